/* linsys_order.c: reverse Cuthill-McKee numbering, for a narrow band of an unordered mesh. */
#include "linsys_solver.h"

#include <stdlib.h>

/* Neighbours of every unknown without itself: list[first[i]] to list[first[i + 1]]. */
typedef struct graph {
    size_t n, *first;
    int32_t *list;
} graph;

static bool build_adjacency_graph(size_t n, const size_t *column, const int32_t *row, graph *g) {
    g->n = n;
    g->first = calloc(n + 2, sizeof *g->first);
    g->list = malloc((2 * column[n] + 1) * sizeof *g->list);
    if (!g->first || !g->list)
        return false;
    size_t *end = g->first + 1;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t j = 0; j < n; j++)
            for (size_t k = column[j]; k < column[j + 1]; k++) {
                size_t i = (size_t)row[k];
                if (i == j)
                    continue;
                if (pass) {
                    g->list[end[i]] = (int32_t)j;
                    g->list[end[j]] = row[k];
                }
                end[i + !pass]++;
                end[j + !pass]++;
            }
        for (size_t j = 0; j < n && !pass; j++)
            end[j + 1] += end[j];
    }
    return true;
}

static size_t degree_of_node(const graph *g, int32_t i) {
    return g->first[i + 1] - g->first[i];
}

/* Appends what is reachable from start to order[count], breadth first, low degrees first. */
static size_t append_breadth_first(const graph *g, int32_t start, bool *seen, int32_t *order, size_t count) {
    size_t head = count;
    order[count++] = start;
    seen[start] = true;
    for (; head < count; head++) {
        size_t from = count;
        for (size_t k = g->first[order[head]]; k < g->first[order[head] + 1]; k++) {
            int32_t next = g->list[k];
            if (seen[next])
                continue;
            seen[next] = true;
            size_t at = count++;
            for (; at > from && degree_of_node(g, order[at - 1]) > degree_of_node(g, next); at--)
                order[at] = order[at - 1];
            order[at] = next;
        }
    }
    return count;
}

/* Starts each connected part at a remote node, found by two breadth-first searches. */
static void number_connected_parts(const graph *g, bool *seen, int32_t *order) {
    enum { TRIES = 4 };
    size_t count = 0;
    for (size_t i = 0; i < g->n; i++) {
        int32_t start = (int32_t)i;
        for (int t = 0; t < TRIES && !seen[i]; t++) {
            size_t end = append_breadth_first(g, start, seen, order, count);
            start = order[end - 1];
            for (size_t k = count; k < end; k++)
                seen[order[k]] = false;
        }
        if (!seen[i])
            count = append_breadth_first(g, start, seen, order, count);
    }
}

palp_status linsys_order(size_t n, const size_t *column, const int32_t *row, int32_t *position) {
    graph g = {0};
    bool *seen = calloc(n + 1, sizeof *seen);
    int32_t *order = malloc((n + 1) * sizeof *order);
    palp_status status =
        seen && order && build_adjacency_graph(n, column, row, &g) ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        number_connected_parts(&g, seen, order);
        for (size_t i = 0; i < n; i++)
            position[order[i]] = (int32_t)(n - 1 - i);
    }
    free(seen);
    free(order);
    free(g.first);
    free(g.list);
    return status;
}
