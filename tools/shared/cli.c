/* cli.c: options, their values and their help. */
#define _POSIX_C_SOURCE 200809L
#include "cli.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OPTIONS_MAX = 96, FIRST_CODE = 256, HELP_COLUMN = 26 };

static const char STDIN[] = "/dev/stdin"; /* what "-" stands for */

bool cli_read_number(const char *text, double *value) {
    char *end;
    double number = strtod(text, &end);
    if (end == text || *end || !isfinite(number))
        return false;
    *value = number;
    return true;
}

bool cli_read_list(const char *text, cli_list *list) {
    char word[64];
    list->n = 0;
    for (const char *from = text;;) {
        size_t length = strcspn(from, ",");
        if (length == 0 || length >= sizeof word || list->n == CLI_LIST_MAX)
            return false;
        memcpy(word, from, length);
        word[length] = '\0';
        if (!cli_read_number(word, &list->value[list->n++]))
            return false;
        if (!from[length])
            return true;
        from += length + 1;
    }
}

bool cli_spread(const cli_list *list, double value[3]) {
    if (list->n != 1 && list->n != 3)
        return false;
    for (size_t i = 0; i < 3; i++)
        value[i] = list->value[list->n == 3 ? i : 0];
    return true;
}

cli_option cli_heading(const char *text) {
    return (cli_option){.type = CLI_HEADING, .name = text};
}

cli_option cli_flag(const char *name, bool *to, const char *help) {
    return (cli_option){CLI_FLAG, name, NULL, help, {.flag = to}, 0, 0, NULL};
}

cli_option cli_text(const char *name, const char *value, const char **to, const char *help) {
    return (cli_option){CLI_TEXT, name, value, help, {.text = to}, 0, 0, NULL};
}

cli_option cli_in(const char *name, const char *value, const char **to, const char *help) {
    return (cli_option){CLI_IN, name, value, help, {.text = to}, 0, 0, NULL};
}

cli_option cli_out(const char *name, const char *value, const char **to, const char *help) {
    return (cli_option){CLI_OUT, name, value, help, {.text = to}, 0, 0, NULL};
}

cli_option cli_out_folder(const char *name, const char *value, const char **to, const char *files,
                          const char *help) {
    return (cli_option){CLI_OUT_FOLDER, name, value, help, {.text = to}, 0, 0, files};
}

cli_option cli_choice(const char *name, const char *choices, int *to, const char *help) {
    return (cli_option){CLI_CHOICE, name, choices, help, {.choice = to}, 0, 0, NULL};
}

cli_option cli_number(const char *name, const char *value, double low, double high, double *to,
                      const char *help) {
    return (cli_option){CLI_NUMBER, name, value, help, {.number = to}, low, high, NULL};
}

cli_option cli_positive(const char *name, const char *value, double high, double *to, const char *help) {
    return (cli_option){CLI_POSITIVE, name, value, help, {.number = to}, 0, high, NULL};
}

cli_option cli_count(const char *name, const char *value, double low, double high, size_t *to,
                     const char *help) {
    return (cli_option){CLI_COUNT, name, value, help, {.count = to}, low, high, NULL};
}

cli_option cli_numbers(const char *name, const char *value, double high, cli_list *to, const char *help) {
    return (cli_option){CLI_NUMBERS, name, value, help, {.list = to}, 0, high, NULL};
}

cli_option cli_counts(const char *name, const char *value, double low, double high, cli_list *to,
                      const char *help) {
    return (cli_option){CLI_COUNTS, name, value, help, {.list = to}, low, high, NULL};
}

static int choice_index(const char *choices, const char *text) {
    size_t length = strlen(text);
    int index = 0;
    for (const char *at = choices;; index++) {
        size_t n = strcspn(at, "|");
        if (n == length && memcmp(at, text, n) == 0)
            return index;
        if (!at[n])
            return -1;
        at += n + 1;
    }
}

static int check_range(const char *name, const cli_option *o, double x) {
    bool whole = o->type == CLI_COUNT || o->type == CLI_COUNTS;
    bool above = o->type == CLI_POSITIVE || o->type == CLI_NUMBERS;
    if (whole && x != floor(x))
        return cli_usage_error(name, "--%s must be a whole number, not %g", o->name, x);
    if (above && (x <= 0 || x > o->high))
        return cli_usage_error(name, "--%s must be above 0 and at most %g, not %g", o->name, o->high, x);
    if (!above && (x < o->low || x > o->high))
        return cli_usage_error(name, "--%s must be from %g to %g, not %g", o->name, o->low, o->high, x);
    return CLI_OK;
}

