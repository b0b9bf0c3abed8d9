/* reduce_file.c: a reduced model as JSON, with its arrays in a binary file next to it. The binary file:
 * "PALPRED1", the number 0x01020304 twice in this machine's byte order (4 bytes each), the sizes (8 bytes
 * each: nodes, modes, elements, triangles), then the arrays of `list_saved_arrays` below in order. */
#include "reduce_internal.h"

#include "base/json.h"
#include "base/text.h"
#include "model/model_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char MAGIC[8] = {'P', 'A', 'L', 'P', 'R', 'E', 'D', '1'};
enum { ORDER = 0x01020304, HEAD = 48, ARRAYS = 10 };

typedef struct array {
    void *data;
    size_t bytes;
} array;

static void list_saved_arrays(palp_reduced *r, array list[ARRAYS]) {
    size_t n3 = 3 * r->n_nodes, f = sizeof(double), i = sizeof(int32_t);
    const array all[ARRAYS] = {{r->rest, n3 * f},
                               {r->lift, n3 * f},
                               {r->basis, n3 * r->modes * f},
                               {r->weight, r->n_elements * f},
                               {r->low, (r->modes + 1) * f},
                               {r->high, (r->modes + 1) * f},
                               {r->unit, r->n_nodes * f},
                               {r->pair, 2 * r->n_elements * i},
                               {r->triangles, 3 * r->n_triangles * i},
                               {r->fixed, n3}};
    memcpy(list, all, sizeof all);
}

/* FNV-1a, 64 bits. */
static uint64_t update_fnv_checksum(uint64_t sum, const void *data, size_t n) {
    const unsigned char *byte = data;
    for (size_t i = 0; i < n; i++)
        sum = (sum ^ byte[i]) * 0x100000001b3u;
    return sum;
}

static const uint64_t CHECKSUM_START = 0xcbf29ce484222325u;

static void make_binary_header(const palp_reduced *r, unsigned char head[HEAD]) {
    const uint32_t order[2] = {ORDER, ORDER};
    const uint64_t size[4] = {r->n_nodes, r->modes, r->n_elements, r->n_triangles};
    memcpy(head, MAGIC, 8);
    memcpy(head + 8, order, 8);
    memcpy(head + 16, size, 32);
}

/* path with .bin instead of .json. */
static palp_status binary_path_of_model(const char *path, char out[PALP_PATH_MAX]) {
    size_t n = strlen(path);
    if (n >= 5 && strcmp(path + n - 5, ".json") == 0)
        n -= 5;
    if (n + 5 > PALP_PATH_MAX)
        return PALP_ERR_LIMIT;
    memcpy(out, path, n);
    memcpy(out + n, ".bin", 5);
    return PALP_OK;
}

typedef struct sums {
    size_t bytes;
    uint64_t checksum;
} sums;

static sums write_binary_arrays(const palp_reduced *r, FILE *to) {
    unsigned char head[HEAD];
    array list[ARRAYS];
    palp_reduced copy = *r; /* its arrays are only read */
    make_binary_header(r, head);
    list_saved_arrays(&copy, list);
    sums out = {HEAD, update_fnv_checksum(CHECKSUM_START, head, HEAD)};
    fwrite(head, 1, HEAD, to);
    for (size_t i = 0; i < ARRAYS; i++) {
        if (list[i].bytes > 0)
            fwrite(list[i].data, 1, list[i].bytes, to);
        out.bytes += list[i].bytes;
        out.checksum = update_fnv_checksum(out.checksum, list[i].data, list[i].bytes);
    }
    return out;
}

