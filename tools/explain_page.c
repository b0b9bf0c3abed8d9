/* explain_page.c: what was found, in lines and as a page: verdict, where, suspects, the gap before and after. */
#include "explain.h"
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "explain";

enum { POINTS = 400, ROW = 512 };

/* ---- words ---- */

static const char *sentence(palp_explain_verdict verdict) {
    static const char *const text[] = {
        "Nothing is missing that these runs could show.",
        "With the effects below, what remains is at the floor.",
        "The effects below close the gap, but others would do as well: see the class.",
        "Something is missing that no effect of the catalogue accounts for.",
    };
    return text[verdict];
}

static void effect_text(const palp_explain_effect *f, char text[ROW]) {
    const palp_effect_info *info = palp_effect_look_up(f->effect.id);
    int n = snprintf(text, ROW, "%s", info->id);
    for (size_t k = 0; k < info->n_parameters && n < ROW; k++) {
        const palp_effect_parameter *p = &info->parameter[k];
        n += snprintf(text + n, (size_t)(ROW - n), "%s %s %.4g (%.4g to %.4g)", k ? "," : ":", p->key,
                      f->effect.value[k] / p->unit, f->low[k] / p->unit, f->high[k] / p->unit);
    }
    for (size_t k = 1; k < f->n_class && n < ROW; k++) {
        n += snprintf(text + n, (size_t)(ROW - n), "%s%s", k == 1 ? "; or " : ", ", palp_effect_look_up(f->alike[k])->id);
    }
}

void explain_say(const palp_explanation *e) {
    char text[ROW];
    printf("%s: %s\n", palp_explain_verdict_name(e->verdict), sentence(e->verdict));
    for (size_t i = 0; i < e->n_effects; i++) {
        effect_text(&e->effect[i], text);
        printf("  %s\n", text);
    }
    printf("gap of experiments left out: %.4g N before, %.4g N after, floor %.4g N\n", e->gap.heldout_before_N,
           e->gap.heldout_after_N, e->gap.floor_N);
    if (e->next.wanted && e->next.kind) {
        printf("next: %s to %.3g mm tells %s from %s\n", e->next.kind, e->next.depth_mm,
               palp_effect_look_up(e->next.between[0])->id, palp_effect_look_up(e->next.between[1])->id);
    }
}

/* ---- figures: small and plain, drawn as they are ---- */

static void polyline(FILE *to, const palp_explain_run *run, const double *y, double most, const char *colour) {
    size_t stride = run->n / POINTS + 1;
    double length = run->time_s[run->n - 1] - run->time_s[0];
    fprintf(to, "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1\" points=\"", colour);
    for (size_t i = 0; i < run->n; i += stride) { /* the mean of what one point stands for */
        double sum = 0;
        size_t end = i + stride < run->n ? i + stride : run->n;
        for (size_t k = i; k < end; k++) {
            sum += y[k];
        }
        fprintf(to, "%.1f,%.1f ", 600 * (run->time_s[i] - run->time_s[0]) / length,
                75 - 70 * sum / (double)(end - i) / most);
    }
    fputs("\"/>\n", to);
}

static void figure(FILE *to, const palp_explanation *e, const palp_explain_run *run, double most) {
    double floor_y = 70 * fmin(1, e->gap.floor_N / most);
    fputs("<figure><svg viewBox=\"0 0 600 150\" role=\"img\">", to);
    fprintf(to, "<rect x=\"0\" y=\"%.1f\" width=\"600\" height=\"%.1f\" fill=\"#eef1f4\"/>", 75 - floor_y, 2 * floor_y);
    fputs("<line x1=\"0\" y1=\"75\" x2=\"600\" y2=\"75\" stroke=\"#c3ccd3\"/>\n", to);
    polyline(to, run, run->before_N, most, "#d55e00");
    polyline(to, run, run->after_N, most, "#0072b2");
    fputs("</svg><figcaption>", to);
    html_text(to, run->name);
    fprintf(to, ": recorded minus model, &#177;%.3g N from top to bottom, over %.4g s; orange as given, blue with the "
                "effects, grey the floor.</figcaption></figure>\n",
            most, run->time_s[run->n - 1] - run->time_s[0]);
}

static void figures(FILE *to, const palp_explanation *e) {
    double most = e->gap.floor_N;
    for (size_t r = 0; r < e->n_runs; r++) {
        double square = 0;
        for (size_t i = 0; i < e->run[r].n; i++) {
            square += e->run[r].before_N[i] * e->run[r].before_N[i] / (double)e->run[r].n;
        }
        most = fmax(most, 3 * sqrt(square));
    }
    fputs("<div class=\"figures\">\n", to);
    for (size_t r = 0; r < e->n_runs; r++) {
        figure(to, e, &e->run[r], most);
    }
    fputs("</div>\n", to);
}

