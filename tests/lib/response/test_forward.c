/* test_forward.c: the forward model against palp_lumped_run, closed forms and calculations by hand. */
#include "forward_ramp.h"

static double strain(size_t i) {
    return s.depth_m[i] / HEIGHT;
}

static double law_force(const palp_model *m, double e) {
    double force;
    palp_law_force(&m->material.law, 1, &e, &force, NULL, NULL);
    return force;
}

/* ---- the plain model ---- */

START_TEST(without_effects_it_is_the_lumped_run_to_the_bit) {
    static double wanted[SAMPLES_MAX];
    palp_model m = lumped_model(3);
    double knots[3] = {0, 0.1, 0.4}, stiffness[3] = {6, 7, 11};
    if (_i == 1)
        m.material.quasi_linear = true;
    if (_i == 2)
        m.material.arms[0].beta = m.material.arms[1].gamma = 1.5;
    if (_i == 3)
        m.material.dashpot_Ns = 0.4;
    if (_i == 4)
        ck_assert_int_eq(palp_law_spline(3, knots, stiffness, &m.material.law), PALP_OK);
    start(&s, 3.7, _i < 3 ? 1.3 : 0); /* there at once, or from contact */
    go(&s, 5.1, 4.7, 37);
    go(&s, 9, 4.7, 29);
    go(&s, 10.3, 6.1, 17);
    go(&s, 40, 6.1, 23);
    press_model(&m, &s);
    ck_assert_int_eq(palp_lumped_run(&m.material, m.height_m, s.n, s.time_s, s.depth_m, wanted), PALP_OK);
    ck_assert_mem_eq(s.force_N, wanted, s.n * sizeof *wanted);
}
END_TEST

START_TEST(effects_at_zero_strength_change_no_bit) {
    static double plain[SAMPLES_MAX];
    palp_model m = lumped_model(2);
    const palp_effect_info *info = palp_effect_look_up((palp_effect_id)_i);
    if (!info->in_lumped)
        return;
    all_phases(&s, 40);
    press_model(&m, &s);
    memcpy(plain, s.force_N, sizeof plain);
    add_effect(&m, (palp_effect_id)_i, 0);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        ck_assert_msg(s.force_N[i] == plain[i], "%s at %g s", info->id, s.time_s[i]);
    m.effects[0] = (palp_effect){0};
    m.n_effects = 0;
    add_effect(&m, (palp_effect_id)_i, _i == PALP_EFFECT_FORCE_SATURATION ? 0.1 : 1);
    press_model(&m, &s);
    ck_assert_msg(memcmp(s.force_N, plain, s.n * sizeof *plain) != 0, "%s does nothing", info->id);
}
END_TEST

START_TEST(arms_of_effects_are_arms) {
    static double wanted[SAMPLES_MAX];
    palp_model m = lumped_model(2), extra = lumped_model(3);
    palp_effect *arm = add_effect(&m, PALP_EFFECT_RELAXATION_ARM, 1);
    arm->value[0] = 0.5;
    arm->value[1] = 120;
    all_phases(&s, 40);
    press_model(&extra, &s);
    memcpy(wanted, s.force_N, sizeof wanted);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        EXPECT(i, wanted[i], 1e-13);
    m = lumped_model(2);
    palp_effect *dependent = add_effect(&m, PALP_EFFECT_STRAIN_DEPENDENT_ARM, 1);
    dependent->value[0] = 2;
    dependent->value[1] = 3;
    extra = lumped_model(2);
    for (size_t j = 0; j < 2; j++) {
        extra.material.arms[j].beta = 2;
        extra.material.arms[j].gamma = 3;
    }
    press_model(&extra, &s);
    memcpy(wanted, s.force_N, sizeof wanted);
    press_model(&m, &s);
    ck_assert_mem_eq(s.force_N, wanted, s.n * sizeof *wanted);
}
END_TEST

/* ---- the material ---- */

START_TEST(springpot_on_a_ramp) {
    for (double a = 0.1; a < 0.9; a += 0.3) {
        palp_model m = linear_model(2);
        palp_effect *pot = add_effect(&m, PALP_EFFECT_POWER_LAW_RELAXATION, 1);
        pot->value[0] = 3;
        pot->value[1] = a;
        ramp(0.06, 100, 300);
        press_model(&m, &s);
        for (size_t i = 1; i < s.n; i++) {
            double rate = 6e-5 / HEIGHT, pull = 3 * rate * pow(s.time_s[i], 1 - a) / tgamma(2 - a);
            EXPECT(i, 2 * strain(i) + pull, 1e-4 * pull);
        }
    }
}
END_TEST

