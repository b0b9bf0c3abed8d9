/* page_story.c: what palpate explain found, in sentences: the terminal prints them, and the page begins with
 * them. A number that is none, or that contradicts another, is not printed. */
#include "page.h"
#include "shared/digits.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static void add(page_story *story, const char *format, ...) {
    va_list arguments;
    if (story->n == PAGE_STORY)
        return;
    va_start(arguments, format);
    vsnprintf(story->line[story->n++], PAGE_LINE, format, arguments);
    va_end(arguments);
}

static bool is_verdict(const json_t *all, const char *name) {
    return strcmp(json_text_at(all, "verdict"), name) == 0;
}

bool page_one_recording(const json_t *all) {
    return json_array_size(json_object_get(json_object_get(all, "profile"), "experiments")) == 1;
}

double page_share(const json_t *object, const char *key) {
    return fmax(0, fmin(1, json_number_at(object, key)));
}

bool page_has_share(const json_t *object, const char *key) {
    return isfinite(json_number_at(object, key));
}

static void effect_names(const json_t *all, char line[PAGE_LINE]) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL && n < PAGE_LINE; i++)
        n += (size_t)snprintf(line + n, PAGE_LINE - n, "%s%s", i ? ", " : "",
                              page_effect(json_text_at(effect, "id")));
}

/* ---- the gap ---- */

static void add_gap(page_story *story, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    double before = json_number_at(gap, "heldout_before_N"), after = json_number_at(gap, "heldout_after_N"),
           noise = json_number_at(gap, "noise_level_N");
    char names[PAGE_LINE], from[32], to[32], alone[32];
    const char *where = page_one_recording(all) ? "" : " in experiments left out of the fit";
    effect_names(all, names);
    if (names[0])
        add(story, "The model as given lacks: %s.", names);
    if (!isfinite(before) || !isfinite(after) || !isfinite(noise)) {
        add(story, "How far the recordings and the model are apart could not be computed.");
        return;
    }
    page_force(before, from);
    page_force(after, to);
    page_force(noise, alone);
    if (names[0])
        add(story, "Once that is added, recorded minus model%s %s from %s, rms, to %s. Noise alone makes %s.",
            where, after <= before ? "falls" : "goes up", from, to, alone);
    else if (page_one_recording(all))
        add(story, "With its numbers refitted, recorded minus model is %s, rms. Noise alone makes %s.", to,
            alone);
    else
        add(story,
            "With its numbers refitted, recorded minus model%s is %s, rms, if all runs have one zero, "
            "contact and gain, and %s if each "
            "has its own. Noise alone makes %s.",
            where, from, to, alone);
}

static void add_rest(page_story *story, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    double rest = json_number_at(gap, "unexplained_N"), after = json_number_at(gap, "heldout_after_N"),
           noise = json_number_at(gap, "noise_level_N");
    bool some = json_array_size(json_object_get(all, "effects")) > 0, below = after <= noise,
         known = isfinite(rest) && rest > 0;
    char force[32];
    page_force(rest, force);
    if (is_verdict(all, "agrees") && known)
        add(story,
            "What is above that, %s, is less than two thirds of the noise level or the practical limit.",
            force);
    if (!is_verdict(all, "unexplained") && !is_verdict(all, "suspected"))
        return;
    if (known)
        add(story, "Beyond noise %s, rms, of structure remain%s.", force,
            below ? ": together with the noise no more than was expected of it, but of a shape that noise "
                    "has not"
                  : "");
    if (is_verdict(all, "suspected"))
        add(story,
            "An effect is named when a second experiment confirms it; until then its candidates are ranked.");
    else
        add(story, some ? "The effects named are there, but they are not all."
                        : "No effect is named: none closes enough of the gap to be more than a mimic.");
}

/* ---- what else differs ---- */

static void add_law(page_story *story, const json_t *all) {
    const json_t *law = json_object_get(all, "law");
    char before[32], after[32];
    if (!json_is_object(law))
        return;
    page_force(json_number_at(law, "gap_before_N"), before);
    page_force(json_number_at(law, "gap_after_N"), after);
    const bool driven = json_is_true(json_object_get(law, "better_quasi_linear")),
               others = driven != json_is_true(json_object_get(law, "given_quasi_linear")),
               same =
                   json_number_at(law, "better_coefficients") == json_number_at(law, "given_coefficients") &&
                   strcmp(json_text_at(law, "better"), json_text_at(law, "given")) == 0;
    if (others)
        add(story, "%s",
            driven ? "The arms are quasi-linear: the elastic force drives them, not the strain (Fung)."
                   : "The arms are linear: the strain drives them, not the elastic force.");
    if (!same)
        add(story,
            "The stiffness law is another one: a %s with %.0f coefficients in place of a %s with %.0f.",
            json_text_at(law, "better"), json_number_at(law, "better_coefficients"),
            json_text_at(law, "given"), json_number_at(law, "given_coefficients"));
    add(story, "The %s would leave %s, rms, this one leaves %s.", others ? "given material" : "given law",
        before, after);
}

static bool has_scatter(const json_t *all, const char *id) {
    const json_t *list = json_object_get(all, "scatter"), *one;
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL; i++)
        if (strcmp(json_text_at(one, "id"), id) == 0)
            return true;
    return false;
}

