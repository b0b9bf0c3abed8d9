/* realtime_refresh.c: makes the next factor from the tangent's blocks, a piece in each tick or in a thread,
 * while the present one is in use. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

/* Work units per element for which a factor is left as it is, to save time in the ticks. */
static const double PAUSE = 1.0;

static void copy_element_block(const palp_network *net, float *element, const multigrid_source *source,
                               size_t i) {
    float *e = element + source->place[i];
    const double inverse = net->inverse_length[i], across = net->force[i] * inverse;
    e[0] = (float)((net->tangent[i] * net->inverse_rest[i] - across) * (inverse * inverse));
    e[source->spacing] = (float)across;
}

/* Destination of the blocks of terms. */
typedef struct gathering {
    double *node;           /* [6 n_nodes] own blocks, lower triangle by rows */
    multigrid_coupling *to; /* [MULTIGRID_COUPLINGS] */
    size_t n;
} gathering;

/* Adds k, or its transpose, to a node's own block. */
static void add_to_diagonal_block(double *block, const double k[9], bool turn) {
    static const int lower[6] = {0, 3, 4, 6, 7, 8}, upper[6] = {0, 1, 4, 2, 5, 8};
    for (int i = 0; i < 6; i++)
        block[i] += k[turn ? upper[i] : lower[i]];
}

/* Couplings beyond the room for them are lumped into the own blocks. */
static void take_block_as_coupling(void *user, int32_t row, int32_t column, const double k[9]) {
    gathering *g = user;
    bool full = g->n == MULTIGRID_COUPLINGS, turn = row > column;
    if (row == column || full)
        add_to_diagonal_block(g->node + 6 * row, k, false);
    if (row == column)
        return;
    if (full) {
        add_to_diagonal_block(g->node + 6 * column, k, true);
        return;
    }
    multigrid_coupling *c = &g->to[g->n++];
    c->low = turn ? column : row;
    c->high = turn ? row : column;
    for (size_t i = 0; i < 9; i++)
        c->block[i] = (float)k[turn ? 3 * (i % 3) + i / 3 : i];
}

bool realtime_touches(const network_term *term) {
    return term->kind->blocks && !term->kind->blocks_part;
}

/* What terms add to the tangent of the last evaluation: own blocks into net->node_block, couplings into to.
 * Returns the number of couplings. */
static size_t gather_blocks_of_terms(palp_network *net, multigrid_coupling *to) {
    gathering g = {net->node_block, to, 0};
    memset(g.node, 0, 6 * net->n_nodes * sizeof *g.node);
    for (size_t i = 0; i < net->n_nodes; i++) {
        g.node[6 * i] = net->diagonal[3 * i];
        g.node[6 * i + 2] = net->diagonal[3 * i + 1];
        g.node[6 * i + 5] = net->diagonal[3 * i + 2];
    }
    for (size_t i = 0; i < net->n_terms; i++)
        if (realtime_touches(net->terms[i]))
            net->terms[i]->kind->blocks(net->terms[i], net, take_block_as_coupling, &g);
    NETWORK_EACH_TERM(net, far_blocks, net, take_block_as_coupling, &g);
    return g.n;
}

static void take_further_block(void *user, int32_t row, int32_t column, const double k[9]) {
    multigrid_add_block(user, row, column, k);
}

/* Adds one part of the blocks of terms on all nodes to the next factor. Parts may come from different
 * ticks. */
static void gather_further_blocks(palp_realtime *rt, size_t part, size_t parts) {
    const palp_network *net = rt->net;
    if (part == 0)
        multigrid_clear_blocks(rt->mg);
    for (size_t i = 0; i < net->n_terms; i++)
        if (net->terms[i]->kind->blocks_part)
            net->terms[i]->kind->blocks_part(net->terms[i], net, part, parts, take_further_block, rt->mg);
}

static void copy_nodal_blocks(palp_network *net, const multigrid_source *source) {
    *source->n_couplings = (int32_t)gather_blocks_of_terms(net, source->coupling);
    for (size_t i = 0; i < 6 * net->n_nodes; i++)
        source->node[i] = (float)net->node_block[i];
}

