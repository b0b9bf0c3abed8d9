/* explain_data.h: the runs that are explained, and the forces of a model along them. Internal. */
#ifndef EXPLAIN_DATA_H
#define EXPLAIN_DATA_H

#include <palpate/explain.h>

#include "effect/effect_internal.h"

enum { EXPLAIN_SAMPLES_MIN = 16 }; /* of a run */
#define EXPLAIN_EXACT 1e-6         /* of the largest force: the noise of a recording without noise */
enum { EXPLAIN_COLUMNS = PALP_LAW_MAX + 2 * PALP_ARMS_MAX + PALP_EFFECTS_MAX * PALP_EFFECT_PARAMETERS };

/* Log odds above which an answer is preferred: the odds of no false alarm to one. */
double explain_threshold(double false_alarm);

typedef struct explain_run {
    char name[PALP_NAME_MAX];
    size_t n;
    size_t n_columns; /* that effects read, the experiment's own: [n_columns] */
    palp_forward_column column[PALP_EFFECT_COUNT];
    double start;                 /* time of the recording at which time[0] = 0 is */
    double *time, *depth, *force; /* depth: nothing is pressed where the specimen is "none" */
    const double *samples;        /* [n] of how many each is the mean, 0: of none; NULL = all of one */
    const double *spread, *noise; /* [n] sds of their times, s, and of their noise, N; NULL: not known */
    double *stood;                /* [n] for how long the plate stands still, s; negative where it moves */
    unsigned char *use;           /* [n] 0 = an event, or not to be fitted */
    unsigned char *phase;         /* [n] palp_phase */
    double session, white;        /* when it began; sd of a sample's white noise */
    double height, area;          /* of its specimen, m; over the model's, 1 where a file does not say */
    bool fresh;                   /* its specimen was not pressed before */
    size_t specimen;              /* which of the data's it presses, as the files name them */
    double largest_strain;        /* largest strain of the earlier runs on its specimen, by depth */
    bool held_out;                /* kept out of the fit */
    size_t input;                 /* its first input of the caller's */
    double *added; /* [n] simulated force less the model's along the simulated path; NULL: none */
} explain_run;

/* The frame's compliance from runs on a rigid block, m/N; an interval of 95 %. */
typedef struct explain_frame {
    size_t n_runs; /* 0 = there are none */
    double compliance, low, high;
    double evidence; /* that it gives way at all, nats */
} explain_frame;

/* The inputs. One that continues another under load is joined to it. made: experiments of joined inputs, or
 * NULL. (explain_join.c) */
typedef struct explain_joined {
    size_t n, n_inputs;
    palp_explain_input *input; /* [n] */
    palp_experiment **made;    /* [n] */
    size_t *first;             /* [n] the input in which each begins */
    size_t *of;                /* [n_inputs] the input in which the run of each begins */
} explain_joined;

palp_status explain_join(size_t n, const palp_explain_input *inputs, explain_joined *joined);
void explain_joined_free(explain_joined *joined);

typedef struct explain_data {
    explain_joined joined; /* whose columns the runs read */
    size_t n_runs, n, longest;
    explain_run *run;
    palp_explain_pressed *pressed;          /* [joined.n] */
    const palp_model *given;                /* the model to be explained */
    double strain;                          /* largest */
    double peak, deepest, duration, height; /* largest force, depth; longest run, s */
    double memory;              /* longest time of the correlated noise, s; 0: that of the longest run */
    double step, fastest, span; /* typical time between samples; largest speed; of the session, s */
    double sample_noise;        /* sd of that of single samples, of runs of means; 0: it is not known */
    double stride;              /* largest way between two samples, of the run where it is least, m */
    effect_shown shown;         /* how the plate moves in them */
    size_t n_specimens;         /* that the files of the runs that are fitted name; at least 1 */
    size_t n_replicates;        /* runs with the path of an earlier one */
    double pull, pull_most;     /* the strongest recorded before a plate let go; the smallest that is too
                                   strong */
    double pulled; /* strongest pull of a withdrawal, at least the size that noise hides; 0 = no plate
                      withdraws so far */
    size_t n_releases;
    explain_frame frame;
    double threshold;        /* explain_threshold of the settings */
    bool simulated;          /* the forces are another program's: law and arms are fixed */
    double simulated_off;    /* rms error of the model's forces, N */
    bool contacts_alike;     /* no run has a contact of its own */
    bool contacts_average_0; /* exactly, over the runs that are fitted */
    bool law_alone;          /* a misfit of law and arms counts as noise: no discrepancy, no gains */
    bool times_fixed;        /* arms keep their relaxation times */
    bool reduced;            /* the model is simpler than the runs show: misfit is white noise */
    size_t n_contact_told;   /* runs with a standard deviation of their contact, */
    double contact_told;     /* and the root of the mean of its squares, m */
    size_t n_events;
    palp_explain_event *event;
} explain_data;

