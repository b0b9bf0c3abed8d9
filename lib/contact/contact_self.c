/* contact_self.c: tissue that touches itself or another part of the mesh. A node of the surface is a point
 * that triangles of the surface touch like a tool; it takes the opposite forces. */
#include "contact_internal.h"

#include "mesh/mesh_internal.h"

#include <string.h>

static const double REACH = 0.5;  /* of an edge: so near, a node may come to touch in a step */
static const double MARGIN = 0.5; /* of an edge: the list of pairs lasts until nodes have moved half of it */
static const double LOYAL = 0.02; /* of an edge: a node changes triangles for at least so much */
static const double LEVEL = 1e-9; /* of an edge: on the surface, neither outside nor inside */
/* Room for pairs, for entries in cells and for cells, each by triangles of the surface. A step with more
 * pairs fails; with more entries or cells the cells are larger. */
enum { PAIRS = 32, ENTRIES = 16, CELLS = 8 };

/* A node of the surface and a triangle of it. */
typedef struct self_pair {
    int32_t node, triangle;
    bool open; /* the node was outside the triangle at the committed state */
} self_pair;

/* What a state keeps of a node. */
typedef struct self_touch {
    bool touches;
    double outward[3]; /* normal of the triangle */
    double depth;      /* in it, m */
    double stretch[3]; /* of friction's spring, m */
    contact_doubt doubt;
} self_touch;

typedef struct self_state {
    self_touch *touch; /* [n_nodes] */
    size_t n_told;
    palp_contact *told; /* [n_nodes], not saved with the state; node and region are not set */
} self_state;

/* A node near a triangle: contact's tool is the node. */
typedef struct self_contact {
    int32_t node, triangle;
    contact contact;
} self_contact;

typedef struct self_term {
    network_term term;
    contact_set set;        /* its only tool is a point */
    size_t surface_changes; /* count of the network's when nodes were listed */
    int32_t *node;          /* [n_listed] nodes of the surface */
    size_t n_listed;
    self_pair *pair; /* [n_pairs] by nodes: near each other at built */
    size_t n_pairs, max_pairs;
    bool overflows;  /* there were more */
    double *built;   /* [3 n_nodes] */
    double *outward; /* [3 n_nodes] there: sums of the normals of a node's triangles, by area */
    bool is_built;
    uint32_t *first; /* [cells + 1] entries of each cell of a grid */
    int32_t *entry;
    size_t max_cells, max_entries;
    self_contact *contact, *found; /* [n_contacts], and those that are looked for */
    size_t n_contacts;
    int32_t *triangle; /* [n_nodes] that a node is near, or -1 */
    double *found_at;  /* [3 n_nodes] where contacts were found */
    self_state now, next;
} self_term;

static void reset_self_contacts(network_term *term, palp_network *net) {
    self_term *t = (self_term *)term;
    memset(t->now.touch, 0, net->n_nodes * sizeof *t->now.touch);
    t->now.n_told = 0;
    for (size_t i = 0; i < net->n_nodes; i++)
        t->triangle[i] = -1;
    t->n_contacts = 0;
}

static void pass_self_state(network_term *term, palp_network *net, network_cursor *cursor) {
    self_term *t = (self_term *)term;
    if (cursor->way == NETWORK_RESTORE)
        reset_self_contacts(term, net);
    network_pass(cursor, t->now.touch, net->n_nodes * sizeof *t->now.touch);
}

static void swap_self_states(network_term *term, palp_network *net) {
    self_term *t = (self_term *)term;
    self_state old = t->now;
    (void)net;
    t->now = t->next;
    t->next = old;
}

/* ---- pairs that are near ------------------------------------------------------------------------- */

typedef struct grid {
    double low[3], cell;
    size_t n[3];
} grid;

static double furthest_of_listed_nodes(const self_term *t, const double *a, const double *b) {
    double most = 0.0;
    for (size_t i = 0; i < t->n_listed; i++) {
        double d[3];
        const size_t at = 3 * (size_t)t->node[i];
        along3(a + at, -1.0, b + at, d);
        most = fmax(most, dot3(d, d));
    }
    return sqrt(most);
}

