/* reduce_ecsw.c: ECSW, energy-conserving sampling and weighting: the elements that are kept, and their
 * weights (Farhat, Avery, Chapman, Cortial 2014, Int. J. Numer. Meth. Eng. 98). Fitted to forces and to
 * tangents, since in equilibrium most of the reduced forces vanish. */
#include "base/dense.h"
#include "solve/nnls.h"
#include "reduce_internal.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum {
    DIRECTIONS = 4, /* random directions a sample for the forces, and as many pairs for the tangents */
    LINES = 2 * DIRECTIONS + 1,
    CANDIDATES_MAX = 200000,
    SPARE = 3 /* equations for each kept element at most */
};

typedef struct sampling {
    arena memory;
    palp_network *net;
    size_t modes, n_candidates, rows, row;
    const double *basis, *lift;
    int32_t *candidate; /* [n_candidates] elements */
    double *a;          /* [rows n_candidates] by columns */
    double *b;          /* [rows] */
    double *spread;     /* [modes] root mean square of the snapshots' coordinates */
    double *solution;   /* [n_candidates] weights */
    double *x, *fields; /* [3 n_nodes], [3 n_nodes 3 DIRECTIONS] */
    double *drive;      /* [3 n_nodes] the lift, with unit energy at rest like the modes */
    double *mix;        /* [modes 3 DIRECTIONS] coordinates of the fields */
    double *work;       /* [n_elements] contribution of each element to a row */
    uint64_t seed;
} sampling;

/* out[3 n_nodes] = basis q. */
static void expand_to_full_displacement(const sampling *s, const double *q, double *out) {
    dense_transposed_times(s->modes, 3 * s->net->n_nodes, 1.0, s->basis, q, 0.0, out);
}

/* Puts the network into a sample's reduced state, with the history of the sample before; then its history is
 * the sample's. */
static bool set_network_to_sample(sampling *s, const double *q, double depth, double dt) {
    palp_network *net = s->net;
    expand_to_full_displacement(s, q, s->x);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.x[i] = net->rest[i] + depth * s->lift[i] + s->x[i];
    element_step_prepare(&net->material, dt, &net->step);
    bool sound = network_evaluate(net);
    element_history old = net->now.history;
    net->now.history = net->next.history;
    net->next.history = old;
    return sound;
}

/* Fields of random directions: Gaussian coordinates, plain ones and ones scaled by the snapshots'. */
static void draw_random_fields(sampling *s) {
    size_t n3 = 3 * s->net->n_nodes;
    for (size_t k = 0; k < 3 * DIRECTIONS; k++) {
        double *mix = s->mix + k * s->modes;
        for (size_t i = 0; i < s->modes; i++)
            mix[i] = palp_random_normal(&s->seed) * (k < 2 * DIRECTIONS ? 1.0 : s->spread[i]);
        expand_to_full_displacement(s, mix, s->fields + k * n3);
    }
}

/* Copies the contribution of each candidate to the next row, and the sum over all elements. */
static void store_sampling_row(sampling *s) {
    double sum = 0.0;
    for (size_t i = 0; i < s->net->n_elements; i++)
        sum += s->work[i];
    for (size_t j = 0; j < s->n_candidates; j++)
        s->a[j * s->rows + s->row] = s->work[s->candidate[j]];
    s->b[s->row++] = sum;
}

static double element_stretch_by_field(const palp_network *net, size_t i, const double *u) {
    const double *n = net->direction + i, *a = u + 3 * net->pair[2 * i], *b = u + 3 * net->pair[2 * i + 1];
    const size_t m = net->n_elements;
    return n[0] * (b[0] - a[0]) + n[m] * (b[1] - a[1]) + n[2 * m] * (b[2] - a[2]);
}

static void add_force_sampling_row(sampling *s, const double *field) {
    for (size_t i = 0; i < s->net->n_elements; i++)
        s->work[i] = s->net->force[i] * element_stretch_by_field(s->net, i, field);
    store_sampling_row(s);
}

static void add_tangent_sampling_row(sampling *s, const double *u, const double *v) {
    const palp_network *net = s->net;
    for (size_t i = 0; i < net->n_elements; i++) {
        size_t a = 3 * (size_t)net->pair[2 * i], b = 3 * (size_t)net->pair[2 * i + 1];
        double across = net->force[i] * net->inverse_length[i], both = 0.0;
        for (size_t k = 0; k < 3; k++)
            both += (u[b + k] - u[a + k]) * (v[b + k] - v[a + k]);
        s->work[i] = (net->tangent[i] * net->inverse_rest[i] - across) * element_stretch_by_field(net, i, u) *
                         element_stretch_by_field(net, i, v) +
                     across * both;
    }
    store_sampling_row(s);
}

/* Rows of one sample: the plate's force, then forces and tangents along random directions. */
static void add_rows_of_sample(sampling *s) {
    size_t n3 = 3 * s->net->n_nodes;
    draw_random_fields(s);
    add_force_sampling_row(s, s->drive);
    for (size_t k = 0; k < DIRECTIONS; k++) {
        add_force_sampling_row(s, s->fields + k * n3);
        add_tangent_sampling_row(s, s->fields + (DIRECTIONS + k) * n3, s->fields + (2 * DIRECTIONS + k) * n3);
    }
}

