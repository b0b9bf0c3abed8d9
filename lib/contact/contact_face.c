/* contact_face.c: a fixed point of a triangle in a sphere or capsule: its depth along the triangle's normal,
 * and how it gives way by what the mesh lacks of the tissue below. */
#include "contact_internal.h"

#include <string.h>

static const double ROUND = 0.8; /* of a sphere's radius: further from its middle it counts as a paraboloid */

/* Outward unit normal of the triangle, and gradients of its shares. */
static void measure_triangle(const double *const corner[3], struct contact_face *f) {
    double ab[3], ac[3];
    along3(corner[1], -1.0, corner[0], ab);
    along3(corner[2], -1.0, corner[0], ac);
    cross3(ab, ac, f->outward);
    const double area = sqrt(dot3(f->outward, f->outward));
    for (int k = 0; k < 3; k++)
        f->outward[k] /= area;
    for (int i = 0; i < 3; i++) {
        double opposite[3];
        along3(corner[(i + 2) % 3], -1.0, corner[(i + 1) % 3], opposite);
        cross3(f->outward, opposite, f->gradient[i]);
        for (int k = 0; k < 3; k++)
            f->gradient[i][k] /= area;
    }
}

/* The depth is along the normal n of the triangle: u = g(q) - z, z the height of the sphere's centre over the
 * plane, v from the centre to the point, q = v v - z^2 the square of its way aside, g = sqrt(r^2 - q). With
 * the shares s of the point and t of the centre's foot, d u / d x_i = 2 g' s_i v + (1 + 2 g' z) t_i n. */
void contact_face_measure(const palp_tool *tool, contact *c, const double *x) {
    contact_point(c, c->share, x, c->point);
    struct contact_face *f = &c->face;
    const double *corner[3] = {x + 3 * c->node[0], x + 3 * c->node[1], x + 3 * c->node[2]};
    double centre[3];
    along3(tool->position_m, c->along, tool->axis, centre);
    along3(c->point, -1.0, centre, f->away);
    measure_triangle(corner, f);
    const double z = c->distance = -dot3(f->away, f->outward), q = dot3(f->away, f->away) - z * z,
                 square = tool->radius_m * tool->radius_m, flat = fmin(q, ROUND * ROUND * square),
                 height = sqrt(square - flat);
    f->across = -1.0 / height;
    f->along = 1.0 + f->across * z;
    f->bend = q > flat ? 0.0 : -0.25 / (height * height * height);
    c->depth = height + 0.5 * f->across * (q - flat) - z + c->early;
    for (int i = 0; i < 3; i++)
        f->foot[i] = c->share[i] - dot3(f->away, f->gradient[i]);
    for (int k = 0; k < 3; k++)
        c->normal[k] = -f->across * f->away[k] - f->along * f->outward[k];
    f->size = sqrt(dot3(c->normal, c->normal));
    for (int k = 0; k < 3; k++)
        c->normal[k] /= f->size;
}

/* ---- forces -------------------------------------------------------------------------------------- */

/* The law's force at the depth u, or its first or second integral. */
static double law_integral(const contact_law *law, int integrals, double u) {
    static const double ROOT[] = {1.0, 2.0 / 3.0, 4.0 / 15.0}, LINEAR[] = {1.0, 1.0 / 2.0, 1.0 / 6.0},
                        STEEPER[] = {1.0, 2.0 / 5.0, 4.0 / 35.0};
    if (!(u > 0.0))
        return 0.0;
    const double root = sqrt(u), beyond = fmax(u - law->limit, 0.0);
    const double sum = ROOT[integrals] * law->root * root + LINEAR[integrals] * law->linear * u +
                       STEEPER[integrals] * law->steep * u * root;
    return pow(u, integrals) * sum + LINEAR[integrals] * law->hard * pow(beyond, integrals + 1);
}

/* The law's mean over the depths within smoothing: its slope (0 integrals), force (1) or energy (2). */
static double smoothed_law(const contact_set *set, const contact *c, int integrals) {
    const double smooth = set->settings.smoothing * set->edge;
    return (law_integral(&c->law, integrals, c->depth) -
            law_integral(&c->law, integrals, c->depth - smooth)) /
           smooth;
}

