/* solid_body.c: the body of a solid: supports, linear tetrahedra, the pattern of their matrix. */
#include "solid_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The node of a set that is nearest to a place, or farthest from it. */
static int32_t extreme(const palp_mesh *mesh, size_t n, const int32_t *nodes, const double at[2],
                       double sign) {
    const double *x = palp_mesh_positions(mesh);
    double best = INFINITY;
    int32_t found = nodes[0];
    for (size_t i = 0; i < n; i++) {
        const double *p = x + 3 * (size_t)nodes[i];
        const double off = sign * ((p[0] - at[0]) * (p[0] - at[0]) + (p[2] - at[1]) * (p[2] - at[1]));
        if (off < best) {
            best = off;
            found = nodes[i];
        }
    }
    return found;
}

palp_status palp_solid_supports(const palp_mesh *mesh, bool slides, unsigned char *held) {
    if (!mesh || !held)
        return PALP_ERR_ARGUMENT;
    size_t n_bottom, n_top;
    const int32_t *bottom, *top;
    palp_status status = palp_mesh_set(mesh, "bottom", &n_bottom, &bottom);
    status = status ? status : palp_mesh_set(mesh, "top", &n_top, &top);
    if (status)
        return status;
    const unsigned char plate = slides ? 2 : 7;
    memset(held, 0, palp_mesh_node_count(mesh));
    for (size_t i = 0; i < n_bottom; i++)
        held[bottom[i]] = plate;
    for (size_t i = 0; i < n_top; i++)
        held[top[i]] = plate | 8;
    if (slides) {
        double low[3], high[3];
        palp_mesh_bounds(mesh, low, high);
        const double middle[2] = {0.5 * (low[0] + high[0]), 0.5 * (low[2] + high[2])};
        const int32_t centre = extreme(mesh, n_bottom, bottom, middle, 1.0);
        const double *c = palp_mesh_positions(mesh) + 3 * (size_t)centre;
        const int32_t far = extreme(mesh, n_bottom, bottom, (double[]){c[0], c[2]}, -1.0);
        const double *f = palp_mesh_positions(mesh) + 3 * (size_t)far;
        held[centre] |= 5;
        held[far] |= fabs(f[0] - c[0]) > fabs(f[2] - c[2]) ? 4 : 1;
    }
    return PALP_OK;
}

/* Gradients of the shape functions at rest; returns the volume. */
static double shape_gradients(const double *x, const int32_t *nodes, double gradient[12]) {
    double e[3][3];
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            e[k][a] = x[3 * nodes[k + 1] + a] - x[3 * nodes[0] + a];
    double six = 0.0;
    for (int k = 0; k < 3; k++) {
        const double *p = e[(k + 1) % 3], *q = e[(k + 2) % 3];
        for (int a = 0; a < 3; a++)
            gradient[3 * (k + 1) + a] = p[(a + 1) % 3] * q[(a + 2) % 3] - p[(a + 2) % 3] * q[(a + 1) % 3];
    }
    for (int a = 0; a < 3; a++)
        six += e[0][a] * gradient[3 + a];
    for (int a = 0; a < 3; a++) {
        for (int k = 1; k < 4; k++)
            gradient[3 * k + a] /= six;
        gradient[a] = -gradient[3 + a] - gradient[6 + a] - gradient[9 + a];
    }
    return six / 6.0;
}

/* The lower triangle by columns: each pair of neighbours is an edge of a tetrahedron, or one node. */
static int by_size(const void *left, const void *right) {
    const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return (a > b) - (a < b);
}

