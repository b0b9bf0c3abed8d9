/* fit_select.c: the number of arms, or the degree, by the error on blocks held out. */
#include "base/arena.h"
#include "base/dense.h"
#include "base/file.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FOLDS = 5, GROUPS = 40 };

static const double COARSE =
    1e-5; /* tolerance of a fit that is only compared: losses within a fifth are alike */

/* Blocks in groups (of one recording, neighbours in log time), groups in folds. With three recordings and
 * one law for all, a fold is a recording. */
typedef struct folds {
    arena memory;
    size_t n_folds, n_groups;
    size_t *group;           /* [n_blocks] */
    size_t *fold;            /* [n_groups] */
    double *weight;          /* [n_blocks] */
    unsigned char *held_out; /* [n_blocks] */
    double *loss;            /* [n_candidates n_groups] mean square of the held-out residuals */
    double *left;            /* [n_candidates n_blocks] these residuals, where laws are compared */
    bool by_run;
} folds;

/* Of a long recording one in so many blocks counts, the others are history only. Some hundred of them in a
 * group are enough to separate losses that differ by a fifth. */
static void thin(fit_problem *p) {
    enum { ENOUGH = 200 * GROUPS };
    for (size_t r = 0; r < p->n_runs; r++)
        for (size_t i = 0, every = 1 + p->run[r].n / ENOUGH; i < p->run[r].n; i++)
            p->run[r].count[i] *= i % every == 0;
}

/* Weights of the blocks in the groups: 1, or more for those that go deeper than all before them, so that at
 * least a third of the groups are theirs. They determine the law, and a sweep has few of them. */
static void weigh_blocks(const fit_run *run, double *weight) {
    double deepest = 0.0, deeper = 0.0, rest = 0.0;
    for (size_t b = 0; b < run->n; b++) {
        bool goes = run->strain[b] > deepest;
        deepest = fmax(deepest, run->strain[b]);
        weight[b] = run->count[b] == 0.0 ? 0.0 : goes ? 2.0 : 1.0;
        deeper += weight[b] > 1.0;
        rest += weight[b] == 1.0;
    }
    for (size_t b = 0; b < run->n; b++)
        weight[b] = weight[b] > 1.0 ? fmax(1.0, 0.5 * rest / deeper) : weight[b];
}

