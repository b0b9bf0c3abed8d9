/* skin.c: a subdivided surface for tools: weights of the nodes in its vertices, and pairs of nodes with a
 * common triangle. */
#include "skin.h"

#include "subdivide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void skin_share_stiffness(skin *s, size_t n_surface, const int32_t *surface, const double *unit) {
    const size_t parts = s->n_triangles / n_surface;
    memset(s->unit, 0, s->n * sizeof *s->unit);
    for (size_t i = 0; i < 3 * s->n_triangles; i++) {
        const int32_t *t = surface + 3 * (i / 3 / parts);
        double sum = 0.0;
        for (int k = 0; k < 3; k++)
            sum += unit[t[k]] / s->faces[t[k]];
        s->unit[s->triangle[i]] += sum / (3.0 * (double)parts);
    }
}

/* ---- pairs --------------------------------------------------------------------------------------- */

static int compare_pair_keys(const void *a, const void *b) {
    return (*(const uint64_t *)a > *(const uint64_t *)b) - (*(const uint64_t *)a < *(const uint64_t *)b);
}

size_t skin_stencil(const skin *s, int n, const int32_t *vertex, int32_t *node, double *share) {
    uint32_t at[3];
    size_t count = 0;
    for (int a = 0; a < n; a++)
        at[a] = s->first[vertex[a]];
    for (;; count++) {
        int32_t next = INT32_MAX;
        for (int a = 0; a < n; a++)
            if (at[a] < s->first[vertex[a] + 1] && s->node[at[a]] < next)
                next = s->node[at[a]];
        if (next == INT32_MAX)
            return count;
        node[count] = next;
        for (int a = 0; a < n; a++) {
            bool has = at[a] < s->first[vertex[a] + 1] && s->node[at[a]] == next;
            share[(size_t)a * s->room + count] = has ? s->weight[at[a]++] : 0.0;
        }
    }
}

/* The pairs of all triangles as low * 2^32 + high; only counts if keys is NULL. */
static size_t collect_node_pairs(const skin *s, int32_t *node, double *share, uint64_t *keys) {
    size_t at = 0;
    for (size_t t = 0; t < s->n_triangles; t++) {
        size_t n = skin_stencil(s, 3, s->triangle + 3 * t, node, share);
        for (size_t i = 0; i < n; i++)
            for (size_t j = i; j < n; j++, at++)
                if (keys)
                    keys[at] = (uint64_t)node[i] << 32 | (uint64_t)node[j];
    }
    return at;
}

static palp_status list_distinct_pairs(arena *memory, skin *s) {
    for (size_t v = 0; v < s->n; v++)
        s->room = s->first[v + 1] - s->first[v] > s->room ? s->first[v + 1] - s->first[v] : s->room;
    s->room *= 3;
    int32_t *node = malloc(s->room * sizeof *node);
    double *share = malloc(3 * s->room * sizeof *share);
    uint64_t *keys =
        node && share ? malloc((collect_node_pairs(s, node, share, NULL) + 1) * sizeof *keys) : NULL;
    if (keys) {
        size_t all = collect_node_pairs(s, node, share, keys);
        qsort(keys, all, sizeof *keys, compare_pair_keys);
        for (size_t i = 0; i < all; i++)
            if (i == 0 || keys[i] != keys[i - 1])
                keys[s->n_pairs++] = keys[i];
        s->pair_first = arena_take(memory, s->n_nodes + 1, sizeof *s->pair_first);
        s->low = arena_take(memory, s->n_pairs, sizeof *s->low);
        s->high = arena_take(memory, s->n_pairs, sizeof *s->high);
    }
    bool made = keys && !memory->failed;
    for (size_t i = 0; i < s->n_pairs && made; i++) {
        s->low[i] = (int32_t)(keys[i] >> 32);
        s->high[i] = (int32_t)(keys[i] & UINT32_MAX);
        s->pair_first[s->low[i] + 1]++;
    }
    for (size_t i = 0; i < s->n_nodes && made; i++)
        s->pair_first[i + 1] += s->pair_first[i];
    free(node);
    free(share);
    free(keys);
    return made ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* ---- a skin -------------------------------------------------------------------------------------- */

/* Lists the triangles around each vertex. */
static void list_triangles_of_vertices(arena *memory, skin *s) {
    s->around_first = arena_take(memory, s->n + 2, sizeof *s->around_first);
    s->around = arena_take(memory, 3 * s->n_triangles, sizeof *s->around);
    if (memory->failed)
        return;
    for (size_t i = 0; i < 3 * s->n_triangles; i++)
        s->around_first[s->triangle[i] + 2]++;
    for (size_t v = 2; v < s->n + 2; v++)
        s->around_first[v] += s->around_first[v - 1];
    for (size_t i = 0; i < 3 * s->n_triangles; i++)
        s->around[s->around_first[s->triangle[i] + 1]++] = (int32_t)(i / 3);
}

/* The node with the largest weight in a vertex. */
static int32_t most_weighted_node(const skin *s, size_t v) {
    uint32_t most = s->first[v];
    for (uint32_t k = most; k < s->first[v + 1]; k++)
        most = s->weight[k] > s->weight[most] ? k : most;
    return s->node[most];
}

/* Lists the vertices of each node, without vertices that are on no triangle. */
static void list_vertices_of_nodes(arena *memory, const double *rest, skin *s) {
    s->home_first = arena_take(memory, s->n_nodes + 2, sizeof *s->home_first);
    s->home = arena_take(memory, s->n, sizeof *s->home);
    for (int fill = 0; fill < 2 && !memory->failed; fill++) {
        for (size_t v = 0; v < s->n; v++) {
            if (s->around_first[v] == s->around_first[v + 1])
                continue;
            const int32_t node = most_weighted_node(s, v);
            const double *a = s->rest + 3 * v, *b = rest + 3 * node;
            s->reach = fmax(s->reach, sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                                           (a[2] - b[2]) * (a[2] - b[2])));
            if (fill)
                s->home[s->home_first[node + 1]++] = (int32_t)v;
            else
                s->home_first[node + 2]++;
        }
        for (size_t i = 2; i < s->n_nodes + 2 && !fill; i++)
            s->home_first[i] += s->home_first[i - 1];
    }
}

