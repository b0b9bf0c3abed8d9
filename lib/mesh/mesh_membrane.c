/* mesh_membrane.c: widths with which springs along a surface's edges stand for an isotropic membrane. */
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A symmetric tensor of fourth order in the plane: how often each of its components occurs among the 16. */
enum { QUARTIC = 5, SPRINGS = 6, SWEEPS = 100 };
static const double times[QUARTIC] = {1, 4, 6, 4, 1};

/* Central forces in a plane have Poisson's ratio 1/3: C1111 = 9/8 and C1122 = C1212 = 3/8 of modulus times
 * thickness. */
static const double MEMBRANE[QUARTIC] = {1.125, 0.0, 0.375, 0.0, 1.125};
static const double FLAT = 0.999; /* cosine between the normals of two triangles that are one face */

/* A triangle, or two that are a flat quadrilateral with both diagonals. */
typedef struct patch {
    size_t n;
    double area, tensor[SPRINGS][QUARTIC], length[SPRINGS], width[SPRINGS];
    size_t element[SPRINGS];
} patch;

static void normal_of(const palp_mesh *mesh, const int32_t *t, double normal[3], double *area) {
    double u[3], v[3], square = 0.0;
    for (int k = 0; k < 3; k++) {
        u[k] = mesh->x_m[3 * (size_t)t[1] + (size_t)k] - mesh->x_m[3 * (size_t)t[0] + (size_t)k];
        v[k] = mesh->x_m[3 * (size_t)t[2] + (size_t)k] - mesh->x_m[3 * (size_t)t[0] + (size_t)k];
    }
    for (int k = 0; k < 3; k++) {
        normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        square += normal[k] * normal[k];
    }
    *area = 0.5 * sqrt(square);
    for (int k = 0; k < 3; k++)
        normal[k] /= sqrt(square);
}

/* Adds the spring between two nodes, in the frame of the first edge and the normal. */
static void add_spring(const palp_mesh *mesh, int32_t a, int32_t b, double frame[2][3], patch *p) {
    const size_t e = palp_mesh_element_between(mesh, a, b);
    double n[3], along[2] = {0.0};
    if (e == mesh->n_elements)
        return;
    p->element[p->n] = e;
    p->length[p->n] = mesh_direction(mesh, (int32_t[]){a, b}, n);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            along[i] += frame[i][k] * n[k];
    for (int j = 0; j < QUARTIC; j++)
        p->tensor[p->n][j] = p->length[p->n] * pow(along[0], QUARTIC - 1 - j) * pow(along[1], j);
    p->n++;
}

static void make_frame(const palp_mesh *mesh, const int32_t *t, const double normal[3], double frame[2][3]) {
    mesh_direction(mesh, (int32_t[]){t[0], t[1]}, frame[0]);
    for (int k = 0; k < 3; k++)
        frame[1][k] =
            normal[(k + 1) % 3] * frame[0][(k + 2) % 3] - normal[(k + 2) % 3] * frame[0][(k + 1) % 3];
}

/* Fits positive widths to the membrane's stiffness by least squares. Then scales all by one factor, so that
 * an even stretch takes the membrane's energy. */
static void fit_widths(patch *p) {
    static const double least[SPRINGS] = {0.0};
    double missing[QUARTIC], sum = 0.0;
    for (size_t i = 0; i < p->n; i++)
        sum += p->length[i];
    for (size_t i = 0; i < p->n; i++)
        p->width[i] = 3.0 * p->area / sum;
    for (int j = 0; j < QUARTIC; j++) {
        missing[j] = p->area * MEMBRANE[j];
        for (size_t i = 0; i < p->n; i++)
            missing[j] -= p->width[i] * p->tensor[i][j];
    }
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        mesh_sweep_factors(p->n, QUARTIC, times, p->tensor[0], p->length, least, p->width, missing);
    sum = 0.0;
    for (size_t i = 0; i < p->n; i++)
        sum += p->width[i] * p->length[i];
    for (size_t i = 0; i < p->n; i++)
        p->width[i] *= 3.0 * p->area / sum;
}

/* The triangle across edge k of triangle t that lies in its plane, if their opposite corners are joined;
 * n_triangles if there is none. */
