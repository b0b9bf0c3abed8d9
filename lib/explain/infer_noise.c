/* infer_noise.c: one Kalman filter that makes the noise of a run white; the variance of its independent
 * part. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <string.h>

enum { S = INFER_STATES, ENCODER = INFER_SLOW };

/* The filter's numbers for a sample. row: derivative of the force by the states. */
typedef struct kept {
    double decay[S], gain[S], row[S], sd; /* sd: 0 without use */
} kept;

/* One step in time: the decay of each process, and the variance that it gains. */
typedef struct infer_step {
    double dt, decay[S], gained[S];
} infer_step;

static void make_step(const infer_noise *noise, double dt, infer_step *step) {
    step->dt = dt;
    for (int a = 0; a < INFER_SLOW; a++) {
        step->decay[a] = exp(-dt / noise->time[a]);
        step->gained[a] = -noise->slow[a] * noise->slow[a] * expm1(-2.0 * dt / noise->time[a]);
    }
}

/* Covariance of the processes after the step. */
static void predict(const infer_step *step, const double steady[INFER_SLOW], double p[S][S]) {
    for (int a = 0; a < S; a++)
        for (int b = 0; b < S; b++)
            p[a][b] *= step->decay[a] * step->decay[b];
    for (int a = 0; a < S; a++)
        p[a][a] += a == ENCODER ? step->gained[a] : step->gained[a] / steady[a];
}

/* The sample's gain and sd; p becomes the covariance after it. Returns the log of its variance. */
static double update(double variance, double p[S][S], kept *k) {
    double sum[S], s = variance;
    for (int a = 0; a < S; a++) {
        sum[a] = 0.0;
        for (int b = 0; b < S; b++)
            sum[a] += p[a][b] * k->row[b];
        s += sum[a] * k->row[a];
    }
    k->sd = sqrt(s);
    for (int a = 0; a < S; a++)
        k->gain[a] = sum[a] / s;
    for (int a = 0; a < S; a++)
        for (int b = 0; b < S; b++)
            p[a][b] -= sum[a] * k->gain[b];
    return log(s);
}

/* Gains, decays and sds of all samples; they depend on times and slopes alone. */
static double gains(const infer_noise *noise, size_t n, const double *time, const infer_sample *sample,
                    const double *variance, const unsigned char *use, kept *all) {
    const double encoder = noise->encoder * noise->encoder;
    double p[S][S] = {{0.0}}, log_det = 0.0;
    infer_step step = {.dt = 0.0};
    for (int a = 0; a < INFER_SLOW; a++)
        p[a][a] = noise->slow[a] * noise->slow[a];
    p[ENCODER][ENCODER] = encoder;
    for (size_t i = 0; i < n; i++) {
        kept *k = &all[i];
        if (i > 0 && time[i] - time[i - 1] != step.dt)
            make_step(noise, time[i] - time[i - 1], &step);
        step.decay[ENCODER] = sample[i].keep;
        step.gained[ENCODER] = encoder * (1.0 - sample[i].keep * sample[i].keep);
        if (i > 0)
            predict(&step, sample[i].steady, p);
        *k = (kept){.sd = 0.0};
        memcpy(k->decay, step.decay, sizeof step.decay);
        for (int a = 0; a < S; a++)
            k->row[a] = a == ENCODER ? sample[i].by_depth : 1.0;
        log_det += use[i] ? update(variance[i], p, k) : 0.0;
    }
    return log_det;
}

/* The two functions below are written for so many slow processes. */
typedef char infer_four_processes[INFER_SLOW == 4 ? 1 : -1];

/* One sample of all columns, y[count], and the states [S count] after it. Four states and the encoder's are
 * written out, so that a compiler takes several columns at once. */
static void whiten_sample(const kept *at, size_t count, double *restrict state, double *restrict y) {
    const double weight = at->sd > 0.0 ? 1.0 / at->sd : 0.0, *d = at->decay, *g = at->gain;
    const double d0 = d[0], d1 = d[1], d2 = d[2], d3 = d[3], d4 = d[ENCODER], row = at->row[ENCODER];
    const double g0 = g[0], g1 = g[1], g2 = g[2], g3 = g[3], g4 = g[ENCODER];
    double *restrict s0 = state, *restrict s1 = s0 + count, *restrict s2 = s1 + count,
                     *restrict s3 = s2 + count, *restrict s4 = s3 + count;
    for (size_t k = 0; k < count; k++) {
        const double a = s0[k] * d0, b = s1[k] * d1, c = s2[k] * d2, e = s3[k] * d3, f = s4[k] * d4;
        const double left = y[k] - ((a + b) + (c + e)) - f * row;
        s0[k] = a + g0 * left;
        s1[k] = b + g1 * left;
        s2[k] = c + g2 * left;
        s3[k] = e + g3 * left;
        s4[k] = f + g4 * left;
        y[k] = left * weight;
    }
}

