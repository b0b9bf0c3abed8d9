/* calibrate_check.c: palpate calibrate --check: spheres pressed into a network, their force over that of a
 * solid. */
#include "calibrate.h"
#include "shared/digits.h"
#include "shared/json_out.h"
#include "shared/opening.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "calibrate";
static const double PI = 3.14159265358979323846, SMALL = 1e-5; /* of the height, a press at small strain */

enum { RADII = 4, DEPTHS = 3, PLACES = 2 };

typedef struct check_state {
    palp_model model;
    palp_mesh_source source;
    palp_mesh *mesh;
    double *covariance, *between; /* of the model, to write them again */
    palp_material material; /* its elements relaxed, with their stiffness at rest; later a solid's law */
    palp_network_settings settings;
    palp_contact_settings touch;
    double low[3], high[3], height_m, section_m2;
    double poisson, shear_Pa; /* of the solid that it stands for */
    double place[PLACES][3];  /* on a node of the top; in the middle of a cell */
    size_t n_radii, n_depths;
    double radius_m[RADII], depth_m[DEPTHS];
    double solid_N[RADII][DEPTHS], over[RADII][DEPTHS][PLACES]; /* solid 0: not known; forces over it */
} check_state;

/* ---- the model and its shape ---- */

/* The reference is that of a box between its floor and a flat top. */
static bool is_box(const check_state *c) {
    const double *x = palp_mesh_positions(c->mesh);
    const int32_t *t = palp_mesh_tetrahedra(c->mesh);
    double volume = 0;
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(c->mesh); i++) {
        double e[3][3];
        for (size_t j = 0; j < 3; j++)
            for (size_t k = 0; k < 3; k++)
                e[j][k] = x[3 * t[4 * i + j + 1] + (int32_t)k] - x[3 * t[4 * i] + (int32_t)k];
        volume += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                   e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                   e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
                  6;
    }
    return fabs(volume - c->section_m2 * c->height_m) <= 1e-6 * volume;
}

static double squared(const double *a, const double *b) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

/* The node of the top nearest to its middle, and the middle of the longest edge of a triangle there. In a
 * lattice that is the middle of a cell. */
static palp_status choose_places(check_state *c) {
    const double *x = palp_mesh_positions(c->mesh),
                 middle[3] = {0.5 * (c->low[0] + c->high[0]), c->high[1], 0.5 * (c->low[2] + c->high[2])};
    const int32_t *t = palp_mesh_triangles(c->mesh), *nodes;
    size_t n, best = 0;
    double longest = 0;
    palp_status status = palp_mesh_set(c->mesh, "top", &n, &nodes);
    if (status)
        return status;
    for (size_t i = 1; i < n; i++)
        if (squared(x + 3 * nodes[i], middle) < squared(x + 3 * nodes[best], middle))
            best = i;
    const double *node = x + 3 * nodes[best];
    memcpy(c->place[0], node, sizeof c->place[0]);
    memcpy(c->place[1], node, sizeof c->place[1]);
    for (size_t i = 0; i < 3 * palp_mesh_triangle_count(c->mesh); i++) {
        const double *a = x + 3 * t[i], *b = x + 3 * t[i - i % 3 + (i + 1) % 3];
        const double *other = a == node ? b : b == node ? a : NULL;
        if (!other || fabs(other[1] - c->high[1]) > 1e-9 * c->height_m || squared(other, node) <= longest)
            continue;
        longest = squared(other, node);
        for (size_t k = 0; k < 3; k++)
            c->place[1][k] = 0.5 * (node[k] + other[k]);
    }
    return PALP_OK;
}

