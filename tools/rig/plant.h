/* plant.h: the indenter and its specimen, simulated: motor, carriage, frame, specimen, sensor. One call a
 * control tick. A pure module: no files but the model and the actuator, no processes, no clock. */
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
    double lift_N;         /* of the balance: so much more than the carriage weighs; negative: less */
    double backlash_m;     /* play of the plate below the encoder; held in it by coulomb_N */
    double travel_m;       /* from the home switch; hard stops stand 1 mm beyond both ends */
    double count_m;        /* of the encoder */
    double start_m;        /* where the plate stands at power-on, from the home switch */
    double compliance_m_N; /* of the frame: the plate gives way behind the encoder */
    double winding_K_W, winding_J_K, case_K_W, case_J_K, ambient_C;
} plant_actuator;

typedef struct plant_sensor {
    double noise_N; /* sd on z of white noise on every channel */
    double hum_N;   /* 50 Hz amplitude on z */
    double bias_N, drift_N_s;
    double
        range_N; /* the amplifier clips z and noise here, short of the converter's rails; 0 = it does not */
    double gain; /* 1 */
    uint64_t seed;
} plant_sensor;

typedef enum plant_specimen { PLANT_MODEL, PLANT_RIGID, PLANT_AIR } plant_specimen;

typedef struct plant_settings {
    plant_actuator actuator;
    uint8_t machine; /* PLANT_VOICE_COIL; PLANT_STEPPER...: one in the place of the motor; its sensor has one
                        channel, and is slow */
    plant_sensor sensor;
    plant_specimen specimen;
    const char *model; /* path, with PLANT_MODEL; NULL = the phantom of the thesis, N = 2 */
    double scale;      /* the specimen's force is multiplied by this; 1 */
    double contact_m;  /* the specimen's top, from the home switch */
    double rigid_N_m;  /* a rigid block's own stiffness, and the table's beneath a specimen */
} plant_settings;

plant_settings plant_settings_default(void);
plant_actuator plant_actuator_default(void);

/* Reads {"palpate": {"actuator": 1}, "moving_kg": ..., ...}: keys as the members above with their units,
 * lengths in mm; what is absent stays as it was. ERR_INPUT with file and line. */
palp_status plant_actuator_read(const char *path, plant_actuator *actuator, palp_error *error);

palp_status plant_create(const plant_settings *settings, plant **made, palp_error *error);
void plant_free(plant *p);

/* What can go wrong with it, from now on until lifted; a jump has happened, and heat goes by itself. */
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
    PLANT_DRIVER     /* the motor's driver gives its alarm and no current */
} plant_fault;
void plant_inject(plant *p, plant_fault fault);
void plant_lift(plant *p, plant_fault fault);
void plant_put(plant *p,
               double force_N); /* what a weight on the sensor gives it from now on, besides the specimen */

/* First record, before any tick and again after a restart of the firmware (the encoder counts from there);
 * then one record a tick: the plant under this output for 1 ms. What the plant does not know (events, rx,
 * reset_cause) is 0. ERR_NOT_CONVERGED and the like, with a line, where a network gives up. */
void plant_first(plant *p, plant_in *in);
palp_status plant_step(plant *p, const plant_out *out, plant_in *in, palp_error *error);

/* What is true, for tests and the rig's log. */
typedef struct plant_truth {
    double time_s, carriage_m, velocity_m_s; /* from the home switch */
    double depth_m;                          /* of the plate into the specimen, compliance taken off */
    double force_N;                          /* of the specimen on the plate */
    double winding_C, case_C, current_A;
} plant_truth;
plant_truth plant_look(const plant *p);

#endif
