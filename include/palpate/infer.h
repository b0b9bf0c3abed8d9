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

/* As palp_explain, for a lumped model. Its law becomes a spline of 16 knots, whose smoothness the runs tell.
 * Of the explanation it leaves the steps, the next run and the specimens at 0;
 * candidate.score and evidence are log odds and gains of log evidence, nats. Settings that it uses:
 * max_effects, false_alarm, candidate, held_out, loop, stop, good_enough. It does not report
 * progress. ERR_UNSUPPORTED: a network, or contacts that are known or common. */
PALP_API palp_status palp_infer(const palp_model *model, size_t n, const palp_explain_input *inputs,
                                const palp_explain_settings *settings, palp_explanation *explanation,
                                palp_error *error);

/* The lumped solid of runs by the same likelihood, without effects: a spline law of 16 knots, and arms as
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
