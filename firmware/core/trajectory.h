/* trajectory.h: the depth that the plate is to follow, tick by tick, from a list of segments. */
#ifndef TRAJECTORY_H
#define TRAJECTORY_H

#include <palpate/wire.h>

/* Where the plate should be, how fast, and at what acceleration. */
typedef struct reference {
    float position_m, velocity_m_s, acceleration_m_s2;
} reference;

/* A move from rest to rest with a trapezoid of velocity; a short one decelerates before it reaches the rate.
 * It lasts length / rate + rate / acceleration, rounded up to whole ticks by rest at the end. */
typedef struct stroke {
    float start_m, end_m;
    float rate_m_s, acceleration_m_s2; /* signed */
    float ramp_s, rest_s;              /* duration of acceleration, and of rest in the last tick */
    uint32_t tick, ticks;
    bool smooth; /* the velocity changes as a cycloid, with this mean acceleration */
} stroke;

void stroke_begin(stroke *s, float start_m, float end_m, float rate_m_s, float acceleration_m_s2);
/* The next tick's reference; false (and at rest at the end) once it is over. */
bool stroke_step(stroke *s, reference *next);

/* A segment in SI units and ticks; see PALP_WIRE_SEGMENT_KINDS. */
typedef struct segment {
    uint8_t kind;
    bool smooth; /* MOVE, CYCLE: the mean acceleration is then half of the given one */
    float target_m, rate_m_s, acceleration_m_s2;
    float target_N, rate_N_s, deepest_m; /* FORCE */
    uint32_t ticks;                      /* HOLD, SINE, SWEEP; FORCE: at the target */
    uint32_t frequency_uHz;              /* SINE; SWEEP: where it starts */
    float octaves;                       /* SWEEP: from there to its end */
    uint32_t cycles; /* whole periods; after those of a SWEEP it rests until its duration ends */
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
    /* FORCE: measured force, set by the caller before each tick; target now; integral of the error */
    float measured_N, stiffness_N_m; /* of the specimen at its surface */
    float wanted_N, sum_Ns;
    float force_w_s, force_most_m_s; /* poles of the loop, 1/s; highest speed of the plate */
    float touch_N, count_m;          /* force that counts as contact; size of an encoder count */
    float smooth_N;                  /* measured_N, its mean over some ticks */
    bool wants, felt;                /* control of force has begun; contact was felt since */
    uint32_t far_ticks, swing_ticks; /* ticks far below the wanted force; since the last swing */
    int8_t side;                     /* sign of the last swing about the wanted force */
    uint8_t swings;
    uint8_t fault; /* palp_wire_fault: why a FORCE cannot go on */
} trajectory;

/* Most that a segment may ask for: half of what the motor can do to the carriage; ten ticks a period. */
#define TRAJECTORY_ACCELERATION_M_S2 50.0f
enum { TRAJECTORY_FREQUENCY_MHZ = 100000 };

/* PALP_WIRE_RESULT_DONE, or _RANGE for a segment that cannot be followed. That is an unknown kind, or a rate,
 * acceleration, duration, frequency or amplitude of zero or beyond what the drive can do. It is also a SWEEP
 * without a whole period, a wave of more than 65535 periods or 49 days, or a force beyond force_N. */
uint8_t trajectory_check(const palp_wire_segment *wire, float speed_m_s, float force_N);
/* One that trajectory_check accepts; index < PALP_WIRE_SEGMENTS. */
void trajectory_set(trajectory *t, uint8_t index, const palp_wire_segment *wire);

/* Poles of the force loop, 1/s, for this delay of the sensor. */
float trajectory_force_w_s(float delay_s);

/* Whether the loop of a FORCE is stable on a specimen of its stiffness_N_m, with a sensor of this noise. */
bool trajectory_force_stable(const trajectory *t, float noise_N);

bool trajectory_forces(const trajectory *t); /* a FORCE is in progress */
float trajectory_slope(const trajectory *t); /* of the specimen, N/m, as the force loop uses it */

/* Starts at rest at start_m with the first count segments. */
void trajectory_begin(trajectory *t, uint8_t count, float start_m);

/* Where the first count segments lead from start_m on: the range of depths (unknown for FORCE), the
 * highest speed of those that go deeper than 0, and the largest force of a FORCE. */
typedef struct reach {
    float low_m, high_m, speed_m_s, force_N;
} reach;
reach trajectory_reach(const trajectory *t, uint8_t count, float start_m);

/* The next tick's reference; false once the last segment is over, at rest where it ended. Every segment
 * begins and ends at rest and takes at least one tick. MOVE and each half of a CYCLE are strokes; SINE and
 * SWEEP fade in and out by (1 - cos) / 2 over their first and last half period. Time is counted in whole
 * ticks, phase in billionths of a period, so nothing drifts in hours. */
bool trajectory_step(trajectory *t, reference *next);

#endif
