/* test_network_bits.c: loops that exist in several versions (base/clones.h) give the bits of plain ones,
 * whichever version this processor takes: those written out here are compiled for the smallest. */
#include "network/network_internal.h"
#include "network_make.h"
#include "tangent_make.h"

#define SAME(a, b)                                                                                           \
    ck_assert_msg(memcmp(&(a), &(b), sizeof(double)) == 0, "element %zu: %.17g not %.17g", i, a, b)

static palp_network *pressed(size_t n, const palp_material *m) {
    palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network *net = network_on(mesh, m, &settings);
    palp_mesh_free(mesh);
    for (int i = 1; i <= 3; i++)
        ck_assert_int_eq(palp_network_step(net, 0.02 * HEIGHT * i, 0.05, NULL), PALP_OK);
    ck_assert_int_eq(network_begin(net, 0.07 * HEIGHT, 0.05), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.x[i] = net->now.x[i] + 1e-5 * sin(7.0 * (double)i);
    ck_assert(network_evaluate(net));
    return net;
}

/* 7 nodes a side: thirteen chunks of elements, the last one of them not full. */
START_TEST(geometry_and_force_of_every_element) {
    palp_material m = quartic(2);
    palp_network *net = pressed(7, &m);
    const double *c = m.law.coefficients;
    const size_t n = net->n_elements;
    for (size_t i = 0; i < n; i++) {
        const double *a = net->next.x + 3 * net->pair[2 * i], *b = net->next.x + 3 * net->pair[2 * i + 1];
        double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), inverse = 1.0 / length;
        double e = length * net->inverse_rest[i] - 1.0, size = fabs(e);
        SAME(net->strain[i], e);
        SAME(net->inverse_length[i], inverse);
        for (size_t k = 0; k < 3; k++) {
            double unit = d[k] * inverse;
            SAME(net->direction[k * n + i], unit);
        }
        double force = ((((c[4] * size + c[3]) * size + c[2]) * size + c[1]) * size + c[0]) * e;
        for (size_t j = 0; j < 2; j++)
            force += net->step.decay[j] * net->now.history.arm[j * n + i] +
                     net->step.gain[j] * (e - net->now.history.strain[i]);
        SAME(net->force[i], force);
    }
    palp_network_free(net);
}
END_TEST

/* A lattice's elements stand in runs, of every length up to a side: what they bring to the nodes is the sum
 * over the elements. */
START_TEST(runs_bring_the_sum_over_elements) {
    palp_material m = quartic(2);
    palp_network *net = pressed((size_t)_i, &m);
    double *sum = calloc(3 * net->n_nodes, sizeof *sum), largest = 0.0;
    ck_assert(sum && net->run);
    for (size_t e = 0; e < net->n_elements; e++)
        for (size_t k = 0; k < 3; k++) {
            const double f = net->force[e] * net->direction[k * net->n_elements + e];
            sum[3 * (size_t)net->pair[2 * e] + k] += f;
            sum[3 * (size_t)net->pair[2 * e + 1] + k] -= f;
            largest = fmax(largest, fabs(f));
        }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        ck_assert_double_eq_tol(net->fint[i], sum[i], 1e-13 * largest);
    free(sum);
    palp_network_free(net);
}
END_TEST

/* Blocks in single precision in place of geometry and tangent: the forces are the same to the bit. */
START_TEST(blocks_leave_the_forces) {
    palp_material m = quartic(2);
    palp_network *net = pressed(7, &m);
    const size_t n = net->n_elements;
    float *element = calloc(2 * n, sizeof *element);
    uint32_t *place = calloc(n, sizeof *place);
    double *before = calloc(3 * net->n_nodes, sizeof *before);
    ck_assert(element && place && before);
    for (size_t i = 0; i < n; i++)
        place[i] = (uint32_t)(n - 1 - i);
    memcpy(before, net->fint, 3 * net->n_nodes * sizeof *before);
    const network_blocks blocks = {.element = element, .place = place, .spacing = n};
    ck_assert(network_evaluate_blocks(net, &blocks));
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        SAME(net->fint[i], before[i]);
    for (size_t i = 0; i < n;
         i++) { /* length and tangent are those of the evaluation before, which is the same */
        const float *e = element + (n - 1 - i);
        double across = net->force[i] * net->inverse_length[i],
               along = net->tangent[i] * net->inverse_rest[i] - across;
        ck_assert(e[0] == (float)(along * (net->inverse_length[i] * net->inverse_length[i])) &&
                  e[n] == (float)across);
    }
    free(element);
    free(place);
    free(before);
    palp_network_free(net);
}
END_TEST

