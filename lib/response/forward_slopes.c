/* forward_slopes.c: derivatives of a network's force by all parameters of the model, carried through its steps:
 * at fixed positions from the elements' histories, then at equilibrium by the tangent of the step. */
#include "forward_internal.h"
#include "network/network_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By columns and elements: [n m], arms [n n_arms m]. */
struct forward_slopes {
    const forward_plan *plan;
    palp_network *net;
    size_t n_spectra;
    const forward_spectrum *spectrum;
    size_t n, m, n_arms, n_state;
    unsigned char *alive; /* [n] the column has moved an element, or may do so itself */
    double *strain, *peak, *arm; /* of the state, one after the other; peak NULL: the springs are not damaged */
    double *kept;                /* [n_state] a copy of them */
    double *partial, *fixed;     /* of the trial: element force and arms with the nodes held */
    double *by;                  /* [n_arms ELEMENT_PARTIALS m] of the arms, by element_arm_partials */
    double *by_peak, *by_time;   /* [m] of the element force */
    double *drive;               /* [3 n_nodes] displacement per depth */
    double *row;                 /* [n] scratch */
    const double *weight;        /* caller's */
    double stiffness;
};

/* ---- what a parameter changes itself ---- */

/* Whether it changes an element or what holds the nodes, and not what stands around the specimen. */
static bool may_move(const forward_slopes *s, const effect_row *row) {
    return row->arm || row->arms || row->spring || row->history || row->spectrum || (row->foundation && network_foundation(s->net));
}

static void find_alive(forward_slopes *s) {
    const palp_model *model = s->plan->model;
    size_t column = forward_effect_column(model, 0);
    memset(s->alive, 1, column);
    for (size_t i = 0; i < model->n_effects; i++) {
        size_t end = forward_effect_column(model, i + 1);
        memset(s->alive + column, may_move(s, effect_row_of(model->effects[i].id)), end - column);
        column = end;
    }
}

/* The elements' partials of arm j by one of element_partial. */
static const double *by_of(const forward_slopes *s, size_t j, element_partial by) {
    return s->by + (j * ELEMENT_PARTIALS + by) * s->m;
}

/* partial = the springs' own, nodes and histories held. */
static void spring_partials(forward_slopes *s, const effect_number *of_effect) {
    const palp_network *net = s->net;
    const bool damaged = net->damage != NULL;
    memset(s->partial, 0, s->n * s->m * sizeof *s->partial);
    for (size_t i = 0; i < s->m; i++) {
        double peak = damaged ? net->now.history.peak[i] : 0.0;
        element_damaged spring = {.inner = net->strain[i], .factor = 1.0, .force = net->next.history.elastic[i]};
        if (damaged)
            element_damage_force(&net->material.law, net->damage, net->strain[i], peak, &spring);
        memset(s->row, 0, s->n * sizeof *s->row);
        forward_spring_own(s->plan, &spring, peak, net->step.rate_factor, of_effect, s->row);
        for (size_t k = 0; k < s->n; k++)
            s->partial[k * s->m + i] = s->row[k];
        s->by_peak[i] = net->step.rate_factor * spring.by_peak;
    }
}

/* Adds what column k changes of arm j itself. */
static void add_own(forward_slopes *s, size_t k, size_t j, const effect_arm *by) {
    double *partial = s->partial + k * s->m, *fixed = s->fixed + (k * s->n_arms + j) * s->m;
    const double *stiffness = by_of(s, j, ELEMENT_LOG_STIFFNESS), *time = by_of(s, j, ELEMENT_LOG_TIME),
                 *beta = by_of(s, j, ELEMENT_BETA), *gamma = by_of(s, j, ELEMENT_GAMMA);
    for (size_t i = 0; i < s->m; i++) {
        double own = by->log_stiffness * stiffness[i] + by->log_time * time[i] + by->beta * beta[i] + by->gamma * gamma[i];
        fixed[i] += own;
        partial[i] += own;
    }
}

