/* explain_internal.h: the parts of palp_explain: runs, the noise, a fit as its sums, candidates. Internal. */
#ifndef EXPLAIN_INTERNAL_H
#define EXPLAIN_INTERNAL_H

#include <palpate/explain.h>

#include "effect/effect_internal.h"

enum {
    EXPLAIN_NUISANCES = 5,                        /* of a run: zero, contact, gain, hum's sine and cosine */
    EXPLAIN_COLUMNS = PALP_LAW_MAX + 2 * PALP_ARMS_MAX + PALP_EFFECTS_MAX * PALP_EFFECT_PARAMETERS,
    EXPLAIN_FREQUENCIES = 601                     /* at which the mains' line is looked for */
};

/* Of what the best candidate promises: the fit of one that promises less is not finished. */
#define EXPLAIN_CONTENDER 0.3

/* ---- runs (explain_data.c) ---- */
typedef struct explain_run {
    char name[PALP_NAME_MAX];
    size_t n;
    double *time, *depth, *force;  /* depth: nothing is pressed where the specimen is "none" */
    unsigned char *use;            /* [n] 0 = an event, or not to be fitted */
    unsigned char *phase;          /* [n] palp_phase */
    double session, white;         /* when it began; sd of a sample's white noise */
    bool fresh;                    /* on a specimen that no run before it pressed */
    double worn;                   /* largest strain of the earlier runs on its specimen, by depth */
    double *keep, *take, *weight;  /* [n] the filter that makes its noise white (explain_noise.c) */
    int replicate;                      /* earlier run of the same protocol, -1 = none */
    bool held_out;                   /* kept out of the fit */
} explain_run;

typedef struct explain_data {
    size_t n_runs, n, longest;
    explain_run *run;
    const palp_model *given;                /* the model to be explained */
    double peak, deepest, duration, height; /* largest force, depth; longest run, s */
    double correlated, correlation_time;           /* of the noise */
    double zero_scatter;                    /* of the force before the plate first moves, between runs; 0 = unknown */
    double replicate_gain;                       /* scatter of gain between runs of one protocol; 0 = there are none */
    size_t n_replicates;
    double pull, pull_most;                 /* the strongest recorded before a plate let go; what would be too strong */
    size_t n_releases;
    size_t n_events;
    palp_explain_event *event;
} explain_data;

palp_status explain_data_create(size_t n, const palp_explain_input *inputs, const palp_explain_settings *settings,
                                const palp_model *model, explain_data *data, palp_error *error);
void explain_data_free(explain_data *data);
effect_data explain_facts(const explain_data *data); /* without what a fit leaves of them */
palp_status explain_event_add(explain_data *data, const palp_explain_event *event);

/* What a specimen keeps from run to run; zero-initialised before the first, palp_forward_wear_free after the last. */
typedef struct explain_wear {
    palp_forward_wear wear;
    double slope[EXPLAIN_COLUMNS];
} explain_wear;

/* For the runs one after the other, in their order, all with one model. */
palp_forward_run explain_forward_run(const explain_run *run, explain_wear *wear);

/* ---- the session (explain_order.c) ---- */

/* Order of the inputs: by specimen, then by the time at which they began; fresh[n] in that order. */
void explain_order_find(size_t n, const palp_explain_input *inputs, size_t *order, bool *fresh);

/* Text or number of a file's key, or what is to stand for it. */
const char *explain_text_of(const palp_experiment *e, const char *key);
double explain_number_of(const palp_experiment *e, const char *key, double otherwise);

/* ---- what a model gives (explain_predict.c): as palp_forward_force, for a network by forward_network_force ---- */
bool explain_carries(const palp_model *model, const palp_effect_info *info);
palp_status explain_height(const palp_model *model, double *height, palp_error *error); /* m, of a network its mesh's */
palp_status explain_predict(const palp_model *model, const palp_forward_run *run, double *force, double *gradient,
                            palp_error *error);

