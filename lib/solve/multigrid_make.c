/* multigrid_make.c: numbers of a set: blocks of the finest level from elements, Galerkin products, the
 * factor. They are made in pieces, so that a tick may do a part. Also updates contacts of the set in use. */
#include "multigrid_internal.h"

#include <math.h>
#include <string.h>

/* Work units of some nanoseconds each: */
static const double ROW_WORK = 6.0;     /* inverting an own block or clearing a block */
static const double ELEMENT_WORK = 3.0; /* both blocks of an element */
static const double ENTRY_WORK = 20.0;  /* an entry of a row of P' A P */
static const double FLOP_WORK = 0.025;  /* a flop of a factor */
static const double VALUE_WORK = 0.08;  /* clearing one value of a factor */
static const double FILL_WORK = 14.0;   /* adding a block to a factor's values */

static const float STIFF = 0.2F; /* share of a node's own block above which contacts put it into the patch */

static int set_being_made(const multigrid *mg) {
    return 1 - mg->used;
}

/* Does the pattern have an entry for this coupling? */
static bool has_coupling_an_entry(const multigrid *mg, const multigrid_coupling *c) {
    const mg_level *l = &mg->level[0];
    return l->first[c->low] < l->first[c->low + 1] &&
           l->column[multigrid_entry(l, c->low, c->high)] == c->high;
}

void multigrid_begin(multigrid *mg, bool definite) {
    const int set = set_being_made(mg);
    mg->definite[set] = definite;
    mg->stage = MG_CLEAR;
    mg->at_level = mg->at = 0;
    for (size_t i = 0; i < mg->n_nodes; i++)
        mg->coupled[i] = -1;
    for (int32_t k = 0; k < mg->n_couplings[set]; k++) {
        multigrid_coupling *c = &mg->coupling[set][k];
        if (!has_coupling_an_entry(mg, c))
            continue;
        c->next = mg->coupled[c->low];
        mg->coupled[c->low] = k;
    }
}

/* b (three columns of four) += factor times the symmetric s (lower triangle by rows), free axes only. */
static void add_symmetric_block(float *b, const float s[6], float factor, unsigned row, unsigned column) {
    static const int at[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
    for (unsigned c = 0; c < 3; c++)
        for (unsigned r = 0; r < 3; r++)
            if (row >> r & 1U && column >> c & 1U)
                b[4 * c + r] += factor * s[at[r][c]];
}

static void clear_blocks_of_row(multigrid *mg, size_t level, size_t i) {
    mg_level *l = &mg->level[level];
    memset(l->own[set_being_made(mg)] + BLOCK_FLOATS * i, 0, BLOCK_FLOATS * sizeof(float));
    if (level > 0)
        memset(l->block[set_being_made(mg)] + multigrid_low(l, i, l->first[i]), 0,
               BLOCK_FLOATS * (l->middle[i] - l->first[i]) * sizeof(float));
}

/* Lower triangle by rows of along d d' + across 1. */
static void lower_block_of_element(const float *e, float s[6]) {
    float p0 = e[3] * e[0], p1 = e[3] * e[1];
    s[0] = p0 * e[0] + e[4];
    s[1] = p0 * e[1];
    s[2] = p1 * e[1] + e[4];
    s[3] = p0 * e[2];
    s[4] = p1 * e[2];
    s[5] = e[3] * e[2] * e[2] + e[4];
}

/* Adds the elements from node i to higher ones to the own blocks of both ends. */
static void add_elements_of_node(multigrid *mg, size_t i) {
    mg_level *l = &mg->level[0];
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
        float *stored = mg->element[set_being_made(mg)] + mg->slot[k], e[5], s[6];
        const int32_t j = mg->high[k];
        multigrid_element(mg, mg->element[set_being_made(mg)], i, k, e);
        if (mg->definite[set_being_made(
                mg)]) { /* leaves out compression, and a negative stiffness along the element */
            const float square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
            stored[mg->spacing] = e[4] = e[4] > 0.0F ? e[4] : 0.0F;
            stored[0] = e[3] = e[3] * square + e[4] > 0.0F ? e[3] : -e[4] / square;
        }
        lower_block_of_element(e, s);
        add_symmetric_block(l->own[set_being_made(mg)] + BLOCK_FLOATS * i, s, 1.0F, l->axes[i], l->axes[i]);
        add_symmetric_block(l->own[set_being_made(mg)] + BLOCK_FLOATS * j, s, 1.0F, l->axes[j], l->axes[j]);
    }
}