/* A trial leaves strain, force and history of every element as they were; its forces on nodes and its blocks,
 * which go by runs where these stand together, are the same to the bit. */
START_TEST(trials_keep_nothing) {
    palp_material m = quartic(2);
    palp_network *net = pressed(7, &m);
    const size_t n = net->n_elements, runs = net->first_run[(n + NETWORK_CHUNK - 1) / NETWORK_CHUNK];
    float *element = calloc(4 * n, sizeof *element);
    uint32_t *place = calloc(n, sizeof *place), *run_place = calloc(runs, sizeof *run_place);
    double *before = calloc(3 * net->n_nodes, sizeof *before),
           *kept[] = {net->strain, net->force, net->next.history.arm};
    const size_t sizes[] = {n, n, 2 * n};
    ck_assert(element && place && run_place && before);
    for (size_t i = 0; i < n; i++)
        place[i] = (uint32_t)i;
    for (size_t r = 1; r < runs; r++)
        run_place[r] = run_place[r - 1] + (uint32_t)net->run[r - 1].n;
    network_blocks blocks = {.element = element, .place = place, .spacing = n};
    ck_assert(network_evaluate_blocks(net, &blocks));
    memcpy(before, net->fint, 3 * net->n_nodes * sizeof *before);
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < sizes[k]; i++)
            kept[k][i] = (double)(k + 1);
    blocks = (network_blocks){element + 2 * n, place, n, run_place, true};
    ck_assert(network_evaluate_blocks(net, &blocks));
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        SAME(net->fint[i], before[i]);
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < sizes[k]; i++)
            ck_assert(kept[k][i] == (double)(k + 1));
    ck_assert_mem_eq(element, element + 2 * n, 2 * n * sizeof *element);
    free(element);
    free(place);
    free(run_place);
    free(before);
    palp_network_free(net);
}
END_TEST

START_TEST(sums_are_in_one_order) {
    double a[101], b[101], lane[8] = {0.0};
    for (size_t i = 0; i < 101; i++) {
        a[i] = sin((double)i);
        b[i] = exp(0.3 * cos(3.0 * (double)i));
        lane[i < 96 ? i % 8 : 0] += a[i] * b[i];
    }
    double sum = ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
    double found = network_dot(a, b, 101);
    size_t i = 0;
    SAME(found, sum);
}
END_TEST

/* The product with the tangent against the matrix of the factor, on the free axes. */
START_TEST(product_is_the_matrix) {
    palp_material m = quartic(2);
    palp_network *net = pressed(5, &m);
    double *u = calloc(3 * net->n_nodes, sizeof *u), *out = calloc(3 * net->n_nodes, sizeof *out);
    int negative;
    ck_assert(u && out);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        u[i] = net->dof[i] < 0 ? 0.0 : cos(5.0 * (double)i);
    network_tangent_times(net, u, out);
    ck_assert_int_eq(network_factor(net, 0.0, &negative), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->dx[net->dof[i]] = out[i];
    linsys_solve(net->ls, net->dx);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            ck_assert_double_eq_tol(net->dx[net->dof[i]], u[i], 1e-9);
    free(u);
    free(out);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, geometry_and_force_of_every_element);
    tcase_add_loop_test(tc, runs_bring_the_sum_over_elements, 4, 10);
    tcase_add_test(tc, blocks_leave_the_forces);
    tcase_add_test(tc, trials_keep_nothing);
    tcase_add_test(tc, sums_are_in_one_order);
    tcase_add_test(tc, product_is_the_matrix);
}
