/* app_bench.c: the whole app around the simulated indenter, in process. */
#include "app_bench.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ALIVE_TICKS = 500 };
static const app_identity IDENTITY = {"test", 7, true};

void bench_open(bench *b, const plant_settings *settings) {
    const plant_settings standard = plant_settings_default();
    palp_error error = {PALP_OK, ""};
    memset(b, 0, sizeof *b);
    b->sample = malloc(BENCH_SAMPLES * sizeof *b->sample);
    b->state = malloc(BENCH_SAMPLES);
    assert_true(b->sample && b->state);
    if (plant_create(settings ? settings : &standard, &b->plant, &error))
        fail_msg("%s", error.text);
    bench_restart(b, 0, 0);
}

void bench_close(bench *b) {
    plant_free(b->plant);
    free(b->sample);
    free(b->state);
}

void bench_restart(bench *b, uint8_t reset_cause, uint8_t failed) {
    plant_first(b->plant, &b->in);
    static const machine *const machines[] = {&machine_indenter, &machine_stepper, &machine_stepper_fast};
    app_init(&b->app, machines[b->in.machine], &IDENTITY, reset_cause, failed);
    b->next_frame = 0;
    b->lost = 0;
}

/* ---- the host ---- */

static void keep_samples(bench *b, const palp_wire_samples *block) {
    assert_in_range(block->count, 1, PALP_WIRE_SAMPLES);
    for (uint8_t i = 0; i < block->count; i++) {
        assert_true(b->n_samples < BENCH_SAMPLES);
        sample *s = &b->sample[b->n_samples];
        *s = (sample){.tick = block->tick + i,
                      .position = block->position[i],
                      .error = block->error[i],
                      .duty = block->duty[i],
                      .flags = block->flags[i]};
        memcpy(s->adc, block->adc + (size_t)i * PALP_WIRE_CHANNELS, sizeof s->adc);
        b->state[b->n_samples++] = block->state;
    }
}

static void keep_frame(bench *b, const palp_wire_message *m) {
    b->damaged += (uint16_t)(m->sequence - b->next_frame);
    b->next_frame = (uint16_t)(m->sequence + 1);
    b->lost = m->lost;
    if (m->type == PALP_WIRE_TYPE_SAMPLES) {
        keep_samples(b, &m->as.samples);
        return;
    }
    if (m->type == PALP_WIRE_TYPE_STATUS) {
        b->status = m->as.status;
        b->statuses++;
    }
    if (b->n_frames < sizeof b->frame / sizeof b->frame[0])
        b->frame[b->n_frames++] = *m;
}

static void listen(bench *b) {
    palp_wire_message m;
    uint8_t byte;
    while (!b->stalled && ring_get(&b->app.stream.out, &byte))
        if (palp_wire_decode(&b->decoder, byte, &m))
            keep_frame(b, &m);
    b->damaged += b->decoder.bad;
    b->decoder.bad = 0;
}

void bench_send(bench *b, const palp_wire_message *m) {
    uint8_t byte[PALP_WIRE_FRAME_MAX];
    const size_t n = palp_wire_encode(m, byte);
    assert_true(n > 0);
    for (size_t i = 0; i < n; i++)
        app_receive(&b->app, byte[i]);
    assert_false(app_listens(&b->app));
}

/* ---- ticks ---- */

static void sense(bench *b) {
    const plant_in *in = &b->in;
    b->inputs = (app_inputs){.position = in->position,
                             .thermistor = b->no_thermistor ? 4095 : in->thermistor,
                             .sensor_silent = (in->switches & PLANT_SENSOR_SILENT) != 0,
                             .home_switch = b->switch_stuck || (in->switches & PLANT_SWITCH_HOME) != 0,
                             .emergency_stop = (in->switches & PLANT_SWITCH_EMERGENCY) != 0,
                             .encoder_lost = (in->switches & PLANT_ENCODER_LOST) != 0,
                             .driver_fault = (in->switches & PLANT_DRIVER_FAULT) != 0,
                             .stack_intact = !b->smashed,
                             .trigger = b->pulse,
                             .force_held = (in->switches & PLANT_FORCE_HELD) != 0,
                             .missed = b->missed};
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        b->inputs.adc[i] = b->unplugged ? b->level : in->adc[i];
}

static void advance(bench *b, bool renewed) {
    const bool on = renewed && b->out.motor_on;
    const plant_out out = {.place = b->out.place,
                           .duty = on ? b->out.duty : 0,
                           .motor = on ? PLANT_MOTOR_ON : PLANT_MOTOR_BRAKED};
    palp_error error = {PALP_OK, ""};
    if (plant_step(b->plant, &out, &b->in, &error))
        fail_msg("%s", error.text);
}

