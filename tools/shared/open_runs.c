/* open_runs.c: runs for one fit of all: every so-many-th sample, picked, not averaged, so that what is fast
 * keeps its size; and the samples between them where the path bends. */
#include "opening.h"

#include "cli.h"

#include <math.h>
#include <palpate/segments.h>
#include <stdlib.h>

static const char *const NUMBERS[] = {"specimen.height_mm", "specimen.radius_mm", "session.start_s",
                                      "protocol.order",     "protocol.repeat",    "protocol.depth_mm",
                                      "protocol.rate_mm_s", "protocol.ramp_s",    "protocol.hold_s",
                                      "protocol.cycles",    "contact.sd_mm"};
static const char *const TEXTS[] = {"specimen.kind", "specimen.name", "protocol.kind", "contact.rule",
                                    "end.fault"};

static palp_status copy_keys(const palp_experiment *from, palp_experiment *to) {
    palp_status status = PALP_OK;
    double number;
    const char *text;
    for (size_t i = 0; i < sizeof NUMBERS / sizeof NUMBERS[0] && !status; i++)
        if (!palp_experiment_get_number(from, NUMBERS[i], &number))
            status = palp_experiment_set_number(to, NUMBERS[i], number);
    for (size_t i = 0; i < sizeof TEXTS / sizeof TEXTS[0] && !status; i++)
        if (!palp_experiment_get_string(from, TEXTS[i], &text))
            status = palp_experiment_set_string(to, TEXTS[i], text);
    return status;
}

/* A run's columns, and which of its samples are picked. */
typedef struct picking {
    size_t n;
    const double *time, *depth, *force;
    unsigned char *picked; /* [n] */
} picking;

/* Between two picked samples, the one that is farthest from the straight path, if by more than this, mm; then
 * between these, and so on. Returns how many. */
static size_t pick_bends(picking *p, size_t from, size_t to, double tolerance) {
    size_t count = 0;
    for (size_t far = from; from + 1 < to; far = from) {
        const double rate = (p->depth[to] - p->depth[from]) / (p->time[to] - p->time[from]);
        double most = tolerance;
        for (size_t i = from + 1; i < to; i++) {
            const double off = fabs(p->depth[i] - p->depth[from] - rate * (p->time[i] - p->time[from]));
            far = off > most ? i : far;
            most = fmax(most, off);
        }
        if (far == from)
            break;
        p->picked[far] = 1;
        const bool first = far - from < to - far; /* the shorter part, so that calls stay few */
        count += 1 + (first ? pick_bends(p, from, far, tolerance) : pick_bends(p, far, to, tolerance));
        from = first ? far : from;
        to = first ? to : far;
    }
    return count;
}

/* The deviation of a path that does not matter, mm. It changes the force by a tenth of a sample's noise at
 * most: a hundred corners then gain less than one nat of evidence. Noise of the path is no bend, and neither
 * is its rounding, at most the smallest step. */
static palp_status find_tolerance(const picking *p, double *tolerance) {
    const double step = (p->time[p->n - 1] - p->time[0]) / (double)p->n;
    double force = 0.0, path = 0.0, deepest = 0.0, peak = 0.0, rounding = HUGE_VAL;
    palp_status status = palp_segments_noise(p->n, p->time, step, p->force, PALP_NOISE_MEDIAN, &force);
    if (!status)
        status = palp_segments_noise(p->n, p->time, step, p->depth, PALP_NOISE_MEDIAN, &path);
    for (size_t i = 0; i < p->n; i++) {
        const double moved = i > 0 ? fabs(p->depth[i] - p->depth[i - 1]) : 0.0;
        rounding = moved > 0.0 ? fmin(rounding, moved) : rounding;
        deepest = fmax(deepest, fabs(p->depth[i]));
        peak = fmax(peak, fabs(p->force[i]));
    }
    *tolerance = fmax(0.1 * force / fmax(peak, 1e-300), 1e-6) * deepest;
    *tolerance = fmax(*tolerance, fmax(5.0 * path, 1.001 * fmin(rounding, deepest)));
    return status;
}

/* Picks one sample in every, and bends between them, at most as many again. Returns how many. */
static palp_status pick(picking *p, size_t every, size_t *rows) {
    const size_t regular = (p->n + every - 1) / every;
    double tolerance;
    palp_status status = find_tolerance(p, &tolerance);
    for (*rows = SIZE_MAX; !status && *rows > 2 * regular; tolerance *= 2.0) {
        *rows = regular;
        for (size_t i = 0; i < p->n; i++)
            p->picked[i] = i % every == 0;
        for (size_t i = 0; i + every < p->n; i += every)
            *rows += pick_bends(p, i, i + every, tolerance);
    }
    return status;
}

static palp_status thin(palp_experiment **run, size_t every) {
    static const char *const columns[] = {"time_s", "depth_mm", "force_N"};
    palp_experiment *fewer = NULL;
    picking p = {.n = palp_experiment_rows(*run),
                 .time = palp_experiment_column(*run, columns[0]),
                 .depth = palp_experiment_column(*run, columns[1]),
                 .force = palp_experiment_column(*run, columns[2]),
                 .picked = calloc(palp_experiment_rows(*run) + 1, 1)};
    size_t rows = 0;
    palp_status status = p.picked ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && p.n > 0)
        status = pick(&p, every, &rows);
    status = status ? status : palp_experiment_create(rows, &fewer);
    status = status ? status : copy_keys(*run, fewer);
    for (size_t c = 0; c < 3 && !status; c++) {
        const double *from = palp_experiment_column(*run, columns[c]);
        double *to = palp_experiment_column(fewer, columns[c]);
        for (size_t i = 0, k = 0; i < p.n; i++)
            if (p.picked[i])
                to[k++] = from[i];
    }
    free(p.picked);
    if (status) {
        palp_experiment_free(fewer);
        return status;
    }
    palp_experiment_free(*run);
    *run = fewer;
    return PALP_OK;
}

int open_runs(const char *command, size_t n, const char *const *files, size_t every, palp_experiment **run,
              palp_explain_input *input) {
    enum { ROWS = 20000 };
    size_t rows = 0;
    for (size_t r = 0; r < n; r++) {
        int code = open_run(command, files[r], &run[r]);
        if (code)
            return code;
        rows += palp_experiment_rows(run[r]);
    }
    const size_t picked = every ? every : 1 + rows / ROWS;
    for (size_t r = 0; r < n; r++) {
        palp_status status = picked > 1 ? thin(&run[r], picked) : PALP_OK;
        if (status)
            return cli_status_of(command, files[r], status, NULL);
        input[r] = (palp_explain_input){run[r], files[r]};
    }
    if (picked > 1 && !every)
        cli_note(command, "one sample in %zu of each run is taken, and those between where its path bends",
                 picked);
    return CLI_OK;
}
