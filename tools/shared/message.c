/* message.c: what is said on a terminal: lines of a table, errors and warnings. */
#include "cli.h"

#include <stdarg.h>

/* Longest line; more is cut. */
enum { LINE_MAX_BYTES = 2 * CLI_PATH_MAX };

static void say(FILE *to, const char *start, const char *format, va_list arguments) {
    char line[LINE_MAX_BYTES];
    size_t n = (size_t)snprintf(line, sizeof line, "%s", start);
    vsnprintf(line + n, sizeof line - n, format, arguments);
    fprintf(to, "%s\n", palp_text_make_plain(line));
}

void cli_say(FILE *to, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    say(to, "", format, arguments);
    va_end(arguments);
}

static void message(const char *name, const char *what, const char *format, va_list arguments) {
    char start[64];
    snprintf(start, sizeof start, name ? "palpate %s: %s" : "palpate%s: %s", name ? name : "", what);
    say(stderr, start, format, arguments);
}

void cli_note(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    message(name, "", format, arguments);
    va_end(arguments);
}

int cli_usage_error(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    message(name, "", format, arguments);
    va_end(arguments);
    return CLI_USAGE;
}

int cli_failure(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    message(name, "", format, arguments);
    va_end(arguments);
    return CLI_FAILURE;
}

void cli_warning(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    message(name, "warning: ", format, arguments);
    va_end(arguments);
}

int cli_status_of(const char *name, const char *what, palp_status status, const palp_error *error) {
    bool gave_up =
        status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED;
    if (error && error->text[0])
        cli_failure(name, "%s", error->text);
    else
        cli_failure(name, what ? "%s: %s" : "%s%s", what ? what : "", palp_status_text(status));
    return gave_up ? CLI_NOT_CONVERGED : CLI_FAILURE;
}

int cli_status(const char *name, palp_status status, const palp_error *error) {
    return cli_status_of(name, NULL, status, error);
}
