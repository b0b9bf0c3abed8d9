/* sweeps.h: a ramp, a dwell, an oscillation about its depth and a withdrawal into the air, of a lumped
 * material. */
#ifndef SWEEPS_H
#define SWEEPS_H

#include "recordings.h"

typedef struct sweep {
    palp_material material;
    double depth_mm, amplitude_mm, dwell_s, from_Hz, to_Hz, time_s, rate_Hz,
        noise_N; /* to_Hz = from_Hz: a sine */
    uint64_t seed;
} sweep;

/* From 1 s in the air, a ramp of 1 s, and after the oscillation half a second back into the air at twice the
 * speed. */
static inline double sweep_depth(const sweep *s, double t) {
    const double turn = 6.283185307179586, start = 2.0 + s->dwell_s, rise = log(s->to_Hz / s->from_Hz);
    if (t <= start)
        return s->depth_mm * fmin(t - 1.0, 1.0);
    t -= start;
    if (t > s->time_s)
        return fmax(s->depth_mm * (1.0 - 4.0 * (t - s->time_s)), -1.0);
    double cycles = rise > 0.0 ? s->from_Hz * s->time_s / rise * expm1(rise * t / s->time_s) : s->from_Hz * t;
    return s->depth_mm + s->amplitude_mm * sin(turn * cycles);
}

/* The specimen is 24 mm high and 12 mm in radius. The plate does not pull: where the force would, it has let
 * go. */
static inline palp_experiment *record_sweep(const sweep *s) {
    size_t n = 1 + (size_t)lround((3.5 + s->dwell_s + s->time_s) * s->rate_Hz);
    palp_experiment *e;
    uint64_t state = s->seed;
    ck_assert_int_eq(palp_experiment_create(n, &e), PALP_OK);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    palp_element_state at = {0};
    int bad = 0;
    for (size_t i = 0; i < n; i++) {
        time[i] = (double)i / s->rate_Hz;
        depth[i] = sweep_depth(s, time[i]);
        bad += palp_element_advance(&s->material, &at, fmax(depth[i], 0.0) / 24.0, i ? 1.0 / s->rate_Hz : 0.0,
                                    &at, NULL) != PALP_OK;
        force[i] = fmax(at.force_N, 0.0) + (s->noise_N > 0.0 ? s->noise_N * palp_random_normal(&state) : 0.0);
    }
    ck_assert_int_eq(bad, 0);
    palp_experiment_set_number(e, "specimen.height_mm", 24.0);
    palp_experiment_set_number(e, "specimen.radius_mm", 12.0);
    return e;
}

#endif
