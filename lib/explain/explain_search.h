/* explain_search.h: candidates beside a fit, and the steps that add them. Internal. */
#ifndef EXPLAIN_SEARCH_H
#define EXPLAIN_SEARCH_H

#include "explain_fit.h"

/* Of what the best candidate promises: the fit of one that promises less is not finished. */
#define EXPLAIN_CONTENDER 0.3

/* ---- one candidate (explain_candidate.c) ---- */

/* Fits with one more effect, from several starts. */
typedef struct explain_start {
    explain_fit fit;
    double chi2; /* that one more step promises */
} explain_start;

typedef struct explain_multistart {
    size_t n; /* best first */
    explain_start start[2 * EFFECT_STARTS];
} explain_multistart;

void explain_multistart_free(explain_multistart *m);

bool explain_has(const explain_fit *fit, palp_effect_id id);

/* Where an effect's search starts, whatever the paths of the plate show of it. ERR_UNSUPPORTED: these runs
 * cannot have it. */
palp_status explain_starts_of(palp_effect_id id, const explain_data *data, const double *residual,
                              effect_starts *s);

/* The same where the paths show it too. ERR_UNSUPPORTED: these runs cannot have it (reason). */
palp_status explain_starts_find(palp_effect_id id, const explain_data *data, const double *residual,
                                effect_starts *s, const char **reason);

/* Refines the few best starts, if chi2 promises to fall by worth. ERR_UNSUPPORTED: these runs cannot have it
 * (reason). */
palp_status explain_candidate_multistart(const explain_fit *base, const explain_data *data,
                                         const double *residual, const palp_explain_settings *settings,
                                         palp_effect_id id, double worth, explain_multistart *m,
                                         const char **reason);

/* Refits the last few and moves the best one to *added, which is never worse than base; not all: the first as
 * it is. */
palp_status explain_candidate_finish(const explain_fit *base, explain_multistart *m, const explain_data *data,
                                     const palp_explain_settings *settings, palp_effect_id id, bool all,
                                     explain_fit *added);

/* ---- all of them beside a fit (explain_search.c) ---- */

typedef struct explain_trial {
    bool tried;
    explain_multistart *multistart; /* while it runs */
    explain_fit fit;                /* product NULL: could not be had, reason says why */
    const char *reason;
    double raw_gain, gain;             /* log likelihood gained; less what its parameters cost */
    double held_out_gain, held_out_se; /* in held-out log score; paired standard error over the runs */
    double held_out_rest;              /* of that, without the run that gains most */
    double *force;                     /* [n] of the model */
    double inflation;                  /* of the evidence's scatter, by what is left beside noise */
    double beside_zeros;               /* gain, if the zeros of the runs may wander without it and with it */
    double explained;                  /* rms difference of the forces */
    bool from_zero; /* the interval of a strength, as the runs scatter, is away from zero */
} explain_trial;

/* What was found when each effect was added: models whose last effect is the candidate. */
typedef struct explain_step {
    bool has[PALP_EFFECT_COUNT], renewed[PALP_EFFECT_COUNT];
    palp_model model[PALP_EFFECT_COUNT];
} explain_step;

typedef struct explain_memory {
    size_t n;
    explain_step step[PALP_EXPLAIN_EFFECTS];
} explain_memory;

typedef struct explain_search {
    explain_data data;
    const palp_explain_settings *settings;
    explain_memory *memory;
    size_t n_given;    /* effects of the given model */
    double opened;     /* rms that the model as given leaves, N */
    double worth;      /* chi2 that a candidate must promise to be tried */
    double taken_gain; /* raw_gain of the trial taken last */
    double step_share; /* of all work, one explain_try_all is */
    bool law_fixed;    /* another law is no candidate */
    bool law_changed;  /* the law at hand is of another family than first_material's, the given one refitted,
                          or its arms are driven otherwise */
    palp_material first_material;
    palp_model given; /* as it was given but for that law and those arms */
    const palp_model *as_given;
    explain_fit fit;          /* at hand */
    double *force, *residual; /* [n] of it, and what is left beside it and the runs' own contacts, zeros,
                                 gains and hum */
    double *first; /* [n] residual of the model as given, refitted; NULL in a search without an effect */
    double share[PALP_EFFECT_COUNT]; /* of each effect's column, left beside the richest material that these
                                        runs could carry */
    explain_trial trial[PALP_EFFECT_COUNT];
} explain_search;

/* So much more of all work is done. */
void explain_tell(const explain_search *s, double share);

/* fit->model refitted with noise and scatter; force and residual at it. */
palp_status explain_refit(explain_search *s);
palp_status explain_try_all(explain_search *s);
void explain_trials_free(explain_search *s);
void explain_search_free(explain_search *s); /* but for its data */

/* What has come of a candidate's fit (t->fit) beside s->fit. id: PALP_EFFECT_COUNT for another law. */
palp_status explain_trial_examine(const explain_search *s, palp_effect_id id, explain_trial *t);

/* ---- the law (explain_law.c) ---- */

/* The family of laws that gains most beside the effects at hand; best->fit.product NULL: none gains what it
 * costs. */
palp_status explain_law_try(const explain_search *s, double threshold, explain_trial *best);
palp_status explain_law_take(explain_search *s, explain_trial *law);

/* Whether a trial of another law, or of other laws of the specimens, has what an effect must have. */
bool explain_law_believed(const explain_search *s, const explain_trial *t, double threshold);
void explain_law_free(explain_trial *law);

/* The spline law at hand with a few more knots at its sharpest bends, refitted; and what looking for those
 * places costs, nats. ERR_ARGUMENT: there are none. (explain_knots.c) */
