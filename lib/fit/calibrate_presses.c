/* calibrate_presses.c: the law, the arms and Poisson's ratio of a network from presses by plates and tools at
 * once, by least squares. Derivatives are differences, since the contact area changes with the material. */
#include "calibrate_internal.h"
#include "relaxation_parameters.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LEAST_RATIO = 0.25, MOST_RATIO = 0.49; /* of springs alone; where networks lock */
static const double SHIFT = 1e-4; /* of a parameter for a derivative: force has eight digits or more */

static const double MOST_STIFFNESS = 100.0; /* of a region; the other bound is its inverse */

enum { PARAMETERS_MAX = PALP_LAW_MAX + RELAXATION_PARAMETERS_MAX + PALP_REGIONS_MAX + 1 };

palp_presses_settings palp_presses_settings_default(void) {
    return (palp_presses_settings){
        .max_evaluations = 40, .stop_relative = 1e-4, .contact = palp_contact_settings_default()};
}

/* Parameters in their units: coefficients of the law, those of the arms, logarithms of the regions'
 * stiffness, Poisson's ratio. */
typedef struct presses {
    palp_model model;         /* with the latest material */
    palp_mesh_source *source; /* of the model's mesh, with the latest stiffness of regions */
    palp_material start;
    double start_ratio;
    const palp_mesh *mesh;
    const palp_presses_settings *settings;
    size_t n_targets, n_samples;
    const palp_press_target *target;
    palp_calibration *result;
    size_t n, n_arms, n_regions; /* parameters; those of the arms; regions to fit */
    size_t region[PALP_REGIONS_MAX];
    relaxation_parameter arm[RELAXATION_PARAMETERS_MAX];
    double unit[PARAMETERS_MAX];
    double *force, *moved; /* [n_samples] at a point and next to it */
    double *root;          /* [n_samples] root of a sample's weight */
    double best, best_ratio, strain_max;
} presses;

/* ---- one press ---- */

static palp_status make_network(const presses *s, bool plate, palp_network **net) {
    palp_support supports[2];
    palp_supports_default(supports);
    palp_status status =
        palp_network_from_model(&s->model, s->mesh, plate ? 2 : 1, supports, NULL, net, NULL);
    return status || plate ? status : palp_network_enable_tools(*net, 1, 0, &s->settings->contact);
}

static palp_status step_press(palp_network *net, const palp_press_target *target, size_t i, double *force) {
    double dt = i ? target->time_s[i] - target->time_s[i - 1] : 0.0;
    palp_tool tool = target->tool;
    palp_tool_force felt;
    tool.position_m[1] -= target->depth_m[i];
    palp_status status = target->plate ? PALP_OK : palp_network_set_tools(net, 1, &tool);
    if (!status)
        status = palp_network_step(net, target->plate ? target->depth_m[i] : 0.0,
                                   target->relaxed ? INFINITY : dt, NULL);
    if (!status && !target->plate)
        status = palp_network_tool_force(net, &felt);
    if (!status)
        *force = target->plate ? palp_network_force(net) : felt.force_N[1];
    return status;
}

static palp_status run_press(presses *s, const palp_press_target *target, double *force) {
    palp_network *net = NULL;
    palp_status status = make_network(s, target->plate, &net);
    for (size_t i = 0; !status && i < target->n; i++) {
        force[i] = 0.0;
        if (i > 0 || target->depth_m[i] > 0.0)
            status = step_press(net, target, i, &force[i]);
        if (!status)
            s->strain_max = fmax(s->strain_max, palp_network_strain_max(net));
    }
    palp_network_free(net);
    return status;
}

static palp_status run_presses(presses *s, double *force) {
    palp_status status = PALP_OK;
    s->strain_max = 0.0;
    for (size_t t = 0; !status && t < s->n_targets; force += s->target[t++].n)
        status = run_press(s, &s->target[t], force);
    return status;
}

/* ---- parameters ---- */

static palp_status set_parameters(presses *s, const double *u) {
    const size_t laws = s->start.law.n;
    double p[PARAMETERS_MAX];
    palp_material first = s->start;
    for (size_t k = 0; k < s->n; k++)
        p[k] = u[k] * s->unit[k];
    palp_status status = palp_law_set_coefficients(&first.law, p);
    if (!status)
        status = relaxation_material(s->n_arms, s->arm, &first, p + laws, &s->model.material);
    for (size_t r = 0; r < s->n_regions; r++)
        s->source->regions[s->region[r]].stiffness = exp(p[laws + s->n_arms + r]);
    if (s->settings->fit_poisson)
        s->model.poisson_ratio = fmin(fmax(p[s->n - 1], LEAST_RATIO), MOST_RATIO);
    return status;
}

