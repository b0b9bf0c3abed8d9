/* calibrate.h: find the element material with which a network gives a wanted force curve. May change. */
#ifndef PALPATE_CALIBRATE_H
#define PALPATE_CALIBRATE_H

#include <palpate/forward.h>
#include <palpate/network.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One evaluation of the force curve; in palpate/thesis.h one iteration of the thesis' loops. */
typedef struct palp_calibrate_iteration {
    int phase;           /* palp_thesis_three_phase: 1, 2, 3; else 0 */
    double residual_N;   /* 2-norm over the samples */
    double relative_rms; /* relaxation stage: the quantity that is minimised, the rms over the targets of each
                            one's rms force error divided by its peak (default weights) */
    palp_material material; /* with which it was evaluated */
    /* palp_thesis_three_phase: absolute values; NaN in the phases that do not measure them */
    double peak_error_percent, steady_time_error_percent, steady_force_error_percent;
} palp_calibrate_iteration;

/* The result; free with palp_calibration_free. */
typedef struct palp_calibration {
    palp_material material; /* the best found */
    double residual_N;      /* of that material */
    size_t n_iterations;
    palp_calibrate_iteration *iterations;
    size_t n_samples;                     /* static: of the curve */
    double *depth_m, *target_N, *force_N; /* [n_samples], the wanted and the reached curve */
    double reached_m;            /* static: depth that the best curve reached before its branch ended */
    bool buckled;                /* static: the best network loses stability */
    double stable_m, unstable_m; /* static: it is stable at the first and unstable at the second depth */
    double strain_max;           /* static: largest |element strain| of the best curve; see palp_law_limit */
    double region_stiffness[PALP_REGIONS_MAX]; /* presses: that of the model's regions, fitted or as given */
    bool converged;                            /* the method's own criterion was met */
} palp_calibration;

PALP_API void palp_calibration_free(palp_calibration *calibration); /* frees arrays, zeroes; NULL is fine */

/* Called after each evaluation; fraction is the part of the work that is done, 0 to 1. Non-zero stops with
 * ERR_STOPPED. */
typedef int (*palp_calibrate_progress)(void *user, double fraction, const palp_calibrate_iteration *last);

typedef struct palp_static_settings {
    size_t max_evaluations; /* of the curve */
    bool every_step;        /* solve every sample instead of error-controlled continuation */
    double curve_tolerance; /* continuation: estimated interpolation error relative to the peak force;
                               0 = 1e-6, or 1e-4 for networks that are costly to factor */
    double stop_relative;   /* stop when the residual changes less than this */
    palp_calibrate_progress progress; /* may be NULL; non-zero stops with ERR_STOPPED */
    void *user;
} palp_static_settings;

/* 60 evaluations, continuation with tolerance 0, stop at 1e-4. */
PALP_API palp_static_settings palp_static_settings_default(void);

/* Static stage (Section 5.3.1): fits the fully relaxed network's force at depth_m[n] (increasing, > 0) to
 * target_N[n], which noise may make zero or negative. The law of *start* (a polynomial or spline) gives the
 * form and the first guess. The network's supports, branch and solver are used; its material is replaced by
 * the result. Arms of start are kept as they are. The caller frees *result. ERR_UNSUPPORTED: another kind of
 * law; ERR_ARGUMENT: a depth out of range, a target that is not finite or, all in all, no press, too few
 * samples for the law; ERR_STOPPED by progress; the statuses of palp_material_check and, where no curve could
 * be found, of palp_network_step. */
PALP_API palp_status palp_calibrate_static(palp_network *network, const palp_material *start, size_t n,
                                           const double *depth_m, const double *target_N,
                                           const palp_static_settings *settings, palp_calibration *result);

/* The same for a network of many thousand nodes, in rounds on two levels (100,000 unknowns take a minute).
 * coarse is a network of some hundred nodes with the same body and supports. Each round fits the law of the
 * coarse network. The large network gets that law, scaled by the ratio of the summed lengths of their
 * elements, coarse over large, and is pressed at 24 depths. The ratio of the two forces hardly depends on
 * the law and corrects the target of the next round. The rounds end when the target is met to 1e-4 of its
 * peak or when one brings no improvement. The best round is the result, and the large network has its law. A
 * large network buckles at a smaller depth than a coarse one. Its branch ends where a press does not
 * converge at once (reached_m, buckled). With PALP_BRANCH_STABLE it is pressed further, down to the next
 * stable branch (stable_m, unstable_m). The force jumps there; force_N contains the jump, and the law is
 * that of the branch from rest. ERR_NOT_CONVERGED too if not even the first depth is reached. */
PALP_API palp_status palp_calibrate_two_level(palp_network *network, palp_network *coarse,
                                              const palp_material *start, size_t n, const double *depth_m,
                                              const double *target_N, const palp_static_settings *settings,
                                              palp_calibration *result);

