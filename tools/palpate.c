/* palpate.c: the command: picks the subcommand. */
#include "shared/blas.h"
#include "shared/cli.h"
#include "shared/commands.h"

#include <palpate/version.h>
#include <string.h>

typedef struct subcommand {
    const char *group; /* printed above the first of a group */
    const char *name;
    const char *about;
    int (*run)(int argc, char **argv);
} subcommand;

static const subcommand subcommands[] = {
    {"Indenter", "acquire", "press a specimen and record it, by an indenter or the virtual one", cmd_acquire},
    {NULL, "panel", "a page in the browser to drive an indenter, or the virtual one", cmd_panel},
    {NULL, "firmware", "identify, home, tare or test an indenter, or clear its fault", cmd_firmware},
    {NULL, "calibrate-device", "measure the parameters of an indenter and store them in it",
     cmd_calibrate_device},
    {NULL, "rig", "the virtual indenter: the firmware, a simulated plant and a specimen", cmd_rig},
    {"Recordings", "import", "other testers' recordings (Mach-1, Instron, CSV) as experiments", cmd_import},
    {NULL, "characterize", "find a lumped model, with 95 % intervals, from raw recordings", cmd_characterize},
    {NULL, "report", "put recordings, models and results on one HTML page", cmd_report},
    {"Tissue models", "calibrate",
     "find the element material with which a network meets a lumped model or runs", cmd_calibrate},
    {NULL, "simulate", "press a model: static, ramp and hold, cyclic, creep, or as a run was recorded",
     cmd_simulate},
    {NULL, "inclusion", "find a stiffer or softer ball in a network from a map of presses", cmd_inclusion},
    {NULL, "reduce", "a small model of a large network, fast enough for a simulator's tick", cmd_reduce},
    {NULL, "explain", "find where a model and recordings disagree, and name the effect that is missing",
     cmd_explain},
    {"Files", "export", "write a model for another program (CalculiX, FEBio, MuJoCo ...)", cmd_export},
    {"Many runs", "batch", "run a command over many inputs, here or on many machines, into one table",
     cmd_batch},
    {NULL, "benchmark", "held-out errors of palpate and other programs on fixed splits, in one table",
     cmd_benchmark},
};

enum { SUBCOMMANDS = sizeof subcommands / sizeof subcommands[0] };

static void help(FILE *to) {
    fprintf(to,
            "palpate %s: from the press of an indenter to a tissue model that a simulator can run\n\n"
            "Usage: palpate COMMAND [options]\n",
            palp_version());
    for (size_t i = 0; i < SUBCOMMANDS; i++) {
        const subcommand *s = &subcommands[i];
        if (s->group)
            fprintf(to, "\n%s\n", s->group);
        fprintf(to, "  %-18s%s\n", s->name, s->about);
    }
    fputs("\n  palpate help COMMAND      options of a command, with units and an example\n"
          "  palpate --version         the version\n"
          "\nExample:\n"
          "  palpate acquire --port rig --ramp-hold 2,4,6 --out runs\n"
          "  palpate characterize static.csv hold_*.csv --out lumped.json\n"
          "  palpate calibrate lumped.json --nodes 3 --stage all --out network.json\n"
          "  palpate simulate network.json --protocol ramp_hold --depth-mm 6 --out run.csv\n"
          "\nExit codes: 0 success, 1 failure, 2 wrong usage, 3 not converged, 4 device fault\n",
          to);
}

static const subcommand *find(const char *name) {
    for (size_t i = 0; i < SUBCOMMANDS; i++)
        if (strcmp(name, subcommands[i].name) == 0)
            return &subcommands[i];
    return NULL;
}

static const subcommand *nearest(const char *name) {
    const char *names[SUBCOMMANDS];
    for (size_t i = 0; i < SUBCOMMANDS; i++)
        names[i] = subcommands[i].name;
    const char *near = cli_nearest(name, SUBCOMMANDS, names);
    return near ? find(near) : NULL;
}

static int unknown(const char *name) {
    const subcommand *near = nearest(name);
    return near ? cli_usage_error(NULL, "no such command: %s; did you mean %s?", name, near->name)
                : cli_usage_error(NULL, "no such command: %s; see palpate --help", name);
}

static int run(int argc, char **argv) {
    const char *word = argv[1];
    if (strcmp(word, "--version") == 0) {
        printf("palpate %s\n", palp_version());
        return CLI_OK;
    }
    bool helps = strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0;
    if (helps && argc == 2) {
        help(stdout);
        return CLI_OK;
    }
    const subcommand *s = find(helps ? argv[2] : word);
    if (!s)
        return unknown(helps ? argv[2] : word);
    char option[] = "--help", *ask[] = {argv[helps ? 2 : 1], option, NULL};
    return helps ? s->run(2, ask) : s->run(argc - 1, argv + 1);
}

int main(int argc, char **argv) {
    blas_one_thread(argv);
    if (argc < 2) {
        help(stderr);
        return CLI_USAGE;
    }
    int code = run(argc, argv);
    return code == CLI_OK ? cli_flush(NULL) : code;
}
