/* calculix.h: a network as a CalculiX deck. */
#ifndef PALPATE_CALCULIX_H
#define PALPATE_CALCULIX_H

#include <palpate/material.h>
#include <palpate/mesh.h>
#include <palpate/network.h>
#include <stdio.h>

/* CalculiX 2.20 resamples spring tables of 200 points or more and loses accuracy; an odd number has a point
 * at zero. */
enum { CALCULIX_POINTS_MAX = 199 };

typedef struct calculix_deck {
    const palp_mesh *mesh;
    const double *factor; /* of each element's force, or NULL: palp_network_element_scale */
    const palp_law *law;
    const char *model;        /* its name, for the heading */
    size_t n_solids, corners; /* palp_network_volume_solids */
    const int32_t *solids;
    const double *solid_Pa; /* palp_network_volume_moduli */
    size_t n_supports;
    const palp_support *supports;
    size_t n_depths;
    const double *depth_m;
    double height_m;
    double step_strain;  /* largest increment, depth / height */
    double table_strain; /* the tables reach from -table_strain to table_strain */
    size_t table_points; /* odd, 5 <= n <= CALCULIX_POINTS_MAX */
} calculix_deck;

/* Writes the deck in mm and N. The caller looks at ferror. */
palp_status calculix_write(const calculix_deck *deck, FILE *to);

/* Least-squares fit of K(e) e by a continuous piecewise linear function on n knots strain[0] = 0 < strain[1]
 * ..., zero at 0. Unlike interpolation it has no bias. */
void calculix_table(const palp_law *law, size_t n, const double *strain, double *force_N);

#endif
