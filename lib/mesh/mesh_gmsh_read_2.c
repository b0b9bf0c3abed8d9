/* mesh_gmsh_read_2.c: the nodes and elements of a Gmsh MSH 2.2 ASCII file, each in a line of its own. */
#include "mesh_gmsh.h"

#include <limits.h>

/* Reads the number of items in a section, then each of them with read from its line. */
static palp_status read_counted_lines(gmsh_file *r, const char *items, palp_status (*read)(gmsh_file *r)) {
    size_t count = 0;
    palp_status status = gmsh_line(r);
    if (!status)
        status = gmsh_count(r, "a total number", &count);
    if (!status)
        status = gmsh_line_end(r);
    for (size_t i = 0; i < count && !status; i++) {
        status = gmsh_line(r);
        if (!status && *r->at == '$')
            status = gmsh_fail(r, r->line, "%zu %s, but %s announces %zu", i, items, r->section, count);
        if (!status)
            status = read(r);
    }
    return status;
}

/* The line "tag x y z". */
static palp_status read_node_line(gmsh_file *r) {
    palp_status status = gmsh_read_node_tag(r);
    if (!status)
        status = gmsh_read_node_place(r, (gmsh_node *)r->nodes.items + r->nodes.n - 1);
    return status ? status : gmsh_line_end(r);
}

palp_status gmsh_read_node_lines(gmsh_file *r) {
    palp_status status = read_counted_lines(r, "nodes", read_node_line);
    return status ? status : gmsh_sort_nodes_by_tag(r);
}

/* Reads the number of tags and these: the physical group, the entity, the number of partitions and more. */
static palp_status read_element_tags(gmsh_file *r, long long *physical) {
    size_t count = 0;
    palp_status status = gmsh_count(r, "a number of tags", &count);
    *physical = 0;
    for (size_t i = 0; i < count && !status; i++) {
        long long tag = 0;
        status = gmsh_integer(r, i == 0 ? "a physical tag" : "a tag", INT32_MIN, INT32_MAX, &tag);
        if (i == 0) /* a negative tag means reversed orientation */
            *physical = tag < 0 ? -tag : tag;
        if (i == 2 && tag > 0)
            status = gmsh_refuse_partitions(r);
    }
    return status;
}

/* The line "tag type tags... nodes...". Its groups take the place of a block's; tag 0 is no group. */
static palp_status read_typed_element_line(gmsh_file *r) {
    long long tag, type = 0, physical = 0;
    palp_status status = gmsh_integer(r, "an element tag", 0, LLONG_MAX, &tag);
    if (!status)
        status = gmsh_integer(r, "an element type", 0, INT32_MAX, &type);
    if (!status)
        status = gmsh_check_element_type(r, type);
    if (!status)
        status = read_element_tags(r, &physical);
    r->block_groups.n = 0;
    if (!status && physical != 0)
        status = gmsh_add_groups_of_tag(r, gmsh_dimension_of_type(type), physical);
    return status ? status : gmsh_read_element_nodes(r, type, physical);
}

palp_status gmsh_read_element_lines(gmsh_file *r) {
    r->elements_line = r->line;
    return read_counted_lines(r, "elements", read_typed_element_line);
}
