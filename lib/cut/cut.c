/* cut.c: which elements are whole, what hangs loose, and what that adds to the network's equations. */
#include "mesh/mesh_internal.h"
#include "contact/tool_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LOOSE = 1e-3;    /* spring of a loose node, of its stiffness at rest */
static const double MECHANISM = 1e-6; /* diagonal of any other node of a cut network */
static const double SMALL_STRAIN = 0.1; /* where the stiffness is taken: a law may start from 0 */

void network_cut_free(network_cut *cut) {
    if (!cut)
        return;
    free(cut->alive);
    free(cut->loose);
    free(cut->broken);
    free(cut->cut);
    free(cut->root);
    free(cut->side);
    free(cut->whole);
    free(cut->stiffness);
    free(cut->diagonal);
    free(cut->first);
    free(cut->around);
    free(cut->neighbour);
    free(cut->triangles);
    free(cut);
}

/* ---- what is loose ------------------------------------------------------------------------------- */

/* A part is held if one of its nodes has an axis that is no unknown, or is held by a hand. */
static void find_loose(palp_network *net) {
    network_cut *cut = net->cut;
    palp_mesh_parts(net->n_nodes, net->n_elements, net->pair, cut->alive, cut->root);
    memset(cut->loose, 1, net->n_nodes);
    for (size_t i = 0; i < net->n_nodes; i++)
        if (net->dof[3 * i] < 0 || net->dof[3 * i + 1] < 0 || net->dof[3 * i + 2] < 0)
            cut->loose[cut->root[i]] = 0;
    for (size_t i = 0; net->load && i < load_memory_of(&net->now)->n_holds; i++)
        cut->loose[cut->root[load_holds(net->load, &net->now)[i].node]] = 0;
    cut->n_loose = 0;
    for (size_t i = 0; i < net->n_nodes; i++) { /* a root is the lowest node of its part: it is known by now */
        cut->loose[i] = cut->loose[cut->root[i]];
        cut->n_loose += cut->loose[i];
        cut->diagonal[i] = cut->n_cut == 0 ? 0.0 : cut->stiffness[i] * (cut->loose[i] ? LOOSE : MECHANISM);
    }
}

void network_cut_held(palp_network *net) {
    find_loose(net);
}

double network_cut_spring(const network_cut *cut, size_t i) {
    return cut->loose[i] ? cut->diagonal[i] : 0.0;
}

void network_cut_mark(network_cut *cut, size_t element) {
    if (!cut->alive[element])
        return;
    cut->alive[element] = 0;
    cut->cut[cut->n_cut++] = (int32_t)element;
}

/* What follows from the elements that were marked since the last time. The next step starts from the state as it is. */
static size_t update(palp_network *net) {
    network_cut *cut = net->cut;
    size_t news = cut->n_cut - cut->n_known;
    for (size_t k = cut->n_known; k < cut->n_cut; k++) {
        size_t i = (size_t)cut->cut[k];
        net->scale[i] = 0.0;
        if (net->now.vector)
            memset(net->now.vector + 3 * i, 0, 3 * sizeof *net->now.vector);
    }
    find_loose(net);
    network_cut_surface_update(cut);
    cut->n_known = cut->n_cut;
    net->surface = cut->triangles;
    net->n_surface = cut->n_triangles;
    net->surface_changes++;
    net->n_past = 0;
    net->trial = net->exact = false;
    return news;
}

static void make_whole(palp_network *net) {
    network_cut *cut = net->cut;
    cut->n_cut = cut->n_known = 0;
    memset(cut->alive, 1, net->n_elements);
    memset(cut->broken, 0, cut->n_tetrahedra);
    memcpy(net->scale, cut->whole, net->n_elements * sizeof *net->scale);
}

void network_cut_set(palp_network *net, const unsigned char *alive) {
    make_whole(net);
    for (size_t i = 0; i < net->n_elements; i++)
        if (!alive[i])
            network_cut_mark(net->cut, i);
    update(net);
}

void network_cut_reset(palp_network *net) {
    network_cut *cut = net->cut;
    double stiffness;
    palp_law_stiffness(&net->material.law, SMALL_STRAIN, &stiffness, NULL);
    for (size_t j = 0; j < net->material.n_arms; j++)
        stiffness += net->material.arms[j].stiffness_N;
    memset(cut->stiffness, 0, net->n_nodes * sizeof *cut->stiffness);
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        cut->stiffness[net->pair[i]] += stiffness * cut->whole[i / 2] * net->inverse_rest[i / 2];
    make_whole(net);
    update(net);
}

