/* noise.h: white Gaussian noise by counter. */
#ifndef PALPATE_NOISE_H
#define PALPATE_NOISE_H

#include <stdint.h>

/* Sample k, sd 1; the same for a seed whatever else is drawn. */
double noise_normal(uint64_t seed, uint64_t k);

#endif
