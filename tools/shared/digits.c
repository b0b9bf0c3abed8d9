/* digits.c: how many digits a number deserves. */
#include "digits.h"

#include <math.h>

int digits_after_point(double uncertainty) {
    if (!(uncertainty > 0) || !isfinite(uncertainty))
        return 4;
    return (int)fmin(fmax(1 - floor(log10(uncertainty)), 0), 9);
}
