/* reduce.c: building a reduced model, its error on held-out paths, and its properties. */
#include "reduce_internal.h"

#include "base/dense.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Error bound: the largest error on held-out and snapshot paths, times 1 + CAUTION / held-out paths. With n
 * similar paths a new one exceeds the largest error with probability 1 / (n + 1). */
static const double CAUTION = 2.0;

palp_reduce_settings palp_reduce_settings_default(void) {
    return (palp_reduce_settings){
        .modes = 80, .tolerance = 1e-3, .elements = 1200, .element_tolerance = 3e-3, .static_modes = 0};
}

void palp_reduced_free(palp_reduced *r) {
    if (!r)
        return;
    arena_free(&r->memory);
    free(r->surface);
    free(r);
}

static double *allocate_doubles(palp_reduced *r, size_t n) {
    return arena_take(&r->memory, n, sizeof(double));
}

static void allocate_reduced_state(palp_reduced *r, reduced_state *s) {
    s->q = allocate_doubles(r, r->modes);
    s->history.strain = allocate_doubles(r, r->n_elements);
    s->history.elastic = allocate_doubles(r, r->n_elements);
    s->history.arm = allocate_doubles(r, r->n_elements * r->material.n_arms);
    s->history.stride = r->n_elements;
}

palp_status reduced_allocate(palp_reduced *r) {
    size_t n3 = 3 * r->n_nodes, m = r->n_elements, k = r->modes;
    r->rest = allocate_doubles(r, n3);
    r->lift = allocate_doubles(r, n3);
    double **by_element[] = {&r->weight, &r->inverse_rest, &r->reach,         &r->strain,
                             &r->force,  &r->tangent,      &r->inverse_length};
    for (size_t i = 0; i < sizeof by_element / sizeof *by_element; i++)
        *by_element[i] = allocate_doubles(r, m);
    double **vectors[] = {&r->gap_rest, &r->gap_lift, &r->direction, &r->vector};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        *vectors[i] = allocate_doubles(r, 3 * m);
    double **by_mode[] = {&r->rhs, &r->dq, &r->start, &r->past};
    for (size_t i = 0; i < sizeof by_mode / sizeof *by_mode; i++)
        *by_mode[i] = allocate_doubles(r, k);
    double **squares[] = {&r->stiffness, &r->factor, &r->coming};
    for (size_t i = 0; i < sizeof squares / sizeof *squares; i++)
        *squares[i] = allocate_doubles(r, k * k);
    r->unit = allocate_doubles(r, r->n_nodes);
    r->basis = allocate_doubles(r, n3 * k);
    r->low = allocate_doubles(r, k + 1);
    r->high = allocate_doubles(r, k + 1);
    r->gap = allocate_doubles(r, k * 3 * m);
    r->scaled = allocate_doubles(r, k * 3 * REDUCED_BLOCK);
    r->work = allocate_doubles(r, DENSE_WORK * k);
    r->fixed = arena_take(&r->memory, n3, sizeof *r->fixed);
    r->triangles = arena_take(&r->memory, 3 * r->n_triangles, sizeof *r->triangles);
    r->pair = arena_take(&r->memory, 2 * m, sizeof *r->pair);
    r->pivot = arena_take(&r->memory, k, sizeof *r->pivot);
    allocate_reduced_state(r, &r->now);
    allocate_reduced_state(r, &r->next);
    return r->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

palp_status reduced_prepare(palp_reduced *r) {
    for (size_t i = 0; i < r->n_elements; i++) {
        size_t a = 3 * (size_t)r->pair[2 * i], b = 3 * (size_t)r->pair[2 * i + 1];
        double length = 0.0, size = 0.0;
        for (size_t k = 0; k < 3; k++) {
            double d = r->rest[b + k] - r->rest[a + k];
            double *gap = r->gap + (3 * i + k) * r->modes;
            r->gap_rest[3 * i + k] = d;
            r->gap_lift[3 * i + k] = r->lift[b + k] - r->lift[a + k];
            length += d * d;
            for (size_t j = 0; j < r->modes; j++) {
                gap[j] = r->basis[(b + k) * r->modes + j] - r->basis[(a + k) * r->modes + j];
                size += gap[j] * gap[j];
            }
        }
        r->inverse_rest[i] = 1.0 / sqrt(length);
        r->reach[i] = r->weight[i] * sqrt(size);
    }
    r->tolerance = 1e-6;
    r->max_iterations = 20;
    palp_status status = r->max_tools > 0 ? reduced_contact_make(r) : PALP_OK;
    if (!status)
        palp_reduced_reset(r);
    return status;
}

palp_status reduced_make(const palp_network *net, const contact_set *contacts, size_t modes,
                         const double *basis, const double *lift, size_t n, const int32_t *element,
                         const double *weight, palp_reduced **out) {
    palp_reduced *r = calloc(1, sizeof *r);
    if (!r)
        return PALP_ERR_NO_MEMORY;
    r->material = net->material;
    r->n_nodes = net->n_nodes;
    r->modes = modes;
    r->n_elements = n;
    r->n_triangles = palp_mesh_triangle_count(net->mesh);
    palp_status status = reduced_allocate(r);
    if (status) {
        palp_reduced_free(r);
        return status;
    }
    memcpy(r->rest, net->rest, 3 * r->n_nodes * sizeof *r->rest);
    memcpy(r->lift, lift, 3 * r->n_nodes * sizeof *r->lift);
    memcpy(r->basis, basis, 3 * r->n_nodes * modes * sizeof *r->basis);
    if (r->n_triangles > 0)
        memcpy(r->triangles, palp_mesh_triangles(net->mesh), 3 * r->n_triangles * sizeof *r->triangles);
    for (size_t i = 0; i < 3 * r->n_nodes; i++)
        r->fixed[i] = net->dof[i] < 0;
    for (size_t i = 0; i < n; i++) {
        memcpy(r->pair + 2 * i, net->pair + 2 * element[i], 2 * sizeof *r->pair);
        r->weight[i] = weight[i] * (net->scale ? net->scale[element[i]] : 1.0);
    }
    r->summary = (palp_reduced_summary){.modes = modes,
                                        .elements = n,
                                        .unknowns = net->n_free,
                                        .network_elements = net->n_elements,
                                        .bound = INFINITY};
    for (size_t i = 0; i < 3 * r->n_nodes; i++)
        if (net->motion[i] != 0.0)
            r->summary.height_m = net->height;
    if (contacts) {
        r->max_tools = contacts->max_tools;
        r->contact_settings = contacts->settings;
        memcpy(r->unit, net->unit, r->n_nodes * sizeof *r->unit);
    }
    status = reduced_prepare(r);
    if (status)
        palp_reduced_free(r);
    else
        *out = r;
    return status;
}

void palp_reduced_reset(palp_reduced *r) {
    if (!r)
        return;
    size_t m = r->n_elements * sizeof(double);
    memset(r->now.q, 0, r->modes * sizeof *r->now.q);
    memset(r->past, 0, r->modes * sizeof *r->past);
    memset(r->now.history.strain, 0, m);
    memset(r->now.history.elastic, 0, m);
    memset(r->now.history.arm, 0, m * r->material.n_arms);
    r->now.depth = r->now.time = r->now.force = r->past_step = r->peak = 0.0;
    r->stiff = false;
    r->refreshed = 0;
    if (r->surface)
        reduced_contact_reset(r);
}

static void find_range_of_snapshots(palp_reduced *r, size_t n_paths, palp_snapshots *const *snapshots,
                                    const reduced_samples *samples) {
    for (size_t i = 0; i < samples->n; i++)
        for (size_t j = 0; j < r->modes; j++) {
            r->low[j] = fmin(r->low[j], samples->q[i * r->modes + j]);
            r->high[j] = fmax(r->high[j], samples->q[i * r->modes + j]);
        }
    for (size_t t = 0; t < n_paths; t++)
        for (size_t i = 0; i < snapshots[t]->n; i++) {
            r->low[r->modes] = fmin(r->low[r->modes], snapshots[t]->depth[i]);
            r->high[r->modes] = fmax(r->high[r->modes], snapshots[t]->depth[i]);
        }
}

/* |difference| of the plate's and the tools' forces at sample i, and |force| of the full network there. */
static double length_of_force_difference(const palp_snapshots *t, size_t i, double force,
                                         const palp_tool_force *tools, double *size) {
    double plate = force - t->force[i], difference = plate * plate, own = t->force[i] * t->force[i];
    for (size_t j = 0; j < t->n_tools; j++)
        for (size_t k = 0; k < 3; k++) {
            double full = t->tool_force[3 * (i * t->n_tools + j) + k], d = tools[j].force_N[k] - full;
            difference += d * d;
            own += full * full;
        }
    *size = sqrt(own);
    return sqrt(difference);
}

palp_status palp_reduced_compare(palp_reduced *r, const palp_snapshots *t, palp_reduce_error *result) {
    if (!r || !t || !result)
        return PALP_ERR_ARGUMENT;
    palp_tool_force *tools = calloc(t->n_tools + 1, sizeof *tools);
    palp_status status = tools ? PALP_OK : PALP_ERR_NO_MEMORY;
    double squares = 0.0;
    *result = (palp_reduce_error){0.0, 0.0, 0.0};
    palp_reduced_reset(r);
    for (size_t i = 0; !status && i < t->n; i++) {
        palp_reduced_info info = {.force_N = 0.0};
        double since = i ? t->time[i - 1] : 0.0, size;
        if (t->time[i] > since || t->depth[i] != 0.0 || t->n_tools > 0)
            status = palp_reduced_step(r, t->depth[i], t->n_tools, t->tools + i * t->n_tools,
                                       t->time[i] - since, tools, &info);
        double difference = length_of_force_difference(t, i, info.force_N, tools, &size);
        squares += difference * difference;
        result->worst_N = fmax(result->worst_N, difference);
        result->peak_N = fmax(result->peak_N, size);
    }
    result->rms_N = sqrt(squares / (double)t->n);
    free(tools);
    palp_reduced_reset(r);
    return status;
}

static palp_status measure_errors_on_paths(palp_reduced *r, size_t n_paths, palp_snapshots *const *snapshots,
                                           size_t n_held_out, palp_snapshots *const *held_out,
                                           palp_reduce_error *error_held_out) {
    palp_reduced_summary *s = &r->summary;
    for (size_t t = 0; t < n_paths && n_held_out > 0; t++) {
        palp_reduce_error e;
        palp_status status = palp_reduced_compare(r, snapshots[t], &e);
        if (status)
            return status;
        s->snapshot_worst = fmax(s->snapshot_worst, e.peak_N > 0.0 ? e.worst_N / e.peak_N : 0.0);
    }
    for (size_t t = 0; t < n_held_out; t++) {
        palp_reduce_error e;
        palp_status status = palp_reduced_compare(r, held_out[t], &e);
        if (status)
            return status;
        if (error_held_out)
            error_held_out[t] = e;
        double peak = e.peak_N > 0.0 ? e.peak_N : 1.0;
        s->held_out_worst = fmax(s->held_out_worst, e.worst_N / peak);
        s->held_out_rms = fmax(s->held_out_rms, e.rms_N / peak);
        s->held_out_peak_N = t == 0 ? e.peak_N : fmin(s->held_out_peak_N, e.peak_N);
    }
    s->held_out_paths = n_held_out;
    s->bound = INFINITY;
    if (n_held_out > 0)
        s->bound = (1.0 + CAUTION / (double)n_held_out) * fmax(s->held_out_worst, s->snapshot_worst);
    return PALP_OK;
}

static bool are_settings_in_range(const palp_reduce_settings *s) {
    return s->modes > 0 && s->elements > 0 && s->static_modes <= s->modes && s->tolerance >= 0.0 &&
           s->tolerance < 1.0 && s->element_tolerance >= 0.0 && s->element_tolerance < 1.0;
}

static palp_status check_creation_arguments(const palp_network *net, size_t n_paths,
                                            palp_snapshots *const *snapshots, size_t n_held_out,
                                            palp_snapshots *const *held_out,
                                            const palp_reduce_settings *settings, palp_error *error) {
    bool sound = n_paths > 0 && are_settings_in_range(settings);
    for (size_t i = 0; i < n_paths; i++)
        sound = sound && snapshots[i]->n_nodes == net->n_nodes;
    for (size_t i = 0; i < n_held_out; i++)
        sound = sound && held_out[i]->n_nodes == net->n_nodes;
    if (!sound)
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "a setting is out of range, or a path belongs to another network");
    bool vectors = net->material.formulation == PALP_SEDEF2008 && net->material.n_arms > 0;
    if (net->mass || net->damage || network_foundation(net) || network_has_volume(net) ||
        network_has_fibres(net) || vectors || net->base_share)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "a network with mass, damage, a volume modulus, Poisson's ratio or fibres, the "
                              "formulation sedef2008, or a "
                              "region with a material of its own cannot be reduced");
    const contact_set *contacts = contact_of(net);
    if (contacts && (contacts->settings.subdivisions > 0 || contacts->settings.local))
        return palp_error_set(
            error, PALP_ERR_UNSUPPORTED,
            "a network whose tools touch a subdivided surface or local points cannot be reduced");
    if (net->far.room > 0)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "a network with ties, or whose tissue touches itself, cannot be reduced");
    return PALP_OK;
}

