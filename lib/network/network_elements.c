/* network_elements.c: the loop over all elements for their forces. They go in chunks that stay in the
 * cache, with an array for each axis. All but gathering from and adding to nodes is vectorized. */
#include "base/clones.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

static const double COLLAPSED = -1.0 + 1e-9; /* strain at which an element has no length */

enum { CHUNK = NETWORK_CHUNK, LANES = 8, RUN = 4 };

/* Work arrays of a chunk's elements, and pointers to where its results go. */
typedef struct chunk {
    size_t at, n; /* elements at to at + n - 1 */
    double d[3][CHUNK + LANES],
        square[CHUNK + LANES]; /* by axis: difference of the end nodes, later force; and its square */
    double *strain, *inverse_length, *force, *tangent;
    element_history next;
    bool keep; /* next is the network's */
} chunk;

/* Room for results of a chunk that the network need not keep. */
typedef struct chunk_room {
    double inverse_length[CHUNK], tangent[CHUNK];
    double strain[CHUNK], force[CHUNK], elastic[CHUNK], peak[CHUNK], arm[PALP_ARMS_MAX][CHUNK];
} chunk_room;

/* Lists the runs unless run is NULL; returns their number. */
static size_t list_consecutive_runs(const palp_network *net, network_run *run, size_t *first_run) {
    const int32_t *pair = net->pair;
    size_t n = 0;
    for (size_t i = 0; i < net->n_elements; i++) {
        const bool chunk_starts = i % CHUNK == 0;
        if (chunk_starts && run)
            first_run[i / CHUNK] = n;
        if (chunk_starts || pair[2 * i] != pair[2 * i - 2] + 1 || pair[2 * i + 1] != pair[2 * i - 1] + 1) {
            if (run)
                run[n] = (network_run){pair[2 * i], pair[2 * i + 1], 0};
            n++;
        }
        if (run)
            run[n - 1].n++;
    }
    if (run)
        first_run[(net->n_elements + CHUNK - 1) / CHUNK] = n;
    return n;
}

/* Distance between the axes of a vector by axis: loads of whole lanes may go beyond its end. */
static size_t stride_of_axis_vectors(const palp_network *net) {
    return net->n_nodes + LANES;
}

palp_status network_make_runs(palp_network *net) {
    const size_t n = list_consecutive_runs(net, NULL, NULL);
    if (RUN * n > net->n_elements + 3 * RUN * (net->n_elements / CHUNK + 1))
        return PALP_OK;
    net->first_run = arena_take(&net->memory, net->n_elements / CHUNK + 2, sizeof *net->first_run);
    net->straight = arena_take(&net->memory, 6 * stride_of_axis_vectors(net), sizeof *net->straight);
    net->run = arena_take(&net->memory, n, sizeof *net->run);
    if (net->memory.failed)
        return PALP_ERR_NO_MEMORY;
    list_consecutive_runs(net, net->run, net->first_run);
    return PALP_OK;
}

/* Several numbers of a vector at once. Local variables only: passing them to functions differs with and
 * without AVX. */
typedef double four __attribute__((vector_size(4 * sizeof(double))));
typedef double two __attribute__((vector_size(2 * sizeof(double))));
typedef float four_floats __attribute__((vector_size(4 * sizeof(float))));

#define LOAD(v, p) memcpy(&(v), p, sizeof(v))
#define STORE(p, v) memcpy(p, &(v), sizeof(v))
#define ADD_TO(p, v) (LOAD(sum, p), sum += (v), STORE(p, sum))
#define DELIVER(lanes)                                                                                       \
    do {                                                                                                     \
        lanes v0, v1, v2, sum;                                                                               \
        LOAD(v0, f0 + i), LOAD(v1, f1 + i), LOAD(v2, f2 + i);                                                \
        ADD_TO(out + low + i, v0), ADD_TO(out1 + low + i, v1), ADD_TO(out2 + low + i, v2);                   \
        ADD_TO(out + high + i, -v0), ADD_TO(out1 + high + i, -v1), ADD_TO(out2 + high + i, -v2);             \
        i += (int32_t)(sizeof(lanes) / sizeof(double));                                                      \
    } while (0)

