/* realtime_state.c: the whole state of a network into a buffer and back. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

typedef enum way { COUNT, SAVE, RESTORE } way;

typedef struct cursor {
    way way;
    unsigned char *at; /* NULL when counting */
    size_t bytes;
} cursor;

/* What must be the same in the network that saves and in the one that restores. */
typedef struct header {
    uint64_t magic, n_nodes, n_elements, n_arms, n_free, load_size, bytes;
    uint64_t mass, peak, vector, cut, realtime;
} header;

static void pass(cursor *c, void *data, size_t bytes) {
    if (c->way == SAVE)
        memcpy(c->at, data, bytes);
    else if (c->way == RESTORE)
        memcpy(data, c->at, bytes);
    if (c->at)
        c->at += bytes;
    c->bytes += bytes;
}

static void pass_state(palp_network *net, cursor *c) {
    network_state *s = &net->now;
    const size_t n3 = 3 * net->n_nodes * sizeof(double), m = net->n_elements * sizeof(double);
    void *arrays[] = {s->x, s->inner, s->velocity, s->acceleration, s->element, s->history.strain, s->history.elastic,
                      s->history.arm, s->history.peak, s->vector, s->load, net->past[0], net->past[1]};
    const size_t bytes[] = {n3, n3, n3, n3, m, m, m, m * net->material.n_arms, m, 3 * m, net->load_size, n3, n3};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (arrays[i])
            pass(c, arrays[i], bytes[i]);
    double *numbers[] = {&s->depth, &s->time, &s->force, &net->past_depth[0], &net->past_depth[1], &net->past_time[0],
                         &net->past_time[1], &net->checked_depth, &net->unstable_depth};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        pass(c, numbers[i], sizeof(double));
    pass(c, &net->n_past, sizeof net->n_past);
    pass(c, &net->buckled, sizeof net->buckled);
}

static void pass_cuts(palp_network *net, cursor *c) {
    if (c->way == RESTORE && memcmp(net->cut->alive, c->at, net->n_elements) != 0)
        network_cut_set(net, c->at);
    pass(c, c->way == RESTORE ? c->at : net->cut->alive, net->n_elements);
}

static void pass_source(const palp_network *net, multigrid_source source, cursor *c) {
    pass(c, source.element, 5 * net->n_elements * sizeof *source.element);
    pass(c, source.node, 6 * net->n_nodes * sizeof *source.node);
    pass(c, source.n_couplings, sizeof *source.n_couplings);
    pass(c, source.coupling, MULTIGRID_COUPLINGS * sizeof *source.coupling);
}

/* Makes the factor that served anew, and of the next one as much as there was. */
static void remake(palp_network *net, cursor *c) {
    network_realtime *rt = net->realtime;
    bool done = false;
    multigrid_begin(rt->mg, rt->used_definite);
    while (!done && !multigrid_advance(rt->mg, INFINITY, &done))
        continue;
    multigrid_swap(rt->mg);
    pass_source(net, multigrid_input(rt->mg), c);
    if (rt->stage != REFRESH_MAKE)
        return;
    multigrid_begin(rt->mg, rt->definite);
    for (size_t i = 0; i < rt->at && !rt->thread; i++)
        multigrid_advance(rt->mg, rt->piece, &done);
    if (rt->thread)
        refresh_thread_start(rt->thread);
}

static void pass_realtime(palp_network *net, cursor *c) {
    network_realtime *rt = net->realtime;
    if (rt->thread)
        refresh_thread_wait(rt->thread);
    pass(c, rt->adjoint, 3 * net->n_nodes * sizeof *rt->adjoint);
    double *numbers[] = {&rt->adjoint_error, &rt->error_ratio, &rt->remembered, &rt->contraction};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        pass(c, numbers[i], sizeof(double));
    pass(c, &rt->stage, sizeof rt->stage);
    pass(c, &rt->at, sizeof rt->at);
    pass(c, &rt->definite, sizeof rt->definite);
    pass(c, &rt->used_definite, sizeof rt->used_definite);
    pass(c, &rt->adjoint_due, sizeof rt->adjoint_due);
    if (c->way == RESTORE) {
        pass_source(net, multigrid_input(rt->mg), c);
        remake(net, c);
    } else {
        pass_source(net, multigrid_used(rt->mg), c);
        pass_source(net, multigrid_input(rt->mg), c);
    }
}

static void pass_all(palp_network *net, cursor *c) {
    pass_state(net, c);
    if (net->cut)
        pass_cuts(net, c);
    if (net->realtime)
        pass_realtime(net, c);
}

static header header_of(const palp_network *net, size_t bytes) {
    return (header){.magic = UINT64_C(0x70616c7061746531),
                    .n_nodes = net->n_nodes,
                    .n_elements = net->n_elements,
                    .n_arms = net->material.n_arms,
                    .n_free = net->n_free,
                    .load_size = net->load_size,
                    .bytes = bytes,
                    .mass = net->mass != NULL,
                    .peak = net->now.history.peak != NULL,
                    .vector = net->now.vector != NULL,
                    .cut = net->cut != NULL,
                    .realtime = net->realtime != NULL};
}

size_t palp_network_state_size(const palp_network *net) {
    palp_network *counted = (palp_network *)net; /* counting changes nothing */
    cursor c = {.way = COUNT};
    pass_all(counted, &c);
    return sizeof(header) + c.bytes;
}

palp_status palp_network_save(const palp_network *net, void *buffer, size_t size) {
    size_t need = palp_network_state_size(net);
    if (!buffer || size < need)
        return PALP_ERR_ARGUMENT;
    header h = header_of(net, need);
    cursor c = {SAVE, (unsigned char *)buffer + sizeof h, 0};
    memcpy(buffer, &h, sizeof h);
    pass_all((palp_network *)net, &c); /* saving only reads */
    return PALP_OK;
}

palp_status palp_network_restore(palp_network *net, const void *buffer, size_t size) {
    size_t need = palp_network_state_size(net);
    header h = header_of(net, need);
    if (!buffer || size < need || memcmp(buffer, &h, sizeof h) != 0)
        return PALP_ERR_ARGUMENT;
    cursor c = {RESTORE, (unsigned char *)buffer + sizeof h, 0}; /* only read */
    net->trial = net->can_undo = net->factored = net->exact = false;
    pass_all(net, &c);
    if (net->load)
        network_load_recall(net);
    return PALP_OK;
}
