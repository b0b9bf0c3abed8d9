/* realtime.c: stepping a network within a tick. */
#include "realtime_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DIRECT = 1000 };            /* unknowns of which a factor is cheaper than a cycle with levels */
static const double SHARE = 0.03;  /* of its residual that a round of conjugate gradients leaves */
static const double CURVED = 0.1;  /* a tick that left less of its residual may be extrapolated by a parabola, */
static const double STRAIGHT = 0.5; /* less than this by a line */
static const double OVERRUN = 0.5; /* of its slope that a move may have against it at its end */
static const double SAFETY = 3.0;  /* of the error estimate */
static const double DRIFT = 0.05;  /* share by which the adjoint has changed when it is first looked at */
enum { HALVINGS = 4, ROUNDS = 12, CORRECTIONS = 400 }; /* most, where the budget sets no end */

palp_realtime_settings palp_realtime_settings_default(void) {
    return (palp_realtime_settings){.refresh_share = 0.15, .background = false};
}

void network_realtime_free(network_realtime *rt) {
    if (!rt)
        return;
    refresh_thread_free(rt->thread);
    multigrid_free(rt->mg);
    double *arrays[] = {rt->r, rt->z, rt->p, rt->q, rt->move, rt->adjoint};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(rt->coupling);
    free(rt->touching);
    free(rt);
}

/* ---- making ready -------------------------------------------------------------------------------- */

static palp_status allocate(palp_network *net, network_realtime *rt) {
    double **arrays[] = {&rt->r, &rt->z, &rt->p, &rt->q, &rt->move, &rt->adjoint};
    bool ok = true;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        *arrays[i] = calloc(3 * net->n_nodes + 1, sizeof **arrays[i]);
        ok = ok && *arrays[i];
    }
    rt->coupling = calloc(MULTIGRID_COUPLINGS, sizeof *rt->coupling);
    rt->touching = calloc(MULTIGRID_COUPLINGS, sizeof *rt->touching);
    if (!ok || !rt->coupling || !rt->touching)
        return PALP_ERR_NO_MEMORY;
    palp_status status =
        multigrid_create(net->n_nodes, net->rest, net->dof, net->n_elements, net->pair, DIRECT, &rt->mg);
    if (!status && rt->settings.background)
        status = refresh_thread_create(rt->mg, &rt->thread);
    return status;
}

/* The tangent of the committed state, as far as an instantaneous step from it has one. */
static palp_status evaluate_here(palp_network *net) {
    element_step_prepare(&net->material, 1e-3, &net->step);
    net->step.boost = net->boost;
    net->step.wear = net->wear;
    net->inertia = net->mass ? 1e6 : 0.0;
    if (net->load)
        network_load_begin(net);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    return network_evaluate(net) ? PALP_OK : PALP_ERR_COLLAPSED;
}

palp_status realtime_begin(palp_network *net) {
    enum { ADJOINT_ROUNDS = 12 };
    network_realtime *rt = net->realtime;
    palp_status status = evaluate_here(net);
    net->trial = net->can_undo = net->factored = false;
    if (!status)
        status = realtime_refresh_now(net);
    memcpy(rt->adjoint, net->motion, 3 * net->n_nodes * sizeof *rt->adjoint);
    for (int i = 0; i < ADJOINT_ROUNDS && rt->driven && !status; i++)
        realtime_improve_adjoint(net);
    network_tangent_times(net, rt->adjoint, rt->q);
    rt->adjoint_error = DRIFT * sqrt(fabs(realtime_dot(rt->adjoint, rt->q, 3 * net->n_nodes)));
    rt->adjoint_due = 0;
    rt->definite = false;
    rt->contraction = 1.0;
    rt->error_ratio = rt->remembered = 0.0;
    return status;
}

void network_realtime_reset(palp_network *net) {
    if (net->realtime->thread)
        refresh_thread_wait(net->realtime->thread);
    realtime_begin(net); /* where it fails the factor in use still serves */
}

static void time_parts(palp_network *net) {
    network_realtime *rt = net->realtime;
    double start = realtime_clock();
    network_evaluate(net);
    double middle = realtime_clock();
    multigrid_apply(rt->mg, rt->r, rt->z);
    network_tangent_times(net, rt->z, rt->q);
    rt->times = (realtime_times){middle - start, realtime_clock() - middle, middle - start};
}

