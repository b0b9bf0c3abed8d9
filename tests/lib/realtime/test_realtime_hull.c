/* test_realtime_hull.c: hulls and spinning spheres under a budget of corrections: the estimate holds, and
 * what is saved goes on to the same bits. */
#include "hull_make.h"
#include "realtime_rough.h"

/* Made and freed by each test. */
static palp_hull *box;

/* A box pressed 1.5 mm within 0.2 s, tilted, then dragged at 10 mm/s and turned at 1 rad/s. */
static palp_tool dragged_box(const rough_way *w, double time) {
    const double slid = fmax(0.0, time - 0.2);
    palp_tool tool = hull_tool(box, 0.009 + 0.01 * slid, HEIGHT + 0.0038 - 0.0015 * fmin(1.0, time / 0.2),
                               0.0121, 0.002, w->friction);
    turn_tool(&tool, (const double[]){0.6, 0.0, 0.8}, 0.1);
    turn_tool(&tool, (const double[]){0.0, 1.0, 0.0}, slid);
    return tool;
}

/* A sphere pressed as far, which then spins at 3 rad/s. */
static palp_tool spun_sphere(const rough_way *w, double time) {
    palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                      .position_m = {0.0117, HEIGHT + 0.005 - 0.0015 * fmin(1.0, time / 0.2), 0.0121},
                      .radius_m = 0.005,
                      .friction = w->friction};
    turn_tool(&tool, (const double[]){0.6, 0.0, 0.8}, 3.0 * fmax(0.0, time - 0.2));
    return tool;
}

/* _i: the box or the sphere, without and with friction; on triangles and on a smooth surface. With sharper
 * edges the mesh snaps off them, which a tick may follow later than it says. */
START_TEST(estimate_holds) {
    enum { N = 500 };
    static double truth[N][3];
    static const size_t corrections[] = {1, 2, 6};
    palp_tool (*const tool)(const rough_way *, double) = _i % 2 ? spun_sphere : dragged_box;
    const rough_way way = {.friction = _i / 2 % 2 ? 0.3 : 0.0};
    palp_contact_settings touch = palp_contact_settings_default();
    double mean = INFINITY;
    touch.subdivisions = _i < 4 ? 0 : 2;
    box = box_hull(0.003, 0.002, 0.004);
    palp_realtime *rt = cube_touched(5, 2, &touch);
    rough_truth(rt, tool, &way, N, truth);
    drop(rt);
    ck_assert_double_gt(truth[N - 1][1], 0.1);
    for (size_t b = 0; b < 3; b++) {
        rt = cube_touched(5, 2, &touch);
        const rough_error e = rough_run(rt, tool, &way, N, corrections[b], truth, 1e-6);
        ck_assert_uint_eq(e.beyond, 0);
        ck_assert_double_lt(e.mean, mean);
        mean = e.mean;
        drop(rt);
    }
    ck_assert_double_lt(mean, _i % 4 == 2 ? 1e-3 : 1e-4); /* the box slips and sticks */
    palp_hull_free(box);
}
END_TEST

START_TEST(restored_it_goes_on) {
    const rough_way way = {.friction = 0.3};
    const palp_budget two = {.corrections = 2};
    double force[2][3];
    palp_realtime *rt[2] = {cube_on_a_table(6, 2), cube_on_a_table(6, 2)};
    const size_t size = palp_realtime_state_size(rt[0]);
    void *saved = malloc(size);
    box = box_hull(0.003, 0.002, 0.004);
    for (int i = 1; i <= 400; i++) {
        const palp_tool tool = dragged_box(&way, 1e-3 * i);
        rough_tick(rt[0], &tool, &two, NULL, force[0]);
        if (i == 300) {
            ck_assert_int_eq(palp_realtime_save(rt[0], saved, size), PALP_OK);
            ck_assert_int_eq(palp_realtime_restore(rt[1], saved, size), PALP_OK);
        } else if (i > 300) {
            rough_tick(rt[1], &tool, &two, NULL, force[1]);
            ck_assert(memcmp(force[0], force[1], sizeof force[0]) == 0);
        }
    }
    ck_assert_double_gt(force[0][1], 0.1);
    snapshot end = snapshot_take(net_of(rt[0]));
    ck_assert(still_at(net_of(rt[1]), &end));
    snapshot_free(&end);
    free(saved);
    drop(rt[0]);
    drop(rt[1]);
    palp_hull_free(box);
}
END_TEST

/* Unlimited ticks are static steps. */
START_TEST(ticks_are_steps) {
    const rough_way way = {.friction = 0.3};
    palp_realtime *rt = cube_on_a_table(6, 1), *other = cube_on_a_table(6, 1);
    box = box_hull(0.003, 0.002, 0.004);
    for (int i = 1; i <= 60; i++) {
        const palp_tool tool = dragged_box(&way, 6e-3 * i);
        palp_tool_force tick, step;
        palp_tick_info info;
        ck_assert_int_eq(palp_network_set_tools(net_of(rt), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(rt, 0.0, 6e-3, &ALL, &info), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(rt), &tick), PALP_OK);
        ck_assert_int_eq(palp_network_set_tools(net_of(other), 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_step(net_of(other), 0.0, 6e-3, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net_of(other), &step), PALP_OK);
        ck_assert_double_le(apart(tick.force_N, step.force_N), info.force_error_N + 1e-8);
    }
    drop(rt);
    drop(other);
    palp_hull_free(box);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, estimate_holds, 0, 8);
    tcase_add_test(tc, restored_it_goes_on);
    tcase_add_test(tc, ticks_are_steps);
}
