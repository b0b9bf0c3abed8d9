/* contact_internal.h: tools on a surface of nodes and triangles, of a network or another model. Internal.
 * Positions of nodes are x[3 n_nodes], m. */
#ifndef CONTACT_INTERNAL_H
#define CONTACT_INTERNAL_H

#include "base/arena.h"
#include "hull.h"
#include "network/network_internal.h"

#include <palpate/tool.h>

#include <math.h>

/* How a point of the surface resists at the depth u in a tool, N: (root sqrt(u) + linear u + steep u sqrt(u))
 * (1 + stiffening u), and beyond the limit, m, hard (u - limit) in addition. */
typedef struct contact_law {
    double root, linear, steep, stiffening, hard, limit;
} contact_law;

/* Error of where friction's spring starts, times the tissue's stiffness there, N: along its stretch if it
 * slipped, and across it or, if it stuck, in any direction. */
typedef struct contact_doubt {
    double along, across;
} contact_doubt;

/* The plane of a triangle: its outward unit normal, and gradients of barycentric coordinates on it, 1/m. */
typedef struct contact_plane {
    int32_t node[3]; /* {-1, ...}: of none */
    double outward[3], gradient[3][3];
} contact_plane;

/* Where a point of a triangle is in a sphere: away from its centre, which is height over the plane. u is the
 * depth along the normal, q the square of the way aside; d u = 2 across v dv - along dz (contact_face.c). */
typedef struct contact_dip {
    double away[3], height, depth, across, along, bend;
} contact_dip;

/* A point of the surface near a tool: a node, a fixed point of a triangle, or the point of a triangle that is
 * nearest to the tool. */
typedef struct contact {
    int32_t tool, node[3]; /* a node's contact has corners = 1, node[1] = node[2] = -1, share = {1, 0, 0} */
    int32_t corners, part; /* part: which of the fixed points of its triangle */
    bool fixed;            /* a fixed point of a triangle in a sphere or capsule (contact_face.c) */
    bool tissue;           /* the tool is a node of the surface (contact_self.c) */
    contact_law law;       /* of a fixed point or a hull's with local compliance; hard = 0: none */
    double early;          /* depth outside the tool at which its smoothing begins, m */
    double
        along; /* position on a capsule's axis of the nearest sphere, m; constant in a step for a triangle */
    double stiffness;      /* N/m */
    double stick_share[3]; /* barycentric coordinates of the point of friction, constant in a step */
    double anchor[3];      /* start of friction's spring, moves with the tool */
    double was[3];         /* stretch of friction's spring in the committed state, m */
    contact_doubt doubt;   /* of its start */
    bool touched;          /* touched in the committed state */
    int32_t memory;        /* its record there, or -1 */
    int material;          /* of the tissue there: its compliance relaxes as that does */
    double past;           /* pressure at no depth by what it remembers, N; at most 0 */
    double entry;          /* share of the step since contact began */
    /* at the last evaluation */
    double depth, pressure; /* m, N */
    double elastic;         /* pressure before any of it has relaxed, N */
    double share[3];        /* barycentric coordinates of the nearest point */
    double gradient[3][3];  /* of the shares on the triangle, 1/m; along the edge only on an edge, 0 in a
                               corner */
    double distance; /* from the point to the sphere's centre, negative if that is below the triangle, m; to a
                        hull's points, 0 within */
    bool round;      /* the nearest point of a hull is on an edge or a corner */
    double straight[3];    /* if so, unit vector along that edge; 0 at a corner */
    double outward[3];     /* of a point near a hull: normal of the surface there, constant in a step */
    const hull_face *over; /* the face of a hull that it is over or leaves the hull by; NULL: none */
    double inset;          /* distance from that face's outline at a step's start, m; 0 if there is none */
    double point[3];
    double normal[3];         /* unit vector from the tool into the tissue */
    double normal_tangent[6]; /* of the normal force at fixed shares: lower triangle xx yx yy zx zy zz */
    struct contact_face {     /* of a fixed point in a tool, see contact_face.c */
        contact_plane plane;
        contact_dip dip;
        double foot[3], slope, size;            /* foot: shares of the centre's foot */
        double deepening[3][3], widening[3][3]; /* d u / d x_i and d q / d x_i */
    } face;
    double stretch[3];  /* of friction's spring, m */
    double friction[3]; /* friction force on the tissue, N */
    double kept;        /* share of the spring's stretch that remains after slip: 1 = it sticks */
    double friction_tangent[6];
    double drag[3]; /* sliding friction: d friction / d displacement along the normal, N/m; 0 if it sticks */
} contact;