void bench_tick(bench *b) {
    for (uint32_t i = 0; i < b->missed; i++)
        advance(b, false); /* the output has expired */
    sense(b);
    b->smashed = b->pulse = false;
    b->missed = 0;
    if (!b->mute && b->app.tick % ALIVE_TICKS == ALIVE_TICKS - 1) {
        palp_wire_message alive = {.type = PALP_WIRE_TYPE_ALIVE, .sequence = b->sequence++};
        bench_send(b, &alive);
    }
    app_tick(&b->app, &b->inputs, &b->out);
    assert_int_equal(b->out.motor_on, supervisor_drives(b->app.supervisor.state));
    assert_true(b->out.motor_on || b->out.duty == 0);
    listen(b);
    advance(b, true);
}

void bench_run(bench *b, uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++)
        bench_tick(b);
}

uint32_t bench_until(bench *b, uint8_t state, uint32_t at_most) {
    for (uint32_t i = 1; i <= at_most; i++) {
        bench_tick(b);
        if (b->app.supervisor.state == state)
            return i;
    }
    fail_msg("%s with %s, not %s, after %u ticks", palp_wire_state_name(b->app.supervisor.state),
             palp_wire_fault_name(b->app.supervisor.fault), palp_wire_state_name(state), (unsigned)at_most);
    return 0;
}

/* ---- commands ---- */

uint8_t bench_command(bench *b, palp_wire_message *command) {
    command->sequence = b->sequence++;
    b->n_frames = 0;
    bench_send(b, command);
    bench_tick(b);
    const palp_wire_ack *ack = &bench_answer(b, PALP_WIRE_TYPE_ACK)->as.ack;
    assert_int_equal(ack->sequence, command->sequence);
    assert_int_equal(ack->command, command->type);
    return ack->result;
}

uint8_t bench_simple(bench *b, uint8_t type) {
    palp_wire_message m = {.type = type};
    return bench_command(b, &m);
}

void bench_accepted(bench *b, palp_wire_message *command) {
    const uint8_t result = bench_command(b, command);
    if (result != PALP_WIRE_RESULT_DONE)
        fail_msg("%s is refused: %s", palp_wire_type_name(command->type), palp_wire_result_text(result));
}

const palp_wire_message *bench_answer(const bench *b, uint8_t type) {
    for (size_t i = 0; i < b->n_frames; i++)
        if (b->frame[i].type == type)
            return &b->frame[i];
    fail_msg("no %s among %zu frames", palp_wire_type_name(type), b->n_frames);
    return NULL;
}

static int32_t nm(double mm) {
    return (int32_t)(mm * 1e6);
}

palp_wire_message bench_find_contact(double rate_mm_s, double travel_mm) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_FIND_CONTACT};
    m.as.find_contact = (palp_wire_find_contact){(uint32_t)nm(rate_mm_s), 0, nm(travel_mm)};
    return m;
}

palp_wire_message bench_move(uint8_t index, double to_mm, double rate_mm_s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SEGMENT};
    m.as.segment = (palp_wire_segment){.index = index,
                                       .kind = PALP_WIRE_SEGMENT_MOVE,
                                       .target_nm = nm(to_mm),
                                       .rate_nm_s = (uint32_t)nm(rate_mm_s),
                                       .acceleration_um_s2 = 500000};
    return m;
}

palp_wire_message bench_force(uint8_t index, double newton, double rate_N_s, uint32_t ms) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SEGMENT};
    m.as.segment = (palp_wire_segment){.index = index,
                                       .kind = PALP_WIRE_SEGMENT_FORCE,
                                       .target_nm = nm(newton),
                                       .rate_nm_s = (uint32_t)nm(rate_N_s),
                                       .duration_ms = ms};
    return m;
}

palp_wire_message bench_hold(uint8_t index, uint32_t ms) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SEGMENT};
    m.as.segment = (palp_wire_segment){.index = index, .kind = PALP_WIRE_SEGMENT_HOLD, .duration_ms = ms};
    return m;
}

palp_wire_message bench_start(uint8_t segments, double start_mm, uint32_t air_ms, uint32_t after_ms) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_START};
    m.as.start = (palp_wire_start){segments, nm(start_mm), air_ms, after_ms};
    return m;
}

palp_wire_message bench_limits(palp_wire_limits limits) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_LIMITS};
    m.as.limits = limits;
    return m;
}

palp_wire_message bench_stream(bool on) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STREAM};
    m.as.stream.on = on;
    return m;
}

void bench_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.9g, not %.9g within %g", got, wanted, tolerance);
}

void bench_home(bench *b) {
    palp_wire_message home = {.type = PALP_WIRE_TYPE_HOME};
    if (b->app.supervisor.state == PALP_WIRE_STATE_BOOT)
        bench_tick(b);
    bench_accepted(b, &home);
    bench_until(b, PALP_WIRE_STATE_READY, 5000);
}

/* Quickly to 1 mm above the specimen and slowly from there. */
void bench_contact(bench *b) {
    palp_wire_message find = bench_find_contact(5, 0);
    bench_home(b);
    bench_accepted(b, &find);
    bench_until(b, PALP_WIRE_STATE_READY, 10000);
    assert_true(b->app.contact_known);
    find = bench_find_contact(0.5, 0);
    bench_accepted(b, &find);
    bench_until(b, PALP_WIRE_STATE_READY, 10000);
    assert_true(b->app.contact_known);
}
