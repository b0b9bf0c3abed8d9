/* network_regions.c: elements and solids whose material differs from that of the network. */
#include "base/file.h"
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool network_material_at(const palp_network *net, size_t number, network_material *material) {
    if (number == 0) {
        *material =
            (network_material){&net->material, &net->step, &net->now.history, net->base_share, net->modulus};
        return true;
    }
    const network_region *region = &net->region[number - 1];
    if (region->share)
        *material = (network_material){&region->given.own_material, &region->step,
                                       &net->now.region[number - 1], region->share, region->modulus};
    return region->share;
}

void network_stiffnesses(const palp_network *net, double strain, bool with_arms,
                         double stiffness[PALP_REGIONS_MAX + 1]) {
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++) {
        stiffness[r] = 0.0;
        if (!network_material_at(net, r, &m))
            continue;
        palp_law_stiffness(&m.material->law, strain, &stiffness[r], NULL);
        for (size_t j = 0; j < m.material->n_arms && with_arms; j++)
            stiffness[r] += m.material->arms[j].stiffness_N;
    }
}

double network_mean_of_materials(const palp_network *net, size_t element,
                                 const double value[PALP_REGIONS_MAX + 1]) {
    if (!net->base_share)
        return value[0];
    double sum = net->base_share[element] * value[0];
    for (size_t r = 0; r < net->n_regions; r++)
        sum += net->region[r].share ? net->region[r].share[element] * value[r + 1] : 0.0;
    return sum;
}

static bool has_stiffness_at_rest(const palp_material *material) {
    double stiffness = 0.0;
    palp_law_stiffness(&material->law, 0.0, &stiffness, NULL);
    return stiffness > 0.0;
}

bool network_may_have_material(const palp_network *net, const palp_material *material) {
    return !net->base_share || has_stiffness_at_rest(material);
}

static palp_status check_region(const palp_network *net, const palp_region *r, palp_error *error) {
    const double ratio = r->poisson_ratio;
    if (!memchr(r->name, '\0', PALP_REGION_NAME_MAX) || !memchr(r->set, '\0', PALP_REGION_NAME_MAX) ||
        !(r->stiffness >= 0.0) || !isfinite(r->stiffness))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "a region's name is too long or its stiffness is < 0");
    if (ratio != 0.0 && !(ratio >= 0.25 && ratio < 0.5 && net->settings.volume_modulus_Pa == 0.0))
        return palp_error_set(
            error, PALP_ERR_ARGUMENT,
            "region \"%s\": Poisson's ratio must be from 0.25 to below 0.5, without a volume "
            "modulus",
            r->name);
    const double along = network_dot(r->fibre, r->fibre, 3);
    if (!(r->fibre_Pa >= 0.0) || !isfinite(r->fibre_Pa) ||
        (r->fibre_Pa > 0.0 && (!(along > 0.0) || !isfinite(along) || r->shape == PALP_REGION_MEMBRANE)))
        return palp_error_set(
            error, PALP_ERR_ARGUMENT,
            "region \"%s\": fibres need a direction, a modulus above 0 and a region of volume", r->name);
    if (r->stiffness > 0.0)
        return PALP_OK;
    if (net->material.formulation != PALP_HISTORY || r->own_material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "region \"%s\": a material of its own needs the formulation \"history\"",
                              r->name);
    palp_status status = palp_material_check(&r->own_material, error);
    if (!status && (!has_stiffness_at_rest(&net->material) || !has_stiffness_at_rest(&r->own_material)))
        status =
            palp_error_set(error, PALP_ERR_ARGUMENT, /* stiffnesses are given as multiples */
                           "region \"%s\": a material of its own needs laws with stiffness at rest", r->name);
    return status;
}

/* The part of each solid in this region, without what later regions have of it. */
static palp_status find_inside(const palp_network *net, size_t of, double *inside) {
    const double *part;
    double *left = malloc(net->mesh->n_tetrahedra * sizeof *left);
    if (!left)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = of; r < net->n_regions; r++)
        if (net->region[r].given.shape != PALP_REGION_MEMBRANE &&
            !palp_mesh_region(net->mesh, net->region[r].given.name, &part))
            for (size_t i = 0; i < net->mesh->n_tetrahedra; i++)
                left[i] = r == of ? part[i] : left[i] * (1.0 - part[i]);
    mesh_parts_of_solids(net->mesh, left, inside, NULL);
    free(left);
    return PALP_OK;
}

