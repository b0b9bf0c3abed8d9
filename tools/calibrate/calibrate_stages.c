/* calibrate_stages.c: the two stages of palpate calibrate, and how well the result does. */
#include "calibrate.h"
#include "shared/press.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "calibrate";

enum { GUESS_STEPS = 20, LARGE = 16 };
static const double TICK_ERROR = 1e-4; /* of the force of a large lattice */

/* ---- shared ---- */

static int show_progress(void *user, double fraction, const palp_calibrate_iteration *last) {
    progress *bar = user;
    if (last)
        snprintf(bar->label, sizeof bar->label, "residual %.4g N", last->residual_N);
    progress_update(bar, fraction);
    return 0;
}

static void note_buckling(calibrate_state *s, bool buckled, double stable_m, double unstable_m) {
    if (buckled && !s->buckled) {
        s->buckled = true;
        s->stable_m = stable_m;
        s->unstable_m = unstable_m;
    }
}

static int stage_failed(const calibrate_options *o, const char *stage, palp_status status) {
    bool gave_up =
        status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED;
    const char *advice = gave_up ? "; try a smaller --depth-mm or --branch stable" : "";
    if (status == PALP_ERR_SINGULAR && o->mesh && !o->hex_diagonals)
        advice = "; a mesh of hexahedra needs --hex-diagonals";
    cli_failure(NAME, "%s stage: %s%s", stage, palp_status_text(status), advice);
    return gave_up ? CLI_NOT_CONVERGED : CLI_FAILURE;
}

/* ---- static ---- */

/* Nodes of a lattice's longest side; 0 for a mesh of a file. */
static size_t finest_side(const palp_mesh_source *source) {
    size_t finest = 0;
    for (size_t k = 0; k < 3 && source->kind == PALP_MESH_LATTICE; k++)
        finest = source->nodes[k] > finest ? source->nodes[k] : finest;
    return finest;
}

/* Large lattices are calibrated by a coarse one of the same box with COARSE nodes a side at most. */
enum { COARSE = 7 };

static bool is_large(const calibrate_state *s) {
    return finest_side(&s->source) >= LARGE;
}

/* A lattice of the same box with at most so many nodes a side. */
static palp_status coarse_network(const calibrate_options *o, const calibrate_state *s, size_t most,
                                  const palp_material *material, palp_network **network) {
    palp_mesh_source source = s->source;
    palp_model model = s->model;
    palp_mesh *mesh = NULL;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_of_model(&model);
    model.mesh = &source;
    for (size_t k = 0; k < 3; k++)
        source.nodes[k] = source.nodes[k] < most ? source.nodes[k] : most;
    palp_supports_default(supports);
    settings.density_kg_m3 = 0;
    settings.branch = (palp_branch)o->branch;
    palp_status status = palp_model_mesh(&model, &mesh, NULL);
    if (!status)
        status = palp_network_create(mesh, material, 2, supports, &settings, network, NULL);
    palp_mesh_free(mesh);
    return status;
}

/* Fits the law on a coarse lattice of the same box as a start, which saves many evaluations of the fine one.
 * The library scales it. */
static palp_status coarse_start(const calibrate_options *o, calibrate_state *s, palp_material *start) {
    enum { START = 5, FINE = 8 };
    palp_network *network = NULL;
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result = {0};
    if (finest_side(&s->source) < FINE)
        return PALP_OK;
    palp_status status = coarse_network(o, s, START, start, &network);
    if (!status)
        status =
            palp_calibrate_static(network, start, s->n_static, s->depth_m, s->force_N, &settings, &result);
    if (!status)
        start->law = result.material.law;
    palp_calibration_free(&result);
    palp_network_free(network);
    return status;
}

/* Calibrates a very large lattice by a coarse one (palp_calibrate_two_level). */
static palp_status two_level_static(const calibrate_options *o, calibrate_state *s,
                                    const palp_material *start, const palp_static_settings *settings) {
    palp_network *coarse = NULL;
    palp_status status = coarse_network(o, s, COARSE, start, &coarse);
    if (!status)
        status = palp_calibrate_two_level(s->network, coarse, start, s->n_static, s->depth_m, s->force_N,
                                          settings, &s->static_result);
    palp_network_free(coarse);
    return status;
}

/* The first guess: the law of --start, or the lumped law in the required form, unscaled for the thesis'
 * method. */
