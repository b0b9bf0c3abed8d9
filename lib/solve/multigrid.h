/* multigrid.h: a multigrid preconditioner for the tangent of a network. Internal. Smoothing is symmetric
 * Gauss-Seidel on 3 by 3 blocks. The finest level uses damped Jacobi at nodes without stiff contacts. Coarser
 * levels are Galerkin products; the coarsest one is factored, and a small network has only that. Single
 * precision, double on the coarsest level. There are two sets of numbers: one is in use while the next is
 * made in pieces of known work. */
#ifndef MULTIGRID_H
#define MULTIGRID_H

#include "linsys.h"

typedef struct multigrid multigrid;

/* Symbolic part and all memory. rest[3 n_nodes] in m; dof[3 n_nodes] < 0: fixed. Networks of at most direct
 * unknowns have one level. */
palp_status multigrid_create(size_t n_nodes, const double *rest, const int32_t *dof, size_t n_elements,
                             const int32_t *pair, size_t direct, multigrid **out);
void multigrid_free(multigrid *mg); /* NULL is fine */

/* Input of the next set. The block of element i is along d d' + across 1, with d the vector between its
 * nodes; across in N/m. The caller fills it before multigrid_begin and leaves it alone until the set is
 * made. */
enum { MULTIGRID_COUPLINGS = 2000 };

/* A block between two further nodes, rows of low, columns of high. If no element joins these nodes, only the
 * sweeps of the finest level use it, neither coarser levels nor the factor. */
typedef struct multigrid_coupling {
    int32_t low, high, next; /* next: set by multigrid_begin */
    float block[9];
} multigrid_coupling;

typedef struct multigrid_source {
    float *element; /* [n_floats] along, across; those of element i from place[i] on, spacing apart; unused
                       ones are 0. Then the nodes, see multigrid_place_nodes */
    const uint32_t *place; /* [n_elements] */
    size_t spacing, n_floats;
    float *node;                  /* [6 n_nodes] added to each node's own block, lower triangle by rows */
    multigrid_coupling *coupling; /* [MULTIGRID_COUPLINGS] */
    int32_t *n_couplings;
    float *between, *beside; /* [n_between], [n_beside] sums of multigrid_add_block; NULL and 0 without
                                multigrid_make_room */
    size_t n_between, n_beside;
} multigrid_source;
multigrid_source multigrid_input(multigrid *mg);

/* Writes node positions x[3 n_nodes], m, into element[n_floats]. The caller writes all other numbers
 * there. */
void multigrid_place_nodes(const multigrid *mg, const double *x, float *element);

/* Makes element[n_floats] the input's array and returns the former one. */
float *multigrid_exchange(multigrid *mg, float *element);

multigrid_source multigrid_used(multigrid *mg); /* the input of the set in use */

/* Room for blocks of terms on all nodes: one between the nodes of each element, one on each node. Their sum
 * must be positive semidefinite, or nearly. It is at most spread times the sum of own blocks: 4 for
 * tetrahedra, 8 for cells. */
palp_status multigrid_make_room(multigrid *mg, double spread);
void multigrid_clear_blocks(multigrid *mg); /* of the next set's input */

/* Adds a block, by rows: a node's own, or one of the two between nodes that an element joins. */
void multigrid_add_block(multigrid *mg, int32_t row, int32_t column, const double block[9]);

/* Starts making the next set from its input. definite: leaves out what makes an element's block
 * indefinite. */
void multigrid_begin(multigrid *mg, bool definite);

/* Does about so many units of work on the next set; multigrid_cycle_work is the cost of one cycle. *done:
 * finished, multigrid_swap may bring it into use. ERR_SINGULAR: not positive definite, given up. */
palp_status multigrid_advance(multigrid *mg, double work, bool *done);
void multigrid_swap(multigrid *mg);

double multigrid_cycle_work(const multigrid *mg); /* work units of one multigrid_apply */

/* Updates own blocks (node[6 n_nodes]) and couplings of the set in use on its finest level. Does nothing if
 * that is the only level. */
void multigrid_touch(multigrid *mg, const double *node, size_t n, const multigrid_coupling *coupling);

/* out = minus the elements' part of the tangent times x, [3 n_nodes] both, in single precision. */
void multigrid_elements_times(multigrid *mg, const float *element, const double *x, double *out);

/* z = M^-1 r, [3 n_nodes] both, 0 at fixed axes. */
void multigrid_apply(multigrid *mg, const double *r, double *z);

/* The same in two halves. half[multigrid_half_size] keeps the intermediate result; in between mg may be used,
 * but not its set exchanged. */
size_t multigrid_half_size(const multigrid *mg);
void multigrid_apply_half(multigrid *mg, const double *r, float *half);
void multigrid_apply_rest(multigrid *mg, const double *r, const float *half, double *z);

size_t multigrid_levels(const multigrid *mg);

#endif
