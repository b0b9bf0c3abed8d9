/* calibrate_two_level.c: the static stage for a network too large to trace many times. A coarse network of
 * the same body is fitted; the large one gives the ratio of the forces. */
#include "calibrate_internal.h"

#include <palpate/realtime.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PRESSES = 24, ROUNDS = 5 };
static const double PRECISE = 1e-6; /* force of the large network */
static const double ENOUGH = 1e-4;  /* largest error against the target, relative to its peak */

typedef struct two_level {
    palp_network *fine, *coarse;
    palp_realtime *realtime; /* of the large one */
    const palp_static_settings *settings;
    size_t n;
    const double *depth, *target;
    double share;                /* law of the large network over that of the coarse one: the same material */
    palp_material material;      /* of the coarse one */
    double *wanted, *ratio;      /* [n] of the coarse network; fine force over coarse */
    size_t n_presses, n_reached; /* of the large network, at samples (i + 1) n / n_presses - 1 */
    size_t n_stable;             /* of these, up to the first on another stable branch than that from rest */
    double strain_max;           /* of the large one in them */
    double *force;               /* [n] of it, in this round */
    double least;                /* squares of the best round */
    palp_calibration *result;
} two_level;

static size_t sample_of(const two_level *c, size_t press) {
    return (press + 1) * c->n / c->n_presses - 1;
}

/* Presses the large network down its branch. With PALP_BRANCH_CONTINUE it stops at the first step that is not
 * solved at once, where the network has begun to buckle. With PALP_BRANCH_STABLE each step descends to the
 * next stable equilibrium. force[n_presses]. */
static palp_status press_fine(two_level *c, const palp_material *material, double *force) {
    palp_tick_info info;
    const bool descends = c->fine->settings.branch == PALP_BRANCH_STABLE;
    const palp_budget budget = {.force_error = PRECISE};
    palp_status status = palp_network_set_material(c->fine, material);
    if (!status)
        status = palp_realtime_reset(c->realtime);
    c->n_stable = c->n_presses;
    for (c->n_reached = 0; c->n_reached < c->n_presses && !status; c->n_reached++) {
        status =
            palp_realtime_step(c->realtime, c->depth[sample_of(c, c->n_reached)], INFINITY, &budget, &info);
        if (calibration_lost(status) || (!status && !info.converged)) {
            status = PALP_OK;
            break;
        }
        if (descends && info.buckled && c->n_reached < c->n_stable)
            c->n_stable = c->n_reached;
        force[c->n_reached] = info.force_N;
        c->strain_max = fmax(c->n_reached ? c->strain_max : 0.0, palp_network_strain_max(c->fine));
    }
    return status || c->n_reached > 0 ? status : PALP_ERR_NOT_CONVERGED;
}

/* Linear between the presses; constant before the first and after the last. */
static void spread_ratio(two_level *c, const double *fine, const double *coarse) {
    size_t last = sample_of(c, c->n_reached - 1);
    for (size_t i = 0, p = 0; i < c->n; i++) {
        while (p + 1 < c->n_reached && i > sample_of(c, p))
            p++;
        size_t right = sample_of(c, p), left = p > 0 ? sample_of(c, p - 1) : right;
        double at_right = fine[p] / coarse[right], at_left = p > 0 ? fine[p - 1] / coarse[left] : at_right;
        double share =
            right > left ? (c->depth[i] - c->depth[left]) / (c->depth[right] - c->depth[left]) : 1.0;
        c->ratio[i] = i > last ? at_right : at_left + share * (at_right - at_left);
    }
}

/* Presses on the branch from rest; at least one. */
static size_t branch_presses(const two_level *c) {
    size_t n = c->n_stable < c->n_reached ? c->n_stable : c->n_reached;
    return n > 0 ? n : 1;
}

/* Where the large network's branch ended, or was left for another. */
static void report_stability(const two_level *c) {
    palp_calibration *r = c->result;
    size_t n = branch_presses(c);
    r->reached_m = c->depth[sample_of(c, c->n_reached - 1)];
    r->strain_max = c->strain_max;
    r->buckled = n < c->n_presses;
    if (r->buckled) {
        r->stable_m = c->depth[sample_of(c, n - 1)];
        r->unstable_m = c->depth[sample_of(c, n)];
    }
}

/* Stores the result of a round. */
static void keep(two_level *c, const palp_calibrate_iteration *it) {
    c->result->residual_N = it->residual_N;
    c->result->material = it->material;
    memcpy(c->result->force_N, c->force, c->n * sizeof *c->force);
    report_stability(c);
}

