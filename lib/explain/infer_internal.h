/* infer_internal.h: the likelihood of measured runs (doc/likelihood.md): a model in search coordinates,
 * parameters of each run, the discrepancy, and the noise. Internal. */
#ifndef INFER_INTERNAL_H
#define INFER_INTERNAL_H

#include "explain_fit.h"

#include <stdint.h>

/* Parameters of a run: zero, contact, gain, the mains' sine and cosine, and the end of the sensor's range.
 * Its discrepancy has others. */
enum { INFER_ZERO, INFER_CONTACT, INFER_GAIN, INFER_SINE, INFER_COSINE, INFER_END, INFER_OWN };

/* Parameters of a specimen: logarithms of a factor on all stiffnesses, one on all times, and one on the law
 * alone. */
enum { INFER_STIFFNESS, INFER_TIMES, INFER_LAW, INFER_SPECIMEN };

/* Discrepancies are sums over these of smooth functions, one a node of a grid (infer_columns.c: hats). */
enum { INFER_LOADING, INFER_UNLOADING, INFER_DWELL, INFER_WITHDRAWN, INFER_DOMAINS };
enum { INFER_NODES = PALP_FREE_NODES, INFER_HATS = INFER_DOMAINS * INFER_NODES };
enum { INFER_LENGTHS = 2 }; /* correlation lengths of each, as shares of the range: infer_lengths */
enum { INFER_BLOCK = INFER_OWN + INFER_HATS };
enum { INFER_SLOW = 4 }; /* processes of the correlated noise, from a few samples to the longest run */
/* Knots of the law: half the intervals of the coarse one, with which a search begins. */
enum { INFER_COARSE = 16, INFER_KNOTS = 2 * INFER_COARSE - 1 };

extern const double infer_lengths[INFER_LENGTHS];

enum { INFER_STATES = INFER_SLOW + 1 }; /* of the filter: these and the encoder's error */
enum {
    INFER_FILTER = 3 * INFER_STATES + 1
}; /* numbers that it keeps for a sample: decays, gains, rows,
      sd */

/* Standard deviations of what is independent from sample to sample and of what is correlated. */
typedef struct infer_noise {
    double white, depth, clock;                /* N; of the recorded depth, m; of the recorded time, s */
    double encoder;                            /* m, of the encoder's rounding error; 0 = it has none */
    double slow[INFER_SLOW], time[INFER_SLOW]; /* N, s: Ornstein-Uhlenbeck processes */
    double freedom;                            /* degrees of freedom of Student's t, for the independent
                                                  noise */
    double slow_freedom[INFER_SLOW]; /* and for the innovations of the correlated noise; 0: they are normal */
} infer_noise;

/* The sizes among these; the encoder's is last, as it may be none. */
enum {
    INFER_BY_WHITE,
    INFER_BY_DEPTH,
    INFER_BY_CLOCK,
    INFER_BY_SLOW,
    INFER_BY_ENCODER = INFER_BY_SLOW + INFER_SLOW,
    INFER_NOISES
};

/* Slopes and weights on which the noise of a sample depends. */
typedef struct infer_sample {
    double by_depth, by_time; /* of the force: by a change of depth at one sample, N/m; along the run, N/s */
    /* The same of the last model, which infer_weigh puts in their place: */
    double next_by_depth, next_by_time;
    double keep;               /* correlation of the encoder's error with that of the sample before */
    double certain;            /* expected precision of the independent noise, in units of the inverse
                                  variance */
    double samples;            /* of which it is the mean, at least 1 */
    double steady[INFER_SLOW]; /* expected precision of the correlated noise's innovations to this sample,
                                  likewise */
} infer_sample;

/* Prior standard deviations; 0 = there is none of it. */
typedef struct infer_sizes {
    double own[INFER_OWN]; /* sine and cosine alike; that of the end is the zero's, or 0 */
    double specimen[INFER_SPECIMEN];
    double common[INFER_DOMAINS][INFER_LENGTHS]; /* discrepancy of all runs, N */
    double each[INFER_DOMAINS][INFER_LENGTHS];   /* of each run, N */
    double bend; /* of log K from knot to knot, second differences: scale of their Cauchy prior */
} infer_sizes;

