/* cmd_reduce.c: palpate reduce: a model of few coordinates and few elements that follows a large network. */
#define _POSIX_C_SOURCE 200809L
#include "shared/blas.h"
#include "shared/commands.h"
#include "shared/jobs.h"
#include "shared/json_out.h"
#include "shared/progress.h"
#include "reduce.h"
#include "shared/opening.h"

#include <math.h>
#include <palpate/realtime.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "reduce";
static const double POOR = 0.01; /* a larger held-out error gives a warning */

typedef struct reduction {
    const reduce_options *options;
    palp_model model;
    palp_mesh_source source;
    palp_mesh *mesh;
    char *list; /* of --runs, cut at its commas */
    reduce_run run[REDUCE_RUNS_MAX];
    size_t n;
    bool tools, free_top;
    pthread_mutex_t lock;
    size_t done, total; /* samples, for the bar */
    progress bar;
    palp_status status; /* of the first run that failed, with its error */
    palp_error error;
    size_t failed;
    palp_reduced *reduced;
} reduction;

static int parse(int argc, char **argv, reduce_options *o) {
    const cli_option options[] = {
        cli_heading("Snapshots"),
        cli_in("runs", "RUN.csv[,...]", &o->runs,
               "paths of the plate (time_s, depth_mm) or of a ball (its centre in the mesh,\n"
               "tool_x_mm, tool_y_mm, tool_z_mm, and the key tool.radius_mm); files may\n"
               "also follow without an option"),
        cli_number("hold-out", "SHARE", 0, 0.9, &o->hold_out,
                   "share of the runs held out of the reduction to measure its error\n"
                   "(default 0.25, at least one run; 0: none, no error is measured)"),
        cli_count("samples", "N", 2, 1e5, &o->samples,
                  "most snapshots of a run, at even distances (default 100)"),
        cli_choice("supports", "auto|plate|bottom", &o->supports,
                   "plate: the plate moves the top nodes; bottom: only the bottom nodes\n"
                   "are fixed; auto (default): bottom if a run has a tool"),
        cli_count("jobs", "N", 1, 64, &o->jobs, "threads (default 1); the result does not depend on it"),
        cli_heading("Size"),
        cli_count("modes", "N", 1, 2000, &o->settings.modes, "most modes (default 80)"),
        cli_positive("tolerance", "REL", 0.5, &o->settings.tolerance,
                     "relative error of the snapshots in the modes, in the energy norm\n(default 1e-3)"),
        cli_count("elements", "N", 1, 1e7, &o->settings.elements, "most elements to keep (default 1200)"),
        cli_positive("element-tolerance", "REL", 0.5, &o->settings.element_tolerance,
                     "relative error of the kept elements' forces in the snapshots\n(default 3e-3)"),
        cli_count(
            "static-modes", "N", 0, 2000, &o->settings.static_modes,
            "how many of the modes are responses to a load at one node that the\ntool touched (default 0)"),
        cli_heading("Output"),
        cli_out("out", "REDUCED.json", &o->out,
                "the reduced model, with its arrays in REDUCED.bin beside it"),
        cli_flag("json", &o->json, "a summary as JSON on standard output"),
    };
    const cli_command command = {
        NAME,
        "NETWORK.json --runs RUN.csv[,...] [RUN.csv ...] [options]",
        "Runs a network along paths and makes a reduced model that is fast enough for a simulator's tick:\n"
        "modes from the snapshots (POD), and few weighted elements in place of all (ECSW).",
        "  palpate reduce network.json --runs press_1.csv,press_2.csv,slide_1.csv --out reduced.json\n"
        "  palpate reduce network.json --runs runs/*.csv --hold-out 0.3 --jobs 2 --out reduced.json\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, o->words, 1 + REDUCE_RUNS_MAX, &o->n_words);
    o->model = o->words[0];
    if (code == CLI_OK && o->n_words == 0)
        return cli_usage_error(NAME, "name a NETWORK.json; see palpate reduce --help");
    if (code == CLI_OK && !o->runs && o->n_words == 1)
        return cli_usage_error(NAME, "name runs for the snapshots: --runs RUN.csv");
    if (code == CLI_OK && o->settings.static_modes > o->settings.modes)
        return cli_usage_error(NAME, "--static-modes count among --modes; raise --modes");
    return code;
}

static int add_run(reduction *r, const char *file) {
    if (r->n == REDUCE_RUNS_MAX)
        return cli_usage_error(NAME, "at most %d runs", (int)REDUCE_RUNS_MAX);
    return reduce_run_read(file, r->options->samples, &r->run[r->n++]);
}

static int read_runs(reduction *r) {
    const reduce_options *o = r->options;
    int code = CLI_OK;
    char *rest = NULL;
    r->list = o->runs ? strdup(o->runs) : NULL;
    if (o->runs && !r->list)
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    for (char *file = r->list ? strtok_r(r->list, ",", &rest) : NULL; file && code == CLI_OK;
         file = strtok_r(NULL, ",", &rest)) {
        code = add_run(r, file);
    }
    for (size_t i = 1; i < o->n_words && code == CLI_OK; i++)
        code = add_run(r, o->words[i]);
    return code;
}

/* Holds out the last run of each group. */
static int hold_out(reduction *r) {
    const reduce_options *o = r->options;
    size_t held = (size_t)(o->hold_out * (double)r->n + 0.5);
    held = o->hold_out > 0 && held == 0 ? 1 : held;
    if (held > 0 && held >= r->n)
        return cli_usage_error(NAME, "%zu runs are too few to hold one out; add runs, or give --hold-out 0",
                               r->n);
    for (size_t i = 0; i < r->n; i++) {
        r->run[i].held_out = (i + 1) * held / r->n > i * held / r->n;
        r->tools = r->tools || r->run[i].tool;
        r->total += r->run[i].n;
    }
    r->free_top = o->supports == 2 || (o->supports == 0 && r->tools);
    return CLI_OK;
}

static int check_depths(const reduction *r) {
    double low[3], high[3];
    palp_mesh_bounds(r->mesh, low, high);
    for (size_t i = 0; i < r->n; i++) {
        for (size_t k = 0; k < r->run[i].n; k++) {
            double depth = r->run[i].depth_m[k];
            if (depth > 0 && r->free_top)
                return cli_failure(
                    NAME, "%s: depth_mm is above 0, but no plate moves the top; give --supports plate",
                    r->run[i].file);
            if (depth >= high[1] - low[1])
                return cli_failure(NAME, "%s: depth_mm reaches %g, beyond the network's height of %g mm",
                                   r->run[i].file, 1e3 * depth, 1e3 * (high[1] - low[1]));
        }
    }
    return CLI_OK;
}

static palp_status make_network(const reduction *r, palp_network **net, palp_error *error) {
    palp_network_settings settings = palp_network_settings_of_model(&r->model);
    palp_contact_settings contact = palp_contact_settings_default();
    palp_support supports[2];
    palp_supports_default(supports);
    settings.tolerance = 1e-7;
    contact.local = false; /* a reduced network touches whole triangles */
    palp_status status = palp_network_create(r->mesh, &r->model.material, r->free_top ? 1 : 2, supports,
                                             &settings, net, error);
    if (!status && r->tools)
        status = palp_network_enable_tools(*net, 1, 0, &contact);
    return status;
}

static int sample_done(void *user, double time_s, double depth_m, double force_N) {
    reduction *r = user;
    (void)time_s;
    (void)depth_m;
    (void)force_N;
    pthread_mutex_lock(&r->lock);
    progress_update(&r->bar, (double)++r->done / (double)r->total);
    bool stop = r->status != PALP_OK;
    pthread_mutex_unlock(&r->lock);
    return stop;
}

static void take_snapshots(void *work, size_t i) {
    reduction *r = work;
    reduce_run *run = &r->run[i];
    palp_network *net = NULL;
    palp_realtime *realtime = NULL;
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_error error = {PALP_OK, ""};
    palp_tool_path path = {run->n, run->time_s, run->depth_m, run->tool ? 1 : 0, run->tool};
    palp_status status = make_network(r, &net, &error);
    if (!status && r->model.material.formulation == PALP_HISTORY)
        status = palp_realtime_create(net, &settings, &realtime);
    if (!status)
        status = palp_snapshots_record(net, realtime, &path, sample_done, r, &run->snapshots, &error);
    palp_realtime_free(realtime);
    palp_network_free(net);
    pthread_mutex_lock(&r->lock);
    if (status && (r->status == PALP_OK || i < r->failed) && status != PALP_ERR_STOPPED) {
        r->status = status;
        r->error = error;
        r->failed = i;
    }
    pthread_mutex_unlock(&r->lock);
}

static int snapshots_of_all(reduction *r) {
    progress_start(&r->bar, "reduce: the network's runs");
    jobs_run((void *)&r->options->jobs, r->n, take_snapshots, r);
    progress_finish(&r->bar);
    if (r->status) {
        palp_error error = {r->status, ""};
        snprintf(error.text, sizeof error.text, "%.200s: %.300s", r->run[r->failed].file,
                 r->error.text[0] ? r->error.text : palp_status_text(r->status));
        return cli_status(NAME, r->status, &error);
    }
    return CLI_OK;
}

static int reduce(reduction *r) {
    palp_snapshots *list[2][REDUCE_RUNS_MAX];
    palp_reduce_error held[REDUCE_RUNS_MAX];
    size_t n[2] = {0, 0};
    palp_network *net = NULL;
    palp_error error = {PALP_OK, ""};
    for (size_t i = 0; i < r->n; i++)
        list[r->run[i].held_out][n[r->run[i].held_out]++] = r->run[i].snapshots;
    palp_status status = make_network(r, &net, &error);
    if (!status)
        status = palp_reduced_create(net, n[0], list[0], n[1], list[1], &r->options->settings, &r->reduced,
                                     held, &error);
    palp_network_free(net);
    if (status == PALP_ERR_ARGUMENT && error.text[0])
        return cli_failure(NAME, "%s%s: %s", r->run[0].file, r->n > 1 ? " and the other runs" : "",
                           error.text);
    if (status)
        return cli_status_of(NAME, r->options->model, status, &error);
    for (size_t i = 0, k = 0; i < r->n; i++)
        if (r->run[i].held_out)
            r->run[i].error = held[k++];
    return CLI_OK;
}

static json_t *error_json(const reduction *r) {
    json_t *list = json_array();
    for (size_t i = 0; i < r->n; i++) {
        const reduce_run *run = &r->run[i];
        if (run->held_out)
            json_array_append_new(list, json_pack("{s:o, s:f, s:f, s:f}", "run", json_text(run->file),
                                                  "worst_N", run->error.worst_N, "rms_N", run->error.rms_N,
                                                  "peak_N", run->error.peak_N));
    }
    return list;
}

static int print_json(const reduction *r) {
    palp_reduced_summary s = palp_reduced_describe(r->reduced);
    bool known = s.held_out_paths > 0;
    return json_print(NAME,
                      json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:o, s:o, s:o, s:o}", "unknowns",
                                (json_int_t)s.unknowns, "modes", (json_int_t)s.modes, "network_elements",
                                (json_int_t)s.network_elements, "elements", (json_int_t)s.elements,
                                "snapshot_runs", (json_int_t)s.snapshot_paths, "held_out_runs",
                                (json_int_t)s.held_out_paths, "element_residual", s.element_residual,
                                "held_out_worst", json_number_or_null(known ? s.held_out_worst : INFINITY),
                                "held_out_rms", json_number_or_null(known ? s.held_out_rms : INFINITY),
                                "bound", json_number_or_null(s.bound), "held_out", error_json(r)));
}

