/* network.h: a network of generalized Maxwell solids between particles, and its time stepping. Stable. */
#ifndef PALPATE_NETWORK_H
#define PALPATE_NETWORK_H

#include <palpate/material.h>
#include <palpate/mesh.h>
#include <palpate/model.h>
#include <palpate/path.h>
#include <palpate/region.h>
#include <palpate/solver.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_network palp_network; /* opaque; palp_network_free */

/* Motion of an axis of a node set. A driven axis moves by depth times the support's motion. */
typedef enum palp_axis { PALP_FREE, PALP_FIXED, PALP_DRIVEN } palp_axis;

typedef struct palp_support {
    const char *set;   /* node set of the mesh */
    palp_axis axis[3]; /* x, y, z */
    double motion[3];  /* displacement per unit depth of the driven axes */
} palp_support;

/* Which equilibrium to follow where the network can buckle. CONTINUE: the branch that Newton's method follows
 * from the last step, stable or not. With tools or grasped nodes an unstable branch is left as with STABLE.
 * STABLE: descend in energy to a stable equilibrium. */
typedef enum palp_branch { PALP_BRANCH_CONTINUE, PALP_BRANCH_STABLE } palp_branch;

typedef enum palp_integrator {
    PALP_BACKWARD_EULER,
    PALP_GENERALIZED_ALPHA /* Chung and Hulbert 1993, spectral_radius at infinity */
} palp_integrator;

typedef struct palp_network_settings {
    double tolerance;   /* |residual|_2 <= tolerance |element forces|_2 */
    int max_iterations; /* Newton iterations a step */
    palp_branch branch;
    palp_solver solver;
    double density_kg_m3; /* 0 = massless (quasi-static). A quarter of each tetrahedron's mass goes to each
                             corner. The mass of hexahedra (lattices), or of the bounding box of meshes from
                             arrays, is shared by the rest length of a node's elements */
    double volume_modulus_Pa; /* k of the energy k (J - 1 - ln J) per volume of the mesh's tetrahedra, J the
                                 ratio of present volume to rest volume; 0 = no resistance to volume change */
    double poisson_ratio;     /* 0.25 to below 0.5, instead of volume_modulus_Pa: the network, scaled as a
                                 continuum, is a solid of this ratio at rest with its springs' shear
                                 modulus. k of hexahedra, or else tetrahedra, follows the law. 0 = none:
                                 springs have 1/4 */
    bool edge_correction; /* Cells of a lattice or of hexahedra, scaled as a continuum, are softer at edges
                             between a bonded face and a free one. Their singular stress makes a mesh too
                             stiff: at 7 nodes a side by 5 % between bonded plates with a ratio of 0.45,
                             with the correction by less than 1 %. Not beside volume_modulus_Pa */
    palp_integrator integrator;
    double spectral_radius; /* generalized alpha: 0 (damps most) to 1 */
    double check_strain; /* the tangent's inertia is assessed at least at this interval of depth / height */
    size_t n_regions;    /* at most PALP_REGIONS_MAX */
    const palp_region *regions; /* [n_regions] regions of the mesh by name, copied; shapes are not read */
} palp_network_settings;

/* tolerance 1e-10, 50 iterations, CONTINUE, AUTO, massless, backward Euler, check every 5e-3. */
PALP_API palp_network_settings palp_network_settings_default(void);

/* The default with the density, volume modulus, Poisson's ratio and regions of a network model. The
 * source of its mesh must stay until a network is made of them. NULL: the default. */
PALP_API palp_network_settings palp_network_settings_of_model(const palp_model *model);

/* The thesis' supports: "bottom" fixed, "top" fixed in x and z and driven in -y. */
PALP_API void palp_supports_default(palp_support supports[2]);

/* The law that makes a mesh scaled as a continuum a neo-Hookean solid of this Young's modulus. Poisson's
 * ratio, 0.25 to below 0.5, is that of palp_network_settings. Springs of constant stiffness are this solid at
 * small strains only: at a strain of 0.2 they are a third too soft. Under even compression between sliding
 * plates the force is the solid's at strains of 0.1 and 0.2, and within 0.3 % between them. Above 0.3 the law
 * is linear. ERR_UNSUPPORTED: a mesh without volume or elements; ERR_NOT_CONVERGED: there is no such law. */
PALP_API palp_status palp_law_of_solid(const palp_mesh *mesh, double poisson_ratio, double young_Pa,
                                       palp_law *law);

/* How a step went. */
typedef struct palp_step_info {
    int iterations;      /* Newton iterations (factorizations) */
    double residual;     /* relative residual reached */
    double force_N;      /* reaction conjugate to depth, positive = compression */
    int negative_pivots; /* of the last factor; -1 = not assessed in this step */
    size_t inverted;     /* inverted or flat tetrahedra of the mesh, without cut ones. Springs do not resist
                            inversion; results there do not represent tissue */
    double beyond;       /* how far the largest |element strain| exceeds the measured range of the law
                            (palp_law_beyond); 0 = within it, or the range is unknown */
} palp_step_info;

