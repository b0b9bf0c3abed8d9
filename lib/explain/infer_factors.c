/* infer_factors.c: the material of one specimen from the population's, by the logarithms of its factors. */
#include "infer_internal.h"

#include <math.h>
#include <string.h>

double infer_law_factor(const double own[INFER_SPECIMEN]) {
    return exp(own[INFER_STIFFNESS] + own[INFER_LAW]);
}

double infer_law_sd(const infer_sizes *sizes) {
    return hypot(sizes->specimen[INFER_STIFFNESS], sizes->specimen[INFER_LAW]);
}

palp_status infer_specimen_material(const palp_material *population, const double own[INFER_SPECIMEN],
                                    palp_material *material) {
    const double stiffness = exp(own[INFER_STIFFNESS]), times = exp(own[INFER_TIMES]);
    *material = *population;
    for (size_t j = 0; j < material->n_arms; j++) {
        material->arms[j].stiffness_N *= stiffness;
        material->arms[j].viscosity_Ns *= stiffness * times;
    }
    return palp_law_scale(&population->law, infer_law_factor(own), &material->law);
}

void infer_specimen_slopes(const palp_material *m, size_t n, double *x) {
    const size_t step = m->law.kind == PALP_LAW_OGDEN ? 2 : 1; /* an exponent is all specimens' */
    memset(x, 0, INFER_SPECIMEN * n * sizeof *x);
    for (size_t k = 0; k < m->law.n; k += step)
        x[INFER_STIFFNESS * n + k] = x[INFER_LAW * n + k] = m->law.coefficients[k];
    for (size_t j = 0; j < m->n_arms; j++) {
        const size_t at = m->law.n + 2 * j;
        x[INFER_STIFFNESS * n + at] = m->arms[j].stiffness_N;
        x[INFER_STIFFNESS * n + at + 1] = x[INFER_TIMES * n + at + 1] = m->arms[j].viscosity_Ns;
    }
}

void infer_specimen_spread(const palp_material *m, const double *square, size_t n, double *into) {
    enum { S = INFER_SPECIMEN };
    double x[S * (PALP_LAW_MAX + 2 * PALP_ARMS_MAX)];
    infer_specimen_slopes(m, n, x);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            for (size_t a = 0; a < S * S; a++)
                into[i * n + j] += x[a / S * n + i] * square[a] * x[a % S * n + j];
}

void infer_specimen_variances(const infer_sizes *sizes, double share, double *square) {
    memset(square, 0, INFER_SPECIMEN * INFER_SPECIMEN * sizeof *square);
    for (size_t a = 0; a < INFER_SPECIMEN; a++)
        square[a * (INFER_SPECIMEN + 1)] = share * sizes->specimen[a] * sizes->specimen[a];
}
