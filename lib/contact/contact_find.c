/* contact_find.c: nodes and triangles of the surface near a tool, and the nearest points on the tool. */
#include "contact_internal.h"

#include <string.h>

static const double REACH = 0.5;  /* of an edge: so near, a point may come to touch in a step */
static const double BEND = 0.25;  /* of a tool's radius: so far its contacts keep their directions, within
                                     a cosine of BEND */
enum { FEWEST = 3, MOST = 12 };   /* parts of a triangle's edge, for fixed points */
static const double FINE = 2.5;   /* of them on the way of a tool's radius, at least */
static const double MIDDLE = 0.1; /* pull to the middle of a triangle, so that the nearest point is one also
                                     where a capsule lies flat on it */

double contact_distance(const palp_tool *tool, const double point[3]) {
    double d[3];
    along3(point, -1.0, tool->position_m, d);
    if (tool->shape == PALP_TOOL_PLANE)
        return fmax(dot3(d, tool->axis), 0.0);
    if (tool->shape == PALP_TOOL_HULL)
        return contact_hull_distance(tool, point);
    along3(d, -contact_along(tool, point), tool->axis, d);
    return sqrt(dot3(d, d));
}

/* Could a triangle be within this distance of a tool's axis? Uses the sphere around its middle. */
static bool is_triangle_near_axis(const palp_tool *tool, double distance, const double *const corner[3]) {
    double middle[3], radius = 0.0;
    for (int k = 0; k < 3; k++)
        middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3.0;
    for (int i = 0; i < 3; i++) {
        double d[3];
        along3(corner[i], -1.0, middle, d);
        radius = fmax(radius, dot3(d, d));
    }
    return contact_distance(tool, middle) <= distance + sqrt(radius);
}

/* Slope of the distance to the triangle from the point at t of a capsule's axis. */
static double distance_slope_along_axis(const palp_tool *tool, double t, const double *const corner[3]) {
    double centre[3], pulled[3], share[3];
    along3(tool->position_m, t, tool->axis, centre);
    for (int k = 0; k < 3; k++)
        pulled[k] =
            (centre[k] + MIDDLE * (corner[0][k] + corner[1][k] + corner[2][k]) / 3.0) / (1.0 + MIDDLE);
    contact_nearest(corner, pulled, share);
    for (int i = 0; i < 3; i++)
        along3(centre, -share[i], corner[i], centre);
    return dot3(centre, tool->axis);
}

/* Point of a capsule's axis nearest to a triangle. The distance is convex: regula falsi (Illinois) on its
 * slope. */
static double nearest_point_on_axis(const palp_tool *tool, const double *const corner[3]) {
    enum { ROUNDS = 12 };
    double low = 0.0, high = tool->length_m, t = 0.0;
    if (tool->shape != PALP_TOOL_CAPSULE || high == 0.0)
        return 0.0;
    double at_low = distance_slope_along_axis(tool, low, corner),
           at_high = distance_slope_along_axis(tool, high, corner);
    if (at_low >= 0.0 || at_high <= 0.0)
        return at_low >= 0.0 ? low : high;
    for (int i = 0, side = 0; i < ROUNDS && high - low > 1e-3 * tool->length_m; i++) {
        t = (low * at_high - high * at_low) / (at_high - at_low);
        double at = distance_slope_along_axis(tool, t, corner);
        if (at == 0.0)
            break;
        if (at < 0.0) {
            low = t;
            at_low = at;
            at_high *= side == -1 ? 0.5 : 1.0;
            side = -1;
        } else {
            high = t;
            at_high = at;
            at_low *= side == 1 ? 0.5 : 1.0;
            side = 1;
        }
    }
    return t;
}

double contact_slid(const contact_set *set, const contact *c, const double *x) {
    if (c->fixed) {
        double point[3];
        contact_point(c, c->share, x, point);
        return fabs(contact_along(&set->pose[c->tool], point) - c->along);
    }
    if (c->corners == 1 || set->pose[c->tool].shape == PALP_TOOL_HULL)
        return 0.0;
    const double *corner[3] = {x + 3 * c->node[0], x + 3 * c->node[1], x + 3 * c->node[2]};
    return fabs(nearest_point_on_axis(&set->pose[c->tool], corner) - c->along);
}

/* 1 where the tool meets a surface with this normal from above, less from the side, 0 from behind. A point
 * within a hull is as below a rounding of its own depth there: less near the outline of the face, to 0 on it.
 */
