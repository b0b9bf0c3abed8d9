/* network_assemble.c: forces and tangent, summed over the network. */
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

bool network_evaluate(palp_network *net) {
    return network_evaluate_blocks(net, NULL);
}

/* Adds what elements of other parts do. False: one has collapsed in some part. */
static bool add_up_parts(palp_network *net, bool sound) {
    double sums[3] = {!sound, sound ? net->force_squares : 0.0, sound ? net->tangent_squares : 0.0};
    net->ranks->sum(net->ranks, 3, sums);
    if (sums[0] > 0.0)
        return false;
    net->force_squares = sums[1];
    net->tangent_squares = sums[2];
    net->ranks->complete(net->ranks, 3, net->fint);
    return true;
}

bool network_evaluate_blocks(palp_network *net, const network_blocks *blocks) {
    bool sound = network_element_forces(net, blocks);
    if (net->ranks)
        sound = add_up_parts(net, sound);
    if (!sound)
        return false;
    network_evaluate_terms(net);
    return isfinite(net->force_squares);
}

void network_evaluate_terms(palp_network *net) {
    memset(net->outer, 0, 3 * net->n_nodes * sizeof *net->outer);
    net->outer_squares = 0.0;
    for (size_t i = 0; i < net->n_terms; i++) {
        const network_term_kind *kind = net->terms[i]->kind;
        if (kind->evaluate)
            kind->evaluate(net->terms[i], net);
        if (kind->adds_up && net->ranks) {
            net->ranks->complete(net->ranks, 3, net->outer);
            net->outer_squares = network_sum_of_parts(net, net->outer_squares);
        }
    }
}

/* out = the terms' blocks times u, of all parts. */
static void multiply_terms(const palp_network *net, const double *u, double *out) {
    memset(out, 0, 3 * net->n_nodes * sizeof *out);
    for (size_t i = 0; i < net->n_terms; i++) {
        const network_term_kind *kind = net->terms[i]->kind;
        if (kind->times)
            kind->times(net->terms[i], net, u, out);
        if (kind->adds_up && net->ranks)
            net->ranks->complete(net->ranks, 3, out);
    }
}

double network_shared_length(const palp_network *net) {
    const double *scale = palp_mesh_element_scale(net->mesh);
    double sum = 0.0;
    for (size_t i = 0; i < net->n_elements; i++)
        sum += (scale ? scale[i] : 1.0) / net->inverse_rest[i];
    return sum;
}

/* Sum of the squares of rhs. */
static double square_of_residual(const palp_network *net) {
    if (!net->ranks)
        return network_dot(net->rhs, net->rhs, net->n_free);
    double sum = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0 && network_owns(net, i / 3))
            sum += net->rhs[net->dof[i]] * net->rhs[net->dof[i]];
    return network_sum_of_parts(net, sum);
}

double network_residual(palp_network *net, double *scale) {
    double squares = net->outer_squares, *r = net->unbalanced;
    memcpy(r, net->fint, 3 * net->n_nodes * sizeof *r);
    NETWORK_EACH_TERM(net, residual, net, r, &squares);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->rhs[net->dof[i]] = r[i] + net->outer[i];
    /* Rounding of positions leaves an error of a few 1e-16 in strains, and in forces that times the tangent.
     * In forces of terms it is that times their stiffness, which may be large. */
    *scale = net->settings.tolerance * sqrt(net->force_squares) + 2e-15 * sqrt(net->tangent_squares) +
             1e-15 * sqrt(squares);
    return sqrt(square_of_residual(net));
}

static inline void element_tangent_block(const palp_network *net, size_t i, double k[6]) {
    const size_t m = net->n_elements;
    const double n[3] = {net->direction[i], net->direction[m + i], net->direction[2 * m + i]};
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

void network_element_block(const palp_network *net, size_t i, double k[6]) {
    element_tangent_block(net, i, k);
}

void network_set_diagonal(palp_network *net, double shift) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->diagonal[i] = shift;
    NETWORK_EACH_TERM(net, diagonal, net, net->diagonal);
}

