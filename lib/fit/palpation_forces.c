/* palpation_forces.c: the presses of a network with a region in it, and their derivatives.
 */
#include "palpation_internal.h"

#include "base/file.h"
#include "calibrate_internal.h"
#include "contact/contact_internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char palpation_region[] = "palpation.region";

static const double SOFT = 0.15;      /* half width of the region's edge, in mean edges of the mesh */
static const double SHIFT = 0.02;     /* of a parameter for its derivative, in mean edges */
static const double LOST = 10.0;      /* residual of a region with which the network has no equilibrium */
static const double TOLERANCE = 1e-6; /* of an equilibrium; that of its energy is the square of it */

/* ---- the region ----------------------------------------------------------------------------------- */

/* A region of some kind: a ball, or a layer whose upper end is at middle[1]. In m. */
typedef struct hidden {
    double middle[3], size, edge;
} hidden;

static double part_in_ball(void *user, const double x[3]) {
    const hidden *h = user;
    const double dx = x[0] - h->middle[0], dy = x[1] - h->middle[1], dz = x[2] - h->middle[2],
                 far = sqrt(dx * dx + dy * dy + dz * dz);
    return fmin(fmax(0.5 + 0.5 * (h->size - far) / h->edge, 0.0), 1.0);
}

static double part_in_layer(void *user, const double x[3]) {
    const hidden *h = user;
    return fmin(fmax(0.5 + 0.5 * (h->size - (h->middle[1] - x[1])) / h->edge, 0.0), 1.0);
}

const palpation_kind palpation_ball = {4, part_in_ball}, palpation_layer = {1, part_in_layer};

palp_status palpation_place(palpation_search *s, const double *p) {
    const size_t last = s->kind->n - 1;
    hidden h = {{0.0, s->high[1], 0.0}, exp(p[last]) * s->edge, SOFT * s->edge};
    for (size_t k = 0; k < last; k++)
        h.middle[k] = p[k] * s->edge;
    return palp_mesh_add_region(s->mesh, palpation_region, s->kind->part, &h);
}

/* The network with the region as it was placed; it is made at the first call. */
static palp_status use_network(palpation_search *s, palp_error *error) {
    const size_t of = s->source->n_regions - 1;
    const double *part;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_supports_default(supports);
    settings.tolerance = TOLERANCE;
    palp_status status = PALP_OK;
    if (!s->net) {
        status = palp_network_from_model(&s->model, s->mesh, 1, supports, &settings, &s->net, error);
        if (!status)
            status = palp_network_enable_tools(s->net, 1, 0, &s->settings->contact);
    }
    if (!status)
        status = palp_mesh_region(s->mesh, palpation_region, &part);
    return status ? status : network_change_region(s->net, of, part, exp(s->log_stiffness));
}

/* ---- presses -------------------------------------------------------------------------------------- */

static double *place_of_nodes(const palpation_search *s, size_t press, size_t level) {
    return s->x + 3 * s->n_nodes * (PALPATION_LEVELS * press + level);
}

/* The network with its nodes at x and the tool at this level. */
static palp_status place_level(const palpation_search *s, const palp_palpation_press *press, size_t level,
                               const double *x) {
    palp_tool tool = press->tool;
    tool.friction = 0.0;
    tool.position_m[1] -= press->depth_m * (level == 0 ? 0.5 : 1.0);
    palp_network_reset(s->net);
    memcpy(s->net->now.x, x, 3 * s->n_nodes * sizeof *x);
    return palp_network_set_tools(s->net, 1, &tool);
}

/* The equilibrium of a press at this level, from the nodes at x, which become those found; its energy. */
static palp_status solve_level(const palpation_search *s, const palp_palpation_press *press, size_t level,
                               double *x, double *energy) {
    palp_status status = place_level(s, press, level, x);
    if (!status)
        status = palp_network_try(s->net, 0.0, INFINITY, NULL);
    if (!status && !network_energy(s->net, energy))
        status = PALP_ERR_UNSUPPORTED;
    if (!status)
        memcpy(x, s->net->next.x, 3 * s->n_nodes * sizeof *x);
    return status;
}

/* Its energy with the nodes held at x. */
static palp_status hold_level(const palpation_search *s, const palp_palpation_press *press, size_t level,
                              const double *x, double *energy) {
    palp_status status = place_level(s, press, level, x);
    if (!status)
        status = network_begin(s->net, 0.0, INFINITY);
    if (status)
        return status;
    memcpy(s->net->next.x, x, 3 * s->n_nodes * sizeof *x);
    return network_evaluate(s->net) && network_energy(s->net, energy) ? PALP_OK : PALP_ERR_UNSUPPORTED;
}

static double force_of_energies(const palp_palpation_press *press, const double energy[PALPATION_LEVELS]) {
    return (energy[1] - energy[0]) / (0.5 * press->depth_m);
}

