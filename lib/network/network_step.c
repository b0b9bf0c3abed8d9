/* network_step.c: one time step: predictor, Newton, fallbacks, stability of the tangent, commit. */
#include "network_internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

void network_place(palp_network *net, double depth) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] < 0)
            net->next.x[i] = net->rest[i] + depth * net->motion[i];
}

/* Extrapolates along s: depth, or time in a dwell. */
bool network_extrapolate(palp_network *net, double depth, double time, bool curved) {
    if (net->n_past == 0)
        return false;
    bool dwell = depth == net->now.depth;
    double s0 = dwell ? net->now.time : net->now.depth, s = dwell ? time : depth;
    double s1 = dwell ? net->past_time[0] : net->past_depth[0];
    double step = s - s0, last = s0 - s1;
    if (!isfinite(s) || !(last * step > 0.0) || fabs(step) > 2.5 * fabs(last) ||
        (dwell && net->past_depth[0] != depth))
        return false;
    double c0 = 1.0 + step / last, c1 = -step / last, c2 = 0.0;
    if (curved && net->n_past > 1 && !(dwell && net->past_depth[1] != depth)) {
        double s2 = dwell ? net->past_time[1] : net->past_depth[1];
        if ((s1 - s2) * step >
            0.01 * last *
                step) { /* a much shorter step, as of a trembling plate, does not show the direction */
            c0 = (s - s1) * (s - s2) / ((s0 - s1) * (s0 - s2));
            c1 = (s - s0) * (s - s2) / ((s1 - s0) * (s1 - s2));
            c2 = (s - s0) * (s - s1) / ((s2 - s0) * (s2 - s1));
        }
    }
    const double *x0 = net->now.x, *x1 = net->past[0], *x2 = net->past[1];
    double *x = net->next.x;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        x[i] = c0 * x0[i] + c1 * x1[i];
    for (size_t i = 0; i < 3 * net->n_nodes && c2 != 0.0; i++)
        x[i] += c2 * x2[i];
    network_place(net, depth);
    return true;
}

/* Linear response of the last state to the plate's motion. ERR_SINGULAR: the tangent is singular, as that of
 * a mechanism at rest. */
static palp_status predict_along_tangent(palp_network *net, double depth) {
    int negative;
    double scale, move = depth - net->now.depth;
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    bool sound = network_evaluate(net);
    if (move == 0.0)
        return sound ? PALP_OK : PALP_ERR_COLLAPSED;
    if (sound) {
        palp_status status = network_factor(net, 0.0, &negative);
        if (status)
            return status;
        network_residual(net, &scale);
        network_drive_column(net, net->dx);
        for (size_t i = 0; i < net->n_free; i++)
            net->dx[i] = net->rhs[i] + move * net->dx[i];
        network_solve(net, net->dx);
        net->factored = true;
        network_place(net, depth);
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            if (net->dof[i] >= 0)
                net->next.x[i] = net->now.x[i] + net->dx[net->dof[i]];
        if (network_evaluate(net))
            return PALP_OK;
    }
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    network_place(net, depth);
    return network_evaluate(net) ? PALP_OK : PALP_ERR_COLLAPSED;
}

bool network_refresh(palp_network *net) {
    bool any = false;
    for (size_t i = 0; i < net->n_terms; i++)
        if (net->terms[i]->kind->refresh)
            any = net->terms[i]->kind->refresh(net->terms[i], net) || any;
    return any;
}

double network_longest_way(const palp_network *net) {
    double longest = 0.0;
    for (size_t i = 0; i < net->n_terms; i++)
        if (net->terms[i]->kind->way)
            longest = fmax(longest, net->terms[i]->kind->way(net->terms[i], net));
    return longest;
}

/* Newton iteration; repeated from there if terms had to find new contact points. */
static palp_status find_equilibrium(palp_network *net, palp_step_info *info) {
    enum { ROUNDS = 5 };
    palp_status status = network_newton(net, info);
    for (int i = 0; i < ROUNDS && !status && network_refresh(net); i++)
        status = network_evaluate(net) ? network_newton(net, info) : PALP_ERR_COLLAPSED;
    return status;
}