/* d = x at the second node less x at the first, by axis, and its square. What is written behind a run is
 * overwritten by the next run, or is spare room. */
PALP_CLONES
static void fetch_run_differences(size_t n, const network_run *run, const double *x, size_t stride,
                                  double *d0, double *d1, double *d2, double *square) {
    const double *x1 = x + stride, *x2 = x1 + stride;
    for (size_t r = 0; r < n; r++) {
        const int32_t low = run[r].low, high = run[r].high;
        for (int32_t i = 0; i < run[r].n; i += 4) {
            four a0, a1, a2, b0, b1, b2;
            LOAD(a0, x + low + i), LOAD(a1, x1 + low + i), LOAD(a2, x2 + low + i);
            LOAD(b0, x + high + i), LOAD(b1, x1 + high + i), LOAD(b2, x2 + high + i);
            b0 -= a0, b1 -= a1, b2 -= a2;
            STORE(d0 + i, b0), STORE(d1 + i, b1), STORE(d2 + i, b2);
            b0 = b0 * b0 + b1 * b1 + b2 * b2;
            STORE(square + i, b0);
        }
        d0 += run[r].n, d1 += run[r].n, d2 += run[r].n, square += run[r].n;
    }
}

/* Adds f, by axis, to out at the first nodes and subtracts it at the second nodes. */
PALP_CLONES
static void deliver_run_forces(size_t n, const network_run *run, const double *f0, const double *f1,
                               const double *f2, double *out, size_t stride) {
    double *out1 = out + stride, *out2 = out1 + stride;
    for (size_t r = 0; r < n; r++) {
        const int32_t low = run[r].low, high = run[r].high;
        int32_t i = 0;
        while (i + 4 <= run[r].n)
            DELIVER(four);
        if (i + 2 <= run[r].n)
            DELIVER(two);
        if (i < run[r].n)
            DELIVER(double);
        f0 += run[r].n, f1 += run[r].n, f2 += run[r].n;
    }
}

/* Copies x[3 n_nodes] by axis for fetching, and clears the sum. */
static void begin_exchange_by_axis(const palp_network *net, const double *x) {
    const size_t stride = stride_of_axis_vectors(net);
    double *to = net->straight;
    if (!net->run)
        return;
    for (size_t i = 0; i < net->n_nodes; i++)
        for (size_t c = 0; c < 3; c++)
            to[c * stride + i] = x[3 * i + c];
    memset(to + 3 * stride, 0, 3 * stride * sizeof *to);
}

/* Adds the sum to out[3 n_nodes]. */
static void add_delivered_forces(const palp_network *net, double *out) {
    const size_t stride = stride_of_axis_vectors(net);
    const double *sum = net->run ? net->straight + 3 * stride : NULL;
    for (size_t i = 0; i < net->n_nodes && sum; i++)
        for (size_t c = 0; c < 3; c++)
            out[3 * i + c] += sum[c * stride + i];
}

/* Difference of x[3 n_nodes] over each element, and its square. */
static void fetch_chunk_differences(const palp_network *net, const double *x, chunk *c) {
    const int32_t *pair = net->pair + 2 * c->at;
    if (net->run) {
        const size_t *first = net->first_run + c->at / CHUNK;
        fetch_run_differences(first[1] - first[0], net->run + first[0], net->straight,
                              stride_of_axis_vectors(net), c->d[0], c->d[1], c->d[2], c->square);
        return;
    }
    for (size_t i = 0; i < c->n; i++) {
        const double *a = x + 3 * pair[2 * i], *b = x + 3 * pair[2 * i + 1];
        c->d[0][i] = b[0] - a[0];
        c->d[1][i] = b[1] - a[1];
        c->d[2][i] = b[2] - a[2];
        c->square[i] = c->d[0][i] * c->d[0][i] + c->d[1][i] * c->d[1][i] + c->d[2][i] * c->d[2][i];
    }
}

/* Adds to the first nodes, subtracts from the second ones. Elements mostly come grouped by first node, whose
 * share is summed in a register: repeated addition to memory would wait for the one before. */
