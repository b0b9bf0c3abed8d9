/* explain_free.c: free terms, which no effect of the catalogue describes, as JSON and in sentences. */
#include "explain.h"
#include "shared/json_out.h"

#include <math.h>
#include <string.h>

/* The variable of a kind, in words and in the unit of the result. */
static const struct {
    const char *words, *unit;
    double size;
} kinds[PALP_FREE_KINDS] = {
    {"the strain on the way in", "1", 1},
    {"the strain on the way out", "1", 1},
    {"the time in a dwell, in proportion to the depth", "s", 1},
    {"the time in the run", "s", 1},
    {"the time in the run, early in it", "s", 1},
    {"the time in the run, in proportion to the force of the plate", "s", 1},
    {"the speed", "mm/s", 1e-3},
    {"the speed, in proportion to the depth", "mm/s", 1e-3},
    {"the way since the plate turned, in proportion to the depth", "mm", 1e-3},
    {"the time in the session", "s", 1},
    {"the place of the plate", "mm", 1e-3},
    {"the place of the plate, in proportion to its force", "mm", 1e-3},
    {"the time since the speed changed, in proportion to the change", "s", 1},
};

static const palp_free_term *term_of(const palp_explanation *e, size_t i) {
    return &e->model.free_term[e->model.n_free - e->free.n + i]; /* after those of the given model */
}

static json_t *term_json(const palp_explanation *e, size_t i) {
    enum { N = PALP_FREE_NODES };
    const palp_free_term *t = term_of(e, i);
    double at[N], low[N], high[N];
    for (size_t a = 0; a < N; a++) {
        at[a] = palp_free_term_coordinate(t, (double)a / (N - 1)) / kinds[t->kind].size;
        low[a] = t->force_N[a] - 1.96 * t->sd_N[a];
        high[a] = t->force_N[a] + 1.96 * t->sd_N[a];
    }
    json_t *term = json_pack("{s:s, s:s, s:s}", "depends_on", palp_free_kind_name(t->kind), "class",
                             palp_free_class_name(t->does), "unit", kinds[t->kind].unit);
    json_object_set_new(term, "at", json_numbers(N, at));
    json_object_set_new(term, "force_N", json_numbers(N, t->force_N));
    json_object_set_new(term, "low_N", json_numbers(N, low));
    json_object_set_new(term, "high_N", json_numbers(N, high));
    json_figures(term, {"evidence", e->free.evidence[i]}, {"rms_N", e->free.rms_N[i]});
    return term;
}

/* "0.31 N exp(-|x| / 1.2 s)" with what x is; and its constants with their intervals. */
static json_t *formula_json(const palp_free_term *t, const palp_formula *f) {
    enum { LINE = 160 };
    const char *unit = strcmp(kinds[t->kind].unit, "1") ? kinds[t->kind].unit : "";
    const double scale = f->scale / kinds[t->kind].size;
    char text[PALP_FORMULA_PARTS * LINE] = "";
    json_t *parts = json_array(), *all = json_object();
    for (size_t i = 0; i < f->n; i++) {
        const bool power = f->part[i].form == PALP_FORM_POWER, hinge = f->part[i].form == PALP_FORM_HINGE;
        const double by = power ? 1 : scale, shape = by * f->part[i].shape, force = f->part[i].force_N,
                     per = hinge ? scale : 1, /* a hinge has a slope */
            force_of[2] = {f->part[i].force_low_N / per, f->part[i].force_high_N / per},
                     shape_of[2] = {by * f->part[i].shape_low, by * f->part[i].shape_high};
        char one[LINE];
        if (power)
            snprintf(one, LINE, "%.4g N sign(x) |x / %.4g %s|^%.3g", force, scale, unit, shape);
        else if (hinge)
            snprintf(one, LINE, "%.4g N/%s sign(x) max(0, |x| - %.4g %s)", force / per, *unit ? unit : "1",
                     shape, unit);
        else
            snprintf(one, LINE,
                     f->part[i].form == PALP_FORM_EXPONENTIAL ? "%.4g N exp(-|x| / %.4g %s)"
                                                              : "%.4g N x / (|x| + %.4g %s)",
                     force, shape, unit);
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i ? " + " : "", one);
        json_t *part = json_pack("{s:s}", "form", palp_formula_form_name(f->part[i].form));
        json_figures(part, {"force_N", force / per}, {"shape", shape});
        json_object_set_new(part, "force_interval", json_numbers(2, force_of));
        json_object_set_new(part, "shape_interval", json_numbers(2, shape_of));
        json_array_append_new(parts, part);
    }
    json_object_set_new(all, "text", json_text(text));
    json_object_set_new(all, "parts", parts);
    json_figures(all, {"evidence", f->evidence}, {"evidence_over_next", f->evidence_over});
    return all;
}

