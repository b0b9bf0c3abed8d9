/* explain_words.c: the result of palpate explain in sentences, for the terminal and for the page. A number
 * that is missing, or that contradicts another, is not printed. */
#include "explain.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

enum { LINE = 512, CANDIDATES_SAID = 3 };

static const char *effect_name(const char *id) {
    palp_effect_id found;
    return palp_effect_parse(id, &found) ? id : palp_effect_look_up(found)->name;
}

static const char *verdict_sentence(const char *verdict, double unexplained_N) {
    static const char *const text[][2] = {
        {"agrees", "Nothing is missing that these runs could show."},
        {"explained", "With the effects below, what remains is at the noise level."},
        {"ambiguous", "The effects below close the gap, but others fit as well; they are named with each."},
        {"suspected",
         "An effect may be missing: these recordings suggest candidates, which others would have "
         "to confirm."},
        {"unexplained", "Something is missing that no effect of the catalogue describes."},
        {"another_law", "No effect is missing, but the material follows another law than the given one."},
    };
    if (strcmp(verdict, "agrees") == 0 && unexplained_N > 0)
        return "The residual exceeds the noise, but is below the practical limit.";
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++)
        if (strcmp(verdict, text[i][0]) == 0)
            return text[i][1];
    return verdict;
}

static const char *force_text(double force_N, char text[32]) {
    static const struct {
        const char *unit;
        double size;
    } units[] = {{"N", 1}, {"mN", 1e-3}, {"\u00b5N", 1e-6}, {"nN", 1e-9}, {"pN", 1e-12}};
    size_t k = force_N == 0; /* 0 mN */
    while (k + 1 < sizeof units / sizeof *units && force_N != 0 && fabs(force_N) < 0.9995 * units[k].size)
        k++;
    if (isfinite(force_N))
        snprintf(text, 32, "%.3g %s", force_N / units[k].size, units[k].unit);
    else
        strcpy(text, "-");
    return text;
}

static void name_list(const json_t *ids, size_t from, const char *between, char line[LINE]) {
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = from; i < json_array_size(ids) && n < LINE; i++) {
        const char *id = json_string_value(json_array_get(ids, i));
        n +=
            (size_t)snprintf(line + n, LINE - n, "%s%s", i > from ? between : "", id ? effect_name(id) : "-");
    }
}

static void add(json_t *story, const char *format, ...) {
    char line[LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    json_array_append_new(story, json_text(line));
}

static bool is_verdict(const json_t *all, const char *name) {
    return strcmp(json_text_at(all, "verdict"), name) == 0;
}

static bool one_recording(const json_t *all) {
    return json_array_size(json_object_get(json_object_get(all, "profile"), "experiments")) == 1;
}

static void effect_names(const json_t *all, char line[LINE]) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL && n < LINE; i++)
        n += (size_t)snprintf(line + n, LINE - n, "%s%s", i ? ", " : "",
                              effect_name(json_text_at(effect, "id")));
}

/* ---- the gap ---- */

static bool is_simulated(const json_t *all) {
    return json_is_object(json_object_get(all, "simulated"));
}

static void add_gap(json_t *story, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    double before = json_number_at(gap, "heldout_before_N"), after = json_number_at(gap, "heldout_after_N"),
           noise = json_number_at(gap, "noise_level_N");
    char names[LINE], from[32], to[32], alone[32];
    const char *where = one_recording(all) ? "" : " in experiments left out of the fit";
    const char *whose = is_simulated(all) ? "simulation" : "model",
               *fitted = is_simulated(all) ? "As it is" : "With its numbers refitted";
    effect_names(all, names);
    if (names[0])
        add(story, is_simulated(all) ? "The simulation lacks: %s." : "The model as given lacks: %s.", names);
    if (!isfinite(before) || !isfinite(after) || !isfinite(noise)) {
        add(story, "How far the recordings and the model are apart could not be computed.");
        return;
    }
    force_text(before, from);
    force_text(after, to);
    force_text(noise, alone);
    if (names[0])
        add(story, "Once that is added, recorded minus %s%s %s from %s, rms, to %s. Noise alone makes %s.",
            whose, where, after <= before ? "falls" : "goes up", from, to, alone);
    else if (one_recording(all))
        add(story, "%s, recorded minus %s is %s, rms. Noise alone makes %s.", fitted, whose, to, alone);
    else
        add(story,
            "%s, recorded minus %s%s is %s, rms, if all runs have one zero, "
            "contact and gain, and %s if each "
            "has its own. Noise alone makes %s.",
            fitted, whose, where, from, to, alone);
}

