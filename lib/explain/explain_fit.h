/* explain_fit.h: a model in search coordinates. Internal. */
#ifndef EXPLAIN_FIT_H
#define EXPLAIN_FIT_H

#include "explain_data.h"

#define EXPLAIN_SOFTEST 1e-3 /* of a typical stiffness: a law that falls below it makes no model */

typedef struct explain_fit {
    palp_model model;
    double hum_Hz;   /* 0 = none */
    double hum_cost; /* nats, of the prior of its frequency: uniform over the band of the mains */
    bool renewed;    /* each run finds its specimen as new, whatever the files say of their order */
    size_t n_columns;
    double low[EXPLAIN_COLUMNS], high[EXPLAIN_COLUMNS], x[EXPLAIN_COLUMNS]; /* search coordinates */
    double unit[EXPLAIN_COLUMNS]; /* prior sd of a coordinate: very wide */
    bool logarithmic[EXPLAIN_COLUMNS];
    double softest;                /* a law that is fitted alone is nowhere softer, N; 0: it is not asked */
    double strain;                 /* up to this one */
    double *contact, *gain, *zero; /* [n_runs] each, in one block: each run's surface, and its gain and zero
                                    * where a sensor bends, about which the columns are linear */
} explain_fit;

/* ---- coordinates (explain_fit.c) ---- */

palp_status explain_fit_create(const palp_model *model, const explain_data *data, explain_fit *fit);
palp_status explain_fit_copy(const explain_fit *from, size_t n_runs, explain_fit *to);
void explain_fit_free(explain_fit *fit);
size_t explain_first_column(const palp_model *model, size_t i); /* index of the first parameter of effect i */

/* Whether a sensor of the model is nonlinear: the effect of a run's gain and zero then depends on their
 * values. */
bool explain_bends(const palp_model *model);

/* Adds a run's gain and zero to those of the model's sensor, as far as the model has them. */
void explain_add_own(palp_model *model, double gain, double zero);

/* The columns of a run's contact, gain and zero. */
enum { EXPLAIN_BY_CONTACT, EXPLAIN_BY_GAIN, EXPLAIN_BY_ZERO, EXPLAIN_BY };

/* The model with a contact offset and a gain, if need be at zero. Where a sensor bends it has a bias too, if
 * there is room; otherwise that column is SIZE_MAX. ERR_LIMIT: there is no room for the others. */
palp_status explain_augment(const palp_model *model, palp_model *full, size_t column[EXPLAIN_BY]);

/* Derivatives by the model's parameters, gradient[columns n], into those by the coordinates: of an arm the
 * logarithms of its stiffness and of its time. */
void explain_chain(const explain_fit *fit, size_t n, double *gradient);

/* Whether a law is as stiff as the fit asks for. */
bool explain_is_stiff(const explain_fit *fit, const palp_law *law);

/* fit->x into fit->model. ERR_ARGUMENT: makes no model. ERR_NOT_CONVERGED: its law is too soft. */
palp_status explain_fit_to_model(explain_fit *fit);

/* ---- where an effect's search starts (explain_starts.c) ---- */

bool explain_has(const explain_fit *fit, palp_effect_id id);

/* Whether the paths of the plate show it or not. ERR_UNSUPPORTED: these runs cannot have it. */
palp_status explain_starts_find(palp_effect_id id, const explain_data *data, const double *residual,
                                effect_starts *s);

#endif