/* ---- the page ---- */

static void bar(FILE *to, const char *label, double value, double most, const char *unit) {
    fputs("<tr><td class=\"t\">", to);
    html_text(to, label);
    fprintf(to,
            "</td><td class=\"t\"><svg width=\"260\" height=\"12\"><rect width=\"%.1f\" height=\"12\" "
            "fill=\"#0072b2\"/></svg></td><td>%.3g%s</td></tr>\n",
            most > 0 ? 260 * fmin(1, fmax(0, value / most)) : 0.0, value, unit);
}

static void where(FILE *to, const palp_explanation *e) {
    char label[PALP_NAME_MAX + 32];
    fputs("<div class=\"scroll\"><table><thead><tr><th>where</th><th></th><th>share of the gap</th></tr></thead><tbody>\n",
          to);
    for (size_t i = 0; i < e->n_where && i < 12; i++) {
        snprintf(label, sizeof label, "%s, %s", e->run[e->where[i].run].name, palp_explain_phase_name(e->where[i].phase));
        bar(to, label, 100 * e->where[i].share, 100 * e->where[0].share, " %");
    }
    html_table_end(to);
}

static void suspects(FILE *to, const palp_explanation *e) {
    html_table(to, "Every suspect beside the model as given", "effect|gain, nats|would explain, N|~what became of it");
    for (size_t i = 0; i < e->n_suspects; i++) {
        const palp_explain_suspect *s = &e->suspect[i];
        html_row(to, "%s|%.4g|%.3g|~%s", palp_effect_look_up(s->id)->name, s->score, s->explained_N,
                 s->accepted ? "accepted" : s->identifiable ? s->reason : "these runs cannot show it");
    }
    html_table_end(to);
}

static void gap(FILE *to, const palp_explanation *e) {
    double most = fmax(e->gap.heldout_before_N, e->gap.before_N);
    fputs("<div class=\"scroll\"><table><thead><tr><th>gap, rms</th><th></th><th>N</th></tr></thead><tbody>\n", to);
    bar(to, "as given, refitted", e->gap.before_N, most, "");
    bar(to, "with the effects", e->gap.after_N, most, "");
    bar(to, "as given, experiments left out", e->gap.heldout_before_N, most, "");
    bar(to, "with the effects, experiments left out", e->gap.heldout_after_N, most, "");
    bar(to, "floor", e->gap.floor_N, most, "");
    html_table_end(to);
}

static void cards(FILE *to, const palp_explanation *e) {
    fputs("<div class=\"cards\">\n", to);
    html_card(to, "Verdict", "%s", palp_explain_verdict_name(e->verdict));
    html_card(to, "Gap closed, experiments left out", "%.1f %%", 100 * e->gap.closed);
    html_card(to, "Floor", "%.3g N", e->gap.floor_N);
    html_card(to, "Structure above the floor that remains", "%.3g N", e->unexplained_N);
    fputs("</div>\n", to);
}

static void page(FILE *to, const explain_options *o, const palp_explanation *e) {
    char text[ROW];
    html_open(to, "What the model misses");
    fprintf(to, "<p>%s</p>\n", sentence(e->verdict));
    cards(to, e);
    for (size_t i = 0; i < e->n_effects; i++) {
        effect_text(&e->effect[i], text);
        fputs("<p><b>", to);
        html_text(to, palp_effect_look_up(e->effect[i].effect.id)->name);
        fputs("</b> ", to);
        html_text(to, text);
        fputs("</p>\n", to);
    }
    html_section(to, "where", "Where model and runs disagree");
    where(to, e);
    figures(to, e);
    html_section(to, "suspects", "The suspects");
    suspects(to, e);
    html_section(to, "gap", "The gap before and after");
    gap(to, e);
    html_section(to, "next", "What to measure next");
    if (e->next.wanted && e->next.kind) {
        fprintf(to, "<p>A %s run to %.3g mm would set %s and %s %.3g N apart.</p>\n", e->next.kind, e->next.depth_mm,
                palp_effect_look_up(e->next.between[0])->name, palp_effect_look_up(e->next.between[1])->name,
                e->next.separation_N);
    } else {
        fprintf(to, "<p>%s</p>\n", e->next.note ? e->next.note : "Nothing that would change the answer.");
    }
    fputs("<p class=\"about\"><code>", to);
    html_text(to, o->command);
    fputs("</code></p>\n", to);
    html_close(to);
}

int explain_page(const explain_options *o, const palp_explanation *e) {
    cli_file to;
    int code = cli_file_open(NAME, o->report, &to);
    if (code == CLI_OK) {
        page(to.stream, o, e);
        code = cli_file_close(NAME, &to);
    }
    return code;
}
