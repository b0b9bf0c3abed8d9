/* palpation_internal.h: the search for a ball or a layer in a map of presses. Lengths are in mean edges of
 * the mesh unless they say m. */
#ifndef PALPATION_INTERNAL_H
#define PALPATION_INTERNAL_H

#include <palpate/palpation.h>

/* Parameters of place and size; stiffness and gain too. */
enum { PALPATION_PLACE = 4, PALPATION_ALL = PALPATION_PLACE + 2 };
enum { PALPATION_LEVELS = 2 }; /* states of a press: at half its depth and at all of it */
enum { PALPATION_GAIN, PALPATION_LAW, PALPATION_LATTICE, PALPATION_COMMON };
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
    double *measured; /* [n] logarithms of the measured forces */
    double *bare;     /* [n] the lattice's error of the tissue alone */
    double *tissue;   /* [n] logarithms of its forces */
    double *more;     /* [n] what the error with one region is more than that */
    double *change;   /* [n] of the logarithms of force by that region */
    double *column;   /* [n PALPATION_COMMON] common errors of the presses, by columns: palpation_errors.c */
    double prior[PALPATION_COMMON]; /* variances of their multiples, 0: there is none */
    double *factor;                 /* [n n] of the forces' covariance with them, over the variance of one */
    double variance;                /* of the latter, for that factor */
    double known_squares, known;    /* prior of it: degrees of freedom, and these times its size */
    double *x;                      /* [3 n_nodes] for each level of each press: the last equilibrium */
    bool solved;                    /* x holds some */
    double *wanted;                 /* [n] measured, less the most probable multiple of the lattice's error */
    double *work, *elastic;         /* [n] model's, and with the nodes held at x */
    double *moved;                  /* [n] */
    double log_stiffness;           /* of the region */
    double done, planned;           /* evaluations */
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

/* slope[n parameters] by columns: derivatives of the logarithms of force by the first parameters of place and
 * size; that by the stiffness follows those of kind->n. The last palpation_solve was of the same p. */
palp_status palpation_slopes(palpation_search *s, const double *p, size_t parameters, double *slope);

/* A least_squares problem: whitened residuals r[n] of the logarithms of force, and the jacobian[n kind->n] by
 * columns unless NULL. A lost region has large residuals. */
palp_status palpation_residuals(void *user, const double *p, double *r, double *jacobian);

/* Presses the tissue with the region at p, or without one. */
palp_status palpation_press_region(palpation_search *s, const double *p, double log_stiffness,
                                   palp_error *error);
palp_status palpation_press_tissue(palpation_search *s, palp_error *error);

/* ---- errors that presses have in common: palpation_errors.c ---- */

/* Allocates them, for a lattice without an error. */
palp_status palpation_use_errors(palpation_search *s);

/* Sets their priors for the lattice's error off[n], whose most probable multiple is taken off the forces.
 * variance: of a force, 0: not known yet. */
void palpation_set_errors(palpation_search *s, const double *off, double variance);

/* Whitens logarithms of force v[n] by their covariance, and takes off a gain that is not known at all. Their
 * sum of squares then is that of the best common errors, with the squares of these over their priors. */
void palpation_whiten(const palpation_search *s, double *v);

/* The gain by residuals r[n], the model's less the measured ones. */
double palpation_gain(const palpation_search *s, const double *r);

/* Logarithm of the likelihood of these residuals, but for a constant. The variance of the forces, with its
 * prior, and all common errors are integrated out. */
double palpation_likelihood(const palpation_search *s, const double *r);

/* ---- the lattice's own error: palpation_lattice.c ---- */

/* Allocates what the presses of s->mesh need. The caller frees it by palpation_free, also after an error. */
palp_status palpation_use_mesh(palpation_search *s);
void palpation_free(palpation_search *s);

/* A lattice has an error at its borders, between its nodes and in the region. It is measured as the logarithm
 * of the ratio of forces, a finer lattice's over its own. The error of the tissue alone, which is pressed: */
palp_status palpation_measure_lattice(palpation_search *s, palp_error *error);

/* The error with this region; where the network has no equilibrium it stays that of the tissue. */
palp_status palpation_measure_region(palpation_search *s, const palpation_candidate *c);

/* The error with another, which was solved last: what it is more than that of the tissue goes with the change
 * of the forces. variance: of the forces. */
void palpation_use_region(palpation_search *s, double variance);

/* ---- evidence and intervals: palpation_posterior.c ---- */

/* Ends of a parameter's range. */
void palpation_range(const palpation_search *s, size_t k, double *low, double *high);

/* The variance of the forces that is expected with this region. */
double palpation_variance(const palpation_search *s, const palpation_candidate *c);

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
