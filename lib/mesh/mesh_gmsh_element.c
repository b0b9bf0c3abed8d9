/* mesh_gmsh_element.c: what the versions of a Gmsh file share: nodes, elements and the groups of these. */
#include "mesh_gmsh.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- nodes --------------------------------------------------------------------------------------- */

palp_status gmsh_read_node_tag(gmsh_file *r) {
    long long tag = 0;
    void *item = NULL;
    palp_status status = gmsh_integer(r, "a node tag", 1, LLONG_MAX, &tag);
    if (!status)
        status = gmsh_append(r, &r->nodes, sizeof(gmsh_node), &item);
    if (!status)
        *(gmsh_node *)item = (gmsh_node){tag, {0.0, 0.0, 0.0}, r->line, -1};
    return status;
}

palp_status gmsh_read_node_place(gmsh_file *r, gmsh_node *n) {
    palp_status status = PALP_OK;
    for (int axis = 0; axis < 3 && !status; axis++) {
        status = gmsh_number(r, "a coordinate", &n->x_m[axis]);
        n->x_m[axis] *= r->scale_m;
        if (!status && !isfinite(n->x_m[axis]))
            status = gmsh_fail(r, r->line, "a coordinate is out of range");
    }
    return status;
}

static int compare_node_tags(const void *left, const void *right) {
    const gmsh_node *a = left, *b = right;
    if (a->tag != b->tag)
        return a->tag < b->tag ? -1 : 1;
    return (a->line > b->line) - (a->line < b->line);
}

palp_status gmsh_sort_nodes_by_tag(gmsh_file *r) {
    gmsh_node *nodes = r->nodes.items;
    const gmsh_node *again = NULL;
    if (r->nodes.n > 0)
        qsort(nodes, r->nodes.n, sizeof *nodes, compare_node_tags);
    for (size_t i = 1; i < r->nodes.n; i++)
        if (nodes[i].tag == nodes[i - 1].tag && (!again || nodes[i].line < again->line))
            again = &nodes[i];
    return again ? gmsh_fail(r, again->line, "node tag %lld is given a second time", again->tag) : PALP_OK;
}

/* ---- types and groups ---------------------------------------------------------------------------- */

/* Number of nodes of the element types that are read, 0 for others. Volumes are tetrahedra and hexahedra of
 * first order. Points, lines and faces, which only define groups, have all common types. */
static int node_count_of_type(long long type) {
    static const signed char nodes[] = {
        [1] = 2,   [2] = 3,   [3] = 4,  [4] = 4,  [5] = 8,   [8] = 3,   [9] = 6,
        [10] = 9,  [15] = 1,  [16] = 8, [20] = 9, [21] = 10, [22] = 12, [23] = 15,
        [24] = 15, [25] = 21, [26] = 4, [27] = 5, [28] = 6};
    return type < (long long)sizeof nodes ? nodes[type] : 0;
}

enum { TYPE_NODES_MAX = 21 };

static bool is_type_of_cells(long long type) {
    return type == 4 || type == 5;
}

int gmsh_dimension_of_type(long long type) {
    bool line = type == 1 || type == 8 || (type >= 26 && type <= 28);
    return is_type_of_cells(type) ? 3 : type == 15 ? 0 : line ? 1 : 2;
}

palp_status gmsh_check_element_type(const gmsh_file *r, long long type) {
    if (node_count_of_type(type) > 0)
        return PALP_OK;
    return gmsh_fail(r, r->line,
                     "elements of type %lld are not supported; mesh the volume with 4-node tetrahedra "
                     "(type 4) or 8-node hexahedra (type 5)",
                     type);
}

palp_status gmsh_refuse_partitions(gmsh_file *r) {
    return gmsh_fail(r, r->line, "partitioned meshes are not supported; save it in one part");
}

/* The first group of the same name: one node set for all dimensions. */
static size_t find_group_of_same_name(const gmsh_file *r, const char *name) {
    const gmsh_group *groups = r->groups.items;
    size_t i = 0;
    while (strcmp(groups[i].name, name) != 0)
        i++;
    return i;
}

palp_status gmsh_add_groups_of_tag(gmsh_file *r, long long dim, long long physical) {
    const gmsh_group *groups = r->groups.items;
    palp_status status = PALP_OK;
    for (size_t g = 0; g < r->groups.n && !status; g++) {
        void *item = NULL;
        if (groups[g].dim != dim || groups[g].tag != physical)
            continue;
        status = gmsh_append(r, &r->block_groups, sizeof(size_t), &item);
        if (!status)
            *(size_t *)item = find_group_of_same_name(r, groups[g].name);
    }
    return status;
}

/* ---- elements ------------------------------------------------------------------------------------ */

static palp_status read_element_node(gmsh_file *r, int32_t *place) {
    const gmsh_node *nodes = r->nodes.items;
    long long tag = 0;
    palp_status status = gmsh_integer(r, "a node tag", 1, LLONG_MAX, &tag);
    if (status)
        return status;
    size_t low = 0, high = r->nodes.n;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (nodes[middle].tag < tag)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == r->nodes.n || nodes[low].tag != tag)
        return gmsh_fail(r, r->line, "there is no node %lld", tag);
    *place = (int32_t)low;
    return PALP_OK;
}

static palp_status check_repeated_nodes(const gmsh_file *r, int n, const int32_t *place) {
    const gmsh_node *nodes = r->nodes.items;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            if (place[i] == place[j])
                return gmsh_fail(r, r->line, "an element has node %lld twice", nodes[place[i]].tag);
    return PALP_OK;
}

/* Keeps an element: a cell as such and as one of the block's groups, its nodes as members of these. */
static palp_status store_element_and_members(gmsh_file *r, bool is_cell, long long physical, int n,
                                             const int32_t *place) {
    void *item = NULL;
    palp_status status = PALP_OK;
    if (is_cell)
        status = gmsh_append(r, &r->cells, sizeof(gmsh_cell), &item);
    if (is_cell && !status) {
        gmsh_cell *cell = item;
        *cell = (gmsh_cell){{0}, n, r->line, physical, 0};
        memcpy(cell->node, place, (size_t)n * sizeof *place);
    }
    for (size_t g = 0; g < r->block_groups.n && is_cell && !status; g++) {
        status = gmsh_append(r, &r->volumes, sizeof(gmsh_volume), &item);
        if (!status)
            *(gmsh_volume *)item = (gmsh_volume){((size_t *)r->block_groups.items)[g], r->cells.n - 1};
    }
    for (size_t g = 0; g < r->block_groups.n; g++)
        for (int i = 0; i < n && !status; i++) {
            status = gmsh_append(r, &r->members, sizeof(gmsh_member), &item);
            if (!status)
                *(gmsh_member *)item = (gmsh_member){((size_t *)r->block_groups.items)[g], place[i]};
        }
    return status;
}

palp_status gmsh_read_element_nodes(gmsh_file *r, long long type, long long physical) {
    int32_t place[TYPE_NODES_MAX];
    int n = node_count_of_type(type);
    palp_status status = PALP_OK;
    for (int i = 0; i < n && !status; i++)
        status = read_element_node(r, &place[i]);
    if (!status)
        status = gmsh_line_end(r);
    if (!status)
        status = check_repeated_nodes(r, n, place);
    return status ? status : store_element_and_members(r, is_type_of_cells(type), physical, n, place);
}
