/* effect_stages.c: what the effects of the contact and of the instrument do to depth and force. */
#include "effect_internal.h"
#include "material/element.h"

#include <math.h>

static const double TWO_PI = 6.28318530717958647692;
static const double SLIDING = 1e-5; /* m/s at which Coulomb friction has half its force */

/* ---- depth ---- */

void effect_contact_offset(const double *value, double depth, double force, effect_surface *out) {
    (void)force;
    *out = (effect_surface){.depth = depth - value[0], .by_depth = 1.0, .by_value = {-1.0}};
}

void effect_frame_compliance(const double *value, double depth, double force, effect_surface *out) {
    *out = (effect_surface){
        .depth = depth - value[0] * force, .by_depth = 1.0, .by_force = -value[0], .by_value = {-force}};
}

/* depth - l (1 - exp(-depth / l)): the share of the surface that touches grows as 1 - exp(-depth / l). */
void effect_toe_region(const double *value, double depth, double force, effect_surface *out) {
    (void)force;
    *out = (effect_surface){.depth = depth, .by_depth = 1.0};
    if (depth <= 0.0)
        return;
    double x = value[0] > 0.0 ? depth / value[0] : INFINITY, missing = -expm1(-x), rest = exp(-x);
    if (value[0] > 0.0) {
        out->depth = depth - value[0] * missing;
        out->by_depth = missing;
    }
    out->by_value[0] = -missing + (rest > 0.0 ? x * rest : 0.0);
}

/* ---- force ---- */

void effect_sensor_gain(const double *value, const effect_moment *at, double input, double input_old,
                        double output_old, effect_reading *out) {
    (void)at, (void)input_old, (void)output_old;
    out->by_input = 1.0 + value[0];
    out->force = input * out->by_input;
    out->by_value[0] = input;
}

void effect_coulomb_friction(const double *value, const effect_moment *at, double input, double input_old,
                             double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    out->by_value[0] = at->velocity / (fabs(at->velocity) + SLIDING);
    out->force = input + value[0] * out->by_value[0];
}

void effect_plate_inertia(const double *value, const effect_moment *at, double input, double input_old,
                          double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    out->by_value[0] = at->acceleration;
    out->force = input + value[0] * at->acceleration;
}

/* value: amplitude, period, phase. */
void effect_drive_ripple(const double *value, const effect_moment *at, double input, double input_old,
                         double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    double turn = TWO_PI * at->depth / value[1], wave = sin(turn + value[2]), slope = cos(turn + value[2]);
    out->force = input + value[0] * wave;
    out->by_value[0] = wave;
    out->by_value[1] = -value[0] * slope * turn / value[1];
    out->by_value[2] = value[0] * slope;
}

/* T dy/dt + y = x, exact for x linear between the samples. */
void effect_sensor_lag(const double *value, const effect_moment *at, double input, double input_old,
                       double output_old, effect_reading *out) {
    double decay, mean, late = output_old - input_old, rise = input - input_old;
    out->force = input;
    if (at->step == 0.0)
        return;
    element_decay(value[0] > 0.0 ? at->step / value[0] : INFINITY, &decay, &mean);
    out->force = input + late * decay - rise * mean;
    out->by_input = 1.0 - mean;
    out->by_input_old = mean - decay;
    out->by_output_old = decay;
    out->by_value[0] = value[0] > 0.0
                           ? (late * decay * at->step / value[0] - rise * (mean - decay)) / value[0]
                           : -rise / at->step;
}

void effect_sensor_bias(const double *value, const effect_moment *at, double input, double input_old,
                        double output_old, effect_reading *out) {
    (void)at, (void)input_old, (void)output_old;
    out->force = input + value[0];
    out->by_value[0] = 1.0;
}

void effect_sensor_drift(const double *value, const effect_moment *at, double input, double input_old,
                         double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    out->force = input + value[0] * at->since;
    out->by_value[0] = at->since;
}

/* value: amplitude, frequency. */
void effect_mains_hum(const double *value, const effect_moment *at, double input, double input_old,
                      double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    double turn = TWO_PI * at->time, angle = turn * value[1] + at->hum_phase;
    out->by_value[0] = sin(angle);
    out->by_value[1] = value[0] * turn * cos(angle);
    out->force = input + value[0] * out->by_value[0];
}

void effect_force_saturation(const double *value, const effect_moment *at, double input, double input_old,
                             double output_old, effect_reading *out) {
    (void)at, (void)input_old, (void)output_old;
    out->force = input;
    if (!(value[0] > 0.0) || fabs(input) <= value[0])
        return;
    out->force = copysign(value[0], input);
    out->by_input = 0.0;
    out->by_value[0] = copysign(1.0, input);
}
