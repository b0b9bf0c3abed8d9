/* infer_normal.c: the posterior of parameters and discrepancy from the products of the whitened columns, and
 * the evidence. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

enum { SPECIMEN_SQUARE = INFER_SPECIMEN * INFER_SPECIMEN };

/* Column of a run's products (parameters, its own, hats, specimen's, residual) of an outer one: hats,
 * parameters, the multiplier (which has none: fit->m), specimen's, residual. */
static size_t outer_column(const infer_fit *fit, const infer_posterior *p, size_t a) {
    return a < p->hats ? fit->k + INFER_OWN + p->hat[a]
           : a < p->g  ? a - p->hats
           : a == p->g ? fit->m
                       : fit->k + INFER_BLOCK + (a - p->g - 1);
}

/* Which of INFER_BLOCK parameter a of a block is. */
static size_t of_block(const infer_posterior *p, size_t a) {
    return a < INFER_OWN ? a : INFER_OWN + p->hat[a - INFER_OWN];
}

/* p's hats are those of domains of which a size is not 0. */
static void find_hats(const infer_fit *fit, infer_posterior *p) {
    for (size_t d = 0; d < INFER_DOMAINS; d++) {
        const bool any = infer_any(fit->sizes.common[d]) || infer_any(fit->sizes.each[d]);
        p->domain[d] = any ? p->hats : SIZE_MAX;
        for (size_t a = 0; a < INFER_NODES && any; a++)
            p->hat[p->hats++] = d * INFER_NODES + a;
    }
    p->width = INFER_OWN + p->hats;
}

double infer_common(const infer_posterior *p, size_t hat) {
    const size_t at = p->domain[hat / INFER_NODES];
    return at == SIZE_MAX ? 0.0 : p->mean[at + hat % INFER_NODES];
}

/* Precision that fixes a parameter of this sd at the value of the columns, if the fit asks for it. It is a
 * hundred thousandth of the sd, below any run's accuracy; six of sixteen digits remain for the density. */
static double hold(const infer_fit *fit, double sd) {
    return fit->held && sd > 0.0 ? 1e10 / (sd * sd) : 0.0;
}

/* The same for a parameter of a run, and the value of its column. 0: the column is linear. */
static double hold_own(const infer_fit *fit, size_t own, size_t r, double *place) {
    const bool bends = own != INFER_CONTACT && explain_bends(&fit->c.model);
    *place = own == INFER_ZERO ? fit->c.zero[r] : own == INFER_GAIN ? fit->c.gain[r] : fit->c.contact[r];
    return own == INFER_CONTACT || (bends && own <= INFER_GAIN) ? hold(fit, fit->sizes.own[own]) : 0.0;
}

/* Cholesky factor l[width width] of the posterior precision of a run's parameters, conditional on the global
 * ones; and the log determinant of its prior. false: not definite. */
static bool own_factor(const infer_fit *fit, const infer_posterior *p, size_t r, double *l,
                       double *log_prior) {
    const double *product = fit->product + r * fit->m * fit->m;
    const size_t width = p->width;
    *log_prior = 0.0;
    for (size_t a = 0; a < width; a++)
        for (size_t b = 0; b < width; b++)
            l[a * width + b] = product[(fit->k + of_block(p, a)) * fit->m + fit->k + of_block(p, b)];
    for (size_t a = 0; a < INFER_OWN; a++) {
        const double certain = a == INFER_CONTACT ? fit->contact_certain[r] : 1.0,
                     sd = fit->sizes.own[a] / sqrt(certain);
        double place;
        for (size_t b = 0; b < width && !(sd > 0.0); b++)
            l[a * width + b] = l[b * width + a] = 0.0;
        l[a * width + a] += sd > 0.0 ? 1.0 / (sd * sd) : 1.0;
        l[a * width + a] += hold_own(fit, a, r, &place);
        *log_prior += sd > 0.0 ? 2.0 * (infer_cauchy_evidence(certain) - log(sd)) : 0.0;
    }
    for (size_t h = 0; h < p->hats; h += INFER_NODES) {
        const size_t at = INFER_OWN + h, d = p->hat[h] / INFER_NODES;
        const bool any = infer_any(fit->sizes.each[d]);
        for (size_t a = at; a < at + INFER_NODES && !any; a++)
            for (size_t b = 0; b < width; b++)
                l[a * width + b] = l[b * width + a] = 0.0;
        *log_prior += infer_hats_precision(fit->sizes.each[d], width, l + at * width + at);
    }
    return dense_cholesky(width, l);
}

