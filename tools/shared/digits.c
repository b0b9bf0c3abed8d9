/* digits.c: a number with as many digits as it deserves. */
#include "digits.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

const char *digits_text(char text[DIGITS_TEXT], double x, double uncertainty) {
    enum { FAR = 9 }; /* digits after the point */
    bool known = uncertainty > 0 && isfinite(uncertainty), small = x != 0 && fabs(x) < 0.01;
    double last = known   ? floor(log10(uncertainty)) - 1
                  : small ? floor(log10(fabs(x))) - 4
                          : -4; /* power of ten of the last digit */
    if (-last <= (known ? FAR : 4) && fabs(x) < 1e15) {
        snprintf(text, DIGITS_TEXT, "%.*f", (int)fmax(-last, 0), x);
    } else {
        double digits = x != 0 ? floor(log10(fabs(x))) - last : 0;
        snprintf(text, DIGITS_TEXT, "%.*e", (int)fmin(fmax(digits, 0), 15), x);
    }
    return text;
}
