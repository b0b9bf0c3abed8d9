/* encoder.c: a quadrature encoder on TIM3, whose 16 bits are extended here. */
#include "drivers.h"

static struct {
    uint16_t last;
    int32_t position;
} encoder;

bool encoder_start(void) {
    RCC->APB1ENR |= RCC_APB1ENR_TIM3;
    BARRIER();
    gpio_alternate(PIN_ENCODER_A, ALTERNATE_TIM3, PULL_UP);
    gpio_alternate(PIN_ENCODER_B, ALTERNATE_TIM3, PULL_UP);
    gpio_input(PIN_ENCODER_GOOD, PULL_DOWN);
    TIM3->SMCR = TIM_SMCR_ENCODER;
    TIM3->CCMR1 = TIM_CCMR1_INPUTS | TIM_CCMR1_FILTERS;
    TIM3->ARR = 0xffff;
    TIM3->CR1 = TIM_CR1_CEN;
    encoder.last = (uint16_t)TIM3->CNT;
    encoder.position = 0;
    return !encoder_lost();
}

bool encoder_lost(void) {
    return !gpio_read(PIN_ENCODER_GOOD);
}

int32_t encoder_read(void) {
    const uint16_t now = (uint16_t)TIM3->CNT;
    encoder.position += (int16_t)(uint16_t)(now - encoder.last);
    encoder.last = now;
    return encoder.position;
}
