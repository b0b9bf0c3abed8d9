/* solid_press.c: a solid pressed by its plate: Newton's method, and the plate's force. */
#include "solid_internal.h"

#include "base/dense.h"

#include <math.h>
#include <string.h>

static const double TOLERANCE = 1e-9; /* of the residual, relative to all nodal forces */
static const double ROUNDED = 1e-13;  /* a smaller step, relative to the positions, is rounding */
enum { ITERATIONS = 30, HALVES = 12 };

/* The gradient of a nodal field in a tetrahedron; of positions it is F. */
static void gradient_of(const solid_body *body, size_t t, const double *field, double F[9]) {
    const int32_t *nodes = palp_mesh_tetrahedra(body->mesh) + 4 * t;
    memset(F, 0, 9 * sizeof *F);
    for (size_t c = 0; c < 4; c++)
        for (size_t i = 0; i < 3; i++)
            for (size_t p = 0; p < 3; p++)
                F[3 * i + p] += field[3 * (size_t)nodes[c] + i] * body->gradient[12 * t + 3 * c + p];
}

/* Adds the nodal forces of a stress. */
static void add_force(solid_body *body, size_t t, const double P[9]) {
    const int32_t *nodes = palp_mesh_tetrahedra(body->mesh) + 4 * t;
    for (size_t c = 0; c < 4; c++)
        for (size_t i = 0; i < 3; i++)
            for (size_t p = 0; p < 3; p++)
                body->force[3 * (size_t)nodes[c] + i] +=
                    body->volume_m3[t] * P[3 * i + p] * body->gradient[12 * t + 3 * c + p];
}

static void add_matrix(solid_body *body, size_t t, const double H[81], double *values) {
    const double *g = body->gradient + 12 * t;
    double half[9][12]; /* H by F, contracted once: [i p][c j] */
    for (size_t ip = 0; ip < 9; ip++)
        for (size_t cj = 0; cj < 12; cj++)
            half[ip][cj] = body->volume_m3[t] * (H[9 * ip + 3 * (cj % 3)] * g[3 * (cj / 3)] +
                                                 H[9 * ip + 3 * (cj % 3) + 1] * g[3 * (cj / 3) + 1] +
                                                 H[9 * ip + 3 * (cj % 3) + 2] * g[3 * (cj / 3) + 2]);
    for (size_t k = 0; k < 144; k++) {
        const size_t slot = body->slot[144 * t + k], c = k / 36, i = k / 12 % 3, cj = k % 12;
        if (slot != SIZE_MAX)
            values[slot] += g[3 * c] * half[3 * i][cj] + g[3 * c + 1] * half[3 * i + 1][cj] +
                            g[3 * c + 2] * half[3 * i + 2][cj];
    }
}

/* Nodal forces and residual at x, and the matrix; the residual's norm over that of all nodal forces. INFINITY
 * where a tetrahedron has no energy. */
static double evaluate(solid_body *body, const palp_solid *solid, bool matrix) {
    const size_t n = 3 * palp_mesh_node_count(body->mesh);
    double *values = linsys_values(body->matrix);
    memset(body->force, 0, n * sizeof *body->force);
    if (matrix)
        memset(values, 0, linsys_value_count(body->matrix) * sizeof *values);
    for (size_t t = 0; t < palp_mesh_tetrahedron_count(body->mesh); t++) {
        double F[9], P[9], H[81];
        gradient_of(body, t, body->x, F);
        if (!isfinite(palp_solid_energy(solid, F, P, matrix ? H : NULL)))
            return INFINITY;
        add_force(body, t, P);
        if (matrix)
            add_matrix(body, t, H, values);
    }
    double all = 0.0, free_axes = 0.0;
    for (size_t i = 0; i < n; i++) {
        all += body->force[i] * body->force[i];
        if (body->unknown[i] >= 0) {
            body->residual[body->unknown[i]] = body->force[i];
            free_axes += body->force[i] * body->force[i];
        }
    }
    return all > 0.0 ? sqrt(free_axes / all) : 0.0;
}

/* x = before + s times the solution, which is in residual, at the unknown axes; others stay. */
static void move(solid_body *body, const double *step, double s) {
    for (size_t i = 0; i < 3 * palp_mesh_node_count(body->mesh); i++)
        if (body->unknown[i] >= 0)
            body->x[i] = body->before[i] - s * step[body->unknown[i]];
}

/* Newton's method at the supports' present places, with steps halved until the residual falls. */
static palp_status newton(solid_body *body, const palp_solid *solid, double *step) {
    const size_t bytes = 3 * palp_mesh_node_count(body->mesh) * sizeof *body->x;
    double off = evaluate(body, solid, true);
    for (int k = 0; k < ITERATIONS && isfinite(off); k++) {
        int negative;
        if (off <= TOLERANCE)
            return PALP_OK;
        const double norm = dense_dot(body->n_unknowns, body->residual, body->residual);
        palp_status status = linsys_factor(body->matrix, &negative);
        if (status)
            return status;
        memcpy(step, body->residual, body->n_unknowns * sizeof *step);
        linsys_solve(body->matrix, step);
        if (dense_dot(body->n_unknowns, step, step) <=
            ROUNDED * ROUNDED * dense_dot(bytes / sizeof *body->x, body->x, body->x))
            return PALP_OK;
        memcpy(body->before, body->x, bytes);
        double s = 1.0;
        for (int half = 0; half < HALVES; half++, s *= 0.5) {
            move(body, step, s);
            off = evaluate(body, solid, true);
            if (isfinite(off) && dense_dot(body->n_unknowns, body->residual, body->residual) < norm)
                break;
        }
    }
    return isfinite(off) && off <= TOLERANCE ? PALP_OK : PALP_ERR_NOT_CONVERGED;
}

