/* specimen.h: a model pressed step by step, for what runs as it goes: a haptic loop, a simulated instrument.
 * The physics of forward.h, whose path is known in advance: one-sided contact and all the model's effects. */
#ifndef PALPATE_SPECIMEN_H
#define PALPATE_SPECIMEN_H

#include <palpate/model.h>
#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_specimen palp_specimen;

typedef struct palp_specimen_settings {
    double start_m;   /* where the plate stands at first; 0 = at the surface, negative = in the air */
    double scale;     /* the specimen's force is multiplied by this; 1 */
    double table_N_m; /* stiffness of what it lies on, met at 95 % of its height; 0 = it lies on nothing */
    double session_s; /* when in the session it is made (session_ageing); 0 */
    double step_s;    /* a network's relaxation spectrum holds for steps from so short; 1 ms */
    double span_s;    /* and so long in all; 1000 s */
    palp_network_settings network; /* density is the model's */
} palp_specimen_settings;

PALP_API palp_specimen_settings palp_specimen_settings_default(void);

/* Of a copy of the model, at rest; settings may be NULL. ERR_UNSUPPORTED: a lumped model in PALP_SEDEF2008.
 * The errors of palp_network_create. The caller frees it with palp_specimen_free. */
PALP_API palp_status palp_specimen_create(const palp_model *model, const palp_specimen_settings *settings,
                                          palp_specimen **specimen, palp_error *error);
PALP_API void palp_specimen_free(palp_specimen *specimen);

/* Moves the encoder evenly in dt_s > 0 to depth_m (0 = nominal contact); *force_N is what the specimen then
 * does to the plate, negative only where it sticks. A specimen left behind recovers on its own. Steps along
 * the samples of a recording give the true force of palp_forward_force but for rounding, except that
 * session_ageing is as of the last contact, and that the rate for rate_stiffening is that of the step.
 * Allocates nothing, but for what a network's solver may. ERR_ARGUMENT: a depth or time that is not finite,
 * nothing changed; after any other error it is only good for being freed. */
PALP_API palp_status palp_specimen_step(palp_specimen *specimen, double depth_m, double dt_s,
                                        double *force_N);

/* How the encoder moves where the sensor is read. */
typedef struct palp_specimen_motion {
    double time_s; /* sensor_drift and mains_hum start at 0 */
    double depth_m, velocity_m_s, acceleration_m_s2;
} palp_specimen_motion;

/* What the model's sensor reads of the last step's force: that force where it has no such effects. Between
 * two readings the force is taken to be straight (sensor_lag); at a time not after that of the last reading
 * this is that again. */
PALP_API double palp_specimen_sense(palp_specimen *specimen, const palp_specimen_motion *motion);

#ifdef __cplusplus
}
#endif
#endif
