/* test_explain_block.c: runs that press no specimen, in addition to those that do: on a rigid block, which
 * shows the frame alone, and in air, which shows the sensor. The specimen is a spring on a frame, by its own
 * formula. check: once */
#include "forward_make.h"

#include "explain/explain_data.h"

enum { RUNS = 5, PRESSES = 3 };

static const double SPRING = 10, WHITE = 3e-3; /* N */
static const double FRAME = 4e-5;              /* m/N */

typedef enum on { ON_SPECIMEN, ON_BLOCK, IN_AIR } on;

static double force_of(on what, double depth, double frame) {
    if (depth <= 0 || what == IN_AIR)
        return 0;
    return depth / ((what == ON_BLOCK ? 0 : HEIGHT / SPRING) + frame);
}

/* Presses to depth_mm at speed_mm_s, holds ten seconds, withdraws; header: a file that says what is pressed.
 */
static palp_experiment *record(on what, double depth_mm, double speed_mm_s, double frame, double drift,
                               bool header, uint64_t *noise) {
    static samples s;
    static const char *const kinds[] = {"cylinder", "rigid", "none"};
    palp_experiment *e;
    const double top = 0.25 * depth_mm, end = 1 + (depth_mm + top) / speed_mm_s;
    const double zero = 2e-3 * white_noise(noise), contact = 4e-6 * white_noise(noise);
    start(&s, 0, -top);
    go(&s, end, depth_mm, 150);
    for (int i = 1; i <= 100; i++)
        s.time_s[s.n] = end + 0.1 * i, s.depth_m[s.n++] = 1e-3 * depth_mm;
    go(&s, 2 * end + 10, -top, 170);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    if (header)
        ck_assert_int_eq(palp_experiment_set_string(e, "specimen.kind", kinds[what]), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] = force_of(what, s.depth_m[i] - contact, frame) + zero +
                                                  drift * s.time_s[i] + WHITE * white_noise(noise);
    }
    return e;
}

static palp_explain_input input[RUNS];

/* Three presses, a block, air. */
static void make(double frame, double drift, bool header) {
    static const double depth_mm[PRESSES] = {3, 4, 5}, speed_mm_s[PRESSES] = {1, 0.4, 2};
    uint64_t noise = 11;
    for (size_t r = 0; r < PRESSES; r++)
        input[r] = (palp_explain_input){
            record(ON_SPECIMEN, depth_mm[r], speed_mm_s[r], frame, drift, header, &noise), "press"};
    input[3] = (palp_explain_input){
        record(ON_BLOCK, 2e3 * frame, 20 * frame * 1e3, frame, drift, header, &noise), "block"};
    input[4] = (palp_explain_input){record(IN_AIR, 4.5, 0.3, frame, drift, header, &noise), "air"};
}

static void unmake(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

START_TEST(what_is_pressed_is_told_by_the_file_or_the_force) {
    palp_explain_pressed pressed[RUNS];
    make(FRAME, 0, _i);
    ck_assert_int_eq(explain_find_pressed(RUNS, input, pressed, NULL), PALP_OK);
    for (size_t r = 0; r < PRESSES; r++)
        ck_assert_int_eq(pressed[r].object, PALP_EXPLAIN_SPECIMEN);
    ck_assert_int_eq(pressed[3].object, PALP_EXPLAIN_BLOCK);
    ck_assert_int_eq(pressed[4].object, PALP_EXPLAIN_AIR);
    unmake();
}
END_TEST

/* A law that stiffens a hundredfold, to three depths, one run begun in contact and one with a spike: no
 * block. */
START_TEST(a_stiffening_specimen_is_no_block) {
    palp_explain_pressed pressed[3];
    palp_explain_input presses[3];
    uint64_t noise = 5;
    for (size_t r = 0; r < 3; r++) {
        palp_experiment *e = record(ON_SPECIMEN, 2 + 1.5 * (double)r, 1, FRAME, 0, false, &noise);
        double *force = palp_experiment_column(e, "force_N");
        for (size_t i = 0; i < palp_experiment_rows(e); i++)
            force[i] = (exp(3 * fmax(0, force[i])) - 1) / 20 + WHITE * white_noise(&noise);
        if (r == 1)
            force[5] = 100;
        for (size_t i = 0; r == 2 && i < 40; i++)
            force[i] = force[80];
        presses[r] = (palp_explain_input){e, "press"};
    }
    ck_assert_int_eq(explain_find_pressed(3, presses, pressed, NULL), PALP_OK);
    for (size_t r = 0; r < 3; r++) {
        ck_assert_int_eq(pressed[r].object, PALP_EXPLAIN_SPECIMEN);
        palp_experiment_free((palp_experiment *)(uintptr_t)presses[r].experiment);
    }
}
END_TEST

static void explain(size_t n, palp_explanation *e) {
    palp_explain_settings settings = palp_explain_settings_default();
    const double given = 1.1 * SPRING;
    palp_model m = lumped_model(0);
    ck_assert_int_eq(palp_law_polynomial(1, &given, &m.material.law), PALP_OK);
    ck_assert_int_eq(palp_explain(&m, n, input, &settings, e, NULL), PALP_OK);
}

/* In the law of one specimen a frame hides; a block shows it, and the law is the specimen's then. */
START_TEST(a_block_shows_the_frame) {
    palp_explanation e;
    make(FRAME, 0, _i);
    explain(RUNS, &e);
    ck_assert_msg(e.verdict == PALP_EXPLAIN_EXPLAINED && e.n_effects == 1, "%s, %zu effects",
                  palp_explain_verdict_name(e.verdict), e.n_effects);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_FRAME_COMPLIANCE);
    ck_assert_msg(e.effect[0].low[0] <= FRAME && FRAME <= e.effect[0].high[0], "%g to %g", e.effect[0].low[0],
                  e.effect[0].high[0]);
    ck_assert_double_lt(e.effect[0].high[0] - e.effect[0].low[0], 0.1 * FRAME);
    ck_assert_double_lt(fabs(e.model.material.law.coefficients[0] / SPRING - 1), 0.01);
    ck_assert_uint_eq(e.n_runs, RUNS - 1);
    palp_explanation_free(&e);
    explain(PRESSES, &e);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    palp_explanation_free(&e);
    unmake();
}
END_TEST