/* Runs every step of all snapshots, which the history needs, and adds rows for evenly spread samples. */
static palp_status replay_all_snapshots(sampling *s, size_t n_paths, palp_snapshots *const *snapshots,
                                        const reduced_samples *samples) {
    size_t wanted = s->rows / LINES, at = 0, taken = 0;
    for (size_t t = 0; t < n_paths; t++) {
        palp_network_reset(s->net);
        for (size_t i = 0; i < snapshots[t]->n; i++) {
            double dt = snapshots[t]->time[i] - (i ? snapshots[t]->time[i - 1] : 0.0);
            if (!set_network_to_sample(s, samples->q + at * s->modes, snapshots[t]->depth[i], dt))
                return PALP_ERR_COLLAPSED;
            if ((at + 1) * wanted / samples->n > taken && taken < wanted) {
                add_rows_of_sample(s);
                taken++;
            }
            at++;
        }
    }
    return PALP_OK;
}

/* All elements as candidates, or so many random ones. */
static void choose_candidate_elements(sampling *s) {
    size_t n = s->net->n_elements, left = s->n_candidates, k = 0;
    for (size_t i = 0; i < n && left > 0; i++)
        if (palp_random_uniform(&s->seed) * (double)(n - i) < (double)left) {
            s->candidate[k++] = (int32_t)i;
            left--;
        }
}

static void find_spread_of_samples(sampling *s, const reduced_samples *samples) {
    for (size_t j = 0; j < s->modes; j++) {
        double sum = 0.0;
        for (size_t i = 0; i < samples->n; i++)
            sum += samples->q[i * s->modes + j] * samples->q[i * s->modes + j];
        s->spread[j] = sqrt(sum / (double)samples->n);
    }
}

static void normalize_drive_field(sampling *s) {
    double energy = 0.0;
    reduced_at_rest(s->net);
    for (size_t i = 0; i < s->net->n_elements; i++) {
        double e = element_stretch_by_field(s->net, i, s->lift);
        energy += s->net->tangent[i] * s->net->inverse_rest[i] * e * e;
    }
    for (size_t i = 0; i < 3 * s->net->n_nodes && energy > 0.0; i++)
        s->drive[i] = s->lift[i] / sqrt(energy);
}

static palp_status create_element_sampling(sampling *s, const palp_reduce_settings *settings,
                                           const reduced_samples *samples) {
    size_t n = s->net->n_elements, n3 = 3 * s->net->n_nodes,
           wanted = SPARE * settings->elements / (2 * LINES) + 1;
    s->rows = LINES * (wanted < samples->n ? wanted : samples->n);
    s->n_candidates = n < CANDIDATES_MAX ? n : CANDIDATES_MAX;
    s->candidate = arena_take(&s->memory, s->n_candidates, sizeof *s->candidate);
    s->a = arena_take(&s->memory, s->rows * s->n_candidates, sizeof *s->a);
    s->b = arena_take(&s->memory, s->rows, sizeof *s->b);
    s->spread = arena_take(&s->memory, s->modes, sizeof *s->spread);
    s->x = arena_take(&s->memory, n3, sizeof *s->x);
    s->drive = arena_take(&s->memory, n3, sizeof *s->drive);
    s->fields = arena_take(&s->memory, 3 * DIRECTIONS * n3, sizeof *s->fields);
    s->mix = arena_take(&s->memory, 3 * DIRECTIONS * s->modes, sizeof *s->mix);
    s->work = arena_take(&s->memory, n, sizeof *s->work);
    s->solution = arena_take(&s->memory, s->n_candidates, sizeof *s->solution);
    if (s->memory.failed)
        return PALP_ERR_NO_MEMORY;
    find_spread_of_samples(s, samples);
    normalize_drive_field(s);
    choose_candidate_elements(s);
    return PALP_OK;
}

/* Keeps the elements with positive weight. */
static palp_status keep_elements_with_weight(const sampling *s, size_t *n, int32_t **element,
                                             double **weight) {
    const double *x = s->solution;
    size_t count = 0;
    for (size_t j = 0; j < s->n_candidates; j++)
        count += x[j] > 0.0;
    *element = malloc((count + 1) * sizeof **element);
    *weight = malloc((count + 1) * sizeof **weight);
    if (!*element || !*weight)
        return PALP_ERR_NO_MEMORY;
    *n = 0;
    for (size_t j = 0; j < s->n_candidates; j++)
        if (x[j] > 0.0) {
            (*element)[*n] = s->candidate[j];
            (*weight)[(*n)++] = x[j];
        }
    return PALP_OK;
}

static palp_status keep_all_elements(size_t n, int32_t **element, double **weight) {
    *element = malloc((n + 1) * sizeof **element);
    *weight = malloc((n + 1) * sizeof **weight);
    if (!*element || !*weight)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        (*element)[i] = (int32_t)i;
        (*weight)[i] = 1.0;
    }
    return PALP_OK;
}

palp_status reduced_ecsw(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                         const palp_reduce_settings *settings, size_t modes, const double *basis,
                         const double *lift, const reduced_samples *samples, size_t *n, int32_t **element,
                         double **weight, double *residual) {
    *element = NULL;
    *weight = NULL;
    *residual = 0.0;
    *n = net->n_elements;
    if (settings->elements >= net->n_elements)
        return keep_all_elements(net->n_elements, element, weight);
    sampling s = {.net = net, .modes = modes, .basis = basis, .lift = lift, .seed = 1};
    palp_status status = create_element_sampling(&s, settings, samples);
    if (!status)
        status = replay_all_snapshots(&s, n_paths, snapshots, samples);
    if (!status)
        status = nnls_solve(s.row, s.n_candidates, s.a, s.b, settings->element_tolerance, settings->elements,
                            s.solution, residual);
    if (!status)
        status = keep_elements_with_weight(&s, n, element, weight);
    arena_free(&s.memory);
    return status;
}
