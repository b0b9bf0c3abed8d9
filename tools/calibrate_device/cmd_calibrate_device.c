/* cmd_calibrate_device.c: palpate calibrate-device: what an indenter is set to, and how it is found. */
#include "calibrate_device.h"
#include "shared/commands.h"

#include <string.h>

static const char NAME[] = MACHINE_NAME;

enum { OWN_OPTIONS = 8 };

static const struct {
    const char *name;
    int (*run)(const machine_options *o, device *d);
} actions[] = {{"show", machine_show}, {"set", machine_set}, {"load", machine_load}, {"standard", machine_standard}};

enum { ACTIONS = sizeof actions / sizeof actions[0] };

static int parse(int argc, char **argv, machine_options *o, const char **action) {
    cli_option options[OWN_OPTIONS + ACQUIRE_SETUP_OPTIONS + RIG_OPTIONS];
    const char *words[MACHINE_WORDS + 1];
    size_t n = acquire_setup_device(&o->setup, options), n_words = 0;
    const cli_option own[] = {
        cli_heading("Output"),
        cli_flag("yes", &o->yes, "keep results in the device without asking"),
        cli_out("out", "FILE.json", &o->out, "what it is then set to, as a file that load takes"),
        cli_flag("force", &o->setup.session.force, "overwrite a file that is there"),
        cli_flag("json", &o->json, "as JSON"),
    };
    memcpy(options + n, own, sizeof own);
    n += sizeof own / sizeof own[0];
    rig_options_list(&o->setup.rig, options + n);
    const cli_command command = {
        NAME,
        "ACTION --port PORT [options]\n"
        "       ACTION: show | set NAME=VALUE ... | load FILE.json | standard",
        "Shows what an indenter is set to: travel, encoder, motor, the sensor's matrix, gains; sets it by\n"
        "name, from a file, or back to what is compiled in; and keeps it in the device's flash. Asks before\n"
        "it keeps anything. Every recording says the calibration that it was made with.",
        "  palpate calibrate-device show --port /dev/ttyACM0 --out machine.json\n"
        "  palpate calibrate-device set travel_m=0.028 --port /dev/ttyACM0\n"
        "  palpate calibrate-device load machine.json --port rig --store flash.bin --yes\n",
        options,
        n + RIG_OPTIONS};
    int code = cli_parse(&command, argc, argv, words, MACHINE_WORDS + 1, &n_words);
    *action = n_words > 0 ? words[0] : NULL;
    o->n_words = n_words > 0 ? n_words - 1 : 0;
    memcpy(o->word, words + 1, o->n_words * sizeof *words);
    return code;
}

/* ---- the command ---- */

static int with_device(machine_options *o, int (*run)(const machine_options *o, device *d)) {
    device d;
    int code = acquire_setup_prepare(NAME, &o->setup);
    code = code ? code : acquire_setup_open(NAME, &o->setup);
    if (code)
        return code;
    if (device_open(o->setup.session.where, o->setup.session.baud, &d) == DEVICE_OK) {
        code = run(o, &d);
        device_close(&d);
    } else {
        code = cli_failure(NAME, "%s", d.why);
    }
    int closed = acquire_setup_close(&o->setup);
    return code ? code : closed;
}

int cmd_calibrate_device(int argc, char **argv) {
    machine_options o = {.setup = acquire_setup_default()};
    const char *action = NULL;
    int code = parse(argc, argv, &o, &action);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    o.setup.session.out = ".";
    if (!action)
        return cli_usage_error(NAME, "say what to do: show, set, load or standard");
    code = acquire_setup_check(NAME, &o.setup);
    for (size_t i = 0; i < ACTIONS && code == CLI_OK; i++)
        if (strcmp(action, actions[i].name) == 0)
            return with_device(&o, actions[i].run);
    return code ? code : cli_usage_error(NAME, "no such action: %s; one of show, set, load, standard", action);
}