/* ---- noise (explain_noise.c) ---- */

/* From what a fit leaves, residual[n] of all runs one after the other: white noise of each run, correlated noise
 * (exponential correlation) of all, and the filters. */
/* run->white from x[n], its force or its residual. */
palp_status explain_white_noise(explain_run *run, const double *x);
palp_status explain_noise_find(explain_data *data, const double *residual);

/* In place: x[n] with the noise's correlation taken out and in units of its sd; masked samples become 0. */
void explain_whiten(const explain_run *run, double *x);

/* ---- a model and its search coordinates (explain_fit.c) ---- */

/* Scatter of the runs' nuisance parameters. Their prior sds are that, divided by misfit: the root of chi2 per sample, from 1; so
 * that a model's own faults, which count as many times too much, do not drive them beyond it. */
typedef struct explain_scatter {
    double zero, contact, gain, misfit;
} explain_scatter;

typedef struct explain_fit {
    palp_model model;
    double hum_Hz, hum_N; /* 0 = none; prior sd of its amplitude */
    size_t n_columns, m;
    double low[EXPLAIN_COLUMNS], high[EXPLAIN_COLUMNS], x[EXPLAIN_COLUMNS]; /* search coordinates */
    double unit[EXPLAIN_COLUMNS];  /* prior sd of a coordinate: very wide */
    bool logarithmic[EXPLAIN_COLUMNS];
    explain_scatter scatter;
    double *product;      /* [n_runs m m]: of the whitened columns of parameters, (nuisance parameters) and residual */
    double score;         /* log likelihood (less constants), nuisances integrated out; runs held out not counted */
} explain_fit;

palp_status explain_fit_create(const palp_model *model, const explain_data *data, explain_fit *fit);
/* The same for another model, with base's scatter and hum. */
palp_status explain_fit_beside(const explain_fit *base, const palp_model *model, const explain_data *data,
                               explain_fit *fit);
size_t explain_first_column(const palp_model *model, size_t i); /* index of the first parameter of effect i */
void explain_fit_free(explain_fit *fit);
palp_status explain_fit_copy(const explain_fit *from, size_t n_runs, explain_fit *to);

/* Products at fit->model. force (NULL or [n]): what the model gives, hum and a run's nuisance parameters left out. */
palp_status explain_fit_products(explain_fit *fit, const explain_data *data, double *force);

/* fit->x into fit->model. ERR_ARGUMENT: makes no model. Log likelihood from the products. */
palp_status explain_fit_to_model(explain_fit *fit);
double explain_fit_score(const explain_fit *fit, const explain_data *data);

/* Moves to the best parameters near by. */
palp_status explain_fit_improve(explain_fit *fit, const explain_data *data, size_t rounds);

/* Re-estimates the scatter from the runs' nuisance parameters. */
void explain_fit_scatter(explain_fit *fit, const explain_data *data, const palp_explain_settings *settings);

/* chi2 after one more step, as the sums predict it. */
palp_status explain_fit_predict(const explain_fit *fit, const explain_data *data, double *chi2);

/* Normal matrix h[k k] (NULL: not wanted, nor g), gradient g[k] and chi2 of run r with its nuisance parameters eliminated;
 * logdet: by how much they narrow. */
void explain_normal_of(const explain_fit *fit, size_t r, double *h, double *g, double *chi2, double *logdet);

/* The run's nuisance parameters at the fit. */
void explain_nuisances(const explain_fit *fit, size_t r, double own[EXPLAIN_NUISANCES], double nuisance_sd[EXPLAIN_NUISANCES]);

/* Of all runs that are not held out, with the priors. work: [k k + k]. */
void explain_fit_total(const explain_fit *fit, const explain_data *data, double *h, double *g, double *chi2,
                       double *work);

/* Held-out log score of each run, predicted by the others: score[n_runs]. */
palp_status explain_fit_leave_out(const explain_fit *fit, const explain_data *data, double *score);

