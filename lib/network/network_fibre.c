/* network_fibre.c: fibres of a region, one mean stretch in each cell or tetrahedron. F is the mean
 * deformation gradient, a the fibre's direction at rest, v = F a and I4 = v.v. The energy per volume at rest
 * is E / 8 (I4 - 1)^2, the standard reinforcing model (Triantafyllidis, Abeyaratne 1983). For small strains
 * it is half of E times the squared strain along a. v is a weighted sum of the corners, so a fibre costs
 * little more than a spring. */
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 8 };

/* The fibres of one region in one solid. */
typedef struct bundle {
    int32_t node[CORNERS];
    double weight[CORNERS];    /* v = sum of weight times corner, 1/m */
    double rest_m3, stiffness; /* the solid's volume; E times the region's part of it, J */
    double v[3], beyond;       /* at the last evaluation: v and I4 - 1 */
} bundle;

typedef struct fibres {
    network_term term;
    size_t corners, n_all, n, changes; /* corners of a solid; surface_changes when those in use were found */
    double squares;                    /* of stiffness times position, at rest, N^2 */
    bundle *all, *bundle; /* [n_all] by regions with fibres, then by solids; [n] of these: with stiffness, and
                             without a cut element */
} fibres;

static void find_used(fibres *t, const palp_network *net) {
    t->n = 0;
    t->squares = 0.0;
    for (size_t i = 0; i < t->n_all; i++) {
        const bundle *b = &t->all[i];
        if (b->stiffness == 0.0 || !network_is_solid_whole(net, t->corners, b->node))
            continue;
        t->bundle[t->n++] = *b;
        for (size_t c = 0; c < t->corners; c++) {
            const double *place = net->rest + 3 * (size_t)b->node[c];
            t->squares += pow(b->stiffness * b->weight[c] * b->weight[c], 2.0) * network_dot(place, place, 3);
        }
    }
    t->changes = net->surface_changes;
}

/* Regions may have changed their places. */
static void find_stiffness(network_term *term, palp_network *net) {
    fibres *t = (fibres *)term;
    bundle *b = t->all;
    size_t corners;
    const int32_t *node;
    const size_t n_solids = mesh_solids(net->mesh, &corners, &node);
    for (size_t r = 0; r < net->n_regions; r++)
        for (size_t i = 0; i < n_solids && net->region[r].given.fibre_Pa > 0.0; i++, b++)
            b->stiffness = net->region[r].given.fibre_Pa * net->region[r].inside[i] * b->rest_m3;
    find_used(t, net);
}

static void evaluate_fibres(network_term *term, palp_network *net) {
    fibres *t = (fibres *)term;
    if (t->changes != net->surface_changes)
        find_used(t, net);
    for (size_t i = 0; i < t->n; i++) {
        bundle *b = &t->bundle[i];
        memset(b->v, 0, sizeof b->v);
        for (size_t c = 0; c < t->corners; c++)
            for (size_t k = 0; k < 3; k++)
                b->v[k] += b->weight[c] * net->next.x[3 * (size_t)b->node[c] + k];
        b->beyond = b->v[0] * b->v[0] + b->v[1] * b->v[1] + b->v[2] * b->v[2] - 1.0;
        for (size_t c = 0; c < t->corners; c++)
            for (size_t k = 0; k < 3; k++)
                net->outer[3 * (size_t)b->node[c] + k] -=
                    0.5 * b->stiffness * b->beyond * b->weight[c] * b->v[k];
    }
    net->outer_squares += t->squares;
}

static bool add_fibre_energy(const network_term *term, const palp_network *net, double *energy) {
    const fibres *t = (const fibres *)term;
    (void)net;
    for (size_t i = 0; i < t->n; i++)
        *energy += 0.125 * t->bundle[i].stiffness * t->bundle[i].beyond * t->bundle[i].beyond;
    return true;
}

/* k = d2W/dv2, symmetric by rows. */
static void find_curvature(const bundle *b, double k[9]) {
    for (size_t i = 0; i < 9; i++)
        k[i] = b->stiffness * (b->v[i / 3] * b->v[i % 3] + (i % 4 == 0 ? 0.5 * b->beyond : 0.0));
}

static void take_part_of_fibre_blocks(const network_term *term, const palp_network *net, size_t part,
                                      size_t parts, network_block_taker take, void *user) {
    const fibres *t = (const fibres *)term;
    double k[9], block[9];
    (void)net;
    for (size_t i = t->n * part / parts; i < t->n * (part + 1) / parts; i++) {
        const bundle *b = &t->bundle[i];
        find_curvature(b, k);
        for (size_t c = 0; c < t->corners; c++)
            for (size_t d = 0; d <= c; d++) {
                for (size_t j = 0; j < 9; j++)
                    block[j] = b->weight[c] * b->weight[d] * k[j];
                take(user, b->node[c], b->node[d], block);
            }
    }
}

static void take_fibre_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                              void *user) {
    take_part_of_fibre_blocks(term, net, 0, 1, take, user);
}

