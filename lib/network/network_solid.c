/* network_solid.c: what makes a network an isotropic solid: the volume modulus for Poisson's ratio, and the
 * law of elements with which a mesh, evenly pressed, is neo-Hookean. Springs of one stiffness get softer
 * where that gets stiffer (doc/numerics.md). */
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>

enum { BINS = 64, STRAINS = 2 };
static const double STRAIN[STRAINS] = {0.1, 0.2}; /* at which the forces are the solid's */
static const double STRAIGHT = 0.3;               /* from which the law goes on along its tangent */

/* Elements by the square of their direction's share of the axis y, each bin with its mean. */
typedef struct even_press {
    double square[BINS], length_m[BINS]; /* length: times the factor, summed */
    double volume_m3, modulus; /* modulus: k of the volume, over the law's stiffness at rest, 1/m2 */
    double c[STRAINS];         /* the stiffness is 1 + c0 |e| + c1 e^2 of that at rest */
} even_press;

static void sort_by_direction(const palp_mesh *mesh, even_press *p) {
    *p = (even_press){.volume_m3 = mesh_volume(mesh, NULL)};
    for (size_t i = 0; i < mesh->n_elements; i++) {
        double n[3];
        const double length =
            mesh_direction(mesh, mesh->pairs + 2 * i, n) * (mesh->scale ? mesh->scale[i] : 1.0);
        const int bin = (int)fmin(n[1] * n[1] * BINS, BINS - 1);
        p->square[bin] += length * n[1] * n[1];
        p->length_m[bin] += length;
    }
    for (int i = 0; i < BINS; i++)
        p->square[i] /= p->length_m[i] > 0.0 ? p->length_m[i] : 1.0;
}

/* Forces per section, tension positive, at the stretches along and across: *aside and the returned one. */
typedef double press_at(const void *what, double along, double across, double *aside);

static double press_of_mesh(const void *what, double along, double across, double *aside) {
    const even_press *p = what;
    const double ratio = along * across * across, bulk = p->modulus * p->volume_m3 * (1.0 - 1.0 / ratio);
    double sum = bulk * across * across;
    *aside = 2.0 * bulk * across * along;
    for (int i = 0; i < BINS; i++) {
        const double stretch = sqrt(across * across + (along * along - across * across) * p->square[i]),
                     e = fabs(stretch - 1.0),
                     force =
                         p->length_m[i] * (1.0 + p->c[0] * e + p->c[1] * e * e) * (stretch - 1.0) / stretch;
        sum += force * along * p->square[i];
        *aside += force * across * (1.0 - p->square[i]);
    }
    return sum / p->volume_m3;
}

/* Neo-Hookean, (I1 J^(-2/3) - 3) / 2 + bulk (J - 1)^2 / 2 with the shear modulus 1. */
static double press_of_solid(const void *what, double along, double across, double *aside) {
    const double bulk = *(const double *)what, ratio = along * across * across, keep = pow(ratio, -2.0 / 3.0),
                 squares = along * along + 2.0 * across * across,
                 by_ratio = bulk * (ratio - 1.0) - keep * squares / (3.0 * ratio);
    *aside = 2.0 * (keep * across + by_ratio * across * along);
    return keep * along + by_ratio * across * across;
}

/* The force along an axis of what is free across it. */
static double free_press(press_at *at, const void *what, double along) {
    enum { HALVES = 50 };
    const double even = 1.0 / sqrt(along); /* keeps the volume */
    double low = fmin(1.0, even), high = fmax(1.0, even), aside;
    for (int i = 0; i < HALVES; i++) {
        const double middle = 0.5 * (low + high);
        at(what, along, middle, &aside);
        if (aside > 0.0)
            high = middle;
        else
            low = middle;
    }
    return at(what, along, 0.5 * (low + high), &aside);
}

static double stiffness_at_rest(press_at *at, const void *what) {
    const double small = 1e-4;
    return 0.5 * (free_press(at, what, 1.0 + small) - free_press(at, what, 1.0 - small)) / small;
}

/* Newton's method for c; false if it fails. */
static bool fit_solid(even_press *p, double bulk) {
    enum { ROUNDS = 20 };
    const double change = 1e-4, solid_rest = stiffness_at_rest(press_of_solid, &bulk),
                 rest = stiffness_at_rest(press_of_mesh, p);
    for (int round = 0; round < ROUNDS; round++) {
        double off[STRAINS], slope[STRAINS][STRAINS];
        for (int i = 0; i < STRAINS; i++) {
            const double along = 1.0 - STRAIN[i], now = free_press(press_of_mesh, p, along);
            off[i] = now / rest - free_press(press_of_solid, &bulk, along) / solid_rest;
            for (int k = 0; k < STRAINS; k++) {
                even_press other = *p;
                other.c[k] += change;
                slope[i][k] = (free_press(press_of_mesh, &other, along) - now) / (change * rest);
            }
        }
        const double det = slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
        const double step[STRAINS] = {(slope[1][1] * off[0] - slope[0][1] * off[1]) / det,
                                      (slope[0][0] * off[1] - slope[1][0] * off[0]) / det};
        if (!isfinite(step[0]) || !isfinite(step[1]))
            return false;
        p->c[0] -= step[0];
        p->c[1] -= step[1];
        if (fabs(step[0]) + fabs(step[1]) < 1e-6)
            return true;
    }
    return false;
}

palp_status palp_law_of_solid(const palp_mesh *mesh, double poisson_ratio, double young_Pa, palp_law *law) {
    if (!mesh || !law || !(poisson_ratio >= 0.25 && poisson_ratio < 0.5) || !(young_Pa > 0.0) ||
        !isfinite(young_Pa))
        return PALP_ERR_ARGUMENT;
    even_press press;
    sort_by_direction(mesh, &press);
    double length = 0.0;
    for (int i = 0; i < BINS; i++)
        length += press.length_m[i];
    if (!(press.volume_m3 > 0.0) || !(length > 0.0))
        return PALP_ERR_UNSUPPORTED;
    const double shear = 0.4 * length / (6.0 * press.volume_m3); /* of springs of 1 N */
    press.modulus = shear * (4.0 * poisson_ratio - 1.0) / (1.0 - 2.0 * poisson_ratio);
    if (!fit_solid(&press, 2.0 * (1.0 + poisson_ratio) / (3.0 * (1.0 - 2.0 * poisson_ratio))))
        return PALP_ERR_NOT_CONVERGED;
    const double rest = 0.5 * young_Pa / (1.0 + poisson_ratio) / shear;
    palp_status status = palp_law_polynomial(3, (double[]){rest, rest * press.c[0], rest * press.c[1]}, law);
    return status ? status : palp_law_limit(law, STRAIGHT);
}

/* A network of central springs has lambda = mu = 2/5 E, E its Young's modulus. What the volume adds to lambda
 * makes Poisson's ratio lambda / (2 (lambda + mu)) the wanted one. */
double network_volume_share(const palp_network_settings *s, double ratio) {
    const double wanted = ratio > 0.0 ? ratio : s->poisson_ratio;
    return s->volume_modulus_Pa > 0.0 ? 1.0
           : wanted > 0.0             ? 0.4 * (4.0 * wanted - 1.0) / (1.0 - 2.0 * wanted)
                                      : 0.0;
}

bool network_wants_volume(const palp_network_settings *s) {
    bool wants = s->volume_modulus_Pa > 0.0 || s->poisson_ratio > 0.0;
    for (size_t r = 0; r < s->n_regions; r++)
        wants = wants || s->regions[r].poisson_ratio > 0.0;
    return wants;
}