static palp_status make_folds(folds *f, const fit_problem *p, size_t candidates) {
    bool by_run = f->by_run = p->settings->spring == PALP_SPRING_LAW && p->n_runs >= 3;
    f->n_groups = p->n_runs * GROUPS;
    f->n_folds = by_run ? p->n_runs : FOLDS;
    f->group = arena_take(&f->memory, p->n_blocks, sizeof *f->group);
    f->fold = arena_take(&f->memory, f->n_groups, sizeof *f->fold);
    f->weight = arena_take(&f->memory, p->n_blocks, sizeof *f->weight);
    f->held_out = arena_take(&f->memory, p->n_blocks, sizeof *f->held_out);
    f->loss = arena_take(&f->memory, candidates * f->n_groups, sizeof *f->loss);
    if (f->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0, i = 0; r < p->n_runs; r++) {
        double *weight = f->weight + i, all = 1.0, at = 0.0;
        weigh_blocks(&p->run[r], weight);
        for (size_t b = 0; b < p->run[r].n; b++)
            all += weight[b];
        for (size_t b = 0; b < p->run[r].n; b++, i++) {
            size_t g = (size_t)(at * GROUPS / all);
            f->group[i] = r * GROUPS + g;
            f->fold[f->group[i]] = by_run ? r : (g * 7 + r) % FOLDS;
            at += weight[b];
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

/* Deepest strain of all runs but one: a law is judged only as far as the other runs went. */
static double others_strain(const fit_problem *p, size_t but) {
    double most = 0.0;
    for (size_t r = 0; r < p->n_runs; r++)
        for (size_t i = 0; i < p->run[r].n && r != but; i++)
            most = fmax(most, p->run[r].strain[i]);
    return most;
}

/* Residual of the blocks of a fold by the fit of all others. It takes one Gauss-Newton step from the fit of
 * all, which is exact for linear parameters: d = (J'J - Jf'Jf)^-1 Jf' rf, and the residual is rf + Jf d.
 * square = J'J; work[3 n n + 2 n]. */
static palp_status step_out(const folds *f, const fit_problem *p, size_t fold, const double *residual,
                            const double *jacobian, const double *square, double *work, double *loss,
                            double *count, double *all) {
    size_t n = fit_parameter_count(p), m = p->n_blocks;
    double *rest = work, *inverse = rest + n * n, *pull = inverse + n * n, *step = pull + n;
    memcpy(rest, square, n * n * sizeof *rest);
    memset(pull, 0, n * sizeof *pull);
    for (size_t i = 0; i < m; i++) {
        if (f->fold[f->group[i]] != fold)
            continue;
        for (size_t a = 0; a < n; a++) {
            pull[a] += jacobian[a * m + i] * residual[i];
            for (size_t b = 0; b < n; b++)
                rest[a * n + b] -= jacobian[a * m + i] * jacobian[b * m + i];
        }
    }
    palp_status status = fit_invert(n, rest, inverse);
    for (size_t a = 0; a < n && !status; a++) {
        step[a] = 0.0;
        for (size_t b = 0; b < n; b++)
            step[a] += inverse[a * n + b] * pull[b];
    }
    for (size_t run = 0, i = 0; run < p->n_runs && !status; run++) {
        double top = f->by_run ? others_strain(p, run) : HUGE_VAL;
        for (size_t b = 0; b < p->run[run].n; b++, i++) {
            double left = residual[i];
            if (f->fold[f->group[i]] != fold || p->run[run].count[b] == 0.0 || p->run[run].strain[b] > top)
                continue;
            for (size_t a = 0; a < n; a++)
                left += jacobian[a * m + i] * step[a];
            all[i] = left;
            loss[f->group[i]] += left * left;
            count[f->group[i]] += 1.0;
        }
    }
    return status;
}

/* The better of two fits, which may end in different minima: from the scan, and from the arms of the law
 * before, v in, where there was one. other[n] is scratch. PALP_ERR_SINGULAR: K(e) falls to 0 within the
 * measured strain, which no constraint prevents for an Ogden law. */
static palp_status solve_twice(fit_problem *p, bool started, double *v, double *other, double *chi2) {
    size_t bytes = fit_parameter_count(p) * sizeof *v;
    double second = HUGE_VAL;
    bool done;
    memcpy(other, v, bytes);
    palp_status status = fit_solve(p, v, chi2, &done);
    p->least = 0.0;
    if (!status && started)
        status = fit_solve_from(p, other, &second, &done);
    if (!status && second < *chi2) {
        memcpy(v, other, bytes);
        *chi2 = second;
    }
    palp_law law;
    if (!status)
        status = fit_law(p, v, &law);
    return !status && !(palp_law_minimum(&law, p->strain_max) > 0.0) ? PALP_ERR_SINGULAR : status;
}

/* Zeroes the derivatives by parameters that a fit without a fold would not move: a time on its bound; an arm
 * whose stiffness may be 0, as it changes all residuals together by less than one sd. */
static void fix_idle_arms(const fit_problem *p, const double *v, double chi2, double *jacobian) {
    const double on_bound = 1e-6; /* in log time; the solver meets a bound to 1e-9 */
    const size_t m = p->n_blocks, bytes = m * sizeof *jacobian;
    for (size_t j = 0; j < p->n_arms; j++) {
        const size_t k = p->n_springs + 2 * j;
        double *by_stiffness = jacobian + k * m, *by_time = by_stiffness + m, time = v[k + 1];
        const bool idle = dense_dot(m, by_stiffness, by_stiffness) < chi2 / (double)m;
        if (idle)
            memset(by_stiffness, 0, bytes);
        if (idle || time < log(p->tau_min) + on_bound || time > log(p->tau_max) - on_bound)
            memset(by_time, 0, bytes);
    }
}

/* One fit, and all folds from its derivatives. arms[2 n_arms]: of the law before, to start from, if *started;
 * then of this one. */
static palp_status score_by_steps(folds *f, fit_problem *p, double *arms, bool *started, double *loss,
                                  double *left) {
    size_t n = fit_parameter_count(p), m = p->n_blocks, bytes = 2 * p->n_arms * sizeof *arms;
    double *v = calloc(n + m + m * n + 4 * n * n + 2 * n + f->n_groups, sizeof *v), chi2;
    if (!v)
        return PALP_ERR_NO_MEMORY;
    double *residual = v + n, *jacobian = residual + m, *square = jacobian + m * n, *work = square + n * n;
    double *count = work + 3 * n * n + 2 * n;
    memcpy(v, p->law.coefficients, p->n_springs * sizeof *v);
    memcpy(v + p->n_springs, arms, bytes);
    palp_status status = solve_twice(p, *started, v, work, &chi2);
    if (!status)
        status = fit_evaluate(p, v, residual, jacobian);
    if (!status) {
        memcpy(arms, v + p->n_springs, bytes);
        *started = true;
        fix_idle_arms(p, v, chi2, jacobian);
    }
    if (!status)
        dense_transposed_product(n, n, m, jacobian, jacobian, square);
    for (size_t fold = 0; fold < f->n_folds && !status; fold++)
        status = step_out(f, p, fold, residual, jacobian, square, work, loss, count, left);
    for (size_t g = 0; g < f->n_groups; g++)
        loss[g] = count[g] > 0.0 ? loss[g] / count[g] : 0.0;
    free(v);
    return status;
}

/* Mean over the groups of log(loss a / loss b), and its standard error: with the logarithm a few groups with
 * a large loss, as a corner or a first sample, do not hide all others. */
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

static palp_status select_best(size_t n, const palp_recording *recordings,
                               const palp_characterize_settings *settings, bool arms, size_t candidates,
                               double *score, double *sd, size_t *chosen, palp_error *error) {
    folds f = {.loss = NULL};
    palp_characterize_settings largest = *settings;
    double one[PALP_LAW_MAX] = {1.0};
    fit_problem p;
    if (arms)
        largest.n_arms = candidates - 1;
    palp_status status = arms ? PALP_OK : palp_law_polynomial(candidates, one, &largest.law);
    if (!status)
        status = fit_problem_create(&p, n, recordings, &largest, error);
    if (status)
        return status;
    p.stop_relative = COARSE;
    thin(&p);
    status = make_folds(&f, &p, candidates);
    for (size_t c = 0; c < candidates && !status; c++) {
        p.n_arms = arms ? c : p.n_arms;
        p.least = 0.0;
        if (!arms)
            status = palp_law_polynomial(p.n_springs = c + 1, one, &p.law);
        if (!status)
            status = score_candidate(&f, &p, f.loss + c * f.n_groups);
    }
    fit_problem_free(&p);
    if (!status)
        *chosen = fit_choose(candidates, f.n_groups, f.loss, score, sd);
    arena_free(&f.memory);
    return status ? fit_failed(error, status, recordings[0].name) : PALP_OK;
}

palp_status palp_characterize_select_arms(size_t n, const palp_recording *recordings,
                                          const palp_characterize_settings *settings, size_t max_arms,
                                          double *score, double *sd, size_t *best, palp_error *error) {
    if (!recordings || !settings || !score || !sd || !best)
        return palp_error_null(error);
    if (max_arms > PALP_ARMS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu arms, at most %d", max_arms, PALP_ARMS_MAX);
    return select_best(n, recordings, settings, true, max_arms + 1, score, sd, best, error);
}

palp_status palp_characterize_select_degree(size_t n, const palp_recording *recordings,
                                            const palp_characterize_settings *settings, size_t max_degree,
                                            double *score, double *sd, size_t *best, palp_error *error) {
    if (!recordings || !settings || !score || !sd || !best)
        return palp_error_null(error);
    if (max_degree + 1 > PALP_LAW_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "degree %zu, at most %d", max_degree, PALP_LAW_MAX - 1);
    if (settings->spring != PALP_SPRING_LAW)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a degree is chosen for one law of all recordings");
    return select_best(n, recordings, settings, false, max_degree + 1, score, sd, best, error);
}

/* Mean over the groups of the excess rms residual of law a over law b, and its standard error. */
static double rms_excess(size_t groups, const double *a, const double *b, double *error) {
    double sum = 0.0, square = 0.0, used = 0.0;
    for (size_t g = 0; g < groups; g++) {
        double d = sqrt(a[g]) - sqrt(b[g]);
        sum += d;
        square += d * d;
        used += a[g] > 0.0 || b[g] > 0.0;
    }
    double mean = sum / fmax(used, 1.0);
    *error = used > 1.0 ? sqrt(fmax(square / used - mean * mean, 0.0) / (used - 1.0)) : HUGE_VAL;
    return mean;
}

/* Excess of the squared residual of law a over law b, in units of the noise, and its standard error by the
 * noise: that of 2 sum (a - b) b, widened as fit_inflation widens intervals. */
static double squares_excess(const fit_problem *p, const double *a, const double *b, double *error) {
    fit_curvature c = {0};
    double sum = 0.0, apart = 0.0;
    for (size_t i = 0; i < p->n_blocks; i++) {
        sum += a[i] * a[i] - b[i] * b[i];
        apart += (a[i] - b[i]) * (a[i] - b[i]);
    }
    fit_sum_residual(p, b, &c);
    *error = 2.0 * sqrt(apart) * fit_inflation(&c);
    return sum;
}

/* For recordings that were all fitted, the first law whose residual is within two standard errors of the best
 * one's. An error of some percent of the noise over thousands of blocks changes the arms by several sds. */
static size_t choose_by_blocks(const folds *f, const fit_problem *p, size_t laws) {
    size_t best = 0, chosen = 0, m = p->n_blocks;
    double error;
    for (size_t c = 1; c < laws; c++)
        if (squares_excess(p, f->left + c * m, f->left + best * m, &error) < 0.0)
            best = c;
    while (chosen < best && squares_excess(p, f->left + chosen * m, f->left + best * m, &error) > 2.0 * error)
        chosen++;
    return chosen;
}

/* The first law whose error on recordings left out is near the best one's: within two standard errors, or a
 * tenth, of the mean of the groups' rms. The recordings left out have a zero force and a contact of their
 * own. A law is judged by forces, so large ones count most; arms are judged by logarithms. */
static size_t choose_by_runs(const folds *f, size_t laws) {
    size_t best = 0, chosen = 0, groups = f->n_groups;
    double error, typical = 0.0, used = 0.0, *loss = f->loss;
    for (size_t c = 1; c < laws; c++)
        if (rms_excess(groups, loss + c * groups, loss + best * groups, &error) < 0.0)
            best = c;
    for (size_t g = 0; g < groups; g++) {
        typical += sqrt(loss[best * groups + g]);
        used += loss[best * groups + g] > 0.0;
    }
    while (chosen < best && rms_excess(groups, loss + chosen * groups, loss + best * groups, &error) >
                                fmax(2.0 * error, 0.1 * typical / fmax(used, 1.0)))
        chosen++;
    return chosen;
}

/* A law that cannot be fitted, or falls to 0, has the residual of zero force. */
static void lose(const folds *f, const fit_problem *p, double *loss, double *left) {
    memset(loss, 0, f->n_groups * sizeof *loss);
    for (size_t r = 0, i = 0; r < p->n_runs; r++)
        for (size_t b = 0; b < p->run[r].n; b++, i++) {
            double force = sqrt(p->run[r].count[b]) * p->run[r].force[b] / p->run[r].noise;
            left[i] = force;
            loss[f->group[i]] = fmax(loss[f->group[i]], force * force);
        }
}

palp_status palp_characterize_select_law(size_t n, const palp_recording *recordings,
                                         const palp_characterize_settings *settings, size_t n_laws,
                                         const palp_law *law, double *score, double *sd, size_t *best,
                                         palp_error *error) {
    if (!recordings || !settings || !law || !score || !sd || !best)
        return palp_error_null(error);
    if (settings->spring != PALP_SPRING_LAW || n_laws == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a law is chosen among some, for all recordings");
    folds f = {.loss = NULL};
    palp_characterize_settings largest = *settings;
    double arms[2 * PALP_ARMS_MAX] = {0};
    bool started = false;
    fit_problem p;
    for (size_t c = 0; c < n_laws; c++)
        if (c == 0 || law[c].n > largest.law.n)
            largest.law = law[c];
    palp_status status = fit_problem_create(&p, n, recordings, &largest, error);
    if (status)
        return status;
    p.stop_relative = COARSE;
    thin(&p);
    status = make_folds(&f, &p, n_laws);
    f.left = arena_take(&f.memory, n_laws * p.n_blocks, sizeof *f.left);
    status = status || f.left ? status : PALP_ERR_NO_MEMORY;
    for (size_t c = 0; c < n_laws && !status; c++) {
        p.law = law[c];
        p.n_springs = law[c].n;
        p.least = 0.0;
        status = score_by_steps(&f, &p, arms, &started, f.loss + c * f.n_groups, f.left + c * p.n_blocks);
        if (status == PALP_ERR_SINGULAR) {
            lose(&f, &p, f.loss + c * f.n_groups, f.left + c * p.n_blocks);
            status = PALP_OK;
        }
    }
    if (!status) {
        fit_choose(n_laws, f.n_groups, f.loss, score, sd);
        *best = f.by_run ? choose_by_runs(&f, n_laws) : choose_by_blocks(&f, &p, n_laws);
    }
    fit_problem_free(&p);
    arena_free(&f.memory);
    return status ? fit_failed(error, status, recordings[0].name) : PALP_OK;
}
