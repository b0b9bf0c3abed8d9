/* test_forward_cost.c: how often a recording asks the specimen for a force: a few times for each sample,
 * whatever the model. */
#include "response/forward_internal.h"
#include "forward_make.h"

static samples s;

/* ---- counted ---- */

static forward_specimen counted;
static size_t asked;

static palp_status count(void *self, const forward_move *move, double *force, double *slope) {
    asked++;
    return counted.attempt(self, move, force, slope);
}

/* How often it is asked at most on the way from one sample to the next. */
static size_t asked_most(const palp_model *m) {
    forward_plan plan;
    forward_plate plate;
    forward_lumped *lumped;
    const palp_forward_run run = run_of(&s);
    size_t most = 0;
    double shortest, whole;
    forward_times(&run, &shortest, &whole);
    ck_assert_int_eq(forward_plan_make(m, 0, &plan, NULL), PALP_OK);
    ck_assert_int_eq(forward_lumped_create(&plan, plan.n_columns, shortest, whole, &lumped), PALP_OK);
    counted = forward_lumped_specimen(lumped);
    forward_specimen specimen = counted;
    specimen.attempt = count;
    ck_assert_int_eq(forward_plate_create(&plan, &specimen, &plate), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        const forward_place place = forward_place_at(&plan, &run, i, 1);
        asked = 0;
        ck_assert_int_eq(i ? forward_plate_move(&plate, &place) : forward_plate_start(&plate, &place),
                         PALP_OK);
        s.force_N[i] = plate.force;
        ck_assert(isfinite(plate.force));
        most = asked > most ? asked : most;
    }
    forward_plate_free(&plate);
    forward_lumped_free(lumped);
    return most;
}

/* Three times, from the air into the air. */
static void presses(void) {
    start(&s, 0, -1);
    for (int k = 0; k < 3; k++) {
        const double t = 8 * k;
        go(&s, t + 2, 6, 40);
        go(&s, t + 5, 6, 60);
        go(&s, t + 7, -1, 40);
        go(&s, t + 8, -1, 20);
    }
}

/* ---- tests ---- */

/* A law that a search tries on its way: at small strains the surface pulls, so that the plate lets go of it
 * in step after step. */
START_TEST(a_law_that_falls_off_the_plate) {
    static const double law[] = {-4000, 15700};
    palp_model m = linear_model(1);
    ck_assert_int_eq(palp_law_polynomial(2, law, &m.material.law), PALP_OK);
    ck_assert_int_eq(palp_law_limit(&m.material.law, 0.3228), PALP_OK);
    *add_effect(&m, PALP_EFFECT_POWER_LAW_RELAXATION, 1) =
        (palp_effect){PALP_EFFECT_POWER_LAW_RELAXATION, {1186, 0.32}};
    presses();
    ck_assert_uint_le(asked_most(&m), 150);
}
END_TEST

/* An arm that is faster than the samples by up to eight decades costs no more than one that is as fast. */
START_TEST(an_arm_much_faster_than_the_samples) {
    palp_model m = lumped_model(2);
    m.material.arms[1] = (palp_arm){.stiffness_N = 20, .viscosity_Ns = 20 * 0.025 * pow(10, -_i)};
    presses();
    ck_assert_uint_le(asked_most(&m), 100);
}
END_TEST

/* Within a step it is in equilibrium: the recording is that without it. */
START_TEST(such_an_arm_changes_nothing) {
    static double without[SAMPLES_MAX];
    palp_model m = lumped_model(1);
    presses();
    asked_most(&m);
    memcpy(without, s.force_N, sizeof without);
    m.material.arms[m.material.n_arms++] = (palp_arm){.stiffness_N = 20, .viscosity_Ns = 20 * 1e-8};
    asked_most(&m);
    for (size_t i = 0; i < s.n; i++)
        ck_assert_double_le(fabs(s.force_N[i] - without[i]), 1e-5);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_law_that_falls_off_the_plate);
    tcase_add_loop_test(tc, an_arm_much_faster_than_the_samples, 0, 9);
    tcase_add_test(tc, such_an_arm_changes_nothing);
}
