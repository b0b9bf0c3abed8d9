/* bench_peers.c: a tick of palpate beside two methods that simulators use for the same springs, all in one
 * run: vertex block descent (Chen et al. 2024, in single precision) and projective dynamics (Bouaziz et al.
 * 2014, a factor kept by CHOLMOD). Cube of 24 mm, linear springs without mass, pressed by 1 strain/s to 0.2
 * in ticks of 1 ms; both start a tick from the line through their last two states, as they do with inertia.
 * The error is that of the plate's force beside the converged one, relative to the peak, in the last tick and
 * the largest of all. Times are the thread's own, repeats interleaved, as many as fit into some time at each
 * size. BENCH_NODES: largest number of nodes a side (21). */
#include "bench.h"
#include "network/network_internal.h"

#include <cholmod.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TICKS = 200, REPEATS = 5, SIZES = 3 };
static const double DT = 1e-3, STRAIN = 0.2, STIFFNESS = 0.54;
static const size_t NODES[SIZES] = {5, 11, 21};
static const double SPAN = 20.0; /* s: no further repeat is begun after it */

static void *need(size_t n, size_t size) {
    void *p = calloc(n + 1, size);
    if (!p) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return p;
}

static double depth_of(size_t tick) {
    return STRAIN * BENCH_SIZE * (double)(tick + 1) / TICKS;
}

/* ---- the lattice that both peers have ------------------------------------------------------------ */

/* Springs of each node to all its neighbours; a node is free or not. */
typedef struct lattice {
    const palp_network *net;
    size_t n, n_plate;
    uint32_t *first;    /* [n + 1] */
    int32_t *neighbour; /* [first[n]] */
    float *length, *k;  /* [first[n]] at rest, m, and stiffness, N/m */
    bool *is_free;      /* [n] */
    int32_t *plate;     /* [n_plate] nodes that are driven */
    float *x, *before;  /* [4 n] now and a tick ago */
} lattice;

static lattice lattice_make(const palp_network *net) {
    lattice l = {.net = net, .n = net->n_nodes};
    l.first = need(l.n + 2, sizeof *l.first);
    l.neighbour = need(2 * net->n_elements, sizeof *l.neighbour);
    l.length = need(2 * net->n_elements, sizeof *l.length);
    l.k = need(2 * net->n_elements, sizeof *l.k);
    l.is_free = need(l.n, sizeof *l.is_free);
    l.plate = need(l.n, sizeof *l.plate);
    l.x = need(4 * l.n, sizeof *l.x);
    l.before = need(4 * l.n, sizeof *l.before);
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        l.first[net->pair[i] + 2]++;
    for (size_t i = 2; i < l.n + 2; i++)
        l.first[i] += l.first[i - 1];
    for (size_t i = 0; i < 2 * net->n_elements; i++) {
        uint32_t at = l.first[net->pair[i] + 1]++;
        l.neighbour[at] = net->pair[i ^ 1];
        l.length[at] = (float)(1.0 / net->inverse_rest[i / 2]);
        l.k[at] = (float)(STIFFNESS * net->inverse_rest[i / 2]);
    }
    for (size_t i = 0; i < l.n; i++) {
        l.is_free[i] = net->dof[3 * i] >= 0;
        if (net->motion[3 * i + 1] != 0.0)
            l.plate[l.n_plate++] = (int32_t)i;
    }
    return l;
}

static void lattice_drop(lattice *l) {
    void *all[] = {l->first, l->neighbour, l->length, l->k, l->is_free, l->plate, l->x, l->before};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
}

static void lattice_rest(lattice *l) {
    for (size_t i = 0; i < l->n; i++)
        for (size_t k = 0; k < 3; k++)
            l->x[4 * i + k] = l->before[4 * i + k] = (float)l->net->rest[3 * i + k];
}

/* Free nodes along the line through the last two states, the others where the plates are. */
static void lattice_start(lattice *l, double depth) {
    for (size_t i = 0; i < l->n; i++)
        for (size_t k = 0; k < 3; k++) {
            float *x = &l->x[4 * i + k], now = *x;
            *x = l->is_free[i] ? 2.0F * now - l->before[4 * i + k]
                               : (float)(l->net->rest[3 * i + k] + depth * l->net->motion[3 * i + k]);
            l->before[4 * i + k] = now;
        }
}

