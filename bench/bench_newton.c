/* bench_newton.c: what a Newton iteration costs beside its best possible parts: assembly, the fastest of
 * four factorizations, the fastest solve. All of it interleaved in one run, medians. */
#include "bench.h"
#include "network/network_internal.h"

#include <cholmod.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void dpbtrf_(const char *uplo, const int *n, const int *kd, double *ab, const int *ldab, int *info);
void dpbtrs_(const char *uplo, const int *n, const int *kd, const int *nrhs, const double *ab,
             const int *ldab, double *b, const int *ldb, int *info);

enum { SIMPLICIAL, SUPERNODAL, LAPACK_BAND, BAND, SOLVERS };
enum { RUNS_MAX = 4001 };

static const char *const SOLVER_NAME[SOLVERS] = {"simplicial", "supernodal", "LAPACK band", "palpate band"};

typedef struct times {
    size_t n;
    double assemble[RUNS_MAX], iteration[RUNS_MAX], step[RUNS_MAX];
    double factor[SOLVERS][RUNS_MAX], solve[SOLVERS][RUNS_MAX];
} times;

/* The tangent of a network in the forms that the other solvers take. */
typedef struct matrix {
    cholmod_common common;
    cholmod_sparse *sparse;
    cholmod_factor *factor[2];
    cholmod_dense *rhs, *solution[2], *y, *e;
    int n, width, ld;
    double *band, *work, *x;
} matrix;

static void *need(void *p) {
    if (!p) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return p;
}

/* Calls visit for every pair of unknowns, row >= column, that the tangent couples. */
static void for_entries(const palp_network *net, void (*visit)(matrix *, const palp_network *, int, int),
                        matrix *m) {
    for (size_t i = 0; i < net->n_elements + net->n_nodes; i++) {
        bool own = i >= net->n_elements;
        size_t a = own ? i - net->n_elements : (size_t)net->pair[2 * i];
        size_t b = own ? a : (size_t)net->pair[2 * i + 1];
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < (own ? r + 1 : 3); c++) {
                int p = net->dof[3 * a + r], q = net->dof[3 * b + c];
                if (p >= 0 && q >= 0)
                    visit(m, net, p > q ? p : q, p > q ? q : p);
            }
    }
}

static void widen(matrix *m, const palp_network *net, int row, int column) {
    (void)net;
    m->width = row - column > m->width ? row - column : m->width;
}

static void put(matrix *m, const palp_network *net, int row, int column) {
    m->band[(row - column) + column * m->ld] =
        linsys_values(net->ls)[linsys_slot(net->ls, (size_t)row, (size_t)column)];
}

static void matrix_make(matrix *m, palp_network *net) {
    memset(m, 0, sizeof *m);
    m->n = (int)net->n_free;
    for_entries(net, widen, m);
    m->ld = m->width + 1;
    size_t size = (size_t)m->n * (size_t)m->ld;
    m->band = need(calloc(size, sizeof *m->band));
    m->work = need(malloc(size * sizeof *m->work));
    m->x = need(malloc((size_t)m->n * sizeof *m->x));
    for_entries(net, put, m);

    cholmod_start(&m->common);
    size_t nz = 0;
    for (size_t i = 0; i < size; i++)
        nz += m->band[i] != 0.0;
    cholmod_triplet *t =
        need(cholmod_allocate_triplet(net->n_free, net->n_free, nz, -1, CHOLMOD_REAL, &m->common));
    for (size_t i = 0; i < size; i++)
        if (m->band[i] != 0.0) {
            int column = (int)i / m->ld;
            ((int *)t->i)[t->nnz] = column + (int)i % m->ld;
            ((int *)t->j)[t->nnz] = column;
            ((double *)t->x)[t->nnz++] = m->band[i];
        }
    m->sparse = need(cholmod_triplet_to_sparse(t, nz, &m->common));
    cholmod_free_triplet(&t, &m->common);
    m->rhs = need(cholmod_ones(net->n_free, 1, CHOLMOD_REAL, &m->common));
    for (int k = 0; k < 2; k++) {
        m->common.supernodal = k == SUPERNODAL ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
        m->common.final_ll = 0;
        m->factor[k] = need(cholmod_analyze(m->sparse, &m->common));
    }
}

static void matrix_free(matrix *m) {
    for (int k = 0; k < 2; k++) {
        cholmod_free_factor(&m->factor[k], &m->common);
        cholmod_free_dense(&m->solution[k], &m->common);
    }
    cholmod_free_dense(&m->y, &m->common);
    cholmod_free_dense(&m->e, &m->common);
    cholmod_free_dense(&m->rhs, &m->common);
    cholmod_free_sparse(&m->sparse, &m->common);
    cholmod_finish(&m->common);
    free(m->band);
    free(m->work);
    free(m->x);
}

static void time_cholmod(matrix *m, int k, double *factor, double *solve) {
    double start = bench_seconds();
    cholmod_factorize(m->sparse, m->factor[k], &m->common);
    double middle = bench_seconds();
    cholmod_solve2(CHOLMOD_A, m->factor[k], m->rhs, NULL, &m->solution[k], NULL, &m->y, &m->e, &m->common);
    *solve = bench_seconds() - middle;
    *factor = middle - start;
}

