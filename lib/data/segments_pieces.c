/* segments_pieces.c: the plate's protocol, piece by piece, from its path alone. */
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative to the path's range: what counts as still; least return of a turn. Relative to the largest depth:
 * what counts as hardly touched. */
static const double STILL = 2e-3, TURN = 0.012, SHALLOW = 0.02;
static const double PRELOADED = 0.15;  /* the same for a plate that stands at the start */
static const double NOISE = 6.0;       /* in sds of depth: what counts as still, too */
static const double LASTS = 1.0 / 6.0; /* least duration of a dwell, relative to the motion before it */
static const double HALTS =
    0.04; /* the same for a halt, relative to the motion after it, in the same direction */
static const double RESTS = 0.02;     /* the same for a rest at the start, relative to the motion after it */
static const double SLOWER = 0.25;    /* relative to the speed next to it: faster motion is not still */
static const double OVERSHOOT = 0.05; /* relative to the ramp before it: a return that ends in the dwell */
static const double ALIKE =
    2.0; /* legs of an oscillation differ from its middle one by less than this factor */
static const double ENDS = 0.4;  /* largest share of a leg's time in its outer twentieths */
static const double SWEPT = 1.5; /* factor by which the length of a sweep's legs changes */

enum { LEGS = 4 }; /* fewest legs of an oscillation */

const char *palp_motion_name(palp_motion motion) {
    static const char *const names[] = {"rest", "approach", "ramp", "dwell", "unload", "cycle", "sweep"};
    return (unsigned)motion < PALP_MOTION_COUNT ? names[motion] : "unknown";
}

void palp_pieces_free(palp_pieces *pieces) {
    if (!pieces)
        return;
    free(pieces->piece);
    memset(pieces, 0, sizeof *pieces);
}

typedef struct path {
    size_t n;
    const double *time, *depth;
    double range, deepest, still; /* still: half the width of what counts as still */
    size_t n_turns, *turn;        /* [n_turns] samples at which the path turns, with its ends */
    bool whole;                   /* no allocation failed */
    palp_pieces *to;
} path;

static void append_motion_piece(path *p, palp_motion motion, size_t first, size_t last) {
    palp_pieces *to = p->to;
    if (first == last || !p->whole)
        return;
    palp_piece *before = to->n ? &to->piece[to->n - 1] : NULL;
    if (before && before->motion == motion && motion != PALP_MOTION_CYCLE && motion != PALP_MOTION_SWEEP) {
        before->last = last;
        return;
    }
    if ((to->n & (to->n - 1)) == 0) { /* full at each power of two */
        palp_piece *larger = realloc(to->piece, (to->n ? 2 * to->n : 1) * sizeof *larger);
        p->whole = larger != NULL;
        to->piece = larger ? larger : to->piece;
        if (!larger)
            return;
    }
    to->piece[to->n++] = (palp_piece){motion, first, last};
}

static bool find_turning_points(path *p) {
    double back = fmax(TURN * p->range, 3.0 * p->still);
    size_t low = 0, high = 0, n = 1;
    int way = 0;
    p->turn = malloc((p->n + 1) * sizeof *p->turn);
    if (!p->turn)
        return false;
    p->turn[0] = 0;
    for (size_t i = 1; i < p->n; i++) {
        high = p->depth[i] > p->depth[high] ? i : high;
        low = p->depth[i] < p->depth[low] ? i : low;
        bool down = way >= 0 && p->depth[high] - p->depth[i] > back,
             up = way <= 0 && p->depth[i] - p->depth[low] > back;
        if (!down && !up)
            continue;
        size_t at = down ? high : low;
        if (at > p->turn[n - 1])
            p->turn[n++] = at;
        way = down ? -1 : 1;
        low = high = i;
    }
    if (p->turn[n - 1] != p->n - 1)
        p->turn[n++] = p->n - 1;
    p->n_turns = n;
    return true;
}

static double depth_range_of_leg(const path *p, size_t leg) {
    return fabs(p->depth[p->turn[leg + 1]] - p->depth[p->turn[leg]]);
}

static double duration_of_leg(const path *p, size_t leg) {
    return p->time[p->turn[leg + 1]] - p->time[p->turn[leg]];
}

/* Does a leg move nearly all the time? */
static bool does_leg_move_steadily(const path *p, size_t leg) {
    size_t first = p->turn[leg], last = p->turn[leg + 1];
    double a = fmin(p->depth[first], p->depth[last]), way = depth_range_of_leg(p, leg), near = 0.0;
    for (size_t i = first; i < last; i++) {
        double part = (0.5 * (p->depth[i] + p->depth[i + 1]) - a) / way;
        near += part < 0.05 || part > 0.95 ? p->time[i + 1] - p->time[i] : 0.0;
    }
    /* With few samples each takes much of the leg. */
    return near <= (ENDS + 2.0 / (double)(last - first)) * duration_of_leg(p, leg);
}

