/* forward_network.c: the forward model of a network: its specimen, and what the effects make of its elements.
 */
#include "file.h"
#include "forward_internal.h"
#include "network_internal.h"

#include <math.h>
#include <stdlib.h>

struct forward_network {
    const forward_plan *plan;
    palp_network *net;
    element_wear wear;
    size_t n_spectra;
    forward_spectrum spectrum[2];
    bool sloped;    /* every trial's slope is asked for */
    bool found;     /* slopes of the trial */
    double decades; /* of its rate */
    double slope, committed; /* of the trial, of the state: d force / d surface strain */
    double *weight; /* [n_elements] of the trial */
    forward_slopes *slopes; /* NULL: no derivatives */
};

static palp_status attempt(void *self, const forward_move *move, double *force, double *slope) {
    forward_network *p = self;
    palp_step_info info = {0};
    double decades, height = p->net->height;
    p->net->boost = forward_boost(p->plan, move->rate, &decades);
    palp_status status = palp_network_try(p->net, move->strain * height, move->dt, &info);
    *force = info.force_N;
    if (status || (!slope && !p->sloped))
        return status;
    status = network_weights(p->net, p->weight, &p->slope);
    p->slope *= height;
    p->found = false;
    p->decades = decades;
    if (slope)
        *slope = p->slope;
    return status;
}

/* Once a trial: most are asked for their force only. */
static void find_slopes(forward_network *p) {
    if (!p->found)
        forward_slopes_find(p->slopes, p->weight, p->slope / p->net->height, p->decades);
    p->found = true;
}

static void hold(void *self, double *force_p, double *force_dt) {
    forward_network *p = self;
    find_slopes(p);
    forward_slopes_hold(p->slopes, force_p, force_dt);
}

static void commit(void *self, const double *strain_p, const double *dt_p, double *force_p) {
    forward_network *p = self;
    if (p->slopes) {
        find_slopes(p);
        forward_slopes_advance(p->slopes, strain_p, dt_p, force_p);
    }
    p->committed = p->slope;
    palp_network_commit(p->net);
}

void forward_network_keep(forward_network *p) {
    network_mark(p->net);
    if (p->slopes)
        forward_slopes_keep(p->slopes, false);
}

void forward_network_back(forward_network *p) {
    network_revert(p->net);
    if (p->slopes)
        forward_slopes_keep(p->slopes, true);
}

double forward_network_slope(const forward_network *p) {
    return p->committed;
}

/* The relaxation modulus of an effect as arms of the elements, as many as there is room for, over the times
 * that the steps can tell. */
static palp_status add_spectrum(forward_network *f, forward_plan *plan, palp_effect_id id, size_t room,
                                double shortest, double whole, palp_error *error) {
    const double *value = plan->value[id];
    if (!value || (value[0] == 0.0 && !f->sloped) || whole == 0.0)
        return PALP_OK;
    if (room < EFFECT_MODES_MIN)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%s: the network's arms leave no room for it (%d in all)",
                              palp_effect_look_up(id)->id, PALP_ARMS_MAX);
    const effect_range range = {room, 0.1 / whole, 5.0 / shortest};
    forward_spectrum *g = &f->spectrum[f->n_spectra++];
    *g = (forward_spectrum){.first = plan->material.n_arms, .n = room, .column = plan->column[id],
                            .n_values = effect_row_of(id)->info.n_parameters};
    effect_row_of(id)->spectrum(value, &range, g->mode);
    for (size_t i = 0; i < room; i++) {
        double weight = fmax(g->mode[i].weight, FORWARD_NO_STIFFNESS);
        plan->material.arms[plan->material.n_arms++] =
            (palp_arm){.stiffness_N = weight, .viscosity_Ns = weight / g->mode[i].rate};
    }
    return PALP_OK;
}

static palp_status add_spectra(forward_network *f, forward_plan *plan, double shortest, double whole,
                               palp_error *error) {
    const palp_effect_id first = PALP_EFFECT_POWER_LAW_RELAXATION, second = PALP_EFFECT_POROELASTIC;
    size_t room = PALP_ARMS_MAX - plan->material.n_arms;
    bool both = plan->value[first] && plan->value[second];
    palp_status status = add_spectrum(f, plan, first, both ? room / 2 : room, shortest, whole, error);
    return status ? status : add_spectrum(f, plan, second, both ? room / 2 : room, shortest, whole, error);
}

/* A slip of 0 has derivatives only as a limit. */
static bool slips(const forward_network *f) {
    const double *slip = f->plan->value[PALP_EFFECT_PLATE_SLIP];
    return slip && (slip[0] > 0.0 || f->sloped);
}

