/* page_search.c: the candidates, their scores and what became of them, step by step. */
#include "page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TOP = 7, CANDIDATES = PALP_EFFECT_COUNT + 1 };

typedef struct candidate {
    const char *id, *reason; /* reason NULL: taken */
    double score, explained;
} candidate;

static int by_score(const void *a, const void *b) {
    const candidate *p = a, *q = b;
    return p->score < q->score ? 1 : p->score > q->score ? -1 : strcmp(p->id, q->id);
}

/* The one taken first, then by score. */
static size_t collect(const json_t *step, candidate list[CANDIDATES]) {
    const json_t *rejected = json_object_get(step, "rejected"), *s, *taken = json_object_get(step, "taken");
    size_t n = 0, first;
    if (json_is_string(taken))
        list[n++] = (candidate){json_string_value(taken), NULL, json_number_at(step, "score"),
                                json_number_at(step, "explained_N")};
    first = n;
    for (size_t i = 0; (s = json_array_get(rejected, i)) != NULL && n < CANDIDATES; i++)
        list[n++] = (candidate){json_text_at(s, "id"), json_text_at(s, "reason"), json_number_at(s, "score"),
                                json_number_at(s, "explained_N")};
    qsort(list + first, n - first, sizeof *list, by_score);
    return n;
}

static double best_of_all(const json_t *steps) {
    candidate list[CANDIDATES];
    const json_t *step;
    double best = 100;
    for (size_t i = 0; (step = json_array_get(steps, i)) != NULL; i++)
        for (size_t k = collect(step, list); k-- > 0;)
            best = fmax(best, list[k].score);
    return best;
}

static void candidate_row(FILE *to, const candidate *s, double best, double threshold) {
    char force[32];
    fprintf(to, "<tr%s><td>", s->reason ? "" : " class=\"taken\"");
    html_text(to, page_effect(s->id));
    fputs("</td>", to);
    html_bars(to, s->score > 1 ? fmin(1, log(s->score) / log(best)) : NAN, NAN,
              fmax(0, fmin(1, log(threshold) / log(best))));
    if (isfinite(s->score))
        fprintf(to, "<td>%.*f</td>", fabs(s->score) < 9.95 ? 1 : 0, s->score);
    else
        fputs("<td>-</td>", to);
    fprintf(to, "<td>%s</td><td class=\"t\">", s->explained > 0 ? page_force(s->explained, force) : "-");
    html_text(to, s->reason ? s->reason : "added");
    fputs("</td></tr>\n", to);
}

static void rows(FILE *to, const candidate *list, size_t n, double best, double threshold) {
    html_table(to, NULL,
               "candidate|~score, on a logarithmic scale|score|would explain, rms|~what became of it");
    for (size_t i = 0; i < n; i++)
        candidate_row(to, &list[i], best, threshold);
    html_table_end(to);
}

/* Those that score first; the others behind a fold. */
static void step_section(FILE *to, const json_t *step, size_t number, const char *beside, double best,
                         double threshold) {
    candidate list[CANDIDATES];
    size_t n = collect(step, list), shown = 0;
    while (shown < n && shown < TOP && (list[shown].score > 0 || !list[shown].reason))
        shown++;
    fprintf(to, "<h4>Step %zu: beside ", number);
    html_text(to, beside);
    fputs("</h4>\n", to);
    if (!json_is_string(json_object_get(step, "taken")))
        page_paragraph(to, "No candidate was accepted: the search ends here.");
    if (shown > 0)
        rows(to, list, shown, best, threshold);
    if (n > shown) {
        fprintf(to, "<details><summary>%s %zu</summary>\n", shown ? "The other" : "All", n - shown);
        rows(to, list + shown, n - shown, best, threshold);
        fputs("</details>\n", to);
    }
}

static bool is_effect(const json_t *all, const char *id) {
    const json_t *list = json_object_get(all, "effects"), *effect;
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL; i++)
        if (strcmp(id, json_text_at(effect, "id")) == 0)
            return true;
    return false;
}

/* Those added in a step and not kept: why. */
static void taken_back(FILE *to, const json_t *all) {
    const json_t *steps = json_object_get(all, "steps"), *rejected = json_object_get(all, "rejected"), *step,
                 *s;
    for (size_t i = 0; (step = json_array_get(steps, i)) != NULL; i++) {
        const char *id = json_text_at(step, "taken");
        for (size_t k = 0; !is_effect(all, id) && (s = json_array_get(rejected, k)) != NULL; k++)
            if (strcmp(id, json_text_at(s, "id")) == 0)
                page_paragraph(to, "Taken out again: %s. It %s.", page_effect(id), json_text_at(s, "reason"));
    }
}

static void blind(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "not_identifiable");
    if (json_array_size(list) == 0)
        return;
    page_paragraph(to, "What an effect does is compared with all that a stiffness law, arms, and the runs' "
                       "own contacts, zeros and gains could do "
                       "in these runs. Of which less than a twentieth is left, a law that is a little wrong "
                       "would look the same: it is not named.");
    html_table(to, "What these runs cannot show, whether it is there or not",
               "effect|~why, and what an experiment needs to show it");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *one = json_array_get(list, i);
        bool bare = json_is_string(one); /* as results were written before */
        const char *id = bare ? json_string_value(one) : json_text_at(one, "id");
        html_row(to, "%s|~%s", page_effect(id), bare ? page_effect_seen_by(id) : json_text_at(one, "reason"));
    }
    html_table_end(to);
}

void page_search(FILE *to, const json_t *all) {
    const json_t *steps = json_object_get(all, "steps"), *step;
    double best = best_of_all(steps), threshold = json_number_at(all, "null_threshold");
    char beside[PAGE_LINE] = "the model as given", chance[32] = "";
    if (isfinite(threshold))
        snprintf(chance, sizeof chance, " (%.2g)", threshold);
    fputs("<h3>The candidates and their scores</h3>\n<div class=\"candidates\">\n", to);
    page_paragraph(
        to,
        "Each effect of the catalogue was added to the model and refitted with everything else over all "
        "experiments at once. The score is the natural logarithm of how many times more likely it makes the "
        "recordings, less a price for its parameters; the dashed line is what the best of all candidates "
        "gains by "
        "chance%s. The best one that also "
        "predicts experiments left out of the fit and changes the forces by enough is added, and the others "
        "are tried again beside it.",
        chance);
    for (size_t i = 0; (step = json_array_get(steps, i)) != NULL; i++) {
        step_section(to, step, i + 1, beside, best, threshold);
        size_t n = strlen(beside);
        snprintf(beside + n, sizeof beside - n, "%s%s", i ? ", " : " with ",
                 page_effect(json_text_at(step, "taken")));
    }
    fputs("</div>\n", to);
    taken_back(to, all);
    blind(to, all);
}
