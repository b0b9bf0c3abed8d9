/* random.c: see random.h. Normal numbers by Box and Muller. */
#include <palpate/random.h>

#include <math.h>

static const uint64_t STEP = UINT64_C(0x9e3779b97f4a7c15); /* increment of the state */
static const double TURN = 6.28318530717958647692;

uint64_t palp_random_next(uint64_t *state) {
    if (!state)
        return 0;
    uint64_t z = *state += STEP;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double palp_random_uniform(uint64_t *state) {
    return state ? ((double)(palp_random_next(state) >> 11) + 0.5) * 0x1p-53 : NAN;
}

double palp_random_normal(uint64_t *state) {
    if (!state)
        return NAN;
    double radius = sqrt(-2.0 * log(palp_random_uniform(state)));
    return radius * cos(TURN * palp_random_uniform(state));
}

/* Numbers 2 i and 2 i + 1 of the sequence make samples 2 i and 2 i + 1. */
double palp_random_normal_at(uint64_t seed, uint64_t k) {
    uint64_t state = palp_random_next(&seed) + k / 2 * 2 * STEP;
    double radius = sqrt(-2.0 * log(palp_random_uniform(&state))), angle = TURN * palp_random_uniform(&state);
    return radius * (k % 2 ? sin(angle) : cos(angle));
}