static int take_list(const char *name, const cli_option *o, const char *text) {
    if (!cli_read_list(text, o->to.list))
        return cli_usage_error(name, "--%s must be numbers separated by commas (%s), not \"%s\"", o->name,
                               o->value, text);
    for (size_t i = 0; i < o->to.list->n; i++) {
        int code = check_range(name, o, o->to.list->value[i]);
        if (code)
            return code;
    }
    return CLI_OK;
}

static int take_number(const char *name, const cli_option *o, const char *text) {
    double x = 0;
    if (!cli_read_number(text, &x))
        return cli_usage_error(name, "--%s must be a number (%s), not \"%s\"", o->name, o->value, text);
    int code = check_range(name, o, x);
    if (code == CLI_OK && o->type == CLI_COUNT)
        *o->to.count = (size_t)x;
    else if (code == CLI_OK)
        *o->to.number = x;
    return code;
}

static int take(const char *name, const cli_option *o, const char *text) {
    switch (o->type) {
    case CLI_HEADING:
        return CLI_OK;
    case CLI_FLAG:
        *o->to.flag = true;
        return CLI_OK;
    case CLI_TEXT:
    case CLI_IN:
    case CLI_OUT:
    case CLI_OUT_FOLDER:
        if (!*text || strlen(text) >= CLI_PATH_MAX - 32)
            return cli_usage_error(name, "--%s needs a name that is not empty or too long (%s)", o->name,
                                   o->value);
        *o->to.text = text;
        if (strcmp(text, "-") == 0 && (o->type == CLI_IN || o->type == CLI_OUT))
            *o->to.text = o->type == CLI_IN ? STDIN : "/dev/stdout";
        return CLI_OK;
    case CLI_CHOICE:
        *o->to.choice = choice_index(o->value, text);
        return *o->to.choice >= 0
                   ? CLI_OK
                   : cli_usage_error(name, "--%s must be one of %s, not \"%s\"", o->name, o->value, text);
    case CLI_NUMBERS:
    case CLI_COUNTS:
        return take_list(name, o, text);
    case CLI_NUMBER:
    case CLI_POSITIVE:
    case CLI_COUNT:
        break;
    }
    return take_number(name, o, text);
}

/* The --force of the command itself; NULL = none. */
static const bool *own_force(const cli_command *command) {
    for (size_t i = 0; i < command->n_options; i++)
        if (command->options[i].type == CLI_FLAG && strcmp(command->options[i].name, "force") == 0)
            return command->options[i].to.flag;
    return NULL;
}

/* Whether it has outputs, but no --force of its own. */
static bool wants_force(const cli_command *command) {
    bool outputs = false;
    for (size_t i = 0; i < command->n_options; i++)
        outputs =
            outputs || command->options[i].type == CLI_OUT || command->options[i].type == CLI_OUT_FOLDER;
    return outputs && !own_force(command);
}

static void long_options(const cli_command *command, struct option *table) {
    size_t n = 0;
    for (size_t i = 0; i < command->n_options && n + 3 < OPTIONS_MAX; i++) {
        const cli_option *o = &command->options[i];
        if (o->type != CLI_HEADING)
            table[n++] = (struct option){o->name, o->type == CLI_FLAG ? no_argument : required_argument, NULL,
                                         FIRST_CODE + (int)i};
    }
    table[n++] = (struct option){"help", no_argument, NULL, 'h'};
    if (wants_force(command))
        table[n++] = (struct option){"force", no_argument, NULL, 'f'};
    table[n] = (struct option){NULL, 0, NULL, 0};
}

static int unknown_option(const cli_command *command, const char *typed) {
    const char *names[OPTIONS_MAX], *near;
    char word[64];
    size_t n = 0;
    snprintf(word, sizeof word, "%.*s", (int)strcspn(typed + 2, "="), typed + 2);
    for (size_t i = 0; i < command->n_options && n < OPTIONS_MAX; i++)
        if (command->options[i].type != CLI_HEADING)
            names[n++] = command->options[i].name;
    near = cli_nearest(word, n, names);
    return near ? cli_usage_error(command->name, "no such option: %s; did you mean --%s?", typed, near)
                : cli_usage_error(command->name, "no such option: %s; see palpate %s --help", typed,
                                  command->name);
}

static int bad_option(const cli_command *command, int code, char **argv) {
    const char *name = command->name;
    if (code == ':')
        return cli_usage_error(name, "%s needs a value; see palpate %s --help", argv[optind - 1], name);
    if (optopt >= FIRST_CODE)
        return cli_usage_error(name, "%s takes no value; see palpate %s --help", argv[optind - 1], name);
    if (optopt && strncmp(argv[optind - 1], "--", 2) != 0)
        return cli_usage_error(name, "no such option: -%c; see palpate %s --help", optopt, name);
    return unknown_option(command, argv[optind - 1]);
}

