/* subdivide.c: Loop's subdivision of a surface as a matrix from its nodes to its vertices. */
#include "subdivide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SHARP =
    0.766; /* cosine between the normals of two triangles: edges above 40 degrees are sharp */

typedef struct edge {
    int32_t low, high;   /* vertices */
    int32_t opposite[2]; /* opposite corners of its first two triangles */
    int32_t triangles;
    bool sharp;
} edge;

/* A surface while it is subdivided: vertices by their nodes, triangles, edges sorted by low and high. */
typedef struct finer {
    subdivided s;
    size_t n_edges;
    edge *edge;
    double *sum;    /* [n_nodes] the row being made, and its nodes */
    int32_t *nodes; /* [n_nodes] */
    bool *in_sum;   /* [n_nodes] */
    size_t n_sum;
    bool failed;
} finer;

/* ---- rows ---------------------------------------------------------------------------------------- */

static void add_weighted_row(finer *f, const weight_rows *from, int32_t row, double factor) {
    for (uint32_t k = from->first[row]; k < from->first[row + 1]; k++) {
        int32_t node = from->node[k];
        if (!f->in_sum[node])
            f->nodes[f->n_sum++] = node;
        f->in_sum[node] = true;
        f->sum[node] += factor * from->weight[k];
    }
}

static int compare_node_indices(const void *a, const void *b) {
    return (*(const int32_t *)a > *(const int32_t *)b) - (*(const int32_t *)a < *(const int32_t *)b);
}

/* Appends the sum as the next row. */
static void append_summed_row(finer *f, weight_rows *to) {
    size_t at = to->first[to->n], room = at + f->n_sum;
    if (room > to->room) {
        size_t more = 2 * room + 64;
        int32_t *node = realloc(to->node, more * sizeof *node);
        to->node = node ? node : to->node;
        double *weight = realloc(to->weight, more * sizeof *weight);
        to->weight = weight ? weight : to->weight;
        f->failed = f->failed || !node || !weight;
        to->room = f->failed ? to->room : more;
    }
    qsort(f->nodes, f->n_sum, sizeof *f->nodes, compare_node_indices);
    for (size_t i = 0; i < f->n_sum; i++) {
        int32_t node = f->nodes[i];
        if (!f->failed) {
            to->node[at + i] = node;
            to->weight[at + i] = f->sum[node];
        }
        f->sum[node] = 0.0;
        f->in_sum[node] = false;
    }
    to->n++;
    to->first[to->n] = (uint32_t)(f->failed ? at : room);
    f->n_sum = 0;
}

static bool initialize_weight_rows(weight_rows *r, size_t n) {
    *r = (weight_rows){.first = calloc(n + 1, sizeof *r->first)};
    return r->first;
}

static void free_weight_rows(weight_rows *r) {
    free(r->first);
    free(r->node);
    free(r->weight);
}

/* ---- edges --------------------------------------------------------------------------------------- */

static int compare_edges_by_ends(const void *a, const void *b) {
    const edge *p = a, *q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    return (p->high > q->high) - (p->high < q->high);
}

static bool list_distinct_edges(finer *f) {
    size_t all = 3 * f->s.n_triangles, n = 0;
    edge *list = malloc((all + 1) * sizeof *list);
    if (!list)
        return false;
    for (size_t i = 0; i < all; i++) {
        int32_t *t = f->s.triangle + i / 3 * 3, a = t[i % 3], b = t[(i + 1) % 3], c = t[(i + 2) % 3];
        list[i] = (edge){a < b ? a : b, a < b ? b : a, {c, -1}, 1, false};
    }
    qsort(list, all, sizeof *list, compare_edges_by_ends);
    for (size_t i = 0; i < all; i++) {
        edge *last = n > 0 ? &list[n - 1] : NULL;
        if (!last || compare_edges_by_ends(last, &list[i]) != 0) {
            list[n++] = list[i];
            continue;
        }
        if (last->triangles++ == 1)
            last->opposite[1] = list[i].opposite[0];
    }
    free(f->edge);
    f->edge = list;
    f->n_edges = n;
    return true;
}

static size_t find_edge_between(const edge *list, size_t n, int32_t a, int32_t b) {
    edge key = {.low = a < b ? a : b, .high = a < b ? b : a};
    const edge *found = bsearch(&key, list, n, sizeof *list, compare_edges_by_ends);
    return (size_t)(found - list);
}

