/* fit_solve.c: first guesses by a scan over relaxation times, polished by NLopt. */
#include "base/dense.h"
#include "fit_internal.h"
#include "solve/least_squares.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TIMES = 14, STARTS_MAX = 16 };

/* Normal equations of springs and arms at fixed times on the grid. */
typedef struct scan {
    const fit_problem *problem;
    size_t n_springs;        /* columns of the spring: its parameters, or one for a law that is not linear */
    size_t n_times, columns; /* n_springs + n_times */
    double tau[PALP_ARMS_MAX];
    double *gram, *right; /* [columns^2], [columns] */
    double total;         /* right-hand side's own square */
    double best[STARTS_MAX];
    double *start; /* [n_starts n_parameters] */
    size_t n_starts, found;
} scan;

static bool linear_law(const fit_problem *p) {
    return p->settings->spring == PALP_SPRING_PER_RUN ||
           (p->law.kind != PALP_LAW_SPLINE && p->law.kind != PALP_LAW_OGDEN);
}

size_t fit_spring_columns(const fit_problem *p) {
    return linear_law(p) ? p->n_springs : 1;
}

void fit_springs_of(const fit_problem *p, const double *solution, double *v) {
    for (size_t k = 0; k < p->n_springs; k++) {
        bool exponent = p->law.kind == PALP_LAW_OGDEN && k % 2;
        v[k] = linear_law(p) ? solution[k] : p->law.coefficients[k] * (exponent ? 1.0 : fabs(solution[0]));
    }
}

/* Row of one block: spring columns and the arms' responses at every time of the grid. */
static void fill_row(const scan *s, size_t r, size_t i, const double *response, double *row) {
    const fit_problem *p = s->problem;
    const fit_run *run = &p->run[r];
    if (p->settings->spring == PALP_SPRING_PER_RUN) {
        memset(row, 0, s->n_springs * sizeof *row);
        row[r] = run->strain[i];
    } else if (linear_law(p)) {
        palp_law_gradient(&p->law, run->strain[i], row);
    } else {
        palp_law_force(&p->law, 1, &run->strain[i], row, NULL, NULL);
    }
    for (size_t k = 0; k < s->n_times; k++)
        row[s->n_springs + k] = response[k * run->n + i];
}

static palp_status sum_up(scan *s) {
    const fit_problem *p = s->problem;
    size_t longest = 0, block = 0;
    for (size_t r = 0; r < p->n_runs; r++)
        longest = p->run[r].n > longest ? p->run[r].n : longest;
    double *response = malloc((s->n_times * longest + s->columns) * sizeof *response);
    if (!response)
        return PALP_ERR_NO_MEMORY;
    double *row = response + s->n_times * longest;
    for (size_t r = 0; r < p->n_runs; r++) {
        const fit_run *run = &p->run[r];
        for (size_t k = 0; k < s->n_times; k++)
            fit_arm_response(run, s->tau[k], response + k * run->n, NULL);
        for (size_t i = 0; i < run->n; i++, block++) {
            double weight = run->count[i] / (run->noise * run->noise);
            if (weight == 0.0)
                continue;
            fill_row(s, r, i, response, row);
            for (size_t a = 0; a < s->columns; a++) {
                s->right[a] += weight * row[a] * run->force[i];
                for (size_t b = 0; b <= a; b++)
                    s->gram[a * s->columns + b] += weight * row[a] * row[b];
            }
            s->total += weight * run->force[i] * run->force[i];
        }
    }
    free(response);
    return PALP_OK;
}

palp_status fit_normal_equations(const fit_problem *p, size_t n_times, const double *time, double *gram,
                                 double *right, double *total) {
    scan s = {
        .problem = p, .n_times = n_times, .n_springs = fit_spring_columns(p), .gram = gram, .right = right};
    s.columns = s.n_springs + n_times;
    memcpy(s.tau, time, n_times * sizeof *time);
    palp_status status = sum_up(&s);
    *total = s.total;
    return status;
}

