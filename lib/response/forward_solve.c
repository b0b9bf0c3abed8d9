/* forward_solve.c: zero of an increasing function, by Newton's method in a bracket. */
#include "forward_internal.h"

#include <math.h>

/* The error after so short a Newton step is about its square; so narrow a bracket is rounding. */
static const double CLOSE = 1e-10, NARROW = 4e-15;

palp_status forward_solve(forward_equation *equation, void *user, double low, double high, double *x) {
    double value, slope, next;
    bool below = false, above = false; /* has the function been below 0 at low, above 0 at high? */
    for (int i = 0; i < 200; i++, *x = next) {
        palp_status status = equation(user, *x, &value, &slope);
        if (status || value == 0.0)
            return status;
        if (value < 0.0) {
            low = *x;
            below = true;
        } else {
            high = *x;
            above = true;
        }
        next = *x - value / slope;
        bool close = fabs(next - *x) <= CLOSE * fmax(fabs(*x), 1e-3);
        if (close) {
            *x = fmax(low, fmin(high, next));
            return equation(user, *x, &value, &slope);
        }
        if (!(next > low && next < high))
            next = 0.5 * (low + high);
        if (!(high - low > NARROW))
            return below && above ? PALP_OK : PALP_ERR_NOT_CONVERGED;
    }
    return PALP_ERR_NOT_CONVERGED;
}