static double fade_by_surface_normal(const palp_tool *tool, const double normal[3], const contact *c) {
    const double length = sqrt(dot3(normal, normal));
    double to[3], cosine = 0.0;
    if (tool->shape == PALP_TOOL_HULL) {
        const double within = fmax(c->depth - tool->radius_m, 0.0), slant = hypot(c->inset, within);
        cosine = length > 0.0 ? -dot3(c->normal, normal) / length : 0.0;
        return hull_facing(within > 0.0 ? cosine * c->inset / slant : cosine);
    }
    along3(tool->position_m, c->along, tool->axis, to);
    along3(to, -1.0, c->point, to);
    if (length > 0.0 && c->distance > 0.0)
        cosine = dot3(to, normal) / (length * c->distance);
    return hull_facing(cosine);
}

/* Factor of a contact's stiffness: 1 where the tool meets the triangle from above, less from the side, 0 from
 * behind. */
static double triangle_facing_factor(const palp_tool *tool, const double *const corner[3], double edge,
                                     const contact *c) {
    double normal[3];
    triangle_normal(corner[0], corner[1], corner[2], normal);
    double area = sqrt(dot3(normal, normal));
    if (!(area > 1e-9 * edge * edge))
        return 0.0;
    if (fmin(c->share[0], fmin(c->share[1], c->share[2])) > 0.0)
        return c->distance > -0.5 * edge ? 1.0 : 0.0;
    return fade_by_surface_normal(tool, normal, c);
}

/* A search around the tools. */
typedef struct search {
    contact_set *set;
    const double *committed, *x; /* positions of the nodes */
    size_t cursor;               /* in the committed records of contact */
    size_t first, last;          /* records of the triangle whose fixed points are in turn */
    contact_plane before, now;   /* of that triangle at committed and at x */
} search;

static bool is_record_of(const contact_touch *touch, int32_t tool, const int32_t node[3]) {
    return touch->tool == tool && memcmp(touch->node, node, sizeof touch->node) == 0;
}

/* The first record of a tool on these nodes, or their number. Records are mostly in the order of contacts. */
static size_t find_first_record(search *s, int32_t tool, const int32_t node[3]) {
    const contact_state *now = &s->set->now;
    const size_t n = now->n_touches;
    for (size_t i = 0; i < n; i++) {
        size_t at = s->cursor + i < n ? s->cursor + i : s->cursor + i - n;
        if (is_record_of(&now->touch[at], tool, node)) {
            s->cursor = at + 1 < n ? at + 1 : 0;
            return at;
        }
    }
    return n;
}

/* Sets first and last. The records of a triangle follow each other. */
static void find_records_of_triangle(search *s, int32_t tool, const int32_t node[3]) {
    const contact_state *now = &s->set->now;
    s->cursor = s->cursor < now->n_touches ? s->cursor : 0;
    s->first = s->last = find_first_record(s, tool, node);
    while (s->first > 0 && s->first < now->n_touches && is_record_of(&now->touch[s->first - 1], tool, node))
        s->first--;
    while (s->last < now->n_touches && is_record_of(&now->touch[s->last], tool, node))
        s->last++;
    s->cursor = s->last;
}

/* Is it a fixed point of a triangle near a hull? */
static bool is_point_in_hull(const contact_set *set, const contact *c) {
    return c->corners == 3 && set->pose[c->tool].shape == PALP_TOOL_HULL;
}

/* The committed state's record of a contact, or NULL. */
static const contact_touch *find_remembered_touch(search *s, const contact *c) {
    const contact_state *now = &s->set->now;
    if (!c->fixed && !is_point_in_hull(s->set, c)) {
        const size_t at = find_first_record(s, c->tool, c->node);
        return at < now->n_touches ? &now->touch[at] : NULL;
    }
    for (size_t at = s->first; at < s->last; at++)
        if (now->touch[at].part == c->part)
            return &now->touch[at];
    return NULL;
}

/* Where a point of the tool that was at place is now: it follows the tool's position and orientation, or
 * without one the smallest rotation of its axis. */
