/* multigrid.h: a preconditioner for the tangent of a network: symmetric Gauss-Seidel on blocks of 3 by 3 (on
 * the finest level damped Jacobi at the nodes that nothing stiff touches), Galerkin products on ever coarser
 * node sets, a direct factor of the coarsest. Of a small network that is all there is. Single precision,
 * double on the coarsest. Two sets of numbers: one serves, the next is made meanwhile in pieces of known
 * work. Internal. */
#ifndef MULTIGRID_H
#define MULTIGRID_H

#include "linsys.h"

typedef struct multigrid multigrid;

/* Symbolic part and all memory. dof[3 n_nodes] < 0: fixed. Networks of at most direct unknowns have one
 * level. */
palp_status multigrid_create(size_t n_nodes, const double *rest, const int32_t *dof, size_t n_elements,
                             const int32_t *pair, size_t direct, multigrid **out);
void multigrid_free(multigrid *mg); /* NULL is fine */

/* What the next numbers are made of: element i is along d d' + across 1 between its nodes, which are d apart;
 * across in N/m. To be filled by the caller before multigrid_begin and left alone until the making is done.
 */
enum { MULTIGRID_COUPLINGS = 600 };

/* Another block between two nodes, rows of low, columns of high. Of nodes that no element joins the finest
 * level's sweeps have it, coarser levels and the factor do not. */
typedef struct multigrid_coupling {
    int32_t low, high, next; /* next: set by begin */
    float block[9];
} multigrid_coupling;

typedef struct multigrid_source {
    float *element; /* [n_floats] along, across; of element i from place[i] on, spacing apart; the others are
                     * 0; then the nodes, as multigrid_place_nodes has them */
    const uint32_t *place; /* [n_elements] */
    size_t spacing, n_floats;
    float *node;                  /* [6 n_nodes] added to a node's own block, lower triangle by rows */
    multigrid_coupling *coupling; /* [MULTIGRID_COUPLINGS] */
    int32_t *n_couplings;
    float *between, *beside; /* [n_between], [n_beside] what multigrid_add_block has added; NULL and 0 without
                                room for it */
    size_t n_between, n_beside;
} multigrid_source;
multigrid_source multigrid_input(multigrid *mg);

/* Where the nodes are, x[3 n_nodes], m, into element[n_floats]: every other number there is the caller's. */
void multigrid_place_nodes(const multigrid *mg, const double *x, float *element);

/* Takes element[n_floats] for the input's and gives back what was that. */
float *multigrid_exchange(multigrid *mg, float *element);

multigrid_source multigrid_used(multigrid *mg); /* what those that serve were made of */

/* Room for further blocks, of what acts on all nodes: one between the two nodes of each element, and one of
 * each node's own. Together they are positive semidefinite, or nearly, and at most four times their own ones,
 * as those of tetrahedra are. */
palp_status multigrid_make_room(multigrid *mg);
void multigrid_clear_blocks(multigrid *mg); /* of the input */

/* Adds a block, by rows, to them: a node's own, or one of the two of a pair that an element joins. */
void multigrid_add_block(multigrid *mg, int32_t row, int32_t column, const double block[9]);

/* Starts making the next numbers from the input; definite: without what makes an element's block indefinite.
 */
void multigrid_begin(multigrid *mg, bool definite);

/* Works on them for about so many units (multigrid_cycle_work is what one cycle costs); *done: they are
 * finished and multigrid_swap may bring them into use. ERR_SINGULAR: not positive definite, given up. */
palp_status multigrid_advance(multigrid *mg, double work, bool *done);
void multigrid_swap(multigrid *mg);

double multigrid_cycle_work(const multigrid *mg); /* units of one multigrid_apply */

/* Brings the own blocks (node[6 n_nodes]) and couplings of the set in use up to date on its finest level;
 * nothing where that is the only one. */
void multigrid_touch(multigrid *mg, const double *node, size_t n, const multigrid_coupling *coupling);

/* out = minus the part of such elements in the tangent times x, [3 n_nodes] both: as the next numbers would
 * have it. In single precision. */
void multigrid_elements_times(multigrid *mg, const float *element, const double *x, double *out);

/* z = M^-1 r, [3 n_nodes] both, 0 at fixed axes. */
void multigrid_apply(multigrid *mg, const double *r, double *z);

/* The same in two halves, between which half[multigrid_half_size] keeps what was found, whatever else is
 * asked of mg meanwhile but another set of numbers. */
size_t multigrid_half_size(const multigrid *mg);
void multigrid_apply_half(multigrid *mg, const double *r, float *half);
void multigrid_apply_rest(multigrid *mg, const double *r, const float *half, double *z);

size_t multigrid_levels(const multigrid *mg);

#endif
