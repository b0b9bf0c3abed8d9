/* infer.h: palp_explain by one likelihood (doc/likelihood.md): what the model does not follow is part of it,
 * and effects are believed by the log odds of their evidence. It is to replace palp_explain's own search. May
 * change. */
#ifndef PALPATE_INFER_H
#define PALPATE_INFER_H

#include <palpate/characterize.h>
#include <palpate/explain.h>

#ifdef __cplusplus
extern "C" {
#endif

/* As palp_explain. The model's law becomes a spline of 31 knots, whose smoothness the runs tell; base has the
 * law of the given family that is nearest. candidate.score and evidence are log odds and gains of log
 * evidence, nats. candidate.share is how much of the prior variance of its strength the runs take away,
 * beside what was found; a candidate of which they take less than half is not identifiable. evidence_se is
 * paired over what is left out in turn: each run, or each eighth of a single one. An effect that does not
 * help to predict that is not accepted. Settings that it does not use: repeatability, contact_scatter_m,
 * seed. */
PALP_API palp_status palp_infer(const palp_model *model, size_t n, const palp_explain_input *inputs,
                                const palp_explain_settings *settings, palp_explanation *explanation,
                                palp_error *error);

/* What palp_infer_material may choose from. Zero-initialised: a spline of 31 knots, no arms. */
typedef struct palp_infer_choice {
    size_t least_arms, most_arms; /* the most is at most PALP_ARMS_MAX */
    size_t n_laws;                /* laws that compete with the spline of 31 knots */
    const palp_law *law; /* [n_laws] the caller's: kind, size, knots and area; coefficients: first guess */
    bool no_spline;      /* the spline does not compete: one of the laws is taken */
} palp_infer_choice;

/* The lumped solid of runs by the same likelihood, without effects: arms as long as one more gains what
 * settings->false_alarm wants, driven by the strain or by the elastic force (quasi-linear), and the law of
 * the largest evidence. specimen: height and radius, to which all runs are scaled by the sizes in their
 * files, and known effects; its material is not read. fit, the caller's to free: of mean, arrays over runs
 * are in the order of inputs, and contact_m is from recorded depth 0. Specimens are numbered as they come
 * first among the inputs (specimen.name); with one, fit has the mean alone. n_spread is 1 if they differ: all
 * stiffnesses of one by a factor, all times, and the law alone. settings: false_alarm, contact, loop, stop.
 * ERR_ARGUMENT: no runs, arms out of range, no_spline without a law; errors of palp_infer. */
PALP_API palp_status palp_infer_material(const palp_model *specimen, size_t n,
                                         const palp_explain_input *inputs,
                                         const palp_explain_settings *settings,
                                         const palp_infer_choice *choice, palp_specimens_fit *fit,
                                         palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