/* Is a node of the triangle this one, or joined to it by an element that is not cut? */
static bool is_triangle_next_to_node(const palp_network *net, const int32_t *triangle, int32_t node) {
    for (int i = 0; i < 3; i++) {
        const size_t e =
            triangle[i] == node ? net->n_elements : palp_mesh_element_between(net->mesh, triangle[i], node);
        if (triangle[i] == node || (e < net->n_elements && (net->n_dead == 0 || net->scale[e] != 0.0)))
            return true;
    }
    return false;
}

static bool place_grid_over_surface(const self_term *t, const double *x, double cell, grid *g) {
    double high[3];
    size_t cells = 1;
    for (size_t k = 0; k < 3; k++)
        g->low[k] = high[k] = x[3 * (size_t)t->node[0] + k];
    for (size_t i = 1; i < t->n_listed; i++)
        for (size_t k = 0; k < 3; k++) {
            g->low[k] = fmin(g->low[k], x[3 * (size_t)t->node[i] + k]);
            high[k] = fmax(high[k], x[3 * (size_t)t->node[i] + k]);
        }
    g->cell = cell;
    for (size_t k = 0; k < 3; k++) {
        const double n = floor((high[k] - g->low[k]) / cell) + 1.0;
        if (!(n <= (double)(t->max_cells / cells)))
            return false;
        g->n[k] = (size_t)n;
        cells *= g->n[k];
    }
    return true;
}

static size_t cell_along_axis(const grid *g, size_t axis, double x) {
    const double at = floor((x - g->low[axis]) / g->cell);
    return at < 1.0 ? 0 : at >= (double)g->n[axis] ? g->n[axis] - 1 : (size_t)at;
}

static void box_around_triangle(const double *x, const int32_t *triangle, double more, double low[3],
                                double high[3]) {
    for (size_t k = 0; k < 3; k++) {
        const double a = x[3 * (size_t)triangle[0] + k], b = x[3 * (size_t)triangle[1] + k],
                     c = x[3 * (size_t)triangle[2] + k];
        low[k] = fmin(a, fmin(b, c)) - more;
        high[k] = fmax(a, fmax(b, c)) + more;
    }
}

/* Enters each triangle in the cells around it, or only counts; returns the number of entries. */
static size_t enter_triangles_in_grid(self_term *t, const grid *g, const double *x, double reach,
                                      bool count) {
    size_t n = 0;
    for (size_t i = 0; i < t->set.n_surface; i++) {
        double low[3], high[3];
        size_t from[3], to[3];
        box_around_triangle(x, t->set.surface + 3 * i, reach, low, high);
        for (size_t k = 0; k < 3; k++) {
            from[k] = cell_along_axis(g, k, low[k]);
            to[k] = cell_along_axis(g, k, high[k]);
        }
        for (size_t a = from[0]; a <= to[0]; a++)
            for (size_t b = from[1]; b <= to[1]; b++)
                for (size_t c = from[2]; c <= to[2]; c++, n++) {
                    const size_t cell = (a * g->n[1] + b) * g->n[2] + c;
                    if (count)
                        t->first[cell + 1]++;
                    else
                        t->entry[t->first[cell]++] = (int32_t)i;
                }
    }
    return n;
}

/* Sorts the triangles into cells that are as small as there is room. */
static void sort_triangles_into_grid(self_term *t, const double *x, double reach, grid *g) {
    for (double cell = t->set.edge;; cell *= 2.0) {
        if (!place_grid_over_surface(t, x, cell, g))
            continue;
        const size_t cells = g->n[0] * g->n[1] * g->n[2];
        memset(t->first, 0, (cells + 1) * sizeof *t->first);
        if (enter_triangles_in_grid(t, g, x, reach, true) > t->max_entries)
            continue;
        for (size_t i = 0; i < cells; i++)
            t->first[i + 1] += t->first[i];
        enter_triangles_in_grid(t, g, x, reach, false);
        memmove(t->first + 1, t->first, cells * sizeof *t->first);
        t->first[0] = 0;
        return;
    }
}

