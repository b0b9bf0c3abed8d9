/* petsc_tangent.c: the tangent of a part in PETSc's matrix. It is given as coordinates and values. Each
 * element has 18: the block of second and first node, and its transpose. Each node of the part has 9, and so
 * has each further pair that solids or tools need. PETSc adds values at the same place, also those of other
 * processes. */
#include "petsc_internal.h"

#include "mesh/mesh_internal.h"

#include <stdlib.h>
#include <string.h>

enum { OF_ELEMENT = 18, OF_NODE = 9 };

/* ---- pairs that have no element ------------------------------------------------------------------ */

static int compare_pairs(const void *a, const void *b) {
    const part_pair *p = a, *q = b;
    if (p->row != q->row)
        return p->row < q->row ? -1 : 1;
    return (p->column > q->column) - (p->column < q->column);
}

/* Both orders of the corners of each triangle, for rows that this process owns. */
static void list_pairs_of_surface(part *p) {
    const palp_network *net = p->net;
    for (size_t i = 0; i < 9 * net->n_surface; i++) {
        const int32_t *corner = net->surface + 3 * (i / 9);
        const part_pair pair = {corner[i % 9 / 3], corner[i % 3]};
        if (pair.row != pair.column && p->own[pair.row])
            p->pair[p->n_pairs++] = pair;
    }
}

/* Counts, and lists if asked, both orders of the corners of solids whose element is in another part. */
static size_t list_pairs_of_solids(part *p, bool list) {
    const palp_mesh *mesh = p->net->mesh;
    size_t corners, n = 0;
    const int32_t *node;
    const size_t n_solids = p->hook.volume ? mesh_solids(mesh, &corners, &node) : 0;
    for (size_t i = 0; i < n_solids; i++)
        for (size_t k = 0; k < corners * corners; k++) {
            const part_pair pair = {node[corners * i + k / corners], node[corners * i + k % corners]};
            if (pair.row == pair.column ||
                palp_mesh_element_between(mesh, pair.row, pair.column) < mesh->n_elements)
                continue;
            n++;
            if (list)
                p->pair[p->n_pairs++] = pair;
        }
    return n;
}

static palp_status list_pairs(part *p) {
    p->pair = malloc((6 * p->net->n_surface + list_pairs_of_solids(p, false) + 1) * sizeof *p->pair);
    if (!p->pair)
        return PALP_ERR_NO_MEMORY;
    list_pairs_of_surface(p);
    list_pairs_of_solids(p, true);
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
    palp_status status = list_pairs(p);
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

static void add_block(double *to, const double k[9], bool transposed) {
    for (int i = 0; i < 9; i++)
        to[i] += k[transposed ? 3 * (i % 3) + i / 3 : i];
}

static void add_pair_block(part *p, int32_t row, int32_t column, const double k[9], bool transposed) {
    const part_pair key = {row, column};
    const part_pair *found = bsearch(&key, p->pair, p->n_pairs, sizeof key, compare_pairs);
    if (found)
        add_block(p->value + OF_ELEMENT * p->net->n_elements +
                      OF_NODE * (p->n_nodes + (size_t)(found - p->pair)),
                  k, transposed);
}

/* Of a term that is the same in all parts: into the rows that this process owns. */
static void take_block_of_all(void *user, int32_t row, int32_t column, const double k[9]) {
    part *p = user;
    if (row == column && p->own[row])
        add_block(p->node_block + 9 * row, k, false);
    if (row != column && p->own[row])
        add_pair_block(p, row, column, k, false);
    if (row != column && p->own[column])
        add_pair_block(p, column, row, k, true);
}

/* Of a term that adds up. */
static void take_block_of_part(void *user, int32_t row, int32_t column, const double k[9]) {
    part *p = user;
    if (row == column) {
        add_block(p->node_block + 9 * row, k, false);
        return;
    }
    const size_t e = palp_mesh_element_between(p->net->mesh, row, column);
    if (e < p->net->n_elements) {
        const bool second = p->net->pair[2 * e] == column; /* the row is the element's second node */
        add_block(p->value + OF_ELEMENT * e, k, !second);
        add_block(p->value + OF_ELEMENT * e + 9, k, second);
        return;
    }
    add_pair_block(p, row, column, k, false);
    add_pair_block(p, column, row, k, true);
}

static void add_blocks_of_terms(part *p) {
    for (size_t i = 0; i < p->net->n_terms; i++) {
        const network_term *term = p->net->terms[i];
        if (term->kind->blocks)
            term->kind->blocks(term, p->net, term->kind->adds_up ? take_block_of_part : take_block_of_all, p);
    }
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
    add_blocks_of_terms(p);
    write_node_blocks(p);
    return MatSetValuesCOO(p->tangent, p->value, INSERT_VALUES);
}
