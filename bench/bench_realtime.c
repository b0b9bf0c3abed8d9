/* bench_realtime.c: what a tick of 1 ms costs, and the error of its force: on linear springs, with our
 * element, and how accuracy is traded for time (bench_peers.c: beside other methods). One thread, 24 mm cube,
 * ramp of 1 strain/s to 0.2. Times are the thread's own: others on a shared machine are not in them.
 * BENCH_NODES: largest number of nodes a side (33). */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TICKS = 200, REPEATS = 5 };
static const double DT = 1e-3, STRAIN = 0.2;

static const struct {
    size_t n;
    double force_N; /* converged static, linear springs of 0.54 N, strain 0.2 */
} STATIC[] = {{5, 4.874162}, {11, 25.098453}, {21, 93.768580}};

static palp_material linear(void) {
    const double k[] = {0.54};
    palp_material m = {.n_arms = 0};
    bench_check(palp_law_polynomial(1, k, &m.law), "law");
    return m;
}

static palp_realtime *realtime(size_t n, const palp_material *material) {
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_realtime *rt = NULL;
    bench_check(palp_realtime_create(bench_network(n, NULL, material, PALP_SOLVER_AUTO), &settings, &rt),
                "realtime");
    return rt;
}

static void drop(palp_realtime *rt) {
    palp_network *net = palp_realtime_network(rt);
    palp_realtime_free(rt);
    palp_network_free(net);
}

/* The ramp's forces, converged at each tick. */
static void converged(size_t n, const palp_material *material, double *force) {
    palp_realtime *rt = realtime(n, material);
    const palp_budget all = {0};
    palp_tick_info info;
    for (size_t i = 0; i < TICKS; i++) {
        bench_check(palp_realtime_step(rt, STRAIN * BENCH_SIZE * (double)(i + 1) / TICKS, DT, &all, &info),
                    "step");
        if (!info.converged)
            printf("      (%zu nodes a side, tick %zu: residual %.1e)\n", n, i, info.residual);
        force[i] = info.force_N;
    }
    drop(rt);
}

typedef struct outcome {
    double least_ms, median_ms, worst_ms; /* over ticks and repeats */
    double uneven;                        /* worst tick over the median one, each the least of its repeats */
    double last, most;  /* error of the force at the end, and the largest, relative to the end's */
    double corrections; /* mean */
    double estimate;    /* mean of the estimated error over the true one */
} outcome;

/* ms[REPEATS TICKS]; what others on the machine do to a tick is in few of its repeats. */
static double unevenness(const double *ms) {
    double least[TICKS];
    for (size_t i = 0; i < TICKS; i++) {
        least[i] = ms[i];
        for (size_t r = 1; r < REPEATS; r++)
            least[i] = fmin(least[i], ms[r * TICKS + i]);
    }
    double median = bench_median(least, TICKS);
    return least[TICKS - 1] / median;
}

static outcome ramp(size_t n, const palp_material *material, const palp_budget *budget, const double *truth) {
    static double ms[REPEATS * TICKS];
    outcome o = {0};
    palp_tick_info info;
    double peak = fabs(truth[TICKS - 1]);
    for (size_t r = 0; r < REPEATS; r++) {
        palp_realtime *rt = realtime(n, material);
        for (size_t i = 0; i < TICKS; i++) {
            double depth = STRAIN * BENCH_SIZE * (double)(i + 1) / TICKS, start = bench_cpu_seconds();
            bench_check(palp_realtime_step(rt, depth, DT, budget, &info), "step");
            ms[r * TICKS + i] = 1e3 * (bench_cpu_seconds() - start);
            double error = fabs(info.force_N - truth[i]);
            o.most = fmax(o.most, error / peak);
            o.last = error / peak;
            o.corrections += (double)info.corrections / (REPEATS * TICKS);
            o.estimate += info.force_error_N / fmax(error, 1e-13 * peak) / (REPEATS * TICKS);
        }
        drop(rt);
    }
    o.uneven = unevenness(ms);
    o.median_ms = bench_median(ms, REPEATS * TICKS);
    o.least_ms = ms[0];
    o.worst_ms = ms[REPEATS * TICKS - 1];
    return o;
}

