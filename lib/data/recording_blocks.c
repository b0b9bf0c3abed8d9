/* recording_blocks.c: a recording in blocks of samples, short against what changes in them. */
#include "base/statistics.h"
#include "recording_internal.h"
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The path of the plate in straight pieces: from sample `from` on every depth is within a tolerance of one
 * straight line. */
typedef struct straight {
    size_t from;
    segments_cone cone;
    double tolerance;
} straight;

/* A two-thousandth of the way, or more for an encoder whose counts or jitter are coarser: the typical second
 * difference of the depth, where it is not 0, unless only a few corners have one. */
static palp_status path_tolerance(const palp_recording *rec, double *tolerance) {
    double *bend = malloc(rec->n * sizeof *bend), least = 5e-4 * rec->deepest_m;
    size_t m = 0;
    if (!bend)
        return PALP_ERR_NO_MEMORY;
    segments_bends(rec->n, rec->depth_m, bend);
    for (size_t i = 0; i + 2 < rec->n; i++)
        if (bend[i] > 1e-9 * rec->deepest_m)
            bend[m++] = bend[i];
    double typical = m > rec->n / 500 + 4 ? statistics_median(bend, m) : 0.0;
    *tolerance = fmin(fmax(1.5 * typical, least), 10.0 * least);
    free(bend);
    return PALP_OK;
}

/* Takes sample i; false, and a new piece from the sample before, if i is not on the line: a corner. */
static bool goes_straight(straight *s, const palp_recording *rec, size_t i) {
    for (int fresh = 0; fresh < 2; fresh++) {
        double t = rec->time_s[i] - rec->time_s[s->from], way = rec->depth_m[i] - rec->depth_m[s->from];
        if (segments_cone_take(&s->cone, t, way, s->tolerance))
            return fresh == 0;
        s->from = i - 1;
        s->cone = segments_cone_open();
    }
    return false;
}

/* The same for the recording's path. Where a force is held, the plate wavers as the force's noise is
 * answered: it goes straight on, in blocks that are long against it; short ones would take the answer to the
 * noise for the specimen's. */
static bool goes_on(straight *s, const palp_recording *rec, size_t i) {
    for (size_t k = 0; k < rec->creep.n; k++) {
        const palp_piece *creep = &rec->creep.piece[k];
        if (i <= creep->first || i > creep->last)
            continue;
        s->from = i == creep->last ? i : creep->first;
        s->cone = segments_cone_open();
        return i != creep->first + 1;
    }
    return goes_straight(s, rec, i);
}

/* A block moves by less than one of so many parts of the way. It lasts less than six of as many parts of the
 * time since the last corner: the force is as good as linear in it. In the air, where it does not count,
 * nothing happens. Even samples meet these limits exactly: which side of them they are on must not be
 * rounding's. */
static bool same_block(const palp_recording *rec, double parts, const unsigned char *counts, size_t first,
                       size_t i, size_t corner, bool pressed) {
    bool late = rec->time_s[i] - rec->time_s[first] >
                (1.0 + 1e-6) * 6.0 / parts * (rec->time_s[first] - rec->time_s[corner]);
    if (counts[i] != counts[first])
        return false;
    if (rec->depth_m[first] <= 0.0 && !counts[first])
        return rec->depth_m[i] <= 0.0 && !(pressed && late);
    return rec->use[i] == rec->use[first] &&
           fabs(rec->depth_m[i] - rec->depth_m[first]) < (1.0 - 1e-6) * rec->deepest_m / parts && !late;
}

palp_status recording_cut(const palp_recording *rec, double parts, const unsigned char *counts, size_t *n,
                          recording_block *block) {
    straight path = {.from = 0, .cone = segments_cone_open()};
    palp_status status = path_tolerance(rec, &path.tolerance);
    if (status)
        return status;
    bool pressed = false;
    *n = 0;
    for (size_t first = 0, end; first < rec->n; first = end) {
        bool corner = false;
        pressed = pressed || rec->depth_m[first] > 0.0;
        size_t from = path.from;
        for (end = first + 1; end < rec->n; end++) {
            corner = !goes_on(&path, rec, end);
            if (corner || !same_block(rec, parts, counts, first, end, from, pressed))
                break;
        }
        if (counts[first])
            block[(*n)++] = (recording_block){first, end, true};
        if (!counts[first] || (corner && end - first > 1))
            block[(*n)++] = (recording_block){end - 1, end, false};
    }
    return PALP_OK;
}

/* The sd of the white noise of n forces, by their second differences; 0 of fewer than three. */
static double scatter_of(size_t n, const double *force) {
    double sum = 0.0;
    for (size_t k = 0; k + 2 < n; k++)
        sum += pow(force[k] - 2.0 * force[k + 1] + force[k + 2], 2.0);
    return n > 2 ? sqrt(sum / (6.0 * (double)(n - 2))) : 0.0;
}

/* Row i of the experiment: the mean of a block's samples, how many they are, the sd of their times, and that
 * of their noise. */
static void take_mean(const palp_recording *rec, const recording_block *block, size_t i,
                      double *const column[6]) {
    const size_t first = block->first;
    double t = 0.0, u = 0.0, f = 0.0, square = 0.0, n = (double)(block->end - first);
    for (size_t k = first; k < block->end; k++) {
        t += rec->time_s[k] - rec->time_s[first];
        u += rec->depth_m[k] - rec->depth_m[first];
        f += rec->force_N[k];
    }
    column[0][i] = rec->time_s[first] + t / n;
    column[1][i] = 1e3 * (rec->depth_m[first] + u / n); /* in a dwell, of every block the same to the bit */
    column[2][i] = f / n;
    column[3][i] = block->counts ? n : 0.0;
    for (size_t k = first; k < block->end; k++)
        square += pow(rec->time_s[k] - rec->time_s[first] - t / n, 2.0);
    column[4][i] = sqrt(square / n);
    column[5][i] = block->counts ? scatter_of(block->end - first, rec->force_N + first) : 0.0;
}

palp_status palp_recording_blocks(const palp_recording *rec, double parts, palp_experiment **blocks) {
    if (!rec || !blocks || !(parts >= 10.0))
        return PALP_ERR_ARGUMENT;
    recording_block *block = malloc(rec->n * sizeof *block);
    unsigned char *counts = malloc(rec->n);
    size_t n = 0;
    palp_experiment *e = NULL;
    static const char *const name[] = {"time_s", "depth_mm", "force_N", "samples", "time_sd_s", "noise_N"};
    palp_status status = block && counts ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < rec->n && !status; i++) /* a withdrawal counts here */
        counts[i] = rec->use[i] || rec->time_s[i] >= rec->end_s;
    if (!status)
        status = recording_cut(rec, parts, counts, &n, block);
    const size_t before = rec->depth_m[0] > 0.0; /* a row of the air, where the recording begins under load */
    if (!status)
        status = palp_experiment_create(n + before, &e);
    double *column[6];
    for (int c = 3; c < 6 && !status; c++)
        status = palp_experiment_add_column(e, name[c]);
    if (!status) {
        for (int c = 0; c < 6; c++)
            column[c] = palp_experiment_column(e, name[c]);
        for (size_t i = 0; i < n; i++)
            take_mean(rec, &block[i], i + before, column);
        if (before)
            column[0][0] = rec->time_s[0] - (rec->n > 1 ? rec->time_s[1] - rec->time_s[0] : 1.0);
    }
    free(block);
    free(counts);
    if (status)
        palp_experiment_free(e);
    else
        *blocks = e;
    return status;
}
