/* test_network_regions.c: networks whose parts differ in material. */
#include "mesh/mesh_internal.h"
#include "network_settle.h"
#include "tangent_make.h"

#include <palpate/cut.h>
#include <palpate/realtime.h>
#include <palpate/tool.h>

#include <stdio.h>

static palp_material spring_with_arm(double stiffness_N, double arm_N, double time_s) {
    palp_material m = {.n_arms = arm_N > 0.0, .arms = {{arm_N, arm_N * time_s, 0, 0}}};
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness_N, &m.law), PALP_OK);
    return m;
}

static palp_region box(const char *name, const double low[3], const double high[3]) {
    palp_region r = {.shape = PALP_REGION_BOX, .stiffness = 1.0};
    strcpy(r.name, name);
    memcpy(r.low_m, low, sizeof r.low_m);
    memcpy(r.high_m, high, sizeof r.high_m);
    return r;
}

static palp_region layer(const char *name, double low_y, double high_y) {
    return box(name, (double[]){-1, low_y, -1}, (double[]){1, high_y, 1});
}

static palp_region nodule(double stiffness) {
    palp_region r = {
        .name = "nodule", .shape = PALP_REGION_SPHERE, .radius_m = 0.3 * HEIGHT, .stiffness = stiffness};
    r.centre_m[0] = r.centre_m[2] = 0.5 * HEIGHT;
    r.centre_m[1] = 0.6 * HEIGHT;
    return r;
}

/* The same material times a factor. */
static palp_region with_material(palp_region r, const palp_material *m, double factor) {
    r.stiffness = 0.0;
    r.own_material = *m;
    for (size_t k = 0; k < m->law.n; k++)
        r.own_material.law.coefficients[k] *= factor;
    for (size_t j = 0; j < m->n_arms; j++) {
        r.own_material.arms[j].stiffness_N *= factor;
        r.own_material.arms[j].viscosity_Ns *= factor;
    }
    r.own_material.dashpot_Ns *= factor;
    return r;
}

static palp_mesh *solid_cube(size_t n) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    return mesh;
}

static palp_network *with_regions(palp_mesh *mesh, const palp_material *m, double ratio, size_t n,
                                  const palp_region *regions) {
    palp_network_settings settings = palp_network_settings_default();
    settings.poisson_ratio = ratio;
    settings.n_regions = n;
    settings.regions = regions;
    for (size_t r = 0; r < n; r++)
        ck_assert_int_eq(palp_region_place_in(mesh, &regions[r], NULL), PALP_OK);
    return network_on(mesh, m, &settings);
}

/* ---- what regions are equal to ------------------------------------------------------------------- */

