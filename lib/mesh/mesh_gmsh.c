/* mesh_gmsh.c: makes a network's mesh from a Gmsh file. */
#define _POSIX_C_SOURCE 200809L /* locale_t */
#include "mesh_gmsh.h"
#include "mesh_internal.h"
#include "base/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Is there an element between nodes a < b of a cell? In tetrahedra between every pair. In hexahedra along the
 * edges, bit b of edges[a]; with diagonals between every pair too. */
static bool are_cell_nodes_joined(const gmsh_cell *cell, bool diagonals, int a, int b) {
    static const unsigned char edges[GMSH_CELL_NODES] = {
        1 << 1 | 1 << 3 | 1 << 4, 1 << 2 | 1 << 5, 1 << 3 | 1 << 6, 1 << 7,
        1 << 5 | 1 << 7,          1 << 6,          1 << 7,          0};
    return cell->n == 4 || diagonals || (edges[a] >> b & 1);
}

/* Numbers the nodes of cells in the order of their tags; returns their number. */
static size_t number_nodes_of_cells(gmsh_file *r) {
    gmsh_node *nodes = r->nodes.items;
    const gmsh_cell *cells = r->cells.items;
    size_t n = 0;
    for (size_t c = 0; c < r->cells.n; c++)
        for (int i = 0; i < cells[c].n; i++)
            nodes[cells[c].node[i]].index = 0;
    for (size_t i = 0; i < r->nodes.n; i++)
        if (nodes[i].index == 0)
            nodes[i].index = (int32_t)n++;
    return n;
}

static size_t count_pairs_of_cells(const gmsh_file *r, bool diagonals) {
    const gmsh_cell *cells = r->cells.items;
    size_t n = 0;
    for (size_t c = 0; c < r->cells.n; c++)
        n += cells[c].n == 4 ? 6 : diagonals ? 28 : 12;
    return n;
}

static void copy_node_positions(const gmsh_file *r, palp_mesh *mesh) {
    const gmsh_node *nodes = r->nodes.items;
    for (size_t i = 0; i < r->nodes.n; i++)
        if (nodes[i].index >= 0)
            memcpy(mesh->x_m + 3 * (size_t)nodes[i].index, nodes[i].x_m, sizeof nodes[i].x_m);
}

/* Writes the pairs of one cell at *pair and moves *pair behind them. */
static palp_status append_pairs_of_cell(const gmsh_file *r, const gmsh_cell *cell, bool diagonals,
                                        double size_m, int32_t **pair) {
    const gmsh_node *nodes = r->nodes.items;
    for (int a = 0; a < cell->n; a++)
        for (int b = a + 1; b < cell->n; b++) {
            if (!are_cell_nodes_joined(cell, diagonals, a, b))
                continue;
            const gmsh_node *from = &nodes[cell->node[a]], *to = &nodes[cell->node[b]];
            if (!mesh_length_ok(from->x_m, to->x_m, size_m))
                return gmsh_fail(r, cell->line,
                                 "an element of zero length: nodes %lld and %lld are at the same place",
                                 from->tag, to->tag);
            *(*pair)++ = from->index;
            *(*pair)++ = to->index;
        }
    return PALP_OK;
}

static palp_status append_pairs_of_all_cells(const gmsh_file *r, bool diagonals, palp_mesh *mesh) {
    const gmsh_cell *cells = r->cells.items;
    double size_m = mesh_diagonal(mesh->n_nodes, mesh->x_m);
    int32_t *pair = mesh->pairs;
    if (!isfinite(size_m))
        return gmsh_fail(r, r->elements_line, "the mesh is too large");
    for (size_t c = 0; c < r->cells.n; c++) {
        palp_status status = append_pairs_of_cell(r, &cells[c], diagonals, size_m, &pair);
        if (status)
            return status;
    }
    mesh->n_elements = mesh_pairs_unique(mesh->n_elements, mesh->pairs);
    pair = realloc(mesh->pairs, 2 * mesh->n_elements * sizeof *pair);
    mesh->pairs = pair ? pair : mesh->pairs;
    return PALP_OK;
}

