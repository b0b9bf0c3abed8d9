/* grasp.c: grasped nodes: a stiff spring from each to its target. */
#include "contact_internal.h"

#include <string.h>

typedef struct grasped {
    double target[3], was[3]; /* target; and the hand's position in the committed state, m */
    double force[3];          /* on the hand, N */
    int32_t node;
} grasped;

typedef struct grasp {
    network_term term;
    double stiffness; /* stiffness of a spring, in units of its node's own */
    size_t max, n;
    grasped *now, *next; /* [n] of at most max */
    double *target;      /* [3 n] targets at the present evaluation */
} grasp;

static void release_all_grasps(network_term *term, palp_network *net) {
    (void)net;
    ((grasp *)term)->n = 0;
}

static void pass_grasp_state(network_term *term, palp_network *net, network_cursor *cursor) {
    grasp *t = (grasp *)term;
    (void)net;
    network_pass(cursor, &t->n, sizeof t->n);
    network_pass(cursor, t->now, t->max * sizeof *t->now);
}

static void swap_grasp_states(network_term *term, palp_network *net) {
    grasp *t = (grasp *)term;
    grasped *old = t->now;
    (void)net;
    t->now = t->next;
    t->next = old;
}

/* ---- a step -------------------------------------------------------------------------------------- */

/* Stiffness of a node's spring, N/m. */
static double grasp_stiffness_of_node(const grasp *t, const palp_network *net, int32_t node) {
    return t->stiffness * net->modulus * net->unit[node];
}

static void place_grasp_targets(network_term *term, palp_network *net, double share) {
    grasp *t = (grasp *)term;
    (void)net;
    for (size_t i = 0; i < 3 * t->n; i++)
        t->target[i] = share * t->now[i / 3].target[i % 3] + (1.0 - share) * t->now[i / 3].was[i % 3];
}

static void begin_grasp_step(network_term *term, palp_network *net) {
    place_grasp_targets(term, net, 1.0);
}

/* Springs to the targets are linear, so a hand can be followed over any distance at once. */
static double longest_grasp_way(const network_term *term, const palp_network *net) {
    const grasp *t = (const grasp *)term;
    (void)net;
    for (size_t i = 0; i < t->n; i++)
        if (memcmp(t->now[i].was, t->now[i].target, sizeof t->now[i].was) != 0)
            return 1.0;
    return 0.0;
}

static void evaluate_grasp_forces(network_term *term, palp_network *net) {
    const grasp *t = (const grasp *)term;
    for (size_t i = 0; i < t->n; i++) {
        const size_t node = (size_t)t->now[i].node;
        const double *x = net->next.x + 3 * node, stiffness = grasp_stiffness_of_node(t, net, t->now[i].node);
        for (size_t k = 0; k < 3; k++)
            net->outer[3 * node + k] += stiffness * (t->target[3 * i + k] - x[k]);
        net->outer_squares += stiffness * stiffness * dot3(x, x);
    }
}

static void finish_grasp_step(network_term *term, palp_network *net) {
    grasp *t = (grasp *)term;
    memcpy(t->next, t->now, t->n * sizeof *t->next);
    for (size_t i = 0; i < t->n; i++) {
        grasped *g = &t->next[i];
        double away[3], none[3] = {0.0};
        memcpy(g->was, t->target + 3 * i, sizeof g->was);
        along3(net->next.x + 3 * g->node, -1.0, g->was, away);
        along3(none, grasp_stiffness_of_node(t, net, g->node), away, g->force);
    }
}

/* ---- tangent and energy -------------------------------------------------------------------------- */

static void take_grasp_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                              void *user) {
    const grasp *t = (const grasp *)term;
    double k[9] = {0.0};
    for (size_t i = 0; i < t->n; i++) {
        k[0] = k[4] = k[8] = grasp_stiffness_of_node(t, net, t->now[i].node);
        take(user, t->now[i].node, t->now[i].node, k);
    }
}

static void multiply_grasp_tangent(const network_term *term, const palp_network *net, const double *u,
                                   double *out) {
    const grasp *t = (const grasp *)term;
    for (size_t i = 0; i < t->n; i++) {
        const size_t at = 3 * (size_t)t->now[i].node;
        along3(out + at, grasp_stiffness_of_node(t, net, t->now[i].node), u + at, out + at);
    }
}

static bool add_grasp_energy(const network_term *term, const palp_network *net, double *energy) {
    const grasp *t = (const grasp *)term;
    for (size_t i = 0; i < t->n; i++) {
        double away[3];
        along3(net->next.x + 3 * t->now[i].node, -1.0, t->target + 3 * i, away);
        *energy += 0.5 * grasp_stiffness_of_node(t, net, t->now[i].node) * dot3(away, away);
    }
    return true;
}

/* ---- remaining residual -------------------------------------------------------------------------- */

static void add_grasp_weights(const network_term *term, const palp_network *net, double *weight) {
    const grasp *t = (const grasp *)term;
    for (size_t i = 0; i < t->n; i++)
        weight[t->now[i].node] += grasp_stiffness_of_node(t, net, t->now[i].node);
}

