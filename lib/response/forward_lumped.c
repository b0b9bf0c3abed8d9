/* forward_lumped.c: the lumped specimen of the forward model, with derivatives by all parameters. */
#include "forward_internal.h"
#include "material/law_internal.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { MODES = FORWARD_SPECTRA * EFFECT_MODES_MAX };

/* Unit responses u parallel to the spring, du/dt + rate u = de/dt; each adds weight u to the force. */
typedef struct modes {
    size_t n;
    double weight[MODES], rate[MODES];
    double decay[MODES], mean[MODES]; /* of the step: exp(-x) and (1 - exp(-x)) / x, x = rate dt */
    double weight_by[PALP_EFFECT_PARAMETERS][MODES], rate_by[PALP_EFFECT_PARAMETERS][MODES];
    bool timed[MODES]; /* the rate depends on a parameter */
    double dt;         /* of decay and mean, to ten digits: even samples differ by rounding */
} modes;

/* Modes of one effect: [first, end). */
typedef struct mode_group {
    size_t first, end, column, n_values;
} mode_group;

typedef struct state {
    double strain, elastic, peak;
    double arm[PALP_ARMS_MAX], unit[MODES];
} state;

/* Rows of derivatives, each [n_columns]. */
typedef struct slopes {
    double *strain, *peak, *arm, *unit; /* arm[n_arms n_columns], unit[modes.n n_columns] */
    double *row, *zero;
} slopes;

struct forward_lumped {
    const forward_plan *plan;
    size_t n_columns;
    modes modes;
    size_t n_groups;
    mode_group group[FORWARD_SPECTRA];
    element_step step;
    element_steps steps; /* prepared earlier */
    bool prepared;
    state now, next;
    slopes d;
    bool still; /* no parameter has moved the surface yet: modes without timed have no derivatives */
    element_damaged spring;                    /* of the trial, if derivatives are needed */
    effect_number of_effect[PALP_EFFECTS_MAX]; /* at the trial's rate */
};

/* ---- values ---- */

static void prepare_step_of_length(forward_lumped *l, double dt) {
    modes *m = &l->modes;
    if (!l->prepared || dt != l->step.dt)
        l->step = *element_steps_of(&l->plan->material, dt, &l->steps);
    bool same = l->prepared && fabs(dt - m->dt) <= 1e-10 * dt;
    l->prepared = true;
    if (same)
        return;
    m->dt = dt;
    for (size_t i = 0; i < m->n; i++)
        element_decay(m->rate[i] * dt, &m->decay[i], &m->mean[i]);
}

/* Force of the modes after the trial, and its derivative by strain. */
static double advance_relaxation_modes(forward_lumped *l, double rise, double *slope) {
    const modes *m = &l->modes;
    const double *old = l->now.unit;
    double *unit = l->next.unit, force = 0.0;
    for (size_t i = 0; i < m->n; i++) {
        unit[i] = m->decay[i] * old[i] + m->mean[i] * rise;
        force += m->weight[i] * unit[i];
        *slope += m->weight[i] * m->mean[i];
    }
    return force;
}

static palp_status try_lumped_strain(void *self, const forward_move *move, double *force, double *slope) {
    forward_lumped *l = self;
    const palp_material *m = &l->plan->material;
    double by_strain, rise = move->strain - l->now.strain;
    if (!isfinite(move->strain) || !(move->dt >= 0.0) || (move->dt == 0.0 && m->dashpot_Ns > 0.0))
        return PALP_ERR_ARGUMENT;
    prepare_step_of_length(l, move->dt);
    element_history old = {&l->now.strain, &l->now.elastic, l->now.arm, &l->now.peak, 1};
    element_history new = {&l->next.strain, &l->next.elastic, l->next.arm, &l->next.peak, 1};
    l->step.rate_factor = forward_rate_factor(l->plan, move->rate, l->of_effect);
    l->step.damage = l->plan->damaged ? &l->plan->damage : NULL;
    element_trial(m, &l->step, 1, &move->strain, &old, &new, force, &by_strain);
    if (l->modes.n)
        *force += advance_relaxation_modes(l, rise, &by_strain);
    if (slope)
        *slope = by_strain;
    return PALP_OK;
}

/* ---- derivatives ---- */

static void evaluate_trial_spring(forward_lumped *l) {
    const palp_law *law = &l->plan->material.law;
    double e = l->next.strain;
    if (l->plan->damaged) {
        element_damage_force(law, &l->plan->damage, e, l->now.peak, &l->spring);
        return;
    }
    l->spring = (element_damaged){.inner = e, .factor = 1.0};
    palp_law_force(law, 1, &e, &l->spring.force, &l->spring.by_strain, NULL);
}

