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
    double *weight; /* [n_elements] scratch */
};

static palp_status attempt(void *self, const forward_move *move, double *force, double *slope) {
    forward_network *p = self;
    palp_step_info info = {0};
    double decades, height = p->net->height;
    p->net->boost = forward_boost(p->plan, move->rate, &decades);
    palp_status status = palp_network_try(p->net, move->strain * height, move->dt, &info);
    *force = info.force_N;
    if (status || !slope)
        return status;
    status = network_weights(p->net, p->weight, slope);
    *slope *= height;
    return status;
}

static void commit(void *self, const double *strain_p, const double *dt_p, double *force_p) {
    forward_network *p = self;
    (void)strain_p, (void)dt_p, (void)force_p;
    palp_network_commit(p->net);
}

/* The relaxation modulus of an effect as arms of the elements, as many as there is room for, over the times
 * that the steps can tell. */
static palp_status add_spectrum(forward_plan *plan, palp_effect_id id, size_t room, double shortest,
                                double whole, palp_error *error) {
    const double *value = plan->value[id];
    effect_mode mode[EFFECT_MODES_MAX];
    if (!value || value[0] == 0.0 || whole == 0.0)
        return PALP_OK;
    if (room < EFFECT_MODES_MIN)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%s: the network's arms leave no room for it (%d in all)",
                              palp_effect_look_up(id)->id, PALP_ARMS_MAX);
    const effect_range range = {room, 0.1 / whole, 5.0 / shortest};
    effect_row_of(id)->spectrum(value, &range, mode);
    for (size_t i = 0; i < room; i++)
        plan->material.arms[plan->material.n_arms++] =
            (palp_arm){.stiffness_N = mode[i].weight, .viscosity_Ns = mode[i].weight / mode[i].rate};
    return PALP_OK;
}

static palp_status add_spectra(forward_plan *plan, double shortest, double whole, palp_error *error) {
    const palp_effect_id first = PALP_EFFECT_POWER_LAW_RELAXATION, second = PALP_EFFECT_POROELASTIC;
    size_t room = PALP_ARMS_MAX - plan->material.n_arms;
    bool both = plan->value[first] && plan->value[second];
    palp_status status = add_spectrum(plan, first, both ? room / 2 : room, shortest, whole, error);
    return status ? status : add_spectrum(plan, second, both ? room / 2 : room, shortest, whole, error);
}

/* A network's plates hold its nodes; with slip they are held by springs instead, slip 1 by next to none. */
static palp_status set_slip(const forward_plan *plan, palp_network *net) {
    const double *slip = plan->value[PALP_EFFECT_PLATE_SLIP];
    if (!slip || slip[0] == 0.0)
        return PALP_OK;
    double share = fmax((1.0 - slip[0]) / slip[0], 1e-6);
    palp_status status = network_set_grip(net, "bottom", share);
    return status ? status : network_set_grip(net, "top", share);
}

static palp_status make_network(const forward_plan *plan, const palp_network_settings *settings,
                                palp_network **net, palp_error *error) {
    const double *slip = plan->value[PALP_EFFECT_PLATE_SLIP];
    palp_network_settings own = settings ? *settings : palp_network_settings_default();
    palp_support supports[2];
    palp_mesh *mesh;
    palp_status status = palp_model_mesh(plan->model, &mesh, error);
    if (status)
        return status;
    own.density_kg_m3 = plan->model->density_kg_m3;
    palp_supports_default(supports);
    for (size_t i = 0; i < 2 && slip && slip[0] > 0.0; i++)
        supports[i].axis[0] = supports[i].axis[2] = PALP_FREE;
    status = palp_network_create(mesh, &plan->material, 2, supports, &own, net, error);
    palp_mesh_free(mesh);
    return status;
}

static palp_status equip(forward_network *f, palp_error *error) {
    const forward_plan *plan = f->plan;
    f->weight = malloc((palp_mesh_element_count(f->net->mesh) + 1) * sizeof *f->weight);
    palp_status status = f->weight ? set_slip(plan, f->net) : PALP_ERR_NO_MEMORY;
    f->wear = plan->wear;
    f->wear.slack = 1e-3;
    if (!status && plan->worn)
        status = network_set_wear(f->net, &f->wear);
    return status ? palp_error_set(error, status, "%s", palp_status_text(status)) : PALP_OK;
}

palp_status forward_network_create(forward_plan *plan, const palp_network_settings *settings, double shortest,
                                   double whole, forward_network **network, palp_error *error) {
    forward_network *f = calloc(1, sizeof *f);
    if (!f)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    f->plan = plan;
    palp_status status = add_spectra(plan, shortest, whole, error);
    if (!status)
        status = make_network(plan, settings, &f->net, error);
    if (!status)
        status = equip(f, error);
    if (status)
        forward_network_free(f);
    else
        *network = f;
    return status;
}

void forward_network_free(forward_network *f) {
    if (!f)
        return;
    palp_network_free(f->net);
    free(f->weight);
    free(f);
}

forward_specimen forward_network_specimen(forward_network *f) {
    double shortest = forward_shortest_arm(f->plan);
    return (forward_specimen){.self = f,
                              .attempt = attempt,
                              .commit = commit,
                              .height = f->net->height,
                              .shortest = isinf(shortest) ? 0.0 : shortest};
}

palp_status palp_forward_network(const palp_model *model, const palp_network_settings *settings,
                                 const palp_forward_run *run, double *force_N, palp_error *error) {
    forward_plan plan;
    forward_network *network;
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a lumped model is run by palp_forward_force");
    double shortest = INFINITY, whole = run->n ? run->time_s[run->n - 1] - run->time_s[0] : 0.0;
    for (size_t i = 1; i < run->n; i++)
        shortest = fmin(shortest, run->time_s[i] - run->time_s[i - 1]);
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