/* A force record to meet: n samples along a path. */
typedef struct palp_target {
    palp_path path; /* corners of the plate's motion, starting at depth 0; caller's */
    size_t n;
    const double *time_s;  /* [n] increasing, caller's */
    const double *force_N; /* [n] caller's */
    double weight;         /* of its squared residuals; 0 = 1 / (n peak^2) */
} palp_target;

typedef struct palp_relaxation_settings {
    size_t max_evaluations;
    double dt_s;              /* fixed step; 0 = steps graded by tolerance */
    double tolerance;         /* of the graded steps, relative force */
    double stop_relative;     /* stop when the residual changes less than this */
    bool fit_beta, fit_gamma; /* strain dependence of the arms */
    bool one_beta;            /* one beta (and gamma) for all arms */
    bool fit_scale;           /* the stiffness law's scale */
    palp_calibrate_progress progress;
    void *user;
} palp_relaxation_settings;

/* 80 evaluations, graded steps of tolerance 1e-4, stop at 1e-4, one beta, the law's scale fitted, no strain
 * dependence. */
PALP_API palp_relaxation_settings palp_relaxation_settings_default(void);

/* Relaxation stage (Section 5.3.2): fits the arms (and optionally the law's scale and the strain
 * dependence) of *start so that the network's force meets all targets at once. The network's material is
 * replaced by the result, which the caller frees. ERR_UNSUPPORTED: another formulation than PALP_HISTORY, a
 * network with mass, beta of quasi-linear arms; ERR_ARGUMENT: no arm, no target, a target whose path or
 * record cannot be used; ERR_STOPPED by progress; the statuses of palp_material_check. */
PALP_API palp_status palp_calibrate_relaxation(palp_network *network, const palp_material *start,
                                               size_t n_targets, const palp_target *targets,
                                               const palp_relaxation_settings *settings,
                                               palp_calibration *result);

/* A press to meet: force_N[n] at depth_m[n] of a plate, or of a tool from where it just touches, along -y.
 * Times increase; the network is solved at the samples, and its strain is linear in time between them. */
typedef struct palp_press_target {
    bool plate;     /* by the supports' plate; else by the tool, on a network that stands on its "bottom" */
    palp_tool tool; /* its pose at depth 0 */
    bool relaxed;   /* the network is fully relaxed at every sample */
    size_t n;
    const double *time_s, *depth_m, *force_N; /* [n] caller's */
} palp_press_target;

typedef struct palp_presses_settings {
    size_t max_evaluations;            /* of all presses, not counting those for derivatives */
    double stop_relative;              /* stop when the residual changes less than this */
    bool fit_poisson;                  /* Poisson's ratio of the model, 0.25 to 0.49 */
    bool fit_beta;                     /* one strain dependence for all arms */
    bool fit_region[PALP_REGIONS_MAX]; /* stiffness of these regions of the model, each a factor: 0.01 to 100
                                        */
    palp_contact_settings contact;
    palp_calibrate_progress progress;
    void *user;
} palp_presses_settings;

/* 40 evaluations, stop at 1e-4, the default contact; Poisson's ratio and beta stay as they are. */
PALP_API palp_presses_settings palp_presses_settings_default(void);

/* Fits the law (a polynomial or spline) and the arms of a network model so that its forces meet all presses
 * at once. Each press counts by the mean square of its error over its peak force. The model's material is the
 * first guess, up to a factor; it and the Poisson's ratio are replaced by the best found. Effects of the
 * model are left out. mesh: the model's, with its regions. result, which the caller frees, has the samples of
 * all presses one after the other. ERR_UNSUPPORTED: another kind of law, mass, a Poisson's ratio where the
 * network cannot have one; ERR_ARGUMENT: no press, one without force, too few samples for the law, numbers
 * out of range; also a region to fit that is not there or has a material of its own. ERR_STOPPED by progress;
 * the statuses of palp_network_create, palp_network_enable_tools and, at the first guess, of
 * palp_network_step. */
PALP_API palp_status palp_calibrate_presses(palp_model *model, const palp_mesh *mesh, size_t n_targets,
                                            const palp_press_target *targets,
                                            const palp_presses_settings *settings, palp_calibration *result);

/* The covariance of a calibrated network's parameters, [n n] in the order of palp_model.covariance. It
 * follows from lumped->covariance and the derivatives of both models' forces in the runs of the calibration.
 * If between is not NULL, it receives the spread between specimens, from lumped->between, likewise. The
 * remaining force error of the calibration is added as the variance of a factor on the network's whole
 * stiffness. Errors of palp_forward_band; ERR_SINGULAR: runs without force. */
PALP_API palp_status palp_calibrate_covariance(const palp_model *lumped, const palp_model *network,
                                               size_t n_runs, const palp_forward_run *runs,
                                               double *covariance, double *between, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
