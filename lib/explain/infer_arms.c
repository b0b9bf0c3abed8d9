/* infer_arms.c: which of several arms is the added one. */
#include "infer_search.h"

#include <math.h>

/* Ratio of an arm's time to that of arm j of the given model, at least 1. */
static double distance_to_given(const infer_search *s, size_t j, double time) {
    const palp_arm *given = &s->data.given->material.arms[j];
    return fabs(log(time * given->stiffness_N / given->viscosity_Ns));
}

/* The given arm that comes nearest to its given time by an exchange with this added one; PALP_ARMS_MAX:
 * none. */
static size_t arm_to_exchange(const infer_search *s, const palp_effect *added) {
    const palp_material *now = &s->fit.c.model.material;
    size_t best = PALP_ARMS_MAX;
    double most = 0.0;
    for (size_t j = 0; j < now->n_arms && j < s->data.given->material.n_arms; j++) {
        const double nearer = distance_to_given(s, j, now->arms[j].viscosity_Ns / now->arms[j].stiffness_N) -
                              distance_to_given(s, j, added->value[1]);
        if (nearer > most) {
            most = nearer;
            best = j;
        }
    }
    return best;
}

/* Whether two fits have the same residual in all samples: an effect may act on one arm alone. */
static bool leave_the_same(const infer_fit *a, const infer_fit *b, const explain_data *data) {
    double most = 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const size_t n = data->run[r].n, last = at * a->m + (a->m - 1) * n;
        for (size_t i = 0; i < n; i++)
            most = fmax(most, fabs(a->raw[last + i] - b->raw[last + i]));
    }
    return most < 1e-6 * data->peak;
}

static palp_status exchange(infer_search *s, size_t effect, size_t arm, bool *done) {
    palp_model model = s->fit.c.model;
    palp_arm *given = &model.material.arms[arm];
    double *added = model.effects[effect].value;
    const palp_arm was = *given;
    infer_fit fit;
    *given = (palp_arm){.stiffness_N = added[0], .viscosity_Ns = added[0] * added[1]};
    added[0] = was.stiffness_N;
    added[1] = was.viscosity_Ns / was.stiffness_N;
    palp_status status = infer_fit_create(&model, &s->data, &s->fit, &fit);
    if (status)
        return status;
    status = infer_fit_evaluate(&fit, &s->data);
    if (!status)
        status = infer_fit_score(&fit, &s->data);
    *done = !status && leave_the_same(&fit, &s->fit, &s->data);
    if (*done) {
        const infer_fit old = s->fit;
        s->fit = fit;
        fit = old;
    }
    infer_fit_free(&fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_keep_given_arms(infer_search *s) {
    palp_status status = PALP_OK;
    for (size_t i = s->n_given; !s->data.simulated && i < s->fit.c.model.n_effects && !status; i++) {
        const palp_effect *added = &s->fit.c.model.effects[i];
        bool done = effect_row_of(added->id)->arm && added->value[0] > 0.0;
        for (size_t k = 0; k < s->fit.c.model.material.n_arms && done && !status; k++) {
            const size_t j = arm_to_exchange(s, added);
            done = j < PALP_ARMS_MAX;
            if (done)
                status = exchange(s, i, j, &done);
        }
    }
    return status;
}
