/* network_push.c: given forces on nodes, and given velocities. */
#include "network_internal.h"

#include <math.h>
#include <string.h>

typedef struct push {
    network_term term;
    double *force; /* [3 n_nodes] N */
} push;

static void pass_push_state(network_term *term, palp_network *net, network_cursor *cursor) {
    push *t = (push *)term;
    network_pass(cursor, t->force, 3 * net->n_nodes * sizeof *t->force);
}

static void clear_push(network_term *term, palp_network *net) {
    push *t = (push *)term;
    memset(t->force, 0, 3 * net->n_nodes * sizeof *t->force);
}

static void add_given_forces(network_term *term, palp_network *net) {
    const push *t = (const push *)term;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->outer[i] += t->force[i];
}

static bool add_push_energy(const network_term *term, const palp_network *net, double *energy) {
    const push *t = (const push *)term;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        *energy -= t->force[i] * (net->next.x[i] - net->rest[i]);
    return true;
}

static const network_term_kind PUSH = {
    .reset = clear_push, .pass = pass_push_state, .evaluate = add_given_forces, .energy = add_push_energy};

static palp_status add_push_term(palp_network *net) {
    push *t = network_term_new(&PUSH, sizeof *t);
    if (t)
        t->force = arena_take(&t->term.memory, 3 * net->n_nodes, sizeof *t->force);
    return network_add_terms(net, 1, (network_term *[]){(network_term *)t});
}

palp_status palp_network_set_forces(palp_network *net, size_t n, const int32_t *nodes,
                                    const double *force_N) {
    if (!net || (n > 0 && (!nodes || !force_N)))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (nodes[i] < 0 || (size_t)nodes[i] >= net->n_nodes || !isfinite(force_N[3 * i]) ||
            !isfinite(force_N[3 * i + 1]) || !isfinite(force_N[3 * i + 2]))
            return PALP_ERR_ARGUMENT;
    if (!network_find_term(net, &PUSH) && add_push_term(net))
        return PALP_ERR_NO_MEMORY;
    push *t = (push *)network_find_term(net, &PUSH);
    clear_push(&t->term, net);
    for (size_t i = 0; i < 3 * n; i++)
        t->force[3 * (size_t)nodes[i / 3] + i % 3] += force_N[i];
    net->trial = net->exact = false;
    return PALP_OK;
}

palp_status palp_network_set_velocities(palp_network *net, const double *velocity_m_s) {
    if (!net || !velocity_m_s)
        return PALP_ERR_ARGUMENT;
    if (!net->mass)
        return PALP_ERR_UNSUPPORTED;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (!isfinite(velocity_m_s[i]))
            return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->now.velocity[i] = net->dof[i] >= 0 ? velocity_m_s[i] : 0.0;
    net->trial = false;
    net->n_past = 0; /* the way so far says nothing of the next step */
    return PALP_OK;
}

const double *palp_network_velocities(const palp_network *net) {
    return net && net->mass ? net->now.velocity : NULL;
}
