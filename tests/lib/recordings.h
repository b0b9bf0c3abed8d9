/* recordings.h: experiments of a lumped material with noise and disturbances, made by the closed form. */
#ifndef RECORDINGS_H
#define RECORDINGS_H

#include <palpate/palpate.h>

#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* splitmix64 and Box-Muller: the same numbers everywhere. */
static inline double uniform(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return ((double)((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
}

static inline double normal(uint64_t *state) {
    double u = uniform(state), v = uniform(state);
    return sqrt(-2.0 * log(u)) * cos(6.283185307179586 * v);
}

typedef struct take {
    palp_material material;
    double depth_mm, ramp_s, hold_s, air_s, rate_Hz, noise_N; /* ramp_s: time from contact to depth_mm */
    const char *kind;
    uint64_t seed;
} take;

/* One press of a 24 mm specimen: air at the ramp's speed, ramp, hold. */
static inline palp_experiment *record(const take *t) {
    size_t air = (size_t)lround(t->air_s * t->rate_Hz), n = air + 1 + (size_t)lround((t->ramp_s + t->hold_s) * t->rate_Hz);
    palp_experiment *e;
    uint64_t state = t->seed;
    ck_assert_int_eq(palp_experiment_create(n, &e), PALP_OK);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    palp_element_state s = {0};
    for (size_t i = 0; i < n; i++) {
        time[i] = (double)i / t->rate_Hz;
        depth[i] = t->depth_mm * fmin(((double)i - (double)air) / t->rate_Hz / t->ramp_s, 1.0);
        ck_assert_int_eq(palp_element_advance(&t->material, &s, fmax(depth[i], 0.0) / 24.0, i ? 1.0 / t->rate_Hz : 0.0,
                                              &s, NULL),
                         PALP_OK);
        force[i] = s.force_N + (t->noise_N > 0.0 ? t->noise_N * normal(&state) : 0.0);
    }
    palp_experiment_set_number(e, "specimen.height_mm", 24.0);
    palp_experiment_set_string(e, "protocol.kind", t->kind);
    return e;
}

static inline palp_recording prepare(palp_experiment *e) {
    palp_recording r;
    palp_error error = {PALP_OK, ""};
    palp_recording_settings settings = palp_recording_settings_default();
    palp_status status = palp_recording_prepare(e, "run.csv", &settings, &r, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    palp_experiment_free(e);
    return r;
}

static inline palp_material two_arms(double k_inf, double k1, double b1, double k2, double b2) {
    palp_material m = {.n_arms = 2, .arms = {{k1, b1, 0, 0}, {k2, b2, 0, 0}}};
    ck_assert_int_eq(palp_law_polynomial(1, &k_inf, &m.law), PALP_OK);
    return m;
}

#endif