static int read_network(const char *file, check_state *c) {
    palp_error error = {PALP_OK, ""};
    double rest = 0;
    size_t n_specimens = 0;
    int code =
        open_model_of(NAME, file, PALP_MODEL_NETWORK, "--check wants a network model", &c->model, &c->source);
    if (code)
        return code;
    palp_status status = palp_model_read_covariance(file, &c->covariance, &error);
    if (!status)
        status = palp_model_read_between(file, &c->between, &n_specimens, &error);
    if (!status)
        status = palp_model_mesh(&c->model, &c->mesh, &error);
    if (status)
        return cli_status_of(NAME, file, status, &error);
    c->model.covariance = c->covariance;
    c->model.between = c->between;
    c->model.n_specimens = n_specimens;
    c->settings = palp_network_settings_of_model(&c->model);
    c->settings.density_kg_m3 = 0;
    c->touch = palp_contact_settings_default();
    palp_mesh_bounds(c->mesh, c->low, c->high);
    c->height_m = c->high[1] - c->low[1];
    c->section_m2 = (c->high[0] - c->low[0]) * (c->high[2] - c->low[2]);
    if (c->source.n_regions > 0)
        return cli_failure(NAME,
                           "%s: has regions, but the force is known of a solid of one material alone: check "
                           "the network without them",
                           file);
    if (!is_box(c))
        return cli_failure(NAME, "%s: is no box, for which alone the force of a solid is known", file);
    palp_law_stiffness(&c->model.material.law, 0.0, &rest, NULL);
    status = palp_law_polynomial(1, &rest, &c->material.law);
    if (!status)
        status = choose_places(c);
    return status ? cli_status_of(NAME, file, status, NULL) : CLI_OK;
}

/* ---- the solid that it stands for ---- */

/* The network on its supports after a small press by its top. */
static palp_status press_top(const check_state *c, size_t n, const palp_support *supports,
                             palp_network **net) {
    palp_status status = palp_network_create(c->mesh, &c->material, n, supports, &c->settings, net, NULL);
    return status ? status : palp_network_step(*net, SMALL * c->height_m, INFINITY, NULL);
}

/* Poisson's ratio from how it widens between plates on which it slides. */
static palp_status find_poisson(check_state *c) {
    static const palp_support SLIDE[] = {{"bottom", {PALP_FREE, PALP_FIXED, PALP_FREE}, {0}},
                                         {"top", {PALP_FREE, PALP_DRIVEN, PALP_FREE}, {0, -1, 0}},
                                         {"palpate low x", {PALP_FIXED, PALP_FREE, PALP_FREE}, {0}},
                                         {"palpate low z", {PALP_FREE, PALP_FREE, PALP_FIXED}, {0}}};
    palp_network *net = NULL;
    double within = 1e-6 * c->height_m, wider = 0;
    size_t n = 0;
    palp_status status = palp_mesh_add_plane_set(c->mesh, SLIDE[2].set, 0, c->low[0], within);
    if (!status)
        status = palp_mesh_add_plane_set(c->mesh, SLIDE[3].set, 2, c->low[2], within);
    if (!status)
        status = press_top(c, 4, SLIDE, &net);
    const double *rest = palp_mesh_positions(c->mesh), *now = status ? NULL : palp_network_positions(net);
    for (size_t i = 0; now && i < palp_mesh_node_count(c->mesh); i++)
        if (rest[3 * i] >= c->high[0] - within) {
            wider += now[3 * i] - rest[3 * i];
            n++;
        }
    if (n > 0)
        c->poisson = fmin(wider / (double)n / (c->high[0] - c->low[0]) / SMALL, 0.5);
    palp_network_free(net);
    return status;
}

/* The shear modulus of the solid with its force between bonded plates. A square is as a disc of its area. */
static palp_status find_modulus(check_state *c) {
    const palp_indentation plate = {.tip = PALP_TIP_PLATE,
                                    .radius_m = sqrt(c->section_m2 / PI),
                                    .thickness_m = c->height_m,
                                    .poisson = c->poisson,
                                    .tip_sticks = true};
    const double depth = SMALL * c->height_m;
    palp_support supports[2];
    palp_network *net = NULL;
    double force_m2 = 0;
    palp_supports_default(supports);
    palp_status status = press_top(c, 2, supports, &net);
    if (!status)
        status = palp_indentation_force(&plate, 1, &depth, &force_m2);
    if (!status)
        c->shear_Pa = palp_network_force(net) / force_m2;
    palp_network_free(net);
    return status;
}

