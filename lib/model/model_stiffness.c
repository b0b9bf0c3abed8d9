/* model_stiffness.c: law, arms and Poisson's ratio in a model JSON. */
#include "base/json.h"
#include "model_internal.h"

#include <math.h>

#define COUNT(list) (sizeof(list) / sizeof(list)[0])

/* The list called key of a stiffness; ERR_INPUT if it is absent or empty. */
static palp_status read_nonempty_list(const palp_json *at, const char *key, palp_json *list, size_t *n,
                                      double *values) {
    palp_status status = palp_json_require(at, key, list);
    if (!status)
        status = palp_json_numbers(list, PALP_LAW_MAX, n, values);
    if (!status && *n == 0)
        status = palp_json_fail(list, PALP_ERR_INPUT, "must not be empty");
    return status;
}

static palp_status check_spline_knots(const palp_json *strain, size_t n, const double *a) {
    if (n < 2 || a[0] != 0)
        return palp_json_fail(strain, PALP_ERR_INPUT, "must have at least two knots, the first at 0");
    for (size_t i = 1; i < n; i++)
        if (!(a[i] > a[i - 1]))
            return palp_json_fail(strain, PALP_ERR_INPUT, "must increase (%g after %g)", a[i], a[i - 1]);
    return PALP_OK;
}

static palp_status read_spline_law(const palp_json *at, palp_law *law) {
    static const char *const keys[] = {"kind", "strain", "stiffness_N", "strain_max"};
    palp_json strain, stiffness;
    double a[PALP_LAW_MAX], k_N[PALP_LAW_MAX];
    size_t n = 0, m = 0;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = read_nonempty_list(at, "strain", &strain, &n, a);
    if (!status)
        status = check_spline_knots(&strain, n, a);
    if (!status)
        status = read_nonempty_list(at, "stiffness_N", &stiffness, &m, k_N);
    if (!status && m != n)
        status = palp_json_fail(&stiffness, PALP_ERR_INPUT, "has %zu values for %zu knots", m, n);
    if (!status && palp_law_spline(n, a, k_N, law))
        status = palp_json_fail(&stiffness, PALP_ERR_INPUT, "must be greater than 0 at every knot");
    return status;
}

/* A polynomial or a hyperelastic law: coefficients alone. */
static palp_status read_law_of_coefficients(const palp_json *at, palp_law_kind kind, double radius_m,
                                            palp_law *law) {
    const bool polynomial = kind == PALP_LAW_POLYNOMIAL;
    const char *const keys[] = {"kind", polynomial ? "coefficients_N" : "coefficients_Pa", "strain_max"};
    palp_json list;
    double c[PALP_LAW_MAX];
    size_t n = 0;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = read_nonempty_list(at, keys[1], &list, &n, c);
    if (!status && !polynomial && !(radius_m > 0))
        status =
            palp_json_fail(at, PALP_ERR_INPUT, "is hyperelastic: it needs specimen.radius_mm for the area");
    if (!status && (polynomial ? palp_law_polynomial(n, c, law)
                               : palp_law_hyperelastic(kind, n, c, palp_model_area(radius_m), law)))
        status = palp_json_fail(&list, PALP_ERR_INPUT, "do not form a %s law: there are %zu",
                                palp_law_kind_name(kind), n);
    return status;
}

static palp_status read_stiffness_law(const palp_json *at, palp_model *model) {
    palp_json kind;
    palp_law_kind law_kind;
    palp_law *law = &model->material.law;
    const char *name = "";
    if (!json_is_object(at->value))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be an object {...}");
    palp_status status = palp_json_require(at, "kind", &kind);
    if (!status)
        status = palp_json_string(&kind, &name);
    if (status)
        return status;
    if (palp_law_kind_parse(name, &law_kind))
        return palp_json_fail(&kind, PALP_ERR_INPUT,
                              "\"%s\" is not one of polynomial, spline, neo_hookean, mooney_rivlin2, "
                              "mooney_rivlin5, yeoh, ogden",
                              name);
    return law_kind == PALP_LAW_SPLINE ? read_spline_law(at, law)
                                       : read_law_of_coefficients(at, law_kind, model->radius_m, law);
}

