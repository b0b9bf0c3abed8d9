/* realtime.c: stepping a network within a tick. */
#include "realtime_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Below so many unknowns a direct factor is cheaper than a multigrid cycle. */
enum { DIRECT = 1000 };
/* The same with tools: only a multigrid with levels can follow their contacts in every tick. */
enum { TOUCHED = 200 };
/* A round of conjugate gradients ends at this share of its first residual. */
static const double SHARE = 0.03;
/* A tick that left less than this share of its residual is extrapolated by a parabola. */
static const double CURVED = 0.1;
/* A tick that left less than this share is extrapolated by a straight line. */
static const double STRAIGHT = 0.5;
/* Above this multiple of the last tick's first residual the path has turned. */
static const double SUDDEN = 2.0;
/* Backtrack if the slope at the end of a move exceeds this share of the initial one. */
static const double OVERRUN = 0.5;
/* A backtracked place keeps this share of the interval away from both of its ends. */
static const double ASIDE = 0.15;
/* Safety factor of the error estimate. */
static const double SAFETY = 3.0;
/* Corrections stop at this share of the error that the budget allows. */
static const double MARGIN = 0.5;
/* No correction is made for less than this share of the allowed error: earlier ticks' errors stay. */
static const double LITTLE = 0.1;
/* Above this share of the allowed error the next tick evaluates the tangent, as it may have to correct. */
static const double NEAR = 0.7;
/* The nodes may be off by so many times the last correction. Without a correction, friction's forces may be
 * off by so many times the error of the tick. A correction that halves the error leaves as much as it was
 * itself. */
static const double ANCHORED = 3.0;
/* No budget ends a tick whose residual is above this multiple of the elements' forces. */
static const double LOST = 1.0;
/* Time step of the tangent of the first factor, s. */
static const double INSTANT = 1e-3;
/* Limits of backtracking steps, rounds and corrections where the budget sets none. */
enum { TRIES = 4, ROUNDS = 12, CORRECTIONS = 400 };
/* Limit of rounds where tools touch: each is one correction, as the tangent does not predict slip. */
enum { SINGLE_ROUNDS = 60 };
/* Limit of corrections on the way to a stable branch; its rounds are not limited. */
enum { DESCENT = 20000 };

palp_realtime_settings palp_realtime_settings_default(void) {
    return (palp_realtime_settings){.refresh_share = 0.15, .background = false};
}

void palp_realtime_free(palp_realtime *rt) {
    if (!rt)
        return;
    rt->net->stepped = false;
    refresh_thread_free(rt->thread);
    multigrid_free(rt->mg);
    arena_free(&rt->memory);
    free(rt);
}

static palp_status allocate_realtime_arrays(palp_realtime *rt) {
    const palp_network *net = rt->net;
    double **arrays[] = {
        &rt->r,      &rt->z,         &rt->p,         &rt->q,      &rt->move,          &rt->adjoint,
        &rt->weight, &rt->adjoint_r, &rt->adjoint_z, &rt->tissue, &rt->adjoint_at[0], &rt->adjoint_at[1]};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = arena_take(&rt->memory, 3 * net->n_nodes, sizeof **arrays[i]);
    rt->touching = arena_take(&rt->memory, MULTIGRID_COUPLINGS, sizeof *rt->touching);
    if (rt->memory.failed)
        return PALP_ERR_NO_MEMORY;
    const bool touched = realtime_touched(net);
    double **kept[] = {&rt->direction, &rt->inner, &rt->tangent};
    for (size_t i = 0; i < 3 && touched; i++)
        if (!(*kept[i] = arena_take(&rt->memory, 3 * net->n_nodes * REALTIME_DIRECTIONS, sizeof **kept[i])))
            return PALP_ERR_NO_MEMORY;
    palp_status status = multigrid_create(net->n_nodes, net->rest, net->dof, net->n_elements, net->pair,
                                          touched ? TOUCHED : DIRECT, &rt->mg);
    for (size_t i = 0; i < net->n_terms; i++)
        rt->spread = fmax(rt->spread, net->terms[i]->kind->spread);
    if (!status && rt->spread > 0.0)
        status = multigrid_make_room(rt->mg, rt->spread);
    if (!status &&
        (!(rt->element = arena_take(&rt->memory, multigrid_input(rt->mg).n_floats, sizeof *rt->element)) ||
         !(rt->adjoint_half =
               arena_take(&rt->memory, multigrid_half_size(rt->mg), sizeof *rt->adjoint_half))))
        status = PALP_ERR_NO_MEMORY;
    if (!status && net->run)
        status = realtime_place_runs(rt);
    if (!status && rt->settings.background)
        status = refresh_thread_create(rt->mg, &rt->thread);
    return status;
}