/* Gives the elements the law of a neo-Hookean solid, with their stiffness at rest: one stiffness for all
 * strains is no solid's. Where there is no such law they keep it. */
static palp_status find_law(check_state *c) {
    static const double LEAST = 0.25, MOST = 0.499;
    palp_law law;
    double rest, own;
    const double poisson = fmin(fmax(c->poisson, LEAST), MOST);
    palp_status status = palp_law_of_solid(c->mesh, poisson, 1.0, &law);
    if (status)
        return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    palp_law_stiffness(&c->material.law, 0.0, &rest, NULL);
    palp_law_stiffness(&law, 0.0, &own, NULL);
    return palp_law_scale(&law, rest / own, &c->material.law);
}

/* Forces of a neo-Hookean solid; 0 where it is not known. */
static palp_status find_forces(check_state *c) {
    for (size_t r = 0; r < c->n_radii; r++)
        for (size_t d = 0; d < c->n_depths; d++) {
            const palp_indentation sphere = {.tip = PALP_TIP_SPHERE,
                                             .radius_m = c->radius_m[r],
                                             .thickness_m = c->height_m,
                                             .poisson = c->poisson,
                                             .large_strain = true,
                                             .specimen_radius_m = sqrt(c->section_m2 / PI)};
            palp_status status = palp_indentation_force(&sphere, 1, &c->depth_m[d], &c->solid_N[r][d]);
            if (status && status != PALP_ERR_LIMIT)
                return status;
            c->solid_N[r][d] = status ? 0 : c->solid_N[r][d] * c->shear_Pa;
        }
    return PALP_OK;
}

/* ---- the presses ---- */

static palp_status press_sphere(check_state *c, size_t r, size_t place) {
    static const palp_support FLOOR = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network *net = NULL;
    palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = c->radius_m[r]};
    palp_tool_force felt;
    memcpy(tool.position_m, c->place[place], sizeof tool.position_m);
    palp_status status = palp_network_create(c->mesh, &c->material, 1, &FLOOR, &c->settings, &net, NULL);
    if (!status)
        status = palp_network_enable_tools(net, 1, 0, &c->touch);
    for (size_t d = 0; !status && d < c->n_depths; d++) {
        double before = d ? c->depth_m[d - 1] : 0;
        for (int half = 1; !status && half <= 2 && c->solid_N[r][d] > 0; half++) {
            tool.position_m[1] = c->high[1] + tool.radius_m - before - 0.5 * half * (c->depth_m[d] - before);
            status = palp_network_set_tools(net, 1, &tool);
            if (!status)
                status = palp_network_step(net, 0, INFINITY, NULL);
        }
        if (!status)
            status = palp_network_tool_force(net, &felt);
        if (!status)
            c->over[r][d][place] = c->solid_N[r][d] > 0 ? felt.force_N[1] / c->solid_N[r][d] : 0;
    }
    palp_network_free(net);
    return status;
}

static double largest_error(const check_state *c, size_t r, size_t d) {
    double most = 0;
    for (size_t p = 0; p < PLACES; p++)
        most = fmax(most, fabs(c->over[r][d][p] - 1));
    return most;
}

/* ---- what is said of it ---- */

static json_t *presses_json(const check_state *c) {
    json_t *list = json_array();
    for (size_t r = 0; r < c->n_radii; r++)
        for (size_t d = 0; d < c->n_depths; d++)
            if (c->solid_N[r][d] > 0)
                json_array_append_new(list, json_pack("{s:f, s:f, s:f, s:f, s:f}", "radius_mm",
                                                      1e3 * c->radius_m[r], "depth_mm", 1e3 * c->depth_m[d],
                                                      "solid_N", c->solid_N[r][d], "on_node",
                                                      c->over[r][d][0], "mid_cell", c->over[r][d][1]));
    return list;
}

