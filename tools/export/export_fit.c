/* export_fit.c: the presses that a solid is fitted to: recordings, or the model's own force. */
#include "export.h"

#include "shared/opening.h"

#include <math.h>
#include <palpate/forward.h>
#include <palpate/network.h>
#include <palpate/recording.h>
#include <stdlib.h>
#include <string.h>

static const double DEEPEST = 0.25; /* of the height, unless a depth or a recording gives another */
static const double RATE_M_S = 1e-3;
static const double SHORTEST_HOLD_S = 10, HOLDS = 3; /* duration of a dwell, in longest relaxation times */

/* ---- recordings ---- */

/* The files between commas, in a copy that the caller frees. */
static int split(const char *list, char **copy, const char *file[EXPORT_RUNS_MAX], size_t *n) {
    *n = 0;
    *copy = malloc(strlen(list) + 1);
    if (!*copy)
        return cli_status("export", PALP_ERR_NO_MEMORY, NULL);
    char *at = strcpy(*copy, list);
    while (at) {
        char *comma = strchr(at, ',');
        if (*n == EXPORT_RUNS_MAX)
            return cli_usage_error("export", "more than %d runs", EXPORT_RUNS_MAX);
        file[(*n)++] = at;
        if (comma)
            *comma++ = '\0';
        at = comma;
    }
    return CLI_OK;
}

static int read_run(const char *file, double height_m, palp_recording *run) {
    palp_experiment *experiment = NULL;
    palp_error error = {PALP_OK, ""};
    palp_recording_settings settings = palp_recording_settings_default();
    settings.height_m = height_m;
    const char *tip = NULL;
    int code = open_run("export", file, &experiment);
    if (code)
        return code;
    if (open_no_specimen(experiment) ||
        (!palp_experiment_get_string(experiment, "tip.kind", &tip) && strcmp(tip, "plate") != 0)) {
        code = cli_failure("export", "%s: no recording of a specimen under a plate", file);
        palp_experiment_free(experiment);
        return code;
    }
    palp_status status = open_smooth_path(experiment);
    if (!status)
        status = palp_recording_prepare(experiment, file, &settings, run, &error);
    palp_experiment_free(experiment);
    return status ? cli_status_of("export", file, status, &error) : CLI_OK;
}

/* Squares of the lumped model's own residuals. */
static palp_status lumped_squares(const palp_model *model, const palp_recording *run, double *sum) {
    double *force = malloc((run->n + 1) * sizeof *force);
    const palp_forward_run forward = {.n = run->n, .time_s = run->time_s, .depth_m = run->depth_m};
    palp_status status = force ? palp_forward_force(model, &forward, force, NULL, NULL) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; !status && i < run->n; i++)
        if (run->use[i])
            *sum += (force[i] - run->force_N[i]) * (force[i] - run->force_N[i]);
    free(force);
    return status;
}

static int fit_runs(const palp_model *model, size_t n, const palp_recording *run, export_scene *s) {
    palp_solid_press press[EXPORT_RUNS_MAX];
    double squares = 0, deepest = 0;
    palp_status status = PALP_OK;
    for (size_t r = 0; r < n; r++) {
        press[r] = (palp_solid_press){run[r].n, run[r].time_s, run[r].depth_m, run[r].force_N, run[r].use};
        deepest = fmax(deepest, run[r].deepest_m);
        if (!status && model->kind == PALP_MODEL_LUMPED)
            status = lumped_squares(model, &run[r], &squares);
    }
    if (!(s->depth_m > 0))
        s->depth_m = deepest;
    s->ramp_s = run[0].ramp_end_s - run[0].ramp_start_s;
    s->ramp_s *= s->depth_m / run[0].deepest_m; /* at the rate of the first recording */
    s->n_runs = n;
    status = status ? status : palp_solid_fit(&s->solid, s->mesh, n, press, &s->info);
    if (!status && model->kind == PALP_MODEL_LUMPED)
        s->lumped_rms_N = sqrt(squares / (double)s->info.n);
    return status ? cli_status_of("export", "the solid's fit", status, NULL) : CLI_OK;
}

static int fit_to_runs(const export_options *o, const palp_model *model, export_scene *s) {
    const char *file[EXPORT_RUNS_MAX];
    palp_recording *run = calloc(EXPORT_RUNS_MAX, sizeof *run);
    char *copy = NULL;
    size_t n = 0, read = 0;
    int code = run ? split(o->runs, &copy, file, &n) : cli_status("export", PALP_ERR_NO_MEMORY, NULL);
    for (; code == CLI_OK && read < n; read++)
        code = read_run(file[read], s->height_m, &run[read]);
    if (code == CLI_OK)
        code = fit_runs(model, n, run, s);
    for (size_t r = 0; r < read; r++)
        palp_recording_free(&run[r]);
    free(run);
    free(copy);
    return code;
}

