/* calibrate_targets.c: the curves to meet, from the lumped model or from measured runs. */
#include "calibrate.h"
#include "shared/opening.h"
#include "shared/press.h"

#include <math.h>
#include <palpate/recording.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "calibrate";

enum { HOLD_SAMPLES = 120, RAMP_SAMPLES = 40 };

/* ---- from the lumped model ---- */

static int static_from_lumped(const calibrate_options *o, calibrate_state *s, double depth_m) {
    size_t n = o->steps;
    s->depth_m = malloc(n * sizeof *s->depth_m);
    s->force_N = malloc(n * sizeof *s->force_N);
    if (!s->depth_m || !s->force_N)
        return cli_status(NAME, PALP_ERR_NO_MEMORY, NULL);
    for (size_t i = 0; i < n; i++) {
        s->depth_m[i] = depth_m * (double)(i + 1) / (double)n;
        double e = s->depth_m[i] / s->lumped.height_m;
        palp_law_force(&s->lumped.material.law, 1, &e, &s->force_N[i], NULL, NULL);
    }
    s->n_static = n;
    return CLI_OK;
}

/* Times of the comparison. The thesis' method uses every step, to find the steady state; otherwise steps are
 * equal on the ramp and grow in the dwell. */
static palp_status sample_times(const calibrate_options *o, const calibrate_state *s, const palp_path *path,
                                size_t *n, double **time_s) {
    if (s->relaxation_method == METHOD_THREE_PHASE) {
        const press_settings every = {.dt_s = 1e-3 * o->dt_ms};
        return press_times(path, &every, n, time_s);
    }
    double *t = malloc((1 + RAMP_SAMPLES + HOLD_SAMPLES) * sizeof *t);
    if (!t)
        return PALP_ERR_NO_MEMORY;
    size_t at = 0;
    double first = fmin(0.01 * o->ramp_s, 1e-3 * o->hold_s);
    for (int i = 0; i <= RAMP_SAMPLES; i++)
        t[at++] = path->time_s[1] * i / RAMP_SAMPLES;
    for (int i = 0; i < HOLD_SAMPLES && o->hold_s > 0; i++)
        t[at++] = o->ramp_s + first * pow(o->hold_s / first, (double)i / (HOLD_SAMPLES - 1));
    *n = at;
    *time_s = t;
    return PALP_OK;
}

static palp_status press_from_lumped(const calibrate_options *o, const calibrate_state *s, double depth_m,
                                     press_target *press) {
    size_t n = 0;
    double *t = NULL, *depth = NULL, *force = NULL;
    press->depth_m = depth_m;
    palp_status status = palp_path_ramp_hold(depth_m, o->ramp_s, o->hold_s, &press->path);
    if (status == PALP_OK)
        status = sample_times(o, s, &press->path, &n, &t);
    if (status == PALP_OK) {
        depth = malloc(n * sizeof *depth);
        force = malloc(n * sizeof *force);
        status = depth && force ? PALP_OK : PALP_ERR_NO_MEMORY;
    }
    for (size_t i = 0; status == PALP_OK && i < n; i++)
        depth[i] = palp_path_at(&press->path, t[i]);
    if (status == PALP_OK)
        status = palp_lumped_run(&s->lumped.material, s->lumped.height_m, n, t, depth, force);
    for (size_t i = 0; status == PALP_OK && i < n; i++)
        status = record_add(&press->target, t[i], depth[i], force[i]);
    free(t);
    free(depth);
    free(force);
    return status;
}

/* ---- from measured runs ---- */

