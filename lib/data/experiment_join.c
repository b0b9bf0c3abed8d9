/* experiment_join.c: joins a recording with its continuation under load in another file. They are one run,
 * since the history of the arms begins in the first. */
#include "experiment_internal.h"
#include "segments_internal.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_MIN = 16 };       /* in each of both parts */
static const double SOON = 10.0; /* clock steps between the parts; after more it is another recording */
static const double LOADED =
    0.1; /* relative to the largest force: below it the earlier history is nearly forgotten */
static const double AWAY =
    2e-3; /* relative to the travel: allowed distance from where the plate's motion leads */
static const double ODDS = 6.0; /* standard deviations of the noise */

typedef struct columns {
    size_t n;
    const double *time, *depth, *force;
    double peak, low, high, white; /* largest force, range of depth, sd of the noise */
} columns;

static columns take_needed_columns(const palp_experiment *e) {
    return (columns){.n = palp_experiment_rows(e),
                     .time = palp_experiment_column(e, "time_s"),
                     .low = HUGE_VAL,
                     .high = -HUGE_VAL,
                     .depth = palp_experiment_column(e, "depth_mm"),
                     .force = palp_experiment_column(e, "force_N")};
}

/* False if the columns cannot be used, which is reported later. */
static bool measure_column_ranges(columns *c) {
    for (size_t i = 0; i < c->n; i++) {
        if (!segments_sample_valid(c->time, c->depth, c->force, i))
            return false;
        c->peak = fmax(c->peak, c->force[i]);
        c->low = fmin(c->low, c->depth[i]);
        c->high = fmax(c->high, c->depth[i]);
    }
    double step = (c->time[c->n - 1] - c->time[0]) / (double)(c->n - 1);
    return palp_segments_noise(c->n, c->time, step, c->force, PALP_NOISE_MEDIAN, &c->white) == PALP_OK;
}

/* Does b begin where and when a ends, with the same force? */
static bool continues_time_and_force(columns *a, columns *b) {
    const size_t last = a->n - 1;
    if (fmin((double)a->n, (double)b->n) < SAMPLES_MIN || !a->time || !a->depth || !a->force || !b->time ||
        !b->depth || !b->force)
        return false;
    double step = (a->time[last] - a->time[0]) / (double)last, gap = b->time[0] - a->time[last];
    if (!(gap > 0.0 && gap < SOON * step && measure_column_ranges(a) && measure_column_ranges(b)))
        return false;
    double force = a->force[last], next = b->force[0], noise = fmax(a->white, b->white),
           peak = fmax(a->peak, b->peak);
    if (!(fmin(force, next) > LOADED * peak + ODDS * noise))
        return false;
    double speed = (a->depth[last] - a->depth[last - 2]) / (a->time[last] - a->time[last - 2]);
    double way = b->depth[0] - a->depth[last], range = fmax(a->high, b->high) - fmin(a->low, b->low);
    double moves = fmax(fabs(force - a->force[last - 3]), fabs(b->force[3] - next)) * fmax(1.0, gap / step);
    return fabs(way - speed * gap) < fabs(speed) * gap + AWAY * range &&
           fabs(next - force) < moves + ODDS * noise;
}

static const char *specimen_name_of(const palp_experiment *e) {
    const char *name;
    return palp_experiment_get_string(e, "specimen.name", &name) ? "" : name;
}

static bool continues_same_specimen(const palp_experiment *first, const palp_experiment *second) {
    if (first == second || strcmp(specimen_name_of(first), specimen_name_of(second)) != 0)
        return false;
    columns a = take_needed_columns(first), b = take_needed_columns(second);
    return continues_time_and_force(&a, &b);
}

/* Copies the keys of the first part, and how the second one ended. */
static palp_status copy_header_keys(const palp_experiment *a, const palp_experiment *b, palp_experiment *to) {
    const palp_experiment *const from[] = {a, b};
    const char *key;
    json_t *value;
    for (size_t i = 0; i < 2; i++)
        json_object_foreach(
            from[i]->header, key,
            value) if ((strncmp(key, "end.", 4) == 0) == (i == 1) &&
                       json_object_set_new(to->header, key, json_deep_copy(value))) return PALP_ERR_NO_MEMORY;
    return PALP_OK;
}

static palp_status fill_joined_experiment(const palp_experiment *a, const palp_experiment *b,
                                          palp_experiment *to) {
    palp_status status = copy_header_keys(a, b, to);
    for (size_t c = 0; c < a->n_columns && !status; c++) {
        const char *name = a->columns[c].name;
        const double *second = palp_experiment_column(b, name);
        if (!second)
            continue;
        if (!palp_experiment_column(to, name))
            status = palp_experiment_add_column(to, name);
        if (status)
            break;
        double *values = palp_experiment_column(to, name);
        memcpy(values, a->columns[c].values, a->rows * sizeof *values);
        memcpy(values + a->rows, second, b->rows * sizeof *values);
    }
    return status;
}

static palp_status join_two_experiments(const palp_experiment *first, const palp_experiment *second,
                                        palp_experiment **both) {
    palp_status status = palp_experiment_create(first->rows + second->rows, both);
    if (!status)
        status = fill_joined_experiment(first, second, *both);
    if (status) {
        palp_experiment_free(*both);
        *both = NULL;
    }
    return status;
}

/* Joins the recordings that begin with run j to the first one that they continue; *done: there is one. */
static palp_status join_to_one_before(size_t n, const palp_experiment *const *run, palp_experiment **whole,
                                      size_t *of, size_t j, bool *done) {
    const palp_experiment *second = whole[j] ? whole[j] : run[j];
    *done = false;
    for (size_t i = 0; i < n && of[j] == j; i++) {
        const palp_experiment *first = whole[i] ? whole[i] : run[i];
        palp_experiment *both;
        if (of[i] != i || !continues_same_specimen(first, second))
            continue;
        palp_status status = join_two_experiments(first, second, &both);
        if (status)
            return status;
        palp_experiment_free(whole[i]);
        palp_experiment_free(whole[j]);
        whole[i] = both;
        whole[j] = NULL;
        for (size_t k = 0; k < n; k++)
            of[k] = of[k] == j ? i : of[k];
        *done = true;
    }
    return PALP_OK;
}

palp_status palp_experiment_join(size_t n, const palp_experiment *const *run, palp_experiment **whole,
                                 size_t *of) {
    palp_status status = run && whole && of ? PALP_OK : PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n && !status; i++) {
        status = run[i] ? PALP_OK : PALP_ERR_ARGUMENT;
        whole[i] = NULL;
        of[i] = i;
    }
    bool done = false;
    for (size_t j = 0; j < n && !status; j = done ? 0 : j + 1)
        status = join_to_one_before(n, run, whole, of, j, &done);
    for (size_t i = 0; i < n && status == PALP_ERR_NO_MEMORY; i++) {
        palp_experiment_free(whole[i]);
        whole[i] = NULL;
    }
    return status;
}
