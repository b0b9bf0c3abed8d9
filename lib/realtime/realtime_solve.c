/* realtime_solve.c: conjugate gradients with the kept factor. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

static const double FURTHEST = 0.002; /* of the network's size: a move where the tangent is not definite */

/* q = K p on the free axes */
static void tangent_times(const palp_network *net, const double *p, double *q) {
    network_tangent_times(net, p, q);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        q[i] = net->dof[i] < 0 ? 0.0 : q[i];
}

/* Downhill along z, but not far. */
static void move_a_little(palp_realtime *rt) {
    const palp_network *net = rt->net;
    double largest = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        largest = fmax(largest, fabs(rt->z[i]));
    double factor = largest > 0.0 ? fmin(1.0, FURTHEST * net->extent / largest) : 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        rt->move[i] = factor * rt->z[i];
}

size_t realtime_solve(palp_realtime *rt, size_t limit, double share) {
    const palp_network *net = rt->net;
    const size_t n = 3 * net->n_nodes;
    double square = network_dot(rt->r, rt->r, n), target = share * share * square, before = 0.0;
    size_t done = 0;
    memset(rt->move, 0, n * sizeof *rt->move);
    realtime_touch(rt);
    while (done < limit && square > target) {
        multigrid_apply(rt->mg, rt->r, rt->z);
        done++;
        double rz = network_dot(rt->r, rt->z, n), beta = before > 0.0 ? rz / before : 0.0;
        if (!(rz > 0.0) || isinf(rz))
            break;
        rt->error_ratio = sqrt(rz / square);
        before = rz;
        for (size_t i = 0; i < n; i++)
            rt->p[i] = rt->z[i] + (beta > 0.0 ? beta * rt->p[i] : 0.0);
        tangent_times(net, rt->p, rt->q);
        double curvature = network_dot(rt->p, rt->q, n), alpha = rz / curvature;
        if (!(curvature > 0.0)) {
            if (done == 1)
                move_a_little(rt);
            break;
        }
        for (size_t i = 0; i < n; i++) {
            rt->move[i] += alpha * rt->p[i];
            rt->r[i] -= alpha * rt->q[i];
        }
        square = network_dot(rt->r, rt->r, n);
    }
    return done;
}

void realtime_improve_adjoint(palp_realtime *rt) {
    const palp_network *net = rt->net;
    const size_t n = 3 * net->n_nodes;
    realtime_touch(rt);
    tangent_times(net, rt->adjoint, rt->r);
    for (size_t i = 0; i < n; i++)
        rt->r[i] = -rt->r[i];
    multigrid_apply(rt->mg, rt->r, rt->z);
    tangent_times(net, rt->z, rt->q);
    double rz = network_dot(rt->r, rt->z, n), curvature = network_dot(rt->z, rt->q, n);
    if (!(rz > 0.0) || !(curvature > 0.0))
        return;
    rt->adjoint_error = fmax(sqrt(rz), 0.5 * rt->adjoint_error);
    for (size_t i = 0; i < n; i++)
        rt->adjoint[i] += rz / curvature * rt->z[i];
}
