/* mesh_internal.h: the data of a mesh, and functions shared by its constructors. */
#ifndef PALP_MESH_INTERNAL_H
#define PALP_MESH_INTERNAL_H

#include "base/arena.h"

#include <palpate/mesh.h>

typedef struct node_set {
    char *name;
    size_t n;
    int32_t *nodes; /* [n], ascending, each once */
} node_set;

/* Volumes with a name. */
typedef struct mesh_region {
    char *name;
    double *part; /* [n_tetrahedra] of each that belongs to it, 0 to 1 */
} mesh_region;

struct palp_mesh {
    arena memory; /* of all arrays but pairs, sets and regions, whose sizes may change */
    size_t n_nodes;
    size_t n_elements;
    double *x_m;    /* [3 n_nodes] */
    int32_t *pairs; /* [2 n_elements] */
    size_t *order;  /* [n_elements] elements by lower, then higher node, or NULL: they stand so */
    size_t n_tetrahedra, n_triangles, n_hexahedra;
    int32_t *tetrahedra, *triangles; /* [4 n_tetrahedra], [3 n_triangles], or NULL */
    int32_t *hexahedra; /* [8 n_hexahedra] in Gmsh's order, or NULL; each is six tetrahedra too, to whose
                           parts its symmetry does not keep */
    double *scale;      /* [n_elements] factor of each element's force, or NULL = all 1 */
    size_t n_sets, n_regions;
    node_set *sets;       /* [n_sets] */
    mesh_region *regions; /* [n_regions] */
};

/* A mesh with arrays of this size, not initialised, and no sets. */
palp_status mesh_new(size_t n_nodes, size_t n_elements, palp_mesh **mesh);

/* A copy with arrays of its own. */
palp_status mesh_copy(const palp_mesh *mesh, palp_mesh **copy);

/* Appends a tetrahedron or hexahedron of n nodes (Gmsh's order) to mesh->tetrahedra and mesh->hexahedra,
 * where the caller made room. */
void mesh_split_cell(palp_mesh *mesh, int n, const int32_t *node);

/* Makes the triangles from the tetrahedra. */
palp_status mesh_add_surface(palp_mesh *mesh);

/* neighbour[4 n_tetrahedra]: tetrahedron across face f, opposite corner f; -1 = surface. */
palp_status mesh_neighbours(const palp_mesh *mesh, int32_t *neighbour);

/* Six times the volume of a tetrahedron of nodes at x. */
double mesh_volume6(const double *x, const int32_t tetrahedron[4]);

/* Volume of the tetrahedra, m^3; node_m3[n_nodes], unless NULL, gets a quarter of each for its corners. */
double mesh_volume(const palp_mesh *mesh, double *node_m3);

/* Nodes of face f of a tetrahedron, in outward orientation. */
void mesh_face(const int32_t tetrahedron[4], size_t f, int32_t triangle[3]);

/* Orders node numbers, for qsort. */
int mesh_compare_nodes(const void *left, const void *right);

/* Sorts n_pairs pairs by lower then higher node, lower first in each, and removes repeats; returns the number
 * that remain. */
size_t mesh_pairs_unique(size_t n_pairs, int32_t *pairs);

/* Is the element from a to b long enough in a mesh whose box has the diagonal size_m? Below 1e-12 of it the
 * direction is rounding. False too where a number overflows. */
bool mesh_length_ok(const double a[3], const double b[3], double size_m);

/* The diagonal of the box around n_nodes points x_m[3 n_nodes]. */
double mesh_diagonal(size_t n_nodes, const double *x_m);

/* The element between two nodes, or n_elements. The mesh's elements must be sorted or have an order, as those
 * of lattices and files. */
size_t palp_mesh_element_between(const palp_mesh *mesh, int32_t a, int32_t b);

/* Number of connected parts; root[n_nodes] is the lowest node of each node's part. Only elements with
 * alive[e] != 0 connect nodes; NULL = all. */
