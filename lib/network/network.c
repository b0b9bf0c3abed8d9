/* network.c: building a network, and its properties. */
#include "network_internal.h"

#include "base/file.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_network_settings palp_network_settings_default(void) {
    return (palp_network_settings){.tolerance = 1e-10,
                                   .max_iterations = 50,
                                   .branch = PALP_BRANCH_CONTINUE,
                                   .solver = PALP_SOLVER_AUTO,
                                   .density_kg_m3 = 0.0,
                                   .volume_modulus_Pa = 0.0,
                                   .poisson_ratio = 0.0,
                                   .integrator = PALP_BACKWARD_EULER,
                                   .spectral_radius = 0.5,
                                   .check_strain = 5e-3};
}

void network_take_settings(const palp_model *model, palp_network_settings *s) {
    s->density_kg_m3 = model->density_kg_m3;
    s->volume_modulus_Pa = model->volume_modulus_Pa;
    s->poisson_ratio = model->poisson_ratio;
    s->edge_correction = model->edge_correction;
    s->n_regions = model->mesh ? model->mesh->n_regions : 0;
    s->regions = model->mesh ? model->mesh->regions : NULL;
}

palp_network_settings palp_network_settings_of_model(const palp_model *model) {
    palp_network_settings s = palp_network_settings_default();
    if (model)
        network_take_settings(model, &s);
    return s;
}

void palp_supports_default(palp_support supports[2]) {
    if (!supports)
        return;
    supports[0] = (palp_support){"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0.0, 0.0, 0.0}};
    supports[1] = (palp_support){"top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0.0, -1.0, 0.0}};
}

void palp_network_free(palp_network *net) {
    if (!net)
        return;
    for (size_t i = 0; i < net->n_terms; i++)
        network_term_free(net->terms[i]);
    linsys_free(net->ls);
    if (net->ranks)
        net->ranks->free(net->ranks);
    palp_mesh_free(net->mesh);
    arena_free(&net->memory);
    arena_free(&net->states);
    free(net->mark);
    free(net);
}

static palp_status allocate_network_arrays(palp_network *net) {
    size_t n3 = 3 * net->n_nodes, m = net->n_elements;
    double **by_axis[] = {&net->motion, &net->fint, &net->outer, &net->diagonal, &net->unbalanced,
                          &net->rhs,    &net->dx,   &net->start, &net->way[0],   &net->way[1]};
    double **by_element[] = {&net->inverse_rest, &net->inverse_length, &net->tangent};
    for (size_t i = 0; i < sizeof by_axis / sizeof *by_axis; i++)
        *by_axis[i] = arena_take(&net->memory, n3, sizeof(double));
    for (size_t i = 0; i < sizeof by_element / sizeof *by_element; i++)
        *by_element[i] = arena_take(&net->memory, m, sizeof(double));
    net->unit = arena_take(&net->memory, net->n_nodes, sizeof *net->unit);
    net->node_block = arena_take(&net->memory, 6 * net->n_nodes, sizeof *net->node_block);
    net->direction = arena_take(&net->memory, 3 * m, sizeof *net->direction);
    net->scratch = arena_take(&net->memory, 2 * m, sizeof *net->scratch);
    if (net->settings.density_kg_m3 > 0.0)
        net->mass = arena_take(&net->memory, net->n_nodes, sizeof *net->mass);
    if (palp_mesh_element_scale(net->mesh) || net->n_regions > 0 || (net->ranks && net->ranks->element_scale))
        net->scale = arena_take(&net->memory, m, sizeof *net->scale);
    net->dof = arena_take(&net->memory, n3, sizeof *net->dof);
    net->slot = net->ranks ? NULL : arena_take(&net->memory, 9 * m, sizeof *net->slot);
    net->slot_node = arena_take(&net->memory, 6 * net->n_nodes, sizeof *net->slot_node);
    return net->memory.failed ? PALP_ERR_NO_MEMORY : network_allocate_states(net);
}

static palp_status apply_support_to_nodes(palp_network *net, const palp_support *support, palp_error *error) {
    const int32_t *nodes;
    size_t n;
    if (palp_mesh_set(net->mesh, support->set, &n, &nodes))
        return palp_error_set(error, PALP_ERR_INPUT, "the mesh has no node set \"%s\"", support->set);
    for (size_t k = 0; k < 3; k++)
        if (support->axis[k] == PALP_DRIVEN && !isfinite(support->motion[k]))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "the motion of node set \"%s\" is not a number",
                                  support->set);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) {
            size_t d = 3 * (size_t)nodes[i] + k;
            if (support->axis[k] == PALP_FREE)
                continue;
            net->dof[d] = -1;
            net->motion[d] = support->axis[k] == PALP_DRIVEN ? support->motion[k] : 0.0;
        }
    return PALP_OK;
}