/* A network's plates hold its nodes; with slip they are held by springs instead, slip 1 by next to none. */
static palp_status set_slip(const forward_network *f) {
    const double *slip = f->plan->value[PALP_EFFECT_PLATE_SLIP];
    if (!slips(f))
        return PALP_OK;
    double at = fmax(slip[0], FORWARD_SLIP), share = fmax((1.0 - at) / at, FORWARD_SLIP);
    palp_status status = network_set_grip(f->net, "bottom", share);
    return status ? status : network_set_grip(f->net, "top", share);
}

static palp_status make_network(const forward_network *f, const palp_network_settings *settings,
                                palp_network **net, palp_error *error) {
    palp_model model = *f->plan->model;
    palp_support supports[2];
    model.material = f->plan->material;
    model.n_effects = 0; /* they are in the plan */
    palp_supports_default(supports);
    for (size_t i = 0; i < 2 && slips(f); i++)
        supports[i].axis[0] = supports[i].axis[2] = PALP_FREE;
    return palp_model_network(&model, NULL, 2, supports, settings, net, error);
}

static palp_status equip(forward_network *f, palp_error *error) {
    const forward_plan *plan = f->plan;
    f->weight = malloc((palp_mesh_element_count(f->net->mesh) + 1) * sizeof *f->weight);
    palp_status status = f->weight ? set_slip(f) : PALP_ERR_NO_MEMORY;
    f->wear = plan->wear;
    f->wear.slack = 1e-3;
    if (!status && plan->worn)
        status = network_set_wear(f->net, &f->wear);
    return status ? palp_error_set(error, status, "%s", palp_status_text(status)) : PALP_OK;
}

static palp_status create(forward_plan *plan, const palp_network_settings *settings, double shortest, double whole,
                          bool sloped, forward_network **network, palp_error *error) {
    forward_network *f = calloc(1, sizeof *f);
    if (!f)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    f->plan = plan;
    f->sloped = sloped;
    palp_status status = add_spectra(f, plan, shortest, whole, error);
    if (!status)
        status = make_network(f, settings, &f->net, error);
    if (!status)
        status = equip(f, error);
    if (status)
        forward_network_free(f);
    else
        *network = f;
    return status;
}

palp_status forward_network_create(forward_plan *plan, const palp_network_settings *settings, double shortest,
                                   double whole, forward_network **network, palp_error *error) {
    return create(plan, settings, shortest, whole, false, network, error);
}

void forward_network_free(forward_network *f) {
    if (!f)
        return;
    palp_network_free(f->net);
    forward_slopes_free(f->slopes);
    free(f->weight);
    free(f);
}

forward_specimen forward_network_specimen(forward_network *f) {
    double shortest = forward_shortest_arm(f->plan);
    return (forward_specimen){.self = f,
                              .attempt = attempt,
                              .hold = hold,
                              .commit = commit,
                              .height = f->net->height,
                              .shortest = isinf(shortest) ? 0.0 : shortest,
                              .n_columns = f->slopes ? f->plan->n_columns : 0};
}

static void times_of(const palp_forward_run *run, double *shortest, double *whole) {
    *shortest = INFINITY;
    *whole = run->n ? run->time_s[run->n - 1] - run->time_s[0] : 0.0;
    for (size_t i = 1; i < run->n; i++)
        *shortest = fmin(*shortest, run->time_s[i] - run->time_s[i - 1]);
}

palp_status palp_forward_network(const palp_model *model, const palp_network_settings *settings,
                                 const palp_forward_run *run, double *force_N, palp_error *error) {
    forward_plan plan;
    forward_network *network;
    double shortest, whole;
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a lumped model is run by palp_forward_force");
    times_of(run, &shortest, &whole);
    palp_status status = forward_plan_make(model, run->session_s, &plan, error);
    if (!status)
        status = forward_network_create(&plan, settings, shortest, whole, &network, error);
    if (status)
        return status;
    forward_specimen specimen = forward_network_specimen(network);
    status = forward_run(&plan, &specimen, run, force_N, NULL, error);
    forward_network_free(network);
    return status;
}

palp_status forward_network_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                                  double *gradient, palp_error *error) {
    forward_plan plan;
    forward_network *network;
    double shortest, whole;
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a lumped model is run by palp_forward_force");
    if (model->density_kg_m3 > 0.0 || model->material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "a network with mass or of formulation sedef2008 has no derivatives");
    times_of(run, &shortest, &whole);
    palp_status status = forward_plan_make(model, run->session_s, &plan, error);
    if (!status)
        status = create(&plan, NULL, shortest, whole, true, &network, error);
    if (status)
        return status;
    if (gradient)
        status = forward_slopes_create(&plan, network->net, network->n_spectra, network->spectrum, &network->slopes);
    if (!status)
        status = forward_run_knots(&plan, network, run, force_N, gradient, error);
    forward_network_free(network);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