/* Both follow a ramp and a hold with the same forces and positions. */
static void check_alike(palp_network *a, palp_network *b, double tolerance) {
    for (int i = 1; i <= 12; i++) {
        const double depth = 0.01 * HEIGHT * fmin(i, 8);
        ck_assert_int_eq(palp_network_step(a, depth, 0.05, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(b, depth, 0.05, NULL), PALP_OK);
        const double force = palp_network_force(a);
        ck_assert_double_eq_tol(palp_network_force(b), force, tolerance * fabs(force));
    }
    for (size_t i = 0; i < 3 * a->n_nodes; i++)
        ck_assert_double_eq_tol(a->now.x[i], b->now.x[i], tolerance * HEIGHT);
    palp_network_free(a);
    palp_network_free(b);
}

/* A region that is stiffer by a factor is one of the same material times the factor. */
START_TEST(a_factor_is_a_material) {
    for (int kind = ELASTIC; kind <= QLV_DASHPOT; kind++) {
        const palp_material m = material_of(kind);
        palp_mesh *mesh = solid_cube(5);
        const palp_region factor = nodule(7.0), own = with_material(nodule(7.0), &m, 7.0);
        check_alike(with_regions(mesh, &m, 0.4, 1, &factor), with_regions(mesh, &m, 0.4, 1, &own), 1e-9);
        palp_mesh_free(mesh);
    }
}
END_TEST

/* A region of everything is the network of its material; one of the network's own material is nothing. */
START_TEST(all_of_the_mesh) {
    const palp_material m = quartic(1), other = spring_with_arm(3.0, 2.0, 0.3);
    for (int own = 0; own < 2; own++) {
        palp_mesh *mesh = solid_cube(5);
        palp_region all =
            own ? with_material(layer("all", -1, 1), &other, 1.0) : with_material(nodule(1.0), &m, 1.0);
        check_alike(with_regions(mesh, own ? &other : &m, 0.45, 0, NULL),
                    with_regions(mesh, &m, 0.45, 1, &all), 1e-9);
        palp_mesh_free(mesh);
    }
}
END_TEST

/* So it is under a sphere that presses and stays, on local points and on a smooth surface. */
START_TEST(all_of_the_mesh_under_a_sphere) {
    const palp_material m = spring_with_arm(1.0, 0.0, 1.0), other = spring_with_arm(3.0, 2.0, 0.3);
    const palp_region all = with_material(layer("all", -1, 1), &other, 1.0);
    double force[2][8];
    for (int with = 0; with < 2; with++) {
        const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
        palp_network_settings settings = palp_network_settings_default();
        palp_contact_settings touch = palp_contact_settings_default();
        palp_mesh *mesh = solid_cube(5);
        palp_network *net = NULL;
        palp_tool tool = {
            .shape = PALP_TOOL_SPHERE, .position_m = {0.4 * HEIGHT, 0, 0.5 * HEIGHT}, .radius_m = 5e-3};
        ck_assert_int_eq(palp_region_place_in(mesh, &all, NULL), PALP_OK);
        touch.subdivisions = _i ? 1 : 0;
        settings.n_regions = (size_t)with;
        settings.regions = &all;
        ck_assert_int_eq(palp_network_create(mesh, with ? &m : &other, 1, &bottom, &settings, &net, NULL),
                         PALP_OK);
        ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &touch), PALP_OK);
        for (int i = 0; i < 8; i++) {
            palp_tool_force felt;
            tool.position_m[1] = HEIGHT + 5e-3 - 2.5e-4 * fmin(i + 1, 4);
            ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.0, 0.1, NULL), PALP_OK);
            ck_assert_int_eq(palp_network_tool_force(net, &felt), PALP_OK);
            force[with][i] = felt.force_N[1];
        }
        palp_network_free(net);
        palp_mesh_free(mesh);
    }
    for (int i = 0; i < 8; i++)
        ck_assert_double_eq_tol(force[1][i], force[0][i], 1e-6 * force[0][i]);
    ck_assert_double_lt(force[0][7], 0.9 * force[0][3]);
}
END_TEST

/* Where regions overlap, the later one counts. */
START_TEST(the_later_region_counts) {
    const palp_material m = quartic(1);
    palp_mesh *mesh = solid_cube(5);
    palp_region two[2] = {layer("wide", 0.25 * HEIGHT, 1), layer("upper", 0.5 * HEIGHT, 1)},
                apart[2] = {layer("middle", 0.25 * HEIGHT, 0.5 * HEIGHT), layer("upper", 0.5 * HEIGHT, 1)};
    two[0].stiffness = apart[0].stiffness = 3.0;
    two[1] = with_material(two[1], &m, 0.5);
    apart[1] = with_material(apart[1], &m, 0.5);
    check_alike(with_regions(mesh, &m, 0.3, 2, two), with_regions(mesh, &m, 0.3, 2, apart), 1e-9);
    palp_mesh_free(mesh);
}
END_TEST

