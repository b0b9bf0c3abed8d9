/* cut_internal.h: what cutting adds to a network's solution. Internal. Weak springs tie loose parts, which no
 * support and no grasp holds, to their last committed place. The tangent of a cut network gets a still weaker
 * diagonal, so that mechanisms do not make it singular. The diagonal is only in the tangent: the converged
 * solution has no such spring at nodes of parts that are not loose. */
#ifndef CUT_INTERNAL_H
#define CUT_INTERNAL_H

#include "base/arena.h"
#include "network/network_internal.h"

#include <palpate/cut.h>

/* Surface of the tetrahedra without cut edges. */
typedef struct cut_surface {
    const int32_t *tetrahedra; /* the mesh's */
    size_t n_tetrahedra, n_triangles;
    unsigned char *broken; /* [n_tetrahedra] has a cut edge */
    size_t *first;         /* [n_elements + 1] range of each element in around */
    int32_t *around;       /* [6 n_tetrahedra] tetrahedra of which the element is an edge */
    int32_t *neighbour;    /* [4 n_tetrahedra] tetrahedron across each face, -1 = none */
    int32_t *triangles;    /* [3 n_triangles], with room for 12 n_tetrahedra */
} cut_surface;

/* Its arrays belong to the arena. */
palp_status cut_surface_create(const palp_network *net, arena *memory, cut_surface *surface);
void cut_surface_whole(cut_surface *surface);

/* Updates the surface after these elements have been cut too. */
void cut_surface_update(cut_surface *surface, size_t n, const int32_t *elements);

/* The cuts of a network. */
typedef struct network_cut {
    network_term term;
    unsigned char *alive; /* [n_elements] */
    unsigned char *fixed; /* [n_nodes] is supported or grasped */
    unsigned char *loose; /* [n_nodes] */
    size_t n_cut, n_known, n_loose;
    int32_t *cut;      /* [n_elements] n_cut elements that are cut; update has dealt with n_known of them */
    int32_t *root;     /* [n_nodes] scratch */
    signed char *side; /* [n_nodes] scratch */
    double *whole;     /* [n_elements] the network's scale before cuts */
    double *stiffness; /* [n_nodes] N/m, of the uncut elements that met in the node, at rest */
    double *diagonal;  /* [n_nodes] N/m, added to the tangent */
    cut_surface surface;
    double tear_strain, tear_force;
} network_cut;

/* The cuts of a network that can be cut, or NULL. */
network_cut *cut_of(const palp_network *net);

/* Stiffness of the spring of node i to its committed place, N/m; 0 unless it is loose. */
double cut_spring(const network_cut *cut, size_t i);

/* ---- cut_blade.c ---- */

/* Side of a triangle's plane on which each of n nodes at x[3 n] is: +1 or -1; 0 for a degenerate triangle. */
void cut_sides(size_t n, const double *x, const double corners[9], signed char *side);

/* Does the line from p to q, which are on different sides, cross the triangle? */
bool cut_crosses(const double *p, const double *q, const double *corners);

#endif