static json_t *number_or_null(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *error_summary_as_json(const palp_reduced_summary *s) {
    double worst = s->held_out_paths ? s->held_out_worst : INFINITY,
           rms = s->held_out_paths ? s->held_out_rms : INFINITY;
    return json_pack("{s:f, s:f, s:o, s:o, s:f, s:o}", "element_residual", s->element_residual,
                     "snapshot_worst", s->snapshot_worst, "held_out_worst", number_or_null(worst),
                     "held_out_rms", number_or_null(rms), "held_out_peak_N", s->held_out_peak_N, "bound",
                     number_or_null(s->bound));
}

static json_t *tool_settings_as_json(const palp_reduced *r) {
    const palp_contact_settings *c = &r->contact_settings;
    return r->max_tools == 0
               ? json_null()
               : json_pack("{s:I, s:f, s:f, s:f, s:I}", "at_once", (json_int_t)r->max_tools, "stiffness",
                           c->stiffness, "grasp_stiffness", c->grasp_stiffness, "smoothing", c->smoothing,
                           "max_contacts", (json_int_t)c->max_contacts);
}

static json_t *reduced_model_as_json(const palp_reduced *r, json_t *network, const char *file, sums check) {
    const palp_reduced_summary *s = &r->summary;
    char sum[24];
    snprintf(sum, sizeof sum, "%016llx", (unsigned long long)check.checksum);
    return json_pack(
        "{s:{s:i}, s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:o, s:o, s:{s:s, s:I, s:s}}", "palpate",
        "reduced", 1, "network", network, "nodes", (json_int_t)r->n_nodes, "unknowns",
        (json_int_t)s->unknowns, "network_elements", (json_int_t)s->network_elements, "modes",
        (json_int_t)r->modes, "elements", (json_int_t)r->n_elements, "triangles", (json_int_t)r->n_triangles,
        "snapshot_paths", (json_int_t)s->snapshot_paths, "held_out_paths", (json_int_t)s->held_out_paths,
        "height_mm", 1e3 * s->height_m, "error", error_summary_as_json(s), "tools", tool_settings_as_json(r),
        "arrays", "file", file, "bytes", (json_int_t)check.bytes, "checksum", sum);
}

/* Writes the arrays, then the model with their name and checksum. */
static palp_status write_model_and_arrays(const palp_reduced *r, const char *model, const char *file,
                                          palp_file *text, palp_file *arrays, palp_error *error) {
    sums check = write_binary_arrays(r, arrays->stream);
    json_t *network = json_loads(model, 0, NULL);
    json_t *root = network ? reduced_model_as_json(r, network, file, check) : NULL;
    if (root) {
        json_dumpf(root, text->stream, JSON_INDENT(2)); /* errors of the stream are checked later */
        fputc('\n', text->stream);
        json_decref(root);
        return palp_file_commit_pair(arrays, text, true, error);
    }
    palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", text->path);
    palp_file_abandon(text);
    palp_file_abandon(arrays);
    return PALP_ERR_NO_MEMORY;
}

palp_status palp_reduced_write(const palp_reduced *r, const palp_model *model, const char *path,
                               palp_error *error) {
    if (!r || !model || !path)
        return palp_error_null(error);
    char beside[PALP_PATH_MAX], *network = NULL;
    palp_file text, arrays_file;
    palp_status status = binary_path_of_model(path, beside);
    const char *slash = status ? NULL : strrchr(beside, '/'), *file = slash ? slash + 1 : beside;
    if (status)
        return palp_error_set(error, status, "%s: not written: the path is too long", path);
    if (!palp_text_is_utf8(file))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "%s: not written: the name of its .bin file is not UTF-8, which JSON requires",
                              path);
    status = palp_model_format(model, &network);
    if (status)
        return palp_error_set(error, status, "%s: not written: the model: %s", path,
                              palp_status_text(status));
    status = palp_file_begin(&arrays_file, beside, error);
    if (!status) {
        status = palp_file_begin(&text, path, error);
        if (status)
            palp_file_abandon(&arrays_file);
        else
            status = write_model_and_arrays(r, network, file, &text, &arrays_file, error);
    }
    free(network);
    return status;
}