void forward_spring_own(const forward_plan *plan, const element_damaged *s, double peak_strain,
                        double rate_factor, const effect_number *of_effect, double *force_p) {
    const palp_law *law = &plan->material.law;
    double row[PALP_LAW_MAX], inner[PALP_LAW_MAX], peak[PALP_LAW_MAX], force = s->force / s->factor;
    palp_law_gradient(law, s->inner, row);
    for (size_t k = 0; k < law->n; k++)
        force_p[k] += rate_factor * s->factor * row[k];
    if (s->factor_by_energy != 0.0) {
        law_energy_gradient(law, s->inner, inner);
        law_energy_gradient(law, peak_strain, peak);
        for (size_t k = 0; k < law->n; k++)
            force_p[k] +=
                rate_factor * force * (s->factor_by_energy * inner[k] + s->factor_by_peak_energy * peak[k]);
    }
    for (size_t i = 0; i < plan->n_effects; i++) {
        const forward_effect *f = &plan->effect[i];
        for (size_t k = 0; f->row->spring && k < f->row->info.n_parameters; k++)
            force_p[f->column + k] += of_effect[i].by_value[k] * rate_factor / of_effect[i].value * s->force;
    }
    for (size_t i = 0; i < plan->n_damage_slopes; i++) {
        const element_damage *by = &plan->damage_slope[i].by;
        force_p[plan->damage_slope[i].column] +=
            rate_factor *
            (by->set * s->by_set + by->softening * s->by_softening + by->sharpness * s->by_sharpness);
    }
}

static void partial_derivatives_of_arm(const forward_lumped *l, size_t j, double partial[ELEMENT_PARTIALS]) {
    element_arm_partials(&l->plan->material, &l->step, j, 1, &l->next.strain, &l->now.strain, &l->now.arm[j],
                         partial);
}

void forward_quasi_linear_own(const palp_law *law, const double e[2], double drive, double *row) {
    double start, elastic[2], by[2][PALP_LAW_MAX], by_start[PALP_LAW_MAX], small = 1e-9;
    palp_law_stiffness(law, 0.0, &start, NULL);
    palp_law_force(law, 2, e, elastic, NULL, NULL);
    palp_law_gradient(law, e[0], by[0]);
    palp_law_gradient(law, e[1], by[1]);
    palp_law_gradient(law, small, by_start);
    for (size_t k = 0; k < law->n; k++)
        row[k] +=
            drive / start * (by[1][k] - by[0][k] - (elastic[1] - elastic[0]) / start * by_start[k] / small);
}

/* Derivatives of arm j's force at the end of the trial, into row, which may hold the old ones. */
static void propagate_arm_slopes(const forward_lumped *l, size_t j, const double *strain_p,
                                 const double *dt_p, double *row) {
    const double *old = l->d.arm + j * l->n_columns, *strain_old = l->d.strain;
    double p[ELEMENT_PARTIALS];
    forward_arm_slope own[FORWARD_ARM_SLOPES];
    partial_derivatives_of_arm(l, j, p);
    for (size_t k = 0; k < l->n_columns; k++)
        row[k] = p[ELEMENT_ARM_OLD] * old[k] + p[ELEMENT_STRAIN] * strain_p[k] +
                 p[ELEMENT_STRAIN_OLD] * strain_old[k];
    const size_t n = forward_arm_slopes(l->plan, j, own);
    for (size_t i = 0; i < n; i++) {
        const effect_arm *by = &own[i].by;
        row[own[i].column] += by->log_stiffness * p[ELEMENT_LOG_STIFFNESS] +
                              by->log_time * p[ELEMENT_LOG_TIME] + by->beta * p[ELEMENT_BETA] +
                              by->gamma * p[ELEMENT_GAMMA];
    }
    if (l->plan->material.quasi_linear)
        forward_quasi_linear_own(&l->plan->material.law, (double[2]){l->now.strain, l->next.strain},
                                 p[ELEMENT_DRIVE], row);
    for (size_t k = 0; dt_p && k < l->n_columns; k++)
        row[k] -= p[ELEMENT_LOG_TIME] / l->step.dt * dt_p[k];
}

/* d unit / d (rate dt) of the trial. */
static double mode_derivative_by_rate(const forward_lumped *l, size_t i) {
    const modes *m = &l->modes;
    double turn = element_mean_slope(m->rate[i] * l->step.dt, m->decay[i], m->mean[i]);
    return turn * (l->next.strain - l->now.strain) - m->decay[i] * l->now.unit[i];
}

