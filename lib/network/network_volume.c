/* network_volume.c: tetrahedra that resist a change of volume, which springs between nodes do not. J is the
 * volume over that at rest. Energy per volume at rest: w(J) = k (J - 1 - ln J), near rest k (J - 1)^2 / 2,
 * infinite at J = 0. */
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

static const double LEAST =
    0.05; /* Below this J w continues as a parabola, as trial positions may be inverted */

typedef struct volume {
    network_term term;
    double modulus; /* k, Pa */
    size_t n;
    const int32_t *node; /* [4 n], owned by the mesh */
    double *rest;        /* [n] m^3 */
    double *edge;        /* [9 n] from a tetrahedron's first node to the others, at the last evaluation */
    double *slope;       /* [n] dw/dJ at the last evaluation, Pa */
    double *curve;       /* [n] d2w/dJ2 over the volume at rest, Pa/m^3 */
} volume;

/* w and dw/dJ; *curve: d2w/dJ2. */
static double volume_energy_density(double k, double ratio, double *slope, double *curve) {
    const double at = fmax(ratio, LEAST), beyond = ratio - at;
    *curve = k / (at * at);
    *slope = k * (1.0 - 1.0 / at) + *curve * beyond;
    return k * (at - 1.0 - log(at)) + (k * (1.0 - 1.0 / at) + 0.5 * *curve * beyond) * beyond;
}

/* sum += factor a x b. */
static void add_scaled_cross_product(double factor, const double *a, const double *b, double *sum) {
    sum[0] += factor * (a[1] * b[2] - a[2] * b[1]);
    sum[1] += factor * (a[2] * b[0] - a[0] * b[2]);
    sum[2] += factor * (a[0] * b[1] - a[1] * b[0]);
}

static double edge_dot_product(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Edges of a tetrahedron from its first node, for vectors x[3 n_nodes]. */
static void edges_of_tetrahedron(const int32_t *node, const double *x, double edge[9]) {
    for (size_t i = 0; i < 9; i++)
        edge[i] = x[3 * (size_t)node[1 + i / 3] + i % 3] - x[3 * (size_t)node[0] + i % 3];
}

/* Derivative of the volume by the positions of all nodes but the first. */
static void volume_gradient(const double edge[9], double g[9]) {
    memset(g, 0, 9 * sizeof *g);
    for (int i = 0; i < 3; i++)
        add_scaled_cross_product(1.0 / 6.0, edge + 3 * ((i + 1) % 3), edge + 3 * ((i + 2) % 3), g + 3 * i);
}

/* Adds factor g to out on a tetrahedron's nodes; the first node gets what makes the sum zero. */
static void spread_over_tetrahedron(const int32_t *node, double factor, const double g[9], double *out) {
    for (size_t i = 0; i < 9; i++) {
        out[3 * (size_t)node[1 + i / 3] + i % 3] += factor * g[i];
        out[3 * (size_t)node[0] + i % 3] -= factor * g[i];
    }
}

static void evaluate_volume_forces(network_term *term, palp_network *net) {
    volume *t = (volume *)term;
    double g[9];
    for (size_t i = 0; i < t->n; i++) {
        const int32_t *node = t->node + 4 * i;
        double *edge = t->edge + 9 * i;
        edges_of_tetrahedron(node, net->next.x, edge);
        volume_gradient(edge, g);
        volume_energy_density(t->modulus, edge_dot_product(edge, g) / t->rest[i], &t->slope[i], &t->curve[i]);
        t->curve[i] /= t->rest[i];
        spread_over_tetrahedron(node, -t->slope[i], g, net->outer);
        const double stiffness = t->curve[i] * (edge_dot_product(g, g) + edge_dot_product(g + 3, g + 3) +
                                                edge_dot_product(g + 6, g + 6));
        const double *place = net->next.x + 3 * (size_t)node[0];
        net->outer_squares += stiffness * stiffness * edge_dot_product(place, place);
    }
}

static bool add_volume_energy(const network_term *term, const palp_network *net, double *energy) {
    const volume *t = (const volume *)term;
    double g[9], slope, curve;
    (void)net;
    for (size_t i = 0; i < t->n; i++) {
        volume_gradient(t->edge + 9 * i, g);
        *energy +=
            t->rest[i] * volume_energy_density(t->modulus, edge_dot_product(t->edge + 9 * i, g) / t->rest[i],
                                               &slope, &curve);
    }
    return true;
}

static void multiply_volume_tangent(const network_term *term, const palp_network *net, const double *u,
                                    double *out) {
    const volume *t = (const volume *)term;
    double g[9], du[9], more[9];
    (void)net;
    for (size_t i = 0; i < t->n; i++) {
        const double *edge = t->edge + 9 * i;
        volume_gradient(edge, g);
        edges_of_tetrahedron(t->node + 4 * i, u, du);
        memset(more, 0, sizeof more);
        double change = 0.0;
        for (size_t k = 0; k < 9; k++)
            change += g[k] * du[k];
        for (int k = 0; k < 3; k++) {
            add_scaled_cross_product(t->slope[i] / 6.0, du + 3 * ((k + 1) % 3), edge + 3 * ((k + 2) % 3),
                                     more + 3 * k);
            add_scaled_cross_product(t->slope[i] / 6.0, edge + 3 * ((k + 1) % 3), du + 3 * ((k + 2) % 3),
                                     more + 3 * k);
        }
        spread_over_tetrahedron(t->node + 4 * i, t->curve[i] * change, g, out);
        spread_over_tetrahedron(t->node + 4 * i, 1.0, more, out);
    }
}

/* Block of nodes 1 + a and 1 + b: curve g g'; for two nodes also slope times the third edge's cross
 * product. */
static void volume_block_between_nodes(const volume *t, size_t i, const double g[9], size_t a, size_t b,
                                       double k[9]) {
    for (size_t j = 0; j < 9; j++)
        k[j] = t->curve[i] * g[3 * a + j / 3] * g[3 * b + j % 3];
    if (a == b)
        return;
    const double *c = t->edge + 9 * i + 3 * (3 - a - b),
                 s = ((b + 3 - a) % 3 == 1 ? -1.0 : 1.0) * t->slope[i] / 6.0;
    k[1] -= s * c[2];
    k[2] += s * c[1];
    k[3] += s * c[2];
    k[5] -= s * c[0];
    k[6] -= s * c[1];
    k[7] += s * c[0];
}

/* The first node's blocks make the sums over each row and column zero. */
static void take_part_of_volume_blocks(const network_term *term, const palp_network *net, size_t part,
                                       size_t parts, network_block_taker take, void *user) {
    const volume *t = (const volume *)term;
    double g[9], k[9];
    (void)net;
    for (size_t i = t->n * part / parts; i < t->n * (part + 1) / parts; i++) {
        const int32_t *node = t->node + 4 * i;
        double first[9] = {0.0};
        volume_gradient(t->edge + 9 * i, g);
        for (size_t a = 0; a < 3; a++) {
            double row[9] = {0.0};
            for (size_t b = 0; b < 3; b++) {
                volume_block_between_nodes(t, i, g, a, b, k);
                for (size_t j = 0; j < 9; j++)
                    row[j] -= k[j];
                if (b <= a)
                    take(user, node[1 + a], node[1 + b], k);
            }
            take(user, node[1 + a], node[0], row);
            for (size_t j = 0; j < 9; j++)
                first[j] -= row[j];
        }
        take(user, node[0], node[0], first);
    }
}

static void take_volume_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                               void *user) {
    take_part_of_volume_blocks(term, net, 0, 1, take, user);
}

