/* palpation.c: a ball or a layer of another stiffness from a map of presses: what is given, the answer, and
 * the next press.
 */
#include "palpation_internal.h"

#include "base/dense.h"
#include "base/file.h"
#include "mesh/mesh_internal.h"
#include "network/network_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEWEST = 8 };

/* ---- the next press ------------------------------------------------------------------------------- */

/* Slopes of press i of all by parameters, slope[parameters all]: the last parameter is the gain. */
static void slopes_of_press(const palpation_search *s, const double *slope, size_t all, size_t i,
                            double g[PALPATION_ALL]) {
    for (size_t a = 0; a <= s->kind->n; a++)
        g[a] = slope[a * all + i];
    g[s->kind->n + 1] = 1.0;
}

/* Information of the search's presses on place, size, stiffness and gain: its factor. */
static bool factor_information(const palpation_search *s, const double *slope, size_t all, double *normal) {
    const size_t parameters = s->kind->n + 2;
    for (size_t a = 0; a < parameters * parameters; a++)
        normal[a] = a % (parameters + 1) == 0 ? 1e-9 : 0.0;
    if (s->prior[PALPATION_GAIN] > 0.0)
        normal[parameters * parameters - 1] += s->variance / s->prior[PALPATION_GAIN];
    for (size_t i = 0; i < s->n; i++) {
        double g[PALPATION_ALL];
        slopes_of_press(s, slope, all, i, g);
        for (size_t a = 0; a < parameters * parameters; a++)
            normal[a] += g[a / parameters] * g[a % parameters];
    }
    return dense_cholesky(parameters, normal);
}

/* The press, of those beyond the search's, whose force is least certain given the latter: it adds most
 * information. */
static size_t find_least_certain(const palpation_search *s, const double *slope, size_t all,
                                 const double *normal) {
    size_t next = all;
    double most = -1.0;
    for (size_t i = s->n; i < all; i++) {
        double g[PALPATION_ALL];
        slopes_of_press(s, slope, all, i, g);
        dense_forward(s->kind->n + 2, normal, 1, g);
        const double told = dense_dot(s->kind->n + 2, g, g);
        next = told > most ? i : next;
        most = fmax(most, told);
    }
    return next;
}

/* Presses all candidates too, with the region found. */
static palp_status choose_next_press(const palpation_search *s, const palpation_candidate *best,
                                     palp_palpation *result) {
    const size_t more = s->settings->n_candidates, all = s->n + more, slopes = s->kind->n + 1;
    double normal[PALPATION_ALL * PALPATION_ALL];
    result->next = more;
    if (more == 0)
        return PALP_OK;
    palp_palpation_press *press = malloc(all * sizeof *press);
    double *x = malloc(PALPATION_LEVELS * 3 * s->n_nodes * all * sizeof *x),
           *slope = malloc((slopes + 3) * all * sizeof *slope);
    palp_status status = press && x && slope ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        palpation_search own = *s;
        memcpy(press, s->press, s->n * sizeof *press);
        memcpy(press + s->n, s->settings->candidate, more * sizeof *press);
        own.n = all;
        own.press = press;
        own.x = x;
        own.solved = false;
        own.work = slope + slopes * all;
        own.elastic = own.work + all;
        own.moved = own.elastic + all;
        own.log_stiffness = best->log_stiffness;
        status = palpation_place(&own, best->p);
        if (!status)
            status = palpation_solve(&own, NULL);
        if (!status)
            status = palpation_slopes(&own, best->p, slopes, slope);
    }
    if (!status && factor_information(s, slope, all, normal))
        result->next = find_least_certain(s, slope, all, normal) - s->n;
    free(press);
    free(x);
    free(slope);
    return palpation_lost(status) ? PALP_OK : status;
}

/* ---- what is given -------------------------------------------------------------------------------- */

palp_palpation_settings palp_palpation_settings_default(void) {
    palp_palpation_settings s = {.false_alarm = 0.05, .contact = palp_contact_settings_default()};
    s.contact.subdivisions = 2;
    return s;
}

static bool is_press_valid(const palp_palpation_press *p, bool with_force) {
    const double *at = p->tool.position_m;
    return p->tool.shape == PALP_TOOL_SPHERE && p->tool.radius_m > 0.0 && isfinite(p->tool.radius_m) &&
           isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]) && p->depth_m > 0.0 &&
           isfinite(p->depth_m) && (!with_force || (p->force_N > 0.0 && isfinite(p->force_N)));
}

