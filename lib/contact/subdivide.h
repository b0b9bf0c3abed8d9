/* subdivide.h: Loop's subdivision (Loop 1987), with creases (Hoppe et al. 1994). Internal. */
#ifndef SUBDIVIDE_H
#define SUBDIVIDE_H

#include <palpate/status.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Row i: weight[k] of node[k], k from first[i] to first[i + 1], nodes ascending. */
typedef struct weight_rows {
    size_t n, room;
    uint32_t *first; /* [n + 1] */
    int32_t *node;   /* [room] */
    double *weight;  /* [room] */
} weight_rows;

/* A surface by its nodes: vertices, of which the first n_nodes belong to one node each, and outward
 * triangles. */
typedef struct subdivided {
    weight_rows vertex;
    size_t n_triangles;
    int32_t *triangle; /* [3 n_triangles]; parts of triangle i of the mesh are contiguous */
} subdivided;

/* Moves the surface's nodes to their limits, then subdivides it so many times, with each vertex on the limit
 * surface. False: out of memory, nothing to free. Moving the nodes first spreads each vertex over more nodes,
 * which leaves a quarter of the ripple. Edges above 40 degrees at rest and borders stay sharp. */
bool subdivide_make(size_t n_nodes, const double *rest, size_t n_surface, const int32_t *surface,
                    size_t subdivisions, subdivided *out);
void subdivide_free(subdivided *s);

#endif