static void outward_of_triangle(const double *x, const int32_t *node, double outward[3]) {
    triangle_normal(x + 3 * node[0], x + 3 * node[1], x + 3 * node[2], outward);
}

static void find_outward_of_nodes(self_term *t, const double *x) {
    memset(t->outward, 0, 3 * t->set.n_nodes * sizeof *t->outward);
    for (size_t i = 0; i < t->set.n_surface; i++) {
        const int32_t *triangle = t->set.surface + 3 * i;
        double outward[3];
        outward_of_triangle(x, triangle, outward);
        for (int j = 0; j < 3; j++)
            along3(t->outward + 3 * triangle[j], 1.0, outward, t->outward + 3 * triangle[j]);
    }
}

/* The surface at the node and the triangle face each other. A node on an edge between two faces is on a level
 * with triangles that it does not face. */
static bool does_node_face_triangle(const self_term *t, const double *x, const int32_t *triangle,
                                    int32_t node) {
    double outward[3];
    outward_of_triangle(x, triangle, outward);
    return dot3(outward, t->outward + 3 * node) < 0.0;
}

static void list_pairs_of_node(self_term *t, const palp_network *net, const grid *g, const double *x,
                               double reach, int32_t node) {
    const double *p = x + 3 * node;
    const size_t cell = (cell_along_axis(g, 0, p[0]) * g->n[1] + cell_along_axis(g, 1, p[1])) * g->n[2] +
                        cell_along_axis(g, 2, p[2]);
    for (uint32_t e = t->first[cell]; e < t->first[cell + 1]; e++) {
        const int32_t *triangle = t->set.surface + 3 * t->entry[e];
        double low[3], high[3], share[3];
        box_around_triangle(x, triangle, reach, low, high);
        bool near = true;
        for (int k = 0; k < 3; k++)
            near = near && p[k] >= low[k] && p[k] <= high[k];
        if (!near || !does_node_face_triangle(t, x, triangle, node) ||
            is_triangle_next_to_node(net, triangle, node) ||
            contact_nearest_distance(x, triangle, p, share) > reach)
            continue;
        t->overflows = t->n_pairs == t->max_pairs;
        if (t->overflows)
            return;
        t->pair[t->n_pairs++] = (self_pair){node, t->entry[e], false};
    }
}

/* Lists the pairs that may come to touch, unless the list still holds at x; false if it does. */
static bool update_list_of_pairs(self_term *t, const palp_network *net, const double *x) {
    const double edge = t->set.edge;
    grid g;
    if (t->is_built && furthest_of_listed_nodes(t, x, t->built) <= 0.5 * MARGIN * edge)
        return false;
    memcpy(t->built, x, 3 * net->n_nodes * sizeof *x);
    t->is_built = true;
    t->n_pairs = 0;
    t->overflows = false;
    find_outward_of_nodes(t, x);
    sort_triangles_into_grid(t, x, (REACH + MARGIN) * edge, &g);
    for (size_t i = 0; i < t->n_listed; i++)
        list_pairs_of_node(t, net, &g, x, (REACH + MARGIN) * edge, t->node[i]);
    return true;
}

/* ---- contacts ------------------------------------------------------------------------------------ */

/* Was the node outside the plane of this triangle at the last committed state? One that touched was a little
 * inside; it stays on the side that it came from, and cannot be deeper in a triangle that it slides onto. */
static bool was_node_outside_triangle(const self_term *t, const palp_network *net, const self_pair *pair) {
    const self_touch *was = &t->now.touch[pair->node];
    const double *x = net->now.x, edge = t->set.edge;
    const int32_t *node = t->set.surface + 3 * pair->triangle;
    double away[3], outward[3];
    along3(x + 3 * pair->node, -1.0, x + 3 * node[0], away);
    outward_of_triangle(x, node, outward);
    const double height = dot3(away, outward) / sqrt(dot3(outward, outward));
    return was->touches ? dot3(was->outward, outward) > 0.0 && height >= -was->depth - LOYAL * edge
                        : height >= -LEVEL * edge;
}

