/* filter.c: zero-phase Butterworth low-pass, in second-order sections. */
#include <palpate/recording.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* One section, bilinear transform with prewarping, in place; starts in the steady state of x[0]. */
static void run_second_order_section(size_t n, double *x, double q, double tangent) {
    double a0 = 1.0 + tangent / q + tangent * tangent, b = tangent * tangent / a0;
    double a1 = 2.0 * (tangent * tangent - 1.0) / a0, a2 = (1.0 - tangent / q + tangent * tangent) / a0;
    double x1 = x[0], x2 = x[0], y1 = x[0], y2 = x[0];
    for (size_t i = 0; i < n; i++) {
        double y = b * (x[i] + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        x2 = x1;
        x1 = x[i];
        y2 = y1;
        y1 = x[i] = y;
    }
}

static void run_filter_sections(size_t n, double *x, int order, double tangent) {
    for (int k = 0; k < order / 2; k++)
        run_second_order_section(n, x, 0.5 / sin(PI * (2 * k + 1) / (2.0 * order)), tangent);
}

static void reverse_sample_order(size_t n, double *x) {
    for (size_t i = 0; i < n / 2; i++) {
        double t = x[i];
        x[i] = x[n - 1 - i];
        x[n - 1 - i] = t;
    }
}

palp_status palp_filter_zero_phase(size_t n, const double *in, double dt_s, int order, double cutoff_Hz,
                                   double *out) {
    if (!in || !out)
        return PALP_ERR_ARGUMENT;
    if (n == 0 || order < 2 || order > 8 || order % 2 || !(dt_s > 0.0) || !(cutoff_Hz > 0.0) ||
        !(cutoff_Hz * dt_s < 0.5))
        return PALP_ERR_ARGUMENT;
    double wanted = 3.0 / (cutoff_Hz * dt_s);
    size_t pad = wanted < (double)(n - 1) ? (size_t)wanted : n - 1, total = n + 2 * pad;
    double *x = malloc(total * sizeof *x);
    if (!x)
        return PALP_ERR_NO_MEMORY;
    memcpy(x + pad, in, n * sizeof *x);
    for (size_t i = 1; i <= pad; i++) {
        x[pad - i] = 2.0 * in[0] - in[i];
        x[pad + n - 1 + i] = 2.0 * in[n - 1] - in[n - 1 - i];
    }
    double tangent = tan(PI * cutoff_Hz * dt_s);
    for (int way = 0; way < 2; way++) {
        run_filter_sections(total, x, order, tangent);
        reverse_sample_order(total, x);
    }
    memcpy(out, x + pad, n * sizeof *out);
    free(x);
    return PALP_OK;
}
