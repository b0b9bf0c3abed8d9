/* thermal.c: how hot the motor is: its case by a thermistor, its winding by a model of its heating. */
#include "thermal.h"

#include "real.h"

/* Counts of the divider every 5 K from 150 C down to -40: 4095 r / (1 + r) with r = exp(3950 / T - 3950 /
 * 298.15), T in kelvin. */
enum { TABLE = 39, STEP_K = 5, HOTTEST_C = 150, SHORT = 40, OPEN = 4040 };
static const float table[TABLE] = {
    80.2f,   89.4f,   100.0f,  112.1f,  125.9f,  141.9f,  160.2f,  181.3f,  205.8f,  234.1f,
    267.0f,  305.2f,  349.7f,  401.4f,  461.6f,  531.6f,  612.8f,  706.9f,  815.4f,  939.8f,
    1081.4f, 1241.0f, 1418.8f, 1614.0f, 1824.7f, 2047.5f, 2277.9f, 2510.1f, 2737.9f, 2955.1f,
    3156.2f, 3337.0f, 3495.0f, 3629.1f, 3740.1f, 3829.6f, 3900.2f, 3954.6f, 3995.6f,
};

/* Of the thermistor, a tick: 64 ms, far below the case's time constant. */
#define FILTER (1.0f / 64)

float thermal_thermistor_C(uint16_t counts) {
    float x = real_clamp((float)counts, table[0], table[TABLE - 1]);
    int i = 0;
    while (i < TABLE - 2 && x > table[i + 1])
        i++;
    float share = (x - table[i]) / (table[i + 1] - table[i]);
    return (float)HOTTEST_C - (float)STEP_K * ((float)i + share);
}

static void read_case(thermal *t, uint16_t counts) {
    t->broken = counts < SHORT || counts > OPEN;
    if (t->broken)
        return;
    float reading = thermal_thermistor_C(counts);
    t->case_C = t->started ? t->case_C + FILTER * (reading - t->case_C) : reading;
    t->started = true;
}

static float heat_W(const machine *m, float duty, float velocity_m_s) {
    float current = (duty * m->supply_V - m->force_constant_N_A * velocity_m_s) / m->resistance_ohm;
    current = real_clamp(current, -m->current_A, m->current_A);
    return current * current * m->resistance_ohm;
}

void thermal_step(thermal *t, const machine *m, float duty, float velocity_m_s, uint16_t thermistor) {
    read_case(t, thermistor);
    t->heat_W += heat_W(m, duty, velocity_m_s);
    if (++t->ticks < THERMAL_TICKS)
        return;
    float x = (float)THERMAL_TICKS * TICK_S / m->winding_s;
    float final_K = t->heat_W / (float)THERMAL_TICKS * m->winding_K_W;
    t->rise_K += (final_K - t->rise_K) * (x - 0.5f * x * x); /* 1 - exp(-x) */
    t->heat_W = 0.0f;
    t->ticks = 0;
}

float thermal_winding_C(const thermal *t) {
    return t->case_C + t->rise_K;
}

float thermal_derating(const thermal *t, const machine *m) {
    return real_clamp((m->fault_C - thermal_winding_C(t)) / (m->fault_C - m->derate_C), 0.0f, 1.0f);
}