static void open_pairs(self_term *t, const palp_network *net) {
    for (size_t i = 0; i < t->n_pairs; i++)
        t->pair[i].open = was_node_outside_triangle(t, net, &t->pair[i]);
}

static double mean_unit_of_triangle(const palp_network *net, const int32_t *node) {
    return (net->unit[node[0]] + net->unit[node[1]] + net->unit[node[2]]) / 3.0;
}

/* A node a little beside the triangle is on it too: on the edge between two, rounding puts it beside both. */
static bool is_node_on_triangle(const self_term *t, const self_contact *s, double distance) {
    const double depth = s->contact.depth, beside = LOYAL * t->set.edge;
    return distance * distance - depth * depth <= beside * beside;
}

/* A node with this triangle at x, as stiff as the softer of both; false if it was inside or is far away.
 * Sets the distance, which is less for the triangle that the node has already. */
static bool try_contact_of_pair(const self_term *t, const palp_network *net, const self_pair *pair,
                                const double *x, self_contact *s, double *distance) {
    const int32_t *node = t->set.surface + 3 * pair->triangle;
    double share[3];
    if (!pair->open)
        return false;
    s->node = pair->node;
    s->triangle = pair->triangle;
    contact *c = &s->contact;
    *c = (contact){.node = {node[0], node[1], node[2]}, .corners = 3, .memory = -1, .tissue = true};
    memcpy(t->set.pose->position_m, x + 3 * pair->node, 3 * sizeof *x);
    contact_measure(t->set.pose, c, x);
    *distance = contact_nearest_distance(x, node, x + 3 * pair->node, share);
    if (!(c->depth > -REACH * t->set.edge) || !is_node_on_triangle(t, s, *distance))
        return false;
    if (t->triangle[s->node] == s->triangle)
        *distance -= LOYAL * t->set.edge;
    memcpy(c->stick_share, c->share, sizeof c->share);
    c->stiffness = t->set.settings.stiffness * net->modulus *
                   fmin(net->unit[pair->node], mean_unit_of_triangle(net, node));
    c->touched = t->now.touch[pair->node].touches;
    c->doubt = t->now.touch[pair->node].doubt;
    memcpy(c->was, t->now.touch[pair->node].stretch, sizeof c->was);
    c->entry = c->touched ? 1.0 : 0.0;
    return true;
}

/* Each node near the surface, with its nearest triangle. Returns their number in t->found. */
static size_t find_contacts_of_nodes(self_term *t, const palp_network *net, bool begins, const double *x) {
    size_t n = 0;
    if (update_list_of_pairs(t, net, x) || begins)
        open_pairs(t, net);
    memcpy(t->found_at, x, 3 * net->n_nodes * sizeof *x);
    for (size_t i = 0; i < t->n_pairs;) {
        const int32_t node = t->pair[i].node;
        double least = INFINITY, distance;
        for (; i < t->n_pairs && t->pair[i].node == node; i++) {
            self_contact s;
            if (!try_contact_of_pair(t, net, &t->pair[i], x, &s, &distance) || !(distance < least))
                continue;
            t->found[n] = s;
            least = distance;
        }
        n += isfinite(least) ? 1 : 0;
    }
    return n;
}

static void use_contacts_found(self_term *t, size_t n) {
    self_contact *old = t->contact;
    for (size_t i = 0; i < t->n_contacts; i++)
        t->triangle[t->contact[i].node] = -1;
    t->contact = t->found;
    t->found = old;
    t->n_contacts = n;
    for (size_t i = 0; i < n; i++)
        t->triangle[t->contact[i].node] = t->contact[i].triangle;
}

static void list_nodes_of_surface(self_term *t, const palp_network *net) {
    contact_set_surface(&t->set, net->n_surface, net->surface);
    t->surface_changes = net->surface_changes;
    t->n_listed = 0;
    t->is_built = false;
    for (size_t i = 0; i < net->n_nodes; i++)
        if (t->set.triangles[i] > 0)
            t->node[t->n_listed++] = (int32_t)i;
    for (size_t i = 0; i < net->n_nodes; i++)
        t->triangle[i] = -1;
    t->n_contacts = 0;
}

