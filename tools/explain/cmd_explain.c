/* cmd_explain.c: palpate explain: names and adds the effects that a model misses in measured runs. */
#define _POSIX_C_SOURCE 200809L
#include <palpate/explain.h>

#include "shared/blas.h"
#include "shared/commands.h"
#include "explain.h"
#include "shared/jobs.h"
#include "shared/json_out.h"
#include "shared/opening.h"
#include "shared/page.h"
#include "shared/watch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "explain";

static int parse(int argc, char **argv, explain_options *o) {
    const cli_option options[] = {
        cli_heading("What is explained"),
        cli_in("model", "MODEL.json", &o->model,
               "the model, lumped or a network, that misses something (this or --simulated)"),
        cli_flag("simulated", &o->simulated,
                 "in place of a model's the forces that another program computed: the files are\n"
                 "simulated runs, then the measured ones. A pair has the same name (without\n"
                 "folder); if no names agree, the first half is simulated, in the order of the\n"
                 "measured half. Both are CSV with time_s, depth_mm (0 = contact) and force_N,\n"
                 "along the same path from the first sample on; the times of samples may differ"),
        cli_text("hold-out", "auto|FILES", &o->hold_out,
                 "runs kept out of the fit, between commas (default auto: each in turn)"),
        cli_text("candidates", "IDS", &o->candidates, "effects to try, between commas (default: all)"),
        cli_count("every", "N", 1, 1e6, &o->every,
                  "take one sample in N of each run, and those between them where the path\n"
                  "bends (default: so many that 20000 remain; the time it takes grows with them)"),
        cli_choice("contact", "known|common|free", &o->contact,
                   "whether depth 0 is contact: exactly in every run (known); off by the same in\n"
                   "all, if at all (common); or off by a value of each run, with an estimated\n"
                   "scatter (free, default)"),
        cli_heading("Thresholds"),
        cli_count("max-effects", "N", 0, PALP_EXPLAIN_EFFECTS, &o->max_effects,
                  "most effects to add (default 4)"),
        cli_number("false-alarm", "P", 1e-4, 0.5, &o->false_alarm,
                   "chance that an effect is named where none is (default 0.05)"),
        cli_number("good-enough", "PERCENT", 0, 100, &o->good_enough,
                   "practical limit, of the largest force: smaller effects are not named, and\n"
                   "smaller residuals do not count (default 0: none)"),
        cli_flag("sparse", &o->sparse,
                 "a formula for each free term, of powers, exponentials, hinges and saturations"),
        cli_count("jobs", "N", 1, 64, &o->jobs, "threads (default 1); the answer does not depend on it"),
        cli_heading("Limits of the next experiment"),
        cli_positive("next-depth-mm", "MM", 1000, &o->limits.depth_m,
                     "deepest place of the plate, mm (default: of the runs)"),
        cli_positive("next-rate-mm-s", "R", 1e4, &o->limits.rate_m_s,
                     "largest speed, mm/s (default: of the runs)"),
        cli_positive("next-time-s", "S", 1e7, &o->limits.time_s,
                     "its duration, s (default: that of the session so far)"),
        cli_positive("next-rest-s", "S", 1e6, &o->limits.rest_s,
                     "rest before each run, s (default: the mean pause between the runs)"),
        cli_heading("Output"),
        cli_out("out", "EXPLAINED.json", &o->out, "the model with the effects"),
        cli_flag("json", &o->json, "the whole result as one JSON object on standard output"),
        cli_out("result", "RESULT.json", &o->result,
                "the same into a file, with its figures, for palpate report"),
        cli_out("report", "PAGE.html", &o->report, "the result on one page"),
        cli_out("next", "PROTOCOL.json", &o->next, "the next experiment, for palpate acquire"),
    };
    const cli_command command = {
        NAME,
        "(--model MODEL.json | --simulated SIM.csv ...) RUN.csv ... [options]",
        "Refits a model to runs, finds where they disagree, names the missing effect from the catalogue and\n"
        "adds it. The answer can also be that nothing is missing; that the runs do not separate effects,\n"
        "with an experiment that would; or that the missing effect is not in the catalogue.",
        "  palpate explain --model lumped.json runs/*.csv --out explained.json --report page.html\n"
        "  palpate explain --simulated simulated/*.csv measured/*.csv --report page.html\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, o->words, 2 * EXPLAIN_RUNS_MAX, &o->n_words);
    if (code == CLI_OK && (!o->model == !o->simulated || o->n_words == 0))
        return cli_usage_error(
            NAME, "needs runs and either --model MODEL.json or --simulated; see palpate explain --help");
    return code ? code : explain_pair(NAME, o);
}

/* The next name of a list between commas; false at its end. */
static bool next_name(const char **list, char name[CLI_PATH_MAX]) {
    size_t n = strcspn(*list, ",");
    if (n == 0 || n >= CLI_PATH_MAX)
        return false;
    memcpy(name, *list, n);
    name[n] = '\0';
    *list += n + ((*list)[n] == ',');
    return true;
}

static int choose_candidates(const explain_options *o, palp_explain_settings *s) {
    char name[CLI_PATH_MAX];
    palp_effect_id id;
    if (!o->candidates)
        return CLI_OK;
    memset(s->candidate, 0, sizeof s->candidate);
    for (const char *at = o->candidates; next_name(&at, name);) {
        if (palp_effect_parse(name, &id))
            return cli_usage_error(NAME, "--candidates: no effect is called \"%s\"", name);
        s->candidate[id] = 1;
    }
    return CLI_OK;
}

static int choose_held_out(const explain_options *o, palp_explain_settings *s,
                           size_t held_out[EXPLAIN_RUNS_MAX]) {
    char name[CLI_PATH_MAX];
    if (!o->hold_out || strcmp(o->hold_out, "auto") == 0)
        return CLI_OK;
    for (const char *at = o->hold_out; next_name(&at, name);) {
        size_t r = 0;
        while (r < o->n_words && strcmp(o->words[r], name) != 0)
            r++;
        if (r == o->n_words)
            return cli_usage_error(NAME, "--hold-out: %s is not among the runs", name);
        if (s->n_held_out < EXPLAIN_RUNS_MAX)
            held_out[s->n_held_out++] = r;
    }
    s->held_out = held_out;
    return s->n_held_out < o->n_words ? CLI_OK : cli_usage_error(NAME, "--hold-out leaves no run to fit");
}

/* Largest depth of the runs of a lumped model, over its height; 0 of a network. */
static double deepest_strain(const palp_model *model, size_t n, palp_experiment *const *run) {
    double deepest = 0;
    for (size_t r = 0; r < n && model->kind == PALP_MODEL_LUMPED; r++) {
        const double *depth_mm = palp_experiment_column(run[r], "depth_mm");
        for (size_t i = 0; depth_mm && i < palp_experiment_rows(run[r]); i++)
            deepest = fmax(deepest, 1e-3 * depth_mm[i] / model->height_m);
    }
    return deepest;
}

/* A law without a measured range may fall to a stiffness of 0 beyond the runs, where a model file must have
 * one. Then it holds as deep as they go. */
static int write_out(const explain_options *o, const palp_explanation *e, palp_experiment *const *run) {
    palp_error error;
    int code = CLI_OK;
    palp_model model = e->model;
    palp_law *law = &model.material.law;
    palp_law_limit(law, law->strain_max); /* of the coefficients that were found */
    if (!(law->strain_max > 0) && !(palp_law_minimum(law, PALP_MODEL_STRAIN) > 0))
        palp_law_limit(law, deepest_strain(&model, o->n_words, run));
    if (o->out && palp_model_write(&model, o->out, &error))
        code = cli_status(NAME, error.status, &error);
    if (code == CLI_OK && o->next && e->next.n_runs > 0)
        code = json_save(NAME, explain_protocol(e), o->next);
    return code;
}

/* The fit's law holds as deep as the runs go. A warning says where they go beyond the measured range of the
 * given law by more than contacts differ. */
static void extend_range(palp_model *model, size_t n, palp_experiment *const *run) {
    palp_law *law = &model->material.law;
    const double given = law->strain_max, deepest = given > 0 ? deepest_strain(model, n, run) : 0;
    if (deepest > 1.02 * given)
        cli_warning(
            NAME, "beyond the measured strain of %.4g: these runs go to %.4g, and the law is fitted to there",
            given, deepest);
    if (deepest > given)
        palp_law_limit(law, deepest);
}

/* The given model, or none with simulated runs. */
static int open_compared(const explain_options *o, palp_model *model, palp_mesh_source *mesh,
                         palp_explain_input *simulated, palp_experiment **run) {
    int code = CLI_OK;
    if (o->simulated)
        return open_runs(NAME, o->n_simulated, o->simulated_files, o->every, run, simulated);
    code = open_model(NAME, o->model, model, mesh);
    return code ? code : open_refuse_mass(NAME, o->model, model);
}

static int explain(explain_options *o, palp_explain_input *input, palp_experiment **run, size_t *held_out) {
    palp_explain_input *simulated = input + EXPLAIN_RUNS_MAX, *simulated_of = simulated + EXPLAIN_RUNS_MAX;
    palp_model model;
    palp_mesh_source mesh;
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    palp_error error = {PALP_OK, ""};
    o->jobs = blas_jobs(NAME, o->jobs);
    s.max_effects = o->max_effects;
    s.false_alarm = o->false_alarm;
    s.contact = (palp_contact_form)o->contact;
    s.good_enough = 0.01 * o->good_enough;
    s.next = o->limits;
    s.next.depth_m *= 1e-3;
    s.next.rate_m_s *= 1e-3;
    s.loop = o->jobs > 1 ? jobs_run : NULL;
    s.loop_user = &o->jobs;
    int code = choose_candidates(o, &s);
    code = code ? code : choose_held_out(o, &s, held_out);
    code = code ? code : open_compared(o, &model, &mesh, simulated, run + EXPLAIN_RUNS_MAX);
    code = code ? code : open_runs(NAME, o->n_words, o->words, o->every, run, input);
    for (size_t r = 0; r < o->n_words && o->simulated; r++)
        simulated_of[r] = o->simulated_of[r] < o->n_simulated ? simulated[o->simulated_of[r]]
                                                              : (palp_explain_input){.experiment = NULL};
    s.simulated = o->simulated ? simulated_of : NULL;
    if (code == CLI_OK) {
        if (o->model)
            extend_range(&model, o->n_words, run);
        watch w;
        watch_start(&w, NAME, &s);
        palp_status status = palp_explain(o->model ? &model : NULL, o->n_words, input, &s, &e, &error);
        watch_finish(&w);
        code = status ? cli_status_of(NAME, o->model, status, &error) : CLI_OK;
    }
    if (code == CLI_OK) {
        json_t *result = explain_json(o, &e), *figures = json_array();
        if (!o->json)
            explain_say(stdout, result);
        if (o->result || o->report)
            explain_figures(figures, &e);
        code = page_result(NAME, result, figures, o->json, o->result, o->report);
        code = code ? code : write_out(o, &e, run);
        code = code == CLI_OK && e.stopped ? CLI_NOT_CONVERGED : code;
        palp_explanation_free(&e);
    }
    return code;
}

int cmd_explain(int argc, char **argv) {
    explain_options *o = calloc(1, sizeof *o);
    palp_explain_input *input = calloc(3 * (size_t)EXPLAIN_RUNS_MAX,
                                       sizeof *input); /* and simulated ones, as given and of each run */
    palp_experiment **run = calloc(2 * (size_t)EXPLAIN_RUNS_MAX, sizeof *run);
    size_t *held_out = calloc(EXPLAIN_RUNS_MAX, sizeof *held_out);
    bool room = o && input && run && held_out;
    int code = room ? CLI_OK : cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    if (code == CLI_OK) {
        o->max_effects = 4;
        o->false_alarm = 0.05;
        o->contact = PALP_CONTACT_FREE;
        o->jobs = 1;
        cli_keep_command(argc, argv, o->command);
        code = parse(argc, argv, o);
    }
    if (code == CLI_OK)
        code = explain(o, input, run, held_out);
    for (size_t r = 0; run && r < 2 * (size_t)EXPLAIN_RUNS_MAX; r++)
        palp_experiment_free(run[r]);
    free(o);
    free(input);
    free(run);
    free(held_out);
    return code == CLI_HELP ? CLI_OK : code;
}
