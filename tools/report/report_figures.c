/* report_figures.c: figures of simulations with their recordings, and others that no result has. */
#include "report.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "report";

/* The recording of a simulation: by its key protocol.like, or of the same kind and depth. */
static const report_file *partner(const report *r, const report_file *simulation) {
    const palp_recording *s = &simulation->recording;
    const char *like = NULL;
    bool named = palp_experiment_get_string(simulation->experiment, "protocol.like", &like) == PALP_OK;
    for (size_t i = 0; i < r->n; i++) {
        const report_file *f = &r->file[i];
        if (f->kind != REPORT_RECORDING || f->recording.n == 0)
            continue;
        bool same = named ? strcmp(cli_base(f->path), cli_base(like)) == 0
                          : f->recording.kind == s->kind && s->kind != PALP_RECORDING_OTHER &&
                                fabs(f->recording.deepest_m - s->deepest_m) < 0.01 * s->deepest_m &&
                                fabs(f->recording.ramp_end_s - f->recording.ramp_start_s - s->ramp_end_s +
                                     s->ramp_start_s) < 0.1 * (s->ramp_end_s - s->ramp_start_s);
        if (same)
            return f;
    }
    return NULL;
}

/* A value at the samples of s at time t, linear between them. */
static double value_at(const palp_recording *s, double *value, double t) {
    const palp_path path = {.n = s->n, .time_s = s->time_s, .depth_m = value};
    return palp_path_at(&path, t);
}

/* The simulated band at the recording's samples, if there is one (--band). */
static void add_band(report_pair *p, double shift) {
    palp_experiment *simulated = p->simulation->experiment;
    const palp_recording *s = &p->simulation->recording, *r = &p->recording->recording;
    double *force = palp_experiment_column(simulated, "force_N");
    double *edge[2] = {palp_experiment_column(simulated, "force_low_N"),
                       palp_experiment_column(simulated, "force_high_N")};
    bool whole = edge[0] && edge[1] && palp_experiment_rows(simulated) == s->n;
    p->band_N = whole ? malloc(2 * r->n * sizeof *p->band_N) : NULL;
    for (size_t end = 0; p->band_N && end < 2; end++) {
        for (size_t i = 0; i < r->n; i++) {
            double t = r->time_s[i] + shift;
            p->band_N[end * r->n + i] = p->force_N[i] + value_at(s, edge[end], t) - value_at(s, force, t);
        }
    }
}

/* Largest difference of simulated and recorded force in their common time, beyond the noise. */
static bool compare(report_pair *p) {
    const palp_recording *s = &p->simulation->recording, *r = &p->recording->recording;
    const char *like;
    bool same_clock =
        palp_experiment_get_string(p->simulation->experiment, "protocol.like", &like) == PALP_OK;
    double shift = same_clock ? 0 : s->ramp_start_s - r->ramp_start_s, square = 0, worst = 0;
    double *smooth = run_filter(r, run_cutoff_Hz(r));
    size_t count = 0;
    p->force_N = malloc(r->n * sizeof *p->force_N);
    for (size_t i = 0; p->force_N && i < r->n; i++) {
        double t = r->time_s[i] + shift, clean = smooth ? smooth[i] : r->force_N[i];
        p->force_N[i] = NAN;
        if (t < s->time_s[0] - 1e-9 || t > s->time_s[s->n - 1] + 1e-9)
            continue;
        p->force_N[i] = value_at(s, s->force_N, t);
        if (r->use[i]) {
            square += (p->force_N[i] - r->force_N[i]) * (p->force_N[i] - r->force_N[i]);
            worst = fmax(worst, fabs(p->force_N[i] - clean));
            p->peak_N = fmax(p->peak_N, clean);
            count++;
        }
    }
    free(smooth);
    if (p->force_N)
        add_band(p, shift);
    p->rms_N = count ? sqrt(square / (double)count) : NAN;
    p->worst_percent = p->peak_N > 0 ? 100 * worst / p->peak_N : NAN;
    return p->force_N != NULL;
}

int report_pairs(report *r) {
    for (size_t i = 0; i < r->n && r->n_pairs < REPORT_CURVES_MAX; i++) {
        const report_file *f = &r->file[i];
        if (f->kind != REPORT_SIMULATION || f->recording.n == 0)
            continue;
        report_pair *p = &r->pair[r->n_pairs];
        *p = (report_pair){.simulation = f, .recording = partner(r, f)};
        if (p->recording) {
            r->n_pairs++;
            if (!compare(p))
                return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
        }
    }
    return CLI_OK;
}

