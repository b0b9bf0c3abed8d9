/* statistics.c: see statistics.h. */
#include "statistics.h"

#include <palpate/random.h>

#include <math.h>

double statistics_mean(const double *x, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += x[i];
    return sum / (double)n;
}

/* Hoare's quickselect; the pivot is the middle element, so that sorted and constant data are not slow. */
double statistics_kth(double *x, size_t n, size_t k) {
    ptrdiff_t low = 0, high = (ptrdiff_t)n - 1, wanted = (ptrdiff_t)k;
    while (low < high) {
        double pivot = x[low + (high - low) / 2];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (x[i] < pivot)
                i++;
            while (pivot < x[j])
                j--;
            if (i <= j) {
                double t = x[i];
                x[i++] = x[j];
                x[j--] = t;
            }
        }
        if (j < wanted)
            low = i;
        if (wanted < i)
            high = j;
    }
    return x[k];
}

double statistics_quantile(double *x, size_t n, double share) {
    return statistics_kth(x, n, (size_t)(share * (double)(n - 1)));
}

double statistics_median(double *x, size_t n) {
    return statistics_kth(x, n, n / 2);
}

statistics_line statistics_line_fit(size_t n, const double *x, const double *y, const unsigned char *use) {
    statistics_line line = {0};
    double sxy = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (use && !use[i])
            continue;
        line.n += 1.0;
        line.mean_x += x ? x[i] : (double)i;
        line.mean_y += y[i];
    }
    line.mean_x /= line.n;
    line.mean_y /= line.n;
    for (size_t i = 0; i < n; i++) {
        double off = (x ? x[i] : (double)i) - line.mean_x;
        if (use && !use[i])
            continue;
        line.sxx += off * off;
        sxy += off * (y[i] - line.mean_y);
    }
    line.slope = line.sxx > 0.0 ? sxy / line.sxx : 0.0;
    return line;
}

/* Distribution function of chi squared: closed form for 1 and 2 degrees of freedom, otherwise by
 * recursion. */
static double chi_squared_probability(size_t freedom, double x) {
    size_t k = freedom % 2 ? 1 : 2;
    double below = k == 1 ? erf(sqrt(0.5 * x)) : -expm1(-0.5 * x);
    double term = exp(-0.5 * x) * (k == 1 ? 1.1283791670955126 * sqrt(0.5 * x) : 0.5 * x); /* 2 / sqrt(pi) */
    for (; k < freedom; k += 2) {
        below -= term;
        term *= x / (double)(k + 2);
    }
    return below;
}

/* Quantile of the normal distribution, for a share of at least a half, to 5e-4 (Abramowitz and Stegun
 * 26.2.23). */
static double normal_quantile(double share) {
    double t = sqrt(-2.0 * log(1.0 - share));
    return t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                   (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

/* Many degrees of freedom: Wilson and Hilferty, to 1e-4, as the sum would be slow and underflow. */
double statistics_chi2_quantile(size_t freedom, double share) {
    enum { MANY = 100 };
    if (freedom > MANY) {
        double normal = share < 0.5 ? -normal_quantile(1.0 - share) : normal_quantile(share);
        double spread = 2.0 / (9.0 * (double)freedom);
        return (double)freedom * pow(1.0 - spread + normal * sqrt(spread), 3.0);
    }
    double low = 0.0, high = (double)freedom + 40.0 + 20.0 * sqrt((double)freedom);
    for (int i = 0; i < 200 && high > low; i++) {
        double middle = 0.5 * (low + high);
        if (middle > 0.0 && chi_squared_probability(freedom, middle) < share)
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* Probability within x, by the sums for odd and even degrees of freedom (Abramowitz and Stegun, 26.7.3 and
 * 26.7.4). */
static double student_within(size_t freedom, double x) {
    double angle = atan(x / sqrt((double)freedom)), c = cos(angle), s = sin(angle), term = 1.0, sum = 0.0;
    if (freedom % 2) {
        for (size_t k = 3; k <= freedom; k += 2) {
            sum += term;
            term *= c * c * (double)(k - 1) / (double)k;
        }
        return 2.0 / 3.14159265358979323846 * (angle + s * c * sum);
    }
    for (size_t k = 2; k <= freedom; k += 2) {
        sum += term;
        term *= c * c * (double)(k - 1) / (double)k;
    }
    return s * sum;
}

double palp_student_95(size_t freedom) {
    if (freedom == 0)
        return HUGE_VAL;
    double low = 1.9, high = 13.0;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (student_within(freedom, middle) < 0.95)
            low = middle;
        else
            high = middle;
    }
    return high;
}

double statistics_student_widening(size_t freedom) {
    return palp_student_95(freedom) / 1.959963984540054;
}