/* Orders cells by their nodes, then by physical tag, then by line. */
static int compare_cells_by_nodes(const void *left, const void *right) {
    const gmsh_cell *a = left, *b = right;
    for (int i = 0; i < GMSH_CELL_NODES; i++)
        if (a->node[i] != b->node[i])
            return a->node[i] < b->node[i] ? -1 : 1;
    if (a->physical != b->physical)
        return a->physical < b->physical ? -1 : 1;
    return (a->line > b->line) - (a->line < b->line);
}

static bool have_cells_same_nodes(const gmsh_cell *a, const gmsh_cell *b) {
    return memcmp(a->node, b->node, sizeof a->node) == 0;
}

/* A copy of the cells in this order, the nodes of each ascending. The caller frees it; NULL: no memory. */
static gmsh_cell *copy_cells_sorted_by_nodes(const gmsh_file *r) {
    gmsh_cell *sorted = malloc(r->cells.n * sizeof *sorted);
    if (!sorted)
        return NULL;
    memcpy(sorted, r->cells.items, r->cells.n * sizeof *sorted);
    for (size_t c = 0; c < r->cells.n; c++) {
        for (int i = sorted[c].n; i < GMSH_CELL_NODES; i++)
            sorted[c].node[i] = INT32_MAX;
        qsort(sorted[c].node, GMSH_CELL_NODES, sizeof *sorted[c].node, mesh_compare_nodes);
        sorted[c].index = c;
    }
    qsort(sorted, r->cells.n, sizeof *sorted, compare_cells_by_nodes);
    return sorted;
}

static palp_status refuse_repeated_cells(const gmsh_file *r) {
    gmsh_cell *sorted = copy_cells_sorted_by_nodes(r);
    if (!sorted)
        return gmsh_no_memory(r);
    palp_status status = PALP_OK;
    for (size_t c = 1; c < r->cells.n && !status; c++)
        if (have_cells_same_nodes(&sorted[c], &sorted[c - 1]))
            status = gmsh_fail(r, sorted[c].line, "an element with the same nodes as that of line %zu",
                               sorted[c - 1].line);
    free(sorted);
    return status;
}

/* Of the cells with the nodes of the first, those in different groups go into the one that is first in the
 * file: into[index]. Returns the number of cells with these nodes. */
static size_t join_cells_with_same_nodes(const gmsh_cell *sorted, size_t n_left, size_t *into) {
    size_t n = 0, lowest = sorted[0].index;
    for (; n < n_left && have_cells_same_nodes(&sorted[n], &sorted[0]); n++)
        lowest = sorted[n].index < lowest ? sorted[n].index : lowest;
    for (size_t i = 0; i < n; i++) {
        bool repeated = i > 0 && sorted[i].physical == sorted[i - 1].physical;
        into[sorted[i].index] = repeated || sorted[0].physical == 0 ? sorted[i].index : lowest;
    }
    return n;
}

/* Removes the cells that go into another one, which is in front of them, and renumbers those of volumes. */
static void remove_joined_cells(gmsh_file *r, size_t *into) {
    gmsh_cell *cells = r->cells.items;
    gmsh_volume *volumes = r->volumes.items;
    size_t kept = 0;
    for (size_t c = 0; c < r->cells.n; c++)
        if (into[c] == c) {
            cells[kept] = cells[c];
            into[c] = kept++;
        } else {
            into[c] = into[into[c]];
        }
    for (size_t v = 0; v < r->volumes.n; v++)
        volumes[v].cell = into[volumes[v].cell];
    r->cells.n = kept;
}

/* Version 2.2 has a cell once for each of its groups: makes one cell of these. */
static palp_status join_cells_of_several_groups(gmsh_file *r) {
    gmsh_cell *sorted = copy_cells_sorted_by_nodes(r);
    size_t *into = malloc(r->cells.n * sizeof *into);
    palp_status status = sorted && into ? PALP_OK : gmsh_no_memory(r);
    for (size_t c = 0; c < r->cells.n && !status;)
        c += join_cells_with_same_nodes(sorted + c, r->cells.n - c, into);
    if (!status)
        remove_joined_cells(r, into);
    free(sorted);
    free(into);
    return status;
}

