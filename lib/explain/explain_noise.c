/* explain_noise.c: the noise of the runs: white from sample to sample, correlated in stretches that stand
 * still. */
#include "explain_noise.h"
#include "base/dense.h"
#include "base/statistics.h"
#include "data/segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The filter of white + exponentially correlated noise (a scalar Kalman filter): its innovations are white.
 */
static double make_filter(const explain_run *run, double white, double correlated, double correlation_time,
                          size_t from, size_t to, double *keep, double *take, double *weight) {
    double variance = correlated * correlated, p = variance, noise = white * white, logdet = 0.0;
    for (size_t i = from; i < to; i++) {
        double fade = i > from ? exp(-(run->time[i] - run->time[i - 1]) / correlation_time) : 0.0;
        p = i > from ? fade * fade * p + variance * (1.0 - fade * fade) : variance;
        keep[i] = fade;
        take[i] = 0.0;
        weight[i] = 0.0;
        if (!run->use[i])
            continue;
        double s = p + noise;
        take[i] = p / s;
        weight[i] = 1.0 / sqrt(s);
        p *= noise / s;
        logdet += log(s);
    }
    return logdet;
}

static void filter(size_t from, size_t to, const double *keep, const double *take, const double *weight,
                   double *x) {
    double state = 0.0;
    for (size_t i = from; i < to; i++) {
        state *= keep[i];
        double innovation = x[i] - state;
        state += take[i] * innovation;
        x[i] = innovation * weight[i];
    }
}

/* Four at a time, as each step of one waits for the step before. */
static void whiten_four(const explain_run *run, double *x) {
    const size_t n = run->n;
    double state[4] = {0.0};
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            state[k] *= run->keep[i];
            double innovation = x[k * n + i] - state[k];
            state[k] += run->take[i] * innovation;
            x[k * n + i] = innovation * run->weight[i];
        }
}

void explain_whiten(const explain_run *run, size_t count, double *x) {
    size_t k = 0;
    for (; k + 4 <= count; k += 4)
        whiten_four(run, x + k * run->n);
    for (; k < count; k++)
        filter(0, run->n, run->keep, run->take, run->weight, x + k * run->n);
}

/* ---- correlated noise ---- */

enum { TREND = 3, PIECES_MAX = 4096 };
static const double LEAST_WHITE = 0.01; /* of the variance that neighbours show: the filter needs some */

typedef struct piece {
    size_t run, from, to;
} piece;

/* Stretches without motion, of some 60 to 600 samples, a while after it ended. */
static size_t find_pieces(const explain_data *data, piece *list) {
    enum { LEAST = 30 };
    const double after = 15.0 * data->step, shortest = 60.0 * data->step, longest = 600.0 * data->step;
    size_t count = 0;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        for (size_t i = 0; i < run->n && !run->held_out;) {
            size_t end = segments_still_end(run->n, run->depth, i, 2e-5 * data->deepest);
            double start = run->time[i];
            size_t from = i;
            while (from < end && run->time[from] < start + after && i)
                from++;
            while (from < end) {
                size_t to = from + 1;
                double length = fmin(longest, fmax(shortest, 2.0 * (run->time[from] - start)));
                while (to < end && run->time[to] < run->time[from] + length)
                    to++;
                if (to - from >= LEAST && run->time[to - 1] - run->time[from] > 0.45 * shortest &&
                    count < PIECES_MAX)
                    list[count++] = (piece){r, from, to};
                from = to;
            }
            i = end;
        }
    }
    return count;
}

/* Correlated noise, in units of what differs from sample to sample; white: what of that it leaves for white
 * noise. */
typedef struct mixture {
    double share, time, white;
} mixture;

/* Neighbours differ by correlated noise also: second differences hold 6 parts of the variance of white noise,
 * and of noise whose neighbours correlate by f, 6 - 8 f + 2 f f. false: there would be more of them than
 * there are. */
static bool mix(const explain_data *data, double share, double correlation_time, mixture *m) {
    const double f = exp(-data->step / correlation_time),
                 rest = 1.0 - share * share * (6.0 - 8.0 * f + 2.0 * f * f) / 6.0;
    *m = (mixture){share, correlation_time, sqrt(fmax(LEAST_WHITE, rest))};
    return rest > -0.2;
}

