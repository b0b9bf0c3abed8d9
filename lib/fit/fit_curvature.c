/* fit_curvature.c: covariance of a fit's parameters: curvature of its chi2, correlated noise, wrong
 * contacts. */
#include "base/dense.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Adds the effect on the parameters of an error that shifts the residuals of run r by shift[run's n]; move[2
 * n] is scratch. */
static void add_systematic(const fit_problem *p, const double *jacobian, size_t first, size_t blocks,
                           const double *shift, double *move, fit_curvature *c) {
    size_t n = fit_parameter_count(p);
    double *pull = move + n;
    for (size_t a = 0; a < n; a++) {
        pull[a] = 0.0;
        for (size_t i = 0; i < blocks; i++)
            pull[a] += jacobian[a * p->n_blocks + first + i] * shift[i];
    }
    for (size_t a = 0; a < n; a++) {
        move[a] = 0.0;
        for (size_t b = 0; b < n; b++)
            move[a] += c->covariance[a * n + b] * pull[b];
    }
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            c->systematic[a * n + b] += move[a] * move[b];
}

/* Residuals with every contact one sd earlier. */
static palp_status earlier_contact(const fit_problem *p, const double *v, double *residual) {
    double *saved = malloc(p->n_blocks * sizeof *saved);
    if (!saved)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0, first = 0; r < p->n_runs; first += p->run[r++].n) {
        const fit_run *run = &p->run[r];
        memcpy(saved + first, run->strain, run->n * sizeof *saved);
        for (size_t i = 0; i < run->n; i++)
            run->strain[i] += run->strain[i] > 0.0 ? run->contact_sd : 0.0;
    }
    palp_status status = fit_evaluate(p, v, residual, NULL);
    for (size_t r = 0, first = 0; r < p->n_runs; first += p->run[r++].n)
        memcpy(p->run[r].strain, saved + first, p->run[r].n * sizeof *saved);
    free(saved);
    return status;
}

/* The residual's slopes by the strain of a run's blocks, for a plate whose position wanders in time seconds:
 * arms that relax faster do not respond. */
static palp_status slopes_by_place(const fit_problem *p, const double *v, size_t r, double time,
                                   double *slope) {
    const fit_run *run = &p->run[r];
    const double *arm = v + p->n_springs;
    palp_law law;
    palp_status status = p->settings->spring == PALP_SPRING_PER_RUN ? palp_law_polynomial(1, &v[r], &law)
                                                                    : fit_law(p, v, &law);
    double answer = 0.0, force;
    for (size_t j = 0; j < p->n_arms; j++)
        answer += exp(arm[2 * j]) / (1.0 + time / exp(arm[2 * j + 1]));
    for (size_t i = 0; i < run->n && !status; i++) {
        palp_law_force(&law, 1, &run->strain[i], &force, &slope[i], NULL);
        slope[i] = run->strain[i] > 0.0 ? (slope[i] + answer) * sqrt(run->count[i]) / run->noise : 0.0;
    }
    return status;
}

/* Covariance sum[n n] of the parameters by position errors of a run's blocks, correlated over time seconds.
 * moves[n blocks] by rows: derivative of the parameters by each block's residual. work[3 blocks]. */
static void sum_wander(const fit_run *run, size_t n, const double *moves, double time, const double *slope,
                       double *work, double *sum) {
    double *near = work, *decay = work + run->n, *row = work + 2 * run->n;
    for (size_t i = 0; i < run->n; i++)
        decay[i] = i ? exp((run->time[i - 1] - run->time[i]) / time) : 0.0;
    for (size_t a = 0; a < n; a++) {
        double later = 0.0;
        for (size_t i = 0; i < run->n; i++) {
            row[i] = moves[a * run->n + i] * slope[i] * run->place_sd;
            near[i] = row[i] + (i ? decay[i] * near[i - 1] : 0.0);
        }
        for (size_t i = run->n; i-- > 0;) {
            near[i] += later;
            later = decay[i] * (later + row[i]);
        }
        for (size_t b = 0; b < n; b++) {
            sum[a * n + b] = 0.0;
            for (size_t i = 0; i < run->n; i++)
                sum[a * n + b] += near[i] * moves[b * run->n + i] * slope[i] * run->place_sd;
        }
    }
}

/* A plate wanders within a count of its encoder, with any correlation time. The correlations are those of the
 * time that is worst for all parameters together; each variance is that of the time that is worst for
 * itself. */
static palp_status add_wander(const fit_problem *p, const double *v, const double *jacobian, size_t r,
                              size_t first, fit_curvature *c) {
    const fit_run *run = &p->run[r];
    size_t n = fit_parameter_count(p), blocks = run->n;
    double *moves = calloc(n * blocks + 4 * blocks + 2 * n * n + n, sizeof *moves), most = 0.0;
    if (!moves)
        return PALP_ERR_NO_MEMORY;
    double *slope = moves + n * blocks, *work = slope + blocks, *sum = work + 3 * blocks,
           *worst = sum + n * n, *own = worst + n * n;
    for (size_t a = 0; a < n; a++)
        for (size_t i = 0; i < blocks; i++)
            for (size_t b = 0; b < n; b++)
                moves[a * blocks + i] += c->covariance[a * n + b] * jacobian[b * p->n_blocks + first + i];
    palp_status status = PALP_OK;
    for (double time = run->end; time > p->tau_min && !status; time /= 3.0) {
        double size = 0.0;
        status = slopes_by_place(p, v, r, time, slope);
        sum_wander(run, n, moves, time, slope, work, sum);
        for (size_t a = 0; a < n; a++) {
            size += c->covariance[a * n + a] > 0.0 ? sum[a * n + a] / c->covariance[a * n + a] : 0.0;
            own[a] = fmax(own[a], sum[a * n + a]);
        }
        if (size > most)
            memcpy(worst, sum, n * n * sizeof *worst);
        most = fmax(most, size);
    }
    for (size_t a = 0; a < n; a++)
        own[a] = worst[a * n + a] > 0.0 ? sqrt(own[a] / worst[a * n + a]) : 1.0;
    for (size_t a = 0; a < n * n && !status; a++)
        c->systematic[a] += own[a / n] * own[a % n] * worst[a];
    free(moves);
    return status;
}

