/* free_term.c: names of free terms, and whether one is within bounds. */
#include "model_internal.h"

#include <math.h>

enum { N = PALP_FREE_NODES };

static const char *const kinds[PALP_FREE_KINDS] = {"depth_loading",
                                                   "depth_unloading",
                                                   "time_in_dwell",
                                                   "time_in_run",
                                                   "early_in_run",
                                                   "time_in_run_times_force",
                                                   "speed",
                                                   "speed_pressed",
                                                   "way_since_turn",
                                                   "time_in_session",
                                                   "place",
                                                   "place_times_force",
                                                   "time_since_change_of_speed"};

const char *palp_free_kind_name(palp_free_kind kind) {
    return (unsigned)kind < PALP_FREE_KINDS ? kinds[kind] : "unknown";
}

const char *palp_free_class_name(palp_free_class class_) {
    static const char *const names[PALP_FREE_CLASSES] = {"elastic",    "dissipative",    "of the clock",
                                                         "of the age", "of the session", "of the place"};
    return (unsigned)class_ < PALP_FREE_CLASSES ? names[class_] : "unknown";
}

bool palp_model_free_of_force(palp_free_kind kind) {
    return kind == PALP_FREE_AGEING || kind == PALP_FREE_GAIN;
}

palp_status palp_free_term_check(const palp_free_term *t) {
    if (!t || (unsigned)t->kind >= PALP_FREE_KINDS || (unsigned)t->does >= PALP_FREE_CLASSES)
        return PALP_ERR_ARGUMENT;
    bool good = isfinite(t->from) && isfinite(t->to) && t->from < t->to && t->depth_m > 0.0 &&
                isfinite(t->depth_m) && t->slow_m_s > 0.0 && isfinite(t->slow_m_s);
    good = good && isfinite(t->plate_N) && (!palp_model_free_of_force(t->kind) || t->plate_N > 0.0);
    for (int a = 0; a < N; a++)
        good = good && isfinite(t->force_N[a]) && t->sd_N[a] >= 0.0 && isfinite(t->sd_N[a]);
    return good ? PALP_OK : PALP_ERR_ARGUMENT;
}

double palp_free_term_coordinate(const palp_free_term *t, double share) {
    if (palp_free_term_check(t))
        return NAN;
    const double x = t->from + share * (t->to - t->from);
    const bool logarithm = t->kind == PALP_FREE_DWELL || t->kind == PALP_FREE_EARLY,
               speed = t->kind == PALP_FREE_SPEED || t->kind == PALP_FREE_PRESSED_SPEED;
    return logarithm ? exp(x) : speed ? t->slow_m_s * sinh(x) : x;
}