/* Without an encoder's error. */
static void whiten_four(const kept *at, size_t count, double *restrict state, double *restrict y) {
    const double weight = at->sd > 0.0 ? 1.0 / at->sd : 0.0, *d = at->decay, *g = at->gain;
    const double d0 = d[0], d1 = d[1], d2 = d[2], d3 = d[3], g0 = g[0], g1 = g[1], g2 = g[2], g3 = g[3];
    double *restrict s0 = state, *restrict s1 = s0 + count, *restrict s2 = s1 + count,
                     *restrict s3 = s2 + count;
    for (size_t k = 0; k < count; k++) {
        const double a = s0[k] * d0, b = s1[k] * d1, c = s2[k] * d2, e = s3[k] * d3;
        const double left = y[k] - ((a + b) + (c + e));
        s0[k] = a + g0 * left;
        s1[k] = b + g1 * left;
        s2[k] = c + g2 * left;
        s3[k] = e + g3 * left;
        y[k] = left * weight;
    }
}

static void filter(const kept *all, bool encoder, size_t n, size_t count, double *state, double *x) {
    memset(state, 0, S * count * sizeof *state);
    for (size_t i = 0; i < n; i++)
        (encoder ? whiten_sample : whiten_four)(&all[i], count, state, x + i * count);
}

double infer_whiten(const infer_noise *noise, size_t n, const double *time, const infer_sample *sample,
                    const double *variance, const unsigned char *use, size_t count, double *x, double *work) {
    kept *all = (kept *)work;
    const double log_det = gains(noise, n, time, sample, variance, use, all);
    filter(all, noise->encoder > 0.0, n, count, work + n * INFER_FILTER, x);
    return log_det;
}

/* ---- backwards: the disturbance smoother (de Jong, J. Am. Stat. Assoc. 84 (1989) 1085) ---- */

/* v: information of the samples from this one on about each state, before the step back to the sample before.
 * Returns that about the independent noise of the sample. */
static double look_back(const kept *k, double v[S][S]) {
    double turned[S], square = k->sd > 0.0 ? 1.0 / (k->sd * k->sd) : 0.0;
    for (int a = 0; a < S; a++) {
        turned[a] = 0.0;
        for (int b = 0; b < S; b++)
            turned[a] += v[a][b] * k->gain[b];
        square += k->gain[a] * turned[a];
    }
    for (int a = 0; a < S && k->sd > 0.0; a++)
        for (int b = 0; b < S; b++)
            v[a][b] += square * k->row[a] * k->row[b] - k->row[a] * turned[b] - turned[a] * k->row[b];
    return square;
}

static void step_back(const kept *k, double v[S][S]) {
    for (int a = 0; a < S; a++)
        for (int b = 0; b < S; b++)
            v[a][b] *= k->decay[a] * k->decay[b];
}

/* One whitened sample of all columns, x[count], becomes the covariance's inverse times them; r[S count]: the
 * score of the states by the samples from this one on. */
static void pull_back(const kept *k, size_t count, double *restrict r, double *restrict x) {
    const double weight = k->sd > 0.0 ? 1.0 / k->sd : 0.0;
    for (size_t c = 0; c < count; c++)
        x[c] *= weight;
    for (int a = 0; a < S; a++)
        for (size_t c = 0; c < count; c++)
            x[c] -= k->gain[a] * r[(size_t)a * count + c];
    for (int a = 0; a < S; a++)
        for (size_t c = 0; c < count; c++)
            r[(size_t)a * count + c] += k->row[a] * x[c];
}

/* What the step to sample i adds to the variance of state a; the first sample has all of it. */
static double gained_by(const infer_noise *noise, size_t i, const infer_sample *sample, const kept *k,
                        int a) {
    const double size = a == ENCODER ? noise->encoder : noise->slow[a],
                 gained = size * size * (i > 0 ? 1.0 - k->decay[a] * k->decay[a] : 1.0);
    return a == ENCODER || i == 0 ? gained : gained / sample->steady[a];
}

