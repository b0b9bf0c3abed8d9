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
    return status;
}

palp_status infer_fit_converge(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 12, EVALUATIONS = 10, SIZES = 20, NOISE = 100 };
    double last = fit->score;
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
    const infer_sizes sizes = infer_sizes_first(data);
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

static palp_status begin_in_two_ways(infer_fit *fit, const explain_data *data) {
    infer_fit anew;
    palp_status status = infer_fit_evaluate(fit, data);
    if (!status)
        status = infer_fit_copy(fit, data, &anew);
    if (status)
        return status;
    status = settle_all(fit, data);
    const palp_status other = settle_parameters_first(&anew, data);
    if (!other && (status || anew.score > fit->score)) {
        const infer_fit worse = *fit;
        *fit = anew;
        anew = worse;
        status = PALP_OK;
    }
    infer_fit_free(&anew);
    return status;
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