/* Of the springs on the plate, N. */
static double plate_force(const lattice *l) {
    double sum = 0.0;
    for (size_t p = 0; p < l->n_plate; p++) {
        const float *a = l->x + 4 * l->plate[p];
        for (uint32_t k = l->first[l->plate[p]]; k < l->first[l->plate[p] + 1]; k++) {
            const float *b = l->x + 4 * l->neighbour[k];
            float d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
            float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            sum += (double)(l->k[k] * (1.0F - l->length[k] / length) * d[1]);
        }
    }
    return sum;
}

/* ---- vertex block descent ------------------------------------------------------------------------ */

/* x_i += H^-1 f of its own springs alone; what pulls across a spring is kept where it is positive. */
static void descend(lattice *l, size_t i) {
    float h[6] = {0.0F}, f[3] = {0.0F}, *a = l->x + 4 * i;
    for (uint32_t k = l->first[i]; k < l->first[i + 1]; k++) {
        const float *b = l->x + 4 * l->neighbour[k];
        float d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], ratio = l->length[k] / sqrtf(square);
        float pull = l->k[k] * (1.0F - ratio), across = pull > 0.0F ? pull : 0.0F,
              along = (l->k[k] - across) / square;
        for (size_t r = 0; r < 3; r++)
            f[r] += pull * d[r];
        h[0] += across + along * d[0] * d[0];
        h[1] += along * d[1] * d[0];
        h[2] += across + along * d[1] * d[1];
        h[3] += along * d[2] * d[0];
        h[4] += along * d[2] * d[1];
        h[5] += across + along * d[2] * d[2];
    }
    float c0 = h[2] * h[5] - h[4] * h[4], c1 = h[3] * h[4] - h[1] * h[5], c2 = h[1] * h[4] - h[3] * h[2];
    float inverse = 1.0F / (h[0] * c0 + h[1] * c1 + h[3] * c2);
    a[0] += inverse * (c0 * f[0] + c1 * f[1] + c2 * f[2]);
    a[1] += inverse * (c1 * f[0] + (h[0] * h[5] - h[3] * h[3]) * f[1] + (h[1] * h[3] - h[0] * h[4]) * f[2]);
    a[2] += inverse * (c2 * f[0] + (h[1] * h[3] - h[0] * h[4]) * f[1] + (h[0] * h[2] - h[1] * h[1]) * f[2]);
}

static void vbd_round(lattice *l, void *unused) {
    (void)unused;
    for (size_t i = 0; i < l->n; i++)
        if (l->is_free[i])
            descend(l, i);
}

/* ---- projective dynamics ------------------------------------------------------------------------- */

/* The constant matrix of the springs' stiffnesses, one row a free node, the same for all three axes. */
typedef struct projective {
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *rhs, *x, *y, *e;
    int *row; /* [n] of a node, or -1 */
} projective;

static void projective_factor(projective *p, const lattice *l, size_t n) {
    cholmod_triplet *t = cholmod_allocate_triplet(n, n, 2 * l->first[l->n], -1, CHOLMOD_REAL, &p->common);
    int *row = t->i, *column = t->j;
    double *value = t->x;
    for (size_t i = 0; i < l->n; i++)
        for (uint32_t k = l->first[i]; k < l->first[i + 1] && p->row[i] >= 0; k++) {
            int j = p->row[l->neighbour[k]];
            row[t->nnz] = column[t->nnz] = p->row[i];
            value[t->nnz++] = (double)l->k[k];
            if (j < 0 || j > p->row[i])
                continue;
            row[t->nnz] = p->row[i];
            column[t->nnz] = j;
            value[t->nnz++] = -(double)l->k[k];
        }
    cholmod_sparse *a = cholmod_triplet_to_sparse(t, t->nnz, &p->common);
    p->factor = cholmod_analyze(a, &p->common);
    cholmod_factorize(a, p->factor, &p->common);
    cholmod_free_sparse(&a, &p->common);
    cholmod_free_triplet(&t, &p->common);
}

