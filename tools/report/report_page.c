/* report_page.c: the page: summary, what was measured, curves, provenance. */
#define _POSIX_C_SOURCE 200809L
#include "report.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "report";

/* ---- summary ---- */

static double strain_top(const report *r) {
    double top = 0;
    for (size_t i = 0; i < r->n; i++)
        if (r->file[i].kind == REPORT_RECORDING && r->file[i].recording.n > 0)
            top = fmax(top, r->file[i].recording.deepest_m / r->file[i].recording.height_m);
    return top;
}

static void card_specimen(FILE *to, const report *r) {
    double height = 0, radius = 0;
    for (size_t i = 0; i < r->n; i++) {
        const report_file *f = &r->file[i];
        if (f->recording.n > 0 || f->kind == REPORT_MODEL) {
            height = f->recording.n > 0 ? f->recording.height_m : f->model.height_m;
            double own = f->recording.n > 0 ? f->recording.radius_m : f->model.radius_m;
            radius = fmax(radius, own);
        }
    }
    if (height > 0 && radius > 0)
        html_card(to, "Specimen", "%.4g mm high, %.4g mm across", 1e3 * height, 2e3 * radius);
    else if (height > 0)
        html_card(to, "Specimen", "%.4g mm high", 1e3 * height);
}

static void card_recordings(FILE *to, const report *r) {
    size_t n = report_count(r, REPORT_RECORDING), n_static = 0;
    double top = strain_top(r);
    for (size_t i = 0; i < r->n; i++)
        n_static += r->file[i].kind == REPORT_RECORDING &&
                    r->file[i].recording.kind == PALP_RECORDING_STATIC && r->file[i].recording.n > 0;
    if (n > 0) {
        html_card(to, "Recordings", n_static ? "%zu, %zu of them static" : "%zu", n, n_static);
        html_card(to, "Deepest", "%.3g %% strain", 100 * top);
    }
}

static void cards_characterize(FILE *to, const report *r) {
    const report_file *f = report_find(r, REPORT_CHARACTERIZE, 0);
    if (!f)
        return;
    const json_t *arms = json_object_get(f->json, "arms"), *runs = json_object_get(f->json, "runs"), *arm,
                 *run;
    size_t i;
    char text[256] = "none";
    double low = HUGE_VAL, high = 0;
    for (i = 0; (arm = json_array_get(arms, i)) != NULL; i++) {
        size_t n = i ? strlen(text) : 0;
        snprintf(text + n, sizeof text - n, "%s%.3g s", i ? ", " : "",
                 json_number_value(json_object_get(arm, "tau_s")));
    }
    html_card(to, json_array_size(arms) == 1 ? "1 arm, relaxation time" : "Arms, relaxation times", "%s",
              text);
    for (i = 0; (run = json_array_get(runs, i)) != NULL; i++) {
        const json_t *ratio = json_object_get(run, "rms_noise");
        if (json_is_number(ratio)) {
            low = fmin(low, json_number_value(ratio));
            high = fmax(high, json_number_value(ratio));
        }
    }
    if (high > 0)
        html_card(to, "Residual, times the noise of a sample", low < high ? "%.3g to %.3g" : "%.3g", low,
                  high);
    const json_t *before = json_object_get(f->json, "gap_before_percent"),
                 *after = json_object_get(f->json, "gap_after_percent");
    if (json_is_number(before) && json_is_number(after))
        html_card(to, "Static against ramp and hold, before and after the joint fit", "%+.2f %% and %+.2f %%",
                  json_number_value(before), json_number_value(after));
}

static void card_model(FILE *to, const report *r) {
    const report_file *f;
    double top = strain_top(r), low, high;
    for (size_t i = 0; (f = report_find(r, REPORT_MODEL, i)) != NULL; i++) {
        if (f->model.kind == PALP_MODEL_LUMPED) {
            top = top > 0 ? top : 0.4;
            palp_law_stiffness(&f->model.material.law, 0, &low, NULL);
            palp_law_stiffness(&f->model.material.law, top, &high, NULL);
            html_card(to, "Stiffness K at strain 0 and at the deepest", "%.3g N and %.3g N", low, high);
            return;
        }
    }
}

