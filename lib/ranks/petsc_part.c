/* petsc_part.c: the part of a network that a process has. */
#include "petsc_internal.h"

#include "base/file.h"
#include "mesh/mesh_internal.h"

#include <stdlib.h>

/* ---- making -------------------------------------------------------------------------------------- */

static void free_part(network_ranks *ranks) {
    part *p = (part *)ranks;
    VecDestroy(&p->x);
    VecDestroy(&p->f);
    VecDestroy(&p->sum);
    VecDestroy(&p->local);
    VecScatterDestroy(&p->exchange);
    MatDestroy(&p->tangent);
    SNESDestroy(&p->snes);
    free(p->own);
    free(p->number);
    free(p->node);
    free(p->element);
    free(p->solid);
    free(p->by_regions);
    free(p->value);
    free(p->pair);
    free(p->node_block);
    free(p);
}

static palp_status make_vectors(part *p) {
    IS from, to;
    TRY(VecCreateMPI(p->comm, 3 * p->n_own, PETSC_DETERMINE, &p->x));
    TRY(VecSetBlockSize(p->x, 3));
    TRY(VecDuplicate(p->x, &p->f));
    TRY(VecDuplicate(p->x, &p->sum));
    TRY(VecCreateSeq(PETSC_COMM_SELF, 3 * (PetscInt)p->n_nodes, &p->local));
    TRY(ISCreateBlock(p->comm, 3, (PetscInt)p->n_nodes, p->number, PETSC_COPY_VALUES, &from));
    TRY(ISCreateStride(PETSC_COMM_SELF, 3 * (PetscInt)p->n_nodes, 0, 1, &to));
    TRY(VecScatterCreate(p->x, from, p->local, to, &p->exchange));
    TRY(ISDestroy(&from));
    TRY(ISDestroy(&to));
    return PALP_OK;
}

/* PETSc's numbers of the part's nodes, and which of them this process owns. */
static palp_status number_part(part *p, const palp_ranks *ranks, size_t n_whole, const int32_t *owner) {
    PetscInt *number = malloc(n_whole * sizeof *number);
    p->own = malloc(p->n_nodes + 1);
    p->number = malloc((p->n_nodes + 1) * sizeof *p->number);
    palp_status status = number && p->own && p->number && !number_nodes(owner, n_whole, ranks->count, number)
                             ? PALP_OK
                             : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < p->n_nodes && !status; i++) {
        p->own[i] = owner[p->node[i]] == ranks->rank;
        p->number[i] = number[p->node[i]];
        p->n_own += p->own[i];
    }
    p->hook.own = p->own;
    free(number);
    return status;
}

/* The part of this process, and the mesh of it. */
static palp_status divide(const palp_ranks *ranks, const palp_mesh *whole, bool surface, part *p,
                          palp_mesh **mesh) {
    const size_t n = palp_mesh_node_count(whole);
    int32_t *owner = malloc(n * sizeof *owner);
    palp_status status = part_agree(ranks->comm, owner ? PALP_OK : PALP_ERR_NO_MEMORY, NULL);
    if (!status && partition_nodes(ranks, whole, owner))
        status = PALP_ERR_NO_MEMORY;
    if (!status)
        status = mesh_part(whole, owner, ranks->rank, surface, mesh, &p->node, &p->element, &p->solid);
    if (!status) {
        p->n_nodes = palp_mesh_node_count(*mesh);
        status = number_part(p, ranks, n, owner);
    }
    free(owner);
    return part_agree(ranks->comm, status, NULL);
}

/* What the regions make of the part's elements and solids, from that of all of them, or NULL without
 * regions. */
static palp_status take_scales(part *p, const palp_mesh *whole, const palp_mesh *mesh, const double *scale) {
    size_t corners, n = mesh->n_elements;
    const int32_t *node;
    const size_t n_solids = mesh_solids(mesh, &corners, &node);
    if (!scale)
        return PALP_OK;
    p->by_regions = malloc((n + n_solids + 1) * sizeof *p->by_regions);
    for (size_t i = 0; i < n && p->by_regions; i++)
        p->by_regions[i] = scale[p->element[i]];
    for (size_t i = 0; i < n_solids && p->by_regions; i++)
        p->by_regions[n + i] = scale[whole->n_elements + (size_t)p->solid[i]];
    p->hook.element_scale = p->by_regions;
    p->hook.solid_scale = p->by_regions + n;
    return p->by_regions ? PALP_OK : PALP_ERR_NO_MEMORY;
}

static part *new_part(const palp_ranks *ranks) {
    part *p = calloc(1, sizeof *p);
    if (p) {
        p->comm = ranks->comm;
        p->hook = (network_ranks){.rank = ranks->rank,
                                  .count = ranks->count,
                                  .complete = part_complete,
                                  .sum = part_sum,
                                  .largest = part_largest,
                                  .newton = part_newton,
                                  .factor = part_factor,
                                  .solve = part_solve,
                                  .free = free_part};
    }
    return p;
}

