/* fit_internal.h: the inside of a characterization fit. */
#ifndef FIT_INTERNAL_H
#define FIT_INTERNAL_H

#include <palpate/characterize.h>

#include "base/arena.h"
#include "material/element.h"

/* A recording in blocks of samples that are short against all changes. Every block has its mean time, strain
 * and force, and the number of its samples. */
typedef struct fit_run {
    size_t n;
    double *time, *strain, *force; /* [n] */
    double *count;                 /* [n] samples; 0 = the block is only a part of the history */
    double noise;                  /* sd of a sample, N, > 0 */
    double zero_sd;                /* of the zero force, N */
    double air_sd;                 /* of the contact's strain by the air before it, where contact_sd is 0 */
    double contact_sd;             /* of the strain, by the assumed contact; 0 where the air gave it */
    double place_sd; /* of the strain, as the plate may be anywhere within a count of its encoder */
    double end;      /* last time from the start, s */
    double peak;     /* largest |force| of a block, N */
    bool leaves;     /* the plate goes back and does not pull: it may separate from the specimen */
} fit_run;

typedef struct fit_problem {
    arena memory;            /* of the runs */
    size_t n_runs, n_blocks; /* blocks of all runs */
    fit_run *run;
    const palp_characterize_settings *settings;
    double height_m, strain_max;
    double stiffness; /* largest force by depth of all runs, N: the scale of forces */
    double tau_min, tau_max;
    size_t n_springs; /* parameters of the spring */
    palp_law law;     /* kind and shape; a constant with PALP_SPRING_PER_RUN */
    size_t n_arms;
    double least;               /* K(e) stays above this share of the stiffness of all; 0 = it is free */
    size_t n_times;             /* arms at fixed times: FRACTIONAL; 0 = free ones */
    double time[PALP_ARMS_MAX]; /* [n_times] rising, even in log */
    size_t n_reduced;           /* number of parameters on which they then depend; 0 = all */
    double *reduced;      /* [n_parameters n_reduced] by columns: derivatives of the parameters by those */
    double stop_relative; /* a fit stops where chi2 no longer falls by this part of it */
} fit_problem;

enum { FIT_PARAMETERS_MAX = 512 };

palp_status fit_problem_create(fit_problem *problem, size_t n, const palp_recording *recordings,
                               const palp_characterize_settings *settings, palp_error *error);
void fit_problem_free(fit_problem *problem);

/* Whether sample i is fitted: not masked, not in the air, nor on the ramp with dwell_only. */
bool fit_counts(const palp_recording *recording, const palp_characterize_settings *settings, size_t i);

size_t fit_parameter_count(const fit_problem *problem);

/* Residuals (model - measured) over the sd of the block's mean, and by columns their derivatives by
 * springs, log K_j, log tau_j ... jacobian may be NULL. */
palp_status fit_evaluate(const fit_problem *problem, const double *p, double *residual, double *jacobian);

/* Response of an arm of unit stiffness to a run's strain, and its derivative by log tau; slope may be NULL.
 */
void fit_arm_response(const fit_run *run, double tau, double *response, double *slope);

/* Whether its plate goes back, beyond the last withdrawal, and does not pull. */
bool fit_leaves(const palp_recording *recording);

/* Residuals of run r, whose first block is first, with a plate that may separate from the specimen. */
palp_status fit_run_one_sided(const fit_problem *problem, const palp_law *law, const double *p, size_t r,
                              size_t first, double *residual, double *jacobian);

/* The same for the force: at[n] are the plate's strains and become forces. */
void fit_force_one_sided(const palp_material *material, size_t n, const double *time, double *at);

/* First guesses: the best combinations of relaxation times on a grid, springs and K_j by linear least
 * squares; start[n_starts n_parameters], *found how many. */
palp_status fit_scan(const fit_problem *problem, size_t n_starts, double *start, size_t *found);

/* Polishes p by NLopt; *chi2 = sum of squared residuals of the fitted blocks. */
palp_status fit_polish(const fit_problem *problem, double *p, double *chi2, bool *converged);

