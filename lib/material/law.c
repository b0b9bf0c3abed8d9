/* law.c: stiffness laws: constructors, the polynomial law, and dispatch to the other kinds. */
#include "base/clones.h"
#include "law_internal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const char *const kind_names[] = {
    [PALP_LAW_POLYNOMIAL] = "polynomial",
    [PALP_LAW_SPLINE] = "spline",
    [PALP_LAW_NEO_HOOKEAN] = "neo_hookean",
    [PALP_LAW_MOONEY_RIVLIN2] = "mooney_rivlin2",
    [PALP_LAW_MOONEY_RIVLIN5] = "mooney_rivlin5",
    [PALP_LAW_YEOH] = "yeoh",
    [PALP_LAW_OGDEN] = "ogden",
};

enum { KIND_COUNT = sizeof kind_names / sizeof kind_names[0] };

const char *palp_law_kind_name(palp_law_kind kind) {
    size_t i = (size_t)kind;
    return i < KIND_COUNT ? kind_names[i] : "unknown";
}

palp_status palp_law_kind_parse(const char *name, palp_law_kind *kind) {
    if (!name || !kind)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; name && i < KIND_COUNT; i++) {
        if (strcmp(name, kind_names[i]) == 0) {
            *kind = (palp_law_kind)i;
            return PALP_OK;
        }
    }
    return PALP_ERR_ARGUMENT;
}

static bool are_all_values_finite(size_t n, const double *x) {
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(x[i]))
            return false;
    }
    return true;
}

static palp_status check_coefficients(size_t n, const double *c) {
    if (n == 0 || !c)
        return PALP_ERR_ARGUMENT;
    if (n > PALP_LAW_MAX)
        return PALP_ERR_LIMIT;
    return are_all_values_finite(n, c) ? PALP_OK : PALP_ERR_ARGUMENT;
}

static palp_law make_law_of_kind(palp_law_kind kind, size_t n, const double *c) {
    palp_law law = {.kind = kind, .n = n};
    memcpy(law.coefficients, c, n * sizeof *c);
    return law;
}

palp_status palp_law_polynomial(size_t n, const double *c_N, palp_law *law) {
    if (!c_N || !law)
        return PALP_ERR_ARGUMENT;
    palp_status status = check_coefficients(n, c_N);
    if (status == PALP_OK)
        *law = make_law_of_kind(PALP_LAW_POLYNOMIAL, n, c_N);
    return status;
}

palp_status palp_law_spline(size_t n, const double *strain, const double *stiffness_N, palp_law *law) {
    if (!strain || !stiffness_N || !law)
        return PALP_ERR_ARGUMENT;
    palp_status status = check_coefficients(n, stiffness_N);
    if (status != PALP_OK)
        return status;
    if (n < 2 || !strain || !are_all_values_finite(n, strain) || strain[0] != 0.0)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        if (stiffness_N[i] <= 0.0 || (i > 0 && strain[i] <= strain[i - 1]))
            return PALP_ERR_ARGUMENT;
    }
    palp_law made = make_law_of_kind(PALP_LAW_SPLINE, n, stiffness_N);
    memcpy(made.strain, strain, n * sizeof *strain);
    law_spline_derive(&made);
    *law = made;
    return PALP_OK;
}

palp_status palp_law_hyperelastic(palp_law_kind kind, size_t n, const double *coefficients_Pa, double area_m2,
                                  palp_law *law) {
    if (!coefficients_Pa || !law)
        return PALP_ERR_ARGUMENT;
    palp_status status = check_coefficients(n, coefficients_Pa);
    if (status == PALP_OK)
        status = law_hyperelastic_check(kind, n, coefficients_Pa);
    if (status != PALP_OK)
        return status;
    if (!(area_m2 > 0.0) || !isfinite(area_m2))
        return PALP_ERR_ARGUMENT;
    *law = make_law_of_kind(kind, n, coefficients_Pa);
    law->area_m2 = area_m2;
    return PALP_OK;
}

palp_status palp_law_set_coefficients(palp_law *law, const double *c) {
    if (!law || !c)
        return PALP_ERR_ARGUMENT;
    const palp_law like = *law;
    palp_status status;
    if (like.kind == PALP_LAW_POLYNOMIAL)
        status = palp_law_polynomial(like.n, c, law);
    else if (like.kind == PALP_LAW_SPLINE)
        status = palp_law_spline(like.n, like.strain, c, law);
    else
        status = palp_law_hyperelastic(like.kind, like.n, c, like.area_m2, law);
    law->strain_max = like.strain_max;
    return status;
}

bool law_bounded(const palp_law *law) {
    return (size_t)law->kind < KIND_COUNT && law->n > 0 && law->n <= PALP_LAW_MAX;
}

palp_status law_check(const palp_law *law) {
    palp_law made = *law;
    palp_status status = (size_t)law->kind < KIND_COUNT ? palp_law_set_coefficients(&made, law->coefficients)
                                                        : PALP_ERR_ARGUMENT;
    if (!(law->strain_max >= 0.0) || !isfinite(law->strain_max))
        status = PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < made.n && !status; i++)
        if (law->kind == PALP_LAW_SPLINE &&
            !(law->slope[i] == made.slope[i] && law->energy[i] == made.energy[i]))
            status = PALP_ERR_ARGUMENT;
    return status;
}

