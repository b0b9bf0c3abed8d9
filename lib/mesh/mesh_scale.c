/* mesh_scale.c: element factors with which springs along a mesh of tetrahedra stand for an isotropic solid.
 */
#include "base/file.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A symmetric tensor of third order: the components, and how often each occurs among the 27. */
enum { CUBE = 10 };
static const unsigned char component[CUBE][3] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 1, 1}, {0, 1, 2},
                                                 {0, 2, 2}, {1, 1, 1}, {1, 1, 2}, {1, 2, 2}, {2, 2, 2}};
static const double times[CUBE] = {1, 3, 3, 3, 6, 3, 1, 3, 3, 1};

/* Factors are fitted in sweeps, until one brings next to nothing; none falls below a share of its first
 * guess. */
enum { SWEEPS = 200 };
static const double ENOUGH = 1e-4, LEAST = 0.2;
static const double SHORTEST = 0.2; /* element across a face, of the face's longest edge */

/* Volume; area[i] = three times the volume's derivative by corner i, i.e. volume times its shape function's
 * gradient is area[i] / 3. */
static double tetrahedron_volume_and_areas(const palp_mesh *mesh, const int32_t t[4], double area[4][3]) {
    const double *x = mesh->x_m;
    double u[3][3], volume = 0.0;
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            u[i][k] = x[3 * (size_t)t[i + 1] + k] - x[3 * (size_t)t[0] + k];
    for (size_t k = 0; k < 3; k++)
        area[0][k] = 0.0;
    for (size_t i = 0; i < 3; i++) {
        const double *v = u[(i + 1) % 3], *w = u[(i + 2) % 3];
        for (size_t k = 0; k < 3; k++) {
            area[i + 1][k] = 0.5 * (v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3]);
            area[0][k] -= area[i + 1][k];
            volume += i == 0 ? u[0][k] * area[1][k] / 3.0 : 0.0;
        }
    }
    return volume;
}

double mesh_volume(const palp_mesh *mesh, double *node_m3) {
    double total = 0.0, area[4][3];
    for (size_t i = 0; i < mesh->n_nodes && node_m3; i++)
        node_m3[i] = 0.0;
    for (size_t i = 0; i < mesh->n_tetrahedra; i++) {
        const int32_t *t = mesh->tetrahedra + 4 * i;
        double volume = tetrahedron_volume_and_areas(mesh, t, area);
        total += volume;
        for (size_t c = 0; c < 4 && node_m3; c++)
            node_m3[t[c]] += 0.25 * volume;
    }
    return total;
}

/* The corner of b that is none of a's. */
static int32_t corner_of_other_tetrahedron(const int32_t a[4], const int32_t b[4]) {
    for (size_t i = 0; i < 4; i++)
        if (b[i] != a[0] && b[i] != a[1] && b[i] != a[2] && b[i] != a[3])
            return b[i];
    return b[0];
}

bool mesh_nodes_across_face(const palp_mesh *mesh, const int32_t *neighbour, size_t i, size_t f,
                            int32_t pair[2]) {
    const int32_t *t = mesh->tetrahedra + 4 * i;
    int32_t beyond = neighbour[4 * i + f], face[3];
    double n[3], longest = 0.0;
    if (beyond < 0 || (size_t)beyond < i)
        return false;
    mesh_face(t, f, face);
    for (size_t k = 0; k < 3; k++)
        longest = fmax(longest, mesh_direction(mesh, (int32_t[]){face[k], face[(k + 1) % 3]}, n));
    int32_t a = t[f], b = corner_of_other_tetrahedron(t, mesh->tetrahedra + 4 * (size_t)beyond);
    pair[0] = a < b ? a : b;
    pair[1] = a < b ? b : a;
    return mesh_direction(mesh, pair, n) > SHORTEST * longest;
}

static palp_status add_pairs_across_faces(palp_mesh *mesh, const int32_t *neighbour) {
    size_t n = mesh->n_elements;
    int32_t *pairs = malloc(2 * (n + 2 * mesh->n_tetrahedra) * sizeof *pairs);
    if (!pairs)
        return PALP_ERR_NO_MEMORY;
    memcpy(pairs, mesh->pairs, 2 * n * sizeof *pairs);
    for (size_t i = 0; i < 4 * mesh->n_tetrahedra; i++)
        n += mesh_nodes_across_face(mesh, neighbour, i / 4, i % 4, pairs + 2 * n);
    free(mesh->pairs);
    mesh->pairs = pairs;
    mesh->order = NULL;
    mesh->n_elements = mesh_pairs_unique(n, pairs);
    return PALP_OK;
}

static const unsigned char edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* Is every edge of a tetrahedron an element? */
static bool are_all_edges_elements(const palp_mesh *mesh) {
    for (size_t i = 0; i < 6 * mesh->n_tetrahedra; i++) {
        const int32_t *t = mesh->tetrahedra + 4 * (i / 6);
        if (palp_mesh_element_between(mesh, t[edge[i % 6][0]], t[edge[i % 6][1]]) == mesh->n_elements)
            return false;
    }
    return true;
}

