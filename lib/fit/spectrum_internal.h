/* spectrum_internal.h: one stretch of an oscillation. */
#ifndef SPECTRUM_INTERNAL_H
#define SPECTRUM_INTERNAL_H

#include <palpate/spectrum.h>

/* Samples first to last, so many cycles of which the first and the last take these times. */
typedef struct spectrum_stretch {
    size_t first, last;
    double cycles, first_cycle_s, last_cycle_s;
    bool sweeps;
} spectrum_stretch;

/* *found: whether the stretch gives a stiffness. ERR_NO_MEMORY. */
palp_status spectrum_fit(const palp_recording *recording, const spectrum_stretch *stretch,
                         palp_spectrum_point *point, bool *found);

#endif
