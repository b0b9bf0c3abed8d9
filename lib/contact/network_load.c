/* network_load.c: see network_load.h. */
#include "tool_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SLID = 0.1; /* of an edge: a contact point that the solution moved so far is looked for again */
static const double LEAP = 0.1; /* of an edge: a tool that goes further in a step is not followed */

static double square(double x) {
    return x * x;
}

void network_load_free(network_load *load) {
    if (!load)
        return;
    free(load->tool);
    free(load->pose);
    free(load->target);
    free(load->contact);
    free(load->unit);
    free(load->triangles);
    free(load->first);
    free(load->element);
    free(load->force);
    free(load->weight);
    free(load);
}

/* ---- what a state remembers ---------------------------------------------------------------------- */

load_memory *load_memory_of(const network_state *state) {
    return state->load;
}

load_tool *load_tools(const network_state *state) {
    return (load_tool *)(load_memory_of(state) + 1);
}

load_hold *load_holds(const network_load *load, const network_state *state) {
    return (load_hold *)(load_tools(state) + load->max_tools);
}

load_touch *load_touches(const network_load *load, const network_state *state) {
    return (load_touch *)(load_holds(load, state) + load->max_held);
}

size_t load_memory_size(const network_load *load) {
    return sizeof(load_memory) + load->max_tools * sizeof(load_tool) + load->max_held * sizeof(load_hold) +
           load->max_contacts * sizeof(load_touch);
}

/* ---- a step -------------------------------------------------------------------------------------- */

/* The surface's triangles in each node; after a cut they are others. */
static void count_triangles(palp_network *net) {
    network_load *load = net->load;
    memset(load->triangles, 0, net->n_nodes * sizeof *load->triangles);
    for (size_t i = 0; i < 3 * net->n_surface; i++)
        load->triangles[net->surface[i]]++;
    load->surface_changes = net->surface_changes;
}

/* Tools and hands at a share of their way, contacts as they are then at x. A new tool comes from nowhere: it
 * hardens. */
static void place(palp_network *net, double share, const double *x) {
    network_load *load = net->load;
    const load_memory *memory = load_memory_of(&net->now);
    const load_hold *hold = load_holds(load, &net->now);
    load->share = share;
    for (size_t i = 0; i < load->n_tools; i++) {
        palp_tool *pose = &load->pose[i];
        const palp_tool *was = &load_tools(&net->now)[i].pose;
        *pose = load->tool[i];
        if (share == 1.0 || i >= memory->n_tools || was->shape != pose->shape)
            continue;
        for (int k = 0; k < 3; k++) {
            pose->position_m[k] = (1.0 - share) * was->position_m[k] + share * pose->position_m[k];
            pose->axis[k] = (1.0 - share) * was->axis[k] + share * pose->axis[k];
        }
        double length = sqrt(dot3(pose->axis, pose->axis));
        for (int k = 0; k < 3 && pose->shape != PALP_TOOL_SPHERE; k++)
            pose->axis[k] = length > 1e-3 ? pose->axis[k] / length : load->tool[i].axis[k];
    }
    for (size_t i = 0; i < memory->n_holds; i++)
        for (size_t k = 0; k < 3; k++)
            load->target[3 * i + k] = share * hold[i].target[k] + (1.0 - share) * hold[i].was[k];
    contact_find(net, x);
}

void network_load_begin(palp_network *net) {
    network_load *load = net->load;
    if (load->surface_changes != net->surface_changes)
        count_triangles(net);
    palp_law_stiffness(&net->material.law, 0.0, &load->modulus, NULL);
    for (size_t j = 0; j < net->material.n_arms; j++)
        load->modulus += net->material.arms[j].stiffness_N;
    place(net, 1.0, net->now.x);
}

bool network_load_moved(const palp_network *net) {
    const network_load *load = net->load;
    const load_memory *memory = load_memory_of(&net->now);
    if (load->n_tools > memory->n_tools)
        return true;
    for (size_t i = 0; i < load->n_tools; i++) {
        const palp_tool *was = &load_tools(&net->now)[i].pose;
        if (memcmp(was->position_m, load->tool[i].position_m, sizeof was->position_m) != 0 ||
            memcmp(was->axis, load->tool[i].axis, sizeof was->axis) != 0)
            return true;
    }
    for (size_t i = 0; i < memory->n_holds; i++) {
        const load_hold *hold = &load_holds(load, &net->now)[i];
        if (memcmp(hold->was, hold->target, sizeof hold->was) != 0)
            return true;
    }
    return false;
}

void network_load_place(palp_network *net, double share) {
    place(net, share, net->next.x);
}

