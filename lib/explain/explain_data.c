/* explain_data.c: experiments into the runs that are explained: masks, phases, replicates. */
#include "explain_data.h"
#include "base/file.h"
#include "base/statistics.h"
#include "data/segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SPIKE_SIGMA = 8.0;

palp_forward_run explain_forward_run(const explain_run *run, double contact, explain_history *history) {
    if (run->fresh || history->renewed)
        palp_load_history_free(&history->load);
    history->load.peak_p = history->slope;
    return (palp_forward_run){.n = run->n,
                              .time_s = run->time,
                              .depth_m = run->depth,
                              .session_s = run->session,
                              .n_columns = run->n_columns,
                              .column = run->column,
                              .history = &history->load,
                              .contact_m = contact,
                              .added_N = run->added};
}

palp_status explain_event_add(explain_data *data, const palp_explain_event *event) {
    palp_explain_event *grown = realloc(data->event, (data->n_events + 1) * sizeof *grown);
    if (!grown)
        return PALP_ERR_NO_MEMORY;
    data->event = grown;
    grown[data->n_events] = *event;
    grown[data->n_events].from_s += data->run[event->run].start;
    grown[data->n_events++].to_s += data->run[event->run].start;
    return PALP_OK;
}

double explain_threshold(double false_alarm) {
    return log(1.0 / false_alarm - 1.0);
}

/* ---- samples ---- */

/* Columns that effects read besides depth and force; a column with a lost number is left out. */
static void find_columns(const palp_experiment *e, explain_run *run) {
    for (int id = 0; id < PALP_EFFECT_COUNT; id++) {
        const char *name = palp_effect_look_up((palp_effect_id)id)->column;
        const double *value = name ? palp_experiment_column(e, name) : NULL;
        size_t finite = 0;
        while (value && finite < run->n && isfinite(value[finite]))
            finite++;
        for (size_t c = 0; value && c < run->n_columns; c++)
            value = strcmp(run->column[c].name, name) == 0 ? NULL : value; /* two effects may read it */
        if (value && finite == run->n)
            run->column[run->n_columns++] = (palp_forward_column){name, value};
    }
}

/* height: of the specimen; a run in air has none. */
static palp_status copy(const palp_experiment *e, double height, bool air, explain_run *run) {
    const double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
                 *force = palp_experiment_column(e, "force_N");
    run->n = palp_experiment_rows(e);
    double *block = malloc(4 * run->n * sizeof *block);
    run->time = block;
    run->use = malloc(2 * run->n);
    if (!block || !run->use)
        return PALP_ERR_NO_MEMORY;
    run->depth = block + run->n;
    run->force = block + 2 * run->n;
    run->stood = block + 3 * run->n;
    run->phase = run->use + run->n;
    run->samples = palp_experiment_column(e, "samples");
    run->spread = run->samples ? palp_experiment_column(e, "time_sd_s") : NULL;
    run->noise = run->samples ? palp_experiment_column(e, "noise_N") : NULL;
    for (size_t i = 0; i < run->n; i++)
        run->use[i] = !run->samples || run->samples[i] > 0.0;
    run->start = time[0];
    double deepest = -HUGE_VAL, noise;
    for (size_t i = 0; i < run->n; i++) {
        run->time[i] = time[i] - time[0];
        run->depth[i] = 1e-3 * depth[i];
        run->force[i] = force[i];
    }
    palp_status status =
        run->samples ? PALP_OK : palp_segments_smooth_path(run->n, run->time, run->depth, &noise);
    if (status)
        return status;
    for (size_t i = 0; i < run->n; i++)
        deepest = fmax(deepest, run->depth[i]);
    find_columns(e, run);
    for (size_t i = 0; air && i < run->n; i++)
        run->depth[i] -= fmax(0.0, deepest) + height;
    return PALP_OK;
}

/* Lone samples far from both neighbours are events. */
static palp_status mask_spikes(explain_data *data, size_t r) {
    explain_run *run = &data->run[r];
    palp_status status = explain_white_noise(run, run->force);
    if (status || run->samples) /* of means, samples are masked before */
        return status;
    segments_mask_spikes(run->n, run->force, run->white, SPIKE_SIGMA, run->use);
    for (size_t i = 1; i + 1 < run->n && !status; i++)
        if (!run->use[i])
            status = explain_event_add(
                data,
                &(palp_explain_event){.run = r,
                                      .samples = 1,
                                      .from_s = run->time[i],
                                      .to_s = run->time[i],
                                      .size_N = run->force[i] - 0.5 * (run->force[i - 1] + run->force[i + 1]),
                                      .kind = "spike"});
    return status;
}

