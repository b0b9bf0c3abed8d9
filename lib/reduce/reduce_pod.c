/* reduce_pod.c: POD modes of a reduced model, orthonormal in the network's stiffness at rest K. Snapshots:
 * Sirovich 1987, Quart. Appl. Math. 45. */
#include "base/dense.h"
#include "reduce_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ROUNDING =
    1e-13; /* relative to the largest eigenvalue: below it there is only rounding */

void reduced_at_rest(palp_network *net) {
    palp_network_reset(net);
    element_step_prepare(&net->material, INFINITY, &net->step);
    memcpy(net->next.x, net->rest, 3 * net->n_nodes * sizeof *net->next.x);
    network_evaluate(net);
}

/* out = K u for all coordinates of a network at rest. */
static void multiply_rest_stiffness(const palp_network *net, const double *u, double *out) {
    memset(out, 0, 3 * net->n_nodes * sizeof *out);
    for (size_t i = 0; i < net->n_elements; i++) {
        size_t a = 3 * (size_t)net->pair[2 * i], b = 3 * (size_t)net->pair[2 * i + 1];
        const double n[3] = {net->direction[i], net->direction[net->n_elements + i],
                             net->direction[2 * net->n_elements + i]};
        double stretch = n[0] * (u[b] - u[a]) + n[1] * (u[b + 1] - u[a + 1]) + n[2] * (u[b + 2] - u[a + 2]);
        double force = net->tangent[i] * net->inverse_rest[i] * stretch;
        for (size_t k = 0; k < 3; k++) {
            out[a + k] -= force * n[k];
            out[b + k] += force * n[k];
        }
    }
}

/* lift: the linear response at rest to the plate's motion. */
static palp_status find_linear_response(palp_network *net, double *lift) {
    int negative;
    reduced_at_rest(net);
    palp_status status = network_factor(net, 0.0, &negative);
    if (status || negative > 0)
        return PALP_ERR_SINGULAR;
    network_drive_column(net, net->dx);
    network_solve(net, net->dx);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        lift[i] = net->dof[i] < 0 ? net->motion[i] : net->dx[net->dof[i]];
    return PALP_OK;
}

/* Displacements of the samples without the lift, u[3 n_nodes samples]. */
static void find_sample_displacements(const palp_network *net, size_t n_paths,
                                      palp_snapshots *const *snapshots, const double *lift, double *u) {
    size_t n3 = 3 * net->n_nodes;
    for (size_t t = 0; t < n_paths; t++)
        for (size_t i = 0; i < snapshots[t]->n; i++) {
            const double *x = snapshots[t]->x + n3 * i;
            for (size_t k = 0; k < n3; k++)
                u[k] = net->dof[k] < 0 ? 0.0 : x[k] - net->rest[k] - snapshots[t]->depth[i] * lift[k];
            u += n3;
        }
}

/* How many of the largest eigenvalues w[n] (ascending) contain all but tolerance^2 of the sum. */
static size_t count_significant_modes(size_t n, const double *w, double tolerance, size_t most) {
    double sum = 0.0, left = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += fmax(w[i], 0.0);
    size_t first = 0;
    while (first < n &&
           (left + fmax(w[first], 0.0) <= tolerance * tolerance * sum || w[first] <= ROUNDING * w[n - 1]))
        left += fmax(w[first++], 0.0);
    return n - first < most ? n - first : most;
}

/* columns[rows count] = u z / sqrt(w) for the count largest eigenvalues. */
static void combine_modes_of_samples(size_t rows, size_t n, const double *u, double *z, const double *w,
                                     size_t count, double *columns) {
    for (size_t j = n - count; j < n; j++)
        for (size_t i = 0; i < n; i++)
            z[j * n + i] /= sqrt(w[j]);
    /* largest first */
    for (size_t j = 0; j < count / 2; j++)
        for (size_t i = 0; i < n; i++) {
            double swap = z[(n - 1 - j) * n + i];
            z[(n - 1 - j) * n + i] = z[(n - count + j) * n + i];
            z[(n - count + j) * n + i] = swap;
        }
    dense_product(rows, count, n, u, z + (n - count) * n, columns);
}

/* v += scale u. */
static void add_scaled_vector(size_t n, double scale, const double *u, double *v) {
    for (size_t k = 0; k < n; k++)
        v[k] += scale * u[k];
}