static void card_explain(FILE *to, const report *r) {
    const report_file *f = report_find(r, REPORT_EXPLAIN, 0);
    bool unknown = f && strcmp(json_text_at(f->json, "verdict"), "unexplained") == 0;
    char text[256];
    snprintf(text, sizeof text, "%s", unknown ? "something that no effect accounts for" : "nothing");
    const json_t *list = f ? json_object_get(f->json, "effects") : NULL, *effect;
    for (size_t i = 0; (effect = json_array_get(list, i)) != NULL; i++) {
        size_t n = i ? strlen(text) : 0;
        snprintf(text + n, sizeof text - n, "%s%s", i ? ", " : "", page_effect(json_text_at(effect, "id")));
    }
    if (f)
        html_card(to, "Missing in the lumped model", "%s", text);
}

static void card_calibrate(FILE *to, const report *r) {
    const report_file *f = report_find(r, REPORT_CALIBRATE, 0);
    const json_t *depths = f ? json_object_get(f->json, "depths") : NULL, *depth;
    double worst = 0;
    for (size_t i = 0; (depth = json_array_get(depths, i)) != NULL; i++)
        worst = fmax(worst, json_number_value(json_object_get(depth, "max_error_percent")));
    if (worst > 0)
        html_card(to, "Network against its target, largest error", "%.2g %% of the peak", worst);
}

static void summary(FILE *to, const report *r) {
    double worst = 0;
    fputs("<div class=\"cards\">\n", to);
    card_specimen(to, r);
    card_recordings(to, r);
    card_model(to, r);
    cards_characterize(to, r);
    card_explain(to, r);
    card_calibrate(to, r);
    for (size_t i = 0; i < r->n_pairs; i++)
        worst = fmax(worst, r->pair[i].worst_percent);
    if (r->n_pairs > 0)
        html_card(to, "Simulation against recording, largest error", "%.2g %% of the peak", worst);
    fputs("</div>\n", to);
}

/* ---- what was measured ---- */

static void finding(char *text, size_t size, const char *format, double a, double b) {
    size_t n = strlen(text);
    n += (size_t)snprintf(text + n, size - n, "%s", n ? "; " : "");
    snprintf(text + n, size - n, format, a, b);
}

static void findings(const palp_recording *r, char *text, size_t size) {
    text[0] = '\0';
    if (r->n_missing > 0)
        finding(text, size, "%.0f samples missing (%.2g %%)", (double)r->n_missing,
                100.0 * (double)r->n_missing / (double)(r->n + r->n_missing));
    if (r->n_gaps > 0)
        finding(text, size, "%.0f gap(s), up to %.3g s", (double)r->n_gaps, r->longest_gap_s);
    if (r->n_spikes > 0)
        finding(text, size, "%.0f spike(s)", (double)r->n_spikes, 0);
    if (r->n_clipped > 0)
        finding(text, size, "%.0f clipped samples", (double)r->n_clipped, 0);
    if (r->hum_N > 0)
        finding(text, size, "hum %.2g mN at %.3g Hz", 1e3 * r->hum_N, r->hum_Hz);
    if (r->uneven)
        finding(text, size, "uneven sampling", 0, 0);
    if (r->faulted)
        finding(text, size, "ended by a fault", 0, 0);
    if (!text[0])
        snprintf(text, size, "none");
}