/* Volume of the tetrahedra around each element, or beside the face it crosses. */
static void gather_volumes(const palp_mesh *mesh, const int32_t *neighbour, double *around) {
    double area[4][3];
    int32_t pair[2];
    memset(around, 0, mesh->n_elements * sizeof *around);
    for (size_t i = 0; i < mesh->n_tetrahedra; i++) {
        const int32_t *t = mesh->tetrahedra + 4 * i;
        double volume = tetrahedron_volume_and_areas(mesh, t, area);
        for (size_t k = 0; k < 6; k++)
            around[palp_mesh_element_between(mesh, t[edge[k][0]], t[edge[k][1]])] += volume;
        for (size_t f = 0; f < 4 && neighbour; f++)
            if (mesh_nodes_across_face(mesh, neighbour, i, f, pair))
                around[palp_mesh_element_between(mesh, pair[0], pair[1])] +=
                    volume + tetrahedron_volume_and_areas(
                                 mesh, mesh->tetrahedra + 4 * (size_t)neighbour[4 * i + f], area);
    }
}

static void cubic_moments_of_direction(const double n[3], double w[CUBE]) {
    for (size_t j = 0; j < CUBE; j++)
        w[j] = n[component[j][0]] * n[component[j][1]] * n[component[j][2]];
}

/* Takes off the forces that the solid, strained evenly, puts on its nodes: a third of stress times area on
 * each corner, of which lambda = mu = 2/5 E make a symmetric tensor. */
static void subtract_solid(const palp_mesh *mesh, double area_m2, double *unbalance) {
    double area[4][3];
    for (size_t i = 0; i < 4 * mesh->n_tetrahedra; i++) {
        if (i % 4 == 0)
            tetrahedron_volume_and_areas(mesh, mesh->tetrahedra + i, area);
        const double *a = area[i % 4];
        double *r = unbalance + CUBE * (size_t)mesh->tetrahedra[i];
        for (size_t j = 0; j < CUBE; j++) {
            const unsigned char *c = component[j];
            double sum = (c[1] == c[2] ? a[c[0]] : 0.0) + (c[0] == c[2] ? a[c[1]] : 0.0) +
                         (c[0] == c[1] ? a[c[2]] : 0.0);
            r[j] -= 0.4 / 3.0 * sum / area_m2;
        }
    }
}

static void add_element_to_unbalance(const palp_mesh *mesh, size_t i, double factor, const double w[CUBE],
                                     double *unbalance) {
    double *a = unbalance + CUBE * (size_t)mesh->pairs[2 * i],
           *b = unbalance + CUBE * (size_t)mesh->pairs[2 * i + 1];
    for (size_t j = 0; j < CUBE; j++) {
        a[j] -= factor * w[j];
        b[j] += factor * w[j];
    }
}

static double weighted_unbalance_norm(size_t n_nodes, const double *weight, const double *unbalance) {
    double sum = 0.0;
    for (size_t i = 0; i < CUBE * n_nodes; i++)
        sum += weight[i / CUBE] * times[i % CUBE] * unbalance[i] * unbalance[i];
    return sum;
}

/* Each element in turn takes the factor that is best for its two nodes: coordinate descent on the weighted
 * least squares; the squares of cubic_moments_of_direction add up to 1. */
static void minimize_factors_in_turn(palp_mesh *mesh, const double *weight, const double *least,
                                     double *unbalance) {
    double n[3], w[CUBE];
    for (size_t i = 0; i < mesh->n_elements; i++) {
        const size_t first = (size_t)mesh->pairs[2 * i], second = (size_t)mesh->pairs[2 * i + 1];
        const double *a = unbalance + CUBE * first, *b = unbalance + CUBE * second;
        double slope = 0.0;
        mesh_direction(mesh, mesh->pairs + 2 * i, n);
        cubic_moments_of_direction(n, w);
        for (size_t j = 0; j < CUBE; j++)
            slope += times[j] * w[j] * (weight[second] * b[j] - weight[first] * a[j]);
        double old = mesh->scale[i];
        mesh->scale[i] = fmax(least[i], old - slope / (weight[first] + weight[second]));
        add_element_to_unbalance(mesh, i, mesh->scale[i] - old, w, unbalance);
    }
}

/* All by one factor, so that an even change of size takes the energy that it takes the solid. */
static void match_energy_of_solid(palp_mesh *mesh, double area_m2) {
    double sum = 0.0, n[3];
    for (size_t i = 0; i < mesh->n_elements; i++)
        sum += mesh->scale[i] * mesh_direction(mesh, mesh->pairs + 2 * i, n);
    double share = 6.0 * mesh_volume(mesh, NULL) / (sum * area_m2);
    for (size_t i = 0; i < mesh->n_elements; i++)
        mesh->scale[i] *= share;
}

