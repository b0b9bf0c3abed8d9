/* network_term.h: what acts on a network's nodes apart from elements: mass, gravity, springs, tools.
 * Internal. The core calls the functions of each term in the order in which they were added and knows none by
 * name. A concrete term is a struct that begins with network_term. */
#ifndef NETWORK_TERM_H
#define NETWORK_TERM_H

#include "base/arena.h"

#include <palpate/network.h>

typedef struct network_term network_term;

/* A pass over the arrays of a state: counts their bytes, copies them into a buffer, or copies them back. */
typedef enum network_way { NETWORK_COUNT, NETWORK_SAVE, NETWORK_RESTORE } network_way;
typedef struct network_cursor {
    network_way way;
    unsigned char *at; /* in the buffer; NULL when counting */
    size_t bytes;      /* so far */
} network_cursor;
void network_pass(network_cursor *cursor, void *data, size_t bytes);

/* Receives k[9] by rows: -d force on node row / d position of node column, N/m. */
typedef void (*network_block_taker)(void *user, int32_t row, int32_t column, const double k[9]);

/* Functions of one kind of term; NULL = nothing to do. now is the committed state, next the one to be
 * solved. */
typedef struct network_term_kind {
    void (*reset)(network_term *term, palp_network *net); /* now becomes the state at rest, without history */
    void (*pass)(network_term *term, palp_network *net,
                 network_cursor *cursor);                /* passes now, always the same bytes */
    void (*swap)(network_term *term, palp_network *net); /* next becomes now */

    /* In a step: begin once, evaluate as often as needed, finish once. */
    void (*begin)(network_term *term, palp_network *net);
    void (*evaluate)(network_term *term,
                     palp_network *net); /* adds to net->outer and outer_squares at next.x */
    void (*finish)(network_term *term, palp_network *net); /* after the solution: sets what next keeps */

    /* Forces on free axes only, which supports do not carry: added to r[3 n_nodes]. *squares grows by the
     * squares of stiffness times position, N^2, for the rounding error of the residual. */
    void (*residual)(const network_term *term, const palp_network *net, double *r, double *squares);

    /* -d force / d x: a constant diagonal, added to d[3 n_nodes]; other blocks, the lower one of each pair of
     * nodes; these blocks times u, added to out, [3 n_nodes] both. Blocks are symmetric; whole_times includes
     * the unsymmetric part of a term that has one. */
    void (*diagonal)(const network_term *term, const palp_network *net, double *d);
    void (*blocks)(const network_term *term, const palp_network *net, network_block_taker take, void *user);
    /* Blocks between different nodes that the factor leaves out and the solution adds (network_solve.c).
     * Those of blocks are then positive semidefinite without them, or nearly. */
    void (*far_blocks)(const network_term *term, const palp_network *net, network_block_taker take,
                       void *user);
    void (*times)(const network_term *term, const palp_network *net, const double *u, double *out);
    void (*whole_times)(const network_term *term, const palp_network *net, const double *u, double *out);

    /* Adds the potential at the last evaluation, J; false if there is none (friction). */
    bool (*energy)(const network_term *term, const palp_network *net, double *energy);

    /* For terms with a prescribed motion, from their place at now to the one they are set to: */
    double (*way)(const network_term *term, const palp_network *net); /* as network_longest_way */
    void (*place)(network_term *term, palp_network *net,
                  double share); /* moves to this share of it, at next.x */
    bool (*refresh)(network_term *term,
                    palp_network *net); /* contact points were found anew, as next.x has slid */
    void (*follow)(network_term *term, palp_network *net); /* is called with each new guess next.x */
    /* After finish. ERR_INSIDE: a tool is in the body without contact; ERR_LIMIT: not all was looked at. */
    palp_status (*check)(const network_term *term, const palp_network *net);

    /* For a residual[3 n_nodes] that remains at next.x. weigh adds the stiffness of the term's springs to
     * weight[n_nodes], N/m. After finish, share_residual turns forces on outside objects into those of the
     * tissue: each spring takes its share of its node's residual. */
    void (*weigh)(const network_term *term, const palp_network *net, double *weight);
    void (*share_residual)(network_term *term, palp_network *net, const double *weight,
                           const double *residual);

    /* doubt adds to *sum the error of its forces at the last evaluation by errors in its history, N. After
     * finish, keep_doubt adds to that history the errors of this step: nodes may be off by change[3 n_nodes],
     * m; where that is NULL, forces by error, N. */
    void (*doubt)(const network_term *term, const palp_network *net, double *sum);
    void (*keep_doubt)(network_term *term, palp_network *net, const double *change, double error);

    /* For a term on all nodes, not one that touches from outside: a part of its blocks, 0 of 1 = all, each on
     * a node or an element. Their sum is positive semidefinite, or nearly, and at most spread times the
     * blocks on nodes. */
    double spread;
    /* In a network in parts each part has other solids, whose forces add up. Such a term comes first; later
     * ones are the same in all parts. */
    bool adds_up;
    void (*blocks_part)(const network_term *term, const palp_network *net, size_t part, size_t parts,
                        network_block_taker take, void *user);

    void (*grasped)(const network_term *term,
                    unsigned char *fixed); /* fixed[node] = 1 for each node it grasps */
    void (*grasp_changed)(network_term *term, palp_network *net); /* another term grasps other nodes now */
} network_term_kind;

struct network_term {
    const network_term_kind *kind;
    arena memory; /* of the term's arrays */
};

/* A term of this kind, otherwise zero, of size bytes; freed by network_term_free. NULL: out of memory. */
void *network_term_new(const network_term_kind *kind, size_t size);
void network_term_free(network_term *term); /* with its arrays; NULL is fine */

/* Adds n new terms, which the network then owns, and resets each. A NULL among them, or one that lacks an
 * array, counts as out of memory. On failure none is added and all are freed. */
palp_status network_add_terms(palp_network *net, size_t n, network_term *const *terms);

/* The term of this kind, or NULL. */
network_term *network_find_term(const palp_network *net, const network_term_kind *kind);

/* Calls a function of every term that has it: NETWORK_EACH_TERM(net, begin, net) calls kind->begin(term,
 * net). */
#define NETWORK_EACH_TERM(net, function, ...)                                                                \
    for (size_t term_ = 0; term_ < (net)->n_terms; term_++)                                                  \
        if ((net)->terms[term_]->kind->function)                                                             \
    (net)->terms[term_]->kind->function((net)->terms[term_], __VA_ARGS__)

#endif