static void print_text(const reduction *r) {
    palp_reduced_summary s = palp_reduced_describe(r->reduced);
    printf("%zu of %zu coordinates, %zu of %zu elements, from snapshots of %zu runs\n", s.modes, s.unknowns,
           s.elements, s.network_elements, s.snapshot_paths);
    for (size_t i = 0; i < r->n; i++) {
        const reduce_run *run = &r->run[i];
        if (run->held_out)
            cli_say(stdout, "held out: %s: largest error %.3g N, rms %.3g N, of a peak force of %.4g N",
                    run->file, run->error.worst_N, run->error.rms_N, run->error.peak_N);
    }
    if (s.held_out_paths > 0)
        printf("error bound on paths like these: %.2g %% of the largest force\n", 100 * s.bound);
}

static int answer(const reduction *r) {
    const reduce_options *o = r->options;
    palp_error error = {PALP_OK, ""};
    palp_reduced_summary s = palp_reduced_describe(r->reduced);
    palp_status status = o->out ? palp_reduced_write(r->reduced, &r->model, o->out, &error) : PALP_OK;
    if (status)
        return cli_status(NAME, status, &error);
    if (s.held_out_paths > 0 && s.held_out_worst > POOR)
        cli_warning(
            NAME,
            "the error on the runs held out is %.2g %%; add runs near them, or raise --modes or --elements",
            100 * s.held_out_worst);
    if (o->json)
        return print_json(r);
    print_text(r);
    return CLI_OK;
}

