/* indentation.c: contact of a rigid tip and an elastic layer. The Hankel transform of the pressure p(r) is
 * P(x) = int_0^a phi(t) cos(x t) dt. The dual integral equations become, for t from 0 to a,
 *   phi(t) - (2 / pi) int_0^a phi(s) int_0^inf M(x h) cos(x t) cos(x s) dx ds
 *     = 2 G / (pi (1 - nu)) (depth - g(t)).
 * 1 - M is the layer's compliance over the half-space's. The tip's profile f gives
 * g(t) = t int_0^t f'(r) / sqrt(t^2 - r^2) dr. Force = 2 pi int phi dt. Where the profile is smooth at the
 * edge of contact, phi(a) = 0. */
#include <palpate/indentation.h>

#include "base/dense.h"
#include "indentation_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum {
    NODES = 32,  /* of Gauss' rule over the contact radius */
    PANELS = 32, /* of wave numbers, with PANEL_NODES each */
    PANEL_NODES = 8,
    WAVES = PANELS * PANEL_NODES,
    CURVE = 32 /* contact radii between which a curved tip's force is interpolated */
};
static const double WAVE_MAX = 20.0; /* times h: M is below 1e-13 beyond it */

static const char *const names[] = {"plate", "flat", "sphere", "cone"};

const char *palp_tip_name(palp_tip_kind kind) {
    return kind >= PALP_TIP_PLATE && kind <= PALP_TIP_CONE ? names[kind] : NULL;
}

bool palp_tip_find(const char *name, palp_tip_kind *kind) {
    for (int i = PALP_TIP_PLATE; name && kind && i <= PALP_TIP_CONE; i++)
        if (strcmp(name, names[i]) == 0) {
            *kind = (palp_tip_kind)i;
            return true;
        }
    return false;
}

/* Gauss' rule on 0 to 1. */
static void gauss_legendre_rule(size_t n, double *x, double *w) {
    for (size_t i = 0; i < n; i++) {
        double z = cos(PI * ((double)i + 0.75) / ((double)n + 0.5)), slope = 1;
        for (int again = 0; again < 8; again++) {
            double p = 1, before = 0;
            for (size_t j = 0; j < n; j++) {
                double next = ((2.0 * (double)j + 1.0) * z * p - (double)j * before) / ((double)j + 1.0);
                before = p;
                p = next;
            }
            slope = (double)n * (z * p - before) / (z * z - 1.0);
            z -= p / slope;
        }
        x[i] = 0.5 * (1.0 - z);
        w[i] = 1.0 / ((1.0 - z * z) * slope * slope);
    }
}

/* M at a wave number times h: 1 - compliance of the layer over that of the half-space. */
static double layer_softness_kernel(double u, double poisson, bool slides) {
    double kappa = 3.0 - 4.0 * poisson, e2 = exp(-2.0 * u), e4 = e2 * e2;
    if (slides)
        return (2.0 * e2 * (1.0 + 2.0 * u) - 2.0 * e4) / (1.0 - e4 + 4.0 * u * e2);
    double coupled = (1.0 + kappa * kappa + 4.0 * u * u) * e2;
    return (2.0 * kappa * e4 + coupled + 4.0 * u * e2) / (kappa * (1.0 + e4) + coupled);
}

/* What does not depend on the contact radius. */
typedef struct layer {
    double x[NODES], w[NODES];          /* of the contact, 0 to 1 */
    double wave[WAVES], weight[WAVES];  /* wave numbers times h; Gauss' weight times M */
    double cosine[(NODES + 1) * WAVES]; /* work array: of the nodes and of the edge */
    double kernel[(NODES + 1) * NODES], system[NODES * NODES], edge[NODES];
    double solution[2 * NODES]; /* for a depth of 1, and for the profile */
} layer;

static void prepare_layer_quadrature(layer *l, const palp_indentation *in) {
    double x[PANEL_NODES], w[PANEL_NODES], width = WAVE_MAX / PANELS;
    gauss_legendre_rule(NODES, l->x, l->w);
    gauss_legendre_rule(PANEL_NODES, x, w);
    for (size_t q = 0; q < WAVES; q++) {
        l->wave[q] = width * ((double)(q / PANEL_NODES) + x[q % PANEL_NODES]);
        l->weight[q] =
            width * w[q % PANEL_NODES] * layer_softness_kernel(l->wave[q], in->poisson, in->floor_slides);
    }
}

/* g(t) of the tip's profile. */
static double tip_profile_transform(const palp_indentation *in, double t) {
    if (in->tip == PALP_TIP_SPHERE)
        return t * atanh(t / in->radius_m);
    return in->tip == PALP_TIP_CONE ? 0.5 * PI * t / tan(in->half_angle_rad) : 0.0;
}

/* Cholesky factor of the system for a contact of a / h = ratio. The kernel is a product of cosines, each
 * with the root of its weight, which is not negative. Unknowns are multiplied by the roots of their
 * weights too. */
