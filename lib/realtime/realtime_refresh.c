/* realtime_refresh.c: making the next factor while the present one serves, some of it in every tick. */
#include "realtime_internal.h"

#include <math.h>

static const double COPY_WORK = 1.5; /* units an element */

static void copy_element(const palp_network *net, const multigrid_source *source, size_t i) {
    float *e = source->element + 5 * (size_t)source->place[i];
    double across = net->force[i] * net->inverse_length[i];
    for (size_t k = 0; k < 3; k++)
        e[k] = (float)net->direction[3 * i + k];
    e[3] = (float)(net->tangent[i] * net->inverse_rest[i] - across);
    e[4] = (float)across;
}

/* Own blocks and couplings of the last evaluation, the former in net->node_block. */
static size_t gather_blocks(palp_network *net, multigrid_coupling *to) {
    load_coupling *from = net->realtime->coupling;
    size_t n = network_node_blocks(net, net->node_block, MULTIGRID_COUPLINGS, from);
    for (size_t k = 0; k < n; k++, to++) {
        bool turn = from[k].row > from[k].column;
        to->low = turn ? from[k].column : from[k].row;
        to->high = turn ? from[k].row : from[k].column;
        for (size_t i = 0; i < 9; i++)
            to->block[i] = (float)from[k].block[turn ? 3 * (i % 3) + i / 3 : i];
    }
    return n;
}

static void copy_nodes(palp_network *net, const multigrid_source *source) {
    *source->n_couplings = (int32_t)gather_blocks(net, source->coupling);
    for (size_t i = 0; i < 6 * net->n_nodes; i++)
        source->node[i] = (float)net->node_block[i];
}

void realtime_touch(palp_network *net) {
    network_realtime *rt = net->realtime;
    if (net->load)
        multigrid_touch(rt->mg, net->node_block, gather_blocks(net, rt->touching), rt->touching);
}

palp_status realtime_refresh_now(palp_network *net) {
    network_realtime *rt = net->realtime;
    multigrid_source source = multigrid_input(rt->mg);
    bool done = false;
    palp_status status = PALP_ERR_SINGULAR;
    copy_nodes(net, &source);
    for (size_t i = 0; i < net->n_elements; i++)
        copy_element(net, &source, i);
    for (int definite = 0; definite < 2 && status == PALP_ERR_SINGULAR; definite++) {
        multigrid_begin(rt->mg, definite);
        status = multigrid_advance(rt->mg, INFINITY, &done);
        while (!status && !done)
            status = multigrid_advance(rt->mg, INFINITY, &done);
        rt->used_definite = definite;
    }
    if (!status)
        multigrid_swap(rt->mg);
    rt->stage = REFRESH_COPY;
    rt->at = 0;
    return status;
}

/* Copies elements, and at their end begins the making. */
static void copy_some(palp_network *net, double work) {
    network_realtime *rt = net->realtime;
    multigrid_source source = multigrid_input(rt->mg);
    for (; rt->at < net->n_elements && work > 0.0; work -= COPY_WORK)
        copy_element(net, &source, rt->at++);
    if (rt->at < net->n_elements)
        return;
    copy_nodes(net, &source);
    multigrid_begin(rt->mg, rt->definite);
    rt->stage = REFRESH_MAKE;
    rt->at = 0;
    if (rt->thread)
        refresh_thread_start(rt->thread);
}

/* Where the tangent was not positive definite, once more with what is left of it that is. */
static bool finish(palp_network *net, palp_status status) {
    network_realtime *rt = net->realtime;
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
    rt->stage = REFRESH_COPY;
    if (status)
        return false;
    multigrid_swap(rt->mg);
    rt->used_definite = definite;
    rt->adjoint_due = 1;
    return true;
}

bool realtime_refresh(palp_network *net) {
    network_realtime *rt = net->realtime;
    palp_status status;
    bool done = false;
    if (rt->stage == REFRESH_COPY) {
        copy_some(net, rt->piece);
        return false;
    }
    if (rt->thread) {
        done = refresh_thread_done(rt->thread, &status);
    } else {
        rt->at++;
        status = multigrid_advance(rt->mg, rt->piece, &done);
    }
    return (done || status) && finish(net, status);
}
