/* path.c: where the plate goes: straight from knot to knot, every corner rounded as servo drives do. */
#include "hidden.h"

#include <math.h>

void path_start(run *r, double depth) {
    r->knots = 1;
    r->knot_t[0] = 0;
    r->knot_d[0] = depth;
}

static void append(run *r, double seconds, double depth) {
    if (r->knots == KNOTS)
        return;
    r->knot_t[r->knots] = r->knot_t[r->knots - 1] + seconds;
    r->knot_d[r->knots++] = depth;
}

void path_wait(run *r, double seconds) {
    append(r, seconds, r->knot_d[r->knots - 1]);
}

void path_to(run *r, double depth, double speed) {
    append(r, fabs(depth - r->knot_d[r->knots - 1]) / speed, depth);
}

static double slope(const run *r, size_t k) {
    return (r->knot_d[k + 1] - r->knot_d[k]) / (r->knot_t[k + 1] - r->knot_t[k]);
}

/* Half the duration of the corner at knot k; corners do not meet. */
static double half_corner(const run *r, size_t k) {
    double before = r->knot_t[k] - r->knot_t[k - 1], after = r->knot_t[k + 1] - r->knot_t[k];
    return 0.5 * fmin(r->corner, 0.5 * fmin(before, after));
}

static bool in_corner(const run *r, size_t k, double t) {
    return k > 0 && k + 1 < r->knots && fabs(t - r->knot_t[k]) < half_corner(r, k);
}

void path_at(const run *r, double t, size_t *hint, double *d, double *v, double *a) {
    size_t low = *hint;
    while (low + 2 < r->knots && r->knot_t[low + 1] <= t)
        low++;
    *hint = low;
    *v = slope(r, low);
    *d = r->knot_d[low] + *v * (t - r->knot_t[low]);
    *a = 0;
    size_t corner = in_corner(r, low, t) ? low : in_corner(r, low + 1, t) ? low + 1 : 0;
    if (corner) { /* acceleration 1 - cos */
        double w = 2 * half_corner(r, corner), u = 0.5 + (t - r->knot_t[corner]) / w,
               turn = 6.283185307179586;
        double before = slope(r, corner - 1), change = slope(r, corner) - before;
        *d = r->knot_d[corner] + before * w * (u - 0.5) +
             change * w * (0.5 * u * u + (cos(turn * u) - 1) / (turn * turn));
        *v = before + change * (u - sin(turn * u) / turn);
        *a = change / w * (1 - cos(turn * u));
    }
}
