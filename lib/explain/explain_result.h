/* explain_result.h: what the search found, as the caller gets it. Internal. */
#ifndef EXPLAIN_RESULT_H
#define EXPLAIN_RESULT_H

#include "explain_data.h"

/* ---- runs and shares (explain_result.c) ---- */

palp_status explain_copy_runs(const explain_data *data, palp_explanation *e);
void explain_keep_residual(const double *residual, palp_explanation *e, bool before);

void explain_phase_shares(const explain_data *data, palp_explanation *e, double noise_level_N);

/* ---- what to run next ---- */

/* Runs that the indenter can do (explain_next.c): the path of the k-th, how it is told, and the rms of the
 * difference of two forces along it that is left once the run's own zero and gain are free. */
enum { EXPLAIN_PROTOCOLS = 8, EXPLAIN_PATH = 2000 };
typedef struct explain_path {
    size_t n;
    double time[EXPLAIN_PATH], depth[EXPLAIN_PATH];
} explain_path;
void explain_path_find(size_t k, const explain_data *data, explain_path *p);
palp_explain_next explain_next_of(size_t k, const explain_data *data);
double explain_separation(const explain_path *p, const double *a, const double *b);

/* ---- diagnostics (explain_diagnostics.c) ---- */

/* Of the residual; slips become events. */
palp_status explain_diagnostics_find(explain_data *data, const double *residual, palp_explanation *e);

#endif
