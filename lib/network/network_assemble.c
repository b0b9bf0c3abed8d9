/* network_assemble.c: forces, tangent and their sums over the network. */
#include "network_internal.h"

#include <math.h>
#include <string.h>

static const double COLLAPSED = -1.0 + 1e-9; /* strain of an element without length */

static bool measure(palp_network *net) {
    const double *x = net->next.x;
    bool sound = true;
    for (size_t i = 0; i < net->n_elements; i++) {
        const double *a = x + 3 * net->pair[2 * i], *b = x + 3 * net->pair[2 * i + 1];
        double d0 = b[0] - a[0], d1 = b[1] - a[1], d2 = b[2] - a[2];
        double length = sqrt(d0 * d0 + d1 * d1 + d2 * d2), inverse = 1.0 / length;
        net->strain[i] = length * net->inverse_rest[i] - 1.0;
        net->inverse_length[i] = inverse;
        net->direction[3 * i] = d0 * inverse;
        net->direction[3 * i + 1] = d1 * inverse;
        net->direction[3 * i + 2] = d2 * inverse;
        sound = sound && net->strain[i] > COLLAPSED;
    }
    return net->cut && net->cut->n_cut > 0 ? network_cut_measure(net, COLLAPSED) : sound;
}

/* Sums the forces of the elements on their nodes. Elements come grouped by their first node, whose share is
 * summed apart: adding to memory each time would wait for the last addition. */
static void sum_forces(palp_network *net) {
    const double carry = net->step.carry, *old = net->now.vector;
    double *vector = net->next.vector, *fint = net->fint;
    memset(fint, 0, 3 * net->n_nodes * sizeof *fint);
    for (size_t i = 0; i < net->n_elements;) {
        const int32_t first = net->pair[2 * i];
        double sum[3] = {0.0};
        for (; i < net->n_elements && net->pair[2 * i] == first; i++) {
            const double *n = net->direction + 3 * i, force = net->force[i];
            double f[3] = {force * n[0], force * n[1], force * n[2]};
            if (vector)
                for (size_t k = 0; k < 3; k++)
                    vector[3 * i + k] = f[k] += carry * old[3 * i + k];
            double *b = fint + 3 * net->pair[2 * i + 1];
            for (size_t k = 0; k < 3; k++) {
                sum[k] += f[k];
                b[k] -= f[k];
            }
        }
        for (size_t k = 0; k < 3; k++)
            fint[3 * first + (int32_t)k] += sum[k];
    }
}

bool network_evaluate(palp_network *net) {
    if (!measure(net))
        return false;
    element_trial(&net->material, &net->step, net->n_elements, net->strain, &net->now.history,
                  &net->next.history, net->force, net->tangent);
    for (size_t i = 0; i < net->n_elements && net->scale; i++) {
        net->force[i] *= net->scale[i];
        net->tangent[i] *= net->scale[i];
    }
    sum_forces(net);
    if (net->load)
        network_load_evaluate(net);
    double sum = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        sum += net->fint[i];
    return isfinite(sum);
}

double network_residual(palp_network *net, double *scale) {
    double residual = 0.0, force = 0.0, noise = 0.0, heavy = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        if (net->dof[i] < 0)
            continue;
        double r = net->fint[i];
        if (net->inertia > 0.0) {
            double pull = net->mass[i / 3] * net->inertia * net->next.x[i];
            r -= pull - net->inertia_rhs[i];
            heavy += pull * pull;
        }
        if (net->load)
            r += network_load_force(net->load)[i];
        if (net->grip) {
            r -= net->grip[i] * (net->next.x[i] - net->rest[i]);
            heavy += net->grip[i] * net->next.x[i] * net->grip[i] * net->next.x[i];
        }
        if (net->cut && net->cut->n_loose > 0) {
            double spring = network_cut_spring(net->cut, i / 3);
            r -= spring * (net->next.x[i] - net->now.x[i]);
            heavy += spring * net->next.x[i] * spring * net->next.x[i];
        }
        net->rhs[net->dof[i]] = r;
        residual += r * r;
    }
    for (size_t i = 0; i < net->n_elements; i++) {
        force += net->force[i] * net->force[i];
        noise += net->tangent[i] * net->tangent[i];
    }
    /* positions are rounded: strains are known to a few 1e-16, forces to that times the tangent, and the
     * mass terms and those of a firm grip to that times theirs, which may be large */
    if (net->load)
        heavy += network_load_size(net->load);
    *scale = net->settings.tolerance * sqrt(force) + 2e-15 * sqrt(noise) + 1e-15 * sqrt(heavy);
    return sqrt(residual);
}

