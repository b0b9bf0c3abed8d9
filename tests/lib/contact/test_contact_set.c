/* test_contact_set.c: tools over one or two triangles by hand: the contacts, their stiffness, the start of
 * friction's springs and the force on the tool. */
#include "contact/contact_internal.h"

#include <check.h>
#include <string.h>

/* A square of 1 m in the plane y = 0, outward is up; its first triangle's middle is (1/3, 0, 1/3). */
static const double PLACE[12] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 1};
static const int32_t TRIANGLE[6] = {0, 1, 2, 1, 3, 2};
static const double UNIT[4] = {1.0, 2.0, 3.0, 5.0};
static const double EDGE[2] = {(2.0 + 1.4142135623730951) / 3.0, (4.0 + 2.0 * 1.4142135623730951) / 6.0};
enum { TOOLS = 2 };

typedef struct surface {
    arena memory;
    contact_set set;
    double x[12];
} surface;

static void make(surface *s, size_t n_triangles) {
    palp_contact_settings settings = {.stiffness = 20.0, .grasp_stiffness = 1.0, .smoothing = 0.01};
    memset(s, 0, sizeof *s);
    memcpy(s->x, PLACE, sizeof s->x);
    ck_assert_int_eq(
        contact_set_create(&s->set, &s->memory, 4, PLACE, n_triangles, TRIANGLE, UNIT, 9.0, TOOLS, &settings),
        PALP_OK);
    s->set.modulus = 0.25;
    ck_assert_double_eq_tol(s->set.edge, EDGE[n_triangles - 1], 1e-12);
}

static palp_tool sphere(double x, double y, double z, double radius) {
    return (palp_tool){
        .shape = PALP_TOOL_SPHERE, .position_m = {x, y, z}, .radius_m = radius, .friction = 0.3};
}

/* The contacts of one tool at a share of its way, evaluated. */
static size_t meet(surface *s, const palp_tool *tool, double share) {
    double force[12] = {0.0}, squares = 0.0;
    ck_assert_int_eq(contact_set_tools(&s->set, 1, tool), PALP_OK);
    contact_set_place(&s->set, share, PLACE, s->x);
    contact_set_evaluate(&s->set, s->x, force, &squares);
    return s->set.n_contacts;
}

static void commit(surface *s) {
    contact_set_finish(&s->set, s->x);
    contact_set_swap(&s->set);
}

/* Each node's stiffness is shared by the triangles that meet in it. */
START_TEST(a_triangle_is_as_stiff_as_its_share_of_its_nodes) {
    static const double alone = 20.0 * 0.25 * (1.0 + 2.0 + 3.0),
                        shared = 20.0 * 0.25 * (1.0 + 2.0 / 2 + 3.0 / 2);
    for (size_t n = 1; n <= 2; n++) {
        surface s;
        make(&s, n);
        palp_tool tool = sphere(0.2, 0.1, 0.2, 0.11);
        ck_assert_uint_eq(meet(&s, &tool, 1.0), n);
        ck_assert_double_eq_tol(s.set.contact[0].stiffness, n == 1 ? alone : shared, 1e-12);
        arena_free(&s.memory);
    }
}
END_TEST

/* Beside the edge on the axis x, seen from it at an angle to the surface's normal of this cosine. */
START_TEST(a_contact_from_the_side_fades) {
    static const double cosine[] = {0.8, 0.5, 0.4, 0.1, -0.1}, factor[] = {1.0, 1.0, 0.896, 0.104, 0.0};
    for (size_t i = 0; i < 5; i++) {
        surface s;
        make(&s, 1);
        double across = sqrt(1.0 - cosine[i] * cosine[i]);
        palp_tool tool = sphere(0.4, 0.3 * cosine[i], -0.3 * across, 0.31);
        ck_assert_uint_eq(meet(&s, &tool, 1.0), factor[i] > 0.0);
        if (factor[i] > 0.0)
            ck_assert_double_eq_tol(s.set.contact[0].stiffness, factor[i] * 30.0, 1e-12);
        arena_free(&s.memory);
    }
}
END_TEST

/* Half an edge from the tool's surface, and as far as it has come in this step, over the face and beyond each
 * corner. */