/* Confined layers of linear springs are springs in series: force A / sum of height over modulus. */
START_TEST(layers_in_series) {
    const palp_material m = spring_with_arm(1.0, 0.0, 1.0);
    static const double STIFFNESS[] = {4.0, 0.5};
    palp_support supports[3] = {[2] = {"all", {PALP_FIXED, PALP_FREE, PALP_FIXED}, {0}}};
    palp_network_settings settings = palp_network_settings_default();
    palp_supports_default(supports);
    palp_mesh *mesh = solid_cube(5);
    int32_t all[125];
    double force[2];
    for (int i = 0; i < 125; i++)
        all[i] = i;
    ck_assert_int_eq(palp_mesh_add_set(mesh, "all", 125, all), PALP_OK);
    palp_region regions[2] = {layer("upper", 0.5 * HEIGHT, 1), layer("lower", -1, 0.25 * HEIGHT)};
    for (int r = 0; r < 2; r++) {
        regions[r].stiffness = STIFFNESS[r];
        ck_assert_int_eq(palp_region_place_in(mesh, &regions[r], NULL), PALP_OK);
    }
    settings.regions = regions;
    for (size_t with = 0; with < 2; with++) {
        palp_network *net = NULL;
        settings.n_regions = 2 * with;
        ck_assert_int_eq(palp_network_create(mesh, &m, 3, supports, &settings, &net, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 1e-5 * HEIGHT, INFINITY, NULL), PALP_OK);
        force[with] = palp_network_force(net);
        palp_network_free(net);
    }
    const double series = 1.0 / (0.5 / STIFFNESS[0] + 0.25 + 0.25 / STIFFNESS[1]);
    ck_assert_double_eq_tol(force[1] / force[0], series, 1e-4 * series);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- derivatives --------------------------------------------------------------------------------- */

static palp_network *three_materials(double ratio) {
    palp_material m = material_of(ARMS), stiff = spring_with_arm(6.0, 2.0, 0.1);
    stiff.arms[0].beta = 2.0;
    palp_mesh *mesh = solid_cube(4);
    palp_region regions[2] = {nodule(5.0), with_material(layer("skin", 0.7 * HEIGHT, 1), &stiff, 1.0)};
    regions[1].poisson_ratio = ratio > 0.0 ? 0.3 : 0.0;
    palp_network *net = with_regions(mesh, &m, ratio, 2, regions);
    palp_mesh_free(mesh);
    return net;
}

/* Forces are the slope of the energy, the tangent that of the forces, in the middle of a step. */
START_TEST(derivatives) {
    const double h = 1e-8;
    palp_network *net = three_materials(_i ? 0.45 : 0.0);
    const size_t n = 3 * net->n_nodes;
    seed = 3;
    unsettle(net, 0.06 * HEIGHT);
    double *x = calloc(5 * n, sizeof *x), *u = x + n, *k = u + n, *low = k + n, *high = low + n, along = 0.0,
           largest = 0.0;
    memcpy(x, net->next.x, n * sizeof *x);
    for (size_t i = 0; i < n; i++)
        u[i] = net->dof[i] < 0 ? 0.0 : cos(2.3 * (double)i);
    residual_at(net, x, u, -h, low);
    residual_at(net, x, u, h, high);
    const double before = energy_at(net, x, u, -h), after = energy_at(net, x, u, h);
    energy_at(net, x, u, 0.0);
    network_set_diagonal(net, 0.0);
    network_tangent_times(net, u, k);
    for (size_t i = 0; i < n; i++) {
        along += 0.5 * (low[i] + high[i]) * u[i];
        largest = fmax(largest, net->dof[i] < 0 ? 0.0 : fabs(k[i]));
    }
    ck_assert_double_eq_tol((before - after) / (2.0 * h), along, 1e-5 * fabs(along));
    for (size_t i = 0; i < n; i++)
        if (net->dof[i] >= 0)
            ck_assert_double_eq_tol((low[i] - high[i]) / (2.0 * h), k[i], 1e-5 * largest);
    free(x);
    palp_network_free(net);
}
END_TEST

/* A law's coefficient changes the reaction by the sum of weight dforce/dp: of the network's own material. */
START_TEST(weights_are_those_of_its_own_material) {
    palp_material m = spring_with_arm(8.0, 0.0, 1.0), changed = m, other = spring_with_arm(20.0, 0.0, 1.0);
    palp_mesh *mesh = solid_cube(5);
    const palp_region regions[2] = {nodule(5.0), with_material(layer("skin", 0.7 * HEIGHT, 1), &other, 1.0)};
    palp_network *net = with_regions(mesh, &m, 0.0, 2, regions);
    double *weight = malloc(net->n_elements * sizeof *weight), stiffness, slope = 0.0, force[2];
    ck_assert_int_eq(palp_network_step(net, 0.05 * HEIGHT, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(network_weights(net, weight, &stiffness), PALP_OK);
    for (size_t i = 0; i < net->n_elements; i++)
        slope += weight[i] * net->now.history.strain[i];
    for (int side = 0; side < 2; side++) {
        changed.law.coefficients[0] = 8.0 + (side ? 1e-4 : -1e-4);
        ck_assert_int_eq(palp_network_set_material(net, &changed), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.05 * HEIGHT, INFINITY, NULL), PALP_OK);
        force[side] = palp_network_force(net);
    }
    ck_assert_double_eq_tol((force[1] - force[0]) / 2e-4, slope, 1e-6 * slope);
    free(weight);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- what stands on it --------------------------------------------------------------------------- */

/* Saved in the middle and restored, a network goes on alike; one with other regions refuses the state. */
START_TEST(states) {
    palp_network *net = three_materials(0.4), *other = three_materials(0.0);
    const size_t size = palp_network_state_size(net);
    void *buffer = malloc(size);
    double force[2];
    ck_assert_int_eq(palp_network_step(net, 0.05 * HEIGHT, 0.03, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_save(net, buffer, size), PALP_OK);
    for (int i = 0; i < 2; i++) {
        ck_assert_int_eq(palp_network_restore(net, buffer, size), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.05 * HEIGHT, 0.2, NULL), PALP_OK);
        force[i] = palp_network_force(net);
    }
    ck_assert_double_eq_tol(force[0], force[1], 1e-9 * force[0]);
    ck_assert_int_eq(palp_network_restore(other, buffer, size), PALP_ERR_ARGUMENT);
    palp_network_reset(net);
    ck_assert_int_eq(palp_network_step(net, 0.0, 0.1, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_force(net), 0.0, 1e-12);
    free(buffer);
    palp_network_free(net);
    palp_network_free(other);
}
END_TEST

/* Stepped within a budget it has the forces of whole steps, and says how far they are. */
START_TEST(in_real_time) {
    palp_network *net = three_materials(0.45), *whole = three_materials(0.45);
    palp_realtime *rt = NULL;
    palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_budget few = {.corrections = 1};
    palp_tick_info info;
    double worst = 0.0, bound = 0.0;
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    for (int i = 1; i <= 400; i++) {
        const double depth = 0.08 * HEIGHT * sin(0.012 * i);
        ck_assert_int_eq(palp_realtime_step(rt, depth, 2e-3, &few, &info), PALP_OK);
        ck_assert_int_eq(palp_network_step(whole, depth, 2e-3, NULL), PALP_OK);
        const double off = fabs(info.force_N - palp_network_force(whole));
        ck_assert_msg(off <= info.force_error_N + 1e-9, "tick %d: off by %g, said %g", i, off,
                      info.force_error_N);
        worst = fmax(worst, off);
        bound = fmax(bound, fabs(palp_network_force(whole)));
    }
    ck_assert_double_le(worst, 0.01 * bound);
    palp_realtime_free(rt);
    palp_network_free(net);
    palp_network_free(whole);
}
END_TEST

/* Cut through regions and pressed, then whole again, it is what it was. */
START_TEST(cut_and_whole_again) {
    palp_network *net = three_materials(0.4);
    const double y = 0.75 * HEIGHT, reach = 0.5 * HEIGHT;
    const double blade[2][9] = {{-1, y, -1, reach, y, -1, reach, y, 1}, {-1, y, -1, reach, y, 1, -1, y, 1}};
    double force[3];
    size_t cut[2] = {0};
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    for (int i = 0; i < 3; i++) {
        palp_network_reset(net);
        for (int k = 0; k < 2 && i == 1; k++)
            ck_assert_int_eq(palp_network_cut(net, blade[k], &cut[k]), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, -0.03 * HEIGHT, 0.1, NULL), PALP_OK);
        force[i] = palp_network_force(net);
    }
    ck_assert_uint_gt(cut[0] + cut[1], 0);
    ck_assert_double_lt(fabs(force[1]), 0.95 * fabs(force[0]));
    ck_assert_double_eq_tol(force[2], force[0], 1e-9 * fabs(force[0]));
    palp_network_free(net);
}
END_TEST

/* Beyond the measured range of the region that is strained most, though the other law has none. */
START_TEST(beyond_the_range_of_a_region) {
    palp_material m = spring_with_arm(20.0, 0.0, 1.0), soft = spring_with_arm(1.0, 0.0, 1.0);
    palp_step_info info;
    ck_assert_int_eq(palp_law_limit(&soft.law, 0.05), PALP_OK);
    palp_mesh *mesh = solid_cube(5);
    const palp_region region = with_material(layer("soft", 0.5 * HEIGHT, 1), &soft, 1.0);
    palp_network *net = with_regions(mesh, &m, 0.0, 1, &region);
    ck_assert_int_eq(palp_network_step(net, 0.01 * HEIGHT, INFINITY, &info), PALP_OK);
    ck_assert_double_eq(info.beyond, 0.0);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, INFINITY, &info), PALP_OK);
    ck_assert_double_gt(info.beyond, 0.0);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

/* A membrane on the top with an arm of its own relaxes; forces are still the slope of the energy. */
START_TEST(membrane) {
    const palp_material m = spring_with_arm(5.0, 0.0, 1.0), skin = spring_with_arm(40.0, 60.0, 0.5);
    palp_mesh *mesh = solid_cube(4);
    palp_region region = {.name = "skin", .shape = PALP_REGION_MEMBRANE, .set = "left"};
    region.own_material = skin;
    palp_network *net = with_regions(mesh, &m, 0.0, 1, &region);
    const size_t n = 3 * net->n_nodes;
    double *u = calloc(2 * n, sizeof *u), *x = u + n, along = 0.0, scale;
    ck_assert_int_eq(palp_network_step(net, 0.05 * HEIGHT, 0.01, NULL), PALP_OK);
    const double at_once = palp_network_force(net);
    ck_assert_int_eq(palp_network_try(net, 0.05 * HEIGHT, 5.0, NULL), PALP_OK);
    memcpy(x, net->next.x, n * sizeof *x);
    for (size_t i = 0; i < n; i++)
        u[i] = net->dof[i] < 0 ? 0.0 : cos(2.3 * (double)i);
    for (size_t i = 0; i < n; i++)
        x[i] += 0.01 * HEIGHT * u[i];
    const double before = energy_at(net, x, u, -1e-8), after = energy_at(net, x, u, 1e-8);
    energy_at(net, x, u, 0.0);
    network_residual(net, &scale);
    for (size_t i = 0; i < n; i++)
        along += net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]] * u[i];
    ck_assert_double_eq_tol((before - after) / 2e-8, along, 1e-5 * fabs(along));
    ck_assert_int_eq(palp_network_step(net, 0.05 * HEIGHT, 5.0, NULL), PALP_OK);
    ck_assert_double_lt(palp_network_force(net), 0.95 * at_once);
    free(u);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(what_is_refused) {
    const palp_material m = quartic(1), sedef = sedef2008();
    palp_mesh *mesh = solid_cube(3);
    palp_support supports[2];
    palp_supports_default(supports);
    const palp_region good = nodule(2.0);
    ck_assert_int_eq(palp_region_place_in(mesh, &good, NULL), PALP_OK);
    for (int i = 0; i < 7; i++) {
        static const palp_status WANTED[] = {PALP_OK,           PALP_ERR_INPUT,       PALP_ERR_ARGUMENT,
                                             PALP_ERR_ARGUMENT, PALP_ERR_UNSUPPORTED, PALP_ERR_ARGUMENT,
                                             PALP_ERR_ARGUMENT};
        palp_network_settings settings = palp_network_settings_default();
        palp_region r = i == 4 ? with_material(good, &sedef, 1.0) : good;
        palp_network *net = NULL;
        palp_error error = {PALP_OK, ""};
        if (i == 1)
            strcpy(r.name, "tumour");
        if (i == 6) {
            r = with_material(good, &m, 1.0);
            r.own_material.law.coefficients[0] = 0.0;
        }
        r.stiffness = i == 2 ? -1.0 : r.stiffness;
        r.poisson_ratio = i == 3 ? 0.2 : 0.0;
        settings.n_regions = i == 5 ? PALP_REGIONS_MAX + 1 : 1;
        settings.regions = &r;
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, &error), WANTED[i]);
        ck_assert(i == 0 || strlen(error.text) > 10);
        palp_network_free(net);
    }
    palp_mesh_free(mesh);
}
END_TEST