static void displacement_of_tool_point(const palp_tool *was, const palp_tool *is, const double place[3],
                                       double moved[3]) {
    double arm[3], turn[3], once[3], twice[3];
    along3(is->position_m, -1.0, was->position_m, moved);
    along3(place, -1.0, was->position_m, arm);
    if (contact_turn_arm(was, is, arm, moved) || is->shape == PALP_TOOL_SPHERE)
        return;
    cross3(was->axis, is->axis, turn);
    double cosine = dot3(was->axis, is->axis);
    if (cosine < -0.99)
        return;
    cross3(turn, arm, once);
    cross3(turn, once, twice);
    for (int k = 0; k < 3; k++)
        moved[k] += once[k] + twice[k] / (1.0 + cosine);
}

/* Depth of a contact in the committed state, if the tool has this pose, and the distance there. */
static double depth_before_step(search *s, const contact *c, const palp_tool *pose, const double place[3],
                                double *distance) {
    if (c->fixed) {
        contact_dip dip;
        contact_plane_at(c->node, s->committed, &s->before);
        contact_dip_at(pose, c->along, &s->before, place, &dip);
        *distance = dip.height;
        return dip.depth + c->early;
    }
    contact there = *c;
    palp_tool then = *pose;
    then.hull = s->set->pose[c->tool].hull; /* that of a pose before is not followed */
    contact_measure(&then, &there, s->committed);
    *distance = there.distance;
    return there.depth;
}

static void continue_touch(const contact_set *set, contact *c, const contact_touch *touch) {
    c->touched = true;
    c->memory = (int32_t)(touch - set->now.touch);
    const contact_relaxation *r = &set->relaxation[c->material];
    for (size_t j = 0; j < r->n_arms && contact_relaxes(set, c); j++)
        c->past += r->keep[j] * touch->arm[j] - r->gain[j] * touch->elastic;
    c->doubt = touch->doubt;
    memcpy(c->was, touch->stretch, sizeof c->was);
    along3(c->anchor, -1.0, touch->stretch, c->anchor);
}

/* The material around the corner that is nearest. */
static int material_at(const contact_set *set, const contact *c) {
    return set->material ? set->material[contact_main_corner(c)] : 0;
}

/* Sets where friction's spring starts, and the share of the step since contact began. False for a tool that
 * came from below the surface. */
static bool place_friction_anchor(search *s, contact *c) {
    const contact_set *set = s->set;
    const palp_tool *pose = &set->pose[c->tool], *was = &set->now.pose[c->tool];
    bool known = (size_t)c->tool < set->now.n_tools && was->shape == pose->shape;
    const contact_touch *touch = known ? find_remembered_touch(s, c) : NULL;
    double place[3], moved[3] = {0.0}, distance, unused;
    memcpy(c->stick_share, c->share, sizeof c->stick_share);
    c->material = material_at(set, c);
    contact_point(c, c->stick_share, s->committed, place);
    if (known)
        displacement_of_tool_point(was, pose, place, moved);
    along3(place, 1.0, moved, c->anchor);
    c->entry = 1.0;
    c->memory = -1;
    if (touch) {
        continue_touch(set, c, touch);
        return true;
    }
    if (!known) {
        c->law.root *= set->share;
        c->law.linear *= set->share;
        c->law.steep *= set->share;
        c->law.hard *= set->share;
        c->stiffness *= set->share;
        return !(c->distance < 0.0);
    }
    const double before = depth_before_step(s, c, was, place, &distance);
    if (before < 0.0) {
        const double after = depth_before_step(s, c, pose, place, &unused);
        c->entry = after > 0.0 ? after / (after - before) : 0.0;
    }
    return !(distance < 0.0);
}

static void add_contact_to_set(search *s, contact *c) {
    contact_set *set = s->set;
    if (set->n_contacts < set->max_contacts && place_friction_anchor(s, c))
        set->contact[set->n_contacts++] = *c;
}

static void find_node_contacts(search *s, int32_t tool, double reach) {
    const contact_set *set = s->set;
    const palp_tool *pose = &set->pose[tool];
    const double *x = s->x;
    double plane = dot3(pose->position_m, pose->axis) + reach;
    for (size_t i = 0; i < set->n_nodes; i++) {
        if (set->triangles[i] == 0 || !(dot3(x + 3 * i, pose->axis) < plane))
            continue;
        contact c = {.tool = tool, .node = {(int32_t)i, -1, -1}, .corners = 1};
        contact_measure(pose, &c, x);
        c.stiffness = set->settings.stiffness * set->modulus * set->unit[i];
        add_contact_to_set(s, &c);
    }
}

