/* forward_ramp.h: ramps of the tests of the forward model. */
#ifndef FORWARD_RAMP_H
#define FORWARD_RAMP_H

#include "forward_make.h"

static const double PI = 3.14159265358979323846;
static samples s; /* of the test at hand */

static inline void ramp(double rate_mm_s, double until, size_t n) {
    start(&s, 0, 0);
    go(&s, until, rate_mm_s * until, n);
}

#define EXPECT(i, wanted, tolerance)                                                                         \
    ck_assert_msg(fabs(s.force_N[i] - (wanted)) <= (tolerance), "at %g s, %g mm: %.9g N, not %.9g",          \
                  s.time_s[i], 1e3 * s.depth_m[i], s.force_N[i], (double)(wanted))

#endif