/* Builds a network: symbolic analysis once, all memory allocated here. Copies what it needs of the
 * mesh and the material. The caller owns *network. error may be NULL. ERR_ARGUMENT: a setting, a motion or
 * the material is out of range; ERR_INPUT: the mesh has no such node set or region; ERR_UNSUPPORTED: the
 * supernodal solver in a build without GPL=1, or a region's material other than PALP_HISTORY; also a volume
 * modulus or Poisson's ratio without cells or tetrahedra, or where edges or diagonals of them are no
 * elements; ERR_LIMIT: too large for 32-bit indices; ERR_NO_MEMORY. */
PALP_API palp_status palp_network_create(const palp_mesh *mesh, const palp_material *material,
                                         size_t n_supports, const palp_support *supports,
                                         const palp_network_settings *settings, palp_network **network,
                                         palp_error *error);
PALP_API void palp_network_free(palp_network *network); /* NULL is fine */

/* The network of a network model, ready to step; the caller owns it. mesh: NULL = the model's own, or that
 * one transformed (palp_mesh_transform). supports: NULL = palp_supports_default. settings: NULL = the
 * default; what palp_network_settings_of_model takes is the model's. Effects of the instrument are left out.
 * ERR_UNSUPPORTED: an effect of the material or the contact; palp_forward_network supports these. */
PALP_API palp_status palp_network_from_model(const palp_model *model, const palp_mesh *mesh,
                                             size_t n_supports, const palp_support *supports,
                                             const palp_network_settings *settings, palp_network **network,
                                             palp_error *error);

/* Back to rest: undeformed, no history, time 0. */
PALP_API void palp_network_reset(palp_network *network);

/* Gives the network another material, regions with one of their own excepted, and resets it. ERR_ARGUMENT:
 * see palp_material_check, or beside such regions a law without stiffness at rest; ERR_UNSUPPORTED:
 * PALP_SEDEF2008 beside such regions; ERR_NO_MEMORY. After an error the network stays as it was. */
PALP_API palp_status palp_network_set_material(palp_network *network, const palp_material *material);

/* One step to depth_m after dt_s seconds (INFINITY = fully relaxed). try leaves the result as a
 * trial, which commit makes the state and any other call that changes the network drops; step commits on
 * success. On failure the state stays as it was. info may be NULL. ERR_ARGUMENT: a number out of range;
 * ERR_NOT_CONVERGED; ERR_BUCKLED: no equilibrium on this branch; ERR_SINGULAR: a mechanism; ERR_COLLAPSED: an
 * element lost its length; ERR_INSIDE: a sphere, a capsule or the middle of a hull starts inside the tissue
 * and the tool touches none of its surface; ERR_LIMIT: more nodes of the surface are near triangles of it
 * than 32 for each triangle, where tissue touches itself. */
PALP_API palp_status palp_network_try(palp_network *network, double depth_m, double dt_s,
                                      palp_step_info *info);
PALP_API void palp_network_commit(palp_network *network); /* nothing without a trial */
PALP_API palp_status palp_network_step(palp_network *network, double depth_m, double dt_s,
                                       palp_step_info *info);

/* The same with the force on the driven nodes given; the depth follows (creep). ERR_ARGUMENT too where
 * nothing is driven. */
PALP_API palp_status palp_network_step_force(palp_network *network, double force_N, double dt_s,
                                             palp_step_info *info);

/* Forces on nodes, force_N[3 n], from the next step until the next call, or until a reset; other nodes have
 * none, and a node that is listed twice has the sum. On supported axes the support carries them. The first
 * call allocates (n may be 0): make it before palp_realtime_create. ERR_ARGUMENT: no such node, a number that
 * is not finite; ERR_NO_MEMORY. */
PALP_API palp_status palp_network_set_forces(palp_network *network, size_t n, const int32_t *nodes,
                                             const double *force_N);

/* Gives a network with mass velocities, velocity_m_s[3 n_nodes]; supported axes keep none. ERR_ARGUMENT: a
 * number that is not finite; ERR_UNSUPPORTED: a network without mass. */
PALP_API palp_status palp_network_set_velocities(palp_network *network, const double *velocity_m_s);

/* Saves the whole state (positions, history, predictor, contacts, tools, grasped nodes, cuts) to the caller's
 * buffer. Restores it to the same network or another one created and enabled alike, which drops a trial.
 * Later steps give the same results to the network's tolerance, as factors are not saved. ERR_ARGUMENT: no
 * buffer or one too small, or a network with another mesh, supports, material, density or terms. ERR_INPUT:
 * wrong checksum. After an error nothing has changed. The checksum detects damage, not manipulation. */
