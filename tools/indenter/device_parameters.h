/* device_parameters.h: the parameters of an indenter, by name: read, set, saved in its flash. */
#ifndef PALPATE_DEVICE_PARAMETERS_H
#define PALPATE_DEVICE_PARAMETERS_H

#include "device.h"

enum { DEVICE_PARAMETERS = 256, DEVICE_SOURCES = 3 };

/* SI units. */
typedef struct device_parameter {
    uint8_t id, index, count; /* index: which of the count values of its name */
    char name[PALP_WIRE_PARAMETER_NAME + 1];
    float value, standard, low, high; /* standard: compiled in */
} device_parameter;

typedef struct device_parameters {
    palp_wire_configuration now;
    size_t n;
    device_parameter one[DEVICE_PARAMETERS];
} device_parameters;

/* Reads the first at_most parameters; DEVICE_PARAMETERS reads all. */
device_result device_parameters_read(device *d, size_t at_most, device_parameters *p);

/* NULL: there is no parameter of that name and index. */
const device_parameter *device_parameter_find(const device_parameters *p, const char *name, size_t index);
/* The same parameter's value; NAN where there is none. */
double device_parameter_value(const device_parameters *p, const char *name, size_t index);

/* In state IDLE only. DEVICE_REFUSED: why has the range. */
device_result device_parameter_set(device *d, const device_parameter *one, double value);
void device_parameter_refuse(const device_parameter *one, double value,
                             char why[DEVICE_TEXT]); /* these words */
/* Saves the parameters in flash, in state IDLE only, and waits until that is done. DEVICE_REFUSED: the flash
 * does not hold afterwards what was written. */
device_result device_save(device *d);

/* "compiled in", "flash", "compiled in, flash damaged". */
const char *device_source_text(uint8_t source);

/* Days since 1970-01-01 as 2026-03-01; empty for 0 and NAN. */
void device_date(double day, char text[16]);

/* The shortest text that reads back as exactly this number. */
void device_parameter_text(float value, char text[24]);
double device_parameter_plain(float value); /* the number of that text */

#endif
