/* report_explain.c: what palpate explain found, from its result as JSON: on its own page and in a report. */
#include "digits.h"
#include "report.h"

#include <math.h>
#include <string.h>

enum { PLACES = 8, LINE = 512 };

const char *report_effect(const char *id) {
    palp_effect_id found;
    return palp_effect_by_name(id, &found) ? id : palp_effect_look_up(found)->name;
}

static double in_mN(const json_t *object, const char *key) {
    return 1e3 * report_number(object, key);
}

const char *report_verdict(const char *verdict) {
    static const char *const text[][2] = {
        {"agrees", "Nothing is missing that these runs could show."},
        {"explained", "With the effects below, what remains is at the floor."},
        {"ambiguous", "The effects below close the gap, but others would do as well: see the class."},
        {"unexplained", "Something is missing that no effect of the catalogue accounts for."},
    };
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
        if (strcmp(verdict, text[i][0]) == 0) {
            return text[i][1];
        }
    }
    return verdict;
}

static const char *effect_at(const json_t *ids, size_t i) {
    const char *id = json_string_value(json_array_get(ids, i));
    return id ? report_effect(id) : "-";
}

/* "a, b, c" of the names from one on. */
static void names(const json_t *ids, size_t from, char line[LINE]) {
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = from; i < json_array_size(ids) && n < LINE; i++) {
        n += (size_t)snprintf(line + n, LINE - n, "%s%s", i > from ? ", " : "", effect_at(ids, i));
    }
}

static void paragraph(FILE *to, const char *text) {
    fputs("<p>", to);
    html_text(to, text);
    fputs("</p>\n", to);
}

static void cards(FILE *to, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    bool effects = json_array_size(json_object_get(all, "effects")) > 0;
    fputs("<div class=\"cards\">\n", to);
    html_card(to, "Verdict", "%s", report_text(all, "verdict"));
    html_card(to, "Gap of experiments left out, rms", effects ? "%.3g \u2192 %.3g mN" : "%.3g mN",
              in_mN(gap, "heldout_before_N"), in_mN(gap, "heldout_after_N"));
    html_card(to, "Floor: noise and scatter between runs, rms", "%.3g mN", in_mN(gap, "floor_N"));
    html_card(to, "Structure above the floor that remains, rms", "%.3g mN", in_mN(gap, "unexplained_N"));
    fputs("</div>\n", to);
}

/* A row for each parameter; what is said of the effect as a whole stands in the first. */
static void effect_rows(FILE *to, const json_t *effect) {
    json_t *parameters = json_object_get(effect, "parameters"), *value;
    const json_t *intervals = json_object_get(effect, "intervals");
    const char *key, *id = report_text(effect, "id");
    char alike[LINE];
    bool first = true;
    names(json_object_get(effect, "class"), 1, alike);
    json_object_foreach(parameters, key, value) {
        const json_t *pair = json_object_get(intervals, key);
        double low = json_number_value(json_array_get(pair, 0)), high = json_number_value(json_array_get(pair, 1));
        int d = digits_after_point(0.5 * (high - low));
        html_row(to, "%s|~%s|%.*f|%.*f to %.*f|~%s", first ? report_effect(id) : "", key, d,
                 json_number_value(value), d, low, d, high, !first ? "" : alike[0] ? alike : "none");
        first = false;
    }
}

static void effects(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "effects");
    if (json_array_size(list) == 0) {
        return;
    }
    html_table(to, NULL, "effect that is missing|~parameter|value|95 % interval|~would do as well");
    for (size_t i = 0; i < json_array_size(list); i++) {
        effect_rows(to, json_array_get(list, i));
    }
    html_table_end(to);
}

/* ---- bars ---- */

static void bar(FILE *to, const char *label, double value, double most, const char *unit) {
    double width = most > 0 ? 260 * fmin(1, fmax(0, value / most)) : 0.0;
    fputs("<tr><td>", to);
    html_text(to, label);
    fprintf(to,
            "</td><td class=\"t\"><svg width=\"260\" height=\"12\"><rect width=\"%.1f\" height=\"12\" "
            "fill=\"#0072b2\"/></svg></td><td>%.3g %s</td></tr>\n",
            width, value, unit);
}

