/* multigrid.c: symbolic part: coarse nodes, interpolation, patterns and memory. */
#include "base/dense.h"
#include "multigrid_internal.h"

#include <stdlib.h>
#include <string.h>

enum { FOLLOWED_MAX = 32 }; /* coarse nodes that a node interpolates from, at most */
enum { COARSEST = 200 };    /* below so many unknowns a factor is cheaper than another level */

void multigrid_free(multigrid *mg) {
    if (!mg)
        return;
    linsys_free(mg->factor[0]);
    linsys_free(mg->factor[1]);
    arena_free(&mg->memory);
    free(mg);
}

static int compare_node_indices(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Allocates the numbers of a level whose pattern is known. */
static palp_status allocate_level_arrays(arena *memory, mg_level *l, bool blocks) {
    size_t entries = blocks ? l->first[l->n] / 2 : 0;
    l->low_first = arena_take(memory, l->n + 1, sizeof *l->low_first);
    l->middle = arena_take(memory, l->n, sizeof *l->middle);
    l->x = arena_take(memory, 4 * l->n, sizeof *l->x);
    l->r = arena_take(memory, 4 * l->n, sizeof *l->r);
    for (size_t k = 0; k < 2; k++) {
        l->block[k] = arena_take(memory, BLOCK_FLOATS * entries, sizeof *l->block[k]);
        l->inverse[k] = arena_take(memory, BLOCK_FLOATS * l->n, sizeof *l->inverse[k]);
        l->own[k] = arena_take(memory, BLOCK_FLOATS * l->n, sizeof *l->own[k]);
    }
    if (memory->failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < l->n; i++) {
        uint32_t k = l->first[i];
        while (k < l->first[i + 1] && l->column[k] < (int32_t)i)
            k++;
        l->middle[i] = k;
        l->low_first[i + 1] = l->low_first[i] + (k - l->first[i]);
    }
    return PALP_OK;
}

/* Sorts the elements by lower node; within one node they keep the caller's order. */
static palp_status sort_elements_by_low_node(multigrid *mg, const int32_t *pair) {
    uint32_t *after = mg->after = arena_take(&mg->memory, mg->n_nodes + 2, sizeof *after);
    mg->place = arena_take(&mg->memory, mg->n_elements, sizeof *mg->place);
    mg->high = arena_take(&mg->memory, mg->n_elements, sizeof *mg->high);
    mg->slot = arena_take(&mg->memory, mg->n_elements, sizeof *mg->slot);
    if (mg->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < mg->n_elements; i++)
        after[(pair[2 * i] < pair[2 * i + 1] ? pair[2 * i] : pair[2 * i + 1]) + 2]++;
    for (size_t i = 2; i < mg->n_nodes + 2; i++)
        after[i] += after[i - 1];
    for (size_t i = 0; i < mg->n_elements; i++) {
        int32_t a = pair[2 * i], b = pair[2 * i + 1];
        mg->place[i] = after[(a < b ? a : b) + 1]++;
        mg->high[mg->place[i]] = a < b ? b : a;
    }
    for (size_t k = 0; k < mg->n_elements; k++)
        mg->slot[k] = (uint32_t)(2 * k);
    palp_status status = multigrid_make_batches(mg);
    mg->spacing = mg->n_batches > 0 ? MULTIGRID_BATCH * mg->n_batches : 1;
    mg->nodes = mg->n_batches > 0 ? 2 * MULTIGRID_BATCH * mg->n_batches : 2 * mg->n_elements;
    mg->n_floats = mg->nodes + (mg->n_batches > 0 ? 3 * multigrid_stride(mg) : 4 * mg->n_nodes);
    for (size_t i = 0; i < mg->n_elements; i++)
        mg->place[i] = mg->slot[mg->place[i]];
    return status;
}

/* The finest level: the entries of a row are the elements of its node. */
static palp_status create_finest_level(multigrid *mg, const int32_t *dof) {
    mg_level *l = &mg->level[0];
    l->n = mg->n_nodes;
    l->first = arena_take(&mg->memory, l->n + 2, sizeof *l->first);
    l->column = arena_take(&mg->memory, 2 * mg->n_elements, sizeof *l->column);
    l->axes = arena_take(&mg->memory, l->n, sizeof *l->axes);
    mg->through = arena_take(&mg->memory, 2 * mg->n_elements, sizeof *mg->through);
    if (mg->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < 3 * l->n; i++)
        if (dof[i] >= 0)
            l->axes[i / 3] = (unsigned char)(l->axes[i / 3] | 1U << i % 3);
    for (size_t i = 0; i < l->n; i++)
        for (uint32_t e = mg->after[i]; e < mg->after[i + 1]; e++) {
            l->first[i + 2]++;
            l->first[mg->high[e] + 2]++;
        }
    for (size_t i = 2; i < l->n + 2; i++)
        l->first[i] += l->first[i - 1];
    for (size_t i = 0; i < l->n; i++)
        for (uint32_t e = mg->after[i]; e < mg->after[i + 1]; e++) {
            l->column[l->first[i + 1]++] = mg->high[e];
            l->column[l->first[mg->high[e] + 1]++] = (int32_t)i;
        }
    for (size_t i = 0; i < l->n; i++)
        qsort(l->column + l->first[i], l->first[i + 1] - l->first[i], sizeof *l->column,
              compare_node_indices);
    for (size_t i = 0; i < l->n; i++)
        for (uint32_t e = mg->after[i]; e < mg->after[i + 1]; e++)
            mg->through[multigrid_entry(l, (int32_t)i, mg->high[e])] =
                mg->through[multigrid_entry(l, mg->high[e], (int32_t)i)] = e;
    return allocate_level_arrays(&mg->memory, l, false);
}

/* Coarse nodes: no two are neighbours, and every other node has one as a neighbour. number[n]: coarse number,
 * or -1. On a lattice these are every second node along each axis. */
static size_t choose_coarse_nodes(const mg_level *l, int32_t *number) {
    size_t n = 0;
    for (size_t i = 0; i < l->n; i++)
        number[i] = 0;
    for (size_t i = 0; i < l->n; i++) {
        if (number[i] < 0)
            continue;
        number[i] = (int32_t)n++;
        for (uint32_t k = l->first[i]; k < l->first[i + 1]; k++)
            number[l->column[k]] = -1;
    }
    return n;
}

/* Minimises w' (D D' + 0.05 |d|^2) w with sum w = 1. This interpolates the node's position from those it
 * follows, at distances d. */
static void fit_interpolation_weights(size_t n, double (*d)[3], double *w) {
    double a[FOLLOWED_MAX * FOLLOWED_MAX], sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j <= i; j++)
            a[i * n + j] = dense_dot(3, d[i], d[j]);
        a[i * n + i] *= 1.05;
        w[i] = 1.0;
    }
    if (dense_cholesky(n, a))
        dense_cholesky_solve(n, a, 1, w);
    for (size_t i = 0; i < n; i++)
        sum += w[i];
    for (size_t i = 0; i < n; i++)
        w[i] /= sum;
}