PALP_API size_t palp_network_state_size(const palp_network *network); /* bytes */
PALP_API palp_status palp_network_save(const palp_network *network, void *buffer, size_t size);
PALP_API palp_status palp_network_restore(palp_network *network, const void *buffer, size_t size);

/* State of the last commit. Arrays are the network's, valid until the next call that changes it. */
PALP_API double palp_network_depth(const palp_network *network);                 /* m */
PALP_API double palp_network_time(const palp_network *network);                  /* s */
PALP_API double palp_network_force(const palp_network *network);                 /* N, conjugate to depth */
PALP_API const double *palp_network_positions(const palp_network *network);      /* [3 n_nodes], m */
PALP_API const double *palp_network_element_strain(const palp_network *network); /* [n_elements] */
PALP_API const double *
palp_network_velocities(const palp_network *network); /* [3 n_nodes], m/s; NULL: no mass */
/* Largest |element strain|, of the elements that are not cut. */
PALP_API double palp_network_strain_max(const palp_network *network);
PALP_API size_t palp_network_unknown_count(const palp_network *network);
PALP_API const palp_mesh *palp_network_mesh(const palp_network *network); /* as given to create, copied */

/* The solids that resist a change of volume (palp_network_settings), and k, Pa, in the present material; k 0
 * and n 0 if there are none. nodes[corners n], the network's: 4 of a tetrahedron, or 8 of a cell, whose
 * corner c is at x = c & 1, y = c >> 1 & 1, z = c >> 2. */
PALP_API double palp_network_volume_solids(const palp_network *network, size_t *n, size_t *corners,
                                           const int32_t **nodes);
/* k of each of these solids, Pa: with the factors of its regions and of the edges of bonded faces; NULL if
 * there are none. The network's. */
PALP_API const double *palp_network_volume_moduli(const palp_network *network);
/* [n_elements] factor of each element's force: the mesh's times those of its regions and edges, 0 if cut;
 * NULL = all 1. The network's. */
PALP_API const double *palp_network_element_scale(const palp_network *network);
/* element forces, tension positive, into force_N[n_elements] */
PALP_API void palp_network_element_force(const palp_network *network, double *force_N);

/* Sum of the element forces that the nodes of a set put on their support, N. */
PALP_API palp_status palp_network_reaction(const palp_network *network, const char *set, double force_N[3]);

/* Present triangles of the surface, outward, into *triangles[3 *n]: those of the mesh. In a network that can
 * be cut (palpate/cut.h), faces of exactly one tetrahedron without a cut edge. The array is the network's,
 * valid until the next cut. */
PALP_API palp_status palp_network_surface(const palp_network *network, size_t *n, const int32_t **triangles);

/* Depth range in which the tangent first lost positive definiteness: stable at *stable_m, not at
 * *unstable_m. With the STABLE branch the network then went to another equilibrium. False if that has not
 * happened since the last reset. */
PALP_API bool palp_network_buckled(const palp_network *network, double *stable_m, double *unstable_m);

/* Called after each committed step; a non-zero return stops the run with ERR_STOPPED. */
typedef int (*palp_network_observer)(void *user, double time_s, double depth_m, double force_N);

typedef struct palp_run_settings {
    double dt_s;      /* fixed step; each segment is cut into equal steps of at most dt_s */
    double tolerance; /* > 0: error-controlled instead, relative to the largest force so far */
    double dt_min_s;  /* error-controlled: first step of a segment; the smallest step is a thousandth of it
                         and accepted with any error. 0 = a fiftieth of the segment, smallest 1e-9 of it */
    bool relaxed;     /* every step fully relaxed (static) */
    double from_s; /* > 0: go on from this time of the path, at which a restored network is: fixed steps that
                      end until then are left out, and those that remain are those of the whole run */
    palp_network_observer observer; /* may be NULL */
    void *user;
} palp_run_settings;

typedef struct palp_run_info {
    size_t steps, rejected, iterations;
    double worst_residual;
    double peak_force_N;
    size_t inverted; /* largest number in a step */
    double beyond;   /* largest value in a step; 0 = never above 0 */
    double beyond_s; /* time of the path when it was first above 0 */
} palp_run_info;

/* Follows a path from the present state. The path's first corner is reached by an instantaneous
 * step if the network is not there. Error control is by step doubling of the reaction force. Its
 * order is 2, or 1 with mass (backward Euler), a dashpot or PALP_SEDEF2008. */
PALP_API palp_status palp_network_run(palp_network *network, const palp_path *path,
                                      const palp_run_settings *settings, palp_run_info *info);

#ifdef __cplusplus
}
#endif
#endif
