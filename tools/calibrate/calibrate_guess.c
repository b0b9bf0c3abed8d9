/* calibrate_guess.c: first guesses of an element's law and arms, from the lumped model. */
#include "calibrate.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Interpolates the law by a polynomial of this degree at Chebyshev's points of [0, strain_max]. It is exact
 * for polynomials, and nearly the best one otherwise. */
palp_status guess_polynomial(const palp_law *law, size_t degree, double strain_max, palp_law *guess) {
    double e[PALP_LAW_MAX], f[PALP_LAW_MAX], c[PALP_LAW_MAX] = {0};
    size_t n = degree + 1;
    if (law->kind == PALP_LAW_POLYNOMIAL && law->n <= n) {
        for (size_t i = 0; i < law->n; i++)
            c[i] = law->coefficients[i];
        return palp_law_polynomial(n, c, guess);
    }
    for (size_t i = 0; i < n; i++) {
        e[i] = 0.5 * strain_max * (1 - cos(pi * ((double)i + 0.5) / (double)n));
        palp_law_stiffness(law, e[i], &f[i], NULL);
    }
    for (size_t k = 1; k < n; k++) { /* Newton's divided differences */
        for (size_t i = n - 1; i >= k; i--)
            f[i] = (f[i] - f[i - 1]) / (e[i] - e[i - k]);
    }
    for (size_t k = n; k-- > 0;) { /* c = c (x - e[k]) + f[k] */
        for (size_t i = n - 1; i > 0; i--)
            c[i] = c[i - 1] - e[k] * c[i];
        c[0] = f[k] - e[k] * c[0];
    }
    return palp_law_polynomial(n, c, guess);
}

palp_status guess_spline(const palp_law *law, size_t knots, double strain_max, palp_law *guess) {
    double e[PALP_LAW_MAX], stiffness[PALP_LAW_MAX];
    for (size_t i = 0; i < knots; i++) {
        e[i] = strain_max * (double)i / (double)(knots - 1);
        palp_law_stiffness(law, e[i], &stiffness[i], NULL);
    }
    return palp_law_spline(knots, e, stiffness, guess);
}

/* The lumped model's arms, stiffness and viscosity times ratio. For another number of arms the stiffness is
 * divided equally, and times are spread over the same range (a decade for one arm). */
void guess_arms(const palp_material *lumped, size_t n, double ratio, palp_material *guess) {
    double total = 0, shortest = INFINITY, longest = 0;
    guess->n_arms = n;
    for (size_t j = 0; j < lumped->n_arms; j++) {
        double tau = lumped->arms[j].viscosity_Ns / lumped->arms[j].stiffness_N;
        total += lumped->arms[j].stiffness_N;
        shortest = fmin(shortest, tau);
        longest = fmax(longest, tau);
    }
    if (lumped->n_arms < 2) {
        shortest = longest / sqrt(10);
        longest *= sqrt(10);
    }
    for (size_t j = 0; j < n; j++) {
        if (n == lumped->n_arms) {
            guess->arms[j] = lumped->arms[j];
        } else {
            double part = n > 1 ? (double)j / (double)(n - 1) : 0.5;
            double tau = shortest * pow(longest / shortest, part);
            guess->arms[j] = (palp_arm){total / (double)n, total / (double)n * tau, 0, 0};
        }
        guess->arms[j].stiffness_N *= ratio;
        guess->arms[j].viscosity_Ns *= ratio;
    }
}