static palp_status static_start(const calibrate_options *o, calibrate_state *s, palp_material *start) {
    double strain_max = s->depth_m[s->n_static - 1] / s->height_m;
    const palp_law *law = o->start ? &s->model.material.law : &s->lumped.material.law;
    memset(start, 0, sizeof *start);
    start->formulation = (palp_formulation)o->formulation;
    palp_status status = o->law == LAW_SPLINE ? guess_spline(law, o->knots, strain_max, &start->law)
                                              : guess_polynomial(law, o->degree, strain_max, &start->law);
    if (status == PALP_OK && s->static_method == METHOD_NLOPT && !o->start)
        status = coarse_start(o, s, start);
    return status;
}

int calibrate_static(const calibrate_options *o, calibrate_state *s) {
    palp_static_settings settings = palp_static_settings_default();
    palp_material start;
    progress bar;
    palp_status status = static_start(o, s, &start);
    if (status)
        return cli_status_of(NAME, o->start ? o->start : o->lumped, status, NULL);
    progress_start(&bar, "static stage");
    settings.every_step = o->every_step;
    settings.progress = show_progress;
    settings.user = &bar;
    if (s->static_method == METHOD_FIXED_POINT)
        status = palp_thesis_fixed_point(s->network, &start, s->n_static, s->depth_m, s->force_N, &settings,
                                         &s->static_result);
    else if (is_large(s) && !o->every_step)
        status = two_level_static(o, s, &start, &settings);
    else
        status = palp_calibrate_static(s->network, &start, s->n_static, s->depth_m, s->force_N, &settings,
                                       &s->static_result);
    progress_finish(&bar);
    if (status)
        return stage_failed(o, "static", status);
    s->model.material = s->static_result.material;
    status = palp_network_set_material(s->network, &s->model.material);
    if (status)
        return stage_failed(o, "static", status);
    const palp_calibration *c = &s->static_result;
    double deepest_m = s->depth_m[s->n_static - 1];
    note_buckling(s, c->buckled, c->stable_m, c->unstable_m);
    if (c->reached_m < 0.999 * deepest_m)
        cli_warning(NAME,
                    "no equilibrium was found beyond %.4g mm: the law is not fitted from there to %.4g mm",
                    1e3 * c->reached_m, 1e3 * deepest_m);
    return CLI_OK;
}

/* ---- relaxation ---- */

static double stiffness_ratio(const palp_law *element, const palp_law *lumped, double strain_max) {
    double sum = 0;
    for (int i = 1; i <= GUESS_STEPS; i++) {
        double a, b, e = strain_max * i / GUESS_STEPS;
        palp_law_stiffness(element, e, &a, NULL);
        palp_law_stiffness(lumped, e, &b, NULL);
        sum += a / b;
    }
    return sum / GUESS_STEPS;
}

static double deepest_press(const calibrate_state *s) {
    double deepest = 0;
    for (size_t i = 0; i < s->n_presses; i++)
        deepest = fmax(deepest, s->press[i].depth_m);
    return deepest;
}

void calibrate_first_arms(const calibrate_options *o, const calibrate_state *s, palp_material *start) {
    size_t n = o->arms ? o->arms : s->lumped.material.n_arms;
    double ratio =
        stiffness_ratio(&s->model.material.law, &s->lumped.material.law, deepest_press(s) / s->height_m);
    bool three_phase = s->relaxation_method == METHOD_THREE_PHASE;
    bool arms_given = o->start && s->model.material.n_arms == n && n > 0;
    *start = s->model.material;
    start->formulation = (palp_formulation)o->formulation;
    if (!arms_given)
        guess_arms(&s->lumped.material, n, three_phase ? 1 : ratio, start);
}

static palp_status three_phases(const calibrate_options *o, calibrate_state *s, const palp_material *start,
                                const palp_target *target, progress *bar) {
    palp_three_phase_settings settings = palp_three_phase_settings_default();
    settings.dt_s = 1e-3 * o->dt_ms;
    settings.frozen_dwell = o->dwell;
    settings.progress = show_progress;
    settings.user = bar;
    return palp_thesis_three_phase(s->network, start, target, &settings, &s->relaxation_result);
}

static void scale_arms(palp_material *material, double factor) {
    for (size_t j = 0; j < material->n_arms; j++) {
        material->arms[j].stiffness_N *= factor;
        material->arms[j].viscosity_Ns *= factor;
    }
}

/* The same material on a coarse lattice of the same box, whose fewer elements bear more force each. */
static palp_status coarse_material(const calibrate_state *s, const palp_material *fine,
                                   palp_material *coarse) {
    double factor = 1;
    for (size_t k = 0; k < 3; k++)
        factor *= k == 1 || s->source.nodes[k] <= COARSE ? 1 : (double)s->source.nodes[k] / COARSE;
    *coarse = *fine;
    scale_arms(coarse, factor);
    return palp_law_scale(&fine->law, factor, &coarse->law);
}

