/* realtime_state.c: saves and restores the state of a network and of its real-time solver. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

static void pass_multigrid_source(const palp_network *net, multigrid_source source, network_cursor *c) {
    network_pass(c, source.element, source.n_floats * sizeof *source.element);
    network_pass(c, source.node, 6 * net->n_nodes * sizeof *source.node);
    network_pass(c, source.n_couplings, sizeof *source.n_couplings);
    network_pass(c, source.coupling, MULTIGRID_COUPLINGS * sizeof *source.coupling);
    if (!source.between)
        return;
    network_pass(c, source.between, source.n_between * sizeof *source.between);
    network_pass(c, source.beside, source.n_beside * sizeof *source.beside);
}

/* Makes the factor in use again, and the next one as far as it had got. */
static void rebuild_saved_factors(palp_realtime *rt, network_cursor *c) {
    bool done = false;
    multigrid_begin(rt->mg, rt->used_definite);
    while (!done && !multigrid_advance(rt->mg, INFINITY, &done))
        continue;
    multigrid_swap(rt->mg);
    pass_multigrid_source(rt->net, multigrid_input(rt->mg), c);
    if (rt->stage != REFRESH_MAKE)
        return;
    multigrid_begin(rt->mg, rt->definite);
    for (size_t i = 0; i < rt->at && !rt->thread; i++)
        multigrid_advance(rt->mg, rt->piece, &done);
    if (rt->thread)
        refresh_thread_start(rt->thread);
}

static void pass_realtime_state(palp_realtime *rt, network_cursor *c) {
    if (rt->thread)
        refresh_thread_wait(rt->thread);
    network_pass(c, rt->adjoint, 3 * rt->net->n_nodes * sizeof *rt->adjoint);
    network_pass(c, rt->adjoint_r, 3 * rt->net->n_nodes * sizeof *rt->adjoint_r);
    network_pass(c, rt->adjoint_z, 3 * rt->net->n_nodes * sizeof *rt->adjoint_z);
    for (size_t i = 0; i < 2; i++)
        network_pass(c, rt->adjoint_at[i], 3 * rt->net->n_nodes * sizeof **rt->adjoint_at);
    network_pass(c, rt->tissue, 3 * rt->net->n_nodes * sizeof *rt->tissue);
    network_pass(c, rt->adjoint_half, multigrid_half_size(rt->mg) * sizeof *rt->adjoint_half);
    double *numbers[] = {&rt->adjoint_error, &rt->adjoint_rate, &rt->adjoint_far, &rt->adjoint_farthest,
                         &rt->adjoint_found, &rt->forgets,      &rt->doubt,       &rt->error_ratio,
                         &rt->remembered,    &rt->guessed,      &rt->contraction};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        network_pass(c, numbers[i], sizeof(double));
    network_pass(c, rt->arm_error, sizeof rt->arm_error);
    network_pass(c, &rt->idle, sizeof rt->idle);
    network_pass(c, &rt->near, sizeof rt->near);
    network_pass(c, &rt->part, sizeof rt->part);
    network_pass(c, rt->inverted, sizeof rt->inverted);
    network_pass(c, &rt->stage, sizeof rt->stage);
    network_pass(c, &rt->at, sizeof rt->at);
    network_pass(c, &rt->gathered, sizeof rt->gathered);
    network_pass(c, &rt->definite, sizeof rt->definite);
    network_pass(c, &rt->used_definite, sizeof rt->used_definite);
    network_pass(c, &rt->adjoint_due, sizeof rt->adjoint_due);
    if (c->way == NETWORK_RESTORE) {
        pass_multigrid_source(rt->net, multigrid_input(rt->mg), c);
        rebuild_saved_factors(rt, c);
    } else {
        pass_multigrid_source(rt->net, multigrid_used(rt->mg), c);
        pass_multigrid_source(rt->net, multigrid_input(rt->mg), c);
    }
}

/* Precedes the network's state; sum is a checksum of what follows. Saver and restorer must agree in all other
 * fields. */
typedef struct header {
    uint64_t magic, network, size, sum;
} header;

/* All but the checksum. */
static header state_buffer_header(const palp_realtime *rt) {
    network_cursor c = {.way = NETWORK_COUNT};
    pass_realtime_state((palp_realtime *)rt, &c); /* counting changes nothing */
    size_t network = palp_network_state_size(rt->net);
    return (header){UINT64_C(0x70616c7072743037), network, sizeof(header) + network + c.bytes, 0};
}

static uint64_t checksum_of_buffer(const header *h, const unsigned char *buffer) {
    size_t before = sizeof *h + h->network;
    return network_sum(NETWORK_SUM, buffer + before, h->size - before);
}

size_t palp_realtime_state_size(const palp_realtime *rt) {
    return rt ? (size_t)state_buffer_header(rt).size : 0;
}

palp_status palp_realtime_save(const palp_realtime *rt, void *buffer, size_t size) {
    if (!rt || !buffer)
        return PALP_ERR_ARGUMENT;
    header h = state_buffer_header(rt);
    if (!buffer || size < h.size)
        return PALP_ERR_ARGUMENT;
    unsigned char *at = (unsigned char *)buffer + sizeof h;
    network_cursor c = {NETWORK_SAVE, at + h.network, 0};
    pass_realtime_state((palp_realtime *)rt, &c); /* saving only reads */
    h.sum = checksum_of_buffer(&h, buffer);
    memcpy(buffer, &h, sizeof h);
    return palp_network_save(rt->net, at, h.network);
}

palp_status palp_realtime_restore(palp_realtime *rt, const void *buffer, size_t size) {
    if (!rt || !buffer)
        return PALP_ERR_ARGUMENT;
    header own = state_buffer_header(rt), found;
    if (!buffer || size < own.size)
        return PALP_ERR_ARGUMENT;
    memcpy(&found, buffer, sizeof found);
    if (memcmp(&found, &own, offsetof(header, sum)) != 0)
        return PALP_ERR_ARGUMENT;
    if (found.sum != checksum_of_buffer(&own, buffer))
        return PALP_ERR_INPUT;
    unsigned char *at = (unsigned char *)buffer + sizeof own; /* only read */
    palp_status status = palp_network_restore(rt->net, at, own.network);
    if (status)
        return status;
    network_cursor c = {NETWORK_RESTORE, at + own.network, 0};
    pass_realtime_state(rt, &c);
    rt->resets = rt->net->resets;
    return PALP_OK;
}

double palp_realtime_energy(const palp_realtime *rt) {
    if (!rt)
        return NAN;
    palp_network *net = rt->net;
    const network_state *s = &net->now;
    double *psi = net->scratch, sum = 0.0;
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++) {
        if (!network_material_at(net, r, &m))
            continue;
        palp_law_force(&m.material->law, net->n_elements, s->history.strain, psi + net->n_elements, NULL,
                       psi);
        for (size_t j = 0; j < m.material->n_arms; j++) {
            const double *q = m.now->arm + j * net->n_elements, half = 0.5 / m.material->arms[j].stiffness_N;
            for (size_t i = 0; i < net->n_elements; i++)
                psi[i] += half * q[i] * q[i];
        }
        for (size_t i = 0; i < net->n_elements; i++)
            sum += (net->scale ? net->scale[i] : 1.0) * (m.share ? m.share[i] : 1.0) * psi[i] /
                   net->inverse_rest[i];
    }
    for (size_t i = 0; i < 3 * net->n_nodes && net->mass; i++)
        sum += 0.5 * net->mass[i / 3] * s->velocity[i] * s->velocity[i];
    return sum;
}
