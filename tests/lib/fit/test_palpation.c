/* test_palpation.c: a ball or a layer hidden in a small cube. check: once */
#include "network_make.h"

#include <palpate/palpation.h>

#include <stdlib.h>
#include <string.h>

enum { GRID = 4, PRESSES = GRID * GRID };

typedef struct tissue {
    palp_mesh_source source;
    palp_model model;
    palp_mesh *mesh;
} tissue;

static void make(tissue *t, size_t nodes, double side, double stiffness, const palp_region *ball) {
    memset(t, 0, sizeof *t);
    t->source = (palp_mesh_source){.kind = PALP_MESH_LATTICE,
                                   .nodes = {nodes, nodes, nodes},
                                   .size_m = {side, side, side},
                                   .neighbourhood = PALP_NEIGHBOURS_26,
                                   .scaling = PALP_SCALING_CONTINUUM,
                                   .n_regions = ball != NULL};
    if (ball)
        t->source.regions[0] = *ball;
    t->model = (palp_model){.kind = PALP_MODEL_NETWORK, .mesh = &t->source};
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness, &t->model.material.law), PALP_OK);
    ck_assert_int_eq(palp_model_mesh(&t->model, &t->mesh, NULL), PALP_OK);
}

/* How a cube is pressed: places a side; so many depths up to a share of the side; the sphere's radius as such
 * a share; nodes a side; noise of the forces' logarithms. */
typedef struct plan {
    int grid, n_depths;
    double depth, radius;
    size_t nodes;
    double noise;
} plan;

/* Nearly normal: the sum of twelve uniform numbers. */
static double random_normal(unsigned *state) {
    double sum = 0.0;
    for (int k = 0; k < 12; k++) {
        *state = *state * 1664525u + 1013904223u;
        sum += *state / 4294967296.0 - 0.5;
    }
    return sum;
}

/* A map of a cube of this side with the region, forces times factor. */
static void map_by_plan(const plan *by, double side, double stiffness, double factor,
                        const palp_region *hidden, palp_palpation_press *map) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_contact_settings contact = palp_contact_settings_default();
    palp_network *net = NULL;
    tissue t;
    unsigned state = 1;
    make(&t, by->nodes, side, stiffness, hidden);
    contact.subdivisions = 1;
    ck_assert_int_eq(palp_network_from_model(&t.model, t.mesh, 1, &bottom, NULL, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &contact), PALP_OK);
    for (int i = 0; i < by->grid * by->grid * by->n_depths; i++) {
        palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = by->radius * side};
        const int place = i / by->n_depths;
        const double depth = by->depth * side * (1 + i % by->n_depths) / by->n_depths,
                     apart = 0.6 / (by->grid - 1);
        double sum = 0.0;
        tool.position_m[0] = side * (0.2 + apart * (place / by->grid));
        tool.position_m[1] = side + tool.radius_m;
        tool.position_m[2] = side * (0.2 + apart * (place % by->grid));
        map[i] = (palp_palpation_press){.tool = tool, .depth_m = depth};
        palp_network_reset(net);
        for (int k = 2; k <= 4; k++) {
            palp_tool_force felt;
            tool.position_m[1] = side + tool.radius_m - 0.25 * depth * k;
            ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
            ck_assert_int_eq(palp_network_tool_force(net, &felt), PALP_OK);
            sum += felt.force_N[1] * (k == 3 ? 4.0 : 1.0) / 6.0;
        }
        map[i].force_N = factor * sum * exp(by->noise * random_normal(&state));
    }
    palp_network_free(net);
    palp_mesh_free(t.mesh);
}

static void map_of(double side, double stiffness, double factor, const palp_region *ball,
                   palp_palpation_press map[PRESSES]) {
    const plan by = {GRID, 1, 0.08, 0.2, 8, 0.0};
    map_by_plan(&by, side, stiffness, factor, ball, map);
}

static palp_region ball_in(double side, double stiffness) {
    return (palp_region){.name = "hidden",
                         .shape = PALP_REGION_SPHERE,
                         .centre_m = {0.35 * side, 0.7 * side, 0.6 * side},
                         .radius_m = 0.2 * side,
                         .stiffness = stiffness};
}

/* Candidates are the map's places, pressed by deeper times its depth. */
static palp_palpation look(double side, double stiffness, double factor, double ball_stiffness,
                           size_t n_candidates, double deeper) {
    const palp_region ball = ball_in(side, ball_stiffness);
    palp_palpation_settings settings = palp_palpation_settings_default();
    palp_palpation_press map[PRESSES], candidate[PRESSES];
    palp_palpation found;
    palp_error error = {PALP_OK, ""};
    tissue t;
    map_of(side, stiffness, factor, ball_stiffness == 1.0 ? NULL : &ball, map);
    make(&t, 5, side, stiffness, NULL);
    settings.contact.subdivisions = 1;
    settings.n_candidates = n_candidates;
    settings.candidate = candidate;
    memcpy(candidate, map, sizeof map);
    for (size_t i = 0; i < n_candidates; i++)
        candidate[i].depth_m *= deeper;
    const palp_status status = palp_palpate(&t.model, t.mesh, PRESSES, map, &settings, &found, &error);
    ck_assert_msg(!status, "%s", error.text);
    palp_mesh_free(t.mesh);
    return found;
}

