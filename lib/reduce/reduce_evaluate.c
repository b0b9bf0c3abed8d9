/* reduce_evaluate.c: forces and tangent of a reduced model's elements. */
#include "base/dense.h"
#include "reduce_internal.h"

#include <math.h>
#include <string.h>

static const double COLLAPSED = -1.0 + 1e-9; /* strain of an element without length */

double reduced_coordinate(const palp_reduced *r, const double *q, double depth, size_t i) {
    return r->rest[i] + depth * r->lift[i] + dense_dot(r->modes, r->basis + i * r->modes, q);
}

static bool measure_reduced_elements(palp_reduced *r) {
    bool sound = true;
    for (size_t i = 0; i < 3 * r->n_elements; i++)
        r->direction[i] = r->gap_rest[i] + r->next.depth * r->gap_lift[i];
    dense_transposed_times(r->modes, 3 * r->n_elements, 1.0, r->gap, r->next.q, 1.0, r->direction);
    for (size_t i = 0; i < r->n_elements; i++) {
        double *d = r->direction + 3 * i;
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), inverse = 1.0 / length;
        r->strain[i] = length * r->inverse_rest[i] - 1.0;
        r->inverse_length[i] = inverse;
        d[0] *= inverse;
        d[1] *= inverse;
        d[2] *= inverse;
        sound = sound && r->strain[i] > COLLAPSED;
    }
    return sound;
}

bool reduced_evaluate(palp_reduced *r, double *drive) {
    if (!measure_reduced_elements(r))
        return false;
    element_trial(&r->material, &r->step, r->n_elements, r->strain, &r->now.history, &r->next.history,
                  r->force, r->tangent);
    *drive = 0.0;
    memset(r->rhs, 0, r->modes * sizeof *r->rhs);
    for (size_t i = 0; i < 3 * r->n_elements; i++) {
        r->vector[i] = -r->weight[i / 3] * r->force[i / 3] * r->direction[i];
        *drive -= r->vector[i] * r->gap_lift[i];
    }
    dense_times(r->modes, 3 * r->n_elements, 1.0, r->gap, r->vector, 0.0, r->rhs);
    return isfinite(*drive) && isfinite(dense_dot(r->modes, r->rhs, r->rhs));
}

/* scaled = (tangent / L0 n n' + force / L (1 - n n')) gap of one element, times its weight. */
static void apply_tangent_to_gap(const palp_reduced *r, size_t i, double *scaled) {
    const double *n = r->direction + 3 * i, *gap = r->gap + 3 * i * r->modes;
    double across = r->weight[i] * r->force[i] * r->inverse_length[i];
    double along = r->weight[i] * r->tangent[i] * r->inverse_rest[i] - across;
    for (size_t j = 0; j < r->modes; j++) {
        const double g[3] = {gap[j], gap[r->modes + j], gap[2 * r->modes + j]};
        double stretch = along * (n[0] * g[0] + n[1] * g[1] + n[2] * g[2]);
        for (size_t k = 0; k < 3; k++)
            scaled[k * r->modes + j] = stretch * n[k] + across * g[k];
    }
}

void reduced_stiffness(palp_reduced *r, size_t from, size_t to, double *stiffness) {
    for (size_t first = from; first < to && r->modes > 0; first += REDUCED_BLOCK) {
        size_t last = first + REDUCED_BLOCK < to ? first + REDUCED_BLOCK : to;
        size_t rows = 3 * (last - first), modes = r->modes;
        for (size_t i = first; i < last; i++)
            apply_tangent_to_gap(r, i, r->scaled + 3 * (i - first) * r->modes);
        dense_add_outer(modes, modes, rows, 1.0, r->scaled, modes, r->gap + 3 * first * modes, modes,
                        stiffness, modes);
    }
}