START_TEST(consolidation_on_a_ramp) {
    palp_model m = linear_model(2);
    palp_effect *pores = add_effect(&m, PALP_EFFECT_POROELASTIC, 1);
    pores->value[0] = 3;
    pores->value[1] = 40;
    ramp(0.06, 100, 300);
    press_model(&m, &s);
    for (size_t i = 1; i < s.n; i += 7) {
        double pull = 0;
        for (double k = 1; k < 2001; k += 2)
            pull += 3 * 8 / (PI * PI) / (k * k) * 6e-5 / HEIGHT * -expm1(-k * k * s.time_s[i] / 40) /
                    (k * k / 40);
        EXPECT(i, 2 * strain(i) + pull, 1e-4 * pull);
    }
}
END_TEST

START_TEST(faster_is_stiffer_while_it_moves) {
    palp_model m = lumped_model(0);
    add_effect(&m, PALP_EFFECT_RATE_STIFFENING, 1)->value[0] = 0.3;
    start(&s, 0, 0);
    go(&s, 2, 6, 50);
    go(&s, 3, 6, 5);
    press_model(&m, &s);
    double factor = 1 + 0.3 * log10(1 + 3e-3 / HEIGHT / 0.01);
    for (size_t i = 1; i < s.n; i++)
        if (i != 50) /* the corner itself has a speed in between */
            EXPECT(i, law_force(&m, strain(i)) * (i < 50 ? factor : 1), 1e-12);
    ck_assert(s.force_N[50] < factor * law_force(&m, strain(50)) &&
              s.force_N[50] > law_force(&m, strain(50)));
}
END_TEST

static double law_energy(const palp_model *m, double e) {
    double force, energy;
    palp_law_force(&m->material.law, 1, &e, &force, NULL, &energy);
    return energy;
}

START_TEST(damage_is_ogden_and_roxburghs) {
    palp_model m = lumped_model(0);
    palp_effect *damage = add_effect(&m, PALP_EFFECT_DAMAGE_SOFTENING, 1);
    damage->value[0] = 0.4;
    damage->value[1] = 0.7;
    start(&s, 0, 0);
    go(&s, 1, 5, 20);
    go(&s, 2, 1, 20);
    go(&s, 3, 6, 20);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        double deepest = s.time_s[i] <= 1 ? strain(i) : fmax(5e-3 / HEIGHT, strain(i));
        double most = law_energy(&m, deepest), part = most > 0 ? law_energy(&m, strain(i)) / most : 1;
        EXPECT(i, law_force(&m, strain(i)) * (1 - 0.4 * erf((1 - part) / 0.7)), 1e-13);
    }
}
END_TEST

START_TEST(set_leaves_no_force_at_its_strain) {
    palp_model m = lumped_model(0);
    add_effect(&m, PALP_EFFECT_PERMANENT_SET, 1)->value[0] = 0.25;
    start(&s, 0, 0);
    go(&s, 1, 4.8, 20);
    go(&s, 2, 0, 16);
    go(&s, 3, 6, 20);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        double deepest = s.time_s[i] <= 1 ? strain(i) : fmax(0.2, strain(i));
        double seen = fmax(0, (strain(i) - 0.25 * deepest) / 0.75);
        EXPECT(i, law_force(&m, seen), 1e-12);
        if (s.time_s[i] > 1 && s.time_s[i] < 3 && strain(i) < 0.05)
            ck_assert_double_eq(s.force_N[i], 0);
    }
}
END_TEST

/* ---- the contact ---- */

START_TEST(offset_toe_and_ageing) {
    palp_model m = lumped_model(0);
    add_effect(&m, PALP_EFFECT_CONTACT_OFFSET, 1)->value[0] = 0.53e-3;
    add_effect(&m, PALP_EFFECT_TOE_REGION, 1)->value[0] = 0.4e-3;
    add_effect(&m, PALP_EFFECT_SESSION_AGEING, 1)->value[0] = -0.12 / 3600;
    ramp(2, 2, 50);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        double d = fmax(0, s.depth_m[i] - 0.53e-3), seen = d - 0.4e-3 * (1 - exp(-d / 0.4e-3));
        EXPECT(i, law_force(&m, seen / HEIGHT) * (1 - 0.12 * 5000 / 3600), 1e-13);
    }
}
END_TEST

