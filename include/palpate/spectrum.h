/* spectrum.h: storage and loss stiffness against frequency, measured from recordings without a model or
 * protocol. palp_lumped_oscillation gives those of a model. May change. */
#ifndef PALPATE_SPECTRUM_H
#define PALPATE_SPECTRUM_H

#include <palpate/recording.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The result of one stretch of an oscillation. If the plate moves as d cos(w t), the force is d (storage
 * cos(w t) - loss sin(w t)). 95 % intervals are value -+ 1.96 sd. */
typedef struct palp_spectrum_point {
    double frequency_Hz; /* in the middle of the stretch */
    double from_s, to_s, cycles;
    double depth_m, amplitude_m, force_N; /* depth and force in the middle of the oscillation */
    double storage_N_m, storage_sd_N_m, loss_N_m, loss_sd_N_m;
} palp_spectrum_point;

typedef struct palp_spectrum {
    size_t n;
    palp_spectrum_point *point; /* [n] owned, in the order of time */
} palp_spectrum;

/* The spectrum of a recording: each cycle and sweep of its path (palp_segments_pieces) is cut into
 * stretches. A stretch spans a quarter of an octave, or three cycles if those take longer, and at most a
 * hundred cycles. Path and force of a stretch are fitted by the driven frequency with its rate of change.
 * The fit includes changes of amplitude, the first two harmonics and a slow drift. Storage and loss are the
 * ratio of force to path at the driven frequency. Left out are the first and last cycle, the first quarter of
 * cycles of constant length, and stretches without contact. n = 0 if nothing oscillates. palp_spectrum_free.
 * ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_spectrum_measure(const palp_recording *recording, palp_spectrum *spectrum);
PALP_API void palp_spectrum_free(palp_spectrum *spectrum); /* frees what is owned, zeroes; NULL is fine */

#ifdef __cplusplus
}
#endif
#endif
