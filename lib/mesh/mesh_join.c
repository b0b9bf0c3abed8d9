/* mesh_join.c: two meshes as separate parts of one. */
#include "mesh_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The array first[n width], then second with step added, in the joined mesh's memory; NULL if both are. */
static int32_t *join_node_lists(palp_mesh *joined, size_t width, size_t n_first, const int32_t *first,
                                size_t n_second, const int32_t *second, size_t step) {
    if (n_first + n_second == 0)
        return NULL;
    int32_t *all = arena_take(&joined->memory, width * (n_first + n_second), sizeof *all);
    for (size_t i = 0; all && i < width * n_first; i++)
        all[i] = first[i];
    for (size_t i = 0; all && i < width * n_second; i++)
        all[width * n_first + i] = second[i] + (int32_t)step;
    return all;
}

static void join_scales_and_orders(palp_mesh *joined, const palp_mesh *first, const palp_mesh *second) {
    const size_t n = first->n_elements;
    if (first->scale || second->scale)
        joined->scale = arena_take(&joined->memory, joined->n_elements, sizeof *joined->scale);
    if (first->order || second->order)
        joined->order = arena_take(&joined->memory, joined->n_elements, sizeof *joined->order);
    for (size_t i = 0; i < joined->n_elements; i++) {
        const palp_mesh *from = i < n ? first : second;
        const size_t start = i < n ? 0 : n, own = i - start;
        if (joined->scale)
            joined->scale[i] = from->scale ? from->scale[own] : 1.0;
        if (joined->order)
            joined->order[i] = start + (from->order ? from->order[own] : own);
    }
}

static palp_status copy_sets_and_regions(palp_mesh *joined, const palp_mesh *from, const char *prefix,
                                         size_t first_node, size_t first_tetrahedron, int32_t *node,
                                         double *part) {
    palp_status status = PALP_OK;
    size_t longest = 1;
    for (size_t i = 0; i < from->n_sets; i++)
        longest = strlen(from->sets[i].name) > longest ? strlen(from->sets[i].name) : longest;
    for (size_t i = 0; i < from->n_regions; i++)
        longest = strlen(from->regions[i].name) > longest ? strlen(from->regions[i].name) : longest;
    const size_t size = strlen(prefix) + longest + 1;
    char *name = malloc(size);
    if (!name)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < from->n_sets && !status; i++) {
        for (size_t k = 0; k < from->sets[i].n; k++)
            node[k] = from->sets[i].nodes[k] + (int32_t)first_node;
        snprintf(name, size, "%s%s", prefix, from->sets[i].name);
        status = palp_mesh_add_set(joined, name, from->sets[i].n, node);
    }
    for (size_t i = 0; i < from->n_regions && !status; i++) {
        memset(part, 0, joined->n_tetrahedra * sizeof *part);
        memcpy(part + first_tetrahedron, from->regions[i].part, from->n_tetrahedra * sizeof *part);
        snprintf(name, size, "%s%s", prefix, from->regions[i].name);
        status = mesh_take_region(joined, name, part);
    }
    free(name);
    return status;
}

/* All of the second mesh as a set and, where it has tetrahedra, as a region. */
static palp_status name_second_part(palp_mesh *joined, const palp_mesh *first, const char *name,
                                    int32_t *node, double *part) {
    const size_t n = joined->n_nodes - first->n_nodes;
    for (size_t i = 0; i < n; i++)
        node[i] = (int32_t)(first->n_nodes + i);
    palp_status status = palp_mesh_add_set(joined, name, n, node);
    for (size_t i = 0; i < joined->n_tetrahedra; i++)
        part[i] = i < first->n_tetrahedra ? 0.0 : 1.0;
    return status || joined->n_tetrahedra == first->n_tetrahedra ? status
                                                                 : mesh_take_region(joined, name, part);
}

static palp_status name_parts_of_joined_mesh(palp_mesh *joined, const palp_mesh *first,
                                             const palp_mesh *second, const char *name) {
    const size_t size = strlen(name) + 2;
    int32_t *node = malloc(joined->n_nodes * sizeof *node);
    double *part = malloc((joined->n_tetrahedra + 1) * sizeof *part);
    char *prefix = malloc(size);
    palp_status status = node && part && prefix ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        snprintf(prefix, size, "%s.", name);
        status = copy_sets_and_regions(joined, first, "", 0, 0, node, part);
    }
    if (!status)
        status =
            copy_sets_and_regions(joined, second, prefix, first->n_nodes, first->n_tetrahedra, node, part);
    if (!status)
        status = name_second_part(joined, first, name, node, part);
    free(prefix);
    free(part);
    free(node);
    return status;
}

static palp_status join_arrays_of_meshes(palp_mesh *m, const palp_mesh *first, const palp_mesh *second) {
    const size_t n = first->n_nodes, e = first->n_elements;
    memcpy(m->x_m, first->x_m, 3 * n * sizeof *m->x_m);
    memcpy(m->x_m + 3 * n, second->x_m, 3 * second->n_nodes * sizeof *m->x_m);
    memcpy(m->pairs, first->pairs, 2 * e * sizeof *m->pairs);
    for (size_t i = 0; i < 2 * second->n_elements; i++)
        m->pairs[2 * e + i] = second->pairs[i] + (int32_t)n;
    m->n_tetrahedra = first->n_tetrahedra + second->n_tetrahedra;
    m->n_triangles = first->n_triangles + second->n_triangles;
    m->n_hexahedra = first->n_hexahedra + second->n_hexahedra;
    m->tetrahedra = join_node_lists(m, 4, first->n_tetrahedra, first->tetrahedra, second->n_tetrahedra,
                                    second->tetrahedra, n);
    m->triangles = join_node_lists(m, 3, first->n_triangles, first->triangles, second->n_triangles,
                                   second->triangles, n);
    m->hexahedra = join_node_lists(m, 8, first->n_hexahedra, first->hexahedra, second->n_hexahedra,
                                   second->hexahedra, n);
    join_scales_and_orders(m, first, second);
    return m->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

palp_status palp_mesh_join(const palp_mesh *first, const palp_mesh *second, const char *name,
                           palp_mesh **joined) {
    if (!first || !second || !name || !name[0] || !joined)
        return PALP_ERR_ARGUMENT;
    if (first->n_nodes + second->n_nodes > INT32_MAX ||
        first->n_tetrahedra + second->n_tetrahedra > INT32_MAX / 4)
        return PALP_ERR_LIMIT;
    size_t n;
    const int32_t *nodes;
    const double *part;
    if (!palp_mesh_set(first, name, &n, &nodes) || !palp_mesh_region(first, name, &part))
        return PALP_ERR_INPUT;
    palp_mesh *m = NULL;
    palp_status status =
        mesh_new(first->n_nodes + second->n_nodes, first->n_elements + second->n_elements, &m);
    if (status)
        return status;
    status = join_arrays_of_meshes(m, first, second);
    if (!status)
        status = name_parts_of_joined_mesh(m, first, second, name);
    if (status)
        palp_mesh_free(m);
    else
        *joined = m;
    return status;
}