static palp_status number_free_unknowns(palp_network *net, size_t n, const palp_support *supports,
                                        palp_error *error) {
    for (size_t i = 0; i < n; i++) {
        palp_status status = apply_support_to_nodes(net, &supports[i], error);
        if (status)
            return status;
    }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->dof[i] = (int32_t)net->n_free++;
    return PALP_OK;
}

/* A quarter of each tetrahedron's mass goes to each corner. Hexahedra and meshes without cells (as large as
 * their box) divide mass in proportion to the rest length of a node's elements: tetrahedra of hexahedra would
 * favour some corners. */
static void share_mass_among_nodes(palp_network *net) {
    double low[3], high[3], total = 0.0, volume = mesh_volume(net->mesh, net->mass);
    if (volume > 0.0 && net->mesh->n_hexahedra == 0) {
        for (size_t i = 0; i < net->n_nodes; i++)
            net->mass[i] *= net->settings.density_kg_m3;
        return;
    }
    palp_mesh_bounds(net->mesh, low, high);
    if (!(volume > 0.0))
        volume = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
    memset(net->mass, 0, net->n_nodes * sizeof *net->mass);
    for (size_t i = 0; i < net->n_elements; i++)
        total += 2.0 / net->inverse_rest[i];
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        net->mass[net->pair[i]] += net->settings.density_kg_m3 * volume / net->inverse_rest[i / 2] / total;
}

static void measure_rest_lengths(palp_network *net) {
    double low[3], high[3], motion[3] = {0.0};
    palp_mesh_bounds(net->mesh, low, high);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        motion[i % 3] = fmax(motion[i % 3], fabs(net->motion[i]));
    for (size_t k = 0; k < 3; k++) {
        low[k] = -network_largest_of_parts(net, -low[k]);
        high[k] = network_largest_of_parts(net, high[k]);
        motion[k] = network_largest_of_parts(net, motion[k]);
        net->extent = fmax(net->extent, high[k] - low[k]);
    }
    net->driven = motion[0] + motion[1] + motion[2] > 0.0;
    size_t along = motion[1] >= motion[0] ? 1 : 0;
    along = motion[2] > motion[along] ? 2 : along;
    net->height = high[along] - low[along];
    for (size_t i = 0; i < net->n_elements; i++) {
        const double *a = net->rest + 3 * net->pair[2 * i], *b = net->rest + 3 * net->pair[2 * i + 1];
        double length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                             (b[2] - a[2]) * (b[2] - a[2]));
        net->inverse_rest[i] = 1.0 / length;
    }
    network_find_units(net);
    if (net->mass)
        share_mass_among_nodes(net);
}

static palp_status build_network_from_mesh(palp_network *net, const palp_mesh *mesh, size_t n_supports,
                                           const palp_support *supports, palp_error *error) {
    const bool volume = net->ranks ? net->ranks->volume : network_wants_volume(&net->settings);
    palp_status status = mesh_copy(mesh, &net->mesh);
    if (status)
        return status;
    net->n_nodes = palp_mesh_node_count(net->mesh);
    net->n_elements = palp_mesh_element_count(net->mesh);
    net->rest = palp_mesh_positions(net->mesh);
    net->pair = palp_mesh_pairs(net->mesh);
    net->surface = palp_mesh_triangles(net->mesh);
    net->n_surface = palp_mesh_triangle_count(net->mesh);
    status = network_take_regions(net, error);
    if (!status)
        status = allocate_network_arrays(net);
    if (!status)
        status = number_free_unknowns(net, n_supports, supports, error);
    if (!status && !net->ranks)
        status = network_find_edges(net, n_supports, supports);
    if (!status)
        status = network_scale_elements(net);
    if (status)
        return status;
    measure_rest_lengths(net);
    status = network_make_runs(net);
    if (!status && !net->ranks)
        status = network_make_pattern(net);
    if (status == PALP_ERR_UNSUPPORTED)
        return palp_error_set(error, status, "the supernodal solver needs a build with GPL=1");
    if (status)
        return status;
    /* a factorization costs more than ten evaluations (some 20 ns an element) at 20 Gflop/s */
    net->reuse_factor = !net->ranks && linsys_flops(net->ls) / 20e9 > 10.0 * 20e-9 * (double)net->n_elements;
    palp_network_reset(net);
    if (net->mass)
        status = network_add_terms(net, 1, (network_term *[]){network_inertia_new(net)});
    if (!status && volume)
        status = network_add_volume(net);
    if (!status)
        status = network_add_fibres(net);
    if (status == PALP_ERR_UNSUPPORTED)
        return palp_error_set(error, status,
                              "a volume modulus, Poisson's ratio or fibres need a mesh of tetrahedra or "
                              "hexahedra with an element "
                              "between any two corners of one (a lattice of 26 neighbours, --hex-diagonals)");
    return status;
}

