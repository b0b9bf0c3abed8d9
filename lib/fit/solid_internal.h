/* solid_internal.h: linear tetrahedra of a solid between plates. */
#ifndef SOLID_INTERNAL_H
#define SOLID_INTERNAL_H

#include "solve/linsys.h"

#include <palpate/solid.h>

/* Rate of E = (F'F - 1)/2 for a rate dF: the symmetric part of F'dF. With dF = F it is F'F. */
void solid_green(const double F[9], const double dF[9], double dE[9]);

/* The solid's body: allocated once, pressed as often as needed. Lengths in m. */
typedef struct solid_body {
    const palp_mesh *mesh;
    bool stable;         /* an unstable equilibrium is ERR_BUCKLED */
    unsigned char *held; /* [n_nodes] palp_solid_supports */
    int32_t *unknown;    /* [3 n_nodes] number of the unknown, or -1 */
    size_t n_unknowns;
    double *gradient;  /* [12 n_tetrahedra] of the four shape functions */
    double *volume_m3; /* [n_tetrahedra] */
    size_t *slot;      /* [144 n_tetrahedra] of each pair of axes in the matrix, or SIZE_MAX */
    linsys *matrix;
    double *x, *before;   /* [3 n_nodes] now, and before a step */
    double *residual;     /* [n_unknowns] */
    double *rate, *force; /* [3 n_nodes] dx / d depth, and a nodal force */
    double *work;         /* [n_unknowns] a step, then [3 n_nodes] */
} solid_body;

palp_status solid_body_create(const palp_mesh *mesh, bool slides, solid_body *body);
void solid_body_free(solid_body *body);

/* A plate's force at a depth. by_c_m2 is its derivative by each coefficient; their sum, weighted by c, is the
 * force. viscous times the rate of depth and the damping is the viscous force. */
typedef struct solid_feel {
    double by_c_m2[PALP_SOLID_MAX], viscous;
} solid_feel;

/* Presses from rest to depth_m[n], ascending. */
palp_status solid_body_press(solid_body *body, const palp_solid *solid, size_t n, const double *depth_m,
                             solid_feel *feel);

#endif
