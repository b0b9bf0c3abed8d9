/* fit_select.c: how many arms, or which degree, by error on blocks that were held out. */
#include "base/arena.h"
#include "base/file.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FOLDS = 5, GROUPS = 40 };

/* Blocks in groups (of one recording, neighbours in log time), groups in folds. With three recordings and
 * one law for all, a fold is a recording. */
typedef struct folds {
    arena memory;
    size_t n_folds, n_groups;
    size_t *group;           /* [n_blocks] */
    size_t *fold;            /* [n_groups] */
    unsigned char *held_out; /* [n_blocks] */
    double *loss;            /* [n_candidates n_groups] mean square of the held-out residuals */
} folds;

static palp_status make_folds(folds *f, const fit_problem *p, size_t candidates) {
    bool by_run = p->settings->spring == PALP_SPRING_LAW && p->n_runs >= 3;
    f->n_groups = p->n_runs * GROUPS;
    f->n_folds = by_run ? p->n_runs : FOLDS;
    f->group = arena_take(&f->memory, p->n_blocks, sizeof *f->group);
    f->fold = arena_take(&f->memory, f->n_groups, sizeof *f->fold);
    f->held_out = arena_take(&f->memory, p->n_blocks, sizeof *f->held_out);
    f->loss = arena_take(&f->memory, candidates * f->n_groups, sizeof *f->loss);
    if (f->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0, i = 0; r < p->n_runs; r++) {
        size_t used = 0, at = 0;
        for (size_t b = 0; b < p->run[r].n; b++)
            used += p->run[r].count[b] > 0.0;
        for (size_t b = 0; b < p->run[r].n; b++, i++) {
            size_t g = used ? at * GROUPS / (used + 1) : 0;
            f->group[i] = r * GROUPS + g;
            f->fold[f->group[i]] = by_run ? r : (g * 7 + r) % FOLDS;
            at += p->run[r].count[b] > 0.0;
        }
    }
    return PALP_OK;
}

/* Adds the squared residuals of the fold that was held out to the losses of its groups. */
static palp_status score_fold(const folds *f, fit_problem *p, size_t fold, const double *v, double *loss,
                              double *count) {
    double *r = malloc(p->n_blocks * sizeof *r);
    if (!r)
        return PALP_ERR_NO_MEMORY;
    p->held_out = NULL;
    palp_status status = fit_evaluate(p, v, r, NULL);
    for (size_t run = 0, i = 0; run < p->n_runs; run++)
        for (size_t b = 0; b < p->run[run].n; b++, i++)
            if (f->fold[f->group[i]] == fold && p->run[run].count[b] > 0.0) {
                loss[f->group[i]] += r[i] * r[i];
                count[f->group[i]] += 1.0;
            }
    free(r);
    return status;
}

static palp_status score_candidate(folds *f, fit_problem *p, double *loss) {
    double chi2, *count = calloc(f->n_groups, sizeof *count);
    size_t n = fit_parameter_count(p);
    double *whole = calloc(n + 1, sizeof *whole), *v = calloc(n + 1, sizeof *v);
    bool done;
    palp_status status = whole && v && count ? fit_solve(p, whole, &chi2, &done) : PALP_ERR_NO_MEMORY;
    for (size_t fold = 0; fold < f->n_folds && !status; fold++) {
        for (size_t i = 0; i < p->n_blocks; i++)
            f->held_out[i] = f->fold[f->group[i]] == fold;
        memcpy(v, whole, n * sizeof *v);
        p->held_out = f->held_out;
        status = fit_polish(p, v, &chi2, &done);
        if (!status)
            status = score_fold(f, p, fold, v, loss, count);
    }
    p->held_out = NULL;
    for (size_t g = 0; g < f->n_groups && count; g++)
        loss[g] = count[g] > 0.0 ? loss[g] / count[g] : 0.0;
    free(count);
    free(whole);
    free(v);
    return status;
}

/* Mean over the groups of log(loss a / loss b), and its standard error: the logarithm keeps a few groups of a large
 * loss, a corner or a first sample, from hiding all others. */