static void add_scatter(page_story *story, const json_t *all) {
    static const struct {
        const char *id, *what, *key, *unit;
        double per;
    } kinds[] = {{"zero_scatter", "zeros of the runs", "sd_N", "N", 1},
                 {"contact_scatter", "contacts of the runs", "sd_mm", "mm", 1},
                 {"gain_scatter", "gains of the runs", "sd_share", "%", 100},
                 {"specimen_stiffness", "stiffnesses of the specimens", "sd_share", "%", 100}};
    const json_t *list = json_object_get(all, "scatter"), *one;
    char before[32], after[32];
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL; i++)
        for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
            double sd = kinds[k].per * json_number_at(one, kinds[k].key);
            if (strcmp(json_text_at(one, "id"), kinds[k].id) != 0 || !isfinite(sd))
                continue;
            page_force(json_number_at(one, "gap_before_N"), before);
            page_force(json_number_at(one, "gap_after_N"), after);
            add(story,
                "The %s differ by %.3g %s (standard deviation): without that %s, rms, would be left, not %s.",
                kinds[k].what, sd, kinds[k].unit, before, after);
        }
}

/* "a could as well be b, c" of each effect that is not alone in its class. */
static void add_classes(page_story *story, const json_t *all) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    char alike[PAGE_LINE];
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL; i++) {
        page_names(json_object_get(effect, "class"), 1, " or ", alike);
        if (alike[0])
            add(story, "What is called %s here could as well be %s: these runs cannot tell.",
                page_effect(json_text_at(effect, "id")), alike);
    }
}

void page_story_tell(const json_t *all, page_story *story) {
    bool law_alone = is_verdict(all, "explained") && json_array_size(json_object_get(all, "effects")) == 0;
    bool specimens = has_scatter(all, "specimen_stiffness") && !json_is_object(json_object_get(all, "law"));
    story->n = 0;
    add(story, "%s",
        law_alone ? specimens ? "With a stiffness of each specimen what remains is at the noise level: no "
                                "effect is missing."
                              : "With another law of the material what remains is at the noise level: no "
                                "effect is missing."
                  : page_verdict(json_text_at(all, "verdict"),
                                 json_number_at(json_object_get(all, "gap"), "unexplained_N")));
    if (json_is_true(json_object_get(all, "stopped")))
        add(story, "The search was stopped early: effects may be missing that were not tried.");
    add_gap(story, all);
    add_law(story, all);
    add_scatter(story, all);
    add_rest(story, all);
    add_classes(story, all);
}

/* ---- on the terminal ---- */

static void say_effect(FILE *to, const json_t *effect) {
    const json_t *value;
    const char *key;
    fprintf(to, "  %s:", json_text_at(effect, "id"));
    json_object_foreach(json_object_get(effect, "parameters"), key, value) {
        const json_t *pair = json_object_get(json_object_get(effect, "intervals"), key),
                     *low = json_array_get(pair, 0), *high = json_array_get(pair, 1);
        if (json_is_number(value))
            fprintf(to, " %s %.4g", key, json_number_value(value));
        if (json_is_number(low) && json_is_number(high) && json_number_value(low) <= json_number_value(high))
            fprintf(to, " (%.4g to %.4g)", json_number_value(low), json_number_value(high));
        fputc(',', to);
    }
    if (isfinite(json_number_at(effect, "evidence")))
        fprintf(to, " evidence %.3g nats,", json_number_at(effect, "evidence"));
    if (page_has_share(effect, "gap_closed"))
        fprintf(to, " closes %.0f %% of the gap", 100 * page_share(effect, "gap_closed"));
    else
        fputs(" share of the gap not known", to);
    if (json_is_true(json_object_get(effect, "recovers")))
        fputs(", gone before the next run of the session", to);
    fputc('\n', to);
}

const json_t *page_candidate(const json_t *all, const json_t *last) {
    const json_t *list = json_object_get(all, "rejected"), *one, *best = NULL;
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL; i++) {
        double score = json_number_at(one, "score");
        bool next = isfinite(score) && score > 0 && (!last || score < json_number_at(last, "score"));
        if (next && (!best || score > json_number_at(best, "score")))
            best = one;
    }
    return best;
}

static void say_candidates(FILE *to, const json_t *all) {
    const json_t *one = page_candidate(all, NULL);
    for (int n = 0; n < PAGE_CANDIDATES && one; n++, one = page_candidate(all, one))
        fprintf(to, "candidate %s: evidence %.3g nats; not taken: %s\n", json_text_at(one, "id"),
                json_number_at(one, "score"), json_text_at(one, "reason"));
}

void explain_say(FILE *to, const json_t *all) {
    page_story story;
    char next[2 * PAGE_LINE];
    page_story_tell(all, &story);
    fprintf(to, "%s: %s\n", json_text_at(all, "verdict"), story.line[0]);
    for (size_t i = 1; i < story.n; i++)
        fprintf(to, "%s\n", story.line[i]);
    for (size_t i = 0; i < json_array_size(json_object_get(all, "effects")); i++)
        say_effect(to, json_array_get(json_object_get(all, "effects"), i));
    say_candidates(to, all);
    page_next_text(all, next);
    fprintf(to, "next: %s\n", next);
}