bool realtime_touched(const palp_network *net) {
    bool any = false;
    for (size_t i = 0; i < net->n_terms; i++)
        any = any || realtime_touches(net->terms[i]);
    return any;
}

void realtime_touch(palp_realtime *rt) {
    if (realtime_touched(rt->net))
        multigrid_touch(rt->mg, rt->net->node_block, gather_blocks_of_terms(rt->net, rt->touching),
                        rt->touching);
}

palp_status realtime_refresh_now(palp_realtime *rt) {
    palp_network *net = rt->net;
    multigrid_source source = multigrid_input(rt->mg);
    bool done = false;
    palp_status status = PALP_ERR_SINGULAR;
    copy_nodal_blocks(net, &source);
    if (rt->spread > 0.0)
        gather_further_blocks(rt, 0, 1);
    for (size_t i = 0; i < net->n_elements; i++)
        copy_element_block(net, rt->element, &source, i);
    multigrid_place_nodes(rt->mg, net->next.x, rt->element);
    memcpy(source.element, rt->element, source.n_floats * sizeof *rt->element);
    for (int definite = 0; definite < 2 && status == PALP_ERR_SINGULAR; definite++) {
        multigrid_begin(rt->mg, definite);
        status = multigrid_advance(rt->mg, INFINITY, &done);
        while (!status && !done)
            status = multigrid_advance(rt->mg, INFINITY, &done);
        rt->used_definite = definite;
    }
    if (!status)
        multigrid_swap(rt->mg);
    rt->stage = REFRESH_DUE;
    rt->at = rt->gathered = 0;
    return status;
}

/* Begins the next factor with the elements of the last evaluation. */
static void begin_next_factor(palp_realtime *rt) {
    const multigrid_source source = multigrid_input(rt->mg);
    rt->element = multigrid_exchange(rt->mg, rt->element);
    copy_nodal_blocks(rt->net, &source);
    multigrid_begin(rt->mg, rt->definite);
    rt->stage = REFRESH_MAKE;
    rt->at = rt->gathered = 0;
    if (rt->thread)
        refresh_thread_start(rt->thread);
}

/* If the tangent was not positive definite, starts again with its positive definite part. */
static bool finish_or_retry_factor(palp_realtime *rt, palp_status status) {
    rt->at = 0;
    if (status && !rt->definite) {
        rt->definite = true;
        multigrid_begin(rt->mg, true);
        if (rt->thread)
            refresh_thread_start(rt->thread);
        return false;
    }
    bool definite = rt->definite;
    rt->definite = false;
    rt->stage = REFRESH_DUE;
    if (status)
        return false;
    multigrid_swap(rt->mg);
    rt->used_definite = definite;
    rt->adjoint_due = rt->adjoint_parts;
    return true;
}

bool realtime_refresh_begins(const palp_realtime *rt) {
    return rt->stage == REFRESH_DUE && (rt->gathered == REALTIME_PARTS || rt->spread == 0.0) &&
           (double)(rt->at + 1) * rt->piece >= PAUSE * (double)rt->net->n_elements;
}

/* Waits until the next factor is due. */
static void wait_for_next_factor(palp_realtime *rt) {
    rt->at++;
    if (rt->spread > 0.0 && rt->gathered < REALTIME_PARTS)
        gather_further_blocks(rt, rt->gathered++, REALTIME_PARTS);
}

bool realtime_refresh(palp_realtime *rt) {
    palp_status status;
    bool done = false;
    if (rt->stage == REFRESH_DUE) {
        if (realtime_refresh_begins(rt))
            begin_next_factor(rt);
        else
            wait_for_next_factor(rt);
        return false;
    }
    if (rt->thread) {
        done = refresh_thread_done(rt->thread, &status);
    } else {
        rt->at++;
        status = multigrid_advance(rt->mg, rt->piece, &done);
    }
    return (done || status) && finish_or_retry_factor(rt, status);
}
