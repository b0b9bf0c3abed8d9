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
    const hull_face *face;      /* that it is on or, from within, nearest to; NULL: an edge or a corner */
    bool round;                 /* it is on an edge or a corner, around which the distance bends */
    double along[3];            /* unit vector along that edge; 0 at a corner */
} hull_near;

/* hull: without faces everything is at an infinite distance. */
void hull_measure(const palp_hull *hull, const double point[3], hull_near *near);

/* The face by which a point within the hull leaves it, if it is on a surface with this outward normal: that
 * of least depth over how it faces that surface; NULL: none does. Tissue below a punch thus stays below it.
 */
const hull_face *hull_exit(const palp_hull *hull, const double point[3], const double outward[3]);

/* How a face or tool meets a surface, by the cosine between its normal and the surface's, reversed: 1 from
 * above, less from the side, 0 from behind. */
double hull_facing(double cosine);

/* Distance of a point over a face from the face's outline, m. */
double hull_inset(const palp_hull *hull, const hull_face *face, const double point[3]);

#endif
