/* infer_settle.c: parameters, contacts, sizes and noise in turn, to their most probable values. */
#include "infer_internal.h"

#include <math.h>
#include <string.h>

/* Each specimen's own to where the posterior has it: its columns belong to the factor at hand. */
static palp_status move_specimens(infer_fit *fit, const explain_data *data, const infer_posterior *p,
                                  bool *moved) {
    palp_status status = PALP_OK;
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        double mean[INFER_SPECIMEN];
        status = infer_specimen_own(p, r, mean, NULL);
        for (size_t a = 0; a < INFER_SPECIMEN && !status; a++) {
            double *at = &fit->specimen[r * INFER_SPECIMEN + a];
            const double to = fmin(*at + 1.0, fmax(*at - 1.0, mean[a]));
            *moved = *moved || fabs(to - *at) > fmax(0.02 * fit->sizes.specimen[a], 1e-4);
            *at = to;
        }
    }
    return status;
}

/* Each run's surface, and its gain where a sensor bends, to where the posterior has it, at most a quarter of
 * the depth away. */
static palp_status move_contacts(infer_fit *fit, const explain_data *data, bool *moved) {
    infer_posterior p;
    palp_status status = infer_posterior_find(fit, data, &p);
    *moved = false;
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        double own[INFER_BLOCK];
        status = infer_own(fit, data, &p, r, own, NULL);
        if (status)
            break;
        const double most = 0.25 * data->deepest, to = fmin(most, fmax(-most, own[INFER_CONTACT]));
        const double gain = explain_bends(&fit->c.model) ? fmin(0.5, fmax(-0.5, own[INFER_GAIN])) : 0.0;
        const double way = fabs(to - fit->c.contact[r]), more = fabs(gain - fit->c.gain[r]);
        if (way > fmax(0.05 * fit->sizes.own[INFER_CONTACT], 1e-4 * data->deepest) || more > 1e-3) {
            fit->c.contact[r] = to; /* otherwise the columns at hand stay those of where it is */
            fit->c.gain[r] = gain;
            *moved = true;
        }
    }
    if (!status)
        status = move_specimens(fit, data, &p, moved);
    infer_posterior_free(&p);
    return status;
}

palp_status infer_fit_settle(infer_fit *fit, const explain_data *data, size_t rounds, bool noise) {
    palp_status status = PALP_OK;
    double last = -HUGE_VAL;
    for (size_t i = 0; i < rounds && !status; i++) {
        bool moved;
        infer_sizes_begin_anew(fit, data);
        status = infer_fit_improve(fit, data, i == 0 ? 12 : 5);
        if (!status)
            status = infer_sizes_learn(fit, data, 6);
        if (!status && noise)
            status = infer_noise_learn(fit, data, 60, i > 1 || rounds == 1);
        if (!status)
            status = move_contacts(fit, data, &moved);
        if (!status && moved)
            status = infer_fit_evaluate(fit, data);
        if (!status && moved)
            status = infer_fit_score(fit, data);
        if (!status && !moved && fabs(fit->score - last) < 0.1)
            break;
        last = fit->score;
    }
    return status || !noise ? status : infer_fit_improve(fit, data, INFER_LAST);
}

palp_status infer_fit_converge(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 12, EVALUATIONS = 10, SIZES = 20, NOISE = 100 };
    double last = fit->score;
    for (size_t a = 0; a < fit->k; a++)
        fit->scan[a].spread = 0.0; /* both parameters of a bond are looked at once more */
    infer_sizes_begin_anew(fit, data);
    palp_status status = infer_fit_products(fit, data);
    for (size_t i = 0; i < ROUNDS && !status; i++) {
        bool moved = false;
        status = infer_sizes_learn(fit, data, SIZES);
        if (!status)
            status = infer_noise_learn(fit, data, NOISE, true);
        if (!status)
            status = move_contacts(fit, data, &moved);
        if (!status && moved)
            status = infer_fit_evaluate(fit, data);
        if (!status)
            status = infer_fit_improve(fit, data, EVALUATIONS);
        if (!status && !moved && fabs(fit->score - last) < 1e-3)
            break;
        last = fit->score;
    }
    return status;
}

static palp_status settle_all(infer_fit *fit, const explain_data *data) {
    palp_status status = infer_fit_settle(fit, data, 2, false);
    return status ? status : infer_fit_settle(fit, data, 4, true);
}

