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
    .search_m_s = 0.01f,
};

/* A count is a sixteenth of a step of 1.8 degrees, on a screw of 2 mm a turn. An HX711 gives the mean of the
 * last 50 ms every 12.5 ms. Within this delay and two ticks the frame and cell (1e5 N/m) add 13 N at the
 * speed of a search (doc/indenter.md). A stepper has no motor force to control, so its force and heat come
 * out as zero. */
#define STEPPER                                                                                              \
    .count_m = 0.625e-6f, .travel_m = 0.030f, .speed_m_s = 0.005f, .force_N = 20.0f, .motor_N = 72.0f,       \
    .moving_kg = 0.4f, .supply_V = 24.0f, .resistance_ohm = 4.0f, .force_constant_N_A = 12.0f,               \
    .current_A = 3.5f, .winding_K_W = 2.5f, .winding_s = 100.0f, .derate_C = 90.0f, .fault_C = 110.0f,       \
    .following_m = 0.001f, .following_ticks = 20, .host_timeout_ms = 5000, .overflow_samples = 1000,         \
    .stepper = true, .count_nN = 1500000,

const machine machine_stepper = {STEPPER.search_m_s = 0.002f, .force_delay_s = 0.0625f,
                                 .force_lag_s = 0.03125f};

/* An ADS1220 gives in each tick the mean of the last one. */
const machine machine_stepper_fast = {STEPPER.search_m_s = 0.005f, .force_delay_s = 0.002f,
                                      .force_lag_s = 0.001f};
