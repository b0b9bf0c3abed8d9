/* contact_term.c: the tools of a network, and the forces on them. */
#include "contact_term.h"

#include "mesh/mesh_internal.h"

#include <string.h>

enum { MOST_SUBDIVISIONS = 4, SELF_BLOCKS = 3 };

/* Of springs alone, 1 less Poisson's ratio. At equal shear modulus the modulus of a surface, E / (1 - nu^2),
 * goes as 1 / (1 - nu). */
static const double SOLIDITY = 0.75;
static const double LEAP = 0.1; /* of an edge: a tool that goes further in a step is not followed */

static contact_set *contact_set_of_term(network_term *term) {
    return &((contact_term *)term)->set;
}

static const contact_set *const_contact_set_of_term(const network_term *term) {
    return &((const contact_term *)term)->set;
}

/* The nodes that corner j of a contact depends on. */
static size_t nodes_of_contact_corner(const contact_term *t, const contact *c, int j, const int32_t **node,
                                      const double **weight) {
    static const double ONE = 1.0;
    if (t->layer)
        return layer_corner(t->layer, c->node[j], node, weight);
    *node = &c->node[j];
    *weight = &ONE;
    return 1;
}

/* Where there are regions their stiffness may have changed. */
static void reset_contact_term(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    contact_set_reset(&t->set);
    if (t->layer && net->stiffer)
        layer_share_stiffness(t->layer, net, &t->set);
}

/* All but their hulls, which are the caller's. */
static void pass_tools(network_cursor *cursor, size_t n, palp_tool *tools) {
    for (size_t i = 0; i < n; i++)
        network_pass(cursor, &tools[i], offsetof(palp_tool, hull));
}

static void pass_contact_state(network_term *term, palp_network *net, network_cursor *cursor) {
    contact_set *set = contact_set_of_term(term);
    contact_state *now = &set->now;
    (void)net;
    if (cursor->way == NETWORK_RESTORE)
        now->n_told = 0;
    network_pass(cursor, &set->n_tools, sizeof set->n_tools);
    pass_tools(cursor, set->max_tools, set->tool);
    network_pass(cursor, &now->n_tools, sizeof now->n_tools);
    network_pass(cursor, &now->n_touches, sizeof now->n_touches);
    pass_tools(cursor, set->max_tools, now->pose);
    network_pass(cursor, now->felt, set->max_tools * sizeof *now->felt);
    network_pass(cursor, now->touch, set->max_contacts * sizeof *now->touch);
}

static void swap_contact_states(network_term *term, palp_network *net) {
    (void)net;
    contact_set_swap(contact_set_of_term(term));
}

/* ---- a step -------------------------------------------------------------------------------------- */

/* As the elements: by the same share of each arm. */
static void set_relaxation(contact_set *set, const palp_network *net) {
    network_material m;
    for (size_t k = 0; k <= net->n_regions; k++) {
        if (!network_material_at(net, k, &m))
            continue;
        contact_relaxation *r = &set->relaxation[k];
        r->n_arms = m.material->formulation == PALP_HISTORY ? m.material->n_arms : 0;
        r->share = 1.0;
        for (size_t j = 0; j < r->n_arms; j++) {
            r->keep[j] = m.step->decay[j];
            r->gain[j] = m.step->gain[j] / m.modulus;
            r->share += r->gain[j] - m.material->arms[j].stiffness_N / m.modulus;
        }
    }
}

static void begin_contact_step(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    t->set.modulus = net->modulus;
    t->set.stiffening = contact_stiffening(&net->material, net->modulus);
    set_relaxation(&t->set, net);
    if (t->layer) {
        layer_place(t->layer, &t->set, 1.0, net->now.x, net->now.x);
        return;
    }
    if (t->surface_changes != net->surface_changes)
        contact_set_surface(&t->set, net->n_surface, net->surface);
    t->surface_changes = net->surface_changes;
    contact_set_place(&t->set, 1.0, net->now.x, net->now.x);
}

static void evaluate_contact_forces(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    if (t->layer)
        layer_evaluate(t->layer, &t->set, net->next.x, net->outer, &net->outer_squares);
    else
        contact_set_evaluate(&t->set, net->next.x, net->outer, &net->outer_squares);
}

