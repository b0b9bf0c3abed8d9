/* calibrate_setup.c: the models, mesh and network of palpate calibrate. */
#include "calibrate.h"
#include "shared/opening.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "calibrate";
static const double PI = 3.14159265358979323846;

/* Effects of contact and instrument are copied to the network. A material effect has parameters of the lumped
 * specimen, not of an element, and is left out. The fit compares the models without effects. */
static void sort_effects(const calibrate_options *o, calibrate_state *s) {
    bool recorded = o->n_words > 1;
    size_t kept = 0;
    for (size_t i = 0; i < s->lumped.n_effects; i++) {
        const palp_effect_info *info = palp_effect_look_up(s->lumped.effects[i].id);
        if (!recorded && !o->start && info->place != PALP_EFFECT_SPECIMEN) {
            s->model.effects[kept++] = s->lumped.effects[i];
            continue;
        }
        cli_warning(NAME, "%s: its effect %s is left out: %s", o->lumped, info->id,
                    recorded ? "a network is fitted to runs without effects"
                    : o->start
                        ? "the network keeps the effects of --start"
                        : "its parameters do not hold for an element; palpate explain finds those of the "
                          "network");
    }
    if (!o->start)
        s->model.n_effects = kept;
    for (size_t i = 0; o->start && i < s->model.n_effects; i++) {
        const palp_effect_info *info = palp_effect_look_up(s->model.effects[i].id);
        if (info->place == PALP_EFFECT_SPECIMEN)
            cli_warning(NAME, "%s: its effect %s is kept in the model, but ignored by the fit", o->start,
                        info->id);
    }
}

static int read_models(const calibrate_options *o, calibrate_state *s) {
    int code = open_model_of(NAME, o->lumped, PALP_MODEL_LUMPED,
                             "is a network; name a lumped model (the network to start from goes to --start)",
                             &s->lumped, NULL);
    if (code)
        return code;
    if (s->does_relaxation && s->lumped.material.n_arms == 0)
        return cli_failure(NAME, "%s: has no arms, so it cannot relax; use --stage static", o->lumped);
    if (s->does_relaxation && s->relaxation_method == METHOD_THREE_PHASE && s->lumped.material.n_arms > 1) {
        return cli_failure(NAME, "%s: has %zu arms, but --method three_phase fits one; use --method nlopt",
                           o->lumped, s->lumped.material.n_arms);
    }
    s->model = s->lumped;
    s->model.kind = PALP_MODEL_NETWORK;
    if (o->start) {
        code = open_model_of(NAME, o->start, PALP_MODEL_NETWORK,
                             "is a lumped model, but --start needs a network", &s->model, &s->source);
        code = code ? code : open_refuse_mass(NAME, o->start, &s->model);
        s->model.n_validity = 0; /* of another material or mesh */
    }
    if (code == CLI_OK)
        sort_effects(o, s);
    return code;
}

/* All but the regions. */
static void forget_mesh(palp_mesh_source *mesh) {
    memset(mesh, 0, offsetof(palp_mesh_source, n_regions));
}

static int choose_lattice(const calibrate_options *o, const calibrate_state *s, palp_mesh_source *mesh) {
    double nodes[3],
        size_mm[3] = {1e3 * s->lumped.height_m, 1e3 * s->lumped.height_m, 1e3 * s->lumped.height_m};
    if (!cli_spread(&o->nodes, nodes))
        return cli_usage_error(NAME, "--nodes must be one or three numbers, e.g. 5 or 5,7,5");
    if (o->size_mm.n && !cli_spread(&o->size_mm, size_mm))
        return cli_usage_error(NAME, "--size-mm must be one or three numbers, e.g. 24 or 24,30,24");
    forget_mesh(mesh);
    mesh->kind = PALP_MESH_LATTICE;
    mesh->neighbourhood = PALP_NEIGHBOURS_26;
    mesh->scaling = o->scaling < 0 ? PALP_SCALING_CONTINUUM : (palp_mesh_scaling)o->scaling;
    mesh->area_m2 = 1e-6 * o->area_mm2;
    for (int i = 0; i < 3; i++) {
        mesh->nodes[i] = (size_t)nodes[i];
        mesh->size_m[i] = 1e-3 * size_mm[i];
    }
    return CLI_OK;
}

