/* explain_join.c: a recording that goes on in another file, under load: one run again, as what its arms remember is in the first. */
#include "explain_data.h"
#include "data/segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SOON = 10.0;  /* steps of the clock, after which it is another recording */
static const double LOADED = 0.1; /* of the largest force: with less the one before is forgotten, or nearly so */
static const double AWAY = 2e-3;  /* of the way: where the plate may be beside where its motion leads */
static const double ODDS = 6.0;   /* standard deviations of the noise */

typedef struct columns {
    size_t n;
    const double *time, *depth, *force;
    double peak, low, high, white; /* largest force, ends of the depth, sd of the noise */
} columns;

static columns columns_of(const palp_experiment *e) {
    return (columns){.n = palp_experiment_rows(e), .time = palp_experiment_column(e, "time_s"), .low = HUGE_VAL,
                     .high = -HUGE_VAL, .depth = palp_experiment_column(e, "depth_mm"),
                     .force = palp_experiment_column(e, "force_N")};
}

/* False: they cannot be used; that is told later. */
static bool measure(columns *c) {
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

/* Whether b begins where and when a ends, with its force. */
static bool continues(columns *a, columns *b) {
    const size_t last = a->n - 1;
    if (fmin((double)a->n, (double)b->n) < EXPLAIN_SAMPLES_MIN || !a->time || !a->depth || !a->force || !b->time || !b->depth || !b->force)
        return false;
    double step = (a->time[last] - a->time[0]) / (double)last, gap = b->time[0] - a->time[last];
    if (!(gap > 0.0 && gap < SOON * step && measure(a) && measure(b)))
        return false;
    double force = a->force[last], next = b->force[0], noise = fmax(a->white, b->white), peak = fmax(a->peak, b->peak);
    if (!(fmin(force, next) > LOADED * peak + ODDS * noise))
        return false;
    double speed = (a->depth[last] - a->depth[last - 2]) / (a->time[last] - a->time[last - 2]);
    double way = b->depth[0] - a->depth[last], range = fmax(a->high, b->high) - fmin(a->low, b->low);
    double moves = fmax(fabs(force - a->force[last - 3]), fabs(b->force[3] - next)) * fmax(1.0, gap / step);
    return fabs(way - speed * gap) < fabs(speed) * gap + AWAY * range && fabs(next - force) < moves + ODDS * noise;
}

/* The keys that are read of a run. */
static palp_status copy_keys(const palp_experiment *from, palp_experiment *to) {
    static const char *const texts[] = {"specimen.name", "specimen.kind"},
                             *const numbers[] = {"specimen.height_mm", "session.start_s", "contact.sd_mm"};
    palp_status status = PALP_OK;
    for (size_t i = 0; i < sizeof texts / sizeof *texts && !status; i++)
        if (*explain_text_of(from, texts[i]))
            status = palp_experiment_set_string(to, texts[i], explain_text_of(from, texts[i]));
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && !status; i++)
        if (isfinite(explain_number_of(from, numbers[i], NAN)))
            status = palp_experiment_set_number(to, numbers[i], explain_number_of(from, numbers[i], NAN));
    return status;
}

/* a and then b, with the columns that both have. */
static palp_status put_together(const palp_experiment *a, const palp_experiment *b, palp_experiment **both) {
    const size_t n = palp_experiment_rows(a), m = palp_experiment_rows(b);
    palp_status status = palp_experiment_create(n + m, both);
    if (!status)
        status = copy_keys(a, *both);
    for (size_t c = 0; c < palp_experiment_column_count(a) && !status; c++) {
        const char *name = palp_experiment_column_name(a, c);
        const double *second = palp_experiment_column(b, name);
        if (!second)
            continue;
        if (!palp_experiment_column(*both, name))
            status = palp_experiment_add_column(*both, name);
        double *to = palp_experiment_column(*both, name);
        if (status)
            break;
        memcpy(to, palp_experiment_column(a, name), n * sizeof *to);
        memcpy(to + n, second, m * sizeof *to);
    }
    return status;
}

/* The first run among these that j continues; n: none. */
static size_t before(size_t n, const palp_explain_input *run, size_t j) {
    for (size_t i = 0; i < n; i++) {
        columns a = columns_of(run[i].experiment), b = columns_of(run[j].experiment);
        if (i != j && explain_same_specimen(run[i].experiment, run[j].experiment) && continues(&a, &b))
            return i;
    }
    return n;
}

/* Run j goes on at the end of run i. */
static palp_status append(explain_joined *joined, size_t n, size_t i, size_t j) {
    palp_experiment *both = NULL;
    palp_status status = put_together(joined->input[i].experiment, joined->input[j].experiment, &both);
    if (status) {
        palp_experiment_free(both);
        return status;
    }
    palp_experiment_free(joined->made[i]);
    palp_experiment_free(joined->made[j]);
    joined->made[i] = both;
    joined->input[i].experiment = both;
    joined->n--;
    for (size_t k = j; k < joined->n; k++) {
        joined->input[k] = joined->input[k + 1];
        joined->made[k] = joined->made[k + 1];
    }
    joined->made[joined->n] = NULL;
    for (size_t k = 0; k < n; k++) {
        joined->of[k] = joined->of[k] == j ? i : joined->of[k];
        joined->of[k] -= joined->of[k] > j;
    }
    return PALP_OK;
}

palp_status explain_join(size_t n, const palp_explain_input *inputs, explain_joined *joined) {
    *joined = (explain_joined){.n = n, .input = malloc(n * sizeof *joined->input), .of = malloc(n * sizeof *joined->of),
                               .made = calloc(n, sizeof *joined->made)};
    if (!joined->input || !joined->of || !joined->made)
        return PALP_ERR_NO_MEMORY;
    memcpy(joined->input, inputs, n * sizeof *inputs);
    for (size_t i = 0; i < n; i++)
        joined->of[i] = i;
    palp_status status = PALP_OK;
    for (size_t j = 0; j < joined->n && !status;) {
        size_t i = before(joined->n, joined->input, j);
        if (i < joined->n)
            status = append(joined, n, i, j);
        j = i < joined->n ? 0 : j + 1;
    }
    return status;
}

void explain_joined_free(explain_joined *joined) {
    for (size_t i = 0; joined->made && i < joined->n; i++)
        palp_experiment_free(joined->made[i]);
    free(joined->made);
    free(joined->input);
    free(joined->of);
    *joined = (explain_joined){0};
}
