/* test_vtu.c: the frames and the series for ParaView against the network they show. */
#define _POSIX_C_SOURCE 200809L
#include <palpate/vtu.h>

#include "scratch.h"

#include <math.h>

enum { NODES = 27, ELEMENTS = 158 }; /* 3 x 3 x 3, Moore */

static palp_network *network_make(void) {
    static const size_t nodes[3] = {3, 3, 3};
    static const double size_m[3] = {0.024, 0.024, 0.024}, c_N[1] = {2};
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_material material;
    palp_mesh *mesh;
    palp_network *network;
    memset(&material, 0, sizeof material);
    material.n_arms = 1;
    material.arms[0] = (palp_arm){1.5, 3, 0, 0};
    palp_supports_default(supports);
    ck_assert_int_eq(palp_law_polynomial(1, c_N, &material.law), PALP_OK);
    ck_assert_int_eq(palp_mesh_lattice(nodes, size_m, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &material, 2, supports, &settings, &network, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return network;
}

/* Every tag that opens is closed, in order; returns the number of elements called name. */
static int xml_check(const char *text, const char *name) {
    char open[16][32];
    int depth = 0, count = 0;
    ck_assert_int_eq(strncmp(text, "<?xml version=\"1.0\"?>\n<VTKFile ", 31), 0);
    for (const char *p = strchr(text + 2, '<'); p; p = strchr(p + 1, '<')) {
        const char *end = strchr(p, '>');
        ck_assert_ptr_nonnull(end);
        size_t length = strcspn(p + 1, " />\n");
        if (p[1] == '/') {
            length = (size_t)(end - p) - 2;
            ck_assert_int_gt(depth, 0);
            depth--;
            ck_assert_uint_eq(strlen(open[depth]), length);
            ck_assert_int_eq(strncmp(open[depth], p + 2, length), 0);
            continue;
        }
        ck_assert_uint_lt(length, sizeof open[0]);
        ck_assert_int_lt(depth, 16);
        count += strlen(name) == length && strncmp(p + 1, name, length) == 0;
        if (end[-1] != '/') {
            memcpy(open[depth], p + 1, length);
            open[depth++][length] = '\0';
        }
    }
    ck_assert_int_eq(depth, 0);
    return count;
}

/* The n numbers of the data array called name. */
static void array_read(const char *text, const char *name, size_t n, double *values) {
    char mark[64];
    snprintf(mark, sizeof mark, "Name=\"%s\"", name);
    const char *p = strstr(text, mark);
    ck_assert_ptr_nonnull(p);
    p = strchr(p, '>') + 1;
    for (size_t i = 0; i < n; i++) {
        char *end;
        values[i] = strtod(p, &end);
        ck_assert_ptr_ne(end, p);
        p = end;
    }
    ck_assert_int_eq(strncmp(p + strspn(p, " \n"), "</DataArray>", 12), 0);
}

/* Written with nine digits. */
static void same(size_t n, const double *written, const double *want) {
    for (size_t i = 0; i < n; i++)
        ck_assert_double_le(fabs(written[i] - want[i]), 5e-9 * fabs(want[i]) + 1e-300);
}

static void frame_shows(const char *path, const palp_network *network) {
    double points[3 * NODES], moved[3 * NODES], strain[ELEMENTS], force_N[ELEMENTS], want_N[ELEMENTS];
    double connectivity[2 * ELEMENTS], offsets[ELEMENTS], types[ELEMENTS];
    const palp_mesh *mesh = palp_network_mesh(network);
    const double *x_m = palp_network_positions(network), *rest_m = palp_mesh_positions(mesh);
    char *text = scratch_read(path);
    ck_assert_int_eq(xml_check(text, "DataArray"), 7);
    ck_assert_ptr_nonnull(strstr(text, "<Piece NumberOfPoints=\"27\" NumberOfCells=\"158\">"));
    array_read(text, "Points", 3 * NODES, points);
    array_read(text, "displacement", 3 * NODES, moved);
    array_read(text, "strain", ELEMENTS, strain);
    array_read(text, "force_N", ELEMENTS, force_N);
    array_read(text, "connectivity", 2 * ELEMENTS, connectivity);
    array_read(text, "offsets", ELEMENTS, offsets);
    array_read(text, "types", ELEMENTS, types);
    palp_network_element_force(network, want_N);
    same(3 * NODES, points, x_m);
    same(ELEMENTS, strain, palp_network_element_strain(network));
    same(ELEMENTS, force_N, want_N);
    for (size_t i = 0; i < 3 * NODES; i++)
        ck_assert_double_eq_tol(moved[i], x_m[i] - rest_m[i], 1e-11);
    for (size_t i = 0; i < ELEMENTS; i++) {
        ck_assert_double_eq(connectivity[2 * i], palp_mesh_pairs(mesh)[2 * i]);
        ck_assert_double_eq(connectivity[2 * i + 1], palp_mesh_pairs(mesh)[2 * i + 1]);
        ck_assert_double_eq(offsets[i], 2.0 * (double)(i + 1));
        ck_assert_double_eq(types[i], 3); /* VTK_LINE */
    }
    free(text);
}

START_TEST(frames_show_the_network) {
    palp_network *network = network_make();
    palp_vtu *series;
    ck_assert_int_eq(palp_vtu_open(scratch_path("vtk"), "press", &series, NULL), PALP_OK);
    ck_assert_int_eq(palp_vtu_add(series, network, NULL), PALP_OK);
    frame_shows(scratch_path("vtk/press_0000.vtu"), network);
    ck_assert_int_eq(palp_network_step(network, 0.0024, 0.1, NULL), PALP_OK);
    ck_assert_int_eq(palp_vtu_add(series, network, NULL), PALP_OK);
    frame_shows(scratch_path("vtk/press_0001.vtu"), network);
    ck_assert_int_eq(palp_network_step(network, 0.0024, 0.2, NULL), PALP_OK);
    ck_assert_int_eq(palp_vtu_add(series, network, NULL), PALP_OK);
    ck_assert_int_ne(access(scratch_path("vtk/press.pvd"), F_OK), 0);
    char want[512];
    snprintf(want, sizeof want,
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n"
             "<DataSet timestep=\"0\" part=\"0\" file=\"press_0000.vtu\"/>\n"
             "<DataSet timestep=\"0.1\" part=\"0\" file=\"press_0001.vtu\"/>\n"
             "<DataSet timestep=\"%.17g\" part=\"0\" file=\"press_0002.vtu\"/>\n"
             "</Collection>\n</VTKFile>\n",
             0.1 + 0.2);
    ck_assert_int_eq(palp_vtu_close(series, NULL), PALP_OK);
    char *text = scratch_read(scratch_path("vtk/press.pvd"));
    ck_assert_int_eq(xml_check(text, "DataSet"), 3);
    ck_assert_str_eq(text, want);
    free(text);
    ck_assert_int_eq(scratch_entries(scratch_path("vtk"), 0), 4);
    palp_network_free(network);
}
END_TEST

/* More frames than the first allocation holds; the folder is there already. */
START_TEST(long_series_is_numbered_through) {
    palp_network *network = network_make();
    palp_vtu *series;
    ck_assert_int_eq(palp_vtu_open(scratch_folder, "a", &series, NULL), PALP_OK);
    for (int i = 0; i < 130; i++)
        ck_assert_int_eq(palp_vtu_add(series, network, NULL), PALP_OK);
    ck_assert_int_eq(palp_vtu_close(series, NULL), PALP_OK);
    char *text = scratch_read(scratch_path("a.pvd"));
    ck_assert_int_eq(xml_check(text, "DataSet"), 130);
    ck_assert_ptr_nonnull(strstr(text, "\"a_0129.vtu\""));
    free(text);
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), 131);
    palp_network_free(network);
}
END_TEST

