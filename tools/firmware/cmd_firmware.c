/* cmd_firmware.c: palpate firmware: identity, status and gains of an indenter; home, tare, self-test, clear a
 * fault, flash. */
#include "firmware_flash.h"
#include "firmware_test.h"
#include "shared/cli.h"
#include "shared/commands.h"
#include "indenter/device.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const char NAME[] = "firmware";

enum { HOMING_S = 120 };

typedef struct firmware_options {
    const char *action, *port, *image;
    int board; /* -1: not given */
    size_t baud, samples;
    bool json;
} firmware_options;

static int parse(int argc, char **argv, firmware_options *o) {
    const cli_option options[] = {
        cli_heading("Device"),
        cli_text(
            "port", "PORT", &o->port,
            "/dev/ttyACM0, pty:PATH, tcp:HOST:PORT or unix:PATH; palpate acquire\n--list shows the ports"),
        cli_count("baud", "N", 1200, 4e6, &o->baud, "of a serial port (default 921600)"),
        cli_count("samples", "N", 1, 4096, &o->samples, "ticks that tare averages (default 1000)"),
        cli_choice("board", "stm32f405|stepper_hx711|stepper_ads1220", &o->board,
                   "kind of board that flash writes to (default: what its firmware says)"),
        cli_in("image", "FILE.bin", &o->image,
               "what flash writes (default: the board's, which came with palpate)"),
        cli_heading("Output"),
        cli_flag("json", &o->json, "as JSON"),
    };
    const cli_command command = {
        NAME,
        "info|status|gains|home|tare|self-test|clear-fault|flash --port PORT [--json]",
        "Acts on an indenter on the bench. info, status and gains print its identity, its state and its\n"
        "table of gains. home finds the home switch. tare zeroes the force in the air. clear-fault leaves a\n"
        "latched fault once its cause is gone. self-test checks sensor, encoder, motor and line; it moves\n"
        "the plate 3 mm and needs free space below. flash writes the board's image through the chip's boot\n"
        "loader, by stm32flash, or by dfu-util with --port dfu.",
        "  palpate firmware info --port /dev/ttyACM0\n"
        "  palpate firmware clear-fault --port /dev/ttyACM0\n"
        "  palpate firmware flash --port /dev/ttyUSB0\n",
        options,
        sizeof options / sizeof options[0]};
    size_t n = 0;
    int code = cli_parse(&command, argc, argv, &o->action, 1, &n);
    if (code == CLI_OK && n == 0)
        return cli_usage_error(
            NAME, "say what to do: info, status, gains, home, tare, self-test, clear-fault or flash");
    return code == CLI_OK && !o->port ? cli_usage_error(NAME, "name the device with --port") : code;
}

/* ---- printing: an object as JSON, or a line for each of its members ---- */

static void print_value(const json_t *value, int width) {
    size_t i;
    json_t *part;
    if (json_is_array(value)) {
        json_array_foreach(value, i, part) {
            printf("%s%*.9g", i ? " " : "", width, json_number_value(part));
        }
    } else if (json_is_string(value)) {
        printf("%*s", width, json_string_value(value));
    } else if (json_is_integer(value)) {
        printf("%*" JSON_INTEGER_FORMAT, width, json_integer_value(value));
    } else if (json_is_real(value)) {
        printf("%*.9g", width, json_real_value(value));
    } else {
        printf("%*s", width, json_is_true(value) ? "yes" : json_is_false(value) ? "no" : "unknown");
    }
}

static int print_object(const firmware_options *o, json_t *object) {
    const char *key;
    json_t *value;
    if (o->json || !object)
        return json_print(NAME, object);
    json_object_foreach(object, key, value) {
        printf("%-18s ", key);
        print_value(value, 0);
        putchar('\n');
    }
    json_decref(object);
    return CLI_OK;
}

/* A table of objects with the same members. */
static int print_table(const firmware_options *o, json_t *rows) {
    size_t i;
    const char *key;
    json_t *row, *value;
    if (o->json || !rows)
        return json_print(NAME, rows);
    json_array_foreach(rows, i, row) {
        if (i == 0) {
            json_object_foreach(row, key, value) printf("%16s", key);
            putchar('\n');
        }
        json_object_foreach(row, key, value) print_value(value, 16);
        putchar('\n');
    }
    json_decref(rows);
    return CLI_OK;
}

