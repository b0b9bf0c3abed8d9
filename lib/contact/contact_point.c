/* contact_point.c: one contact: how deep it is, its pressure, Coulomb friction by return mapping, its
 * tangent. */
#include "contact_internal.h"

#include <string.h>

/* ---- where --------------------------------------------------------------------------------------- */

/* Ericson 2005, 5.1.5. */
void contact_nearest(const double *const corner[3], const double p[3], double share[3]) {
    const double *a = corner[0], *b = corner[1], *c = corner[2];
    double ab[3], ac[3], q[3];
    along3(b, -1.0, a, ab);
    along3(c, -1.0, a, ac);
    along3(p, -1.0, a, q);
    double d1 = dot3(ab, q), d2 = dot3(ac, q);
    along3(p, -1.0, b, q);
    double d3 = dot3(ab, q), d4 = dot3(ac, q);
    along3(p, -1.0, c, q);
    double d5 = dot3(ab, q), d6 = dot3(ac, q);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, sum = va + vb + vc;
    double found[3] = {va / sum, vb / sum, vc / sum};
    if (d1 <= 0.0 && d2 <= 0.0)
        memcpy(found, (double[]){1.0, 0.0, 0.0}, sizeof found);
    else if (d3 >= 0.0 && d4 <= d3)
        memcpy(found, (double[]){0.0, 1.0, 0.0}, sizeof found);
    else if (d6 >= 0.0 && d5 <= d6)
        memcpy(found, (double[]){0.0, 0.0, 1.0}, sizeof found);
    else if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
        memcpy(found, (double[]){-d3 / (d1 - d3), d1 / (d1 - d3), 0.0}, sizeof found);
    else if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
        memcpy(found, (double[]){-d6 / (d2 - d6), 0.0, d2 / (d2 - d6)}, sizeof found);
    else if (va <= 0.0 && d4 >= d3 && d5 >= d6)
        memcpy(found, (double[]){0.0, (d5 - d6) / (d4 - d3 + d5 - d6), (d4 - d3) / (d4 - d3 + d5 - d6)},
               sizeof found);
    memcpy(share, found, sizeof found);
}

double contact_nearest_distance(const double *x, const int32_t node[3], const double p[3], double share[3]) {
    const double *corner[3] = {x + 3 * node[0], x + 3 * node[1], x + 3 * node[2]};
    double away[3] = {p[0], p[1], p[2]};
    contact_nearest(corner, p, share);
    for (int i = 0; i < 3; i++)
        along3(away, -share[i], corner[i], away);
    return sqrt(dot3(away, away));
}

/* The nearest point is inside the triangle: distance along its normal. */
static void measure_distance_to_face(const double *const corner[3], const double centre[3], contact *c) {
    double normal[3], to[3];
    triangle_normal(corner[0], corner[1], corner[2], normal);
    double area = sqrt(dot3(normal, normal));
    for (int k = 0; k < 3; k++)
        c->normal[k] = -normal[k] / area;
    along3(centre, -1.0, c->point, to);
    c->distance = -dot3(to, c->normal);
    for (int i = 0; i < 3; i++) {
        double opposite[3];
        along3(corner[(i + 2) % 3], -1.0, corner[(i + 1) % 3], opposite);
        cross3(opposite, c->normal, c->gradient[i]);
        for (int k = 0; k < 3; k++)
            c->gradient[i][k] /= area;
    }
}

/* It is on an edge or in a corner. */
static void measure_distance_to_edge(const double *const corner[3], const double centre[3], contact *c) {
    double to[3];
    along3(centre, -1.0, c->point, to);
    c->distance = sqrt(dot3(to, to));
    memset(c->gradient, 0, sizeof c->gradient);
    for (int k = 0; k < 3; k++)
        c->normal[k] = c->distance > 0.0 ? -to[k] / c->distance : 0.0;
    for (int i = 0; i < 3; i++) {
        int next = (i + 1) % 3;
        if (c->share[i] == 0.0 || c->share[next] == 0.0)
            continue;
        double edge[3];
        along3(corner[next], -1.0, corner[i], edge);
        double square = dot3(edge, edge);
        for (int k = 0; k < 3; k++) {
            c->gradient[next][k] = edge[k] / square;
            c->gradient[i][k] = -edge[k] / square;
        }
    }
}

double contact_along(const palp_tool *tool, const double point[3]) {
    double d[3];
    if (tool->shape != PALP_TOOL_CAPSULE)
        return 0.0;
    along3(point, -1.0, tool->position_m, d);
    return fmin(fmax(dot3(d, tool->axis), 0.0), tool->length_m);
}