/* Interpolation of each node: the coarse nodes it follows and their weights. x[3 n]: positions of this
 * level's nodes. */
static palp_status create_interpolation(arena *memory, mg_level *l, const int32_t *number, const double *x) {
    l->up_first = arena_take(memory, l->n + 1, sizeof *l->up_first);
    l->up = arena_take(memory, l->first[l->n] + l->n, sizeof *l->up);
    l->weight = arena_take(memory, l->first[l->n] + l->n, sizeof *l->weight);
    if (memory->failed)
        return PALP_ERR_NO_MEMORY;
    uint32_t at = 0;
    for (size_t i = 0; i < l->n; i++) {
        double d[FOLLOWED_MAX][3], w[FOLLOWED_MAX] = {1.0};
        size_t n = 0;
        if (number[i] >= 0)
            l->up[at + n++] = number[i];
        for (uint32_t k = l->first[i]; number[i] < 0 && k < l->first[i + 1] && n < FOLLOWED_MAX; k++) {
            int32_t j = l->column[k];
            if (number[j] < 0)
                continue;
            for (size_t c = 0; c < 3; c++)
                d[n][c] = x[3 * (size_t)j + c] - x[3 * i + c];
            l->up[at + n++] = number[j];
        }
        if (n > 1)
            fit_interpolation_weights(n, d, w);
        for (size_t k = 0; k < n; k++)
            l->weight[at++] = (float)w[k];
        l->up_first[i + 1] = at;
    }
    return PALP_OK;
}