double contact_face_energy(const contact_set *set, const contact *c) {
    return smoothed_law(set, c, 2);
}

/* d u / d x_i of a triangle's contact. */
static void deepening(const contact *c, int i, double to[3]) {
    const struct contact_face *f = &c->face;
    for (int k = 0; k < 3; k++)
        to[k] = f->across * c->share[i] * f->away[k] + f->along * f->foot[i] * f->outward[k];
}

void contact_face_push(const contact *c, int i, double force[3]) {
    deepening(c, i, force);
    for (int k = 0; k < 3; k++)
        force[k] *= -c->pressure;
}

double contact_face_pressure(const contact_set *set, contact *c) {
    c->pressure = smoothed_law(set, c, 1);
    c->face.slope = smoothed_law(set, c, 0);
    return c->face.slope;
}

/* Tangent of a triangle's pressure: slope u_a u_b' + pressure u_ab, with d q / d x_a = 2 s_a v + 2 z t_a n
 * and d(t_a n) / d x_b = z (g_a g_b) n n' - t_b n g_a' - t_a g_b n', g the gradients of the shares. */
void contact_face_block(const contact *c, int a, int b, double k[9]) {
    const struct contact_face *f = &c->face;
    const double *n = f->outward, *ga = f->gradient[a], *gb = f->gradient[b], s = c->share[a] * c->share[b],
                 ta = f->foot[a], tb = f->foot[b], z = c->distance, p = c->pressure;
    double ua[3], ub[3], qa[3], qb[3];
    deepening(c, a, ua);
    deepening(c, b, ub);
    for (int i = 0; i < 3; i++) {
        qa[i] = 2.0 * (c->share[a] * f->away[i] + z * ta * n[i]);
        qb[i] = 2.0 * (c->share[b] * f->away[i] + z * tb * n[i]);
    }
    const double normal = f->along * z * dot3(ga, gb) - f->across * ta * tb;
    for (int i = 0; i < 9; i++) {
        const int row = i / 3, col = i % 3;
        k[i] += f->slope * ua[row] * ub[col] +
                p * (f->bend * qa[row] * qb[col] + (row == col ? f->across * s : 0.0) +
                     normal * n[row] * n[col] - f->along * (tb * n[row] * ga[col] + ta * gb[row] * n[col]));
    }
}

/* ---- what gives way ------------------------------------------------------------------------------ */

/* Young's modulus times the area of a triangle over its spacing, and the mean stiffness of the parts of its
 * nodes: 2.134 K and 2.561 K per spacing for cells scaled as a solid (doc/numerics.md). */
static const double SOLID = 2.134 / 2.561;
static const double FLAT = 16.0 / 15.0; /* 1 / (1 - nu^2), as central forces have it */

/* What a triangle's point of this stiffness E A / h, N/m, gives way below a sphere of this radius: what the
 * mesh of the spacing h lacks of Hertz's solid, to half the radius; beyond that it is hard, so that no tool
 * sinks in. even: 1 less the squares of the point's shares. Constants by data/contact/local_law.py. */
static contact_law local_law(double stiffness, double radius, double spacing, double even, double hard) {
    return (contact_law){.root = FLAT / acos(-1.0) * stiffness * spacing / sqrt(radius),
                         .linear = (2.0 - 1.5 * even) * stiffness,
                         .steep = (6.5 - 9.0 * even) * stiffness * sqrt(radius) / spacing,
                         .hard = hard * stiffness * fmax(1.0, spacing * spacing / (radius * radius)),
                         .limit = 0.5 * radius};
}

/* Stiffness of friction's spring: that of the law where it has given a sixteenth of this length, m. */
static double stiffness_of_law(const contact_law *law, double length) {
    const double root = sqrt(length / 16.0);
    return law->root / root + law->linear + law->steep * root;
}

void contact_face_law(const contact_set *set, const palp_tool *tool, double stiffness, double spacing,
                      contact *c) {
    c->law = local_law(SOLID * stiffness, tool->radius_m, spacing, 1.0 - dot3(c->share, c->share),
                       set->settings.stiffness);
    c->stiffness = stiffness_of_law(&c->law, fmin(spacing, tool->radius_m));
}
