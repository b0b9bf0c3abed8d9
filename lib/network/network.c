/* network.c: building a network, its state, and what can be asked of it. */
#include "network_internal.h"

#include "base/file.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_network_settings palp_network_settings_default(void) {
    return (palp_network_settings){.tolerance = 1e-10,
                                   .max_iterations = 50,
                                   .branch = PALP_BRANCH_CONTINUE,
                                   .solver = PALP_SOLVER_AUTO,
                                   .density_kg_m3 = 0.0,
                                   .integrator = PALP_BACKWARD_EULER,
                                   .spectral_radius = 0.5,
                                   .check_strain = 5e-3};
}

void palp_supports_default(palp_support supports[2]) {
    supports[0] = (palp_support){"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0.0, 0.0, 0.0}};
    supports[1] = (palp_support){"top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0.0, -1.0, 0.0}};
}

static void state_free(network_state *s) {
    free(s->x);
    free(s->velocity);
    free(s->acceleration);
    free(s->inner);
    free(s->element);
    free(s->history.strain);
    free(s->history.elastic);
    free(s->history.arm);
    free(s->history.peak);
    free(s->vector);
    free(s->load);
}

void palp_network_free(palp_network *net) {
    if (!net)
        return;
    state_free(&net->now);
    state_free(&net->next);
    state_free(&net->mark);
    for (size_t i = 0; i < NETWORK_PAST; i++)
        free(net->past[i]);
    free(net->way[0]);
    free(net->way[1]);
    linsys_free(net->ls);
    network_load_free(net->load);
    network_cut_free(net->cut);
    network_realtime_free(net->realtime);
    palp_mesh_free(net->mesh);
    double *arrays[] = {net->inverse_rest, net->scale, net->motion, net->mass, net->grip, net->node_block, net->direction,
                        net->inverse_length, net->strain, net->force, net->tangent, net->fint,
                        net->inertia_rhs, net->rhs, net->dx, net->start, net->scratch};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(net->dof);
    free(net->slot);
    free(net->slot_node);
    free(net);
}

/* Allocates zeroed doubles; *ok becomes false if it cannot. */
static double *doubles(size_t n, bool *ok) {
    double *p = calloc(n + 1, sizeof *p);
    *ok = *ok && p;
    return p;
}

static bool state_allocate(palp_network *net, network_state *s) {
    size_t n3 = 3 * net->n_nodes, m = net->n_elements;
    bool ok = true;
    s->x = doubles(n3, &ok);
    s->inner = doubles(n3, &ok);
    s->element = doubles(m, &ok);
    if (net->mass) {
        s->velocity = doubles(n3, &ok);
        s->acceleration = doubles(n3, &ok);
    }
    s->history.strain = doubles(m, &ok);
    s->history.elastic = doubles(m, &ok);
    s->history.arm = doubles(m * net->material.n_arms, &ok);
    if (net->wear)
        s->history.peak = doubles(m, &ok);
    if (net->material.formulation == PALP_SEDEF2008 && net->material.n_arms > 0)
        s->vector = doubles(3 * m, &ok);
    s->load = net->load ? calloc(1, net->load_size) : NULL;
    return ok && (s->load || !net->load);
}

/* The states are as large as the material asks for; called again when the material changes. */
static palp_status allocate_states(palp_network *net) {
    network_state *states[] = {&net->now, &net->next, &net->mark}, fresh[3] = {{0}};
    bool ok = true;
    for (size_t i = 0; i < 3; i++)
        ok = state_allocate(net, &fresh[i]) && ok;
    for (size_t i = 0; i < 3; i++) {
        network_state old = *states[i];
        if (ok)
            *states[i] = fresh[i];
        state_free(ok ? &old : &fresh[i]);
    }
    return ok ? PALP_OK : PALP_ERR_NO_MEMORY;
}

static palp_status allocate(palp_network *net) {
    size_t n3 = 3 * net->n_nodes, m = net->n_elements;
    bool ok = true;
    net->inverse_rest = doubles(m, &ok);
    net->motion = doubles(n3, &ok);
    net->node_block = doubles(6 * net->n_nodes, &ok);
    net->direction = doubles(3 * m, &ok);
    net->inverse_length = doubles(m, &ok);
    net->strain = doubles(m, &ok);
    net->force = doubles(m, &ok);
    net->tangent = doubles(m, &ok);
    net->fint = doubles(n3, &ok);
    net->rhs = doubles(n3, &ok);
    net->dx = doubles(n3, &ok);
    net->start = doubles(n3, &ok);
    net->scratch = doubles(2 * m, &ok);
    for (size_t i = 0; i < NETWORK_PAST; i++)
        net->past[i] = doubles(n3, &ok);
    net->way[0] = doubles(n3, &ok);
    net->way[1] = doubles(n3, &ok);
    if (net->settings.density_kg_m3 > 0.0) {
        net->mass = doubles(net->n_nodes, &ok);
        net->inertia_rhs = doubles(n3, &ok);
    }
    net->dof = calloc(n3 + 1, sizeof *net->dof);
    net->slot = malloc((9 * m + 1) * sizeof *net->slot);
    net->slot_node = malloc((6 * net->n_nodes + 1) * sizeof *net->slot_node);
    return ok && net->dof && net->slot && net->slot_node ? allocate_states(net) : PALP_ERR_NO_MEMORY;
}

static palp_status apply_support(palp_network *net, const palp_support *support, palp_error *error) {
    const int32_t *nodes;
    size_t n;
    if (palp_mesh_set(net->mesh, support->set, &n, &nodes))
        return palp_error_set(error, PALP_ERR_INPUT, "the mesh has no node set \"%s\"", support->set);
    for (size_t k = 0; k < 3; k++)
        if (support->axis[k] == PALP_DRIVEN && !isfinite(support->motion[k]))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "the motion of node set \"%s\" is not a number",
                                  support->set);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) {
            size_t d = 3 * (size_t)nodes[i] + k;
            if (support->axis[k] == PALP_FREE)
                continue;
            net->dof[d] = -1;
            net->motion[d] = support->axis[k] == PALP_DRIVEN ? support->motion[k] : 0.0;
        }
    return PALP_OK;
}

