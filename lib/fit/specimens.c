/* specimens.c: what a fit of several specimens says of the stiffness. */
#include "base/file.h"
#include "base/statistics.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void palp_specimens_fit_free(palp_specimens_fit *fit) {
    if (!fit)
        return;
    palp_lumped_fit_free(&fit->mean);
    free(fit->own);
    free(fit->factor);
    free(fit->between);
    free(fit->within);
    memset(fit, 0, sizeof *fit);
}

/* ---- K(e) ---- */

/* Sd of K at the strain by another covariance. */
static palp_status sd_by(const palp_specimens_fit *fit, double *covariance, double strain, double *stiffness,
                         double *sd) {
    palp_lumped_fit other = fit->mean;
    other.covariance = covariance;
    return palp_lumped_fit_stiffness(&other, 1, &strain, stiffness, sd);
}

palp_status palp_specimens_fit_stiffness(const palp_specimens_fit *fit, size_t n, const double *strain,
                                         palp_specimens_point *point) {
    if (!fit || !strain || !point || fit->n_specimens < 2)
        return PALP_ERR_ARGUMENT;
    const size_t freedom = fit->n_specimens - 1;
    const double t = statistics_student_widening(freedom);
    const double most = (double)freedom / statistics_chi2_quantile(freedom, 0.025);
    const double least = (double)freedom / statistics_chi2_quantile(freedom, 0.975);
    palp_status status = PALP_OK;
    for (size_t i = 0; i < n && !status; i++) {
        palp_specimens_point *at = &point[i];
        status = sd_by(fit, fit->mean.covariance, strain[i], &at->stiffness_N, &at->sd_N);
        if (!status)
            status = sd_by(fit, fit->between, strain[i], &at->stiffness_N, &at->between_N);
        if (!status)
            status = sd_by(fit, fit->within, strain[i], &at->stiffness_N, &at->within_N);
        double own = at->within_N * at->within_N, both = at->between_N * at->between_N + own;
        at->between_low = sqrt(fmax(least * both - own, 0.0));
        at->between_high = sqrt(fmax(most * both - own, 0.0));
        if (fit->high > 0.0) {
            at->between_low = fit->low * at->between_N;
            at->between_high = fit->high * at->between_N;
        }
        at->new_sd_N = hypot(at->sd_N, (fit->n_spread ? t : 1.0) * at->between_N);
    }
    return status;
}