palp_status palp_law_scale(const palp_law *law, double factor, palp_law *scaled) {
    if (!law || !scaled)
        return PALP_ERR_ARGUMENT;
    double c[PALP_LAW_MAX];
    for (size_t i = 0; i < law->n; i++) {
        bool exponent = law->kind == PALP_LAW_OGDEN && i % 2 == 1;
        c[i] = exponent ? law->coefficients[i] : law->coefficients[i] * factor;
    }
    palp_law made = *law;
    palp_status status = palp_law_set_coefficients(&made, c);
    if (!status)
        *scaled = made;
    return status;
}

/* The polynomial loops are inlined with constant m into polynomial_force. This unrolls the inner loop and
 * lets the compiler vectorise the outer one. */
static inline void polynomial_force_by_horner(size_t m, const double *restrict c, size_t n,
                                              const double *restrict e, double *restrict force) {
    for (size_t i = 0; i < n; i++) {
        double a = fabs(e[i]), k = c[m - 1];
        for (size_t j = m - 1; j-- > 0;)
            k = k * a + c[j];
        force[i] = k * e[i];
    }
}

static inline void horner_tangent(size_t m, const double *restrict c, size_t n, const double *restrict e,
                                  double *restrict force, double *restrict tangent) {
    for (size_t i = 0; i < n; i++) {
        double a = fabs(e[i]), k = c[m - 1], slope = 0.0;
        for (size_t j = m - 1; j-- > 0;) {
            slope = slope * a + k;
            k = k * a + c[j];
        }
        force[i] = k * e[i];
        tangent[i] = k + a * slope;
    }
}

static inline void polynomial_loop(size_t m, const double *c, size_t n, const double *e, double *force,
                                   double *tangent) {
    if (tangent)
        horner_tangent(m, c, n, e, force, tangent);
    else
        polynomial_force_by_horner(m, c, n, e, force);
}

/* sum c_j a^(j+2) / (j+2) */
static void polynomial_energy(const palp_law *law, size_t n, const double *restrict e,
                              double *restrict energy) {
    double g[PALP_LAW_MAX];
    size_t m = law->n;
    for (size_t j = 0; j < m; j++)
        g[j] = law->coefficients[j] / (double)(j + 2);
    for (size_t i = 0; i < n; i++) {
        double a = fabs(e[i]), w = g[m - 1];
        for (size_t j = m - 1; j-- > 0;)
            w = w * a + g[j];
        energy[i] = w * a * a;
    }
}

PALP_CLONES
static void polynomial_force(const palp_law *law, size_t n, const double *e, double *force, double *tangent,
                             double *energy) {
    const double *c = law->coefficients;
    if (energy)
        polynomial_energy(law, n, e, energy);
    switch (law->n) {
    case 1:
        polynomial_loop(1, c, n, e, force, tangent);
        break;
    case 2:
        polynomial_loop(2, c, n, e, force, tangent);
        break;
    case 3:
        polynomial_loop(3, c, n, e, force, tangent);
        break;
    case 4:
        polynomial_loop(4, c, n, e, force, tangent);
        break;
    case 5:
        polynomial_loop(5, c, n, e, force, tangent);
        break;
    case 6:
        polynomial_loop(6, c, n, e, force, tangent);
        break;
    default:
        polynomial_loop(law->n, c, n, e, force, tangent);
    }
}

static void polynomial_stiffness(const palp_law *law, double a, double *stiffness, double *slope) {
    double k = law->coefficients[law->n - 1], d = 0.0;
    for (size_t j = law->n - 1; j-- > 0;) {
        d = d * a + k;
        k = k * a + law->coefficients[j];
    }
    *stiffness = k;
    *slope = d;
}

static void polynomial_gradient(const palp_law *law, double a, double *dstiffness, double *dslope) {
    double power = 1.0, below = 0.0; /* a^k, k a^(k - 1) */
    for (size_t k = 0; k < law->n; k++) {
        dstiffness[k] = power;
        if (dslope)
            dslope[k] = below;
        below = (double)(k + 1) * power;
        power *= a;
    }
}

/* What a kind of law computes, as the functions below. */
typedef struct law_row {
    void (*force)(const palp_law *law, size_t n, const double *e, double *force_N, double *tangent_N,
                  double *energy_N);
    void (*stiffness)(const palp_law *law, double a, double *stiffness_N, double *slope_N);
    void (*gradient)(const palp_law *law, double a, double *dstiffness, double *dslope);
} law_row;

static const law_row *row_of(palp_law_kind kind) {
    static const law_row rows[] = {
        {polynomial_force, polynomial_stiffness, polynomial_gradient},
        {law_spline_force, law_spline_stiffness, law_spline_gradient},
        {law_hyperelastic_force, law_hyperelastic_stiffness, law_hyperelastic_gradient}};
    return &rows[kind == PALP_LAW_POLYNOMIAL ? 0 : kind == PALP_LAW_SPLINE ? 1 : 2];
}

void law_kind_force(const palp_law *law, size_t n, const double *e, double *force_N, double *tangent_N,
                    double *energy_N) {
    row_of(law->kind)->force(law, n, e, force_N, tangent_N, energy_N);
}

void law_kind_stiffness(const palp_law *law, double a, double *stiffness, double *slope) {
    row_of(law->kind)->stiffness(law, a, stiffness, slope);
}

void law_kind_gradient(const palp_law *law, double a, double *dstiffness, double *dslope) {
    row_of(law->kind)->gradient(law, a, dstiffness, dslope);
}