/* Least squares on the springs and the chosen arms: *chi2 of it; false if singular. */
static bool solve_choice(const scan *s, const size_t *arm, size_t n_arms, double *solution, double *work,
                         double *chi2) {
    size_t n = s->n_springs + n_arms;
    for (size_t a = 0; a < n; a++) {
        size_t ga = a < s->n_springs ? a : s->n_springs + arm[a - s->n_springs];
        solution[a] = s->right[ga];
        for (size_t b = 0; b <= a; b++) {
            size_t gb = b < s->n_springs ? b : s->n_springs + arm[b - s->n_springs];
            work[a * n + b] = s->gram[ga * s->columns + gb] * (a == b ? 1.0 + 1e-12 : 1.0);
        }
    }
    if (!dense_cholesky(n, work))
        return false;
    dense_forward(n, work, 1, solution);
    *chi2 = s->total - dense_dot(n, solution, solution);
    dense_backward(n, work, 1, solution);
    return true;
}

/* Keeps a solution among the best starts; an arm that came out negative gets a small stiffness and the
 * choice a penalty. */
static void keep(scan *s, const size_t *arm, const double *solution, double chi2) {
    const fit_problem *p = s->problem;
    size_t n = fit_parameter_count(p), at = s->found;
    for (size_t j = 0; j < p->n_arms; j++)
        if (solution[s->n_springs + j] <= 0.0)
            chi2 += s->total;
    while (at > 0 && s->best[at - 1] > chi2)
        at--;
    if (at >= s->n_starts)
        return;
    s->found += s->found < s->n_starts;
    for (size_t k = s->found - 1; k > at; k--) {
        s->best[k] = s->best[k - 1];
        memcpy(s->start + k * n, s->start + (k - 1) * n, n * sizeof *s->start);
    }
    double *v = s->start + at * n;
    s->best[at] = chi2;
    fit_springs_of(p, solution, v);
    for (size_t j = 0; j < p->n_arms; j++) {
        v[p->n_springs + 2 * j] = log(fmax(solution[s->n_springs + j], 1e-3 * p->stiffness));
        v[p->n_springs + 2 * j + 1] = log(s->tau[arm[j]]);
    }
}

/* Next combination of n out of TIMES in order. */
static bool next_choice(size_t *arm, size_t n) {
    for (size_t j = n; j-- > 0;)
        if (arm[j] < TIMES - n + j) {
            arm[j]++;
            for (size_t k = j + 1; k < n; k++)
                arm[k] = arm[k - 1] + 1;
            return true;
        }
    return false;
}

static palp_status try_choices(scan *s) {
    size_t n_arms = s->problem->n_arms, n = s->n_springs + n_arms, arm[PALP_ARMS_MAX];
    double *work = malloc((n * n + n) * sizeof *work), *solution = work + n * n, chi2;
    if (!work)
        return PALP_ERR_NO_MEMORY;
    for (size_t j = 0; j < n_arms; j++)
        arm[j] = j;
    do {
        if (solve_choice(s, arm, n_arms, solution, work, &chi2))
            keep(s, arm, solution, chi2);
    } while (next_choice(arm, n_arms));
    free(work);
    return s->found ? PALP_OK : PALP_ERR_SINGULAR;
}

palp_status fit_scan(const fit_problem *p, size_t n_starts, double *start, size_t *found) {
    scan s = {.problem = p,
              .n_times = TIMES,
              .start = start,
              .n_starts = n_starts < STARTS_MAX ? n_starts : STARTS_MAX};
    if (p->n_arms > TIMES)
        return PALP_ERR_LIMIT;
    s.n_springs = fit_spring_columns(p);
    s.columns = s.n_springs + TIMES;
    for (size_t k = 0; k < TIMES; k++)
        s.tau[k] = p->tau_min * pow(p->tau_max / p->tau_min, ((double)k + 0.5) / TIMES);
    s.gram = calloc(s.columns * s.columns, sizeof(double));
    s.right = calloc(s.columns, sizeof(double));
    palp_status status = s.gram && s.right ? sum_up(&s) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = try_choices(&s);
    *found = s.found;
    free(s.gram);
    free(s.right);
    return status;
}