START_TEST(adhesion_pulls_and_lets_go) {
    palp_model m = linear_model(12);
    *add_effect(&m, PALP_EFFECT_ADHESION, 1) =
        (palp_effect){PALP_EFFECT_ADHESION, {0.3}}; /* at -0.025, -0.6 mm */
    start(&s, 0, -1);
    go(&s, 1, 2, 31);
    go(&s, 2, -2, 41);
    go(&s, 3, 1, 31);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        bool stuck = strain(i) > 0 || (s.time_s[i] > 1 && s.time_s[i] < 2 && strain(i) > -0.025);
        EXPECT(i, stuck ? 12 * strain(i) : 0, 1e-14);
    }
}
END_TEST

/* A standard linear solid pressed at once, let go of on the way up, left alone and met again. */
START_TEST(surface_recovers_and_is_met_again) {
    const double spring = 6, arm = 4, tau = 2, up = 0.05, back = 0.03, pause = 3; /* N, s, strain per s */
    palp_model m = linear_model(spring);
    m.material.n_arms = 1;
    m.material.arms[0] = (palp_arm){.stiffness_N = arm, .viscosity_Ns = arm * tau};
    start(&s, 0, 1e3 * HEIGHT * 0.2);
    go(&s, 5, 1e3 * HEIGHT * 0.2, 30);
    double q = arm * 0.2 * exp(-5 / tau), low = 0, high = 0.2 / up;
    for (int i = 0; i < 100; i++) { /* when the force is zero on the way up */
        double t = 0.5 * (low + high), pull = (q + arm * up * tau) * exp(-t / tau) - arm * up * tau;
        *(spring * (0.2 - up * t) + pull > 0 ? &low : &high) = t;
    }
    double left = 5 + low, at = 0.2 - up * low;
    go(&s, 9, 0, 23);
    go(&s, 9 + pause, 0, 6);
    go(&s, 9 + pause + 5, 1e3 * HEIGHT * back * 5, 37);
    low = 0, high = 5;
    double slow = spring / (tau * (spring + arm));
    for (int i = 0; i < 100; i++) { /* when the plate is back at the surface */
        double t = 0.5 * (low + high);
        *(back * t < at * exp(-slow * (9 + pause + t - left)) ? &low : &high) = t;
    }
    double met = 9 + pause + low, start_q = -spring * back * low;
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        double t = s.time_s[i] - met;
        if (s.time_s[i] > left && t <= 0)
            ck_assert_double_eq(s.force_N[i], 0);
        if (t > 0) {
            double wanted =
                (start_q - arm * back * tau) * exp(-t / tau) + arm * back * tau + spring * strain(i);
            EXPECT(i, wanted, 5e-5 * spring * at);
        }
    }
}
END_TEST

/* ---- coarse grids ---- */

/* Every effect on a grid of some 200 samples is near what it is on sixteen times as many. */
START_TEST(coarse_grids_tell_the_same) {
    static samples fine;
    const palp_effect_info *info = palp_effect_look_up((palp_effect_id)_i);
    bool by_speed = _i == PALP_EFFECT_COULOMB_FRICTION || _i == PALP_EFFECT_RATE_STIFFENING;
    if (!info->in_lumped ||
        _i == PALP_EFFECT_PLATE_INERTIA) /* inertia: of corners, as wide as the grid there */
        return;
    palp_model m = lumped_model(2);
    palp_effect *effect = add_effect(&m, (palp_effect_id)_i, 1);
    if (_i == PALP_EFFECT_FRAME_COMPLIANCE)
        effect->value[0] = 3e-4;
    all_phases(&s, 25);
    all_phases(&fine, 400);
    press_model(&m, &s);
    press_model(&m, &fine);
    double tolerance = _i == PALP_EFFECT_SENSOR_LAG ? 1e-2 : 1e-4; /* lag: of the one sample after contact */
    for (size_t i = 0; i < s.n; i++) {
        ck_assert_double_eq_tol(s.time_s[i], fine.time_s[16 * i], 1e-9);
        if (by_speed && i % 25 == 0)
            continue; /* a corner has no speed */
        EXPECT(i, fine.force_N[16 * i], tolerance);
    }
}
END_TEST

/* ---- parameters and errors ---- */

