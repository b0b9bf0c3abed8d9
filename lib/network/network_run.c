/* network_run.c: following a path with fixed or error-controlled steps. */
#include "network_internal.h"

#include <math.h>

typedef struct run {
    palp_network *net;
    const palp_path *path;
    const palp_run_settings *settings;
    palp_run_info *info;
} run;

static palp_status observe_committed_state(const run *r, double time) {
    const palp_network *net = r->net;
    const double beyond = network_beyond(net, net->now.history.strain);
    r->info->peak_force_N = fmax(r->info->peak_force_N, fabs(net->now.force));
    if (beyond > 0.0 && r->info->beyond == 0.0)
        r->info->beyond_s = time;
    r->info->beyond = fmax(r->info->beyond, beyond);
    if (r->settings->observer &&
        r->settings->observer(r->settings->user, time, net->now.depth, net->now.force))
        return PALP_ERR_STOPPED;
    return PALP_OK;
}

/* One trial step to the path's value at time t. Creep commits at once, since it finds its depth by several
 * tries. */
static palp_status advance_to_path_time(run *r, double t, double dt, bool commit) {
    palp_step_info step = {0};
    double target = palp_path_at(r->path, t), length = r->settings->relaxed ? INFINITY : dt;
    palp_status status = r->path->depth_m ? palp_network_try(r->net, target, length, &step)
                                          : palp_network_step_force(r->net, target, length, &step);
    r->info->iterations += (size_t)step.iterations;
    r->info->inverted = step.inverted > r->info->inverted ? step.inverted : r->info->inverted;
    r->info->worst_residual = fmax(r->info->worst_residual, step.residual);
    if (!status && commit)
        palp_network_commit(r->net);
    return status;
}

static palp_status run_segment_in_fixed_steps(run *r, double from, double to) {
    double count = ceil((to - from) / r->settings->dt_s * (1.0 - 1e-12));
    palp_status status = PALP_OK;
    for (double i = 1.0; i <= count && !status; i += 1.0) {
        double t = i < count ? from + (to - from) * i / count : to;
        if (t <= r->settings->from_s)
            continue;
        status = advance_to_path_time(r, t, (to - from) / count, true);
        r->info->steps += !status;
        if (!status)
            status = observe_committed_state(r, t);
    }
    return status;
}

/* The quantity whose error is estimated: the force, or in creep the depth. */
static double error_measure_of_state(const run *r, const network_state *s) {
    return r->path->depth_m ? s->force : s->depth;
}

/* Order of the error of a run in dt. */
static double convergence_order_of_run(const palp_network *net) {
    bool arms = net->material.formulation == PALP_SEDEF2008 && net->material.n_arms > 0;
    bool first =
        arms || network_has_dashpot(net) || (net->mass && net->settings.integrator == PALP_BACKWARD_EULER);
    return first ? 1.0 : 2.0;
}

/* Step doubling: one whole step and two halves, which are kept. For order p the error is 1 / (2^p - 1) of the
 * difference. */
static palp_status step_whole_and_halved(run *r, double t, double h, double *error) {
    palp_network *net = r->net;
    palp_status status = advance_to_path_time(r, t + h, h, false);
    double whole = r->path->depth_m ? net->next.force : net->now.depth;
    if (status)
        return status;
    if (!r->path->depth_m)
        network_mark_restore(net);
    status = advance_to_path_time(r, t + 0.5 * h, 0.5 * h, true);
    if (!status)
        status = advance_to_path_time(r, t + h, 0.5 * h, true);
    *error = fabs(error_measure_of_state(r, &net->now) - whole) /
             (convergence_order_of_run(net) > 1.0 ? 3.0 : 1.0);
    return status;
}

static bool may_shorter_step_help(palp_status status) {
    return status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED;
}

/* A step that first meets a loss of stability is shortened until its depth is known to check_strain. */
static bool must_locate_buckling(const palp_network *net, bool before) {
    return net->buckled && !before &&
           fabs(net->unstable_depth - net->checked_depth) > net->settings.check_strain * net->height;
}

/* Longest steps, so that the record shows the curve: 50 samples of a moving plate, some 25 a decade of a
 * dwell. The corners of a path of many segments, such as a recording, show most of it. */
enum { SEGMENT_SAMPLES = 50, PATH_SAMPLES = 2000 };

