/* test_mesh_solid.c: lattices and hexahedra scaled as a continuum, against the isotropic solid of Poisson's
 * ratio 1/4. */
#include "cut/cut_internal.h"
#include "mesh/mesh_internal.h"
#include "network_make.h"

#include <palpate/cut.h>
#include <palpate/random.h>
#include <palpate/realtime.h>
#include <palpate/reduce.h>

static const double STIFFNESS = 8.18; /* N per unit strain */

static palp_mesh *box(const size_t nodes[3], const double size_m[3]) {
    palp_mesh *mesh = NULL;
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(palp_mesh_lattice(nodes, size_m, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    palp_status status = palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, &error);
    ck_assert_msg(!status, "%s", error.text);
    return mesh;
}

static palp_mesh *solid_cube(size_t n) {
    return box((size_t[]){n, n, n}, (double[]){HEIGHT, HEIGHT, HEIGHT});
}

static palp_material spring(void) {
    palp_material m = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(1, &STIFFNESS, &m.law), PALP_OK);
    return m;
}

/* ---- isotropy ------------------------------------------------------------------------------------ */

/* Energy of an even strain over that of the solid, 1/2 (lambda tr^2 + 2 mu e:e) V with lambda = mu = 2/5 K /
 * area. */
static double energy_ratio(const palp_mesh *mesh, double area_m2, const double e[6]) {
    const double trace = e[0] + e[1] + e[2];
    const double square =
        e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2.0 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
    double springs = 0.0, n[3];
    for (size_t i = 0; i < mesh->n_elements; i++) {
        double length = mesh_direction(mesh, mesh->pairs + 2 * i, n);
        double along = e[0] * n[0] * n[0] + e[1] * n[1] * n[1] + e[2] * n[2] * n[2] +
                       2.0 * (e[3] * n[0] * n[1] + e[4] * n[1] * n[2] + e[5] * n[0] * n[2]);
        springs += mesh->scale[i] * length * along * along;
    }
    return springs * area_m2 / (0.4 * (trace * trace + 2.0 * square) * mesh_volume(mesh, NULL));
}

/* Off by at most so much for any strain. */
static void check_isotropic(const palp_mesh *mesh, double area_m2, double most) {
    uint64_t seed = 7;
    for (int s = 0; s < 40; s++) {
        double e[6];
        for (size_t k = 0; k < 6; k++)
            e[k] = palp_random_uniform(&seed) - 0.5;
        const double ratio = energy_ratio(mesh, area_m2, e);
        ck_assert_msg(fabs(ratio - 1.0) <= most, "strain %d: %.6f of the solid's energy", s, ratio);
    }
}

/* Boxes with sides up to 1.5 to 1 have no direction of their own; with 1.67 to 1 hardly one. */
START_TEST(boxes_are_isotropic) {
    static const double size_mm[][3] = {{24, 24, 24}, {24, 30, 24}, {24, 24, 36}, {30, 24, 20},
                                        {36, 24, 30}, {36, 24, 24}, {24, 40, 24}};
    for (size_t i = 0; i < sizeof size_mm / sizeof *size_mm; i++) {
        const double size_m[3] = {1e-3 * size_mm[i][0], 1e-3 * size_mm[i][1], 1e-3 * size_mm[i][2]};
        palp_mesh *mesh = box((size_t[]){5, 5, 5}, size_m);
        check_isotropic(mesh, size_m[0] * size_m[2], i < 6 ? 1e-9 : 0.1);
        palp_mesh_free(mesh);
    }
}
END_TEST

/* Factors of a cube: the axes' is face / sqrt(2) + 8 body / (3 sqrt(3)), and that of the faces' diagonals; a
 * half of them in a face of the box, a quarter along its edges. */
START_TEST(factors_of_a_cube) {
    palp_mesh *mesh = solid_cube(4);
    const double of[4] = {0.0, 1.0, 1.0, (1.0 - sqrt(0.5)) * 3.0 * sqrt(3.0) / 8.0};
    double face = 0.0, n[3];
    for (int round = 0; round < 2; round++)
        for (size_t i = 0; i < mesh->n_elements; i++) {
            const double *a = mesh->x_m + 3 * mesh->pairs[2 * i], *b = mesh->x_m + 3 * mesh->pairs[2 * i + 1];
            double share = 1.0;
            int along = 0;
            mesh_direction(mesh, mesh->pairs + 2 * i, n);
            for (int k = 0; k < 3; k++) {
                along += n[k] != 0.0;
                share *= a[k] == b[k] && (a[k] == 0.0 || a[k] == HEIGHT) ? 0.5 : 1.0;
            }
            if (along == 2 && share == 1.0)
                face = mesh->scale[i];
            if (round > 0)
                ck_assert_double_eq_tol(mesh->scale[i], share * face * of[along], 1e-12 * face);
        }
    palp_mesh_free(mesh);
}
END_TEST