static void restart_getopt(void) {
    opterr = 0;
#if defined(__GLIBC__)
    optind = 0;
#else
    optind = 1;
#endif
}

int cli_parse(const cli_command *command, int argc, char **argv, const char **words, size_t max_words,
              size_t *n_words) {
    struct option table[OPTIONS_MAX];
    const bool *own = own_force(command);
    bool force = false;
    int code;
    long_options(command, table);
    restart_getopt();
    while ((code = getopt_long(argc, argv, ":h", table, NULL)) != -1) {
        if (code == 'h') {
            cli_help(command, stdout);
            return CLI_HELP;
        }
        if (code == 'f') {
            force = true;
            continue;
        }
        if (code < FIRST_CODE)
            return bad_option(command, code, argv);
        int exit_code = take(command->name, &command->options[code - FIRST_CODE], optarg);
        if (exit_code)
            return exit_code;
    }
    for (*n_words = 0; optind < argc; optind++) {
        if (*n_words == max_words)
            return cli_usage_error(command->name, "one argument too many: \"%s\"", argv[optind]);
        words[(*n_words)++] = strcmp(argv[optind], "-") == 0 ? STDIN : argv[optind];
    }
    return cli_outputs_check(command, own ? *own : force, words, *n_words);
}

/* Help lines of several rows are separated by \n in the text. */
static void help_line(const cli_option *o, FILE *to) {
    int width =
        o->type == CLI_FLAG ? fprintf(to, "  --%s", o->name) : fprintf(to, "  --%s %s", o->name, o->value);
    if (width > HELP_COLUMN - 2) { /* two blanks separate them in a manual page */
        fputc('\n', to);
        width = 0;
    }
    for (const char *at = o->help; at;) {
        int n = (int)strcspn(at, "\n");
        fprintf(to, "%*s%.*s\n", HELP_COLUMN - width, "", n, at);
        width = 0;
        at = at[n] ? at + n + 1 : NULL;
    }
}

void cli_help(const cli_command *command, FILE *to) {
    fprintf(to, "Usage: palpate %s %s\n\n%s\n", command->name, command->usage, command->about);
    for (size_t i = 0; i < command->n_options; i++) {
        const cli_option *o = &command->options[i];
        if (o->type == CLI_HEADING)
            fprintf(to, "\n%s\n", o->name);
        else
            help_line(o, to);
    }
    if (wants_force(command))
        fprintf(to, "  --force%*sallow an output to replace a recording\n", HELP_COLUMN - 9, "");
    fprintf(to, "  --help%*sthis text\n\nExample:\n%s", HELP_COLUMN - 8, "", command->example);
}

void cli_keep_command(int argc, char **argv, char command[CLI_COMMAND_MAX]) {
    size_t at = (size_t)snprintf(command, CLI_COMMAND_MAX, "palpate");
    for (int i = 0; i < argc && at < CLI_COMMAND_MAX; i++) {
        int n = snprintf(command + at, CLI_COMMAND_MAX - at, " %s", argv[i]);
        at += n > 0 ? (size_t)n : 0;
    }
    if (at >= CLI_COMMAND_MAX)
        memcpy(command + CLI_COMMAND_MAX - 5, " ...", 5);
    palp_text_make_plain(command);
}

/* Edit distance with swaps of neighbours (Damerau-Levenshtein). */
static size_t distance(const char *a, const char *b) {
    enum { MOST = 32 };
    size_t n = strlen(a), m = strlen(b), row[3][MOST + 1], *two = row[0], *above = row[1], *now = row[2];
    if (n > MOST || m > MOST)
        return MOST;
    for (size_t j = 0; j <= m; j++)
        above[j] = two[j] = j;
    for (size_t i = 1; i <= n; i++) {
        now[0] = i;
        for (size_t j = 1; j <= m; j++) {
            size_t best = above[j - 1] + (a[i - 1] != b[j - 1]),
                   other = above[j] < now[j - 1] ? above[j] : now[j - 1];
            bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            best = other + 1 < best ? other + 1 : best;
            now[j] = swapped && two[j - 2] + 1 < best ? two[j - 2] + 1 : best;
        }
        size_t *oldest = two;
        two = above;
        above = now;
        now = oldest;
    }
    return above[m];
}

const char *cli_nearest(const char *word, size_t n, const char *const name[]) {
    const char *best = NULL;
    size_t least = strlen(word) < 6 ? 2 : 3; /* at this distance nothing matches */
    for (size_t i = 0; i < n; i++) {
        size_t d = distance(word, name[i]);
        if (d < least || (d == least && !best && strncmp(word, name[i], 3) == 0)) {
            best = name[i];
            least = d;
        }
    }
    return best;
}
