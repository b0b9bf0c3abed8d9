/* test_acquire_plan.c: the segments that acquire plans from options and protocol files. */
/* link: -pthread */
#define _POSIX_C_SOURCE 200809L
#include "acquire_make.h"

#include <string.h>

static void test_ramp_hold(void **state) {
    char why[ACQUIRE_TEXT];
    acquire_plan *plan = empty_plan();
    acquire_motion m = acquire_motion_none();
    (void)state;
    assert_null(acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, NULL, why));
    assert_non_null(strstr(why, "depth_mm"));
    m.depth_mm = 5;
    const acquire_run *r = acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, NULL, why);
    assert_string_equal(r->name, "ramp_hold_5mm");
    assert_int_equal(r->n_segments, 2);
    assert_int_equal(r->segment[0].kind, PALP_WIRE_SEGMENT_MOVE);
    assert_int_equal(r->segment[0].target_nm, 5000000);
    assert_int_equal(r->segment[0].rate_nm_s, 5000000);
    assert_int_equal(r->segment[0].acceleration_um_s2, 500000);
    assert_int_equal(r->segment[1].kind, PALP_WIRE_SEGMENT_HOLD);
    assert_int_equal(r->segment[1].index, 1);
    assert_int_equal(r->segment[1].duration_ms, 200000);
    near(r->start_mm, -1, 0);
    near(r->deepest_mm, 5, 0);
    near(r->highest_mm, -1, 0);
    near(r->press_s, 6.0 / 5 + 200, 1e-12);
    m.rate_mm_s = 2; /* instead of the time */
    m.hold_s = 0;
    r = acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, "named", why);
    assert_string_equal(r->name, "named");
    assert_int_equal(r->n_segments, 1);
    assert_int_equal(r->segment[0].rate_nm_s, 2000000);
    near(r->motion.ramp_s, 2.5, 0);
    assert_true(acquire_plan_arrange(plan));
    near(plan->run[0].motion.rest_s, 0, 0); /* then as long as the last press took, or 200 s */
    near(plan->run[1].motion.rest_s, plan->run[0].press_s, 0);
    free(plan);
}

static void test_kinds(void **state) {
    char why[ACQUIRE_TEXT];
    acquire_plan *plan = empty_plan();
    acquire_motion m = acquire_motion_none();
    (void)state;
    m.depth_mm = 3;
    m.ramp_s = 0.5; /* of ramps only */
    const acquire_run *r = acquire_plan_add(plan, ACQUIRE_STATIC, &m, NULL, why);
    assert_int_equal(r->n_segments, 1);
    assert_int_equal(r->segment[0].rate_nm_s, 100000);
    assert_true(isnan(r->motion.ramp_s) && isnan(r->motion.hold_s) && isnan(r->motion.cycles));
    r = acquire_plan_add(plan, ACQUIRE_CYCLIC, &m, NULL, why);
    assert_int_equal(r->n_segments, 2);
    assert_int_equal(r->segment[0].target_nm, 0);
    assert_int_equal(r->segment[1].kind, PALP_WIRE_SEGMENT_CYCLE);
    assert_int_equal(r->segment[1].cycles, 3);
    near(r->press_s, 1 + 3 * 2 * 3, 1e-12);
    r = acquire_plan_add(plan, ACQUIRE_SWEEP, &m, NULL, why);
    assert_int_equal(r->n_segments, 3);
    assert_int_equal(r->segment[2].target_nm, 300000);
    assert_int_equal(r->segment[2].frequency_mHz, 100);
    assert_int_equal(r->segment[2].frequency_end_mHz, 10000);
    assert_int_equal(r->segment[2].duration_ms, 60000);
    near(r->deepest_mm, 3.3, 1e-12);
    r = acquire_plan_add(plan, ACQUIRE_FREE, &m, NULL, why);
    assert_int_equal(r->n_segments, 2);
    near(r->start_mm, -4, 0);
    near(r->deepest_mm, -1, 0);
    assert_int_equal(r->segment[0].rate_nm_s, 6000000);
    free(plan);
}

