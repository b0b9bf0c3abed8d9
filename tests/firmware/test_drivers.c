/* test_drivers.c: the drivers of the STM32F405 on fake registers, also where the hardware does not answer. */
#include "drivers_make.h"

/* Some 100 ms. */
static void assert_bounded(void) {
    assert_true(hardware.polls < 200000);
}

/* ---- clock ---- */

static void test_clock(void **state) {
    (void)state;
    const clock_state c = clock_start();
    assert_true(c.crystal);
    assert_int_equal(c.hz, 168000000);
    assert_int_equal(c.bus_hz, 84000000);
    assert_int_equal(RCC->PLLCFGR, 0x07402a04); /* 8 MHz / 4 * 168 / 2 */
    assert_int_equal(hardware.switched_waits, 5);
    assert_int_equal(RCC->CFGR, 5u << 10 | 4u << 13 | 2u << 2 | 2u); /* APB1 by 4, APB2 by 2, PLL */
    assert_true((RCC->CR & RCC_CR_CSSON) != 0);
    assert_int_equal(FLASH->ACR, 5u | 7u << 8); /* prefetch, both caches */
}

/* The prefetch of the first chips does not work. */
static void test_clock_of_revision_a(void **state) {
    (void)state;
    *REGISTERS_AT(reg, 0xe0042000u) = 0x10000413;
    assert_true(clock_start().crystal);
    assert_int_equal(FLASH->ACR, 5u | 6u << 8);
}

static void test_clock_without_crystal(void **state) {
    (void)state;
    hardware.crystal = false;
    const clock_state c = clock_start();
    assert_false(c.crystal);
    assert_int_equal(c.hz, 168000000);
    assert_int_equal(RCC->PLLCFGR, 0x07002a08); /* 16 MHz / 8 * 168 / 2, of the internal one */
    assert_int_equal(RCC->CR & (RCC_CR_HSEON | RCC_CR_CSSON), 0);
    assert_bounded();
}

static void test_clock_without_pll(void **state) {
    bool *const broken[] = {&hardware.pll, &hardware.flash, &hardware.pll_switch};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        fake_start();
        *broken[i] = false;
        const clock_state c = clock_start();
        assert_false(c.crystal);
        assert_int_equal(c.hz, 16000000);
        assert_int_equal(c.bus_hz, 16000000);
        assert_int_equal(RCC->CFGR, 0);
        assert_bounded();
    }
}

/* A boot loader left the PLL as the clock: the processor leaves it before it is changed. */
static void test_clock_after_boot_loader(void **state) {
    (void)state;
    RCC->CR = RCC_CR_PLLON | RCC_CR_PLLRDY;
    RCC->CFGR = RCC_CFGR_SW_PLL | RCC_CFGR_SWS_PLL;
    assert_true(clock_start().crystal);
}

/* ---- pins ---- */

static void test_gpio(void **state) {
    gpio_registers *a = GPIO(PORT_A);
    (void)state;
    a->MODER = 0xa8000000; /* after a reset: the debugger's pins */
    gpio_alternate(PIN(PORT_A, 9), 7, PULL_UP);
    gpio_output(PIN(PORT_A, 4), true);
    assert_int_equal(a->MODER, 0xa8000000 | 2u << 18 | 1u << 8);
    assert_int_equal(a->AFR[1], 7u << 4);
    assert_int_equal(a->PUPDR, 1u << 18);
    assert_true(fake_pin(PIN(PORT_A, 4)));
    gpio_write(PIN(PORT_A, 4), false);
    assert_false(fake_pin(PIN(PORT_A, 4)));
    gpio_input(PIN(PORT_A, 9), PULL_DOWN);
    assert_int_equal(a->MODER, 0xa8000000 | 1u << 8);
    assert_int_equal(a->PUPDR, 2u << 18);
    fake_set_pin(PIN(PORT_C, 2), true);
    assert_true(gpio_read(PIN(PORT_C, 2)));
    assert_false(gpio_read(PIN(PORT_C, 3)));
}

static void test_open_wire_is_a_pressed_switch(void **state) {
    (void)state;
    switches_start();
    motor_start(168000000);
    assert_int_equal(GPIO(PORT_C)->PUPDR >> 2 & 3, PULL_DOWN);  /* home, PC1 */
    assert_int_equal(GPIO(PORT_B)->PUPDR >> 24 & 3, PULL_DOWN); /* emergency stop, PB12 */
    assert_true(switches_home());
    assert_true(switches_emergency());
    fake_set_pin(PIN_HOME, true);
    fake_set_pin(PIN_EMERGENCY, true);
    assert_false(switches_home());
    assert_false(switches_emergency());
}

