/* indentation.h: the force of a tip pressed into an elastic layer, small strain: plate, flat punch, sphere,
 * cone. May change. */
#ifndef PALPATE_INDENTATION_H
#define PALPATE_INDENTATION_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* PLATE covers the whole face of a cylindrical specimen. The others touch a part of the face of a wide
 * layer. */
typedef enum palp_tip_kind { PALP_TIP_PLATE, PALP_TIP_FLAT, PALP_TIP_SPHERE, PALP_TIP_CONE } palp_tip_kind;

/* "plate", "flat", "sphere", "cone"; NULL for another kind. */
PALP_API const char *palp_tip_name(palp_tip_kind kind);
PALP_API bool palp_tip_find(const char *name, palp_tip_kind *kind);

/* A tip on an elastic layer; lengths in m. With all members after poisson zero, the tip slides without
 * friction on a wide bonded layer, at small strain. Other cases are interpolated in tables computed with
 * CalculiX (data/tips), for a bonded layer. ERR_UNSUPPORTED: a sphere or cone that sticks. ERR_LIMIT beyond
 * the tables: a flat punch of 0.2 to 2 thicknesses, a plate of 0.2 to 4 heights, a sphere of at most 4
 * thicknesses, a cone of 70 to 80 degrees. The tables start at a Poisson's ratio of 0.3, go on along their
 * slope to 0.25, and keep that value below it. A sphere of less than 0.3 thicknesses has the factor of large
 * strain of one of 0.3 on the layer that is as much thinner. */
typedef struct palp_indentation {
    palp_tip_kind tip;
    double radius_m;       /* flat punch, sphere: > 0. Plate: of the specimen, > 0 */
    double half_angle_rad; /* cone: between axis and flank, 0 to pi / 2 */
    double thickness_m;    /* of the layer; INFINITY = a half-space (not for a plate) */
    double poisson;        /* -1 < nu <= 0.5 */
    bool floor_slides;     /* the layer slides on its floor; a plate's specimen slides on both faces unless it
                              sticks */
    bool tip_sticks;       /* flat: friction holds its face; plate: the specimen is glued to both plates */
    bool large_strain; /* a neo-Hookean layer; flat: to a depth of 0.2 thicknesses h and 0.25 radii; sphere:
                          to 0.16 R h / (R + 0.1 h), at most 0.4 R; cone: to 0.15 h; a plate stays linear */
    double specimen_radius_m; /* flat, sphere, cone: of the cylinder under it, not below the contact's; 0 =
                                 wide */
} palp_indentation;

/* Force divided by the shear modulus, force_m2[n], at depth_m[n]: times G in Pa it is the force in N. 0 at
 * depths <= 0. Plate: Young's modulus times strain times area. Other tips: the dual integral equations of
 * the contact of a layer (Lebedev and Ufliand 1958; Hayes and others 1972), solved to some 1e-6. Their limit
 * for a thick layer is the half-space (flat 4 G a d / (1 - nu); Hertz; Sneddon). A sphere is a true sphere,
 * not a paraboloid. ERR_ARGUMENT: a number out of its range or not finite; ERR_LIMIT: a contact wider than
 * PALP_INDENTATION_WIDEST thicknesses; ERR_NO_MEMORY. */
PALP_API palp_status palp_indentation_force(const palp_indentation *indentation, size_t n,
                                            const double *depth_m, double *force_m2);

/* Radius of the contact at a depth; a flat punch's and a plate's is their own. Errors likewise. */
PALP_API palp_status palp_indentation_contact(const palp_indentation *indentation, double depth_m,
                                              double *contact_m);

#define PALP_INDENTATION_WIDEST 12.0

#ifdef __cplusplus
}
#endif
#endif