palp_status explain_knots_add(const explain_search *s, explain_fit *fit);
double explain_knots_cost(const explain_search *s, size_t n);

/* Whether the effect of trial t, of the contact or the instrument, gains more than chance beside that law
 * too. */
palp_status explain_law_spares(const explain_search *s, const explain_trial *law, const explain_trial *t,
                               double threshold, bool *stands);

/* ---- specimens (explain_specimens.c) ---- */

/* A stiffness of each specimen beside the effects at hand, where the files name several; trial->fit.product
 * NULL: it does not gain what it must, or the runs of one specimen differ as much as those of different ones.
 */
palp_status explain_specimens_try(const explain_search *s, double threshold, explain_trial *trial);
palp_status explain_specimens_take(explain_search *s, explain_trial *trial);

/* Whether what the runs have of their own (nuisance parameter q) is their specimens'. */
bool explain_of_specimens(const explain_fit *fit, const explain_data *data, size_t q);

/* The law near the surface and where all runs have it stand in for each other, so that a fit may hold on to a
 * place that is not the best: a refit that also moves it to surfaces higher or lower, with the law that goes
 * with them, as long as that is more likely. */
palp_status explain_refit_anywhere(explain_search *s);

/* What the changed law is good for beside the effects at hand; one that is not needed any more is taken back.
 */
palp_status explain_law_review(explain_search *s, palp_explain_law *found);

/* ---- explain_held_out.c ---- */

/* rms of what the fit, refitted without each run, leaves of that run where no other run is less deep; with
 * runs held out, what the fit leaves of them. */
palp_status explain_held_out(const explain_search *s, const explain_fit *fit, double *rms_N);

/* ---- what can be told from noise (explain_rest.c) ---- */

typedef struct explain_rest {
    double rms_N;  /* of what is no noise, over all samples; 0 = nothing is left */
    double most_N; /* in the run that has most of it */
    size_t run;
} explain_rest;

/* Of a fit's force[n] and residual[n]: structure that noise has not, at the settings' chance of a false
 * alarm; and listed releases, around which samples do not count, that the force does not follow. */
palp_status explain_rest_find(const explain_search *s, const double *force, const double *residual,
                              explain_rest *rest);
bool explain_rest_matters(const explain_search *s,
                          const explain_rest *rest); /* in some run it is beyond the practical limit */

/* By how much what a residual[n] has beside noise widens the scatter of sums over it; 1: it is noise. */
palp_status explain_rest_inflation(const explain_data *data, const double *residual, double *inflation);

/* ---- zeros that wander (explain_wander.c) ---- */

/* What the fit gains if the zeros of the runs may wander, with its parameters moved by a step and its scatter
 * found anew, nats, less what their pace costs. */
palp_status explain_wander_find(const explain_fit *fit, const explain_data *data,
                                const palp_explain_settings *settings, double *gain);

/* ---- explain_null.c ---- */

/* Gain in log likelihood that chance alone reaches beside s->fit, over all candidates, with probability
 * false_alarm. share: NULL, or [PALP_EFFECT_COUNT] zeros: s->share. */
palp_status explain_null_threshold(const explain_search *s, double *threshold, double *share);

/* ---- what these runs can show (explain_share.c) ---- */

/* How many coefficients and arms the richest material has that they could carry. */
size_t explain_rich_law(const explain_data *data);
size_t explain_rich_arms(const explain_search *s);

/* Its columns in run r, [law + arms, n]. */
palp_status explain_rich_columns(const explain_search *s, size_t r, double *column);

/* Whether enough of an effect is left beside that for it to be named. */
bool explain_shows(const explain_search *s, palp_effect_id id);

/* Whether these runs cannot tell of it, for that or for what they lack; and why, in words. */
bool explain_blind(const explain_search *s, palp_effect_id id);
void explain_say_blind(const explain_search *s, palp_effect_id id, char text[PALP_EXPLAIN_REASON]);

/* ---- without one of the added effects (explain_without.c) ---- */

size_t explain_added_count(const explain_search *s);
palp_effect explain_added(const explain_search *s, size_t i); /* the hum is the last */

/* The search at the fit without added effect i, which shares the data; explain_search_free of both. */
palp_status explain_search_without(const explain_search *full, size_t i, explain_search *rest);

/* full's own fit as the trial of id there. */
palp_status explain_trial_again(const explain_search *full, explain_search *rest, palp_effect_id id);

/* ---- a step (explain_step.c) ---- */

/* Why a trial may not be accepted; NULL: it may. */
const char *explain_judged(const explain_search *s, const explain_trial *t, double threshold);

/* Whether that is all that speaks against it: there is no second run that it helps. */
bool explain_unconfirmed(const char *reason);

/* The one that gains most of those that may; PALP_EFFECT_COUNT: none. */
size_t explain_best_trial(const explain_search *s, double threshold, palp_status *status);

/* Where the fit leaves something that is no noise and no trial may be accepted: of those that explain no more
 * than what an effect's equations are good for, and have all else, the one that gains most and leaves
 * nothing; PALP_EFFECT_COUNT: none. */
palp_status explain_completing_trial(explain_search *s, double threshold, size_t *best);
palp_status explain_take(explain_search *s, size_t i);

/* Takes out an effect without which the model loses no more than chance gives, or one that gains less than
 * that and would not be added again beside the others; *dropped is PALP_EFFECT_COUNT: there is none. last:
 * the one added last may be it too. */
palp_status explain_drop(explain_search *s, double threshold, double gain, bool last,
                         palp_effect_id *dropped);

/* Of two arms either may have been added; the one nearer to a given arm takes that one's place. */
palp_status explain_keep_given_arms(explain_search *s);

#endif
