/* contact_set.c: tools on a surface during a step: placement, forces, history. */
#include "contact_internal.h"

#include <string.h>

enum {
    POINTS = 4,
    SPARE = 1024
}; /* room for fixed points near a tool: of a triangle on the average, and more */
static const double SLID = 0.1; /* in edges: a contact whose point moved so far is found anew */

/* ---- making -------------------------------------------------------------------------------------- */

static void allocate_contact_state(contact_state *s, arena *memory, size_t max_tools, size_t max_contacts) {
    s->pose = arena_take(memory, max_tools, sizeof *s->pose);
    s->felt = arena_take(memory, max_tools, sizeof *s->felt);
    s->touch = arena_take(memory, max_contacts, sizeof *s->touch);
    s->told = arena_take(memory, max_contacts, sizeof *s->told);
}

static double mean_edge_length(const double *rest, size_t n_surface, const int32_t *surface) {
    double length = 0.0;
    for (size_t i = 0; i < 3 * n_surface; i++) {
        double d[3];
        size_t next = i % 3 == 2 ? i - 2 : i + 1;
        along3(rest + 3 * surface[i], -1.0, rest + 3 * surface[next], d);
        length += sqrt(dot3(d, d));
    }
    return length / (3.0 * (double)n_surface);
}

palp_status contact_set_create(contact_set *set, arena *memory, size_t n_nodes, const double *rest,
                               size_t n_surface, const int32_t *surface, const double *unit, double edge,
                               size_t max_tools, const palp_contact_settings *settings) {
    const size_t points = settings->subdivisions > 0 ? n_surface : POINTS * n_surface + SPARE;
    size_t all = max_tools * (points > n_nodes ? points : n_nodes), most = settings->max_contacts;
    set->settings = *settings;
    set->n_nodes = n_nodes;
    set->max_tools = max_tools;
    set->max_contacts = most > 0 && most < all ? most : all;
    set->unit = unit;
    set->rest = rest;
    set->solid = 1.0;
    for (size_t m = 0; m <= PALP_REGIONS_MAX; m++)
        set->relaxation[m] = (contact_relaxation){.share = 1.0};
    set->edge = n_surface > 0 ? mean_edge_length(rest, n_surface, surface) : edge;
    set->tool = arena_take(memory, max_tools, sizeof *set->tool);
    set->pose = arena_take(memory, max_tools, sizeof *set->pose);
    set->contact = arena_take(memory, set->max_contacts, sizeof *set->contact);
    set->triangles = arena_take(memory, n_nodes, sizeof *set->triangles);
    allocate_contact_state(&set->now, memory, max_tools, set->max_contacts);
    allocate_contact_state(&set->next, memory, max_tools, set->max_contacts);
    if (memory->failed)
        return PALP_ERR_NO_MEMORY;
    contact_set_surface(set, n_surface, surface);
    return PALP_OK;
}

void contact_set_surface(contact_set *set, size_t n, const int32_t *surface) {
    set->surface = surface;
    set->n_surface = n;
    memset(set->triangles, 0, set->n_nodes * sizeof *set->triangles);
    for (size_t i = 0; i < 3 * n; i++)
        set->triangles[surface[i]]++;
}

void contact_set_reset(contact_set *set) {
    set->now.n_tools = set->now.n_touches = set->now.n_told = 0;
}

/* ---- tools --------------------------------------------------------------------------------------- */

static bool are_tool_values_valid(const palp_tool *t) {
    if (t->shape > PALP_TOOL_HULL || !finite3(t->position_m) || !(t->friction >= 0.0) ||
        !isfinite(t->friction))
        return false;
    const double *q = t->orientation, square = q[0] * q[0] + dot3(q + 1, q + 1);
    if (square != 0.0 && !(fabs(sqrt(square) - 1.0) < 1e-6))
        return false;
    if (t->shape != PALP_TOOL_PLANE && !positive(t->radius_m))
        return false;
    if (t->shape == PALP_TOOL_CAPSULE && !(t->length_m >= 0.0 && isfinite(t->length_m)))
        return false;
    if (t->shape == PALP_TOOL_HULL)
        return t->hull;
    return t->shape == PALP_TOOL_SPHERE || fabs(sqrt(dot3(t->axis, t->axis)) - 1.0) < 1e-6;
}

