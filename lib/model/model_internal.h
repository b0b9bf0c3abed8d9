/* model_internal.h: functions shared by the model's reader and writer. */
#ifndef PALP_MODEL_INTERNAL_H
#define PALP_MODEL_INTERNAL_H

#include <palpate/model.h>

#include "base/json.h"

/* The lowest K in that range, N. */
double palp_model_lowest(const palp_law *law);

/* Names of the scalings of a mesh. */
extern const char *const palp_model_scalings[PALP_SCALING_CONTINUUM + 1];

/* Cross-section of a cylinder, m^2. */
double palp_model_area(double radius_m);

/* Letters, digits, '_' and '-', less than PALP_SPECIMEN_KIND_MAX of them. */
bool palp_model_kind_valid(const char *kind);

/* The list "effects" of a model whose kind is known; absent = none. */
palp_status palp_model_effects_read(const palp_json *root, palp_model *model);

/* Are all effects within bounds, possible for the model's kind, and without repeats? */
palp_status palp_model_effects_check(const palp_model *model, palp_error *error);

/* The list "free_term", absent = none; and may it be written? (model_free_terms.c) */
palp_status palp_model_free_terms_read(const palp_json *root, palp_model *model);
palp_status palp_model_free_terms_check(const palp_model *model, palp_error *error);

/* Units of the ends of a kind's grid in a file: 1, or mm where they are metres. */
double palp_model_free_unit(palp_free_kind kind);

/* Whether the force of a kind is in proportion to that of the plate. (free_term.c) */
bool palp_model_free_of_force(palp_free_kind kind);

/* Rows of a material's covariance: coefficients of the law, then K_j and b_j of each arm. */
size_t palp_model_covariance_size(const palp_material *material);
bool palp_model_covariance_valid(size_t n, const double *covariance);

/* Valid stiffness, time and exponent of a fractional element? "fractional" is one, or absent. */
bool palp_model_fractional_valid(const double fractional[3]);
palp_status palp_model_fractional_check(const palp_json *root);

/* Reads "covariance" of a model whose material is known; allocated for the caller, NULL if absent. */
palp_status palp_model_covariance_read(const palp_json *root, const palp_material *material,
                                       double **covariance);

/* Reads "specimens": their differences, allocated for the caller, and their number; NULL and 0 if absent. */
palp_status palp_model_between_read(const palp_json *root, const palp_material *material, double **between,
                                    size_t *n_specimens);

/* "validity" of a network, absent = none; and may it be written? */
palp_status palp_model_validity_read(const palp_json *root, palp_model *model);
bool palp_model_validity_valid(const palp_model *model);

/* "regions" of a network whose material is known, absent = none; and may they be written? */
palp_status palp_model_regions_read(const palp_json *root, const palp_model *model, palp_mesh_source *source);
bool palp_model_regions_valid(const palp_model *model);

/* Law, arms, dashpot and quasi_linear; the model's radius is known. */
palp_status palp_model_material_read(const palp_json *root, palp_model *model);

/* A Poisson's ratio, which does not go with a volume modulus. */
palp_status palp_model_ratio_read(const palp_json *value, double volume_modulus_Pa, double *ratio);

/* palp_model_read for the parsed value of a file. */
palp_status palp_model_from_json(const palp_json *root, palp_model *model, palp_mesh_source *mesh);

/* The folder part of path ("" if it has none) into folder; ERR_LIMIT if it does not fit. */
palp_status palp_model_folder(const char *path, char folder[PALP_PATH_MAX]);

/* folder/path, or path if it is absolute or folder is "". ERR_LIMIT if it does not fit. */
palp_status palp_model_join(const char *folder, const char *path, char joined[PALP_PATH_MAX]);

#endif