/* Whether a column of the block has no size, so that its coefficient is 0. */
static bool is_off(const infer_fit *fit, const infer_posterior *p, size_t a) {
    if (a < INFER_OWN)
        return !(fit->sizes.own[a] > 0.0);
    return !infer_any(fit->sizes.each[p->hat[a - INFER_OWN] / INFER_NODES]);
}

/* Whether an outer column is a common discrepancy without a size: nothing else depends on it. */
static bool is_absent(const infer_fit *fit, const infer_posterior *p, size_t outer) {
    return outer < p->hats && !infer_any(fit->sizes.common[p->hat[outer] / INFER_NODES]);
}

/* The weight of the run's contact among those that average 0: how certain it is. */
static double in_mean(const infer_fit *fit, const explain_data *data, size_t r) {
    const bool in = data->contacts_average_0 && !fit->held && !data->run[r].held_out &&
                    fit->sizes.own[INFER_CONTACT] > 0.0;
    return in ? fit->contact_certain[r] : 0.0;
}

/* cross[width outer]: products of run r's parameters with the outer columns; with the multiplier its contact
 * has 1. */
static void own_cross(const infer_fit *fit, const explain_data *data, const infer_posterior *p, size_t r,
                      size_t outer, double *cross) {
    const double *product = fit->product + r * fit->m * fit->m;
    const size_t s = p->g + 1, width = p->width;
    for (size_t b = 0; b < outer; b++) {
        const size_t column = outer_column(fit, p, b);
        const bool off = is_absent(fit, p, b) || column == fit->m ||
                         (b >= s && b < s + INFER_SPECIMEN && !(fit->sizes.specimen[b - s] > 0.0));
        for (size_t a = 0; a < width; a++)
            cross[b * width + a] =
                off || is_off(fit, p, a) ? 0.0 : product[column * fit->m + fit->k + of_block(p, a)];
    }
    for (size_t a = 0; a < INFER_OWN; a++) {
        double place;
        const double precision = hold_own(fit, a, r, &place);
        cross[(outer - 1) * width + a] += precision * place;
    }
    cross[(s - 1) * width + INFER_CONTACT] = in_mean(fit, data, r);
}

/* Adds run r, with its own parameters eliminated, to the outer matrix a[outer outer]; and to the log
 * determinants of posterior and prior. cross: [(width + outer) outer] */
static bool add_run(const infer_fit *fit, const explain_data *data, const infer_posterior *p, size_t r,
                    size_t outer, double *a, double *cross, double det[2]) {
    const size_t width = p->width;
    const double *product = fit->product + r * fit->m * fit->m;
    double l[INFER_BLOCK * INFER_BLOCK], log_prior;
    if (!own_factor(fit, p, r, l, &log_prior))
        return false;
    own_cross(fit, data, p, r, outer, cross);
    dense_forward(width, l, outer, cross);
    det[0] += dense_log_determinant(width, l);
    det[1] += log_prior;
    const size_t multiplier = p->g;
    for (size_t i = 0; i < outer; i++) {
        const double *row = product + outer_column(fit, p, i) * fit->m;
        for (size_t j = 0; j < outer && i != multiplier; j++)
            a[i * outer + j] += j != multiplier ? row[outer_column(fit, p, j)] : 0.0;
    }
    for (size_t i = 0; i < INFER_OWN; i++) {
        double place;
        const double precision = hold_own(fit, i, r, &place);
        a[outer * outer - 1] += precision * place * place;
    }
    double *square = cross + width * outer;
    dense_transposed_product(outer, outer, width, cross, cross, square);
    for (size_t i = 0; i < outer * outer; i++)
        a[i] -= square[i];
    return true;
}