static bool factor_contact_kernel(layer *l, double ratio) {
    for (size_t i = 0; i <= NODES; i++)
        for (size_t q = 0; q < WAVES; q++)
            l->cosine[i * WAVES + q] =
                sqrt(l->weight[q]) * cos(ratio * l->wave[q] * (i < NODES ? l->x[i] : 1.0));
    dense_transposed_product(NODES + 1, NODES, WAVES, l->cosine, l->cosine, l->kernel);
    for (size_t j = 0; j < NODES; j++) {
        const double *column = &l->kernel[j * (NODES + 1)];
        l->edge[j] = 2.0 / PI * ratio * column[NODES];
        for (size_t i = 0; i < NODES; i++)
            l->system[j * NODES + i] = (i == j) - 2.0 / PI * ratio * sqrt(l->w[i] * l->w[j]) * column[i];
    }
    return dense_cholesky(NODES, l->system);
}

/* A contact of radius a: depth, force over G, and the slope of force over depth, which is that of a flat
 * punch of this radius. */
typedef struct contact {
    double depth_m, force_m2, slope_m;
} contact;

static palp_status solve_contact_of_radius(layer *l, const palp_indentation *in, double a, contact *c);

/* What a specimen yields as a whole for lack of the tissue around it. Under a curved tip that is, per force,
 * what it is under a flat punch as wide as the contact, or as the tables' smallest: it hardly depends on how
 * the pressure is spread. */
static palp_status add_narrowness(layer *l, const palp_indentation *in, double a, contact *c) {
    palp_indentation flat = {.tip = PALP_TIP_FLAT,
                             .radius_m = fmax(a, indentation_smallest_punch(in)),
                             .thickness_m = in->thickness_m,
                             .poisson = in->poisson};
    contact wide = {0, 0, 0};
    palp_status status = solve_contact_of_radius(l, &flat, flat.radius_m, &wide);
    flat.specimen_radius_m = in->specimen_radius_m;
    if (!status)
        status = indentation_factor_check(&flat, 0.0);
    if (status)
        return status;
    double more = (1.0 / indentation_factor(&flat, 0.0) - 1.0) / wide.slope_m;
    c->depth_m += more * c->force_m2;
    c->slope_m /= 1.0 + more * c->slope_m;
    return PALP_OK;
}

static palp_status solve_contact_of_radius(layer *l, const palp_indentation *in, double a, contact *c) {
    double *one = l->solution, *shape = one + NODES, sum[2] = {0, 0},
           edge[2] = {1.0, tip_profile_transform(in, a)};
    if (!(a / in->thickness_m <= PALP_INDENTATION_WIDEST))
        return PALP_ERR_LIMIT;
    if (!factor_contact_kernel(l, a / in->thickness_m))
        return PALP_ERR_SINGULAR;
    for (size_t i = 0; i < NODES; i++) {
        one[i] = sqrt(l->w[i]);
        shape[i] = sqrt(l->w[i]) * tip_profile_transform(in, a * l->x[i]);
    }
    dense_cholesky_solve(NODES, l->system, 2, l->solution);
    for (size_t i = 0; i < 2 * NODES; i++) {
        double weighted = sqrt(l->w[i % NODES]) * l->solution[i];
        sum[i / NODES] += weighted;
        edge[i / NODES] += l->edge[i % NODES] * weighted;
    }
    double stiff = 4.0 * a / (1.0 - in->poisson);
    c->depth_m = edge[1] / edge[0];
    c->slope_m = stiff * sum[0];
    c->force_m2 = stiff * (c->depth_m * sum[0] - sum[1]);
    if (in->specimen_radius_m > 0 && in->tip != PALP_TIP_FLAT)
        return add_narrowness(l, in, a, c);
    return PALP_OK;
}

/* ---- curved tips: force by depth ---- */

/* A contact radius whose depth is depth_m or a little more. */
static palp_status find_widest_contact_radius(layer *l, const palp_indentation *in, double depth_m,
                                              double *a) {
    contact c = {0, 0, 0};
    double limit = in->tip == PALP_TIP_SPHERE ? in->radius_m : HUGE_VAL;
    palp_status status = PALP_OK;
    *a = in->tip == PALP_TIP_SPHERE ? sqrt(in->radius_m * depth_m)
                                    : 2.0 / PI * depth_m * tan(in->half_angle_rad);
    *a = *a < 0.9 * limit ? *a : 0.9 * limit;
    while (!status && !((status = solve_contact_of_radius(l, in, *a, &c)) || c.depth_m >= depth_m))
        *a = 1.05 * *a < limit ? 1.05 * *a : 0.5 * (*a + limit);
    return status;
}

