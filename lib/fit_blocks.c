/* fit_blocks.c: recordings into blocks. */
#include "file.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void fit_problem_free(fit_problem *p) {
    for (size_t r = 0; p->run && r < p->n_runs; r++) {
        free(p->run[r].time);
        free(p->run[r].strain);
        free(p->run[r].force);
        free(p->run[r].count);
    }
    free(p->run);
    memset(p, 0, sizeof *p);
}

static double strain_of(const palp_recording *rec, size_t i) {
    return fmax(rec->depth_m[i], 0.0) / rec->height_m; /* one-sided: in the air the specimen rests */
}

/* Whether a block that began at sample first may take sample i as well: it moves by less than a
 * three-hundredth of the way at an even speed, or it lasts less than a fiftieth of the time since the plate
 * last moved. A corner of the path always ends a block. */
static bool same_block(const palp_recording *rec, size_t first, size_t i, double still_since) {
    double moved = fabs(rec->depth_m[i] - rec->depth_m[first]), last = fabs(rec->depth_m[i] - rec->depth_m[i - 1]);
    double span = rec->time_s[i] - rec->time_s[first], gap = rec->time_s[i] - rec->time_s[i - 1];
    bool moving = moved >= 1e-3 * rec->deepest_m && last * (double)(i - first) >= 0.3 * moved;
    return rec->use[i] == rec->use[first] && moved < rec->deepest_m / 300.0 &&
           gap < 0.02 * (rec->time_s[i] - rec->time_s[0]) + 1e-12 &&
           (moving || span <= 0.02 * (rec->time_s[first] - still_since));
}

static void add_block(fit_run *run, const palp_recording *rec, size_t first, size_t end, bool counts) {
    double t = 0.0, e = 0.0, f = 0.0, n = (double)(end - first);
    for (size_t i = first; i < end; i++) {
        t += rec->time_s[i] - rec->time_s[0];
        e += strain_of(rec, i);
        f += rec->force_N[i];
    }
    run->time[run->n] = t / n;
    run->strain[run->n] = e / n;
    run->force[run->n] = f / n;
    run->count[run->n] = counts && rec->use[first] ? n : 0.0;
    run->n++;
}

/* Air does not speak for any parameter; with hold_only the ramp does not either. */
static bool counts(const palp_recording *rec, const palp_fit_settings *settings, size_t i) {
    if (rec->depth_m[i] <= 0.0)
        return false;
    return !(settings->hold_only && rec->kind == PALP_RECORDING_RAMP_HOLD && rec->time_s[i] < rec->ramp_end_s);
}

static palp_status make_run(fit_run *run, const palp_recording *rec, const palp_fit_settings *settings) {
    size_t bytes = (rec->n + 1) * sizeof(double);
    run->time = malloc(bytes);
    run->strain = malloc(bytes);
    run->force = malloc(bytes);
    run->count = malloc(bytes);
    if (!run->time || !run->strain || !run->force || !run->count)
        return PALP_ERR_NO_MEMORY;
    double still_since = rec->time_s[0], reference = rec->depth_m[0], peak = 0.0;
    for (size_t first = 0; first < rec->n;) {
        size_t end = first + 1;
        bool take = counts(rec, settings, first);
        if (fabs(rec->depth_m[first] - reference) > 1e-3 * rec->deepest_m) {
            reference = rec->depth_m[first];
            still_since = rec->time_s[first];
        }
        while (end < rec->n && counts(rec, settings, end) == take && same_block(rec, first, end, still_since))
            end++;
        add_block(run, rec, first, end, take);
        peak = fmax(peak, fabs(run->force[run->n - 1]));
        first = end;
    }
    run->noise = fmax(rec->noise_N, 1e-6 * peak);
    run->zero_sd = rec->zero_sd_N;
    run->end = rec->time_s[rec->n - 1] - rec->time_s[0];
    return run->noise > 0.0 ? PALP_OK : PALP_ERR_INPUT;
}

/* Bounds of relaxation times: from a few samples to three times the longest recording. */
static void bound_times(fit_problem *p, const palp_recording *recordings) {
    double shortest = HUGE_VAL, longest = 0.0;
    for (size_t r = 0; r < p->n_runs; r++) {
        const palp_recording *rec = &recordings[r];
        shortest = fmin(shortest, (rec->time_s[rec->n - 1] - rec->time_s[0]) / (double)(rec->n - 1));
        longest = fmax(longest, p->run[r].end);
    }
    p->tau_min = p->settings->tau_min_s > 0.0 ? p->settings->tau_min_s : 4.0 * shortest;
    p->tau_max = p->settings->tau_max_s > 0.0 ? p->settings->tau_max_s : 3.0 * longest;
}

static palp_status choose_spring(fit_problem *p, palp_error *error) {
    const palp_fit_settings *s = p->settings;
    double one = 1.0;
    palp_status status = PALP_OK;
    if (s->spring == PALP_SPRING_PER_RUN)
        status = palp_law_polynomial(1, &one, &p->law);
    else
        p->law = s->law;
    p->n_springs = s->spring == PALP_SPRING_PER_RUN ? p->n_runs : p->law.n;
    if (p->n_springs == 0 || s->n_arms > PALP_ARMS_MAX || fit_parameter_count(p) > FIT_PARAMETERS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "too many parameters for one fit");
    return status;
}

palp_status fit_problem_create(fit_problem *p, size_t n, const palp_recording *recordings,
                               const palp_fit_settings *settings, palp_error *error) {
    memset(p, 0, sizeof *p);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no recordings to fit");
    p->n_runs = n;
    p->settings = settings;
    p->n_arms = settings->n_arms;
    p->height_m = recordings[0].height_m;
    p->run = calloc(n, sizeof *p->run);
    palp_status status = p->run ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < n && !status; r++) {
        const palp_recording *rec = &recordings[r];
        if (fabs(rec->height_m - p->height_m) > 1e-9)
            status = palp_error_set(error, PALP_ERR_INPUT, "%s: specimen of %g mm among specimens of %g mm", rec->name,
                                    1e3 * rec->height_m, 1e3 * p->height_m);
        if (!status)
            status = make_run(&p->run[r], rec, settings);
        p->n_blocks += p->run[r].n;
        p->strain_max = fmax(p->strain_max, rec->deepest_m / rec->height_m);
    }
    if (!status)
        status = choose_spring(p, error);
    if (!status)
        bound_times(p, recordings);
    if (!status && p->n_blocks <= fit_parameter_count(p))
        status = palp_error_set(error, PALP_ERR_INPUT, "%s: fewer samples than parameters", recordings[0].name);
    if (status)
        fit_problem_free(p);
    return status;
}
