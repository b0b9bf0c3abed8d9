/* uart.c: USART1, 921600 baud, 8N1, filled and drained by interrupt. */
#include "drivers.h"

enum { BAUD = 921600, LOWER = 0x80 };

static struct {
    uint8_t byte[SERIAL_RECEIVE];
    ring received;
    ring *transmit;
} uart;

void uart_start(uint32_t bus_hz) {
    ring_init(&uart.received, uart.byte, SERIAL_RECEIVE);
    uart.transmit = NULL;
    RCC->APB2ENR |= RCC_APB2ENR_USART1;
    BARRIER();
    gpio_alternate(PIN_UART_TX, ALTERNATE_USART1, PULL_NONE);
    gpio_alternate(PIN_UART_RX, ALTERNATE_USART1, PULL_UP);
    USART1->BRR = (bus_hz + BAUD / 2) / BAUD;
    USART1->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
    NVIC->IPR[USART1_IRQ / 4] = LOWER << USART1_IRQ % 4 * 8; /* than the tick, which it must not delay */
    NVIC->ISER[USART1_IRQ / 32] = 1u << USART1_IRQ % 32;
}

bool serial_receive(uint8_t *byte) {
    return ring_get(&uart.received, byte);
}

void serial_send(ring *transmit) {
    uart.transmit = transmit;
    if (ring_used(transmit) == 0)
        return;
    USART1->CR1 |= USART_CR1_TXEIE;
    /* QEMU raises no interrupt for an empty data register; on the chip this one comes a moment sooner. */
    NVIC->ISPR[USART1_IRQ / 32] = 1u << USART1_IRQ % 32;
}

/* Sends one byte on the chip, whose data register is then full; under QEMU, where it never is, all bytes of a
 * tick. It replaces ring_get() because nothing else runs as often. */
static void send_some(ring *from) {
    const uint8_t *byte = from->byte;
    const uint32_t mask = from->size - 1, end = from->head;
    uint32_t next = from->tail;
    for (int left = SERIAL_BURST; left > 0 && next != end; left--) {
        if (!wait_for(&USART1->SR, USART_SR_TXE, USART_SR_TXE, 1))
            break;
        USART1->DR = byte[next];
        next = (next + 1) & mask;
    }
    from->tail = next;
    if (next == end)
        USART1->CR1 &= ~(uint32_t)USART_CR1_TXEIE;
}

void uart_interrupt(void) {
    const uint32_t status = USART1->SR;
    if ((status & (USART_SR_RXNE | USART_SR_ORE)) != 0) {
        POLLED(&USART1->DR);
        const uint8_t byte = (uint8_t)USART1->DR; /* this read also clears an overrun */
        if ((status & USART_SR_RXNE) != 0)
            (void)ring_put(&uart.received, byte); /* what does not fit fails its frame's check */
    }
    if ((USART1->CR1 & USART_CR1_TXEIE) != 0)
        send_some(uart.transmit);
}