static double longest_press(const presses *s) {
    double longest = 0.0;
    for (size_t t = 0; t < s->n_targets; t++)
        longest = fmax(longest, s->target[t].time_s[s->target[t].n - 1] - s->target[t].time_s[0]);
    return longest;
}

/* Bounds own[rows n_own] on parameters in their own numbers, those from column first on. */
static void place_bounds(const presses *s, size_t rows, const double *own, size_t n_own, size_t first,
                         double *row, double *floor) {
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < n_own; k++) {
            row[i * s->n + first + k] = own[i * n_own + k];
            if (own[i * n_own + k] != 0.0)
                floor[i] /= s->unit[first + k]; /* a bound is of one parameter */
        }
}

/* First guess u[n] with the law and arms scaled by factor, units and bounds; how many of these. Up to the
 * strain reach a polynomial's force rises, d(K a)/da > 0, and a spline is positive: elements whose force
 * falls snap, which costs many small steps. row is zero. */
static size_t set_up(presses *s, double factor, double reach, double *u, double *row, double *floor) {
    const palp_law *law = &s->start.law;
    const size_t laws = law->n;
    const bool rises = law->kind == PALP_LAW_POLYNOMIAL;
    double own[2 * RELAXATION_PARAMETERS_MAX * RELAXATION_PARAMETERS_MAX], rest, size = 1.0;
    palp_law_stiffness(law, 0.0, &rest, NULL);
    size_t rows = law_positive_rows(law, reach, s->n, row);
    for (size_t k = 0; k < laws; k++) {
        s->unit[k] = rest * factor * size;
        u[k] = law->coefficients[k] / (rest * size);
        size /= rises ? reach : 1.0;
    }
    for (size_t i = 0; i < rows; i++) {
        floor[i] = 0.02;
        for (size_t k = 0; k < laws; k++)
            row[i * s->n + k] *= s->unit[k] / s->unit[0] * (rises ? 1.0 + (double)k : 1.0);
    }
    relaxation_first_guess(s->n_arms, s->arm, &s->start, u + laws);
    for (size_t k = 0; k < s->n_arms; k++) {
        s->unit[laws + k] = s->arm[k].role == RELAXATION_STIFFNESS ? factor * u[laws + k] : 1.0;
        u[laws + k] /= s->arm[k].role == RELAXATION_STIFFNESS ? u[laws + k] : 1.0;
    }
    size_t more = relaxation_bounds(s->n_arms, s->arm, &s->start, longest_press(s), own, floor + rows);
    place_bounds(s, more, own, s->n_arms, laws, row + rows * s->n, floor + rows);
    rows += more;
    for (size_t r = 0; r < s->n_regions; r++) {
        const size_t k = laws + s->n_arms + r;
        s->unit[k] = 1.0;
        u[k] = log(s->source->regions[s->region[r]].stiffness);
        for (int side = -1; side <= 1; side += 2) {
            row[rows * s->n + k] = side;
            floor[rows++] = -log(MOST_STIFFNESS);
        }
    }
    if (s->settings->fit_poisson) {
        s->unit[s->n - 1] = 1.0;
        u[s->n - 1] = fmin(fmax(s->start_ratio, LEAST_RATIO), MOST_RATIO);
        row[rows * s->n + s->n - 1] = 1.0;
        floor[rows++] = LEAST_RATIO;
        row[rows * s->n + s->n - 1] = -1.0;
        floor[rows++] = -MOST_RATIO;
    }
    return rows;
}

/* ---- the fit ---- */