/* A wrong zero shifts a whole recording, force or depth, and more samples do not help. */
static palp_status find_systematic(const fit_problem *p, const double *v, const double *residual,
                                   const double *jacobian, fit_curvature *c) {
    size_t n = fit_parameter_count(p), m = p->n_blocks;
    double *shift = malloc((2 * m + 2 * n) * sizeof *shift);
    palp_status status = shift ? earlier_contact(p, v, shift + m) : PALP_ERR_NO_MEMORY;
    memset(c->systematic, 0, n * n * sizeof *c->systematic);
    for (size_t r = 0, first = 0; r < p->n_runs && !status; first += p->run[r++].n) {
        const fit_run *run = &p->run[r];
        for (size_t i = 0; i < run->n; i++) {
            shift[i] = sqrt(run->count[i]) / run->noise * run->zero_sd;
            shift[m + first + i] -= residual[first + i];
        }
        add_systematic(p, jacobian, first, run->n, shift, shift + 2 * m, c);
        add_systematic(p, jacobian, first, run->n, shift + m + first, shift + 2 * m, c);
        if (run->place_sd > 0.0)
            status = add_wander(p, v, jacobian, r, first, c);
    }
    free(shift);
    return status;
}

void fit_sum_residual(const fit_problem *p, const double *residual, fit_curvature *c) {
    double own = 0.0, next = 0.0;
    size_t used = 0, n = fit_parameter_count(p);
    for (size_t run = 0, i = 0; run < p->n_runs; run++) {
        double last = 0.0;
        for (size_t b = 0; b < p->run[run].n; b++, i++) {
            if (p->run[run].count[b] == 0.0)
                continue;
            own += residual[i] * residual[i];
            next += residual[i] * last;
            last = residual[i];
            used++;
        }
    }
    c->chi2 = own;
    c->correlation = own > 0.0 ? next / own : 0.0;
    c->freedom = used > n ? used - n : 1;
}

/* Covariance of all parameters that depend on fewer ones: T (T' square T)^-1 T'. */
static palp_status invert_reduced(const fit_problem *p, const double *square, double *covariance) {
    size_t n = fit_parameter_count(p), q = p->n_reduced;
    double *half = malloc((2 * n * q + 2 * q * q) * sizeof *half), *back = half + n * q,
           *small = back + n * q, *inverse = small + q * q;
    if (!half)
        return PALP_ERR_NO_MEMORY;
    dense_product(n, q, n, square, p->reduced, half);
    dense_transposed_product(q, q, n, p->reduced, half, small);
    palp_status status = fit_invert(q, small, inverse);
    dense_product(n, q, q, p->reduced, inverse, back);
    for (size_t a = 0; a < n && !status; a++)
        for (size_t b = 0; b < n; b++) {
            covariance[a * n + b] = 0.0;
            for (size_t k = 0; k < q; k++)
                covariance[a * n + b] += back[k * n + a] * p->reduced[k * n + b];
        }
    free(half);
    return status;
}

palp_status fit_find_curvature(const fit_problem *p, const double *v, fit_curvature *c) {
    size_t n = fit_parameter_count(p), m = p->n_blocks;
    double *r = malloc((m + m * n + n * n) * sizeof *r), *jacobian = r + m, *square = jacobian + m * n;
    if (!r)
        return PALP_ERR_NO_MEMORY;
    palp_status status = fit_evaluate(p, v, r, jacobian);
    if (!status) {
        fit_sum_residual(p, r, c);
        dense_transposed_product(n, n, m, jacobian, jacobian, square);
        status =
            p->n_reduced ? invert_reduced(p, square, c->covariance) : fit_invert(n, square, c->covariance);
    }
    if (!status)
        status = find_systematic(p, v, r, jacobian, c);
    free(r);
    return status;
}

double fit_inflation(const fit_curvature *c) {
    double misfit = c->chi2 / (double)c->freedom, rho = fmin(fmax(c->correlation, 0.0), 0.98);
    if (rho < 3.0 / sqrt((double)c->freedom))
        rho = 0.0;
    return sqrt(fmax(1.0, misfit) * (1.0 + rho) / (1.0 - rho));
}

/* Sd of log tau of arm j + 1 less that of arm j, whose parameter is a. */
static double sd_apart(size_t n, size_t a, const double *covariance) {
    size_t b = a + 2;
    return sqrt(fmax(covariance[a * n + a] + covariance[b * n + b] - 2.0 * covariance[a * n + b], 0.0));
}

size_t fit_weakest_arm(const fit_problem *p, const double *v, const double *covariance, double widen) {
    size_t n = fit_parameter_count(p);
    for (size_t j = 0; j < p->n_arms; j++) {
        size_t k = p->n_springs + 2 * j;
        if (sqrt(fmax(covariance[k * n + k], 0.0)) * widen > 2.0)
            return j;
        if (j + 1 == p->n_arms)
            break;
        double apart = v[k + 3] - v[k + 1];
        if (apart < 0.14 || apart < 2.0 * sd_apart(n, k + 1, covariance) * widen)
            return j;
    }
    return p->n_arms;
}
