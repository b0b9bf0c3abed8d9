/* petsc_tangent.c: the tangent of a part in PETSc's matrix. It is given as coordinates and values: 18 for
 * each element (the block of second and first node, and its transpose), 9 for each node of the part, 9 for
 * each pair that tools need. PETSc adds values at the same place, also those of other processes. */
#include "petsc_internal.h"

#include <stdlib.h>
#include <string.h>

enum { OF_ELEMENT = 18, OF_NODE = 9 };

/* ---- pairs that tools may join ------------------------------------------------------------------- */

static int compare_pairs(const void *a, const void *b) {
    const part_pair *p = a, *q = b;
    if (p->row != q->row)
        return p->row < q->row ? -1 : 1;
    return (p->column > q->column) - (p->column < q->column);
}

/* Both orders of the corners of each triangle, for rows that this process owns. */
static palp_status list_pairs_of_surface(part *p) {
    const palp_network *net = p->net;
    const size_t n = net->n_terms > 0 ? net->n_surface : 0;
    p->pair = malloc((6 * n + 1) * sizeof *p->pair);
    if (!p->pair)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < 9 * n; i++) {
        const int32_t *corner = net->surface + 3 * (i / 9);
        const part_pair pair = {corner[i % 9 / 3], corner[i % 3]};
        if (pair.row != pair.column && p->own[pair.row])
            p->pair[p->n_pairs++] = pair;
    }
    qsort(p->pair, p->n_pairs, sizeof *p->pair, compare_pairs);
    size_t kept = 0;
    for (size_t i = 0; i < p->n_pairs; i++)
        if (i == 0 || compare_pairs(&p->pair[i], &p->pair[kept - 1]) != 0)
            p->pair[kept++] = p->pair[i];
    p->n_pairs = kept;
    return PALP_OK;
}

/* ---- the pattern --------------------------------------------------------------------------------- */

/* Unknown of an axis of a node, or -1 where it is fixed: PETSc leaves such entries out. */
static PetscInt unknown(const part *p, int32_t node, int axis) {
    return p->net->dof[3 * node + axis] < 0 ? -1 : 3 * p->number[node] + axis;
}

static void list_block(const part *p, int32_t row, int32_t column, PetscInt *rows, PetscInt *columns) {
    for (int i = 0; i < 9; i++) {
        rows[i] = unknown(p, row, i / 3);
        columns[i] = unknown(p, column, i % 3);
    }
}

/* A fixed axis has its diagonal entry only. */
static void list_node_block(const part *p, int32_t node, PetscInt *rows, PetscInt *columns) {
    list_block(p, node, node, rows, columns);
    for (int k = 0; k < 3; k++)
        rows[4 * k] = columns[4 * k] = 3 * p->number[node] + k;
}

