/* trajectory.h: the depth that the plate is to follow, tick by tick, from a list of segments. */
#ifndef TRAJECTORY_H
#define TRAJECTORY_H

#include <palpate/wire.h>

/* Where the plate should be, how fast, and at what acceleration. */
typedef struct reference {
    float position_m, velocity_m_s, acceleration_m_s2;
} reference;

/* From rest to rest in a straight line: velocity rises at the acceleration, stays at the rate, falls at the
 * acceleration; a short stroke turns before it reaches the rate. Lasts length / rate + rate /
 * acceleration, rounded up to whole ticks: what is left of the last tick is rest at the end. */
typedef struct stroke {
    float start_m, end_m;
    float rate_m_s, acceleration_m_s2; /* signed */
    float ramp_s, rest_s;              /* of the velocity, up or down; of the last tick, at the end */
    uint32_t tick, ticks;
    bool smooth; /* the velocity rises and falls as a cycloid, whose mean acceleration is that */
} stroke;

void stroke_begin(stroke *s, float start_m, float end_m, float rate_m_s, float acceleration_m_s2);
/* The next tick's reference; false (and at rest at the end) once it is over. */
bool stroke_step(stroke *s, reference *next);

/* A segment in SI units and ticks; see PALP_WIRE_SEGMENT_KINDS. */
typedef struct segment {
    uint8_t kind;
    bool smooth; /* MOVE, CYCLE; half of the acceleration is then on average */
    float target_m, rate_m_s, acceleration_m_s2;
    float target_N, rate_N_s, deepest_m; /* FORCE */
    uint32_t ticks;                      /* HOLD, SINE, SWEEP; FORCE: at the target */
    uint32_t frequency_uHz;              /* SINE; SWEEP: where it starts */
    float octaves;                       /* SWEEP: from there to its end */
    uint32_t cycles; /* whole periods; a SWEEP's fit into its duration, and it rests for what is left */
} segment;

typedef struct trajectory {
    segment list[PALP_WIRE_SEGMENTS];
    uint8_t count, current;
    uint32_t tick;          /* within the current segment's HOLD, SINE or SWEEP */
    uint32_t cycle;         /* strokes of a CYCLE, periods of a wave */
    uint32_t phase;         /* of a wave: billionths of a period */
    uint32_t frequency_uHz; /* of a wave, now */
    float start_m;          /* where the current segment began */
    stroke stroke;
    reference now;
    /* of FORCE: the caller's, before each tick; the force that it is to be; integral of what it is off by */
    float measured_N, stiffness_N_m; /* of the specimen at its surface */
    float wanted_N, sum_Ns;
    float force_w_s, force_most_m_s; /* how fast the loop is; the plate in it at most */
    float touch_N, count_m;          /* so much is a specimen that is felt; a count of the encoder */
    float smooth_N;                  /* measured_N, its mean over some ticks */
    bool wants, felt;                /* it has begun, from the force that there was; felt since */
    uint32_t far_ticks, swing_ticks; /* so long far below what is wanted; since the last swing */
    int8_t side;                     /* of what is wanted, where the last swing went to */
    uint8_t swings;
    uint8_t fault; /* palp_wire_fault: why a FORCE cannot go on */
} trajectory;

/* Most that a segment may ask for: half of what the motor can do to the carriage; ten ticks a period. */
#define TRAJECTORY_ACCELERATION_M_S2 50.0f
enum { TRAJECTORY_FREQUENCY_MHZ = 100000 };

/* PALP_WIRE_RESULT_DONE, or _RANGE for a segment that cannot be followed: an unknown kind, a rate,
 * acceleration, duration, frequency or amplitude of zero or beyond what the drive can do, no whole period
 * in a SWEEP, a wave of more than 65535 periods or 49 days, a force beyond force_N. */
uint8_t trajectory_check(const palp_wire_segment *wire, float speed_m_s, float force_N);
/* One that trajectory_check accepts; index < PALP_WIRE_SEGMENTS. */
void trajectory_set(trajectory *t, uint8_t index, const palp_wire_segment *wire);

/* How fast the force's loop may be where the sensor is this late. */
float trajectory_force_w_s(float delay_s);

/* Whether the loop of a FORCE is stable on a specimen of its stiffness_N_m, with a sensor of this noise. */
bool trajectory_force_stable(const trajectory *t, float noise_N);

bool trajectory_forces(const trajectory *t); /* a FORCE is in progress */
float trajectory_slope(const trajectory *t); /* of the specimen, N/m, as its loop believes it to be */

/* Starts at rest at start_m with the first count segments. */
void trajectory_begin(trajectory *t, uint8_t count, float start_m);

/* Where the first count segments lead from start_m on: the range of depths (of FORCE nobody knows it), the
 * highest speed of those that go deeper than 0, and the largest force of a FORCE. */
typedef struct reach {
    float low_m, high_m, speed_m_s, force_N;
} reach;
reach trajectory_reach(const trajectory *t, uint8_t count, float start_m);

/* The next tick's reference; false once the last segment is over, at rest where it ended. Every segment
 * begins and ends at rest, also between two MOVEs the same way, and takes a tick at least. Velocity never
 * jumps: MOVE and each way of a CYCLE are strokes; SINE and SWEEP fade in and out by (1 - cos) / 2 over their
 * first and last half period. Time is kept in whole ticks, the phase of a wave in billionths of a period:
 * nothing drifts in segments of hours. */
bool trajectory_step(trajectory *t, reference *next);

#endif
