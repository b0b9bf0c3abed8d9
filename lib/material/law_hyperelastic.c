/* law_hyperelastic.c: the incompressible hyperelastic cylinder in uniaxial compression (Section 3.2). */
#include "law_internal.h"

#include <float.h>
#include <math.h>

/* With stretch s = 1 - a the invariants of Eq. 3.70 factor as
 *   I1 - 3 = a^2 (3 - a) / s, I2 - 3 = a^2 (3 - 2 a) / s^2,
 * and K = -(dW/ds)/a has no cancellation as a goes to 0. All three sums are per unit of area. */
typedef struct response {
    double energy, stiffness, slope; /* W, K, dK/da */
} response;

/* J = I - 3 and p = (dJ/da)/a with its derivative, for I1 and I2. */
typedef struct invariants {
    double a;
    double j1, p1, dp1;
    double j2, p2, dp2;
} invariants;

static invariants strain_invariants_at(double a) {
    double s = 1.0 - a, r = 1.0 / s;
    invariants v = {.a = a};
    v.j1 = a * a * (3.0 - a) * r;
    v.p1 = 2.0 * (1.0 + r + r * r);
    v.dp1 = 2.0 * r * r * (1.0 + 2.0 * r);
    v.j2 = a * a * (3.0 - 2.0 * a) * r * r;
    v.p2 = r * v.p1;
    v.dp2 = r * r * v.p1 + r * v.dp1;
    return v;
}

/* x^n; 0 for negative n, which stands for the derivative of a constant. */
static double integer_power_or_zero(double x, int n) {
    if (n < 0)
        return 0.0;
    double y = 1.0;
    for (; n > 0; n--)
        y *= x;
    return y;
}

/* The response of W = (I1 - 3)^p (I2 - 3)^q. */
static response invariant_term(const invariants *v, int p, int q) {
    double f1 = integer_power_or_zero(v->j1, p), f2 = integer_power_or_zero(v->j2, q);
    double g1 = p * integer_power_or_zero(v->j1, p - 1),
           g2 = q * integer_power_or_zero(v->j2, q - 1); /* first derivatives */
    double h1 = p * (p - 1) * integer_power_or_zero(v->j1, p - 2),
           h2 = q * (q - 1) * integer_power_or_zero(v->j2, q - 2);
    double w1 = g1 * f2, w2 = f1 * g2, w12 = g1 * g2;
    response r;
    r.energy = f1 * f2;
    r.stiffness = w1 * v->p1 + w2 * v->p2;
    r.slope = w1 * v->dp1 + w2 * v->dp2 +
              v->a * (h1 * f2 * v->p1 * v->p1 + 2.0 * w12 * v->p1 * v->p2 + f1 * h2 * v->p2 * v->p2);
    return r;
}

