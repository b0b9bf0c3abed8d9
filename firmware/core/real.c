/* real.c: functions of float by polynomials of our own. */
#include "real.h"

#include <stdbool.h>

typedef union bits {
    float value;
    uint32_t word;
} bits;

/* Taylor's series within an eighth of a turn of the nearest quarter. */
void real_sine(float turn, float *sine, float *cosine) {
    int quarter = (int)(turn * 4.0f + 0.5f);
    float x = (turn - (float)quarter * 0.25f) * (2.0f * REAL_PI), y = x * x;
    float s = x * (1.0f + y * (-1.0f / 6 + y * (1.0f / 120 + y * (-1.0f / 5040 + y * (1.0f / 362880)))));
    float c = 1.0f + y * (-0.5f + y * (1.0f / 24 + y * (-1.0f / 720 + y * (1.0f / 40320))));
    bool odd = (quarter & 1) != 0;
    *sine = (quarter & 2) != 0 ? -(odd ? c : s) : odd ? c : s;
    *cosine = ((quarter + 1) & 2) != 0 ? -(odd ? s : c) : odd ? s : c;
}

/* x = m 2^e with m near 1; ln m = 2 artanh((m - 1) / (m + 1)). */
float real_log2(float x) {
    bits b = {.value = x};
    int exponent = (int)((b.word - 0x3f3504f3u) >> 23); /* 0x3f3504f3: the root of a half */
    if (exponent >= 256)
        exponent -= 512;
    b.word -= (uint32_t)exponent << 23;
    float s = (b.value - 1.0f) / (b.value + 1.0f), y = s * s;
    float artanh = s * (1.0f + y * (1.0f / 3 + y * (1.0f / 5 + y * (1.0f / 7))));
    return (float)exponent + artanh * (2.0f / REAL_LN2);
}

float real_exp2(float x) {
    int whole = (int)(x < 0.0f ? x - 0.5f : x + 0.5f);
    float y = (x - (float)whole) * REAL_LN2;
    float sum = 1.0f + y * (1.0f / 7);
    for (int i = 6; i > 0; i--)
        sum = 1.0f + y * sum / (float)i;
    bits b = {.word = (uint32_t)(whole + 127) << 23};
    return sum * b.value;
}

int32_t real_round(float x) {
    x = real_clamp(x, -2147483520.0f, 2147483520.0f); /* the last that a float and an int32_t both hold */
    return x == x ? (int32_t)(x < 0.0f ? x - 0.5f : x + 0.5f) : 0;
}
