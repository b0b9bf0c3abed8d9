/* realtime_adjoint.c: the adjoint dx / d depth, which makes the force's error a product of two errors. Its
 * corrections; the estimates of its error, of the factor's, and of the error that arms remember. */
#include "realtime_internal.h"

#include <math.h>
#include <string.h>

/* An error is taken as this share of the largest underestimate that was found for the factor. */
static const double DOUBTED = 0.5;
/* A correction with a good factor removes this share of the adjoint's error. */
static const double PUT_RIGHT = 0.5;
/* The estimated rate of change of the adjoint falls to this share of the last one at most. */
static const double FADES = 0.7;
/* Rounding of single precision, as a share of the error's energy. */
static const double ROUNDING = 1e-8;
/* Displacement over which the adjoint's change is found, as a share of the network's size. */
static const double STEP = 1e-3;

/* A correction of the adjoint has four parts: its residual, two halves of the preconditioner, and the
 * step. */
static void evaluate_adjoint_residual(palp_realtime *rt) {
    realtime_tangent_times(rt, rt->adjoint, rt->adjoint_r);
    for (size_t i = 0; i < 3 * rt->net->n_nodes; i++)
        rt->adjoint_r[i] = -rt->adjoint_r[i];
    rt->adjoint_found = rt->adjoint_far;
    memcpy(rt->adjoint_at[1], rt->net->now.x, 3 * rt->net->n_nodes * sizeof *rt->adjoint);
}

static void precondition_adjoint_down(palp_realtime *rt) {
    realtime_touch(rt);
    multigrid_apply_half(rt->mg, rt->adjoint_r, rt->adjoint_half);
}

static void find_adjoint_direction(palp_realtime *rt) {
    realtime_touch(rt);
    multigrid_apply_rest(rt->mg, rt->adjoint_r, rt->adjoint_half, rt->adjoint_z);
}

/* The error was found some ticks ago, at adjoint_at[1]. A correction is assumed to remove only its share of
 * it. The rate at which the error grows, per m, falls to FADES of its former value at most. */
static void correct_adjoint_along(palp_realtime *rt) {
    const size_t n = 3 * rt->net->n_nodes;
    const double *z = rt->adjoint_z;
    realtime_tangent_times(rt, z, rt->q);
    double rz = network_dot(rt->adjoint_r, z, n), curvature = network_dot(z, rt->q, n);
    if (!(rz > 0.0) || !(curvature > 0.0))
        return;
    const double found = realtime_doubt(rt) * sqrt(rz),
                 far = fmax(rt->adjoint_found, 0.5 * rt->adjoint_farthest);
    if (far > 0.0)
        rt->adjoint_rate = fmax(found / far, FADES * rt->adjoint_rate);
    rt->adjoint_error = (1.0 - PUT_RIGHT / rt->doubt) * found;
    rt->adjoint_farthest = 0.0;
    double *at = rt->adjoint_at[0];
    rt->adjoint_at[0] = rt->adjoint_at[1];
    rt->adjoint_at[1] = at;
    for (size_t i = 0; i < n; i++)
        rt->adjoint[i] += rz / curvature * z[i];
}

/* Share of the stiffness that relaxes in this step, of the material that relaxes most. */
static double relaxing_share(const palp_network *net) {
    double most = 0.0;
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++) {
        double sum = 0.0;
        for (size_t j = 0; network_material_at(net, r, &m) && j < m.material->n_arms; j++)
            sum += (1.0 - m.step->decay[j]) * m.material->arms[j].stiffness_N / m.modulus;
        most = fmax(most, sum);
    }
    return most;
}

/* Stiffness by which the arms of each material at strain e relax in this step, N. */
static void forgotten_arm_stiffness(const palp_network *net, double e,
                                    double stiffness[PALP_REGIONS_MAX + 1]) {
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++) {
        double elastic = 0.0, tangent = 0.0;
        stiffness[r] = 0.0;
        if (!network_material_at(net, r, &m))
            continue;
        if (m.material->quasi_linear)
            palp_law_force(&m.material->law, 1, &e, &elastic, &tangent, NULL);
        for (size_t j = 0; j < m.material->n_arms; j++)
            stiffness[r] += (1.0 - m.step->decay[j]) * m.step->gain[j] *
                            element_arm_drive(m.material, j, e, elastic, tangent, 0.0).slope;
    }
}

