/* cut_internal.h: what cutting adds to a network's solution. Internal.
 *
 * Parts that no support and no grasp holds in place are tied to their last committed place by weak springs,
 * and every tangent of a cut network gets a still weaker diagonal, so that mechanisms are no singular
 * systems. The diagonal is in the tangent only: what is converged to has no spring at a node that is tied to
 * a support. */
#ifndef CUT_INTERNAL_H
#define CUT_INTERNAL_H

#include "base/arena.h"
#include "network/network_internal.h"

#include <palpate/cut.h>

/* The surface of the tetrahedra without a cut edge. */
typedef struct cut_surface {
    const int32_t *tetrahedra; /* mesh's */
    size_t n_tetrahedra, n_triangles;
    unsigned char *broken; /* [n_tetrahedra] has an edge that is cut */
    size_t *first;         /* [n_elements + 1] of each element, in around */
    int32_t *around;       /* [6 n_tetrahedra] tetrahedra that have the element as an edge */
    int32_t *neighbour;    /* [4 n_tetrahedra] across the faces, -1 = none */
    int32_t *triangles;    /* [3 n_triangles], room for 12 n_tetrahedra */
} cut_surface;

/* Its arrays are of the arena. */
palp_status cut_surface_create(const palp_network *net, arena *memory, cut_surface *surface);
void cut_surface_whole(cut_surface *surface);

/* The surface once these elements are cut too. */
void cut_surface_update(cut_surface *surface, size_t n, const int32_t *elements);

/* The cuts of a network. */
typedef struct network_cut {
    network_term term;
    unsigned char *alive; /* [n_elements] */
    unsigned char *fixed; /* [n_nodes] has a support or is grasped */
    unsigned char *loose; /* [n_nodes] */
    size_t n_cut, n_known, n_loose;
    int32_t *cut;      /* [n_elements] the n_cut elements that are cut; the rest knows of n_known */
    int32_t *root;     /* [n_nodes] scratch */
    signed char *side; /* [n_nodes] scratch */
    double *whole;     /* [n_elements] the network's scale of uncut elements */
    double *stiffness; /* [n_nodes] N/m, of the elements that met in the node, uncut and at rest */
    double *diagonal;  /* [n_nodes] N/m, on the tangent */
    cut_surface surface;
    double tear_strain, tear_force;
} network_cut;

/* The cuts of a network that can be cut, or NULL. */
network_cut *cut_of(const palp_network *net);

/* Stiffness of the spring of node i to its committed place, N/m; 0 unless it is loose. */
double cut_spring(const network_cut *cut, size_t i);

/* ---- cut_blade.c ---- */

/* Sides of the plane of a triangle on which n nodes at x[3 n] are: +1 or -1; 0 if the triangle is none. */
void cut_sides(size_t n, const double *x, const double corners[9], signed char *side);

/* Does the line from p to q, on different sides, cross the triangle? */
bool cut_crosses(const double *p, const double *q, const double *corners);

#endif
