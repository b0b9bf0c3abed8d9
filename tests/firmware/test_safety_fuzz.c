/* test_safety_fuzz.c: 300,000 random commands, faults and restarts. The motor is on only in states that
 * drive or hold it, READY holds the plate still, and commands alone always bring the plate home. check: all
 */
#include "faults_make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MESSAGES = 300000, ROUND = 500, PLANT_ROUNDS = 10 };

static uint64_t state_of_random = 17;

static uint32_t chance(uint32_t n) {
    state_of_random = state_of_random * 6364136223846793005U + 1442695040888963407U;
    return (uint32_t)(state_of_random >> 33) % n;
}

/* Mostly within a range, now and then anything. */
static int32_t about(int32_t low, int32_t high) {
    static const int32_t edge[] = {0, 1, -1, INT32_MAX, INT32_MIN};
    return chance(12) ? low + (int32_t)chance((uint32_t)(high - low + 1)) : edge[chance(5)];
}

static palp_wire_message any_segment(void) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SEGMENT};
    m.as.segment = (palp_wire_segment){.index = (uint8_t)chance(4),
                                       .kind = (uint8_t)(chance(PALP_WIRE_SEGMENT_KIND_COUNT + 1) |
                                                         (chance(4) ? 0 : PALP_WIRE_SEGMENT_SMOOTH)),
                                       .target_nm = about(-12000000, 20000000),
                                       .rate_nm_s = (uint32_t)about(1, 260000000),
                                       .acceleration_um_s2 = (uint32_t)about(1000, 51000000),
                                       .duration_ms = (uint32_t)about(1, 3000),
                                       .frequency_mHz = (uint32_t)about(100, 20000),
                                       .frequency_end_mHz = (uint32_t)about(100, 20000),
                                       .cycles = (uint16_t)about(1, 5)};
    return m;
}

static palp_wire_message any_limits(void) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_LIMITS};
    m.as.limits = (palp_wire_limits){.force_uN = about(0, 24000000),
                                     .travel_nm = about(0, 30000000),
                                     .following_nm = about(0, 1000000),
                                     .temperature_cC = (int16_t)about(0, 11000),
                                     .host_timeout_ms = (uint16_t)about(0, 6000),
                                     .overflow_samples = (uint16_t)about(0, 100)};
    return m;
}

static palp_wire_message any_command(void) {
    static const uint8_t often[] = {PALP_WIRE_TYPE_HOME,         PALP_WIRE_TYPE_FIND_CONTACT,
                                    PALP_WIRE_TYPE_START,        PALP_WIRE_TYPE_CLEAR_FAULT,
                                    PALP_WIRE_TYPE_HELLO,        PALP_WIRE_TYPE_SEGMENT,
                                    PALP_WIRE_TYPE_FIND_CONTACT, PALP_WIRE_TYPE_START};
    palp_wire_message m = {.type = chance(2) ? often[chance(sizeof often)]
                                             : (uint8_t)(1 + chance(PALP_WIRE_TYPE_TRIGGER))};
    switch (m.type) {
    case PALP_WIRE_TYPE_HELLO:
        m.as.hello.protocol = PALP_WIRE_VERSION + (chance(8) == 0);
        break;
    case PALP_WIRE_TYPE_STREAM:
        m.as.stream.on = chance(4) > 0;
        break;
    case PALP_WIRE_TYPE_TARE:
        m.as.tare.samples = (uint16_t)about(1, 200);
        break;
    case PALP_WIRE_TYPE_SET_CALIBRATION:
        m.as.set_calibration.axis = (uint8_t)chance(7);
        for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
            m.as.set_calibration.row[i] = about(-2000000, 2000000);
        break;
    case PALP_WIRE_TYPE_SELECT_GAINS:
        m.as.select_gains.softness = (uint8_t)chance(8);
        break;
    case PALP_WIRE_TYPE_LIMITS:
        return any_limits();
    case PALP_WIRE_TYPE_SEGMENT:
        return any_segment();
    case PALP_WIRE_TYPE_FIND_CONTACT:
        m.as.find_contact =
            (palp_wire_find_contact){(uint32_t)about(0, 11000000), about(0, 1000000), about(0, 30000000)};
        break;
    case PALP_WIRE_TYPE_START:
        m.as.start = (palp_wire_start){(uint8_t)chance(5), about(-11000000, 3000000), chance(50), chance(50)};
        break;
    case PALP_WIRE_TYPE_TRIGGER:
        m.as.trigger = (palp_wire_trigger){(uint8_t)chance(4), (uint8_t)chance(3), (uint16_t)chance(5)};
        break;
    case PALP_WIRE_TYPE_JOG:
        m.as.jog = (palp_wire_jog){about(0, 30000000), (uint32_t)about(0, 10000000)};
        break;
    default:
        break;
    }
    return m;
}

