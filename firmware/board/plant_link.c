/* plant_link.c: the lockstep records, byte for byte. */
#include "plant_link.h"

/* Each writes or reads at the place given and returns the place after it. */
static uint8_t *put16(uint8_t *byte, uint32_t value) {
    byte[0] = (uint8_t)value;
    byte[1] = (uint8_t)(value >> 8);
    return byte + 2;
}

static uint8_t *put32(uint8_t *byte, uint32_t value) {
    return put16(put16(byte, value), value >> 16);
}

static uint16_t get16(const uint8_t **byte) {
    const uint8_t *b = *byte;
    *byte += 2;
    return (uint16_t)(b[0] | b[1] << 8);
}

static uint32_t get32(const uint8_t **byte) {
    const uint32_t low = get16(byte);
    return low | (uint32_t)get16(byte) << 16;
}

void plant_link_put_in(const plant_in *in, uint8_t byte[PLANT_LINK_IN]) {
    byte = put32(put32(byte, in->tick), (uint32_t)in->position);
    for (int i = 0; i < 6; i++)
        byte = put16(byte, (uint16_t)in->adc[i]);
    byte = put16(byte, in->thermistor);
    *byte++ = in->switches;
    *byte++ = in->events;
    *byte++ = in->reset_cause;
    *byte++ = in->rx_count;
    for (int i = 0; i < PLANT_LINK_RX; i++)
        *byte++ = in->rx[i];
    put16(byte, in->machine);
}

void plant_link_get_in(const uint8_t byte[PLANT_LINK_IN], plant_in *in) {
    in->tick = get32(&byte);
    in->position = (int32_t)get32(&byte);
    for (int i = 0; i < 6; i++)
        in->adc[i] = (int16_t)get16(&byte);
    in->thermistor = get16(&byte);
    in->switches = *byte++;
    in->events = *byte++;
    in->reset_cause = *byte++;
    in->rx_count = *byte++;
    for (int i = 0; i < PLANT_LINK_RX; i++)
        in->rx[i] = *byte++;
    in->machine = *byte;
}

void plant_link_put_out(const plant_out *out, uint8_t byte[PLANT_LINK_OUT]) {
    byte = put16(put32(byte, out->tick), (uint16_t)out->duty);
    *byte++ = out->motor;
    *byte++ = out->boot;
    byte = put16(put16(put32(byte, out->cost), out->version), out->stack_free);
    *byte++ = out->tx_count;
    for (int i = 0; i < PLANT_LINK_TX; i++)
        *byte++ = out->tx[i];
    *byte++ = out->trigger;
    byte = put32(byte, (uint32_t)out->place);
    for (int i = 0; i < PLANT_LINK_OUT - 22 - PLANT_LINK_TX; i++)
        *byte++ = 0;
}

void plant_link_get_out(const uint8_t byte[PLANT_LINK_OUT], plant_out *out) {
    out->tick = get32(&byte);
    out->duty = (int16_t)get16(&byte);
    out->motor = *byte++;
    out->boot = *byte++;
    out->cost = get32(&byte);
    out->version = get16(&byte);
    out->stack_free = get16(&byte);
    out->tx_count = *byte < PLANT_LINK_TX ? *byte : PLANT_LINK_TX;
    byte++;
    for (int i = 0; i < PLANT_LINK_TX; i++)
        out->tx[i] = *byte++;
    out->trigger = *byte++;
    out->place = (int32_t)get32(&byte);
}