static bool copy_subdivided_surface(arena *memory, const subdivided *finer, skin *s) {
    const weight_rows *v = &finer->vertex;
    s->n = v->n;
    s->n_triangles = finer->n_triangles;
    s->triangle = arena_take(memory, 3 * s->n_triangles, sizeof *s->triangle);
    s->first = arena_take(memory, s->n + 1, sizeof *s->first);
    s->node = arena_take(memory, v->first[v->n], sizeof *s->node);
    s->weight = arena_take(memory, v->first[v->n], sizeof *s->weight);
    s->unit = arena_take(memory, s->n, sizeof *s->unit);
    s->faces = arena_take(memory, s->n_nodes, sizeof *s->faces);
    s->rest = arena_take(memory, 3 * s->n, sizeof *s->rest);
    if (memory->failed)
        return false;
    memcpy(s->triangle, finer->triangle, 3 * s->n_triangles * sizeof *s->triangle);
    memcpy(s->first, v->first, (s->n + 1) * sizeof *s->first);
    memcpy(s->node, v->node, v->first[v->n] * sizeof *s->node);
    memcpy(s->weight, v->weight, v->first[v->n] * sizeof *s->weight);
    return true;
}

palp_status skin_make(arena *memory, size_t n_nodes, const double *rest, size_t n_surface,
                      const int32_t *surface, const double *unit, size_t subdivisions, skin *s) {
    subdivided finer;
    bool made = subdivide_make(n_nodes, rest, n_surface, surface, subdivisions, &finer);
    if (!made)
        return PALP_ERR_NO_MEMORY;
    s->n_nodes = n_nodes;
    made = copy_subdivided_surface(memory, &finer, s);
    subdivide_free(&finer);
    if (made) {
        for (size_t i = 0; i < 3 * n_surface; i++)
            s->faces[surface[i]]++;
        skin_share_stiffness(s, n_surface, surface, unit);
        for (size_t v = 0; v < s->n; v++)
            skin_take_vertex(s, (int32_t)v, rest, s->rest + 3 * v);
        list_triangles_of_vertices(memory, s);
        list_vertices_of_nodes(memory, rest, s);
        made = !memory->failed;
    }
    return made ? list_distinct_pairs(memory, s) : PALP_ERR_NO_MEMORY;
}

void skin_take_vertex(const skin *s, int32_t vertex, const double *in, double out[3]) {
    out[0] = out[1] = out[2] = 0.0;
    for (uint32_t k = s->first[vertex]; k < s->first[vertex + 1]; k++)
        for (int c = 0; c < 3; c++)
            out[c] += s->weight[k] * in[3 * s->node[k] + c];
}

void skin_give_vertex(const skin *s, int32_t vertex, const double force[3], double *out) {
    for (uint32_t k = s->first[vertex]; k < s->first[vertex + 1]; k++)
        for (int c = 0; c < 3; c++)
            out[3 * s->node[k] + c] += s->weight[k] * force[c];
}

uint32_t skin_pair(const skin *s, int32_t low, int32_t high) {
    uint32_t from = s->pair_first[low], to = s->pair_first[low + 1] - 1;
    while (from < to) {
        uint32_t middle = (from + to) / 2;
        if (s->high[middle] < high)
            from = middle + 1;
        else
            to = middle;
    }
    return from;
}