static palp_status set_pattern(part *p) {
    const palp_network *net = p->net;
    p->n_value = OF_ELEMENT * net->n_elements + OF_NODE * (net->n_nodes + p->n_pairs);
    PetscInt *rows = malloc(p->n_value * sizeof *rows), *columns = malloc(p->n_value * sizeof *columns);
    bool ok = rows && columns;
    size_t at = 0;
    for (size_t i = 0; i < net->n_elements && ok; i++, at += OF_ELEMENT) {
        const int32_t a = net->pair[2 * i], b = net->pair[2 * i + 1];
        list_block(p, b, a, rows + at, columns + at);
        list_block(p, a, b, rows + at + 9, columns + at + 9);
    }
    for (size_t i = 0; i < net->n_nodes && ok; i++, at += OF_NODE)
        list_node_block(p, (int32_t)i, rows + at, columns + at);
    for (size_t i = 0; i < p->n_pairs && ok; i++, at += OF_NODE)
        list_block(p, p->pair[i].row, p->pair[i].column, rows + at, columns + at);
    ok = ok && !MatSetPreallocationCOO(p->tangent, (PetscCount)p->n_value, rows, columns);
    free(rows);
    free(columns);
    return ok ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* The motions of a rigid body, which a multigrid for solids must represent on all levels. */
static palp_status set_rigid_motions(part *p) {
    MatNullSpace rigid;
    PetscScalar *at;
    TRY(VecGetArray(p->x, &at));
    PetscInt first;
    TRY(VecGetOwnershipRange(p->x, &first, NULL));
    for (size_t i = 0; i < p->n_nodes; i++)
        if (p->own[i])
            memcpy(at + 3 * p->number[i] - first, p->net->rest + 3 * i, 3 * sizeof *at);
    TRY(VecRestoreArray(p->x, &at));
    TRY(MatNullSpaceCreateRigidBody(p->x, &rigid));
    TRY(MatSetNearNullSpace(p->tangent, rigid));
    TRY(MatNullSpaceDestroy(&rigid));
    return PALP_OK;
}

palp_status part_make_tangent(part *p) {
    const PetscInt own = 3 * p->n_own;
    palp_status status = list_pairs_of_surface(p);
    if (status)
        return status;
    TRY(MatCreate(p->comm, &p->tangent));
    TRY(MatSetSizes(p->tangent, own, own, PETSC_DETERMINE, PETSC_DETERMINE));
    TRY(MatSetType(p->tangent, MATAIJ));
    TRY(MatSetBlockSize(p->tangent, 3));
    status = set_pattern(p);
    if (!status)
        status = set_rigid_motions(p);
    p->node_block = malloc(9 * p->n_nodes * sizeof *p->node_block);
    p->value = malloc(p->n_value * sizeof *p->value);
    return status || (p->node_block && p->value) ? status : PALP_ERR_NO_MEMORY;
}

/* ---- the values ---------------------------------------------------------------------------------- */

static void write_element_blocks(part *p) {
    const palp_network *net = p->net;
    double *at = p->value;
    memset(p->node_block, 0, 9 * p->n_nodes * sizeof *p->node_block);
    for (size_t i = 0; i < net->n_elements; i++, at += OF_ELEMENT) {
        static const unsigned char place[9] = {0, 1, 3, 1, 2, 4, 3, 4, 5};
        double k[6], *a = p->node_block + 9 * net->pair[2 * i], *b = p->node_block + 9 * net->pair[2 * i + 1];
        network_element_block(net, i, k);
        for (size_t e = 0; e < 9; e++) {
            at[e] = at[e + 9] = -k[place[e]];
            a[e] += k[place[e]];
            b[e] += k[place[e]];
        }
    }
}

/* A block between nodes of a term, which is the same in all parts. It goes into the rows that this process
 * owns. */
static void add_pair_block(part *p, int32_t row, int32_t column, const double k[9], bool transposed) {
    const part_pair key = {row, column};
    const part_pair *found =
        p->own[row] ? bsearch(&key, p->pair, p->n_pairs, sizeof key, compare_pairs) : NULL;
    if (!found)
        return;
    double *value =
        p->value + OF_ELEMENT * p->net->n_elements + OF_NODE * (p->n_nodes + (size_t)(found - p->pair));
    for (int i = 0; i < 9; i++)
        value[i] += k[transposed ? 3 * (i % 3) + i / 3 : i];
}

static void take_term_block(void *user, int32_t row, int32_t column, const double k[9]) {
    part *p = user;
    for (int i = 0; i < 9 && row == column && p->own[row]; i++)
        p->node_block[9 * row + i] += k[i];
    if (row == column)
        return;
    add_pair_block(p, row, column, k, false);
    add_pair_block(p, column, row, k, true);
}

/* Equations of fixed axes have the diagonal of their node at rest. */
static void write_node_blocks(part *p) {
    palp_network *net = p->net;
    network_set_diagonal(net, 0.0);
    for (size_t i = 0; i < net->n_nodes; i++)
        for (size_t k = 0; k < 3; k++) {
            double *value = p->node_block + 9 * i + 4 * k;
            *value += p->own[i] ? net->diagonal[3 * i + k] : 0.0;
            if (net->dof[3 * i + k] < 0)
                *value = p->own[i] ? net->modulus * net->unit[i] : 0.0;
        }
    memcpy(p->value + OF_ELEMENT * net->n_elements, p->node_block, 9 * net->n_nodes * sizeof *p->value);
}

PetscErrorCode part_assemble(part *p) {
    palp_network *net = p->net;
    double *pairs = p->value + OF_ELEMENT * net->n_elements + OF_NODE * net->n_nodes;
    write_element_blocks(p);
    memset(pairs, 0, OF_NODE * p->n_pairs * sizeof *pairs);
    NETWORK_EACH_TERM(net, blocks, net, take_term_block, p);
    write_node_blocks(p);
    return MatSetValuesCOO(p->tangent, p->value, INSERT_VALUES);
}
