/* simulate_reduced.c: palpate simulate's run of a reduced model under its plate. */
#include "shared/json_out.h"
#include "simulate.h"

#include <math.h>
#include <stdlib.h>

static const char NAME[] = "simulate";

bool simulate_is_reduced(const char *path) {
    json_t *root = json_load_file(path, 0, NULL);
    bool reduced = json_object_get(json_object_get(root, "palpate"), "reduced") != NULL;
    json_decref(root);
    return reduced;
}

static int check(const simulate_options *o, const simulation *s) {
    if (o->vtu || o->nodes.n > 0 || o->solver || o->branch)
        return cli_usage_error(
            NAME, "--vtu, --nodes, --solver and --branch are for a full network; %s is reduced", o->model);
    if (s->path.force_N)
        return cli_usage_error(NAME, "%s is a reduced model: it follows a depth, not a force", o->model);
    if (!(s->height_m > 0))
        return cli_failure(
            NAME, "%s was made for tools and has no plate; step it from a program (palpate/reduce.h)",
            o->model);
    return CLI_OK;
}

static palp_status step(simulation *s, double time_s, double since_s, bool relaxed) {
    palp_reduced_info info;
    double depth_m = palp_path_at(&s->path, time_s), dt_s = relaxed ? INFINITY : time_s - since_s;
    palp_status status = palp_reduced_step(s->reduced, depth_m, 0, NULL, dt_s, NULL, &info);
    if (status)
        return status;
    s->info.iterations += (size_t)info.iterations;
    s->info.worst_residual = fmax(s->info.worst_residual, info.residual);
    s->info.peak_force_N = fmax(s->info.peak_force_N, fabs(info.force_N));
    if (info.beyond > 0 && s->info.beyond == 0)
        s->info.beyond_s = time_s;
    s->info.beyond = fmax(s->info.beyond, info.beyond);
    return record_add(&s->curve, time_s, depth_m, info.force_N);
}

int simulate_reduced(const simulate_options *o, simulation *s) {
    press_settings press = {1e-3 * o->dt_ms, o->tolerance, o->relaxed, o->like || o->sample_Hz > 0, 0};
    double *time_s = NULL;
    size_t n = 0;
    int code = check(o, s);
    if (code)
        return code;
    palp_status status = press_times(&s->path, &press, &n, &time_s);
    for (size_t i = 0; i < n && !status; i++) {
        bool at_rest = i == 0 && palp_path_at(&s->path, time_s[0]) == 0;
        status = at_rest ? record_add(&s->curve, time_s[0], 0, 0)
                         : step(s, time_s[i], i ? time_s[i - 1] : time_s[0], o->relaxed);
        s->info.steps += i > 0;
    }
    free(time_s);
    return status ? cli_status_of(NAME, o->model, status, NULL) : CLI_OK;
}
