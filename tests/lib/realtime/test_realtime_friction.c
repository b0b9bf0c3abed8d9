/* test_realtime_friction.c: friction under a budget of corrections: more of them help, the estimate holds,
 * and what slips is held by Coulomb's law. */
#include "realtime_rough.h"

/* 5 mm in radius, pressed 1.5 mm within 0.3 s, then slid at 10 mm/s by a hand that trembles 0.1 mm at 8 Hz.
 */
static palp_tool trembling(const rough_way *w, double time) {
    double slid = fmax(0.0, time - 0.3);
    palp_tool tool = {
        .shape = PALP_TOOL_SPHERE, .radius_m = 0.005, .friction = w->friction, .axis = {0, 1, 0}};
    tool.position_m[0] = 0.007 + 0.01 * slid + 1e-4 * sin(16.0 * 3.14159265 * slid);
    tool.position_m[1] = HEIGHT + 0.005 - 0.0015 * fmin(1.0, time / 0.3);
    tool.position_m[2] = 0.0121;
    return tool;
}

/* The same hand without its tremor. */
static palp_tool sliding(const rough_way *w, double time) {
    palp_tool tool = trembling(w, fmin(time, 0.3));
    tool.position_m[0] += 0.01 * fmax(0.0, time - 0.3);
    return tool;
}

START_TEST(more_corrections_help) {
    enum { N = 1100, BUDGETS = 7 };
    static double truth[N][3];
    const size_t nodes[] = {5, 7}, corrections[BUDGETS] = {1, 2, 3, 4, 6, 8, 10};
    const double most[BUDGETS] = {0.05, 0.01, 0.002, 5e-4, 3e-5, 2e-6, 1e-7};
    const rough_way way = {.friction = 0.3};
    for (size_t k = 0; k < 2; k++) {
        palp_realtime *rt = cube_on_a_table(nodes[k], 2);
        double before = INFINITY;
        rough_truth(rt, trembling, &way, N, truth);
        drop(rt);
        for (size_t b = 0; b < BUDGETS; b++) {
            rt = cube_on_a_table(nodes[k], 2);
            rough_error e = rough_run(rt, trembling, &way, N, corrections[b], truth, 1e-6);
            ck_assert_uint_eq(e.beyond, 0);
            ck_assert_msg(e.most < most[b] && e.mean <= (b == 1 ? 0.5 : 1.0) * before,
                          "%zu nodes a side, %zu corrections: %g, mean %g after %g", nodes[k], corrections[b],
                          e.most, e.mean, before);
            before = e.mean;
            drop(rt);
        }
    }
}
END_TEST

/* On a subdivided surface and local points the estimate holds as well. One correction leaves less than half
 * the error that it leaves on whole triangles. */
START_TEST(smooth_surface) {
    enum { N = 600 };
    static double truth[N][3];
    const size_t corrections[] = {1, 2, 6};
    const rough_way way = {.friction = 0.3};
    palp_contact_settings touch = palp_contact_settings_default();
    double first[3] = {0.0};
    for (int kind = 0; kind < 3; kind++) {
        touch.subdivisions = kind == 1 ? 2 : 0;
        touch.local = kind == 2;
        palp_realtime *rt = cube_touched(5, 2, &touch);
        rough_truth(rt, trembling, &way, N, truth);
        drop(rt);
        for (size_t b = 0; b < 3; b++) {
            rt = cube_touched(5, 2, &touch);
            rough_error e = rough_run(rt, trembling, &way, N, corrections[b], truth, 1e-6);
            ck_assert_uint_eq(e.beyond, 0);
            first[kind] = b == 0 ? e.mean : first[kind];
            drop(rt);
        }
    }
    ck_assert_double_lt(first[1], 0.5 * first[0]);
    ck_assert_double_lt(first[2], 0.5 * first[0]);
}
END_TEST

/* One correction alone left 3.8 % in the median when its ticks could end with a residual above the forces. */
START_TEST(random_ways) {
    const size_t corrections[] = {1, 2, 6, 10};
    double median[4];
    ck_assert_uint_eq(rough_ways(1, 5, corrections, 4, median), 0);
    ck_assert_double_lt(median[0], 0.03);
    ck_assert_double_lt(median[1], 0.0038);
    for (size_t k = 2; k < 4; k++)
        ck_assert_double_lt(median[k], 0.01 * median[k - 1]);
}
END_TEST

