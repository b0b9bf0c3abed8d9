/* thermistor.c: ADC1, one conversion a tick: started at one, read at the next. */
#include "drivers.h"

enum { CHANNEL = 10, LONGEST = 7, SETTLE_POLLS = 1000 };

static void convert(void) {
    ADC1->SR = 0;
    ADC1->CR2 |= ADC_CR2_SWSTART;
}

void thermistor_start(void) {
    RCC->APB2ENR |= RCC_APB2ENR_ADC1;
    BARRIER();
    gpio_analog(PIN_THERMISTOR);
    ADC_COMMON->CCR = ADC_CCR_BY_4; /* 21 MHz */
    ADC1->SMPR1 = LONGEST << (CHANNEL - 10) * 3;
    ADC1->SQR3 = CHANNEL;
    ADC1->CR2 = ADC_CR2_ADON;
    (void)wait_for(&ADC1->SR, ADC_SR_EOC, ADC_SR_EOC, SETTLE_POLLS); /* it needs 3 us before the first */
    convert();
}

uint16_t thermistor_read(void) {
    const bool ended = (ADC1->SR & ADC_SR_EOC) != 0;
    const uint16_t counts = ended ? (uint16_t)(ADC1->DR & 0xfff) : 0;
    convert();
    return counts;
}
