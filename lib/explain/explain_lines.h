/* explain_lines.h: spectral lines of the residual. residual[data->n] holds all runs one after the other.
 * Internal. */
#ifndef EXPLAIN_LINES_H
#define EXPLAIN_LINES_H

#include "explain_data.h"

enum {
    EXPLAIN_FREQUENCIES = 601, /* tried for the mains' line */
    EXPLAIN_PERIODS = 3        /* within the travel: with fewer it is no wave */
};

/* Whether the runs are sampled fast and long enough to show the mains. */
bool explain_line_visible(const explain_data *data);

enum { EXPLAIN_LINE_LOWEST = 40, EXPLAIN_LINE_HIGHEST = 70 }; /* band of the mains, Hz */

/* Whether they are long enough to resolve one line within the mains' band. In shorter ones a line is as wide
 * as the band. */
bool explain_line_resolved(const explain_data *data);

/* Strongest line of a residual over time, 40 to 70 Hz, and over depth. ERR_UNSUPPORTED: there is none; it is
 * next to what is stronger outside; or it could stand out and does not. */
palp_status explain_line_in_time(const explain_data *data, const double *residual, double *frequency,
                                 double *amplitude);
palp_status explain_line_in_depth(const explain_data *data, const double *residual, double *period,
                                  double *amplitude, double *phase);

/* The strongest lines at any frequency, and over depth. */
palp_status explain_peak_in_time(const explain_data *data, const double *residual, palp_explain_peak *peak);
palp_status explain_peak_in_depth(const explain_data *data, const double *residual, palp_explain_peak *peak);

#endif
