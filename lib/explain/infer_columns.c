/* infer_columns.c: the functions whose sum is a run's discrepancy: of depth on both ways, of the time in a
 * dwell, and of the height of a withdrawing plate, which a specimen may follow. Each is a natural cubic
 * spline, 1 at one node of a grid and 0 at the others; they are called hats for short. */
#include "infer_internal.h"
#include "model/model_internal.h"
#include "response/free_term.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void infer_hats(const explain_data *data, size_t r, double contact, double *column) {
    const explain_run *run = &data->run[r];
    const size_t n = run->n;
    const double span = log(data->duration / data->step);
    double bend[FREE_BENDS], top = run->depth[0], bottom = run->depth[0];
    bool back = false;
    const double surface = fmin(0.0, contact); /* below nominal contact there are the others */
    double above = 0.0, *dwell = column + INFER_DWELL * INFER_NODES * n;
    for (size_t i = 0; i < n; i++)
        above = fmax(above, surface - run->depth[i]);
    const double height = log1p(above / data->stride); /* the distance to which a surface follows the plate is
                                                          unknown */
    free_term_bends(bend);
    memset(column, 0, INFER_HATS * n * sizeof *column);
    for (size_t i = 0; i < n; i++) {
        const double turned = 0.01 * data->deepest;
        top = fmax(top, run->depth[i]);
        bottom = fmin(bottom, run->depth[i]);
        if (!back && run->depth[i] < top - turned) {
            back = true;
            bottom = run->depth[i];
        } else if (back && run->depth[i] > bottom + turned) {
            back = false;
            top = run->depth[i];
        }
        if (run->depth[i] <= 0.0) {
            if (back && top > surface && run->depth[i] < surface)
                free_term_hats(bend, log1p((surface - run->depth[i]) / data->stride) / height, 1.0, n, i,
                               column + INFER_WITHDRAWN * INFER_NODES * n);
            continue;
        }
        free_term_hats(bend, run->depth[i] / run->height / data->strain, 1.0, n, i,
                       column + (size_t)(back ? INFER_UNLOADING : INFER_LOADING) * INFER_NODES * n);
        if (run->stood[i] >= 0.0)
            free_term_hats(bend, log(fmax(run->stood[i], data->step) / data->step) / span,
                           run->depth[i] / data->deepest, n, i, dwell);
        dwell[i] = 0.0; /* the force is continuous at the start of a dwell */
    }
}

/* ---- free terms ---- */

static bool is_one_session(const explain_data *data) {
    for (size_t r = 1; r < data->n_runs; r++)
        if (data->run[r].session != data->run[0].session)
            return false;
    return true;
}

static void find_range(const explain_data *data, palp_free_kind kind, double *from, double *to) {
    double top = HUGE_VAL, first = HUGE_VAL;
    for (size_t r = 0; r < data->n_runs; r++) {
        first = fmin(first, data->run[r].session);
        for (size_t i = 0; i < data->run[r].n; i++)
            top = fmin(top, data->run[r].depth[i]);
    }
    *from = 0.0;
    switch (kind) {
    case PALP_FREE_LOADING:
    case PALP_FREE_UNLOADING:
        *to = data->strain;
        break;
    case PALP_FREE_DWELL:
    case PALP_FREE_EARLY:
        *from = log(data->step);
        *to = log(data->duration);
        break;
    case PALP_FREE_SPEED:
    case PALP_FREE_PRESSED_SPEED:
        *to = asinh(data->fastest * data->step / data->stride);
        *from = -*to;
        break;
    case PALP_FREE_TURN:
        *to = data->deepest - top;
        break;
    case PALP_FREE_SESSION:
        *from = first;
        *to = first + data->span;
        break;
    case PALP_FREE_GAIN: /* of nothing in air */
        *to = data->deepest;
        break;
    case PALP_FREE_PLACE:
        *from = top;
        *to = data->deepest;
        break;
    case PALP_FREE_RESPONSE: /* two samples a node */
        *to = 2.0 * (INFER_NODES - 1) * data->step;
        break;
    default:
        *to = data->duration;
    }
}

palp_status infer_free_term(const explain_data *data, palp_free_kind kind, int longer, palp_free_term *term) {
    const bool by_clock = kind == PALP_FREE_RUN || kind == PALP_FREE_EARLY || kind == PALP_FREE_AGEING;
    *term = (palp_free_term){.kind = kind,
                             .depth_m = data->deepest,
                             .slow_m_s = data->stride / data->step,
                             .plate_N = palp_model_free_of_force(kind) ? data->peak : 0.0};
    find_range(data, kind, &term->from, &term->to);
    if (kind == PALP_FREE_RESPONSE) {
        term->to = ldexp(term->to, longer);
        if (term->to > 0.25 * data->duration)
            return PALP_ERR_UNSUPPORTED; /* it is over before the run is */
    }
    if ((by_clock && data->n_runs < 2) || (kind == PALP_FREE_SESSION && is_one_session(data)))
        return PALP_ERR_UNSUPPORTED; /* it need not come again, or another kind is the same */
    return palp_free_term_check(term) ? PALP_ERR_UNSUPPORTED : PALP_OK;
}

palp_status infer_free_hats(const infer_fit *fit, const explain_data *data, size_t r, const double *left,
                            double *column) {
    enum { N = INFER_NODES };
    const explain_run *run = &data->run[r];
    const size_t n = run->n;
    double *force = malloc(n * sizeof *force);
    palp_status status = force ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && force; i++)
        force[i] = run->force[i] - left[i];
    memset(column, 0, INFER_HATS * n * sizeof *column);
    for (size_t d = 0; d < fit->n_terms && !status; d++)
        status = free_term_columns(&fit->term[d], n, run->time, run->depth, run->height, run->session, force,
                                   column + d * N * n);
    free(force);
    return status;
}
