/* cut_surface.c: the surface after cuts, for drawing and contact. */
#include "cut_internal.h"
#include "mesh/mesh_internal.h"

#include <string.h>

/* Visits the elements along the edges of tetrahedra: counts the tetrahedra around each or, with fill, lists
 * them. */
static void visit_tetrahedra_of_edges(const palp_network *net, cut_surface *s, bool fill) {
    for (size_t i = 0; i < 6 * s->n_tetrahedra; i++) {
        static const unsigned char ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
        const int32_t *t = s->tetrahedra + i / 6 * 4;
        size_t element = palp_mesh_element_between(net->mesh, t[ends[i % 6][0]], t[ends[i % 6][1]]);
        if (element < net->n_elements && fill)
            s->around[--s->first[element]] = (int32_t)(i / 6);
        else if (element < net->n_elements)
            s->first[element]++;
    }
}

palp_status cut_surface_create(const palp_network *net, arena *memory, cut_surface *s) {
    size_t n = s->n_tetrahedra = palp_mesh_tetrahedron_count(net->mesh);
    s->tetrahedra = palp_mesh_tetrahedra(net->mesh);
    s->broken = arena_take(memory, n, sizeof *s->broken);
    s->first = arena_take(memory, net->n_elements + 1, sizeof *s->first);
    s->around = arena_take(memory, 6 * n, sizeof *s->around);
    s->neighbour = arena_take(memory, 4 * n, sizeof *s->neighbour);
    s->triangles = arena_take(memory, 12 * n, sizeof *s->triangles);
    if (memory->failed)
        return PALP_ERR_NO_MEMORY;
    visit_tetrahedra_of_edges(net, s, false);
    for (size_t i = 0; i < net->n_elements;
         i++) /* first becomes the end of each list; filling moves it back to the start */
        s->first[i + 1] += s->first[i];
    visit_tetrahedra_of_edges(net, s, true);
    return mesh_neighbours(net->mesh, s->neighbour);
}

void cut_surface_whole(cut_surface *s) {
    memset(s->broken, 0, s->n_tetrahedra);
}

void cut_surface_update(cut_surface *s, size_t n, const int32_t *elements) {
    for (size_t k = 0; k < n; k++)
        for (size_t j = s->first[elements[k]]; j < s->first[elements[k] + 1]; j++)
            s->broken[s->around[j]] = 1;
    s->n_triangles = 0;
    for (size_t i = 0; i < 4 * s->n_tetrahedra; i++) {
        int32_t other = s->neighbour[i];
        if (!s->broken[i / 4] && (other < 0 || s->broken[other]))
            mesh_face(s->tetrahedra + i / 4 * 4, i % 4, s->triangles + 3 * s->n_triangles++);
    }
}
