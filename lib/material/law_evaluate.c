/* law_evaluate.c: a law at any strain: the formula of its kind, continued by its tangent beyond the largest
 * measured strain. */
#include "law_internal.h"

#include <math.h>
#include <string.h>

/* Force, slope and energy at the end of the measured range. */
typedef struct range_end {
    double force, tangent, energy;
} range_end;

static range_end force_at_range_end(const palp_law *law) {
    range_end end;
    law_kind_force(law, 1, &law->strain_max, &end.force, &end.tangent, &end.energy);
    return end;
}

static bool is_strain_beyond_range(const palp_law *law, double a) {
    return law->strain_max > 0.0 && a > law->strain_max;
}

static void extrapolate_linearly(const range_end *end, double e, double beyond, double *force,
                                 double *tangent, double *energy) {
    *force = copysign(end->force + end->tangent * beyond, e);
    if (tangent)
        *tangent = end->tangent;
    if (energy)
        *energy = end->energy + beyond * (end->force + 0.5 * end->tangent * beyond);
}

/* Replaces only the values beyond the measured range. */
static void evaluate_force_beyond_range(const palp_law *law, size_t n, const double *e, double *force_N,
                                        double *tangent_N, double *energy_N) {
    size_t i = 0;
    while (i < n && fabs(e[i]) <= law->strain_max)
        i++;
    if (i == n)
        return;
    const range_end end = force_at_range_end(law);
    for (; i < n; i++)
        if (fabs(e[i]) > law->strain_max)
            extrapolate_linearly(&end, e[i], fabs(e[i]) - law->strain_max, &force_N[i],
                                 tangent_N ? &tangent_N[i] : NULL, energy_N ? &energy_N[i] : NULL);
}

static void stiffness_beyond(const palp_law *law, double a, double *stiffness_N, double *slope_N) {
    const range_end end = force_at_range_end(law);
    *stiffness_N = (end.force + end.tangent * (a - law->strain_max)) / a;
    *slope_N = (end.tangent - *stiffness_N) / a;
}

/* At the end the force is K(end) end, its slope K(end) + end K'(end). */
static void gradient_beyond(const palp_law *law, double a, double *dstiffness) {
    const double end = law->strain_max, beyond = a - end;
    double dslope[PALP_LAW_MAX];
    law_kind_gradient(law, end, dstiffness, dslope);
    for (size_t k = 0; k < law->n; k++)
        dstiffness[k] = (end * dstiffness[k] + beyond * (dstiffness[k] + end * dslope[k])) / a;
}

void palp_law_force(const palp_law *law, size_t n, const double *e, double *force_N, double *tangent_N,
                    double *energy_N) {
    if (!law || !e || !force_N)
        return;
    law_kind_force(law, n, e, force_N, tangent_N, energy_N);
    if (law->strain_max > 0.0)
        evaluate_force_beyond_range(law, n, e, force_N, tangent_N, energy_N);
}

void palp_law_stiffness(const palp_law *law, double e, double *stiffness_N, double *slope_N) {
    if (!law)
        return;
    double a = fabs(e), k, slope;
    if (is_strain_beyond_range(law, a))
        stiffness_beyond(law, a, &k, &slope);
    else
        law_kind_stiffness(law, a, &k, &slope);
    if (stiffness_N)
        *stiffness_N = k;
    if (slope_N)
        *slope_N = slope;
}

void palp_law_gradient(const palp_law *law, double e, double *dforce) {
    if (!law || !dforce)
        return;
    double a = fabs(e);
    if (is_strain_beyond_range(law, a))
        gradient_beyond(law, a, dforce);
    else
        law_kind_gradient(law, a, dforce, NULL);
    for (size_t k = 0; k < law->n; k++)
        dforce[k] *= e;
}

/* Adds the integral of palp_law_gradient between two strains, by Gauss-Legendre quadrature. */
static void integrate_law_gradient(const palp_law *law, double from, double to, double *out) {
    enum { POINTS = 8 };
    static const double at[POINTS / 2] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                          0.96028985649753623};
    static const double weight[POINTS / 2] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                              0.10122853629037626};
    const double half = 0.5 * (to - from);
    double row[PALP_LAW_MAX];
    for (size_t i = 0; i < POINTS; i++) {
        palp_law_gradient(law, from + half * (1.0 + (i % 2 ? -at[i / 2] : at[i / 2])), row);
        for (size_t k = 0; k < law->n; k++)
            out[k] += half * weight[i / 2] * row[k];
    }
}

void law_energy_gradient(const palp_law *law, double e, double *out) {
    enum { PANELS = 4 };
    const double a = fabs(e), inside = is_strain_beyond_range(law, a) ? law->strain_max : a;
    double power = 0.5 * inside * inside;
    memset(out, 0, law->n * sizeof *out);
    if (law->kind == PALP_LAW_SPLINE)
        law_spline_energy_gradient(law, inside, out);
    else if (law->kind == PALP_LAW_POLYNOMIAL)
        for (size_t k = 0; k < law->n; k++, power *= inside)
            out[k] = 2.0 * power / (double)(k + 2);
    else
        for (int i = 0; i < PANELS; i++)
            integrate_law_gradient(law, inside * i / PANELS, inside * (i + 1) / PANELS, out);
    if (inside < a)
        integrate_law_gradient(law, inside, a, out);
}

double palp_law_minimum(const palp_law *law, double strain_max) {
    if (!law)
        return NAN;
    enum { GRID = 2000 };
    double lowest = INFINITY, k;
    for (int i = 0; i <= GRID; i++) {
        palp_law_stiffness(law, strain_max * i / GRID, &k, NULL);
        lowest = fmin(lowest, k);
    }
    if (law->kind == PALP_LAW_SPLINE) {
        for (size_t i = 0; i < law->n && law->strain[i] <= strain_max; i++)
            lowest = fmin(lowest, law->coefficients[i]);
    }
    return lowest;
}

double palp_law_beyond(const palp_law *law, double e) {
    return law && is_strain_beyond_range(law, fabs(e)) ? fabs(e) - law->strain_max : 0.0;
}

/* To be continued by its tangent a force must rise: by a hundredth of K at least. */
static bool does_force_rise_at_strain(const palp_law *law, double a) {
    double force, tangent;
    law_kind_force(law, 1, &a, &force, &tangent, NULL);
    return force > 0.0 && isfinite(tangent) && tangent >= 0.01 * force / a;
}

palp_status palp_law_limit(palp_law *law, double strain_max) {
    enum { STEPS = 400 };
    if (!law || !(strain_max >= 0.0) || !isfinite(strain_max))
        return PALP_ERR_ARGUMENT;
    for (int i = STEPS; i > 0 && strain_max > 0.0; i--) {
        double a = i == STEPS ? strain_max : strain_max * i / STEPS;
        if (does_force_rise_at_strain(law, a)) {
            law->strain_max = a;
            return PALP_OK;
        }
    }
    if (strain_max > 0.0)
        return PALP_ERR_ARGUMENT;
    law->strain_max = 0.0;
    return PALP_OK;
}
