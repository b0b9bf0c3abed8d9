/* specimens.c: several specimens: each one's own fit, and from these the mean and how they differ. */
#include "base/file.h"
#include "base/statistics.h"
#include "fit_internal.h"
#include "fit_spread.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void palp_specimens_fit_free(palp_specimens_fit *fit) {
    if (!fit)
        return;
    palp_lumped_fit_free(&fit->mean);
    free(fit->own);
    free(fit->factor);
    free(fit->between);
    free(fit->within);
    memset(fit, 0, sizeof *fit);
}

/* ---- forces of one level ---- */

static void divide(fit_problem *p, const size_t *specimen, const double *factor) {
    for (size_t r = 0; r < p->n_runs; r++) {
        fit_run *run = &p->run[r];
        double f = factor[specimen[r]];
        for (size_t i = 0; i < run->n; i++)
            run->force[i] /= f;
        run->noise /= f;
        run->zero_sd /= f;
        run->peak /= f;
    }
}

/* Best factor of the model's force for each specimen, from the weighted residual, model less measured. */
static void find_ratios(const fit_problem *p, const size_t *specimen, size_t n_specimens,
                        const double *residual, double *product, double *square, double *ratio) {
    memset(product, 0, n_specimens * sizeof *product);
    memset(square, 0, n_specimens * sizeof *square);
    for (size_t r = 0, row = 0; r < p->n_runs; r++)
        for (size_t i = 0; i < p->run[r].n; i++, row++) {
            double measured = sqrt(p->run[r].count[i]) / p->run[r].noise * p->run[r].force[i];
            double model = measured + residual[row];
            product[specimen[r]] += model * measured;
            square[specimen[r]] += model * model;
        }
    for (size_t k = 0; k < n_specimens; k++)
        ratio[k] = square[k] > 0.0 && product[k] > 0.0 ? product[k] / square[k] : 1.0;
}

/* Fits all recordings and divides each specimen's by its factor, in turn; v[parameters]: the last fit. */
static palp_status level(fit_problem *p, const size_t *specimen, size_t n_specimens, double *v,
                         double *factor) {
    enum { ROUNDS = 6 };
    double *residual = malloc((p->n_blocks + 3 * n_specimens) * sizeof *residual), chi2, mean = 0.0;
    double *ratio = residual ? residual + p->n_blocks : NULL, moved = 1.0;
    bool converged;
    palp_status status = residual ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t k = 0; k < n_specimens; k++)
        factor[k] = 1.0;
    for (int round = 0; round < ROUNDS && moved > 1e-3 && !status; round++) {
        status = round ? fit_solve_from(p, v, &chi2, &converged) : fit_solve(p, v, &chi2, &converged);
        if (!status)
            status = fit_evaluate(p, v, residual, NULL);
        if (status)
            break;
        find_ratios(p, specimen, n_specimens, residual, ratio + n_specimens, ratio + 2 * n_specimens, ratio);
        divide(p, specimen, ratio);
        moved = 0.0;
        for (size_t k = 0; k < n_specimens; k++) {
            factor[k] *= ratio[k];
            moved = fmax(moved, fabs(log(ratio[k])));
        }
    }
    for (size_t k = 0; k < n_specimens; k++)
        mean += log(factor[k]) / (double)n_specimens;
    for (size_t k = 0; k < n_specimens; k++)
        factor[k] *= exp(-mean);
    free(residual);
    return status;
}

/* ---- one specimen ---- */

/* The whole: parameters of each specimen are the law's coefficients, K_j and log tau_j; in a fit log K_j
 * stands for K_j. */
typedef struct specimens {
    size_t n_runs, n;
    const palp_recording *recordings;
    const size_t *specimen;
    const palp_characterize_settings *settings;
    palp_specimens_fit *fit;
    fit_problem all; /* of one level */
    size_t n_parameters;
    double *shape;                           /* [n_parameters] the fit of all */
    double *x, *v;                           /* [n n_parameters], [n n_parameters^2] */
    double *mean, *mean_covariance, *within; /* as of fit_spread */
    double chi2;                             /* reduced, mean of the specimens */
} specimens;