static palp_status build_reduced_model(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                                       const palp_reduce_settings *settings, const contact_set *contacts,
                                       palp_reduced **out) {
    size_t modes = 0, n = 0;
    double *basis = NULL, *lift = NULL, *weight = NULL, residual = 0.0;
    int32_t *element = NULL;
    reduced_samples samples = {0, NULL};
    palp_status status = reduced_pod(net, n_paths, snapshots, settings, &modes, &basis, &lift, &samples);
    if (!status && modes == 0)
        status = PALP_ERR_ARGUMENT; /* the snapshot paths move nothing */
    if (!status)
        status = reduced_ecsw(net, n_paths, snapshots, settings, modes, basis, lift, &samples, &n, &element,
                              &weight, &residual);
    if (!status)
        status = reduced_make(net, contacts, modes, basis, lift, n, element, weight, out);
    if (!status) {
        (*out)->summary.snapshot_paths = n_paths;
        (*out)->summary.element_residual = residual;
        find_range_of_snapshots(*out, n_paths, snapshots, &samples);
    }
    free(basis);
    free(lift);
    free(weight);
    free(element);
    free(samples.q);
    return status;
}

palp_status palp_reduced_create(palp_network *net, size_t n_paths, palp_snapshots *const *snapshots,
                                size_t n_held_out, palp_snapshots *const *held_out,
                                const palp_reduce_settings *settings, palp_reduced **reduced,
                                palp_reduce_error *error_held_out, palp_error *error) {
    if (!net || !snapshots || (n_held_out > 0 && !held_out) || !settings || !reduced)
        return palp_error_null(error);
    palp_status status =
        check_creation_arguments(net, n_paths, snapshots, n_held_out, held_out, settings, error);
    if (!status && net->ranks)
        status = palp_error_set(error, PALP_ERR_UNSUPPORTED, "a part of a network cannot be reduced");
    if (status)
        return status;
    palp_reduced *made = NULL;
    const contact_set *contacts = contact_of(net);
    const size_t n_terms = net->n_terms;
    palp_network_reset(net);
    net->n_terms = 0; /* the stiffness at rest has no tools and no cuts */
    status = build_reduced_model(net, n_paths, snapshots, settings, contacts, &made);
    net->n_terms = n_terms;
    palp_network_reset(net);
    if (!status)
        status = measure_errors_on_paths(made, n_paths, snapshots, n_held_out, held_out, error_held_out);
    if (status) {
        palp_reduced_free(made);
        return palp_error_set(error, status, "%s",
                              status == PALP_ERR_ARGUMENT ? "the snapshot paths do not move the network"
                                                          : palp_status_text(status));
    }
    *reduced = made;
    return PALP_OK;
}

