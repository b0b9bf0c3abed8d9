/* explain_shown.c: the plate's motion in the runs, which decides the effects that they can show. */
#include "explain_data.h"

#include <math.h>

static const double PRESSED = 0.05; /* of the deepest: from there on a run presses */

/* Widens the range of a run's mean speeds over twentieths of the time that it presses. */
static void add_speeds(const explain_run *run, double deepest, double *slowest, double *fastest) {
    enum { PARTS = 20 };
    size_t first = 0, last = run->n - 1;
    while (first < last && run->depth[first] < PRESSED * deepest)
        first++;
    while (last > first && run->depth[last] < PRESSED * deepest)
        last--;
    const size_t part = (last - first) / PARTS;
    for (size_t k = 0; k < PARTS && part > 0; k++) {
        size_t a = first + k * part, b = a + part;
        double speed = (run->depth[b] - run->depth[a]) / (run->time[b] - run->time[a]);
        *slowest = fmin(*slowest, speed);
        *fastest = fmax(*fastest, speed);
    }
}

/* The largest way back of the plate. */
static double way_back(const explain_run *run) {
    double top = -HUGE_VAL, back = 0.0;
    for (size_t i = 0; i < run->n; i++) {
        top = fmax(top, run->depth[i]);
        back = fmax(back, top - run->depth[i]);
    }
    return back;
}

/* The least depth at which the run dwells, or to which it goes; HUGE_VAL: it does not press. */
static double least_deep(const explain_run *run, double deepest) {
    double least = HUGE_VAL, own = 0.0;
    for (size_t i = 0; i < run->n; i++) {
        const bool dwells = run->phase[i] == PALP_PHASE_EARLY_DWELL || run->phase[i] == PALP_PHASE_LATE_DWELL;
        own = fmax(own, run->depth[i]);
        if (dwells && run->depth[i] > PRESSED * deepest)
            least = fmin(least, run->depth[i]);
    }
    return own > PRESSED * deepest ? fmin(least, own) : HUGE_VAL;
}

void explain_shown_find(explain_data *data) {
    double slowest = HUGE_VAL, fastest = -HUGE_VAL, least = HUGE_VAL;
    effect_shown *shown = &data->shown;
    *shown = (effect_shown){.rate = HUGE_VAL, .stride = data->stride};
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        shown->rate = fmin(shown->rate, (double)(run->n - 1) / (run->time[run->n - 1] - run->time[0]));
        if (run->held_out)
            continue;
        add_speeds(run, data->deepest, &slowest, &fastest);
        shown->back = fmax(shown->back, way_back(run) / data->deepest);
        least = fmin(least, least_deep(run, data->deepest));
        shown->again = shown->again || run->largest_strain > 0.0;
    }
    shown->speeds = !(slowest > 0.0) ? HUGE_VAL : slowest < HUGE_VAL ? fastest / slowest : 1.0;
    shown->depths = least < HUGE_VAL ? data->deepest / least : 1.0;
}