/* ---- candidates (explain_candidate.c, explain_lines.c) ---- */

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

/* Refines the few best starts, if chi2 promises to fall by worth. ERR_UNSUPPORTED: these runs cannot have it (reason). */
palp_status explain_candidate_multistart(const explain_fit *fit, const explain_data *data, const double *residual,
                                         const palp_explain_settings *settings, palp_effect_id id, double worth,
                                         explain_multistart *m, const char **reason);

/* Refits the last few and moves the best one to *added; not all: the first as it is. */
palp_status explain_candidate_finish(explain_multistart *m, const explain_data *data,
                                     const palp_explain_settings *settings, palp_effect_id id, bool all,
                                     explain_fit *added);

/* Strongest line of residual[n] over time, 40 to 70 Hz (ERR_UNSUPPORTED: none stands out), and over depth. */
palp_status explain_line_in_time(const explain_data *data, const double *residual, double *frequency, double *amplitude);
/* Takes a line of that frequency off each run's residual. */
void explain_line_take(const explain_data *data, double frequency, double *residual);
palp_status explain_line_in_depth(const explain_data *data, const double *residual, double *period, double *amplitude,
                                  double *phase);
/* The strongest lines of residual, at any frequency, and over depth. */
palp_status explain_peak_in_time(const explain_data *data, const double *residual, palp_explain_peak *peak);
palp_status explain_peak_in_depth(const explain_data *data, const double *residual, palp_explain_peak *peak);

/* ---- the search (explain_search.c, explain_held_out.c) ---- */

/* One candidate beside a fit. */
typedef struct explain_trial {
    bool tried;
    explain_multistart *multistart; /* while it runs */
    explain_fit fit;          /* product NULL: could not be had, reason says why */
    const char *reason;
    double raw_gain, gain;    /* log likelihood gained; less what its parameters cost */
    double held_out_gain, held_out_se; /* in held-out log score; paired standard error over the runs */
    double held_out_rest;     /* of that, without the run that gains most */
    double *force;            /* [n] of the model */
    double explained;         /* rms difference of the forces */
    double shrinks;           /* root of by how much the squared residual shrinks, rms */
} explain_trial;

/* What was found when each effect was added: models whose last effect is the candidate. */
typedef struct explain_step {
    bool has[PALP_EFFECT_COUNT];
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
    size_t n_given;           /* effects of the given model */
    double opened;            /* rms that the model as given leaves, N */
    double worth;             /* chi2 that a candidate must promise to be tried */
    double taken_gain;        /* raw_gain of the trial taken last */
    explain_fit fit;          /* at hand */
    double *force, *residual; /* [n] of it; hum is taken out of the residual */
    explain_trial trial[PALP_EFFECT_COUNT];
} explain_search;

/* fit->model refitted with noise and scatter; force and residual at it. */
palp_status explain_refit(explain_search *s);
/* Tries all candidates beside s->fit. */
palp_status explain_try_all(explain_search *s);
void explain_trials_free(explain_search *s);
/* What has come of a candidate's fit (t->fit) beside s->fit. */
palp_status explain_trial_examine(const explain_search *s, palp_effect_id id, explain_trial *t);

/* Held-out log score of b less that of a; its standard error, paired over the runs; less the run that gains most. */
typedef struct explain_pair {
    double gain, se, rest;
} explain_pair;
palp_status explain_paired(const explain_data *data, const explain_fit *a, const explain_fit *b, explain_pair *pair);

/* ---- a step (explain_step.c) ---- */

