/* network_cut.h: what cutting adds to a network's solution. Internal.
 *
 * Parts that nothing holds are tied to their last committed place by weak springs, and every tangent of a cut
 * network gets a still weaker diagonal, so that mechanisms are no singular systems. The diagonal is in the
 * tangent only: what is converged to has no spring at a node that a support holds. */
#ifndef NETWORK_CUT_H
#define NETWORK_CUT_H

#include <palpate/cut.h>

typedef struct network_cut {
    unsigned char *alive;      /* [n_elements] */
    unsigned char *loose;      /* [n_nodes] */
    unsigned char *broken;     /* [n_tetrahedra] has an edge that is cut */
    size_t n_cut, n_known, n_loose;
    int32_t *cut;              /* [n_elements] the n_cut elements that are cut; the rest knows of n_known */
    int32_t *root;             /* [n_nodes] scratch */
    signed char *side;         /* [n_nodes] scratch */
    double *whole;             /* [n_elements] the network's scale of uncut elements */
    double *stiffness;         /* [n_nodes] N/m, of the elements that met in the node, uncut and at rest */
    double *diagonal;          /* [n_nodes] N/m, on the tangent */
    const int32_t *tetrahedra; /* mesh's */
    size_t n_tetrahedra, n_triangles;
    size_t *first;             /* [n_elements + 1] of each element, in around */
    int32_t *around;           /* [6 n_tetrahedra] tetrahedra that have the element as an edge */
    int32_t *neighbour;        /* [4 n_tetrahedra] across the faces, -1 = none */
    int32_t *triangles;        /* [3 n_triangles], room for 12 n_tetrahedra */
    double tear_strain, tear_force;
} network_cut;

void network_cut_free(network_cut *cut); /* NULL is fine */

/* Everything whole again, for the present material: a part of palp_network_reset. */
void network_cut_reset(palp_network *net);

/* After measuring: cut elements get strain 0 and no direction. False if a whole one has collapsed. */
bool network_cut_measure(palp_network *net, double collapsed);

/* Stiffness of the spring of node i to its committed place, N/m; 0 unless it is loose. */
double network_cut_spring(const network_cut *cut, size_t i);

/* For save and restore: what is whole, alive[n_elements]; all the rest of a network_cut follows from it. */
void network_cut_set(palp_network *net, const unsigned char *alive);

/* Whatever is held or let go changes what is loose. */
void network_cut_held(palp_network *net);

/* ---- shared by cut*.c ---- */

/* Marks an element as cut, if it is whole. */
void network_cut_mark(network_cut *cut, size_t element);

/* Marks the elements that cross the triangle. */
void network_cut_blade(palp_network *net, const double corners_m[9]);

palp_status network_cut_surface_create(const palp_network *net, network_cut *cut);

/* The surface of the tetrahedra without a cut edge. */
void network_cut_surface_update(network_cut *cut);

#endif
