/* press.c: runs a lumped model or a network along a path and records the force. */
#include "press.h"
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    EVEN = 100,    /* steps of a segment that moves */
    GROWING = 120, /* steps of a segment that is held */
    RELAXED_STEPS = 200,
    HALVINGS_MAX = 7
};

static const double first_part = 1e-5; /* first step of a held segment, of its length */

/* ---- sample times ---- */

static double held_value(const palp_path *path, size_t i) {
    return path->force_N ? path->force_N[i] : path->depth_m[i];
}

/* Steps of segment i: their number, and whether they grow. */
static size_t segment_steps(const palp_path *path, size_t i, const press_settings *settings, bool *growing) {
    *growing = false;
    if (settings->corners)
        return 1;
    if (settings->dt_s > 0) {
        double steps = ceil((path->time_s[i + 1] - path->time_s[i]) / settings->dt_s * (1 - 1e-12));
        return steps < 1 ? 1 : (size_t)steps;
    }
    *growing = held_value(path, i) == held_value(path, i + 1);
    return *growing ? GROWING : EVEN;
}

palp_status press_times(const palp_path *path, const press_settings *settings, size_t *n, double **time_s) {
    size_t total = 1, at = 0;
    bool growing;
    for (size_t i = 0; i + 1 < path->n; i++)
        total += segment_steps(path, i, settings, &growing);
    double *t = malloc(total * sizeof *t);
    if (!t)
        return PALP_ERR_NO_MEMORY;
    t[at++] = path->time_s[0];
    for (size_t i = 0; i + 1 < path->n; i++) {
        double start = path->time_s[i], length = path->time_s[i + 1] - start;
        size_t steps = segment_steps(path, i, settings, &growing);
        for (size_t k = 1; k < steps; k++) {
            double part = (double)k / (double)steps;
            t[at++] = start + length * (growing ? first_part * (pow(1 + 1 / first_part, part) - 1) : part);
        }
        t[at++] = path->time_s[i + 1];
    }
    *n = at;
    *time_s = t;
    return PALP_OK;
}

/* ---- lumped ---- */

/* Strain at which the force after dt_s is force_N: Newton, kept in a bracket by bisection. */
static palp_status creep_step(const palp_material *material, double force_N, double dt_s,
                              palp_element_state *state) {
    double low = -0.95, high = 0.95, e = state->strain, slope;
    palp_element_state next = *state;
    palp_status status = palp_element_advance(material, state, high, dt_s, &next, NULL);
    if (status == PALP_OK && next.force_N < force_N)
        return PALP_ERR_COLLAPSED;
    for (int i = 0; status == PALP_OK && i < 200; i++) {
        status = palp_element_advance(material, state, e, dt_s, &next, &slope);
        double miss = next.force_N - force_N;
        if (status || fabs(miss) <= 1e-13 * fabs(force_N) || high - low < 1e-15)
            break;
        if (miss > 0)
            high = e;
        else
            low = e;
        double newton = e - miss / slope;
        e = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    *state = next;
    return status;
}

/* The specimen's response at n times: force to a depth path, depth to a force path. */
static palp_status answer(const palp_material *material, double height_m, const palp_path *path, bool relaxed,
                          size_t n, const double *time_s, double *drive, double *out) {
    for (size_t i = 0; i < n; i++) {
        drive[i] = palp_path_at(path, time_s[i]);
        if (!path->force_N && drive[i] < 0)
            drive[i] = 0; /* the plate is in free air and pulls at nothing */
    }
    if (path->force_N) {
        palp_element_state state = {0};
        for (size_t i = 0; i < n; i++) {
            double dt_s = i ? time_s[i] - time_s[i - 1] : 0;
            if (i > 0 || drive[i] > 0) {
                palp_status status = creep_step(material, drive[i], dt_s, &state);
                if (status)
                    return status;
            }
            out[i] = state.strain * height_m;
        }
        return PALP_OK;
    }
    if (!relaxed)
        return palp_lumped_run(material, height_m, n, time_s, drive, out);
    for (size_t i = 0; i < n; i++) {
        double e = drive[i] / height_m;
        palp_law_force(&material->law, 1, &e, &out[i], NULL, NULL);
    }
    return PALP_OK;
}

/* The answer with every step of time_s[n] cut in cuts, at the times of time_s only. */
static palp_status answer_finer(const palp_material *material, double height_m, const palp_path *path,
                                const press_settings *settings, size_t n, const double *time_s, size_t cuts,
                                double *out) {
    size_t m = (n - 1) * cuts + 1;
    double *work = malloc(3 * m * sizeof *work);
    if (!work)
        return PALP_ERR_NO_MEMORY;
    double *t = work, *drive = work + m, *all = work + 2 * m;
    for (size_t i = 0; i + 1 < n; i++)
        for (size_t k = 0; k < cuts; k++)
            t[i * cuts + k] = time_s[i] + (time_s[i + 1] - time_s[i]) * (double)k / (double)cuts;
    t[m - 1] = time_s[n - 1];
    palp_status status = answer(material, height_m, path, settings->relaxed, m, t, drive, all);
    for (size_t i = 0; status == PALP_OK && i < n; i++)
        out[i] = all[i * cuts];
    free(work);
    return status;
}

/* Halves the steps until the answer changes less than the tolerance. */
static palp_status answer_to_tolerance(const palp_material *material, double height_m, const palp_path *path,
                                       const press_settings *settings, size_t n, const double *time_s,
                                       double *out) {
    double *coarse = malloc(n * sizeof *coarse);
    palp_status status =
        coarse ? answer_finer(material, height_m, path, settings, n, time_s, 1, out) : PALP_ERR_NO_MEMORY;
    double change = settings->dt_s > 0 ? 0 : 1, scale = 0;
    for (size_t k = 1; status == PALP_OK && change > settings->tolerance * scale && k <= HALVINGS_MAX; k++) {
        memcpy(coarse, out, n * sizeof *out);
        status = answer_finer(material, height_m, path, settings, n, time_s, (size_t)1 << k, out);
        change = 0;
        for (size_t i = 0; status == PALP_OK && i < n; i++) {
            change = fmax(change, fabs(out[i] - coarse[i]));
            scale = fmax(scale, fabs(out[i]));
        }
    }
    free(coarse);
    return status;
}

palp_status press_lumped(const palp_material *material, double height_m, const palp_path *path,
                         const press_settings *settings, record *curve) {
    size_t n = 0;
    double *t = NULL;
    palp_status status = press_times(path, settings, &n, &t);
    double *out = status == PALP_OK ? malloc(n * sizeof *out) : NULL;
    if (status == PALP_OK)
        status =
            out ? answer_to_tolerance(material, height_m, path, settings, n, t, out) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; status == PALP_OK && i < n; i++) {
        double given = palp_path_at(path, t[i]);
        status =
            path->force_N ? record_add(curve, t[i], out[i], given) : record_add(curve, t[i], given, out[i]);
    }
    free(out);
    free(t);
    return status;
}

