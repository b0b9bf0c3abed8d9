/* test_mesh_gmsh.c: meshes from Gmsh files, good ones and damaged. */
#include "mesh/mesh_internal.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DATA "tests/data/mesh/"

static const double MM = 0.001;

/* ---- Gmsh files ---------------------------------------------------------------------------------- */

static palp_mesh *read_good(const char *path, bool diagonals) {
    palp_error error = {PALP_OK, "untouched"};
    palp_mesh *mesh = NULL;
    palp_status status = palp_mesh_read_gmsh(path, MM, diagonals, &mesh, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    ck_assert_str_eq(error.text, "untouched");
    return mesh;
}

static void check_set(const palp_mesh *mesh, const char *name, size_t n, const int32_t *expected) {
    const int32_t *nodes = NULL;
    size_t found = 0;
    ck_assert_int_eq(palp_mesh_set(mesh, name, &found, &nodes), PALP_OK);
    ck_assert_uint_eq(found, n);
    ck_assert_mem_eq(nodes, expected, n * sizeof *nodes);
}

/* Tags 3, 5, 10, 42, 700 become nodes 0 to 4. */
START_TEST(gmsh_tetrahedra_with_everything) {
    static const int32_t pairs[] = {0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 1, 4, 2, 3, 2, 4, 3, 4};
    static const double x[] = {1, 0, 0, 1, -1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t tip[] = {3}, bottom[] = {0, 2, 4}, tissue[] = {0, 1, 2, 3, 4};
    palp_mesh *mesh = read_good(DATA "good_tetra.msh", false);
    const int32_t *nodes;
    size_t n;
    ck_assert_uint_eq(palp_mesh_node_count(mesh), 5);
    ck_assert_uint_eq(palp_mesh_element_count(mesh), 9);
    ck_assert_mem_eq(palp_mesh_pairs(mesh), pairs, sizeof pairs);
    for (int i = 0; i < 15; i++)
        ck_assert_double_eq(palp_mesh_positions(mesh)[i], MM * x[i]);
    check_set(mesh, "tip node", 1, tip);
    check_set(mesh, "bottom", 3, bottom);
    check_set(mesh, "tissue", 5, tissue);
    check_set(mesh, "top", 1, tip);
    ck_assert_int_eq(palp_mesh_set(mesh, "nothing of the volume", &n, &nodes), PALP_ERR_INPUT);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(gmsh_scale_and_default_sets) {
    static const int32_t bottom[] = {0, 1, 3}, top[] = {2, 4};
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_read_gmsh(DATA "good_plain.msh", 2.0, false, &mesh, NULL), PALP_OK);
    ck_assert_double_eq(palp_mesh_positions(mesh)[3], 2.0);
    check_set(mesh, "bottom", 3, bottom);
    check_set(mesh, "top", 2, top);
    palp_mesh_free(mesh);
}
END_TEST

/* The number of edges of a mesh of a ball is its nodes + faces - cells - 1 (Euler): 259 nodes, 972
 * tetrahedra and (4 * 972 + 324) / 2 triangles, 324 of them on the surface. */
START_TEST(gmsh_cylinder_has_eulers_edges) {
    palp_mesh *mesh = read_good("data/meshes/cylinder_tetra.msh", false);
    const int32_t *nodes = NULL;
    size_t n = 0;
    double low[3], high[3];
    ck_assert_uint_eq(palp_mesh_node_count(mesh), 259);
    ck_assert_uint_eq(palp_mesh_element_count(mesh), 259 + (4 * 972 + 324) / 2 - 972 - 1);
    palp_mesh_bounds(mesh, low, high);
    ck_assert_double_eq_tol(low[0], -0.012, 1e-15);
    ck_assert_double_eq_tol(high[0], 0.012, 1e-15);
    ck_assert(low[1] == 0.0 && fabs(high[1] - 0.024) < 1e-15);
    for (int end = 0; end < 2; end++) {
        ck_assert_int_eq(palp_mesh_set(mesh, end ? "top" : "bottom", &n, &nodes), PALP_OK);
        ck_assert_uint_eq(n, 37);
        for (size_t i = 0; i < n; i++)
            ck_assert_double_eq(palp_mesh_positions(mesh)[3 * nodes[i] + 1], end ? high[1] : 0.0);
    }
    palp_mesh_free(mesh);
}
END_TEST

static int compare_pairs(const void *left, const void *right) {
    const int32_t *a = left, *b = right;
    return a[0] != b[0] ? a[0] - b[0] : a[1] - b[1];
}

/* The pairs of a mesh in the numbering of a 5 x 5 x 5 lattice of 24 mm, sorted. */
static int32_t *lattice_pairs(const palp_mesh *mesh) {
    size_t n = palp_mesh_element_count(mesh);
    int32_t *pairs = malloc(2 * n * sizeof *pairs), number[2];
    ck_assert_ptr_nonnull(pairs);
    for (size_t e = 0; e < n; e++) {
        for (int end = 0; end < 2; end++) {
            const double *x = palp_mesh_positions(mesh) + 3 * palp_mesh_pairs(mesh)[2 * e + (size_t)end];
            number[end] =
                (int32_t)(lround(x[0] / 0.006) * 25 + lround(x[1] / 0.006) * 5 + lround(x[2] / 0.006));
        }
        pairs[2 * e] = number[0] < number[1] ? number[0] : number[1];
        pairs[2 * e + 1] = number[0] < number[1] ? number[1] : number[0];
    }
    qsort(pairs, n, 2 * sizeof *pairs, compare_pairs);
    return pairs;
}

static void check_same_lattice(bool diagonals, palp_neighbourhood neighbourhood) {
    const size_t nodes[3] = {5, 5, 5};
    const double size_m[3] = {0.024, 0.024, 0.024};
    palp_mesh *read = read_good("data/meshes/box_hexa.msh", diagonals), *mesh = NULL;
    ck_assert_int_eq(palp_mesh_lattice(nodes, size_m, neighbourhood, &mesh), PALP_OK);
    size_t n = palp_mesh_element_count(mesh);
    ck_assert_uint_eq(palp_mesh_node_count(read), 125);
    ck_assert_uint_eq(palp_mesh_element_count(read), n);
    int32_t *a = lattice_pairs(read), *b = lattice_pairs(mesh);
    ck_assert_mem_eq(a, b, 2 * n * sizeof *a);
    free(a);
    free(b);
    palp_mesh_free(read);
    palp_mesh_free(mesh);
}

START_TEST(gmsh_hexahedra_are_the_lattice) {
    check_same_lattice(true, PALP_NEIGHBOURS_26);
    check_same_lattice(false, PALP_NEIGHBOURS_6);
}
END_TEST

/* file, the line to blame, what the message holds */
static const struct {
    const char *name;
    int line;
    const char *text;
} bad_files[] = {
    {"bad_version", 2, "MSH version 4 is not supported; save the mesh as version 2.2 or 4.1 ASCII"},
    {"bad_binary", 2, "binary files are not supported"},
    {"bad_no_format", 1, "$MeshFormat is expected before $Nodes"},
    {"bad_not_gmsh", 1, "not 'solid thing'"},
    {"bad_empty", 1, "the file ends without $MeshFormat"},
    {"bad_truncated_nodes", 14, "the file ends inside $Nodes"},
    {"bad_truncated_elements", 21, "the file ends inside $Elements"},
    {"bad_no_elements", 17, "the file ends without $Elements"},
    {"bad_nan", 14, "a coordinate is expected, not 'nan'"},
    {"bad_infinite", 14, "a coordinate is out of range"},
    {"bad_missing_coordinate", 13, "the line ends where a coordinate is expected"},
    {"bad_extra_coordinate", 13, "the end of the line is expected, not '7'"},
    {"bad_node_tag", 9, "a node tag is expected, not 'x3'"},
    {"bad_unknown_node", 22, "there is no node 6"},
    {"bad_duplicate_tag", 10, "node tag 2 is given a second time"},
    {"bad_same_place", 22, "nodes 4 and 5 are at the same place"},
    {"bad_flat", 22, "a flat tetrahedron"},
    {"bad_repeated_node", 22, "an element has node 3 twice"},
    {"bad_repeated_element", 22, "an element with the same nodes as that of line 21"},
    {"bad_nothing_usable", 18, "there are no 4-node tetrahedra"},
    {"bad_prisms", 20, "elements of type 6 are not supported"},
    {"bad_negative_count", 6, "a number in the block of -5 is out of range"},
    {"bad_huge_count", 5, "a total number of 99999999999999999999 is out of range"},
    {"bad_long_block", 12, "a node tag of 0 is out of range"},
    {"bad_few_nodes", 16, "5 nodes, but $Nodes announces 6"},
    {"bad_many_elements", 20, "more elements than $Elements announces"},
    {"bad_few_elements", 22, "1 elements fewer than $Elements announces"},
    {"bad_end", 23, "$EndElements is expected, not '$EndElement'"},
    {"bad_second_nodes", 18, "$Nodes is given a second time"},
    {"bad_elements_first", 4, "$Nodes is expected before $Elements"},
    {"bad_partitioned", 4, "partitioned meshes are not supported"},
    {"bad_name", 6, "a name in quotation marks is expected, not 'bottom'"},
    {"bad_parts", 11, "the mesh has 3 separate parts: no elements connect node 1 to node 5"},
};

START_TEST(gmsh_bad_files_say_where) {
    char path[256], prefix[300];
    palp_error error = {PALP_OK, ""};
    palp_mesh *mesh = NULL;
    snprintf(path, sizeof path, DATA "%s.msh", bad_files[_i].name);
    snprintf(prefix, sizeof prefix, "%s:%d: ", path, bad_files[_i].line);
    ck_assert_int_eq(palp_mesh_read_gmsh(path, MM, true, &mesh, &error), PALP_ERR_INPUT);
    ck_assert_int_eq(error.status, PALP_ERR_INPUT);
    ck_assert_msg(strncmp(error.text, prefix, strlen(prefix)) == 0, "%s, not %s", error.text, prefix);
    ck_assert_msg(strstr(error.text, bad_files[_i].text), "%s", error.text);
    ck_assert_ptr_null(mesh);
}
END_TEST

START_TEST(gmsh_refuses_bad_arguments) {
    palp_error error = {PALP_OK, ""};
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_read_gmsh(DATA "good_plain.msh", 0.0, true, &mesh, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_read_gmsh(DATA "good_plain.msh", NAN, true, &mesh, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_read_gmsh(DATA "no_such_file.msh", MM, true, &mesh, &error), PALP_ERR_FILE);
    ck_assert_ptr_nonnull(strstr(error.text, "no_such_file.msh"));
    ck_assert_ptr_null(mesh);
}
END_TEST

/* ---- damaged files ------------------------------------------------------------------------------- */

static const char *scratch_path(void) {
    static char path[512];
    const char *folder = getenv("SCRATCH");
    snprintf(path, sizeof path, "%s/test_mesh.msh", folder ? folder : "/tmp");
    return path;
}

static void write_bytes(const char *path, const char *bytes, size_t n) {
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, n, file), n);
    ck_assert_int_eq(fclose(file), 0);
}

static char *read_bytes(const char *path, size_t *n) {
    FILE *file = fopen(path, "rb");
    ck_assert_ptr_nonnull(file);
    char *bytes = malloc(65536);
    ck_assert_ptr_nonnull(bytes);
    *n = fread(bytes, 1, 65535, file);
    bytes[*n] = '\0';
    fclose(file);
    return bytes;
}

/* A mesh, or one line that names the file and a line it has. */
static bool read_damaged(const char *path, size_t lines) {
    palp_error error = {PALP_OK, ""};
    palp_mesh *mesh = NULL;
    palp_status status = palp_mesh_read_gmsh(path, MM, false, &mesh, &error);
    palp_mesh_free(mesh);
    if (status == PALP_OK)
        return true;
    size_t length = strlen(path);
    ck_assert_int_eq(status, PALP_ERR_INPUT);
    ck_assert_ptr_null(strchr(error.text, '\n'));
    ck_assert_msg(strncmp(error.text, path, length) == 0 && error.text[length] == ':', "%s", error.text);
    long line = strtol(error.text + length + 1, NULL, 10);
    ck_assert_msg(line >= 1 && (size_t)line <= lines, "%s", error.text);
    return false;
}

/* The same mesh in both versions. */
static const char *const tetra_files[] = {DATA "good_tetra.msh", DATA "good_tetra_2.msh"};

/* Cut after any byte: a mesh only from where a section has just ended, behind $Elements. */
START_TEST(gmsh_every_truncation_is_an_error_or_a_mesh) {
    size_t n = 0, lines = 1, meshes = 0;
    char *bytes = read_bytes(tetra_files[_i], &n);
    const char *path = scratch_path(), *elements = strstr(bytes, "$EndElements");
    const char *data = strstr(bytes, "$NodeData"), *end = strstr(bytes, "$EndNodeData");
    for (size_t cut = 0; cut <= n; cut++) {
        write_bytes(path, bytes, cut);
        bool mesh = read_damaged(path, lines);
        bool whole = (bytes + cut >= elements + 12 && bytes + cut <= data) || bytes + cut >= end + 12;
        ck_assert_msg(mesh == whole, "cut after byte %zu", cut);
        meshes += mesh;
        lines += bytes[cut] == '\n' && cut > 0;
    }
    ck_assert_uint_eq(meshes, 5);
    free(bytes);
    remove(path);
}
END_TEST

/* Any byte overwritten: never a crash, and an error says where. */
START_TEST(gmsh_every_overwritten_byte_is_an_error_or_a_mesh) {
    static const char with[] = {'\0', '9', '-', '$', '\n', '"', 'e', ' '};
    size_t n = 0, failed = 0;
    char *bytes = read_bytes(tetra_files[_i / 8], &n);
    const char *path = scratch_path();
    for (size_t at = 0; at < n; at++) {
        char kept = bytes[at];
        bytes[at] = with[(at + (size_t)_i) % sizeof with];
        write_bytes(path, bytes, n);
        failed += !read_damaged(path, 80);
        bytes[at] = kept;
    }
    ck_assert_uint_gt(failed, n / 4);
    ck_assert_uint_lt(failed, n);
    free(bytes);
    remove(path);
}
END_TEST

START_TEST(gmsh_windows_line_ends_are_read) {
    size_t n = 0, m = 0;
    char *bytes = read_bytes(DATA "good_plain.msh", &n), *windows = malloc(2 * n);
    ck_assert_ptr_nonnull(windows);
    for (size_t i = 0; i < n; i++) {
        if (bytes[i] == '\n')
            windows[m++] = '\r';
        windows[m++] = bytes[i];
    }
    write_bytes(scratch_path(), windows, m);
    palp_mesh *mesh = read_good(scratch_path(), false);
    ck_assert_uint_eq(palp_mesh_element_count(mesh), 9);
    palp_mesh_free(mesh);
    free(bytes);
    free(windows);
    remove(scratch_path());
}
END_TEST

/* ---- version 2.2 --------------------------------------------------------------------------------- */

static void check_equal_groups(const palp_mesh *a, const palp_mesh *b) {
    ck_assert_uint_eq(a->n_sets, b->n_sets);
    for (size_t s = 0; s < a->n_sets; s++) {
        ck_assert_str_eq(a->sets[s].name, b->sets[s].name);
        check_set(a, a->sets[s].name, b->sets[s].n, b->sets[s].nodes);
    }
    ck_assert_uint_eq(a->n_regions, b->n_regions);
    for (size_t i = 0; i < a->n_regions; i++) {
        ck_assert_str_eq(a->regions[i].name, b->regions[i].name);
        ck_assert_mem_eq(a->regions[i].part, b->regions[i].part, a->n_tetrahedra * sizeof(double));
    }
}

static void check_equal_meshes(const palp_mesh *a, const palp_mesh *b) {
    ck_assert_uint_eq(a->n_nodes, b->n_nodes);
    ck_assert_uint_eq(a->n_elements, b->n_elements);
    ck_assert_uint_eq(a->n_tetrahedra, b->n_tetrahedra);
    ck_assert_uint_eq(a->n_triangles, b->n_triangles);
    ck_assert_uint_eq(a->n_hexahedra, b->n_hexahedra);
    ck_assert_mem_eq(a->x_m, b->x_m, 3 * a->n_nodes * sizeof *a->x_m);
    ck_assert_mem_eq(a->pairs, b->pairs, 2 * a->n_elements * sizeof *a->pairs);
    ck_assert_mem_eq(a->tetrahedra, b->tetrahedra, 4 * a->n_tetrahedra * sizeof *a->tetrahedra);
    ck_assert_mem_eq(a->triangles, b->triangles, 3 * a->n_triangles * sizeof *a->triangles);
    if (a->n_hexahedra > 0)
        ck_assert_mem_eq(a->hexahedra, b->hexahedra, 8 * a->n_hexahedra * sizeof *a->hexahedra);
    check_equal_groups(a, b);
}

/* Gmsh 4.15 wrote good_groups in both: eight hexahedra in two groups each, in version 2.2 on two lines each.
 */
START_TEST(gmsh_versions_give_the_same_mesh) {
    palp_mesh *new = read_good(_i / 2 ? DATA "good_groups.msh" : tetra_files[0], _i % 2);
    palp_mesh *old = read_good(_i / 2 ? DATA "good_groups_2.msh" : tetra_files[1], _i % 2);
    check_equal_meshes(new, old);
    ck_assert_uint_eq(old->n_hexahedra, _i / 2 ? 8 : 0);
    ck_assert_uint_eq(old->n_regions, _i / 2 ? 2 : 1);
    palp_mesh_free(new);
    palp_mesh_free(old);
}
END_TEST

/* Writes good_tetra_2.msh to the scratch file, the first place of one text changed to another. */
static void write_changed(const char *from, const char *to) {
    size_t n = 0;
    char *bytes = read_bytes(tetra_files[1], &n), *at = strstr(bytes, from);
    char *changed = malloc(n + strlen(to) + 1);
    ck_assert_ptr_nonnull(changed);
    ck_assert_msg(at, "%s", from);
    snprintf(changed, n + strlen(to) + 1, "%.*s%s%s", (int)(at - bytes), bytes, to, at + strlen(from));
    write_bytes(scratch_path(), changed, strlen(changed));
    free(bytes);
    free(changed);
}

START_TEST(gmsh_version_2_element_without_a_group) {
    const double *part = NULL;
    write_changed("4 4 2 1 1 10", _i ? "4 4 0 10" : "4 4 2 0 1 10");
    palp_mesh *mesh = read_good(scratch_path(), false);
    ck_assert_uint_eq(mesh->n_tetrahedra, 2);
    ck_assert_int_eq(palp_mesh_region(mesh, "tissue", &part), PALP_OK);
    ck_assert(part[0] == 1.0 && part[1] == 0.0);
    palp_mesh_free(mesh);
    remove(scratch_path());
}
END_TEST

#define NODES                                                                                                \
    "$Nodes\n7\n700 0 0 1\n10 0 0 0\n42 0 1 0\n99 5 5 5\n98 6 6 6\n3 1 0 0\n5 1e0 -1.0E+00 +1.\n$EndNodes\n"
#define ELEMENTS                                                                                             \
    "$Elements\n5\n1 15 2 7 4 42\n1 1 3 9 6 0 99 98\n900 2 2 -1 2 10 3 700\n"                                \
    "5 4 2 1 1 10 3 700 42\n4 4 2 1 1 10 3 700 5\n$EndElements\n"

/* a text of good_tetra_2.msh, what takes its place, the line to blame, what the message holds */
static const struct {
    const char *from, *to;
    int line;
    const char *text;
} bad_changes[] = {
    {"2.2 0 8", "2.1 0 8", 5, "MSH version 2.1 is not supported; save the mesh as version 2.2 or 4.1 ASCII"},
    {"2.2 0 8", "3 0 8", 5, "MSH version 3 is not supported"},
    {"2.2 0 8", "2.2 1 8", 5, "binary files are not supported; save the mesh as version 2.2 or 4.1 ASCII"},
    {"2.2 0 8", "4.1 0 8", 15, "the line ends where a total number is expected"},
    {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "", 4, "$MeshFormat is expected before $PhysicalNames"},
    {"$Nodes\n7\n", "$Nodes\n7 1\n", 15, "the end of the line is expected, not '1'"},
    {"$Nodes\n7\n", "$Nodes\n8\n", 23, "7 nodes, but $Nodes announces 8"},
    {"$Nodes\n7\n", "$Nodes\n6\n", 22, "$EndNodes is expected, not '5 1e0"},
    {"$Nodes\n7\n", "$Nodes\n-7\n", 15, "a total number of -7 is out of range"},
    {"$EndNodes\n", "$EndNodes\n$Nodes\n0\n$EndNodes\n", 24, "$Nodes is given a second time"},
    {"42 0 1 0", "700 0 1 0", 18, "node tag 700 is given a second time"},
    {"42 0 1 0", "0 0 1 0", 18, "a node tag of 0 is out of range"},
    {"42 0 1 0", "42 0 1", 18, "the line ends where a coordinate is expected"},
    {"42 0 1 0", "42 0 1 0 1", 18, "the end of the line is expected, not '1'"},
    {"42 0 1 0", "42 0 inf 0", 18, "a coordinate is"},
    {"42 0 1 0", "42 0 0 0", 29, "an element of zero length: nodes 10 and 42 are at the same place"},
    {"42 0 1 0", "42 0.5 0 0.5", 29, "a flat tetrahedron"},
    {"$Elements\n5\n", "$Elements\n6\n", 31, "5 elements, but $Elements announces 6"},
    {"$Elements\n5\n", "$Elements\n4\n", 30, "$EndElements is expected, not '4 4 2 1 1"},
    {"$Elements\n5\n", "$Elements\nfive\n", 25, "a total number is expected, not 'five'"},
    {"5 4 2 1 1 10 3", "5 6 2 1 1 10 3", 29, "elements of type 6 are not supported"},
    {"5 4 2 1 1 10 3", "5 4 9 1 1 0 10 3", 29, "the line ends where a tag is expected"},
    {"5 4 2 1 1 10 3", "5 4 1 x 10 3", 29, "a physical tag is expected, not 'x'"},
    {"5 4 2 1 1 10 3", "5 4 4 1 1 1 3 10 3", 29, "partitioned meshes are not supported"},
    {"5 4 2 1 1 10 3", "5 4 2 1 1 10 10", 29, "an element has node 10 twice"},
    {"5 4 2 1 1 10 3", "5 4 2 1 1 10 4", 29, "there is no node 4"},
    {"700 42\n", "700\n", 29, "the line ends where a node tag is expected"},
    {"700 42\n", "700 42 5\n", 29, "the end of the line is expected, not '5'"},
    {"3 700 5\n", "42 700 3\n", 30, "an element with the same nodes as that of line 29"},
    {"5 4 2 1 1 10 3 700 42\n4 4 2 1 1 10 3 700 5\n", "5 2 2 1 1 10 3 42\n4 15 0 10\n", 24,
     "there are no 4-node tetrahedra"},
    {NODES, "", 14, "$Nodes is expected before $Elements"},
    {ELEMENTS, "", 28, "the file ends without $Elements"},
};

START_TEST(gmsh_bad_changes_of_version_2_say_where) {
    char prefix[600];
    palp_error error = {PALP_OK, ""};
    palp_mesh *mesh = NULL;
    write_changed(bad_changes[_i].from, bad_changes[_i].to);
    snprintf(prefix, sizeof prefix, "%s:%d: ", scratch_path(), bad_changes[_i].line);
    ck_assert_int_eq(palp_mesh_read_gmsh(scratch_path(), MM, true, &mesh, &error), PALP_ERR_INPUT);
    ck_assert_msg(strncmp(error.text, prefix, strlen(prefix)) == 0, "%s, not %s", error.text, prefix);
    ck_assert_msg(strstr(error.text, bad_changes[_i].text), "%s", error.text);
    ck_assert_ptr_null(mesh);
    remove(scratch_path());
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, gmsh_tetrahedra_with_everything);
    tcase_add_test(tc, gmsh_scale_and_default_sets);
    tcase_add_test(tc, gmsh_cylinder_has_eulers_edges);
    tcase_add_test(tc, gmsh_hexahedra_are_the_lattice);
    tcase_add_loop_test(tc, gmsh_bad_files_say_where, 0, (int)(sizeof bad_files / sizeof *bad_files));
    tcase_add_test(tc, gmsh_refuses_bad_arguments);
    tcase_add_loop_test(tc, gmsh_every_truncation_is_an_error_or_a_mesh, 0, 2);
    tcase_add_loop_test(tc, gmsh_every_overwritten_byte_is_an_error_or_a_mesh, 0, 16);
    tcase_add_test(tc, gmsh_windows_line_ends_are_read);
    tcase_add_loop_test(tc, gmsh_versions_give_the_same_mesh, 0, 4);
    tcase_add_loop_test(tc, gmsh_version_2_element_without_a_group, 0, 2);
    tcase_add_loop_test(tc, gmsh_bad_changes_of_version_2_say_where, 0,
                        (int)(sizeof bad_changes / sizeof *bad_changes));
}
