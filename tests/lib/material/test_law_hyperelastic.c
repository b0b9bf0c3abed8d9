/* test_law_hyperelastic.c: hyperelastic stiffness laws against closed forms, tables and each other. */
#include "law_make.h"

/* Eq. 3.76 and 3.77 as they stand, for the stress MR5 gives at stretch 1 - a. */
static double mooney_rivlin5_stress(const double *c, double a) {
    double l = 1.0 - a;
    double a1 = l - 1.0 / (l * l), a2 = 1.0 - 1.0 / (l * l * l), a3 = l * l + 2.0 / l - 3.0;
    double a4 = 2.0 * l + 1.0 / (l * l) - 3.0;
    return -2.0 *
           (c[0] * a1 + c[1] * a2 + 2.0 * c[2] * a1 * a3 + c[3] * (a1 * a4 + a2 * a3) + 2.0 * c[4] * a2 * a4);
}

START_TEST(mooney_rivlin_is_eq376) {
    static const double c[5] = {2500.0, 700.0, 1800.0, -400.0, 900.0};
    static const double c2[5] = {2500.0, 700.0, 0.0, 0.0, 0.0};
    palp_law mr5 = hyperelastic(PALP_LAW_MOONEY_RIVLIN5, 5, c);
    palp_law mr2 = hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, c);
    for (double a = 0.1; a < 0.95; a += 0.05) {
        CLOSE(force_at(&mr5, a), 4.5e-4 * mooney_rivlin5_stress(c, a), 1e-12);
        CLOSE(force_at(&mr2, a), 4.5e-4 * mooney_rivlin5_stress(c2, a), 1e-12);
    }
}
END_TEST

/* Compares K, dK/da, force and energy of two laws that should be one, from the limit at 0 upwards. */
static void expect_same(const palp_law *a, const palp_law *b) {
    static const double at[] = {0.0,  1e-300, 1e-20, 1e-12, 1e-8, 1e-5, 1e-3, 0.01,
                                0.05, 0.1249, 0.13,  0.2,   0.35, 0.5,  0.8,  0.95};
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
        double ka, kb, sa, sb;
        palp_law_stiffness(a, at[i], &ka, &sa);
        palp_law_stiffness(b, at[i], &kb, &sb);
        CLOSE(ka, kb, 2e-14);
        CLOSE(sa, sb, 1e-12);
        CLOSE(energy_at(a, at[i]), energy_at(b, at[i]), 1e-13);
    }
}

START_TEST(hyperelastic_laws_coincide_where_they_should) {
    static const double mr5[5] = {2500.0, 700.0, 0.0, 0.0, 0.0}, neo[2] = {2500.0, 0.0};
    static const double reduced[5] = {2500.0, 0.0, 600.0, 0.0, 0.0}, yeoh[3] = {2500.0, 600.0, 0.0};
    static const double ogden[4] = {5000.0, 2.0, -1400.0, -2.0};
    palp_law l_neo = hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, neo), other;
    other = hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, neo);
    expect_same(&l_neo, &other);
    other = hyperelastic(PALP_LAW_YEOH, 1, neo);
    expect_same(&l_neo, &other);
    other = hyperelastic(PALP_LAW_OGDEN, 2, ogden);
    expect_same(&l_neo, &other);
    palp_law l_mr5 = hyperelastic(PALP_LAW_MOONEY_RIVLIN5, 5, mr5);
    other = hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, mr5);
    expect_same(&l_mr5, &other);
    other = hyperelastic(PALP_LAW_OGDEN, 4, ogden);
    expect_same(&l_mr5, &other);
    palp_law l_yeoh = hyperelastic(PALP_LAW_YEOH, 3, yeoh);
    other = hyperelastic(PALP_LAW_MOONEY_RIVLIN5, 5, reduced);
    expect_same(&l_yeoh, &other);
}
END_TEST

/* alpha, a, and W, K, dK/da of W = (s^alpha + 2 s^(-alpha/2) - 3) / alpha per area, from 60-digit
 * arithmetic. */