static void triangle_normal_at_rest(const double *rest, int32_t a, int32_t b, int32_t c, double n[3]) {
    double p[3], q[3];
    for (int k = 0; k < 3; k++) {
        p[k] = rest[3 * b + k] - rest[3 * a + k];
        q[k] = rest[3 * c + k] - rest[3 * a + k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
}

/* Finds borders, edges of three or more triangles, and edges that are sharp at rest. */
static void mark_sharp_edges(finer *f, const double *rest) {
    for (size_t i = 0; i < f->n_edges; i++) {
        edge *e = &f->edge[i];
        double p[3], q[3], pq = 0.0, pp = 0.0, qq = 0.0;
        e->sharp = e->triangles != 2;
        if (e->sharp)
            continue;
        triangle_normal_at_rest(rest, e->low, e->high, e->opposite[0], p);
        triangle_normal_at_rest(rest, e->high, e->low, e->opposite[1], q);
        for (int k = 0; k < 3; k++) {
            pq += p[k] * q[k];
            pp += p[k] * p[k];
            qq += q[k] * q[k];
        }
        e->sharp = !(pq > SHARP * sqrt(pp * qq));
    }
}

/* ---- subdividing --------------------------------------------------------------------------------- */

/* The edges of a vertex, for its rule. */
typedef struct star {
    int32_t edges, sharp;
    uint32_t first; /* index in ends */
} star;

/* Stars of all vertices. ends: other ends of a vertex's edges, sharp edges first. */
static bool list_edges_of_vertices(const finer *f, star **stars, int32_t **ends) {
    star *s = *stars = calloc(f->s.vertex.n + 1, sizeof *s);
    int32_t *e = *ends = malloc((2 * f->n_edges + 1) * sizeof *e);
    if (!s || !e)
        return false;
    for (size_t i = 0; i < f->n_edges; i++) {
        s[f->edge[i].low].edges++;
        s[f->edge[i].high].edges++;
    }
    for (size_t v = 0; v < f->s.vertex.n; v++) {
        s[v + 1].first = s[v].first + (uint32_t)s[v].edges;
        s[v].edges = 0;
    }
    for (int smooth = 0; smooth < 2; smooth++)
        for (size_t i = 0; i < f->n_edges; i++) {
            const edge *g = &f->edge[i];
            if (g->sharp == (smooth != 0))
                continue;
            e[s[g->low].first + (uint32_t)s[g->low].edges++] = g->high;
            e[s[g->high].first + (uint32_t)s[g->high].edges++] = g->low;
            s[g->low].sharp += g->sharp;
            s[g->high].sharp += g->sharp;
        }
    return true;
}

/* Adds the rule of a vertex, its own weight and that of each neighbour. On a crease these are the ends of its
 * two sharp edges; with more sharp edges it stays. */
static void add_row_of_vertex_star(finer *f, const star *s, const int32_t *ends, int32_t v, bool limit) {
    const double pi = acos(-1.0), n = s->edges, c = 0.375 + 0.25 * cos(2.0 * pi / n),
                 beta = (0.625 - c * c) / n;
    double each = limit ? 1.0 / (n + 0.375 / beta) : beta;
    int32_t taken = s->edges;
    if (taken == 0)
        each = 0.0; /* an inner vertex */
    if (s->sharp > 1) {
        each = s->sharp > 2 ? 0.0 : limit ? 1.0 / 6.0 : 0.125;
        taken = s->sharp > 2 ? 0 : 2;
    }
    add_weighted_row(f, &f->s.vertex, v, 1.0 - taken * each);
    for (int32_t k = 0; k < taken; k++)
        add_weighted_row(f, &f->s.vertex, ends[s->first + (uint32_t)k], each);
}

/* Moves all vertices by their rule; with edges, appends the midpoints of edges. */
static void apply_vertex_rules(finer *f, bool limit, size_t n_edges) {
    star *stars = NULL;
    int32_t *ends = NULL;
    weight_rows to;
    f->failed = f->failed || !initialize_weight_rows(&to, f->s.vertex.n + n_edges);
    if (f->failed)
        return;
    f->failed = !list_edges_of_vertices(f, &stars, &ends);
    for (size_t v = 0; v < f->s.vertex.n && !f->failed; v++) {
        add_row_of_vertex_star(f, &stars[v], ends, (int32_t)v, limit);
        append_summed_row(f, &to);
    }
    for (size_t i = 0; i < n_edges && !f->failed; i++) {
        const edge *e = &f->edge[i];
        add_weighted_row(f, &f->s.vertex, e->low, e->sharp ? 0.5 : 0.375);
        add_weighted_row(f, &f->s.vertex, e->high, e->sharp ? 0.5 : 0.375);
        for (int k = 0; k < 2 && !e->sharp; k++)
            add_weighted_row(f, &f->s.vertex, e->opposite[k], 0.125);
        append_summed_row(f, &to);
    }
    free(stars);
    free(ends);
    free_weight_rows(&f->s.vertex);
    f->s.vertex = to;
}

/* Marks halves of sharp edges as sharp. */
static void pass_on_sharp_edges(finer *f, const edge *old, size_t n_old, size_t n_vertices) {
    for (size_t i = 0; i < n_old; i++)
        for (int end = 0; end < 2 && old[i].sharp; end++) {
            int32_t middle = (int32_t)(n_vertices + i);
            f->edge[find_edge_between(f->edge, f->n_edges, end ? old[i].high : old[i].low, middle)].sharp =
                true;
        }
}

/* Divides each triangle into four. */
static void subdivide_triangles_once(finer *f) {
    const size_t n_vertices = f->s.vertex.n, n_old = f->n_edges;
    edge *old = f->edge;
    int32_t *triangle = malloc((12 * f->s.n_triangles + 1) * sizeof *triangle);
    apply_vertex_rules(f, false, n_old);
    f->failed = f->failed || !triangle;
    for (size_t i = 0; i < f->s.n_triangles && !f->failed; i++) {
        const int32_t *t = f->s.triangle + 3 * i;
        int32_t m[3];
        for (int k = 0; k < 3; k++)
            m[k] = (int32_t)(n_vertices + find_edge_between(old, n_old, t[k], t[(k + 1) % 3]));
        const int32_t four[12] = {t[0], m[0], m[2], m[0], t[1], m[1], m[2], m[1], t[2], m[0], m[1], m[2]};
        memcpy(triangle + 12 * i, four, sizeof four);
    }
    free(f->s.triangle);
    f->s.triangle = triangle;
    f->s.n_triangles *= 4;
    f->edge = NULL;
    f->failed = f->failed || !list_distinct_edges(f);
    if (!f->failed)
        pass_on_sharp_edges(f, old, n_old, n_vertices);
    free(old);
}

/* ---- all of it ----------------------------------------------------------------------------------- */

/* Nodes on no triangle stay vertices, which nothing touches. */
static bool initialize_subdivision(finer *f, size_t n_nodes, const double *rest, size_t n_surface,
                                   const int32_t *surface) {
    f->s.n_triangles = n_surface;
    f->s.triangle = malloc((3 * n_surface + 1) * sizeof *f->s.triangle);
    f->sum = calloc(n_nodes + 1, sizeof *f->sum);
    f->nodes = malloc((n_nodes + 1) * sizeof *f->nodes);
    f->in_sum = calloc(n_nodes + 1, sizeof *f->in_sum);
    if (!initialize_weight_rows(&f->s.vertex, n_nodes) || !f->s.triangle || !f->sum || !f->nodes ||
        !f->in_sum)
        return false;
    memcpy(f->s.triangle, surface, 3 * n_surface * sizeof *surface);
    for (size_t i = 0; i < n_nodes; i++) {
        f->nodes[f->n_sum++] = (int32_t)i;
        f->sum[i] = 1.0;
        append_summed_row(f, &f->s.vertex);
    }
    if (f->failed || !list_distinct_edges(f))
        return false;
    mark_sharp_edges(f, rest);
    return true;
}

bool subdivide_make(size_t n_nodes, const double *rest, size_t n_surface, const int32_t *surface,
                    size_t subdivisions, subdivided *out) {
    finer f = {0};
    bool made = initialize_subdivision(&f, n_nodes, rest, n_surface, surface);
    if (made)
        apply_vertex_rules(&f, true, 0);
    for (size_t k = 0; k < subdivisions && made && !f.failed; k++)
        subdivide_triangles_once(&f);
    if (made && !f.failed)
        apply_vertex_rules(&f, true, 0);
    made = made && !f.failed;
    free(f.edge);
    free(f.sum);
    free(f.nodes);
    free(f.in_sum);
    if (made)
        *out = f.s;
    else
        subdivide_free(&f.s);
    return made;
}

void subdivide_free(subdivided *s) {
    free_weight_rows(&s->vertex);
    free(s->triangle);
}
