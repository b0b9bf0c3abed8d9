/* multigrid_product.c: the Galerkin products P' A P = S + S' with S = P' (D / 2 + L) P, A = D + L + L', row
 * by row of L. The destination of each number is found once, when the levels are made. */
#include "multigrid_internal.h"

/* Destination of a block of S: the coarse row's own block, with its transpose; or another block, transposed
 * if S has it behind the diagonal. */
static const uint32_t OWN = UINT32_MAX, TURNED = UINT32_C(1) << 31;

/* Columns of a row of (D / 2 + L) P. */
typedef struct places {
    int32_t *mark;   /* [n of the next level] position of each, or -1 */
    int32_t *column; /* [n] */
    size_t n;
} places;

/* Finds positions for the nodes that node j follows, into local unless NULL; returns their number. */
static size_t find_places_of_followed(const mg_level *l, size_t j, places *p, uint16_t *local) {
    const uint32_t first = l->up_first[j], n = l->up_first[j + 1] - first;
    for (uint32_t k = 0; k < n; k++) {
        const int32_t c = l->up[first + k];
        if (p->mark[c] < 0) {
            p->mark[c] = (int32_t)p->n;
            p->column[p->n++] = c;
        }
        if (local)
            local[k] = (uint16_t)p->mark[c];
    }
    return n;
}

/* Columns of row i, in the order in which they occur; returns the number of locals. */
static size_t find_places_of_row(const mg_level *l, size_t i, places *p, uint16_t *local) {
    p->n = 0;
    size_t n = find_places_of_followed(l, i, p, local);
    for (uint32_t k = l->first[i]; k < l->middle[i]; k++)
        n += find_places_of_followed(l, (size_t)l->column[k], p, local ? local + n : NULL);
    for (size_t k = 0; k < p->n; k++)
        p->mark[p->column[k]] = -1;
    return n;
}

/* Counts a level's locals and targets, and the longest row. */
static size_t count_locals_and_targets(const mg_level *l, places *p, size_t *locals, size_t *targets) {
    size_t longest = 0;
    *locals = *targets = 0;
    for (size_t i = 0; i < l->n; i++) {
        *locals += find_places_of_row(l, i, p, NULL);
        *targets += (l->up_first[i + 1] - l->up_first[i]) * p->n;
        longest = p->n > longest ? p->n : longest;
    }
    return longest;
}

static uint32_t find_target_block(const mg_level *coarse, int32_t row, int32_t column) {
    if (row == column)
        return OWN;
    const int32_t low = row < column ? row : column, high = row < column ? column : row;
    return (coarse->low_first[high] + multigrid_entry(coarse, high, low) - coarse->first[high]) |
           (row < column ? TURNED : 0);
}

static void list_locals_and_targets(mg_level *l, const mg_level *coarse, places *p) {
    uint32_t local = 0, target = 0;
    for (size_t i = 0; i < l->n; i++) {
        l->local_first[i] = local;
        l->target_first[i] = target;
        local += (uint32_t)find_places_of_row(l, i, p, l->local + local);
        for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++)
            for (size_t j = 0; j < p->n; j++)
                l->target[target++] = find_target_block(coarse, l->up[k], p->column[j]);
    }
    l->local_first[l->n] = local;
    l->target_first[l->n] = target;
}

static palp_status create_product_tables(arena *memory, mg_level *l, const mg_level *coarse,
                                         size_t *longest) {
    arena scratch = {NULL, false};
    size_t locals, targets;
    places p = {arena_take(&scratch, coarse->n, sizeof *p.mark),
                arena_take(&scratch, coarse->n, sizeof *p.column), 0};
    for (size_t i = 0; i < coarse->n && !scratch.failed; i++)
        p.mark[i] = -1;
    const size_t row = scratch.failed ? 0 : count_locals_and_targets(l, &p, &locals, &targets);
    const bool large = row > UINT16_MAX || targets >= OWN || coarse->low_first[coarse->n] >= TURNED;
    palp_status status = scratch.failed ? PALP_ERR_NO_MEMORY : large ? PALP_ERR_LIMIT : PALP_OK;
    if (!status) {
        l->local_first = arena_take(memory, l->n + 1, sizeof *l->local_first);
        l->target_first = arena_take(memory, l->n + 1, sizeof *l->target_first);
        l->local = arena_take(memory, locals, sizeof *l->local);
        l->target = arena_take(memory, targets, sizeof *l->target);
        *longest = row > *longest ? row : *longest;
        if (memory->failed)
            status = PALP_ERR_NO_MEMORY;
        else
            list_locals_and_targets(l, coarse, &p);
    }
    arena_free(&scratch);
    return status;
}