/* The last point of the curve at or before a depth. */
static size_t find_curve_interval(const contact *c, double depth_m) {
    size_t low = 0, high = CURVE;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (c[middle].depth_m <= depth_m)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Hermite's cubic between two points; below the first point the half-space's power of depth. */
static double interpolate_contact_curve(const contact *c, double depth_m, double power) {
    if (depth_m <= c[0].depth_m)
        return c[0].force_m2 * pow(depth_m / c[0].depth_m, power);
    size_t i = find_curve_interval(c, depth_m);
    double step = c[i + 1].depth_m - c[i].depth_m, s = (depth_m - c[i].depth_m) / step, r = 1.0 - s;
    return r * r * ((1.0 + 2.0 * s) * c[i].force_m2 + s * step * c[i].slope_m) +
           s * s * ((1.0 + 2.0 * r) * c[i + 1].force_m2 - r * step * c[i + 1].slope_m);
}

static palp_status force_of_curved_tip(layer *l, const palp_indentation *in, size_t n, const double *depth_m,
                                       double *force_m2) {
    contact c[CURVE + 1];
    double deepest = 0, a = 0;
    for (size_t i = 0; i < n; i++)
        deepest = fmax(deepest, depth_m[i]);
    palp_status status = deepest > 0 ? find_widest_contact_radius(l, in, deepest, &a) : PALP_OK;
    for (size_t i = 0; deepest > 0 && !status && i <= CURVE; i++) {
        double part = ((double)i + 1.0) / (CURVE + 1.0);
        status = solve_contact_of_radius(l, in, a * part * part, &c[i]);
    }
    for (size_t i = 0; !status && i < n; i++)
        force_m2[i] = depth_m[i] > 0
                          ? indentation_factor(in, depth_m[i]) *
                                interpolate_contact_curve(c, depth_m[i], in->tip == PALP_TIP_CONE ? 2.0 : 1.5)
                          : 0.0;
    return status;
}

static bool is_indentation_valid(const palp_indentation *in) {
    if (!in || !palp_tip_name(in->tip) || !(in->thickness_m > 0) || !(in->poisson > -1.0) ||
        !(in->poisson <= 0.5))
        return false;
    if (in->tip == PALP_TIP_CONE)
        return in->half_angle_rad > 0 && in->half_angle_rad < 0.5 * PI;
    if (!(in->specimen_radius_m >= 0) || !isfinite(in->specimen_radius_m))
        return false;
    return in->radius_m > 0 && isfinite(in->radius_m) &&
           (in->tip != PALP_TIP_PLATE || isfinite(in->thickness_m));
}

/* Force over depth of a plate or of a flat punch. */
static palp_status stiffness_of_flat_tip(layer *l, const palp_indentation *in, double *slope_m) {
    contact c = {0, 0, 0};
    palp_status status = PALP_OK;
    if (in->tip == PALP_TIP_PLATE)
        c.slope_m = 2.0 * (1.0 + in->poisson) * PI * in->radius_m * in->radius_m / in->thickness_m;
    else
        status = solve_contact_of_radius(l, in, in->radius_m, &c);
    *slope_m = c.slope_m;
    return status;
}

palp_status palp_indentation_force(const palp_indentation *in, size_t n, const double *depth_m,
                                   double *force_m2) {
    bool fine = is_indentation_valid(in) && (n == 0 || (depth_m && force_m2));
    for (size_t i = 0; fine && i < n; i++)
        fine = isfinite(depth_m[i]);
    if (!fine)
        return PALP_ERR_ARGUMENT;
    double deepest = 0;
    for (size_t i = 0; i < n; i++)
        deepest = fmax(deepest, depth_m[i]);
    palp_status status = indentation_factor_check(in, deepest);
    layer *l = status ? NULL : malloc(sizeof *l);
    if (status)
        return status;
    if (!l)
        return PALP_ERR_NO_MEMORY;
    prepare_layer_quadrature(l, in);
    double slope = 0;
    if (in->tip == PALP_TIP_SPHERE || in->tip == PALP_TIP_CONE)
        status = force_of_curved_tip(l, in, n, depth_m, force_m2);
    else if (!(status = stiffness_of_flat_tip(l, in, &slope)))
        for (size_t i = 0; i < n; i++)
            force_m2[i] = depth_m[i] > 0 ? slope * indentation_factor(in, depth_m[i]) * depth_m[i] : 0.0;
    free(l);
    return status;
}

palp_status palp_indentation_contact(const palp_indentation *in, double depth_m, double *contact_m) {
    if (!is_indentation_valid(in) || !isfinite(depth_m) || !contact_m)
        return PALP_ERR_ARGUMENT;
    *contact_m = depth_m > 0 ? in->radius_m : 0.0;
    if (depth_m <= 0 || in->tip == PALP_TIP_PLATE || in->tip == PALP_TIP_FLAT)
        return PALP_OK;
    layer *l = malloc(sizeof *l);
    if (!l)
        return PALP_ERR_NO_MEMORY;
    prepare_layer_quadrature(l, in);
    double high = 0, low = 0;
    contact c = {0, 0, 0};
    palp_status status = find_widest_contact_radius(l, in, depth_m, &high);
    for (int i = 0; !status && i < 40; i++) {
        double middle = 0.5 * (low + high);
        status = solve_contact_of_radius(l, in, middle, &c);
        *(c.depth_m < depth_m ? &low : &high) = middle;
    }
    *contact_m = high;
    free(l);
    return status;
}
