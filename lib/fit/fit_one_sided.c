/* fit_one_sided.c: a plate that withdraws faster than the specimen recovers separates from it, as contact
 * cannot pull. The free surface then lags behind, and the plate meets it again on its next way down. */
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- whether a recording pulls ---- */

/* Mean force of so many neighbours in contact from sample i on, and whether there are so many. */
static bool mean_of(const palp_recording *rec, size_t i, size_t many, double *mean) {
    double sum = 0.0;
    for (size_t k = i; k < i + many; k++) {
        if (k >= rec->n || !rec->use[k] || rec->depth_m[k] <= 0.0)
            return false;
        sum += rec->force_N[k];
    }
    *mean = sum / (double)many;
    return true;
}

/* Whether the contact pulls: by more than the force's noise, its zero and a share of its peak. */
static bool pulls(const palp_recording *rec) {
    const double share = 0.02, sds = 5.0;
    size_t many = rec->n / 2000 > 4 ? (rec->n / 2000 < 64 ? rec->n / 2000 : 64) : 4;
    double peak = 0.0, mean, most = 0.0;
    for (size_t i = 0; i < rec->n; i++)
        peak = rec->use[i] ? fmax(peak, rec->force_N[i]) : peak;
    for (size_t i = 0; i < rec->n; i += many)
        if (mean_of(rec, i, many, &mean))
            most = fmax(most, -mean);
    return most > fmax(share * peak, sds * hypot(rec->noise_N / sqrt((double)many), rec->zero_sd_N));
}

bool fit_leaves(const palp_recording *rec) {
    const double back = 0.02 * rec->deepest_m; /* of the way */
    double deepest = 0.0;
    for (size_t i = 0; i < rec->n; i++) {
        double depth = rec->depth_m[i] > 0.0 ? rec->depth_m[i] : 0.0;
        if (depth > deepest)
            deepest = depth;
        else if (depth < deepest - back && rec->use[i])
            return !pulls(rec);
    }
    return false;
}

/* ---- where the surface is ---- */

/* The strain at which law(e) + push + stiffness (e - start) is 0, above the plate's, where it is negative:
 * Newton in a bracket. It ends a little beyond the former strain, as a free surface recovers. So it does not
 * jump to a second zero of a falling law, farther in. False: there is no such strain, and *strain stays. */
static bool free_strain(const palp_law *law, double plate, double push, double start, double stiffness,
                        double *strain) {
    const double close = 1e-12, most = fmin(0.999, fmax(plate, start) + 0.1 * fabs(start));
    double low = plate, high = most, e = fmin(fmax(start, low), high), last = 0.0;
    for (int i = 0; i < 100; i++) {
        double force, tangent;
        palp_law_force(law, 1, &e, &force, &tangent, NULL);
        double value = force + push + stiffness * (e - start), slope = tangent + stiffness;
        if (!isfinite(value))
            return false;
        *(value > 0.0 ? &high : &low) = e;
        double next = slope > 0.0 ? e - value / slope : 0.5 * (low + high);
        next = next >= low && next <= high ? next : 0.5 * (low + high);
        last = fabs(next - e);
        e = next;
        if (last <= close * most)
            break;
    }
    if (!(high < most && last <= 1e-9))
        return false;
    *strain = e;
    return true;
}

/* Force after the plate has moved from strain before to *strain. The arms have the forces rest[n] without
 * this motion, and gain[n] more for a strain of 1. Where the plate would pull, the surface leaves it: *strain
 * is then that of the free surface, and the force is 0. *tangent, unless NULL, is the derivative of the force
 * by the strain there. */
static double press(const palp_law *law, size_t n, const double *rest, const double *gain, double before,
                    double *strain, double *tangent) {
    double force, push = 0.0, stiffness = 0.0;
    for (size_t j = 0; j < n; j++) {
        push += rest[j];
        stiffness += gain[j];
    }
    palp_law_force(law, 1, strain, &force, NULL, NULL);
    force += push + stiffness * (*strain - before);
    if (!(force < 0.0) || !free_strain(law, *strain, push, before, stiffness, strain))
        return force;
    if (tangent) {
        palp_law_force(law, 1, strain, &force, tangent, NULL);
        *tangent += stiffness;
    }
    return 0.0;
}

void fit_force_one_sided(const palp_material *material, size_t n, const double *time, double *at) {
    element_steps steps = {0};
    double arm[PALP_ARMS_MAX] = {0}, before = 0.0;
    for (size_t i = 0; i < n; i++) {
        const element_step *step = element_steps_of(material, i ? time[i] - time[i - 1] : 0.0, &steps);
        double strain = at[i];
        for (size_t j = 0; j < material->n_arms; j++)
            arm[j] *= step->decay[j];
        at[i] = press(&material->law, material->n_arms, arm, step->gain, before, &strain, NULL);
        for (size_t j = 0; j < material->n_arms; j++)
            arm[j] += step->gain[j] * (strain - before);
        before = strain;
    }
}

/* ---- a run of the fit ---- */

