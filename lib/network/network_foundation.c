/* network_foundation.c: springs from nodes to their positions at rest. */
#include "network_internal.h"

#include <stdlib.h>

typedef struct foundation {
    network_term term;
    double *stiffness; /* [3 n_nodes] N/m */
} foundation;

static void add_foundation_residual(const network_term *term, const palp_network *net, double *r,
                                    double *squares) {
    const double *k = ((const foundation *)term)->stiffness;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0) {
            r[i] -= k[i] * (net->next.x[i] - net->rest[i]);
            *squares += k[i] * net->next.x[i] * k[i] * net->next.x[i];
        }
}

static void add_foundation_diagonal(const network_term *term, const palp_network *net, double *d) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        d[i] += ((const foundation *)term)->stiffness[i];
}

static bool add_foundation_energy(const network_term *term, const palp_network *net, double *energy) {
    const double *k = ((const foundation *)term)->stiffness;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0) {
            double moved = net->next.x[i] - net->rest[i];
            *energy += 0.5 * k[i] * moved * moved;
        }
    return true;
}

static const network_term_kind FOUNDATION = {.residual = add_foundation_residual,
                                             .diagonal = add_foundation_diagonal,
                                             .energy = add_foundation_energy};

static foundation *find_foundation_term(const palp_network *net) {
    return (foundation *)network_find_term(net, &FOUNDATION);
}

const double *network_foundation(const palp_network *net) {
    const foundation *t = find_foundation_term(net);
    return t ? t->stiffness : NULL;
}

static palp_status add_foundation_term(palp_network *net) {
    foundation *t = network_term_new(&FOUNDATION, sizeof *t);
    if (t)
        t->stiffness = arena_take(&t->term.memory, 3 * net->n_nodes, sizeof *t->stiffness);
    return network_add_terms(net, 1, (network_term *[]){(network_term *)t});
}

palp_status network_set_foundation(palp_network *net, const char *set, double share) {
    const int32_t *nodes;
    size_t n;
    double start[PALP_REGIONS_MAX + 1];
    palp_status status = palp_mesh_set(net->mesh, set, &n, &nodes);
    if (!status && !find_foundation_term(net))
        status = add_foundation_term(net);
    if (status)
        return status;
    unsigned char *listed = calloc(net->n_nodes, 1);
    if (!listed)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++)
        listed[nodes[i]] = 1;
    double *stiffness = find_foundation_term(net)->stiffness;
    network_stiffnesses(net, 0.0, false, start);
    for (size_t j = 0; j < 2 * net->n_elements; j++)
        for (size_t k = 0; k < 3 && listed[net->pair[j]]; k++)
            stiffness[3 * (size_t)net->pair[j] + k] += share * network_mean_of_materials(net, j / 2, start) *
                                                       net->inverse_rest[j / 2] *
                                                       (net->scale ? net->scale[j / 2] : 1.0);
    free(listed);
    return PALP_OK;
}