/* Relaxed force of the network at CURVE depths, by realtime ticks, which need no factorization of the
 * network. */
enum { CURVE = 30 };
static palp_status relaxed_curve(const calibrate_state *s, const palp_material *material, double deepest_m,
                                 double depth_m[CURVE], double force_N[CURVE]) {
    const palp_realtime_settings realtime = palp_realtime_settings_default();
    const palp_budget budget = {.force_error = TICK_ERROR};
    palp_tick_info info;
    palp_realtime *rt = NULL;
    palp_status status = palp_network_set_material(s->network, material);
    if (!status)
        status = palp_realtime_create(s->network, &realtime, &rt);
    for (int i = 0; i < CURVE && !status; i++) {
        depth_m[i] = deepest_m * (i + 1) / CURVE;
        status = palp_realtime_step(rt, depth_m[i], INFINITY, &budget, &info);
        if (!status && !info.converged)
            status = PALP_ERR_NOT_CONVERGED;
        force_N[i] = info.force_N;
    }
    palp_realtime_free(rt);
    return status;
}

/* For a large lattice: fits a coarse one to the large one's static curve, then its arms; scales the arms by
 * the ratio of both laws. */
static palp_status arms_of_coarse(const calibrate_options *o, calibrate_state *s, const palp_material *start,
                                  double deepest_m, const palp_target *targets,
                                  const palp_relaxation_settings *settings) {
    const palp_static_settings how = palp_static_settings_default();
    const double strain = deepest_m / s->height_m;
    double depth_m[CURVE], force_N[CURVE];
    palp_network *coarse = NULL;
    palp_material first;
    palp_calibration own = {0}, *r = &s->relaxation_result;
    palp_status status = relaxed_curve(s, start, deepest_m, depth_m, force_N);
    if (!status)
        status = coarse_material(s, start, &first);
    if (!status)
        status = coarse_network(o, s, COARSE, &first, &coarse);
    if (!status)
        status = palp_calibrate_static(coarse, &first, CURVE, depth_m, force_N, &how, &own);
    if (!status)
        status = palp_calibrate_relaxation(coarse, &own.material, s->n_presses, targets, settings, r);
    palp_network_free(coarse);
    if (!status) {
        double scale = stiffness_ratio(&r->material.law, &own.material.law, strain);
        scale_arms(&r->material, stiffness_ratio(&start->law, &own.material.law, strain));
        status = palp_law_scale(&start->law, scale, &r->material.law);
    }
    palp_calibration_free(&own);
    return status;
}

static palp_status fit_arms(const calibrate_options *o, calibrate_state *s, const palp_material *start,
                            const palp_target *targets, progress *bar) {
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    settings.fit_beta = o->strain_dependent;
    settings.dt_s = 1e-3 * o->dt_ms;
    settings.progress = show_progress;
    settings.user = bar;
    if (is_large(s))
        return arms_of_coarse(o, s, start, deepest_press(s), targets, &settings);
    return palp_calibrate_relaxation(s->network, start, s->n_presses, targets, &settings,
                                     &s->relaxation_result);
}

int calibrate_relaxation(const calibrate_options *o, calibrate_state *s) {
    palp_target targets[PRESSES_MAX];
    palp_material start;
    progress bar;
    if (s->relaxation_method == METHOD_THREE_PHASE && s->n_presses > 1)
        return cli_usage_error(NAME, "--method three_phase takes one run; run it once for each");
    if (is_large(s) && s->relaxation_method != METHOD_THREE_PHASE)
        cli_warning(
            NAME, "the arms are fitted on a lattice of %d nodes a side, not on the large one (doc/meshes.md)",
            COARSE);
    calibrate_first_arms(o, s, &start);
    for (size_t i = 0; i < s->n_presses; i++) {
        const press_target *press = &s->press[i];
        targets[i] = (palp_target){.path = press->path,
                                   .n = press->target.n,
                                   .time_s = press->target.time_s,
                                   .force_N = press->target.force_N};
    }
    progress_start(&bar, "relaxation stage");
    palp_status status = s->relaxation_method == METHOD_THREE_PHASE
                             ? three_phases(o, s, &start, targets, &bar)
                             : fit_arms(o, s, &start, targets, &bar);
    progress_finish(&bar);
    if (status)
        return stage_failed(o, "relaxation", status);
    s->model.material = s->relaxation_result.material;
    return CLI_OK;
}

