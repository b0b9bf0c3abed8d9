/* explain_result.h: the search's result in the caller's form. Internal. */
#ifndef EXPLAIN_RESULT_H
#define EXPLAIN_RESULT_H

#include "explain_data.h"

/* ---- runs and shares (explain_result.c) ---- */

palp_status explain_copy_runs(const explain_data *data, palp_explanation *e);
void explain_keep_residual(const double *residual, palp_explanation *e, bool before);

/* The candidate of an effect; NULL: it is none. */
palp_explain_candidate *explain_candidate_of(palp_explanation *e, palp_effect_id id);

void explain_phase_shares(const explain_data *data, palp_explanation *e, double noise_level_N);

/* ---- what to run next (explain_next.c) ---- */

enum { EXPLAIN_PROTOCOLS = 96, EXPLAIN_PATH = 512 };

/* A run that the indenter can do. */
typedef struct explain_protocol {
    bool air;              /* the plate goes up instead of down, and touches nothing */
    size_t cycles;         /* 0: a ramp and hold */
    double depth, rate;    /* m, m/s */
    double hold, duration; /* s */
} explain_protocol;

/* Its samples. Each stands for some of those that would be recorded. */
typedef struct explain_path {
    size_t n;
    double time[EXPLAIN_PATH], depth[EXPLAIN_PATH], samples[EXPLAIN_PATH];
} explain_path;

/* The limits, with those of the runs in place of 0. */
palp_explain_limits explain_limits_find(const palp_explain_limits *given, const explain_data *data);
/* The runs to choose from, list[EXPLAIN_PROTOCOLS]: all kinds, with depth, speed and time from the limits
 * down, by factors of 2 and 4. Returns how many. */
size_t explain_protocols_list(const palp_explain_limits *limits, explain_protocol *list);
/* At most this many samples of its path (at least 16), none nearer than those of the data. */
void explain_path_find(const explain_protocol *protocol, const explain_data *data, size_t most,
                       explain_path *path);
palp_explain_next_run explain_next_run_of(const explain_protocol *protocol);
/* The rms difference of two forces along a path, after a fit of the run's zero and gain. */
double explain_separation(const explain_path *p, const double *a, const double *b);

/* ---- diagnostics (explain_diagnostics.c) ---- */

/* Of the residual; slips become events. */
palp_status explain_diagnostics_find(explain_data *data, const double *residual, palp_explanation *e);

#endif
