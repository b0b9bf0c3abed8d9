/* calibrate_covariance.c: the covariance of a calibrated network, from that of the lumped model that it was
 * calibrated to. */
#include <palpate/calibrate.h>

#include "base/dense.h"
#include "base/file.h"
#include "response/forward_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Normal equations of A dphi = G dtheta: the change of the network's parameters that has the same effect on
 * the forces as a change of the lumped model's. Each run counts the same. */
typedef struct carrying {
    const palp_model *lumped, *network;
    size_t from, to;        /* parameters of the lumped model, of the network */
    double *square, *right; /* A'A [to to], A'G [to from] by columns; then the solution */
    double miss, missed;    /* relative error of the network's force against the lumped model's: sum of
                               squares, count */
} carrying;

static size_t count(const palp_model *model) {
    return model->material.law.n + 2 * model->material.n_arms;
}

/* The squared relative error of the network's force, with equal weight at every force. The error is
 * systematic: it is the same in each press, and largest at small forces during loading. Forces below a
 * twentieth of the largest do not count. */
static void add_miss(carrying *c, size_t n, const double *network_N, const double *lumped_N) {
    double peak = 0.0;
    for (size_t i = 0; i < n; i++)
        peak = fmax(peak, fabs(lumped_N[i]));
    for (size_t i = 0; i < n; i++) {
        if (fabs(lumped_N[i]) > 0.05 * peak) {
            double part = network_N[i] / lumped_N[i] - 1.0;
            c->miss += part * part;
            c->missed += 1.0;
        }
    }
}

static void add_run(carrying *c, size_t n, const double *network_N, const double *a, const double *lumped_N,
                    const double *g) {
    double square = 0.0;
    for (size_t i = 0; i < n; i++)
        square += lumped_N[i] * lumped_N[i];
    double weight = square > 0.0 ? 1.0 / square : 0.0;
    add_miss(c, n, network_N, lumped_N);
    for (size_t k = 0; k < c->to; k++) {
        for (size_t j = 0; j < c->to; j++)
            c->square[k * c->to + j] += weight * dense_dot(n, a + k * n, a + j * n);
        for (size_t j = 0; j < c->from; j++)
            c->right[j * c->to + k] += weight * dense_dot(n, a + k * n, g + j * n);
    }
}

static palp_status take_run(carrying *c, const palp_forward_run *run, palp_error *error) {
    const size_t n = run->n, a = palp_forward_parameter_count(c->network),
                 g = palp_forward_parameter_count(c->lumped);
    double *room = malloc((2 + a + g) * n * sizeof *room + 1);
    if (!room)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    double *network_N = room, *lumped_N = room + n, *by_network = room + 2 * n,
           *by_lumped = by_network + a * n;
    palp_status status = forward_network_force(c->network, run, network_N, by_network, error);
    if (!status)
        status = palp_forward_force(c->lumped, run, lumped_N, by_lumped, error);
    if (!status)
        add_run(c, n, network_N, by_network, lumped_N, by_lumped);
    free(room);
    return status;
}

/* right becomes d network parameters / d lumped parameters. A ridge fixes directions that the runs hardly
 * determine. */
static palp_status solve(carrying *c) {
    const size_t n = c->to;
    double *scale = malloc(n * sizeof *scale + 1);
    if (!scale)
        return PALP_ERR_NO_MEMORY;
    for (size_t k = 0; k < n; k++)
        scale[k] = c->square[k * n + k] > 0.0 ? 1.0 / sqrt(c->square[k * n + k]) : 0.0;
    for (size_t k = 0; k < n; k++)
        for (size_t j = 0; j < n; j++)
            c->square[k * n + j] = k == j ? 1.0 + 1e-9 : c->square[k * n + j] * scale[k] * scale[j];
    for (size_t i = 0; i < n * c->from; i++)
        c->right[i] *= scale[i % n];
    palp_status status = dense_cholesky(n, c->square) ? PALP_OK : PALP_ERR_SINGULAR;
    if (!status)
        dense_cholesky_solve(n, c->square, c->from, c->right);
    for (size_t i = 0; i < n * c->from; i++)
        c->right[i] *= scale[i % n];
    free(scale);
    return status;
}

/* X C X' of the covariance of the lumped model's parameters. */
static void carry(const carrying *c, const double *covariance, double *result) {
    for (size_t k = 0; k < c->to; k++)
        for (size_t j = 0; j <= k; j++) {
            double sum = 0.0;
            for (size_t a = 0; a < c->from; a++)
                for (size_t b = 0; b < c->from; b++)
                    sum += c->right[a * c->to + k] * covariance[a * c->from + b] * c->right[b * c->to + j];
            result[k * c->to + j] = result[j * c->to + k] = sum;
        }
}

/* The network's error against the lumped model, as one factor on its whole stiffness. */
static palp_status add_misfit(const carrying *c, double *covariance) {
    double *own = malloc((palp_forward_parameter_count(c->network) + 1) * sizeof *own);
    palp_status status = own ? palp_forward_get(c->network, own) : PALP_ERR_NO_MEMORY;
    double part = c->missed > 0.0 ? c->miss / c->missed : 0.0;
    for (size_t k = 0; k < c->to && !status; k++)
        for (size_t j = 0; j < c->to; j++)
            covariance[k * c->to + j] += part * own[k] * own[j];
    free(own);
    return status;
}

palp_status palp_calibrate_covariance(const palp_model *lumped, const palp_model *network, size_t n_runs,
                                      const palp_forward_run *runs, double *covariance, double *between,
                                      palp_error *error) {
    if (!lumped || !network || !runs || !covariance)
        return palp_error_null(error);
    carrying c = {.lumped = lumped, .network = network, .from = count(lumped), .to = count(network)};
    if (!lumped->covariance || n_runs == 0 || lumped->kind != PALP_MODEL_LUMPED ||
        network->kind != PALP_MODEL_NETWORK || (between && !lumped->between))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "a lumped model with its covariance, a network and runs are needed");
    c.square = calloc(c.to * (c.to + c.from) + 1, sizeof *c.square);
    c.right = c.square + c.to * c.to;
    palp_status status = c.square ? PALP_OK : palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    for (size_t r = 0; r < n_runs && !status; r++)
        status = take_run(&c, &runs[r], error);
    if (!status && solve(&c))
        status = palp_error_set(error, PALP_ERR_SINGULAR, "the runs do not determine the network");
    if (!status) {
        carry(&c, lumped->covariance, covariance);
        if (between)
            carry(&c, lumped->between, between);
        status = add_misfit(&c, covariance);
    }
    free(c.square);
    return status;
}
