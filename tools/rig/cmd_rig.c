/* cmd_rig.c: palpate rig: the virtual indenter at a port, for palpate acquire or any other program. */
#define _POSIX_C_SOURCE 200809L
#include "shared/cli.h"
#include "shared/commands.h"
#include "rig_options.h"

#include <palpate/wire.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char NAME[] = "rig";

typedef struct options {
    rig_options rig;
    const char *model, *port, *script;
    double until_s;
    bool force;
} options;

static volatile sig_atomic_t stopped;

static void on_signal(int number) {
    (void)number;
    stopped = 1;
}

static int parse(int argc, char **argv, options *o) {
    enum { OWN = 6 }; /* with the heading */
    cli_option list[OWN + RIG_OPTIONS] = {
        cli_heading("Run"),
        cli_in("model", "MODEL.json", &o->model,
               "what is pressed, lumped or network (default: the phantom of the thesis,\n"
               "lumped, two arms)"),
        cli_text("port", "pty|tcp:PORT|file:PATH", &o->port,
                 "where the indenter answers: a pseudo-terminal (default), a TCP port\n"
                 "of this machine, or a file that takes what it sends"),
        cli_positive("until-s", "S", 1e6, &o->until_s,
                     "end after S seconds of the device's time (default: Ctrl-C)"),
        cli_in("script", "FILE", &o->script,
               "bytes to feed it as if a host sent them: lines of a tick and\n"
               "hexadecimal digits"),
        cli_flag("force", &o->force, "let the log or the port's file replace a recording"),
    };
    rig_options_list(&o->rig, list + OWN);
    const cli_command command = {
        NAME,
        "[--model MODEL.json] [options]",
        "Runs the indenter's firmware with a simulated motor, specimen and force sensor, and prints the\n"
        "port at which it answers.",
        "  palpate rig --model lumped.json --paced\n"
        "  palpate rig --port tcp:4000 --inject sensor_silent@20 --log truth.csv\n",
        list,
        OWN + RIG_OPTIONS};
    size_t n;
    return cli_parse(&command, argc, argv, NULL, 0, &n);
}

static int check_port(const options *o) {
    char *end;
    const char *port = o->port, *given[] = {o->model, o->script, o->rig.actuator, o->rig.log}, *other[4];
    size_t n = 0;
    for (size_t i = 0; i < 4; i++)
        if (given[i])
            other[n++] = given[i];
    if (strncmp(port, "file:", 5) == 0 && port[5])
        return cli_output_check(NAME, port + 5, o->force, n, other);
    long number = strncmp(port, "tcp:", 4) == 0 ? strtol(port + 4, &end, 10) : -1;
    bool good = strcmp(port, "pty") == 0 || (number > 0 && number < 65536 && *end == '\0');
    return good ? CLI_OK
                : cli_usage_error(NAME, "--port wants pty, file:PATH or tcp:PORT (1 to 65535), not \"%s\"",
                                  port);
}

/* Made absolute, since the firmware runs in a folder of its own. */
static const char *absolute(const char *port, char whole[RIG_PATH]) {
    char here[RIG_PATH];
    int n = 0;
    if (strncmp(port, "file:", 5) != 0 || port[5] == '/' || !getcwd(here, sizeof here))
        return port;
    n = snprintf(whole, RIG_PATH, "file:%s/%s", here, port + 5);
    return n > 0 && n < RIG_PATH ? whole : port;
}

/* Prints, once it runs, the firmware and the port. */
static void say_port(const char *port, void *context) {
    cli_say(stderr, "running %s", (const char *)context);
    cli_say(stdout, "%s", port);
    fflush(stdout);
}

static void catch_signals(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction act = {.sa_handler = on_signal};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        sigaction(numbers[i], &act, NULL);
}

static void say_figures(const rig_settings *s, const rig_figures *f) {
    fprintf(stderr, "%.3f s of the device's time in %.3f s", 1e-3 * f->ticks, f->elapsed_s);
    if (f->cost)
        fprintf(stderr, ", at most %u instructions a tick", (unsigned)f->cost);
    if (f->restarts)
        fprintf(stderr, ", restarted %u times", (unsigned)f->restarts);
    if (s->paced)
        fprintf(stderr, ", %u ticks late (worst %.2f ms)", (unsigned)f->late, 1e3 * f->worst_s);
    fputc('\n', stderr);
}

int cmd_rig(int argc, char **argv) {
    options o = {.rig = rig_options_default(), .port = "pty"};
    rig_settings settings;
    rig_figures figures;
    char note[RIG_NOTE], port[RIG_PATH];
    int code = parse(argc, argv, &o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    code = check_port(&o);
    code = code ? code : rig_options_settings(NAME, &o.rig, o.model, &settings);
    if (code)
        return code;
    settings.port = absolute(o.port, port);
    settings.script = o.script;
    settings.until_s = o.until_s;
    if (!rig_find(&settings, note))
        return cli_failure(NAME, "%s", note);
    catch_signals();
    code = rig_run(NAME, &settings, &stopped, say_port, note, &figures);
    if (code == CLI_OK)
        say_figures(&settings, &figures);
    return code;
}