/* ---- the model's own force ---- */

enum { PHASE = 50, OWN = 2 * PHASE + 1 }; /* even samples of the ramp, and of the dwell */

typedef struct own_press {
    double time_s[OWN], depth_m[OWN], force_N[OWN];
} own_press;

static void make_path(const export_scene *s, own_press *press) {
    for (int i = 0; i < OWN; i++) {
        press->time_s[i] = i <= PHASE ? s->ramp_s * i / PHASE : s->ramp_s + s->hold_s * (i - PHASE) / PHASE;
        press->depth_m[i] = s->depth_m * fmin(1, press->time_s[i] / s->ramp_s);
    }
}

static int press_network_model(const palp_model *model, const export_scene *s, own_press *press) {
    palp_network *network = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_network_from_model(model, s->mesh, 0, NULL, NULL, &network, &error);
    int code = status ? cli_status("export", status, &error) : CLI_OK;
    for (int i = 1; i < OWN && code == CLI_OK; i++) {
        palp_step_info info;
        status =
            palp_network_step(network, press->depth_m[i], press->time_s[i] - press->time_s[i - 1], &info);
        press->force_N[i] = info.force_N;
        if (status) {
            char what[CLI_PATH_MAX];
            snprintf(what, sizeof what, "%.3000s: its network at %.4g mm (try a smaller --depth-mm)",
                     s->model, 1e3 * press->depth_m[i]);
            code = cli_status_of("export", what, status, NULL);
        }
    }
    palp_network_free(network);
    return code;
}

static int fit_to_model(const palp_model *model, export_scene *s) {
    own_press own = {{0}, {0}, {0}};
    make_path(s, &own);
    int code = CLI_OK;
    palp_status status = PALP_OK;
    if (model->kind == PALP_MODEL_NETWORK)
        code = press_network_model(model, s, &own);
    else
        status =
            palp_lumped_run(&model->material, model->height_m, OWN, own.time_s, own.depth_m, own.force_N);
    if (code)
        return code;
    const palp_solid_press press = {OWN, own.time_s, own.depth_m, own.force_N, NULL};
    status = status ? status : palp_solid_fit(&s->solid, s->mesh, 1, &press, &s->info);
    return status ? cli_status_of("export", "the solid's fit", status, NULL) : CLI_OK;
}

int export_fit(const export_options *o, const palp_model *model, export_scene *s) {
    double longest = 0;
    for (size_t j = 0; j < s->solid.n_arms; j++)
        longest = fmax(longest, s->solid.tau_s[j]);
    if (o->depth_mm.n > 0)
        s->depth_m = 1e-3 * o->depth_mm.value[0];
    else if (o->strain.n > 0)
        s->depth_m = o->strain.value[0] * s->height_m;
    else if (!o->runs)
        s->depth_m =
            s->height_m *
            (model->material.law.strain_max > 0 ? fmin(DEEPEST, model->material.law.strain_max) : DEEPEST);
    if (s->depth_m >= 0.95 * s->height_m)
        return cli_usage_error("export",
                               "a depth of %g mm is not below the height of %g mm of %s; press less",
                               1e3 * s->depth_m, 1e3 * s->height_m, s->model);
    s->hold_s = o->hold_s > 0 ? o->hold_s : fmax(SHORTEST_HOLD_S, HOLDS * longest);
    const int code = o->runs ? fit_to_runs(o, model, s) : CLI_OK;
    if (o->rate_mm_s > 0 || !(s->ramp_s > 0))
        s->ramp_s = s->depth_m / (o->rate_mm_s > 0 ? 1e-3 * o->rate_mm_s : RATE_M_S);
    return o->runs ? code : fit_to_model(model, s);
}

int export_press(export_scene *s) {
    own_press own = {{0}, {0}, {0}};
    make_path(s, &own);
    const palp_solid_press press = {OWN, own.time_s, own.depth_m, own.force_N, NULL};
    const palp_status status = palp_solid_run(&s->solid, s->mesh, &press, own.force_N);
    s->ramp_N = own.force_N[PHASE];
    s->hold_N = own.force_N[OWN - 1];
    return status ? cli_status_of("export", "the scene's press", status, NULL) : CLI_OK;
}
