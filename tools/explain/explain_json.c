/* explain_json.c: the result as JSON, and the next experiment as a protocol file. */
#include "explain.h"

#include "shared/json_out.h"

#include <math.h>
#include <string.h>

static const char *id_of(palp_effect_id id) {
    return palp_effect_look_up(id)->id;
}

static json_t *effect_json(const palp_explain_effect *f) {
    const palp_effect_info *info = palp_effect_look_up(f->effect.id);
    json_t *value = json_object(), *intervals = json_object(), *alike = json_array(), *object = json_object();
    for (size_t k = 0; k < info->n_parameters; k++) {
        const palp_effect_parameter *p = &info->parameter[k];
        double interval[2] = {f->low[k] / p->unit, f->high[k] / p->unit};
        json_figures(value, {p->key, f->effect.value[k] / p->unit});
        json_object_set_new(intervals, p->key, json_numbers(2, interval));
    }
    for (size_t k = 0; k < f->n_class; k++)
        json_array_append_new(alike, json_string(id_of(f->alike[k])));
    json_object_set_new(object, "id", json_string(info->id));
    json_object_set_new(object, "parameters", value);
    json_object_set_new(object, "intervals", intervals);
    json_object_set_new(object, "class", alike);
    json_figures(object, {"evidence", f->evidence}, {"evidence_standard_error", f->evidence_se},
                 {"gap_closed", f->gap_closed});
    json_object_set_new(object, "recovers", json_boolean(f->recovers));
    return object;
}

static json_t *gap_json(const palp_explanation *e) {
    json_t *gap = json_object();
    json_figures(gap, {"noise_level_N", e->gap.noise_level_N}, {"before_N", e->gap.before_N},
                 {"after_N", e->gap.after_N}, {"heldout_before_N", e->gap.heldout_before_N},
                 {"heldout_after_N", e->gap.heldout_after_N}, {"closed", e->gap.closed},
                 {"unexplained_N", e->unexplained_N});
    return gap;
}

static json_t *noise_level_json(const palp_explanation *e) {
    json_t *parts = json_object();
    json_figures(parts, {"white_N", e->white_N}, {"correlated_N", e->correlated_N},
                 {"correlation_s", e->correlation_s}, {"gain_scatter", e->gain.sd},
                 {"contact_scatter_mm", 1e3 * e->contact.sd});
    json_object_set_new(parts, "replicates", json_boolean(e->replicates));
    return parts;
}

static void add_scatter(json_t *list, const char *id, const char *key, double value,
                        const palp_explain_scatter *from, const palp_explanation *e) {
    if (!from->found)
        return;
    json_t *object = json_pack("{s:s}", "id", id);
    json_figures(object, {key, value}, {"evidence", from->evidence}, {"gap_before_N", from->without_N},
                 {"gap_after_N", e->gap.after_N});
    json_array_append_new(list, object);
}

/* Scatter from run to run that is distinguishable from noise. */
static json_t *scatter_json(const palp_explanation *e) {
    json_t *list = json_array();
    add_scatter(list, "zero_scatter", "sd_N", e->zero.sd, &e->zero, e);
    add_scatter(list, "contact_scatter", "sd_mm", 1e3 * e->contact.sd, &e->contact, e);
    add_scatter(list, "gain_scatter", "sd_share", e->gain.sd, &e->gain, e);
    const palp_explain_specimens *s = &e->specimens;
    const palp_explain_scatter specimens = {
        .without_N = s->without_N, .evidence = s->evidence, .found = s->found};
    add_scatter(list, "specimen_stiffness", "sd_share", s->sd, &specimens, e);
    return list;
}

static void add_law(json_t *root, const palp_explanation *e) {
    if (!e->law.found)
        return;
    const palp_material *given = &e->base.material, *better = &e->model.material;
    json_t *law = json_pack("{s:s, s:I, s:s, s:I, s:b, s:b}", "given", palp_law_kind_name(given->law.kind),
                            "given_coefficients", (json_int_t)given->law.n, "better",
                            palp_law_kind_name(better->law.kind), "better_coefficients",
                            (json_int_t)better->law.n, "given_quasi_linear", (int)given->quasi_linear,
                            "better_quasi_linear", (int)better->quasi_linear);
    json_figures(law, {"evidence", e->law.evidence}, {"gap_before_N", e->law.without_N},
                 {"gap_after_N", e->gap.after_N});
    json_object_set_new(root, "law", law);
}

/* The discrepancy by the variable that it depends on; its share is of the squared residual with the
 * effects. */
