/* report_words.c: what palpate explain found, in words: effects, their parameters, phases, forces. */
#include "report_explain.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* What an effect does, in the order of the catalogue. */
static const char *const effects[PALP_EFFECT_COUNT] = {
    "The specimen relaxes with one more relaxation time.",
    "The specimen relaxes over many decades of time, as a power of it.",
    "How stiff the arms are, or how fast they relax, depends on strain.",
    "The specimen's spring is stiffer the faster the plate moves.",
    "Once pressed, the specimen is softer on the way back and the next time, up to the depth it has seen.",
    "Once pressed, the specimen does not come back to its full height.",
    "Liquid is pressed out of pores; the force falls as it drains.",
    "The surface is not where depth 0 was said to be.",
    "The surface is uneven: the force begins more softly than the law says.",
    "The specimen sticks to the plate, which pulls it on withdrawal until it lets go.",
    "The specimen slides sideways at the plates.",
    "The specimen grows stiffer or softer during the session.",
    "The frame gives way under load: the specimen is pressed less deep than the encoder says.",
    "The plate's own mass adds a force wherever it speeds up or slows down.",
    "Something rubs: a constant force against the motion, in air too.",
    "The force sensor is late, as behind a low-pass filter of this time.",
    "The force sensor has a zero that is off by the same in all runs.",
    "The zero of the force sensor moves at a constant rate during a run.",
    "The force sensor reads too much or too little by a factor.",
    "The force sensor's range ends: it does not read beyond this force.",
    "The mains are heard in the force.",
    "The force has a wave that repeats with position, as from a screw or gear, in air too.",
};

const char *report_effect(const char *id) {
    palp_effect_id found;
    return palp_effect_by_name(id, &found) ? id : palp_effect_look_up(found)->name;
}

const char *report_effect_means(const char *id) {
    palp_effect_id found;
    return palp_effect_by_name(id, &found) ? "" : effects[found];
}

const char *report_effect_seen_by(const char *id) {
    palp_effect_id found;
    return palp_effect_by_name(id, &found) ? "-" : palp_effect_look_up(found)->seen_by;
}

const char *report_verdict(const char *verdict) {
    static const char *const text[][2] = {
        {"agrees", "Nothing is missing that these runs could show."},
        {"explained", "With the effects below, what remains is at the noise level."},
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

static void spaces(char *text) {
    for (; *text; text++) {
        *text = *text == '_' ? ' ' : *text;
    }
}

/* "force_N_s": "force", "N/s". */
void report_parameter(const char *key, char name[48], char unit[16]) {
    static const char *const units[][2] = {{"_mm_N", "mm/N"}, {"_N_s", "N/s"}, {"_mm", "mm"}, {"_Hz", "Hz"},
                                           {"_kg", "kg"},     {"_rad", "rad"}, {"_N", "N"},   {"_s", "s"}};
    size_t length = strlen(key);
    snprintf(name, 48, "%s", key);
    unit[0] = '\0';
    for (size_t i = 0; i < sizeof units / sizeof units[0] && !unit[0]; i++) {
        size_t n = strlen(units[i][0]);
        if (length > n && length < 48 && strcmp(key + length - n, units[i][0]) == 0) {
            name[length - n] = '\0';
            strcpy(unit, units[i][1]);
        }
    }
    spaces(name);
}

void report_phase(const char *id, char text[32]) {
    bool early = strcmp(id, "early_hold") == 0, late = strcmp(id, "late_hold") == 0;
    snprintf(text, 32, "%s", early ? "hold, first 5 s" : late ? "hold, later" : id);
    spaces(text);
}

const char *report_force(double force_N, char text[32]) {
    double size = fabs(force_N);
    bool newtons = size >= 0.9995, milli = newtons || size >= 9.995e-4 || size == 0;
    if (isfinite(force_N)) {
        snprintf(text, 32, "%.3g %s", newtons ? force_N : milli ? 1e3 * force_N : 1e6 * force_N,
                 newtons ? "N" : milli ? "mN" : "\u00b5N");
    } else {
        strcpy(text, "-");
    }
    return text;
}

void report_names(const json_t *ids, size_t from, const char *between, char line[REPORT_LINE]) {
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = from; i < json_array_size(ids) && n < REPORT_LINE; i++) {
        const char *id = json_string_value(json_array_get(ids, i));
        n += (size_t)snprintf(line + n, REPORT_LINE - n, "%s%s", i > from ? between : "", id ? report_effect(id) : "-");
    }
}

void report_paragraph(FILE *to, const char *format, ...) {
    char text[4 * REPORT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fputs("<p>", to);
    html_text(to, text);
    fputs("</p>\n", to);
}
