/* visual.c: a fine surface that a network carries along: each vertex goes with the tetrahedron that it is in.
 */
#include <palpate/visual.h>

#include "base/file.h"
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 4 };

struct palp_visual {
    arena memory;
    size_t n_nodes, n_tetrahedra; /* of the network's mesh */
    size_t n_vertices, n_all, n_drawn;
    double *rest;                 /* [3 n_vertices] */
    int32_t *node;                /* [4 n_vertices] corners of the tetrahedron */
    double *share;                /* [4 n_vertices] barycentric coordinates in it */
    double *follows;              /* [4 n_vertices] what the vertex moves by of each corner's displacement */
    int32_t *all, *drawn;         /* [3 n_all] triangles, and those to draw */
    double *x, *normal;           /* [3 n_vertices] */
    const palp_network *drawn_of; /* the network that drawn was found for, or NULL: for none yet */
    size_t changes, version;      /* its surface_changes then */
};

/* ---- binding ------------------------------------------------------------------------------------- */

/* A tetrahedron for the search: gradients of its barycentric coordinates. */
typedef struct bound {
    double centre[3], reach, gradient[CORNERS][3];
} bound;

static bound bound_of_tetrahedron(const double *rest, const int32_t t[CORNERS]) {
    bound b = {.reach = 0.0};
    const double six = mesh_volume6(rest, t);
    for (int i = 0; i < CORNERS; i++) {
        const double *a = rest + 3 * (size_t)t[(i + 1) % CORNERS],
                     *c = rest + 3 * (size_t)t[(i + 2) % CORNERS],
                     *d = rest + 3 * (size_t)t[(i + 3) % CORNERS];
        const double sign = i % 2 ? 1.0 : -1.0;
        for (int k = 0; k < 3; k++) {
            const int m = (k + 1) % 3, n = (k + 2) % 3;
            b.gradient[i][k] = sign * ((c[m] - a[m]) * (d[n] - a[n]) - (c[n] - a[n]) * (d[m] - a[m])) / six;
            b.centre[k] += 0.25 * rest[3 * (size_t)t[i] + (size_t)k];
        }
    }
    for (int i = 0; i < CORNERS; i++) {
        const double *x = rest + 3 * (size_t)t[i];
        b.reach = fmax(b.reach, hypot(hypot(x[0] - b.centre[0], x[1] - b.centre[1]), x[2] - b.centre[2]));
    }
    return b;
}

/* Barycentric coordinates of a place; returns its distance from the plane of the face that it is farthest
 * outside of, 0 inside. */