palp_status explain_data_create(size_t n, const palp_explain_input *inputs,
                                const palp_explain_settings *settings, const palp_model *model,
                                explain_data *data, palp_error *error);
void explain_data_free(explain_data *data);
double explain_fitted_rms(const explain_data *data,
                          const double *x);       /* [n], of the samples that are fitted */
size_t explain_samples(const explain_data *data); /* of the runs that are not held out */
bool explain_may_recover(const explain_data *data,
                         palp_effect_id id);          /* a specimen may keep its effect from run to run */
size_t explain_fitted_runs(const explain_data *data); /* how many are not */
effect_data explain_facts(const explain_data *data);  /* without the residual of a fit */
palp_status explain_event_add(explain_data *data, const palp_explain_event *event);

/* task(work, i) for all i < n by the caller's loop, or one after the other; each sets status[i], the first
 * error counts. */
palp_status explain_each(const palp_explain_settings *settings, size_t n, void (*task)(void *work, size_t i),
                         void *work, const palp_status *status);

/* run->white from x[n], its force or its residual. */
palp_status explain_white_noise(explain_run *run, const double *x);

/* What a specimen keeps from run to run; zero-initialised before the first, palp_load_history_free after the
 * last. */
typedef struct explain_history {
    bool renewed; /* between the runs it recovers: it keeps nothing */
    palp_load_history load;
    double slope[EXPLAIN_COLUMNS];
} explain_history;

/* Call it for the runs in their order, all with one model. contact: depth of the surface below the recorded
 * contact, m. */
palp_forward_run explain_forward_run(const explain_run *run, double contact, explain_history *history);

/* ---- how the plate moves (explain_shown.c) ---- */

void explain_shown_find(explain_data *data);

/* ---- runs without a specimen (explain_block.c) ---- */

/* What each input presses: by its file (specimen.kind), or else by its force relative to the others'. A run
 * without force is one of the specimen if its file names one, or if it lacks the other runs' noise.
 * palp_recording_check then refuses it. */
palp_status explain_find_pressed(size_t n, const palp_explain_input *inputs, palp_explain_pressed *pressed,
                                 palp_error *error);

palp_status explain_block_measure(size_t n, const palp_explain_input *inputs,
                                  const palp_explain_pressed *pressed, explain_frame *frame,
                                  palp_error *error);

/* Adds the frame's compliance from the blocks to a model that has none. True if it matters for the specimen's
 * runs. It is then no parameter of the fits. The effect as the result reports it: */
bool explain_frame_add(const explain_data *data, const palp_explain_settings *settings, palp_model *model);
palp_explain_effect explain_frame_effect(const explain_data *data);

/* ---- the session (explain_order.c) ---- */

/* Whether both are of one specimen, as far as their files say. */
bool explain_same_specimen(const palp_experiment *a, const palp_experiment *b);

/* Order of the inputs: by specimen, then by the time at which they began; fresh[n] in that order. */
void explain_order_find(size_t n, const palp_explain_input *inputs, size_t *order, bool *fresh);

/* Text or number of a file's key, or a default. */
const char *explain_text_of(const palp_experiment *e, const char *key);
double explain_number_of(const palp_experiment *e, const char *key, double otherwise);

/* ---- forces of another program (explain_simulated.c) ---- */

/* A lumped model that follows the simulated forces. */
palp_status explain_stand_in(size_t n, const palp_explain_input *inputs,
                             const palp_explain_settings *settings, palp_model *model, palp_error *error);

/* The error of the data's model for the simulated forces, into each run. nats: the largest change of the log
 * evidence that a difference of paths may cause. */
palp_status explain_take_simulated(explain_data *data, const palp_explain_input *simulated, double nats,
                                   palp_error *error);

/* ---- what a model gives (explain_predict.c): as palp_forward_force, for a network by forward_network_force
 * ---- */

/* Of the size of the run's specimen. */
palp_status explain_resize(palp_model *model, const explain_run *run);
bool explain_carries(const palp_model *model, const palp_effect_info *info);
palp_status explain_height(const palp_model *model, double *height,
                           palp_error *error); /* m, of a network its mesh's */
palp_status explain_predict(const palp_model *model, const palp_forward_run *run, double *force,
                            double *gradient, palp_error *error);

#endif
