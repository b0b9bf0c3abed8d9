/* plot_runs.h: the figures of recordings, and of fits to them. */
#ifndef PALPATE_PLOT_RUNS_H
#define PALPATE_PLOT_RUNS_H

#include "plot.h"

#include <palpate/recording.h>

/* Facts of a recording before any fit, as in the results of characterize and report. */
json_t *run_json(const palp_recording *recording);

/* A zero-phase Butterworth filter of this order, forward and backward. */
enum { RUN_FILTER_ORDER = 4 };

/* A recording as it is drawn. */
typedef struct run_curve {
    const palp_recording *recording;
    double *filtered_N, *fit_N; /* [recording->n]; NULL = none */
    const double *band_N;       /* [2 n] the lowest, then the highest force of the fit; NULL = none */
} run_curve;

/* Whether a stands before b in tables and keys: ramps without a dwell, ramps and holds by depth, then others.
 */
bool run_before(const palp_recording *a, const palp_recording *b);

typedef enum plot_time { PLOT_TIME_LINEAR, PLOT_TIME_LOG, PLOT_TIME_FIRST } plot_time;

/* The figures recordings_linear, recordings_log and recordings_first. */
void plot_runs_recorded(json_t *figures, size_t n, const run_curve *run);

/* fit_linear, fit_log and fit_first, then fit_depth and residuals. */
void plot_runs_fitted(json_t *figures, size_t n, const run_curve *run);

/* Force against time from the start of the ramp: raw in a light tint, and over it the fit if fit, else
 * the filtered curve. PLOT_TIME_FIRST: the first 10 s. */
void plot_runs_time(json_t *figures, const char *name, const char *title, size_t n, const run_curve *run,
                    plot_time time, bool fit);

/* Force against depth, likewise. */
void plot_runs_depth(json_t *figures, const char *name, const char *title, size_t n, const run_curve *run,
                     bool fit);

/* The low-passed force of each stretch between gaps, malloc'ed; NULL where the samples are not even, the
 * cut-off is beyond them, or there is no memory. */
double *run_filter(const palp_recording *recording, double cutoff_Hz);

/* The cut-off for figures if none is asked for: 10 Hz, or a fifth of the sampling rate. */
double run_cutoff_Hz(const palp_recording *recording);
double run_rate_Hz(const palp_recording *recording); /* samples a second */

#endif
