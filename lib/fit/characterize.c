/* characterize.c: the fit's result: estimates with intervals, merged arms, residuals of each recording. */
#include <palpate/forward.h>

#include "base/dense.h"
#include "base/file.h"
#include "fit_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double Z95 = 1.959963984540054;

palp_characterize_settings palp_characterize_settings_default(void) {
    return (palp_characterize_settings){
        .spring = PALP_SPRING_PER_RUN, .n_arms = 0, .dwell_only = false, .starts = 4, .max_evaluations = 300};
}

void palp_lumped_fit_free(palp_lumped_fit *fit) {
    if (!fit)
        return;
    free(fit->spring_N);
    free(fit->rms_N);
    free(fit->absolute_N);
    free(fit->estimate);
    free(fit->correlation);
    free(fit->covariance);
    free(fit->contact_m);
    free(fit->contact_sd_m);
    memset(fit, 0, sizeof *fit);
}

void fit_sort_arms(const fit_problem *p, double *v) {
    double *arm = v + p->n_springs;
    for (size_t j = 1; j < p->n_arms; j++)
        for (size_t k = j; k > 0 && arm[2 * k + 1] < arm[2 * k - 1]; k--)
            for (size_t c = 0; c < 2; c++) {
                double t = arm[2 * k + c];
                arm[2 * k + c] = arm[2 * k - 2 + c];
                arm[2 * k - 2 + c] = t;
            }
}

/* Rows of the map from the parameters' covariance to that of the estimates: springs, then log K, log b,
 * log tau of each arm. */
static double map(const fit_problem *p, size_t estimate, size_t parameter) {
    if (estimate < p->n_springs)
        return estimate == parameter;
    size_t j = (estimate - p->n_springs) / 3, what = (estimate - p->n_springs) % 3, k = p->n_springs + 2 * j;
    return (parameter == k && what < 2) || (parameter == k + 1 && what > 0);
}

static double mapped(const fit_problem *p, const double *covariance, size_t a, size_t b) {
    size_t n = fit_parameter_count(p);
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double m = map(p, a, i) * map(p, b, j);
            sum += m != 0.0 ? m * covariance[i * n + j] : 0.0;
        }
    return sum;
}

static void name_estimate(const fit_problem *p, size_t i, palp_estimate *e) {
    static const char *const ARM[] = {"K", "b", "tau"}, *const UNIT[] = {"N", "N s", "s"};
    bool law = p->settings->spring == PALP_SPRING_LAW;
    if (i >= p->n_springs) {
        size_t j = (i - p->n_springs) / 3, what = (i - p->n_springs) % 3;
        snprintf(e->name, sizeof e->name, "%s_%zu", ARM[what], j + 1);
        e->unit = UNIT[what];
        return;
    }
    bool pascal = law && p->law.kind != PALP_LAW_POLYNOMIAL && p->law.kind != PALP_LAW_SPLINE;
    snprintf(e->name, sizeof e->name, law ? "c%zu" : "K_inf [%zu]", law ? i : i + 1);
    e->unit = pascal ? (p->law.kind == PALP_LAW_OGDEN && i % 2 ? "1" : "Pa") : "N";
}

static void estimate(const fit_problem *p, const double *v, double variance, size_t i, palp_estimate *e) {
    name_estimate(p, i, e);
    double sd = sqrt(fmax(variance, 0.0));
    if (i < p->n_springs) {
        *e = (palp_estimate){
            .unit = e->unit, .value = v[i], .sd = sd, .low = v[i] - Z95 * sd, .high = v[i] + Z95 * sd};
        name_estimate(p, i, e);
        e->determined = e->low > 0.0 || (p->settings->spring == PALP_SPRING_LAW && e->high < 0.0);
        return;
    }
    size_t k = p->n_springs + 2 * ((i - p->n_springs) / 3);
    double logarithm = map(p, i, k) * v[k] + map(p, i, k + 1) * v[k + 1];
    e->value = exp(logarithm);
    e->sd = e->value * sd;
    e->low = exp(logarithm - Z95 * sd);
    e->high = exp(logarithm + Z95 * sd);
    e->determined = 2.0 * Z95 * sd < log(10.0);
}

