/* calibrate_report.c: what palpate calibrate found, as JSON or as text. */
#include "calibrate.h"
#include "shared/json_out.h"
#include "shared/law_text.h"
#include "shared/page.h"

#include <math.h>

static const char NAME[] = "calibrate";

static const char *method_name(calibrate_method method) {
    static const char *const names[] = {"nlopt", "fixed_point", "three_phase"};
    return names[method];
}

/* ---- JSON ---- */

static json_t *arms_json(const palp_material *material) {
    json_t *list = json_array();
    for (size_t j = 0; j < material->n_arms; j++) {
        const palp_arm *arm = &material->arms[j];
        json_t *entry =
            json_pack("{s:f, s:f}", "stiffness_N", arm->stiffness_N, "viscosity_Ns", arm->viscosity_Ns);
        if (arm->beta != 0)
            json_object_set_new(entry, "beta", json_real(arm->beta));
        if (arm->gamma != 0)
            json_object_set_new(entry, "gamma", json_real(arm->gamma));
        json_array_append_new(list, entry);
    }
    return list;
}

static json_t *iteration_json(calibrate_method method, bool relaxation, const palp_calibrate_iteration *it) {
    json_t *entry = json_object();
    if (method == METHOD_THREE_PHASE) {
        json_object_set_new(entry, "phase", json_integer(it->phase));
        json_figures(entry, {"stiffness_N", it->material.arms[0].stiffness_N},
                     {"viscosity_Ns", it->material.arms[0].viscosity_Ns},
                     {"peak_error_percent", it->peak_error_percent},
                     {"steady_time_error_percent", it->steady_time_error_percent},
                     {"steady_force_error_percent", it->steady_force_error_percent});
        if (it->phase == 3) {
            json_t *law = json_object();
            json_add_law(law, &it->material.law);
            json_object_set_new(entry, "law", law);
        }
        return entry;
    }
    json_figures(entry, {"residual", it->residual_N});
    json_add_law(entry, &it->material.law);
    if (relaxation) {
        json_object_set_new(entry, "relative_rms_percent", json_real(100 * it->relative_rms));
        json_object_set_new(entry, "arms", arms_json(&it->material));
    }
    return entry;
}

static json_t *depths_json(const calibrate_state *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < s->n_presses; i++) {
        const press_target *p = &s->press[i];
        json_t *entry = json_pack("{s:f, s:f, s:f}", "depth_mm", 1e3 * p->depth_m, "peak_N", p->peak_N,
                                  "max_error_percent", p->max_error_percent);
        if (p->tip_radius_m > 0)
            json_object_set_new(entry, "tip_radius_mm", json_real(1e3 * p->tip_radius_m));
        json_array_append_new(list, entry);
    }
    return list;
}

static void add_stage(json_t *to, const calibrate_state *s, bool relaxation) {
    const palp_calibration *c = relaxation ? &s->relaxation_result : &s->static_result;
    calibrate_method method = relaxation ? s->relaxation_method : s->static_method;
    json_t *iterations = json_array();
    json_object_set_new(to, "method", json_string(method_name(method)));
    json_figures(to, {"residual", c->residual_N});
    json_object_set_new(to, "converged", json_boolean(c->converged));
    json_add_law(to, &c->material.law);
    json_object_set_new(to, "arms", arms_json(&c->material));
    if (relaxation) {
        json_object_set_new(to, "depths", depths_json(s));
    } else {
        json_object_set_new(to, "samples", json_integer((json_int_t)s->n_static));
        json_object_set_new(to, "depth_mm", json_real(1e3 * s->depth_m[s->n_static - 1]));
        json_object_set_new(to, "reached_depth_mm", json_real(1e3 * c->reached_m));
    }
    for (size_t i = 0; i < c->n_iterations; i++)
        json_array_append_new(iterations, iteration_json(method, relaxation, &c->iterations[i]));
    json_object_set_new(to, "iterations", iterations);
}

static json_t *nodes_json(const calibrate_state *s) {
    const palp_mesh_source *mesh = &s->source;
    if (mesh->kind != PALP_MESH_LATTICE)
        return json_integer((json_int_t)palp_mesh_node_count(s->mesh));
    return json_pack("[I, I, I]", (json_int_t)mesh->nodes[0], (json_int_t)mesh->nodes[1],
                     (json_int_t)mesh->nodes[2]);
}

