/* reduce_contact.c: the surface of a reduced model, which tools touch as they do a network's. Positions are
 * computed only near the tools. */
#include "base/dense.h"
#include "mesh/mesh_internal.h"
#include "reduce_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SLACK = 2.0; /* in edges; error allowed for positions away from the tools */

/* Numbers the nodes of the triangles, ascending and without repeats, and the triangles' corners by these
 * numbers. */
static void number_surface_nodes(const palp_reduced *r, reduced_contact *surface, int32_t *number) {
    for (size_t i = 0; i < r->n_nodes; i++)
        number[i] = -1;
    for (size_t i = 0; i < 3 * r->n_triangles; i++)
        number[r->triangles[i]] = 0;
    for (size_t i = 0; i < r->n_nodes; i++)
        if (number[i] == 0) {
            number[i] = (int32_t)surface->n;
            surface->node[surface->n++] = (int32_t)i;
        }
    for (size_t i = 0; i < 3 * r->n_triangles; i++)
        surface->triangle[i] = number[r->triangles[i]];
}

/* Largest motion of a node per coordinate and per depth. */
static void find_fastest_surface_node(const palp_reduced *r, reduced_contact *surface) {
    for (size_t i = 0; i < surface->n; i++) {
        size_t row = 3 * (size_t)surface->node[i];
        const double *rows = r->basis + row * r->modes;
        surface->speed = fmax(surface->speed, sqrt(dense_dot(3 * r->modes, rows, rows)));
        surface->lift = fmax(surface->lift, sqrt(dense_dot(3, r->lift + row, r->lift + row)));
    }
}

