/* tie.c: threads and rods through points of the tissue. */
#include "contact_internal.h"

#include <palpate/tie.h>

#include <string.h>

enum { PAIRS = 500, ENTRIES = 4 * PALP_TIE_POINTS };

typedef struct tie_term {
    network_term term;
    size_t max, n;
    palp_tie *tie;              /* [max] */
    double *was;                /* [3 max PALP_TIE_POINTS] places of points at the committed state */
    double *place;              /* the same, at the present evaluation */
    double *was_length;         /* [max] without force at the committed state, m */
    double *length;             /* the same, at the present evaluation */
    palp_tie_state *now, *next; /* [max] */
} tie_term;

/* A tie's shape at some positions of the nodes. */
typedef struct tie_shape {
    double point[PALP_TIE_POINTS][3];
    double along[PALP_TIE_POINTS][3]; /* unit vector of the segment from each point to the next */
    double segment[PALP_TIE_POINTS];  /* its length, m */
    double length, force;
} tie_shape;

static void reset_ties(network_term *term, palp_network *net) {
    tie_term *t = (tie_term *)term;
    (void)net;
    memset(t->now, 0, t->max * sizeof *t->now);
    for (size_t i = 0; i < t->n; i++) {
        t->was_length[i] = t->tie[i].length_m;
        for (size_t k = 0; k < PALP_TIE_POINTS; k++)
            memcpy(t->was + 3 * (i * PALP_TIE_POINTS + k), t->tie[i].point[k].place_m, 3 * sizeof *t->was);
    }
}

static void pass_tie_state(network_term *term, palp_network *net, network_cursor *cursor) {
    tie_term *t = (tie_term *)term;
    (void)net;
    network_pass(cursor, &t->n, sizeof t->n);
    network_pass(cursor, t->tie, t->max * sizeof *t->tie);
    network_pass(cursor, t->was, 3 * t->max * PALP_TIE_POINTS * sizeof *t->was);
    network_pass(cursor, t->was_length, t->max * sizeof *t->was_length);
    network_pass(cursor, t->now, t->max * sizeof *t->now);
}

static void swap_tie_states(network_term *term, palp_network *net) {
    tie_term *t = (tie_term *)term;
    palp_tie_state *old = t->now;
    (void)net;
    t->now = t->next;
    t->next = old;
    memcpy(t->was, t->place, 3 * t->n * PALP_TIE_POINTS * sizeof *t->was);
    memcpy(t->was_length, t->length, t->n * sizeof *t->length);
}

/* ---- a step -------------------------------------------------------------------------------------- */

static double part_of_way(double share, double from, double to) {
    return share * to + (1.0 - share) * from;
}

static void place_points_of_ties(network_term *term, palp_network *net, double share) {
    tie_term *t = (tie_term *)term;
    (void)net;
    for (size_t i = 0; i < t->n; i++) {
        t->length[i] = part_of_way(share, t->was_length[i], t->tie[i].length_m);
        for (size_t k = 0; k < PALP_TIE_POINTS; k++)
            for (size_t c = 0, at = 3 * (i * PALP_TIE_POINTS + k); c < 3; c++)
                t->place[at + c] = part_of_way(share, t->was[at + c], t->tie[i].point[k].place_m[c]);
    }
}

static void begin_tie_step(network_term *term, palp_network *net) {
    place_points_of_ties(term, net, 1.0);
}

/* Does the place of this point go on from where it was? The places of new ties do not move in a step. */
static bool was_point_outside(const tie_term *t, size_t i, size_t k) {
    return i < t->n && k < t->tie[i].n_points && t->tie[i].point[k].node[0] < 0;
}

/* A tie can be followed over any distance at once. */
static double longest_way_of_ties(const network_term *term, const palp_network *net) {
    const tie_term *t = (const tie_term *)term;
    (void)net;
    for (size_t i = 0; i < t->n; i++) {
        if (t->was_length[i] != t->tie[i].length_m)
            return 1.0;
        for (size_t k = 0; k < PALP_TIE_POINTS; k++)
            if (was_point_outside(t, i, k) && memcmp(t->was + 3 * (i * PALP_TIE_POINTS + k),
                                                     t->tie[i].point[k].place_m, 3 * sizeof *t->was) != 0)
                return 1.0;
    }
    return 0.0;
}

