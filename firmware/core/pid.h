/* pid.h: position control of the plate. */
#ifndef PID_H
#define PID_H

#include "trajectory.h"

/* Of one class of softness. */
typedef struct gains {
    float stiffness_N_m; /* upper end of the class: specimens up to here */
    float kp_N_m, ki_N_ms, kd_Ns_m;
    float filter_Hz; /* of the derivative */
    float feed_N_m;  /* specimen force fed forward per depth */
} gains;

enum { GAINS_CLASSES = 6, GAINS_MIDDLE = 2 };
extern const gains gains_table[GAINS_CLASSES]; /* softest first; doc/control.md: how they were found */

/* The class for a specimen whose stiffness in its first tenth of a millimetre is so much. */
uint8_t gains_class(const gains table[GAINS_CLASSES], float stiffness_N_m);

typedef struct pid {
    float integral_N; /* of the integral term */
    float slope_m_s;  /* filtered velocity error */
    float last_error_m;
    float friction; /* -1..1: direction and share of the friction that is fed forward */
    float feed_N_m; /* of the last step: where it changes, the integral takes over what it gave */
    bool started;
} pid;

void pid_reset(pid *p);

/* Force for the motor, within +-limit_N, as it gives it at standstill: drag_Ns_m times the reference's
 * velocity is in it, so that duty = force / motor_N. feed_N_m: specimen force fed forward per depth_m, which
 * is that of the reference into the specimen, from contact (0 in the air, or where contact is not known); it
 * may change at any time without a jump of the force. The integral stops where the output is held back
 * (anti-windup). */
float pid_step(pid *p, const gains *g, float feed_N_m, const reference *to, float position_m, float depth_m,
               float moving_kg, float drag_Ns_m, float friction_N, float limit_N);

#endif