static void add_discrepancy(json_t *root, const palp_explanation *e) {
    const palp_explain_discrepancy *d = &e->discrepancy;
    const struct {
        const char *on;
        double rms_N;
    } part[] = {{"depth_loading", d->loading_N},
                {"depth_unloading", d->unloading_N},
                {"time_in_dwell", d->dwell_N},
                {"time_in_run", d->correlated_N}};
    json_t *list = json_array(), *all = json_object();
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        json_t *one = json_pack("{s:s}", "depends_on", part[i].on);
        const double share = e->gap.after_N > 0 ? pow(part[i].rms_N / e->gap.after_N, 2) : 0;
        json_figures(one, {"rms_N", part[i].rms_N}, {"share", share});
        json_array_append_new(list, one);
    }
    json_object_set_new(all, "found", json_boolean(d->found));
    json_figures(all, {"evidence", d->evidence});
    json_object_set_new(all, "parts", list);
    json_object_set_new(root, "discrepancy", all);
}

static json_t *phase_shares_json(const palp_explanation *e) {
    json_t *list = json_array();
    for (size_t i = 0; i < e->n_phase_shares; i++) {
        json_t *object = json_object();
        json_object_set_new(object, "experiment", json_text(e->run[e->phase_share[i].run].name));
        json_object_set_new(object, "phase", json_string(palp_phase_name(e->phase_share[i].phase)));
        json_figures(object, {"share", e->phase_share[i].share}, {"remaining", e->phase_share[i].remaining},
                     {"residual_lag1", e->phase_share[i].lag1},
                     {"residual_runs_z", e->phase_share[i].runs_z});
        json_array_append_new(list, object);
    }
    return list;
}

static json_t *events_json(const palp_explanation *e) {
    json_t *list = json_array();
    for (size_t i = 0; i < e->n_events; i++) {
        json_t *object = json_object();
        json_object_set_new(object, "experiment", json_text(e->run[e->event[i].run].name));
        json_object_set_new(object, "kind", json_string(e->event[i].kind));
        json_figures(object, {"from_s", e->event[i].from_s}, {"to_s", e->event[i].to_s},
                     {"size_N", e->event[i].size_N});
        json_array_append_new(list, object);
    }
    return list;
}

static json_t *peak_json(const palp_explain_peak *peak, const char *key, double unit) {
    json_t *object = json_object();
    json_figures(object, {key, peak->at / unit}, {"amplitude_N", peak->amplitude_N},
                 {"prominence", peak->prominence});
    return object;
}

/* The strongest lines of the residual, and the part that free curves could remove. */
static json_t *diagnostics_json(const palp_explanation *e) {
    json_t *diagnostics = json_object(), *curves = json_object();
    json_figures(curves, {"depth_N", e->diagnostics.by_depth_N}, {"time_N", e->diagnostics.by_time_N},
                 {"rate_N", e->diagnostics.by_rate_N});
    json_object_set_new(diagnostics, "line_in_time", peak_json(&e->diagnostics.in_time, "frequency_Hz", 1));
    json_object_set_new(diagnostics, "line_in_depth", peak_json(&e->diagnostics.in_depth, "period_mm", 1e-3));
    json_object_set_new(diagnostics, "free_curves", curves);
    return diagnostics;
}

static json_t *candidate_json(const palp_explain_candidate *s) {
    json_t *object = json_object();
    json_object_set_new(object, "id", json_string(id_of(s->id)));
    json_object_set_new(object, "reason", json_string(s->reason));
    json_figures(object, {"score", s->score}, {"explained_N", s->explained_N});
    return object;
}

static json_t *blind_json(const palp_explain_candidate *s) {
    json_t *object = json_object();
    json_object_set_new(object, "id", json_string(id_of(s->id)));
    json_object_set_new(object, "reason", json_string(s->reason));
    json_figures(object, {"share", s->share});
    return object;
}

/* Those rejected, or those that these runs cannot see. */
static json_t *candidates_json(const palp_explanation *e, bool blind) {
    json_t *list = json_array();
    for (size_t i = 0; i < e->n_candidates; i++) {
        const palp_explain_candidate *s = &e->candidate[i];
        if (s->accepted || s->identifiable == blind)
            continue;
        json_array_append_new(list, blind ? blind_json(s) : candidate_json(s));
    }
    return list;
}

static json_t *steps_json(const palp_explanation *e) {
    json_t *list = json_array();
    for (size_t i = 0; i < e->n_steps; i++) {
        const palp_explain_step *step = &e->step[i];
        json_t *object = json_object(), *rejected = json_array();
        json_object_set_new(object, "taken",
                            step->taken == PALP_EFFECT_COUNT ? json_null() : json_string(id_of(step->taken)));
        for (size_t k = 0; k < step->n_candidates; k++) {
            const palp_explain_candidate *s = &step->candidate[k];
            if (s->accepted) {
                json_figures(object, {"score", s->score}, {"explained_N", s->explained_N});
                continue;
            }
            json_array_append_new(rejected, candidate_json(s));
        }
        json_object_set_new(object, "rejected", rejected);
        json_array_append_new(list, object);
    }
    return list;
}