/* Is the volume rounding, compared with the cube of the longest edge from the first node? */
static bool is_tetrahedron_flat(const double *x, const int32_t node[4]) {
    double longest = 0.0;
    for (int i = 1; i < 4; i++) {
        const double *a = x + 3 * (size_t)node[0], *b = x + 3 * (size_t)node[i];
        longest = fmax(longest, hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]));
    }
    return fabs(mesh_volume6(x, node)) <= 1e-12 * longest * longest * longest;
}

static palp_status copy_cells_as_tetrahedra(const gmsh_file *r, palp_mesh *mesh) {
    const gmsh_cell *cells = r->cells.items;
    const gmsh_node *nodes = r->nodes.items;
    size_t n = 0;
    for (size_t c = 0; c < r->cells.n; c++)
        n += cells[c].n != 4;
    mesh->tetrahedra = arena_take(&mesh->memory, 4 * (r->cells.n + 5 * n), sizeof *mesh->tetrahedra);
    mesh->hexahedra = n > 0 ? arena_take(&mesh->memory, 8 * n, sizeof *mesh->hexahedra) : NULL;
    if (mesh->memory.failed)
        return gmsh_no_memory(r);
    for (size_t c = 0; c < r->cells.n; c++) {
        int32_t node[GMSH_CELL_NODES];
        for (int i = 0; i < cells[c].n; i++)
            node[i] = nodes[cells[c].node[i]].index;
        mesh_split_cell(mesh, cells[c].n, node);
        if (cells[c].n == 4 && is_tetrahedron_flat(mesh->x_m, node))
            return gmsh_fail(r, cells[c].line, "a flat tetrahedron: its nodes lie in one plane");
    }
    return mesh_add_surface(mesh) ? gmsh_no_memory(r) : PALP_OK;
}

static const gmsh_node *find_node_with_index(const gmsh_file *r, size_t index) {
    const gmsh_node *node = r->nodes.items;
    while (node->index < 0 || (size_t)node->index != index)
        node++;
    return node;
}

static palp_status check_mesh_is_connected(const gmsh_file *r, const palp_mesh *mesh) {
    size_t parts, other;
    if (mesh_part_away(mesh, &parts, &other))
        return gmsh_no_memory(r);
    if (parts == 1)
        return PALP_OK;
    const gmsh_node *from = find_node_with_index(r, 0), *to = find_node_with_index(r, other);
    return gmsh_fail(r, to->line,
                     "the mesh has %zu separate parts: no elements connect node %lld to node %lld", parts,
                     from->tag, to->tag);
}

static int compare_group_members(const void *left, const void *right) {
    const gmsh_member *a = left, *b = right;
    if (a->group != b->group)
        return a->group < b->group ? -1 : 1;
    return (a->node > b->node) - (a->node < b->node);
}

/* Adds the group of the members from *first on and moves *first behind them. A group without nodes in the
 * mesh gives no set. */
static palp_status add_node_set_of_group(const gmsh_file *r, palp_mesh *mesh, int32_t *set, size_t *first) {
    const gmsh_member *members = r->members.items;
    const gmsh_node *nodes = r->nodes.items;
    size_t group = members[*first].group, n = 0;
    for (; *first < r->members.n && members[*first].group == group; ++*first) {
        int32_t index = nodes[members[*first].node].index;
        if (index >= 0 && (n == 0 || set[n - 1] != index))
            set[n++] = index;
    }
    return n > 0 ? palp_mesh_add_set(mesh, ((gmsh_group *)r->groups.items)[group].name, n, set) : PALP_OK;
}

static palp_status add_node_sets_of_groups(const gmsh_file *r, palp_mesh *mesh) {
    int32_t *set = malloc(mesh->n_nodes * sizeof *set);
    palp_status status = set ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && r->members.n > 0)
        qsort(r->members.items, r->members.n, sizeof(gmsh_member), compare_group_members);
    for (size_t i = 0; i < r->members.n && !status;)
        status = add_node_set_of_group(r, mesh, set, &i);
    free(set);
    return status;
}