/* A coordinate by which the forces jump. It has no derivative, so its posterior is evaluated on a grid. */
typedef struct infer_scan {
    bool jumps;       /* it is one */
    double spread;    /* integral of the posterior over its density here; 0: not known */
    double low, high; /* of 95 % of it */
} infer_scan;

/* One block of columns of a run: [k parameters | INFER_OWN | INFER_HATS | INFER_SPECIMEN | residual], each
 * [n]. */
typedef struct infer_fit {
    explain_fit c; /* the model and its coordinates; contacts and gains where the columns are */
    size_t k, m;   /* parameters; columns of a run: k + INFER_BLOCK + INFER_SPECIMEN + 1 */
    infer_noise noise;
    infer_sizes sizes;
    double given[EXPLAIN_COLUMNS]; /* prior mean of each coordinate, */
    double width[EXPLAIN_COLUMNS]; /* and its sd; 0: an effect's strength, see infer_prior */
    infer_scan scan[EXPLAIN_COLUMNS];
    size_t n_known; /* so many first coordinates are fixed: a material that is not fitted, or none */
    bool plain;     /* it has no discrepancy */
    bool free;      /* its domains run over these terms instead (infer_columns.c) */
    size_t n_terms;
    palp_free_term term[INFER_DOMAINS];
    bool kept_weights; /* by_depth and by_time stay those of an earlier model */
    bool held;   /* contacts, specimens, gains and zeros of a nonlinear sensor are fixed at the values of the
                    columns */
    double *raw; /* all runs' columns, run r at raw + first sample m */
    double *product;         /* [n_runs m m] of the whitened ones */
    double *specimen;        /* [n_runs INFER_SPECIMEN] where the columns are; alike in one specimen */
    double *contact_certain; /* [n_runs] expected precision of each contact, in units of that of its size */
    infer_sample *sample;    /* [data->n] */
    double converter;        /* step of the force, N; 0 = none was found */
    double rounding;         /* sd of the rounding to the encoder's steps, m */
    double certain[PALP_LAW_MAX]; /* of each bend: expected precision, in units of sizes.bend's */
    double log_noise;             /* log determinant of the noise's covariance, less the part that tails count
                                     twice */
    double score;                 /* log Z at the current parameters, nats */
    double promised;              /* log Z predicted by the current columns after the best step */
} infer_fit;

/* The posterior of the common discrepancy (hats) and the parameters (k) from all runs. Each run's own
 * parameters are eliminated, then each specimen's. Domains without any size are left out. */
typedef struct infer_posterior {
    size_t g;                        /* hats + k */
    size_t hats, hat[INFER_HATS];    /* so many; which of INFER_HATS each is */
    size_t width;                    /* of a run's block: INFER_OWN + hats */
    size_t domain[INFER_DOMAINS];    /* the first of each domain; SIZE_MAX: it is left out */
    double *factor;                  /* [g g] Cholesky factor of the posterior precision */
    double *mean;                    /* [g] the common discrepancy, and the best step of the parameters */
    double *normal, *pull;           /* [k k], [k] of the parameters, the common discrepancy eliminated, */
    double here;                     /* and chi2 without a step */
    double chi2, log_det, log_prior; /* with the step; of both precisions, with those of the runs'
                                        parameters */
    double *specimen; /* [n_runs] of their specimens, each specimen's factor and rows (infer_normal.c) */
    double *turn;     /* [hats k] steps of the law nearest to a hat, which are taken off it; NULL: hats
                         are not orthogonal to the law */
    size_t k;
    double *pull_of_mean; /* [g + 1] slopes, by the global ones, of the multiplier that makes the contacts
                             average 0; without a step, last */
    double mean_square;   /* variance that the multiplier removes; 0: there is none */
    double *memory;
} infer_posterior;

/* ---- noise (infer_noise.c) ---- */

/* In place: rows x[count n], one a sample, in units of the innovations' sd, by one Kalman filter.
 * variance[n]: that of the independent noise. Samples without use become 0. work[n INFER_FILTER +
 * INFER_STATES count]. Returns the log determinant. */