static palp_status make_matrix(solid_body *body, size_t n_tetrahedra, const int32_t *tetrahedra) {
    const size_t n = body->n_unknowns;
    uint64_t *key = malloc((144 * n_tetrahedra + 1) * sizeof *key);
    size_t *column = calloc(n + 1, sizeof *column), count = 0, kept = 0;
    if (!key || !column) {
        free(key);
        free(column);
        return PALP_ERR_NO_MEMORY;
    }
    for (size_t t = 0; t < n_tetrahedra; t++) {
        for (int i = 0; i < 144; i++) {
            const int32_t *nodes = tetrahedra + 4 * t;
            const int32_t r = body->unknown[3 * nodes[i / 36] + i / 12 % 3],
                          c = body->unknown[3 * nodes[i % 12 / 3] + i % 3];
            if (c >= 0 && r >= c)
                key[count++] = (uint64_t)c << 32 | (uint64_t)r;
        }
    }
    qsort(key, count, sizeof *key, by_size);
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || key[i] != key[i - 1]) {
            key[kept++] = key[i];
            column[(key[i] >> 32) + 1]++;
        }
    }
    for (size_t c = 0; c < n; c++)
        column[c + 1] += column[c];
    int32_t *row = malloc((kept + 1) * sizeof *row);
    palp_status status = row ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; row && i < kept; i++)
        row[i] = (int32_t)(key[i] & 0x7fffffff);
    if (!status)
        status = linsys_create(PALP_SOLVER_AUTO, n, column, row, &body->matrix);
    for (size_t t = 0; !status && t < n_tetrahedra; t++) {
        for (size_t i = 0; i < 144; i++) {
            const int32_t *nodes = tetrahedra + 4 * t;
            const int32_t r = body->unknown[3 * nodes[i / 36] + (int)(i / 12 % 3)],
                          c = body->unknown[3 * nodes[i % 12 / 3] + (int)(i % 3)];
            body->slot[144 * t + i] =
                c >= 0 && r >= c ? linsys_slot(body->matrix, (size_t)r, (size_t)c) : SIZE_MAX;
        }
    }
    free(key);
    free(column);
    free(row);
    return status;
}

palp_status solid_body_create(const palp_mesh *mesh, bool slides, solid_body *body) {
    const size_t n = palp_mesh_node_count(mesh), m = palp_mesh_tetrahedron_count(mesh);
    const int32_t *tetrahedra = palp_mesh_tetrahedra(mesh);
    *body = (solid_body){.mesh = mesh};
    if (m == 0)
        return PALP_ERR_UNSUPPORTED;
    body->held = malloc(n);
    body->unknown = malloc(3 * n * sizeof(int32_t));
    body->gradient = malloc(12 * m * sizeof(double));
    body->volume_m3 = malloc(m * sizeof(double));
    body->slot = malloc(144 * m * sizeof(size_t));
    body->x = malloc(3 * n * sizeof(double));
    body->before = malloc(3 * n * sizeof(double));
    body->residual = malloc(3 * n * sizeof(double));
    body->rate = malloc(3 * n * sizeof(double));
    body->force = malloc(3 * n * sizeof(double));
    body->work = malloc(6 * n * sizeof(double));
    if (!body->held || !body->unknown || !body->gradient || !body->volume_m3 || !body->slot || !body->x ||
        !body->before || !body->residual || !body->rate || !body->force || !body->work)
        return PALP_ERR_NO_MEMORY;
    palp_status status = palp_solid_supports(mesh, slides, body->held);
    if (status)
        return status;
    for (size_t i = 0; i < 3 * n; i++)
        body->unknown[i] = body->held[i / 3] >> (i % 3) & 1 ? -1 : (int32_t)body->n_unknowns++;
    for (size_t t = 0; t < m; t++)
        body->volume_m3[t] =
            shape_gradients(palp_mesh_positions(mesh), tetrahedra + 4 * t, body->gradient + 12 * t);
    return body->n_unknowns > 0 ? make_matrix(body, m, tetrahedra) : PALP_ERR_UNSUPPORTED;
}

void solid_body_free(solid_body *body) {
    linsys_free(body->matrix);
    free(body->held);
    free(body->unknown);
    free(body->gradient);
    free(body->volume_m3);
    free(body->slot);
    free(body->x);
    free(body->before);
    free(body->residual);
    free(body->rate);
    free(body->force);
    free(body->work);
    *body = (solid_body){0};
}