static const double ogden_table[][5] = {
    {3.7, 1e-9, 2.77500000106375e-18, 5.55000000319125, 3.191250018809875},
    {3.7, 0.0123, 0.0004218638069299776, 5.5906998747094059, 3.4286521571749498},
    {3.7, 0.13, 0.050019456533830828, 6.1585034779531379, 6.493736248649014},
    {3.7, 0.55, 1.5712905097778304, 17.489812934113225, 81.565674740805851},
    {-5.3, 1e-9, -3.97500000748625e-18, -7.9500000224587501, -22.458750127113875},
    {-5.3, 0.0123, -0.00061568085568641763, -8.2361405047524521, -24.091710824736098},
    {-5.3, 0.13, -0.08957042101595416, -12.383194151546319, -50.277398737098297},
    {-5.3, 0.55, -12.4720887291802, -277.73959000653789, -3391.9750513774918},
    {0.25, 1e-9, 1.875000001796875e-19, 0.3750000005390625, 0.53906250128710938},
    {0.25, 0.0123, 2.8704973065222317e-5, 0.38172919017694657, 0.55522666505794244},
    {0.25, 0.13, 0.0036155342345845252, 0.45779474647673794, 0.75116776359840237},
    {0.25, 0.55, 0.1158632829293887, 1.1552667561498729, 3.5453797203133646},
};

START_TEST(ogden_meets_high_precision_values) {
    const double *row = ogden_table[_i], c[2] = {1.0, row[0]};
    palp_law law;
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 2, c, 1.0, &law), PALP_OK);
    double k, slope;
    palp_law_stiffness(&law, row[1], &k, &slope);
    CLOSE(energy_at(&law, row[1]), row[2], 1e-13);
    CLOSE(k, row[3], 1e-13);
    CLOSE(slope, row[4], 1e-12);
}
END_TEST

/* Initial stiffness = Young's modulus times area: 6 (C10 + C01), 3/2 sum mu alpha. */
START_TEST(initial_stiffness_is_youngs_modulus) {
    static const double mr2[2] = {2500.0, 700.0}, yeoh[2] = {2500.0, 900.0};
    static const double ogden[4] = {300.0, 3.0, -50.0, -4.0};
    palp_law law = hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, mr2);
    CLOSE(stiffness_at(&law, 0.0), 4.5e-4 * 6.0 * 3200.0, 1e-15);
    law = hyperelastic(PALP_LAW_YEOH, 2, yeoh);
    CLOSE(stiffness_at(&law, 0.0), 4.5e-4 * 6.0 * 2500.0, 1e-15);
    law = hyperelastic(PALP_LAW_OGDEN, 4, ogden);
    CLOSE(stiffness_at(&law, 0.0), 4.5e-4 * 1.5 * (900.0 + 200.0), 1e-15);
    /* alpha = 1: F = mu A (s^(-3/2) - 1), 0.953125 at s = 0.64 */
    static const double one[2] = {1000.0, 1.0};
    law = hyperelastic(PALP_LAW_OGDEN, 2, one);
    CLOSE(force_at(&law, 0.36), 4.5e-4 * 1000.0 * 0.953125, 1e-14);
}
END_TEST

START_TEST(crushed_hyperelastic_is_infinite) {
    for (int i = 5; i < SAMPLE_LAWS; i++) {
        palp_law law = sample_law(i);
        double e[2] = {1.0, -1.5}, f[2], t[2], w[2];
        palp_law_force(&law, 2, e, f, t, w);
        ck_assert(f[0] == INFINITY && f[1] == -INFINITY);
        ck_assert(t[0] == INFINITY && t[1] == INFINITY);
        ck_assert(w[0] == INFINITY && w[1] == INFINITY);
    }
}
END_TEST

START_TEST(bad_hyperelastic_laws_are_refused) {
    static const double c[6] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, zero[2] = {1.0, 0.0}, nan_c[1] = {NAN};
    palp_law law;
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 2, c, 1.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, nan_c, 1.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, c, 0.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, c, NAN, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 3, c, 1.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN5, 4, c, 1.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 3, c, 1.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 2, zero, 1.0, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_POLYNOMIAL, 1, c, 1.0, &law), PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, mooney_rivlin_is_eq376);
    tcase_add_test(tc, hyperelastic_laws_coincide_where_they_should);
    tcase_add_loop_test(tc, ogden_meets_high_precision_values, 0, sizeof ogden_table / sizeof ogden_table[0]);
    tcase_add_test(tc, initial_stiffness_is_youngs_modulus);
    tcase_add_test(tc, crushed_hyperelastic_is_infinite);
    tcase_add_test(tc, bad_hyperelastic_laws_are_refused);
}