/* Exponents of (I1 - 3) and (I2 - 3) that coefficient i stands for. */
static void exponents_of_invariants(palp_law_kind kind, size_t i, int *p, int *q) {
    static const int mooney_rivlin[5][2] = {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    if (kind == PALP_LAW_YEOH || kind == PALP_LAW_NEO_HOOKEAN) {
        *p = (int)i + 1;
        *q = 0;
    } else {
        *p = mooney_rivlin[i][0];
        *q = mooney_rivlin[i][1];
    }
}

/* d/da of ((1 - a)^beta - 1) / a by its binomial series, for small a (|beta| + 2). */
static double quotient_slope_series(double beta, double a) {
    double term = -beta, power_a = 1.0, sum = 0.0; /* term = (-1)^k binomial(beta, k) */
    for (int k = 2; k < 200; k++) {
        term *= -(beta - k + 1.0) / k;
        double add = (k - 1.0) * term * power_a;
        sum += add;
        if (fabs(add) <= 0.01 * DBL_EPSILON * fabs(sum))
            break;
        power_a *= a;
    }
    return sum;
}

/* y = s^beta, value = (y - 1) / a and its derivative, exact to rounding for every 0 <= a < 1. */
static void power_quotient(double beta, double a, double *y, double *value, double *slope) {
    double l = log1p(-a);
    *y = exp(beta * l);
    *value = a > 0.0 ? expm1(beta * l) / a : -beta;
    if (a * (fabs(beta) + 2.0) < 0.5)
        *slope = quotient_slope_series(beta, a);
    else
        *slope = (-beta * *y / (1.0 - a) - *value) / a;
}

/* The response of one Ogden term with mu = 1, W = (s^alpha + 2 s^(-alpha/2) - 3) / alpha. With
 * y = s^(-alpha/2), W = (y - 1)^2 (2 y + 1) / (y^2 alpha) and K = (y - 1)/a (1 + 1/y + 1/y^2) / s. */
static response response_of_ogden_term(double alpha, double a) {
    double beta = -0.5 * alpha, y, q, dq, r = 1.0 / (1.0 - a);
    power_quotient(beta, a, &y, &q, &dq);
    double g = 1.0 + (1.0 + 1.0 / y) / y, dg = beta * r * (1.0 + 2.0 / y) / y;
    response t;
    t.energy = (q * a / y) * (q * a / y) * (2.0 * y + 1.0) / alpha;
    t.stiffness = q * g * r;
    t.slope = r * (dq * g + q * dg + q * g * r);
    return t;
}

/* d/da of -log(1 - a) / a, by its series for small a. */
static double log_strain_ratio_slope(double a) {
    double power_a = 1.0, sum = 0.0;
    if (a > 0.1)
        return (1.0 / (1.0 - a) + log1p(-a) / a) / a;
    for (int k = 1; k < 30; k++) {
        sum += k * power_a / (k + 1.0);
        power_a *= a;
    }
    return sum;
}

/* dK/dalpha of the same term, from K = (s^(-alpha/2 - 1) - s^(alpha - 1)) / a. *slope, which may be NULL:
 * d2K/(da dalpha). */
static double ogden_exponent_gradient(double alpha, double a, double *slope) {
    double l = log1p(-a), s = 1.0 - a;
    double rate = a > 0.0 ? -l / a : 1.0;
    double low = exp(-0.5 * alpha * l), high = exp(alpha * l), sum = 0.5 * low + high;
    if (slope)
        *slope = (log_strain_ratio_slope(a) * sum + rate * (sum + alpha * (0.25 * low - high)) / s) / s;
    return rate * sum / s;
}

static void add_scaled_response(response *sum, double c, response term) {
    sum->energy += c * term.energy;
    sum->stiffness += c * term.stiffness;
    sum->slope += c * term.slope;
}

/* The whole law at a >= 0, in N; infinite from a = 1 on. */
static response hyperelastic_response_at(const palp_law *law, double a) {
    const double *c = law->coefficients;
    response sum = {0.0, 0.0, 0.0};
    if (a >= 1.0)
        return (response){INFINITY, INFINITY, INFINITY};
    if (law->kind == PALP_LAW_OGDEN) {
        for (size_t i = 0; i + 1 < law->n; i += 2)
            add_scaled_response(&sum, law->area_m2 * c[i], response_of_ogden_term(c[i + 1], a));
        return sum;
    }
    invariants v = strain_invariants_at(a);
    for (size_t i = 0; i < law->n; i++) {
        int p, q;
        exponents_of_invariants(law->kind, i, &p, &q);
        add_scaled_response(&sum, law->area_m2 * c[i], invariant_term(&v, p, q));
    }
    return sum;
}

palp_status law_hyperelastic_check(palp_law_kind kind, size_t n, const double *c) {
    switch (kind) {
    case PALP_LAW_NEO_HOOKEAN:
        return n == 1 ? PALP_OK : PALP_ERR_ARGUMENT;
    case PALP_LAW_MOONEY_RIVLIN2:
        return n == 2 ? PALP_OK : PALP_ERR_ARGUMENT;
    case PALP_LAW_MOONEY_RIVLIN5:
        return n == 5 ? PALP_OK : PALP_ERR_ARGUMENT;
    case PALP_LAW_YEOH:
        return PALP_OK;
    case PALP_LAW_OGDEN:
        for (size_t i = 1; i < n; i += 2) {
            if (c[i] == 0.0)
                return PALP_ERR_ARGUMENT;
        }
        return n % 2 == 0 ? PALP_OK : PALP_ERR_ARGUMENT;
    default:
        return PALP_ERR_ARGUMENT;
    }
}

void law_hyperelastic_force(const palp_law *law, size_t n, const double *e, double *force_N,
                            double *tangent_N, double *energy_N) {
    for (size_t i = 0; i < n; i++) {
        double a = fabs(e[i]);
        response r = hyperelastic_response_at(law, a);
        force_N[i] = r.stiffness * e[i];
        if (tangent_N)
            tangent_N[i] = a > 0.0 ? r.stiffness + a * r.slope : r.stiffness;
        if (energy_N)
            energy_N[i] = r.energy;
    }
}

void law_hyperelastic_stiffness(const palp_law *law, double a, double *stiffness_N, double *slope_N) {
    response r = hyperelastic_response_at(law, a);
    *stiffness_N = r.stiffness;
    *slope_N = r.slope;
}

static void ogden_gradient(const palp_law *law, double a, double *dstiffness, double *dslope) {
    for (size_t i = 0; i + 1 < law->n; i += 2) {
        double mu = law->coefficients[i], alpha = law->coefficients[i + 1], slope;
        response term = response_of_ogden_term(alpha, a);
        dstiffness[i] = law->area_m2 * term.stiffness;
        dstiffness[i + 1] = law->area_m2 * mu * ogden_exponent_gradient(alpha, a, dslope ? &slope : NULL);
        if (dslope) {
            dslope[i] = law->area_m2 * term.slope;
            dslope[i + 1] = law->area_m2 * mu * slope;
        }
    }
}

void law_hyperelastic_gradient(const palp_law *law, double a, double *dstiffness, double *dslope) {
    if (a >= 1.0) {
        for (size_t k = 0; k < law->n; k++)
            dstiffness[k] = INFINITY;
        for (size_t k = 0; k < law->n && dslope; k++)
            dslope[k] = INFINITY;
        return;
    }
    if (law->kind == PALP_LAW_OGDEN) {
        ogden_gradient(law, a, dstiffness, dslope);
        return;
    }
    invariants v = strain_invariants_at(a);
    for (size_t k = 0; k < law->n; k++) {
        int p, q;
        exponents_of_invariants(law->kind, k, &p, &q);
        response term = invariant_term(&v, p, q);
        dstiffness[k] = law->area_m2 * term.stiffness;
        if (dslope)
            dslope[k] = law->area_m2 * term.slope;
    }
}
