/* explain.h: find the effects that a model misses in measured runs, from the catalogue of effects, and add
 * them. One likelihood decides (doc/likelihood.md), which includes the model's misfit. doc/explain.md has the
 * procedure and its limits. May change. */
#ifndef PALPATE_EXPLAIN_H
#define PALPATE_EXPLAIN_H

#include <palpate/characterize.h>
#include <palpate/experiment.h>
#include <palpate/forward.h>
#include <palpate/recording.h>
#include <palpate/segments.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PALP_EXPLAIN_EFFECTS = 6,
    PALP_EXPLAIN_PHASE_SHARES = 64,
    PALP_EXPLAIN_REASON = 160,
    PALP_EXPLAIN_NEXT_RUNS = 4
};

/* Runs task(work, i) for all i < n, in any order, also at once; returns after the last. */
typedef void palp_explain_loop(void *user, size_t n, void (*task)(void *work, size_t i), void *work);

/* Limits of the next experiment; 0: those of the recorded runs. */
typedef struct palp_explain_limits {
    double depth_m, rate_m_s; /* deepest place and fastest motion of the plate */
    double time_s;            /* of the whole experiment; 0: as long as the session so far */
    double rest_s;            /* before each of its runs; 0: the mean pause between the runs */
} palp_explain_limits;

/* A run; the experiment is only read. */
typedef struct palp_explain_input {
    const palp_experiment *experiment;
    const char *name; /* the file's, for messages */
} palp_explain_input;

typedef struct palp_explain_settings {
    size_t max_effects;        /* 4; at most PALP_EXPLAIN_EFFECTS */
    double false_alarm;        /* 0.05: chance that any effect is named where nothing is missing */
    double good_enough;        /* 0: the practical limit, of the largest force; smaller effects are not
                                  named */
    palp_contact_form contact; /* FREE; KNOWN: every recorded contact is exact; COMMON: all are off by the
                                  same, if at all */
    unsigned char candidate[PALP_EFFECT_COUNT]; /* 1 = a candidate; all of them */
    palp_explain_limits next;                   /* of the next experiment; all 0 */
    size_t n_held_out;                          /* runs kept out of the fit; 0 = each in turn */
    const size_t *held_out;                     /* [n_held_out] indices, caller's */
    const palp_explain_input *simulated; /* NULL, or for each run the forces that another program computed
                                            along its path, for palp_explain; experiment NULL: none for this
                                            run */
    palp_explain_loop *loop;             /* NULL = one after the other; the result is the same */
    void *loop_user;
    void (*progress)(void *user, double share); /* NULL, or called when a further share of the work is done; 1
                                                   in all. The loop's threads call it too, several at once */
    void *progress_user;
    bool (*stop)(void *user); /* NULL, or asked before each candidate, by the loop's threads too: true ends
                                 the search, and the result so far is returned */
    void *stop_user;
} palp_explain_settings;

PALP_API palp_explain_settings palp_explain_settings_default(void);

/* What a run presses: by its file's specimen.kind ("none" is air, "rigid" a block), or else by its force
 * relative to the others'. */
typedef enum palp_explain_object {
    PALP_EXPLAIN_SPECIMEN,
    PALP_EXPLAIN_AIR,  /* it presses nothing, however deep it goes */
    PALP_EXPLAIN_BLOCK /* it gives the frame's compliance, and is not fitted */
} palp_explain_object;

typedef struct palp_explain_pressed {
    palp_explain_object object;
    bool declared; /* by the file. Air that is not declared is an assumption: a dead sensor with noise looks
                      the same */
} palp_explain_pressed;

PALP_API const char *palp_explain_object_name(palp_explain_object object); /* "specimen", "air", "block" */

typedef enum palp_explain_verdict {
    PALP_EXPLAIN_AGREES,      /* nothing is missing that these runs could show */
    PALP_EXPLAIN_EXPLAINED,   /* with the effects the residual is at the noise level */
    PALP_EXPLAIN_AMBIGUOUS,   /* likewise, but another effect fits as well */
    PALP_EXPLAIN_UNEXPLAINED, /* a residual remains that no effect of the catalogue describes */
    PALP_EXPLAIN_SUSPECTED,   /* effects are more probable than not, but below the threshold, or not
                                 confirmed */
    PALP_EXPLAIN_ANOTHER_LAW  /* no effect is missing, but the law or the drive of the arms is another one */
} palp_explain_verdict;

