/* contact_term.c: the tools of a network, and what they feel. */
#include "contact_term.h"

#include "mesh/mesh_internal.h"

#include <string.h>

enum { MOST_SUBDIVISIONS = 4 };

static const double LEAP = 0.1; /* of an edge: a tool that goes further in a step is not followed */

static contact_set *set_of(network_term *term) {
    return &((contact_term *)term)->set;
}

static const contact_set *const_set_of(const network_term *term) {
    return &((const contact_term *)term)->set;
}

/* The nodes that corner j of a contact depends on. */
static size_t corner_nodes(const contact_term *t, const contact *c, int j, const int32_t **node,
                           const double **weight) {
    static const double ONE = 1.0;
    if (t->layer)
        return layer_corner(t->layer, c->node[j], node, weight);
    *node = &c->node[j];
    *weight = &ONE;
    return 1;
}

static void term_reset(network_term *term, palp_network *net) {
    (void)net;
    contact_set_reset(set_of(term));
}

static void term_pass(network_term *term, palp_network *net, network_cursor *cursor) {
    contact_set *set = set_of(term);
    contact_state *now = &set->now;
    (void)net;
    network_pass(cursor, &set->n_tools, sizeof set->n_tools);
    network_pass(cursor, set->tool, set->max_tools * sizeof *set->tool);
    network_pass(cursor, &now->n_tools, sizeof now->n_tools);
    network_pass(cursor, &now->n_touches, sizeof now->n_touches);
    network_pass(cursor, now->pose, set->max_tools * sizeof *now->pose);
    network_pass(cursor, now->felt, set->max_tools * sizeof *now->felt);
    network_pass(cursor, now->touch, set->max_contacts * sizeof *now->touch);
}

static void term_swap(network_term *term, palp_network *net) {
    (void)net;
    contact_set_swap(set_of(term));
}

/* ---- a step -------------------------------------------------------------------------------------- */

static void term_begin(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    t->set.modulus = net->modulus;
    if (t->layer) {
        layer_place(t->layer, &t->set, 1.0, net->now.x, net->now.x);
        return;
    }
    if (t->surface_changes != net->surface_changes)
        contact_set_surface(&t->set, net->n_surface, net->surface);
    t->surface_changes = net->surface_changes;
    contact_set_place(&t->set, 1.0, net->now.x, net->now.x);
}

static void term_evaluate(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    if (t->layer)
        layer_evaluate(t->layer, &t->set, net->next.x, net->outer, &net->outer_squares);
    else
        contact_set_evaluate(&t->set, net->next.x, net->outer, &net->outer_squares);
}

static void term_finish(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    contact_set_finish(&t->set, t->layer ? layer_places(t->layer, net->next.x) : net->next.x);
}

static double term_way(const network_term *term, const palp_network *net) {
    (void)net;
    return contact_set_way(const_set_of(term));
}

static bool term_inside(const network_term *term, const palp_network *net) {
    return contact_set_inside(const_set_of(term), net->n_surface, net->surface, net->next.x);
}

static void term_place(network_term *term, palp_network *net, double share) {
    contact_term *t = (contact_term *)term;
    if (t->layer)
        layer_place(t->layer, &t->set, share, net->now.x, net->next.x);
    else
        contact_set_place(&t->set, share, net->now.x, net->next.x);
}

static bool term_refresh(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    if (t->layer)
        return layer_refresh(t->layer, &t->set, net->now.x, net->next.x);
    return contact_set_refresh(&t->set, net->now.x, net->next.x);
}

/* ---- tangent and energy -------------------------------------------------------------------------- */

static void term_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                        void *user) {
    const contact_term *t = (const contact_term *)term;
    const contact_set *set = &t->set;
    double k[9];
    (void)net;
    if (t->layer) {
        layer_blocks(t->layer, set, take, user);
        return;
    }
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        for (int a = 0; a < c->corners && c->depth > 0.0; a++)
            for (int b = 0; b <= a; b++) {
                contact_block(c, a, b, k);
                take(user, c->node[a], c->node[b], k);
            }
    }
}

static void add_times(const network_term *term, contact_product *times, const double *u, double *out) {
    const contact_term *t = (const contact_term *)term;
    const contact_set *set = &t->set;
    if (t->layer) {
        layer_times(t->layer, set, times, u, out);
        return;
    }
    for (size_t i = 0; i < set->n_contacts; i++)
        if (set->contact[i].depth > 0.0)
            times(&set->contact[i], u, out);
}

static void term_times(const network_term *term, const palp_network *net, const double *u, double *out) {
    (void)net;
    add_times(term, contact_times, u, out);
}

