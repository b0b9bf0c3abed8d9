/* test_contact_point.c: one contact alone: the nearest point, and force and tangent as derivatives of its
 * energy. */
#include "contact_alone.h"

static uint64_t seed;

static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

/* The triangle of the nodes 0, 1, 2, its sides about 1 m, with a corner anywhere near. */
static void random_triangle(double x[9]) {
    static const double equal[9] = {0, 0, 0, 1, 0, 0, 0.5, 0, 0.8};
    for (int i = 0; i < 9; i++)
        x[i] = equal[i] + uniform(-0.2, 0.2);
}

/* Of a convex set the nearest point q to p is the one where (p - q) . (c - q) <= 0 for each corner c. */
START_TEST(nearest_point_of_a_triangle) {
    int regions[8] = {0};
    seed = 3;
    for (int trial = 0; trial < 2000; trial++) {
        double x[9], p[3], share[3], q[3], away[3], to[3];
        const double *corner[3] = {x, x + 3, x + 6};
        random_triangle(x);
        for (int k = 0; k < 3; k++)
            p[k] = uniform(-1.5, 2.5);
        contact_nearest(corner, p, share);
        ck_assert_double_eq_tol(share[0] + share[1] + share[2], 1.0, 1e-12);
        for (int i = 0; i < 3; i++)
            ck_assert_double_ge(share[i], 0.0);
        for (int k = 0; k < 3; k++) {
            q[k] = share[0] * x[k] + share[1] * x[3 + k] + share[2] * x[6 + k];
            away[k] = p[k] - q[k];
        }
        for (int i = 0; i < 3; i++) {
            along3(corner[i], -1.0, q, to);
            ck_assert_double_le(dot3(away, to), 1e-12);
        }
        regions[(share[0] > 0.0) + 2 * (share[1] > 0.0) + 4 * (share[2] > 0.0)]++;
    }
    for (int i = 1; i < 8; i++) /* inside, each edge and each corner have been met */
        ck_assert_int_gt(regions[i], 20);
}
END_TEST

static void place(setting *s, const double position[3], double radius, double friction) {
    palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = radius, .friction = friction};
    memcpy(tool.position_m, position, sizeof tool.position_m);
    place_alone(s, &tool);
}

/* _i: over the face, an edge and a corner; shallow, where the penalty is quadratic, and deep. */
START_TEST(pressure_is_the_slope_of_the_energy) {
    static const double over[3][3] = {{0.45, 0.3, 0.25}, {0.5, 0.25, -0.3}, {-0.35, 0.2, -0.3}};
    static const int corners[3] = {3, 2, 1};
    static const double depth[2] = {0.06, 0.16}; /* smoothing ends at 0.1 */
    seed = 11 + (uint64_t)_i;
    for (int trial = 0; trial < 5; trial++) {
        double x[9] = {0, 0, 0, 1, 0, 0, 0.5, 0, 0.8}; /* its normal is -y: the tool is below */
        for (int i = 0; i < 9; i++)
            x[i] += uniform(-0.03, 0.03);
        double position[3] = {over[_i % 3][0], -over[_i % 3][1], over[_i % 3][2]};
        setting s;
        place(&s, position, 1.0, 0.0);
        contact_measure(&s.tool, &s.c, x);
        place(&s, position, s.c.distance + depth[_i / 3], 0.0);
        contact_evaluate(&s.set, &s.c, x);
        int n = 0;
        for (int k = 0; k < 3; k++)
            n += s.c.share[k] > 0.0;
        ck_assert_int_eq(n, corners[_i % 3]);
        ck_assert_double_eq_tol(s.c.depth, depth[_i / 3], 1e-12);
        check_derivatives(&s, x, 1e-6, 1e-5);
    }
}
END_TEST

/* Motion of the triangle out of the tool along the normal reduces sliding friction by its share of the
 * pressure, but not sticking friction. This is the unsymmetric part of the tangent. */
