/* network_state.c: states of a network and of its terms: allocated, reset to rest, marked, saved to a buffer
 * and restored. */
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <stdlib.h>
#include <string.h>

/* All but the strain. */
static void allocate_history(const palp_material *material, size_t m, arena *memory, element_history *h) {
    if (material->quasi_linear)
        h->elastic = arena_take(memory, m, sizeof(double));
    h->arm = arena_take(memory, m * material->n_arms, sizeof(double));
    h->stride = m;
}

static void allocate_state_arrays(const palp_network *net, arena *memory, network_state *s) {
    size_t n3 = 3 * net->n_nodes, m = net->n_elements;
    s->x = arena_take(memory, n3, sizeof(double));
    s->inner = arena_take(memory, n3, sizeof(double));
    s->element = arena_take(memory, m, sizeof(double));
    if (net->mass) {
        s->velocity = arena_take(memory, n3, sizeof(double));
        s->acceleration = arena_take(memory, n3, sizeof(double));
    }
    s->history.strain = arena_take(memory, m, sizeof(double));
    allocate_history(&net->material, m, memory, &s->history);
    for (size_t r = 0; r < net->n_regions; r++) {
        s->region[r].strain = s->history.strain;
        if (net->region[r].share)
            allocate_history(&net->region[r].given.own_material, m, memory, &s->region[r]);
    }
    if (net->damage)
        s->history.peak = arena_take(memory, m, sizeof(double));
    if (net->material.formulation == PALP_SEDEF2008 && net->material.n_arms > 0)
        s->vector = arena_take(memory, 3 * m, sizeof(double));
}

void network_pass(network_cursor *c, void *data, size_t bytes) {
    if (c->way == NETWORK_SAVE)
        memcpy(c->at, data, bytes);
    else if (c->way == NETWORK_RESTORE)
        memcpy(data, c->at, bytes);
    if (c->at)
        c->at += bytes;
    c->bytes += bytes;
}

/* The committed state, with that of the terms. */
static void pass_committed_state(palp_network *net, network_cursor *c) {
    network_state *s = &net->now;
    const size_t n3 = 3 * net->n_nodes * sizeof(double), m = net->n_elements * sizeof(double);
    void *arrays[] = {s->x,
                      s->inner,
                      s->velocity,
                      s->acceleration,
                      s->element,
                      s->history.strain,
                      s->history.elastic,
                      s->history.arm,
                      s->history.peak,
                      s->vector,
                      &s->depth,
                      &s->time,
                      &s->force};
    const size_t bytes[] = {n3,
                            n3,
                            n3,
                            n3,
                            m,
                            m,
                            m,
                            m * net->material.n_arms,
                            m,
                            3 * m,
                            sizeof s->depth,
                            sizeof s->time,
                            sizeof s->force};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (arrays[i])
            network_pass(c, arrays[i], bytes[i]);
    for (size_t r = 0; r < net->n_regions; r++)
        if (net->region[r].share) {
            if (s->region[r].elastic)
                network_pass(c, s->region[r].elastic, m);
            network_pass(c, s->region[r].arm, m * net->region[r].given.own_material.n_arms);
        }
    NETWORK_EACH_TERM(net, pass, net, c);
    if (c->way == NETWORK_RESTORE)
        NETWORK_EACH_TERM(net, grasp_changed, net);
}

/* What the predictor keeps of earlier states and of the branch. */
static void pass_predictor_state(palp_network *net, network_cursor *c) {
    for (size_t i = 0; i < NETWORK_PAST; i++)
        network_pass(c, net->past[i], 3 * net->n_nodes * sizeof *net->past[i]);
    network_pass(c, net->past_depth, sizeof net->past_depth);
    network_pass(c, net->past_time, sizeof net->past_time);
    network_pass(c, &net->n_past, sizeof net->n_past);
    network_pass(c, &net->buckled, sizeof net->buckled);
    network_pass(c, &net->checked_depth, sizeof net->checked_depth);
    network_pass(c, &net->unstable_depth, sizeof net->unstable_depth);
}

static bool allocate_restore_mark(palp_network *net) {
    network_cursor c = {.way = NETWORK_COUNT};
    pass_committed_state(net, &c);
    unsigned char *mark = realloc(net->mark, c.bytes);
    if (mark)
        net->mark = mark;
    return mark;
}

void network_point_at_next(palp_network *net) {
    net->strain = net->next.history.strain;
    net->force = net->own_force ? net->own_force : net->next.element;
}

