/* characterize_json.c: the result of palpate characterize as JSON. */
#include "characterize.h"

static void set_text(json_t *to, const char *key, const char *text) {
    json_object_set_new(to, key, json_text(text));
}

static json_t *law_json(const palp_law *law) {
    json_t *to = json_object();
    set_text(to, "kind", palp_law_kind_name(law->kind));
    json_add_law(to, law);
    if (law->strain_max > 0)
        json_figures(to, {"strain_max", law->strain_max});
    return to;
}

static json_t *arms_json(const palp_material *m) {
    json_t *list = json_array();
    for (size_t j = 0; j < m->n_arms; j++) {
        const palp_arm *a = &m->arms[j];
        json_array_append_new(list,
                              json_pack("{s:f, s:f, s:f}", "stiffness_N", a->stiffness_N, "viscosity_Ns",
                                        a->viscosity_Ns, "tau_s", a->viscosity_Ns / a->stiffness_N));
    }
    return list;
}

static json_t *estimates_json(const palp_lumped_fit *f) {
    json_t *list = json_array();
    for (size_t i = 0; i < f->n_estimates; i++) {
        const palp_estimate *e = &f->estimate[i];
        json_t *to = json_object();
        set_text(to, "name", e->name);
        set_text(to, "unit", e->unit);
        json_figures(to, {"value", e->value}, {"sd", e->sd}, {"low", e->low}, {"high", e->high});
        json_object_set_new(to, "determined", json_boolean(e->determined));
        json_array_append_new(list, to);
    }
    return list;
}

static json_t *correlation_json(const palp_lumped_fit *f) {
    json_t *rows = json_array();
    for (size_t i = 0; i < f->n_estimates; i++)
        json_array_append_new(rows, json_numbers(f->n_estimates, f->correlation + i * f->n_estimates));
    return rows;
}

/* The laws that competed with the spline. */
static json_t *laws_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t k = 0; k < s->n_laws && s->n_laws > 1; k++) {
        json_t *to = json_object();
        set_text(to, "kind", palp_law_kind_name(s->law[k].kind));
        json_object_set_new(to, "parameters", json_integer((json_int_t)s->law[k].n));
        json_figures(to, {"log_odds", s->log_odds[k]});
        json_object_set_new(to, "taken", json_boolean(characterize_took(s, k)));
        json_array_append_new(list, to);
    }
    return list;
}

static json_t *fitted_run_json(const characterize_state *s, size_t i) {
    const palp_recording *r = &s->run[i];
    json_t *to = run_json(r);
    json_figures(to, {"peak_N", s->peak_N[i]},
                 {"largest_residual_percent", 100 * s->largest_N[i] / s->peak_N[i]});
    if (s->has_final) {
        json_figures(to, {"rms_N", s->final.rms_N[i]},
                     {"rms_noise", characterize_noise_ratio(&s->final, i, r)},
                     {"absolute_N", s->final.absolute_N[i]});
    }
    return to;
}

static json_t *static_json(const characterize_state *s, size_t i) {
    json_t *list = json_array();
    for (size_t d = DEGREE_MIN; d <= DEGREE_MAX; d++) {
        const palp_law *law = &s->plain[i][d];
        if (law->n)
            json_array_append_new(list, json_pack("{s:I, s:o, s:f}", "degree", (json_int_t)d,
                                                  "coefficients_N", json_numbers(law->n, law->coefficients),
                                                  "norm_N", s->norm_N[i][d]));
    }
    return json_pack("{s:o, s:o}", "file", json_text(s->run[i].name), "polynomials", list);
}

static json_t *single_json(const characterize_state *s, size_t i) {
    const palp_recording *r = &s->run[s->n_static + i];
    const palp_lumped_fit *f = &s->single[i];
    json_t *to = json_object();
    set_text(to, "file", r->name);
    json_figures(to, {"depth_mm", 1e3 * r->deepest_m}, {"strain", r->deepest_m / r->height_m});
    json_object_set_new(to, "estimates", estimates_json(f));
    json_figures(to, {"rms_N", f->rms_N[0]}, {"rms_noise", characterize_noise_ratio(f, 0, r)});
    json_object_set_new(to, "merged", json_integer((json_int_t)f->n_merged));
    json_object_set_new(to, "converged", json_boolean(f->converged));
    return to;
}

static json_t *shared_json(const characterize_state *s) {
    const palp_lumped_fit *f = &s->shared;
    json_t *to = json_object();
    json_object_set_new(to, "arms", arms_json(&f->material));
    json_object_set_new(to, "springs_N", json_numbers(f->n_runs, f->spring_N));
    json_object_set_new(to, "estimates", estimates_json(f));
    json_object_set_new(to, "correlation", correlation_json(f));
    json_figures(to, {"total_absolute_residual_N", characterize_total(f)});
    json_object_set_new(to, "merged", json_integer((json_int_t)f->n_merged));
    json_object_set_new(to, "converged", json_boolean(f->converged));
    return to;
}