static void say_presses(const check_state *c) {
    cli_say(stdout, "as a solid: G = %.4g Pa, Poisson's ratio %.3f", c->shear_Pa, c->poisson);
    cli_say(stdout, "%9s %8s %9s   %s", "radius mm", "depth mm", "solid N",
            "network over solid: on a node, mid-cell");
    for (size_t r = 0; r < c->n_radii; r++)
        for (size_t d = 0; d < c->n_depths; d++)
            if (c->solid_N[r][d] > 0)
                cli_say(stdout, "%9.4g %8.4g %9.4g   %6.3f %6.3f", 1e3 * c->radius_m[r], 1e3 * c->depth_m[d],
                        c->solid_N[r][d], c->over[r][d][0], c->over[r][d][1]);
}

static int report(const calibrate_options *o, check_state *c) {
    palp_error error = {PALP_OK, ""};
    c->model.n_validity = 0;
    for (size_t r = 0; r < c->n_radii; r++)
        for (size_t d = 0; d < c->n_depths; d++)
            if (c->solid_N[r][d] > 0)
                c->model.validity[c->model.n_validity++] =
                    (palp_validity){c->radius_m[r], c->depth_m[d], round(1e4 * largest_error(c, r, d)) / 1e4};
    if (c->model.n_validity == 0)
        return cli_usage_error(
            NAME, "no press of these radii and depths has a known force: press less deep than 0.4 radii");
    palp_status status = o->out ? palp_model_write(&c->model, o->out, &error) : PALP_OK;
    if (status)
        return cli_status(NAME, status, &error);
    if (!o->json) {
        say_presses(c);
        return CLI_OK;
    }
    json_t *all = json_pack("{s:{s:i, s:s}, s:o, s:f, s:f, s:o}", "palpate", "check", 1, "version",
                            palp_version(), "model", json_text(o->check), "shear_Pa", c->shear_Pa, "poisson",
                            c->poisson, "presses", presses_json(c));
    return json_print(NAME, all);
}

/* ---- the command ---- */

/* In metres, ascending; those of the thesis' cube of 24 mm unless given. */
static size_t lengths(const cli_list *given, size_t most, double height_m, const double *part, double *to) {
    size_t n = given->n ? given->n : 3;
    for (size_t i = 0; i < n && i < most; i++) {
        double value = given->n ? 1e-3 * given->value[i] : part[i] * height_m;
        size_t at = i;
        for (; at > 0 && to[at - 1] > value; at--)
            to[at] = to[at - 1];
        to[at] = value;
    }
    return n;
}

static int check(const calibrate_options *o, check_state *c) {
    static const double RADIUS[] = {1.0 / 8, 5.0 / 24, 5.0 / 12}, DEPTH[] = {1.0 / 48, 1.0 / 24, 1.0 / 12};
    int code = read_network(o->check, c);
    if (code)
        return code;
    c->touch.subdivisions = o->subdivisions == SIZE_MAX ? c->touch.subdivisions : o->subdivisions;
    c->n_radii = lengths(&o->tip_radius_mm, RADII, c->height_m, RADIUS, c->radius_m);
    c->n_depths = lengths(&o->depth_mm, DEPTHS, c->height_m, DEPTH, c->depth_m);
    palp_status status = find_poisson(c);
    if (!status)
        status = find_modulus(c);
    if (!status)
        status = find_law(c);
    if (!status)
        status = find_forces(c);
    for (size_t r = 0; !status && r < c->n_radii; r++)
        for (size_t p = 0; !status && p < PLACES; p++)
            status = press_sphere(c, r, p);
    return status ? cli_status_of(NAME, o->check, status, NULL) : report(o, c);
}

int calibrate_check(const calibrate_options *o) {
    if (o->n_words)
        return cli_usage_error(NAME, "--check takes its network alone; leave out %s", o->words[0]);
    if (o->tip_radius_mm.n > RADII || o->depth_mm.n > DEPTHS)
        return cli_usage_error(NAME, "--check takes at most %d radii and %d depths", RADII, DEPTHS);
    check_state *c = calloc(1, sizeof *c);
    if (!c)
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    int code = check(o, c);
    palp_mesh_free(c->mesh);
    free(c->covariance);
    free(c->between);
    free(c);
    return code;
}
