/* contact_alone.h: one contact of a tool with a triangle alone: force and tangent as derivatives of its
 * energy. */
#ifndef CONTACT_ALONE_H
#define CONTACT_ALONE_H

#include "contact/contact_internal.h"

#include <check.h>
#include <string.h>

/* A tool on the triangle of the nodes 0, 1, 2: what contact_evaluate needs, no more. */
typedef struct setting {
    palp_tool tool;
    contact_set set;
    contact c;
} setting;

static inline void place_alone(setting *s, const palp_tool *tool) {
    memset(s, 0, sizeof *s);
    s->tool = *tool;
    s->set.pose = s->set.tool = &s->tool;
    s->set.settings.smoothing = 0.05;
    s->set.edge = 2.0;
    s->c = (contact){.node = {0, 1, 2},
                     .corners = 3,
                     .stiffness = 7.0,
                     .entry = 1.0,
                     .share = {0.2, 0.5, 0.3},
                     .stick_share = {0.2, 0.5, 0.3}};
}

static inline double energy_at(setting *s, const double *x) {
    contact_evaluate(&s->set, &s->c, x);
    return contact_energy(&s->set, &s->c);
}

/* Pressure alone, on the nodes. */
static inline void force_at(setting *s, const double *x, double force[9]) {
    contact_evaluate(&s->set, &s->c, x);
    for (int i = 0; i < 9; i++)
        force[i] = s->c.share[i / 3] * s->c.pressure * s->c.normal[i % 3];
}

/* A central difference over h is off by its square; on a kink (two parts of the triangle, the smoothing's
 * end) by more. The bounds are of the force, N, and of the tangent, N/m. */
static inline void check_derivatives(setting *s, double *x, double force_off, double tangent_off) {
    const double h = 1e-5;
    double force[9], low[9], high[9], block[9];
    force_at(s, x, force);
    contact here = s->c;
    for (int j = 0; j < 9; j++) {
        double kept = x[j], unit[9] = {0.0}, product[9] = {0.0};
        x[j] = kept + h;
        double above = energy_at(s, x);
        force_at(s, x, high);
        x[j] = kept - h;
        double below = energy_at(s, x);
        force_at(s, x, low);
        x[j] = kept;
        ck_assert_double_eq_tol(force[j], -(above - below) / (2.0 * h), force_off);
        unit[j] = 1.0;
        contact_times(&here, unit, product);
        for (int i = 0; i < 9; i++) {
            contact_block(&here, i / 3, j / 3, block);
            ck_assert_double_eq_tol(block[3 * (i % 3) + j % 3], -(high[i] - low[i]) / (2.0 * h), tangent_off);
            ck_assert_double_eq_tol(block[3 * (i % 3) + j % 3], product[i], 1e-12);
        }
    }
}

#endif
