/* element.c: the generalized Maxwell solid over one time step, many elements at a time. */
#include "element.h"

#include "base/clones.h"

#include <math.h>
#include <string.h>

void element_decay(double x, double *decay, double *mean) {
    *decay = exp(-x);
    if (x < 1e-8)
        *mean = 1.0 - 0.5 * x;
    else
        *mean = isinf(x) ? 0.0 : -expm1(-x) / x;
}

double element_mean_slope(double x, double decay, double mean) {
    return x < 1e-4 ? -0.5 + x / 3.0 : (decay - mean) / x; /* series, where the difference loses all digits */
}

void element_step_prepare(const palp_material *material, double dt, element_step *step) {
    step->dt = dt;
    step->dashpot = material->dashpot_Ns > 0.0 ? material->dashpot_Ns / dt : 0.0;
    step->carry = 0.0;
    step->rate_factor = 1.0;
    step->damage = NULL;
    bool sedef = material->formulation == PALP_SEDEF2008;
    for (size_t j = 0; j < material->n_arms; j++) {
        const palp_arm *arm = &material->arms[j];
        double x = dt * arm->stiffness_N / arm->viscosity_Ns, mean;
        element_decay(x, &step->decay[j], &mean);
        step->gain[j] = arm->stiffness_N * mean;
        if (sedef)
            step->carry = 1.0 / (1.0 + x);
    }
}

const element_step *element_steps_of(const palp_material *material, double dt, element_steps *steps) {
    for (size_t i = 0; i < steps->n; i++)
        if (steps->step[i].dt == dt)
            return &steps->step[i];
    element_step *step = &steps->step[steps->next];
    steps->next = (steps->next + 1) % ELEMENT_STEPS;
    steps->n += steps->n < ELEMENT_STEPS;
    element_step_prepare(material, dt, step);
    return step;
}

/* Eq. 5.11: A = (K e + b1 (1 + K/K1) (e - e_old) / dt) / (1 + b1 / (K1 dt)), and dA/de. K and dK/de follow
 * from the law's force K e and tangent K + e dK/de; near e = 0 dK/de comes from the law. */
static void evaluate_sedef_trial(const palp_material *material, const element_step *step, size_t n,
                                 const double *e, const element_history *old, double *force,
                                 double *tangent) {
    const palp_arm *arm = &material->arms[0];
    const double rate = arm->viscosity_Ns / step->dt, compliance = 1.0 / arm->stiffness_N;
    const double share = 1.0 / (1.0 + rate * compliance);
    double start, slope;
    palp_law_stiffness(&material->law, 0.0, &start, &slope);
    for (size_t i = 0; i < n; i++) {
        double size = fabs(e[i]), inverse = 1.0 / e[i], de = e[i] - old->strain[i];
        double stiffness = size < 1e-200 ? start : force[i] * inverse;
        double turn = size < 1e-7 ? (e[i] < 0.0 ? -slope : slope) : (tangent[i] - stiffness) * inverse;
        double along = 1.0 + stiffness * compliance;
        force[i] = share * (force[i] + rate * along * de);
        tangent[i] = share * (tangent[i] + rate * (along + turn * compliance * de));
    }
}

element_drive element_arm_drive(const palp_material *material, size_t arm, double e, double elastic,
                                double tangent, double energy) {
    if (material->quasi_linear) {
        double start;
        palp_law_stiffness(&material->law, 0.0, &start, NULL);
        return (element_drive){elastic / start, tangent / start, energy / start};
    }
    double beta = material->arms[arm].beta, a = fabs(e);
    return (element_drive){e * (1.0 + 0.5 * beta * a), 1.0 + beta * a, e * e * (0.5 + beta * a / 6.0)};
}

/* q = decay q_old + gain (e - e_old): an arm without strain dependence. */
PALP_CLONES
static void advance_linear_arm(double decay, double gain, size_t n, const double *restrict e,
                               const double *restrict e_old, const double *restrict q_old, double *restrict q,
                               double *restrict force, double *restrict tangent) {
    for (size_t i = 0; i < n; i++) {
        q[i] = decay * q_old[i] + gain * (e[i] - e_old[i]);
        force[i] += q[i];
        tangent[i] += gain;
    }
}

/* The drive of an arm at the start of the step. */
static element_drive arm_drive_at_step_start(const palp_material *material, size_t arm,
                                             const element_history *old, size_t i) {
    return element_arm_drive(material, arm, old->strain[i], material->quasi_linear ? old->elastic[i] : 0.0,
                             0.0, 0.0);
}