static bool are_settings_in_range(const palp_network_settings *s) {
    return s->tolerance > 0.0 && isfinite(s->tolerance) && s->max_iterations >= 1 &&
           s->density_kg_m3 >= 0.0 && isfinite(s->density_kg_m3) && s->volume_modulus_Pa >= 0.0 &&
           isfinite(s->volume_modulus_Pa) &&
           (s->poisson_ratio == 0.0 ||
            (s->poisson_ratio >= 0.25 && s->poisson_ratio < 0.5 && s->volume_modulus_Pa == 0.0)) &&
           s->spectral_radius >= 0.0 && s->spectral_radius <= 1.0 && s->check_strain >= 0.0 &&
           s->n_regions <= PALP_REGIONS_MAX && (s->n_regions == 0 || s->regions) &&
           s->branch <= PALP_BRANCH_STABLE && s->solver <= PALP_SOLVER_SUPERNODAL &&
           s->integrator <= PALP_GENERALIZED_ALPHA;
}

static palp_status check_material_and_settings(const palp_material *material,
                                               const palp_network_settings *settings, palp_error *error) {
    double rest = 0.0;
    palp_status status = palp_material_check(material, error);
    if (status)
        return status;
    if (!are_settings_in_range(settings))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a network setting is out of range");
    palp_law_stiffness(&material->law, 0.0, &rest, NULL);
    if (settings->poisson_ratio > 0.0 && !(rest > 0.0))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "Poisson's ratio needs a law with stiffness at rest");
    return PALP_OK;
}

palp_status palp_network_create(const palp_mesh *mesh, const palp_material *material, size_t n_supports,
                                const palp_support *supports, const palp_network_settings *settings,
                                palp_network **network, palp_error *error) {
    if (!mesh || !material || (n_supports > 0 && !supports) || !settings || !network)
        return palp_error_null(error);
    return network_create_part(mesh, material, n_supports, supports, settings, NULL, network, error);
}

palp_status network_create_part(const palp_mesh *mesh, const palp_material *material, size_t n_supports,
                                const palp_support *supports, const palp_network_settings *settings,
                                network_ranks *ranks, palp_network **network, palp_error *error) {
    palp_status status = check_material_and_settings(material, settings, error);
    palp_network *net = status ? NULL : calloc(1, sizeof *net);
    if (!net) {
        if (ranks)
            ranks->free(ranks);
        return status ? status : palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    }
    net->ranks = ranks;
    net->settings = *settings;
    net->material = *material;
    net->rate_factor = 1.0;
    palp_error why = {PALP_OK, ""};
    status = build_network_from_mesh(net, mesh, n_supports, supports, &why);
    if (status) {
        palp_network_free(net);
        return why.text[0] ? palp_error_set(error, status, "%s", why.text)
                           : palp_error_set(error, status, "the network: %s", palp_status_text(status));
    }
    *network = net;
    return PALP_OK;
}

palp_status palp_network_set_material(palp_network *net, const palp_material *material) {
    if (!net || !material)
        return PALP_ERR_ARGUMENT;
    palp_status status = palp_material_check(material, NULL);
    if (status)
        return status;
    bool vector = material->formulation == PALP_SEDEF2008 && material->n_arms > 0;
    if (net->base_share && material->formulation != PALP_HISTORY)
        return PALP_ERR_UNSUPPORTED;
    if (!network_may_have_material(net, material))
        return PALP_ERR_ARGUMENT;
    bool same = material->n_arms == net->material.n_arms && vector == (net->now.vector != NULL) &&
                material->quasi_linear == net->material.quasi_linear;
    palp_material old = net->material;
    net->material = *material;
    if (!same && network_allocate_states(net)) {
        net->material = old;
        return PALP_ERR_NO_MEMORY;
    }
    if (net->base_share)
        network_find_units(net);
    palp_network_reset(net);
    return PALP_OK;
}

