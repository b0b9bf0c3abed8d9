/* calibrate_relaxation.c: arms and scale of the element material from force records of several depths at once
 * (the thesis' open problem of Section 6.2). The method is least squares with forward sensitivities. */
#include "calibrate_internal.h"
#include "relaxation_parameters.h"
#include "response/step_slopes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_relaxation_settings palp_relaxation_settings_default(void) {
    return (palp_relaxation_settings){.max_evaluations = 80,
                                      .dt_s = 0.0,
                                      .tolerance = 1e-4,
                                      .stop_relative = 1e-4,
                                      .fit_beta = false,
                                      .fit_gamma = false,
                                      .one_beta = true,
                                      .fit_scale = true};
}

typedef struct relaxation {
    palp_network *net;
    const palp_material *start;
    const palp_relaxation_settings *settings;
    size_t n_targets, n_samples;
    const palp_target *target;
    palp_calibration *result;
    size_t n;
    relaxation_parameter parameter[RELAXATION_PARAMETERS_MAX];
    step_slopes slopes;          /* columns: the parameters */
    double *weight, *force;      /* [n_elements], [n_samples] */
    double best;                 /* weighted sum of squares */
    double *residual, *jacobian; /* where linearize puts them, else NULL */
} relaxation;

/* Direct derivative of arm j by a parameter of an arm. */
static effect_arm own_arm(const relaxation *s, relaxation_role role, size_t j) {
    switch (role) {
    case RELAXATION_STIFFNESS:
        return (effect_arm){.log_stiffness = 1.0 / s->net->material.arms[j].stiffness_N};
    case RELAXATION_BETA:
        return (effect_arm){.beta = 1.0};
    case RELAXATION_GAMMA:
        return (effect_arm){.gamma = 1.0};
    default:
        return (effect_arm){.log_time = 1.0};
    }
}

/* Adds the direct derivative of the elements by parameter k. */
static void add_own(relaxation *s, size_t k, double scale) {
    const relaxation_parameter *p = &s->parameter[k];
    const size_t m = s->net->n_elements;
    if (p->role == RELAXATION_SCALE) {
        double *elastic = s->net->scratch;
        palp_law_force(&s->net->material.law, m, s->net->strain, elastic, NULL, NULL);
        for (size_t i = 0; i < m; i++)
            s->slopes.partial[k * m + i] += elastic[i] / scale;
        s->slopes.outer = s->net->settings.poisson_ratio > 0.0 ? 1.0 / scale : 0.0; /* its modulus follows */
        return;
    }
    for (size_t j = p->first; j <= p->last; j++) {
        const effect_arm own = own_arm(s, p->role, j);
        step_slopes_add_arm(&s->slopes, k, j, &own);
    }
}

/* After a trial step: dforce/dparameter into gradient[n], sensitivities advanced. */
static palp_status advance_sensitivities(relaxation *s, double scale, double *gradient) {
    double stiffness;
    palp_status status = network_weights(s->net, s->weight, &stiffness);
    if (status)
        return status;
    step_slopes_begin(&s->slopes, s->weight);
    for (size_t k = 0; k < s->n; k++) {
        step_slopes_carry(&s->slopes, k);
        s->slopes.outer = 0.0;
        add_own(s, k, scale);
        gradient[k] = step_slopes_force(&s->slopes, k, 0.0);
        step_slopes_equilibrate(&s->slopes, k, 0.0, 0.0);
    }
    return PALP_OK;
}

/* Next time to solve at: graded steps, never past a sample or a corner, even on a ramp; in a hold they grow
 * with the time since the ramp. With both constants the error is a tenth of the tolerance for the material of
 * Table 4.5. */
static double next_time(const relaxation *s, const palp_target *target, size_t sample, double t) {
    size_t corner = 0;
    while (corner + 2 < target->path.n && target->path.time_s[corner + 1] <= t)
        corner++;
    double from = target->path.time_s[corner], to = target->path.time_s[corner + 1];
    double before = corner ? from - target->path.time_s[corner - 1] : to - from; /* the ramp, in a hold */
    double coarse = sqrt(s->settings->tolerance), step = s->settings->dt_s;
    if (step == 0.0)
        step = target->path.depth_m[corner] == target->path.depth_m[corner + 1]
                   ? fmax(15.0 * coarse * (t - from), 0.5 * coarse * before)
                   : (to - from) * 5.0 * coarse;
    double next = t + step;
    if (t < to && next > to - 1e-9 * step)
        next = to;
    if (sample < target->n && next > target->time_s[sample] - 1e-9 * step)
        next = target->time_s[sample];
    return next;
}

