/* import_protocol.c: what the plate did, by the options or the motion. */
#include "import.h"

#include <math.h>
#include <string.h>

static const char *const protocols[] = {"static", "ramp_hold", "cyclic", "other"};

bool import_is_approach(const import_source *s) {
    return s->format == IMPORT_MACH1 &&
           (import_setting(s, "Contact Criteria, gf") || strcmp(s->block, "Find Contact") == 0);
}

/* First sample at which the depth has come to this part of its way to the deepest. */
static size_t reaches(const import_source *s, double part) {
    double deepest_mm = s->depth_mm[0];
    for (size_t i = 0; i < s->rows; i++) {
        deepest_mm = fmax(deepest_mm, s->depth_mm[i]);
    }
    size_t i = 0;
    while (i + 1 < s->rows && s->depth_mm[i] - s->depth_mm[0] < part * (deepest_mm - s->depth_mm[0])) {
        i++;
    }
    return i;
}

/* Ends at the deepest point: held there for longer than it took is a ramp and hold, else static. */
static const char *of_motion(const import_source *s) {
    size_t start = reaches(s, 0.02), there = reaches(s, 0.98), last = s->rows - 1;
    double least_mm = 0.95 * (s->depth_mm[there] - s->depth_mm[0]);
    for (size_t i = there; i <= last; i++) {
        if (s->depth_mm[i] - s->depth_mm[0] < least_mm) {
            return s->depth_mm[last] - s->depth_mm[0] < 0.5 * least_mm ? "cyclic" : "other";
        }
    }
    return s->time_s[last] - s->time_s[there] > s->time_s[there] - s->time_s[start] ? "ramp_hold" : "static";
}

void import_protocol(const import_options *o, import_source *s) {
    double ramps = import_setting_number(s, "Number of Ramp");
    if (o->protocol >= 0) {
        s->protocol = protocols[o->protocol];
    } else if (import_is_approach(s)) {
        s->protocol = "free";
    } else if (s->format == IMPORT_INSTRON) {
        s->protocol = "static";
    } else if (ramps > 0) {
        s->protocol = ramps == 1 ? "ramp_hold" : "other";
    } else {
        s->protocol = of_motion(s);
    }
}
