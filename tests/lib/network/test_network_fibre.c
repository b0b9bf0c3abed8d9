/* test_network_fibre.c: fibres of regions, against closed forms, finite differences and CalculiX. */
#include "cut_make.h"
#include "network_settle.h"
#include "tangent_make.h"

#include <stdio.h>

static const double SPRINGS = 8.18; /* N */
static const double DEGREE = 3.141592653589793 / 180.0;
static const palp_support BONDED[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}},
                                      {"top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}}};

static palp_material tissue(void) {
    palp_material m = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(1, &SPRINGS, &m.law), PALP_OK);
    return m;
}

/* Fibres everywhere, at an angle to y in the plane of x and y. */
static palp_region fibres(const char *name, double degrees, double modulus) {
    palp_region r = {.shape = PALP_REGION_BOX,
                     .low_m = {-1, -1, -1},
                     .high_m = {1, 1, 1},
                     .stiffness = 1.0,
                     .fibre = {3.0 * sin(degrees * DEGREE), 3.0 * cos(degrees * DEGREE), 0.0},
                     .fibre_Pa = modulus};
    strcpy(r.name, name);
    return r;
}

static palp_network *with_regions(palp_mesh *mesh, const palp_material *m, double ratio, size_t n_supports,
                                  const palp_support *supports, size_t n, const palp_region *region) {
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    palp_error error = {PALP_OK, ""};
    settings.poisson_ratio = ratio;
    settings.edge_correction = true;
    settings.tolerance = 1e-9;
    settings.n_regions = n;
    settings.regions = region;
    for (size_t r = 0; r < n; r++)
        ck_assert_int_eq(palp_region_place_in(mesh, &region[r], NULL), PALP_OK);
    const palp_status status = palp_network_create(mesh, m, n_supports, supports, &settings, &net, &error);
    ck_assert_msg(!status, "%s", error.text);
    return net;
}

static palp_network *cube_of(size_t n, const palp_material *m, double ratio, size_t n_regions,
                             const palp_region *region) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    palp_network *net = with_regions(mesh, m, ratio, 2, BONDED, n_regions, region);
    palp_mesh_free(mesh);
    return net;
}

static double force_at(palp_network *net, double depth) {
    const palp_status status = palp_network_step(net, depth, INFINITY, NULL);
    ck_assert_msg(!status, "%s", palp_status_text(status));
    const double force = palp_network_force(net);
    palp_network_free(net);
    return force;
}

/* Nothing gives way sideways: the stretch s of the height alone changes I4 by (s^2 - 1) cos^2, and the plate
 * feels E / 2 s (s^2 - 1) cos^4 more on its area. */
START_TEST(stretched_and_pressed) {
    const palp_material m = tissue();
    const double angle[] = {0.0, 30.0, 45.0, 90.0}, modulus = 3e4;
    for (size_t i = 0; i < 4; i++)
        for (double s = 0.6; s < 1.5; s += 0.2) {
            const palp_region region = fibres("muscle", angle[i], modulus);
            const double depth = (1.0 - s) * HEIGHT, along = pow(cos(angle[i] * DEGREE), 4.0),
                         plain = force_at(cube_of(2, &m, 0.0, 0, NULL), depth),
                         own = force_at(cube_of(2, &m, 0.0, 1, &region), depth);
            ck_assert_double_eq_tol(own - plain, -0.5 * modulus * along * s * (s * s - 1.0) * HEIGHT * HEIGHT,
                                    1e-7);
        }
}
END_TEST

static palp_network *free_block(double ratio, const palp_region *region) {
    const palp_material m = tissue();
    const palp_support supports[] = {{"bottom", {PALP_FREE, PALP_FIXED, PALP_FREE}, {0, 0, 0}},
                                     {"top", {PALP_FREE, PALP_DRIVEN, PALP_FREE}, {0, -1, 0}},
                                     {"corner", {PALP_FIXED, PALP_FREE, PALP_FIXED}, {0, 0, 0}},
                                     {"side", {PALP_FREE, PALP_FREE, PALP_FIXED}, {0, 0, 0}}};
    palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26);
    const double *x = palp_mesh_positions(mesh);
    int32_t corner = -1, side = -1;
    for (int32_t i = 0; i < 64; i++)
        if (x[3 * i + 1] == 0.0 && x[3 * i + 2] == 0.0) {
            corner = x[3 * i] == 0.0 ? i : corner;
            side = x[3 * i] > 0.9 * HEIGHT ? i : side;
        }
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "corner", 1, &corner), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "side", 1, &side), PALP_OK);
    palp_network *net = with_regions(mesh, &m, ratio, 4, supports, region != NULL, region);
    palp_mesh_free(mesh);
    return net;
}

/* A block between smooth plates strains evenly. Fibres take b^2 / (E + E_f) E_f / E from its compliance 1 /
 * E, b = (1 + ratio) cos^2 - ratio. */