/* The tangent of the committed state, for an instantaneous step from it. */
static palp_status evaluate_committed_state(palp_network *net) {
    palp_status status = network_begin(net, net->now.depth, INSTANT);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    return status ? status : network_evaluate(net) ? PALP_OK : PALP_ERR_COLLAPSED;
}

/* Makes a factor and an adjoint of the committed state at once. If that fails, the factor in use stays. */
static palp_status begin_from_committed_state(palp_realtime *rt) {
    palp_network *net = rt->net;
    if (rt->thread)
        refresh_thread_wait(rt->thread);
    palp_status status = evaluate_committed_state(net);
    net->factored = false;
    rt->resets = net->resets;
    memcpy(rt->tissue, net->fint, 3 * net->n_nodes * sizeof *rt->tissue);
    if (!status)
        status = realtime_refresh_now(rt);
    for (size_t k = 0; k < REALTIME_PARTS; k++)
        rt->inverted[k] = network_count_inverted(net, net->now.x, k, REALTIME_PARTS);
    rt->part = 0;
    realtime_begin_adjoint(rt, !status);
    rt->definite = rt->idle = rt->near = false;
    rt->contraction = 1.0;
    rt->error_ratio = rt->remembered = rt->anchored = rt->guessed = 0.0;
    memset(rt->arm_error, 0, sizeof rt->arm_error);
    return status;
}

palp_status palp_realtime_reset(palp_realtime *rt) {
    if (!rt)
        return PALP_ERR_ARGUMENT;
    palp_network_reset(rt->net);
    return begin_from_committed_state(rt);
}

static void measure_correction_times(palp_realtime *rt) {
    double start = realtime_clock();
    realtime_evaluate(rt, true, false);
    double middle = realtime_clock();
    multigrid_apply(rt->mg, rt->r, rt->z);
    realtime_tangent_times(rt, rt->z, rt->q);
    rt->times = (realtime_times){middle - start, realtime_clock() - middle, middle - start};
}

palp_status palp_realtime_create(palp_network *net, const palp_realtime_settings *settings,
                                 palp_realtime **realtime) {
    if (!net || !settings || !realtime || net->stepped)
        return PALP_ERR_ARGUMENT;
    if (net->ranks)
        return PALP_ERR_UNSUPPORTED;
    if (!(settings->refresh_share > 0.0 && settings->refresh_share < 1.0))
        return PALP_ERR_ARGUMENT;
    palp_realtime *rt = calloc(1, sizeof *rt);
    if (!rt)
        return PALP_ERR_NO_MEMORY;
    rt->net = net;
    net->stepped = true;
    rt->settings = *settings;
    rt->driven = net->driven;
    palp_status status = allocate_realtime_arrays(rt);
    if (!status) {
        double tick = 2.0 * ((double)net->n_elements + multigrid_cycle_work(rt->mg));
        rt->piece = settings->refresh_share / (1.0 - settings->refresh_share) * tick;
        status = begin_from_committed_state(rt);
        if (!status) /* repeated for the other set, so that no tick is the first to touch its memory */
            status = realtime_refresh_now(rt);
        measure_correction_times(rt);
    }
    if (status)
        palp_realtime_free(rt);
    else
        *realtime = rt;
    return status;
}

palp_network *palp_realtime_network(const palp_realtime *rt) {
    return rt ? rt->net : NULL;
}

