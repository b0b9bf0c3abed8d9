/* calibrate_curve.c: the static force curve of a network and its gradient, traced and sampled. */
#include "calibrate_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void force_curve_free(force_curve *c) {
    free(c->depth);
    free(c->force);
    free(c->slope);
    free(c->gradient);
    free(c->weight);
    memset(c, 0, sizeof *c);
}

static bool grow(double **array, size_t n) {
    double *grown = realloc(*array, (n + 1) * sizeof **array);
    if (grown)
        *array = grown;
    return grown;
}

static palp_status reserve(force_curve *c, const palp_network *net, size_t n) {
    c->n_parameters = net->material.law.n;
    if (!c->weight && !grow(&c->weight, net->n_elements))
        return PALP_ERR_NO_MEMORY;
    if (n <= c->capacity)
        return PALP_OK;
    n = n > 2 * c->capacity ? n : 2 * c->capacity;
    if (!grow(&c->depth, n) || !grow(&c->force, n) || !grow(&c->slope, n) || !grow(&c->gradient, n * PALP_LAW_MAX))
        return PALP_ERR_NO_MEMORY;
    c->capacity = n;
    return PALP_OK;
}

/* The state just solved becomes the curve's next point. */
static palp_status add_point(force_curve *c, palp_network *net, double force, bool with_gradient) {
    palp_status status = reserve(c, net, c->n + 1);
    if (status)
        return status;
    size_t p = c->n_parameters;
    double *g = c->gradient + c->n * p, one[PALP_LAW_MAX];
    c->depth[c->n] = net->next.depth;
    c->force[c->n] = force;
    c->slope[c->n] = 0.0;
    memset(g, 0, p * sizeof *g);
    if (with_gradient) {
        status = network_weights(net, c->weight, &c->slope[c->n]);
        for (size_t i = 0; i < net->n_elements && !status; i++) {
            palp_law_gradient(&net->material.law, net->strain[i], one);
            for (size_t k = 0; k < p; k++)
                g[k] += c->weight[i] * one[k];
        }
    }
    c->n += !status;
    return status;
}

/* Cubic through value and slope at both ends, at depth d. */
static double hermite(const force_curve *c, size_t i, double d) {
    double h = c->depth[i + 1] - c->depth[i], t = (d - c->depth[i]) / h, s = 1.0 - t;
    return s * s * ((1.0 + 2.0 * t) * c->force[i] + t * h * c->slope[i]) +
           t * t * ((1.0 + 2.0 * s) * c->force[i + 1] - s * h * c->slope[i + 1]);
}

palp_status force_curve_trace(force_curve *c, palp_network *net, double depth_max, double tolerance) {
    enum { FEWEST = 12 };
    /* extrapolating one interval ahead errs by 4 h^4 F''''/24, interpolating by h^4/16 of it */
    const double ratio = 64.0;
    double step = depth_max / (4.0 * FEWEST), peak = 0.0;
    palp_step_info info;
    palp_network_reset(net);
    net->no_approach = true;
    c->n = 0;
    palp_status status = palp_network_try(net, 0.0, INFINITY, &info);
    if (!status)
        status = add_point(c, net, 0.0, true);
    while (!status && net->now.depth < depth_max) {
        double left = depth_max - net->now.depth;
        double target = step >= left ? depth_max : net->now.depth + fmin(step, 0.5 * left > step ? step : left);
        status = palp_network_try(net, target, INFINITY, &info);
        if (status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED) {
            if (step > 2e-3 * depth_max)
                status = PALP_OK;
            step *= 0.25;
            continue;
        }
        if (status)
            break;
        peak = fmax(peak, fabs(info.force_N));
        double error = c->n > 1 ? fabs(hermite(c, c->n - 2, target) - info.force_N) / (ratio * tolerance * peak) : 1.0;
        if (error > 16.0 && step > 1e-3 * depth_max) {
            palp_network_rollback(net);
            step *= 0.5;
            continue;
        }
        status = add_point(c, net, info.force_N, true);
        if (!status)
            palp_network_commit(net);
        step = fmin(depth_max / FEWEST, step * fmin(2.0, 0.9 * pow(error + 1e-9, -0.25)));
    }
    net->no_approach = false;
    return status;
}

palp_status force_curve_steps(force_curve *c, palp_network *net, size_t n, const double *depth,
                              bool with_gradient) {
    palp_step_info info;
    palp_network_reset(net);
    c->n = 0;
    palp_status status = reserve(c, net, n);
    for (size_t i = 0; i < n && !status; i++) {
        status = palp_network_try(net, depth[i], INFINITY, &info);
        if (!status)
            status = add_point(c, net, info.force_N, with_gradient);
        if (!status)
            palp_network_commit(net);
    }
    return status;
}

/* Weights of the four points around interval i for cubic interpolation at depth d; *first is the lowest. */
static size_t lagrange(const force_curve *c, size_t i, double d, double weight[4], size_t *first) {
    size_t n = c->n < 4 ? c->n : 4, start = i > 0 ? i - 1 : 0;
    if (start + n > c->n)
        start = c->n - n;
    for (size_t a = 0; a < n; a++) {
        weight[a] = 1.0;
        for (size_t b = 0; b < n; b++)
            if (b != a)
                weight[a] *= (d - c->depth[start + b]) / (c->depth[start + a] - c->depth[start + b]);
    }
    *first = start;
    return n;
}

void force_curve_sample(const force_curve *c, size_t n, const double *depth, double *force, double *gradient) {
    size_t i = 0, p = c->n_parameters;
    for (size_t j = 0; j < n; j++) {
        double weight[4], d = fmin(depth[j], c->depth[c->n - 1]);
        size_t first, count;
        while (i + 2 < c->n && c->depth[i + 1] < d)
            i++;
        force[j] = c->n > 1 ? hermite(c, i, d) : c->force[0];
        if (!gradient)
            continue;
        count = lagrange(c, i, d, weight, &first);
        for (size_t k = 0; k < p; k++) {
            double g = 0.0;
            for (size_t a = 0; a < count; a++)
                g += weight[a] * c->gradient[(first + a) * p + k];
            gradient[k * n + j] = g;
        }
    }
}