/* ---- force sensor ---- */

static void test_sensor_reads_in_order(void **state) {
    int16_t adc[PALP_WIRE_CHANNELS];
    bool held;
    (void)state;
    assert_true(gauge_start());
    for (int i = 0; i < 3; i++) {
        gauge_convert();
        assert_true(gauge_read(adc, &held));
        assert_memory_equal(adc, hardware.channel, sizeof adc);
        assert_true(hardware.cs);
    }
    assert_int_equal(hardware.words, 18);
    /* 16 bits, master, by 8, read at falling edges of a clock that rests high */
    assert_int_equal(hardware.spi_cr1, 1u << 11 | 1u << 9 | 1u << 8 | 1u << 6 | 2u << 3 | 1u << 2 | 1u << 1);
}

/* However it fails to answer: the counts are 0, the wait is short, and it is read again once it answers. */
static void test_sensor_silent(void **state) {
    bool *const broken[] = {&hardware.converter_starts, &hardware.converter_ends, &hardware.spi_answers};
    int16_t adc[PALP_WIRE_CHANNELS];
    bool held;
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        fake_start();
        assert_true(gauge_start());
        *broken[i] = false;
        for (int j = 0; j < 3; j++) {
            hardware.polls = 0;
            gauge_convert();
            adc[0] = adc[5] = 7;
            assert_false(gauge_read(adc, &held));
            assert_int_equal(adc[0], 0);
            assert_int_equal(adc[5], 0);
            assert_true(hardware.cs);
            assert_true(hardware.polls < 2000); /* a tenth of a tick */
        }
        *broken[i] = true;
        (void)gauge_read(adc, &held); /* which resets it */
        gauge_convert();
        assert_true(gauge_read(adc, &held));
        assert_memory_equal(adc, hardware.channel, sizeof adc);
    }
}

static void test_sensor_absent(void **state) {
    (void)state;
    hardware.busy = 1; /* the pull-up of an open wire */
    hardware.stuck = true;
    hardware.converter_ends = false;
    assert_false(gauge_start());
    assert_bounded();
}

/* ---- encoder ---- */

static void test_encoder_wraps(void **state) {
    (void)state;
    fake_set_pin(PIN_ENCODER_GOOD, true);
    TIM3->CNT = 65000;
    assert_true(encoder_start());
    assert_int_equal(TIM3->SMCR, 3);
    assert_int_equal(TIM3->ARR, 65535);
    assert_int_equal(encoder_read(), 0);
    TIM3->CNT = 200;
    assert_int_equal(encoder_read(), 736);
    for (int i = 1; i <= 10; i++) {
        TIM3->CNT = (uint16_t)(200 + 30000 * i);
        assert_int_equal(encoder_read(), 736 + 30000 * i);
    }
    for (int i = 1; i <= 20; i++) {
        TIM3->CNT = (uint16_t)(200 + 300000 - 32000 * i);
        assert_int_equal(encoder_read(), 736 + 300000 - 32000 * i);
    }
}

static void test_encoder_alarm(void **state) {
    (void)state;
    assert_false(encoder_start());
    assert_int_equal(GPIO(PORT_C)->PUPDR >> 4 & 3, PULL_DOWN);
}

/* ---- motor ---- */

static void drive(int16_t duty) {
    motor_drive(&(app_outputs){.duty = duty});
}

static void test_motor(void **state) {
    (void)state;
    motor_start(168000000);
    assert_int_equal(TIM1->ARR, 8147);                          /* 20.6 periods a tick */
    assert_int_equal(TIM1->BDTR, TIM_BDTR_BKE | TIM_BDTR_OSSI); /* off; break at low */
    assert_false(fake_pin(PIN_MOTOR_ENABLE));
    drive(32767);
    assert_int_equal(TIM1->CCR[0], 8148); /* high all the time */
    assert_true(fake_pin(PIN_MOTOR_DIRECTION));
    assert_true(fake_pin(PIN_MOTOR_ENABLE));
    assert_true((TIM1->BDTR & TIM_BDTR_MOE) != 0);
    drive(-16384);
    assert_int_equal(TIM1->CCR[0], 4074);
    assert_false(fake_pin(PIN_MOTOR_DIRECTION));
    drive(INT16_MIN);
    assert_int_equal(TIM1->CCR[0], 8148);
    motor_brake();
    assert_int_equal(TIM1->CCR[0], 0);
    assert_int_equal(TIM1->BDTR & TIM_BDTR_MOE, 0);
    assert_true(fake_pin(PIN_MOTOR_ENABLE));
    drive(5);
    motor_off();
    assert_int_equal(TIM1->CCR[0], 0);
    assert_int_equal(TIM1->BDTR & TIM_BDTR_MOE, 0);
    assert_false(fake_pin(PIN_MOTOR_ENABLE));
}

