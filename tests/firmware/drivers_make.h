/* drivers_make.h: the drivers, on registers that are memory. */
#ifndef DRIVERS_MAKE_H
#define DRIVERS_MAKE_H

#include "fake_registers.h"

#include "../../firmware/board/stm32f405/board.c"
#include "../../firmware/board/stm32f405/clock.c"
#include "../../firmware/board/stm32f405/flash.c"
#include "../../firmware/board/stm32f405/gpio.c"
#include "../../firmware/board/stm32f405/guard.c"
#include "../../firmware/board/stm32f405/supply.c"
#include "../../firmware/board/stm32f405/switches.c"
#include "../../firmware/board/stm32f405/thermistor.c"
#include "../../firmware/board/stm32f405/tick.c"
#include "../../firmware/board/stm32f405/trigger.c"
#include "../../firmware/board/stm32f405/uart.c"
#include "../../firmware/board/stm32f405/watchdog.c"

/* The devices of the voice coil's board, or of the stepper's with this amplifier. */
#ifdef DRIVERS_AMPLIFIER
#include "../../firmware/board/stepper/sensor_cell.c"
#include "../../firmware/board/stepper/steps.c"
#include DRIVERS_AMPLIFIER
#else
#include "../../firmware/board/stm32f405/encoder.c"
#include "../../firmware/board/stm32f405/motor.c"
#include "../../firmware/board/stm32f405/sensor_ad7606.c"
#endif

volatile uint32_t reset_note;
#include "../../firmware/board/stm32f405/reset.c"

static uint32_t stack_words[1024];
#define STACK_BOTTOM stack_words
#define STACK_TOP (stack_words + 1024)
#define STACK_NOW (stack_words + 1000)
#include "../../firmware/board/stm32f405/stack.c"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static inline int setup(void **state) {
    (void)state;
    fake_start();
    return 0;
}

#endif
