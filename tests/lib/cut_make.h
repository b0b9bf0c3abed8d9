/* cut_make.h: networks that can be cut, blades, and the same network built without what was cut. */
#ifndef CUT_MAKE_H
#define CUT_MAKE_H

#include "cut/cut_internal.h"
#include "mesh/mesh_internal.h"
#include "network/network_internal.h"
#include "network_make.h"

#include <palpate/cut.h>
#include <palpate/random.h>
#include <palpate/realtime.h>
#include <palpate/tool.h>

static inline palp_network *cuttable(size_t n, const palp_material *m) {
    palp_network *net = cube_network(n, m, NULL);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    return net;
}

static inline void step_to(palp_network *net, double depth, double dt) {
    palp_step_info info;
    palp_status status = palp_network_step(net, depth, dt, &info);
    ck_assert_msg(!status, "depth %g: %s", depth, palp_status_text(status));
}

/* A blade as a rectangle: corner, two edges. */
static inline size_t cut_rectangle(palp_network *net, const double o[3], const double u[3],
                                   const double v[3]) {
    double first[9], second[9];
    size_t a = 0, b = 0;
    for (size_t k = 0; k < 3; k++) {
        first[k] = second[k] = o[k];
        first[3 + k] = o[k] + u[k];
        first[6 + k] = second[3 + k] = o[k] + u[k] + v[k];
        second[6 + k] = o[k] + v[k];
    }
    ck_assert_int_eq(palp_network_cut(net, first, &a), PALP_OK);
    ck_assert_int_eq(palp_network_cut(net, second, &b), PALP_OK);
    return a + b;
}

/* All of the plane y = height, or its part x <= reach. */
static inline size_t cut_level(palp_network *net, double height, double reach) {
    return cut_rectangle(net, (double[]){-1.0, height, -1.0}, (double[]){1.0 + reach, 0, 0},
                         (double[]){0, 0, 2.0});
}

static inline size_t count_alive(const palp_network *net) {
    size_t n = 0;
    for (size_t i = 0; i < element_count(net); i++)
        n += palp_network_alive(net)[i];
    return n;
}

static inline void random_blade(uint64_t *seed, double size, double corners[9]) {
    double middle[3];
    for (size_t k = 0; k < 3; k++)
        middle[k] = HEIGHT * palp_random_uniform(seed);
    for (size_t i = 0; i < 9; i++)
        corners[i] = middle[i % 3] + size * HEIGHT * (palp_random_uniform(seed) - 0.5);
}

/* The same elements as a network of its own: only whole ones, only nodes that one of them meets and that are
 * held. */
static inline palp_network *afresh(const palp_network *net, const palp_material *m, int32_t **place) {
    size_t n = node_count(net), n_nodes = 0, n_elements = 0;
    const palp_mesh *mesh = palp_network_mesh(net);
    unsigned char *loose = malloc(n);
    double *x = malloc(3 * n * sizeof *x);
    int32_t *index = malloc(n * sizeof *index), *pairs = malloc(2 * element_count(net) * sizeof *pairs);
    ck_assert(loose && x && index && pairs);
    palp_network_loose(net, loose);
    for (size_t i = 0; i < n; i++)
        index[i] = -1;
    for (size_t e = 0; e < element_count(net); e++) {
        const int32_t *pair = palp_mesh_pairs(mesh) + 2 * e;
        if (!palp_network_alive(net)[e] || loose[pair[0]])
            continue;
        for (size_t end = 0; end < 2; end++) {
            if (index[pair[end]] < 0) {
                memcpy(x + 3 * n_nodes, palp_mesh_positions(mesh) + 3 * pair[end], 3 * sizeof *x);
                index[pair[end]] = (int32_t)n_nodes++;
            }
            pairs[2 * n_elements + end] = index[pair[end]];
        }
        n_elements++;
    }
    palp_mesh *part = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_mesh_create(n_nodes, x, n_elements, pairs, &part, &error);
    ck_assert_msg(!status, "%s", error.text);
    ck_assert_int_eq(palp_mesh_add_plane_set(part, "bottom", 1, 0.0, 0.0), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(part, "top", 1, HEIGHT, 0.0), PALP_OK);
    palp_network_settings settings = palp_network_settings_default();
    palp_network *fresh = network_on(part, m, &settings);
    palp_mesh_free(part);
    free(loose);
    free(x);
    free(pairs);
    if (place)
        *place = index;
    else
        free(index);
    return fresh;
}

#endif
