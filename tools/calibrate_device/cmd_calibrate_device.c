/* cmd_calibrate_device.c: palpate calibrate-device: shows, sets and measures an indenter's parameters. */
#include "calibrate_device.h"
#include "shared/commands.h"

#include <stdlib.h>
#include <string.h>

static const char NAME[] = MACHINE_NAME;

enum { OWN_OPTIONS = 16 };

static const struct {
    const char *name;
    int (*run)(const machine_options *o, session *s);
} actions[] = {
    {"show", machine_show},    {"set", machine_set},  {"load", machine_load}, {"standard", machine_standard},
    {"weights", step_weights}, {"block", step_block}, {"air", step_air},      {"gains", step_gains}};
static const char LIST[] = "show, set, load, standard, weights, block, air or gains";

enum { ACTIONS = sizeof actions / sizeof actions[0] };

static int parse(int argc, char **argv, machine_options *o, const char **action) {
    cli_option options[OWN_OPTIONS + ACQUIRE_SETUP_OPTIONS + RIG_OPTIONS];
    const char *words[MACHINE_WORDS + 1];
    size_t n = acquire_setup_device(&o->setup, options), n_words = 0;
    const cli_option own[] = {
        cli_heading("Steps"),
        cli_numbers("weights-g", "G,G,...", 1e5, &o->weights_g,
                    "masses to put on the sensor one after the other, g"),
        cli_flag("hanging", &o->hanging,
                 "the masses hang from the plate (default: they lie on the sensor, turned up)"),
        cli_flag("large-change", &o->large_change, "accept a sensitivity more than 20 % from the one in use"),
        cli_count("channel", "1..6", 1, 6, &o->channel,
                  "input of a single load cell (default: a six-channel sensor with its matrix)"),
        cli_positive("gravity-m-s2", "G", 20, &o->gravity_m_s2, "local gravity, m/s2 (default 9.80665)"),
        cli_positive("average-s", "S", 60, &o->average_s, "average each reading over S seconds (default 1)"),
        cli_positive("force-N", "F", 1000, &o->force_N,
                     "force on the block, N (default: 40 % of the sensor's range)"),
        cli_text("out-folder", "DIR", &o->setup.session.out,
                 "folder for the recordings of block and gains (default .)"),
        cli_heading("Output"),
        cli_flag("yes", &o->yes, "save results in the device without asking"),
        cli_out("out", "FILE.json", &o->out, "the resulting parameters, as a file for the action load"),
        cli_flag("force", &o->setup.session.force, "overwrite an existing file"),
        cli_flag("json", &o->json, "the result as JSON on standard output"),
    };
    memcpy(options + n, own, sizeof own);
    n += sizeof own / sizeof own[0];
    rig_options_list(&o->setup.rig, options + n);
    const cli_command command = {
        NAME,
        "ACTION --port PORT [options]\n"
        "       ACTION: weights | block | air | gains | show | set NAME=VALUE ... | load FILE.json | "
        "standard",
        "Calibrates an indenter in steps, best in this order: weights (known masses on the sensor), block "
        "(a\n"
        "press on a rigid block: compliance of the frame, force of the motor), air (motion in air: "
        "friction,\n"
        "noise), gains (a sweep above a soft specimen: gains of position control). Other actions show the\n"
        "device's parameters, set them by name, load them from a file, or restore the compiled-in values.\n"
        "Changes are saved in the device's flash after a question. Recordings name their calibration.",
        "  palpate calibrate-device weights --weights-g 50,100,200,500 --port /dev/ttyACM0\n"
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

static int with_device(machine_options *o, int (*run)(const machine_options *o, session *s)) {
    int code = cli_folder(NAME, o->setup.session.out);
    code = code ? code : acquire_setup_prepare(NAME, &o->setup);
    code = code ? code : acquire_setup_open(NAME, &o->setup);
    if (code)
        return code;
    o->plan = calloc(1, sizeof *o->plan);
    session *s = o->plan ? session_open(&o->setup.session, o->plan) : NULL;
    if (s) {
        code = run(o, s);
        session_close(s);
    } else {
        code = CLI_FAILURE;
    }
    free(o->plan);
    int closed = acquire_setup_close(&o->setup);
    return code ? code : closed;
}

int cmd_calibrate_device(int argc, char **argv) {
    machine_options o = {.setup = acquire_setup_default(), .average_s = 1};
    const char *action = NULL;
    int code = parse(argc, argv, &o, &action);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    o.setup.session.command = NAME;
    o.setup.session.out = o.setup.session.out ? o.setup.session.out : ".";
    if (!action)
        return cli_usage_error(NAME, "name an action: %s", LIST);
    code = acquire_setup_check(NAME, &o.setup);
    for (size_t i = 0; i < ACTIONS && code == CLI_OK; i++)
        if (strcmp(action, actions[i].name) == 0)
            return with_device(&o, actions[i].run);
    return code ? code : cli_usage_error(NAME, "no such action: %s; one of %s", action, LIST);
}