double infer_whiten(const infer_noise *noise, size_t n, const double *time, const infer_sample *sample,
                    const double *variance, const unsigned char *use, size_t count, double *x, double *work);

/* After infer_whiten of one column x[n] with the same work: x becomes the inverse of the covariance times the
 * column, and inverse[n] the inverse's diagonal. square[n] (NULL: not wanted): expected squares of the
 * innovations of the correlated noise to each sample, over their variance: [n INFER_SLOW]. */
void infer_unwhiten(const infer_noise *noise, size_t n, const infer_sample *sample, const double *work,
                    double *x, double *inverse, double *square);

/* After infer_whiten of x[n count] with the same work. The log likelihood is minus half the sum of the
 * columns' squares. Adds its derivatives by the logarithms of the sizes to slope[NOISES]. Adds their average
 * information, which the last column gives, to information[NOISES NOISES] (Gilmour, Thompson and Cullis,
 * Biometrics 51 (1995) 1440). count is at least NOISES. x and moved[n NOISES] are overwritten. */
void infer_noise_slope(const infer_noise *noise, size_t n, const infer_sample *sample, size_t count,
                       double *x, double *work, double *moved, double slope[INFER_NOISES],
                       double *information);

/* A first guess of the noise from the samples, without tails. (infer_fit.c) */
void infer_noise_begin(infer_fit *fit, const explain_data *data);

/* Variance[n] of the independent noise of one run. */
void infer_variance(const infer_fit *fit, size_t n, const infer_sample *sample, double *variance);

/* The contribution of a sample with this expected precision to the bound of the evidence. */
double infer_tail_evidence(double freedom, double certain);

/* ---- steps of encoder and converter (infer_steps.c) ---- */

/* The largest step of which all differences in value[n] are multiples, given that of others (0: there are
 * none yet; NAN: they have none). */
double infer_common_step(size_t n, const double *value, double step);

/* Finds the steps of both columns, and the correlation of the encoder's error. */
void infer_steps_find(infer_fit *fit, const explain_data *data);

/* ---- what a specimen has of its own (infer_factors.c) ---- */

/* The factor on its law in all, and the sd of its logarithm. */
double infer_law_factor(const double own[INFER_SPECIMEN]);
double infer_law_sd(const infer_sizes *sizes);

palp_status infer_specimen_material(const palp_material *population, const double own[INFER_SPECIMEN],
                                    palp_material *material);

/* Derivatives of the n parameters of the material (springs, then K_j and b_j): x[INFER_SPECIMEN n]. */
void infer_specimen_slopes(const palp_material *m, size_t n, double *x);

/* into[n n] += the covariance of the parameters for a specimen's covariance square[SPECIMEN SPECIMEN]. */
void infer_specimen_spread(const palp_material *m, const double *square, size_t n, double *into);

/* This share of the specimens' variances: square[SPECIMEN SPECIMEN]. */
void infer_specimen_variances(const infer_sizes *sizes, double share, double *square);

/* ---- heavy tails (infer_tails.c) ---- */

/* Estimates the samples' expected precisions and the degrees of freedom, at the current columns. */
palp_status infer_tails_learn(infer_fit *fit, const explain_data *data);

/* Factor on sds from the expected precisions, since these are uncertain themselves. */
double infer_tail_widening(const infer_fit *fit);

/* The sd of the independent noise, N. */
double infer_white_level(const infer_fit *fit, const explain_data *data);

/* Lone samples far from their neighbours are events; the likelihood includes them. */
void infer_use_spikes(explain_data *data);

/* ---- priors (infer_prior.c) ---- */

bool infer_any(const double size[INFER_LENGTHS]); /* one of them is not 0 */

/* Covariance [INFER_NODES INFER_NODES] of the hats of unit size at this length: Matern's of order 3/2. */
void infer_matern(double length, double *covariance);

/* Adds the prior's precision of one domain's hats, of these sizes, at a[0] of a matrix with n rows. Returns
 * its log determinant; with no size at all the coefficients are fixed at 0. */
double infer_hats_precision(const double size[INFER_LENGTHS], size_t n, double *a);

