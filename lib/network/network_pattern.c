/* network_pattern.c: the pattern of the tangent, and where each block goes in the solver's values. */
#include "network_internal.h"

#include <stdlib.h>

/* Neighbours of each node with a higher or the same number, ascending: [first[a], first[a + 1]). */
static palp_status neighbours(const palp_network *net, size_t **first, int32_t **list) {
    size_t n = net->n_nodes, *count = calloc(n + 2, sizeof *count);
    int32_t *out = malloc((n + net->n_elements + 1) * sizeof *out);
    if (!count || !out) {
        free(count);
        free(out);
        return PALP_ERR_NO_MEMORY;
    }
    for (size_t i = 0; i < n; i++)
        count[i + 2] = 1;
    for (size_t i = 0; i < net->n_elements; i++) {
        int32_t a = net->pair[2 * i], b = net->pair[2 * i + 1];
        count[(a < b ? a : b) + 2]++;
    }
    for (size_t i = 2; i < n + 2; i++)
        count[i] += count[i - 1];
    for (size_t i = 0; i < n; i++)
        out[count[i + 1]++] = (int32_t)i;
    for (size_t i = 0; i < net->n_elements; i++) {
        int32_t a = net->pair[2 * i], b = net->pair[2 * i + 1];
        out[count[(a < b ? a : b) + 1]++] = a < b ? b : a;
    }
    for (size_t i = 0; i < n; i++) /* insertion sort: a node has few neighbours */
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

/* Lower triangle of the tangent by columns. With row NULL only counts. */
static size_t fill_pattern(const palp_network *net, const size_t *first, const int32_t *list, size_t *column,
                           int32_t *row) {
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

static palp_status make_linsys(palp_network *net) {
    size_t *first = NULL, *column = malloc((net->n_free + 1) * sizeof *column);
    int32_t *list = NULL, *row = NULL;
    palp_status status = column ? neighbours(net, &first, &list) : PALP_ERR_NO_MEMORY;
    if (!status) {
        size_t nz = fill_pattern(net, first, list, column, NULL);
        row = malloc((nz + 1) * sizeof *row);
        if (row)
            fill_pattern(net, first, list, column, row);
        status = row ? linsys_create(net->settings.solver, net->n_free, column, row, &net->ls) : PALP_ERR_NO_MEMORY;
    }
    free(first);
    free(list);
    free(column);
    free(row);
    return status;
}

static uint32_t slot_of(const palp_network *net, size_t i, size_t j) {
    int32_t a = net->dof[i], b = net->dof[j];
    if (a < 0 || b < 0)
        return (uint32_t)linsys_value_count(net->ls); /* the bin */
    return (uint32_t)(a > b ? linsys_slot(net->ls, (size_t)a, (size_t)b) : linsys_slot(net->ls, (size_t)b, (size_t)a));
}

static palp_status find_slots(palp_network *net) {
    if (linsys_value_count(net->ls) >= UINT32_MAX)
        return PALP_ERR_LIMIT;
    for (size_t i = 0; i < net->n_elements; i++)
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++)
                net->slot[9 * i + 3 * r + c] =
                    slot_of(net, 3 * (size_t)net->pair[2 * i + 1] + r, 3 * (size_t)net->pair[2 * i] + c);
    for (size_t i = 0; i < net->n_nodes; i++) {
        uint32_t *s = net->slot_node + 6 * i;
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c <= r; c++)
                *s++ = slot_of(net, 3 * i + r, 3 * i + c);
    }
    return PALP_OK;
}

palp_status network_make_pattern(palp_network *net) {
    palp_status status = make_linsys(net);
    return status ? status : find_slots(net);
}