/* Least move of its corners by which a contact's point comes to where the tool took it, along the push. */
static void follow(palp_network *net, contact *c) {
    network_load *load = net->load;
    double point[3], squares = 0.0;
    contact_measure(&load->pose[c->tool], c, net->next.x);
    if (c->depth > 0.0)
        return;
    contact_point(c, c->grip, net->next.x, point);
    along3(c->anchor, -1.0, point, point);
    for (int j = 0; j < c->corners; j++)
        squares += square(c->grip[j]);
    double size = dot3(c->push, point) / squares;
    if (fabs(size) > LEAP * load->edge)
        return;
    for (int j = 0; j < c->corners; j++) {
        double weight = c->grip[j] * c->stiffness, *move = load->force + 3 * c->node[j];
        along3(move, weight * c->grip[j] * size, c->push, move);
        load->weight[c->node[j]] += weight;
    }
}

void network_load_follow(palp_network *net) {
    network_load *load = net->load;
    memset(load->force, 0, 3 * net->n_nodes * sizeof *load->force);
    memset(load->weight, 0, net->n_nodes * sizeof *load->weight);
    for (size_t i = 0; i < load->n_contacts; i++)
        if (load->contact[i].touched)
            follow(net, &load->contact[i]);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0 && load->weight[i / 3] > 0.0)
            net->next.x[i] += load->force[i] / load->weight[i / 3];
}

bool network_load_refresh(palp_network *net) {
    const network_load *load = net->load;
    bool slid = false;
    for (size_t i = 0; i < load->n_contacts && !slid; i++)
        slid = load->contact[i].depth > 0.0 && contact_slid(net, &load->contact[i]) > SLID * load->edge;
    if (slid)
        contact_find(net, net->next.x);
    return slid;
}

/* ---- forces and tangent -------------------------------------------------------------------------- */

double load_hold_stiffness(const network_load *load, int32_t node) {
    return load->settings.hold_stiffness * load->modulus * load->unit[node];
}

static void add_contacts(palp_network *net) {
    network_load *load = net->load;
    for (size_t i = 0; i < load->n_contacts; i++) {
        contact *c = &load->contact[i];
        contact_evaluate(net, c);
        if (!(c->depth > 0.0))
            continue;
        for (int j = 0; j < c->corners; j++) {
            double *f = load->force + 3 * c->node[j];
            along3(f, c->share[j] * c->pressure, c->push, f);
            along3(f, c->grip[j], c->rub, f);
        }
        load->size += square(c->stiffness) * dot3(c->point, c->point);
    }
}

void network_load_evaluate(palp_network *net) {
    network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    load->size = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        load->force[i] = net->mass ? net->mass[i / 3] * load->settings.gravity_m_s2[i % 3] : 0.0;
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++) {
        const double *x = net->next.x + 3 * hold[i].node, stiffness = load_hold_stiffness(load, hold[i].node);
        for (size_t k = 0; k < 3; k++)
            load->force[3 * (size_t)hold[i].node + k] += stiffness * (load->target[3 * i + k] - x[k]);
        load->size += square(stiffness) * dot3(x, x);
    }
    add_contacts(net);
}

const double *network_load_force(const network_load *load) {
    return load->force;
}

double network_load_size(const network_load *load) {
    return load->size;
}

/* The element between two nodes, or n_elements. */
static size_t element_between(const palp_network *net, int32_t a, int32_t b) {
    const network_load *load = net->load;
    for (size_t i = load->first[a]; i < load->first[a + 1]; i++) {
        size_t e = (size_t)load->element[i];
        if (net->pair[2 * e] == b || net->pair[2 * e + 1] == b)
            return e;
    }
    return net->n_elements;
}

static void add_own(palp_network *net, int32_t node, const double k[9]) {
    double *value = linsys_values(net->ls);
    const uint32_t *slot = net->slot_node + 6 * (size_t)node;
    for (int row = 0; row < 3; row++)
        for (int col = 0; col <= row; col++)
            value[*slot++] += k[3 * row + col];
}

/* k of corner a by corner b; an element's slots are of its second node by its first. */
static void add_pair(palp_network *net, int32_t a, int32_t b, const double k[9]) {
    size_t e = element_between(net, a, b);
    if (e == net->n_elements)
        return;
    double *value = linsys_values(net->ls);
    for (int i = 0; i < 9; i++)
        value[net->slot[9 * e + (size_t)i]] += net->pair[2 * e] == b ? k[i] : k[3 * (i % 3) + i / 3];
}

