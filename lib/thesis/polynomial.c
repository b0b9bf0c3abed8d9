/* polynomial.c: the polynomials of Table 4.1. */
#include <palpate/thesis.h>

#include "base/dense.h"

#include <stdlib.h>

palp_status palp_thesis_polynomial(const palp_recording *rec, size_t degree, palp_law *law, double *norm) {
    if (!rec || !law || !norm)
        return PALP_ERR_ARGUMENT;
    size_t n = 0;
    double c[PALP_LAW_MAX];
    if (degree < 1 || degree > PALP_LAW_MAX)
        return PALP_ERR_ARGUMENT;
    double *strain = malloc(2 * rec->n * sizeof *strain), *force = strain + rec->n;
    if (!strain)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < rec->n; i++)
        if (rec->use[i] && rec->depth_m[i] > 0.0) {
            strain[n] = rec->depth_m[i] / rec->height_m;
            force[n++] = rec->force_N[i];
        }
    palp_status status = PALP_ERR_INPUT;
    if (n > degree)
        status = dense_polynomial(n, strain, force, 1, degree, c, norm);
    free(strain);
    return status ? status : palp_law_polynomial(degree, c, law);
}
