/* explain_simulated.c: forces that another program computed along the runs' paths, and a lumped model fitted
 * to them. The model gives their change with the effects and with the path. */
#include "explain_data.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>

/* ---- the lumped model ---- */

/* The length in the first file that has it, m. */
static double first_length(size_t n, const palp_explain_input *inputs, const char *key, double otherwise) {
    for (size_t i = 0; i < n; i++)
        if (explain_number_of(inputs[i].experiment, key, 0.0) > 0.0)
            return 1e-3 * explain_number_of(inputs[i].experiment, key, 0.0);
    return otherwise;
}

static double deepest_of(size_t n, const palp_explain_input *inputs) {
    double deepest = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double *depth = palp_experiment_column(inputs[i].experiment, "depth_mm");
        for (size_t k = 0; depth && k < palp_experiment_rows(inputs[i].experiment); k++)
            deepest = fmax(deepest, 1e-3 * depth[k]);
    }
    return deepest;
}

palp_status explain_stand_in(size_t n, const palp_explain_input *inputs,
                             const palp_explain_settings *settings, palp_model *model, palp_error *error) {
    enum { ARMS = 4 }; /* their residual is added to each run */
    static const double TALL =
        4.0; /* of the largest depth, where no file has a height: strains up to a quarter */
    palp_explain_settings own = *settings;
    own.contact = PALP_CONTACT_KNOWN;
    own.progress = NULL;
    own.n_held_out = 0;
    own.simulated = NULL;
    palp_specimens_fit fit;
    palp_explain_input *simulated = malloc(n * sizeof *simulated);
    size_t count = 0;
    if (!simulated)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    for (size_t i = 0; i < n; i++)
        if (settings->simulated[i].experiment)
            simulated[count++] = settings->simulated[i];
    *model = (palp_model){
        .kind = PALP_MODEL_LUMPED,
        .height_m = first_length(n, inputs, "specimen.height_mm", TALL * deepest_of(count, simulated)),
        .radius_m = first_length(n, inputs, "specimen.radius_mm", 0.0)};
    const palp_explain_choice choice = {.most_arms = ARMS};
    palp_status status = count > 0
                             ? palp_explain_material(model, count, simulated, &own, &choice, &fit, error)
                             : palp_error_set(error, PALP_ERR_INPUT, "%s: no simulated run goes with it",
                                              inputs[0].name ? inputs[0].name : "run");
    if (!status) {
        palp_law *law = &model->material.law;
        model->material = fit.mean.material;
        palp_law_limit(law, law->strain[law->n - 1]); /* as deep as the simulated runs go */
        palp_specimens_fit_free(&fit);
    }
    free(simulated);
    return status;
}

/* ---- what it misses ---- */

/* A simulated run: missed is its force less the model's. */
typedef struct forces {
    size_t n;
    double *time, *depth, *missed; /* [n] s, m, N */
} forces;

static palp_status find_missed(const explain_data *data, const explain_run *run, const palp_experiment *e,
                               forces *f) {
    const double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
                 *force = palp_experiment_column(e, "force_N");
    f->n = palp_experiment_rows(e);
    f->time = malloc(3 * f->n * sizeof *f->time);
    if (!f->time)
        return PALP_ERR_NO_MEMORY;
    f->depth = f->time + f->n;
    f->missed = f->depth + f->n;
    for (size_t i = 0; i < f->n; i++) {
        f->time[i] = time[i] - time[0];
        f->depth[i] = 1e-3 * depth[i];
    }
    palp_model model = *data->given;
    const palp_forward_run path = {.n = f->n, .time_s = f->time, .depth_m = f->depth};
    palp_status status = explain_resize(&model, run);
    if (!status)
        status = explain_predict(&model, &path, f->missed, NULL, NULL);
    for (size_t i = 0; i < f->n && !status; i++)
        f->missed[i] = force[i] - f->missed[i];
    return status;
}

static const double PART = 0.01; /* of the range, over which a slope is taken */

/* The rms slope of the missed force by the depth, over parts of the range, N/m. */
static double slope_of_missed(const explain_data *data, const forces *f) {
    const double step = PART * data->deepest;
    double square = 0.0, way = 0.0;
    for (size_t i = 1, last = 0; i < f->n; i++) {
        const double moved = f->depth[i] - f->depth[last];
        if (fabs(moved) < step && i + 1 < f->n)
            continue;
        square += pow(f->missed[i] - f->missed[last], 2.0);
        way += moved * moved;
        last = i;
    }
    return way > 0.0 ? sqrt(square / way) : 0.0;
}