static projective *projective_make(const lattice *l) {
    projective *p = need(1, sizeof *p);
    int n = 0;
    p->row = need(l->n, sizeof *p->row);
    for (size_t i = 0; i < l->n; i++)
        p->row[i] = l->is_free[i] ? n++ : -1;
    cholmod_start(&p->common);
    p->common.supernodal = CHOLMOD_SIMPLICIAL;
    p->rhs = cholmod_allocate_dense((size_t)n, 3, (size_t)n, CHOLMOD_REAL, &p->common);
    projective_factor(p, l, (size_t)n);
    return p;
}

static void projective_drop(projective *p) {
    cholmod_free_factor(&p->factor, &p->common);
    cholmod_free_dense(&p->rhs, &p->common);
    cholmod_free_dense(&p->x, &p->common);
    cholmod_free_dense(&p->y, &p->common);
    cholmod_free_dense(&p->e, &p->common);
    cholmod_finish(&p->common);
    free(p->row);
    free(p);
}

/* Each spring brought to its length, then all nodes at once to where that leaves the least energy. */
static void projective_round(lattice *l, void *own) {
    projective *p = own;
    double *b = p->rhs->x;
    const size_t n = p->rhs->nrow;
    for (size_t i = 0; i < l->n; i++) {
        const float *a = l->x + 4 * i;
        float sum[3] = {0.0F};
        for (uint32_t k = l->first[i]; k < l->first[i + 1] && l->is_free[i]; k++) {
            const float *o = l->x + 4 * l->neighbour[k], other = l->is_free[l->neighbour[k]] ? 0.0F : 1.0F;
            float d[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]};
            float ratio = l->length[k] / sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            for (size_t r = 0; r < 3; r++)
                sum[r] += l->k[k] * (ratio * d[r] + other * o[r]);
        }
        for (size_t r = 0; r < 3 && l->is_free[i]; r++)
            b[r * n + (size_t)p->row[i]] = (double)sum[r];
    }
    cholmod_solve2(CHOLMOD_A, p->factor, p->rhs, NULL, &p->x, NULL, &p->y, &p->e, &p->common);
    const double *x = p->x->x;
    for (size_t i = 0; i < l->n; i++)
        for (size_t r = 0; r < 3 && l->is_free[i]; r++)
            l->x[4 * i + r] = (float)x[r * n + (size_t)p->row[i]];
}

/* ---- runs ---------------------------------------------------------------------------------------- */

typedef struct outcome {
    double ms[REPEATS * TICKS];
    double most, last; /* error of the force: of all ticks, of the last */
    size_t n;
    double bound; /* a ramp that is off by more is broken off; 0: none is */
} outcome;

/* False: the ramp need not go on. */
static bool note(outcome *o, double seconds, double force, const double *truth, size_t tick) {
    o->ms[o->n++] = 1e3 * seconds;
    o->last = fabs(force - truth[tick]) / truth[TICKS - 1];
    o->most = fmax(o->most, o->last);
    return o->bound == 0.0 || o->most <= o->bound;
}

static void peer_ramp(lattice *l, void (*round)(lattice *, void *), void *own, size_t rounds,
                      const double *truth, outcome *o) {
    lattice_rest(l);
    for (size_t i = 0; i < TICKS; i++) {
        double start = bench_cpu_seconds();
        lattice_start(l, depth_of(i));
        for (size_t k = 0; k < rounds; k++)
            round(l, own);
        double force = plate_force(l);
        if (!note(o, bench_cpu_seconds() - start, force, truth, i))
            return;
    }
}

static void palpate_ramp(palp_realtime *rt, const palp_budget *budget, const double *truth, outcome *o) {
    palp_tick_info info;
    bench_check(palp_realtime_reset(rt), "reset");
    for (size_t i = 0; i < TICKS; i++) {
        double start = bench_cpu_seconds();
        bench_check(palp_realtime_step(rt, depth_of(i), DT, budget, &info), "step");
        note(o, bench_cpu_seconds() - start, info.force_N, truth, i);
    }
}

static void find_truth(palp_realtime *rt, double *force) {
    palp_tick_info info;
    for (size_t i = 0; i < TICKS; i++) {
        bench_check(palp_realtime_step(rt, depth_of(i), DT, &(palp_budget){0}, &info), "step");
        force[i] = info.force_N;
    }
}