static palp_status number_unknowns(palp_network *net, size_t n, const palp_support *supports, palp_error *error) {
    for (size_t i = 0; i < n; i++) {
        palp_status status = apply_support(net, &supports[i], error);
        if (status)
            return status;
    }
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        net->driven = net->driven || net->motion[i] != 0.0;
        if (net->dof[i] >= 0)
            net->dof[i] = (int32_t)net->n_free++;
    }
    return PALP_OK;
}

/* Each tetrahedron's mass to its corners, a quarter each. Hexahedra, whose tetrahedra favour some corners, and
 * meshes without cells, as large as their box: by the rest length of a node's elements. */
static void share_mass(palp_network *net) {
    double low[3], high[3], total = 0.0, volume = palp_mesh_volume(net->mesh, net->mass);
    if (volume > 0.0 && !net->mesh->split) {
        for (size_t i = 0; i < net->n_nodes; i++)
            net->mass[i] *= net->settings.density_kg_m3;
        return;
    }
    palp_mesh_bounds(net->mesh, low, high);
    if (!(volume > 0.0))
        volume = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
    memset(net->mass, 0, net->n_nodes * sizeof *net->mass);
    for (size_t i = 0; i < net->n_elements; i++)
        total += 2.0 / net->inverse_rest[i];
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        net->mass[net->pair[i]] += net->settings.density_kg_m3 * volume / net->inverse_rest[i / 2] / total;
}

static void measure_rest(palp_network *net) {
    double low[3], high[3];
    palp_mesh_bounds(net->mesh, low, high);
    for (size_t k = 0; k < 3; k++)
        net->extent = fmax(net->extent, high[k] - low[k]);
    double motion[3] = {0.0};
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        motion[i % 3] = fmax(motion[i % 3], fabs(net->motion[i]));
    size_t along = motion[1] >= motion[0] ? 1 : 0;
    along = motion[2] > motion[along] ? 2 : along;
    net->height = high[along] - low[along];
    for (size_t i = 0; i < net->n_elements; i++) {
        const double *a = net->rest + 3 * net->pair[2 * i], *b = net->rest + 3 * net->pair[2 * i + 1];
        double length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                             (b[2] - a[2]) * (b[2] - a[2]));
        net->inverse_rest[i] = 1.0 / length;
    }
    if (net->mass)
        share_mass(net);
}

