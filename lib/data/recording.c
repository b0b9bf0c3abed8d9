/* recording.c: checks of a raw recording, and its phases, contact and noise, before any fit. */
#include <palpate/recording.h>

#include "base/file.h"
#include "base/statistics.h"
#include "recording_internal.h"
#include "segments_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

palp_recording_settings palp_recording_settings_default(void) {
    return (palp_recording_settings){.spike_sigma = 8.0, .clip_share = 0.002};
}

void palp_recording_free(palp_recording *r) {
    if (!r)
        return;
    free(r->time_s);
    free(r->depth_m);
    free(r->force_N);
    free(r->use);
    palp_pieces_free(&r->creep);
    memset(r, 0, sizeof *r);
}

void palp_recording_scale(palp_recording *r, double length, double force) {
    if (!r)
        return;
    double *const lengths[] = {&r->height_m, &r->deepest_m, &r->contact_m, &r->contact_sd_m};
    double *const forces[] = {&r->zero_N, &r->zero_sd_N, &r->noise_N, &r->hum_N};
    for (size_t i = 0; i < r->n; i++) {
        r->depth_m[i] *= length;
        r->force_N[i] *= force;
    }
    for (size_t i = 0; i < 4; i++) {
        *lengths[i] *= length;
        *forces[i] *= force;
    }
    r->radius_m *= sqrt(force);
}

static palp_status copy_recorded_columns(palp_recording *r, const palp_experiment *e, palp_error *error) {
    const double *t = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
                 *f = palp_experiment_column(e, "force_N");
    r->time_s = malloc((r->n + 1) * sizeof(double));
    r->depth_m = malloc((r->n + 1) * sizeof(double));
    r->force_N = malloc((r->n + 1) * sizeof(double));
    r->use = malloc(r->n + 1);
    if (!r->time_s || !r->depth_m || !r->force_N || !r->use)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < r->n; i++) {
        r->time_s[i] = t[i];
        r->depth_m[i] = 1e-3 * d[i];
        r->force_N[i] = f[i];
        r->use[i] = 1;
        if (!segments_sample_valid(t, d, f, i))
            return palp_error_set(error, PALP_ERR_INPUT,
                                  "%s: sample %zu: not finite, beyond 1e12, or time_s does not increase",
                                  r->name, i + 1);
    }
    double noise;
    return palp_segments_smooth_path(r->n, r->time_s, r->depth_m, &noise);
}

static void read_specimen_header(palp_recording *r, const palp_experiment *e,
                                 const palp_recording_settings *settings) {
    const char *text;
    double value;
    r->n = palp_experiment_rows(e);
    if (!palp_experiment_get_number(e, "specimen.height_mm", &value))
        r->height_m = 1e-3 * value;
    if (!palp_experiment_get_number(e, "specimen.radius_mm", &value))
        r->radius_m = 1e-3 * value;
    if (!palp_experiment_get_string(e, "specimen.name", &text))
        snprintf(r->specimen, sizeof r->specimen, "%s", text);
    palp_text_make_plain(r->specimen);
    r->contact_found =
        !palp_experiment_get_string(e, "contact.rule", &text) && strcmp(text, "as_recorded") != 0;
    if (!palp_experiment_get_number(e, "contact.sd_mm", &value))
        r->contact_sd_m = 1e-3 * fmax(value, 0.0);
    if (settings->height_m > 0.0)
        r->height_m = settings->height_m;
    r->faulted = !palp_experiment_get_string(e, "end.fault", &text) && strcmp(text, "samples_lost") != 0;
}

/* A length of gap, in steps, that chance exceeds less often than once in n recordings, if samples are lost
 * independently. */
static double longest_gap_by_chance(size_t n, size_t missing) {
    double part = (double)missing / (double)(n + missing);
    return missing ? 2.0 * log((double)n) / -log(part) : 0.0;
}

/* Assesses the times: clock step, gaps and unevenness. */
static palp_status examine_sample_times(palp_recording *r, double *step) {
    size_t steps = r->n - 1, odd = 0;
    palp_status status = palp_segments_clock(r->n, r->time_s, step, &r->n_missing);
    double gap_s = *step * (3.0 + longest_gap_by_chance(r->n, r->n_missing));
    for (size_t i = 0; !status && i < steps; i++) {
        double dt = r->time_s[i + 1] - r->time_s[i];
        r->n_gaps += dt > gap_s;
        if (dt > gap_s)
            r->longest_gap_s = fmax(r->longest_gap_s, dt);
        else
            odd += fabs(dt - *step) > 0.01 * *step;
    }
    r->uneven = odd > steps / 100;
    return status;
}

/* The used sample whose force differs most from that of the first used one. */
static size_t find_strongest_sample(const palp_recording *r, double first) {
    size_t at = 0;
    double most = -1.0;
    for (size_t i = 0; i < r->n; i++)
        if (r->use[i] && fabs(r->force_N[i] - first) > most) {
            most = fabs(r->force_N[i] - first);
            at = i;
        }
    return at;
}

