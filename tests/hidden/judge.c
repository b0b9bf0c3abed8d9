/* judge.c: how much of an effect is left in the records after the plain model's numbers are refitted. */
#include "hidden.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The plain model's numbers, so that a step of 1 is large: the law's at a strain of a third, the arms'
 * logarithms. */
static void base_move(world *w, size_t k, double step) {
    if (k < LAW) {
        w->law[k] += step * w->law[0] * pow(3, (double)k);
        return;
    }
    arm *a = &w->arms[(k - LAW) / 2];
    double factor = exp(fmax(-1.5, fmin(1.5, step)));
    if ((k - LAW) % 2)
        a->time *= factor;
    else
        a->stiffness *= factor;
}

double judge_dot(const judge *j, const double *a, const double *b) {
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0; /* four sums: the processor need not wait for each */
    size_t i = 0;
    for (; i + 4 <= j->n; i += 4) {
        s0 += a[i] * b[i];
        s1 += a[i + 1] * b[i + 1];
        s2 += a[i + 2] * b[i + 2];
        s3 += a[i + 3] * b[i + 3];
    }
    for (; i < j->n; i++)
        s0 += a[i] * b[i];
    return s0 + s1 + s2 + s3;
}

double judge_rms(const judge *j, const double *v) {
    return sqrt(judge_dot(j, v, v) / (double)j->n);
}

/* v -= its part along unit; returns that part. */
static double take_off(const judge *j, const double *unit, double *v) {
    double part = judge_dot(j, unit, v);
    for (size_t i = 0; i < j->n; i++)
        v[i] -= part * unit[i];
    return part;
}

void judge_project(const judge *j, double *v) {
    for (size_t k = 0; k < j->n_base; k++)
        take_off(j, j->at.basis + k * j->n, v);
}

/* Gram-Schmidt, twice. */
static void orthonormalize(const judge *j, slopes *at) {
    memset(at->triangle, 0, sizeof at->triangle);
    for (size_t k = 0; k < j->n_base; k++) {
        double *column = at->basis + k * j->n;
        for (int pass = 0; pass < 2; pass++)
            for (size_t i = 0; i < k; i++)
                at->triangle[i][k] += take_off(j, at->basis + i * j->n, column);
        double length = sqrt(judge_dot(j, column, column));
        at->triangle[k][k] = length;
        for (size_t i = 0; i < j->n; i++)
            column[i] /= length;
    }
}

/* force: of the world w. */
static void linearize(const judge *j, const world *w, const double *force, slopes *at) {
    for (size_t k = 0; k < j->n_base; k++) {
        world moved = *w;
        double *column = at->basis + k * j->n;
        base_move(&moved, k, 1e-4);
        world_session(&moved, j->session, j->h, false, NULL, column);
        for (size_t i = 0; i < j->n; i++)
            column[i] = (column[i] - force[i]) / 1e-4;
    }
    orthonormalize(j, at);
}

static double *numbers(size_t n) {
    double *x = malloc(n * sizeof *x);
    if (!x)
        abort();
    return x;
}

bool judge_make(judge *j, const world *plain, const session *s, double h) {
    *j = (judge){.plain = plain, .session = s, .h = h, .n = s->n, .n_base = LAW + 2 * plain->n_arms};
    j->force = numbers(j->n);
    j->at.basis = numbers(j->n_base * j->n);
    world_session(plain, s, h, false, NULL, j->force);
    for (size_t i = 0; i < j->n; i++)
        j->peak = fmax(j->peak, fabs(j->force[i]));
    linearize(j, plain, j->force, &j->at);
    return true;
}

void judge_free(judge *j) {
    free(j->force);
    free(j->at.basis);
}

/* ---- refit ---- */

typedef struct refit {
    const judge *judge;
    double *there, *r, *trial; /* what is to be met; there - plain */
    double left;
    world plain;
    slopes own;
    const slopes *at; /* the judge's, or own */
} refit;

static refit refit_make(const judge *j) {
    double *space = numbers((3 + j->n_base) * j->n);
    return (refit){.judge = j,
                   .there = space,
                   .r = space + j->n,
                   .trial = space + 2 * j->n,
                   .plain = *j->plain,
                   .own.basis = space + 3 * j->n,
                   .at = &j->at};
}

/* By how much to move each number to take r off; the share of r that lies along the slopes. */
static double newton(const refit *f, double step[BASE]) {
    const judge *j = f->judge;
    double part = 0, longest = 1;
    for (size_t k = j->n_base; k-- > 0;) {
        double sum = judge_dot(j, f->at->basis + k * j->n, f->r);
        part += sum * sum;
        for (size_t i = k + 1; i < j->n_base; i++)
            sum -= f->at->triangle[k][i] * step[i];
        step[k] = sum / f->at->triangle[k][k];
        longest = fmax(longest, fabs(step[k]));
    }
    for (size_t k = 0; k < j->n_base; k++)
        step[k] /= longest;
    return sqrt(part / (double)j->n) / f->left;
}

