/* rig_feed.c: inputs of the virtual indenter besides the plant: faults at their time, a script of bytes. */
#define _POSIX_C_SOURCE 200809L
#include "shared/cli.h"
#include "rig_internal.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <palpate/wire.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int bad_line(const char *name, const rig_feed *f, const char *why) {
    return cli_failure(name, "%s:%zu: %s", f->settings->script, f->n_lines + 1, why);
}

static int hex_digit(char c) {
    const char *digits = "0123456789abcdef", *at = strchr(digits, tolower((unsigned char)c));
    return c && at ? (int)(at - digits) : -1;
}

/* Appends a line's bytes; false: not pairs of hexadecimal digits. */
static bool take_bytes(rig_feed *f, const char *text, rig_line *line) {
    size_t at = line->from;
    for (; hex_digit(text[0]) >= 0 && hex_digit(text[1]) >= 0; text += 2)
        f->byte[at++] = (uint8_t)(16 * hex_digit(text[0]) + hex_digit(text[1]));
    line->n = at - line->from;
    return line->n > 0 && text[strspn(text, " \r\n")] == '\0';
}

/* Lines "TICK HEXBYTES", their ticks not falling. */
static int take_line(const char *name, rig_feed *f, const char *text, size_t *used) {
    char *rest;
    rig_line line = {.from = *used};
    unsigned long tick = strtoul(text, &rest, 10);
    if (!isdigit((unsigned char)text[0]) || *rest != ' ' || tick > UINT32_MAX)
        return bad_line(name, f, "wants TICK HEXBYTES");
    line.tick = (uint32_t)tick;
    if (f->n_lines > 0 && line.tick < f->line[f->n_lines - 1].tick)
        return bad_line(name, f, "its tick is before the line's above");
    rig_line *lines = realloc(f->line, (f->n_lines + 1) * sizeof *lines);
    f->line = lines ? lines : f->line;
    uint8_t *bytes = lines ? realloc(f->byte, *used + strlen(rest)) : NULL;
    f->byte = bytes ? bytes : f->byte;
    if (!bytes)
        return cli_status(name, PALP_ERR_NO_MEMORY, NULL);
    if (!take_bytes(f, rest + 1, &line))
        return bad_line(name, f, "wants pairs of hexadecimal digits after the tick");
    *used += line.n;
    f->line[f->n_lines++] = line;
    return CLI_OK;
}

int rig_feed_open(const char *name, const rig_settings *settings, rig_feed *f) {
    *f = (rig_feed){.settings = settings};
    if (!settings->script)
        return CLI_OK;
    FILE *file = fopen(settings->script, "r");
    if (!file)
        return cli_failure(name, "%s: %s", settings->script, strerror(errno));
    char *text = NULL;
    size_t size = 0, used = 0;
    int code = CLI_OK;
    while (code == CLI_OK && getline(&text, &size, file) >= 0)
        code = take_line(name, f, text, &used);
    if (code == CLI_OK && ferror(file))
        code = cli_failure(name, "%s: %s", settings->script, strerror(errno));
    free(text);
    fclose(file);
    return code;
}

void rig_feed_free(rig_feed *f) {
    free(f->line);
    free(f->byte);
}

/* ---- faults, and a weight ---- */

enum { WEIGHT_TICKS = 20 };

/* How a fault is caused: in the plant, by an event (lasting or once), or by a command. */
typedef enum effect_kind { IN_PLANT, BY_EVENT, BY_EVENT_ONCE, BY_COMMAND } effect_kind;

static const struct {
    effect_kind kind;
    int what; /* plant_fault or PLANT_EVENT_* */
} effects[PALP_WIRE_FAULT_COUNT] = {
    [PALP_WIRE_FAULT_OVER_FORCE] = {IN_PLANT, PLANT_OBSTACLE},
    [PALP_WIRE_FAULT_OVER_TRAVEL] = {IN_PLANT, PLANT_PUSHED},
    [PALP_WIRE_FAULT_OVER_TEMPERATURE] = {IN_PLANT, PLANT_HOT},
    [PALP_WIRE_FAULT_FOLLOWING_ERROR] = {IN_PLANT, PLANT_JAMMED},
    [PALP_WIRE_FAULT_SENSOR_SILENT] = {IN_PLANT, PLANT_SILENT},
    [PALP_WIRE_FAULT_SENSOR_SATURATED] = {IN_PLANT, PLANT_SATURATED},
    [PALP_WIRE_FAULT_ENCODER_JUMP] = {IN_PLANT, PLANT_JUMP},
    [PALP_WIRE_FAULT_HOST_TIMEOUT] = {BY_EVENT, PLANT_EVENT_DEAF},
    [PALP_WIRE_FAULT_STREAM_OVERFLOW] = {BY_EVENT, PLANT_EVENT_STALL_TX},
    [PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE] = {BY_COMMAND, 0},
    [PALP_WIRE_FAULT_WATCHDOG_RESET] = {BY_EVENT_ONCE, PLANT_EVENT_HANG},
    [PALP_WIRE_FAULT_STACK_GUARD] = {BY_EVENT_ONCE, PLANT_EVENT_SMASH},
    [PALP_WIRE_FAULT_EMERGENCY_STOP] = {IN_PLANT, PLANT_EMERGENCY},
    [PALP_WIRE_FAULT_ENCODER_LOST] = {IN_PLANT, PLANT_ENCODER},
    [PALP_WIRE_FAULT_DRIVER_FAULT] = {IN_PLANT, PLANT_DRIVER},
    [PALP_WIRE_FAULT_BROWN_OUT] = {BY_EVENT_ONCE, PLANT_EVENT_BROWN_OUT},
    [PALP_WIRE_FAULT_CONTACT_LOST] = {IN_PLANT, PLANT_GONE},
    [PALP_WIRE_FAULT_FORCE_OSCILLATES] = {IN_PLANT, PLANT_SHAKEN},
};