static void deliver_chunk_forces(const palp_network *net, const chunk *c, double *out) {
    const int32_t *pair = net->pair + 2 * c->at;
    if (net->run) {
        const size_t *first = net->first_run + c->at / CHUNK, stride = stride_of_axis_vectors(net);
        deliver_run_forces(first[1] - first[0], net->run + first[0], c->d[0], c->d[1], c->d[2],
                           net->straight + 3 * stride, stride);
        return;
    }
    for (size_t i = 0; i < c->n;) {
        const int32_t first = pair[2 * i];
        double s0 = 0.0, s1 = 0.0, s2 = 0.0, *a = out + 3 * first;
        for (; i < c->n && pair[2 * i] == first; i++) {
            double *b = out + 3 * pair[2 * i + 1];
            const double f0 = c->d[0][i], f1 = c->d[1][i], f2 = c->d[2][i];
            s0 += f0;
            s1 += f1;
            s2 += f2;
            b[0] -= f0;
            b[1] -= f1;
            b[2] -= f2;
        }
        a[0] += s0;
        a[1] += s1;
        a[2] += s2;
    }
}

static chunk chunk_of_elements_at(const palp_network *net, size_t at) {
    size_t left = net->n_elements - at;
    chunk c;
    c.at = at;
    c.n = left < CHUNK ? left : CHUNK;
    return c;
}

PALP_CLONES
static void measure_strain_of_chunk(size_t n, const double *restrict square,
                                    const double *restrict inverse_rest, double *restrict strain,
                                    double *restrict inverse_length) {
    for (size_t i = 0; i < n; i++) {
        double length = sqrt(square[i]);
        strain[i] = length * inverse_rest[i] - 1.0;
        inverse_length[i] = 1.0 / length;
    }
}

/* Turns d into the force on the first node. */
PALP_CLONES
static void direct_forces_along_elements(size_t n, const double *restrict force,
                                         const double *restrict inverse_length, double *restrict d0,
                                         double *restrict d1, double *restrict d2) {
    for (size_t i = 0; i < n; i++) {
        const double pull = force[i] * inverse_length[i];
        d0[i] *= pull;
        d1[i] *= pull;
        d2[i] *= pull;
    }
}

PALP_CLONES
static void divide_by_element_length(size_t n, const double *restrict d,
                                     const double *restrict inverse_length, double *restrict direction) {
    for (size_t i = 0; i < n; i++)
        direction[i] = d[i] * inverse_length[i];
}

/* sum[LANES] += squares. */
PALP_CLONES
static void accumulate_squares(size_t n, const double *restrict x, double *restrict sum) {
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t k = 0; k < LANES; k++)
            sum[k] += x[i + k] * x[i + k];
    for (; i < n; i++)
        sum[0] += x[i] * x[i];
}

static double sum_of_all_lanes(const double s[LANES]) {
    return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
}

PALP_CLONES
double network_dot(const double *a, const double *b, size_t n) {
    double sum[LANES] = {0.0}; /* several partial sums, which are added independently */
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t k = 0; k < LANES; k++)
            sum[k] += a[i + k] * b[i + k];
    for (; i < n; i++)
        sum[0] += a[i] * b[i];
    return sum_of_all_lanes(sum);
}

PALP_CLONES
double network_distance(const double *a, const double *b, size_t n) {
    double sum[LANES] = {0.0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t k = 0; k < LANES; k++)
            sum[k] += (a[i + k] - b[i + k]) * (a[i + k] - b[i + k]);
    for (; i < n; i++)
        sum[0] += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum_of_all_lanes(sum));
}

/* Number of collapsed elements. */
PALP_CLONES
static size_t count_collapsed_elements(size_t n, const double *strain) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        count += strain[i] > COLLAPSED ? 0 : 1;
    return count;
}

static element_history history_of_elements_from(const element_history *h, size_t at) {
    return (element_history){h->strain + at, h->elastic ? h->elastic + at : NULL, h->arm + at,
                             h->peak ? h->peak + at : NULL, h->stride};
}

