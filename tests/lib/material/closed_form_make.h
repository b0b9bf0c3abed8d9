/* closed_form_make.h: what the tests of closed forms share. */
#ifndef CLOSED_FORM_MAKE_H
#define CLOSED_FORM_MAKE_H

#include <palpate/closed_form.h>

#include <check.h>
#include <math.h>

#define CLOSE(got, want, tolerance) ck_assert_double_le(fabs((got) - (want)), (tolerance)*fabs(want))

enum { STATES = 16, STEPS = 8000 };

/* The shortest relaxation time is 0.5 s and the longest run 40 s: (h / tau)^4 / 120 < 1e-10. */
static const double times[] = {0.01, 0.4, 1.0, 1.7, 6.0, 40.0};
enum { TIMES = sizeof times / sizeof times[0] };
static const double rk4_error = 1e-9;

static const palp_spring_dashpot one = {1.2962987, 17.873062}; /* Table 4.4, N and N s */

static inline palp_generalized_maxwell solid(double spring, size_t n) {
    static const palp_spring_dashpot arms[5] = {
        {2.5847711, 3.6146}, {0.6853036, 23.964533}, {7.0, 3.5}, {0.05, 40.0}, {1.0, 3.5}};
    palp_generalized_maxwell model = {.spring_Pa = spring, .n_arms = n};
    for (size_t j = 0; j < n; j++)
        model.arms[j] = arms[j];
    return model;
}

#endif
