/* message.c: the one line on stderr of an error or a warning. */
#include "cli.h"

#include <stdarg.h>

static void line(const char *name, const char *what, const char *format, va_list arguments) {
    fprintf(stderr, name ? "palpate %s: %s" : "palpate%s: %s", name ? name : "", what);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
}

int cli_usage_error(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    line(name, "", format, arguments);
    va_end(arguments);
    return CLI_USAGE;
}

int cli_failure(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    line(name, "", format, arguments);
    va_end(arguments);
    return CLI_FAILURE;
}

void cli_warning(const char *name, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    line(name, "warning: ", format, arguments);
    va_end(arguments);
}

int cli_status(const char *name, palp_status status, const palp_error *error) {
    bool gave_up =
        status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED;
    cli_failure(name, "%s", error && error->text[0] ? error->text : palp_status_text(status));
    return gave_up ? CLI_NOT_CONVERGED : CLI_FAILURE;
}