/* The same with a drive s(e), and with tau (1 + gamma |e|) at the mean of old and new strain. */
static void advance_nonlinear_arm(const palp_material *material, const element_step *step, size_t j, size_t n,
                                  const double *e, const element_history *old, element_history *new,
                                  double *force, double *tangent) {
    const palp_arm *arm = &material->arms[j];
    const double *q_old = old->arm + j * old->stride;
    double *q = new->arm + j *new->stride, tau = arm->viscosity_Ns / arm->stiffness_N;
    for (size_t i = 0; i < n; i++) {
        double slope = 0.0, elastic = material->quasi_linear ? new->elastic[i] : 0.0;
        if (material->quasi_linear)
            palp_law_force(&material->law, 1, &e[i], &(double){0}, &slope, NULL);
        element_drive s = element_arm_drive(material, j, e[i], elastic, slope, 0.0);
        element_drive s_old = arm_drive_at_step_start(material, j, old, i);
        double ds = s.value - s_old.value, decay = step->decay[j], gain = step->gain[j], turn = 0.0;
        if (arm->gamma != 0.0) {
            double stretch = 1.0 + 0.5 * arm->gamma * (fabs(e[i]) + fabs(old->strain[i]));
            double x = step->dt / (tau * stretch), mean;
            element_decay(x, &decay, &mean);
            gain = arm->stiffness_N * mean;
            /* d/de of decay and gain through x: dx/de = -x gamma sign(e) / (2 stretch) */
            double dx = -0.5 * x * (e[i] < 0.0 ? -arm->gamma : arm->gamma) / stretch;
            turn =
                isinf(x)
                    ? 0.0
                    : dx * (-decay * q_old[i] + arm->stiffness_N * element_mean_slope(x, decay, mean) * ds);
        }
        q[i] = decay * q_old[i] + gain * ds;
        force[i] += q[i];
        tangent[i] += gain * s.slope + turn;
    }
}

/* Replaces the law's springs by those changed by damage and rate_factor. */
static void change_springs(const palp_material *material, const element_step *step, size_t n, const double *e,
                           const element_history *old, element_history *new, double *force, double *tangent) {
    for (size_t i = 0; i < n; i++) {
        if (step->damage) {
            element_damaged spring;
            element_damage_force(&material->law, step->damage, e[i], old->peak[i], &spring);
            new->peak[i] = spring.peak;
            force[i] = spring.force;
            tangent[i] = spring.by_strain;
        }
        force[i] *= step->rate_factor;
        tangent[i] *= step->rate_factor;
    }
}

void element_trial(const palp_material *material, const element_step *step, size_t n, const double *e,
                   const element_history *old, element_history *new, double *force, double *tangent) {
    palp_law_force(&material->law, n, e, force, tangent, NULL);
    if (new->strain != e)
        memcpy(new->strain, e, n * sizeof *e);
    if (material->quasi_linear)
        memcpy(new->elastic, force, n * sizeof *force);
    if (step->damage || step->rate_factor != 1.0)
        change_springs(material, step, n, e, old, new, force, tangent);
    if (material->formulation == PALP_SEDEF2008 && material->n_arms > 0) {
        evaluate_sedef_trial(material, step, n, e, old, force, tangent);
        return;
    }
    for (size_t j = 0; j < material->n_arms; j++) {
        const palp_arm *arm = &material->arms[j];
        if (material->quasi_linear || arm->beta != 0.0 || arm->gamma != 0.0)
            advance_nonlinear_arm(material, step, j, n, e, old, new, force, tangent);
        else
            advance_linear_arm(step->decay[j], step->gain[j], n, e, old->strain, old->arm + j * old->stride,
                               new->arm + j *new->stride, force, tangent);
    }
    if (step->dashpot > 0.0)
        for (size_t i = 0; i < n; i++) {
            force[i] += step->dashpot * (e[i] - old->strain[i]);
            tangent[i] += step->dashpot;
        }
}