/* ---- the continuum ------------------------------------------------------------------------------- */

/* Force over that of a cube of one material: between bonded plates, sheared, and under a sphere. */
static double load(const char *kind, size_t n, double ratio, const palp_region *region) {
    static const double SPHERE = 5e-3, DEPTH = 1e-3;
    const bool sphere = strcmp(kind, "sphere") == 0, shear = strcmp(kind, "shear") == 0;
    palp_material m = {.n_arms = 0};
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_supports_default(supports);
    palp_mesh *mesh = solid_cube(n);
    ck_assert_int_eq(palp_law_of_solid(mesh, ratio, 0.8 * (1.0 + ratio) * 10.0 / (HEIGHT * HEIGHT), &m.law),
                     PALP_OK);
    settings.poisson_ratio = ratio > 0.25 ? ratio : 0.0;
    settings.n_regions = region != NULL;
    settings.regions = region;
    if (region)
        ck_assert_int_eq(palp_region_place_in(mesh, region, NULL), PALP_OK);
    for (int k = 0; k < 3 && shear; k++) {
        supports[1].axis[k] = k == 0 ? PALP_DRIVEN : PALP_FIXED;
        supports[1].motion[k] = k == 0 ? 1.0 : 0.0;
    }
    ck_assert_int_eq(palp_network_create(mesh, &m, sphere ? 1 : 2, supports, &settings, &net, NULL), PALP_OK);
    double force = 0.0;
    if (sphere) {
        palp_contact_settings touch = palp_contact_settings_default();
        palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = SPHERE};
        palp_tool_force felt;
        tool.position_m[0] = tool.position_m[2] = 0.5 * HEIGHT;
        ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &touch), PALP_OK);
        for (int i = 1; i <= 4; i++) {
            tool.position_m[1] = HEIGHT + SPHERE - 0.25 * i * DEPTH;
            ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
        }
        ck_assert_int_eq(palp_network_tool_force(net, &felt), PALP_OK);
        force = felt.force_N[1];
    } else {
        ck_assert_int_eq(palp_network_step(net, 1e-3 * HEIGHT, INFINITY, NULL), PALP_OK);
        force = palp_network_force(net);
    }
    palp_network_free(net);
    palp_mesh_free(mesh);
    return fabs(force);
}