PALP_API const char *palp_explain_verdict_name(palp_explain_verdict verdict); /* "agrees", ... */

/* An accepted effect. Intervals are 95 %. */
typedef struct palp_explain_effect {
    palp_effect effect;
    double low[PALP_EFFECT_PARAMETERS], high[PALP_EFFECT_PARAMETERS];
    size_t n_class; /* effects that fit as well, itself first */
    palp_effect_id alike[PALP_EFFECT_COUNT];
    double evidence;    /* gain in held-out log score, nats */
    double evidence_se; /* its paired standard error over the experiments */
    double gap_closed;  /* share of the squared gap above the noise level */
    bool recovers;      /* the runs of one session show it, but each as on a new specimen */
} palp_explain_effect;

/* N, rms over the samples: before, by the model as given with one contact and one gain for all runs; after,
 * with the effects and the parameters of each run. */
typedef struct palp_explain_gap {
    double noise_level_N, before_N, after_N, heldout_before_N, heldout_after_N, closed;
} palp_explain_gap;

/* What differs from run to run: each run's own zero, contact or gain. */
typedef struct palp_explain_scatter {
    double sd;        /* of the zeros about their mean, N; of the contacts, m; of the gains, a share; as
                         fitted */
    double without_N; /* rms residual if all runs have the same; gap.after_N is that with the scatter */
    double evidence;  /* in log likelihood, nats */
    bool found;       /* it is distinguishable from noise */
} palp_explain_scatter;

/* Whether another family of stiffness laws is needed, or quasi-linear arms (driven by the elastic force) in
 * place of linear ones, or the reverse. model then has it, base the given one. */
typedef struct palp_explain_law {
    bool found;
    double without_N; /* rms residual with the given law and the same effects; gap.after_N is that with the
                         other law */
    double evidence;  /* in log likelihood, less the cost of its coefficients, nats */
} palp_explain_law;

/* The part of the force that no term of the model describes, by the variable that it depends on: rms over the
 * samples, N. */
typedef struct palp_explain_discrepancy {
    bool found;                    /* it is distinguishable from zero, and beyond the practical limit */
    double evidence;               /* nats */
    double loading_N, unloading_N; /* on the depth, on the way in and on the way out */
    double dwell_N;                /* on the time in a dwell */
    double correlated_N;           /* on the time in the run: correlated noise */
} palp_explain_discrepancy;

/* Terms of the written model beyond the catalogue: the last n terms of model.free_term. */
typedef struct palp_explain_free {
    size_t n;
    double evidence[PALP_FREE_TERMS]; /* that all runs share it, nats */
    double rms_N[PALP_FREE_TERMS];
    palp_effect_id resembles; /* the effect that the first one is nearest to; PALP_EFFECT_COUNT: none */
    double heldout_before_N, heldout_after_N; /* rms of runs left out, without and with the terms; 0: none */
    double noise_level_N;                     /* beside the terms */
    double closed;                            /* share of heldout_before_N above that noise */
    double after_N;                           /* residual of the model with them, as gap.after_N */
    double scale_N;                           /* r.m.s. of the forces */
    /* The likelihood of the table of each, all else integrated out: precision, and precision times the best
     * table. */
    double information[PALP_FREE_TERMS][PALP_FREE_NODES * PALP_FREE_NODES],
        pull[PALP_FREE_TERMS][PALP_FREE_NODES];
} palp_explain_free;

/* How the specimens differ that the files name. If found, the model has it as the spread between
 * specimens. */