/* Followers of each coarse node: list[first[i]] to list[first[i + 1]]. */
static palp_status list_coarse_followers(arena *scratch, const mg_level *l, size_t n_coarse, uint32_t **first,
                                         int32_t **list) {
    uint32_t *f = *first = arena_take(scratch, n_coarse + 2, sizeof *f);
    int32_t *out = *list = arena_take(scratch, l->up_first[l->n], sizeof *out);
    if (scratch->failed)
        return PALP_ERR_NO_MEMORY;
    for (uint32_t k = 0; k < l->up_first[l->n]; k++)
        f[l->up[k] + 2]++;
    for (size_t i = 2; i < n_coarse + 2; i++)
        f[i] += f[i - 1];
    for (size_t i = 0; i < l->n; i++)
        for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++)
            out[f[l->up[k] + 1]++] = (int32_t)i;
    return PALP_OK;
}

/* Adds to a row's columns whom node j follows, each once. */
static uint32_t append_followed_columns(const mg_level *fine, int32_t j, int32_t self, int32_t *mark,
                                        int32_t *column, uint32_t at) {
    for (uint32_t k = fine->up_first[j]; k < fine->up_first[j + 1]; k++) {
        int32_t c = fine->up[k];
        if (mark[c] == self)
            continue;
        mark[c] = self;
        if (column)
            column[at] = c;
        at++;
    }
    return at;
}

/* Pattern of P' A P; with column NULL it is only counted. */
static void fill_coarse_pattern(const mg_level *fine, mg_level *l, const uint32_t *first, const int32_t *list,
                                int32_t *mark) {
    for (size_t i = 0; i < l->n; i++)
        mark[i] = -1;
    uint32_t at = 0;
    for (size_t i = 0; i < l->n; i++) {
        int32_t self = (int32_t)i;
        l->first[i] = at;
        mark[i] = self;
        for (uint32_t f = first[i]; f < first[i + 1]; f++) {
            int32_t row = list[f];
            at = append_followed_columns(fine, row, self, mark, l->column, at);
            for (uint32_t k = fine->first[row]; k < fine->first[row + 1]; k++)
                at = append_followed_columns(fine, fine->column[k], self, mark, l->column, at);
        }
        if (l->column)
            qsort(l->column + l->first[i], at - l->first[i], sizeof *l->column, compare_node_indices);
    }
    l->first[l->n] = at;
}

static palp_status create_coarse_pattern(arena *memory, mg_level *fine, mg_level *l, const int32_t *number,
                                         size_t n_coarse) {
    arena scratch = {NULL, false};
    uint32_t *first;
    int32_t *list, *mark = arena_take(&scratch, n_coarse, sizeof *mark);
    l->n = n_coarse;
    l->first = arena_take(memory, n_coarse + 1, sizeof *l->first);
    l->axes = arena_take(memory, n_coarse, sizeof *l->axes);
    palp_status status = list_coarse_followers(&scratch, fine, n_coarse, &first, &list);
    if (!status && !memory->failed) {
        fill_coarse_pattern(fine, l, first, list, mark);
        l->column = arena_take(memory, l->first[l->n], sizeof *l->column);
    }
    if (memory->failed)
        status = PALP_ERR_NO_MEMORY;
    if (!status) {
        fill_coarse_pattern(fine, l, first, list, mark);
        for (size_t i = 0; i < fine->n; i++)
            if (number[i] >= 0)
                l->axes[number[i]] = fine->axes[i];
        status = allocate_level_arrays(memory, l, true);
    }
    arena_free(&scratch);
    return status;
}

