/* mesh.c: particles, the elements between them, and named sets of particles. */
#include "mesh_internal.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_status mesh_new(size_t n_nodes, size_t n_elements, palp_mesh **mesh) {
    if (n_nodes > SIZE_MAX / (3 * sizeof(double)) || n_elements > SIZE_MAX / (2 * sizeof(int32_t)))
        return PALP_ERR_NO_MEMORY;
    palp_mesh *m = calloc(1, sizeof *m);
    if (!m)
        return PALP_ERR_NO_MEMORY;
    m->n_nodes = n_nodes;
    m->n_elements = n_elements;
    m->x_m = arena_take(&m->memory, 3 * n_nodes, sizeof *m->x_m);
    m->pairs = malloc(2 * n_elements * sizeof *m->pairs);
    if (!m->x_m || !m->pairs) {
        palp_mesh_free(m);
        return PALP_ERR_NO_MEMORY;
    }
    *mesh = m;
    return PALP_OK;
}

void palp_mesh_free(palp_mesh *mesh) {
    if (!mesh)
        return;
    arena_free(&mesh->memory);
    free(mesh->sets);
    free(mesh->regions);
    free(mesh->pairs);
    free(mesh);
}

/* A copy of an array, owned by m; NULL if from is NULL or memory is short. */
static void *copy_into_mesh_memory(palp_mesh *m, size_t n, size_t size, const void *from) {
    void *to = from ? arena_take(&m->memory, n, size) : NULL;
    return to ? memcpy(to, from, n * size) : NULL;
}

palp_status mesh_copy(const palp_mesh *mesh, palp_mesh **copy) {
    palp_mesh *m = NULL;
    palp_status status = mesh_new(mesh->n_nodes, mesh->n_elements, &m);
    if (status)
        return status;
    memcpy(m->x_m, mesh->x_m, 3 * mesh->n_nodes * sizeof *m->x_m);
    memcpy(m->pairs, mesh->pairs, 2 * mesh->n_elements * sizeof *m->pairs);
    m->n_tetrahedra = mesh->n_tetrahedra;
    m->n_triangles = mesh->n_triangles;
    m->n_hexahedra = mesh->n_hexahedra;
    m->tetrahedra = copy_into_mesh_memory(m, 4 * m->n_tetrahedra, sizeof *m->tetrahedra, mesh->tetrahedra);
    m->hexahedra = copy_into_mesh_memory(m, 8 * m->n_hexahedra, sizeof *m->hexahedra, mesh->hexahedra);
    m->triangles = copy_into_mesh_memory(m, 3 * m->n_triangles, sizeof *m->triangles, mesh->triangles);
    m->scale = copy_into_mesh_memory(m, m->n_elements, sizeof *m->scale, mesh->scale);
    m->order = copy_into_mesh_memory(m, m->n_elements, sizeof *m->order, mesh->order);
    for (size_t i = 0; i < mesh->n_sets && !m->memory.failed; i++)
        palp_mesh_add_set(m, mesh->sets[i].name, mesh->sets[i].n, mesh->sets[i].nodes);
    for (size_t i = 0; i < mesh->n_regions && !m->memory.failed; i++)
        mesh_take_region(m, mesh->regions[i].name, mesh->regions[i].part);
    if (m->memory.failed || m->n_sets < mesh->n_sets || m->n_regions < mesh->n_regions) {
        palp_mesh_free(m);
        return PALP_ERR_NO_MEMORY;
    }
    *copy = m;
    return PALP_OK;
}

double mesh_direction(const palp_mesh *mesh, const int32_t pair[2], double n[3]) {
    const double *a = mesh->x_m + 3 * (size_t)pair[0], *b = mesh->x_m + 3 * (size_t)pair[1];
    double square = 0.0;
    for (size_t k = 0; k < 3; k++) {
        n[k] = b[k] - a[k];
        square += n[k] * n[k];
    }
    double length = sqrt(square);
    for (size_t k = 0; k < 3; k++)
        n[k] /= length;
    return length;
}

static int compare_node_pairs(const void *left, const void *right) {
    const int32_t *a = left, *b = right;
    if (a[0] != b[0])
        return a[0] < b[0] ? -1 : 1;
    return (a[1] > b[1]) - (a[1] < b[1]);
}

size_t mesh_pairs_unique(size_t n_pairs, int32_t *pairs) {
    for (size_t e = 0; e < n_pairs; e++) {
        int32_t a = pairs[2 * e], b = pairs[2 * e + 1];
        pairs[2 * e] = a < b ? a : b;
        pairs[2 * e + 1] = a < b ? b : a;
    }
    qsort(pairs, n_pairs, 2 * sizeof *pairs, compare_node_pairs);
    size_t kept = 0;
    for (size_t e = 0; e < n_pairs; e++)
        if (e == 0 || compare_node_pairs(pairs + 2 * e, pairs + 2 * (kept - 1)) != 0) {
            memmove(pairs + 2 * kept, pairs + 2 * e, 2 * sizeof *pairs);
            kept++;
        }
    return kept;
}

