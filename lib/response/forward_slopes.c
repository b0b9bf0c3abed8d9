/* forward_slopes.c: derivatives of a network's force by all parameters, carried from step to step: the direct
 * changes by each parameter. */
#include "forward_internal.h"
#include "step_slopes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The columns of step are all parameters of the model. */
struct forward_slopes {
    const forward_plan *plan;
    step_slopes step;
    size_t n_spectra;
    const forward_spectrum *spectrum;
    unsigned char *alive; /* [n] the parameter has moved an element, or may change one */
    double *kept;         /* [n_state] a copy of the state */
    double *by_time;      /* [m] of the element force */
    double *row;          /* [n] scratch */
    double stiffness;
};

/* ---- direct changes by a parameter ---- */

/* Does it change elements or supports, and not only the instrument? */
static bool does_effect_move_specimen(const forward_slopes *s, const effect_row *row) {
    return row->arm || row->arms || row->spring || row->history || row->spectrum ||
           (row->foundation && network_foundation(s->step.net));
}

static void mark_moving_columns(forward_slopes *s) {
    const palp_model *model = s->plan->model;
    size_t column = forward_effect_column(model, 0);
    memset(s->alive, 1, column);
    for (size_t i = 0; i < model->n_effects; i++) {
        size_t end = forward_effect_column(model, i + 1);
        memset(s->alive + column, does_effect_move_specimen(s, effect_row_of(model->effects[i].id)),
               end - column);
        column = end;
    }
}

/* partial = direct changes of the springs, at fixed nodes and histories. */
static void spring_parameter_partials(forward_slopes *s, const effect_number *of_effect) {
    step_slopes *step = &s->step;
    const palp_network *net = step->net;
    const bool damaged = net->damage != NULL;
    double *elastic = net->scratch;
    palp_law_force(&net->material.law, step->m, net->strain, elastic, NULL, NULL);
    for (size_t i = 0; i < step->m; i++) {
        double peak = damaged ? net->now.history.peak[i] : 0.0;
        element_damaged spring = {.inner = net->strain[i], .factor = 1.0, .force = elastic[i]};
        if (damaged)
            element_damage_force(&net->material.law, net->damage, net->strain[i], peak, &spring);
        memset(s->row, 0, step->n * sizeof *s->row);
        forward_spring_own(s->plan, &spring, peak, net->step.rate_factor, of_effect, s->row);
        for (size_t k = 0; k < step->n; k++)
            step->partial[k * step->m + i] = s->row[k];
        step->by_peak[i] = net->step.rate_factor * spring.by_peak;
    }
}

static void add_own_slopes_of_arm(forward_slopes *s, size_t j) {
    forward_arm_slope own[FORWARD_ARM_SLOPES];
    const size_t n = forward_arm_slopes(s->plan, j, own);
    for (size_t i = 0; i < n; i++)
        step_slopes_add_arm(&s->step, own[i].column, j, &own[i].by);
}

static void add_quasi_linear_slopes(forward_slopes *s, size_t j) {
    step_slopes *step = &s->step;
    const palp_network *net = step->net;
    const palp_law *law = &net->material.law;
    for (size_t i = 0; i < step->m; i++) {
        const double e[2] = {net->now.history.strain[i], net->strain[i]};
        memset(s->row, 0, law->n * sizeof *s->row);
        forward_quasi_linear_own(law, e, step_slopes_by(step, j, ELEMENT_DRIVE)[i], s->row);
        for (size_t k = 0; k < law->n; k++) {
            step->partial[k * step->m + i] += s->row[k];
            step->fixed[(k * step->n_arms + j) * step->m + i] += s->row[k];
        }
    }
}

static void add_own_slopes_of_spectrum(forward_slopes *s, const forward_spectrum *g) {
    for (size_t i = 0; i < g->n; i++)
        for (size_t v = 0; v < g->n_values; v++) {
            const effect_arm by = {.log_stiffness = g->mode[i].weight_by[v] /
                                                    s->step.net->material.arms[g->first + i].stiffness_N,
                                   .log_time = -g->mode[i].rate_by[v] / g->mode[i].rate};
            step_slopes_add_arm(&s->step, g->column + v, g->first + i, &by);
        }
}

static void derivatives_by_step_time(forward_slopes *s) {
    const palp_network *net = s->step.net;
    const double dt = net->step.dt;
    for (size_t i = 0; i < s->step.m; i++) {
        s->by_time[i] = -net->step.dashpot * (net->strain[i] - net->now.history.strain[i]);
        for (size_t j = 0; j < s->step.n_arms; j++)
            s->by_time[i] -= step_slopes_by(&s->step, j, ELEMENT_LOG_TIME)[i];
        s->by_time[i] = dt > 0.0 ? s->by_time[i] / dt : 0.0;
    }
}

