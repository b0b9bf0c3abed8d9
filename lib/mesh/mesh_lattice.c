/* mesh_lattice.c: a box lattice of particles with its face, edge or Moore neighbours. */
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

enum { HALF_MAX = 13 }; /* those of the 26 neighbours that have a higher number */

/* Offsets to the neighbours of higher number, ascending; returns how many. */
static int list_half_of_neighbours(palp_neighbourhood neighbourhood, int offset[HALF_MAX][3]) {
    int steps = neighbourhood == PALP_NEIGHBOURS_6 ? 1 : neighbourhood == PALP_NEIGHBOURS_18 ? 2 : 3;
    int n = 0;
    for (int code = 14; code < 27; code++) { /* in base 3; 13 is the node itself */
        int d[3] = {code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1};
        if (abs(d[0]) + abs(d[1]) + abs(d[2]) > steps)
            continue;
        for (int axis = 0; axis < 3; axis++)
            offset[n][axis] = d[axis];
        n++;
    }
    return n;
}

/* Number of nodes that have a neighbour at this offset. */
static size_t count_nodes_with_neighbour(const size_t nodes[3], const int offset[3]) {
    size_t count = 1;
    for (int axis = 0; axis < 3; axis++)
        count *= nodes[axis] - (offset[axis] != 0);
    return count;
}

static bool is_neighbour_in_lattice(const size_t nodes[3], const size_t at[3], const int offset[3]) {
    for (int axis = 0; axis < 3; axis++)
        if ((offset[axis] < 0 && at[axis] == 0) || (offset[axis] > 0 && at[axis] + 1 == nodes[axis]))
            return false;
    return true;
}

static void set_lattice_position(palp_mesh *mesh, const size_t nodes[3], const double size_m[3],
                                 const size_t at[3], size_t index) {
    for (int axis = 0; axis < 3; axis++) {
        size_t last = nodes[axis] - 1; /* puts the far face exactly at size */
        mesh->x_m[3 * index + (size_t)axis] =
            at[axis] == last ? size_m[axis] : size_m[axis] * (double)at[axis] / (double)last;
    }
}

/* Elements of one offset stand together for so many nodes. Those of a row are parallel and their ends
 * consecutive, so loops need no indices. Longer stretches would leave the nearest cache. */
enum { STRETCH = 128 };

static void fill_lattice_pairs(palp_mesh *mesh, const size_t nodes[3], const double size_m[3], int n_offsets,
                               int offset[HALF_MAX][3]) {
    int32_t *pair = mesh->pairs, stride[2] = {(int32_t)(nodes[1] * nodes[2]), (int32_t)nodes[2]};
    for (size_t start = 0; start < mesh->n_nodes; start += STRETCH)
        for (int k = 0; k < n_offsets; k++)
            for (size_t index = start; index < start + STRETCH && index < mesh->n_nodes; index++) {
                size_t at[3] = {index / (nodes[1] * nodes[2]), index / nodes[2] % nodes[1], index % nodes[2]};
                if (k == 0)
                    set_lattice_position(mesh, nodes, size_m, at, index);
                if (!is_neighbour_in_lattice(nodes, at, offset[k]))
                    continue;
                *pair++ = (int32_t)index;
                *pair++ = (int32_t)index + offset[k][0] * stride[0] + offset[k][1] * stride[1] + offset[k][2];
            }
}

/* Sorts the elements by lower node; within a node they are sorted already. */
static palp_status order_pairs_by_lower_node(palp_mesh *mesh) {
    arena scratch = {NULL, false};
    size_t *next = arena_take(&scratch, mesh->n_nodes + 1, sizeof *next);
    mesh->order = arena_take(&mesh->memory, mesh->n_elements, sizeof *mesh->order);
    if (next && mesh->order) {
        for (size_t e = 0; e < mesh->n_elements; e++)
            next[mesh->pairs[2 * e] + 1]++;
        for (size_t i = 0; i < mesh->n_nodes; i++)
            next[i + 1] += next[i];
        for (size_t e = 0; e < mesh->n_elements; e++)
            mesh->order[next[mesh->pairs[2 * e]]++] = e;
    }
    arena_free(&scratch);
    return next && mesh->order ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* Adds six tetrahedra for each box. */
static palp_status add_lattice_tetrahedra(palp_mesh *mesh, const size_t nodes[3]) {
    size_t boxes = (nodes[0] - 1) * (nodes[1] - 1) * (nodes[2] - 1), sx = nodes[1] * nodes[2], sy = nodes[2];
    mesh->tetrahedra = arena_take(&mesh->memory, boxes * 24, sizeof *mesh->tetrahedra);
    mesh->hexahedra = arena_take(&mesh->memory, boxes * 8, sizeof *mesh->hexahedra);
    if (!mesh->tetrahedra || !mesh->hexahedra)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i + 1 < nodes[0]; i++)
        for (size_t j = 0; j + 1 < nodes[1]; j++)
            for (size_t k = 0; k + 1 < nodes[2]; k++) {
                size_t o = i * sx + j * sy + k;
                const size_t at[8] = {o,     o + sx,     o + sx + sy,     o + sy,
                                      o + 1, o + sx + 1, o + sx + sy + 1, o + sy + 1};
                int32_t node[8];
                for (size_t c = 0; c < 8; c++)
                    node[c] = (int32_t)at[c];
                mesh_split_cell(mesh, 8, node);
            }
    return mesh_add_surface(mesh);
}

static palp_status add_face_node_sets(palp_mesh *mesh, const double size_m[3]) {
    static const char *const names[3][2] = {{"left", "right"}, {"bottom", "top"}, {"back", "front"}};
    palp_status status = PALP_OK;
    for (int face = 0; face < 6 && !status; face++) {
        int axis = face / 2;
        double value_m = face % 2 ? size_m[axis] : 0.0;
        status = palp_mesh_add_plane_set(mesh, names[axis][face % 2], axis, value_m, 0.0);
    }
    return status;
}

static bool are_arguments_valid(const size_t nodes[3], const double size_m[3],
                                palp_neighbourhood neighbourhood) {
    size_t product = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (nodes[axis] < 2 || nodes[axis] > INT32_MAX / product)
            return false;
        product *= nodes[axis];
        if (!(size_m[axis] > 0.0 && isfinite(size_m[axis])))
            return false;
    }
    return neighbourhood == PALP_NEIGHBOURS_6 || neighbourhood == PALP_NEIGHBOURS_18 ||
           neighbourhood == PALP_NEIGHBOURS_26;
}

palp_status palp_mesh_lattice(const size_t nodes[3], const double size_m[3], palp_neighbourhood neighbourhood,
                              palp_mesh **mesh) {
    if (!mesh || !nodes || !size_m || !are_arguments_valid(nodes, size_m, neighbourhood))
        return PALP_ERR_ARGUMENT;
    int offset[HALF_MAX][3], n_offsets = list_half_of_neighbours(neighbourhood, offset);
    size_t n_elements = 0;
    for (int k = 0; k < n_offsets; k++)
        n_elements += count_nodes_with_neighbour(nodes, offset[k]);
    palp_mesh *m = NULL;
    palp_status status = mesh_new(nodes[0] * nodes[1] * nodes[2], n_elements, &m);
    if (status)
        return status;
    fill_lattice_pairs(m, nodes, size_m, n_offsets, offset);
    status = order_pairs_by_lower_node(m);
    if (!status)
        status = add_face_node_sets(m, size_m);
    if (!status)
        status = add_lattice_tetrahedra(m, nodes);
    if (status)
        palp_mesh_free(m);
    else
        *mesh = m;
    return status;
}
