/* realtime_touch.c: what touches the tissue: forces, stiffness, and whether unmoved nodes are nearer to
 * equilibrium. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

/* An arm's force lasts if a step leaves at least this share of it. */
static const double LASTING = 0.9;

double realtime_outer_force(const palp_network *net) {
    double sum[3] = {0.0};
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        sum[i % 3] += net->outer[i];
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

void realtime_weigh(palp_realtime *rt) {
    memset(rt->weight, 0, rt->net->n_nodes * sizeof *rt->weight);
    NETWORK_EACH_TERM(rt->net, weigh, rt->net, rt->weight);
}

double realtime_own_stiffness(palp_realtime *rt) {
    double sum = 0.0;
    bool any = false;
    for (size_t i = 0; i < rt->net->n_terms; i++)
        any = any || rt->net->terms[i]->kind->weigh;
    if (!any)
        return 0.0;
    realtime_weigh(rt);
    for (size_t i = 0; i < rt->net->n_nodes; i++)
        sum += rt->weight[i] > 0.0 ? rt->net->unit[i] : 0.0;
    return 3.0 * rt->net->modulus * sum;
}

/* Do elements of constant length keep their forces in this step? */
static bool do_forces_outlast_step(const palp_network *net) {
    bool last = net->material.formulation == PALP_HISTORY && !network_has_dashpot(net);
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++)
        for (size_t j = 0; network_material_at(net, r, &m) && j < m.material->n_arms; j++)
            last = last && m.step->decay[j] > LASTING;
    return last;
}

bool realtime_may_stay(palp_realtime *rt, double norm) {
    palp_network *net = rt->net;
    const size_t size = 3 * net->n_nodes * sizeof *rt->q;
    double scale;
    if (!do_forces_outlast_step(net))
        return true;
    memcpy(rt->q, net->next.x, size);
    memcpy(rt->move, net->fint, size);
    memcpy(net->next.x, net->now.x, size);
    network_place(net, net->next.depth);
    NETWORK_EACH_TERM(net, follow, net);
    bool may = memcmp(net->next.x, net->now.x, size) != 0;
    if (!may) {
        memcpy(net->fint, rt->tissue, size);
        network_evaluate_terms(net);
        may = network_residual(net, &scale) < norm;
    }
    memcpy(net->next.x, rt->q, size);
    memcpy(net->fint, rt->move, size);
    network_evaluate_terms(net);
    network_residual(net, &scale);
    return may;
}