palp_status palp_network_enable_realtime(palp_network *net, const palp_realtime_settings *settings) {
    if (net->realtime || !(settings->refresh_share > 0.0 && settings->refresh_share < 1.0))
        return PALP_ERR_ARGUMENT;
    network_realtime *rt = calloc(1, sizeof *rt);
    if (!rt)
        return PALP_ERR_NO_MEMORY;
    rt->settings = *settings;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        rt->driven = rt->driven || net->motion[i] != 0.0;
    palp_status status = allocate(net, rt);
    if (!status) {
        double tick = 2.0 * (1.5 * (double)net->n_elements + multigrid_cycle_work(rt->mg));
        rt->piece = settings->refresh_share / (1.0 - settings->refresh_share) * tick;
        net->realtime = rt;
        status = realtime_begin(net);
        time_parts(net);
    }
    if (status) {
        net->realtime = NULL;
        network_realtime_free(rt);
    }
    return status;
}

/* ---- a tick -------------------------------------------------------------------------------------- */

/* What a tick is at. */
typedef struct tick {
    palp_budget budget;
    palp_tick_info info;
    double start;         /* clock, s */
    double norm, scale;   /* |residual| of next.x, and where it is converged */
    double first;         /* the first norm */
    double fresh_error;   /* of the force, by this tick's positions, N */
} tick;

/* Evaluates next.x, once it has not lost what touched. */
static bool follow_tools(palp_network *net) {
    if (net->load)
        network_load_follow(net);
    return network_evaluate(net);
}

static bool predict(palp_network *net) {
    const network_realtime *rt = net->realtime;
    double depth = net->next.depth, move = depth - net->now.depth;
    bool extrapolated =
        rt->contraction < STRAIGHT && network_extrapolate(net, depth, net->next.time, rt->contraction < CURVED);
    if (extrapolated && follow_tools(net))
        return true;
    for (int straight = 1; straight >= 0; straight--) {
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            net->next.x[i] = net->now.x[i] + (straight && rt->driven ? move * rt->adjoint[i] : 0.0);
        network_place(net, depth);
        if (follow_tools(net))
            return true;
    }
    return false;
}

/* Resultant of the load, N. */
static double load_force(const palp_network *net) {
    const double *f = network_load_force(net->load);
    double sum[3] = {0.0};
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        sum[i % 3] += f[i];
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

/* Residual, force and their judgement at next.x. Force by virtual work: exact but for the product of two errors, that
 * of the positions and that of the adjoint, both known in the norm of the tangent. What tools and hands feel is the tissue's
 * own force on nodes of stiffness k: off by no more than sqrt(k) times the first of them. */
static void look(palp_network *net, tick *t) {
    network_realtime *rt = net->realtime;
    t->norm = network_residual(net, &t->scale);
    double force = network_drive_force(net), work = 0.0, error = SAFETY * rt->error_ratio * t->norm, loaded = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        rt->r[i] = net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]];
        work += rt->r[i] * rt->adjoint[i];
    }
    t->info.residual = t->scale > 0.0 ? net->settings.tolerance * t->norm / t->scale : 0.0;
    t->info.force_N = rt->driven ? force - work : 0.0;
    t->fresh_error = rt->driven ? error * rt->adjoint_error : 0.0;
    if (net->load) {
        t->fresh_error += error * sqrt(network_load_own_stiffness(net));
        loaded = load_force(net);
    }
    t->info.force_error_N = t->fresh_error + rt->remembered;
    double most = t->budget.force_error * (fabs(t->info.force_N) + loaded);
    t->info.converged = t->norm <= t->scale || (rt->error_ratio > 0.0 && t->info.force_error_N < most);
}

/* Corrections that the budget leaves room for. The first is always made: a state that is only extrapolated goes
 * astray. */
static size_t room(const palp_network *net, const tick *t) {
    const network_realtime *rt = net->realtime;
    size_t most = t->budget.corrections > 0 ? t->budget.corrections : CORRECTIONS;
    size_t left = most > t->info.corrections ? most - t->info.corrections : 0;
    if (!(t->budget.seconds > 0.0))
        return left;
    double spare = t->budget.seconds - (realtime_clock() - t->start) - rt->times.evaluation - rt->times.rest;
    double fit = floor(spare / rt->times.correction);
    size_t least = t->info.corrections == 0 ? 1 : 0;
    return fit < (double)left ? (fit >= 1.0 ? (size_t)fit : least) : left;
}

/* A slowly forgotten mean that a single preempted tick cannot spoil. */
static void learn(double *mean, double seconds) {
    *mean += 0.1 * (fmin(seconds, 3.0 * *mean) - *mean);
}

/* Residual along the move. */
static double slope(const palp_network *net) {
    double sum = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        sum += net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]] * net->realtime->move[i];
    return sum;
}

/* next.x = start + move, or less of it where that is unsound or runs past the least energy along it, as where a contact
 * stiffens. */
