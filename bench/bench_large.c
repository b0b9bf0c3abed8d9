/* bench_large.c: calibrating large lattices by palp_calibrate_two_level: rounds, time, memory, and how deep
 * each lattice's branch goes. An argument or BENCH_NODES sets the largest number of nodes a side (default 21;
 * 33 takes half a minute). Each size runs in a process of its own. */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SAMPLES = 1000, COARSE = 7 };

static void calibrate_here(size_t n, double depth) {
    const double lumped[] = {8.18, -0.70, 47.47, -131.36, 146.89}; /* N, data/sedef2008/lumped_n1.json */
    static double depths[SAMPLES], forces[SAMPLES];
    palp_material material = bench_material(0);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    palp_law law;
    double worst = 0.0;
    bench_check(palp_law_polynomial(5, lumped, &law), "law");
    for (int i = 0; i < SAMPLES; i++) {
        depths[i] = depth * (i + 1) / SAMPLES;
        double e = depths[i] / BENCH_SIZE;
        palp_law_force(&law, 1, &e, &forces[i], NULL, NULL);
    }
    double before = bench_peak_MB(), start = bench_seconds();
    palp_network *net = bench_network(n, NULL, &material, PALP_SOLVER_AUTO),
                 *coarse = bench_network(COARSE, NULL, &material, PALP_SOLVER_AUTO);
    bench_check(palp_calibrate_two_level(net, coarse, &material, SAMPLES, depths, forces, &settings, &result),
                "calibrate");
    for (int i = 0; i < SAMPLES && depths[i] <= result.reached_m; i++)
        worst = fmax(worst, fabs(result.force_N[i] - forces[i]) / forces[SAMPLES - 1]);
    printf("%8zu %9zu %8.1f %10.2f %7zu %12.4f %9.2f %10.1f\n", n, palp_network_unknown_count(net),
           1e3 * depth, 1e3 * result.reached_m, result.n_iterations, 100.0 * worst, bench_seconds() - start,
           bench_peak_MB() - before);
    palp_calibration_free(&result);
    palp_network_free(coarse);
    palp_network_free(net);
}

static void calibrate(size_t n, double depth) {
    int status = 0;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        calibrate_here(n, depth);
        exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0 || status)
        printf("%8zu failed\n", n);
}

int main(int argc, char **argv) {
    const size_t sizes[] = {9, 11, 15, 21, 27, 33};
    const char *text = argc > 1 ? argv[1] : getenv("BENCH_NODES");
    size_t largest = text ? (size_t)strtoul(text, NULL, 10) : 21;
    printf("static calibration through a lattice of %d nodes a side, 24 mm cube, lumped_n1, to 5 mm and to "
           "9.7 mm\n",
           COARSE);
    printf("%8s %9s %8s %10s %7s %12s %9s %10s\n", "n", "unknowns", "depth mm", "reached mm", "rounds",
           "worst error %", "time s", "memory MB");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes && sizes[i] <= largest; i++) {
        calibrate(sizes[i], 0.005);
        calibrate(sizes[i], 0.0097);
    }
    return 0;
}