static palp_status read_whole_number(const palp_json *at, const char *key, size_t *value) {
    palp_json member;
    palp_status status = palp_json_require(at, key, &member);
    if (status)
        return status;
    if (!json_is_integer(member.value) || json_integer_value(member.value) < 0 ||
        json_integer_value(member.value) > INT32_MAX)
        return palp_json_fail(&member, PALP_ERR_INPUT, "must be a whole number, 0 or more");
    *value = (size_t)json_integer_value(member.value);
    return PALP_OK;
}

/* A number >= 0; absent is the value for null, if that is allowed. */
static palp_status read_number_or_null(const palp_json *at, const char *key, double absent, double *value) {
    palp_json member;
    palp_status status = palp_json_require(at, key, &member);
    *value = absent;
    if (status || (json_is_null(member.value) && !isnan(absent)))
        return status;
    return palp_json_not_negative(&member, value);
}

static palp_status read_reduced_version(const palp_json *root) {
    palp_json palpate, version;
    if (!json_is_object(root->value) || !palp_json_member(root, "palpate", &palpate) ||
        !json_is_object(palpate.value) || !palp_json_member(&palpate, "reduced", &version))
        return palp_json_fail(root, PALP_ERR_INPUT,
                              "not a reduced model: it lacks \"palpate\": {\"reduced\": 1}");
    if (!json_is_integer(version.value) || json_integer_value(version.value) != 1)
        return palp_json_fail(&version, PALP_ERR_INPUT, "is not 1, the version that this build reads");
    return PALP_OK;
}

static palp_status read_network_model(const palp_json *root, palp_model *model, palp_mesh_source *mesh) {
    palp_json network;
    palp_status status = palp_json_require(root, "network", &network);
    if (!status)
        status = palp_model_from_json(&network, model, mesh);
    if (!status && model->kind != PALP_MODEL_NETWORK)
        status = palp_json_fail(&network, PALP_ERR_INPUT, "is not a model of kind \"network\"");
    return status;
}

static palp_status read_array_sizes(const palp_json *root, palp_reduced *r) {
    const struct {
        const char *key;
        size_t *to;
    } counts[] = {{"nodes", &r->n_nodes},
                  {"modes", &r->modes},
                  {"elements", &r->n_elements},
                  {"triangles", &r->n_triangles},
                  {"unknowns", &r->summary.unknowns},
                  {"network_elements", &r->summary.network_elements},
                  {"snapshot_paths", &r->summary.snapshot_paths},
                  {"held_out_paths", &r->summary.held_out_paths}};
    palp_status status = PALP_OK;
    for (size_t i = 0; i < sizeof counts / sizeof *counts && !status; i++)
        status = read_whole_number(root, counts[i].key, counts[i].to);
    r->summary.modes = r->modes;
    r->summary.elements = r->n_elements;
    if (!status)
        status = read_number_or_null(root, "height_mm", NAN, &r->summary.height_m);
    r->summary.height_m *= 1e-3;
    return status;
}

static palp_status read_error_summary(const palp_json *root, palp_reduced_summary *s) {
    static const char *const keys[] = {"element_residual", "held_out_worst", "held_out_rms",
                                       "held_out_peak_N",  "bound",          "snapshot_worst"};
    static const double absent[] = {NAN, 0.0, 0.0, NAN, INFINITY, NAN};
    double *const to[] = {&s->element_residual, &s->held_out_worst, &s->held_out_rms,
                          &s->held_out_peak_N,  &s->bound,          &s->snapshot_worst};
    palp_json at;
    palp_status status = palp_json_require(root, "error", &at);
    if (!status)
        status = palp_json_keys(&at, 6, keys);
    for (size_t i = 0; i < 6 && !status; i++)
        status = read_number_or_null(&at, keys[i], absent[i], to[i]);
    return status;
}

