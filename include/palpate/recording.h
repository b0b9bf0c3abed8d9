/* recording.h: a raw recording made ready for a fit: contact, zero force, noise, defects. May change. */
#ifndef PALPATE_RECORDING_H
#define PALPATE_RECORDING_H

#include <palpate/experiment.h>
#include <palpate/segments.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_NAME_MAX = 256 };

/* The kind of an experiment, by its path. */
/* STATIC: a ramp without a dwell, at any rate; whether the specimen was in equilibrium is not checked.
 * RAMP_HOLD: a ramp and one dwell. CREEP: a constant force while the depth continues to grow. OTHER: cycles,
 * sweeps, several ramps. */
typedef enum palp_recording_kind {
    PALP_RECORDING_STATIC,
    PALP_RECORDING_RAMP_HOLD,
    PALP_RECORDING_OTHER,
    PALP_RECORDING_CREEP
} palp_recording_kind;

/* How contact (depth 0) and zero force were found. */
typedef enum palp_contact_rule {
    PALP_CONTACT_GIVEN,    /* by the caller, or by the file's contact.rule (palpate import) */
    PALP_CONTACT_FREE_AIR, /* zero force is the mean force in the air; contact is recorded depth 0, or the
                              depth to which the rising force extrapolates if that is more than 3 sds away */
    PALP_CONTACT_NOMINAL   /* the plate was never in the air: contact is recorded depth 0, and zero force the
                              mean while the plate rests there, or 0; the contact's sd is the file's
                              contact.sd_mm or follows from the beginning of the rise */
} palp_contact_rule;

/* What a fit assumes about the contacts of several recordings. KNOWN: they are right. COMMON: all are off by
 * the same amount. FREE: each is off by an amount of its own, with a standard deviation estimated from the
 * runs. */
typedef enum palp_contact_form {
    PALP_CONTACT_KNOWN,
    PALP_CONTACT_COMMON,
    PALP_CONTACT_FREE
} palp_contact_form;

typedef struct palp_recording_settings {
    double height_m; /* 0 = from the file's specimen.height_mm */
    bool contact_given;
    double contact_m;   /* recorded depth at contact, with contact_given */
    double spike_sigma; /* a single sample further than this many noise sds from both neighbours is masked */
    double clip_share;  /* the sensor counts as clipped where at least this share of the samples has exactly
                           the largest force while the plate moves on */
} palp_recording_settings;

/* Contact is found, spikes beyond 8 sds are masked, clipping counts from a share of 0.002. */
PALP_API palp_recording_settings palp_recording_settings_default(void);

/* A prepared recording; owns its arrays; palp_recording_free. Depth and force are relative to contact. */
typedef struct palp_recording {
    char name[PALP_NAME_MAX];
    char specimen[PALP_NAME_MAX]; /* the file's specimen.name, "" without one */
    palp_recording_kind kind;
    double height_m, radius_m; /* radius 0 = not given */
    size_t n;
    double *time_s, *depth_m, *force_N;
    unsigned char *use;              /* [n] 0 = masked: a spike, clipped, withdrawal */
    double deepest_m;                /* largest depth */
    double ramp_start_s, ramp_end_s; /* first motion into the specimen: its start and its end */
    palp_pieces creep;  /* where the force was constant while the depth continued to grow; owned */
    double end_s;       /* end of the press: samples from the last withdrawal on are masked */
    bool contact_found; /* the file says that its depth and force are already relative to contact */
    palp_contact_rule contact_rule;
    double contact_m, contact_sd_m; /* recorded depth at contact */
    double zero_N, zero_sd_N;       /* recorded force at zero */
    double noise_N;                 /* sd of a sample's white noise, from differences */
    double correlation;   /* of the noise between neighbouring samples, from a final dwell; 0 without one */
    double hum_Hz, hum_N; /* strongest line in 45-65 Hz and its amplitude; 0 if none stands out */
    size_t n_spikes, n_clipped;
    size_t n_missing; /* samples missing on a regular clock */
    size_t
        n_gaps; /* time steps longer than 3 of the clock's and longer than randomly missing samples explain */
    double longest_gap_s;
    bool faulted; /* the file has an end.fault that ended it */
    bool uneven;  /* one time step in a hundred is off the median by over 1 % (gaps aside) */
} palp_recording;

/* Prepares an experiment; name is copied (the file's name, for messages). ERR_INPUT with a line for a
 * recording that cannot be used: depth or force in the wrong sign, no motion, no height, a depth beyond it.
 * Also force that never exceeds its noise, fewer than 16 samples, numbers that are not finite, or times that
 * do not increase. */
PALP_API palp_status palp_recording_prepare(const palp_experiment *experiment, const char *name,
                                            const palp_recording_settings *settings,
                                            palp_recording *recording, palp_error *error);
/* Only the checks, for callers that use an experiment's samples as they are. height_m: of the specimen, 0 =
 * from the file. */
PALP_API palp_status palp_recording_check(const palp_experiment *experiment, const char *name,
                                          double height_m, palp_error *error);
PALP_API void palp_recording_free(palp_recording *recording); /* frees arrays, zeroes; NULL is fine */

/* The recording as means of blocks of samples, relative to its contact; the caller frees it. In a block the
 * path is straight and the plate moves by less than deepest_m / parts (10 or more). A block lasts less than
 * 6 / parts of the time since the last corner. Column "samples": of how many samples a row is the mean; 0: it
 * only carries the path, and its force does not count. "time_sd_s": sd of the samples' times. "noise_N": sd
 * of their noise, by second differences; 0 of fewer than three. A recording that begins under load has such a
 * row of depth 0 a sample before it. ERR_ARGUMENT: fewer parts; ERR_NO_MEMORY. */
PALP_API palp_status palp_recording_blocks(const palp_recording *recording, double parts,
                                           palp_experiment **blocks);

/* Scales a recording to a specimen whose lengths are length times and whose area is force times as large:
 * stress and strain stay. Depth, height and contact change, and force, its zero and its noise. The radius
 * follows the area. */
PALP_API void palp_recording_scale(palp_recording *recording, double length, double force);

/* The kind of a path with these pieces; PALP_RECORDING_OTHER for NULL. */
PALP_API palp_recording_kind palp_recording_kind_of(const palp_pieces *pieces);

/* Zero-phase low-pass: a Butterworth filter of an even order 2..8, run forward and backward (so twice
 * the order, -6 dB at cutoff_Hz), for evenly sampled data; ends are extended by odd reflection.
 * in[n] and out[n] are the caller's. ERR_ARGUMENT: another order, a cutoff not in (0, 0.5 / dt_s), no
 * samples; ERR_NO_MEMORY. */
PALP_API palp_status palp_filter_zero_phase(size_t n, const double *in, double dt_s, int order,
                                            double cutoff_Hz, double *out);

#ifdef __cplusplus
}
#endif
#endif