/* A chunk whose results go to the network; with room, only strain, force and history do, if they are kept. */
static chunk chunk_with_result_arrays(palp_network *net, size_t at, bool keep, chunk_room *room) {
    chunk c = chunk_of_elements_at(net, at);
    c.keep = keep;
    c.inverse_length = room ? room->inverse_length : net->inverse_length + at;
    c.tangent = room ? room->tangent : net->tangent + at;
    c.strain = keep ? net->strain + at : room->strain;
    c.force = keep ? net->force + at : room->force;
    c.next = keep ? history_of_elements_from(&net->next.history, at)
                  : (element_history){room->strain, room->elastic, room->arm[0], room->peak, CHUNK};
    return c;
}

static void measure_chunk_of_network(palp_network *net, chunk *c) {
    fetch_chunk_differences(net, net->next.x, c);
    measure_strain_of_chunk(c->n, c->square, net->inverse_rest + c->at, c->strain, c->inverse_length);
}

static void find_directions_of_chunk(palp_network *net, const chunk *c) {
    for (size_t k = 0; k < 3; k++)
        divide_by_element_length(c->n, c->d[k], c->inverse_length,
                                 net->direction + k * net->n_elements + c->at);
}

/* Adds the part of PALP_SEDEF2008's force that is a vector from the last step. */
static void carry_sedef_force_vector(palp_network *net, chunk *c) {
    const double *old = net->now.vector + 3 * c->at, share = net->step.carry;
    double *vector = net->next.vector + 3 * c->at;
    for (size_t i = 0; i < c->n; i++)
        for (size_t k = 0; k < 3; k++)
            vector[3 * i + k] = c->d[k][i] += share * old[3 * i + k];
}

PALP_CLONES
static void multiply_by_share(size_t n, const double *restrict share, double *restrict force,
                              double *restrict tangent) {
    for (size_t i = 0; i < n; i++) {
        force[i] *= share[i];
        tangent[i] *= share[i];
    }
}

PALP_CLONES
static void add_share(size_t n, const double *restrict share, const double *restrict more_force,
                      const double *restrict more_tangent, double *restrict force, double *restrict tangent) {
    for (size_t i = 0; i < n; i++) {
        force[i] += share[i] * more_force[i];
        tangent[i] += share[i] * more_tangent[i];
    }
}

static void evaluate_own_material(palp_network *net, chunk *c) {
    const element_history old = history_of_elements_from(&net->now.history, c->at);
    element_trial(&net->material, &net->step, c->n, c->strain, &old, &c->next, c->force, c->tangent);
}

/* Forces where some elements have another material than the network, or parts of several. Histories are those
 * of whole elements of each material. */
static void evaluate_chunk_of_materials(palp_network *net, chunk *c) {
    const unsigned has = net->chunk_has[c->at / CHUNK];
    chunk_room room;
    if (has & 1U) {
        evaluate_own_material(net, c);
        multiply_by_share(c->n, net->base_share + c->at, c->force, c->tangent);
    } else {
        memset(c->force, 0, c->n * sizeof *c->force);
        memset(c->tangent, 0, c->n * sizeof *c->tangent);
    }
    for (size_t r = 0; r < net->n_regions; r++) {
        if (!(has & 2U << r))
            continue;
        const network_region *region = &net->region[r];
        const element_history old = history_of_elements_from(&net->now.region[r], c->at);
        element_history next = {room.strain, room.elastic, room.arm[0], room.peak, CHUNK};
        if (c->keep)
            next = history_of_elements_from(&net->next.region[r], c->at);
        element_trial(&region->given.own_material, &region->step, c->n, c->strain, &old, &next, room.force,
                      room.tangent);
        add_share(c->n, region->share + c->at, room.force, room.tangent, c->force, c->tangent);
    }
}

static void evaluate_chunk_forces(palp_network *net, chunk *c) {
    if (net->base_share)
        evaluate_chunk_of_materials(net, c);
    else
        evaluate_own_material(net, c);
    for (size_t i = 0; i < c->n && net->scale; i++) {
        c->force[i] *= net->scale[c->at + i];
        c->tangent[i] *= net->scale[c->at + i];
    }
    direct_forces_along_elements(c->n, c->force, c->inverse_length, c->d[0], c->d[1], c->d[2]);
    if (net->next.vector)
        carry_sedef_force_vector(net, c);
    deliver_chunk_forces(net, c, net->fint);
}