/* A contact that touched, with friction's spring. */
typedef struct contact_touch {
    int32_t tool, node[3], part;
    double stretch[3];
    contact_doubt doubt;
    double elastic, arm[PALP_ARMS_MAX]; /* N, of a contact that relaxes: its arms have these parts of it */
} contact_touch;

/* What palp_network_contacts says of a contact. */
typedef struct contact_told {
    palp_contact contact; /* without node and region */
    int32_t node[3];
    double share[3]; /* of its force, that these nodes take */
} contact_told;

/* How local compliance relaxes in a step, as the tissue's arms do: the pressure is share times the elastic
 * one, and what is kept of each arm. */
typedef struct contact_relaxation {
    size_t n_arms;
    double share, keep[PALP_ARMS_MAX], gain[PALP_ARMS_MAX];
} contact_relaxation;

/* What a state keeps of contacts. */
typedef struct contact_state {
    size_t n_tools, n_touches;
    palp_tool *pose;       /* [max_tools] */
    palp_tool_force *felt; /* [max_tools] */
    contact_touch *touch;  /* [max_contacts] */
    size_t n_told;
    contact_told *told; /* [max_contacts], not saved with the state */
} contact_state;

/* Nodes that tools may touch, and the triangles around each: around[first[i]] to around[first[i + 1]]. */
typedef struct contact_points {
    size_t n;
    const int32_t *node; /* [n] */
    const uint32_t *first;
    const int32_t *around;
} contact_points;

typedef struct contact_set {
    palp_contact_settings settings;
    size_t n_nodes, max_tools, max_contacts;
    size_t n_tools;
    palp_tool *tool;  /* [max_tools] as set by the caller */
    palp_tool *pose;  /* [max_tools] at the present evaluation */
    double share;     /* share of their way from the committed state */
    contact *contact; /* [max_contacts] */
    size_t n_contacts;
    const int32_t *surface; /* [3 n_surface] triangles, outward; owned by the caller */
    size_t n_surface;
    const double *rest;  /* [3 n_nodes] the caller's */
    int32_t *triangles;  /* [n_nodes] of the surface that meet in a node */
    const double *unit;  /* [n_nodes] a node's own stiffness over that of an element, 1/m; the caller's */
    const double *local; /* of a smooth surface: [n_nodes] Young's modulus times a point's area, over spacing
                            and the stiffness of an element, 1/m; or NULL */
    double spacing;      /* of the mesh's own nodes on that surface, m */
    double modulus;    /* instantaneous stiffness of an element at rest, N; set by the caller before place */
    double stiffening; /* contact_stiffening of the network's material; set by the caller before place */
    double solid;      /* stiffness of the surface by Poisson's ratio, over that at 1/4 */
    contact_relaxation relaxation[PALP_REGIONS_MAX + 1]; /* of the step, for each material of the tissue; set
                                                            by the caller before place */
    const unsigned char *material; /* [n_nodes] that around each node, or NULL = all 0; the caller's */
    double edge;                   /* mean edge of the surface at rest, m */
    contact_points points; /* if first is not NULL tools of all shapes touch these nodes, not triangles */
    contact_state now, next;
} contact_set;

/* ---- contact_set.c ---- */

/* rest and surface are at rest; edge replaces the mean edge where there are no triangles. Its arrays belong
 * to the arena. */
palp_status contact_set_create(contact_set *set, arena *memory, size_t n_nodes, const double *rest,
                               size_t n_surface, const int32_t *surface, const double *unit, double edge,
                               size_t max_tools, const palp_contact_settings *settings);
void contact_set_reset(contact_set *set);

/* Replaces the surface, with the same nodes. */
void contact_set_surface(contact_set *set, size_t n, const int32_t *surface);

/* Copies the poses for the next step. ERR_ARGUMENT: see palp_network_set_tools. */
palp_status contact_set_tools(contact_set *set, size_t n, const palp_tool *tools);

/* Puts tools at a share of their way from the committed state, with its nodes at committed; finds contacts at
 * x. */
void contact_set_place(contact_set *set, double share, const double *committed, const double *x);

/* Largest distance that a tool moves or appears in since the committed state, in strides; 0 = none moves. */
double contact_set_way(const contact_set *set);

/* Forces at x, added to force[3 n_nodes]; *squares as for residual in network_term.h. */
void contact_set_evaluate(contact_set *set, const double *x, double *force, double *squares);

/* Finds contacts again at x if a contact's point is no longer the nearest to the tool; true if so. */
bool contact_set_refresh(contact_set *set, const double *committed, const double *x);

/* After a step solved at x: sets what set->next keeps. contact_set_swap makes next the committed state. */
void contact_set_finish(contact_set *set, const double *x);
void contact_set_swap(contact_set *set);

/* Largest friction force of a contact, N. */
double contact_friction_limit(const contact_set *set, const contact *c);

