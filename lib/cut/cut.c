/* cut.c: which elements are cut or torn, which parts are loose, and what cutting adds to the network's
 * equations. */
#include "cut_internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

static const double LOOSE = 1e-3;       /* spring of a loose node, relative to its stiffness at rest */
static const double MECHANISM = 1e-6;   /* the same for the diagonal of any other node */
static const double SMALL_STRAIN = 0.1; /* strain at which stiffness is taken, as a law may start from 0 */

/* A part is loose unless one of its nodes has a supported axis or is grasped. */
static void find_loose_parts(network_term *term, palp_network *net) {
    network_cut *cut = (network_cut *)term;
    mesh_parts(net->n_nodes, net->n_elements, net->pair, cut->alive, cut->root);
    for (size_t i = 0; i < net->n_nodes; i++)
        cut->fixed[i] = net->dof[3 * i] < 0 || net->dof[3 * i + 1] < 0 || net->dof[3 * i + 2] < 0;
    NETWORK_EACH_TERM(net, grasped, cut->fixed);
    memset(cut->loose, 1, net->n_nodes);
    for (size_t i = 0; i < net->n_nodes; i++)
        if (cut->fixed[i])
            cut->loose[cut->root[i]] = 0;
    cut->n_loose = 0;
    for (size_t i = 0; i < net->n_nodes;
         i++) { /* a root is the lowest node of its part, so its flag is final */
        cut->loose[i] = cut->loose[cut->root[i]];
        cut->n_loose += cut->loose[i];
        cut->diagonal[i] = cut->n_cut == 0 ? 0.0 : cut->stiffness[i] * (cut->loose[i] ? LOOSE : MECHANISM);
    }
}

double cut_spring(const network_cut *cut, size_t i) {
    return cut->loose[i] ? cut->diagonal[i] : 0.0;
}

/* Marks an element as cut, unless it is cut already. */
static void mark_element_as_cut(network_cut *cut, size_t element) {
    if (!cut->alive[element])
        return;
    cut->alive[element] = 0;
    cut->cut[cut->n_cut++] = (int32_t)element;
}

/* Updates all that depends on elements marked since the last call. The next step starts from the present
 * state. */
static size_t apply_marked_cuts(palp_network *net, network_cut *cut) {
    size_t news = cut->n_cut - cut->n_known;
    for (size_t k = cut->n_known; k < cut->n_cut; k++) {
        size_t i = (size_t)cut->cut[k];
        net->scale[i] = 0.0;
        if (net->now.vector)
            memset(net->now.vector + 3 * i, 0, 3 * sizeof *net->now.vector);
    }
    find_loose_parts(&cut->term, net);
    cut_surface_update(&cut->surface, news, cut->cut + cut->n_known);
    cut->n_known = cut->n_cut;
    net->dead = cut->cut;
    net->n_dead = cut->n_cut;
    net->surface = cut->surface.triangles;
    net->n_surface = cut->surface.n_triangles;
    net->surface_changes++;
    net->n_past = 0;
    net->trial = net->exact = false;
    return news;
}

static void restore_all_elements(palp_network *net, network_cut *cut) {
    cut->n_cut = cut->n_known = 0;
    memset(cut->alive, 1, net->n_elements);
    memcpy(net->scale, cut->whole, net->n_elements * sizeof *net->scale);
    cut_surface_whole(&cut->surface);
}

/* Only alive is saved: all else of a network_cut follows from it. */
static void pass_cut_state(network_term *term, palp_network *net, network_cursor *cursor) {
    network_cut *cut = (network_cut *)term;
    if (cursor->way == NETWORK_RESTORE && memcmp(cut->alive, cursor->at, net->n_elements) != 0) {
        restore_all_elements(net, cut);
        for (size_t i = 0; i < net->n_elements; i++)
            if (!cursor->at[i])
                mark_element_as_cut(cut, i);
        apply_marked_cuts(net, cut);
    }
    network_pass(cursor, cut->alive, net->n_elements);
}

