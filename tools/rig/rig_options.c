/* rig_options.c: the options that describe the virtual indenter, for palpate rig and acquire --port rig. */
#include "rig_options.h"

#include <math.h>
#include <palpate/wire.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

rig_options rig_options_default(void) {
    return (rig_options){.machine = -1,
                         .specimen = -1,
                         .firmware = -1,
                         .scale = NAN,
                         .contact_mm = NAN,
                         .compliance_mm_N = NAN,
                         .backlash_mm = NAN,
                         .noise_N = NAN,
                         .hum_N = NAN,
                         .bias_N = NAN,
                         .drift_N_s = NAN,
                         .gain = NAN,
                         .range_N = NAN,
                         .trigger_s = NAN,
                         .seed = SIZE_MAX};
}

void rig_options_list(rig_options *o, cli_option list[RIG_OPTIONS]) {
    const cli_option options[RIG_OPTIONS] = {
        cli_heading("Virtual indenter"),
        cli_choice("firmware", "auto|qemu|host", &o->firmware,
                   "the image under QEMU, or the same code as a process (default auto:\n"
                   "QEMU where it is installed)"),
        cli_choice("machine", "voice-coil|stepper|stepper-fast", &o->machine,
                   "machine of doc/indenter.md: voice coil (default), or stepper with the\nslow or the fast "
                   "load-cell amplifier"),
        cli_flag("paced", &o->paced, "run in real time (default: as fast as possible)"),
        cli_choice("specimen", "model|rigid|none", &o->specimen,
                   "the model (default), a rigid block (to measure the frame), or air"),
        cli_positive("scale", "X", 1e6, &o->scale, "multiply the model's force by X (default 1)"),
        cli_number("contact-mm", "MM", 0, 1e3, &o->contact_mm,
                   "top of the specimen, mm below home (default 12)"),
        cli_in("actuator", "FILE.json", &o->actuator,
               "properties of motor, carriage and frame (see data/rig/)"),
        cli_number("compliance-mm-N", "C", 0, 10, &o->compliance_mm_N, "compliance of the frame, mm/N"),
        cli_number("backlash-mm", "MM", 0, 10, &o->backlash_mm, "play between encoder and plate, mm"),
        cli_number("noise-N", "SD", 0, 100, &o->noise_N,
                   "standard deviation of the force's white noise, N (default 0.002)"),
        cli_number("hum-N", "A", 0, 100, &o->hum_N, "amplitude of mains hum on the force, N, at 50 Hz"),
        cli_number("bias-N", "F", -100, 100, &o->bias_N, "offset of the force sensor, N"),
        cli_number("drift-N-s", "R", -10, 10, &o->drift_N_s, "drift of this offset, N/s"),
        cli_positive("gain", "G", 10, &o->gain, "gain error: factor on the sensor's reading (default 1)"),
        cli_positive("range-N", "F", 1e3, &o->range_N,
                     "the sensor's amplifier saturates at F and -F newtons"),
        cli_count("seed", "N", 0, 9e15, &o->seed, "seed of the noise (default 1)"),
        cli_text("inject", "FAULT@S[-S]", &o->inject,
                 "a fault at S seconds of the device's time, until a second time if given;\n"
                 "several: over_force@3.5,sensor_silent@7-8"),
        cli_positive("trigger-every-s", "S", 1e6, &o->trigger_s,
                     "pulse at the trigger input every S seconds, as from a camera"),
        cli_text("weight", "FILE", &o->weight,
                 "weight on the sensor, N, read from FILE, which may change while it runs"),
        cli_text("store", "FILE", &o->store, "file for saved parameters (default: lost at the end)"),
        cli_out("log", "FILE.csv", &o->log, "true values of motor, plate and specimen at each tick"),
    };
    memcpy(list, options, sizeof options);
}

/* Whether an option was given: its target no longer holds the default. */
static bool given(const cli_option *o) {
    switch (o->type) {
    case CLI_FLAG:
        return *o->to.flag;
    case CLI_TEXT:
    case CLI_IN:
    case CLI_OUT:
    case CLI_OUT_FOLDER:
        return *o->to.text != NULL;
    case CLI_CHOICE:
        return *o->to.choice >= 0;
    case CLI_COUNT:
        return *o->to.count != SIZE_MAX;
    case CLI_NUMBER:
    case CLI_POSITIVE:
        return !isnan(*o->to.number);
    case CLI_HEADING:
    case CLI_NUMBERS:
    case CLI_COUNTS:
        break;
    }
    return false;
}

const char *rig_options_given(const rig_options *o) {
    rig_options copy = *o;
    cli_option list[RIG_OPTIONS];
    rig_options_list(&copy, list);
    for (size_t i = 0; i < RIG_OPTIONS; i++)
        if (given(&list[i]))
            return list[i].name;
    return NULL;
}

