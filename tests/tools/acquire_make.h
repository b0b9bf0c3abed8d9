/* acquire_make.h: what the tests of acquire share. */
#ifndef ACQUIRE_MAKE_H
#define ACQUIRE_MAKE_H

#include "acquire/acquire.h"
#include "acquire_fake.h"

#include <math.h>
#include <palpate/experiment.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static inline const char *in_folder(const char *name) {
    static char path[4][640];
    static int next;
    char *to = path[next++ % 4];
    const char *scratch = getenv("SCRATCH");
    snprintf(to, 640, "%s/%s", scratch ? scratch : "/tmp", name);
    return to;
}

static inline void near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance)) {
        fail_msg("%.12g is not %.12g", a, b);
    }
}

static inline acquire_plan *empty_plan(void) {
    acquire_plan *plan = calloc(1, sizeof *plan);
    assert_non_null(plan);
    plan->random = plan->repeat_first = -1;
    plan->seed = NAN;
    return plan;
}

static inline palp_experiment *read_file(const char *name) {
    palp_experiment *e = NULL;
    palp_error error = {PALP_OK, ""};
    if (palp_experiment_read(in_folder(name), &e, &error) != PALP_OK) {
        fail_msg("%s", error.text);
    }
    return e;
}

static inline const char *fault_of(const palp_experiment *e) {
    const char *text = NULL;
    return palp_experiment_get_string(e, "end.fault", &text) == PALP_OK ? text : NULL;
}

#endif
