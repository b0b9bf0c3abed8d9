/* fake_registers.c: the hardware behind the fake registers. */
#include "fake_registers.h"

#include "../../firmware/board/stm32f405/drivers.h"

#include <setjmp.h>
#include <string.h>
#include <stdarg.h>

#include <cmocka.h>

/* In a data register: not written since it was last looked at. */
enum { SEEN = 0x10000 };

fake hardware;

void *fake_at(uintptr_t address) {
    int i = 0;
    if (address == 0x080e0000u - sizeof hardware.stored / 2)
        return hardware.stored;
    while (i < FAKE_BLOCKS && hardware.address[i] != address && hardware.address[i] != 0)
        i++;
    assert_true(i < FAKE_BLOCKS);
    hardware.address[i] = address;
    return hardware.word[i];
}

void fake_start(void) {
    hardware = (fake){.crystal = true,
                      .pll = true,
                      .flash = true,
                      .pll_switch = true,
                      .converter_starts = true,
                      .converter_ends = true,
                      .spi_answers = true,
                      .channel = {1, -2, 32767, -32768, 0x1234, -1, 77, 88},
                      .switched_waits = FAKE_NOT_SWITCHED,
                      .convert = true,
                      .cs = true};
    memset(hardware.stored, 0xff, sizeof hardware.stored);
    FLASH->CR = FLASH_CR_LOCK;
    USART1->SR = USART_SR_TXE;
    USART1->DR = SEEN;
}

static void set_bits(reg *address, uint32_t bits, bool on) {
    *address = on ? *address | bits : *address & ~bits;
}

void fake_set_pin(uint8_t pin, bool level) {
    set_bits(&GPIO((uint32_t)pin / 16)->IDR, 1u << pin % 16, level);
}

bool fake_pin(uint8_t pin) {
    return (GPIO((uint32_t)pin / 16)->ODR >> pin % 16 & 1u) != 0;
}

static void clocks(void) {
    set_bits(&RCC->CR, RCC_CR_HSIRDY, (RCC->CR & RCC_CR_HSION) != 0);
    set_bits(&RCC->CR, RCC_CR_HSERDY, hardware.crystal && (RCC->CR & RCC_CR_HSEON) != 0);
    /* It does not stop while it is the clock. */
    set_bits(&RCC->CR, RCC_CR_PLLRDY,
             (hardware.pll && (RCC->CR & RCC_CR_PLLON) != 0) ||
                 (RCC->CFGR & RCC_CFGR_SWS) == RCC_CFGR_SWS_PLL);
    if (!hardware.flash)
        FLASH->ACR = 0;
    const uint32_t wanted = RCC->CFGR & RCC_CFGR_SW;
    if (wanted == RCC_CFGR_SW_PLL && hardware.switched_waits == FAKE_NOT_SWITCHED)
        hardware.switched_waits = FLASH->ACR & FLASH_ACR_LATENCY;
    if (hardware.pll_switch || wanted == 0)
        RCC->CFGR = (RCC->CFGR & ~(uint32_t)RCC_CFGR_SWS) | wanted << 2;
}

/* An erasure in sector 10 or 11 takes a few looks; its half of the parameters is blank then. */
static void flash(void) {
    if ((FLASH->CR & FLASH_CR_LOCK) != 0 && FLASH->KEYR == FLASH_KEY_2)
        FLASH->CR = 0;
    FLASH->KEYR = 0;
    set_bits(&FLASH->SR, FLASH_SR_BSY, hardware.flash_hangs);
    if ((FLASH->CR & FLASH_CR_STRT) == 0 || hardware.flash_hangs)
        return;
    assert_int_equal(FLASH->CR & FLASH_CR_SER, FLASH_CR_SER);
    const uint32_t sector = FLASH->CR >> 3 & 15, half = FAKE_STORED / 2;
    assert_true(sector == 10 || sector == 11);
    memset(hardware.stored + (sector - 10) * half, 0xff, half * sizeof(uint32_t));
    FLASH->CR &= ~(uint32_t)FLASH_CR_STRT;
}

static void outputs(void) {
    for (uint32_t port = PORT_A; port <= PORT_C; port++) {
        gpio_registers *g = GPIO(port);
        g->ODR = (g->ODR | (g->BSRR & 0xffff)) & ~(g->BSRR >> 16);
        g->BSRR = 0;
    }
    if (hardware.pins)
        hardware.pins();
}

/* A rising edge of its start begins a conversion, a falling one of its select goes to the first channel. */
static void converter_edges(void) {
    const bool convert = fake_pin(PIN_SENSOR_CONVERT), cs = fake_pin(PIN_SENSOR_CS);
    if (convert && !hardware.convert && hardware.converter_starts) {
        hardware.busy = 5;
        hardware.stuck = hardware.stuck || !hardware.converter_ends;
    }
    if (!cs && hardware.cs)
        hardware.next_channel = 0;
    if (fake_pin(PIN_SENSOR_RESET) && hardware.converter_ends) {
        hardware.busy = 0;
        hardware.stuck = false;
    }
    hardware.convert = convert;
    hardware.cs = cs;
}

static void converter_busy(void) {
    const bool busy = hardware.busy > 0;
    fake_set_pin(PIN_SENSOR_BUSY, busy);
    if (busy && !hardware.stuck)
        hardware.busy--;
}

static void spi(void) {
    if ((SPI1->DR & SEEN) != 0 || !hardware.spi_answers || hardware.cs)
        return;
    hardware.spi_cr1 = SPI1->CR1;
    SPI1->DR = SEEN | (uint16_t)hardware.channel[hardware.next_channel++ % 8];
    SPI1->SR = SPI_SR_RXNE;
    hardware.words++;
}

static void uart_takes(void) {
    if ((USART1->DR & SEEN) != 0)
        return;
    assert_true(hardware.n_sent < FAKE_SENT);
    hardware.sent[hardware.n_sent++] = (uint8_t)USART1->DR;
    USART1->DR = SEEN;
    set_bits(&USART1->SR, USART_SR_TXE, !hardware.chip_uart);
}

void fake_polled(const volatile uint32_t *address) {
    hardware.polls++;
    if (address == &RCC->CR || address == &RCC->CFGR || address == &FLASH->ACR) {
        clocks();
    } else if (address == &FLASH->SR) {
        flash();
    } else if (address == &SPI1->SR) {
        spi();
    } else if (address == &USART1->SR) {
        uart_takes();
    } else if (address == &USART1->DR) {
        set_bits(&USART1->SR, USART_SR_RXNE | USART_SR_ORE, false);
    } else if (address == &GPIO(PIN_SENSOR_BUSY / 16)->IDR) {
        converter_busy();
    } else {
        outputs();
        converter_edges();
    }
}

void fake_sleep(void) {
    assert_non_null(hardware.sleep);
    hardware.sleep();
}