START_TEST(modulus_by_angle) {
    const double angle[] = {0.0, 30.0, 45.0, 90.0}, ratios[] = {0.25, 0.45};
    for (size_t r = 0; r < 2; r++)
        for (size_t i = 0; i < 4; i++) {
            const double strain = 1e-5, section = HEIGHT * HEIGHT,
                         young = 0.8 * (1.0 + ratios[r]) * SPRINGS / section, modulus = 3.0 * young,
                         cosine = cos(angle[i] * DEGREE), b = (1.0 + ratios[r]) * cosine * cosine - ratios[r];
            const palp_region region = fibres("muscle", angle[i], modulus);
            const double wanted = 1.0 / (1.0 - b * b * modulus / (young + modulus)),
                         plain = force_at(free_block(ratios[r], NULL), strain * HEIGHT),
                         own = force_at(free_block(ratios[r], &region), strain * HEIGHT);
            ck_assert_double_eq_tol(plain, young * section * strain, 1e-4 * plain);
            ck_assert_double_eq_tol(own / plain, wanted, (i % 3 == 0 ? 1e-4 : 1e-3) * wanted);
        }
}
END_TEST

/* Bonded plates at small strain, as CalculiX has them with an anisotropic elastic law. */
START_TEST(as_calculix_has_it) {
    const palp_material m = tissue();
    FILE *file = fopen("data/tips/fibres.csv", "r");
    double ratio, angle, modulus, force;
    size_t rows = 0;
    ck_assert(file && fscanf(file, "%*[^\n]") == 0);
    while (fscanf(file, "%lf,%lf,%lf,%lf", &ratio, &angle, &modulus, &force) == 4) {
        const double young = 0.8 * (1.0 + ratio) * SPRINGS / (HEIGHT * HEIGHT), strain = 1e-5,
                     unit = young * strain * HEIGHT * HEIGHT * force;
        const palp_region region = fibres("muscle", angle, modulus * young);
        double off[2];
        for (size_t i = 0; i < 2; i++)
            off[i] =
                force_at(cube_of(i ? 11 : 7, &m, ratio, modulus > 0.0, &region), strain * HEIGHT) / unit -
                1.0;
        ck_assert_double_lt(fabs(off[0]), 0.026);
        ck_assert_double_lt(fabs(off[1]), 0.011);
        rows++;
    }
    fclose(file);
    ck_assert_uint_eq(rows, 10);
}
END_TEST

typedef struct dense_blocks {
    double *k;
    size_t n;
} dense_blocks;

static void take(void *user, int32_t row, int32_t column, const double k[9]) {
    dense_blocks *to = user;
    for (size_t i = 0; i < 9; i++) {
        const size_t r = 3 * (size_t)row + i / 3, c = 3 * (size_t)column + i % 3;
        to->k[r * to->n + c] += k[i];
        if (row != column)
            to->k[c * to->n + r] += k[i];
    }
}

/* Forces are the slope of the energy, the tangent that of the forces, its blocks the tangent. Cells of a
 * lattice, and of a mesh of tetrahedra; two directions that share cells. */
START_TEST(derivatives) {
    const palp_material m = tissue();
    const double h = 1e-8;
    for (int solids = 0; solids < 2; solids++) {
        palp_region region[] = {fibres("one", 20.0, 2e4), fibres("two", 75.0, 5e4)};
        region[1].low_m[0] = 0.4 * HEIGHT;
        region[1].fibre[2] = 1.0;
        palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26);
        if (solids)
            mesh->n_hexahedra = 0;
        palp_network *net = with_regions(mesh, &m, 0.0, 2, BONDED, 2, region);
        palp_mesh_free(mesh);
        const size_t n = 3 * net->n_nodes;
        double *x = calloc(5 * n, sizeof *x), *u = x + n, *k = u + n, *low = k + n, *high = low + n;
        dense_blocks blocks = {calloc(n * n, sizeof(double)), n};
        ck_assert(x && blocks.k);
        ck_assert_int_eq(network_begin(net, 0.0, INFINITY), PALP_OK);
        for (size_t i = 0; i < n; i++) {
            x[i] = net->rest[i] + (net->dof[i] < 0 ? 0.0 : 0.1 * HEIGHT / 3.0 * sin(1.7 * (double)(i * i)));
            u[i] = net->dof[i] < 0 ? 0.0 : cos(2.3 * (double)i);
        }
        residual_at(net, x, u, -h, low);
        residual_at(net, x, u, h, high);
        const double before = energy_at(net, x, u, -h), after = energy_at(net, x, u, h);
        double along = 0.0, largest = 0.0;
        energy_at(net, x, u, 0.0);
        network_set_diagonal(net, 0.0);
        network_tangent_times(net, u, k);
        for (size_t i = 0; i < n; i++) {
            along += 0.5 * (low[i] + high[i]) * u[i];
            largest = fmax(largest, fabs(k[i]));
        }
        ck_assert_double_eq_tol((before - after) / (2.0 * h), along, 1e-5 * fabs(along));
        for (size_t i = 0; i < n; i++)
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol((low[i] - high[i]) / (2.0 * h), k[i], 1e-5 * largest);
        network_term *term = net->terms[net->n_terms - 1];
        ck_assert_double_eq(term->kind->spread, solids ? 4.0 : 8.0);
        memset(k, 0, n * sizeof *k);
        term->kind->times(term, net, u, k);
        for (size_t part = 0; part < 3; part++)
            term->kind->blocks_part(term, net, part, 3, take, &blocks);
        for (size_t i = 0; i < n; i++)
            ck_assert_double_eq_tol(network_dot(blocks.k + i * n, u, n), k[i], 1e-9 * largest);
        free(blocks.k);
        free(x);
        palp_network_free(net);
    }
}
END_TEST