/* Moves plate and terms in parts, none longer than terms can be followed at once. Each part starts from the
 * secant through the last two. History and time are those of the whole step: this only finds a better start
 * for Newton's iteration. */
static palp_status approach_target_in_parts(palp_network *net, double depth, double way,
                                            palp_step_info *info) {
    size_t size = 3 * net->n_nodes * sizeof(double);
    double reached = 0.0, before = 0.0, part = fmin(0.25, 1.0 / way);
    const double least = part / 512.0;
    memcpy(net->way[0], net->now.x, size);
    palp_status status = PALP_ERR_NOT_CONVERGED;
    while (part >= least && reached != 1.0) {
        double target = 1.0 - reached <= 1.0001 * part ? 1.0 : reached + part;
        double ahead = reached != before ? (target - reached) / (reached - before) : 0.0;
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            net->next.x[i] = net->way[0][i] + (ahead > 0.0 ? ahead * (net->way[0][i] - net->way[1][i]) : 0.0);
        network_place(net, target == 1.0 ? depth : net->now.depth + target * (depth - net->now.depth));
        NETWORK_EACH_TERM(net, place, net, target);
        status = network_evaluate(net) ? find_equilibrium(net, info) : PALP_ERR_COLLAPSED;
        if (status) {
            part *= 0.25;
            continue;
        }
        memcpy(net->way[1], net->way[0], size);
        memcpy(net->way[0], net->next.x, size);
        before = reached;
        reached = target;
        part = fmin(1.5 * part, 1.0 / way);
    }
    return status;
}

/* From the last state, in parts if terms move farther than they can be followed at once. */
static palp_status solve_from_last_state(palp_network *net, double depth, palp_step_info *info) {
    const double way = network_longest_way(net);
    palp_status status = way > 1.0 ? PALP_ERR_NOT_CONVERGED : predict_along_tangent(net, depth);
    if (!status)
        status = find_equilibrium(net, info);
    if (status && status != PALP_ERR_NO_MEMORY && status != PALP_ERR_SINGULAR &&
        (depth != net->now.depth || way > 0.0) && !net->no_approach)
        status = approach_target_in_parts(net, depth, way, info);
    return status;
}

/* From the extrapolated state; if that fails, from the last one. */
static palp_status solve_from_extrapolation(palp_network *net, double depth, double time,
                                            palp_step_info *info) {
    palp_status status = PALP_ERR_NOT_CONVERGED;
    bool extrapolated = network_longest_way(net) <= 1.0 && network_extrapolate(net, depth, time, true) &&
                        network_evaluate(net);
    if (extrapolated)
        status = find_equilibrium(net, info);
    if (status && status != PALP_ERR_NO_MEMORY && !(extrapolated && net->no_approach)) {
        if (extrapolated)
            NETWORK_EACH_TERM(net, begin, net);
        status = solve_from_last_state(net, depth, info);
    }
    return status;
}

static bool has_any_tool_path(const palp_network *net) {
    bool any = false;
    for (size_t i = 0; i < net->n_terms; i++)
        any = any || net->terms[i]->kind->way;
    return any;
}

/* Tissue that slides off a tool snaps: where its branch ends or turns unstable, solves again for a stable
 * one. */
static palp_status solve_to_stable_branch(palp_network *net, double depth, double time,
                                          palp_step_info *info) {
    const palp_branch own = net->settings.branch;
    palp_status status = solve_from_extrapolation(net, depth, time, info);
    const bool ended = status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED ||
                       status == PALP_ERR_COLLAPSED || (!status && info->negative_pivots > 0);
    if (!ended || own != PALP_BRANCH_CONTINUE || net->no_approach || net->ranks || !has_any_tool_path(net))
        return status;
    net->settings.branch = PALP_BRANCH_STABLE;
    NETWORK_EACH_TERM(net, begin, net);
    status = solve_from_last_state(net, depth, info);
    net->settings.branch = own;
    net->left_branch = true;
    return status;
}

/* Assesses the inertia of the tangent at the solution: when Newton first met a negative pivot, or when the
 * plate has moved by check_strain since the last time. */