static void finish_contact_step(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    contact_set_finish(&t->set, t->layer ? layer_places(t->layer, net->next.x) : net->next.x);
}

static double longest_tool_way(const network_term *term, const palp_network *net) {
    (void)net;
    return contact_set_way(const_contact_set_of_term(term));
}

static palp_status check_tools(const network_term *term, const palp_network *net) {
    return contact_set_inside(const_contact_set_of_term(term), net->n_surface, net->surface, net->next.x)
               ? PALP_ERR_INSIDE
               : PALP_OK;
}

static void place_tools_on_their_way(network_term *term, palp_network *net, double share) {
    contact_term *t = (contact_term *)term;
    if (t->layer)
        layer_place(t->layer, &t->set, share, net->now.x, net->next.x);
    else
        contact_set_place(&t->set, share, net->now.x, net->next.x);
}

static bool refresh_contact_points(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    if (t->layer)
        return layer_refresh(t->layer, &t->set, net->now.x, net->next.x);
    return contact_set_refresh(&t->set, net->now.x, net->next.x);
}

/* ---- tangent and energy -------------------------------------------------------------------------- */

/* Contacts of a triangle follow each other: sums the blocks of those from i on, by pairs of corners. Returns
 * their number. */
static size_t add_blocks_of_triangle(const contact_set *set, size_t i, double sum[6][9], size_t *touching) {
    const contact *first = &set->contact[i];
    double k[9];
    size_t n = 0;
    memset(sum, 0, 6 * sizeof *sum);
    *touching = 0;
    for (; i + n < set->n_contacts; n++) {
        const contact *c = first + n;
        if (c->corners != first->corners || memcmp(c->node, first->node, sizeof c->node) != 0)
            break;
        if (!(c->depth > 0.0))
            continue;
        ++*touching;
        for (int a = 0, pair = 0; a < c->corners; a++)
            for (int b = 0; b <= a; b++, pair++) {
                contact_block(c, a, b, k);
                for (int e = 0; e < 9; e++)
                    sum[pair][e] += k[e];
            }
    }
    return n;
}

static void take_contact_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                                void *user) {
    const contact_term *t = (const contact_term *)term;
    const contact_set *set = &t->set;
    double sum[6][9];
    (void)net;
    if (t->layer) {
        layer_blocks(t->layer, set, take, user);
        return;
    }
    for (size_t i = 0, touching; i < set->n_contacts;) {
        const contact *c = &set->contact[i];
        i += add_blocks_of_triangle(set, i, sum, &touching);
        for (int a = 0, pair = 0; a < c->corners && touching > 0; a++)
            for (int b = 0; b <= a; b++, pair++)
                take(user, c->node[a], c->node[b], sum[pair]);
    }
}

