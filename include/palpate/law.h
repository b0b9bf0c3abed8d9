/* law.h: stiffness laws, F = K(|e|) e, behind one interface with value, derivative and energy. Stable. */
#ifndef PALPATE_LAW_H
#define PALPATE_LAW_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_LAW_MAX = 32 }; /* most coefficients a law holds */

typedef enum palp_law_kind {
    PALP_LAW_POLYNOMIAL,     /* K(a) = c0 + c1 a + c2 a^2 ..., c in N (Eq. 4.3) */
    PALP_LAW_SPLINE,         /* C1 piecewise cubic through (strain_i, K_i), monotone between knots (slopes
                                of Fritsch and Butland 1984 as in PCHIP: weighted harmonic means,
                                shape-preserving three-point formula at the two ends); beyond the last
                                knot K continues as a straight line with the end slope */
    PALP_LAW_NEO_HOOKEAN,    /* W = C10 (I1 - 3) (Eq. 3.59) */
    PALP_LAW_MOONEY_RIVLIN2, /* C10, C01 (Eq. 3.60, 3.76) */
    PALP_LAW_MOONEY_RIVLIN5, /* C10, C01, C20, C11, C02 (Eq. 3.73, 3.76) */
    PALP_LAW_YEOH,           /* W = sum over i = 1.. of Ci0 (I1 - 3)^i: C10, C20, C30, ... any number
                                (Eq. 3.62 without its constant i = 0) */
    PALP_LAW_OGDEN           /* W = sum mu_i / alpha_i (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3):
                                mu1, alpha1, mu2, alpha2, ... (Eq. 3.63); the initial shear modulus is
                                sum mu_i alpha_i / 2, so alpha 2, mu 2 C10 is neo-Hookean */
} palp_law_kind;

/* A stiffness law; a plain value, copied freely. Fill it with one of the three makers below, and
 * change it through them too (a spline's slopes follow from its knots).
 * The hyperelastic laws are those of an incompressible cylinder of initial cross-section area_m2
 * in uniaxial compression (Section 3.2): F(a) = -area dW/dstretch at stretch 1 - a, a = |strain|, and
 * K = F(a)/a. */
typedef struct palp_law {
    palp_law_kind kind;
    size_t n;                          /* number of coefficients */
    double coefficients[PALP_LAW_MAX]; /* N (polynomial, spline), Pa (hyperelastic; Ogden's alpha: 1) */
    double strain[PALP_LAW_MAX];       /* spline only: knots, strain[0] = 0, increasing */
    double slope[PALP_LAW_MAX];        /* spline only: dK/da at the knots, N; derived by the maker */
    double energy[PALP_LAW_MAX];       /* spline only: integral of K(a) a da to the knots, N; likewise */
    double area_m2;                    /* hyperelastic only: initial cross-section */
    /* Largest |strain| of the measurement; beyond it the force continues along its tangent (palp_law_limit).
     * 0 = not known: the formula of the kind holds everywhere. */
    double strain_max;
} palp_law;

/* K(a) = sum c_N[i] a^i, i < n, 1 <= n <= PALP_LAW_MAX. ERR_ARGUMENT: n = 0 or a coefficient is not
 * finite; ERR_LIMIT: n too large (so for all three makers). *law is untouched on failure. */
PALP_API palp_status palp_law_polynomial(size_t n, const double *c_N, palp_law *law);

/* Spline through n >= 2 knots; strain[0] = 0, strictly increasing; stiffness_N finite and > 0. */
PALP_API palp_status palp_law_spline(size_t n, const double *strain, const double *stiffness_N,
                                     palp_law *law);

/* One of the hyperelastic kinds with n coefficients as listed at palp_law_kind; area_m2 > 0.
 * ERR_ARGUMENT too for an Ogden alpha of 0. */
PALP_API palp_status palp_law_hyperelastic(palp_law_kind kind, size_t n, const double *coefficients_Pa,
                                           double area_m2, palp_law *law);

/* Gives *law other coefficients c[law->n], as its maker takes them; knots, area and strain_max stay. Errors
 * as of the makers; *law is then untouched. */
PALP_API palp_status palp_law_set_coefficients(palp_law *law, const double *c);

/* Sets the strain to which the law was measured. Beyond it the force is a straight line with the force and
 * slope that it has there. If the slope of the force at strain_max is below a hundredth of K, the limit is
 * moved down to where it is not; law->strain_max is the limit used. 0 removes the limit; a maker makes a law
 * without one. ERR_ARGUMENT: not finite, negative, or a force that rises nowhere below it. */
PALP_API palp_status palp_law_limit(palp_law *law, double strain_max);

/* By how much |e| exceeds the strain of the measurement; 0 within it, and where it is not known. */
PALP_API double palp_law_beyond(const palp_law *law, double e);

/* The same law with every coefficient times factor (Ogden's alpha untouched); *scaled may be *law.
 * ERR_ARGUMENT: the result is no law (factor not finite, or <= 0 for a spline). */
PALP_API palp_status palp_law_scale(const palp_law *law, double factor, palp_law *scaled);

/* K(|e|) in N and dK/d|e| in N at strain e; either output may be NULL. */
PALP_API void palp_law_stiffness(const palp_law *law, double e, double *stiffness_N, double *slope_N);

/* For n strains e[n]: force f = K(|e|) e, tangent df/de, energy = integral of f de from 0 (N, i.e.
 * J per metre of rest length). A law depends on |e| only: e is positive in tension for an element and in
 * compression for a lumped specimen. tangent and energy may be NULL; the arrays must not overlap. A
 * hyperelastic law without a limit gives infinity at |e| >= 1. e may be any finite number. */
PALP_API void palp_law_force(const palp_law *law, size_t n, const double *e, double *force_N,
                             double *tangent_N, double *energy_N);

/* dforce[k] = d(K(|e|) e) / d coefficients[k], k < law->n, at one strain. The slopes of a spline follow its
 * knots. Where they have a kink (a flat interval, or a knot that is an extremum) they are taken as constant
 * 0. */
PALP_API void palp_law_gradient(const palp_law *law, double e, double *dforce);

/* The lowest K(a), N, for 0 <= a <= strain_max, searched on a fine grid and a spline's knots. A law with
 * a value <= 0 there is not physical. */
PALP_API double palp_law_minimum(const palp_law *law, double strain_max);

/* "polynomial", "spline", "neo_hookean", "mooney_rivlin2", "mooney_rivlin5", "yeoh", "ogden".
 * parse: ERR_ARGUMENT for any other name; kind_name: "unknown" for a number outside the list. */
PALP_API const char *palp_law_kind_name(palp_law_kind kind);
PALP_API palp_status palp_law_kind_parse(const char *name, palp_law_kind *kind);

#ifdef __cplusplus
}
#endif
#endif
