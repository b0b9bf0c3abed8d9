/* mesh_scale_cells.c: element factors with which the springs of hexahedral cells stand for an isotropic
 * solid. The derivation is in doc/numerics.md. */
#include "base/file.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Corner b of a cell is at x = b & 1, y = b >> 1 & 1, z = b >> 2. Two corners differ by a mask of 1 to 7: one
 * bit an edge, two bits the diagonal of a face, three that of the cell. */
enum { CORNERS = 8, MASKS = 8, BODY = 7, PAIRS = 28 };
const unsigned char mesh_gmsh_corner[] = {0, 1, 3, 2, 4, 5, 7, 6};

/* A symmetric tensor of fourth order: the axes of its components, and how often each occurs among the 81. */
enum { QUARTIC = 15 };
static const unsigned char component[QUARTIC][4] = {{0, 0, 0, 0}, {1, 1, 1, 1}, {2, 2, 2, 2}, {0, 0, 1, 1},
                                                    {0, 0, 2, 2}, {1, 1, 2, 2}, {0, 0, 0, 1}, {0, 0, 0, 2},
                                                    {0, 1, 1, 1}, {1, 1, 1, 2}, {0, 2, 2, 2}, {1, 2, 2, 2},
                                                    {0, 0, 1, 2}, {0, 1, 1, 2}, {0, 1, 2, 2}};
static const double times[QUARTIC] = {1, 1, 1, 6, 6, 6, 4, 4, 4, 4, 4, 4, 12, 12, 12};

/* Sweeps of the fit, until one takes next to nothing off the residual, or that is rounding. */
enum { SWEEPS = 200 };
static const double ENOUGH = 1e-3, EXACT = 1e-24;
static const double LEAST = 0.05; /* factor, of one for all elements by their share of cells */

typedef struct cell {
    double volume_m3;
    int32_t pair[PAIRS][2];
    int mask[PAIRS];
    double length[PAIRS], tensor[PAIRS][QUARTIC]; /* m; length n n n n */
    double factor[PAIRS], least[PAIRS];
} cell;

/* Cells that share an element at most: four an edge, two the diagonal of a face. */
static double most_cells(int mask) {
    static const double cells[MASKS] = {1, 4, 4, 2, 4, 2, 2, 1};
    return cells[mask];
}

static void measure_pair(const palp_mesh *mesh, cell *c, size_t i) {
    double n[3];
    c->length[i] = mesh_direction(mesh, c->pair[i], n);
    for (size_t j = 0; j < QUARTIC; j++) {
        const unsigned char *axis = component[j];
        c->tensor[i][j] = c->length[i] * n[axis[0]] * n[axis[1]] * n[axis[2]] * n[axis[3]];
    }
}

/* The six tetrahedra of a cell follow those of the cell before. */
static void measure(const palp_mesh *mesh, size_t index, cell *c) {
    const int32_t *node = mesh->hexahedra + CORNERS * index;
    size_t i = 0;
    for (int a = 0; a < CORNERS; a++)
        for (int b = a + 1; b < CORNERS; b++, i++) {
            c->pair[i][0] = node[mesh_gmsh_corner[a]];
            c->pair[i][1] = node[mesh_gmsh_corner[b]];
            c->mask[i] = a ^ b;
            measure_pair(mesh, c, i);
        }
    c->volume_m3 = 0.0;
    for (size_t t = 0; t < 6; t++)
        c->volume_m3 += mesh_volume6(mesh->x_m, mesh->tetrahedra + 4 * (6 * index + t)) / 6.0;
}

/* Factors of a lattice of such boxes are constant[mask] + slope[mask] times that of the body's diagonals. */
static void box_family(double shear, const double square[3], double constant[MASKS], double slope[MASKS]) {
    const double body = pow(square[0] + square[1] + square[2], 1.5);
    for (int k = 0; k < 3; k++) {
        const double a = square[k], b = square[(k + 1) % 3], c = square[(k + 2) % 3];
        const double diagonal = pow(b + c, 1.5);
        constant[1 << k] = shear * (3.0 - a / b - a / c) / sqrt(a);
        slope[1 << k] = 4.0 * a * sqrt(a) / body;
        constant[BODY ^ (1 << k)] = shear * diagonal / (2.0 * b * c);
        slope[BODY ^ (1 << k)] = -2.0 * diagonal / body;
    }
    constant[BODY] = 0.0;
    slope[BODY] = 1.0;
}

static double smallest(const double constant[MASKS], const double slope[MASKS], double at) {
    double least = HUGE_VAL;
    for (int mask = 1; mask < BODY; mask++)
        least = fmin(least, constant[mask] + slope[mask] * at);
    return least;
}

