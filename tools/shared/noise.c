/* noise.c: white Gaussian noise by counter. */
#include "noise.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* Steele, Lea and Flood's SplitMix64, by counter. */
static uint64_t mix(uint64_t x) {
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

static double uniform(uint64_t seed, uint64_t k) /* in (0, 1) */
{
    const uint64_t golden = UINT64_C(0x9e3779b97f4a7c15);
    return ((double)(mix(mix(seed + golden) + (k + 1) * golden) >> 12) + 0.5) * 0x1p-52;
}

double noise_normal(uint64_t seed, uint64_t k) {
    uint64_t pair = 2 * (k / 2);
    double radius = sqrt(-2 * log(uniform(seed, pair))), angle = 2 * PI * uniform(seed, pair + 1);
    return radius * (k % 2 ? sin(angle) : cos(angle));
}
