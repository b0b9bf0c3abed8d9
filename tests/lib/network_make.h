/* network_make.h: the small networks that the network tests press. */
#ifndef NETWORK_MAKE_H
#define NETWORK_MAKE_H

#include <palpate/network.h>

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEIGHT 0.024 /* m */

/* N arms of well-separated times beside the quartic that the figures of other solvers are for. */
static inline palp_material quartic(size_t n_arms) {
    static const double law[] = {0.54, -2.34, 33.25, -124.03, 177.63}; /* N */
    static const palp_arm arms[] = {{0.4, 0.2, 0, 0}, {0.15, 3.0, 0, 0}, {0.1, 12.0, 0, 0}};
    palp_material m = {.n_arms = n_arms};
    ck_assert_int_eq(palp_law_polynomial(5, law, &m.law), PALP_OK);
    for (size_t j = 0; j < n_arms; j++)
        m.arms[j] = arms[j];
    return m;
}

static inline palp_material sedef2008(void) {
    palp_material m = quartic(1);
    m.formulation = PALP_SEDEF2008;
    return m;
}

/* One of each kind of material. */
enum { ELASTIC, ARMS, STRAIN_DEPENDENT, QLV_DASHPOT, SEDEF, KINDS };

static inline palp_material material_of(int kind) {
    palp_material m = kind == SEDEF ? sedef2008() : quartic(kind == ELASTIC ? 0 : 2);
    if (kind == STRAIN_DEPENDENT) {
        m.arms[0].beta = 3.0;
        m.arms[1].gamma = 2.0;
    }
    m.quasi_linear = kind == QLV_DASHPOT;
    m.dashpot_Ns = kind == QLV_DASHPOT ? 0.02 : 0.0;
    return m;
}

static inline palp_mesh *cube(size_t n, palp_neighbourhood neighbourhood) {
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(
        palp_mesh_lattice((size_t[]){n, n, n}, (double[]){HEIGHT, HEIGHT, HEIGHT}, neighbourhood, &mesh),
        PALP_OK);
    return mesh;
}

static inline palp_network *network_on(const palp_mesh *mesh, const palp_material *m,
                                       const palp_network_settings *settings) {
    palp_support supports[2];
    palp_network *net = NULL;
    palp_error error = {PALP_OK, ""};
    palp_supports_default(supports);
    palp_status status = palp_network_create(mesh, m, 2, supports, settings, &net, &error);
    ck_assert_msg(!status, "%s", error.text);
    return net;
}

/* n nodes a side, every neighbour. */
static inline palp_network *cube_network(size_t n, const palp_material *m,
                                         const palp_network_settings *settings) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network_settings plain = palp_network_settings_default();
    palp_network *net = network_on(mesh, m, settings ? settings : &plain);
    palp_mesh_free(mesh);
    return net;
}

/* Two nodes, or three in a row, along y and free along it only: the lumped specimen itself. */
static inline palp_network *column_of(size_t n_nodes, const palp_material *m) {
    const double x[] = {0, 0, 0, 0, 0.5 * HEIGHT, 0, 0, HEIGHT, 0}, ends[] = {0, 0, 0, 0, HEIGHT, 0};
    static const int32_t pairs[] = {0, 1, 2, 1};
    int32_t last = (int32_t)n_nodes - 1;
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    ck_assert_int_eq(palp_mesh_create(n_nodes, n_nodes == 2 ? ends : x, n_nodes - 1, pairs, &mesh, NULL),
                     PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "bottom", 1, (int32_t[]){0}), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "top", 1, &last), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "all", n_nodes, (int32_t[]){0, 1, 2}), PALP_OK);
    palp_support supports[3] = {[2] = {"all", {PALP_FIXED, PALP_FREE, PALP_FIXED}, {0, 0, 0}}};
    palp_supports_default(supports);
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_network_create(mesh, m, 3, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_uint_eq(palp_network_unknown_count(net), n_nodes - 2);
    palp_mesh_free(mesh);
    return net;
}

static inline size_t node_count(const palp_network *net) {
    return palp_mesh_node_count(palp_network_mesh(net));
}

static inline size_t element_count(const palp_network *net) {
    return palp_mesh_element_count(palp_network_mesh(net));
}

/* All that can be seen of a committed state, to be compared to the bit. */
typedef struct snapshot {
    size_t n;
    double *value;
} snapshot;

static inline snapshot snapshot_take(const palp_network *net) {
    size_t n3 = 3 * node_count(net), m = element_count(net);
    snapshot s = {3 + n3 + 2 * m + 6, malloc((3 + n3 + 2 * m + 6) * sizeof(double))};
    ck_assert(s.value != NULL);
    s.value[0] = palp_network_depth(net);
    s.value[1] = palp_network_time(net);
    s.value[2] = palp_network_force(net);
    memcpy(s.value + 3, palp_network_positions(net), n3 * sizeof(double));
    memcpy(s.value + 3 + n3, palp_network_element_strain(net), m * sizeof(double));
    palp_network_element_force(net, s.value + 3 + n3 + m);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", s.value + 3 + n3 + 2 * m), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "top", s.value + 6 + n3 + 2 * m), PALP_OK);
    return s;
}

static inline void snapshot_free(snapshot *s) {
    free(s->value);
}

static inline bool snapshot_same(const snapshot *a, const snapshot *b) {
    return a->n == b->n && memcmp(a->value, b->value, a->n * sizeof(double)) == 0;
}

/* The network's state is that of the snapshot, to the bit. */
static inline bool still_at(const palp_network *net, const snapshot *s) {
    snapshot now = snapshot_take(net);
    bool same = snapshot_same(&now, s);
    snapshot_free(&now);
    return same;
}

#endif