palp_status network_set_damage(palp_network *net, const element_damage *damage) {
    net->damage = damage;
    palp_status status = network_allocate_states(net);
    if (!status)
        palp_network_reset(net);
    return status;
}

double palp_network_depth(const palp_network *net) {
    return net ? net->now.depth : NAN;
}

double palp_network_time(const palp_network *net) {
    return net ? net->now.time : NAN;
}

double palp_network_force(const palp_network *net) {
    return net ? net->now.force : NAN;
}

const double *palp_network_positions(const palp_network *net) {
    return net ? net->now.x : NULL;
}

const double *palp_network_element_strain(const palp_network *net) {
    return net ? net->now.history.strain : NULL;
}

size_t palp_network_unknown_count(const palp_network *net) {
    return net ? net->n_free : 0;
}

const palp_mesh *palp_network_mesh(const palp_network *net) {
    return net ? net->mesh : NULL;
}

const double *palp_network_element_scale(const palp_network *net) {
    return net ? net->scale : NULL;
}

void palp_network_element_force(const palp_network *net, double *force_N) {
    if (!net || !force_N)
        return;
    memcpy(force_N, net->now.element, net->n_elements * sizeof *force_N);
}

palp_status palp_network_reaction(const palp_network *net, const char *set, double force_N[3]) {
    if (!net || !set || !force_N)
        return PALP_ERR_ARGUMENT;
    const int32_t *nodes;
    size_t n;
    palp_status status = palp_mesh_set(net->mesh, set, &n, &nodes);
    if (status)
        return status;
    force_N[0] = force_N[1] = force_N[2] = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3 && network_owns(net, (size_t)nodes[i]); k++)
            force_N[k] += net->now.inner[3 * (size_t)nodes[i] + k];
    if (net->ranks)
        net->ranks->sum(net->ranks, 3, force_N);
    return PALP_OK;
}

palp_status palp_network_surface(const palp_network *net, size_t *n, const int32_t **triangles) {
    if (!net || !n || !triangles)
        return PALP_ERR_ARGUMENT;
    *n = net->n_surface;
    *triangles = net->surface;
    return PALP_OK;
}

bool palp_network_buckled(const palp_network *net, double *stable_m, double *unstable_m) {
    if (!net || !stable_m || !unstable_m)
        return false;
    if (net->buckled) {
        *stable_m = net->checked_depth;
        *unstable_m = net->unstable_depth;
    }
    return net->buckled;
}

/* Effects of the tester are not part of the tissue and are left out. Effects of elements or plates cannot
 * be. */
static palp_status check_effects_supported(const palp_model *model, palp_error *error) {
    for (size_t i = 0; i < model->n_effects; i++) {
        const palp_effect_info *info = palp_effect_look_up(model->effects[i].id);
        if (!info || (info->place != PALP_EFFECT_FRAME && info->place != PALP_EFFECT_SENSOR))
            return palp_error_set(error, PALP_ERR_UNSUPPORTED, "the effect %s needs palp_forward_network",
                                  info ? info->id : "of unknown number");
    }
    return PALP_OK;
}

palp_status palp_network_from_model(const palp_model *model, const palp_mesh *mesh, size_t n_supports,
                                    const palp_support *supports, const palp_network_settings *settings,
                                    palp_network **network, palp_error *error) {
    if (!model || !network)
        return palp_error_null(error);
    palp_network_settings own = settings ? *settings : palp_network_settings_default();
    palp_support usual[2];
    palp_mesh *made = NULL;
    palp_status status = check_effects_supported(model, error);
    if (!status && !mesh)
        status = palp_model_mesh(model, &made, error);
    if (status)
        return status;
    palp_supports_default(usual);
    network_take_settings(model, &own);
    status = palp_network_create(mesh ? mesh : made, &model->material, supports ? n_supports : 2,
                                 supports ? supports : usual, &own, network, error);
    palp_mesh_free(made);
    return status;
}
