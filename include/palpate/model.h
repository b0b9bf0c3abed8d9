/* model.h: the model JSON, lumped or network. Stable. */
#ifndef PALPATE_MODEL_H
#define PALPATE_MODEL_H

#include <palpate/effect.h>
#include <palpate/material.h>
#include <palpate/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum palp_model_kind { PALP_MODEL_LUMPED, PALP_MODEL_NETWORK } palp_model_kind;
typedef enum palp_mesh_kind { PALP_MESH_LATTICE, PALP_MESH_FILE } palp_mesh_kind;

enum { PALP_PATH_MAX = 4096, PALP_SPECIMEN_KIND_MAX = 32 };

/* How a network model's mesh is made: 8 KB, kept once beside the models that point to it. A relative path is
 * taken from the model file's folder. */
typedef struct palp_mesh_source {
    palp_mesh_kind kind;
    size_t nodes[3];                  /* lattice */
    double size_m[3];                 /* lattice */
    palp_neighbourhood neighbourhood; /* lattice; default 26 */
    char path[PALP_PATH_MAX];         /* file: as written in the model */
    char folder[PALP_PATH_MAX];       /* file: where a relative path starts; "" = working directory */
    double scale_m;                   /* file: metres per unit; default 0.001 */
    bool hex_diagonals;               /* file */
    palp_mesh_scaling scaling;        /* file: see palp_mesh_scale; default none */
    double area_m2;                   /* of the scaling; 0 = the mesh's volume over its height */
} palp_mesh_source;

/* A model; a plain value of less than 2 KB. Lengths in metres here, in mm in the file. */
typedef struct palp_model {
    palp_model_kind kind;
    double height_m, radius_m; /* specimen; radius 0 = not given; a network's height may be 0 = that
                                  of its mesh */
    char specimen_kind[PALP_SPECIMEN_KIND_MAX]; /* "cylinder", ...; "" = not given */
    palp_material material;
    const palp_mesh_source *mesh; /* network only: the caller's, which outlives the model and its copies; NULL
                                     = none, and there is neither a mesh to make nor a model to write */
    double density_kg_m3;         /* network only, 0 = massless */
    double volume_modulus_Pa;     /* network only, 0 = none: see palp_network_settings */
    const double
        *fractional; /* [3] K_frac in N, tau_frac in s and exponent of the fractional element whose spectrum
                        the arms are, for who reads the file, or NULL; the caller's; NULL when it is read */
    const double *
        covariance; /* how well the material is known, or NULL; the caller's. Of the law's coefficients, then
                       K_j and b_j of each arm (the order of palp_forward_get): [n n], n = law.n + 2 n_arms */
    const double
        *between; /* [n n] how specimens differ from this, the mean of n_specimens, or NULL; the caller's */
    size_t n_specimens; /* with between, 2 or more */
    size_t n_effects;   /* what is added to the plain model; run by palp_forward_* */
    palp_effect effects[PALP_EFFECTS_MAX];
} palp_model;

/* Reads and checks a model. mesh (may be NULL: nobody needs it) is the caller's; a network's is filled, also
 * where its reading fails, and the model points to it. ERR_INPUT with "file:line: ..." (Jansson's line for
 * syntax; for a wrong value the line where its key stands, as nearly as can be told) for malformed JSON, a
 * missing or unknown key, a wrong unit in a key ("height_m"), a non-physical number, K(a) <= 0 for a in [0,
 * 0.4]. ERR_LIMIT for a folder that does not fit in the source. ERR_UNSUPPORTED for an effect that this build
 * does not know, or that a model of its kind cannot carry. */
PALP_API palp_status palp_model_read(const char *path, palp_model *model, palp_mesh_source *mesh,
                                     palp_error *error);

/* The covariance in a model file, malloc'ed, the caller frees it; NULL where the file has none.
 * palp_model_read checks it and leaves the model's NULL: numbers that are changed are no longer known so
 * well. Errors of palp_model_read. */
PALP_API palp_status palp_model_read_covariance(const char *path, double **covariance, palp_error *error);

/* How specimens differ, likewise; *n_specimens 0 where the file does not say. */
PALP_API palp_status palp_model_read_between(const char *path, double **between, size_t *n_specimens,
                                             palp_error *error);

/* The covariance of a specimen that was not measured: that of the mean and the spread together, widened by
 * Student's t so that 1.96 sd hold 95 % of such specimens. total[n n] may be the covariance itself, which is
 * widened already. */
PALP_API palp_status palp_model_unmeasured(size_t n, const double *covariance, const double *between,
                                           size_t n_specimens, double *total);

/* Writes to a temporary name, then renames. A mesh file's relative path is rewritten so that it
 * holds from the folder of path. ERR_ARGUMENT for a model that could not be read again: numbers that
 * make no material, K(a) <= 0, a hyperelastic law whose area is not that of the specimen's radius. */
PALP_API palp_status palp_model_write(const palp_model *model, const char *path, palp_error *error);

/* The model as one JSON line without its end, malloc'ed; the caller frees it. A mesh file's path is
 * given as it stands in the model. */
PALP_API palp_status palp_model_format(const palp_model *model, char **json);

/* The mesh of a network model, a lattice made or a file read; the caller owns it. ERR_ARGUMENT: a lumped
 * model, or one without its source; ERR_LIMIT: folder and path are too long together. */
PALP_API palp_status palp_model_mesh(const palp_model *model, palp_mesh **mesh, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