static bool go(palp_network *net, tick *t) {
    network_realtime *rt = net->realtime;
    double before = slope(net), alpha = 1.0, start = realtime_clock();
    memcpy(rt->q, net->next.x, 3 * net->n_nodes * sizeof *rt->q);
    for (int i = 0; i <= HALVINGS; i++) {
        for (size_t k = 0; k < 3 * net->n_nodes; k++)
            net->next.x[k] = rt->q[k] + alpha * rt->move[k];
        if (!network_evaluate(net)) {
            alpha *= 0.5;
            continue;
        }
        look(net, t);
        if (i == 0)
            learn(&rt->times.evaluation, realtime_clock() - start);
        double after = slope(net);
        if (after >= -OVERRUN * before || i == HALVINGS)
            return true;
        alpha *= fmax(0.1, before / (before - after));
    }
    memcpy(net->next.x, rt->q, 3 * net->n_nodes * sizeof *rt->q);
    network_evaluate(net);
    look(net, t);
    return false;
}

static void correct(palp_network *net, tick *t) {
    network_realtime *rt = net->realtime;
    size_t left;
    for (int i = 0; !t->info.converged && (left = room(net, t)) > 0; i++) {
        if (i == ROUNDS && t->budget.corrections == 0 && !(t->budget.seconds > 0.0))
            return;
        double start = realtime_clock();
        size_t done = realtime_solve(net, left, SHARE);
        if (done == 0)
            return;
        learn(&rt->times.correction, (realtime_clock() - start) / (double)done);
        t->info.corrections += done;
        if (!go(net, t))
            return;
        if (net->load && network_load_refresh(net)) {
            if (!network_evaluate(net))
                return;
            look(net, t);
        }
    }
}

/* Stored in springs and arms, and of motion, at the committed state. */
double network_stored_energy(palp_network *net) {
    const network_state *s = &net->now;
    const palp_material *m = &net->material;
    double *psi = net->scratch, sum = 0.0;
    palp_law_force(&m->law, net->n_elements, s->history.strain, psi + net->n_elements, NULL, psi);
    for (size_t j = 0; j < m->n_arms; j++) {
        const double *q = s->history.arm + j * net->n_elements, half = 0.5 / m->arms[j].stiffness_N;
        for (size_t i = 0; i < net->n_elements; i++)
            psi[i] += half * q[i] * q[i];
    }
    for (size_t i = 0; i < net->n_elements; i++)
        sum += (net->scale ? net->scale[i] : 1.0) * psi[i] / net->inverse_rest[i];
    for (size_t i = 0; i < 3 * net->n_nodes && net->mass; i++)
        sum += 0.5 * net->mass[i / 3] * s->velocity[i] * s->velocity[i];
    return sum;
}

/* Of an error in a tick's positions the arms remember what they relax in it. */
static void remember(palp_network *net, const tick *t) {
    network_realtime *rt = net->realtime;
    double slowest = 0.0, leak = 0.0;
    for (size_t j = 0; j < net->material.n_arms; j++) {
        slowest = fmax(slowest, net->step.decay[j]);
        leak += 1.0 - net->step.decay[j];
    }
    rt->remembered = slowest * rt->remembered + fmin(leak, 1.0) * t->fresh_error;
}

/* After the commit: the next factor and the adjoint, on the tangent of the last evaluation. */
static void look_ahead(palp_network *net, tick *t) {
    network_realtime *rt = net->realtime;
    if (rt->adjoint_due > 0 && rt->driven) {
        realtime_improve_adjoint(net);
        rt->adjoint_due--;
    } else {
        t->info.refreshed = realtime_refresh(net);
    }
}

palp_status palp_network_step_within(palp_network *net, double depth_m, double dt_s, const palp_budget *budget,
                                     palp_tick_info *info) {
    tick t = {.budget = *budget, .start = realtime_clock()};
    network_realtime *rt = net->realtime;
    if (!rt || !(budget->seconds >= 0.0) || !(budget->force_error >= 0.0))
        return PALP_ERR_ARGUMENT;
    palp_status status = network_begin(net, depth_m, dt_s);
    if (status)
        return status;
    if (!predict(net))
        return PALP_ERR_COLLAPSED;
    look(net, &t);
    t.first = t.norm;
    correct(net, &t);
    double rest = realtime_clock();
    network_finish(net);
    if (net->load)
        network_load_settle(net, rt->r);
    net->next.force = t.info.force_N;
    net->trial = true;
    net->trial_checked = false;
    palp_network_commit(net);
    rt->contraction = t.first > 0.0 ? t.norm / t.first : 0.0;
    remember(net, &t);
    look_ahead(net, &t);
    if (info) {
        t.info.energy_J = network_stored_energy(net);
        t.info.seconds = realtime_clock() - t.start;
        *info = t.info;
    }
    learn(&rt->times.rest, realtime_clock() - rest);
    return PALP_OK;
}
