/* hull.c: the convex hull of a few points, by trying all planes through three of them. */
#include "hull.h"

#include "base/file.h"
#include "contact_internal.h"

#include <stdlib.h>
#include <string.h>

static const double FLAT = 1e-6; /* of the size: so near to a plane or line a point is on it */

static const double STEEP = 0.5; /* cosine below which a tool meets a surface from the side, to 0 at 90 deg */

/* What the hull is made of. A set of points is a word with a bit for each. */
typedef struct making {
    palp_hull *hull;
    size_t n;
    double point[PALP_HULL_POINTS][3];
    double near;                       /* FLAT times the size, m */
    uint64_t on[2 * PALP_HULL_POINTS]; /* points of each face's plane */
} making;

/* ---- making -------------------------------------------------------------------------------------- */

static double distance3(const double *a, const double *b) {
    double d[3];
    along3(a, -1.0, b, d);
    return sqrt(dot3(d, d));
}

/* Copies points but those that are at an earlier one's place. */
static void take_points(making *m, size_t n, const double *points) {
    double size = 0.0;
    for (size_t i = 1; i < n; i++)
        size = fmax(size, distance3(points + 3 * i, points));
    m->near = FLAT * size;
    for (size_t i = 0; i < n; i++) {
        bool again = false;
        for (size_t j = 0; j < m->n; j++)
            again = again || distance3(points + 3 * i, m->point[j]) <= m->near;
        if (!again)
            memcpy(m->point[m->n++], points + 3 * i, sizeof *m->point);
    }
}

/* The plane through three points, if all others are on it or on one side, which is inside. False: it is no
 * face. */
static bool find_plane(const making *m, const size_t three[3], hull_face *face, uint64_t *on) {
    double low = 0.0, high = 0.0;
    const double *start = m->point[three[0]];
    triangle_normal(start, m->point[three[1]], m->point[three[2]], face->normal);
    const double area = sqrt(dot3(face->normal, face->normal));
    if (!(area * FLAT > m->near * m->near))
        return false;
    *on = 0;
    for (int k = 0; k < 3; k++)
        face->normal[k] /= area;
    for (size_t i = 0; i < m->n; i++) {
        double to[3];
        along3(m->point[i], -1.0, start, to);
        const double height = dot3(to, face->normal);
        low = fmin(low, height);
        high = fmax(high, height);
        *on |= (uint64_t)(fabs(height) <= m->near) << i;
    }
    if ((low < -m->near) == (high > m->near))
        return false;
    for (int k = 0; k < 3 && high > m->near; k++)
        face->normal[k] = -face->normal[k];
    face->offset = dot3(start, face->normal);
    return true;
}

static bool is_within_one_face(const making *m, uint64_t points) {
    bool within = false;
    for (size_t f = 0; f < m->hull->n_faces; f++)
        within = within || (points & ~m->on[f]) == 0;
    return within;
}

static void find_faces(making *m) {
    palp_hull *hull = m->hull;
    for (size_t i = 0; i < m->n; i++)
        for (size_t j = i + 1; j < m->n; j++)
            for (size_t k = j + 1; k < m->n && hull->n_faces < 2 * PALP_HULL_POINTS; k++) {
                const uint64_t three = UINT64_C(1) << i | UINT64_C(1) << j | UINT64_C(1) << k;
                if (!is_within_one_face(m, three) &&
                    find_plane(m, (const size_t[]){i, j, k}, &hull->face[hull->n_faces],
                               &m->on[hull->n_faces]))
                    hull->n_faces++;
            }
}

/* The edge between two points of a face, if all others of the face are on its left or between them. */
static bool find_edge(const making *m, size_t f, size_t from, size_t to, hull_edge *edge) {
    const double *start = m->point[from];
    edge->from = from;
    edge->to = to;
    edge->length = distance3(m->point[to], start);
    memcpy(edge->start, start, sizeof edge->start);
    along3(m->point[to], -1.0, start, edge->along);
    for (int k = 0; k < 3; k++)
        edge->along[k] /= edge->length;
    cross3(edge->along, m->hull->face[f].normal, edge->out);
    for (size_t i = 0; i < m->n; i++) {
        double d[3];
        along3(m->point[i], -1.0, start, d);
        const double beside = dot3(d, edge->out), along = dot3(d, edge->along);
        if ((m->on[f] >> i & 1) &&
            (beside > m->near || (beside > -m->near && (along < -m->near || along > edge->length + m->near))))
            return false;
    }
    return true;
}

