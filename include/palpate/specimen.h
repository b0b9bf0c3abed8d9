/* specimen.h: a model pressed step by step, for paths that are not known in advance: a haptic loop, a
 * simulated instrument. The physics is that of forward.h: one-sided contact and all effects of the model.
 * May change. */
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
    double table_N_m; /* stiffness of the table below, which the plate meets at 95 % of the specimen's height;
                         0 = no table */
    double session_s; /* when in the session it is made (session_ageing); 0 */
    double step_s;    /* shortest step for which power law and pores are accurate; 1 ms */
    double span_s;    /* and the longest total time; 1000 s */
    double fastest_m_s; /* the plate's largest speed, below a thousandth of which coulomb_friction fades; 0 =
                           the largest so far */
    palp_network_settings network; /* density is the model's */
} palp_specimen_settings;

PALP_API palp_specimen_settings palp_specimen_settings_default(void);

/* A specimen at rest, of a copy of the model, whose mesh is not needed any more; settings may be NULL
 * (defaults). The caller frees it with palp_specimen_free. ERR_UNSUPPORTED: a lumped model in PALP_SEDEF2008;
 * the errors of palp_network_create. */
PALP_API palp_status palp_specimen_create(const palp_model *model, const palp_specimen_settings *settings,
                                          palp_specimen **specimen, palp_error *error);
PALP_API void palp_specimen_free(palp_specimen *specimen);

/* Moves the encoder at constant speed within dt_s > 0 to depth_m (0 = nominal contact). *force_N is then the
 * specimen's force on the plate, negative only if it sticks. A specimen that the plate has left recovers on
 * its own. Steps along the samples of a recording give the force of palp_forward_force without its sensor,
 * to rounding, with two exceptions. session_ageing is that of the last contact, and rate_stiffening uses the
 * rate of the step. It allocates nothing itself; a network's solver may. ERR_ARGUMENT: a depth or time that
 * is not finite; the specimen is unchanged. After any other error it can only be freed. */
PALP_API palp_status palp_specimen_step(palp_specimen *specimen, double depth_m, double dt_s,
                                        double *force_N);

/* The motion of the encoder at a reading of the sensor. */
typedef struct palp_specimen_motion {
    double time_s; /* sensor_drift and mains_hum start at 0 */
    double depth_m, velocity_m_s, acceleration_m_s2;
} palp_specimen_motion;

/* The sensor's reading of the last step's force, N; that force itself if the model has no effects of the
 * sensor. Between two readings the force changes linearly (sensor_lag). If the time is not later than that
 * of the last reading, that reading is returned. */
PALP_API double palp_specimen_sense(palp_specimen *specimen, const palp_specimen_motion *motion);

#ifdef __cplusplus
}
#endif
#endif