/* dx / d depth at x. */
static palp_status find_rate(solid_body *body, const palp_solid *solid, double *step) {
    const size_t n = palp_mesh_node_count(body->mesh);
    evaluate(body, solid, true);
    for (size_t i = 0; i < 3 * n; i++)
        body->rate[i] = i % 3 == 1 && body->held[i / 3] & 8 ? -1.0 : 0.0;
    memset(body->force, 0, 3 * n * sizeof *body->force);
    for (size_t t = 0; t < palp_mesh_tetrahedron_count(body->mesh); t++) {
        double F[9], dF[9], P[9], dP[9], H[81];
        gradient_of(body, t, body->rate, dF);
        gradient_of(body, t, body->x, F);
        palp_solid_energy(solid, F, P, H);
        for (size_t i = 0; i < 9; i++)
            dP[i] = dense_dot(9, H + 9 * i, dF);
        add_force(body, t, dP);
    }
    for (size_t i = 0; i < 3 * n; i++)
        if (body->unknown[i] >= 0)
            step[body->unknown[i]] = -body->force[i];
    int negative;
    palp_status status = linsys_factor(body->matrix, &negative);
    if (!status && body->stable && negative > 0)
        status = PALP_ERR_BUCKLED;
    if (!status)
        linsys_solve(body->matrix, step);
    for (size_t i = 0; !status && i < 3 * n; i++)
        if (body->unknown[i] >= 0)
            body->rate[i] = step[body->unknown[i]];
    return status;
}

/* Power of the viscous stress at the rate dF, over the damping. */
static double viscous_power(const palp_solid *solid, const double F[9], const double dF[9],
                            const double H[81]) {
    double dE[9], power = 0.0;
    solid_green(F, dF, dE);
    const double trace = dE[0] + dE[4] + dE[8], square = dense_dot(9, dE, dE);
    switch (solid->time) {
    case PALP_SOLID_SHEAR:
        return 2.0 * square;
    case PALP_SOLID_MATERIAL:
        return palp_solid_lambda(solid) * trace * trace + 2.0 * palp_solid_shear(solid) * square;
    case PALP_SOLID_RAYLEIGH:
        for (size_t i = 0; i < 9; i++)
            power += dF[i] * dense_dot(9, H + 9 * i, dF);
        return power;
    default:
        return 0.0;
    }
}

/* By virtual work with the rate as the virtual motion. */
static void feel_plate(const solid_body *body, const palp_solid *solid, solid_feel *feel) {
    const size_t count = palp_solid_count(solid->law);
    *feel = (solid_feel){{0}, 0};
    for (size_t t = 0; t < palp_mesh_tetrahedron_count(body->mesh); t++) {
        double F[9], dF[9], P[9], H[81];
        gradient_of(body, t, body->x, F);
        gradient_of(body, t, body->rate, dF);
        for (size_t k = 0; k < count; k++) {
            palp_solid unit = *solid;
            for (size_t j = 0; j < count; j++)
                unit.c_Pa[j] = j == k ? 1.0 : 0.0;
            palp_solid_energy(&unit, F, P, NULL);
            feel->by_c_m2[k] += body->volume_m3[t] * dense_dot(9, P, dF);
        }
        palp_solid_energy(solid, F, P, H);
        feel->viscous += body->volume_m3[t] * viscous_power(solid, F, dF, H);
    }
}

/* Moves the plate from one depth to another, in more parts where Newton's method fails. body->rate is that at
 * the start. */
static palp_status press_on(solid_body *body, const palp_solid *solid, double from_m, double to_m,
                            double *step) {
    const size_t n = 3 * palp_mesh_node_count(body->mesh);
    double part = to_m - from_m;
    while (to_m - from_m > 1e-12 * to_m) {
        part = fmin(part, to_m - from_m);
        double *x = step + body->n_unknowns; /* positions at the start of this part */
        memcpy(x, body->x, n * sizeof *x);
        for (size_t i = 0; i < n; i++)
            body->x[i] += part * body->rate[i];
        palp_status status = newton(body, solid, step);
        status = status ? status : find_rate(body, solid, step);
        if (!status) {
            from_m += part;
        } else {
            memcpy(body->x, x, n * sizeof *x);
            part *= 0.5;
            if (status == PALP_ERR_NO_MEMORY || status == PALP_ERR_BUCKLED || part < to_m / 32)
                return status;
        }
    }
    return PALP_OK;
}

palp_status solid_body_press(solid_body *body, const palp_solid *solid, size_t n, const double *depth_m,
                             solid_feel *feel) {
    const size_t axes = 3 * palp_mesh_node_count(body->mesh);
    double from = 0.0;
    memcpy(body->x, palp_mesh_positions(body->mesh), axes * sizeof *body->x);
    palp_status status = find_rate(body, solid, body->work);
    for (size_t i = 0; !status && i < n; i++) {
        status = press_on(body, solid, from, depth_m[i], body->work);
        from = depth_m[i];
        if (!status)
            feel_plate(body, solid, &feel[i]);
    }
    return status;
}
