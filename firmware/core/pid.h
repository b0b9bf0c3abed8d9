/* pid.h: position control of the plate. */
#ifndef PID_H
#define PID_H

#include "trajectory.h"

/* Gains of one class of stiffness. */
typedef struct gains {
    float stiffness_N_m; /* upper end of the class: specimens up to here */
    float kp_N_m, ki_N_ms, kd_Ns_m;
    float filter_Hz; /* of the derivative */
    float feed_N_m;  /* specimen force fed forward per depth */
} gains;

enum { GAINS_CLASSES = 6, GAINS_MIDDLE = 2 };
extern const gains gains_table[GAINS_CLASSES]; /* softest first; doc/control.md: how they were found */

/* The class for a specimen of this stiffness in its first tenth of a millimetre. */
uint8_t gains_class(const gains table[GAINS_CLASSES], float stiffness_N_m);

typedef struct pid {
    float integral_N; /* of the integral term */
    float slope_m_s;  /* filtered velocity error */
    float last_error_m;
    float friction; /* -1..1: direction and share of the friction that is fed forward */
    float feed_N_m; /* of the last step; when it changes, the integral takes over the difference */
    bool started;
} pid;

void pid_reset(pid *p);

/* Force of the motor at standstill, within +-limit_N: duty = force / motor_N, as drag_Ns_m times the
 * reference's velocity is included. feed_N_m: feedforward of the specimen's force per depth_m, the depth of
 * the reference (0 in the air, or if contact is unknown). A change of feed_N_m makes no jump of the force.
 * The integral does not grow while the output is limited (anti-windup). */
float pid_step(pid *p, const gains *g, float feed_N_m, const reference *to, float position_m, float depth_m,
               float moving_kg, float drag_Ns_m, float friction_N, float limit_N);

#endif
