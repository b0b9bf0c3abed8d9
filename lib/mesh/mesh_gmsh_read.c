/* mesh_gmsh_read.c: the sections of a Gmsh MSH 4.1 ASCII file, line by line. */
#include "mesh_gmsh.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the format, groups and entities ------------------------------------------------------------- */

static palp_status read_mesh_format(gmsh_file *r) {
    double version = 0.0;
    long long binary = 0;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_number(r, "a format version", &version);
    if (status)
        return status;
    if (fabs(version - 4.1) > 1e-9)
        return gmsh_fail(r, r->line, "MSH version %g is not supported; save the mesh as version 4.1 ASCII",
                         version);
    status = gmsh_integer(r, "a file type (0 = ASCII)", 0, 1, &binary);
    if (!status && binary)
        return gmsh_fail(r, r->line, "binary files are not supported; save the mesh as version 4.1 ASCII");
    return status;
}

static palp_status read_physical_name(gmsh_file *r) {
    gmsh_group g = {0, 0, NULL};
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_integer(r, "a dimension", 0, 3, &g.dim);
    if (!status)
        status = gmsh_integer(r, "a physical tag", INT32_MIN, INT32_MAX, &g.tag);
    if (status)
        return status;
    gmsh_skip(r);
    char *stop = strrchr(r->at, '"');
    if (*r->at != '"' || stop < r->at + 2 || stop[1])
        return gmsh_fail_token(r, "a name in quotation marks");
    *stop = '\0';
    g.name = r->at + 1;
    void *item;
    status = gmsh_append(r, &r->groups, sizeof g, &item);
    if (!status)
        *(gmsh_group *)item = g;
    return status;
}

static palp_status read_physical_names(gmsh_file *r) {
    size_t count = 0;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_count(r, "a number of names", &count);
    for (size_t i = 0; i < count && !status; i++)
        status = read_physical_name(r);
    return status;
}

/* One entity: its tag, its box (a point: its position) and its physical groups; its boundary is skipped. */
static palp_status read_geometric_entity(gmsh_file *r, long long dim) {
    long long tag = 0, physical = 0;
    double box;
    size_t count = 0;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_integer(r, "an entity tag", INT32_MIN, INT32_MAX, &tag);
    for (int i = 0; i < (dim == 0 ? 3 : 6) && !status; i++)
        status = gmsh_number(r, "a coordinate", &box);
    if (!status)
        status = gmsh_count(r, "a number of physical groups", &count);
    for (size_t i = 0; i < count && !status; i++) {
        void *item = NULL;
        status = gmsh_integer(r, "a physical tag", INT32_MIN, INT32_MAX, &physical);
        if (!status)
            status = gmsh_append(r, &r->entities, sizeof(gmsh_entity), &item);
        if (!status) /* a negative tag means reversed orientation */
            *(gmsh_entity *)item = (gmsh_entity){dim, tag, physical < 0 ? -physical : physical};
    }
    return status;
}

static palp_status read_geometric_entities(gmsh_file *r) {
    size_t count[4] = {0, 0, 0, 0};
    palp_status status = gmsh_line(r);
    for (int dim = 0; dim < 4 && !status; dim++)
        status = gmsh_count(r, "a number of entities", &count[dim]);
    for (int dim = 0; dim < 4 && !status; dim++)
        for (size_t i = 0; i < count[dim] && !status; i++)
            status = read_geometric_entity(r, dim);
    return status;
}

/* The line "blocks total lowest-tag highest-tag" of $Nodes and $Elements. */
static palp_status read_section_totals(gmsh_file *r, size_t *blocks, size_t *total) {
    long long tag;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_count(r, "a number of blocks", blocks);
    if (!status)
        status = gmsh_count(r, "a total number", total);
    for (int i = 0; i < 2 && !status; i++)
        status = gmsh_integer(r, "a lowest or highest tag", 0, LLONG_MAX, &tag);
    return status ? status : gmsh_line_end(r);
}

/* The line "dimension entity third count" of a block. */
static palp_status read_block_header(gmsh_file *r, gmsh_entity *of, const char *what, long long third_max,
                                     long long *third, size_t *count) {
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_integer(r, "a dimension", 0, 3, &of->dim);
    if (!status)
        status = gmsh_integer(r, "an entity tag", INT32_MIN, INT32_MAX, &of->tag);
    if (!status)
        status = gmsh_integer(r, what, 0, third_max, third);
    if (!status)
        status = gmsh_count(r, "a number in the block", count);
    return status ? status : gmsh_line_end(r);
}

static palp_status read_node_tag_line(gmsh_file *r) {
    long long tag = 0;
    void *item = NULL;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_integer(r, "a node tag", 1, LLONG_MAX, &tag);
    if (!status)
        status = gmsh_line_end(r);
    if (!status)
        status = gmsh_append(r, &r->nodes, sizeof(gmsh_node), &item);
    if (!status)
        *(gmsh_node *)item = (gmsh_node){tag, {0.0, 0.0, 0.0}, r->line, -1};
    return status;
}

