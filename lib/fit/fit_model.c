/* fit_model.c: the prediction of a parameter vector, and its residuals. */
#include "base/dense.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t fit_parameter_count(const fit_problem *p) {
    return p->n_springs + 2 * p->n_arms;
}

void fit_arm_response(const fit_run *run, double tau, double *response, double *slope) {
    double q = run->strain[0], dq = 0.0; /* the first sample's strain is applied at once */
    double x = 0.0, decay = 1.0, mean = 1.0;
    for (size_t i = 0; i < run->n; i++) {
        if (i > 0) {
            double step = (run->time[i] - run->time[i - 1]) / tau, de = run->strain[i] - run->strain[i - 1];
            if (fabs(step - x) > 1e-10 * x) { /* even samples differ by rounding */
                double lost = -expm1(-step);
                x = step;
                decay = 1.0 - lost;
                mean = x < 1e-8 ? 1.0 - 0.5 * x : lost / x;
            }
            dq = decay * dq + x * decay * q + (mean - decay) * de;
            q = decay * q + mean * de;
        }
        response[i] = q;
        if (slope)
            slope[i] = dq;
    }
}

palp_status fit_law(const fit_problem *p, const double *v, palp_law *law) {
    if (p->settings->spring == PALP_SPRING_PER_RUN) {
        double sum = 0.0;
        for (size_t r = 0; r < p->n_runs; r++)
            sum += v[r] / (double)p->n_runs;
        return palp_law_polynomial(1, &sum, law);
    }
    *law = p->law;
    return palp_law_set_coefficients(law, v);
}

palp_status fit_material(const fit_problem *p, const double *v, palp_material *material) {
    memset(material, 0, sizeof *material);
    const double *arm = v + p->n_springs;
    material->n_arms = p->n_arms;
    for (size_t j = 0; j < p->n_arms; j++) {
        double k = exp(arm[2 * j]), b = k * exp(arm[2 * j + 1]);
        material->arms[j] = (palp_arm){.stiffness_N = k, .viscosity_Ns = b};
    }
    return fit_law(p, v, &material->law);
}

/* Spring force of run r and, unless NULL, its derivatives by the spring's parameters: one where each run has
 * its own. */
static void spring(const fit_problem *p, const palp_law *law, const double *v, size_t r, double e,
                   double *force, double *derivative) {
    if (p->settings->spring == PALP_SPRING_PER_RUN) {
        *force = v[r] * e;
        if (derivative)
            derivative[0] = e;
        return;
    }
    palp_law_force(law, 1, &e, force, NULL, NULL);
    if (derivative)
        palp_law_gradient(law, e, derivative);
}

/* An impossible spring, as a line search may ask for: its residual is ten times that of zero force. */
static palp_status no_spring(const fit_problem *p, double *residual, double *jacobian) {
    for (size_t r = 0, row = 0; r < p->n_runs; r++)
        for (size_t i = 0; i < p->run[r].n; i++, row++)
            residual[row] = -10.0 * sqrt(p->run[r].count[i]) / p->run[r].noise * p->run[r].force[i];
    if (jacobian)
        memset(jacobian, 0, p->n_blocks * fit_parameter_count(p) * sizeof *jacobian);
    return PALP_OK;
}

/* A row of the history only, or one that is held out. */
static void silence(const fit_problem *p, size_t row, double *residual, double *jacobian) {
    size_t n = fit_parameter_count(p);
    residual[row] = 0.0;
    for (size_t k = 0; k < n && jacobian; k++)
        jacobian[k * p->n_blocks + row] = 0.0;
}

palp_status fit_evaluate(const fit_problem *p, const double *v, double *residual, double *jacobian) {
    palp_law law;
    bool sound = true;
    if (fit_law(p, v, &law))
        return no_spring(p, residual, jacobian);
    size_t longest = 0, first = 0, m = p->n_blocks;
    for (size_t r = 0; r < p->n_runs; r++)
        longest = p->run[r].n > longest ? p->run[r].n : longest;
    double *response = malloc((2 * p->n_arms * longest + p->n_springs + 1) * sizeof *response);
    if (!response)
        return PALP_ERR_NO_MEMORY;
    double *by_spring = response + 2 * p->n_arms * longest;
    bool own = p->settings->spring == PALP_SPRING_PER_RUN;
    if (jacobian && own)
        memset(jacobian, 0, p->n_springs * m * sizeof *jacobian);
    for (size_t r = 0; r < p->n_runs; first += p->run[r++].n) {
        const fit_run *run = &p->run[r];
        const double *arm = v + p->n_springs;
        double stiffnesses[PALP_ARMS_MAX];
        for (size_t j = 0; j < p->n_arms; j++) {
            stiffnesses[j] = exp(arm[2 * j]);
            fit_arm_response(run, exp(arm[2 * j + 1]), response + 2 * j * longest,
                             jacobian ? response + (2 * j + 1) * longest : NULL);
        }
        double at = NAN, plain = 0.0; /* the strain of the row before, and the spring's force there */
        bool pulled = false;
        for (size_t i = 0; i < run->n; i++) {
            size_t row = first + i;
            double weight = sqrt(run->count[i]) / run->noise;
            if (weight == 0.0) {
                silence(p, row, residual, jacobian);
                if (!run->leaves)
                    continue;
            }
            if (run->strain[i] != at)
                spring(p, &law, v, r, at = run->strain[i], &plain, jacobian ? by_spring : NULL);
            double force = plain;
            for (size_t k = 0; k < (own ? 1 : p->n_springs) && jacobian; k++)
                jacobian[(own ? r : k) * m + row] = weight * by_spring[k];
            for (size_t j = 0; j < p->n_arms; j++) {
                double stiffness = stiffnesses[j], q = stiffness * response[2 * j * longest + i];
                force += q;
                if (jacobian) {
                    jacobian[(p->n_springs + 2 * j) * m + row] = weight * q;
                    jacobian[(p->n_springs + 2 * j + 1) * m + row] =
                        weight * stiffness * response[(2 * j + 1) * longest + i];
                }
            }
            residual[row] = weight * (force - run->force[i]);
            pulled = pulled || force < 0.0;
        }
        if (pulled && run->leaves && fit_run_one_sided(p, &law, v, r, first, residual, jacobian)) {
            free(response);
            return PALP_ERR_NO_MEMORY;
        }
        for (size_t i = first; i < first + run->n; i++)
            sound = sound && isfinite(residual[i]);
    }
    free(response);
    return sound ? PALP_OK : no_spring(p, residual, jacobian);
}

palp_status fit_invert(size_t n, double *a, double *inverse) {
    const double most = 1e-8;
    double ridge = 1e-14, *scale = malloc((n * n + n) * sizeof *scale), *plain = scale + n;
    bool done = false;
    if (!scale)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++)
        scale[i] = a[i * n + i] > 0.0 ? 1.0 / sqrt(a[i * n + i]) : 1.0;
    memcpy(plain, a, n * n * sizeof *plain);
    for (; !done && ridge < most; ridge *= 10.0) {
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++) {
                a[i * n + j] = plain[i * n + j] * scale[i] * scale[j] + (i == j ? ridge : 0.0);
                inverse[i * n + j] = i == j ? scale[i] : 0.0;
            }
        done = dense_cholesky(n, a);
    }
    if (done)
        dense_cholesky_solve(n, a, n, inverse);
    for (size_t i = 0; i < n * n && done; i++) {
        inverse[i] *= scale[i % n];
        done = isfinite(inverse[i]);
    }
    free(scale);
    return done ? PALP_OK : PALP_ERR_SINGULAR;
}
