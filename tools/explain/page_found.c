/* page_found.c: what palpate explain found, from its result as JSON: on its own page and in a report. */
#include "shared/digits.h"
#include "page.h"

#include <math.h>
#include <string.h>

/* ---- the verdict ---- */

static void effect_names(const json_t *all, char line[PAGE_LINE]) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL && n < PAGE_LINE; i++)
        n += (size_t)snprintf(line + n, PAGE_LINE - n, "%s%s", i ? ", " : "", page_effect(json_text_at(effect, "id")));
}

/* "a could as well be b, c" of each effect that is not alone in its class. */
static void classes(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    char alike[PAGE_LINE];
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL; i++) {
        page_names(json_object_get(effect, "class"), 1, " or ", alike);
        if (alike[0])
            page_paragraph(to, "What is called %s here could as well be %s: these runs cannot tell.",
                             page_effect(json_text_at(effect, "id")), alike);
    }
}

static void verdict(FILE *to, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    const char *name = json_text_at(all, "verdict");
    bool some = json_array_size(json_object_get(all, "effects")) > 0, unexplained = strcmp(name, "unexplained") == 0 || strcmp(name, "suspected") == 0;
    char names[PAGE_LINE], before[32], after[32], noise[32], rest[32];
    effect_names(all, names);
    page_force(json_number_at(gap, "heldout_before_N"), before);
    page_force(json_number_at(gap, "heldout_after_N"), after);
    page_force(json_number_at(gap, "noise_level_N"), noise);
    page_force(json_number_at(gap, "unexplained_N"), rest);
    fputs("<div class=\"verdict ", to);
    html_text(to, name);
    fputs("\"><b>", to);
    html_text(to, page_verdict(name, json_number_at(gap, "unexplained_N")));
    fputs("</b>\n", to);
    if (some)
        page_paragraph(to,
                         "The model as given lacks: %s. Once that is added, recorded minus model in experiments left out of "
                         "the fit falls from %s, rms, to %s. Noise alone makes %s.",
                         names, before, after, noise);
    else
        page_paragraph(to,
                         "With its numbers refitted, recorded minus model is %s, rms, in experiments left out of the fit if all "
                         "runs have one zero, contact and gain, and %s if each has its own. Noise alone makes %s.",
                         before, after, noise);
    if (unexplained)
        page_paragraph(to,
                         "Beyond noise %s, rms, of structure remain. %s", rest,
                         some ? "The effects named are there, but they are not all."
                              : "No effect is named: none closes enough of the gap to be more than a mimic.");
    if (strcmp(name, "agrees") == 0 && json_number_at(gap, "unexplained_N") > 0)
        page_paragraph(to, "What is above that, %s, is less than two thirds of the noise level or the practical limit.",
                         rest);
    classes(to, all);
    fputs("</div>\n", to);
}

/* ---- the gap ---- */

static void gap_bars(FILE *to, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    bool some = json_array_size(json_object_get(all, "effects")) > 0;
    const page_bar bar[] = {
        {"all experiments", json_number_at(gap, "before_N"), some ? json_number_at(gap, "after_N") : NAN},
        {"experiments left out", json_number_at(gap, "heldout_before_N"),
         some ? json_number_at(gap, "heldout_after_N") : NAN},
    };
    char caption[PAGE_LINE], closed[80] = "";
    if (some)
        snprintf(closed, sizeof closed, " Of the gap above the noise level %.0f %% is closed.", 100 * fmin(1, json_number_at(gap, "closed")));
    snprintf(caption, sizeof caption,
             "The gap, rms: orange the model as given, refitted%s. Below: experiments that the fit did not see.%s",
             some ? ", blue with the effects" : "", closed);
    page_bars(to, caption, sizeof bar / sizeof bar[0], bar, json_number_at(gap, "noise_level_N"));
}

static void noise_level_table(FILE *to, const json_t *all) {
    const json_t *parts = json_object_get(all, "noise_level");
    char white[32], correlated[32];
    html_table(to, "What the noise level is made of", "part|~size");
    html_row(to, "white noise of a sample|~%s", page_force(json_number_at(parts, "white_N"), white));
    html_row(to, "correlated noise|~%s over %.2g s", page_force(json_number_at(parts, "correlated_N"), correlated),
             json_number_at(parts, "correlation_s"));
    html_row(to, "beside it, gain from run to run|~%.2g %%", 100 * json_number_at(parts, "gain_scatter"));
    html_row(to, "contact from run to run|~%.2g mm", json_number_at(parts, "contact_scatter_mm"));
    html_row(to, "runs that go the same way|~%s",
             json_is_true(json_object_get(parts, "replicates")) ? "there are some" : "none: repeat a run");
    html_table_end(to);
}

static void gap_section(FILE *to, const json_t *all) {
    fputs("<h3>The gap before and after</h3>\n<div class=\"figures\">\n", to);
    gap_bars(to, all);
    fputs("<div>\n", to);
    noise_level_table(to, all);
    fputs("</div></div>\n", to);
}

/* ---- the effects ---- */

static void parameter_rows(FILE *to, const json_t *effect) {
    json_t *parameters = json_object_get(effect, "parameters"), *value;
    const char *key;
    char name[48], unit[16];
    json_object_foreach(parameters, key, value) {
        const json_t *pair = json_object_get(json_object_get(effect, "intervals"), key);
        double low = json_number_value(json_array_get(pair, 0)), high = json_number_value(json_array_get(pair, 1));
        double half = 0.5 * (high - low);
        char text[DIGITS_TEXT], from[DIGITS_TEXT], end[DIGITS_TEXT];
        page_parameter(key, name, unit);
        html_row(to, "%s|%s|%s to %s|~%s|~%s", name, digits_text(text, json_number_value(value), half), digits_text(from, low, half),
                 digits_text(end, high, half), unit, key);
    }
}

static void effect_card(FILE *to, const json_t *effect) {
    const char *id = json_text_at(effect, "id");
    char alike[PAGE_LINE];
    page_names(json_object_get(effect, "class"), 1, ", ", alike);
    fputs("<div class=\"effect\"><h4>", to);
    html_text(to, page_effect(id));
    fputs("</h4>\n", to);
    page_paragraph(to, "%s", page_effect_means(id));
    html_table(to, NULL, "parameter|value|95 % interval|~unit|~in the model file");
    parameter_rows(to, effect);
    html_table_end(to);
    page_paragraph(to,
                     "It closes %.0f %% of the squared gap above the noise level that is open without it; with it the experiments "
                     "left out are more likely: the natural logarithm of their likelihood grows by %.0f \u00b1 %.0f.",
                     100 * json_number_at(effect, "gap_closed"), json_number_at(effect, "evidence"),
                     json_number_at(effect, "evidence_standard_error"));
    page_paragraph(to, "Would do as well: %s.", alike[0] ? alike : "no other effect of the catalogue");
    fputs("</div>\n", to);
}

static void effects_section(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "effects");
    if (json_array_size(list) == 0)
        return;
    fputs("<h3>What is missing</h3>\n<div class=\"figures\">\n", to);
    for (size_t i = 0; i < json_array_size(list); i++)
        effect_card(to, json_array_get(list, i));
    fputs("</div>\n", to);
}

/* ---- all of it ---- */

void page_found(FILE *to, const json_t *all) {
    verdict(to, all);
    effects_section(to, all);
    gap_section(to, all);
    page_phases(to, all);
}

void page_how(FILE *to, const json_t *all) {
    page_search(to, all);
    page_diagnostics(to, all);
    page_next(to, all);
}
