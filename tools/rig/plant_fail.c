/* plant_fail.c: the plant's error messages. */
#include "plant_internal.h"

#include <stdarg.h>
#include <stdio.h>

palp_status plant_fail(palp_error *error, palp_status status, const char *format, ...) {
    va_list arguments;
    if (error) {
        error->status = status;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}