/* A node is touched by a plane, or by the sphere of a tool that is nearest to it. */
static void measure_depth_of_node(const palp_tool *tool, contact *c, const double *x) {
    memcpy(c->share, (double[]){1.0, 0.0, 0.0}, sizeof c->share);
    memcpy(c->point, x + 3 * c->node[0], sizeof c->point);
    if (tool->shape == PALP_TOOL_PLANE) {
        memcpy(c->normal, tool->axis, sizeof c->normal);
        c->depth = dot3(tool->position_m, tool->axis) - dot3(c->point, tool->axis);
        return;
    }
    double centre[3];
    c->along = contact_along(tool, c->point);
    along3(tool->position_m, c->along, tool->axis, centre);
    const double *corner[3] = {c->point, c->point, c->point};
    measure_distance_to_edge(corner, centre, c);
    c->depth = tool->radius_m - c->distance;
}

static bool is_inside_triangle(const contact *c) {
    return c->share[0] > 0.0 && c->share[1] > 0.0 && c->share[2] > 0.0;
}

/* A node of other tissue is measured along the normal of the triangle, also a little beside it. */
static void measure_distance_to_plane(const double *const corner[3], const double node[3], contact *c) {
    double away[3];
    memcpy(c->point, corner[0], sizeof c->point);
    measure_distance_to_face(corner, node, c);
    along3(node, -1.0, corner[0], away);
    for (int i = 0; i < 3; i++)
        c->share[i] = (i == 0) + dot3(c->gradient[i], away);
    along3(node, c->distance, c->normal, c->point);
}

void contact_measure(const palp_tool *tool, contact *c, const double *x) {
    double centre[3];
    if (tool->shape == PALP_TOOL_HULL) {
        contact_hull_measure(tool, c, x);
        return;
    }
    if (c->fixed) {
        contact_plane plane = {.node = {-1, -1, -1}};
        contact_face_measure(tool, c, x, &plane);
        return;
    }
    if (c->corners == 1) {
        measure_depth_of_node(tool, c, x);
        return;
    }
    along3(tool->position_m, c->along, tool->axis, centre);
    const double *corner[3] = {x + 3 * c->node[0], x + 3 * c->node[1], x + 3 * c->node[2]};
    if (c->tissue) {
        measure_distance_to_plane(corner, centre, c);
        c->depth = -c->distance;
        return;
    }
    contact_nearest(corner, centre, c->share);
    contact_point(c, c->share, x, c->point);
    if (is_inside_triangle(c))
        measure_distance_to_face(corner, centre, c);
    else
        measure_distance_to_edge(corner, centre, c);
    c->depth = tool->radius_m - c->distance;
}

/* ---- forces -------------------------------------------------------------------------------------- */

/* Adds s (1 - a a') to a lower triangle. */
static void add_transverse_block(double s, const double *a, double k[6]) {
    for (int r = 0, i = 0; r < 3; r++)
        for (int c = 0; c <= r; c++, i++)
            k[i] += s * ((r == c) - a[r] * a[c]);
}

static void add_longitudinal_block(double s, const double *a, double k[6]) {
    for (int r = 0, i = 0; r < 3; r++)
        for (int c = 0; c <= r; c++, i++)
            k[i] += s * a[r] * a[c];
}

/* Force of the penalty and its slope: quadratic up to the smoothing depth, then linear. */
static double penalty_force_at_depth(const contact_set *set, const contact *c, double d, double *slope) {
    double smooth = set->settings.smoothing * set->edge;
    *slope = d < smooth ? c->stiffness * d / smooth : c->stiffness;
    return d < smooth ? 0.5 * d * *slope : c->stiffness * (d - 0.5 * smooth);
}

static double elastic_force_at_depth(const contact_set *set, const contact *c, double d, double *slope) {
    return c->law.hard > 0.0 ? contact_face_elastic(set, c, d, slope)
                             : penalty_force_at_depth(set, c, d, slope);
}

static double elastic_energy_at_depth(const contact_set *set, const contact *c, double d) {
    double smooth = set->settings.smoothing * set->edge;
    if (c->law.hard > 0.0)
        return contact_face_energy(set, c, d);
    if (d < smooth)
        return c->stiffness * d * d * d / (6.0 * smooth);
    return c->stiffness * (0.5 * d * (d - smooth) + smooth * smooth / 6.0);
}

bool contact_relaxes(const contact_set *set, const contact *c) {
    return (set->settings.local || set->local) && set->tool[c->tool].shape != PALP_TOOL_PLANE;
}