static palp_status read_node_place(gmsh_file *r, bool parametric, gmsh_node *n) {
    palp_status status = gmsh_line(r);
    for (int axis = 0; axis < 3 && !status; axis++) {
        status = gmsh_number(r, "a coordinate", &n->x_m[axis]);
        n->x_m[axis] *= r->scale_m;
        if (!status && !isfinite(n->x_m[axis]))
            status = gmsh_fail(r, r->line, "a coordinate is out of range");
    }
    return status || parametric ? status : gmsh_line_end(r);
}

static palp_status read_node_block(gmsh_file *r, size_t total) {
    gmsh_entity of = {0, 0, 0};
    long long parametric = 0;
    size_t count = 0, first = r->nodes.n;
    palp_status status = read_block_header(r, &of, "a parametric flag (0 or 1)", 1, &parametric, &count);
    if (!status && count > total - first)
        return gmsh_fail(r, r->line, "more nodes than the %zu that $Nodes announces", total);
    for (size_t i = 0; i < count && !status; i++)
        status = read_node_tag_line(r);
    for (size_t i = 0; i < count && !status; i++)
        status = read_node_place(r, parametric != 0, (gmsh_node *)r->nodes.items + first + i);
    return status;
}

static int compare_node_tags(const void *left, const void *right) {
    const gmsh_node *a = left, *b = right;
    if (a->tag != b->tag)
        return a->tag < b->tag ? -1 : 1;
    return (a->line > b->line) - (a->line < b->line);
}

/* Sorts the nodes by tag: tags are found by bisection, and numbering does not depend on blocks. */
static palp_status sort_nodes_by_tag(gmsh_file *r) {
    gmsh_node *nodes = r->nodes.items;
    const gmsh_node *again = NULL;
    if (r->nodes.n > 0)
        qsort(nodes, r->nodes.n, sizeof *nodes, compare_node_tags);
    for (size_t i = 1; i < r->nodes.n; i++)
        if (nodes[i].tag == nodes[i - 1].tag && (!again || nodes[i].line < again->line))
            again = &nodes[i];
    return again ? gmsh_fail(r, again->line, "node tag %lld is given a second time", again->tag) : PALP_OK;
}

static palp_status read_nodes_section(gmsh_file *r) {
    size_t blocks = 0, total = 0;
    palp_status status = read_section_totals(r, &blocks, &total);
    for (size_t i = 0; i < blocks && !status; i++)
        status = read_node_block(r, total);
    if (!status && r->nodes.n < total)
        return gmsh_fail(r, r->line, "%zu nodes, but $Nodes announces %zu", r->nodes.n, total);
    return status ? status : sort_nodes_by_tag(r);
}

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

/* The first group of the same name: one node set for all dimensions. */
static size_t find_group_of_same_name(const gmsh_file *r, const char *name) {
    const gmsh_group *groups = r->groups.items;
    size_t i = 0;
    while (strcmp(groups[i].name, name) != 0)
        i++;
    return i;
}

