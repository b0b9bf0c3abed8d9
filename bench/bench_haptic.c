/* bench_haptic.c: a minute of a hand's tool at 1 kHz (data/paths/haptic_minute.csv): how long the ticks take,
 * how many are missed, and how far the force is from the converged one. Quartic law and two arms. Wall times
 * are of a shared machine; the thread's own time, and that of the ticks alone that nothing interrupted, is
 * nearer to what a machine without other work would show. BENCH_TICKS=60000 is the whole minute, some ten
 * minutes of work; the first ten seconds are one round of it. BENCH_CONTACT=triangles or 2 touches whole
 * triangles, or a smooth surface, instead of local points. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TICKS = 60000, ROWS_MAX = 7000 };
static const double DT = 1e-3, RADIUS = 4e-3;
static size_t n_ticks = 10000;

typedef struct recorded {
    size_t n;
    double time[ROWS_MAX], x[ROWS_MAX][3];
} recorded;

static void read_path(const char *file, recorded *p) {
    char line[256];
    FILE *f = fopen(file, "r");
    if (!f) {
        fprintf(stderr, "%s cannot be read\n", file);
        exit(1);
    }
    while (p->n < ROWS_MAX && fgets(line, sizeof line, f)) {
        double *x = p->x[p->n];
        if (sscanf(line, "%lf,%lf,%lf,%lf", &p->time[p->n], &x[0], &x[1], &x[2]) == 4)
            p->n++;
    }
    fclose(f);
}

/* Cubic through four rows (Catmull and Rom), m. */
static void at_time(const recorded *p, double t, double out[3]) {
    double s = fmin(t * 100.0, (double)(p->n - 1));
    size_t i = (size_t)s < p->n - 2 ? (size_t)s : p->n - 2, before = i > 0 ? i - 1 : 0;
    size_t after = i + 2 < p->n ? i + 2 : i + 1;
    double u = s - (double)i;
    for (size_t k = 0; k < 3; k++) {
        double a = p->x[before][k], b = p->x[i][k], c = p->x[i + 1][k], d = p->x[after][k];
        double slope0 = 0.5 * (c - a), slope1 = 0.5 * (d - b);
        double bend = 3.0 * (c - b) - 2.0 * slope0 - slope1, twist = 2.0 * (b - c) + slope0 + slope1;
        out[k] = 1e-3 * (b + u * (slope0 + u * (bend + u * twist)));
    }
}

static palp_realtime *tissue(size_t n, double tolerance) {
    const size_t nodes[3] = {n, n, n};
    const double size[3] = {BENCH_SIZE, BENCH_SIZE, BENCH_SIZE};
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    const char *surface = getenv("BENCH_CONTACT"); /* triangles, or a number of subdivisions */
    contact.local = !surface;
    contact.subdivisions = surface ? strtoul(surface, NULL, 10) : 0;
    palp_realtime_settings realtime = palp_realtime_settings_default();
    palp_realtime *rt;
    palp_material material = bench_material(2);
    palp_mesh *mesh;
    palp_network *net;
    settings.tolerance = tolerance;
    bench_check(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), "mesh");
    bench_check(palp_network_create(mesh, &material, 1, &bottom, &settings, &net, NULL), "network");
    palp_mesh_free(mesh);
    bench_check(palp_network_enable_tools(net, 1, 1, &contact), "tools");
    bench_check(palp_realtime_create(net, &realtime, &rt), "realtime");
    return rt;
}

typedef struct run {
    double force[TICKS][3];
    double wall[TICKS], cpu[TICKS],
        quiet[TICKS]; /* ms; quiet: own time of the ticks that were not interrupted */
    size_t n_quiet;
    size_t converged, corrections, touching;
} run;