static uint32_t duty_at_turn; /* which TIM1 had when the direction changed; 1: no update was asked for */

static void watch_turn(void) {
    static bool before;
    if (fake_pin(PIN_MOTOR_DIRECTION) != before)
        duty_at_turn = (TIM1->EGR & TIM_EGR_UG) ? TIM1->CCR[0] : 1;
    before = fake_pin(PIN_MOTOR_DIRECTION);
}

/* The direction changes only after the old magnitude is gone. */
static void test_motor_turns_at_rest(void **state) {
    (void)state;
    hardware.pins = watch_turn;
    motor_start(168000000);
    for (int i = 0; i < 4; i++) {
        drive(i % 2 ? -20000 : 20000);
        TIM1->EGR = 0;
        assert_int_equal(duty_at_turn, 0);
        duty_at_turn = 7;
    }
    drive(-20000);
    assert_int_equal(duty_at_turn, 7); /* no turn: nothing is interrupted */
}

/* A pulse that is over before anybody looks. */
static void test_short_emergency_stop(void **state) {
    app_inputs in;
    (void)state;
    fake_set_pin(PIN_ENCODER_GOOD, true);
    fake_set_pin(PIN_EMERGENCY, true);
    assert_int_equal(hal_init(), 0);
    hal_sense(&in);
    assert_false(in.emergency_stop);
    TIM1->SR |= 1u << 7;
    hal_sense(&in);
    assert_true(in.emergency_stop);
    hal_sense(&in);
    assert_false(in.emergency_stop);
}

static void test_alarms(void **state) {
    app_inputs in;
    (void)state;
    fake_set_pin(PIN_ENCODER_GOOD, true);
    fake_set_pin(PIN_MOTOR_FAULT, true);
    assert_int_equal(hal_init(), 0);
    assert_int_equal(GPIO(PORT_B)->PUPDR >> 30 & 3, PULL_UP); /* nFAULT, PB15 */
    for (int i = 0; i < 2; i++) {
        fake_set_pin(PIN_ENCODER_GOOD, i == 0);
        fake_set_pin(PIN_MOTOR_FAULT, i == 0);
        hal_sense(&in);
        assert_int_equal(in.encoder_lost, i);
        assert_int_equal(in.driver_fault, i);
    }
}

/* ---- supply, guard ---- */

static void test_supply(void **state) {
    (void)state;
    FLASH->OPTCR = 0x0fffaaed; /* as sold: no brown-out reset, locked */
    supply_start();
    assert_int_equal(FLASH->OPTCR, 0x0fffaae3);
    assert_int_equal(FLASH->OPTKEYR, 0x4c5d6e7f);
    assert_int_equal(PWR->CR, 7u << 5 | 1u << 4); /* 2.9 V, on */
    assert_int_equal(EXTI->RTSR & EXTI->IMR, 1u << 16);
    assert_int_equal(NVIC->ISER[0], 1u << 1);
    FLASH->OPTKEYR = 0;
    supply_start(); /* written once only */
    assert_int_equal(FLASH->OPTKEYR, 0);
    motor_start(168000000);
    drive(1000);
    supply_interrupt();
    assert_false(fake_pin(PIN_MOTOR_ENABLE));
    assert_int_equal(SCB->AIRCR, 0x05fa0004);
    assert_int_equal(reset_cause(), APP_RESET_BROWN_OUT);
    RCC->CSR = RCC_CSR_BORRSTF;
    assert_int_equal(reset_cause(), APP_RESET_BROWN_OUT);
    RCC->CSR = RCC_CSR_BORRSTF | RCC_CSR_PORRSTF; /* switched on */
    assert_int_equal(reset_cause(), APP_RESET_POWER);
}

static void test_guard(void **state) {
    (void)state;
    guard_start();
    assert_int_equal(MPU->RBAR, 0);
    assert_int_equal(MPU->RASR, 1u << 28 | 19u << 1 | 1u); /* 1 MiB, no access */
    assert_int_equal(MPU->CTRL, 5);
}