/* Doubles that a posterior keeps of a specimen. First the Cholesky factor of its own parameters, conditional
 * on the global ones. Then that factor's inverse times its rows of the global columns and the residual,
 * column by column. */
static size_t specimen_room(size_t g) {
    return SPECIMEN_SQUARE + INFER_SPECIMEN * (g + 1);
}

/* Eliminates the specimen's parameters from a[outer outer], lower triangle; keep[specimen_room]. */
static bool take_specimen(const infer_fit *fit, const infer_posterior *p, const double *place, double *a,
                          double *keep, double det[2]) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g + 1, outer = g + S + 1;
    double *rows = keep + SPECIMEN_SQUARE;
    for (size_t i = 0; i < S; i++) {
        const double sd = fit->sizes.specimen[i];
        const bool on = sd > 0.0;
        for (size_t j = 0; j < S; j++) {
            const size_t high = i > j ? i : j, low = i > j ? j : i;
            keep[i * S + j] = on && fit->sizes.specimen[j] > 0.0 ? a[(g + high) * outer + g + low] : 0.0;
        }
        keep[i * S + i] += (on ? 1.0 / (sd * sd) : 1.0) + hold(fit, sd);
        det[1] -= on ? 2.0 * log(sd) : 0.0;
        for (size_t b = 0; b < g; b++)
            rows[b * S + i] = on && !is_absent(fit, p, b) ? a[(g + i) * outer + b] : 0.0;
        rows[g * S + i] = (on ? a[(g + S) * outer + g + i] : 0.0) + hold(fit, sd) * place[i];
        a[outer * outer - 1] += hold(fit, sd) * place[i] * place[i];
    }
    if (!dense_cholesky(S, keep))
        return false;
    dense_forward(S, keep, g + 1, rows);
    det[0] += dense_log_determinant(S, keep);
    return true;
}

/* Adds the runs from .. to - 1 of one specimen to a[(g + 1) (g + 1)], where g has the multiplier too. One
 * without a fitted run has parameters too, but adds nothing. inner: [(g + SPECIMEN + 1) (g + SPECIMEN +
 * 1)]. */
static bool add_specimen(const infer_fit *fit, const explain_data *data, size_t from, size_t to, double *a,
                         double *inner, double *cross, infer_posterior *p) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g + 1, outer = g + S + 1, room = specimen_room(g);
    double det[2] = {0.0, 0.0}, *keep = p->specimen + from * room, *rows = keep + SPECIMEN_SQUARE;
    bool fitted = false;
    memset(inner, 0, outer * outer * sizeof *inner);
    for (size_t r = from; r < to; r++)
        fitted = fitted || !data->run[r].held_out;
    for (size_t r = from; r < to; r++)
        if (!(fitted && data->run[r].held_out) && !add_run(fit, data, p, r, outer, inner, cross, det))
            return false;
    if (!take_specimen(fit, p, fit->specimen + from * S, inner, keep, det))
        return false;
    for (size_t r = from + 1; r < to; r++)
        memcpy(p->specimen + r * room, keep, room * sizeof *keep);
    for (size_t i = 0; i <= g && fitted; i++)
        for (size_t j = 0; j <= i; j++) {
            const size_t at = i < g ? i : g + S;
            const double sum =
                inner[at * outer + (j < g ? j : g + S)] - dense_dot(S, rows + i * S, rows + j * S);
            a[i * (g + 1) + j] += sum;
            a[j * (g + 1) + i] += i != j ? sum : 0.0;
        }
    p->log_det += fitted ? det[0] : 0.0;
    p->log_prior += fitted ? det[1] : 0.0;
    return true;
}