bool mesh_length_ok(const double a[3], const double b[3], double size_m) {
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    return length > 1e-12 * size_m && isfinite(length);
}

static void bounding_box_of_nodes(size_t n_nodes, const double *x_m, double low[3], double high[3]) {
    for (int axis = 0; axis < 3; axis++)
        low[axis] = high[axis] = x_m[axis];
    for (size_t i = 1; i < n_nodes; i++)
        for (int axis = 0; axis < 3; axis++) {
            double x = x_m[3 * i + (size_t)axis];
            low[axis] = x < low[axis] ? x : low[axis];
            high[axis] = x > high[axis] ? x : high[axis];
        }
}

double mesh_diagonal(size_t n_nodes, const double *x_m) {
    double low[3], high[3];
    bounding_box_of_nodes(n_nodes, x_m, low, high);
    double d[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static int32_t find_root_of_node(int32_t *root, int32_t i) {
    while (root[i] != i) {
        root[i] = root[root[i]];
        i = root[i];
    }
    return i;
}

size_t mesh_parts(size_t n_nodes, size_t n_elements, const int32_t *pairs, const unsigned char *alive,
                  int32_t *root) {
    size_t n_parts = n_nodes;
    for (size_t i = 0; i < n_nodes; i++)
        root[i] = (int32_t)i;
    for (size_t e = 0; e < n_elements; e++) {
        if (alive && !alive[e])
            continue;
        int32_t a = find_root_of_node(root, pairs[2 * e]), b = find_root_of_node(root, pairs[2 * e + 1]);
        if (a == b)
            continue;
        root[a > b ? a : b] = a > b ? b : a;
        n_parts--;
    }
    for (size_t i = 0; i < n_nodes; i++)
        root[i] = find_root_of_node(root, (int32_t)i);
    return n_parts;
}

static palp_status check_node_positions(size_t n_nodes, const double *x_m, palp_error *error) {
    for (size_t i = 0; i < 3 * n_nodes; i++)
        if (!isfinite(x_m[i]))
            return palp_error_set(error, PALP_ERR_INPUT, "node %zu: a coordinate is not finite", i / 3);
    return PALP_OK;
}

static palp_status check_element_nodes(const palp_mesh *mesh, palp_error *error) {
    double size_m = mesh_diagonal(mesh->n_nodes, mesh->x_m);
    for (size_t e = 0; e < mesh->n_elements; e++) {
        const int32_t *pair = mesh->pairs + 2 * e;
        for (int end = 0; end < 2; end++)
            if (pair[end] < 0 || (size_t)pair[end] >= mesh->n_nodes)
                return palp_error_set(error, PALP_ERR_INPUT,
                                      "element %zu: there is no node %ld; the mesh has %zu nodes", e,
                                      (long)pair[end], mesh->n_nodes);
        if (!mesh_length_ok(mesh->x_m + 3 * (size_t)pair[0], mesh->x_m + 3 * (size_t)pair[1], size_m))
            return palp_error_set(error, PALP_ERR_INPUT,
                                  "element %zu: nodes %ld and %ld are at the same place (or too far apart)",
                                  e, (long)pair[0], (long)pair[1]);
    }
    return PALP_OK;
}

static palp_status check_repeated_elements(const palp_mesh *mesh, palp_error *error) {
    size_t bytes = 2 * mesh->n_elements * sizeof *mesh->pairs;
    int32_t *sorted = malloc(bytes);
    if (!sorted)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    memcpy(sorted, mesh->pairs, bytes);
    size_t distinct = mesh_pairs_unique(mesh->n_elements, sorted);
    free(sorted);
    if (distinct < mesh->n_elements)
        return palp_error_set(error, PALP_ERR_INPUT, "%zu elements join the same nodes as another element",
                              mesh->n_elements - distinct);
    return PALP_OK;
}

palp_status mesh_part_away(const palp_mesh *mesh, size_t *parts, size_t *away) {
    int32_t *root = malloc(mesh->n_nodes * sizeof *root);
    if (!root)
        return PALP_ERR_NO_MEMORY;
    *parts = mesh_parts(mesh->n_nodes, mesh->n_elements, mesh->pairs, NULL, root);
    *away = 0;
    while (*away < mesh->n_nodes && root[*away] == 0)
        ++*away;
    free(root);
    return PALP_OK;
}

static palp_status check_mesh_is_connected(const palp_mesh *mesh, palp_error *error) {
    size_t parts, other;
    if (mesh_part_away(mesh, &parts, &other))
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    if (parts == 1)
        return PALP_OK;
    return palp_error_set(error, PALP_ERR_INPUT,
                          "the mesh has %zu separate parts: no elements connect node 0 to node %zu", parts,
                          other);
}

static palp_status check_complete_mesh(const palp_mesh *mesh, palp_error *error) {
    palp_status status = check_node_positions(mesh->n_nodes, mesh->x_m, error);
    if (!status)
        status = check_element_nodes(mesh, error);
    if (!status)
        status = check_repeated_elements(mesh, error);
    return status ? status : check_mesh_is_connected(mesh, error);
}

palp_status palp_mesh_create(size_t n_nodes, const double *x_m, size_t n_elements, const int32_t *pairs,
                             palp_mesh **mesh, palp_error *error) {
    if (!mesh || !x_m || !pairs || n_nodes < 2 || n_nodes > INT32_MAX || n_elements < 1)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a mesh needs at least two nodes and one element");
    palp_mesh *m = NULL;
    palp_status status = mesh_new(n_nodes, n_elements, &m);
    if (status)
        return palp_error_set(error, status, "out of memory");
    memcpy(m->x_m, x_m, 3 * n_nodes * sizeof *x_m);
    memcpy(m->pairs, pairs, 2 * n_elements * sizeof *pairs);
    status = check_complete_mesh(m, error);
    if (status)
        palp_mesh_free(m);
    else
        *mesh = m;
    return status;
}

int mesh_compare_nodes(const void *left, const void *right) {
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

static node_set *find_node_set_by_name(const palp_mesh *mesh, const char *name) {
    for (size_t i = 0; i < mesh->n_sets; i++)
        if (strcmp(mesh->sets[i].name, name) == 0)
            return &mesh->sets[i];
    return NULL;
}

palp_status palp_mesh_add_set(palp_mesh *mesh, const char *name, size_t n, const int32_t *nodes) {
    if (!mesh || !name || !name[0] || (n > 0 && !nodes) || n >= SIZE_MAX / sizeof *nodes)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (nodes[i] < 0 || (size_t)nodes[i] >= mesh->n_nodes)
            return PALP_ERR_ARGUMENT;
    node_set set = {.name = copy_into_mesh_memory(mesh, strlen(name) + 1, 1, name),
                    .nodes = arena_take(&mesh->memory, n, sizeof *nodes)};
    node_set *old = find_node_set_by_name(mesh, name);
    node_set *sets = old ? mesh->sets : realloc(mesh->sets, (mesh->n_sets + 1) * sizeof *sets);
    mesh->sets = sets ? sets : mesh->sets;
    if (!set.name || !set.nodes || !sets)
        return PALP_ERR_NO_MEMORY;
    if (n > 0)
        memcpy(set.nodes, nodes, n * sizeof *nodes);
    qsort(set.nodes, n, sizeof *nodes, mesh_compare_nodes);
    for (size_t i = 0; i < n; i++)
        if (i == 0 || set.nodes[i] != set.nodes[set.n - 1])
            set.nodes[set.n++] = set.nodes[i];
    node_set *at = old ? old : &sets[mesh->n_sets++];
    *at = set;
    return PALP_OK;
}

palp_status palp_mesh_add_plane_set(palp_mesh *mesh, const char *name, int axis, double value_m,
                                    double tolerance_m) {
    if (!name)
        return PALP_ERR_ARGUMENT;
    if (!mesh || axis < 0 || axis > 2 || !isfinite(value_m) || !(tolerance_m >= 0.0))
        return PALP_ERR_ARGUMENT;
    int32_t *nodes = malloc(mesh->n_nodes * sizeof *nodes);
    if (!nodes)
        return PALP_ERR_NO_MEMORY;
    size_t n = 0;
    for (size_t i = 0; i < mesh->n_nodes; i++)
        if (fabs(mesh->x_m[3 * i + (size_t)axis] - value_m) <= tolerance_m)
            nodes[n++] = (int32_t)i;
    palp_status status = n > 0 ? palp_mesh_add_set(mesh, name, n, nodes) : PALP_ERR_INPUT;
    free(nodes);
    return status;
}

palp_status palp_mesh_set(const palp_mesh *mesh, const char *name, size_t *n, const int32_t **nodes) {
    if (!mesh || !name || !n || !nodes)
        return PALP_ERR_ARGUMENT;
    const node_set *set = find_node_set_by_name(mesh, name);
    if (!set)
        return PALP_ERR_INPUT;
    *n = set->n;
    *nodes = set->nodes;
    return PALP_OK;
}

size_t palp_mesh_node_count(const palp_mesh *mesh) {
    return mesh ? mesh->n_nodes : 0;
}

size_t palp_mesh_element_count(const palp_mesh *mesh) {
    return mesh ? mesh->n_elements : 0;
}

const double *palp_mesh_positions(const palp_mesh *mesh) {
    return mesh ? mesh->x_m : NULL;
}

const int32_t *palp_mesh_pairs(const palp_mesh *mesh) {
    return mesh ? mesh->pairs : NULL;
}

/* Is R R' = 1, without a reflection? */
static bool is_proper_rotation(const double r[9]) {
    double volume = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                    r[2] * (r[3] * r[7] - r[4] * r[6]);
    for (int i = 0; i < 9; i++) {
        const double *a = r + 3 * (i / 3), *b = r + 3 * (i % 3);
        double product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        if (!(fabs(product - (i / 3 == i % 3)) <= 1e-9))
            return false;
    }
    return volume > 0.0;
}

palp_status palp_mesh_transform(palp_mesh *mesh, const double rotation[9], const double translation_m[3]) {
    if (!mesh || !rotation || !translation_m || !is_proper_rotation(rotation) ||
        !isfinite(translation_m[0]) || !isfinite(translation_m[1]) || !isfinite(translation_m[2]))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < mesh->n_nodes; i++) {
        double *x = mesh->x_m + 3 * i;
        const double old[3] = {x[0], x[1], x[2]};
        for (int k = 0; k < 3; k++) {
            const double *r = rotation + 3 * k;
            x[k] = r[0] * old[0] + r[1] * old[1] + r[2] * old[2] + translation_m[k];
        }
    }
    return PALP_OK;
}

void palp_mesh_bounds(const palp_mesh *mesh, double low_m[3], double high_m[3]) {
    if (!mesh || !low_m || !high_m)
        return;
    bounding_box_of_nodes(mesh->n_nodes, mesh->x_m, low_m, high_m);
}

static const int32_t *element_pair_in_order(const palp_mesh *mesh, size_t i) {
    return mesh->pairs + 2 * (mesh->order ? mesh->order[i] : i);
}

size_t palp_mesh_element_between(const palp_mesh *mesh, int32_t a, int32_t b) {
    int32_t low = a < b ? a : b, high = a < b ? b : a;
    size_t first = 0, last = mesh->n_elements;
    while (first < last) {
        size_t middle = (first + last) / 2;
        const int32_t *pair = element_pair_in_order(mesh, middle);
        if (pair[0] < low || (pair[0] == low && pair[1] < high))
            first = middle + 1;
        else
            last = middle;
    }
    if (first == mesh->n_elements || element_pair_in_order(mesh, first)[0] != low ||
        element_pair_in_order(mesh, first)[1] != high)
        return mesh->n_elements;
    return mesh->order ? mesh->order[first] : first;
}

bool mesh_is_all_hexahedra(const palp_mesh *mesh) {
    return mesh->n_hexahedra > 0 && mesh->n_tetrahedra == 6 * mesh->n_hexahedra;
}

static mesh_region *find_region(const palp_mesh *mesh, const char *name) {
    for (size_t i = 0; i < mesh->n_regions; i++)
        if (strcmp(mesh->regions[i].name, name) == 0)
            return &mesh->regions[i];
    return NULL;
}

palp_status mesh_take_region(palp_mesh *mesh, const char *name, const double *part) {
    const size_t length = strlen(name) + 1;
    const mesh_region *old = find_region(mesh, name);
    if (old) {
        memmove(old->part, part, mesh->n_tetrahedra * sizeof *part);
        return PALP_OK;
    }
    mesh_region made = {arena_take(&mesh->memory, length, 1),
                        arena_take(&mesh->memory, mesh->n_tetrahedra, sizeof *part)};
    mesh_region *regions = realloc(mesh->regions, (mesh->n_regions + 1) * sizeof *regions);
    mesh->regions = regions ? regions : mesh->regions;
    if (!made.name || !made.part || !regions)
        return PALP_ERR_NO_MEMORY;
    memcpy(made.name, name, length);
    memcpy(made.part, part, mesh->n_tetrahedra * sizeof *part);
    regions[mesh->n_regions++] = made;
    return PALP_OK;
}

palp_status palp_mesh_region(const palp_mesh *mesh, const char *name, const double **part) {
    if (!mesh || !name || !part)
        return PALP_ERR_ARGUMENT;
    const mesh_region *r = find_region(mesh, name);
    if (!r)
        return PALP_ERR_INPUT;
    *part = r->part;
    return PALP_OK;
}
