/* test_commands.c: every command in every state, its ranges and its answers; the stream around it. */
#include "app_bench.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The result of every command in every state, all else being in order: a row a command, a column a state:
 * Done, S = not in this state, F = a fault is latched, H = not homed. */
static const struct row {
    uint8_t command;
    const char *in; /* boot idle homing ready approach run retract fault jog */
} wanted[] = {
    {PALP_WIRE_TYPE_ALIVE, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_STREAM, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_CLEAR_FAULT, "SSSSSSSDS"},
    {PALP_WIRE_TYPE_HOME, "SDSDSSSFS"},
    {PALP_WIRE_TYPE_TARE, "SDSDSSSDS"},
    {PALP_WIRE_TYPE_SET_CALIBRATION, "SDSDSSSDS"},
    {PALP_WIRE_TYPE_GET_CALIBRATION, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_LIMITS, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_GET_LIMITS, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_SELECT_GAINS, "SDSDSSSFS"},
    {PALP_WIRE_TYPE_GET_GAINS, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_FIND_CONTACT, "SHSDSSSFS"},
    {PALP_WIRE_TYPE_SEGMENT, "SDDDDSDFD"},
    {PALP_WIRE_TYPE_START, "SHSDSSSFS"},
    {PALP_WIRE_TYPE_STOP, "SDDDDDDFD"},
    {PALP_WIRE_TYPE_GET_STATUS, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_HALT, "SDDDDDDFD"},
    {PALP_WIRE_TYPE_JOG, "SHSDSSSFS"},
    {PALP_WIRE_TYPE_TRIGGER, "SDSDSSSFS"},
    {PALP_WIRE_TYPE_GET_PARAMETER, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_SET_PARAMETER, "SDSSSSSFS"},
    {PALP_WIRE_TYPE_SAVE, "SDSSSSSFS"},
    {PALP_WIRE_TYPE_GET_CONFIGURATION, "DDDDDDDDD"},
    {PALP_WIRE_TYPE_HELLO, "DDDDDDDDD"},
};

static palp_wire_message in_order(uint8_t type) {
    palp_wire_message m = {.type = type};
    switch (type) {
    case PALP_WIRE_TYPE_HELLO:
        m.as.hello.protocol = PALP_WIRE_VERSION;
        break;
    case PALP_WIRE_TYPE_TARE:
        m.as.tare.samples = 1;
        break;
    case PALP_WIRE_TYPE_SET_CALIBRATION:
        m.as.set_calibration.row[0] = 5;
        break;
    case PALP_WIRE_TYPE_SEGMENT:
        return bench_hold(0, 1);
    case PALP_WIRE_TYPE_START:
        return bench_start(1, 0, 0, 0);
    case PALP_WIRE_TYPE_JOG:
        m.as.jog = (palp_wire_jog){2000000, 1000000};
        break;
    default:
        break;
    }
    return m;
}

static void test_every_command_in_every_state(void **state) {
    static const char letter[] = "DUVSRFHCP";
    palp_wire_message find = bench_find_contact(5, 0), hold = bench_hold(0, 100),
                      start = bench_start(1, -1, 0, 0), jog = in_order(PALP_WIRE_TYPE_JOG);
    static bench at[PALP_WIRE_STATE_COUNT];
    (void)state;
    for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++) {
        bench_open(&at[s], NULL);
        if (s == PALP_WIRE_STATE_BOOT)
            continue;
        bench_contact(&at[s]);
        bench_accepted(&at[s], &hold);
    }
    bench_restart(&at[PALP_WIRE_STATE_IDLE], 0, 0);
    bench_tick(&at[PALP_WIRE_STATE_IDLE]);
    bench_simple(&at[PALP_WIRE_STATE_HOMING], PALP_WIRE_TYPE_HOME);
    bench_accepted(&at[PALP_WIRE_STATE_APPROACH], &find);
    bench_accepted(&at[PALP_WIRE_STATE_RUN], &start);
    start.as.start.start_nm = 0;
    bench_accepted(&at[PALP_WIRE_STATE_RETRACT], &start);
    bench_simple(&at[PALP_WIRE_STATE_RETRACT], PALP_WIRE_TYPE_STOP);
    bench_accepted(&at[PALP_WIRE_STATE_JOG], &jog);
    at[PALP_WIRE_STATE_FAULT].smashed = true;
    bench_run(&at[PALP_WIRE_STATE_FAULT], 2);
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++) {
            app *kept = malloc(sizeof *kept);
            palp_wire_message m = in_order(wanted[i].command);
            assert_non_null(kept);
            *kept = at[s].app;
            assert_int_equal(at[s].app.supervisor.state, s);
            m.sequence = at[s].sequence++;
            bench_send(&at[s], &m);
            const char got = letter[at[s].app.command_result];
            if (got != wanted[i].in[s])
                fail_msg("%s in %s: %c, not %c", palp_wire_type_name(m.type), palp_wire_state_name(s), got,
                         wanted[i].in[s]);
            at[s].app = *kept;
            free(kept);
        }
    }
    for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++)
        bench_close(&at[s]);
}

