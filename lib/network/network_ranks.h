/* network_ranks.h: what a network that is one part of a larger one asks of the processes with the other
 * parts. Internal. All processes make the same calls in the same order. A node on the border of parts is in
 * several of them; each element and solid is in one. Terms are the same in all parts and must see all nodes
 * on which they act, unless their kind adds up. */
#ifndef NETWORK_RANKS_H
#define NETWORK_RANKS_H

#include <palpate/network.h>

typedef struct network_ranks network_ranks;

struct network_ranks {
    int rank, count;          /* this process of so many */
    const unsigned char *own; /* [n_nodes] nonzero: the node counts here, in no other part */

    /* What depends on solids and regions of the whole: */
    bool volume;                               /* solids resist a change of volume */
    bool joined;                               /* there is an element between any two corners of each solid */
    const double *element_scale, *solid_scale; /* as network_scales_of_regions, of this part; or NULL */

    /* Adds up values[components n_nodes] of each node over the parts that have it; components: 1 or 3. */
    void (*complete)(network_ranks *ranks, size_t components, double *values);
    void (*sum)(network_ranks *ranks, int n, double *values); /* of all parts, in all */
    double (*largest)(network_ranks *ranks, double value);

    /* As network_newton, network_factor and network_solve. */
    palp_status (*newton)(network_ranks *ranks, palp_network *net, palp_step_info *info);
    palp_status (*factor)(network_ranks *ranks, palp_network *net);
    void (*solve)(network_ranks *ranks, palp_network *net, double *x);
    void (*free)(network_ranks *ranks);
};

/* A network of a part's mesh, which then owns ranks, also where this fails. Otherwise as palp_network_create.
 */
palp_status network_create_part(const palp_mesh *mesh, const palp_material *material, size_t n_supports,
                                const palp_support *supports, const palp_network_settings *settings,
                                network_ranks *ranks, palp_network **network, palp_error *error);

#endif
