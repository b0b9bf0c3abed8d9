/* explain_candidate.c: one effect of the catalogue added to a fit: from where its search starts, and the
 * refit. */
#include "explain_search.h"
#include "explain_noise.h"

#include <math.h>
#include <string.h>

static const double POOR = 1.2; /* chi2 per sample of a fit that may have gone astray */

static palp_status wave_in_depth(const effect_data *facts, double wave[3]) {
    return explain_line_in_depth(facts->runs, facts->residual, &wave[0], &wave[1], &wave[2]);
}

/* Without these an effect has no place to start from, or no column. */
static bool can_start(const effect_row *row, const effect_data *facts) {
    const bool needed = row->need == EFFECT_NEEDS_WITHDRAWAL || row->need == EFFECT_NEEDS_PERIODS ||
                        row->need == EFFECT_NEEDS_COLUMN || row->need == EFFECT_NEEDS_WEIGHT;
    char lack[EFFECT_LACK_MAX];
    return !needed || effect_need_met(row, facts, lack);
}

palp_status explain_starts_of(palp_effect_id id, const explain_data *data, const double *residual,
                              effect_starts *s) {
    const effect_row *row = effect_row_of(id);
    effect_data facts = explain_facts(data);
    facts.residual = residual;
    facts.wave_in_depth = wave_in_depth;
    *s = (effect_starts){.id = id};
    if (!can_start(row, &facts))
        return PALP_ERR_UNSUPPORTED;
    if (row->starts)
        return row->starts(&facts, s);
    effect_start_at(s, 0.0, 0.0, 0.0);
    return PALP_OK;
}

palp_status explain_starts_find(palp_effect_id id, const explain_data *data, const double *residual,
                                effect_starts *s, const char **reason) {
    const effect_data facts = explain_facts(data);
    char lack[EFFECT_LACK_MAX];
    if (effect_need_met(effect_row_of(id), &facts, lack))
        return explain_starts_of(id, data, residual, s);
    *s = (effect_starts){.id = id};
    *reason = "the runs lack what it needs";
    return PALP_ERR_UNSUPPORTED;
}

/* A strong effect may have led the plain model's own parameters and the contacts astray: those as given, and
 * all surfaces near where the model has them. */
static palp_status go_back(explain_fit *fit, const explain_data *data) {
    explain_fit given;
    palp_status status = explain_fit_create(data->given, data, &given);
    if (status)
        return status;
    size_t k = data->given->material.law.n + 2 * data->given->material.n_arms;
    memcpy(fit->x, given.x, k * sizeof *fit->x);
    memset(fit->contact, 0, 2 * data->n_runs * sizeof *fit->contact); /* and gains */
    fit->scatter.contact = fmin(fit->scatter.contact, explain_hidden_scatter(data).contact);
    fit->model.material = data->given->material;
    explain_fit_free(&given);
    return PALP_OK;
}

/* An offset of the contact begins at what the runs' own have in common, and they beside it: on the way there
 * from nothing, with their own where they are, all surfaces would be led away. */
static palp_status begin_at_mean(const explain_fit *base, const explain_data *data, explain_fit *fit) {
    const size_t last = fit->n_columns - 1;
    double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES], mean = 0.0, square = 0.0;
    const double runs = (double)explain_fitted_runs(data);
    for (size_t r = 0; r < data->n_runs; r++) {
        explain_nuisances(base, r, own, sd);
        mean += data->run[r].held_out ? 0.0 : own[1] / runs;
    }
    fit->x[last] = fmin(fit->high[last], fmax(fit->low[last], mean));
    for (size_t r = 0; r < data->n_runs; r++) {
        explain_nuisances(base, r, own, sd);
        fit->contact[r] = own[1] - fit->x[last];
        square += data->run[r].held_out ? 0.0 : (fit->contact[r] * fit->contact[r] + sd[1] * sd[1]) / runs;
    }
    fit->scatter.contact =
        fmin(fit->scatter.contact, fmax(explain_hidden_scatter(data).contact, sqrt(square)));
    return explain_fit_to_model(fit);
}

/* base, or back at the parameters as given, with the effect at a start. */
static palp_status added_at(const explain_fit *base, const explain_data *data, const palp_effect *effect,
                            bool back, explain_fit *fit) {
    palp_model model = base->model;
    model.effects[model.n_effects++] = *effect;
    palp_status status = explain_fit_beside(base, &model, data, fit);
    if (status)
        return status;
    const effect_row *row = effect_row_of(effect->id);
    if (back)
        status = go_back(fit, data);
    else if (row->of_runs && row->map)
        status = begin_at_mean(base, data, fit);
    if (!status)
        status = explain_fit_products(fit, data, NULL);
    if (status)
        explain_fit_free(fit);
    return status;
}

