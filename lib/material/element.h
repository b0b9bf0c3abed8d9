/* element.h: what n elements of one material do in a time step. Internal. */
#ifndef ELEMENT_H
#define ELEMENT_H

#include <palpate/material.h>

/* Damage of a spring whose largest |e| so far is peak. Its strain is (|e| - set peak) / (1 - set), or 0 where
 * that is negative. Its force is multiplied by 1 - softening erf((W(peak) - W) / (sharpness W(peak))), W the
 * law's energy at that strain. slack: least share of the strain, without which a network could become a
 * mechanism. */
typedef struct element_damage {
    double set, softening, sharpness, slack;
} element_damage;

/* Constants of a step of dt seconds; arms with strain-dependent times compute theirs for each element. */
typedef struct element_step {
    double dt;
    double decay[PALP_ARMS_MAX];  /* exp(-dt / tau_j) */
    double gain[PALP_ARMS_MAX];   /* K_j (1 - exp(-dt / tau_j)) tau_j / dt, N */
    double dashpot;               /* b / dt, N */
    double carry;                 /* PALP_SEDEF2008: share of the previous force vector, Eq. 5.11 */
    double rate_factor;           /* factor of the spring's force; element_step_prepare sets 1 */
    const element_damage *damage; /* element_step_prepare sets NULL: no damage */
} element_step;

/* Prepared steps of one material: evenly sampled data have few different steps, apart from rounding.
 * Zero-initialised = none. */
enum { ELEMENT_STEPS = 8 };
typedef struct element_steps {
    size_t n, next;
    element_step step[ELEMENT_STEPS];
} element_steps;

/* The step of dt, prepared now if it is not there yet. */
const element_step *element_steps_of(const palp_material *material, double dt, element_steps *steps);

/* History of n elements, structure of arrays. */
typedef struct element_history {
    double *strain;  /* [n] */
    double *elastic; /* [n] K(|e|) e of a quasi-linear material, or NULL */
    double *arm;     /* arm j of n at arm + j stride */
    double *peak;    /* [n] largest |e| of a damaged spring, or NULL */
    size_t stride;
} element_history;

/* exp(-x) and (1 - exp(-x)) / x, with their limits at x = 0 and infinity. */
void element_decay(double x, double *decay, double *mean);

void element_step_prepare(const palp_material *material, double dt, element_step *step);

/* Force and tangent (N) of n elements at the strains e, and the history that a commit would keep.
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

/* Partial derivatives of an arm's force q at the end of a step, PALP_HISTORY. By the strain, its old value,
 * the old force, the drive, log K at fixed tau, log tau at fixed K, beta and gamma. */
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

/* For n elements, into partial[ELEMENT_PARTIALS n]. */
void element_arm_partials(const palp_material *material, const element_step *step, size_t arm, size_t n,
                          const double *e, const double *e_old, const double *q_old, double *partial);

/* d/dx of (1 - exp(-x)) / x, from both results of element_decay. */
double element_mean_slope(double x, double decay, double mean);

/* Force of a damaged spring and its derivatives; factor: the softening factor of the force. */
typedef struct element_damaged {
    double force, peak;        /* peak: includes e */
    double by_strain, by_peak; /* by_peak: by the old peak, 0 where e is the new one */
    double by_set, by_softening, by_sharpness;
    double inner, factor, factor_by_energy, factor_by_peak_energy; /* inner: the strain in the law */
} element_damaged;
void element_damage_force(const palp_law *law, const element_damage *damage, double e, double peak,
                          element_damaged *out);

#endif