/* Exit code 4 and the fault's name where a fault is latched. */
static int device_failure(device *d, device_result result) {
    bool faulted = result == DEVICE_REFUSED &&
                   (d->refusal == PALP_WIRE_RESULT_FAULTED || d->refusal == PALP_WIRE_RESULT_PERSISTS);
    cli_failure(NAME, "%s", d->why);
    return faulted ? CLI_DEVICE_FAULT : CLI_FAILURE;
}

static int say_fault(const palp_wire_status *s) {
    cli_failure(NAME, "the device stopped: %s (%s); see to it, then palpate firmware clear-fault",
                palp_wire_fault_name(s->fault), palp_wire_fault_text(s->fault));
    return CLI_DEVICE_FAULT;
}

static int run_info(const firmware_options *o, device *d) {
    const palp_wire_info *i = &d->info;
    char version[16], board[PALP_WIRE_NAME + 1] = "";
    snprintf(version, sizeof version, "%u.%u.%u", i->major, i->minor, i->patch);
    memcpy(board, i->board, PALP_WIRE_NAME);
    return print_object(o, json_pack("{ss ss si sb sI si sf sf sf}", "board", board, "firmware", version,
                                     "protocol", (int)i->protocol, "simulated", i->simulated != 0, "serial",
                                     (json_int_t)i->serial, "tick_Hz", (int)i->tick_Hz, "count_um",
                                     1e-6 * i->count_pm, "travel_mm", 1e-6 * i->travel_nm, "force_N",
                                     1e-6 * i->force_uN));
}

static json_t *known(bool is_known, double value) {
    return json_number_or_null(is_known ? value : NAN);
}

static json_t *status_object(const device *d, const palp_wire_status *s) {
    double count_mm = 1e-9 * d->info.count_pm;
    json_t *it =
        json_pack("{ss ss sI sI sb sf}", "state", palp_wire_state_name(s->state), "fault",
                  palp_wire_fault_name(s->fault), "fault_tick", (json_int_t)s->fault_tick, "tick",
                  (json_int_t)s->tick, "homed", s->homed != 0, "position_mm", count_mm * s->position);
    json_t *more =
        json_pack("{so so si sf sf sf sf sI sI sI si}", "contact_mm",
                  known(s->contact_known != 0, count_mm * s->contact), "stiffness_N_m",
                  known(s->contact_known != 0, 1e-3 * s->stiffness_mN_m), "softness_class", (int)s->softness,
                  "force_N", 1e-6 * s->force_uN, "case_C", 1e-2 * s->case_cC, "winding_C",
                  1e-2 * s->winding_cC, "derating", 1e-3 * s->derating_permille, "missed_ticks",
                  (json_int_t)s->missed_ticks, "bad_frames", (json_int_t)s->bad_frames, "tick_cost",
                  (json_int_t)s->tick_cost, "stack_free_bytes", (int)s->stack_free);
    json_object_update(it, more);
    json_decref(more);
    return it;
}

static int run_status(const firmware_options *o, device *d) {
    device_result result = device_do(d, PALP_WIRE_TYPE_GET_STATUS, &(palp_wire_message){0});
    return result ? device_failure(d, result) : print_object(o, status_object(d, &d->status));
}

static int run_gains(const firmware_options *o, device *d) {
    json_t *rows = json_array();
    for (uint8_t i = 0; i < PALP_WIRE_GAINS_AUTO; i++) {
        palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_GAINS, .as.get_gains = {.softness = i}}, got;
        const palp_wire_gains *g = &got.as.gains;
        device_result result = device_command(d, &ask, &got);
        if (i > 0 && result == DEVICE_REFUSED && d->refusal == PALP_WIRE_RESULT_RANGE)
            break; /* that was the last class */
        if (result) {
            json_decref(rows);
            return device_failure(d, result);
        }
        json_array_append_new(rows,
                              json_pack("{si sf sI sI sf sf sf}", "softness_class", (int)i, "up_to_N_m",
                                        1e-3 * g->stiffness_mN_m, "kp_N_m", (json_int_t)g->kp_N_m, "ki_N_m_s",
                                        (json_int_t)g->ki_N_m_s, "kd_N_s_m", 1e-3 * g->kd_mN_s_m, "filter_Hz",
                                        1e-3 * g->filter_mHz, "feed_N_m", 1e-3 * g->feed_mN_m));
    }
    return print_table(o, rows);
}

