/* test_tool_state.c: grasped nodes, what a state remembers of contact, cuts, and networks placed elsewhere.
 */
#include "tool_make.h"

#include <palpate/cut.h>
#include <palpate/model.h>
#include <palpate/realtime.h>

/* ---- grasped nodes ---------------------------------------------------------------------------------- */

START_TEST(grasped_nodes_follow_their_targets) {
    palp_material m = quartic(0);
    palp_network *net = block(5, &m, 0.0, NULL);
    const int32_t nodes[2] = {2 * 25 + 4 * 5 + 2, 2 * 25 + 4 * 5 + 3};
    double target[6], force[3], reaction[3];
    for (int i = 1; i <= 10; i++) {
        for (int k = 0; k < 6; k++)
            target[k] = net->rest[3 * nodes[k / 3] + k % 3] + (k % 3 == 1 ? 3e-4 * i : 1e-4 * i);
        ck_assert_int_eq(palp_network_grasp(net, 2, nodes, target), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    }
    for (int k = 0; k < 6; k++)
        ck_assert_double_eq_tol(palp_network_positions(net)[3 * nodes[k / 3] + k % 3], target[k],
                                0.02 * 3e-3);
    ck_assert_int_eq(palp_network_grasp_force(net, 2, nodes, force), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", reaction), PALP_OK);
    ck_assert_double_lt(force[1], -0.1); /* the tissue pulls the hand back down */
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(force[k], -reaction[k], 1e-8);
    ck_assert_int_eq(palp_network_release(net, 1, nodes), PALP_OK);
    ck_assert_int_eq(palp_network_grasp_force(net, 1, nodes, force), PALP_OK);
    ck_assert_double_eq(force[1], 0.0);
    ck_assert_int_eq(palp_network_release(net, 2, nodes), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        ck_assert_double_eq_tol(palp_network_positions(net)[i], net->rest[i], 1e-9);
    palp_network_free(net);
}
END_TEST

/* A support that moves: the top, all of it grasped and led down as one, has the force of the driven plate. */
START_TEST(grasped_set_is_a_moving_support) {
    palp_material m = quartic(1);
    palp_contact_settings penalty = palp_contact_settings_default();
    penalty.grasp_stiffness = 1e5;
    palp_network *net = block(5, &m, 0.0, &penalty), *plate = cube_network(5, &m, NULL);
    const int32_t *top;
    size_t n;
    double *target, force[3];
    ck_assert_int_eq(palp_mesh_set(net->mesh, "top", &n, &top), PALP_OK);
    target = malloc(3 * n * sizeof *target);
    for (int i = 1; i <= 10; i++) {
        double depth = 0.01 * i * HEIGHT;
        for (size_t j = 0; j < 3 * n; j++)
            target[j] = net->rest[3 * (size_t)top[j / 3] + j % 3] - (j % 3 == 1 ? depth : 0.0);
        ck_assert_int_eq(palp_network_grasp(net, n, top, target), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, 0.05, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(plate, depth, 0.05, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_grasp_force(net, n, top, force), PALP_OK);
        ck_assert_double_eq_tol(force[1], palp_network_force(plate), 1e-3 * palp_network_force(plate));
    }
    free(target);
    palp_network_free(net);
    palp_network_free(plate);
}
END_TEST

/* ---- state --------------------------------------------------------------------------------------- */

/* A tool that drags: what comes out depends on friction's memory. */
static palp_tool dragging(int i) {
    palp_tool tool = sphere(0.009 + 1e-4 * i, HEIGHT - 1e-3, 0.0117, 0.004, 0.4);
    return tool;
}

static palp_tool_force drag(palp_network *net, int from, int to) {
    palp_tool_force f = {.contacts = 0};
    for (int i = from; i < to; i++) {
        palp_tool tool = dragging(i);
        f = step(net, &tool, 0.01);
    }
    return f;
}

START_TEST(trials_and_marks_keep_friction_and_grasps) {
    palp_material m = quartic(1);
    palp_network *net = block(5, &m, 0.0, NULL), *other = block(5, &m, 0.0, NULL);
    const int32_t node = 3;
    palp_tool_force want = drag(other, 0, 12), got;
    drag(net, 0, 6);
    palp_tool far = dragging(60);
    far.position_m[1] -= 5e-4;
    ck_assert_int_eq(palp_network_set_tools(net, 1, &far), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, 0.0, 0.01, NULL), PALP_OK);
    network_mark_save(net);
    network_mark_save(other);
    got = drag(net, 6, 12);
    ck_assert(memcmp(got.force_N, want.force_N, sizeof want.force_N) == 0);
    ck_assert_int_eq(palp_network_grasp(net, 1, &node, (double[]){0.001, 0.002, 0.02}), PALP_OK);
    network_mark_restore(net);
    got = drag(net, 6, 12); /* the predictor starts anew: the same but for the tolerance */
    double hand[3];
    ck_assert_int_eq(palp_network_grasp_force(net, 1, &node, hand), PALP_OK);
    ck_assert(hand[0] == 0.0 && hand[1] == 0.0 && hand[2] == 0.0);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(got.force_N[k], want.force_N[k], 1e-7);
    palp_network_reset(net);
    got = drag(net, 0, 12);
    ck_assert(memcmp(got.force_N, want.force_N, sizeof want.force_N) == 0);
    palp_network_free(net);
    palp_network_free(other);
}
END_TEST

/* Saved while it drags, gone on and restored, it drags on as before. */
START_TEST(save_and_restore_keep_friction_and_grasps) {
    palp_material m = quartic(1);
    palp_network *net = block(5, &m, 0.0, NULL);
    const int32_t node = 124;
    ck_assert_int_eq(palp_network_grasp(net, 1, &node, (double[]){0.024, 0.0245, 0.024}), PALP_OK);
    drag(net, 0, 6);
    size_t size = palp_network_state_size(net);
    void *buffer = malloc(size);
    ck_assert_int_eq(palp_network_save(net, buffer, size), PALP_OK);
    palp_tool_force want = drag(net, 6, 12), got;
    ck_assert_int_eq(palp_network_release(net, 1, &node), PALP_OK);
    drag(net, 30, 33);
    ck_assert_int_eq(palp_network_restore(net, buffer, size), PALP_OK);
    got = drag(net, 6, 12);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(got.force_N[k], want.force_N[k], 1e-7);
    free(buffer);
    palp_network_free(net);
}
END_TEST

/* What a grasp holds is not loose: restored with the grasp, whether it was enabled before the cutting or
 * after. */
START_TEST(restore_knows_what_a_grasp_holds) {
    palp_material m = quartic(0);
    const palp_contact_settings penalty = palp_contact_settings_default();
    const double level[2][9] = {{-1, 0.015, -1, -1, 0.015, 1, 1, 0.015, 1},
                                {-1, 0.015, -1, 1, 0.015, 1, 1, 0.015, -1}};
    const int32_t node = 124;
    for (int first = 0; first < 2; first++) {
        palp_network *net, *other;
        palp_mesh *mesh = cube(5, PALP_NEIGHBOURS_26);
        palp_support bottom[2];
        palp_supports_default(bottom);
        palp_network_settings settings = palp_network_settings_default();
        ck_assert_int_eq(palp_network_create(mesh, &m, 1, bottom, &settings, &net, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_create(mesh, &m, 1, bottom, &settings, &other, NULL), PALP_OK);
        palp_network *both[2] = {net, other};
        for (int i = 0; i < 2; i++) {
            if (first)
                ck_assert_int_eq(palp_network_enable_cutting(both[i]), PALP_OK);
            ck_assert_int_eq(palp_network_enable_tools(both[i], 0, 1, &penalty), PALP_OK);
            if (!first)
                ck_assert_int_eq(palp_network_enable_cutting(both[i]), PALP_OK);
        }
        for (int i = 0; i < 2; i++)
            ck_assert_int_eq(palp_network_cut(net, level[i], NULL), PALP_OK);
        size_t loose = palp_network_loose(net, NULL), size = palp_network_state_size(net);
        ck_assert_uint_gt(loose, 24);
        ck_assert_int_eq(palp_network_grasp(net, 1, &node, (double[]){0.024, 0.024, 0.024}), PALP_OK);
        ck_assert_uint_eq(palp_network_loose(net, NULL), 0);
        void *saved = malloc(size);
        ck_assert_int_eq(palp_network_save(net, saved, size), PALP_OK);
        ck_assert_int_eq(palp_network_release(net, 1, &node), PALP_OK);
        ck_assert_uint_eq(palp_network_loose(net, NULL), loose);
        ck_assert_int_eq(palp_network_restore(net, saved, size), PALP_OK);
        ck_assert_uint_eq(palp_network_loose(net, NULL), 0);
        ck_assert_int_eq(palp_network_restore(other, saved, size), PALP_OK);
        ck_assert_uint_eq(palp_network_loose(other, NULL), 0);
        ck_assert_int_eq(palp_network_release(other, 1, &node), PALP_OK);
        ck_assert_uint_eq(palp_network_loose(other, NULL), loose);
        free(saved);
        palp_mesh_free(mesh);
        palp_network_free(net);
        palp_network_free(other);
    }
}
END_TEST

/* ---- after a cut --------------------------------------------------------------------------------- */

/* A sphere on a slit as deep as half the block: softer than on whole tissue, in balance, and felt on the new
 * faces. */
START_TEST(contact_follows_the_surface_of_a_cut) {
    palp_material m = quartic(0);
    palp_tool tool = sphere(0.0121, HEIGHT - 1.5e-3, 0.0118, 0.004, 0.2);
    double force[2], sum[6];
    for (int cut = 0; cut < 2; cut++) {
        palp_network *net = block(5, &m, 0.0, NULL);
        const double side[2][9] = {{0.0118, 0.011, -0.01, 0.0118, 0.011, 0.03, 0.0118, 0.03, 0.03},
                                   {0.0118, 0.011, -0.01, 0.0118, 0.03, 0.03, 0.0118, 0.03, -0.01}};
        size_t n, before = net->n_surface;
        const int32_t *triangle;
        ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
        for (int i = 0; i < 2 && cut; i++)
            ck_assert_int_eq(palp_network_cut(net, side[i], &n), PALP_OK);
        for (int i = 10; i >= 0; i--) {
            palp_tool above = tool;
            above.position_m[1] += 1.5e-4 * i;
            force[cut] = step(net, &above, INFINITY).force_N[1];
        }
        balance(net, 1, &tool, sum);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(sum[k], 0.0, 1e-8);
        ck_assert_int_eq(palp_network_surface(net, &n, &triangle), PALP_OK);
        ck_assert(cut ? n > before : n == before);
        palp_network_free(net);
    }
    ck_assert_double_lt(force[1], 0.9 * force[0]);
    ck_assert_double_gt(force[1], 0.1 * force[0]);
}
END_TEST

/* ---- elsewhere ----------------------------------------------------------------------------------- */

static void turn(const double r[9], const double t[3], const double *v, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = dot3(r + 3 * k, v) + t[k];
}

/* A model's network turned and moved, tools likewise: the same forces and moments, turned. */
START_TEST(placed_elsewhere_it_feels_the_same) {
    static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, at_origin[3] = {0},
                        moved[3] = {0.1, -0.03, 0.2};
    static const double turned[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6};
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings penalty = palp_contact_settings_default();
    const palp_tool tools[2] = {sphere(0.008, 0.0236, 0.009, 0.004, 0.3),
                                capsule(0.014, 0.0236, 0.013, 0.002, 0.3)};
    palp_tool_force felt[2][2];
    palp_model model;
    palp_mesh_source source;
    ck_assert_int_eq(palp_model_read("data/sedef2008/network_125.json", &model, &source, NULL), PALP_OK);
    for (int place = 0; place < 2; place++) {
        const double *r = place ? turned : one, *t = place ? moved : at_origin;
        palp_mesh *mesh;
        palp_network *net;
        ck_assert_int_eq(palp_model_mesh(&model, &mesh, NULL), PALP_OK);
        ck_assert_int_eq(palp_mesh_transform(mesh, r, t), PALP_OK);
        ck_assert_int_eq(palp_network_from_model(&model, mesh, 1, &bottom, NULL, &net, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_enable_tools(net, 2, 0, &penalty), PALP_OK);
        for (int i = 0; i < 5; i++) {
            palp_tool there[2];
            for (int k = 0; k < 2; k++) {
                const double *at = tools[k].position_m, p[3] = {at[0] + 1e-4 * i, at[1] - 1e-4 * i, at[2]};
                there[k] = tools[k];
                turn(r, t, p, there[k].position_m);
                turn(r, at_origin, tools[k].axis, there[k].axis);
            }
            ck_assert_int_eq(palp_network_set_tools(net, 2, there), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
        }
        ck_assert_int_eq(palp_network_tool_force(net, felt[place]), PALP_OK);
        palp_network_free(net);
        palp_mesh_free(mesh);
    }
    for (int k = 0; k < 2; k++) {
        double force[3], moment[3];
        turn(turned, at_origin, felt[0][k].force_N, force);
        turn(turned, at_origin, felt[0][k].moment_Nm, moment);
        ck_assert_double_gt(sqrt(dot3(force, force)), 0.01);
        for (int i = 0; i < 3; i++) {
            ck_assert_double_eq_tol(felt[1][k].force_N[i], force[i], 1e-7);
            ck_assert_double_eq_tol(felt[1][k].moment_Nm[i], moment[i], 1e-9);
        }
    }
}
END_TEST

START_TEST(models_make_networks) {
    palp_model model;
    palp_mesh_source source;
    palp_network *net = NULL, *own;
    palp_mesh *mesh;
    palp_error error = {PALP_OK, ""};
    palp_material m = quartic(0);
    ck_assert_int_eq(palp_model_read("data/sedef2008/network_125.json", &model, &source, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_from_model(&model, NULL, 0, NULL, NULL, &net, &error), PALP_OK);
    own = cube_network(5, &m, NULL);
    ck_assert_int_eq(palp_network_step(net, 0.0024, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(own, 0.0024, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq(palp_network_force(net), palp_network_force(own));
    palp_network_free(net);
    palp_network_free(own);
    net = NULL;
    model.n_effects = 1;
    ck_assert_int_eq(palp_effect_default(PALP_EFFECT_PLATE_SLIP, &model.effects[0]), PALP_OK);
    ck_assert_int_eq(palp_network_from_model(&model, NULL, 0, NULL, NULL, &net, &error),
                     PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(error.text, "plate_slip"));
    ck_assert_int_eq(palp_effect_default(PALP_EFFECT_MAINS_HUM, &model.effects[0]), PALP_OK);
    ck_assert_int_eq(palp_network_from_model(&model, NULL, 0, NULL, NULL, &net, &error), PALP_OK);
    palp_network_free(net);
    ck_assert_int_eq(palp_model_read("data/sedef2008/lumped_n1.json", &model, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_from_model(&model, NULL, 0, NULL, NULL, &net, &error), PALP_ERR_ARGUMENT);
    mesh = cube(3, PALP_NEIGHBOURS_26);
    const double mirror[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, sheared[9] = {1, 0, 0, 0, 1, 0, 0, 1e-3, 1};
    const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, here[3] = {0}, nowhere[3] = {0, NAN, 0};
    ck_assert_int_eq(palp_mesh_transform(mesh, mirror, here), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_transform(mesh, sheared, here), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_transform(mesh, one, nowhere), PALP_ERR_ARGUMENT);
    palp_mesh_free(mesh);
}
END_TEST

/* A plane that pressed draws back by 5 % of an edge: the guess of the nodes it touched goes along, and of no
 * others. One that draws back by 15 % is not followed. */
START_TEST(a_guess_follows_a_tool_that_draws_back) {
    for (int far = 0; far < 2; far++) {
        palp_material m = linear();
        palp_network *net = block(4, &m, 0.0, NULL);
        double back = (far ? 0.15 : 0.05) * contact_of(net)->edge;
        palp_tool tool = plane(HEIGHT - 1e-4, 0.0);
        step(net, &tool, INFINITY);
        tool.position_m[1] += back;
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        ck_assert_int_eq(network_begin(net, 0.0, INFINITY), PALP_OK);
        memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
        ck_assert(network_evaluate(net));
        NETWORK_EACH_TERM(net, follow, net);
        for (size_t i = 0; i < 3 * net->n_nodes; i++) {
            bool along = !far && i % 3 == 1 && net->rest[i] > 0.99 * HEIGHT;
            ck_assert_double_eq_tol(net->next.x[i] - net->now.x[i], along ? back : 0.0, 1e-15);
        }
        palp_network_free(net);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_guess_follows_a_tool_that_draws_back);
    tcase_add_test(tc, grasped_nodes_follow_their_targets);
    tcase_add_test(tc, grasped_set_is_a_moving_support);
    tcase_add_test(tc, trials_and_marks_keep_friction_and_grasps);
    tcase_add_test(tc, save_and_restore_keep_friction_and_grasps);
    tcase_add_test(tc, restore_knows_what_a_grasp_holds);
    tcase_add_test(tc, contact_follows_the_surface_of_a_cut);
    tcase_add_test(tc, placed_elsewhere_it_feels_the_same);
    tcase_add_test(tc, models_make_networks);
}