static void test_thesis_protocol(void **state) {
    char why[ACQUIRE_TEXT];
    acquire_motion m = acquire_motion_none();
    acquire_plan *plan = empty_plan(), *again = empty_plan();
    size_t seen = 0, moved = 0;
    (void)state;
    m.hold_s = 5;
    assert_true(acquire_plan_seed(plan, &m, why) && acquire_plan_arrange(plan));
    assert_true(acquire_plan_seed(again, &m, why) && acquire_plan_arrange(again));
    assert_int_equal(plan->n, 16);
    assert_string_equal(plan->run[0].name, "air_before");
    assert_string_equal(plan->run[15].name, "air_after");
    for (size_t i = 1; i < 15; i++) {
        const acquire_run *r = &plan->run[i];
        assert_string_equal(r->name, again->run[i].name);
        assert_true(r->kind == ACQUIRE_RAMP_HOLD || r->kind == ACQUIRE_STATIC);
        for (int k = 0; k < 12; k++) {
            seen +=
                r->kind == ACQUIRE_RAMP_HOLD && r->motion.depth_mm == 1.5 + 0.5 * k && !r->repeat ? 1u : 0;
        }
        moved += r->motion.depth_mm != 1.0 + 0.5 * (double)i;
        if (i > 1) { /* at most 107 s were pressed */
            near(r->motion.rest_s, 200, 0);
        }
    }
    assert_int_equal(seen, 12);
    assert_true(moved > 6);
    assert_true(plan->run[14].repeat);
    near(plan->run[14].motion.depth_mm, plan->run[1].motion.depth_mm, 0);
    assert_non_null(strstr(plan->run[14].name, "_repeat"));
    near(plan->run[1].motion.rest_s, 0, 0);
    again->n = 0;
    again->seed = 2;
    assert_true(acquire_plan_seed(again, &m, why) && acquire_plan_arrange(again));
    size_t same = 0;
    for (size_t i = 1; i < 15; i++) {
        same += strcmp(plan->run[i].name, again->run[i].name) == 0;
    }
    assert_true(same < 7);
    free(plan);
    free(again);
}

static acquire_plan *read_protocol(const char *text, const acquire_motion *options, int *code) {
    acquire_plan *plan = empty_plan();
    FILE *to = fopen(in_folder("protocol.json"), "w");
    fputs(text, to);
    fclose(to);
    *code = acquire_plan_read(plan, in_folder("protocol.json"), options);
    return plan;
}