/* Runs one target from rest: force[n] at its samples and, unless NULL, gradient rows of stride total. */
static palp_status run_target(relaxation *s, const palp_target *target, double scale, double *force,
                              double *gradient, size_t total) {
    double row[RELAXATION_PARAMETERS_MAX] = {0}, t = target->path.time_s[0];
    palp_status status = PALP_OK;
    palp_network_reset(s->net);
    memset(s->slopes.state, 0, s->slopes.n_state * sizeof *s->slopes.state);
    for (size_t i = 0; i < target->n && !status;) {
        if (t >= target->time_s[i]) {
            force[i] = s->net->now.force;
            for (size_t k = 0; k < s->n && gradient; k++)
                gradient[k * total + i] = row[k];
            i++;
            continue;
        }
        double next = next_time(s, target, i, t);
        status = palp_network_try(s->net, palp_path_at(&target->path, next), next - t, NULL);
        if (!status && gradient)
            status = advance_sensitivities(s, scale, row);
        if (!status)
            palp_network_commit(s->net);
        t = next;
    }
    return status;
}

static double weight_of(const palp_target *target) {
    double peak = 0.0;
    for (size_t i = 0; i < target->n; i++)
        peak = fmax(peak, fabs(target->force_N[i]));
    return target->weight > 0.0 ? target->weight : 1.0 / ((double)target->n * peak * peak);
}

static palp_status report(relaxation *s, const palp_material *material, double weighted) {
    double sum = 0.0;
    const double *force = s->force;
    for (size_t t = 0; t < s->n_targets; force += s->target[t++].n)
        for (size_t i = 0; i < s->target[t].n; i++)
            sum += (force[i] - s->target[t].force_N[i]) * (force[i] - s->target[t].force_N[i]);
    palp_calibrate_iteration it = calibration_iteration(material, sum, weighted, s->n_targets);
    palp_status status = calibration_add(s->result, &it);
    if (status)
        return status;
    if (s->result->n_iterations == 1 || weighted < s->best) {
        s->best = weighted;
        s->result->residual_N = it.residual_N;
        s->result->material = *material;
    }
    double done = (double)s->result->n_iterations / (double)s->settings->max_evaluations;
    if (s->settings->progress && s->settings->progress(s->settings->user, done, &it))
        return PALP_ERR_STOPPED;
    return PALP_OK;
}

/* A material without an equilibrium counts as one without force: far from any target. */
static palp_status residuals(void *user, const double *p, double *r, double *jacobian) {
    relaxation *s = user;
    palp_material material;
    size_t first = 0;
    double weighted = 0.0, scale = s->settings->fit_scale ? p[0] : 1.0;
    palp_status status = relaxation_material(s->n, s->parameter, s->start, p, &material);
    if (!status)
        status = palp_network_set_material(s->net, &material);
    bool no_material = status != PALP_OK;
    for (size_t t = 0; t < s->n_targets; t++) {
        const palp_target *target = &s->target[t];
        double root = sqrt(weight_of(target));
        if (!status)
            status = run_target(s, target, scale, s->force + first, jacobian ? jacobian + first : NULL,
                                s->n_samples);
        bool lost = calibration_lost(status) || status == PALP_ERR_ARGUMENT;
        if (status && (!lost || s->result->n_iterations == 0))
            return status;
        for (size_t i = first; i < first + target->n; i++) {
            if (status)
                s->force[i] = 0.0;
            r[i] = root * (s->force[i] - target->force_N[i - first]);
            weighted += r[i] * r[i];
            for (size_t k = 0; k < s->n && jacobian; k++)
                jacobian[k * s->n_samples + i] = status ? 0.0 : root * jacobian[k * s->n_samples + i];
        }
        first += target->n;
    }
    return no_material ? PALP_OK : report(s, &material, weighted);
}

static double longest_path(const relaxation *s) {
    double longest = 0.0;
    for (size_t t = 0; t < s->n_targets; t++) {
        const palp_path *path = &s->target[t].path;
        longest = fmax(longest, path->time_s[path->n - 1] - path->time_s[0]);
    }
    return longest;
}

/* Stiffnesses in units of their first guess, so that the solver takes the same steps in newtons and in
 * nanonewtons. */
typedef struct plain_numbers {
    relaxation *stage;
    double unit[RELAXATION_PARAMETERS_MAX];
} plain_numbers;

static palp_status plain_residuals(void *user, const double *u, double *r, double *jacobian) {
    plain_numbers *plain = user;
    relaxation *s = plain->stage;
    double p[RELAXATION_PARAMETERS_MAX];
    for (size_t k = 0; k < s->n; k++)
        p[k] = plain->unit[k] * u[k];
    palp_status status = residuals(s, p, r, jacobian);
    for (size_t k = 0; k < s->n && jacobian; k++)
        for (size_t i = 0; i < s->n_samples; i++)
            jacobian[k * s->n_samples + i] *= plain->unit[k];
    return status;
}

/* First guess u[n] and bounds on it, from those on p. */
static size_t plain_bounds(plain_numbers *plain, double *u, double *row, double *floor) {
    relaxation *s = plain->stage;
    relaxation_first_guess(s->n, s->parameter, s->start, u);
    size_t rows = relaxation_bounds(s->n, s->parameter, s->start, longest_path(s), row, floor);
    for (size_t k = 0; k < s->n; k++) {
        plain->unit[k] = s->parameter[k].role == RELAXATION_STIFFNESS ? u[k] : 1.0;
        u[k] /= plain->unit[k];
    }
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < s->n; k++)
            if (row[i * s->n + k] != 0.0)
                floor[i] /= plain->unit[k]; /* a bound is of one parameter */
    return rows;
}