static palp_status report(presses *s, double weighted) {
    double sum = 0.0;
    for (size_t i = 0; i < s->n_samples; i++)
        sum += (s->force[i] - s->result->target_N[i]) * (s->force[i] - s->result->target_N[i]);
    palp_calibrate_iteration it = calibration_iteration(&s->model.material, sum, weighted, s->n_targets);
    palp_status status = calibration_add(s->result, &it);
    if (status)
        return status;
    if (s->result->n_iterations == 1 || weighted < s->best) {
        s->best = weighted;
        s->best_ratio = s->model.poisson_ratio;
        for (size_t r = 0; r < s->source->n_regions; r++)
            s->result->region_stiffness[r] = s->source->regions[r].stiffness;
        s->result->residual_N = it.residual_N;
        s->result->material = it.material;
        s->result->strain_max = s->strain_max;
        memcpy(s->result->force_N, s->force, s->n_samples * sizeof *s->force);
    }
    double done = fmin((double)s->result->n_iterations / (double)s->settings->max_evaluations, 1.0);
    if (s->settings->progress && s->settings->progress(s->settings->user, done, &it))
        return PALP_ERR_STOPPED;
    return PALP_OK;
}

/* No press of such a material: the first guess was one. */
static bool is_lost(palp_status status) {
    return calibration_lost(status) || status == PALP_ERR_ARGUMENT || status == PALP_ERR_SINGULAR;
}

static palp_status add_derivatives(presses *s, const double *u, double *jacobian) {
    double next[PARAMETERS_MAX];
    for (size_t k = 0; k < s->n; k++) {
        memcpy(next, u, s->n * sizeof *next);
        next[k] += k == s->n - 1 && s->settings->fit_poisson && u[k] > MOST_RATIO - SHIFT ? -SHIFT : SHIFT;
        palp_status status = set_parameters(s, next);
        if (!status)
            status = run_presses(s, s->moved);
        bool lost = is_lost(status);
        if (status && !lost)
            return status;
        for (size_t i = 0; i < s->n_samples; i++)
            jacobian[k * s->n_samples + i] =
                lost ? 0.0 : s->root[i] * (s->moved[i] - s->force[i]) / (next[k] - u[k]);
    }
    return PALP_OK;
}

/* A material without an equilibrium counts as one without force: far from any target. */
static palp_status residuals(void *user, const double *u, double *r, double *jacobian) {
    presses *s = user;
    double weighted = 0.0;
    palp_status status = set_parameters(s, u);
    bool no_material = status != PALP_OK;
    if (!status)
        status = run_presses(s, s->force);
    bool lost = is_lost(status);
    if (status && !lost)
        return status;
    for (size_t i = 0; i < s->n_samples; i++) {
        s->force[i] = lost ? 0.0 : s->force[i];
        r[i] = s->root[i] * (s->force[i] - s->result->target_N[i]);
        weighted += r[i] * r[i];
    }
    status = no_material ? PALP_OK : report(s, weighted);
    if (status || !jacobian)
        return status;
    if (lost)
        memset(jacobian, 0, s->n * s->n_samples * sizeof *jacobian);
    return lost ? PALP_OK : add_derivatives(s, u, jacobian);
}

/* Forces are proportional to law and arms together: the factor of the first guess that meets the targets
 * best costs one evaluation. */
static palp_status find_factor(presses *s, double *factor) {
    double product = 0.0, square = 0.0;
    s->model.material = s->start;
    palp_status status = run_presses(s, s->force);
    for (size_t i = 0; !status && i < s->n_samples; i++) {
        product += s->root[i] * s->root[i] * s->force[i] * s->result->target_N[i];
        square += s->root[i] * s->root[i] * s->force[i] * s->force[i];
    }
    *factor = product / square;
    return status || *factor > 0.0 ? status : PALP_ERR_ARGUMENT;
}

static palp_status fit(presses *s) {
    double u[PARAMETERS_MAX], floor[LAW_ROWS + 2 * PARAMETERS_MAX], norm, factor;
    palp_status status = find_factor(s, &factor);
    double *row = status ? NULL : calloc((LAW_ROWS + 2 * s->n) * s->n, sizeof *row);
    if (status || !row)
        return status ? status : PALP_ERR_NO_MEMORY;
    least_squares problem = {.n_parameters = s->n,
                             .n_residuals = s->n_samples,
                             .max_evaluations = s->settings->max_evaluations,
                             .stop_relative = s->settings->stop_relative,
                             .evaluate = residuals,
                             .user = s,
                             .constraint = row,
                             .floor = floor};
    problem.n_constraints = set_up(s, factor, 1.2 * s->strain_max, u, row, floor);
    status = least_squares_solve(&problem, u, &norm, &s->result->converged);
    free(row);
    return status;
}

/* ---- what is given ---- */

