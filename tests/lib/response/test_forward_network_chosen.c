/* test_forward_network_chosen.c: the force of a network at chosen samples against every sample, and its
 * derivatives against finite differences. check: once */
#include "response/forward_internal.h"
#include "forward_make.h"

#include <stdint.h>
#include <stdio.h>

/* A strength that changes the test's force and keeps away from kinks. */
static palp_effect *add_telling(palp_model *m, palp_effect_id id) {
    palp_effect *effect = add_effect(m, id, 1.07);
    if (id == PALP_EFFECT_RELAXATION_ARM || id == PALP_EFFECT_POWER_LAW_RELAXATION ||
        id == PALP_EFFECT_POROELASTIC)
        effect->value[0] = 0.04;
    if (id == PALP_EFFECT_FRAME_COMPLIANCE)
        effect->value[0] = 8e-4;
    if (id == PALP_EFFECT_FORCE_SATURATION)
        effect->value[0] = 1.03;
    if (id == PALP_EFFECT_SENSOR_LAG)
        effect->value[0] = 0.11;
    if (id == PALP_EFFECT_PLATE_SLIP)
        effect->value[0] = 0.3;
    return effect;
}

/* ---- derivatives ---- */

/* Solves every sample. */
static palp_status force_at_all(const palp_model *model, const palp_forward_run *run, double *force,
                                double *gradient, palp_error *error) {
    (void)gradient;
    return palp_forward_network(model, NULL, run, force, error);
}

static void check_gradient(const char *what, const palp_model *model, const samples *s, double share,
                           double tolerance) {
    check_slopes(what, forward_network_force, force_at_all, model, s, share, tolerance);
}

START_TEST(every_effect_has_derivatives) {
    static samples s;
    const palp_effect_id id = (palp_effect_id)_i;
    const palp_effect_info *info = palp_effect_look_up(id);
    palp_model on = lattice_model(2, 3), off = on;
    if (!info->in_network)
        return;
    all_phases(&s, 8);
    add_telling(&on, id);
    bool wave = id == PALP_EFFECT_MAINS_HUM || id == PALP_EFFECT_DRIVE_RIPPLE;
    check_gradient(info->id, &on, &s, wave ? 1e-6 : 1e-4, 2e-4);
    palp_effect *none = add_effect(&off, id, 0);
    if (id == PALP_EFFECT_ADHESION)
        none->value[1] = 0; /* on its reach the slope is that of a plate that has not let go */
    bool modes = info->id && (id == PALP_EFFECT_POWER_LAW_RELAXATION || id == PALP_EFFECT_POROELASTIC);
    if (id != PALP_EFFECT_FORCE_SATURATION && id != PALP_EFFECT_PLATE_SLIP)
        check_gradient(info->id, &off, &s, wave ? 1e-6 : modes ? 1e-2 : 1e-4, modes ? 3e-3 : 2e-4);
}
END_TEST

/* ---- chosen samples ---- */

/* Two presses with a hold, a withdrawal after which the plate comes back, and one after which it does not. */
static void two_presses(samples *s, double noise_m) {
    uint64_t state = 3;
    start(s, 0, -0.5);
    go(s, 1, -0.5, 20);
    go(s, 3.5, 5, 120);
    for (int i = 1; i <= 400; i++) /* evenly: go would grade a hold */
        s->time_s[s->n] = 3.5 + 0.05 * i, s->depth_m[s->n++] = 5e-3;
    go(s, 26, 0, 120);
    go(s, 28.5, 6, 120);
    go(s, 31.5, -1, 140);
    go(s, 33, -1, 30);
    for (size_t i = 0; i < s->n; i++) {
        state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        s->depth_m[i] += noise_m * sqrt(12) * ((double)(state >> 11) * 0x1p-53 - 0.5);
    }
}

