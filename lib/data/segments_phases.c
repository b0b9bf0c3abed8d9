/* segments_phases.c: the plate's phase at each sample, from the pieces of its path. */
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>

/* Relative to the duration of the motion at a corner: duration of the corner, and end of an early dwell. */
static const double CORNER = 0.2, EARLY = 5.0;

static const double TURN = 0.25; /* relative to the range of an oscillation: least return of a turn */

const char *palp_phase_name(palp_phase phase) {
    static const char *const names[] = {"air",        "ramp",   "corner",   "early_dwell",
                                        "late_dwell", "unload", "recovery", "reload"};
    return (unsigned)phase < PALP_PHASE_COUNT ? names[phase] : "unknown";
}

/* State of a pass along the path. */
typedef struct walk {
    const double *time, *depth;
    unsigned char *phase;
    double *stood; /* NULL, or [n] for how long the plate stands still; negative where it moves */
    bool touched, unloaded;
    double motion_s; /* duration of the last motion in the specimen; 0 = none yet */
} walk;

static palp_phase phase_of_motion(walk *w, bool back) {
    w->unloaded = w->unloaded || back;
    return back ? PALP_PHASE_UNLOAD : w->unloaded ? PALP_PHASE_RELOAD : PALP_PHASE_RAMP;
}

/* Sets a sample's phase; outside of the specimen it is air or recovery, moving or not. */
static void assign_sample_phase(walk *w, size_t i, palp_phase phase) {
    w->touched = w->touched || w->depth[i] > 0.0;
    w->phase[i] = (unsigned char)(w->depth[i] > 0.0 ? phase
                                  : w->touched      ? PALP_PHASE_RECOVERY
                                                    : PALP_PHASE_AIR);
}

/* A motion between two samples; it begins with a corner unless it only comes out of the air. */
static void assign_motion_phases(walk *w, size_t first, size_t last, bool back, bool corner) {
    w->motion_s = w->time[last] - w->time[first];
    palp_phase phase = phase_of_motion(w, back);
    for (size_t i = first; i < last; i++)
        assign_sample_phase(
            w, i, corner && w->time[i] - w->time[first] < CORNER * w->motion_s ? PALP_PHASE_CORNER : phase);
}

static void assign_dwell_phases(walk *w, size_t first, size_t last) {
    double early = w->motion_s > 0.0 ? EARLY * w->motion_s : HUGE_VAL;
    for (size_t i = first; i < last; i++) {
        double since = w->time[i] - w->time[first];
        if (w->stood)
            w->stood[i] = since;
        assign_sample_phase(w, i,
                            since < CORNER * w->motion_s ? PALP_PHASE_CORNER
                            : since < early              ? PALP_PHASE_EARLY_DWELL
                                                         : PALP_PHASE_LATE_DWELL);
    }
}

/* The next sample at which an oscillation turns, or last. */
static size_t find_next_turning_point(const double *depth, size_t from, size_t last, double back,
                                      bool *down) {
    size_t high = from, low = from;
    for (size_t i = from + 1; i <= last; i++) {
        high = depth[i] > depth[high] ? i : high;
        low = depth[i] < depth[low] ? i : low;
        if (depth[high] - depth[i] > back && high > from) {
            *down = false;
            return high;
        }
        if (depth[i] - depth[low] > back && low > from) {
            *down = true;
            return low;
        }
    }
    *down = depth[last] < depth[from];
    return last;
}

static void assign_cycle_phases(walk *w, const palp_piece *piece) {
    double low = w->depth[piece->first], high = low;
    for (size_t i = piece->first; i <= piece->last; i++) {
        low = fmin(low, w->depth[i]);
        high = fmax(high, w->depth[i]);
    }
    for (size_t from = piece->first, to; from < piece->last; from = to) {
        bool down;
        to = find_next_turning_point(w->depth, from, piece->last, TURN * (high - low), &down);
        assign_motion_phases(w, from, to, down, true);
    }
}

static void assign_piece_phases(walk *w, const palp_pieces *pieces, size_t k) {
    const palp_piece *piece = &pieces->piece[k];
    bool comes = k == 0 || pieces->piece[k - 1].motion == PALP_MOTION_APPROACH;
    if (piece->motion == PALP_MOTION_REST || piece->motion == PALP_MOTION_DWELL)
        assign_dwell_phases(w, piece->first, piece->last);
    else if (piece->motion == PALP_MOTION_CYCLE || piece->motion == PALP_MOTION_SWEEP)
        assign_cycle_phases(w, piece);
    else if (piece->motion == PALP_MOTION_APPROACH)
        for (size_t i = piece->first; i < piece->last; i++)
            assign_sample_phase(w, i, PALP_PHASE_RAMP);
    else
        assign_motion_phases(w, piece->first, piece->last, piece->motion == PALP_MOTION_UNLOAD, !comes);
}

/* A dwell from where its force is reached. The motion before it began where the plate left the air, or
 * stood. */
static void assign_creep_phases(walk *w, const palp_piece *piece) {
    size_t start = piece->first;
    while (start > 0 && (w->phase[start - 1] == PALP_PHASE_RAMP || w->phase[start - 1] == PALP_PHASE_RELOAD ||
                         w->phase[start - 1] == PALP_PHASE_CORNER))
        start--;
    w->motion_s = w->time[piece->first + 1] - w->time[start]; /* at least one sample */
    assign_dwell_phases(w, piece->first, piece->last);
}

static palp_status assign_all_creep_phases(walk *w, size_t n, const double *force) {
    palp_pieces creep;
    palp_status status = palp_segments_creep(n, w->time, w->depth, force, &creep);
    if (status)
        return status;
    for (size_t k = 0; k < creep.n; k++)
        assign_creep_phases(w, &creep.piece[k]);
    palp_pieces_free(&creep);
    return PALP_OK;
}

palp_status segments_phases(size_t n, const double *time, const double *depth, const double *force,
                            unsigned char *phase, double *stood) {
    palp_pieces pieces;
    palp_status status = palp_segments_pieces(n, time, depth, &pieces);
    if (status)
        return status;
    walk w = {.time = time, .depth = depth, .phase = phase, .stood = stood};
    for (size_t i = 0; stood && i < n; i++)
        stood[i] = -1.0;
    for (size_t k = 0; k < pieces.n; k++)
        assign_piece_phases(&w, &pieces, k);
    assign_sample_phase(&w, n - 1, n > 1 ? (palp_phase)phase[n - 2] : PALP_PHASE_RAMP);
    palp_pieces_free(&pieces);
    status = force ? assign_all_creep_phases(&w, n, force) : PALP_OK;
    if (stood && n > 1 && stood[n - 2] >= 0.0)
        stood[n - 1] = stood[n - 2] + time[n - 1] - time[n - 2];
    return status;
}

palp_status palp_segments_phases(size_t n, const double *time, const double *depth, const double *force,
                                 unsigned char *phase) {
    if (!time || !depth || !phase)
        return PALP_ERR_ARGUMENT;
    return segments_phases(n, time, depth, force, phase, NULL);
}