/* Log likelihood of a piece of the residual, its smooth trend left open. work: [7 longest]. */
static double piece_score(const explain_run *run, const double *residual, const piece *p, const mixture *m,
                          double *work, size_t longest) {
    double *keep = work, *take = work + longest, *weight = work + 2 * longest, *column[TREND + 1];
    double middle = 0.5 * (run->time[p->from] + run->time[p->to - 1]), half = run->time[p->to - 1] - middle;
    double logdet = make_filter(run, m->white * run->white, m->share * run->white, m->time, p->from, p->to,
                                keep, take, weight);
    for (size_t k = 0; k <= TREND; k++)
        column[k] = work + (3 + k) * longest;
    for (size_t i = p->from; i < p->to; i++) {
        double u = (run->time[i] - middle) / half;
        column[0][i] = 1.0;
        column[1][i] = u;
        column[2][i] = u * u;
        column[3][i] = residual[i];
    }
    double a[TREND * TREND] = {0}, b[TREND] = {0}, chi2 = 0.0;
    for (size_t k = 0; k <= TREND; k++)
        filter(p->from, p->to, keep, take, weight, column[k]);
    for (size_t i = p->from; i < p->to; i++) {
        for (size_t k = 0; k < TREND; k++) {
            b[k] += column[k][i] * column[TREND][i];
            for (size_t l = 0; l <= k; l++)
                a[k * TREND + l] += column[k][i] * column[l][i];
        }
        chi2 += column[TREND][i] * column[TREND][i];
    }
    double x[TREND];
    memcpy(x, b, sizeof x);
    if (!dense_cholesky(TREND, a))
        return 0.0;
    dense_cholesky_solve(TREND, a, 1, x);
    chi2 -= dense_dot(TREND, b, x);
    return -0.5 * (chi2 + logdet + dense_log_determinant(TREND, a));
}

/* What was asked before: the pieces, and each run's score without correlated noise. */
typedef struct pauses {
    const explain_data *data;
    const double *residual;
    const piece *list;
    size_t count;
    double *work, *without, *with; /* [7 longest]; [n_runs] each */
} pauses;

static void score_runs(const pauses *p, const mixture *m, double *score) {
    memset(score, 0, p->data->n_runs * sizeof *score);
    for (size_t k = 0; k < p->count; k++) {
        const explain_run *run = &p->data->run[p->list[k].run];
        const double *own = p->residual;
        for (size_t r = 0; r < p->list[k].run; r++)
            own += p->data->run[r].n;
        score[p->list[k].run] += piece_score(run, own, &p->list[k], m, p->work, p->data->longest);
    }
}

/* What correlated noise gains over none. An instrument has it in all its runs: of several the one that gains
 * most does not count, so that what happened in one run is not taken for noise. */
static double correlated_gain(const pauses *p, const mixture *m) {
    double sum = 0.0, most = 0.0;
    size_t runs = 0;
    score_runs(p, m, p->with);
    for (size_t r = 0; r < p->data->n_runs; r++) {
        double gain = p->with[r] - p->without[r];
        runs += p->without[r] != 0.0;
        sum += gain;
        most = fmax(most, gain);
    }
    return runs > 1 ? sum - most : sum;
}

/* The best of the grid of so many steps each way about one that is there; whether it is another. */
static bool look_around(const pauses *p, int reach, double span, mixture *best, double *most) {
    const mixture from = *best;
    const double share = from.share > 0.0 ? from.share : 0.5;
    for (int i = -reach; i <= reach; i++)
        for (int j = -reach; j <= reach; j++) {
            mixture m;
            bool can_be = mix(p->data, share * pow(span, i + 0.5 * j), from.time * pow(span, j),
                              &m); /* as much of it between neighbours */
            double gain = can_be ? correlated_gain(p, &m) : -HUGE_VAL;
            if (gain > *most + (best->share == 0.0 ? 5.0 : 0.0)) {
                *most = gain;
                *best = m;
            }
        }
    return best->share != from.share || best->time != from.time;
}

/* The most likely one: on a grid, then closer by. */
static mixture find_correlated(const pauses *p) {
    enum { CLOSER = 2, WALK = 8 };
    const mixture none = {.time = 30.0 * p->data->step, .white = 1.0};
    mixture best = none;
    double most = 0.0, span = 2.0;
    score_runs(p, &none, p->without);
    if (!look_around(p, 3, span, &best, &most))
        return none;
    for (int pass = 0; pass < CLOSER; pass++) {
        span = sqrt(span);
        for (int step = 0; step < WALK && look_around(p, 1, span, &best, &most); step++)
            continue;
    }
    return best;
}

/* Whether a piece steps from one level to another by more than this noise does: medians of a few samples
 * before and after, so that a single odd sample is none. */
