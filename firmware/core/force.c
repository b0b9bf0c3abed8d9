/* force.c: six-channel force and torque from ADC counts. */
#include "force.h"

/* nN (nNm) a count. Three beams at 120 degrees, each with a gauge along the axis (0, 2, 4) and one across
 * (1, 3, 5), with a few per cent of cross-talk. A count on the three axial gauges is
 * 1/1250 N of z, and 25.1 N saturate the first of them. */
static const int32_t matrix_nN[FORCE_AXES][PALP_WIRE_CHANNELS] = {
    {8440, 2920, -17450, -450150, 5500, 459720}, /* Fx */
    {-8700, 493160, -4290, -241020, 2830, -247560},
    {266540, 18890, 267670, -3780, 265060, 2130},
    {280, -10, 6550, -90, -6510, -250}, /* Tx */
    {-7500, -10, 3680, -280, 3420, -40},
    {-150, 3670, -110, 3550, -70, 3610},
};

/* Codes this near to an end of the converter's range are not valid readings. */
enum { RAIL = 32752 };

/* Largest entry of a calibration: converted to float and back it still fits an int32_t. */
enum { MOST_NN = 2000000000 };

void force_init(force_sensor *f) {
    *f = (force_sensor){.tare_samples = 0};
    for (uint8_t axis = 0; axis < FORCE_AXES; axis++)
        (void)force_set_row(f, axis, matrix_nN[axis]);
}

void force_begin(force_sensor *f, int32_t count_nN) {
    force_init(f);
    if (count_nN != 0)
        (void)force_set_row(f, FORCE_Z, (const int32_t[PALP_WIRE_CHANNELS]){count_nN});
}

float force_standard(int32_t count_nN, uint8_t i) {
    const uint8_t axis = i / PALP_WIRE_CHANNELS, channel = i % PALP_WIRE_CHANNELS;
    const bool single = count_nN != 0 && axis == FORCE_Z;
    return (float)(!single ? matrix_nN[axis][channel] : channel == 0 ? count_nN : 0) * 1e-9f;
}

float force_axis(const force_sensor *f, const int16_t adc[PALP_WIRE_CHANNELS], uint8_t axis) {
    float sum = 0.0f;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        sum += f->matrix[axis][i] * (float)(adc[i] * 16 - f->tare[i]);
    return sum * 0.0625f;
}

bool force_set_row(force_sensor *f, uint8_t axis, const int32_t row_nN[PALP_WIRE_CHANNELS]) {
    bool some = false, good = axis < FORCE_AXES;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++) {
        some = some || row_nN[i] != 0;
        good = good && row_nN[i] >= -MOST_NN && row_nN[i] <= MOST_NN;
    }
    if (!some || !good)
        return false;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        f->matrix[axis][i] = (float)row_nN[i] * 1e-9f;
    return true;
}

/* Nearest whole nN: the row given to force_set_row, within a float's 24 bits. */
bool force_get_row(const force_sensor *f, uint8_t axis, int32_t row_nN[PALP_WIRE_CHANNELS]) {
    if (axis >= FORCE_AXES)
        return false;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++) {
        float nN = f->matrix[axis][i] * 1e9f;
        row_nN[i] = (int32_t)(nN < 0.0f ? nN - 0.5f : nN + 0.5f);
    }
    return true;
}

void force_tare_begin(force_sensor *f, uint16_t samples) {
    f->tare_samples = samples < 1 ? 1 : samples > FORCE_TARE_MOST ? FORCE_TARE_MOST : samples;
    f->tare_left = f->tare_samples;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        f->sum[i] = 0;
}

/* Sixteen times the mean, to the nearest. */
static int32_t mean_16(int32_t sum, int32_t n) {
    int32_t whole = sum / n, rest = sum % n;
    int32_t half = rest < 0 ? -n : n;
    return whole * 16 + (rest * 32 + half) / (2 * n);
}

void force_tare_add(force_sensor *f, const int16_t adc[PALP_WIRE_CHANNELS]) {
    if (f->tare_left == 0)
        return;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        f->sum[i] += adc[i];
    if (--f->tare_left > 0)
        return;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        f->tare[i] = mean_16(f->sum[i], f->tare_samples);
}

bool force_saturated(const int16_t adc[PALP_WIRE_CHANNELS]) {
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        if (adc[i] >= RAIL || adc[i] <= -RAIL)
            return true;
    return false;
}
