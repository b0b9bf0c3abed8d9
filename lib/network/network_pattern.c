/* network_pattern.c: pattern of the tangent, and the place of each block in the solver's values. */
#include "network_internal.h"

#include "mesh/mesh_internal.h"

#include <stdlib.h>

/* Pair i of nodes with a block: first those of elements, then the others. */
static const int32_t *nodes_of_joined_pair(const palp_network *net, size_t i) {
    return i < net->n_elements ? net->pair + 2 * i : net->other_pair + 2 * (i - net->n_elements);
}

/* Neighbours of each node with a higher or equal number, ascending: [first[a], first[a + 1]). */
static palp_status list_higher_neighbours(const palp_network *net, size_t **first, int32_t **list) {
    size_t n = net->n_nodes, n_pairs = net->n_elements + net->n_other_pairs,
           *count = calloc(n + 2, sizeof *count);
    int32_t *out = malloc((n + n_pairs + 1) * sizeof *out);
    if (!count || !out) {
        free(count);
        free(out);
        return PALP_ERR_NO_MEMORY;
    }
    for (size_t i = 0; i < n; i++)
        count[i + 2] = 1;
    for (size_t i = 0; i < n_pairs; i++) {
        int32_t a = nodes_of_joined_pair(net, i)[0], b = nodes_of_joined_pair(net, i)[1];
        count[(a < b ? a : b) + 2]++;
    }
    for (size_t i = 2; i < n + 2; i++)
        count[i] += count[i - 1];
    for (size_t i = 0; i < n; i++)
        out[count[i + 1]++] = (int32_t)i;
    for (size_t i = 0; i < n_pairs; i++) {
        int32_t a = nodes_of_joined_pair(net, i)[0], b = nodes_of_joined_pair(net, i)[1];
        out[count[(a < b ? a : b) + 1]++] = a < b ? b : a;
    }
    for (size_t i = 0; i < n; i++) /* insertion sort, as a node has few neighbours */
        for (size_t j = count[i] + 1; j < count[i + 1]; j++) {
            int32_t v = out[j];
            size_t k = j;
            for (; k > count[i] && out[k - 1] > v; k--)
                out[k] = out[k - 1];
            out[k] = v;
        }
    *first = count;
    *list = out;
    return PALP_OK;
}

/* Lower triangle of the tangent by columns; only counts if row is NULL. */
static size_t fill_tangent_pattern(const palp_network *net, const size_t *first, const int32_t *list,
                                   size_t *column, int32_t *row) {
    size_t nz = 0;
    for (size_t a = 0; a < net->n_nodes; a++)
        for (size_t k = 0; k < 3; k++) {
            int32_t c = net->dof[3 * a + k];
            if (c < 0)
                continue;
            column[c] = nz;
            for (size_t j = first[a]; j < first[a + 1]; j++)
                for (size_t r = 0; r < 3; r++) {
                    int32_t d = net->dof[3 * (size_t)list[j] + r];
                    if (d < c)
                        continue;
                    if (row)
                        row[nz] = d;
                    nz++;
                }
        }
    column[net->n_free] = nz;
    return nz;
}

static palp_status create_linear_system(palp_network *net) {
    size_t *first = NULL, *column = malloc((net->n_free + 1) * sizeof *column);
    int32_t *list = NULL, *row = NULL;
    palp_status status = column ? list_higher_neighbours(net, &first, &list) : PALP_ERR_NO_MEMORY;
    if (!status) {
        size_t nz = fill_tangent_pattern(net, first, list, column, NULL);
        row = malloc((nz + 1) * sizeof *row);
        if (row)
            fill_tangent_pattern(net, first, list, column, row);
        status = row ? linsys_create(net->settings.solver, net->n_free, column, row, &net->ls)
                     : PALP_ERR_NO_MEMORY;
    }
    free(first);
    free(list);
    free(column);
    free(row);
    return status;
}

static uint32_t find_slot_of_coordinates(const palp_network *net, size_t i, size_t j) {
    int32_t a = net->dof[i], b = net->dof[j];
    if (a < 0 || b < 0)
        return (uint32_t)linsys_value_count(net->ls); /* the slot that is ignored */
    return (uint32_t)(a > b ? linsys_slot(net->ls, (size_t)a, (size_t)b)
                            : linsys_slot(net->ls, (size_t)b, (size_t)a));
}

static palp_status find_slots_of_blocks(palp_network *net) {
    if (linsys_value_count(net->ls) >= UINT32_MAX)
        return PALP_ERR_LIMIT;
    for (size_t i = 0; i < net->n_elements + net->n_other_pairs; i++) {
        const int32_t *pair = nodes_of_joined_pair(net, i);
        uint32_t *slot =
            i < net->n_elements ? net->slot + 9 * i : net->other_slot + 9 * (i - net->n_elements);
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++)
                slot[3 * r + c] =
                    find_slot_of_coordinates(net, 3 * (size_t)pair[1] + r, 3 * (size_t)pair[0] + c);
    }
    for (size_t i = 0; i < net->n_nodes; i++) {
        uint32_t *s = net->slot_node + 6 * i;
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c <= r; c++)
                *s++ = find_slot_of_coordinates(net, 3 * i + r, 3 * i + c);
    }
    return PALP_OK;
}

palp_status network_make_pattern(palp_network *net) {
    palp_status status = create_linear_system(net);
    return status ? status : find_slots_of_blocks(net);
}

palp_status network_add_pairs(palp_network *net, size_t n, const int32_t *low, const int32_t *high) {
    if (net->ranks)
        return PALP_ERR_UNSUPPORTED;
    net->other_pair = arena_take(&net->memory, 2 * n, sizeof *net->other_pair);
    net->other_slot = arena_take(&net->memory, 9 * n, sizeof *net->other_slot);
    if (net->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        if (low[i] == high[i] || palp_mesh_element_between(net->mesh, low[i], high[i]) < net->n_elements)
            continue;
        net->other_pair[2 * net->n_other_pairs] = low[i];
        net->other_pair[2 * net->n_other_pairs++ + 1] = high[i];
    }
    linsys *old = net->ls;
    net->ls = NULL;
    palp_status status = network_make_pattern(net);
    if (status) { /* slots are set last, so they are still the old ones */
        linsys_free(net->ls);
        net->ls = old;
        net->n_other_pairs = 0;
        return status;
    }
    linsys_free(old);
    return PALP_OK;
}

static int compare_pairs_by_ends(const void *a, const void *b) {
    const int32_t *p = a, *q = b;
    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

const uint32_t *network_other_slots(const palp_network *net, int32_t low, int32_t high) {
    const int32_t key[2] = {low, high}, *list = net->other_pair;
    const int32_t *found =
        list ? bsearch(key, list, net->n_other_pairs, sizeof key, compare_pairs_by_ends) : NULL;
    return found ? net->other_slot + 9 * ((found - list) / 2) : NULL;
}