static void add_own_block_of_node(multigrid *mg, size_t i) {
    mg_level *l = &mg->level[0];
    add_symmetric_block(l->own[set_being_made(mg)] + BLOCK_FLOATS * i, mg->node[set_being_made(mg)] + 6 * i,
                        1.0F, l->axes[i], l->axes[i]);
    if (multigrid_has_between(mg, set_being_made(mg)))
        add_symmetric_block(l->own[set_being_made(mg)] + BLOCK_FLOATS * i,
                            mg->beside[set_being_made(mg)] + 6 * i, 1.0F, l->axes[i], l->axes[i]);
}

/* Clears what is not between free axes in a block. */
static void clear_fixed_axes_of_block(float *b, unsigned row, unsigned column) {
    for (unsigned c = 0; c < 3 && (row & column) != 7U; c++)
        for (unsigned r = 0; r < 3; r++)
            b[4 * c + r] = row >> r & column >> c & 1U ? b[4 * c + r] : 0.0F;
}

/* Inverse of the free part of own block b of row i. False, and unchanged, if not positive definite. */
static bool invert_free_diagonal_block(mg_level *l, int set, size_t i, const float *b) {
    float *inverse = l->inverse[set] + BLOCK_FLOATS * i;
    double a[3][3];
    for (unsigned r = 0; r < 3; r++)
        for (unsigned c = 0; c < 3; c++)
            a[r][c] = l->axes[i] >> r & l->axes[i] >> c & 1U ? (double)b[4 * c + r] : r == c ? 1.0 : 0.0;
    double c00 = a[1][1] * a[2][2] - a[1][2] * a[1][2], c01 = a[0][2] * a[1][2] - a[0][1] * a[2][2];
    double c02 = a[0][1] * a[1][2] - a[0][2] * a[1][1],
           determinant = a[0][0] * c00 + a[0][1] * c01 + a[0][2] * c02;
    double minor = a[0][0] * a[1][1] - a[0][1] * a[0][1];
    if (!(a[0][0] > 0.0) || !(minor > 0.0) || !(determinant > 0.0) || isinf(determinant))
        return false;
    double inv[3][3] = {{c00, c01, c02},
                        {c01, a[0][0] * a[2][2] - a[0][2] * a[0][2], a[0][1] * a[0][2] - a[0][0] * a[1][2]},
                        {c02, a[0][1] * a[0][2] - a[0][0] * a[1][2], minor}};
    for (unsigned r = 0; r < 3; r++)
        for (unsigned c = 0; c < 3; c++)
            inverse[4 * c + r] =
                l->axes[i] >> r & l->axes[i] >> c & 1U ? (float)(inv[r][c] / determinant) : 0.0F;
    return true;
}

/* b[12]: the own block i that sweeps invert. With several levels, own further blocks of the finest level
 * count more. Together they reach spread times their own blocks, elements only twice, and damped Jacobi must
 * stay a contraction. */
static void block_of_sweep(const multigrid *mg, const mg_level *l, int set, size_t i, float *b) {
    memcpy(b, l->own[set] + BLOCK_FLOATS * i, BLOCK_FLOATS * sizeof *b);
    if (l == mg->level && mg->n_levels > 1 && multigrid_has_between(mg, set))
        add_symmetric_block(b, mg->beside[set] + 6 * i, (float)(0.375 * mg->spread - 1.0), l->axes[i],
                            l->axes[i]);
}