palp_status network_allocate_states(palp_network *net) {
    network_state old[2] = {net->now, net->next}, fresh[2] = {{0}};
    double *past[NETWORK_PAST], *own_force = NULL;
    arena memory = {NULL, false};
    allocate_state_arrays(net, &memory, &fresh[0]);
    allocate_state_arrays(net, &memory, &fresh[1]);
    if (fresh[0].vector)
        own_force = arena_take(&memory, net->n_elements, sizeof *own_force);
    for (size_t i = 0; i < NETWORK_PAST; i++) /* a step swaps them with a state's x */
        past[i] = arena_take(&memory, 3 * net->n_nodes, sizeof *past[i]);
    net->now = fresh[0];
    net->next = fresh[1];
    bool ok = !memory.failed && allocate_restore_mark(net);
    if (!ok) {
        net->now = old[0];
        net->next = old[1];
    }
    arena_free(ok ? &net->states : &memory);
    if (ok) {
        net->states = memory;
        memcpy(net->past, past, sizeof past);
        net->own_force = own_force;
        network_point_at_next(net);
    }
    return ok ? PALP_OK : PALP_ERR_NO_MEMORY;
}

void *network_term_new(const network_term_kind *kind, size_t size) {
    network_term *term = calloc(1, size);
    if (term)
        term->kind = kind;
    return term;
}

void network_term_free(network_term *term) {
    if (term)
        arena_free(&term->memory);
    free(term);
}

palp_status network_add_terms(palp_network *net, size_t n, network_term *const *terms) {
    bool ok = net->n_terms + n <= NETWORK_TERMS;
    for (size_t i = 0; i < n; i++)
        ok = ok && terms[i] && !terms[i]->memory.failed;
    for (size_t i = 0; i < n && ok; i++)
        net->terms[net->n_terms + i] = terms[i];
    net->n_terms += ok ? n : 0;
    if (ok && allocate_restore_mark(net)) {
        for (size_t i = 0; i < n; i++)
            if (terms[i]->kind->reset)
                terms[i]->kind->reset(terms[i], net);
        return PALP_OK;
    }
    net->n_terms -= ok ? n : 0;
    for (size_t i = 0; i < n; i++)
        network_term_free(terms[i]);
    return PALP_ERR_NO_MEMORY;
}

network_term *network_find_term(const palp_network *net, const network_term_kind *kind) {
    for (size_t i = 0; i < net->n_terms; i++)
        if (net->terms[i]->kind == kind)
            return net->terms[i];
    return NULL;
}

/* ---- rest, aside and back ------------------------------------------------------------------------ */

static void clear_history(const palp_material *material, size_t bytes, element_history *h) {
    if (h->elastic)
        memset(h->elastic, 0, bytes);
    memset(h->arm, 0, bytes * material->n_arms);
}

void palp_network_reset(palp_network *net) {
    if (!net)
        return;
    network_state *s = &net->now;
    size_t n3 = 3 * net->n_nodes * sizeof(double), m = net->n_elements * sizeof(double);
    memcpy(s->x, net->rest, n3);
    memset(s->inner, 0, n3);
    memset(s->element, 0, m);
    if (net->mass) {
        memset(s->velocity, 0, n3);
        memset(s->acceleration, 0, n3);
    }
    memset(s->history.strain, 0, m);
    clear_history(&net->material, m, &s->history);
    for (size_t r = 0; r < net->n_regions; r++)
        if (net->region[r].share)
            clear_history(&net->region[r].given.own_material, m, &s->region[r]);
    if (s->history.peak)
        memset(s->history.peak, 0, m);
    if (s->vector)
        memset(s->vector, 0, 3 * m);
    s->depth = s->time = s->force = 0.0;
    net->n_past = 0;
    net->trial = net->factored = net->buckled = false;
    net->checked_depth = net->unstable_depth = 0.0;
    net->resets++;
    NETWORK_EACH_TERM(net, reset, net);
}

void network_mark_save(palp_network *net) {
    network_cursor c = {NETWORK_SAVE, net->mark, 0};
    pass_committed_state(net, &c);
}

void network_mark_restore(palp_network *net) {
    network_cursor c = {NETWORK_RESTORE, net->mark, 0};
    pass_committed_state(net, &c);
    net->n_past = 0;
    net->trial = false;
}

/* Precedes the state; sum is a checksum of the state. Saver and restorer must agree in all other fields. */
typedef struct header {
    uint64_t magic, size, like, sum;
} header;

uint64_t network_sum(uint64_t sum, const void *data, size_t bytes) {
    const unsigned char *at = data;
    uint64_t word = 0;
    for (; bytes >= sizeof word; bytes -= sizeof word, at += sizeof word) {
        memcpy(&word, at, sizeof word);
        sum = (sum ^ word) * UINT64_C(0x100000001b3);
        sum ^= sum >> 32;
    }
    for (; bytes > 0; bytes--)
        sum = (sum ^ *at++) * UINT64_C(0x100000001b3);
    return sum;
}

