/* infer_internal.h: the likelihood of measured runs (doc/likelihood.md): a model in search coordinates, what
 * each run has of its own, what the model does not follow, and the noise. Internal. */
#ifndef INFER_INTERNAL_H
#define INFER_INTERNAL_H

#include "explain_fit.h"

/* What a run has of its own beside its discrepancy: zero, contact, gain, and the mains' sine and cosine. */
enum { INFER_ZERO, INFER_CONTACT, INFER_GAIN, INFER_SINE, INFER_COSINE, INFER_OWN };

/* What a specimen has of its own: logarithms of a factor on all stiffnesses, one on all times, and one on the
 * law alone. */
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

enum { INFER_STATES = INFER_SLOW + 1 };       /* of the filter: these and the encoder's error */
enum { INFER_FILTER = 3 * INFER_STATES + 1 }; /* what it keeps of a sample: decays, gains, rows, sd */

/* Standard deviations of what is independent from sample to sample and of what is correlated. */
typedef struct infer_noise {
    double white, depth, clock;                /* N; of the recorded depth, m; of the recorded time, s */
    double encoder;                            /* m, of what its steps hide; 0 = it has none */
    double slow[INFER_SLOW], time[INFER_SLOW]; /* N, s: Ornstein-Uhlenbeck processes */
    double freedom;                            /* degrees of freedom of Student's t, of what is independent */
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

/* What the noise of a sample depends on. */
typedef struct infer_sample {
    double by_depth, by_time; /* of the force: by a depth that is new, N/m; along the run, N/s */
    double keep;              /* correlation of the encoder's error with that of the sample before */
    double certain;           /* expected precision of what is independent, in units of its variance's */
    double samples;           /* of which it is the mean, at least 1 */
} infer_sample;

/* Prior standard deviations; 0 = there is none of it. */
typedef struct infer_sizes {
    double own[INFER_OWN]; /* sine and cosine alike */
    double specimen[INFER_SPECIMEN];
    double common[INFER_DOMAINS][INFER_LENGTHS]; /* discrepancy of all runs, N */
    double each[INFER_DOMAINS][INFER_LENGTHS];   /* of each run, N */
    double bend; /* of log K from knot to knot, second differences: scale of their Cauchy prior */
} infer_sizes;

/* A coordinate by which the forces jump: no column says what it does, so its posterior is looked at place by
 * place. */
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
    size_t
        n_known; /* the first so many coordinates are as they are: a material that is not fitted, or none */
    bool plain;  /* it has no discrepancy */
    bool free;   /* its domains run over these terms instead (infer_columns.c) */
    size_t n_terms;
    palp_free_term term[INFER_DOMAINS];
    bool held;   /* contacts, gains that bend and specimens are where the columns are */
    double *raw; /* all runs' columns, run r at raw + first sample m */
    double *product;              /* [n_runs m m] of the whitened ones */
    double *specimen;             /* [n_runs INFER_SPECIMEN] where the columns are; alike in one specimen */
    infer_sample *sample;         /* [data->n] */
    double converter;             /* step of the force, N; 0 = none was found */
    double certain[PALP_LAW_MAX]; /* of each bend: expected precision, in units of sizes.bend's */
    double log_noise;             /* log determinant of the noise's covariance, less what tails add twice */
    double score;                 /* log Z at the parameters at hand, nats */
    double promised;              /* log Z after the best step that the columns at hand let expect */
} infer_fit;

/* What all runs together say of the common discrepancy (INFER_HATS) and then of the parameters (k), each
 * run's own eliminated, and then each specimen's. */
typedef struct infer_posterior {
    size_t g;                        /* INFER_HATS + k */
    double *factor;                  /* [g g] Cholesky factor of the posterior precision */
    double *mean;                    /* [g] the common discrepancy, and the best step of the parameters */
    double *normal, *pull;           /* [k k], [k] of the parameters, the common discrepancy eliminated, */
    double here;                     /* and chi2 without a step */
    double chi2, log_det, log_prior; /* with the step; of both precisions, with those of the runs' own */
    double *specimen; /* [n_runs] of their specimens, each specimen's factor and rows (infer_normal.c) */
    double *turn;     /* [INFER_HATS k] steps of the law that follow a hat as well as they can, which it is
                         free of; NULL: hats are as they are */
    size_t k;
    double *pull_of_mean; /* [g + 1] slopes, by the global ones, of the multiplier that makes the contacts
                             average 0; without a step, last */
    double mean_square;   /* variance that the multiplier takes away; 0: there is none */
    double *memory;
} infer_posterior;

/* ---- noise (infer_noise.c) ---- */

/* In place: rows x[count n], one a sample, in units of the innovations' sd, by one Kalman filter.
 * variance[n]: what is independent from sample to sample. Samples without use become 0. work[n INFER_FILTER +
 * INFER_STATES count]. Returns the log determinant. */
double infer_whiten(const infer_noise *noise, size_t n, const double *time, const infer_sample *sample,
                    const double *variance, const unsigned char *use, size_t count, double *x, double *work);