/* Factor of the stiffness of a node's contact, by the mean normal of its triangles. */
static double node_facing_factor(const contact_set *set, const palp_tool *tool, contact *c, const double *x) {
    double normal[3] = {0.0}, own[3];
    const int32_t node = c->node[0];
    if (tool->shape == PALP_TOOL_PLANE)
        return 1.0;
    for (uint32_t i = set->points.first[node]; i < set->points.first[node + 1]; i++) {
        const int32_t *t = set->surface + 3 * set->points.around[i];
        triangle_normal(x + 3 * t[0], x + 3 * t[1], x + 3 * t[2], own);
        along3(normal, 1.0, own, normal);
    }
    if (tool->shape == PALP_TOOL_HULL) {
        memcpy(c->outward, normal, sizeof normal);
        if (c->depth > tool->radius_m) /* within the hull, which it leaves by a face that this normal meets */
            contact_measure(tool, c, x);
        c->inset = contact_hull_inset(tool, c);
    }
    return fade_by_surface_normal(tool, normal, c);
}

/* The compliance b h / E, h the spacing, that a lattice lacks below a contact of radius a under Hertz's
 * pressure, by a / h: within 0.02 of what data/contact/local_compliance.py prints. A tool of radius r has
 * that of the depth h / 6, a = sqrt(r h / 6), at any depth: its force is that of a spring. */
static double local_compliance(double radius_in_spacings) {
    const double square = radius_in_spacings / 6.0;
    return (0.15 + 4.20 * square) / (1.0 + 4.93 * square);
}

/* The penalty of a point of a smooth surface: for a sphere or capsule what the tissue below lacks in the
 * mesh. A plane or hull touches all nodes, however its force is spread; a hull has the law below besides. */
static double stiffness_of_node_contact(const contact_set *set, const palp_tool *tool, int32_t node) {
    if (contact_tool_is_round(tool))
        return set->solid * set->modulus * set->local[node] / local_compliance(tool->radius_m / set->spacing);
    return set->settings.stiffness * set->modulus * set->unit[node];
}

static void find_point_contacts(search *s, int32_t tool, double reach) {
    const contact_set *set = s->set;
    const palp_tool *pose = &set->pose[tool];
    for (size_t i = 0; i < set->points.n; i++) {
        const int32_t node = set->points.node[i];
        contact c = {.tool = tool, .node = {node, -1, -1}, .corners = 1, .share = {1.0}};
        contact_measure(pose, &c, s->x);
        if (!(c.depth > -reach))
            continue;
        const double factor = node_facing_factor(set, pose, &c, s->x);
        c.stiffness = factor * stiffness_of_node_contact(set, pose, node);
        if (pose->shape == PALP_TOOL_HULL && set->local)
            contact_hull_law(set, pose, factor * set->solid * set->modulus * set->local[node], set->spacing,
                             &c);
        if (c.stiffness > 0.0)
            add_contact_to_set(s, &c);
    }
}

/* A triangle's share of the stiffness of its nodes. */
static double stiffness_of_triangle(const contact_set *set, const int32_t *node) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum += set->unit[node[i]] / set->triangles[node[i]];
    return set->settings.stiffness * set->modulus * sum;
}

static bool has_triangle_area(const contact_set *set, const double *const corner[3]) {
    double normal[3];
    triangle_normal(corner[0], corner[1], corner[2], normal);
    return sqrt(dot3(normal, normal)) > 1e-9 * set->edge * set->edge;
}

/* The side of a square of twice the triangle's area at rest, m. */
static double spacing_of_triangle(const contact_set *set, const int32_t *node) {
    double normal[3];
    triangle_normal(set->rest + 3 * node[0], set->rest + 3 * node[1], set->rest + 3 * node[2], normal);
    return sqrt(sqrt(dot3(normal, normal)));
}

/* Factor of a triangle's point with these shares: 1 where the tool's centre is above the triangle, to half an
 * edge through it; beside the triangle it falls to 0 where the centre comes down to the plane, in which the
 * tool is at its side. */
static double triangle_point_factor(const contact_set *set, const palp_tool *tool, const contact_plane *plane,
                                    const contact_dip *dip, const double share[3]) {
    bool above = true;
    for (int i = 0; i < 3; i++)
        above = above && contact_foot(plane, dip, i, share[i]) > 0.0;
    if (above)
        return dip->height > -0.5 * set->edge ? 1.0 : 0.0;
    const double height = dip->height / (BEND * tool->radius_m);
    return height >= 1.0 ? 1.0 : height > 0.0 ? height * height * (3.0 - 2.0 * height) : 0.0;
}