enum { VBD, PROJECTIVE, PALPATE, METHODS };
static const char *const NAME[METHODS] = {"vertex block descent", "projective dynamics", "palpate"};

typedef struct contender {
    int method;
    size_t rounds;
    palp_budget budget;
    outcome o;
} contender;

/* All methods at one size. */
typedef struct stage {
    lattice l;
    projective *p;
    palp_realtime *rt;
    double truth[TICKS];
} stage;

static void run(stage *s, contender *c) {
    if (c->method == VBD)
        peer_ramp(&s->l, vbd_round, NULL, c->rounds, s->truth, &c->o);
    else if (c->method == PROJECTIVE)
        peer_ramp(&s->l, projective_round, s->p, c->rounds, s->truth, &c->o);
    else
        palpate_ramp(s->rt, &c->budget, s->truth, &c->o);
}

static void print(size_t n, contender *c) {
    char what[40];
    if (c->budget.force_error > 0.0)
        snprintf(what, sizeof what, "estimated error %.0e", c->budget.force_error);
    else
        snprintf(what, sizeof what, c->method == PALPATE ? "%zu correction%s" : "%zu round%s", c->rounds,
                 c->rounds == 1 ? "" : "s");
    bench_median(c->o.ms, c->o.n);
    printf("  %2zu  %-21s %-22s %8.4f %8.4f %8.4f   %8.1e %8.1e\n", n, NAME[c->method], what, c->o.ms[0],
           c->o.ms[c->o.n / 2], c->o.ms[c->o.n * 99 / 100], c->o.last, c->o.most);
}

/* A peer with the fewest rounds with which its error stays below a bound in every tick, and its run; false:
 * none of those tried. */
static bool find_rounds(stage *s, int method, double bound, contender *c) {
    static const size_t tried[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128};
    for (size_t k = 0; k < sizeof tried / sizeof *tried; k++) {
        *c = (contender){.method = method, .rounds = tried[k], .o.bound = bound};
        run(s, c);
        if (c->o.most <= bound)
            return true;
    }
    return false;
}

static void size_of(size_t n) {
    static const double bounds[] = {1e-2, 1e-3};
    static contender list[12];
    static stage s;
    const double k[] = {STIFFNESS};
    palp_material m = {.n_arms = 0};
    palp_realtime_settings settings = palp_realtime_settings_default();
    bench_check(palp_law_polynomial(1, k, &m.law), "law");
    palp_network *net = bench_network(n, NULL, &m, PALP_SOLVER_AUTO);
    bench_check(palp_realtime_create(net, &settings, &s.rt), "realtime");
    find_truth(s.rt, s.truth);
    s.l = lattice_make(net);
    s.p = projective_make(&s.l);
    size_t count = 0;
    const double start = bench_cpu_seconds();
    list[count++] = (contender){.method = VBD, .rounds = 1};
    list[count++] = (contender){.method = PROJECTIVE, .rounds = 1};
    list[count++] = (contender){.method = PALPATE, .rounds = 1, .budget = {.corrections = 1}};
    for (size_t b = 0; b < sizeof bounds / sizeof *bounds; b++) {
        for (int method = VBD; method <= PROJECTIVE; method++)
            if (find_rounds(&s, method, bounds[b], &list[count]) && list[count].rounds > 1)
                count++;
        list[count++] = (contender){.method = PALPATE, .budget = {.force_error = bounds[b]}};
    }
    for (size_t r = 0; r < REPEATS; r++)
        for (size_t c = 0; c < count; c++)
            if (list[c].o.n <= r * TICKS && (r == 0 || bench_cpu_seconds() - start < SPAN))
                run(&s, &list[c]);
    for (size_t c = 0; c < count; c++)
        print(n, &list[c]);
    fflush(stdout);
    projective_drop(s.p);
    lattice_drop(&s.l);
    palp_realtime_free(s.rt);
    palp_network_free(net);
}

int main(void) {
    const char *text = getenv("BENCH_NODES");
    size_t largest = text ? (size_t)strtoul(text, NULL, 10) : NODES[SIZES - 1];
    printf("   n  method                what                    least ms   median      p99     at end  "
           "largest\n");
    for (size_t i = 0; i < SIZES && NODES[i] <= largest; i++)
        size_of(NODES[i]);
    return 0;
}
