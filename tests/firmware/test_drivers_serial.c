/* test_drivers_serial.c: the serial port of the board, on registers that are memory. */
#include "drivers_make.h"

static void receive(uint32_t flags, uint8_t byte) {
    const uint32_t before = USART1->DR;
    USART1->DR = byte;
    USART1->SR |= flags;
    uart_interrupt();
    assert_int_equal(USART1->SR & flags, 0); /* else it would interrupt for ever */
    USART1->DR = before;
}

static void test_uart_receives(void **state) {
    uint8_t byte;
    (void)state;
    uart_start(84000000);
    assert_int_equal(USART1->BRR, 91); /* 0.2 % off */
    assert_int_equal(NVIC->ISER[1], 1u << 5);
    assert_int_equal(NVIC->IPR[9], 0x80u << 8); /* below the tick */
    assert_false(serial_receive(&byte));
    receive(USART_SR_RXNE, 0x55);
    receive(USART_SR_RXNE | USART_SR_ORE, 0xaa); /* the byte is good, the one after it was lost */
    receive(USART_SR_ORE, 0x11);                 /* nothing there but the flag */
    assert_true(serial_receive(&byte) && byte == 0x55);
    assert_true(serial_receive(&byte) && byte == 0xaa);
    assert_false(serial_receive(&byte));
    for (int i = 0; i < SERIAL_RECEIVE + 100; i++)
        receive(USART_SR_RXNE, (uint8_t)i);
    for (int i = 0; i < SERIAL_RECEIVE - 1; i++)
        assert_true(serial_receive(&byte) && byte == (uint8_t)i);
    assert_false(serial_receive(&byte));
}

static void test_uart_sends_byte_by_byte(void **state) {
    uint8_t buffer[16];
    ring r;
    (void)state;
    uart_start(84000000);
    hardware.chip_uart = true;
    ring_init(&r, buffer, sizeof buffer);
    serial_send(&r);
    assert_int_equal(USART1->CR1 & USART_CR1_TXEIE, 0); /* nothing to send */
    assert_true(ring_put_all(&r, (const uint8_t *)"palp", 4));
    serial_send(&r);
    assert_true((USART1->CR1 & USART_CR1_TXEIE) != 0);
    assert_int_equal(NVIC->ISPR[1], 1u << 5);
    for (uint32_t left = 4; left > 0; left--) {
        assert_int_equal(ring_used(&r), left);
        USART1->SR |= USART_SR_TXE;
        uart_interrupt();
        fake_polled(&USART1->SR);
        uart_interrupt(); /* its register is full: nothing happens */
    }
    assert_int_equal(hardware.n_sent, 4);
    assert_memory_equal(hardware.sent, "palp", 4);
    assert_int_equal(USART1->CR1 & USART_CR1_TXEIE, 0);
}

/* Under QEMU the data register is never full: a tick sends its own share, not all that waits. */
static void test_uart_sends_a_burst(void **state) {
    uint8_t buffer[256];
    ring r;
    (void)state;
    uart_start(84000000);
    ring_init(&r, buffer, sizeof buffer);
    for (int i = 0; i < 200; i++)
        assert_true(ring_put(&r, (uint8_t)(i * 7)));
    for (uint32_t sent = 92; sent < 200 + 92; sent += 92) {
        serial_send(&r);
        uart_interrupt();
        fake_polled(&USART1->SR);
        assert_int_equal(ring_used(&r), sent < 200 ? 200 - sent : 0);
    }
    assert_int_equal(hardware.n_sent, 200);
    for (int i = 0; i < 200; i++)
        assert_int_equal(hardware.sent[i], (uint8_t)(i * 7));
    assert_int_equal(USART1->CR1 & USART_CR1_TXEIE, 0);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_uart_receives, setup),
    cmocka_unit_test_setup(test_uart_sends_byte_by_byte, setup),
    cmocka_unit_test_setup(test_uart_sends_a_burst, setup),
    {0},
};
