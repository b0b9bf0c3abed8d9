/* vtu.c: the deforming network for ParaView: VTK XML unstructured grids and a .pvd series. */
#define _XOPEN_SOURCE 700 /* locale_t, mkdir */
#include <palpate/vtu.h>

#include "base/file.h"
#include "base/number.h"
#include "network_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct palp_vtu {
    char *folder, *name;
    size_t n, capacity;
    double *time_s;  /* [capacity] one for each frame, n of them used */
    int rank, parts; /* of a network in parts, of which each process writes one; parts: 0 = whole */
};

enum { VTK_LINE = 3 };

static void free_series_memory(palp_vtu *series) {
    free(series->folder);
    free(series->name);
    free(series->time_s);
    free(series);
}

/* Is it a plain file name, which needs no escaping in XML? */
static bool is_plain_file_name(const char *name) {
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return name[0] && name[0] != '.' && name[strspn(name, allowed)] == '\0';
}

static palp_status create_folder_if_missing(const char *folder, palp_error *error) {
    struct stat info;
    if (mkdir(folder, 0777) == 0 || (errno == EEXIST && stat(folder, &info) == 0 && S_ISDIR(info.st_mode)))
        return PALP_OK;
    return palp_error_set_file(error, folder, "cannot create the folder", errno);
}

palp_status palp_vtu_open(const char *folder, const char *name, palp_vtu **series, palp_error *error) {
    if (!folder || !name || !series)
        return palp_error_null(error);
    *series = NULL;
    if (!is_plain_file_name(name))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "\"%s\" is not a valid name of a series; use letters and digits", name);
    palp_status status = create_folder_if_missing(folder, error);
    if (status)
        return status;
    palp_vtu *made = calloc(1, sizeof *made);
    if (made) {
        made->folder = palp_text_copy(folder);
        made->name = palp_text_copy(name);
    }
    if (!made || !made->folder || !made->name) {
        if (made)
            free_series_memory(made);
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", folder);
    }
    *series = made;
    return PALP_OK;
}

/* folder/name + ending, allocated by malloc. */
static char *path_in_series_folder(const palp_vtu *series, const char *ending) {
    size_t size = strlen(series->folder) + strlen(series->name) + strlen(ending) + 2;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%s/%s%s", series->folder, series->name, ending);
    return path;
}

static void print_array_start_tag(FILE *f, const char *type, const char *name, int components) {
    fprintf(f, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n", type, name,
            components);
}

static void print_array_end_tag(FILE *f) {
    fputs("</DataArray>\n", f);
}

/* Prints values[n] less from[n] (or 0), per numbers in a line. */
static void print_values_in_rows(FILE *f, size_t n, const double *values, const double *from, size_t per) {
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%.9g%c", values[i] - (from ? from[i] : 0), (i + 1) % per ? ' ' : '\n');
}

static void print_points_and_motion(FILE *f, size_t n_nodes, const double *x_m, const double *rest_m) {
    fputs("<Points>\n", f);
    print_array_start_tag(f, "Float64", "Points", 3);
    print_values_in_rows(f, 3 * n_nodes, x_m, NULL, 3);
    print_array_end_tag(f);
    fputs("</Points>\n<PointData Vectors=\"displacement\">\n", f);
    print_array_start_tag(f, "Float64", "displacement", 3);
    print_values_in_rows(f, 3 * n_nodes, x_m, rest_m, 3);
    print_array_end_tag(f);
    fputs("</PointData>\n", f);
}

static void print_line_cells(FILE *f, size_t n, const int32_t *pairs) {
    fputs("<Cells>\n", f);
    print_array_start_tag(f, "Int64", "connectivity", 1);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%ld %ld\n", (long)pairs[2 * i], (long)pairs[2 * i + 1]);
    print_array_end_tag(f);
    print_array_start_tag(f, "Int64", "offsets", 1);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu\n", 2 * (i + 1));
    print_array_end_tag(f);
    print_array_start_tag(f, "UInt8", "types", 1);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%d\n", VTK_LINE);
    print_array_end_tag(f);
    fputs("</Cells>\n", f);
}

/* K at rest of each element, by which regions differ. */
static void print_rest_stiffness(FILE *f, const palp_network *net) {
    double stiffness[PALP_REGIONS_MAX + 1];
    network_stiffnesses(net, 0.0, false, stiffness);
    print_array_start_tag(f, "Float64", "stiffness_N", 1);
    for (size_t i = 0; i < net->n_elements; i++)
        fprintf(f, "%.9g\n", net->scale[i] * network_mean_of_materials(net, i, stiffness));
    print_array_end_tag(f);
}

static void print_element_values(FILE *f, const palp_network *network, size_t n, const double *force_N) {
    fputs("<CellData Scalars=\"strain\">\n", f);
    print_array_start_tag(f, "Float64", "strain", 1);
    print_values_in_rows(f, n, palp_network_element_strain(network), NULL, 1);
    print_array_end_tag(f);
    print_array_start_tag(f, "Float64", "force_N", 1);
    print_values_in_rows(f, n, force_N, NULL, 1);
    print_array_end_tag(f);
    if (network->n_regions > 0)
        print_rest_stiffness(f, network);
    fputs("</CellData>\n", f);
}

