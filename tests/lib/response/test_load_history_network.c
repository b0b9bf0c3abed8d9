/* test_load_history_network.c: damage and permanent set of a network's elements from run to run: two presses
 * in one recording, or in two; their derivatives. */
#include "response/forward_internal.h"
#include "forward_make.h"

static palp_model network_model(size_t n_arms) {
    static const palp_arm arms[] = {{0.08, 0.1, 0, 0}, {0.05, 0.02, 0, 0}};
    palp_model m = cube_model();
    m.material.n_arms = n_arms;
    memcpy(m.material.arms, arms, n_arms * sizeof *arms);
    return m;
}

static palp_model worn_model(size_t n_arms) {
    palp_model m = network_model(n_arms);
    add_effect(&m, PALP_EFFECT_DAMAGE_SOFTENING, 1.3);
    add_effect(&m, PALP_EFFECT_PERMANENT_SET, 0.7);
    add_effect(&m, PALP_EFFECT_CONTACT_OFFSET, 0.9);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 4e-4;
    return m;
}

static void press(samples *s, double t, double depth_mm) {
    go(s, t + 2, depth_mm, 40);
    go(s, t + 5, depth_mm, 20);
    go(s, t + 7, -1, 40);
}

static void two_presses(samples *first, samples *second, double deep_mm) {
    start(first, 0, -1);
    press(first, 0, 5);
    start(second, 0, -1);
    press(second, 0, deep_mm);
}

/* Each sample solved; the second run's force. */
static void in_two(const palp_model *m, const samples *first, samples *second) {
    static double other[SAMPLES_MAX];
    palp_load_history wear = {0};
    palp_forward_run a = run_of(first), b = run_of(second);
    a.history = b.history = &wear;
    ck_assert_int_eq(palp_forward_network(m, NULL, &a, other, NULL), PALP_OK);
    ck_assert_double_gt(wear.peak, 0.17);
    palp_error error = {PALP_OK, ""};
    ck_assert_msg(!palp_forward_network(m, NULL, &b, second->force_N, &error), "%s", error.text);
    palp_load_history_free(&wear);
    ck_assert_ptr_null(wear.elements);
}

static double largest(size_t n, const double *force) {
    double peak = 0;
    for (size_t i = 0; i < n; i++)
        peak = fmax(peak, fabs(force[i]));
    return peak;
}

/* Damage with arms that have forgotten; damage and set with hardly an arm: what is slack still has a
 * thousandth of its springs, by which a surface left alone creeps back. */
START_TEST(two_recordings_are_as_one) {
    static samples one, first, second;
    static const double deep[] = {4, 6.5};
    const bool set = _i >= 2;
    palp_model m = worn_model(set ? 1 : 2);
    if (set)
        m.material.arms[0] = (palp_arm){.stiffness_N = 4e-3, .viscosity_Ns = 4e-4};
    else
        m.effects[1].value[0] = 0;
    two_presses(&first, &second, deep[_i % 2]);
    in_two(&m, &first, &second);
    start(&one, 0, -1);
    press(&one, 0, 5);
    go(&one, 40, -1, 100);
    size_t from = one.n - 1;
    press(&one, 40, deep[_i % 2]);
    palp_forward_run run = run_of(&one);
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, one.force_N, NULL), PALP_OK);
    double peak = largest(second.n, second.force_N), off = 0;
    for (size_t i = 0; i < second.n; i++)
        off = fmax(off, fabs(second.force_N[i] - one.force_N[from + i]));
    ck_assert_msg(off <= (set ? 2e-3 : 1e-4) * peak, "off by %g of %g N", off, peak);
    run = run_of(&second); /* a fresh one is another matter */
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, second.force_N, NULL), PALP_OK);
    ck_assert_double_gt(fabs(second.force_N[30] - one.force_N[from + 30]), 0.02 * peak);
}
END_TEST

