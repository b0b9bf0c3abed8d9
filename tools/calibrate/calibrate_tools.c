/* calibrate_tools.c: the law and the arms from runs of plates and tools at once. */
#include "calibrate.h"
#include "shared/press.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "calibrate";

/* ---- what is given ---- */

static int check_given(const calibrate_options *o, const calibrate_state *s) {
    bool dwells = false;
    for (size_t i = 0; i < s->n_presses; i++)
        dwells = dwells || !s->press[i].relaxed;
    if (o->stage == STAGE_RELAXATION)
        return cli_usage_error(NAME,
                               "runs of a tool give law and arms at once; leave out --stage relaxation");
    if (o->method != METHOD_NLOPT || o->formulation != PALP_HISTORY)
        return cli_usage_error(NAME, "runs of a tool need --method nlopt and --formulation history");
    if (o->stage == STAGE_STATIC && dwells)
        return cli_usage_error(NAME, "--stage static takes runs of one press without a dwell");
    if (o->stage == STAGE_ALL && !dwells)
        return cli_usage_error(NAME, "no run has a dwell, which the arms need; use --stage static");
    return CLI_OK;
}

/* The law of --start or of the lumped model in the wanted form, with its arms. */
static palp_status first_guess(const calibrate_options *o, calibrate_state *s) {
    const palp_law *law = o->start ? &s->model.material.law : &s->lumped.material.law;
    palp_material *start = &s->model.material;
    double deepest = 0;
    for (size_t i = 0; i < s->n_presses; i++)
        deepest = fmax(deepest, s->press[i].depth_m);
    palp_status status = o->law == LAW_SPLINE
                             ? guess_spline(law, o->knots, deepest / s->height_m, &start->law)
                             : guess_polynomial(law, o->degree, deepest / s->height_m, &start->law);
    if (status == PALP_OK && o->stage == STAGE_ALL)
        calibrate_first_arms(o, s, start);
    return status;
}

/* ---- what is found ---- */

/* The network's forces beside those wanted. */
static palp_status keep_forces(calibrate_state *s) {
    const double *force_N = s->relaxation_result.force_N;
    palp_status status = PALP_OK;
    for (size_t k = 0; k < s->n_presses; k++) {
        press_target *press = &s->press[k];
        const record *target = &press->target;
        press->wanted_N = malloc(target->n * sizeof *press->wanted_N);
        if (!press->wanted_N)
            return PALP_ERR_NO_MEMORY;
        for (size_t i = 0; status == PALP_OK && i < target->n; i++, force_N++) {
            press->wanted_N[i] = target->force_N[i];
            press->max_error_percent =
                fmax(press->max_error_percent, 100 * fabs(*force_N - target->force_N[i]) / press->peak_N);
            status = record_add(&press->network, target->time_s[i], target->depth_m[i], *force_N);
        }
    }
    return status;
}

static int show(void *user, double fraction, const palp_calibrate_iteration *last) {
    progress *bar = user;
    snprintf(bar->label, sizeof bar->label, "residual %.4g N", last->residual_N);
    progress_update(bar, fraction);
    return 0;
}

int calibrate_tools(const calibrate_options *o, calibrate_state *s) {
    palp_press_target targets[PRESSES_MAX];
    palp_presses_settings settings = palp_presses_settings_default();
    progress bar;
    int code = check_given(o, s);
    if (code)
        return code;
    for (size_t i = 0; i < s->n_presses; i++) {
        const press_target *press = &s->press[i];
        const double *at = press->tip_m;
        targets[i] = (palp_press_target){.plate = press->tip_radius_m == 0,
                                         .tool = press_sphere(s->mesh, press->tip_radius_m, at[0], at[1]),
                                         .relaxed = press->relaxed,
                                         .n = press->target.n,
                                         .time_s = press->target.time_s,
                                         .depth_m = press->target.depth_m,
                                         .force_N = press->target.force_N};
    }
    for (size_t i = 0; i < s->n_presses; i++)
        if (!targets[i].plate && !isfinite(targets[i].tool.position_m[1]))
            return cli_failure(NAME, "nothing of the network is below the sphere at x = %.4g, z = %.4g mm",
                               1e3 * s->press[i].tip_m[0], 1e3 * s->press[i].tip_m[1]);
    palp_status status = first_guess(o, s);
    progress_start(&bar, "plates and spheres");
    settings.fit_poisson = s->fits_poisson;
    memcpy(settings.fit_region, s->fits_region, sizeof settings.fit_region);
    settings.fit_beta = o->strain_dependent && o->stage == STAGE_ALL;
    settings.progress = show;
    settings.user = &bar;
    if (status == PALP_OK)
        status = palp_calibrate_presses(&s->model, s->mesh, s->n_presses, targets, &settings,
                                        &s->relaxation_result);
    progress_finish(&bar);
    if (status == PALP_OK)
        status = keep_forces(s);
    for (size_t r = 0; status == PALP_OK && r < s->source.n_regions; r++)
        s->source.regions[r].stiffness = s->relaxation_result.region_stiffness[r];
    if (status == PALP_OK)
        s->strain_max = s->relaxation_result.strain_max;
    return status ? cli_status(NAME, status, NULL) : CLI_OK;
}