static palp_status fit_factors_to_continuum(palp_mesh *mesh, double area_m2) {
    double *unbalance = calloc(CUBE * mesh->n_nodes, sizeof *unbalance);
    double *weight =
        malloc(mesh->n_nodes * sizeof *weight); /* of a node: 1 / its volume^(4/3), as of stress */
    double *least = malloc(mesh->n_elements * sizeof *least), n[3], w[CUBE];
    bool ok = unbalance && weight && least;
    if (ok)
        subtract_solid(mesh, area_m2, unbalance);
    for (size_t i = 0; i < mesh->n_elements && ok; i++) {
        least[i] = LEAST * mesh->scale[i];
        mesh_direction(mesh, mesh->pairs + 2 * i, n);
        cubic_moments_of_direction(n, w);
        add_element_to_unbalance(mesh, i, mesh->scale[i], w, unbalance);
    }
    double total = ok ? mesh_volume(mesh, weight) : 0.0;
    for (size_t i = 0; i < mesh->n_nodes && ok; i++)
        weight[i] = pow(weight[i] / total, -4.0 / 3.0);
    double now = ok ? weighted_unbalance_norm(mesh->n_nodes, weight, unbalance) : 0.0, before = HUGE_VAL;
    for (int i = 0; i < SWEEPS && ok && before - now > ENOUGH * now; i++) {
        minimize_factors_in_turn(mesh, weight, least, unbalance);
        before = now;
        now = weighted_unbalance_norm(mesh->n_nodes, weight, unbalance);
    }
    if (ok)
        match_energy_of_solid(mesh, area_m2);
    free(unbalance);
    free(weight);
    free(least);
    return ok ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* In proportion to volume over length. */
static palp_status scale_by_volume(palp_mesh *mesh, double area_m2, palp_error *error) {
    double n[3];
    for (size_t i = 0; i < mesh->n_elements; i++) {
        mesh->scale[i] /= mesh_direction(mesh, mesh->pairs + 2 * i, n) * area_m2;
        if (!(mesh->scale[i] > 0.0 && isfinite(mesh->scale[i])))
            return palp_error_set(
                error, PALP_ERR_INPUT,
                "the element between nodes %ld and %ld belongs to no tetrahedron with a volume",
                (long)mesh->pairs[2 * i], (long)mesh->pairs[2 * i + 1]);
    }
    match_energy_of_solid(mesh, area_m2);
    return PALP_OK;
}

static palp_status scale_tetrahedra(palp_mesh *mesh, palp_mesh_scaling scaling, double area_m2,
                                    palp_error *error) {
    bool continuum = scaling == PALP_SCALING_CONTINUUM;
    int32_t *neighbour = continuum ? malloc(4 * mesh->n_tetrahedra * sizeof *neighbour) : NULL;
    palp_status status = continuum && !neighbour ? PALP_ERR_NO_MEMORY : PALP_OK;
    if (!status && continuum)
        status = mesh_neighbours(mesh, neighbour);
    if (!status && continuum)
        status = add_pairs_across_faces(mesh, neighbour);
    if (!status)
        mesh->scale = arena_take(&mesh->memory, mesh->n_elements, sizeof *mesh->scale);
    if (!status && !mesh->scale)
        status = PALP_ERR_NO_MEMORY;
    if (!status)
        gather_volumes(mesh, neighbour, mesh->scale);
    free(neighbour);
    if (status)
        return palp_error_set(error, status, "scaling of the mesh: %s", palp_status_text(status));
    status = scale_by_volume(mesh, area_m2, error);
    if (!status && continuum && fit_factors_to_continuum(mesh, area_m2))
        status = palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    return status;
}

static palp_status scale_hexahedra(palp_mesh *mesh, double area_m2, palp_error *error) {
    mesh->scale = arena_take(&mesh->memory, mesh->n_elements, sizeof *mesh->scale);
    if (!mesh->scale)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    palp_status status = mesh_scale_cells(mesh, area_m2, error);
    if (!status)
        match_energy_of_solid(mesh, area_m2);
    return status;
}

/* Volume over height. */
static double mean_cross_section(const palp_mesh *mesh) {
    double low[3], high[3];
    palp_mesh_bounds(mesh, low, high);
    return mesh_volume(mesh, NULL) / (high[1] - low[1]);
}

palp_status palp_mesh_scale(palp_mesh *mesh, palp_mesh_scaling scaling, double area_m2, palp_error *error) {
    if (!mesh || mesh->scale || (unsigned)scaling > PALP_SCALING_CONTINUUM || !(area_m2 >= 0.0) ||
        !isfinite(area_m2))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "the mesh is scaled already, or the area is negative");
    if (scaling == PALP_SCALING_NONE)
        return PALP_OK;
    const bool cells = scaling == PALP_SCALING_CONTINUUM && mesh_has_cells(mesh);
    if (!cells && (mesh->n_tetrahedra == 0 || mesh->n_hexahedra > 0 || !are_all_edges_elements(mesh)))
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "scaling needs a mesh of tetrahedra with elements along their edges, or, as a "
                              "continuum, one of hexahedra with elements along all their diagonals");
    const double area = area_m2 > 0.0 ? area_m2 : mean_cross_section(mesh);
    palp_status status =
        cells ? scale_hexahedra(mesh, area, error) : scale_tetrahedra(mesh, scaling, area, error);
    if (status)
        mesh->scale = NULL;
    return status;
}

const double *palp_mesh_element_scale(const palp_mesh *mesh) {
    return mesh ? mesh->scale : NULL;
}
