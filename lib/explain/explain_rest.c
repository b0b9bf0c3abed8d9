/* explain_rest.c: whether what a fit leaves of a run can be told from the instrument's noise. */
#include "explain_search.h"
#include "explain_noise.h"
#include "base/dense.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Means of the residual over blocks of samples: of noise they shrink as the blocks grow, of anything else
 * they do not. */
enum { BLOCKS_MIN = 8, TIMES = 4 };  /* fewest blocks; a block's length over that of the next shorter */
static const double KNOWN_TO = 0.25; /* of its variance: how well the noise is known from pauses */
static const double PULLS = 0.3;     /* of a release: a model that pulls so much there follows it */
static const double TOLD =
    0.66; /* noise levels in a run: equations and the samples of a path are not better than that */

/* x: whitened, raw: in N, both 0 where a sample does not count. */
typedef struct blocks {
    double count, whitened, raw; /* how many; sums of their squared sums over their length */
} blocks;

static blocks sum_blocks(const explain_run *run, const double *x, const double *raw, size_t length) {
    blocks b = {.count = 0.0};
    for (size_t from = 0; from + length <= run->n; from += length) {
        double sum = 0.0, of_raw = 0.0, n = 0.0;
        for (size_t i = from; i < from + length; i++) {
            sum += x[i];
            of_raw += raw[i];
            n += run->use[i];
        }
        if (2.0 * n < (double)length)
            continue;
        b.count += 1.0;
        b.whitened += sum * sum / n;
        b.raw += of_raw * of_raw / n;
    }
    return b;
}

/* Variance of x as neighbours differ, which what changes slowly is not in: of sixteenths of the run that
 * which a quarter of them exceed, so that a fast ramp of a few samples does not pass for noise. */
static double by_neighbours(const explain_run *run, const double *x) {
    enum { STRETCHES = 16, EXCEEDED = STRETCHES / 4 };
    double mean[STRETCHES];
    size_t found = 0;
    for (size_t k = 0; k < STRETCHES; k++) {
        double sum = 0.0, n = 0.0;
        for (size_t i = k * run->n / STRETCHES + 1; i < (k + 1) * run->n / STRETCHES; i++)
            if (run->use[i] && run->use[i - 1]) {
                sum += 0.5 * (x[i] - x[i - 1]) * (x[i] - x[i - 1]);
                n += 1.0;
            }
        size_t at = found;
        for (; n > 0.0 && at > 0 && mean[at - 1] < sum / n; at--) /* largest first */
            mean[at] = mean[at - 1];
        if (n > 0.0)
            mean[at] = sum / n;
        found += n > 0.0;
    }
    return found > EXCEEDED ? mean[EXCEEDED] : found > 0 ? mean[found - 1] : 1.0;
}

/* Square of the rms that is no noise, of one run; 0: nothing can be told from noise. */
static double rest_of(const explain_run *run, const double *x, const double *raw, double alarm) {
    double noise = fmax(1.0, by_neighbours(run, x)), most = 0.0;
    size_t scales = 0;
    for (size_t length = TIMES; BLOCKS_MIN * length <= run->n; length *= TIMES)
        scales++;
    for (size_t length = TIMES; BLOCKS_MIN * length <= run->n; length *= TIMES) {
        blocks b = sum_blocks(run, x, raw, length);
        double limit = (1.0 + KNOWN_TO) * noise *
                       statistics_chi2_quantile((size_t)b.count, 1.0 - alarm / (double)scales);
        if (b.count > 0.0 && b.whitened > limit)
            most = fmax(most, b.raw / (double)run->n * (1.0 - noise * b.count / b.whitened));
    }
    return most;
}

/* A run's residual[n] into x, whitened; false: the run is left out of the fit. */
static bool take_whitened(const explain_run *run, const double *residual, double *x) {
    if (run->held_out)
        return false;
    memcpy(x, residual, run->n * sizeof *x);
    explain_whiten(run, 1, x);
    return true;
}

palp_status explain_rest_inflation(const explain_data *data, const double *residual, double *inflation) {
    enum { SCALES = 8, BLOCKS = 16 };
    double *x = malloc(data->longest * sizeof *x), whitened[SCALES] = {0}, count[SCALES] = {0};
    *inflation = 1.0;
    if (!x)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < data->n_runs; residual += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        if (!take_whitened(run, residual, x))
            continue;
        for (size_t k = 0, length = 1; k < SCALES && BLOCKS * length <= run->n; k++, length *= TIMES) {
            blocks b = sum_blocks(run, x, x, length);
            whitened[k] += b.whitened;
            count[k] += b.count;
        }
    }
    for (size_t k = 0; k < SCALES; k++)
        if (count[k] > 0.0)
            *inflation = fmax(*inflation, whitened[k] / statistics_chi2_quantile((size_t)count[k], 0.99));
    free(x);
    return PALP_OK;
}

/* ---- the verdict ---- */

/* Mean square pull of the releases in run r, whose model gives force, that the model does not follow: a pull
 * that grows evenly up to the jump; *most: the largest jump. */
static double missed_pulls(const explain_data *data, size_t r, const double *force, double *most) {
    const explain_run *run = &data->run[r];
    double sum = 0.0;
    for (size_t k = 0; k < data->n_events; k++) {
        const palp_explain_event *event = &data->event[k];
        double strongest = 0.0;
        if (event->run != r || strcmp(event->kind, "release") != 0)
            continue;
        for (size_t i = 0; i < run->n; i++) {
            double before = event->from_s - run->start - run->time[i];
            if (before >= 0.0 && before <= (double)event->samples * data->step)
                strongest = fmax(strongest, -force[i]);
        }
        if (strongest > PULLS * event->size_N)
            continue;
        sum += event->size_N * event->size_N * (double)event->samples / 3.0;
        *most = fmax(*most, event->size_N);
    }
    return sum / (double)run->n;
}

palp_status explain_rest_find(const explain_search *s, const double *force, const double *residual,
                              explain_rest *rest) {
    const explain_data *data = &s->data;
    double *x = malloc(data->longest * sizeof *x), sum = 0.0, runs = 0.0;
    *rest = (explain_rest){.run = data->n_runs};
    if (!x)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < data->n_runs; r++)
        runs += !data->run[r].held_out;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        if (!take_whitened(run, residual + at, x))
            continue;
        double square = rest_of(run, x, residual + at, s->settings->false_alarm / runs);
        if (square < TOLD * TOLD * (run->white * run->white + data->correlated * data->correlated))
            square = 0.0;
        double jump = 0.0;
        square += missed_pulls(data, r, force + at, &jump);
        sum += square * (double)run->n;
        if (fmax(jump, sqrt(square)) > rest->most_N) {
            rest->most_N = fmax(jump, sqrt(square));
            rest->run = r;
        }
    }
    rest->rms_N = sqrt(sum / (double)explain_samples(data));
    free(x);
    return PALP_OK;
}

bool explain_rest_matters(const explain_search *s, const explain_rest *rest) {
    return rest->most_N > s->settings->good_enough * s->data.peak;
}
