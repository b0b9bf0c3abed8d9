/* bench_cut.c: 200 random cuts and tears of a lattice of 11 nodes a side that runs at 1 kHz within a budget.
 * Prints the time of a cut and of the ticks after it, and the balance of forces. The final force is compared
 * with that of a new network of the same elements. Quartic law and two arms; the top plate moves up and down.
 * Times are the thread's own. */
#include "bench.h"
#include "network/network_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 11, EVENTS = 200, GAP = 20, AFTER = 10, TICKS = EVENTS * GAP };
static const double DT = 1e-3, TICK_MS = 1.0, PERIOD_S = 1.0;

typedef struct run {
    double depth;       /* largest, of the height; both ways */
    double blade;       /* size, of the height */
    size_t corrections; /* a tick's budget */
    double cut_ms[EVENTS], after_ms[AFTER][EVENTS], ordinary_ms[TICKS];
    size_t cut, torn, tears, ordinary, late, unsound, failed;
    double imbalance, residual; /* largest |sum of the forces| / sum of sizes; mean relative residual */
} run;

/* 0 to 1, the same on every machine (xorshift64*, Vigna 2016). */
static double roll(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)((*state * 2685821657736338717u) >> 11) / 9007199254740992.0;
}

static void random_blade(uint64_t *dice, double size, double corners[9]) {
    double middle[3];
    for (size_t k = 0; k < 3; k++)
        middle[k] = BENCH_SIZE * roll(dice);
    for (size_t i = 0; i < 9; i++)
        corners[i] = middle[i % 3] + size * BENCH_SIZE * (roll(dice) - 0.5);
}

/* A strain limit just below the few most stretched elements. */
static double tearing_limit(const palp_network *net) {
    double largest = 0.0;
    for (size_t i = 0; i < net->n_elements; i++)
        largest = fmax(largest, net->now.history.strain[i]);
    return 0.9 * largest;
}

static void event(palp_network *net, uint64_t *dice, size_t i, run *r) {
    double corners[9], start;
    size_t n = 0;
    random_blade(dice, r->blade, corners);
    if (i % 4 == 3) {
        bench_check(palp_network_set_tearing(net, fmax(0.02, tearing_limit(net)), 0.0), "limit");
        start = bench_cpu_seconds();
        bench_check(palp_network_tear(net, &n), "tear");
        r->torn += n;
        r->tears++;
    } else {
        start = bench_cpu_seconds();
        bench_check(palp_network_cut(net, corners, &n), "cut");
        r->cut += n;
    }
    r->cut_ms[i] = 1e3 * (bench_cpu_seconds() - start);
}

/* All forces of elements on nodes, those of supported nodes included, cancel to rounding; all is a number. */
static void check_state(const palp_network *net, run *r) {
    double sum[3] = {0.0}, size = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        sum[i % 3] += net->now.inner[i];
        size += fabs(net->now.inner[i]);
        r->unsound += !isfinite(net->now.x[i]) || !isfinite(net->now.inner[i]);
    }
    for (size_t k = 0; k < 3 && size > 0.0; k++)
        r->imbalance = fmax(r->imbalance, fabs(sum[k]) / size);
}

static void tick(palp_realtime *rt, size_t i, const palp_budget *budget, run *r) {
    palp_tick_info info = {.residual = 0.0};
    double depth = r->depth * BENCH_SIZE * sin(2.0 * 3.14159265358979 * DT * (double)i / PERIOD_S);
    double start = bench_cpu_seconds();
    r->failed += palp_realtime_step(rt, depth, DT, budget, &info) != PALP_OK;
    double ms = 1e3 * (bench_cpu_seconds() - start);
    size_t after = i % GAP;
    if (after < AFTER)
        r->after_ms[after][i / GAP] = ms;
    else
        r->ordinary_ms[r->ordinary++] = ms;
    r->late += after < AFTER && ms > TICK_MS;
    r->residual += info.residual / TICKS;
    check_state(palp_realtime_network(rt), r);
}

/* To a depth in parts, fully relaxed. */
static palp_status lead(palp_network *net, double depth) {
    enum { PARTS = 5, MORE = 3 };
    double from = palp_network_depth(net);
    palp_status status = PALP_OK;
    for (int k = 1; k <= PARTS + MORE && !status; k++)
        status =
            palp_network_step(net, k < PARTS ? from + (depth - from) * k / PARTS : depth, INFINITY, NULL);
    return status;
}

/* Nodes that are elsewhere by more than a hundredth of the spacing. */
static size_t count_apart(const palp_network *a, const palp_network *b) {
    size_t n = 0;
    for (size_t i = 0; i < a->n_nodes; i++) {
        double far = 0.0;
        for (size_t k = 0; k < 3; k++)
            far = fmax(far, fabs(a->now.x[3 * i + k] - b->now.x[3 * i + k]));
        n += far > 0.01 * BENCH_SIZE / (NODES - 1);
    }
    return n;
}

