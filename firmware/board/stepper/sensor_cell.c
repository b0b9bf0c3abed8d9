/* sensor_cell.c: the one channel of a load cell, as the first of six. A sample stays until the next one. */
#include "sensor_cell.h"

enum { SILENT_TICKS = 70 /* after five samples of the slowest */ };

static struct {
    int16_t held;
    uint32_t waited;
} cell;

bool gauge_start(void) {
    cell.waited = 0;
    return cell_start();
}

/* The amplifier converts by itself. */
void gauge_convert(void) {
}

static int16_t within(int32_t counts) {
    return (int16_t)(counts > INT16_MAX ? INT16_MAX : counts < INT16_MIN ? INT16_MIN : counts);
}

bool gauge_read(int16_t adc[PALP_WIRE_CHANNELS], bool *held) {
    *held = !cell_there();
    cell.waited = *held ? cell.waited + 1 : 0;
    if (!*held)
        cell.held = within(cell_take());
    for (int i = 1; i < PALP_WIRE_CHANNELS; i++)
        adc[i] = 0;
    adc[0] = cell.held;
    return cell.waited < SILENT_TICKS;
}