static void time_lapack(matrix *m, double *factor, double *solve) {
    int one = 1, info;
    memcpy(m->work, m->band, (size_t)m->n * (size_t)m->ld * sizeof *m->work);
    for (int i = 0; i < m->n; i++)
        m->x[i] = 1.0;
    double start = bench_seconds();
    dpbtrf_("L", &m->n, &m->width, m->work, &m->ld, &info);
    double middle = bench_seconds();
    dpbtrs_("L", &m->n, &m->width, &one, m->work, &m->ld, m->x, &m->n, &info);
    *solve = bench_seconds() - middle;
    *factor = middle - start;
}

static void time_ours(palp_network *net, double *x, double *assemble, double *factor, double *solve) {
    int negative;
    for (size_t i = 0; i < net->n_free; i++)
        x[i] = 1.0;
    double start = bench_seconds();
    network_evaluate(net);
    network_assemble(net, 0.0);
    double assembled = bench_seconds();
    bench_check(linsys_factor(net->ls, &negative), "factor");
    double factored = bench_seconds();
    linsys_solve(net->ls, x);
    *solve = bench_seconds() - factored;
    *factor = factored - assembled;
    *assemble = assembled - start;
}

static double distance(const double *a, const double *b, size_t n) {
    double most = 0.0, scale = 0.0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
        scale = fmax(scale, fabs(b[i]));
    }
    return most / scale;
}

/* A step of 1 % strain from the last state, by Newton alone and with all that a step does; per iteration. */
static void time_iteration(palp_network *net, double *iteration, double *step) {
    palp_step_info info = {.negative_pivots = -1};
    double depth = 0.11 * BENCH_SIZE, dt = 0.1;
    net->reuse_factor = false;
    net->n_past = 0;
    element_step_prepare(&net->material, dt, &net->step);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    network_place(net, depth);
    network_evaluate(net);
    double start = bench_seconds();
    bench_check(network_newton(net, &info), "newton");
    *iteration = (bench_seconds() - start) / info.iterations;
    start = bench_seconds();
    bench_check(palp_network_try(net, depth, dt, &info), "step");
    *step = (bench_seconds() - start) / (info.iterations + 1); /* one more in the predictor */
}

static double clock_cost(void) {
    double t[101];
    for (size_t i = 0; i < 101; i++) {
        double start = bench_seconds();
        t[i] = bench_seconds() - start;
    }
    return bench_median(t, 101);
}

static void measure(size_t n, size_t runs, times *t) {
    palp_material material = bench_material(2);
    palp_network *net = bench_network(n, NULL, &material, PALP_SOLVER_BAND);
    bench_check(palp_network_step(net, 0.1 * BENCH_SIZE, 0.1, NULL), "first step");
    double *x = need(malloc(net->n_free * sizeof *x)), difference = 0.0;
    matrix m;
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    network_evaluate(net);
    network_assemble(net, 0.0);
    matrix_make(&m, net);
    t->n = runs;
    for (size_t r = 0; r < runs + 1; r++) {
        size_t i = r < 1 ? 0 : r - 1; /* the first is thrown away */
        time_ours(net, x, &t->assemble[i], &t->factor[BAND][i], &t->solve[BAND][i]);
        time_cholmod(&m, SIMPLICIAL, &t->factor[SIMPLICIAL][i], &t->solve[SIMPLICIAL][i]);
        time_cholmod(&m, SUPERNODAL, &t->factor[SUPERNODAL][i], &t->solve[SUPERNODAL][i]);
        time_lapack(&m, &t->factor[LAPACK_BAND][i], &t->solve[LAPACK_BAND][i]);
        if (r == 0)
            difference =
                fmax(distance(x, m.x, net->n_free), distance(x, m.solution[SUPERNODAL]->x, net->n_free));
        time_iteration(net, &t->iteration[i], &t->step[i]);
    }
    if (!(difference < 1e-9))
        printf("the solvers differ by %g\n", difference);
    matrix_free(&m);
    free(x);
    palp_network_free(net);
}

static double least(const double *x, int n) {
    double low = x[0];
    for (int i = 1; i < n; i++)
        low = fmin(low, x[i]);
    return low;
}

static void report(size_t n, times *t, double clock) {
    double factor[SOLVERS], solve[SOLVERS];
    double assemble = bench_median(t->assemble, t->n) - clock;
    double iteration = bench_median(t->iteration, t->n), step = bench_median(t->step, t->n);
    printf("%4zu  assemble %9.4f ms; factor / solve, ms:", n, 1e3 * assemble);
    for (int k = 0; k < SOLVERS; k++) {
        factor[k] = bench_median(t->factor[k], t->n) - clock;
        solve[k] = bench_median(t->solve[k], t->n) - clock;
        printf("  %s %.4f / %.4f", SOLVER_NAME[k], 1e3 * factor[k], 1e3 * solve[k]);
    }
    double best = assemble + least(factor, SOLVERS) + least(solve, SOLVERS);
    printf(
        "\n      iteration %.4f ms, best parts %.4f ms, ratio %.2f (at most 1.30); whole step, each of its "
        "tangents: %.2f\n",
        1e3 * iteration, 1e3 * best, iteration / best, step / best);
}

int main(void) {
    static times t;
    const struct { size_t n, runs; } sizes[] = {{3, 4000}, {5, 1000}, {7, 300}, {11, 25}};
    double clock = clock_cost();
    printf("Newton iteration, 24 mm cube, n nodes a side, quartic law and two arms\n");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        measure(sizes[i].n, sizes[i].runs, &t);
        report(sizes[i].n, &t, clock);
    }
    return 0;
}