static void begin_self_step(network_term *term, palp_network *net) {
    self_term *t = (self_term *)term;
    if (t->surface_changes != net->surface_changes)
        list_nodes_of_surface(t, net);
    if (t->n_listed > 0)
        use_contacts_found(t, find_contacts_of_nodes(t, net, true, net->now.x));
}

/* Nodes that are near have a triangle; have they slid so far that it may be another one? */
static bool refresh_self_contacts(network_term *term, palp_network *net) {
    self_term *t = (self_term *)term;
    bool other = false;
    if (t->n_listed == 0 || furthest_of_listed_nodes(t, net->next.x, t->found_at) <= LOYAL * t->set.edge)
        return false;
    const size_t n = find_contacts_of_nodes(t, net, false, net->next.x);
    for (size_t i = 0; i < n; i++)
        other = other ||
                (t->found[i].contact.depth > 0.0 && t->triangle[t->found[i].node] != t->found[i].triangle);
    if (other)
        use_contacts_found(t, n);
    return other;
}

/* ---- forces -------------------------------------------------------------------------------------- */

/* Moves the tool to the node, and the start of friction's spring with it. */
static void place_contact_at_node(const self_term *t, const palp_network *net, self_contact *s) {
    const double *x = net->next.x + 3 * s->node, *was = net->now.x + 3 * s->node;
    contact *c = &s->contact;
    memcpy(t->set.pose->position_m, x, 3 * sizeof *x);
    if (!(t->set.settings.tissue_friction > 0.0))
        return;
    contact_point(c, c->stick_share, net->now.x, c->anchor);
    along3(c->anchor, 1.0, x, c->anchor);
    along3(c->anchor, -1.0, was, c->anchor);
    if (c->touched)
        along3(c->anchor, -1.0, t->now.touch[s->node].stretch, c->anchor);
}

static void evaluate_self_forces(network_term *term, palp_network *net) {
    self_term *t = (self_term *)term;
    const double *x = net->next.x;
    for (size_t i = 0; i < t->n_contacts; i++) {
        self_contact *s = &t->contact[i];
        contact *c = &s->contact;
        place_contact_at_node(t, net, s);
        contact_evaluate(&t->set, c, x);
        if (!(c->depth > 0.0))
            continue;
        double *own = net->outer + 3 * s->node;
        for (int j = 0; j < 3; j++) {
            double *f = net->outer + 3 * c->node[j];
            along3(f, c->share[j] * c->pressure, c->normal, f);
            along3(f, c->stick_share[j], c->friction, f);
        }
        along3(own, -c->pressure, c->normal, own);
        along3(own, -1.0, c->friction, own);
        net->outer_squares +=
            c->stiffness * c->stiffness * (dot3(c->point, c->point) + dot3(x + 3 * s->node, x + 3 * s->node));
    }
}

static palp_contact tell_self_contact(const self_term *t, const self_contact *s) {
    const contact *c = &s->contact;
    palp_contact told = {.tool = PALP_CONTACT_TISSUE,
                         .normal_N = c->pressure,
                         .depth_m = c->depth,
                         .slips = t->set.settings.tissue_friction > 0.0 && c->kept < 1.0,
                         .node = s->node,
                         .other = contact_main_corner(c)};
    memcpy(told.place_m, c->point, sizeof c->point);
    for (int k = 0; k < 3; k++) {
        told.normal[k] = -c->normal[k];
        told.friction_N[k] = -c->friction[k];
    }
    return told;
}