static void add_rest(json_t *story, const json_t *all) {
    const json_t *gap = json_object_get(all, "gap");
    double rest = json_number_at(gap, "unexplained_N"), after = json_number_at(gap, "heldout_after_N"),
           noise = json_number_at(gap, "noise_level_N");
    bool some = json_array_size(json_object_get(all, "effects")) > 0, below = after <= noise,
         known = isfinite(rest) && rest > 0;
    char force[32];
    force_text(rest, force);
    if (is_verdict(all, "agrees") && known)
        add(story,
            "The residual above that, %s, is less than two thirds of the noise level or the practical limit.",
            force);
    if (!is_verdict(all, "unexplained") && !is_verdict(all, "suspected"))
        return;
    if (known)
        add(story, "Beyond the noise a residual of %s, rms, remains%s.", force,
            below ? ": its size is that of noise, but not its shape" : "");
    if (is_verdict(all, "suspected"))
        add(story,
            "An effect is named when other experiments confirm it; until then its candidates are ranked.");
    else
        add(story, some ? "The effects named are there, but they are not all."
                        : "No effect is named: none is clearly more probable than an unknown cause.");
}

/* The lumped model of the simulation, and another cause of a gain. */
static void add_simulated(json_t *story, const json_t *all) {
    const json_t *simulated = json_object_get(all, "simulated"), *list = json_object_get(all, "effects"),
                 *one;
    char force[32];
    if (!json_is_object(simulated))
        return;
    add(story,
        "The lumped model, which gives the change of the simulated force with the effects, is off by %s, "
        "rms. "
        "This difference is taken from the simulation.",
        force_text(json_number_at(simulated, "lumped_off_N"), force));
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL; i++)
        if (strcmp(json_text_at(one, "id"), "sensor_gain") == 0)
            add(story,
                "A simulated specimen that is too soft or too stiff by that factor looks like the gain.");
}

/* The largest part of the discrepancy, by the variable that it depends on. */
static void add_discrepancy(json_t *story, const json_t *all) {
    static const char *const words[][2] = {{"depth_loading", "the depth on the way in"},
                                           {"depth_unloading", "the depth on the way out"},
                                           {"time_in_dwell", "the time in a dwell"},
                                           {"time_in_run", "the time in the run"}};
    const json_t *found = json_object_get(all, "discrepancy"), *parts = json_object_get(found, "parts"), *one,
                 *most = NULL;
    char force[32];
    if (!json_is_true(json_object_get(found, "found")))
        return;
    for (size_t i = 0; (one = json_array_get(parts, i)) != NULL; i++)
        if (!most || json_number_at(one, "share") > json_number_at(most, "share"))
            most = one;
    for (size_t i = 0; most && i < sizeof words / sizeof *words; i++)
        if (strcmp(json_text_at(most, "depends_on"), words[i][0]) == 0)
            add(story, "Most of it depends on %s: %s, rms, %.0f %% of the squared residual.", words[i][1],
                force_text(json_number_at(most, "rms_N"), force), 100 * json_number_at(most, "share"));
}

/* ---- what else differs ---- */

static void add_law(json_t *story, const json_t *all) {
    const json_t *law = json_object_get(all, "law");
    char before[32], after[32];
    if (!json_is_object(law))
        return;
    force_text(json_number_at(law, "gap_before_N"), before);
    force_text(json_number_at(law, "gap_after_N"), after);
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

static void add_scatter(json_t *story, const json_t *all) {
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
            force_text(json_number_at(one, "gap_before_N"), before);
            force_text(json_number_at(one, "gap_after_N"), after);
            add(story,
                "The %s differ by %.3g %s (standard deviation). Without that the residual would be %s, rms, "
                "not %s.",
                kinds[k].what, sd, kinds[k].unit, before, after);
        }
}

/* "a could as well be b, c" of each effect that is not alone in its class. */
static void add_classes(json_t *story, const json_t *all) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    char alike[LINE];
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL; i++) {
        name_list(json_object_get(effect, "class"), 1, " or ", alike);
        if (alike[0])
            add(story, "The effect named %s could as well be %s: these runs do not separate them.",
                effect_name(json_text_at(effect, "id")), alike);
    }
}