static void test_motor_output_expires(void **state) {
    const app_outputs on = {.duty = 1000, .motor_on = true}, off = {.duty = 1000};
    (void)state;
    (void)hal_init();
    for (int i = 0; i < 3; i++) {
        hal_drive(&on);
        assert_true(fake_pin(PIN_MOTOR_ENABLE));
        tick_interrupt();
        assert_true(fake_pin(PIN_MOTOR_ENABLE));
    }
    tick_interrupt(); /* a tick went by without a new output: it brakes */
    assert_int_equal(TIM1->BDTR & TIM_BDTR_MOE, 0);
    assert_true(fake_pin(PIN_MOTOR_ENABLE));
    assert_int_equal(TIM1->CCR[0], 0);
    hal_drive(&on);
    hal_drive(&off);
    assert_int_equal(TIM1->BDTR & TIM_BDTR_MOE, 0);
    assert_true(fake_pin(PIN_MOTOR_ENABLE));
}

/* ---- tick ---- */

static void test_tick_wait(void **state) {
    (void)state;
    (void)hal_init();
    if (tick_now() != tick.seen)
        (void)hal_tick_wait(); /* those of other tests */
    assert_int_equal(SYSTICK->LOAD, 167999);
    assert_int_equal(SYSTICK->CTRL, 7);
    hardware.sleep = tick_interrupt;
    assert_int_equal(hal_tick_wait(), 1);
    assert_int_equal(hal_tick_wait(), 1);
    hardware.sleep = NULL; /* there is no sleep where ticks have passed */
    tick_interrupt();
    tick_interrupt();
    tick_interrupt();
    assert_int_equal(hal_tick_wait(), 3);
}

/* ---- thermistor ---- */

static void test_thermistor(void **state) {
    (void)state;
    thermistor_start();
    assert_int_equal(ADC1->SQR3, 10);
    assert_int_equal(ADC1->SMPR1, 7);
    assert_int_equal(GPIO(PORT_C)->MODER & 3, 3);
    assert_int_equal(ADC1->CR2, ADC_CR2_ADON | ADC_CR2_SWSTART);
    ADC1->SR = ADC_SR_EOC;
    ADC1->DR = 0xf000 | 2047;
    ADC1->CR2 = ADC_CR2_ADON;
    assert_int_equal(thermistor_read(), 2047);
    assert_int_equal(ADC1->SR, 0);
    assert_int_equal(ADC1->CR2, ADC_CR2_ADON | ADC_CR2_SWSTART); /* the next one */
    assert_int_equal(thermistor_read(), 0);                      /* which never ends */
    assert_bounded();
}

/* ---- watchdog and resets ---- */

static void test_watchdog(void **state) {
    (void)state;
    IWDG->SR = 3; /* never takes over */
    watchdog_start();
    assert_bounded();
    assert_int_equal(IWDG->PR, 0);
    assert_int_equal(IWDG->RLR, 160); /* 20 ms of 32 kHz by 4 */
    IWDG->KR = 0;
    hal_watchdog_kick();
    assert_int_equal(IWDG->KR, 0xaaaa);
}

static void test_reset_cause(void **state) {
    (void)state;
    reset_because(APP_RESET_STACK);
    assert_int_equal(SCB->AIRCR, 0x05fa0004);
    assert_int_equal(reset_cause(), APP_RESET_STACK);
    assert_true((RCC->CSR & RCC_CSR_RMVF) != 0);
    assert_int_equal(reset_cause(), APP_RESET_POWER); /* said once */
    RCC->CSR = RCC_CSR_IWDGRSTF;
    assert_int_equal(reset_cause(), APP_RESET_WATCHDOG);
    reset_because(APP_RESET_STACK);
    RCC->CSR = RCC_CSR_PORRSTF; /* after power-on the memory may hold anything */
    assert_int_equal(reset_cause(), APP_RESET_POWER);
    RCC->CSR = 0;
    reset_note = 0x12345601;
    assert_int_equal(reset_cause(), APP_RESET_POWER);
}

/* ---- stack ---- */

static uint32_t settled_free(void) {
    for (int i = 0; i < 300; i++)
        (void)stack_free();
    return stack_free();
}

