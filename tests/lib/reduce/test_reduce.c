/* test_reduce.c: reduced models against the full network: energy, tangents, settings and files. */
#define _POSIX_C_SOURCE 200809L
#include "scratch.h"
#include "hull_make.h"
#include "reduce_make.h"

/* ---- networks and paths ---- */

/* All coordinates of the network, mixed by reflections so that none is a node's own, and all its elements. */
static palp_reduced *whole(palp_network *net) {
    size_t n = net->n_free, n3 = 3 * net->n_nodes;
    double *basis = calloc(n3 * n, sizeof *basis), *weight = malloc(net->n_elements * sizeof *weight);
    double *lift = calloc(n3, sizeof *lift);
    int32_t *element = malloc(net->n_elements * sizeof *element);
    palp_reduced *reduced = NULL;
    for (size_t i = 0; i < n3; i++) {
        lift[i] = net->dof[i] < 0 ? net->motion[i] : net->motion[i] + 0.3 * sin((double)i);
        for (size_t j = 0; j < n && net->dof[i] >= 0; j++) {
            double a = sin(1.0 + 3.0 * net->dof[i]), b = sin(1.0 + 3.0 * (double)j);
            basis[i * n + j] = ((size_t)net->dof[i] == j) - 4.0 * a * b / (double)n;
        }
    }
    for (size_t i = 0; i < net->n_elements; i++) {
        element[i] = (int32_t)i;
        weight[i] = 1.0;
    }
    ck_assert_int_eq(
        reduced_make(net, contact_of(net), n, basis, lift, net->n_elements, element, weight, &reduced),
        PALP_OK);
    ck_assert_int_eq(palp_reduced_set_limits(reduced, 1e-11, 50), PALP_OK);
    free(basis);
    free(weight);
    free(lift);
    free(element);
    return reduced;
}

static void check_places(const palp_network *net, const palp_reduced *reduced, double tolerance) {
    size_t n = node_count(net);
    double *x = malloc(3 * n * sizeof *x);
    const double *full = palp_network_positions(net);
    ck_assert_int_eq(palp_reduced_positions(reduced, n, NULL, x), PALP_OK);
    for (size_t i = 0; i < 3 * n; i++)
        ck_assert_double_eq_tol(x[i], full[i], tolerance * HEIGHT);
    free(x);
}

/* ---- tests ---- */

/* With all coordinates and all elements nothing is left out. */
START_TEST(nothing_reduced) {
    for (int kind = 0; kind < KINDS; kind++) {
        palp_material m = material_of(kind);
        if (m.formulation == PALP_SEDEF2008)
            continue;
        palp_network *net = cube_network(4, &m, NULL);
        palp_reduced *reduced = whole(net);
        for (int i = 1; i <= 12; i++) {
            double depth = 0.02 * HEIGHT * (i < 8 ? i : 8), dt = i == 12 ? INFINITY : 0.03 * i;
            palp_reduced_info info;
            ck_assert_int_eq(palp_network_step(net, depth, dt, NULL), PALP_OK);
            ck_assert_int_eq(palp_reduced_step(reduced, depth, 0, NULL, dt, NULL, &info), PALP_OK);
            ck_assert_double_eq_tol(info.force_N, palp_network_force(net), 1e-8 * palp_network_force(net));
            check_places(net, reduced, 1e-8);
        }
        palp_reduced_free(reduced);
        palp_network_free(net);
    }
}
END_TEST