/* ---- what was pressed ---- */

/* The runs of which this was found, or declared by their files; in one sentence that begins as said. */
static bool add_pressed(json_t *story, const json_t *all, const char *object, bool declared,
                        const char *begin) {
    const json_t *list = json_object_get(all, "pressed"), *one;
    char names[LINE] = "";
    size_t n = 0;
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL && n < LINE; i++)
        if (strcmp(json_text_at(one, "object"), object) == 0 &&
            json_is_true(json_object_get(one, "declared")) == declared)
            n += (size_t)snprintf(names + n, LINE - n, "%s%s", n ? ", " : "",
                                  cli_base(json_text_at(one, "experiment")));
    if (n > 0)
        add(story, "%s: %.400s.", begin, names);
    return n > 0;
}

static void add_objects(json_t *story, const json_t *all) {
    add_pressed(story, all, "air", true, "In air, as the file says");
    add_pressed(story, all, "block", true, "On a rigid block, as the file says");
    add_pressed(story, all, "block", false, "Taken for a rigid block, by force and travel");
    if (add_pressed(story, all, "air", false, "Taken for a run in air, as it has almost no force"))
        add(story,
            "No file declares it. With a specimen under the plate it would be a dead sensor: leave the "
            "run out then.");
}

static json_t *tell(const json_t *all) {
    json_t *story = json_array();
    bool law_alone = is_verdict(all, "explained") && json_array_size(json_object_get(all, "effects")) == 0;
    bool specimens = has_scatter(all, "specimen_stiffness") && !json_is_object(json_object_get(all, "law"));
    add(story, "%s",
        law_alone ? specimens ? "With a stiffness of each specimen what remains is at the noise level: no "
                                "effect is missing."
                              : "With another law of the material what remains is at the noise level: no "
                                "effect is missing."
                  : verdict_sentence(json_text_at(all, "verdict"),
                                     json_number_at(json_object_get(all, "gap"), "unexplained_N")));
    if (json_is_true(json_object_get(all, "stopped")))
        add(story, "The search was stopped early: effects may be missing that were not tried.");
    add_objects(story, all);
    add_gap(story, all);
    add_simulated(story, all);
    add_law(story, all);
    add_scatter(story, all);
    add_rest(story, all);
    add_discrepancy(story, all);
    explain_free_say(story, all);
    add_classes(story, all);
    return story;
}

/* ---- what to measure next ---- */

static void kind_words(const json_t *run, char text[LINE]) {
    const char *kind = json_text_at(run, "kind");
    double depth = json_number_at(run, "depth_mm"), rate = json_number_at(run, "rate_mm_s"),
           hold = json_number_at(run, "hold_s"), cycles = json_number_at(run, "cycles");
    if (strcmp(kind, "ramp_hold") == 0)
        snprintf(text, LINE, "a ramp to %.3g mm at %.3g mm/s, held for %.3g s", depth, rate, hold);
    else if (strcmp(kind, "cyclic") == 0 && cycles < 2)
        snprintf(text, LINE, "a press to %.3g mm at %.3g mm/s, and back as fast", depth, rate);
    else if (strcmp(kind, "cyclic") == 0)
        snprintf(text, LINE, "%.0f cycles to %.3g mm at %.3g mm/s", cycles, depth, rate);
    else if (strcmp(kind, "free") == 0)
        snprintf(text, LINE, "a stroke of %.3g mm in the air at %.3g mm/s", depth, rate);
    else
        snprintf(text, LINE, "%.100s to %.3g mm", kind, depth);
}

/* Where most is left. */
static void repeat_words(const json_t *all, char text[2 * LINE]) {
    const json_t *runs = json_object_get(json_object_get(all, "profile"), "experiments"), *run, *worst = NULL;
    char force[32];
    for (size_t i = 0; (run = json_array_get(runs, i)) != NULL; i++)
        if (!worst || json_number_at(run, "after_N") > json_number_at(worst, "after_N"))
            worst = run;
    if (json_array_size(runs) == 1)
        snprintf(
            text, 2 * LINE,
            "Press again the same way, and once more at another depth and speed: only a systematic residual "
            "comes back.");
    else
        snprintf(
            text, 2 * LINE,
            "No experiment can be designed for an unknown cause. Repeat %s, which has the largest residual "
            "(%s rms): only a systematic one comes back.",
            worst ? cli_base(json_text_at(worst, "experiment")) : "an experiment",
            force_text(worst ? json_number_at(worst, "after_N") : NAN, force));
}