/* Gives cut elements strain 0 and no direction. */
static void reset_cut_elements(palp_network *net) {
    const size_t m = net->n_elements;
    for (size_t k = 0; k < net->n_dead; k++) {
        size_t i = (size_t)net->dead[k];
        net->strain[i] = 0.0;
        net->inverse_length[i] = net->inverse_rest[i];
        net->direction[i] = net->direction[m + i] = net->direction[2 * m + i] = 0.0;
    }
}

/* along and across of the elements' blocks. */
PALP_CLONES
static void find_element_blocks(size_t n, const double *restrict force, const double *restrict inverse_length,
                                const double *restrict tangent, const double *restrict inverse_rest,
                                float *restrict along, float *restrict across) {
    for (size_t i = 0; i < n; i++) {
        const double pull = force[i] * inverse_length[i];
        along[i] = (float)((tangent[i] * inverse_rest[i] - pull) * (inverse_length[i] * inverse_length[i]));
        across[i] = (float)pull;
    }
}

/* Copies numbers of the elements of runs to their places in to[n]. */
PALP_CLONES
static void pack_run_values(size_t n, const network_run *run, const uint32_t *to, const float *from,
                            float *element) {
    for (size_t r = 0; r < n; r++) {
        float *e = element + to[r];
        int32_t i = 0;
        for (four_floats v; i + 4 <= run[r].n; i += 4)
            LOAD(v, from + i), STORE(e + i, v);
        for (; i < run[r].n; i++)
            e[i] = from[i];
        from += run[r].n;
    }
}

static void pack_chunk_blocks(const palp_network *net, const chunk *c, const network_blocks *to) {
    float along[CHUNK], across[CHUNK];
    find_element_blocks(c->n, c->force, c->inverse_length, c->tangent, net->inverse_rest + c->at, along,
                        across);
    if (to->run_place) {
        const size_t *first = net->first_run + c->at / CHUNK, n = first[1] - first[0];
        pack_run_values(n, net->run + first[0], to->run_place + first[0], along, to->element);
        pack_run_values(n, net->run + first[0], to->run_place + first[0], across, to->element + to->spacing);
        return;
    }
    for (size_t i = 0; i < c->n; i++) {
        float *e = to->element + to->place[c->at + i];
        e[0] = along[i];
        e[to->spacing] = across[i];
    }
}

/* Geometry of all elements where some are cut: these have strain 0 and no direction. */
static void measure_partly_cut_network(palp_network *net) {
    for (size_t at = 0; at < net->n_elements; at += CHUNK) {
        chunk c = chunk_with_result_arrays(net, at, true, NULL);
        measure_chunk_of_network(net, &c);
        find_directions_of_chunk(net, &c);
    }
    reset_cut_elements(net);
}

bool network_element_forces(palp_network *net, const network_blocks *blocks) {
    double forces[LANES] = {0.0}, tangents[LANES] = {0.0};
    const bool cut = net->n_dead > 0;
    chunk_room own, *room = blocks && !cut && !net->next.vector ? &own : NULL;
    network_point_at_next(net);
    begin_exchange_by_axis(net, net->next.x);
    if (cut)
        measure_partly_cut_network(net);
    memset(net->fint, 0, 3 * net->n_nodes * sizeof *net->fint);
    for (size_t at = 0; at < net->n_elements; at += CHUNK) {
        chunk c = chunk_with_result_arrays(net, at, !room || !blocks->trial, room);
        if (cut)
            fetch_chunk_differences(net, net->next.x, &c);
        else
            measure_chunk_of_network(net, &c);
        if (count_collapsed_elements(c.n, c.strain) > 0)
            return false;
        if (!room && !cut)
            find_directions_of_chunk(net, &c);
        evaluate_chunk_forces(net, &c);
        accumulate_squares(c.n, c.force, forces);
        accumulate_squares(c.n, c.tangent, tangents);
        if (blocks && blocks->element)
            pack_chunk_blocks(net, &c, blocks);
    }
    add_delivered_forces(net, net->fint);
    net->force_squares = sum_of_all_lanes(forces);
    net->tangent_squares = sum_of_all_lanes(tangents);
    return true;
}
