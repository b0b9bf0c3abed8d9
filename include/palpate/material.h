/* material.h: the generalized Maxwell solid, a nonlinear spring beside N Maxwell arms, as one
 * element advances it in time. Stable. */
#ifndef PALPATE_MATERIAL_H
#define PALPATE_MATERIAL_H

#include <palpate/law.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_ARMS_MAX = 16 }; /* most arms a material holds */

/* How an element advances in time.
 * PALP_HISTORY: F = K(|e|) e + sum q_j, dq_j/dt + q_j / tau_j = K_j ds_j/dt, each q_j advanced
 *   exactly for a drive s_j linear over the step.
 * PALP_SEDEF2008: Eq. 5.4 and 5.10-5.14: backward difference, the previous force a fixed vector;
 *   at most one arm, without strain dependence. It reproduces the tables of the thesis, not the material
 *   (doc/strain-dependence.md). */
typedef enum palp_formulation { PALP_HISTORY, PALP_SEDEF2008 } palp_formulation;

/* One Maxwell element. tau = viscosity / stiffness at zero strain. With strain dependence
 * (Eq. 3.78-3.79) the stiffness is K (1 + beta |e|) and the relaxation time tau (1 + gamma |e|). */
typedef struct palp_arm {
    double stiffness_N;  /* K_j > 0, N */
    double viscosity_Ns; /* b_j > 0, N s */
    double beta;         /* 1 per unit strain, >= 0 or small enough that 1 + beta |e| > 0 */
    double gamma;        /* 1 per unit strain, likewise */
} palp_arm;

/* A material; a plain value. With quasi_linear the arms are driven by the elastic response
 * (Fung's QLV, Eq. 3.77): s_j = K(|e|) e / K(0), so at small strain both agree. */
typedef struct palp_material {
    palp_law law;
    size_t n_arms;
    palp_arm arms[PALP_ARMS_MAX];
    double dashpot_Ns; /* parallel (Voigt) dashpot, N s, 0 = none */
    bool quasi_linear;
    palp_formulation formulation;
} palp_material;

/* Whether a material can be run; a line in error (may be NULL) says what is wrong. ERR_ARGUMENT: a number out
 * of its range or not finite; ERR_LIMIT: more than PALP_ARMS_MAX arms; ERR_UNSUPPORTED: the formulation has
 * no equation for it. */
PALP_API palp_status palp_material_check(const palp_material *material, palp_error *error);

/* The state of one element after a step, from which the next one starts; zero-initialised = undeformed and at
 * rest. */
typedef struct palp_element_state {
    double strain;               /* e */
    double force_N;              /* F */
    double arm_N[PALP_ARMS_MAX]; /* q_j */
} palp_element_state;

/* Advances one element, or a lumped specimen, from *from to strain within dt_s. Writes *to, which may be
 * from, and if tangent_N is not NULL dF/de at the end of the step. dt_s = 0 is an instantaneous step, dt_s =
 * INFINITY a fully relaxed one. Only what could overrun an array is checked here; call palp_material_check
 * once for everything else. ERR_ARGUMENT: dt_s < 0 or NaN, strain not finite, a law or arms beyond their
 * arrays, or dt_s = 0 with a parallel dashpot or PALP_SEDEF2008. */
PALP_API palp_status palp_element_advance(const palp_material *material, const palp_element_state *from,
                                          double strain, double dt_s, palp_element_state *to,
                                          double *tangent_N);

/* Force of a lumped specimen of height height_m that follows depth_m[n] (positive = compression) at
 * the increasing times time_s[n]; at rest before time_s[0], where depth_m[0] is applied at once.
 * Linear depth between the samples. force_N[n] is the caller's. Errors of palp_material_check and
 * palp_element_advance; ERR_ARGUMENT: a height that is not positive, times that do not increase. */
PALP_API palp_status palp_lumped_run(const palp_material *material, double height_m, size_t n,
                                     const double *time_s, const double *depth_m, double *force_N);

#ifdef __cplusplus
}
#endif
#endif
