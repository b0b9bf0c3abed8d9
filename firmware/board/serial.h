/* serial.h: the bytes to and from the host, under a board: the chip's UART. */
#ifndef SERIAL_H
#define SERIAL_H

#include "ring.h"

/* What 921600 baud carries in a control tick: simulated boards send no faster than that. */
enum { SERIAL_BURST = 92, SERIAL_RECEIVE = 512 };

bool serial_receive(uint8_t *byte);
void serial_send(ring *transmit);

#endif