static double log_ratio(size_t groups, const double *a, const double *b, double *error) {
    double sum = 0.0, square = 0.0, used = 0.0;
    for (size_t g = 0; g < groups; g++) {
        if (!(a[g] > 0.0) || !(b[g] > 0.0))
            continue;
        double d = log(a[g] / b[g]);
        sum += d;
        square += d * d;
        used += 1.0;
    }
    double mean = used > 0.0 ? sum / used : 0.0;
    *error = used > 1.0 ? sqrt(fmax(square / used - mean * mean, 0.0) / (used - 1.0)) : HUGE_VAL;
    return mean;
}

size_t fit_choose(size_t candidates, size_t groups, const double *loss, double *score, double *sd) {
    size_t best = 0, chosen = 0, used = 0;
    double error;
    for (size_t g = 0; g < groups; g++)
        used += loss[g] > 0.0;
    for (size_t c = 0; c < candidates; c++) {
        score[c] = 0.0;
        for (size_t g = 0; g < groups; g++)
            score[c] += loss[c * groups + g] / (double)used;
        if (log_ratio(groups, loss + c * groups, loss + best * groups, &error) < 0.0)
            best = c;
    }
    for (size_t c = 0; c < candidates; c++) {
        double square = 0.0, mean = score[c] - score[best];
        for (size_t g = 0; g < groups; g++) {
            double d = loss[c * groups + g] - loss[best * groups + g] - mean;
            square += loss[g] > 0.0 ? d * d : 0.0;
        }
        sd[c] = used > 1 ? sqrt(square / (double)(used - 1) / (double)used) : 0.0;
    }
    while (chosen < best && log_ratio(groups, loss + chosen * groups, loss + best * groups, &error) >
                                fmax(2.0 * error, log(1.2)))
        chosen++;
    return chosen;
}

static palp_status select_best(size_t n, const palp_recording *recordings, const palp_characterize_settings *settings,
                               bool arms, size_t candidates, double *score, double *sd, size_t *chosen,
                               palp_error *error) {
    folds f = {.loss = NULL};
    palp_status status = PALP_OK;
    for (size_t c = 0; c < candidates && !status; c++) {
        palp_characterize_settings trial = *settings;
        double one[PALP_LAW_MAX] = {1.0};
        fit_problem p;
        if (arms)
            trial.n_arms = c;
        else
            status = palp_law_polynomial(c + 1, one, &trial.law);
        if (!status)
            status = fit_problem_create(&p, n, recordings, &trial, error);
        if (status)
            break;
        if (c == 0)
            status = make_folds(&f, &p, candidates);
        if (!status)
            status = score_candidate(&f, &p, f.loss + c * f.n_groups);
        fit_problem_free(&p);
    }
    if (!status)
        *chosen = fit_choose(candidates, f.n_groups, f.loss, score, sd);
    arena_free(&f.memory);
    return status;
}

palp_status palp_characterize_select_arms(size_t n, const palp_recording *recordings, const palp_characterize_settings *settings,
                             size_t max_arms, double *score, double *sd, size_t *best, palp_error *error) {
    if (!recordings || !settings || !score || !sd || !best)
        return palp_error_null(error);
    if (max_arms > PALP_ARMS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu arms, at most %d", max_arms, PALP_ARMS_MAX);
    return select_best(n, recordings, settings, true, max_arms + 1, score, sd, best, error);
}

palp_status palp_characterize_select_degree(size_t n, const palp_recording *recordings, const palp_characterize_settings *settings,
                               size_t max_degree, double *score, double *sd, size_t *best,
                               palp_error *error) {
    if (!recordings || !settings || !score || !sd || !best)
        return palp_error_null(error);
    if (max_degree + 1 > PALP_LAW_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "degree %zu, at most %d", max_degree, PALP_LAW_MAX - 1);
    if (settings->spring != PALP_SPRING_LAW)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a degree is chosen for one law of all recordings");
    return select_best(n, recordings, settings, false, max_degree + 1, score, sd, best, error);
}