static palp_status read_tool_settings(const palp_json *root, palp_reduced *r) {
    static const char *const keys[] = {"stiffness", "grasp_stiffness", "smoothing", "at_once",
                                       "max_contacts"};
    palp_contact_settings *c = &r->contact_settings;
    double *const number[] = {&c->stiffness, &c->grasp_stiffness, &c->smoothing};
    size_t *const count[] = {&r->max_tools, &c->max_contacts};
    palp_json at;
    palp_status status = palp_json_require(root, "tools", &at);
    if (status || json_is_null(at.value))
        return status;
    status = palp_json_keys(&at, 5, keys);
    for (size_t i = 0; i < 5 && !status; i++)
        status = i < 3 ? read_number_or_null(&at, keys[i], NAN, number[i])
                       : read_whole_number(&at, keys[i], count[i - 3]);
    bool sound = c->stiffness > 0.0 && c->grasp_stiffness > 0.0 && c->smoothing > 0.0 && r->max_tools <= 1000;
    if (!status && !sound)
        status = palp_json_fail(&at, PALP_ERR_INPUT, "has a number out of range");
    return status;
}

/* What contradicts the header, as a sentence, or NULL. */
static const char *describe_wrong_bytes(const palp_reduced *r, const char *bytes, size_t size, size_t want,
                                        const char *sum) {
    unsigned char head[HEAD];
    char is[24];
    make_binary_header(r, head);
    if (size < HEAD || memcmp(bytes, MAGIC, sizeof MAGIC) != 0)
        return "are not those of a reduced model";
    if (memcmp(bytes + 8, head + 8, 8) != 0)
        return "have the byte order of another machine";
    if (memcmp(bytes + 16, head + 16, HEAD - 16) != 0)
        return "have sizes that differ from the model's";
    if (size != want)
        return "have the wrong length";
    snprintf(is, sizeof is, "%016llx", (unsigned long long)update_fnv_checksum(CHECKSUM_START, bytes, size));
    return strcmp(is, sum) != 0 ? "have the wrong checksum: damaged, or of another model" : NULL;
}

static bool are_all_values_finite(const double *x, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] * 0.0;
    return sum == 0.0;
}

static bool are_nodes_in_range(const int32_t *node, size_t n, size_t n_nodes) {
    for (size_t i = 0; i < n; i++)
        if (node[i] < 0 || (size_t)node[i] >= n_nodes)
            return false;
    return true;
}

static bool are_arrays_valid(const palp_reduced *r) {
    size_t n3 = 3 * r->n_nodes;
    bool sound = are_all_values_finite(r->rest, n3) && are_all_values_finite(r->lift, n3) &&
                 are_all_values_finite(r->basis, n3 * r->modes) &&
                 are_all_values_finite(r->weight, r->n_elements) &&
                 are_all_values_finite(r->low, r->modes + 1) &&
                 are_all_values_finite(r->high, r->modes + 1) && are_all_values_finite(r->unit, r->n_nodes) &&
                 are_nodes_in_range(r->pair, 2 * r->n_elements, r->n_nodes) &&
                 are_nodes_in_range(r->triangles, 3 * r->n_triangles, r->n_nodes);
    for (size_t i = 0; i < r->n_elements && sound; i++)
        sound = r->weight[i] >= 0.0 && memcmp(r->rest + 3 * r->pair[2 * i], r->rest + 3 * r->pair[2 * i + 1],
                                              3 * sizeof *r->rest) != 0;
    return sound;
}

/* Size of the arrays in bytes; 0 if it is impossibly large. */
static size_t expected_array_bytes(palp_reduced *r) {
    array list[ARRAYS];
    size_t sum = HEAD;
    if (r->n_nodes == 0 || r->modes > 10000 || (double)r->n_nodes * (double)(r->modes + 10) > 1e11)
        return 0;
    list_saved_arrays(r, list);
    for (size_t i = 0; i < ARRAYS; i++)
        sum += list[i].bytes;
    return sum;
}