static void add_contact_product(const network_term *term, contact_product *times, const double *u,
                                double *out) {
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

static void multiply_contact_tangent(const network_term *term, const palp_network *net, const double *u,
                                     double *out) {
    (void)net;
    add_contact_product(term, contact_times, u, out);
}

static void multiply_whole_tangent(const network_term *term, const palp_network *net, const double *u,
                                   double *out) {
    (void)net;
    add_contact_product(term, contact_whole_times, u, out);
}

static bool add_contact_energy(const network_term *term, const palp_network *net, double *energy) {
    const contact_set *set = const_contact_set_of_term(term);
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
static void move_corners_with_tool(contact_term *t, const contact *c, const double *x, double *moves) {
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
        size_t n = nodes_of_contact_corner(t, c, j, &node, &weight);
        for (size_t i = 0; i < n; i++) {
            double *move = moves + 3 * node[i];
            along3(move, weight[i] * stiffness * c->stick_share[j] * size, c->normal, move);
            t->weight[node[i]] += weight[i] * stiffness;
        }
    }
}

/* Does the tool lose the tissue: of the contacts that touched none does? One of several that comes off as the
 * tool slides on is let go. */
static bool has_tool_lost_tissue(contact_set *set, int32_t tool, const double *x) {
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
static void move_nodes_with_tools(network_term *term, palp_network *net) {
    contact_term *t = (contact_term *)term;
    double *moves = net->outer; /* the next evaluation fills it anew */
    const double *x = t->layer ? layer_places(t->layer, net->next.x) : net->next.x;
    bool any = false;
    for (size_t tool = 0; tool < t->set.n_tools; tool++) {
        if (!has_tool_lost_tissue(&t->set, (int32_t)tool, x))
            continue;
        if (!any) {
            memset(moves, 0, 3 * net->n_nodes * sizeof *moves);
            memset(t->weight, 0, net->n_nodes * sizeof *t->weight);
        }
        any = true;
        for (size_t i = 0; i < t->set.n_contacts; i++)
            if (t->set.contact[i].touched && t->set.contact[i].tool == (int32_t)tool)
                move_corners_with_tool(t, &t->set.contact[i], x, moves);
    }
    for (size_t i = 0; i < 3 * net->n_nodes && any; i++)
        if (net->dof[i] >= 0 && t->weight[i / 3] > 0.0)
            net->next.x[i] += moves[i] / t->weight[i / 3];
}

/* ---- remaining residual -------------------------------------------------------------------------- */

static void add_contact_weights(const network_term *term, const palp_network *net, double *weight) {
    const contact_term *t = (const contact_term *)term;
    (void)net;
    for (size_t i = 0; i < t->set.n_contacts; i++) {
        const contact *c = &t->set.contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++) {
            const int32_t *node;
            const double *share;
            size_t n = nodes_of_contact_corner(t, c, j, &node, &share);
            for (size_t k = 0; k < n; k++)
                weight[node[k]] += share[k] * c->share[j] * c->stiffness;
        }
    }
}

static void share_contact_residual(network_term *term, palp_network *net, const double *weight,
                                   const double *residual) {
    contact_term *t = (contact_term *)term;
    contact_set *set = &t->set;
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++) {
            const int32_t *node;
            const double *share;
            size_t n = nodes_of_contact_corner(t, c, j, &node, &share);
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

static void add_force_uncertainty(const network_term *term, const palp_network *net, double *sum) {
    (void)net;
    *sum += contact_set_doubt(const_contact_set_of_term(term));
}

static void keep_force_uncertainty(network_term *term, palp_network *net, const double *change,
                                   double error) {
    contact_term *t = (contact_term *)term;
    (void)net;
    contact_set_keep_doubt(&t->set, change && t->layer ? layer_places(t->layer, change) : change, error);
}

static const network_term_kind CONTACT = {.reset = reset_contact_term,
                                          .pass = pass_contact_state,
                                          .swap = swap_contact_states,
                                          .begin = begin_contact_step,
                                          .evaluate = evaluate_contact_forces,
                                          .finish = finish_contact_step,
                                          .blocks = take_contact_blocks,
                                          .times = multiply_contact_tangent,
                                          .whole_times = multiply_whole_tangent,
                                          .energy = add_contact_energy,
                                          .way = longest_tool_way,
                                          .place = place_tools_on_their_way,
                                          .refresh = refresh_contact_points,
                                          .follow = move_nodes_with_tools,
                                          .check = check_tools,
                                          .weigh = add_contact_weights,
                                          .share_residual = share_contact_residual,
                                          .doubt = add_force_uncertainty,
                                          .keep_doubt = keep_force_uncertainty};

contact_set *contact_of(const palp_network *net) {
    network_term *term = network_find_term(net, &CONTACT);
    return term ? contact_set_of_term(term) : NULL;
}

/* The node of the network that takes most of a contact's force. */
static int32_t main_node(const contact_term *t, const contact_told *told) {
    int32_t best = told->node[0];
    double most = -1.0;
    for (int j = 0; j < 3 && told->node[j] >= 0; j++) {
        const contact corner = {.node = {told->node[j]}};
        const int32_t *node;
        const double *weight;
        const size_t n = nodes_of_contact_corner(t, &corner, 0, &node, &weight);
        for (size_t i = 0; i < n; i++)
            if (weight[i] * told->share[j] > most) {
                most = weight[i] * told->share[j];
                best = node[i];
            }
    }
    return best;
}

/* The material of the tissue around each point that tools touch. */
static unsigned char *materials_of_points(contact_term *t, const palp_network *net) {
    unsigned char *material = arena_take(&t->term.memory, t->set.n_nodes, sizeof *material);
    for (size_t i = 0; i < t->set.n_nodes && material && !t->term.memory.failed; i++) {
        const contact_told point = {.node = {(int32_t)i, -1, -1}, .share = {1.0}};
        const int region = net->region_of_node[main_node(t, &point)];
        material[i] = region >= 0 && net->region[region].share ? (unsigned char)(region + 1) : 0;
    }
    return material;
}

/* NULL: out of memory. */
static network_term *create_contact_term(const palp_network *net, size_t max_tools,
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
    if (net->base_share)
        t->set.material = materials_of_points(t, net);
    t->set.solid = SOLIDITY / (1.0 - fmax(net->settings.poisson_ratio, 1.0 - SOLIDITY));
    return &t->term;
}

/* Room in the tangent for what a layer joins. */
static palp_status reserve_tangent_pairs(palp_network *net, const network_term *term) {
    const contact_term *t = (const contact_term *)term;
    if (!t || t->term.memory.failed || !t->layer)
        return PALP_OK; /* network_add_terms reports the failure */
    net->surface_stays = true;
    const skin *s = &t->layer->skin;
    return network_add_pairs(net, s->n_pairs, s->low, s->high);
}

/* ---- the public calls -------------------------------------------------------------------------- */

palp_contact_settings palp_contact_settings_default(void) {
    return (palp_contact_settings){.stiffness = 20.0,
                                   .grasp_stiffness = 100.0,
                                   .tissue_stiffness = 5.0,
                                   .smoothing = 0.01,
                                   .local = true};
}

palp_status palp_network_enable_tools(palp_network *net, size_t max_tools, size_t max_grasped,
                                      const palp_contact_settings *settings) {
    if (!net || !settings || contact_of(net) || max_tools > INT32_MAX || max_grasped > net->n_nodes)
        return PALP_ERR_ARGUMENT;
    palp_contact_settings own = *settings;
    own.local = own.local && own.subdivisions == 0;
    const palp_contact_settings *s = &own;
    bool weighs = dot3(s->gravity_m_s2, s->gravity_m_s2) > 0.0;
    if (!positive(s->stiffness) || !positive(s->grasp_stiffness) || !positive(s->tissue_stiffness) ||
        !positive(s->smoothing) || !(s->tissue_friction >= 0.0 && isfinite(s->tissue_friction)) ||
        s->subdivisions > MOST_SUBDIVISIONS || !finite3(s->gravity_m_s2) || (weighs && !net->mass))
        return PALP_ERR_ARGUMENT;
    if ((max_tools > 0 || s->tissue) && net->n_surface == 0)
        return PALP_ERR_UNSUPPORTED;
    if (s->subdivisions > 0 && net->surface != palp_mesh_triangles(net->mesh))
        return PALP_ERR_UNSUPPORTED;
    network_term *terms[4];
    size_t n = 0;
    if (weighs)
        terms[n++] = network_gravity_new(s->gravity_m_s2);
    terms[n++] = grasp_new(max_grasped, s->grasp_stiffness);
    terms[n++] = create_contact_term(net, max_tools, s);
    palp_status status = reserve_tangent_pairs(net, terms[n - 1]);
    if (!status && s->tissue) {
        terms[n++] = contact_self_new(net, s);
        status = network_make_far_room(net, SELF_BLOCKS * net->n_surface);
    }
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

palp_status palp_network_contacts(const palp_network *net, size_t room, palp_contact *contacts, size_t *n) {
    if (!net || !n || (room > 0 && !contacts))
        return PALP_ERR_ARGUMENT;
    const contact_term *t = (const contact_term *)network_find_term(net, &CONTACT);
    if (!t)
        return PALP_ERR_ARGUMENT;
    const size_t by_tools = t->set.now.n_told;
    size_t more;
    const palp_contact *self = contact_self_told(net, &more);
    *n = by_tools + more;
    for (size_t i = 0; i < *n && i < room; i++) {
        contacts[i] = i < by_tools ? t->set.now.told[i].contact : self[i - by_tools];
        if (i < by_tools)
            contacts[i].node = main_node(t, &t->set.now.told[i]);
        contacts[i].region = net->region_of_node ? net->region_of_node[contacts[i].node] : -1;
    }
    return PALP_OK;
}