/* The run's force where the plate is farthest away: the median of a few samples; 0 if that is not above the
 * surface. */
static double zero_of(const explain_run *run) {
    enum { FEW = 5 };
    double force[FEW];
    size_t away = 0, n = 0;
    for (size_t i = 1; i < run->n; i++)
        away = run->depth[i] <= run->depth[away] ? i : away;
    const size_t first = away < FEW / 2 ? 0 : away - FEW / 2;
    for (size_t k = first; k < run->n && n < FEW; k++)
        force[n++] = run->force[k];
    return run->depth[away] <= 0.0 && n > 0 ? statistics_median(force, n) : 0.0;
}

/* Where a plate that sticks lets go, the force jumps. The jump's time is not known to a sample, so samples
 * around it do not count: a part of the pull before it, and as much after. The run's zero is no pull. */
static palp_status mask_releases(explain_data *data, size_t r) {
    explain_run *run = &data->run[r];
    palp_status status = PALP_OK;
    const double zero = zero_of(run);
    for (size_t i = 1; i + 1 < run->n && !status; i++) {
        double jump = run->force[i + 1] - run->force[i], pull = zero - run->force[i];
        const bool alone =
            fabs(run->force[i - 1] - zero) < 0.5 * pull; /* a sample that is odd, of noise with heavy tails */
        if (alone || !(pull > 12.0 * run->white && jump > 0.5 * pull && run->depth[i + 1] <= run->depth[i]))
            continue;
        size_t start = i, reach, end = i + 1;
        while (start > 0 && run->force[start] < zero)
            start--;
        reach = (i - start) / 5 + 3;
        for (size_t k = i > reach ? i - reach : 0; k <= i + reach && k < run->n; end = ++k)
            run->use[k] = 0;
        double next =
            pull + fmax(0.0, run->force[i - 1] - run->force[i]); /* it let go before the next sample */
        data->pull_most = data->n_releases ? fmin(data->pull_most, next) : next;
        data->pull = fmax(data->pull, pull);
        data->n_releases++;
        status = explain_event_add(data, &(palp_explain_event){.run = r,
                                                               .samples = end - start,
                                                               .from_s = run->time[i],
                                                               .to_s = run->time[i + 1],
                                                               .size_N = jump,
                                                               .kind = "release"});
        i = end;
    }
    return status;
}

/* The strongest pull after the largest force, by means of three samples, relative to the force where the
 * plate is farthest away. It is at least the size that noise hides; 0 if the plate does not withdraw so
 * far. */
static void find_pull(explain_data *data, const explain_run *run) {
    size_t most = 1;
    double pull = -HUGE_VAL, least = HUGE_VAL;
    for (size_t i = 1; i + 1 < run->n; i++)
        most = run->force[i] > run->force[most] ? i : most;
    const double zero = zero_of(run), peak = run->force[most] - zero, noise = run->white / sqrt(3.0);
    for (size_t i = most + 1; i + 1 < run->n; i++) {
        const double mean = (run->force[i - 1] + run->force[i] + run->force[i + 1]) / 3.0 - zero;
        pull = fmax(pull, -mean);
        least = fmin(least, mean);
    }
    if (peak > 20.0 * noise && least < 0.01 * peak + 3.0 * noise)
        data->pulled = fmax(data->pulled, fmax(pull, 2.0 * noise));
}

/* Whether the plate had the same path in both, to a hundredth of the deepest. */
static bool same_path(const explain_data *data, const explain_run *a, const explain_run *b) {
    enum { PLACES = 64 };
    double last = a->time[a->n - 1] - a->time[0], other = b->time[b->n - 1] - b->time[0];
    if (fabs(last - other) > 0.01 * last)
        return false;
    for (size_t k = 0, i = 0, j = 0; k <= PLACES; k++) {
        double at = fmin(last, other) * (double)k / PLACES;
        while (i + 1 < a->n && a->time[i] - a->time[0] < at)
            i++;
        while (j + 1 < b->n && b->time[j] - b->time[0] < at)
            j++;
        double step = fabs(a->depth[i] - a->depth[i ? i - 1 : 0]);
        if (fabs(a->depth[i] - b->depth[j]) > 0.01 * data->deepest + step)
            return false;
    }
    return true;
}

/* How long the session was. A run without a start time began with the first. If the clock's zero is long
 * before the first run, the session begins with that run. */