/* Lists the named groups of an entity in block_groups. */
static palp_status find_groups_of_entity(gmsh_file *r, const gmsh_entity *of) {
    const gmsh_group *groups = r->groups.items;
    const gmsh_entity *entities = r->entities.items;
    palp_status status = PALP_OK;
    r->block_groups.n = 0;
    for (size_t e = 0; e < r->entities.n; e++)
        for (size_t g = 0; g < r->groups.n && !status; g++) {
            void *item = NULL;
            if (entities[e].dim != of->dim || entities[e].tag != of->tag || groups[g].dim != of->dim ||
                groups[g].tag != entities[e].physical)
                continue;
            status = gmsh_append(r, &r->block_groups, sizeof(size_t), &item);
            if (!status)
                *(size_t *)item = find_group_of_same_name(r, groups[g].name);
        }
    return status;
}

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
static palp_status store_element_and_members(gmsh_file *r, bool is_cell, int n, const int32_t *place) {
    void *item = NULL;
    palp_status status = PALP_OK;
    if (is_cell)
        status = gmsh_append(r, &r->cells, sizeof(gmsh_cell), &item);
    if (is_cell && !status) {
        gmsh_cell *cell = item;
        *cell = (gmsh_cell){{0}, n, r->line};
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

static palp_status read_element_line(gmsh_file *r, bool is_cell, int n) {
    long long tag;
    int32_t place[TYPE_NODES_MAX];
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_integer(r, "an element tag", 0, LLONG_MAX, &tag);
    for (int i = 0; i < n && !status; i++)
        status = read_element_node(r, &place[i]);
    if (!status)
        status = gmsh_line_end(r);
    if (!status)
        status = check_repeated_nodes(r, n, place);
    return status ? status : store_element_and_members(r, is_cell, n, place);
}

static palp_status read_element_block(gmsh_file *r, size_t *left) {
    gmsh_entity of = {0, 0, 0};
    long long type = 0;
    size_t count = 0;
    palp_status status = read_block_header(r, &of, "an element type", INT32_MAX, &type, &count);
    if (status)
        return status;
    int n = node_count_of_type(type);
    if (n == 0)
        return gmsh_fail(r, r->line,
                         "elements of type %lld are not supported; mesh the volume with 4-node tetrahedra "
                         "(type 4) or 8-node hexahedra (type 5)",
                         type);
    if (count > *left)
        return gmsh_fail(r, r->line, "more elements than $Elements announces");
    *left -= count;
    status = find_groups_of_entity(r, &of);
    for (size_t i = 0; i < count && !status; i++)
        status = read_element_line(r, type == 4 || type == 5, n);
    return status;
}

static palp_status read_elements_section(gmsh_file *r) {
    size_t blocks = 0, left = 0;
    r->elements_line = r->line;
    palp_status status = read_section_totals(r, &blocks, &left);
    for (size_t i = 0; i < blocks && !status; i++)
        status = read_element_block(r, &left);
    if (!status && left > 0)
        return gmsh_fail(r, r->line, "%zu elements fewer than $Elements announces", left);
    return status;
}

static palp_status refuse_partitions(gmsh_file *r) {
    return gmsh_fail(r, r->line, "partitioned meshes are not supported; save it in one part");
}

typedef struct section {
    const char *name;
    palp_status (*read)(gmsh_file *r);
} section;

enum { FORMAT, GROUPS, ENTITIES, PARTITIONS, NODES, ELEMENTS, SECTIONS };

static const section sections[SECTIONS] = {
    {"$MeshFormat", read_mesh_format},      {"$PhysicalNames", read_physical_names},
    {"$Entities", read_geometric_entities}, {"$PartitionedEntities", refuse_partitions},
    {"$Nodes", read_nodes_section},         {"$Elements", read_elements_section},
};

static bool is_section_end_line(const gmsh_file *r) {
    return strncmp(r->at, "$End", 4) == 0 && strcmp(r->at + 4, r->section + 1) == 0;
}

/* The line that ends a section; the lines of an unknown section are skipped. */
static palp_status read_section_end(gmsh_file *r, bool known) {
    palp_status status = gmsh_line(r);
    while (!status && !is_section_end_line(r) && !known)
        status = gmsh_line(r);
    if (!status && !is_section_end_line(r))
        return gmsh_fail(r, r->line, "$End%s is expected, not '%.40s'", r->section + 1, r->at);
    return status;
}

static palp_status check_section_order(const gmsh_file *r, int i) {
    if (i != FORMAT && !(r->seen & 1u << FORMAT))
        return gmsh_fail(r, r->line, "$MeshFormat is expected before %s", sections[i].name);
    if (r->seen & 1u << i)
        return gmsh_fail(r, r->line, "%s is given a second time", sections[i].name);
    if (r->seen & 1u << ELEMENTS)
        return gmsh_fail(r, r->line, "%s is expected before $Elements", sections[i].name);
    if (i == ELEMENTS && !(r->seen & 1u << NODES))
        return gmsh_fail(r, r->line, "$Nodes is expected before $Elements");
    return PALP_OK;
}

static palp_status read_one_section(gmsh_file *r) {
    int i = 0;
    if (r->at[0] != '$' || strlen(r->at) >= sizeof r->section)
        return gmsh_fail(r, r->line, "a section such as $Nodes is expected, not '%.40s'", r->at);
    strcpy(r->section, r->at);
    while (i < SECTIONS && strcmp(sections[i].name, r->section) != 0)
        i++;
    if (i == SECTIONS)
        return read_section_end(r, false);
    palp_status status = check_section_order(r, i);
    r->seen |= 1u << i;
    if (!status)
        status = sections[i].read(r);
    return status ? status : read_section_end(r, true);
}

/* A NUL would be taken for the end of a line. */
static void replace_nul_characters(char *text, size_t size) {
    for (char *nul = memchr(text, '\0', size); nul; nul = memchr(nul, '\0', size - (size_t)(nul - text)))
        *nul = '?';
}

palp_status gmsh_read(gmsh_file *r) {
    size_t size = 0;
    palp_status status = palp_file_read(r->path, &r->text, &size, r->error);
    if (status)
        return status;
    replace_nul_characters(r->text, size);
    r->next = r->text;
    r->end = r->text + size;
    while (!status && gmsh_next(r))
        status = read_one_section(r);
    for (int i = FORMAT; i < SECTIONS && !status; i++)
        if ((i == FORMAT || i >= NODES) && !(r->seen & 1u << i))
            status = gmsh_fail(r, r->line, "the file ends without %s", sections[i].name);
    return status;
}

void gmsh_release(gmsh_file *r) {
    free(r->text);
    free(r->groups.items);
    free(r->entities.items);
    free(r->nodes.items);
    free(r->cells.items);
    free(r->members.items);
    free(r->volumes.items);
    free(r->block_groups.items);
}