bool network_cut_measure(palp_network *net, double collapsed) {
    const network_cut *cut = net->cut;
    bool sound = true;
    for (size_t k = 0; k < cut->n_cut; k++) {
        size_t i = (size_t)cut->cut[k];
        net->strain[i] = 0.0;
        net->inverse_length[i] = net->inverse_rest[i];
        net->direction[3 * i] = net->direction[3 * i + 1] = net->direction[3 * i + 2] = 0.0;
    }
    for (size_t i = 0; i < net->n_elements; i++)
        sound = sound && net->strain[i] > collapsed;
    return sound;
}

/* ---- the public calls ---------------------------------------------------------------------------- */

static palp_status allocate(const palp_network *net, network_cut *cut) {
    size_t n = net->n_nodes, m = net->n_elements;
    cut->alive = malloc(m);
    cut->cut = malloc(m * sizeof *cut->cut);
    cut->whole = malloc(m * sizeof *cut->whole);
    cut->loose = malloc(n);
    cut->root = malloc(n * sizeof *cut->root);
    cut->side = malloc(n);
    cut->stiffness = malloc(n * sizeof *cut->stiffness);
    cut->diagonal = malloc(n * sizeof *cut->diagonal);
    bool ok = cut->alive && cut->cut && cut->whole && cut->loose && cut->root && cut->side && cut->stiffness &&
              cut->diagonal;
    return ok ? network_cut_surface_create(net, cut) : PALP_ERR_NO_MEMORY;
}

palp_status palp_network_enable_cutting(palp_network *net) {
    if (!net || net->cut)
        return PALP_ERR_ARGUMENT;
    network_cut *cut = calloc(1, sizeof *cut);
    double *scale = net->scale ? net->scale : malloc(net->n_elements * sizeof *scale);
    palp_status status = cut && scale ? allocate(net, cut) : PALP_ERR_NO_MEMORY;
    if (status) {
        network_cut_free(cut);
        if (scale != net->scale)
            free(scale);
        return status;
    }
    for (size_t i = 0; i < net->n_elements; i++)
        cut->whole[i] = net->scale ? net->scale[i] : 1.0;
    net->scale = scale;
    net->cut = cut;
    network_cut_reset(net);
    return PALP_OK;
}

static palp_status finish(palp_network *net, size_t *n) {
    size_t news = net->cut->n_cut > net->cut->n_known ? update(net) : 0;
    if (n)
        *n = news;
    return PALP_OK;
}

static bool finite9(const double *v) {
    double sum = 0.0;
    for (size_t i = 0; i < 9; i++)
        sum += fabs(v[i]);
    return isfinite(sum);
}

palp_status palp_network_cut(palp_network *net, const double corners_m[9], size_t *n_cut) {
    if (!net || !net->cut || !corners_m || !finite9(corners_m))
        return PALP_ERR_ARGUMENT;
    network_cut_blade(net, corners_m);
    return finish(net, n_cut);
}

palp_status palp_network_cut_elements(palp_network *net, size_t n, const int32_t *elements) {
    if (!net || !net->cut || (n > 0 && !elements))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (elements[i] < 0 || (size_t)elements[i] >= net->n_elements)
            return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        network_cut_mark(net->cut, (size_t)elements[i]);
    return finish(net, NULL);
}

palp_status palp_network_set_tearing(palp_network *net, double strain, double force_N) {
    if (!net || !net->cut || !(strain >= 0.0 && isfinite(strain)) || !(force_N >= 0.0 && isfinite(force_N)))
        return PALP_ERR_ARGUMENT;
    net->cut->tear_strain = strain;
    net->cut->tear_force = force_N;
    return PALP_OK;
}

palp_status palp_network_tear(palp_network *net, size_t *n_torn) {
    if (!net || !net->cut)
        return PALP_ERR_ARGUMENT;
    double strain = net->cut->tear_strain > 0.0 ? net->cut->tear_strain : INFINITY;
    double force = net->cut->tear_force > 0.0 ? net->cut->tear_force : INFINITY;
    for (size_t i = 0; i < net->n_elements; i++)
        if (net->now.history.strain[i] > strain || net->now.element[i] > force)
            network_cut_mark(net->cut, i);
    return finish(net, n_torn);
}

const unsigned char *palp_network_alive(const palp_network *net) {
    return net->cut ? net->cut->alive : NULL;
}

size_t palp_network_loose(const palp_network *net, unsigned char *loose) {
    if (loose && net->cut)
        memcpy(loose, net->cut->loose, net->n_nodes);
    else if (loose)
        memset(loose, 0, net->n_nodes);
    return net->cut ? net->cut->n_loose : 0;
}
