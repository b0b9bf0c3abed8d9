/* bench_reduce.c: reduced models beside the full network: time of a tick, size, error of the force on paths
 * held out. A plate on the cube, and a ball of 4 mm that presses and slides on its free top; quartic law and
 * two arms. bench_reduce [nodes a side ...] 7 and 11; 21 takes several minutes */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"

#include <math.h>
#include <palpate/realtime.h>
#include <palpate/reduce.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TICKS = 3000, PATHS = 16, SAMPLES = 64 };

static const double RADIUS = 0.004, MIDDLE = 0.012, REACH = 0.003, PRESS = 0.0008; /* m */

/* Corners of a path; straight in between, so many samples to each. */
typedef struct corner {
    double time, depth, x, z; /* s, m; depth of the plate or of the ball's lowest point */
    size_t samples;
} corner;

typedef struct path {
    size_t n;
    double time[SAMPLES], depth[SAMPLES];
    palp_tool tool[SAMPLES];
} path;

static palp_tool ball(double x, double z, double depth) {
    return (palp_tool){
        .shape = PALP_TOOL_SPHERE, .position_m = {x, BENCH_SIZE + RADIUS - depth, z}, .radius_m = RADIUS};
}

static void path_make(size_t n, const corner *c, bool tool, path *p) {
    p->n = 0;
    for (size_t i = 1; i < n; i++)
        for (size_t j = 1; j <= c[i].samples; j++) {
            double s = (double)j / (double)c[i].samples,
                   depth = c[i - 1].depth + s * (c[i].depth - c[i - 1].depth);
            p->time[p->n] = c[i - 1].time + s * (c[i].time - c[i - 1].time);
            p->depth[p->n] = tool ? 0.0 : depth;
            p->tool[p->n++] =
                ball(c[i - 1].x + s * (c[i].x - c[i - 1].x), c[i - 1].z + s * (c[i].z - c[i - 1].z), depth);
        }
}

/* Down, across, up; places in units of REACH from the middle, depth in units of PRESS. */
static void slide(double x0, double z0, double x1, double z1, double depth, path *p) {
    double ax = MIDDLE + REACH * x0, az = MIDDLE + REACH * z0, bx = MIDDLE + REACH * x1,
           bz = MIDDLE + REACH * z1;
    const corner c[] = {{0.0, -0.0003, ax, az, 0},
                        {0.5, PRESS * depth, ax, az, 8},
                        {1.5, PRESS * depth, bx, bz, 16},
                        {2.0, -0.0003, bx, bz, 8}};
    path_make(4, c, true, p);
}

/* Down and held. */
static void dwell(double x, double z, double depth, path *p) {
    double ax = MIDDLE + REACH * x, az = MIDDLE + REACH * z;
    const corner c[] = {
        {0.0, -0.0003, ax, az, 0}, {0.3, PRESS * depth, ax, az, 8}, {0.6, PRESS * depth, ax, az, 4}};
    path_make(3, c, true, p);
}

static void plate(double depth, double rate, double hold, path *p) {
    const corner c[] = {{0.0, 0.0, 0, 0, 0},
                        {depth / rate, depth, 0, 0, 20},
                        {depth / rate + hold, depth, 0, 0, 20},
                        {2.0 * depth / rate + hold, 0.0, 0, 0, 20}};
    path_make(4, c, false, p);
}

static size_t plate_paths(path *p, size_t *held) {
    plate(0.0048, 0.024, 1.0, p++);
    plate(0.0030, 0.006, 2.0, p++);
    plate(0.0055, 0.050, 0.5, p++);
    plate(0.0040, 0.012, 1.0, p++);
    plate(0.0050, 0.040, 0.7, p++);
    *held = 2;
    return 5;
}

static size_t ball_paths(path *p, size_t *held) {
    slide(-1, -0.6, 1, -0.6, 0.8, p++);
    slide(1, 0.6, -1, 0.6, 0.7, p++);
    slide(-1, 0, 1, 0, 1.0, p++);
    slide(-0.6, 1, -0.6, -1, 1.0, p++);
    slide(0.6, -1, 0.6, 1, 0.9, p++);
    for (int i = 0; i < 4; i++)
        dwell(i & 1 ? 1 : -1, i & 2 ? 1 : -1, 1.0, p++);
    dwell(0, 0, 1.0, p++);
    slide(-1, 1, 1, -1, 1.0, p++);
    dwell(0.35, 0.1, 0.9, p++);
    dwell(-0.5, -0.25, 0.9, p++);
    *held = 3;
    return 13;
}

static palp_network *make(size_t n, bool tool) {
    const size_t nodes[3] = {n, n, n};
    const double size[3] = {BENCH_SIZE, BENCH_SIZE, BENCH_SIZE};
    palp_material m = bench_material(2);
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    contact.local = false;
    palp_support supports[2];
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    settings.tolerance = 1e-6;
    palp_supports_default(supports);
    bench_check(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), "mesh");
    bench_check(palp_network_create(mesh, &m, tool ? 1 : 2, supports, &settings, &net, NULL), "network");
    if (tool)
        bench_check(palp_network_enable_tools(net, 1, 0, &contact), "tools");
    palp_mesh_free(mesh);
    return net;
}

