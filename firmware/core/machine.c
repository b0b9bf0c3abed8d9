/* machine.c: the figures of the indenter that the firmware is built for. */
#include "machine.h"

/* doc/indenter.md; the simulated actuator of tools/plant.h has the same. */
const machine machine_indenter = {
    .count_m = 1e-6f,
    .travel_m = 0.030f,
    .speed_m_s = 0.25f,
    .force_N = 24.0f,
    .motor_N = 72.0f,
    .motor_drag_Ns_m = 40.0f,
    .moving_kg = 0.4f,
    .friction_N = 0.15f,
    .supply_V = 24.0f,
    .resistance_ohm = 4.0f,
    .force_constant_N_A = 12.0f,
    .current_A = 3.5f,
    .winding_K_W = 2.5f,
    .winding_s = 100.0f,
    .derate_C = 90.0f,
    .fault_C = 110.0f,
    .following_m = 0.001f,
    .following_ticks = 20,
    .host_timeout_ms = 5000,
    .overflow_samples = 1000,
};
