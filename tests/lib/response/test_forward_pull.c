/* test_forward_pull.c: a plate that pulls a surface on a bond with a reach, against formulas of its own: a
 * spring behind a traction of Xu and Needleman, read by its parameter, the gap. */
#include "forward_ramp.h"

/* The traction at a gap, both in terms of the strongest and the reach. */
static double traction(double x) {
    return x * exp(1 - x);
}

/* Where the plate is when a spring of k N/m hangs on the bond at gap x. */
static double plate_at(double force, double reach, double k, double x) {
    return -force * traction(x) / k - reach * x;
}

/* Force of a spring that the plate at depth < 0 pulls, on the way from contact: the first gap that belongs to
 * the depth; 0 where the plate has let go. */
static double pulled(double force, double reach, double k, double depth) {
    double step = 1e-4, x = 0;
    while (x < 40 && plate_at(force, reach, k, x + step) > depth) {
        if (plate_at(force, reach, k, x + step) > plate_at(force, reach, k, x))
            return 0; /* the plate cannot go back: it jumps */
        x += step;
    }
    if (x >= 40)
        return 0;
    double low = x, high = x + step;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        *(plate_at(force, reach, k, middle) > depth ? &low : &high) = middle;
    }
    return -force * traction(low);
}

static void withdraw(void) {
    start(&s, 0, -1);
    go(&s, 1, 2, 31);
    go(&s, 2, -2.013, 401);
}

/* A reach so short for this spring that it jumps, and one so long that it does not. */
START_TEST(a_spring_is_pulled_and_let_go) {
    static const double reach[] = {2e-5, 1e-4, 4e-4, 1e-3};
    const double stiffness = 12, k = stiffness / HEIGHT, force = 0.2;
    palp_model m = linear_model(stiffness);
    *add_effect(&m, PALP_EFFECT_ADHESION, 1) = (palp_effect){PALP_EFFECT_ADHESION, {force, reach[_i]}};
    withdraw();
    press_model(&m, &s);
    double most = 0;
    for (size_t i = 0; i < s.n; i++) {
        double depth = s.depth_m[i], wanted = depth > 0         ? k * depth
                                              : s.time_s[i] > 1 ? pulled(force, reach[_i], k, depth)
                                                                : 0;
        ck_assert_msg(fabs(s.force_N[i] - wanted) <= 1e-7, "reach %g, depth %g: %g, not %g", reach[_i], depth,
                      s.force_N[i], wanted);
        most = fmax(most, -s.force_N[i]);
    }
    ck_assert_double_lt(fabs(most - force), 0.02 * force);
}
END_TEST

START_TEST(the_plate_comes_back_before_it_has_let_go) {
    const double stiffness = 12, k = stiffness / HEIGHT, force = 0.2, reach = 1e-3;
    palp_model m = linear_model(stiffness);
    *add_effect(&m, PALP_EFFECT_ADHESION, 1) = (palp_effect){PALP_EFFECT_ADHESION, {force, reach}};
    start(&s, 0, 2);
    go(&s, 1, -1.2, 201);
    go(&s, 2, 1, 137);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        double depth = s.depth_m[i], wanted = depth > 0 ? k * depth : pulled(force, reach, k, depth);
        ck_assert_double_le(fabs(s.force_N[i] - wanted), 1e-7);
    }
}
END_TEST

/* A surface that recovers meets the plate again in the step in which it let go, and is let go of again: the
 * step ends all the same. */
START_TEST(a_weak_bond_lets_go_in_a_long_step) {
    const double force = 1e-3;
    palp_model m = lumped_model(2);
    *add_effect(&m, PALP_EFFECT_ADHESION, 1) = (palp_effect){PALP_EFFECT_ADHESION, {force, 1e-6}};
    start(&s, 0, -1);
    go(&s, 0.5, -0.3, 20);
    go(&s, 2, 5, 20);
    go(&s, 4, 5, 20);
    go(&s, 6, -1, 20);
    go(&s, 7, 4, 20);
    go(&s, 7.2, -1, 20);
    go(&s, 9, -1, 20);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        ck_assert_double_ge(s.force_N[i], -1.01 * force);
    ck_assert(s.force_N[s.n - 1] == 0);
}
END_TEST

START_TEST(a_short_reach_is_nearly_none) {
    static double sudden[SAMPLES_MAX];
    palp_model m = lumped_model(2);
    palp_effect *effect = add_effect(&m, PALP_EFFECT_ADHESION, 1);
    *effect = (palp_effect){PALP_EFFECT_ADHESION, {0.1, 0}};
    withdraw();
    press_model(&m, &s);
    memcpy(sudden, s.force_N, sizeof sudden);
    effect->value[1] = 1e-8;
    press_model(&m, &s);
    size_t apart = 0;
    for (size_t i = 0; i < s.n; i++)
        apart += fabs(s.force_N[i] - sudden[i]) > 1e-4;
    ck_assert_uint_le(apart, 1); /* the sample at which it lets go */
}
END_TEST

/* Neither a sample at contact nor one near where it lets go. */
START_TEST(derivatives_are_exact) {
    static const palp_effect_id beside[] = {PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_PERMANENT_SET,
                                            PALP_EFFECT_SESSION_AGEING, PALP_EFFECT_TOE_REGION,
                                            PALP_EFFECT_SENSOR_LAG};
    palp_model m = lumped_model(2);
    all_phases(&s, 17);
    *add_effect(&m, PALP_EFFECT_ADHESION, 1) = (palp_effect){PALP_EFFECT_ADHESION, {0.11, 6e-4}};
    if (_i > 0)
        add_effect(&m, beside[_i - 1], _i == 1 ? 0.5 : 1.07);
    check_slopes("pulled", palp_forward_force, palp_forward_force, &m, &s, 1e-4, 5e-6);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_spring_is_pulled_and_let_go, 0, 4);
    tcase_add_test(tc, the_plate_comes_back_before_it_has_let_go);
    tcase_add_test(tc, a_weak_bond_lets_go_in_a_long_step);
    tcase_add_test(tc, a_short_reach_is_nearly_none);
    tcase_add_loop_test(tc, derivatives_are_exact, 0, 6);
}