static void find_span(explain_data *data) {
    const double ages = 1e3;
    double first = HUGE_VAL, last = 0.0;
    for (size_t r = 0; r < data->n_runs; r++)
        first = fmin(first, data->run[r].session); /* but NAN */
    first = isfinite(first) ? first : 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        explain_run *run = &data->run[r];
        run->session = isnan(run->session) ? first : run->session;
        last = fmax(last, run->session - first + run->time[run->n - 1]);
    }
    data->span = last;
    for (size_t r = 0; r < data->n_runs && fabs(first) > ages * last; r++)
        data->run[r].session -= first;
}

/* The time of a run of means over the number of their samples. */
static double mean_step(const explain_run *run) {
    double count = 0.0;
    for (size_t i = 0; i < run->n; i++)
        count += run->samples[i];
    return (run->time[run->n - 1] - run->time[0]) / count;
}

/* The median over the means of three samples and more: outliers in some do not count. */
static palp_status find_sample_noise(explain_data *data) {
    size_t m = 0;
    double *noise = malloc(data->n * sizeof *noise);
    if (!noise)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < data->n_runs; r++)
        for (size_t i = 0; i < data->run[r].n && data->run[r].noise; i++)
            if (data->run[r].samples[i] > 2.0)
                noise[m++] = data->run[r].noise[i];
    data->sample_noise = m > 0 ? fmax(EXPLAIN_EXACT * data->peak, statistics_median(noise, m)) : 0.0;
    free(noise);
    return PALP_OK;
}

/* The typical time between samples, the largest speed, and the slowest run's way from one sample to the
 * next. */
static palp_status find_pace(explain_data *data) {
    double *step = malloc(data->longest * sizeof *step);
    if (!step)
        return PALP_ERR_NO_MEMORY;
    data->step = data->stride = HUGE_VAL;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        double stride = 0.0;
        for (size_t i = 0; i + 1 < run->n; i++) {
            double moved = fabs(run->depth[i + 1] - run->depth[i]);
            step[i] = run->time[i + 1] - run->time[i];
            stride = fmax(stride, moved);
            data->fastest = fmax(data->fastest, moved / step[i]);
        }
        data->stride = fmin(data->stride, stride);
        data->step = fmin(data->step, run->samples ? mean_step(run) : statistics_median(step, run->n - 1));
    }
    find_span(data);
    free(step);
    return PALP_OK;
}

/* Of the runs that are fitted and press one. */
static void count_specimens(explain_data *data) {
    size_t last = data->n_runs;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        double deepest = 0.0;
        for (size_t i = 0; i < run->n; i++)
            deepest = fmax(deepest, run->depth[i]);
        if (run->held_out || !(deepest > 0.0) || (data->n_specimens > 0 && run->specimen == last))
            continue;
        data->n_specimens++;
        last = run->specimen;
    }
}

static void count_replicates(explain_data *data) {
    for (size_t r = 1; r < data->n_runs; r++) {
        bool found = false;
        for (size_t s = 0; s < r && !found; s++)
            found = !data->run[r].held_out && !data->run[s].held_out &&
                    same_path(data, &data->run[r], &data->run[s]);
        data->n_replicates += found;
    }
}

static void take_contact(explain_data *data, double sd) {
    const double n = (double)data->n_contact_told, sum = n * data->contact_told * data->contact_told;
    if (!(sd > 0.0 && isfinite(sd)))
        return;
    data->contact_told = sqrt((sum + sd * sd) / (n + 1.0));
    data->n_contact_told++;
}

/* Whether it begins in the middle of a press whose first part is in no file. The state of the arms is not
 * known then. The run's own zero and gain absorb a smaller part. */
static bool begins_under_load(const explain_run *run) {
    const double part = 0.25; /* of the run's largest depth and force */
    double deepest = 0.0, peak = 0.0;
    for (size_t i = 0; i < run->n; i++) {
        deepest = fmax(deepest, run->depth[i]);
        peak = fmax(peak, run->force[i]);
    }
    return run->depth[0] > part * deepest && run->force[0] > part * peak;
}

/* Whether it presses at all, by its own depths. A run above nominal contact shows the instrument alone. */
static bool goes_below_contact(const explain_run *run) {
    for (size_t i = 0; i < run->n; i++)
        if (run->depth[i] > 0.0)
            return true;
    return false;
}

