/* infer_answer.h: what the posterior says beyond the set of effects: the check by prediction, equivalence
 * classes, discrepancy and free terms. Internal. */
#ifndef INFER_ANSWER_H
#define INFER_ANSWER_H

#include "infer_search.h"

/* ---- cross-validation (infer_check.c) ---- */

/* Log probability of each run given the others, or of the runs held out given those that are fitted. Of a
 * single run it is that of each eighth given the seven others. All parameters take the best step of the
 * linear problem. */
typedef struct infer_left_out {
    size_t n;
    double *score; /* [n] nats */
    double rms_N;  /* of the residual of these runs; 0: there is a single one */
} infer_left_out;

/* Sets held_out or use of a run for a moment. infer_left_out_free, on failure too. */
palp_status infer_leave_out(const infer_fit *fit, explain_data *data, infer_left_out *out);
double infer_predicts_better(const infer_left_out *with, const infer_left_out *without,
                             double *se); /* nats; paired */
void infer_left_out_free(infer_left_out *left);

/* ---- the law (infer_law.c) ---- */

/* Log odds of the fit's law over the family of the given one, nats; and the law of that family that the
 * posterior is nearest to. A law without a family, as a spline is: 0, and it stays as it is. */
palp_status infer_law_compare(const infer_fit *fit, const explain_data *data, const palp_law *given,
                              palp_law *nearest, double *nats);

/* e->law of the fit at hand; base: the fit of the model as given. */
palp_status infer_law_find(const infer_search *s, const palp_model *given, palp_explanation *e);

/* ---- the accepted effects (infer_describe.c) ---- */

/* exchanged: a look-alike that is more probable than its effect may take its place in the fit at hand; it
 * has, and e has to be described anew. */
palp_status infer_describe(infer_search *s, palp_explanation *e, bool *exchanged);

/* The experiment with the largest expected information on which effect of out's equivalence class is the true
 * one. It replaces *next if it has more. (infer_next.c) */
palp_status infer_next_find(const infer_search *full, const infer_search *rest,
                            const palp_explain_effect *out, palp_explain_next *next);

/* ---- what remains (infer_remains.c) ---- */

/* residual[data.n] of the fit at hand, refitted with one zero, contact and gain for all runs. */
palp_status infer_before_find(const infer_search *s, double *residual);

/* Zeros, contacts and gains of the runs about their means, each with its evidence. */
palp_status infer_scatter_find(const infer_search *s, palp_explanation *e);

/* The fit at hand with its discrepancy left out, all else as it is; the caller's to free. */
palp_status infer_without_discrepancy(const infer_search *s, infer_fit *without);

/* Adds to nats what one size of the fit costs: its log-uniform prior over what its posterior leaves of it
 * (Laplace). */
palp_status infer_size_cost(infer_fit *fit, const explain_data *data, double *size, double *nats);

/* What all sizes of the fit's discrepancy cost, nats; 0: it has none. */
palp_status infer_discrepancy_cost(const infer_search *s, double *nats);

/* Evidence of the discrepancy of the fit at hand, nats. */
palp_status infer_discrepancy_weigh(const infer_search *s, double *nats);

/* The same, and the fit without it where that is more probable. */
palp_status infer_discrepancy_drop(infer_search *s, double *nats);

/* e->discrepancy, whose evidence is there already; s->residual and s->discrepancy are those of the fit at
 * hand. */
palp_status infer_discrepancy_find(const infer_search *s, palp_explanation *e);

/* ---- free terms (infer_free.c) ---- */

/* What all runs share of what no effect follows, where it is certain, as a fit with terms: *found is the
 * caller's to free, its raw NULL where there is none. Effects of the fit at hand that the terms make needless
 * are removed: they stand for what has no name. Their candidates get the reason; e->gap.heldout_after_N is
 * that of the fit without them. */
palp_status infer_free_find(infer_search *s, palp_explanation *e, infer_fit *found);

/* Writes these terms into e->free and e->model, whose verdict is unexplained then. Where another effect took
 * the place of one, they are found anew. */
palp_status infer_free_take(const infer_search *s, palp_explanation *e, infer_fit *found);

#endif