/* Precision q[k k] of the coordinates, about fit->given; returns its log determinant. */
palp_status infer_prior(const infer_fit *fit, const explain_data *data, double *q, double *log_det);

/* Cauchy's distribution as a mixture of normal ones: the expected precision of what has this expected square,
 * both in units of the scale's, and what it adds to the log evidence: 0 where it is 1. */
double infer_cauchy_certain(double square);
double infer_cauchy_evidence(double certain);

/* Log evidence that the expected precisions of the bends add. */
double infer_bends_evidence(const infer_fit *fit);

/* Whether runs have gains: if a specimen was pressed more than once. Otherwise a gain belongs to its
 * specimen. */
bool infer_has_gains(const explain_data *data);

/* A first guess: scatters and discrepancies of a percent, or of the noise. */
infer_sizes infer_sizes_first(const explain_data *data);

/* ---- from the products (infer_normal.c) ---- */

palp_status infer_posterior_find(const infer_fit *fit, const explain_data *data, infer_posterior *p);
void infer_posterior_free(infer_posterior *p);
/* Scores of the current parameters by p->here, and after the best step by p->chi2. */
double infer_log_evidence(const infer_fit *fit, const infer_posterior *p, double chi2);

/* The posterior mean of a common hat of INFER_HATS. */
double infer_common(const infer_posterior *p, size_t hat);

/* Parameters of run r at the posterior: mean[INFER_BLOCK], covariance[INFER_BLOCK INFER_BLOCK] (NULL: not
 * wanted). A hat without a size has mean 0, and variance 1. */
palp_status infer_own(const infer_fit *fit, const explain_data *data, const infer_posterior *p, size_t r,
                      double *mean, double *covariance);

/* Step of the law's coordinate i that was taken off the common hats from .. to - 1 at the posterior. */
double infer_undone(const infer_posterior *p, size_t from, size_t to, size_t i);

/* Posterior mean[m - 1] and covariance[(m - 1) (m - 1)] of the coefficients of run r's columns. A hat
 * function's is the sum of the common one and the run's own. */
palp_status infer_run_moments(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                              size_t r, double *mean, double *covariance);

/* Parameters of run r's specimen, likewise: mean[INFER_SPECIMEN], covariance[INFER_SPECIMEN
 * INFER_SPECIMEN]. */
palp_status infer_specimen_own(const infer_posterior *p, size_t r, double *mean, double *covariance);

/* Their covariance if the mean is known: covariance[INFER_SPECIMEN INFER_SPECIMEN]. */
void infer_specimen_left(const infer_posterior *p, size_t r, double *covariance);

/* ---- sizes (infer_sizes.c) ---- */

/* Gives sizes that are 0 a small value again, before the columns are whitened. */
void infer_sizes_begin_anew(infer_fit *fit, const explain_data *data);

/* So many rounds of the fixed point of restricted maximum likelihood for fit->sizes, from the products. */
palp_status infer_sizes_learn(infer_fit *fit, const explain_data *data, size_t rounds);

/* At the products at hand and their posterior: derivatives of the log evidence after the best step by the
 * logarithms of the noise's sizes, slope[NOISES]. information[NOISES NOISES] is their average information.
 * (infer_learn.c) */
palp_status infer_noise_slopes(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                               double slope[INFER_NOISES], double *information);

/* The most probable fit->noise at the current columns, with products and score. anew: a size of 0 begins
 * where the samples barely show it. (infer_learn.c) */
palp_status infer_noise_learn(infer_fit *fit, const explain_data *data, size_t evaluations, bool anew);

/* ---- the fit (infer_fit.c) ---- */

palp_status infer_fit_create(const palp_model *model, const explain_data *data, const infer_fit *like,
                             infer_fit *fit);
/* The same with the model's law as it is. like: of a law with as many coefficients. */
palp_status infer_fit_create_as(const palp_model *model, const explain_data *data, const infer_fit *like,
                                infer_fit *fit);