/* Adds the lowest or highest nodes in y as a set, unless the file has a group of that name. */
static palp_status add_missing_end_set(const gmsh_file *r, palp_mesh *mesh, const char *name, bool top) {
    const gmsh_group *groups = r->groups.items;
    double low[3], high[3];
    for (size_t g = 0; g < r->groups.n; g++)
        if (strcmp(groups[g].name, name) == 0)
            return PALP_OK;
    palp_mesh_bounds(mesh, low, high);
    return palp_mesh_add_plane_set(mesh, name, 1, top ? high[1] : low[1], 1e-6 * (high[1] - low[1]));
}

static palp_status add_all_node_sets(const gmsh_file *r, palp_mesh *mesh) {
    palp_status status = add_node_sets_of_groups(r, mesh);
    if (!status)
        status = add_missing_end_set(r, mesh, "bottom", false);
    if (!status)
        status = add_missing_end_set(r, mesh, "top", true);
    return status ? gmsh_no_memory(r) : PALP_OK;
}

/* A region for each group of volumes. A group has all volumes of its blocks, in any order. */
static palp_status add_regions_of_groups(const gmsh_file *r, palp_mesh *mesh) {
    const gmsh_volume *volumes = r->volumes.items;
    const gmsh_cell *cells = r->cells.items;
    size_t *first = malloc(r->cells.n * sizeof *first), at = 0;
    double *part = malloc(mesh->n_tetrahedra * sizeof *part);
    palp_status status = first && part ? PALP_OK : gmsh_no_memory(r);
    for (size_t c = 0; c < r->cells.n && !status; c++) {
        first[c] = at;
        at += cells[c].n == 4 ? 1 : 6;
    }
    for (size_t g = 0; g < r->groups.n && !status; g++) {
        bool any = false;
        memset(part, 0, mesh->n_tetrahedra * sizeof *part);
        for (size_t v = 0; v < r->volumes.n; v++)
            for (size_t t = 0; volumes[v].group == g && t < (cells[volumes[v].cell].n == 4 ? 1 : 6); t++) {
                part[first[volumes[v].cell] + t] = 1.0;
                any = true;
            }
        if (any && mesh_take_region(mesh, ((gmsh_group *)r->groups.items)[g].name, part))
            status = gmsh_no_memory(r);
    }
    free(first);
    free(part);
    return status;
}

static palp_status build_mesh_from_gmsh(gmsh_file *r, bool diagonals, palp_mesh **mesh) {
    palp_mesh *m = NULL;
    if (r->cells.n == 0)
        return gmsh_fail(r, r->elements_line,
                         "there are no 4-node tetrahedra (type 4) or 8-node hexahedra (type 5)");
    if (r->version == GMSH_2_2 && join_cells_of_several_groups(r))
        return PALP_ERR_NO_MEMORY;
    size_t n_nodes = number_nodes_of_cells(r);
    if (mesh_new(n_nodes, count_pairs_of_cells(r, diagonals), &m))
        return gmsh_no_memory(r);
    copy_node_positions(r, m);
    palp_status status = append_pairs_of_all_cells(r, diagonals, m);
    if (!status)
        status = refuse_repeated_cells(r);
    if (!status)
        status = check_mesh_is_connected(r, m);
    if (!status)
        status = copy_cells_as_tetrahedra(r, m);
    if (!status)
        status = add_all_node_sets(r, m);
    if (!status)
        status = add_regions_of_groups(r, m);
    if (status)
        palp_mesh_free(m);
    else
        *mesh = m;
    return status;
}

palp_status palp_mesh_read_gmsh(const char *path, double scale_m, bool hex_diagonals, palp_mesh **mesh,
                                palp_error *error) {
    if (!path || !mesh || !(scale_m > 0.0 && isfinite(scale_m)))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a mesh needs a path and a scale above 0");
    gmsh_file r = {.path = path, .error = error, .scale_m = scale_m};
    palp_locale locale;
    if (!palp_locale_enter(&locale))
        return gmsh_no_memory(&r);
    palp_status status = gmsh_read(&r);
    if (!status)
        status = build_mesh_from_gmsh(&r, hex_diagonals, mesh);
    gmsh_release(&r);
    palp_locale_leave(&locale);
    return status;
}