static void check_drag(const setting *s, const double *x, bool slips) {
    const double out = 1e-3;
    double along[9], moved[9], product[9] = {0.0}, symmetric[9] = {0.0};
    setting then = *s;
    for (int i = 0; i < 9; i++) {
        along[i] = s->c.normal[i % 3];
        moved[i] = x[i] + out * along[i];
    }
    then.set.pose = &then.tool;
    contact_evaluate(&then.set, &then.c, moved);
    contact_times(&s->c, along, symmetric);
    contact_whole_times(&s->c, along, product);
    double largest = 0.0;
    for (int i = 0; i < 9; i++) {
        const double change = s->c.stick_share[i / 3] * (then.c.friction[i % 3] - s->c.friction[i % 3]);
        ck_assert_double_eq_tol(product[i] - symmetric[i], -change / out, 1e-9);
        largest = fmax(largest, fabs(product[i] - symmetric[i]));
    }
    ck_assert(slips ? largest > 0.1 : largest == 0.0);
}

/* Friction's spring is along the surface and as stiff as the penalty for the share of the step that it
 * touched; beyond the coefficient times the pressure it slips. */
START_TEST(friction_sticks_and_slips) {
    const double x[9] = {0, 0, 0, 1, 0, 0, 0.5, 0, 0.8}, position[3] = {0.5, -0.4, 0.3};
    const double pull = 7.0 * 0.75 * 0.05, pressure = 7.0 * (0.2 - 0.05);
    for (int slips = 0; slips < 2; slips++) {
        setting s;
        double coefficient = slips ? 0.4 * pull / pressure : 2.0 * pull / pressure, share = slips ? 0.4 : 1.0;
        place(&s, position, 0.6, coefficient);
        s.c.entry = 0.75;
        contact_point(&s.c, s.c.stick_share, x, s.c.anchor);
        s.c.anchor[0] -= 0.03;
        s.c.anchor[2] -= 0.04;
        s.c.anchor[1] -= 0.5; /* along the normal: has no effect */
        contact_evaluate(&s.set, &s.c, x);
        ck_assert_double_eq_tol(s.c.pressure, pressure, 1e-12);
        static const double along[3] = {0.6, 0.0, 0.8};
        for (int k = 0, i = 0; k < 3; k++) {
            ck_assert_double_eq_tol(s.c.friction[k], -share * pull * along[k], 1e-12);
            ck_assert_double_eq_tol(s.c.stretch[k], share * 0.75 * 0.05 * along[k], 1e-12);
            for (int l = 0; l <= k; l++, i++) {
                double surface = k == l && k != 1, turn = slips ? along[k] * along[l] : 0.0;
                ck_assert_double_eq_tol(s.c.friction_tangent[i], share * 7.0 * 0.75 * (surface - turn),
                                        1e-12);
            }
        }
        check_drag(&s, x, slips);
    }
}
END_TEST

/* Beyond half an edge below the surface a tool has lost it. */
START_TEST(a_tool_far_through_is_lost) {
    const double x[9] = {0, 0, 0, 1, 0, 0, 0.5, 0, 0.8};
    for (int lost = 0; lost < 2; lost++) {
        setting s;
        place(&s, (double[3]){0.5, lost ? 1.02 : 0.98, 0.3}, 0.5, 0.0);
        contact_evaluate(&s.set, &s.c, x);
        ck_assert_double_eq_tol(s.c.distance, lost ? -1.02 : -0.98, 1e-12);
        ck_assert_double_eq_tol(s.c.depth, lost ? 0.0 : 1.48, 1e-12);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, nearest_point_of_a_triangle);
    tcase_add_loop_test(tc, pressure_is_the_slope_of_the_energy, 0, 6);
    tcase_add_test(tc, friction_sticks_and_slips);
    tcase_add_test(tc, a_tool_far_through_is_lost);
}
