/* law_spline.c: the monotone C1 cubic spline as a stiffness law (Fritsch and Butland 1984). */
#include "law_internal.h"

#include <math.h>
#include <string.h>

/* One interval: K(x + u) = c[0] + c[1] u + c[2] u^2 + c[3] u^3; energy = integral of K(a) a da from 0 to
 * x. */
typedef struct piece {
    double x, c[4], energy;
} piece;

/* A slope at a knot and its derivatives by the secants left and right of it, 0 where there is none. */
typedef struct knot_slope {
    double slope, left, right;
} knot_slope;

static double interval_width(const palp_law *law, size_t i) {
    return law->strain[i + 1] - law->strain[i];
}

static double interval_secant(const palp_law *law, size_t i) {
    return (law->coefficients[i + 1] - law->coefficients[i]) / interval_width(law, i);
}

/* Weighted harmonic mean of the secants of intervals i-1 and i; 0 at an extremum. */
static knot_slope slope_at_inner_knot(const palp_law *law, size_t i) {
    double h0 = interval_width(law, i - 1), h1 = interval_width(law, i);
    double d0 = interval_secant(law, i - 1), d1 = interval_secant(law, i);
    knot_slope s = {0.0, 0.0, 0.0};
    if ((d0 > 0.0 && d1 > 0.0) || (d0 < 0.0 && d1 < 0.0)) {
        double w0 = (2.0 * h1 + h0) / (3.0 * (h0 + h1)), w1 = 1.0 - w0;
        double sum = w0 * d1 + w1 * d0;
        double p = d1 / sum, q = d0 / sum;
        s.slope = d0 * p;
        s.left = w0 * p * p;
        s.right = w1 * q * q;
    }
    return s;
}

/* Three-point slope at an end: near and far are the secants of the two intervals next to it. It has the sign
 * of near and at most three times its size, which keeps the end interval monotone. */
static knot_slope slope_at_end_knot(double h_near, double h_far, double near, double far) {
    double w = h_near / (h_near + h_far);
    knot_slope s = {(1.0 + w) * near - w * far, 1.0 + w, -w}; /* left = d/dnear, right = d/dfar */
    if (s.slope * near <= 0.0)
        return (knot_slope){0.0, 0.0, 0.0};
    if (near * far < 0.0 && fabs(s.slope) > 3.0 * fabs(near))
        return (knot_slope){3.0 * near, 3.0, 0.0};
    return s;
}

static knot_slope monotone_slope_at_knot(const palp_law *law, size_t i) {
    size_t n = law->n;
    if (n == 2)
        return i == 0 ? (knot_slope){interval_secant(law, 0), 0.0, 1.0}
                      : (knot_slope){interval_secant(law, 0), 1.0, 0.0};
    if (i == 0)
        return slope_at_end_knot(interval_width(law, 0), interval_width(law, 1), interval_secant(law, 0),
                                 interval_secant(law, 1));
    if (i == n - 1)
        return slope_at_end_knot(interval_width(law, n - 2), interval_width(law, n - 3),
                                 interval_secant(law, n - 2), interval_secant(law, n - 3));
    return slope_at_inner_knot(law, i);
}

/* Interval i for i < n - 1, or the straight continuation for i = n - 1. */
static piece cubic_piece_of_interval(const palp_law *law, size_t i) {
    piece p = {law->strain[i], {law->coefficients[i], law->slope[i], 0.0, 0.0}, law->energy[i]};
    if (i + 1 < law->n) {
        double h = interval_width(law, i), d = interval_secant(law, i);
        p.c[2] = (3.0 * d - 2.0 * law->slope[i] - law->slope[i + 1]) / h;
        p.c[3] = (law->slope[i] + law->slope[i + 1] - 2.0 * d) / (h * h);
    }
    return p;
}

/* Integral of K(a) a da from x to x + u. */
static double integrate_energy_in_piece(const piece *p, double u) {
    const double *c = p->c;
    double k = c[0] + u * (c[1] / 2.0 + u * (c[2] / 3.0 + u * c[3] / 4.0));
    double ku = c[0] / 2.0 + u * (c[1] / 3.0 + u * (c[2] / 4.0 + u * c[3] / 5.0));
    return u * (p->x * k + u * ku);
}

void law_spline_derive(palp_law *law) {
    for (size_t i = 0; i < law->n; i++)
        law->slope[i] = monotone_slope_at_knot(law, i).slope;
    law->energy[0] = 0.0;
    for (size_t i = 0; i + 1 < law->n; i++) {
        const piece p = cubic_piece_of_interval(law, i);
        law->energy[i + 1] = p.energy + integrate_energy_in_piece(&p, interval_width(law, i));
    }
}

static double piece_stiffness(const piece *p, double u) {
    return p->c[0] + u * (p->c[1] + u * (p->c[2] + u * p->c[3]));
}

static double stiffness_slope_in_piece(const piece *p, double u) {
    return p->c[1] + u * (2.0 * p->c[2] + u * 3.0 * p->c[3]);
}