static palp_status fit(relaxation *s) {
    double p[RELAXATION_PARAMETERS_MAX], floor[2 * RELAXATION_PARAMETERS_MAX],
        norm; /* two bounds of a time */
    double *row = malloc(2 * s->n * s->n * sizeof *row + 1);
    plain_numbers plain = {.stage = s};
    if (!row)
        return PALP_ERR_NO_MEMORY;
    least_squares problem = {.n_parameters = s->n,
                             .n_residuals = s->n_samples,
                             .max_evaluations = s->settings->max_evaluations,
                             .stop_relative = s->settings->stop_relative,
                             .evaluate = plain_residuals,
                             .user = &plain,
                             .constraint = row,
                             .floor = floor};
    problem.n_constraints = plain_bounds(&plain, p, row, floor);
    palp_status status = least_squares_solve(&problem, p, &norm, &s->result->converged);
    free(row);
    return status;
}

static bool target_sound(const palp_target *target) {
    double peak = 0.0;
    if (target->n == 0 || target->path.n < 2 || !target->path.depth_m || target->path.depth_m[0] != 0.0)
        return false;
    for (size_t i = 0; i < target->n; i++) {
        if (!isfinite(target->time_s[i]) || !isfinite(target->force_N[i]) ||
            (i && !(target->time_s[i] > target->time_s[i - 1])))
            return false;
        peak = fmax(peak, fabs(target->force_N[i]));
    }
    return isfinite(target->weight) && (target->weight > 0.0 || (target->weight == 0.0 && peak > 0.0));
}

/* The sensitivities leave out mass; a quasi-linear arm has no beta (palp_material_check). */
static palp_status check(const relaxation *s) {
    const palp_relaxation_settings *settings = s->settings;
    if (s->start->formulation != PALP_HISTORY || s->net->mass || network_has_fibres(s->net) ||
        (settings->fit_beta && s->start->quasi_linear))
        return PALP_ERR_UNSUPPORTED;
    if (s->start->n_arms == 0 || s->n_targets == 0 || settings->max_evaluations < 1 ||
        !(settings->tolerance > 0.0) || !(settings->dt_s >= 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t t = 0; t < s->n_targets; t++)
        if (!target_sound(&s->target[t]))
            return PALP_ERR_ARGUMENT;
    return palp_material_check(s->start, NULL);
}

/* Checks, allocates and does the work. */
static palp_status prepare(relaxation *s, palp_status (*work)(relaxation *)) {
    palp_status status = check(s);
    if (status)
        return status;
    s->n = relaxation_list(s->start, s->settings, s->parameter);
    for (size_t t = 0; t < s->n_targets; t++)
        s->n_samples += s->target[t].n;
    s->weight = malloc((s->net->n_elements + 1) * sizeof(double));
    s->force = calloc(s->n_samples + 1, sizeof(double));
    status = step_slopes_create(s->net, s->n, s->start->n_arms, &s->slopes);
    if (!status)
        status = s->weight && s->force ? work(s) : PALP_ERR_NO_MEMORY;
    step_slopes_free(&s->slopes);
    free(s->weight);
    free(s->force);
    return status;
}

static palp_status linearize(relaxation *s) {
    double p[RELAXATION_PARAMETERS_MAX];
    relaxation_first_guess(s->n, s->parameter, s->start, p);
    return residuals(s, p, s->residual, s->jacobian);
}

palp_status relaxation_linearize(palp_network *network, const palp_material *start, size_t n_targets,
                                 const palp_target *targets, const palp_relaxation_settings *settings,
                                 size_t *n_parameters, double *residual, double *jacobian) {
    palp_calibration result = {0};
    relaxation s = {.net = network,
                    .start = start,
                    .settings = settings,
                    .n_targets = n_targets,
                    .target = targets,
                    .result = &result,
                    .residual = residual,
                    .jacobian = jacobian};
    palp_status status = prepare(&s, linearize);
    *n_parameters = s.n;
    palp_calibration_free(&result);
    return status;
}

palp_status palp_calibrate_relaxation(palp_network *network, const palp_material *start, size_t n_targets,
                                      const palp_target *targets, const palp_relaxation_settings *settings,
                                      palp_calibration *result) {
    if (!network || !start || !targets || !settings || !result)
        return PALP_ERR_ARGUMENT;
    relaxation s = {.net = network,
                    .start = start,
                    .settings = settings,
                    .n_targets = n_targets,
                    .target = targets,
                    .result = result};
    memset(result, 0, sizeof *result);
    palp_status status = prepare(&s, fit);
    if (!status)
        status = palp_network_set_material(network, &result->material);
    if (status)
        palp_calibration_free(result);
    return status;
}