uint64_t network_sum_of_material(uint64_t sum, const palp_material *m) {
    const uint64_t number[] = {m->law.kind, m->law.n, m->n_arms, m->quasi_linear, m->formulation};
    const double value[] = {m->law.area_m2, m->law.strain_max, m->dashpot_Ns};
    sum = network_sum(sum, number, sizeof number);
    sum = network_sum(sum, value, sizeof value);
    sum = network_sum(sum, m->law.coefficients, m->law.n * sizeof *m->law.coefficients);
    sum = network_sum(sum, m->law.strain, m->law.n * sizeof *m->law.strain);
    return network_sum(sum, m->arms, m->n_arms * sizeof *m->arms);
}

/* Distinguishes networks of another mesh, other supports, materials, regions, density or integrator. */
static uint64_t fingerprint_of_network(const palp_network *net) {
    const size_t n3 = 3 * net->n_nodes;
    const uint64_t number[] = {net->n_nodes,
                               net->n_elements,
                               net->n_free,
                               net->n_terms,
                               net->n_regions,
                               net->now.history.peak != NULL,
                               net->settings.integrator};
    const double value[] = {net->settings.density_kg_m3, net->settings.volume_modulus_Pa,
                            net->settings.poisson_ratio, net->settings.spectral_radius};
    const double *scale = palp_mesh_element_scale(net->mesh);
    size_t corners;
    const int32_t *node;
    uint64_t sum = network_sum(NETWORK_SUM, number, sizeof number);
    sum = network_sum(sum, value, sizeof value);
    sum = network_sum_of_material(sum, &net->material);
    for (size_t r = 0; r < net->n_regions; r++) {
        const network_region *region = &net->region[r];
        const double own[] = {region->given.stiffness, region->given.poisson_ratio};
        sum = network_sum(sum, own, sizeof own);
        sum = network_sum(sum, region->inside,
                          mesh_solids(net->mesh, &corners, &node) * sizeof *region->inside);
        sum = region->share ? network_sum_of_material(sum, &region->given.own_material) : sum;
    }
    if (net->edge)
        sum = network_sum(sum, net->edge, mesh_solids(net->mesh, &corners, &node) * sizeof *net->edge);
    sum = network_sum(sum, net->rest, n3 * sizeof *net->rest);
    sum = network_sum(sum, net->pair, 2 * net->n_elements * sizeof *net->pair);
    sum = network_sum(sum, net->motion, n3 * sizeof *net->motion);
    sum = network_sum(sum, net->dof, n3 * sizeof *net->dof);
    return scale ? network_sum(sum, scale, net->n_elements * sizeof *scale) : sum;
}

size_t palp_network_state_size(const palp_network *net) {
    if (!net)
        return 0;
    palp_network *counted = (palp_network *)net; /* counting changes nothing */
    network_cursor c = {.way = NETWORK_COUNT};
    pass_committed_state(counted, &c);
    pass_predictor_state(counted, &c);
    return sizeof(header) + c.bytes;
}

static header state_buffer_header(const palp_network *net, const void *buffer) {
    size_t size = palp_network_state_size(net);
    const unsigned char *state = (const unsigned char *)buffer + sizeof(header);
    return (header){UINT64_C(0x70616c7061746534), size, fingerprint_of_network(net),
                    network_sum(NETWORK_SUM, state, size - sizeof(header))};
}

palp_status palp_network_save(const palp_network *net, void *buffer, size_t size) {
    if (!net)
        return PALP_ERR_ARGUMENT;
    if (!buffer || size < palp_network_state_size(net))
        return PALP_ERR_ARGUMENT;
    network_cursor c = {NETWORK_SAVE, (unsigned char *)buffer + sizeof(header), 0};
    palp_network *saved = (palp_network *)net; /* saving only reads */
    pass_committed_state(saved, &c);
    pass_predictor_state(saved, &c);
    header h = state_buffer_header(net, buffer);
    memcpy(buffer, &h, sizeof h);
    return PALP_OK;
}

static palp_status check_saved_state(const palp_network *net, const void *buffer, size_t size) {
    header found, own;
    if (!buffer || size < palp_network_state_size(net))
        return PALP_ERR_ARGUMENT;
    memcpy(&found, buffer, sizeof found);
    own = state_buffer_header(net, buffer);
    if (memcmp(&found, &own, offsetof(header, sum)) != 0)
        return PALP_ERR_ARGUMENT;
    return found.sum == own.sum ? PALP_OK : PALP_ERR_INPUT;
}

palp_status palp_network_restore(palp_network *net, const void *buffer, size_t size) {
    if (!net || !buffer)
        return PALP_ERR_ARGUMENT;
    palp_status status = check_saved_state(net, buffer, size);
    if (status)
        return status;
    network_cursor c = {NETWORK_RESTORE, (unsigned char *)buffer + sizeof(header), 0}; /* only read */
    net->trial = net->factored = net->exact = false;
    pass_committed_state(net, &c);
    pass_predictor_state(net, &c);
    return PALP_OK;
}
