/* number.c: decimal numbers to and from text, exactly and in any locale. */
#define _POSIX_C_SOURCE 200809L /* newlocale, uselocale */
#include "number.h"

#include <float.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

bool palp_locale_enter(palp_locale *scope) {
    scope->c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (scope->c == (locale_t)0)
        return false;
    scope->previous = uselocale(scope->c);
    return true;
}

void palp_locale_leave(palp_locale *scope) {
    uselocale(scope->previous);
    freelocale(scope->c);
}

/* w 10^exponent if both are exact doubles: rounded once, as by strtod (Clinger 1990). */
static bool scale_by_exact_power(uint64_t w, int exponent, double *value) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (FLT_EVAL_METHOD != 0 || w > ((uint64_t)1 << 53) || exponent < -22 || exponent > 22)
        return false;
    *value = exponent < 0 ? (double)w / power[-exponent] : (double)w * power[exponent];
    return true;
}

/* Adds the digits at p to *w (modulo 2^64) and returns their end. */
static const char *accumulate_digits(const char *p, uint64_t *w) {
    uint64_t sum = *w;
    for (unsigned digit; (digit = (unsigned)*p - '0') < 10; p++)
        sum = 10 * sum + digit;
    *w = sum;
    return p;
}

/* Reads an exponent part at p, if complete, into *exponent; returns its end. */
static const char *parse_exponent_part(const char *p, int *exponent) {
    const char *digit = p + 1;
    bool negative = *digit == '-';
    if (*digit == '-' || *digit == '+')
        digit++;
    if (*digit < '0' || *digit > '9')
        return p;
    int e = 0;
    for (; *digit >= '0' && *digit <= '9'; digit++)
        e = e < 10000 ? 10 * e + (*digit - '0') : e;
    *exponent += negative ? -e : e;
    return digit;
}

const char *palp_number_parse(const char *text, double *value) {
    const char *p = text;
    bool negative = *p == '-';
    if (*p == '-' || *p == '+')
        p++;
    const char *first = p;
    uint64_t w = 0;
    p = accumulate_digits(p, &w);
    ptrdiff_t digits = p - first, decimals = 0;
    if (*p == '.') {
        const char *point = p;
        p = accumulate_digits(p + 1, &w);
        decimals = p - point - 1;
        digits += decimals;
    }
    if (digits == 0)
        return NULL;
    int exponent = decimals < 100 ? -(int)decimals : -100;
    if (*p == 'e' || *p == 'E')
        p = parse_exponent_part(p, &exponent);
    if (digits <= 19 && scale_by_exact_power(w, exponent, value))
        *value = negative ? -*value : *value;
    else
        *value = strtod(text, NULL);
    return p;
}

size_t palp_number_format(double value, char text[PALP_NUMBER_TEXT]) {
    int length = 0;
    double back;
    for (int precision = 15; precision <= 17; precision++) {
        length = snprintf(text, PALP_NUMBER_TEXT, "%.*g", precision, value);
        if (palp_number_parse(text, &back) && back == value)
            break;
    }
    return length > 0 ? (size_t)length : 0;
}