void forward_slopes_find(forward_slopes *s, const double *weight, double stiffness,
                         const effect_number *of_effect) {
    s->stiffness = stiffness;
    step_slopes_begin(&s->step, weight);
    spring_parameter_partials(s, of_effect);
    for (size_t k = 0; k < s->step.n; k++)
        if (s->alive[k])
            step_slopes_carry(&s->step, k);
    size_t plain = s->n_spectra ? s->spectrum[0].first : s->step.n_arms;
    for (size_t j = 0; j < plain; j++)
        add_own_slopes_of_arm(s, j);
    for (size_t j = 0; j < s->step.n_arms && s->step.net->material.quasi_linear; j++)
        add_quasi_linear_slopes(s, j);
    for (size_t g = 0; g < s->n_spectra; g++)
        add_own_slopes_of_spectrum(s, &s->spectrum[g]);
    derivatives_by_step_time(s);
}

/* ---- at equilibrium ---- */

/* d log foundation / d parameter k. */
static double log_foundation_derivative(const forward_slopes *s, size_t k) {
    const palp_law *law = &s->step.net->material.law;
    const double small = 1e-9;
    double start, row[PALP_LAW_MAX];
    if (!network_foundation(s->step.net))
        return 0.0;
    if (k < law->n) {
        palp_law_stiffness(law, 0.0, &start, NULL);
        palp_law_gradient(law, small, row);
        return row[k] / (small * start);
    }
    for (size_t i = 0; i < s->plan->n_effects; i++) {
        const forward_effect *f = &s->plan->effect[i];
        effect_number foundation = {.value = 0.0};
        if (!f->row->foundation || k < f->column || k >= f->column + f->row->info.n_parameters)
            continue;
        f->row->foundation(f->effect->value, 0.0, &foundation);
        return foundation.by_value[k - f->column];
    }
    return 0.0;
}

void forward_slopes_hold(forward_slopes *s, double *force_p, double *force_dt) {
    for (size_t k = 0; k < s->step.n; k++)
        force_p[k] = s->alive[k] ? step_slopes_force(&s->step, k, log_foundation_derivative(s, k)) : 0.0;
    *force_dt = 0.0;
    for (size_t i = 0; i < s->step.m; i++)
        *force_dt += s->step.weight[i] * s->by_time[i];
}

static void add_step_time_slopes(forward_slopes *s, size_t k, double dt_p) {
    step_slopes *step = &s->step;
    const double dt = step->net->step.dt;
    for (size_t i = 0; i < step->m; i++)
        step->partial[k * step->m + i] += dt_p * s->by_time[i];
    for (size_t j = 0; j < step->n_arms && dt > 0.0; j++)
        for (size_t i = 0; i < step->m; i++)
            step->fixed[(k * step->n_arms + j) * step->m + i] -=
                dt_p / dt * step_slopes_by(step, j, ELEMENT_LOG_TIME)[i];
}

void forward_slopes_advance(forward_slopes *s, const double *strain_p, const double *dt_p, double *force_p) {
    for (size_t k = 0; k < s->step.n; k++) {
        double depth_p = strain_p ? strain_p[k] * s->step.net->height : 0.0;
        force_p[k] = 0.0;
        if (!s->alive[k] && depth_p == 0.0 && (!dt_p || dt_p[k] == 0.0))
            continue;
        s->alive[k] = 1;
        if (dt_p && dt_p[k] != 0.0)
            add_step_time_slopes(s, k, dt_p[k]);
        const double stiffer = log_foundation_derivative(s, k);
        force_p[k] = step_slopes_force(&s->step, k, stiffer) + s->stiffness * depth_p;
        step_slopes_equilibrate(&s->step, k, stiffer, depth_p);
    }
}

/* ---- construction ---- */

palp_status forward_slopes_create(const forward_plan *plan, palp_network *net, size_t n_spectra,
                                  const forward_spectrum *spectrum, forward_slopes **slopes) {
    const size_t n = plan->n_columns, m = net->n_elements;
    forward_slopes *s = calloc(1, sizeof *s);
    if (!s)
        return PALP_ERR_NO_MEMORY;
    *s = (forward_slopes){.plan = plan, .n_spectra = n_spectra, .spectrum = spectrum};
    palp_status status = step_slopes_create(net, n, net->material.n_arms, &s->step);
    s->kept = malloc((s->step.n_state + m + n + 1) * sizeof *s->kept);
    s->alive = malloc(n + 1);
    if (status || !s->kept || !s->alive) {
        forward_slopes_free(s);
        return status ? status : PALP_ERR_NO_MEMORY;
    }
    s->by_time = s->kept + s->step.n_state;
    s->row = s->by_time + m;
    mark_moving_columns(s);
    *slopes = s;
    return PALP_OK;
}

void forward_slopes_free(forward_slopes *s) {
    if (!s)
        return;
    step_slopes_free(&s->step);
    free(s->kept);
    free(s->alive);
    free(s);
}

void forward_slopes_keep(forward_slopes *s, bool back) {
    memcpy(back ? s->step.state : s->kept, back ? s->kept : s->step.state, s->step.n_state * sizeof *s->kept);
}

void forward_slopes_take_history(forward_slopes *s, const double *peak_p) {
    memcpy(s->step.peak, peak_p, s->step.n * s->step.m * sizeof *s->step.peak);
    for (size_t k = 0; k < s->step.n; k++)
        for (size_t i = 0; i < s->step.m && !s->alive[k]; i++)
            s->alive[k] = peak_p[k * s->step.m + i] != 0.0;
}

const double *forward_slopes_history(const forward_slopes *s) {
    return s->step.peak;
}