/* A stiff ball is found where it is, and the next press is above it rather than in the far corner. */
START_TEST(ball_is_found) {
    const palp_palpation p = look(0.024, 8.0, 1.3, 8.0, PRESSES, 1.0);
    ck_assert_msg(p.found, "evidence %g", p.evidence);
    ck_assert_int_eq(p.kind, PALP_PALPATION_BALL);
    ck_assert_double_eq_tol(p.x_m.best, 0.35 * 0.024, 0.003);
    ck_assert_double_eq_tol(p.z_m.best, 0.6 * 0.024, 0.003);
    ck_assert_double_gt(p.stiffness.best, 1.0);
    ck_assert(p.x_m.low < p.x_m.high && p.radius_m.low < p.radius_m.high);
    ck_assert_double_lt(p.scatter_found, 0.5 * p.scatter);
    ck_assert_double_eq_tol(p.gain, 1.3, 0.2);
    ck_assert_uint_lt(p.next, PRESSES);
}
END_TEST

/* Without a ball the evidence is against one. Candidates that press through the cube have no information. */
START_TEST(none_is_found) {
    const palp_palpation p = look(0.024, 8.0, 1.0, 1.0, 2, 30.0);
    ck_assert_msg(!p.found, "evidence %g", p.evidence);
    ck_assert_int_eq(p.kind, PALP_PALPATION_NONE);
    ck_assert_uint_eq(p.next, 2);
}
END_TEST

/* Lengths, stiffness and the forces' unit times factors change nothing else. */
START_TEST(units_do_not_matter) {
    const palp_palpation one = look(0.024, 8.0, 1.0, 8.0, 0, 1.0), two = look(0.6, 3000.0, 7.0, 8.0, 0, 1.0);
    ck_assert_double_eq_tol(two.evidence, one.evidence, 0.02);
    ck_assert_double_eq_tol(two.x_m.best / 0.6, one.x_m.best / 0.024, 1e-3);
    ck_assert_double_eq_tol(two.y_m.high / 0.6, one.y_m.high / 0.024, 1e-2);
    ck_assert_double_eq_tol(two.stiffness.best, one.stiffness.best, 1e-6);
    ck_assert_double_eq_tol(two.gain / 7.0, one.gain, 1e-2);
    ck_assert_uint_eq(one.next, 0);
}
END_TEST

/* ---- layers --------------------------------------------------------------------------------------- */

/* Looks in a map with noise of 0.5 %. The sphere is large, as the smallest depth must be felt by the lattice.
 */
static palp_palpation look_for_layer(const palp_region *hidden, int n_depths, bool gain_known) {
    static const double SIDE = 0.024, STIFFNESS = 8.0;
    const plan by = {n_depths > 1 ? 3 : GRID, n_depths, 0.1, 0.35, 9, 0.005};
    palp_palpation_settings settings = palp_palpation_settings_default();
    palp_palpation_press map[2 * PRESSES];
    palp_palpation found;
    palp_error error = {PALP_OK, ""};
    tissue t;
    map_by_plan(&by, SIDE, STIFFNESS, gain_known ? 1.0 : 1.3, hidden, map);
    make(&t, 6, SIDE, STIFFNESS, NULL);
    settings.contact.subdivisions = 1;
    settings.gain_known = gain_known;
    const palp_status status = palp_palpate(&t.model, t.mesh, (size_t)(by.grid * by.grid * n_depths), map,
                                            &settings, &found, &error);
    ck_assert_msg(!status, "%s", error.text);
    palp_mesh_free(t.mesh);
    return found;
}

static palp_region layer_of(double thickness, double stiffness) {
    return (palp_region){.name = "hidden",
                         .shape = PALP_REGION_BOX,
                         .low_m = {-1.0, 0.024 - thickness, -1.0},
                         .high_m = {1.0, 1.0, 1.0},
                         .stiffness = stiffness};
}

