/* explain_page.c: what was found, in lines, as a page, and as files for palpate report. */
#include "explain.h"
#include "shared/json_out.h"
#include "page.h"

#include <stdlib.h>

static const char NAME[] = "explain";

enum { ROW = 512 };

/* ---- words ---- */

static void effect_text(const palp_explain_effect *f, char text[ROW]) {
    const palp_effect_info *info = palp_effect_look_up(f->effect.id);
    int n = snprintf(text, ROW, "%s", info->id);
    for (size_t k = 0; k < info->n_parameters && n < ROW; k++) {
        const palp_effect_parameter *p = &info->parameter[k];
        n += snprintf(text + n, (size_t)(ROW - n), "%s %s %.4g (%.4g to %.4g)", k ? "," : ":", p->key,
                      f->effect.value[k] / p->unit, f->low[k] / p->unit, f->high[k] / p->unit);
    }
    for (size_t k = 1; k < f->n_class && n < ROW; k++)
        n += snprintf(text + n, (size_t)(ROW - n), "%s%s", k == 1 ? "; or " : ", ", palp_effect_look_up(f->alike[k])->id);
}

static void say_scatter(const palp_explanation *e) {
    const struct {
        const char *id, *what, *unit;
        const palp_explain_scatter *is;
        double per;
    } all[] = {{"zero_scatter", "zeros", "N", &e->zero, 1}, {"contact_scatter", "contacts", "mm", &e->contact, 1e3},
               {"gain_scatter", "gains", "%", &e->gain, 100}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        if (all[i].is->found)
            printf("  %s: the %s of the runs differ by %.3g %s (standard deviation); one for all would leave %.4g N, not %.4g N\n",
                   all[i].id, all[i].what, all[i].per * all[i].is->sd, all[i].unit, all[i].is->without_N, e->gap.after_N);
    }
}

static void say_law(const palp_explanation *e) {
    const palp_law *given = &e->base.material.law, *better = &e->model.material.law;
    if (e->law.found)
        printf("  stiffness_law: %s with %zu coefficients instead of %s with %zu, which would leave %.4g N, not %.4g N\n",
               palp_law_kind_name(better->kind), better->n, palp_law_kind_name(given->kind), given->n, e->law.without_N,
               e->gap.after_N);
}

/* The candidates that gain most and were not taken. */
static void say_candidates(const palp_explanation *e) {
    enum { SAID = 3 };
    bool said[PALP_EFFECT_COUNT] = {false};
    for (int n = 0; n < SAID; n++) {
        size_t best = e->n_candidates;
        for (size_t k = 0; k < e->n_candidates; k++) {
            const palp_explain_candidate *c = &e->candidate[k];
            bool worse = best < e->n_candidates && c->score <= e->candidate[best].score;
            best = c->accepted || said[k] || !(c->score > 0) || worse ? best : k;
        }
        if (best == e->n_candidates)
            return;
        said[best] = true;
        printf("candidate %s: %.3g nats; not taken: %s\n", palp_effect_look_up(e->candidate[best].id)->id,
               e->candidate[best].score, e->candidate[best].reason);
    }
}

void explain_say(const palp_explanation *e) {
    char text[ROW];
    const char *verdict = palp_explain_verdict_name(e->verdict);
    printf("%s: %s\n", verdict, page_verdict(verdict, e->unexplained_N));
    for (size_t i = 0; i < e->n_effects; i++) {
        effect_text(&e->effect[i], text);
        printf("  %s\n", text);
    }
    say_law(e);
    say_scatter(e);
    printf("gap of experiments left out: %.4g N before, %.4g N after, noise level %.4g N\n", e->gap.heldout_before_N,
           e->gap.heldout_after_N, e->gap.noise_level_N);
    say_candidates(e);
    if (e->verdict == PALP_EXPLAIN_SUSPECTED)
        printf("next: press again the same way, and at another depth and speed\n");
    if (e->next.wanted && e->next.kind)
        printf("next: %s to %.3g mm tells %s from %s\n", e->next.kind, e->next.depth_mm,
               palp_effect_look_up(e->next.between[0])->id, palp_effect_look_up(e->next.between[1])->id);
}

/* ---- the page ---- */

static void into_page(void *user, const char *name, char *svg) {
    (void)name;
    html_svg(user, svg, PAGE_RESIDUALS);
    free(svg);
}

static int page(FILE *to, const json_t *result, const palp_explanation *e) {
    plot_book book = {.command = NAME, .take = into_page, .user = to};
    html_open(to, "What the model misses");
    page_found(to, result);
    explain_figure(&book, e);
    page_how(to, result);
    fputs("<p class=\"about\"><code>", to);
    html_text(to, json_string_value(json_object_get(result, "command")));
    fputs("</code></p>\n", to);
    html_close(to);
    return plot_close(&book);
}

int explain_page(const explain_options *o, const palp_explanation *e) {
    json_t *result = explain_json(o, e);
    palp_file to;
    int code = result ? cli_file_open(NAME, o->report, &to) : cli_failure(NAME, "out of memory");
    if (code == CLI_OK) {
        code = page(to.stream, result, e);
        if (code)
            palp_file_abandon(&to);
        else
            code = cli_file_close(NAME, &to);
    }
    json_decref(result);
    return code;
}

int explain_plot(const explain_options *o, const palp_explanation *e) {
    plot_book book = {.command = NAME, .folder = o->plot};
    int code = json_save_in(NAME, explain_json(o, e), o->plot, "explain.json");
    if (code == CLI_OK)
        explain_figure(&book, e);
    return code ? code : plot_close(&book);
}
