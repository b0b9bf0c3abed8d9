/* mesh_surface.c: cells of a mesh as tetrahedra, their neighbours, and the triangles of its surface. */
#include "mesh_internal.h"

#include <stdlib.h>
#include <string.h>

/* Faces of a tetrahedron of positive volume: face f is opposite corner f, outward. */
static const unsigned char face_corner[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

void mesh_face(const int32_t tetrahedron[4], size_t f, int32_t triangle[3]) {
    for (size_t i = 0; i < 3; i++)
        triangle[i] = tetrahedron[face_corner[f][i]];
}

double mesh_volume6(const double *x, const int32_t t[4]) {
    const double *a = x + 3 * t[0];
    double u[3][3];
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            u[i][k] = x[3 * t[i + 1] + (int32_t)k] - a[k];
    return u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
           u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
           u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
}

/* Reverses those of n tetrahedra that have negative volume. */
static void orient_tetrahedra(const double *x, size_t n, int32_t *t) {
    double volume = 0.0;
    for (size_t i = 0; i < n; i++)
        volume += mesh_volume6(x, t + 4 * i);
    for (size_t i = 0; i < n && volume < 0.0; i++) {
        int32_t third = t[4 * i + 2];
        t[4 * i + 2] = t[4 * i + 3];
        t[4 * i + 3] = third;
    }
}

/* Six tetrahedra from the lowest node to the faces that it is not on. Each face is split at its own lowest
 * node, so that neighbours agree (Dompierre et al. 1999). In a lattice these are Kuhn's. */
static void split_hexahedron(const int32_t node[8], int32_t *t) {
    static const unsigned char faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    int32_t lowest = node[0];
    for (size_t i = 1; i < 8; i++)
        lowest = node[i] < lowest ? node[i] : lowest;
    for (size_t f = 0; f < 6; f++) {
        int32_t quad[4];
        size_t first = 0;
        for (size_t i = 0; i < 4; i++) {
            quad[i] = node[faces[f][i]];
            first = quad[i] < quad[first] ? i : first;
        }
        if (quad[first] == lowest)
            continue;
        for (size_t i = 1; i < 3; i++) {
            const int32_t corners[4] = {lowest, quad[first], quad[(first + i) % 4],
                                        quad[(first + i + 1) % 4]};
            memcpy(t, corners, sizeof corners);
            t += 4;
        }
    }
}

void mesh_split_cell(palp_mesh *mesh, int n, const int32_t *node) {
    int32_t *t = mesh->tetrahedra + 4 * mesh->n_tetrahedra;
    size_t made = n == 4 ? 1 : 6;
    if (n == 4)
        memcpy(t, node, 4 * sizeof *t);
    else {
        split_hexahedron(node, t);
        memcpy(mesh->hexahedra + 8 * mesh->n_hexahedra++, node, 8 * sizeof *node);
    }
    orient_tetrahedra(mesh->x_m, made, t);
    mesh->n_tetrahedra += made;
}

/* The nodes of face f, ascending. */
static void sorted_nodes_of_face(const int32_t *t, size_t f, int32_t node[3]) {
    mesh_face(t, f, node);
    for (size_t i = 1; i < 3; i++)
        for (size_t j = i; j > 0 && node[j] < node[j - 1]; j--) {
            int32_t swap = node[j];
            node[j] = node[j - 1];
            node[j - 1] = swap;
        }
}

/* Pairs the faces of one lowest node. face[n]: 4 tetrahedron + face; key[2 n]: their other two nodes. */
static void pair_faces_of_lowest_node(size_t n, const int32_t *face, const int32_t *key, int32_t *neighbour) {
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n && neighbour[face[i]] < 0; j++)
            if (key[2 * j] == key[2 * i] && key[2 * j + 1] == key[2 * i + 1] && neighbour[face[j]] < 0) {
                neighbour[face[i]] = face[j] / 4;
                neighbour[face[j]] = face[i] / 4;
            }
}

palp_status mesh_neighbours(const palp_mesh *mesh, int32_t *neighbour) {
    size_t n_faces = 4 * mesh->n_tetrahedra;
    if (n_faces > INT32_MAX)
        return PALP_ERR_LIMIT;
    size_t *first = calloc(mesh->n_nodes + 2, sizeof *first);
    int32_t *face = malloc((n_faces + 1) * sizeof *face), *key = malloc((2 * n_faces + 1) * sizeof *key),
            node[3];
    bool ok = first && face && key;
    for (size_t i = 0; i < n_faces && ok; i++) { /* counting sort by lowest node */
        sorted_nodes_of_face(mesh->tetrahedra + i / 4 * 4, i % 4, node);
        first[node[0] + 2]++;
        neighbour[i] = -1;
    }
    for (size_t i = 2; i < mesh->n_nodes + 2 && ok; i++)
        first[i] += first[i - 1];
    for (size_t i = 0; i < n_faces && ok; i++) {
        sorted_nodes_of_face(mesh->tetrahedra + i / 4 * 4, i % 4, node);
        size_t at = first[node[0] + 1]++;
        face[at] = (int32_t)i;
        key[2 * at] = node[1];
        key[2 * at + 1] = node[2];
    }
    for (size_t i = 0; i < mesh->n_nodes && ok; i++)
        pair_faces_of_lowest_node(first[i + 1] - first[i], face + first[i], key + 2 * first[i], neighbour);
    free(first);
    free(face);
    free(key);
    return ok ? PALP_OK : PALP_ERR_NO_MEMORY;
}

palp_status mesh_add_surface(palp_mesh *mesh) {
    size_t n_faces = 4 * mesh->n_tetrahedra, n = 0;
    int32_t *neighbour = malloc((n_faces + 1) * sizeof *neighbour);
    palp_status status = neighbour ? mesh_neighbours(mesh, neighbour) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n_faces && !status; i++)
        n += neighbour[i] < 0;
    if (!status)
        mesh->triangles = arena_take(&mesh->memory, 3 * n, sizeof *mesh->triangles);
    if (!status && !mesh->triangles)
        status = PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n_faces && !status; i++)
        if (neighbour[i] < 0)
            mesh_face(mesh->tetrahedra + i / 4 * 4, i % 4, mesh->triangles + 3 * mesh->n_triangles++);
    free(neighbour);
    return status;
}

size_t palp_mesh_tetrahedron_count(const palp_mesh *mesh) {
    return mesh ? mesh->n_tetrahedra : 0;
}

const int32_t *palp_mesh_tetrahedra(const palp_mesh *mesh) {
    return mesh ? mesh->tetrahedra : NULL;
}

size_t palp_mesh_triangle_count(const palp_mesh *mesh) {
    return mesh ? mesh->n_triangles : 0;
}

const int32_t *palp_mesh_triangles(const palp_mesh *mesh) {
    return mesh ? mesh->triangles : NULL;
}
