/* solid.h: isotropic solids of other programs on a mesh's tetrahedra, fitted to the force of a plate. May
 * change. */
#ifndef PALPATE_SOLID_H
#define PALPATE_SOLID_H

#include <palpate/material.h>
#include <palpate/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_SOLID_MAX = 3 }; /* most coefficients of a solid */

/* Energies per volume at rest, linear in the coefficients c, Pa. C = F'F has the invariants I1 and I2, J =
 * det F, I1~ = J^(-2/3) I1, I2~ = J^(-4/3) I2. Poisson's ratio gives the volume terms from the shear modulus
 * G at rest: bulk modulus K = 2 G (1 + nu) / (3 (1 - 2 nu)), lambda = 2 G nu / (1 - 2 nu). */
typedef enum palp_solid_law {
    PALP_SOLID_NEO_HOOKEAN,        /* c0 (I1~ - 3) + K/2 (J - 1)^2, G = 2 c0 */
    PALP_SOLID_MOONEY_RIVLIN,      /* c0 (I1~ - 3) + c1 (I2~ - 3) + K/2 (J - 1)^2, G = 2 (c0 + c1) */
    PALP_SOLID_YEOH,               /* sum of ci (I1~ - 3)^(i + 1), i < 3, + K/2 (J - 1)^2, G = 2 c0 */
    PALP_SOLID_MOONEY_RIVLIN_LOG,  /* as MOONEY_RIVLIN with K/2 (ln J)^2: FEBio, SOFA */
    PALP_SOLID_NEO_HOOKEAN_LOG,    /* c0/2 (I1 - 3) - c0 ln J + lambda/2 (ln J)^2, G = c0: FEBio, Vega */
    PALP_SOLID_NEO_HOOKEAN_STABLE, /* c0/2 (I1 - 3) + (lambda + c0)/2 (J - 1 - c0 / (lambda + c0))^2, G = c0
                                      (Smith, De Goes and Kim 2018): SOFA, Newton */
    PALP_SOLID_ST_VENANT           /* lambda/2 (tr E)^2 + c0 E:E, E = (C - 1)/2, G = c0: MuJoCo, Vega */
} palp_solid_law;

/* The time dependence of a solid. PRONY: the stress of each arm relaxes, all components alike, F = Fe + sum
 * of share_j times the history of Fe over exp(-t / tau_j). The others add a viscous force. RAYLEIGH:
 * damping_s times the tangent. MATERIAL: the stress is damping_s times that of the rate of E. SHEAR: the
 * dissipation is 2 viscosity (dE/dt : dE/dt). */
typedef enum palp_solid_time {
    PALP_SOLID_ELASTIC,
    PALP_SOLID_PRONY,
    PALP_SOLID_RAYLEIGH,
    PALP_SOLID_MATERIAL,
    PALP_SOLID_SHEAR
} palp_solid_time;

/* A solid on a mesh whose set "bottom" is held and whose "top" is pressed along y; a plain value. */
typedef struct palp_solid {
    palp_solid_law law;
    double poisson;              /* 0 <= nu < 0.5 */
    double c_Pa[PALP_SOLID_MAX]; /* palp_solid_count of them */
    bool slides;                 /* plates without friction; else both hold their nodes */
    palp_solid_time time;
    size_t n_arms; /* PRONY: their times, and shares of the relaxed stiffness */
    double tau_s[PALP_ARMS_MAX], share[PALP_ARMS_MAX];
    double damping; /* RAYLEIGH, MATERIAL: s; SHEAR: viscosity, Pa s */
} palp_solid;

/* One press for a fit; the arrays are the caller's. use[n]: 0 where a force does not count; NULL = all. */
typedef struct palp_solid_press {
    size_t n;
    const double *time_s, *depth_m, *force_N;
    const unsigned char *use;
} palp_solid_press;

typedef struct palp_solid_fit_info {
    double rms_N, worst_N, peak_N; /* residuals, and the largest force of the presses */
    size_t n;                      /* samples */
} palp_solid_fit_info;

PALP_API size_t palp_solid_count(palp_solid_law law); /* number of its coefficients */

/* Shear modulus G, bulk modulus K and lambda at rest, relaxed, Pa; 0 for NULL. */
PALP_API double palp_solid_shear(const palp_solid *solid);
PALP_API double palp_solid_bulk(const palp_solid *solid);
PALP_API double palp_solid_lambda(const palp_solid *solid);

/* Energy per volume at the deformation gradient F[9] by rows, and if not NULL its derivatives by F: stress[9]
 * (first Piola-Kirchhoff) and tangent[81]. INFINITY where J <= 0 and the law has no energy there. */
PALP_API double palp_solid_energy(const palp_solid *solid, const double F[9], double *stress,
                                  double *tangent);

/* Which axes of each node are supported, held[n_nodes]: bits 0 to 2 for x, y, z, bit 3 if y is pressed.
 * Plates that slide leave x and z free but for a node at the middle of the bottom and, against turning, z of
 * another. ERR_INPUT: the mesh has no "bottom" or "top". */
PALP_API palp_status palp_solid_supports(const palp_mesh *mesh, bool slides, unsigned char *held);

/* Relaxed force of the plate, force_N[n], at depths that grow from 0, by linear tetrahedra and Newton's
 * method. Errors of palp_solid_supports; ERR_UNSUPPORTED: a mesh without tetrahedra; ERR_ARGUMENT: a number
 * out of its range; ERR_NOT_CONVERGED, ERR_SINGULAR, ERR_NO_MEMORY. */
PALP_API palp_status palp_solid_force(const palp_solid *solid, const palp_mesh *mesh, size_t n,
                                      const double *depth_m, double *force_N);

/* Fits the coefficients, and shares (of the given tau_s) or damping, to n presses by least squares of the
 * force: solid's law, poisson, slides, time, n_arms and tau_s are in, the others out. A solid of two or
 * three coefficients is stable between its plates to a quarter beyond the deepest press; shares and damping
 * are not negative. Below contact the force is 0. The elastic force is computed at 12 depths and interpolated
 * (cubic). Errors as above; ERR_ARGUMENT too: no sample at a depth above 0. */
PALP_API palp_status palp_solid_fit(palp_solid *solid, const palp_mesh *mesh, size_t n,
                                    const palp_solid_press *press, palp_solid_fit_info *info);

/* The force of a fitted solid at the samples of a press, force_N[press->n]; errors of palp_solid_force. */
PALP_API palp_status palp_solid_run(const palp_solid *solid, const palp_mesh *mesh,
                                    const palp_solid_press *press, double *force_N);

#ifdef __cplusplus
}
#endif
#endif