static void term_whole_times(const network_term *term, const palp_network *net, const double *u,
                             double *out) {
    (void)net;
    add_times(term, contact_whole_times, u, out);
}

static bool term_energy(const network_term *term, const palp_network *net, double *energy) {
    const contact_set *set = const_set_of(term);
    (void)net;
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        if (!(c->depth > 0.0))
            continue;
        if (set->pose[c->tool].friction > 0.0)
            return false;
        *energy += contact_energy(set, c);
    }
    return true;
}

/* ---- a guess that goes along --------------------------------------------------------------------- */

/* Least move of its corners by which a contact's point comes to where the tool took it, along the normal. */
static void follow(contact_term *t, const contact *c, const double *x, double *moves) {
    const contact_set *set = &t->set;
    double point[3], squares = 0.0;
    contact_point(c, c->stick_share, x, point);
    along3(c->anchor, -1.0, point, point);
    for (int j = 0; j < c->corners; j++)
        squares += c->stick_share[j] * c->stick_share[j];
    double size = dot3(c->normal, point) / squares;
    if (fabs(size) > LEAP * set->edge)
        return;
    for (int j = 0; j < c->corners; j++) {
        const double stiffness = c->stick_share[j] * c->stiffness, *weight;
        const int32_t *node;
        size_t n = corner_nodes(t, c, j, &node, &weight);
        for (size_t i = 0; i < n; i++) {
            double *move = moves + 3 * node[i];
            along3(move, weight[i] * stiffness * c->stick_share[j] * size, c->normal, move);
            t->weight[node[i]] += weight[i] * stiffness;
        }
    }
}

/* Does the tool lose the tissue: of the contacts that touched none does? One of several that comes off as the
 * tool slides on is let go. */
static bool lost(contact_set *set, int32_t tool, const double *x) {
    bool touched = false, touches = false;
    for (size_t i = 0; i < set->n_contacts; i++) {
        contact *c = &set->contact[i];
        if (c->tool != tool || !c->touched)
            continue;
        contact_measure(&set->pose[tool], c, x);
        touched = true;
        touches = touches || c->depth > 0.0;
    }
    return touched && !touches;
}

/* A tool that withdraws all of a sudden would otherwise lose the tissue for some ticks. */
static void term_follow(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    double *moves = net->outer; /* the next evaluation fills it anew */
    const double *x = t->layer ? layer_places(t->layer, net->next.x) : net->next.x;
    memset(moves, 0, 3 * net->n_nodes * sizeof *moves);
    memset(t->weight, 0, net->n_nodes * sizeof *t->weight);
    for (size_t tool = 0; tool < t->set.n_tools; tool++) {
        bool any = lost(&t->set, (int32_t)tool, x);
        for (size_t i = 0; i < t->set.n_contacts && any; i++)
            if (t->set.contact[i].touched && t->set.contact[i].tool == (int32_t)tool)
                follow(t, &t->set.contact[i], x, moves);
    }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0 && t->weight[i / 3] > 0.0)
            net->next.x[i] += moves[i] / t->weight[i / 3];
}

/* ---- a residual that is left --------------------------------------------------------------------- */

static void term_weigh(const network_term *term, const palp_network *net, double *weight) {
    const contact_term *t = (const contact_term *)term;
    (void)net;
    for (size_t i = 0; i < t->set.n_contacts; i++) {
        const contact *c = &t->set.contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++) {
            const int32_t *node;
            const double *share;
            size_t n = corner_nodes(t, c, j, &node, &share);
            for (size_t k = 0; k < n; k++)
                weight[node[k]] += share[k] * c->share[j] * c->stiffness;
        }
    }
}

static void term_share_residual(network_term *term, palp_network *net, const double *weight,
                                const double *residual) {
    contact_term *t = (contact_term *)term;
    contact_set *set = &t->set;
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++) {
            const int32_t *node;
            const double *share;
            size_t n = corner_nodes(t, c, j, &node, &share);
            for (size_t k = 0; k < n; k++) {
                size_t at = 3 * (size_t)node[k];
                double all = weight[node[k]],
                       part = all > 0.0 ? share[k] * c->share[j] * c->stiffness / all : 0.0;
                contact_feel(&set->pose[c->tool], net->next.x + at, -part, residual + at,
                             &set->next.felt[c->tool]);
            }
        }
    }
}

static void term_doubt(network_term *term, palp_network *net, double error, double *sum) {
    (void)net;
    *sum += contact_set_doubt(set_of(term), error);
}

