/* forward_network.c: forward model of a network: its specimen, and the effects on its elements. */
#include "base/file.h"
#include "forward_internal.h"
#include "network/network_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct forward_network {
    const forward_plan *plan;
    palp_network *net;
    element_damage damage;
    size_t n_spectra;
    forward_spectrum spectrum[FORWARD_SPECTRA];
    bool sloped;                               /* the slope of every trial is needed */
    bool found;                                /* the slopes of this trial are known */
    effect_number of_effect[PALP_EFFECTS_MAX]; /* at the trial's rate */
    double slope, committed;                   /* d force / d surface strain: of the trial; of the state */
    double strain, peak[2]; /* surface strain of the trial; its largest so far, and a copy */
    double *peak_p[2];      /* [n_columns] derivatives of peak */
    double rest, *rest_p;   /* surface strain before contact */
    double *weight;         /* [n_elements] of the trial */
    forward_slopes *slopes; /* NULL without derivatives */
};

static palp_status try_network_strain(void *self, const forward_move *move, double *force, double *slope) {
    forward_network *p = self;
    palp_step_info info = {0};
    const double height = p->net->height;
    p->net->rate_factor = forward_rate_factor(p->plan, move->rate, p->of_effect);
    p->strain = move->strain;
    palp_status status = palp_network_try(p->net, move->strain * height, move->dt, &info);
    *force = info.force_N;
    if (status || (!slope && !p->sloped))
        return status;
    status = network_weights(p->net, p->weight, &p->slope);
    p->slope *= height;
    p->found = false;
    if (slope)
        *slope = p->slope;
    return status;
}

/* Computed on demand: most trials need their force only. */
static void find_slopes_once_per_trial(forward_network *p) {
    if (!p->found)
        forward_slopes_find(p->slopes, p->weight, p->slope / p->net->height, p->of_effect);
    p->found = true;
}

static void slopes_at_held_strain(void *self, double *force_p, double *force_dt) {
    forward_network *p = self;
    find_slopes_once_per_trial(p);
    forward_slopes_hold(p->slopes, force_p, force_dt);
}

static void commit_network_strain(void *self, const double *strain_p, const double *dt_p, double *force_p) {
    forward_network *p = self;
    if (p->slopes) {
        find_slopes_once_per_trial(p);
        forward_slopes_advance(p->slopes, strain_p, dt_p, force_p);
    }
    p->committed = p->slope;
    if (fabs(p->strain) >= p->peak[0]) {
        p->peak[0] = fabs(p->strain);
        for (size_t k = 0; p->slopes && k < p->plan->n_columns; k++)
            p->peak_p[0][k] = strain_p ? copysign(1.0, p->strain) * strain_p[k] : 0.0;
    }
    palp_network_commit(p->net);
}

static void copy_peak_strain(forward_network *p, size_t from, size_t to) {
    p->peak[to] = p->peak[from];
    if (p->slopes)
        memcpy(p->peak_p[to], p->peak_p[from], p->plan->n_columns * sizeof *p->peak_p[to]);
}

void forward_network_keep(forward_network *p) {
    network_mark_save(p->net);
    copy_peak_strain(p, 0, 1);
    if (p->slopes)
        forward_slopes_keep(p->slopes, false);
}

void forward_network_back(forward_network *p) {
    network_mark_restore(p->net);
    copy_peak_strain(p, 1, 0);
    if (p->slopes)
        forward_slopes_keep(p->slopes, true);
}

double forward_network_slope(const forward_network *p) {
    return p->committed;
}

/* An effect's relaxation modulus as arms of the elements: as many as fit, over the times that the steps
 * resolve. */
static palp_status add_spectrum_as_arms(forward_network *f, forward_plan *plan, const forward_effect *from,
                                        size_t room, double shortest, double whole, palp_error *error) {
    if ((effect_is_off(from->effect) && !f->sloped) || whole == 0.0)
        return PALP_OK;
    if (room < EFFECT_MODES_MIN)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%s: the network already has all arms that are possible (%d)",
                              from->row->info.id, PALP_ARMS_MAX);
    const effect_range range = {room, 0.1 / whole, 5.0 / shortest};
    forward_spectrum *g = &f->spectrum[f->n_spectra++];
    *g = (forward_spectrum){.first = plan->material.n_arms,
                            .n = room,
                            .column = from->column,
                            .n_values = from->row->info.n_parameters};
    from->row->spectrum(from->effect->value, &range, g->mode);
    for (size_t i = 0; i < room; i++) {
        double weight = fmax(g->mode[i].weight, FORWARD_NO_STIFFNESS);
        plan->material.arms[plan->material.n_arms++] =
            (palp_arm){.stiffness_N = weight, .viscosity_Ns = weight / g->mode[i].rate};
    }
    return PALP_OK;
}