/* Sum of share times u[3 n_nodes] at the nodes of a point; 0 for one outside the tissue. */
static void take_at_point(const palp_tie_point *p, const double *u, double at[3]) {
    at[0] = at[1] = at[2] = 0.0;
    for (int k = 0; k < 4 && p->node[0] >= 0; k++)
        if (p->share[k] != 0.0)
            along3(at, p->share[k], u + 3 * p->node[k], at);
}

/* slack: its length without force. place[3 PALP_TIE_POINTS]: of points that are not in the tissue. */
static void shape_of_tie(const palp_tie *tie, double slack, const double *place, const double *x,
                         tie_shape *shape) {
    shape->length = 0.0;
    for (size_t i = 0; i < tie->n_points; i++) {
        const palp_tie_point *p = &tie->point[i];
        memcpy(shape->point[i], place + 3 * i, sizeof shape->point[i]);
        if (p->node[0] >= 0)
            take_at_point(p, x, shape->point[i]);
    }
    for (size_t i = 0; i + 1 < tie->n_points; i++) {
        double d[3], none[3] = {0.0};
        along3(shape->point[i + 1], -1.0, shape->point[i], d);
        shape->segment[i] = sqrt(dot3(d, d));
        along3(none, shape->segment[i] > 0.0 ? 1.0 / shape->segment[i] : 0.0, d, shape->along[i]);
        shape->length += shape->segment[i];
    }
    const double longer = shape->length - slack;
    shape->force = tie->rod || longer > 0.0 ? tie->stiffness_N_m * longer : 0.0;
}

static bool is_tie_at_work(const tie_term *t, const palp_network *net, size_t i, tie_shape *shape) {
    if (t->now[i].torn)
        return false;
    shape_of_tie(&t->tie[i], t->length[i], t->place + 3 * i * PALP_TIE_POINTS, net->next.x, shape);
    return shape->force != 0.0;
}

/* Derivative of the length by the place of a point. */
static void slope_of_length(const palp_tie *tie, const tie_shape *shape, size_t i, double slope[3]) {
    slope[0] = slope[1] = slope[2] = 0.0;
    if (i > 0)
        along3(slope, 1.0, shape->along[i - 1], slope);
    if (i + 1 < tie->n_points)
        along3(slope, -1.0, shape->along[i], slope);
}

/* out += share times v at the nodes of a point. */
static void add_at_point(const palp_tie_point *p, double factor, const double v[3], double *out) {
    for (int k = 0; k < 4 && p->node[0] >= 0; k++)
        if (p->share[k] != 0.0)
            along3(out + 3 * p->node[k], factor * p->share[k], v, out + 3 * p->node[k]);
}

static void evaluate_tie_forces(network_term *term, palp_network *net) {
    const tie_term *t = (const tie_term *)term;
    tie_shape shape;
    for (size_t i = 0; i < t->n; i++) {
        const palp_tie *tie = &t->tie[i];
        if (!is_tie_at_work(t, net, i, &shape))
            continue;
        for (size_t k = 0; k < tie->n_points; k++) {
            double slope[3];
            slope_of_length(tie, &shape, k, slope);
            add_at_point(&tie->point[k], -shape.force, slope, net->outer);
            net->outer_squares +=
                tie->stiffness_N_m * tie->stiffness_N_m * dot3(shape.point[k], shape.point[k]);
        }
    }
}

static void finish_tie_step(network_term *term, palp_network *net) {
    tie_term *t = (tie_term *)term;
    tie_shape shape;
    for (size_t i = 0; i < t->n; i++) {
        shape_of_tie(&t->tie[i], t->length[i], t->place + 3 * i * PALP_TIE_POINTS, net->next.x, &shape);
        const bool torn = t->now[i].torn;
        t->next[i] = (palp_tie_state){.force_N = torn ? 0.0 : shape.force,
                                      .length_m = shape.length,
                                      .torn = torn || shape.force > t->tie[i].strength_N};
    }
}

/* ---- tangent and energy -------------------------------------------------------------------------- */

/* Adds size (1 - a a') to block[9]. */
static void add_across(double size, const double a[3], double block[9]) {
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            block[3 * r + c] += size * ((r == c) - a[r] * a[c]);
}