typedef struct palp_explain_specimens {
    size_t n; /* that the files name; 0 or 1: nothing can be said */
    bool found;
    double sd;        /* of their stiffness, as a share */
    double low, high; /* its interval of 95 %, from the likelihood; 0 = not known */
    bool law;         /* of the law alone; else one factor scales the whole force of a specimen */
    double without_N; /* rms residual if they are alike; gap.after_N is that with the spread */
    double evidence;  /* in log likelihood, nats */
    double *between;  /* what the model's points to */
} palp_explain_specimens;

typedef struct palp_explain_phase_share {
    size_t run;
    palp_phase phase;
    double share;     /* of the squared gap, before */
    double remaining; /* likewise of the residual there with the effects, relative to the same gap */
    /* of the residual there, for white noise 0 and within +-2: correlation from sample to sample; too few (-)
     * or too many runs of one sign, in standard deviations */
    double lag1, runs_z;
} palp_explain_phase_share;

/* A line in the spectrum of the residual. */
typedef struct palp_explain_peak {
    double at, amplitude_N; /* Hz, or m of depth from crest to crest; 0 = none */
    double prominence;      /* its power over the median of all frequencies */
} palp_explain_peak;

/* Diagnostics of the residual with the effects: its strongest lines, and the rms that free smooth curves
 * would remove. That is the most that an unknown effect of depth, of time within a run or of speed could
 * explain. */
typedef struct palp_explain_diagnostics {
    palp_explain_peak in_time, in_depth;
    double by_depth_N, by_time_N, by_rate_N;
} palp_explain_diagnostics;

typedef struct palp_explain_event {
    size_t run, samples;
    double from_s, to_s, size_N;
    const char *kind; /* "spike", "release", "slip" (the residual steps and stays) */
} palp_explain_event;

/* A candidate and its result. */
typedef struct palp_explain_candidate {
    palp_effect_id id;
    bool identifiable; /* share is a half at least, and the runs have all that it needs */
    double share; /* reduction of the prior variance of its strength by the runs, conditional on the effects
                     found */
    bool accepted;
    bool unconfirmed;                 /* it exceeds the threshold, but in one run only */
    double score;                     /* log odds of its fit over the one without it, nats */
    double explained_N;               /* rms that it alone would explain */
    char reason[PALP_EXPLAIN_REASON]; /* why it was rejected */
} palp_explain_candidate;

/* A step of the search: every candidate conditional on the effects accepted before, and the one that was
 * taken. Two effects that were taken at once have a step each, with the same scores. */
typedef struct palp_explain_step {
    palp_effect_id taken; /* PALP_EFFECT_COUNT: none */
    size_t n_candidates;
    palp_explain_candidate candidate[PALP_EFFECT_COUNT];
} palp_explain_step;

/* One run as it was used, for figures. */
typedef struct palp_explain_run {
    char name[PALP_NAME_MAX];
    size_t n;
    double *time_s, *depth_m, *force_N; /* [n] as recorded */
    double *before_N, *after_N; /* [n] recorded minus the refitted model: as given, with the effects */
    double stiffness; /* its specimen's stiffness over the model's; 1 where specimens do not differ */
} palp_explain_run;

/* A run of the next experiment. */
typedef struct palp_explain_next_run {
    const char *kind; /* as in a protocol file: "ramp_hold", "cyclic" or "free" */
    double depth_mm, rate_mm_s, hold_s;
    size_t cycles;
    double time_s; /* how long it takes */
} palp_explain_next_run;

/* The experiment within the limits that has the largest expected information on which effect of an
 * equivalence class is the true one. */
typedef struct palp_explain_next {
    bool wanted;
    size_t n_runs; /* 0: no run has information */
    palp_explain_next_run run[PALP_EXPLAIN_NEXT_RUNS];
    palp_effect_id between[2]; /* the accepted effect, and the most probable other one */
    double separation_N;       /* expected rms difference of these two in the first run */
    double nats;               /* expected log odds between these two, whichever is true */
    double information;        /* lower bound of the share of the uncertainty about the class that it
                                  removes */
    double time_s;             /* with the rests, */
    double rest_s;             /* each before a run */
} palp_explain_next;

