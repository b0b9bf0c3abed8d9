/* network_solve.c: solves with the tangent of the last factor. Contact of tissue with tissue and ties join
 * any nodes: blocks between these are not in the factor, and conjugate gradients add them. */
#include "base/dense.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

static const double SHARE = 1e-8; /* of the right-hand side that conjugate gradients leave */
enum { MOST = 400 };              /* of their iterations */

palp_status network_make_far_room(palp_network *net, size_t more) {
    if (net->ranks)
        return PALP_ERR_UNSUPPORTED;
    network_far far = {.room = net->far.room + more};
    far.node = arena_take(&net->memory, 2 * far.room, sizeof *far.node);
    far.block = arena_take(&net->memory, 9 * far.room, sizeof *far.block);
    double **vector[] = {&far.residual, &far.direction, &far.near, &far.product};
    for (size_t i = 0; i < sizeof vector / sizeof *vector; i++)
        *vector[i] = arena_take(&net->memory, net->n_free, sizeof **vector[i]);
    if (net->memory.failed)
        return PALP_ERR_NO_MEMORY;
    net->far = far;
    return PALP_OK;
}

void network_keep_far_block(void *net, int32_t row, int32_t column, const double k[9]) {
    network_far *far = &((palp_network *)net)->far;
    if (far->n == far->room)
        return;
    far->node[2 * far->n] = row;
    far->node[2 * far->n + 1] = column;
    memcpy(far->block + 9 * far->n++, k, 9 * sizeof *k);
}

/* out += blocks u. */
static void multiply_far_blocks(const palp_network *net, const double *u, double *out) {
    for (size_t i = 0; i < net->far.n; i++) {
        const int32_t *row = net->dof + 3 * net->far.node[2 * i],
                      *column = net->dof + 3 * net->far.node[2 * i + 1];
        const double *k = net->far.block + 9 * i;
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                if (row[r] >= 0 && column[c] >= 0) {
                    out[row[r]] += k[3 * r + c] * u[column[c]];
                    out[column[c]] += k[3 * r + c] * u[row[r]];
                }
    }
}

/* Preconditioned by the factor P: with directions p = z + beta p, z = P^-1 r, follows P p = r + beta P p. */
void network_solve(palp_network *net, double *x) {
    const size_t n = net->n_free;
    network_far *f = &net->far;
    double before = 0.0, square;
    if (net->ranks) {
        net->ranks->solve(net->ranks, net, x);
        return;
    }
    if (f->n == 0) {
        linsys_solve(net->ls, x);
        return;
    }
    memcpy(f->residual, x, n * sizeof *x);
    memset(x, 0, n * sizeof *x);
    memset(f->direction, 0, n * sizeof *x);
    memset(f->near, 0, n * sizeof *x);
    square = dense_dot(n, f->residual, f->residual);
    const double enough = SHARE * SHARE * square;
    for (int i = 0; i < MOST && square > enough; i++) {
        memcpy(f->product, f->residual, n * sizeof *x);
        linsys_solve(net->ls, f->product);
        const double rz = dense_dot(n, f->residual, f->product), beta = i > 0 ? rz / before : 0.0;
        for (size_t k = 0; k < n; k++) {
            f->direction[k] = f->product[k] + beta * f->direction[k];
            f->near[k] = f->residual[k] + beta * f->near[k];
        }
        before = rz;
        memcpy(f->product, f->near, n * sizeof *x);
        multiply_far_blocks(net, f->direction, f->product);
        const double curvature = dense_dot(n, f->direction, f->product), alpha = rz / curvature;
        if (!isfinite(alpha) || (curvature <= 0.0 && rz >= 0.0))
            break;
        for (size_t k = 0; k < n; k++) {
            x[k] += alpha * f->direction[k];
            f->residual[k] -= alpha * f->product[k];
        }
        square = dense_dot(n, f->residual, f->residual);
    }
    if (before != 0.0 && dense_dot(n, x, x) == 0.0)
        memcpy(x, f->direction, n * sizeof *x);
}
