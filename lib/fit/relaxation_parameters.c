/* relaxation_parameters.c: see relaxation_parameters.h. */
#include "relaxation_parameters.h"

#include <math.h>
#include <string.h>

static double time_of(const palp_arm *arm) {
    return arm->viscosity_Ns / arm->stiffness_N;
}

size_t relaxation_list(const palp_material *start, const palp_relaxation_settings *settings,
                       relaxation_parameter *list) {
    size_t n = 0, arms = start->n_arms;
    if (settings->fit_scale)
        list[n++] = (relaxation_parameter){RELAXATION_SCALE, 0, 0};
    for (size_t j = 0; j < arms; j++) {
        list[n++] = (relaxation_parameter){RELAXATION_STIFFNESS, j, j};
        list[n++] = (relaxation_parameter){RELAXATION_LOG_TIME, j, j};
    }
    for (size_t j = 0; j < (settings->one_beta ? 1 : arms); j++) {
        size_t last = settings->one_beta ? arms - 1 : j;
        if (settings->fit_beta)
            list[n++] = (relaxation_parameter){RELAXATION_BETA, j, last};
        if (settings->fit_gamma)
            list[n++] = (relaxation_parameter){RELAXATION_GAMMA, j, last};
    }
    return n;
}

void relaxation_first_guess(size_t n, const relaxation_parameter *list, const palp_material *start,
                            double *p) {
    for (size_t k = 0; k < n; k++) {
        const palp_arm *arm = &start->arms[list[k].first];
        switch (list[k].role) {
        case RELAXATION_SCALE:
            p[k] = 1.0;
            break;
        case RELAXATION_STIFFNESS:
            p[k] = arm->stiffness_N;
            break;
        case RELAXATION_LOG_TIME:
            p[k] = log(time_of(arm));
            break;
        case RELAXATION_BETA:
            p[k] = arm->beta;
            break;
        case RELAXATION_GAMMA:
            p[k] = arm->gamma;
            break;
        }
    }
}

/* *time: of the arm, whose viscosity follows later. */
static void set_arm(relaxation_role role, double value, palp_arm *arm, double *time) {
    if (role == RELAXATION_STIFFNESS)
        arm->stiffness_N = value;
    else if (role == RELAXATION_LOG_TIME)
        *time = exp(value);
    else if (role == RELAXATION_BETA)
        arm->beta = value;
    else
        arm->gamma = value;
}

palp_status relaxation_material(size_t n, const relaxation_parameter *list, const palp_material *start,
                                const double *p, palp_material *material) {
    double time[PALP_ARMS_MAX];
    *material = *start;
    for (size_t j = 0; j < start->n_arms; j++)
        time[j] = time_of(&start->arms[j]);
    for (size_t k = 0; k < n; k++) {
        bool scale = list[k].role == RELAXATION_SCALE;
        if (scale && (!(p[k] > 0.0) || palp_law_scale(&start->law, p[k], &material->law)))
            return PALP_ERR_ARGUMENT;
        for (size_t j = list[k].first; !scale && j <= list[k].last; j++)
            set_arm(list[k].role, p[k], &material->arms[j], &time[j]);
    }
    for (size_t j = 0; j < start->n_arms; j++)
        material->arms[j].viscosity_Ns = time[j] * material->arms[j].stiffness_N;
    return palp_material_check(material, NULL);
}

size_t relaxation_bounds(size_t n, const relaxation_parameter *list, const palp_material *start,
                         double longest, double *row, double *floor) {
    size_t rows = 0;
    memset(row, 0, 2 * n * n * sizeof *row);
    for (size_t k = 0; k < n; k++) {
        const palp_arm *arm = &start->arms[list[k].first];
        row[rows * n + k] = 1.0;
        switch (list[k].role) {
        case RELAXATION_SCALE:
            floor[rows++] = 0.05;
            break;
        case RELAXATION_STIFFNESS:
            floor[rows++] = 1e-6 * arm->stiffness_N;
            break;
        case RELAXATION_LOG_TIME:
            floor[rows++] = log(fmin(1e-5 * longest, time_of(arm)));
            row[rows * n + k] = -1.0;
            floor[rows++] = -log(fmax(1e2 * longest, time_of(arm)));
            break;
        case RELAXATION_BETA:
        case RELAXATION_GAMMA:
            floor[rows++] = 0.0;
            break;
        }
    }
    return rows;
}