/* Copies all but the law from another fit of the same arms and effects. */
void infer_fit_take_state(const infer_fit *from, const explain_data *data, infer_fit *fit);
/* The spline law that interpolates another law. */
palp_status infer_spline_of(const palp_law *law, size_t knots, double deepest, palp_law *spline);
palp_status infer_fit_copy(const infer_fit *from, const explain_data *data, infer_fit *to);
void infer_fit_exchange(infer_fit *a, infer_fit *b);
void infer_fit_free(infer_fit *fit);

/* Columns of a run that may be nonzero: list[m]. Returns how many; the residual is the last. */
size_t infer_active_columns(const infer_fit *fit, size_t *list);

/* Columns of fit->c.model, and their products; products of the current columns; score and promised of
 * these. */
palp_status infer_fit_evaluate(infer_fit *fit, const explain_data *data);
palp_status infer_fit_products(infer_fit *fit, const explain_data *data);
/* The noise that the last model implies. Products and score stay as they were. */
void infer_weigh(infer_fit *fit, const explain_data *data);
/* Forces of fit->c.model, with the columns and the noise of a nearby model; and their products. Much cheaper
 * than infer_fit_evaluate. */
palp_status infer_fit_reevaluate(infer_fit *fit, const explain_data *data);
palp_status infer_fit_score(infer_fit *fit, const explain_data *data);
void infer_take_scores(infer_fit *fit, const infer_posterior *p);
/* From the current columns to better parameters. (infer_improve.c) */
palp_status infer_fit_improve(infer_fit *fit, const explain_data *data, size_t evaluations);

/* Moves the parameters of a bond between plate and surface to their most probable values, and finds their
 * posterior; all others follow by their best step. If that posterior is known already, the strength alone
 * moves. Without a bond it does nothing. (infer_scan.c) */
palp_status infer_scan_bond(infer_fit *fit, const explain_data *data);

/* The sd of a run's pull where its plate lets go, from all parameters but the bond's: r.m.s. over the runs
 * that pull. On the grid all others stay near their values, so that only the sample of the release counts, as
 * if the pull there were known. */
palp_status infer_scan_pull(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                            size_t strength, double *sd);

/* The residual of all runs, [data->n], after the model and the runs' own parameters; and the discrepancy's
 * part of it. */
palp_status infer_residual(const infer_fit *fit, const explain_data *data, double *residual,
                           double *discrepancy);

/* Parameters, contacts and sizes in turn; with noise, that too. (infer_settle.c) */
palp_status infer_fit_settle(infer_fit *fit, const explain_data *data, size_t rounds, bool noise);

/* Continues until a round changes the score by less than a thousandth of a nat. So the result does not depend
 * on the path of the search. */
palp_status infer_fit_converge(infer_fit *fit, const explain_data *data);

/* Parameters of a new fit without a discrepancy: white noise takes its place, each round as large as the last
 * residual. */
palp_status infer_fit_anneal(infer_fit *fit, const explain_data *data, size_t rounds);

/* The same for a new fit, from a first guess of all sizes, in two ways: directly, and with the parameters
 * first fitted without a discrepancy, which could take their place. The more probable end is kept. A law of
 * INFER_KNOTS begins with the coarse one's. */
palp_status infer_begin(infer_fit *fit, const explain_data *data, const palp_explain_settings *settings);

/* The same for a converged fit to which an effect was added: directly, or from a first guess of sizes,
 * contacts and noise, which had absorbed the effect. */
palp_status infer_begin_anew(infer_fit *fit, const explain_data *data);

enum {
    INFER_LAST = 5
}; /* evaluations of the last improvement; sizes and noise are estimated after the others */

/* The term of this kind for these runs; longer: so many times a response of twice the time. ERR_UNSUPPORTED:
 * the runs do not have its variable. */
palp_status infer_free_term(const explain_data *data, palp_free_kind kind, int longer, palp_free_term *term);
/* Hat functions of a free fit, [INFER_HATS n]. left[n]: the run's residual. (infer_columns.c) */
palp_status infer_free_hats(const infer_fit *fit, const explain_data *data, size_t r, const double *left,
                            double *column);

/* Hat functions of run r, whose surface is at this depth, [INFER_HATS n]. (infer_columns.c) */
void infer_hats(const explain_data *data, size_t r, double contact, double *column);

#endif