/* Takes the columns of a common discrepancy without a size out of a[n n]. */
static void drop_absent(const infer_fit *fit, const infer_posterior *p, size_t n, double *a) {
    for (size_t i = 0; i < p->hats; i++)
        for (size_t j = 0; j < n && is_absent(fit, p, i); j++)
            a[i * n + j] = a[j * n + i] = 0.0;
}

/* Eliminates the multiplier from a[(g + 2) (g + 2)], which becomes [(g + 1) (g + 1)]: the contacts then
 * average 0. Their prior is normal under that condition too. */
static void take_mean(const infer_fit *fit, const explain_data *data, infer_posterior *p, double *a) {
    const size_t g = p->g, n = g + 2;
    const double curvature = -a[g * n + g];
    double *slope = p->pull_of_mean, count = 0.0;
    for (size_t r = 0; r < data->n_runs; r++)
        count += in_mean(fit, data, r);
    p->mean_square = count > 0.0 && curvature > 0.0 ? 1.0 / curvature : 0.0;
    for (size_t i = 0; i <= g; i++)
        slope[i] = -p->mean_square * a[g * n + (i < g ? i : g + 1)];
    for (size_t i = 0; i <= g; i++)
        for (size_t j = 0; j <= g; j++) {
            const double was = a[(i < g ? i : g + 1) * n + (j < g ? j : g + 1)];
            a[i * (g + 1) + j] = was + (p->mean_square > 0.0 ? slope[i] * slope[j] * curvature : 0.0);
        }
    if (p->mean_square > 0.0) {
        p->log_det += log(curvature);
        p->log_prior += log(count) + 2.0 * log(fit->sizes.own[INFER_CONTACT]);
    }
}

/* p->turn, and the hats of a[e e] made orthogonal to steps of the law: the discrepancy is what the law cannot
 * follow (Plumlee, J. Am. Stat. Assoc. 112 (2017) 1274). q: the parameters' prior precision; work[k (k +
 * e)]. */
static palp_status turn_hats(const infer_fit *fit, const infer_posterior *p, const double *q, double *work,
                             double *a) {
    const size_t k = fit->k, n = fit->c.model.material.law.n, e = p->g + 1, hats = p->hats;
    double *normal = work, *rows = work + n * n, *turn = rows + n * e;
    memcpy(rows, a + hats * e, n * e * sizeof *rows);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++)
            normal[i * n + j] = rows[i * e + hats + j] + q[i * k + j];
        for (size_t h = 0; h < hats; h++)
            turn[h * n + i] = rows[i * e + h];
    }
    if (!dense_cholesky(n, normal))
        return PALP_ERR_SINGULAR;
    dense_cholesky_solve(n, normal, hats, turn);
    for (size_t h = 0; h < hats; h++) {
        memcpy(p->turn + h * k, turn + h * n, n * sizeof *turn);
        for (size_t i = 0; i < n; i++) /* rows, then columns */
            for (size_t j = 0; j < e; j++)
                a[h * e + j] -= turn[h * n + i] * rows[i * e + j];
    }
    for (size_t j = 0; j < e; j++)
        for (size_t h = 0; h < hats; h++)
            a[j * e + h] -= dense_dot(n, turn + h * n, a + j * e + hats);
    return PALP_OK;
}