static palp_status add_spectra_of_effects(forward_network *f, forward_plan *plan, double shortest,
                                          double whole, palp_error *error) {
    const size_t room = PALP_ARMS_MAX - plan->material.n_arms;
    palp_status status = PALP_OK;
    for (size_t i = 0; i < plan->n_effects && !status; i++)
        if (plan->effect[i].row->spectrum)
            status = add_spectrum_as_arms(f, plan, &plan->effect[i], room / plan->n_spectra, shortest, whole,
                                          error);
    return status;
}

/* The effect that lets nodes at the plates slide, or NULL: they are fixed. The derivatives of full support
 * exist only as a limit. */
static const forward_effect *find_plate_slip_effect(const forward_network *f) {
    for (size_t i = 0; i < f->plan->n_effects; i++)
        if (f->plan->effect[i].row->foundation && (f->sloped || !effect_is_off(f->plan->effect[i].effect)))
            return &f->plan->effect[i];
    return NULL;
}

static palp_status set_slip_foundation(const forward_network *f) {
    const forward_effect *slip = find_plate_slip_effect(f);
    effect_number foundation = {.value = 0.0};
    if (!slip)
        return PALP_OK;
    slip->row->foundation(slip->effect->value, 0.0, &foundation);
    palp_status status = network_set_foundation(f->net, "bottom", foundation.value);
    return status ? status : network_set_foundation(f->net, "top", foundation.value);
}

static palp_status create_specimen_network(const forward_network *f, const palp_network_settings *settings,
                                           palp_network **net, palp_error *error) {
    palp_model model = *f->plan->model;
    palp_support supports[2];
    model.material = f->plan->material;
    model.n_effects = 0; /* the plan has them */
    palp_supports_default(supports);
    for (size_t i = 0; i < 2 && find_plate_slip_effect(f); i++)
        supports[i].axis[0] = supports[i].axis[2] = PALP_FREE;
    return palp_network_from_model(&model, NULL, 2, supports, settings, net, error);
}

static palp_status allocate_slope_arrays(forward_network *f, palp_error *error) {
    const forward_plan *plan = f->plan;
    const size_t n = plan->n_columns, m = palp_mesh_element_count(f->net->mesh);
    f->weight = calloc(m + 3 * n + 1, sizeof *f->weight);
    palp_status status = f->weight ? set_slip_foundation(f) : PALP_ERR_NO_MEMORY;
    if (status)
        return palp_error_set(error, status, "the network: %s", palp_status_text(status));
    f->peak_p[0] = f->weight + m;
    f->peak_p[1] = f->peak_p[0] + n;
    f->rest_p = f->peak_p[1] + n;
    f->damage = plan->damage;
    f->damage.slack = 1e-3;
    if (plan->damaged)
        status = network_set_damage(f->net, &f->damage);
    return status ? palp_error_set(error, status, "the network: %s", palp_status_text(status)) : PALP_OK;
}

palp_status forward_network_create(forward_plan *plan, const palp_network_settings *settings, double shortest,
                                   double whole, bool sloped, forward_network **network, palp_error *error) {
    forward_network *f = calloc(1, sizeof *f);
    if (!f)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    f->plan = plan;
    f->sloped = sloped;
    palp_status status = add_spectra_of_effects(f, plan, shortest, whole, error);
    if (!status)
        status = create_specimen_network(f, settings, &f->net, error);
    if (!status)
        status = allocate_slope_arrays(f, error);
    if (status)
        forward_network_free(f);
    else
        *network = f;
    return status;
}

palp_status forward_network_add_slopes(forward_network *f) {
    return forward_slopes_create(f->plan, f->net, f->n_spectra, f->spectrum, &f->slopes);
}

void forward_network_free(forward_network *f) {
    if (!f)
        return;
    palp_network_free(f->net);
    forward_slopes_free(f->slopes);
    free(f->weight);
    free(f);
}

forward_specimen forward_network_specimen(forward_network *f) {
    double shortest = forward_shortest_arm(f->plan);
    return (forward_specimen){.self = f,
                              .attempt = try_network_strain,
                              .hold = slopes_at_held_strain,
                              .commit = commit_network_strain,
                              .height = f->net->height,
                              .shortest = isinf(shortest) ? 0.0 : shortest,
                              .n_columns = f->slopes ? f->plan->n_columns : 0,
                              .rest = f->rest,
                              .rest_p = f->slopes ? f->rest_p : NULL};
}

