/* region.h: parts of a mesh that have a material of their own. Stable. */
#ifndef PALPATE_REGION_H
#define PALPATE_REGION_H

#include <palpate/material.h>
#include <palpate/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_REGIONS_MAX = 8, PALP_REGION_NAME_MAX = 64 };

typedef enum palp_region_shape {
    PALP_REGION_OF_MESH, /* the mesh has it: a named group of the volumes of a Gmsh file, or one added before
                          */
    PALP_REGION_BOX,     /* a layer is a box as wide as the mesh */
    PALP_REGION_SPHERE,
    PALP_REGION_MEMBRANE /* a skin without thickness on the surface, with a material of its own alone */
} palp_region_shape;

/* A region of a network or of a network model; a plain value. Where regions overlap, the later one counts. A
 * membrane is added to the tissue below: K of own_material is that of a strip 1 m wide, its modulus times its
 * thickness. Its Poisson's ratio is 1/3. Fibres add to the region's material and work in tension and
 * compression alike: I4 is the square of the stretch along them (the standard reinforcing model). They need a
 * mesh as Poisson's ratio does; arms do not change them. */
typedef struct palp_region {
    char name[PALP_REGION_NAME_MAX];
    palp_region_shape shape;
    double low_m[3], high_m[3];   /* opposite corners of a box */
    double centre_m[3], radius_m; /* of a sphere */
    double stiffness; /* > 0: every force of the network's own material times this; 0: own_material */
    palp_material own_material;     /* PALP_HISTORY only; scaled by the mesh as the network's material is */
    char set[PALP_REGION_NAME_MAX]; /* of a membrane: triangles with all nodes in this set; "" = all */
    double poisson_ratio;           /* as in palp_network_settings; 0 = that of the network */
    double fibre[3];                /* direction of fibres at rest, of any length */
    double fibre_Pa; /* their modulus E, 0 = none: energy E / 8 (I4 - 1)^2 per volume at rest */
} palp_region;

/* Adds a region by its shape; PALP_REGION_OF_MESH, and the set of a membrane, must be there already. Errors
 * of palp_mesh_add_region, with a line in error, which may be NULL. */
PALP_API palp_status palp_region_place_in(palp_mesh *mesh, const palp_region *region, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