/* Error of its force at the last evaluation by errors of friction's history, N; and what the history has of
 * it after this step. Its point may be off by off[3] from the tool, m; where that is NULL its force by error,
 * N. */
double contact_force_doubt(const contact_set *set, const contact *c);
contact_doubt contact_doubt_to_keep(const contact_set *set, const contact *c, const double *off,
                                    double error);

/* Error of the forces at the last evaluation by errors of friction's history, summed, N. */
double contact_set_doubt(const contact_set *set);

/* After finish: adds this step's errors to that history. Points may be off by change[3 n_nodes], m; where
 * that is NULL the forces by error, N. */
void contact_set_keep_doubt(contact_set *set, const double *change, double error);

/* After finish: is a tool inside the body of surface[3 n] without touching it? */
bool contact_set_inside(const contact_set *set, size_t n, const int32_t *surface, const double *x);

/* Adds a force on the tissue, size times force at this point, to what the tool in this pose feels. */
void contact_feel(const palp_tool *pose, const double point[3], double size, const double force[3],
                  palp_tool_force *felt);

/* ---- contact_find.c ---- */

/* Fills set->contact with points near the tools at x; friction starts from the committed state. */
void contact_find(contact_set *set, const double *committed, const double *x);

/* Distance that a tool moves in this step to this pose, m. */
double contact_travel(const contact_set *set, const palp_tool *pose, size_t tool);

/* Distance over which a tool can be followed in one part, m. */
double contact_stride(const contact_set *set, const palp_tool *tool);

/* Distance from a point to a sphere's centre, a capsule's axis, a plane (0 behind it) or a hull's points (0
 * within), m. */
double contact_distance(const palp_tool *tool, const double point[3]);

/* low, high: the box around a sphere, capsule or hull, enlarged by slack beyond its radius. */
void contact_box(const palp_tool *tool, double slack, double low[3], double high[3]);

/* Distance along a capsule from the contact's point on the axis to that now nearest to its triangle, m. */
double contact_slid(const contact_set *set, const contact *c, const double *x);

/* ---- contact_point.c ---- */

/* Computes depth, normal, share, distance and gradient for the tool in this pose and nodes at x. */
void contact_measure(const palp_tool *tool, contact *c, const double *x);

/* Position on a capsule's axis nearest to a point, m; 0 for other tools. */
double contact_along(const palp_tool *tool, const double point[3]);

/* Force and tangent at x. */
void contact_evaluate(const contact_set *set, contact *c, const double *x);

/* The same; plane: of the fixed point before, or of none; becomes this one's. */
void contact_evaluate_next(const contact_set *set, contact *c, const double *x, contact_plane *plane);

/* out += -d force / d x times u, both [3 n_nodes]: the symmetric part; and all of it. */
typedef void contact_product(const contact *c, const double *u, double *out);
contact_product contact_times, contact_whole_times;

/* k[9] = -d force on corner a / d corner b, by rows. */
void contact_block(const contact *c, int a, int b, double k[9]);

/* Size of the force that is normal to the tool, N. */
double contact_normal_force(const contact *c);

/* Is its stiffness the tissue's, which relaxes, rather than a penalty? */
bool contact_relaxes(const contact_set *set, const contact *c);

/* Potential of its normal force, J. */
double contact_energy(const contact_set *set, const contact *c);

/* Barycentric coordinates of the point of a triangle nearest to p; and the distance to the triangle of these
 * nodes at x. */
void contact_nearest(const double *const corner[3], const double p[3], double share[3]);
double contact_nearest_distance(const double *x, const int32_t node[3], const double p[3], double share[3]);

/* ---- contact_hull.c: hulls, and how tools have turned ---- */

/* A point within a hull; it stays as it is if the tool has no hull. */
void contact_hull_centre(const palp_tool *tool, double point[3]);

/* As contact_distance and contact_box, around: all that it is enlarged by. */
double contact_hull_distance(const palp_tool *tool, const double point[3]);
void contact_hull_box(const palp_tool *tool, double around, double low[3], double high[3]);

/* As contact_measure for a hull: of the point with the contact's shares, which stay. */
void contact_hull_measure(const palp_tool *tool, contact *c, const double *x);

/* Distance of a measured point from the outline of the face that it is over, m; 0 if it is over none. */
double contact_hull_inset(const palp_tool *tool, const contact *c);

/* Half the least thickness of a hull, or another tool's radius, m. */
double contact_thickness(const palp_tool *tool);

/* Distance that a point of the tool moves at most about position_m by the orientations, m. */
double contact_turned(const palp_tool *was, const palp_tool *is);

/* Orientation at this share of the shorter way. */
void contact_turn_between(const palp_tool *was, const palp_tool *is, double share, double orientation[4]);