/* From that of the estimates, springs and log K, log b, log tau of the arms, below the diagonal. */
static palp_status fill_covariance(const fit_problem *p, palp_lumped_fit *fit) {
    size_t n = p->n_springs + 2 * p->n_arms, m = fit->n_estimates;
    fit->n_parameters = n;
    fit->covariance = malloc(n * n * sizeof *fit->covariance);
    if (!fit->covariance)
        return PALP_ERR_NO_MEMORY;
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b <= a; b++) {
            size_t i =
                a < p->n_springs ? a : p->n_springs + 3 * ((a - p->n_springs) / 2) + (a - p->n_springs) % 2;
            size_t j =
                b < p->n_springs ? b : p->n_springs + 3 * ((b - p->n_springs) / 2) + (b - p->n_springs) % 2;
            double scale = (a < p->n_springs ? 1.0 : fit->estimate[i].value) *
                           (b < p->n_springs ? 1.0 : fit->estimate[j].value);
            double most =
                sqrt(fmax(fit->correlation[i * m + i], 0.0) * fmax(fit->correlation[j * m + j], 0.0));
            fit->covariance[a * n + b] = fit->covariance[b * n + a] =
                scale *
                fmax(fmin(fit->correlation[i * m + j], most), -most); /* but for rounding it is within them */
        }
    return PALP_OK;
}

palp_status palp_lumped_fit_stiffness(const palp_lumped_fit *fit, size_t n, const double *strain,
                                      double *stiffness_N, double *sd_N) {
    if (!fit || !strain || !stiffness_N || !sd_N || fit->spring_N || !fit->covariance)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        const double small = 1e-9; /* K is the force over the strain, at 0 its limit */
        double e = fmax(fabs(strain[i]), small), by[PALP_LAW_MAX], sum = 0.0;
        palp_law_stiffness(&fit->material.law, e, &stiffness_N[i], NULL);
        palp_law_gradient(&fit->material.law, e, by);
        for (size_t a = 0; a < fit->material.law.n; a++)
            for (size_t b = 0; b < fit->material.law.n; b++)
                sum += by[a] * by[b] * fit->covariance[a * fit->n_parameters + b];
        sd_N[i] = sqrt(fmax(sum, 0.0)) / e;
    }
    return PALP_OK;
}

static palp_status fill_estimates(const fit_problem *p, const double *v, const fit_curvature *c,
                                  palp_lumped_fit *fit) {
    size_t n = p->n_springs + 3 * p->n_arms;
    fit->n_estimates = n;
    fit->estimate = calloc(n, sizeof *fit->estimate);
    fit->correlation = calloc(n * n, sizeof *fit->correlation);
    if (!fit->estimate || !fit->correlation)
        return PALP_ERR_NO_MEMORY;
    fit->reduced_chi2 = c->chi2 / (double)c->freedom;
    fit->inflation = fit_inflation(c);
    double widen = fit->inflation * fit->inflation;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
            fit->correlation[i * n + j] =
                widen * mapped(p, c->covariance, i, j) + mapped(p, c->systematic, i, j);
    for (size_t i = 0; i < n; i++)
        estimate(p, v, fit->correlation[i * n + i], i, &fit->estimate[i]);
    if (fill_covariance(p, fit))
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            double sd = sqrt(fit->correlation[i * n + i] * fit->correlation[j * n + j]);
            fit->correlation[i * n + j] = fit->correlation[j * n + i] =
                sd > 0.0 ? fit->correlation[i * n + j] / sd : 0.0;
        }
    for (size_t i = 0; i < n; i++)
        fit->correlation[i * n + i] = 1.0;
    return PALP_OK;
}