/* Why a trial may not be accepted; NULL: it may. */
const char *explain_judged(const explain_search *s, const explain_trial *t, double threshold, double noise_level_N);
/* The one that gains most of those that may; PALP_EFFECT_COUNT: none. */
size_t explain_best_trial(const explain_search *s, double threshold, const bool *seen, palp_status *status);
palp_status explain_take(explain_search *s, size_t i);
/* Takes out an effect that would not be added again beside the others; PALP_EFFECT_COUNT: there is none. */
palp_status explain_drop(explain_search *s, double threshold, palp_effect_id *dropped);
/* Of two arms either may have been added; the one nearer to a given arm takes that one's place. */
palp_status explain_keep_given_arms(explain_search *s);

/* ---- what was accepted (explain_describe.c, explain_interval.c, explain_result.c) ---- */

size_t explain_added_count(const explain_search *s);
palp_effect explain_added(const explain_search *s, size_t i); /* the hum is the last */
/* The search at the fit without added effect i, explain_search_free (of both that shares data); full's own fit as the
 * trial of id there. */
palp_status explain_search_without(const explain_search *full, size_t i, explain_search *rest);
palp_status explain_trial_again(const explain_search *full, explain_search *rest, palp_effect_id id);
void explain_search_free(explain_search *s);
palp_status explain_describe(explain_search *s, palp_explanation *e);
palp_status explain_intervals(const explain_search *s, palp_explanation *e);
/* The hum is the model's last effect; its amplitude is the mean of the runs' own. */
void explain_add_hum(const explain_search *s, palp_explanation *e);

palp_status explain_copy_runs(const explain_search *s, palp_explanation *e);
void explain_keep_residual(const explain_search *s, palp_explanation *e, bool before);
void explain_phase_shares(const explain_data *data, palp_explanation *e, double noise_level_N);
size_t explain_list_candidates(const explain_search *s, double threshold, double noise_level_N, const bool *seen,
                             palp_explain_candidate *list);
/* Diagnostics of the residual (explain_diagnostics.c); slips become events. */
palp_status explain_diagnostics_find(explain_data *data, const double *residual, palp_explanation *e);
/* From fit and its force to the residual without a hum. */
void explain_residual(const explain_data *data, const explain_fit *fit, const double *force, double *residual);

double explain_rms(size_t n, const double *a, const double *b); /* of a - b */
double explain_fitted_rms(const explain_data *data, const double *x); /* [n], of the samples that are fitted */
/* The noise level with the fit's scatter. */
palp_status explain_noise_level(const explain_data *data, const explain_fit *fit, const double *force,
                                double *noise_level_N);
/* rms of what the fit, refitted without each run, leaves of that run where no other run is less deep; with runs
 * held out, what the fit leaves of them. */
palp_status explain_held_out(const explain_search *s, double *rms_N);
size_t explain_samples(const explain_data *data); /* of the runs that are not held out */
/* chi2 per sample of these. */
double explain_chi2(const explain_data *data, const explain_fit *fit);

/* Effects at which the search starts, as directions beside s->fit: the derivative by the strength. */
typedef struct explain_directions {
    size_t n;
    palp_effect effect[PALP_EFFECT_COUNT * EFFECT_STARTS];
} explain_directions;
palp_status explain_directions_find(const explain_search *s, explain_directions *d);
/* Whitened columns of run r: own zero, contact, gain; the model's parameters; the directions. */
palp_status explain_directions_columns(const explain_search *s, const explain_directions *d, size_t r, double *column);

/* Gain in log likelihood that chance alone reaches beside s->fit, over all candidates, with probability false_alarm.
 * seen: NULL, or [PALP_EFFECT_COUNT], set for those of which these runs show anything beside the model. */
palp_status explain_null_threshold(const explain_search *s, double *threshold, bool *seen);

/* What would do as well as out->effect: rest is the search at the fit without it, its trials done. */
palp_status explain_class_find(const explain_search *full, const explain_search *rest, palp_explain_effect *out);

/* The run that tells out->effect from one of its class best; stays as it is if none does better. */
palp_status explain_next_find(const explain_search *full, const explain_search *rest, const palp_explain_effect *out,
                              palp_explain_next *next);

#endif