/* A triangle in whose fixed points a tool may touch it: in the middles of parts * parts equal parts. */
typedef struct facet {
    int32_t tool;
    const int32_t *node;
    int parts;
    double spacing, stiffness; /* stiffness: of a part, N/m */
} facet;

static void find_point_of_triangle(search *s, const facet *f, double reach, int part, const double share[3]) {
    contact_set *set = s->set;
    const palp_tool *pose = &set->pose[f->tool];
    const double early = 0.5 * set->settings.smoothing * set->edge, around = pose->radius_m + reach;
    double point[3] = {0.0}, centre[3];
    contact_dip dip;
    for (int i = 0; i < 3; i++)
        along3(point, share[i], s->x + 3 * f->node[i], point);
    const double along = contact_along(pose, point);
    along3(pose->position_m, along, pose->axis, centre);
    along3(point, -1.0, centre, dip.away);
    if (dot3(dip.away, dip.away) > around * around)
        return;
    contact_dip_at(pose, along, &s->now, point, &dip);
    if (!(dip.depth + early > -reach))
        return;
    const double factor = triangle_point_factor(set, pose, &s->now, &dip, share);
    if (!(factor > 0.0) || set->n_contacts == set->max_contacts)
        return;
    contact *c = &set->contact[set->n_contacts];
    *c = (contact){.tool = f->tool,
                   .node = {f->node[0], f->node[1], f->node[2]},
                   .corners = 3,
                   .part = part,
                   .fixed = true,
                   .share = {share[0], share[1], share[2]},
                   .early = early,
                   .along = along,
                   .depth = dip.depth + early,
                   .distance = dip.height};
    contact_face_law(set, pose, factor * f->stiffness, f->spacing, c);
    if (place_friction_anchor(s, c))
        set->n_contacts++;
}

/* A hull has the penalty of a plane there and the local compliance below its rim, less where it meets the
 * triangle from the side. */
static void find_point_in_hull(search *s, const facet *f, double reach, int part, const double share[3]) {
    const palp_tool *pose = &s->set->pose[f->tool];
    contact c = {.tool = f->tool,
                 .node = {f->node[0], f->node[1], f->node[2]},
                 .corners = 3,
                 .part = part,
                 .share = {share[0], share[1], share[2]}};
    memcpy(c.outward, s->now.outward, sizeof c.outward);
    contact_measure(pose, &c, s->x);
    if (!(c.depth > -reach))
        return;
    c.inset = contact_hull_inset(pose, &c);
    const double stiffness = f->stiffness * fade_by_surface_normal(pose, s->now.outward, &c);
    c.stiffness = s->set->settings.stiffness * stiffness;
    if (s->set->settings.local)
        contact_hull_law(s->set, pose, contact_patch(s->set, stiffness), f->spacing, &c);
    if (c.stiffness > 0.0)
        add_contact_to_set(s, &c);
}

/* Is all of a tool's axis further than this over a triangle's plane? */
static bool is_axis_above_plane(const palp_tool *tool, double distance, const contact_plane *plane,
                                const double corner[3]) {
    double to[3];
    along3(tool->position_m, -1.0, corner, to);
    const double start = dot3(to, plane->outward),
                 rise = tool->shape == PALP_TOOL_CAPSULE ? tool->length_m * dot3(tool->axis, plane->outward)
                                                         : 0.0;
    return fmin(start, start + rise) > distance;
}

static void find_points_of_triangle(search *s, int32_t tool, const int32_t *node, double reach) {
    const contact_set *set = s->set;
    facet f = {.tool = tool, .node = node, .spacing = spacing_of_triangle(set, node)};
    const bool hull = set->pose[tool].shape == PALP_TOOL_HULL;
    f.parts = (int)fmin(fmax(ceil(FINE * set->edge / contact_thickness(&set->pose[tool])), FEWEST), MOST);
    f.stiffness = stiffness_of_triangle(set, node) / (set->settings.stiffness * f.parts * f.parts);
    contact_plane_at(node, s->x, &s->now);
    if (!hull && is_axis_above_plane(&set->pose[tool],
                                     set->pose[tool].radius_m + reach + set->edge * set->settings.smoothing,
                                     &s->now, s->x + 3 * node[0]))
        return;
    find_records_of_triangle(s, tool, node);
    for (int part = 0, row = 0; row < f.parts; row++)
        for (int k = 0; k < 2 * (f.parts - row) - 1; k++, part++) {
            const double third = (1 + (k & 1)) / 3.0, a = (row + third) / f.parts,
                         b = (k / 2 + third) / f.parts;
            const double share[3] = {1.0 - a - b, a, b};
            if (hull)
                find_point_in_hull(s, &f, reach, part, share);
            else
                find_point_of_triangle(s, &f, reach, part, share);
        }
}

