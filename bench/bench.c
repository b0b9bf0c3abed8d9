/* bench.c: what the benches share. */
#define _GNU_SOURCE /* RUSAGE_THREAD */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>

const double BENCH_SIZE = 0.024;

static double read_clock(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double bench_seconds(void) {
    return read_clock(CLOCK_MONOTONIC);
}

double bench_cpu_seconds(void) {
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *x, size_t n) {
    qsort(x, n, sizeof *x, ascending);
    return n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

long bench_interruptions(void) {
#ifdef RUSAGE_THREAD
    struct rusage usage;
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_nivcsw;
#else
    return 0;
#endif
}

double bench_peak_MB(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024.0;
}

void bench_check(palp_status status, const char *what) {
    if (status) {
        fprintf(stderr, "%s: %s\n", what, palp_status_text(status));
        exit(1);
    }
}

palp_material bench_material(size_t n_arms) {
    const double c[] = {0.54, -2.34, 33.25, -124.03, 177.63};
    palp_material m = {.n_arms = n_arms, .arms = {{0.4, 0.2, 0.0, 0.0}, {0.2, 2.0, 0.0, 0.0}}};
    bench_check(palp_law_polynomial(5, c, &m.law), "law");
    return m;
}

palp_network *bench_network(size_t n, const char *file, const palp_material *material, palp_solver solver) {
    const size_t nodes[3] = {n, n, n};
    const double size[3] = {BENCH_SIZE, BENCH_SIZE, BENCH_SIZE};
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_error error = {PALP_OK, ""};
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_status status = file ? palp_mesh_read_gmsh(file, 1e-3, false, &mesh, &error)
                              : palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh);
    bench_check(status, file ? error.text : "mesh");
    settings.solver = solver;
    palp_supports_default(supports);
    status = palp_network_create(mesh, material, 2, supports, &settings, &net, &error);
    bench_check(status, error.text);
    palp_mesh_free(mesh);
    return net;
}
