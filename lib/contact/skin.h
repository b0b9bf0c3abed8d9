/* skin.h: a finer, smooth surface on a network's nodes, for tools to touch. Internal.
 * Loop's subdivision (Loop 1987): each triangle becomes four, so many times over, and each vertex lies on the
 * limit surface of the scheme, a fixed weighted mean of nodes near by. Edges that are sharp at rest, and
 * borders, stay sharp (Hoppe et al. 1994). What a tool feels on triangles ripples with the distance of the
 * nodes; on this surface most of that is gone. */
#ifndef SKIN_H
#define SKIN_H

#include "base/arena.h"

#include <palpate/status.h>

#include <stdint.h>

/* Vertex v is the sum of weight[k] times node[k], k from first[v] to first[v + 1], nodes ascending. Pairs:
 * two nodes that a triangle of the skin depends on both, low <= high, by low, then high: those of low from
 * pair_first[low] to pair_first[low + 1]. */
typedef struct skin {
    size_t n, n_nodes, n_triangles, n_pairs;
    int32_t *triangle; /* [3 n_triangles] outward as those it was made from */
    uint32_t *first;   /* [n + 1] */
    int32_t *node;
    double *weight;
    double *rest;           /* [3 n] */
    double *unit;           /* [n] share of the nodes' stiffness */
    uint32_t *around_first; /* [n + 1] triangles around vertex v: around[around_first[v]] to
                               around[around_first[v + 1]] */
    int32_t *around;
    uint32_t *home_first; /* [n_nodes + 1] vertices of the triangles that depend on a node most:
                             home[home_first[node]] ... */
    int32_t *home;
    double reach;         /* largest distance of a vertex from that node at rest, m */
    uint32_t *pair_first; /* [n_nodes + 1] */
    int32_t *low, *high;  /* [n_pairs] */
    size_t room;          /* nodes that a triangle depends on, at most */
} skin;

/* A skin of the surface with so many subdivisions, at least one; arrays are of the arena. unit[n_nodes]:
 * stiffness of each node, which is shared among the vertices. */
palp_status skin_make(arena *memory, size_t n_nodes, const double *rest, size_t n_surface,
                      const int32_t *surface, const double *unit, size_t subdivisions, skin *s);

/* out[3 n] of the vertices from in[3 n_nodes] of the nodes. */
void skin_take(const skin *s, const double *in, double *out);

/* The same of one vertex. */
void skin_take_vertex(const skin *s, int32_t vertex, const double *in, double out[3]);

/* Adds a vertex's force to those of its nodes, [3 n_nodes]. */
void skin_give_vertex(const skin *s, int32_t vertex, const double force[3], double *out);

/* The nodes that n vertices depend on, ascending, into node[room], and what each has of them, share[n room]:
 * of vertex a and node i at a * room + i. Returns their number. */
size_t skin_stencil(const skin *s, int n, const int32_t *vertex, int32_t *node, double *share);

/* Place of a pair, low <= high, among the pairs. */
uint32_t skin_pair(const skin *s, int32_t low, int32_t high);

#endif