palp_status multigrid_make_products(multigrid *mg) {
    size_t longest = 1;
    for (size_t k = 0; k + 1 < mg->n_levels; k++) {
        palp_status status = create_product_tables(&mg->memory, &mg->level[k], &mg->level[k + 1], &longest);
        if (status)
            return status;
    }
    mg->row = arena_take(&mg->memory, BLOCK_FLOATS * longest, sizeof *mg->row);
    return mg->row ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* b += the further block between nodes i and j, joined by the k-th sorted element; free axes only. */
static void add_further_block(const multigrid *mg, size_t i, size_t j, uint32_t k, float *b) {
    const unsigned row = mg->level[0].axes[i], column = mg->level[0].axes[j];
    float block[BLOCK_FLOATS];
    multigrid_between(mg, 1 - mg->used, i, j, k, block);
    for (unsigned at = 0; at < BLOCK_FLOATS; at++)
        if (row >> at % 4 & column >> at / 4 & 1U)
            b[at] += block[at];
}

/* b += the couplings between nodes i and j; free axes only. */
static void add_couplings_of_pair(const multigrid *mg, size_t i, size_t j, float *b) {
    const mg_level *l = &mg->level[0];
    const multigrid_coupling *list = mg->coupling[1 - mg->used];
    for (int32_t k = mg->coupled[i < j ? i : j]; k >= 0; k = list[k].next)
        for (unsigned r = 0; r < 3 && list[k].high == (int32_t)(i < j ? j : i); r++)
            for (unsigned c = 0; c < 3; c++)
                if (l->axes[i] >> r & l->axes[j] >> c & 1U)
                    b[4 * c + r] += i < j ? list[k].block[3 * r + c] : list[k].block[3 * c + r];
}

const float *multigrid_entry_block(const multigrid *mg, const mg_level *l, size_t i, uint32_t k,
                                   float *room) {
    if (l != mg->level)
        return l->block[1 - mg->used] + multigrid_low(l, i, k);
    float e[5];
    const size_t j = (size_t)l->column[k];
    multigrid_element(mg, mg->element[1 - mg->used], i < j ? i : j, mg->through[k], e);
    const multigrid_four d = {e[0], e[1], e[2], 0.0F}, rows = multigrid_load(MULTIGRID_FREE[l->axes[i]]);
    for (size_t c = 0; c < 3; c++) {
        multigrid_four column = multigrid_all(-e[3] * e[c]) * d;
        column[c] -= e[4];
        multigrid_store(room + 4 * c, multigrid_all(MULTIGRID_FREE[l->axes[j]][c]) * rows * column);
    }
    if (multigrid_has_between(mg, 1 - mg->used))
        add_further_block(mg, i, j, mg->through[k], room);
    if (mg->n_couplings[1 - mg->used] > 0)
        add_couplings_of_pair(mg, i, j, room);
    return room;
}

/* to += factor times a block. */
static inline void add_scaled_block(float *to, float factor, const float *block) {
    const multigrid_four w = multigrid_all(factor);
    for (size_t c = 0; c < BLOCK_FLOATS; c += 4)
        multigrid_store(to + c, multigrid_load(to + c) + w * multigrid_load(block + c));
}

/* to += factor times the transpose of a block. */
static inline void add_scaled_transpose(float *to, float factor, const float *b) {
    const multigrid_four w = multigrid_all(factor);
    for (size_t c = 0; c < 3; c++)
        multigrid_store(to + 4 * c,
                        multigrid_load(to + 4 * c) + w * (multigrid_four){b[c], b[4 + c], b[8 + c], 0.0F});
}

/* row += factor times block times the weights of node j. */
static inline const uint16_t *spread_block_by_weights(float *row, const mg_level *l, size_t j, float factor,
                                                      const float *block, const uint16_t *local) {
    for (uint32_t k = l->up_first[j]; k < l->up_first[j + 1]; k++)
        add_scaled_block(row + (size_t)BLOCK_FLOATS * *local++, factor * l->weight[k], block);
    return local;
}

size_t multigrid_coarsen(multigrid *mg, size_t level, size_t i) {
    mg_level *l = &mg->level[level], *coarse = l + 1;
    const int set = 1 - mg->used;
    const uint32_t ups = l->up_first[i + 1] - l->up_first[i], *target = l->target + l->target_first[i];
    const size_t n = ups > 0 ? (l->target_first[i + 1] - l->target_first[i]) / ups : 0;
    const uint16_t *local = l->local + l->local_first[i];
    float room[BLOCK_FLOATS];
    memset(mg->row, 0, BLOCK_FLOATS * n * sizeof *mg->row);
    local = spread_block_by_weights(mg->row, l, i, 0.5F, l->own[set] + BLOCK_FLOATS * i, local);
    for (uint32_t k = l->first[i]; k < l->middle[i]; k++)
        local = spread_block_by_weights(mg->row, l, (size_t)l->column[k], 1.0F,
                                        multigrid_entry_block(mg, l, i, k, room), local);
    for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++)
        for (size_t j = 0; j < n; j++, target++) {
            const bool own = *target == OWN;
            float *to = own ? coarse->own[set] + BLOCK_FLOATS * l->up[k]
                            : coarse->block[set] + (size_t)BLOCK_FLOATS * (*target & ~TURNED);
            if (own || !(*target & TURNED))
                add_scaled_block(to, l->weight[k], mg->row + BLOCK_FLOATS * j);
            if (own || *target & TURNED)
                add_scaled_transpose(to, l->weight[k], mg->row + BLOCK_FLOATS * j);
        }
    return n;
}
