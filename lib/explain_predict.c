/* explain_predict.c: the one door through which explain asks a model for its forces. */
#include "explain_internal.h"

palp_status explain_predict(const palp_model *model, const palp_forward_run *run, double *force, double *gradient,
                            palp_error *error) {
    return palp_forward_force(model, run, force, gradient, error);
}
