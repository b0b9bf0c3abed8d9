/* bench_static.c: the seed's fixed point on 27 nodes with all of its 97000 steps solved, beside the same by
 * error-controlled continuation and interpolation; then its three phases on the law found. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STEPS = 97000, ITERATIONS = 10, HOLD_STEPS = 201000 };

typedef struct press {
    double *x, *depth, *force; /* time or nothing, m, N */
} press;

static press press_make(size_t n) {
    press p = {malloc(n * sizeof(double)), malloc(n * sizeof(double)), malloc(n * sizeof(double))};
    bench_check(p.x && p.depth && p.force ? PALP_OK : PALP_ERR_NO_MEMORY, "press");
    return p;
}

static void press_free(press *p) {
    free(p->x);
    free(p->depth);
    free(p->force);
}

static palp_model read_lumped(void) {
    palp_model model;
    palp_error error = {PALP_OK, ""};
    bench_check(palp_model_read("data/sedef2008/lumped_n1.json", &model, NULL, &error), error.text);
    return model;
}

static double fixed_point(const palp_model *lumped, const press *p, bool every_step, size_t iterations,
                          palp_calibration *result) {
    palp_static_settings settings = palp_static_settings_default();
    palp_material start = lumped->material;
    start.n_arms = 0;
    palp_network *net = bench_network(3, NULL, &start, PALP_SOLVER_AUTO);
    settings.max_evaluations = iterations;
    settings.every_step = every_step;
    double begin = bench_seconds();
    bench_check(palp_thesis_fixed_point(net, &start, STEPS, p->depth, p->force, &settings, result),
                "fixed point");
    double seconds = bench_seconds() - begin;
    palp_network_free(net);
    return seconds;
}

/* The three phases of a 6 mm press in 1 s, 1 ms steps, on the law of the static stage. */
static double three_phase(const palp_model *lumped, const palp_law *law, palp_calibration *result) {
    palp_three_phase_settings settings = palp_three_phase_settings_default();
    palp_material start = lumped->material;
    palp_path path;
    press p = press_make(HOLD_STEPS + 1);
    bench_check(palp_path_ramp_hold(6e-3, 1.0, 200.0, &path), "path");
    for (size_t i = 0; i <= HOLD_STEPS; i++) {
        p.x[i] = 1e-3 * (double)i;
        p.depth[i] = palp_path_at(&path, p.x[i]);
    }
    bench_check(palp_lumped_run(&lumped->material, lumped->height_m, HOLD_STEPS + 1, p.x, p.depth, p.force),
                "run");
    palp_target target = {.path = path, .n = HOLD_STEPS + 1, .time_s = p.x, .force_N = p.force};
    start.law = *law;
    start.formulation = PALP_SEDEF2008;
    palp_network *net = bench_network(3, NULL, &start, PALP_SOLVER_AUTO);
    double begin = bench_seconds();
    bench_check(palp_thesis_three_phase(net, &start, &target, &settings, result), "three phases");
    double seconds = bench_seconds() - begin;
    palp_network_free(net);
    palp_path_free(&path);
    press_free(&p);
    return seconds;
}

int main(void) {
    palp_model lumped = read_lumped();
    press p = press_make(STEPS);
    for (size_t i = 0; i < STEPS; i++) {
        p.depth[i] = 9.7e-3 * (double)(i + 1) / STEPS;
        p.x[i] = p.depth[i] / lumped.height_m;
    }
    palp_law_force(&lumped.material.law, STEPS, p.x, p.force, NULL, NULL);

    palp_calibration steps, curve, phases;
    double slow = fixed_point(&lumped, &p, true, ITERATIONS, &steps);
    double fast = fixed_point(&lumped, &p, false, ITERATIONS, &curve), most = 0.0;
    printf("fixed point, 27 nodes, %d iterations of %d steps\n  residual, N, every step:", ITERATIONS, STEPS);
    for (size_t i = 0; i < steps.n_iterations && i < curve.n_iterations; i++) {
        double a = steps.iterations[i].residual_N, b = curve.iterations[i].residual_N;
        most = fmax(most, fabs(a - b) / a);
        printf(" %.6g", a);
    }
    printf("\n  continuation and interpolation: the same to %.1e\n", most);
    printf("  every step %.2f s (at most 20), continuation %.3f s (at most 0.2), ratio %.0f\n", slow, fast,
           slow / fast);
    palp_calibration_free(&curve);
    double whole = fixed_point(&lumped, &p, false, 60, &curve);
    double phase = three_phase(&lumped, &curve.material.law, &phases);
    printf("three phases, 27 nodes, 6 mm in 1 s, 1 ms steps, %zu iterations\n", phases.n_iterations);
    printf("  static stage %.3f s, phases %.2f s, together %.2f s (at most 2)\n", whole, phase,
           whole + phase);
    palp_calibration_free(&steps);
    palp_calibration_free(&curve);
    palp_calibration_free(&phases);
    press_free(&p);
    return most < 1e-3 ? 0 : 1;
}
