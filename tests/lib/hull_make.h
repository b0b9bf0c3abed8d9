/* hull_make.h: hulls as tools, for the tests. */
#ifndef HULL_MAKE_H
#define HULL_MAKE_H

#include "contact/contact_internal.h"

#include <check.h>
#include <string.h>

static inline palp_hull *box_hull(double x, double y, double z) {
    palp_hull *hull = NULL;
    ck_assert_int_eq(palp_hull_create_box((const double[]){x, y, z}, &hull, NULL), PALP_OK);
    return hull;
}

/* A prism along y, its sections polygons in circles of this radius. */
static inline palp_hull *cylinder_hull(size_t sides, double radius, double half) {
    double points[PALP_HULL_POINTS][3];
    palp_hull *hull = NULL;
    for (size_t i = 0; i < 2 * sides; i++) {
        const double angle = 2.0 * acos(-1.0) * (double)(i / 2) / (double)sides;
        memcpy(points[i], (double[]){radius * cos(angle), i % 2 ? half : -half, radius * sin(angle)},
               sizeof points[i]);
    }
    ck_assert_int_eq(palp_hull_create(2 * sides, points[0], &hull, NULL), PALP_OK);
    return hull;
}

static inline palp_tool hull_tool(const palp_hull *hull, double x, double y, double z, double radius,
                                  double friction) {
    return (palp_tool){.shape = PALP_TOOL_HULL,
                       .position_m = {x, y, z},
                       .radius_m = radius,
                       .friction = friction,
                       .hull = hull};
}

/* Turns a tool, on top of how it is turned, by an angle about an axis of unit length through its position. */
static inline void turn_tool(palp_tool *tool, const double axis[3], double angle) {
    const double w = cos(0.5 * angle), s = sin(0.5 * angle);
    double q[4], across[3];
    memcpy(q, tool->orientation, sizeof q);
    if (q[0] == 0.0 && dot3(q + 1, q + 1) == 0.0)
        q[0] = 1.0;
    cross3(axis, q + 1, across);
    tool->orientation[0] = w * q[0] - s * dot3(axis, q + 1);
    for (int k = 1; k < 4; k++)
        tool->orientation[k] = w * q[k] + s * (q[0] * axis[k - 1] + across[k - 1]);
}

#endif