static json_t *gap_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < s->n_gap; i++) {
        const characterize_gap *g = &s->gap[i];
        json_t *to = json_object();
        json_figures(to, {"strain", g->strain}, {"ramp_hold_N", g->run_N}, {"ramp_hold_low_N", g->low_N},
                     {"ramp_hold_high_N", g->high_N}, {"static_plain_N", g->plain_N},
                     {"joint_N", g->joint_N});
        json_array_append_new(list, to);
    }
    return list;
}

/* 95 % bands of K(e) and of the force K(e) e over the strains measured. */
static json_t *band_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < s->n_band; i++) {
        const characterize_known *at = &s->band[i];
        json_t *to = json_object();
        json_figures(to, {"strain", at->strain}, {"stiffness_N", at->stiffness_N},
                     {"stiffness_low_N", at->low_N}, {"stiffness_high_N", at->high_N},
                     {"force_N", at->stiffness_N * at->strain}, {"force_low_N", at->low_N * at->strain},
                     {"force_high_N", at->high_N * at->strain});
        json_array_append_new(list, to);
    }
    return list;
}

static json_t *spread_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < s->n_spread; i++) {
        const characterize_spread *at = &s->spread[i];
        json_t *to = json_object();
        json_figures(to, {"strain", at->strain}, {"mean_N", at->mean_N}, {"sd_N", at->sd_N},
                     {"low_N", at->low_N}, {"high_N", at->high_N});
        json_array_append_new(list, to);
    }
    return list;
}

static void add_lists(json_t *all, const characterize_state *s) {
    json_t *runs = json_array(), *statics = json_array(), *singles = json_array(), *warnings = json_array();
    for (size_t i = 0; i < s->n; i++)
        json_array_append_new(runs, fitted_run_json(s, i));
    for (size_t i = 0; i < s->n_static; i++)
        json_array_append_new(statics, static_json(s, i));
    for (size_t i = 0; i < s->n_single; i++)
        json_array_append_new(singles, single_json(s, i));
    for (size_t i = 0; i < s->n_warnings; i++)
        json_array_append_new(warnings, json_text(s->warning[i]));
    json_object_set_new(all, "runs", runs);
    json_object_set_new(all, "static", statics);
    json_object_set_new(all, "law_scores", laws_json(s));
    json_object_set_new(all, "per_depth", singles);
    json_object_set_new(all, "shared", s->has_shared ? shared_json(s) : json_null());
    json_object_set_new(all, "comparison", gap_json(s));
    json_object_set_new(all, "band", band_json(s));
    json_object_set_new(all, "moduli", characterize_tip_json(s));
    json_object_set_new(all, "spread", spread_json(s));
    json_object_set_new(all, "spectrum", characterize_spectrum_json(s));
    json_object_set_new(all, "specimens", characterize_json_specimens(s));
    json_object_set_new(all, "warnings", warnings);
}

json_t *characterize_json(const characterize_options *o, const characterize_state *s) {
    const palp_lumped_fit *f = characterize_fit_of(s);
    json_t *all = json_object();
    json_object_set_new(all, "palpate",
                        json_pack("{s:i, s:s}", "characterize", 1, "version", palp_version()));
    set_text(all, "command", o->command);
    set_text(all, "method", o->method == METHOD_GRID ? "grid" : "likelihood");
    json_object_set_new(all, "hold_only", json_boolean(o->dwell_only));
    json_object_set_new(all, "law", law_json(&s->material.law));
    json_object_set_new(all, "arms", arms_json(&s->material));
    json_object_set_new(all, "estimates", estimates_json(f));
    json_object_set_new(all, "correlation", correlation_json(f));
    json_figures(all, {"total_absolute_residual_N", characterize_total(f)}, {"reduced_chi2", f->reduced_chi2},
                 {"inflation", f->inflation});
    json_object_set_new(all, "merged", json_integer((json_int_t)f->n_merged));
    json_object_set_new(all, "constrained", json_boolean(f->constrained));
    json_object_set_new(all, "converged", json_boolean(f->converged));
    json_figures(all, {"strain_max", characterize_strain_max(s)});
    set_text(all, "contact",
             s->contact == PALP_CONTACT_FREE     ? "free"
             : s->contact == PALP_CONTACT_COMMON ? "common"
                                                 : "known");
    json_figures(all, {"contact_scatter_mm", 1e3 * s->contact_scatter_m},
                 {"gap_before_percent", s->gap_before_percent}, {"gap_after_percent", s->gap_after_percent});
    json_object_set_new(all, "filter",
                        json_pack("{s:s, s:i, s:f, s:b}", "kind", "Butterworth, forward and backward",
                                  "order", RUN_FILTER_ORDER, "cutoff_Hz", s->cutoff_Hz, "used_for_fit",
                                  o->fit_filtered));
    add_lists(all, s);
    return all;
}