static int choose_mesh(const calibrate_options *o, calibrate_state *s) {
    palp_mesh_source *mesh = &s->source;
    s->model.mesh = mesh;
    if (o->nodes.n) {
        const int code = choose_lattice(o, s, mesh);
        s->model.edge_correction = mesh->scaling == PALP_SCALING_CONTINUUM;
        return code;
    }
    if (o->mesh) {
        forget_mesh(mesh);
        mesh->kind = PALP_MESH_FILE;
        mesh->neighbourhood = PALP_NEIGHBOURS_26;
        mesh->scale_m = 1e-3 * o->scale_mm;
        mesh->hex_diagonals = o->hex_diagonals;
        mesh->scaling = o->scaling < 0 ? PALP_SCALING_CONTINUUM : (palp_mesh_scaling)o->scaling;
        mesh->area_m2 = o->area_mm2 > 0 ? 1e-6 * o->area_mm2 : PI * s->lumped.radius_m * s->lumped.radius_m;
        strncpy(mesh->path, o->mesh, sizeof mesh->path - 1);
        s->model.edge_correction = o->hex_diagonals && mesh->scaling == PALP_SCALING_CONTINUUM;
    }
    return CLI_OK; /* else that of --start */
}

/* Springs have 1/4 by themselves; without the option it is as --start has it. */
static void choose_poisson(const calibrate_options *o, palp_model *model) {
    if (o->poisson > 0) {
        model->poisson_ratio = o->poisson > 0.25 ? o->poisson : 0;
        model->volume_modulus_Pa = 0;
    }
}

/* Each tetrahedron has a volume of its own to keep, which is more than its corners can do near 1/2. */
static const double TETRAHEDRA_MOST = 0.45;
static bool is_of_tetrahedra(const calibrate_state *s) {
    return s->source.kind == PALP_MESH_FILE && !s->source.hex_diagonals;
}

/* The regions that --fit-region names. */
static int choose_regions(const calibrate_options *o, calibrate_state *s) {
    for (size_t r = 0; r < s->source.n_regions; r++)
        if (s->source.regions[r].fibre_Pa > 0)
            return cli_failure(NAME, "%s: region \"%s\" has fibres, which calibrate does not take yet",
                               o->start, s->source.regions[r].name);
    for (const char *name = o->regions; name; name = strchr(name, ',') ? strchr(name, ',') + 1 : NULL) {
        const size_t length = strcspn(name, ",");
        size_t r = 0;
        while (r < s->source.n_regions && (strlen(s->source.regions[r].name) != length ||
                                           strncmp(s->source.regions[r].name, name, length) != 0))
            r++;
        if (r == s->source.n_regions || s->source.regions[r].stiffness == 0)
            return cli_usage_error(NAME, "--fit-region: %s has no region \"%.*s\" with a stiffness_factor",
                                   o->start ? o->start : "the network (no --start)", (int)length, name);
        s->fits_region[r] = true;
    }
    if (o->regions && o->n_words < 2)
        return cli_usage_error(NAME, "--fit-region needs runs of spheres over the regions");
    return CLI_OK;
}

int calibrate_setup(const calibrate_options *o, calibrate_state *s) {
    palp_support supports[2];
    palp_network_settings settings;
    palp_error error = {PALP_OK, ""};
    double low[3], high[3];
    int code = read_models(o, s);
    if (code == CLI_OK)
        code = choose_mesh(o, s);
    if (code == CLI_OK)
        code = choose_regions(o, s);
    if (code)
        return code;
    choose_poisson(o, &s->model);
    palp_status status = palp_model_mesh(&s->model, &s->mesh, &error);
    if (status == PALP_ERR_UNSUPPORTED && o->mesh &&
        o->scaling < 0) { /* hexahedra without diagonals cannot be scaled */
        s->source.scaling = PALP_SCALING_NONE;
        status = palp_model_mesh(&s->model, &s->mesh, &error);
    }
    if (status == PALP_OK) {
        palp_mesh_bounds(s->mesh, low, high);
        s->height_m = high[1] - low[1];
        palp_supports_default(supports);
        settings = palp_network_settings_of_model(&s->model);
        settings.density_kg_m3 = 0;
        settings.branch = (palp_branch)o->branch;
        s->model.material.formulation = (palp_formulation)o->formulation;
        if (s->does_static) {
            s->model.material.n_arms = 0;
            s->model.material.dashpot_Ns = 0;
        }
        status =
            palp_network_create(s->mesh, &s->model.material, 2, supports, &settings, &s->network, &error);
    }
    if (status)
        return cli_status(NAME, status, &error);
    if (s->model.poisson_ratio > TETRAHEDRA_MOST && is_of_tetrahedra(s))
        cli_warning(
            NAME,
            "tetrahedra lock above a Poisson's ratio of %g: fitted to a plate, they shear too easily; "
            "take hexahedra or a lattice",
            TETRAHEDRA_MOST);
    if (fabs(s->height_m - s->lumped.height_m) > 1e-3 * s->lumped.height_m)
        cli_warning(NAME,
                    "the network is %.4g mm high, but the specimen of %s is %.4g mm; depths in mm are equal",
                    1e3 * s->height_m, o->lumped, 1e3 * s->lumped.height_m);
    return CLI_OK;
}
