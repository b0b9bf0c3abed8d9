/* forward_surface.c: from the encoder to the specimen's surface, and trials of the specimen there. */
#include "forward_plate.h"

#include <string.h>

static double plate_depth_at_share(const forward_plate *p, double share) {
    return share == 1.0 ? p->depth[1] : p->depth[0] + share * (p->depth[1] - p->depth[0]);
}

forward_surface forward_held(const forward_plate *p, double share, double force) {
    forward_surface s;
    const double height = p->specimen.height;
    double depth = plate_depth_at_share(p, share) - p->plan->contact;
    s.by_depth = 1.0;
    s.by_force = s.drift = 0.0;
    for (size_t i = 0; i < p->plan->n_effects; i++) {
        const forward_effect *f = &p->plan->effect[i];
        if (!f->row->map)
            continue;
        const double rise = p->change[1][i] - p->change[0][i];
        const effect_press at = {depth, force,
                                 share == 1.0 ? p->change[1][i] : p->change[0][i] + share * rise};
        effect_surface out = {.depth = depth, .by_depth = 1.0};
        f->row->map(f->effect->value, &at, &out);
        depth = out.depth;
        s.by_depth *= out.by_depth;
        s.by_force = s.by_force * out.by_depth + out.by_force;
        s.drift = s.drift * out.by_depth + out.by_change * rise;
        for (size_t j = 0; j < i && out.by_depth != 1.0; j++)
            for (size_t k = 0; p->plan->effect[j].row->map && k < PALP_EFFECT_PARAMETERS; k++)
                s.by_value[j][k] *= out.by_depth;
        memcpy(s.by_value[i], out.by_value, sizeof out.by_value);
    }
    s.strain = depth / height;
    s.by_depth /= height;
    s.by_force /= height;
    s.drift /= height;
    return s;
}

double forward_along_step(const forward_plate *p, const forward_surface *s) {
    return s->by_depth * (p->depth[1] - p->depth[0]) + s->drift;
}

void forward_own_slopes(const forward_plate *p, const forward_surface *s, double *row) {
    memset(row, 0, p->specimen.n_columns * sizeof *row);
    for (size_t i = 0; p->specimen.n_columns > 0 && i < p->plan->n_effects; i++) {
        const forward_effect *f = &p->plan->effect[i];
        for (size_t k = 0; f->row->map && k < f->row->info.n_parameters; k++)
            row[f->column + k] = s->by_value[i][k] / p->specimen.height;
    }
}

double forward_step_time(const forward_plate *p) {
    return p->time[1] - p->time[0];
}

palp_status forward_ask(const forward_plate *p, double strain, double share, bool moved, double *force,
                        double *slope) {
    forward_move move = {strain, (share - p->done) * forward_step_time(p),
                         moved ? p->velocity / p->specimen.height : 0.0};
    palp_status status = p->specimen.attempt(p->specimen.self, &move, force, slope);
    if (status)
        return status;
    *force *= p->plan->age;
    if (slope)
        *slope *= p->plan->age;
    return PALP_OK;
}

/* Adds the direct changes of a force by the parameters of ageing. */
static void add_ageing_derivatives(const forward_plate *p, double force, double *force_p) {
    for (size_t i = 0; i < p->plan->n_effects; i++) {
        const forward_effect *f = &p->plan->effect[i];
        for (size_t k = 0; f->row->specimen && k < f->row->info.n_parameters; k++)
            force_p[f->column + k] += f->age.by_value[k] * force / f->age.value;
    }
}

void forward_hold(const forward_plate *p, double force, double *force_p, double *force_dt) {
    p->specimen.hold(p->specimen.self, force_p, force_dt);
    for (size_t k = 0; k < p->specimen.n_columns; k++)
        force_p[k] *= p->plan->age;
    *force_dt *= p->plan->age;
    add_ageing_derivatives(p, force, force_p);
}

void forward_take(forward_plate *p, double strain, double share, double force, const double *strain_p,
                  const double *share_p) {
    const size_t n = p->specimen.n_columns;
    double *dt_p = p->work; /* the first row: free between two calls of forward_take */
    bool timed = false;
    for (size_t k = 0; k < n; k++) {
        dt_p[k] = ((share_p ? share_p[k] : 0.0) - p->done_p[k]) * forward_step_time(p);
        timed = timed || dt_p[k] != 0.0;
    }
    p->specimen.commit(p->specimen.self, n ? strain_p : NULL, timed ? dt_p : NULL, p->force_p);
    for (size_t k = 0; k < n; k++) {
        p->force_p[k] *= p->plan->age;
        p->strain_p[k] = strain_p[k];
        p->done_p[k] = share_p ? share_p[k] : 0.0;
    }
    if (n)
        add_ageing_derivatives(p, force, p->force_p);
    p->strain = strain;
    p->force = force;
    p->done = share;
}
