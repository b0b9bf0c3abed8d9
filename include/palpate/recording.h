/* recording.h: a raw recording made ready for a fit: contact, zero force, noise, what is wrong with it. May change. */
#ifndef PALPATE_RECORDING_H
#define PALPATE_RECORDING_H

#include <palpate/experiment.h>
#include <palpate/segments.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_NAME_MAX = 256 };

/* What was done, by the path: one press and perhaps the way back; one press and a dwell; anything else. */
/* STATIC: a ramp without a dwell, at whatever rate; that the specimen was at rest on it nothing here tells.
 * RAMP_HOLD: a ramp and one dwell. CREEP: a force held while the depth goes on. OTHER: cycles, sweeps,
 * several ramps. */
typedef enum palp_recording_kind {
    PALP_RECORDING_STATIC,
    PALP_RECORDING_RAMP_HOLD,
    PALP_RECORDING_OTHER,
    PALP_RECORDING_CREEP
} palp_recording_kind;

/* How contact (depth 0) and zero force were found. */
typedef enum palp_contact_rule {
    PALP_CONTACT_GIVEN,    /* by the caller, or by the file's contact.rule (palpate import) */
    PALP_CONTACT_FREE_AIR, /* the mean force in the air is zero force; contact is recorded depth 0, unless the
                              rising force leads back to a depth more than 3 sds from it, which then is
                              contact */
    PALP_CONTACT_NOMINAL   /* the plate was never in the air: contact is recorded depth 0; zero force is the
                              mean of the rest there, or 0 without one; the contact's sd is the file's
                              contact.sd_mm or follows from the beginning of the rise */
} palp_contact_rule;

/* What a fit takes for known of the contacts of several recordings. KNOWN: they are where the recordings have
 * them. COMMON: all are off by the same. FREE: each run's is off by its own, by a scatter that is learned
 * from the runs. AUTO: FREE where the runs show it, else KNOWN; of palp_explain, FREE. */
typedef enum palp_contact_form {
    PALP_CONTACT_KNOWN,
    PALP_CONTACT_COMMON,
    PALP_CONTACT_FREE,
    PALP_CONTACT_AUTO
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
    palp_pieces creep;               /* where a force was held while the depth went on; owned */
    double end_s;                    /* of the press: from the last withdrawal on, samples are masked */
    bool contact_found; /* the file says that its depth and force are already relative to contact */
    palp_contact_rule contact_rule;
    double contact_m, contact_sd_m; /* recorded depth at contact */
    double zero_N, zero_sd_N;       /* recorded force at zero */
    double noise_N;                 /* sd of a sample's white noise, from differences */
    double correlation;             /* of the noise from sample to sample, in a still end; 0 without one */
    double hum_Hz, hum_N;           /* strongest line in 45-65 Hz and its amplitude; 0 if none stands out */
    size_t n_spikes, n_clipped;
    size_t n_missing; /* samples that the clock's step tells of and that are not there */
    size_t n_gaps;    /* time steps over 3 of the clock's, and over what samples missing by chance make */
    double longest_gap_s;
    bool faulted; /* the file has an end.fault that ended it */
    bool uneven;  /* one time step in a hundred is off the median by over 1 % (gaps aside) */
} palp_recording;

/* Prepares an experiment; name is copied (the file's name, for messages). ERR_INPUT with a line for a
 * recording that cannot be used: depth or force in the wrong sign, no motion, no height, force that never
 * leaves its noise, fewer than 16 samples, numbers that are not finite, times that do not increase. */
PALP_API palp_status palp_recording_prepare(const palp_experiment *experiment, const char *name,
                                            const palp_recording_settings *settings,
                                            palp_recording *recording, palp_error *error);
PALP_API void palp_recording_free(palp_recording *recording); /* frees arrays, zeroes; NULL is fine */

/* As of a specimen whose lengths are length times as large and whose area is force times as large, so that
 * stress and strain stay: depth, height and contact, and force, its zero and noise. The radius follows the
 * area. */
PALP_API void palp_recording_scale(palp_recording *recording, double length, double force);

/* The kind that the pieces of a path make; PALP_RECORDING_OTHER for NULL. */
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