static palp_status take_run(explain_data *data, size_t r, const palp_explain_input *input, bool air,
                            palp_error *error) {
    const palp_experiment *e = input->experiment;
    explain_run *run = &data->run[r];
    snprintf(run->name, sizeof run->name, "%s", input->name ? input->name : "run");
    palp_text_make_plain(run->name);
    run->height = 1e-3 * explain_number_of(e, "specimen.height_mm", 1e3 * data->height);
    if (!(run->height > 0.0))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: a specimen of %g mm, the model's has %g mm",
                              run->name, 1e3 * run->height, 1e3 * data->height);
    const double radius = 1e-3 * explain_number_of(e, "specimen.radius_mm", 1e3 * data->given->radius_m);
    run->area = radius > 0.0 && data->given->radius_m > 0.0 ? pow(radius / data->given->radius_m, 2.0) : 1.0;
    palp_status status = copy(e, run->height, air, run);
    if (status)
        return status;
    if (!air && begins_under_load(run))
        return palp_error_set(error, PALP_ERR_INPUT,
                              "%s: begins under load (%.3g N at %.3g mm), and no other file ends there: what "
                              "was pressed before is "
                              "missing. Give that recording too, or leave this one out",
                              run->name, run->force[0], 1e3 * run->depth[0]);
    status = goes_below_contact(run) ? palp_recording_check(e, run->name, run->height, error) : PALP_OK;
    if (status)
        return status;
    run->session = explain_number_of(e, "session.start_s", NAN);
    take_contact(data, 1e-3 * explain_number_of(e, "contact.sd_mm", 0.0));
    status = segments_phases(run->n, run->time, run->depth, run->force, run->phase, run->stood);
    if (status)
        return status;
    palp_status masked = mask_spikes(data, r);
    find_pull(data, run);
    return masked ? masked : mask_releases(data, r);
}

/* The largest strain that earlier runs have pressed each specimen to. */
static void find_largest_strains(explain_data *data) {
    double largest = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        explain_run *run = &data->run[r];
        run->largest_strain = largest = run->fresh ? 0.0 : largest;
        for (size_t i = 0; i < run->n; i++)
            largest = fmax(largest, run->depth[i] / run->height);
    }
}

/* In the order in which they were made; those on a block are left out. */
static palp_status take_runs(explain_data *data, size_t n, const palp_explain_input *inputs,
                             const palp_explain_settings *settings, palp_error *error) {
    size_t *order = malloc(n * sizeof *order);
    bool *fresh = malloc(n * sizeof *fresh);
    palp_status status = order && fresh ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status)
        explain_order_find(n, inputs, order, fresh);
    bool renewed = false;
    size_t specimen = 0;
    for (size_t i = 0; i < n && !status; i++) {
        const size_t of = order[i];
        renewed = renewed || fresh[i];
        specimen += i > 0 && !explain_same_specimen(inputs[order[i - 1]].experiment, inputs[of].experiment);
        if (data->pressed[of].object == PALP_EXPLAIN_BLOCK)
            continue;
        explain_run *run = &data->run[data->n_runs++];
        run->fresh = renewed;
        run->specimen = specimen;
        run->input = data->joined.first[of];
        renewed = false;
        for (size_t k = 0; k < settings->n_held_out; k++)
            run->held_out = run->held_out || data->joined.of[settings->held_out[k]] == data->joined.first[of];
        status = take_run(data, data->n_runs - 1, &inputs[of], data->pressed[of].object == PALP_EXPLAIN_AIR,
                          error);
    }
    free(order);
    free(fresh);
    return status;
}

/* Sorts the inputs, and takes the runs of the specimen and those in air. */
static palp_status take_inputs(explain_data *data, size_t n, const palp_explain_input *inputs,
                               const palp_explain_settings *settings, palp_error *error) {
    data->pressed = calloc(n, sizeof *data->pressed);
    palp_status status =
        data->pressed ? explain_find_pressed(n, inputs, data->pressed, error) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = explain_block_measure(n, inputs, data->pressed, &data->frame, error);
    if (!status)
        status = take_runs(data, n, inputs, settings, error);
    if (!status && explain_fitted_runs(data) == 0)
        status = palp_error_set(
            error, PALP_ERR_INPUT,
            "%s: no run is left in which the specimen is pressed: a rigid block shows the frame alone",
            inputs[0].name ? inputs[0].name : "run");
    return status;
}