/* ---- network ---- */

typedef struct observation {
    const palp_path *path;
    const press_settings *settings;
    const press_watch *watch;
    record *curve;
    size_t corner; /* the next to come */
    palp_status status;
} observation;

static bool at_corner(observation *o, double time_s) {
    const palp_path *path = o->path;
    while (o->corner < path->n) {
        size_t i = o->corner, next = i + 1 < path->n ? i + 1 : i;
        double near = 1e-6 * (path->time_s[next] - path->time_s[i ? i - 1 : 0]);
        if (time_s < path->time_s[i] - near)
            return false;
        o->corner++;
        if (time_s <= path->time_s[i] + near)
            return true;
    }
    return false;
}

static int observe(void *user, double time_s, double depth_m, double force_N) {
    observation *o = user;
    const palp_path *path = o->path;
    if (!o->settings->corners || at_corner(o, time_s))
        o->status = record_add(o->curve, time_s, depth_m, force_N);
    if (o->watch && o->watch->bar) {
        double length = path->time_s[path->n - 1] - path->time_s[0];
        progress_update(o->watch->bar, (time_s - path->time_s[0]) / length);
    }
    if (o->status == PALP_OK && o->watch && o->watch->frame)
        return o->watch->frame(o->watch->user);
    return o->status != PALP_OK;
}

palp_status press_network(palp_network *network, const palp_path *path, const press_settings *settings,
                          const press_watch *watch, record *curve, palp_run_info *info) {
    observation o = {.path = path, .settings = settings, .watch = watch, .curve = curve};
    palp_run_settings run = {
        .dt_s = settings->dt_s, .observer = observe, .user = &o, .relaxed = settings->relaxed};
    double length = path->time_s[path->n - 1] - path->time_s[0];
    if (settings->relaxed && run.dt_s <= 0)
        run.dt_s = length / RELAXED_STEPS;
    else if (run.dt_s <= 0)
        run.tolerance = settings->tolerance;
    run.from_s = settings->from_s;
    bool at_rest = path->force_N ? path->force_N[0] <= 0 : path->depth_m[0] == 0;
    if (run.from_s > 0)
        at_corner(&o, run.from_s);
    else if (at_rest) {
        o.status = record_add(curve, path->time_s[0], 0, 0);
        o.corner = 1;
    }
    palp_status status = o.status ? o.status : palp_network_run(network, path, &run, info);
    return o.status ? o.status : status;
}

/* Highest y of the centre at which a sphere at x and z touches a triangle's plane inside it, or one of its
 * corners; -INFINITY: it meets neither. An edge that it would meet first, which is a little higher,
 * is left out. */
