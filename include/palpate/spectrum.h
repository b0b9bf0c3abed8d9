/* spectrum.h: storage and loss stiffness of a specimen against frequency, by its recordings alone: no model,
 * no protocol. What a model has instead is palp_lumped_oscillation. May change. */
#ifndef PALPATE_SPECTRUM_H
#define PALPATE_SPECTRUM_H

#include <palpate/recording.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a stretch of an oscillation tells. Where the plate goes by d cos(w t), the force follows by
 * d (storage cos(w t) - loss sin(w t)). Intervals are value -+ 1.96 sd. */
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

/* The spectrum of a recording: of each cycle and sweep of its path (palp_segments_pieces), in stretches of a
 * quarter of an octave, or three cycles where those last longer, or a hundred. Path and force of a stretch
 * are fitted by the driven frequency, how it and the amplitude change, its two first harmonics and a slow
 * drift; storage and loss are the ratio of both at the driven frequency. The first and the last cycle are
 * left out, of cycles of one length the first quarter, and stretches in which the plate leaves the specimen.
 * n = 0 where nothing oscillates. palp_spectrum_free. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_spectrum_measure(const palp_recording *recording, palp_spectrum *spectrum);
PALP_API void palp_spectrum_free(palp_spectrum *spectrum); /* frees what is owned, zeroes; NULL is fine */

#ifdef __cplusplus
}
#endif
#endif