static void test_protocol_file(void **state) {
    int code;
    acquire_motion options = acquire_motion_none();
    (void)state;
    options.hold_s = 7;
    acquire_plan *plan =
        read_protocol("{\"palpate\": {\"protocol\": 1}, \"hold_s\": 100, \"air_s\": 0.5, "
                      "\"rate_mm_s\": 2, \"order\": \"random\",\n"
                      " \"order_seed\": 5, \"repeat_first\": true, \"runs\": [\n"
                      "  {\"kind\": \"ramp_hold\", \"depth_mm\": 2, \"ramp_s\": 0.5},\n"
                      "  {\"kind\": \"ramp_hold\", \"depth_mm\": 2, \"hold_s\": 3},\n"
                      "  {\"kind\": \"segments\", \"name\": \"steps\", \"segments\": [\n"
                      "    {\"move_to_mm\": 1, \"rate_mm_s\": 4}, {\"hold_s\": 2}, "
                      "{\"sine_mm\": 0.1, \"frequency_Hz\": 2, \"cycles\": 4},\n"
                      "    {\"cycle_to_mm\": 3, \"rate_mm_s\": 1, \"cycles\": 2}, "
                      "{\"move_to_mm\": -0.5, \"rate_mm_s\": 1}]},\n"
                      "  {\"kind\": \"segments\", \"name\": \"creep\", \"air_mm\": 1, \"segments\": [\n"
                      "    {\"force_N\": 1.5, \"ramp_s\": 0.5, \"duration_s\": 20}]},\n"
                      "  {\"kind\": \"free\", \"hold_s\": 1}]}",
                      &options, &code);
    assert_int_equal(code, CLI_OK);
    assert_int_equal(plan->n, 5);
    near(plan->run[0].motion.rate_mm_s, 4, 0); /* its own ramp time before all else */
    near(plan->run[0].motion.hold_s, 7, 0);    /* an option before what the file says for all */
    near(plan->run[1].motion.hold_s, 3, 0);    /* and what a run says before both */
    near(plan->run[1].motion.rate_mm_s, 2, 0);
    near(plan->run[1].motion.air_s, 0.5, 0);
    const acquire_run *steps = &plan->run[2];
    assert_int_equal(steps->n_segments, 5);
    near(steps->press_s, 0.5 + 2 + 2 + 8 + 1.5, 1e-12);
    near(steps->deepest_mm, 3, 0);
    near(steps->at_mm, -0.5, 0);
    const acquire_run *creep = &plan->run[3];
    assert_int_equal(creep->n_segments, 1);
    assert_int_equal(creep->segment[0].kind, PALP_WIRE_SEGMENT_FORCE);
    assert_int_equal(creep->segment[0].target_nm, 1500000);
    assert_int_equal(creep->segment[0].rate_nm_s, 3000000);
    assert_int_equal(creep->segment[0].duration_ms, 20000);
    near(creep->press_s, 1 + 0.5 + 20, 1e-12);
    assert_int_equal(plan->random, 1);
    near(plan->seed, 5, 0);
    assert_int_equal(plan->repeat_first, 1);
    assert_true(acquire_plan_arrange(plan));
    assert_int_equal(plan->n, 6);
    assert_int_equal(plan->run[5].kind, ACQUIRE_FREE);
    for (size_t i = 0; i < plan->n; i++) {
        for (size_t j = 0; j < i; j++) {
            assert_string_not_equal(plan->run[i].name, plan->run[j].name);
        }
    }
    free(plan);
}

/* A key of the file's own that looks like a place in it: the line is found without leaving the text. */
static void test_strange_keys(void **state) {
    static const char *const keys[] = {"x[", "[", "x[0", "x[5][7]", "x]", "..", "[[0]", "runs[0][1].x"};
    acquire_motion options = acquire_motion_none();
    int code;
    (void)state;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        char text[128];
        snprintf(text, sizeof text, "{\"palpate\":{\"protocol\":1},\"runs\":[],\"%s\":1}", keys[i]);
        free(read_protocol(text, &options, &code));
        assert_int_equal(code, CLI_FAILURE);
    }
}

static void test_examples(void **state) {
    static const char *const files[] = {"data/protocols/sedef2008.json", "data/protocols/quick.json",
                                        "data/protocols/dynamic.json"};
    acquire_motion options = acquire_motion_none();
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        acquire_plan *plan = empty_plan();
        assert_int_equal(acquire_plan_read(plan, files[i], &options), CLI_OK);
        assert_true(plan->n > 1 && acquire_plan_arrange(plan));
        free(plan);
    }
    acquire_plan *file = empty_plan(), *built_in = empty_plan();
    char why[ACQUIRE_TEXT];
    assert_int_equal(acquire_plan_read(file, files[0], &options), CLI_OK);
    assert_true(acquire_plan_seed(built_in, &options, why) && acquire_plan_arrange(built_in));
    assert_true(acquire_plan_arrange(file));
    assert_int_equal(file->n, built_in->n);
    for (size_t i = 0; i < file->n; i++) {
        assert_string_equal(file->run[i].name, built_in->run[i].name);
        assert_memory_equal(file->run[i].segment, built_in->run[i].segment, sizeof file->run[i].segment);
    }
    free(file);
    free(built_in);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_ramp_hold),
    cmocka_unit_test(test_kinds),
    cmocka_unit_test(test_thesis_protocol),
    cmocka_unit_test(test_protocol_file),
    cmocka_unit_test(test_strange_keys),
    cmocka_unit_test(test_examples),
    {0},
};
