/* cli.h: what the commands share: options and their help, error lines, exit codes, output files. */
#ifndef PALPATE_CLI_H
#define PALPATE_CLI_H

#include <palpate/file.h>

#if defined(__GNUC__)
#define CLI_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define CLI_PRINTF(text, first)
#endif

enum { CLI_OK = 0, CLI_FAILURE = 1, CLI_USAGE = 2, CLI_NOT_CONVERGED = 3, CLI_DEVICE_FAULT = 4 };
enum { CLI_HELP = -1 };     /* cli_parse printed the help: exit 0 */
enum { CLI_LIST_MAX = 64 }; /* most numbers in a list such as 1.5,2,2.5 */
enum { CLI_PATH_MAX = 4096, CLI_COMMAND_MAX = 1024 };

typedef struct cli_list {
    size_t n;
    double value[CLI_LIST_MAX];
} cli_list;

typedef enum cli_type {
    CLI_HEADING,
    CLI_FLAG,
    CLI_TEXT,
    CLI_IN,
    CLI_OUT,
    CLI_OUT_FOLDER,
    CLI_CHOICE,
    CLI_NUMBER,
    CLI_POSITIVE,
    CLI_COUNT,
    CLI_NUMBERS,
    CLI_COUNTS
} cli_type;

/* One option; made by the functions below. */
typedef struct cli_option {
    cli_type type;
    const char *name;  /* without the dashes */
    const char *value; /* placeholder of the value in the help, e.g. "MM" */
    const char *help;  /* its rows separated by \n */
    union {
        bool *flag;
        const char **text;
        int *choice;
        double *number;
        size_t *count;
        cli_list *list;
    } to;
    double low, high;
    const char *files; /* patterns of the files in a folder, between blanks */
} cli_option;

cli_option cli_heading(const char *text); /* of a group of options, in the help */
cli_option cli_flag(const char *name, bool *to, const char *help);
cli_option cli_text(const char *name, const char *value, const char **to, const char *help);

/* A file to read ("-": standard input; several between commas) or to write ("-": standard output). A command
 * with outputs accepts --force, which allows them to replace a recording; it may define this flag itself. */
cli_option cli_in(const char *name, const char *value, const char **to, const char *help);
cli_option cli_out(const char *name, const char *value, const char **to, const char *help);

/* A folder of outputs; files: patterns of them, such as "*.vtu result.json". */
cli_option cli_out_folder(const char *name, const char *value, const char **to, const char *files,
                          const char *help);

/* choices: "first|second|third"; *to is the index. */
cli_option cli_choice(const char *name, const char *choices, int *to, const char *help);

/* low <= x <= high; 0 < x <= high; whole, low <= n <= high; and lists of the last two. */
cli_option cli_number(const char *name, const char *value, double low, double high, double *to,
                      const char *help);
cli_option cli_positive(const char *name, const char *value, double high, double *to, const char *help);
cli_option cli_count(const char *name, const char *value, double low, double high, size_t *to,
                     const char *help);
cli_option cli_numbers(const char *name, const char *value, double high, cli_list *to, const char *help);
cli_option cli_counts(const char *name, const char *value, double low, double high, cli_list *to,
                      const char *help);

typedef struct cli_command {
    const char *name;  /* "simulate" */
    const char *usage; /* "MODEL.json --protocol P [options]" */
    const char *about;
    const char *example;
    const cli_option *options;
    size_t n_options;
} cli_command;

/* Reads options into their targets and other words into words[max_words], "-" as standard input. Returns
 * CLI_OK, CLI_USAGE after one line on stderr, or CLI_HELP after the help on stdout. */
int cli_parse(const cli_command *command, int argc, char **argv, const char **words, size_t max_words,
              size_t *n_words);

void cli_help(const cli_command *command, FILE *to);

/* The command line as typed, made plain text and cut if too long. Call it before cli_parse, which reorders
 * words. */
void cli_keep_command(int argc, char **argv, char command[CLI_COMMAND_MAX]);

/* One line with a newline after it. All these functions remove control characters of names
 * (palp_text_make_plain). */
void cli_say(FILE *to, const char *format, ...) CLI_PRINTF(2, 3);

/* One line "palpate NAME: ..." on stderr; returns the exit code of its name. */
void cli_note(const char *name, const char *format, ...) CLI_PRINTF(2, 3);
int cli_usage_error(const char *name, const char *format, ...) CLI_PRINTF(2, 3);
int cli_failure(const char *name, const char *format, ...) CLI_PRINTF(2, 3);
void cli_warning(const char *name, const char *format, ...) CLI_PRINTF(2, 3);

/* The same for a failed library call: error's text, else "WHAT: " and that of the status; what names the file
 * or option. Returns 3 if a solver gave up, else 1. */
int cli_status(const char *name, palp_status status, const palp_error *error);
int cli_status_of(const char *name, const char *what, palp_status status, const palp_error *error);

/* Reads all of text as a finite number, or as numbers between commas (up to CLI_LIST_MAX). */
bool cli_read_number(const char *text, double *value);
bool cli_read_list(const char *text, cli_list *list);

/* Spreads a list of one or three values over three axes. */
bool cli_spread(const cli_list *list, double value[3]);

/* Opens a file for writing by the rules of palpate/file.h; NULL path = standard output. End it by
 * cli_file_close or palp_file_abandon. */
int cli_file_open(const char *name, const char *path, palp_file *file);
int cli_file_close(const char *name, palp_file *file);

/* Flushes standard output. */
int cli_flush(const char *name);

/* Checks outputs: none is an input, a recording or another output. Returns an exit code. */
int cli_outputs_check(const cli_command *command, bool force, const char *const words[], size_t n_words);

/* Refuses an output that is an input. Unless forced it also refuses to replace a recording (an experiment
 * that no simulation wrote). cli_parse calls it for CLI_OUT. */
int cli_output_check(const char *name, const char *path, bool force, size_t n_inputs,
                     const char *const inputs[]);

/* The nearest name to a mistyped word; NULL = none. */
const char *cli_nearest(const char *word, size_t n, const char *const name[]);

/* The part after the last slash. */
const char *cli_base(const char *path);

/* Creates the folder if it does not exist; returns an exit code. */
int cli_folder(const char *name, const char *folder);

#endif