static int run(const reduce_options *o, reduction *r) {
    palp_error error = {PALP_OK, ""};
    r->options = o;
    int code =
        open_model_of(NAME, o->model, PALP_MODEL_NETWORK,
                      "is a lumped model, which needs no reduction; give a network", &r->model, &r->source);
    if (code)
        return code;
    if (r->model.n_effects + r->model.n_free > 0)
        return cli_failure(NAME, "%s: a model with effects or free terms cannot be reduced", o->model);
    code = read_runs(r);
    code = code ? code : hold_out(r);
    if (code == CLI_OK) {
        palp_status status = palp_model_mesh(&r->model, &r->mesh, &error);
        code = status ? cli_status(NAME, status, &error) : check_depths(r);
    }
    code = code ? code : snapshots_of_all(r);
    code = code ? code : reduce(r);
    return code ? code : answer(r);
}

int cmd_reduce(int argc, char **argv) {
    reduce_options o = {
        .hold_out = 0.25, .samples = 100, .jobs = 1, .settings = palp_reduce_settings_default()};
    int code = parse(argc, argv, &o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    o.jobs = blas_jobs(NAME, o.jobs);
    reduction *r = calloc(1, sizeof *r);
    if (!r)
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    pthread_mutex_init(&r->lock, NULL);
    code = run(&o, r);
    for (size_t i = 0; i < r->n; i++)
        reduce_run_free(&r->run[i]);
    pthread_mutex_destroy(&r->lock);
    palp_reduced_free(r->reduced);
    palp_mesh_free(r->mesh);
    free(r->list);
    free(r);
    return code;
}
