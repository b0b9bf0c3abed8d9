/* app_internal.h: shared by the parts of the app. */
#ifndef APP_INTERNAL_H
#define APP_INTERNAL_H

#include "app.h"

#define MOTION_RATE_M_S 0.005f /* least speed to the start of a run and back */
#define MOTION_AIR_M 1e-3f     /* a search for contact ends so far above it */

/* ---- app_command.c ---- */
void command_take(app *a, const palp_wire_message *command);

/* ---- app_parameters.c ---- */
uint8_t parameters_set(app *a, const palp_wire_set_parameter *asked); /* a palp_wire_result */
bool parameters_get(const app *a, uint8_t id, palp_wire_parameter *one);
void parameters_changed(app *a); /* what follows from them */
uint8_t parameters_save(app *a); /* begins to */
bool parameters_write(app *a,
                      app_outputs *out); /* one word a tick of the parameters being saved; false: none */
palp_wire_configuration parameters_state(const app *a);

/* ---- app_watch.c ---- */
void watch_limits_begin(app *a);   /* the machine's own */
void watch_inputs(app *a);         /* faults seen in the sensors */
void watch_reference(app *a);      /* and in the reference of the motion */
bool watch_persists(const app *a); /* what CLEAR_FAULT would have to leave alone */
bool watch_out_of_travel(const app *a);
bool watch_pressed(
    const app *a); /* a stepper holds a force that is too large, and must be homed away from it */

/* ---- app_motion.c ---- */
void motion_begin(app *a);                /* from rest, where the plate is, or is held */
void motion_withdraw(app *a, float to_m); /* where RETRACT and JOG go */
void motion_stop(app *a);                 /* what STOP ends */
void motion_step(app *a);                 /* the reference of this tick */
bool motion_records(const app *a);
bool motion_follows(const app *a);
bool motion_pulse(app *a); /* whether a trigger's pulse goes out with this tick's sample; once a tick */
/* Where the plate may be, metres from home; in HOMING, from where it began. */
void motion_bounds(const app *a, float *low_m, float *high_m);

/* ---- app_report.c ---- */
void report_tick(app *a, int16_t duty); /* the sample; a status where one is due */
void report_ack(app *a, uint16_t sequence, uint8_t command, uint8_t result);
void report_status(app *a);
void report_info(app *a);
void report_calibration(app *a, uint8_t axis);
void report_gains(app *a, uint8_t softness);
void report_limits(app *a);
void report_parameter(app *a, uint8_t id);
void report_configuration(app *a);

static inline bool app_drives(const app *a) {
    return supervisor_drives(a->supervisor.state);
}

static inline bool app_moving(const app *a) {
    return supervisor_moving(a->supervisor.state);
}

#endif
