/* body.c: the phantom and what touches it: where palpate's library is used. */
#include "poke.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SPEED = 0.15; /* of the sphere and the hand, m/s */
static const double TEAR_STRAIN = 0.8;
static const double LOST = 0.02;    /* residual over the elements' forces */
static const double OVERLAP = 0.05; /* of a sweep with the one before */
enum { CORRECTIONS = 12 };          /* at most, of a tick without a clock */

static double distance(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static palp_status open_network(body *b, const palp_model *model, palp_error *error) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0.0, 0.0, 0.0}};
    const palp_contact_settings contact = palp_contact_settings_default();
    const palp_realtime_settings realtime = palp_realtime_settings_default();
    palp_network_settings settings = palp_network_settings_default();
    settings.branch = PALP_BRANCH_STABLE;
    palp_status status = palp_network_from_model(model, NULL, 1, &bottom, &settings, &b->net, error);
    if (status)
        return status;
    size_t n_nodes = palp_mesh_node_count(palp_network_mesh(b->net));
    status = palp_network_enable_tools(b->net, 1, n_nodes < POKE_GRASPED ? n_nodes : POKE_GRASPED, &contact);
    if (!status)
        status = palp_network_enable_cutting(b->net);
    if (!status)
        status = palp_realtime_create(b->net, &realtime, &b->realtime);
    if (status)
        return status;
    b->saved_size = palp_network_state_size(b->net);
    b->saved = malloc(b->saved_size);
    return b->saved ? PALP_OK : PALP_ERR_NO_MEMORY;
}

bool body_open(body *b, const char *path) {
    palp_model model;
    palp_mesh_source source;
    palp_error error = {PALP_OK, ""};
    memset(b, 0, sizeof *b);
    palp_status status = palp_model_read(path, &model, &source, &error);
    if (!status)
        status = open_network(b, &model, &error);
    if (status) {
        fprintf(stderr, "poke: %s\n", error.text[0] ? error.text : palp_status_text(status));
        body_close(b);
        return false;
    }
    b->n_regions = source.n_regions;
    for (size_t r = 0; r < source.n_regions; r++)
        memcpy(b->region[r], source.regions[r].name, sizeof b->region[r]);
    b->mesh = palp_network_mesh(b->net);
    palp_mesh_bounds(b->mesh, b->low, b->high);
    b->sphere =
        (palp_tool){.shape = PALP_TOOL_SPHERE, .radius_m = 0.14 * (b->high[1] - b->low[1]), .friction = 0.3};
    return true;
}

void body_close(body *b) {
    palp_realtime_free(b->realtime);
    palp_network_free(b->net);
    free(b->saved);
    b->realtime = NULL;
    b->net = NULL;
    b->saved = NULL;
}

void body_reset(body *b) {
    body_release(b);
    b->sphere_on = b->blade_on = false;
    b->n_cut = b->n_torn = b->failed = 0;
    palp_realtime_reset(b->realtime);
}

/* ---- ticks --------------------------------------------------------------------------------------- */

/* Towards the goal, so as to be there after so many ticks if SPEED allows. */
static void move_sphere(body *b, double dt, int ticks) {
    double away = distance(b->sphere_goal, b->sphere.position_m), step = away / ticks;
    double share = step > SPEED * dt ? SPEED * dt / away : 1.0 / ticks;
    for (int k = 0; k < 3; k++)
        b->sphere.position_m[k] += share * (b->sphere_goal[k] - b->sphere.position_m[k]);
    palp_network_set_tools(b->net, b->sphere_on ? 1 : 0, &b->sphere);
}

static void move_hand(body *b, double dt, int ticks) {
    double target[3 * POKE_GRASPED], away = distance(b->hand_goal, b->hand), step = away / ticks;
    double share = step > SPEED * dt ? SPEED * dt / away : 1.0 / ticks;
    for (int k = 0; k < 3; k++)
        b->hand[k] += share * (b->hand_goal[k] - b->hand[k]);
    for (size_t i = 0; i < 3 * b->n_grasped; i++)
        target[i] = b->grasped_from[i] + b->hand[i % 3];
    palp_network_grasp(b->net, b->n_grasped, b->grasped, target);
}

/* The region with the largest share of the force that is normal to the sphere, or -1 outside all regions. */
static int touched_region(const body *b) {
    enum { ROOM = 256 };
    palp_contact contact[ROOM];
    double share[PALP_REGIONS_MAX + 1] = {0.0};
    size_t n = 0;
    int most = -1;
    palp_network_contacts(b->net, ROOM, contact, &n);
    for (size_t i = 0; i < n && i < ROOM; i++)
        share[contact[i].region + 1] += contact[i].normal_N;
    for (int r = 0; r < (int)b->n_regions; r++)
        most = share[r + 1] > share[most + 1] ? r : most;
    return most;
}

static void feel(body *b) {
    palp_tool_force felt = {{0.0}, {0.0}, 0, 0.0};
    memset(b->force_N, 0, sizeof b->force_N);
    b->touched = b->sphere_on ? touched_region(b) : -1;
    if (b->n_grasped > 0) {
        palp_network_grasp_force(b->net, b->n_grasped, b->grasped, b->force_N);
    } else if (b->sphere_on) {
        palp_network_tool_force(b->net, &felt);
        memcpy(b->force_N, felt.force_N, sizeof b->force_N);
    }
}

/* A tick that comes out badly, as where the phantom snaps through, is taken back and solved to the end; where
 * even that finds nothing, the phantom stays as it was. */