START_TEST(contacts_are_looked_for_within_reach) {
    static const double from[4][3] = {{0.25, 0.0, 0.25}, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    static const double to[4][3] = {{0, 1, 0}, {-0.48, 0.6, -0.64}, {-0.48, 0.6, 0.64}, {0.64, 0.6, -0.48}};
    for (int known = 0; known < 2; known++)
        for (int place = 0; place < 4; place++)
            for (int out = 0; out < 2; out++) {
                surface s;
                make(&s, 1);
                double way = 0.2 + (0.5 * EDGE[0] + 0.3 * known) * (out ? 1.001 : 0.999), at[3];
                palp_tool before, tool;
                along3(from[place], way, to[place], at);
                tool = before = sphere(at[0], at[1], at[2], 0.2);
                along3(at, 0.3, (double[]){0.6, 0.0, 0.8}, before.position_m);
                if (known) {
                    meet(&s, &before, 1.0);
                    commit(&s);
                }
                ck_assert_uint_eq(meet(&s, &tool, 1.0), !out);
                arena_free(&s.memory);
            }
}
END_TEST

static palp_tool capsule(const double position[3], const double axis[3], double length, double radius) {
    palp_tool tool = {.shape = PALP_TOOL_CAPSULE, .length_m = length, .radius_m = radius, .friction = 0.3};
    memcpy(tool.position_m, position, sizeof tool.position_m);
    memcpy(tool.axis, axis, sizeof tool.axis);
    return tool;
}

/* A capsule touches with its nearer end; flat on a triangle as near to over its middle as it
 * reaches. */
START_TEST(a_capsule_touches_at_one_place) {
    static const struct {
        double position[3], axis[3], along;
    } made[] = {
        {{0.2, 0.2, 0.3}, {0.6, 0.8, 0.0}, 0.0},
        {{0.2, 0.52, 0.3}, {0.6, -0.8, 0.0}, 0.4},
        {{0.2, 0.1, 0.3}, {1, 0, 0}, 1.0 / 3.0 - 0.2},
        {{0.1, 0.1, 0.3}, {0, 0, 1}, 1.0 / 3.0 - 0.3},
        {{0.9, 0.1, 0.3}, {-1, 0, 0}, 0.4},
        {{-0.05, 0.1, 0.3}, {1, 0, 0}, 1.0 / 3.0 + 0.05},
    };
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) {
        surface s;
        make(&s, 1);
        palp_tool tool = capsule(made[i].position, made[i].axis, 0.4, 0.15);
        ck_assert_uint_eq(meet(&s, &tool, 1.0), 1);
        ck_assert_double_eq_tol(s.set.contact[0].along, made[i].along, 1e-3 * 0.4);
        arena_free(&s.memory);
    }
    surface s;
    make(&s, 1);
    palp_tool needle =
        capsule((double[]){-9.8, 0.1, 0.3}, (double[]){1, 0, 0}, 10.0, 0.15); /* its end is near */
    ck_assert_uint_eq(meet(&s, &needle, 1.0), 1);
    ck_assert_double_eq(s.set.contact[0].along, 10.0);
    arena_free(&s.memory);
}
END_TEST

START_TEST(a_share_of_the_way_is_straight_and_turns) {
    surface s;
    make(&s, 1);
    palp_tool was = capsule((double[]){0.0, 2.0, 0.0}, (double[]){1, 0, 0}, 0.4, 0.1);
    palp_tool is = capsule((double[]){0.4, 2.4, 0.8}, (double[]){0, 0, 1}, 0.4, 0.1);
    meet(&s, &was, 1.0);
    commit(&s);
    ck_assert(contact_set_way(&s.set) == 0.0);
    meet(&s, &is, 0.25);
    ck_assert_double_gt(contact_set_way(&s.set), 1.0);
    static const double position[3] = {0.1, 2.1, 0.2}, axis[3] = {0.75, 0.0, 0.25};
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(s.set.pose[0].position_m[k], position[k], 1e-12);
        ck_assert_double_eq_tol(s.set.pose[0].axis[k], axis[k] / sqrt(0.625), 1e-12);
    }
    arena_free(&s.memory);
}
END_TEST

/* A sphere comes from 0.03 above the surface to 0.01 below it and 0.05 along it: touching for a quarter of
 * the step, its spring is taken along from the place where the surface was. */
