/* plant_specimen.c: the specimen of the plant, pressed from one side, behind a compliant frame. */
#include "plant_specimen.h"
#include "plant_internal.h"

#include <math.h>
#include <string.h>

static const double DEEPEST = 0.95; /* strain: there the plate meets the table beneath */

/* Of a network: once left further behind than this it is not tried for contact, which is dear; so close to
 * undeformed it has recovered; with so little force it is free; its stiffness to begin with. */
static const double CLOSE_M = 5e-5, REST_M = 1e-10, FREE_N = 1e-7, GUESS_N_m = 500;

enum { ROUNDS = 60 };

/* The seed's phantom by two arms: data/sedef2008/lumped_n2.json. */
static palp_model seed_phantom(void) {
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024, .radius_m = 0.012};
    static const double coefficients_N[] = {8.18, -0.70, 47.47, -131.36, 146.89};
    palp_law_polynomial(5, coefficients_N, &model.material.law);
    model.material.n_arms = 2;
    model.material.arms[0] = (palp_arm){.stiffness_N = 2.5847711, .viscosity_Ns = 3.6146};
    model.material.arms[1] = (palp_arm){.stiffness_N = 0.6853036, .viscosity_Ns = 23.964533};
    return model;
}

static palp_status create_network(specimen *s, palp_error *error) {
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = NULL;
    double low[3], high[3];
    palp_supports_default(supports);
    settings.density_kg_m3 = s->model.density_kg_m3;
    palp_status status = palp_model_mesh(&s->model, &mesh, error);
    if (status == PALP_OK) {
        palp_mesh_bounds(mesh, low, high);
        s->height_m = high[1] - low[1];
        status = palp_network_create(mesh, &s->model.material, 2, supports, &settings, &s->network, error);
    }
    palp_mesh_free(mesh);
    return status;
}

palp_status specimen_create(const plant_settings *settings, specimen *s, palp_error *error) {
    palp_status status = PALP_OK;
    memset(s, 0, sizeof *s);
    s->kind = settings->specimen;
    s->path = settings->model ? settings->model : "the seed's phantom";
    s->scale = settings->scale;
    s->rigid_N_m = settings->rigid_N_m;
    s->compliance_m_N = settings->actuator.compliance_m_N;
    if (s->kind != PLANT_MODEL) {
        return PALP_OK;
    }
    if (settings->model) {
        status = palp_model_read(settings->model, &s->model, error);
    } else {
        s->model = seed_phantom();
    }
    if (status == PALP_OK && s->model.n_effects > 0) {
        return plant_fail(error, PALP_ERR_UNSUPPORTED, "%s: the virtual indenter does not run effects (%s)",
                          s->path, palp_effect_look_up(s->model.effects[0].id)->id);
    }
    s->height_m = s->model.height_m;
    return status == PALP_OK && s->model.kind == PALP_MODEL_NETWORK ? create_network(s, error) : status;
}

void specimen_free(specimen *s) {
    palp_network_free(s->network);
}

bool specimen_is_slow(const specimen *s) {
    return s->network != NULL;
}

/* ---- the force at a depth: a trial that keep() makes the state ---- */

static palp_status try_lumped(specimen *s, double depth_m, double dt_s, double *force_N, double *slope_N_m) {
    palp_status status =
        palp_element_advance(&s->model.material, &s->now, depth_m / s->height_m, dt_s, &s->next, slope_N_m);
    *force_N = s->next.force_N;
    *slope_N_m /= s->height_m;
    return status;
}

/* A network's stiffness is the secant of the last two trials of a step. */
static palp_status try_network(specimen *s, double depth_m, double dt_s, double *force_N, double *slope_N_m) {
    palp_step_info info;
    palp_status status = palp_network_try(s->network, depth_m, dt_s, &info);
    if (status) {
        return status;
    }
    double moved = depth_m - s->tried_m;
    if (s->tried && fabs(moved) > 1e-10) {
        s->slope_N_m = fmax((info.force_N - s->tried_N) / moved, 0);
    }
    s->tried = true;
    s->tried_m = depth_m;
    s->tried_N = info.force_N;
    *force_N = info.force_N;
    *slope_N_m = s->slope_N_m;
    return PALP_OK;
}

