/* alike.c: which other effects could have left the same in the records. */
#include "hidden.h"

#include <math.h>
#include <stdlib.h>

typedef struct look {
    const judge *judge;
    const double *y; /* projected */
    double y_rms;
    size_t n_also;
    const double *also;
    double *u, *v; /* [n] each: directions */
} look;

static void project(const look *l, double *v) {
    const judge *j = l->judge;
    judge_project(j, v);
    for (size_t k = 0; k < l->n_also; k++) {
        const double *unit = l->also + k * j->n;
        double part = judge_dot(j, unit, v);
        for (size_t i = 0; i < j->n; i++)
            v[i] -= part * unit[i];
    }
}

/* The effect of this shape at strength s, orthogonal to the plain model; its rms. 0 where the residual is
 * within the finite differences' error. */
static double direction(const look *l, int id, const double shape[VALUES], double s, double *u) {
    const judge *j = l->judge;
    world w = *j->plain;
    judge_put(j, &w, id, shape, s);
    world_session(&w, j->session, j->h, false, NULL, u);
    for (size_t i = 0; i < j->n; i++)
        u[i] -= j->force[i];
    double raw = judge_rms(j, u);
    project(l, u);
    double left = judge_rms(j, u);
    return left > 1e-3 * raw ? left : 0;
}

/* At about the strength that the true effect has. */
static double matched(const look *l, int id, const double shape[VALUES], double *u) {
    double s = 0.05, rms = direction(l, id, shape, s, u);
    if (effect_kinds[id].linear)
        return rms;
    s = rms > 0 ? fmin(1, s * fmin(20, l->y_rms / rms)) : 1;
    return direction(l, id, shape, s, u);
}

static double cosine_of(const look *l, const double *u, double rms) {
    const judge *j = l->judge;
    return rms > 0 ? judge_dot(j, l->y, u) / (double)j->n / (rms * l->y_rms) : 0;
}

static double one(const look *l, int id, double shape[VALUES]) {
    const effect_kind *kind = &effect_kinds[id];
    shape[0] = 1;
    double cosine = cosine_of(l, l->u, matched(l, id, shape, l->u));
    if (!kind->either_sign || kind->linear)
        return kind->either_sign ? fabs(cosine) : cosine;
    shape[0] = -1;
    return fmax(cosine, cosine_of(l, l->u, matched(l, id, shape, l->u)));
}

/* Two directions that mix freely. */
static double two(const look *l, int id, const double a[VALUES], const double b[VALUES]) {
    const judge *j = l->judge;
    double rms_u = direction(l, id, a, 0.02, l->u), rms_v = direction(l, id, b, 0.02, l->v);
    double first = cosine_of(l, l->u, rms_u);
    double before = rms_v;
    if (rms_u > 0 && rms_v > 0) {
        double part = judge_dot(j, l->u, l->v) / (double)j->n / (rms_u * rms_u);
        for (size_t i = 0; i < j->n; i++)
            l->v[i] -= part * l->u[i];
        rms_v = judge_rms(j, l->v);
    }
    return hypot(first, rms_v > 1e-3 * before ? cosine_of(l, l->v, rms_v) : 0);
}

static double grid_point(const effect_kind *kind, size_t k, int i, int n) {
    double share = n > 1 ? (double)i / (n - 1) : 0.5, low = kind->low[k], high = kind->high[k];
    return kind->logarithmic[k] ? low * pow(high / low, share) : low + (high - low) * share;
}

/* The best over the effect's shapes. */
static double best(const look *l, int id) {
    const effect_kind *kind = &effect_kinds[id];
    double cosine = -1, shape[VALUES] = {1, 0, 0}, other[VALUES] = {1, 0, 0};
    if (id == STRAIN_DEPENDENT_ARM) { /* stiffness alone, and with the time */
        other[1] = 1;
        return two(l, id, shape, other);
    }
    int n = kind->n == 1 ? 1 : kind->logarithmic[1] ? 7 : 3;
    for (int i = 0; i < n; i++) {
        shape[1] = other[1] = kind->n > 1 ? grid_point(kind, 1, i, n) : 0;
        other[2] = 1.5707963267948966;
        cosine = fmax(cosine, kind->plane ? two(l, id, shape, other) : one(l, id, shape));
    }
    return cosine;
}

void judge_alike(const judge *j, double *y, size_t n_also, const double *also, double cosine[EFFECTS]) {
    double *space = malloc(2 * j->n * sizeof *space);
    look l = {j, y, 0, n_also, also, space, space ? space + j->n : NULL};
    if (!space)
        abort();
    project(&l, y);
    l.y_rms = judge_rms(j, y);
    for (int id = 0; id < EFFECTS; id++) /* hum is like nothing else */
        cosine[id] = id == MAINS_HUM ? 0 : best(&l, id);
    free(space);
}

double judge_frame(const judge *j, const world *w, double left) {
    static const double shape[VALUES] = {1, 0, 0};
    double least = left;
    world nearest = *j->plain;
    for (double s = 0.1; s < 1; s *= 1.5) { /* each from the last one's numbers */
        judge beside;
        world plain = nearest;
        judge_put(j, &plain, FRAME_COMPLIANCE, shape, s);
        if (!judge_make(&beside, &plain, j->session, j->h))
            abort();
        least = fmin(least, judge_fit(&beside, w, &nearest));
        judge_free(&beside);
    }
    return sqrt(1 - least * least / (left * left));
}
