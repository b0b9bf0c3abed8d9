/* app.c: a control tick, from the sensors to the motor's output. */
#include "app_internal.h"

#include "real.h"

#include <string.h>

#define DUTY_FULL 32767.0f
enum { LEVEL_TICKS = 20 };

void app_init(app *a, const machine *m, const app_identity *who, uint8_t reset_cause, uint8_t failed) {
    memset(a, 0, sizeof *a);
    a->machine = *m;
    a->standard = m;
    memcpy(a->gains, gains_table, sizeof a->gains);
    a->identity = *who;
    /* A clock that is 1 % wrong would change every time constant unnoticed, so such a board moves nothing. A
     * sensor that failed to start counts as silent. */
    a->unfit = failed & (APP_CLOCK_FAILED | APP_ENCODER_FAILED);
    watch_limits_begin(a);
    a->softness = GAINS_MIDDLE;
    a->softness_auto = true;
    stream_init(&a->stream, a->transmit, APP_TRANSMIT);
    force_begin(&a->force, m->count_nN);
    a->trajectory.force_w_s = trajectory_force_w_s(m->force_delay_s);
    if (reset_cause == APP_RESET_WATCHDOG)
        (void)supervisor_fault(&a->supervisor, PALP_WIRE_FAULT_WATCHDOG_RESET, 0);
    if (reset_cause == APP_RESET_STACK)
        (void)supervisor_fault(&a->supervisor, PALP_WIRE_FAULT_STACK_GUARD, 0);
    if (reset_cause == APP_RESET_BROWN_OUT)
        (void)supervisor_fault(&a->supervisor, PALP_WIRE_FAULT_BROWN_OUT, 0);
}

bool app_listens(const app *a) {
    return !a->command_taken && !a->stream.due;
}

void app_receive(app *a, uint8_t byte) {
    palp_wire_message command;
    if (!palp_wire_decode(&a->decoder, byte, &command) || command.type >= PALP_WIRE_TYPE_ACK)
        return;
    a->host_ticks = 0;
    command_take(a, &command);
}

static void sense_position(app *a, const app_inputs *in) {
    const int32_t before = a->sensed ? a->in.position : in->position;
    a->velocity_m_s = (float)(in->position - before) * a->machine.count_m / (TICK_S * (float)a->elapsed);
    a->position_m = (float)(in->position - a->home) * a->machine.count_m;
}

/* A sensor that is not connected answers with the same level on its line all the time. A quiet one in the air
 * may do so for some ticks. */
static bool all_channels(const int16_t adc[PALP_WIRE_CHANNELS], int16_t value) {
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        if (adc[i] != value)
            return false;
    return true;
}

static void sense_force(app *a, const app_inputs *in) {
    const bool level = a->machine.count_nN == 0 && (all_channels(in->adc, 0) || all_channels(in->adc, -1));
    a->level_ticks = level ? a->level_ticks + 1 : 0;
    a->answering = !in->sensor_silent && a->level_ticks < LEVEL_TICKS;
    a->saturated = a->answering && force_saturated(in->adc);
    if (!a->answering)
        return;
    force_tare_add(&a->force, in->adc);
    a->force_N = force_axis(&a->force, in->adc, FORCE_Z);
}

static void sense(app *a, const app_inputs *in) {
    a->elapsed = 1 + (a->sensed ? in->missed : 0); /* no tick can be missed before the first */
    a->tick += a->elapsed;
    a->missed_ticks += a->elapsed - 1;
    if (in->cost > a->cost_most)
        a->cost_most = in->cost;
    sense_position(a, in);
    sense_force(a, in);
    thermal_step(&a->thermal, &a->machine, a->duty, a->velocity_m_s, in->thermistor);
    a->in = *in;
    a->sensed = true;
}

/* The motor's force for this tick's reference, as a share of its full force. */
static float drive(app *a) {
    const machine *m = &a->machine;
    if (m->stepper)
        return 0.0f;
    const float depth_m = a->contact_known ? a->reference.position_m - a->contact_m : 0.0f;
    const float driver_N = thermal_derating(&a->thermal, m) * m->current_A * m->force_constant_N_A;
    const float limit_N = driver_N < m->motor_N ? driver_N : m->motor_N;
    const gains *g = &a->gains[a->softness];
    const float feed_N_m = motion_follows(a) && trajectory_forces(&a->trajectory)
                               ? trajectory_slope(&a->trajectory)
                               : g->feed_N_m;
    return pid_step(&a->pid, g, feed_N_m, &a->reference, a->position_m, depth_m, m->moving_kg,
                    m->motor_drag_Ns_m, m->friction_N, limit_N) /
           m->motor_N;
}

void app_tick(app *a, const app_inputs *in, app_outputs *out) {
    sense(a, in);
    if (a->unfit == 0)
        (void)supervisor_take(&a->supervisor, SUPERVISOR_STARTED);
    watch_inputs(a);
    if (app_moving(a) && a->force.tare_left == 0) /* the end of a tare is awaited */
        motion_step(a);
    watch_reference(a);
    a->duty = app_drives(a) ? drive(a) : 0.0f;
    out->motor_on = app_drives(a);
    out->duty = (int16_t)real_round(a->duty * DUTY_FULL);
    out->place =
        app_drives(a) ? a->home + real_round(a->reference.position_m / a->machine.count_m) : in->position;
    a->pulsed = out->trigger = motion_pulse(a);
    out->stores = a->store.writing && parameters_write(a, out);
    report_tick(a, out->duty);
}