/* _i: a ball, a ball that spins, a box that turns. */
START_TEST(nothing_reduced_under_a_tool) {
    palp_material m = quartic(2);
    palp_network *net = block(5, &m);
    palp_hull *hull = box_hull(0.003, 0.002, 0.004);
    net->settings.tolerance = 1e-11;
    palp_reduced *reduced = whole(net);
    for (int i = 0; i < 14; i++) {
        palp_tool tool = ball(0.010 + 0.0003 * i, 0.011, i < 5 ? 0.0002 * i - 0.0001 : 0.0008);
        palp_tool_force full, small;
        palp_reduced_info info;
        if (_i == 2)
            tool = hull_tool(hull, tool.position_m[0], tool.position_m[1] - RADIUS + 0.003,
                             tool.position_m[2], 0.001, 0.0);
        if (_i > 0)
            turn_tool(&tool, (const double[]){0.0, 0.8, 0.6}, 0.02 * i);
        tool.friction = 0.2;
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, 0.02, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net, &full), PALP_OK);
        ck_assert_int_eq(palp_reduced_step(reduced, 0.0, 1, &tool, 0.02, &small, &info), PALP_OK);
        ck_assert_uint_eq(small.contacts, full.contacts);
        ck_assert_uint_eq(info.contacts, full.contacts);
        double size = fabs(full.force_N[1]);
        ck_assert_msg(i < 2 || size > 0.05, "the ball does not press: %g N", size);
        for (size_t k = 0; k < 3; k++)
            ck_assert_double_eq_tol(small.force_N[k], full.force_N[k], 1e-7 * size + 1e-12);
        check_places(net, reduced, 1e-8);
    }
    palp_reduced_free(reduced);
    palp_network_free(net);
    palp_hull_free(hull);
}
END_TEST

START_TEST(rest_is_rest) {
    palp_material m = quartic(2);
    palp_network *net = cube_network(4, &m, NULL);
    palp_snapshots *snapshots[] = {press(net, 0.003, 0.02, 0.5)};
    palp_reduce_settings settings = palp_reduce_settings_default();
    palp_reduced *reduced = reduce(net, 1, snapshots, 0, NULL, &settings);
    for (int i = 0; i < 3; i++) {
        palp_reduced_info info;
        ck_assert_int_eq(palp_reduced_step(reduced, 0.0, 0, NULL, 0.01, NULL, &info), PALP_OK);
        ck_assert_double_eq_tol(info.force_N, 0.0, 1e-12);
        ck_assert_int_eq(info.iterations, 0);
        ck_assert(isinf(palp_reduced_describe(reduced).bound)); /* no path was held out */
    }
    palp_network_reset(net);
    check_places(net, reduced, 1e-15);
    palp_reduced_free(reduced);
    free_all(1, snapshots);
    palp_network_free(net);
}
END_TEST

/* Energy of the kept elements at (q, depth), J. */
static double energy_at(palp_reduced *r, const double *q, double depth, double *drive) {
    double sum = 0.0, *work = malloc(2 * r->n_elements * sizeof *work);
    memcpy(r->next.q, q, r->modes * sizeof *q);
    r->next.depth = depth;
    ck_assert(reduced_evaluate(r, drive));
    ck_assert(element_energy(&r->material, &r->step, r->n_elements, r->strain, &r->now.history, work,
                             work + r->n_elements));
    for (size_t i = 0; i < r->n_elements; i++)
        sum += r->weight[i] * work[i] / r->inverse_rest[i];
    free(work);
    return sum;
}

/* Forces are the derivatives of an energy, the tangent that of the forces and symmetric: by finite
 * differences, in a state with a history and out of equilibrium. */