static double measure_place(const bound *b, const double place[3], double share[CORNERS]) {
    double outside = 0.0;
    for (int i = 0; i < CORNERS; i++) {
        const double *g = b->gradient[i];
        share[i] = 0.25;
        for (int k = 0; k < 3; k++)
            share[i] += g[k] * (place[k] - b->centre[k]);
        outside = fmax(outside, -share[i] / sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
    }
    return outside;
}

static double distance_from_reach(const bound *b, const double place[3]) {
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (place[k] - b->centre[k]) * (place[k] - b->centre[k]);
    return fmax(0.0, sqrt(square) - b->reach);
}

/* To the nearest tetrahedron, from the last vertex's on: neighbours in the list are near each other mostly.
 */
static void bind_vertex(palp_visual *v, size_t vertex, const bound *bounds, const int32_t *tetrahedra,
                        size_t *last) {
    const double *place = v->rest + 3 * vertex;
    double share[CORNERS], best = measure_place(&bounds[*last], place, v->share + CORNERS * vertex),
                           near = distance_from_reach(&bounds[*last], place);
    for (size_t t = 0; t < v->n_tetrahedra && !(best == 0.0 && near == 0.0); t++) {
        const double away = distance_from_reach(&bounds[t], place);
        if (away > fmax(best, near))
            continue;
        const double outside = fmax(measure_place(&bounds[t], place, share), away);
        if (outside < fmax(best, near)) {
            best = outside;
            near = away;
            *last = t;
            memcpy(v->share + CORNERS * vertex, share, sizeof share);
        }
    }
    memcpy(v->node + CORNERS * vertex, tetrahedra + CORNERS * *last, CORNERS * sizeof *v->node);
}

static palp_status bind_vertices(palp_visual *v, const palp_network *net) {
    arena scratch = {NULL, false};
    bound *bounds = arena_take(&scratch, v->n_tetrahedra, sizeof *bounds);
    size_t last = 0;
    for (size_t t = 0; t < v->n_tetrahedra && bounds; t++)
        bounds[t] = bound_of_tetrahedron(net->rest, net->mesh->tetrahedra + CORNERS * t);
    for (size_t i = 0; i < v->n_vertices && bounds; i++)
        bind_vertex(v, i, bounds, net->mesh->tetrahedra, &last);
    arena_free(&scratch);
    return bounds ? PALP_OK : PALP_ERR_NO_MEMORY;
}

static palp_status check_surface(size_t n_vertices, const double *x, size_t n_triangles,
                                 const int32_t *triangles, palp_error *error) {
    for (size_t i = 0; i < 3 * n_vertices; i++)
        if (!isfinite(x[i]))
            return palp_error_set(error, PALP_ERR_INPUT, "vertex %zu: a coordinate is not finite", i / 3);
    for (size_t i = 0; i < 3 * n_triangles; i++)
        if (triangles[i] < 0 || (size_t)triangles[i] >= n_vertices)
            return palp_error_set(error, PALP_ERR_INPUT, "triangle %zu: there is no vertex %ld", i / 3,
                                  (long)triangles[i]);
    return PALP_OK;
}

palp_status palp_visual_create(const palp_network *net, size_t n_vertices, const double *x_m,
                               size_t n_triangles, const int32_t *triangles, palp_visual **visual,
                               palp_error *error) {
    if (!net || !x_m || !triangles || !visual)
        return palp_error_null(error);
    if (net->mesh->n_tetrahedra == 0)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "the network's mesh has no tetrahedra");
    palp_status status = check_surface(n_vertices, x_m, n_triangles, triangles, error);
    if (status)
        return status;
    arena memory = {NULL, false};
    palp_visual *v = arena_take(&memory, 1, sizeof *v);
    if (!v)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    v->n_nodes = net->n_nodes;
    v->n_tetrahedra = net->mesh->n_tetrahedra;
    v->n_vertices = n_vertices;
    v->n_all = n_triangles;
    v->node = arena_take(&memory, CORNERS * n_vertices, sizeof *v->node);
    v->share = arena_take(&memory, CORNERS * n_vertices, sizeof *v->share);
    v->follows = arena_take(&memory, CORNERS * n_vertices, sizeof *v->follows);
    v->rest = arena_take(&memory, 3 * n_vertices, sizeof *v->rest);
    v->x = arena_take(&memory, 3 * n_vertices, sizeof *v->x);
    v->normal = arena_take(&memory, 3 * n_vertices, sizeof *v->normal);
    v->all = arena_take(&memory, 3 * n_triangles, sizeof *v->all);
    v->drawn = arena_take(&memory, 3 * n_triangles, sizeof *v->drawn);
    if (!memory.failed) {
        memcpy(v->rest, x_m, 3 * n_vertices * sizeof *x_m);
        memcpy(v->all, triangles, 3 * n_triangles * sizeof *triangles);
        status = bind_vertices(v, net);
    }
    if (memory.failed || status) {
        arena_free(&memory);
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    }
    v->memory = memory;
    *visual = v;
    return PALP_OK;
}

void palp_visual_free(palp_visual *v) {
    if (!v)
        return;
    arena memory = v->memory;
    arena_free(&memory);
}

/* ---- cuts ---------------------------------------------------------------------------------------- */

/* Are two nodes joined? Those without an element between them count as joined. */
static bool are_nodes_joined(const palp_network *net, int32_t a, int32_t b) {
    const size_t e = a == b ? net->n_elements : palp_mesh_element_between(net->mesh, a, b);
    return e == net->n_elements || net->scale[e] != 0.0;
}

/* The corner that a vertex is nearest to. */
static int nearest_corner(const double share[CORNERS]) {
    int nearest = 0;
    for (int c = 1; c < CORNERS; c++)
        nearest = share[c] > share[nearest] ? c : nearest;
    return nearest;
}

/* A vertex goes with the corners on its side: those that are joined to its nearest one. */
static void follow_own_side(palp_visual *v, const palp_network *net, size_t vertex) {
    const int32_t *node = v->node + CORNERS * vertex;
    const double *share = v->share + CORNERS * vertex;
    double *follows = v->follows + CORNERS * vertex, sum = 0.0;
    const int nearest = nearest_corner(share);
    bool own[CORNERS] = {false};
    own[nearest] = true;
    for (int round = 0; round < CORNERS; round++)
        for (int a = 0; a < CORNERS; a++)
            for (int b = 0; b < CORNERS; b++)
                own[b] = own[b] || (own[a] && are_nodes_joined(net, node[a], node[b]));
    for (int c = 0; c < CORNERS; c++)
        sum += own[c] ? share[c] : 0.0;
    const bool alone = sum < 0.5 * share[nearest]; /* the others pull the other way */
    for (int c = 0; c < CORNERS; c++)
        follows[c] = alone ? (c == nearest ? 1.0 : 0.0) : own[c] ? share[c] / sum : 0.0;
}

