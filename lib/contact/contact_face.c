/* contact_face.c: a fixed point of a triangle in a sphere or capsule: its depth along the triangle's normal,
 * and the local compliance that the mesh lacks. */
#include "contact_internal.h"

#include <string.h>

static const double ROUND = 0.8; /* of a sphere's radius: further from its middle it counts as a paraboloid */

void contact_plane_at(const int32_t node[3], const double *x, contact_plane *plane) {
    if (memcmp(plane->node, node, sizeof plane->node) == 0)
        return;
    const double *corner[3] = {x + 3 * node[0], x + 3 * node[1], x + 3 * node[2]};
    memcpy(plane->node, node, sizeof plane->node);
    triangle_normal(corner[0], corner[1], corner[2], plane->outward);
    const double area = sqrt(dot3(plane->outward, plane->outward));
    for (int k = 0; k < 3; k++)
        plane->outward[k] /= area;
    for (int i = 0; i < 3; i++) {
        double opposite[3];
        along3(corner[(i + 2) % 3], -1.0, corner[(i + 1) % 3], opposite);
        cross3(plane->outward, opposite, plane->gradient[i]);
        for (int k = 0; k < 3; k++)
            plane->gradient[i][k] /= area;
    }
}

/* The depth is along the normal n of the triangle: u = g(q) - z, with z the height of the sphere's centre
 * over the plane. v leads from the centre to the point; q = v v - z^2 is the squared distance of the point
 * from the normal through the centre; g = sqrt(r^2 - q). With the shares s of the point and t of the centre's
 * foot, d u / d x_i = 2 g' s_i v + (1 + 2 g' z) t_i n. */
void contact_dip_at(const palp_tool *tool, double along, const contact_plane *plane, const double point[3],
                    contact_dip *dip) {
    double centre[3];
    along3(tool->position_m, along, tool->axis, centre);
    along3(point, -1.0, centre, dip->away);
    const double z = -dot3(dip->away, plane->outward), q = dot3(dip->away, dip->away) - z * z,
                 square = tool->radius_m * tool->radius_m, flat = fmin(q, ROUND * ROUND * square),
                 height = sqrt(square - flat);
    dip->height = z;
    dip->across = -1.0 / height;
    dip->along = 1.0 + dip->across * z;
    dip->bend = q > flat ? 0.0 : -0.25 / (height * height * height);
    dip->depth = height + 0.5 * dip->across * (q - flat) - z;
}

double contact_foot(const contact_plane *plane, const contact_dip *dip, int i, double share) {
    return share - dot3(dip->away, plane->gradient[i]);
}

void contact_face_measure(const palp_tool *tool, contact *c, const double *x, contact_plane *plane) {
    struct contact_face *f = &c->face;
    double point[3];
    contact_dip dip;
    contact_point(c, c->share, x, point);
    contact_plane_at(c->node, x, plane);
    contact_dip_at(tool, c->along, plane, point, &dip);
    c->distance = dip.height;
    c->depth = dip.depth + c->early;
    if (!(c->depth > 0.0))
        return;
    memcpy(c->point, point, sizeof point);
    f->plane = *plane;
    f->dip = dip;
    for (int i = 0; i < 3; i++)
        f->foot[i] = contact_foot(plane, &dip, i, c->share[i]);
    for (int k = 0; k < 3; k++)
        c->normal[k] = -dip.across * dip.away[k] - dip.along * plane->outward[k];
    f->size = sqrt(dot3(c->normal, c->normal));
    for (int k = 0; k < 3; k++)
        c->normal[k] /= f->size;
}

/* ---- forces -------------------------------------------------------------------------------------- */

/* The law's force at the depth u, or its first or second integral. */
static double law_integral(const contact_law *law, int integrals, double u) {
    static const double ROOT[] = {1.0, 2.0 / 3.0, 4.0 / 15.0}, LINEAR[] = {1.0, 1.0 / 2.0, 1.0 / 6.0},
                        STEEPER[] = {1.0, 2.0 / 5.0, 4.0 / 35.0}, SQUARE[] = {1.0, 1.0 / 3.0, 1.0 / 12.0},
                        STEEPEST[] = {1.0, 2.0 / 7.0, 4.0 / 63.0};
    if (!(u > 0.0))
        return 0.0;
    const double root = sqrt(u), beyond = fmax(u - law->limit, 0.0), more = law->stiffening;
    double sum = ROOT[integrals] * law->root * root +
                 u * (LINEAR[integrals] * law->linear +
                      STEEPER[integrals] * (law->steep + more * law->root) * root +
                      more * u * (SQUARE[integrals] * law->linear + STEEPEST[integrals] * law->steep * root)),
           hard = LINEAR[integrals] * law->hard * beyond;
    for (int i = 0; i < integrals; i++) {
        sum *= u;
        hard *= beyond;
    }
    return sum + hard;
}

