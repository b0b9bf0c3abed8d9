/* palpation_lattice.c: the error of a lattice, by a finer one without a region.
 */
#include "palpation_internal.h"

#include "base/dense.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FINER = 1.6; /* cells a side of the finer lattice, over the other's */

static double mean_edge_of(const palp_mesh *mesh) {
    double sum = 0.0, unused[3];
    for (size_t i = 0; i < mesh->n_elements; i++)
        sum += mesh_direction(mesh, mesh->pairs + 2 * i, unused);
    return sum / (double)mesh->n_elements;
}

palp_status palpation_use_mesh(palpation_search *s) {
    s->n_nodes = s->mesh->n_nodes;
    s->edge = mean_edge_of(s->mesh);
    s->x = malloc(3 * s->n_nodes * PALPATION_LEVELS * s->n * sizeof *s->x);
    s->wanted = malloc(4 * s->n * sizeof *s->wanted);
    if (!s->x || !s->wanted)
        return PALP_ERR_NO_MEMORY;
    s->work = s->wanted + s->n;
    s->elastic = s->work + s->n;
    s->moved = s->elastic + s->n;
    return PALP_OK;
}

void palpation_free(palpation_search *s) {
    free(s->x);
    free(s->wanted);
    free(s->column);
    free(s->factor);
    free(s->source);
    palp_network_free(s->net);
    palp_mesh_free(s->mesh);
}

/* The search of the finer lattice; lengths stay in edges of the other. */
static palp_status make_finer(const palpation_search *s, palpation_search *f) {
    *f = (palpation_search){.kind = s->kind,
                            .model = s->model,
                            .source = malloc(sizeof *f->source),
                            .settings = s->settings,
                            .n = s->n,
                            .press = s->press,
                            .planned = s->planned};
    if (!f->source)
        return PALP_ERR_NO_MEMORY;
    f->model.mesh = f->source;
    *f->source = *s->source;
    for (int k = 0; k < 3; k++)
        f->source->nodes[k] = 1 + (size_t)ceil(FINER * (double)(s->source->nodes[k] - 1));
    memcpy(f->low, s->low, sizeof f->low);
    memcpy(f->high, s->high, sizeof f->high);
    f->source->n_regions--; /* what is hidden is not of the mesh yet */
    palp_status status = palp_model_mesh(&f->model, &f->mesh, NULL);
    f->source->n_regions++;
    if (!status)
        status = palpation_use_mesh(f);
    f->edge = s->edge;
    return status;
}

/* off[n]: the error with the region that s was last pressed with, NULL: of the tissue alone. */
static palp_status compare_with_finer(const palpation_search *s, const double *p, double *off) {
    palpation_search finer;
    palp_status status = make_finer(s, &finer);
    if (!status)
        status = p ? palpation_press_region(&finer, p, s->log_stiffness, NULL)
                   : palpation_press_tissue(&finer, NULL);
    for (size_t i = 0; i < s->n && !status; i++)
        off[i] = log(finer.work[i]) - log(s->work[i]);
    palpation_free(&finer);
    return status;
}

palp_status palpation_measure_lattice(palpation_search *s, palp_error *error) {
    palp_status status = palpation_press_tissue(s, error);
    if (!status && s->source->kind == PALP_MESH_LATTICE) {
        status = compare_with_finer(s, NULL, s->bare);
        status = palpation_lost(status) ? PALP_OK : status;
    }
    return status;
}

palp_status palpation_measure_region(palpation_search *s, const palpation_candidate *c) {
    memset(s->more, 0, s->n * sizeof *s->more);
    memset(s->change, 0, s->n * sizeof *s->change);
    palp_status status = palpation_press_region(s, c->p, c->log_stiffness, NULL);
    for (size_t i = 0; i < s->n && !status; i++)
        s->change[i] = log(s->work[i]) - s->tissue[i];
    if (!status && s->source->kind == PALP_MESH_LATTICE)
        status = compare_with_finer(s, c->p, s->moved);
    for (size_t i = 0; i < s->n && !status; i++)
        s->more[i] = s->moved[i] - s->bare[i];
    return palpation_lost(status) ? PALP_OK : status;
}

void palpation_use_region(palpation_search *s, double variance) {
    const double square = dense_dot(s->n, s->change, s->change);
    double along = 0.0;
    for (size_t i = 0; i < s->n; i++)
        along += s->change[i] * (log(s->work[i]) - s->tissue[i]);
    for (size_t i = 0; i < s->n; i++)
        s->moved[i] = s->bare[i] + (square > 0.0 ? along / square : 0.0) * s->more[i];
    palpation_set_errors(s, s->moved, variance);
}
