/* test_realtime_tool.c: stepping within a budget under a tool. */
#define _POSIX_C_SOURCE 200809L
#include "realtime_make.h"

/* A sphere comes down on the middle of the top, slides and stays. */
static void place_tool(const palp_realtime *rt, size_t tick, double friction) {
    double down = 0.0016 * fmin(1.0, (double)tick / 60.0),
           aside = tick < 60 ? 0.0 : 2e-5 * (double)(tick - 60);
    palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                      .position_m = {0.5 * HEIGHT + fmin(aside, 8e-4), HEIGHT + 0.0041 - down, 0.51 * HEIGHT},
                      .axis = {0, 1, 0},
                      .radius_m = 0.004,
                      .friction = friction};
    ck_assert_int_eq(palp_network_set_tools(net_of(rt), 1, &tool), PALP_OK);
}

static palp_tool_force tick_with_tool(palp_realtime *rt, size_t tick, const palp_budget *budget,
                                      palp_tick_info *info) {
    palp_tool_force felt;
    place_tool(rt, tick, 0.0);
    ck_assert_int_eq(palp_realtime_step(rt, 0.0, DT, budget, info), PALP_OK);
    ck_assert_int_eq(palp_network_tool_force(net_of(rt), &felt), PALP_OK);
    return felt;
}

/* Converged as by palp_network_step; with two corrections as near as the estimate says, and soon at rest
 * there. */
START_TEST(tool_is_felt) {
    const size_t nodes[] = {5, 8};
    for (size_t k = 0; k < 2; k++) {
        palp_realtime *net = cube_on_a_table(nodes[k], 2), *quick = cube_on_a_table(nodes[k], 2);
        palp_realtime *reference = cube_on_a_table(nodes[k], 2);
        const palp_budget two = {.corrections = 2};
        palp_tool_force a, b, c;
        palp_tick_info info;
        double peak = 0.0, last = 0.0;
        for (size_t i = 1; i < 120; i++) {
            a = tick_with_tool(net, i, &ALL, NULL);
            b = tick_with_tool(quick, i, &two, &info);
            place_tool(reference, i, 0.0);
            ck_assert_int_eq(palp_network_step(net_of(reference), 0.0, DT, NULL), PALP_OK);
            ck_assert_int_eq(palp_network_tool_force(net_of(reference), &c), PALP_OK);
            peak = fmax(peak, fabs(c.force_N[1]));
            for (size_t j = 0; j < 3; j++) {
                ck_assert_double_eq_tol(a.force_N[j], c.force_N[j], 1e-6 * peak + 1e-12);
            }
            last = fabs(b.force_N[1] - c.force_N[1]);
            ck_assert_msg(last <= info.force_error_N + 1e-6 * peak, "tick %zu: off by %g, estimate %g", i,
                          last, info.force_error_N);
        }
        ck_assert_double_le(last, 1e-3 * peak);
        ck_assert_double_gt(peak, 0.1);
        drop(net);
        drop(quick);
        drop(reference);
    }
}
END_TEST

/* A rough sphere that sticks and slips. Its force is that of the tissue: where a correction is not enough for
 * the stiff springs between them, these are off by many times more. */
START_TEST(rough_tool_within_a_tick) {
    const palp_budget few[2] = {{.corrections = 1}, {.corrections = 2}};
    const double most[2] = {0.2, 0.05};
    for (size_t k = 0; k < 2; k++) {
        palp_realtime *net = cube_on_a_table(8, 2), *reference = cube_on_a_table(8, 2);
        double peak = 0.0, error = 0.0;
        for (size_t i = 1; i < 120; i++) {
            palp_tool_force felt[2];
            place_tool(net, i, 0.3);
            place_tool(reference, i, 0.3);
            ck_assert_int_eq(palp_realtime_step(net, 0.0, DT, &few[k], NULL), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(reference, 0.0, DT, &ALL, NULL), PALP_OK);
            ck_assert_int_eq(palp_network_tool_force(net_of(net), &felt[0]), PALP_OK);
            ck_assert_int_eq(palp_network_tool_force(net_of(reference), &felt[1]), PALP_OK);
            peak = fmax(peak, fabs(felt[1].force_N[1]));
            for (size_t j = 0; j < 3; j++)
                error = fmax(error, fabs(felt[0].force_N[j] - felt[1].force_N[j]));
        }
        ck_assert_double_le(error, most[k] * peak);
        drop(net);
        drop(reference);
    }
}
END_TEST

