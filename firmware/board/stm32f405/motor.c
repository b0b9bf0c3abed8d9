/* motor.c: an H-bridge by sign and magnitude (DRV8874 in its PH/EN mode): TIM1's PWM at 20 kHz, a direction,
 * an enable. The emergency stop also reaches TIM1's break input: it holds the PWM low without any program. */
#include "drivers.h"

enum { PWM_HZ = 20000, FULL = 32767 };

void motor_start(uint32_t clock_hz) {
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
}

void motor_set(int16_t duty) {
    const uint32_t magnitude = (uint32_t)(duty < 0 ? -duty : duty);
    gpio_write(PIN_MOTOR_DIRECTION, duty >= 0);
    TIM1->CCR[0] = (magnitude < FULL ? magnitude : FULL) * (TIM1->ARR + 1) / FULL;
    TIM1->BDTR |= TIM_BDTR_MOE; /* stays off while the emergency stop is pressed */
    gpio_write(PIN_MOTOR_ENABLE, true);
}

void motor_off(void) {
    gpio_write(PIN_MOTOR_ENABLE, false);
    TIM1->BDTR &= ~(uint32_t)TIM_BDTR_MOE;
    TIM1->CCR[0] = 0;
}