START_TEST(parameters_go_round) {
    double got[COLUMNS_MAX], moved[COLUMNS_MAX];
    palp_model m = lumped_model(2);
    add_effect(&m, PALP_EFFECT_POROELASTIC, 1);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1);
    ck_assert_uint_eq(palp_forward_parameter_count(&m), 5 + 4 + 2 + 1);
    ck_assert_int_eq(palp_forward_get(&m, got), PALP_OK);
    ck_assert(got[0] == 8.18 && got[5] == 1.3 && got[8] == 0.4 && got[9] == 1 && got[10] == 10 &&
              got[11] == 1e-5);
    for (size_t k = 0; k < 12; k++)
        got[k] *= 1.25;
    ck_assert_int_eq(palp_forward_set(&m, got), PALP_OK);
    ck_assert_int_eq(palp_forward_get(&m, moved), PALP_OK);
    ck_assert_mem_eq(got, moved, 12 * sizeof *got);
    got[11] = -1;
    ck_assert_int_eq(palp_forward_set(&m, got), PALP_ERR_ARGUMENT);
    got[11] = 0;
    got[6] = 0;
    ck_assert_int_eq(palp_forward_set(&m, got), PALP_ERR_ARGUMENT);
    got[6] = NAN;
    ck_assert_int_eq(palp_forward_set(&m, got), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_forward_get(&m, got), PALP_OK);
    ck_assert_mem_eq(got, moved, 12 * sizeof *got);
}
END_TEST

static void fails(const palp_model *m, palp_status status, const char *text) {
    palp_forward_run run = run_of(&s);
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(palp_forward_force(m, &run, s.force_N, NULL, &error), status);
    ck_assert_msg(strstr(error.text, text) != NULL, "\"%s\" lacks \"%s\"", error.text, text);
}

START_TEST(what_cannot_be_run_is_told) {
    palp_model m = lumped_model(2);
    ramp(1, 2, 5);
    add_effect(&m, PALP_EFFECT_PLATE_SLIP, 1);
    fails(&m, PALP_ERR_UNSUPPORTED, "plate_slip is not an effect of a lumped model");
    m.n_effects = 0;
    add_effect(&m, PALP_EFFECT_SENSOR_LAG, 1);
    add_effect(&m, PALP_EFFECT_SENSOR_LAG, 1);
    fails(&m, PALP_ERR_ARGUMENT, "sensor_lag is given twice");
    m.n_effects = 1;
    m.effects[0].value[0] = -1;
    fails(&m, PALP_ERR_ARGUMENT, "sensor_lag: time_s must be between");
    m.n_effects = 0;
    m.kind = PALP_MODEL_NETWORK;
    fails(&m, PALP_ERR_UNSUPPORTED, "palp_forward_network");
    m.kind = PALP_MODEL_LUMPED;
    m.material.n_arms = 1;
    m.material.formulation = PALP_SEDEF2008;
    fails(&m, PALP_ERR_UNSUPPORTED, "sedef2008");
    m = lumped_model(2);
    add_effect(&m, PALP_EFFECT_SESSION_AGEING, 1)->value[0] = -0.9 / 3600;
    fails(&m, PALP_ERR_ARGUMENT, "session_ageing leaves no force");
    m.n_effects = 0;
    m.material.n_arms = PALP_ARMS_MAX;
    for (size_t j = 0; j < PALP_ARMS_MAX; j++)
        m.material.arms[j] = (palp_arm){.stiffness_N = 1, .viscosity_Ns = 1};
    add_effect(&m, PALP_EFFECT_RELAXATION_ARM, 1);
    fails(&m, PALP_ERR_LIMIT, "relaxation_arm: the model already has");
    m = lumped_model(2);
    s.time_s[3] = s.time_s[2];
    fails(&m, PALP_ERR_ARGUMENT, "sample 3: times must increase");
    ramp(1, 2, 5);
    s.depth_m[4] = NAN;
    fails(&m, PALP_ERR_ARGUMENT, "sample 4");
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, without_effects_it_is_the_lumped_run_to_the_bit, 0, 5);
    tcase_add_loop_test(tc, effects_at_zero_strength_change_no_bit, 0, PALP_EFFECT_COUNT);
    tcase_add_test(tc, arms_of_effects_are_arms);
    tcase_add_test(tc, springpot_on_a_ramp);
    tcase_add_test(tc, consolidation_on_a_ramp);
    tcase_add_test(tc, faster_is_stiffer_while_it_moves);
    tcase_add_test(tc, damage_is_ogden_and_roxburghs);
    tcase_add_test(tc, set_leaves_no_force_at_its_strain);
    tcase_add_test(tc, offset_toe_and_ageing);
    tcase_add_test(tc, adhesion_pulls_and_lets_go);
    tcase_add_test(tc, surface_recovers_and_is_met_again);
    tcase_add_loop_test(tc, coarse_grids_tell_the_same, 0, PALP_EFFECT_COUNT);
    tcase_add_test(tc, parameters_go_round);
    tcase_add_test(tc, what_cannot_be_run_is_told);
}