static void assess_tangent_stability(palp_network *net, palp_step_info *info) {
    bool due = fabs(net->next.depth - net->checked_depth) >= net->settings.check_strain * net->height;
    if (!net->ranks && !net->buckled && (info->negative_pivots > 0 || (info->negative_pivots < 0 && due))) {
        int negative;
        palp_status status = network_factor(net, 0.0, &negative);
        info->negative_pivots = status ? 1 : negative;
        net->factored = net->exact = !status;
    }
    net->trial_checked = info->negative_pivots >= 0;
    net->trial_stable = info->negative_pivots == 0 && !net->left_branch;
}

static palp_status check_step_arguments(const palp_network *net, double depth, double dt) {
    const palp_material *m = &net->material;
    bool rate = network_has_dashpot(net) || net->mass || (m->formulation == PALP_SEDEF2008 && m->n_arms > 0);
    return !isfinite(depth) || !(dt >= 0.0) || (dt == 0.0 && rate) ? PALP_ERR_ARGUMENT : PALP_OK;
}

/* Initial accelerations: at time 0 no step has determined the forces on the nodes. */
static void set_initial_accelerations(palp_network *net) {
    network_state *s = &net->now;
    memcpy(net->next.x, s->x, 3 * net->n_nodes * sizeof *s->x);
    if (!network_evaluate(net))
        return;
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        s->inner[i] = net->fint[i] + net->outer[i];
        s->acceleration[i] =
            net->dof[i] >= 0 && net->mass[i / 3] > 0.0 ? s->inner[i] / net->mass[i / 3] : 0.0;
    }
    NETWORK_EACH_TERM(net, begin, net);
}

palp_status network_begin(palp_network *net, double depth_m, double dt_s) {
    net->trial = net->exact = net->left_branch = false;
    palp_status status = check_step_arguments(net, depth_m, dt_s);
    if (status)
        return status;
    element_step_prepare(&net->material, dt_s, &net->step);
    net->step.rate_factor = net->rate_factor;
    net->step.damage = net->damage;
    double modulus[PALP_REGIONS_MAX + 1];
    network_stiffnesses(net, 0.0, true, modulus);
    net->modulus = modulus[0];
    for (size_t r = 0; r < net->n_regions; r++) {
        net->region[r].modulus = modulus[r + 1];
        if (net->region[r].share)
            element_step_prepare(&net->region[r].given.own_material, dt_s, &net->region[r].step);
    }
    NETWORK_EACH_TERM(net, begin, net);
    if (net->mass && net->settings.integrator == PALP_GENERALIZED_ALPHA && net->now.time == 0.0 &&
        isfinite(dt_s))
        set_initial_accelerations(net);
    network_set_diagonal(net, 0.0);
    net->next.depth = depth_m;
    net->next.time = net->now.time + (isinf(dt_s) ? 0.0 : dt_s);
    return PALP_OK;
}

palp_status network_finish(palp_network *net) {
    net->next.force = network_drive_force(net);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.inner[i] = net->fint[i] + net->outer[i];
    if (net->own_force)
        memcpy(net->next.element, net->own_force, net->n_elements * sizeof *net->own_force);
    if (net->step.carry > 0.0)
        for (size_t i = 0; i < net->n_elements; i++)
            for (size_t k = 0; k < 3; k++)
                net->next.element[i] +=
                    net->step.carry * net->now.vector[3 * i + k] * net->direction[k * net->n_elements + i];
    NETWORK_EACH_TERM(net, finish, net);
    palp_status status = PALP_OK;
    for (size_t i = 0; i < net->n_terms && !status; i++)
        if (net->terms[i]->kind->check)
            status = net->terms[i]->kind->check(net->terms[i], net);
    return status;
}

/* Are all edges of a tetrahedron uncut? */
static bool is_tetrahedron_uncut(const palp_network *net, const int32_t *t) {
    for (int a = 0; a < 4; a++)
        for (int b = a + 1; b < 4; b++) {
            size_t e = palp_mesh_element_between(net->mesh, t[a], t[b]);
            if (net->n_dead > 0 && e < net->n_elements && net->scale[e] == 0.0)
                return false;
        }
    return true;
}