/* After infer_whiten of one column x[n] with the same work: x becomes the inverse of the covariance times the
 * column, and inverse[n] the inverse's diagonal. */
void infer_unwhiten(size_t n, const double *work, double *x, double *inverse);

/* After infer_whiten of x[n count] with the same work. The log likelihood is minus half the sum of the
 * columns' squares. Adds its derivatives by the logarithms of the sizes to slope[NOISES]. Adds their average
 * information, which the last column gives, to information[NOISES NOISES] (Gilmour, Thompson and Cullis,
 * Biometrics 51 (1995) 1440). count is at least NOISES. x and moved[n NOISES] are overwritten. */
void infer_noise_slope(const infer_noise *noise, size_t n, const infer_sample *sample, size_t count,
                       double *x, double *work, double *moved, double slope[INFER_NOISES],
                       double *information);

/* Noise as the samples show it, without tails: a first guess of what is learned. (infer_fit.c) */
void infer_noise_begin(infer_fit *fit, const explain_data *data);

/* What is independent from sample to sample, of one run: variance[n]. */
void infer_variance(const infer_fit *fit, size_t n, const infer_sample *sample, double *variance);

/* What a sample adds to the bound of the evidence, of this expected precision. */
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

/* into[n n] += the covariance of the parameters that square[SPECIMEN SPECIMEN] means. */
void infer_specimen_spread(const palp_material *m, const double *square, size_t n, double *into);

/* This share of the specimens' variances: square[SPECIMEN SPECIMEN]. */
void infer_specimen_variances(const infer_sizes *sizes, double share, double *square);

/* ---- heavy tails (infer_tails.c) ---- */

/* The samples' expected precisions and the degrees of freedom, at the columns at hand. */
palp_status infer_tails_learn(infer_fit *fit, const explain_data *data);

/* What sds from the expected precisions lack: these are not known themselves. */
double infer_tail_widening(const infer_fit *fit);

/* The sd of what is independent from sample to sample, N. */
double infer_white_level(const infer_fit *fit, const explain_data *data);

/* Lone samples far from their neighbours are events; the likelihood has them all the same. */
void infer_use_spikes(explain_data *data);

/* ---- priors (infer_prior.c) ---- */

bool infer_any(const double size[INFER_LENGTHS]); /* one of them is not 0 */

/* Covariance [INFER_NODES INFER_NODES] of the hats of unit size at this length: Matern's of order 3/2. */
void infer_matern(double length, double *covariance);

/* Adds the prior's precision of one domain's hats, of these sizes, at a[0] of a matrix with n rows. Returns
 * its log determinant; with no size at all the coefficients are held at 0. */
double infer_hats_precision(const double size[INFER_LENGTHS], size_t n, double *a);

/* Precision q[k k] of the coordinates, about fit->given; returns its log determinant. */
palp_status infer_prior(const infer_fit *fit, const explain_data *data, double *q, double *log_det);

/* Log evidence that the expected precisions of the bends add: 0 where all are 1. */
double infer_bends_evidence(const infer_fit *fit);

/* Whether runs have gains: where a specimen was pressed more than once. A gain is its specimen's otherwise.
 */
bool infer_has_gains(const explain_data *data);

/* A first guess: scatters and discrepancies of a percent, or of the noise. */
infer_sizes infer_sizes_first(const explain_data *data);

/* ---- from the products (infer_normal.c) ---- */

palp_status infer_posterior_find(const infer_fit *fit, const explain_data *data, infer_posterior *p);
void infer_posterior_free(infer_posterior *p);
/* Of the parameters at hand by p->here, after the best step by p->chi2. */
double infer_log_evidence(const infer_fit *fit, const infer_posterior *p, double chi2);

/* Run r's own at the posterior: mean[INFER_BLOCK], covariance[INFER_BLOCK INFER_BLOCK] (NULL: not wanted). */
palp_status infer_own(const infer_fit *fit, const explain_data *data, const infer_posterior *p, size_t r,
                      double *mean, double *covariance);

/* Step of the law's coordinate i that follows the posterior's common hats from .. to - 1, which they are free
 * of. */
double infer_undone(const infer_posterior *p, size_t from, size_t to, size_t i);

/* Posterior mean[m - 1] and covariance[(m - 1) (m - 1)] of the coefficients of run r's columns. A hat
 * function's is the sum of the common one and the run's own. */
palp_status infer_run_moments(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                              size_t r, double *mean, double *covariance);

/* What the specimen of run r has of its own, likewise: mean[INFER_SPECIMEN], covariance[INFER_SPECIMEN
 * INFER_SPECIMEN]. */
palp_status infer_specimen_own(const infer_posterior *p, size_t r, double *mean, double *covariance);

/* What its runs leave open of it where the mean is known: covariance[INFER_SPECIMEN INFER_SPECIMEN]. */
void infer_specimen_left(const infer_posterior *p, size_t r, double *covariance);

/* ---- sizes (infer_sizes.c) ---- */

/* Gives sizes that are 0 a small value again, before the columns are whitened. */
void infer_sizes_begin_anew(infer_fit *fit, const explain_data *data);

