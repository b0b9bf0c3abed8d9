/* levenberg.c: see levenberg.h. */
#include "levenberg.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FIRST_DAMPING = 1e-6, LEAST_DAMPING = 1e-9, FELT_DAMPING = 1e-3, MOST_DAMPING = 1e4;

bool levenberg_step(size_t n, const double *x, const double *low, const double *high, const double *h,
                    const double *g, double damping, double *work, double *step) {
    memcpy(work, h, n * n * sizeof *work);
    for (size_t i = 0; i < n; i++) {
        bool stuck = (x[i] <= low[i] && g[i] <= 0.0) || (x[i] >= high[i] && g[i] >= 0.0);
        step[i] = stuck ? 0.0 : g[i];
        work[i * n + i] *= 1.0 + damping;
        for (size_t j = 0; j < n && stuck; j++)
            work[i * n + j] = work[j * n + i] = 0.0;
        if (stuck || !(work[i * n + i] > 0.0))
            work[i * n + i] = 1.0;
    }
    const bool regular = dense_cholesky(n, work);
    if (regular)
        dense_cholesky_solve(n, work, 1, step);
    else
        memset(step, 0, n * sizeof *step);
    return regular;
}

/* next = x + step, clipped to reach and bounds. */
static void limit_step_to_bounds(const levenberg *p, const double *x, const double *step, double *next) {
    for (size_t i = 0; i < p->n; i++) {
        double way = fmax(-p->reach[i], fmin(p->reach[i], step[i]));
        next[i] = fmin(p->high[i], fmax(p->low[i], x[i] + way));
    }
}

/* By how much chi2 falls from x to next, if it is quadratic. */
static double expected_fall(size_t n, const double *x, const double *next, const double *h, const double *g) {
    double fall = 0.0;
    for (size_t i = 0; i < n; i++) {
        double turn = 2.0 * g[i];
        for (size_t j = 0; j < n; j++)
            turn -= h[i * n + j] * (next[j] - x[j]);
        fall += turn * (next[i] - x[i]);
    }
    return fall;
}

palp_status levenberg_solve(const levenberg *p, double *x, double *h, double *g, double *chi2) {
    size_t n = p->n;
    double damping = FIRST_DAMPING, *next_h = malloc((2 * n * n + 3 * n) * sizeof *next_h);
    if (!next_h)
        return PALP_ERR_NO_MEMORY;
    double *work = next_h + n * n, *next_g = work + n * n, *next = next_g + n, *step = next + n;
    palp_status status = PALP_OK;
    for (size_t k = 0; k < p->evaluations && damping <= MOST_DAMPING; k++) {
        double next_chi2, before = *chi2;
        levenberg_step(n, x, p->low, p->high, h, g, damping, work, step);
        limit_step_to_bounds(p, x, step, next);
        const double fall = expected_fall(n, x, next, h, g);
        if (fall >= 0.0 && fall < p->stop_expected) /* a clipped step may promise a rise, and need damping */
            break;
        palp_status tried = p->evaluate(p->user, next, next_h, next_g, &next_chi2);
        if (tried == PALP_ERR_NO_MEMORY) {
            status = tried;
            break;
        }
        if (tried || !(next_chi2 < before)) {
            if (!tried && next_chi2 - before < p->stop_rise)
                break;
            damping = fmax(FELT_DAMPING, 10.0 * damping);
            continue;
        }
        memcpy(x, next, n * sizeof *x);
        memcpy(h, next_h, n * n * sizeof *h);
        memcpy(g, next_g, n * sizeof *g);
        *chi2 = next_chi2;
        p->keep(p->user);
        damping = fmax(LEAST_DAMPING, 0.1 * damping);
        if (before - next_chi2 < p->stop_absolute + p->stop_relative * next_chi2)
            break;
    }
    free(next_h);
    return status;
}