static void find_edges_of_face(making *m, size_t f) {
    palp_hull *hull = m->hull;
    hull->face[f].first = hull->n_edges;
    for (size_t i = 0; i < m->n; i++)
        for (size_t j = 0; j < m->n && hull->n_edges < 6 * PALP_HULL_POINTS; j++)
            if (i != j && (m->on[f] >> i & 1) && (m->on[f] >> j & 1) &&
                find_edge(m, f, i, j, &hull->edge[hull->n_edges]))
                hull->n_edges++;
    hull->face[f].n = hull->n_edges - hull->face[f].first;
}

/* Is each edge that of two faces? */
static bool is_hull_closed(const palp_hull *hull) {
    for (size_t i = 0; i < hull->n_edges; i++) {
        size_t same = 0, back = 0;
        for (size_t j = 0; j < hull->n_edges; j++) {
            same += hull->edge[j].from == hull->edge[i].from && hull->edge[j].to == hull->edge[i].to;
            back += hull->edge[j].from == hull->edge[i].to && hull->edge[j].to == hull->edge[i].from;
        }
        if (same != 1 || back != 1)
            return false;
    }
    return hull->n_faces >= 4;
}

static void find_corners_and_sizes(const making *m) {
    palp_hull *hull = m->hull;
    hull->inner = INFINITY;
    for (size_t i = 0; i < m->n; i++) {
        bool corner = false;
        for (size_t e = 0; e < hull->n_edges; e++)
            corner = corner || hull->edge[e].from == i;
        if (!corner)
            continue;
        memcpy(hull->corner + 3 * hull->n_corners++, m->point[i], sizeof *m->point);
        hull->size = fmax(hull->size, sqrt(dot3(m->point[i], m->point[i])));
        along3(hull->centre, 1.0, m->point[i], hull->centre);
    }
    for (int k = 0; k < 3; k++)
        hull->centre[k] /= (double)hull->n_corners;
    for (size_t f = 0; f < hull->n_faces; f++)
        hull->inner = fmin(hull->inner, hull->face[f].offset - dot3(hull->face[f].normal, hull->centre));
}

static palp_hull *allocate_hull(void) {
    palp_hull *hull = calloc(1, sizeof *hull);
    if (!hull)
        return NULL;
    hull->corner = arena_take(&hull->memory, 3 * PALP_HULL_POINTS, sizeof *hull->corner);
    hull->face = arena_take(&hull->memory, 2 * PALP_HULL_POINTS, sizeof *hull->face);
    hull->edge = arena_take(&hull->memory, 6 * PALP_HULL_POINTS, sizeof *hull->edge);
    if (hull->memory.failed) {
        palp_hull_free(hull);
        return NULL;
    }
    return hull;
}

palp_status palp_hull_create(size_t n, const double *points_m, palp_hull **hull, palp_error *error) {
    if (!points_m || !hull)
        return palp_error_null(error);
    if (n < 4)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a hull needs at least 4 points, not %zu", n);
    if (n > PALP_HULL_POINTS)
        return palp_error_set(error, PALP_ERR_LIMIT, "a hull has at most %d points, not %zu",
                              PALP_HULL_POINTS, n);
    for (size_t i = 0; i < n; i++)
        if (!finite3(points_m + 3 * i))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "point %zu of a hull is not finite", i);
    making m = {.hull = allocate_hull()};
    if (!m.hull)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    take_points(&m, n, points_m);
    find_faces(&m);
    for (size_t f = 0; f < m.hull->n_faces; f++)
        find_edges_of_face(&m, f);
    if (!is_hull_closed(m.hull)) {
        palp_hull_free(m.hull);
        return palp_error_set(error, PALP_ERR_INPUT, "the points of a hull lie in a plane, or nearly so");
    }
    find_corners_and_sizes(&m);
    *hull = m.hull;
    return PALP_OK;
}

