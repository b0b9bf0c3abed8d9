/* contact_hull.c: points of the surface near a hull, and how tools of all shapes have turned. */
#include "contact_internal.h"

#include <string.h>

/* Turns a vector by an orientation, or back where way is -1. A zero orientation leaves it. */
static void turn_vector(const double orientation[4], double way, const double v[3], double out[3]) {
    const double *axis = orientation + 1;
    double once[3], twice[3];
    cross3(axis, v, once);
    cross3(axis, once, twice);
    for (int k = 0; k < 3; k++)
        out[k] = v[k] + 2.0 * (way * orientation[0] * once[k] + twice[k]);
}

/* ---- hulls --------------------------------------------------------------------------------------- */

/* That of a restored tool without one touches nothing. */
static const palp_hull *hull_of_tool(const palp_tool *tool) {
    static const palp_hull NONE = {.n_faces = 0};
    return tool->hull ? tool->hull : &NONE;
}

static void point_of_hull(const palp_tool *tool, const double place[3], double point[3]) {
    turn_vector(tool->orientation, 1.0, place, point);
    along3(point, 1.0, tool->position_m, point);
}

/* place: the point in the hull's frame. */
static void measure_point(const palp_tool *tool, const double point[3], double place[3], hull_near *near) {
    double arm[3];
    along3(point, -1.0, tool->position_m, arm);
    turn_vector(tool->orientation, -1.0, arm, place);
    hull_measure(hull_of_tool(tool), place, near);
}

double contact_hull_distance(const palp_tool *tool, const double point[3]) {
    hull_near near;
    double place[3];
    measure_point(tool, point, place, &near);
    return fmax(near.distance, 0.0);
}

/* A point within the hull leaves it by the face that the surface there meets. */
static void leave_hull(const palp_tool *tool, const double outward[3], const double place[3],
                       hull_near *near) {
    double way[3];
    turn_vector(tool->orientation, -1.0, outward, way);
    const hull_face *exit = hull_exit(hull_of_tool(tool), place, way);
    if (!exit)
        return;
    near->face = exit;
    near->distance = dot3(exit->normal, place) - exit->offset;
    memcpy(near->normal, exit->normal, sizeof near->normal);
}

void contact_hull_measure(const palp_tool *tool, contact *c, const double *x) {
    hull_near near;
    double place[3];
    contact_point(c, c->share, x, c->point);
    measure_point(tool, c->point, place, &near);
    if (near.distance < 0.0)
        leave_hull(tool, c->outward, place, &near);
    turn_vector(tool->orientation, 1.0, near.normal, c->normal);
    c->round = near.round;
    if (near.round)
        turn_vector(tool->orientation, 1.0, near.along, c->straight);
    c->over = near.face;
    c->distance = fmax(near.distance, 0.0);
    c->depth = tool->radius_m - near.distance;
}

double contact_hull_inset(const palp_tool *tool, const contact *c) {
    double arm[3], place[3];
    if (!c->over)
        return 0.0;
    along3(c->point, -1.0, tool->position_m, arm);
    turn_vector(tool->orientation, -1.0, arm, place);
    return hull_inset(hull_of_tool(tool), c->over, place);
}

void contact_hull_centre(const palp_tool *tool, double point[3]) {
    if (tool->hull)
        point_of_hull(tool, tool->hull->centre, point);
}

void contact_hull_box(const palp_tool *tool, double around, double low[3], double high[3]) {
    const palp_hull *hull = hull_of_tool(tool);
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (size_t i = 0; i < hull->n_corners; i++) {
        double corner[3];
        point_of_hull(tool, hull->corner + 3 * i, corner);
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], corner[k] - around);
            high[k] = fmax(high[k], corner[k] + around);
        }
    }
}

double contact_thickness(const palp_tool *tool) {
    return tool->radius_m + (tool->shape == PALP_TOOL_HULL ? hull_of_tool(tool)->inner : 0.0);
}

/* ---- orientations -------------------------------------------------------------------------------- */

/* Of no orientation that which does not turn. */
static void orientation_of_tool(const palp_tool *tool, double q[4]) {
    memcpy(q, tool->orientation, sizeof tool->orientation);
    if (q[0] == 0.0 && dot3(q + 1, q + 1) == 0.0)
        q[0] = 1.0;
}

/* The rotation between two poses. False: neither has an orientation. */
static bool turn_between_poses(const palp_tool *was, const palp_tool *is, double turn[4]) {
    static const double NONE[4] = {0.0};
    if (memcmp(was->orientation, NONE, sizeof NONE) == 0 && memcmp(is->orientation, NONE, sizeof NONE) == 0)
        return false;
    double from[4], to[4], across[3];
    orientation_of_tool(was, from);
    orientation_of_tool(is, to);
    cross3(from + 1, to + 1, across);
    turn[0] = from[0] * to[0] + dot3(from + 1, to + 1);
    for (int k = 1; k < 4; k++)
        turn[k] = from[0] * to[k] - to[0] * from[k] + across[k - 1];
    return true;
}

bool contact_turn_arm(const palp_tool *was, const palp_tool *is, const double arm[3], double moved[3]) {
    double turn[4], turned[3];
    if (!turn_between_poses(was, is, turn))
        return false;
    turn_vector(turn, 1.0, arm, turned);
    for (int k = 0; k < 3; k++)
        moved[k] += turned[k] - arm[k];
    return true;
}

double contact_turned(const palp_tool *was, const palp_tool *is) {
    double turn[4];
    if (is->shape == PALP_TOOL_PLANE || !turn_between_poses(was, is, turn))
        return 0.0;
    const double size = is->shape == PALP_TOOL_HULL ? hull_of_tool(is)->size : 0.0;
    return (is->radius_m + size) * 2.0 * atan2(sqrt(dot3(turn + 1, turn + 1)), fabs(turn[0]));
}

/* Linear interpolation between the quaternions, normalized. A quaternion's negative is the same rotation. */
void contact_turn_between(const palp_tool *was, const palp_tool *is, double share, double orientation[4]) {
    double turn[4], from[4], to[4];
    if (!turn_between_poses(was, is, turn))
        return;
    orientation_of_tool(was, from);
    orientation_of_tool(is, to);
    const double sign = turn[0] < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 4; k++)
        orientation[k] = (1.0 - share) * from[k] + sign * share * to[k];
    const double length = sqrt(orientation[0] * orientation[0] + dot3(orientation + 1, orientation + 1));
    for (int k = 0; k < 4; k++)
        orientation[k] /= length;
}