static void finish_self_step(network_term *term, palp_network *net) {
    self_term *t = (self_term *)term;
    self_state *next = &t->next;
    memset(next->touch, 0, net->n_nodes * sizeof *next->touch);
    next->n_told = 0;
    for (size_t i = 0; i < t->n_contacts; i++) {
        const contact *c = &t->contact[i].contact;
        self_touch *touch = &next->touch[t->contact[i].node];
        if (!(c->depth > 0.0))
            continue;
        next->told[next->n_told++] = tell_self_contact(t, &t->contact[i]);
        touch->touches = true;
        touch->depth = c->depth;
        for (int k = 0; k < 3; k++)
            touch->outward[k] = -c->normal[k];
        if (t->set.settings.tissue_friction > 0.0)
            memcpy(touch->stretch, c->stretch, sizeof c->stretch);
    }
}

static void add_self_uncertainty(const network_term *term, const palp_network *net, double *sum) {
    const self_term *t = (const self_term *)term;
    (void)net;
    for (size_t i = 0; i < t->n_contacts; i++)
        *sum += contact_force_doubt(&t->set, &t->contact[i].contact);
}

/* The node, which is the tool, is off as well as the triangle. */
static void keep_self_uncertainty(network_term *term, palp_network *net, const double *change, double error) {
    self_term *t = (self_term *)term;
    double all = 0.0;
    (void)net;
    for (size_t i = 0; i < t->n_contacts; i++)
        all += contact_friction_limit(&t->set, &t->contact[i].contact);
    for (size_t i = 0; i < t->n_contacts && all > 0.0; i++) {
        const contact *c = &t->contact[i].contact;
        const int32_t node = t->contact[i].node;
        double off[3];
        if (change) {
            contact_point(c, c->stick_share, change, off);
            along3(off, -1.0, change + 3 * node, off);
        }
        t->next.touch[node].doubt = contact_doubt_to_keep(&t->set, c, change ? off : NULL,
                                                          error * contact_friction_limit(&t->set, c) / all);
    }
}

/* ---- tangent and energy -------------------------------------------------------------------------- */

static void take_self_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                             void *user) {
    const self_term *t = (const self_term *)term;
    (void)net;
    for (size_t i = 0; i < t->n_contacts; i++) {
        const self_contact *s = &t->contact[i];
        const contact *c = &s->contact;
        double own[9] = {0.0}, k[9];
        if (!(c->depth > 0.0))
            continue;
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                contact_block(c, a, b, k);
                if (b <= a)
                    take(user, c->node[a], c->node[b], k);
                for (int e = 0; e < 9; e++)
                    own[e] += k[e];
            }
        take(user, s->node, s->node, own);
    }
}

/* Between the node and each corner of its triangle. */
static void take_far_self_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                                 void *user) {
    const self_term *t = (const self_term *)term;
    (void)net;
    for (size_t i = 0; i < t->n_contacts; i++) {
        const self_contact *s = &t->contact[i];
        for (int a = 0; a < 3 && s->contact.depth > 0.0; a++) {
            double row[9] = {0.0}, k[9];
            for (int b = 0; b < 3; b++) {
                contact_block(&s->contact, a, b, k);
                for (int e = 0; e < 9; e++)
                    row[e] -= k[e];
            }
            take(user, s->contact.node[a], s->node, row);
        }
    }
}

/* The tool moves with its node: the corners' displacements count relative to that. */
static void add_self_product(const network_term *term, contact_product *times, const double *u, double *out) {
    const self_term *t = (const self_term *)term;
    for (size_t i = 0; i < t->n_contacts; i++) {
        const self_contact *s = &t->contact[i];
        contact c = s->contact;
        double own[9], pull[9] = {0.0};
        if (!(c.depth > 0.0))
            continue;
        for (int j = 0; j < 3; j++) {
            along3(u + 3 * c.node[j], -1.0, u + 3 * s->node, own + 3 * j);
            c.node[j] = j;
        }
        times(&c, own, pull);
        for (int j = 0; j < 3; j++) {
            double *at = out + 3 * s->contact.node[j];
            along3(at, 1.0, pull + 3 * j, at);
            along3(out + 3 * s->node, -1.0, pull + 3 * j, out + 3 * s->node);
        }
    }
}