/* The specimen's recordings as a problem, divided by its factor and with the bounds of all. */
static palp_status own_problem(const specimens *s, size_t k, fit_problem *p, palp_error *error) {
    palp_recording *own = malloc(s->n_runs * sizeof *own);
    size_t *none = calloc(s->n_runs, sizeof *none), n = 0;
    palp_status status = own && none ? PALP_OK : palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    for (size_t r = 0; r < s->n_runs && !status; r++)
        if (s->specimen[r] == k)
            own[n++] = s->recordings[r];
    if (!status)
        status = fit_problem_create(p, n, own, s->settings, error);
    if (!status) {
        divide(p, none, &s->fit->factor[k]);
        p->n_arms = s->all.n_arms;
        p->tau_min = s->all.tau_min;
        p->tau_max = s->all.tau_max;
    }
    free(own);
    free(none);
    return status;
}

/* The fit's parameters and their covariance as those of the spread, for the specimen's own force. */
static void store(specimens *s, size_t k, const fit_problem *p, const double *v, const fit_curvature *c) {
    const size_t n = s->n_parameters;
    const double factor = s->fit->factor[k], widen = fit_inflation(c) * fit_inflation(c);
    double unit[FIT_PARAMETERS_MAX];
    for (size_t i = 0; i < n; i++) {
        bool exponent = p->law.kind == PALP_LAW_OGDEN && i % 2, log_K = (i - p->n_springs) % 2 == 0;
        unit[i] = i < p->n_springs ? (exponent ? 1.0 : factor) : log_K ? factor * exp(v[i]) : 1.0;
        s->x[k * n + i] = i < p->n_springs ? unit[i] * v[i] : log_K ? unit[i] : v[i];
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            size_t a = i > j ? i : j, b = i > j ? j : i;
            s->v[k * n * n + i * n + j] =
                unit[a] * unit[b] * (widen * c->covariance[a * n + b] + c->systematic[a * n + b]);
        }
    s->chi2 += c->chi2 / (double)c->freedom / (double)s->n;
}

static palp_status fit_own(specimens *s, size_t k, palp_error *error) {
    const size_t n = s->n_parameters;
    fit_problem p;
    double *v = malloc((n + 2 * n * n) * sizeof *v), chi2;
    bool converged;
    if (!v)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    fit_curvature c = {.covariance = v + n, .systematic = v + n + n * n};
    palp_status status = own_problem(s, k, &p, error);
    if (!status) {
        memcpy(v, s->shape, n * sizeof *v);
        status = fit_solve_from(&p, v, &chi2, &converged);
        fit_sort_arms(&p, v);
        if (!status)
            status = fit_find_curvature(&p, v, &c);
        if (!status)
            store(s, k, &p, v, &c);
        fit_problem_free(&p);
    }
    free(v);
    return status;
}

/* ---- the mean ---- */

/* Parameters of a spread as those of a fit. ERR_INPUT: an arm without stiffness. */
static palp_status parameters_of(const specimens *s, const double *x, double *v) {
    memcpy(v, x, s->n_parameters * sizeof *v);
    for (size_t i = s->all.n_springs; i < s->n_parameters; i += 2) {
        if (!(x[i] > 0.0))
            return PALP_ERR_INPUT;
        v[i] = log(x[i]);
    }
    return PALP_OK;
}

/* Covariance of a spread's parameters as that of coefficients, K_j and b_j = K_j tau_j at the mean. */
static void to_natural(const specimens *s, const double *c, double *to) {
    const size_t n = s->n_parameters, m = s->all.n_springs;
    double half[FIT_PARAMETERS_MAX];
    for (size_t i = 0; i < n * n; i++)
        to[i] = c[i];
    for (size_t turn = 0; turn < 2; turn++)
        for (size_t j = 0; j < n; j++) {
            for (size_t i = 0; i < n; i++)
                half[i] = turn ? to[j * n + i] : to[i * n + j];
            for (size_t i = m; i < n; i += 2) {
                double tau = exp(s->mean[i + 1]);
                half[i + 1] = tau * half[i] + s->mean[i] * tau * half[i + 1];
            }
            for (size_t i = 0; i < n; i++)
                *(turn ? &to[j * n + i] : &to[i * n + j]) = half[i];
        }
}

