/* test_drivers_stepper.c: the cheap machine's board on registers that are memory: steps, HX711. */
#define DRIVERS_AMPLIFIER "../../firmware/board/stepper/sensor_hx711.c"
#include "drivers_make.h"

/* ---- an HX711: each rising edge of its clock shifts a bit out, the first of them the highest ---- */

static struct {
    int32_t sample;
    int bits;
    bool clock;
} hx711;

static void shift(void) {
    const bool clock = fake_pin(PIN_SENSOR_CLOCK);
    if (clock && !hx711.clock) {
        hx711.bits++;
        fake_set_pin(PIN_SENSOR_DATA,
                     hx711.bits > 24 || ((uint32_t)hx711.sample >> (24 - hx711.bits) & 1u) != 0);
    }
    hx711.clock = clock;
}

static void converts(int32_t counts) {
    hx711.sample = counts;
    hx711.bits = 0;
    fake_set_pin(PIN_SENSOR_DATA, false);
}

static void start(void) {
    fake_set_pin(PIN_EMERGENCY, true);
    fake_set_pin(PIN_HOME, true);
    fake_set_pin(PIN_MOTOR_FAULT, true);
    fake_set_pin(PIN_SENSOR_DATA, true);
    hardware.pins = shift;
    assert_int_equal(hal_init(), 0);
}

static void test_cell(void **state) {
    static const int32_t samples[] = {0, 64, -64, 1000000, -1000000, 0x7fffff, -0x800000};
    static const int16_t counts[] = {0, 1, -1, 15625, -15625, 32767, -32768};
    app_inputs in;
    (void)state;
    start();
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
        converts(samples[i]);
        hal_sense(&in);
        assert_int_equal(hx711.bits, 25); /* the last one asks for gain 128 again */
        assert_false(in.force_held || in.sensor_silent);
        assert_int_equal(in.adc[0], counts[i]);
        for (int k = 1; k < PALP_WIRE_CHANNELS; k++)
            assert_int_equal(in.adc[k], 0);
        hal_sense(&in); /* nothing new */
        assert_true(in.force_held);
        assert_int_equal(in.adc[0], counts[i]);
        assert_int_equal(hx711.bits, 25);
    }
    for (int i = 0; i < 70; i++)
        hal_sense(&in);
    assert_true(in.sensor_silent);
    converts(5);
    hal_sense(&in);
    assert_false(in.sensor_silent);
    assert_ptr_equal(hal_machine(), &machine_stepper);
}

/* ---- steps ---- */

static int32_t position(void) {
    app_inputs in;
    TIM1->CR1 &= ~(uint32_t)TIM_CR1_CEN; /* the burst is over */
    tick_interrupt();
    hal_sense(&in);
    return in.position;
}

static void go(int32_t place) {
    hal_drive(&(app_outputs){.place = place, .motor_on = true});
}

static void test_bursts(void **state) {
    static const int32_t place[] = {1, 8, 3, 3, -9};
    static const uint32_t pulses[] = {1, 7, 5, 0, 12};
    (void)state;
    start();
    assert_int_equal(TIM1->PSC, 7); /* 21 MHz */
    for (size_t i = 0; i < sizeof pulses / sizeof pulses[0]; i++) {
        TIM1->RCR = 99;
        go(place[i]);
        assert_false(fake_pin(PIN_MOTOR_ENABLE)); /* on */
        if (pulses[i] > 0) {
            assert_int_equal(TIM1->RCR, pulses[i] - 1);
            assert_true((TIM1->ARR + 1) * pulses[i] <= 16800 && TIM1->ARR + 1 > 2 * 210);
            assert_int_equal(TIM1->ARR + 1 - TIM1->CCR[0], 210); /* 10 us, at the end */
            assert_int_equal(TIM1->CR1, TIM_CR1_OPM | TIM_CR1_CEN);
            assert_int_equal(fake_pin(PIN_MOTOR_DIRECTION), i < 2);
        } else {
            assert_int_equal(TIM1->RCR, 99);
        }
        assert_int_equal(position(), place[i]);
    }
    go(-100); /* more than a tick can do */
    assert_int_equal(position(), -21);
    go(-30);
    TIM1->RCR = 99;
    go(-40); /* while the burst before is not over: none, and none is counted */
    assert_int_equal(TIM1->RCR, 99);
    assert_int_equal(position(), -30);
}

/* Held without steps; off, the position is lost. */
static void test_holds(void **state) {
    app_inputs in;
    (void)state;
    start();
    go(5);
    (void)position();
    hal_drive(&(app_outputs){.place = 50});
    assert_false(fake_pin(PIN_MOTOR_ENABLE));
    assert_int_equal(position(), 5);
    motor_off();
    assert_true(fake_pin(PIN_MOTOR_ENABLE));
    for (int i = 0; i < 3; i++) {
        hal_sense(&in);
        assert_true(in.encoder_lost);
    }
    hal_sense(&in);
    assert_false(in.encoder_lost);
}

/* The stop's pulse may end a burst: told for so long that the core believes it. */
static void test_emergency(void **state) {
    app_inputs in;
    (void)state;
    start();
    hal_sense(&in);
    assert_false(in.emergency_stop || in.encoder_lost);
    TIM1->SR |= TIM_SR_BIF;
    hal_sense(&in);
    assert_true(in.emergency_stop && in.encoder_lost);
    hal_sense(&in);
    assert_true(!in.emergency_stop && in.encoder_lost);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_cell, setup),
    cmocka_unit_test_setup(test_bursts, setup),
    cmocka_unit_test_setup(test_holds, setup),
    cmocka_unit_test_setup(test_emergency, setup),
    {0},
};
