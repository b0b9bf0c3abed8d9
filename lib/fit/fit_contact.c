/* fit_contact.c: contacts that differ from the assumed ones: nuisance parameters of the fit. */
#include "base/arena.h"
#include "base/dense.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Contact of every run later by shift[its column]; a block in the air stays there. */
static void place(const fit_problem *p, const fit_contacts *c, double more) {
    for (size_t r = 0, at = 0; r < p->n_runs; at += p->run[r++].n)
        for (size_t i = 0; i < p->run[r].n; i++) {
            double plain = c->plain[at + i];
            p->run[r].strain[i] = plain > 0.0 ? fmax(plain - c->shift[c->common ? 0 : r] - more, 0.0) : 0.0;
        }
}

palp_status fit_contacts_differentiate(const fit_problem *p, const fit_contacts *c, const double *v,
                                       double *by_shift, double *other) {
    const double h = 1e-4 * p->strain_max;
    place(p, c, h);
    palp_status status = fit_evaluate(p, v, by_shift, NULL);
    place(p, c, -h);
    if (!status)
        status = fit_evaluate(p, v, other, NULL);
    place(p, c, 0.0);
    for (size_t i = 0; i < p->n_blocks && !status; i++)
        by_shift[i] = (by_shift[i] - other[i]) / (2.0 * h);
    return status;
}

/* J'J of the parameters and the shifts together, square[(n + k)^2], and the pull, J'r. */
static void sum_up(const fit_problem *p, const fit_contacts *c, const double *r, const double *jacobian,
                   const double *by_shift, double *square, double *pull) {
    size_t n = fit_parameter_count(p), m = p->n_blocks, k = c->n, all = n + k;
    memset(square, 0, all * all * sizeof *square);
    memset(pull, 0, all * sizeof *pull);
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            square[a * all + b] = dense_dot(m, jacobian + a * m, jacobian + b * m);
    for (size_t run = 0, i = 0; run < p->n_runs; run++) {
        size_t q = n + (c->common ? 0 : run);
        for (size_t b = 0; b < p->run[run].n; b++, i++) {
            for (size_t a = 0; a < n; a++) {
                square[a * all + q] += jacobian[a * m + i] * by_shift[i];
                square[q * all + a] = square[a * all + q];
            }
            square[q * all + q] += by_shift[i] * by_shift[i];
            pull[q] += by_shift[i] * r[i];
        }
    }
    for (size_t a = 0; a < n; a++)
        pull[a] = dense_dot(m, jacobian + a * m, r);
}

/* A shift's prior sd: that of the recording, combined with the scatter of the runs. */
static double prior_sd(const fit_problem *p, const fit_contacts *c, size_t q) {
    double own = 0.0;
    for (size_t r = 0; r < p->n_runs; r++)
        own = fmax(own, c->common || r == q ? c->sd[r] : 0.0);
    return hypot(own, c->scatter);
}

/* From the mean square of the shifts; few runs may scatter little by chance, so the contacts' sd in the air
 * counts as one more run. */
static void learn_scatter(const fit_problem *p, fit_contacts *c, double sum) {
    double n = (double)c->n, air = 0.0, least = 1e-12 * p->strain_max * p->strain_max;
    for (size_t r = 0; r < p->n_runs; r++)
        air += p->run[r].air_sd * p->run[r].air_sd / n;
    c->scatter = sqrt(fmax(fmax(sum / n, (sum + air) / (n + 1.0)), least));
}

/* One Gauss-Newton step of all; the shifts take it, and their scatter is estimated from them. *moved: largest
 * change. */
static palp_status step(fit_problem *p, double *v, fit_contacts *c, double *moved) {
    size_t n = fit_parameter_count(p), m = p->n_blocks, all = n + c->n;
    arena memory = {0};
    double *r = arena_take(&memory, m, sizeof *r), *jacobian = arena_take(&memory, m * n, sizeof *r),
           *by_shift = arena_take(&memory, m, sizeof *r), *other = arena_take(&memory, m, sizeof *r),
           *square = arena_take(&memory, all * all, sizeof *r),
           *inverse = arena_take(&memory, all * all, sizeof *r), *pull = arena_take(&memory, all, sizeof *r);
    palp_status status = memory.failed ? PALP_ERR_NO_MEMORY : fit_evaluate(p, v, r, jacobian);
    if (!status)
        status = fit_contacts_differentiate(p, c, v, by_shift, other);
    if (!status) {
        sum_up(p, c, r, jacobian, by_shift, square, pull);
        c->misfit = fmax(1.0, dense_dot(m, r, r) / fmax((double)m - (double)n, 1.0));
        for (size_t q = 0; q < c->n; q++) {
            double precision = c->misfit / (prior_sd(p, c, q) * prior_sd(p, c, q));
            square[(n + q) * all + n + q] += precision;
            pull[n + q] += precision * c->shift[q];
        }
        status = fit_invert(all, square, inverse);
    }
    double sum = 0.0;
    *moved = 0.0;
    for (size_t q = 0; q < c->n && !status; q++) {
        double change = 0.0;
        for (size_t a = 0; a < all; a++)
            change -= inverse[(n + q) * all + a] * pull[a];
        change = fmin(fmax(change, -0.1 * p->strain_max), 0.1 * p->strain_max);
        c->shift[q] += change;
        c->shift_sd[q] = sqrt(c->misfit * fmax(inverse[(n + q) * all + n + q], 0.0));
        *moved = fmax(*moved, fabs(change));
        sum += c->shift[q] * c->shift[q] + c->shift_sd[q] * c->shift_sd[q] - c->sd[q] * c->sd[q];
    }
    if (!status && !c->common)
        learn_scatter(p, c, sum);
    for (size_t a = 0; a < n && !status; a++)
        memcpy(c->covariance + a * n, inverse + a * all, n * sizeof *inverse);
    arena_free(&memory);
    place(p, c, 0.0);
    return status;
}

palp_status fit_contacts_create(const fit_problem *p, bool common, fit_contacts *c) {
    size_t n = fit_parameter_count(p);
    memset(c, 0, sizeof *c);
    c->common = common;
    c->n = common ? 1 : p->n_runs;
    c->scatter = 0.01 * p->strain_max;
    c->plain = arena_take(&c->memory, p->n_blocks, sizeof(double));
    c->shift = arena_take(&c->memory, p->n_runs, sizeof(double));
    c->shift_sd = arena_take(&c->memory, p->n_runs, sizeof(double));
    c->sd = arena_take(&c->memory, p->n_runs, sizeof(double));
    c->covariance = arena_take(&c->memory, n * n, sizeof(double));
    if (c->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0, at = 0; r < p->n_runs; at += p->run[r++].n) {
        memcpy(c->plain + at, p->run[r].strain, p->run[r].n * sizeof *c->plain);
        c->sd[r] = p->run[r].contact_sd;
    }
    return PALP_OK;
}

void fit_contacts_free(fit_contacts *c) {
    arena_free(&c->memory);
}

palp_status fit_contacts_solve(fit_problem *p, double *v, fit_contacts *c, bool *converged) {
    enum { ROUNDS = 12 };
    double moved = HUGE_VAL, chi2;
    palp_status status = PALP_OK;
    for (int i = 0; i < ROUNDS && !status && moved > 1e-5 * p->strain_max; i++) {
        status = step(p, v, c, &moved);
        if (!status)
            status = fit_solve_from(p, v, &chi2, converged);
    }
    return status;
}