static void test_ranges(void **state) {
    palp_wire_message tare = {.type = PALP_WIRE_TYPE_TARE}, row = {.type = PALP_WIRE_TYPE_SET_CALIBRATION};
    palp_wire_message ask_row = {.type = PALP_WIRE_TYPE_GET_CALIBRATION},
                      ask_gains = {.type = PALP_WIRE_TYPE_GET_GAINS};
    palp_wire_message select = {.type = PALP_WIRE_TYPE_SELECT_GAINS}, bad = bench_move(32, 1, 1);
    palp_wire_message find[] = {bench_find_contact(10.1, 0), bench_find_contact(1, -1),
                                bench_find_contact(1, 1), bench_find_contact(1, 1)};
    palp_wire_message start[] = {bench_start(0, 0, 0, 0), bench_start(2, 0, 0, 0), bench_start(33, 0, 0, 0),
                                 bench_start(1, 18.5, 0, 0), bench_start(1, -12.5, 0, 0)};
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    tare.as.tare.samples = 0;
    assert_int_equal(bench_command(&b, &tare), PALP_WIRE_RESULT_RANGE);
    tare.as.tare.samples = 4097;
    assert_int_equal(bench_command(&b, &tare), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &row), PALP_WIRE_RESULT_RANGE);
    ask_row.as.get_calibration.axis = FORCE_AXES;
    assert_int_equal(bench_command(&b, &ask_row), PALP_WIRE_RESULT_RANGE);
    ask_gains.as.get_gains.softness = GAINS_CLASSES;
    assert_int_equal(bench_command(&b, &ask_gains), PALP_WIRE_RESULT_RANGE);
    select.as.select_gains.softness = GAINS_CLASSES;
    assert_int_equal(bench_command(&b, &select), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &bad), PALP_WIRE_RESULT_RANGE);
    bad = bench_move(0, 1, 300);
    assert_int_equal(bench_command(&b, &bad), PALP_WIRE_RESULT_RANGE);
    find[2].as.find_contact.force_uN = -1;
    find[3].as.find_contact.force_uN = 25000000;
    for (size_t i = 0; i < sizeof find / sizeof find[0]; i++)
        assert_int_equal(bench_command(&b, &find[i]), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &start[4]), PALP_WIRE_RESULT_RANGE);
    palp_wire_message hold = bench_hold(0, 5);
    bench_accepted(&b, &hold);
    for (size_t i = 0; i < sizeof start / sizeof start[0]; i++)
        assert_int_equal(bench_command(&b, &start[i]), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    assert_true(b.app.contact_known);
    bench_close(&b);
}

static void test_answers(void **state) {
    palp_wire_message row = {.type = PALP_WIRE_TYPE_SET_CALIBRATION}, m;
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_tick(&b);
    row.as.set_calibration = (palp_wire_set_calibration){4, {1000, -2000, 3000, -4000, 5000, -6000}};
    bench_accepted(&b, &row);
    m = (palp_wire_message){.type = PALP_WIRE_TYPE_GET_CALIBRATION};
    m.as.get_calibration.axis = 4;
    bench_accepted(&b, &m);
    const palp_wire_calibration *got = &bench_answer(&b, PALP_WIRE_TYPE_CALIBRATION)->as.calibration;
    assert_int_equal(got->axis, 4);
    assert_memory_equal(got->row, row.as.set_calibration.row, sizeof got->row);
    m = (palp_wire_message){.type = PALP_WIRE_TYPE_GET_GAINS};
    m.as.get_gains.softness = 3;
    bench_accepted(&b, &m);
    const palp_wire_gains *g = &bench_answer(&b, PALP_WIRE_TYPE_GAINS)->as.gains;
    assert_int_equal(g->softness, 3);
    bench_near(g->kp_N_m, gains_table[3].kp_N_m, 0.5);
    bench_near(g->ki_N_m_s, gains_table[3].ki_N_ms, 0.5);
    bench_near(g->kd_mN_s_m, gains_table[3].kd_Ns_m * 1e3f, 0.5);
    bench_near(g->stiffness_mN_m, gains_table[3].stiffness_N_m * 1e3f, 0.5);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_GET_STATUS), PALP_WIRE_RESULT_DONE);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_STATUS)->as.status.state, PALP_WIRE_STATE_IDLE);
    bench_close(&b);
}