/* Strains become the force of a law and arms. */
static void run_along(const palp_material *material, size_t n, const double *time, double *at) {
    enum { MANY = 256 };
    double strain[MANY], arm[PALP_ARMS_MAX] = {0}, before = 0.0;
    element_steps steps = {0};
    for (size_t first = 0, many; first < n; first += many) {
        many = n - first < MANY ? n - first : MANY;
        memcpy(strain, at + first, many * sizeof *strain);
        palp_law_force(&material->law, many, strain, at + first, NULL, NULL);
        for (size_t i = 0, s = first; i < many; i++, s++) {
            const element_step *step = element_steps_of(material, s ? time[s] - time[s - 1] : 0.0, &steps);
            for (size_t j = 0; j < material->n_arms; j++) {
                arm[j] = step->decay[j] * arm[j] + step->gain[j] * (strain[i] - before);
                at[s] += arm[j];
            }
            before = strain[i];
        }
    }
}

/* The same of arms that the elastic force drives, and of a surface that the plate may leave. */
static palp_status run_quasi_linear(const palp_material *material, const palp_recording *rec, double *at) {
    const palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = rec->height_m, .material = *material};
    double *depth = malloc(rec->n * sizeof *depth);
    if (!depth)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < rec->n; i++)
        depth[i] = at[i] * rec->height_m;
    const palp_forward_run run = {.n = rec->n, .time_s = rec->time_s, .depth_m = depth};
    palp_status status = palp_forward_force(&model, &run, at, NULL, NULL);
    free(depth);
    return status;
}

palp_status palp_lumped_fit_force(const palp_lumped_fit *fit, size_t run, const palp_recording *rec,
                                  double *force_N) {
    if (!fit || !rec || !force_N)
        return PALP_ERR_ARGUMENT;
    palp_material material = fit->material;
    palp_status status = PALP_OK;
    if (fit->spring_N) {
        if (run >= fit->n_runs)
            return PALP_ERR_ARGUMENT;
        status = palp_law_polynomial(1, &fit->spring_N[run], &material.law);
    }
    double contact = fit->contact_m && run < fit->n_runs ? fit->contact_m[run] : 0.0;
    for (size_t i = 0; i < rec->n && !status; i++) {
        double depth = rec->depth_m[i] - (rec->depth_m[i] > 0.0 ? contact : 0.0);
        force_N[i] = (depth > 0.0 ? depth : 0.0) / rec->height_m;
        if ((i && !(rec->time_s[i] >= rec->time_s[i - 1])) || !isfinite(depth))
            return PALP_ERR_ARGUMENT;
    }
    if (status)
        return status;
    if (material.quasi_linear)
        return run_quasi_linear(&material, rec, force_N);
    bool leaves = fit_leaves(rec);
    double *strain = leaves ? malloc(rec->n * sizeof *strain) : NULL;
    if (leaves && !strain)
        return PALP_ERR_NO_MEMORY;
    if (leaves)
        memcpy(strain, force_N, rec->n * sizeof *strain);
    run_along(&material, rec->n, rec->time_s, force_N);
    for (size_t i = 0; i < rec->n && leaves; i++)
        if (force_N[i] < 0.0) {
            memcpy(force_N, strain, rec->n * sizeof *strain);
            fit_force_one_sided(&material, rec->n, rec->time_s, force_N);
            break;
        }
    free(strain);
    return PALP_OK;
}

palp_status fit_fill_residuals(size_t n, const palp_recording *recordings,
                               const palp_characterize_settings *settings, palp_lumped_fit *fit) {
    palp_status status = PALP_OK;
    for (size_t r = 0; r < n && !status; r++) {
        const palp_recording *rec = &recordings[r];
        double square = 0.0, used = 0.0, *force = malloc(rec->n * sizeof *force);
        status = force ? palp_lumped_fit_force(fit, r, rec, force) : PALP_ERR_NO_MEMORY;
        for (size_t i = 0; i < rec->n && !status; i++) {
            if (!fit_counts(rec, settings, i))
                continue;
            double miss = force[i] - rec->force_N[i];
            square += miss * miss;
            fit->absolute_N[r] += fabs(miss);
            used += 1.0;
        }
        fit->rms_N[r] = used > 0.0 ? sqrt(square / used) : 0.0;
        free(force);
    }
    return status;
}

