/* test_realtime_plate.c: a plate on random ways over lattices and meshes, with and without tetrahedra that
 * keep their volume: the estimate of the force's error holds in every tick. check: all */
#include "realtime_make.h"

#include <palpate/random.h>

enum { WAY_TICKS = 300, WAVES = 4 };

/* Four waves from 0.5 to 40 rad/s, pressed within 0.1 s. */
typedef struct way {
    const char *file; /* of a mesh, or NULL: a lattice of so many nodes a side */
    size_t nodes, n_arms;
    double modulus, dt, top, size[WAVES], rate[WAVES], phase[WAVES];
    bool scaled;
} way;

static double between(uint64_t *r, double low, double high) {
    return low + (high - low) * palp_random_uniform(r);
}

static double between_decades(uint64_t *r, double low, double high) {
    return exp(between(r, log(low), log(high)));
}

static way way_make(uint64_t seed, bool volume) {
    static const char *const files[] = {NULL, "box_tetra", "cylinder_tetra", "liver_7.5", "sphere_4.4"};
    uint64_t r = seed;
    palp_random_next(&r);
    way w = {.file = files[(size_t)between(&r, 0.0, 5.0)]};
    w.nodes = 4 + (size_t)between(&r, 0.0, 5.0);
    w.n_arms = (size_t)between(&r, 0.0, 4.0);
    w.modulus = volume ? between_decades(&r, 1e3, 5e5) : 0.0;
    w.dt = between_decades(&r, 5e-4, 1e-2);
    w.top = between(&r, 0.03, volume ? 0.18 : 0.12);
    w.scaled = palp_random_uniform(&r) < 0.7;
    for (size_t i = 0; i < WAVES; i++) {
        w.size[i] = between(&r, 0.0, 1.0) / (double)(1 + i);
        w.rate[i] = between_decades(&r, 0.5, 40.0);
        w.phase[i] = between(&r, 0.0, 6.283);
    }
    return w;
}

static double way_strain(const way *w, size_t tick) {
    const double time = w->dt * (double)(tick + 1);
    double sum = 0.0, all = 0.0;
    for (size_t i = 0; i < WAVES; i++) {
        sum += w->size[i] * sin(w->rate[i] * time + w->phase[i]);
        all += w->size[i];
    }
    return w->top * fmin(1.0, time / 0.1) * (0.6 + 0.4 * sum / all);
}

static palp_realtime *way_realtime(const way *w, double *height) {
    palp_network_settings settings = palp_network_settings_default();
    const palp_material m = quartic(w->n_arms);
    palp_mesh *mesh = NULL;
    char path[64];
    settings.volume_modulus_Pa = w->modulus;
    if (w->file) {
        snprintf(path, sizeof path, "data/meshes/%s.msh", w->file);
        ck_assert_int_eq(palp_mesh_read_gmsh(path, 1e-3, false, &mesh, NULL), PALP_OK);
        if (w->scaled)
            ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_VOLUME, 0.0, NULL), PALP_OK);
    } else {
        mesh = cube(w->nodes, PALP_NEIGHBOURS_26);
    }
    palp_network *net = network_on(mesh, &m, &settings);
    *height = !w->file                             ? HEIGHT
              : strncmp(w->file, "liver", 5) == 0  ? 0.030
              : strncmp(w->file, "sphere", 6) == 0 ? 0.018
                                                   : HEIGHT;
    palp_mesh_free(mesh);
    return realtime_on(net, false);
}

/* Converged forces, as far as the path does not come to where several answers are; returns how many ticks
 * that is. */
static size_t way_truth(const way *w, double *force, double *peak) {
    double height;
    palp_realtime *rt = way_realtime(w, &height);
    size_t n = 0;
    *peak = 0.0;
    for (; n < WAY_TICKS; n++) {
        palp_tick_info info;
        if (palp_realtime_step(rt, height * way_strain(w, n), w->dt, &ALL, &info) || info.buckled ||
            !info.converged)
            break;
        force[n] = info.force_N;
        *peak = fmax(*peak, fabs(force[n]));
    }
    drop(rt);
    return n;
}

/* The largest error beyond the estimate, of the peak. */
static double way_beyond(const way *w, size_t n, const double *force, double peak,
                         const palp_budget *budget) {
    double height, beyond = 0.0;
    palp_realtime *rt = way_realtime(w, &height);
    for (size_t i = 0; i < n; i++) {
        palp_tick_info info;
        ck_assert_int_eq(palp_realtime_step(rt, height * way_strain(w, i), w->dt, budget, &info), PALP_OK);
        ck_assert(isfinite(info.force_N) && isfinite(info.force_error_N));
        beyond = fmax(beyond, (fabs(info.force_N - force[i]) - info.force_error_N) / peak);
    }
    drop(rt);
    return beyond;
}

/* ALLOWED, of the peak: near folding of a scaled mesh the adjoint changes faster than ticks update it. The
 * estimate of a tick without a correction can then be too small by this. */
static void check_ways(uint64_t from, uint64_t to, bool volume) {
    static const double ALLOWED = 2e-4;
    static const palp_budget budgets[] = {{.force_error = 1e-2}, {.force_error = 1e-3}, {.force_error = 1e-4},
                                          {.corrections = 1},    {.corrections = 2},    {.corrections = 4},
                                          {.corrections = 10}};
    static double force[WAY_TICKS];
    size_t ticks = 0;
    for (uint64_t seed = from; seed < to; seed++) {
        const way w = way_make(seed, volume);
        double peak;
        const size_t n = way_truth(&w, force, &peak);
        ticks += n;
        for (size_t k = 0; k < sizeof budgets / sizeof *budgets; k++) {
            const double beyond = way_beyond(&w, n, force, peak, &budgets[k]);
            ck_assert_msg(beyond <= ALLOWED, "seed %d, budget %zu: %g of the peak beyond the estimate",
                          (int)seed, k, beyond);
        }
    }
    ck_assert_uint_gt(ticks, (to - from) * WAY_TICKS / 2); /* most of a path is looked at */
}

START_TEST(with_volume) {
    check_ways(1, 21, true);
}
END_TEST

START_TEST(springs_alone) {
    check_ways(1, 21, false);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, with_volume);
    tcase_add_test(tc, springs_alone);
}