palp_reduced_summary palp_reduced_describe(const palp_reduced *r) {
    return r ? r->summary : (palp_reduced_summary){0};
}

palp_status palp_reduced_set_limits(palp_reduced *r, double tolerance, int max_iterations) {
    if (!r)
        return PALP_ERR_ARGUMENT;
    if (!(tolerance > 0.0) || !(tolerance < 1.0) || max_iterations < 1)
        return PALP_ERR_ARGUMENT;
    r->tolerance = tolerance;
    r->max_iterations = max_iterations;
    return PALP_OK;
}

palp_status palp_reduced_positions(const palp_reduced *r, size_t n, const int32_t *nodes, double *x_m) {
    if (!r || !x_m)
        return PALP_ERR_ARGUMENT;
    if (!nodes && n > r->n_nodes)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        size_t node = nodes ? (size_t)nodes[i] : i;
        if (node >= r->n_nodes)
            return PALP_ERR_ARGUMENT;
        for (size_t k = 0; k < 3; k++)
            x_m[3 * i + k] = reduced_coordinate(r, r->now.q, r->now.depth, 3 * node + k);
    }
    return PALP_OK;
}

size_t palp_reduced_node_count(const palp_reduced *r) {
    return r ? r->n_nodes : 0;
}

size_t palp_reduced_triangle_count(const palp_reduced *r) {
    return r ? r->n_triangles : 0;
}

const int32_t *palp_reduced_triangles(const palp_reduced *r) {
    return r ? r->triangles : NULL;
}
