/* palpation_lattice.c: the error of a lattice, by a finer one without a region.
 */
#include "palpation_internal.h"

#include "base/dense.h"
#include "base/statistics.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double KNOWN = 4.0; /* degrees of freedom of the prior of errors (doc/palpation.md) */
static const double FINER = 1.6; /* cells a side of the finer lattice, over the other's */
static const double SOFT = 0.15; /* half width of the region's edge, in mean edges of the mesh */

static double mean_edge_of(const palp_mesh *mesh) {
    double sum = 0.0, unused[3];
    for (size_t i = 0; i < mesh->n_elements; i++)
        sum += mesh_direction(mesh, mesh->pairs + 2 * i, unused);
    return sum / (double)mesh->n_elements;
}

palp_status palpation_use_mesh(palpation_search *s) {
    s->n_nodes = s->mesh->n_nodes;
    s->edge = mean_edge_of(s->mesh);
    s->soft = SOFT * s->edge;
    s->x = malloc(3 * s->n_nodes * PALPATION_LEVELS * s->n * sizeof *s->x);
    s->measured = malloc(6 * s->n * sizeof *s->measured);
    if (!s->x || !s->measured)
        return PALP_ERR_NO_MEMORY;
    s->wanted = s->measured + s->n;
    s->tissue = s->wanted + s->n;
    s->work = s->tissue + s->n;
    s->elastic = s->work + s->n;
    s->moved = s->elastic + s->n;
    return PALP_OK;
}

void palpation_free(palpation_search *s) {
    if (s->finer)
        palpation_free(s->finer);
    free(s->finer);
    free(s->x);
    free(s->measured);
    free(s->source);
    palp_network_free(s->net);
    palp_mesh_free(s->mesh);
}

/* Lengths stay in edges of the other mesh. */
static palp_status make_finer(palpation_search *s) {
    palpation_search *f = calloc(1, sizeof *f);
    s->finer = f;
    if (!f || !(f->source = malloc(sizeof *f->source)))
        return PALP_ERR_NO_MEMORY;
    f->model = s->model;
    f->model.mesh = f->source;
    *f->source = *s->source;
    for (int k = 0; k < 3; k++)
        f->source->nodes[k] = 1 + (size_t)ceil(FINER * (double)(s->source->nodes[k] - 1));
    f->settings = s->settings;
    f->n = s->n;
    f->press = s->press;
    f->planned = s->planned;
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

/* error[n], of the region that both have last been pressed with. */
static void compare_lattices(const palpation_search *s, double *error) {
    for (size_t i = 0; i < s->n; i++)
        error[i] = log(s->finer->work[i]) - log(s->work[i]);
}

/* A common factor stays, as the network may have been calibrated with it: the size of this factor is the
 * standard deviation of a gain that is known. */
static void set_priors(palpation_search *s) {
    const double n = (double)s->n, square = dense_dot(s->n, s->tissue, s->tissue) / n;
    s->known_squares = KNOWN * square;
    s->known = square > 0.0 ? KNOWN : 0.0;
    s->gain_sd = fmax(fabs(s->mean), 1e-6);
    if (s->settings->gain_known)
        s->gain_share = square > 0.0 ? 1.0 - 1.0 / sqrt(1.0 + n * s->mean * s->mean / square) : 0.0;
}

palp_status palpation_measure_lattice(palpation_search *s, palp_error *error) {
    palp_status status = palpation_press_tissue(s, error);
    memset(s->tissue, 0, s->n * sizeof *s->tissue);
    if (!status && s->source->kind == PALP_MESH_LATTICE) {
        status = make_finer(s);
        if (!status) {
            s->finer->kind = s->kind;
            status = palpation_press_tissue(s->finer, NULL);
        }
        if (!status)
            compare_lattices(s, s->tissue);
        status = palpation_lost(status) ? PALP_OK : status;
    }
    s->mean = statistics_mean(s->tissue, s->n);
    for (size_t i = 0; i < s->n; i++)
        s->tissue[i] -= s->mean;
    set_priors(s);
    return status;
}

void palpation_correct_for_tissue(palpation_search *s) {
    for (size_t i = 0; i < s->n; i++)
        s->wanted[i] = s->measured[i] - s->tissue[i];
}