/* Adds the priors to a[(g + 1) (g + 1)] and factorizes. */
static palp_status solve(const infer_fit *fit, const explain_data *data, infer_posterior *p, double *a,
                         double *q) {
    const size_t g = p->g, k = fit->k, e = g + 1, hats = p->hats;
    double log_prior;
    palp_status status = infer_prior(fit, data, q, &log_prior);
    if (status)
        return status;
    p->log_prior += log_prior;
    status = turn_hats(fit, p, q, q + k * k, a);
    if (status)
        return status;
    for (size_t h = 0; h < hats; h += INFER_NODES)
        p->log_prior += infer_hats_precision(fit->sizes.common[p->hat[h] / INFER_NODES], e, a + h * (e + 1));
    p->chi2 = a[e * e - 1];
    for (size_t i = 0; i < k; i++)
        for (size_t j = 0; j < k; j++) {
            const double off = fit->c.x[j] - fit->given[j];
            a[(hats + i) * e + hats + j] += q[i * k + j];
            a[g * e + hats + i] -= q[i * k + j] * off;
            p->chi2 += (fit->c.x[i] - fit->given[i]) * q[i * k + j] * off;
        }
    for (size_t i = 0; i < k; i++)
        if (fit->scan[i].jumps) { /* it is at the median, and its posterior is known */
            a[g * e + hats + i] = 0.0;
            if (fit->scan[i].spread > 0.0)
                a[(hats + i) * (e + 1)] = TURN / (fit->scan[i].spread * fit->scan[i].spread);
        }
    for (size_t i = 0; i < g; i++) {
        memcpy(p->factor + i * g, a + i * e, g * sizeof *p->factor);
        p->mean[i] = a[g * e + i];
    }
    return dense_cholesky(g, p->factor) ? PALP_OK : PALP_ERR_SINGULAR;
}

palp_status infer_posterior_find(const infer_fit *fit, const explain_data *data, infer_posterior *p) {
    memset(p, 0, sizeof *p);
    find_hats(fit, p);
    const size_t k = fit->k, hats = p->hats, g = k + hats, e = g + 2, outer = e + INFER_SPECIMEN;
    p->g = g;
    p->k = k;
    p->memory = calloc(g * g + g + k * k + k + e * e + k * k + (p->width + outer) * outer + outer * outer +
                           data->n_runs * specimen_room(g + 1) + e + hats * k + k * (k + e + hats),
                       sizeof *p->memory);
    if (!p->memory)
        return PALP_ERR_NO_MEMORY;
    p->factor = p->memory;
    p->mean = p->factor + g * g;
    p->normal = p->mean + g;
    p->pull = p->normal + k * k;
    double *a = p->pull + k, *q = a + e * e, *cross = q + k * k + k * (k + e + hats),
           *inner = cross + (p->width + outer) * outer;
    p->specimen = inner + outer * outer;
    p->pull_of_mean = p->specimen + data->n_runs * specimen_room(g + 1);
    p->turn = p->pull_of_mean + e;
    bool good = true;
    for (size_t from = 0, to = 0; from < data->n_runs && good; from = to) {
        while (to < data->n_runs && data->run[to].specimen == data->run[from].specimen)
            to++;
        good = add_specimen(fit, data, from, to, a, inner, cross, p);
    }
    drop_absent(fit, p, e, a);
    if (good)
        take_mean(fit, data, p, a);
    palp_status status = good ? solve(fit, data, p, a, q) : PALP_ERR_SINGULAR;
    if (status) {
        infer_posterior_free(p);
        return status;
    }
    p->log_det += dense_log_determinant(g, p->factor);
    dense_forward(g, p->factor, 1, p->mean);
    p->here = p->chi2 - dense_dot(hats, p->mean, p->mean);
    p->chi2 -= dense_dot(g, p->mean, p->mean);
    for (size_t i = 0; i < k; i++) {
        const double *row = p->factor + (hats + i) * g + hats;
        p->pull[i] = dense_dot(i + 1, row, p->mean + hats);
        for (size_t j = 0; j <= i; j++)
            p->normal[i * k + j] = p->normal[j * k + i] =
                dense_dot(j + 1, row, p->factor + (hats + j) * g + hats);
    }
    dense_backward(g, p->factor, 1, p->mean);
    return PALP_OK;
}

void infer_posterior_free(infer_posterior *p) {
    free(p->memory);
    memset(p, 0, sizeof *p);
}

