/* machine.h: the figures of the indenter that the firmware is built for. SI units. */
#ifndef MACHINE_H
#define MACHINE_H

#include <stdbool.h>
#include <stdint.h>

enum { CONTROL_HZ = 1000 };
#define TICK_S 0.001f

/* Positions count from the home switch, positive towards the specimen. */
typedef struct machine {
    float count_m;         /* metres an encoder count */
    float travel_m;        /* from home to the lower end */
    float speed_m_s;       /* highest of the drive; a faster change is a jump of the encoder */
    float force_N;         /* of the sensor, and so of any limit */
    float motor_N;         /* force at full duty and standstill */
    float motor_drag_Ns_m; /* force lost with speed, by back-EMF and friction */
    float moving_kg;
    float friction_N;
    float supply_V, resistance_ohm, force_constant_N_A; /* of the motor, for its heat */
    float current_A;                                    /* most that its driver gives */
    float winding_K_W, winding_s; /* rise of the winding over the case, and its time constant */
    float derate_C, fault_C;      /* of the winding: force is held back from, stopped at */
    float following_m;            /* error that is a fault after following_ticks */
    uint16_t following_ticks;
    uint16_t host_timeout_ms;
    uint16_t overflow_samples; /* lost in a run before it is a fault */
    float search_m_s;          /* highest speed of a search or jog towards a possible obstacle */
    /* for a stepper, which follows its steps without control */
    bool stepper;
    int32_t count_nN;    /* of the one channel of its sensor; 0: six channels */
    float force_delay_s; /* largest age of the sensor's reading, */
    float force_lag_s;   /* and on average */
} machine;

extern const machine machine_indenter;     /* the one of doc/indenter.md */
extern const machine machine_stepper;      /* the stepper's machine with an HX711, */
extern const machine machine_stepper_fast; /* and an ADS1220 */

#endif