START_TEST(chosen_samples_give_the_force_of_all) {
    static samples s;
    static double chosen[SAMPLES_MAX];
    const palp_effect_info *info = palp_effect_look_up((palp_effect_id)_i);
    palp_model m = lattice_model(2, 3);
    if (!info->in_network)
        return;
    add_telling(&m, (palp_effect_id)_i);
    two_presses(&s, 0);
    palp_forward_run run = run_of(&s);
    bool worn =
        _i == PALP_EFFECT_DAMAGE_SOFTENING || _i == PALP_EFFECT_PERMANENT_SET; /* bends at the old peaks */
    double peak = 0;
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, s.force_N, NULL), PALP_OK);
    ck_assert_int_eq(forward_network_force(&m, &run, chosen, NULL, NULL), PALP_OK);
    for (size_t i = 0; i < s.n; i++)
        peak = fmax(peak, s.force_N[i]);
    for (size_t i = 0; i < s.n; i++)
        ck_assert_msg(fabs(chosen[i] - s.force_N[i]) <= (worn ? 1e-3 : 3e-4) * peak,
                      "%s at %g s, %g mm: %.9g, not %.9g", info->id, s.time_s[i], 1e3 * s.depth_m[i],
                      chosen[i], s.force_N[i]);
}
END_TEST

/* An encoder's noise of a micrometre: the tangent takes it into the force. */
START_TEST(an_encoder_may_be_noisy) {
    static samples s;
    static double chosen[SAMPLES_MAX], straight[SAMPLES_MAX];
    palp_model m = lattice_model(2, 3);
    double off = 0, moved = 0, peak = 0;
    two_presses(&s, 0);
    palp_forward_run run = run_of(&s);
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, straight, NULL), PALP_OK);
    two_presses(&s, 1e-6);
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, s.force_N, NULL), PALP_OK);
    ck_assert_int_eq(forward_network_force(&m, &run, chosen, NULL, NULL), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        off += pow(chosen[i] - s.force_N[i], 2);
        moved += pow(straight[i] - s.force_N[i], 2);
        peak = fmax(peak, s.force_N[i]);
    }
    ck_assert_msg(off < 0.01 * moved, "rms %g of %g N", sqrt(off / (double)s.n), sqrt(moved / (double)s.n));
}
END_TEST

START_TEST(force_is_the_same_with_derivatives) {
    static samples s;
    static double plain[SAMPLES_MAX], with[SAMPLES_MAX], gradient[COLUMNS_MAX * SAMPLES_MAX];
    palp_model m = lattice_model(2, 3);
    add_telling(&m, PALP_EFFECT_POWER_LAW_RELAXATION);
    add_telling(&m, PALP_EFFECT_FRAME_COMPLIANCE);
    add_telling(&m, PALP_EFFECT_PLATE_SLIP);
    two_presses(&s, 1e-6);
    palp_forward_run run = run_of(&s);
    ck_assert_int_eq(forward_network_force(&m, &run, plain, NULL, NULL), PALP_OK);
    ck_assert_int_eq(forward_network_force(&m, &run, with, gradient, NULL), PALP_OK);
    ck_assert_mem_eq(plain, with, s.n * sizeof *plain);
}
END_TEST

START_TEST(what_has_no_derivatives_is_told) {
    static samples s;
    palp_model m = lattice_model(1, 3);
    palp_error error;
    all_phases(&s, 12);
    palp_forward_run run = run_of(&s);
    m.density_kg_m3 = 1000;
    ck_assert_int_eq(forward_network_force(&m, &run, s.force_N, NULL, &error), PALP_ERR_UNSUPPORTED);
    m.density_kg_m3 = 0;
    m.material.formulation = PALP_SEDEF2008;
    ck_assert_int_eq(forward_network_force(&m, &run, s.force_N, NULL, &error), PALP_ERR_UNSUPPORTED);
    m = lumped_model(1);
    ck_assert_int_eq(forward_network_force(&m, &run, s.force_N, NULL, &error), PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, every_effect_has_derivatives, 0, PALP_EFFECT_COUNT);
    tcase_add_loop_test(tc, chosen_samples_give_the_force_of_all, 0, PALP_EFFECT_COUNT);
    tcase_add_test(tc, an_encoder_may_be_noisy);
    tcase_add_test(tc, force_is_the_same_with_derivatives);
    tcase_add_test(tc, what_has_no_derivatives_is_told);
}
