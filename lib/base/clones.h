/* clones.h: PALP_CLONES before a function adds a version for processors with AVX2; the program's loader
 * chooses. Both do the same operations in the same order, without contraction, and so give the same bits
 * (tests/lib/network/test_network_bits.c). -DPALP_ONE_VERSION makes only the first. Internal. */
#ifndef CLONES_H
#define CLONES_H

#include <limits.h> /* defines __GLIBC__ if glibc, whose loader can choose, is used */

#if defined __x86_64__ && defined __GLIBC__ && defined __GNUC__ && !defined __clang__ &&                     \
    !defined __SANITIZE_ADDRESS__ && !defined PALP_ONE_VERSION
#define PALP_CLONES __attribute__((target_clones("default", "avx2")))
#else
#define PALP_CLONES
#endif

#endif
