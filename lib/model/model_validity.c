/* model_validity.c: what the force of a sphere is off by in a network: "validity" of a model file, and its
 * look-up. */
#include "model_internal.h"

#include <math.h>

palp_status palp_model_validity_read(const palp_json *root, palp_model *model) {
    static const char *const keys[] = {"radius_mm", "depth_mm", "error"};
    palp_json list, item, value;
    if (!palp_json_member(root, "validity", &list))
        return PALP_OK;
    palp_status status = palp_json_list(&list, PALP_VALIDITY_MAX, &model->n_validity);
    for (size_t i = 0; !status && i < model->n_validity; i++) {
        palp_validity *press = &model->validity[i];
        double *const to[] = {&press->radius_m, &press->depth_m, &press->error};
        status = palp_json_item(&list, i, &item);
        if (!status)
            status = palp_json_keys(&item, 3, keys);
        for (size_t k = 0; !status && k < 3; k++) {
            status = palp_json_require(&item, keys[k], &value);
            if (!status)
                status = k < 2 ? palp_json_positive(&value, to[k]) : palp_json_not_negative(&value, to[k]);
            if (k < 2)
                *to[k] /= 1000;
        }
    }
    return status;
}

bool palp_model_validity_valid(const palp_model *model) {
    if (model->n_validity > PALP_VALIDITY_MAX)
        return false;
    for (size_t i = 0; i < model->n_validity; i++) {
        const palp_validity *press = &model->validity[i];
        if (!(press->radius_m > 0) || !isfinite(press->radius_m) || !(press->depth_m > 0) ||
            !isfinite(press->depth_m) || !(press->error >= 0) || !isfinite(press->error))
            return false;
    }
    return true;
}

/* The values of the presses that are next to one: the largest below or at it, the smallest above or at it;
 * where there is none on one side, that of the other. */
static void widen(double value, double at, double *below, double *above) {
    if (value <= at * (1 + 1e-9))
        *below = fmax(*below, value);
    if (value >= at * (1 - 1e-9))
        *above = fmin(*above, value);
}

palp_status palp_model_tool_error(const palp_model *model, double radius_m, double depth_m, double *error) {
    double radius[2] = {-INFINITY, INFINITY}, depth[2] = {-INFINITY, INFINITY}, most = 0;
    if (!model || !error || !(radius_m > 0) || !(depth_m >= 0))
        return PALP_ERR_ARGUMENT;
    if (model->n_validity == 0)
        return PALP_ERR_UNSUPPORTED;
    for (size_t i = 0; i < model->n_validity; i++) {
        widen(model->validity[i].radius_m, radius_m, &radius[0], &radius[1]);
        widen(model->validity[i].depth_m, depth_m, &depth[0], &depth[1]);
    }
    if (isinf(radius[0]) || isinf(depth[1]))
        return PALP_ERR_LIMIT;
    radius[1] = fmax(radius[0], isinf(radius[1]) ? radius[0] : radius[1]);
    depth[0] = isinf(depth[0]) ? depth[1] : depth[0];
    for (size_t i = 0; i < model->n_validity; i++) {
        const palp_validity *press = &model->validity[i];
        if (press->radius_m >= radius[0] && press->radius_m <= radius[1] && press->depth_m >= depth[0] &&
            press->depth_m <= depth[1])
            most = fmax(most, press->error);
    }
    *error = most;
    return PALP_OK;
}