static void arm_own(forward_slopes *s, size_t j) {
    forward_arm_slope own[FORWARD_ARM_SLOPES];
    const size_t n = forward_arm_slopes(s->plan, j, own);
    for (size_t i = 0; i < n; i++)
        add_own(s, own[i].column, j, &own[i].by);
}

static void quasi_linear_own(forward_slopes *s, size_t j) {
    const palp_network *net = s->net;
    const palp_law *law = &net->material.law;
    for (size_t i = 0; i < s->m; i++) {
        const double e[2] = {net->now.history.strain[i], net->strain[i]};
        memset(s->row, 0, law->n * sizeof *s->row);
        forward_quasi_linear_own(law, e, by_of(s, j, ELEMENT_DRIVE)[i], s->row);
        for (size_t k = 0; k < law->n; k++) {
            s->partial[k * s->m + i] += s->row[k];
            s->fixed[(k * s->n_arms + j) * s->m + i] += s->row[k];
        }
    }
}

static void spectrum_own(forward_slopes *s, const forward_spectrum *g) {
    for (size_t i = 0; i < g->n; i++)
        for (size_t v = 0; v < g->n_values; v++) {
            const effect_arm by = {
                .log_stiffness = g->mode[i].weight_by[v] / s->net->material.arms[g->first + i].stiffness_N,
                .log_time = -g->mode[i].rate_by[v] / g->mode[i].rate};
            add_own(s, g->column + v, g->first + i, &by);
        }
}

/* ---- what the histories carry ---- */

static void carry(forward_slopes *s, size_t k) {
    const palp_network *net = s->net;
    double *partial = s->partial + k * s->m;
    const double *strain = s->strain + k * s->m;
    for (size_t i = 0; i < s->m && s->peak; i++)
        partial[i] += s->by_peak[i] * s->peak[k * s->m + i];
    for (size_t i = 0; i < s->m && net->step.dashpot > 0.0; i++)
        partial[i] -= net->step.dashpot * strain[i];
    for (size_t j = 0; j < s->n_arms; j++) {
        const double *arm_old = by_of(s, j, ELEMENT_ARM_OLD), *strain_old = by_of(s, j, ELEMENT_STRAIN_OLD);
        const double *arm = s->arm + (k * s->n_arms + j) * s->m;
        double *fixed = s->fixed + (k * s->n_arms + j) * s->m;
        for (size_t i = 0; i < s->m; i++) {
            fixed[i] = arm_old[i] * arm[i] + strain_old[i] * strain[i];
            partial[i] += fixed[i];
        }
    }
}

static void time_partials(forward_slopes *s) {
    const palp_network *net = s->net;
    const double dt = net->step.dt;
    for (size_t i = 0; i < s->m; i++) {
        s->by_time[i] = -net->step.dashpot * (net->strain[i] - net->now.history.strain[i]);
        for (size_t j = 0; j < s->n_arms; j++)
            s->by_time[i] -= by_of(s, j, ELEMENT_LOG_TIME)[i];
        s->by_time[i] = dt > 0.0 ? s->by_time[i] / dt : 0.0;
    }
}

void forward_slopes_find(forward_slopes *s, const double *weight, double stiffness,
                         const effect_number *of_effect) {
    const palp_network *net = s->net;
    s->weight = weight;
    s->stiffness = stiffness;
    memcpy(s->drive, net->fint, 3 * net->n_nodes * sizeof *s->drive);
    for (size_t j = 0; j < s->n_arms; j++)
        element_arm_partials(&net->material, &net->step, j, s->m, net->strain, net->now.history.strain,
                             net->now.history.arm + j * s->m, s->by + j * ELEMENT_PARTIALS * s->m);
    spring_partials(s, of_effect);
    for (size_t k = 0; k < s->n; k++)
        if (s->alive[k])
            carry(s, k);
    size_t plain = s->n_spectra ? s->spectrum[0].first : s->n_arms;
    for (size_t j = 0; j < plain; j++)
        arm_own(s, j);
    for (size_t j = 0; j < s->n_arms && net->material.quasi_linear; j++)
        quasi_linear_own(s, j);
    for (size_t g = 0; g < s->n_spectra; g++)
        spectrum_own(s, &s->spectrum[g]);
    time_partials(s);
}

