/* spectrum.c: the stretches of a recording in which the plate oscillates. */
#include "spectrum_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 0.1; /* of the oscillation's range, by which the path returns */
static const double OCTAVES =
    1.189207115002721; /* change of the frequency in a stretch, in octaves: a quarter */

enum { FEWEST = 3, MOST = 100 }; /* cycles of a stretch */
enum {
    SETTLES = 4
}; /* of cycles of one length the first part, 1 in so many, is left out: the history still relaxes */

void palp_spectrum_free(palp_spectrum *spectrum) {
    if (!spectrum)
        return;
    free(spectrum->point);
    memset(spectrum, 0, sizeof *spectrum);
}

/* The samples from first to last where the path is deepest of a cycle, into peak[]; how many. */
static size_t find_peaks(const palp_recording *r, size_t first, size_t last, size_t *peak) {
    const double *depth = r->depth_m;
    double low = depth[first], high = low;
    for (size_t i = first; i <= last; i++) {
        low = fmin(low, depth[i]);
        high = fmax(high, depth[i]);
    }
    double back = TURN * (high - low);
    size_t n = 0, top = first, bottom = first;
    bool rising = true;
    for (size_t i = first; i <= last; i++) {
        top = depth[i] > depth[top] ? i : top;
        bottom = depth[i] < depth[bottom] ? i : bottom;
        if (rising && depth[top] - depth[i] > back) {
            if (top > first)
                peak[n++] = top;
            rising = false;
            bottom = i;
        } else if (!rising && depth[i] - depth[bottom] > back) {
            rising = true;
            top = i;
        }
    }
    return n;
}

static double period(const palp_recording *r, const size_t *peak, size_t cycle) {
    return r->time_s[peak[cycle + 1]] - r->time_s[peak[cycle]];
}

/* The end of the stretch that begins with a peak: a quarter of an octave on, or as few or as many cycles as
 * there may be. */
static size_t stretch_end(const palp_recording *r, const size_t *peak, size_t from, size_t last,
                          bool sweeps) {
    size_t to = from + FEWEST;
    for (; to < last && to < from + MOST; to++) {
        double ratio = period(r, peak, to - 1) / period(r, peak, from);
        if (sweeps && (ratio > OCTAVES || ratio * OCTAVES < 1.0))
            break;
    }
    return to;
}

static palp_status add(const palp_recording *r, const spectrum_stretch *stretch, palp_spectrum *to) {
    palp_spectrum_point point;
    bool found = false;
    palp_status status = spectrum_fit(r, stretch, &point, &found);
    if (status || !found)
        return status;
    if ((to->n & (to->n - 1)) == 0) { /* full at each power of two */
        palp_spectrum_point *larger = realloc(to->point, (to->n ? 2 * to->n : 1) * sizeof *larger);
        if (!larger)
            return PALP_ERR_NO_MEMORY;
        to->point = larger;
    }
    to->point[to->n++] = point;
    return PALP_OK;
}

static palp_status measure_piece(const palp_recording *r, const palp_piece *piece, palp_spectrum *to) {
    size_t *peak = malloc((piece->last - piece->first + 1) * sizeof *peak);
    if (!peak)
        return PALP_ERR_NO_MEMORY;
    bool sweeps = piece->motion == PALP_MOTION_SWEEP;
    size_t n = find_peaks(r, piece->first, piece->last, peak), edge = n > FEWEST + 3,
           last = n - (n > 0) - edge;
    size_t from = sweeps ? edge : edge + n / SETTLES;
    palp_status status = PALP_OK;
    while (!status && n > FEWEST && from + FEWEST <= last) {
        size_t end = stretch_end(r, peak, from, last, sweeps);
        const spectrum_stretch stretch = {
            peak[from], peak[end], (double)(end - from), period(r, peak, from), period(r, peak, end - 1),
            sweeps};
        status = add(r, &stretch, to);
        from = end;
    }
    free(peak);
    return status;
}

palp_status palp_spectrum_measure(const palp_recording *recording, palp_spectrum *spectrum) {
    palp_pieces pieces;
    if (!recording || !spectrum)
        return PALP_ERR_ARGUMENT;
    memset(spectrum, 0, sizeof *spectrum);
    palp_status status = palp_segments_pieces(recording->n, recording->time_s, recording->depth_m, &pieces);
    if (status)
        return status;
    for (size_t k = 0; k < pieces.n && !status; k++)
        if (pieces.piece[k].motion == PALP_MOTION_CYCLE || pieces.piece[k].motion == PALP_MOTION_SWEEP)
            status = measure_piece(recording, &pieces.piece[k], spectrum);
    palp_pieces_free(&pieces);
    if (status)
        palp_spectrum_free(spectrum);
    return status;
}