static void print_frame_document(FILE *f, const palp_network *network, const double *force_N) {
    const palp_mesh *mesh = palp_network_mesh(network);
    size_t n_nodes = palp_mesh_node_count(mesh), n_elements = palp_mesh_element_count(mesh);
    fputs(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">\n<UnstructuredGrid>\n",
        f);
    fprintf(f, "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n", n_nodes, n_elements);
    print_points_and_motion(f, n_nodes, palp_network_positions(network), palp_mesh_positions(mesh));
    print_line_cells(f, n_elements, palp_mesh_pairs(mesh));
    print_element_values(f, network, n_elements, force_N);
    fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", f);
}

/* The frame of a network whose parts are in files of their own. */
static void print_frame_of_parts(FILE *f, const palp_vtu *series) {
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\">\n"
          "<PUnstructuredGrid GhostLevel=\"0\">\n"
          "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n"
          "<PPointData Vectors=\"displacement\">\n"
          "<PDataArray type=\"Float64\" Name=\"displacement\" NumberOfComponents=\"3\"/>\n</PPointData>\n"
          "<PCellData Scalars=\"strain\">\n"
          "<PDataArray type=\"Float64\" Name=\"strain\" NumberOfComponents=\"1\"/>\n"
          "<PDataArray type=\"Float64\" Name=\"force_N\" NumberOfComponents=\"1\"/>\n</PCellData>\n",
          f);
    for (int i = 0; i < series->parts; i++)
        fprintf(f, "<Piece Source=\"%s_%04zu_%d.vtu\"/>\n", series->name, series->n, i);
    fputs("</PUnstructuredGrid>\n</VTKFile>\n", f);
}

/* network: NULL = the frame of the parts. */
static palp_status write_frame_file(const char *path, const palp_vtu *series, const palp_network *network,
                                    const double *force_N, palp_error *error) {
    palp_file file;
    palp_locale locale;
    palp_status status = palp_file_begin(&file, path, error);
    if (status)
        return status;
    if (!palp_locale_enter(&locale)) {
        palp_file_abandon(&file);
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", path);
    }
    if (network)
        print_frame_document(file.stream, network, force_N);
    else
        print_frame_of_parts(file.stream, series);
    palp_locale_leave(&locale);
    return palp_file_commit(&file, false, error);
}

/* Makes room for one more frame. */
static bool grow_series_times(palp_vtu *series) {
    if (series->n < series->capacity)
        return true;
    size_t capacity = series->capacity ? 2 * series->capacity : 64;
    double *time_s = realloc(series->time_s, capacity * sizeof *time_s);
    if (!time_s)
        return false;
    series->time_s = time_s;
    series->capacity = capacity;
    return true;
}

static palp_status write_frame_of_parts(const palp_vtu *series, palp_error *error) {
    char ending[48];
    snprintf(ending, sizeof ending, "_%04zu.pvtu", series->n);
    char *path = path_in_series_folder(series, ending);
    palp_status status = path
                             ? write_frame_file(path, series, NULL, NULL, error)
                             : palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", series->folder);
    free(path);
    return status;
}

palp_status palp_vtu_add(palp_vtu *series, const palp_network *network, palp_error *error) {
    if (!series || !network)
        return palp_error_null(error);
    char ending[64];
    if (network->ranks) {
        series->rank = network->ranks->rank;
        series->parts = network->ranks->count;
        snprintf(ending, sizeof ending, "_%04zu_%d.vtu", series->n, series->rank);
    } else
        snprintf(ending, sizeof ending, "_%04zu.vtu", series->n);
    char *path = path_in_series_folder(series, ending);
    double *force_N = malloc((palp_mesh_element_count(palp_network_mesh(network)) + 1) * sizeof *force_N);
    palp_status status = PALP_ERR_NO_MEMORY;
    if (path && force_N && grow_series_times(series)) {
        palp_network_element_force(network, force_N);
        status = write_frame_file(path, series, network, force_N, error);
        if (!status && series->parts > 0 && series->rank == 0)
            status = write_frame_of_parts(series, error);
    } else
        palp_error_set(error, status, "%s: out of memory", series->folder);
    status = (palp_status)network_largest_of_parts(network, (double)status);
    if (!status)
        series->time_s[series->n++] = palp_network_time(network);
    free(path);
    free(force_N);
    return status;
}

static void print_series_document(FILE *f, const palp_vtu *series) {
    char text[PALP_NUMBER_TEXT];
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n", f);
    for (size_t i = 0; i < series->n; i++) {
        palp_number_format(series->time_s[i], text);
        fprintf(f, "<DataSet timestep=\"%s\" part=\"0\" file=\"%s_%04zu.%s\"/>\n", text, series->name, i,
                series->parts > 0 ? "pvtu" : "vtu");
    }
    fputs("</Collection>\n</VTKFile>\n", f);
}

static palp_status write_series_file(const palp_vtu *series, palp_error *error) {
    palp_file file;
    palp_locale locale;
    char *path = path_in_series_folder(series, ".pvd");
    if (!path || !palp_locale_enter(&locale)) {
        free(path);
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", series->folder);
    }
    palp_status status = palp_file_begin(&file, path, error);
    if (!status) {
        print_series_document(file.stream, series);
        status = palp_file_commit(&file, false, error);
    }
    palp_locale_leave(&locale);
    free(path);
    return status;
}

palp_status palp_vtu_close(palp_vtu *series, palp_error *error) {
    if (!series)
        return PALP_OK;
    palp_status status = series->rank == 0 ? write_series_file(series, error) : PALP_OK;
    free_series_memory(series);
    return status;
}