static void measured_row(FILE *to, const report_file *f) {
    static const char *const kinds[] = {"ramp", "ramp and hold", "other", "creep"};
    static const char *const rules[] = {"given", "free air", "nominal"};
    const palp_recording *r = &f->recording;
    char text[256];
    if (r->n == 0) {
        html_row(to, f->note[0] ? "%s|~could not be used: %s" : "%s|~no specimen%s||||||||||",
                 cli_base(f->path), f->note);
        return;
    }
    findings(r, text, sizeof text);
    html_row(to, "%s|~%s|%.4g|%.3g|%.4g|%zu|%.4g|%.3g \u00b1 %.2g|~%s|%.3f|%#.3g|~%s", cli_base(f->path),
             kinds[r->kind], 1e3 * r->deepest_m, r->ramp_end_s - r->ramp_start_s,
             r->time_s[r->n - 1] - r->time_s[0], r->n, run_rate_Hz(r), 1e3 * r->contact_m,
             1.96e3 * r->contact_sd_m, rules[r->contact_rule], 1e3 * r->zero_N, 1e3 * r->noise_N, text);
}

static void warnings(FILE *to, const report *r) {
    const json_t *text;
    size_t count = 0;
    for (size_t i = 0; i < r->n; i++) {
        const json_t *list = r->file[i].json ? json_object_get(r->file[i].json, "warnings") : NULL;
        for (size_t k = 0; (text = json_array_get(list, k)) != NULL; k++) {
            fputs(count++ ? "<li>" : "<div class=\"warn\"><b>Warnings</b><ul><li>", to);
            html_text(to, json_is_string(text) ? json_string_value(text) : "");
            fputs("</li>\n", to);
        }
    }
    if (count > 0)
        fputs("</ul>\n<p>c0, c1, c2 are the coefficients of a polynomial stiffness law K(e) = c0 + c1 e + c2 "
              "e<sup>2</sup> of the strain e; K_1, b_1 "
              "and tau_1 the spring, the dashpot and the relaxation time of the first arm; K_inf [1] the "
              "stiffness at the depth of "
              "the first hold.</p></div>\n",
              to);
}

static void measured(FILE *to, const report *r) {
    if (report_count(r, REPORT_RECORDING) == 0) {
        warnings(to, r);
        return;
    }
    html_section(to, "measured", "What was measured");
    warnings(to, r);
    html_table(to, NULL,
               "file|~protocol|depth (mm)|ramp (s)|length (s)|samples|rate (Hz)|contact (mm)|~found by|zero "
               "(mN)|noise (mN)|~findings");
    for (size_t i = 0; i < r->n; i++)
        if (r->file[i].kind == REPORT_RECORDING)
            measured_row(to, &r->file[i]);
    html_table_end(to);
    fputs("<p class=\"about\">Contact is the recorded depth at which the force begins, with its 95&nbsp;% "
          "interval; zero "
          "is the recorded force in free air; noise is the standard deviation of a sample.</p>\n",
          to);
}

static void curves(FILE *to, report *r) {
    if (report_count(r, REPORT_RECORDING) == 0)
        return;
    html_section(to, "curves", "Recorded curves");
    fputs("<div class=\"figures\">\n", to);
    report_figure(to, r, "recordings_linear", "Force over time.");
    report_figure(to, r, "recordings_log",
                  "The same over the logarithm of time, where each arm takes its decade.");
    report_figure(to, r, "recordings_first", "The first ten seconds.");
    report_figure(to, r, "recordings_static", "Force over depth in the slow press.");
    fputs("</div>\n<p class=\"about\">Light: raw samples, thinned to the lowest and highest of each stretch. "
          "Dark: "
          "filtered forward and backward, without a shift in time; fits use the raw samples unless said "
          "otherwise.</p>\n",
          to);
}

/* ---- what palpate explain found ---- */

static void explanations(FILE *to, report *r) {
    const report_file *f;
    if (report_count(r, REPORT_EXPLAIN) == 0)
        return;
    html_section(to, "explain", "What the model misses");
    for (size_t i = 0; (f = report_find(r, REPORT_EXPLAIN, i)) != NULL; i++) {
        page_found(to, f->json);
        report_figure(to, r, "explain_residuals", PAGE_RESIDUALS);
        page_how(to, f->json);
    }
}

/* ---- provenance ---- */

static const char *kind_name(report_kind kind) {
    static const char *const names[] = {"not used",     "recording", "simulation", "model",
                                        "characterize", "calibrate", "explain",    "figure"};
    return names[kind];
}

