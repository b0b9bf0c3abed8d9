/* tangent_make.h: the product of a network's tangent with a vector, for tests that compare with it. */
#ifndef TANGENT_MAKE_H
#define TANGENT_MAKE_H

#include "network/network_internal.h"

/* out = tangent of the last evaluation without blocks times u, [3 n_nodes] both, fixed axes included. */
static inline void network_tangent_times(const palp_network *net, const double *u, double *out) {
    const size_t m = net->n_elements;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        out[i] = net->diagonal[i] * u[i];
    for (size_t e = 0; e < m; e++) {
        const size_t a = 3 * (size_t)net->pair[2 * e], b = 3 * (size_t)net->pair[2 * e + 1];
        const double across = net->force[e] * net->inverse_length[e];
        double along = 0.0;
        for (size_t k = 0; k < 3; k++)
            along += net->direction[k * m + e] * (u[b + k] - u[a + k]);
        along *= net->tangent[e] * net->inverse_rest[e] - across;
        for (size_t k = 0; k < 3; k++) {
            const double f = along * net->direction[k * m + e] + across * (u[b + k] - u[a + k]);
            out[a + k] -= f;
            out[b + k] += f;
        }
    }
    NETWORK_EACH_TERM(net, times, net, u, out);
}

#endif
