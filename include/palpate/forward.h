/* forward.h: what an instrument would record: the depth that its encoder reads to the force that its sensor
 * reads, through the contact, the lumped specimen and every effect of the model, with derivatives. May change. */
#ifndef PALPATE_FORWARD_H
#define PALPATE_FORWARD_H

#include <palpate/model.h>
#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What earlier presses left in a specimen, of which damage and permanent set depend. Zero-initialised = a
 * fresh one. Of a network the elements keep their own largest strains: palp_load_history_free. With peak
 * alone it is one that was slowly pressed to there. */
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

/* What is known of one recording beside its samples. Zero-initialised but for the first three = no session.
 */
typedef struct palp_forward_run {
    size_t n;
    const double *time_s, *depth_m; /* as the encoder reads them, 0 = nominal contact; caller's */
    double session_s;               /* when in the session it began (session_ageing) */
    double hum_phase;               /* of mains_hum at time 0, rad */
    size_t parts;                   /* steps of the specimen from sample to sample; 0 = 1 */
    size_t n_columns;               /* what it does not have is taken to stay as it was at the first sample */
    const palp_forward_column *column; /* [n_columns] */
    palp_load_history *history; /* NULL, or how the run finds the specimen, and then how it leaves it */
    double contact_m;           /* the surface of this run lies so much deeper than the model's */
} palp_forward_run;

/* Parameters of a model in one vector: law coefficients, then K_j, b_j of each arm, then each effect's own
 * parameters, all SI and plain (no logarithms). */
PALP_API size_t palp_forward_parameter_count(const palp_model *model);
PALP_API palp_status palp_forward_get(const palp_model *model, double *parameter);
PALP_API palp_status palp_forward_set(palp_model *model,
                                      const double *parameter); /* ERR_ARGUMENT: makes no model */

/* force_N[n] of a lumped model, and by columns d force / d parameter where gradient[n * n_parameters] is not
 * NULL. The specimen starts at rest at the first sample, as run->history says (its surface then lies where
 * the permanent set left it). The contact is one-sided: a plate that the specimen does not stick to cannot
 * pull, and a specimen left behind recovers on its own. Linear in depth between the samples. With no effects
 * and depths that never leave the specimen: palp_lumped_run to the bit. An effect whose strengths are 0
 * changes nothing. Derivatives are exact; at a kink (zero strength, a sample at contact) one of the two
 * sides. ERR_ARGUMENT: no model, times that do not increase. ERR_NOT_CONVERGED: an implicit effect has no
 * solution. ERR_UNSUPPORTED: a network, or PALP_SEDEF2008. */
PALP_API palp_status palp_forward_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                                        double *gradient, palp_error *error);

/* Beside the force how well it is known: sd_N[n], from the covariance of the model's material
 * (palp_model.covariance) by the derivatives of the force; effects count as known. 95 % of the forces that
 * the data allow are within 1.96 sd of force_N; the noise of a sensor is not in it. A network is solved with
 * derivatives by all of its numbers: no mass, no PALP_SEDEF2008. Errors of palp_forward_force, of a network
 * those of palp_forward_network. */
PALP_API palp_status palp_forward_band(const palp_model *model, const palp_forward_run *run,
                                       const double *covariance, double *force_N, double *sd_N,
                                       palp_error *error);

/* palp_forward_force for a network model, without derivatives; settings may be NULL (density is the model's).
 * A material effect's numbers are those of every element, as the model's law and arms are. Errors of
 * palp_network_step too; ERR_ARGUMENT: the load history is that of another mesh. */
PALP_API palp_status palp_forward_network(const palp_model *model, const palp_network_settings *settings,
                                          const palp_forward_run *run, double *force_N, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