START_TEST(energy_consistent) {
    palp_material m = material_of(QLV_DASHPOT);
    palp_network *net = cube_network(5, &m, NULL);
    palp_snapshots *snapshots[] = {press(net, 0.004, 0.02, 0.5), press(net, 0.003, 0.005, 1.0)};
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.modes = 6;
    settings.tolerance = 1e-6;
    settings.elements = 200;
    palp_reduced *r = reduce(net, 2, snapshots, 0, NULL, &settings);
    size_t n = r->modes;
    ck_assert_uint_ge(n, 4);
    ck_assert_uint_lt(palp_reduced_describe(r).elements, palp_reduced_describe(r).network_elements);
    ck_assert_int_eq(palp_reduced_step(r, 0.002, 0, NULL, 0.1, NULL, NULL), PALP_OK);
    element_step_prepare(&r->material, 0.05, &r->step);
    double q[8], gradient[8], drive, other, *k = calloc(n * n, sizeof *k), depth = 0.0026;
    for (size_t i = 0; i < n; i++)
        q[i] = r->now.q[i] * (1.1 + 0.05 * (double)i);
    energy_at(r, q, depth, &drive);
    memcpy(gradient, r->rhs, n * sizeof *gradient);
    reduced_stiffness(r, 0, r->n_elements, k);
    double size = 0.0, force = 0.0;
    for (size_t i = 0; i < n; i++) {
        size = fmax(size, k[i * n + i]);
        force = fmax(force, fabs(gradient[i]));
    }
    for (size_t j = 0; j < n; j++) {
        double h = 1e-5, high[8], was = q[j];
        q[j] = was + h;
        double up = energy_at(r, q, depth, &other);
        memcpy(high, r->rhs, n * sizeof *high);
        q[j] = was - h;
        double down = energy_at(r, q, depth, &other);
        ck_assert_double_eq_tol(-gradient[j], (up - down) / (2.0 * h), 1e-5 * force);
        for (size_t i = 0; i < n; i++) {
            ck_assert_double_eq_tol(k[j * n + i], -(high[i] - r->rhs[i]) / (2.0 * h), 1e-5 * size);
            ck_assert_double_eq_tol(k[j * n + i], k[i * n + j], 1e-12 * size);
        }
        q[j] = was;
    }
    double up = energy_at(r, q, depth + 1e-7, &other), down = energy_at(r, q, depth - 1e-7, &other);
    ck_assert_double_eq_tol(drive, (up - down) / 2e-7, 1e-5 * fabs(drive));
    free(k);
    palp_reduced_free(r);
    free_all(2, snapshots);
    palp_network_free(net);
}
END_TEST

/* The kept elements' tangent, where a state was sampled, is that of all: their stretching and their turning
 * under load. */
START_TEST(kept_elements_have_the_tangent_of_all) {
    enum { MODES = 3 };
    palp_material m = quartic(0);
    palp_network *net = cube_network(5, &m, NULL);
    palp_snapshots *snapshots = press(net, 0.005, 0.02, 0.5);
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.modes = MODES;
    settings.tolerance = settings.element_tolerance = 1e-9;
    settings.elements = 300;
    palp_reduced *few = reduce(net, 1, &snapshots, 0, NULL, &settings), *all = NULL;
    double *weight = malloc(net->n_elements * sizeof *weight), k[2][MODES * MODES] = {{0.0}}, drive;
    int32_t *element = malloc(net->n_elements * sizeof *element);
    ck_assert_uint_eq(few->modes, MODES);
    ck_assert_uint_lt(few->n_elements, net->n_elements / 2);
    for (size_t i = 0; i < net->n_elements; i++) {
        element[i] = (int32_t)i;
        weight[i] = 1.0;
    }
    ck_assert_int_eq(
        reduced_make(net, NULL, MODES, few->basis, few->lift, net->n_elements, element, weight, &all),
        PALP_OK);
    palp_reduced *both[] = {few, all};
    ck_assert_int_eq(palp_reduced_step(all, 0.004, 0, NULL, INFINITY, NULL, NULL), PALP_OK);
    for (size_t i = 0; i < 2; i++) {
        element_step_prepare(&both[i]->material, INFINITY, &both[i]->step);
        memcpy(both[i]->next.q, all->now.q, MODES * sizeof *all->now.q);
        both[i]->next.depth = 0.004;
        ck_assert(reduced_evaluate(both[i], &drive));
        reduced_stiffness(both[i], 0, both[i]->n_elements, k[i]);
    }
    for (size_t i = 0; i < MODES; i++)
        for (size_t j = 0; j < MODES; j++)
            ck_assert_double_eq_tol(k[0][i * MODES + j], k[1][i * MODES + j], 5e-6 * k[1][0]);
    palp_reduced_free(all);
    palp_reduced_free(few);
    palp_snapshots_free(snapshots);
    palp_network_free(net);
    free(weight);
    free(element);
}
END_TEST

