/* tool.h: rigid tools that touch a network, gravity, and nodes that are grasped. Stable. */
#ifndef PALPATE_TOOL_H
#define PALPATE_TOOL_H

#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum palp_tool_shape {
    PALP_TOOL_SPHERE,
    PALP_TOOL_CAPSULE, /* a cylinder with round ends */
    PALP_TOOL_PLANE,   /* the half space behind a plane */
    PALP_TOOL_HULL     /* the convex hull of points, with round edges */
} palp_tool_shape;

/* The convex hull of points: a box, a wedge, a jaw. Lengths in m, in a frame of its own. */
typedef struct palp_hull palp_hull;

enum { PALP_HULL_POINTS = 64 };

/* Makes the hull of points_m[3 n]; those inside it are dropped. Points within a millionth of its size of a
 * plane count as on it. The caller owns *hull, which any number of tools and networks may share. error may be
 * NULL. ERR_ARGUMENT: fewer than 4 points, a number that is not finite; ERR_LIMIT: more than
 * PALP_HULL_POINTS; ERR_INPUT: all points lie in a plane, or nearly so; ERR_NO_MEMORY. */
PALP_API palp_status palp_hull_create(size_t n, const double *points_m, palp_hull **hull, palp_error *error);

/* The box from -half_m to half_m on each axis. Errors as above. */
PALP_API palp_status palp_hull_create_box(const double half_m[3], palp_hull **hull, palp_error *error);

PALP_API void palp_hull_free(palp_hull *hull); /* NULL is allowed */

/* A tool and its pose, in the mesh's coordinates. Contact is one-sided: a penalty force where the surface is
 * inside the tool, quadratic in the depth at first touch and linear beyond, with Coulomb friction. A plane
 * touches nodes of the surface. A sphere or capsule touches triangles in fixed points, so that even a small
 * tool has contact between nodes. A hull touches them in fixed points too, each with its part of the penalty
 * of a plane. Within 2 edges of the outline of a face a point also has the local compliance that the mesh
 * lacks there. It acts to at most the depth of radius_m (doc/numerics.md). With subdivisions tools touch the
 * vertices of a smooth surface instead: Loop's limit surface (Loop 1987, Hoppe et al. 1994) of nodes smoothed
 * once by the same scheme. Its vertices are fixed means of nearby nodes, so that a sliding tool feels little
 * of the mesh. A tool should be thicker than its triangles.
 *
 * A hull's frame is turned by orientation and then has its origin at position_m. Of other shapes orientation
 * is their rotation, which matters for friction only: a sphere that spins drags the tissue. Where it is zero
 * now and before, a capsule or plane turns as its axis does, without spin. */
typedef struct palp_tool {
    palp_tool_shape shape;
    double position_m[3]; /* sphere: centre; capsule: the centre of its first end; plane: a point of it; hull:
                             the origin of its frame */
    double axis[3];  /* unit vector: the capsule's, towards its other end; the plane's normal, towards the
                        tissue */
    double length_m; /* capsule: between the centres of its ends */
    double
        radius_m; /* sphere, capsule; hull: by which it is thicker all round, so that its edges are round */
    double friction;       /* Coulomb's coefficient, 0 = smooth */
    double orientation[4]; /* unit quaternion w, x, y, z from the tool's own frame to the mesh's; all zero:
                              not turned */
    const palp_hull *hull; /* of PALP_TOOL_HULL; the caller's, who keeps it while the network has the tool */
} palp_tool;

/* Force of the tissue on a tool, and its moment about position_m. */
typedef struct palp_tool_force {
    double force_N[3];
    double moment_Nm[3];
    size_t contacts; /* points in contact */
    double depth_m;  /* largest depth of a point inside the tool */
} palp_tool_force;

#define PALP_CONTACT_TISSUE ((size_t)-1)

/* One point in contact. The tissue is pushed there by normal_N times normal, and by friction_N. Where tissue
 * touches tissue, a node is pushed so by a triangle of the surface, which takes the opposite force. */
typedef struct palp_contact {
    size_t tool;       /* its index, or PALP_CONTACT_TISSUE */
    double place_m[3]; /* on the surface of the tissue */
    double normal[3];  /* unit vector from the tool into the tissue, or from the triangle to the node */
    double normal_N;   /* 0 or more */
    double friction_N[3];
    double depth_m; /* inside the tool */
    bool slips;     /* friction is at its limit */
    int32_t node;   /* the network's node that takes the largest part of the force */
    int32_t other;  /* the one that takes the largest part of the opposite force; -1 = a tool */
    int region;     /* index of the region that has most of the tissue around that node, or -1 */
} palp_contact;