/* ---- at equilibrium ---- */

/* d log foundation / d parameter k. */
static double foundation_slope(const forward_slopes *s, size_t k) {
    const palp_law *law = &s->net->material.law;
    const double small = 1e-9;
    double start, row[PALP_LAW_MAX];
    if (!network_foundation(s->net))
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

static double force_slope(const forward_slopes *s, size_t k) {
    const palp_network *net = s->net;
    const double *partial = s->partial + k * s->m, stiffer = foundation_slope(s, k), *spring = network_foundation(s->net);
    double sum = 0.0;
    for (size_t i = 0; i < s->m; i++)
        sum += s->weight[i] * partial[i];
    for (size_t i = 0; i < 3 * net->n_nodes && stiffer != 0.0; i++)
        if (net->dof[i] >= 0)
            sum += stiffer * spring[i] * (net->next.x[i] - net->rest[i]) * s->drive[i];
    return sum;
}

void forward_slopes_hold(forward_slopes *s, double *force_p, double *force_dt) {
    for (size_t k = 0; k < s->n; k++)
        force_p[k] = s->alive[k] ? force_slope(s, k) : 0.0;
    *force_dt = 0.0;
    for (size_t i = 0; i < s->m; i++)
        *force_dt += s->weight[i] * s->by_time[i];
}

/* Displacement of every node by parameter k, the plate's own included, into net->fint. */
static void displace(forward_slopes *s, size_t k, double depth_p) {
    palp_network *net = s->net;
    const double *partial = s->partial + k * s->m, stiffer = foundation_slope(s, k), *spring = network_foundation(s->net);
    double *u = net->fint;
    memset(u, 0, 3 * net->n_nodes * sizeof *u);
    for (size_t i = 0; i < s->m; i++)
        for (size_t c = 0; c < 3; c++) {
            double f = partial[i] * net->direction[3 * i + c] * (net->scale ? net->scale[i] : 1.0);
            u[3 * (size_t)net->pair[2 * i] + c] += f;
            u[3 * (size_t)net->pair[2 * i + 1] + c] -= f;
        }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->dx[net->dof[i]] = u[i] - (stiffer != 0.0 ? stiffer * spring[i] * (net->next.x[i] - net->rest[i]) : 0.0);
    linsys_solve(net->ls, net->dx);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        u[i] = depth_p * s->drive[i] + (net->dof[i] >= 0 ? net->dx[net->dof[i]] : 0.0);
}

/* The state's derivatives by parameter k become the trial's. */
static void equilibrate(forward_slopes *s, size_t k, double depth_p) {
    palp_network *net = s->net;
    double *strain = s->strain + k * s->m;
    displace(s, k, depth_p);
    for (size_t i = 0; i < s->m; i++) {
        const double *n = net->direction + 3 * i, *a = net->fint + 3 * net->pair[2 * i],
                     *b = net->fint + 3 * net->pair[2 * i + 1];
        strain[i] = (n[0] * (b[0] - a[0]) + n[1] * (b[1] - a[1]) + n[2] * (b[2] - a[2])) * net->inverse_rest[i];
    }
    for (size_t j = 0; j < s->n_arms; j++) {
        const double *by = by_of(s, j, ELEMENT_STRAIN), *fixed = s->fixed + (k * s->n_arms + j) * s->m;
        double *arm = s->arm + (k * s->n_arms + j) * s->m;
        for (size_t i = 0; i < s->m; i++)
            arm[i] = fixed[i] + by[i] * strain[i];
    }
    for (size_t i = 0; i < s->m && s->peak; i++)
        if (fabs(net->strain[i]) >= net->now.history.peak[i])
            s->peak[k * s->m + i] = copysign(strain[i], strain[i] * net->strain[i]);
}

static void add_time(forward_slopes *s, size_t k, double dt_p) {
    for (size_t i = 0; i < s->m; i++)
        s->partial[k * s->m + i] += dt_p * s->by_time[i];
    for (size_t j = 0; j < s->n_arms && s->net->step.dt > 0.0; j++)
        for (size_t i = 0; i < s->m; i++)
            s->fixed[(k * s->n_arms + j) * s->m + i] -= dt_p / s->net->step.dt * by_of(s, j, ELEMENT_LOG_TIME)[i];
}

void forward_slopes_advance(forward_slopes *s, const double *strain_p, const double *dt_p, double *force_p) {
    for (size_t k = 0; k < s->n; k++) {
        double depth_p = strain_p ? strain_p[k] * s->net->height : 0.0;
        force_p[k] = 0.0;
        if (!s->alive[k] && depth_p == 0.0 && (!dt_p || dt_p[k] == 0.0))
            continue;
        s->alive[k] = 1;
        if (dt_p && dt_p[k] != 0.0)
            add_time(s, k, dt_p[k]);
        force_p[k] = force_slope(s, k) + s->stiffness * depth_p;
        equilibrate(s, k, depth_p);
    }
}

/* ---- making them ---- */

static void carve(forward_slopes *s, double *block) {
    const size_t rows = s->n * s->m, arms = s->n_arms * s->m;
    s->strain = block;
    s->arm = s->strain + rows;
    s->peak = s->net->damage ? s->arm + s->n * arms : NULL;
    s->kept = block + s->n_state;
    s->partial = s->kept + s->n_state;
    s->fixed = s->partial + rows;
    s->by = s->fixed + s->n * arms;
    s->by_peak = s->by + ELEMENT_PARTIALS * arms;
    s->by_time = s->by_peak + s->m;
    s->drive = s->by_time + s->m;
    s->row = s->drive + 3 * s->net->n_nodes;
}

palp_status forward_slopes_create(const forward_plan *plan, palp_network *net, size_t n_spectra,
                                  const forward_spectrum *spectrum, forward_slopes **slopes) {
    forward_slopes *s = calloc(1, sizeof *s);
    if (!s)
        return PALP_ERR_NO_MEMORY;
    *s = (forward_slopes){.plan = plan, .net = net, .n_spectra = n_spectra, .spectrum = spectrum,
                          .n = plan->n_columns, .m = net->n_elements, .n_arms = net->material.n_arms};
    size_t rows = s->n * s->m, arms = s->n_arms * s->m;
    s->n_state = rows + s->n * arms + (net->damage ? rows : 0);
    double *block = calloc(2 * s->n_state + rows + s->n * arms + ELEMENT_PARTIALS * arms + 2 * s->m + 3 * net->n_nodes + s->n + 1,
                           sizeof *block);
    s->alive = malloc(s->n + 1);
    if (!block || !s->alive) {
        free(block);
        free(s->alive);
        free(s);
        return PALP_ERR_NO_MEMORY;
    }
    carve(s, block);
    find_alive(s);
    *slopes = s;
    return PALP_OK;
}

void forward_slopes_free(forward_slopes *s) {
    if (!s)
        return;
    free(s->strain);
    free(s->alive);
    free(s);
}

void forward_slopes_keep(forward_slopes *s, bool back) {
    memcpy(back ? s->strain : s->kept, back ? s->kept : s->strain, s->n_state * sizeof *s->kept);
}

void forward_slopes_take_history(forward_slopes *s, const double *peak_p) {
    memcpy(s->peak, peak_p, s->n * s->m * sizeof *s->peak);
    for (size_t k = 0; k < s->n; k++)
        for (size_t i = 0; i < s->m && !s->alive[k]; i++)
            s->alive[k] = peak_p[k * s->m + i] != 0.0;
}

const double *forward_slopes_history(const forward_slopes *s) {
    return s->peak;
}