/* Parameters without units, v = origin + unit u, so that the solver takes the same steps in newtons and in
 * nanonewtons. */
typedef struct plain_numbers {
    const fit_problem *problem;
    double unit[FIT_PARAMETERS_MAX], origin[FIT_PARAMETERS_MAX], v[FIT_PARAMETERS_MAX];
} plain_numbers;

static void choose_units(const fit_problem *p, plain_numbers *s) {
    bool pascal = p->settings->spring == PALP_SPRING_LAW && p->law.area_m2 > 0.0;
    s->problem = p;
    for (size_t k = 0; k < p->n_springs; k++) {
        bool exponent = p->law.kind == PALP_LAW_OGDEN && k % 2 == 1;
        s->unit[k] = exponent ? 1.0 : pascal ? p->stiffness / p->law.area_m2 : p->stiffness;
        s->origin[k] = 0.0;
    }
    for (size_t k = p->n_springs; k < fit_parameter_count(p); k++) {
        s->unit[k] = 1.0;
        s->origin[k] = (k - p->n_springs) % 2 ? log(p->tau_max) : log(p->stiffness);
    }
}

static palp_status residuals(void *user, const double *u, double *residual, double *jacobian) {
    plain_numbers *s = user;
    size_t n = fit_parameter_count(s->problem), m = s->problem->n_blocks;
    for (size_t k = 0; k < n; k++)
        s->v[k] = s->origin[k] + s->unit[k] * u[k];
    palp_status status = fit_evaluate(s->problem, s->v, residual, jacobian);
    for (size_t k = 0; k < n && jacobian && !status; k++)
        if (s->unit[k] != 1.0)
            for (size_t i = 0; i < m; i++)
                jacobian[k * m + i] *= s->unit[k];
    return status;
}

/* Rows of constraints on v become rows on u whose largest number is 1. */
static void convert_rows(const plain_numbers *s, size_t rows, double *row, double *floor) {
    size_t n = fit_parameter_count(s->problem);
    for (size_t i = 0; i < rows; i++) {
        double largest = 0.0;
        for (size_t k = 0; k < n; k++) {
            floor[i] -= row[i * n + k] * s->origin[k];
            row[i * n + k] *= s->unit[k];
            largest = fmax(largest, fabs(row[i * n + k]));
        }
        for (size_t k = 0; k < n; k++)
            row[i * n + k] /= largest;
        floor[i] /= largest;
    }
}

enum { GRID = 40 };

/* log tau within its bounds, log K within a million of the stiffness of all; K(e) > 0 where asked. */
static size_t constrain(const fit_problem *p, double *row, double *floor) {
    size_t n = fit_parameter_count(p), rows = 0;
    double a[PALP_LAW_MAX] = {0};
    for (size_t j = 0; j < p->n_arms; j++) {
        size_t k = p->n_springs + 2 * j;
        row[rows * n + k + 1] = 1.0;
        floor[rows++] = log(p->tau_min);
        row[rows * n + k + 1] = -1.0;
        floor[rows++] = -log(p->tau_max);
        row[rows * n + k] = 1.0;
        floor[rows++] = log(1e-6 * p->stiffness);
        row[rows * n + k] = -1.0;
        floor[rows++] = -log(1e6 * p->stiffness);
    }
    bool spline = p->settings->spring == PALP_SPRING_LAW && p->law.kind == PALP_LAW_SPLINE;
    for (size_t i = 0; spline && i < p->law.n; i++) {
        row[rows * n + i] = 1.0;
        floor[rows++] = 1e-6 * p->stiffness;
    }
    for (size_t i = 0; p->least > 0.0 && !spline && i < GRID; i++) {
        double e = p->strain_max * fmax((double)i, 1e-6) / (GRID - 1); /* from 0 to the deepest strain */
        palp_law_gradient(&p->law, e, a);
        for (size_t k = 0; k < p->law.n; k++)
            row[rows * n + k] = a[k] / e;
        floor[rows++] = p->least * p->stiffness;
    }
    return rows;
}