/* Covariance of depth and force up to a sample, weighted by the plate's travel: both ends of a step count by
 * its length, so that a dwell does not count. */
static double covariance_on_way(const palp_recording *r, size_t end) {
    double way = 0.0, depth = 0.0, force = 0.0, product = 0.0;
    for (size_t i = 0; i < 2 * end; i++) {
        size_t from = i / 2, at = from + i % 2;
        double step = fabs(r->depth_m[from + 1] - r->depth_m[from]);
        step = r->use[from] && r->use[from + 1] ? step : 0.0;
        way += step;
        depth += step * r->depth_m[at];
        force += step * r->force_N[at];
        product += step * r->depth_m[at] * r->force_N[at];
    }
    return way > 0.0 ? product / way - depth / way * (force / way) : 0.0;
}

/* Does the force grow with depth, by more than noise, up to its largest value? Relaxation and unloading come
 * later. */
static palp_status check_force_direction(const palp_recording *r, palp_error *error) {
    double low = r->depth_m[0], high = low, before = r->force_N[r->use[0] ? 0 : 1];
    size_t at = find_strongest_sample(r, before);
    double strongest = r->force_N[at] - before, pressed = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        low = fmin(low, r->depth_m[i]);
        high = fmax(high, r->depth_m[i]);
        if (i < at && r->use[i] && r->depth_m[i] > 0.0) /* before a sticking plate is pulled off */
            pressed = fmax(pressed, r->force_N[i] - before);
    }
    if (!(high > low))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: depth_mm never changes: nothing was pressed",
                              r->name);
    if (!(fabs(strongest) > 6.0 * r->noise_N))
        return palp_error_set(
            error, PALP_ERR_INPUT,
            "%s: force_N never exceeds its noise: no contact, or a dead sensor (a run in air "
            "has specimen.kind \"none\")",
            r->name);
    if (covariance_on_way(r, at) < 0.0)
        return palp_error_set(error, PALP_ERR_INPUT,
                              "%s: force_N grows while depth_mm falls: depth or force has the wrong sign "
                              "(palpate import --negate depth or force)",
                              r->name);
    if ((strongest < 0.0 && !(pressed > 6.0 * r->noise_N)) || !(high > 0.0))
        return palp_error_set(
            error, PALP_ERR_INPUT,
            "%s: depth_mm and force_N fall under load: both have the wrong sign, or contact "
            "was not reached (palpate import --negate depth,force)",
            r->name);
    return PALP_OK;
}

/* Depth and force relative to contact and zero. */
static void shift_to_contact_origin(palp_recording *r) {
    r->deepest_m = -HUGE_VAL;
    for (size_t i = 0; i < r->n; i++) {
        r->depth_m[i] -= r->contact_m;
        r->force_N[i] -= r->zero_N;
        r->deepest_m = fmax(r->deepest_m, r->depth_m[i]);
    }
}

palp_recording_kind palp_recording_kind_of(const palp_pieces *pieces) {
    size_t k = 0, n = pieces ? pieces->n : 0;
    const palp_piece *piece = n ? pieces->piece : NULL;
    while (k < n && (piece[k].motion == PALP_MOTION_REST || piece[k].motion == PALP_MOTION_APPROACH))
        k++;
    bool ramp = k < n && piece[k].motion == PALP_MOTION_RAMP;
    k += ramp;
    bool dwell = k < n && piece[k].motion == PALP_MOTION_DWELL;
    k += dwell;
    while (k < n && (piece[k].motion == PALP_MOTION_REST || piece[k].motion == PALP_MOTION_UNLOAD))
        k++;
    return k < n || !(ramp || dwell) ? PALP_RECORDING_OTHER
           : dwell                   ? PALP_RECORDING_RAMP_HOLD
                                     : PALP_RECORDING_STATIC;
}

/* The sample after which the plate is only withdrawn, or r->n. */
static size_t find_plate_withdrawal(const palp_recording *r, const palp_pieces *pieces, size_t ramp_end) {
    size_t k = pieces->n;
    if (r->kind != PALP_RECORDING_OTHER)
        return segments_press_end(r->n, r->depth_m, r->deepest_m, ramp_end);
    while (k > 0 && pieces->piece[k - 1].motion == PALP_MOTION_REST)
        k--;
    return k > 0 && pieces->piece[k - 1].motion == PALP_MOTION_UNLOAD ? pieces->piece[k - 1].first : r->n;
}

static double mean_speed_between(const palp_recording *r, size_t from, size_t to) {
    return (r->depth_m[to] - r->depth_m[from]) / (r->time_s[to] - r->time_s[from]);
}

/* Is the force constant while depth goes on? A depth that comes to rest may also be ramp and hold of a
 * press; then the plate was much faster before the force became constant. At the end of a sensor's range
 * it was not. */