/* Makes all elements whole again, for the present material. */
static void reset_cut_stiffness(network_term *term, palp_network *net) {
    network_cut *cut = (network_cut *)term;
    double stiffness[PALP_REGIONS_MAX + 1];
    network_stiffnesses(net, SMALL_STRAIN, true, stiffness);
    memset(cut->stiffness, 0, net->n_nodes * sizeof *cut->stiffness);
    for (size_t i = 0; i < 2 * net->n_elements; i++)
        cut->stiffness[net->pair[i]] +=
            network_mean_of_materials(net, i / 2, stiffness) * cut->whole[i / 2] * net->inverse_rest[i / 2];
    restore_all_elements(net, cut);
    apply_marked_cuts(net, cut);
}

static void add_loose_part_residual(const network_term *term, const palp_network *net, double *r,
                                    double *squares) {
    const network_cut *cut = (const network_cut *)term;
    for (size_t i = 0; i < 3 * net->n_nodes && cut->n_loose > 0; i++) {
        if (net->dof[i] < 0)
            continue;
        double spring = cut_spring(cut, i / 3);
        r[i] -= spring * (net->next.x[i] - net->now.x[i]);
        *squares += spring * net->next.x[i] * spring * net->next.x[i];
    }
}

static void add_loose_part_diagonal(const network_term *term, const palp_network *net, double *d) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        d[i] += ((const network_cut *)term)->diagonal[i / 3];
}

static bool add_loose_part_energy(const network_term *term, const palp_network *net, double *energy) {
    const network_cut *cut = (const network_cut *)term;
    for (size_t i = 0; i < 3 * net->n_nodes && cut->n_loose > 0; i++) {
        double moved = net->next.x[i] - net->now.x[i];
        *energy += 0.5 * cut_spring(cut, i / 3) * moved * moved;
    }
    return true;
}

static const network_term_kind CUT = {.reset = reset_cut_stiffness,
                                      .pass = pass_cut_state,
                                      .residual = add_loose_part_residual,
                                      .diagonal = add_loose_part_diagonal,
                                      .energy = add_loose_part_energy,
                                      .grasp_changed = find_loose_parts};

network_cut *cut_of(const palp_network *net) {
    return (network_cut *)network_find_term(net, &CUT);
}

static palp_status allocate_cut_arrays(const palp_network *net, network_cut *cut) {
    size_t n = net->n_nodes, m = net->n_elements;
    arena *memory = &cut->term.memory;
    cut->alive = arena_take(memory, m, sizeof *cut->alive);
    cut->cut = arena_take(memory, m, sizeof *cut->cut);
    cut->whole = arena_take(memory, m, sizeof *cut->whole);
    cut->fixed = arena_take(memory, n, sizeof *cut->fixed);
    cut->loose = arena_take(memory, n, sizeof *cut->loose);
    cut->root = arena_take(memory, n, sizeof *cut->root);
    cut->side = arena_take(memory, n, sizeof *cut->side);
    cut->stiffness = arena_take(memory, n, sizeof *cut->stiffness);
    cut->diagonal = arena_take(memory, n, sizeof *cut->diagonal);
    return cut_surface_create(net, memory, &cut->surface);
}

static network_cut *create_cut_term(const palp_network *net) {
    network_cut *cut = network_term_new(&CUT, sizeof *cut);
    if (!cut || allocate_cut_arrays(net, cut)) {
        network_term_free((network_term *)cut);
        return NULL;
    }
    for (size_t i = 0; i < net->n_elements; i++)
        cut->whole[i] = net->scale ? net->scale[i] : 1.0;
    return cut;
}