static bool invert_diagonal_of_row(multigrid *mg, mg_level *l, size_t i) {
    const int set = set_being_made(mg);
    float b[BLOCK_FLOATS];
    clear_fixed_axes_of_block(l->own[set] + BLOCK_FLOATS * i, l->axes[i],
                              l->axes[i]); /* of a coarse row: its own block is a sum over its followers */
    for (uint32_t k = l->first[i]; l != mg->level && k < l->middle[i]; k++)
        clear_fixed_axes_of_block(l->block[set] + multigrid_low(l, i, k), l->axes[i], l->axes[l->column[k]]);
    block_of_sweep(mg, l, set, i, b);
    return invert_free_diagonal_block(l, set, i, b);
}

/* Clears a row's share of the factor's values; returns work units. */
static double clear_share_of_values(multigrid *mg, size_t i) {
    linsys *ls = mg->factor[set_being_made(mg)];
    const size_t n = mg->level[mg->n_levels - 1].n, count = linsys_value_count(ls), from = count * i / n,
                 to = count * (i + 1) / n;
    if (i == 0)
        linsys_begin(ls);
    memset(linsys_values(ls) + from, 0, (to - from) * sizeof(double));
    return VALUE_WORK * (double)(to - from) + 1.0;
}

/* Adds row i of the coarsest level to the cleared values, lower triangle by columns; returns work units. */
static double fill_row_of_coarsest(multigrid *mg, size_t i) {
    const mg_level *l = &mg->level[mg->n_levels - 1];
    linsys *ls = mg->factor[set_being_made(mg)];
    double *value = linsys_values(ls);
    float room[BLOCK_FLOATS];
    for (uint32_t k = l->first[i]; k <= l->middle[i]; k++) {
        const bool own = k == l->middle[i];
        const size_t j = own ? i : (size_t)l->column[k];
        const float *b =
            own ? l->own[set_being_made(mg)] + BLOCK_FLOATS * i : multigrid_entry_block(mg, l, i, k, room);
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++) {
                int32_t p = mg->dof[3 * i + r], q = mg->dof[3 * j + c];
                if (q >= 0 && p >= q)
                    value[linsys_slot(ls, (size_t)p, (size_t)q)] = (double)b[4 * c + r];
            }
    }
    return FILL_WORK * (double)(l->middle[i] + 1 - l->first[i]);
}

static palp_status advance_coarsest_factor(multigrid *mg, double work, bool *done) {
    int negative;
    palp_status status = linsys_advance(mg->factor[set_being_made(mg)], work / FLOP_WORK, &negative, done);
    return !status && *done && negative > 0 ? PALP_ERR_SINGULAR : status;
}

/* Goes to the next stage, or to the next level in the same stage. */
static void go_to_next_stage(multigrid *mg) {
    size_t last = mg->n_levels - 1;
    mg->at = 0;
    if (mg->stage == MG_CLEAR && mg->at_level < last)
        mg->at_level++;
    else if (mg->stage == MG_COARSEN && ++mg->at_level < last)
        mg->stage = MG_INVERT;
    else if (mg->stage == MG_NODES && last == 0)
        mg->stage = MG_FILL;
    else {
        mg->at_level = mg->stage == MG_COARSEN ? last : mg->stage == MG_CLEAR ? 0 : mg->at_level;
        mg->stage++;
    }
}

/* One item of the present stage. Returns work units, 0 if the stage is over, below 0 if not positive
 * definite. */
static double process_one_stage_item(multigrid *mg) {
    size_t i = mg->at++;
    mg_level *l = &mg->level[mg->at_level];
    switch (mg->stage) {
    case MG_CLEAR:
        return i < l->n ? (clear_blocks_of_row(mg, mg->at_level, i), ROW_WORK) : 0.0;
    case MG_ELEMENTS:
        return i < l->n
                   ? (add_elements_of_node(mg, i), ELEMENT_WORK * (1.0 + mg->after[i + 1] - mg->after[i]))
                   : 0.0;
    case MG_NODES:
        return i < mg->n_nodes ? (add_own_block_of_node(mg, i), ROW_WORK) : 0.0;
    case MG_INVERT:
        return i < l->n ? (invert_diagonal_of_row(mg, l, i) ? ROW_WORK : -1.0) : 0.0;
    case MG_COARSEN:
        return i < l->n ? ENTRY_WORK * (double)multigrid_coarsen(mg, mg->at_level, i) : 0.0;
    default:
        return i < l->n       ? clear_share_of_values(mg, i)
               : i < 2 * l->n ? fill_row_of_coarsest(mg, i - l->n)
                              : 0.0;
    }
}