palp_status palp_hull_create_box(const double half_m[3], palp_hull **hull, palp_error *error) {
    double point[8][3];
    if (!half_m)
        return palp_error_null(error);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            point[i][k] = i >> k & 1 ? half_m[k] : -half_m[k];
    return palp_hull_create(8, point[0], hull, error);
}

void palp_hull_free(palp_hull *hull) {
    if (!hull)
        return;
    arena_free(&hull->memory);
    free(hull);
}

/* ---- the nearest point --------------------------------------------------------------------------- */

/* The point is above this face. True if it is over it; otherwise the edges beside which it is are looked at:
 * *square is that of the distance so far. */
static bool is_over_face(const palp_hull *hull, const hull_face *face, const double point[3], double *square,
                         hull_near *near) {
    bool over = true;
    for (size_t i = face->first; i < face->first + face->n; i++) {
        const hull_edge *e = &hull->edge[i];
        double d[3];
        along3(point, -1.0, e->start, d);
        if (!(dot3(d, e->out) > 0.0))
            continue;
        over = false;
        const double at = dot3(d, e->along), on = fmin(fmax(at, 0.0), e->length);
        along3(d, -on, e->along, d);
        if (!(dot3(d, d) < *square))
            continue;
        *square = dot3(d, d);
        memcpy(near->normal, d, sizeof near->normal);
        for (int k = 0; k < 3; k++)
            near->along[k] = at == on ? e->along[k] : 0.0;
    }
    return over;
}

static void be_near_face(const hull_face *face, double height, hull_near *near) {
    near->face = face;
    near->distance = height;
    near->round = false;
    memcpy(near->normal, face->normal, sizeof near->normal);
}

void hull_measure(const palp_hull *hull, const double point[3], hull_near *near) {
    double top = -INFINITY, square = INFINITY;
    const hull_face *highest = NULL;
    *near = (hull_near){.distance = INFINITY};
    for (size_t f = 0; f < hull->n_faces; f++) {
        const hull_face *face = &hull->face[f];
        const double height = dot3(face->normal, point) - face->offset;
        if (height > 0.0 && is_over_face(hull, face, point, &square, near)) {
            be_near_face(face, height, near);
            return;
        }
        if (height > top) {
            top = height;
            highest = face;
        }
    }
    const double distance = sqrt(square);
    if (highest && !(top > 0.0 && distance > 1e-12 * hull->size)) {
        be_near_face(highest, top, near);
        return;
    }
    near->distance = distance;
    near->round = true;
    for (int k = 0; k < 3; k++)
        near->normal[k] /= distance;
}

double hull_facing(double cosine) {
    const double part = cosine / STEEP;
    return part >= 1.0 ? 1.0 : part > 0.0 ? part * part * (3.0 - 2.0 * part) : 0.0;
}

const hull_face *hull_exit(const palp_hull *hull, const double point[3], const double outward[3]) {
    const hull_face *exit = NULL;
    const double length = sqrt(dot3(outward, outward));
    double least = INFINITY;
    for (size_t f = 0; f < hull->n_faces && length > 0.0; f++) {
        const hull_face *face = &hull->face[f];
        const double facing = hull_facing(-dot3(face->normal, outward) / length),
                     depth = face->offset - dot3(face->normal, point);
        if (depth < least * facing) {
            least = depth / facing;
            exit = face;
        }
    }
    return exit;
}

double hull_inset(const palp_hull *hull, const hull_face *face, const double point[3]) {
    double inset = INFINITY;
    for (size_t i = face->first; i < face->first + face->n; i++) {
        double d[3];
        along3(point, -1.0, hull->edge[i].start, d);
        inset = fmin(inset, -dot3(d, hull->edge[i].out));
    }
    return fmax(inset, 0.0);
}
