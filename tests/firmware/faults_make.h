/* faults_make.h: brings the indenter to each state. */
#ifndef FAULTS_MAKE_H
#define FAULTS_MAKE_H

#include "app_bench.h"

#include "hal.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static inline void to_idle(bench *b) {
    bench_run(b, 5);
}

static inline void to_homing(bench *b) {
    bench_tick(b);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_DONE);
    bench_run(b, 100);
}

static inline void to_approach(bench *b) {
    palp_wire_message find = bench_find_contact(0.5, 0);
    bench_contact(b);
    bench_accepted(b, &find);
    bench_run(b, 300);
}

/* A millimetre deep in a ramp to three, 2 mm/s; a long hold follows. */
static inline void to_run(bench *b) {
    palp_wire_message ramp = bench_move(0, 3, 2), hold = bench_hold(1, 3000),
                      start = bench_start(2, -1, 50, 50);
    bench_contact(b);
    bench_accepted(b, &ramp);
    bench_accepted(b, &hold);
    bench_accepted(b, &start);
    while (b->app.position_m < b->app.contact_m + 1e-3f)
        bench_tick(b);
}

static inline void to_retract(bench *b) {
    to_run(b);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    bench_run(b, 20);
}

/* In the air, on the way to 16 mm below home. */
static inline void to_jog(bench *b) {
    palp_wire_message jog = {.type = PALP_WIRE_TYPE_JOG, .as.jog = {16000000, 2000000}};
    bench_contact(b);
    bench_accepted(b, &jog);
    bench_run(b, 20);
}

static inline void bring_to(bench *b, uint8_t state) {
    palp_wire_message streaming = bench_stream(true);
    bench_open(b, NULL);
    if (state != PALP_WIRE_STATE_BOOT)
        bench_accepted(b, &streaming);
    switch (state) {
    case PALP_WIRE_STATE_BOOT:
        return;
    case PALP_WIRE_STATE_IDLE:
        to_idle(b);
        break;
    case PALP_WIRE_STATE_HOMING:
        to_homing(b);
        break;
    case PALP_WIRE_STATE_READY:
        bench_contact(b);
        break;
    case PALP_WIRE_STATE_APPROACH:
        to_approach(b);
        break;
    case PALP_WIRE_STATE_RUN:
        to_run(b);
        break;
    case PALP_WIRE_STATE_JOG:
        to_jog(b);
        break;
    default:
        to_retract(b);
        break;
    }
    assert_int_equal(b->app.supervisor.state, state);
}

static inline void make_jammed(bench *b) {
    plant_inject(b->plant, PLANT_JAMMED);
}

static inline void set_limits(bench *b, palp_wire_limits limits) {
    palp_wire_message m = bench_limits(limits);
    bench_accepted(b, &m);
}

/* The travel ends so far beyond the plate; takes a tick. */
static inline void end_travel_at(bench *b, float beyond_m) {
    set_limits(b, (palp_wire_limits){.travel_nm = (int32_t)((b->app.position_m + beyond_m) * 1e9f)});
}

static inline void make_smash(bench *b) {
    b->smashed = true;
}

#endif
