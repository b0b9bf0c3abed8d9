/* test_parameters.c: the machine's parameters over the wire: ranges, what follows from them, flash that is
 * written a word a tick. */
#include "app_bench.h"

#include <setjmp.h>
#include <stdarg.h>
#include <math.h>
#include <string.h>

#include <cmocka.h>

static uint32_t flash[STORE_WORDS];

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static float number_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static palp_wire_configuration configuration(bench *b) {
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_CONFIGURATION};
    bench_accepted(b, &ask);
    return bench_answer(b, PALP_WIRE_TYPE_CONFIGURATION)->as.configuration;
}

static palp_wire_parameter parameter(bench *b, uint8_t id) {
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_PARAMETER, .as.get_parameter.id = id};
    bench_accepted(b, &ask);
    return bench_answer(b, PALP_WIRE_TYPE_PARAMETER)->as.parameter;
}

/* The number of a name's first value. */
static uint8_t named(bench *b, const char *name) {
    const uint8_t n = configuration(b).parameters;
    for (uint8_t id = 0; id < n; id++) {
        const palp_wire_parameter p = parameter(b, id);
        if (strcmp((const char *)p.name, name) == 0)
            return id;
    }
    fail_msg("no parameter %s", name);
    return 0;
}

static uint8_t set(bench *b, uint8_t id, uint32_t bits) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SET_PARAMETER, .as.set_parameter = {id, bits}};
    return bench_command(b, &m);
}

/* A tick, and the flash words that the board writes; never while the motor is on. */
static void tick(bench *b) {
    bench_tick(b);
    assert_false(b->out.stores && b->out.motor_on);
    if (b->out.stores)
        flash[b->out.store_at] &= b->out.store_word;
}

static void open_idle(bench *b) {
    memset(flash, 0xff, sizeof flash);
    bench_open(b, NULL);
    app_load(&b->app, flash);
    bench_run(b, 2);
}

/* Each is between its limits, is what is compiled in, and takes its limits but nothing beyond, nor a NaN. */
static void test_ranges(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    const uint8_t n = configuration(&b).parameters;
    assert_true(n > 90);
    for (uint8_t id = 0; id < n; id++) {
        const palp_wire_parameter p = parameter(&b, id);
        const float low = number_of(p.low), high = number_of(p.high);
        assert_true(memchr(p.name, 0, sizeof p.name) != NULL);
        assert_int_equal(p.value, p.standard);
        assert_true(number_of(p.value) >= low && number_of(p.value) <= high);
        assert_int_equal(set(&b, id, bits_of(nextafterf(low, -INFINITY))), PALP_WIRE_RESULT_RANGE);
        assert_int_equal(set(&b, id, bits_of(nextafterf(high, INFINITY))), PALP_WIRE_RESULT_RANGE);
        assert_int_equal(set(&b, id, bits_of(NAN)), PALP_WIRE_RESULT_RANGE);
        assert_int_equal(set(&b, id, p.low), PALP_WIRE_RESULT_DONE);
        assert_int_equal(set(&b, id, p.high), PALP_WIRE_RESULT_DONE);
        assert_int_equal(parameter(&b, id).value, p.high);
        assert_int_equal(set(&b, id, p.standard), PALP_WIRE_RESULT_DONE);
    }
    assert_int_equal(set(&b, n, 0), PALP_WIRE_RESULT_RANGE);
    bench_close(&b);
}

/* The position is not known any more; INFO, limits and gains are the new ones. */
static void test_what_follows(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    const uint8_t travel = named(&b, "travel_m"), kp = named(&b, "kp_N_m");
    bench_home(&b);
    assert_int_equal(set(&b, travel, bits_of(0.02f)), PALP_WIRE_RESULT_STATE);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    assert_true(b.app.homed);
    const uint32_t id = configuration(&b).id;
    assert_int_equal(set(&b, travel, bits_of(0.02f)), PALP_WIRE_RESULT_DONE);
    assert_int_equal(set(&b, (uint8_t)(kp + 2), bits_of(4000.0f)), PALP_WIRE_RESULT_DONE);
    assert_false(b.app.homed);
    assert_true(configuration(&b).id != id);
    palp_wire_message m = {.type = PALP_WIRE_TYPE_HELLO, .as.hello.protocol = PALP_WIRE_VERSION};
    bench_accepted(&b, &m);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_INFO)->as.info.travel_nm, 20000000);
    m = (palp_wire_message){.type = PALP_WIRE_TYPE_GET_LIMITS};
    bench_accepted(&b, &m);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_LIMITS_NOW)->as.limits_now.travel_nm, 20000000);
    m = (palp_wire_message){.type = PALP_WIRE_TYPE_GET_GAINS, .as.get_gains.softness = 2};
    bench_accepted(&b, &m);
    assert_int_equal(bench_answer(&b, PALP_WIRE_TYPE_GAINS)->as.gains.kp_N_m, 4000);
    bench_home(&b);
    bench_close(&b);
}