static bool improve(refit *f, const double step[BASE], double share) {
    const judge *j = f->judge;
    world next = f->plain;
    for (size_t k = 0; k < j->n_base; k++)
        base_move(&next, k, share * step[k]);
    world_session(&next, j->session, j->h, false, NULL, f->trial);
    for (size_t i = 0; i < j->n; i++)
        f->trial[i] = f->there[i] - f->trial[i];
    double now = judge_rms(j, f->trial);
    if (!(now < f->left))
        return false;
    f->plain = next;
    f->left = now;
    memcpy(f->r, f->trial, j->n * sizeof *f->r);
    return true;
}

/* Gauss-Newton; the slopes are taken anew where the old ones no longer help. */
static void refit_run(refit *f) {
    const judge *j = f->judge;
    bool fresh = false;
    for (int i = 0; i < 12; i++) {
        double step[BASE], before = f->left;
        if (newton(f, step) < 0.1)
            break;
        bool good = improve(f, step, 1) || improve(f, step, 0.2);
        if (good && f->left < (fresh ? 0.98 : 0.7) * before)
            continue;
        if (fresh)
            break;
        for (size_t k = 0; k < j->n; k++)
            f->trial[k] = f->there[k] - f->r[k];
        linearize(j, &f->plain, f->trial, &f->own);
        f->at = &f->own;
        fresh = true;
    }
}

/* From where the last world's refit ended, or from the start. */
static visible refit_world(refit *f, const world *w) {
    const judge *j = f->judge;
    visible seen = {0, 0};
    world_session(w, j->session, j->h, false, NULL, f->there);
    world_session(&f->plain, j->session, j->h, false, NULL, f->trial);
    for (size_t i = 0; i < j->n; i++) {
        f->r[i] = f->there[i] - j->force[i];
        f->trial[i] = f->there[i] - f->trial[i];
    }
    seen.raw = judge_rms(j, f->r);
    f->left = judge_rms(j, f->trial);
    if (f->left < seen.raw) {
        memcpy(f->r, f->trial, j->n * sizeof *f->r);
    } else {
        f->left = seen.raw;
        f->plain = *j->plain;
        f->at = &j->at;
    }
    if (f->left > 0)
        refit_run(f);
    seen.left = f->left;
    return seen;
}

visible judge_visible(const judge *j, const world *w, double *residual) {
    refit f = refit_make(j);
    visible seen = refit_world(&f, w);
    if (residual)
        memcpy(residual, f.r, j->n * sizeof *residual);
    free(f.there);
    return seen;
}

double judge_fit(const judge *j, const world *w, world *nearest) {
    refit f = refit_make(j);
    double left = refit_world(&f, w).left;
    *nearest = f.plain;
    free(f.there);
    return left;
}

/* ---- strength ---- */

static double strongest(const judge *j, const world *w, int id) {
    const effect_kind *kind = id == EFFECTS ? NULL : &effect_kinds[id];
    double peak = j->peak, depth = j->session->deepest;
    if (!kind)
        switch (w->foreign) {
        case STIFFNESS_CYCLE:
        case GAIN_MAP:
        case MISPLACED:
            return 0.6;
        case BACKLASH:
            return 0.5e-3;
        default:
            return peak;
        }
    double unit = kind->scale == OF_STIFFNESS    ? j->plain->law[0]
                  : kind->scale == OF_FORCE      ? peak
                  : kind->scale == OF_COMPLIANCE ? depth / peak
                                                 : 1;
    return kind->high[0] * unit;
}

void judge_put(const judge *j, world *w, int id, const double shape[VALUES], double s) {
    double size = s * strongest(j, w, id) * shape[0];
    if (id == EFFECTS) {
        w->foreign_size = size;
        return;
    }
    w->value[id][0] = id == FORCE_SATURATION ? j->peak - size : size;
    for (size_t k = 1; k < effect_kinds[id].n; k++)
        w->value[id][k] = effect_kinds[id].coupled ? fmax(-0.9, shape[k] * size) : shape[k];
}

/* From weak to strong, then closing in; the residual need not grow with the strength for ever. */
visible judge_strengthen(const judge *j, world *w, int id, const double shape[VALUES], double target,
                         bool raw) {
    double s = 0.01, low = 0, high = 0, best = 0, best_left = 0, goal = 1.03 * target;
    visible seen = {0, 0};
    refit f = refit_make(j);
    for (int i = 0; i < 16; i++) {
        judge_put(j, w, id, shape, s);
        seen = refit_world(&f, w);
        double now = raw ? seen.raw : seen.left;
        if (now > best_left && now < goal)
            best = s, best_left = now;
        if (fabs(now - goal) < 0.03 * target) {
            best = s;
            break;
        }
        if (now < goal)
            low = s;
        else
            high = s;
        if (s >= 1 && now < goal)
            break;
        s = fmin(1, s * fmax(0.02, fmin(2.5, now > 0 ? goal / now : 2.5)));
        if (high > 0 && !(s > low && s < high))
            s = low > 0 ? sqrt(low * high) : 0.3 * high;
    }
    judge_put(j, w, id, shape, best);
    seen = refit_world(&f, w);
    free(f.there);
    return seen;
}