/* Is it independent of strain? */
static bool do_arms_forget_evenly(const palp_network *net) {
    bool even = true;
    network_material m;
    for (size_t r = 0; r <= net->n_regions; r++) {
        if (!network_material_at(net, r, &m))
            continue;
        even = even && !m.material->quasi_linear;
        for (size_t j = 0; j < m.material->n_arms; j++)
            even = even && m.material->arms[j].beta == 0.0;
    }
    return even;
}

/* The nodal forces of relaxing arms after a displacement along the adjoint, from one of FORCE_PARTS of the
 * elements. */
static void push_of_forgetting_arms(palp_realtime *rt, size_t part) {
    const palp_network *net = rt->net;
    const double *x = net->now.x, *a = rt->adjoint;
    const bool even = do_arms_forget_evenly(net);
    double *out = rt->adjoint_r, stiffness[PALP_REGIONS_MAX + 1];
    forgotten_arm_stiffness(net, 0.0, stiffness);
    if (part == 0)
        memset(out, 0, 3 * net->n_nodes * sizeof *out);
    for (size_t i = part * net->n_elements / FORCE_PARTS; i < (part + 1) * net->n_elements / FORCE_PARTS;
         i++) {
        const size_t p = 3 * (size_t)net->pair[2 * i], q = 3 * (size_t)net->pair[2 * i + 1];
        double square = 0.0, along = 0.0;
        for (size_t k = 0; k < 3; k++) {
            square += (x[q + k] - x[p + k]) * (x[q + k] - x[p + k]);
            along += (x[q + k] - x[p + k]) * (a[q + k] - a[p + k]);
        }
        if (!even)
            forgotten_arm_stiffness(net, sqrt(square) * net->inverse_rest[i] - 1.0, stiffness);
        const double size = (net->scale ? net->scale[i] : 1.0) *
                            network_mean_of_materials(net, i, stiffness) * net->inverse_rest[i] * along /
                            square;
        for (size_t k = 0; k < 3; k++) {
            out[q + k] -= size * (x[q + k] - x[p + k]);
            out[p + k] += size * (x[q + k] - x[p + k]);
        }
    }
}

static void precondition_memory_down(palp_realtime *rt) {
    for (size_t i = 0; i < 3 * rt->net->n_nodes; i++)
        rt->adjoint_r[i] = rt->net->dof[i] < 0 ? 0.0 : rt->adjoint_r[i];
    precondition_adjoint_down(rt);
}

static void measure_forgotten_energy(palp_realtime *rt) {
    find_adjoint_direction(rt);
    const double relaxing = relaxing_share(rt->net),
                 square = network_dot(rt->adjoint_r, rt->adjoint_z, 3 * rt->net->n_nodes);
    if (relaxing > 0.0)
        rt->forgets = sqrt(fabs(square)) / relaxing;
}

void realtime_improve_adjoint(palp_realtime *rt, int part) {
    static void (*const correct[ADJOINT_PARTS])(palp_realtime *) = {
        evaluate_adjoint_residual, precondition_adjoint_down, find_adjoint_direction, correct_adjoint_along};
    static void (*const measure[2])(palp_realtime *) = {precondition_memory_down, measure_forgotten_energy};
    if (part < ADJOINT_PARTS)
        correct[part](rt);
    else if (part < ADJOINT_PARTS + FORCE_PARTS)
        push_of_forgetting_arms(rt, (size_t)(part - ADJOINT_PARTS));
    else
        measure[part - ADJOINT_PARTS - FORCE_PARTS](rt);
}

double realtime_doubt(const palp_realtime *rt) {
    return fmax(1.0, DOUBTED * rt->doubt);
}