/* Neighbours of each node with a higher or the same number, ascending: [first[a], first[a + 1]). */
static palp_status neighbours(const palp_network *net, size_t **first, int32_t **list) {
    size_t n = net->n_nodes, *count = calloc(n + 2, sizeof *count);
    int32_t *out = malloc((n + net->n_elements + 1) * sizeof *out);
    if (!count || !out) {
        free(count);
        free(out);
        return PALP_ERR_NO_MEMORY;
    }
    for (size_t i = 0; i < n; i++)
        count[i + 2] = 1;
    for (size_t i = 0; i < net->n_elements; i++) {
        int32_t a = net->pair[2 * i], b = net->pair[2 * i + 1];
        count[(a < b ? a : b) + 2]++;
    }
    for (size_t i = 2; i < n + 2; i++)
        count[i] += count[i - 1];
    for (size_t i = 0; i < n; i++)
        out[count[i + 1]++] = (int32_t)i;
    for (size_t i = 0; i < net->n_elements; i++) {
        int32_t a = net->pair[2 * i], b = net->pair[2 * i + 1];
        out[count[(a < b ? a : b) + 1]++] = a < b ? b : a;
    }
    for (size_t i = 0; i < n; i++) /* insertion sort: a node has few neighbours */
        for (size_t j = count[i] + 1; j < count[i + 1]; j++) {
            int32_t v = out[j];
            size_t k = j;
            for (; k > count[i] && out[k - 1] > v; k--)
                out[k] = out[k - 1];
            out[k] = v;
        }
    *first = count;
    *list = out;
    return PALP_OK;
}

/* Lower triangle of the tangent by columns. With row NULL only counts. */
static size_t fill_pattern(const palp_network *net, const size_t *first, const int32_t *list, size_t *column,
                           int32_t *row) {
    size_t nz = 0;
    for (size_t a = 0; a < net->n_nodes; a++)
        for (size_t k = 0; k < 3; k++) {
            int32_t c = net->dof[3 * a + k];
            if (c < 0)
                continue;
            column[c] = nz;
            for (size_t j = first[a]; j < first[a + 1]; j++)
                for (size_t r = 0; r < 3; r++) {
                    int32_t d = net->dof[3 * (size_t)list[j] + r];
                    if (d < c)
                        continue;
                    if (row)
                        row[nz] = d;
                    nz++;
                }
        }
    column[net->n_free] = nz;
    return nz;
}

static palp_status make_linsys(palp_network *net) {
    size_t *first = NULL, *column = malloc((net->n_free + 1) * sizeof *column);
    int32_t *list = NULL, *row = NULL;
    palp_status status = column ? neighbours(net, &first, &list) : PALP_ERR_NO_MEMORY;
    if (!status) {
        size_t nz = fill_pattern(net, first, list, column, NULL);
        row = malloc((nz + 1) * sizeof *row);
        if (row)
            fill_pattern(net, first, list, column, row);
        status = row ? linsys_create(net->settings.solver, net->n_free, column, row, &net->ls) : PALP_ERR_NO_MEMORY;
    }
    free(first);
    free(list);
    free(column);
    free(row);
    return status;
}

static uint32_t slot_of(const palp_network *net, size_t i, size_t j) {
    int32_t a = net->dof[i], b = net->dof[j];
    if (a < 0 || b < 0)
        return (uint32_t)linsys_value_count(net->ls); /* the bin */
    return (uint32_t)(a > b ? linsys_slot(net->ls, (size_t)a, (size_t)b) : linsys_slot(net->ls, (size_t)b, (size_t)a));
}

static palp_status find_slots(palp_network *net) {
    if (linsys_value_count(net->ls) >= UINT32_MAX)
        return PALP_ERR_LIMIT;
    for (size_t i = 0; i < net->n_elements; i++)
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++)
                net->slot[9 * i + 3 * r + c] =
                    slot_of(net, 3 * (size_t)net->pair[2 * i + 1] + r, 3 * (size_t)net->pair[2 * i] + c);
    for (size_t i = 0; i < net->n_nodes; i++) {
        uint32_t *s = net->slot_node + 6 * i;
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c <= r; c++)
                *s++ = slot_of(net, 3 * i + r, 3 * i + c);
    }
    return PALP_OK;
}

