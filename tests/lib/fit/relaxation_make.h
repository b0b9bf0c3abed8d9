/* relaxation_make.h: materials and records of the tests of the calibration of arms. */
#ifndef RELAXATION_MAKE_H
#define RELAXATION_MAKE_H

#include "fit/calibrate_internal.h"
#include "cube.h"

#include <palpate/path.h>

enum { TARGETS = 12, RAMP_SAMPLES = 10, SAMPLES = 36, MOST_COLUMNS = 1 + 4 * PALP_ARMS_MAX };

/* Records of ramps and holds at the depths of Chapter 4, 1.5, 2 ... 7 mm: 1 s up, held for 200 s. */
typedef struct records {
    double time_s[SAMPLES], force_N[TARGETS][SAMPLES];
    palp_target target[TARGETS];
} records;

static inline void records_make(records *r, double weight) {
    for (size_t i = 0; i < SAMPLES; i++) {
        double share = ((double)i - RAMP_SAMPLES) / (SAMPLES - RAMP_SAMPLES - 1.0);
        r->time_s[i] =
            i < RAMP_SAMPLES ? (double)(i + 1) / RAMP_SAMPLES : 1.0 + 0.02 * pow(200.0 / 0.02, share);
    }
    for (size_t t = 0; t < TARGETS; t++) {
        r->target[t] =
            (palp_target){.n = SAMPLES, .time_s = r->time_s, .force_N = r->force_N[t], .weight = weight};
        ck_assert_int_eq(palp_path_ramp_hold(1e-3 * (1.5 + 0.5 * (double)t), 1.0, 200.0, &r->target[t].path),
                         PALP_OK);
    }
}

static inline void records_free(records *r) {
    for (size_t t = 0; t < TARGETS; t++)
        palp_path_free(&r->target[t].path);
}

/* Eq. 4.3 with the arms of Table 4.5. */
static inline palp_material lumped_n2(void) {
    palp_material material = cube_polynomial(5, LUMPED_LAW);
    material.n_arms = 2;
    material.arms[0] = (palp_arm){.stiffness_N = 2.5847711, .viscosity_Ns = 3.6146000};
    material.arms[1] = (palp_arm){.stiffness_N = 0.68530360, .viscosity_Ns = 23.964533};
    return material;
}

/* What the static stage finds for 27 nodes (a quartic that meets Eq. 4.3 within 1.3 N in the 2-norm), with
 * the lumped arms made smaller as a network needs them. */
static inline palp_material network_n2(void) {
    const double quartic[5] = {0.4876, -1.0629, 23.6251, -96.7201, 152.6749};
    palp_material material = cube_polynomial(5, quartic), lumped = lumped_n2();
    material.n_arms = 2;
    for (size_t j = 0; j < 2; j++)
        material.arms[j] = (palp_arm){.stiffness_N = 0.07 * lumped.arms[j].stiffness_N,
                                      .viscosity_Ns = 0.07 * lumped.arms[j].viscosity_Ns};
    return material;
}

static inline palp_network *network_of(const palp_material *material) {
    palp_network_settings settings = palp_network_settings_default();
    settings.tolerance = 1e-12;
    return cube_network(3, material, &settings);
}

#endif