size_t network_count_inverted(const palp_network *net, const double *x, size_t part, size_t parts) {
    const size_t m = palp_mesh_tetrahedron_count(net->mesh);
    const int32_t *t = palp_mesh_tetrahedra(net->mesh);
    size_t n = 0;
    for (size_t i = m * part / parts; i < m * (part + 1) / parts; i++)
        n += mesh_volume6(x, t + 4 * i) <= 0.0 && is_tetrahedron_uncut(net, t + 4 * i);
    return n;
}

double network_largest_strain(const palp_network *net, const double *strain) {
    double largest = 0.0;
    for (size_t i = 0; i < net->n_elements; i++)
        if (net->n_dead == 0 || net->scale[i] != 0.0)
            largest = fmax(largest, fabs(strain[i]));
    return largest;
}

double palp_network_strain_max(const palp_network *net) {
    return net ? network_largest_of_parts(net, network_largest_strain(net, net->now.history.strain)) : 0.0;
}

palp_status palp_network_try(palp_network *net, double depth_m, double dt_s, palp_step_info *info) {
    if (!net)
        return PALP_ERR_ARGUMENT;
    palp_step_info local = {.negative_pivots = -1};
    palp_status status = network_begin(net, depth_m, dt_s);
    if (status)
        return status;
    status = solve_to_stable_branch(net, depth_m, net->next.time, &local);
    if (!status)
        status = network_finish(net);
    if (!status) {
        local.force_N = net->next.force;
        local.inverted =
            (size_t)network_sum_of_parts(net, (double)network_count_inverted(net, net->next.x, 0, 1));
        local.beyond = network_beyond(net, net->next.history.strain);
        assess_tangent_stability(net, &local);
        net->trial = true;
    } else {
        net->factored = false;
    }
    if (info)
        *info = local;
    return status;
}

void palp_network_commit(palp_network *net) {
    if (!net || !net->trial)
        return;
    double *spare = net->past[1];
    net->past[1] = net->past[0];
    net->past_depth[1] = net->past_depth[0];
    net->past_time[1] = net->past_time[0];
    net->past[0] = net->now.x;
    net->past_depth[0] = net->now.depth;
    net->past_time[0] = net->now.time;
    net->n_past += net->n_past < NETWORK_PAST;
    net->now.x = spare;
    network_state old = net->now;
    net->now = net->next;
    net->next = old;
    NETWORK_EACH_TERM(net, swap, net);
    net->trial = false;
    if (net->trial_checked && !net->buckled) {
        net->buckled = !net->trial_stable;
        if (net->trial_stable)
            net->checked_depth = net->now.depth;
        else
            net->unstable_depth = net->now.depth;
    }
}

palp_status palp_network_step(palp_network *net, double depth_m, double dt_s, palp_step_info *info) {
    if (!net)
        return PALP_ERR_ARGUMENT;
    palp_status status = palp_network_try(net, depth_m, dt_s, info);
    if (!status)
        palp_network_commit(net);
    return status;
}

palp_status palp_network_step_force(palp_network *net, double force_N, double dt_s, palp_step_info *info) {
    if (!net)
        return PALP_ERR_ARGUMENT;
    enum { ROUNDS = 40 };
    palp_step_info local = {0}, total = {0};
    double depth = net->now.depth, stiffness = 0.0;
    if (!isfinite(force_N) || !net->driven)
        return PALP_ERR_ARGUMENT;
    for (int i = 0; i < ROUNDS; i++) {
        palp_status status = palp_network_try(net, depth, dt_s, &local);
        total.iterations += local.iterations;
        local.iterations = total.iterations;
        if (!status &&
            fabs(local.force_N - force_N) <= 1e-10 * fabs(force_N) + 1e-14 * stiffness * net->extent) {
            palp_network_commit(net);
            if (info)
                *info = local;
            return PALP_OK;
        }
        if (!status)
            status = network_weights(net, net->scratch, &stiffness);
        if (!status && !(stiffness > 0.0))
            status = PALP_ERR_BUCKLED;
        net->trial = false;
        if (status)
            return status;
        double limit = 0.1 * net->extent, move = (force_N - local.force_N) / stiffness;
        depth += fmax(-limit, fmin(limit, move));
    }
    return PALP_ERR_NOT_CONVERGED;
}