static double sample_count_of_segment(const palp_path *path) {
    double share = PATH_SAMPLES / (double)(path->n - 1);
    return fmax(1.0, fmin(share, SEGMENT_SAMPLES));
}

static double longest_step_at_time(const run *r, double from, double to, double t) {
    double length = to - from, samples = sample_count_of_segment(r->path);
    bool dwell = palp_path_at(r->path, from) == palp_path_at(r->path, to);
    double first = samples < SEGMENT_SAMPLES ? 1.0 / samples : 1e-3;
    return dwell ? fmax(0.1 * (t - from), first * length) : length / samples;
}

static palp_status run_segment_adaptively(run *r, double from, double to, double *step) {
    const double power =
        -1.0 / (1.0 + convergence_order_of_run(r->net)); /* a step of order p has an error of h^(p + 1) */
    const double smallest = fmax(1e-9 * (to - from), 1e-3 * r->settings->dt_min_s);
    double t = from;
    while (t < to) {
        double h = fmin(fmin(*step, longest_step_at_time(r, from, to, t)), to - t), error = 0.0;
        bool buckled = r->net->buckled;
        double checked = r->net->checked_depth;
        if (to - t - h < 0.1 * h)
            h = to - t;
        network_mark_save(r->net);
        palp_status status = step_whole_and_halved(r, t, h, &error);
        if (status && !may_shorter_step_help(status)) {
            network_mark_restore(r->net);
            return status;
        }
        double scale =
            r->path->depth_m ? fmax(r->info->peak_force_N, fabs(r->net->now.force)) : r->net->height;
        double ratio = status ? 64.0 : error / (r->settings->tolerance * scale + 1e-300);
        bool cut = !status && must_locate_buckling(r->net, buckled);
        if ((ratio > 1.0 || cut) && h > smallest) {
            network_mark_restore(r->net);
            r->net->buckled = buckled;
            r->net->checked_depth = checked;
            r->info->rejected++;
            *step = h * fmax(0.2, fmin(0.5, 0.9 * pow(ratio, power)));
            continue;
        }
        if (status) {
            network_mark_restore(r->net);
            return status;
        }
        t = to - t - h <= 0.0 ? to : t + h;
        r->info->steps += 2;
        status = observe_committed_state(r, t);
        if (status)
            return status;
        *step = h * fmin(3.0, 0.9 * pow(ratio + 1e-6, power));
    }
    return PALP_OK;
}

static palp_status check_run_settings(const run *r) {
    const palp_path *p = r->path;
    const palp_run_settings *s = r->settings;
    if (p->n == 0 || (!p->depth_m && !p->force_N) || !(s->tolerance >= 0.0) || !(s->dt_min_s >= 0.0))
        return PALP_ERR_ARGUMENT;
    if (!(s->from_s >= 0.0) || (s->from_s > 0.0 && s->tolerance > 0.0))
        return PALP_ERR_ARGUMENT;
    return s->tolerance > 0.0 || s->dt_s > 0.0 ? PALP_OK : PALP_ERR_ARGUMENT;
}

palp_status palp_network_run(palp_network *network, const palp_path *path, const palp_run_settings *settings,
                             palp_run_info *info) {
    if (!network || !path || !settings)
        return PALP_ERR_ARGUMENT;
    palp_run_info local = {0};
    run r = {network, path, settings, &local};
    palp_status status = check_run_settings(&r);
    double start = status ? 0.0 : palp_path_at(path, path->time_s[0]);
    const bool anew = settings->from_s == 0.0;
    if (!status && anew && start != (path->depth_m ? network->now.depth : network->now.force))
        status = advance_to_path_time(&r, path->time_s[0], 0.0, true);
    if (!status && anew)
        status = observe_committed_state(&r, path->time_s[0]);
    for (size_t i = 0; i + 1 < path->n && !status; i++) {
        double from = path->time_s[i], to = path->time_s[i + 1];
        double step =
            settings->dt_min_s > 0.0 ? settings->dt_min_s : (to - from) / sample_count_of_segment(path);
        status = settings->tolerance > 0.0 ? run_segment_adaptively(&r, from, to, &step)
                                           : run_segment_in_fixed_steps(&r, from, to);
    }
    if (info)
        *info = local;
    return status;
}
