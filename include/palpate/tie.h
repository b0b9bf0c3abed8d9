/* tie.h: threads and rods that hold tissue: sutures, ligaments, a string in a hand. Stable. */
#ifndef PALPATE_TIE_H
#define PALPATE_TIE_H

#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_TIE_POINTS = 16 };

/* A point of the tissue, the sum of share times the places of its nodes, or a place of its own. */
typedef struct palp_tie_point {
    int32_t node[4];   /* node[0] = -1: place_m is the point; nodes of share 0 are not looked at */
    double share[4];   /* add up to 1 */
    double place_m[3]; /* follows a straight line in a step, from where it was at the last committed one */
} palp_tie_point;

/* A thread through points. It runs freely through those between its ends, so that its tension is the same
 * all along: stiffness times the elongation beyond length_m, and none while it is slack. */
typedef struct palp_tie {
    size_t n_points; /* 2 to PALP_TIE_POINTS */
    palp_tie_point point[PALP_TIE_POINTS];
    double length_m;      /* without force, 0 or more; a step follows its change */
    double stiffness_N_m; /* of the whole length */
    double strength_N;    /* above this tension after a step it tears; INFINITY = never */
    bool rod;             /* pushes too where it is shorter than length_m */
} palp_tie;

typedef struct palp_tie_state {
    double force_N;  /* tension, negative in a rod that pushes; 0 of a torn tie */
    double length_m; /* through its points */
    bool torn;
} palp_tie_state;

/* The point of the mesh nearest to place_m, at rest: in a tetrahedron, on the surface, or for a mesh without
 * tetrahedra at a node. ERR_ARGUMENT: a number that is not finite. */
PALP_API palp_status palp_tie_point_at(const palp_mesh *mesh, const double place_m[3], palp_tie_point *point);

/* Prepares a network for up to max_ties ties; all memory is allocated here. Resets the network; possible
 * once. ERR_ARGUMENT: done before; ERR_NO_MEMORY. */
PALP_API palp_status palp_network_enable_ties(palp_network *network, size_t max_ties);

/* Sets the ties from the next step until the next call; they are copied. A tie is identified by its index: it
 * stays torn until the ties are set without it. Drops a trial step. A reset keeps the ties, whole.
 * ERR_ARGUMENT: not enabled, more than max_ties, a number out of range, no such node; ERR_LIMIT: together
 * they join more than 500 pairs of nodes for each of max_ties. */
PALP_API palp_status palp_network_set_ties(palp_network *network, size_t n, const palp_tie *ties);

/* state[n of set_ties] at the last committed state. ERR_ARGUMENT: not enabled. */
PALP_API palp_status palp_network_ties(const palp_network *network, palp_tie_state *state);

/* Length through the points of a tie at the last committed state, m: for one that is to be taut there.
 * ERR_ARGUMENT: see palp_network_set_ties. */
PALP_API palp_status palp_network_tie_length(const palp_network *network, const palp_tie *tie,
                                             double *length_m);

#ifdef __cplusplus
}
#endif
#endif