/* The missed force at the run's times, into run->added. Paths may differ as long as the error changes the log
 * evidence by at most nats: half of its square over the noise's. */
static palp_status add_missed(const explain_data *data, explain_run *run, const forces *f, const char *name,
                              double nats, palp_error *error) {
    const double slope = slope_of_missed(data, f), last = run->time[run->n - 1],
                 known = (1.0 + PART) * data->given->material.law.strain_max * run->height;
    double apart = 0.0, at = 0.0, square = 0.0;
    if (f->time[f->n - 1] < last - data->step)
        return palp_error_set(error, PALP_ERR_INPUT, "%s: ends after %.4g s, but %s after %.4g s", name,
                              f->time[f->n - 1], run->name, last);
    for (size_t i = 0, k = 0; i < run->n; i++) {
        while (k + 2 < f->n && f->time[k + 1] <= run->time[i])
            k++;
        const double share = fmin(1.0, (run->time[i] - f->time[k]) / (f->time[k + 1] - f->time[k])),
                     depth = f->depth[k] + share * (f->depth[k + 1] - f->depth[k]),
                     off = fabs(run->depth[i] - depth);
        run->added[i] = f->missed[k] + share * (f->missed[k + 1] - f->missed[k]);
        if (run->depth[i] > known)
            return palp_error_set(error, PALP_ERR_INPUT,
                                  "%s: goes to %.4g mm, but no simulated run beyond %.4g mm", run->name,
                                  1e3 * run->depth[i], 1e3 * known / (1.0 + PART));
        if (run->depth[i] <= 0.0 && depth <= 0.0)
            continue;
        square += slope * off * slope * off;
        at = off > apart ? run->time[i] : at;
        apart = fmax(apart, off);
    }
    if (0.5 * square > nats * run->white * run->white)
        return palp_error_set(
            error, PALP_ERR_INPUT,
            "%s: its path differs from that of %s by up to %.3g mm, %.4g s after the start; "
            "simulate the recorded path",
            name, run->name, 1e3 * apart, at);
    return PALP_OK;
}

static palp_status take_forces(const explain_data *data, explain_run *run, const palp_explain_input *from,
                               double nats, double *square, palp_error *error) {
    const char *name = from->name ? from->name : "a simulated run";
    forces f = {.n = 0};
    run->added = malloc(run->n * sizeof *run->added);
    palp_status status = run->added ? find_missed(data, run, from->experiment, &f) : PALP_ERR_NO_MEMORY;
    if (status)
        palp_error_set(error, status, "%s: %s", name, palp_status_text(status));
    else
        status = add_missed(data, run, &f, name, nats, error);
    for (size_t i = 0; i < run->n && !status; i++)
        *square += run->added[i] * run->added[i];
    free(f.time);
    return status;
}

static bool presses(const explain_run *run) {
    for (size_t i = 0; i < run->n; i++)
        if (run->depth[i] > 0.0)
            return true;
    return false;
}

palp_status explain_take_simulated(explain_data *data, const palp_explain_input *simulated, double nats,
                                   palp_error *error) {
    double square = 0.0, count = 0.0;
    palp_status status = PALP_OK;
    for (size_t r = 0; r < data->n_runs && simulated && !status; r++) {
        explain_run *run = &data->run[r];
        const palp_explain_input *from = &simulated[run->input];
        size_t k = 0;
        while (data->joined.first[k] != run->input)
            k++;
        if (!presses(run))
            continue;
        if (!from->experiment)
            return palp_error_set(error, PALP_ERR_INPUT, "%s: no simulated run goes with it", run->name);
        if (data->joined.made[k])
            return palp_error_set(
                error, PALP_ERR_UNSUPPORTED,
                "%s: continues in another file; simulated forces need a whole run in one file", run->name);
        status = take_forces(data, run, from, nats, &square, error);
        count += (double)run->n;
    }
    data->simulated_off = count > 0.0 ? sqrt(square / count) : 0.0;
    return status;
}