/* Stiffness of each region over that of the network's own material, with all arms, and that itself last. */
static void find_ratios(const palp_network *net, double ratio[PALP_REGIONS_MAX + 1]) {
    double stiffness[PALP_REGIONS_MAX + 1];
    network_stiffnesses(net, 0.0, true, stiffness);
    for (size_t r = 0; r < net->n_regions; r++)
        ratio[r] = net->region[r].share ? stiffness[r + 1] / stiffness[0] : net->region[r].given.stiffness;
    ratio[net->n_regions] = 1.0;
}

/* Part of a solid in region r, or (n_regions) in none. */
static double part_of_solid(const palp_network *net, size_t r, size_t solid) {
    if (r < net->n_regions)
        return net->region[r].inside[solid];
    double rest = 1.0;
    for (size_t other = 0; other < net->n_regions; other++)
        rest -= net->region[other].inside[solid];
    return fmax(0.0, rest);
}

/* Stiffness of a solid over that of the network's own material: the geometric mean of its parts' by volume,
 * which is between that of layers along a load and across it. *sum: the arithmetic mean. */
static double stiffness_of_solid(const palp_network *net, const double ratio[PALP_REGIONS_MAX + 1],
                                 size_t solid, double *sum) {
    double logarithm = 0.0;
    *sum = 0.0;
    for (size_t r = 0; r <= net->n_regions; r++) {
        const double part = part_of_solid(net, r, solid);
        logarithm += part * log(ratio[r]);
        *sum += part * ratio[r];
    }
    return exp(logarithm);
}

void network_mean_of_solids(const palp_network *net, const double value[PALP_REGIONS_MAX + 1], size_t n,
                            size_t per_solid, double *mean) {
    double ratio[PALP_REGIONS_MAX + 1], sum;
    find_ratios(net, ratio);
    for (size_t i = 0; i < n; i++) {
        mean[i] = 0.0;
        for (size_t r = 0; r <= net->n_regions; r++)
            mean[i] += part_of_solid(net, r, i / per_solid) * value[r] / ratio[r];
        mean[i] *= stiffness_of_solid(net, ratio, i / per_solid, &sum) *
                   (net->edge ? net->edge[i / per_solid] : 1.0);
    }
}

/* Each element's force over that of the same spring in the network's own material, into factor[n_elements];
 * and what part of it each material has, if some regions have one of their own. */
static palp_status find_shares(palp_network *net, double *factor) {
    size_t corners;
    const int32_t *node;
    const size_t n = mesh_solids(net->mesh, &corners, &node);
    double *stiffness = malloc((3 * n + 1) * sizeof *stiffness), *sum = stiffness + n, *value = sum + n;
    double ratio[PALP_REGIONS_MAX + 1];
    palp_status status = stiffness ? PALP_OK : PALP_ERR_NO_MEMORY;
    find_ratios(net, ratio);
    for (size_t i = 0; i < n && !status; i++)
        stiffness[i] = stiffness_of_solid(net, ratio, i, &sum[i]) * (net->edge ? net->edge[i] : 1.0);
    if (!status)
        status = mesh_mean_around_elements(net->mesh, stiffness, factor);
    for (size_t r = 0; r <= net->n_regions && net->base_share && !status; r++) {
        double *share = r < net->n_regions ? net->region[r].share : net->base_share;
        if (!share || (r < net->n_regions && net->region[r].given.shape == PALP_REGION_MEMBRANE))
            continue;
        for (size_t i = 0; i < n; i++) {
            double part = part_of_solid(net, r, i);
            for (size_t other = 0; other < net->n_regions && r == net->n_regions; other++)
                part += net->region[other].share ? 0.0 : ratio[other] * part_of_solid(net, other, i);
            value[i] = part * stiffness[i] / sum[i];
        }
        status = mesh_mean_around_elements(net->mesh, value, share);
        for (size_t i = 0; i < net->n_elements && !status; i++)
            share[i] /= factor[i];
    }
    free(stiffness);
    return status;
}

/* Which materials each chunk of elements has: bit 0 that of the network, bit r + 1 that of region r. */
static void list_materials_of_chunks(palp_network *net) {
    for (size_t i = 0; i < net->n_elements; i++) {
        unsigned short *has = &net->chunk_has[i / NETWORK_CHUNK];
        *has |= net->base_share[i] > 0.0;
        for (size_t r = 0; r < net->n_regions; r++)
            if (net->region[r].share && net->region[r].share[i] > 0.0)
                *has |= (unsigned short)(2U << r);
    }
}

