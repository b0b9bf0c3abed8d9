/* three_phase.c: the thesis' loops of Figure 5.21 for one arm: peak force by K1 and b1, time to
 * the steady state by b1, force there by the law's scale. */
#include <palpate/thesis.h>

#include "fit/calibrate_internal.h"

#include <math.h>
#include <string.h>

/* Peak force, and the time and force at which the slope has fallen to steady_slope. */
typedef struct marks {
    double peak, steady_time, steady_force;
} marks;

typedef struct three_phase {
    palp_network *net;
    const palp_target *target;
    const palp_three_phase_settings *settings;
    palp_calibration *result;
    palp_material material;
    marks wanted, reached;
} three_phase;

static marks measure_marks_of_record(const palp_target *target, double slope) {
    marks m = {0};
    size_t i = 1, n = target->n;
    double ramp_end = target->path.time_s[1];
    while (i < n && target->time_s[i] < ramp_end * (1.0 - 1e-12))
        i++;
    m.peak = target->force_N[i < n ? i : n - 1];
    for (i++; i < n; i++) {
        m.steady_time = target->time_s[i];
        m.steady_force = target->force_N[i];
        if (target->force_N[i - 1] - target->force_N[i] < slope * (target->time_s[i] - target->time_s[i - 1]))
            break;
    }
    return m;
}

/* A step of the dwell: to equilibrium, or of a frozen dwell with every node where it is. */
static palp_status advance_dwell_step(palp_network *net, bool frozen, double depth_m, double dt_s) {
    if (!frozen)
        return palp_network_step(net, depth_m, dt_s, NULL);
    palp_status status = network_begin(net, depth_m, dt_s);
    if (status)
        return status;
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    if (!network_evaluate(net))
        return PALP_ERR_COLLAPSED;
    network_finish(net);
    net->trial_checked = false;
    net->trial = true;
    palp_network_commit(net);
    return PALP_OK;
}

/* Runs the ramp, and the hold until it is steady if wanted. */
static palp_status run_ramp_and_hold(three_phase *s, bool hold) {
    const palp_path *path = &s->target->path;
    double dt = s->settings->dt_s, ramp = path->time_s[1], end = path->time_s[path->n - 1];
    palp_status status = palp_network_set_material(s->net, &s->material);
    double steps = ceil(ramp / dt - 1e-9), step = ramp / steps;
    for (double i = 1.0; i <= steps && !status; i += 1.0)
        status = palp_network_step(s->net, path->depth_m[1] * i / steps, step, NULL);
    s->reached.peak = s->net->now.force;
    for (double t = ramp + dt; hold && t < end + 0.5 * dt && !status; t += dt) {
        double before = s->net->now.force;
        status = advance_dwell_step(s->net, s->settings->frozen_dwell, path->depth_m[1], dt);
        s->reached.steady_time = t;
        s->reached.steady_force = s->net->now.force;
        if (before - s->net->now.force < s->settings->steady_slope_N_s * dt)
            break;
    }
    return status;
}

static double relative_error_of_mark(double reached, double wanted) {
    return fabs(reached - wanted) / fabs(wanted);
}

static palp_status record_iteration_errors(three_phase *s, int phase, bool hold) {
    double peak = 100.0 * relative_error_of_mark(s->reached.peak, s->wanted.peak);
    palp_calibrate_iteration it = {.phase = phase,
                                   .residual_N = fabs(s->reached.peak - s->wanted.peak),
                                   .material = s->material,
                                   .peak_error_percent = peak,
                                   .steady_time_error_percent = NAN,
                                   .steady_force_error_percent = NAN};
    if (hold) {
        it.steady_time_error_percent =
            100.0 * relative_error_of_mark(s->reached.steady_time, s->wanted.steady_time);
        it.steady_force_error_percent =
            100.0 * relative_error_of_mark(s->reached.steady_force, s->wanted.steady_force);
    }
    palp_status status = calibration_add(s->result, &it);
    double done = (double)s->result->n_iterations / (double)s->settings->max_evaluations;
    if (!status && s->settings->progress && s->settings->progress(s->settings->user, done, &it))
        status = PALP_ERR_STOPPED;
    return status;
}

static bool are_evaluations_exhausted(const three_phase *s) {
    return s->result->n_iterations >= s->settings->max_evaluations;
}

/* Phases 1 and 2: multiply by wanted / reached until the error is within the bound or grows. */
static palp_status match_mark_by_scaling(three_phase *s, int phase) {
    double least = HUGE_VAL, e = HUGE_VAL;
    palp_arm *arm = &s->material.arms[0], best = *arm;
    while (e > s->settings->error_bound && !are_evaluations_exhausted(s)) {
        palp_status status = run_ramp_and_hold(s, phase == 2);
        if (!status)
            status = record_iteration_errors(s, phase, phase == 2);
        if (status)
            return status;
        double wanted = phase == 1 ? s->wanted.peak : s->wanted.steady_time;
        double reached = phase == 1 ? s->reached.peak : s->reached.steady_time;
        e = relative_error_of_mark(reached, wanted);
        if (!(e < least))
            break;
        least = e;
        best = *arm;
        if (e > s->settings->error_bound) {
            arm->viscosity_Ns *= wanted / reached;
            if (phase == 1)
                arm->stiffness_N *= wanted / reached;
        }
    }
    *arm = best;
    return PALP_OK;
}

