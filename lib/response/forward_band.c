/* forward_band.c: the uncertainty of a model's force. */
#include "base/file.h"
#include "forward_internal.h"

#include <math.h>
#include <stdlib.h>

/* Variance of the force at sample i: g' C g with its derivatives by the first m parameters, columns of n. */
static double force_variance_at_sample(const double *gradient, const double *covariance, size_t n, size_t m,
                                       size_t i) {
    double sum = 0.0;
    for (size_t a = 0; a < m; a++)
        for (size_t b = 0; b < m; b++)
            sum += gradient[a * n + i] * covariance[a * m + b] * gradient[b * n + i];
    return fmax(sum, 0.0);
}

palp_status palp_forward_band(const palp_model *model, const palp_forward_run *run, const double *covariance,
                              double *force_N, double *sd_N, palp_error *error) {
    if (!model || !run || !covariance || !force_N || !sd_N)
        return palp_error_null(error);
    const size_t m = model->material.law.n + 2 * model->material.n_arms,
                 columns = palp_forward_parameter_count(model);
    double *gradient = malloc((run->n * columns + 1) * sizeof *gradient);
    if (!gradient)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    palp_status status = model->kind == PALP_MODEL_NETWORK
                             ? forward_network_force(model, run, force_N, gradient, error)
                             : palp_forward_force(model, run, force_N, gradient, error);
    for (size_t i = 0; i < run->n && !status; i++)
        sd_N[i] = sqrt(force_variance_at_sample(gradient, covariance, run->n, m, i));
    free(gradient);
    return status;
}
