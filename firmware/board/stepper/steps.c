/* steps.c: in the place of motor and encoder a stepper's driver by step and direction (TMC2209, A4988,
 * DRV8825). TIM1 gives the steps of a tick as one burst of pulses within its first four fifths, counted by
 * its repetition counter. The plate's position is the sum of the steps given. The emergency stop ends a burst
 * in hardware, at TIM1's break input. How many pulses were given is then not known, and the position is lost,
 * as it is when the driver is off. */
#include "../stm32f405/drivers.h"

enum {
    TIMER_HZ = 21000000,
    BURST = 16800,   /* of the timer, for all pulses: 0.8 ms */
    PULSE = 210,     /* 10 us high, at the end of each step, long after the direction was set */
    STEPS_MOST = 12, /* a tick; a faster reference leaves the plate behind: a following error */
    LOST_TICKS = 3   /* in so many ticks: one alone counts as a glitch */
};

static struct {
    int32_t place; /* counts, all bursts done */
    uint32_t lost;
} steps;

void motor_start(uint32_t clock_hz) {
    gpio_input(PIN_MOTOR_FAULT, PULL_UP);
    gpio_output(PIN_MOTOR_ENABLE, true); /* high is off */
    gpio_output(PIN_MOTOR_DIRECTION, false);
    RCC->APB2ENR |= RCC_APB2ENR_TIM1;
    BARRIER();
    TIM1->PSC = clock_hz > TIMER_HZ ? clock_hz / TIMER_HZ - 1 : 0; /* without the crystal nothing moves */
    TIM1->CCMR1 = TIM_CCMR1_PWM_LATE;
    TIM1->CCER = TIM_CCER_CC1E;
    TIM1->BDTR = TIM_BDTR_BKE | TIM_BDTR_OSSI; /* break at low; driven low while it is off */
    gpio_alternate(PIN_EMERGENCY, ALTERNATE_TIM1, PULL_DOWN);
    gpio_alternate(PIN_MOTOR_PWM, ALTERNATE_TIM1, PULL_DOWN);
    TIM1->SR = 0; /* its pins have just been connected */
}

static void burst(uint32_t n) {
    TIM1->ARR = BURST / n - 1;
    TIM1->CCR[0] = BURST / n - PULSE;
    TIM1->RCR = n - 1;
    TIM1->EGR = TIM_EGR_UG;     /* takes these over */
    TIM1->BDTR |= TIM_BDTR_MOE; /* stays off while the emergency stop is pressed */
    TIM1->CR1 = TIM_CR1_OPM | TIM_CR1_CEN;
}

void motor_drive(const app_outputs *outputs) {
    const int32_t way = outputs->place - steps.place;
    const bool down = way > 0;
    uint32_t n = (uint32_t)(down ? way : -way);
    n = n < STEPS_MOST ? n : STEPS_MOST;
    motor_brake();
    if (n == 0 || (TIM1->CR1 & TIM_CR1_CEN) != 0) /* a burst that has not ended: the tick came too early */
        return;
    gpio_write(PIN_MOTOR_DIRECTION, down);
    burst(n);
    steps.place += down ? (int32_t)n : -(int32_t)n;
}

/* Holds the plate: the driver stays on, and gets no more steps. */
void motor_brake(void) {
    gpio_write(PIN_MOTOR_ENABLE, false);
}

void motor_off(void) {
    gpio_write(PIN_MOTOR_ENABLE, true);
    TIM1->CR1 = 0;
    steps.lost = LOST_TICKS;
}

bool motor_stopped(void) {
    const bool stopped = (TIM1->SR & TIM_SR_BIF) != 0;
    TIM1->SR = ~(uint32_t)TIM_SR_BIF; /* the others stay as they are */
    steps.lost = stopped ? (uint32_t)LOST_TICKS : steps.lost;
    return stopped;
}

bool motor_fault(void) {
    return !gpio_read(PIN_MOTOR_FAULT);
}

bool encoder_start(void) {
    steps.place = 0;
    steps.lost = 0;
    return true;
}

int32_t encoder_read(void) {
    return steps.place;
}

bool encoder_lost(void) {
    const bool lost = steps.lost > 0;
    steps.lost -= lost;
    return lost;
}