/* Keeps each sample that is deeper than all before it. */
static int static_from_run(const char *file, const palp_experiment *run, calibrate_state *s) {
    const double *depth_mm = palp_experiment_column(run, "depth_mm"),
                 *force_N = palp_experiment_column(run, "force_N");
    size_t rows = palp_experiment_rows(run);
    if (s->n_static)
        return cli_failure(NAME, "%s: is a second static run; give only one", file);
    s->depth_m = malloc((rows ? rows : 1) * sizeof *s->depth_m);
    s->force_N = malloc((rows ? rows : 1) * sizeof *s->force_N);
    if (!s->depth_m || !s->force_N)
        return cli_status(NAME, PALP_ERR_NO_MEMORY, NULL);
    double deepest = 0;
    for (size_t i = 0; i < rows; i++) {
        if (1e-3 * depth_mm[i] > deepest) {
            deepest = 1e-3 * depth_mm[i];
            if (s->static_method == METHOD_FIXED_POINT && !(force_N[i] > 0))
                return cli_failure(
                    NAME, "%s: the force at %.4g mm is %.4g N; --method fixed_point needs forces above 0",
                    file, depth_mm[i], force_N[i]);
            s->depth_m[s->n_static] = deepest;
            s->force_N[s->n_static++] = force_N[i];
        }
    }
    return s->n_static >= 10
               ? CLI_OK
               : cli_failure(NAME, "%s: has %zu samples of increasing depth, but a static run needs ten",
                             file, s->n_static);
}

/* First row of the press: the last in free air before contact. */
static size_t contact_row(size_t rows, const double *depth_mm) {
    for (size_t i = 0; i < rows; i++)
        if (depth_mm[i] > 0)
            return i > 0 ? i - 1 : 0;
    return rows;
}

static void add_corner(palp_path *corners, double time_s, double depth_m) {
    corners->time_s[corners->n] = time_s;
    corners->depth_m[corners->n++] = depth_m;
}

/* Corners of a recorded path: few rows (greedy) whose connecting lines stay within 0.1 % of the largest
 * depth. */
static palp_status simplify(size_t n, const double *time_s, const double *depth_m, double deepest_m,
                            palp_path *path) {
    palp_path corners = {0, malloc(n * sizeof(double)), malloc(n * sizeof(double)), NULL};
    palp_status status = corners.time_s && corners.depth_m ? PALP_OK : PALP_ERR_NO_MEMORY;
    double allowed = 1e-3 * deepest_m, low = -INFINITY, high = INFINITY;
    size_t from = 0;
    if (status == PALP_OK)
        add_corner(&corners, time_s[0], depth_m[0]);
    for (size_t i = 1; status == PALP_OK && i < n; i++) {
        double dt = time_s[i] - time_s[from], slope = (depth_m[i] - depth_m[from]) / dt;
        if (slope < low || slope > high) {
            from = i - 1;
            add_corner(&corners, time_s[from], depth_m[from]);
            dt = time_s[i] - time_s[from];
            low = -INFINITY;
            high = INFINITY;
        }
        low = fmax(low, (depth_m[i] - allowed - depth_m[from]) / dt);
        high = fmin(high, (depth_m[i] + allowed - depth_m[from]) / dt);
    }
    if (status == PALP_OK) {
        add_corner(&corners, time_s[n - 1], depth_m[n - 1]);
        status = palp_path_create(corners.n, corners.time_s, corners.depth_m, path);
    }
    free(corners.time_s);
    free(corners.depth_m);
    return status;
}

/* Thins the samples: equal steps to the largest depth, then growing ones. */
static palp_status thin(size_t n, const double *time_s, const double *depth_m, const double *force_N,
                        double deepest_m, record *target) {
    size_t peak = 0;
    while (peak + 1 < n && depth_m[peak] < 0.999 * deepest_m)
        peak++;
    double ramp = (time_s[peak] - time_s[0]) / RAMP_SAMPLES, next = time_s[0];
    palp_status status = PALP_OK;
    for (size_t i = 0; status == PALP_OK && i < n; i++) {
        if (time_s[i] < next && i != peak)
            continue;
        status = record_add(target, time_s[i], depth_m[i], force_N[i]);
        next = time_s[i] + (i < peak ? ramp : fmax(0.1 * ramp, 0.07 * (time_s[i] - time_s[peak])));
    }
    return status;
}