/* A copy without what its shape does not need, and an orientation of length 1. */
static palp_tool copy_of_tool(const palp_tool *tool) {
    palp_tool t = *tool;
    const double *q = tool->orientation, length = sqrt(q[0] * q[0] + dot3(q + 1, q + 1));
    for (int k = 0; k < 4; k++)
        t.orientation[k] = length > 0.0 ? q[k] / length : 0.0;
    if (t.shape == PALP_TOOL_SPHERE || t.shape == PALP_TOOL_HULL)
        t.axis[0] = t.axis[1] = t.axis[2] = 0.0;
    if (t.shape != PALP_TOOL_HULL)
        t.hull = NULL;
    return t;
}

palp_status contact_set_tools(contact_set *set, size_t n, const palp_tool *tools) {
    if (n > set->max_tools || (n > 0 && !tools))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (!are_tool_values_valid(&tools[i]))
            return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        set->tool[i] = copy_of_tool(&tools[i]);
    for (size_t i = n; i < set->max_tools; i++)
        set->tool[i].hull = NULL;
    set->n_tools = n;
    return PALP_OK;
}

double contact_set_way(const contact_set *set) {
    double longest = set->n_tools > set->now.n_tools ? 1.0 : 0.0;
    for (size_t i = 0; i < set->n_tools; i++)
        longest = fmax(longest, contact_travel(set, &set->tool[i], i) / contact_stride(set, &set->tool[i]));
    return longest;
}

/* Is a point in the body? A line along y leaves the body as often as it enters: counts faces below less faces
 * above. An edge belongs to one of its faces. */
static bool is_point_inside_body(size_t n, const int32_t *surface, const double *x, const double *p) {
    bool inside = false;
    for (size_t i = 0; i < n; i++) {
        const double *corner[3];
        bool over = false;
        for (size_t k = 0; k < 3; k++)
            corner[k] = x + 3 * surface[3 * i + k];
        for (size_t k = 0; k < 3; k++) {
            const double *a = corner[k], *b = corner[(k + 1) % 3];
            if ((a[0] > p[0]) != (b[0] > p[0]) && p[2] < a[2] + (p[0] - a[0]) * (b[2] - a[2]) / (b[0] - a[0]))
                over = !over;
        }
        if (!over)
            continue;
        double ap[3], normal[3];
        along3(p, -1.0, corner[0], ap);
        triangle_normal(corner[0], corner[1], corner[2], normal);
        if ((dot3(normal, ap) < 0.0) == (normal[1] > 0.0))
            inside = !inside;
    }
    return inside;
}

bool contact_set_inside(const contact_set *set, size_t n, const int32_t *surface, const double *x) {
    for (size_t i = 0; i < set->n_tools; i++) {
        const palp_tool *tool = &set->next.pose[i];
        double point[3];
        memcpy(point, tool->position_m, sizeof point);
        if (tool->shape == PALP_TOOL_HULL)
            contact_hull_centre(tool, point);
        if (tool->shape != PALP_TOOL_PLANE && set->next.felt[i].contacts == 0 &&
            is_point_inside_body(n, surface, x, point))
            return true;
    }
    return false;
}

/* ---- a step -------------------------------------------------------------------------------------- */

/* A tool at this share of its way; a new tool is at its target. */
static palp_tool interpolate_tool_pose(const contact_set *set, size_t i, double share) {
    const palp_tool *was = &set->now.pose[i];
    palp_tool pose = set->tool[i];
    if (share == 1.0 || i >= set->now.n_tools || was->shape != pose.shape)
        return pose;
    for (int k = 0; k < 3; k++) {
        pose.position_m[k] = (1.0 - share) * was->position_m[k] + share * pose.position_m[k];
        pose.axis[k] = (1.0 - share) * was->axis[k] + share * pose.axis[k];
    }
    contact_turn_between(was, &set->tool[i], share, pose.orientation);
    double length = sqrt(dot3(pose.axis, pose.axis));
    for (int k = 0; k < 3 && (pose.shape == PALP_TOOL_CAPSULE || pose.shape == PALP_TOOL_PLANE); k++)
        pose.axis[k] = length > 1e-3 ? pose.axis[k] / length : set->tool[i].axis[k];
    return pose;
}

void contact_set_place(contact_set *set, double share, const double *committed, const double *x) {
    set->share = share;
    for (size_t i = 0; i < set->n_tools; i++)
        set->pose[i] = interpolate_tool_pose(set, i, share);
    contact_find(set, committed, x);
}