static palp_status build(palp_network *net, const palp_mesh *mesh, size_t n_supports, const palp_support *supports,
                         palp_error *error) {
    palp_status status = palp_mesh_copy(mesh, &net->mesh);
    if (status)
        return status;
    net->n_nodes = palp_mesh_node_count(net->mesh);
    net->n_elements = palp_mesh_element_count(net->mesh);
    net->rest = palp_mesh_positions(net->mesh);
    net->pair = palp_mesh_pairs(net->mesh);
    net->surface = palp_mesh_triangles(net->mesh);
    net->n_surface = palp_mesh_triangle_count(net->mesh);
    status = allocate(net);
    const double *scale = palp_mesh_element_scale(net->mesh);
    if (!status && scale) {
        net->scale = malloc(net->n_elements * sizeof *net->scale);
        status = net->scale ? PALP_OK : PALP_ERR_NO_MEMORY;
    }
    if (!status && scale)
        memcpy(net->scale, scale, net->n_elements * sizeof *scale);
    if (!status)
        status = number_unknowns(net, n_supports, supports, error);
    if (status)
        return status;
    measure_rest(net);
    status = make_linsys(net);
    if (!status)
        status = find_slots(net);
    if (status == PALP_ERR_UNSUPPORTED)
        return palp_error_set(error, status, "the supernodal solver needs a build with GPL=1");
    if (status)
        return status;
    /* a factor costs more than ten evaluations (some 20 ns an element) at 20 Gflop/s */
    net->chord = linsys_flops(net->ls) / 20e9 > 10.0 * 20e-9 * (double)net->n_elements;
    palp_network_reset(net);
    return PALP_OK;
}

static bool settings_in_range(const palp_network_settings *s) {
    return s->tolerance > 0.0 && isfinite(s->tolerance) && s->max_iterations >= 1 && s->density_kg_m3 >= 0.0 &&
           isfinite(s->density_kg_m3) && s->spectral_radius >= 0.0 && s->spectral_radius <= 1.0 &&
           s->check_strain >= 0.0 && s->branch <= PALP_BRANCH_STABLE && s->solver <= PALP_SOLVER_SUPERNODAL &&
           s->integrator <= PALP_GENERALIZED_ALPHA;
}

palp_status palp_network_create(const palp_mesh *mesh, const palp_material *material, size_t n_supports,
                                const palp_support *supports, const palp_network_settings *settings,
                                palp_network **network, palp_error *error) {
    palp_status status = palp_material_check(material, error);
    if (status)
        return status;
    if (!settings_in_range(settings))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a network setting is out of range");
    palp_network *net = calloc(1, sizeof *net);
    if (!net)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    net->settings = *settings;
    net->material = *material;
    net->boost = 1.0;
    palp_error why = {PALP_OK, ""};
    status = build(net, mesh, n_supports, supports, &why);
    if (status) {
        palp_network_free(net);
        return palp_error_set(error, status, "%s", why.text[0] ? why.text : palp_status_text(status));
    }
    *network = net;
    return PALP_OK;
}

void network_state_copy(const palp_network *net, network_state *to, const network_state *from) {
    size_t n3 = 3 * net->n_nodes * sizeof(double), m = net->n_elements * sizeof(double);
    memcpy(to->x, from->x, n3);
    memcpy(to->inner, from->inner, n3);
    memcpy(to->element, from->element, m);
    if (net->mass) {
        memcpy(to->velocity, from->velocity, n3);
        memcpy(to->acceleration, from->acceleration, n3);
    }
    memcpy(to->history.strain, from->history.strain, m);
    memcpy(to->history.elastic, from->history.elastic, m);
    memcpy(to->history.arm, from->history.arm, m * net->material.n_arms);
    if (to->history.peak)
        memcpy(to->history.peak, from->history.peak, m);
    if (to->vector)
        memcpy(to->vector, from->vector, 3 * m);
    if (to->load)
        memcpy(to->load, from->load, net->load_size);
    to->depth = from->depth;
    to->time = from->time;
    to->force = from->force;
}

void network_mark(palp_network *net) {
    network_state_copy(net, &net->mark, &net->now);
}

