/* palpation_internal.h: the search for a ball or a layer in a map of presses. Lengths are in mean edges of
 * the mesh unless they say m. */
#ifndef PALPATION_INTERNAL_H
#define PALPATION_INTERNAL_H

#include <palpate/palpation.h>

/* Parameters of place and size; stiffness and gain too. */
enum { PALPATION_PLACE = 4, PALPATION_ALL = PALPATION_PLACE + 2 };
enum { PALPATION_LEVELS = 2 }; /* states of a press: at half its depth and at all of it */
enum { PALPATION_STIFFNESSES = 7, PALPATION_STARTS = 3 };

extern const char palpation_region[17];
extern const double palpation_stiffness[PALPATION_STIFFNESSES]; /* or one over these */

/* What is looked for. Of the n parameters the last is the logarithm of the size, a radius or a thickness; the
 * others are the middle. part: share of a point in m in the region, user being private. */
typedef struct palpation_kind {
    size_t n;
    palp_mesh_place *part;
} palpation_kind;

extern const palpation_kind palpation_ball, palpation_layer;

typedef struct palpation_search {
    const palpation_kind *kind;
    palp_model model;
    palp_mesh_source *source;
    palp_mesh *mesh;
    const palp_palpation_settings *settings;
    size_t n, n_nodes;
    const palp_palpation_press *press;
    double edge, low[3], high[3], shortest; /* m; edge: the mean of the mesh that is searched */
    palp_network *net;
    double known_squares; /* weight of the prior of the errors, in presses */
    double known;
    double gain_sd;    /* of the logarithm of a gain that is known */
    double gain_share; /* of a mean that is a gain if the errors have their prior size: 1 if it is not known
                          at all, 0 if exactly */
    double *x;         /* [3 n_nodes] for each level of each press: the last equilibrium */
    bool solved;       /* x holds some */
    double *wanted;    /* [n] logarithms of the measured forces, less the lattice's own error */
    double *work, *elastic; /* [n] model's, and with the nodes held at x */
    double *moved;          /* [n] */
    double log_stiffness;   /* of the region */
    double gain;
    double done, planned; /* evaluations */
} palpation_search;

/* A region of one stiffness that fits best. */
typedef struct palpation_candidate {
    double log_stiffness, p[PALPATION_PLACE], squares, gain, likelihood;
    double covariance[PALPATION_PLACE * PALPATION_PLACE]; /* over the variance of the forces, by rows */
    double along[PALPATION_PLACE]; /* derivatives of p, as fits best, by log_stiffness */
    bool known;                    /* there is one */
} palpation_candidate;

/* What was found of a kind. */
typedef struct palpation_answer {
    palpation_candidate best;
    double evidence, scatter, gain;
} palpation_answer;

/* ---- forces: palpation_forces.c ---- */

/* Statuses of a region with which the network has no equilibrium. */
bool palpation_lost(palp_status status);

/* Puts the region where p[kind->n] says. ERR_INPUT: no element has a part of it. */
palp_status palpation_place(palpation_search *s, const double *p);

/* Presses the network with the region as it was placed: work[n], x. Reports progress. */
palp_status palpation_solve(palpation_search *s, palp_error *error);

/* The mean forces work[n] with the nodes held at x. For a derivative nodes in equilibrium may stay: the
 * energy does not change with them to first order. */
palp_status palpation_hold(palpation_search *s, double *work);

/* Fits the gain to the logarithms v[n], and returns it. A share of their mean is subtracted. The sum of
 * squares then is that of the best gain, with the square of its own deviation. */
double palpation_subtract_gain(const palpation_search *s, double *v);

/* slope[n parameters] by columns: derivatives of the logarithms of force by the first parameters of place and
 * size; that by the stiffness follows those of kind->n. The last palpation_solve was of the same p. */
palp_status palpation_slopes(palpation_search *s, const double *p, size_t parameters, double *slope);

/* A least_squares problem: residuals r[n] of the logarithms of force, with the gain that fits best, and the
 * jacobian[n kind->n] by columns unless NULL. A lost region has large residuals. */
palp_status palpation_residuals(void *user, const double *p, double *r, double *jacobian);

/* Presses the tissue without a region. */
palp_status palpation_press_tissue(palpation_search *s, palp_error *error);

/* ---- the lattice's own error: palpation_lattice.c ---- */

/* Allocates what the presses of s->mesh need. The caller frees it by palpation_free, also after an error. */
palp_status palpation_use_mesh(palpation_search *s);
void palpation_free(palpation_search *s);

/* A lattice has an error at its borders and between its nodes. It is the logarithm of the ratio of forces, a
 * finer lattice's over its own. Takes that of the tissue alone off the measured forces, but for its mean, and
 * sets the priors of the errors and of a known gain. */
palp_status palpation_measure_lattice(palpation_search *s, palp_error *error);

/* ---- evidence and intervals: palpation_posterior.c ---- */

/* Ends of a parameter's range. */
void palpation_range(const palpation_search *s, size_t k, double *low, double *high);

/* Logarithm of the likelihood of residuals r[n], of which the gain's share is subtracted, but for a constant.
 * The variance of the forces, with its prior, and the gain are integrated out. */
double palpation_likelihood(const palpation_search *s, const double *r);

/* Degrees of freedom of the presses after so many parameters, and the gain if it is fitted; at least 1. */
double palpation_freedom(const palpation_search *s, size_t parameters);

/* Logarithm of the ratio of marginal likelihoods, of all stiffnesses over none, whose likelihood is given.
 * posterior[i] is the share of each. */
double palpation_evidence(const palpation_search *s, const palpation_candidate found[PALPATION_STIFFNESSES],
                          double none, double posterior[PALPATION_STIFFNESSES]);

/* The region of the most probable stiffness, whose index is returned, and intervals over all: value[n] of its
 * place and size, and of its stiffness. */
size_t palpation_intervals(const palpation_search *s, const palpation_candidate found[PALPATION_STIFFNESSES],
                           const double posterior[PALPATION_STIFFNESSES], palp_palpation_value *const *value);

/* ---- the search: palpation_search.c ---- */

/* Looks for a region of this kind in the corrected map. residual[n]: that of the tissue alone; value: of its
 * place, size and stiffness. */
palp_status palpation_find(palpation_search *s, const palpation_kind *kind, double *residual,
                           palp_palpation_value *const *value, palpation_answer *a);

#endif