palp_status fit_solve_and_merge(fit_problem *p, double *v, fit_curvature *c, palp_lumped_fit *fit) {
    for (;;) {
        double chi2;
        palp_status status = fit_solve(p, v, &chi2, &fit->converged);
        if (status)
            return status;
        fit_sort_arms(p, v);
        status = fit_find_curvature(p, v, c);
        if (status || !fit->converged || p->n_arms == 0 ||
            fit_weakest_arm(p, v, c->covariance, fit_inflation(c)) == p->n_arms)
            return status;
        p->n_arms--;
        fit->n_merged++;
    }
}

palp_status fit_finish(fit_problem *p, const double *v, const fit_curvature *c, size_t n,
                       const palp_recording *recordings, const palp_characterize_settings *settings,
                       palp_lumped_fit *fit) {
    fit->n_runs = n;
    fit->constrained = p->least > 0.0;
    fit->rms_N = calloc(n, sizeof(double));
    fit->absolute_N = calloc(n, sizeof(double));
    if (settings->spring == PALP_SPRING_PER_RUN)
        fit->spring_N = malloc(n * sizeof(double));
    if (!fit->rms_N || !fit->absolute_N || (settings->spring == PALP_SPRING_PER_RUN && !fit->spring_N))
        return PALP_ERR_NO_MEMORY;
    if (fit->spring_N)
        memcpy(fit->spring_N, v, n * sizeof *v);
    palp_status status = fit_material(p, v, &fit->material);
    if (!status)
        status = fill_estimates(p, v, c, fit);
    return status ? status : fit_fill_residuals(n, recordings, settings, fit);
}

palp_status fit_failed(palp_error *error, palp_status status, const char *recording) {
    const char *what = status == PALP_ERR_SINGULAR
                           ? "the recordings do not determine the parameters of this law "
                             "and these arms: take fewer arms or a simpler law, "
                             "or add recordings of other depths and speeds"
                           : palp_status_text(status);
    return error && error->text[0] ? status : palp_error_set(error, status, "%s: %s", recording, what);
}

palp_status palp_characterize_fit(size_t n, const palp_recording *recordings,
                                  const palp_characterize_settings *settings, palp_lumped_fit *fit,
                                  palp_error *error) {
    if (!recordings || !settings || !fit)
        return palp_error_null(error);
    fit_problem p;
    memset(fit, 0, sizeof *fit);
    palp_status status = fit_problem_create(&p, n, recordings, settings, error);
    if (status)
        return status;
    size_t parameters = fit_parameter_count(&p);
    double *v = calloc(parameters, sizeof *v);
    fit_curvature c = {.covariance = calloc(2 * parameters * parameters + 1, sizeof(double))};
    c.systematic = c.covariance ? c.covariance + parameters * parameters : NULL;
    double theta[3] = {0};
    status = v && c.covariance ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && p.n_times) {
        status = fit_solve_spectrum(&p, v, theta, &fit->converged);
        status = status ? status : fit_find_curvature(&p, v, &c);
    } else if (!status) {
        status = fit_solve_and_merge(&p, v, &c, fit);
    }
    if (!status)
        status = fit_finish(&p, v, &c, n, recordings, settings, fit);
    if (!status && settings->arms == PALP_ARMS_FRACTIONAL)
        status = fit_estimate_fractional(&p, theta, &c, fit);
    free(v);
    free(c.covariance);
    fit_problem_free(&p);
    if (status) {
        palp_lumped_fit_free(fit);
        fit_failed(error, status, recordings[0].name);
    }
    return status;
}