bool element_energy(const palp_material *material, const element_step *step, size_t n, const double *e,
                    const element_history *old, double *energy, double *work) {
    for (size_t j = 0; j < material->n_arms; j++)
        if (material->arms[j].gamma != 0.0)
            return false;
    if ((material->formulation == PALP_SEDEF2008 && material->n_arms > 0) || step->damage ||
        step->rate_factor != 1.0)
        return false;
    palp_law_force(&material->law, n, e, work, NULL, energy);
    for (size_t i = 0; i < n; i++) {
        double law = energy[i], de = e[i] - old->strain[i];
        energy[i] += 0.5 * step->dashpot * de * de;
        for (size_t j = 0; j < material->n_arms; j++) {
            element_drive s = element_arm_drive(material, j, e[i], work[i], 0.0, law);
            element_drive s_old = arm_drive_at_step_start(material, j, old, i);
            energy[i] += step->decay[j] * old->arm[j * old->stride + i] * e[i] +
                         step->gain[j] * (s.integral - s_old.value * e[i]);
        }
    }
    return true;
}

/* Arms of constant time, driven by e (1 + beta |e| / 2); decay and gain are the step's. */
static void constant_partials(const palp_arm *arm, double dt, double decay, double gain, size_t n,
                              const double *e, const double *e_old, const double *q_old, double *p) {
    const double x = dt * arm->stiffness_N / arm->viscosity_Ns, mean = gain / arm->stiffness_N,
                 weight = isinf(x) ? 0.0 : x;
    const double turn = arm->stiffness_N * element_mean_slope(x, decay, mean);
    for (size_t i = 0; i < n; i++) {
        double a = arm->beta * fabs(e[i]), a_old = arm->beta * fabs(e_old[i]);
        double rise = e[i] * (1.0 + 0.5 * a) - e_old[i] * (1.0 + 0.5 * a_old);
        double log_time = weight * (decay * q_old[i] - turn * rise);
        p[ELEMENT_STRAIN * n + i] = gain * (1.0 + a);
        p[ELEMENT_STRAIN_OLD * n + i] = -gain * (1.0 + a_old);
        p[ELEMENT_ARM_OLD * n + i] = decay;
        p[ELEMENT_DRIVE * n + i] = gain;
        p[ELEMENT_LOG_STIFFNESS * n + i] = gain * rise;
        p[ELEMENT_LOG_TIME * n + i] = log_time;
        p[ELEMENT_BETA * n + i] = 0.5 * gain * (e[i] * fabs(e[i]) - e_old[i] * fabs(e_old[i]));
        p[ELEMENT_GAMMA * n + i] = log_time * 0.5 * (fabs(e[i]) + fabs(e_old[i]));
    }
}

static element_drive arm_drive_at_strain(const palp_material *material, size_t j, double e) {
    double elastic, tangent;
    palp_law_force(&material->law, 1, &e, &elastic, &tangent, NULL);
    return element_arm_drive(material, j, e, elastic, tangent, 0.0);
}

void element_arm_partials(const palp_material *material, const element_step *step, size_t j, size_t n,
                          const double *e, const double *e_old, const double *q_old, double *p) {
    const palp_arm *arm = &material->arms[j];
    if (!material->quasi_linear && arm->gamma == 0.0) {
        constant_partials(arm, step->dt, step->decay[j], step->gain[j], n, e, e_old, q_old, p);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        double decay, mean, stretch = 1.0 + 0.5 * arm->gamma * (fabs(e[i]) + fabs(e_old[i]));
        double x = step->dt * arm->stiffness_N / (arm->viscosity_Ns * stretch);
        element_drive s = arm_drive_at_strain(material, j, e[i]),
                      s_old = arm_drive_at_strain(material, j, e_old[i]);
        double ds = s.value - s_old.value, turn = 0.5 * arm->gamma / stretch;
        element_decay(x, &decay, &mean);
        double slope = element_mean_slope(x, decay, mean), gain = arm->stiffness_N * mean;
        double by_x = isinf(x) ? 0.0 : x * (-decay * q_old[i] + arm->stiffness_N * slope * ds); /* x dq/dx */
        p[ELEMENT_STRAIN * n + i] = gain * s.slope - by_x * (e[i] < 0.0 ? -turn : turn);
        p[ELEMENT_STRAIN_OLD * n + i] = -gain * s_old.slope - by_x * (e_old[i] < 0.0 ? -turn : turn);
        p[ELEMENT_ARM_OLD * n + i] = decay;
        p[ELEMENT_DRIVE * n + i] = gain;
        p[ELEMENT_LOG_STIFFNESS * n + i] = gain * ds;
        p[ELEMENT_LOG_TIME * n + i] = -by_x;
        p[ELEMENT_BETA * n + i] = 0.5 * gain * (e[i] * fabs(e[i]) - e_old[i] * fabs(e_old[i]));
        p[ELEMENT_GAMMA * n + i] = -by_x * 0.5 * (fabs(e[i]) + fabs(e_old[i])) / stretch;
    }
}