static palp_status allocate_contact_surface(palp_reduced *r) {
    reduced_contact *surface = r->surface = calloc(1, sizeof *surface);
    arena *memory = &r->memory;
    if (!surface)
        return PALP_ERR_NO_MEMORY;
    surface->x = arena_take(memory, 3 * r->n_nodes, sizeof *surface->x);
    surface->next_x = arena_take(memory, 3 * r->n_nodes, sizeof *surface->next_x);
    surface->rest = arena_take(memory, 3 * r->n_nodes, sizeof *surface->rest);
    surface->unit = arena_take(memory, r->n_nodes, sizeof *surface->unit);
    surface->force = arena_take(memory, 3 * r->n_nodes, sizeof *surface->force);
    surface->node = arena_take(memory, r->n_nodes, sizeof *surface->node);
    surface->near = arena_take(memory, r->n_nodes, sizeof *surface->near);
    surface->triangle = arena_take(memory, 3 * r->n_triangles, sizeof *surface->triangle);
    surface->row = arena_take(memory, 3 * REDUCED_BLOCK * r->modes, sizeof *surface->row);
    return memory->failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

static palp_status enable_tool_contacts(palp_reduced *r, reduced_contact *surface) {
    for (size_t i = 0; i < 3 * surface->n; i++)
        surface->rest[i] = r->rest[3 * (size_t)surface->node[i / 3] + i % 3];
    for (size_t i = 0; i < surface->n; i++)
        surface->unit[i] = r->unit[surface->node[i]];
    contact_set *contacts = &surface->contacts;
    palp_status status =
        contact_set_create(contacts, &r->memory, surface->n, surface->rest, r->n_triangles, surface->triangle,
                           surface->unit, 0.0, r->max_tools, &r->contact_settings);
    palp_law_stiffness(&r->material.law, 0.0, &contacts->modulus, NULL);
    for (size_t j = 0; j < r->material.n_arms; j++)
        contacts->modulus += r->material.arms[j].stiffness_N;
    contacts->stiffening = contact_stiffening(&r->material, contacts->modulus);
    return status;
}

palp_status reduced_contact_make(palp_reduced *r) {
    int32_t *number = malloc((r->n_nodes + 1) * sizeof *number);
    palp_status status = number ? allocate_contact_surface(r) : PALP_ERR_NO_MEMORY;
    if (!status) {
        reduced_contact *surface = r->surface;
        number_surface_nodes(r, surface, number);
        find_fastest_surface_node(r, surface);
        status = enable_tool_contacts(r, surface);
    }
    free(number);
    return status;
}

/* Position of surface node i at (q, depth) into x. */
static void place_surface_node(const palp_reduced *r, size_t i, const double *q, double depth, double *x) {
    for (size_t k = 0; k < 3; k++)
        x[3 * i + k] = reduced_coordinate(r, q, depth, 3 * (size_t)r->surface->node[i] + k);
}

void reduced_contact_reset(palp_reduced *r) {
    reduced_contact *surface = r->surface;
    memcpy(surface->x, surface->rest, 3 * surface->n * sizeof *surface->x);
    contact_set_reset(&surface->contacts);
    surface->drift = 0.0;
}

/* The box around a tool; unbounded for a plane. */
static void bounding_box_of_tool(const palp_tool *tool, double margin, double low[3], double high[3]) {
    for (size_t k = 0; k < 3; k++) {
        low[k] = -INFINITY;
        high[k] = INFINITY;
    }
    if (tool->shape != PALP_TOOL_PLANE)
        contact_box(tool, margin, low, high);
}

/* Finds the nodes that could touch in this step: those whose last position is in a tool's box, enlarged by
 * its travel and the positions' error. */
static void find_nodes_near_tools(palp_reduced *r, double margin) {
    reduced_contact *surface = r->surface;
    const contact_set *contacts = &surface->contacts;
    surface->n_near = 0;
    for (size_t i = 0; i < surface->n; i++) {
        const double *x = surface->x + 3 * i;
        bool near = false;
        for (size_t t = 0; t < contacts->n_tools && !near; t++) {
            double low[3], high[3];
            bounding_box_of_tool(&contacts->tool[t], margin, low, high);
            near = true;
            for (size_t k = 0; k < 3; k++)
                near = near && x[k] > low[k] && x[k] < high[k];
        }
        if (near)
            surface->near[surface->n_near++] = (int32_t)i;
    }
}

/* Largest distance that a tool moves in this step. */
static double farthest_tool_travel(const contact_set *contacts) {
    double most = 0.0;
    for (size_t i = 0; i < contacts->n_tools && i < contacts->now.n_tools; i++) {
        const palp_tool *was = &contacts->now.pose[i], *is = &contacts->tool[i];
        double moved[3];
        along3(is->position_m, -1.0, was->position_m, moved);
        most = fmax(most, sqrt(dot3(moved, moved)) + 2.0 * is->length_m + contact_turned(was, is));
    }
    return most;
}

palp_status reduced_contact_begin(palp_reduced *r, size_t n_tools, const palp_tool *tools) {
    reduced_contact *surface = r->surface;
    contact_set *contacts = &surface->contacts;
    palp_status status = contact_set_tools(contacts, n_tools, tools);
    if (status)
        return status;
    double slack = SLACK * contacts->edge;
    bool all = surface->drift > slack;
    for (size_t i = 0; all && i < surface->n; i++)
        place_surface_node(r, i, r->now.q, r->now.depth, surface->x);
    surface->drift = all ? 0.0 : surface->drift;
    find_nodes_near_tools(r, 2.0 * slack + farthest_tool_travel(contacts));
    for (size_t i = 0; i < surface->n_near && !all; i++)
        place_surface_node(r, (size_t)surface->near[i], r->now.q, r->now.depth, surface->x);
    memcpy(surface->next_x, surface->x, 3 * surface->n * sizeof *surface->x);
    contact_set_place(contacts, 1.0, surface->x, surface->x);
    return PALP_OK;
}

void reduced_contact_evaluate(palp_reduced *r, double *drive) {
    reduced_contact *surface = r->surface;
    contact_set *contacts = &surface->contacts;
    double squares = 0.0;
    for (size_t i = 0; i < contacts->n_contacts; i++)
        for (int32_t j = 0; j < contacts->contact[i].corners; j++)
            place_surface_node(r, (size_t)contacts->contact[i].node[j], r->next.q, r->next.depth,
                               surface->next_x);
    memset(surface->force, 0, 3 * surface->n * sizeof *surface->force);
    contact_set_evaluate(contacts, surface->next_x, surface->force, &squares);
    for (size_t i = 0; i < 3 * surface->n_near; i++) {
        double f = surface->force[3 * surface->near[i / 3] + (int32_t)(i % 3)];
        size_t row = 3 * (size_t)surface->node[surface->near[i / 3]] + i % 3;
        if (f == 0.0 || r->fixed[row])
            continue;
        *drive -= f * r->lift[row];
        for (size_t j = 0; j < r->modes; j++)
            r->rhs[j] += f * r->basis[row * r->modes + j];
    }
}

/* POD rows of a contact's corners, rows[modes 9], and the contact's tangent times them. */
static void reduced_rows_of_contact(const palp_reduced *r, const contact *c, double *rows, double *scaled) {
    size_t n = r->modes;
    memset(scaled, 0, 9 * n * sizeof *scaled);
    for (int32_t b = 0; b < 3; b++) {
        size_t node = b < c->corners ? (size_t)r->surface->node[c->node[b]] : 0;
        for (size_t j = 0; j < 3 * n; j++)
            rows[3 * (size_t)b * n + j] = b < c->corners ? r->basis[3 * node * n + j] : 0.0;
    }
    for (int32_t a = 0; a < c->corners; a++)
        for (int32_t b = 0; b < c->corners; b++) {
            double k[9];
            contact_block(c, a, b, k);
            for (size_t i = 0; i < 9; i++) {
                double *out = scaled + (3 * (size_t)a + i / 3) * n;
                const double *row = rows + (3 * (size_t)b + i % 3) * n;
                for (size_t j = 0; j < n; j++)
                    out[j] += k[i] * row[j];
            }
        }
}

void reduced_contact_stiffness(const palp_reduced *r, double *stiffness) {
    enum { CORNERS = 9, AT_ONCE = 3 * REDUCED_BLOCK / CORNERS };
    const contact_set *contacts = &r->surface->contacts;
    const size_t n = r->modes;
    double *rows = r->surface->row, *scaled = r->scaled;
    for (size_t i = 0, k = 0; i <= contacts->n_contacts; i++) {
        bool touches = i < contacts->n_contacts && contacts->contact[i].depth > 0.0;
        if (touches) {
            reduced_rows_of_contact(r, &contacts->contact[i], rows + CORNERS * k * r->modes,
                                    scaled + CORNERS * k * r->modes);
            k++;
        }
        if (k > 0 && (k == AT_ONCE || i == contacts->n_contacts)) {
            dense_add_outer(n, n, CORNERS * k, 1.0, scaled, n, rows, n, stiffness, n);
            k = 0;
        }
    }
}

bool reduced_contact_refresh(palp_reduced *r) {
    reduced_contact *surface = r->surface;
    for (size_t i = 0; i < surface->n_near; i++)
        place_surface_node(r, (size_t)surface->near[i], r->next.q, r->next.depth, surface->next_x);
    return contact_set_refresh(&surface->contacts, surface->x, surface->next_x);
}

size_t reduced_contact_commit(palp_reduced *r, palp_tool_force *force, double *squares) {
    reduced_contact *surface = r->surface;
    double moved = 0.0, *x = surface->x;
    size_t touching = 0;
    contact_set_finish(&surface->contacts, surface->next_x);
    contact_set_swap(&surface->contacts);
    surface->x = surface->next_x;
    surface->next_x = x;
    for (size_t j = 0; j < r->modes; j++)
        moved += (r->next.q[j] - r->now.q[j]) * (r->next.q[j] - r->now.q[j]);
    surface->drift += surface->speed * sqrt(moved) + surface->lift * fabs(r->next.depth - r->now.depth);
    for (size_t i = 0; i < surface->contacts.n_tools; i++) {
        const palp_tool_force *felt = &surface->contacts.now.felt[i];
        *squares += dot3(felt->force_N, felt->force_N);
        touching += felt->contacts;
        if (force)
            force[i] = *felt;
    }
    return touching;
}
