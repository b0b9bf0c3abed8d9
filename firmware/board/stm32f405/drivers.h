/* drivers.h: the drivers of the STM32F405, one .c file each. None waits without a bound. */
#ifndef DRIVERS_H
#define DRIVERS_H

#include "app.h"
#include "hal.h"
#include "pins.h"
#include "registers.h"
#include "serial.h"

/* clock.c */
enum { CLOCK_HSI_HZ = 16000000, CLOCK_FULL_HZ = 168000000 };
/* 168 MHz from the crystal; without it from the internal oscillator (1 % off), or else that oscillator's own
 * rate. */
typedef struct clock_state {
    uint32_t hz;     /* of the processor and of TIM1 */
    uint32_t bus_hz; /* of USART1 and SPI1 */
    bool crystal;
} clock_state;
clock_state clock_start(void);

/* gpio.c */
typedef enum pin_pull { PULL_NONE, PULL_UP, PULL_DOWN } pin_pull;
void gpio_start(void);
void gpio_input(uint8_t pin, pin_pull pull);
void gpio_analog(uint8_t pin);
void gpio_output(uint8_t pin, bool level);
void gpio_alternate(uint8_t pin, uint8_t function, pin_pull pull);
void gpio_write(uint8_t pin, bool level);
bool gpio_read(uint8_t pin);

/* tick.c: SysTick at CONTROL_HZ. The board's board_tick() runs in its interrupt, first. */
void tick_start(uint32_t clock_hz);
uint32_t tick_now(void);   /* ticks since tick_start */
void tick_renew(void);     /* the motor's output holds until the tick after next, which brakes it */
uint32_t tick_spent(void); /* cycles between the last wake and the sleep after it */
void tick_interrupt(void);
void board_tick(void);
uint32_t board_cycles(void); /* a free-running count; instructions where simulated */

/* uart.c: USART1 at 921600 baud, serial.h */
void uart_start(uint32_t bus_hz);
void uart_interrupt(void);

/* sensor_ad7606.c, which also names the board and its machine; ../stepper/sensor_cell.c */
bool gauge_start(void);   /* false: it does not come out of its reset */
void gauge_convert(void); /* all channels, at once */
/* False: no answer; adc is then 0. held: no new sample since the last call. */
bool gauge_read(int16_t adc[PALP_WIRE_CHANNELS], bool *held);

/* encoder.c; ../stepper/steps.c */
bool encoder_start(void);   /* false: its alarm is on */
int32_t encoder_read(void); /* counts since encoder_start; must be called at least every 32767 counts */
bool encoder_lost(void);    /* its alarm, now */

/* motor.c; ../stepper/steps.c */
void motor_start(uint32_t clock_hz);
void motor_drive(const app_outputs *outputs);
void motor_brake(void);   /* its ends joined: no current but that of its own motion */
void motor_off(void);     /* its ends open */
bool motor_stopped(void); /* true once after each pulse at the emergency stop, however short */
bool motor_fault(void);   /* the driver's alarm, now */

/* supply.c: the processor's supply */
void supply_start(void);
void supply_interrupt(void);

/* flash.c: the parameters' flash, hal.h; erases what store_to_erase says */
void flash_start(void);

/* guard.c: no null pointers */
void guard_start(void);

/* thermistor.c */
void thermistor_start(void);
uint16_t thermistor_read(void); /* 12 bits, as of the last call; 0 if the conversion has not ended */

/* switches.c */
void switches_start(void);
bool switches_home(void);
bool switches_emergency(void);

/* trigger.c: a camera's wires */
void trigger_start(void);
bool trigger_came(void); /* true once for all rising edges since the last call */
void trigger_give(bool high);

/* watchdog.c */
void watchdog_start(void);

/* reset.c */
uint8_t reset_cause(void); /* APP_RESET_*; clears it for the next start */
void reset_because(uint8_t cause);

/* stack.c */
void stack_paint(void); /* at the very start */
bool stack_overran(uintptr_t pointer);
uint32_t stack_free(void);

#endif