static void others(FILE *to, report *r) {
    bool any = false;
    for (size_t i = 0; i < r->n; i++) {
        report_file *f = &r->file[i];
        if (f->kind == REPORT_FIGURE && !f->shown) {
            if (!any) {
                html_section(to, "others", "Other figures");
                fputs("<div class=\"figures\">\n", to);
                any = true;
            }
            report_place(to, f, cli_base(f->path));
        }
    }
    fputs(any ? "</div>\n" : "", to);
}

static void commands(FILE *to, const report *r) {
    for (size_t i = 0; i < r->n; i++) {
        const json_t *command = r->file[i].json ? json_object_get(r->file[i].json, "command") : NULL;
        const json_t *about = r->file[i].json ? json_object_get(r->file[i].json, "palpate") : NULL;
        const json_t *version = about ? json_object_get(about, "version") : NULL;
        if (json_is_string(command)) {
            fputs("<p>", to);
            html_text(to, cli_base(r->file[i].path));
            fprintf(to, ", palpate ");
            html_text(to, json_is_string(version) ? json_string_value(version) : "?");
            fputs(": <code>", to);
            html_text(to, json_string_value(command));
            fputs("</code></p>\n", to);
        }
    }
}

static void provenance(FILE *to, const report *r) {
    char date[32];
    html_section(to, "provenance", "Provenance");
    fputs("<p>This page: palpate ", to);
    html_text(to, palp_version());
    fputs(". It needs no network and no other file.</p>\n", to);
    commands(to, r);
    html_table(to, NULL, "file|~what|size (bytes)|CRC-32|~modified (UTC)|~note");
    for (size_t i = 0; i < r->n; i++) {
        const report_file *f = &r->file[i];
        struct tm when;
        if (f->drawn)
            continue;
        if (!gmtime_r(&f->modified, &when) || strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S", &when) == 0)
            strcpy(date, "-");
        html_row(to, "%s|~%s|%lld|%08lx|~%s|~%s", cli_base(f->path), kind_name(f->kind), f->size,
                 (unsigned long)f->crc, date, f->note);
    }
    html_table_end(to);
}

/* ---- the page ---- */

static void contents(FILE *to, const report *r) {
    bool runs = report_count(r, REPORT_RECORDING) > 0, fit = report_count(r, REPORT_CHARACTERIZE) > 0;
    const struct {
        bool there;
        const char *id, *title;
    } parts[] = {{runs, "measured", "What was measured"},
                 {runs, "curves", "Recorded curves"},
                 {r->has_fits, "fits", "Fits and residuals"},
                 {fit, "parameters", "Parameters"},
                 {r->has_law, "law", "Stiffness law and arms"},
                 {report_count(r, REPORT_EXPLAIN) > 0, "explain", "What the model misses"},
                 {r->has_calibration, "calibration", "Network calibration"},
                 {r->n_pairs > 0, "simulation", "Simulation against recordings"},
                 {true, "provenance", "Provenance"}};
    fputs("<nav>", to);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (parts[i].there)
            fprintf(to, "<a href=\"#%s\">%s</a>", parts[i].id, parts[i].title);
    fputs("</nav>\n", to);
}

int report_page(report *r, const char *path) {
    palp_file file;
    int code = cli_file_open(NAME, path, &file);
    if (code)
        return code;
    FILE *to = file.stream;
    html_open(to, r->title);
    fputs(
        "<p class=\"about\">From the press of an indenter to a tissue model that a simulator can run.</p>\n",
        to);
    for (size_t i = 0; report_find(r, REPORT_EXPLAIN, i); i++)
        page_in_short(to, report_find(r, REPORT_EXPLAIN, i)->json);
    summary(to, r);
    contents(to, r);
    measured(to, r);
    curves(to, r);
    report_fits(to, r);
    report_parameters(to, r);
    report_law(to, r);
    explanations(to, r);
    report_calibrations(to, r);
    report_simulations(to, r);
    others(to, r);
    provenance(to, r);
    html_close(to);
    return cli_file_close(NAME, &file);
}
