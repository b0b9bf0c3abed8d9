/* hull.h: the convex hull of points, and the point of it that is nearest to another. Internal. */
#ifndef HULL_H
#define HULL_H

#include "base/arena.h"

#include <palpate/tool.h>

/* An edge as one of its two faces has it: the face is on the left, seen from outside. */
typedef struct hull_edge {
    size_t from, to; /* points */
    double start[3], along[3], length;
    double out[3]; /* unit vector in the face's plane, away from the face */
} hull_edge;

typedef struct hull_face {
    double normal[3], offset; /* outward; the plane is normal . x = offset */
    size_t first, n;          /* its edges */
} hull_face;

struct palp_hull {
    arena memory;
    size_t n_corners, n_faces, n_edges; /* each edge counts twice */
    double *corner;                     /* [3 n_corners] */
    hull_face *face;
    hull_edge *edge;
    double centre[3]; /* mean of the corners */
    double size;      /* distance of the farthest corner from the origin, m */
    double inner;     /* distance of the nearest face from the centre, m */
};

/* The point of a hull that is nearest to a given one, or within the hull the face of least depth. */
typedef struct hull_near {
    double distance, normal[3]; /* negative within; outward unit vector */
    bool round;                 /* it is on an edge or a corner, around which the distance bends */
    double along[3];            /* unit vector along that edge; 0 at a corner */
} hull_near;

/* hull: without faces everything is at an infinite distance. */
void hull_measure(const palp_hull *hull, const double point[3], hull_near *near);

/* The face by which a point within the hull leaves it if it goes against this direction; NULL: no faces. */
const hull_face *hull_exit(const palp_hull *hull, const double point[3], const double direction[3]);

#endif