/* The mean specimen's fit: its covariance widened by Student's t. */
static palp_status give_mean(specimens *s) {
    const size_t n = s->n_parameters;
    const double t = statistics_student_widening(s->n - 1);
    double *v = malloc((n + 2 * n * n) * sizeof *v), unit[FIT_PARAMETERS_MAX];
    if (!v)
        return PALP_ERR_NO_MEMORY;
    fit_curvature c = {.covariance = v + n, .systematic = v + n + n * n, .chi2 = 1.0, .freedom = 1};
    memset(c.systematic, 0, n * n * sizeof *c.systematic);
    palp_status status = parameters_of(s, s->mean, v);
    for (size_t i = 0; i < n; i++)
        unit[i] = i >= s->all.n_springs && (i - s->all.n_springs) % 2 == 0 ? t / s->mean[i] : t;
    for (size_t i = 0; i < n * n; i++)
        c.covariance[i] = unit[i / n] * unit[i % n] * s->mean_covariance[i];
    palp_lumped_fit *mean = &s->fit->mean;
    if (!status)
        status = fit_finish(&s->all, v, &c, s->n_runs, s->recordings, s->settings, mean);
    if (!status && palp_material_check(&mean->material, NULL))
        status = PALP_ERR_INPUT;
    mean->reduced_chi2 = s->chi2;
    free(v);
    return status;
}

/* If the spread does not exceed chance: one fit of all without factors, unless it separates fewer arms. */
static palp_status give_one(specimens *s, palp_error *error) {
    palp_characterize_settings settings = *s->settings;
    palp_lumped_fit one;
    settings.contact = PALP_CONTACT_KNOWN;
    settings.n_arms = s->all.n_arms;
    palp_status status = palp_characterize_fit(s->n_runs, s->recordings, &settings, &one, error);
    if (status)
        return status;
    if (one.n_parameters != s->n_parameters) {
        palp_lumped_fit_free(&one);
        return give_mean(s);
    }
    one.n_merged += s->fit->mean.n_merged;
    s->fit->mean = one;
    return PALP_OK;
}

static palp_status give(specimens *s, palp_error *error) {
    const size_t n = s->n_parameters;
    palp_specimens_fit *fit = s->fit;
    fit_spread spread = {.n = n,
                         .n_specimens = s->n,
                         .x = s->x,
                         .v = s->v,
                         .mean = s->mean,
                         .mean_covariance = s->mean_covariance,
                         .between = fit->between,
                         .within = fit->within};
    palp_status status = fit_spread_find(&spread);
    fit->n_spread = spread.n_directions;
    for (size_t k = 0; k < s->n && !status; k++) {
        double v[FIT_PARAMETERS_MAX];
        status = parameters_of(s, s->x + k * n, v);
        if (!status)
            status = fit_material(&s->all, v, &fit->own[k]);
    }
    if (!status)
        status = fit->n_spread ? give_mean(s) : give_one(s, error);
    if (status)
        return status;
    memcpy(s->within, fit->between, n * n * sizeof *s->within);
    to_natural(s, s->within, fit->between);
    memcpy(s->within, fit->within, n * n * sizeof *s->within);
    to_natural(s, s->within, fit->within);
    return PALP_OK;
}

/* ---- the whole ---- */

static size_t count_specimens(size_t n, const size_t *specimen) {
    size_t count = 0;
    for (size_t r = 0; r < n; r++)
        count = specimen[r] + 1 > count ? specimen[r] + 1 : count;
    for (size_t k = 0; k < count; k++) {
        size_t r = 0;
        while (r < n && specimen[r] != k)
            r++;
        if (r == n)
            return 0;
    }
    return count;
}

