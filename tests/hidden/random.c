/* random.c: random numbers: xoshiro256**, seeded by splitmix64; the same on every machine. */
#include "hidden.h"

#include <math.h>

static uint64_t mix(uint64_t *x) {
    uint64_t z = (*x += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

random_state random_make(uint64_t seed, uint64_t stream) {
    uint64_t x = seed * UINT64_C(0xd1342543de82ef95) + stream;
    random_state r;
    for (int i = 0; i < 4; i++)
        r.s[i] = mix(&x);
    return r;
}

static uint64_t rotate(uint64_t x, int k) {
    return (x << k) | (x >> (64 - k));
}

static uint64_t next(random_state *r) {
    uint64_t *s = r->s, result = rotate(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate(s[3], 45);
    return result;
}

double random_uniform(random_state *r, double low, double high) {
    return low + (high - low) * ((double)(next(r) >> 11) + 0.5) * 0x1p-53;
}

double random_log(random_state *r, double low, double high) {
    return low * exp(random_uniform(r, 0, log(high / low)));
}

double random_normal(random_state *r) {
    double u = random_uniform(r, 0, 1), v = random_uniform(r, 0, 6.283185307179586);
    return sqrt(-2 * log(u)) * cos(v);
}

size_t random_index(random_state *r, size_t n) {
    return (size_t)(next(r) % n);
}

double random_sign(random_state *r) {
    return next(r) >> 63 ? 1 : -1;
}
