/* random.h: random numbers, the same for a seed on every machine: SplitMix64 (Steele, Lea, Flood 2014).
 * Stable. */
#ifndef PALPATE_RANDOM_H
#define PALPATE_RANDOM_H

#include <palpate/export.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Each call moves *state on; any number is a seed. */
PALP_API uint64_t palp_random_next(uint64_t *state);
PALP_API double palp_random_uniform(uint64_t *state); /* between 0 and 1, never 0 */
PALP_API double palp_random_normal(uint64_t *state);  /* of mean 0 and standard deviation 1 */

/* Sample k of a sequence of such normal numbers, whatever else is drawn. */
PALP_API double palp_random_normal_at(uint64_t seed, uint64_t k);

/* 95 % of Student's t lies within this of 0; infinite where there is no degree of freedom. */
PALP_API double palp_student_95(size_t freedom);

#ifdef __cplusplus
}
#endif
#endif