/* Number of legs from this one on that oscillate alike. */
static size_t find_oscillation_end(const path *p, size_t leg) {
    size_t end = leg;
    double least = HUGE_VAL, most = 0.0;
    for (; end + 1 < p->n_turns; end++) {
        double way = depth_range_of_leg(p, end);
        if (!does_leg_move_steadily(p, end) || fmax(most, way) > ALIKE * ALIKE * fmin(least, way))
            break;
        least = fmin(least, way);
        most = fmax(most, way);
    }
    return end - leg >= LEGS ? end : leg;
}

static bool is_frequency_sweep(const path *p, size_t leg, size_t end) {
    double first = duration_of_leg(p, leg) + duration_of_leg(p, leg + 1),
           last = duration_of_leg(p, end - 1) + duration_of_leg(p, end - 2);
    return first > SWEPT * last || last > SWEPT * first;
}

typedef struct stretch {
    size_t first, last;
    int way; /* -1 back, 0 still, 1 into the specimen */
} stretch;

static double depth_change_of_stretch(const path *p, const stretch *s) {
    return p->depth[s->last] - p->depth[s->first];
}

static double duration_of_stretch(const path *p, const stretch *s) {
    return p->time[s->last] - p->time[s->first];
}

static double mean_speed_of_stretch(const path *p, const stretch *s) {
    return fabs(depth_change_of_stretch(p, s)) / duration_of_stretch(p, s);
}

static size_t merge_equal_stretches(stretch *s, size_t n) {
    size_t m = 0;
    for (size_t k = 1; k < n; k++)
        if (s[k].way == s[m].way)
            s[m].last = s[k].last;
        else
            s[++m] = s[k];
    return n ? m + 1 : 0;
}

/* Divides the path into straight stretches, and merges those of one direction. */
static size_t split_into_stretches(const path *p, size_t from, size_t to, stretch *s) {
    size_t n = 0;
    for (size_t first = from, last; first < to; first = last) {
        segments_cone cone = segments_cone_open();
        for (last = first; last < to; last++)
            if (!segments_cone_take(&cone, p->time[last + 1] - p->time[first],
                                    p->depth[last + 1] - p->depth[first], p->still))
                break;
        double way = p->depth[last] - p->depth[first];
        s[n++] = (stretch){first, last, fabs(way) <= 2.5 * p->still ? 0 : way > 0.0 ? 1 : -1};
    }
    return merge_equal_stretches(s, n);
}

/* Is a rest too short, or nearly as fast as the motion next to it? Then it is part of that motion. */
static bool is_stretch_too_short(const path *p, const stretch *s, const stretch *before,
                                 const stretch *after) {
    const stretch *beside = before ? before : after;
    if (s->way != 0 || !beside)
        return false;
    double least = (before ? LASTS : RESTS) * duration_of_stretch(p, beside);
    if (before && after && before->way == after->way) /* a halt during the motion */
        least = fmax(least, HALTS * duration_of_stretch(p, after));
    return duration_of_stretch(p, s) < least ||
           mean_speed_of_stretch(p, s) > SLOWER * mean_speed_of_stretch(p, beside);
}

static size_t absorb_short_stretches(const path *p, stretch *s, size_t n) {
    size_t m = 0; /* stretches kept, of which the last one grows */
    for (size_t k = 0; k < n; k++) {
        const stretch *before = m > 0 ? &s[m - 1] : NULL, *after = k + 1 < n ? &s[k + 1] : NULL;
        stretch now = s[k];
        if (is_stretch_too_short(p, &now, before, after))
            now.way = before ? before->way : after->way;
        if (before && before->way == now.way)
            s[m - 1].last = now.last;
        else
            s[m++] = now;
    }
    return m;
}

/* A return after overshoot belongs to the dwell. */
static size_t absorb_overshoots(const path *p, stretch *s, size_t n) {
    for (size_t k = 1; k + 1 < n; k++)
        if (s[k].way == -s[k - 1].way && s[k + 1].way == 0 &&
            fabs(depth_change_of_stretch(p, &s[k])) < OVERSHOOT * fabs(depth_change_of_stretch(p, &s[k - 1])))
            s[k].way = 0;
    return merge_equal_stretches(s, n);
}

