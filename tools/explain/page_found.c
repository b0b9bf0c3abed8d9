/* page_found.c: what palpate explain found, from its result as JSON: on its own page and in a report. */
#include "shared/digits.h"
#include "page.h"

#include <math.h>
#include <string.h>

/* ---- the verdict ---- */

/* Where no effect is named yet: which are the first to think of, and what to measure. */
static void ranked(FILE *to, const json_t *all) {
    const json_t *one = page_candidate(all, NULL);
    char next[2 * PAGE_LINE];
    for (int n = 1; n <= PAGE_CANDIDATES && one; n++, one = page_candidate(all, one))
        page_paragraph(to, "%d. %s (the natural logarithm of the likelihood grows by %.3g): %s.", n,
                       page_effect(json_text_at(one, "id")), json_number_at(one, "score"),
                       json_text_at(one, "reason"));
    page_next_text(all, next);
    page_paragraph(to, "Next: %s", next);
}

/* A parameter's value and its 95 % interval in words. */
typedef struct in_words {
    char name[48], unit[16], value[DIGITS_TEXT], low[DIGITS_TEXT], high[DIGITS_TEXT];
} in_words;

static void parameter_words(const json_t *effect, const char *key, double value, in_words *w) {
    const json_t *pair = json_object_get(json_object_get(effect, "intervals"), key);
    double low = json_number_value(json_array_get(pair, 0)),
           high = json_number_value(json_array_get(pair, 1)), half = 0.5 * (high - low);
    page_parameter(key, w->name, w->unit);
    digits_text(w->value, value, half);
    digits_text(w->low, low, half);
    digits_text(w->high, high, half);
}

/* "lag of the sensor: what that is. Here: time 0.0499 s (0.0493 to 0.0504)." */
static void effect_in_short(FILE *to, const json_t *effect) {
    json_t *value;
    const char *key, *id = json_text_at(effect, "id");
    char line[PAGE_LINE] = "";
    size_t used = 0;
    json_object_foreach(json_object_get(effect, "parameters"), key, value) {
        in_words w;
        parameter_words(effect, key, json_number_value(value), &w);
        if (used < sizeof line)
            used +=
                (size_t)snprintf(line + used, sizeof line - used, "%s%s %s%s%s (%s to %s)", used ? ", " : "",
                                 w.name, w.value, w.unit[0] ? " " : "", w.unit, w.low, w.high);
    }
    page_paragraph(to, "%s: %s Here: %s.", page_effect(id), page_effect_means(id), line);
}

static void verdict(FILE *to, const json_t *all, bool in_short) {
    const json_t *effects = json_object_get(all, "effects");
    page_story story;
    page_story_tell(all, &story);
    fputs("<div class=\"verdict ", to);
    html_text(to, json_text_at(all, "verdict"));
    fputs("\"><b>", to);
    html_text(to, story.line[0]);
    fputs("</b>\n", to);
    for (size_t i = 1; i < story.n; i++) {
        page_paragraph(to, "%s", story.line[i]);
        for (size_t k = 0; in_short && i == 1 && k < json_array_size(effects); k++)
            effect_in_short(to, json_array_get(effects, k));
    }
    if (strcmp(json_text_at(all, "verdict"), "suspected") == 0)
        ranked(to, all);
    fputs(in_short ? "<p><a href=\"#explain\">How this was found</a></p></div>\n" : "</div>\n", to);
}

void page_in_short(FILE *to, const json_t *all) {
    verdict(to, all, true);
}

/* ---- the gap ---- */

static void gap_bars(FILE *to, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    bool some = json_array_size(json_object_get(all, "effects")) > 0, one = page_one_recording(all);
    const page_bar bar[] = {
        {"all experiments", json_number_at(gap, "before_N"), some ? json_number_at(gap, "after_N") : NAN},
        {"experiments left out", json_number_at(gap, "heldout_before_N"),
         some ? json_number_at(gap, "heldout_after_N") : NAN},
    };
    char caption[PAGE_LINE], closed[80] = "";
    if (some && page_has_share(gap, "closed"))
        snprintf(closed, sizeof closed, " Of the gap above the noise level %.0f %% is closed.",
                 100 * page_share(gap, "closed"));
    snprintf(caption, sizeof caption, "The gap, rms: orange the model as given, refitted%s.%s%s",
             some ? ", blue with the effects" : "",
             one ? "" : " Below: experiments that the fit did not see.", closed);
    page_bars(to, caption, one ? 1 : sizeof bar / sizeof bar[0], bar, json_number_at(gap, "noise_level_N"));
}

/* "12 %", or "-" where it is none. */
static const char *amount(const json_t *object, const char *key, double per, const char *unit,
                          char text[32]) {
    double value = per * json_number_at(object, key);
    snprintf(text, 32, isfinite(value) ? "%.2g %s" : "-", value, unit);
    return text;
}

static void noise_level_table(FILE *to, const json_t *all) {
    const json_t *parts = json_object_get(all, "noise_level");
    char white[32], correlated[32], over[32], text[32];
    html_table(to, "What the noise level is made of", "part|~size");
    html_row(to, "white noise of a sample|~%s", page_force(json_number_at(parts, "white_N"), white));
    html_row(to, "correlated noise|~%s over %s",
             page_force(json_number_at(parts, "correlated_N"), correlated),
             amount(parts, "correlation_s", 1, "s", over));
    if (page_one_recording(all)) {
        html_table_end(to);
        return;
    }
    html_row(to, "beside it, gain from run to run|~%s", amount(parts, "gain_scatter", 100, "%", text));
    html_row(to, "contact from run to run|~%s", amount(parts, "contact_scatter_mm", 1, "mm", text));
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
    json_t *value;
    const char *key;
    json_object_foreach(json_object_get(effect, "parameters"), key, value) {
        in_words w;
        parameter_words(effect, key, json_number_value(value), &w);
        html_row(to, "%s|%s|%s to %s|~%s|~%s", w.name, w.value, w.low, w.high, w.unit, key);
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
    if (page_has_share(effect, "gap_closed"))
        page_paragraph(to,
                       "It closes %.0f %% of the squared gap above the noise level that is open without it.",
                       100 * page_share(effect, "gap_closed"));
    if (isfinite(json_number_at(effect, "evidence")) &&
        isfinite(json_number_at(effect, "evidence_standard_error")))
        page_paragraph(to,
                       "With it the experiments left out are more likely: the natural logarithm of their "
                       "likelihood grows by %.0f "
                       "\u00b1 %.0f.",
                       json_number_at(effect, "evidence"), json_number_at(effect, "evidence_standard_error"));
    if (json_is_true(json_object_get(effect, "recovers")))
        page_paragraph(
            to, "The specimen recovers between the runs of the session: each run begins as on a new one.");
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
    verdict(to, all, false);
    effects_section(to, all);
    gap_section(to, all);
    page_phases(to, all);
}

void page_how(FILE *to, const json_t *all) {
    page_search(to, all);
    page_diagnostics(to, all);
    page_next(to, all);
}