/* The result; palp_explanation_free. */
typedef struct palp_explanation {
    palp_explain_verdict verdict;
    bool simulated;         /* the forces of another program took the place of a model's, */
    double simulated_off_N; /* and the lumped model that gives their slopes is off by so much, rms */
    bool stopped;           /* by settings.stop: some candidates were not tried */
    palp_model base, model; /* refitted as given, and with the effects; their mesh is the given model's */
    size_t n_effects;
    palp_explain_effect effect[PALP_EXPLAIN_EFFECTS];
    palp_explain_gap gap;
    double white_N, correlated_N, correlation_s; /* the noise level's parts */
    palp_explain_scatter zero, contact, gain;
    palp_explain_law law;
    palp_explain_discrepancy discrepancy;
    palp_explain_free free;
    palp_explain_specimens specimens;
    bool replicates;       /* some runs have the same path */
    double null_threshold; /* threshold of a candidate's score, nats */
    double unexplained_N;  /* rms of the structure that remains above the noise level */
    size_t n_phase_shares, n_events, n_candidates, n_runs;
    palp_explain_phase_share phase_share[PALP_EXPLAIN_PHASE_SHARES];
    palp_explain_event *event;
    palp_explain_candidate candidate[PALP_EFFECT_COUNT]; /* added to the model as given */
    size_t n_steps;
    palp_explain_step *step; /* [n_steps] */
    palp_explain_diagnostics diagnostics;
    palp_explain_next next;
    palp_explain_run *run; /* [n_runs] */
    size_t n_inputs;
    palp_explain_pressed *pressed; /* [n_inputs] in the order in which the runs were given */
} palp_explanation;

PALP_API void palp_explanation_free(palp_explanation *explanation); /* NULL is fine */

/* With settings->simulated, and model NULL, each run of the specimen has a simulated one: the force is that
 * of the other program, and nothing of its material is fitted. A lumped model fitted to the simulated forces
 * (palp_explain_material) gives their change: F = simulated + model with the effects along the recorded path
 * - model without them along the simulated one. Its error matters in proportion to the effects. base and
 * model are that lumped model. ERR_INPUT with a line where paths differ too much: the error could change the
 * log evidence by the threshold of settings->false_alarm. ERR_ARGUMENT: a model and simulated runs;
 * ERR_UNSUPPORTED: a simulated run that continues in another file. The model's law becomes a spline of 31
 * knots with estimated smoothness; base has the nearest law of the given family. evidence_se is paired over
 * the runs left out in turn, or over each eighth of a single run. Effects that do not improve their
 * prediction are not accepted. ERR_INPUT with a line for runs that cannot be used; ERR_UNSUPPORTED: a network
 * with mass, or a model that is not PALP_HISTORY; ERR_LIMIT: the model has too many effects already. */
PALP_API palp_status palp_explain(const palp_model *model, size_t n, const palp_explain_input *inputs,
                                  const palp_explain_settings *settings, palp_explanation *explanation,
                                  palp_error *error);

/* The frame's compliance from runs on a rigid block, with a 95 % interval, m/N. ERR_INPUT with the run's name
 * where its samples are not usable, or it does not press. */
typedef struct palp_frame {
    double compliance_m_N, low_m_N, high_m_N;
} palp_frame;

PALP_API palp_status palp_explain_frame(size_t n, const palp_explain_input *runs, palp_frame *frame,
                                        palp_error *error);

/* What palp_explain_material may choose from. Zero-initialised: a spline of 31 knots, no arms. */
typedef struct palp_explain_choice {
    size_t least_arms, most_arms; /* the most is at most PALP_ARMS_MAX */
    size_t n_laws;                /* laws that compete with the spline of 31 knots */
    const palp_law *law; /* [n_laws] the caller's: kind, size, knots and area; coefficients: first guess */
    double *log_odds;  /* [n_laws] the caller's, or NULL: of the spline over each law's nearest, nats; 0 for a
                          spline of fewer knots */
    bool no_spline;    /* the spline does not compete: one of the laws is taken */
    size_t per_decade; /* 0, or so many arms a decade at fixed times, from four samples to three times the
                          longest run. Arms that the runs do not show are removed. The numbers of arms above
                          do not count */
    bool dwell_only;   /* of runs with a dwell, its samples alone are fitted */
} palp_explain_choice;