static palp_status polish(const fit_problem *p, size_t max_evaluations, double *v, double *chi2,
                          bool *converged) {
    size_t n = fit_parameter_count(p), most = 4 * p->n_arms + GRID + PALP_LAW_MAX;
    double *row = calloc(most * n + most, sizeof *row), norm = 0.0;
    if (!row)
        return PALP_ERR_NO_MEMORY;
    double *floor = row + most * n;
    plain_numbers plain;
    choose_units(p, &plain);
    least_squares problem = {.n_parameters = n,
                             .n_residuals = p->n_blocks,
                             .max_evaluations = max_evaluations,
                             .stop_relative = p->stop_relative,
                             .evaluate = residuals,
                             .user = &plain,
                             .constraint = row,
                             .floor = floor};
    problem.n_constraints = constrain(p, row, floor);
    convert_rows(&plain, problem.n_constraints, row, floor);
    for (size_t k = 0; k < n; k++)
        v[k] = (v[k] - plain.origin[k]) / plain.unit[k];
    palp_status status = least_squares_solve(&problem, v, &norm, converged);
    for (size_t k = 0; k < n; k++)
        v[k] = plain.origin[k] + plain.unit[k] * v[k];
    *chi2 = norm * norm;
    free(row);
    return status;
}

palp_status fit_polish(const fit_problem *p, double *v, double *chi2, bool *converged) {
    return polish(p, p->settings->max_evaluations, v, chi2, converged);
}

/* Coarsely from each start, and on from the best of them. */
static palp_status polish_starts(fit_problem *p, double *v, double *chi2, bool *converged) {
    const double fine = p->stop_relative, coarse = 1e-4;
    const size_t most = p->settings->max_evaluations, few = most < 30 ? most : 30;
    size_t n = fit_parameter_count(p), found = 0;
    size_t starts = p->n_arms == 0 || p->settings->starts < 1 ? 1 : p->settings->starts;
    double *start = malloc(starts * n * sizeof *start);
    palp_status status = start ? fit_scan(p, starts, start, &found) : PALP_ERR_NO_MEMORY;
    *chi2 = HUGE_VAL;
    p->stop_relative = found > 1 ? coarse : fine;
    for (size_t k = 0; k < found && !status; k++) {
        double c = HUGE_VAL;
        status = polish(p, found > 1 ? few : most, start + k * n, &c, converged);
        if (!status && c < *chi2) {
            *chi2 = c;
            memcpy(v, start + k * n, n * sizeof *v);
        }
    }
    p->stop_relative = fine;
    if (!status && found > 1)
        status = fit_polish(p, v, chi2, converged);
    free(start);
    return status;
}

/* Enforces K(e) > 0 over the measured strains if the fit violates it: at some strains, by the margin that is
 * needed between them. */
static palp_status keep_positive(fit_problem *p, double *v, double *chi2, bool *converged) {
    const double least = 1e-3, most = 0.1;
    palp_law law;
    palp_status status = PALP_OK;
    if (p->settings->spring == PALP_SPRING_PER_RUN || !linear_law(p))
        return status;
    for (double share = fmax(least, p->least); share < most && !status; share *= 3.0) {
        status = fit_law(p, v, &law);
        if (status || palp_law_minimum(&law, p->strain_max) > 0.0)
            break;
        p->least = share;
        status = fit_polish(p, v, chi2, converged);
    }
    return status;
}

palp_status fit_solve(fit_problem *p, double *v, double *chi2, bool *converged) {
    *converged = false;
    palp_status status = polish_starts(p, v, chi2, converged);
    return status ? status : keep_positive(p, v, chi2, converged);
}
