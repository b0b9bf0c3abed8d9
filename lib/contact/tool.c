/* tool.c: enabling and placing tools, holding nodes, and what they feel. */
#include "tool_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_contact_settings palp_contact_settings_default(void) {
    return (palp_contact_settings){.stiffness = 20.0, .hold_stiffness = 100.0, .smoothing = 0.01};
}

static bool finite3(const double v[3]) {
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool positive(double v) {
    return v > 0.0 && isfinite(v);
}

/* ---- enabling ------------------------------------------------------------------------------------ */

/* Elements of each node. */
static void list_elements(const palp_network *net, network_load *load) {
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        load->first[net->pair[i] + 1]++;
    for (size_t i = 0; i < net->n_nodes; i++)
        load->first[i + 1] += load->first[i];
    for (size_t i = 2 * net->n_elements; i-- > 0;) /* backwards: first ends where it should start */
        load->element[--load->first[net->pair[i] + 1]] = (int32_t)(i / 2);
    memmove(load->first, load->first + 1, net->n_nodes * sizeof *load->first);
    load->first[net->n_nodes] = 2 * net->n_elements;
}

/* A node's own stiffness is a third of the trace of its block of the tangent: the mean over directions. */
static void measure(const palp_network *net, network_load *load) {
    const double *scale = palp_mesh_element_scale(net->mesh);
    double length = 0.0;
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        load->unit[net->pair[i]] += (scale ? scale[i / 2] : 1.0) * net->inverse_rest[i / 2] / 3.0;
    for (size_t i = 0; i < 3 * net->n_surface; i++) {
        double d[3];
        size_t next = i % 3 == 2 ? i - 2 : i + 1;
        along3(net->rest + 3 * net->surface[i], -1.0, net->rest + 3 * net->surface[next], d);
        length += sqrt(dot3(d, d));
    }
    load->edge = net->n_surface > 0 ? length / (3.0 * (double)net->n_surface) : net->extent;
    load->surface_changes = net->surface_changes - 1; /* triangles are counted at the first step */
}

static palp_status make(const palp_network *net, size_t max_tools, size_t max_held,
                        const palp_contact_settings *settings, network_load **out) {
    network_load *load = calloc(1, sizeof *load);
    if (!load)
        return PALP_ERR_NO_MEMORY;
    size_t all = max_tools * (net->n_surface > net->n_nodes ? net->n_surface : net->n_nodes);
    load->settings = *settings;
    load->max_tools = max_tools;
    load->max_held = max_held;
    load->max_contacts = settings->max_contacts > 0 && settings->max_contacts < all ? settings->max_contacts : all;
    load->tool = calloc(max_tools + 1, sizeof *load->tool);
    load->pose = calloc(max_tools + 1, sizeof *load->pose);
    load->target = calloc(3 * max_held + 1, sizeof *load->target);
    load->contact = calloc(load->max_contacts + 1, sizeof *load->contact);
    load->unit = calloc(net->n_nodes, sizeof *load->unit);
    load->triangles = calloc(net->n_nodes, sizeof *load->triangles);
    load->first = calloc(net->n_nodes + 1, sizeof *load->first);
    load->element = calloc(2 * net->n_elements, sizeof *load->element);
    load->force = calloc(3 * net->n_nodes, sizeof *load->force);
    load->weight = calloc(net->n_nodes, sizeof *load->weight);
    if (!load->tool || !load->pose || !load->target || !load->contact || !load->unit || !load->triangles ||
        !load->first || !load->element || !load->force || !load->weight) {
        network_load_free(load);
        return PALP_ERR_NO_MEMORY;
    }
    list_elements(net, load);
    measure(net, load);
    *out = load;
    return PALP_OK;
}

palp_status palp_network_enable_tools(palp_network *net, size_t max_tools, size_t max_held,
                                      const palp_contact_settings *settings) {
    const palp_contact_settings *s = settings;
    network_load *load;
    if (!net || !s || net->load || max_tools > INT32_MAX || max_held > net->n_nodes)
        return PALP_ERR_ARGUMENT;
    if (!positive(s->stiffness) || !positive(s->hold_stiffness) || !positive(s->smoothing) ||
        !finite3(s->gravity_m_s2) || (dot3(s->gravity_m_s2, s->gravity_m_s2) > 0.0 && !net->mass))
        return PALP_ERR_ARGUMENT;
    if (max_tools > 0 && net->n_surface == 0)
        return PALP_ERR_UNSUPPORTED;
    palp_status status = make(net, max_tools, max_held, s, &load);
    if (status)
        return status;
    status = network_set_load(net, load, load_memory_size(load));
    if (status)
        network_load_free(load);
    return status;
}

/* ---- tools --------------------------------------------------------------------------------------- */

static bool tool_sound(const palp_tool *t) {
    if (!finite3(t->position_m) || !(t->friction >= 0.0) || !isfinite(t->friction))
        return false;
    if (t->shape != PALP_TOOL_PLANE && !positive(t->radius_m))
        return false;
    if (t->shape == PALP_TOOL_CAPSULE && !(t->length_m >= 0.0 && isfinite(t->length_m)))
        return false;
    return t->shape == PALP_TOOL_SPHERE || fabs(sqrt(dot3(t->axis, t->axis)) - 1.0) < 1e-6;
}

palp_status palp_network_set_tools(palp_network *net, size_t n, const palp_tool *tools) {
    if (!net->load || n > net->load->max_tools || (n > 0 && !tools))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (tools[i].shape > PALP_TOOL_PLANE || !tool_sound(&tools[i]))
            return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        palp_tool *t = &net->load->tool[i];
        *t = tools[i];
        if (t->shape == PALP_TOOL_SPHERE)
            t->axis[0] = t->axis[1] = t->axis[2] = 0.0;
    }
    net->load->n_tools = n;
    return PALP_OK;
}