/* ---- the calibrated network against each target ---- */

static palp_status wanted_forces(const calibrate_state *s, press_target *press) {
    const record *run = &press->network;
    press->wanted_N = malloc(run->n * sizeof *press->wanted_N);
    if (!press->wanted_N)
        return PALP_ERR_NO_MEMORY;
    if (!press->measured)
        return palp_lumped_run(&s->lumped.material, s->lumped.height_m, run->n, run->time_s, run->depth_m,
                               press->wanted_N);
    for (size_t i = 0; i < run->n; i++)
        press->wanted_N[i] = record_at(&press->target, run->time_s[i]);
    return PALP_OK;
}

static int note_strain(void *user) {
    calibrate_state *s = user;
    s->strain_max = fmax(s->strain_max, palp_network_strain_max(s->network));
    return 0;
}

/* A large network is run by realtime ticks, which need no factorization. */
static palp_status press_large(calibrate_state *s, press_target *press, progress *bar) {
    const press_settings settings = {.tolerance = 1e-4};
    const palp_realtime_settings realtime = palp_realtime_settings_default();
    const palp_budget budget = {.force_error = TICK_ERROR};
    const palp_path *path = &press->path;
    palp_realtime *rt = NULL;
    palp_tick_info info = {.converged = true};
    double *time_s = NULL;
    size_t n = 0;
    palp_status status = press_times(path, &settings, &n, &time_s);
    if (status == PALP_OK)
        status = palp_realtime_create(s->network, &realtime, &rt);
    for (size_t i = 0; i < n && status == PALP_OK; i++) {
        double depth_m = palp_path_at(path, time_s[i]);
        if (i > 0)
            status = palp_realtime_step(rt, depth_m, time_s[i] - time_s[i - 1], &budget, &info);
        if (status == PALP_OK && !info.converged)
            status = PALP_ERR_NOT_CONVERGED;
        if (status == PALP_OK)
            status = record_add(&press->network, time_s[i], depth_m, info.force_N);
        note_strain(s);
        progress_update(bar, (double)i / (double)n);
    }
    palp_realtime_free(rt);
    free(time_s);
    return status;
}

static palp_status compare(calibrate_state *s, press_target *press, progress *bar) {
    const press_settings settings = {.tolerance = 1e-4};
    const press_watch watch = {bar, note_strain, s};
    palp_run_info info;
    palp_network_reset(s->network);
    palp_status status =
        is_large(s) ? press_large(s, press, bar)
                    : press_network(s->network, &press->path, &settings, &watch, &press->network, &info);
    double stable_m = 0, unstable_m = 0;
    bool buckled = palp_network_buckled(s->network, &stable_m, &unstable_m);
    note_buckling(s, buckled, stable_m, unstable_m);
    if (status == PALP_OK)
        status = wanted_forces(s, press);
    for (size_t i = 0; status == PALP_OK && i < press->network.n; i++) {
        double error = fabs(press->network.force_N[i] - press->wanted_N[i]);
        press->max_error_percent = fmax(press->max_error_percent, 100 * error / press->peak_N);
    }
    return status;
}

/* Sets strain_max of a fitted law to the largest element strain; the law of --start keeps its own. */
static void limit_range(calibrate_state *s) {
    palp_law *law = &s->model.material.law;
    double top = fmax(s->static_result.strain_max, s->strain_max);
    if (!s->does_static && !s->tools) {
        if (palp_law_beyond(law, s->strain_max) > 1e-9)
            press_warn_beyond(NAME, law, s->strain_max, -1);
        return;
    }
    if (palp_law_limit(law, top) || law->strain_max < top) {
        palp_law_limit(law, 0);
        cli_warning(NAME,
                    "an element's force no longer rises at the largest strain of %.3g: the model has no "
                    "strain_max",
                    top);
    }
}

int calibrate_compare(const calibrate_options *o, calibrate_state *s) {
    progress bar;
    palp_status status = palp_network_set_material(s->network, &s->model.material);
    for (size_t i = 0; status == PALP_OK && i < s->n_presses && !s->tools; i++) { /* the others are met */
        progress_start(&bar, "checking");
        status = compare(s, &s->press[i], &bar);
        progress_finish(&bar);
    }
    if (status)
        return stage_failed(o, "relaxation", status);
    limit_range(s);
    if (s->buckled)
        press_warn_buckled(NAME, s->stable_m, s->unstable_m, s->height_m, (palp_branch)o->branch);
    return CLI_OK;
}