static palp_status take_memory(specimens *s) {
    const size_t n = s->n_parameters, m = s->n;
    s->x = arena_take(&s->all.memory, m * n, sizeof(double));
    s->v = arena_take(&s->all.memory, m * n * n, sizeof(double));
    s->mean = arena_take(&s->all.memory, n, sizeof(double));
    s->mean_covariance = arena_take(&s->all.memory, n * n, sizeof(double));
    s->within = arena_take(&s->all.memory, n * n, sizeof(double));
    s->fit->own = calloc(m, sizeof *s->fit->own);
    s->fit->between = calloc(n * n, sizeof(double));
    s->fit->within = calloc(n * n, sizeof(double));
    bool whole = s->fit->own && s->fit->between && s->fit->within && !s->all.memory.failed;
    return whole ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* The common shape, with the arms that the data separate. */
static palp_status find_shape(specimens *s) {
    size_t n = fit_parameter_count(&s->all);
    double *room = arena_take(&s->all.memory, 2 * n * n, sizeof *room);
    s->shape = arena_take(&s->all.memory, n, sizeof(double));
    s->fit->factor = malloc(s->n * sizeof(double));
    if (!room || !s->shape || !s->fit->factor)
        return PALP_ERR_NO_MEMORY;
    fit_curvature c = {.covariance = room, .systematic = room + n * n};
    palp_status status = level(&s->all, s->specimen, s->n, s->shape, s->fit->factor);
    return status ? status : fit_solve_and_merge(&s->all, s->shape, &c, &s->fit->mean);
}

static palp_status solve(specimens *s, palp_error *error) {
    palp_status status = find_shape(s);
    s->n_parameters = fit_parameter_count(&s->all);
    if (!status)
        status = take_memory(s);
    for (size_t k = 0; k < s->n && !status; k++)
        status = fit_own(s, k, error);
    return status ? status : give(s, error);
}

palp_status palp_characterize_specimens(size_t n, const palp_recording *recordings, const size_t *specimen,
                                        const palp_characterize_settings *settings, palp_specimens_fit *fit,
                                        palp_error *error) {
    if (!recordings || !specimen || !settings || !fit)
        return palp_error_null(error);
    palp_error own = {PALP_OK, ""};
    specimens s = {.n_runs = n,
                   .n = count_specimens(n, specimen),
                   .recordings = recordings,
                   .specimen = specimen,
                   .settings = settings,
                   .fit = fit};
    memset(fit, 0, sizeof *fit);
    if (settings->arms != PALP_ARMS_FREE)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "arms of several specimens are free ones");
    if (s.n < 2 || settings->spring != PALP_SPRING_LAW)
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "two specimens or more are needed, each with a recording, and one law");
    palp_status status = fit_problem_create(&s.all, n, recordings, settings, error);
    if (status)
        return status;
    fit->n_specimens = s.n;
    status = solve(&s, &own);
    fit_problem_free(&s.all);
    if (status) {
        palp_specimens_fit_free(fit);
        if (own.text[0] || status == PALP_ERR_INPUT)
            palp_error_set(error, status, "%s",
                           own.text[0] ? own.text : "the mean of the specimens is no material");
        else
            fit_failed(error, status, recordings[0].name);
    }
    return status;
}

palp_status palp_characterize_level(size_t n, const palp_recording *recordings, const size_t *specimen,
                                    const palp_characterize_settings *settings, double *factor,
                                    palp_error *error) {
    if (!recordings || !specimen || !settings || !factor)
        return palp_error_null(error);
    fit_problem p;
    size_t n_specimens = count_specimens(n, specimen);
    if (n_specimens == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a specimen without a recording");
    palp_status status = fit_problem_create(&p, n, recordings, settings, error);
    if (status)
        return status;
    double *v = calloc(fit_parameter_count(&p), sizeof *v);
    status = v ? level(&p, specimen, n_specimens, v, factor) : PALP_ERR_NO_MEMORY;
    free(v);
    fit_problem_free(&p);
    return status ? fit_failed(error, status, recordings[0].name) : PALP_OK;
}

/* ---- K(e) ---- */

/* Sd of K at the strain by another covariance. */
static palp_status sd_by(const palp_specimens_fit *fit, double *covariance, double strain, double *stiffness,
                         double *sd) {
    palp_lumped_fit other = fit->mean;
    other.covariance = covariance;
    return palp_lumped_fit_stiffness(&other, 1, &strain, stiffness, sd);
}

palp_status palp_specimens_fit_stiffness(const palp_specimens_fit *fit, size_t n, const double *strain,
                                         palp_specimens_point *point) {
    if (!fit || !strain || !point || fit->n_specimens < 2)
        return PALP_ERR_ARGUMENT;
    const size_t freedom = fit->n_specimens - 1;
    const double t = statistics_student_widening(freedom);
    const double most = (double)freedom / statistics_chi2_quantile(freedom, 0.025);
    const double least = (double)freedom / statistics_chi2_quantile(freedom, 0.975);
    palp_status status = PALP_OK;
    for (size_t i = 0; i < n && !status; i++) {
        palp_specimens_point *at = &point[i];
        status = sd_by(fit, fit->mean.covariance, strain[i], &at->stiffness_N, &at->sd_N);
        if (!status)
            status = sd_by(fit, fit->between, strain[i], &at->stiffness_N, &at->between_N);
        if (!status)
            status = sd_by(fit, fit->within, strain[i], &at->stiffness_N, &at->within_N);
        double own = at->within_N * at->within_N, both = at->between_N * at->between_N + own;
        at->between_low = sqrt(fmax(least * both - own, 0.0));
        at->between_high = sqrt(fmax(most * both - own, 0.0));
        if (fit->high > 0.0) {
            at->between_low = fit->low * at->between_N;
            at->between_high = fit->high * at->between_N;
        }
        at->new_sd_N = hypot(at->sd_N, (fit->n_spread ? t : 1.0) * at->between_N);
    }
    return status;
}