/* Reads the largest strain at which the law was measured, if present. */
static palp_status read_law_strain_limit(const palp_json *stiffness, palp_law *law) {
    palp_json value;
    double strain_max = 0;
    if (!palp_json_member(stiffness, "strain_max", &value))
        return PALP_OK;
    palp_status status = palp_json_positive(&value, &strain_max);
    if (!status && (palp_law_limit(law, strain_max) || law->strain_max != strain_max))
        status = palp_json_fail(&value, PALP_ERR_INPUT,
                                "is %g, where the force no longer rises, so that the law cannot be extended",
                                strain_max);
    return status;
}

static palp_status read_stiffness(const palp_json *root, palp_model *model) {
    palp_json stiffness;
    palp_status status = palp_json_require(root, "stiffness", &stiffness);
    if (!status)
        status = read_stiffness_law(&stiffness, model);
    if (!status)
        status = read_law_strain_limit(&stiffness, &model->material.law);
    if (status)
        return status;
    double lowest_N = palp_model_lowest(&model->material.law);
    if (!(lowest_N > 0))
        return palp_json_fail(&stiffness, PALP_ERR_INPUT,
                              "falls to %.6g N between strain 0 and %g, but must stay above 0", lowest_N,
                              fmax(PALP_MODEL_STRAIN, model->material.law.strain_max));
    return PALP_OK;
}

static palp_status read_maxwell_arm(const palp_json *at, palp_arm *arm) {
    static const char *const keys[] = {"stiffness_N", "viscosity_Ns", "stiffness_per_strain",
                                       "time_per_strain"};
    palp_json value;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = palp_json_require(at, "stiffness_N", &value);
    if (!status)
        status = palp_json_positive(&value, &arm->stiffness_N);
    if (!status)
        status = palp_json_require(at, "viscosity_Ns", &value);
    if (!status)
        status = palp_json_positive(&value, &arm->viscosity_Ns);
    if (!status && palp_json_member(at, "stiffness_per_strain", &value))
        status = palp_json_number(&value, &arm->beta);
    if (!status && palp_json_member(at, "time_per_strain", &value))
        status = palp_json_number(&value, &arm->gamma);
    return status;
}

static palp_status read_maxwell_arms(const palp_json *root, palp_material *material) {
    palp_json arms, arm;
    if (!palp_json_member(root, "arms", &arms))
        return PALP_OK;
    palp_status status = palp_json_list(&arms, PALP_ARMS_MAX, &material->n_arms);
    for (size_t j = 0; !status && j < material->n_arms; j++) {
        status = palp_json_item(&arms, j, &arm);
        if (!status)
            status = read_maxwell_arm(&arm, &material->arms[j]);
    }
    return status;
}

palp_status palp_model_material_read(const palp_json *root, palp_model *model) {
    palp_json value;
    palp_material *material = &model->material;
    palp_status status = read_stiffness(root, model);
    if (!status)
        status = read_maxwell_arms(root, material);
    if (!status && palp_json_member(root, "dashpot_Ns", &value))
        status = palp_json_not_negative(&value, &material->dashpot_Ns);
    if (!status && palp_json_member(root, "quasi_linear", &value))
        status = palp_json_bool(&value, &material->quasi_linear);
    return status;
}

palp_status palp_model_ratio_read(const palp_json *value, double volume_modulus_Pa, double *ratio) {
    palp_status status = palp_json_positive(value, ratio);
    if (!status && !(*ratio >= 0.25 && *ratio < 0.5))
        return palp_json_fail(value, PALP_ERR_INPUT, "must be from 0.25 to below 0.5");
    if (!status && volume_modulus_Pa > 0)
        return palp_json_fail(value, PALP_ERR_INPUT, "does not go with volume_modulus_Pa");
    return status;
}
