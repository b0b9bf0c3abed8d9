/* cmd_acquire.c: palpate acquire: runs a protocol on an indenter and writes the recordings. */
#define _POSIX_C_SOURCE 200809L
#include "acquire_setup.h"
#include "shared/commands.h"
#include "shared/json_out.h"
#include "shared/opening.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char NAME[] = "acquire";

/* Options of the command line that are not in the session. */
typedef struct choice {
    acquire_setup setup;
    acquire_motion motion;
    bool is_static, sweep, thesis_protocol, list, monitor, json, repeat_first, dry_run, smooth;
    cli_list ramp_hold;
    size_t cycles, order_seed;
    int order, trigger_in;
    const char *protocol;
    acquire_until until;
} choice;

enum { OWN_OPTIONS = 64 + ACQUIRE_SETUP_OPTIONS };

static size_t plate_options(choice *c, cli_option *list) {
    acquire_motion *m = &c->motion;
    const cli_option all[] = {
        cli_heading("Motion of the plate"),
        cli_flag("static", &c->is_static, "press to --depth-mm at --rate-mm-s (default 0.1)"),
        cli_numbers("ramp-hold", "MM,MM,...", 1000, &c->ramp_hold, "ramp to each depth, dwell, withdraw"),
        cli_count("cycles", "N", 1, 65535, &c->cycles,
                  "N cycles from contact to --depth-mm and back, at --rate-mm-s (default 1)"),
        cli_flag("sweep", &c->sweep,
                 "a sine of rising frequency about --depth-mm, after --hold-s (default 10)"),
        cli_in("protocol", "FILE.json", &c->protocol, "runs from a protocol file"),
        cli_flag("thesis-protocol", &c->thesis_protocol,
                 "protocol of Sedef 2008: ramps of 1.5 to 7 mm and a static press to 9.7 mm\n"
                 "in random order, the first repeated at the end, runs in air around them"),
        cli_positive("depth-mm", "MM", 1000, &m->depth_mm, "depth below contact, mm"),
        cli_positive("rate-mm-s", "R", 1000, &m->rate_mm_s,
                     "speed of the plate, mm/s (--ramp-hold: instead of --ramp-s)"),
        cli_positive("ramp-s", "S", 1e6, &m->ramp_s,
                     "duration of the ramp from contact to depth, s (default 1)"),
        cli_number("hold-s", "S", 0, 1e6, &m->hold_s, "duration of the dwell, s (default 200)"),
        cli_positive("amplitude-mm", "MM", 1000, &m->amplitude_mm,
                     "amplitude of the sweep, mm (default: a tenth of the depth)"),
        cli_positive("from-Hz", "F", 1000, &m->frequency_Hz,
                     "first frequency of the sweep, Hz (default 0.1)"),
        cli_positive("to-Hz", "F", 1000, &m->frequency_end_Hz,
                     "last frequency of the sweep, Hz (default 10)"),
        cli_positive("sweep-s", "S", 1e6, &m->duration_s, "duration of the sweep, s (default 60)"),
        cli_positive("acceleration-mm-s2", "A", 1e6, &m->acceleration_mm_s2,
                     "acceleration of the plate at corners of its path, mm/s2 (default 500)"),
        cli_flag("smooth", &c->smooth, "corners with continuous acceleration; each takes twice as long"),
        cli_number("air-mm", "MM", 0, 1000, &m->air_mm, "start of a run above contact, mm (default 1)"),
        cli_number("air-s", "S", 0, 1e6, &m->air_s, "rest there before the run, s (default 1)"),
        cli_number("after-s", "S", 0, 1e6, &m->after_s, "rest there after the run, s (default 1)"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static size_t session_options(choice *c, cli_option *list) {
    acquire_options *o = &c->setup.session;
    const cli_option all[] = {
        cli_heading("Session"),
        cli_choice("order", "given|random", &c->order, "order of the presses (default given)"),
        cli_count("order-seed", "N", 0, 9e15, &c->order_seed, "seed of the random order (default 1)"),
        cli_flag("repeat-first", &c->repeat_first, "repeat the first press after the last"),
        cli_number("rest-s", "S", 0, 1e6, &c->motion.rest_s,
                   "recovery of the specimen between presses, s (default: duration of the\n"
                   "last press, at least 200)"),
        cli_number("reconnect-s", "S", 0, 1e6, &o->reconnect_s,
                   "time to plug a pulled cable in again while nothing moves, s (default 60)"),
        cli_choice("trigger-in", "mark|start", &c->trigger_in,
                   "trigger input of the indenter: mark: a pulse marks its sample; start: each\nrun also "
                   "waits for a pulse"),
        cli_count("trigger-out", "N", 0, 65535, &o->trigger_every,
                  "trigger output: a pulse with the first sample of each run and with every\nNth after it "
                  "(0: with the first only)"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static size_t explain_options(choice *c, cli_option *list) {
    const cli_option all[] = {
        cli_heading("Experiments that follow"),
        cli_in("until-explained", "MODEL.json", &c->until.model,
               "after the runs, palpate explain compares them with this model and designs an\n"
               "experiment, which is run; so on, until no effect has look-alikes"),
        cli_positive("budget-s", "S", 1e7, &c->until.time_s,
                     "time of the device for these experiments, s (default: as long as the runs)"),
        cli_count("every", "N", 1, 1e6, &c->until.every,
                  "explain takes one sample in N (default: so many that 20000 remain)"),
        cli_number("false-alarm", "P", 1e-4, 0.5, &c->until.false_alarm,
                   "chance that explain names an effect where none is (default 0.05)"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static size_t output_options(choice *c, cli_option *list) {
    acquire_options *o = &c->setup.session;
    const cli_option all[] = {
        cli_heading("Output"),
        cli_text("out", "DIR", &o->out, "folder for the recordings; created if it does not exist"),
        cli_flag("force", &o->force, "overwrite existing recordings"),
        cli_flag("live", &o->live, "draw the force in the terminal"),
        cli_flag("json", &c->json, "a summary as JSON on standard output"),
        cli_flag("dry-run", &c->dry_run, "print the runs, with --json also their paths, and move nothing"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static int parse(int argc, char **argv, choice *c) {
    cli_option options[OWN_OPTIONS + RIG_OPTIONS];
    size_t n = acquire_setup_device(&c->setup, options), words;
    options[n++] = cli_flag("list", &c->list, "list the serial ports instead");
    options[n++] = cli_flag("monitor", &c->monitor,
                            "only show force, place and temperatures, until Ctrl-C; moves nothing");
    n += plate_options(c, options + n);
    n += session_options(c, options + n);
    n += acquire_setup_specimen(&c->setup, options + n);
    n += explain_options(c, options + n);
    n += output_options(c, options + n);
    n += acquire_setup_columns(&c->setup, options + n);
    rig_options_list(&c->setup.rig, options + n);
    const cli_command command = {
        NAME,
        "--port PORT (--static | --ramp-hold MM,... | --cycles N | --sweep |\n"
        "                       --protocol FILE | --thesis-protocol) --out DIR [options]",
        "Runs a protocol on an indenter and records each run as an experiment. If a run ends early, its\n"
        "samples are kept with the reason. Homes the plate, tares the sensor in the air and finds contact\n"
        "once, before the first run. Exit code 4: the device stopped by a fault.",
        "  palpate acquire --port /dev/ttyACM0 --ramp-hold 1.5,3,5 --specimen-height-mm 24 --out runs\n"
        "  palpate acquire --port rig:data/sedef2008/lumped_n2.json --ramp-hold 2,4 --hold-s 20 --out runs\n"
        "  palpate acquire --port rig --thesis-protocol --out runs --json\n"
        "  palpate acquire --port /dev/ttyACM0 --protocol first.json --until-explained lumped.json --out "
        "runs\n",
        options,
        n + RIG_OPTIONS};
    return cli_parse(&command, argc, argv, NULL, 0, &words);
}

enum { STATIC = 1, RAMP_HOLD = 2, CYCLES = 4, SWEEP = 8, PROTOCOL = 16, THESIS = 32 };

static int modes(const choice *c) {
    return (c->is_static ? STATIC : 0) | (c->ramp_hold.n ? RAMP_HOLD : 0) | (c->cycles ? CYCLES : 0) |
           (c->sweep ? SWEEP : 0) | (c->protocol ? PROTOCOL : 0) | (c->thesis_protocol ? THESIS : 0);
}

static const char *mode_name(int mode) {
    static const char *const names[] = {"static", "ramp-hold", "cycles",
                                        "sweep",  "protocol",  "thesis-protocol"};
    size_t i = 0;
    while (mode >> (i + 1))
        i++;
    return names[i];
}

static int check_motion(const choice *c, int mode) {
    const acquire_motion *m = &c->motion;
    const struct {
        const char *option;
        double value;
        int goes_with;
    } uses[] = {{"depth-mm", m->depth_mm, STATIC | CYCLES | SWEEP | PROTOCOL},
                {"ramp-s", m->ramp_s, RAMP_HOLD | PROTOCOL | THESIS},
                {"hold-s", m->hold_s, RAMP_HOLD | SWEEP | PROTOCOL | THESIS},
                {"amplitude-mm", m->amplitude_mm, SWEEP | PROTOCOL},
                {"from-Hz", m->frequency_Hz, SWEEP | PROTOCOL},
                {"to-Hz", m->frequency_end_Hz, SWEEP | PROTOCOL},
                {"sweep-s", m->duration_s, SWEEP | PROTOCOL}};
    for (size_t i = 0; i < sizeof uses / sizeof uses[0]; i++)
        if (!isnan(uses[i].value) && !(uses[i].goes_with & mode))
            return cli_usage_error(NAME, "--%s does not go with --%s", uses[i].option, mode_name(mode));
    if (!isnan(m->rate_mm_s) && !isnan(m->ramp_s))
        return cli_usage_error(NAME, "--rate-mm-s and --ramp-s say the same thing; leave one out");
    if (isnan(m->depth_mm) && (mode & (STATIC | CYCLES | SWEEP)))
        return cli_usage_error(NAME, "--%s needs --depth-mm", mode_name(mode));
    return CLI_OK;
}

static int check_options(choice *c) {
    int mode = modes(c);
    int code = c->dry_run ? CLI_OK : acquire_setup_check(NAME, &c->setup);
    if (code)
        return code;
    if (mode == 0 || (mode & (mode - 1)))
        return cli_usage_error(NAME,
                               "say what the plate does by one of --static, --ramp-hold, --cycles, --sweep, "
                               "--protocol, --thesis-protocol");
    if ((c->until.time_s > 0 || c->until.every > 0 || c->until.false_alarm > 0) && !c->until.model)
        return cli_usage_error(NAME, "--%s needs --until-explained MODEL.json",
                               c->until.time_s > 0  ? "budget-s"
                               : c->until.every > 0 ? "every"
                                                    : "false-alarm");
    return check_motion(c, mode);
}

static void set_triggers(choice *c) {
    acquire_options *o = &c->setup.session;
    o->trigger_out = o->trigger_every != SIZE_MAX;
    o->trigger_every = o->trigger_out ? o->trigger_every : 0;
    o->trigger_in = c->trigger_in + 1;
    o->columns = o->trigger_in || o->trigger_out ? ACQUIRE_TRIGGER : 0;
}

static bool add(const choice *c, acquire_kind kind, double depth_mm, acquire_plan *plan,
                char why[ACQUIRE_TEXT]) {
    acquire_motion m = c->motion;
    m.depth_mm = depth_mm;
    m.cycles = c->cycles ? (double)c->cycles : NAN;
    return acquire_plan_add(plan, kind, &m, NULL, why) != NULL;
}

static int make_plan(const choice *c, acquire_plan *plan) {
    char why[ACQUIRE_TEXT] = "has too many runs";
    bool good = true;
    *plan = (acquire_plan){.smooth = c->smooth, .random = c->order, .repeat_first = c->repeat_first ? 1 : -1};
    plan->seed = c->order_seed == SIZE_MAX ? NAN : (double)c->order_seed;
    if (c->protocol) {
        int code = acquire_plan_read(plan, c->protocol, &c->motion);
        if (code)
            return code;
    } else if (c->thesis_protocol) {
        good = acquire_plan_seed(plan, &c->motion, why);
    } else if (c->ramp_hold.n == 0) {
        acquire_kind kind = c->is_static ? ACQUIRE_STATIC : c->cycles ? ACQUIRE_CYCLIC : ACQUIRE_SWEEP;
        good = add(c, kind, c->motion.depth_mm, plan, why);
    }
    for (size_t i = 0; good && i < c->ramp_hold.n; i++)
        good = add(c, ACQUIRE_RAMP_HOLD, c->ramp_hold.value[i], plan, why);
    good = good && acquire_plan_arrange(plan);
    return good ? CLI_OK : cli_usage_error(NAME, "--%s %s", mode_name(modes(c)), why);
}

static int check_specimen(const choice *c, const acquire_plan *plan) {
    const acquire_options *o = &c->setup.session;
    for (size_t i = 0; i < plan->n; i++) {
        const acquire_run *r = &plan->run[i];
        if (r->kind == ACQUIRE_FREE)
            continue;
        if (o->height_mm <= 0)
            return cli_usage_error(NAME, "how high is the specimen? Give --specimen-height-mm");
        if (r->deepest_mm >= o->height_mm)
            return cli_usage_error(NAME, "%s: %g mm does not fit a specimen of %g mm", r->name, r->deepest_mm,
                                   o->height_mm);
    }
    return CLI_OK;
}

/* Checks outputs in advance: existing files, and those that the rig reads or writes. */
static int check_files(const choice *c, const acquire_plan *plan) {
    const acquire_options *o = &c->setup.session;
    char path[CLI_PATH_MAX];
    int code = CLI_OK;
    if (cli_folder(NAME, o->out))
        return CLI_FAILURE;
    for (size_t i = 0; i < plan->n && code == CLI_OK; i++) {
        int n = snprintf(path, sizeof path, "%s/%s.csv", o->out, plan->run[i].name);
        if (n < 0 || (size_t)n >= sizeof path)
            return cli_failure(NAME, "%s: the name is too long", o->out);
        if (access(path, F_OK) == 0 && !o->force)
            return cli_failure(NAME, "%s is there already: name another --out, or give --force", path);
        code = c->setup.rig.log ? cli_output_check(NAME, path, true, 1, &c->setup.rig.log) : CLI_OK;
    }
    return code;
}

static int run_session(choice *c, acquire_plan *plan) {
    json_t *summary = NULL;
    int code = acquire_session(&c->setup.session, plan, c->json ? &summary : NULL);
    if (code == CLI_OK && c->until.model)
        code = acquire_until_explained(&c->setup, plan, &c->until, summary);
    if (summary) {
        int printed = json_print(NAME, summary);
        code = code ? code : printed;
    }
    return code;
}

/* Whether explain will be able to read the model, before anything moves. */
static int check_model(const char *file) {
    palp_model model;
    palp_mesh_source source;
    return file ? open_model(NAME, file, &model, &source) : CLI_OK;
}

static int with_device(choice *c, acquire_plan *plan) {
    int code = check_model(c->until.model);
    code = code ? code : acquire_setup_prepare(NAME, &c->setup);
    code = code ? code : check_specimen(c, plan);
    code = code ? code : check_files(c, plan);
    code = code ? code : acquire_setup_open(NAME, &c->setup);
    if (code)
        return code;
    code = run_session(c, plan);
    int closed = acquire_setup_close(&c->setup);
    return code ? code : closed;
}

static int dry_run(choice *c, const acquire_plan *plan) {
    if (c->setup.session.port && acquire_setup_prepare(NAME, &c->setup))
        return CLI_FAILURE;
    int code = check_specimen(c, plan);
    if (code)
        return code;
    if (c->json)
        return json_print(NAME, acquire_plan_json(plan));
    acquire_plan_print(plan, stdout);
    return CLI_OK;
}

static int monitor(choice *c) {
    c->setup.session.out = c->setup.session.out ? c->setup.session.out : ".";
    int code = acquire_setup_check(NAME, &c->setup);
    code = code ? code : acquire_setup_prepare(NAME, &c->setup);
    c->setup.settings.paced = true; /* somebody looks on */
    code = code ? code : acquire_setup_open(NAME, &c->setup);
    if (code)
        return code;
    code = acquire_monitor(&c->setup.session);
    int closed = acquire_setup_close(&c->setup);
    return code ? code : closed;
}

int cmd_acquire(int argc, char **argv) {
    choice c = {.order = -1, .trigger_in = -1, .order_seed = SIZE_MAX};
    c.setup = acquire_setup_default();
    c.setup.session.trigger_every = SIZE_MAX;
    c.setup.session.reconnect_s = 60;
    c.motion = acquire_motion_none();
    int code = parse(argc, argv, &c);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    if (c.list)
        return link_list() < 0 ? CLI_FAILURE : CLI_OK;
    if (c.monitor)
        return monitor(&c);
    c.setup.session.protocol = c.protocol;
    set_triggers(&c);
    code = check_options(&c);
    acquire_plan *plan = code ? NULL : malloc(sizeof *plan);
    if (code || !plan)
        return code ? code : cli_failure(NAME, "out of memory");
    code = make_plan(&c, plan);
    code = code ? code : c.dry_run ? dry_run(&c, plan) : with_device(&c, plan);
    free(plan);
    return code;
}