/* Where no positive factors make a box isotropic they come near: every element keeps a part. */
START_TEST(long_cells_keep_all_elements) {
    palp_mesh *mesh = box((size_t[]){5, 5, 5}, (double[]){HEIGHT, 2.5 * HEIGHT, HEIGHT});
    for (size_t i = 0; i < mesh->n_elements; i++)
        ck_assert_double_gt(mesh->scale[i], 0.0);
    check_isotropic(mesh, HEIGHT * HEIGHT, 0.5);
    palp_mesh_free(mesh);
}
END_TEST

/* Hexahedra of a file are the lattice of the same nodes; sheared and crooked they still are a solid. */
START_TEST(hexahedra_of_a_file) {
    static const double SHEAR = 0.25, CROOKED = 0.1;
    palp_mesh *file = NULL, *lattice = solid_cube(5);
    uint64_t seed = 3;
    for (int crooked = 0; crooked < 2; crooked++) {
        ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/box_hexa.msh", 1e-3, true, &file, NULL), PALP_OK);
        for (size_t i = 0; i < 3 * file->n_nodes && crooked; i++) {
            file->x_m[i] += CROOKED * 0.006 * (palp_random_uniform(&seed) - 0.5);
            file->x_m[i] += i % 3 == 0 ? SHEAR * file->x_m[i + 1] : 0.0;
        }
        ck_assert_int_eq(palp_mesh_scale(file, PALP_SCALING_CONTINUUM, HEIGHT * HEIGHT, NULL), PALP_OK);
        check_isotropic(file, HEIGHT * HEIGHT, crooked ? 0.03 : 1e-9);
        ck_assert_uint_eq(file->n_elements, lattice->n_elements);
        palp_mesh_free(file);
    }
    palp_mesh_free(lattice);
}
END_TEST

START_TEST(what_is_no_solid_is_refused) {
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_18);
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, &error), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(error.text, "elements along all their diagonals"));
    palp_mesh_free(mesh);
    mesh = cube(3, PALP_NEIGHBOURS_26);
    for (size_t i = 0; i < mesh->n_nodes; i++)
        mesh->x_m[3 * i + 2] = 0.5 * mesh->x_m[3 * i];
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 1e-4, &error), PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "has no volume"));
    palp_mesh_free(mesh);
}
END_TEST

/* ---- a block between plates ---------------------------------------------------------------------- */

/* Force on the top, which moves by depth along axis. */
static double moved_top(const palp_mesh *mesh, int axis, double depth, double *bulge) {
    const palp_material m = spring();
    const palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_supports_default(supports);
    for (int k = 0; k < 3; k++) {
        supports[1].axis[k] = k == axis ? PALP_DRIVEN : PALP_FIXED;
        supports[1].motion[k] = k == axis ? -1.0 : 0.0;
    }
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, depth, INFINITY, NULL), PALP_OK);
    const double force = palp_network_force(net), *rest = palp_mesh_positions(mesh),
                 *now = palp_network_positions(net);
    *bulge = 0.0;
    for (size_t i = 0; i < 3 * node_count(net); i += 3)
        *bulge = fmax(*bulge, (now[i] - rest[i]) / depth);
    palp_network_free(net);
    return force;
}

/* A bonded cube, sheared and pressed: the ratio of both forces, and how far its sides come out, as quadratic
 * finite elements have them at Poisson's ratio 1/4. */