/* A second Gram-Schmidt pass in K, against rounding; stiff[3 n_nodes] is scratch. */
static void orthonormalize_columns(const palp_network *net, size_t count, double *columns, double *stiff) {
    size_t n3 = 3 * net->n_nodes;
    for (size_t j = 0; j < count; j++) {
        double *v = columns + j * n3;
        multiply_rest_stiffness(net, v, stiff);
        for (size_t i = 0; i < j; i++)
            add_scaled_vector(n3, -dense_dot(n3, columns + i * n3, stiff), columns + i * n3, v);
        multiply_rest_stiffness(net, v, stiff);
        add_scaled_vector(n3, 1.0 / sqrt(dense_dot(n3, v, stiff)) - 1.0, v, v);
    }
}

/* POD modes of the samples: columns[3 n_nodes *count]. */
static palp_status find_proper_modes(const palp_network *net, size_t n, const double *u, double tolerance,
                                     size_t most, double *columns, size_t *count) {
    size_t n3 = 3 * net->n_nodes;
    double *stiff = malloc((n3 * n + 1) * sizeof *stiff), *c = malloc((n * n + n + 1) * sizeof *c);
    palp_status status = stiff && c ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        for (size_t i = 0; i < n; i++)
            multiply_rest_stiffness(net, u + i * n3, stiff + i * n3);
        dense_transposed_product(n, n, n3, u, stiff, c);
        status = dense_eigen(n, c, c + n * n);
    }
    if (!status) {
        *count = count_significant_modes(n, c + n * n, tolerance, most);
        combine_modes_of_samples(n3, n, u, c, c + n * n, *count, columns);
    }
    free(stiff);
    free(c);
    return status;
}

static double distance_of_node_to_tool(const palp_tool *tool, const double x[3]) {
    double d[3] = {x[0] - tool->position_m[0], x[1] - tool->position_m[1], x[2] - tool->position_m[2]};
    double along = d[0] * tool->axis[0] + d[1] * tool->axis[1] + d[2] * tool->axis[2];
    if (tool->shape == PALP_TOOL_PLANE)
        return along;
    if (tool->shape == PALP_TOOL_HULL)
        return contact_distance(tool, x) - tool->radius_m;
    double on = tool->shape == PALP_TOOL_CAPSULE ? fmax(0.0, fmin(tool->length_m, along)) : 0.0;
    for (size_t k = 0; k < 3; k++)
        d[k] -= on * tool->axis[k];
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - tool->radius_m;
}

/* Free coordinates of surface nodes within an element's length of a tool, into list unless NULL; returns
 * their number. */
static size_t list_touched_coordinates(const palp_network *net, size_t n_paths,
                                       palp_snapshots *const *snapshots, size_t *list) {
    size_t n_triangles = palp_mesh_triangle_count(net->mesh), n = 0;
    const int32_t *triangles = palp_mesh_triangles(net->mesh);
    unsigned char *near = calloc(net->n_nodes + 1, 1);
    double length = 1.0 / net->inverse_rest[0];
    for (size_t c = 0; near && c < 3 * n_triangles; c++) {
        size_t node = (size_t)triangles[c];
        for (size_t t = 0; !near[node] && t < n_paths; t++)
            for (size_t i = 0; i < snapshots[t]->n && !near[node]; i++)
                for (size_t k = 0; k < snapshots[t]->n_tools; k++)
                    if (distance_of_node_to_tool(&snapshots[t]->tools[i * snapshots[t]->n_tools + k],
                                                 snapshots[t]->x + 3 * (net->n_nodes * i + node)) < length)
                        near[node] = 1;
    }
    for (size_t i = 0; near && i < 3 * net->n_nodes; i++)
        if (near[i / 3] && net->dof[i] >= 0) {
            if (list)
                list[n] = i;
            n++;
        }
    free(near);
    return n;
}

/* Appends at most `most` columns: the response to unit loads at the coordinates list[n] that the count
 * columns do not span. These are the largest eigenvectors of the compliance e' K^-1 e less that of the
 * columns. */
