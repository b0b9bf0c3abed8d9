/* test_specimen.c: a model pressed step by step against the run of the whole path; what a step allocates. */
/* link: -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc */
#include "forward_make.h"

#include <palpate/specimen.h>

/* ---- allocation, counted and refused ---- */

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);

static size_t calls, refused; /* the refused-th call gives NULL; 0 = none does */

void *__wrap_malloc(size_t size) {
    return ++calls == refused ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size) {
    return ++calls == refused ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *old, size_t size) {
    return ++calls == refused ? NULL : __real_realloc(old, size);
}

/* ---- pressing ---- */

static samples s;

static palp_specimen *make(const palp_model *m, const palp_specimen_settings *settings) {
    palp_specimen *specimen = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_specimen_create(m, settings, &specimen, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    return specimen;
}

/* Allocates nothing. */
static double step(palp_specimen *specimen, double depth_m, double dt_s) {
    double force = NAN;
    size_t before = calls;
    palp_status status = palp_specimen_step(specimen, depth_m, dt_s, &force);
    before = calls - before;
    ck_assert_int_eq(status, PALP_OK);
    ck_assert_uint_eq(before, 0);
    return force;
}

static palp_model network_model(size_t nodes) {
    palp_model m = lumped_model(2);
    m.kind = PALP_MODEL_NETWORK;
    m.mesh = lattice_source(nodes, PALP_NEIGHBOURS_26);
    return m;
}

/* As forward.c sees the path at sample i: a parabola through it and its neighbours. */
static palp_specimen_motion motion_at(const samples *p, size_t i) {
    const double *t = p->time_s, *d = p->depth_m;
    size_t last = p->n - 1;
    double come = i ? (d[i] - d[i - 1]) / (t[i] - t[i - 1]) : (d[1] - d[0]) / (t[1] - t[0]);
    double go = i < last ? (d[i + 1] - d[i]) / (t[i + 1] - t[i]) : come;
    palp_specimen_motion m = {t[i], d[i], come, 0};
    if (i && i < last) {
        double before = t[i] - t[i - 1], after = t[i + 1] - t[i];
        m.velocity_m_s = (come * after + go * before) / (before + after);
        m.acceleration_m_s2 = 2 * (go - come) / (before + after);
    }
    return m;
}

/* Steps along the samples; the sensor readings equal s.force_N within the tolerance. rated: they are not
 * compared at corners, where the rates of step and sample differ. */
static void follows(const palp_model *m, bool rated, double tolerance) {
    palp_specimen_settings settings = palp_specimen_settings_default();
    settings.start_m = s.depth_m[0];
    settings.session_s = 5000;
    settings.step_s = s.time_s[1] - s.time_s[0];
    for (size_t i = 1; i < s.n; i++) {
        settings.step_s = fmin(settings.step_s, s.time_s[i] - s.time_s[i - 1]);
        settings.fastest_m_s = fmax(settings.fastest_m_s, fabs(motion_at(&s, i).velocity_m_s));
    }
    settings.span_s = s.time_s[s.n - 1] - s.time_s[0];
    palp_specimen *specimen = make(m, &settings);
    double largest = 0, worst = 0;
    for (size_t i = 0; i < s.n; i++) {
        const palp_specimen_motion at = motion_at(&s, i);
        double rate = at.velocity_m_s;
        if (i) {
            rate = (s.depth_m[i] - s.depth_m[i - 1]) / (s.time_s[i] - s.time_s[i - 1]);
            step(specimen, s.depth_m[i], s.time_s[i] - s.time_s[i - 1]);
        }
        double miss = fabs(palp_specimen_sense(specimen, &at) - s.force_N[i]);
        largest = fmax(largest, fabs(s.force_N[i]));
        if (!rated || fabs(rate - at.velocity_m_s) < 1e-9)
            worst = fmax(worst, miss);
    }
    ck_assert_double_gt(largest, 0.5);
    ck_assert_msg(worst <= tolerance * largest, "off by %g of %g N", worst, largest);
    palp_specimen_free(specimen);
}

START_TEST(steps_are_the_run) {
    const palp_effect_id id = (palp_effect_id)_i;
    palp_model m = lumped_model(2);
    if (id < PALP_EFFECT_COUNT && !palp_effect_look_up(id)->in_lumped)
        return;
    if (id < PALP_EFFECT_COUNT)
        add_effect(&m, id, 1);
    if (id == PALP_EFFECT_FORCE_SATURATION)
        m.effects[0].value[0] = 1;
    all_phases(&s, 60);
    palp_forward_run run = run_of(&s);
    run.n_columns = 0; /* a specimen that is stepped knows none */
    run.hum_phase = 0;
    ck_assert_int_eq(palp_forward_force(&m, &run, s.force_N, NULL, NULL), PALP_OK);
    double tolerance = id == PALP_EFFECT_SESSION_AGEING ? 3e-4 : 1e-11; /* it is seconds older at contact */
    follows(&m, id == PALP_EFFECT_RATE_STIFFENING, tolerance);
}
END_TEST

START_TEST(steps_are_the_run_of_a_network) {
    static const palp_effect_id ids[] = {PALP_EFFECT_COUNT,
                                         PALP_EFFECT_ADHESION,
                                         PALP_EFFECT_PLATE_SLIP,
                                         PALP_EFFECT_DAMAGE_SOFTENING,
                                         PALP_EFFECT_FRAME_COMPLIANCE,
                                         PALP_EFFECT_SENSOR_LAG};
    palp_model m = network_model(3);
    if (ids[_i] < PALP_EFFECT_COUNT)
        add_effect(&m, ids[_i], 1);
    all_phases(&s, 20);
    palp_forward_run run = run_of(&s);
    run.hum_phase = 0;
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, s.force_N, NULL), PALP_OK);
    follows(&m, false, 1e-9);
}
END_TEST

