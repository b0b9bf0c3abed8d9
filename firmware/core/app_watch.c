/* app_watch.c: finds what is wrong, and stops by the fault that matters most. */
#include "app_internal.h"

#include "real.h"

enum {
    BAD_READINGS = 2 /* ticks */,
    FIT_TICKS = 100 /* with a signal, before an encoder that had none is trusted */
};

/* Which fault is latched where several begin in one tick: first those that make the others doubtful. */
static const uint8_t order[] = {
    PALP_WIRE_FAULT_STACK_GUARD,      PALP_WIRE_FAULT_EMERGENCY_STOP,       PALP_WIRE_FAULT_DRIVER_FAULT,
    PALP_WIRE_FAULT_ENCODER_LOST,     PALP_WIRE_FAULT_ENCODER_JUMP,         PALP_WIRE_FAULT_SENSOR_SILENT,
    PALP_WIRE_FAULT_OVER_FORCE,       PALP_WIRE_FAULT_SENSOR_SATURATED,     PALP_WIRE_FAULT_OVER_TRAVEL,
    PALP_WIRE_FAULT_OVER_TEMPERATURE, PALP_WIRE_FAULT_FOLLOWING_ERROR,      PALP_WIRE_FAULT_HOST_TIMEOUT,
    PALP_WIRE_FAULT_STREAM_OVERFLOW,  PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE, PALP_WIRE_FAULT_CONTACT_LOST,
    PALP_WIRE_FAULT_FORCE_OSCILLATES,
};

void watch_limits_begin(app *a) {
    const machine *m = &a->machine;
    a->limits = (app_limits){m->force_N, m->travel_m,        m->following_m,
                             m->fault_C, m->host_timeout_ms, m->overflow_samples};
}

static void note(app *a, uint8_t fault, bool is_the_case) {
    if (is_the_case)
        a->causes |= 1U << fault;
}

static bool noted(const app *a, uint8_t fault) {
    return (a->causes & 1U << fault) != 0;
}

/* Counts the ticks in a row for which a condition holds. */
static uint32_t lasting(uint32_t ticks, bool is_the_case) {
    return is_the_case ? ticks + 1 : 0;
}

static void stop_for(app *a) {
    for (size_t i = 0; i < sizeof order; i++)
        if (noted(a, order[i]) && supervisor_fault(&a->supervisor, order[i], a->tick))
            return;
}

/* Force on the plate. If the sensor is saturated it follows from its counts, as a tare then would hide it. */
static bool from_below(const app *a) {
    return a->saturated ? a->force.matrix[FORCE_Z][0] * (float)a->in.adc[0] > 0.0f : a->force_N > 0.0f;
}

/* A stepper that moves up to home, which reduces the force. */
static bool leaves(const app *a) {
    return a->machine.stepper && a->supervisor.state == PALP_WIRE_STATE_HOMING && !a->in.home_switch &&
           a->reference.velocity_m_s <= 0.0f && from_below(a);
}

static void watch_sensor(app *a) {
    a->silent_ticks = lasting(a->silent_ticks, !a->answering);
    a->saturated_ticks = lasting(a->saturated_ticks, a->saturated);
    note(a, PALP_WIRE_FAULT_SENSOR_SILENT, a->silent_ticks >= BAD_READINGS);
    note(a, PALP_WIRE_FAULT_SENSOR_SATURATED, a->saturated_ticks >= BAD_READINGS && !leaves(a));
    note(a, PALP_WIRE_FAULT_OVER_FORCE,
         a->answering && real_abs(a->force_N) > a->limits.force_N && !leaves(a));
}

static void watch_encoder(app *a) {
    a->encoder_ticks = lasting(a->encoder_ticks, a->in.encoder_lost);
    a->signal_ticks = lasting(a->signal_ticks, !a->in.encoder_lost);
    if (a->signal_ticks >= FIT_TICKS)
        a->unfit &= (uint8_t)~APP_ENCODER_FAILED;
    note(a, PALP_WIRE_FAULT_ENCODER_LOST, a->encoder_ticks >= BAD_READINGS);
}

