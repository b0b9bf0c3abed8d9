/* segments_contact.c: air and contact of a press about which nothing is known: zero force, direction of the
 * motion, drift of the load cell. recording_contact.c has another task: it checks a depth 0 that is said to
 * be contact. */
#include "base/statistics.h"
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WINDOW = 11, ROUNDS = 5, AIR_LEAST = 20, REST_LEAST = 5 };

static const double BEYOND = 4.0; /* distance of a running mean from the air's force at contact, in sds */
static const double DOUBTFUL =
    2.0; /* distance at which contact may have begun, in sds: gives the uncertainty */
static const double APPROACH_AIR = 0.8; /* share of an approach that is certainly air */
static const double RESTING = 1e-3;     /* relative to the travel: not moving yet */
static const double FIRST_PART = 0.05;  /* share of the travel whose slope converts force to travel */

static size_t smaller_sample_index(size_t a, size_t b) {
    return a < b ? a : b;
}

static void compute_running_mean(palp_press *p) {
    size_t half = smaller_sample_index(p->n / 20, WINDOW / 2);
    p->window = 2 * half + 1;
    for (size_t i = 0; i < p->n; i++) {
        size_t from = i > half ? i - half : 0, to = smaller_sample_index(i + half, p->n - 1);
        p->mean_N[i] = 0.0;
        for (size_t k = from; k <= to; k++)
            p->mean_N[i] += p->force_N[k] / (double)(to - from + 1);
    }
}

palp_status palp_press_create(size_t n, const double *time_s, const double *depth, const double *force_N,
                              palp_press *press) {
    if (!time_s || !depth || !force_N || !press)
        return PALP_ERR_ARGUMENT;
    *press = (palp_press){.n = n, .time_s = time_s, .depth = depth, .force_N = force_N};
    press->mean_N = malloc(n * sizeof *press->mean_N);
    double step_s;
    size_t missing;
    palp_status status =
        press->mean_N ? palp_segments_clock(n, time_s, &step_s, &missing) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = palp_segments_noise(n, time_s, 10.0 * step_s, force_N, PALP_NOISE_TRIMMED, &press->noise_N);
    if (status) {
        palp_press_free(press);
        return status;
    }
    compute_running_mean(press);
    for (size_t i = 1; i < n; i++)
        if (fabs(press->mean_N[i] - press->mean_N[0]) > fabs(press->mean_N[press->peak] - press->mean_N[0]))
            press->peak = i;
    return PALP_OK;
}

void palp_press_free(palp_press *press) {
    if (!press)
        return;
    free(press->mean_N);
    memset(press, 0, sizeof *press);
}

double palp_air_force(const palp_air *air, double time_s) {
    return air ? air->level_N + air->drift_N_s * time_s : NAN;
}

/* Fits the level (and the drift, if drifting) of the first n samples. */
static void fit_line_to_air(const palp_press *p, size_t n, bool drifting, double least_sd, palp_air *air) {
    statistics_line line = statistics_line_fit(n, p->time_s, p->force_N, NULL);
    double squares = 0.0;
    air->drift_N_s = drifting ? line.slope : 0.0;
    air->level_N = line.mean_y - air->drift_N_s * line.mean_x;
    for (size_t i = 0; i < n; i++) {
        double off = p->mean_N[i] - palp_air_force(air, p->time_s[i]);
        squares += off * off;
    }
    air->sd_N = fmax(sqrt(squares / (double)n), least_sd);
}

/* The sample after the last one before the peak whose running mean is within so many sds of the air. */
static size_t find_departure_from_air(const palp_press *p, const palp_air *air, double sds) {
    size_t i = p->peak;
    while (i > 0 && fabs(p->mean_N[i] - palp_air_force(air, p->time_s[i])) > sds * air->sd_N)
        i--;
    return i == p->peak ? p->peak : i + 1;
}

/* Uncertainty of contact: from where it may have begun; the running mean is early by up to half its
 * window. */
static double contact_depth_uncertainty(const palp_press *p, const palp_air *air) {
    size_t early = smaller_sample_index(find_departure_from_air(p, air, DOUBTFUL), air->contact);
    size_t late = smaller_sample_index(air->contact + p->window / 2, p->n - 1);
    return fmax(fabs(p->depth[air->contact] - p->depth[early]),
                fabs(p->depth[late] - p->depth[air->contact]));
}

/* Fits the level of air again to the samples found to be air, at most ROUNDS times. */
palp_air palp_press_air(const palp_press *p, bool approach) {
    if (!p)
        return (palp_air){0};
    palp_air air = {0};
    double least_sd =
        fmax(p->noise_N / sqrt((double)p->window), 1e-6 * fabs(p->mean_N[p->peak] - p->mean_N[0]));
    size_t rest = palp_press_rest(p);
    size_t n = smaller_sample_index(approach             ? (size_t)(APPROACH_AIR * (double)p->peak)
                                    : rest >= REST_LEAST ? rest
                                                         : 5 * p->window,
                                    p->peak);
    fit_line_to_air(p, n > 2 ? n : 2, approach, least_sd, &air);
    air.contact = find_departure_from_air(p, &air, BEYOND);
    for (int round = 0; !approach && round < ROUNDS; round++) {
        if (air.contact <= 3 * p->window || air.contact >= p->peak)
            break;
        fit_line_to_air(p, air.contact - p->window, false, least_sd, &air);
        air.contact = find_departure_from_air(p, &air, BEYOND);
    }
    air.contact_sd = contact_depth_uncertainty(p, &air);
    air.contact_depth = p->depth[air.contact];
    if (!approach && air.contact < p->peak)
        segments_refine_contact(p, &air);
    air.seen = approach ? air.contact < p->peak : segments_air_seen(p, &air);
    return air;
}

/* A trend shows in the means of the outer thirds. */
bool palp_press_starts_in_air(const palp_press *p) {
    if (!p)
        return false;
    size_t n = smaller_sample_index(5 * p->window, p->n), third = n / 3;
    double squares = 0.0, level = statistics_mean(p->force_N, n);
    if (n < AIR_LEAST)
        return false;
    for (size_t i = 0; i < n; i++)
        squares += (p->force_N[i] - level) * (p->force_N[i] - level);
    double trend = statistics_mean(p->force_N + n - third, third) - statistics_mean(p->force_N, third);
    return fabs(trend) <= BEYOND * sqrt(squares / (double)n / (double)third);
}

/* First sample that is so far from the start. */
static size_t find_first_moved_sample(const palp_press *p, double by) {
    size_t i = 0;
    while (i + 1 < p->n && fabs(p->depth[i] - p->depth[0]) <= by)
        i++;
    return i;
}

size_t palp_press_rest(const palp_press *p) {
    return p ? find_first_moved_sample(p, RESTING * fabs(p->depth[p->peak] - p->depth[0])) : 0;
}

double palp_press_travel(const palp_press *p, double force_N) {
    if (!p)
        return NAN;
    double travel = p->depth[p->peak] - p->depth[0];
    size_t from = palp_press_rest(p), to = find_first_moved_sample(p, FIRST_PART * fabs(travel));
    double rise_N = p->mean_N[to] - p->mean_N[from], way = p->depth[to] - p->depth[from];
    if (rise_N * way <= 0.0) {
        rise_N = p->mean_N[p->peak] - p->mean_N[0];
        way = travel;
    }
    return rise_N == 0.0 ? 0.0 : fabs(force_N * way / rise_N);
}
