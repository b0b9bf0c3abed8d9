/* free_formula.c: a free term as a sum of few different forms with a shape each, by their evidence. The
 * likelihood of a term's table is a normal density. So the forces of a formula are integrated out exactly,
 * and its shapes on a grid. */
#include <palpate/explain.h>

#include "base/dense.h"
#include "explain_data.h"

#include <math.h>
#include <string.h>

enum { N = PALP_FREE_NODES, MOST = PALP_FORMULA_PARTS, GRID = 160 };

/* Ends of the shapes, and whether the grid is even in the logarithm. */
static const struct {
    const char *name;
    double low, high;
    bool logarithm;
} forms[PALP_FORMS] = {
    {"power", 0.1, 5.0, true}, /* from a step to a rise at the very end */
    {"exponential", 0.01, 3.0, true},
    {"hinge", 0.0, 0.95, false},
    {"saturation", 0.01, 3.0, true},
};

const char *palp_formula_form_name(palp_formula_form form) {
    return (unsigned)form < PALP_FORMS ? forms[form].name : "unknown";
}

static double shape_at(palp_formula_form form, size_t i) {
    const double share = (double)i / (GRID - 1), low = forms[form].low, high = forms[form].high;
    return forms[form].logarithm ? low * pow(high / low, share) : low + share * (high - low);
}

static double value_of(palp_formula_form form, double shape, double x) {
    const double size = fabs(x), sign = x < 0.0 ? -1.0 : x > 0.0 ? 1.0 : 0.0;
    switch (form) {
    case PALP_FORM_POWER:
        return sign * pow(size, shape);
    case PALP_FORM_EXPONENTIAL:
        return (x < 0.0 ? -1.0 : 1.0) * exp(-size / shape);
    case PALP_FORM_HINGE:
        return sign * fmax(0.0, size - shape);
    default:
        return x / (size + shape);
    }
}

/* The likelihood of a term's table, as palp_explain_free has it. */
typedef struct problem {
    const double *information, *pull;
    double x[N], scale_N;
} problem;

static void find_column(const problem *p, palp_formula_form form, double shape, double column[N]) {
    for (size_t a = 0; a < N; a++)
        column[a] = value_of(form, shape, p->x[a]);
}

/* Log evidence of n columns over none, and the forces' posterior: mean[n], covariance[n n]. */
static double weigh(const problem *p, size_t n, const double column[MOST][N], double mean[MOST],
                    double covariance[MOST * MOST]) {
    double a[MOST * MOST], turned[N];
    for (size_t i = 0; i < n; i++) {
        dense_times(N, N, 1.0, p->information, column[i], 0.0, turned);
        for (size_t j = 0; j < n; j++)
            a[i * n + j] = dense_dot(N, turned, column[j]) + (i == j ? 1.0 / (p->scale_N * p->scale_N) : 0.0);
        mean[i] = dense_dot(N, column[i], p->pull);
    }
    memset(covariance, 0, n * n * sizeof *covariance);
    if (!dense_cholesky(n, a))
        return -HUGE_VAL;
    for (size_t i = 0; i < n; i++)
        covariance[i * (n + 1)] = 1.0;
    dense_cholesky_solve(n, a, n, covariance);
    double before[MOST];
    memcpy(before, mean, n * sizeof *before);
    dense_cholesky_solve(n, a, 1, mean);
    return 0.5 * dense_dot(n, before, mean) - 0.5 * dense_log_determinant(n, a) - (double)n * log(p->scale_N);
}

/* Posterior of the shape of the last part on its grid: weight[GRID], sum 1. Returns the log evidence of the
 * formula with it, the shape integrated out; best: the most probable one. */
static double scan(const problem *p, size_t n, double column[MOST][N], palp_formula_form form,
                   double weight[GRID], size_t *best) {
    double mean[MOST], covariance[MOST * MOST], sum = 0.0;
    *best = 0;
    for (size_t i = 0; i < GRID; i++) {
        find_column(p, form, shape_at(form, i), column[n - 1]);
        weight[i] = weigh(p, n, (const double(*)[N])column, mean, covariance);
        *best = weight[i] > weight[*best] ? i : *best;
    }
    const double top = weight[*best];
    for (size_t i = 0; i < GRID; i++)
        sum += weight[i] = exp(weight[i] - top);
    for (size_t i = 0; i < GRID; i++)
        weight[i] /= sum;
    return top + log(sum / GRID);
}

