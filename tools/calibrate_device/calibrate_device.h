/* calibrate_device.h: palpate calibrate-device: the parameters of an indenter, and the steps that measure
 * them. */
#ifndef PALPATE_CALIBRATE_DEVICE_H
#define PALPATE_CALIBRATE_DEVICE_H

#include "acquire/acquire_setup.h"
#include "machine_trace.h"
#include "indenter/device_parameters.h"

enum { MACHINE_WORDS = 64 };

typedef struct machine_options {
    acquire_setup setup;
    bool json, yes, hanging, large_change;
    acquire_plan *plan; /* the trace of the session, for the step */
    cli_list weights_g;
    size_t channel; /* channel of the sensor, from 1, to calibrate alone; 0: all by their matrix */
    double gravity_m_s2, average_s, force_N; /* 0: not given */
    const char *out;                         /* of show: a file */
    size_t n_words;
    const char *word[MACHINE_WORDS]; /* behind the action */
} machine_options;

#define MACHINE_NAME "calibrate-device"

/* Brings the device to IDLE, where parameters can be set; a held plate is released. Returns an exit code,
 * after one line if it is not 0. */
int machine_idle(device *d);
int machine_failure(device *d, device_result result);
/* Asks and reads a line; true for yes, or with --yes. End of input means no. */
bool machine_agrees(const machine_options *o, const char *question);

/* Results of a step: on stderr as they come, and as JSON at its end (machine_result.c). */
typedef struct machine_result {
    const char *step;
    json_t *figures;
} machine_result;
void machine_tell(machine_result *r, const char *name, double value, double half,
                  const char *what); /* half NAN: no interval */
int machine_finish(const machine_options *o, machine_result *r,
                   int code); /* the exit code; frees the figures */
/* Waits for Enter; false at the end of the input. machine_ready_unless: not with --yes. */
bool machine_ready(const char *prompt);
bool machine_ready_unless(const machine_options *o, const char *prompt);
/* An exit code, after one line if it is not 0. */
int machine_ended(session *s, outcome end);

/* Steps (step_*.c). */
int step_weights(const machine_options *o, session *s);
int step_block(const machine_options *o, session *s);
int step_air(const machine_options *o, session *s);
int step_gains(const machine_options *o, session *s);

/* The actions; each returns an exit code (machine_file.c). */
int machine_show(const machine_options *o, session *s);
int machine_set(const machine_options *o, session *s);      /* NAME=VALUE ... */
int machine_load(const machine_options *o, session *s);     /* FILE.json */
int machine_standard(const machine_options *o, session *s); /* what is compiled in */

/* Parameters to set. Asks, sets and saves them; returns an exit code. */
typedef struct machine_change {
    const device_parameter *one;
    double value;
} machine_change;
int machine_change_all(const machine_options *o, device *d, size_t n, const machine_change *change);

double machine_today(void); /* days since 1970-01-01 */

#endif
