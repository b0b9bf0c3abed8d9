/* bench_growth.c: how time and memory grow with the network. An argument or BENCH_NODES sets the largest
 * number of nodes a side (default 21; 33 takes minutes and 3 GB). Each size runs in a process of its own. */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"
#include "network/network_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static size_t largest_asked(int argc, char **argv) {
    const char *text = argc > 1 ? argv[1] : getenv("BENCH_NODES");
    return text ? (size_t)strtoul(text, NULL, 10) : 21;
}

/* The network at rest pressed by 1 %, not yet relaxed: its tangent, factored. */
static double time_factor(palp_network *net) {
    int negative;
    element_step_prepare(&net->material, 0.1, &net->step);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    network_place(net, 0.01 * BENCH_SIZE);
    network_evaluate(net);
    network_assemble(net, 0.0);
    double start = bench_seconds();
    bench_check(linsys_factor(net->ls, &negative), "factor");
    return bench_seconds() - start;
}

static void measure_here(const char *name, size_t n, const char *file) {
    palp_material material = bench_material(2);
    palp_step_info info;
    double before = bench_peak_MB(), start = bench_seconds();
    palp_network *net = bench_network(n, file, &material, PALP_SOLVER_AUTO);
    double create = bench_seconds() - start, factor = time_factor(net);
    palp_network_reset(net);
    start = bench_seconds();
    bench_check(palp_network_step(net, 0.01 * BENCH_SIZE, INFINITY, &info), "step");
    double step = bench_seconds() - start;
    printf("%8s %8zu %9zu %10.2f %11.3f %11.3f %4d %11.1f %10.1f\n", name, net->n_elements, net->n_free,
           1e3 * create, 1e3 * factor, 1e3 * step, info.iterations,
           (double)linsys_value_count(net->ls) * sizeof(double) / 1048576.0, bench_peak_MB() - before);
    palp_network_free(net);
}

static void measure(const char *name, size_t n, const char *file) {
    int status = 0;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        measure_here(name, n, file);
        exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0 || status)
        printf("%8s failed\n", name);
}

int main(int argc, char **argv) {
    const size_t sizes[] = {3, 5, 7, 11, 15, 21, 27, 33};
    size_t largest = largest_asked(argc, argv);
    printf("growth, 24 mm cube, n nodes a side, quartic law and two arms, AUTO solver; a relaxed step of 1 "
           "%%\n");
    printf("%8s %8s %9s %10s %11s %11s %4s %11s %10s\n", "n", "elements", "unknowns", "create ms",
           "factor ms", "step ms", "it.", "matrix MB", "memory MB");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes && sizes[i] <= largest; i++) {
        char name[16];
        snprintf(name, sizeof name, "%zu", sizes[i]);
        measure(name, sizes[i], NULL);
    }
    measure("cylinder", 0, "data/meshes/cylinder_tetra.msh");
    return 0;
}
