/* skin.h: a finer, smooth surface on a network's nodes, for tools to touch. Internal. Loop's subdivision
 * (Loop 1987) divides each triangle into four several times and puts the vertices on the scheme's limit
 * surface: each is a fixed weighted mean of nearby nodes. Edges that are sharp at rest, and borders, stay
 * sharp (Hoppe et al. 1994). On triangles a tool's force ripples with the distance of the nodes; this surface
 * removes most of that. */
#ifndef SKIN_H
#define SKIN_H

#include "base/arena.h"

#include <palpate/status.h>

#include <stdint.h>

/* Vertex v is the sum of weight[k] times node[k], for k from first[v] to first[v + 1], nodes ascending. A
 * pair is two nodes with weight in a common triangle, low <= high. Pairs are sorted by low, then high; those
 * of low are from pair_first[low] to pair_first[low + 1]. */
typedef struct skin {
    size_t n, n_nodes, n_triangles, n_pairs;
    int32_t *triangle; /* [3 n_triangles] outward, as the original ones */
    uint32_t *first;   /* [n + 1] */
    int32_t *node;
    double *weight;
    double *rest;           /* [3 n] */
    double *unit;           /* [n] its share of the nodes' stiffness */
    int32_t *faces;         /* [n_nodes] triangles of the network's surface at a node */
    uint32_t *around_first; /* [n + 1] triangles around vertex v: around[around_first[v]] to
                               around[around_first[v + 1]] */
    int32_t *around;
    uint32_t *home_first; /* [n_nodes + 1] vertices of triangles with their largest weight at a node:
                             home[home_first[node]] ... */
    int32_t *home;
    double reach;         /* largest distance of a vertex from that node, at rest, m */
    uint32_t *pair_first; /* [n_nodes + 1] */
    int32_t *low, *high;  /* [n_pairs] */
    size_t room;          /* largest number of nodes with weight in a triangle */
} skin;

/* A smooth surface with so many subdivisions, at least one; its arrays belong to the arena. unit[n_nodes]:
 * stiffness of each node, which is distributed to the vertices. */
palp_status skin_make(arena *memory, size_t n_nodes, const double *rest, size_t n_surface,
                      const int32_t *surface, const double *unit, size_t subdivisions, skin *s);

/* Distributes another stiffness of each node to its triangles and on to the vertices of their parts. */
void skin_share_stiffness(skin *s, size_t n_surface, const int32_t *surface, const double *unit);

/* The value at a vertex from values at nodes, in[3 n_nodes]. */
void skin_take_vertex(const skin *s, int32_t vertex, const double *in, double out[3]);

/* Adds a vertex's force to its nodes, out[3 n_nodes]. */
void skin_give_vertex(const skin *s, int32_t vertex, const double force[3], double *out);

/* The nodes of n vertices, ascending, into node[room], and their weights, share[n room]: vertex a and node i
 * at a * room + i. Returns the number of nodes. */
size_t skin_stencil(const skin *s, int n, const int32_t *vertex, int32_t *node, double *share);

/* Index of a pair, low <= high. */
uint32_t skin_pair(const skin *s, int32_t low, int32_t high);

#endif