void network_revert(palp_network *net) {
    network_state_copy(net, &net->now, &net->mark);
    net->n_past = 0;
    net->trial = net->can_undo = false;
}

void palp_network_reset(palp_network *net) {
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
    memset(s->history.elastic, 0, m);
    memset(s->history.arm, 0, m * net->material.n_arms);
    if (s->history.peak)
        memset(s->history.peak, 0, m);
    if (s->vector)
        memset(s->vector, 0, 3 * m);
    if (s->load)
        memset(s->load, 0, net->load_size);
    s->depth = s->time = s->force = 0.0;
    net->n_past = 0;
    net->trial = net->factored = net->buckled = net->can_undo = false;
    net->checked_depth = net->unstable_depth = 0.0;
    if (net->realtime)
        network_realtime_reset(net);
    if (net->cut)
        network_cut_reset(net);
}

palp_status palp_network_set_material(palp_network *net, const palp_material *material) {
    palp_status status = palp_material_check(material, NULL);
    if (status)
        return status;
    bool vector = material->formulation == PALP_SEDEF2008 && material->n_arms > 0;
    bool same = material->n_arms == net->material.n_arms && vector == (net->now.vector != NULL);
    palp_material old = net->material;
    net->material = *material;
    if (!same && allocate_states(net)) {
        net->material = old;
        return PALP_ERR_NO_MEMORY;
    }
    palp_network_reset(net);
    return PALP_OK;
}

palp_status network_set_wear(palp_network *net, const element_wear *wear) {
    net->wear = wear;
    palp_status status = allocate_states(net);
    if (!status)
        palp_network_reset(net);
    return status;
}

palp_status network_set_load(palp_network *net, network_load *load, size_t size) {
    net->load = load;
    net->load_size = size;
    palp_status status = allocate_states(net);
    if (status)
        net->load = NULL;
    else
        palp_network_reset(net);
    return status;
}

palp_status network_set_grip(palp_network *net, const char *set, double share) {
    const int32_t *nodes;
    size_t n;
    double start;
    palp_status status = palp_mesh_set(net->mesh, set, &n, &nodes);
    if (status)
        return status;
    if (!net->grip)
        net->grip = calloc(3 * net->n_nodes, sizeof *net->grip);
    if (!net->grip)
        return PALP_ERR_NO_MEMORY;
    unsigned char *held = calloc(net->n_nodes, 1);
    if (!held)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++)
        held[nodes[i]] = 1;
    palp_law_stiffness(&net->material.law, 0.0, &start, NULL);
    for (size_t j = 0; j < 2 * net->n_elements; j++)
        for (size_t k = 0; k < 3 && held[net->pair[j]]; k++)
            net->grip[3 * (size_t)net->pair[j] + k] +=
                share * start * net->inverse_rest[j / 2] * (net->scale ? net->scale[j / 2] : 1.0);
    free(held);
    return PALP_OK;
}

double palp_network_depth(const palp_network *net) {
    return net->now.depth;
}

double palp_network_time(const palp_network *net) {
    return net->now.time;
}

double palp_network_force(const palp_network *net) {
    return net->now.force;
}

const double *palp_network_positions(const palp_network *net) {
    return net->now.x;
}

const double *palp_network_element_strain(const palp_network *net) {
    return net->now.history.strain;
}

size_t palp_network_unknowns(const palp_network *net) {
    return net->n_free;
}

const palp_mesh *palp_network_mesh(const palp_network *net) {
    return net->mesh;
}

void palp_network_element_force(const palp_network *net, double *force_N) {
    memcpy(force_N, net->now.element, net->n_elements * sizeof *force_N);
}

palp_status palp_network_reaction(const palp_network *net, const char *set, double force_N[3]) {
    const int32_t *nodes;
    size_t n;
    palp_status status = palp_mesh_set(net->mesh, set, &n, &nodes);
    if (status)
        return status;
    force_N[0] = force_N[1] = force_N[2] = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            force_N[k] += net->now.inner[3 * (size_t)nodes[i] + k];
    return PALP_OK;
}

bool palp_network_buckled(const palp_network *net, double *stable_m, double *unstable_m) {
    if (net->buckled) {
        *stable_m = net->checked_depth;
        *unstable_m = net->unstable_depth;
    }
    return net->buckled;
}