static const network_term_kind VOLUME = {.evaluate = evaluate_volume_forces,
                                         .blocks = take_volume_blocks,
                                         .times = multiply_volume_tangent,
                                         .energy = add_volume_energy,
                                         .blocks_part = take_part_of_volume_blocks};

bool network_has_volume(const palp_network *net) {
    return network_find_term(net, &VOLUME);
}

/* Does the tangent have room for each pair of a tetrahedron's nodes? */
static bool are_all_corners_joined(const palp_network *net, const int32_t node[4]) {
    for (int a = 0; a < 4; a++)
        for (int b = a + 1; b < 4; b++)
            if (palp_mesh_element_between(net->mesh, node[a], node[b]) >= net->n_elements)
                return false;
    return true;
}

palp_status network_add_volume(palp_network *net, double modulus_Pa) {
    const size_t n = palp_mesh_tetrahedron_count(net->mesh);
    const int32_t *node = palp_mesh_tetrahedra(net->mesh);
    if (n == 0)
        return PALP_ERR_UNSUPPORTED;
    for (size_t i = 0; i < n; i++)
        if (!are_all_corners_joined(net, node + 4 * i) || !(mesh_volume6(net->rest, node + 4 * i) > 0.0))
            return PALP_ERR_UNSUPPORTED;
    volume *t = network_term_new(&VOLUME, sizeof *t);
    if (!t)
        return PALP_ERR_NO_MEMORY;
    arena *memory = &t->term.memory;
    t->modulus = modulus_Pa;
    t->n = n;
    t->node = node;
    t->rest = arena_take(memory, n, sizeof *t->rest);
    t->edge = arena_take(memory, 9 * n, sizeof *t->edge);
    t->slope = arena_take(memory, n, sizeof *t->slope);
    t->curve = arena_take(memory, n, sizeof *t->curve);
    for (size_t i = 0; i < n && !memory->failed; i++)
        t->rest[i] = mesh_volume6(net->rest, node + 4 * i) / 6.0;
    return network_add_terms(net, 1, (network_term *[]){(network_term *)t});
}