/* The same number again: the same answer, done once. A HELLO starts afresh; a frame of the device's is none.
 */
static void test_repeated_command(void **state) {
    palp_wire_message home = {.type = PALP_WIRE_TYPE_HOME, .sequence = 900},
                      hello = {.type = PALP_WIRE_TYPE_HELLO};
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_STATUS, .sequence = 901},
                      ack = {.type = PALP_WIRE_TYPE_ACK};
    uint8_t byte[PALP_WIRE_FRAME_MAX];
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_tick(&b);
    bench_send(&b, &home);
    bench_run(&b, 300);
    const float place = b.app.reference.position_m;
    for (int i = 0; i < 3; i++) {
        b.n_frames = 0;
        bench_send(&b, &home);
        bench_tick(&b);
        assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_ACK)->as.ack.result, PALP_WIRE_RESULT_DONE);
        assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_HOMING);
        assert_true(b.app.reference.position_m < place); /* it goes on, and does not begin again */
    }
    for (int i = 0; i < 2; i++) { /* what was asked for comes again, too */
        b.n_frames = 0;
        bench_send(&b, &ask);
        bench_tick(&b);
        bench_answer(&b, PALP_WIRE_TYPE_STATUS);
    }
    hello.sequence = 900;
    hello.as.hello.protocol = PALP_WIRE_VERSION;
    bench_send(&b, &hello);
    bench_tick(&b);
    b.n_frames = 0;
    bench_send(&b, &home);
    bench_tick(&b);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_ACK)->as.ack.result, PALP_WIRE_RESULT_STATE);
    const size_t n = palp_wire_encode(&ack, byte);
    b.n_frames = 0;
    for (size_t i = 0; i < n; i++)
        app_receive(&b.app, byte[i]);
    bench_tick(&b);
    assert_int_equal(b.n_frames, 0);
    bench_close(&b);
}

static void test_new_host_stops_the_stream(void **state) {
    palp_wire_message streaming = bench_stream(true), hello = in_order(PALP_WIRE_TYPE_HELLO);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_accepted(&b, &streaming);
    bench_run(&b, 25);
    bench_accepted(&b, &hello);
    const size_t before = b.n_samples;
    bench_run(&b, 25);
    assert_int_equal(b.n_samples, before);
    bench_close(&b);
}

static void test_other_version(void **state) {
    palp_wire_message hello = {.type = PALP_WIRE_TYPE_HELLO};
    bench b;
    (void)state;
    bench_open(&b, NULL);
    hello.as.hello.protocol = PALP_WIRE_VERSION + 1;
    assert_int_equal(bench_command(&b, &hello), PALP_WIRE_RESULT_VERSION);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_INFO)->as.info.protocol, PALP_WIRE_VERSION);
    bench_close(&b);
}

static void test_limits(void **state) {
    static const palp_wire_limits bad[] = {
        {.force_uN = 24000001},   {.force_uN = -1},          {.travel_nm = 30000500},
        {.travel_nm = -5},        {.following_nm = 1000100}, {.temperature_cC = 11001},
        {.temperature_cC = -100}, {.host_timeout_ms = 99},   {.host_timeout_ms = 60001},
    };
    const palp_wire_limits most = {24000000, 30000000, 1000000, 11000, 60000, 65535};
    bench b;
    (void)state;
    bench_open(&b, NULL);
    const app_limits before = b.app.limits;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        palp_wire_limits asked = bad[i];
        asked.overflow_samples = 5;
        palp_wire_message m = bench_limits(asked);
        assert_int_equal(bench_command(&b, &m), PALP_WIRE_RESULT_RANGE);
        assert_memory_equal(&b.app.limits, &before, sizeof before);
    }
    palp_wire_message m = bench_limits((palp_wire_limits){.overflow_samples = 0});
    bench_accepted(&b, &m);
    assert_memory_equal(&b.app.limits, &before, sizeof before);
    m = bench_limits(most);
    bench_accepted(&b, &m);
    bench_near(b.app.limits.travel_m, 0.03, 1e-8);
    assert_int_equal(b.app.limits.host_timeout_ms, 60000);
    assert_int_equal(b.app.limits.overflow_samples, 65535);
    bench_close(&b);
}

/* ---- tare ---- */