/* So many rounds of the fixed point of restricted maximum likelihood for fit->sizes, from the products. */
palp_status infer_sizes_learn(infer_fit *fit, const explain_data *data, size_t rounds);

/* At the products at hand: derivatives of the log evidence after the best step by the logarithms of the
 * noise's sizes, slope[NOISES]. information[NOISES NOISES] is their average information. Sets the scores too.
 * (infer_learn.c) */
palp_status infer_noise_slopes(infer_fit *fit, const explain_data *data, double slope[INFER_NOISES],
                               double *information);

/* The most probable fit->noise at the columns at hand, with products and score. anew: a size of nothing
 * begins where the samples barely show it. (infer_learn.c) */
palp_status infer_noise_learn(infer_fit *fit, const explain_data *data, size_t evaluations, bool anew);

/* ---- the fit (infer_fit.c) ---- */

palp_status infer_fit_create(const palp_model *model, const explain_data *data, const infer_fit *like,
                             infer_fit *fit);
/* The same with the model's law as it is. like: of a law with as many coefficients. */
palp_status infer_fit_create_as(const palp_model *model, const explain_data *data, const infer_fit *like,
                                infer_fit *fit);
/* What another fit of the same arms and effects has, but for its law. */
void infer_fit_take_state(const infer_fit *from, const explain_data *data, infer_fit *fit);
/* The spline law through another one. */
palp_status infer_spline_of(const palp_law *law, size_t knots, double deepest, palp_law *spline);
palp_status infer_fit_copy(const infer_fit *from, const explain_data *data, infer_fit *to);
void infer_fit_exchange(infer_fit *a, infer_fit *b);
void infer_fit_free(infer_fit *fit);

/* Which columns of a run can have something: list[m], returns how many; the residual is the last. */
size_t infer_active_columns(const infer_fit *fit, size_t *list);

/* Columns of fit->c.model, and their products; products of the columns at hand; score and promised of these.
 */
palp_status infer_fit_evaluate(infer_fit *fit, const explain_data *data);
palp_status infer_fit_products(infer_fit *fit, const explain_data *data);
/* Forces of fit->c.model beside the columns and the noise at hand, which were found near by; and their
 * products. Much cheaper than infer_fit_evaluate. */
palp_status infer_fit_reevaluate(infer_fit *fit, const explain_data *data);
palp_status infer_fit_score(infer_fit *fit, const explain_data *data);
void infer_take_scores(infer_fit *fit, const infer_posterior *p);
/* From the columns at hand to better parameters. (infer_improve.c) */
palp_status infer_fit_improve(infer_fit *fit, const explain_data *data, size_t evaluations);

/* The parameters of a bond between plate and surface to where they are most probable, and what the runs leave
 * open of them; all others follow by their best step. Where that is known already, the strength alone moves.
 * Nothing where there is no bond. (infer_scan.c) */
palp_status infer_scan_bond(infer_fit *fit, const explain_data *data);

/* What is left of all runs, [data->n]: beside the model and what the runs have of their own; and what the
 * discrepancy takes of that. */
palp_status infer_residual(const infer_fit *fit, const explain_data *data, double *residual,
                           double *discrepancy);

/* Parameters, contacts and sizes in turn; with noise, that too. (infer_settle.c) */
palp_status infer_fit_settle(infer_fit *fit, const explain_data *data, size_t rounds, bool noise);

/* To where another round changes its score by a thousandth of a nat: what is written does not depend on how
 * the search came there. */
palp_status infer_fit_converge(infer_fit *fit, const explain_data *data);

/* Parameters of a fit just made, without a discrepancy: white noise takes its place, as much of it each round
 * as the last one left. */
palp_status infer_fit_anneal(infer_fit *fit, const explain_data *data, size_t rounds);

/* The same for a fit just made, from a first guess of all sizes, in two ways, of which the more probable one
 * is kept: as it is; and its parameters first without a discrepancy, which could take their place. A law of
 * INFER_KNOTS begins with the coarse one's. */
palp_status infer_begin(infer_fit *fit, const explain_data *data, const palp_explain_settings *settings);

/* The same for a settled fit to which an effect was added: as it is, or from a first guess of sizes, contacts
 * and noise, which had taken the effect's place. */
palp_status infer_begin_anew(infer_fit *fit, const explain_data *data);

enum {
    INFER_LAST = 5
}; /* evaluations of the last improvement, as sizes and noise are learned after others */

/* The term of this kind for these runs. ERR_UNSUPPORTED: they have none of what it runs over. */
palp_status infer_free_term(const explain_data *data, palp_free_kind kind, palp_free_term *term);
/* Hat functions of a free fit, [INFER_HATS n]. (infer_columns.c) */
palp_status infer_free_hats(const infer_fit *fit, const explain_data *data, size_t r, double *column);

/* Hat functions of run r, whose surface is at this depth, [INFER_HATS n]. (infer_columns.c) */
void infer_hats(const explain_data *data, size_t r, double contact, double *column);

#endif