/* Draws recordings: the static ones, or the others. */
static size_t collect(const report *r, bool is_static, run_curve *curve) {
    size_t n = 0;
    for (size_t i = 0; i < r->n && n < REPORT_CURVES_MAX; i++) {
        const palp_recording *own = &r->file[i].recording;
        if (r->file[i].kind != REPORT_RECORDING || own->n == 0 ||
            (own->kind == PALP_RECORDING_STATIC) != is_static) {
            continue;
        }
        curve[n++] = (run_curve){own, NULL, NULL, NULL};
    }
    return n;
}

/* Force of the lumped model, with effects, at the recorded depth. */
static double *lumped_force(const palp_model *m, const palp_recording *r) {
    double *force = malloc(r->n * sizeof *force);
    palp_forward_run run = {.n = r->n, .time_s = r->time_s, .depth_m = r->depth_m};
    if (!force || palp_forward_force(m, &run, force, NULL, NULL)) {
        free(force);
        force = NULL;
    }
    return force;
}

static const palp_model *lumped_model(const report *r) {
    for (size_t i = 0; i < r->n; i++)
        if (r->file[i].kind == REPORT_MODEL && r->file[i].model.kind == PALP_MODEL_LUMPED)
            return &r->file[i].model;
    return NULL;
}

/* Whether a result has a figure of this name. */
static bool has(const report *r, const char *name) {
    const json_t *figure;
    for (size_t i = 0; i < r->n; i++) {
        const json_t *list = json_object_get(r->file[i].json, "figures");
        for (size_t k = 0; (figure = json_array_get(list, k)) != NULL; k++)
            if (strcmp(json_text_at(figure, "name"), name) == 0)
                return true;
    }
    return false;
}

static void fill(const report *r, size_t n, run_curve *curve, bool filter, bool fit) {
    const palp_model *model = lumped_model(r);
    for (size_t k = 0; k < n; k++) {
        curve[k].filtered_N =
            filter ? run_filter(curve[k].recording, run_cutoff_Hz(curve[k].recording)) : NULL;
        curve[k].fit_N = fit && model ? lumped_force(model, curve[k].recording) : NULL;
    }
}

static void release(size_t n, run_curve *curve) {
    for (size_t k = 0; k < n; k++) {
        free(curve[k].filtered_N);
        free(curve[k].fit_N);
    }
}

static void draw_recordings(const report *r, json_t *figures, bool is_static) {
    run_curve curve[REPORT_CURVES_MAX];
    size_t n = collect(r, is_static, curve);
    bool raw = !has(r, is_static ? "recordings_static" : "recordings_log"),
         fit = !has(r, is_static ? "fit_static" : "fit_log") && lumped_model(r);
    if (n == 0 || (!raw && !fit))
        return;
    fill(r, n, curve, raw, fit);
    if (raw && is_static)
        plot_runs_depth(figures, "recordings_static", "Ramps without a dwell: raw (light) and filtered", n,
                        curve, false);
    else if (raw)
        plot_runs_recorded(figures, n, curve);
    if (fit && is_static)
        plot_runs_depth(figures, "fit_static", "Ramps without a dwell (light) and the lumped model", n, curve,
                        true);
    else if (fit)
        plot_runs_fitted(figures, n, curve);
    release(n, curve);
}

static void draw_pairs(const report *r, json_t *figures) {
    run_curve curve[REPORT_CURVES_MAX];
    for (int is_static = 0; is_static < 2; is_static++) {
        size_t n = 0;
        for (size_t i = 0; i < r->n_pairs; i++) {
            const palp_recording *own = &r->pair[i].recording->recording;
            if ((own->kind == PALP_RECORDING_STATIC) == (is_static == 1))
                curve[n++] = (run_curve){own, NULL, r->pair[i].force_N, r->pair[i].band_N};
        }
        if (n > 0 && is_static) {
            plot_runs_depth(figures, "simulated_static",
                            "Ramps without a dwell: recorded (light) and simulated", n, curve, true);
        } else if (n > 0) {
            const char *title = "Recorded (light) and simulated";
            plot_runs_time(figures, "simulated_linear", title, n, curve, PLOT_TIME_LINEAR, true);
            plot_runs_time(figures, "simulated_log", title, n, curve, PLOT_TIME_LOG, true);
        }
    }
}

json_t *report_figures(const report *r) {
    json_t *figures = json_array();
    draw_recordings(r, figures, false);
    draw_recordings(r, figures, true);
    draw_pairs(r, figures);
    return figures;
}
