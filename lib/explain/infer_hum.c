/* infer_hum.c: amplitude and frequency of the mains' line in a fit. */
#include "infer_search.h"
#include "explain_lines.h"
#include "base/statistics.h"

#include <math.h>

/* Variance of a run's amplitude along own, its direction in sine and cosine; and the run's information on the
 * frequency, s^2. With a free phase this is (2 pi amplitude)^2 over that variance times the variance of the
 * times (Rife and Boorstyn, IEEE Trans. Inf. Theory 20 (1974) 591). */
static double hum_variance(const explain_run *run, const double own[2], double sine, double cosine,
                           double both, double *frequency) {
    const double size = own[0] * own[0] + own[1] * own[1], turn = 2.0 * acos(-1.0);
    const double variance =
        (own[0] * own[0] * sine + own[1] * own[1] * cosine + 2.0 * own[0] * own[1] * both) / size;
    const double square = statistics_line_fit(run->n, run->time, run->time, NULL).sxx / (double)run->n;
    *frequency = turn * turn * size * square / variance;
    return variance;
}

palp_status infer_hum_measure(const infer_fit *fit, const explain_data *data, double *amplitude,
                              double *variance, double *information) {
    enum { B = INFER_BLOCK, S = INFER_SINE, C = INFER_COSINE };
    infer_posterior p;
    palp_status status = infer_posterior_find(fit, data, &p);
    const double n = (double)data->n_runs;
    *amplitude = *variance = *information = 0.0;
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        double own[B], v[B * B], frequency;
        status = infer_own(fit, data, &p, r, own, v);
        if (status || !(hypot(own[S], own[C]) > 0.0))
            continue;
        *amplitude += hypot(own[S], own[C]) / n;
        *variance +=
            hum_variance(&data->run[r], own + S, v[S * B + S], v[C * B + C], v[S * B + C], &frequency) /
            (n * n);
        *information += frequency;
    }
    infer_posterior_free(&p);
    return status;
}

palp_status infer_hum_cost(infer_fit *fit, const explain_data *data) {
    const double band = EXPLAIN_LINE_HIGHEST - EXPLAIN_LINE_LOWEST, turn = 2.0 * acos(-1.0);
    double amplitude, variance, information;
    palp_status status = infer_hum_measure(fit, data, &amplitude, &variance, &information);
    fit->c.hum_cost = status ? 0.0 : fmax(0.0, log(band * sqrt(information / turn)));
    return status;
}
