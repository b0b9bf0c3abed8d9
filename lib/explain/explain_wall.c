/* explain_wall.c: a law that falls below a little of its stiffness before PALP_MODEL_STRAIN makes no model.
 */
#include "explain_fit.h"
#include "model/model_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 200 };
static const double MARGIN =
    1e-3; /* a polynomial stays off the end by it; a knot goes beyond, where its bound takes it back */

static double typical(const explain_data *data) {
    return data->peak * data->height / data->deepest;
}

static double place(int i) {
    return fmax(1e-6, PALP_MODEL_STRAIN * i / PLACES);
}

double explain_fit_wall(const explain_fit *fit, const explain_data *data) {
    const double low = EXPLAIN_SOFTEST * typical(data), sd = 1e-7 * typical(data);
    double stiffness, chi2 = 0.0;
    for (int i = 0; i <= PLACES; i++) {
        palp_law_stiffness(&fit->model.material.law, place(i), &stiffness, NULL);
        if (stiffness < low)
            chi2 += pow((low - stiffness) / sd, 2);
    }
    return chi2;
}

/* A polynomial at those places, of a spline, which is monotone between them, its knots; other laws are not
 * linear. */
palp_status explain_walls_find(const explain_fit *fit, const explain_data *data, levenberg_walls *walls) {
    const palp_law *law = &fit->model.material.law;
    const bool spline = law->kind == PALP_LAW_SPLINE;
    const size_t n = fit->n_columns, count = law->kind == PALP_LAW_POLYNOMIAL ? PLACES + 1
                                             : spline                         ? law->n
                                                                              : 0;
    *walls = (levenberg_walls){.count = count};
    if (count == 0)
        return PALP_OK;
    walls->row = calloc(count * (n + 1), sizeof *walls->row);
    if (!walls->row)
        return PALP_ERR_NO_MEMORY;
    walls->least = walls->row + count * n;
    for (size_t i = 0; i < count; i++) {
        double *row = walls->row + i * n, e = place((int)i);
        walls->least[i] = (spline ? 1.0 - MARGIN : 1.0 + MARGIN) * EXPLAIN_SOFTEST * typical(data);
        if (spline) {
            row[i] = 1.0;
            continue;
        }
        palp_law_gradient(law, e, row);
        for (size_t k = 0; k < law->n; k++)
            row[k] /= e;
    }
    return PALP_OK;
}
