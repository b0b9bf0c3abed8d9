/* simulate_sensor.c: what a tester makes of palpate simulate's run: even samples, free air, noise, faults. */
#include "simulate.h"

#include <math.h>
#include <palpate/random.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "simulate";
static const double PI = 3.14159265358979323846;

enum { SAMPLES_MAX = 100000000 };

double simulate_air_rate(const simulate_options *o) {
    return o->protocol == 1 ? o->depth_mm / o->ramp_s : o->rate_mm_s;
}

/* Time of sample k on the path, which starts after the air. */
static double sample_time(const simulate_options *o, size_t k) {
    return (double)k / o->sample_Hz - o->air_s;
}

static size_t sample_count(const simulate_options *o, const palp_path *path) {
    return (size_t)floor((o->air_s + path->time_s[path->n - 1]) * o->sample_Hz * (1 + 1e-12)) + 1;
}

/* Merges corners of the path and samples in order; a sample next to a corner becomes that corner. */
static size_t merge_times(const simulate_options *o, const palp_path *path, double *time_s) {
    double near = 1e-6 / o->sample_Hz;
    size_t n = 0, k = 0, count = sample_count(o, path);
    for (size_t i = 0; i < path->n; i++) {
        for (; k < count && sample_time(o, k) <= path->time_s[i] + near; k++)
            if (sample_time(o, k) > path->time_s[0] + near && sample_time(o, k) < path->time_s[i] - near)
                time_s[n++] = sample_time(o, k);
        time_s[n++] = path->time_s[i];
    }
    return n;
}

static palp_status resample(const simulate_options *o, palp_path *path) {
    palp_path finer;
    size_t most = sample_count(o, path) + path->n;
    double *work = malloc(2 * most * sizeof *work);
    if (!work)
        return PALP_ERR_NO_MEMORY;
    double *time_s = work, *value = work + most;
    size_t n = merge_times(o, path, time_s);
    for (size_t i = 0; i < n; i++)
        value[i] = palp_path_at(path, time_s[i]);
    palp_status status = palp_path_create(n, time_s, value, &finer);
    free(work);
    if (status)
        return status;
    if (path->force_N) {
        finer.force_N = finer.depth_m;
        finer.depth_m = NULL;
    }
    palp_path_free(path);
    *path = finer;
    return PALP_OK;
}

int simulate_resample(const simulate_options *o, palp_path *path) {
    if (o->sample_Hz <= 0)
        return CLI_OK;
    if ((o->air_s + path->time_s[path->n - 1]) * o->sample_Hz > SAMPLES_MAX)
        return cli_usage_error(NAME, "%g s at %g Hz are too many samples; lower --sample-Hz",
                               o->air_s + path->time_s[path->n - 1], o->sample_Hz);
    palp_status status = resample(o, path);
    return status ? cli_status_of(NAME, o->sample_Hz > 0 ? "--sample-Hz" : o->model, status, NULL) : CLI_OK;
}