static void test_tare(void **state) {
    palp_wire_message tare = {.type = PALP_WIRE_TYPE_TARE}, home = {.type = PALP_WIRE_TYPE_HOME};
    plant_settings s = plant_settings_default();
    bench b;
    (void)state;
    s.sensor.bias_N = 1.5;
    bench_open(&b, &s);
    bench_run(&b, 5);
    bench_near(b.app.force_N, 1.5, 0.02);
    tare.as.tare.samples = 500;
    bench_accepted(&b, &tare);
    bench_accepted(&b, &home); /* waits for it */
    bench_run(&b, 480);
    bench_near(plant_look(b.plant).carriage_m, 5e-3, 1e-5);
    bench_run(&b, 120);
    bench_near(b.app.force_N, 0, 0.02);
    assert_true(plant_look(b.plant).carriage_m < 4.8e-3);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_close(&b);
}

/* ---- the stream ---- */

static void test_missed_ticks(void **state) {
    palp_wire_message streaming = bench_stream(true);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    bench_accepted(&b, &streaming);
    bench_run(&b, 14);
    const uint32_t tick = b.app.tick;
    b.missed = 3;
    bench_tick(&b);
    assert_int_equal(b.app.tick, tick + 4);
    bench_run(&b, 30);
    size_t gaps = 0;
    for (size_t i = 1; i < b.n_samples; i++) {
        const bool gap = b.sample[i].tick != b.sample[i - 1].tick + 1;
        gaps += gap;
        assert_int_equal((b.sample[i].flags & PALP_WIRE_FLAG_TICK_MISSED) != 0, gap);
        if (gap)
            assert_true(b.sample[i].tick == tick + 4 && b.sample[i - 1].tick == tick);
    }
    assert_int_equal(gaps, 1);
    bench_simple(&b, PALP_WIRE_TYPE_GET_STATUS);
    assert_int_equal(b.status.missed_ticks, 3);
    bench_close(&b);
}

/* A host that stalls: what is lost is lost in whole frames and counted, and its commands are still answered.
 */
static void test_stalled_host(void **state) {
    palp_wire_message streaming = bench_stream(true), ask = {.type = PALP_WIRE_TYPE_GET_STATUS};
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    bench_accepted(&b, &streaming);
    bench_run(&b, 600);
    b.stalled = b.mute = true;
    bench_run(&b, 2000);
    ask.sequence = b.sequence++;
    bench_send(&b, &ask);
    b.n_frames = 0;
    b.stalled = false;
    bench_run(&b, 1000);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_ACK)->as.ack.sequence, ask.sequence);
    bench_answer(&b, PALP_WIRE_TYPE_STATUS);
    assert_int_equal(b.damaged, 0);
    assert_in_range(b.lost, 1300, 1500);
    const uint32_t span = b.sample[b.n_samples - 1].tick - b.sample[0].tick + 1;
    assert_int_equal(b.n_samples + b.lost, span);
    bench_close(&b);
}

static void test_status_on_every_change(void **state) {
    bench b;
    uint8_t last = PALP_WIRE_STATE_BOOT;
    uint32_t changes = 0;
    (void)state;
    bench_open(&b, NULL);
    bench_tick(&b);
    bench_simple(&b, PALP_WIRE_TYPE_HOME);
    for (int i = 0; i < 3000; i++) {
        bench_tick(&b);
        changes += b.app.supervisor.state != last;
        last = b.app.supervisor.state;
        assert_int_equal(b.status.state, last);
    }
    assert_int_equal(b.statuses, 1 + changes);
    palp_wire_message streaming = bench_stream(true);
    bench_accepted(&b, &streaming);
    const uint32_t before = b.statuses;
    bench_run(&b, 1000);
    assert_in_range(b.statuses - before, 9, 10);
    bench_close(&b);
}

/* Ten seconds of noise on the line do nothing but be counted. */
static void test_noise_on_the_line(void **state) {
    uint32_t random = 12345;
    bench b;
    (void)state;
    bench_open(&b, NULL);
    b.mute = true;
    for (int i = 0; i < 10000; i++) {
        for (int j = 0; j < 92; j++) {
            random = random * 1664525u + 1013904223u;
            app_receive(&b.app, (uint8_t)(random >> 24));
        }
        bench_tick(&b);
        assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    }
    assert_true(b.app.decoder.bad > 1000);
    app_receive(&b.app, 0);
    bench_home(&b);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_other_version),
    cmocka_unit_test(test_limits),
    cmocka_unit_test(test_every_command_in_every_state),
    cmocka_unit_test(test_ranges),
    cmocka_unit_test(test_answers),
    cmocka_unit_test(test_repeated_command),
    cmocka_unit_test(test_new_host_stops_the_stream),
    cmocka_unit_test(test_tare),
    cmocka_unit_test(test_missed_ticks),
    cmocka_unit_test(test_stalled_host),
    cmocka_unit_test(test_status_on_every_change),
    cmocka_unit_test(test_noise_on_the_line),
    {0},
};
