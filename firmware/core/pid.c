/* pid.c: position control of the plate: feedforward of the known forces, and a PID controller of the
 * error. */
#include "pid.h"

#include "machine.h"
#include "real.h"

/* Travel within which friction reverses; it stays constant at rest (Dahl's model). */
#define FRICTION_M 1e-5f

void pid_reset(pid *p) {
    *p = (pid){.started = false};
}

static float feed_forward(pid *p, float feed_N_m, const reference *to, float depth_m, float moving_kg,
                          float drag_Ns_m, float friction_N) {
    const float deep_m = depth_m > 0.0f ? depth_m : 0.0f, specimen_N = feed_N_m * deep_m;
    if (p->started)
        p->integral_N += (p->feed_N_m - feed_N_m) * deep_m;
    p->feed_N_m = feed_N_m;
    p->friction = real_clamp(p->friction + to->velocity_m_s * (TICK_S / FRICTION_M), -1.0f, 1.0f);
    return moving_kg * to->acceleration_m_s2 + drag_Ns_m * to->velocity_m_s + friction_N * p->friction +
           specimen_N;
}

static float slope(pid *p, float filter_Hz, float error_m) {
    float x = 2.0f * REAL_PI * TICK_S * filter_Hz;
    if (p->started)
        p->slope_m_s += ((error_m - p->last_error_m) / TICK_S - p->slope_m_s) * (x / (1.0f + x));
    p->last_error_m = error_m;
    p->started = true;
    return p->slope_m_s;
}

float pid_step(pid *p, const gains *g, float feed_N_m, const reference *to, float position_m, float depth_m,
               float moving_kg, float drag_Ns_m, float friction_N, float limit_N) {
    float error_m = to->position_m - position_m, change_N = g->ki_N_ms * error_m * TICK_S;
    float force_N = feed_forward(p, feed_N_m, to, depth_m, moving_kg, drag_Ns_m, friction_N) +
                    g->kp_N_m * error_m + g->kd_Ns_m * slope(p, g->filter_Hz, error_m) + p->integral_N +
                    change_N;
    float held_N = real_clamp(force_N, -limit_N, limit_N);
    if (force_N == held_N || (force_N > held_N) != (change_N > 0.0f))
        p->integral_N += change_N;
    return held_N;
}