palp_status simulate_samples(const simulate_options *o, const palp_path *path, size_t *n, double **time_s) {
    *n = sample_count(o, path);
    *time_s = malloc(*n * sizeof **time_s);
    for (size_t k = 0; *time_s && k < *n; k++)
        (*time_s)[k] = (double)k / o->sample_Hz;
    return *time_s ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* Keeps only the regular samples, after those in air. */
static palp_status pick(const simulate_options *o, const palp_path *path, record *curve) {
    record all = *curve;
    double rate_m_s = 1e-3 * simulate_air_rate(o), near = 1e-6 / o->sample_Hz;
    palp_status status = PALP_OK;
    memset(curve, 0, sizeof *curve);
    for (size_t k = 0, i = 0, count = sample_count(o, path); status == PALP_OK && k < count; k++) {
        double t = sample_time(o, k), at_s = (double)k / o->sample_Hz;
        while (i + 1 < all.n && all.time_s[i] < t - near)
            i++;
        if (t < -near)
            status = record_add(curve, at_s, rate_m_s * t, 0);
        else
            status = record_add(curve, at_s, all.depth_m[i], all.force_N[i]);
    }
    record_free(&all);
    return status;
}

static void add_spikes(const cli_list *spikes, record *c) {
    for (size_t j = 0; j + 1 < spikes->n; j += 2) {
        size_t nearest = 0;
        for (size_t i = 1; i < c->n; i++)
            if (fabs(c->time_s[i] - spikes->value[j]) < fabs(c->time_s[nearest] - spikes->value[j]))
                nearest = i;
        c->force_N[nearest] += spikes->value[j + 1];
    }
}

static void drop(const cli_list *gaps, record *c) {
    for (size_t j = 0; j + 1 < gaps->n; j += 2) {
        size_t kept = 0;
        for (size_t i = 0; i < c->n; i++) {
            if (c->time_s[i] < gaps->value[j] || c->time_s[i] >= gaps->value[j + 1]) {
                c->time_s[kept] = c->time_s[i];
                c->depth_m[kept] = c->depth_m[i];
                c->force_N[kept++] = c->force_N[i];
            }
        }
        c->n = kept;
    }
}

/* Rounds to nanonewtons, or finer for small noise: digits far below the noise only lengthen the file. */
static double round_to_noise(double x, double noise_N) {
    double per_N = fmax(1e9, pow(10, 6 - floor(log10(noise_N))));
    return rint(x * per_N) / per_N;
}

static void disturb(const simulate_options *o, record *c) {
    for (size_t i = 0; i < c->n; i++) {
        if (o->hum_N > 0)
            c->force_N[i] += o->hum_N * sin(2 * PI * SIMULATE_HUM_HZ * c->time_s[i]);
        if (o->noise_N > 0)
            c->force_N[i] =
                round_to_noise(c->force_N[i] + o->noise_N * palp_random_normal_at(o->seed, i), o->noise_N);
    }
    add_spikes(&o->spikes, c);
    for (size_t i = 0; o->clip_N > 0 && i < c->n; i++)
        c->force_N[i] = fmin(fmax(c->force_N[i], -o->clip_N), o->clip_N);
    drop(&o->gaps, c);
}

int simulate_sense(const simulate_options *o, simulation *s) {
    bool picked = o->sample_Hz <= 0 || s->recorded;
    palp_status status = !picked ? pick(o, &s->path, &s->curve) : PALP_OK;
    if (status)
        return cli_status_of(NAME, o->sample_Hz > 0 ? "--sample-Hz" : o->model, status, NULL);
    disturb(o, &s->curve);
    return s->curve.n > 0 ? CLI_OK : cli_usage_error(NAME, "--drop leaves no sample");
}

/* Reads pairs of numbers; of a gap the second must be larger. */
static int pairs(const char *option, const char *text, bool rising, cli_list *list) {
    bool good = !text || (cli_read_list(text, list) && list->n % 2 == 0);
    for (size_t j = 0; good && rising && j + 1 < list->n; j += 2)
        good = list->value[j] < list->value[j + 1];
    return good ? CLI_OK
                : cli_usage_error(NAME, "--%s must be pairs of numbers (%s), not \"%s\"", option,
                                  rising ? "T0,T1 with T0 before T1" : "T,F", text);
}

int simulate_sensor_check(simulate_options *o) {
    if (o->sample_Hz > 0 && (o->like || o->dt_ms > 0))
        return cli_usage_error(NAME, "--sample-Hz does not go with --%s", o->like ? "like" : "dt-ms");
    if (o->air_s > 0 && (o->sample_Hz <= 0 || o->protocol == 3))
        return cli_usage_error(NAME, "--air-s %s",
                               o->protocol == 3 ? "does not go with --protocol creep" : "needs --sample-Hz");
    if (o->seed != SIZE_MAX && o->noise_N <= 0)
        return cli_usage_error(NAME, "--seed needs --noise-N");
    o->seed = o->seed == SIZE_MAX ? 1 : o->seed;
    int code = pairs("drop", o->drop, true, &o->gaps);
    return code ? code : pairs("spike", o->spike, false, &o->spikes);
}
