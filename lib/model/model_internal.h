/* model_internal.h: what the model's reader and writer share. */
#ifndef PALP_MODEL_INTERNAL_H
#define PALP_MODEL_INTERNAL_H

#include <palpate/model.h>

#include "base/json.h"

/* K must be positive up to here, and over the strains it was measured to, in a model that is read or written.
 */
#define PALP_MODEL_STRAIN 0.4

/* The lowest K there, N. */
double palp_model_lowest(const palp_law *law);

/* "stiffness" of a model whose specimen is known. */
palp_status palp_model_stiffness_read(const palp_json *root, palp_model *model);

/* Names of the scalings of a mesh. */
extern const char *const palp_model_scalings[PALP_SCALING_CONTINUUM + 1];

/* Cross-section of a cylinder, m^2. */
double palp_model_area(double radius_m);

/* Letters, digits, '_' and '-', less than PALP_SPECIMEN_KIND_MAX of them. */
bool palp_model_kind_valid(const char *kind);

/* The list "effects" of a model whose kind is known; absent = none. */
palp_status palp_model_effects_read(const palp_json *root, palp_model *model);

/* Whether a model's effects are all within their bounds, carried by its kind, and there once. */
palp_status palp_model_effects_check(const palp_model *model, palp_error *error);

/* Rows of a material's covariance: coefficients of the law, then K_j and b_j of each arm. */
size_t palp_model_covariance_size(const palp_material *material);
bool palp_model_covariance_valid(size_t n, const double *covariance);

/* Stiffness, time and exponent of a fractional element; "fractional" of a model is one, or is not there. */
bool palp_model_fractional_valid(const double fractional[3]);
palp_status palp_model_fractional_check(const palp_json *root);

/* "covariance" of a model whose material is known, malloc'ed; NULL without it. */
palp_status palp_model_covariance_read(const palp_json *root, const palp_material *material,
                                       double **covariance);

/* "specimens" of it: how they differ, malloc'ed, and how many; NULL and 0 without. */
palp_status palp_model_between_read(const palp_json *root, const palp_material *material, double **between,
                                    size_t *n_specimens);

/* What palp_model_read does with the value of a file. */
palp_status palp_model_from_json(const palp_json *root, palp_model *model, palp_mesh_source *mesh);

/* The folder part of path ("" if it has none) into folder; ERR_LIMIT if it does not fit. */
palp_status palp_model_folder(const char *path, char folder[PALP_PATH_MAX]);

/* folder/path, or path if it is absolute or folder is "". ERR_LIMIT if it does not fit. */
palp_status palp_model_join(const char *folder, const char *path, char joined[PALP_PATH_MAX]);

#endif
