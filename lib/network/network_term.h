/* network_term.h: what acts on the nodes of a network beside its elements: mass, gravity, springs, tools.
 * Internal. The core calls the functions of each term in the order in which they were added and knows none by
 * name. A concrete term is a struct that begins with network_term. */
#ifndef NETWORK_TERM_H
#define NETWORK_TERM_H

#include "base/arena.h"

#include <palpate/network.h>

typedef struct network_term network_term;

/* A walk over the arrays of a state: counts their bytes, copies them into a buffer or back. */
typedef enum network_way { NETWORK_COUNT, NETWORK_SAVE, NETWORK_RESTORE } network_way;
typedef struct network_cursor {
    network_way way;
    unsigned char *at; /* in the buffer; NULL when counting */
    size_t bytes;      /* passed so far */
} network_cursor;
void network_pass(network_cursor *cursor, void *data, size_t bytes);

/* Takes k[9] by rows: -d force on node row / d place of node column, N/m. */
typedef void (*network_block_taker)(void *user, int32_t row, int32_t column, const double k[9]);

/* The functions of one kind of term; NULL = nothing to do. now is the committed state, next the one sought.
 */
typedef struct network_term_kind {
    void (*reset)(network_term *term, palp_network *net); /* now: at rest, no history */
    void (*pass)(network_term *term, palp_network *net,
                 network_cursor *cursor);                /* now; always the same bytes */
    void (*swap)(network_term *term, palp_network *net); /* next becomes now */

    /* A step: begin, evaluate as often as it takes, finish. */
    void (*begin)(network_term *term, palp_network *net);
    void (*evaluate)(network_term *term,
                     palp_network *net); /* adds to net->outer and outer_squares at next.x */
    void (*finish)(network_term *term, palp_network *net); /* solved: what lasts into next */

    /* Forces on the free axes alone, which no support feels: added to r[3 n_nodes]. *squares grows by the
     * squares of stiffness times place, which tell how far rounding leaves the residual uncertain, N^2. */
    void (*residual)(const network_term *term, const palp_network *net, double *r, double *squares);

    /* -d force / d x: its constant diagonal, added to d[3 n_nodes]; other blocks, the lower ones of each pair
     * of nodes; and these blocks times u, added to out, [3 n_nodes] both. Blocks are symmetric; whole_times
     * is for a term that has more, with what is not. */
    void (*diagonal)(const network_term *term, const palp_network *net, double *d);
    void (*blocks)(const network_term *term, const palp_network *net, network_block_taker take, void *user);
    void (*times)(const network_term *term, const palp_network *net, const double *u, double *out);
    void (*whole_times)(const network_term *term, const palp_network *net, const double *u, double *out);

    /* Adds the potential of the last evaluation, J; false if there is none (friction). */
    bool (*energy)(const network_term *term, const palp_network *net, double *energy);

    /* Of terms that move on a path of their own, from where they were at now to where they were told to go:
     */
    double (*way)(const network_term *term, const palp_network *net);   /* as network_longest_way */
    void (*place)(network_term *term, palp_network *net, double share); /* to this share of it, at next.x */
    bool (*refresh)(network_term *term, palp_network *net); /* next.x has slid: points were taken anew */
    void (*follow)(network_term *term, palp_network *net);  /* the guess next.x goes along */
    bool (*inside)(const network_term *term, const palp_network *net); /* after finish: is one in the body
                                                                          that touches nothing of it? */

    /* Where a residual[3 n_nodes] is left at next.x: stiffness of the term's springs on each node, added to
     * weight[n_nodes], N/m; and, after finish, forces on what is outside become those that the tissue pushes
     * back with: each spring takes its share of the node's residual. */
    void (*weigh)(const network_term *term, const palp_network *net, double *weight);
    void (*share_residual)(network_term *term, palp_network *net, const double *weight,
                           const double *residual);

    /* After finish: what of an error of its forces, N, the term remembers beyond the step; adds it to *sum.
     */
    void (*doubt)(network_term *term, palp_network *net, double error, double *sum);

    /* Of a term on all nodes, none that touches from outside: a part of its blocks, 0 of 1 = all, each of one
     * node or of the two of an element. Together they are positive semidefinite, or nearly, and at most four
     * times those of single nodes. */
    void (*blocks_part)(const network_term *term, const palp_network *net, size_t part, size_t parts,
                        network_block_taker take, void *user);

    void (*grasped)(const network_term *term, unsigned char *fixed); /* fixed[node] = 1 where it grasps one */
    void (*grasp_changed)(network_term *term, palp_network *net);    /* another term grasps other nodes */
} network_term_kind;

struct network_term {
    const network_term_kind *kind;
    arena memory; /* of its arrays */
};

/* A term of this kind, zero but for that, of size bytes, to be freed by network_term_free; NULL: out of
 * memory. */
void *network_term_new(const network_term_kind *kind, size_t size);
void network_term_free(network_term *term); /* its arrays too; NULL is fine */

/* Adds n new terms, which the network then owns, each reset. A NULL among them, or one that lacks an array,
 * counts as out of memory. On failure none is added and all are freed. */
palp_status network_add_terms(palp_network *net, size_t n, network_term *const *terms);

/* The term of this kind, or NULL. */
network_term *network_find_term(const palp_network *net, const network_term_kind *kind);

/* Calls a function of every term that has it: NETWORK_EACH_TERM(net, begin, net) is kind->begin(term, net).
 */
#define NETWORK_EACH_TERM(net, function, ...)                                                                \
    for (size_t term_ = 0; term_ < (net)->n_terms; term_++)                                                  \
        if ((net)->terms[term_]->kind->function)                                                             \
    (net)->terms[term_]->kind->function((net)->terms[term_], __VA_ARGS__)

#endif
