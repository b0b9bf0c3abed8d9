/* real.h: functions of float by polynomials of our own: the same bits on every processor. */
#ifndef REAL_H
#define REAL_H

#include <stdint.h>

#define REAL_PI 3.14159265f
#define REAL_LN2 0.693147181f

static inline float real_abs(float x) {
    return x < 0.0f ? -x : x;
}

static inline float real_clamp(float x, float low, float high) {
    return x < low ? low : x > high ? high : x;
}

/* Nearest whole number, held at the ends of int32_t; 0 for what is no number. */
int32_t real_round(float x);

/* Sine and cosine of 2 pi turn, 0 <= turn <= 1; to 2e-7. */
void real_sine(float turn, float *sine, float *cosine);

/* Logarithm to base 2 of a normal x > 0; relative to the larger of it and 1, to 2e-7. */
float real_log2(float x);

/* 2^x, |x| <= 120; relative to 2e-7 (1 + |x|). */
float real_exp2(float x);

#endif