static palp_status find_static_load_modes(palp_network *net, size_t n, const size_t *list, size_t most,
                                          double *columns, size_t *count) {
    size_t n3 = 3 * net->n_nodes;
    double *answer = calloc(n3 * n + 1, sizeof *answer), *c = malloc((n * n + n + 1) * sizeof *c);
    palp_status status = answer && c ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; !status && i < n; i++) {
        double *u = answer + i * n3;
        memset(net->dx, 0, net->n_free * sizeof *net->dx);
        net->dx[net->dof[list[i]]] = 1.0;
        network_solve(net, net->dx);
        for (size_t k = 0; k < n3; k++)
            u[k] = net->dof[k] < 0 ? 0.0 : net->dx[net->dof[k]];
        for (size_t j = 0; j < *count;
             j++) /* the K product of answer and column is the column's value at the load */
            add_scaled_vector(n3, -columns[j * n3 + list[i]], columns + j * n3, u);
    }
    for (size_t i = 0; !status && i < n; i++)
        for (size_t j = 0; j < n; j++)
            c[i * n + j] = 0.5 * (answer[i * n3 + list[j]] + answer[j * n3 + list[i]]);
    status = status ? status : dense_eigen(n, c, c + n * n);
    if (!status) {
        size_t more = count_significant_modes(n, c + n * n, 1e-4, most);
        combine_modes_of_samples(n3, n, answer, c, c + n * n, more, columns + *count * n3);
        *count += more;
    }
    free(answer);
    free(c);
    return status;
}

/* rows[3 n_nodes count]: the transpose of columns[count 3 n_nodes]. */
static void transpose_columns_to_rows(size_t n3, size_t count, const double *columns, double *rows) {
    for (size_t j = 0; j < count; j++)
        for (size_t i = 0; i < n3; i++)
            rows[i * count + j] = columns[j * n3 + i];
}

static palp_status find_basis_columns(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                                      const palp_reduce_settings *settings, size_t n, const double *u,
                                      double *columns, size_t *count) {
    size_t loads = settings->static_modes < settings->modes ? settings->static_modes : settings->modes;
    palp_status status =
        find_proper_modes(net, n, u, settings->tolerance, settings->modes - loads, columns, count);
    size_t *list = malloc((3 * net->n_nodes + 1) * sizeof *list);
    if (!status && !list)
        status = PALP_ERR_NO_MEMORY;
    if (!status && loads > 0) {
        size_t n_list = list_touched_coordinates(net, n_paths, snapshots, list);
        if (n_list > 0)
            status = find_static_load_modes(net, n_list, list, loads, columns, count);
    }
    free(list);
    return status;
}

palp_status reduced_pod(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                        const palp_reduce_settings *settings, size_t *modes, double **basis, double **lift,
                        reduced_samples *samples) {
    size_t n3 = 3 * net->n_nodes, n = 0, count = 0;
    for (size_t t = 0; t < n_paths; t++)
        n += snapshots[t]->n;
    double *u = malloc((n3 * n + 1) * sizeof *u),
           *columns = malloc((n3 * settings->modes + 1) * sizeof *columns);
    double *stiff = malloc((n3 + 1) * sizeof *stiff), *rows = NULL, *q = NULL;
    *lift = calloc(n3 + 1, sizeof **lift);
    palp_status status =
        u && columns && stiff && *lift ? find_linear_response(net, *lift) : PALP_ERR_NO_MEMORY;
    if (!status) {
        find_sample_displacements(net, n_paths, snapshots, *lift, u);
        status = find_basis_columns(net, n_paths, snapshots, settings, n, u, columns, &count);
    }
    if (!status) {
        orthonormalize_columns(net, count, columns, stiff);
        rows = malloc((n3 * count + 1) * sizeof *rows);
        q = malloc((count * n + 1) * sizeof *q);
        status = rows && q ? PALP_OK : PALP_ERR_NO_MEMORY;
    }
    if (!status) {
        transpose_columns_to_rows(n3, count, columns, rows);
        for (size_t i = 0; i < n; i++) {
            multiply_rest_stiffness(net, u + i * n3, stiff);
            dense_transposed_product(count, 1, n3, columns, stiff, q + i * count);
        }
        *modes = count;
        *samples = (reduced_samples){n, q};
        *basis = rows;
    } else {
        free(rows);
        free(q);
        free(*lift);
        *lift = NULL;
    }
    free(u);
    free(columns);
    free(stiff);
    return status;
}
