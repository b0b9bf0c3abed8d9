/* forward.h: the forward model of an instrument: from the depth that its encoder reads to the force that its
 * sensor reads. Contact, specimen and every effect of the model act in between; derivatives are exact. May
 * change. */
#ifndef PALPATE_FORWARD_H
#define PALPATE_FORWARD_H

#include <palpate/model.h>
#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The load history of a specimen, on which damage and permanent set depend. Zero-initialised: a fresh
 * specimen. In a network each element keeps its own largest strain; free it with palp_load_history_free.
 * With peak alone it is a specimen that was slowly pressed to that strain. */
typedef struct palp_load_history {
    double peak;    /* largest strain so far, of a network's surface */
    double *peak_p; /* [n_parameters] its derivatives, caller's; NULL with no gradient */
    struct palp_load_history_elements *elements;
} palp_load_history;

PALP_API void palp_load_history_free(palp_load_history *history); /* as fresh then; peak_p stays as it is */

/* A column of a recording that an effect of the model reads (palp_effect_info.column). */
typedef struct palp_forward_column {
    const char *name;
    const double *value; /* [n] in the unit of the recording; caller's */
} palp_forward_column;

/* One recording for the forward model. All members but the first three may be zero. */
typedef struct palp_forward_run {
    size_t n;
    const double *time_s, *depth_m;    /* as the encoder reads them, 0 = nominal contact; caller's */
    double session_s;                  /* when in the session it began (session_ageing) */
    double hum_phase;                  /* of mains_hum at time 0, rad */
    size_t parts;                      /* steps of the specimen from sample to sample; 0 = 1 */
    size_t n_columns;                  /* a column that is missing is taken as constant */
    const palp_forward_column *column; /* [n_columns] */
    palp_load_history *history;        /* NULL, or in: the state before the run; out: the state after it */
    double contact_m;                  /* depth of this run's surface below that of the model */
    const double *added_N; /* [n] a force on the sensor in addition to the model's; NULL = nothing;
                              caller's */
} palp_forward_run;

/* The parameters of a model as one vector: law coefficients, then K_j, b_j of each arm, then the parameters
 * of each effect. All are in SI units, none is a logarithm. */
PALP_API size_t palp_forward_parameter_count(const palp_model *model);
PALP_API palp_status palp_forward_get(const palp_model *model, double *parameter);
PALP_API palp_status palp_forward_set(palp_model *model,
                                      const double *parameter); /* ERR_ARGUMENT: makes no model */

/* The force of a lumped model, force_N[n]. If gradient is not NULL, gradient[n * n_parameters] receives d
 * force / d parameter by columns. The specimen starts at rest at the first sample, with run->history if
 * there is one; its surface then lies where the permanent set left it. Contact is one-sided: the plate
 * cannot pull unless the specimen sticks to it, and a specimen that it has left recovers on its own. Depth
 * is linear between the samples. Without effects, and if the plate never leaves the specimen, the result is
 * that of palp_lumped_run to the bit. An effect whose strengths are 0 changes nothing. At a kink (zero
 * strength, a sample at contact) the derivative is that of one side. ERR_ARGUMENT: no model, times that do
 * not increase. ERR_NOT_CONVERGED: an implicit effect has no solution. ERR_UNSUPPORTED: a network, or
 * PALP_SEDEF2008. */
PALP_API palp_status palp_forward_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                                        double *gradient, palp_error *error);

/* The force and its standard deviation sd_N[n], from the covariance of the model's material
 * (palp_model.covariance) and the derivatives of the force. Effects are taken as known. The 95 % interval is
 * force_N -+ 1.96 sd_N; sensor noise is not included. For a network: neither mass nor PALP_SEDEF2008. Errors
 * of palp_forward_force, or for a network of palp_forward_network. */
PALP_API palp_status palp_forward_band(const palp_model *model, const palp_forward_run *run,
                                       const double *covariance, double *force_N, double *sd_N,
                                       palp_error *error);

/* palp_forward_force for a network model, without derivatives; settings may be NULL, and the density is the
 * model's. Parameters of a material effect are those of every element, as law and arms are. Errors of
 * palp_network_step too; ERR_ARGUMENT: a load history of another mesh. */
PALP_API palp_status palp_forward_network(const palp_model *model, const palp_network_settings *settings,
                                          const palp_forward_run *run, double *force_N, palp_error *error);

/* Adds the term to force_N[n] along a path, times in s that increase, depths in m. height_m: of the specimen;
 * session_s: when in the session time_s[0] was. ERR_ARGUMENT: palp_free_term_check, a height of 0. */
PALP_API palp_status palp_free_term_add(const palp_free_term *term, size_t n, const double *time_s,
                                        const double *depth_m, double height_m, double session_s,
                                        double *force_N);

#ifdef __cplusplus
}
#endif
#endif