/* ---- the public call ----------------------------------------------------------------------------- */

/* The first region with a material or fibres of its own; NULL = none. */
static const char *unsupported_region(const palp_network_settings *s) {
    for (size_t r = 0; r < s->n_regions; r++) {
        const palp_region *region = &s->regions[r];
        if (!(region->stiffness > 0.0) || region->fibre_Pa > 0.0)
            return region->name;
    }
    return NULL;
}

/* Names the first feature that is not supported. */
static palp_status refuse_unsupported(const palp_model *model, const palp_network_settings *s,
                                      palp_error *error) {
    char what[PALP_REGION_NAME_MAX + 48] = "";
    const char *region = unsupported_region(s);
    if (model->n_effects > 0)
        snprintf(what, sizeof what, "the effect %s", palp_effect_look_up(model->effects[0].id)->id);
    else if (region)
        snprintf(what, sizeof what, "the region \"%.*s\"", PALP_REGION_NAME_MAX - 1, region);
    else if (s->density_kg_m3 > 0.0)
        snprintf(what, sizeof what, "a density");
    else if (s->branch != PALP_BRANCH_CONTINUE)
        snprintf(what, sizeof what, "the stable branch");
    return what[0] ? palp_error_set(error, PALP_ERR_UNSUPPORTED,
                                    "a network over several processes cannot have %s; run it in one", what)
                   : PALP_OK;
}

static bool are_solids_joined(const palp_mesh *mesh) {
    size_t corners;
    const int32_t *node;
    const size_t n = mesh_solids(mesh, &corners, &node);
    bool joined = n > 0;
    for (size_t i = 0; i < n && joined; i++)
        joined = network_is_solid_joined(mesh, corners, node + corners * i);
    return joined;
}

/* The same for all elements and solids of the whole mesh, whose neighbours may be in other parts; for the
 * caller to free. */
static palp_status find_scales(const palp_mesh *whole, const palp_material *material,
                               const palp_network_settings *s, size_t n_supports,
                               const palp_support *supports, double **scale, palp_error *error) {
    size_t corners;
    const int32_t *node;
    const size_t n = whole->n_elements + mesh_solids(whole, &corners, &node);
    if (s->n_regions == 0 && !network_has_edges(whole, s))
        return PALP_OK;
    *scale = malloc(n * sizeof **scale);
    return *scale ? network_scales_of_regions(whole, material, s, n_supports, supports, *scale,
                                              *scale + whole->n_elements, error)
                  : PALP_ERR_NO_MEMORY;
}

static palp_status make_network(palp_ranks *ranks, const palp_model *model, const palp_mesh *whole,
                                const double *scale, size_t n_supports, const palp_support *supports,
                                const palp_network_settings *settings, bool tools, palp_network **network,
                                palp_error *error) {
    palp_network_settings own = *settings;
    part *p = new_part(ranks);
    palp_mesh *mesh = NULL;
    palp_status status = part_agree(ranks->comm, p ? PALP_OK : PALP_ERR_NO_MEMORY, NULL);
    if (!status)
        status = divide(ranks, whole, tools, p, &mesh);
    if (!status)
        status = part_agree(ranks->comm, take_scales(p, whole, mesh, scale), NULL);
    if (!status)
        status = part_agree(ranks->comm, make_vectors(p), NULL);
    if (!status) {
        p->hook.volume = network_wants_volume(settings);
        p->hook.joined = p->hook.volume && are_solids_joined(whole);
        own.n_regions = 0;
        status =
            network_create_part(mesh, &model->material, n_supports, supports, &own, &p->hook, network, error);
    } else {
        palp_error_set(error, status, "dividing the network: %s", palp_status_text(status));
        if (p)
            free_part(&p->hook);
    }
    palp_mesh_free(mesh);
    return status;
}

palp_status palp_ranks_network(palp_ranks *ranks, const palp_model *model, const palp_mesh *mesh,
                               size_t n_supports, const palp_support *supports,
                               const palp_network_settings *settings, bool tools, palp_network **network,
                               palp_error *error) {
    if (!ranks || !model || !network)
        return palp_error_null(error);
    palp_network_settings own = settings ? *settings : palp_network_settings_default();
    palp_support usual[2];
    palp_mesh *made = NULL;
    double *scale = NULL;
    palp_supports_default(usual);
    if (!supports) {
        supports = usual;
        n_supports = 2;
    }
    network_take_settings(model, &own);
    palp_status status = refuse_unsupported(model, &own, error);
    if (!status && !mesh)
        status = part_agree(ranks->comm, palp_model_mesh(model, &made, error), error);
    const palp_mesh *whole = mesh ? mesh : made;
    if (!status)
        status = part_agree(ranks->comm,
                            find_scales(whole, &model->material, &own, n_supports, supports, &scale, error),
                            error);
    if (!status)
        status = make_network(ranks, model, whole, scale, n_supports, supports, &own, tools, network, error);
    free(scale);
    palp_mesh_free(made);
    return status;
}
