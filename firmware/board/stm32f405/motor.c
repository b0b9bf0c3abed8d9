/* motor.c: an H-bridge by sign and magnitude (DRV8874 in its PH/EN mode): TIM1's PWM, a direction, an enable
 * (nSLEEP). While it is enabled and the PWM low, both of its outputs are low: the motor brakes. The emergency
 * stop also reaches TIM1's break input: it holds the PWM low, and so brakes, without any program. */
#include "drivers.h"

/* A control tick has 20.62 periods, not a whole number. The ripple of the current so reaches the sensor's
 * samples as noise of 93 Hz and above. With a whole number it would be an offset that changes with the duty.
 */
enum { PWM_HZ = 20618, FULL = 32767 };

static bool down; /* the direction */

void motor_start(uint32_t clock_hz) {
    down = false;
    gpio_input(PIN_MOTOR_FAULT, PULL_UP);
    gpio_output(PIN_MOTOR_ENABLE, false);
    gpio_output(PIN_MOTOR_DIRECTION, false);
    RCC->APB2ENR |= RCC_APB2ENR_TIM1;
    BARRIER();
    TIM1->ARR = clock_hz / PWM_HZ - 1;
    TIM1->CCMR1 = TIM_CCMR1_PWM;
    TIM1->CCR[0] = 0;
    TIM1->CCER = TIM_CCER_CC1E;
    TIM1->BDTR = TIM_BDTR_BKE | TIM_BDTR_OSSI; /* break at low; driven low while it is off */
    TIM1->EGR = TIM_EGR_UG;
    TIM1->CR1 = TIM_CR1_ARPE | TIM_CR1_CEN;
    gpio_alternate(PIN_EMERGENCY, ALTERNATE_TIM1, PULL_DOWN);
    gpio_alternate(PIN_MOTOR_PWM, ALTERNATE_TIM1, PULL_DOWN);
    TIM1->SR = 0; /* its pins have just been connected */
}

/* The new magnitude waits for the period's end; the old one must not act in the new direction meanwhile. */
static void set_direction(bool to_down) {
    if (to_down == down)
        return;
    TIM1->CCR[0] = 0;
    TIM1->EGR = TIM_EGR_UG; /* now */
    gpio_write(PIN_MOTOR_DIRECTION, to_down);
    down = to_down;
}

static void set(int16_t duty) {
    const uint32_t magnitude = (uint32_t)(duty < 0 ? -duty : duty);
    set_direction(duty >= 0);
    TIM1->CCR[0] = (magnitude < FULL ? magnitude : FULL) * (TIM1->ARR + 1) / FULL;
    TIM1->BDTR |= TIM_BDTR_MOE; /* stays off while the emergency stop is pressed */
    gpio_write(PIN_MOTOR_ENABLE, true);
}

void motor_drive(const app_outputs *outputs) {
    set(outputs->duty);
}

static void pwm_off(void) {
    TIM1->BDTR &= ~(uint32_t)TIM_BDTR_MOE;
    TIM1->CCR[0] = 0;
}

void motor_brake(void) {
    pwm_off();
    gpio_write(PIN_MOTOR_ENABLE, true);
}

void motor_off(void) {
    gpio_write(PIN_MOTOR_ENABLE, false);
    pwm_off();
}

bool motor_stopped(void) {
    const bool stopped = (TIM1->SR & TIM_SR_BIF) != 0;
    TIM1->SR = ~(uint32_t)TIM_SR_BIF; /* the others stay as they are */
    return stopped;
}

bool motor_fault(void) {
    return !gpio_read(PIN_MOTOR_FAULT);
}
