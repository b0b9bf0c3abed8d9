/* characterize.h: a lumped generalized Maxwell solid from recordings (Chapter 4), with intervals. May change.
 */
#ifndef PALPATE_CHARACTERIZE_H
#define PALPATE_CHARACTERIZE_H

#include <palpate/material.h>
#include <palpate/recording.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the spring is made of in a fit. */
typedef enum palp_spring_form {
    PALP_SPRING_LAW,    /* one stiffness law for all recordings */
    PALP_SPRING_PER_RUN /* one K_inf for each recording (Tables 4.2, 4.3) */
} palp_spring_form;

/* Form of the arms. FREE: n_arms with free times. FRACTIONAL: a fractional Maxwell element (a spring in
 * series with a springpot) parallel to the law, together a fractional Zener solid. Its parameters are K_frac,
 * tau_frac and the exponent a of the relaxation K_frac E_a(-(t / tau_frac)^a) (Mittag-Leffler). It becomes
 * PALP_ARMS_MAX arms of the spectrum sin(pi a) / (pi (x^a + x^-a + 2 cos(pi a))), x = tau / tau_frac (Cole
 * and Cole 1941). */
typedef enum palp_arms_form { PALP_ARMS_FREE, PALP_ARMS_FRACTIONAL } palp_arms_form;

typedef struct palp_characterize_settings {
    palp_spring_form spring;
    palp_law law;        /* PALP_SPRING_LAW: kind, size and (spline) knots; coefficients: first guess */
    palp_arms_form arms; /* FRACTIONAL has its own starts */
    size_t n_arms;       /* FREE; 0 = elastic */
    bool dwell_only;     /* ramp and hold: leave the ramp out of the residual */
    double tau_min_s, tau_max_s; /* bounds of relaxation times; 0 = from the data */
    size_t starts;               /* multistart: from how many first guesses the fit is refined */
    size_t max_evaluations;      /* of the residual in one refinement */
} palp_characterize_settings;

/* A constant spring for each recording, no arms, the whole curve, 4 starts, 300 evaluations.
 */
PALP_API palp_characterize_settings palp_characterize_settings_default(void);

/* One fitted parameter. Intervals are 95 %, from the curvature at the optimum, the noise model, and the sd of
 * zero force and of contact; those of arms are symmetric in the logarithm. */
typedef struct palp_estimate {
    char name[48];    /* "K_inf [3]", "c2", "K_1", "b_1", "tau_1" */
    const char *unit; /* "N", "N s", "s", "Pa" */
    double value, sd, low, high;
    bool determined; /* false: the interval spans more than a factor of 10, or zero (springs; K_inf: or less)
                      */
} palp_estimate;

/* Result of a fit; palp_lumped_fit_free. */
typedef struct palp_lumped_fit {
    palp_material material; /* PALP_SPRING_PER_RUN: law = constant, mean of the runs' K_inf */
    size_t n_runs;
    double *spring_N;                 /* [n_runs] K_inf, PALP_SPRING_PER_RUN */
    double *contact_m, *contact_sd_m; /* [n_runs] by how much contact is later than the recording has it; NULL
                                         if taken for known */
    double contact_scatter_m;         /* of them, PALP_CONTACT_FREE */
    double *rms_N;                    /* [n_runs] residual rms of the samples */
    double *absolute_N; /* [n_runs] sum of |residual| over the samples (the thesis' total residual) */
    size_t n_estimates;
    palp_estimate
        *estimate; /* springs, then K_j, b_j, tau_j by arm; FRACTIONAL: springs, K_frac, tau_frac, exponent */
    double *correlation; /* [n_estimates^2] */
    size_t n_parameters; /* springs, then K_j and b_j of each arm: as palp_forward_get has a model's */
    double *covariance;  /* [n_parameters^2] of them, widened as the intervals are; palp_model.covariance */
    double reduced_chi2; /* weighted residual per degree of freedom, 1 = down to the noise */
    double inflation;    /* factor on the sds for misfit and correlated noise, >= 1 */
    size_t n_merged;     /* arms merged because the data do not separate them */
    bool constrained;    /* K(e) > 0 had to be enforced */
    bool converged;
} palp_lumped_fit;

PALP_API void palp_lumped_fit_free(palp_lumped_fit *fit); /* frees arrays, zeroes; NULL is fine */

/* Fits n recordings at once: weighted least squares on means of short blocks of raw samples, by NLopt in log
 * K and log tau. Arms are shared by all recordings. The caller frees *fit. ERR_ARGUMENT: no recording, a law
 * without coefficients; ERR_INPUT with a line in error: recordings of different heights, a recording without
 * noise, fewer samples than parameters. */
PALP_API palp_status palp_characterize_fit(size_t n, const palp_recording *recordings,
                                           const palp_characterize_settings *settings, palp_lumped_fit *fit,
                                           palp_error *error);

/* K(e) of the fit's law at strain[n] and its sd, stiffness_N[n] and sd_N[n], the caller's. The force is K e,
 * and so is its sd. ERR_ARGUMENT: a fit without one law (PALP_SPRING_PER_RUN) or without intervals. */
PALP_API palp_status palp_lumped_fit_stiffness(const palp_lumped_fit *fit, size_t n, const double *strain,
                                               double *stiffness_N, double *sd_N);

/* ---- many specimens ---- */

/* A fit of several specimens of one height and area (palp_explain_recordings); palp_specimens_fit_free. Each
 * has its own coefficients of one law and its own arms; these scatter about a mean. */
typedef struct palp_specimens_fit {
    palp_lumped_fit
        mean; /* of the mean specimen. Its intervals and covariance are widened so that 1.96 sd hold 95 %, by
                 Student's t of n_specimens - 1; its residuals are of each run to the mean specimen's force */
    size_t n_specimens;
    palp_material *own; /* [n_specimens] of each */
    double *factor;     /* [n_specimens] its force over that of the mean, about */
    double *between;    /* [mean.n_parameters^2] covariance of the specimens about the mean; 0: no more than
                           chance */
    double *within;     /* [mean.n_parameters^2] covariance of one specimen's estimate */
    size_t n_spread;    /* directions in which the specimens differ by more than chance */
    double low, high;   /* 95 % interval of their sd over the estimate; 0: by chi squared */
} palp_specimens_fit;

PALP_API void palp_specimens_fit_free(palp_specimens_fit *fit); /* frees arrays, zeroes; NULL is fine */

/* K(e) of the specimens at a strain. */
typedef struct palp_specimens_point {
    double stiffness_N, sd_N; /* of the mean specimen */
    double between_N, between_low,
        between_high; /* sd between specimens, and its 95 % interval by chi squared */
    double within_N;  /* sd of one specimen's estimate */
    double new_sd_N;  /* 1.96 of it about stiffness_N hold 95 % of the specimens not measured */
} palp_specimens_point;

/* At strain[n], into the caller's point[n]. ERR_ARGUMENT: an empty fit. */
PALP_API palp_status palp_specimens_fit_stiffness(const palp_specimens_fit *fit, size_t n,
                                                  const double *strain, palp_specimens_point *point);

/* The fit's force for a recording, at its samples, into the caller's force_N[recording->n]. run is the
 * recording's index in the fit, which chooses its K_inf. ERR_ARGUMENT: run out of range. */
PALP_API palp_status palp_lumped_fit_force(const palp_lumped_fit *fit, size_t run,
                                           const palp_recording *recording, double *force_N);

#ifdef __cplusplus
}
#endif
#endif