/* Adds to moved how a point with this arm moves by the orientations. False: neither has one. */
bool contact_turn_arm(const palp_tool *was, const palp_tool *is, const double arm[3], double moved[3]);

/* ---- contact_face.c: fixed points of triangles ---- */

/* The plane of these nodes at x, unless it is theirs already. */
void contact_plane_at(const int32_t node[3], const double *x, contact_plane *plane);

/* Where a point of that plane is in the sphere at a position on the tool's axis. */
void contact_dip_at(const palp_tool *tool, double along, const contact_plane *plane, const double point[3],
                    contact_dip *dip);

/* Share of corner i at the foot of the sphere's centre on the plane, if the point has this share. */
double contact_foot(const contact_plane *plane, const contact_dip *dip, int i, double share);

/* As contact_measure, contact_energy and contact_block; sets no more than the depth and the distance of a
 * point that is not in the tool. The energy is that of the elastic pressure, forces and the tangent are
 * without friction, k is added to. */
void contact_face_measure(const palp_tool *tool, contact *c, const double *x, contact_plane *plane);
double contact_face_energy(const contact_set *set, const contact *c, double depth);
void contact_face_block(const contact *c, int a, int b, double k[9]);
void contact_face_times(const contact *c, const double *u, double *out);

/* Elastic pressure at this depth, N, and its slope, N/m. */
double contact_face_elastic(const contact_set *set, const contact *c, double depth, double *slope);

/* By what part of modulus, N, a material's element gets stiffer for a strain of 1: its mean slope up to a
 * tenth, less up to a tenth. 0 for one that softens. */
double contact_stiffening(const palp_material *material, double modulus);

/* Prepares forces and tangent for this slope of the pressure. */
void contact_face_slopes(contact *c, double slope);

/* Pressure's force on corner i. */
void contact_face_push(const contact *c, int i, double force[3]);

/* Gives a contact its law: stiffness, N/m, is its part of that of its nodes, spacing that of the mesh there.
 */
void contact_face_law(const contact_set *set, const palp_tool *tool, double stiffness, double spacing,
                      contact *c);

/* Young's modulus times the area of a point over the spacing, N/m; stiffness as above. It is as in those
 * terms of that law which take off the mesh's own compliance. */
double contact_patch(const contact_set *set, double stiffness);

/* Gives a hull's point, whose stiffness is its penalty's, the local compliance below the rim of a face. It
 * acts to a depth by the hull's radius and thickness. Beyond that the penalty is added. Friction keeps the
 * penalty's stiffness. patch: Young's modulus times the point's area over the spacing, N/m. */
void contact_hull_law(const contact_set *set, const palp_tool *tool, double patch, double spacing,
                      contact *c);

/* ---- terms of a network ---- */

/* Term for tissue that touches itself (contact_self.c); NULL: out of memory. */
network_term *contact_self_new(const palp_network *net, const palp_contact_settings *settings);

/* The contacts of that term at the last committed state, without region; none where there is no term. */
const palp_contact *contact_self_told(const palp_network *net, size_t *n);

/* Term for grasped nodes (grasp.c); NULL: out of memory. */
network_term *grasp_new(size_t max_grasped, double stiffness);

/* The tools of a network, or NULL. */
contact_set *contact_of(const palp_network *net);

/* ---- vectors ---- */

static inline double dot3(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross3(const double *a, const double *b, double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* a + s b */
static inline void along3(const double *a, double s, const double *b, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + s * b[k];
}

/* Is it one below which the local compliance of a mesh is known? */
static inline bool contact_tool_is_round(const palp_tool *tool) {
    return tool->shape == PALP_TOOL_SPHERE || tool->shape == PALP_TOOL_CAPSULE;
}

/* Normal of a triangle, outward where its corners go round so; its length is twice the area. */
static inline void triangle_normal(const double *a, const double *b, const double *c, double normal[3]) {
    double ab[3], ac[3];
    along3(b, -1.0, a, ab);
    along3(c, -1.0, a, ac);
    cross3(ab, ac, normal);
}

/* Sum of share[i] times the contact's nodes in x[3 n_nodes]. */
static inline void contact_point(const contact *c, const double share[3], const double *x, double point[3]) {
    point[0] = point[1] = point[2] = 0.0;
    for (int i = 0; i < c->corners; i++)
        along3(point, share[i], x + 3 * c->node[i], point);
}

/* The node that has the largest share of a contact's nearest point. */
static inline int32_t contact_main_corner(const contact *c) {
    int most = 0;
    for (int j = 1; j < c->corners; j++)
        most = c->share[j] > c->share[most] ? j : most;
    return c->node[most];
}

static inline bool positive(double v) {
    return v > 0.0 && isfinite(v);
}

static inline bool finite3(const double v[3]) {
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

#endif