/* ---- what happens to it ---- */

static void lift_all(bench *b) {
    for (int fault = 0; fault <= PLANT_SHAKEN; fault++)
        plant_lift(b->plant, (plant_fault)fault);
    b->mute = b->stalled = b->unplugged = b->no_thermistor = b->switch_stuck = false;
}

/* All but heat, which takes minutes to go. */
static void any_fault(bench *b) {
    const plant_fault fault = (plant_fault)chance(PLANT_SHAKEN + 1);
    if (fault != PLANT_HOT)
        plant_inject(b->plant, fault);
    switch (chance(30)) {
    case 0:
        bench_restart(b, (uint8_t)chance(4), chance(3) ? 0 : APP_ENCODER_FAILED);
        break;
    case 1:
        b->smashed = true;
        break;
    case 2:
        b->missed = chance(20);
        break;
    case 3:
        b->mute = true;
        break;
    case 4:
        b->no_thermistor = true;
        break;
    case 5:
        b->switch_stuck = true;
        break;
    case 6:
        b->stalled = true;
        break;
    default:
        break;
    }
}

/* bench_tick() sees to it that the motor is on in the states that drive it only. */
static unsigned long in_state[PALP_WIRE_STATE_COUNT], faults_seen[PALP_WIRE_FAULT_COUNT];

static void ticks(bench *b, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t before = b->app.tick > 0 ? b->app.supervisor.state : PALP_WIRE_STATE_COUNT;
        bench_tick(b);
        b->n_samples = 0;
        b->pulse = chance(50) == 0;
        in_state[b->app.supervisor.state]++;
        faults_seen[b->app.supervisor.fault] += before != b->app.supervisor.state;
        if (b->app.supervisor.state == PALP_WIRE_STATE_READY)
            assert_true(b->app.reference.velocity_m_s == 0.0f);
    }
}

static uint8_t send(bench *b, palp_wire_message *m) {
    const uint8_t result = bench_command(b, m);
    b->n_samples = 0;
    return result;
}

static uint8_t send_simple(bench *b, uint8_t type) {
    palp_wire_message m = {.type = type};
    return send(b, &m);
}

/* What a host does that finds it in any state: its own session, calibration and tare; then home. */
static void bring_home(bench *b) {
    static const int32_t row_z[] = {266540, 18890, 267670, -3780, 265060, 2130};
    palp_wire_message hello = {.type = PALP_WIRE_TYPE_HELLO, .as.hello = {PALP_WIRE_VERSION}};
    palp_wire_message tare = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = 50}};
    palp_wire_message row = {.type = PALP_WIRE_TYPE_SET_CALIBRATION, .as.set_calibration = {.axis = 2}};
    memcpy(row.as.set_calibration.row, row_z, sizeof row_z);
    lift_all(b);
    ticks(b, 300);
    for (int i = 0; i < 5 && b->app.supervisor.state != PALP_WIRE_STATE_READY; i++) {
        if (supervisor_moving(b->app.supervisor.state))
            (void)send_simple(b, PALP_WIRE_TYPE_STOP);
        for (int k = 0; k < 20000 && supervisor_moving(b->app.supervisor.state); k++)
            ticks(b, 1);
        (void)send(b, &hello);
        (void)send(b, &row);
        (void)send_simple(b, PALP_WIRE_TYPE_CLEAR_FAULT);
        ticks(b, 2);
        (void)send_simple(b, PALP_WIRE_TYPE_HOME);
        for (int k = 0; k < 20000 && b->app.supervisor.state == PALP_WIRE_STATE_HOMING; k++)
            ticks(b, 1);
        if (b->app.supervisor.state == PALP_WIRE_STATE_FAULT &&
            b->app.supervisor.fault == PALP_WIRE_FAULT_OVER_FORCE)
            (void)send(b, &tare); /* it was tared with the specimen's force on it */
        ticks(b, 60);
    }
    if (b->app.supervisor.state != PALP_WIRE_STATE_READY || !b->app.homed)
        fail_msg("stays in %s with %s at %.3f mm", palp_wire_state_name(b->app.supervisor.state),
                 palp_wire_fault_name(b->app.supervisor.fault), 1e3 * plant_look(b->plant).carriage_m);
}

