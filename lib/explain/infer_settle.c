/* infer_settle.c: parameters, contacts, sizes and noise in turn, to their most probable values. */
#include "infer_internal.h"

#include <math.h>
#include <string.h>

/* This share of the way from one value to another, if the distance exceeds least. For a smaller one the
 * current columns suffice. */
static double move(double from, double to, double share, double least, bool *moved) {
    if (!(fabs(to - from) > least))
        return from;
    *moved = true;
    return from + share * (to - from);
}

/* Moves in *fit the parameters of each specimen, each run's surface, and its gain and zero where a sensor
 * bends. They go this share of the way from their values in *from to those of its posterior p; a surface goes
 * at most a quarter of the depth. The columns stay those of *from. */
static palp_status move_own(const infer_fit *from, const explain_data *data, const infer_posterior *p,
                            double share, infer_fit *fit, bool *moved) {
    const double most = 0.25 * data->deepest, force = 0.25 * data->peak;
    const bool bends = explain_bends(&from->c.model);
    palp_status status = PALP_OK;
    *moved = false;
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        double own[INFER_BLOCK], mean[INFER_SPECIMEN];
        status = infer_own(from, data, p, r, own, NULL);
        if (!status)
            status = infer_specimen_own(p, r, mean, NULL);
        if (status)
            break;
        fit->c.contact[r] = move(from->c.contact[r], fmin(most, fmax(-most, own[INFER_CONTACT])), share,
                                 fmax(0.05 * from->sizes.own[INFER_CONTACT], 1e-4 * data->deepest), moved);
        const double gain = bends ? fmin(0.5, fmax(-0.5, own[INFER_GAIN])) : 0.0,
                     zero = bends ? fmin(force, fmax(-force, own[INFER_ZERO])) : 0.0;
        fit->c.gain[r] = move(from->c.gain[r], gain, share, 1e-3, moved);
        fit->c.zero[r] = move(from->c.zero[r], zero, share,
                              fmax(0.05 * from->sizes.own[INFER_ZERO], 1e-4 * data->peak), moved);
        for (size_t a = 0; a < INFER_SPECIMEN; a++) {
            const size_t i = r * INFER_SPECIMEN + a;
            const double at = from->specimen[i], to = fmin(at + 1.0, fmax(at - 1.0, mean[a]));
            fit->specimen[i] = move(at, to, share, fmax(0.02 * from->sizes.specimen[a], 1e-4), moved);
        }
    }
    return status;
}

/* Log posterior density of the runs' parameters at the values of the columns, with the best step of all
 * others. */
static palp_status find_density(infer_fit *fit, const explain_data *data, double *density) {
    infer_posterior p;
    fit->held = true;
    palp_status status = infer_posterior_find(fit, data, &p);
    fit->held = false;
    if (!status)
        *density = infer_log_evidence(fit, &p, p.chi2);
    infer_posterior_free(&p);
    return status;
}

/* Moves the runs' parameters, and takes new columns there. A step that leads to a smaller density, or where
 * the model has no solution, is halved, three times at most. */
static palp_status move_contacts(infer_fit *fit, const explain_data *data, bool *moved) {
    enum { HALVES = 3 };
    infer_posterior p;
    infer_fit before;
    double was, density;
    palp_status status = infer_posterior_find(fit, data, &p);
    if (!status)
        status = move_own(fit, data, &p, 0.0, fit, moved);
    if (!status && *moved)
        status = infer_fit_copy(fit, data, &before);
    if (status || !*moved) {
        infer_posterior_free(&p);
        return status;
    }
    status = find_density(fit, data, &was);
    for (int i = 0; i <= HALVES && !status; i++) {
        status = move_own(&before, data, &p, ldexp(1.0, -i), fit, moved);
        if (!status)
            status = infer_fit_evaluate(fit, data);
        if (!status)
            status = find_density(fit, data, &density);
        if (!status && density > was)
            break;
        status = status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
        *moved = false;
    }
    infer_posterior_free(&p);
    if (!status && !*moved)
        infer_fit_exchange(fit, &before);
    infer_fit_free(&before);
    return status || !*moved ? status : infer_fit_score(fit, data);
}

/* The most probable sizes, and noise if it is asked for, after the best step of the parameters. */
static palp_status learn(infer_fit *fit, const explain_data *data, bool noise, bool near) {
    palp_status status = infer_sizes_learn(fit, data, 6);
    return status || !noise ? status : infer_noise_learn(fit, data, 10, !near);
}

/* The fit that was kept, if it is more probable; it is freed otherwise. */
static bool go_back(infer_fit *fit, infer_fit *kept) {
    const bool back = kept->raw && kept->score > fit->score;
    infer_fit_free(back ? fit : kept);
    if (back)
        *fit = *kept;
    memset(kept, 0, sizeof *kept);
    return back;
}