static void add_diagonal_block(palp_network *net, int32_t node, const double k[9]) {
    double *value = linsys_values(net->ls);
    const uint32_t *slot = net->slot_node + 6 * (size_t)node;
    for (int row = 0; row < 3; row++)
        for (int col = 0; col <= row; col++)
            value[*slot++] += k[3 * row + col];
}

/* Adds a term's block to the solver's values, unless no element joins its nodes. The slots of an element are
 * for its second node by its first. */
static void add_block_to_tangent(void *user, int32_t row, int32_t column, const double k[9]) {
    palp_network *net = user;
    if (row == column) {
        add_diagonal_block(net, row, k);
        return;
    }
    size_t e = palp_mesh_element_between(net->mesh, row, column);
    const bool element = e < net->n_elements;
    const uint32_t *slot =
        element ? net->slot + 9 * e
                : network_other_slots(net, row < column ? row : column, row < column ? column : row);
    const bool as_is = element ? net->pair[2 * e] == column : column < row;
    double *value = linsys_values(net->ls);
    for (int i = 0; i < 9 && slot; i++)
        value[slot[i]] += as_is ? k[i] : k[3 * (i % 3) + i / 3];
}

/* Adds the elements' blocks: those between nodes to the values, those on nodes to node_block. */
static void assemble_element_tangents(palp_network *net) {
    double *restrict value = linsys_values(net->ls), *restrict block = net->node_block;
    memset(value, 0, linsys_value_count(net->ls) * sizeof *value);
    memset(block, 0, 6 * net->n_nodes * sizeof *block);
    for (size_t i = 0; i < net->n_elements;) {
        const int32_t first = net->pair[2 * i];
        double sum[6] = {0.0};
        for (; i < net->n_elements && net->pair[2 * i] == first; i++) {
            double k[6], *b = block + 6 * net->pair[2 * i + 1];
            const uint32_t *s = net->slot + 9 * i;
            element_tangent_block(net, i, k);
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
}

void network_assemble(palp_network *net, double shift) {
    double *value = linsys_values(net->ls);
    assemble_element_tangents(net);
    network_set_diagonal(net, shift);
    for (size_t i = 0; i < net->n_nodes; i++) {
        const uint32_t *s = net->slot_node + 6 * i;
        double *b = net->node_block + 6 * i;
        b[0] += net->diagonal[3 * i];
        b[2] += net->diagonal[3 * i + 1];
        b[5] += net->diagonal[3 * i + 2];
        for (size_t j = 0; j < 6; j++)
            value[s[j]] = b[j];
    }
    if (shift != 0.0)
        network_set_diagonal(net, 0.0);
    NETWORK_EACH_TERM(net, blocks, net, add_block_to_tangent, net);
    net->far.n = 0;
    NETWORK_EACH_TERM(net, far_blocks, net, network_keep_far_block, net);
}

palp_status network_factor(palp_network *net, double shift, int *negative) {
    if (net->ranks) {
        *negative = -1;
        return net->ranks->factor(net->ranks, net);
    }
    network_assemble(net, shift);
    return linsys_factor(net->ls, negative);
}

/* k (vb - va) of element i. */
static void multiply_element_block(const palp_network *net, size_t i, const double *va, const double *vb,
                                   double out[3]) {
    double k[6], d[3] = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
    element_tangent_block(net, i, k);
    out[0] = k[0] * d[0] + k[1] * d[1] + k[3] * d[2];
    out[1] = k[1] * d[0] + k[2] * d[1] + k[4] * d[2];
    out[2] = k[3] * d[0] + k[4] * d[1] + k[5] * d[2];
}

/* Adds up column[n_free] over the parts. */
static void complete_unknowns(palp_network *net, double *column) {
    double *all = net->unbalanced;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        all[i] = net->dof[i] < 0 ? 0.0 : column[net->dof[i]];
    net->ranks->complete(net->ranks, 3, all);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            column[net->dof[i]] = all[i];
}

void network_drive_column(palp_network *net, double *column) {
    memset(column, 0, net->n_free * sizeof *column);
    for (size_t i = 0; i < net->n_elements; i++) {
        size_t a = 3 * (size_t)net->pair[2 * i], b = 3 * (size_t)net->pair[2 * i + 1];
        double f[3];
        multiply_element_block(net, i, net->motion + a, net->motion + b, f);
        for (size_t k = 0; k < 3; k++) {
            if (net->dof[a + k] >= 0)
                column[net->dof[a + k]] += f[k];
            if (net->dof[b + k] >= 0)
                column[net->dof[b + k]] -= f[k];
        }
    }
    double *pull = net->unbalanced;
    if (net->ranks)
        complete_unknowns(net, column);
    multiply_terms(net, net->motion, pull);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            column[net->dof[i]] -= pull[i];
}

bool network_energy(palp_network *net, double *energy) {
    double *psi = net->scratch;
    network_material m;
    *energy = 0.0;
    for (size_t r = 0; r <= net->n_regions; r++) {
        if (!network_material_at(net, r, &m))
            continue;
        double sum = 0.0;
        if (!element_energy(m.material, m.step, net->n_elements, net->strain, m.now, psi,
                            psi + net->n_elements))
            return false;
        for (size_t i = 0; i < net->n_elements; i++)
            sum += (net->scale ? net->scale[i] : 1.0) * (m.share ? m.share[i] : 1.0) * psi[i] /
                   net->inverse_rest[i];
        *energy += sum;
    }
    for (size_t i = net->n_terms; i-- > 0;)
        if (net->terms[i]->kind->energy && !net->terms[i]->kind->energy(net->terms[i], net, energy))
            return false;
    return true;
}

double network_drive_force(const palp_network *net) {
    const size_t n = 3 * net->n_nodes;
    if (!net->ranks)
        return -network_dot(net->motion, net->fint, n) - network_dot(net->motion, net->outer, n);
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        if (network_owns(net, i / 3))
            sum -= net->motion[i] * (net->fint[i] + net->outer[i]);
    return network_sum_of_parts(net, sum);
}

/* u' T u with the tangent T of the terms. Their constant diagonal counts on free axes only: the plate's
 * reaction contains only elements and outer forces. */
static double curvature_of_terms_along(const palp_network *net, const double *u) {
    double sum = 0.0, *pull = net->unbalanced;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0 && network_owns(net, i / 3))
            sum += net->diagonal[i] * u[i] * u[i];
    multiply_terms(net, u, pull);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (network_owns(net, i / 3))
            sum += pull[i] * u[i];
    return sum;
}

palp_status network_weights(palp_network *net, double *weight, double *stiffness) {
    int negative;
    palp_status status = net->exact ? PALP_OK : network_factor(net, 0.0, &negative);
    if (status)
        return status;
    net->exact = true;
    network_drive_column(net, net->start);
    network_solve(net, net->start);
    double *u = net->fint; /* displacement per depth; fint is no longer needed */
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        u[i] = net->dof[i] < 0 ? net->motion[i] : net->start[net->dof[i]];
    *stiffness = curvature_of_terms_along(net, u);
    for (size_t i = 0; i < net->n_elements; i++) {
        const double *a = u + 3 * net->pair[2 * i], *b = u + 3 * net->pair[2 * i + 1];
        double f[3];
        multiply_element_block(net, i, a, b, f);
        weight[i] = 0.0;
        for (size_t k = 0; k < 3; k++) {
            weight[i] += net->direction[k * net->n_elements + i] * (b[k] - a[k]);
            *stiffness += f[k] * (b[k] - a[k]);
        }
        if (net->scale)
            weight[i] *= net->scale[i];
        if (net->base_share)
            weight[i] *= net->base_share[i];
    }
    *stiffness = network_sum_of_parts(net, *stiffness);
    return PALP_OK;
}
