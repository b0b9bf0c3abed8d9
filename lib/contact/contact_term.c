/* contact_term.c: the tools of a network, and what they feel. */
#include "contact_internal.h"

#include <string.h>

static const double LEAP = 0.1; /* of an edge: a tool that goes further in a step is not followed */

typedef struct contact_term {
    network_term term;
    contact_set set;
    size_t surface_changes; /* of the network's surface that the set has */
    double *weight;         /* [n_nodes] scratch */
} contact_term;

static contact_set *set_of(network_term *term) {
    return &((contact_term *)term)->set;
}

static const contact_set *const_set_of(const network_term *term) {
    return &((const contact_term *)term)->set;
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
    if (t->surface_changes != net->surface_changes)
        contact_set_surface(&t->set, net->n_surface, net->surface);
    t->surface_changes = net->surface_changes;
    t->set.modulus = net->modulus;
    contact_set_place(&t->set, 1.0, net->now.x, net->now.x);
}

static void term_evaluate(network_term *term, palp_network *net) {
    contact_set_evaluate(set_of(term), net->next.x, net->outer, &net->outer_squares);
}

static void term_finish(network_term *term, palp_network *net) {
    contact_set_finish(set_of(term), net->next.x);
}

static bool term_moved(const network_term *term, const palp_network *net) {
    (void)net;
    return contact_set_moved(const_set_of(term));
}

static void term_place(network_term *term, palp_network *net, double share) {
    contact_set_place(set_of(term), share, net->now.x, net->next.x);
}

static bool term_refresh(network_term *term, palp_network *net) {
    return contact_set_refresh(set_of(term), net->now.x, net->next.x);
}

/* ---- tangent and energy -------------------------------------------------------------------------- */

static void term_blocks(const network_term *term, const palp_network *net, network_block_taker take, void *user) {
    const contact_set *set = const_set_of(term);
    double k[9];
    (void)net;
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        for (int a = 0; a < c->corners && c->depth > 0.0; a++)
            for (int b = 0; b <= a; b++) {
                contact_block(c, a, b, k);
                take(user, c->node[a], c->node[b], k);
            }
    }
}

static void term_times(const network_term *term, const palp_network *net, const double *u, double *out) {
    const contact_set *set = const_set_of(term);
    (void)net;
    for (size_t i = 0; i < set->n_contacts; i++)
        if (set->contact[i].depth > 0.0)
            contact_times(&set->contact[i], u, out);
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
        double weight = c->stick_share[j] * c->stiffness, *move = moves + 3 * c->node[j];
        along3(move, weight * c->stick_share[j] * size, c->normal, move);
        t->weight[c->node[j]] += weight;
    }
}

/* Does the tool lose the tissue: of the contacts that touched none does? One of several that comes off as the tool slides on
 * is let go. */
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
    memset(moves, 0, 3 * net->n_nodes * sizeof *moves);
    memset(t->weight, 0, net->n_nodes * sizeof *t->weight);
    for (size_t tool = 0; tool < t->set.n_tools; tool++) {
        bool any = lost(&t->set, (int32_t)tool, net->next.x);
        for (size_t i = 0; i < t->set.n_contacts && any; i++)
            if (t->set.contact[i].touched && t->set.contact[i].tool == (int32_t)tool)
                follow(t, &t->set.contact[i], net->next.x, moves);
    }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0 && t->weight[i / 3] > 0.0)
            net->next.x[i] += moves[i] / t->weight[i / 3];
}

/* ---- a residual that is left --------------------------------------------------------------------- */

static void term_weigh(const network_term *term, const palp_network *net, double *weight) {
    const contact_set *set = const_set_of(term);
    (void)net;
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++)
            weight[c->node[j]] += c->share[j] * c->stiffness;
    }
}

static void term_share_residual(network_term *term, palp_network *net, const double *weight, const double *residual) {
    contact_set *set = set_of(term);
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++) {
            size_t at = 3 * (size_t)c->node[j];
            double all = weight[c->node[j]], part = all > 0.0 ? c->share[j] * c->stiffness / all : 0.0;
            contact_feel(&set->pose[c->tool], net->next.x + at, -part, residual + at, &set->next.felt[c->tool]);
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
                                          .energy = term_energy,
                                          .moved = term_moved,
                                          .place = term_place,
                                          .refresh = term_refresh,
                                          .follow = term_follow,
                                          .weigh = term_weigh,
                                          .share_residual = term_share_residual,
                                          .doubt = term_doubt};

contact_set *contact_of(const palp_network *net) {
    network_term *term = network_find_term(net, &CONTACT);
    return term ? set_of(term) : NULL;
}

/* NULL: out of memory. */
static network_term *term_new(const palp_network *net, size_t max_tools, const palp_contact_settings *settings) {
    contact_term *t = network_term_new(&CONTACT, sizeof *t);
    if (!t)
        return NULL;
    t->surface_changes = net->surface_changes;
    t->weight = arena_take(&t->term.memory, net->n_nodes, sizeof *t->weight);
    contact_set_create(&t->set, &t->term.memory, net->n_nodes, net->rest, net->n_surface, net->surface, net->unit, net->extent,
                       max_tools, settings); /* where it fails the memory has failed */
    return &t->term;
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
        !finite3(s->gravity_m_s2) || (weighs && !net->mass))
        return PALP_ERR_ARGUMENT;
    if (max_tools > 0 && net->n_surface == 0)
        return PALP_ERR_UNSUPPORTED;
    network_term *terms[3];
    size_t n = 0;
    if (weighs)
        terms[n++] = network_gravity_new(s->gravity_m_s2);
    terms[n++] = grasp_new(max_grasped, s->grasp_stiffness);
    terms[n++] = term_new(net, max_tools, s);
    palp_status status = network_add_terms(net, n, terms);
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