static int run_home(const firmware_options *o, device *d) {
    double until_s = link_now_s() + HOMING_S;
    device_result result = device_do(d, PALP_WIRE_TYPE_HOME, NULL);
    do {
        result = result ? result : device_status(d);
        if (result)
            return device_failure(d, result);
    } while (d->status.state == PALP_WIRE_STATE_HOMING && link_now_s() < until_s);
    if (d->status.state == PALP_WIRE_STATE_FAULT)
        return say_fault(&d->status);
    if (!d->status.homed)
        return cli_failure(NAME, "the home position was not found (state %s)",
                           palp_wire_state_name(d->status.state));
    return print_object(o, status_object(d, &d->status));
}

static int run_tare(const firmware_options *o, device *d) {
    palp_wire_message tare = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = (uint16_t)o->samples}}, got;
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_CALIBRATION,
                             .as.get_calibration = {.axis = DEVICE_AXIS_Z}};
    const palp_wire_calibration *c = &got.as.calibration;
    double counts[PALP_WIRE_CHANNELS];
    device_result result = device_command(d, &tare, NULL);
    result = result ? result : device_status(d);
    for (uint32_t tick = d->status.tick; !result && d->status.tick - tick <= o->samples;)
        result = device_status(d);
    result = result ? result : device_command(d, &ask, &got);
    if (result)
        return device_failure(d, result);
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        counts[i] = c->tare[i] / 16.0;
    return print_object(o, json_pack("{sI so sf}", "samples", (json_int_t)o->samples, "tare_counts",
                                     json_numbers(PALP_WIRE_CHANNELS, counts), "force_N",
                                     1e-6 * d->status.force_uN));
}

static int run_self_test(const firmware_options *o, device *d) {
    const int code = firmware_self_test(NAME, d, o->json);
    return code == CLI_DEVICE_FAULT ? say_fault(&d->status) : code;
}

static int run_clear(const firmware_options *o, device *d) {
    device_result result = device_do(d, PALP_WIRE_TYPE_CLEAR_FAULT, NULL);
    if (result == DEVICE_REFUSED && d->refusal == PALP_WIRE_RESULT_STATE) { /* there is none to clear */
        result = DEVICE_OK;
    }
    if (result == DEVICE_REFUSED && d->refusal == PALP_WIRE_RESULT_PERSISTS &&
        device_status(d) == DEVICE_OK) {
        cli_failure(NAME, "the cause of %s is still there: %s", palp_wire_fault_name(d->status.fault),
                    palp_wire_fault_text(d->status.fault));
        return CLI_DEVICE_FAULT;
    }
    return result ? device_failure(d, result) : run_status(o, d);
}

int cmd_firmware(int argc, char **argv) {
    static const struct {
        const char *name;
        int (*run)(const firmware_options *o, device *d);
    } actions[] = {{"info", run_info},          {"status", run_status}, {"gains", run_gains},
                   {"home", run_home},          {"tare", run_tare},     {"clear-fault", run_clear},
                   {"self-test", run_self_test}};
    static const char *const boards[] = {"stm32f405", "stepper_hx711", "stepper_ads1220"};
    firmware_options o = {.board = -1, .baud = LINK_BAUD, .samples = 1000};
    device d;
    int code = parse(argc, argv, &o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    if (strcmp(o.action, "flash") == 0)
        return firmware_flash(NAME, o.port, o.board < 0 ? NULL : boards[o.board], o.image);
    for (size_t i = 0; i < sizeof actions / sizeof actions[0]; i++) {
        if (strcmp(o.action, actions[i].name) == 0) {
            if (device_open(o.port, (int)o.baud, &d) != DEVICE_OK)
                return cli_failure(NAME, "%s", d.why);
            code = actions[i].run(&o, &d);
            device_close(&d);
            return code;
        }
    }
    return cli_usage_error(
        NAME, "no such action: %s; one of info, status, gains, home, tare, self-test, clear-fault, flash",
        o.action);
}