static size_t count_unknowns_of_level(const mg_level *l) {
    size_t n = 0;
    for (size_t i = 0; i < 3 * l->n; i++)
        n += l->axes[i / 3] >> i % 3 & 1U;
    return n;
}

/* With more than direct unknowns: adds coarser levels until the factor is cheap or no unknowns are saved. x[3
 * n_nodes] is overwritten. */
static palp_status create_coarser_levels(multigrid *mg, size_t direct, double *x, int32_t *number) {
    const size_t coarsest =
        count_unknowns_of_level(&mg->level[0]) > direct && direct > COARSEST ? COARSEST : direct;
    mg->n_levels = 1;
    while (mg->n_levels < MULTIGRID_LEVELS &&
           count_unknowns_of_level(&mg->level[mg->n_levels - 1]) > coarsest) {
        mg_level *fine = &mg->level[mg->n_levels - 1];
        size_t n = choose_coarse_nodes(fine, number);
        if (n > fine->n * 3 / 4)
            break;
        palp_status status = create_interpolation(&mg->memory, fine, number, x);
        if (!status)
            status = create_coarse_pattern(&mg->memory, fine, fine + 1, number, n);
        if (status)
            return status;
        for (size_t i = 0; i < fine->n; i++)
            if (number[i] >= 0)
                memmove(x + 3 * (size_t)number[i], x + 3 * i, 3 * sizeof *x);
        mg->n_levels++;
    }
    return PALP_OK;
}

/* Lower triangle of the coarsest level by columns; only counts if row is NULL. */
static void fill_coarsest_pattern(const multigrid *mg, const mg_level *l, size_t *column, int32_t *row) {
    size_t nz = 0;
    for (size_t c = 0; c < 3 * l->n; c++) {
        if (mg->dof[c] < 0)
            continue;
        column[mg->dof[c]] = nz;
        for (uint32_t k = l->middle[c / 3]; k <= l->first[c / 3 + 1]; k++) {
            size_t j = k == l->middle[c / 3] ? c / 3 : (size_t)l->column[k - 1];
            for (size_t d = 3 * j; d < 3 * j + 3; d++) {
                if (mg->dof[d] < mg->dof[c])
                    continue;
                if (row)
                    row[nz] = mg->dof[d];
                nz++;
            }
        }
    }
    column[mg->n_direct] = nz;
}

static palp_status create_coarsest_solver(multigrid *mg) {
    const mg_level *l = &mg->level[mg->n_levels - 1];
    arena scratch = {NULL, false};
    int32_t *row = NULL;
    mg->dof = arena_take(&mg->memory, 3 * l->n, sizeof *mg->dof);
    size_t *column = arena_take(&scratch, 3 * l->n + 1, sizeof *column);
    palp_status status = mg->dof && column ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < 3 * l->n && !status; i++)
        mg->dof[i] = l->axes[i / 3] >> i % 3 & 1U ? (int32_t)mg->n_direct++ : -1;
    if (!status) {
        fill_coarsest_pattern(mg, l, column, NULL);
        row = arena_take(&scratch, column[mg->n_direct], sizeof *row);
        mg->rhs = arena_take(&mg->memory, mg->n_direct, sizeof *mg->rhs);
        status = row && mg->rhs ? PALP_OK : PALP_ERR_NO_MEMORY;
    }
    if (!status) {
        fill_coarsest_pattern(mg, l, column, row);
        for (size_t k = 0; k < 2 && !status; k++)
            status = linsys_create(PALP_SOLVER_BAND, mg->n_direct, column, row, &mg->factor[k]);
    }
    arena_free(&scratch);
    return status;
}

