/* statistics.h: means, order statistics, quantiles of Student's t and chi squared, straight lines. Internal.
 */
#ifndef PALP_STATISTICS_H
#define PALP_STATISTICS_H

#include <stddef.h>

double statistics_mean(const double *x, size_t n); /* n > 0 */

/* The k-th smallest, from 0, of n > k numbers. Reorders x: x[0..k] are then the k + 1 smallest. */
double statistics_kth(double *x, size_t n, size_t k);

/* The quantile of n > 0 numbers below which this share lies, and the upper median. Both reorder x. */
double statistics_quantile(double *x, size_t n, double share);
double statistics_median(double *x, size_t n);

/* Width of an interval by Student's t over that of a normal one. Quantile of chi squared, below which the
 * share lies. freedom > 0. */
double statistics_student_widening(size_t freedom);
double statistics_chi2_quantile(size_t freedom, double share);

/* The least-squares line y = mean_y + slope (x - mean_x). */
typedef struct statistics_line {
    double n, mean_x, mean_y, slope; /* slope is 0 if all x are equal */
    double sxx;                      /* sum of (x - mean_x)^2 */
} statistics_line;

/* Fits n points; x NULL = 0, 1, 2 ...; only those with use[i], unless use is NULL. */
statistics_line statistics_line_fit(size_t n, const double *x, const double *y, const unsigned char *use);

#endif
