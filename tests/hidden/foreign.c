/* foreign.c: effects that no row of the catalogue describes. */
#include "hidden.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

const char *foreign_name(enum foreign_id id) {
    static const char *const names[FOREIGNERS] = {
        [NOTHING_FOREIGN] = "none",
        [STICK_SLIP] = "stick_slip",
        [THERMAL_CYCLE] = "thermal_cycle",
        [STIFFNESS_CYCLE] = "stiffness_cycle",
        [COARSE_ADC] = "coarse_adc",
        [GAIN_MAP] = "gain_map",
        [SIDE_WALL] = "side_wall",
        [POWER_DAMPER] = "power_damper",
        [MISPLACED] = "misplaced",
        [BACKLASH] = "backlash",
        [CELL_HYSTERESIS] = "cell_hysteresis",
        [WANDER] = "wander",
        [TELEGRAPH] = "telegraph",
    };
    return names[id];
}

enum { TEETH = 200, WAVES = 10, FLIPS = 60 };

void foreign_begin(const world *w, const run *r, foreign_state *state) {
    random_state rng = random_make(w->foreign_seed, w->foreign == STICK_SLIP ? 0 : (uint64_t)r->order);
    double at = w->foreign == STICK_SLIP ? -8e-3 : 0;
    if (w->foreign == STICK_SLIP)
        for (int i = 0; i < TEETH; i++)
            state->table[i] = at += random_log(&rng, 0.08e-3, 0.5e-3);
    if (w->foreign == TELEGRAPH)
        for (int i = 0; i < FLIPS; i++)
            state->table[i] = at += random_log(&rng, 1, 20);
    if (w->foreign == WANDER)
        for (int i = 0; i < WAVES; i++) {
            state->table[2 * i] = random_log(&rng, 0.01, 0.5);
            state->table[2 * i + 1] = random_uniform(&rng, 0, 2 * pi);
        }
    state->table[TEETH - 1] = r->session; /* of the others, which use less of the table */
}

double foreign_depth(const world *w, double d, foreign_state *state) {
    if (w->foreign != BACKLASH)
        return d;
    double play = w->foreign_size;
    state->play = fmax(d - play, fmin(d + play, state->play));
    return state->play + play; /* contact on loading stays where it is */
}

double foreign_factor(const world *w, double time) {
    if (w->foreign == STIFFNESS_CYCLE)
        return 1 + w->foreign_size * sin(2 * pi * time / w->foreign_shape[0] + w->foreign_shape[1]);
    if (w->foreign == MISPLACED && time > w->foreign_shape[0] && time < w->foreign_shape[1])
        return 1 - w->foreign_size;
    return 1;
}

double foreign_contact(const world *w, double x, double v) {
    if (w->foreign == SIDE_WALL && x > w->foreign_shape[0])
        return w->foreign_size * pow((x - w->foreign_shape[0]) / 1e-3, 1.5);
    if (w->foreign == POWER_DAMPER && v != 0)
        return w->foreign_size * pow(fabs(v) / 1e-3, 0.4) * (v > 0 ? 1 : -1);
    return 0;
}

static double tooth(const foreign_state *state, double d, double v) {
    int i = 0;
    while (i + 2 < TEETH - 1 && state->table[i + 1] < d)
        i++;
    double share = (d - state->table[i]) / (state->table[i + 1] - state->table[i]);
    return v == 0 ? 0 : share - 0.5;
}

static double wander(const foreign_state *state, double t) {
    double sum = 0;
    for (int i = 0; i < WAVES; i++)
        sum += pow(state->table[2 * i] / 0.01, -0.5) *
               sin(2 * pi * state->table[2 * i] * t + state->table[2 * i + 1]);
    return sum;
}

static double flipped(const foreign_state *state, double t) {
    int i = 0;
    while (i < FLIPS && state->table[i] < t)
        i++;
    return i % 2 ? 1 : 0;
}

/* A cell of friction within: a fraction of every force change of less than the yield is held back. */
static double held_back(const world *w, double force, foreign_state *state) {
    double change = force - state->force, yield = w->foreign_shape[0];
    state->force = force;
    state->cell = fmax(-yield, fmin(yield, state->cell + change));
    return force + w->foreign_size * state->cell / yield;
}

double foreign_record(const world *w, double time, double d, double v, double force, foreign_state *state) {
    double since = time - state->table[TEETH - 1];
    switch (w->foreign) {
    case STICK_SLIP:
        return force + w->foreign_size * tooth(state, d, v);
    case THERMAL_CYCLE:
        return force + w->foreign_size * sin(2 * pi * time / w->foreign_shape[0] + w->foreign_shape[1]);
    case GAIN_MAP:
        return force * (1 + w->foreign_size * sin(2 * pi * d / w->foreign_shape[0] + w->foreign_shape[1]));
    case CELL_HYSTERESIS:
        return held_back(w, force, state);
    case WANDER:
        return force + w->foreign_size * wander(state, since);
    case TELEGRAPH:
        return force + w->foreign_size * flipped(state, since);
    default:
        return force;
    }
}

double foreign_convert(const world *w, double force) {
    return w->foreign == COARSE_ADC && w->foreign_size > 0 ? w->foreign_size * round(force / w->foreign_size)
                                                           : force;
}
