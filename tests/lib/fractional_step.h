/* fractional_step.h: the recording of a fractional Zener solid after a step, by a closed form. */
#ifndef FRACTIONAL_STEP_H
#define FRACTIONAL_STEP_H

#include "recordings.h"

/* exp(z^2) erfc(z): the relaxation of a fractional Maxwell element whose exponent is a half, at z = sqrt(t /
 * tau). */
static inline double relaxes(double z) {
    return z < 5.0 ? exp(z * z) * erfc(z)
                   : (1.0 - 0.5 / (z * z) + 0.75 / (z * z * z * z)) / (z * sqrt(3.14159265358979323846));
}

/* The exact response to a step of a tenth of the height, held for 200 s, in any units. The solid is a spring
 * of 8 N with an arm of 5 N and 2 s. */
static inline palp_recording step(double force, double time, double noise) {
    enum { SAMPLES = 20001 };
    palp_recording r = {.name = "step",
                        .height_m = 0.024,
                        .n = SAMPLES,
                        .deepest_m = 0.0024,
                        .kind = PALP_RECORDING_RAMP_HOLD,
                        .noise_N = force * noise,
                        .contact_rule = PALP_CONTACT_GIVEN};
    uint64_t state = 3;
    r.time_s = calloc(SAMPLES, sizeof(double));
    r.depth_m = calloc(SAMPLES, sizeof(double));
    r.force_N = calloc(SAMPLES, sizeof(double));
    r.use = malloc(SAMPLES);
    ck_assert(r.time_s && r.depth_m && r.force_N && r.use);
    for (size_t i = 0; i < SAMPLES; i++) {
        double t = 0.01 * (double)i;
        r.time_s[i] = time * t;
        r.depth_m[i] = r.deepest_m;
        r.force_N[i] =
            force * (0.1 * (8.0 + 5.0 * relaxes(sqrt(t / 2.0))) + noise * palp_random_normal(&state));
        r.use[i] = 1;
    }
    return r;
}

#endif
