/* law_internal.h: the kinds of stiffness law to which law.c dispatches. */
#ifndef PALPATE_LAW_INTERNAL_H
#define PALPATE_LAW_INTERNAL_H

#include <palpate/law.h>
#include <stdbool.h>

/* Are kind and number of coefficients within the law's arrays? law_check tests this first. */
bool law_bounded(const palp_law *law);

/* Would the law's constructor accept these values? ERR_ARGUMENT, ERR_LIMIT. */
palp_status law_check(const palp_law *law);

/* Arguments as for palp_law_force, palp_law_stiffness (with a = |e|) and palp_law_gradient. The gradients are
 * of K(a), and dslope (may be NULL) of dK/da. */

/* By the formula of the law's kind, without an end of its range. */
void law_kind_force(const palp_law *law, size_t n, const double *e, double *force_N, double *tangent_N,
                    double *energy_N);
void law_kind_stiffness(const palp_law *law, double a, double *stiffness_N, double *slope_N);
void law_kind_gradient(const palp_law *law, double a, double *dstiffness, double *dslope);

/* d energy / d coefficients at strain e: the integral of palp_law_gradient from 0 to |e|. */
void law_energy_gradient(const palp_law *law, double e, double *out);

/* Computes law->slope and law->energy from the values at the knots. */
void law_spline_derive(palp_law *law);
void law_spline_force(const palp_law *law, size_t n, const double *e, double *force_N, double *tangent_N,
                      double *energy_N);
void law_spline_stiffness(const palp_law *law, double a, double *stiffness_N, double *slope_N);
void law_spline_gradient(const palp_law *law, double a, double *dstiffness, double *dslope);
/* Adds to out. */
void law_spline_energy_gradient(const palp_law *law, double a, double *out);

/* Are the coefficients those of a hyperelastic law? */
palp_status law_hyperelastic_check(palp_law_kind kind, size_t n, const double *c);
void law_hyperelastic_force(const palp_law *law, size_t n, const double *e, double *force_N,
                            double *tangent_N, double *energy_N);
void law_hyperelastic_stiffness(const palp_law *law, double a, double *stiffness_N, double *slope_N);
void law_hyperelastic_gradient(const palp_law *law, double a, double *dstiffness, double *dslope);

#endif