static void print(size_t n, const char *budget, const outcome *o) {
    printf("  %2zu  %-16s %8.4f %8.4f %8.4f %7.2f   %8.1e %8.1e  %5.2f %9.1f\n", n, budget, o->least_ms,
           o->median_ms, o->worst_ms, o->uneven, o->last, o->most, o->corrections, o->estimate);
}

/* A ramp's first ticks on a network too large for a direct factor. */
static void large(size_t n) {
    enum { FEW = 60 };
    static double ms[FEW];
    const palp_budget one = {.corrections = 1}, all = {0};
    palp_material material = bench_material(2);
    palp_tick_info info, last;
    double start = bench_cpu_seconds(), before = bench_peak_MB();
    palp_realtime *rt = realtime(n, &material);
    double made = bench_cpu_seconds() - start;
    for (size_t i = 0; i < FEW; i++) {
        start = bench_cpu_seconds();
        bench_check(palp_realtime_step(rt, STRAIN * BENCH_SIZE * (double)(i + 1) / TICKS, DT, &one, &info),
                    "step");
        ms[i] = 1e3 * (bench_cpu_seconds() - start);
    }
    double median = bench_median(ms, FEW);
    start = bench_cpu_seconds();
    bench_check(palp_realtime_step(rt, STRAIN * BENCH_SIZE * (FEW + 1.0) / TICKS, DT, &all, &last), "step");
    printf("%zu nodes a side, %zu unknowns, quartic law and two arms: made in %.0f ms, one correction %.1f "
           "ms a tick (median "
           "of %d, worst %.1f), estimated error %.1e of %.3f N; converged tick: %zu corrections, %.0f ms, "
           "residual %.1e; "
           "%.0f MB\n",
           n, palp_network_unknown_count(palp_realtime_network(rt)), 1e3 * made, median, FEW, ms[FEW - 1],
           info.force_error_N / info.force_N, info.force_N, last.corrections,
           1e3 * (bench_cpu_seconds() - start), last.residual, bench_peak_MB() - before);
    drop(rt);
}

static void chart(size_t n, const palp_material *material, double static_force) {
    const size_t corrections[] = {1, 2, 3, 0};
    static double truth[TICKS];
    converged(n, material, truth);
    if (static_force > 0.0)
        printf("  %2zu  converged force %.6f N, static %.6f N: %.1e\n", n, truth[TICKS - 1], static_force,
               fabs(truth[TICKS - 1] / static_force - 1.0));
    for (size_t k = 0; k < sizeof corrections / sizeof *corrections; k++) {
        palp_budget budget = {.corrections = corrections[k]};
        char text[32];
        snprintf(text, sizeof text, corrections[k] ? "%zu corrections" : "converged", corrections[k]);
        outcome o = ramp(n, material, &budget, truth);
        print(n, text, &o);
    }
    palp_budget budget = {.force_error = 1e-3};
    outcome o = ramp(n, material, &budget, truth);
    print(n, "error 1e-3", &o);
}

static const char HEAD[] =
    "   n  budget            least ms   median    worst  uneven   at end  largest  corr. est./true\n";

static void linear_springs(size_t largest) {
    palp_material material = linear();
    printf("linear springs\n%s", HEAD);
    for (size_t k = 0; k < 3 && STATIC[k].n <= largest; k++)
        chart(STATIC[k].n, &material, STATIC[k].force_N);
}

static void our_element(size_t largest) {
    const size_t sizes[] = {5, 7, 11, 21};
    palp_material material = bench_material(2);
    printf("quartic law and two arms\n%s", HEAD);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes && sizes[k] <= largest; k++)
        chart(sizes[k], &material, 0.0);
}

int main(void) {
    const char *text = getenv("BENCH_NODES");
    size_t largest = text ? (size_t)strtoul(text, NULL, 10) : 33;
    linear_springs(largest);
    our_element(largest);
    if (largest >= 33)
        large(33);
    return 0;
}
