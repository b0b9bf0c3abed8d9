/* forward_pull.c: a plate that pulls a surface on a bond behind it, until it lets go. */
#include "forward_plate.h"

#include <math.h>

static const double CLOSE =
    1e-8; /* relative to the reach: Newton's step at which the surface's place is accepted */

size_t forward_bond_at(const forward_plate *p, double gap, effect_bond *bond) {
    size_t column = 0;
    *bond = (effect_bond){.reach = 0.0};
    for (size_t i = 0; i < p->plan->n_effects; i++) {
        const forward_effect *f = &p->plan->effect[i];
        if (!f->row->bond)
            continue;
        f->row->bond(f->effect->value, gap * p->specimen.height, bond);
        column = f->column;
    }
    return column;
}

/* Finds the distance at which the bond's pull is the specimen's force; of several the nearest. Newton's
 * method approaches it from one side, as the bond's stiffness falls with the gap. ERR_NOT_CONVERGED: none,
 * the plate lets go. */
static palp_status find_strain_on_bond(const forward_plate *p, double *strain, double *force, double *slope) {
    enum { STEPS = 100 };
    const double height = p->specimen.height;
    double nearest = *strain, at = *strain + p->gap;
    for (int step = 0; step < STEPS; step++) {
        palp_status status = forward_ask(p, at, 1.0, true, force, slope);
        if (status)
            return status;
        forward_surface s = forward_held(p, 1.0, *force);
        effect_bond bond;
        forward_bond_at(p, at - s.strain, &bond);
        double stiffness = bond.by_gap * height, value = *force + bond.pull;
        double rise = *slope + stiffness * (1.0 - s.by_force * *slope), reach = bond.reach / height;
        if (at - s.strain > 20.0 * reach || (!(rise > 0.0) && value <= 0.0))
            return PALP_ERR_NOT_CONVERGED;
        if (value < 0.0)
            nearest = at;
        double move = rise > 0.0 ? -value / rise : 0.5 * (nearest - at);
        move = fmax(-0.5 * reach, fmin(0.5 * reach, move));
        at += move;
        *strain = at;
        if (fabs(move) <= CLOSE * reach) /* no more exact than a network's force; Newton's next step would be
                                            the square of this */
            return forward_ask(p, at, 1.0, true, force, slope);
    }
    return PALP_ERR_NOT_CONVERGED;
}

static void commit_strain_on_bond(forward_plate *p, double strain, double force, double slope) {
    const size_t n = p->specimen.n_columns;
    forward_surface s = forward_held(p, 1.0, force);
    effect_bond bond;
    const size_t column = forward_bond_at(p, strain - s.strain, &bond);
    const double stiffness = bond.by_gap * p->specimen.height,
                 rise = slope + stiffness * (1.0 - s.by_force * slope);
    if (n) {
        double *strain_p = p->work + n, *force_p = p->work + 2 * n, force_dt;
        forward_own_slopes(p, &s, strain_p);
        forward_hold(p, force, force_p, &force_dt);
        for (size_t k = 0; k < n; k++) {
            double direct = force_p[k] - force_dt * p->done_p[k] * forward_step_time(p);
            strain_p[k] = stiffness * (strain_p[k] + s.by_force * direct) - direct;
        }
        for (size_t k = 0; k < PALP_EFFECT_PARAMETERS; k++)
            if (bond.by_value[k] != 0.0)
                strain_p[column + k] -= bond.by_value[k];
        for (size_t k = 0; k < n; k++)
            strain_p[k] /= rise;
    }
    p->gap = strain - s.strain;
    p->bond = stiffness;
    forward_take(p, strain, 1.0, force, p->work + n, NULL);
}

void forward_let_go(forward_plate *p) {
    p->touching = false;
    p->released = p->time[0] + p->done * forward_step_time(p);
    p->gap = p->bond = 0.0;
}

palp_status forward_pull(forward_plate *p, double strain) {
    double force, slope;
    palp_status status = find_strain_on_bond(p, &strain, &force, &slope);
    if (!status)
        commit_strain_on_bond(p, strain, force, slope);
    if (status == PALP_ERR_NOT_CONVERGED)
        forward_let_go(p);
    return status == PALP_ERR_NOT_CONVERGED ? PALP_OK : status;
}
