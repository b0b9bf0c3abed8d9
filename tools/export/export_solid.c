/* export_solid.c: the targets, the scene of one, and the report of its error. */
#include "export.h"

#include "shared/json_out.h"
#include "shared/opening.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ABAQUS_LAWS                                                                                          \
    3, {                                                                                                     \
        {PALP_SOLID_YEOH, "yeoh", "YEOH"}, {PALP_SOLID_NEO_HOOKEAN, "neo-hookean", "NEO HOOKE"}, {           \
            PALP_SOLID_MOONEY_RIVLIN, "mooney-rivlin", "MOONEY-RIVLIN"                                       \
        }                                                                                                    \
    }

const export_target export_targets[EXPORT_TARGETS] = {
    {"calculix", PALP_SOLID_ELASTIC, PALP_ARMS_MAX, true, ABAQUS_LAWS, export_calculix},
    {"abaqus", PALP_SOLID_PRONY, PALP_ARMS_MAX, true, ABAQUS_LAWS, export_abaqus},
    {"febio",
     PALP_SOLID_PRONY,
     6,
     true,
     1,
     {{PALP_SOLID_NEO_HOOKEAN_LOG, "neo-hookean", "neo-Hookean"}},
     export_febio},
    {"sofa",
     PALP_SOLID_RAYLEIGH,
     PALP_ARMS_MAX,
     false,
     2,
     {{PALP_SOLID_NEO_HOOKEAN_STABLE, "neo-hookean", "StableNeoHookean"},
      {PALP_SOLID_MOONEY_RIVLIN_LOG, "mooney-rivlin", "MooneyRivlin"}},
     export_sofa},
    {"mujoco",
     PALP_SOLID_MATERIAL,
     PALP_ARMS_MAX,
     true,
     1,
     {{PALP_SOLID_ST_VENANT, "st-venant", "Saint Venant-Kirchhoff"}},
     export_mujoco},
    {"newton",
     PALP_SOLID_SHEAR,
     PALP_ARMS_MAX,
     false,
     1,
     {{PALP_SOLID_NEO_HOOKEAN_STABLE, "neo-hookean", "stable neo-Hookean"}},
     export_newton},
    {"vega",
     PALP_SOLID_RAYLEIGH,
     PALP_ARMS_MAX,
     true,
     2,
     {{PALP_SOLID_NEO_HOOKEAN_LOG, "neo-hookean", "neoHookean"}, {PALP_SOLID_ST_VENANT, "st-venant", "StVK"}},
     export_vega},
};

/* ---- the result ---- */

static json_t *arms_of(const palp_solid *solid) {
    json_t *arms = json_array();
    for (size_t j = 0; j < solid->n_arms && solid->time == PALP_SOLID_PRONY; j++) {
        json_t *arm = json_object();
        json_figures(arm, {"share", solid->share[j]}, {"tau_s", solid->tau_s[j]});
        json_array_append_new(arms, arm);
    }
    return arms;
}

static int report(const export_options *o, const export_scene *s) {
    if (!o->json) {
        export_state(s, "palpate export: ", stderr);
        return CLI_OK;
    }
    const palp_solid *solid = &s->solid;
    json_t *result = json_pack("{s:{s:i}, s:o, s:s, s:s, s:s, s:s, s:i}", "palpate", "export", 1, "model",
                               json_text(s->model), "to", s->target->name, "law", export_law_of(s)->option,
                               "plates", solid->slides ? "slide" : "hold", "against",
                               s->n_runs > 0 ? "recordings" : "model", "runs", (int)s->n_runs);
    if (!result)
        return json_print("export", NULL);
    json_object_set_new(result, "c_Pa", json_numbers(palp_solid_count(solid->law), solid->c_Pa));
    json_object_set_new(result, "arms", arms_of(solid));
    json_figures(result, {"poisson_ratio", solid->poisson}, {"shear_Pa", palp_solid_shear(solid)},
                 {"bulk_Pa", palp_solid_bulk(solid)}, {"lambda_Pa", palp_solid_lambda(solid)},
                 {"depth_mm", 1e3 * s->depth_m}, {"ramp_s", s->ramp_s}, {"hold_s", s->hold_s},
                 {"ramp_N", s->ramp_N}, {"dwell_N", s->hold_N}, {"peak_N", s->info.peak_N},
                 {"worst_N", s->info.worst_N}, {"rms_N", s->info.rms_N});
    json_object_set_new(result, "damping_s",
                        solid->time == PALP_SOLID_RAYLEIGH || solid->time == PALP_SOLID_MATERIAL
                            ? json_real(solid->damping)
                            : json_null());
    json_object_set_new(result, "viscosity_Pa_s",
                        solid->time == PALP_SOLID_SHEAR ? json_real(solid->damping) : json_null());
    json_object_set_new(result, "model_rms_N", json_number_or_null(s->lumped_rms_N));
    json_object_set_new(result, "samples", json_integer((json_int_t)s->info.n));
    json_object_set_new(result, "nodes", json_integer((json_int_t)palp_mesh_node_count(s->mesh)));
    json_object_set_new(result, "tetrahedra", json_integer((json_int_t)palp_mesh_tetrahedron_count(s->mesh)));
    return json_print("export", result);
}