START_TEST(friction_begins_where_the_tool_came_from) {
    surface s;
    make(&s, 1);
    palp_tool was = sphere(0.25, 0.23, 0.25, 0.2), is = sphere(0.30, 0.19, 0.25, 0.2);
    meet(&s, &was, 1.0);
    commit(&s);
    ck_assert_uint_eq(meet(&s, &is, 1.0), 1);
    const contact *c = &s.set.contact[0];
    static const double anchor[3] = {0.35, -0.04, 0.25};
    ck_assert(!c->touched);
    ck_assert_double_eq_tol(c->entry, 0.25, 1e-12);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(c->anchor[k], anchor[k], 1e-12);
    /* it slips; what the spring still has is taken along in the next step */
    double slipped = 0.3 * c->pressure / c->stiffness;
    ck_assert_double_eq_tol(c->stretch[0], -slipped, 1e-12);
    commit(&s);
    palp_tool next = sphere(0.31, 0.19, 0.27, 0.2);
    meet(&s, &next, 1.0);
    ck_assert(s.set.contact[0].touched);
    ck_assert_double_eq_tol(s.set.contact[0].entry, 1.0, 1e-12);
    ck_assert_double_eq_tol(s.set.contact[0].anchor[0], 0.31 + 0.01 + slipped, 1e-12);
    ck_assert_double_eq_tol(s.set.contact[0].anchor[2], 0.27 + 0.02, 1e-12);
    arena_free(&s.memory);
}
END_TEST

/* A capsule that turns about the vertical by an angle of sine 0.6 about its position and moves: so does the
 * anchor. */
START_TEST(friction_turns_with_a_capsule) {
    surface s;
    make(&s, 1);
    const double position[3] = {0.2, 0.09, 0.3}, moved[3] = {0.01, 0.0, 0.02};
    double to[3];
    along3(position, 1.0, moved, to);
    palp_tool was = capsule(position, (double[]){1, 0, 0}, 0.4, 0.1),
              is = capsule(to, (double[]){0.8, 0, 0.6}, 0.4, 0.1);
    meet(&s, &was, 1.0);
    commit(&s);
    ck_assert_uint_eq(meet(&s, &is, 1.0), 1);
    const contact *c = &s.set.contact[0];
    double arm[3], point[3];
    contact_point(c, c->stick_share, PLACE, point);
    along3(point, -1.0, position, arm);
    double turned[3] = {0.8 * arm[0] - 0.6 * arm[2], arm[1], 0.6 * arm[0] + 0.8 * arm[2]};
    ck_assert_double_gt(fabs(arm[0]), 0.05);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(c->anchor[k], to[k] + turned[k], 1e-12);
    arena_free(&s.memory);
}
END_TEST

/* Normal force and friction on a capsule, and their moment about its position. */
START_TEST(a_tool_feels_force_and_moment) {
    surface s;
    make(&s, 1);
    palp_tool was = capsule((double[]){0.2, 0.3, 0.3}, (double[]){1, 0, 0}, 0.4, 0.1), is = was;
    is.position_m[1] = 0.08;
    is.position_m[2] += 0.04;
    meet(&s, &was, 1.0);
    commit(&s);
    meet(&s, &is, 1.0);
    double pressure = 30.0 * (0.02 - 0.5 * 0.01 * EDGE[0]), drag = 30.0 * 0.02 / 0.22 * 0.04;
    ck_assert_double_lt(drag, 0.3 * pressure); /* it sticks */
    commit(&s);
    const palp_tool_force *felt = &s.set.now.felt[0];
    double along = 1.0 / 3.0 - 0.2;
    ck_assert_uint_eq(felt->contacts, 1);
    ck_assert_double_eq_tol(felt->depth_m, 0.02, 1e-12);
    double force[3] = {0.0, pressure, -drag}, arm[3] = {along, -0.08, 0.0}, moment[3];
    cross3(arm, force, moment);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(felt->force_N[k], force[k], 1e-9);
        ck_assert_double_eq_tol(felt->moment_Nm[k], moment[k], 1e-3 * pressure * 0.4);
    }
    arena_free(&s.memory);
}
END_TEST

