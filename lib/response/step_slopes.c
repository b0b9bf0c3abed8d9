/* step_slopes.c: derivatives carried through a network's steps: first at fixed positions from the elements'
 * histories, then at equilibrium by the step's tangent. */
#include "step_slopes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_status step_slopes_create(palp_network *net, size_t n, size_t n_arms, step_slopes *s) {
    const size_t m = net->n_elements, rows = n * m, arms = n_arms * m;
    *s = (step_slopes){.net = net, .n = n, .m = m, .n_arms = n_arms};
    network_material other;
    for (size_t r = 1; r <= net->n_regions; r++) /* their histories would have slopes too */
        if (network_material_at(net, r, &other) &&
            (other.material->n_arms > 0 || other.material->dashpot_Ns > 0.0))
            return PALP_ERR_UNSUPPORTED;
    s->n_state = rows + n * arms + (net->damage ? rows : 0);
    s->state = calloc(s->n_state + rows + n * arms + ELEMENT_PARTIALS * arms + m + 3 * net->n_nodes,
                      sizeof *s->state);
    if (!s->state)
        return PALP_ERR_NO_MEMORY;
    s->strain = s->state;
    s->arm = s->strain + rows;
    s->peak = net->damage ? s->arm + n * arms : NULL;
    s->partial = s->state + s->n_state;
    s->fixed = s->partial + rows;
    s->by = s->fixed + n * arms;
    s->by_peak = s->by + ELEMENT_PARTIALS * arms;
    s->drive = s->by_peak + m;
    return PALP_OK;
}

void step_slopes_free(step_slopes *s) {
    free(s->state);
}

const double *step_slopes_by(const step_slopes *s, size_t j, element_partial by) {
    return s->by + (j * ELEMENT_PARTIALS + by) * s->m;
}

void step_slopes_begin(step_slopes *s, const double *weight) {
    const palp_network *net = s->net;
    s->weight = weight;
    memcpy(s->drive, net->fint, 3 * net->n_nodes * sizeof *s->drive);
    memset(s->partial, 0, s->n * s->m * sizeof *s->partial);
    for (size_t j = 0; j < s->n_arms; j++)
        element_arm_partials(&net->material, &net->step, j, s->m, net->strain, net->now.history.strain,
                             net->now.history.arm + j * s->m, s->by + j * ELEMENT_PARTIALS * s->m);
}

void step_slopes_carry(step_slopes *s, size_t k) {
    const palp_network *net = s->net;
    double *partial = s->partial + k * s->m;
    const double *strain = s->strain + k * s->m;
    for (size_t i = 0; i < s->m && s->peak; i++)
        partial[i] += s->by_peak[i] * s->peak[k * s->m + i];
    for (size_t i = 0; i < s->m && net->step.dashpot > 0.0; i++)
        partial[i] -= net->step.dashpot * strain[i];
    for (size_t j = 0; j < s->n_arms; j++) {
        const double *arm_old = step_slopes_by(s, j, ELEMENT_ARM_OLD),
                     *strain_old = step_slopes_by(s, j, ELEMENT_STRAIN_OLD);
        const double *arm = s->arm + (k * s->n_arms + j) * s->m;
        double *fixed = s->fixed + (k * s->n_arms + j) * s->m;
        for (size_t i = 0; i < s->m; i++) {
            fixed[i] = arm_old[i] * arm[i] + strain_old[i] * strain[i];
            partial[i] += fixed[i];
        }
    }
}

void step_slopes_add_arm(step_slopes *s, size_t k, size_t j, const effect_arm *own) {
    double *partial = s->partial + k * s->m, *fixed = s->fixed + (k * s->n_arms + j) * s->m;
    const double *stiffness = step_slopes_by(s, j, ELEMENT_LOG_STIFFNESS),
                 *time = step_slopes_by(s, j, ELEMENT_LOG_TIME), *beta = step_slopes_by(s, j, ELEMENT_BETA),
                 *gamma = step_slopes_by(s, j, ELEMENT_GAMMA);
    for (size_t i = 0; i < s->m; i++) {
        double change = own->log_stiffness * stiffness[i] + own->log_time * time[i] + own->beta * beta[i] +
                        own->gamma * gamma[i];
        fixed[i] += change;
        partial[i] += change;
    }
}

double step_slopes_force(const step_slopes *s, size_t k, double stiffer) {
    const palp_network *net = s->net;
    const double *partial = s->partial + k * s->m, *spring = network_foundation(net);
    double sum = s->outer != 0.0 ? -s->outer * network_dot(net->outer, s->drive, 3 * net->n_nodes) : 0.0;
    for (size_t i = 0; i < s->m; i++)
        sum += s->weight[i] * partial[i];
    for (size_t i = 0; i < 3 * net->n_nodes && stiffer != 0.0; i++)
        if (net->dof[i] >= 0)
            sum += stiffer * spring[i] * (net->next.x[i] - net->rest[i]) * s->drive[i];
    return sum;
}

/* Displacement of every node by column k, with that of the plate, into net->fint. */
static void solve_displacement_slopes(step_slopes *s, size_t k, double stiffer, double depth_p) {
    palp_network *net = s->net;
    const double *partial = s->partial + k * s->m, *spring = network_foundation(net);
    double *u = net->fint;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        u[i] = s->outer != 0.0 ? s->outer * net->outer[i] : 0.0;
    for (size_t i = 0; i < s->m; i++)
        for (size_t c = 0; c < 3; c++) {
            double f = partial[i] * net->direction[c * s->m + i] * (net->scale ? net->scale[i] : 1.0) *
                       (net->base_share ? net->base_share[i] : 1.0);
            u[3 * (size_t)net->pair[2 * i] + c] += f;
            u[3 * (size_t)net->pair[2 * i + 1] + c] -= f;
        }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->dx[net->dof[i]] =
                u[i] - (stiffer != 0.0 ? stiffer * spring[i] * (net->next.x[i] - net->rest[i]) : 0.0);
    network_solve(net, net->dx);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        u[i] = depth_p * s->drive[i] + (net->dof[i] >= 0 ? net->dx[net->dof[i]] : 0.0);
}

void step_slopes_equilibrate(step_slopes *s, size_t k, double stiffer, double depth_p) {
    palp_network *net = s->net;
    double *strain = s->strain + k * s->m;
    solve_displacement_slopes(s, k, stiffer, depth_p);
    for (size_t i = 0; i < s->m; i++) {
        const double *a = net->fint + 3 * net->pair[2 * i], *b = net->fint + 3 * net->pair[2 * i + 1];
        const double n[3] = {net->direction[i], net->direction[s->m + i], net->direction[2 * s->m + i]};
        strain[i] =
            (n[0] * (b[0] - a[0]) + n[1] * (b[1] - a[1]) + n[2] * (b[2] - a[2])) * net->inverse_rest[i];
    }
    for (size_t j = 0; j < s->n_arms; j++) {
        const double *by = step_slopes_by(s, j, ELEMENT_STRAIN),
                     *fixed = s->fixed + (k * s->n_arms + j) * s->m;
        double *arm = s->arm + (k * s->n_arms + j) * s->m;
        for (size_t i = 0; i < s->m; i++)
            arm[i] = fixed[i] + by[i] * strain[i];
    }
    for (size_t i = 0; i < s->m && s->peak; i++)
        if (fabs(net->strain[i]) >= net->now.history.peak[i])
            s->peak[k * s->m + i] = copysign(strain[i], strain[i] * net->strain[i]);
}
