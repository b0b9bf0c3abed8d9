/* linsys.c: chooses a solver and forwards calls to it. */
#include "linsys.h"

#include "linsys_solver.h"

#include <stdlib.h>

struct linsys {
    linsys_made made;
};

/* flop/s of CHOLMOD's scalar simplicial loop, measured on one core: 3e9 in cache, below 1e9 outside of it */
static const double SIMPLICIAL_RATE = 2.5e9;

/* Rounding leaves 1e-17 of the largest pivot where zero is exact. Pivots of a regular network span a few
 * powers of ten. */
static const double ROUNDING = 1e-14;

static palp_status create_chosen_solver(palp_solver solver, size_t n, const size_t *column,
                                        const int32_t *row, linsys_made *made) {
    if (solver == PALP_SOLVER_BAND)
        return linsys_band_make(n, column, row, made);
    if (solver == PALP_SOLVER_SIMPLICIAL || solver == PALP_SOLVER_SUPERNODAL)
        return linsys_cholmod_make(solver == PALP_SOLVER_SUPERNODAL, n, column, row, made);
    double band;
    palp_status status = linsys_band_cost(n, column, row, &band);
    if (!status)
        status = linsys_cholmod_make(false, n, column, row, made);
    if (status || made->flops / SIMPLICIAL_RATE <= band)
        return status;
    made->ops->destroy(made->self);
    return linsys_band_make(n, column, row, made);
}

palp_status linsys_create(palp_solver solver, size_t n, const size_t *column, const int32_t *row,
                          linsys **out) {
    linsys *ls = malloc(sizeof *ls);
    if (!ls)
        return PALP_ERR_NO_MEMORY;
    palp_status status = create_chosen_solver(solver, n, column, row, &ls->made);
    if (status) {
        free(ls);
        return status;
    }
    *out = ls;
    return PALP_OK;
}

void linsys_free(linsys *ls) {
    if (ls) {
        ls->made.ops->destroy(ls->made.self);
        free(ls);
    }
}

double *linsys_values(linsys *ls) {
    return ls->made.values;
}

size_t linsys_value_count(const linsys *ls) {
    return ls->made.count;
}

size_t linsys_slot(const linsys *ls, size_t row, size_t column) {
    return ls->made.ops->slot(ls->made.self, row, column);
}

double linsys_flops(const linsys *ls) {
    return ls->made.flops;
}

/* A pivot below rounding of the largest one counts as zero: the matrix is singular. */
static palp_status judge_factor_by_pivots(palp_status status, const linsys_pivots *pivots, int *negative) {
    *negative = pivots->negative;
    if (!status && !(pivots->least >= ROUNDING * pivots->largest))
        return PALP_ERR_SINGULAR;
    return status;
}

palp_status linsys_factor(linsys *ls, int *negative) {
    linsys_pivots pivots = {0};
    palp_status status = ls->made.ops->factor(ls->made.self, &pivots);
    return judge_factor_by_pivots(status, &pivots, negative);
}

void linsys_begin(linsys *ls) {
    if (ls->made.ops->begin)
        ls->made.ops->begin(ls->made.self);
}

palp_status linsys_advance(linsys *ls, double flops, int *negative, bool *done) {
    linsys_pivots pivots = {0};
    *done = !ls->made.ops->advance;
    if (*done)
        return linsys_factor(ls, negative);
    palp_status status = ls->made.ops->advance(ls->made.self, flops, &pivots, done);
    return judge_factor_by_pivots(status, &pivots, negative);
}

void linsys_solve(linsys *ls, double *b) {
    ls->made.ops->solve(ls->made.self, b);
}