palp_status multigrid_advance(multigrid *mg, double work, bool *done) {
    palp_status status = PALP_OK;
    *done = mg->stage == MG_DONE;
    while (work > 0.0 && !status && mg->stage != MG_DONE && mg->stage != MG_IDLE) {
        if (mg->stage == MG_FACTOR) {
            status = advance_coarsest_factor(mg, work, done);
            mg->stage = *done ? MG_DONE : MG_FACTOR;
            break;
        }
        double spent = process_one_stage_item(mg);
        if (spent < 0.0)
            status = PALP_ERR_SINGULAR;
        else if (spent == 0.0)
            go_to_next_stage(mg);
        work -= spent;
    }
    if (status)
        mg->stage = MG_IDLE;
    return status;
}

/* Replaces the couplings of the set in use. */
static void replace_touching_couplings(multigrid *mg, size_t n, const multigrid_coupling *coupling) {
    for (int32_t k = 0; k < mg->n_touching; k++)
        mg->first_touching[mg->touching[k].low] = -1;
    memcpy(mg->touching, coupling, n * sizeof *coupling);
    mg->n_touching = (int32_t)n;
    for (int32_t k = 0; k < mg->n_touching; k++) {
        mg->touching[k].next = mg->first_touching[mg->touching[k].low];
        mg->first_touching[mg->touching[k].low] = k;
    }
}

/* Finds the nodes of the set in use that have couplings or stiff contacts. */
static void find_patched_nodes(multigrid *mg) {
    const float *own = mg->level[0].own[mg->used], *touched = mg->touched;
    for (size_t i = 0; i < mg->n_nodes; i++, own += BLOCK_FLOATS, touched += 6)
        mg->patched[i] = touched[0] + touched[2] + touched[5] > STIFF * (own[0] + own[5] + own[10]);
    for (int32_t k = 0; k < mg->n_touching; k++)
        mg->patched[mg->touching[k].low] = mg->patched[mg->touching[k].high] = true;
    mg->n_patch = 0;
    for (size_t i = 0; i < mg->n_nodes; i++)
        if (mg->patched[i])
            mg->patch[mg->n_patch++] = (int32_t)i;
}

void multigrid_touch(multigrid *mg, const double *node, size_t n, const multigrid_coupling *coupling) {
    mg_level *l = &mg->level[0];
    if (mg->n_levels == 1)
        return;
    replace_touching_couplings(mg, n, coupling);
    for (size_t i = 0; i < l->n; i++) {
        float *now = mg->touched + 6 * i, change[6], b[BLOCK_FLOATS];
        bool changed = false;
        for (size_t k = 0; k < 6; k++) {
            changed = changed || now[k] != (float)node[6 * i + k];
            now[k] = (float)node[6 * i + k];
            change[k] = now[k] - mg->node[mg->used][6 * i + k];
        }
        if (!changed)
            continue;
        block_of_sweep(mg, l, mg->used, i, b);
        add_symmetric_block(b, change, 1.0F, l->axes[i], l->axes[i]);
        invert_free_diagonal_block(l, mg->used, i, b);
    }
    find_patched_nodes(mg);
}

void multigrid_swap(multigrid *mg) {
    mg->used = set_being_made(mg);
    mg->stage = MG_IDLE;
    memcpy(mg->touched, mg->node[mg->used], 6 * mg->n_nodes * sizeof *mg->touched);
    replace_touching_couplings(mg, (size_t)mg->n_couplings[mg->used], mg->coupling[mg->used]);
    find_patched_nodes(mg);
}
