/* gpio.c: pins as inputs, outputs and alternate functions. */
#include "drivers.h"

enum { MODE_INPUT, MODE_OUTPUT, MODE_ALTERNATE, MODE_ANALOG };
enum { SPEED_MEDIUM = 1, SPEED_FAST = 2 };

static gpio_registers *port_of(uint8_t pin) {
    return GPIO((uint32_t)pin >> 4);
}

/* Replaces the field of so many bits that belongs to this pin. */
static void set_field(reg *address, uint32_t index, uint32_t bits, uint32_t value) {
    const uint32_t mask = ((1u << bits) - 1) << (index * bits);
    *address = (*address & ~mask) | (value << (index * bits) & mask);
}

static void set_mode(uint8_t pin, uint32_t mode) {
    set_field(&port_of(pin)->MODER, pin & 15u, 2, mode);
}

void gpio_start(void) {
    RCC->AHB1ENR |= RCC_AHB1ENR_GPIOABC;
    BARRIER();
}

void gpio_input(uint8_t pin, pin_pull pull) {
    set_field(&port_of(pin)->PUPDR, pin & 15u, 2, pull);
    set_mode(pin, MODE_INPUT);
}

void gpio_analog(uint8_t pin) {
    set_field(&port_of(pin)->PUPDR, pin & 15u, 2, PULL_NONE);
    set_mode(pin, MODE_ANALOG);
}

void gpio_output(uint8_t pin, bool level) {
    gpio_write(pin, level); /* before it drives */
    set_field(&port_of(pin)->OSPEEDR, pin & 15u, 2, SPEED_MEDIUM);
    set_mode(pin, MODE_OUTPUT);
}

void gpio_alternate(uint8_t pin, uint8_t function, pin_pull pull) {
    gpio_registers *port = port_of(pin);
    set_field(&port->PUPDR, pin & 15u, 2, pull);
    set_field(&port->OSPEEDR, pin & 15u, 2, SPEED_FAST);
    set_field(&port->AFR[(pin & 15u) >> 3], pin & 7u, 4, function);
    set_mode(pin, MODE_ALTERNATE);
}

void gpio_write(uint8_t pin, bool level) {
    gpio_registers *port = port_of(pin);
    port->BSRR = 1u << (pin & 15u) << (level ? 0 : 16);
    POLLED(&port->BSRR);
}

bool gpio_read(uint8_t pin) {
    return (port_of(pin)->IDR >> (pin & 15u) & 1u) != 0;
}