static bool is_creep_recording(const palp_recording *r, size_t start, size_t end) {
    static const double slower = 0.5;
    if (r->kind != PALP_RECORDING_RAMP_HOLD || r->creep.n == 0)
        return r->creep.n > 0;
    const size_t held = r->creep.piece[0].first,
                 from = start < held ? start : held - 1; /* a ramp precedes it */
    return held < end && mean_speed_between(r, held, end) < slower * mean_speed_between(r, from, held);
}

/* Finds the protocol, and where the motion starts and ends. The withdrawal after a press is left out: it
 * shows how the plate leaves, which no law of pressing describes. */
static palp_status find_motion_phases(palp_recording *r) {
    palp_pieces pieces;
    size_t start, end;
    palp_status status = palp_segments_pieces(r->n, r->time_s, r->depth_m, &pieces);
    if (status)
        return status;
    r->kind = palp_recording_kind_of(&pieces);
    segments_ramp(r->n, r->depth_m, r->deepest_m, &start, &end);
    size_t last = find_plate_withdrawal(r, &pieces, end);
    r->ramp_start_s = r->time_s[start];
    r->ramp_end_s = r->time_s[end];
    r->end_s = r->time_s[last < r->n ? last : r->n - 1];
    for (size_t i = last + 1; i < r->n; i++)
        r->use[i] = 0;
    palp_pieces_free(&pieces);
    status = palp_segments_creep(r->n, r->time_s, r->depth_m, r->force_N, &r->creep);
    if (!status && is_creep_recording(r, start, end)) {
        r->kind = PALP_RECORDING_CREEP;
        r->ramp_end_s = r->time_s[r->creep.piece[0].first];
    }
    return status;
}

/* Checks that a specimen is pressed in this recording. Makes depth and force relative to contact and zero,
 * and gives the clock's step. */
static palp_status check_and_examine_samples(palp_recording *r, const palp_experiment *experiment,
                                             const palp_recording_settings *settings, double *step,
                                             palp_error *error) {
    enum { FEWEST = 16 };
    read_specimen_header(r, experiment, settings);
    if (r->n < FEWEST)
        return palp_error_set(error, PALP_ERR_INPUT, "%s: has %zu samples, but at least 16 are needed",
                              r->name, r->n);
    if (!(r->height_m > 0.0))
        return palp_error_set(error, PALP_ERR_INPUT,
                              "%s: has no specimen.height_mm; give --specimen-height-mm", r->name);
    palp_status status = copy_recorded_columns(r, experiment, error);
    if (!status)
        status = examine_sample_times(r, step);
    if (!status)
        status = palp_segments_noise(r->n, r->time_s, *step, r->force_N, PALP_NOISE_MEDIAN, &r->noise_N);
    if (status)
        return status;
    r->n_spikes = segments_mask_spikes(r->n, r->force_N, r->noise_N, settings->spike_sigma, r->use);
    recording_mask_clipped(r, settings->clip_share);
    status = check_force_direction(r, error);
    if (status)
        return status;
    recording_find_contact(r, settings);
    shift_to_contact_origin(r);
    if (!(r->deepest_m > 0.0) || r->deepest_m >= r->height_m)
        return palp_error_set(error, PALP_ERR_INPUT,
                              "%s: the depth of %g mm exceeds the specimen's height of %g mm", r->name,
                              1e3 * r->deepest_m, 1e3 * r->height_m);
    return PALP_OK;
}

/* whole: also finds what a fit needs. */
static palp_status build_from_experiment(const palp_experiment *experiment, const char *name,
                                         const palp_recording_settings *settings, bool whole,
                                         palp_recording *r, palp_error *error) {
    double step = 0.0;
    memset(r, 0, sizeof *r);
    strncpy(r->name, name, PALP_NAME_MAX - 1);
    palp_text_make_plain(r->name);
    palp_status status = check_and_examine_samples(r, experiment, settings, &step, error);
    if (!status && whole)
        status = recording_look_at_noise(r, step);
    if (!status && whole)
        status = find_motion_phases(r);
    if (status == PALP_ERR_NO_MEMORY)
        palp_error_set(error, status, "%s: out of memory", name);
    if (status || !whole)
        palp_recording_free(r);
    return status;
}

palp_status palp_recording_prepare(const palp_experiment *experiment, const char *name,
                                   const palp_recording_settings *settings, palp_recording *recording,
                                   palp_error *error) {
    if (!experiment || !name || !settings || !recording)
        return palp_error_null(error);
    return build_from_experiment(experiment, name, settings, true, recording, error);
}

palp_status palp_recording_check(const palp_experiment *experiment, const char *name, double height_m,
                                 palp_error *error) {
    if (!experiment || !name)
        return palp_error_null(error);
    palp_recording_settings settings = palp_recording_settings_default();
    settings.height_m = height_m;
    palp_recording recording;
    return build_from_experiment(experiment, name, &settings, false, &recording, error);
}
