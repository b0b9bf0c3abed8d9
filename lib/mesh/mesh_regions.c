/* mesh_regions.c: named parts of a mesh's volume, and how much of each element is in one. */
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PER_AXIS = 6, SAMPLES = PER_AXIS * PER_AXIS * PER_AXIS };

/* Barycentric coordinates of places spread evenly in a tetrahedron: those of a cube, coordinates sorted. Axes
 * begin at different parts of a step, so that no place is on a face. */
static void spread_places(double weight[SAMPLES][4]) {
    for (int i = 0; i < SAMPLES; i++) {
        const int step[3] = {i / (PER_AXIS * PER_AXIS), i / PER_AXIS % PER_AXIS, i % PER_AXIS};
        double u[3];
        for (int k = 0; k < 3; k++)
            u[k] = (step[k] + (2 * k + 1) / 6.0) / PER_AXIS;
        for (int k = 0; k < 3; k++)
            if (u[k % 2] < u[k % 2 + 1]) {
                const double lower = u[k % 2];
                u[k % 2] = u[k % 2 + 1];
                u[k % 2 + 1] = lower;
            }
        weight[i][0] = 1.0 - u[0];
        weight[i][1] = u[0] - u[1];
        weight[i][2] = u[1] - u[2];
        weight[i][3] = u[2];
    }
}

/* Mean over a tetrahedron. */
static double part_of_tetrahedron(const palp_mesh *mesh, const int32_t t[4], double weight[SAMPLES][4],
                                  palp_mesh_place *place, void *user) {
    double sum = 0.0;
    for (int i = 0; i < SAMPLES; i++) {
        double x[3] = {0.0};
        for (int c = 0; c < 4; c++)
            for (int k = 0; k < 3; k++)
                x[k] += weight[i][c] * mesh->x_m[3 * (size_t)t[c] + (size_t)k];
        const double part = place(user, x);
        sum += part > 0.0 ? fmin(part, 1.0) : 0.0;
    }
    return sum / SAMPLES;
}

palp_status palp_mesh_add_region(palp_mesh *mesh, const char *name, palp_mesh_place *place, void *user) {
    if (!mesh || !name || !name[0] || !place)
        return PALP_ERR_ARGUMENT;
    if (mesh->n_tetrahedra == 0)
        return PALP_ERR_UNSUPPORTED;
    double weight[SAMPLES][4], most = 0.0, *part = malloc(mesh->n_tetrahedra * sizeof *part);
    if (!part)
        return PALP_ERR_NO_MEMORY;
    spread_places(weight);
    for (size_t i = 0; i < mesh->n_tetrahedra; i++) {
        part[i] = part_of_tetrahedron(mesh, mesh->tetrahedra + 4 * i, weight, place, user);
        most = fmax(most, part[i]);
    }
    palp_status status = most > 0.0 ? mesh_take_region(mesh, name, part) : PALP_ERR_INPUT;
    free(part);
    return status;
}

/* ---- solids and elements ------------------------------------------------------------------------- */

size_t mesh_solids(const palp_mesh *mesh, size_t *corners, const int32_t **nodes) {
    const bool cells = mesh_is_all_hexahedra(mesh);
    *corners = cells ? 8 : 4;
    *nodes = cells ? mesh->hexahedra : mesh->tetrahedra;
    return cells ? mesh->n_hexahedra : mesh->n_tetrahedra;
}

void mesh_parts_of_solids(const palp_mesh *mesh, const double *part, double *of_solid, double *volume) {
    const size_t each = mesh_is_all_hexahedra(mesh) ? 6 : 1;
    for (size_t i = 0; i < mesh->n_tetrahedra / each; i++) {
        double whole = 0.0, inside = 0.0;
        for (size_t t = each * i; t < each * (i + 1); t++) {
            const double own = mesh_volume6(mesh->x_m, mesh->tetrahedra + 4 * t) / 6.0;
            whole += own;
            inside += own * part[t];
        }
        of_solid[i] = inside / whole;
        if (volume)
            volume[i] = whole;
    }
}

/* Sums over the solids around each element. */
typedef struct sums {
    double *value, *volume; /* [n_elements] */
} sums;

static void add_to_element(const palp_mesh *mesh, int32_t a, int32_t b, double volume, double value,
                           sums *s) {
    const size_t e = palp_mesh_element_between(mesh, a, b);
    if (e == mesh->n_elements)
        return;
    s->volume[e] += volume;
    s->value[e] += volume * value;
}

static palp_status add_across_faces(const palp_mesh *mesh, const double *volume, const double *value,
                                    sums *s) {
    int32_t *neighbour = malloc(4 * mesh->n_tetrahedra * sizeof *neighbour), pair[2];
    palp_status status = neighbour ? mesh_neighbours(mesh, neighbour) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < 4 * mesh->n_tetrahedra && !status; i++)
        if (mesh_nodes_across_face(mesh, neighbour, i / 4, i % 4, pair)) {
            const size_t beside[2] = {i / 4, (size_t)neighbour[i]};
            for (int k = 0; k < 2; k++)
                add_to_element(mesh, pair[0], pair[1], volume[beside[k]], value[beside[k]], s);
        }
    free(neighbour);
    return status;
}

palp_status mesh_mean_around_elements(const palp_mesh *mesh, const double *of_solid, double *of_element) {
    size_t corners;
    const int32_t *node;
    const size_t n = mesh_solids(mesh, &corners, &node);
    double *volume = calloc(mesh->n_elements + n + mesh->n_tetrahedra + n, sizeof *volume);
    if (!volume)
        return PALP_ERR_NO_MEMORY;
    sums s = {of_element, volume + n};
    memset(of_element, 0, mesh->n_elements * sizeof *of_element);
    double *none = s.volume + mesh->n_elements;
    mesh_parts_of_solids(mesh, none, none + mesh->n_tetrahedra, volume);
    for (size_t i = 0; i < n; i++)
        for (size_t a = 0; a < corners; a++)
            for (size_t b = 0; b < a; b++)
                add_to_element(mesh, node[corners * i + a], node[corners * i + b], volume[i], of_solid[i],
                               &s);
    palp_status status = corners == 4 ? add_across_faces(mesh, volume, of_solid, &s) : PALP_OK;
    for (size_t e = 0; e < mesh->n_elements; e++)
        of_element[e] = s.volume[e] > 0.0 ? of_element[e] / s.volume[e] : 0.0;
    free(volume);
    return status;
}