/* Of the isotropic boxes of this family the one where the smallest factor of edges and diagonals of faces is
 * largest: there one that rises meets one that falls. More on the body's diagonals makes a lattice fold
 * sooner. */
static double best_body(const double constant[MASKS], const double slope[MASKS]) {
    double best = 0.0, most = -HUGE_VAL;
    for (int edge = 1; edge < BODY; edge *= 2)
        for (int face = 1; face < BODY; face *= 2) {
            const int across = BODY ^ face;
            double at = (constant[across] - constant[edge]) / (slope[edge] - slope[across]);
            double least = smallest(constant, slope, at);
            best = least > most ? at : best;
            most = fmax(most, least);
        }
    return best;
}

/* Those of the box with edges as long as the cell's are in the mean. */
static void start_from_box(cell *c, double area_m2) {
    double square[3] = {0.0}, constant[MASKS], slope[MASKS], uniform = 0.0;
    for (size_t i = 0; i < PAIRS; i++) {
        uniform += c->length[i] / most_cells(c->mask[i]);
        for (int k = 0; k < 3; k++)
            square[k] += c->mask[i] == 1 << k ? 0.25 * c->length[i] * c->length[i] : 0.0;
    }
    box_family(0.4 * c->volume_m3 / area_m2, square, constant, slope);
    const double body = best_body(constant, slope);
    for (size_t i = 0; i < PAIRS; i++) {
        const double cells = most_cells(c->mask[i]);
        c->least[i] = LEAST * 6.0 * c->volume_m3 / (area_m2 * uniform * cells);
        c->factor[i] = fmax(c->least[i], (constant[c->mask[i]] + slope[c->mask[i]] * body) / cells);
    }
}

static double square_of(const double *tensor) {
    double sum = 0.0;
    for (size_t j = 0; j < QUARTIC; j++)
        sum += times[j] * tensor[j] * tensor[j];
    return sum;
}

void mesh_sweep_factors(size_t n, size_t components, const double *count, const double *tensor,
                        const double *length, const double *least, double *factor, double *missing) {
    for (size_t i = 0; i < n; i++) {
        const double *own = tensor + components * i;
        double slope = 0.0;
        for (size_t j = 0; j < components; j++)
            slope += count[j] * own[j] * missing[j];
        double better = fmax(least[i], factor[i] + slope / (length[i] * length[i]));
        for (size_t j = 0; j < components; j++)
            missing[j] -= (better - factor[i]) * own[j];
        factor[i] = better;
    }
}

/* Least squares of the cell's stiffness less the solid's, lambda = mu = 2/5 K / area. */
static void fit(cell *c, double area_m2) {
    double missing[QUARTIC], solid[QUARTIC];
    for (size_t j = 0; j < QUARTIC; j++) {
        solid[j] = j < 6 ? (j < 3 ? 1.2 : 0.4) * c->volume_m3 / area_m2 : 0.0;
        missing[j] = solid[j];
        for (size_t i = 0; i < PAIRS; i++)
            missing[j] -= c->factor[i] * c->tensor[i][j];
    }
    double now = square_of(missing), before = HUGE_VAL, exact = EXACT * square_of(solid);
    for (int i = 0; i < SWEEPS && now > exact && before - now > ENOUGH * now; i++) {
        mesh_sweep_factors(PAIRS, QUARTIC, times, c->tensor[0], c->length, c->least, c->factor, missing);
        before = now;
        now = square_of(missing);
    }
}

palp_status mesh_scale_cells(palp_mesh *mesh, double area_m2, palp_error *error) {
    cell c;
    for (size_t index = 0; index < mesh->n_hexahedra; index++) {
        measure(mesh, index, &c);
        if (!(c.volume_m3 > 0.0 && isfinite(c.volume_m3 / area_m2)))
            return palp_error_set(error, PALP_ERR_INPUT, "hexahedron %zu of the mesh has no volume", index);
        start_from_box(&c, area_m2);
        fit(&c, area_m2);
        for (size_t i = 0; i < PAIRS; i++)
            mesh->scale[palp_mesh_element_between(mesh, c.pair[i][0], c.pair[i][1])] += c.factor[i];
    }
    return PALP_OK;
}

bool mesh_has_cells(const palp_mesh *mesh) {
    if (!mesh_is_all_hexahedra(mesh))
        return false;
    for (size_t i = 0; i < mesh->n_hexahedra; i++)
        for (int a = 0; a < CORNERS; a++)
            for (int b = 0; b < a; b++) {
                const int32_t *node = mesh->hexahedra + CORNERS * i;
                if (palp_mesh_element_between(mesh, node[a], node[b]) == mesh->n_elements)
                    return false;
            }
    return true;
}