palp_status palp_network_enable_cutting(palp_network *net) {
    if (!net || cut_of(net))
        return PALP_ERR_ARGUMENT;
    if (net->surface_stays || net->ranks)
        return PALP_ERR_UNSUPPORTED;
    network_cut *cut = create_cut_term(net);
    if (!cut)
        return PALP_ERR_NO_MEMORY;
    if (!net->scale) {
        net->scale = arena_take(&net->memory, net->n_elements, sizeof *net->scale);
        if (!net->scale) {
            network_term_free(&cut->term);
            return PALP_ERR_NO_MEMORY;
        }
        memcpy(net->scale, cut->whole, net->n_elements * sizeof *net->scale);
    }
    return network_add_terms(net, 1, (network_term *[]){&cut->term});
}

static palp_status apply_and_count_cuts(palp_network *net, network_cut *cut, size_t *n) {
    size_t news = cut->n_cut > cut->n_known ? apply_marked_cuts(net, cut) : 0;
    if (n)
        *n = news;
    return PALP_OK;
}

static bool are_nine_values_finite(const double *v) {
    double sum = 0.0;
    for (size_t i = 0; i < 9; i++)
        sum += fabs(v[i]);
    return isfinite(sum);
}

palp_status palp_network_cut(palp_network *net, const double corners_m[9], size_t *n_cut) {
    network_cut *cut = net ? cut_of(net) : NULL;
    if (!cut || !corners_m || !are_nine_values_finite(corners_m))
        return PALP_ERR_ARGUMENT;
    const double *x = net->now.x;
    cut_sides(net->n_nodes, x, corners_m, cut->side);
    for (size_t i = 0; i < net->n_elements; i++) {
        int32_t a = net->pair[2 * i], b = net->pair[2 * i + 1];
        if (cut->side[a] * cut->side[b] < 0 && cut_crosses(x + 3 * a, x + 3 * b, corners_m))
            mark_element_as_cut(cut, i);
    }
    return apply_and_count_cuts(net, cut, n_cut);
}

palp_status palp_network_cut_elements(palp_network *net, size_t n, const int32_t *elements) {
    network_cut *cut = net ? cut_of(net) : NULL;
    if (!cut || (n > 0 && !elements))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (elements[i] < 0 || (size_t)elements[i] >= net->n_elements)
            return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        mark_element_as_cut(cut, (size_t)elements[i]);
    return apply_and_count_cuts(net, cut, NULL);
}

palp_status palp_network_set_tearing(palp_network *net, double strain, double force_N) {
    network_cut *cut = net ? cut_of(net) : NULL;
    if (!cut || !(strain >= 0.0 && isfinite(strain)) || !(force_N >= 0.0 && isfinite(force_N)))
        return PALP_ERR_ARGUMENT;
    cut->tear_strain = strain;
    cut->tear_force = force_N;
    return PALP_OK;
}

palp_status palp_network_tear(palp_network *net, size_t *n_torn) {
    network_cut *cut = net ? cut_of(net) : NULL;
    if (!cut)
        return PALP_ERR_ARGUMENT;
    double strain = cut->tear_strain > 0.0 ? cut->tear_strain : INFINITY;
    double force = cut->tear_force > 0.0 ? cut->tear_force : INFINITY;
    for (size_t i = 0; i < net->n_elements; i++)
        if (net->now.history.strain[i] > strain || net->now.element[i] > force)
            mark_element_as_cut(cut, i);
    return apply_and_count_cuts(net, cut, n_torn);
}

const unsigned char *palp_network_alive(const palp_network *net) {
    if (!net)
        return NULL;
    const network_cut *cut = cut_of(net);
    return cut ? cut->alive : NULL;
}

size_t palp_network_loose(const palp_network *net, unsigned char *loose) {
    if (!net)
        return 0;
    const network_cut *cut = cut_of(net);
    if (loose && cut)
        memcpy(loose, cut->loose, net->n_nodes);
    else if (loose)
        memset(loose, 0, net->n_nodes);
    return cut ? cut->n_loose : 0;
}