static palp_status hum_multistart(const explain_fit *base, const explain_data *data, const double *residual,
                                  const palp_explain_settings *settings, explain_multistart *m,
                                  const char **reason) {
    explain_fit *added = &m->start[0].fit;
    if (base->hum_Hz > 0.0) {
        *reason = "is in the model already";
        return PALP_ERR_UNSUPPORTED;
    }
    palp_status status = explain_fit_copy(base, data->n_runs, added);
    if (status)
        return status;
    m->n = 1;
    status = explain_line_in_time(data, residual, &added->hum_Hz, &added->hum_N);
    if (status == PALP_ERR_UNSUPPORTED)
        *reason = "no line stands out between 40 and 70 Hz";
    if (!status)
        status = explain_fit_products(added, data, NULL);
    if (!status)
        explain_fit_scatter(added, data, settings);
    return status ? status : explain_fit_predict(added, data, &m->start[0].chi2);
}

bool explain_has(const explain_fit *fit, palp_effect_id id) {
    for (size_t i = 0; i < fit->model.n_effects; i++)
        if (fit->model.effects[i].id == id)
            return true;
    return false;
}

/* ---- many starts ---- */

void explain_multistart_free(explain_multistart *m) {
    for (size_t i = 0; i < m->n; i++)
        explain_fit_free(&m->start[i].fit);
    m->n = 0;
}

/* Best first; equal ones as they came. */
static void multistart_sort(explain_multistart *r) {
    for (size_t i = 1; i < r->n; i++)
        for (size_t k = i; k > 0 && r->start[k].chi2 < r->start[k - 1].chi2; k--) {
            explain_start other = r->start[k];
            r->start[k] = r->start[k - 1];
            r->start[k - 1] = other;
        }
}

static void multistart_keep(explain_multistart *r, size_t n) {
    multistart_sort(r);
    while (r->n > n)
        explain_fit_free(&r->start[--r->n].fit);
}

/* One from a start, from the base's parameters (what one more step promises), or from those as given (after
 * rounds of improvement). A start without a solution does not take part. */
static palp_status multistart_enter(explain_multistart *r, const explain_fit *base, const explain_data *data,
                                    const palp_effect *start, size_t rounds_back) {
    explain_start *new = &r->start[r->n];
    palp_status status = added_at(base, data, start, rounds_back > 0, &new->fit);
    if (status)
        return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    if (rounds_back)
        status = explain_fit_improve(&new->fit, data, rounds_back);
    if (!status)
        status = explain_fit_predict(&new->fit, data, &new->chi2);
    if (status) {
        explain_fit_free(&new->fit);
        return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    }
    r->n++;
    return PALP_OK;
}

static palp_status multistart_run(explain_multistart *r, const explain_data *data, size_t rounds) {
    palp_status status = PALP_OK;
    for (size_t i = 0; i < r->n && !status; i++) {
        status = explain_fit_improve(&r->start[i].fit, data, rounds);
        if (!status)
            status = explain_fit_predict(&r->start[i].fit, data, &r->start[i].chi2);
    }
    return status;
}

/* One from each start. What a specimen keeps from a press may be gone before the next run, which no file
 * tells: where runs follow each other on it both are tried. */
static palp_status multistart_enter_all(explain_multistart *r, const explain_fit *base,
                                        const explain_data *data, const effect_starts *s,
                                        size_t rounds_back) {
    palp_status status = PALP_OK;
    explain_fit other = *base; /* reads base's, and owns nothing */
    other.renewed = !base->renewed;
    for (size_t k = 0; k < s->n && !status; k++) {
        status = multistart_enter(r, base, data, &s->effect[k], rounds_back);
        if (!status && explain_may_recover(data, s->id))
            status = multistart_enter(r, &other, data, &s->effect[k], rounds_back);
    }
    return status;
}

/* base with the effect of *like in it, whose strengths are nothing: as good as base itself. */
static palp_status added_at_zero(const explain_fit *base, const explain_fit *like, const explain_data *data,
                                 explain_fit *fit) {
    palp_model model = base->model;
    palp_effect *effect = &model.effects[model.n_effects++];
    *effect = like->model.effects[like->model.n_effects - 1];
    const palp_effect_info *info = palp_effect_look_up(effect->id);
    for (size_t p = 0; p < info->n_parameters; p++)
        effect->value[p] = info->parameter[p].strength ? 0.0 : effect->value[p];
    palp_status status = explain_fit_beside(base, &model, data, fit);
    if (!status)
        status = explain_fit_to_model(fit); /* of a logarithm the least there is */
    if (!status)
        status = explain_fit_products(fit, data, NULL);
    if (status)
        explain_fit_free(fit);
    return status;
}

/* A model with one effect more is never worse than base: where no start has come so far, one goes on from
 * base itself. */
