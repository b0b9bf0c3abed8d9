/* test_network_volume.c: tetrahedra that resist a change of their volume. */
#include "network_make.h"
#include "network_settle.h"
#include "tangent_make.h"

#include <palpate/realtime.h>

static const double MODULUS = 2e4; /* Pa */

static palp_network *solid(size_t n, const palp_material *m, double modulus) {
    palp_network_settings settings = palp_network_settings_default();
    settings.volume_modulus_Pa = modulus;
    return cube_network(n, m, &settings);
}

static double tilt(size_t i) {
    return 0.1 * sin(1.7 * (double)i) * HEIGHT / 4.0;
}

/* Nodes off their places, some tetrahedra nearly flat or inside out. */
static void disorder(palp_network *net, double size) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.x[i] = net->rest[i] + (net->dof[i] < 0 ? 0.0 : size * tilt(i));
}

/* Forces are the gradient of the energy and the tangent is theirs, assembled or times a vector, also with
 * flat tetrahedra. */
START_TEST(derivatives) {
    const palp_material m = quartic(0);
    const double sizes[] = {0.3, 1.0, 8.0}, h = 1e-8;
    for (size_t s = 0; s < 3; s++) {
        palp_network *net = solid(4, &m, MODULUS);
        const size_t n = 3 * net->n_nodes;
        double *x = calloc(n, sizeof *x), *u = calloc(n, sizeof *u), *k = calloc(n, sizeof *k),
               *low = calloc(n, sizeof *low), scale;
        ck_assert(x && u && k && low);
        ck_assert_int_eq(network_begin(net, 0.0, INFINITY), PALP_OK);
        disorder(net, sizes[s]);
        memcpy(x, net->next.x, n * sizeof *x);
        for (size_t i = 0; i < n; i++)
            u[i] = net->dof[i] < 0 ? 0.0 : cos(2.3 * (double)i);
        double before = energy_at(net, x, u, -h), after = energy_at(net, x, u, h);
        ck_assert_double_eq_tol(energy_at(net, x, u, 0.0), 0.5 * (before + after), 1e-6 * before);
        network_residual(net, &scale);
        network_set_diagonal(net, 0.0);
        memcpy(k, net->diagonal, n * sizeof *k);
        network_tangent_times(net, u, k);
        double along = 0.0, largest = 0.0;
        for (size_t i = 0; i < n; i++)
            along += net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]] * u[i];
        ck_assert_double_eq_tol((before - after) / (2.0 * h), along, 1e-5 * fabs(along));
        energy_at(net, x, u, -h);
        network_residual(net, &scale);
        for (size_t i = 0; i < n; i++)
            low[i] = net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]];
        energy_at(net, x, u, h);
        network_residual(net, &scale);
        for (size_t i = 0; i < n; i++)
            largest = fmax(largest, net->dof[i] < 0 ? 0.0 : fabs(k[i]));
        for (size_t i = 0; i < n; i++)
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol((low[i] - net->rhs[net->dof[i]]) / (2.0 * h), k[i], 1e-5 * largest);
        free(x);
        free(u);
        free(k);
        free(low);
        palp_network_free(net);
    }
}
END_TEST

/* Nothing gives way sideways: all of the volume goes with the depth, and the plate feels k A (1 / J - 1)
 * more. */
START_TEST(confined) {
    const palp_material m = quartic(0);
    const palp_support supports[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}},
                                     {"top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}},
                                     {"left", {PALP_FIXED, PALP_FREE, PALP_FREE}, {0, 0, 0}},
                                     {"right", {PALP_FIXED, PALP_FREE, PALP_FREE}, {0, 0, 0}},
                                     {"back", {PALP_FREE, PALP_FREE, PALP_FIXED}, {0, 0, 0}},
                                     {"front", {PALP_FREE, PALP_FREE, PALP_FIXED}, {0, 0, 0}}};
    palp_mesh *mesh = cube(2, PALP_NEIGHBOURS_26);
    double force[2];
    for (int i = 1; i <= 4; i++) {
        const double ratio = 1.0 - 0.1 * i;
        for (int with = 0; with < 2; with++) {
            palp_network_settings settings = palp_network_settings_default();
            palp_network *net;
            palp_step_info info;
            settings.volume_modulus_Pa = with * MODULUS;
            ck_assert_int_eq(palp_network_create(mesh, &m, 6, supports, &settings, &net, NULL), PALP_OK);
            palp_status status = palp_network_step(net, (1.0 - ratio) * HEIGHT, INFINITY, &info);
            ck_assert_msg(status == PALP_OK, "%s", palp_status_text(status));
            force[with] = info.force_N;
            palp_network_free(net);
        }
        ck_assert_double_eq_tol(force[1] - force[0], MODULUS * HEIGHT * HEIGHT * (1.0 / ratio - 1.0),
                                1e-9 * force[1]);
    }
    palp_mesh_free(mesh);
}
END_TEST

