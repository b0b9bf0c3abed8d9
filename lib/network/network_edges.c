/* network_edges.c: cells at an edge between a bonded face and a free one. The solid's stress is singular
 * there. A cell does not follow that, and takes too much energy. Without a correction the force of a whole
 * block is too large by several per cent, and approaches the solid's slowly. A factor on the stiffness of
 * these cells alone takes that error away. It depends on Poisson's ratio, not on the spacing
 * (energy-corrected finite elements: Egger, Ruede and Wohlmuth 2014, SIAM J. Numer. Anal. 52, 171). */
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cubic cells have the factor LEAST + MORE sqrt(1 - 2 nu), to 0.013, in a strip of ten between bonded plates.
 * With six it is up to 0.01 more, with 24 up to 0.013 less. A cube lacks one less this factor of its
 * stiffness. A cell that is r times as long away from the free face as from the bonded one lacks r^POWER
 * times as much. That was found for 1 / LONGEST to LONGEST (data/contact/edge_factor.py). */
static const double LEAST = 0.6, MORE = 0.478, POWER = -2.0 / 3.0, LONGEST = 1.5;

enum { CORNERS = 8, TETRAHEDRA = 6 };

typedef struct cell {
    int32_t node[CORNERS];
    bool surface[3][2], bonded[3][2]; /* faces by axis and side */
} cell;

/* Which nodes no axis of which is free. */
static palp_status find_held(const palp_mesh *mesh, size_t n_supports, const palp_support *supports,
                             unsigned char *held) {
    for (size_t s = 0; s < n_supports; s++) {
        size_t n;
        const int32_t *node;
        const palp_status status = palp_mesh_set(mesh, supports[s].set, &n, &node);
        for (size_t i = 0; i < 3 * n && !status; i++)
            if (supports[s].axis[i % 3] != PALP_FREE)
                held[node[i / 3]] |= (unsigned char)(1U << i % 3);
        if (status)
            return status;
    }
    return PALP_OK;
}

/* The face of a cell that has these three nodes. */
static void mark_face(cell *c, const int32_t triangle[3]) {
    unsigned high = CORNERS - 1, low = CORNERS - 1;
    for (size_t i = 0; i < 3; i++)
        for (unsigned corner = 0; corner < CORNERS; corner++)
            if (c->node[corner] == triangle[i]) {
                high &= corner;
                low &= ~corner;
            }
    for (unsigned k = 0; k < 3; k++) {
        c->surface[k][0] |= low >> k & 1U;
        c->surface[k][1] |= high >> k & 1U;
    }
}

static void find_faces(const palp_mesh *mesh, const int32_t *neighbour, const unsigned char *held, size_t i,
                       cell *c) {
    memset(c, 0, sizeof *c);
    for (size_t corner = 0; corner < CORNERS; corner++)
        c->node[corner] = mesh->hexahedra[CORNERS * i + mesh_gmsh_corner[corner]];
    for (size_t t = TETRAHEDRA * i; t < TETRAHEDRA * (i + 1); t++)
        for (size_t f = 0; f < 4; f++) {
            int32_t triangle[3];
            if (neighbour[4 * t + f] >= 0)
                continue;
            mesh_face(mesh->tetrahedra + 4 * t, f, triangle);
            mark_face(c, triangle);
        }
    for (size_t k = 0; k < 3; k++)
        for (size_t side = 0; side < 2; side++) {
            c->bonded[k][side] = c->surface[k][side];
            for (size_t corner = 0; corner < CORNERS; corner++)
                c->bonded[k][side] &= (corner >> k & 1U) != side || held[c->node[corner]] == 7;
        }
}

/* Mean length of the four edges of a cell along an axis. */
static double mean_edge(const palp_mesh *mesh, const cell *c, size_t axis) {
    double sum = 0.0, n[3];
    for (size_t corner = 0; corner < CORNERS; corner++)
        if (!(corner >> axis & 1U))
            sum += mesh_direction(mesh, (int32_t[]){c->node[corner], c->node[corner | 1U << axis]}, n);
    return sum / 4.0;
}

/* What the cell lacks of its stiffness over what a cube does, mean over its edges; 0 without such an edge. */
static double edges_of_cell(const palp_mesh *mesh, const cell *c) {
    double sum = 0.0, edges = 0.0;
    for (size_t k = 0; k < 3; k++)
        for (size_t l = 0; l < 3; l++)
            for (size_t sides = 0; sides < 4; sides++) {
                const size_t side = sides & 1U, other = sides >> 1U;
                if (k == l || !c->bonded[k][side] || !c->surface[l][other] || c->bonded[l][other])
                    continue;
                const double ratio = mean_edge(mesh, c, l) / mean_edge(mesh, c, k);
                sum += pow(fmin(fmax(ratio, 1.0 / LONGEST), LONGEST), POWER);
                edges += 1.0;
            }
    return edges > 0.0 ? sum / edges : 0.0;
}

bool network_has_edges(const palp_mesh *mesh, const palp_network_settings *settings) {
    return settings->edge_correction && settings->volume_modulus_Pa == 0.0 && palp_mesh_element_scale(mesh) &&
           mesh_has_cells(mesh);
}

palp_status network_edge_factors(const palp_mesh *mesh, const palp_network_settings *settings,
                                 size_t n_supports, const palp_support *supports, double *of_solid) {
    const double ratio = fmax(0.25, settings->poisson_ratio),
                 lacks = 1.0 - LEAST - MORE * sqrt(1.0 - 2.0 * ratio);
    unsigned char *held = calloc(mesh->n_nodes + 1, 1);
    int32_t *neighbour = malloc((4 * mesh->n_tetrahedra + 1) * sizeof *neighbour);
    palp_status status = held && neighbour ? find_held(mesh, n_supports, supports, held) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = mesh_neighbours(mesh, neighbour);
    for (size_t i = 0; i < mesh->n_hexahedra && !status; i++) {
        cell c;
        find_faces(mesh, neighbour, held, i, &c);
        of_solid[i] = 1.0 - lacks * edges_of_cell(mesh, &c);
    }
    free(held);
    free(neighbour);
    return status;
}