static void follow(size_t n, double friction, double tolerance, const recorded *path,
                   const palp_budget *budget, run *r) {
    palp_realtime *rt = tissue(n, tolerance);
    palp_network *net = palp_realtime_network(rt);
    palp_tick_info info;
    palp_tool_force felt;
    r->n_quiet = r->converged = r->corrections = r->touching = 0;
    for (size_t i = 0; i < n_ticks; i++) {
        palp_tool tool = {
            .shape = PALP_TOOL_SPHERE, .axis = {0, 1, 0}, .radius_m = RADIUS, .friction = friction};
        at_time(path, DT * (double)(i + 1), tool.position_m);
        const long interruptions = bench_interruptions();
        double wall = bench_seconds(), cpu = bench_cpu_seconds();
        bench_check(palp_network_set_tools(net, 1, &tool), "tool");
        bench_check(palp_realtime_step(rt, 0.0, DT, budget, &info), "step");
        bench_check(palp_network_tool_force(net, &felt), "force");
        r->cpu[i] = 1e3 * (bench_cpu_seconds() - cpu);
        r->wall[i] = 1e3 * (bench_seconds() - wall);
        if (bench_interruptions() == interruptions)
            r->quiet[r->n_quiet++] = r->cpu[i];
        memcpy(r->force[i], felt.force_N, sizeof felt.force_N);
        r->converged += info.converged;
        r->corrections += info.corrections;
        r->touching += felt.contacts > 0;
    }
    palp_realtime_free(rt);
    palp_network_free(net);
}

static void print_times(const char *what, double *ms, size_t n) {
    size_t missed = 0;
    if (n == 0)
        return;
    for (size_t i = 0; i < n; i++)
        missed += ms[i] > 1e3 * DT;
    bench_median(ms, n); /* sorts */
    printf("      %-19s p50 %.3f  p99 %.3f  p99.9 %.3f  worst %.3f ms, %zu of %zu ticks above 1 ms\n", what,
           ms[n / 2], ms[n * 99 / 100], ms[n * 999 / 1000], ms[n - 1], missed, n);
}

static void print_errors(run *r, const run *truth) {
    double most = 0.0, peak = 0.0, sum = 0.0;
    for (size_t i = 0; i < n_ticks; i++) {
        double square = 0.0, size = 0.0;
        for (size_t k = 0; k < 3; k++) {
            double d = r->force[i][k] - truth->force[i][k];
            square += d * d;
            size += truth->force[i][k] * truth->force[i][k];
        }
        most = fmax(most, sqrt(square));
        peak = fmax(peak, sqrt(size));
        sum += square;
    }
    printf("      error of the force: largest %.2e, root mean square %.2e of the peak of %.3f N; %zu ticks "
           "touch, %zu "
           "converged, %.2f corrections a tick\n",
           most / peak, sqrt(sum / (double)n_ticks) / peak, peak, r->touching, r->converged,
           (double)r->corrections / (double)n_ticks);
}

static void minute(const char *name, size_t n, double friction, double tolerance, const recorded *path,
                   const palp_budget *budget, const run *truth, run *r) {
    printf("  %zu nodes a side, friction %.1f, %s\n", n, friction, name);
    follow(n, friction, tolerance, path, budget, r);
    print_errors(r, truth);
    print_times("wall", r->wall, n_ticks);
    print_times("own time", r->cpu, n_ticks);
    print_times("own, uninterrupted", r->quiet, r->n_quiet);
    fflush(stdout);
}

int main(void) {
    static recorded path;
    static run truth, r;
    const palp_budget all = {0}, thousandth = {.force_error = 1e-3}, one = {.corrections = 1},
                      two = {.corrections = 2};
    const char *text = getenv("BENCH_TICKS");
    if (text && strtoul(text, NULL, 10) > 0 && strtoul(text, NULL, 10) <= TICKS)
        n_ticks = (size_t)strtoul(text, NULL, 10);
    read_path("data/paths/haptic_minute.csv", &path);
    printf("%zu ticks at 1 kHz, sphere of 4 mm; converged: a residual of 1e-8 of the element forces\n",
           n_ticks);
    follow(7, 0.0, 1e-8, &path, &all, &truth);
    minute("residual 1e-6", 7, 0.0, 1e-6, &path, &all, &truth, &r);
    minute("estimated error 1e-3", 7, 0.0, 1e-6, &path, &thousandth, &truth, &r);
    follow(7, 0.3, 1e-8, &path, &all, &truth);
    minute("residual 1e-6", 7, 0.3, 1e-6, &path, &all, &truth, &r);
    minute("two corrections", 7, 0.3, 1e-6, &path, &two, &truth, &r);
    follow(11, 0.0, 1e-8, &path, &all, &truth);
    minute("one correction", 11, 0.0, 1e-6, &path, &one, &truth, &r);
    minute("two corrections", 11, 0.0, 1e-6, &path, &two, &truth, &r);
    return 0;
}