static void tick(body *b, double dt, const palp_budget *budget) {
    palp_network_save(b->net, b->saved, b->saved_size);
    palp_status status = palp_realtime_step(b->realtime, 0.0, dt, budget, &b->tick);
    if (!status && b->tick.residual <= LOST)
        return;
    if (!status)
        palp_network_restore(b->net, b->saved, b->saved_size);
    b->failed += palp_network_step(b->net, 0.0, dt, NULL) != PALP_OK;
}

void body_step(body *b, double seconds, bool within) {
    const double dt = seconds / POKE_TICKS, zero[3] = {0.0};
    const palp_budget budget = {
        .seconds = within ? 0.7 * dt : 0.0, .corrections = within ? 0 : CORRECTIONS, .force_error = 1e-3};
    palp_network_set_tearing(b->net, b->tearing ? TEAR_STRAIN : 0.0, 0.0);
    for (int i = 0; i < POKE_TICKS; i++) {
        size_t torn = 0;
        move_sphere(b, dt, POKE_TICKS - i);
        move_hand(b, dt, POKE_TICKS - i);
        tick(b, dt, &budget);
        b->tick_seconds[b->n_ticks++ % POKE_TIMES] = b->tick.seconds;
        palp_network_tear(b->net, &torn);
        b->n_torn += torn;
    }
    feel(b);
    b->time += seconds;
    b->curve_N[b->curve_end++ % POKE_CURVE] = distance(b->force_N, zero);
}

static int smaller_first(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The drawing shares the processors: it makes single ticks several times as long, and the median hardly
 * longer. */
double body_tick_median(const body *b) {
    double sorted[POKE_TIMES];
    size_t n = b->n_ticks < POKE_TIMES ? b->n_ticks : POKE_TIMES;
    memcpy(sorted, b->tick_seconds, n * sizeof *sorted);
    qsort(sorted, n, sizeof *sorted, smaller_first);
    return n > 0 ? sorted[n / 2] : 0.0;
}

/* ---- hand and blade ------------------------------------------------------------------------------ */

void body_grasp(body *b, const double at[3], double radius) {
    const double *x = palp_network_positions(b->net);
    const int32_t *triangles;
    size_t n, n_nodes = palp_mesh_node_count(b->mesh), nearest = 0;
    unsigned char *surface = calloc(n_nodes, 1);
    body_release(b);
    if (!surface || palp_network_surface(b->net, &n, &triangles) || n == 0) {
        free(surface);
        return;
    }
    nearest = (size_t)triangles[0];
    for (size_t i = 0; i < 3 * n; i++) {
        surface[triangles[i]] = 1;
        if (distance(x + 3 * triangles[i], at) < distance(x + 3 * nearest, at))
            nearest = (size_t)triangles[i];
    }
    for (size_t i = 0; i < n_nodes && b->n_grasped < POKE_GRASPED; i++)
        if (i == nearest || (surface[i] && distance(x + 3 * i, at) <= radius)) {
            memcpy(b->grasped_from + 3 * b->n_grasped, x + 3 * i, 3 * sizeof *x);
            b->grasped[b->n_grasped++] = (int32_t)i;
        }
    memset(b->hand, 0, sizeof b->hand);
    memset(b->hand_goal, 0, sizeof b->hand_goal);
    free(surface);
}

void body_release(body *b) {
    palp_network_release(b->net, b->n_grasped, b->grasped);
    b->n_grasped = 0;
}

void body_slice(body *b, const double edge[6]) {
    double old[6], first[9], second[9]; /* old ends a, b; new ends c, d: a b c and b d c */
    size_t n = 0;
    if (b->blade_on) {
        for (int k = 0; k < 6; k++) /* over the end of the last sweep: the phantom has moved a little since */
            old[k] = b->blade[k] - OVERLAP * (edge[k] - b->blade[k]);
        memcpy(first, old, 6 * sizeof *first);
        memcpy(first + 6, edge, 3 * sizeof *first);
        memcpy(second, old + 3, 3 * sizeof *second);
        memcpy(second + 3, edge + 3, 3 * sizeof *second);
        memcpy(second + 6, edge, 3 * sizeof *second);
        palp_network_cut(b->net, first, &n);
        b->n_cut += n;
        palp_network_cut(b->net, second, &n);
        b->n_cut += n;
    }
    memcpy(b->blade, edge, 6 * sizeof *edge);
    b->blade_on = true;
}

/* ---- where a ray meets it ------------------------------------------------------------------------ */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Moeller and Trumbore 1997; the distance along the ray, or INFINITY. */
static double meet(const double from[3], const double along[3], const double *a, const double *b,
                   const double *c) {
    double u[3], v[3], w[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = from[k] - a[k];
    }
    cross(along, v, p);
    cross(w, u, q);
    double det = dot(u, p), s = dot(w, p) / det, t = dot(along, q) / det, reach = dot(v, q) / det;
    return det != 0.0 && s >= 0.0 && t >= 0.0 && s + t <= 1.0 && reach > 0.0 ? reach : INFINITY;
}

bool body_hit(const body *b, const double from[3], const double along[3], double at[3]) {
    const double *x = palp_network_positions(b->net);
    const int32_t *t;
    size_t n;
    double nearest = INFINITY;
    palp_network_surface(b->net, &n, &t);
    for (size_t i = 0; i < n; i++, t += 3)
        nearest = fmin(nearest, meet(from, along, x + 3 * t[0], x + 3 * t[1], x + 3 * t[2]));
    for (int k = 0; k < 3 && isfinite(nearest); k++)
        at[k] = from[k] + nearest * along[k];
    return isfinite(nearest);
}
