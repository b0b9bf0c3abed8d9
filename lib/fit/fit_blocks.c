/* fit_blocks.c: recordings into blocks. */
#include "base/file.h"
#include "base/statistics.h"
#include "data/recording_internal.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void fit_problem_free(fit_problem *p) {
    arena_free(&p->memory);
    memset(p, 0, sizeof *p);
}

static double strain_of(const palp_recording *rec, size_t i) {
    return (rec->depth_m[i] > 0.0 ? rec->depth_m[i] : 0.0) /
           rec->height_m; /* one-sided: in the air the specimen rests */
}

/* Adds the mean of its samples. */
static void add_block(fit_run *run, const palp_recording *rec, const recording_block *block) {
    const size_t first = block->first;
    double t = 0.0, e = 0.0, f = 0.0, n = (double)(block->end - first), strain = strain_of(rec, first);
    for (size_t i = first; i < block->end; i++) {
        t += rec->time_s[i] - rec->time_s[0];
        e += strain_of(rec, i) - strain;
        f += rec->force_N[i];
    }
    run->time[run->n] = t / n;
    run->strain[run->n] = strain + e / n; /* in a dwell, of every block the same to the bit */
    run->force[run->n] = f / n;
    run->count[run->n] = block->counts ? n : 0.0;
    run->n++;
}

bool fit_counts(const palp_recording *rec, const palp_characterize_settings *settings, size_t i) {
    if (!rec->use[i] || rec->depth_m[i] <= 0.0)
        return false;
    return !(settings->dwell_only && rec->kind == PALP_RECORDING_RAMP_HOLD &&
             rec->time_s[i] < rec->ramp_end_s);
}

/* Blocks of one recording. The strain is linear between what is there. */
static palp_status cut(fit_run *run, const palp_recording *rec, const palp_characterize_settings *settings) {
    recording_block *block = malloc(rec->n * sizeof *block);
    unsigned char *counts = malloc(rec->n);
    size_t n = 0;
    palp_status status = block && counts ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < rec->n && !status; i++)
        counts[i] = fit_counts(rec, settings, i);
    if (!status)
        status = recording_cut(rec, 300.0, counts, &n, block);
    for (size_t i = 0; i < n && !status; i++)
        add_block(run, rec, &block[i]);
    free(block);
    free(counts);
    return status;
}

/* The encoder's count: the least step between neighbours, or difference of two steps, of which all steps are
 * multiples; 0 = the depth is not in counts. A path of equal steps has such a count too, but its step changes
 * at a few corners only. */
static double count_of(const palp_recording *rec) {
    const double rounding = 1e-9 * rec->deepest_m, whole = 1e-3;
    double least = HUGE_VAL, before = 0.0;
    size_t changes = 0;
    for (size_t i = 1; i < rec->n; i++) {
        double step = rec->depth_m[i] - rec->depth_m[i - 1], size = fabs(step), change = fabs(step - before);
        least = size > rounding && size < least ? size : least;
        least = change > rounding && change < least ? change : least;
        changes += change > rounding;
        before = step;
    }
    if (changes <= rec->n / 500 + 4)
        return 0.0;
    for (size_t i = 1; i < rec->n; i++) {
        double counts = (rec->depth_m[i] - rec->depth_m[i - 1]) / least;
        if (!(fabs(counts - round(counts)) <= whole))
            return 0.0;
    }
    return least;
}

static palp_status make_run(arena *memory, fit_run *run, const palp_recording *rec,
                            const palp_characterize_settings *settings) {
    double peak = 0.0, **arrays[] = {&run->time, &run->strain, &run->force, &run->count};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = arena_take(memory, rec->n + 1, sizeof **arrays[i]);
    if (memory->failed)
        return PALP_ERR_NO_MEMORY;
    palp_status status = cut(run, rec, settings);
    if (status)
        return status;
    for (size_t i = 0; i < run->n; i++)
        peak = fmax(peak, fabs(run->force[i]));
    run->noise = fmax(rec->noise_N, 1e-6 * peak);
    run->zero_sd = rec->zero_sd_N;
    bool exact =
        rec->contact_rule == PALP_CONTACT_FREE_AIR && rec->contact_m == 0.0; /* nothing spoke against it */
    run->contact_sd = exact ? 0.0 : rec->contact_sd_m / rec->height_m;
    run->air_sd = exact ? rec->contact_sd_m / rec->height_m : 0.0;
    run->end = rec->time_s[rec->n - 1] - rec->time_s[0];
    run->peak = peak;
    run->place_sd = count_of(rec) / rec->height_m / sqrt(12.0);
    run->leaves = fit_leaves(rec);
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

/* Times of the arms of a fractional element, which extends to faster times than a free arm could be
 * identified at. */
static palp_status choose_times(fit_problem *p, palp_error *error) {
    const palp_characterize_settings *s = p->settings;
    const double faster = 1.0, step = (log10(p->tau_max / p->tau_min) + faster) / (PALP_ARMS_MAX - 1);
    p->n_arms = s->n_arms;
    if (s->arms == PALP_ARMS_FREE)
        return PALP_OK;
    if (s->spring == PALP_SPRING_PER_RUN)
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "a fractional element goes with one law of all recordings");
    p->n_arms = p->n_times = PALP_ARMS_MAX;
    for (size_t j = 0; j < p->n_times; j++)
        p->time[j] = p->tau_min * pow(10.0, step * (double)j - faster);
    return PALP_OK;
}

static palp_status choose_spring(fit_problem *p, palp_error *error) {
    const palp_characterize_settings *s = p->settings;
    double one = 1.0;
    palp_status status = PALP_OK;
    if (s->spring == PALP_SPRING_PER_RUN)
        status = palp_law_polynomial(1, &one, &p->law);
    else
        p->law = s->law;
    p->n_springs = s->spring == PALP_SPRING_PER_RUN ? p->n_runs : p->law.n;
    if (p->n_springs == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a law without coefficients cannot be fitted");
    if (p->n_arms > PALP_ARMS_MAX || fit_parameter_count(p) > FIT_PARAMETERS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "too many parameters for one fit");
    return status;
}

palp_status fit_problem_create(fit_problem *p, size_t n, const palp_recording *recordings,
                               const palp_characterize_settings *settings, palp_error *error) {
    memset(p, 0, sizeof *p);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no recordings to fit");
    p->n_runs = n;
    p->stop_relative = 1e-7;
    p->settings = settings;
    p->height_m = recordings[0].height_m;
    p->run = arena_take(&p->memory, n, sizeof *p->run);
    palp_status status = p->run ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < n && !status; r++) {
        const palp_recording *rec = &recordings[r];
        if (fabs(rec->height_m - p->height_m) > 1e-6 * p->height_m)
            status = palp_error_set(error, PALP_ERR_INPUT, "%s: specimen of %g mm among specimens of %g mm",
                                    rec->name, 1e3 * rec->height_m, 1e3 * p->height_m);
        if (!status)
            status = make_run(&p->memory, &p->run[r], rec, settings);
        p->n_blocks += p->run[r].n;
        p->strain_max = fmax(p->strain_max, rec->deepest_m / rec->height_m);
        p->stiffness = fmax(p->stiffness, p->run[r].peak * rec->height_m / rec->deepest_m);
    }
    if (!status) {
        bound_times(p, recordings);
        status = choose_times(p, error);
    }
    if (!status)
        status = choose_spring(p, error);
    if (!status && p->n_blocks <= fit_parameter_count(p))
        status =
            palp_error_set(error, PALP_ERR_INPUT, "%s: fewer samples than parameters", recordings[0].name);
    if (status)
        fit_problem_free(p);
    return status;
}