START_TEST(what_cannot_be_written_is_named) {
    static const char *const names[] = {"", "a/b", "../a", ".a", "a\"b", "a<b"};
    palp_error error;
    palp_vtu *series;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        ck_assert_int_eq(palp_vtu_open(scratch_folder, names[i], &series, &error), PALP_ERR_ARGUMENT);
        ck_assert_ptr_null(series);
    }
    ck_assert_int_eq(palp_vtu_open("/nowhere/at/all", "a", &series, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/nowhere/at/all: cannot create the folder: No such file or directory");
    const char *file = scratch_write("file", "x", 1);
    ck_assert_int_eq(palp_vtu_open(file, "a", &series, &error), PALP_ERR_FILE);
    ck_assert_int_eq(palp_vtu_close(NULL, &error), PALP_OK);
}
END_TEST

/* The folder is taken away under an open series: both calls say so, nothing leaks. */
START_TEST(lost_folder_is_a_file_error) {
    palp_network *network = network_make();
    palp_error error;
    palp_vtu *series;
    const char *folder = scratch_path("gone");
    ck_assert_int_eq(palp_vtu_open(folder, "a", &series, NULL), PALP_OK);
    ck_assert_int_eq(rmdir(folder), 0);
    ck_assert_int_eq(palp_vtu_add(series, network, &error), PALP_ERR_FILE);
    ck_assert_int_eq(strncmp(error.text, folder, strlen(folder)), 0);
    ck_assert_int_eq(palp_vtu_close(series, &error), PALP_ERR_FILE);
    palp_network_free(network);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, frames_show_the_network);
    tcase_add_test(tc, long_series_is_numbered_through);
    tcase_add_test(tc, what_cannot_be_written_is_named);
    tcase_add_test(tc, lost_folder_is_a_file_error);
}