/* A fine lattice that folds without it is pressed on, with every tetrahedron the right way round. */
START_TEST(does_not_fold) {
    const palp_material m = quartic(0);
    const double rest = 2.5e5; /* Pa, about this lattice's own modulus */
    size_t worst[2] = {0};
    bool through[2] = {true, true};
    for (int with = 0; with < 2; with++) {
        palp_network *net = solid(11, &m, with * rest);
        palp_step_info info;
        for (int i = 1; i <= 48 && through[with]; i++) {
            through[with] = palp_network_step(net, 2e-4 * i, INFINITY, &info) == PALP_OK;
            worst[with] = info.inverted > worst[with] ? info.inverted : worst[with];
        }
        palp_network_free(net);
    }
    ck_assert(!through[0] || worst[0] > 0);
    ck_assert(through[1]);
    ck_assert_uint_eq(worst[1], 0);
}
END_TEST

/* Steps within a tick come to the same as converged ones, with arms. */
START_TEST(realtime) {
    const palp_material m = quartic(2);
    const palp_budget all = {.force_error = 1e-9};
    palp_realtime_settings settings = palp_realtime_settings_default();
    for (size_t n = 5; n <= 11; n += 6) {
        palp_network *net = solid(n, &m, 1e5), *same = solid(n, &m, 1e5);
        palp_realtime *rt;
        ck_assert_int_eq(palp_realtime_create(same, &settings, &rt), PALP_OK);
        for (int i = 1; i <= 10; i++) {
            palp_step_info info;
            palp_tick_info tick;
            ck_assert_int_eq(palp_network_step(net, 4e-4 * i, 0.02, &info), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(rt, 4e-4 * i, 0.02, &all, &tick), PALP_OK);
            ck_assert(tick.converged);
            ck_assert_double_eq_tol(tick.force_N, info.force_N, 1e-7 * info.force_N);
        }
        palp_realtime_free(rt);
        palp_network_free(net);
        palp_network_free(same);
    }
}
END_TEST

static double to_and_fro(int i) {
    return 0.003 + 0.002 * sin(0.025 * i);
}

/* The preconditioner includes the tetrahedra. One correction after each step of an oscillating plate leaves a
 * tenth of the error without them: 1.4e-4 of the peak with 7 nodes a side and one level, 1.9e-4 with 11. A
 * restored state continues with the same bits. */
START_TEST(preconditioned) {
    const palp_budget all = {.force_error = 1e-9}, one = {.corrections = 1};
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_material m = quartic(0);
    for (size_t n = 7; n <= 11; n += 4) {
        const double share = 7.0 / (double)n * 7.0 / (double)n;
        double c[5] = {0.0611 * share, 0.0153 * share, 0.510 * share, -1.516 * share, 0.797 * share},
               worst = 0.0, peak = 0.0;
        ck_assert_int_eq(palp_law_polynomial(5, c, &m.law), PALP_OK);
        palp_network *net = solid(n, &m, 1.42e4), *same = solid(n, &m, 1.42e4);
        palp_realtime *exact, *rt;
        unsigned char *saved = NULL;
        double again = 0.0;
        ck_assert_int_eq(palp_realtime_create(net, &settings, &exact), PALP_OK);
        ck_assert_int_eq(palp_realtime_create(same, &settings, &rt), PALP_OK);
        const size_t size = palp_realtime_state_size(rt);
        for (int i = 0; i < 300; i++) {
            const double depth = to_and_fro(i);
            palp_tick_info wanted, got;
            if (i == 250) {
                ck_assert_ptr_nonnull(saved = malloc(size));
                ck_assert_int_eq(palp_realtime_save(rt, saved, size), PALP_OK);
            }
            ck_assert_int_eq(palp_realtime_step(exact, depth, INFINITY, &all, &wanted), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(rt, depth, INFINITY, &one, &got), PALP_OK);
            peak = fmax(peak, wanted.force_N);
            worst = i < 5 ? 0.0 : fmax(worst, fabs(got.force_N - wanted.force_N));
            again = got.force_N;
        }
        ck_assert_msg(worst < 3e-5 * peak, "%zu nodes: %g", n, worst / peak);
        ck_assert_int_eq(palp_realtime_restore(rt, saved, size), PALP_OK);
        palp_tick_info got;
        for (int i = 250; i < 300; i++)
            ck_assert_int_eq(palp_realtime_step(rt, to_and_fro(i), INFINITY, &one, &got), PALP_OK);
        ck_assert(got.force_N == again);
        free(saved);
        palp_realtime_free(exact);
        palp_realtime_free(rt);
        palp_network_free(net);
        palp_network_free(same);
    }
}
END_TEST

START_TEST(refused) {
    const palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_error error;
    palp_supports_default(supports);
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_18);
    settings.volume_modulus_Pa = MODULUS;
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, &error),
                     PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(error.text, "26 neighbours"));
    palp_mesh_free(mesh);
    mesh = cube(3, PALP_NEIGHBOURS_26);
    const double wrong[] = {-1.0, NAN, INFINITY};
    for (size_t i = 0; i < 3; i++) {
        settings.volume_modulus_Pa = wrong[i];
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, &error),
                         PALP_ERR_ARGUMENT);
    }
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, derivatives);
    tcase_add_test(tc, confined);
    tcase_add_test(tc, does_not_fold);
    tcase_add_test(tc, realtime);
    tcase_add_test(tc, preconditioned);
    tcase_add_test(tc, refused);
}