START_TEST(effects_together_in_small_steps) {
    static const palp_effect_id ids[] = {PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_PERMANENT_SET,
                                         PALP_EFFECT_ADHESION,         PALP_EFFECT_TOE_REGION,
                                         PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_POWER_LAW_RELAXATION,
                                         PALP_EFFECT_SENSOR_LAG,       PALP_EFFECT_COULOMB_FRICTION};
    palp_model m = lumped_model(1);
    for (size_t i = 0; i < PALP_EFFECTS_MAX; i++)
        add_effect(&m, ids[i], 1);
    all_phases(&s, 400);
    press_model(&m, &s);
    follows(&m, false, 1e-11);
}
END_TEST

/* An oscillating plate meets the surface within a step, and then presses no deeper than it moves in that
 * step. */
START_TEST(meets_anywhere_in_a_step) {
    const double dt = 5e-5, fast = 5e-7, pace = 3e-9; /* m a step */
    palp_model m = lumped_model(2);
    add_effect(&m, PALP_EFFECT_PERMANENT_SET, 1);
    palp_specimen *specimen = make(&m, NULL);
    double depth = 0, force = 0;
    while (depth < 0.2 * HEIGHT)
        force = step(specimen, depth += fast, dt);
    while (force > 0)
        force = step(specimen, depth -= fast, dt);
    for (int meets = 0; meets < 300; meets++) {
        double taken = pace * (1 + fmod(0.618034 * meets, 1));
        while (force == 0)
            force = step(specimen, depth += taken, dt);
        ck_assert_double_lt(force, 100 / HEIGHT * taken);
        while (force > 0)
            force = step(specimen, depth -= taken, dt);
    }
    palp_specimen_free(specimen);
}
END_TEST

/* ---- what else it can be told ---- */

START_TEST(scale_and_table) {
    const double N_m = 2000;
    palp_model m = linear_model(8);
    palp_specimen_settings settings = palp_specimen_settings_default();
    settings.scale = 3;
    settings.table_N_m = N_m;
    palp_specimen *specimen = make(&m, &settings);
    ck_assert_double_eq_tol(step(specimen, 0.5 * HEIGHT, 0.1), 3 * 8 * 0.5, 1e-12);
    ck_assert_double_eq_tol(step(specimen, 0.97 * HEIGHT, 0.1), 3 * 8 * 0.95 + N_m * 0.02 * HEIGHT, 1e-12);
    ck_assert_double_eq(step(specimen, -0.1 * HEIGHT, 0.1), 0);
    palp_specimen_free(specimen);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 2e-5;
    specimen = make(&m, &settings);
    double force = step(specimen, HEIGHT, 0.1), depth = HEIGHT - 2e-5 * force; /* the frame gives way */
    ck_assert_double_eq_tol(force, 3 * 8 * 0.95 + N_m * (depth - 0.95 * HEIGHT), 1e-9);
    palp_specimen_free(specimen);
}
END_TEST

START_TEST(starts_pressed) {
    palp_model m = linear_model(8);
    palp_specimen_settings settings = palp_specimen_settings_default();
    settings.start_m = 0.25 * HEIGHT;
    palp_specimen *specimen = make(&m, &settings);
    palp_specimen_motion at = {.time_s = 0};
    ck_assert_double_eq_tol(palp_specimen_sense(specimen, &at), 2, 1e-12);
    ck_assert_double_eq_tol(step(specimen, 0.25 * HEIGHT, 1), 2, 1e-12);
    palp_specimen_free(specimen);
}
END_TEST