/* *miss: largest difference from the target as far as the branch from rest was followed, of the target's
 * peak. The best round is that of the least squares, with the force at that branch's end for all beyond:
 * forces of another branch do not count. */
static palp_status report(two_level *c, const palp_material *fine, const double *coarse, double *miss) {
    palp_calibration *r = c->result;
    palp_calibrate_iteration it = {.material = *fine};
    size_t last = sample_of(c, c->n_reached - 1), own = sample_of(c, branch_presses(c) - 1);
    double sum = 0.0, squares = 0.0, peak = 0.0;
    *miss = 0.0;
    for (size_t i = 0; i < c->n; i++) {
        c->force[i] = c->ratio[i] * coarse[i <= last ? i : last];
        double off = c->force[i] - c->target[i], here = c->force[i <= own ? i : own] - c->target[i];
        sum += off * off;
        squares += here * here;
        peak = fmax(peak, c->target[i]);
        *miss = i <= own ? fmax(*miss, fabs(off)) : *miss;
    }
    *miss /= peak;
    it.residual_N = sqrt(sum);
    if (r->n_iterations == 0 || squares < c->least) {
        c->least = squares;
        keep(c, &it);
    }
    palp_status status = calibration_add(r, &it);
    double done = (double)r->n_iterations / ROUNDS;
    bool stop = !status && c->settings->progress && c->settings->progress(c->settings->user, done, &it);
    return stop ? PALP_ERR_STOPPED : status;
}

/* One round: the coarse network's law for the wanted force, and the large network's force with it. */
static palp_status improve(two_level *c, double *miss) {
    double fine[PRESSES];
    palp_static_settings settings = *c->settings;
    palp_calibration coarse;
    settings.progress = NULL;
    palp_status status =
        palp_calibrate_static(c->coarse, &c->material, c->n, c->depth, c->wanted, &settings, &coarse);
    if (status)
        return status;
    palp_material material = c->material = coarse.material;
    status = palp_law_scale(&coarse.material.law, c->share, &material.law);
    if (!status)
        status = press_fine(c, &material, fine);
    if (!status) {
        spread_ratio(c, fine, coarse.force_N);
        status = report(c, &material, coarse.force_N, miss);
    }
    size_t own = status ? 0 : sample_of(c, branch_presses(c) - 1);
    for (size_t i = 0; i < c->n && !status; i++)
        c->wanted[i] = c->target[i] / c->ratio[i <= own ? i : own]; /* the law is not fitted to another
                                                                       branch */
    palp_calibration_free(&coarse);
    return status;
}

static palp_status allocate(two_level *c) {
    c->wanted = malloc(c->n * sizeof *c->wanted);
    c->ratio = malloc(c->n * sizeof *c->ratio);
    c->force = malloc(c->n * sizeof *c->force);
    if (!c->wanted || !c->ratio || !c->force)
        return PALP_ERR_NO_MEMORY;
    memcpy(c->wanted, c->target, c->n * sizeof *c->wanted);
    return calibration_set_target(c->result, c->n, c->depth, c->target);
}

palp_status palp_calibrate_two_level(palp_network *network, palp_network *coarse, const palp_material *start,
                                     size_t n, const double *depth_m, const double *target_N,
                                     const palp_static_settings *settings, palp_calibration *result) {
    if (!network || !coarse || !start || !depth_m || !target_N || !settings || !result)
        return PALP_ERR_ARGUMENT;
    two_level c = {.fine = network,
                   .coarse = coarse,
                   .settings = settings,
                   .n = n,
                   .depth = depth_m,
                   .target = target_N,
                   .n_presses = n < PRESSES ? n : PRESSES,
                   .result = result,
                   .material = *start,
                   .share = network_shared_length(coarse) / network_shared_length(network)};
    palp_realtime_settings realtime = palp_realtime_settings_default();
    double miss = HUGE_VAL, before = HUGE_VAL;
    memset(result, 0, sizeof *result);
    palp_status status = n > 0 ? allocate(&c) : PALP_ERR_ARGUMENT;
    if (!status)
        status = palp_realtime_create(network, &realtime, &c.realtime);
    for (int i = 0; i < ROUNDS && !status && miss > ENOUGH && (i < 2 || miss < 0.5 * before); i++) {
        before = miss;
        status = improve(&c, &miss);
    }
    result->converged = miss <= ENOUGH || (before < HUGE_VAL && miss >= 0.5 * before);
    if (!status)
        status = palp_network_set_material(network, &result->material);
    palp_realtime_free(c.realtime);
    free(c.wanted);
    free(c.ratio);
    free(c.force);
    if (status)
        palp_calibration_free(result);
    return status;
}
