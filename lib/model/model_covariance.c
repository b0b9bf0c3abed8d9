/* model_covariance.c: covariance of a model's numbers, and the spectrum that its arms stand for, in its
 * JSON. */
#include "base/json.h"
#include "base/statistics.h"
#include "model_internal.h"

#include <math.h>
#include <stdlib.h>

size_t palp_model_covariance_size(const palp_material *material) {
    return material->law.n + 2 * material->n_arms;
}

bool palp_model_covariance_valid(size_t n, const double *c) {
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double scale = sqrt(c[i * n + i] * c[j * n + j]);
            if (!isfinite(c[i * n + j]) || !(fabs(c[i * n + j]) <= scale * (1.0 + 1e-9)) ||
                !(fabs(c[i * n + j] - c[j * n + i]) <= 1e-9 * scale))
                return false;
        }
    return true;
}

/* Reads a square matrix, a member of root, if root has it. */
static palp_status read_square_matrix(const palp_json *root, const char *key, const palp_material *material,
                                      double **covariance) {
    palp_json rows, row;
    size_t n = palp_model_covariance_size(material), count = 0, width = 0;
    *covariance = NULL;
    if (!palp_json_member(root, key, &rows))
        return PALP_OK;
    palp_status status = palp_json_list(&rows, n, &count);
    double *c = calloc(n * n + 1, sizeof *c);
    if (!c)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        status = palp_json_item(&rows, i, &row);
        if (!status)
            status = palp_json_numbers(&row, n, &width, c + i * n);
        if (!status && width != n)
            status = palp_json_fail(&row, PALP_ERR_INPUT,
                                    "has %zu numbers, not one for each of the %zu parameters", width, n);
    }
    if (!status && count != n)
        status = palp_json_fail(&rows, PALP_ERR_INPUT, "has %zu rows, not one for each of the %zu parameters",
                                count, n);
    if (!status && !palp_model_covariance_valid(n, c))
        status = palp_json_fail(&rows, PALP_ERR_INPUT,
                                "is not a covariance: it must be symmetric, with no correlation beyond 1");
    if (status)
        free(c);
    else
        *covariance = c;
    return status;
}

bool palp_model_fractional_valid(const double fractional[3]) {
    return fractional[0] > 0 && isfinite(fractional[0]) && fractional[1] > 0 && isfinite(fractional[1]) &&
           fractional[2] > 0 && fractional[2] < 1;
}

palp_status palp_model_fractional_check(const palp_json *root) {
    static const char *const keys[] = {"stiffness_N", "time_s", "exponent"};
    palp_json element, number;
    double fractional[3] = {0};
    if (!palp_json_member(root, "fractional", &element))
        return PALP_OK;
    palp_status status = palp_json_keys(&element, 3, keys);
    for (size_t k = 0; k < 3 && !status; k++) {
        status = palp_json_require(&element, keys[k], &number);
        status = status ? status : palp_json_number(&number, &fractional[k]);
    }
    if (!status && !palp_model_fractional_valid(fractional))
        status = palp_json_fail(&element, PALP_ERR_INPUT,
                                "needs a stiffness and a time above 0, and an exponent between 0 and 1");
    return status;
}

palp_status palp_model_covariance_read(const palp_json *root, const palp_material *material,
                                       double **covariance) {
    return read_square_matrix(root, "covariance", material, covariance);
}

palp_status palp_model_between_read(const palp_json *root, const palp_material *material, double **between,
                                    size_t *n_specimens) {
    static const char *const keys[] = {"count", "between"};
    palp_json specimens, count;
    double value = 0.0;
    *between = NULL;
    *n_specimens = 0;
    if (!palp_json_member(root, "specimens", &specimens))
        return PALP_OK;
    palp_status status = palp_json_keys(&specimens, 2, keys);
    if (!status)
        status = palp_json_require(&specimens, "count", &count);
    if (!status)
        status = palp_json_number(&count, &value);
    if (!status && (value < 2.0 || value > 1e6 || value != floor(value)))
        status = palp_json_fail(&count, PALP_ERR_INPUT, "must be a whole number of 2 or more");
    if (!status)
        status = read_square_matrix(&specimens, "between", material, between);
    if (!status && !*between)
        status = palp_json_fail(&specimens, PALP_ERR_INPUT, "has no \"between\"");
    *n_specimens = status ? 0 : (size_t)value;
    return status;
}

palp_status palp_model_unmeasured(size_t n, const double *covariance, const double *between,
                                  size_t n_specimens, double *total) {
    if (!covariance || !between || !total || n_specimens < 2)
        return PALP_ERR_ARGUMENT;
    double t = statistics_student_widening(n_specimens - 1);
    for (size_t i = 0; i < n * n; i++)
        total[i] = covariance[i] + t * t * between[i];
    return PALP_OK;
}