/* The law's mean over the depths within smoothing: its slope (0 integrals), force (1) or energy (2). */
static double smoothed_law(const contact_set *set, const contact *c, int integrals, double depth) {
    const double smooth = set->settings.smoothing * set->edge;
    return (law_integral(&c->law, integrals, depth) - law_integral(&c->law, integrals, depth - smooth)) /
           smooth;
}

double contact_face_energy(const contact_set *set, const contact *c, double depth) {
    return smoothed_law(set, c, 2, depth);
}

double contact_face_elastic(const contact_set *set, const contact *c, double depth, double *slope) {
    *slope = smoothed_law(set, c, 0, depth);
    return smoothed_law(set, c, 1, depth);
}

void contact_face_slopes(contact *c, double slope) {
    struct contact_face *f = &c->face;
    f->slope = slope;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            f->deepening[i][k] = f->dip.across * c->share[i] * f->dip.away[k] +
                                 f->dip.along * f->foot[i] * f->plane.outward[k];
            f->widening[i][k] =
                2.0 * (c->share[i] * f->dip.away[k] + c->distance * f->foot[i] * f->plane.outward[k]);
        }
}

void contact_face_push(const contact *c, int i, double force[3]) {
    for (int k = 0; k < 3; k++)
        force[k] = -c->pressure * c->face.deepening[i][k];
}

/* Tangent of a triangle's pressure: slope u_a u_b' + pressure u_ab, with d q / d x_a = 2 s_a v + 2 z t_a n;
 * d(t_a n) / d x_b = z (g_a g_b) n n' - t_b n g_a' - t_a g_b n'; g the gradients of the shares. */
void contact_face_block(const contact *c, int a, int b, double k[9]) {
    const struct contact_face *f = &c->face;
    const double *n = f->plane.outward, *ga = f->plane.gradient[a], *gb = f->plane.gradient[b],
                 p = c->pressure, ta = p * f->dip.along * f->foot[a], tb = p * f->dip.along * f->foot[b],
                 bend = p * f->dip.bend, same = p * f->dip.across * c->share[a] * c->share[b],
                 normal = p * (f->dip.along * c->distance * dot3(ga, gb) -
                               f->dip.across * f->foot[a] * f->foot[b]);
    for (int row = 0, i = 0; row < 3; row++) {
        const double u = f->slope * f->deepening[a][row], q = bend * f->widening[a][row], g = ta * gb[row];
        k[4 * row] += same;
        for (int col = 0; col < 3; col++, i++)
            k[i] += u * f->deepening[b][col] + q * f->widening[b][col] +
                    n[row] * (normal * n[col] - tb * ga[col]) - g * n[col];
    }
}

/* The same, of all corners at once. */
void contact_face_times(const contact *c, const double *u, double *out) {
    const struct contact_face *f = &c->face;
    const double *n = f->plane.outward, p = c->pressure;
    double deeper = 0.0, wider = 0.0, foot[3] = {0.0}, at_point[3], turn[3] = {0.0};
    contact_point(c, c->share, u, at_point);
    for (int b = 0; b < 3; b++) {
        const double *ub = u + 3 * c->node[b];
        deeper += dot3(f->deepening[b], ub);
        wider += dot3(f->widening[b], ub);
        along3(foot, f->foot[b], ub, foot);
        along3(turn, dot3(n, ub), f->plane.gradient[b], turn);
    }
    for (int a = 0; a < 3; a++) {
        double *o = out + 3 * c->node[a];
        const double normal = f->dip.along * (c->distance * dot3(f->plane.gradient[a], turn) -
                                              dot3(f->plane.gradient[a], foot)) -
                              f->dip.across * f->foot[a] * dot3(n, foot);
        along3(o, f->slope * deeper, f->deepening[a], o);
        along3(o, p * f->dip.bend * wider, f->widening[a], o);
        along3(o, p * f->dip.across * c->share[a], at_point, o);
        along3(o, p * normal, n, o);
        along3(o, -p * f->dip.along * f->foot[a], turn, o);
    }
}

/* ---- local compliance ---------------------------------------------------------------------------- */