/* The state of a tick. */
typedef struct tick {
    palp_budget budget;
    palp_tick_info info;
    double start;       /* clock, s */
    double norm, scale; /* |residual| of next.x, and the norm at which it is converged */
    double first;       /* norm of the first guess */
    double place_error; /* of this tick's positions, in the energy norm of the tangent */
    double fresh_error; /* error of the force due to place_error, N */
    bool moved;         /* rt->move is ANCHORED times the last correction, which was taken */
    bool enough;        /* a correction cannot lower the estimated error by much of what the budget allows */
    bool near;          /* the estimated error is nearly as large as the budget allows */
    size_t before;      /* corrections made while tools were moved in parts */
} tick;

/* Lets the terms follow next.x, then evaluates there. */
static bool evaluate_with_followers(palp_realtime *rt, bool tangent, bool trial) {
    palp_network *net = rt->net;
    NETWORK_EACH_TERM(net, follow, net);
    return realtime_evaluate(rt, tangent, trial);
}

/* Is the tangent at next.x needed: by another correction, by the adjoint or by the next factor? */
static bool is_tangent_wanted(const palp_realtime *rt, bool last) {
    bool due = rt->adjoint_due > 0 && rt->driven;
    const int part = rt->adjoint_parts - rt->adjoint_due;
    return !last || (due ? part == 0 || part == ADJOINT_PARTS - 1 : realtime_refresh_begins(rt));
}

static bool predict_next_positions(palp_realtime *rt, const palp_budget *budget) {
    const bool enough = rt->idle && !rt->near && budget->force_error > 0.0 &&
                        !realtime_touched(rt->net); /* as in the last tick */
    const bool tangent = is_tangent_wanted(rt, enough);
    palp_network *net = rt->net;
    double depth = net->next.depth, move = depth - net->now.depth;
    const bool trial = budget->force_error == 0.0; /* otherwise this evaluation may be the last one */
    bool extrapolated = rt->contraction < STRAIGHT &&
                        network_extrapolate(net, depth, net->next.time, rt->contraction < CURVED);
    if (extrapolated && evaluate_with_followers(rt, tangent, trial))
        return true;
    for (int straight = 1; straight >= 0; straight--) {
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            net->next.x[i] = net->now.x[i] + (straight && rt->driven ? move * rt->adjoint[i] : 0.0);
        network_place(net, depth);
        if (evaluate_with_followers(rt, tangent, trial))
            return true;
    }
    return false;
}

/* The residual of the last evaluation on all axes, 0 on fixed ones. */
static void spread_residual_to_nodes(const palp_network *net, double *r) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        r[i] = net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]];
}

/* The force error that the budget allows, N. */
static double allowed_force_error(const palp_realtime *rt, const tick *t) {
    return t->budget.force_error > 0.0
               ? t->budget.force_error * (fabs(t->info.force_N) + realtime_outer_force(rt->net))
               : 0.0;
}

/* Residual, force and their error at next.x. The force follows from virtual work, so its error is the product
 * of the errors of positions and adjoint, both in the energy norm. Tools and hands feel the tissue's force on
 * nodes of stiffness k: its error is at most sqrt(k) times that of the positions. */
static void assess_residual_and_force(palp_realtime *rt, tick *t) {
    palp_network *net = rt->net;
    t->norm = network_residual(net, &t->scale);
    t->place_error = SAFETY * realtime_doubt(rt) * rt->error_ratio * t->norm;
    const double force = network_drive_force(net);
    spread_residual_to_nodes(net, rt->r);
    double work = network_dot(rt->r, rt->adjoint, 3 * net->n_nodes);
    t->info.residual = t->scale > 0.0 ? net->settings.tolerance * t->norm / t->scale : 0.0;
    t->info.force_N = rt->driven ? force - work : 0.0;
    t->fresh_error = t->place_error * (realtime_adjoint_error(rt) + sqrt(realtime_own_stiffness(rt)));
    rt->anchored = 0.0;
    NETWORK_EACH_TERM(net, doubt, net, &rt->anchored);
    t->info.force_error_N = t->fresh_error + rt->remembered + rt->anchored;
    double most = allowed_force_error(rt, t);
    t->near = t->info.force_error_N > NEAR * most;
    t->enough = rt->error_ratio > 0.0 && t->fresh_error < LITTLE * most;
    t->info.converged = t->norm <= t->scale || (rt->error_ratio > 0.0 && t->info.force_error_N < most);
}

