/* forward_contact.c: the plate and the specimen's surface: pressed, released, moving freely, met again. */
#include "forward_plate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A free surface is followed in steps of EARLY times the shortest relaxation time, or of the sample interval
 * if that is longer: faster arms are in equilibrium. Later steps are LATER times the time since release.
 * Steps are rounded down to powers of two so that they do not depend on parameters. LATER times a whole
 * number of steps is never such a power. */
static const double EARLY = 0.1, LATER = 0.047;
static const double AT_ONCE = 4e-15; /* smallest share of a step that is distinguishable from its start */
static const double STRAIN_LOW = -0.95, STRAIN_HIGH = 0.999; /* range of the search for implicit strains */
enum {
    EVENTS = 8
}; /* most events in one step, more would be rounding; after half of them a bond breaks at its largest pull */

/* ---- pressed ---- */

typedef struct equation {
    const forward_plate *plate;
    double share, force, slope; /* of the specimen, for the last strain or share */
    double rest[2], ends[2];    /* meeting: the surface's strain at two shares */
} equation;

/* Equation of a plate on a compliant frame: strain - forward_held(depth, force(strain)). */
static palp_status frame_deflection_residual(void *user, double strain, double *value, double *slope) {
    equation *q = user;
    palp_status status = forward_ask(q->plate, strain, q->share, true, &q->force, &q->slope);
    if (status)
        return status;
    forward_surface s = forward_held(q->plate, q->share, q->force);
    *value = strain - s.strain;
    *slope = 1.0 - s.by_force * q->slope;
    return PALP_OK;
}

/* Moves the plate to the end of the step with the surface on it; gives strain and force there. */
static palp_status press_to_step_end(forward_plate *p, double *strain, double *force, double *slope) {
    forward_surface s = forward_held(p, 1.0, p->force);
    *strain = s.strain;
    *slope = 0.0; /* not needed */
    if (!p->plan->gives_way)
        return forward_ask(p, *strain, 1.0, true, force, NULL);
    equation q = {.plate = p, .share = 1.0};
    palp_status status = forward_solve(frame_deflection_residual, &q, STRAIN_LOW, STRAIN_HIGH, strain);
    *force = q.force;
    *slope = q.slope;
    return status;
}

static void commit_pressed_state(forward_plate *p, double strain, double force, double slope) {
    const size_t n = p->specimen.n_columns;
    if (n) {
        double *strain_p = p->work + n, *force_p = p->work + 2 * n, force_dt;
        forward_surface s = forward_held(p, 1.0, force);
        forward_own_slopes(p, &s, strain_p);
        if (s.by_force != 0.0) {
            forward_hold(p, force, force_p, &force_dt);
            for (size_t k = 0; k < n; k++) {
                double direct = force_p[k] - force_dt * p->done_p[k] * forward_step_time(p);
                strain_p[k] = (strain_p[k] + s.by_force * direct) / (1.0 - s.by_force * slope);
            }
        }
    }
    p->gap = p->bond = 0.0;
    forward_take(p, strain, 1.0, force, p->work + n, NULL);
}

/* ---- released ---- */

/* For a surface on a plate that pulls with the full adhesion: -(force + adhesion), which increases with the
 * share. */
static palp_status pull_beyond_adhesion(void *user, double share, double *value, double *slope) {
    equation *q = user;
    const forward_plate *p = q->plate;
    double next, little = 1e-7;
    forward_surface s = forward_held(p, share, -p->plan->adhesion);
    double later =
        share +
        little *
            (1.0 - p->done); /* the slope by time alone, a difference quotient for Newton's method only */
    palp_status status = forward_ask(p, s.strain, later, true, &next, NULL);
    if (!status)
        status = forward_ask(p, s.strain, share, true, &q->force, &q->slope);
    if (status)
        return status;
    *value = -(q->force + p->plan->adhesion);
    *slope = -(q->slope * forward_along_step(p, &s) + (next - q->force) / (later - share));
    return PALP_OK;
}

/* The plate lets go at a force of minus the adhesion, an effect's parameter. Adds its contribution to the
 * derivatives of the strain there and of the force beyond it. */
static void add_pull_derivatives(const forward_plate *p, const forward_surface *s, double *strain_p,
                                 double *force_p) {
    effect_bond bond;
    const size_t column = forward_bond_at(p, 0.0, &bond);
    for (size_t k = 0; k < PALP_EFFECT_PARAMETERS; k++)
        if (bond.by_value[k] != 0.0) {
            strain_p[column + k] -= s->by_force * bond.by_value[k];
            force_p[column + k] += bond.by_value[k];
        }
}