void network_load_assemble(palp_network *net) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    double k[9] = {0.0};
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++) {
        k[0] = k[4] = k[8] = load_hold_stiffness(load, hold[i].node);
        add_own(net, hold[i].node, k);
    }
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        for (int a = 0; a < c->corners && c->depth > 0.0; a++)
            for (int b = 0; b <= a; b++) {
                contact_block(c, a, b, k);
                if (a == b)
                    add_own(net, c->node[a], k);
                else
                    add_pair(net, c->node[a], c->node[b], k);
            }
    }
}

/* Own blocks and couplings of one contact; without room for those, all on the own blocks. */
static size_t contact_blocks(const contact *c, double *block, size_t room, load_coupling *coupling) {
    static const int lower[6] = {0, 3, 4, 6, 7, 8};
    size_t n = 0;
    bool lump = room < 3;
    for (int a = 0; a < c->corners; a++)
        for (int b = 0; b < c->corners; b++) {
            double k[9];
            contact_block(c, a, b, k);
            if (a == b || lump)
                for (int i = 0; i < 6; i++)
                    block[6 * c->node[a] + i] += k[lower[i]];
            else if (b < a) {
                coupling[n] = (load_coupling){.row = c->node[a], .column = c->node[b]};
                memcpy(coupling[n++].block, k, sizeof k);
            }
        }
    return n;
}

size_t network_load_blocks(const palp_network *net, double *block, size_t max, load_coupling *coupling) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    size_t n = 0;
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++) {
        double *b = block + 6 * hold[i].node, stiffness = load_hold_stiffness(load, hold[i].node);
        b[0] += stiffness;
        b[2] += stiffness;
        b[5] += stiffness;
    }
    for (size_t i = 0; i < load->n_contacts; i++)
        if (load->contact[i].depth > 0.0)
            n += contact_blocks(&load->contact[i], block, max - n, coupling + n);
    return n;
}

void network_load_times(const palp_network *net, const double *u, double *out) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++) {
        double *o = out + 3 * hold[i].node;
        along3(o, load_hold_stiffness(load, hold[i].node), u + 3 * hold[i].node, o);
    }
    for (size_t i = 0; i < load->n_contacts; i++) {
        if (load->contact[i].depth > 0.0)
            contact_times(&load->contact[i], u, out);
    }
}

/* pull[9]: of a contact, -d force on its corners times u. */
static void contact_pull(const contact *c, const double *u, double pull[9]) {
    memset(pull, 0, 9 * sizeof *pull);
    for (int a = 0; a < c->corners; a++)
        for (int b = 0; b < c->corners; b++) {
            double k[9];
            contact_block(c, a, b, k);
            for (int i = 0; i < 9; i++)
                pull[3 * a + i / 3] += k[i] * u[3 * c->node[b] + i % 3];
        }
}

void network_load_drive(const palp_network *net, double *column) {
    const network_load *load = net->load;
    double pull[9];
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        if (!(c->depth > 0.0))
            continue;
        contact_pull(c, net->motion, pull);
        for (int j = 0; j < 3 * c->corners; j++) {
            int32_t unknown = net->dof[3 * c->node[j / 3] + j % 3];
            if (unknown >= 0)
                column[unknown] -= pull[j];
        }
    }
}

double network_load_curvature(const palp_network *net, const double *u) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    double sum = 0.0, pull[9];
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++)
        sum += load_hold_stiffness(load, hold[i].node) * dot3(u + 3 * hold[i].node, u + 3 * hold[i].node);
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        if (!(c->depth > 0.0))
            continue;
        contact_pull(c, u, pull);
        for (int j = 0; j < 3 * c->corners; j++)
            sum += pull[j] * u[3 * c->node[j / 3] + j % 3];
    }
    return sum;
}

bool network_load_energy(const palp_network *net, double *energy) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        if (!(c->depth > 0.0))
            continue;
        if (load->pose[c->tool].friction > 0.0)
            return false;
        *energy += contact_energy(load, c);
    }
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++) {
        double away[3];
        along3(net->next.x + 3 * hold[i].node, -1.0, load->target + 3 * i, away);
        *energy += 0.5 * load_hold_stiffness(load, hold[i].node) * dot3(away, away);
    }
    for (size_t i = 0; i < net->n_nodes && net->mass; i++) {
        double away[3];
        along3(net->next.x + 3 * i, -1.0, net->rest + 3 * i, away);
        *energy -= net->mass[i] * dot3(load->settings.gravity_m_s2, away);
    }
    return true;
}

/* ---- a residual that is left --------------------------------------------------------------------- */