static bool steps_in(const explain_run *run, const double *residual, const piece *p, const mixture *m) {
    enum { FEW = 3 };
    static const double ODDS = 5.0; /* standard deviations */
    for (size_t i = p->from + FEW; i + FEW <= p->to; i++) {
        double before[FEW], after[FEW], far = run->time[i + FEW - 1] - run->time[i - FEW];
        bool whole = true;
        for (size_t k = 0; k < FEW; k++) {
            before[k] = residual[i - 1 - k];
            after[k] = residual[i + k];
            whole = whole && run->use[i - 1 - k] && run->use[i + k];
        }
        double wander = 1.0 - exp(-far / m->time),
               unit = run->white * run->white; /* 1.57: of a median, for a mean */
        double variance = 2.0 * unit * (1.57 / FEW * m->white * m->white + m->share * m->share * wander);
        double step = statistics_median(after, FEW) - statistics_median(before, FEW);
        if (whole && step * step > ODDS * ODDS * variance)
            return true;
    }
    return false;
}

/* Noise wanders. What steps from level to level in several runs is structure, which a model may yet account
 * for. */
static bool steps(const pauses *p, const mixture *m) {
    size_t stepping = 0;
    const double *own = p->residual;
    for (size_t r = 0; r < p->data->n_runs; own += p->data->run[r++].n) {
        bool any = false;
        for (size_t k = 0; k < p->count && !any; k++)
            any = p->list[k].run == r && steps_in(&p->data->run[r], own, &p->list[k], m);
        stepping += any;
    }
    return stepping > 1 || stepping == p->data->n_runs;
}

/* ---- white noise ---- */

/* Neighbours at the run's largest force that do not differ at all may be beyond what the sensor reads: they
 * tell of no noise, if there are others. */
palp_status explain_white_noise(explain_run *run, const double *x) {
    const size_t n = run->n;
    const double step = (run->time[n - 1] - run->time[0]) / (double)(n - 1);
    double *time = malloc(2 * n * sizeof *time), *rest = time ? time + n : NULL, most = 0.0;
    size_t kept = 0;
    if (!time)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(run->force[i]));
    for (size_t i = 0; i < n; i++) {
        const bool alike = (i > 0 && run->force[i - 1] == run->force[i]) ||
                           (i + 1 < n && run->force[i + 1] == run->force[i]);
        if (alike && fabs(run->force[i]) == most)
            continue;
        time[kept] = run->time[i];
        rest[kept++] = x[i];
    }
    const bool some = kept >= EXPLAIN_SAMPLES_MIN;
    palp_status status = palp_segments_noise(some ? kept : n, some ? time : run->time, step, some ? rest : x,
                                             PALP_NOISE_MEDIAN, &run->white);
    free(time);
    return status;
}

static palp_status find_white(explain_data *data, const double *residual) {
    double typical = 0.0, least = 1e-7 * data->peak;
    for (size_t r = 0; r < data->n_runs; r++) {
        explain_run *run = &data->run[r];
        palp_status status = explain_white_noise(run, residual);
        if (status)
            return status;
        residual += run->n;
        typical += run->white * run->white / (double)data->n_runs;
    }
    for (size_t r = 0; r < data->n_runs; r++)
        data->run[r].white = fmax(data->run[r].white, fmax(least, 0.5 * sqrt(typical)));
    return PALP_OK;
}

palp_status explain_noise_find(explain_data *data, const double *residual) {
    piece *list = malloc(PIECES_MAX * sizeof *list);
    double *work = malloc((7 * data->longest + 2 * data->n_runs) * sizeof *work), square = 0.0;
    palp_status status = list && work ? find_white(data, residual) : PALP_ERR_NO_MEMORY;
    if (!status) {
        double *without = work + 7 * data->longest;
        const pauses p = {
            data, residual, list, find_pieces(data, list), work, without, without + data->n_runs};
        mixture m = find_correlated(&p);
        if (m.share > 0.0 && steps(&p, &m))
            m = (mixture){.time = m.time, .white = 1.0};
        data->correlation_time = m.time;
        for (size_t r = 0; r < data->n_runs; r++) {
            explain_run *run = &data->run[r];
            const double correlated = m.share * run->white;
            square += correlated * correlated * (double)run->n / (double)data->n;
            run->white *= m.white;
            make_filter(run, run->white, correlated, m.time, 0, run->n, run->keep, run->take, run->weight);
        }
        data->correlated = sqrt(square);
    }
    free(list);
    free(work);
    return status;
}
