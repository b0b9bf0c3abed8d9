/* fit_contact_evidence.c: evidence that the contacts differ from the assumed ones. It takes the residual of a
 * fit with known contacts that neither its parameters nor a zero force within its sd explain. Its Bayes
 * factor is that of scattered contacts over known ones, integrated over the contacts and the logarithm of
 * their scatter. */
#include "base/arena.h"
#include "base/dense.h"
#include "fit_internal.h"

#include <math.h>
#include <string.h>

/* Unknowns: the fit's parameters, a zero force in sds for each run, a contact in strain for each run. */
typedef struct judged {
    arena memory;
    const fit_problem *p;
    size_t n, m, runs, all;      /* parameters, blocks, runs, unknowns */
    double *residual, *jacobian; /* [m], [m n] */
    double *by_shift, *other;    /* [m] */
    double *row; /* [n + 2] of one block: derivatives by the parameters, its run's zero and contact */
    double *square, *pull; /* [all all], [all]: J'J and J'r of all unknowns */
    double *a, *inverse;   /* [all all] */
    double widen;          /* factor on the variance of a block, for misfit and correlation */
} judged;

static palp_status take_memory(judged *j) {
    size_t square = j->all * j->all;
    double **arrays[] = {&j->residual, &j->jacobian, &j->by_shift, &j->other,  &j->row,
                         &j->square,   &j->pull,     &j->a,        &j->inverse};
    const size_t sizes[] = {j->m, j->m * j->n, j->m, j->m, j->n + 2, square, j->all, square, square};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        *arrays[i] = arena_take(&j->memory, sizes[i], sizeof(double));
    return j->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

/* Index of the k-th unknown in a row of run r. */
static size_t number(const judged *j, size_t r, size_t k) {
    return k < j->n ? k : k == j->n ? j->n + r : j->n + j->runs + r;
}

static void fill_row(judged *j, const fit_run *run, size_t b, size_t i) {
    for (size_t k = 0; k < j->n; k++)
        j->row[k] = j->jacobian[k * j->m + i];
    j->row[j->n] = sqrt(run->count[b]) / run->noise * run->zero_sd;
    j->row[j->n + 1] = j->by_shift[i];
}

static void sum_up(judged *j) {
    for (size_t r = 0, i = 0; r < j->runs; r++)
        for (size_t b = 0; b < j->p->run[r].n; b++, i++) {
            fill_row(j, &j->p->run[r], b, i);
            for (size_t k = 0; k < j->n + 2; k++) {
                size_t at = number(j, r, k);
                j->pull[at] += j->row[k] * j->residual[i];
                for (size_t l = 0; l < j->n + 2; l++)
                    j->square[at * j->all + number(j, r, l)] += j->row[k] * j->row[l];
            }
        }
}

/* The residual with all unknowns free, contacts within a tenth of the strains. Its misfit and correlation are
 * not due to them. */
static palp_status find_widening(judged *j) {
    double wide = 1.0 / (0.01 * j->p->strain_max * j->p->strain_max);
    memcpy(j->a, j->square, j->all * j->all * sizeof *j->a);
    for (size_t k = j->n; k < j->all; k++)
        j->a[k * j->all + k] += k < j->n + j->runs ? 1.0 : wide;
    palp_status status = fit_invert(j->all, j->a, j->inverse);
    if (status)
        return status;
    double *step = j->a;
    dense_times(j->all, j->all, -1.0, j->inverse, j->pull, 0.0, step);
    for (size_t r = 0, i = 0; r < j->runs; r++)
        for (size_t b = 0; b < j->p->run[r].n; b++, i++) {
            fill_row(j, &j->p->run[r], b, i);
            for (size_t k = 0; k < j->n + 2; k++)
                j->residual[i] += j->row[k] * step[number(j, r, k)];
        }
    fit_curvature c = {0};
    fit_sum_residual(j->p, j->residual, &c);
    j->widen = fit_inflation(&c) * fit_inflation(&c);
    return PALP_OK;
}

/* Information of the contacts alone, with the other unknowns eliminated and the variances widened. It is the
 * first block of square and pull: square[runs runs], pull[runs]. */
static palp_status eliminate(judged *j) {
    size_t n = j->n + j->runs, all = j->all, runs = j->runs;
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            j->a[a * n + b] = j->square[a * all + b] + (a == b && a >= j->n ? j->widen : 0.0);
    palp_status status = fit_invert(n, j->a, j->inverse);
    for (size_t q = 0; q < runs && !status;
         q++) { /* the rows of the contacts: less their part in the others */
        double *row = j->square + (n + q) * all, *half = j->a;
        dense_times(n, n, 1.0, j->inverse, row, 0.0, half);
        j->pull[n + q] -= dense_dot(n, half, j->pull);
        for (size_t o = 0; o < runs; o++)
            row[n + o] -= dense_dot(n, half, j->square + (n + o) * all);
    }
    for (size_t q = 0; q < runs && !status; q++) {
        j->pull[q] = j->pull[n + q] / j->widen;
        for (size_t o = 0; o < runs; o++)
            j->inverse[q * runs + o] = j->square[(n + q) * all + n + o] / j->widen;
    }
    if (!status)
        memcpy(j->square, j->inverse, runs * runs * sizeof *j->square);
    return status;
}

/* log of the Bayes factor of contacts with this scatter, and the recordings' sds, over known ones. */
static double log_factor(judged *j, double scatter) {
    size_t runs = j->runs;
    double *m = j->a, *push = j->inverse;
    for (size_t q = 0; q < runs; q++) {
        double t = hypot(j->p->run[q].contact_sd, scatter);
        push[q] = t * j->pull[q];
        for (size_t o = 0; o < runs; o++)
            m[q * runs + o] =
                t * hypot(j->p->run[o].contact_sd, scatter) * j->square[q * runs + o] + (q == o ? 1.0 : 0.0);
    }
    if (!dense_cholesky(runs, m))
        return -HUGE_VAL;
    double determinant = dense_log_determinant(runs, m);
    dense_forward(runs, m, 1, push);
    return 0.5 * (dense_dot(runs, push, push) - determinant);
}

palp_status fit_contacts_weigh(const fit_problem *p, const double *v, double *log_evidence) {
    enum { SCATTERS = 18 }; /* from a millionth to a tenth of the strains, by factors of 2 */
    judged j = {.p = p, .n = fit_parameter_count(p), .m = p->n_blocks, .runs = p->n_runs};
    j.all = j.n + 2 * j.runs;
    fit_contacts contacts;
    palp_status status = fit_contacts_create(p, false, &contacts);
    status = status ? status : take_memory(&j);
    status = status ? status : fit_evaluate(p, v, j.residual, j.jacobian);
    status = status ? status : fit_contacts_differentiate(p, &contacts, v, j.by_shift, j.other);
    if (!status) {
        sum_up(&j);
        status = find_widening(&j);
    }
    status = status ? status : eliminate(&j);
    double sum = 0.0, most = -HUGE_VAL, one[SCATTERS];
    for (int i = 0; i < SCATTERS && !status; i++)
        most = fmax(most, one[i] = log_factor(&j, 0.1 * p->strain_max * pow(0.5, i)));
    for (int i = 0; i < SCATTERS && !status; i++)
        sum += exp(one[i] - most) / SCATTERS;
    *log_evidence = status ? 0.0 : most + log(sum);
    fit_contacts_free(&contacts);
    arena_free(&j.memory);
    return status;
}