double infer_log_evidence(const infer_fit *fit, const infer_posterior *p, double chi2) {
    return infer_bends_evidence(fit) - fit->c.hum_cost -
           0.5 * (chi2 + fit->log_noise + p->log_det - p->log_prior);
}

/* Minus the derivative of the parameters of run r's specimen by the global ones: slope[SPECIMEN (g + 2)].
 * That by the multiplier follows; the best values without a step are the last column. */
static const double *specimen_slope(const infer_posterior *p, size_t r, double *slope) {
    const double *keep = p->specimen + r * specimen_room(p->g + 1);
    memcpy(slope, keep + SPECIMEN_SQUARE, INFER_SPECIMEN * (p->g + 2) * sizeof *slope);
    dense_backward(INFER_SPECIMEN, keep, p->g + 2, slope);
    return keep;
}

/* Of n that depend on the global ones by -x[n (g + 2)] (a column after the other; the multiplier's, and their
 * values without a step, last): mean[n] at the posterior; covariance[n n] += the changes by the multiplier
 * and by the global ones. x is overwritten. */
static palp_status add_global(const infer_posterior *p, size_t n, double *x, double *mean,
                              double *covariance) {
    const size_t g = p->g;
    const double *by_mean = x + g * n;
    double *best = x + (g + 1) * n;
    for (size_t a = 0; a < n; a++) {
        for (size_t b = 0; b < g; b++)
            x[b * n + a] -= by_mean[a] * p->pull_of_mean[b];
        best[a] -= by_mean[a] * p->pull_of_mean[g];
        for (size_t h = 0; h < p->hats; h++)
            for (size_t i = 0; i < p->k; i++)
                x[h * n + a] -= p->turn[h * p->k + i] * x[(p->hats + i) * n + a];
        mean[a] = best[a];
        for (size_t b = 0; b < g; b++)
            mean[a] -= x[b * n + a] * p->mean[b];
    }
    double *turned = covariance ? malloc((g + n) * n * sizeof *turned) : NULL;
    if (!covariance || !turned)
        return covariance ? PALP_ERR_NO_MEMORY : PALP_OK;
    double *square = turned + g * n;
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < g; b++)
            turned[a * g + b] = x[b * n + a];
    dense_forward(g, p->factor, n, turned);
    dense_transposed_product(n, n, g, turned, turned, square);
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            covariance[a * n + b] += square[a * n + b] - by_mean[a] * by_mean[b] * p->mean_square;
    free(turned);
    return PALP_OK;
}

/* C[n n] = the inverse of the factor's square. */
static void invert(size_t n, const double *factor, double *c) {
    memset(c, 0, n * n * sizeof *c);
    for (size_t a = 0; a < n; a++)
        c[a * n + a] = 1.0;
    dense_cholesky_solve(n, factor, n, c);
}

void infer_specimen_left(const infer_posterior *p, size_t r, double *covariance) {
    invert(INFER_SPECIMEN, p->specimen + r * specimen_room(p->g + 1), covariance);
}

palp_status infer_specimen_own(const infer_posterior *p, size_t r, double *mean, double *covariance) {
    enum { S = INFER_SPECIMEN };
    double *slope = malloc((p->g + 2) * S * sizeof *slope);
    if (!slope)
        return PALP_ERR_NO_MEMORY;
    const double *keep = specimen_slope(p, r, slope);
    if (covariance)
        invert(S, keep, covariance);
    palp_status status = add_global(p, S, slope, mean, covariance);
    free(slope);
    return status;
}

/* How the parameters of run r, with factor l, depend on the outer ones: cross[width outer], through the
 * specimen too. slope[SPECIMEN (g + 2)]: likewise of the specimen's parameters; spread[SPECIMEN SPECIMEN]:
 * their covariance. covariance[width width]: of the run's parameters, conditional on the global ones. */
