/* mesh_gmsh.h: the contents of a Gmsh file, before they become a mesh. */
#ifndef PALP_MESH_GMSH_H
#define PALP_MESH_GMSH_H

#include "base/file.h"

#include <stdint.h>

enum { GMSH_CELL_NODES = 8, GMSH_SECTION_TEXT = 64 };

typedef enum gmsh_version { GMSH_4_1, GMSH_2_2 } gmsh_version;

typedef struct gmsh_group { /* a line of $PhysicalNames */
    long long dim, tag;
    const char *name; /* in the file's text */
} gmsh_group;

typedef struct gmsh_entity { /* a physical group of an entity of $Entities */
    long long dim, tag, physical;
} gmsh_entity;

typedef struct gmsh_node {
    long long tag;
    double x_m[3];
    size_t line;
    int32_t index; /* in the mesh; -1 = not used */
} gmsh_node;

typedef struct gmsh_cell {         /* a tetrahedron or hexahedron */
    int32_t node[GMSH_CELL_NODES]; /* in nodes */
    int n;
    size_t line;
    long long physical; /* version 2.2: tag of its physical group; 0 = none, or 4.1 */
    size_t index;       /* in cells, set in a sorted copy only */
} gmsh_cell;

typedef struct gmsh_member { /* a node in a group */
    size_t group;            /* in groups, the first of its name */
    int32_t node;            /* in nodes */
} gmsh_member;

typedef struct gmsh_volume { /* a cell in a group of volumes */
    size_t group, cell;      /* in groups, in cells */
} gmsh_volume;

/* A growing array of any type; room and n count items. */
typedef struct gmsh_list {
    void *items;
    size_t n, room;
} gmsh_list;

typedef struct gmsh_file {
    const char *path;
    palp_error *error;
    double scale_m;
    char *text, *next, *end;         /* file contents, next line, end of it */
    char *at;                        /* position in the present line */
    size_t line;                     /* its number */
    char section[GMSH_SECTION_TEXT]; /* name with its dollar sign */
    unsigned seen;                   /* bit i: section i of the table */
    gmsh_version version;
    size_t elements_line;
    gmsh_list groups, entities, nodes, cells, members, volumes; /* of the types above */
    gmsh_list block_groups; /* size_t: groups of the present block or line */
} gmsh_file;

/* ERR_INPUT with "path:line: " and the formatted text. */
palp_status gmsh_fail(const gmsh_file *r, size_t line, const char *format, ...) PALP_PRINTF(3, 4);

palp_status gmsh_no_memory(const gmsh_file *r);

/* Adds room for one item of this size, its address in *item. Counts in the file are not trusted: memory grows
 * with what is read. */
palp_status gmsh_append(const gmsh_file *r, gmsh_list *l, size_t size, void **item);

/* Finds the next line that is not blank, without surrounding space. False at the end of the file and on an
 * error there. */
bool gmsh_next(gmsh_file *r);
palp_status gmsh_line(gmsh_file *r);

/* Reads the next token of the line as a number; what names it in an error: "a node tag". */
palp_status gmsh_integer(gmsh_file *r, const char *what, long long low, long long high, long long *value);
palp_status gmsh_count(gmsh_file *r, const char *what, size_t *count); /* 0 to INT32_MAX */
palp_status gmsh_number(gmsh_file *r, const char *what, double *value);
palp_status gmsh_line_end(gmsh_file *r);
void gmsh_skip(gmsh_file *r); /* to the next token */

/* Fails with the error that expected something else than the token at r->at. */
palp_status gmsh_fail_token(const gmsh_file *r, const char *expected);

/* Reads a tag from the present line as that of a new node in nodes. */
palp_status gmsh_read_node_tag(gmsh_file *r);

/* Reads three coordinates from the present line, scaled, as the place of a node. */
palp_status gmsh_read_node_place(gmsh_file *r, gmsh_node *n);

/* Sorts the nodes by tag: tags are found by bisection, and numbering does not depend on the file's order.
 * Fails where a tag is given a second time. */
palp_status gmsh_sort_nodes_by_tag(gmsh_file *r);

/* Fails unless elements of the type are read: cells, and what only defines groups. */
palp_status gmsh_check_element_type(const gmsh_file *r, long long type);
int gmsh_dimension_of_type(long long type); /* of a type that passed this check */

/* Fails with the error that the mesh has partitions. */
palp_status gmsh_refuse_partitions(gmsh_file *r);

/* Adds the named groups with this dimension and tag to block_groups. */
palp_status gmsh_add_groups_of_tag(gmsh_file *r, long long dim, long long physical);

/* Reads the nodes of an element of a checked type to the end of the line; keeps it if it is a cell, and its
 * nodes as members of block_groups. */
palp_status gmsh_read_element_nodes(gmsh_file *r, long long type, long long physical);

/* Read the sections $Nodes and $Elements of version 2.2. */
palp_status gmsh_read_node_lines(gmsh_file *r);
palp_status gmsh_read_element_lines(gmsh_file *r);

/* Reads the file at r->path into the lists; all other fields but error and scale_m must be zero. Nodes are in
 * the order of their tags, without repeats. Cells and members refer to nodes that exist. */
palp_status gmsh_read(gmsh_file *r);

/* Frees what gmsh_read allocated, after a failure too. */
void gmsh_release(gmsh_file *r);

#endif