static json_t *whole_json(const calibrate_options *o, const calibrate_state *s) {
    static const char *const stages[] = {"static", "relaxation", "all"};
    json_t *all = json_object();
    json_object_set_new(all, "palpate", json_pack("{s:i, s:s}", "calibrate", 1, "version", palp_version()));
    json_object_set_new(all, "command", json_text(o->command));
    json_object_set_new(all, "stage", json_string(stages[o->stage]));
    json_object_set_new(all, "formulation",
                        json_string(o->formulation == PALP_HISTORY ? "history" : "sedef2008"));
    json_object_set_new(all, "nodes", nodes_json(s));
    add_stage(all, s, s->does_relaxation);
    if (s->model.material.law.strain_max > 0) { /* of the model; laws of stages and iterations carry none */
        json_object_set_new(all, "strain_max", json_real(s->model.material.law.strain_max));
    }
    if (s->fits_poisson)
        json_object_set_new(all, "poisson_ratio", json_real(s->model.poisson_ratio));
    json_t *regions = o->regions ? json_array() : NULL;
    if (regions)
        json_object_set_new(all, "regions", regions);
    for (size_t r = 0; r < s->source.n_regions; r++)
        if (s->fits_region[r])
            json_array_append_new(regions, json_pack("{s:s, s:f}", "name", s->source.regions[r].name,
                                                     "stiffness", s->source.regions[r].stiffness));
    if (s->buckled)
        json_object_set_new(
            all, "buckling",
            json_pack("{s:f, s:f}", "stable_mm", 1e3 * s->stable_m, "unstable_mm", 1e3 * s->unstable_m));
    if (s->does_static && s->does_relaxation) {
        json_t *first = json_object(), *second = json_object();
        add_stage(first, s, false);
        add_stage(second, s, true);
        json_object_set_new(all, "static", first);
        json_object_set_new(all, "relaxation", second);
    }
    return all;
}

/* ---- text ---- */

static void print_arms(const palp_material *material) {
    for (size_t j = 0; j < material->n_arms; j++) {
        const palp_arm *arm = &material->arms[j];
        printf("  arm %zu: %.6g N, %.6g N s (%.4g s)", j + 1, arm->stiffness_N, arm->viscosity_Ns,
               arm->viscosity_Ns / arm->stiffness_N);
        printf(arm->beta != 0 ? ", beta %.4g\n" : "\n", arm->beta);
    }
}

/* A percentage, or "-" if the phase does not use it. */
static void print_percent(double value) {
    if (isfinite(value))
        printf(" %12.2f", value);
    else
        printf(" %12s", "-");
}

static void print_iterations(const palp_calibration *c, calibrate_method method, bool relaxation) {
    bool phases = method == METHOD_THREE_PHASE;
    printf(phases       ? "  phase         K1 (N)     b1 (N s)   peak err %%   time err %%  force err %%\n"
           : relaxation ? "  evaluation   rms error (%% of the peak)\n"
                        : "  evaluation   residual (N)\n");
    for (size_t i = 0; i < c->n_iterations; i++) {
        const palp_calibrate_iteration *it = &c->iterations[i];
        if (phases) {
            printf("  %5d %14.6f %12.6f", it->phase, it->material.arms[0].stiffness_N,
                   it->material.arms[0].viscosity_Ns);
            print_percent(it->peak_error_percent);
            print_percent(it->steady_time_error_percent);
            print_percent(it->steady_force_error_percent);
            putchar('\n');
        } else {
            printf("  %10zu %14.6g\n", i + 1, relaxation ? 100 * it->relative_rms : it->residual_N);
        }
    }
}

static void print_static(const calibrate_state *s) {
    const palp_calibration *c = &s->static_result;
    printf("Static stage (%s), %zu samples to %.4g mm\n", method_name(s->static_method), s->n_static,
           1e3 * s->depth_m[s->n_static - 1]);
    print_iterations(c, s->static_method, false);
    printf("  residual %.5g N, %.3g N a sample\n", c->residual_N, c->residual_N / sqrt((double)s->n_static));
    law_text_print(&c->material.law);
}

static void print_relaxation(const calibrate_state *s) {
    const palp_calibration *c = &s->relaxation_result;
    printf(s->tools ? "Plates and spheres at once (%s)\n" : "Relaxation stage (%s)\n",
           method_name(s->relaxation_method));
    print_iterations(c, s->relaxation_method, true);
    law_text_print(&c->material.law);
    print_arms(&c->material);
    if (s->fits_poisson)
        printf("  Poisson's ratio %.3f\n", s->model.poisson_ratio);
    for (size_t r = 0; r < s->source.n_regions; r++)
        if (s->fits_region[r])
            printf("  region %s: %.4g times as stiff as the tissue around\n", s->source.regions[r].name,
                   s->source.regions[r].stiffness);
    printf("  depth (mm)   peak (N)   largest error (%% of the peak)\n");
    for (size_t i = 0; i < s->n_presses; i++) {
        const press_target *p = &s->press[i];
        printf("  %10.4g %10.5g %10.3f", 1e3 * p->depth_m, p->peak_N, p->max_error_percent);
        if (p->tip_radius_m > 0)
            printf("   sphere of %.4g mm", 1e3 * p->tip_radius_m);
        putchar('\n');
    }
}

int calibrate_report(const calibrate_options *o, const calibrate_state *s) {
    bool drawn = o->result || o->report;
    int code = page_result(NAME, whole_json(o, s), drawn ? calibrate_figures(s) : NULL, o->json, o->result,
                           o->report);
    if (code || o->json)
        return code;
    if (s->does_static)
        print_static(s);
    if (s->does_relaxation)
        print_relaxation(s);
    if (o->out)
        cli_say(stdout, "Written to %s", o->out);
    return cli_flush(NAME);
}