static void where(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "where"), *place;
    char label[LINE];
    double most = 0, rest = 100;
    if (json_array_size(list) == 0) {
        return;
    }
    html_table(to, "Where model and runs disagree", "experiment, phase|~|share of the gap");
    for (size_t i = 0; i < PLACES && (place = json_array_get(list, i)) != NULL; i++) {
        double share = 100 * report_number(place, "share");
        most = i ? most : share;
        rest -= share;
        snprintf(label, sizeof label, "%.200s, %.40s", report_base(report_text(place, "experiment")),
                 report_text(place, "phase"));
        char *under = strchr(strrchr(label, ','), '_'); /* early_hold */
        if (under) {
            *under = ' ';
        }
        bar(to, label, share, most, "%");
    }
    if (json_array_size(list) > PLACES) {
        bar(to, "elsewhere", fmax(rest, 0), most, "%");
    }
    html_table_end(to);
}

static void gap(FILE *to, const json_t *all) {
    static const char *const bars[][2] = {{"before_N", "as given, refitted"},
                                          {"after_N", "with the effects"},
                                          {"heldout_before_N", "as given, experiments left out"},
                                          {"heldout_after_N", "with the effects, experiments left out"},
                                          {"floor_N", "floor"}};
    const json_t *values = json_object_get(all, "gap");
    double most = fmax(in_mN(values, "heldout_before_N"), in_mN(values, "before_N"));
    html_table(to, "The gap before and after", "|~|rms");
    for (size_t i = 0; i < sizeof bars / sizeof bars[0]; i++) {
        bar(to, bars[i][1], in_mN(values, bars[i][0]), most, "mN");
    }
    html_table_end(to);
}

/* ---- suspects, and what to measure next ---- */

static void suspects(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "rejected"), *s;
    char blind[LINE];
    names(json_object_get(all, "not_identifiable"), 0, blind);
    fputs("<details><summary>Suspects that were not accepted</summary>\n", to);
    html_table(to, NULL, "effect|log likelihood gained alone (nats)|would explain, rms (mN)|~what became of it");
    for (size_t i = 0; (s = json_array_get(list, i)) != NULL; i++) {
        html_row(to, "%s|%.1f|%.3g|~%s", report_effect(report_text(s, "id")), report_number(s, "score"),
                 in_mN(s, "explained_N"), report_text(s, "reason"));
    }
    html_table_end(to);
    if (blind[0]) {
        fputs("<p>These runs cannot show: ", to);
        html_text(to, blind);
        fputs(".</p>\n", to);
    }
    fputs("</details>\n", to);
}

static void next(FILE *to, const json_t *all) {
    const json_t *next = json_object_get(all, "next_experiment"), *run = json_object_get(next, "run"),
                 *between = json_object_get(next, "between"), *note = json_object_get(next, "note");
    char text[LINE], rate[64] = "";
    if (json_is_object(run) && json_array_size(between) == 2) {
        if (json_object_get(run, "rate_mm_s")) {
            snprintf(rate, sizeof rate, " at %.3g mm/s", report_number(run, "rate_mm_s"));
        }
        snprintf(text, sizeof text, "Next: %s to %.3g mm%s would set %s and %s %.3g mN apart.", report_text(run, "kind"),
                 report_number(run, "depth_mm"), rate, effect_at(between, 0), effect_at(between, 1),
                 in_mN(next, "separation_N"));
        paragraph(to, text);
    }
    if (json_is_string(note)) {
        paragraph(to, json_string_value(note));
    }
}

void report_explained(FILE *to, const json_t *all) {
    paragraph(to, report_verdict(report_text(all, "verdict")));
    cards(to, all);
    effects(to, all);
    next(to, all);
    fputs("<div class=\"tables\">\n", to);
    where(to, all);
    gap(to, all);
    fputs("</div>\n", to);
    suspects(to, all);
}

void report_explanations(FILE *to, report *r) {
    const report_file *f;
    if (report_count(r, REPORT_EXPLAIN) == 0) {
        return;
    }
    html_section(to, "explain", "What the model misses");
    for (size_t i = 0; (f = report_find(r, REPORT_EXPLAIN, i)) != NULL; i++) {
        report_explained(to, f->json);
    }
    html_figure(to, r, "explain_residuals", REPORT_EXPLAIN_CAPTION);
}