static palp_status allocate_work_arrays(multigrid *mg) {
    arena *memory = &mg->memory;
    for (size_t k = 0; k < 2; k++) {
        mg->element[k] = arena_take(memory, mg->n_floats, sizeof *mg->element[k]);
        mg->node[k] = arena_take(memory, 6 * mg->n_nodes, sizeof *mg->node[k]);
        mg->coupling[k] = arena_take(memory, MULTIGRID_COUPLINGS, sizeof *mg->coupling[k]);
    }
    mg->coupled = arena_take(memory, mg->n_nodes, sizeof *mg->coupled);
    mg->touched = arena_take(memory, 6 * mg->n_nodes, sizeof *mg->touched);
    mg->touching = arena_take(memory, MULTIGRID_COUPLINGS, sizeof *mg->touching);
    mg->first_touching = arena_take(memory, mg->n_nodes, sizeof *mg->first_touching);
    mg->patch = arena_take(memory, mg->n_nodes, sizeof *mg->patch);
    mg->patched = arena_take(memory, mg->n_nodes, sizeof *mg->patched);
    mg->rest = arena_take(memory, 4 * mg->n_nodes, sizeof *mg->rest);
    if (memory->failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < mg->n_nodes; i++)
        mg->first_touching[i] = -1;
    return PALP_OK;
}

palp_status multigrid_create(size_t n_nodes, const double *rest, const int32_t *dof, size_t n_elements,
                             const int32_t *pair, size_t direct, multigrid **out) {
    multigrid *mg = calloc(1, sizeof *mg);
    double *x = malloc((3 * n_nodes + 1) * sizeof *x);
    int32_t *number = malloc((n_nodes + 1) * sizeof *number);
    palp_status status = mg && x && number ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        mg->n_nodes = n_nodes;
        mg->n_elements = n_elements;
        memcpy(x, rest, 3 * n_nodes * sizeof *x);
        for (size_t i = 0; i < 3 * n_nodes; i++)
            mg->origin[i % 3] += rest[i] / (double)n_nodes;
        status = sort_elements_by_low_node(mg, pair);
    }
    if (!status)
        status = create_finest_level(mg, dof);
    if (!status)
        status = create_coarser_levels(mg, direct, x, number);
    if (!status)
        status = multigrid_make_products(mg);
    if (!status)
        status = create_coarsest_solver(mg);
    if (!status)
        status = allocate_work_arrays(mg);
    free(x);
    free(number);
    if (status)
        multigrid_free(mg);
    else
        *out = mg;
    return status;
}

static multigrid_source source_arrays_of_set(multigrid *mg, int set) {
    return (multigrid_source){mg->element[set], mg->place,         mg->spacing,           mg->n_floats,
                              mg->node[set],    mg->coupling[set], &mg->n_couplings[set], mg->between[set],
                              mg->beside[set],  mg->n_between,     mg->n_beside};
}

multigrid_source multigrid_input(multigrid *mg) {
    return source_arrays_of_set(mg, 1 - mg->used);
}

void multigrid_place_nodes(const multigrid *mg, const double *x, float *element) {
    const size_t across = mg->n_batches > 0 ? multigrid_stride(mg) : 1, along = mg->n_batches > 0 ? 1 : 4;
    float *to = element + mg->nodes;
    for (size_t i = 0; i < mg->n_nodes; i++)
        for (size_t c = 0; c < 3; c++)
            to[along * i + across * c] = (float)(x[3 * i + c] - mg->origin[c]);
}

float *multigrid_exchange(multigrid *mg, float *element) {
    float *former = mg->element[1 - mg->used];
    mg->element[1 - mg->used] = element;
    return former;
}

multigrid_source multigrid_used(multigrid *mg) {
    return source_arrays_of_set(mg, mg->used);
}

size_t multigrid_levels(const multigrid *mg) {
    return mg->n_levels;
}