/* The same moment read twice is one reading; a lag of T has reached 1 - T/t (1 - exp(-t/T)) of a ramp. */
START_TEST(reads_once_a_moment) {
    palp_model m = linear_model(8);
    add_effect(&m, PALP_EFFECT_SENSOR_LAG, 1)->value[0] = 0.5;
    palp_specimen *specimen = make(&m, NULL);
    palp_specimen_motion at = {.time_s = 0};
    ck_assert_double_eq(palp_specimen_sense(specimen, &at), 0);
    double force = step(specimen, 0.5 * HEIGHT, 1);
    at.time_s = 1;
    double read = palp_specimen_sense(specimen, &at);
    ck_assert_double_eq_tol(read, force * (1 - 0.5 * (1 - exp(-2))), 1e-12);
    ck_assert_double_eq(palp_specimen_sense(specimen, &at), read);
    palp_specimen_free(specimen);
}
END_TEST

/* It ages while it is let be, not under the plate. */
START_TEST(ages_from_contact_to_contact) {
    palp_model m = linear_model(8);
    add_effect(&m, PALP_EFFECT_SESSION_AGEING, 1)->value[0] = 0.5 / 3600;
    palp_specimen *specimen = make(&m, NULL);
    ck_assert_double_eq_tol(step(specimen, 0.5 * HEIGHT, 1), 4, 1e-12);
    ck_assert_double_eq_tol(step(specimen, 0.5 * HEIGHT, 1800), 4, 1e-12);
    step(specimen, -1e-3, 1);
    step(specimen, -1e-3, 1798);
    ck_assert_double_eq_tol(step(specimen, 0.5 * HEIGHT, 1), 6, 1e-12);
    palp_specimen_free(specimen);
}
END_TEST

START_TEST(what_cannot_be_is_told) {
    palp_model m = lumped_model(1);
    palp_specimen *specimen = make(&m, NULL), *none = NULL;
    palp_specimen_settings settings = palp_specimen_settings_default();
    palp_error error;
    double force = 7;
    step(specimen, 1e-3, 0.1);
    ck_assert_int_eq(palp_specimen_step(specimen, NAN, 0.1, &force), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_specimen_step(specimen, 1e-3, 0, &force), PALP_ERR_ARGUMENT);
    ck_assert_double_eq(force, 7);
    ck_assert_double_gt(step(specimen, 1e-3, 0.1), 0);
    palp_specimen_free(specimen);
    settings.scale = 0;
    ck_assert_int_eq(palp_specimen_create(&m, &settings, &none, &error), PALP_ERR_ARGUMENT);
    m.material.formulation = PALP_SEDEF2008;
    ck_assert_int_eq(palp_specimen_create(&m, NULL, &none, &error), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(error.text, "sedef2008"));
    ck_assert_ptr_null(none);
    palp_specimen_free(NULL);
}
END_TEST

START_TEST(each_allocation_fails) {
    palp_model m = _i ? network_model(3) : lumped_model(2);
    palp_status status = PALP_ERR_NO_MEMORY;
    add_effect(&m, PALP_EFFECT_SENSOR_LAG, 1);
    size_t n = 0;
    while (status) {
        palp_specimen *specimen = NULL;
        palp_error error = {PALP_OK, ""};
        calls = 0;
        refused = ++n;
        status = palp_specimen_create(&m, NULL, &specimen, &error);
        refused = 0;
        ck_assert(status == PALP_OK || (status == PALP_ERR_NO_MEMORY && error.text[0]));
        palp_specimen_free(specimen);
    }
    ck_assert_uint_gt(n, 3);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, steps_are_the_run, 0, PALP_EFFECT_COUNT + 1);
    tcase_add_loop_test(tc, steps_are_the_run_of_a_network, 0, 6);
    tcase_add_test(tc, effects_together_in_small_steps);
    tcase_add_test(tc, meets_anywhere_in_a_step);
    tcase_add_test(tc, scale_and_table);
    tcase_add_test(tc, starts_pressed);
    tcase_add_test(tc, reads_once_a_moment);
    tcase_add_test(tc, ages_from_contact_to_contact);
    tcase_add_test(tc, what_cannot_be_is_told);
    tcase_add_loop_test(tc, each_allocation_fails, 0, 2);
}