/* A specimen with its derivatives by the parameters: its springs, then log K_j and log tau_j of each arm. */
typedef struct surface {
    const palp_law *law;
    size_t n_springs, n_arms, n; /* n: of all these */
    const double *arm;           /* log K_j, log tau_j in turn */
    double strain, *strain_p;    /* [n] */
    double *q, *q_p;             /* [n_arms] the arms' forces, [n_arms n] */
    double *rest, *rest_p;       /* the same after a step without motion */
    double *gain, *gain_p;       /* [n_arms] by a strain of 1, [2 n_arms] by log K_j and log tau_j */
    double *by_spring;           /* [n_springs] */
} surface;

static palp_status take_memory(arena *memory, surface *s) {
    double **arrays[] = {&s->strain_p, &s->q,    &s->q_p,    &s->rest,
                         &s->rest_p,   &s->gain, &s->gain_p, &s->by_spring};
    const size_t sizes[] = {s->n,      s->n_arms,     s->n_arms * s->n, s->n_arms, s->n_arms * s->n,
                            s->n_arms, 2 * s->n_arms, s->n_springs};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        *arrays[i] = arena_take(memory, sizes[i] + 1, sizeof(double));
    return memory->failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

/* The arms after dt at the same strain, and their derivative by a strain in that time; dt < 0: at once. */
static void rest(surface *s, double dt) {
    for (size_t j = 0; j < s->n_arms; j++) {
        double stiffness = exp(s->arm[2 * j]), x = dt > 0.0 ? dt / exp(s->arm[2 * j + 1]) : 0.0;
        double decay, mean, *to = s->rest_p + j * s->n;
        element_decay(x, &decay, &mean);
        s->rest[j] = decay * s->q[j];
        s->gain[j] = s->gain_p[2 * j] = stiffness * mean;
        s->gain_p[2 * j + 1] = stiffness * (mean - decay);
        for (size_t k = 0; k < s->n; k++)
            to[k] = decay * s->q_p[j * s->n + k] - s->gain[j] * s->strain_p[k];
        to[s->n_springs + 2 * j + 1] += x * decay * s->q[j];
    }
}

/* Derivatives of the force at the fixed strain e. */
static void slopes_of(surface *s, double e, double *force_p) {
    memset(force_p, 0, s->n * sizeof *force_p);
    palp_law_gradient(s->law, e, s->by_spring);
    memcpy(force_p, s->by_spring, s->n_springs * sizeof *force_p);
    for (size_t j = 0; j < s->n_arms; j++) {
        for (size_t k = 0; k < s->n; k++)
            force_p[k] += s->rest_p[j * s->n + k];
        for (size_t c = 0; c < 2; c++)
            force_p[s->n_springs + 2 * j + c] += s->gain_p[2 * j + c] * (e - s->strain);
    }
}

/* The arms with the strain of the end, whose derivatives are strain_p. */
static void move_to(surface *s, double e, const double *strain_p) {
    for (size_t j = 0; j < s->n_arms; j++) {
        double *to = s->q_p + j * s->n;
        s->q[j] = s->rest[j] + s->gain[j] * (e - s->strain);
        for (size_t k = 0; k < s->n; k++)
            to[k] = s->rest_p[j * s->n + k] + s->gain[j] * strain_p[k];
        for (size_t c = 0; c < 2; c++)
            to[s->n_springs + 2 * j + c] += s->gain_p[2 * j + c] * (e - s->strain);
    }
    memcpy(s->strain_p, strain_p, s->n * sizeof *strain_p);
    s->strain = e;
}

/* Steps to the plate's strain, or to that of the free surface. force_p[n]; work[n]. */
static double advance(surface *s, double plate, double dt, double *force_p, double *work) {
    double e = plate, tangent;
    rest(s, dt);
    const double force = press(s->law, s->n_arms, s->rest, s->gain, s->strain, &e, &tangent);
    memset(work, 0, s->n * sizeof *work);
    slopes_of(s, e, force_p);
    for (size_t k = 0; k < s->n && e > plate; k++) {
        work[k] = -force_p[k] / tangent;
        force_p[k] = 0.0;
    }
    move_to(s, e, work);
    return force;
}

palp_status fit_run_one_sided(const fit_problem *p, const palp_law *law, const double *v, size_t r,
                              size_t first, double *residual, double *jacobian) {
    const fit_run *run = &p->run[r];
    bool own = p->settings->spring == PALP_SPRING_PER_RUN;
    size_t m = p->n_blocks;
    arena memory = {0};
    palp_law plain = *law;
    surface s = {
        .law = &plain, .n_springs = own ? 1 : p->n_springs, .n_arms = p->n_arms, .arm = v + p->n_springs};
    s.n = s.n_springs + 2 * s.n_arms;
    double *force_p = arena_take(&memory, s.n, sizeof *force_p),
           *work = arena_take(&memory, s.n, sizeof *work);
    palp_status status = take_memory(&memory, &s);
    if (own && !status)
        status = palp_law_polynomial(1, &v[r], &plain);
    for (size_t i = 0; i < run->n && !status; i++) {
        double force = advance(&s, run->strain[i], i ? run->time[i] - run->time[i - 1] : -1.0, force_p, work);
        size_t row = first + i;
        double weight = sqrt(run->count[i]) / run->noise;
        residual[row] = weight * (force - run->force[i]);
        for (size_t k = 0; k < s.n && jacobian; k++) {
            size_t column = k < s.n_springs ? (own ? r : k) : p->n_springs + k - s.n_springs;
            jacobian[column * m + row] = weight * force_p[k];
        }
    }
    arena_free(&memory);
    return status;
}