static palp_status try_depth(specimen *s, double depth_m, double dt_s, double *force_N, double *slope_N_m) {
    double deepest = DEEPEST * s->height_m, beyond = s->kind == PLANT_MODEL ? fmax(depth_m - deepest, 0) : 0;
    palp_status status = PALP_OK;
    *force_N = *slope_N_m = 0;
    if (s->kind == PLANT_RIGID) {
        *force_N = s->rigid_N_m * depth_m;
        *slope_N_m = s->rigid_N_m;
    } else if (s->network) {
        status = try_network(s, depth_m - beyond, dt_s, force_N, slope_N_m);
    } else if (s->kind == PLANT_MODEL) {
        status = try_lumped(s, depth_m - beyond, dt_s, force_N, slope_N_m);
    }
    *force_N = s->scale * *force_N + s->rigid_N_m * beyond;
    *slope_N_m = s->scale * *slope_N_m + (beyond > 0 ? s->rigid_N_m : 0);
    return status;
}

static void keep(specimen *s, double depth_m, double force_N) {
    s->now = s->next;
    if (s->network) {
        palp_network_commit(s->network);
    }
    s->surface_m = depth_m;
    s->force_N = force_N;
}

/* ---- without the plate ---- */

/* The strain at which the element carries nothing: Newton's method, within a bracket. */
static palp_status recover_lumped(specimen *s, double dt_s) {
    double low = fmin(s->now.strain, 0) - 0.1, high = fmax(s->now.strain, 0) + 0.1, e = s->now.strain, slope;
    palp_status status = PALP_OK;
    for (int i = 0; i < ROUNDS && high - low > 1e-16; i++) {
        status = palp_element_advance(&s->model.material, &s->now, e, dt_s, &s->next, &slope);
        if (status || fabs(s->next.force_N) <= 1e-14 * slope) {
            break;
        }
        if (s->next.force_N > 0) {
            high = e;
        } else {
            low = e;
        }
        double newton = e - s->next.force_N / slope;
        e = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return status;
}

/* The same of a network: by the secant, from where it was. */
static palp_status recover_network(specimen *s, double dt_s, double *surface_m) {
    const double farthest_m = 0.05 * s->height_m;
    double force_N, slope_N_m;
    *surface_m = s->surface_m;
    for (int i = 0; i < ROUNDS; i++) {
        palp_status status = try_network(s, *surface_m, dt_s, &force_N, &slope_N_m);
        if (status || fabs(force_N) <= FREE_N) {
            return status;
        }
        double move_m = force_N / (slope_N_m > 0 ? slope_N_m : GUESS_N_m);
        *surface_m -= fmax(-farthest_m, fmin(farthest_m, move_m));
    }
    return PALP_ERR_NOT_CONVERGED;
}

static palp_status recover(specimen *s, double dt_s) {
    palp_status status = PALP_OK;
    double surface_m = 0;
    if (s->network) {
        palp_network_rollback(s->network);
    }
    if (s->network && s->surface_m > REST_M) {
        status = recover_network(s, dt_s, &surface_m);
    } else if (s->kind == PLANT_MODEL && !s->network) {
        status = recover_lumped(s, dt_s);
        surface_m = s->next.strain * s->height_m;
    }
    if (status == PALP_OK) {
        keep(s, surface_m, 0);
    }
    return status;
}

/* ---- both ---- */

/* The depth that the force leaves of reach_m, the frame giving way by compliance times force: Newton's method
 * from the depth at which the trial at reach_m stands. */
static palp_status settle(specimen *s, double reach_m, double dt_s, double force_N, double slope_N_m) {
    double depth_m = reach_m, miss = s->compliance_m_N * force_N;
    for (int i = 0; fabs(miss) > 1e-12; i++) {
        depth_m -= miss / (1 + s->compliance_m_N * slope_N_m);
        palp_status status =
            i < ROUNDS ? try_depth(s, depth_m, dt_s, &force_N, &slope_N_m) : PALP_ERR_NOT_CONVERGED;
        if (status) {
            return status;
        }
        miss = depth_m + s->compliance_m_N * force_N - reach_m;
    }
    keep(s, depth_m, force_N);
    return PALP_OK;
}

palp_status specimen_advance(specimen *s, double reach_m, double dt_s) {
    double force_N, slope_N_m;
    bool far = s->network && s->force_N <= 0 && reach_m < s->surface_m - CLOSE_M;
    s->tried = false;
    if (s->kind == PLANT_AIR || reach_m <= 0 || far) {
        return recover(s, dt_s);
    }
    palp_status status = try_depth(s, reach_m, dt_s, &force_N, &slope_N_m);
    if (status == PALP_OK && !(force_N > 0)) {
        return recover(s, dt_s);
    }
    return status ? status : settle(s, reach_m, dt_s, force_N, slope_N_m);
}