/* The last knot at or below a. */
static size_t find_knot_interval(const palp_law *law, double a) {
    size_t low = 0, high = law->n;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (law->strain[middle] <= a)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Force, tangent and energy at a strain in a piece. */
static void evaluate_spline_piece(const piece *p, double e, double *force_N, double *tangent_N,
                                  double *energy_N) {
    double a = fabs(e), u = a - p->x, k = piece_stiffness(p, u);
    *force_N = k * e;
    if (tangent_N)
        *tangent_N = k + a * stiffness_slope_in_piece(p, u);
    if (energy_N)
        *energy_N = p->energy + integrate_energy_in_piece(p, u);
}

/* For a few strains each piece is made when needed, otherwise all before. */
void law_spline_force(const palp_law *law, size_t n, const double *e, double *force_N, double *tangent_N,
                      double *energy_N) {
    piece pieces[PALP_LAW_MAX];
    const bool few = n < law->n;
    for (size_t i = 0; i < law->n && !few; i++)
        pieces[i] = cubic_piece_of_interval(law, i);
    for (size_t i = 0; i < n; i++) {
        const size_t at = find_knot_interval(law, fabs(e[i]));
        const piece own = few ? cubic_piece_of_interval(law, at) : pieces[at];
        evaluate_spline_piece(&own, e[i], &force_N[i], tangent_N ? &tangent_N[i] : NULL,
                              energy_N ? &energy_N[i] : NULL);
    }
}

void law_spline_stiffness(const palp_law *law, double a, double *stiffness_N, double *slope_N) {
    piece p = cubic_piece_of_interval(law, find_knot_interval(law, a));
    *stiffness_N = piece_stiffness(&p, a - p.x);
    *slope_N = stiffness_slope_in_piece(&p, a - p.x);
}

/* Adds weight * d secant_i / d K_k. */
static void add_secant_derivative(const palp_law *law, size_t i, double weight, double *dstiffness) {
    double g = weight / interval_width(law, i);
    dstiffness[i] -= g;
    dstiffness[i + 1] += g;
}

/* Adds weight * d slope_i / d K_k. */
static void add_knot_slope_derivative(const palp_law *law, size_t i, double weight, double *dstiffness) {
    size_t n = law->n;
    knot_slope s = monotone_slope_at_knot(law, i);
    if (n > 2 && i == 0) { /* end slopes: near, far instead of left, right */
        add_secant_derivative(law, 0, weight * s.left, dstiffness);
        add_secant_derivative(law, 1, weight * s.right, dstiffness);
    } else if (n > 2 && i == n - 1) {
        add_secant_derivative(law, n - 2, weight * s.left, dstiffness);
        add_secant_derivative(law, n - 3, weight * s.right, dstiffness);
    } else {
        if (i > 0)
            add_secant_derivative(law, i - 1, weight * s.left, dstiffness);
        if (i + 1 < n)
            add_secant_derivative(law, i, weight * s.right, dstiffness);
    }
}

void law_spline_gradient(const palp_law *law, double a, double *dstiffness, double *dslope) {
    memset(dstiffness, 0, law->n * sizeof *dstiffness);
    if (dslope)
        memset(dslope, 0, law->n * sizeof *dslope);
    size_t i = find_knot_interval(law, a);
    double u = a - law->strain[i];
    if (i + 1 == law->n) {
        dstiffness[i] = 1.0;
        add_knot_slope_derivative(law, i, u, dstiffness);
        if (dslope)
            add_knot_slope_derivative(law, i, 1.0, dslope);
        return;
    }
    double h = interval_width(law, i), t = u / h; /* Hermite basis */
    double h01 = t * t * (3.0 - 2.0 * t);
    dstiffness[i] = 1.0 - h01;
    dstiffness[i + 1] = h01;
    add_knot_slope_derivative(law, i, u * (1.0 - t) * (1.0 - t), dstiffness);
    add_knot_slope_derivative(law, i + 1, u * t * (t - 1.0), dstiffness);
    if (!dslope)
        return;
    double turn = 6.0 * t * (1.0 - t) / h;
    dslope[i] = -turn;
    dslope[i + 1] = turn;
    add_knot_slope_derivative(law, i, (1.0 - t) * (1.0 - 3.0 * t), dslope);
    add_knot_slope_derivative(law, i + 1, t * (3.0 * t - 2.0), dslope);
}

/* Derivatives of the energy, from the start of interval i to a strain in it, by the values and slopes at its
 * ends. Three Gauss-Legendre points, exact for K(a) a. */
static void add_energy_derivatives(const palp_law *law, size_t i, double to, double *by_stiffness,
                                   double *by_slope) {
    static const double at[3] = {0.11270166537925831, 0.5, 0.88729833462074169},
                        weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    const double from = law->strain[i];
    for (size_t j = 0; j < 3; j++) {
        const double u = at[j] * (to - from), w = weight[j] * (to - from) * (from + u);
        if (i + 1 == law->n) {
            by_stiffness[i] += w;
            by_slope[i] += w * u;
            continue;
        }
        const double t = u / interval_width(law, i), h01 = t * t * (3.0 - 2.0 * t);
        by_stiffness[i] += w * (1.0 - h01);
        by_stiffness[i + 1] += w * h01;
        by_slope[i] += w * u * (1.0 - t) * (1.0 - t);
        by_slope[i + 1] += w * u * t * (t - 1.0);
    }
}

void law_spline_energy_gradient(const palp_law *law, double a, double *out) {
    double by_slope[PALP_LAW_MAX] = {0.0};
    for (size_t i = 0; i < law->n && law->strain[i] < a; i++)
        add_energy_derivatives(law, i, i + 1 < law->n ? fmin(a, law->strain[i + 1]) : a, out, by_slope);
    for (size_t i = 0; i < law->n; i++)
        if (by_slope[i] != 0.0)
            add_knot_slope_derivative(law, i, by_slope[i], out);
}