static json_t *runs_json(const palp_explain_next *next) {
    json_t *runs = json_array();
    for (size_t i = 0; i < next->n_runs; i++) {
        const palp_explain_next_run *from = &next->run[i];
        json_t *run = json_pack("{s:s}", "kind", from->kind);
        json_figures(run, {"depth_mm", from->depth_mm}, {"rate_mm_s", from->rate_mm_s});
        if (from->hold_s > 0)
            json_figures(run, {"hold_s", from->hold_s});
        if (from->cycles > 0)
            json_object_set_new(run, "cycles", json_integer((json_int_t)from->cycles));
        json_array_append_new(runs, run);
    }
    return runs;
}

static json_t *next_json(const palp_explanation *e) {
    const palp_explain_next *next = &e->next;
    if (!next->wanted)
        return json_null();
    json_t *object = json_object(), *between = json_array();
    for (int i = 0; i < 2; i++)
        json_array_append_new(between, json_string(id_of(next->between[i])));
    json_object_set_new(object, "runs", runs_json(next));
    json_object_set_new(object, "between", between);
    json_figures(object, {"separation_N", next->separation_N}, {"nats", next->nats},
                 {"information", next->information}, {"time_s", next->time_s});
    return object;
}

static json_t *pressed_json(const explain_options *o, const palp_explanation *e) {
    json_t *list = json_array();
    for (size_t i = 0; i < e->n_inputs; i++)
        json_array_append_new(list, json_pack("{s:o, s:s, s:b}", "experiment", json_text(o->words[i]),
                                              "object", palp_explain_object_name(e->pressed[i].object),
                                              "declared", (int)e->pressed[i].declared));
    return list;
}

/* The pairs, and the error of the lumped model for the simulated forces. */
static json_t *simulated_json(const explain_options *o, const palp_explanation *e) {
    json_t *all = json_object(), *list = json_array();
    for (size_t r = 0; r < o->n_words; r++)
        if (o->simulated_of[r] < o->n_simulated)
            json_array_append_new(list,
                                  json_pack("{s:o, s:o}", "experiment", json_text(o->words[r]), "simulated",
                                            json_text(o->simulated_files[o->simulated_of[r]])));
    json_object_set_new(all, "runs", list);
    json_figures(all, {"lumped_off_N", e->simulated_off_N});
    return all;
}

json_t *explain_json(const explain_options *o, const palp_explanation *e) {
    static const char *const contacts[] = {"known", "common", "free"};
    json_t *root = json_object(), *effects = json_array();
    for (size_t i = 0; i < e->n_effects; i++)
        json_array_append_new(effects, effect_json(&e->effect[i]));
    json_object_set_new(root, "palpate", json_pack("{s:i}", "explain", 1));
    json_object_set_new(root, "command", json_text(o->command));
    json_object_set_new(root, "verdict", json_string(palp_explain_verdict_name(e->verdict)));
    json_object_set_new(root, "stopped", json_boolean(e->stopped));
    json_object_set_new(root, "contact", json_string(contacts[o->contact]));
    json_object_set_new(root, "pressed", pressed_json(o, e));
    if (e->simulated)
        json_object_set_new(root, "simulated", simulated_json(o, e));
    json_object_set_new(root, "effects", effects);
    json_object_set_new(root, "gap", gap_json(e));
    json_object_set_new(root, "noise_level", noise_level_json(e));
    json_object_set_new(root, "scatter", scatter_json(e));
    add_law(root, e);
    add_discrepancy(root, e);
    if (e->free.n > 0)
        json_object_set_new(root, "free_term", explain_free(o, e));
    json_figures(root, {"null_threshold", e->null_threshold});
    json_object_set_new(root, "phase_shares", phase_shares_json(e));
    json_object_set_new(root, "profile", explain_profile(e));
    json_object_set_new(root, "spectrum", explain_spectrum(e));
    json_object_set_new(root, "events", events_json(e));
    json_object_set_new(root, "not_identifiable", candidates_json(e, true));
    json_object_set_new(root, "next_experiment", next_json(e));
    json_object_set_new(root, "rejected", candidates_json(e, false));
    json_object_set_new(root, "steps", steps_json(e));
    json_object_set_new(root, "residual_diagnostics", diagnostics_json(e));
    explain_add_words(root);
    return root;
}

json_t *explain_protocol(const palp_explanation *e) {
    json_t *root = json_object();
    char about[160];
    snprintf(about, sizeof about, "separates %s from %s", id_of(e->next.between[0]),
             id_of(e->next.between[1]));
    json_object_set_new(root, "palpate", json_pack("{s:i}", "protocol", 1));
    json_object_set_new(root, "about", json_string(about));
    json_figures(root, {"rest_s", e->next.rest_s});
    json_object_set_new(root, "runs", runs_json(&e->next));
    return root;
}
