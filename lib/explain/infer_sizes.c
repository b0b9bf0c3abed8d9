/* infer_sizes.c: sizes of scatters and discrepancies by restricted maximum likelihood. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* For one size, summed over its coefficients: b' S^-1 C S^-1 b, and its expectation. The restricted
 * likelihood is largest where both are equal (Harville, J. Am. Stat. Assoc. 72 (1977) 320). */
typedef struct pair {
    double found, expected;
} pair;

/* One coefficient: posterior mean and variance. */
static void add_scalar(pair *s, double sd, double mean, double variance) {
    const double prior = sd * sd;
    s->found += mean * mean / (prior * prior);
    s->expected += 1.0 / prior - variance / (prior * prior);
}

/* A wrong contact must not move those of the other runs: in characterize the prior of contacts is Cauchy's,
 * as that of the bends. Returns its expected precision. */
static double add_contact(pair *s, double sd, const explain_data *data, double mean, double variance) {
    const double square = (mean * mean + variance) / (sd * sd),
                 certain = data->contacts_average_0 ? infer_cauchy_certain(square) : 1.0;
    add_scalar(s, sd, mean * sqrt(certain), variance * certain);
    return certain;
}

/* The sd of a contact in a file counts as one more contact with this error. */
static void add_told(pair *s, double sd, const explain_data *data) {
    for (size_t i = 0; sd > 0.0 && i < data->n_contact_told; i++)
        add_contact(s, sd, data, data->contact_told, 0.0);
}

/* One domain's hats: mean[NODES], covariance v with rows of n. */
static void add_hats(pair s[INFER_LENGTHS], const double size[INFER_LENGTHS], const double *mean,
                     const double *v, size_t n) {
    enum { N = INFER_NODES };
    double inverse[N * N] = {0.0}, one[N * N], turned[N], left[N * N];
    if (!infer_any(size))
        return;
    infer_hats_precision(size, N, inverse);
    dense_times(N, N, 1.0, inverse, mean, 0.0, turned);
    for (int l = 0; l < INFER_LENGTHS; l++) {
        double pulled[N];
        infer_matern(infer_lengths[l], one);
        dense_times(N, N, 1.0, one, turned, 0.0, pulled);
        s[l].found += dense_dot(N, turned, pulled);
        dense_product(N, N, N, inverse, one, left);
        double both[N * N];
        dense_product(N, N, N, left, inverse, both);
        for (size_t a = 0; a < N; a++)
            for (size_t b = 0; b < N; b++)
                s[l].expected += inverse[a * N + b] * one[b * N + a] - both[a * N + b] * v[b * n + a];
    }
}

/* Moves a size towards equality of both, at most tenfold in the square; a size too small to be seen becomes
 * 0. */
static void move(double *size, const pair *s, double least) {
    if (!(*size > 0.0) || !(s->expected > 0.0))
        return;
    *size *= sqrt(fmin(10.0, fmax(0.1, s->found / s->expected)));
    if (*size < least)
        *size = 0.0;
}

/* Sums over the second differences of the law's coordinates, at the best step; and the expected precision of
 * each. A law may bend sharply at a place (a knee), and be smooth elsewhere: the bends' prior is Cauchy's, a
 * mixture of normal ones over the precision. */
static void add_bends(pair *s, infer_fit *fit, const double *step, const double *covariance) {
    const size_t k = fit->k;
    for (size_t i = 1; i + 1 < fit->c.model.material.law.n; i++) {
        const double d[3] = {1.0, -2.0, 1.0};
        double mean = 0.0, variance = 0.0;
        for (size_t a = 0; a < 3; a++) {
            mean += d[a] * (fit->c.x[i - 1 + a] + step[i - 1 + a] - fit->given[i - 1 + a]);
            for (size_t b = 0; b < 3; b++)
                variance += d[a] * d[b] * covariance[(i - 1 + a) * k + i - 1 + b];
        }
        const double square = (mean * mean + variance) / (fit->sizes.bend * fit->sizes.bend);
        fit->certain[i] = infer_cauchy_certain(square);
        add_scalar(s, fit->sizes.bend, mean * sqrt(fit->certain[i]), variance * fit->certain[i]);
    }
}