static void multiply_fibre_tangent(const network_term *term, const palp_network *net, const double *u,
                                   double *out) {
    const fibres *t = (const fibres *)term;
    (void)net;
    for (size_t i = 0; i < t->n; i++) {
        const bundle *b = &t->bundle[i];
        double dv[3] = {0.0}, k[9];
        find_curvature(b, k);
        for (size_t c = 0; c < t->corners; c++)
            for (size_t j = 0; j < 3; j++)
                dv[j] += b->weight[c] * u[3 * (size_t)b->node[c] + j];
        const double df[] = {k[0] * dv[0] + k[1] * dv[1] + k[2] * dv[2],
                             k[3] * dv[0] + k[4] * dv[1] + k[5] * dv[2],
                             k[6] * dv[0] + k[7] * dv[1] + k[8] * dv[2]};
        for (size_t c = 0; c < t->corners; c++)
            for (size_t j = 0; j < 3; j++)
                out[3 * (size_t)b->node[c] + j] += b->weight[c] * df[j];
    }
}

#define FIBRES_OF(corners)                                                                                   \
    {                                                                                                        \
        .reset = find_stiffness, .evaluate = evaluate_fibres, .blocks = take_fibre_blocks,                   \
        .times = multiply_fibre_tangent, .energy = add_fibre_energy, .spread = (corners),                    \
        .blocks_part = take_part_of_fibre_blocks                                                             \
    }
static const network_term_kind IN_TETRAHEDRA = FIBRES_OF(4), IN_CELLS = FIBRES_OF(CORNERS);

bool network_has_fibres(const palp_network *net) {
    return network_find_term(net, &IN_CELLS) || network_find_term(net, &IN_TETRAHEDRA);
}

/* Derivatives of a solid's shape functions along a, in its middle. The edges' means there, e, are what unit
 * steps of the corners' own coordinates become: a = sum of part e, and each edge is a sum of corners. */
static bool find_weights(const double *rest, size_t corners, const double a[3], bundle *b) {
    double edge[3][3] = {{0.0}}, sign[3][CORNERS] = {{0.0}}, normal[3];
    for (size_t j = 0; j < 3; j++) {
        for (size_t c = 0; c < corners; c++) {
            const size_t axes = c ^ (c >> 1 & 1); /* of Gmsh's corners: bits of x, y, z */
            if (corners == CORNERS)
                sign[j][c] = axes >> j & 1 ? 0.25 : -0.25;
            else
                sign[j][c] = c == 0 ? -1.0 : c == j + 1;
            for (size_t k = 0; k < 3; k++)
                edge[j][k] += sign[j][c] * rest[3 * (size_t)b->node[c] + k];
        }
    }
    for (size_t j = 0; j < 3; j++) {
        const double *f = edge[(j + 1) % 3], *g = edge[(j + 2) % 3];
        for (size_t k = 0; k < 3; k++)
            normal[k] = f[(k + 1) % 3] * g[(k + 2) % 3] - f[(k + 2) % 3] * g[(k + 1) % 3];
        const double six = network_dot(normal, edge[j], 3);
        if (six == 0.0)
            return false;
        for (size_t c = 0; c < corners; c++)
            b->weight[c] += network_dot(normal, a, 3) / six * sign[j][c];
    }
    return true;
}

static palp_status list_bundles(fibres *t, const palp_network *net, const int32_t *node, size_t n_solids,
                                const double *volume) {
    bundle *b = t->all;
    for (size_t r = 0; r < net->n_regions; r++) {
        const palp_region *given = &net->region[r].given;
        const double length = sqrt(network_dot(given->fibre, given->fibre, 3));
        const double a[] = {given->fibre[0] / length, given->fibre[1] / length, given->fibre[2] / length};
        for (size_t i = 0; i < n_solids && given->fibre_Pa > 0.0; i++, b++) {
            memcpy(b->node, node + t->corners * i, t->corners * sizeof *node);
            b->rest_m3 = volume[i];
            if (!(volume[i] > 0.0) || !find_weights(net->rest, t->corners, a, b) ||
                !network_is_solid_joined(net->mesh, t->corners, b->node))
                return PALP_ERR_UNSUPPORTED;
        }
    }
    return PALP_OK;
}

palp_status network_add_fibres(palp_network *net) {
    size_t corners, n_regions = 0;
    const int32_t *node;
    const size_t n_solids = mesh_solids(net->mesh, &corners, &node);
    for (size_t r = 0; r < net->n_regions; r++)
        n_regions += net->region[r].given.fibre_Pa > 0.0;
    if (n_regions == 0)
        return PALP_OK;
    if (n_solids == 0)
        return PALP_ERR_UNSUPPORTED;
    fibres *t = network_term_new(corners == CORNERS ? &IN_CELLS : &IN_TETRAHEDRA, sizeof *t);
    double *volume = calloc(n_solids + net->mesh->n_tetrahedra + n_solids, sizeof *volume);
    palp_status status = t && volume ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        t->corners = corners;
        t->n_all = n_regions * n_solids;
        t->all = arena_take(&t->term.memory, t->n_all, sizeof *t->all);
        t->bundle = arena_take(&t->term.memory, t->n_all, sizeof *t->bundle);
        status = t->all && t->bundle ? PALP_OK : PALP_ERR_NO_MEMORY;
    }
    if (!status) {
        mesh_parts_of_solids(net->mesh, volume + n_solids, volume + n_solids + net->mesh->n_tetrahedra,
                             volume);
        status = list_bundles(t, net, node, n_solids, volume);
    }
    free(volume);
    if (status && t)
        network_term_free(&t->term);
    return status ? status : network_add_terms(net, 1, (network_term *[]){&t->term});
}