/* Which region has most of the solids around each node; -1: more of them are in none. */
static palp_status find_regions_of_nodes(palp_network *net) {
    size_t corners;
    const int32_t *node;
    const size_t n = mesh_solids(net->mesh, &corners, &node);
    double *most = calloc(2 * net->n_nodes, sizeof *most), *sum = most + net->n_nodes;
    net->region_of_node = arena_take(&net->memory, net->n_nodes, sizeof *net->region_of_node);
    const bool ok = most && net->region_of_node;
    for (size_t r = 0; r <= net->n_regions && ok; r++) {
        memset(sum, 0, net->n_nodes * sizeof *sum);
        for (size_t i = 0; i < corners * n; i++)
            sum[node[i]] += part_of_solid(net, r, i / corners);
        for (size_t i = 0; i < net->n_nodes; i++)
            if (sum[i] > most[i]) {
                most[i] = sum[i];
                net->region_of_node[i] = r < net->n_regions ? (signed char)r : -1;
            }
    }
    free(most);
    return ok ? PALP_OK : PALP_ERR_NO_MEMORY;
}

palp_status network_take_regions(palp_network *net, palp_error *error) {
    const palp_region *given = net->settings.regions;
    size_t corners;
    const int32_t *node;
    const size_t n_solids = mesh_solids(net->mesh, &corners, &node);
    bool own = false;
    net->n_regions = net->settings.n_regions;
    net->region = arena_take(&net->memory, net->n_regions, sizeof *net->region);
    for (size_t r = 0; r < net->n_regions && net->region; r++) {
        const double *part;
        network_region *region = &net->region[r];
        palp_status status = check_region(net, &given[r], error);
        if (status)
            return status;
        if (given[r].shape != PALP_REGION_MEMBRANE && palp_mesh_region(net->mesh, given[r].name, &part))
            return palp_error_set(error, PALP_ERR_INPUT, "the mesh has no region \"%s\"", given[r].name);
        if (given[r].shape == PALP_REGION_MEMBRANE && given[r].set[0] &&
            palp_mesh_set(net->mesh, given[r].set, &(size_t){0}, &(const int32_t *){NULL}))
            return palp_error_set(error, PALP_ERR_INPUT, "the mesh has no node set \"%s\"", given[r].set);
        region->given = given[r];
        region->inside = arena_take(&net->memory, n_solids, sizeof *region->inside);
        if (given[r].stiffness == 0.0) {
            region->share = arena_take(&net->memory, net->n_elements, sizeof *region->share);
            own = true;
        }
    }
    for (size_t r = 0; r < net->n_regions && !net->memory.failed; r++)
        if (net->region[r].given.shape != PALP_REGION_MEMBRANE && find_inside(net, r, net->region[r].inside))
            return PALP_ERR_NO_MEMORY;
    if (net->n_regions > 0)
        net->stiffer = arena_take(&net->memory, net->n_nodes, sizeof *net->stiffer);
    if (own) {
        net->base_share = arena_take(&net->memory, net->n_elements, sizeof *net->base_share);
        net->chunk_has =
            arena_take(&net->memory, net->n_elements / NETWORK_CHUNK + 1, sizeof *net->chunk_has);
    }
    net->settings.regions = NULL; /* the caller's */
    if (net->memory.failed)
        return PALP_ERR_NO_MEMORY;
    return net->n_regions > 0 ? find_regions_of_nodes(net) : PALP_OK;
}

/* Its share of each element's force, which all have the element's factor. */
static palp_status add_membrane(palp_network *net, network_region *region) {
    const char *set = region->given.set;
    const int32_t *node = NULL;
    size_t n = 0;
    unsigned char *listed = set[0] ? calloc(net->n_nodes, 1) : NULL;
    if (set[0] && !listed)
        return PALP_ERR_NO_MEMORY;
    palp_status status = set[0] ? palp_mesh_set(net->mesh, set, &n, &node) : PALP_OK;
    for (size_t i = 0; i < n; i++)
        listed[node[i]] = 1;
    if (!status)
        status = mesh_membrane_widths(net->mesh, listed, region->share);
    for (size_t i = 0; i < net->n_elements && !status; i++)
        region->share[i] /= net->scale[i];
    free(listed);
    return status;
}

palp_status network_find_edges(palp_network *net, size_t n_supports, const palp_support *supports) {
    size_t corners;
    const int32_t *node;
    if (!network_has_edges(net->mesh, &net->settings))
        return PALP_OK;
    net->edge = arena_take(&net->memory, mesh_solids(net->mesh, &corners, &node), sizeof *net->edge);
    return net->edge ? network_edge_factors(net->mesh, &net->settings, n_supports, supports, net->edge)
                     : PALP_ERR_NO_MEMORY;
}

