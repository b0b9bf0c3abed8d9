/* pins.h: the pin map (doc/indenter.md says what to connect). */
#ifndef PINS_H
#define PINS_H

#define PIN(port, number) ((port)*16 + (number))
enum { PORT_A, PORT_B, PORT_C };

enum {
    PIN_SENSOR_CS = PIN(PORT_A, 4),
    PIN_SENSOR_CLOCK = PIN(PORT_A, 5),   /* SPI1_SCK */
    PIN_SENSOR_DATA = PIN(PORT_A, 6),    /* SPI1_MISO */
    PIN_SENSOR_COMMAND = PIN(PORT_A, 7), /* SPI1_MOSI; of the ADS1220 alone */
    PIN_SENSOR_CONVERT = PIN(PORT_B, 0),
    PIN_SENSOR_BUSY = PIN(PORT_B, 1), /* pulled up: an open wire is a converter that never ends */
    PIN_SENSOR_RESET = PIN(PORT_C, 4),
    PIN_ENCODER_A = PIN(PORT_C, 6),    /* TIM3_CH1 */
    PIN_ENCODER_B = PIN(PORT_C, 7),    /* TIM3_CH2 */
    PIN_ENCODER_GOOD = PIN(PORT_C, 2), /* pulled down: low or open = alarm */
    PIN_MOTOR_PWM = PIN(PORT_A, 8),    /* TIM1_CH1 */
    PIN_MOTOR_DIRECTION = PIN(PORT_B, 13),
    PIN_MOTOR_ENABLE = PIN(PORT_B, 14), /* the driver pulls it down: off while the processor is in reset */
    PIN_MOTOR_FAULT = PIN(PORT_B, 15),  /* pulled up: low = the driver has switched itself off */
    PIN_EMERGENCY = PIN(PORT_B, 12),    /* TIM1_BKIN; pulled down: low or open = pressed */
    PIN_HOME = PIN(PORT_C, 1),          /* pulled down: low or open = at home */
    PIN_THERMISTOR = PIN(PORT_C, 0),    /* ADC1_IN10 */
    PIN_TRIGGER_IN = PIN(PORT_C, 8),    /* pulled down; rising edges */
    PIN_TRIGGER_OUT = PIN(PORT_C, 9),
    PIN_UART_TX = PIN(PORT_A, 9), /* USART1_TX */
    PIN_UART_RX = PIN(PORT_A, 10) /* USART1_RX */
};

enum { ALTERNATE_TIM1 = 1, ALTERNATE_TIM3 = 2, ALTERNATE_SPI1 = 5, ALTERNATE_USART1 = 7 };

#endif
