/* fake_registers.h: memory in the place of the STM32F405's registers, and what acts on it as the hardware.
 * To be included before the drivers' own files. */
#ifndef FAKE_REGISTERS_H
#define FAKE_REGISTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define REGISTERS_AT(type, address) ((type *)fake_at(address))
#define POLLED(address) fake_polled(address)
#define SLEEP() fake_sleep()
#define INTERRUPTS_OFF() ((void)0)
#define INTERRUPTS_ON() ((void)0)
#define BARRIER() ((void)0)

enum { FAKE_BLOCKS = 32, FAKE_WORDS = 256, FAKE_SENT = 256, FAKE_NOT_SWITCHED = 99, FAKE_STORED = 1536 };

typedef struct fake {
    /* what the hardware does: all true where it is healthy */
    bool crystal, pll, flash, pll_switch;
    bool converter_starts, converter_ends, spi_answers;
    bool chip_uart; /* its data register is full after a write; QEMU's never is */
    int16_t channel[8];
    void (*pins)(void);  /* told of what was written to a pin */
    void (*sleep)(void); /* what happens while the processor sleeps */
    /* what has happened to it */
    uint32_t polls;
    uint32_t switched_waits; /* of the flash, when the PLL became the clock */
    int busy, next_channel, words;
    bool stuck;       /* the converter, until it is reset */
    bool convert, cs; /* last levels */
    uint32_t spi_cr1; /* at the last word */
    uint8_t sent[FAKE_SENT];
    size_t n_sent;
    uintptr_t address[FAKE_BLOCKS];
    uint32_t word[FAKE_BLOCKS][FAKE_WORDS];
    uint32_t stored[FAKE_STORED]; /* the flash of the parameters */
    bool flash_hangs;
} fake;

extern fake hardware;

void fake_start(void); /* healthy, all registers 0 */
void fake_set_pin(uint8_t pin, bool level);
bool fake_pin(uint8_t pin); /* as written */

void *fake_at(uintptr_t address); /* the block of registers there, made at its first use */
/* Before each look of a wait and each byte received, after each write to a pin. */
void fake_polled(const volatile uint32_t *address);
void fake_sleep(void);

#endif
