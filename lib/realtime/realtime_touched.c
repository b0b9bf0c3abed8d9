/* realtime_touched.c: corrections where tools touch. Contact, stick and slip change with every correction, so
 * forces are evaluated after each, and conjugate gradients would have to restart. A tick therefore keeps its
 * directions and their products with the tissue's tangent, which hardly changes within a tick. The tools'
 * part is made anew. After a correction the residual is orthogonal to all directions (Galerkin's condition).
 * With a constant symmetric tangent this is conjugate gradients. The tangent need not be symmetric: sliding
 * friction follows the pressure. */
#include "base/dense.h"
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

/* Solves a x = b for x in place of b; a[m m] by columns is overwritten. No pivoting: pivot k is the curvature
 * of direction k after elimination of those before. False if a pivot is not positive. */
static bool solve_by_elimination(size_t m, double *a, double *b) {
    for (size_t k = 0; k < m; k++) {
        if (!(a[k + k * m] > 0.0))
            return false;
        for (size_t i = k + 1; i < m; i++) {
            const double factor = a[i + k * m] / a[k + k * m];
            for (size_t j = k + 1; j < m; j++)
                a[i + j * m] -= factor * a[k + j * m];
            b[i] -= factor * b[k];
        }
    }
    for (size_t k = m; k-- > 0;) {
        for (size_t j = k + 1; j < m; j++)
            b[k] -= a[k + j * m] * b[j];
        b[k] /= a[k + k * m];
    }
    return true;
}

/* Adds to the move what makes the residual orthogonal to all directions. False if that is not downhill. */
static bool move_along_kept_directions(palp_realtime *rt) {
    const size_t n = 3 * rt->net->n_nodes, m = rt->n_directions;
    double a[REALTIME_DIRECTIONS * REALTIME_DIRECTIONS], along[REALTIME_DIRECTIONS],
        size[REALTIME_DIRECTIONS], slope = 0.0;
    for (size_t i = 0; i < m; i++)
        memcpy(a + i * m, rt->curvature[i], m * sizeof *a);
    dense_transposed_times(n, m, 1.0, rt->direction, rt->r, 0.0, along);
    memcpy(size, along, m * sizeof *size);
    if (!solve_by_elimination(m, a, size))
        return false;
    for (size_t i = 0; i < m; i++)
        slope += along[i] * size[i];
    if (!(slope > 0.0))
        return false;
    dense_times(n, m, 1.0, rt->direction, size, 1.0, rt->move);
    dense_times(n, m, -1.0, rt->tangent, size, 1.0, rt->r);
    return true;
}

/* The whole tangent times direction i, with the tools as they are now. */
static void apply_tangent_to_direction(palp_realtime *rt, size_t i) {
    const size_t n = 3 * rt->net->n_nodes;
    memcpy(rt->tangent + i * n, rt->inner + i * n, n * sizeof *rt->tangent);
    realtime_add_touching(rt, true, rt->direction + i * n, rt->tangent + i * n);
}

/* Updates the kept directions for the tools as they are now, and moves along them. */
static void renew_and_use_directions(palp_realtime *rt) {
    const size_t m = rt->n_directions;
    double a[REALTIME_DIRECTIONS * REALTIME_DIRECTIONS];
    if (m == 0)
        return;
    for (size_t i = 0; i < m; i++)
        apply_tangent_to_direction(rt, i);
    dense_transposed_product(m, m, 3 * rt->net->n_nodes, rt->direction, rt->tangent, a);
    for (size_t i = 0; i < m; i++)
        memcpy(rt->curvature[i], a + i * m, m * sizeof *a);
    if (!move_along_kept_directions(rt))
        rt->n_directions = 0;
}

/* Adds rt->z / size as a direction; if there is no room, it replaces all others. */
static void keep_search_direction(palp_realtime *rt, double size) {
    const size_t n = 3 * rt->net->n_nodes,
                 last = rt->n_directions < REALTIME_DIRECTIONS ? rt->n_directions : 0;
    double *direction = rt->direction + last * n, row[REALTIME_DIRECTIONS];
    for (size_t i = 0; i < n; i++)
        direction[i] = rt->z[i] / size;
    realtime_tissue_times(rt, direction, rt->inner + last * n);
    apply_tangent_to_direction(rt, last);
    rt->n_directions = last + 1;
    dense_transposed_times(n, last + 1, 1.0, rt->direction, rt->tangent + last * n, 0.0, rt->curvature[last]);
    dense_transposed_times(n, last + 1, 1.0, rt->tangent, direction, 0.0, row);
    for (size_t i = 0; i < last; i++)
        rt->curvature[i][last] = row[i];
}

/* Forgets all but the last direction. */
static void keep_last_direction(palp_realtime *rt) {
    const size_t n = 3 * rt->net->n_nodes, last = rt->n_directions - 1;
    double *arrays[] = {rt->direction, rt->inner, rt->tangent};
    for (size_t i = 0; i < 3 && last > 0; i++)
        memcpy(arrays[i], arrays[i] + last * n, n * sizeof **arrays);
    rt->curvature[0][0] = rt->curvature[last][last];
    rt->n_directions = 1;
}

size_t realtime_solve_touched(palp_realtime *rt, size_t limit, double share) {
    const size_t n = 3 * rt->net->n_nodes;
    double square = network_dot(rt->r, rt->r, n), target = share * share * square;
    size_t done = 0;
    memset(rt->move, 0, n * sizeof *rt->move);
    realtime_touch(rt);
    renew_and_use_directions(rt);
    do {
        multigrid_apply(rt->mg, rt->r, rt->z);
        done++;
        square = network_dot(rt->r, rt->r, n);
        const double rz = network_dot(rt->r, rt->z, n);
        if (!(rz > 0.0) || isinf(rz))
            break;
        rt->error_ratio = sqrt(rz / square);
        keep_search_direction(rt, sqrt(rz));
        if (!move_along_kept_directions(rt)) {
            keep_last_direction(rt);
            if (!move_along_kept_directions(rt)) {
                rt->indefinite = true;
                rt->n_directions = 0;
                if (done == 1)
                    realtime_move_a_little(rt);
                break;
            }
        }
        square = network_dot(rt->r, rt->r, n);
    } while (done < limit && square > target);
    return done;
}
