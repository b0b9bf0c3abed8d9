/* plant_internal.h: the parts of the plant: drive and sensor; the specimen has a header of its own. */
#ifndef PALPATE_PLANT_INTERNAL_H
#define PALPATE_PLANT_INTERNAL_H

#include "force.h"
#include "plant.h"

/* Fills error with a formatted line; returns status. plant_fail.c */
palp_status plant_fail(palp_error *error, palp_status status, const char *format, ...);

/* ---- motor and carriage: plant_actuator.c ---- */

typedef enum drive_hold { DRIVE_FREE, DRIVE_JAMMED, DRIVE_DRAGGED } drive_hold;

typedef struct drive {
    double carriage_m, velocity_m_s; /* velocity half a substep earlier: the leapfrog's */
    double current_A, winding_C, case_C;
    drive_hold hold;
} drive;

drive drive_start(const plant_actuator *a);

/* Advances a motor (PLANT_MOTOR_*) under a voltage by dt_s against the specimen's force. */
/* Advances a stepper at a speed by dt_s, whatever force it meets. */
void drive_step(const plant_actuator *a, drive *d, double speed_m_s, double dt_s);
void drive_advance(const plant_actuator *a, drive *d, uint8_t motor, double volt, double load_N, double dt_s);

/* ---- sensor, thermistor: plant_sensor.c ---- */

typedef struct sensor {
    plant_sensor settings;
    double counts_N[PALP_WIRE_CHANNELS]; /* of a pure z force, each channel: a column of the inverse matrix */
    double z_counts[PALP_WIRE_CHANNELS]; /* N a count: the sensor's own matrix row */
    double rest[PALP_WIRE_CHANNELS];     /* counts without force: its mounting strains it sideways */
    double noise_counts;                 /* sd of each channel */
    /* Of a stepper's sensor, which has one channel: an HX711 gives the mean of 50 ms 80 times a second, the
     * fast one a sample each tick. */
    double gathered, n_gathered, said[4]; /* of the sample in progress; the last four */
    int16_t held;
} sensor;

/* For the matrix that the firmware starts with. False where it has no inverse. */
bool sensor_start(const plant_sensor *settings, sensor *s);

/* A tick of a stepper's sensor: true where it has a new sample, which is then in held. */
bool sensor_gather(sensor *s, bool fast, double force_N, uint32_t tick);

/* The z force that brings the first channel to its rail. */
double sensor_range(const sensor *s);

/* Converts the force at tick number tick, other forces and torques being zero. */
void sensor_convert(const sensor *s, double force_N, uint32_t tick, int16_t adc[PALP_WIRE_CHANNELS]);

/* 12-bit counts of the divider with a 10 kOhm NTC (B 3950 K) below 10 kOhm. */
uint16_t sensor_thermistor(double celsius);

#endif
