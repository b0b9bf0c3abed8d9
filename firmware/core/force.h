/* force.h: six-channel force and torque from ADC counts. */
#ifndef FORCE_H
#define FORCE_H

#include <palpate/wire.h>

enum { FORCE_AXES = PALP_WIRE_CHANNELS, FORCE_Z = 2, FORCE_TARE_MOST = 4096 };

typedef struct force_sensor {
    float matrix[FORCE_AXES][PALP_WIRE_CHANNELS]; /* N (Nm) a count */
    int32_t tare[PALP_WIRE_CHANNELS];             /* sixteenths of a count */
    int32_t sum[PALP_WIRE_CHANNELS];              /* of a tare in progress */
    uint16_t tare_samples, tare_left;
} force_sensor;

void force_init(force_sensor *f); /* the matrix of the simulated sensor (doc/indenter.md), no tare */
/* The same for a sensor of one channel, whose count is count_nN along z; 0: six channels. */
void force_begin(force_sensor *f, int32_t count_nN);
/* Entry number i of that matrix, row by row. */
float force_standard(int32_t count_nN, uint8_t i);
float force_axis(const force_sensor *f, const int16_t adc[PALP_WIRE_CHANNELS], uint8_t axis);
/* False, and no change: no such axis, a row of zeros, or more than 2 N a count. */
bool force_set_row(force_sensor *f, uint8_t axis, const int32_t row_nN[PALP_WIRE_CHANNELS]);
bool force_get_row(const force_sensor *f, uint8_t axis, int32_t row_nN[PALP_WIRE_CHANNELS]);
/* Averages samples (1..FORCE_TARE_MOST) ticks; the old tare holds until tare_left is 0. */
void force_tare_begin(force_sensor *f, uint16_t samples);
void force_tare_add(force_sensor *f, const int16_t adc[PALP_WIRE_CHANNELS]); /* ends by itself */
bool force_saturated(const int16_t adc[PALP_WIRE_CHANNELS]);                 /* any channel at its rail */

#endif