/* Derivatives of a mode's force at the end of the trial. */
static void propagate_mode_slopes(const forward_lumped *l, const mode_group *g, size_t i,
                                  const double *strain_p, const double *dt_p, double *row) {
    const modes *m = &l->modes;
    const double *old = l->d.unit + i * l->n_columns, *strain_old = l->d.strain;
    double decay = m->decay[i], mean = m->mean[i];
    for (size_t k = 0; k < l->n_columns; k++)
        row[k] = decay * old[k] + mean * (strain_p[k] - strain_old[k]);
    if (!m->timed[i] && !dt_p)
        return;
    double by_x = mode_derivative_by_rate(l, i);
    for (size_t k = 0; m->timed[i] && k < g->n_values; k++)
        row[g->column + k] += by_x * l->step.dt * m->rate_by[k][i];
    for (size_t k = 0; dt_p && k < l->n_columns; k++)
        row[k] += by_x * m->rate[i] * dt_p[k];
}

static bool are_all_values_zero(size_t n, const double *values) {
    for (size_t k = 0; k < n; k++)
        if (values[k] != 0.0)
            return false;
    return true;
}

static void add_scaled_row(size_t n, double factor, const double *row, double *force_p) {
    for (size_t k = 0; k < n; k++)
        force_p[k] += factor * row[k];
}

static void propagate_group_slopes(forward_lumped *l, const mode_group *g, const double *strain_p,
                                   const double *dt_p, double *force_p, bool keep) {
    const modes *m = &l->modes;
    for (size_t k = 0; k < g->n_values; k++)
        for (size_t i = g->first; i < g->end; i++)
            force_p[g->column + k] += m->weight_by[k][i] * l->next.unit[i];
    for (size_t i = g->first; i < g->end; i++) {
        if (l->still && !m->timed[i])
            continue;
        double *row = keep ? l->d.unit + i * l->n_columns : l->d.row;
        propagate_mode_slopes(l, g, i, strain_p, dt_p, row);
        add_scaled_row(l->n_columns, m->weight[i], row, force_p);
    }
}

/* Derivatives of the trial's force; with keep, those of the state become the trial's. */
static void propagate_force_slopes(forward_lumped *l, const double *strain_p, const double *dt_p,
                                   double *force_p, bool keep) {
    const size_t n = l->n_columns;
    const slopes *d = &l->d;
    evaluate_trial_spring(l);
    double by_strain = l->step.rate_factor * l->spring.by_strain,
           by_peak = l->step.rate_factor * l->spring.by_peak;
    double dashpot = l->step.dashpot, rise = l->next.strain - l->now.strain;
    l->still = l->still && !dt_p && are_all_values_zero(n, strain_p);
    for (size_t k = 0; k < n; k++)
        force_p[k] = by_strain * strain_p[k] + by_peak * d->peak[k] + dashpot * (strain_p[k] - d->strain[k]);
    for (size_t k = 0; k < n && dashpot > 0.0 && dt_p; k++)
        force_p[k] -= dashpot * rise / l->step.dt * dt_p[k];
    forward_spring_own(l->plan, &l->spring, l->now.peak, l->step.rate_factor, l->of_effect, force_p);
    for (size_t j = 0; j < l->plan->material.n_arms; j++) {
        double *row = keep ? d->arm + j * n : d->row;
        propagate_arm_slopes(l, j, strain_p, dt_p, row);
        add_scaled_row(n, 1.0, row, force_p);
    }
    for (size_t g = 0; g < l->n_groups; g++)
        propagate_group_slopes(l, &l->group[g], strain_p, dt_p, force_p, keep);
}

static void slopes_at_held_strain(void *self, double *force_p, double *force_dt) {
    forward_lumped *l = self;
    bool still = l->still;
    propagate_force_slopes(l, l->d.zero, NULL, force_p, false);
    l->still = still;
    *force_dt = 0.0;
    if (l->step.dt == 0.0)
        return;
    double rise = l->next.strain - l->now.strain;
    *force_dt = -l->step.dashpot * rise / l->step.dt;
    for (size_t j = 0; j < l->plan->material.n_arms; j++) {
        double p[ELEMENT_PARTIALS];
        partial_derivatives_of_arm(l, j, p);
        *force_dt -= p[ELEMENT_LOG_TIME] / l->step.dt;
    }
    for (size_t i = 0; i < l->modes.n; i++)
        *force_dt += l->modes.weight[i] * l->modes.rate[i] * mode_derivative_by_rate(l, i);
}

static void commit_lumped_strain(void *self, const double *strain_p, const double *dt_p, double *force_p) {
    forward_lumped *l = self;
    if (l->n_columns > 0) {
        const double *to = strain_p ? strain_p : l->d.zero;
        propagate_force_slopes(l, to, dt_p, force_p, true);
        bool deeper = l->plan->damaged && fabs(l->next.strain) >= l->now.peak;
        for (size_t k = 0; deeper && k < l->n_columns; k++)
            l->d.peak[k] = copysign(1.0, l->next.strain) * to[k];
        memcpy(l->d.strain, to, l->n_columns * sizeof *to);
    }
    memcpy(&l->now, &l->next, offsetof(state, unit) + l->modes.n * sizeof *l->now.unit);
}