/* Young's modulus times the area of a triangle over its spacing, and the mean stiffness of the parts of its
 * nodes: 2.134 K and 2.561 K per spacing for cells scaled as a solid (doc/numerics.md). */
static const double SOLID = 2.134 / 2.561;
static const double FLAT = 16.0 / 15.0; /* 1 / (1 - nu^2), as central forces have it */

static const double STRAIN = 0.1; /* to which a law's slope is its mean */
static const double BEND = 0.1; /* slopes over which it begins to count: at a kink fits of laws would stop */

double contact_stiffening(const palp_material *material, double modulus) {
    double rest, strained;
    palp_law_stiffness(&material->law, 0.0, &rest, NULL);
    palp_law_stiffness(&material->law, STRAIN, &strained, NULL);
    const double whole = material->quasi_linear ? rest : modulus; /* with arms that do not stiffen */
    const double slope = whole > 0.0 ? fmax((strained - rest) / (STRAIN * whole), 0.0) : 0.0;
    return slope * slope / (slope + BEND);
}

/* Force law of a triangle's point of this stiffness E A / h, N/m, below a sphere of this radius. To half the
 * radius it is the local compliance of Hertz's solid that a mesh of spacing h lacks. Beyond that it is hard,
 * so that no tool sinks in. uneven: 1 on a node, 0 in the middle of a triangle. solid: E by Poisson's ratio
 * over that at 1/4. Its square scales the terms that take off the mesh's own compliance, since the cells'
 * volume hardly stiffens nodes. Constants and this rule are from data/contact/local_law.py. The tissue there
 * stiffens with the strain u / h as elements do. */
static contact_law local_law(const contact_set *set, double stiffness, double radius, double spacing,
                             double uneven) {
    const double root = set->solid * stiffness, mesh = set->solid * root;
    return (contact_law){.root = FLAT / acos(-1.0) * root * spacing / sqrt(radius),
                         .linear = (0.95 - 2.05 * uneven) * mesh,
                         .steep = (8.1 + 20.2 * uneven) * uneven * mesh * sqrt(radius) / spacing,
                         .stiffening = set->stiffening / spacing,
                         .hard = set->settings.stiffness * root *
                                 fmax(1.0, spacing * spacing / (radius * radius)),
                         .limit = 0.5 * radius};
}

/* Stiffness of friction's spring: that of the law where it has given a sixteenth of this length, m. */
static double stiffness_of_law(const contact_law *law, double length) {
    const double root = sqrt(length / 16.0);
    return law->root / root + law->linear + law->steep * root;
}

void contact_face_law(const contact_set *set, const palp_tool *tool, double stiffness, double spacing,
                      contact *c) {
    const double uneven = 1.5 * dot3(c->share, c->share) - 0.5;
    c->law = local_law(set, SOLID * stiffness, tool->radius_m, spacing, uneven);
    c->stiffness = stiffness_of_law(&c->law, fmin(spacing, tool->radius_m));
}

/* What is missing below a flat face is near its outline, where a solid's pressure is highest and a mesh does
 * not follow it. In a wave of pressure a mesh lacks compliance in proportion to the wave number. So a point
 * lacks the less the further inward it is. The stiffness is E A / h (rim + inward (inset / h)^2). Fitted to
 * flat punches of half a spacing to three on the half-space of springs (data/contact/flat_law.py). It holds
 * to the share deep of the rounding and of half the half thickness. At the depth u a pressure p on a rounding
 * R has the slope -p / (R - u) across, by which points slip off it. A share below 1 bounds that. Points of a
 * smooth surface move together, so that theirs may be larger. */
static const struct surface_law {
    double rim, inward, deep;
} TRIANGLES = {3.0, 16.0, 0.5}, SMOOTH = {1.6, 4.0, 0.75};

double contact_patch(const contact_set *set, double stiffness) {
    return set->solid * set->solid * SOLID * stiffness;
}

void contact_hull_law(const contact_set *set, const palp_tool *tool, double patch, double spacing,
                      contact *c) {
    const struct surface_law *law = set->local ? &SMOOTH : &TRIANGLES;
    const double thick = contact_thickness(tool), inset = c->inset / spacing;
    c->law.hard = c->stiffness * fmax(1.0, spacing * spacing / (thick * thick));
    c->law.limit = law->deep * fmin(tool->radius_m, 0.5 * thick);
    c->law.linear = fmin(c->stiffness, patch * (law->rim + law->inward * inset * inset));
}