/* Is a stable branch wanted, whatever number of corrections it takes? */
static bool seeks_stable_branch(const palp_realtime *rt) {
    return rt->net->settings.branch == PALP_BRANCH_STABLE;
}

/* Corrections that the budget leaves room for. The first is always made: extrapolation alone would drift. So
 * are more while the residual exceeds the elements' forces: later ticks would start from a folded state. */
static size_t corrections_left_in_budget(const palp_realtime *rt, const tick *t) {
    size_t own = seeks_stable_branch(rt) ? DESCENT : CORRECTIONS,
           most = t->budget.corrections > 0 ? t->budget.corrections : own;
    const bool lost = t->info.residual > LOST && t->info.corrections < SINGLE_ROUNDS;
    const size_t least = t->info.corrections == 0 || lost ? 1 : 0;
    size_t left = most > t->info.corrections ? most - t->info.corrections : least;
    if (!(t->budget.seconds > 0.0))
        return left;
    double spare = t->budget.seconds - (realtime_clock() - t->start) - rt->times.evaluation - rt->times.rest;
    double fit = floor(spare / rt->times.correction);
    return fit < (double)left ? (fit >= 1.0 ? (size_t)fit : least) : left;
}

/* A running mean that forgets slowly and that one preempted tick cannot spoil. */
static void update_running_mean(double *mean, double seconds) {
    *mean += 0.1 * (fmin(seconds, 3.0 * *mean) - *mean);
}

/* The share of an interval at which the slope along the move is zero, by linear interpolation. */
static double secant_part_of_move(double at_low, double at_high) {
    return fmin(fmax(at_low / (at_low - at_high), ASIDE), 1.0 - ASIDE);
}

/* next.x = start + move. Backtracks if the network cannot be evaluated, or if the energy rises too steeply at
 * the end of the move. It does so where a contact stiffens or begins to stick. */
static bool go_along_search_direction(palp_realtime *rt, tick *t) {
    palp_network *net = rt->net;
    double alpha = 1.0, start = realtime_clock();
    spread_residual_to_nodes(net, rt->p); /* conjugate gradients have changed r */
    const double before = network_dot(rt->p, rt->move, 3 * net->n_nodes);
    double low = 0.0, high = 1.0, at_low = before, at_high = 0.0;
    const bool last = t->info.corrections == t->budget.corrections, tangent = is_tangent_wanted(rt, last);
    const bool trial = !last && t->budget.corrections > 0;
    memcpy(rt->q, net->next.x, 3 * net->n_nodes * sizeof *rt->q);
    for (int i = 0; i <= TRIES; i++) {
        for (size_t k = 0; k < 3 * net->n_nodes; k++)
            net->next.x[k] = rt->q[k] + alpha * rt->move[k];
        double after = -at_low;
        if (realtime_evaluate(rt, tangent, trial)) {
            assess_residual_and_force(rt, t);
            if (i == 0)
                update_running_mean(&rt->times.evaluation, realtime_clock() - start);
            after = network_dot(rt->r, rt->move, 3 * net->n_nodes);
            if (i == TRIES || (after >= -OVERRUN * before && (i == 0 || after <= OVERRUN * before))) {
                for (size_t k = 0; k < 3 * net->n_nodes; k++)
                    rt->move[k] = ANCHORED * (net->next.x[k] - rt->q[k]);
                t->moved = true;
                return true;
            }
        }
        if (after > 0.0) {
            low = alpha;
            at_low = after;
        } else {
            high = alpha;
            at_high = after;
        }
        alpha = low + secant_part_of_move(at_low, at_high) * (high - low);
    }
    memcpy(net->next.x, rt->q, 3 * net->n_nodes * sizeof *rt->q);
    t->moved = false;
    realtime_evaluate(rt, true, false);
    assess_residual_and_force(rt, t);
    return false;
}

/* Error of the positions, in the energy norm, at which the budget's force error is met; 0 if it sets none. */
static double allowed_position_error(palp_realtime *rt, const tick *t) {
    const double error =
        SAFETY * realtime_doubt(rt) * (realtime_adjoint_error(rt) + sqrt(realtime_own_stiffness(rt)));
    const double most = allowed_force_error(rt, t);
    return t->budget.force_error > 0.0
               ? fmax(LITTLE * most, MARGIN * most - rt->remembered - rt->anchored) / error
               : 0.0;
}

