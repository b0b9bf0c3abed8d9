/* infer_search.h: sets of effects compared by their evidence. Internal. */
#ifndef INFER_SEARCH_H
#define INFER_SEARCH_H

#include <palpate/explain.h>

#include "infer_internal.h"

/* A further effect of a fit. */
typedef struct infer_trial {
    bool tried;
    infer_fit fit;     /* fit.raw NULL: it could not be tried */
    palp_effect start; /* from which it began */
    infer_fit second;  /* from another start, as long as either may be the better one; raw NULL: none */
    double gain;       /* in log evidence, less the logarithm of the number of candidates, nats */
    double explained;  /* rms by which it changes the residual, N */
    double learned;    /* reduction of its strength's prior variance by the runs, */
    double share;      /* and the largest one at its starts with the current fit */
    palp_status status;
} infer_trial;

/* The effects of the catalogue, and arms that are driven otherwise (quasi-linear or not). */
enum { INFER_DRIVE = PALP_EFFECT_COUNT, INFER_TRIALS };

typedef struct infer_search {
    explain_data data;
    const palp_explain_settings *settings;
    size_t n_given;                          /* effects of the given model */
    infer_fit fit;                           /* at hand */
    infer_fit without[PALP_EXPLAIN_EFFECTS]; /* it without each added effect; raw NULL: not known */
    double *residual, *discrepancy;          /* [data.n] of it */
    infer_trial trial[INFER_TRIALS];
    const bool *only;  /* [INFER_TRIALS] look-alikes that are to be tried; NULL: all trials are */
    double promising;  /* smallest predicted evidence of a trial's fit that is converged */
    double drive_gain; /* nats, of arms that are driven otherwise than the given ones; 0: they are not */
    double first;      /* score of the fit with the first effect, less its price */
    size_t n_steps;
    palp_explain_step *step; /* [n_steps] */
    double step_share, told; /* of all work: that of a step, and that reported */
    bool stopped;            /* by settings.stop: some candidates were not tried */
} infer_search;

#define INFER_SEARCH_SHARE 0.7 /* of all work */

/* ---- the line of the mains, of a fit whose columns and products have it (infer_hum.c) ---- */

/* Mean amplitude over the runs, its variance, and the information on the frequency, s^2. */
palp_status infer_hum_measure(const infer_fit *fit, const explain_data *data, double *amplitude,
                              double *variance, double *information);

/* fit->c.hum_cost (Laplace). */
palp_status infer_hum_cost(infer_fit *fit, const explain_data *data);

/* explain_threshold of the settings. */
double infer_threshold(const palp_explain_settings *settings);

/* Log of the number of candidates, nats. */
double infer_price(const infer_search *s);

/* Adds each candidate to the fit at hand; their trials are freed first. */
palp_status infer_try_all(infer_search *s);
void infer_trials_free(infer_search *s);

/* Reduction of the prior variance of the strength of a fit's effect i by the runs; and the fit's scores. */
palp_status infer_learned(infer_fit *fit, const explain_data *data, size_t i, double *learned);
bool infer_is_shown(double learned); /* whether the runs determine it better than its prior */

/* Root mean square by which a fit changes the residual of the search, N. */
palp_status infer_change(const infer_search *s, const infer_fit *fit, double *rms);

/* A few steps towards its best parameters, which show its promise; freed where there are none. */
palp_status infer_approach(const infer_search *s, infer_fit *fit);

/* Parameters, sizes and noise; the fit stays unchanged where moving contacts make it worse. */
palp_status infer_settle_with_noise(const infer_search *s, size_t rounds, infer_fit *fit);

/* The most probable pair of effects after infer_try_all, if it exceeds the threshold; both->raw NULL if none
 * does. It is the caller's to free. (infer_pairs.c) */
palp_status infer_pair_find(infer_search *s, infer_fit *both, palp_effect_id pair[2]);

/* Adds effects as long as one exceeds the threshold, or a pair where none does alone. Removes those below it,
 * exchanges one for a better one. */
palp_status infer_search_run(infer_search *s);

/* If a search ended with a discrepancy or another law: fits each effect to the model as given without a
 * discrepancy. If the best of these is the better first one, it searches from there. base: the fit that the
 * search began with. Keeps the more probable end. (infer_anew.c) */
palp_status infer_search_anew(infer_search *s, const infer_fit *base);

/* Removes effects whose evidence fell below the threshold when all were fitted together, from the last to the
 * first. */
palp_status infer_search_drop(infer_search *s);

/* Goes on with a search without an effect; or with this trial of it. */
void infer_search_go_on(infer_search *s, infer_search *rest);
void infer_search_exchange(infer_search *s, infer_search *rest, int id);

/* Whether a trial has a fit whose strength the runs determine, above the practical limit. */
bool infer_may_be_named(const infer_search *s, const infer_trial *t);

/* The search without added effect i; its trials are not done. */
palp_status infer_search_without(const infer_search *full, size_t i, infer_search *rest);
void infer_search_free(infer_search *s); /* but for its data */

/* Exchanges an added arm and one of the given model where that one is then nearer to its given time; no force
 * changes. (infer_arms.c) */
palp_status infer_keep_given_arms(infer_search *s);

size_t infer_added(const infer_search *s); /* how many effects, the mains' hum the last */
/* How the specimens differ in stiffness, and whether by more than chance; into e, with each run's stiffness.
 * (infer_specimens.c) */
palp_status infer_spread_find(const infer_search *s, palp_explain_specimens *out);
palp_status infer_specimens_find(const infer_search *s, palp_explanation *e);

/* ---- a material alone (infer_material.c) ---- */

/* Writes the current fit's material, runs and specimens into out. (infer_estimates.c) */
palp_status infer_estimates_fill(infer_search *s, size_t n, const palp_explain_input *inputs,
                                 palp_specimens_fit *out);

/* Replaces the spline of the fit at hand by the most probable law of choice. The spline stays if it is more
 * probable and competes. (infer_law.c) */
palp_status infer_law_choose(infer_search *s, const palp_explain_choice *choice);

palp_effect_id infer_added_id(const infer_search *s, size_t i);

#endif