static palp_status add_target(presses *s, const palp_press_target *target, size_t first) {
    double peak = 0.0;
    for (size_t i = 0; i < target->n; i++) {
        if (!isfinite(target->force_N[i]) || !isfinite(target->time_s[i]) ||
            !(target->depth_m[i] >= 0.0 && isfinite(target->depth_m[i])) ||
            (i > 0 && !(target->time_s[i] > target->time_s[i - 1])))
            return PALP_ERR_ARGUMENT;
        peak = fmax(peak, fabs(target->force_N[i]));
    }
    if (target->n == 0 || !(peak > 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < target->n; i++) {
        s->result->depth_m[first + i] = target->depth_m[i];
        s->result->target_N[first + i] = target->force_N[i];
        s->root[first + i] = sqrt(1.0 / (double)target->n) / peak;
    }
    return PALP_OK;
}

static palp_status prepare(presses *s) {
    const palp_relaxation_settings arms = {.one_beta = true, .fit_beta = s->settings->fit_beta};
    const palp_law *law = &s->start.law;
    if (law->kind != PALP_LAW_POLYNOMIAL && law->kind != PALP_LAW_SPLINE)
        return PALP_ERR_UNSUPPORTED;
    s->n_arms = s->start.n_arms ? relaxation_list(&s->start, &arms, s->arm) : 0;
    for (size_t r = 0; r < PALP_REGIONS_MAX; r++) {
        if (!s->settings->fit_region[r])
            continue;
        if (r >= s->source->n_regions || !(s->source->regions[r].stiffness > 0.0))
            return PALP_ERR_ARGUMENT;
        s->region[s->n_regions++] = r;
    }
    s->n = law->n + s->n_arms + s->n_regions + s->settings->fit_poisson;
    for (size_t t = 0; t < s->n_targets; t++)
        s->n_samples += s->target[t].n;
    if (s->n_samples < s->n || s->settings->max_evaluations < 1)
        return PALP_ERR_ARGUMENT;
    palp_calibration *c = s->result;
    s->force = malloc(3 * s->n_samples * sizeof(double));
    c->n_samples = s->n_samples;
    c->depth_m = malloc(s->n_samples * sizeof(double));
    c->target_N = malloc(s->n_samples * sizeof(double));
    c->force_N = calloc(s->n_samples, sizeof(double));
    if (!s->force || !c->depth_m || !c->target_N || !c->force_N)
        return PALP_ERR_NO_MEMORY;
    s->moved = s->force + s->n_samples;
    s->root = s->moved + s->n_samples;
    palp_status status = palp_material_check(&s->start, NULL);
    for (size_t t = 0, first = 0; !status && t < s->n_targets; first += s->target[t++].n)
        status = add_target(s, &s->target[t], first);
    return status;
}

palp_status palp_calibrate_presses(palp_model *model, const palp_mesh *mesh, size_t n_targets,
                                   const palp_press_target *targets, const palp_presses_settings *settings,
                                   palp_calibration *result) {
    if (!model || !mesh || !targets || !settings || !result)
        return PALP_ERR_ARGUMENT;
    presses s = {.model = *model,
                 .start = model->material,
                 .start_ratio = model->poisson_ratio,
                 .mesh = mesh,
                 .settings = settings,
                 .n_targets = n_targets,
                 .target = targets,
                 .result = result};
    memset(result, 0, sizeof *result);
    s.source = malloc(sizeof *s.source);
    if (!s.source)
        return PALP_ERR_NO_MEMORY;
    memset(s.source, 0, sizeof *s.source);
    if (model->mesh)
        *s.source = *model->mesh;
    s.model.mesh = s.source;
    s.model.n_effects = 0;
    if (settings->fit_poisson) {
        s.model.volume_modulus_Pa = 0.0;
        s.model.poisson_ratio = fmin(fmax(s.start_ratio, LEAST_RATIO), MOST_RATIO);
    }
    palp_status status = model->density_kg_m3 > 0.0 ? PALP_ERR_UNSUPPORTED : prepare(&s);
    if (!status)
        status = fit(&s);
    free(s.force);
    free(s.source);
    if (status) {
        palp_calibration_free(result);
        return status;
    }
    model->material = result->material;
    model->volume_modulus_Pa = s.model.volume_modulus_Pa;
    model->poisson_ratio = s.best_ratio;
    return PALP_OK;
}