/* k = (tangent / L0) n n' + (force / L) (1 - n n'), lower triangle xx yx yy zx zy zz. */
static inline void element_block(const palp_network *net, size_t i, double k[6]) {
    const double *n = net->direction + 3 * i;
    double across = net->force[i] * net->inverse_length[i];
    double along = net->tangent[i] * net->inverse_rest[i] - across;
    double p0 = along * n[0], p1 = along * n[1];
    k[0] = p0 * n[0] + across;
    k[1] = p0 * n[1];
    k[2] = p1 * n[1] + across;
    k[3] = p0 * n[2];
    k[4] = p1 * n[2];
    k[5] = along * n[2] * n[2] + across;
}

/* Diagonal of the tangent that is no element's. */
static inline void own_terms(const palp_network *net, size_t i, double shift, double own[3]) {
    double add = shift;
    if (net->inertia > 0.0)
        add += net->mass[i] * net->inertia;
    if (net->cut)
        add += net->cut->diagonal[i];
    for (size_t k = 0; k < 3; k++)
        own[k] = add + (net->grip ? net->grip[3 * i + k] : 0.0);
}

size_t network_node_blocks(const palp_network *net, double *block, size_t max, load_coupling *coupling) {
    memset(block, 0, 6 * net->n_nodes * sizeof *block);
    for (size_t i = 0; i < net->n_nodes; i++) {
        double own[3];
        own_terms(net, i, 0.0, own);
        block[6 * i] = own[0];
        block[6 * i + 2] = own[1];
        block[6 * i + 5] = own[2];
    }
    return net->load ? network_load_blocks(net, block, max, coupling) : 0;
}

void network_assemble(palp_network *net, double shift) {
    double *restrict value = linsys_values(net->ls), *restrict block = net->node_block;
    memset(value, 0, linsys_value_count(net->ls) * sizeof *value);
    memset(block, 0, 6 * net->n_nodes * sizeof *block);
    for (size_t i = 0; i < net->n_elements;) {
        const int32_t first = net->pair[2 * i];
        double sum[6] = {0.0};
        for (; i < net->n_elements && net->pair[2 * i] == first; i++) {
            double k[6], *b = block + 6 * net->pair[2 * i + 1];
            const uint32_t *s = net->slot + 9 * i;
            element_block(net, i, k);
            for (size_t j = 0; j < 6; j++)
                sum[j] += k[j];
            for (size_t j = 0; j < 6; j++)
                b[j] += k[j];
            value[s[0]] = -k[0];
            value[s[1]] = value[s[3]] = -k[1];
            value[s[2]] = value[s[6]] = -k[3];
            value[s[4]] = -k[2];
            value[s[5]] = value[s[7]] = -k[4];
            value[s[8]] = -k[5];
        }
        for (size_t j = 0; j < 6; j++)
            block[6 * first + (int32_t)j] += sum[j];
    }
    for (size_t i = 0; i < net->n_nodes; i++) {
        const uint32_t *s = net->slot_node + 6 * i;
        double *b = block + 6 * i, own[3];
        own_terms(net, i, shift, own);
        b[0] += own[0];
        b[2] += own[1];
        b[5] += own[2];
        for (size_t j = 0; j < 6; j++)
            value[s[j]] = b[j];
    }
    if (net->load)
        network_load_assemble(net);
}

palp_status network_factor(palp_network *net, double shift, int *negative) {
    network_assemble(net, shift);
    return linsys_factor(net->ls, negative);
}

/* k (vb - va) of element i. */
static void block_times(const palp_network *net, size_t i, const double *va, const double *vb, double out[3]) {
    double k[6], d[3] = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
    element_block(net, i, k);
    out[0] = k[0] * d[0] + k[1] * d[1] + k[3] * d[2];
    out[1] = k[1] * d[0] + k[2] * d[1] + k[4] * d[2];
    out[2] = k[3] * d[0] + k[4] * d[1] + k[5] * d[2];
}

