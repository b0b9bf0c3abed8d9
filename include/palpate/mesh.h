/* mesh.h: particles, the elements between them, and named sets of particles. Stable. */
#ifndef PALPATE_MESH_H
#define PALPATE_MESH_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Limits: at least two nodes and one element, at most INT32_MAX nodes, which a lattice refuses with
 * ERR_ARGUMENT; at most INT32_MAX / 4 tetrahedra (ERR_LIMIT). A network is limited earlier, by the entries of
 * its tangent and of the factor, which have 32-bit indices (ERR_LIMIT of palp_network_create). A mesh is one
 * connected part unless it was joined (palp_mesh_join); no pair of nodes has two elements. Tetrahedra that
 * overlap without being the same one are not refused. */
typedef struct palp_mesh palp_mesh; /* owns its arrays; free with palp_mesh_free */

/* Neighbourhood of a lattice node: the faces; faces and edges; faces, edges and corners (Moore). */
typedef enum palp_neighbourhood {
    PALP_NEIGHBOURS_6 = 6,
    PALP_NEIGHBOURS_18 = 18,
    PALP_NEIGHBOURS_26 = 26
} palp_neighbourhood;

/* A box lattice of nodes[0] x nodes[1] x nodes[2] particles (each >= 2) filling size_m[3], one
 * corner at the origin; y (axis 1) is the direction of compression. Particle (i, j, k) has index
 * (i * nodes[1] + j) * nodes[2] + k: x slowest, z fastest. An element on every pair of neighbours,
 * once. Sets: "bottom" (y = 0), "top" (y = size), "left"/"right" (x), "back"/"front" (z).
 * The caller owns *mesh. */
PALP_API palp_status palp_mesh_lattice(const size_t nodes[3], const double size_m[3],
                                       palp_neighbourhood neighbourhood, palp_mesh **mesh);

/* A mesh from arrays: x_m[3 n_nodes], pairs[2 n_elements] (node indices). Copies; makes no sets. error may
 * be NULL. ERR_INPUT with a line in error for an index out of range or a pair given twice; for a node without
 * an element or more than one connected part; also for an element shorter than 1e-12 of the mesh's size. */
PALP_API palp_status palp_mesh_create(size_t n_nodes, const double *x_m, size_t n_elements,
                                      const int32_t *pairs, palp_mesh **mesh, palp_error *error);

/* Reads a Gmsh 2.2 or 4.1 ASCII file: tetrahedra (type 4) and hexahedra (type 5). Both versions of a mesh
 * give the same: in 2.2 a cell may be given once for each of its groups. Edges become elements, each once;
 * with hex_diagonals the face and space diagonals of hexahedra too. scale_m is the length of the file's unit
 * in metres (0.001 for millimetres). Named physical groups become node sets. If none is called "bottom" or
 * "top", these are the nodes within 1e-6 of the height from the lowest and the highest y. Nodes that no
 * tetrahedron or hexahedron uses are left out, and a group of such nodes makes no set. The other nodes are
 * numbered in the order of their tags. ERR_INPUT with "file:line: ..." for: anything malformed; a missing or
 * repeated node; a node twice in an element; an element given twice or of zero length; a flat tetrahedron;
 * more than one connected part; volume elements of other types; a partitioned or binary file; another
 * version. */
PALP_API palp_status palp_mesh_read_gmsh(const char *path, double scale_m, bool hex_diagonals,
                                         palp_mesh **mesh, palp_error *error);

PALP_API void palp_mesh_free(palp_mesh *mesh); /* NULL is allowed */

PALP_API size_t palp_mesh_node_count(const palp_mesh *mesh);
PALP_API size_t palp_mesh_element_count(const palp_mesh *mesh);
PALP_API const double *palp_mesh_positions(const palp_mesh *mesh); /* [3 n_nodes], m, at rest; the mesh's */

/* [2 n_elements], the two nodes of each element; the mesh's. */
PALP_API const int32_t *palp_mesh_pairs(const palp_mesh *mesh);

/* Tetrahedra that fill the mesh, four nodes each, positive volume; mesh's. A lattice's boxes are six each,
 * with edges between Moore neighbours; a Gmsh file's hexahedra likewise. 0 for a mesh from arrays. */
PALP_API size_t palp_mesh_tetrahedron_count(const palp_mesh *mesh);
PALP_API const int32_t *palp_mesh_tetrahedra(const palp_mesh *mesh);

/* Triangles of the surface, three nodes each, outward; mesh's. 0 where there are no tetrahedra. */
PALP_API size_t palp_mesh_triangle_count(const palp_mesh *mesh);
PALP_API const int32_t *palp_mesh_triangles(const palp_mesh *mesh);

