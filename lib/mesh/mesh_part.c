/* mesh_part.c: the part of a mesh that one of several processes has. */
#include "mesh_internal.h"

#include <stdlib.h>
#include <string.h>

typedef struct selection {
    const palp_mesh *mesh;
    const int32_t *owner_of_node;
    int32_t owner;
    int32_t *local;  /* [n_nodes] number in the part, or -1 */
    size_t per_cell; /* tetrahedra of a solid (mesh_solids) */
    size_t n_nodes, n_elements, n_tetrahedra;
} selection;

static bool is_in_part(const selection *s, const int32_t *node) {
    return s->owner_of_node[node[0]] == s->owner;
}

/* The six tetrahedra of a hexahedron are in one part. */
static bool is_tetrahedron_in_part(const selection *s, size_t i) {
    return is_in_part(s, s->mesh->tetrahedra + 4 * (i - i % s->per_cell));
}

static void mark_nodes(const selection *s, size_t n, const int32_t *node) {
    for (size_t i = 0; i < n; i++)
        s->local[node[i]] = 0;
}

static void select_part(selection *s, bool surface) {
    const palp_mesh *m = s->mesh;
    for (size_t i = 0; i < m->n_nodes; i++)
        s->local[i] = s->owner_of_node[i] == s->owner ? 0 : -1;
    for (size_t i = 0; i < m->n_elements; i++)
        if (is_in_part(s, m->pairs + 2 * i)) {
            mark_nodes(s, 2, m->pairs + 2 * i);
            s->n_elements++;
        }
    for (size_t i = 0; i < m->n_tetrahedra; i++)
        if (is_tetrahedron_in_part(s, i)) {
            mark_nodes(s, 4, m->tetrahedra + 4 * i);
            s->n_tetrahedra++;
        }
    if (surface)
        mark_nodes(s, 3 * m->n_triangles, m->triangles);
    for (size_t i = 0; i < m->n_nodes; i++)
        if (s->local[i] == 0)
            s->local[i] = (int32_t)s->n_nodes++;
}

static void renumber(const selection *s, size_t n, const int32_t *from, int32_t *to) {
    for (size_t i = 0; i < n; i++)
        to[i] = s->local[from[i]];
}

static void fill_nodes(const selection *s, palp_mesh *p, int32_t *node) {
    for (size_t i = 0; i < s->mesh->n_nodes; i++)
        if (s->local[i] >= 0) {
            memcpy(p->x_m + 3 * s->local[i], s->mesh->x_m + 3 * i, 3 * sizeof *p->x_m);
            node[s->local[i]] = (int32_t)i;
        }
}

/* number[n_elements of the mesh] becomes that of each element in the part, or -1. */
static void fill_elements(const selection *s, palp_mesh *p, int32_t *element, int32_t *number) {
    const palp_mesh *m = s->mesh;
    size_t n = 0;
    for (size_t i = 0; i < m->n_elements; i++) {
        number[i] = is_in_part(s, m->pairs + 2 * i) ? (int32_t)n : -1;
        if (number[i] < 0)
            continue;
        renumber(s, 2, m->pairs + 2 * i, p->pairs + 2 * n);
        if (p->scale)
            p->scale[n] = m->scale[i];
        element[n++] = (int32_t)i;
    }
    n = 0;
    for (size_t i = 0; i < m->n_elements && p->order; i++)
        if (number[m->order[i]] >= 0)
            p->order[n++] = (size_t)number[m->order[i]];
}

static palp_status fill_solids(const selection *s, palp_mesh *p, bool surface, int32_t *solid) {
    const palp_mesh *m = s->mesh;
    const bool cells = s->per_cell > 1;
    size_t n = 0;
    p->tetrahedra = arena_take(&p->memory, 4 * s->n_tetrahedra, sizeof *p->tetrahedra);
    if (cells)
        p->hexahedra = arena_take(&p->memory, 8 * s->n_tetrahedra / s->per_cell, sizeof *p->hexahedra);
    if (surface)
        p->triangles = arena_take(&p->memory, 3 * m->n_triangles, sizeof *p->triangles);
    if (p->memory.failed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < m->n_tetrahedra; i++) {
        if (!is_tetrahedron_in_part(s, i))
            continue;
        renumber(s, 4, m->tetrahedra + 4 * i, p->tetrahedra + 4 * p->n_tetrahedra++);
        if (i % s->per_cell == 0)
            solid[n++] = (int32_t)(i / s->per_cell);
    }
    p->n_hexahedra = cells ? n : 0;
    for (size_t i = 0; i < p->n_hexahedra; i++)
        renumber(s, 8, m->hexahedra + 8 * (size_t)solid[i], p->hexahedra + 8 * i);
    if (surface) {
        renumber(s, 3 * m->n_triangles, m->triangles, p->triangles);
        p->n_triangles = m->n_triangles;
    }
    return PALP_OK;
}

/* room[n_nodes of the part] is scratch. */
static palp_status fill_sets(const selection *s, palp_mesh *p, int32_t *room) {
    palp_status status = PALP_OK;
    for (size_t k = 0; k < s->mesh->n_sets && !status; k++) {
        const node_set *set = &s->mesh->sets[k];
        size_t n = 0;
        for (size_t i = 0; i < set->n; i++)
            if (s->local[set->nodes[i]] >= 0)
                room[n++] = s->local[set->nodes[i]];
        status = palp_mesh_add_set(p, set->name, n, room);
    }
    return status;
}

static palp_status fill_part(const selection *s, palp_mesh *p, bool surface, int32_t *node, int32_t *element,
                             int32_t *solid) {
    const palp_mesh *m = s->mesh;
    if (m->scale)
        p->scale = arena_take(&p->memory, s->n_elements, sizeof *p->scale);
    if (m->order)
        p->order = arena_take(&p->memory, s->n_elements, sizeof *p->order);
    int32_t *number = malloc((m->n_elements + 1) * sizeof *number);
    palp_status status = number && !p->memory.failed ? fill_solids(s, p, surface, solid) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = fill_sets(s, p, node); /* node is filled below */
    if (!status) {
        fill_nodes(s, p, node);
        fill_elements(s, p, element, number);
    }
    free(number);
    return status;
}

palp_status mesh_part(const palp_mesh *mesh, const int32_t *owner_of_node, int32_t owner, bool surface,
                      palp_mesh **part, int32_t **node, int32_t **element, int32_t **solid) {
    selection s = {.mesh = mesh,
                   .owner_of_node = owner_of_node,
                   .owner = owner,
                   .per_cell = mesh_is_all_hexahedra(mesh) ? 6 : 1};
    palp_mesh *p = NULL;
    if (mesh->n_elements > INT32_MAX)
        return PALP_ERR_LIMIT;
    s.local = malloc(mesh->n_nodes * sizeof *s.local);
    if (!s.local)
        return PALP_ERR_NO_MEMORY;
    select_part(&s, surface);
    *node = malloc((s.n_nodes + 1) * sizeof **node);
    *element = malloc((s.n_elements + 1) * sizeof **element);
    *solid = malloc((s.n_tetrahedra / s.per_cell + 1) * sizeof **solid);
    palp_status status =
        *node && *element && *solid ? mesh_new(s.n_nodes, s.n_elements, &p) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = fill_part(&s, p, surface, *node, *element, *solid);
    free(s.local);
    if (status) {
        free(*node);
        free(*element);
        free(*solid);
        palp_mesh_free(p);
        *node = *element = *solid = NULL;
    } else
        *part = p;
    return status;
}