/* Where regions overlap the later one counts, and a part of a cell has that part of its fibres. */
START_TEST(overlap) {
    const palp_material m = tissue();
    const double depth = 1e-3 * HEIGHT;
    palp_region both[] = {fibres("fibres", 0.0, 4e4), fibres("none", 0.0, 0.0)},
                half = fibres("half", 0.0, 4e4);
    const double plain = force_at(cube_of(2, &m, 0.0, 0, NULL), depth),
                 all = force_at(cube_of(2, &m, 0.0, 1, both), depth);
    ck_assert_double_gt(all, 2.0 * plain);
    ck_assert_double_eq_tol(force_at(cube_of(2, &m, 0.0, 2, both), depth), plain, 1e-9 * plain);
    half.high_m[0] = 0.5 * HEIGHT;
    ck_assert_double_eq_tol(force_at(cube_of(2, &m, 0.0, 1, &half), depth), 0.5 * (plain + all), 0.02 * all);
}
END_TEST

/* A cut through all cells of a layer leaves no force. */
START_TEST(cut_through) {
    const palp_material m = tissue();
    const palp_region region = fibres("muscle", 0.0, 4e4);
    palp_network *net = cube_of(4, &m, 0.0, 1, &region);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, -0.05 * HEIGHT, INFINITY, NULL), PALP_OK);
    ck_assert_double_lt(palp_network_force(net), -0.5);
    ck_assert_uint_gt(cut_level(net, 0.45 * HEIGHT, 1.0), 0);
    ck_assert_int_eq(palp_network_step(net, -0.05 * HEIGHT, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_force(net), 0.0, 1e-8);
    palp_network_free(net);
}
END_TEST

/* Ticks come to the same as converged steps, with cells that fibres pull together. */
START_TEST(in_real_time) {
    const palp_material m = tissue();
    const palp_budget all = {.force_error = 1e-9};
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_region region = fibres("muscle", 35.0, 4e4);
    for (size_t n = 5; n <= 11; n += 6) {
        palp_network *net = cube_of(n, &m, 0.45, 1, &region), *same = cube_of(n, &m, 0.45, 1, &region);
        palp_realtime *rt;
        ck_assert_int_eq(palp_realtime_create(same, &settings, &rt), PALP_OK);
        for (int i = 1; i <= 10; i++) {
            palp_step_info info;
            palp_tick_info tick;
            ck_assert_int_eq(palp_network_step(net, 2e-4 * i, 0.02, &info), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(rt, 2e-4 * i, 0.02, &all, &tick), PALP_OK);
            ck_assert(tick.converged);
            ck_assert_double_eq_tol(tick.force_N, info.force_N, 1e-6 * info.force_N);
        }
        palp_realtime_free(rt);
        palp_network_free(net);
        palp_network_free(same);
    }
}
END_TEST

START_TEST(refused) {
    const palp_material m = tissue();
    const double wrong[] = {-1.0, NAN, INFINITY};
    palp_network_settings settings = palp_network_settings_default();
    palp_region region = fibres("muscle", 0.0, 1e4);
    palp_network *net = NULL;
    palp_error error;
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26), *six = cube(3, PALP_NEIGHBOURS_6);
    settings.n_regions = 1;
    settings.regions = &region;
    ck_assert_int_eq(palp_region_place_in(mesh, &region, NULL), PALP_OK);
    ck_assert_int_eq(palp_region_place_in(six, &region, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_create(six, &m, 2, BONDED, &settings, &net, &error), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(error.text, "fibres"));
    for (size_t i = 0; i < 6; i++) {
        region = fibres("muscle", 0.0, i < 3 ? wrong[i] : 1e4);
        for (size_t k = 0; k < 3 && i >= 3; k++)
            region.fibre[k] = i == 3 ? 0.0 : wrong[i - 3];
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, BONDED, &settings, &net, &error),
                         PALP_ERR_ARGUMENT);
        ck_assert_ptr_nonnull(strstr(error.text, "muscle"));
    }
    palp_mesh_free(mesh);
    palp_mesh_free(six);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, stretched_and_pressed);
    tcase_add_test(tc, modulus_by_angle);
    tcase_add_test(tc, as_calculix_has_it);
    tcase_add_test(tc, derivatives);
    tcase_add_test(tc, overlap);
    tcase_add_test(tc, cut_through);
    tcase_add_test(tc, in_real_time);
    tcase_add_test(tc, refused);
}