static uint32_t tick_of(double time_s) {
    return (uint32_t)llround(1e3 * time_s);
}

static bool begins(const rig_injection *i, uint32_t tick) {
    return tick == tick_of(i->time_s);
}

static bool ends(const rig_injection *i, uint32_t tick) {
    return i->until_s > 0 && tick == tick_of(i->until_s);
}

static bool lasts(const rig_injection *i, uint32_t tick) {
    return tick >= tick_of(i->time_s) && (i->until_s <= 0 || tick < tick_of(i->until_s));
}

/* No weight where the file does not exist or holds no number. */
static double read_weight(const char *path) {
    double force_N = 0;
    FILE *file = fopen(path, "r");
    if (file && fscanf(file, "%lf", &force_N) != 1)
        force_N = 0;
    if (file)
        fclose(file);
    return isfinite(force_N) ? force_N : 0;
}

void rig_feed_plant(const rig_feed *f, uint32_t tick, plant *p) {
    if (f->settings->weight && tick % WEIGHT_TICKS == 0)
        plant_put(p, read_weight(f->settings->weight));
    for (size_t i = 0; i < f->settings->n_injections; i++) {
        const rig_injection *one = &f->settings->injection[i];
        if (effects[one->fault].kind == IN_PLANT && begins(one, tick))
            plant_inject(p, (plant_fault)effects[one->fault].what);
        else if (effects[one->fault].kind == IN_PLANT && ends(one, tick))
            plant_lift(p, (plant_fault)effects[one->fault].what);
    }
}

/* A command that narrows the travel to so much beyond the plate's place. The zero before it ends a frame of
 * the host's that it may interrupt. */
static void narrow_travel(rig_feed *f, const plant *p, double beyond_m) {
    palp_wire_message limits = {.type = PALP_WIRE_TYPE_LIMITS, .sequence = 0xf1f1};
    limits.as.limits.travel_nm = (int32_t)fmax(1e9 * (plant_look(p).carriage_m + beyond_m), 1);
    f->limits[0] = 0;
    f->limits_n = 1 + palp_wire_encode(&limits, f->limits + 1);
    f->limits_at = 0;
}

static void feed_events(rig_feed *f, const plant *p, plant_in *in) {
    for (size_t i = 0; i < f->settings->n_injections; i++) {
        const rig_injection *one = &f->settings->injection[i];
        effect_kind kind = effects[one->fault].kind;
        bool once = begins(one, in->tick) && !(f->done >> i & 1u);
        if ((kind == BY_EVENT && lasts(one, in->tick)) || (kind == BY_EVENT_ONCE && once))
            in->events |= (uint8_t)effects[one->fault].what;
        if (once && one->fault == PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE)
            narrow_travel(f, p, -1e-4); /* the reference is then outside the travel */
        else if (once && one->fault == PALP_WIRE_FAULT_OVER_TRAVEL)
            narrow_travel(f, p, 2e-3); /* seen before the plate has been off its reference for long */
        f->done |= once ? 1u << i : 0;
    }
}

static void put(plant_in *in, uint8_t byte) {
    in->rx[in->rx_count++] = byte;
}

void rig_feed_record(rig_feed *f, const plant *p, plant_in *in) {
    const uint32_t period = tick_of(f->settings->trigger_s);
    feed_events(f, p, in);
    if (period > 0 && in->tick > 0 && in->tick % period == 0)
        in->switches |= PLANT_TRIGGER;
    while (in->rx_count < PLANT_LINK_RX && f->limits_at < f->limits_n)
        put(in, f->limits[f->limits_at++]);
    while (in->rx_count < PLANT_LINK_RX && f->next < f->n_lines && f->line[f->next].tick <= in->tick) {
        const rig_line *line = &f->line[f->next];
        put(in, f->byte[line->from + f->at++]);
        if (f->at == line->n) {
            f->next++;
            f->at = 0;
        }
    }
}