START_TEST(settings_are_checked) {
    palp_material m = quartic(1), sedef = sedef2008();
    palp_network *net = cube_network(3, &m, NULL), *other = cube_network(4, &m, NULL),
                 *old = cube_network(3, &sedef, NULL), *touched = cube_network(3, &m, NULL);
    palp_snapshots *path = press(net, 0.002, 0.01, 0.5);
    palp_reduce_settings good = palp_reduce_settings_default(), bad[4] = {good, good, good, good};
    palp_reduced *reduced = NULL;
    palp_error error = {PALP_OK, ""};
    bad[0].modes = 0;
    bad[1].elements = 0;
    bad[2].element_tolerance = NAN;
    bad[3].static_modes = good.modes + 1;
    for (size_t i = 0; i < 4; i++)
        ck_assert_int_eq(palp_reduced_create(net, 1, &path, 0, NULL, &bad[i], &reduced, NULL, &error),
                         PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_reduced_create(net, 0, NULL, 0, NULL, &good, &reduced, NULL, &error),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_reduced_create(other, 1, &path, 0, NULL, &good, &reduced, NULL, &error),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_reduced_create(old, 1, &path, 0, NULL, &good, &reduced, NULL, &error),
                     PALP_ERR_UNSUPPORTED);
    palp_contact_settings smooth = palp_contact_settings_default(), touching = smooth;
    touching.tissue = true;
    touching.local = false;
    ck_assert_int_eq(palp_network_enable_tools(touched, 1, 0, &touching), PALP_OK);
    ck_assert_int_eq(palp_reduced_create(touched, 1, &path, 0, NULL, &good, &reduced, NULL, &error),
                     PALP_ERR_UNSUPPORTED);
    ck_assert_msg(strstr(error.text, "tissue touches itself"), "%s", error.text);
    smooth.subdivisions = 1;
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &smooth), PALP_OK);
    ck_assert_int_eq(palp_reduced_create(net, 1, &path, 0, NULL, &good, &reduced, NULL, &error),
                     PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_null(reduced);
    palp_snapshots *none = NULL;
    const double back[] = {0.1, 0.1}, depth[] = {0.0, 0.0};
    palp_tool_path wrong = {.n = 2, .time_s = back, .depth_m = depth};
    ck_assert_int_eq(palp_snapshots_record(net, NULL, &wrong, NULL, NULL, &none, &error), PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(none);
    palp_snapshots_free(path);
    palp_network_free(net);
    palp_network_free(other);
    palp_network_free(old);
    palp_network_free(touched);
}
END_TEST

/* ---- files ---- */

static void spoil(const char *path, long at, int by) {
    FILE *file = fopen(path, "r+b");
    ck_assert_ptr_nonnull(file);
    fseek(file, at, at < 0 ? SEEK_END : SEEK_SET);
    int byte = fgetc(file);
    fseek(file, -1, SEEK_CUR);
    fputc(byte ^ by, file);
    ck_assert_int_eq(fclose(file), 0);
}

static void check_refused(const char *text) {
    palp_reduced *none = NULL;
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(palp_reduced_read(scratch_path("r.json"), NULL, NULL, &none, &error), PALP_ERR_INPUT);
    ck_assert_ptr_null(none);
    ck_assert_msg(strstr(error.text, text) != NULL, "\"%s\" lacks \"%s\"", error.text, text);
    ck_assert_msg(strstr(error.text, "r.json:") != NULL, "%s", error.text);
}

START_TEST(files) {
    palp_network *net;
    palp_material m = quartic(2);
    const palp_mesh_source mesh = {
        .nodes = {5, 5, 5}, .size_m = {HEIGHT, HEIGHT, HEIGHT}, .neighbourhood = PALP_NEIGHBOURS_26};
    palp_mesh_source mesh_back;
    palp_model model = {.kind = PALP_MODEL_NETWORK, .height_m = HEIGHT, .material = m, .mesh = &mesh}, back;
    palp_reduced *reduced = under_a_ball(&net), *copy = NULL;
    palp_error error = {PALP_OK, ""};
    scratch_setup();
    ck_assert_int_eq(palp_reduced_write(reduced, &model, scratch_path("r.json"), &error), PALP_OK);
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), 2);
    ck_assert_msg(!palp_reduced_read(scratch_path("r.json"), &back, &mesh_back, &copy, &error), "%s",
                  error.text);
    ck_assert_ptr_eq(back.mesh, &mesh_back);
    ck_assert_mem_eq(mesh_back.nodes, mesh.nodes, sizeof mesh.nodes);
    palp_reduced_summary a = palp_reduced_describe(reduced), b = palp_reduced_describe(copy);
    ck_assert_double_eq(a.bound, b.bound);
    ck_assert_uint_eq(a.elements, b.elements);
    ck_assert_uint_eq(palp_reduced_triangle_count(copy), 12 * 16);
    for (int i = 0; i < 30; i++) {
        palp_tool_force one, two;
        palp_reduced_info info, other;
        ck_assert_int_eq(tick(reduced, i, &one, &info), PALP_OK);
        ck_assert_int_eq(tick(copy, i, &two, &other), PALP_OK);
        ck_assert(memcmp(&one, &two, sizeof one) == 0);
        ck_assert_double_eq(info.force_error_N, other.force_error_N);
    }
    palp_reduced_free(copy);
    spoil(scratch_path("r.bin"), 5000, 1);
    check_refused("the wrong checksum");
    spoil(scratch_path("r.bin"), 5000, 1);
    spoil(scratch_path("r.bin"), 16, 1);
    check_refused("sizes that differ from the model's");
    spoil(scratch_path("r.bin"), 16, 1);
    spoil(scratch_path("r.bin"), 9, 1);
    check_refused("byte order");
    spoil(scratch_path("r.bin"), 9, 1);
    ck_assert_int_eq(truncate(scratch_path("r.bin"), 1000), 0);
    check_refused("the wrong length");
    ck_assert_int_eq(truncate(scratch_path("r.bin"), 4), 0);
    check_refused("are not those of a reduced model");
    ck_assert_int_eq(remove(scratch_path("r.bin")), 0);
    ck_assert_int_eq(palp_reduced_read(scratch_path("r.json"), NULL, NULL, &copy, &error), PALP_ERR_FILE);
    scratch_teardown();
    palp_reduced_free(reduced);
    palp_network_free(net);
}
END_TEST

