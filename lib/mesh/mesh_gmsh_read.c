/* mesh_gmsh_read.c: the sections of a Gmsh ASCII file, line by line, with the entities and blocks of 4.1. */
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
    r->version = fabs(version - 2.2) > 1e-9 ? GMSH_4_1 : GMSH_2_2;
    if (r->version == GMSH_4_1 && fabs(version - 4.1) > 1e-9)
        return gmsh_fail(r, r->line,
                         "MSH version %g is not supported; save the mesh as version 2.2 or 4.1 ASCII",
                         version);
    status = gmsh_integer(r, "a file type (0 = ASCII)", 0, 1, &binary);
    if (!status && binary)
        return gmsh_fail(r, r->line,
                         "binary files are not supported; save the mesh as version 2.2 or 4.1 ASCII");
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
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_read_node_tag(r);
    return status ? status : gmsh_line_end(r);
}

static palp_status read_node_place_line(gmsh_file *r, bool parametric, gmsh_node *n) {
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_read_node_place(r, n);
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
        status = read_node_place_line(r, parametric != 0, (gmsh_node *)r->nodes.items + first + i);
    return status;
}

static palp_status read_nodes_section(gmsh_file *r) {
    size_t blocks = 0, total = 0;
    palp_status status = read_section_totals(r, &blocks, &total);
    for (size_t i = 0; i < blocks && !status; i++)
        status = read_node_block(r, total);
    if (!status && r->nodes.n < total)
        return gmsh_fail(r, r->line, "%zu nodes, but $Nodes announces %zu", r->nodes.n, total);
    return status ? status : gmsh_sort_nodes_by_tag(r);
}

/* Lists the named groups of an entity in block_groups. */
static palp_status find_groups_of_entity(gmsh_file *r, const gmsh_entity *of) {
    const gmsh_entity *entities = r->entities.items;
    palp_status status = PALP_OK;
    r->block_groups.n = 0;
    for (size_t e = 0; e < r->entities.n && !status; e++)
        if (entities[e].dim == of->dim && entities[e].tag == of->tag)
            status = gmsh_add_groups_of_tag(r, of->dim, entities[e].physical);
    return status;
}

static palp_status read_element_line(gmsh_file *r, long long type) {
    long long tag;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_integer(r, "an element tag", 0, LLONG_MAX, &tag);
    return status ? status : gmsh_read_element_nodes(r, type, 0);
}

static palp_status read_element_block(gmsh_file *r, size_t *left) {
    gmsh_entity of = {0, 0, 0};
    long long type = 0;
    size_t count = 0;
    palp_status status = read_block_header(r, &of, "an element type", INT32_MAX, &type, &count);
    if (!status)
        status = gmsh_check_element_type(r, type);
    if (status)
        return status;
    if (count > *left)
        return gmsh_fail(r, r->line, "more elements than $Elements announces");
    *left -= count;
    status = find_groups_of_entity(r, &of);
    for (size_t i = 0; i < count && !status; i++)
        status = read_element_line(r, type);
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

/* ---- the sections of a file ---------------------------------------------------------------------- */

typedef struct section {
    const char *name;
    palp_status (*read[2])(gmsh_file *r); /* by version, NULL where it has no such section */
} section;

enum { FORMAT, GROUPS, ENTITIES, PARTITIONS, NODES, ELEMENTS, SECTIONS };

static const section sections[SECTIONS] = {
    {"$MeshFormat", {read_mesh_format, read_mesh_format}},
    {"$PhysicalNames", {read_physical_names, read_physical_names}},
    {"$Entities", {read_geometric_entities, NULL}},
    {"$PartitionedEntities", {gmsh_refuse_partitions, NULL}},
    {"$Nodes", {read_nodes_section, gmsh_read_node_lines}},
    {"$Elements", {read_elements_section, gmsh_read_element_lines}},
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
    if (i == SECTIONS || !sections[i].read[r->version])
        return read_section_end(r, false);
    palp_status status = check_section_order(r, i);
    r->seen |= 1u << i;
    if (!status)
        status = sections[i].read[r->version](r);
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