void contact_box(const palp_tool *tool, double slack, double low[3], double high[3]) {
    const double around = tool->radius_m + slack;
    if (tool->shape == PALP_TOOL_HULL) {
        contact_hull_box(tool, around, low, high);
        return;
    }
    for (int k = 0; k < 3; k++) {
        double start = tool->position_m[k];
        double end = start + (tool->shape == PALP_TOOL_CAPSULE ? tool->length_m * tool->axis[k] : 0.0);
        low[k] = fmin(start, end) - around;
        high[k] = fmax(start, end) + around;
    }
}

static bool triangle_overlaps_box(const double low[3], const double high[3], const double *const corner[3]) {
    const double *a = corner[0], *b = corner[1], *c = corner[2];
    for (int k = 0; k < 3; k++)
        if ((a[k] < low[k] && b[k] < low[k] && c[k] < low[k]) ||
            (a[k] > high[k] && b[k] > high[k] && c[k] > high[k]))
            return false;
    return true;
}

static void find_triangle_contacts(search *s, int32_t tool, double reach) {
    const contact_set *set = s->set;
    const palp_tool *pose = &set->pose[tool];
    const double *x = s->x;
    double low[3], high[3], around = reach + pose->radius_m;
    contact_box(pose, reach, low, high);
    for (size_t i = 0; i < set->n_surface; i++) {
        const int32_t *node = set->surface + 3 * i;
        const double *corner[3] = {x + 3 * node[0], x + 3 * node[1], x + 3 * node[2]};
        if (!triangle_overlaps_box(low, high, corner) || !is_triangle_near_axis(pose, around, corner))
            continue;
        if (set->settings.local || pose->shape == PALP_TOOL_HULL) {
            if (has_triangle_area(set, corner))
                find_points_of_triangle(s, tool, node, reach);
            continue;
        }
        contact c = {.tool = tool, .node = {node[0], node[1], node[2]}, .corners = 3};
        c.along = nearest_point_on_axis(pose, corner);
        contact_measure(pose, &c, x);
        c.stiffness = triangle_facing_factor(pose, corner, set->edge, &c) * stiffness_of_triangle(set, node);
        if (c.depth > -reach && c.stiffness > 0.0)
            add_contact_to_set(s, &c);
    }
}

double contact_travel(const contact_set *set, const palp_tool *pose, size_t tool) {
    const palp_tool *was = &set->now.pose[tool];
    double moved[3], turned[3];
    if (tool >= set->now.n_tools)
        return 0.0;
    along3(pose->position_m, -1.0, was->position_m, moved);
    along3(pose->axis, -1.0, was->axis, turned);
    double reach = pose->shape == PALP_TOOL_CAPSULE ? pose->length_m : 0.0;
    return sqrt(dot3(moved, moved)) + reach * sqrt(dot3(turned, turned)) + contact_turned(was, pose);
}

double contact_stride(const contact_set *set, const palp_tool *tool) {
    const double reach = REACH * set->edge;
    if (tool->shape == PALP_TOOL_PLANE)
        return reach;
    /* a hull that goes further could take points through the round of its edges */
    return fmin(reach, (tool->shape == PALP_TOOL_HULL ? 1.0 : BEND) * tool->radius_m);
}

void contact_find(contact_set *set, const double *committed, const double *x) {
    const contact_plane none = {.node = {-1, -1, -1}};
    search s = {.set = set, .committed = committed, .x = x, .before = none, .now = none};
    set->n_contacts = 0;
    for (size_t i = 0; i < set->n_tools; i++) {
        double reach = REACH * set->edge + contact_travel(set, &set->pose[i], i);
        if (set->points.first)
            find_point_contacts(&s, (int32_t)i, reach);
        else if (set->pose[i].shape == PALP_TOOL_PLANE)
            find_node_contacts(&s, (int32_t)i, reach);
        else
            find_triangle_contacts(&s, (int32_t)i, reach);
    }
}
