/* infer_noise.c: one Kalman filter that makes the noise of a run white. */
#include "infer_internal.h"

#include <math.h>
#include <string.h>

/* One step in time: how far each process decays, and the variance that it gains. */
typedef struct infer_step {
    double dt, decay[INFER_SLOW], gained[INFER_SLOW];
} infer_step;

static void make_step(const infer_noise *noise, double dt, infer_step *step) {
    step->dt = dt;
    for (int a = 0; a < INFER_SLOW; a++) {
        step->decay[a] = exp(-dt / noise->time[a]);
        step->gained[a] = -noise->slow[a] * noise->slow[a] * expm1(-2.0 * dt / noise->time[a]);
    }
}

/* Covariance of the processes after the step. */
static void predict(const infer_step *step, double p[INFER_SLOW][INFER_SLOW]) {
    for (int a = 0; a < INFER_SLOW; a++)
        for (int b = 0; b < INFER_SLOW; b++)
            p[a][b] *= step->decay[a] * step->decay[b];
    for (int a = 0; a < INFER_SLOW; a++)
        p[a][a] += step->gained[a];
}

/* Gains, decays and sds of all samples; they depend on the times alone. */
static double gains(const infer_noise *noise, size_t n, const double *time, const double *variance,
                    const unsigned char *use, double *work) {
    double p[INFER_SLOW][INFER_SLOW] = {{0.0}}, log_det = 0.0;
    infer_step step = {.dt = 0.0};
    for (int a = 0; a < INFER_SLOW; a++)
        p[a][a] = noise->slow[a] * noise->slow[a];
    for (size_t i = 0; i < n; i++) {
        double *decay = work + i * (2 * INFER_SLOW + 1), *gain = decay + INFER_SLOW, *sd = gain + INFER_SLOW;
        double sum[INFER_SLOW], s = variance[i];
        if (i > 0 && time[i] - time[i - 1] != step.dt)
            make_step(noise, time[i] - time[i - 1], &step);
        memcpy(decay, step.decay, sizeof step.decay);
        if (i > 0)
            predict(&step, p);
        for (int a = 0; a < INFER_SLOW; a++) {
            sum[a] = 0.0;
            for (int b = 0; b < INFER_SLOW; b++)
                sum[a] += p[a][b];
            s += sum[a];
        }
        *sd = use[i] ? sqrt(s) : 0.0;
        log_det += use[i] ? log(s) : 0.0;
        for (int a = 0; a < INFER_SLOW; a++)
            gain[a] = use[i] ? sum[a] / s : 0.0;
        for (int a = 0; a < INFER_SLOW && use[i]; a++)
            for (int b = 0; b < INFER_SLOW; b++)
                p[a][b] -= sum[a] * sum[b] / s;
    }
    return log_det;
}

/* One sample of all columns, y[count], and the states [INFER_SLOW count] after it; at: its decays, gains, sd.
 */
static void whiten_sample(const double *at, size_t count, double *state, double *y) {
    const double *gain = at + INFER_SLOW, sd = gain[INFER_SLOW], weight = sd > 0.0 ? 1.0 / sd : 0.0;
    for (size_t k = 0; k < count; k++) {
        double now[INFER_SLOW], left = y[k];
        for (size_t a = 0; a < INFER_SLOW; a++)
            left -= now[a] = state[a * count + k] * at[a];
        for (size_t a = 0; a < INFER_SLOW; a++)
            state[a * count + k] = now[a] + gain[a] * left;
        y[k] = left * weight;
    }
}

double infer_whiten(const infer_noise *noise, size_t n, const double *time, const double *variance,
                    const unsigned char *use, size_t count, double *x, double *work) {
    const double log_det = gains(noise, n, time, variance, use, work);
    double *state = work + n * (2 * INFER_SLOW + 1);
    memset(state, 0, INFER_SLOW * count * sizeof *state);
    for (size_t i = 0; i < n; i++)
        whiten_sample(work + i * (2 * INFER_SLOW + 1), count, state, x + i * count);
    return log_det;
}