/* By two depths, a stiff layer and a soft one, whatever the gain. */
START_TEST(layer_is_found) {
    static const double FACTOR[] = {5.0, 0.2};
    const palp_region layer = layer_of(0.006, FACTOR[_i]);
    const palp_palpation p = look_for_layer(&layer, 2, false);
    ck_assert_msg(p.kind == PALP_PALPATION_LAYER, "ball %g, layer %g", p.evidence, p.evidence_layer);
    ck_assert(p.found);
    ck_assert_double_gt(p.evidence_layer, p.evidence + 3.0);
    ck_assert((p.layer_stiffness.best > 1.0) == (FACTOR[_i] > 1.0));
    ck_assert_msg(p.thickness_m.low <= 0.006 && 0.006 <= p.thickness_m.high, "thickness %g (%g to %g)",
                  p.thickness_m.best, p.thickness_m.low, p.thickness_m.high);
    ck_assert_msg(p.layer_stiffness.low <= FACTOR[_i] && FACTOR[_i] <= p.layer_stiffness.high,
                  "stiffness %g (%g to %g)", p.layer_stiffness.best, p.layer_stiffness.low,
                  p.layer_stiffness.high);
    ck_assert_double_lt(p.scatter_layer, 0.5 * p.scatter);
}
END_TEST

/* Two depths without a layer; and one above a ball is no layer. */
START_TEST(no_layer_is_found) {
    const palp_region ball = ball_in(0.024, 8.0);
    const palp_palpation none = look_for_layer(NULL, 2, false), round = look_for_layer(&ball, 2, false);
    ck_assert_msg(!none.found, "ball %g, layer %g", none.evidence, none.evidence_layer);
    ck_assert_msg(round.kind == PALP_PALPATION_BALL, "ball %g, layer %g", round.evidence,
                  round.evidence_layer);
}
END_TEST

/* One depth does if the gain is known; it is known but for the lattice's own error. */
START_TEST(known_gain) {
    const palp_region layer = layer_of(0.006, 5.0);
    const palp_palpation p = look_for_layer(&layer, 1, true), none = look_for_layer(NULL, 1, true);
    ck_assert_msg(p.kind == PALP_PALPATION_LAYER, "ball %g, layer %g", p.evidence, p.evidence_layer);
    ck_assert_double_eq_tol(p.thickness_m.best, 0.006, 0.0025);
    ck_assert_double_eq_tol(log(p.layer_stiffness.best), log(5.0), 0.6);
    ck_assert_double_eq_tol(p.gain_layer, 1.0, 0.1);
    ck_assert_msg(!none.found, "ball %g, layer %g", none.evidence, none.evidence_layer);
}
END_TEST

static int stop(void *user, double share) {
    *(double *)user = share;
    return 1;
}

START_TEST(refused) {
    palp_palpation_press map[PRESSES];
    palp_palpation_settings settings = palp_palpation_settings_default();
    palp_palpation p;
    palp_error error;
    double share = 0.0;
    tissue t;
    map_of(0.024, 8.0, 1.0, NULL, map);
    make(&t, 4, 0.024, 8.0, NULL);
    ck_assert_int_eq(palp_palpate(&t.model, t.mesh, 7, map, &settings, &p, &error), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(error.text, "a map needs at least 8 presses");
    settings.false_alarm = 1.0;
    ck_assert_int_eq(palp_palpate(&t.model, t.mesh, PRESSES, map, &settings, &p, &error), PALP_ERR_ARGUMENT);
    settings.false_alarm = 0.05;
    map[3].force_N = -1.0;
    ck_assert_int_eq(palp_palpate(&t.model, t.mesh, PRESSES, map, &settings, &p, &error), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(error.text, "press 4: needs a sphere, a depth and a force above 0");
    map[3].force_N = map[4].force_N;
    map[5].tool.shape = PALP_TOOL_PLANE;
    ck_assert_int_eq(palp_palpate(&t.model, t.mesh, PRESSES, map, &settings, &p, &error), PALP_ERR_ARGUMENT);
    map[5].tool.shape = PALP_TOOL_SPHERE;
    t.model.density_kg_m3 = 1000.0;
    ck_assert_int_eq(palp_palpate(&t.model, t.mesh, PRESSES, map, &settings, &p, &error),
                     PALP_ERR_UNSUPPORTED);
    t.model.density_kg_m3 = 0.0;
    settings.progress = stop;
    settings.user = &share;
    ck_assert_int_eq(palp_palpate(&t.model, t.mesh, PRESSES, map, &settings, &p, &error), PALP_ERR_STOPPED);
    ck_assert_double_gt(share, 0.0);
    palp_mesh_free(t.mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_set_timeout(tc, 300);
    tcase_add_test(tc, ball_is_found);
    tcase_add_test(tc, none_is_found);
    tcase_add_test(tc, units_do_not_matter);
    tcase_add_test(tc, refused);
    tcase_add_loop_test(tc, layer_is_found, 0, 2);
    tcase_add_test(tc, no_layer_is_found);
    tcase_add_test(tc, known_gain);
}
