/* json_out.c: JSON on standard output. */
#include "json_out.h"

#include "cli.h"

#include <math.h>

int json_print(const char *name, json_t *value) {
    if (!value) {
        return cli_failure(name, "out of memory");
    }
    int bad = json_dumpf(value, stdout, JSON_INDENT(2) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15));
    json_decref(value);
    putchar('\n');
    return bad || fflush(stdout) || ferror(stdout) ? cli_failure(name, "standard output: write error")
                                                   : CLI_OK;
}

json_t *json_number_or_null(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_numbers(size_t n, const double *value) {
    json_t *list = json_array();
    for (size_t i = 0; list && i < n; i++) {
        json_array_append_new(list, json_number_or_null(value[i]));
    }
    return list;
}
