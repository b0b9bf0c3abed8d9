/* element_make.h: materials of the tests of elements. */
#ifndef ELEMENT_MAKE_H
#define ELEMENT_MAKE_H

#include "material/element.h"

#include <check.h>

static const double QUARTIC[] = {0.54, -2.34, 33.25, -124.03, 177.63}; /* N, phantom of the seed */

/* N s against N: relaxation times from 0.05 to 800 s. */
static const palp_arm ARMS[] = {
    {0.9, 0.6, 0, 0}, {0.35, 14.0, 0, 0}, {1.6, 0.08, 0, 0}, {0.2, 160.0, 0, 0}, {0.5, 2.5, 0, 0}};

static inline palp_material plain(size_t n_arms) {
    palp_material m = {.n_arms = n_arms};
    ck_assert_int_eq(palp_law_polynomial(5, QUARTIC, &m.law), PALP_OK);
    for (size_t j = 0; j < n_arms; j++)
        m.arms[j] = ARMS[j];
    return m;
}

enum {
    PLAIN_0,
    PLAIN_1,
    PLAIN_2,
    PLAIN_5,
    DASHPOT,
    BETA,
    GAMMA,
    BETA_GAMMA,
    QLV,
    QLV_GAMMA,
    SEDEF_0,
    SEDEF_1,
    KINDS
};

/* One of each kind of material. */
static inline palp_material material_of(int kind) {
    static const size_t arms[KINDS] = {0, 1, 2, 5, 1, 2, 2, 3, 2, 2, 0, 1};
    palp_material m = plain(arms[kind]);
    for (size_t j = 0; j < m.n_arms; j++) {
        if (kind == BETA || kind == BETA_GAMMA)
            m.arms[j].beta = 3.0 - (double)j;
        if (kind == GAMMA || kind == BETA_GAMMA || kind == QLV_GAMMA)
            m.arms[j].gamma = 2.5 - 1.5 * (double)j;
    }
    m.dashpot_Ns = kind == DASHPOT || kind == QLV ? 0.7 : 0.0;
    m.quasi_linear = kind == QLV || kind == QLV_GAMMA;
    m.formulation = kind == SEDEF_0 || kind == SEDEF_1 ? PALP_SEDEF2008 : PALP_HISTORY;
    ck_assert_int_eq(palp_material_check(&m, NULL), PALP_OK);
    return m;
}

static inline palp_element_state advance(const palp_material *m, palp_element_state from, double strain,
                                         double dt) {
    palp_element_state to;
    ck_assert_int_eq(palp_element_advance(m, &from, strain, dt, &to, NULL), PALP_OK);
    return to;
}

#endif
