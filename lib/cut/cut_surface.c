/* cut_surface.c: the surface of what a cut leaves, for drawing and for contact. */
#include "mesh/mesh_internal.h"
#include "network/network_internal.h"

#include <stdlib.h>

/* The element between two nodes, pairs ascending as lattices and files have them; -1 = none. */
static int32_t element_between(const palp_network *net, int32_t a, int32_t b) {
    int32_t lower = a < b ? a : b, higher = a < b ? b : a;
    size_t low = 0, high = net->n_elements;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const int32_t *pair = net->pair + 2 * middle;
        if (pair[0] < lower || (pair[0] == lower && pair[1] < higher))
            low = middle + 1;
        else
            high = middle;
    }
    bool found = low < net->n_elements && net->pair[2 * low] == lower && net->pair[2 * low + 1] == higher;
    return found ? (int32_t)low : -1;
}

/* Visits the elements along the edges: counts the tetrahedra around each, or (fill) lists them. */
static void visit_edges(const palp_network *net, network_cut *cut, bool fill) {
    for (size_t i = 0; i < 6 * cut->n_tetrahedra; i++) {
        static const unsigned char ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
        const int32_t *t = cut->tetrahedra + i / 6 * 4;
        int32_t element = element_between(net, t[ends[i % 6][0]], t[ends[i % 6][1]]);
        if (element >= 0 && fill)
            cut->around[--cut->first[element]] = (int32_t)(i / 6);
        else if (element >= 0)
            cut->first[element]++;
    }
}

palp_status network_cut_surface_create(const palp_network *net, network_cut *cut) {
    size_t n = cut->n_tetrahedra = palp_mesh_tetrahedron_count(net->mesh);
    cut->tetrahedra = palp_mesh_tetrahedra(net->mesh);
    cut->broken = malloc(n + 1);
    cut->first = calloc(net->n_elements + 1, sizeof *cut->first);
    cut->around = malloc((6 * n + 1) * sizeof *cut->around);
    cut->neighbour = malloc((4 * n + 1) * sizeof *cut->neighbour);
    cut->triangles = malloc((12 * n + 1) * sizeof *cut->triangles);
    if (!cut->broken || !cut->first || !cut->around || !cut->neighbour || !cut->triangles)
        return PALP_ERR_NO_MEMORY;
    visit_edges(net, cut, false);
    for (size_t i = 0; i < net->n_elements; i++) /* each ends where the next starts; listing walks back */
        cut->first[i + 1] += cut->first[i];
    visit_edges(net, cut, true);
    return palp_mesh_neighbours(net->mesh, cut->neighbour);
}

void network_cut_surface_update(network_cut *cut) {
    for (size_t k = cut->n_known; k < cut->n_cut; k++)
        for (size_t j = cut->first[cut->cut[k]]; j < cut->first[cut->cut[k] + 1]; j++)
            cut->broken[cut->around[j]] = 1;
    cut->n_triangles = 0;
    for (size_t i = 0; i < 4 * cut->n_tetrahedra; i++) {
        int32_t other = cut->neighbour[i];
        if (!cut->broken[i / 4] && (other < 0 || cut->broken[other]))
            palp_mesh_face(cut->tetrahedra + i / 4 * 4, i % 4, cut->triangles + 3 * cut->n_triangles++);
    }
}

palp_status palp_network_surface(const palp_network *net, size_t *n, const int32_t **triangles) {
    if (!net || !n || !triangles)
        return PALP_ERR_ARGUMENT;
    *n = net->n_surface;
    *triangles = net->surface;
    return PALP_OK;
}