START_TEST(sheared_and_pressed) {
    static const struct {
        size_t nodes;
        double shear, bulge;
    } within[] = {{5, 0.10, 0.05}, {7, 0.05, 0.05}, {11, 0.05, 0.05}};
    const size_t n = within[_i].nodes;
    palp_mesh *mesh = solid_cube(n);
    double out, none;
    const double pressed = moved_top(mesh, 1, 1e-3 * HEIGHT, &out);
    const double ratio = moved_top(mesh, 0, 1e-3 * HEIGHT, &none) / pressed;
    ck_assert_msg(fabs(ratio / 0.254 - 1.0) < within[_i].shear, "%zu nodes: shear over press %.4f", n, ratio);
    ck_assert_msg(fabs(out / 0.130 - 1.0) < within[_i].bulge, "%zu nodes: bulge %.4f", n, out);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- what stands on a network -------------------------------------------------------------------- */

/* Ticks on 10 nodes a side, whose preconditioner has levels: converged they are steps, of one correction near
 * them. The second time with Poisson's ratio of tissue. */
START_TEST(ticks_are_steps) {
    const palp_material m = quartic(1);
    palp_network_settings settings = palp_network_settings_default();
    const palp_realtime_settings ticks = palp_realtime_settings_default();
    const palp_budget budgets[2] = {{0}, {.corrections = 1}};
    static const double off[2] = {1e-8, 1e-3};
    settings.poisson_ratio = _i ? 0.45 : 0.0;
    palp_mesh *mesh = solid_cube(10);
    palp_network *steps = network_on(mesh, &m, &settings), *net[2];
    palp_realtime *rt[2] = {NULL, NULL};
    for (int k = 0; k < 2; k++) {
        net[k] = network_on(mesh, &m, &settings);
        ck_assert_int_eq(palp_realtime_create(net[k], &ticks, &rt[k]), PALP_OK);
    }
    for (int i = 1; i <= 30; i++) {
        const double depth = 0.15 * HEIGHT * sin(0.05 * i);
        ck_assert_int_eq(palp_network_step(steps, depth, 2e-3, NULL), PALP_OK);
        const double force = palp_network_force(steps);
        for (int k = 0; k < 2; k++) {
            palp_tick_info info;
            ck_assert_int_eq(palp_realtime_step(rt[k], depth, 2e-3, &budgets[k], &info), PALP_OK);
            ck_assert_double_eq_tol(info.force_N, force, off[k] * force);
        }
    }
    for (int k = 0; k < 2; k++) {
        palp_realtime_free(rt[k]);
        palp_network_free(net[k]);
    }
    palp_network_free(steps);
    palp_mesh_free(mesh);
}
END_TEST

/* A slit from the side is what the same lattice is without the elements that it crosses. */
START_TEST(cut_is_built_without) {
    const palp_material m = quartic(1);
    const palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = solid_cube(5), *part = NULL;
    palp_network *net = network_on(mesh, &m, &settings), *fresh = NULL;
    size_t n = 0, cut = 0;
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    const double y = 0.45 * HEIGHT, reach = 0.6 * HEIGHT;
    const double blade[2][9] = {{-1, y, -1, reach, y, -1, reach, y, 1}, {-1, y, -1, reach, y, 1, -1, y, 1}};
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(palp_network_cut(net, blade[k], &cut), PALP_OK);
        n += cut;
    }
    ck_assert_uint_gt(n, 30);
    int32_t *pairs = malloc(2 * mesh->n_elements * sizeof *pairs);
    double *scale = malloc(mesh->n_elements * sizeof *scale);
    n = 0;
    for (size_t i = 0; i < mesh->n_elements; i++)
        if (palp_network_alive(net)[i]) {
            memcpy(pairs + 2 * n, mesh->pairs + 2 * i, 2 * sizeof *pairs);
            scale[n++] = mesh->scale[i];
        }
    ck_assert_int_eq(palp_mesh_create(mesh->n_nodes, mesh->x_m, n, pairs, &part, NULL), PALP_OK);
    part->scale = arena_take(&part->memory, n, sizeof *scale);
    memcpy(part->scale, scale, n * sizeof *scale);
    ck_assert_int_eq(palp_mesh_add_plane_set(part, "bottom", 1, 0.0, 0.0), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(part, "top", 1, HEIGHT, 0.0), PALP_OK);
    fresh = network_on(part, &m, &settings);
    for (int i = 1; i <= 20; i++) {
        const double depth = -0.002 * HEIGHT * i;
        ck_assert_int_eq(palp_network_step(net, depth, 0.01, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(fresh, depth, 0.01, NULL), PALP_OK);
        ck_assert_double_eq_tol(palp_network_force(net), palp_network_force(fresh),
                                1e-8 * fabs(palp_network_force(fresh)));
    }
    free(pairs);
    free(scale);
    palp_network_free(net);
    palp_network_free(fresh);
    palp_mesh_free(mesh);
    palp_mesh_free(part);
}
END_TEST

/* A reduced model of it follows it along the path that it was made of. */
START_TEST(reduced_follows) {
    enum { N = 24 };
    const palp_material m = quartic(1);
    const palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = solid_cube(5);
    palp_network *net = network_on(mesh, &m, &settings);
    palp_reduce_settings few = palp_reduce_settings_default();
    palp_snapshots *snapshots[2] = {NULL, NULL};
    palp_reduced *reduced = NULL;
    double time[N], depth[N];
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < N; i++) {
            time[i] = 0.05 * (double)(i + 1);
            depth[i] = (0.20 - 0.05 * k) * HEIGHT * (double)(i + 1) / N;
        }
        const palp_tool_path path = {.n = N, .time_s = time, .depth_m = depth};
        ck_assert_int_eq(palp_snapshots_record(net, NULL, &path, NULL, NULL, &snapshots[k], NULL), PALP_OK);
    }
    ck_assert_int_eq(palp_reduced_create(net, 1, snapshots, 1, snapshots + 1, &few, &reduced, NULL, NULL),
                     PALP_OK);
    palp_network_reset(net);
    for (size_t i = 0; i < N; i++) {
        palp_reduced_info info;
        ck_assert_int_eq(palp_reduced_step(reduced, depth[i], 0, NULL, 0.05, NULL, &info), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, depth[i], 0.05, NULL), PALP_OK);
        ck_assert_double_eq_tol(info.force_N, palp_network_force(net), 5e-3 * palp_network_force(net));
    }
    palp_reduced_free(reduced);
    for (int k = 0; k < 2; k++)
        palp_snapshots_free(snapshots[k]);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, boxes_are_isotropic);
    tcase_add_test(tc, factors_of_a_cube);
    tcase_add_test(tc, long_cells_keep_all_elements);
    tcase_add_test(tc, hexahedra_of_a_file);
    tcase_add_test(tc, what_is_no_solid_is_refused);
    tcase_add_loop_test(tc, sheared_and_pressed, 0, 3);
    tcase_add_loop_test(tc, ticks_are_steps, 0, 2);
    tcase_add_test(tc, cut_is_built_without);
    tcase_add_test(tc, reduced_follows);
}