static palp_status check_given(const palp_model *model, size_t n, const palp_palpation_press *presses,
                               const palp_palpation_settings *settings, palp_error *error) {
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the model is no network");
    if (n < FEWEST)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a map needs at least %d presses", FEWEST);
    if (!(settings->false_alarm > 0.0 && settings->false_alarm < 1.0))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "the chance of a false alarm must be between 0 and 1");
    for (size_t i = 0; i < n; i++)
        if (!is_press_valid(&presses[i], true))
            return palp_error_set(error, PALP_ERR_ARGUMENT,
                                  "press %zu: needs a sphere, a depth and a force above 0", i + 1);
    for (size_t i = 0; i < settings->n_candidates; i++)
        if (!is_press_valid(&settings->candidate[i], false))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "candidate %zu: needs a sphere and a depth",
                                  i + 1);
    if (model->density_kg_m3 > 0.0)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "palpation takes networks without mass");
    if (model->mesh && model->mesh->n_regions == PALP_REGIONS_MAX)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "the model has %d regions already",
                              PALP_REGIONS_MAX);
    return PALP_OK;
}

static palp_status prepare_search(palpation_search *s, const palp_model *model, const palp_mesh *mesh) {
    s->source = malloc(sizeof *s->source);
    palp_status status = s->source ? mesh_copy(mesh, &s->mesh) : PALP_ERR_NO_MEMORY;
    if (status)
        return status;
    memset(s->source, 0, sizeof *s->source);
    if (model->mesh)
        *s->source = *model->mesh;
    s->model.mesh = s->source;
    s->model.n_effects = 0;
    palp_region *region = &s->source->regions[s->source->n_regions++];
    *region = (palp_region){.shape = PALP_REGION_OF_MESH, .stiffness = 1.0};
    memcpy(region->name, palpation_region, sizeof palpation_region);
    palp_mesh_bounds(mesh, s->low, s->high);
    s->shortest = fmin(s->high[0] - s->low[0], fmin(s->high[1] - s->low[1], s->high[2] - s->low[2]));
    status = palpation_use_mesh(s);
    return status ? status : palpation_use_errors(s);
}

/* ---- the answer ----------------------------------------------------------------------------------- */

/* Prior odds of a ball, a layer and neither are equal. */
static palp_status search_for_all(palpation_search *s, double *residual, palp_palpation *r,
                                  palp_error *error) {
    palp_palpation_value *const ball[] = {&r->x_m, &r->y_m, &r->z_m, &r->radius_m, &r->stiffness},
                                *const layer[] = {&r->thickness_m, &r->layer_stiffness};
    palpation_answer a_ball, a_layer;
    s->kind = &palpation_ball;
    s->planned = 5.0 + 2.0 * (12.0 * PALPATION_STARTS + 18.0 * PALPATION_STIFFNESSES);
    palp_status status = palpation_measure_lattice(s, error);
    if (!status)
        status = palpation_find(s, &palpation_layer, residual, layer, &a_layer);
    if (!status)
        status = palpation_find(s, &palpation_ball, residual, ball, &a_ball);
    if (status)
        return status;
    const double alone = dense_dot(s->n, residual, residual);
    const bool is_layer = a_layer.evidence > a_ball.evidence;
    const double more = is_layer ? a_layer.evidence : a_ball.evidence,
                 less = is_layer ? a_ball.evidence : a_layer.evidence;
    r->found =
        more + log1p(exp(less - more)) > log((1.0 - s->settings->false_alarm) / s->settings->false_alarm);
    r->kind = !r->found ? PALP_PALPATION_NONE : is_layer ? PALP_PALPATION_LAYER : PALP_PALPATION_BALL;
    r->evidence = a_ball.evidence;
    r->evidence_layer = a_layer.evidence;
    r->scatter = sqrt(alone / palpation_freedom(s, 0));
    r->scatter_found = a_ball.scatter;
    r->scatter_layer = a_layer.scatter;
    r->gain = a_ball.gain;
    r->gain_layer = a_layer.gain;
    s->kind = is_layer ? &palpation_layer : &palpation_ball;
    return choose_next_press(s, is_layer ? &a_layer.best : &a_ball.best, r);
}

palp_status palp_palpate(const palp_model *model, const palp_mesh *mesh, size_t n,
                         const palp_palpation_press *presses, const palp_palpation_settings *settings,
                         palp_palpation *result, palp_error *error) {
    if (!model || !mesh || !presses || !settings || !result ||
        (settings->n_candidates > 0 && !settings->candidate))
        return palp_error_null(error);
    palp_status status = check_given(model, n, presses, settings, error);
    if (status)
        return status;
    palpation_search s = {.model = *model, .settings = settings, .n = n, .press = presses};
    double *residual = malloc(n * sizeof *residual);
    memset(result, 0, sizeof *result);
    status = residual ? prepare_search(&s, model, mesh) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = search_for_all(&s, residual, result, error);
    free(residual);
    palpation_free(&s);
    if (status && error && error->status != status)
        palp_error_set(error, status, "%s", palp_status_text(status));
    return status;
}