/* -d force on point i / d place of point j: stiffness g_i g_j' + tension times the second derivative of the
 * length, (1 - a a') / segment for each segment. */
static void block_of_points(const palp_tie *tie, const tie_shape *shape, size_t i, size_t j,
                            double block[9]) {
    double gi[3], gj[3];
    slope_of_length(tie, shape, i, gi);
    slope_of_length(tie, shape, j, gj);
    for (int e = 0; e < 9; e++)
        block[e] = tie->stiffness_N_m * gi[e / 3] * gj[e % 3];
    const size_t low = i < j ? i : j, high = i < j ? j : i;
    for (size_t s = high > 0 ? high - 1 : 0; s <= low && s + 1 < tie->n_points; s++)
        if (shape->segment[s] > 0.0)
            add_across((i == j ? 1.0 : -1.0) * shape->force / shape->segment[s], shape->along[s], block);
}

/* The nodes of all points: which point, and the share in it. */
typedef struct tie_entry {
    size_t point;
    int32_t node;
    double share;
} tie_entry;

static size_t list_entries_of_tie(const palp_tie *tie, tie_entry entry[ENTRIES]) {
    size_t n = 0;
    for (size_t i = 0; i < tie->n_points; i++)
        for (int k = 0; k < 4 && tie->point[i].node[0] >= 0; k++)
            if (tie->point[i].share[k] != 0.0)
                entry[n++] = (tie_entry){i, tie->point[i].node[k], tie->point[i].share[k]};
    return n;
}

static void take_blocks_of_entries(const network_term *term, const palp_network *net, bool far,
                                   network_block_taker take, void *user) {
    const tie_term *t = (const tie_term *)term;
    tie_shape shape;
    tie_entry entry[ENTRIES];
    for (size_t i = 0; i < t->n; i++) {
        if (!is_tie_at_work(t, net, i, &shape))
            continue;
        const size_t n = list_entries_of_tie(&t->tie[i], entry);
        for (size_t a = 0; a < n; a++)
            for (size_t b = 0; b <= a; b++) {
                double k[9], both[9];
                const bool same = entry[a].node == entry[b].node, twice = same && a != b;
                if (same == far)
                    continue;
                block_of_points(&t->tie[i], &shape, entry[a].point, entry[b].point, k);
                for (int e = 0; e < 9; e++)
                    both[e] =
                        entry[a].share * entry[b].share * (k[e] + (twice ? k[3 * (e % 3) + e / 3] : 0.0));
                take(user, entry[a].node, entry[b].node, both);
            }
    }
}

static void take_tie_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                            void *user) {
    take_blocks_of_entries(term, net, false, take, user);
}

static void take_far_tie_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                                void *user) {
    take_blocks_of_entries(term, net, true, take, user);
}

static void multiply_tie_tangent(const network_term *term, const palp_network *net, const double *u,
                                 double *out) {
    const tie_term *t = (const tie_term *)term;
    tie_shape shape;
    for (size_t i = 0; i < t->n; i++) {
        const palp_tie *tie = &t->tie[i];
        if (!is_tie_at_work(t, net, i, &shape))
            continue;
        for (size_t a = 0; a < tie->n_points; a++)
            for (size_t b = 0; b < tie->n_points; b++) {
                double k[9], at[3], pull[3];
                take_at_point(&tie->point[b], u, at);
                block_of_points(tie, &shape, a, b, k);
                for (int r = 0; r < 3; r++)
                    pull[r] = dot3(k + 3 * r, at);
                add_at_point(&tie->point[a], 1.0, pull, out);
            }
    }
}

static bool add_tie_energy(const network_term *term, const palp_network *net, double *energy) {
    const tie_term *t = (const tie_term *)term;
    tie_shape shape;
    for (size_t i = 0; i < t->n; i++)
        if (is_tie_at_work(t, net, i, &shape))
            *energy += 0.5 * shape.force * shape.force / t->tie[i].stiffness_N_m;
    return true;
}

/* A thread from outside holds the tissue as a hand does. */
static void mark_tied_nodes(const network_term *term, unsigned char *fixed) {
    const tie_term *t = (const tie_term *)term;
    for (size_t i = 0; i < t->n; i++) {
        bool outside = false;
        tie_entry entry[ENTRIES];
        for (size_t k = 0; k < t->tie[i].n_points; k++)
            outside = outside || t->tie[i].point[k].node[0] < 0;
        const size_t n = outside && !t->now[i].torn ? list_entries_of_tie(&t->tie[i], entry) : 0;
        for (size_t k = 0; k < n; k++)
            fixed[entry[k].node] = 1;
    }
}

