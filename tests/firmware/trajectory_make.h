/* trajectory_make.h: what the tests of trajectories share. */
#ifndef TRAJECTORY_MAKE_H
#define TRAJECTORY_MAKE_H

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static const double PI = 3.14159265358979323846, SPEED = 0.25;

static const palp_wire_segment good[] = {
    {.kind = PALP_WIRE_SEGMENT_MOVE,
     .target_nm = 5000000,
     .rate_nm_s = 5000000,
     .acceleration_um_s2 = 500000},
    {.kind = PALP_WIRE_SEGMENT_HOLD, .duration_ms = 1},
    {.kind = PALP_WIRE_SEGMENT_CYCLE, .rate_nm_s = 1, .acceleration_um_s2 = 1, .cycles = 1},
    {.kind = PALP_WIRE_SEGMENT_SINE, .target_nm = -500000, .frequency_mHz = 1000, .cycles = 65535},
    {.kind = PALP_WIRE_SEGMENT_SWEEP,
     .target_nm = 500000,
     .frequency_mHz = 100,
     .frequency_end_mHz = 10000,
     .duration_ms = 10000}};

#endif