static palp_snapshots *record(palp_network *net, palp_realtime *realtime, const path *p, bool tool,
                              double *seconds) {
    palp_snapshots *snapshots = NULL;
    palp_error error = {PALP_OK, ""};
    palp_tool_path along = {p->n, p->time, p->depth, tool ? 1 : 0, p->tool};
    double start = bench_seconds();
    bench_check(palp_snapshots_record(net, realtime, &along, NULL, NULL, &snapshots, &error), error.text);
    *seconds += bench_seconds() - start;
    return snapshots;
}

/* Processor time of this thread, s: what a tick takes on a machine that has nothing else to do. */
static double processor_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A path at 1 kHz, its samples joined by straight lines; ms[TICKS] a tick and its processor time, sorted. */
static size_t time_ticks(palp_reduced *reduced, const path *p, bool tool, double *ms, double *processor_ms) {
    size_t n = 0;
    palp_reduced_reset(reduced);
    for (size_t i = 0; n < TICKS && 0.001 * (double)(n + 1) <= p->time[p->n - 1]; n++) {
        double t = 0.001 * (double)(n + 1);
        while (i + 2 < p->n && p->time[i + 1] < t)
            i++;
        double s = (t - p->time[i]) / (p->time[i + 1] - p->time[i]);
        double depth = p->depth[i] + s * (p->depth[i + 1] - p->depth[i]);
        palp_tool at = p->tool[i];
        for (size_t k = 0; k < 3; k++)
            at.position_m[k] += s * (p->tool[i + 1].position_m[k] - at.position_m[k]);
        palp_tool_force force;
        palp_reduced_info info;
        double start = bench_seconds(), processor = processor_seconds();
        bench_check(palp_reduced_step(reduced, depth, tool ? 1 : 0, &at, 0.001, &force, &info), "tick");
        processor_ms[n] = 1e3 * (processor_seconds() - processor);
        ms[n] = 1e3 * (bench_seconds() - start);
    }
    bench_median(ms, n);
    bench_median(processor_ms, n);
    return n;
}

static void measure(size_t n, bool tool, path *p) {
    static double ms[TICKS], processor_ms[TICKS];
    palp_snapshots *snapshots[PATHS];
    palp_reduce_settings settings = palp_reduce_settings_default();
    palp_reduced *reduced = NULL;
    palp_error error = {PALP_OK, ""};
    size_t held, paths = tool ? ball_paths(p, &held) : plate_paths(p, &held), samples = 0,
                 n_paths = paths - held;
    double full = 0.0;
    palp_network *net = make(n, tool);
    palp_realtime_settings quick = palp_realtime_settings_default();
    palp_realtime *realtime = NULL;
    bench_check(palp_realtime_create(net, &quick, &realtime), "real time");
    for (size_t i = 0; i < paths; i++) {
        snapshots[i] = record(net, realtime, &p[i], tool, &full);
        samples += p[i].n;
    }
    palp_realtime_free(realtime);
    double start = bench_seconds();
    bench_check(palp_reduced_create(net, n_paths, snapshots, held, snapshots + n_paths, &settings, &reduced,
                                    NULL, &error),
                error.text);
    double create = bench_seconds() - start;
    palp_reduced_summary s = palp_reduced_describe(reduced);
    size_t ticks = time_ticks(reduced, &p[n_paths], tool, ms, processor_ms);
    printf("%4zu %-6s %8zu %8zu %5zu %6zu %9.1f %8.1f %8.4f %8.4f %8.4f %8.4f %7.3f %7.3f %7.3f\n", n,
           tool ? "ball" : "plate", s.unknowns, s.network_elements, s.modes, s.elements,
           1e3 * full / (double)samples, create, ms[ticks / 2], ms[ticks * 99 / 100],
           processor_ms[ticks * 99 / 100], processor_ms[ticks - 1], 100.0 * s.held_out_worst,
           100.0 * s.held_out_rms, 100.0 * s.bound);
    fflush(stdout);
    for (size_t i = 0; i < paths; i++)
        palp_snapshots_free(snapshots[i]);
    palp_reduced_free(reduced);
    palp_network_free(net);
}

int main(int argc, char **argv) {
    static path paths[PATHS];
    printf("Reduced models of a 24 mm cube: ms a tick at 1 kHz (and of it processor time), error of the "
           "force on paths\n"
           "held out, %% of their peak. Goal: 21 nodes a side, 1 ms, 1 %%\n"
           "                                               full     make     tick      p99      processor    "
           "   error\n"
           "   n driven unknowns elements modes   kept      (ms)      (s)   median               p99    "
           "worst   worst     "
           "rms   bound\n");
    for (int i = 1; i < (argc > 1 ? argc : 3); i++) {
        size_t n = argc > 1 ? (size_t)atoi(argv[i]) : i == 1 ? 7 : 11;
        if (n < 3 || n > 40) {
            fprintf(stderr, "bench_reduce [nodes a side, 3 to 40 ...]\n");
            return 2;
        }
        measure(n, false, paths);
        measure(n, true, paths);
    }
    return 0;
}