static double touching_height(const double *const corner[3], double radius_m, double x_m, double z_m) {
    double height = -INFINITY, u[3], v[3], normal[3];
    for (int c = 0; c < 3; c++) {
        const double away = hypot(corner[c][0] - x_m, corner[c][2] - z_m);
        if (away < radius_m)
            height = fmax(height, corner[c][1] + sqrt(radius_m * radius_m - away * away));
    }
    for (int k = 0; k < 3; k++) {
        u[k] = corner[1][k] - corner[0][k];
        v[k] = corner[2][k] - corner[0][k];
    }
    for (int k = 0; k < 3; k++)
        normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (!(normal[1] > 1e-6 * length))
        return height;
    /* the centre is above x and z, its foot on the plane aside of it; on a flat top both are one */
    const double foot[2] = {x_m - radius_m * normal[0] / length, z_m - radius_m * normal[2] / length};
    const double dx = foot[0] - corner[0][0], dz = foot[1] - corner[0][2], det = u[0] * v[2] - u[2] * v[0];
    const double a = (dx * v[2] - dz * v[0]) / det, b = (u[0] * dz - u[2] * dx) / det;
    if (a >= -1e-9 && b >= -1e-9 && a + b <= 1 + 1e-9)
        height = fmax(height, corner[0][1] + a * u[1] + b * v[1] + radius_m * normal[1] / length);
    return height;
}

palp_tool press_sphere(const palp_mesh *mesh, double radius_m, double x_m, double z_m) {
    palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = radius_m};
    const double *x = palp_mesh_positions(mesh);
    const int32_t *top = NULL, *triangle = palp_mesh_triangles(mesh);
    size_t n = 0;
    if (!isnan(x_m) && !isnan(z_m)) {
        double height = -INFINITY;
        for (size_t i = 0; i < palp_mesh_triangle_count(mesh); i++) {
            const double *const corner[3] = {x + 3 * triangle[3 * i], x + 3 * triangle[3 * i + 1],
                                             x + 3 * triangle[3 * i + 2]};
            height = fmax(height, touching_height(corner, radius_m, x_m, z_m));
        }
        tool.position_m[0] = x_m;
        tool.position_m[1] = height;
        tool.position_m[2] = z_m;
        return tool;
    }
    palp_mesh_set(mesh, "top", &n, &top);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            tool.position_m[k] += x[3 * top[i] + k] / (double)n;
    tool.position_m[1] += radius_m;
    return tool;
}

static palp_status step_tool(palp_network *network, const palp_tool *start, double time_s, double depth_m,
                             double dt_s, double *force_N, palp_run_info *info) {
    palp_tool tool = *start;
    palp_tool_force felt;
    palp_step_info step;
    tool.position_m[1] -= depth_m;
    palp_status status = palp_network_set_tools(network, 1, &tool);
    if (!status)
        status = palp_network_step(network, 0, dt_s, &step);
    if (!status)
        status = palp_network_tool_force(network, &felt);
    if (status)
        return status;
    *force_N = felt.force_N[1];
    info->steps++;
    info->iterations += (size_t)step.iterations;
    info->worst_residual = fmax(info->worst_residual, step.residual);
    info->peak_force_N = fmax(info->peak_force_N, felt.force_N[1]);
    info->inverted = step.inverted > info->inverted ? step.inverted : info->inverted;
    if (step.beyond > 0 && info->beyond <= 0)
        info->beyond_s = time_s;
    info->beyond = fmax(info->beyond, step.beyond);
    return PALP_OK;
}

palp_status press_tool(palp_network *network, const palp_tool *start, const palp_path *path,
                       const press_settings *settings, const press_watch *watch, record *curve,
                       palp_run_info *info) {
    observation o = {.path = path, .settings = &(press_settings){0}, .watch = watch, .curve = curve};
    double *time_s = NULL;
    size_t n = 0;
    memset(info, 0, sizeof *info);
    palp_status status = press_times(path, settings, &n, &time_s);
    for (size_t i = 0; status == PALP_OK && i < n; i++) {
        double depth_m = palp_path_at(path, time_s[i]), force_N = 0;
        if (i > 0 || depth_m > 0)
            status = step_tool(network, start, time_s[i], depth_m,
                               settings->relaxed ? INFINITY
                               : i               ? time_s[i] - time_s[i - 1]
                                                 : 0,
                               &force_N, info);
        if (status == PALP_OK && observe(&o, time_s[i], depth_m, force_N))
            status = o.status ? o.status : PALP_ERR_STOPPED;
    }
    free(time_s);
    return status;
}

void press_warn_beyond(const char *name, const palp_law *law, double largest_strain, double first_s) {
    char from[48] = "";
    if (first_s >= 0)
        snprintf(from, sizeof from, " from t = %.4g s", first_s);
    cli_warning(name,
                "beyond the measured strain of %.4g%s, to %.4g: the law is extended along its tangent, not "
                "measured",
                law->strain_max, from, largest_strain);
}

void press_warn_buckled(const char *name, double stable_m, double unstable_m, double height_m,
                        palp_branch branch) {
    cli_warning(name, "the network buckles between %.4g and %.4g mm (strain %.4g..%.4g); %s", 1e3 * stable_m,
                1e3 * unstable_m, stable_m / height_m, unstable_m / height_m,
                branch == PALP_BRANCH_STABLE
                    ? "followed a stable branch; --branch continue follows Newton's method"
                    : "followed the branch that Newton's method finds; --branch stable follows "
                      "a stable one");
}