/* A plane that pressed leaves at once at 50 mm/s: the tissue, which is slow to know, must not have lost it
 * meanwhile. */
START_TEST(sudden_withdrawal) {
    const palp_budget two = {.corrections = 2};
    palp_realtime *net = cube_on_a_table(7, 2), *reference = cube_on_a_table(7, 2);
    double peak = 0.0, error = 0.0;
    for (size_t i = 1; i < 180; i++) {
        double down = i < 100 ? 3e-5 * (double)i : 3e-3 - 5e-5 * (double)(i - 100);
        palp_tool tool = {.shape = PALP_TOOL_PLANE, .position_m = {0, HEIGHT - down, 0}, .axis = {0, -1, 0}};
        palp_tool_force felt[2];
        ck_assert_int_eq(palp_network_set_tools(net_of(net), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_set_tools(net_of(reference), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(net, 0.0, DT, &two, NULL), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(reference, 0.0, DT, &ALL, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(net), &felt[0]), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(reference), &felt[1]), PALP_OK);
        peak = fmax(peak, felt[1].force_N[1]);
        error = fmax(error, fabs(felt[0].force_N[1] - felt[1].force_N[1]));
    }
    ck_assert_double_gt(peak, 5.0);
    ck_assert_msg(error < 0.1 * peak, "off by %g of %g N", error, peak);
    drop(net);
    drop(reference);
}
END_TEST

/* A sphere at 100 mm/s on stiff contacts is too fast for two corrections a tick: some ticks make more, so
 * that the force stays near the right one and comes back to it when the sphere has stopped. */
START_TEST(too_fast_for_the_budget) {
    palp_contact_settings stiff = palp_contact_settings_default();
    stiff.stiffness = 200.0;
    stiff.local = false;
    palp_realtime *net = cube_touched(7, 2, &stiff), *reference = cube_touched(7, 2, &stiff);
    const palp_budget two = {.corrections = 2};
    double error = 0.0, last = 0.0, peak = 0.0;
    size_t more = 0;
    for (size_t i = 1; i <= 50; i++) {
        const palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                                .position_m = {0.0121, HEIGHT + 0.005 - fmin(3e-3, 1e-4 * (double)i), 0.0123},
                                .radius_m = 0.005};
        palp_tool_force felt[2];
        palp_tick_info info;
        ck_assert_int_eq(palp_network_set_tools(net_of(net), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_set_tools(net_of(reference), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(net, 0.0, 1e-3, &two, &info), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(reference, 0.0, 1e-3, &ALL, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(net), &felt[0]), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(reference), &felt[1]), PALP_OK);
        last = fabs(felt[0].force_N[1] - felt[1].force_N[1]);
        peak = fmax(peak, fabs(felt[1].force_N[1]));
        error = fmax(error, last);
        more += info.corrections > 2;
        ck_assert_double_le(info.residual, 1.0);
    }
    ck_assert_uint_gt(more, 0);
    ck_assert_uint_lt(more, 25);
    ck_assert_msg(error < 0.15 * peak && last < 1e-3 * peak, "off by %g, at the end by %g, of %g N", error,
                  last, peak);
    drop(net);
    drop(reference);
}
END_TEST

/* One that is taken away altogether is not followed. */
START_TEST(taken_away) {
    const palp_budget two = {.corrections = 2};
    palp_realtime *net = cube_on_a_table(7, 2);
    palp_tool_force felt;
    for (size_t i = 1; i < 70; i++) {
        palp_tool tool = {
            .shape = PALP_TOOL_PLANE, .position_m = {0, HEIGHT - 3e-5 * (double)i, 0}, .axis = {0, -1, 0}};
        if (i > 60)
            tool.position_m[1] = 2.0 * HEIGHT;
        ck_assert_int_eq(palp_network_set_tools(net_of(net), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(net, 0.0, DT, &two, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(net), &felt), PALP_OK);
        ck_assert(i <= 60 ? felt.force_N[1] > 0.0 : felt.force_N[1] == 0.0);
    }
    drop(net);
}
END_TEST

START_TEST(restored_with_tool) {
    const palp_budget two = {.corrections = 2};
    palp_realtime *net = cube_on_a_table(8, 2), *other = cube_on_a_table(8, 2);
    size_t size = palp_realtime_state_size(net);
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    for (size_t i = 1; i < 75; i++)
        tick_with_tool(net, i, &two, NULL);
    ck_assert_int_eq(palp_realtime_save(net, saved, size), PALP_OK);
    for (size_t i = 75; i < 100; i++)
        tick_with_tool(net, i, &two, NULL);
    snapshot end = snapshot_take(net_of(net));
    ck_assert_int_eq(palp_realtime_restore(other, saved, size), PALP_OK);
    for (size_t i = 75; i < 100; i++)
        tick_with_tool(other, i, &two, NULL);
    ck_assert(still_at(net_of(other), &end));
    snapshot_free(&end);
    free(saved);
    drop(net);
    drop(other);
}
END_TEST

/* A tool that goes far within a tick is felt as one that went there slowly; a tick that does not come so far
 * says so; and one that begins inside changes nothing. */
START_TEST(far_in_one_tick) {
    static const double depth = 0.004, radius = 0.003;
    double force[2] = {0.0};
    palp_tool_force felt;
    for (int slow = 0; slow < 2; slow++) {
        palp_realtime *rt = cube_on_a_table(7, 0);
        for (int i = 0; i <= (slow ? 40 : 1); i++) {
            palp_tick_info info;
            const palp_tool tool = {
                .position_m = {0.0121, HEIGHT + radius - depth * i / (slow ? 40 : 1), 0.0121},
                .radius_m = radius};
            ck_assert_int_eq(palp_network_set_tools(net_of(rt), 1, &tool), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(rt, 0.0, 1e-3, &ALL, &info), PALP_OK);
            ck_assert(info.converged);
            ck_assert_int_eq(palp_network_tool_force(net_of(rt), &felt), PALP_OK);
            force[slow] = felt.force_N[1];
        }
        drop(rt);
    }
    ck_assert_double_gt(force[1], 0.5);
    /* how much points beside a triangle count is found once in a tick */
    ck_assert_double_eq_tol(force[0], force[1], 4e-4 * force[1]);
}
END_TEST

START_TEST(begins_inside) {
    palp_realtime *rt = cube_on_a_table(5, 0);
    const palp_tool tool = {.position_m = {0.012, 0.011, 0.013}, .radius_m = 0.001};
    snapshot before = snapshot_take(net_of(rt));
    ck_assert_int_eq(palp_network_set_tools(net_of(rt), 1, &tool), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(rt, 0.0, 1e-3, &ALL, NULL), PALP_ERR_INSIDE);
    ck_assert(still_at(net_of(rt), &before));
    snapshot_free(&before);
    drop(rt);
}
END_TEST

/* A stiff contact at 100 mm/s is more than two corrections follow: no such tick passes for solved, and the
 * estimate is no less than the error. */
START_TEST(too_few_corrections_are_told) {
    palp_contact_settings stiff = palp_contact_settings_default();
    const palp_budget two = {.corrections = 2};
    stiff.stiffness = 200.0;
    palp_realtime *rt = cube_touched(11, 2, &stiff), *exact = cube_touched(11, 2, &stiff);
    for (int i = 1; i <= 20; i++) {
        palp_realtime *both[2] = {rt, exact};
        palp_tick_info info[2];
        palp_tool_force felt[2];
        const palp_tool tool = {.position_m = {0.0081, HEIGHT + 0.005 - 1e-4 * i, 0.0121}, .radius_m = 0.005};
        for (int k = 0; k < 2; k++) {
            ck_assert_int_eq(palp_network_set_tools(net_of(both[k]), 1, &tool), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(both[k], 0.0, 1e-3, k ? &ALL : &two, &info[k]), PALP_OK);
            ck_assert_int_eq(palp_network_tool_force(net_of(both[k]), &felt[k]), PALP_OK);
        }
        const double off = fabs(felt[0].force_N[1] - felt[1].force_N[1]);
        ck_assert(info[1].converged && !info[0].converged);
        ck_assert_double_ge(info[0].force_error_N, off);
    }
    drop(rt);
    drop(exact);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, far_in_one_tick);
    tcase_add_test(tc, begins_inside);
    tcase_add_test(tc, too_few_corrections_are_told);
    tcase_add_test(tc, restored_with_tool);
    tcase_add_test(tc, tool_is_felt);
    tcase_add_test(tc, rough_tool_within_a_tick);
    tcase_add_test(tc, sudden_withdrawal);
    tcase_add_test(tc, too_fast_for_the_budget);
    tcase_add_test(tc, taken_away);
}