static palp_status multistart_from_base(explain_multistart *r, const explain_fit *base,
                                        const explain_data *data, size_t rounds) {
    multistart_sort(r);
    explain_start *new = &r->start[r->n];
    if (r->n == 0 || r->start[0].chi2 < explain_chi2(data, base) * (double)explain_samples(data))
        return PALP_OK;
    palp_status status = added_at_zero(base, &r->start[0].fit, data, &new->fit);
    if (status)
        return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    r->n++;
    status = explain_fit_improve(&new->fit, data, rounds);
    return status ? status : explain_fit_predict(&new->fit, data, &new->chi2);
}

/* The starts that promise most, from the base's parameters and, where it fits badly, from those as given. */
static palp_status multistart_fill(explain_multistart *r, const explain_fit *base, const explain_data *data,
                                   const effect_starts *s, double worth) {
    enum { AHEAD = 3, BACK = 2 };
    palp_status status = multistart_enter_all(r, base, data, s, 0);
    multistart_keep(r, AHEAD);
    while (r->n > 0 && !(r->start[r->n - 1].chi2 < worth))
        explain_fit_free(&r->start[--r->n].fit);
    bool back =
        explain_chi2(data, base) > POOR && base->model.kind != PALP_MODEL_NETWORK; /* whose fits are dear */
    if (!status && back)
        status = multistart_enter_all(r, base, data, s, BACK);
    return status;
}

palp_status explain_candidate_multistart(const explain_fit *base, const explain_data *data,
                                         const double *residual, const palp_explain_settings *settings,
                                         palp_effect_id id, double worth, explain_multistart *m,
                                         const char **reason) {
    enum { REFINED = 4, ROUNDS = 4, FINALISTS = 2 };
    const palp_effect_info *info = palp_effect_look_up(id);
    m->n = 0;
    *reason = NULL;
    if (data->one_speed) /* nothing can be told from the law */
        return PALP_ERR_UNSUPPORTED;
    if (!explain_carries(&base->model, info) || (explain_has(base, id) && !info->repeats)) {
        *reason = explain_carries(&base->model, info) ? "is in the model already"
                                                      : "a model of this kind cannot have it";
        return PALP_ERR_UNSUPPORTED;
    }
    if (effect_row_of(id)->line)
        return hum_multistart(base, data, residual, settings, m, reason);
    effect_starts s;
    palp_status status = explain_starts_find(id, data, residual, &s, reason);
    worth = explain_chi2(data, base) * (double)explain_samples(data) - worth;
    if (effect_row_of(id)->as_scatter ||
        effect_row_of(id)->bond) /* the scatter of the runs may hide it: that shrinks later; where a
                                  * surface lets go, a step from afar promises nothing */
        worth = HUGE_VAL;
    if (!status)
        status = multistart_fill(m, base, data, &s, worth);
    if (!status) {
        multistart_keep(m, REFINED);
        status = multistart_run(m, data, ROUNDS);
        if (!status)
            status = multistart_from_base(m, base, data, ROUNDS);
        multistart_keep(m, FINALISTS);
    }
    if (!status && m->n == 0) {
        *reason = "gains no more than chance does";
        status = PALP_ERR_UNSUPPORTED;
    }
    return status;
}

static palp_status finish_one(explain_fit *fit, const explain_data *data,
                              const palp_explain_settings *settings, palp_effect_id id, bool all) {
    if (all && !effect_row_of(id)->line)
        return explain_fit_settle(fit, data, settings);
    explain_fit_scatter(fit, data, settings);
    return PALP_OK;
}

/* In *added the better of both; the other is freed. */
static void take_better(explain_fit *fit, explain_fit *added) {
    if (added->product && !(fit->score > added->score)) {
        explain_fit_free(fit);
        return;
    }
    explain_fit_free(added);
    *added = *fit;
    memset(fit, 0, sizeof *fit);
}

palp_status explain_candidate_finish(const explain_fit *base, explain_multistart *m, const explain_data *data,
                                     const palp_explain_settings *settings, palp_effect_id id, bool all,
                                     explain_fit *added) {
    palp_status status = PALP_OK;
    memset(added, 0, sizeof *added);
    for (size_t i = 0; !status && i < (all ? m->n : 1); i++) {
        explain_fit *fit = &m->start[i].fit;
        status = finish_one(fit, data, settings, id, all);
        if (!status)
            take_better(fit, added);
    }
    if (!status && all && added->score < base->score && !effect_row_of(id)->line) { /* it went astray */
        explain_fit again;
        status = added_at_zero(base, added, data, &again);
        if (!status) {
            status = finish_one(&again, data, settings, id, all);
            take_better(&again, added);
        } else if (status != PALP_ERR_NO_MEMORY)
            status = PALP_OK;
    }
    if (status)
        explain_fit_free(added);
    return status;
}
