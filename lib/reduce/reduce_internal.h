/* reduce_internal.h: internal data of the reduced model, for its own files and tests. Coordinates q[modes]: x
 * = rest + depth lift + basis q. The basis is orthonormal in the stiffness at rest. */
#ifndef REDUCE_INTERNAL_H
#define REDUCE_INTERNAL_H

#include "base/arena.h"
#include "contact/contact_internal.h"

#include <palpate/reduce.h>

enum { REDUCED_BLOCK = 64 }; /* elements whose tangents are summed together */

/* Positions and forces of the full network on one path. */
struct palp_snapshots {
    arena memory;
    size_t n, n_nodes, n_tools;
    double *time, *depth, *force; /* [n] */
    double *x;                    /* [3 n_nodes n] positions, sample by sample */
    palp_tool *tools;             /* [n n_tools] */
    double *tool_force;           /* [3 n_tools n] N, on the tools */
};

/* One state of the reduced model. */
typedef struct reduced_state {
    double *q;               /* [modes] */
    element_history history; /* of the kept elements */
    double depth, time, force;
} reduced_state;

/* The surface that tools touch (reduce_contact.c). */
typedef struct reduced_contact {
    contact_set contacts;
    size_t n, n_near;
    double *x, *next_x, *rest; /* [3 n] positions: committed, next, at rest, m */
    double *force;             /* [3 n] force of the tools, N */
    double *unit;              /* [n] as unit of the reduced model */
    int32_t *node;             /* [n] nodes of the reduced model */
    int32_t *triangle;         /* [3 n_triangles] */
    int32_t *near;             /* [n_near] nodes whose positions are up to date */
    double *row;               /* [modes 3 REDUCED_BLOCK] scratch */
    double speed, lift;        /* largest motion of a node per unit of q and of depth */
    double drift;              /* largest motion of a node since all positions were up to date, m */
} reduced_contact;

struct palp_reduced {
    arena memory; /* of all arrays, the surface's included */
    palp_material material;
    palp_reduced_summary summary;
    size_t n_nodes, modes, n_elements, n_triangles;
    double *rest, *lift;  /* [3 n_nodes] positions, m; displacement per depth */
    double *basis;        /* [3 n_nodes modes] one row for each coordinate of a node */
    unsigned char *fixed; /* [3 n_nodes] 1 = fixed or driven */
    int32_t *triangles;   /* [3 n_triangles] on the surface */
    int32_t *pair;        /* [2 n_elements] nodes of the kept elements */
    double *weight;       /* [n_elements] */
    double *low, *high;   /* [modes + 1] range in the snapshots, at the end that of depth */
    size_t max_tools;     /* 0 = no tools */
    palp_contact_settings contact_settings;
    double *unit;             /* [n_nodes] a node's stiffness over that of an element, 1/m */
    reduced_contact *surface; /* NULL if max_tools is 0 */

    /* of the kept elements: differences of the rows of their ends */
    double *gap_rest, *gap_lift;  /* [3 n_elements] */
    double *gap;                  /* [modes 3 n_elements] one column for each coordinate */
    double *inverse_rest, *reach; /* [n_elements] 1 / rest length; weight times norm of gap */

    double tolerance;
    int max_iterations;
    /* at the last evaluation, at next */
    element_step step;
    double *strain, *force, *tangent, *inverse_length; /* [n_elements] */
    double *direction, *vector;                        /* [3 n_elements] */
    double *rhs, *dq, *start;                          /* [modes] */
    double *stiffness,
        *factor;      /* [modes modes] kept tangent of the elements; that with the contacts, factored */
    double *scaled;   /* [modes 3 REDUCED_BLOCK] */
    int *pivot;       /* [modes] */
    double *work;     /* [64 modes] */
    bool definite;    /* the factor is Cholesky's, otherwise L D L' */
    bool stiff;       /* stiffness holds a tangent */
    size_t refreshed; /* elements summed so far for the next stiffness */
    double *coming;   /* [modes modes] the next stiffness */
    reduced_state now, next;
    double *past;           /* [modes] q of the state before the committed one */
    double past_step, peak; /* s from past to now; largest force since the last reset */
};

/* A reduced model with this basis [3 n_nodes modes], 0 at fixed coordinates, and elements element[n] of the
 * network with weight[n]; lift[3 n_nodes]. contacts: the network's tools, or NULL. Everything is copied. */
palp_status reduced_make(const palp_network *net, const contact_set *contacts, size_t modes,
                         const double *basis, const double *lift, size_t n, const int32_t *element,
                         const double *weight, palp_reduced **out);

/* Allocates for the sizes given. The caller then fills rest, lift, basis, pair and weight, and calls
 * reduced_prepare. */
palp_status reduced_allocate(palp_reduced *reduced);
palp_status reduced_prepare(palp_reduced *reduced);

/* Coordinate i of the nodes at (q, depth). */
double reduced_coordinate(const palp_reduced *reduced, const double *q, double depth, size_t i);

/* At next (q, depth) with the history of now: rhs = -dE/dq and *drive = dE/ddepth of the elements' energy.
 * False: an element has collapsed. */
bool reduced_evaluate(palp_reduced *reduced, double *drive);

/* Adds the tangent of elements [from, to) at the last evaluation to k[modes modes]. */
void reduced_stiffness(palp_reduced *reduced, size_t from, size_t to, double *k);

/* Tools on the surface. make is the last step of building and allocates all memory. begin sets the poses from
 * now to next. evaluate adds to rhs and *drive, stiffness to a tangent. refresh is true if contacts were
 * found anew: solve again. commit gives force[n_tools] (or NULL), adds their squares and returns the number
 * of contacts. */
palp_status reduced_contact_make(palp_reduced *reduced);
void reduced_contact_reset(palp_reduced *reduced);
palp_status reduced_contact_begin(palp_reduced *reduced, size_t n_tools, const palp_tool *tools);
void reduced_contact_evaluate(palp_reduced *reduced, double *drive);
void reduced_contact_stiffness(const palp_reduced *reduced, double *stiffness);
bool reduced_contact_refresh(palp_reduced *reduced);
size_t reduced_contact_commit(palp_reduced *reduced, palp_tool_force *force, double *squares);

/* The samples of all snapshots in reduced coordinates. */
typedef struct reduced_samples {
    size_t n;  /* of all paths */
    double *q; /* [modes n] */
} reduced_samples;

/* Modes (reduce_pod.c): at most settings->modes of them into *basis [3 n_nodes *modes], with the samples'
 * coordinates and *lift. The caller frees them. */
palp_status reduced_pod(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                        const palp_reduce_settings *settings, size_t *modes, double **basis, double **lift,
                        reduced_samples *samples);

/* Kept elements and weights (reduce_ecsw.c), which the caller frees; *residual as of nnls_solve. */
palp_status reduced_ecsw(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                         const palp_reduce_settings *settings, size_t modes, const double *basis,
                         const double *lift, const reduced_samples *samples, size_t *n, int32_t **element,
                         double **weight, double *residual);

/* Resets the network to rest and evaluates it, fully relaxed. */
void reduced_at_rest(palp_network *net);

#endif
