/* statistics.c: see statistics.h. */
#include "statistics.h"

double statistics_mean(const double *x, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += x[i];
    return sum / (double)n;
}

/* Hoare's quickselect; the middle as pivot, so that sorted and constant data are no worse than others. */
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