/* The share of the step at which the plate lets go; the present one if the pull is already too large. */
static palp_status find_share_of_parting(equation *q, double *share) {
    const forward_plate *p = q->plate;
    double pull, slope, start = fmin(1.0, p->done + AT_ONCE);
    palp_status status = pull_beyond_adhesion(q, start, &pull, &slope);
    *share = start;
    if (status || pull >= 0.0 || start == 1.0)
        return status;
    *share = 0.5 * (start + 1.0);
    status = forward_solve(pull_beyond_adhesion, q, start, 1.0, share);
    return status == PALP_ERR_NOT_CONVERGED ? PALP_OK
                                            : status; /* not converged: it lets go at the very end */
}

static palp_status part_plate_from_surface(forward_plate *p) {
    const size_t n = p->specimen.n_columns;
    double share, step = forward_step_time(p), force_dt, *share_p = p->work + n, *strain_p = p->work + 2 * n,
                  *force_p = p->work + 3 * n;
    equation q = {.plate = p};
    palp_status status = find_share_of_parting(&q, &share);
    if (status)
        return status;
    forward_surface s = forward_held(p, share, -p->plan->adhesion);
    if (n) {
        double along = forward_along_step(p, &s);
        forward_own_slopes(p, &s, strain_p);
        forward_hold(p, q.force, force_p, &force_dt);
        add_pull_derivatives(p, &s, strain_p, force_p);
        double turn = q.slope * along + force_dt * step;
        for (size_t k = 0; k < n; k++) {
            double direct = force_p[k] + q.slope * strain_p[k] - force_dt * p->done_p[k] * step;
            share_p[k] = turn < 0.0 ? -direct / turn : 0.0;
            strain_p[k] += along * share_p[k];
        }
    }
    forward_take(p, s.strain, share, q.force, strain_p, share_p);
    forward_let_go(p);
    return PALP_OK;
}

/* ---- moving freely, and met again ---- */

static palp_status free_surface_residual(void *user, double strain, double *value, double *slope) {
    equation *q = user;
    palp_status status = forward_ask(q->plate, strain, q->share, false, &q->force, &q->slope);
    *value = q->force;
    *slope = q->slope;
    return status;
}

/* Strain of the plate less that of the surface, which is linear between the two ends. */
static palp_status gap_of_plate_and_surface(void *user, double share, double *value, double *slope) {
    const equation *q = user;
    const forward_plate *p = q->plate;
    double rate = (q->rest[1] - q->rest[0]) / (q->ends[1] - q->ends[0]);
    forward_surface s = forward_held(p, share, 0.0);
    *value = s.strain - q->rest[0] - rate * (share - q->ends[0]);
    *slope = forward_along_step(p, &s) - rate;
    return PALP_OK;
}

/* Share of the step to which a free surface is followed next. */
static double choose_next_free_share(const forward_plate *p) {
    double step = forward_step_time(p), now = p->time[0] + p->done * step;
    if (p->fresh || p->specimen.shortest == 0.0)
        return 1.0;
    double wanted = fmax(EARLY * fmax(p->specimen.shortest, step), LATER * (now - p->released));
    double share = p->done + ldexp(1.0, ilogb(wanted)) / step;
    return share < 1.0 && share > p->done ? share : 1.0;
}

/* The plate meets the surface between done and end, at which the free surface would have strain rest. */
static palp_status meet_free_surface(forward_plate *p, double end, double rest, const double *rest_p,
                                     const double *end_p) {
    const size_t n = p->specimen.n_columns;
    double share = p->done, force, whole = end - p->done, *share_p = p->work + n, *strain_p = p->work + 2 * n;
    equation q = {.plate = p, .rest = {p->strain, rest}, .ends = {p->done, end}};
    p->touching = true;
    p->fresh = false;
    if (forward_held(p, share, 0.0).strain >= p->strain)
        return PALP_OK; /* already in contact */
    palp_status status = forward_solve(gap_of_plate_and_surface, &q, p->done, end, &share);
    if (status)
        return status;
    forward_surface s = forward_held(p, share, 0.0);
    status = forward_ask(p, s.strain, share, false, &force, NULL);
    double part = (share - p->done) / whole, rate = (rest - p->strain) / whole;
    double along = forward_along_step(p, &s);
    forward_own_slopes(p, &s, strain_p);
    for (size_t k = 0; k < n; k++) {
        double end_k = end_p ? end_p[k] : 0.0;
        double surface_p = p->strain_p[k] * (1.0 - part) + part * rest_p[k] -
                           rate * ((1.0 - part) * p->done_p[k] + part * end_k);
        share_p[k] = along != rate ? (surface_p - strain_p[k]) / (along - rate) : 0.0;
        strain_p[k] += along * share_p[k];
    }
    if (!status)
        forward_take(p, s.strain, share, force, strain_p, share_p);
    return status;
}

