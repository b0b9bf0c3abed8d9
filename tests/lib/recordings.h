/* recordings.h: experiments of a lumped material with noise, whose answer is known, and their fits. */
#ifndef RECORDINGS_H
#define RECORDINGS_H

#include <palpate/palpate.h>

#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct take {
    palp_material material;
    double depth_mm, ramp_s, hold_s, air_s, rate_Hz, noise_N; /* ramp_s: time from contact to depth_mm */
    const char *kind;
    uint64_t seed;
} take;

/* One press of a 24 mm specimen: air at the ramp's speed, ramp, hold. */
static inline palp_experiment *record(const take *t) {
    size_t air = (size_t)lround(t->air_s * t->rate_Hz),
           n = air + 1 + (size_t)lround((t->ramp_s + t->hold_s) * t->rate_Hz);
    palp_experiment *e;
    uint64_t state = t->seed;
    ck_assert_int_eq(palp_experiment_create(n, &e), PALP_OK);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    palp_element_state s = {0};
    int bad = 0; /* one assertion for all: each costs more than a sample */
    for (size_t i = 0; i < n; i++) {
        time[i] = (double)i / t->rate_Hz;
        depth[i] = t->depth_mm * fmin(((double)i - (double)air) / t->rate_Hz / t->ramp_s, 1.0);
        double strain = fmax(depth[i], 0.0) / 24.0;
        bad +=
            palp_element_advance(&t->material, &s, strain, i ? 1.0 / t->rate_Hz : 0.0, &s, NULL) != PALP_OK;
        force[i] = s.force_N + (t->noise_N > 0.0 ? t->noise_N * palp_random_normal(&state) : 0.0);
    }
    ck_assert_int_eq(bad, 0);
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

static inline palp_lumped_fit fit(size_t n, const palp_recording *r, palp_characterize_settings settings) {
    palp_lumped_fit f;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_characterize_fit(n, r, &settings, &f, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    return f;
}

static inline palp_characterize_settings with_arms(size_t n_arms) {
    palp_characterize_settings s = palp_characterize_settings_default();
    s.n_arms = n_arms;
    return s;
}

static inline palp_characterize_settings with_law(palp_law law, size_t n_arms) {
    palp_characterize_settings s = with_arms(n_arms);
    s.spring = PALP_SPRING_LAW;
    s.law = law;
    return s;
}

static inline palp_law polynomial(size_t n, const double *c) {
    palp_law law;
    ck_assert_int_eq(palp_law_polynomial(n, c, &law), PALP_OK);
    return law;
}

static inline void free_all(size_t n, palp_recording *r) {
    for (size_t i = 0; i < n; i++)
        palp_recording_free(&r[i]);
}

/* Eq. 4.3, ascending powers, with the arms of Table 4.5. */
static const double LAW[5] = {8.18, -0.70, 47.47, -131.36, 146.89};

static inline palp_material phantom(void) {
    palp_material m = two_arms(1.0, 2.5847711, 3.6146, 0.6853036, 23.964533);
    m.law = polynomial(5, LAW);
    return m;
}

#endif
