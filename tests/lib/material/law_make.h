/* law_make.h: stiffness laws of each kind. */
#ifndef LAW_MAKE_H
#define LAW_MAKE_H

#include <palpate/law.h>

#include <check.h>
#include <math.h>

#define CLOSE(got, want, tolerance) ck_assert_double_le(fabs((got) - (want)), (tolerance)*fabs(want))

/* Eq. 4.3, ascending */
static const double eq43[5] = {8.18, -0.70, 47.47, -131.36, 146.89};
static const double knots[6] = {0.0, 0.05, 0.15, 0.2, 0.3, 0.4};
static const double knot_stiffness[6] = {8.2, 8.1, 8.9, 9.4, 9.5, 11.0};

static inline palp_law polynomial43(void) {
    palp_law law;
    ck_assert_int_eq(palp_law_polynomial(5, eq43, &law), PALP_OK);
    return law;
}

static inline palp_law spline(void) {
    palp_law law;
    ck_assert_int_eq(palp_law_spline(6, knots, knot_stiffness, &law), PALP_OK);
    return law;
}

static inline palp_law hyperelastic(palp_law_kind kind, size_t n, const double *c) {
    palp_law law;
    ck_assert_int_eq(palp_law_hyperelastic(kind, n, c, 4.5e-4, &law), PALP_OK);
    return law;
}

enum { SAMPLE_LAWS = 10 };

/* One of each kind, with numbers of the size of soft tissue. */
static inline palp_law sample_law(int i) {
    static const double neo[1] = {3000.0}, mr2[2] = {2500.0, 700.0};
    static const double mr5[5] = {2500.0, 700.0, 1800.0, -400.0, 900.0}, yeoh[3] = {3000.0, 1200.0, 800.0};
    static const double ogden[6] = {5000.0, 2.0, -900.0, -3.3, 40.0, 9.4};
    static const double c8[8] = {1.0, -2.0, 30.0, -4.0, 5.0, -6.0, 7.0, 8.0}, c1[1] = {4.0};
    static const double steep_knots[4] = {0.0, 0.2, 0.22, 0.4}, steep[4] = {1.0, 2.0, 0.5, 0.6};
    palp_law law;
    switch (i) {
    case 0:
        return polynomial43();
    case 1:
        ck_assert_int_eq(palp_law_polynomial(8, c8, &law), PALP_OK);
        return law;
    case 2:
        ck_assert_int_eq(palp_law_polynomial(1, c1, &law), PALP_OK);
        return law;
    case 3:
        return spline();
    case 4: /* both end slopes at their cap */
        ck_assert_int_eq(palp_law_spline(4, steep_knots, steep, &law), PALP_OK);
        return law;
    case 5:
        return hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, neo);
    case 6:
        return hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, mr2);
    case 7:
        return hyperelastic(PALP_LAW_MOONEY_RIVLIN5, 5, mr5);
    case 8:
        return hyperelastic(PALP_LAW_YEOH, 3, yeoh);
    default:
        return hyperelastic(PALP_LAW_OGDEN, 6, ogden);
    }
}

static inline double force_at(const palp_law *law, double e) {
    double f;
    palp_law_force(law, 1, &e, &f, NULL, NULL);
    return f;
}

static inline double stiffness_at(const palp_law *law, double e) {
    double k;
    palp_law_stiffness(law, e, &k, NULL);
    return k;
}

static inline double energy_at(const palp_law *law, double e) {
    double f, w;
    palp_law_force(law, 1, &e, &f, NULL, &w);
    return w;
}

#endif
