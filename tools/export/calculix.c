/* calculix.c: a network as a CalculiX deck: SPRINGA elements with force-elongation tables. */
#include "calculix.h"

#include <math.h>
#include <stdlib.h>

enum { HALF_MAX = (CALCULIX_POINTS_MAX + 1) / 2, GAUSS = 5 };

/* Sorts elements by rest length and factor. */
typedef struct spring {
    double length_m, factor;
    int32_t a, b;
} spring;

/* ---- the table ---- */

static void mass_and_load(const palp_law *law, size_t n, const double *strain, double *diagonal,
                          double *upper, double *load) {
    static const double x[GAUSS] = {-0.90617984593866399, -0.53846931010568309, 0, 0.53846931010568309,
                                    0.90617984593866399};
    static const double w[GAUSS] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889,
                                    0.47862867049936647, 0.23692688505618909};
    for (size_t i = 0; i < n; i++)
        diagonal[i] = load[i] = 0;
    for (size_t i = 0; i + 1 < n; i++) {
        double h = strain[i + 1] - strain[i], e[GAUSS], force[GAUSS];
        for (int k = 0; k < GAUSS; k++)
            e[k] = strain[i] + 0.5 * (x[k] + 1) * h;
        palp_law_force(law, GAUSS, e, force, NULL, NULL);
        for (int k = 0; k < GAUSS; k++) {
            double t = 0.5 * (x[k] + 1);
            load[i] += 0.5 * h * w[k] * force[k] * (1 - t);
            load[i + 1] += 0.5 * h * w[k] * force[k] * t;
        }
        diagonal[i] += h / 3;
        diagonal[i + 1] += h / 3;
        upper[i] = h / 6;
    }
}

void calculix_table(const palp_law *law, size_t n, const double *strain, double *force_N) {
    double diagonal[HALF_MAX], upper[HALF_MAX] = {0}, load[HALF_MAX];
    mass_and_load(law, n, strain, diagonal, upper, load);
    for (size_t i = 2; i < n; i++) { /* force_N[0] = 0 removes row and column 0 */
        double q = upper[i - 1] / diagonal[i - 1];
        diagonal[i] -= q * upper[i - 1];
        load[i] -= q * load[i - 1];
    }
    force_N[n - 1] = load[n - 1] / diagonal[n - 1];
    for (size_t i = n - 2; i > 0; i--)
        force_N[i] = (load[i] - upper[i] * force_N[i + 1]) / diagonal[i];
    force_N[0] = 0;
}

/* ---- the deck ---- */

static int by_length(const void *left, const void *right) {
    const spring *p = left, *q = right;
    if (p->length_m != q->length_m)
        return p->length_m < q->length_m ? -1 : 1;
    if (p->factor != q->factor)
        return p->factor < q->factor ? -1 : 1;
    return p->a != q->a ? (p->a > q->a) - (p->a < q->a) : (p->b > q->b) - (p->b < q->b);
}

static spring *springs(const palp_mesh *mesh, const double *factor, size_t n) {
    const double *x = palp_mesh_positions(mesh);
    const int32_t *pairs = palp_mesh_pairs(mesh);
    spring *list = malloc(n * sizeof *list);
    for (size_t i = 0; list && i < n; i++) {
        const double *p = &x[3 * (size_t)pairs[2 * i]], *q = &x[3 * (size_t)pairs[2 * i + 1]];
        double length = sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                             (p[2] - q[2]) * (p[2] - q[2]));
        list[i] = (spring){length, factor ? factor[i] : 1, pairs[2 * i], pairs[2 * i + 1]};
    }
    return list;
}

static void write_nodes(const palp_mesh *mesh, FILE *to) {
    const double *x = palp_mesh_positions(mesh);
    size_t n = palp_mesh_node_count(mesh);
    fputs("*NODE\n", to);
    for (size_t i = 0; i < n; i++)
        fprintf(to, "%zu,%.15g,%.15g,%.15g\n", i + 1, 1e3 * x[3 * i], 1e3 * x[3 * i + 1], 1e3 * x[3 * i + 2]);
}