static void test_stack(void **state) {
    (void)state;
    stack_paint();
    stack_words[1010] = 0;
    assert_int_equal(settled_free(), 4000);
    stack_words[700] = 0; /* a deeper call with a gap in what it wrote */
    assert_int_equal(settled_free(), 2800);
    assert_true(hal_stack_intact());
    stack_words[8] = 0;
    assert_true(hal_stack_intact());
    stack_words[7] = 0;
    assert_false(hal_stack_intact());
    assert_true(hal_stack_intact()); /* said once, then watched anew */
    assert_true(stack_overran((uintptr_t)stack_words - 4));
    assert_false(stack_overran((uintptr_t)(stack_words + 8)));
}

/* ---- the board ---- */

/* Its edge is kept until it has been seen; no interrupt comes of it. */
static void test_trigger(void **state) {
    (void)state;
    trigger_start();
    assert_int_equal(SYSCFG->EXTICR[2] & 15u, 2); /* line 8 is port C's */
    assert_true(EXTI->RTSR & 1u << 8);
    assert_int_equal(NVIC->ISER[0] & 1u << 23, 0); /* EXTI9_5 */
    assert_int_equal(EXTI->PR, 1u << 8);
    EXTI->PR = 0; /* what the write of a one does */
    assert_false(trigger_came());
    EXTI->PR = 1u << 8;
    assert_true(trigger_came());
    EXTI->PR = 0;
    assert_false(trigger_came());
    trigger_give(true);
    assert_true(fake_pin(PIN_TRIGGER_OUT));
    trigger_give(false);
    assert_false(fake_pin(PIN_TRIGGER_OUT));
}

static void test_board(void **state) {
    app_inputs in;
    (void)state;
    fake_set_pin(PIN_ENCODER_GOOD, true);
    fake_set_pin(PIN_HOME, true);
    assert_int_equal(hal_init(), 0);
    assert_false(hal_is_simulated());
    ADC1->SR = ADC_SR_EOC;
    ADC1->DR = 1000;
    TIM3->CNT = 0xfff0;
    tick_interrupt();
    TIM3->CNT = 0xffe0; /* after the tick: not this one's */
    hal_sense(&in);
    assert_int_equal(in.position, -16);
    assert_memory_equal(in.adc, hardware.channel, sizeof in.adc);
    assert_int_equal(in.thermistor, 1000);
    assert_false(in.sensor_silent);
    assert_false(in.home_switch);
    assert_true(in.emergency_stop);
}

static void test_board_says_what_failed(void **state) {
    app_inputs in;
    (void)state;
    hardware.crystal = false;
    hardware.busy = 1;
    hardware.stuck = true;
    hardware.converter_ends = false;
    assert_int_equal(hal_init(), APP_CLOCK_FAILED | APP_SENSOR_FAILED | APP_ENCODER_FAILED);
    tick_interrupt();
    hal_sense(&in);
    assert_true(in.sensor_silent);
    assert_bounded();
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_clock, setup),
    cmocka_unit_test_setup(test_clock_without_crystal, setup),
    cmocka_unit_test_setup(test_clock_without_pll, setup),
    cmocka_unit_test_setup(test_clock_after_boot_loader, setup),
    cmocka_unit_test_setup(test_gpio, setup),
    cmocka_unit_test_setup(test_open_wire_is_a_pressed_switch, setup),
    cmocka_unit_test_setup(test_sensor_reads_in_order, setup),
    cmocka_unit_test_setup(test_sensor_silent, setup),
    cmocka_unit_test_setup(test_sensor_absent, setup),
    cmocka_unit_test_setup(test_encoder_wraps, setup),
    cmocka_unit_test_setup(test_encoder_alarm, setup),
    cmocka_unit_test_setup(test_clock_of_revision_a, setup),
    cmocka_unit_test_setup(test_motor, setup),
    cmocka_unit_test_setup(test_motor_turns_at_rest, setup),
    cmocka_unit_test_setup(test_short_emergency_stop, setup),
    cmocka_unit_test_setup(test_alarms, setup),
    cmocka_unit_test_setup(test_supply, setup),
    cmocka_unit_test_setup(test_trigger, setup),
    cmocka_unit_test_setup(test_guard, setup),
    cmocka_unit_test_setup(test_motor_output_expires, setup),
    cmocka_unit_test_setup(test_tick_wait, setup),
    cmocka_unit_test_setup(test_thermistor, setup),
    cmocka_unit_test_setup(test_watchdog, setup),
    cmocka_unit_test_setup(test_reset_cause, setup),
    cmocka_unit_test_setup(test_stack, setup),
    cmocka_unit_test_setup(test_board, setup),
    cmocka_unit_test_setup(test_board_says_what_failed, setup),
    {0},
};