/* While it is written nothing can begin to move or change; a fault does not end it; the next start has it. */
static void test_saved(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    const uint8_t friction = named(&b, "friction_N");
    assert_int_equal(configuration(&b).stored_id, 0);
    assert_int_equal(set(&b, friction, bits_of(0.3f)), PALP_WIRE_RESULT_DONE);
    const uint32_t id = configuration(&b).id;
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_SAVE), PALP_WIRE_RESULT_DONE);
    flash[b.out.store_at] &= b.out.store_word;
    uint32_t words = 1;
    static const uint8_t refused[] = {PALP_WIRE_TYPE_HOME,          PALP_WIRE_TYPE_TARE,
                                      PALP_WIRE_TYPE_SAVE,          PALP_WIRE_TYPE_JOG,
                                      PALP_WIRE_TYPE_SET_PARAMETER, PALP_WIRE_TYPE_SET_CALIBRATION,
                                      PALP_WIRE_TYPE_START};
    for (size_t i = 0; i < sizeof refused; i++, words++) {
        assert_int_equal(bench_simple(&b, refused[i]), PALP_WIRE_RESULT_STATE);
        assert_true(b.out.stores);
        flash[b.out.store_at] &= b.out.store_word;
    }
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HALT), PALP_WIRE_RESULT_DONE);
    flash[b.out.store_at] &= b.out.store_word;
    words++;
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_STATE);
    flash[b.out.store_at] &= b.out.store_word;
    words++;
    for (; b.app.store.writing; words++)
        tick(&b);
    assert_in_range(words, 90, STORE_RECORD);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    palp_wire_configuration now = configuration(&b);
    assert_int_equal(now.saving, 0);
    assert_int_equal(now.stored_id, id);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_SAVE), PALP_WIRE_RESULT_DONE); /* is there already */
    bench_tick(&b);
    assert_false(b.out.stores);
    bench_restart(&b, APP_RESET_POWER, 0);
    app_load(&b.app, flash);
    now = configuration(&b);
    assert_int_equal(now.source, 1);
    assert_int_equal(now.id, id);
    assert_true(number_of(parameter(&b, friction).value) == 0.3f);
    bench_close(&b);
}

/* A record of so many values of which all are as compiled in but travel, and one more. */
static void store_record(bench *b, uint32_t n, uint8_t travel, uint8_t other, float value) {
    uint32_t at, word;
    store s;
    uint32_t values[STORE_VALUES];
    for (uint8_t id = 0; id < n; id++)
        values[id] = parameter(b, id).standard;
    values[travel] = bits_of(0.02f);
    values[other] = bits_of(value);
    store_open(&s, flash);
    assert_true(store_begin(&s, n));
    while (store_step(&s, values[store_wants(&s)], &at, &word))
        flash[at] = word;
    bench_restart(b, APP_RESET_POWER, 0);
    app_load(&b->app, flash);
}

/* A record with fewer values than this firmware has is accepted. With one value out of range it counts as
 * damaged, and the compiled-in values are used and reported until the next save. */
static void test_other_records(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    const uint8_t travel = named(&b, "travel_m"), friction = named(&b, "friction_N"),
                  n = configuration(&b).parameters;
    store_record(&b, travel + 1u, travel, 0, 20000);
    assert_int_equal(configuration(&b).source, 1);
    assert_true(number_of(parameter(&b, travel).value) == 0.02f);
    for (int kind = 0; kind < 3; kind++) {
        store_record(&b, n, travel, friction, kind == 0 ? -1.0f : kind == 1 ? NAN : 20.1f);
        const palp_wire_configuration now = configuration(&b);
        assert_int_equal(now.source, 2);
        assert_int_equal(now.bad, 1);
        assert_int_equal(now.stored_id, 0);
        for (uint8_t id = 0; id < n; id++)
            assert_int_equal(parameter(&b, id).value, parameter(&b, id).standard);
    }
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_SAVE), PALP_WIRE_RESULT_DONE);
    flash[b.out.store_at] &= b.out.store_word;
    while (b.app.store.writing)
        tick(&b);
    assert_int_equal(configuration(&b).source, 1);
    bench_close(&b);
}