static double quantile(palp_formula_form form, const double weight[GRID], double share) {
    double sum = 0.0;
    for (size_t i = 0; i < GRID; i++) {
        sum += weight[i];
        if (sum >= share)
            return shape_at(form, i);
    }
    return forms[form].high;
}

/* Shape and force of part j, conditional on the others' shapes: the mean over the grid, and intervals. */
static void refine(const problem *p, palp_formula *f, size_t j) {
    double column[MOST][N], weight[GRID], mean[MOST], covariance[MOST * MOST], first = 0.0, square = 0.0;
    size_t at = 0, best;
    for (size_t i = 0; i < f->n; i++) /* part j is the last */
        if (i != j)
            find_column(p, f->part[i].form, f->part[i].shape, column[at++]);
    const palp_formula_form form = f->part[j].form;
    scan(p, f->n, column, form, weight, &best);
    for (size_t i = 0; i < GRID; i++) {
        find_column(p, form, shape_at(form, i), column[f->n - 1]);
        weigh(p, f->n, (const double(*)[N])column, mean, covariance);
        first += weight[i] * mean[f->n - 1];
        square += weight[i] * (mean[f->n - 1] * mean[f->n - 1] + covariance[f->n * f->n - 1]);
    }
    f->part[j].shape = shape_at(form, best);
    f->part[j].shape_low = quantile(form, weight, 0.025);
    f->part[j].shape_high = quantile(form, weight, 0.975);
    find_column(p, form, f->part[j].shape, column[f->n - 1]);
    weigh(p, f->n, (const double(*)[N])column, mean, covariance);
    const double sd = sqrt(fmax(0.0, square - first * first));
    f->part[j].force_N = mean[f->n - 1];
    f->part[j].force_low_N = fmin(mean[f->n - 1], first - 1.96 * sd);
    f->part[j].force_high_N = fmax(mean[f->n - 1], first + 1.96 * sd);
}

static bool has_form(const palp_formula *f, palp_formula_form form) {
    for (size_t i = 0; i < f->n; i++)
        if (f->part[i].form == form)
            return true;
    return false;
}

/* Adds a part of another form if it gains more than the threshold. */
static bool add_part(const problem *p, double threshold, palp_formula *f) {
    double column[MOST][N], weight[GRID], best = -HUGE_VAL, second = -HUGE_VAL, shape = 0.0;
    size_t at;
    palp_formula_form form = PALP_FORM_POWER;
    for (size_t i = 0; i < f->n; i++)
        find_column(p, f->part[i].form, f->part[i].shape, column[i]);
    for (int k = 0; k < PALP_FORMS; k++) {
        if (has_form(f, (palp_formula_form)k))
            continue;
        const double gain = scan(p, f->n + 1, column, (palp_formula_form)k, weight, &at) - log(PALP_FORMS);
        second = fmax(second, fmin(gain, best));
        if (gain > best) {
            best = gain;
            form = (palp_formula_form)k;
            shape = shape_at(form, at);
        }
    }
    if (!(best - f->evidence > threshold))
        return false;
    f->evidence = best;
    f->evidence_over = best - second;
    f->part[f->n].form = form;
    f->part[f->n++].shape = shape;
    return true;
}

palp_status palp_formula_find(const palp_free_term *term, const double *information, const double *pull,
                              double scale_N, double false_alarm, palp_formula *formula) {
    enum { ROUNDS = 20 };
    if (palp_free_term_check(term) || !information || !pull || !formula || !(scale_N > 0.0) ||
        !(false_alarm > 0.0 && false_alarm < 1.0))
        return PALP_ERR_ARGUMENT;
    problem p = {.information = information, .pull = pull, .scale_N = scale_N};
    *formula = (palp_formula){.evidence_over = HUGE_VAL};
    for (size_t a = 0; a < N; a++) {
        p.x[a] = palp_free_term_coordinate(term, (double)a / (N - 1));
        formula->scale = fmax(formula->scale, fabs(p.x[a]));
    }
    for (size_t a = 0; a < N; a++)
        p.x[a] /= formula->scale;
    while (formula->n < MOST && add_part(&p, explain_threshold(false_alarm), formula))
        for (size_t i = 0; i < ROUNDS * formula->n; i++) /* each conditional on the others */
            refine(&p, formula, i % formula->n);
    return PALP_OK;
}

double palp_formula_force(const palp_formula *formula, double at) {
    double sum = 0.0;
    for (size_t i = 0; formula && i < formula->n; i++)
        sum += formula->part[i].force_N *
               value_of(formula->part[i].form, formula->part[i].shape, at / formula->scale);
    return sum;
}