/* Told only how deep it was pressed: as if that had been done slowly. */
START_TEST(depth_alone_tells_most) {
    static samples first, second, again;
    palp_model m = worn_model(2);
    m.effects[2].value[0] = m.effects[3].value[0] = 0;
    two_presses(&first, &second, 4);
    again = second;
    palp_load_history wear = {.peak = 5e-3 / HEIGHT};
    palp_forward_run run = run_of(&again);
    run.history = &wear;
    in_two(&m, &first, &second);
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, again.force_N, NULL), PALP_OK);
    palp_load_history_free(&wear);
    double peak = largest(second.n, second.force_N);
    for (size_t i = 0; i < second.n; i++)
        ck_assert_double_eq_tol(again.force_N[i], second.force_N[i], 0.01 * peak);
}
END_TEST

/* The second run after the first, at chosen samples. */
static void chosen(const palp_model *m, const samples *first, const samples *second, double *force,
                   double *gradient) {
    static double other[SAMPLES_MAX], slopes[COLUMNS_MAX * SAMPLES_MAX];
    double peak_p[COLUMNS_MAX] = {0};
    palp_load_history wear = {.peak_p = peak_p};
    palp_forward_run a = run_of(first), b = run_of(second);
    a.history = b.history = &wear;
    ck_assert_int_eq(forward_network_force(m, &a, other, gradient ? slopes : NULL, NULL), PALP_OK);
    ck_assert_int_eq(forward_network_force(m, &b, force, gradient, NULL), PALP_OK);
    palp_load_history_free(&wear);
}

START_TEST(chosen_samples_wear_alike) {
    static samples first, second;
    static double force[SAMPLES_MAX];
    palp_model m = worn_model(2);
    two_presses(&first, &second, _i ? 6.5 : 4);
    in_two(&m, &first, &second);
    chosen(&m, &first, &second, force, NULL);
    double peak = largest(second.n, second.force_N);
    for (size_t i = 0; i < second.n; i++)
        ck_assert_double_eq_tol(force[i], second.force_N[i], 1e-3 * peak);
}
END_TEST

START_TEST(the_gradient_goes_from_run_to_run) {
    static samples first, second;
    static double gradient[COLUMNS_MAX * SAMPLES_MAX], here[SAMPLES_MAX], force[2][SAMPLES_MAX],
        wanted[SAMPLES_MAX];
    palp_model m = worn_model(2), moved = m;
    double at[COLUMNS_MAX];
    size_t n = palp_forward_parameter_count(&m);
    two_presses(&first, &second, 4);
    chosen(&m, &first, &second, here, gradient);
    for (size_t k = 0; k < n; k++) {
        palp_forward_get(&m, at);
        double h = 1e-4 * fmax(fabs(at[k]), 1e-5), here_k = at[k];
        for (int j = 0; j < 2; j++) {
            at[k] = here_k + (j ? -h : h);
            ck_assert_int_eq(palp_forward_set(&moved, at), PALP_OK);
            chosen(&moved, &first, &second, force[j], NULL);
        }
        for (size_t i = 0; i < second.n; i++)
            wanted[i] = (force[0][i] - force[1][i]) / (2 * h);
        double most = largest(second.n, wanted);
        for (size_t i = 0; i < second.n; i++)
            ck_assert_msg(fabs(gradient[k * second.n + i] - wanted[i]) <= 2e-3 * most,
                          "parameter %zu, sample %zu, %g mm: %.9g, not %.9g (largest %g)", k, i,
                          1e3 * second.depth_m[i], gradient[k * second.n + i], wanted[i], most);
    }
}
END_TEST

START_TEST(another_mesh_is_told) {
    static samples first, second;
    palp_model m = worn_model(1);
    palp_load_history wear = {0};
    palp_error error;
    two_presses(&first, &second, 4);
    palp_forward_run run = run_of(&first);
    run.history = &wear;
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, first.force_N, NULL), PALP_OK);
    palp_mesh_source wider = *m.mesh;
    wider.nodes[0] = 4;
    m.mesh = &wider;
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, first.force_N, &error), PALP_ERR_ARGUMENT);
    palp_load_history_free(&wear);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, two_recordings_are_as_one, 0, 4);
    tcase_add_test(tc, depth_alone_tells_most);
    tcase_add_loop_test(tc, chosen_samples_wear_alike, 0, 2);
    tcase_add_test(tc, the_gradient_goes_from_run_to_run);
    tcase_add_test(tc, another_mesh_is_told);
}