/* The lumped solid of runs by the same likelihood, without effects, gains and discrepancy. The evidence of
 * each arm exceeds the threshold of settings->false_alarm. Arms are driven by the strain or by the elastic
 * force (quasi-linear). The law is that of the largest evidence. If fewer arms or only less probable laws are
 * allowed, all that the model misses is white noise. specimen: height and radius, to which all runs are
 * scaled by the sizes in their files, and known effects; its material is not read. fit, the caller's to free:
 * of mean, arrays over runs are in the order of inputs, and contact_m is from recorded depth 0. Specimens are
 * numbered in the order of their first inputs (specimen.name); with one, fit has the mean alone. n_spread is
 * 1 if they differ: by a factor on all stiffnesses, one on all times, and one on the law alone. settings:
 * false_alarm, contact, loop, progress, stop. ERR_ARGUMENT: no runs, arms out of range, no_spline without a
 * law; ERR_LIMIT: more than PALP_ARMS_MAX at fixed times; errors of palp_explain. */
PALP_API palp_status palp_explain_material(const palp_model *specimen, size_t n,
                                           const palp_explain_input *inputs,
                                           const palp_explain_settings *settings,
                                           const palp_explain_choice *choice, palp_specimens_fit *fit,
                                           palp_error *error);

/* palp_explain_material of recordings, all of one height and radius (palp_recording_scale makes them so), as
 * palpate characterize has it. Samples are taken in blocks, whose length follows from the noise. Units of the
 * recordings change nothing but the units of the result. specimen[n]: of each, numbered from 0 without a gap;
 * NULL: one. rms_N and absolute_N of the mean are of all samples. ERR_ARGUMENT too: other sizes. */
PALP_API palp_status palp_explain_recordings(size_t n, const palp_recording *recordings,
                                             const size_t *specimen, const palp_explain_settings *settings,
                                             const palp_explain_choice *choice, palp_specimens_fit *fit,
                                             palp_error *error);

/* A form of shape p over x. x is the variable of a term, relative to its largest value on the grid. */
typedef enum palp_formula_form {
    PALP_FORM_POWER,       /* |x|^p, with the sign of x */
    PALP_FORM_EXPONENTIAL, /* exp(-|x| / p), with the sign of x where x has both */
    PALP_FORM_HINGE,       /* max(0, |x| - p), with the sign of x */
    PALP_FORM_SATURATION,  /* x / (|x| + p) */
    PALP_FORMS
} palp_formula_form;

enum { PALP_FORMULA_PARTS = 3 };

/* A form times a force in N. Intervals are 95 %. */
typedef struct palp_formula_part {
    palp_formula_form form;
    double force_N, force_low_N, force_high_N, shape, shape_low, shape_high;
} palp_formula_part;

/* A sum of few forms. */
typedef struct palp_formula {
    size_t n;     /* 0: no sum of these forms is more probable than zero force */
    double scale; /* largest value of the term's variable: strain, s, m/s or m */
    palp_formula_part part[PALP_FORMULA_PARTS];
    double evidence;      /* over zero force, nats */
    double evidence_over; /* over the best formula with another last part; HUGE_VAL: there is none */
} palp_formula;

PALP_API const char *palp_formula_form_name(palp_formula_form form); /* "power", ... */

/* The most probable sparse sum for a term: parts are added as long as one gains more than the threshold of
 * false_alarm, less the logarithm of the number of forms. The prior of a force is normal with the sd scale_N,
 * that of a shape uniform over its grid. information, pull: as palp_explain_free has them. ERR_ARGUMENT: no
 * term, or false_alarm not between 0 and 1. */
PALP_API palp_status palp_formula_find(const palp_free_term *term, const double *information,
                                       const double *pull, double scale_N, double false_alarm,
                                       palp_formula *formula);

/* Its force in N at a value of the term's variable, in SI units. */
PALP_API double palp_formula_force(const palp_formula *formula, double at);

#ifdef __cplusplus
}
#endif
#endif