/* How a solid's stiffness is divided among the elements of a mesh. An element's force has a factor s,
 * F = s (K(|e|) e + sum q). K / area is then the modulus of the solid (Poisson's ratio 1/4) at small strain,
 * whatever the mesh. */
typedef enum palp_mesh_scaling {
    PALP_SCALING_NONE,   /* all factors 1: what K means depends on the mesh */
    PALP_SCALING_VOLUME, /* s = V / (L area), V the volume of the tetrahedra around the edge (Van Gelder 1998)
                          */
    PALP_SCALING_CONTINUUM /* Tetrahedra have elements across the faces too, between the corners opposite a
                              face that two tetrahedra share. The factors are fitted to the nodal forces of
                              the evenly strained solid, none below a fifth of its part by volume
                              (doc/meshes.md). Each hexahedron, as those of a lattice, gives its elements
                              what makes it isotropic (doc/numerics.md). */
} palp_mesh_scaling;

/* Scales the elements, once. area_m2 = 0: the mesh's volume over its height (y). ERR_UNSUPPORTED for a mesh
 * of both cells and for hexahedra by volume; also if an edge of a tetrahedron or a diagonal of a hexahedron
 * is no element. ERR_INPUT for an element with nothing but flat tetrahedra or a hexahedron of no volume
 * around it; ERR_ARGUMENT if scaled before. After ERR_INPUT or ERR_NO_MEMORY the mesh is good for
 * palp_mesh_free only. */
PALP_API palp_status palp_mesh_scale(palp_mesh *mesh, palp_mesh_scaling scaling, double area_m2,
                                     palp_error *error);

/* [n_elements], or NULL = all 1; mesh's. */
PALP_API const double *palp_mesh_element_scale(const palp_mesh *mesh);

/* Adds (or replaces) the node set called name; it is kept in ascending order, each node once.
 * ERR_ARGUMENT: an index out of range, no name. */
PALP_API palp_status palp_mesh_add_set(palp_mesh *mesh, const char *name, size_t n, const int32_t *nodes);

/* Adds the set of the nodes within tolerance_m of the plane axis = value_m (axis 0, 1, 2 = x, y, z).
 * ERR_INPUT if there are none. */
PALP_API palp_status palp_mesh_add_plane_set(palp_mesh *mesh, const char *name, int axis, double value_m,
                                             double tolerance_m);

/* The nodes of a set; *nodes is the mesh's. ERR_INPUT if there is no such set. */
PALP_API palp_status palp_mesh_set(const palp_mesh *mesh, const char *name, size_t *n, const int32_t **nodes);

/* Part of the tissue at x_m that belongs to a region, from 0 to 1; values beyond count as these. */
typedef double palp_mesh_place(void *user, const double x_m[3]);

/* Adds (or replaces) the region called name: the part of each tetrahedron in it is a mean over 216 places.
 * ERR_ARGUMENT: no name; ERR_INPUT: no part of the mesh is in it; ERR_UNSUPPORTED: the mesh has no
 * tetrahedra. A Gmsh file has a region for each named group of volumes. */
PALP_API palp_status palp_mesh_add_region(palp_mesh *mesh, const char *name, palp_mesh_place *place,
                                          void *user);

/* The part of each tetrahedron that is in a region, [palp_mesh_tetrahedron_count]; *part is the mesh's.
 * ERR_INPUT if there is no such region. */
PALP_API palp_status palp_mesh_region(const palp_mesh *mesh, const char *name, const double **part);

/* Places the mesh: x = rotation x + translation_m, rotation[9] by rows. ERR_ARGUMENT: a number that is not
 * finite, a matrix that is no rotation within 1e-9. */
PALP_API palp_status palp_mesh_transform(palp_mesh *mesh, const double rotation[9],
                                         const double translation_m[3]);

/* Two meshes as separate parts of a new one, which the caller owns: tissues that may touch each other
 * (palp_contact_settings) or be tied (palpate/tie.h). Nodes, elements, tetrahedra and triangles of the second
 * follow those of the first, as the meshes are placed and scaled. Sets and regions of the second are called
 * "name.set" and "name.region"; all of it is the set, and where it has tetrahedra the region, called name.
 * ERR_INPUT: the first has a set or region of that name; ERR_LIMIT: too large; ERR_NO_MEMORY. */
PALP_API palp_status palp_mesh_join(const palp_mesh *first, const palp_mesh *second, const char *name,
                                    palp_mesh **joined);

/* Lowest and highest rest coordinate, m. */
PALP_API void palp_mesh_bounds(const palp_mesh *mesh, double low_m[3], double high_m[3]);

#ifdef __cplusplus
}
#endif
#endif