/* ---- the scene ---- */

static int choose_law(const export_options *o, export_scene *s) {
    static const char *const option[] = {"yeoh", "neo-hookean", "mooney-rivlin", "st-venant"};
    const export_target *t = s->target;
    s->solid.law = t->laws[0].law;
    for (size_t k = 0; o->law >= 0; k++) {
        if (k == t->n_laws)
            return cli_usage_error("export", "%s has no law %s here; palpate export --help lists them",
                                   t->name, option[o->law]);
        if (strcmp(t->laws[k].option, option[o->law]) == 0) {
            s->solid.law = t->laws[k].law;
            break;
        }
    }
    return CLI_OK;
}

/* The model's mesh; of a lumped model a block of its height and section. */
static int make_mesh(const export_options *o, const palp_model *model, export_scene *s) {
    palp_error error = {PALP_OK, ""};
    palp_status status;
    if (model->kind == PALP_MODEL_NETWORK) {
        if (model->mesh->n_regions > 0)
            return cli_failure(
                "export", "%s: has regions; a solid is exported for models of one material only", s->model);
        status = palp_model_mesh(model, &s->mesh, &error);
    } else {
        if (!(model->radius_m > 0))
            return cli_failure("export", "%s: a lumped model without radius_mm has no section for a mesh",
                               s->model);
        const double pi = 3.14159265358979323846, side = sqrt(pi) * model->radius_m;
        const size_t nodes[3] = {o->nodes, o->nodes, o->nodes};
        const double size[3] = {side, model->height_m, side};
        status = palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &s->mesh);
    }
    if (status)
        return cli_status("export", status, &error);
    double low[3], high[3];
    palp_mesh_bounds(s->mesh, low, high);
    s->height_m = high[1] - low[1];
    s->held = malloc(palp_mesh_node_count(s->mesh));
    status = s->held ? palp_solid_supports(s->mesh, o->slides, s->held) : PALP_ERR_NO_MEMORY;
    return status ? cli_status_of("export", s->model, status, NULL) : CLI_OK;
}

static int choose_poisson(const export_options *o, const palp_model *model, export_scene *s) {
    if (!isnan(o->poisson)) {
        s->solid.poisson = o->poisson;
    } else if (model->kind == PALP_MODEL_LUMPED) {
        s->solid.poisson = 0.45;
        cli_note("export", "%s: a lumped model has no Poisson's ratio; 0.45 is taken (--poisson)", s->model);
    } else if (model->poisson_ratio > 0) {
        s->solid.poisson = model->poisson_ratio;
    } else if (model->volume_modulus_Pa > 0) {
        return cli_usage_error("export", "%s: has volume_modulus_Pa; name its ratio by --poisson", s->model);
    } else {
        s->solid.poisson = 0.25; /* of springs: doc/meshes.md */
    }
    return CLI_OK;
}

static int take_arms(const palp_model *model, export_scene *s) {
    s->solid.n_arms = model->material.n_arms;
    if (s->solid.n_arms > s->target->arms_max)
        return cli_failure("export", "%s: has %zu arms; %s takes %zu", s->model, s->solid.n_arms,
                           s->target->name, s->target->arms_max);
    for (size_t j = 0; j < s->solid.n_arms; j++)
        s->solid.tau_s[j] = model->material.arms[j].viscosity_Ns / model->material.arms[j].stiffness_N;
    return CLI_OK;
}

static int write_scene(const export_options *o, const export_scene *s) {
    palp_file file;
    int code = cli_file_open("export", o->out, &file);
    if (code)
        return code;
    s->target->write(s, file.stream);
    return cli_file_close("export", &file);
}

int export_solid(const export_options *o, const char *path) {
    palp_model model;
    palp_mesh_source source;
    export_scene s = {.target = &export_targets[o->to - 1],
                      .model = path,
                      .lumped_rms_N = NAN,
                      .density_kg_m3 = o->density_kg_m3};
    if (o->slides && !s.target->slides)
        return cli_usage_error("export", "%s's plates hold the tissue; leave --slide out", s.target->name);
    int code = choose_law(o, &s);
    code = code ? code : open_model("export", path, &model, &source);
    if (code)
        return code;
    s.model = cli_base(path);
    s.solid.time = s.target->time;
    s.solid.slides = o->slides;
    model.n_effects = 0; /* of the tissue alone, as in a simulator */
    if (model.density_kg_m3 > 0) {
        s.density_kg_m3 = model.density_kg_m3;
        model.density_kg_m3 = 0;
    }
    code = take_arms(&model, &s);
    if (s.solid.n_arms == 0) /* a ramp alone does not separate viscosity from elasticity */
        s.solid.time = PALP_SOLID_ELASTIC;
    code = code ? code : choose_poisson(o, &model, &s);
    code = code ? code : make_mesh(o, &model, &s);
    code = code ? code : export_fit(o, &model, &s);
    code = code ? code : export_press(&s);
    code = code ? code : write_scene(o, &s);
    code = code ? code : report(o, &s);
    free(s.held);
    palp_mesh_free(s.mesh);
    return code;
}