palp_status infer_fit_settle(infer_fit *fit, const explain_data *data, size_t rounds, bool noise) {
    palp_status status = PALP_OK;
    infer_fit kept = {.raw = NULL}; /* before sizes and noise were estimated for a step that may be
                                       rejected */
    double last = -HUGE_VAL;
    for (size_t i = 0; i < rounds && !status; i++) {
        bool moved, back = false;
        infer_sizes_begin_anew(fit, data);
        status = infer_fit_improve(fit, data, i == 0 ? 12 : 5);
        if (!status)
            back = go_back(fit, &kept);
        if (!status)
            status = move_contacts(fit, data, &moved);
        if (!status)
            status = infer_fit_copy(fit, data, &kept);
        if (!status && !back)
            status = learn(fit, data, noise, i > 1 || rounds == 1);
        if (!status && !moved && !back && fabs(fit->score - last) < 0.1)
            break;
        last = fit->score;
    }
    if (!status && noise)
        status = infer_fit_improve(fit, data, INFER_LAST);
    if (!status)
        go_back(fit, &kept);
    else if (kept.raw)
        infer_fit_free(&kept);
    return status;
}

/* This share of the way from one array to another. */
static void go(size_t n, const double *from, const double *to, double share, double *out) {
    for (size_t i = 0; i < n; i++)
        out[i] = from[i] + share * (to[i] - from[i]);
}

/* Sizes, noise and expected precisions of *fit this share of the way from those of one fit to another's. */
static void go_between(const infer_fit *from, const infer_fit *to, const explain_data *data, double share,
                       infer_fit *fit) {
    enum { NOISE = sizeof(infer_noise) / sizeof(double), SIZES = sizeof(infer_sizes) / sizeof(double) };
    go(NOISE, (const double *)&from->noise, (const double *)&to->noise, share, (double *)&fit->noise);
    go(SIZES, (const double *)&from->sizes, (const double *)&to->sizes, share, (double *)&fit->sizes);
    go(PALP_LAW_MAX, from->certain, to->certain, share, fit->certain);
    go(data->n_runs, from->contact_certain, to->contact_certain, share, fit->contact_certain);
    for (size_t i = 0; i < data->n; i++) {
        go(1, &from->sample[i].certain, &to->sample[i].certain, share, &fit->sample[i].certain);
        go(INFER_SLOW, from->sample[i].steady, to->sample[i].steady, share, fit->sample[i].steady);
    }
}

/* Contacts and parameters at the sizes and the noise at hand. */
static palp_status follow(infer_fit *fit, const explain_data *data, bool *moved) {
    enum { EVALUATIONS = 10 };
    palp_status status = move_contacts(fit, data, moved);
    return status ? status : infer_fit_improve(fit, data, EVALUATIONS);
}

/* Sizes and noise are learned for a step that the columns predict. Where the step is worse, as the forces are
 * not linear, they go a part of that way only, or none. */
static palp_status go_part(infer_fit *fit, infer_fit *before, const explain_data *data, bool *moved) {
    enum { QUARTERS = 4 };
    palp_status status = PALP_OK;
    for (int i = 1; i <= QUARTERS && !status && !(fit->score >= before->score); i++) {
        infer_fit part;
        status = infer_fit_copy(before, data, &part);
        if (status)
            break;
        go_between(before, fit, data, ldexp(1.0, -2 * i), &part);
        palp_status failed = infer_fit_products(&part, data);
        if (!failed)
            failed = follow(&part, data, moved);
        if (!failed && part.score >= before->score)
            infer_fit_exchange(fit, &part);
        infer_fit_free(&part);
        status = failed == PALP_ERR_NO_MEMORY ? failed : PALP_OK;
    }
    if (!status && !(fit->score >= before->score)) {
        *moved = false;
        infer_fit_exchange(fit, before);
    }
    return status;
}

palp_status infer_fit_converge(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 12, SIZES = 20, NOISE = 25 };
    bool moved = false;
    for (size_t a = 0; a < fit->k; a++)
        fit->scan[a].spread = 0.0; /* both parameters of a bond are scanned once more */
    infer_sizes_begin_anew(fit, data);
    palp_status status = infer_fit_products(fit, data);
    if (!status)
        status = follow(fit, data, &moved);
    for (size_t i = 0; i < ROUNDS && !status; i++) {
        infer_fit before;
        status = infer_fit_copy(fit, data, &before);
        if (status)
            break;
        const double last = fit->score;
        status = infer_sizes_learn(fit, data, SIZES);
        if (!status)
            status = infer_noise_learn(fit, data, NOISE, false);
        if (!status)
            status = follow(fit, data, &moved);
        if (!status)
            status = go_part(fit, &before, data, &moved);
        infer_fit_free(&before);
        if (!status && !moved && fabs(fit->score - last) < 1e-3)
            break;
    }
    return status;
}

static palp_status settle_all(infer_fit *fit, const explain_data *data) {
    palp_status status = infer_fit_settle(fit, data, 2, false);
    return status ? status : infer_fit_settle(fit, data, 4, true);
}