/* Mean force over the deeper half by the energies at its ends. */
static palp_status solve_press(const palpation_search *s, size_t i) {
    const size_t size = 3 * s->n_nodes * sizeof(double);
    double energy[PALPATION_LEVELS],
        *x[PALPATION_LEVELS] = {place_of_nodes(s, i, 0), place_of_nodes(s, i, 1)};
    if (!s->solved)
        memcpy(x[0], s->net->rest, size);
    palp_status status = solve_level(s, &s->press[i], 0, x[0], &energy[0]);
    if (!s->solved)
        memcpy(x[1], x[0], size);
    if (!status)
        status = solve_level(s, &s->press[i], 1, x[1], &energy[1]);
    s->work[i] = status ? 0.0 : force_of_energies(&s->press[i], energy);
    return status || s->work[i] > 0.0 ? status : PALP_ERR_NOT_CONVERGED;
}

palp_status palpation_solve(palpation_search *s, palp_error *error) {
    palp_status status = use_network(s, error);
    for (size_t i = 0; i < s->n && !status; i++)
        status = solve_press(s, i);
    s->solved = !status;
    s->done += 1.0;
    if (!status && s->settings->progress &&
        s->settings->progress(s->settings->user, fmin(1.0, s->done / s->planned)))
        status = PALP_ERR_STOPPED;
    return status;
}

palp_status palpation_hold(palpation_search *s, double *work) {
    palp_status status = use_network(s, NULL);
    for (size_t i = 0; i < s->n && !status; i++) {
        double energy[PALPATION_LEVELS];
        for (size_t level = 0; level < PALPATION_LEVELS && !status; level++)
            status = hold_level(s, &s->press[i], level, place_of_nodes(s, i, level), &energy[level]);
        work[i] = status ? 0.0 : force_of_energies(&s->press[i], energy);
    }
    return status;
}

/* slope[n]: derivative of the logarithms of force by a parameter, the last one that of the stiffness. */
static palp_status slope_by_parameter(palpation_search *s, const double *p, size_t k, double *slope) {
    double next[PALPATION_PLACE];
    const double own = s->log_stiffness;
    memcpy(next, p, s->kind->n * sizeof *next);
    if (k < s->kind->n)
        next[k] += SHIFT;
    else
        s->log_stiffness += SHIFT;
    palp_status status = palpation_place(s, next);
    if (!status)
        status = palpation_hold(s, s->moved);
    s->log_stiffness = own;
    for (size_t i = 0; i < s->n && !status; i++)
        slope[i] = (s->moved[i] - s->elastic[i]) / SHIFT / s->work[i];
    return status;
}

palp_status palpation_slopes(palpation_search *s, const double *p, size_t parameters, double *slope) {
    palp_status status = palpation_hold(s, s->elastic);
    for (size_t k = 0; k < parameters && !status; k++)
        status = slope_by_parameter(s, p, k, slope + k * s->n);
    return status;
}

bool palpation_lost(palp_status status) {
    return calibration_lost(status) || status == PALP_ERR_SINGULAR || status == PALP_ERR_INSIDE ||
           status == PALP_ERR_INPUT;
}

palp_status palpation_residuals(void *user, const double *p, double *r, double *jacobian) {
    palpation_search *s = user;
    palp_status status = palpation_place(s, p);
    if (!status)
        status = palpation_solve(s, NULL);
    if (palpation_lost(status)) {
        for (size_t i = 0; i < s->n; i++)
            r[i] = i % 2 == 0 ? LOST : -LOST;
        if (jacobian)
            memset(jacobian, 0, s->kind->n * s->n * sizeof *jacobian);
        return PALP_OK;
    }
    for (size_t i = 0; i < s->n && !status; i++)
        r[i] = log(s->work[i]) - s->wanted[i];
    if (status)
        return status;
    palpation_whiten(s, r);
    if (jacobian)
        status = palpation_slopes(s, p, s->kind->n, jacobian);
    for (size_t k = 0; k < s->kind->n && jacobian && !status; k++)
        palpation_whiten(s, jacobian + k * s->n);
    return status;
}

palp_status palpation_press_region(palpation_search *s, const double *p, double log_stiffness,
                                   palp_error *error) {
    s->log_stiffness = log_stiffness;
    s->solved = false;
    palp_status status = palpation_place(s, p);
    return status ? status : palpation_solve(s, error);
}

palp_status palpation_press_tissue(palpation_search *s, palp_error *error) {
    double p[PALPATION_PLACE] = {0.0};
    for (size_t k = 0; k + 1 < s->kind->n; k++)
        p[k] = 0.5 * (s->low[k] + s->high[k]) / s->edge;
    return palpation_press_region(s, p, 0.0, error);
}