/* A position that jumped or was not counted is lost in every state, even where that is no fault. */
static void watch_position(app *a) {
    float low_m, high_m;
    const bool jumped = !a->machine.stepper && real_abs(a->velocity_m_s) > a->machine.speed_m_s;
    if (jumped || noted(a, PALP_WIRE_FAULT_ENCODER_LOST))
        a->homed = a->contact_known = false;
    motion_bounds(a, &low_m, &high_m);
    note(a, PALP_WIRE_FAULT_ENCODER_JUMP, jumped);
    note(a, PALP_WIRE_FAULT_OVER_TRAVEL, a->position_m < low_m || a->position_m > high_m);
}

static bool host_is_gone(const app *a) {
    return a->host_ticks > (uint32_t)a->limits.host_timeout_ms * CONTROL_HZ / 1000;
}

/* Counted only while the motor is on. */
static void watch_motion(app *a) {
    const bool on = app_drives(a);
    const float error_m = real_abs(a->reference.position_m - a->position_m);
    a->following_ticks = lasting(a->following_ticks, on && error_m > a->limits.following_m);
    a->host_ticks = on ? a->host_ticks + a->elapsed : 0;
    /* A motor that is derated for its heat falls behind before it is too hot. */
    note(a,
         thermal_derating(&a->thermal, &a->machine) < 1.0f ? PALP_WIRE_FAULT_OVER_TEMPERATURE
                                                           : PALP_WIRE_FAULT_FOLLOWING_ERROR,
         a->following_ticks >= a->machine.following_ticks);
    note(a, PALP_WIRE_FAULT_HOST_TIMEOUT, host_is_gone(a));
    note(a, PALP_WIRE_FAULT_STREAM_OVERFLOW,
         app_moving(a) && a->stream.lost - a->lost_at_start > a->limits.overflow_samples);
}

void watch_inputs(app *a) {
    a->causes = 0;
    watch_sensor(a);
    watch_encoder(a);
    watch_position(a);
    watch_motion(a);
    note(a, PALP_WIRE_FAULT_OVER_TEMPERATURE,
         a->thermal.broken || thermal_winding_C(&a->thermal) > a->limits.winding_C);
    note(a, PALP_WIRE_FAULT_STACK_GUARD, !a->in.stack_intact);
    note(a, PALP_WIRE_FAULT_EMERGENCY_STOP, a->in.emergency_stop);
    note(a, PALP_WIRE_FAULT_DRIVER_FAULT, a->in.driver_fault);
    stop_for(a);
    if (a->supervisor.state == PALP_WIRE_STATE_READY && host_is_gone(a))
        (void)supervisor_take(&a->supervisor, SUPERVISOR_STOP);
}

/* It may begin a little outside, where the plate was pushed by hand. */
void watch_reference(app *a) {
    const float x = a->reference.position_m, from = a->from_m, most = a->limits.travel_m;
    const bool within =
        x >= (from < 0.0f ? from : 0.0f) && x <= (from > most ? from : most); /* not so a NaN */
    note(a, PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE, app_moving(a) && !within);
    note(a, a->trajectory.fault, motion_follows(a) && a->trajectory.fault != PALP_WIRE_FAULT_NONE);
    stop_for(a);
}

/* A plate outside its travel may be out of reach, so homing must work from there. */
bool watch_persists(const app *a) {
    const uint8_t fault = a->supervisor.fault;
    return a->unfit != 0 || (noted(a, fault) && fault != PALP_WIRE_FAULT_OVER_TRAVEL && !watch_pressed(a));
}

bool watch_pressed(const app *a) {
    return a->machine.stepper && from_below(a) &&
           (noted(a, PALP_WIRE_FAULT_OVER_FORCE) || noted(a, PALP_WIRE_FAULT_SENSOR_SATURATED));
}

bool watch_out_of_travel(const app *a) {
    return noted(a, PALP_WIRE_FAULT_OVER_TRAVEL);
}