static void depend_on_outer(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                            size_t r, const double *l, double *cross, double *slope, double *spread,
                            double *covariance) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g + 1, outer = g + S + 1, width = p->width;
    own_cross(fit, data, p, r, outer, cross);
    dense_cholesky_solve(width, l, outer, cross);
    const double *by = cross + g * width;
    invert(S, specimen_slope(p, r, slope), spread);
    invert(width, l, covariance);
    for (size_t a = 0; a < width; a++)
        for (size_t b = 0; b < width; b++)
            for (size_t i = 0; i < S * S; i++)
                covariance[a * width + b] += by[i / S * width + a] * spread[i] * by[i % S * width + b];
    for (size_t b = 0; b <= g; b++) {
        double *column = cross + (b < g ? b : g + S) * width;
        for (size_t s = 0; s < S; s++)
            for (size_t a = 0; a < width; a++)
                column[a] -= by[s * width + a] * slope[b * S + s];
    }
}

double infer_undone(const infer_posterior *p, size_t from, size_t to, size_t i) {
    double sum = 0.0;
    for (size_t h = 0; h < p->hats; h++)
        sum += p->hat[h] >= from && p->hat[h] < to ? p->turn[h * p->k + i] * p->mean[h] : 0.0;
    return sum;
}

/* Column of a run's products of parameter a: the global ones, its block's, its specimen's. */
static size_t column_of(const infer_fit *fit, const infer_posterior *p, size_t a) {
    return a < fit->k              ? a
           : a < fit->k + p->width ? fit->k + of_block(p, a - fit->k)
                                   : a - p->width + INFER_BLOCK;
}

palp_status infer_run_moments(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                              size_t r, double *mean, double *covariance) {
    enum { S = INFER_SPECIMEN };
    const size_t k = fit->k, width = p->width, n = k + width + S, g = p->g + 1, outer = g + S + 1,
                 all = fit->m - 1;
    double l[INFER_BLOCK * INFER_BLOCK], own[INFER_BLOCK * INFER_BLOCK], log_prior, spread[S * S];
    double *cross = malloc(outer * width * sizeof *cross), *slope = malloc((g + 1) * S * sizeof *slope),
           *x = calloc((g + 1) * n + n + n * n, sizeof *x);
    palp_status status = cross && slope && x ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && !own_factor(fit, p, r, l, &log_prior))
        status = PALP_ERR_SINGULAR;
    if (!status) {
        double *middle = x + (g + 1) * n, *square = middle + n;
        depend_on_outer(fit, data, p, r, l, cross, slope, spread, own);
        for (size_t i = 0; i < S * S; i++) /* without a size it is 0, whatever its precision */
            spread[i] *= fit->sizes.specimen[i / S] > 0.0 && fit->sizes.specimen[i % S] > 0.0 ? 1.0 : 0.0;
        for (size_t a = 0; a < width; a++)
            for (size_t b = 0; b < width; b++)
                square[(k + a) * n + k + b] =
                    is_off(fit, p, a) || is_off(fit, p, b) ? 0.0 : own[a * width + b];
        for (size_t s = 0; s < S; s++)
            for (size_t t = 0; t < S; t++)
                square[(k + width + s) * n + k + width + t] = spread[s * S + t];
        for (size_t a = 0; a < width; a++)
            for (size_t s = 0; s < S; s++) {
                double both = 0.0;
                for (size_t t = 0; t < S; t++)
                    both -= cross[(g + t) * width + a] * spread[t * S + s];
                square[(k + a) * n + k + width + s] = square[(k + width + s) * n + k + a] = both;
            }
        for (size_t b = 0; b <= g; b++) {
            memcpy(x + b * n + k, cross + (b < g ? b : g + S) * width, width * sizeof *x);
            memcpy(x + b * n + k + width, slope + b * S, S * sizeof *x);
        }
        for (size_t a = 0; a < k; a++)
            x[(p->hats + a) * n + a] = -1.0;
        for (size_t h = 0; h < p->hats; h++)
            x[h * n + k + INFER_OWN + h] -= is_absent(fit, p, h) ? 0.0 : 1.0;
        status = add_global(p, n, x, middle, square);
        memset(mean, 0, all * sizeof *mean);
        memset(covariance, 0, all * all * sizeof *covariance);
        for (size_t a = 0; a < n; a++) {
            const size_t i = column_of(fit, p, a);
            mean[i] = middle[a];
            for (size_t b = 0; b < n; b++)
                covariance[i * all + column_of(fit, p, b)] = square[a * n + b];
        }
    }
    free(cross);
    free(slope);
    free(x);
    return status;
}