START_TEST(air_shows_the_drift) {
    const double drift = 1.2e-3; /* N/s */
    palp_explanation e;
    make(FRAME, drift, _i);
    explain(RUNS, &e);
    bool found = false;
    for (size_t i = 0; i < e.n_effects; i++) {
        const palp_explain_effect *of = &e.effect[i];
        if (of->effect.id == PALP_EFFECT_SENSOR_DRIFT)
            found = of->low[0] <= drift && drift <= of->high[0] && of->high[0] - of->low[0] < 0.1 * drift;
        else
            ck_assert_int_eq(of->effect.id, PALP_EFFECT_FRAME_COMPLIANCE);
    }
    ck_assert(found);
    palp_explanation_free(&e);
    unmake();
}
END_TEST

START_TEST(a_block_alone_is_no_specimen) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    palp_error error;
    palp_model m = lumped_model(0);
    make(FRAME, 0, true);
    ck_assert_int_eq(palp_explain(&m, 1, &input[3], &settings, &e, &error), PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "block: no run is left in which the specimen is pressed"));
    unmake();
}
END_TEST

/* What explain says of the runs before it fits any; NULL: it takes them all. */
static const char *refusal(void) {
    static palp_error error;
    palp_explain_settings settings = palp_explain_settings_default();
    palp_model m = lumped_model(0);
    explain_data data;
    palp_status status = explain_data_create(RUNS, input, &settings, &m, &data, &error);
    explain_data_free(&data);
    return status ? error.text : NULL;
}

static palp_experiment *last_run(void) {
    return (palp_experiment *)(uintptr_t)input[RUNS - 1].experiment;
}

/* 0 and 1: a file that names a specimen, of a sensor that shows its noise alone, or 0 N. 2 and 3: a file that
 * names nothing, of a sensor that stands still at 0 N or at another force. */
START_TEST(a_dead_sensor_is_no_run_in_air) {
    make(FRAME, 0, _i < 2);
    input[RUNS - 1].name = "dead.csv";
    if (_i < 2)
        ck_assert_int_eq(palp_experiment_set_string(last_run(), "specimen.kind", "cylinder"), PALP_OK);
    double *force = palp_experiment_column(last_run(), "force_N");
    for (size_t i = 0; i < palp_experiment_rows(last_run()) && _i > 0; i++)
        force[i] = _i == 3 ? 0.02 : 0;
    const char *why = refusal();
    ck_assert_ptr_nonnull(why);
    ck_assert_msg(strstr(why, "dead.csv: force_N never exceeds its noise: no contact, or a dead sensor"),
                  "%s", why);
    unmake();
}
END_TEST

/* Of a run with noise whose file says nothing no one can know: it is said to be an assumption. */
START_TEST(air_that_no_file_declares_is_said_to_be_assumed) {
    static const palp_explain_object found[RUNS] = {PALP_EXPLAIN_SPECIMEN, PALP_EXPLAIN_SPECIMEN,
                                                    PALP_EXPLAIN_SPECIMEN, PALP_EXPLAIN_BLOCK,
                                                    PALP_EXPLAIN_AIR};
    palp_explanation e;
    make(FRAME, 0, _i);
    explain(RUNS, &e);
    ck_assert_uint_eq(e.n_inputs, RUNS);
    for (size_t r = 0; r < RUNS; r++) {
        ck_assert_int_eq(e.pressed[r].object, found[r]);
        ck_assert_int_eq(e.pressed[r].declared, _i);
    }
    palp_explanation_free(&e);
    unmake();
}
END_TEST

/* Above nominal contact nothing is pressed: such a run need not leave its noise, whatever its file names. */
START_TEST(a_run_above_contact_is_no_dead_sensor) {
    make(FRAME, 0, _i);
    if (_i)
        ck_assert_int_eq(palp_experiment_set_string(last_run(), "specimen.kind", "cylinder"), PALP_OK);
    double *depth = palp_experiment_column(last_run(), "depth_mm");
    for (size_t i = 0; i < palp_experiment_rows(last_run()); i++)
        depth[i] -= 4.6;
    ck_assert_msg(!refusal(), "%s", refusal());
    unmake();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_dead_sensor_is_no_run_in_air, 0, 4);
    tcase_add_loop_test(tc, air_that_no_file_declares_is_said_to_be_assumed, 0, 2);
    tcase_add_loop_test(tc, a_run_above_contact_is_no_dead_sensor, 0, 2);
    tcase_add_loop_test(tc, what_is_pressed_is_told_by_the_file_or_the_force, 0, 2);
    tcase_add_test(tc, a_stiffening_specimen_is_no_block);
    tcase_add_loop_test(tc, a_block_shows_the_frame, 0, 2);
    tcase_add_loop_test(tc, air_shows_the_drift, 0, 2);
    tcase_add_test(tc, a_block_alone_is_no_specimen);
}