static const network_term_kind TIE = {.reset = reset_ties,
                                      .pass = pass_tie_state,
                                      .swap = swap_tie_states,
                                      .begin = begin_tie_step,
                                      .evaluate = evaluate_tie_forces,
                                      .finish = finish_tie_step,
                                      .blocks = take_tie_blocks,
                                      .far_blocks = take_far_tie_blocks,
                                      .times = multiply_tie_tangent,
                                      .energy = add_tie_energy,
                                      .way = longest_way_of_ties,
                                      .place = place_points_of_ties,
                                      .grasped = mark_tied_nodes};

/* ---- the public calls ---------------------------------------------------------------------------- */

static tie_term *find_tie_term(const palp_network *net) {
    return net ? (tie_term *)network_find_term(net, &TIE) : NULL;
}

palp_status palp_network_enable_ties(palp_network *net, size_t max_ties) {
    if (!net || find_tie_term(net) || max_ties > INT32_MAX / (PAIRS * PALP_TIE_POINTS))
        return PALP_ERR_ARGUMENT;
    tie_term *t = network_term_new(&TIE, sizeof *t);
    if (t) {
        arena *memory = &t->term.memory;
        t->max = max_ties;
        t->tie = arena_take(memory, max_ties, sizeof *t->tie);
        t->was = arena_take(memory, 3 * max_ties * PALP_TIE_POINTS, sizeof *t->was);
        t->place = arena_take(memory, 3 * max_ties * PALP_TIE_POINTS, sizeof *t->place);
        t->was_length = arena_take(memory, max_ties, sizeof *t->was_length);
        t->length = arena_take(memory, max_ties, sizeof *t->length);
        t->now = arena_take(memory, max_ties, sizeof *t->now);
        t->next = arena_take(memory, max_ties, sizeof *t->next);
    }
    network_term *terms[] = {t ? &t->term : NULL};
    palp_status status = network_make_far_room(net, PAIRS * max_ties);
    if (status) {
        network_term_free(terms[0]);
        return status;
    }
    status = network_add_terms(net, 1, terms);
    if (!status)
        palp_network_reset(net);
    return status;
}

static bool is_point_valid(const palp_network *net, const palp_tie_point *p) {
    double sum = 0.0;
    if (p->node[0] < 0)
        return p->node[0] == -1 && finite3(p->place_m);
    for (int k = 0; k < 4; k++) {
        if (!isfinite(p->share[k]) ||
            (p->share[k] != 0.0 && (p->node[k] < 0 || (size_t)p->node[k] >= net->n_nodes)))
            return false;
        sum += p->share[k];
    }
    return fabs(sum - 1.0) < 1e-6;
}

static bool is_tie_valid(const palp_network *net, const palp_tie *tie) {
    if (tie->n_points < 2 || tie->n_points > PALP_TIE_POINTS || !(tie->length_m >= 0.0) ||
        !isfinite(tie->length_m) || !positive(tie->stiffness_N_m) || !(tie->strength_N > 0.0))
        return false;
    for (size_t i = 0; i < tie->n_points; i++)
        if (!is_point_valid(net, &tie->point[i]))
            return false;
    return true;
}

palp_status palp_network_set_ties(palp_network *net, size_t n, const palp_tie *ties) {
    tie_term *t = find_tie_term(net);
    size_t pairs = 0;
    if (!t || n > t->max || (n > 0 && !ties))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        tie_entry entry[ENTRIES];
        if (!is_tie_valid(net, &ties[i]))
            return PALP_ERR_ARGUMENT;
        const size_t entries = list_entries_of_tie(&ties[i], entry);
        pairs += entries * (entries > 0 ? entries - 1 : 0) / 2;
    }
    if (pairs > PAIRS * t->max)
        return PALP_ERR_LIMIT;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < PALP_TIE_POINTS; k++)
            if (!was_point_outside(t, i, k))
                memcpy(t->was + 3 * (i * PALP_TIE_POINTS + k), ties[i].point[k].place_m, 3 * sizeof *t->was);
        t->tie[i] = ties[i];
        if (i < t->n)
            continue;
        t->now[i] = (palp_tie_state){.torn = false};
        t->was_length[i] = ties[i].length_m;
    }
    t->n = n;
    net->trial = false;
    NETWORK_EACH_TERM(net, grasp_changed, net);
    return PALP_OK;
}

