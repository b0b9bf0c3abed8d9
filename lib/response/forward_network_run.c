/* forward_network_run.c: recordings of a network: every sample solved, or adaptive samples with
 * derivatives. */
#include "base/file.h"
#include "forward_internal.h"

#include <math.h>

palp_status palp_forward_network(const palp_model *model, const palp_network_settings *settings,
                                 const palp_forward_run *run, double *force_N, palp_error *error) {
    if (!model || !run || !force_N)
        return palp_error_null(error);
    forward_plan plan;
    forward_network *network;
    double shortest, whole;
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the model is lumped; use palp_forward_force");
    forward_times(run, &shortest, &whole);
    palp_status status = forward_plan_make(model, run->session_s, &plan, error);
    if (!status)
        status = forward_network_create(&plan, settings, shortest, whole, false, &network, error);
    if (status)
        return status;
    plan.contact = run->contact_m;
    status = forward_network_take_history(network, run->history);
    if (status)
        palp_error_set(error, status, "state of the specimen after earlier runs: %s",
                       palp_status_text(status));
    forward_specimen specimen = forward_network_specimen(network);
    if (!status)
        status = forward_run(&plan, &specimen, run, force_N, NULL, error);
    if (!status)
        status = forward_network_leave_history(network, run->history);
    forward_network_free(network);
    return status ? status : forward_add_free(model, run, 0, force_N, NULL);
}

palp_status forward_network_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                                  double *gradient, palp_error *error) {
    forward_plan plan;
    forward_network *network;
    double shortest, whole;
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the model is lumped; use palp_forward_force");
    if (model->density_kg_m3 > 0.0 || model->material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "a network with mass or of formulation sedef2008 has no derivatives");
    forward_times(run, &shortest, &whole);
    palp_status status = forward_plan_make(model, run->session_s, &plan, error);
    if (!status)
        status = forward_network_create(&plan, NULL, shortest, whole, true, &network, error);
    if (status)
        return status;
    plan.contact = run->contact_m;
    if (gradient)
        status = forward_network_add_slopes(network);
    if (!status) {
        status = forward_network_take_history(network, run->history);
        if (status)
            palp_error_set(error, status, "state of the specimen after earlier runs: %s",
                           palp_status_text(status));
    }
    if (!status)
        status = forward_run_adaptive(&plan, network, run, force_N, gradient, error);
    if (!status)
        status = forward_network_leave_history(network, run->history);
    forward_network_free(network);
    if (!status)
        status = forward_add_free(model, run, plan.n_columns, force_N, gradient);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
