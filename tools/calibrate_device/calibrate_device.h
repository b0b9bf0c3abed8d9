/* calibrate_device.h: palpate calibrate-device: what can be set of an indenter, and steps that measure it. */
#ifndef PALPATE_CALIBRATE_DEVICE_H
#define PALPATE_CALIBRATE_DEVICE_H

#include "acquire/acquire_setup.h"
#include "rig/device_parameters.h"

enum { MACHINE_WORDS = 64 };

typedef struct machine_options {
    acquire_setup setup;
    bool json, yes;
    const char *out; /* of show: a file */
    size_t n_words;
    const char *word[MACHINE_WORDS]; /* behind the action */
} machine_options;

#define MACHINE_NAME "calibrate-device"

/* Into IDLE, where parameters can be set: lets go of a plate that is held. An exit code, after one line if it is not 0. */
int machine_idle(device *d);
int machine_failure(device *d, device_result result);
/* Reads a line; true for yes. --yes says it without asking; the end of the input is a no. */
bool machine_agrees(const machine_options *o, const char *question);

/* The actions; each returns an exit code (machine_file.c). */
int machine_show(const machine_options *o, device *d);
int machine_set(const machine_options *o, device *d);      /* NAME=VALUE ... */
int machine_load(const machine_options *o, device *d);     /* FILE.json */
int machine_standard(const machine_options *o, device *d); /* what is compiled in */

/* A value that is to be set; and setting and keeping them after asking: an exit code. */
typedef struct machine_change {
    const device_parameter *one;
    double value;
} machine_change;
int machine_change_all(const machine_options *o, device *d, size_t n, const machine_change *change);

/* Days since 1970-01-01; and as 2026-03-01, empty for 0. */
double machine_today(void);
void machine_date(double day, char text[16]);

#endif