static palp_region part_called(const char *name) {
    static const struct {
        const char *name;
        double low[3], high[3], stiffness; /* mm */
    } PARTS[] = {
        {"stiff_upper_half", {0, 12, 0}, {24, 24, 24}, 5}, {"soft_upper_half", {0, 12, 0}, {24, 24, 24}, 0.2},
        {"stiff_skin", {0, 20, 0}, {24, 24, 24}, 5},       {"stiff_inclusion", {8, 8, 8}, {16, 16, 16}, 10},
        {"soft_inclusion", {8, 8, 8}, {16, 16, 16}, 0.1},  {"stiff_nodule", {8, 12, 8}, {16, 20, 16}, 10}};
    size_t i = 0;
    while (strcmp(PARTS[i].name, name) != 0)
        i++;
    palp_region r = {.shape = PALP_REGION_BOX, .stiffness = PARTS[i].stiffness};
    strcpy(r.name, name);
    for (int k = 0; k < 3; k++) {
        r.low_m[k] = 1e-3 * PARTS[i].low[k];
        r.high_m[k] = 1e-3 * PARTS[i].high[k];
    }
    return r;
}

/* What sides of 0.25 mm with ten times the modulus are more than the tissue there: a membrane around the
 * block. The solid's Young's modulus is 4/5 (1 + ratio) K over its section. */
