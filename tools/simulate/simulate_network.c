/* simulate_network.c: palpate simulate's run of a network, with frames for ParaView. */
#include "simulate.h"

#include <math.h>

static const char NAME[] = "simulate";
static const double CHECKED_WELL = 0.1; /* an error of the force above which a run says so */

typedef struct frames {
    const simulate_options *options;
    const simulation *run;
    palp_vtu *series;
    const palp_network *network;
    size_t every, step, steps;
    palp_status status;
    palp_error error;
} frames;

static int add_frame(void *user) {
    frames *f = user;
    if (f->series && f->step++ % f->every == 0)
        f->status = palp_vtu_add(f->series, f->network, &f->error);
    if (!f->status && f->options->checkpoint && ++f->steps % f->options->checkpoint_every == 0)
        f->status = simulate_ranks_save(f->options, f->run, &f->error);
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

/* ---- a sphere in place of the plate ---- */

int simulate_tip(const simulate_options *o, simulation *s) {
    const char *kind = NULL;
    double radius_mm = o->tip_radius_mm;
    palp_tip_kind tip = o->tip == 1 ? PALP_TIP_SPHERE : PALP_TIP_PLATE;
    bool network = s->model.kind == PALP_MODEL_NETWORK && !s->reduced;
    if (!network && (o->tip == 1 || radius_mm > 0))
        return cli_usage_error(NAME, "--tip sphere needs a network, which %s is not", o->model);
    if (!network)
        return CLI_OK; /* a lumped model is that of the tip whose runs it was fitted to */
    if (o->tip < 0 && s->like && palp_experiment_get_string(s->like, "tip.kind", &kind) == PALP_OK &&
        (!palp_tip_find(kind, &tip) || tip == PALP_TIP_FLAT || tip == PALP_TIP_CONE))
        return cli_failure(NAME, "%s: its tip.kind \"%s\" presses no network; only plate and sphere do",
                           o->like, kind);
    if (tip == PALP_TIP_PLATE)
        return radius_mm > 0 ? cli_usage_error(NAME, "--tip-radius-mm goes with --tip sphere") : CLI_OK;
    if (radius_mm <= 0 && s->like)
        palp_experiment_get_number(s->like, "tip.radius_mm", &radius_mm);
    if (!(radius_mm > 0))
        return cli_usage_error(NAME, "a sphere needs --tip-radius-mm");
    if (s->model.n_effects + s->model.n_free > 0 || o->protocol == 3)
        return cli_usage_error(NAME, "%s does not go with a sphere",
                               o->protocol == 3 ? "--protocol creep" : "a model with effects or free terms");
    s->tip_radius_m = 1e-3 * radius_mm;
    for (int k = 0; k < 2; k++) {
        double place_mm = o->tip_mm[k];
        if (isnan(place_mm) && s->like)
            palp_experiment_get_number(s->like, k ? "tip.z_mm" : "tip.x_mm", &place_mm);
        s->tip_m[k] = 1e-3 * place_mm;
    }
    if (isnan(s->tip_m[0]) != isnan(s->tip_m[1]))
        return cli_usage_error(NAME, "the place of a sphere needs both --tip-x-mm and --tip-z-mm");
    return CLI_OK;
}

static void judge_tip(const simulate_options *o, const simulation *s) {
    double error = 0, deepest = 0;
    for (size_t i = 0; i < s->curve.n; i++)
        deepest = fmax(deepest, s->curve.depth_m[i]);
    palp_status status = palp_model_tool_error(&s->model, s->tip_radius_m, deepest, &error);
    if (status == PALP_ERR_UNSUPPORTED)
        cli_warning(NAME, "%s: was not checked under tools; palpate calibrate --check does", o->model);
    else if (status)
        cli_warning(NAME, "%s: was not checked for a sphere of %.4g mm pressed %.4g mm deep", o->model,
                    1e3 * s->tip_radius_m, 1e3 * deepest);
    else if (error > CHECKED_WELL)
        cli_warning(NAME, "%s: the force of a sphere of %.4g mm pressed %.4g mm deep is off by up to %.3g %%",
                    o->model, 1e3 * s->tip_radius_m, 1e3 * deepest, 100 * error);
}

static palp_status press_with_bar(const simulate_options *o, simulation *s, frames *f) {
    progress bar;
    press_settings press = {1e-3 * o->dt_ms, o->tolerance, o->relaxed, o->like || o->sample_Hz > 0, 0};
    if (o->restart && s->curve.n > 0)
        press.from_s = s->curve.time_s[s->curve.n - 1];
    press_watch watch = {&bar, add_frame, f};
    progress_start(&bar, "simulate");
    palp_status status;
    if (s->tip_radius_m > 0) {
        const palp_tool sphere = press_sphere(s->mesh, s->tip_radius_m, s->tip_m[0], s->tip_m[1]);
        status = press_tool(s->network, &sphere, &s->path, &press, &watch, &s->curve, &s->info);
    } else
        status = press_network(s->network, &s->path, &press, &watch, &s->curve, &s->info);
    progress_finish(&bar);
    return status;
}

int simulate_network(const simulate_options *o, simulation *s) {
    palp_network_settings settings = palp_network_settings_default();
    frames f = {.options = o, .run = s, .every = o->vtu_every};
    palp_error error = {PALP_OK, ""};
    settings.branch = (palp_branch)o->branch;
    settings.solver = (palp_solver)o->solver;
    const palp_contact_settings touch = palp_contact_settings_default();
    palp_support supports[2];
    palp_supports_default(supports);
    bool tip = s->tip_radius_m > 0; /* on the bottom alone */
    if (tip && !isfinite(press_sphere(s->mesh, s->tip_radius_m, s->tip_m[0], s->tip_m[1]).position_m[1]))
        return cli_failure(NAME, "%s: nothing of it is below a sphere at x = %.4g, z = %.4g mm", o->model,
                           1e3 * s->tip_m[0], 1e3 * s->tip_m[1]);
    palp_status status = s->ranks ? palp_ranks_network(s->ranks, &s->model, s->mesh, tip ? 1 : 2, supports,
                                                       &settings, tip, &s->network, &error)
                                  : palp_network_from_model(&s->model, s->mesh, tip ? 1 : 2, supports,
                                                            &settings, &s->network, &error);
    const size_t n_tetrahedra = palp_mesh_tetrahedron_count(s->mesh);
    if (s->ranks && !tip) { /* each process has its part, and may need the memory */
        palp_mesh_free(s->mesh);
        s->mesh = NULL;
    }
    if (status == PALP_OK && o->restart)
        status = simulate_ranks_restore(o, s, &error);
    if (status == PALP_OK && tip)
        status = palp_network_enable_tools(s->network, 1, 0, &touch);
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
    if (tip && !status)
        judge_tip(o, s);
    s->buckled = palp_network_buckled(s->network, &s->stable_m, &s->unstable_m);
    if (s->buckled)
        press_warn_buckled(NAME, s->stable_m, s->unstable_m, s->height_m, settings.branch);
    if (s->info.inverted > 0)
        cli_warning(NAME,
                    "up to %zu of %zu tetrahedra of the mesh are inverted at once: their forces mean "
                    "nothing; press less",
                    s->info.inverted, n_tetrahedra);
    return status ? run_failed(o, s, status) : CLI_OK;
}