/* A number that is none anywhere in the arrays, or a node that there is not, is refused though the checksum
 * is right. */
START_TEST(arrays_of_a_file_are_checked) {
    palp_network *net;
    palp_material m = quartic(2);
    const palp_mesh_source mesh = {
        .nodes = {5, 5, 5}, .size_m = {HEIGHT, HEIGHT, HEIGHT}, .neighbourhood = PALP_NEIGHBOURS_26};
    const palp_model model = {.kind = PALP_MODEL_NETWORK, .height_m = HEIGHT, .material = m, .mesh = &mesh};
    palp_reduced *r = under_a_ball(&net);
    const size_t n = r->n_nodes;
    double *last[] = {r->rest + 3 * n - 1,
                      r->lift + 3 * n - 1,
                      r->basis + 3 * n * r->modes - 1,
                      r->weight + r->n_elements - 1,
                      r->low + r->modes,
                      r->high + r->modes,
                      r->unit + n - 1};
    int32_t *node[] = {r->pair + 2 * r->n_elements - 1, r->triangles + 3 * r->n_triangles - 1};
    scratch_setup();
    for (size_t i = 0; i < sizeof last / sizeof *last + 4; i++) {
        double *number = i < 7 ? last[i] : NULL, was = number ? *number : 0.0;
        int32_t *at = number ? NULL : node[(i - 7) / 2], index = at ? *at : 0;
        if (number)
            *number = NAN;
        else
            *at = i % 2 ? (int32_t)n : -1;
        ck_assert_int_eq(palp_reduced_write(r, &model, scratch_path("r.json"), NULL), PALP_OK);
        check_refused("");
        if (number)
            *number = was;
        else
            *at = index;
    }
    scratch_teardown();
    palp_reduced_free(r);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, arrays_of_a_file_are_checked);
    tcase_add_test(tc, nothing_reduced);
    tcase_add_loop_test(tc, nothing_reduced_under_a_tool, 0, 3);
    tcase_add_test(tc, rest_is_rest);
    tcase_add_test(tc, energy_consistent);
    tcase_add_test(tc, kept_elements_have_the_tangent_of_all);
    tcase_add_test(tc, settings_are_checked);
    tcase_add_test(tc, files);
}