static void multiply_self_tangent(const network_term *term, const palp_network *net, const double *u,
                                  double *out) {
    (void)net;
    add_self_product(term, contact_times, u, out);
}

static void multiply_whole_self_tangent(const network_term *term, const palp_network *net, const double *u,
                                        double *out) {
    (void)net;
    add_self_product(term, contact_whole_times, u, out);
}

static bool add_self_energy(const network_term *term, const palp_network *net, double *energy) {
    const self_term *t = (const self_term *)term;
    (void)net;
    for (size_t i = 0; i < t->n_contacts; i++) {
        if (!(t->contact[i].contact.depth > 0.0))
            continue;
        if (t->set.settings.tissue_friction > 0.0)
            return false;
        *energy += contact_energy(&t->set, &t->contact[i].contact);
    }
    return true;
}

static palp_status check_pairs(const network_term *term, const palp_network *net) {
    (void)net;
    return ((const self_term *)term)->overflows ? PALP_ERR_LIMIT : PALP_OK;
}

static const network_term_kind SELF = {.reset = reset_self_contacts,
                                       .pass = pass_self_state,
                                       .swap = swap_self_states,
                                       .begin = begin_self_step,
                                       .evaluate = evaluate_self_forces,
                                       .finish = finish_self_step,
                                       .check = check_pairs,
                                       .blocks = take_self_blocks,
                                       .far_blocks = take_far_self_blocks,
                                       .times = multiply_self_tangent,
                                       .whole_times = multiply_whole_self_tangent,
                                       .energy = add_self_energy,
                                       .doubt = add_self_uncertainty,
                                       .keep_doubt = keep_self_uncertainty,
                                       .refresh = refresh_self_contacts};

network_term *contact_self_new(const palp_network *net, const palp_contact_settings *settings) {
    self_term *t = network_term_new(&SELF, sizeof *t);
    palp_contact_settings own = *settings;
    if (!t)
        return NULL;
    arena *memory = &t->term.memory;
    const size_t n = net->n_nodes, triangles = net->n_surface,
                 tetrahedra = palp_mesh_tetrahedron_count(net->mesh);
    own.max_contacts = 1;
    own.stiffness = settings->tissue_stiffness;
    own.local = false;
    contact_set_create(&t->set, memory, n, net->rest, triangles, net->surface, net->unit, net->extent, 1,
                       &own);
    t->max_pairs = PAIRS * triangles;
    t->max_cells = CELLS * triangles;
    t->max_entries = ENTRIES * triangles + 4 * tetrahedra; /* all triangles of a cut mesh, in one cell */
    t->node = arena_take(memory, n, sizeof *t->node);
    t->pair = arena_take(memory, t->max_pairs, sizeof *t->pair);
    t->built = arena_take(memory, 3 * n, sizeof *t->built);
    t->outward = arena_take(memory, 3 * n, sizeof *t->outward);
    t->found_at = arena_take(memory, 3 * n, sizeof *t->found_at);
    t->first = arena_take(memory, t->max_cells + 1, sizeof *t->first);
    t->entry = arena_take(memory, t->max_entries, sizeof *t->entry);
    t->contact = arena_take(memory, n, sizeof *t->contact);
    t->found = arena_take(memory, n, sizeof *t->found);
    t->triangle = arena_take(memory, n, sizeof *t->triangle);
    for (int i = 0; i < 2; i++) {
        self_state *state = i == 0 ? &t->now : &t->next;
        state->touch = arena_take(memory, n, sizeof *state->touch);
        state->told = arena_take(memory, n, sizeof *state->told);
    }
    if (!memory->failed) {
        t->set.pose[0] = (palp_tool){.shape = PALP_TOOL_SPHERE, .friction = t->set.settings.tissue_friction};
        t->set.tool[0] = t->set.pose[0];
        list_nodes_of_surface(t, net);
    }
    return &t->term;
}

const palp_contact *contact_self_told(const palp_network *net, size_t *n) {
    const self_term *t = (const self_term *)network_find_term(net, &SELF);
    *n = t ? t->now.n_told : 0;
    return t ? t->now.told : NULL;
}
