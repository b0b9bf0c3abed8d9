/* thermal.h: how hot the motor is: its case by a thermistor, its winding by a model of its heating. */
#ifndef THERMAL_H
#define THERMAL_H

#include "machine.h"

#include <stdbool.h>

enum {
    THERMAL_TICKS = 64
}; /* ticks of heat summed for a step of the winding; one tick is too small for a float */

typedef struct thermal {
    float case_C;         /* filtered thermistor; keeps its value while broken */
    float rise_K;         /* of the winding over the case; starts at 0, since only the case is measured */
    float heat_W;         /* sum of the ticks since the last step of the winding */
    uint16_t ticks;       /* these */
    bool started, broken; /* broken: the thermistor reads open or short */
} thermal;

/* One tick: heat of the current that duty (-1..1) drives at this speed, and the thermistor's counts. */
void thermal_step(thermal *t, const machine *m, float duty, float velocity_m_s, uint16_t thermistor);
float thermal_winding_C(const thermal *t);
/* Share of the full force that may be used: 1 below derate_C, 0 at fault_C, linear between. */
float thermal_derating(const thermal *t, const machine *m);
/* 10 kOhm NTC (B 3950 K) to ground below 10 kOhm to the reference; 12-bit counts. Clamped to -40..150. */
float thermal_thermistor_C(uint16_t counts);

#endif