void realtime_follow_adjoint(palp_realtime *rt) {
    const palp_network *net = rt->net;
    rt->adjoint_far = network_distance(net->next.x, rt->adjoint_at[0], 3 * net->n_nodes);
    rt->adjoint_farthest = fmax(rt->adjoint_farthest, rt->adjoint_far);
}

double realtime_adjoint_error(const palp_realtime *rt) {
    return rt->driven ? rt->adjoint_error + rt->adjoint_rate * rt->adjoint_far : 0.0;
}

/* The initial rate of the adjoint's error, from its residual after a small displacement along the adjoint. */
static void find_adjoint_error_rate(palp_realtime *rt) {
    palp_network *net = rt->net;
    const size_t n = 3 * net->n_nodes;
    const double step = STEP * net->extent, way = step * sqrt(network_dot(rt->adjoint, rt->adjoint, n));
    for (size_t i = 0; i < n; i++)
        net->next.x[i] += step * rt->adjoint[i];
    if (realtime_evaluate(rt, true, true)) {
        evaluate_adjoint_residual(rt);
        multigrid_apply(rt->mg, rt->adjoint_r, rt->z);
        rt->adjoint_rate = sqrt(fabs(network_dot(rt->adjoint_r, rt->z, n))) / way;
    }
    memcpy(net->next.x, net->now.x, n * sizeof *net->next.x);
    network_evaluate(net);
}

/* Power iteration for the factor's worst underestimate: repeated corrections leave the error it reduces
 * least. A good factor leaves rounding only. */
static void find_worst_factor_error(palp_realtime *rt) {
    enum { ROUNDS = 12 };
    const palp_network *net = rt->net;
    const size_t n = 3 * net->n_nodes;
    double *e = rt->p, first = 0.0;
    for (size_t i = 0; i < n; i++)
        e[i] = net->dof[i] < 0 ? 0.0 : sin(1.0 + 3.7 * (double)i);
    for (int k = 0; k < ROUNDS; k++) {
        realtime_tangent_times(rt, e, rt->q);
        multigrid_apply(rt->mg, rt->q, rt->z);
        const double all = network_dot(e, rt->q, n), told = network_dot(rt->q, rt->z, n);
        first = k == 0 ? all : first;
        if (!(told > 0.0) || !(all > ROUNDING * first))
            return;
        rt->doubt = fmax(rt->doubt, sqrt(all / told));
        for (size_t i = 0; i < n; i++)
            e[i] -= rt->z[i];
    }
}

void realtime_begin_adjoint(palp_realtime *rt, bool made) {
    enum { ROUNDS = 12 };
    const size_t n = 3 * rt->net->n_nodes;
    memcpy(rt->adjoint, rt->net->motion, n * sizeof *rt->adjoint);
    for (size_t i = 0; i < 2; i++)
        memcpy(rt->adjoint_at[i], rt->net->now.x, n * sizeof *rt->adjoint);
    rt->adjoint_error = rt->adjoint_rate = rt->adjoint_far = rt->adjoint_farthest = rt->adjoint_found =
        rt->forgets = 0.0;
    rt->adjoint_due = 0;
    network_material m;
    bool arms = false;
    for (size_t r = 0; r <= rt->net->n_regions; r++)
        arms = arms || (network_material_at(rt->net, r, &m) && m.material->n_arms > 0);
    rt->adjoint_parts = arms ? ADJOINT_PARTS + FORCE_PARTS + 2 : ADJOINT_PARTS;
    rt->doubt = 1.0;
    if (!made)
        return;
    find_worst_factor_error(rt);
    for (int i = 0; i < ROUNDS * ADJOINT_PARTS && rt->driven; i++)
        realtime_improve_adjoint(rt, i % ADJOINT_PARTS);
    for (int i = ADJOINT_PARTS; i < rt->adjoint_parts && rt->driven; i++)
        realtime_improve_adjoint(rt, i);
    if (rt->driven)
        find_adjoint_error_rate(rt);
}