static size_t crosses_contact(const path *p, const stretch *s) {
    size_t i = s->first;
    while (i < s->last && p->depth[i] < 0.0)
        i++;
    return i;
}

static void add_named_stretch(path *p, const stretch *s) {
    double shallow = SHALLOW * fmax(p->deepest, 0.0);
    if (s->way == 0) {
        double middle = 0.5 * (p->depth[s->first] + p->depth[s->last]);
        append_motion_piece(p,
                            middle <= (s->first == 0 ? PRELOADED * fmax(p->deepest, 0.0) : shallow)
                                ? PALP_MOTION_REST
                                : PALP_MOTION_DWELL,
                            s->first, s->last);
    } else if (s->way < 0) {
        append_motion_piece(p, PALP_MOTION_UNLOAD, s->first, s->last);
    } else if (p->depth[s->last] <= shallow) {
        append_motion_piece(p, PALP_MOTION_APPROACH, s->first, s->last);
    } else {
        size_t contact = p->depth[s->first] < -shallow ? crosses_contact(p, s) : s->first;
        append_motion_piece(p, PALP_MOTION_APPROACH, s->first, contact);
        append_motion_piece(p, PALP_MOTION_RAMP, contact, s->last);
    }
}

/* Number of stretches without those that belong to the oscillation after them: the start of its first leg
 * after a rest or dwell, and the first turn. */
static size_t drop_oscillation_start(const path *p, const stretch *s, size_t n, double leg) {
    size_t k = n > 0 && s[n - 1].way == 0 ? n - 1 : n;
    return k > 1 && s[k - 1].way != 0 && s[k - 2].way == 0 &&
                   fabs(depth_change_of_stretch(p, &s[k - 1])) < 1.3 * leg
               ? k - 1
               : n;
}

/* Pieces between two samples without oscillation. leg: length of a leg of the oscillation that follows, 0 if
 * none. Returns where the oscillation begins. */
static size_t add_straight_stretches(path *p, size_t from, size_t to, double leg) {
    stretch *s = malloc((to - from + 1) * sizeof *s);
    if (!s) {
        p->whole = false;
        return to;
    }
    size_t n = absorb_overshoots(p, s, absorb_short_stretches(p, s, split_into_stretches(p, from, to, s))),
           own = leg > 0.0 ? drop_oscillation_start(p, s, n, leg) : n;
    for (size_t k = 0; k < own; k++)
        add_named_stretch(p, &s[k]);
    to = own < n ? s[own].first : to;
    free(s);
    return to;
}

static void find_motion_pieces(path *p) {
    size_t from = 0;
    for (size_t leg = 0; leg + 1 < p->n_turns;) {
        size_t end = find_oscillation_end(p, leg);
        if (end == leg) {
            leg++;
            continue;
        }
        size_t first = p->turn[leg];
        if (first > from)
            first = add_straight_stretches(p, from, first, depth_range_of_leg(p, leg));
        append_motion_piece(p, is_frequency_sweep(p, leg, end) ? PALP_MOTION_SWEEP : PALP_MOTION_CYCLE, first,
                            p->turn[end]);
        from = p->turn[end];
        leg = end;
    }
    if (from + 1 < p->n)
        add_straight_stretches(p, from, p->n - 1, 0.0);
}

palp_status palp_segments_pieces(size_t n, const double *time_s, const double *depth, palp_pieces *pieces) {
    if (!time_s || !depth || !pieces || n < 2)
        return PALP_ERR_ARGUMENT;
    *pieces = (palp_pieces){0, NULL};
    path p = {.n = n, .time = time_s, .depth = depth, .deepest = depth[0], .whole = true, .to = pieces};
    double low = depth[0], noise, step;
    size_t missing;
    for (size_t i = 0; i < n; i++) {
        low = fmin(low, depth[i]);
        p.deepest = fmax(p.deepest, depth[i]);
    }
    p.range = p.deepest - low;
    palp_status status = palp_segments_clock(n, time_s, &step, &missing);
    if (!status)
        status = palp_segments_noise(n, time_s, 4.0 * step, depth, PALP_NOISE_TRIMMED, &noise);
    if (status)
        return status;
    p.still = fmax(STILL * p.range, fmin(NOISE * noise, 0.05 * p.range));
    if (!find_turning_points(&p))
        return PALP_ERR_NO_MEMORY;
    find_motion_pieces(&p);
    free(p.turn);
    if (!p.whole)
        palp_pieces_free(pieces);
    return p.whole ? PALP_OK : PALP_ERR_NO_MEMORY;
}
