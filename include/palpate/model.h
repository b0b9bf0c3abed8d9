/* model.h: the model JSON, lumped or network. Stable. */
#ifndef PALPATE_MODEL_H
#define PALPATE_MODEL_H

#include <palpate/effect.h>
#include <palpate/free_term.h>
#include <palpate/material.h>
#include <palpate/mesh.h>
#include <palpate/region.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum palp_model_kind { PALP_MODEL_LUMPED, PALP_MODEL_NETWORK } palp_model_kind;
typedef enum palp_mesh_kind { PALP_MESH_LATTICE, PALP_MESH_FILE } palp_mesh_kind;

enum { PALP_PATH_MAX = 4096, PALP_SPECIMEN_KIND_MAX = 32 };

/* The stiffness of a law that is read or written must be positive up to this strain, and over its measured
 * range. */
#define PALP_MODEL_STRAIN 0.4

/* How the mesh of a network model is made, and its regions. It takes 20 KB, so models point to it. A relative
 * path is taken from the folder of the model file. */
typedef struct palp_mesh_source {
    palp_mesh_kind kind;
    size_t nodes[3];                  /* lattice */
    double size_m[3];                 /* lattice */
    palp_neighbourhood neighbourhood; /* lattice; default 26 */
    char path[PALP_PATH_MAX];         /* file: as written in the model */
    char folder[PALP_PATH_MAX];       /* file: where a relative path starts; "" = working directory */
    double scale_m;                   /* file: metres per unit; default 0.001 */
    bool hex_diagonals;               /* file */
    palp_mesh_scaling scaling;        /* see palp_mesh_scale; default none */
    double area_m2;                   /* of the scaling; 0 = the mesh's volume over its height */
    size_t n_regions;
    palp_region regions[PALP_REGIONS_MAX];
} palp_mesh_source;

/* The largest relative error of the force of a smooth sphere in a network, wherever it stands over the nodes
 * (palpate calibrate --check). */
enum { PALP_VALIDITY_MAX = 12 };
typedef struct palp_validity {
    double radius_m, depth_m, error;
} palp_validity;

/* A model; a plain value of less than 4 KB. Lengths in metres here, in mm in the file. */
typedef struct palp_model {
    palp_model_kind kind;
    double height_m, radius_m; /* specimen; radius 0 = not given; a network's height may be 0 = that
                                  of its mesh */
    char specimen_kind[PALP_SPECIMEN_KIND_MAX]; /* "cylinder", ...; "" = not given */
    palp_material material;
    const palp_mesh_source *mesh; /* network only: the caller's, which outlives the model and its copies; NULL
                                     = none, and there is neither a mesh to make nor a model to write */
    double density_kg_m3;         /* network only, 0 = massless */
    double volume_modulus_Pa, poisson_ratio; /* network only, 0 = none: see palp_network_settings */
    bool edge_correction;                    /* network only: see palp_network_settings */
    /* [3] K_frac in N, tau_frac in s and exponent of the fractional element that the arms approximate; NULL =
     * none. The caller's; written only, and NULL when a model is read. */
    const double *fractional;
    /* Covariance [n n] of the material's n = law.n + 2 n_arms parameters: the law's coefficients, then K_j
     * and b_j of each arm (the order of palp_forward_get). NULL = not known; the caller's. */
    const double *covariance;
    /* [n n] covariance between specimens, if this is the mean of n_specimens; NULL = none; the caller's. */
    const double *between;
    size_t n_specimens; /* with between, 2 or more */
    size_t n_validity;  /* network only: the presses that it was checked by; 0 = it was not */
    palp_validity validity[PALP_VALIDITY_MAX];
    size_t n_effects; /* additions to the plain model; run by palp_forward_* */
    palp_effect effects[PALP_EFFECTS_MAX];
    size_t n_free; /* free terms; added to the force by palp_forward_* */
    palp_free_term free_term[PALP_FREE_TERMS];
} palp_model;

/* Reads and checks a model. mesh is the caller's, and may be NULL if the mesh is not needed. For a network
 * it is filled, even if reading then fails, and the model points to it. ERR_INPUT with "file:line: ...":
 * malformed JSON, a missing or unknown key, a wrong unit in a key ("height_m"), a non-physical number, K(a)
 * <= 0 for a in [0, 0.4]. The line is that of the syntax error, or of the key with the wrong value.
 * ERR_LIMIT: a folder name that does not fit in the source. ERR_UNSUPPORTED: an effect that this build does
 * not know, or that a model of its kind cannot have. */
PALP_API palp_status palp_model_read(const char *path, palp_model *model, palp_mesh_source *mesh,
                                     palp_error *error);

/* The covariance in a model file, malloc'ed, for the caller to free; NULL if the file has none.
 * palp_model_read checks it but leaves model->covariance NULL, since it would no longer hold for a model
 * that the caller changes. Errors of palp_model_read. */
PALP_API palp_status palp_model_read_covariance(const char *path, double **covariance, palp_error *error);

/* The covariance between specimens, likewise; *n_specimens is 0 if the file does not have it. */
PALP_API palp_status palp_model_read_between(const char *path, double **between, size_t *n_specimens,
                                             palp_error *error);

/* The covariance for a specimen that was not measured: that of the mean plus that between specimens, widened
 * by Student's t so that +-1.96 sd contain 95 % of such specimens. covariance is already widened in this
 * way. total[n n] may be covariance itself. */
PALP_API palp_status palp_model_unmeasured(size_t n, const double *covariance, const double *between,
                                           size_t n_specimens, double *total);

/* What the force of a sphere of this radius is off by at this depth: the largest error of the checked presses
 * next to it. A larger sphere than was checked counts as the largest, a shallower press as the shallowest.
 * ERR_LIMIT: a smaller sphere or a deeper press than was checked; ERR_UNSUPPORTED: nothing was checked;
 * ERR_ARGUMENT: radius_m <= 0, depth_m < 0. */
PALP_API palp_status palp_model_tool_error(const palp_model *model, double radius_m, double depth_m,
                                           double *error);

/* Writes to a temporary name, then renames. A mesh file's relative path is rewritten so that it
 * holds from the folder of path. ERR_ARGUMENT for a model that could not be read again: numbers that
 * make no material, K(a) <= 0, a hyperelastic law whose area is not that of the specimen's radius. */
PALP_API palp_status palp_model_write(const palp_model *model, const char *path, palp_error *error);

/* The model as one JSON line without its end, malloc'ed; the caller frees it. A mesh file's path is
 * given as it stands in the model. */
PALP_API palp_status palp_model_format(const palp_model *model, char **json);

/* The mesh of a network model with its regions, a lattice made or a file read; the caller owns it.
 * ERR_ARGUMENT: a lumped model, or one without its source; ERR_LIMIT: folder and path are too long together.
 */
PALP_API palp_status palp_model_mesh(const palp_model *model, palp_mesh **mesh, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