/* weight[node] of what is touched or held: stiffness of all that acts on it, N/m. */
static void weigh(const palp_network *net) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    for (size_t i = 0; i < load->n_contacts; i++)
        for (int j = 0; j < load->contact[i].corners; j++)
            load->weight[load->contact[i].node[j]] = 0.0;
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++)
        load->weight[hold[i].node] = load_hold_stiffness(load, hold[i].node);
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++)
            load->weight[c->node[j]] += c->share[j] * c->stiffness;
    }
}

/* Share of a node's residual that a corner of a contact takes. */
static double corner_part(const network_load *load, const contact *c, int corner) {
    double weight = load->weight[c->node[corner]];
    return weight > 0.0 ? c->share[corner] * c->stiffness / weight : 0.0;
}

static double hold_part(const network_load *load, int32_t node) {
    return load_hold_stiffness(load, node) / load->weight[node];
}

double network_load_own_stiffness(const palp_network *net) {
    const network_load *load = net->load;
    const load_hold *hold = load_holds(load, &net->now);
    double sum = 0.0;
    weigh(net);
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++)
        sum += hold_part(load, hold[i].node) * load->unit[hold[i].node];
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++)
            sum += corner_part(load, c, j) * load->unit[c->node[j]];
    }
    return 3.0 * load->modulus * sum;
}

/* ---- the end of a step --------------------------------------------------------------------------- */

/* Force on the tissue at a point of it, as the tool feels it. */
static void feel(const palp_tool *pose, const double point[3], double size, const double force[3],
                 palp_tool_force *felt) {
    double arm[3], moment[3];
    along3(point, -1.0, pose->position_m, arm);
    cross3(arm, force, moment);
    along3(felt->force_N, -size, force, felt->force_N);
    along3(felt->moment_Nm, -size, moment, felt->moment_Nm);
}

static void feel_contact(const palp_network *net, const contact *c, palp_tool_force *felt) {
    const palp_tool *pose = &net->load->pose[c->tool];
    double held[3];
    contact_point(c, c->grip, net->next.x, held);
    feel(pose, c->point, c->pressure, c->push, felt);
    feel(pose, held, 1.0, c->rub, felt);
    felt->contacts++;
    felt->depth_m = fmax(felt->depth_m, c->depth);
}

void network_load_finish(palp_network *net) {
    const network_load *load = net->load;
    const load_memory *old = load_memory_of(&net->now);
    load_memory *memory = load_memory_of(&net->next);
    load_tool *tool = load_tools(&net->next);
    load_hold *hold = load_holds(load, &net->next);
    load_touch *touch = load_touches(load, &net->next);
    memory->n_tools = load->n_tools;
    memory->n_holds = old->n_holds;
    memory->n_touches = 0;
    for (size_t i = 0; i < load->n_tools; i++)
        tool[i] = (load_tool){.pose = load->pose[i]};
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        if (!(c->depth > 0.0))
            continue;
        feel_contact(net, c, &tool[c->tool].felt);
        load_touch *t = &touch[memory->n_touches++];
        t->tool = c->tool;
        memcpy(t->node, c->node, sizeof t->node);
        memcpy(t->stretch, c->stretch, sizeof t->stretch);
    }
    memcpy(hold, load_holds(load, &net->now), old->n_holds * sizeof *hold);
    for (size_t i = 0; i < old->n_holds; i++) {
        double away[3], none[3] = {0.0};
        memcpy(hold[i].was, load->target + 3 * i, sizeof hold[i].was);
        along3(net->next.x + 3 * hold[i].node, -1.0, hold[i].was, away);
        along3(none, load_hold_stiffness(load, hold[i].node), away, hold[i].force);
    }
}

void network_load_settle(palp_network *net, const double *residual) {
    const network_load *load = net->load;
    load_tool *tool = load_tools(&net->next);
    load_hold *hold = load_holds(load, &net->next);
    weigh(net);
    for (size_t i = 0; i < load->n_contacts; i++) {
        const contact *c = &load->contact[i];
        for (int j = 0; j < c->corners && c->depth > 0.0; j++) {
            size_t at = 3 * (size_t)c->node[j];
            feel(&load->pose[c->tool], net->next.x + at, -corner_part(load, c, j), residual + at, &tool[c->tool].felt);
        }
    }
    for (size_t i = 0; i < load_memory_of(&net->now)->n_holds; i++)
        along3(hold[i].force, hold_part(load, hold[i].node), residual + 3 * hold[i].node, hold[i].force);
}

void network_load_recall(palp_network *net) {
    network_load *load = net->load;
    load->n_tools = load_memory_of(&net->now)->n_tools;
    for (size_t i = 0; i < load->n_tools; i++)
        load->tool[i] = load_tools(&net->now)[i].pose;
}
