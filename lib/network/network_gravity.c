/* network_gravity.c: the weight of the nodes. */
#include "network_internal.h"

#include <string.h>

typedef struct gravity {
    network_term term;
    double acceleration[3]; /* m/s^2 */
} gravity;

static void evaluate_gravity_forces(network_term *term, palp_network *net) {
    const gravity *t = (const gravity *)term;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->outer[i] += net->mass[i / 3] * t->acceleration[i % 3];
}

static bool add_gravity_energy(const network_term *term, const palp_network *net, double *energy) {
    const double *g = ((const gravity *)term)->acceleration;
    for (size_t i = 0; i < net->n_nodes; i++) {
        const double *x = net->next.x + 3 * i, *rest = net->rest + 3 * i;
        *energy -=
            net->mass[i] * (g[0] * (x[0] - rest[0]) + g[1] * (x[1] - rest[1]) + g[2] * (x[2] - rest[2]));
    }
    return true;
}

static const network_term_kind GRAVITY = {.evaluate = evaluate_gravity_forces, .energy = add_gravity_energy};

network_term *network_gravity_new(const double acceleration_m_s2[3]) {
    gravity *t = network_term_new(&GRAVITY, sizeof *t);
    if (t)
        memcpy(t->acceleration, acceleration_m_s2, sizeof t->acceleration);
    return (network_term *)t;
}