size_t mesh_parts(size_t n_nodes, size_t n_elements, const int32_t *pairs, const unsigned char *alive,
                  int32_t *root);

/* Number of connected parts, and the lowest node not connected with node 0, or n_nodes. ERR_NO_MEMORY. */
palp_status mesh_part_away(const palp_mesh *mesh, size_t *parts, size_t *away);

/* Unit vector along the element between two nodes; returns its length. */
double mesh_direction(const palp_mesh *mesh, const int32_t pair[2], double n[3]);

/* Nodes opposite face f of tetrahedron i and of its neighbour there (mesh_neighbours); false where there is
 * no neighbour, at a face that was seen from the other side, or where they are too close for an element. */
bool mesh_nodes_across_face(const palp_mesh *mesh, const int32_t *neighbour, size_t i, size_t f,
                            int32_t pair[2]);

/* Adds (or replaces) a region of which each tetrahedron has this part. */
palp_status mesh_take_region(palp_mesh *mesh, const char *name, const double *part);

/* Corner c of a hexahedron, at x = c & 1, y = c >> 1 & 1, z = c >> 2, is this one in the order of a file. */
extern const unsigned char mesh_gmsh_corner[8];

/* Does the mesh consist of hexahedra alone? Their six tetrahedra follow those of the one before. */
bool mesh_is_all_hexahedra(const palp_mesh *mesh);

/* The solids of a mesh: its hexahedra where these are all, otherwise its tetrahedra. */
size_t mesh_solids(const palp_mesh *mesh, size_t *corners, const int32_t **nodes);

/* The part of each solid in a region, and its volume, m^3, from those of its tetrahedra. volume may be NULL.
 */
void mesh_parts_of_solids(const palp_mesh *mesh, const double *part, double *of_solid, double *volume);

/* Each of n springs in turn takes the factor, none below its least, by which least is missing of the wanted
 * stiffness. tensor[components n]: of each spring with factor 1; count: how often each component occurs. The
 * squares of a spring's tensor add up to those of its length. */
void mesh_sweep_factors(size_t n, size_t components, const double *count, const double *tensor,
                        const double *length, const double *least, double *factor, double *missing);

/* Widths of strips, m, into width[n_elements]. Springs along the edges of the surface, as stiff as strips of
 * these widths, are an isotropic membrane (Poisson's ratio 1/3). It covers the triangles whose nodes are all
 * listed[n_nodes]; NULL: all triangles. Exact for rectangles with both diagonals, by least squares for
 * triangles. */
palp_status mesh_membrane_widths(const palp_mesh *mesh, const unsigned char *listed, double *width);

/* Mean by volume over the solids that have both nodes of an element, or are beside the face that it crosses,
 * into of_element[n_elements]; 0 where there is none. */
palp_status mesh_mean_around_elements(const palp_mesh *mesh, const double *of_solid, double *of_element);

/* The part of a mesh that belongs to one owner: its nodes, and the elements and solids (mesh_solids) whose
 * first node is one of these, with all their nodes; no regions. With surface, all triangles with their nodes.
 * All stay in order. (*node)[part's n_nodes], (*element)[part's n_elements] and (*solid)[its solids] are
 * their numbers in the mesh, malloc'ed, for the caller to free. */
palp_status mesh_part(const palp_mesh *mesh, const int32_t *owner_of_node, int32_t owner, bool surface,
                      palp_mesh **part, int32_t **node, int32_t **element, int32_t **solid);

/* Does the mesh consist of hexahedra alone, with elements along all their edges and diagonals? */
bool mesh_has_cells(const palp_mesh *mesh);

/* Adds to mesh->scale, which is zero, what each hexahedron gives to its elements. ERR_INPUT: one has no
 * volume. */
palp_status mesh_scale_cells(palp_mesh *mesh, double area_m2, palp_error *error);

#endif