/* ---- making one ---- */

/* Range of the modes' rates relative to the run's: 32 modes over seven decades of time represent a power law
 * to 1e-4. */
static const double SLOWER = 0.07, FASTER = 70.0;

static void add_modes_of_effect(forward_lumped *l, const forward_effect *f, double shortest, double whole) {
    effect_mode list[EFFECT_MODES_MAX];
    modes *m = &l->modes;
    const effect_range range = {EFFECT_MODES_MAX, SLOWER / whole, FASTER / shortest};
    const size_t n = range.n;
    f->row->spectrum(f->effect->value, &range, list);
    l->group[l->n_groups++] = (mode_group){m->n, m->n + n, f->column, f->row->info.n_parameters};
    for (size_t i = 0; i < n; i++, m->n++) {
        m->weight[m->n] = list[i].weight;
        m->rate[m->n] = list[i].rate;
        m->timed[m->n] = !are_all_values_zero(PALP_EFFECT_PARAMETERS, list[i].rate_by);
        for (size_t k = 0; k < PALP_EFFECT_PARAMETERS; k++) {
            m->weight_by[k][m->n] = list[i].weight_by[k];
            m->rate_by[k][m->n] = list[i].rate_by[k];
        }
    }
}

static bool allocate_slope_rows(forward_lumped *l) {
    const size_t n = l->n_columns, n_arms = l->plan->material.n_arms;
    if (n == 0)
        return true;
    double *block = calloc((4 + n_arms + l->modes.n) * n, sizeof *block);
    l->d = (slopes){block, block, block, block, block, block};
    if (!block)
        return false;
    l->d.peak += n;
    l->d.row += 2 * n;
    l->d.zero += 3 * n;
    l->d.arm += 4 * n;
    l->d.unit += (4 + n_arms) * n;
    return true;
}

palp_status forward_lumped_create(const forward_plan *plan, size_t n_columns, double shortest, double whole,
                                  forward_lumped **lumped) {
    forward_lumped *l = calloc(1, sizeof *l);
    if (!l)
        return PALP_ERR_NO_MEMORY;
    l->plan = plan;
    l->n_columns = n_columns;
    l->still = true;
    for (size_t i = 0; i < plan->n_effects; i++)
        if (plan->effect[i].row->spectrum && whole > 0.0)
            add_modes_of_effect(l, &plan->effect[i], shortest, whole);
    if (!allocate_slope_rows(l)) {
        free(l);
        return PALP_ERR_NO_MEMORY;
    }
    *lumped = l;
    return PALP_OK;
}

void forward_lumped_free(forward_lumped *l) {
    if (!l)
        return;
    free(l->d.strain);
    free(l);
}

/* Of arms and modes that are on; those that are off change nothing, not even a step. */
static double shortest_relaxation_time(const forward_lumped *l) {
    double shortest = forward_shortest_arm(l->plan);
    for (size_t i = 0; i < l->modes.n; i++)
        if (l->modes.weight[i] > 0.0)
            shortest = fmin(shortest, 1.0 / l->modes.rate[i]);
    return isinf(shortest) ? 0.0 : shortest;
}

forward_specimen forward_lumped_specimen(forward_lumped *l) {
    return (forward_specimen){.self = l,
                              .attempt = try_lumped_strain,
                              .hold = slopes_at_held_strain,
                              .commit = commit_lumped_strain,
                              .height = l->plan->model->height_m,
                              .shortest = shortest_relaxation_time(l),
                              .n_columns = l->n_columns,
                              .rest = l->now.strain,
                              .rest_p = l->n_columns ? l->d.strain : NULL};
}

/* ---- load history ---- */

void forward_lumped_take_history(forward_lumped *l, const palp_load_history *history) {
    const double set = l->plan->damage.set;
    if (!l->plan->damaged || !(history->peak > 0.0))
        return;
    l->now.peak = history->peak;
    l->now.strain = set * history->peak;
    palp_law_force(&l->plan->material.law, 1, &l->now.strain, &l->now.elastic, NULL, NULL);
    for (size_t k = 0; k < l->n_columns && history->peak_p; k++) {
        l->d.peak[k] = history->peak_p[k];
        l->d.strain[k] = set * history->peak_p[k];
    }
    for (size_t i = 0; l->n_columns && i < l->plan->n_damage_slopes; i++)
        l->d.strain[l->plan->damage_slope[i].column] += l->plan->damage_slope[i].by.set * history->peak;
    l->still = l->still && !l->plan->sets;
}

void forward_lumped_leave_history(const forward_lumped *l, palp_load_history *history) {
    history->peak = l->now.peak;
    if (l->n_columns && history->peak_p)
        memcpy(history->peak_p, l->d.peak, l->n_columns * sizeof *history->peak_p);
}
