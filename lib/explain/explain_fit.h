/* explain_fit.h: a model in search coordinates, its sums over the runs, and its best parameters. Internal. */
#ifndef EXPLAIN_FIT_H
#define EXPLAIN_FIT_H

#include "explain_data.h"
#include "solve/levenberg.h"

#define EXPLAIN_CLEAR 10.0   /* nats of evidence that leave no doubt */
#define EXPLAIN_SOFTEST 1e-3 /* of a typical stiffness: a law that falls below it makes no model */

enum {
    EXPLAIN_NUISANCES = 6
}; /* of a run: zero, contact, gain, hum's sine and cosine, its specimen's stiffness */

/* Scatter of the runs' nuisance parameters: their prior sds. */
typedef struct explain_scatter {
    double zero, contact, gain;
    double stiffness; /* of the laws of the runs' specimens, as a share; 0 = one law for all */
} explain_scatter;

typedef struct explain_fit {
    palp_model model;
    double hum_Hz, hum_N; /* 0 = none; prior sd of its amplitude */
    bool renewed;         /* each run finds its specimen as new, whatever the files say of their order */
    size_t n_columns, m;
    double low[EXPLAIN_COLUMNS], high[EXPLAIN_COLUMNS], x[EXPLAIN_COLUMNS]; /* search coordinates */
    double unit[EXPLAIN_COLUMNS]; /* prior sd of a coordinate: very wide */
    bool logarithmic[EXPLAIN_COLUMNS];
    explain_scatter scatter;
    double *product;        /* [n_runs m m]: of the whitened columns of parameters, nuisances and residual */
    double *contact, *gain; /* [n_runs] each, in the same block: each run's surface, and its gain where a
                             * sensor bends, about which they are linear */
    const palp_explain_settings *spread; /* whose loop takes the runs; NULL, as in a task of that loop and in
                                            each new fit or copy: they are one after the other */
    double score; /* log likelihood (less constants) of the runs not held out, nuisances integrated out */
} explain_fit;

/* ---- coordinates and products (explain_fit.c) ---- */

palp_status explain_fit_create(const palp_model *model, const explain_data *data, explain_fit *fit);
/* The same for another model, with base's scatter and hum, and each run's surface, and gain where a sensor of
 * it bends, where base, whose products are known, has them. */
palp_status explain_fit_beside(const explain_fit *base, const palp_model *model, const explain_data *data,
                               explain_fit *fit);
palp_status explain_fit_copy(const explain_fit *from, size_t n_runs, explain_fit *to);
void explain_fit_free(explain_fit *fit);
size_t explain_first_column(const palp_model *model, size_t i); /* index of the first parameter of effect i */

/* Whether a sensor of the model reads no straight line over the force: how far a run's own gain goes depends
 * on where it is. */
bool explain_bends(const palp_model *model);

/* So much more to the gain of the model's sensor; nothing where the model has no room for one. */
void explain_add_gain(palp_model *model, double gain);

/* The model with a contact offset and a gain, if need be at zero, and their columns: a run's own contact and
 * gain are theirs. ERR_LIMIT: it has no room for them. */
palp_status explain_augment(const palp_model *model, palp_model *full, size_t *offset, size_t *gain);

/* Derivatives by the model's parameters, gradient[columns n], into those by the coordinates: of an arm the
 * logarithms of its stiffness and of its time. */
void explain_chain(const explain_fit *fit, size_t n, double *gradient);

/* Whether parameter p is the period of a wave over depth, which has ends on both sides in the runs' samples
 * and travel. */
bool explain_is_period(const effect_row *row, size_t p);

/* fit->x into fit->model. ERR_ARGUMENT: makes no model. */
palp_status explain_fit_to_model(explain_fit *fit);

/* Products and score at fit->model. force (NULL or [n]): what the model gives, each run's surface at
 * fit->contact. */
palp_status explain_fit_products(explain_fit *fit, const explain_data *data, double *force);

/* The same; residual (NULL or [n]): what force and the runs' nuisance parameters leave, 0 where a sample does
 * not count. */
palp_status explain_fit_evaluate(explain_fit *fit, const explain_data *data, double *force, double *residual);

/* The same; visit gets the m whitened columns [n] of each run: parameters, nuisance parameters, residual. */
typedef void explain_visit(void *user, size_t r, const double *column);
palp_status explain_fit_visit(explain_fit *fit, const explain_data *data, double *force, double *residual,
                              explain_visit *visit, void *user);

/* ---- from the products (explain_normal.c) ---- */

/* Normal matrix h[k k] (NULL: not wanted, nor g), gradient g[k] and chi2 of run r with its nuisances
 * eliminated; logdet: by how much they narrow. */
