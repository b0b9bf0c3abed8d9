/* thesis.h: the procedures of the thesis (Sedef 2008) as printed, to reproduce its tables. For other uses
 * there are characterize.h and calibrate.h. May change. */
#ifndef PALPATE_THESIS_H
#define PALPATE_THESIS_H

#include <palpate/calibrate.h>
#include <palpate/characterize.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Table 4.1: unweighted polynomial F = sum c_k e^(k+1), no constant (the printed ones had one that was
 * dropped), to a static recording's samples with depth > 0; *norm: 2-norm of the residual, N. ERR_ARGUMENT: a
 * degree of 0 or above PALP_LAW_MAX; ERR_INPUT: not more samples than coefficients. */
PALP_API palp_status palp_thesis_polynomial(const palp_recording *recording, size_t degree, palp_law *law,
                                            double *norm);

/* Section 4.3.3, one or two shared arms: per-recording fits give ranges of K and b, each cut into 20; all
 * combinations are tried, K_inf as fitted, least sum of |residual|. ERR_UNSUPPORTED: another number of arms.
 */
PALP_API palp_status palp_thesis_grid(size_t n, const palp_recording *recordings,
                                      const palp_characterize_settings *settings, palp_lumped_fit *fit,
                                      palp_error *error);

/* Figure 5.6: what palp_calibrate_static does, for a polynomial, by multiplying the law's curve by target
 * over force and fitting again until the residual grows. ERR_UNSUPPORTED: a law that is no polynomial;
 * ERR_ARGUMENT: a target that is not above 0. */
PALP_API palp_status palp_thesis_fixed_point(palp_network *network, const palp_material *start, size_t n,
                                             const double *depth_m, const double *target_N,
                                             const palp_static_settings *settings, palp_calibration *result);

typedef struct palp_three_phase_settings {
    size_t max_evaluations;           /* runs of the network */
    double dt_s;                      /* time step */
    double error_bound;               /* relative, of peak force, time to the steady state and force there */
    double steady_slope_N_s;          /* the force is steady where it falls slower than this */
    bool frozen_dwell;                /* nodes stay where the ramp leaves them, as in the thesis' tables */
    palp_calibrate_progress progress; /* may be NULL; non-zero stops with ERR_STOPPED */
    void *user;
} palp_three_phase_settings;

/* 80 runs of 1 ms steps, 0.01, 1e-3 N/s, nodes in equilibrium throughout. */
PALP_API palp_three_phase_settings palp_three_phase_settings_default(void);

/* Figure 5.21, one arm and one ramp and hold from rest. K1 and b1 are adjusted to the peak force. Then b1 is
 * adjusted to the time to the steady state, and the law's scale to the force there. This is repeated until
 * all three errors are within error_bound. The network's material is replaced by the result. ERR_UNSUPPORTED:
 * not one arm; ERR_ARGUMENT: another path, a record without force or that ends with its ramp. */
PALP_API palp_status palp_thesis_three_phase(palp_network *network, const palp_material *start,
                                             const palp_target *target,
                                             const palp_three_phase_settings *settings,
                                             palp_calibration *result);

#ifdef __cplusplus
}
#endif
#endif
