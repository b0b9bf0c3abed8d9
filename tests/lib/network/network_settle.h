/* network_settle.h: what the tests of networks share. */
#ifndef NETWORK_SETTLE_H
#define NETWORK_SETTLE_H

#include "network/network_internal.h"
#include "network_make.h"

/* The same numbers on every machine: a 64-bit linear congruential generator (Knuth's MMIX). */
static uint64_t seed;
static inline double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

/* Leaves the network in the middle of a step of 10 ms to depth, with a history and random displacements of
 * the free nodes. */
static inline void unsettle(palp_network *net, double depth) {
    ck_assert_int_eq(palp_network_step(net, 0.5 * depth, 0.02, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.8 * depth, 0.05, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, depth, 0.01, NULL), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->next.x[i] += uniform(-4e-4, 4e-4);
    ck_assert(network_evaluate(net));
}

/* Energy at x + h along, [3 n_nodes] both. */
static inline double energy_at(palp_network *net, const double *x, const double *along, double h) {
    double energy;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.x[i] = x[i] + h * along[i];
    ck_assert(network_evaluate(net));
    ck_assert(network_energy(net, &energy));
    return energy;
}

/* Residual there into r[3 n_nodes], 0 on fixed axes. */
static inline void residual_at(palp_network *net, const double *x, const double *along, double h, double *r) {
    double scale;
    energy_at(net, x, along, h);
    network_residual(net, &scale);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        r[i] = net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]];
}

#endif