static const network_term_kind CONTACT = {.reset = term_reset,
                                          .pass = term_pass,
                                          .swap = term_swap,
                                          .begin = term_begin,
                                          .evaluate = term_evaluate,
                                          .finish = term_finish,
                                          .blocks = term_blocks,
                                          .times = term_times,
                                          .whole_times = term_whole_times,
                                          .energy = term_energy,
                                          .way = term_way,
                                          .place = term_place,
                                          .refresh = term_refresh,
                                          .follow = term_follow,
                                          .inside = term_inside,
                                          .weigh = term_weigh,
                                          .share_residual = term_share_residual,
                                          .doubt = term_doubt};

contact_set *contact_of(const palp_network *net) {
    network_term *term = network_find_term(net, &CONTACT);
    return term ? set_of(term) : NULL;
}

/* NULL: out of memory. */
static network_term *term_new(const palp_network *net, size_t max_tools,
                              const palp_contact_settings *settings) {
    contact_term *t = network_term_new(&CONTACT, sizeof *t);
    if (!t)
        return NULL;
    t->surface_changes = net->surface_changes;
    arena *memory = &t->term.memory;
    t->weight = arena_take(memory, net->n_nodes, sizeof *t->weight);
    /* where one of these fails the memory has failed */
    if (settings->subdivisions > 0)
        t->layer = layer_new(memory, net, max_tools, settings, &t->set);
    else
        contact_set_create(&t->set, memory, net->n_nodes, net->rest, net->n_surface, net->surface, net->unit,
                           net->extent, max_tools, settings);
    return &t->term;
}

/* Room in the tangent for what a layer joins. */
static palp_status join(palp_network *net, const network_term *term) {
    const contact_term *t = (const contact_term *)term;
    if (!t || t->term.memory.failed || !t->layer)
        return PALP_OK; /* network_add_terms tells what failed */
    net->surface_stays = true;
    const skin *s = &t->layer->skin;
    return network_add_pairs(net, s->n_pairs, s->low, s->high);
}

/* ---- the public calls -------------------------------------------------------------------------- */

palp_contact_settings palp_contact_settings_default(void) {
    return (palp_contact_settings){.stiffness = 20.0, .grasp_stiffness = 100.0, .smoothing = 0.01};
}

palp_status palp_network_enable_tools(palp_network *net, size_t max_tools, size_t max_grasped,
                                      const palp_contact_settings *settings) {
    const palp_contact_settings *s = settings;
    if (!net || !s || contact_of(net) || max_tools > INT32_MAX || max_grasped > net->n_nodes)
        return PALP_ERR_ARGUMENT;
    bool weighs = dot3(s->gravity_m_s2, s->gravity_m_s2) > 0.0;
    if (!positive(s->stiffness) || !positive(s->grasp_stiffness) || !positive(s->smoothing) ||
        s->subdivisions > MOST_SUBDIVISIONS || !finite3(s->gravity_m_s2) || (weighs && !net->mass))
        return PALP_ERR_ARGUMENT;
    if (max_tools > 0 && net->n_surface == 0)
        return PALP_ERR_UNSUPPORTED;
    if (s->subdivisions > 0 && net->surface != palp_mesh_triangles(net->mesh))
        return PALP_ERR_UNSUPPORTED;
    network_term *terms[3];
    size_t n = 0;
    if (weighs)
        terms[n++] = network_gravity_new(s->gravity_m_s2);
    terms[n++] = grasp_new(max_grasped, s->grasp_stiffness);
    terms[n++] = term_new(net, max_tools, s);
    palp_status status = join(net, terms[n - 1]);
    if (status) {
        for (size_t i = 0; i < n; i++)
            network_term_free(terms[i]);
        return status;
    }
    status = network_add_terms(net, n, terms);
    if (!status)
        palp_network_reset(net);
    return status;
}

palp_status palp_network_set_tools(palp_network *net, size_t n, const palp_tool *tools) {
    if (!net || (n > 0 && !tools))
        return PALP_ERR_ARGUMENT;
    contact_set *set = contact_of(net);
    return set ? contact_set_tools(set, n, tools) : PALP_ERR_ARGUMENT;
}

palp_status palp_network_tool_force(const palp_network *net, palp_tool_force *force) {
    if (!net || !force)
        return PALP_ERR_ARGUMENT;
    const contact_set *set = contact_of(net);
    if (!set)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < set->n_tools; i++)
        force[i] = i < set->now.n_tools ? set->now.felt[i] : (palp_tool_force){.contacts = 0};
    return PALP_OK;
}
