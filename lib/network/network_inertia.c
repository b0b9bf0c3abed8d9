/* network_inertia.c: the mass terms of time integration: backward Euler or generalized alpha. */
#include "network_internal.h"

#include <math.h>

typedef struct inertia {
    network_term term;
    double factor; /* coefficient of mass times position in the force, 1/s^2; 0 in a static step */
    double *known; /* [3 n_nodes] the known part of that force, N */
} inertia;

/* Coefficients of Chung and Hulbert 1993; backward Euler has its own two lines. */
typedef struct alpha {
    double m, f, beta, gamma;
} alpha;

static alpha generalized_alpha_factors(double rho) {
    alpha a = {.m = (2.0 * rho - 1.0) / (rho + 1.0), .f = rho / (rho + 1.0)};
    a.beta = 0.25 * (1.0 - a.m + a.f) * (1.0 - a.m + a.f);
    a.gamma = 0.5 - a.m + a.f;
    return a;
}

/* Prepares the step: the residual is mass times factor x, less known. */
static void begin_inertia_step(network_term *term, palp_network *net) {
    inertia *t = (inertia *)term;
    const double dt = net->step.dt;
    t->factor = 0.0;
    if (isinf(dt))
        return;
    const network_state *s = &net->now;
    alpha a = generalized_alpha_factors(net->settings.spectral_radius);
    bool euler = net->settings.integrator == PALP_BACKWARD_EULER;
    double share = (1.0 - a.m) / (1.0 - a.f);
    t->factor = euler ? 1.0 / (dt * dt) : share / (a.beta * dt * dt);
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        double m = net->mass[i / 3], moved = m * t->factor * (s->x[i] + dt * s->velocity[i]);
        if (!euler)
            moved += m * (share * (0.5 / a.beta - 1.0) - a.m / (1.0 - a.f)) * s->acceleration[i] +
                     a.f / (1.0 - a.f) * s->inner[i];
        t->known[i] = moved;
    }
}

static void finish_inertia_step(network_term *term, palp_network *net) {
    (void)term;
    const double dt = net->step.dt;
    const network_state *s = &net->now;
    network_state *t = &net->next;
    alpha a = generalized_alpha_factors(net->settings.spectral_radius);
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        if (isinf(dt)) {
            t->velocity[i] = t->acceleration[i] = 0.0;
        } else if (net->settings.integrator == PALP_BACKWARD_EULER) {
            t->velocity[i] = (t->x[i] - s->x[i]) / dt;
            t->acceleration[i] = (t->velocity[i] - s->velocity[i]) / dt;
        } else {
            t->acceleration[i] = (t->x[i] - s->x[i] - dt * s->velocity[i]) / (a.beta * dt * dt) -
                                 (0.5 / a.beta - 1.0) * s->acceleration[i];
            t->velocity[i] =
                s->velocity[i] + dt * ((1.0 - a.gamma) * s->acceleration[i] + a.gamma * t->acceleration[i]);
        }
    }
}

static void add_inertia_residual(const network_term *term, const palp_network *net, double *r,
                                 double *squares) {
    const inertia *t = (const inertia *)term;
    for (size_t i = 0; i < 3 * net->n_nodes && t->factor > 0.0; i++) {
        if (net->dof[i] < 0)
            continue;
        double pull = net->mass[i / 3] * t->factor * net->next.x[i];
        r[i] -= pull - t->known[i];
        *squares += pull * pull;
    }
}

static void add_inertia_diagonal(const network_term *term, const palp_network *net, double *d) {
    const inertia *t = (const inertia *)term;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        d[i] += net->mass[i / 3] * t->factor;
}

static bool add_inertia_energy(const network_term *term, const palp_network *net, double *energy) {
    const inertia *t = (const inertia *)term;
    for (size_t i = 0; i < 3 * net->n_nodes && t->factor > 0.0; i++)
        if (net->dof[i] >= 0) {
            double x = net->next.x[i];
            *energy += x * (0.5 * net->mass[i / 3] * t->factor * x - t->known[i]);
        }
    return true;
}

static const network_term_kind INERTIA = {.begin = begin_inertia_step,
                                          .finish = finish_inertia_step,
                                          .residual = add_inertia_residual,
                                          .diagonal = add_inertia_diagonal,
                                          .energy = add_inertia_energy};

network_term *network_inertia_new(const palp_network *net) {
    inertia *t = network_term_new(&INERTIA, sizeof *t);
    if (t)
        t->known = arena_take(&t->term.memory, 3 * net->n_nodes, sizeof *t->known);
    return (network_term *)t;
}
