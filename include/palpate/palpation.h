/* palpation.h: a stiffer or softer ball or layer in tissue, from a map of presses by spheres. May change. */
#ifndef PALPATE_PALPATION_H
#define PALPATE_PALPATION_H

#include <palpate/model.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A press by a sphere along -y. Radii, depths and places may differ; all presses have the same protocol in
 * time, so that relaxation changes all forces by one factor. */
typedef struct palp_palpation_press {
    palp_tool tool; /* where it just touches */
    double depth_m; /* from there */
    double force_N; /* mean over the deeper half, 1 / (depth / 2) times the work from half the depth on */
} palp_palpation_press;

typedef struct palp_palpation_settings {
    double false_alarm; /* posterior probability of neither, below which something is found; 0.05 */
    bool gain_known; /* the network has the tissue's forces as it stands, but for a factor as large as a finer
                        lattice's; false: a factor common to all forces is fitted */
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

typedef enum palp_palpation_kind {
    PALP_PALPATION_NONE,
    PALP_PALPATION_BALL,
    PALP_PALPATION_LAYER
} palp_palpation_kind;

/* Evidences are logarithms of ratios of marginal likelihoods, over that of neither. With equal prior odds the
 * posterior probabilities of neither, a ball and a layer are as 1, exp(evidence) and exp(evidence_layer). */
typedef struct palp_palpation {
    bool found;               /* the posterior probability of neither is below false_alarm */
    palp_palpation_kind kind; /* the more probable of both if found, else NONE */
    double evidence, evidence_layer;
    palp_palpation_value x_m, y_m, z_m; /* of the ball's middle */
    palp_palpation_value radius_m;
    palp_palpation_value stiffness;       /* over that of the tissue around it */
    palp_palpation_value thickness_m;     /* of the layer, from the highest point of the mesh down */
    palp_palpation_value layer_stiffness; /* over that of the tissue below */
    double scatter;                       /* of the forces about the model, relative, with neither */
    double scatter_found, scatter_layer;  /* with the ball; with the layer */
    double gain, gain_layer;              /* measured force over the model's, with the ball; with the layer */
    size_t next; /* candidate with the most information on the more probable of both; n_candidates: not known,
                    or none was given */
} palp_palpation;

PALP_API palp_palpation_settings palp_palpation_settings_default(void);

/* Looks for a ball, and for a layer at the surface, in a network model that was calibrated without. The model
 * stands on its "bottom" and is fully relaxed. Unless the gain is known, a common factor of all forces is
 * fitted. Neither the tissue's stiffness nor its relaxation at the protocol's speed matter then, and a layer
 * is only found by presses of several depths or radii. Errors of the logarithm of force are normal, of
 * unknown size, and independent (doc/palpation.md). mesh: the model's, with its regions; a layer needs a flat
 * top. ERR_ARGUMENT: fewer than 8 presses, a tool that is no sphere, a number out of range; ERR_UNSUPPORTED:
 * the model has 8 regions, mass, or a law without potential; ERR_STOPPED; the statuses of
 * palp_network_create, palp_network_enable_tools and palp_network_step for the tissue alone. */
PALP_API palp_status palp_palpate(const palp_model *model, const palp_mesh *mesh, size_t n,
                                  const palp_palpation_press *presses,
                                  const palp_palpation_settings *settings, palp_palpation *result,
                                  palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