static void correct_within_budget(palp_realtime *rt, tick *t) {
    const bool touched = rt->direction;
    const int rounds = touched ? SINGLE_ROUNDS : ROUNDS;
    for (int i = 0; !t->info.converged && !t->enough; i++) {
        size_t left = corrections_left_in_budget(rt, t);
        if (left == 0)
            return;
        if (i == rounds && t->budget.corrections == 0 && !(t->budget.seconds > 0.0) &&
            !seeks_stable_branch(rt))
            return;
        double start = realtime_clock();
        if (!rt->fresh &&
            !realtime_evaluate(rt, true, true)) /* the prediction was expected to be good enough */
            return;
        size_t done = touched ? realtime_solve_touched(rt, 1, SHARE)
                              : realtime_solve(rt, left, SHARE, allowed_position_error(rt, t));
        if (done == 0)
            return;
        update_running_mean(&rt->times.correction, (realtime_clock() - start) / (double)done);
        t->info.corrections += done;
        if (!go_along_search_direction(rt, t))
            return;
        if (network_refresh(rt->net)) {
            if (!realtime_evaluate(rt, true, false))
                return;
            assess_residual_and_force(rt, t);
        }
    }
}

/* Moves the tools to this share of their way and corrects with a new budget of corrections. */
static palp_status continue_at_tool_share(palp_realtime *rt, tick *t, double share) {
    NETWORK_EACH_TERM(rt->net, place, rt->net, share);
    if (!realtime_evaluate(rt, true, true))
        return PALP_ERR_COLLAPSED;
    assess_residual_and_force(rt, t);
    t->before += t->info.corrections;
    t->info.corrections = 0;
    rt->n_directions = 0;
    correct_within_budget(rt, t);
    return PALP_OK;
}

/* Arms relax at positions that have an error, and remember the force of that. With the error d of the
 * positions after a tick, arm j of stiffness K_j is off by K_j (d - m). m is a weighted mean of earlier
 * errors: m <- decay_j m + (1 - decay_j) d from tick to tick. K_j m moves the nodes by no more than m times
 * the arm's share of the stiffness, which is itself part of the next d. For the plate the force of that is of
 * first order, as arms and springs have different equilibria. Of several materials the worst counts. */
static void remember_position_errors(palp_realtime *rt, const tick *t) {
    const palp_network *net = rt->net;
    const double error =
        t->fresh_error + rt->anchored + rt->remembered + (rt->driven ? rt->forgets * t->place_error : 0.0);
    rt->remembered = 0.0;
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++) {
        double sum = 0.0;
        for (size_t j = 0; network_material_at(net, r, &m) && j < m.material->n_arms; j++) {
            const double decay = m.step->decay[j], share = m.material->arms[j].stiffness_N / m.modulus;
            rt->arm_error[r][j] = decay * rt->arm_error[r][j] + (1.0 - decay) * share * error;
            sum += rt->arm_error[r][j];
        }
        rt->remembered = fmax(rt->remembered, sum);
    }
}

/* After the commit: works on the adjoint or the next factor with the tangent of the last evaluation. A tick
 * that had to correct, though the one before it had not, leaves this to later ticks. */
static void refresh_factor_or_adjoint(palp_realtime *rt, tick *t) {
    if (rt->idle && t->info.corrections > 0)
        return;
    if (rt->adjoint_due > 0 && rt->driven) {
        realtime_improve_adjoint(rt, rt->adjoint_parts - rt->adjoint_due);
        rt->adjoint_due--;
    } else {
        t->info.refreshed = realtime_refresh(rt);
    }
}

/* Finishes the step at the accuracy reached and commits it. */
static palp_status commit_corrected_state(palp_realtime *rt, const tick *t) {
    palp_network *net = rt->net;
    if (!rt->kept) /* an unexpected last evaluation: its history was not kept */
        realtime_evaluate(rt, rt->fresh, false);
    palp_status status = network_finish(net);
    if (status)
        return status;
    if (realtime_touched(net))
        memcpy(rt->tissue, net->fint, 3 * net->n_nodes * sizeof *rt->tissue);
    realtime_weigh(rt);
    NETWORK_EACH_TERM(net, share_residual, net, rt->weight, rt->r);
    NETWORK_EACH_TERM(net, keep_doubt, net, t->moved ? rt->move : NULL, ANCHORED * t->fresh_error);
    net->next.force = t->info.force_N;
    net->trial = true;
    net->trial_checked = false;
    palp_network_commit(net);
    return PALP_OK;
}