palp_status palp_network_ties(const palp_network *net, palp_tie_state *state) {
    const tie_term *t = find_tie_term(net);
    if (!t || !state)
        return PALP_ERR_ARGUMENT;
    memcpy(state, t->now, t->n * sizeof *state);
    return PALP_OK;
}

palp_status palp_network_tie_length(const palp_network *net, const palp_tie *tie, double *length_m) {
    double place[3 * PALP_TIE_POINTS];
    tie_shape shape;
    if (!find_tie_term(net) || !tie || !length_m || !is_tie_valid(net, tie))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < tie->n_points; i++)
        memcpy(place + 3 * i, tie->point[i].place_m, 3 * sizeof *place);
    shape_of_tie(tie, tie->length_m, place, net->now.x, &shape);
    *length_m = shape.length;
    return PALP_OK;
}

/* ---- points of a mesh ---------------------------------------------------------------------------- */

/* Barycentric coordinates in a tetrahedron; their least. */
static double place_in_tetrahedron(const double *x, const int32_t *t, const double place[3],
                                   double share[4]) {
    double side[3][3], away[3], normal[3], least = INFINITY;
    for (int k = 0; k < 3; k++)
        along3(x + 3 * t[k + 1], -1.0, x + 3 * t[0], side[k]);
    along3(place, -1.0, x + 3 * t[0], away);
    cross3(side[1], side[2], normal);
    const double volume = dot3(side[0], normal);
    share[0] = 1.0;
    for (int k = 0; k < 3; k++) {
        cross3(side[(k + 1) % 3], side[(k + 2) % 3], normal);
        share[k + 1] = dot3(away, normal) / volume;
        share[0] -= share[k + 1];
    }
    for (int k = 0; k < 4; k++)
        least = fmin(least, share[k]);
    return least;
}

static void nearest_point_of_surface(const palp_mesh *mesh, const double place[3], palp_tie_point *point) {
    const double *x = palp_mesh_positions(mesh);
    const int32_t *triangle = palp_mesh_triangles(mesh);
    double least = INFINITY;
    for (size_t i = 0; i < palp_mesh_triangle_count(mesh); i++, triangle += 3) {
        double share[3];
        const double distance = contact_nearest_distance(x, triangle, place, share);
        if (!(distance < least))
            continue;
        least = distance;
        *point = (palp_tie_point){.node = {triangle[0], triangle[1], triangle[2], -1},
                                  .share = {share[0], share[1], share[2], 0.0}};
    }
}

static void nearest_node_of_mesh(const palp_mesh *mesh, const double place[3], palp_tie_point *point) {
    const double *x = palp_mesh_positions(mesh);
    double least = INFINITY;
    for (size_t i = 0; i < palp_mesh_node_count(mesh); i++) {
        double away[3];
        along3(place, -1.0, x + 3 * i, away);
        if (dot3(away, away) < least) {
            least = dot3(away, away);
            *point = (palp_tie_point){.node = {(int32_t)i, -1, -1, -1}, .share = {1.0}};
        }
    }
}

palp_status palp_tie_point_at(const palp_mesh *mesh, const double place_m[3], palp_tie_point *point) {
    if (!mesh || !place_m || !point || !finite3(place_m))
        return PALP_ERR_ARGUMENT;
    const size_t n = palp_mesh_tetrahedron_count(mesh);
    const int32_t *t = palp_mesh_tetrahedra(mesh);
    if (n == 0) {
        nearest_node_of_mesh(mesh, place_m, point);
        return PALP_OK;
    }
    for (size_t i = 0; i < n; i++, t += 4) {
        palp_tie_point inside = {.node = {t[0], t[1], t[2], t[3]}};
        if (place_in_tetrahedron(palp_mesh_positions(mesh), t, place_m, inside.share) >= 0.0) {
            *point = inside;
            return PALP_OK;
        }
    }
    nearest_point_of_surface(mesh, place_m, point);
    return PALP_OK;
}