/* The mean alone, for which one right-hand side is enough: that of the residual without the outer parameters
 * at their posterior. mean[width] */
static palp_status find_own_mean(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                                 size_t r, double *mean) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g, outer = g + 1 + S + 1, hats = p->hats, width = p->width;
    double l[INFER_BLOCK * INFER_BLOCK], log_prior, specimen[S], multiplier = p->pull_of_mean[g];
    if (!own_factor(fit, p, r, l, &log_prior))
        return PALP_ERR_SINGULAR;
    palp_status status = infer_specimen_own(p, r, specimen, NULL);
    double *cross = status ? NULL : malloc(outer * width * sizeof *cross);
    if (!cross)
        return status ? status : PALP_ERR_NO_MEMORY;
    own_cross(fit, data, p, r, outer, cross);
    memcpy(mean, cross + (outer - 1) * width, width * sizeof *mean);
    for (size_t b = 0; b < outer - 1; b++) {
        const double at = b < hats ? p->mean[b]
                          : b < g  ? p->mean[b] - infer_undone(p, 0, INFER_HATS, b - hats)
                          : b == g ? multiplier
                                   : specimen[b - g - 1];
        multiplier -= b < g ? p->pull_of_mean[b] * at : 0.0;
        for (size_t a = 0; a < width; a++)
            mean[a] -= at * cross[b * width + a];
    }
    dense_cholesky_solve(width, l, 1, mean);
    free(cross);
    return PALP_OK;
}

/* The same with covariance[width width]. */
static palp_status find_own(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                            size_t r, double *mean, double *covariance) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g + 1, outer = g + S + 1, width = p->width;
    double l[INFER_BLOCK * INFER_BLOCK], log_prior, spread[S * S];
    double *cross = malloc(outer * width * sizeof *cross), *slope = malloc((g + 1) * S * sizeof *slope);
    palp_status status = cross && slope ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && !own_factor(fit, p, r, l, &log_prior))
        status = PALP_ERR_SINGULAR;
    if (!status) {
        depend_on_outer(fit, data, p, r, l, cross, slope, spread, covariance);
        memmove(cross + g * width, cross + (g + S) * width, width * sizeof *cross);
        status = add_global(p, width, cross, mean, covariance);
    }
    free(cross);
    free(slope);
    return status;
}

palp_status infer_own(const infer_fit *fit, const explain_data *data, const infer_posterior *p, size_t r,
                      double *mean, double *covariance) {
    double middle[INFER_BLOCK], square[INFER_BLOCK * INFER_BLOCK];
    const size_t width = p->width;
    palp_status status =
        covariance ? find_own(fit, data, p, r, middle, square) : find_own_mean(fit, data, p, r, middle);
    memset(mean, 0, INFER_BLOCK * sizeof *mean);
    for (size_t a = 0; a < INFER_BLOCK * INFER_BLOCK && covariance; a++)
        covariance[a] = a % (INFER_BLOCK + 1) == 0 ? 1.0 : 0.0;
    for (size_t a = 0; a < width && !status; a++) {
        const size_t i = of_block(p, a);
        mean[i] = middle[a];
        for (size_t b = 0; b < width && covariance; b++)
            covariance[i * INFER_BLOCK + of_block(p, b)] = square[a * width + b];
    }
    return status;
}
