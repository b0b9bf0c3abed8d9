/* test_hull.c: hulls: what is made of points, the distance to them, and one contact's force and tangent as
 * derivatives of its energy. */
#include "contact_alone.h"
#include "hull_make.h"

static uint64_t seed = 5;

static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

/* ---- what is made of points ------------------------------------------------------------------------ */

/* Corners, edges and faces of a box, a wedge and a cylinder; also of a box with more points on and within
 * it. */
START_TEST(corners_edges_and_faces) {
    static const double more[][3] = {{-1, -2, -3}, {1, -2, -3},   {-1, 2, -3}, {1, 2, -3},
                                     {-1, -2, 3},  {1, -2, 3},    {-1, 2, 3},  {1, 2, 3},
                                     {0, 0, 0},    {1, 0, 0},     {1, 2, 0},   {0.5, 2, 1},
                                     {0, -2, -3},  {0.5, -2, -3}, {1, 2, 3},   {0.1, 1, 2}},
                        wedge[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
    palp_hull *hull[4] = {box_hull(1, 2, 3), NULL, NULL, cylinder_hull(32, 1, 2)};
    static const size_t corners[4] = {8, 8, 6, 64}, edges[4] = {12, 12, 9, 96}, faces[4] = {6, 6, 5, 34};
    ck_assert_int_eq(palp_hull_create(16, more[0], &hull[1], NULL), PALP_OK);
    ck_assert_int_eq(palp_hull_create(6, wedge[0], &hull[2], NULL), PALP_OK);
    for (int i = 0; i < 4; i++) {
        ck_assert_uint_eq(hull[i]->n_corners, corners[i]);
        ck_assert_uint_eq(hull[i]->n_edges, 2 * edges[i]);
        ck_assert_uint_eq(hull[i]->n_faces, faces[i]);
        palp_hull_free(hull[i]);
    }
}
END_TEST

START_TEST(bad_points) {
    double points[65][3] = {{0}};
    palp_hull *hull = NULL;
    palp_error error = {PALP_OK, ""};
    for (int i = 0; i < 65; i++)
        for (int k = 0; k < 3; k++)
            points[i][k] = uniform(-1.0, 1.0);
    ck_assert_int_eq(palp_hull_create(64, points[0], &hull, &error), PALP_OK);
    palp_hull_free(hull);
    hull = NULL;
    ck_assert_int_eq(palp_hull_create(65, points[0], &hull, &error), PALP_ERR_LIMIT);
    ck_assert_ptr_nonnull(strstr(error.text, "at most 64 points, not 65"));
    ck_assert_int_eq(palp_hull_create(3, points[0], &hull, &error), PALP_ERR_ARGUMENT);
    ck_assert_ptr_nonnull(strstr(error.text, "at least 4 points, not 3"));
    points[2][1] = NAN;
    ck_assert_int_eq(palp_hull_create(10, points[0], &hull, &error), PALP_ERR_ARGUMENT);
    ck_assert_ptr_nonnull(strstr(error.text, "point 2"));
    for (int flat = 0; flat < 3; flat++) { /* in a plane, in a line, at one place */
        for (int i = 0; i < 20; i++) {
            const double a = flat < 2 ? uniform(-1.0, 1.0) : 0.5, b = flat < 1 ? uniform(-1.0, 1.0) : 0.0;
            for (int k = 0; k < 3; k++)
                points[i][k] =
                    0.01 * (1.0 + a * (k + 1) + b * (2 - k * k)) + (flat < 2 ? uniform(-1e-9, 1e-9) : 0.0);
        }
        ck_assert_int_eq(palp_hull_create(20, points[0], &hull, &error), PALP_ERR_INPUT);
        ck_assert_ptr_nonnull(strstr(error.text, "lie in a plane"));
    }
    ck_assert_int_eq(palp_hull_create_box((double[]){1, 0, 1}, &hull, NULL), PALP_ERR_INPUT);
    ck_assert_ptr_null(hull);
    palp_hull_free(NULL);
}
END_TEST

/* ---- distance -------------------------------------------------------------------------------------- */

/* Of a box with these half sides: q = |p| - half, then |max(q, 0)| outside and the largest q inside. */
START_TEST(distance_to_a_box) {
    static const double half[3] = {1.0, 2.0, 0.5};
    palp_hull *hull = box_hull(half[0], half[1], half[2]);
    int regions[4] = {0}; /* inside, face, edge, corner */
    for (int trial = 0; trial < 5000; trial++) {
        double p[3], q[3], beyond[3], sign[3];
        int out = 0;
        hull_near near;
        for (int k = 0; k < 3; k++) {
            p[k] = uniform(-2.0, 2.0) * half[k];
            q[k] = fabs(p[k]) - half[k];
            beyond[k] = fmax(q[k], 0.0);
            sign[k] = p[k] < 0.0 ? -1.0 : 1.0;
            out += q[k] > 0.0;
        }
        const double inside = fmax(q[0], fmax(q[1], q[2])), outside = sqrt(dot3(beyond, beyond));
        hull_measure(hull, p, &near);
        ck_assert_double_eq_tol(near.distance, out ? outside : inside, 1e-14);
        ck_assert(near.round == (out > 1));
        for (int k = 0; k < 3; k++) {
            const double normal = out ? beyond[k] / outside : q[k] == inside;
            ck_assert_double_eq_tol(near.normal[k], sign[k] * normal, 1e-12);
            ck_assert_double_eq(fabs(near.along[k]), out == 2 && q[k] <= 0.0 ? 1.0 : 0.0);
        }
        regions[out]++;
    }
    for (int i = 0; i < 4; i++)
        ck_assert_int_gt(regions[i], 100);
    palp_hull_free(hull);
}
END_TEST

/* Of random points. Outside the nearest point is in the hull and no corner is beyond the plane through it.
 * Inside the face's plane holds all corners, and no direction leads out sooner. */
START_TEST(distance_to_any_hull) {
    for (int trial = 0; trial < 100; trial++) {
        double points[20][3], point[3], on[3];
        palp_hull *hull;
        for (int i = 0; i < 60; i++)
            points[i / 3][i % 3] = uniform(-1.0, 1.0);
        ck_assert_int_eq(palp_hull_create(20, points[0], &hull, NULL), PALP_OK);
        for (int k = 0; k < 50; k++) {
            hull_near near;
            double support = -INFINITY;
            for (int i = 0; i < 3; i++)
                point[i] = uniform(-1.5, 1.5);
            hull_measure(hull, point, &near);
            along3(point, -near.distance, near.normal, on);
            ck_assert_double_eq_tol(dot3(near.normal, near.normal), 1.0, 1e-12);
            for (int i = 0; i < 20; i++)
                support = fmax(support, dot3(points[i], near.normal) - dot3(on, near.normal));
            ck_assert_double_eq_tol(support, 0.0, 1e-12);
            for (int d = 0; d < 200; d++) {
                double u[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, far = -INFINITY;
                for (int i = 0; i < 20; i++)
                    far = fmax(far, dot3(points[i], u));
                if (near.distance > 0.0) /* the nearest point is within */
                    ck_assert_double_ge(far - dot3(on, u), -1e-12);
                else
                    ck_assert_double_ge(far - dot3(point, u), (-near.distance - 1e-12) * sqrt(dot3(u, u)));
            }
        }
        palp_hull_free(hull);
    }
}
END_TEST

/* Out of a box by the surface's normal: by a face that it meets, and by one at its side only where that is
 * much nearer. */
START_TEST(exit_of_a_box) {
    palp_hull *hull = box_hull(1.0, 2.0, 0.5);
    const double point[3] = {0.9, -1.5, 0.0};
    const hull_face *aside = hull_exit(hull, point, (const double[]){-1.0, 0.0, 0.0}),
                    *down = hull_exit(hull, point, (const double[]){0.0, 1.0, 0.0}),
                    *slant = hull_exit(hull, point, (const double[]){-0.28, 0.96, 0.0});
    ck_assert_ptr_null(hull_exit(hull, point, (const double[]){0.0, 0.0, 0.0}));
    ck_assert_double_eq_tol(hull_inset(hull, down, point), 0.1, 1e-15);
    ck_assert_double_eq_tol(hull_inset(hull, aside, point), 0.5, 1e-15);
    ck_assert_double_eq(aside->normal[0], 1.0);
    ck_assert_double_eq(down->normal[1], -1.0);
    ck_assert_ptr_eq(slant, aside);
    palp_hull_free(hull);
}
END_TEST

/* ---- force and tangent ------------------------------------------------------------------------------ */

static void place(setting *s, const palp_hull *hull, const double position[3]) {
    palp_tool tool = hull_tool(hull, position[0], position[1], position[2], 0.3, 0.0);
    turn_tool(&tool, (const double[]){0.6, 0.0, 0.8}, 0.7);
    turn_tool(&tool, (const double[]){0.0, 0.28, 0.96}, -2.0);
    place_alone(s, &tool);
}

/* A vector of the hull's frame. */
static void turned(const palp_tool *tool, const double v[3], double out[3]) {
    const palp_tool none = {.shape = PALP_TOOL_HULL};
    double moved[3] = {0.0};
    contact_turn_arm(&none, tool, v, moved);
    along3(v, 1.0, moved, out);
}

/* _i: at a face, an edge, a corner and inside; shallow, where the penalty is quadratic, deep, and with local
 * compliance, of which the last leaves the hull by the face that its surface meets. A point of
 * the box's own frame is put at the point of the triangle. */
START_TEST(pressure_is_the_slope_of_the_energy) {
    static const double at[4][3] = {{0.2, 1.0, 0.3}, {1.0, 1.0, 0.2}, {1.0, 1.0, 1.0}, {0.1, 0.9, 0.2}},
                        out[4][3] = {{0, 1, 0}, {0.6, 0.8, 0}, {0.48, 0.6, 0.64}, {0, 0, 0}};
    palp_hull *hull = box_hull(1, 1, 1);
    const int feature = _i % 4;
    const double depth = _i < 4 ? 0.06 : 0.2; /* smoothing ends at 0.1 */
    double x[9] = {0, 0, 0, 1, 0, 0, 0.5, 0, 0.8}, local[3], point[3];
    setting s;
    place(&s, hull, (const double[]){0, 0, 0});
    contact_point(&s.c, s.c.share, x, point);
    along3(at[feature], 0.3 - depth, out[feature], local);
    turned(&s.tool, local, local);
    along3(point, -1.0, local, local);
    place(&s, hull, local);
    if (_i >= 8)
        s.c.law = (contact_law){.linear = 0.3 * s.c.stiffness, .hard = s.c.stiffness, .limit = 0.13};
    if (_i >= 12) /* it leaves by another face than the nearest */
        turned(&s.tool, (const double[]){-1.0, 0.1, 0.0}, s.c.outward);
    contact_evaluate(&s.set, &s.c, x);
    ck_assert_double_eq_tol(s.c.depth, feature < 3 ? depth : _i < 12 ? 0.4 : 1.2, 1e-12);
    ck_assert(s.c.round == (feature == 1 || feature == 2));
    check_derivatives(&s, x, 1e-8, 1e-7);
    palp_hull_free(hull);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, corners_edges_and_faces);
    tcase_add_test(tc, bad_points);
    tcase_add_test(tc, distance_to_a_box);
    tcase_add_test(tc, distance_to_any_hull);
    tcase_add_test(tc, exit_of_a_box);
    tcase_add_loop_test(tc, pressure_is_the_slope_of_the_energy, 0, 16);
}