void contact_set_evaluate(contact_set *set, const double *x, double *force, double *squares) {
    contact_plane plane = {.node = {-1, -1, -1}};
    for (size_t i = 0; i < set->n_contacts; i++) {
        contact *c = &set->contact[i];
        contact_evaluate_next(set, c, x, &plane);
        if (!(c->depth > 0.0))
            continue;
        for (int j = 0; j < c->corners; j++) {
            double *f = force + 3 * c->node[j];
            double push[3];
            if (c->fixed) {
                contact_face_push(c, j, push);
                along3(f, 1.0, push, f);
            } else
                along3(f, c->share[j] * c->pressure, c->normal, f);
            along3(f, c->stick_share[j], c->friction, f);
        }
        *squares += c->stiffness * c->stiffness * dot3(c->point, c->point);
    }
}

bool contact_set_refresh(contact_set *set, const double *committed, const double *x) {
    bool slid = false;
    for (size_t i = 0; i < set->n_contacts && !slid; i++)
        slid = set->contact[i].depth > 0.0 && contact_slid(set, &set->contact[i], x) > SLID * set->edge;
    if (slid)
        contact_find(set, committed, x);
    return slid;
}

/* ---- the end of a step --------------------------------------------------------------------------- */

void contact_feel(const palp_tool *pose, const double point[3], double size, const double force[3],
                  palp_tool_force *felt) {
    double arm[3], moment[3];
    along3(point, -1.0, pose->position_m, arm);
    cross3(arm, force, moment);
    along3(felt->force_N, -size, force, felt->force_N);
    along3(felt->moment_Nm, -size, moment, felt->moment_Nm);
}

static void add_force_on_tool(const palp_tool *pose, const contact *c, const double *x,
                              palp_tool_force *felt) {
    double stuck[3], centre[3];
    contact_point(c, c->stick_share, x, stuck);
    along3(pose->position_m, c->along, pose->axis, centre); /* through which a fixed point's force goes */
    contact_feel(pose, c->fixed ? centre : c->point, contact_normal_force(c), c->normal, felt);
    contact_feel(pose, stuck, 1.0, c->friction, felt);
    felt->contacts++;
    felt->depth_m = fmax(felt->depth_m, c->depth - c->early);
}

/* A contact that is new has no arms yet. */
static void remember_arms(const contact_set *set, const contact *c, contact_touch *t) {
    const contact_touch *was = c->memory < 0 ? NULL : &set->now.touch[c->memory];
    const contact_relaxation *r = &set->relaxation[c->material];
    t->elastic = c->elastic;
    for (size_t j = 0; j < r->n_arms; j++)
        t->arm[j] =
            (was ? r->keep[j] * was->arm[j] - r->gain[j] * was->elastic : 0.0) + r->gain[j] * c->elastic;
}

static void tell_contact(const contact_set *set, const contact *c, contact_told *told) {
    told->contact = (palp_contact){.tool = (size_t)c->tool,
                                   .other = -1,
                                   .normal_N = contact_normal_force(c),
                                   .depth_m = c->depth - c->early,
                                   .slips = set->pose[c->tool].friction > 0.0 && c->kept < 1.0};
    memcpy(told->contact.place_m, c->point, sizeof c->point);
    memcpy(told->contact.normal, c->normal, sizeof c->normal);
    memcpy(told->contact.friction_N, c->friction, sizeof c->friction);
    memcpy(told->node, c->node, sizeof told->node);
    memcpy(told->share, c->share, sizeof told->share);
}

void contact_set_finish(contact_set *set, const double *x) {
    contact_state *next = &set->next;
    next->n_told = 0;
    next->n_tools = set->n_tools;
    next->n_touches = 0;
    for (size_t i = 0; i < set->n_tools; i++) {
        next->pose[i] = set->pose[i];
        next->felt[i] = (palp_tool_force){.contacts = 0};
    }
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        if (!(c->depth > 0.0))
            continue;
        add_force_on_tool(&set->pose[c->tool], c, x, &next->felt[c->tool]);
        contact_touch *t = &next->touch[next->n_touches++];
        t->tool = c->tool;
        t->part = c->part;
        memcpy(t->node, c->node, sizeof t->node);
        memcpy(t->stretch, c->stretch, sizeof t->stretch);
        tell_contact(set, c, &next->told[next->n_told++]);
        remember_arms(set, c, t);
    }
}

/* ---- errors that friction remembers ---------------------------------------------------------------- */

double contact_friction_limit(const contact_set *set, const contact *c) {
    return c->depth > 0.0 ? set->pose[c->tool].friction * contact_normal_force(c) : 0.0;
}