static palp_region capsule(double ratio) {
    const double modulus = 0.8 * (1.0 + ratio) * 10.0 / (HEIGHT * HEIGHT);
    const palp_material m = spring_with_arm(9.0 * modulus * 0.25e-3, 0.0, 1.0);
    palp_region r = {.name = "capsule", .shape = PALP_REGION_MEMBRANE};
    r.own_material = m;
    return r;
}

/* Forces of a cube with a stiff or soft part over those of the cube without it, by CalculiX. Not every part
 * ends at nodes. */
START_TEST(as_calculix_has_it) {
    static const struct {
        size_t nodes;
        double plate, sphere, skin; /* skin: a sphere on the stiff skin */
    } BOUND[] = {{5, 0.045, 0.07, 0.057}, {7, 0.038, 0.053, 0.13}, {11, 0.018, 0.032, 0.066}};
    FILE *file = fopen("data/tips/regions.csv", "r");
    char part[32], kind[16];
    double ratio, force, none[2][3], own[2][3];
    size_t compared = 0;
    ck_assert(file && fscanf(file, "%*[^\n]") == 0);
    while (fscanf(file, " %31[^,],%lf,%15[^,],%lf", part, &ratio, kind, &force) == 4) {
        const int k = kind[0] == 'p' ? 0 : kind[1] == 'h' ? 1 : 2, r = ratio > 0.3;
        const size_t n = BOUND[_i].nodes;
        if (strcmp(part, "none") == 0) {
            none[r][k] = force;
            own[r][k] = load(kind, n, ratio, NULL);
            continue;
        }
        const palp_region region = strcmp(part, "capsule") == 0 ? capsule(ratio) : part_called(part);
        const double off = load(kind, n, ratio, &region) / own[r][k] / (force / none[r][k]) - 1.0;
        const double most = k < 2                             ? BOUND[_i].plate
                            : strcmp(part, "stiff_skin") == 0 ? BOUND[_i].skin
                                                              : BOUND[_i].sphere;
        ck_assert_msg(fabs(off) < most, "%zu nodes, %s, %g, %s: off by %.3f", n, part, ratio, kind, off);
        compared++;
    }
    fclose(file);
    ck_assert_uint_eq(compared, 40);
}
END_TEST

