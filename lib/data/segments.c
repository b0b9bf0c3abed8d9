/* segments.c: the path of the plate: straight pieces, the first ramp, stillness, phases. */
#include "segments_internal.h"

#include <math.h>

/* Shares of the way at which the first motion has begun and has come to its end, and the depth is left for good. */
static const double BEGUN = 2e-3, ARRIVED = 0.998, LEFT = 0.95;

/* Half-width in time of a corner, and when an early dwell ends, s. */
static const double CORNER = 0.2, EARLY = 5.0;

segments_cone segments_cone_open(void) {
    return (segments_cone){.low = -HUGE_VAL, .high = HUGE_VAL};
}

bool segments_cone_take(segments_cone *cone, double time, double way, double tolerance) {
    cone->low = fmax(cone->low, (way - tolerance) / time);
    cone->high = fmin(cone->high, (way + tolerance) / time);
    return cone->low <= cone->high;
}

void segments_bends(size_t n, const double *depth, double *bend) {
    for (size_t i = 1; i + 1 < n; i++)
        bend[i - 1] = fabs(depth[i - 1] - 2.0 * depth[i] + depth[i + 1]);
}

size_t segments_still_end(size_t n, const double *depth, size_t i, double within) {
    size_t end = i + 1;
    while (end < n && fabs(depth[end] - depth[i]) < within)
        end++;
    return end;
}

void segments_ramp(size_t n, const double *depth, double deepest, size_t *start, size_t *end) {
    double from = fmax(depth[0], 0.0);
    size_t i = 0;
    while (i + 1 < n && depth[i] < from + BEGUN * (deepest - from))
        i++;
    *start = i;
    while (i + 1 < n && depth[i] < ARRIVED * deepest)
        i++;
    *end = i;
}

size_t segments_press_end(size_t n, const double *depth, double deepest, size_t ramp_end) {
    size_t last = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > ramp_end && depth[i] < LEFT * deepest)
            return last;
        if (depth[i] >= ARRIVED * deepest)
            last = i;
    }
    return n;
}

/* ---- phases ---- */

const char *palp_phase_name(palp_phase phase) {
    static const char *const names[] = {"air",    "ramp",     "corner", "early_dwell", "late_dwell",
                                        "unload", "recovery", "reload"};
    return (unsigned)phase < PALP_PHASE_COUNT ? names[phase] : "unknown";
}

/* Below which the plate stands: a hundredth of the fastest, or a fifth of the mean speed if that is less. */
static double still_speed(size_t n, const double *time, const double *depth) {
    double way = 0.0, fastest = 0.0;
    for (size_t i = 1; i < n; i++) {
        double step = fabs(depth[i] - depth[i - 1]);
        way += step;
        fastest = fmax(fastest, step / (time[i] - time[i - 1]));
    }
    return fmin(1e-2 * fastest, 0.2 * way / (time[n - 1] - time[0]));
}

/* What has been since the start; moves: -1 out of the specimen, 0, 1 into it. */
typedef struct past {
    double corner; /* time of the last change of moves */
    int moves;
    bool touched, unloaded;
} past;

static palp_phase phase_of(const past *p, double depth, double since) {
    if (depth <= 0.0)
        return p->touched ? PALP_PHASE_RECOVERY : PALP_PHASE_AIR;
    if (p->moves == 0 && since > CORNER)
        return since < EARLY ? PALP_PHASE_EARLY_DWELL : PALP_PHASE_LATE_DWELL;
    if (since < CORNER)
        return PALP_PHASE_CORNER;
    if (p->moves < 0)
        return PALP_PHASE_UNLOAD;
    return p->unloaded ? PALP_PHASE_RELOAD : PALP_PHASE_RAMP;
}

void palp_segments_phases(size_t n, const double *time, const double *depth, unsigned char *phase) {
    if (!time || !depth || !phase)
        return;
    double still = still_speed(n, time, depth);
    past p = {.corner = time[0]};
    for (size_t i = 0; i < n; i++) {
        size_t a = i ? i - 1 : 0, b = i ? i : 1;
        double speed = (depth[b] - depth[a]) / (time[b] - time[a]);
        int moves = fabs(speed) <= still ? 0 : speed > 0.0 ? 1 : -1;
        if (moves != p.moves)
            p.corner = time[i];
        p.moves = moves;
        p.touched = p.touched || depth[i] > 0.0;
        p.unloaded = p.unloaded || (p.touched && moves < 0);
        phase[i] = (unsigned char)phase_of(&p, depth[i], time[i] - p.corner);
    }
}

bool segments_sample_valid(const double *time, const double *depth, const double *force, size_t i) {
    static const double most = 1e12;
    return fabs(time[i]) <= most && fabs(depth[i]) <= most && fabs(force[i]) <= most && (i == 0 || time[i] > time[i - 1]);
}
