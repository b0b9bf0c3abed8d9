/* test_forward_gradient.c: derivatives of the forward model by every parameter against finite differences. */
#include "forward_make.h"

#include <math.h>
#include <stdio.h>

static void check_gradient(const char *what, const palp_model *model, const samples *s, double share,
                           double tolerance) {
    check_slopes(what, palp_forward_force, palp_forward_force, model, s, share, tolerance);
}

/* A strength that changes the test's force and keeps away from kinks. */
static palp_effect *add_telling(palp_model *m, palp_effect_id id) {
    palp_effect *effect = add_effect(m, id, 1.07);
    if (id == PALP_EFFECT_FRAME_COMPLIANCE)
        effect->value[0] = 8e-4;
    if (id == PALP_EFFECT_FORCE_SATURATION)
        effect->value[0] = 1.03;
    if (id == PALP_EFFECT_SENSOR_LAG)
        effect->value[0] = 0.11;
    return effect;
}

START_TEST(plain_materials) {
    static samples s;
    double strain[4] = {0, 0.07, 0.16, 0.3}, stiffness[4] = {8, 8.4, 9.6, 11}, yeoh[2] = {4000, 2500},
           ogden[4] = {3000, 2.5, 900, -3};
    palp_model m[5] = {lumped_model(3), lumped_model(2), lumped_model(2), lumped_model(1), lumped_model(2)};
    all_phases(&s, 12);
    ck_assert_int_eq(palp_law_spline(4, strain, stiffness, &m[1].material.law), PALP_OK);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_YEOH, 2, yeoh, 4.5e-4, &m[2].material.law), PALP_OK);
    m[2].material.dashpot_Ns = 0.3;
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 4, ogden, 4.5e-4, &m[3].material.law), PALP_OK);
    m[3].material.arms[0].beta = 2;
    m[3].material.arms[0].gamma = -0.5;
    m[4].material.quasi_linear = true;
    for (int i = 0; i < 5; i++) {
        char what[32];
        snprintf(what, sizeof what, "plain material %d", i);
        check_gradient(what, &m[i], &s, 1e-4, 1e-6);
    }
}
END_TEST

/* Where a strength at zero ends the model, there is no derivative. */
static bool has_slope_at_zero(int id) {
    return id != PALP_EFFECT_FORCE_SATURATION;
}

START_TEST(every_effect_alone) {
    static samples s;
    const palp_effect_info *info = palp_effect_look_up((palp_effect_id)_i);
    palp_model on = lumped_model(2), off = on;
    if (!info->in_lumped)
        return;
    all_phases(&s, 12);
    add_telling(&on, (palp_effect_id)_i);
    bool wave = _i == PALP_EFFECT_MAINS_HUM || _i == PALP_EFFECT_DRIVE_RIPPLE;
    check_gradient(info->id, &on, &s, wave ? 1e-6 : 1e-4, 2e-6);
    palp_effect *none = add_effect(&off, (palp_effect_id)_i, 0);
    if (_i == PALP_EFFECT_ADHESION)
        none->value[1] = 0; /* on its reach the slope is that of a plate that has not let go */
    /* modes that come to be refine the steps of recovery */
    bool modes = _i == PALP_EFFECT_POWER_LAW_RELAXATION || _i == PALP_EFFECT_POROELASTIC;
    if (has_slope_at_zero(_i))
        check_gradient(info->id, &off, &s, wave ? 1e-6 : modes ? 1e-2 : 1e-4, modes ? 2e-4 : 2e-6);
}
END_TEST

START_TEST(effects_together) {
    static const palp_effect_id sets[][5] = {
        {PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_POWER_LAW_RELAXATION, PALP_EFFECT_SENSOR_LAG,
         PALP_EFFECT_TOE_REGION, PALP_EFFECT_SESSION_AGEING},
        {PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_PERMANENT_SET,
         PALP_EFFECT_ADHESION, PALP_EFFECT_SENSOR_GAIN},
        {PALP_EFFECT_CONTACT_OFFSET, PALP_EFFECT_POROELASTIC, PALP_EFFECT_STRAIN_DEPENDENT_ARM,
         PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_RELAXATION_ARM},
        {PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_RATE_STIFFENING, PALP_EFFECT_POROELASTIC,
         PALP_EFFECT_COULOMB_FRICTION, PALP_EFFECT_POWER_LAW_RELAXATION}};
    static samples s;
    char what[16];
    palp_model m = lumped_model(2);
    all_phases(&s, 12);
    for (size_t k = 0; k < 5; k++)
        add_telling(&m, sets[_i][k]);
    snprintf(what, sizeof what, "set %d", _i);
    check_gradient(what, &m, &s, 1e-4, 5e-6);
}
END_TEST

/* Damage needs the energy's derivative by the coefficients of each kind of law. */
START_TEST(damage_of_other_laws) {
    static samples s;
    double strain[4] = {0, 0.07, 0.16, 0.3}, stiffness[4] = {8, 8.4, 9.6, 11},
           ogden[4] = {3000, 2.5, 900, -3};
    palp_model m = lumped_model(1);
    all_phases(&s, 12);
    add_telling(&m, PALP_EFFECT_DAMAGE_SOFTENING);
    ck_assert_int_eq(palp_law_spline(4, strain, stiffness, &m.material.law), PALP_OK);
    check_gradient("damage of a spline", &m, &s, 1e-4, 2e-6);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 4, ogden, 4.5e-4, &m.material.law), PALP_OK);
    check_gradient("damage of Ogden's", &m, &s, 1e-4, 2e-6);
}
END_TEST

/* Of the free terms only the factors on the force have to do with the derivatives. */
START_TEST(gains_by_the_place_and_the_time) {
    static samples s;
    palp_model m = lumped_model(2);
    all_phases(&s, 12);
    add_telling(&m, PALP_EFFECT_FRAME_COMPLIANCE);
    static const palp_free_kind kind[] = {PALP_FREE_SPEED, PALP_FREE_GAIN, PALP_FREE_AGEING};
    m.n_free = sizeof kind / sizeof *kind;
    for (size_t i = 0; i < m.n_free; i++) {
        m.free_term[i] =
            (palp_free_term){.kind = kind[i], .to = i == 1 ? 6e-3 : 5, .depth_m = 6e-3, .slow_m_s = 1e-3};
        m.free_term[i].plate_N = i ? 2.5 : 0;
        for (int a = 0; a < PALP_FREE_NODES; a++)
            m.free_term[i].force_N[a] = 0.8 * sin(0.5 * a + (double)i);
    }
    check_gradient("gains by the place and the time", &m, &s, 1e-4, 2e-6);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, plain_materials);
    tcase_add_loop_test(tc, every_effect_alone, 0, PALP_EFFECT_COUNT);
    tcase_add_loop_test(tc, effects_together, 0, 4);
    tcase_add_test(tc, damage_of_other_laws);
    tcase_add_test(tc, gains_by_the_place_and_the_time);
}
