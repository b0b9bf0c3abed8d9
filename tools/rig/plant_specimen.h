/* plant_specimen.h: the object under the plate: a lumped model, a network, a rigid block or air. */
#ifndef PALPATE_PLANT_SPECIMEN_H
#define PALPATE_PLANT_SPECIMEN_H

#include "plant.h"

#include <palpate/palpate.h>

typedef struct specimen {
    palp_specimen *pressed; /* NULL: air */
    const char *path;       /* of its model, for errors */
    bool slow;              /* a network takes one step a control tick, everything else one a substep */
    double compliance_m_N;  /* of the frame: the model's and the actuator's in series */
    double range_N;         /* force_saturation of its model, left to the amplifier; 0 = none */
    double force_N;         /* on the plate; negative where it sticks */
} specimen;

/* The caller frees it, also after a failure. */
palp_status specimen_create(const plant_settings *settings, specimen *s, palp_error *error);
void specimen_free(specimen *s);

/* Advances by dt_s to where a plate behind a stiff frame would be reach_m into the specimen. */
palp_status specimen_advance(specimen *s, double reach_m, double dt_s);

/* The force as its model's sensor reads it. */
double specimen_sense(const specimen *s, const palp_specimen_motion *motion);

#endif