/* Scan and polish from several starts, then K(e) > 0 if need be. */
palp_status fit_solve(fit_problem *problem, double *p, double *chi2, bool *converged);

/* Covariance of the parameters at v, and the residual's weighted square and its lag-1 correlation. */
typedef struct fit_curvature {
    double *covariance; /* [n^2] from the blocks' own noise */
    double *systematic; /* [n^2] from the zero force and the contact */
    double chi2, correlation;
    size_t freedom;
} fit_curvature;

/* Square of the residual, and its correlation from block to block of each run. */
void fit_sum_residual(const fit_problem *problem, const double *residual, fit_curvature *c);

palp_status fit_find_curvature(const fit_problem *problem, const double *v, fit_curvature *c);

/* Misfit and correlation of the residual widen the intervals: sqrt of reduced chi2, and of (1 + rho)/(1 -
 * rho), the loss of independent blocks for a first-order correlation. Neither ever narrows them. */
double fit_inflation(const fit_curvature *c);

/* Arms by rising tau. */
void fit_sort_arms(const fit_problem *problem, double *v);

/* Solves, and solves again with one arm less while the data cannot separate two. */
palp_status fit_solve_and_merge(fit_problem *problem, double *v, fit_curvature *c, palp_lumped_fit *fit);

/* The fit's result from the parameters v and their curvature. */
palp_status fit_finish(fit_problem *problem, const double *v, const fit_curvature *c, size_t n,
                       const palp_recording *recordings, const palp_characterize_settings *settings,
                       palp_lumped_fit *fit);

/* Normal equations of springs and arms at n_times times, gram[columns^2] whole below its diagonal and
 * right[columns], the caller's and 0: the spring's columns, n_springs or one for a law that is not linear,
 * then the arms'. *total: the forces' own square. */
palp_status fit_normal_equations(const fit_problem *problem, size_t n_times, const double *time, double *gram,
                                 double *right, double *total);
size_t fit_spring_columns(const fit_problem *problem);

/* Springs of a solution of these. */
void fit_springs_of(const fit_problem *problem, const double *solution, double *p);

/* Arms at fixed times: parameters p, and those that they depend on. theta[3]: of FRACTIONAL. */
palp_status fit_solve_spectrum(fit_problem *problem, double *p, double *theta, bool *converged);

/* In place of the arms' estimates those of FRACTIONAL. */
palp_status fit_estimate_fractional(const fit_problem *problem, const double *theta, const fit_curvature *c,
                                    palp_lumped_fit *fit);

/* Inverse of the symmetric a[n n], which is destroyed. It is first scaled to a unit diagonal. The smallest
 * ridge that makes it positive definite is added, from rounding size on. In directions that the data do not
 * determine, variances are very large, never negative. ERR_SINGULAR: it is indefinite by more than rounding,
 * or not finite. */
palp_status fit_invert(size_t n, double *a, double *inverse);

/* The law of a parameter vector, and the whole material with the arms in order of tau. */
palp_status fit_law(const fit_problem *problem, const double *p, palp_law *law);
palp_status fit_material(const fit_problem *problem, const double *p, palp_material *material);

/* The first arm that the data cannot separate from the next, or from none; n_arms if there is none. Two arms
 * are one if their times differ by less than two sds, or by less than 15 %; an arm is nothing if the sd of
 * log K is above 2. covariance[n n] of the parameters v[n], times in rising order; widen: factor on the
 * sds. */
size_t fit_weakest_arm(const fit_problem *problem, const double *v, const double *covariance, double widen);

/* The message of a status for a user of recordings. A message that is in error already stays. */
palp_status fit_failed(palp_error *error, palp_status status, const char *recording);

/* rms_N and absolute_N, which are 0 so far, of the fit's material over the samples that count. */
palp_status fit_fill_residuals(size_t n, const palp_recording *recordings,
                               const palp_characterize_settings *settings, palp_lumped_fit *fit);

#endif
