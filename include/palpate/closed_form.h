/* closed_form.h: closed-form responses of viscoelastic models (Section 3.1.2, Eq. 3.20-3.56, 4.7). Stable. */
#ifndef PALPATE_CLOSED_FORM_H
#define PALPATE_CLOSED_FORM_H

#include <palpate/material.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The loadings, all starting from rest at t = 0:
 *   creep        constant stress stress_Pa; gives strain
 *   relaxation   constant strain; gives stress, Pa
 *   ramp         strain rate_1_s t; gives stress, Pa
 *   ramp_hold    strain rate_1_s min(t, ramp_s); gives stress, Pa
 * Everything is 0 for t < 0. Where the response jumps at t = 0, its value there is the one just after the
 * jump. At t = ramp_s a dashpot still gives its force (the peak). The linear models have no area: with N for
 * Pa and N s for Pa s throughout, stress is force (Eq. 4.6). Moduli and viscosities are > 0 unless they are
 * said to be >= 0; nothing is checked. doc/thesis-errata.md lists the errors of the thesis' equations. */

/* A spring and a dashpot, in series (Maxwell model, or one arm of a solid) or parallel (Voigt). */
typedef struct palp_spring_dashpot {
    double modulus_Pa;     /* E */
    double viscosity_Pa_s; /* eta; relaxation time tau = eta / E, Eq. 3.17 */
} palp_spring_dashpot;

/* Maxwell model, spring and dashpot in series (Eq. 3.16): Eq. 3.20, 3.21, 3.23, 3.25. */
PALP_API double palp_maxwell_creep(palp_spring_dashpot model, double stress_Pa, double t);
PALP_API double palp_maxwell_relaxation(palp_spring_dashpot model, double strain, double t);
PALP_API double palp_maxwell_ramp(palp_spring_dashpot model, double rate_1_s, double t);
PALP_API double palp_maxwell_ramp_hold(palp_spring_dashpot model, double rate_1_s, double ramp_s, double t);

/* Voigt model, spring and dashpot in parallel (Eq. 3.26): Eq. 3.28, 3.30, 3.33. */
PALP_API double palp_voigt_creep(palp_spring_dashpot model, double stress_Pa, double t);
PALP_API double palp_voigt_ramp(palp_spring_dashpot model, double rate_1_s, double t);
PALP_API double palp_voigt_ramp_hold(palp_spring_dashpot model, double rate_1_s, double ramp_s, double t);

/* Eq. 3.29, sigma(t) = eta strain delta(t) + E strain (the thesis leaves out the strain of the first
 * term). A step strain takes an infinite stress for no time, so the impulse is no number: the value is
 * E strain for t >= 0, and *impulse_Pa_s, if not NULL, receives the weight eta strain of delta(t). */
PALP_API double palp_voigt_relaxation(palp_spring_dashpot model, double strain, double t,
                                      double *impulse_Pa_s);

/* Maxwell solid (standard linear solid), a spring spring_Pa >= 0 beside one Maxwell arm (Eq. 3.40):
 * Eq. 3.42 with 3.43, 3.45, 3.48, 3.50. */
PALP_API double palp_maxwell_solid_creep(double spring_Pa, palp_spring_dashpot arm, double stress_Pa,
                                         double t);
PALP_API double palp_maxwell_solid_relaxation(double spring_Pa, palp_spring_dashpot arm, double strain,
                                              double t);
PALP_API double palp_maxwell_solid_ramp(double spring_Pa, palp_spring_dashpot arm, double rate_1_s, double t);
PALP_API double palp_maxwell_solid_ramp_hold(double spring_Pa, palp_spring_dashpot arm, double rate_1_s,
                                             double ramp_s, double t);

/* Generalized Maxwell solid: a spring beside any number of Maxwell arms, Eq. 3.51 to 3.53; its
 * relaxation function is the Prony series of Eq. 3.52. A plain value. */
typedef struct palp_generalized_maxwell {
    double spring_Pa; /* E_inf >= 0 */
    size_t n_arms;    /* 0 to PALP_ARMS_MAX */
    palp_spring_dashpot arms[PALP_ARMS_MAX];
} palp_generalized_maxwell;

/* Eq. 3.54, 3.55, 3.56. */
PALP_API double palp_generalized_maxwell_relaxation(const palp_generalized_maxwell *model, double strain,
                                                    double t);