void infer_unwhiten(const infer_noise *noise, size_t n, const infer_sample *sample, const double *work,
                    double *x, double *inverse, double *square) {
    const kept *all = (const kept *)work;
    double r[S] = {0.0}, v[S][S] = {{0.0}};
    for (size_t i = n; i-- > 0;) {
        inverse[i] = look_back(&all[i], v);
        pull_back(&all[i], 1, r, &x[i]);
        for (int a = 0; square && a < INFER_SLOW; a++) {
            const double steady = sample[i].steady[a], gained = gained_by(noise, i, &sample[i], &all[i], a);
            square[i * INFER_SLOW + (size_t)a] = (1.0 + gained * (r[a] * r[a] - v[a][a])) / steady;
        }
        for (int a = 0; a < S; a++)
            r[a] *= all[i].decay[a];
        step_back(&all[i], v);
    }
}

/* Derivatives of variances by half of each size's logarithm: of the independent noise, and of the states'
 * gain from sample i - 1 to i. */
static void find_parts(const infer_noise *noise, size_t i, const infer_sample *sample, const kept *k,
                       double part[INFER_NOISES]) {
    const double depth = sample->by_depth * noise->depth, clock = sample->by_time * noise->clock,
                 precision = sample->certain * sample->samples;
    part[INFER_BY_WHITE] = noise->white * noise->white / precision;
    part[INFER_BY_DEPTH] = depth * depth / precision;
    part[INFER_BY_CLOCK] = clock * clock / precision;
    for (int a = 0; a < S; a++)
        part[INFER_BY_SLOW + a] = gained_by(noise, i, sample, k, a);
}

/* The score of Koopman and Shephard, Biometrika 79 (1992) 823. */
void infer_noise_slope(const infer_noise *noise, size_t n, const infer_sample *sample, size_t count,
                       double *x, double *work, double *moved, double slope[INFER_NOISES],
                       double *information) {
    enum { N = INFER_NOISES };
    const kept *all = (const kept *)work;
    double *r = work + n * INFER_FILTER, v[S][S] = {{0.0}}, part[N], state[S] = {0.0};
    memset(r, 0, S * count * sizeof *r);
    for (size_t i = n; i-- > 0;) {
        const double square = look_back(&all[i], v);
        double *y = x + i * count, *to = moved + i * N;
        pull_back(&all[i], count, r, y);
        find_parts(noise, i, &sample[i], &all[i], part);
        const double more = dense_dot(count, y, y) - square;
        for (int a = 0; a < INFER_BY_SLOW; a++) {
            slope[a] += part[a] * more;
            to[a] = 2.0 * part[a] * y[count - 1];
        }
        for (int a = 0; a < S; a++) {
            double *pull = r + (size_t)a * count;
            slope[INFER_BY_SLOW + a] += part[INFER_BY_SLOW + a] * (dense_dot(count, pull, pull) - v[a][a]);
            to[INFER_BY_SLOW + a] = 2.0 * part[INFER_BY_SLOW + a] * pull[count - 1];
            for (size_t c = 0; c < count; c++)
                pull[c] *= all[i].decay[a];
        }
        step_back(&all[i], v);
    }
    for (size_t i = 0; i < n; i++)
        for (int a = 0; a < S; a++) {
            state[a] = (i > 0 ? all[i].decay[a] * state[a] : 0.0) + moved[i * N + INFER_BY_SLOW + (size_t)a];
            moved[i * N + INFER_BY_SLOW + (size_t)a] = all[i].row[a] * state[a];
        }
    filter(all, noise->encoder > 0.0, n, N, r, moved);
    dense_add_square(N, n, 0.5, moved, information);
}

void infer_variance(const infer_fit *fit, size_t n, const infer_sample *sample, double *variance) {
    const infer_noise *noise = &fit->noise;
    const double same = noise->white * noise->white + fit->converter * fit->converter / 12.0;
    for (size_t i = 0; i < n; i++) {
        const double depth = sample[i].by_depth * noise->depth, clock = sample[i].by_time * noise->clock;
        variance[i] = (same + depth * depth + clock * clock) / (sample[i].certain * sample[i].samples);
    }
}

/* A precision w has a gamma distribution of shape and rate freedom / 2; q of it, of shape (freedom + 1) / 2,
 * is the nearest to its posterior. The bound of the evidence has the expected log of the prior over q, less
 * the excess of the determinant with the expected precision: 0 for a normal distribution. */
double infer_tail_evidence(double freedom, double certain) {
    const double half = 0.5 * freedom, more = half + 0.5;
    return lgamma(more) - lgamma(half) - half * log(more / half) + more - 0.5 * log(more) +
           half * (log(certain) - certain);
}