static palp_status learn_once(infer_fit *fit, const explain_data *data, double *work) {
    enum { B = INFER_BLOCK };
    infer_posterior p;
    pair own[INFER_OWN] = {{0.0, 0.0}}, each[INFER_DOMAINS][INFER_LENGTHS] = {{{0.0, 0.0}}},
         common[INFER_DOMAINS][INFER_LENGTHS] = {{{0.0, 0.0}}}, bend = {0.0, 0.0},
         specimen[INFER_SPECIMEN] = {{0.0, 0.0}};
    palp_status status = infer_posterior_find(fit, data, &p);
    if (status)
        return status;
    const size_t g = p.g, k = fit->k;
    double mean[B], *covariance = work, *all = work + B * B, *theta = all + g * g;
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        if (data->run[r].held_out)
            continue;
        status = infer_own(fit, data, &p, r, mean, covariance);
        for (size_t a = 0; a < INFER_OWN && !status; a++)
            if (fit->sizes.own[a] > 0.0 && a == INFER_CONTACT)
                fit->contact_certain[r] =
                    add_contact(&own[a], fit->sizes.own[a], data, mean[a], covariance[a * B + a]);
            else if (fit->sizes.own[a] > 0.0)
                add_scalar(&own[a == INFER_COSINE ? INFER_SINE
                                : a == INFER_END  ? INFER_ZERO
                                                  : a],
                           fit->sizes.own[a], mean[a], covariance[a * B + a]);
        for (size_t d = 0; d < INFER_DOMAINS && !status; d++) {
            const size_t at = INFER_OWN + d * INFER_NODES;
            add_hats(each[d], fit->sizes.each[d], mean + at, covariance + at * B + at, B);
        }
    }
    if (data->contacts_average_0 &&
        fit->sizes.own[INFER_CONTACT] > 0.0) /* of contacts that average 0, one is known */
        own[INFER_CONTACT].expected -= 1.0 / (fit->sizes.own[INFER_CONTACT] * fit->sizes.own[INFER_CONTACT]);
    add_told(&own[INFER_CONTACT], fit->sizes.own[INFER_CONTACT], data);
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        double b[INFER_SPECIMEN], v[INFER_SPECIMEN * INFER_SPECIMEN];
        if (r > 0 && data->run[r].specimen == data->run[r - 1].specimen)
            continue;
        status = infer_specimen_own(&p, r, b, v);
        for (size_t a = 0; a < INFER_SPECIMEN && !status; a++)
            if (fit->sizes.specimen[a] > 0.0)
                add_scalar(&specimen[a], fit->sizes.specimen[a], b[a], v[a * (INFER_SPECIMEN + 1)]);
    }
    memset(all, 0, g * g * sizeof *all);
    for (size_t a = 0; a < g; a++)
        all[a * g + a] = 1.0;
    dense_cholesky_solve(g, p.factor, g, all);
    for (size_t d = 0; d < INFER_DOMAINS; d++)
        if (p.domain[d] != SIZE_MAX)
            add_hats(common[d], fit->sizes.common[d], p.mean + p.domain[d], all + p.domain[d] * (g + 1), g);
    for (size_t a = 0; a < k; a++)
        memcpy(theta + a * k, all + (p.hats + a) * g + p.hats, k * sizeof *theta);
    if (fit->c.model.material.law.kind == PALP_LAW_SPLINE && fit->n_known == 0)
        add_bends(&bend, fit, p.mean + p.hats, theta);
    infer_posterior_free(&p);
    if (status)
        return status;
    const double n = (double)explain_samples(data), hidden = fit->noise.white / sqrt(n);
    const double least[INFER_OWN] = {hidden, hidden / data->peak * data->deepest, hidden / data->peak, hidden,
                                     hidden};
    for (size_t a = 0; a < INFER_OWN; a++)
        move(&fit->sizes.own[a], &own[a], least[a]);
    for (size_t a = 0; a < INFER_SPECIMEN; a++)
        move(&fit->sizes.specimen[a], &specimen[a], hidden / data->peak);
    fit->sizes.own[INFER_COSINE] = fit->sizes.own[INFER_SINE];
    for (size_t d = 0; d < INFER_DOMAINS; d++)
        for (size_t l = 0; l < INFER_LENGTHS; l++) {
            move(&fit->sizes.each[d][l], &each[d][l], hidden);
            move(&fit->sizes.common[d][l], &common[d][l], hidden);
        }
    move(&fit->sizes.bend, &bend, 0.0);
    fit->sizes.bend = fmin(10.0, fmax(1e-4, fit->sizes.bend));
    return PALP_OK;
}

/* A size that was 0 with other parameters need not be with these: it begins again where it is barely seen. */
void infer_sizes_begin_anew(infer_fit *fit, const explain_data *data) {
    const double small = 3.0 * fit->noise.white / sqrt((double)explain_samples(data));
    const bool several = data->n_runs > 1;
    const double own[INFER_GAIN + 1] = {small,
                                        data->contacts_alike ? 0.0 : small / data->peak * data->deepest,
                                        infer_has_gains(data) ? small / data->peak : 0.0};
    for (size_t a = 0; a <= INFER_GAIN; a++)
        fit->sizes.own[a] = fmax(fit->sizes.own[a], own[a]);
    for (size_t a = 0; a < INFER_SPECIMEN && data->n_specimens > 1; a++)
        fit->sizes.specimen[a] = fmax(fit->sizes.specimen[a], small / data->peak);
    const size_t domains = fit->plain || data->law_alone ? 0 : fit->free ? fit->n_terms : INFER_DOMAINS;
    for (size_t d = 0; d < domains; d++)
        for (size_t l = 0; l < INFER_LENGTHS; l++) {
            fit->sizes.common[d][l] = fmax(fit->sizes.common[d][l], small);
            fit->sizes.each[d][l] = fmax(fit->sizes.each[d][l], several ? small : 0.0);
        }
}

/* The ends of the sensor's range differ as the zeros do, which may be added on either side of what saturates.
 * They are alike only if that is more probable by the threshold; one run that saturates says nothing. */
static palp_status choose_ends(infer_fit *fit, const explain_data *data) {
    double *size = &fit->sizes.own[INFER_END];
    const bool has_products = *size > 0.0;
    *size = explain_bends(&fit->c.model) ? fit->sizes.own[INFER_ZERO] : 0.0;
    palp_status status = PALP_OK;
    if (*size > 0.0 && !has_products)
        status = infer_fit_products(fit, data);
    if (!status)
        status = infer_fit_score(fit, data);
    if (status || !(*size > 0.0))
        return status;
    const double differ = fit->promised;
    *size = 0.0;
    status = infer_fit_score(fit, data);
    if (status || fit->promised - differ > data->threshold)
        return status;
    *size = fit->sizes.own[INFER_ZERO];
    return infer_fit_score(fit, data);
}

palp_status infer_sizes_learn(infer_fit *fit, const explain_data *data, size_t rounds) {
    const size_t g = fit->k + INFER_HATS;
    double *work = malloc((INFER_BLOCK * INFER_BLOCK + g * g + fit->k * fit->k) * sizeof *work);
    palp_status status = work ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < rounds && !status; i++)
        status = learn_once(fit, data, work);
    free(work);
    return status ? status : choose_ends(fit, data);
}
