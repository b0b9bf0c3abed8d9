/* realtime_solve.c: evaluates the tissue, multiplies by its tangent, and solves by conjugate gradients with
 * the multigrid cycle as preconditioner. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

/* Longest move where the tangent is not definite, as a share of the network's size. */
static const double FURTHEST = 0.002;

palp_status realtime_place_runs(palp_realtime *rt) {
    const palp_network *net = rt->net;
    const uint32_t *place = multigrid_input(rt->mg).place;
    const size_t n = net->first_run[(net->n_elements + NETWORK_CHUNK - 1) / NETWORK_CHUNK];
    uint32_t *to = arena_take(&rt->memory, n, sizeof *to);
    bool together = to != NULL;
    for (size_t r = 0, at = 0; r < n && together; at += (size_t)net->run[r++].n) {
        to[r] = place[at];
        for (size_t i = 0; i < (size_t)net->run[r].n; i++)
            together = together && place[at + i] == to[r] + i;
    }
    rt->run_place = together ? to : NULL;
    return to ? PALP_OK : PALP_ERR_NO_MEMORY;
}

bool realtime_evaluate(palp_realtime *rt, bool tangent, bool trial) {
    const multigrid_source source = multigrid_input(rt->mg);
    rt->fresh = tangent;
    rt->kept = !trial;
    const network_blocks blocks = {tangent ? rt->element : NULL, source.place, source.spacing, rt->run_place,
                                   trial};
    if (tangent)
        multigrid_place_nodes(rt->mg, rt->net->next.x, rt->element);
    return network_evaluate_blocks(rt->net, &blocks);
}

static void clear_fixed_coordinates(const palp_network *net, double *q) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        q[i] = net->dof[i] < 0 ? 0.0 : q[i];
}

void realtime_tissue_times(palp_realtime *rt, const double *p, double *q) {
    const palp_network *net = rt->net;
    multigrid_elements_times(rt->mg, rt->element, p, q);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        q[i] = net->diagonal[i] * p[i] - q[i];
    for (size_t i = 0; i < net->n_terms; i++)
        if (net->terms[i]->kind->times && !realtime_touches(net->terms[i]))
            net->terms[i]->kind->times(net->terms[i], net, p, q);
    clear_fixed_coordinates(net, q);
}

void realtime_add_touching(const palp_realtime *rt, bool whole, const double *p, double *q) {
    const palp_network *net = rt->net;
    for (size_t i = 0; i < net->n_terms; i++) {
        const network_term_kind *kind = net->terms[i]->kind;
        if (realtime_touches(net->terms[i]))
            (whole && kind->whole_times ? kind->whole_times : kind->times)(net->terms[i], net, p, q);
    }
    clear_fixed_coordinates(net, q);
}

void realtime_tangent_times(palp_realtime *rt, const double *p, double *q) {
    realtime_tissue_times(rt, p, q);
    realtime_add_touching(rt, false, p, q);
}

void realtime_move_a_little(palp_realtime *rt) {
    const palp_network *net = rt->net;
    double largest = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        largest = fmax(largest, fabs(rt->z[i]));
    double factor = largest > 0.0 ? fmin(1.0, FURTHEST * net->extent / largest) : 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        rt->move[i] = factor * rt->z[i];
}

size_t realtime_solve(palp_realtime *rt, size_t limit, double share, double enough) {
    const palp_network *net = rt->net;
    const size_t n = 3 * net->n_nodes;
    double square = network_dot(rt->r, rt->r, n), target = share * share * square, before = 0.0;
    size_t done = 0;
    memset(rt->move, 0, n * sizeof *rt->move);
    realtime_touch(rt);
    while (done < limit && square > target && !(done > 0 && rt->error_ratio * sqrt(square) < enough)) {
        multigrid_apply(rt->mg, rt->r, rt->z);
        done++;
        double rz = network_dot(rt->r, rt->z, n), beta = before > 0.0 ? rz / before : 0.0;
        if (!(rz > 0.0) || isinf(rz))
            break;
        const double ratio = sqrt(rz / square); /* the ratio is least for the rough residual that corrections
                                                   leave, not for that of a later guess */
        rt->error_ratio = rt->spread > 0.0 && done > 1 ? fmax(rt->error_ratio, ratio) : ratio;
        before = rz;
        for (size_t i = 0; i < n; i++)
            rt->p[i] = rt->z[i] + (beta > 0.0 ? beta * rt->p[i] : 0.0);
        realtime_tangent_times(rt, rt->p, rt->q);
        double curvature = network_dot(rt->p, rt->q, n), alpha = rz / curvature;
        if (!(curvature > 0.0)) {
            rt->indefinite = true;
            if (done == 1)
                realtime_move_a_little(rt);
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