/* Phase 3, as printed: the law's scale moves by the last error, halved whenever it overshoots. */
static palp_status match_steady_force(three_phase *s) {
    enum { ROUNDS = 20 };
    double least = HUGE_VAL, best_force = 0.0, difference = 0.0, e;
    palp_law best = s->material.law;
    for (int round = 0; round < ROUNDS && !are_evaluations_exhausted(s); round++) {
        palp_status status = run_ramp_and_hold(s, true);
        if (!status)
            status = record_iteration_errors(s, 3, true);
        if (status)
            return status;
        e = relative_error_of_mark(s->reached.steady_force, s->wanted.steady_force);
        if (e <= s->settings->error_bound)
            return PALP_OK;
        if (e < least) {
            least = difference = e;
            best_force = s->reached.steady_force;
            best = s->material.law;
        } else {
            difference *= 0.5;
        }
        double factor = best_force > s->wanted.steady_force ? 1.0 - difference : 1.0 + difference;
        status = palp_law_scale(&best, factor, &s->material.law);
        if (status)
            return status;
    }
    s->material.law = best;
    return PALP_OK;
}

static bool are_materials_identical(const palp_material *a, const palp_material *b) {
    return a->arms[0].stiffness_N == b->arms[0].stiffness_N &&
           a->arms[0].viscosity_Ns == b->arms[0].viscosity_Ns &&
           memcmp(a->law.coefficients, b->law.coefficients, sizeof a->law.coefficients) == 0;
}

static bool are_errors_within_bound(const three_phase *s) {
    double bound = s->settings->error_bound;
    return relative_error_of_mark(s->reached.peak, s->wanted.peak) <= bound &&
           relative_error_of_mark(s->reached.steady_time, s->wanted.steady_time) <= bound &&
           relative_error_of_mark(s->reached.steady_force, s->wanted.steady_force) <= bound;
}

/* From rest along a ramp and a hold. */
static palp_status check_three_phase_input(const palp_material *start, const palp_target *target,
                                           const palp_three_phase_settings *settings) {
    if (start->n_arms != 1)
        return PALP_ERR_UNSUPPORTED;
    const palp_path *p = &target->path;
    if (target->n < 3 || p->n != 3 || !p->depth_m || p->depth_m[0] != 0.0 || p->time_s[0] != 0.0 ||
        p->depth_m[1] != p->depth_m[2] || !(settings->dt_s > 0.0) || settings->max_evaluations < 1 ||
        !(settings->error_bound > 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 1; i < target->n; i++)
        if (!(target->time_s[i] > target->time_s[i - 1]))
            return PALP_ERR_ARGUMENT;
    return palp_material_check(start, NULL);
}

/* One global iteration: the three phases, and the response of the resulting material. */
static palp_status iterate_three_phases(three_phase *s) {
    palp_status status = match_mark_by_scaling(s, 1);
    if (!status)
        status = match_mark_by_scaling(s, 2);
    if (!status)
        status = match_steady_force(s);
    return status ? status : run_ramp_and_hold(s, true);
}

static palp_status iterate_until_unchanged(three_phase *s) {
    palp_calibration *result = s->result;
    palp_material before;
    s->wanted = measure_marks_of_record(s->target, s->settings->steady_slope_N_s);
    if (!(s->wanted.peak > 0.0) || !(s->wanted.steady_time > 0.0) || !(s->wanted.steady_force > 0.0))
        return PALP_ERR_ARGUMENT; /* no force, or a record that ends with the ramp */
    do {
        before = s->material;
        palp_status status = iterate_three_phases(s);
        if (status)
            return status;
        result->converged = are_errors_within_bound(s);
    } while (!result->converged && !are_evaluations_exhausted(s) &&
             !are_materials_identical(&before, &s->material));
    result->material = s->material;
    result->residual_N = fabs(s->reached.peak - s->wanted.peak);
    return palp_network_set_material(s->net, &result->material);
}

palp_three_phase_settings palp_three_phase_settings_default(void) {
    return (palp_three_phase_settings){
        .max_evaluations = 80, .dt_s = 1e-3, .error_bound = 0.01, .steady_slope_N_s = 1e-3};
}

palp_status palp_thesis_three_phase(palp_network *network, const palp_material *start,
                                    const palp_target *target, const palp_three_phase_settings *settings,
                                    palp_calibration *result) {
    if (!network || !start || !target || !settings || !result)
        return PALP_ERR_ARGUMENT;
    three_phase s = {
        .net = network, .target = target, .settings = settings, .result = result, .material = *start};
    memset(result, 0, sizeof *result);
    palp_status status = check_three_phase_input(start, target, settings);
    if (!status)
        status = iterate_until_unchanged(&s);
    if (status)
        palp_calibration_free(result);
    return status;
}