static void write_table(const calculix_deck *deck, const double *strain, const double *force_N,
                        const spring *element, FILE *to) {
    size_t half = deck->table_points / 2;
    for (size_t i = 0; i < deck->table_points; i++) {
        size_t k = i < half ? half - i : i - half;
        double sign = i < half ? -1 : 1;
        fprintf(to, "%.12e,%.12e,0.\n", sign * element->factor * force_N[k],
                sign * 1e3 * strain[k] * element->length_m);
    }
}

/* Writes an element set and a table for each rest length and factor, within rounding. */
static palp_status write_springs(const calculix_deck *deck, FILE *to) {
    double strain[HALF_MAX], force_N[HALF_MAX];
    size_t half = deck->table_points / 2, n = palp_mesh_element_count(deck->mesh), group = 0;
    spring *list = springs(deck->mesh, deck->factor, n);
    if (!list)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i <= half; i++)
        strain[i] = deck->table_strain * (double)i / (double)half;
    calculix_table(deck->law, half + 1, strain, force_N);
    qsort(list, n, sizeof *list, by_length);
    for (size_t first = 0, i; first < n; first = i) {
        fprintf(to, "*ELEMENT,TYPE=SPRINGA,ELSET=LENGTH%zu\n", ++group);
        for (i = first; i < n && list[i].length_m <= list[first].length_m * (1 + 1e-9) &&
                        list[i].factor == list[first].factor;
             i++) {
            fprintf(to, "%zu,%d,%d\n", i + 1, list[i].a + 1, list[i].b + 1);
        }
        fprintf(to, "*SPRING,ELSET=LENGTH%zu,NONLINEAR\n", group);
        write_table(deck, strain, force_N, &list[first], to);
    }
    free(list);
    return PALP_OK;
}

/* Solids of the energy k (J - 1 - ln J) per volume, from two terms (mu, alpha, nu) of a hyperfoam. A term is
 * 2 mu / alpha^2 (sum of l^alpha - 3 + (J^(-alpha b) - 1) / b), with the stretches l and b = nu / (1 - 2 nu).
 * With mu -+k / 2 and alpha 1 the sums cancel; b = -1 leaves k (J - 1), b near 0 leaves -k ln J. A cell has
 * one point of integration, as it has one J here. */
static void write_solid_group(size_t group, double modulus_Pa, FILE *to) {
    const double mu_MPa = 0.5e-6 * modulus_Pa;
    fprintf(to,
            "*MATERIAL,NAME=VOLUME%zu\n*HYPERFOAM,N=2\n%.12g,1.,%.12g,1.,1.,1e-6\n"
            "*SOLID SECTION,ELSET=SOLIDS%zu,MATERIAL=VOLUME%zu\n",
            group, -mu_MPa, mu_MPa, group, group);
}

static bool same_modulus(double a, double b) {
    return fabs(a - b) <= 1e-9 * fabs(b);
}

/* Writes an element set and a material for each modulus, within rounding. */
static palp_status write_solids(const calculix_deck *deck, FILE *to) {
    static const int in_gmsh_order[8] = {0, 1, 3, 2, 4, 5, 7, 6}, as_given[4] = {0, 1, 2, 3};
    const int *order = deck->corners == 8 ? in_gmsh_order : as_given;
    const size_t before = palp_mesh_element_count(deck->mesh) + 1;
    bool *written = calloc(deck->n_solids + 1, sizeof *written);
    size_t group = 0;
    if (!written)
        return PALP_ERR_NO_MEMORY;
    for (size_t first = 0; first < deck->n_solids; first++) {
        if (written[first])
            continue;
        fprintf(to, "*ELEMENT,TYPE=%s,ELSET=SOLIDS%zu\n", deck->corners == 8 ? "C3D8R" : "C3D4", ++group);
        for (size_t i = first; i < deck->n_solids; i++) {
            if (written[i] || !same_modulus(deck->solid_Pa[i], deck->solid_Pa[first]))
                continue;
            written[i] = true;
            fprintf(to, "%zu", before + i);
            for (size_t c = 0; c < deck->corners; c++)
                fprintf(to, ",%d", deck->solids[deck->corners * i + (size_t)order[c]] + 1);
            fputc('\n', to);
        }
        write_solid_group(group, deck->solid_Pa[first], to);
    }
    free(written);
    return PALP_OK;
}

