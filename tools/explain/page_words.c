/* page_words.c: what palpate explain found, in words: effects, their parameters, phases, forces. */
#include "page.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

const char *page_effect(const char *id) {
    palp_effect_id found;
    return palp_effect_parse(id, &found) ? id : palp_effect_look_up(found)->name;
}

const char *page_effect_means(const char *id) {
    palp_effect_id found;
    return palp_effect_parse(id, &found) ? "" : palp_effect_look_up(found)->means;
}

const char *page_effect_seen_by(const char *id) {
    palp_effect_id found;
    return palp_effect_parse(id, &found) ? "-" : palp_effect_look_up(found)->seen_by;
}

const char *page_verdict(const char *verdict, double unexplained_N) {
    static const char *const text[][2] = {
        {"agrees", "Nothing is missing that these runs could show."},
        {"explained", "With the effects below, what remains is at the noise level."},
        {"ambiguous",
         "The effects below close the gap, but others would do as well; they are named with each."},
        {"suspected", "Something is missing; this recording suggests candidates, and a second one would have "
                      "to confirm them."},
        {"unexplained", "Something is missing that no effect of the catalogue accounts for."},
    };
    if (strcmp(verdict, "agrees") == 0 && unexplained_N > 0)
        return "What is left is more than noise, but below the practical limit.";
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++)
        if (strcmp(verdict, text[i][0]) == 0)
            return text[i][1];
    return verdict;
}

static void spaces(char *text) {
    for (; *text; text++)
        *text = *text == '_' ? ' ' : *text;
}

static bool is_unit(const char *word) {
    static const char *const units[] = {"mm", "um", "N", "s", "Hz", "kg", "rad", "K"};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (strcmp(word, units[i]) == 0)
            return true;
    return false;
}

/* "force_N_s": "force", "N/s". */
void page_parameter(const char *key, char name[48], char unit[16]) {
    char last[2][8] = {"", ""};
    snprintf(name, 48, "%s", key);
    for (int i = 0; i < 2; i++) {
        char *word = strrchr(name, '_');
        if (!word || !is_unit(word + 1))
            break;
        snprintf(last[i], sizeof last[i], "%s", word + 1);
        *word = '\0';
    }
    snprintf(unit, 16, "%s%s%s", last[1], last[1][0] ? "/" : "", last[0]);
    spaces(name);
}

void page_phase(const char *id, char text[32]) {
    bool early = strcmp(id, "early_dwell") == 0, late = strcmp(id, "late_dwell") == 0;
    snprintf(text, 32, "%s", early ? "dwell, early" : late ? "dwell, late" : id);
    spaces(text);
}

const char *page_force(double force_N, char text[32]) {
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

void page_names(const json_t *ids, size_t from, const char *between, char line[PAGE_LINE]) {
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = from; i < json_array_size(ids) && n < PAGE_LINE; i++) {
        const char *id = json_string_value(json_array_get(ids, i));
        n += (size_t)snprintf(line + n, PAGE_LINE - n, "%s%s", i > from ? between : "",
                              id ? page_effect(id) : "-");
    }
}

void page_paragraph(FILE *to, const char *format, ...) {
    char text[4 * PAGE_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fputs("<p>", to);
    html_text(to, text);
    fputs("</p>\n", to);
}