static double instant_share(const contact_set *set, const contact *c) {
    return contact_relaxes(set, c) ? set->relaxation[c->material].share : 1.0;
}

/* Sets the pressure: what it remembers makes it less, to 0 at least. Returns its slope by the depth. */
static double evaluate_pressure(const contact_set *set, contact *c) {
    const double share = instant_share(set, c);
    double slope;
    c->elastic = elastic_force_at_depth(set, c, c->depth, &slope);
    c->pressure = fmax(0.0, share * c->elastic + c->past);
    return c->pressure > 0.0 ? share * slope : 0.0;
}

/* Depth at which the pressure begins: by bisection. */
static double depth_without_pressure(const contact_set *set, const contact *c, double share) {
    enum { HALVES = 48 };
    double low = 0.0, high = c->depth, slope;
    for (int i = 0; i < HALVES; i++) {
        const double middle = 0.5 * (low + high);
        if (share * elastic_force_at_depth(set, c, middle, &slope) + c->past > 0.0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

double contact_energy(const contact_set *set, const contact *c) {
    const double share = instant_share(set, c);
    if (!(c->past < 0.0))
        return share * elastic_energy_at_depth(set, c, c->depth) + c->past * c->depth;
    if (!(c->pressure > 0.0))
        return 0.0;
    const double start = depth_without_pressure(set, c, share);
    return share * (elastic_energy_at_depth(set, c, c->depth) - elastic_energy_at_depth(set, c, start)) +
           c->past * (c->depth - start);
}

/* Tangent of the pressure along the normal, and across it where the point cannot move on its triangle:
 * all round in a corner, across an edge on one. A capsule is straight along its axis. Of a hull the points of
 * triangles are fixed, and its faces are flat. */
static void evaluate_normal_force(const palp_tool *tool, contact *c, double slope) {
    double edge[3] = {0.0}, length = 0.0;
    memset(c->normal_tangent, 0, sizeof c->normal_tangent);
    add_longitudinal_block(slope, c->normal, c->normal_tangent);
    const bool hull = tool->shape == PALP_TOOL_HULL;
    if (hull ? !c->round
             : tool->shape == PALP_TOOL_PLANE || c->tissue || is_inside_triangle(c) || !(c->distance > 0.0))
        return;
    double bend = c->pressure / c->distance;
    add_transverse_block(-bend, c->normal, c->normal_tangent);
    if (hull) {
        add_longitudinal_block(bend, c->straight, c->normal_tangent);
        return;
    }
    for (int i = 0; i < 3 && length == 0.0; i++) {
        length = sqrt(dot3(c->gradient[i], c->gradient[i]));
        for (int k = 0; k < 3 && length > 0.0; k++)
            edge[k] = c->gradient[i][k] / length;
    }
    if (length > 0.0)
        add_longitudinal_block(bend, edge, c->normal_tangent);
    else if (tool->shape == PALP_TOOL_CAPSULE && c->along > 0.0 && c->along < tool->length_m)
        add_longitudinal_block(bend, tool->axis, c->normal_tangent);
}

double contact_normal_force(const contact *c) {
    return c->pressure * (c->fixed ? c->face.size : 1.0);
}

/* A spring as stiff as the penalty from the anchor to the point, along the surface; where it pulls harder
 * than friction holds, it slips (return mapping). The part of the tangent by which slip follows the pressure,
 * which has this slope, has no mirror image and stands apart, as drag: factors are of symmetric matrices. */
static void evaluate_friction_force(contact *c, double coefficient, double slope, const double *x) {
    double u[3], stiffness = c->entry * c->stiffness, turn[3];
    contact_point(c, c->stick_share, x, u);
    along3(u, -1.0, c->anchor, u);
    along3(u, -dot3(u, c->normal), c->normal, u);
    double pull = stiffness * sqrt(dot3(u, u)), limit = coefficient * contact_normal_force(c);
    bool slips = pull > limit;
    double share = c->kept = slips ? limit / pull : 1.0;
    for (int k = 0; k < 3; k++) {
        c->stretch[k] = share * c->entry * u[k];
        c->friction[k] = -share * stiffness * u[k];
        turn[k] = slips ? u[k] * stiffness / pull : 0.0;
        c->drag[k] = coefficient * slope * turn[k];
    }
    memset(c->friction_tangent, 0, sizeof c->friction_tangent);
    add_transverse_block(share * stiffness, c->normal, c->friction_tangent);
    add_longitudinal_block(-share * stiffness, turn, c->friction_tangent);
}

void contact_evaluate_next(const contact_set *set, contact *c, const double *x, contact_plane *plane) {
    const palp_tool *tool = &set->pose[c->tool];
    if (c->fixed)
        contact_face_measure(tool, c, x, plane);
    else
        contact_measure(tool, c, x);
    if (c->corners == 3 && !c->tissue && c->distance < -0.5 * set->edge)
        c->depth = 0.0; /* a tool that far through the surface has lost it */
    if (!(c->depth > 0.0))
        return;
    double slope = evaluate_pressure(set, c);
    if (c->fixed) {
        contact_face_slopes(c, slope);
        slope *= c->face.size * c->face.size;
    } else
        evaluate_normal_force(tool, c, slope);
    if (tool->friction > 0.0)
        evaluate_friction_force(c, tool->friction, slope, x);
}

void contact_evaluate(const contact_set *set, contact *c, const double *x) {
    contact_plane none = {.node = {-1, -1, -1}};
    contact_evaluate_next(set, c, x, &none);
}

static void multiply_symmetric_block(const double k[6], const double *p, double out[3]) {
    out[0] = k[0] * p[0] + k[1] * p[1] + k[3] * p[2];
    out[1] = k[1] * p[0] + k[2] * p[1] + k[4] * p[2];
    out[2] = k[3] * p[0] + k[4] * p[1] + k[5] * p[2];
}

static void multiply_fixed_point(const contact *c, const double *u, double *out) {
    double at_point[3], across[3];
    contact_face_times(c, u, out);
    contact_point(c, c->share, u, at_point);
    multiply_symmetric_block(c->friction_tangent, at_point, across);
    for (int i = 0; i < 3; i++)
        along3(out + 3 * c->node[i], c->share[i], across, out + 3 * c->node[i]);
}

/* Second derivative of the distance d of a centre to a triangle:
 * d_ij = s_i s_j Q / d + n g_i' s_j + s_i g_j n' - d (g_i g_j) n n'
 * with n = -normal, the shares s and their gradients g. Q is 1 - n n' without the directions of g. */
void contact_times(const contact *c, const double *u, double *out) {
    if (c->fixed) {
        multiply_fixed_point(c, u, out);
        return;
    }
    double at_point[3], at_stick[3], along[3], slide[3] = {0.0}, across[3], turn[3];
    contact_point(c, c->share, u, at_point);
    contact_point(c, c->stick_share, u, at_stick);
    multiply_symmetric_block(c->normal_tangent, at_point, along);
    multiply_symmetric_block(c->friction_tangent, at_stick, across);
    for (int j = 0; j < c->corners; j++)
        along3(slide, dot3(c->normal, u + 3 * c->node[j]), c->gradient[j], slide);
    along3(along, c->pressure, slide, along);
    along3(at_point, c->distance, slide, turn);
    for (int i = 0; i < c->corners; i++) {
        double *o = out + 3 * c->node[i];
        along3(o, c->share[i], along, o);
        along3(o, c->pressure * dot3(c->gradient[i], turn), c->normal, o);
        along3(o, c->stick_share[i], across, o);
    }
}

/* The pressure falls by its slope times the way along the normal, which leads into the tissue, and friction
 * with it. */
void contact_whole_times(const contact *c, const double *u, double *out) {
    double at_point[3];
    contact_times(c, u, out);
    contact_point(c, c->share, u, at_point);
    const double way = dot3(c->normal, at_point);
    for (int i = 0; i < c->corners; i++)
        along3(out + 3 * c->node[i], -c->stick_share[i] * way, c->drag, out + 3 * c->node[i]);
}

void contact_block(const contact *c, int a, int b, double k[9]) {
    static const unsigned char full[9] = {0, 1, 3, 1, 2, 4, 3, 4, 5};
    if (c->fixed) {
        for (int i = 0; i < 9; i++)
            k[i] = c->share[a] * c->share[b] * c->friction_tangent[full[i]];
        contact_face_block(c, a, b, k);
        return;
    }
    const double *ga = c->gradient[a], *gb = c->gradient[b], *n = c->normal;
    for (int i = 0; i < 9; i++)
        k[i] = c->share[a] * c->share[b] * c->normal_tangent[full[i]] +
               c->stick_share[a] * c->stick_share[b] * c->friction_tangent[full[i]];
    if (dot3(ga, ga) + dot3(gb, gb) == 0.0) /* of a hull's points, and others whose shares stay */
        return;
    double both = c->distance * dot3(ga, gb);
    for (int i = 0; i < 9; i++) {
        int row = i / 3, col = i % 3;
        k[i] += c->pressure *
                (n[row] * ga[col] * c->share[b] + c->share[a] * gb[row] * n[col] + both * n[row] * n[col]);
    }
}