static int press_from_run(const char *file, const palp_experiment *run, size_t least, press_target *press) {
    const double *time_s = palp_experiment_column(run, "time_s"),
                 *depth_mm = palp_experiment_column(run, "depth_mm"),
                 *force_N = palp_experiment_column(run, "force_N");
    size_t rows = palp_experiment_rows(run), first = contact_row(rows, depth_mm), n = rows - first;
    if (n < least)
        return cli_failure(NAME, "%s: has fewer than %zu samples in contact", file, least);
    double *time = malloc(n * sizeof *time), *depth = malloc(n * sizeof *depth);
    palp_status status = time && depth ? PALP_OK : PALP_ERR_NO_MEMORY;
    press->measured = true;
    for (size_t i = 0; status == PALP_OK && i < n; i++) {
        time[i] = time_s[first + i] - time_s[first];
        depth[i] = i ? 1e-3 * fmax(depth_mm[first + i], 0) : 0;
        press->depth_m = fmax(press->depth_m, depth[i]);
    }
    if (status == PALP_OK)
        status = simplify(n, time, depth, press->depth_m, &press->path);
    if (status == PALP_OK)
        status = thin(n, time, depth, force_N + first, press->depth_m, &press->target);
    free(time);
    free(depth);
    return status ? cli_status_of(NAME, file, status, NULL) : CLI_OK;
}

/* Classifies the path: one press without or with a dwell, or more. */
static palp_status kind_of(const palp_experiment *run, palp_recording_kind *kind) {
    palp_pieces pieces;
    palp_status status =
        palp_segments_pieces(palp_experiment_rows(run), palp_experiment_column(run, "time_s"),
                             palp_experiment_column(run, "depth_mm"), &pieces);
    if (status == PALP_OK) {
        *kind = palp_recording_kind_of(&pieces);
        palp_pieces_free(&pieces);
    }
    return status;
}

/* The samples to the deepest one of a slow press; each is of the relaxed network. */
static int press_of_tip(const char *file, const palp_experiment *run, palp_recording_kind kind,
                        press_target *press) {
    int code = open_tip(NAME, file, run, &press->tip_radius_m, press->tip_m);
    if (code == CLI_OK)
        code = press_from_run(file, run, 3, press);
    press->relaxed = kind == PALP_RECORDING_STATIC;
    record *target = &press->target;
    for (size_t i = 0; press->relaxed && i < target->n; i++)
        if (target->depth_m[i] >= 0.999 * press->depth_m)
            target->n = i + 1;
    return code;
}

/* Whether any run is of a tool, and whether tips of different size pressed. */
static int note_tools(const calibrate_options *o, calibrate_state *s) {
    double first_m = 0, radius_m, place_m[2];
    bool differ = false;
    int code = CLI_OK;
    for (size_t i = 1; code == CLI_OK && i < o->n_words; i++) {
        palp_experiment *run = NULL;
        code = open_run(NAME, o->words[i], &run);
        if (code == CLI_OK)
            code = open_tip(NAME, o->words[i], run, &radius_m, place_m);
        palp_experiment_free(run);
        if (code)
            break;
        first_m = i == 1 ? radius_m : first_m;
        differ = differ || radius_m != first_m;
        s->tools = s->tools || radius_m > 0;
    }
    s->tools = s->tools || o->regions;
    s->fits_poisson = s->tools && differ && !(o->poisson > 0) && s->source.scaling == PALP_SCALING_CONTINUUM;
    return code;
}

static int read_run(const char *file, calibrate_state *s) {
    palp_experiment *run = NULL;
    palp_recording_kind kind = PALP_RECORDING_OTHER;
    palp_error error = {PALP_OK, ""};
    int code = open_run(NAME, file, &run);
    if (code)
        return code;
    palp_status status = palp_recording_check(run, file, s->lumped.height_m, &error);
    if (status == PALP_OK)
        status = open_smooth_path(run);
    if (status == PALP_OK)
        status = kind_of(run, &kind);
    if (status) {
        code = cli_status_of(NAME, file, status, &error);
    } else if (kind != PALP_RECORDING_OTHER && s->tools && s->n_presses < PRESSES_MAX) {
        code = press_of_tip(file, run, kind, &s->press[s->n_presses++]);
    } else if (kind == PALP_RECORDING_STATIC && s->does_static) {
        code = static_from_run(file, run, s);
    } else if (kind == PALP_RECORDING_RAMP_HOLD && s->does_relaxation && s->n_presses < PRESSES_MAX) {
        code = press_from_run(file, run, 10, &s->press[s->n_presses++]);
    } else {
        static const char *const kinds[] = {"one press without a dwell", "a press and a dwell",
                                            "more than one press"};
        code = cli_failure(
            NAME, "%s: its path is %s, which this stage cannot use; leave it out or choose another --stage",
            file, kinds[kind]);
    }
    palp_experiment_free(run);
    return code;
}

