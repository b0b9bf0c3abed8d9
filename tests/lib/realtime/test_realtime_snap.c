/* test_realtime_snap.c: where a branch of equilibria ends, a network with PALP_BRANCH_STABLE goes down to the
 * next stable one. */
#include "realtime_make.h"

/* Two bars of half span A and rise B (a von Mises truss), pressed in the middle through a long spring: all of
 * the same K. */
#define A 0.010
#define B 0.003
#define SPRING 0.3
static const double K = 2.0; /* N */

static palp_network *truss(palp_branch branch) {
    const double x[] = {-A, 0, 0, A, 0, 0, 0, B, 0, 0, B + SPRING, 0};
    static const int32_t pairs[] = {0, 2, 1, 2, 2, 3};
    palp_material m = {0};
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_support supports[3] = {[2] = {"apex", {PALP_FIXED, PALP_FREE, PALP_FIXED}, {0, 0, 0}}};
    palp_network_settings settings = palp_network_settings_default();
    settings.branch = branch;
    palp_supports_default(supports);
    ck_assert_int_eq(palp_law_polynomial(1, &K, &m.law), PALP_OK);
    ck_assert_int_eq(palp_mesh_create(4, x, 3, pairs, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "bottom", 2, (int32_t[]){0, 1}), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "top", 1, (int32_t[]){3}), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "apex", 1, (int32_t[]){2}), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 3, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* Force of the two bars upwards on what presses the apex at height y; the spring's at that height, pressed in
 * by depth. */
static double bars(double y) {
    double rest = hypot(A, B), length = hypot(A, y);
    return -2.0 * K * (length - rest) / rest * y / length;
}
static double spring(double y, double depth) {
    return K * (y - B + depth) / SPRING;
}

/* The next equilibrium down from height y: the spring presses more above it, less below. */
static double down_from(double y, double depth) {
    const double step = 1e-7;
    while (spring(y, depth) > bars(y))
        y -= step;
    double low = y, high = y + step;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        *(spring(middle, depth) > bars(middle) ? &high : &low) = middle;
    }
    return low;
}

/* By steps and by ticks: the apex is where the closed form has it, before the snap and after it, and what is
 * felt jumps. */
START_TEST(truss_snaps_to_its_other_side) {
    for (int ticks = 0; ticks < 2; ticks++) {
        palp_network *net = truss(PALP_BRANCH_STABLE);
        palp_realtime *rt = ticks ? realtime_on(net, false) : NULL;
        double y = B, before = 0.0, jump = 0.0;
        int snaps = 0;
        for (int i = 1; i <= 400; i++) {
            const double depth = 5e-5 * i;
            ck_assert_int_eq(ticks ? palp_realtime_step(rt, depth, INFINITY, &ALL, NULL)
                                   : palp_network_step(net, depth, INFINITY, NULL),
                             PALP_OK);
            double wanted = down_from(y, depth);
            ck_assert_double_eq_tol(palp_network_positions(net)[7], wanted, 1e-8);
            ck_assert_double_eq_tol(palp_network_force(net), spring(wanted, depth), 1e-8);
            if (wanted < y - 0.001) {
                snaps++;
                jump = before - palp_network_force(net);
            }
            y = wanted;
            before = palp_network_force(net);
        }
        ck_assert_int_eq(snaps, 1);
        ck_assert_double_gt(jump, 0.5 * K * B / SPRING);
        palp_realtime_free(rt);
        palp_network_free(net);
    }
}
END_TEST

/* 11 nodes a side fold near 9.15 mm. Ticks of a few corrections at a depth beyond it: the energy falls in
 * each of them, and they end at rest, at a smaller force than before, as one tick without limit does; the
 * branch that a plain network follows ends there. There are several stable branches below it, of 60.3, 63.79
 * and 63.82 N and energies that are 0.3 % apart: the way there decides which one is reached. */
START_TEST(lattice_goes_down_to_a_stable_branch) {
    const palp_budget few = {.corrections = 10};
    palp_network_settings settings = palp_network_settings_default();
    palp_material m = quartic(0);
    palp_tick_info info, once;
    settings.branch = PALP_BRANCH_STABLE;
    palp_network *net = cube_network(11, &m, &settings), *other = cube_network(11, &m, &settings);
    palp_realtime *rt = realtime_on(net, false), *straight = realtime_on(other, false);
    for (int i = 1; i <= 91; i++) {
        ck_assert_int_eq(palp_realtime_step(rt, 1e-4 * i, INFINITY, &ALL, &info), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(straight, 1e-4 * i, INFINITY, &ALL, &once), PALP_OK);
        ck_assert(info.converged && once.converged);
    }
    const double top = info.force_N;
    ck_assert_int_eq(palp_realtime_step(straight, 9.2e-3, INFINITY, &ALL, &once), PALP_OK);
    ck_assert_msg(once.converged && once.buckled, "%d %d %zu %g %g", once.converged, once.buckled,
                  once.corrections, once.residual, once.force_N);
    ck_assert_double_lt(once.force_N, 0.98 * top);
    double energy = INFINITY;
    info.converged = false;
    for (int i = 0; i < 400 && !info.converged; i++) {
        ck_assert_int_eq(palp_realtime_step(rt, 9.2e-3, INFINITY, &few, &info), PALP_OK);
        ck_assert_double_lt(palp_realtime_energy(rt), energy * (1.0 + 1e-13));
        energy = palp_realtime_energy(rt);
    }
    ck_assert(info.converged);
    ck_assert_double_lt(info.force_N, 0.98 * top);
    ck_assert_double_eq_tol(palp_realtime_energy(rt), palp_realtime_energy(straight), 5e-3 * energy);
    drop(rt);
    drop(straight);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, truss_snaps_to_its_other_side);
    tcase_add_test(tc, lattice_goes_down_to_a_stable_branch);
}
