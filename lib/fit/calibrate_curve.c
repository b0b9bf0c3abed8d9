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
    if (network_has_fibres(net))
        return PALP_ERR_UNSUPPORTED; /* nor do those of fibres follow it */
    for (size_t r = 0; r < net->n_regions && network_has_volume(net); r++)
        if (net->region[r].share && net->region[r].given.shape != PALP_REGION_MEMBRANE)
            return PALP_ERR_UNSUPPORTED; /* part of the volume's forces does not follow the law */
    if (!c->weight && !grow(&c->weight, net->n_elements))
        return PALP_ERR_NO_MEMORY;
    if (n <= c->capacity)
        return PALP_OK;
    n = n > 2 * c->capacity ? n : 2 * c->capacity;
    if (!grow(&c->depth, n) || !grow(&c->force, n) || !grow(&c->slope, n) ||
        !grow(&c->gradient, n * PALP_LAW_MAX))
        return PALP_ERR_NO_MEMORY;
    c->capacity = n;
    return PALP_OK;
}

/* Adds to g[p] the derivative of the force by way of the volume modulus, which is proportional to the law's
 * stiffness at rest. After network_weights. */
static void add_volume_gradient(const palp_network *net, size_t p, double *g) {
    static const double SMALL = 1e-9;
    double one[PALP_LAW_MAX], rest;
    if (!(net->settings.poisson_ratio > 0.0))
        return;
    palp_law_stiffness(&net->material.law, 0.0, &rest, NULL);
    palp_law_gradient(&net->material.law, SMALL, one);
    const double share = -network_dot(net->outer, net->fint, 3 * net->n_nodes) / (SMALL * rest);
    for (size_t k = 0; k < p; k++)
        g[k] += share * one[k];
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
    c->strain_max = fmax(c->n ? c->strain_max : 0.0, network_largest_strain(net, net->strain));
    memset(g, 0, p * sizeof *g);
    if (with_gradient) {
        status = network_weights(net, c->weight, &c->slope[c->n]);
        for (size_t i = 0; i < net->n_elements && !status; i++) {
            palp_law_gradient(&net->material.law, net->strain[i], one);
            for (size_t k = 0; k < p; k++)
                g[k] += c->weight[i] * one[k];
        }
        if (!status)
            add_volume_gradient(net, p, g);
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

/* Extrapolating the last interval of length l over a step h errs by h^2 (l + h)^2 F''''/24, interpolating the
 * step by h^4/16 of the same. So the error of the extrapolation gives that of the interpolation. */
static double interpolation_error(const force_curve *c, double depth, double force) {
    double last = c->depth[c->n - 1] - c->depth[c->n - 2], step = depth - c->depth[c->n - 1];
    double share = 0.25 * step / (last + step), doubt = 2.0; /* F'''' is not constant */
    return doubt * fabs(hermite(c, c->n - 2, depth) - force) * share * share;
}

/* The next step and the one after it divide the remaining depth, so that no tiny last step remains. */
static double next_depth(double depth, double step, double depth_max) {
    double left = depth_max - depth;
    return step >= left ? depth_max : depth + fmin(step, 0.5 * left);
}

palp_status force_curve_trace(force_curve *c, palp_network *net, double depth_max, double tolerance) {
    enum { FEWEST = 12 };
    const double shortest = 2e-4 * depth_max,
                 nearest = 2e-3 * depth_max;               /* for the error; to a branch's end */
    double step = depth_max / (16.0 * FEWEST), peak = 0.0; /* there is no estimate for the first one */
    palp_step_info info;
    palp_network_reset(net);
    net->no_approach = true;
    c->n = 0;
    palp_status status = palp_network_try(net, 0.0, INFINITY, &info);
    if (!status)
        status = add_point(c, net, 0.0, true);
    while (!status && net->now.depth < depth_max) {
        double target = next_depth(net->now.depth, step, depth_max);
        status = palp_network_try(net, target, INFINITY, &info);
        if (calibration_lost(status)) {
            if (step > nearest)
                status = PALP_OK;
            step *= 0.25;
            continue;
        }
        if (status)
            break;
        peak = fmax(peak, fabs(info.force_N));
        double error = c->n > 1 ? interpolation_error(c, target, info.force_N) / (tolerance * peak) : 0.0;
        if (error > 1.0 && step > shortest) {
            step *= fmax(0.25, 0.8 * pow(error, -0.25));
            continue;
        }
        status = add_point(c, net, info.force_N, true);
        if (!status)
            palp_network_commit(net);
        step = fmin(depth_max / FEWEST, step * fmin(2.0, 0.8 * pow(error + 1e-9, -0.25)));
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

void force_curve_sample(const force_curve *c, size_t n, const double *depth, double *force,
                        double *gradient) {
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
