/* cut_blade.c: which elements cross a triangle. A node exactly on the blade counts as shifted by an
 * infinitesimal step in one fixed direction (simulation of simplicity, Edelsbrunner and Muecke 1990). It is
 * then on the same side for every element that meets in it and for both triangles of a sweep. The order of
 * corners and ends makes no difference. */
#include "cut_internal.h"

#include <math.h>

/* 1, 1/p and 1/p^2 with p^3 = p + 1: not at right angles to any lattice direction. */
static const double SHIFT[3] = {1.0, 0.7548776662466927, 0.5698402909980532};
static const double ROUNDING =
    1e-14; /* relative to the sum of its terms' sizes: below it a determinant counts as 0 */

static void subtract_vectors(const double *a, const double *b, double out[3]) {
    for (size_t k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* a . (b x c), and the sum of the absolute values of its terms. */
static double determinant_with_size(const double a[3], const double b[3], const double c[3], double *size) {
    double sum = 0.0;
    *size = 0.0;
    for (size_t i = 0; i < 3; i++) {
        size_t j = (i + 1) % 3, k = (i + 2) % 3;
        double p = a[i] * b[j] * c[k], q = a[i] * b[k] * c[j];
        sum += p - q;
        *size += fabs(p) + fabs(q);
    }
    return sum;
}

static int sign_of_number(double value) {
    return (value > 0.0) - (value < 0.0);
}

/* Side of node x of the plane through a with edges u and v: +1 or -1; 0 for a degenerate triangle. */
static int side_of_blade_plane(const double *x, const double *a, const double u[3], const double v[3]) {
    double w[3], size;
    subtract_vectors(x, a, w);
    double d = determinant_with_size(w, u, v, &size);
    if (fabs(d) > ROUNDING * size)
        return sign_of_number(d);
    d = determinant_with_size(SHIFT, u, v, &size);
    return fabs(d) > ROUNDING * size ? sign_of_number(d) : 0;
}

/* Does the line p -> q pass the edge a -> b on its left (+1) or right (-1)? */
static int side_passed_by_line(const double *p, const double *q, const double *a, const double *b) {
    double along[3], to_a[3], to_b[3], size, size_b;
    subtract_vectors(q, p, along);
    subtract_vectors(a, p, to_a);
    subtract_vectors(b, p, to_b);
    double d = determinant_with_size(along, to_a, to_b, &size);
    if (fabs(d) > ROUNDING * size)
        return sign_of_number(d);
    d = determinant_with_size(along, to_a, SHIFT, &size) + determinant_with_size(along, SHIFT, to_b, &size_b);
    return fabs(d) > ROUNDING * (size + size_b) ? -sign_of_number(d) : 0;
}

/* The same for the edge between corners i and j. The edge has one orientation, so that both triangles of a
 * sweep get the same number. */
static int side_of_edge_passed(const double *p, const double *q, const double *corners, size_t i, size_t j) {
    const double *a = corners + 3 * i, *b = corners + 3 * j;
    bool swap = a[0] != b[0] ? a[0] > b[0] : a[1] != b[1] ? a[1] > b[1] : a[2] > b[2];
    return swap ? -side_passed_by_line(p, q, b, a) : side_passed_by_line(p, q, a, b);
}

bool cut_crosses(const double *p, const double *q, const double *corners) {
    int first = side_of_edge_passed(p, q, corners, 0, 1);
    return first != 0 && side_of_edge_passed(p, q, corners, 1, 2) == first &&
           side_of_edge_passed(p, q, corners, 2, 0) == first;
}

void cut_sides(size_t n, const double *x, const double corners[9], signed char *side) {
    double u[3], v[3];
    subtract_vectors(corners + 3, corners, u);
    subtract_vectors(corners + 6, corners, v);
    for (size_t i = 0; i < n; i++)
        side[i] = (signed char)side_of_blade_plane(x + 3 * i, corners, u, v);
}
