/* palpation.h: a stiffer or softer ball hidden in tissue, from a map of presses by a sphere. May change. */
#ifndef PALPATE_PALPATION_H
#define PALPATE_PALPATION_H

#include <palpate/model.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A press by a sphere along -y. All presses have the same protocol in time. */
typedef struct palp_palpation_press {
    palp_tool tool; /* where it just touches */
    double depth_m; /* from there */
    double force_N; /* mean over the deeper half, 1 / (depth / 2) times the work from half the depth on */
} palp_palpation_press;

typedef struct palp_palpation_settings {
    double false_alarm;            /* chance that a ball is found where there is none; 0.05 */
    palp_contact_settings contact; /* the default with 2 subdivisions: a map must not show the nodes */
    size_t n_candidates;           /* places for the next press, 0 = none */
    const palp_palpation_press *candidate;     /* [n_candidates], without force */
    int (*progress)(void *user, double share); /* non-zero stops: ERR_STOPPED; may be NULL */
    void *user;
} palp_palpation_settings;

/* A value with the ends of its 95 % interval. */
typedef struct palp_palpation_value {
    double best, low, high; /* high INFINITY or low 0: not bounded by these presses */
} palp_palpation_value;

typedef struct palp_palpation {
    bool found;      /* the evidence exceeds the logarithm of (1 - false_alarm) / false_alarm */
    double evidence; /* logarithm of the ratio of marginal likelihoods, a ball over none */
    palp_palpation_value x_m, y_m, z_m; /* of its middle */
    palp_palpation_value radius_m;
    palp_palpation_value stiffness; /* over that of the tissue around it */
    double scatter;                 /* of the forces about the model, relative, without the ball */
    double scatter_found;           /* with it */
    double gain;                    /* measured force over the model's, with the ball */
    size_t next; /* candidate with the most information on the ball; n_candidates: not known, or none was
                    given */
} palp_palpation;

PALP_API palp_palpation_settings palp_palpation_settings_default(void);

/* Looks for a ball in a network model that was calibrated without one. The model stands on its "bottom" and
 * is fully relaxed; a common factor of all forces is fitted, so that neither the tissue's stiffness nor its
 * relaxation at the protocol's speed matter. Errors of the logarithm of force are normal, of unknown size,
 * and independent (doc/palpation.md). mesh: the model's, with its regions. ERR_ARGUMENT: fewer than 8
 * presses, a tool that is no sphere, a number out of range; ERR_UNSUPPORTED: the model has 8 regions, mass,
 * or a law without potential; ERR_STOPPED; the statuses of palp_network_create, palp_network_enable_tools and
 * palp_network_step for the tissue without a ball. */
PALP_API palp_status palp_palpate(const palp_model *model, const palp_mesh *mesh, size_t n,
                                  const palp_palpation_press *presses,
                                  const palp_palpation_settings *settings, palp_palpation *result,
                                  palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