static bool is_triangle_whole(const palp_visual *v, const palp_network *net, const int32_t *triangle) {
    int32_t node[3];
    for (int k = 0; k < 3; k++) {
        const size_t vertex = (size_t)triangle[k];
        node[k] = v->node[CORNERS * vertex + (size_t)nearest_corner(v->share + CORNERS * vertex)];
    }
    return are_nodes_joined(net, node[0], node[1]) && are_nodes_joined(net, node[1], node[2]) &&
           are_nodes_joined(net, node[2], node[0]);
}

static void find_drawn(palp_visual *v, const palp_network *net) {
    v->n_drawn = 0;
    for (size_t i = 0; i < v->n_vertices && net->n_dead > 0; i++)
        follow_own_side(v, net, i);
    if (net->n_dead == 0)
        memcpy(v->follows, v->share, CORNERS * v->n_vertices * sizeof *v->share);
    for (size_t i = 0; i < v->n_all; i++)
        if (net->n_dead == 0 || is_triangle_whole(v, net, v->all + 3 * i))
            memcpy(v->drawn + 3 * v->n_drawn++, v->all + 3 * i, 3 * sizeof *v->all);
    v->drawn_of = net;
    v->changes = net->surface_changes;
    v->version++;
}

/* ---- following ----------------------------------------------------------------------------------- */

static void place_vertices(palp_visual *v, const palp_network *net) {
    for (size_t i = 0; i < v->n_vertices; i++)
        for (size_t k = 0; k < 3; k++) {
            double moved = 0.0;
            for (size_t c = 0; c < CORNERS; c++) {
                const size_t at = 3 * (size_t)v->node[CORNERS * i + c] + k;
                moved += v->follows[CORNERS * i + c] * (net->now.x[at] - net->rest[at]);
            }
            v->x[3 * i + k] = v->rest[3 * i + k] + moved;
        }
}

static void find_normals(palp_visual *v) {
    memset(v->normal, 0, 3 * v->n_vertices * sizeof *v->normal);
    for (size_t i = 0; i < v->n_drawn; i++) {
        const int32_t *t = v->drawn + 3 * i;
        const double *a = v->x + 3 * (size_t)t[0], *b = v->x + 3 * (size_t)t[1], *c = v->x + 3 * (size_t)t[2];
        for (size_t k = 0; k < 3; k++) {
            const size_t m = (k + 1) % 3, n = (k + 2) % 3;
            const double area = (b[m] - a[m]) * (c[n] - a[n]) - (b[n] - a[n]) * (c[m] - a[m]);
            for (size_t corner = 0; corner < 3; corner++)
                v->normal[3 * (size_t)t[corner] + k] += area;
        }
    }
    for (size_t i = 0; i < v->n_vertices; i++) {
        double *n = v->normal + 3 * i, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (size_t k = 0; k < 3 && length > 0.0; k++)
            n[k] /= length;
    }
}

static palp_status follow(palp_visual *v, const palp_network *net, bool normals) {
    if (net->n_nodes != v->n_nodes || net->mesh->n_tetrahedra != v->n_tetrahedra)
        return PALP_ERR_ARGUMENT;
    if (v->drawn_of != net || v->changes != net->surface_changes)
        find_drawn(v, net);
    place_vertices(v, net);
    if (normals)
        find_normals(v);
    return PALP_OK;
}

palp_status palp_visual_follow(palp_visual *v, const palp_network *net, double *x_m, double *normal) {
    palp_status status = v && net && x_m ? follow(v, net, normal) : PALP_ERR_ARGUMENT;
    if (status)
        return status;
    memcpy(x_m, v->x, 3 * v->n_vertices * sizeof *x_m);
    if (normal)
        memcpy(normal, v->normal, 3 * v->n_vertices * sizeof *normal);
    return PALP_OK;
}

palp_status palp_visual_follow_float(palp_visual *v, const palp_network *net, float *x_m, float *normal) {
    palp_status status = v && net && x_m ? follow(v, net, normal) : PALP_ERR_ARGUMENT;
    for (size_t i = 0; !status && i < 3 * v->n_vertices; i++) {
        x_m[i] = (float)v->x[i];
        if (normal)
            normal[i] = (float)v->normal[i];
    }
    return status;
}

palp_status palp_visual_triangles(const palp_visual *v, size_t *n, const int32_t **triangles,
                                  size_t *version) {
    if (!v || !n || !triangles)
        return PALP_ERR_ARGUMENT;
    *n = v->n_drawn;
    *triangles = v->drawn;
    if (version)
        *version = v->version;
    return PALP_OK;
}