void explain_normal_of(const explain_fit *fit, size_t r, double *h, double *g, double *chi2, double *logdet);

/* The same of all runs that are not held out, with the priors. work: [k k + k]. */
void explain_fit_total(const explain_fit *fit, const explain_data *data, double *h, double *g, double *chi2,
                       double *work);

/* What chi2 has of a law that makes no model; 0: it makes one. (explain_wall.c) */
double explain_fit_wall(const explain_fit *fit, const explain_data *data);

/* What the fit's coordinates must hold so that the law makes one. free() of row after. */
palp_status explain_walls_find(const explain_fit *fit, const explain_data *data, levenberg_walls *walls);

double explain_fit_score(const explain_fit *fit, const explain_data *data);
double explain_chi2(const explain_data *data,
                    const explain_fit *fit); /* per sample of the runs not held out */

/* The run's nuisance parameters at the fit, and their sds. */
void explain_nuisances(const explain_fit *fit, size_t r, double value[EXPLAIN_NUISANCES],
                       double sd[EXPLAIN_NUISANCES]);

/* Their best values for what has these products with their columns. */
void explain_nuisances_for(const explain_fit *fit, size_t r, const double pull[EXPLAIN_NUISANCES],
                           double own[EXPLAIN_NUISANCES]);

/* What no run could show, for its noise. */
explain_scatter explain_hidden_scatter(const explain_data *data);

/* So little that no run has anything of its own: what the noise of all samples together hides. */
explain_scatter explain_no_scatter(const explain_data *data);

/* Re-estimates the scatter from the runs' nuisance parameters. */
void explain_fit_scatter(explain_fit *fit, const explain_data *data, const palp_explain_settings *settings);

/* What a gain in log likelihood counts if n runs have it by being off by the same. Their scatter is learned
 * from them and from what is expected of it, which counts as trust runs, and shrinks as their mean is taken
 * off. It counts what is as rare beside a known scatter, and no more than it is. known: the squares that are
 * expected, in units of a run's variance. By Satterthwaite's degrees of freedom, and the normal deviate for
 * Student's t of Wallace, Annals of Mathematical Statistics 30 (1959) 1124. */
double explain_students_gain(double gain, size_t n, double trust, double known);

/* The same of a fit with an effect that is of all runs what each has of its own (a bias, a contact offset,
 * ageing). */
double explain_gain_of_mean(const explain_fit *fit, const explain_data *data,
                            const palp_explain_settings *settings, const effect_row *row, double gain);

/* ---- better parameters (explain_improve.c) ---- */

/* chi2 after one more step, as the products predict it. */
palp_status explain_fit_predict(const explain_fit *fit, const explain_data *data, double *chi2);

/* Moves to the best parameters near by, and each run's surface, and gain where a sensor bends, to where they
 * find it. */
palp_status explain_fit_improve(explain_fit *fit, const explain_data *data, size_t rounds);

/* Improves it and re-estimates its scatter in turn, as each changes with the other. */
palp_status explain_fit_settle(explain_fit *fit, const explain_data *data,
                               const palp_explain_settings *settings);
/* The same of one that was just made beside another, by its sums first; spread over the search's threads. */
palp_status explain_fit_settle_anew(explain_fit *fit, const explain_data *data,
                                    const palp_explain_settings *settings);

/* ---- intervals (explain_interval.c) ---- */

/* Half widths of all parameters' intervals for a quadratic likelihood, reach[n_columns], in search
 * coordinates, and by how much chi2 may rise within them, rise[n_columns]; HUGE_VAL where the runs leave some
 * open. */
palp_status explain_reaches_find(const explain_fit *fit, const explain_data *data, double *reach,
                                 double *rise);

/* By how much what the fit leaves widens the variance of parameter at beyond what noise does; 1: not at all.
 * (explain_widen.c) */
palp_status explain_widening(explain_fit *fit, const explain_data *data, size_t at, double *widening);

/* ---- each run predicted by the others (explain_cross.c) ---- */

palp_status explain_fit_leave_out(const explain_fit *fit, const explain_data *data,
                                  double *score); /* [n_runs], log */

/* Score of b less that of a; its standard error, paired over the runs; less the run that gains most. */
typedef struct explain_pair {
    double gain, se, rest;
} explain_pair;

palp_status explain_paired(const explain_data *data, const explain_fit *a, const explain_fit *b,
                           explain_pair *pair);

/* ---- what it leaves (explain_residual.c) ---- */

double explain_rms(size_t n, const double *a, const double *b); /* of a - b */
double explain_fitted_rms(const explain_data *data,
                          const double *x); /* [n], of the samples that are fitted */

double
explain_noise_level(const explain_data *data); /* rms of the instrument's noise, white and correlated */

#endif