/* The remaining error of a spring's start, as a force: the error times the tissue's stiffness K of the point.
 * A spring of stiffness k that slips keeps its force along the way at the limit, whatever the error there
 * was. Across the way only its share kept remains, and its stiffness is k kept. So an error a moves the point
 * by y = k kept a / (K + k kept). The new start is off by y + kept (a - y) = kept (K + k) a / (K + k kept).
 * The way turns from tick to tick: some of the error along the last one is across the new one. */
static contact_doubt doubt_after_slip(const contact_set *set, const contact *c) {
    const double soft = 1.0 / set->settings.stiffness;
    double cross[3], turn = 1.0;
    if (!(c->kept < 1.0))
        return (contact_doubt){.across =
                                   sqrt(c->doubt.across * c->doubt.across + c->doubt.along * c->doubt.along)};
    cross3(c->was, c->stretch, cross);
    const double lengths = dot3(c->was, c->was) * dot3(c->stretch, c->stretch);
    if (lengths > 0.0)
        turn = sqrt(dot3(cross, cross) / lengths);
    const double slip = (1.0 / c->kept - 1.0) * sqrt(dot3(c->stretch, c->stretch)) * c->stiffness * soft,
                 behind = fmax(0.0, c->doubt.along - slip);
    return (contact_doubt){.along = behind,
                           .across = c->kept * (1.0 + soft) / (c->kept + soft) *
                                     (c->doubt.across + turn * c->doubt.along)};
}

double contact_force_doubt(const contact_set *set, const contact *c) {
    if (!(contact_friction_limit(set, c) > 0.0))
        return 0.0;
    const contact_doubt doubt = doubt_after_slip(set, c);
    return doubt.across + doubt.along;
}

double contact_set_doubt(const contact_set *set) {
    double sum = 0.0;
    for (size_t i = 0; i < set->n_contacts; i++)
        sum += contact_force_doubt(set, &set->contact[i]);
    return sum;
}

/* Adds the error of this step's slip, if the point is off by d. A spring that slips along a direction starts
 * anew from the point less limit / k, of which the limit changes with the pressure; across that direction it
 * keeps its share. One that sticks slips by what d is more than its room up to the limit. */
static void add_error_of_slip(const contact_set *set, const contact *c, const double off[3],
                              contact_doubt *doubt) {
    const double friction = set->pose[c->tool].friction, own = c->stiffness / set->settings.stiffness,
                 down = dot3(off, c->normal), length = sqrt(dot3(c->stretch, c->stretch));
    double d[3];
    along3(off, -down, c->normal, d);
    const double size = sqrt(dot3(d, d)), pressed = friction * fabs(down);
    if (c->kept < 1.0 && length > 0.0) {
        const double along = fabs(dot3(d, c->stretch)) / length;
        doubt->along = fmax(doubt->along, own * (along + pressed));
        doubt->across += own * (1.0 - c->kept) * sqrt(fmax(0.0, size * size - along * along));
    } else {
        const double room = c->touched ? friction * c->pressure / c->stiffness - c->entry * length : 0.0;
        doubt->across = fmax(doubt->across, own * (size + pressed - fmax(0.0, room)));
    }
}

contact_doubt contact_doubt_to_keep(const contact_set *set, const contact *c, const double *off,
                                    double error) {
    const double most = contact_friction_limit(set, c);
    contact_doubt doubt = {0.0, 0.0};
    if (!(most > 0.0))
        return doubt;
    doubt = doubt_after_slip(set, c);
    if (off) {
        add_error_of_slip(set, c, off, &doubt);
    } else if (c->kept < 1.0 || !c->touched) {
        doubt.along = fmax(doubt.along, error);
        doubt.across += (1.0 - c->kept) * doubt.along;
    }
    return (contact_doubt){fmin(doubt.along, 2.0 * most), fmin(doubt.across, 2.0 * most)};
}

void contact_set_keep_doubt(contact_set *set, const double *change, double error) {
    double all = 0.0;
    contact_touch *t = set->next.touch;
    for (size_t i = 0; i < set->n_contacts; i++)
        all += contact_friction_limit(set, &set->contact[i]);
    for (size_t i = 0; i < set->n_contacts; i++) {
        const contact *c = &set->contact[i];
        if (!(c->depth > 0.0))
            continue;
        const double share = all > 0.0 ? contact_friction_limit(set, c) / all : 0.0;
        double off[3];
        if (change)
            contact_point(c, c->stick_share, change, off);
        (t++)->doubt = contact_doubt_to_keep(set, c, change ? off : NULL, error * share);
    }
}

void contact_set_swap(contact_set *set) {
    contact_state old = set->now;
    set->now = set->next;
    set->next = old;
}