static palp_status fill_arrays_from_bytes(const palp_json *at, palp_reduced *r, const char *bytes) {
    array list[ARRAYS];
    palp_status status = reduced_allocate(r);
    if (status)
        return palp_json_fail(at, status, ": out of memory");
    list_saved_arrays(r, list);
    for (size_t i = 0, from = HEAD; i < ARRAYS; from += list[i++].bytes)
        if (list[i].bytes > 0)
            memcpy(list[i].data, bytes + from, list[i].bytes);
    if (!are_arrays_valid(r))
        return palp_json_fail(at, PALP_ERR_INPUT, "has a number out of range");
    return reduced_prepare(r);
}

static palp_status read_binary_arrays(const palp_json *root, palp_reduced *r, palp_error *error) {
    static const char *const keys[] = {"file", "bytes", "checksum"};
    palp_json at, file, sum;
    const char *name = "", *check = "";
    char folder[PALP_PATH_MAX], path[PALP_PATH_MAX], *bytes = NULL;
    size_t size = 0, want = expected_array_bytes(r), said = 0;
    palp_status status = palp_json_require(root, "arrays", &at);
    if (!status)
        status = palp_json_keys(&at, 3, keys);
    if (!status)
        status = palp_json_require(&at, "file", &file);
    if (!status)
        status = palp_json_string(&file, &name);
    if (!status)
        status = palp_json_require(&at, "checksum", &sum);
    if (!status)
        status = palp_json_string(&sum, &check);
    if (!status)
        status = read_whole_number(&at, "bytes", &said);
    if (status)
        return status;
    if (want == 0 || said != want)
        return palp_json_fail(&at, PALP_ERR_INPUT, "does not agree with the sizes above");
    if (palp_model_folder(root->file->path, folder) || palp_model_join(folder, name, path))
        return palp_json_fail(&file, PALP_ERR_LIMIT, "has too long a path");
    status = palp_file_read(path, &bytes, &size, error);
    const char *wrong = status ? NULL : describe_wrong_bytes(r, bytes, size, want, check);
    if (wrong)
        status = palp_json_fail(&file, PALP_ERR_INPUT, ": the arrays in %s %s", name, wrong);
    if (!status)
        status = fill_arrays_from_bytes(&file, r, bytes);
    free(bytes);
    return status;
}

static palp_status read_model_from_json(const palp_json *root, palp_model *model, palp_mesh_source *mesh,
                                        palp_reduced *r, palp_error *error) {
    static const char *const keys[] = {
        "palpate",   "network",  "nodes",     "unknowns",       "network_elements",
        "modes",     "elements", "triangles", "snapshot_paths", "held_out_paths",
        "height_mm", "error",    "tools",     "arrays"};
    palp_status status = read_reduced_version(root);
    if (!status)
        status = palp_json_keys(root, sizeof keys / sizeof *keys, keys);
    if (!status)
        status = read_network_model(root, model, mesh);
    if (!status) {
        r->material = model->material;
        status = read_array_sizes(root, r);
    }
    if (!status)
        status = read_error_summary(root, &r->summary);
    if (!status)
        status = read_tool_settings(root, r);
    return status ? status : read_binary_arrays(root, r, error);
}

palp_status palp_reduced_read(const char *path, palp_model *model, palp_mesh_source *mesh,
                              palp_reduced **reduced, palp_error *error) {
    if (!path || !reduced)
        return palp_error_null(error);
    palp_json_file file;
    palp_json root;
    palp_model made;
    palp_mesh_source unwanted;
    palp_reduced *r = calloc(1, sizeof *r);
    if (!r)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", path);
    palp_status status = palp_json_open(path, &file, &root, error);
    if (!status) {
        status = read_model_from_json(&root, &made, mesh ? mesh : &unwanted, r, error);
        palp_json_close(&file);
    }
    if (status) {
        palp_reduced_free(r);
        return status;
    }
    if (!mesh)
        made.mesh = NULL;
    if (model)
        *model = made;
    *reduced = r;
    return PALP_OK;
}