static palp_status settle_parameters_first(infer_fit *fit, const explain_data *data) {
    enum { EVALUATIONS = 30 };
    infer_sizes sizes = infer_sizes_first(data);
    sizes.own[INFER_SINE] = sizes.own[INFER_COSINE] = fit->sizes.own[INFER_SINE]; /* those of a line */
    infer_noise_begin(fit, data);
    fit->sizes = sizes;
    memset(fit->sizes.common, 0, sizeof sizes.common);
    memset(fit->sizes.each, 0, sizeof sizes.each);
    memset(fit->c.contact, 0, 2 * data->n_runs * sizeof *fit->c.contact); /* and the gains */
    palp_status status = infer_fit_evaluate(fit, data);
    if (!status)
        status = infer_fit_improve(fit, data, EVALUATIONS);
    fit->sizes = sizes;
    if (!status)
        status = infer_fit_evaluate(fit, data);
    return status ? status : settle_all(fit, data);
}

palp_status infer_fit_anneal(infer_fit *fit, const explain_data *data, size_t rounds) {
    enum { EVALUATIONS = 4 };
    memset(fit->sizes.common, 0, sizeof fit->sizes.common);
    memset(fit->sizes.each, 0, sizeof fit->sizes.each);
    palp_status status = infer_fit_evaluate(fit, data);
    for (size_t i = 0; i <= rounds && !status; i++) {
        infer_posterior p;
        if (i > 0)
            status = infer_fit_improve(fit, data, EVALUATIONS);
        if (!status)
            status = infer_posterior_find(fit, data, &p);
        if (status)
            break;
        fit->noise.white *= sqrt(p.here / (double)explain_samples(data));
        infer_posterior_free(&p);
        status = infer_fit_products(fit, data);
    }
    return status ? status : infer_fit_score(fit, data);
}

/* Instead of a fit, settled with this status, the one that begins anew from the other's parameters, if that
 * is more probable. The other is freed. */
static palp_status settle_anew(infer_fit *fit, palp_status status, const explain_data *data,
                               infer_fit *anew) {
    const palp_status other = settle_parameters_first(anew, data);
    if (!other && (status || anew->score > fit->score)) {
        const infer_fit worse = *fit;
        *fit = *anew;
        *anew = worse;
        status = PALP_OK;
    }
    infer_fit_free(anew);
    return status;
}

static palp_status begin_in_two_ways(infer_fit *fit, const explain_data *data) {
    infer_fit anew;
    palp_status status = infer_fit_evaluate(fit, data);
    if (!status)
        status = infer_fit_copy(fit, data, &anew);
    return status ? status : settle_anew(fit, settle_all(fit, data), data, &anew);
}

palp_status infer_begin_anew(infer_fit *fit, const explain_data *data) {
    infer_fit anew;
    palp_status status = infer_fit_copy(fit, data, &anew);
    return status ? status : settle_anew(fit, PALP_OK, data, &anew);
}

palp_status infer_begin(infer_fit *fit, const explain_data *data) {
    palp_model model = fit->c.model;
    palp_law *law = &model.material.law;
    infer_fit coarse, fine;
    if (law->kind != PALP_LAW_SPLINE || law->n != INFER_KNOTS)
        return begin_in_two_ways(fit, data);
    palp_status status = infer_spline_of(law, INFER_COARSE, law->strain[law->n - 1], law);
    if (!status)
        status = infer_fit_create_as(&model, data, NULL, &coarse);
    if (status)
        return status;
    coarse.c.renewed = fit->c.renewed;
    status = begin_in_two_ways(&coarse, data);
    if (!status) {
        model = coarse.c.model;
        status = infer_spline_of(law, INFER_KNOTS, law->strain[law->n - 1], law);
    }
    if (!status)
        status = infer_fit_create_as(&model, data, NULL, &fine);
    if (!status) {
        infer_fit_take_state(&coarse, data, &fine);
        fine.sizes.bend = 0.25 * coarse.sizes.bend; /* a second difference goes with the square of its way */
        infer_fit_free(fit);
        *fit = fine;
        status = infer_fit_evaluate(fit, data);
    }
    infer_fit_free(&coarse);
    return status ? status : infer_fit_settle(fit, data, 4, true);
}