/* Without room, or where a word does not take. */
static void test_cannot_be_saved(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    const uint8_t friction = named(&b, "friction_N");
    for (int k = 0; k < 13; k++) {
        assert_int_equal(set(&b, friction, bits_of(0.2f + 0.01f * (float)k)), PALP_WIRE_RESULT_DONE);
        assert_int_equal(configuration(&b).room, 12 - k);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_SAVE),
                         k < 12 ? PALP_WIRE_RESULT_DONE : PALP_WIRE_RESULT_FULL);
        if (b.out.stores)
            flash[b.out.store_at] &= b.out.store_word;
        while (b.app.store.writing)
            tick(&b);
        if (k == 3) /* its successor's place is worn */
            flash[4 * STORE_RECORD + 8] = 0;
        if (k == 4)
            assert_int_equal(configuration(&b).saving, 2);
    }
    bench_close(&b);
}

/* A force beyond full duty is limited to full duty, without overflow of 16 bits. */
static void test_full_is_full(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    assert_int_equal(set(&b, named(&b, "motor_N"), bits_of(1.0f)), PALP_WIRE_RESULT_DONE);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_DONE);
    bool full = false;
    for (int i = 0; i < 3000; i++) {
        tick(&b);
        assert_true(b.app.duty >= -1.0f && b.app.duty <= 1.0f);
        full = full || b.app.duty == -1.0f || b.app.duty == 1.0f;
    }
    assert_true(full);
    bench_close(&b);
}

/* ---- any machine at all ---- */

static uint32_t random_below(uint32_t n) {
    static uint64_t seed = 7;
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(seed >> 33) % n;
}

/* Within its limits, near the least as likely as near the most. */
static palp_wire_message any_parameter(bench *b, uint8_t n) {
    palp_wire_parameter p = {.id = 0};
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SET_PARAMETER};
    const uint8_t id = (uint8_t)random_below(n);
    p = parameter(b, id);
    const float low = number_of(p.low), high = number_of(p.high), share = (float)random_below(1001) / 1000.0f;
    const float value =
        random_below(3) == 0 ? number_of(p.standard) : low + (high - low) * share * share * share;
    m.as.set_parameter = (palp_wire_set_parameter){id, random_below(20) == 0 ? 0x7fc00000u : bits_of(value)};
    return m;
}

static palp_wire_message any_command(bench *b, uint8_t n) {
    static const uint8_t types[] = {PALP_WIRE_TYPE_HOME,         PALP_WIRE_TYPE_STOP, PALP_WIRE_TYPE_TARE,
                                    PALP_WIRE_TYPE_CLEAR_FAULT,  PALP_WIRE_TYPE_SAVE, PALP_WIRE_TYPE_JOG,
                                    PALP_WIRE_TYPE_FIND_CONTACT, PALP_WIRE_TYPE_START};
    palp_wire_message m = {.type = types[random_below(sizeof types)]};
    if (random_below(2) == 0)
        return any_parameter(b, n);
    if (m.type == PALP_WIRE_TYPE_TARE)
        m.as.tare.samples = 5;
    if (m.type == PALP_WIRE_TYPE_JOG)
        m.as.jog = (palp_wire_jog){(int32_t)random_below(40000000), random_below(12000000)};
    return m.type == PALP_WIRE_TYPE_START ? bench_start(1, -1, 0, 0) : m;
}

/* With any parameters the motor is on only in states that allow it (bench_tick), and flash is not written
 * meanwhile. With the standard values the behaviour is as before. */
static void test_any_machine(void **state) {
    static bench b;
    (void)state;
    open_idle(&b);
    const uint8_t n = configuration(&b).parameters;
    for (int k = 0; k < 3000; k++) {
        palp_wire_message m = any_command(&b, n);
        (void)bench_command(&b, &m);
        if (b.out.stores)
            flash[b.out.store_at] &= b.out.store_word;
        for (uint32_t i = random_below(m.type == PALP_WIRE_TYPE_HOME ? 300 : 40); i > 0; i--)
            tick(&b);
        assert_true(b.app.duty >= -1.0f && b.app.duty <= 1.0f); /* not so a NaN */
    }
    bench_restart(&b, APP_RESET_POWER, 0);
    bench_run(&b, 200);
    bench_home(&b);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_ranges),          cmocka_unit_test(test_what_follows),
    cmocka_unit_test(test_saved),           cmocka_unit_test(test_other_records),
    cmocka_unit_test(test_cannot_be_saved), cmocka_unit_test(test_full_is_full),
    cmocka_unit_test(test_any_machine),     {0},
};
