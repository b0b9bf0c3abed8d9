/* plant_make.h: makes and steps the simulated indenter. */
#ifndef PLANT_MAKE_H
#define PLANT_MAKE_H

#include "force.h"
#include "rig/plant.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <palpate/palpate.h>

static const double TICK = 1e-3;

static inline plant *make(const plant_settings *settings) {
    plant *p;
    palp_error error = {PALP_OK, ""};
    if (plant_create(settings, &p, &error)) {
        fail_msg("%s", error.text);
    }
    return p;
}

static inline plant_truth step(plant *p, int duty, bool on, plant_in *in) {
    plant_out out = {.duty = (int16_t)duty, .motor = on ? PLANT_MOTOR_ON : PLANT_MOTOR_OFF};
    plant_in unused;
    palp_error error = {PALP_OK, ""};
    if (plant_step(p, &out, in ? in : &unused, &error)) {
        fail_msg("%s", error.text);
    }
    return plant_look(p);
}

static inline plant_settings in_air(void) {
    plant_settings s = plant_settings_default();
    s.specimen = PLANT_AIR;
    s.sensor.noise_N = 0;
    return s;
}

static inline void near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance)) {
        fail_msg("%.12g, not %.12g within %g", got, wanted, tolerance);
    }
}

static inline double z_of(const plant_in *in) {
    force_sensor f;
    force_init(&f);
    return (double)force_axis(&f, in->adc, FORCE_Z);
}

/* A model of height 20 mm with one arm, as a file; of a network the figures are each element's. */
static inline const char *model_file(const char *kind, const char *more, double k, double arm, double b) {
    static char path[4096];
    const char *scratch = getenv("SCRATCH");
    snprintf(path, sizeof path, "%s/one_arm.json", scratch ? scratch : "/tmp");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "{\"palpate\": {\"model\": 1}, \"kind\": \"%s\", \"specimen\": {\"height_mm\": 20}, %s\n"
            "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [%g]},\n"
            "\"arms\": [{\"stiffness_N\": %g, \"viscosity_Ns\": %g}]}\n",
            kind, more, k, arm, b);
    fclose(file);
    return path;
}

/* Half a count of every channel, as z reads it. */
static inline double half_count_N(void) {
    force_sensor f;
    double sum = 0;
    force_init(&f);
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++) {
        sum += fabs((double)f.matrix[FORCE_Z][i]);
    }
    return 0.5 * sum + 3e-6;
}

#endif