/* The far end of a capsule comes into reach by its turn alone. */
START_TEST(a_capsule_reaches_as_far_as_it_turns) {
    for (int turns = 0; turns < 2; turns++) {
        surface s;
        make(&s, 1);
        palp_tool was = capsule((double[]){0, 0, 0}, (double[]){0.8, -0.6, 0}, 0.3, 0.1), is = was;
        if (turns)
            memcpy(is.axis, (double[]){0.6, -0.8, 0}, sizeof is.axis);
        double reach = 0.5 * EDGE[0] + (turns ? 0.3 * sqrt(0.08) : 0.0);
        for (int out = 0; out < 2; out++) {
            double end[3] = {0.2, 0.1 + (out ? 1.001 : 0.999) * reach, 0.3};
            along3(end, -is.length_m, is.axis, is.position_m);
            memcpy(was.position_m, is.position_m, sizeof was.position_m);
            contact_set_reset(&s.set);
            meet(&s, &was, 1.0);
            commit(&s);
            ck_assert_uint_eq(meet(&s, &is, 1.0), !out);
        }
        arena_free(&s.memory);
    }
}
END_TEST

/* From above a tool may go half an edge through the face. One that begins below it is no contact; one that is
 * new has its stiffness by its share of the step. */
START_TEST(a_tool_far_through_or_from_below_is_none) {
    static const double through[] = {0.4, 0.6};
    for (int i = 0; i < 4; i++) {
        surface s;
        make(&s, 1);
        palp_tool above = sphere(0.25, 0.3, 0.25, 0.2),
                  is = sphere(0.25, -through[i % 2] * EDGE[0], 0.25, 0.2);
        if (i < 2) {
            meet(&s, &above, 1.0);
            commit(&s);
        }
        ck_assert_uint_eq(meet(&s, &is, 1.0), i == 0);
        arena_free(&s.memory);
    }
    surface s;
    make(&s, 1);
    palp_tool tool = sphere(0.25, 0.19, 0.25, 0.2);
    ck_assert_uint_eq(meet(&s, &tool, 0.25), 1);
    ck_assert_double_eq_tol(s.set.contact[0].stiffness, 0.25 * 30.0, 1e-12);
    arena_free(&s.memory);
}
END_TEST

/* A sliver whose height is a millionth of its edge is a triangle, of a billionth of an edge none; however
 * large the mesh. */
START_TEST(slivers_are_triangles) {
    for (int none = 0; none < 2; none++) {
        surface s;
        make(&s, 1);
        for (int i = 0; i < 9; i++)
            s.x[i] = 1e-3 * PLACE[i];
        s.x[6] = (none ? 0.9e-9 : 1e-6) * 1e-3;
        s.set.edge *= 1e-3;
        palp_tool tool = sphere(0.25 * s.x[6], 2e-4, 0.5e-3, 3e-4);
        ck_assert_uint_eq(meet(&s, &tool, 1.0), !none);
        arena_free(&s.memory);
    }
}
END_TEST

/* The triangle moves under a capsule that lies on it: the place along a capsule is looked for again once it
 * is 0.1 of an edge from where it was. */
START_TEST(a_place_that_slid_is_looked_for_again) {
    for (int far = 0; far < 2; far++) {
        surface s;
        make(&s, 1);
        palp_tool tool = capsule((double[]){0.1, 0.09, 0.3}, (double[]){1, 0, 0}, 0.4, 0.1);
        meet(&s, &tool, 1.0);
        double was = s.set.contact[0].along, move = (far ? 0.11 : 0.09) * EDGE[0];
        for (int i = 0; i < 3; i++)
            s.x[3 * i] -= move;
        ck_assert_int_eq(contact_set_refresh(&s.set, PLACE, s.x), far);
        ck_assert_double_eq_tol(s.set.contact[0].along, far ? was - move : was, 2e-3 * 0.4);
        arena_free(&s.memory);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_triangle_is_as_stiff_as_its_share_of_its_nodes);
    tcase_add_test(tc, a_contact_from_the_side_fades);
    tcase_add_test(tc, contacts_are_looked_for_within_reach);
    tcase_add_test(tc, a_capsule_touches_at_one_place);
    tcase_add_test(tc, a_share_of_the_way_is_straight_and_turns);
    tcase_add_test(tc, friction_begins_where_the_tool_came_from);
    tcase_add_test(tc, friction_turns_with_a_capsule);
    tcase_add_test(tc, a_tool_feels_force_and_moment);
    tcase_add_test(tc, a_capsule_reaches_as_far_as_it_turns);
    tcase_add_test(tc, a_tool_far_through_or_from_below_is_none);
    tcase_add_test(tc, slivers_are_triangles);
    tcase_add_test(tc, a_place_that_slid_is_looked_for_again);
}