/* ---- load history ---- */

struct palp_load_history_elements {
    size_t n, n_columns;
    double peak[]; /* [n] largest |e|, then its derivatives [n_columns n] */
};

void palp_load_history_free(palp_load_history *history) {
    if (!history)
        return;
    free(history->elements);
    history->elements = NULL;
    history->peak = 0.0;
}

static const double LONG = 1e9; /* s, after which all arms are relaxed */

static palp_status move_specimen_to_strain(forward_network *f, double strain, double dt,
                                           const double *strain_p) {
    double force, *force_p = f->peak_p[1]; /* nothing is kept there yet */
    const forward_move move = {strain, dt, 0.0};
    palp_status status = try_network_strain(f, &move, &force, NULL);
    if (!status)
        commit_network_strain(f, strain_p, NULL, force_p);
    return status;
}

/* Largest strains of the elements after an earlier slow press. The strain of that press has no derivatives
 * here. */
static palp_status press_to_earlier_peak(forward_network *f, double strain) {
    enum { STEPS = 16 };
    const size_t size = f->net->n_elements * sizeof *f->weight;
    palp_status status = PALP_OK;
    palp_step_info info;
    for (int i = 1; i <= STEPS && !status; i++) {
        status = palp_network_try(f->net, strain * f->net->height * i / STEPS, LONG, &info);
        if (!status)
            palp_network_commit(f->net);
    }
    if (!status)
        memcpy(f->weight, f->net->now.history.peak, size);
    palp_network_reset(f->net);
    if (!status)
        memcpy(f->net->now.history.peak, f->weight, size);
    return status;
}

/* Puts the specimen at the strain of its permanent set, with relaxed arms. */
static palp_status settle_at_permanent_set(forward_network *f) {
    const double set = f->plan->damage.set;
    f->rest = set * f->peak[0];
    for (size_t k = 0; f->slopes && k < f->plan->n_columns; k++)
        f->rest_p[k] = set * f->peak_p[0][k];
    for (size_t i = 0; f->slopes && i < f->plan->n_damage_slopes; i++)
        f->rest_p[f->plan->damage_slope[i].column] += f->plan->damage_slope[i].by.set * f->peak[0];
    palp_status status = move_specimen_to_strain(f, f->rest, LONG, f->slopes ? f->rest_p : NULL);
    f->net->now.time = 0.0;
    f->net->n_past = 0;
    return status;
}

palp_status forward_network_take_history(forward_network *f, const palp_load_history *history) {
    const struct palp_load_history_elements *e = history ? history->elements : NULL;
    const size_t n = f->plan->n_columns, m = f->net->n_elements;
    if (!history || !f->plan->damaged || !(history->peak > 0.0))
        return PALP_OK;
    if (e && (e->n != m || (f->slopes && e->n_columns && e->n_columns != n)))
        return PALP_ERR_ARGUMENT;
    palp_status status = e ? PALP_OK : press_to_earlier_peak(f, history->peak);
    if (e)
        memcpy(f->net->now.history.peak, e->peak, m * sizeof *e->peak);
    if (e && f->slopes && e->n_columns)
        forward_slopes_take_history(f->slopes, e->peak + m);
    f->peak[0] = history->peak;
    if (f->slopes && history->peak_p)
        memcpy(f->peak_p[0], history->peak_p, n * sizeof *history->peak_p);
    return status || !f->plan->sets ? status : settle_at_permanent_set(f);
}

palp_status forward_network_leave_history(const forward_network *f, palp_load_history *history) {
    const size_t n = f->slopes ? f->plan->n_columns : 0, m = f->net->n_elements;
    if (!history || !f->plan->damaged)
        return PALP_OK;
    struct palp_load_history_elements *e =
        realloc(history->elements, sizeof *e + (1 + n) * m * sizeof *e->peak);
    if (!e)
        return PALP_ERR_NO_MEMORY;
    e->n = m;
    e->n_columns = n;
    memcpy(e->peak, f->net->now.history.peak, m * sizeof *e->peak);
    if (n)
        memcpy(e->peak + m, forward_slopes_history(f->slopes), n * m * sizeof *e->peak);
    history->elements = e;
    history->peak = f->peak[0];
    if (n && history->peak_p)
        memcpy(history->peak_p, f->peak_p[0], n * sizeof *history->peak_p);
    return PALP_OK;
}