/* Counts one part of the tetrahedra anew and adds the last counts of the other parts. */
static size_t count_inverted(palp_realtime *rt) {
    size_t sum = 0;
    rt->inverted[rt->part] = network_count_inverted(rt->net, rt->net->now.x, rt->part, REALTIME_PARTS);
    rt->part = (rt->part + 1) % REALTIME_PARTS;
    for (size_t k = 0; k < REALTIME_PARTS; k++)
        sum += rt->inverted[k];
    return sum;
}

/* When a hand stops or turns, extrapolation is a bad guess, and friction would remember slip on the way back.
 * If tools touch and the guess's residual jumped, the tick starts from the committed positions, provided
 * their residual is smaller. */
static void stay_if_nearer(palp_realtime *rt, tick *t) {
    palp_network *net = rt->net;
    const size_t size = 3 * net->n_nodes * sizeof *rt->q;
    const double predicted = t->norm, usual = rt->guessed;
    rt->guessed = predicted;
    if (!realtime_touched(net) || predicted <= SUDDEN * usual || !realtime_may_stay(rt, predicted))
        return;
    memcpy(rt->q, net->next.x, size);
    memcpy(net->next.x, net->now.x, size);
    network_place(net, net->next.depth);
    if (evaluate_with_followers(rt, true, true)) {
        assess_residual_and_force(rt, t);
        if (t->norm < predicted) {
            rt->guessed = t->norm;
            return;
        }
    }
    memcpy(net->next.x, rt->q, size);
    realtime_evaluate(rt, true, true);
    assess_residual_and_force(rt, t);
}

palp_status palp_realtime_step(palp_realtime *rt, double depth_m, double dt_s, const palp_budget *budget,
                               palp_tick_info *info) {
    if (!rt || !budget)
        return PALP_ERR_ARGUMENT;
    tick t = {.budget = *budget, .start = realtime_clock()};
    palp_network *net = rt->net;
    if (!(budget->seconds >= 0.0) || !(budget->force_error >= 0.0))
        return PALP_ERR_ARGUMENT;
    palp_status status = rt->resets != net->resets ? begin_from_committed_state(rt) : PALP_OK;
    if (!status)
        status = network_begin(net, depth_m, dt_s);
    if (status)
        return status;
    const double parts = fmax(1.0, ceil(network_longest_way(net)));
    if (parts > 1.0) {
        memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
        NETWORK_EACH_TERM(net, place, net, 1.0 / parts);
    }
    if (!predict_next_positions(rt, budget))
        return PALP_ERR_COLLAPSED;
    if (rt->driven)
        realtime_follow_adjoint(rt);
    assess_residual_and_force(rt, &t);
    stay_if_nearer(rt, &t);
    t.first = t.norm;
    rt->indefinite = false;
    rt->n_directions = 0;
    correct_within_budget(rt, &t);
    for (double k = 2.0; k <= parts && !status; k += 1.0)
        status = continue_at_tool_share(rt, &t, k / parts);
    t.info.corrections += t.before;
    t.info.buckled = rt->indefinite;
    double rest = realtime_clock();
    if (!status)
        status = commit_corrected_state(rt, &t);
    if (status)
        return status;
    rt->contraction = t.first > 0.0 ? t.norm / t.first : 0.0;
    remember_position_errors(rt, &t);
    refresh_factor_or_adjoint(rt, &t);
    rt->idle = t.info.corrections == 0;
    rt->near = t.near;
    t.info.inverted = count_inverted(rt);
    if (info) {
        t.info.beyond = network_beyond(net, net->now.history.strain);
        t.info.seconds = realtime_clock() - t.start;
        *info = t.info;
    }
    update_running_mean(&rt->times.rest, realtime_clock() - rest);
    return PALP_OK;
}