palp_status infer_fit_anneal(infer_fit *fit, const explain_data *data, size_t rounds) {
    enum { EVALUATIONS = 4 };
    if (!fit->free) {
        memset(fit->sizes.common, 0, sizeof fit->sizes.common);
        memset(fit->sizes.each, 0, sizeof fit->sizes.each);
    }
    palp_status status = infer_fit_evaluate(fit, data);
    for (size_t i = 0; i <= rounds && !status; i++) {
        infer_posterior p;
        bool moved;
        if (i > 0)
            status = infer_fit_improve(fit, data, EVALUATIONS);
        if (!status && i > 0)
            status = move_contacts(fit, data, &moved);
        if (!status)
            status = infer_posterior_find(fit, data, &p);
        if (status)
            break;
        fit->noise.white *= sqrt(p.here / (double)explain_samples(data));
        infer_posterior_free(&p);
        status = infer_fit_products(fit, data);
        if (!status && i > 0 && data->law_alone) /* a misfit must not distort the model */
            status = infer_tails_learn(fit, data);
    }
    return status ? status : infer_fit_score(fit, data);
}

/* Without a discrepancy first, from contacts, gains and specimens that are alike. */
static palp_status settle_parameters_first(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 6 };
    infer_sizes sizes = infer_sizes_first(data);
    sizes.own[INFER_SINE] = sizes.own[INFER_COSINE] = fit->sizes.own[INFER_SINE]; /* those of a line */
    infer_noise_begin(fit, data);
    fit->sizes = sizes;
    memset(fit->c.contact, 0, 3 * data->n_runs * sizeof *fit->c.contact); /* gains and zeros too */
    palp_status status = infer_fit_anneal(fit, data, ROUNDS);
    fit->sizes = sizes;
    if (!status)
        status = infer_fit_evaluate(fit, data);
    return status ? status : settle_all(fit, data);
}

/* Keeps the more probable of two fits, which ended with these statuses, in *fit. The other is freed. */
static palp_status take_better(infer_fit *fit, palp_status status, infer_fit *anew, palp_status other) {
    if (!other && (status || anew->score > fit->score)) {
        infer_fit_exchange(fit, anew);
        status = PALP_OK;
    }
    infer_fit_free(anew);
    return status;
}

typedef struct ways {
    infer_fit *fit, anew;
    const explain_data *data;
    palp_status status[2];
} ways;

static void settle_way(void *user, size_t i) {
    ways *w = user;
    w->status[i] = i == 0 ? settle_all(w->fit, w->data) : settle_parameters_first(&w->anew, w->data);
}

static palp_status begin_in_two_ways(infer_fit *fit, const explain_data *data,
                                     const palp_explain_settings *settings) {
    ways w = {.fit = fit, .data = data};
    palp_status status = infer_fit_evaluate(fit, data);
    if (!status)
        status = infer_fit_copy(fit, data, &w.anew);
    if (status)
        return status;
    explain_each(settings, 2, settle_way, &w, w.status);
    return take_better(fit, w.status[0], &w.anew, w.status[1]);
}

palp_status infer_begin_anew(infer_fit *fit, const explain_data *data) {
    infer_fit anew;
    palp_status status = infer_fit_copy(fit, data, &anew);
    return status ? status : take_better(fit, PALP_OK, &anew, settle_parameters_first(&anew, data));
}

/* The fit with all knots from the one with fewer. */
static palp_status refine(const infer_fit *coarse, const explain_data *data, infer_fit *fit) {
    palp_model model = coarse->c.model;
    palp_law *law = &model.material.law;
    infer_fit fine;
    palp_status status = infer_spline_of(law, INFER_KNOTS, law->strain[law->n - 1], law);
    if (!status)
        status = infer_fit_create_as(&model, data, NULL, &fine);
    if (status)
        return status;
    infer_fit_take_state(coarse, data, &fine);
    fine.sizes.bend = 0.25 * coarse->sizes.bend; /* a second difference grows with the square of the
                                                    distance */
    status = infer_fit_evaluate(&fine, data);
    if (!status)
        status = infer_fit_settle(&fine, data, 4, true);
    if (!status)
        infer_fit_exchange(fit, &fine);
    infer_fit_free(&fine);
    return status;
}

/* With fewer knots first. If the model, mostly a network, has no solution on the way, with all from the
 * start. */
palp_status infer_begin(infer_fit *fit, const explain_data *data, const palp_explain_settings *settings) {
    palp_model model = fit->c.model;
    palp_law *law = &model.material.law;
    infer_fit coarse;
    if (law->kind != PALP_LAW_SPLINE || law->n != INFER_KNOTS || fit->n_known > 0)
        return begin_in_two_ways(fit, data, settings);
    palp_status status = infer_spline_of(law, INFER_COARSE, law->strain[law->n - 1], law);
    if (!status)
        status = infer_fit_create_as(&model, data, NULL, &coarse);
    if (status)
        return status;
    coarse.c.renewed = fit->c.renewed;
    status = begin_in_two_ways(&coarse, data, settings);
    if (!status)
        status = refine(&coarse, data, fit);
    infer_fit_free(&coarse);
    return status == PALP_ERR_NOT_CONVERGED ? begin_in_two_ways(fit, data, settings) : status;
}