palp_status explain_data_create(size_t n, const palp_explain_input *inputs,
                                const palp_explain_settings *settings, const palp_model *model,
                                explain_data *data, palp_error *error) {
    *data = (explain_data){.given = model,
                           .simulated = settings->simulated != NULL,
                           .threshold = explain_threshold(settings->false_alarm),
                           .contacts_alike = settings->contact == PALP_CONTACT_KNOWN ||
                                             settings->contact == PALP_CONTACT_COMMON};
    data->run = calloc(n, sizeof *data->run);
    palp_status status = data->run ? explain_height(model, &data->height, error) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = explain_join(n, inputs, &data->joined);
    if (!status)
        status = take_inputs(data, data->joined.n, data->joined.input, settings, error);
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        explain_run *run = &data->run[r];
        data->n += run->n;
        data->longest = run->n > data->longest ? run->n : data->longest;
        for (size_t i = 0; i < run->n && !status; i++) {
            data->peak = fmax(data->peak, run->force[i]);
            data->deepest = fmax(data->deepest, run->depth[i]);
            data->strain = fmax(data->strain, run->depth[i] / run->height);
        }
        if (!status)
            data->duration = fmax(data->duration, run->time[run->n - 1] - run->time[0]);
    }
    if (!status)
        status = find_pace(data);
    if (!status)
        status = find_sample_noise(data);
    if (!status) {
        count_replicates(data);
        count_specimens(data);
        find_largest_strains(data);
        explain_shown_find(data);
    }
    if (!status && (!(data->peak > 0.0) || !(data->deepest > 0.0)))
        status = palp_error_set(error, PALP_ERR_INPUT, "%s: no run presses the specimen", data->run[0].name);
    return status;
}

void explain_data_free(explain_data *data) {
    for (size_t r = 0; data->run && r < data->n_runs; r++) {
        free(data->run[r].time);
        free(data->run[r].use);
        free(data->run[r].added);
    }
    free(data->run);
    free(data->pressed);
    free(data->event);
    explain_joined_free(&data->joined);
    *data = (explain_data){0};
}

size_t explain_samples(const explain_data *data) {
    size_t n = 0;
    for (size_t r = 0; r < data->n_runs; r++)
        n += data->run[r].held_out ? 0 : data->run[r].n;
    return n;
}

bool explain_may_recover(const explain_data *data, palp_effect_id id) {
    bool follows = false;
    for (size_t r = 0; r < data->n_runs; r++)
        follows = follows || !data->run[r].fresh;
    return follows && effect_row_of(id)->history;
}

size_t explain_fitted_runs(const explain_data *data) {
    size_t n = 0;
    for (size_t r = 0; r < data->n_runs; r++)
        n += !data->run[r].held_out;
    return n;
}

/* The change of a column; 0 if it is within its noise. */
static double change_in(const explain_run *run, const double *value) {
    const double beyond = 10.0;
    double most = 0.0, noise = 0.0;
    for (size_t i = 0; i < run->n; i++)
        most = fmax(most, fabs(value[i] - value[0]));
    if (palp_segments_noise(run->n, NULL, 0.0, value, PALP_NOISE_MEDIAN, &noise))
        return 0.0;
    return most > beyond * noise ? most : 0.0;
}

static double change_of(const effect_data *facts, const char *column) {
    const explain_data *data = facts->runs;
    double most = 0.0;
    for (size_t r = 0; r < data->n_runs; r++)
        for (size_t c = 0; c < data->run[r].n_columns; c++)
            if (strcmp(data->run[r].column[c].name, column) == 0)
                most = fmax(most, change_in(&data->run[r], data->run[r].column[c].value));
    return most;
}

effect_data explain_facts(const explain_data *data) {
    return (effect_data){.duration = data->duration,
                         .step = data->step,
                         .deepest = data->deepest,
                         .fastest = data->fastest,
                         .peak = data->peak,
                         .height = data->height,
                         .white = data->run[0].white,
                         .known_force = data->simulated,
                         .n_releases = data->n_releases,
                         .pull = {data->pull, data->pull_most},
                         .pulled = data->pulled,
                         .shown = data->shown,
                         .frame = {data->frame.low, data->frame.high},
                         .runs = data,
                         .change_of = change_of};
}

palp_status explain_each(const palp_explain_settings *settings, size_t n, void (*task)(void *work, size_t i),
                         void *work, const palp_status *status) {
    if (settings->loop)
        settings->loop(settings->loop_user, n, task, work);
    for (size_t i = 0; i < n && !settings->loop; i++)
        task(work, i);
    for (size_t i = 0; i < n; i++)
        if (status[i])
            return status[i];
    return PALP_OK;
}

double explain_fitted_rms(const explain_data *data, const double *x) {
    double sum = 0.0, count = 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n && !data->run[r].held_out; i++)
            if (data->run[r].use[i]) {
                sum += x[at + i] * x[at + i];
                count += 1.0;
            }
    return count > 0.0 ? sqrt(sum / count) : 0.0;
}