/* Follows the free surface for one step, or until the plate meets it. */
static palp_status follow_free_surface(forward_plate *p) {
    const size_t n = p->specimen.n_columns;
    double end = choose_next_free_share(p), rest = p->strain, force = 0.0, slope = 0.0, force_dt;
    double *rest_p = p->work + 3 * n, *end_p = end < 1.0 ? p->done_p : NULL;
    equation q = {.plate = p, .share = end};
    memcpy(rest_p, p->strain_p, n * sizeof *rest_p);
    if (!p->fresh) {
        palp_status status = forward_solve(free_surface_residual, &q, STRAIN_LOW, STRAIN_HIGH, &rest);
        if (status)
            return status;
        force = q.force;
        slope = q.slope;
        if (n) {
            forward_hold(p, force, rest_p, &force_dt);
            for (size_t k = 0; k < n; k++) {
                double dt_p = (end_p ? 0.0 : -p->done_p[k]) * forward_step_time(p);
                rest_p[k] = slope > 0.0 ? -(rest_p[k] + force_dt * dt_p) / slope : 0.0;
            }
        }
    }
    if (forward_held(p, end, 0.0).strain > rest)
        return meet_free_surface(p, end, rest, rest_p, end_p);
    if (p->fresh)
        p->done = 1.0;
    else
        forward_take(p, rest, end, force, rest_p, end_p);
    p->force = 0.0;
    memset(p->force_p, 0, n * sizeof *p->force_p);
    return PALP_OK;
}

/* ---- the plate's motion ---- */

/* The end of the last step becomes the start of this one. */
static void begin_step_to_place(forward_plate *p, const forward_place *to) {
    p->time[0] = p->time[1];
    p->depth[0] = p->depth[1];
    memcpy(p->change[0], p->change[1], sizeof p->change[0]);
    p->time[1] = to->time;
    p->depth[1] = to->depth;
    memcpy(p->change[1], to->change, sizeof p->change[1]);
}

palp_status forward_plate_start(forward_plate *p, const forward_place *place) {
    p->fresh = true;
    begin_step_to_place(p, place);
    begin_step_to_place(p, place);
    p->strain = p->specimen.rest;
    if (p->specimen.rest_p)
        memcpy(p->strain_p, p->specimen.rest_p, p->specimen.n_columns * sizeof *p->strain_p);
    if (!(forward_held(p, 1.0, 0.0).strain > p->strain))
        return PALP_OK;
    double strain, force, slope;
    p->fresh = false;
    p->touching = true;
    palp_status status = press_to_step_end(p, &strain, &force, &slope);
    if (!status)
        commit_pressed_state(p, strain, force, slope);
    return status;
}

palp_status forward_plate_move(forward_plate *p, const forward_place *to) {
    const size_t n = p->specimen.n_columns;
    int events = 0;
    begin_step_to_place(p, to);
    p->velocity = to->velocity;
    p->done = 0.0;
    memset(p->done_p, 0, n * sizeof *p->done_p);
    while (p->done < 1.0) {
        double strain, force, slope;
        palp_status status;
        if (!p->touching && p->abandons) {
            p->force = 0.0;
            memset(p->force_p, 0, n * sizeof *p->force_p);
            return PALP_OK;
        }
        if (!p->touching) {
            status = follow_free_surface(p);
        } else {
            status = press_to_step_end(p, &strain, &force, &slope);
            if (!status && force < 0.0 && p->plan->reaches && events++ < EVENTS / 2)
                status = forward_pull(p, strain);
            else if (!status && force < -p->plan->adhesion && events++ < EVENTS)
                status = part_plate_from_surface(p);
            else if (!status)
                commit_pressed_state(p, strain, force, slope);
        }
        if (status)
            return status;
    }
    return PALP_OK;
}

double forward_plate_stiffness(const forward_plate *p, double slope) {
    if (!p->touching)
        return 0.0;
    forward_surface s = forward_held(p, 1.0, p->force);
    double stiffness = p->plan->age * slope;
    if (p->bond != 0.0)
        stiffness *= p->bond / (p->bond + stiffness);
    return stiffness * s.by_depth / (1.0 - s.by_force * stiffness);
}

bool forward_plate_clear(const forward_plate *p, const forward_place *place) {
    forward_plate there = *p;
    begin_step_to_place(&there, place);
    return !(forward_held(&there, 1.0, 0.0).strain > 0.0);
}

palp_status forward_plate_step(forward_plate *p, double dt, double depth, double velocity) {
    p->released -= p->time[1];
    p->time[1] = 0.0;
    return forward_plate_move(p, &(forward_place){.time = dt, .depth = depth, .velocity = velocity});
}

palp_status forward_plate_create(const forward_plan *plan, const forward_specimen *specimen,
                                 forward_plate *plate) {
    const size_t n = specimen->n_columns;
    *plate = (forward_plate){.plan = plan, .specimen = *specimen};
    double *block = calloc((3 + FORWARD_WORK) * n + 1, sizeof *block);
    if (!block)
        return PALP_ERR_NO_MEMORY;
    plate->force_p = block;
    plate->strain_p = block + n;
    plate->done_p = block + 2 * n;
    plate->work = block + 3 * n;
    return PALP_OK;
}

void forward_plate_free(forward_plate *plate) {
    free(plate->force_p);
    *plate = (forward_plate){0};
}