static void print_force(const char *name, palp_status status, const palp_network *fresh,
                        const palp_network *net) {
    double force = palp_network_force(net);
    if (status)
        printf("    %s: %s\n", name, palp_status_text(status));
    else
        printf("    %s: %.9f N, difference %.1e, %zu nodes elsewhere\n", name, palp_network_force(fresh),
               fabs(palp_network_force(fresh) - force) / fabs(force), count_apart(fresh, net));
}

/* Another network with the same elements cut: from rest, where buckled struts may choose another equilibrium,
 * and from near the places of the first; all relaxed. */
static void compare(palp_network *net, const run *r) {
    palp_material material = bench_material(2);
    palp_network *fresh = bench_network(NODES, NULL, &material, PALP_SOLVER_AUTO);
    const double depth = 0.5 * r->depth * BENCH_SIZE, near = 1e-6 * BENCH_SIZE;
    bench_check(palp_network_enable_cutting(fresh), "fresh");
    for (size_t i = 0; i < net->n_elements; i++)
        if (!palp_network_alive(net)[i])
            bench_check(palp_network_cut_elements(fresh, 1, &(int32_t){(int32_t)i}), "elements");
    palp_status status = lead(net, depth);
    print_force("converged at half the depth    ", status, net, net);
    if (!status) {
        uint64_t dice = 1;
        print_force("built afresh, led from rest    ", lead(fresh, depth), fresh, net);
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            fresh->now.x[i] = net->now.x[i] + (net->dof[i] >= 0 ? near * (roll(&dice) - 0.5) : 0.0);
        fresh->n_past = 0;
        fresh->now.depth = depth;
        print_force("built afresh, from 1e-6 H beside", lead(fresh, depth), fresh, net);
    }
    palp_network_free(fresh);
}

static double largest(const double *x, size_t n) {
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, x[i]);
    return most;
}

static void print(run *r, const palp_network *net) {
    printf("  depth %+.0f %% to %+.0f %%, blades of %.0f %% of the height, budget %zu corrections a tick\n",
           -100.0 * r->depth, 100.0 * r->depth, 100.0 * r->blade, r->corrections);
    printf("    %zu elements cut in %zu sweeps, %zu torn in %zu tears, of %zu; %zu nodes loose\n", r->cut,
           EVENTS - r->tears, r->torn, r->tears, net->n_elements, palp_network_loose(net, NULL));
    printf(
        "    not a number: %zu; failed ticks %zu; balance of forces %.1e; mean residual %.1e of the forces\n",
        r->unsound, r->failed, r->imbalance, r->residual);
    printf("    a cut %.3f ms, worst %.3f; ordinary tick %.3f ms, worst %.3f; late ticks after a cut %zu of "
           "%d\n",
           bench_median(r->cut_ms, EVENTS), largest(r->cut_ms, EVENTS),
           bench_median(r->ordinary_ms, r->ordinary), largest(r->ordinary_ms, r->ordinary), r->late,
           EVENTS * AFTER);
    printf("    tick after a cut     1      2      3      4      5      6      7      8      9     10\n      "
           "median, ms   ");
    for (size_t k = 0; k < AFTER; k++)
        printf(" %6.3f", bench_median(r->after_ms[k], EVENTS));
    printf("\n      worst, ms    ");
    for (size_t k = 0; k < AFTER; k++)
        printf(" %6.3f", largest(r->after_ms[k], EVENTS));
    printf("\n");
}

static void walk(double depth, double blade, size_t corrections) {
    static run r;
    const palp_budget budget = {.corrections = corrections};
    palp_material material = bench_material(2);
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_realtime *rt = NULL;
    palp_network *net = bench_network(NODES, NULL, &material, PALP_SOLVER_AUTO);
    uint64_t dice = 20081;
    r = (run){.depth = depth, .blade = blade, .corrections = corrections};
    bench_check(palp_network_enable_cutting(net), "cutting");
    bench_check(palp_realtime_create(net, &settings, &rt), "realtime");
    for (size_t i = 0; i < TICKS; i++) {
        if (i % GAP == 0)
            event(net, &dice, i / GAP, &r);
        tick(rt, i, &budget, &r);
    }
    print(&r, net);
    palp_realtime_free(rt);
    compare(net, &r);
    palp_network_free(net);
}

int main(void) {
    printf("%d random cuts and tears, one every %d ticks of 1 ms, %d nodes a side\n", EVENTS, GAP, NODES);
    walk(0.05, 0.3, 1);
    walk(0.1, 0.3, 1);
    walk(0.1, 0.3, 2);
    walk(0.1, 0.5, 2);
    return 0;
}