/* A region that moves and stiffens is one of a network made so, the later region and the cells' volume too.
 * A smooth surface is stiffer with it. */
START_TEST(a_region_that_moves) {
    const palp_material m = spring_with_arm(6.0, 2.0, 1.0);
    palp_region before[2] = {nodule(3.0), layer("layer", 0.9 * HEIGHT, HEIGHT)}, after[2];
    before[1].stiffness = 5.0;
    memcpy(after, before, sizeof after);
    after[0].centre_m[0] = after[0].centre_m[1] = 0.8 * HEIGHT;
    after[0].stiffness = 11.0;
    palp_mesh *old = solid_cube(5), *new = solid_cube(5);
    palp_network *moved = with_regions(old, &m, 0.4, 2, before), *made = with_regions(new, &m, 0.4, 2, after);
    const palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                            .position_m = {HEIGHT + 4e-3, 0.8 * HEIGHT, 0.5 * HEIGHT},
                            .radius_m = 5e-3};
    palp_contact_settings touch = palp_contact_settings_default();
    palp_tool_force felt[2];
    const double *part;
    touch.subdivisions = 1;
    ck_assert_int_eq(palp_network_enable_tools(moved, 1, 0, &touch), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(made, 1, 0, &touch), PALP_OK);
    ck_assert_int_eq(palp_mesh_region(palp_network_mesh(made), "nodule", &part), PALP_OK);
    ck_assert_int_eq(palp_network_step(moved, 1e-3, 0.1, NULL), PALP_OK);
    ck_assert_int_eq(network_change_region(moved, 0, part, 11.0), PALP_OK);
    for (size_t i = 0; i < made->n_elements; i++)
        ck_assert_double_eq_tol(moved->scale[i], made->scale[i], 1e-14 * made->scale[i]);
    ck_assert_int_eq(palp_network_set_tools(moved, 1, &tool), PALP_OK);
    ck_assert_int_eq(palp_network_set_tools(made, 1, &tool), PALP_OK);
    for (int i = 1; i <= 2; i++) {
        palp_step_info one, two;
        ck_assert_int_eq(palp_network_step(moved, 1e-3 * i, 0.1, &one), PALP_OK);
        ck_assert_int_eq(palp_network_step(made, 1e-3 * i, 0.1, &two), PALP_OK);
        ck_assert_double_eq_tol(one.force_N, two.force_N, 1e-9 * two.force_N);
        ck_assert_int_eq(palp_network_tool_force(moved, &felt[0]), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(made, &felt[1]), PALP_OK);
        ck_assert_double_eq_tol(felt[0].force_N[0], felt[1].force_N[0], 1e-9 * fabs(felt[1].force_N[0]));
    }
    ck_assert_double_gt(fabs(felt[1].force_N[0]), 1e-3);
    palp_mesh_free(old);
    palp_mesh_free(new);
    palp_network_free(moved);
    palp_network_free(made);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_test(tc, a_factor_is_a_material);
    tcase_add_test(tc, all_of_the_mesh);
    tcase_add_loop_test(tc, all_of_the_mesh_under_a_sphere, 0, 2);
    tcase_add_test(tc, the_later_region_counts);
    tcase_add_test(tc, layers_in_series);
    tcase_add_loop_test(tc, derivatives, 0, 2);
    tcase_add_test(tc, weights_are_those_of_its_own_material);
    tcase_add_test(tc, states);
    tcase_add_test(tc, in_real_time);
    tcase_add_test(tc, cut_and_whole_again);
    tcase_add_test(tc, beyond_the_range_of_a_region);
    tcase_add_test(tc, membrane);
    tcase_add_test(tc, a_region_that_moves);
    tcase_add_test(tc, what_is_refused);
    tcase_add_loop_test(tc, as_calculix_has_it, 0, 3);
}