/* ---- all of them ---- */

/* A share of the height, but no deeper than the lumped model was measured. */
static double default_depth(const calibrate_state *s, double part) {
    double measured = s->lumped.material.law.strain_max;
    return (measured > 0 ? fmin(part, measured) : part) * s->lumped.height_m;
}

/* The depths of the thesis (Section 5.3 and Chapter 4) as shares of the height. */
static size_t default_depths(const calibrate_state *s, double depth_m[PRESSES_MAX]) {
    if (s->relaxation_method == METHOD_THREE_PHASE) {
        depth_m[0] = default_depth(s, 0.25);
        return 1;
    }
    const double share = default_depth(s, 7.0 / 24) / (7.0 / 24 * s->lumped.height_m);
    for (size_t i = 0; i < 12; i++)
        depth_m[i] = (1.5 + 0.5 * (double)i) / 24 * s->lumped.height_m * share;
    return 12;
}

static int presses_from_lumped(const calibrate_options *o, calibrate_state *s) {
    double depth_m[PRESSES_MAX];
    size_t n = default_depths(s, depth_m);
    if (o->depth_mm.n) {
        n = o->depth_mm.n;
        for (size_t i = 0; i < n; i++)
            depth_m[i] = 1e-3 * o->depth_mm.value[i];
    }
    for (size_t i = 0; i < n; i++) {
        palp_status status = press_from_lumped(o, s, depth_m[i], &s->press[s->n_presses++]);
        if (status)
            return cli_status_of(NAME, o->lumped, status, NULL);
    }
    return CLI_OK;
}

static int check_depths(const calibrate_state *s) {
    double deepest = s->n_static ? s->depth_m[s->n_static - 1] : 0;
    for (size_t i = 0; i < s->n_presses; i++)
        deepest = fmax(deepest, s->press[i].depth_m);
    if (deepest >= s->height_m)
        return cli_usage_error(NAME, "a depth of %g mm exceeds the network's height of %g mm; press less",
                               1e3 * deepest, 1e3 * s->height_m);
    return CLI_OK;
}

/* Warns if targets go beyond the measured range of the lumped model. */
static void judge_range(const calibrate_state *s) {
    const palp_law *law = &s->lumped.material.law;
    double deepest = s->does_static && s->static_lumped ? s->depth_m[s->n_static - 1] : 0;
    for (size_t i = 0; i < s->n_presses; i++)
        deepest = s->press[i].measured ? deepest : fmax(deepest, s->press[i].depth_m);
    if (palp_law_beyond(law, deepest / s->lumped.height_m) > 1e-9)
        press_warn_beyond(NAME, law, deepest / s->lumped.height_m, -1);
}

int calibrate_targets(const calibrate_options *o, calibrate_state *s) {
    int code = note_tools(o, s);
    s->does_static = s->does_static && !s->tools;
    s->does_relaxation = s->does_relaxation || s->tools; /* where its result goes */
    for (size_t i = 1; code == CLI_OK && i < o->n_words; i++)
        code = read_run(o->words[i], s);
    if (code == CLI_OK && s->does_static && s->n_static == 0) {
        bool given = o->stage == STAGE_STATIC && o->depth_mm.n;
        double depth_m = given ? 1e-3 * o->depth_mm.value[0] : default_depth(s, 9.7 / 24);
        s->static_lumped = true;
        code = static_from_lumped(o, s, depth_m);
    }
    if (code == CLI_OK && s->does_relaxation && s->n_presses == 0)
        code = presses_from_lumped(o, s);
    for (size_t i = 0; i < s->n_presses; i++)
        s->press[i].peak_N = record_peak(&s->press[i].target);
    judge_range(s);
    return code ? code : check_depths(s);
}
