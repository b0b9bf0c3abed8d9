/* plant_specimen.h: what the plate presses: a lumped model, a network, a rigid block or air. */
#ifndef PALPATE_PLANT_SPECIMEN_H
#define PALPATE_PLANT_SPECIMEN_H

#include "plant.h"

#include <palpate/palpate.h>

typedef struct specimen {
    plant_specimen kind;
    const char *path; /* of its model, for errors */
    palp_model model;
    palp_network *network; /* a network model's */
    double height_m, scale, rigid_N_m;
    double compliance_m_N;        /* of the frame in series */
    palp_element_state now, next; /* lumped: committed and on trial */
    double slope_N_m;             /* network: stiffness last seen */
    bool tried;                   /* in this step, and what came of it */
    double tried_m, tried_N;
    double surface_m; /* where its top is: 0 undeformed, positive pressed in */
    double force_N;   /* on the plate, never negative */
} specimen;

/* compliance_m_N: of the frame. The caller frees it, also after a failure. */
palp_status specimen_create(const plant_settings *settings, specimen *s, palp_error *error);
void specimen_free(specimen *s);

/* A network takes one step a control tick, everything else one a substep. */
bool specimen_is_slow(const specimen *s);

/* Advances by dt_s to where a plate behind a stiff frame would be reach_m into the specimen. The plate cannot
 * pull: a specimen left behind recovers by itself. Leaves surface_m and force_N. */
palp_status specimen_advance(specimen *s, double reach_m, double dt_s);

#endif