PALP_API double palp_generalized_maxwell_ramp(const palp_generalized_maxwell *model, double rate_1_s,
                                              double t);
PALP_API double palp_generalized_maxwell_ramp_hold(const palp_generalized_maxwell *model, double rate_1_s,
                                                   double ramp_s, double t);

/* Creep of the generalized Maxwell solid, which the thesis has for one arm only (Eq. 3.42):
 *   strain(t) = stress (J_0 + fluidity t + sum_k J_k (1 - exp(-t / tau_k))).
 * The relaxation function has the transform
 * s E(s) = E_inf + sum_j E_j s / (s + r_j), with r_j = 1 / tau_j of the arms. The creep compliance is its
 * reciprocal, s J(s) = 1 / (s E(s)). On s = -p the transform rises from minus to plus infinity between
 * neighbouring r_j. Its zeros p_k therefore interlace them, p_1 < r_1 < p_2 < r_2 ..., and each is found by
 * bisection. Then
 *   J_0 = 1 / (E_inf + sum_j E_j), tau_k = 1 / p_k, J_k = 1 / (p_k sum_j E_j r_j / (r_j - p_k)^2).
 * With E_inf = 0 the solid is a liquid: p_1 = 0 becomes the flow term, fluidity = 1 / sum_j eta_j. */
typedef struct palp_retardation {
    double instant_1_Pa;                   /* J_0 */
    double fluidity_1_Pa_s;                /* 0 for a solid */
    size_t n;                              /* one for each different tau_j, less 1 if the spring is 0 */
    double compliance_1_Pa[PALP_ARMS_MAX]; /* J_k >= 0 */
    double time_s[PALP_ARMS_MAX];          /* tau_k, longest first */
} palp_retardation;

/* The retardation spectrum of a solid, once for any number of palp_generalized_maxwell_creep.
 * ERR_ARGUMENT: spring < 0, an arm's modulus or viscosity not > 0, a number not finite, or neither
 * spring nor arm; ERR_LIMIT: too many arms. */
PALP_API palp_status palp_retardation_spectrum(const palp_generalized_maxwell *model,
                                               palp_retardation *spectrum);
PALP_API double palp_generalized_maxwell_creep(const palp_retardation *spectrum, double stress_Pa, double t);

/* Force of the nonlinear lumped solid in a ramp and hold (Eq. 4.7; 5.24 and 5.25 for one arm, 6.1 for two).
 * The strain rises to strain within ramp_s and then stays. The force at time_s[n], in any order, goes to the
 * caller's force_N[n]:
 *   F(t) = K(|e|) e + sum_j q_j(t), e = strain min(t, ramp_s) / ramp_s.
 * K is taken at the present strain; the thesis gives the hold only. strain is positive in compression and
 * may be negative. ramp_s = 0 is a step. With beta an arm obeys q_j' + q_j / tau_j = K_j (1 + beta |e|) e',
 * which has a closed form on a ramp too. A parallel dashpot adds its constant force on the ramp. The
 * formulation is ignored: this is the exact solution, which PALP_HISTORY reproduces.
 * ERR_UNSUPPORTED: gamma or quasi_linear (no closed form); ERR_ARGUMENT: no material, ramp_s < 0, strain not
 * finite, or ramp_s = 0 with a dashpot. */
PALP_API palp_status palp_lumped_ramp_hold(const palp_material *material, double strain, double ramp_s,
                                           size_t n, const double *time_s, double *force_N);

/* A small oscillation of a specimen of that height about a strain, in the steady state: depth d cos(w t), w =
 * 2 pi frequency, needs the force d (storage cos(w t) - loss sin(w t)). With x = w tau_j and the law's
 * tangent F', storage = (F'(e) + sum_j K_j x^2 / (1 + x^2)) / height. The loss is (sum_j K_j x / (1 + x^2) +
 * dashpot w) / height. K_j and tau_j include beta, gamma and quasi_linear at the strain. The caller's
 * storage_N_m[n] and loss_N_m[n]; by H / A of a cylinder they are moduli. Errors of palp_material_check;
 * ERR_ARGUMENT: a height or a frequency not > 0, a strain not finite; ERR_UNSUPPORTED: PALP_SEDEF2008. */
PALP_API palp_status palp_lumped_oscillation(const palp_material *material, double height_m, double strain,
                                             size_t n, const double *frequency_Hz, double *storage_N_m,
                                             double *loss_N_m);

#ifdef __cplusplus
}
#endif
#endif