static int fault_number(const char *name, size_t length) {
    for (int i = 1; i < PALP_WIRE_FAULT_COUNT; i++) {
        const char *known = palp_wire_fault_name((uint8_t)i);
        if (strlen(known) == length && memcmp(known, name, length) == 0)
            return i;
    }
    return 0;
}

/* Reads FAULT@S or FAULT@S-S; returns the text after it, or NULL. */
static const char *read_injection(const char *text, rig_injection *one) {
    char *end;
    size_t length = strcspn(text, "@,");
    *one = (rig_injection){.fault = fault_number(text, length)};
    if (!one->fault || text[length] != '@')
        return NULL;
    one->time_s = strtod(text + length + 1, &end);
    bool good = end > text + length + 1 && one->time_s >= 0 && one->time_s < 1e6;
    if (good && *end == '-') {
        const char *from = end + 1;
        one->until_s = strtod(from, &end);
        good = end > from && one->until_s > one->time_s && one->until_s < 1e6;
    }
    return good && (*end == ',' || *end == '\0') ? end : NULL;
}

static int bad_injection(const char *name, const char *text) {
    char known[512] = "";
    size_t at = 0;
    int length = (int)strcspn(text, "@,");
    if (fault_number(text, (size_t)length))
        return cli_usage_error(name, "--inject wants FAULT@SECONDS or FAULT@FROM-TO, not \"%.*s\"",
                               (int)strcspn(text, ","), text);
    for (int i = 1; i < PALP_WIRE_FAULT_COUNT; i++)
        at += (size_t)snprintf(known + at, sizeof known - at, "%s%s", i > 1 ? ", " : "",
                               palp_wire_fault_name((uint8_t)i));
    return cli_usage_error(name, "--inject: no such fault: \"%.*s\"; there are %s", length, text, known);
}

static int read_injections(const char *name, const char *text, rig_settings *s) {
    while (text && *text) {
        if (s->n_injections == RIG_INJECTIONS)
            return cli_usage_error(name, "--inject takes at most %d faults", RIG_INJECTIONS);
        const char *end = read_injection(text, &s->injection[s->n_injections++]);
        if (!end)
            return bad_injection(name, text);
        text = *end ? end + 1 : end;
    }
    return CLI_OK;
}

static void set(double *to, double value, double unit) {
    if (!isnan(value))
        *to = value / unit;
}

/* The stepper's machine counts its own steps. */
static const double STEPPER_COUNT_M = 0.625e-6;

static int set_plant(const char *name, const rig_options *o, const char *model, plant_settings *p) {
    palp_error error = {PALP_OK, ""};
    p->machine = (uint8_t)(o->machine < 0 ? PLANT_VOICE_COIL : o->machine);
    p->actuator.count_m = p->machine != PLANT_VOICE_COIL ? STEPPER_COUNT_M : p->actuator.count_m;
    palp_status status = o->actuator ? plant_actuator_read(o->actuator, &p->actuator, &error) : PALP_OK;
    if (status)
        return cli_status(name, status, &error);
    p->model = model;
    p->specimen = o->specimen < 0 ? PLANT_MODEL : (plant_specimen)o->specimen;
    p->sensor.seed = o->seed == SIZE_MAX ? p->sensor.seed : o->seed;
    set(&p->scale, o->scale, 1);
    set(&p->contact_m, o->contact_mm, 1e3);
    set(&p->actuator.compliance_m_N, o->compliance_mm_N, 1e3);
    set(&p->actuator.backlash_m, o->backlash_mm, 1e3);
    set(&p->sensor.noise_N, o->noise_N, 1);
    set(&p->sensor.hum_N, o->hum_N, 1);
    set(&p->sensor.bias_N, o->bias_N, 1);
    set(&p->sensor.drift_N_s, o->drift_N_s, 1);
    set(&p->sensor.gain, o->gain, 1);
    set(&p->sensor.range_N, o->range_N, 1);
    return CLI_OK;
}

int rig_options_settings(const char *name, const rig_options *o, const char *model, rig_settings *settings) {
    *settings = rig_settings_default();
    if (model && o->specimen > 0)
        return cli_usage_error(name, "--specimen %s does not go with a model",
                               o->specimen == 1 ? "rigid" : "none");
    settings->firmware = o->firmware < 0 ? RIG_AUTO : (rig_firmware)o->firmware;
    settings->paced = o->paced;
    settings->log = o->log;
    settings->trigger_s = isnan(o->trigger_s) ? 0 : o->trigger_s;
    settings->store = o->store;
    settings->weight = o->weight;
    int code = read_injections(name, o->inject, settings);
    return code ? code : set_plant(name, o, model, &settings->plant);
}
