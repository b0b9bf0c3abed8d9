/* moduli.h: shear modulus and Poisson's ratio of a layer from presses with a plate, flat punch, sphere or
 * cone. May change. */
#ifndef PALPATE_MODULI_H
#define PALPATE_MODULI_H

#include <palpate/indentation.h>
#include <palpate/material.h>
#include <palpate/recording.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_moduli_settings {
    size_t n_arms;      /* of the relaxation, 0 = elastic */
    bool dwell_only;    /* leave the ramps out */
    bool contact_known; /* take the contact of a sphere or cone from the recording; else it is fitted with the
                           moduli */
    double poisson;     /* known Poisson's ratio; NaN = fit it, which needs tips of different shape or size */
} palp_moduli_settings;

/* Elastic, with the ramps, incompressible: 0.5. */
PALP_API palp_moduli_settings palp_moduli_settings_default(void);

/* A value with its sd and 95 % interval. */
typedef struct palp_modulus {
    double value, sd, low, high;
} palp_modulus;

/* G(t) = long_term + sum_j arm_Pa[j] exp(-t / tau_s[j]); Poisson's ratio does not change with time. */
typedef struct palp_moduli {
    palp_modulus shear_inf_Pa, shear_0_Pa; /* long-term and instantaneous shear modulus */
    palp_modulus young_inf_Pa, young_0_Pa; /* 2 (1 + nu) G */
    palp_modulus poisson;                  /* sd 0 and low = high = value if it was given */
    bool poisson_found;
    size_t n_tips; /* number of tips that differ in shape, size or thickness of the layer */
    double shear_low_Pa, shear_high_Pa; /* long-term shear modulus for a Poisson's ratio of 0.5 and of 0.3,
                                           between which a single tip cannot decide */
    size_t n_arms;
    double arm_Pa[PALP_ARMS_MAX], tau_s[PALP_ARMS_MAX];
    double largest_depth;   /* over the layer's thickness; 0 for a half-space */
    double widest_contact;  /* radius of contact over the layer's thickness */
    double largest_shift_m; /* largest difference of a fitted contact from that of its recording */
    double misfit; /* rms residual over the rms force, of all runs; large if one modulus does not describe
                      them */
    bool converged;
} palp_moduli;

/* Fits n recordings, each with its tip (whose poisson is not read), at once: the depth of each sample becomes
 * the force over G that palp_indentation_force has for it, which relaxes linearly (Lee and Radok 1960: right
 * as long as the contact does not shrink). A sphere or cone leaves contact so gently that a straight rise
 * finds it too late: its contact is fitted too. Intervals are those of palp_characterize_fit; with Poisson's
 * ratio found, by how the tips' own moduli agree, they include its own. Errors of palp_indentation_force and
 * palp_characterize_fit; ERR_INPUT with a line in error: Poisson's ratio asked for and all tips alike. */
PALP_API palp_status palp_moduli_fit(size_t n, const palp_recording *recordings, const palp_indentation *tips,
                                     const palp_moduli_settings *settings, palp_moduli *moduli,
                                     palp_error *error);

/* The mean of n >= 2 specimens' moduli into mean's four of them, with its sd and its 95 % interval by how the
 * specimens differ (Student's t); between_Pa: sd between specimens of the long-term and the instantaneous
 * shear modulus. ERR_ARGUMENT: n < 2. */
PALP_API palp_status palp_moduli_pool(size_t n, const palp_moduli *each, palp_moduli *mean,
                                      double between_Pa[2]);

#ifdef __cplusplus
}
#endif
#endif
