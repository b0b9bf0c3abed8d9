/* contact_layer.c: tools that touch a smooth surface (skin.h) instead of a network's triangles. */
#include "contact_term.h"

#include "mesh/mesh_internal.h"

#include <string.h>

/* Young's modulus times a part of a triangle, over the spacing and the stiffness of an element. Returns the
 * spacing, m. */
static double measure_patches(const palp_network *net, const skin *s, double *patch) {
    const double parts = (double)(s->n_triangles / net->n_surface),
                 modulus = network_shared_length(net) / (6.0 * mesh_volume(net->mesh, NULL));
    double sum = 0.0;
    for (size_t i = 0; i < net->n_surface; i++) {
        const int32_t *t = net->surface + 3 * i;
        double normal[3];
        triangle_normal(net->rest + 3 * t[0], net->rest + 3 * t[1], net->rest + 3 * t[2], normal);
        const double edge = pow(dot3(normal, normal), 0.25); /* of the square that is twice the triangle */
        patch[i] = modulus * edge / (6.0 * parts);
        sum += edge;
    }
    return sum / (double)net->n_surface;
}

void layer_share_stiffness(contact_layer *l, const palp_network *net, contact_set *set) {
    skin *s = &l->skin;
    const size_t parts = s->n_triangles / net->n_surface;
    skin_share_stiffness(s, net->n_surface, net->surface, net->unit);
    memset(l->local, 0, s->n * sizeof *l->local);
    for (size_t i = 0; i < 3 * s->n_triangles; i++) {
        const size_t face = i / 3 / parts;
        const int32_t *t = net->surface + 3 * face;
        const double stiffer =
            net->stiffer ? (net->stiffer[t[0]] + net->stiffer[t[1]] + net->stiffer[t[2]]) / 3.0 : 1.0;
        l->local[s->triangle[i]] += stiffer * l->patch[face];
    }
    set->local = l->local;
}

contact_layer *layer_new(arena *memory, const palp_network *net, size_t max_tools,
                         const palp_contact_settings *settings, contact_set *set) {
    contact_layer *l = arena_take(memory, 1, sizeof *l);
    if (!l || skin_make(memory, net->n_nodes, net->rest, net->n_surface, net->surface, net->unit,
                        settings->subdivisions, &l->skin)) {
        memory->failed = true;
        return NULL;
    }
    const skin *s = &l->skin;
    double **vectors[] = {&l->x, &l->committed, &l->in, &l->out};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        *vectors[i] = arena_take(memory, 3 * s->n, sizeof **vectors[i]);
    l->near = arena_take(memory, s->n, sizeof *l->near);
    l->active = arena_take(memory, s->n, sizeof *l->active);
    l->is_active = arena_take(memory, s->n, sizeof *l->is_active);
    l->block = arena_take(memory, 9 * s->n_pairs, sizeof *l->block);
    l->is_touched = arena_take(memory, s->n_pairs, sizeof *l->is_touched);
    l->touched = arena_take(memory, s->n_pairs, sizeof *l->touched);
    l->stencil = arena_take(memory, s->room, sizeof *l->stencil);
    l->share = arena_take(memory, 3 * s->room, sizeof *l->share);
    l->half = arena_take(memory, 27 * s->room, sizeof *l->half);
    contact_set_create(set, memory, s->n, s->rest, s->n_triangles, s->triangle, s->unit, net->extent,
                       max_tools, settings);
    l->patch = arena_take(memory, net->n_surface, sizeof *l->patch);
    l->local = arena_take(memory, s->n, sizeof *l->local);
    if (memory->failed)
        return NULL;
    set->spacing = measure_patches(net, s, l->patch);
    layer_share_stiffness(l, net, set);
    return l;
}

/* ---- places -------------------------------------------------------------------------------------- */

static void list_touched_vertices(contact_layer *l, const contact_set *set) {
    for (size_t i = 0; i < l->n_active; i++)
        l->is_active[l->active[i]] = false;
    l->n_active = 0;
    for (size_t i = 0; i < set->n_contacts; i++)
        for (int j = 0; j < set->contact[i].corners; j++) {
            int32_t v = set->contact[i].node[j];
            if (!l->is_active[v])
                l->active[l->n_active++] = v;
            l->is_active[v] = true;
        }
}

/* Is a node so near a tool's way in this step that one of its vertices may be touched? Assumes that elements
 * stretch to twice their length at most. */
static bool may_node_touch_tool(const contact_layer *l, const contact_set *set, const double *x) {
    for (size_t i = 0; i < set->n_tools; i++) {
        const palp_tool *tool = &set->tool[i];
        double around = tool->shape == PALP_TOOL_PLANE ? 0.0 : tool->radius_m;
        if (contact_distance(tool, x) <=
            around + set->edge + 2.0 * l->skin.reach + contact_travel(set, tool, i))
            return true;
    }
    return false;
}