void network_tangent_times(const palp_network *net, const double *u, double *out) {
    for (size_t i = 0; i < net->n_nodes; i++) {
        double own[3];
        own_terms(net, i, 0.0, own);
        for (size_t k = 0; k < 3; k++)
            out[3 * i + k] = own[k] * u[3 * i + k];
    }
    for (size_t i = 0; i < net->n_elements;) {
        const int32_t first = net->pair[2 * i];
        const double *a = u + 3 * first;
        double sum[3] = {0.0};
        for (; i < net->n_elements && net->pair[2 * i] == first; i++) {
            const double *n = net->direction + 3 * i, *b = u + 3 * net->pair[2 * i + 1];
            double *o = out + 3 * net->pair[2 * i + 1], d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
            double across = net->force[i] * net->inverse_length[i];
            double along = (net->tangent[i] * net->inverse_rest[i] - across) * (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
            for (size_t k = 0; k < 3; k++) {
                double f = along * n[k] + across * d[k];
                sum[k] += f;
                o[k] += f;
            }
        }
        for (size_t k = 0; k < 3; k++)
            out[3 * first + (int32_t)k] -= sum[k];
    }
    if (net->load)
        network_load_times(net, u, out);
}

void network_drive_column(palp_network *net, double *column) {
    memset(column, 0, net->n_free * sizeof *column);
    for (size_t i = 0; i < net->n_elements; i++) {
        size_t a = 3 * (size_t)net->pair[2 * i], b = 3 * (size_t)net->pair[2 * i + 1];
        double f[3];
        block_times(net, i, net->motion + a, net->motion + b, f);
        for (size_t k = 0; k < 3; k++) {
            if (net->dof[a + k] >= 0)
                column[net->dof[a + k]] += f[k];
            if (net->dof[b + k] >= 0)
                column[net->dof[b + k]] -= f[k];
        }
    }
    if (net->load)
        network_load_drive(net, column);
}

bool network_energy(palp_network *net, double *energy) {
    double *psi = net->scratch, sum = 0.0;
    if (!element_energy(&net->material, &net->step, net->n_elements, net->strain, &net->now.history, psi,
                        psi + net->n_elements))
        return false;
    for (size_t i = 0; i < net->n_elements; i++)
        sum += (net->scale ? net->scale[i] : 1.0) * psi[i] / net->inverse_rest[i];
    for (size_t i = 0; i < 3 * net->n_nodes && net->grip; i++)
        if (net->dof[i] >= 0) {
            double moved = net->next.x[i] - net->rest[i];
            sum += 0.5 * net->grip[i] * moved * moved;
        }
    for (size_t i = 0; i < 3 * net->n_nodes && net->cut && net->cut->n_loose > 0; i++) {
        double moved = net->next.x[i] - net->now.x[i];
        sum += 0.5 * network_cut_spring(net->cut, i / 3) * moved * moved;
    }
    if (net->load && !network_load_energy(net, &sum))
        return false;
    if (net->inertia > 0.0)
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            if (net->dof[i] >= 0) {
                double x = net->next.x[i];
                sum += x * (0.5 * net->mass[i / 3] * net->inertia * x - net->inertia_rhs[i]);
            }
    *energy = sum;
    return true;
}

double network_drive_force(const palp_network *net) {
    double force = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        force -= net->motion[i] * net->fint[i];
    for (size_t i = 0; i < 3 * net->n_nodes && net->load; i++)
        force -= net->motion[i] * network_load_force(net->load)[i];
    return force;
}

void network_place(palp_network *net, double depth) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] < 0)
            net->next.x[i] = net->rest[i] + depth * net->motion[i];
}

palp_status network_weights(palp_network *net, double *weight, double *stiffness) {
    int negative;
    palp_status status = net->exact ? PALP_OK : network_factor(net, 0.0, &negative);
    if (status)
        return status;
    net->exact = true;
    network_drive_column(net, net->start);
    linsys_solve(net->ls, net->start);
    double *u = net->fint; /* displacement per depth; fint is not needed any more */
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        u[i] = net->dof[i] < 0 ? net->motion[i] : net->start[net->dof[i]];
    *stiffness = 0.0;
    if (net->inertia > 0.0) /* of the free nodes: the plate's own reaction is that of the elements alone */
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            if (net->dof[i] >= 0)
                *stiffness += net->mass[i / 3] * net->inertia * u[i] * u[i];
    for (size_t i = 0; i < 3 * net->n_nodes && net->grip; i++)
        if (net->dof[i] >= 0)
            *stiffness += net->grip[i] * u[i] * u[i];
    if (net->load)
        *stiffness += network_load_curvature(net, u);
    for (size_t i = 0; i < net->n_elements; i++) {
        const double *a = u + 3 * net->pair[2 * i], *b = u + 3 * net->pair[2 * i + 1];
        double f[3];
        block_times(net, i, a, b, f);
        weight[i] = 0.0;
        for (size_t k = 0; k < 3; k++) {
            weight[i] += net->direction[3 * i + k] * (b[k] - a[k]);
            *stiffness += f[k] * (b[k] - a[k]);
        }
        if (net->scale)
            weight[i] *= net->scale[i];
    }
    return PALP_OK;
}