static palp_status write_supports(const calculix_deck *deck, FILE *to) {
    for (size_t s = 0; s < deck->n_supports; s++) {
        const palp_support *support = &deck->supports[s];
        const int32_t *nodes;
        size_t n;
        palp_status status = palp_mesh_set(deck->mesh, support->set, &n, &nodes);
        if (status)
            return status;
        fprintf(to, "*NSET,NSET=SUPPORT%zu\n", s + 1);
        for (size_t i = 0; i < n; i++)
            fprintf(to, "%d\n", nodes[i] + 1);
        fputs("*BOUNDARY\n", to);
        for (int axis = 0; axis < 3; axis++)
            if (support->axis[axis] == PALP_FIXED)
                fprintf(to, "SUPPORT%zu,%d,%d\n", s + 1, axis + 1, axis + 1);
    }
    return PALP_OK;
}

/* Writes a step to depth_m, with increments small enough to stay on the branch from rest. */
static void write_step(const calculix_deck *deck, double from_m, double depth_m, FILE *to) {
    double increment = deck->step_strain * deck->height_m / fabs(depth_m - from_m);
    increment = increment < 1 ? increment : 1;
    fprintf(to,
            "** depth %.9g mm, strain %.9g\n*STEP,NLGEOM,INC=100000\n*STATIC\n%.9g,1.,1e-8,%.9g\n*BOUNDARY\n",
            1e3 * depth_m, depth_m / deck->height_m, increment, increment);
    for (size_t s = 0; s < deck->n_supports; s++) {
        for (int axis = 0; axis < 3; axis++) {
            if (deck->supports[s].axis[axis] == PALP_DRIVEN)
                fprintf(to, "SUPPORT%zu,%d,%d,%.15g\n", s + 1, axis + 1, axis + 1,
                        1e3 * depth_m * deck->supports[s].motion[axis]);
        }
    }
    for (size_t s = 0; s < deck->n_supports; s++) {
        const palp_axis *axis = deck->supports[s].axis;
        if (axis[0] == PALP_DRIVEN || axis[1] == PALP_DRIVEN || axis[2] == PALP_DRIVEN)
            fprintf(to, "*NODE PRINT,NSET=SUPPORT%zu,TOTALS=ONLY\nRF\n", s + 1);
    }
    fputs("*END STEP\n", to);
}

palp_status calculix_write(const calculix_deck *deck, FILE *to) {
    fprintf(to,
            "** %s: its fully relaxed network, in mm and N; run: ccx -i DECK (without .inp)\n"
            "** Each *SPRING table is K(|e|) e against the elongation: %zu points, e from %.4g to %.4g,\n"
            "** placed for the least squared error of the straight lines between them.\n"
            "** DECK.dat gets the total reaction RF of the driven nodes.\n",
            deck->model, deck->table_points, -deck->table_strain, deck->table_strain);
    write_nodes(deck->mesh, to);
    palp_status status = write_springs(deck, to);
    if (deck->n_solids > 0 && !status)
        status = write_solids(deck, to);
    if (status == PALP_OK)
        status = write_supports(deck, to);
    double from_m = 0;
    for (size_t i = 0; status == PALP_OK && i < deck->n_depths; i++) {
        write_step(deck, from_m, deck->depth_m[i], to);
        from_m = deck->depth_m[i];
    }
    return status;
}