/* Lists vertices near tools, with their present and committed positions. */
static void list_vertices_near_tools(contact_layer *l, contact_set *set, const double *now,
                                     const double *next) {
    const skin *s = &l->skin;
    size_t n = 0;
    for (size_t i = 0; i < s->n_nodes; i++) {
        if (s->home_first[i] == s->home_first[i + 1] || !may_node_touch_tool(l, set, next + 3 * i))
            continue;
        for (uint32_t k = s->home_first[i]; k < s->home_first[i + 1]; k++) {
            const int32_t v = l->near[n++] = s->home[k];
            skin_take_vertex(s, v, now, l->committed + 3 * v);
            if (next == now)
                memcpy(l->x + 3 * v, l->committed + 3 * v, 3 * sizeof *l->x);
            else
                skin_take_vertex(s, v, next, l->x + 3 * v);
        }
    }
    set->points = (contact_points){n, l->near, s->around_first, s->around};
}

void layer_place(contact_layer *l, contact_set *set, double share, const double *now, const double *next) {
    list_vertices_near_tools(l, set, now, next);
    contact_set_place(set, share, l->committed, l->x);
    list_touched_vertices(l, set);
}

bool layer_refresh(contact_layer *l, contact_set *set, const double *now, const double *next) {
    list_vertices_near_tools(l, set, now, next);
    bool slid = contact_set_refresh(set, l->committed, l->x);
    if (slid)
        list_touched_vertices(l, set);
    return slid;
}

const double *layer_places(contact_layer *l, const double *next) {
    for (size_t i = 0; i < l->n_active; i++)
        skin_take_vertex(&l->skin, l->active[i], next, l->x + 3 * l->active[i]);
    return l->x;
}

size_t layer_corner(const contact_layer *l, int32_t vertex, const int32_t **node, const double **weight) {
    const skin *s = &l->skin;
    *node = s->node + s->first[vertex];
    *weight = s->weight + s->first[vertex];
    return s->first[vertex + 1] - s->first[vertex];
}

/* ---- forces and tangent -------------------------------------------------------------------------- */

/* Distributes the forces of vertices in out to the nodes. */
static void spread_forces_to_nodes(const contact_layer *l, double *to) {
    for (size_t i = 0; i < l->n_active; i++) {
        double *force = l->out + 3 * l->active[i];
        skin_give_vertex(&l->skin, l->active[i], force, to);
        memset(force, 0, 3 * sizeof *force);
    }
}

void layer_evaluate(contact_layer *l, contact_set *set, const double *next, double *force, double *squares) {
    contact_set_evaluate(set, layer_places(l, next), l->out, squares);
    spread_forces_to_nodes(l, force);
}

void layer_times(const contact_layer *l, const contact_set *set, contact_product *times, const double *u,
                 double *out) {
    for (size_t i = 0; i < l->n_active; i++)
        skin_take_vertex(&l->skin, l->active[i], u, l->in + 3 * l->active[i]);
    for (size_t i = 0; i < set->n_contacts; i++)
        if (set->contact[i].depth > 0.0)
            times(&set->contact[i], l->in, l->out);
    spread_forces_to_nodes(l, out);
}

/* half[9 (n a + i)]: sum over corners b of block (a, b) times the weight of node i in corner b. */
static void multiply_blocks_by_shares(const contact_layer *l, const contact *c, size_t n) {
    memset(l->half, 0, 9 * n * (size_t)c->corners * sizeof *l->half);
    for (int a = 0; a < c->corners; a++)
        for (int b = 0; b < c->corners; b++) {
            double k[9];
            contact_block(c, a, b, k);
            for (size_t i = 0; i < n; i++) {
                const double share = l->share[(size_t)b * l->skin.room + i];
                for (size_t e = 0; e < 9; e++)
                    l->half[9 * (n * (size_t)a + i) + e] += share * k[e];
            }
        }
}

/* Adds the block of nodes i and j <= i, among the n of a contact, to that of their pair. */
static void add_block_of_node_pair(const contact_layer *l, const contact *c, size_t n, size_t i, size_t j,
                                   size_t *n_touched) {
    const uint32_t pair = skin_pair(&l->skin, l->stencil[j], l->stencil[i]);
    double *block = l->block + 9 * (size_t)pair;
    if (!l->is_touched[pair])
        l->touched[(*n_touched)++] = pair;
    l->is_touched[pair] = true;
    for (size_t a = 0; a < (size_t)c->corners; a++)
        for (size_t e = 0; e < 9; e++)
            block[e] += l->share[a * l->skin.room + i] * l->half[9 * (n * a + j) + e];
}

void layer_blocks(const contact_layer *l, const contact_set *set, network_block_taker take, void *user) {
    size_t n_touched = 0;
    for (size_t k = 0; k < set->n_contacts; k++) {
        const contact *c = &set->contact[k];
        if (!(c->depth > 0.0))
            continue;
        size_t n = skin_stencil(&l->skin, c->corners, c->node, l->stencil, l->share);
        multiply_blocks_by_shares(l, c, n);
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j <= i; j++)
                add_block_of_node_pair(l, c, n, i, j, &n_touched);
    }
    for (size_t i = 0; i < n_touched; i++) {
        const uint32_t pair = l->touched[i];
        take(user, l->skin.high[pair], l->skin.low[pair], l->block + 9 * (size_t)pair);
        memset(l->block + 9 * (size_t)pair, 0, 9 * sizeof *l->block);
        l->is_touched[pair] = false;
    }
}