json_t *explain_free(const explain_options *o, const palp_explanation *e) {
    const palp_explain_free *f = &e->free;
    json_t *all = json_object(), *terms = json_array();
    for (size_t i = 0; i < f->n; i++) {
        json_t *term = term_json(e, i);
        palp_formula formula;
        if (o->sparse && !palp_formula_find(term_of(e, i), f->information[i], f->pull[i], f->scale_N,
                                            o->false_alarm, &formula))
            json_object_set_new(term, "formula",
                                formula.n ? formula_json(term_of(e, i), &formula) : json_null());
        json_array_append_new(terms, term);
    }
    json_object_set_new(
        all, "resembles",
        f->resembles == PALP_EFFECT_COUNT ? json_null() : json_string(palp_effect_look_up(f->resembles)->id));
    json_figures(all, {"heldout_before_N", f->heldout_before_N}, {"heldout_after_N", f->heldout_after_N},
                 {"noise_level_N", f->noise_level_N}, {"closed", f->closed}, {"after_N", f->after_N});
    json_object_set_new(all, "terms", terms);
    return all;
}

static const char *words_of(const char *name) {
    for (int k = 0; k < PALP_FREE_KINDS; k++)
        if (strcmp(palp_free_kind_name((palp_free_kind)k), name) == 0)
            return kinds[k].words;
    return name;
}

static void say_formula(json_t *story, const json_t *formula) {
    enum { LINE = 640 };
    const json_t *part, *list = json_object_get(formula, "parts");
    char line[LINE];
    if (json_is_null(formula))
        json_array_append_new(story, json_text("No sum of the known forms describes it."));
    if (!json_is_object(formula))
        return;
    snprintf(line, LINE, "Its formula over x is %s.", json_text_at(formula, "text"));
    json_array_append_new(story, json_text(line));
    for (size_t i = 0; (part = json_array_get(list, i)) != NULL; i++) {
        const json_t *force = json_object_get(part, "force_interval"),
                     *shape = json_object_get(part, "shape_interval");
        snprintf(line, LINE, "The 95 %% intervals of its %s are %.4g to %.4g N and %.4g to %.4g.",
                 json_text_at(part, "form"), json_number_value(json_array_get(force, 0)),
                 json_number_value(json_array_get(force, 1)), json_number_value(json_array_get(shape, 0)),
                 json_number_value(json_array_get(shape, 1)));
        json_array_append_new(story, json_text(line));
    }
}

void explain_free_say(json_t *story, const json_t *all) {
    enum { LINE = 512 };
    const json_t *free_term = json_object_get(all, "free_term"), *terms = json_object_get(free_term, "terms"),
                 *one;
    const char *resembles = json_text_at(free_term, "resembles");
    palp_effect_id id;
    char line[LINE];
    for (size_t i = 0; (one = json_array_get(terms, i)) != NULL; i++) {
        snprintf(line, LINE, "The model that is written has a free term of %s: %s, %.3g N, rms.",
                 words_of(json_text_at(one, "depends_on")), json_text_at(one, "class"),
                 json_number_at(one, "rms_N"));
        json_array_append_new(story, json_text(line));
        say_formula(story, json_object_get(one, "formula"));
    }
    if (!json_is_object(free_term))
        return;
    if (json_number_at(free_term, "heldout_before_N") > 0) {
        snprintf(
            line, LINE,
            "With it recorded minus model in experiments left out goes from %.3g to %.3g N, rms: %.0f %% "
            "of the gap.",
            json_number_at(free_term, "heldout_before_N"), json_number_at(free_term, "heldout_after_N"),
            100 * json_number_at(free_term, "closed"));
        json_array_append_new(story, json_text(line));
    }
    if (!palp_effect_parse(resembles, &id)) {
        snprintf(line, LINE, "It resembles %s, but its form differs.", palp_effect_look_up(id)->name);
        json_array_append_new(story, json_text(line));
    }
}