static void share_grasp_residual(network_term *term, palp_network *net, const double *weight,
                                 const double *residual) {
    grasp *t = (grasp *)term;
    for (size_t i = 0; i < t->n; i++) {
        grasped *g = &t->next[i];
        along3(g->force, grasp_stiffness_of_node(t, net, g->node) / weight[g->node], residual + 3 * g->node,
               g->force);
    }
}

static void mark_grasped_nodes(const network_term *term, unsigned char *fixed) {
    const grasp *t = (const grasp *)term;
    for (size_t i = 0; i < t->n; i++)
        fixed[t->now[i].node] = 1;
}

static const network_term_kind GRASP = {.reset = release_all_grasps,
                                        .pass = pass_grasp_state,
                                        .swap = swap_grasp_states,
                                        .begin = begin_grasp_step,
                                        .evaluate = evaluate_grasp_forces,
                                        .finish = finish_grasp_step,
                                        .blocks = take_grasp_blocks,
                                        .times = multiply_grasp_tangent,
                                        .energy = add_grasp_energy,
                                        .way = longest_grasp_way,
                                        .place = place_grasp_targets,
                                        .weigh = add_grasp_weights,
                                        .share_residual = share_grasp_residual,
                                        .grasped = mark_grasped_nodes};

network_term *grasp_new(size_t max_grasped, double stiffness) {
    grasp *t = network_term_new(&GRASP, sizeof *t);
    if (!t)
        return NULL;
    t->stiffness = stiffness;
    t->max = max_grasped;
    t->now = arena_take(&t->term.memory, max_grasped, sizeof *t->now);
    t->next = arena_take(&t->term.memory, max_grasped, sizeof *t->next);
    t->target = arena_take(&t->term.memory, 3 * max_grasped, sizeof *t->target);
    return &t->term;
}

/* ---- the public calls ---------------------------------------------------------------------------- */

static grasp *find_grasp_term(const palp_network *net) {
    return (grasp *)network_find_term(net, &GRASP);
}

static grasped *find_grasped_node(const grasp *t, int32_t node) {
    for (size_t i = 0; i < t->n; i++)
        if (t->now[i].node == node)
            return &t->now[i];
    return NULL;
}

static bool are_nodes_in_range(const palp_network *net, size_t n, const int32_t *nodes) {
    if (!net || !find_grasp_term(net) || (n > 0 && !nodes))
        return false;
    for (size_t i = 0; i < n; i++)
        if (nodes[i] < 0 || (size_t)nodes[i] >= net->n_nodes)
            return false;
    return true;
}

static void announce_grasp_change(palp_network *net) {
    net->trial = false;
    NETWORK_EACH_TERM(net, grasp_changed, net);
}

palp_status palp_network_grasp(palp_network *net, size_t n, const int32_t *nodes, const double *target_m) {
    if (!are_nodes_in_range(net, n, nodes) || (n > 0 && !target_m))
        return PALP_ERR_ARGUMENT;
    grasp *t = find_grasp_term(net);
    size_t room = t->max - t->n;
    for (size_t i = 0; i < n; i++) {
        if (!finite3(target_m + 3 * i))
            return PALP_ERR_ARGUMENT;
        if (!find_grasped_node(t, nodes[i]) && room-- == 0)
            return PALP_ERR_LIMIT;
    }
    for (size_t i = 0; i < n; i++) {
        grasped *g = find_grasped_node(t, nodes[i]);
        if (!g) {
            g = &t->now[t->n++];
            *g = (grasped){.node = nodes[i]};
            memcpy(g->was, net->now.x + 3 * nodes[i], sizeof g->was);
        }
        memcpy(g->target, target_m + 3 * i, sizeof g->target);
    }
    announce_grasp_change(net);
    return PALP_OK;
}

palp_status palp_network_release(palp_network *net, size_t n, const int32_t *nodes) {
    if (!are_nodes_in_range(net, n, nodes))
        return PALP_ERR_ARGUMENT;
    grasp *t = find_grasp_term(net);
    for (size_t i = 0; i < n; i++) {
        grasped *g = find_grasped_node(t, nodes[i]);
        if (g) {
            t->n--;
            memmove(g, g + 1, (size_t)(t->now + t->n - g) * sizeof *g);
        }
    }
    announce_grasp_change(net);
    return PALP_OK;
}

palp_status palp_network_grasp_force(const palp_network *net, size_t n, const int32_t *nodes,
                                     double force_N[3]) {
    if (!are_nodes_in_range(net, n, nodes) || !force_N)
        return PALP_ERR_ARGUMENT;
    force_N[0] = force_N[1] = force_N[2] = 0.0;
    for (size_t i = 0; i < n; i++) {
        const grasped *g = find_grasped_node(find_grasp_term(net), nodes[i]);
        if (g)
            along3(force_N, 1.0, g->force, force_N);
    }
    return PALP_OK;
}
