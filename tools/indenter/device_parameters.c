/* device_parameters.c: the parameters of an indenter over the wire. */
#define _POSIX_C_SOURCE 200809L
#include "device_parameters.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SAVE_TICKS = 5000 };

static float number_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static device_result read_configuration(device *d, palp_wire_configuration *now) {
    palp_wire_message got = {0};
    device_result result = device_do(d, PALP_WIRE_TYPE_GET_CONFIGURATION, &got);
    *now = got.as.configuration;
    return result;
}

static device_result read_one(device *d, uint8_t id, device_parameter *one) {
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_PARAMETER, .as.get_parameter = {.id = id}}, got = {0};
    device_result result = device_command(d, &ask, &got);
    const palp_wire_parameter *p = &got.as.parameter;
    *one = (device_parameter){.id = id,
                              .index = p->index,
                              .count = p->count,
                              .value = number_of(p->value),
                              .standard = number_of(p->standard),
                              .low = number_of(p->low),
                              .high = number_of(p->high)};
    memcpy(one->name, p->name, sizeof p->name);
    return result;
}

device_result device_parameters_read(device *d, size_t at_most, device_parameters *p) {
    device_result result = read_configuration(d, &p->now);
    p->n = 0;
    while (result == DEVICE_OK && p->n < at_most && p->n < p->now.parameters) {
        result = read_one(d, (uint8_t)p->n, &p->one[p->n]);
        p->n++;
    }
    return result;
}

const device_parameter *device_parameter_find(const device_parameters *p, const char *name, size_t index) {
    for (size_t i = 0; i < p->n; i++)
        if (p->one[i].index == index && strcmp(p->one[i].name, name) == 0)
            return &p->one[i];
    return NULL;
}

double device_parameter_plain(float value) {
    char text[24];
    device_parameter_text(value, text);
    return strtod(text, NULL);
}

double device_parameter_value(const device_parameters *p, const char *name, size_t index) {
    const device_parameter *one = device_parameter_find(p, name, index);
    return one ? device_parameter_plain(one->value) : NAN;
}

void device_parameter_refuse(const device_parameter *one, double value, char why[DEVICE_TEXT]) {
    char low[24], high[24];
    device_parameter_text(one->low, low);
    device_parameter_text(one->high, high);
    snprintf(why, DEVICE_TEXT, "%s cannot be %.9g: it goes from %s to %s%s", one->name, value, low, high,
             strcmp(one->name, "Fz_N") == 0 ? ", and is not 0 in all channels" : "");
}

device_result device_parameter_set(device *d, const device_parameter *one, double value) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SET_PARAMETER};
    m.as.set_parameter = (palp_wire_set_parameter){.id = one->id, .value = bits_of((float)value)};
    device_result result = device_command(d, &m, NULL);
    if (result == DEVICE_REFUSED && d->refusal == PALP_WIRE_RESULT_RANGE)
        device_parameter_refuse(one, value, d->why);
    return result;
}

static device_result wait_for_save(device *d, palp_wire_configuration *now) {
    device_result result = read_configuration(d, now);
    const uint32_t from = d->device_tick;
    while (result == DEVICE_OK && now->saving == 1 && d->device_tick - from < SAVE_TICKS) {
        result = device_status(d);
        result = result ? result : read_configuration(d, now);
    }
    return result;
}

device_result device_save(device *d) {
    palp_wire_configuration now;
    device_result result = device_do(d, PALP_WIRE_TYPE_SAVE, NULL);
    result = result ? result : wait_for_save(d, &now);
    if (result == DEVICE_OK && (now.saving != 0 || now.id != now.stored_id)) {
        snprintf(d->why, sizeof d->why,
                 "the device could not write its flash: what was there before still is");
        d->refusal = PALP_WIRE_RESULT_DONE;
        result = DEVICE_REFUSED;
    }
    return result;
}

const char *device_source_text(uint8_t source) {
    static const char *const texts[DEVICE_SOURCES] = {"compiled in", "flash", "compiled in, flash damaged"};
    return source < DEVICE_SOURCES ? texts[source] : "unknown";
}

void device_date(double day, char text[16]) {
    const time_t clock = day > 0 ? (time_t)(day * 86400) : 0;
    struct tm utc;
    text[0] = '\0';
    if (clock > 0 && gmtime_r(&clock, &utc))
        (void)strftime(text, 16, "%Y-%m-%d", &utc);
}

void device_parameter_text(float value, char text[24]) {
    if (value == rintf(value) && fabsf(value) < 1e7f) {
        snprintf(text, 24, "%.0f", (double)value);
        return;
    }
    for (int digits = 1; digits <= 9; digits++) {
        snprintf(text, 24, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value)
            return;
    }
}
