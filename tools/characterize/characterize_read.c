/* characterize_read.c: the runs of palpate characterize, and the contact, noise and defects of each. */
#include "characterize.h"
#include "shared/opening.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "characterize";

typedef struct text_line {
    char text[512];
    size_t n;
} text_line;

static void add(text_line *line, const char *format, double a, double b) {
    int n = snprintf(line->text + line->n, sizeof line->text - line->n, format, a, b);
    line->n += n > 0 ? (size_t)n : 0;
    line->n = line->n < sizeof line->text ? line->n : sizeof line->text - 1;
}

/* One line for a run: contact, zero force, noise and defects. */
static void tell(const palp_recording *r) {
    static const char *const kinds[] = {"ramp without a dwell", "ramp and hold", "press", "creep"};
    text_line line = {"", 0};
    add(&line, " to %.4g mm, %.0f samples", 1e3 * r->deepest_m, (double)r->n);
    add(&line, "; contact %.4g +- %.2g mm", 1e3 * r->contact_m, 1.96e3 * r->contact_sd_m);
    add(&line,
        r->contact_rule == PALP_CONTACT_FREE_AIR ? " (free air)"
        : r->contact_rule == PALP_CONTACT_GIVEN  ? " (given)"
                                                 : " (nominal, as there is no free air)",
        0, 0);
    add(&line, "; zero %.3g +- %.2g mN", 1e3 * r->zero_N, 1.96e3 * r->zero_sd_N);
    add(&line, "; noise %.3g mN", 1e3 * r->noise_N, 0);
    if (r->n_missing > 0)
        add(&line, "; %.0f samples missing (%.2g %%)", (double)r->n_missing,
            100.0 * (double)r->n_missing / (double)(r->n + r->n_missing));
    if (r->n_gaps > 0)
        add(&line, "; %.0f gap(s), the longest %.3g s", (double)r->n_gaps, r->longest_gap_s);
    if (r->n_spikes > 0)
        add(&line, "; %.0f spike(s) masked", (double)r->n_spikes, 0);
    if (r->n_clipped > 0)
        add(&line, "; %.0f clipped samples masked", (double)r->n_clipped, 0);
    if (r->hum_N > 0)
        add(&line, "; hum of %.2g mN at %.4g Hz", 1e3 * r->hum_N, r->hum_Hz);
    if (r->uneven)
        add(&line, "; uneven sampling", 0, 0);
    if (r->faulted)
        add(&line, "; cut short by a fault", 0, 0);
    cli_note(NAME, "%s: %s%s", r->name, kinds[r->kind], line.text);
}

/* Adds the run unless it has no specimen. */
static int take_one(const characterize_options *o, const char *file, const palp_experiment *experiment,
                    characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_recording_settings settings = palp_recording_settings_default();
    settings.height_m = 1e-3 * o->height_mm;
    settings.contact_given = !isnan(o->contact_mm);
    settings.contact_m = settings.contact_given ? 1e-3 * o->contact_mm : 0;
    const char *none = open_no_specimen(experiment);
    if (none) {
        cli_note(NAME, "%s: left out, as it has no specimen (specimen.kind is \"%s\")", file, none);
        return CLI_OK;
    }
    palp_status status = palp_recording_prepare(experiment, file, &settings, &s->run[s->n], &error);
    if (status)
        return cli_status(NAME, status, &error);
    s->run[s->n].radius_m = o->radius_mm > 0 ? 1e-3 * o->radius_mm : s->run[s->n].radius_m;
    int code = characterize_tip_read(o, experiment, &s->run[s->n], s);
    tell(&s->run[s->n++]);
    return code;
}

/* Joins runs that continue in another file, in place of the first part. */
static int join(const characterize_options *o, palp_experiment **run) {
    palp_experiment *whole[CHARACTERIZE_RUNS_MAX];
    size_t of[CHARACTERIZE_RUNS_MAX];
    palp_status status = palp_experiment_join(o->n_words, (const palp_experiment *const *)run, whole, of);
    if (status)
        return cli_status_of(NAME, o->words[0], status, NULL);
    for (size_t i = 0; i < o->n_words; i++) {
        const bool part = of[i] != i;
        if (part)
            cli_note(NAME, "%s: continues %s, and is joined to it as one run", o->words[i], o->words[of[i]]);
        if (part || whole[i]) {
            palp_experiment_free(run[i]);
            run[i] = whole[i];
        }
    }
    return CLI_OK;
}

static void sort(characterize_state *s) {
    for (size_t i = 1; i < s->n; i++) {
        palp_recording moved = s->run[i];
        palp_indentation tip = s->tip[i];
        size_t at = i;
        for (; at > 0 && run_before(&moved, &s->run[at - 1]); at--) {
            s->run[at] = s->run[at - 1];
            s->tip[at] = s->tip[at - 1];
        }
        s->run[at] = moved;
        s->tip[at] = tip;
    }
}

/* ---- the filter, for figures unless asked ---- */

static int filter_runs(const characterize_options *o, characterize_state *s) {
    s->cutoff_Hz = o->filter_Hz;
    for (size_t i = 0; i < s->n && o->filter_Hz <= 0; i++) {
        double own = run_cutoff_Hz(&s->run[i]);
        s->cutoff_Hz = i == 0 ? own : fmin(s->cutoff_Hz, own);
    }
    for (size_t i = 0; i < s->n && (o->result || o->report || o->fit_filtered); i++) {
        palp_recording *r = &s->run[i];
        s->filtered_N[i] = run_filter(r, s->cutoff_Hz);
        if (!s->filtered_N[i] && (o->fit_filtered || o->filter_Hz > 0))
            return cli_failure(NAME, "%s: cannot be filtered at %g Hz: %s", r->name, s->cutoff_Hz,
                               r->uneven ? "its samples are not evenly spaced in time"
                                         : "its sampling rate is too low");
        if (o->fit_filtered)
            memcpy(r->force_N, s->filtered_N[i], r->n * sizeof *r->force_N);
    }
    if (o->fit_filtered)
        characterize_warn(
            s, "the model is fitted to the filtered force: the filter rounds the ramp and biases fast arms");
    return CLI_OK;
}

static int read_all(const characterize_options *o, characterize_state *s) {
    palp_experiment *run[CHARACTERIZE_RUNS_MAX] = {NULL};
    int code = CLI_OK;
    for (size_t i = 0; i < o->n_words && code == CLI_OK; i++)
        code = open_run(NAME, o->words[i], &run[i]);
    if (code == CLI_OK)
        code = join(o, run);
    for (size_t i = 0; i < o->n_words; i++) {
        if (code == CLI_OK && run[i])
            code = take_one(o, o->words[i], run[i], s);
        palp_experiment_free(run[i]);
    }
    return code;
}

int characterize_read(const characterize_options *o, characterize_state *s) {
    int code = read_all(o, s);
    if (code)
        return code;
    if (s->n == 0)
        return cli_failure(NAME, "no recording of a specimen among the %zu given", o->n_words);
    sort(s);
    for (size_t i = 0; i < s->n; i++) {
        s->n_static += s->run[i].kind == PALP_RECORDING_STATIC;
        s->n_hold += s->run[i].kind == PALP_RECORDING_RAMP_HOLD;
    }
    code = characterize_group(o, s);
    return code ? code : filter_runs(o, s);
}