/* All points of a sphere come into contact within a few ticks and stick. Their error of the first contact
 * remains, and is in the estimate. */
START_TEST(what_sticks_at_first_touch_stays) {
    const size_t corrections = 3;
    double median;
    rough_ways(1053, 1054, &corrections, 1, &median);
}
END_TEST

/* A plane that presses and drags the whole top until all of it slips: what holds it back is the coefficient
 * times what presses, to rounding, whatever the budget left of the corrections before. */
START_TEST(plateau) {
    const double friction = 0.2;
    palp_realtime *rt = cube_on_a_table(5, 0);
    palp_tick_info info;
    double force[3];
    for (int i = 1; i <= 400; i++) {
        double aside = fmax(0.0, 2e-5 * (i - 100)), down = 1e-5 * fmin(100.0, i);
        palp_tool tool = {.shape = PALP_TOOL_PLANE,
                          .position_m = {aside, HEIGHT - down, 0.3 * aside},
                          .axis = {0, -1, 0},
                          .friction = friction};
        palp_budget budget = {.corrections = i <= 380 ? 2 : 0};
        rough_tick(rt, &tool, &budget, &info, force);
        double along = hypot(force[0], force[2]);
        if (i > 380) {
            ck_assert(info.converged);
            ck_assert_double_eq_tol(along, friction * force[1], 1e-9 * force[1]);
            ck_assert_double_eq_tol(force[2] / force[0], 0.3, 0.02);
        } else if (i > 300) {
            ck_assert_double_le(fabs(along - friction * force[1]), info.force_error_N + 1e-9);
        }
    }
    drop(rt);
}
END_TEST

/* What friction and arms remember of earlier errors: a few hundred times the error in the median over the
 * ticks in which the tool slides, without trembling, with any number of corrections; never less than the
 * error. */
START_TEST(estimate_while_sliding) {
    enum { N = 700, SLIDES = 450 };
    static double truth[N][3], over[N - SLIDES];
    const size_t corrections[] = {1, 2, 3, 4, 6};
    const rough_way way = {.friction = 0.3};
    palp_realtime *rt = cube_on_a_table(7, 2);
    rough_truth(rt, sliding, &way, N, truth);
    drop(rt);
    for (size_t b = 0; b < 5; b++) {
        const palp_budget budget = {.corrections = corrections[b]};
        rt = cube_on_a_table(7, 2);
        for (int i = 0; i < N; i++) {
            palp_tool tool = sliding(&way, 1e-3 * (i + 1));
            palp_tick_info info;
            double force[3];
            rough_tick(rt, &tool, &budget, &info, force);
            ck_assert_double_le(apart(force, truth[i]), info.force_error_N + 1e-9);
            if (i >= SLIDES)
                over[i - SLIDES] = info.force_error_N / apart(force, truth[i]);
        }
        qsort(over, N - SLIDES, sizeof *over, ascending);
        ck_assert_msg(over[(N - SLIDES) / 2] < 600.0, "%zu corrections: %g times the error", corrections[b],
                      over[(N - SLIDES) / 2]);
        drop(rt);
    }
}
END_TEST

/* A spring that just slips from tick to tick has the error of its last slip, not the sum of all: a tool that
 * stays after a slide is followed within its budget in a few corrections. */
START_TEST(a_tool_that_stays) {
    enum { N = 900, STAYS = 600 };
    const rough_way way = {.friction = 0.3};
    const palp_budget budget = {.force_error = 1e-3};
    palp_realtime *rt = cube_on_a_table(7, 2);
    size_t corrections = 0;
    for (int i = 0; i < N; i++) {
        palp_tool tool = sliding(&way, 1e-3 * fmin(i + 1, STAYS));
        palp_tick_info info;
        double force[3];
        rough_tick(rt, &tool, &budget, &info, force);
        corrections += i >= STAYS ? info.corrections : 0;
    }
    ck_assert_uint_le(corrections, 2 * (N - STAYS));
    drop(rt);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, estimate_while_sliding);
    tcase_add_test(tc, a_tool_that_stays);
    tcase_add_test(tc, more_corrections_help);
    tcase_add_test(tc, smooth_surface);
    tcase_add_test(tc, random_ways);
    tcase_add_test(tc, what_sticks_at_first_touch_stays);
    tcase_add_test(tc, plateau);
}
