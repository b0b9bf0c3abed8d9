/* test_load_history.c: damage and permanent set from run to run: two presses in one recording, or in two. */
#include "forward_make.h"

/* Time enough that the arm has forgotten everything. */
static const double REST = 400;

static void press(samples *s, double t, double depth_mm) {
    go(s, t + 2, depth_mm, 40);
    go(s, t + 5, depth_mm, 40);
    go(s, t + 7, -1.0, 40);
}

static palp_model worn_model(void) {
    palp_model m = lumped_model(2);
    m.material.arms[1].viscosity_Ns = 2;
    add_effect(&m, PALP_EFFECT_DAMAGE_SOFTENING, 1.3);
    add_effect(&m, PALP_EFFECT_PERMANENT_SET, 1.7);
    add_effect(&m, PALP_EFFECT_CONTACT_OFFSET, 0.9);
    m.effects[m.n_effects] = (palp_effect){.id = PALP_EFFECT_FRAME_COMPLIANCE, .value = {4e-5}};
    m.n_effects++;
    return m;
}

static void two_presses(samples *first, samples *second, double deep_mm) {
    start(first, 0, -1.0);
    press(first, 0, 6);
    start(second, 0, -1.0);
    press(second, 0, deep_mm);
}

START_TEST(two_recordings_are_as_one) {
    static samples one, first, second;
    palp_model m = worn_model();
    two_presses(&first, &second, _i ? 7.5 : 4);
    start(&one, 0, -1.0);
    press(&one, 0, 6);
    go(&one, REST, -1.0, 600);
    size_t from = one.n - 1;
    press(&one, REST, _i ? 7.5 : 4);
    press_model(&m, &one);
    palp_load_history wear = {0};
    palp_forward_run a = run_of(&first), b = run_of(&second);
    a.history = b.history = &wear;
    ck_assert_int_eq(palp_forward_force(&m, &a, first.force_N, NULL, NULL), PALP_OK);
    ck_assert_double_gt(wear.peak, 0.2);
    ck_assert_int_eq(palp_forward_force(&m, &b, second.force_N, NULL, NULL), PALP_OK);
    double largest = 0;
    for (size_t i = 0; i < second.n; i++)
        largest = fmax(largest, fabs(second.force_N[i]));
    for (size_t i = 0; i < second.n; i++)
        ck_assert_double_eq_tol(second.force_N[i], one.force_N[from + i], 1e-4 * largest);
    b.history = NULL; /* a fresh one is another matter */
    ck_assert_int_eq(palp_forward_force(&m, &b, second.force_N, NULL, NULL), PALP_OK);
    ck_assert_double_gt(fabs(second.force_N[30] - one.force_N[from + 30]), 0.02 * largest);
}
END_TEST

/* The second run's forces after the first, and its gradient if wanted. */
static void both(const palp_model *m, const samples *first, const samples *second, double *force,
                 double *gradient) {
    static double other[SAMPLES_MAX], slopes[COLUMNS_MAX * SAMPLES_MAX];
    double peak_p[COLUMNS_MAX] = {0};
    palp_load_history wear = {.peak_p = peak_p};
    palp_forward_run a = run_of(first), b = run_of(second);
    a.history = b.history = &wear;
    ck_assert_int_eq(palp_forward_force(m, &a, other, gradient ? slopes : NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_forward_force(m, &b, force, gradient, NULL), PALP_OK);
}

START_TEST(the_gradient_goes_from_run_to_run) {
    static samples first, second;
    static double gradient[COLUMNS_MAX * SAMPLES_MAX], here[SAMPLES_MAX], up[SAMPLES_MAX], down[SAMPLES_MAX];
    palp_model m = worn_model(), moved = m;
    double at[COLUMNS_MAX];
    size_t n = palp_forward_parameter_count(&m);
    two_presses(&first, &second, 4);
    both(&m, &first, &second, here, gradient);
    for (size_t k = 0; k < n; k++) {
        palp_forward_get(&m, at);
        double h = 1e-5 * fmax(fabs(at[k]), 1e-6), largest = 0;
        at[k] += h;
        ck_assert_int_eq(palp_forward_set(&moved, at), PALP_OK);
        both(&moved, &first, &second, up, NULL);
        at[k] -= 2 * h;
        ck_assert_int_eq(palp_forward_set(&moved, at), PALP_OK);
        both(&moved, &first, &second, down, NULL);
        for (size_t i = 0; i < second.n; i++)
            largest = fmax(largest, fabs(up[i] - down[i]) / (2 * h));
        for (size_t i = 0; i < second.n; i++)
            ck_assert_msg(fabs(gradient[k * second.n + i] - (up[i] - down[i]) / (2 * h)) <= 1e-4 * largest,
                          "parameter %zu, sample %zu: %.9g, not %.9g", k, i, gradient[k * second.n + i],
                          (up[i] - down[i]) / (2 * h));
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, two_recordings_are_as_one, 0, 2);
    tcase_add_test(tc, the_gradient_goes_from_run_to_run);
}