/* Chance alone hardly ever gets as far as a run: there in order, and on from there. */
static void begin_run(bench *b) {
    palp_wire_message find = bench_find_contact(5, 0), first = bench_move(0, 2, 5),
                      start = bench_start(1, -1, 20, 20);
    bring_home(b);
    (void)send(b, &find);
    for (int k = 0; k < 20000 && supervisor_moving(b->app.supervisor.state); k++)
        ticks(b, 1);
    (void)send(b, &first);
    for (uint32_t n = chance(8); n > 0; n--) {
        palp_wire_message m = any_segment();
        m.as.segment.index = start.as.start.segments;
        if (send(b, &m) == PALP_WIRE_RESULT_DONE)
            start.as.start.segments++;
    }
    while (start.as.start.segments > 0 && send(b, &start) != PALP_WIRE_RESULT_DONE)
        start.as.start.segments--;
    ticks(b, chance(2000));
}

static void one_round(bench *b) {
    for (int i = 0; i < ROUND; i++) {
        if (chance(200) == 0)
            begin_run(b);
        palp_wire_message m = any_command();
        m.sequence = b->sequence++;
        b->n_frames = 0;
        if (app_listens(&b->app))
            bench_send(b, &m);
        ticks(b, chance(4) ? 1 : chance(20) ? chance(20) : chance(1000));
        if (chance(60) == 0)
            any_fault(b);
        if (chance(15) == 0)
            lift_all(b);
    }
    bring_home(b);
}

static void open_any(bench *b) {
    static const double lift_N[] = {0, 0.2, -0.3, 1};
    plant_settings s = plant_settings_default();
    s.actuator.lift_N = lift_N[chance(4)];
    s.actuator.start_m = 1e-3 * (double)chance(12);
    s.specimen = chance(4) ? PLANT_MODEL : chance(2) ? PLANT_AIR : PLANT_RIGID;
    s.scale = 0.2 + 0.1 * (double)chance(48);
    s.machine = (uint8_t)(chance(3) ? PLANT_VOICE_COIL : PLANT_STEPPER + chance(2));
    s.actuator.count_m = s.machine ? 0.625e-6 : s.actuator.count_m;
    bench_open(b, &s);
}

static void test_nothing_leaves_it_helpless(void **state) {
    const char *asked = getenv("FUZZ_MESSAGES");
    const long messages = asked ? atol(asked) : MESSAGES;
    bench b;
    (void)state;
    for (long done = 0; done < messages;) {
        open_any(&b);
        for (int i = 0; i < PLANT_ROUNDS && done < messages; i++, done += ROUND)
            one_round(&b);
        bench_close(&b);
    }
    /* It has been everywhere, and every fault has been made but heat. */
    for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++) {
        print_message("%-8s %lu ticks\n", palp_wire_state_name(s), in_state[s]);
        assert_true(in_state[s] > 0 || messages < MESSAGES);
    }
    for (uint8_t f = 1; f < PALP_WIRE_FAULT_COUNT; f++) {
        print_message("%-20s %lu\n", palp_wire_fault_name(f), faults_seen[f]);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_nothing_leaves_it_helpless),
    {0},
};