palp_status network_scale_elements(palp_network *net) {
    const double *scale = palp_mesh_element_scale(net->mesh);
    const bool own = net->n_regions > 0 || net->edge;
    const double *regions = net->ranks ? net->ranks->element_scale : own ? net->scale : NULL;
    palp_status status = own ? find_shares(net, net->scale) : PALP_OK;
    for (size_t i = 0; i < net->n_elements && net->scale && !status; i++)
        net->scale[i] = (scale ? scale[i] : 1.0) * (regions ? regions[i] : 1.0);
    for (size_t r = 0; r < net->n_regions && !status; r++)
        if (net->region[r].given.shape == PALP_REGION_MEMBRANE)
            status = add_membrane(net, &net->region[r]);
    if (!status && net->base_share)
        list_materials_of_chunks(net);
    return status;
}

palp_status network_scales_of_regions(const palp_mesh *mesh, const palp_material *material,
                                      const palp_network_settings *settings, size_t n_supports,
                                      const palp_support *supports, double *element, double *solid,
                                      palp_error *error) {
    palp_network net = {.mesh = (palp_mesh *)mesh, /* only read */
                        .n_nodes = mesh->n_nodes,
                        .n_elements = mesh->n_elements,
                        .material = *material,
                        .settings = *settings};
    size_t corners;
    const int32_t *node;
    double share[PALP_REGIONS_MAX + 1];
    palp_status status = network_take_regions(&net, error);
    if (!status)
        status = network_find_edges(&net, n_supports, supports);
    if (!status)
        status = find_shares(&net, element);
    if (!status) {
        for (size_t r = 0; r < net.n_regions; r++)
            share[r] = net.region[r].given.stiffness *
                       network_volume_share(settings, net.region[r].given.poisson_ratio);
        share[net.n_regions] = network_volume_share(settings, 0.0);
        network_mean_of_solids(&net, share, mesh_solids(mesh, &corners, &node), 1, solid);
    }
    arena_free(&net.memory);
    return status;
}

void network_find_units(palp_network *net) {
    const double *scale = palp_mesh_element_scale(net->mesh);
    double stiffness[PALP_REGIONS_MAX + 1];
    network_stiffnesses(net, 0.0, true, stiffness);
    for (size_t r = 0; r < net->n_regions; r++) /* a membrane hardly changes how the tissue below gives way */
        stiffness[r + 1] *= net->region[r].given.shape != PALP_REGION_MEMBRANE;
    memset(net->unit, 0, net->n_nodes * sizeof *net->unit);
    /* a third of the trace of a node's block of the tangent */
    for (size_t i = 0; i < 2 * net->n_elements; i++) {
        const double ratio =
            net->base_share ? network_mean_of_materials(net, i / 2, stiffness) / stiffness[0] : 1.0;
        net->unit[net->pair[i]] +=
            ratio * (net->scale ? net->scale[i / 2] : 1.0) * net->inverse_rest[i / 2] / 3.0;
    }
    if (net->ranks)
        net->ranks->complete(net->ranks, 1, net->unit);
    if (!net->stiffer)
        return;
    memset(net->stiffer, 0, net->n_nodes * sizeof *net->stiffer);
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        net->stiffer[net->pair[i]] += (scale ? scale[i / 2] : 1.0) * net->inverse_rest[i / 2] / 3.0;
    for (size_t i = 0; i < net->n_nodes; i++)
        net->stiffer[i] = net->unit[i] / net->stiffer[i];
}

bool network_has_dashpot(const palp_network *net) {
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++)
        if (network_material_at(net, r, &m) && m.material->dashpot_Ns > 0.0)
            return true;
    return false;
}

double network_beyond(const palp_network *net, const double *strain) {
    network_material m;
    double beyond = 0.0;
    for (size_t r = 0; r <= net->n_regions; r++) {
        if (!network_material_at(net, r, &m) || !(m.material->law.strain_max > 0.0))
            continue;
        double largest = 0.0;
        for (size_t i = 0; i < net->n_elements; i++)
            if ((!m.share || m.share[i] > 0.0) && (net->n_dead == 0 || net->scale[i] != 0.0))
                largest = fmax(largest, fabs(strain[i]));
        beyond = fmax(beyond, palp_law_beyond(&m.material->law, largest));
    }
    return network_largest_of_parts(net, beyond);
}

palp_status network_change_region(palp_network *net, size_t of, const double *part, double stiffness) {
    palp_status status = mesh_take_region(net->mesh, net->region[of].given.name, part);
    net->region[of].given.stiffness = stiffness;
    for (size_t r = 0; r <= of && !status; r++)
        if (net->region[r].given.shape != PALP_REGION_MEMBRANE)
            status = find_inside(net, r, net->region[r].inside);
    if (!status)
        status = network_scale_elements(net);
    network_find_units(net);
    palp_network_reset(net);
    return status;
}
