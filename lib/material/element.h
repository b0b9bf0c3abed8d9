/* element.h: what n elements of one material do in a time step. Internal. */
#ifndef ELEMENT_H
#define ELEMENT_H

#include <palpate/material.h>

/* What loading leaves behind in a spring that has been at peak, the largest |e| so far: it sees
 * (|e| - set peak) / (1 - set), 0 where that is negative, and its force is multiplied by
 * 1 - softening erf((W(peak) - W) / (sharpness W(peak))), W the law's energy there. slack: share of the
 * strain that it sees at least; a network without it would be a mechanism. */
typedef struct element_damage {
    double set, softening, sharpness, slack;
} element_damage;

/* Constants of a step of dt seconds; arms with strain-dependent times take theirs per element. */
typedef struct element_step {
    double dt;
    double decay[PALP_ARMS_MAX];  /* exp(-dt / tau_j) */
    double gain[PALP_ARMS_MAX];   /* K_j (1 - exp(-dt / tau_j)) tau_j / dt, N */
    double dashpot;               /* b / dt, N */
    double carry;                 /* PALP_SEDEF2008: share of the previous force vector, Eq. 5.11 */
    double rate_factor;           /* factor of the spring's force; prepare gives 1 */
    const element_damage *damage; /* prepare gives NULL: the spring does not damage */
} element_step;

/* Steps that were prepared, for one material: even samples have few different steps, but for rounding.
 * Zero-initialised = none. */
enum { ELEMENT_STEPS = 8 };
typedef struct element_steps {
    size_t n, next;
    element_step step[ELEMENT_STEPS];
} element_steps;

/* The one of dt, prepared now unless it is there. */
const element_step *element_steps_of(const palp_material *material, double dt, element_steps *steps);

/* palp_element_advance by a prepared step, without its checks. */
void element_advance(const palp_material *material, const element_step *step, const palp_element_state *from,
                     double strain, palp_element_state *to, double *tangent_N);

/* What n elements remember, structure of arrays. */
typedef struct element_history {
    double *strain;  /* [n] */
    double *elastic; /* [n] K(|e|) e, where the material is quasi-linear; or NULL */
    double *arm;     /* arm j of n at arm + j stride */
    double *peak;    /* [n] largest |e|, where the spring is damaged; or NULL */
    size_t stride;
} element_history;

/* exp(-x) and (1 - exp(-x)) / x, their limits at x = 0 and infinity included. */
void element_decay(double x, double *decay, double *mean);

void element_step_prepare(const palp_material *material, double dt, element_step *step);

/* Force and tangent (N) of n elements at the strains e, and the history a commit would keep.
 * PALP_SEDEF2008: force is A of Eq. 5.11; the caller adds carry times the previous force. */
void element_trial(const palp_material *material, const element_step *step, size_t n, const double *e,
                   const element_history *old, element_history *new, double *force, double *tangent);

/* Incremental energy, N: integral of the force over the strain at frozen history, up to a constant. False if
 * there is no closed form (strain-dependent relaxation times, changed springs). work[n] is scratch. */
bool element_energy(const palp_material *material, const element_step *step, size_t n, const double *e,
                    const element_history *old, double *energy, double *work);

/* The drive s of an arm, ds/de and its integral at strain e; elastic, tangent, energy are the law's. */
typedef struct element_drive {
    double value, slope, integral;
} element_drive;
element_drive element_arm_drive(const palp_material *material, size_t arm, double e, double elastic,
                                double tangent, double energy);

/* Partial derivatives of an arm's force q at the end of a step, PALP_HISTORY: by the strain, the strain and
 * force before it, the drive, log K with tau held, log tau with K held, beta and gamma. */
typedef enum element_partial {
    ELEMENT_STRAIN,
    ELEMENT_STRAIN_OLD,
    ELEMENT_ARM_OLD,
    ELEMENT_DRIVE,
    ELEMENT_LOG_STIFFNESS,
    ELEMENT_LOG_TIME,
    ELEMENT_BETA,
    ELEMENT_GAMMA,
    ELEMENT_PARTIALS
} element_partial;

/* Of n elements, partial[ELEMENT_PARTIALS n]. */
void element_arm_partials(const palp_material *material, const element_step *step, size_t arm, size_t n,
                          const double *e, const double *e_old, const double *q_old, double *partial);

/* d/dx of (1 - exp(-x)) / x, both functions of it given by element_decay. */
double element_mean_slope(double x, double decay, double mean);

/* Force of a damaged spring and its derivatives; factor: what softening makes of it. */
typedef struct element_damaged {
    double force, peak;        /* peak: with e in it */
    double by_strain, by_peak; /* peak: the old one, 0 where e is the new one */
    double by_set, by_softening, by_sharpness;
    double inner, factor, factor_by_energy, factor_by_peak_energy; /* inner: the strain that the law sees */
} element_damaged;
void element_damage_force(const palp_law *law, const element_damage *damage, double e, double peak,
                          element_damaged *out);

#endif
