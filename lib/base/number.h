/* number.h: decimal numbers to and from text, exactly and in any locale. */
#ifndef PALP_NUMBER_H
#define PALP_NUMBER_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>

/* The C locale for this thread between enter and leave: strtod and printf then use '.'. */
typedef struct palp_locale {
    locale_t c, previous;
} palp_locale;

bool palp_locale_enter(palp_locale *scope); /* false: out of memory */
void palp_locale_leave(palp_locale *scope);

/* Reads [+-]digits[.digits][e[+-]digits] from NUL-terminated text; digits may be missing on one side of the
 * point. The value is bit for bit strtod's. Returns its end, or NULL if there is no number; nan, inf and
 * hexadecimal are not accepted. Too large a number gives an infinity. Needs a palp_locale. */
const char *palp_number_parse(const char *text, double *value);

enum { PALP_NUMBER_TEXT = 32 };

/* The shortest of %.15g, %.16g and %.17g that reads back as value; returns its length. Inside a
 * palp_locale. */
size_t palp_number_format(double value, char text[PALP_NUMBER_TEXT]);

#endif