palp_status palp_network_tool_force(const palp_network *net, palp_tool_force *force) {
    if (!net->load || !force)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < net->load->n_tools; i++) {
        bool stepped = i < load_memory_of(&net->now)->n_tools;
        force[i] = stepped ? load_tools(&net->now)[i].felt : (palp_tool_force){.contacts = 0};
    }
    return PALP_OK;
}

/* ---- held nodes ---------------------------------------------------------------------------------- */

static load_hold *find_hold(const palp_network *net, int32_t node) {
    load_hold *hold = load_holds(net->load, &net->now);
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++)
        if (hold[i].node == node)
            return &hold[i];
    return NULL;
}

static bool nodes_sound(const palp_network *net, size_t n, const int32_t *nodes) {
    if (!net->load || (n > 0 && !nodes))
        return false;
    for (size_t i = 0; i < n; i++)
        if (nodes[i] < 0 || (size_t)nodes[i] >= net->n_nodes)
            return false;
    return true;
}

palp_status palp_network_hold(palp_network *net, size_t n, const int32_t *nodes, const double *target_m) {
    if (!nodes_sound(net, n, nodes) || (n > 0 && !target_m))
        return PALP_ERR_ARGUMENT;
    load_memory *memory = load_memory_of(&net->now);
    size_t room = net->load->max_held - memory->n_holds;
    for (size_t i = 0; i < n; i++) {
        if (!finite3(target_m + 3 * i))
            return PALP_ERR_ARGUMENT;
        if (!find_hold(net, nodes[i]) && room-- == 0)
            return PALP_ERR_LIMIT;
    }
    for (size_t i = 0; i < n; i++) {
        load_hold *hold = find_hold(net, nodes[i]);
        if (!hold) {
            hold = &load_holds(net->load, &net->now)[memory->n_holds++];
            *hold = (load_hold){.node = nodes[i]};
            memcpy(hold->was, net->now.x + 3 * nodes[i], sizeof hold->was);
        }
        memcpy(hold->target, target_m + 3 * i, sizeof hold->target);
    }
    net->trial = false;
    if (net->cut)
        network_cut_held(net);
    return PALP_OK;
}

palp_status palp_network_release(palp_network *net, size_t n, const int32_t *nodes) {
    if (!nodes_sound(net, n, nodes))
        return PALP_ERR_ARGUMENT;
    load_memory *memory = load_memory_of(&net->now);
    load_hold *all = load_holds(net->load, &net->now);
    for (size_t i = 0; i < n; i++) {
        load_hold *hold = find_hold(net, nodes[i]);
        if (hold) {
            memory->n_holds--;
            memmove(hold, hold + 1, (size_t)(all + memory->n_holds - hold) * sizeof *hold);
        }
    }
    net->trial = false;
    if (net->cut)
        network_cut_held(net);
    return PALP_OK;
}

palp_status palp_network_held_force(const palp_network *net, size_t n, const int32_t *nodes, double force_N[3]) {
    if (!nodes_sound(net, n, nodes) || !force_N)
        return PALP_ERR_ARGUMENT;
    force_N[0] = force_N[1] = force_N[2] = 0.0;
    for (size_t i = 0; i < n; i++) {
        const load_hold *hold = find_hold(net, nodes[i]);
        if (hold)
            along3(force_N, 1.0, hold->force, force_N);
    }
    return PALP_OK;
}
