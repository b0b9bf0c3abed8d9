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
 * law of the given family that is nearest. Of the explanation it leaves the specimens at 0.
 * candidate.score and evidence are log odds and gains of log evidence, nats; candidate.share is how much of
 * the prior variance of its strength the runs take away, and one that keeps half of it is not identifiable.
 * evidence_se is paired over what is left out in turn: each run, or each eighth of a single one. An effect
 * that does not help to predict that is not accepted. Settings that it does not use: repeatability,
 * contact_scatter_m, seed. */
PALP_API palp_status palp_infer(const palp_model *model, size_t n, const palp_explain_input *inputs,
                                const palp_explain_settings *settings, palp_explanation *explanation,
                                palp_error *error);

/* The lumped solid of runs by the same likelihood, without effects: a spline law of 31 knots, and arms as
 * long as one more gains what --false-alarm wants, at least least_arms and at most most_arms (PALP_ARMS_MAX).
 * The arms are driven by the strain or by the elastic force (quasi-linear), whichever is more probable.
 * specimen: height, radius and known effects; its material is not read. fit: arrays over runs are in the
 * order of inputs; contact_m is from recorded depth 0; the caller frees it. settings: false_alarm, loop,
 * stop. ERR_ARGUMENT: no runs, or arms out of range; errors of palp_infer. */
PALP_API palp_status palp_infer_material(const palp_model *specimen, size_t n,
                                         const palp_explain_input *inputs,
                                         const palp_explain_settings *settings, size_t least_arms,
                                         size_t most_arms, palp_lumped_fit *fit, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