/* All runs of the next experiment. */
static void runs_words(const json_t *runs, char text[2 * LINE]) {
    char one[LINE];
    size_t at = 0;
    text[0] = '\0';
    for (size_t i = 0; i < json_array_size(runs) && at < 2 * LINE; i++) {
        kind_words(json_array_get(runs, i), one);
        at += (size_t)snprintf(text + at, 2 * LINE - at, "%s%.160s", i ? "; then " : "", one);
    }
}

static void next_text(const json_t *all, char text[4 * LINE]) {
    const json_t *next = json_object_get(all, "next_experiment"), *runs = json_object_get(next, "runs");
    const char *verdict = json_text_at(all, "verdict");
    char what[2 * LINE], both[LINE], apart[32], noise[32];
    name_list(json_object_get(next, "between"), 0, " and ", both);
    if (json_array_size(runs) > 0) {
        runs_words(runs, what);
        snprintf(
            text, 4 * LINE,
            "Measure %.500s. Both %.200s fit the present runs. In the first new run the forces that they "
            "predict differ by %s, rms, after a fit of zero and gain (the noise level is %s).",
            what, both, force_text(json_number_at(next, "separation_N"), apart),
            force_text(json_number_at(json_object_get(all, "gap"), "noise_level_N"), noise));
    } else if (json_is_object(next)) {
        snprintf(text, 2 * LINE, "No run within the allowed time, depth and speed separates %s.", both);
    } else if (strcmp(verdict, "unexplained") == 0 || strcmp(verdict, "suspected") == 0) {
        repeat_words(all, text);
    } else {
        snprintf(text, 2 * LINE, "There are no look-alikes to separate.%s",
                 json_array_size(json_object_get(all, "not_identifiable")) > 0
                     ? " The page and the result list what these runs cannot show."
                     : "");
    }
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
    double closed = json_number_at(effect, "gap_closed");
    if (isfinite(closed))
        fprintf(to, " closes %.0f %% of the gap", 100 * fmax(0, fmin(1, closed)));
    else
        fputs(" share of the gap not known", to);
    if (json_is_true(json_object_get(effect, "recovers")))
        fputs(", gone before the next run of the session", to);
    fputc('\n', to);
}

/* The rejected candidate with the next smaller positive gain after last, or NULL; last NULL: the one with the
 * largest. */
static const json_t *candidate_after(const json_t *all, const json_t *last) {
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
    const json_t *one = candidate_after(all, NULL);
    for (int n = 0; n < CANDIDATES_SAID && one; n++, one = candidate_after(all, one))
        fprintf(to, "candidate %s: evidence %.3g nats; not taken: %s\n", json_text_at(one, "id"),
                json_number_at(one, "score"), json_text_at(one, "reason"));
}

void explain_say(FILE *to, const json_t *all) {
    const json_t *story = json_object_get(all, "sentences");
    fprintf(to, "%s: ", json_text_at(all, "verdict"));
    for (size_t i = 0; i < json_array_size(story); i++)
        fprintf(to, "%s\n", json_string_value(json_array_get(story, i)));
    for (size_t i = 0; i < json_array_size(json_object_get(all, "effects")); i++)
        say_effect(to, json_array_get(json_object_get(all, "effects"), i));
    say_candidates(to, all);
    fprintf(to, "next: %s\n", json_text_at(all, "next_sentence"));
}

/* ---- in the result ---- */

void explain_add_words(json_t *all) {
    json_t *names = json_object();
    char next[4 * LINE];
    next_text(all, next);
    json_object_set_new(all, "sentences", tell(all));
    json_object_set_new(all, "next_sentence", json_text(next));
    for (int id = 0; id < PALP_EFFECT_COUNT; id++) {
        const palp_effect_info *effect = palp_effect_look_up((palp_effect_id)id);
        json_object_set_new(names, effect->id,
                            json_pack("{s:s, s:s}", "name", effect->name, "means", effect->means));
    }
    json_object_set_new(all, "catalogue", names);
}
