/* explain_result.h: what the search found, as the caller gets it. Internal. */
#ifndef EXPLAIN_RESULT_H
#define EXPLAIN_RESULT_H

#include "explain_search.h"

/* ---- runs, shares, candidates (explain_result.c) ---- */

palp_status explain_copy_runs(const explain_search *s, palp_explanation *e);
void explain_keep_residual(const double *residual, palp_explanation *e, bool before);

/* Takes the names back: the model is what it was before the first. */
void explain_disown(const explain_search *s, palp_explanation *e);
void explain_phase_shares(const explain_data *data, palp_explanation *e, double noise_level_N);
size_t explain_list_candidates(const explain_search *s, double threshold, palp_explain_candidate *list);

/* ---- the accepted effects ---- */

/* What would do as well as out->effect: rest is the search at the fit without it, its trials done; threshold
 * (nats): what the best of all candidates gains by chance, within which none is preferred. (explain_class.c)
 */
palp_status explain_class_find(const explain_search *full, const explain_search *rest, double threshold,
                               palp_explain_effect *out);

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

/* The run that tells out->effect from one of its class best; stays as it is if none does better.
 * (explain_next.c) */
palp_status explain_next_find(const explain_search *full, const explain_search *rest,
                              const palp_explain_effect *out, palp_explain_next *next);

/* Each with its evidence and its class. (explain_describe.c) */
palp_status explain_describe(explain_search *s, palp_explanation *e);

/* (explain_interval.c) The hum is the model's last effect; its amplitude is the mean of the runs' own. */
palp_status explain_intervals(const explain_search *s, palp_explanation *e);
/* Of the force and reach of a bond in columns at and at + 1, in search coordinates. (explain_scan.c) */
palp_status explain_scan_bond(const explain_search *s, size_t at, double low[2], double high[2]);
void explain_add_hum(const explain_search *s, palp_explanation *e);

/* ---- without what was found (explain_before.c) ---- */

/* base: the model as given, refitted. */
palp_status explain_before_find(const explain_search *s, explain_fit *base, palp_explanation *e);
palp_status explain_scatter_find(const explain_search *s, palp_explanation *e);

/* How specimens differ, after the scatter: it takes over what is theirs of it. (explain_specimens.c) */
palp_status explain_between_find(const palp_material *material, double whole, double law,
                                 palp_explanation *e);
palp_status explain_specimens_find(const explain_search *s, palp_explanation *e);

/* ---- diagnostics (explain_diagnostics.c) ---- */

/* Of the residual; slips become events. */
palp_status explain_diagnostics_find(explain_data *data, const double *residual, palp_explanation *e);

#endif
