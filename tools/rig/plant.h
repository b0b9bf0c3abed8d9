/* plant.h: the indenter and its specimen, simulated: motor, carriage, frame, specimen, sensor. One call a
 * control tick. It opens no files but the model and the actuator, and uses no processes and no clock. */
#ifndef PALPATE_PLANT_H
#define PALPATE_PLANT_H

#include "plant_link.h"

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct plant plant;

/* The motor, carriage and frame; SI units. plant_actuator_default() is the machine of doc/indenter.md. */
typedef struct plant_actuator {
    double force_constant_N_A, resistance_ohm, supply_V, current_A; /* current: the driver's limit */
    double moving_kg, viscous_Ns_m, coulomb_N;
    double lift_N;         /* force of the balance beyond the carriage's weight; may be negative */
    double backlash_m;     /* play of the plate below the encoder, within which coulomb_N holds it */
    double travel_m;       /* from the home switch; hard stops stand 1 mm beyond both ends */
    double count_m;        /* of the encoder */
    double start_m;        /* where the plate stands at power-on, from the home switch */
    double compliance_m_N; /* of the frame: the plate yields, and the encoder does not see it */
    double winding_K_W, winding_J_K, case_K_W, case_J_K, ambient_C;
} plant_actuator;

typedef struct plant_sensor {
    double noise_N; /* sd on z of white noise on every channel */
    double hum_N;   /* 50 Hz amplitude on z */
    double bias_N, drift_N_s;
    double range_N; /* the amplifier clips z and noise here, below the converter's rails; 0 = never */
    double gain;    /* 1 */
    uint64_t seed;
} plant_sensor;

typedef enum plant_specimen { PLANT_MODEL, PLANT_RIGID, PLANT_AIR } plant_specimen;

typedef struct plant_settings {
    plant_actuator actuator;
    uint8_t machine; /* PLANT_VOICE_COIL, or PLANT_STEPPER...: a stepper instead, with a sensor of one slow
                        channel */
    plant_sensor sensor;
    plant_specimen specimen;
    const char *model; /* path, with PLANT_MODEL; NULL = the phantom of the thesis, N = 2 */
    double scale;      /* the specimen's force is multiplied by this; 1 */
    double contact_m;  /* the specimen's top, from the home switch */
    double rigid_N_m;  /* of a rigid block, and of the table below a specimen */
} plant_settings;

plant_settings plant_settings_default(void);
plant_actuator plant_actuator_default(void);

/* Reads {"palpate": {"actuator": 1}, "moving_kg": ..., ...}. Keys are the members above with their units,
 * lengths in mm; members without a key keep their value. ERR_INPUT with file and line. */
palp_status plant_actuator_read(const char *path, plant_actuator *actuator, palp_error *error);

palp_status plant_create(const plant_settings *settings, plant **made, palp_error *error);
void plant_free(plant *p);

/* Faults of the plant, each until it is lifted. A jump happens once, and heat goes away by itself. */
typedef enum plant_fault {
    PLANT_OBSTACLE,  /* the sensor meets something hard */
    PLANT_PUSHED,    /* the carriage is dragged to beyond its travel */
    PLANT_HOT,       /* the motor heats to 120 C */
    PLANT_JAMMED,    /* the carriage does not move */
    PLANT_SILENT,    /* the converter does not answer */
    PLANT_SATURATED, /* one channel at its rail */
    PLANT_JUMP,      /* the encoder jumps by 5000 counts */
    PLANT_EMERGENCY, /* the emergency stop is pressed */
    PLANT_ENCODER,   /* the encoder gives its alarm and counts no more */
    PLANT_DRIVER,    /* the motor's driver gives its alarm and no current */
    PLANT_GONE,      /* there is no specimen any more */
    PLANT_SHAKEN     /* the force on the sensor swings by half of it, five times a second */
} plant_fault;
void plant_inject(plant *p, plant_fault fault);
void plant_lift(plant *p, plant_fault fault);
void plant_put(plant *p,
               double force_N); /* puts a weight on the sensor, whose force adds to the specimen's */

/* The first record, before any tick and again after a restart of the firmware; the encoder counts from there.
 * Then one record a tick: the plant under this output for 1 ms. Fields that the plant does not know (events,
 * rx, reset_cause) are 0. Fails with a line of text where a network's step does. */
void plant_first(plant *p, plant_in *in);
palp_status plant_step(plant *p, const plant_out *out, plant_in *in, palp_error *error);

/* The true values, for tests and the rig's log. */
typedef struct plant_truth {
    double time_s, carriage_m, velocity_m_s; /* from the home switch */
    double depth_m; /* of the plate into the specimen, without the frame's compliance */
    double force_N; /* of the specimen on the plate */
    double winding_C, case_C, current_A;
} plant_truth;
plant_truth plant_look(const plant *p);

#endif
