/* simulate_network.c: palpate simulate's run of a network, with frames for ParaView. */
#include "simulate.h"

static const char NAME[] = "simulate";

typedef struct frames {
    palp_vtu *series;
    const palp_network *network;
    size_t every, step;
    palp_status status;
    palp_error error;
} frames;

static int add_frame(void *user) {
    frames *f = user;
    if (f->series && f->step++ % f->every == 0)
        f->status = palp_vtu_add(f->series, f->network, &f->error);
    return f->status != PALP_OK;
}

int simulate_mesh(const simulate_options *o, simulation *s) {
    double low[3], high[3];
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_model_mesh(&s->model, &s->mesh, &error);
    if (status)
        return cli_status_of(NAME, o->model, status, &error);
    palp_mesh_bounds(s->mesh, low, high);
    s->height_m = high[1] - low[1];
    return CLI_OK;
}

static int run_failed(const simulate_options *o, const simulation *s, palp_status status) {
    double at_mm = 1e3 * palp_network_depth(s->network), at_s = palp_network_time(s->network);
    const char *advice = status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED
                             ? (o->dt_ms > 0 ? "; try a smaller --dt-ms" : "; try a smaller --tolerance")
                             : "";
    int code = status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED
                   ? CLI_NOT_CONVERGED
                   : CLI_FAILURE;
    cli_failure(NAME, "%s: %s after %.4g mm (%.4g s)%s", o->model, palp_status_text(status), at_mm, at_s,
                advice);
    return code;
}

static palp_status press_with_bar(const simulate_options *o, simulation *s, frames *f) {
    progress bar;
    press_settings press = {1e-3 * o->dt_ms, o->tolerance, o->relaxed, o->like || o->sample_Hz > 0};
    press_watch watch = {&bar, add_frame, f};
    progress_start(&bar, "simulate");
    palp_status status = press_network(s->network, &s->path, &press, &watch, &s->curve, &s->info);
    progress_finish(&bar);
    return status;
}

int simulate_network(const simulate_options *o, simulation *s) {
    palp_network_settings settings = palp_network_settings_default();
    frames f = {.every = o->vtu_every};
    palp_error error = {PALP_OK, ""};
    settings.branch = (palp_branch)o->branch;
    settings.solver = (palp_solver)o->solver;
    palp_status status = palp_network_from_model(&s->model, s->mesh, 0, NULL, &settings, &s->network, &error);
    if (status == PALP_OK && o->vtu) {
        f.network = s->network;
        status = palp_vtu_open(o->vtu, "network", &f.series, &error);
    }
    if (status)
        return cli_status(NAME, status, &error);
    status = press_with_bar(o, s, &f);
    palp_status closed = palp_vtu_close(f.series, &error);
    if (f.status || closed)
        return cli_status(NAME, f.status ? f.status : closed, f.status ? &f.error : &error);
    s->buckled = palp_network_buckled(s->network, &s->stable_m, &s->unstable_m);
    if (s->buckled)
        press_warn_buckled(NAME, s->stable_m, s->unstable_m, s->height_m, settings.branch);
    if (s->info.inverted > 0)
        cli_warning(NAME,
                    "up to %zu of %zu tetrahedra of the mesh are inverted at once: their forces mean "
                    "nothing; press less",
                    s->info.inverted, palp_mesh_tetrahedron_count(s->mesh));
    return status ? run_failed(o, s, status) : CLI_OK;
}