typedef struct palp_contact_settings {
    double stiffness; /* of the penalty, relative to a surface node's stiffness by its elements at rest with
                         all arms; shared among its triangles and their points; 20 */
    double grasp_stiffness; /* of the spring to a grasped node's target, in the same units; 100 */
    double smoothing;       /* depth at which the penalty becomes linear, of the surface's mean edge; 0.01 */
    /* Times that each triangle of the surface becomes four for tools to touch, see palp_tool; at most 4.
     * 0 = tools touch the mesh's own. 2 for a sphere of the mesh's edges in size, 3 for a smaller one. For
     * spheres and capsules stiffness is then not used: each vertex has the local compliance that the mesh
     * lacks (doc/numerics.md), so the force hardly depends on the spacing of the nodes. */
    size_t subdivisions;
    /* Without subdivisions: spheres and capsules touch triangles in points with the local compliance that the
     * mesh lacks (doc/numerics.md). The force then hardly depends on where between the nodes a tool is.
     * stiffness then only keeps a tool from sinking in by more than half its radius. Otherwise each triangle
     * is touched in its nearest point, which is up to four times too stiff. true */
    bool local;
    /* Tissue touches itself, and other tissues of the mesh (palp_mesh_join): nodes of the surface touch its
     * triangles, apart from those next to them. A node stays on its side of a triangle, wherever a step takes
     * it. Tissues that overlap at rest do not touch. max_tools may be 0. false */
    bool tissue;
    double tissue_stiffness; /* of that penalty on either side, in the units of stiffness; 5 */
    double tissue_friction;  /* Coulomb's coefficient of tissue on tissue; 0 */
    size_t max_contacts;     /* points near tools at once, others are ignored; 0 = as many as possible */
    double gravity_m_s2[3];  /* acts on the network's mass; 0 */
} palp_contact_settings;

PALP_API palp_contact_settings palp_contact_settings_default(void);

/* Prepares a network for up to max_tools tools and max_grasped grasped nodes; all memory is allocated
 * here. Resets the network; possible once. ERR_ARGUMENT: a setting out of range, gravity for a network
 * without mass, done before; ERR_NO_MEMORY; ERR_UNSUPPORTED: tools for a mesh without triangles
 * (palp_mesh_triangles), subdivisions of a network that can be cut. */
PALP_API palp_status palp_network_enable_tools(palp_network *network, size_t max_tools, size_t max_grasped,
                                               const palp_contact_settings *settings);

/* Sets the tools for the next steps until the next call; they are copied. A tool is identified by its index.
 * It moves on a straight line from its place at the last committed step, and turns by the shorter way. A step
 * follows it in parts of at most half an edge of the surface. They are at most a quarter of its radius long,
 * of a hull its whole radius. ERR_ARGUMENT: more than max_tools; a number that is not finite; an axis
 * (capsule, plane) or orientation that is no unit vector within 1e-6, unless the orientation is zero; a
 * radius that is not positive; a negative length or friction; no hull. A saved state has no hulls: a tool
 * restored has that of its index at present, and without one touches nothing until the tools are set. */
PALP_API palp_status palp_network_set_tools(palp_network *network, size_t n, const palp_tool *tools);

/* Force on each tool at the last committed state, force[n of set_tools]; zeros before the first step of a
 * tool. ERR_ARGUMENT: not enabled. */
PALP_API palp_status palp_network_tool_force(const palp_network *network, palp_tool_force *force);

/* Points in contact at the last committed state, those of a tool together: the first room of them into
 * contacts[room], their number into *n. Their forces add up to what palp_network_tool_force has, in a tick of
 * palp_realtime_step but for its force_error_N. A restored state has none before its next step.
 * ERR_ARGUMENT: not enabled. */
PALP_API palp_status palp_network_contacts(const palp_network *network, size_t room, palp_contact *contacts,
                                           size_t *n);

/* Grasps: a stiff spring ties each of these nodes to target_m[3 n] from the next step on. A node already
 * grasped gets a new target. Drops a trial step. ERR_LIMIT: more than max_grasped, nothing done;
 * ERR_ARGUMENT: no such node, a number that is not finite. */
PALP_API palp_status palp_network_grasp(palp_network *network, size_t n, const int32_t *nodes,
                                        const double *target_m);

/* Releases nodes; those that are not grasped are ignored. ERR_ARGUMENT: no such node. */
PALP_API palp_status palp_network_release(palp_network *network, size_t n, const int32_t *nodes);

/* Sum of the forces of these grasped nodes on the hand at the last committed state, N; one not grasped adds
 * nothing. ERR_ARGUMENT: no such node. */
PALP_API palp_status palp_network_grasp_force(const palp_network *network, size_t n, const int32_t *nodes,
                                              double force_N[3]);

#ifdef __cplusplus
}
#endif
#endif