static size_t other_half(const palp_mesh *mesh, const size_t *across, size_t t, int k, int32_t *corner) {
    const size_t other = across[3 * t + (size_t)k];
    double normal[2][3], area, cosine = 0.0;
    if (other == mesh->n_triangles)
        return other;
    const int32_t *own = mesh->triangles + 3 * t, *its = mesh->triangles + 3 * other;
    normal_of(mesh, own, normal[0], &area);
    normal_of(mesh, its, normal[1], &area);
    for (int i = 0; i < 3; i++)
        cosine += normal[0][i] * normal[1][i];
    for (int i = 0; i < 3; i++)
        if (its[i] != own[k] && its[i] != own[(k + 1) % 3])
            *corner = its[i];
    const bool joined = palp_mesh_element_between(mesh, own[(k + 2) % 3], *corner) < mesh->n_elements;
    return cosine > FLAT && joined ? other : mesh->n_triangles;
}

static int compare_edges(const void *left, const void *right) {
    const int32_t *a = left, *b = right;
    for (int i = 0; i < 2; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

/* across[3 n_triangles]: the triangle across the edge from corner k, or n_triangles. */
static palp_status find_across(const palp_mesh *mesh, size_t *across) {
    const size_t n = 3 * mesh->n_triangles;
    int32_t *edge = malloc(3 * n * sizeof *edge); /* lower node, higher node, edge */
    if (!edge)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        const int32_t *t = mesh->triangles + i - i % 3, a = t[i % 3], b = t[(i + 1) % 3];
        edge[3 * i] = a < b ? a : b;
        edge[3 * i + 1] = a < b ? b : a;
        edge[3 * i + 2] = (int32_t)i;
        across[i] = mesh->n_triangles;
    }
    qsort(edge, n, 3 * sizeof *edge, compare_edges);
    for (size_t i = 0; i + 1 < n; i++)
        if (compare_edges(edge + 3 * i, edge + 3 * (i + 1)) == 0) {
            across[edge[3 * i + 2]] = (size_t)edge[3 * i + 5] / 3;
            across[edge[3 * i + 5]] = (size_t)edge[3 * i + 2] / 3;
        }
    free(edge);
    return PALP_OK;
}

/* The patch of triangle t, with its other half if that is free. */
static void make_patch(const palp_mesh *mesh, const size_t *across, size_t t, unsigned char *done, patch *p) {
    const int32_t *node = mesh->triangles + 3 * t;
    double normal[3], frame[2][3], longest = 0.0, n[3];
    int32_t corner = -1;
    int edge = 0;
    *p = (patch){.n = 0};
    normal_of(mesh, node, normal, &p->area);
    make_frame(mesh, node, normal, frame);
    for (int k = 0; k < 3; k++) {
        const double length = mesh_direction(mesh, (int32_t[]){node[k], node[(k + 1) % 3]}, n);
        edge = length > longest ? k : edge;
        longest = fmax(longest, length);
        add_spring(mesh, node[k], node[(k + 1) % 3], frame, p);
    }
    done[t] = 1;
    const size_t other = other_half(mesh, across, t, edge, &corner);
    if (other == mesh->n_triangles || done[other])
        return;
    double area;
    normal_of(mesh, mesh->triangles + 3 * other, normal, &area);
    p->area += area;
    for (int k = 0; k < 3; k++) /* to the edge's ends, and across */
        add_spring(mesh, node[k], corner, frame, p);
    done[other] = 1;
}

palp_status mesh_membrane_widths(const palp_mesh *mesh, const unsigned char *listed, double *width) {
    size_t *across = malloc((3 * mesh->n_triangles + 1) * sizeof *across);
    unsigned char *done = calloc(mesh->n_triangles + 1, 1);
    palp_status status = across && done ? find_across(mesh, across) : PALP_ERR_NO_MEMORY;
    memset(width, 0, mesh->n_elements * sizeof *width);
    for (size_t t = 0; t < mesh->n_triangles && !status; t++)
        for (int k = 0; k < 3 && listed; k++)
            done[t] = done[t] || !listed[mesh->triangles[3 * t + (size_t)k]];
    for (size_t t = 0; t < mesh->n_triangles && !status; t++) {
        patch p;
        if (done[t])
            continue;
        make_patch(mesh, across, t, done, &p);
        fit_widths(&p);
        for (size_t i = 0; i < p.n; i++)
            width[p.element[i]] += p.width[i];
    }
    free(across);
    free(done);
    return status;
}
