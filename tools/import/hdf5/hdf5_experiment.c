/* hdf5_experiment.c: an experiment as HDF5: a dataset for each column, an attribute of the root for each key.
 * A text is a UTF-8 string and a number is a number; any other value is its JSON text as an ASCII string. */
#include "hdf5_tool.h"

#include <errno.h>
#include <palpate/file.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char MARK[] = "palpate.experiment";

/* ---- writing ---- */

static bool put_attribute(hid_t root, const char *key, hid_t type, const void *value) {
    hid_t space = H5Screate(H5S_SCALAR), at = H5Acreate2(root, key, type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool good = at >= 0 && H5Awrite(at, type, value) >= 0;
    H5Aclose(at);
    H5Sclose(space);
    return good;
}

static bool put_text(hid_t at, const char *key, H5T_cset_t set, const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1);
    bool good = type >= 0 && H5Tset_size(type, H5T_VARIABLE) >= 0 && H5Tset_cset(type, set) >= 0 &&
                put_attribute(at, key, type, &text);
    H5Tclose(type);
    return good;
}

static bool put_key(const palp_experiment *run, hid_t root, const char *key) {
    char *json = NULL;
    const char *text;
    double number;
    if (palp_experiment_get_string(run, key, &text) == PALP_OK)
        return put_text(root, key, H5T_CSET_UTF8, text);
    if (palp_experiment_get_json(run, key, &json))
        return false;
    bool good;
    if (palp_experiment_get_number(run, key, &number)) {
        good = put_text(root, key, H5T_CSET_ASCII, json);
    } else if (strpbrk(json, ".eE")) {
        good = put_attribute(root, key, H5T_NATIVE_DOUBLE, &number);
    } else {
        long long whole = strtoll(json, NULL, 10);
        good = put_attribute(root, key, H5T_NATIVE_LLONG, &whole);
    }
    free(json);
    return good;
}

/* The unit at the end of a column's name: depth_mm is in mm. */
static bool put_unit(hid_t dataset, const char *name) {
    const char *unit = strrchr(name, '_');
    return !unit || !unit[1] || put_text(dataset, "units", H5T_CSET_UTF8, unit + 1);
}

static bool put_column(const palp_experiment *run, hid_t root, const char *name) {
    hsize_t rows = palp_experiment_rows(run);
    hid_t space = H5Screate_simple(1, &rows, NULL), create = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(create, false); /* the same bytes for the same experiment */
    hid_t set = H5Dcreate2(root, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, create, H5P_DEFAULT);
    bool good = set >= 0 && put_unit(set, name) &&
                H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                         palp_experiment_column(run, name)) >= 0;
    H5Dclose(set);
    H5Pclose(create);
    H5Sclose(space);
    return good;
}

/* Keys and columns keep their order. */
static bool write_file(const palp_experiment *run, const char *path) {
    const unsigned order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    hid_t create = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_link_creation_order(create, order);
    H5Pset_attr_creation_order(create, order);
    H5Pset_obj_track_times(create, false);
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, create, H5P_DEFAULT);
    bool good = file >= 0;
    const char *key;
    for (size_t i = 0; good && (key = palp_experiment_key(run, i)); i++)
        good = put_key(run, file, key);
    for (size_t i = 0; good && i < palp_experiment_column_count(run); i++) {
        const char *name = palp_experiment_column_name(run, i);
        good = !strchr(name, '/') && put_column(run, file, name);
    }
    good = good && H5Fflush(file, H5F_SCOPE_LOCAL) >= 0;
    H5Pclose(create);
    bool closed = file >= 0 && H5Fclose(file) >= 0;
    return good && closed;
}

int tool_write_experiment(const char *csv, const char *name) {
    palp_error error = {PALP_OK, ""};
    palp_experiment *run = NULL;
    palp_file file;
    palp_status status = palp_experiment_read(csv, &run, &error);
    if (!status)
        status = palp_file_begin(&file, name, &error);
    if (!status && !*file.temporary) {
        palp_file_abandon(&file);
        palp_experiment_free(run);
        return tool_failure(name, "an HDF5 file cannot be written to a pipe or device");
    }
    errno = 0;
    if (!status && !write_file(run, file.temporary)) {
        int code = tool_failure(name, "cannot write%s%s", errno ? ": " : "", errno ? strerror(errno) : "");
        palp_file_abandon(&file);
        palp_experiment_free(run);
        return code;
    }
    palp_experiment_free(run);
    status = status ? status : palp_file_commit(&file, true, &error);
    return status ? tool_status(status, &error) : TOOL_OK;
}

/* ---- reading ---- */

typedef struct reading {
    palp_experiment *run;
    hsize_t rows;
    char name[TOOL_WORD]; /* of the attribute or column that cannot be used */
    const char *bad;      /* what is wrong with it */
} reading;

static herr_t refuse(reading *r, const char *name, const char *bad) {
    snprintf(r->name, sizeof r->name, "%s", name);
    r->bad = bad;
    return -1;
}

/* A text, or the JSON text of another value. */
static palp_status take_text(palp_experiment *run, const char *key, hid_t at) {
    size_t n;
    char **texts = tool_texts(at, true, &n);
    hid_t type = H5Aget_type(at);
    palp_status status = n == 1 ? PALP_OK : PALP_ERR_INPUT, json = PALP_ERR_INPUT;
    if (!status && H5Tget_cset(type) == H5T_CSET_ASCII)
        json = palp_experiment_set_json(run, key, texts[0]);
    if (!status && json)
        status = palp_experiment_set_string(run, key, texts[0]);
    H5Tclose(type);
    tool_free_texts(texts, n);
    return status;
}

static herr_t take_attribute(hid_t root, const char *key, const H5A_info_t *info, void *data) {
    (void)info;
    reading *r = data;
    hid_t at = H5Aopen(root, key, H5P_DEFAULT), type = H5Aget_type(at);
    double number;
    char text[32];
    palp_status status;
    if (!tool_number(at, true, &number)) {
        status = take_text(r->run, key, at);
    } else if (H5Tget_class(type) == H5T_INTEGER) {
        long long whole = 0;
        H5Aread(at, H5T_NATIVE_LLONG, &whole);
        snprintf(text, sizeof text, "%lld", whole);
        status = palp_experiment_set_json(r->run, key, text);
    } else {
        status = palp_experiment_set_number(r->run, key, number);
    }
    H5Tclose(type);
    H5Aclose(at);
    return status ? refuse(r, key, "is no key of a header with a number or text") : 0;
}

/* Number of rows of a dataset of one dimension; 0: it is something else. */
static hsize_t rows_of(hid_t set) {
    hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    H5T_class_t class = H5Tget_class(type);
    hsize_t rows = 0;
    if ((class == H5T_FLOAT || class == H5T_INTEGER) && H5Sget_simple_extent_ndims(space) == 1)
        H5Sget_simple_extent_dims(space, &rows, NULL);
    H5Tclose(type);
    H5Sclose(space);
    return rows;
}

static herr_t take_column(hid_t root, const char *name, const H5L_info_t *info, void *data) {
    (void)info;
    reading *r = data;
    hid_t set = H5Dopen2(root, name, H5P_DEFAULT);
    hsize_t rows = set < 0 ? 0 : rows_of(set);
    double *to = palp_experiment_column(r->run, name);
    palp_status status = to || rows != r->rows ? PALP_OK : palp_experiment_add_column(r->run, name);
    to = to ? to : palp_experiment_column(r->run, name);
    bool good = rows == r->rows && to && !status &&
                H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) >= 0;
    H5Dclose(set);
    return good ? 0 : refuse(r, name, "is not a readable column of as many numbers as time_s has");
}

static hsize_t rows_of_time(hid_t file) {
    hid_t time = H5Dopen2(file, "time_s", H5P_DEFAULT);
    hsize_t rows = time < 0 ? 0 : rows_of(time);
    H5Dclose(time);
    return rows;
}

static herr_t take_all(hid_t file, reading *r) {
    hid_t root = H5Gopen2(file, "/", H5P_DEFAULT), create = H5Gget_create_plist(root);
    unsigned links = 0, attributes = 0;
    H5Pget_link_creation_order(create, &links);
    H5Pget_attr_creation_order(create, &attributes);
    H5Pclose(create);
    H5Gclose(root);
    herr_t good = H5Aiterate2(file, attributes & H5P_CRT_ORDER_TRACKED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME,
                              H5_ITER_INC, NULL, take_attribute, r);
    static const char *const needed[] = {"depth_mm", "force_N"};
    for (size_t i = 0; good >= 0 && i < 2; i++)
        if (H5Lexists(file, needed[i], H5P_DEFAULT) <= 0)
            good = refuse(r, needed[i], "is missing");
    return good < 0 ? good
                    : H5Literate(file, links & H5P_CRT_ORDER_TRACKED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME,
                                 H5_ITER_INC, NULL, take_column, r);
}

/* Makes the folder of a file if it is not there; where that fails, writing says so. */
static void make_folder(const char *path) {
    char folder[4096];
    const char *slash = strrchr(path, '/');
    if (slash && slash > path && (size_t)(slash - path) < sizeof folder) {
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
        mkdir(folder, 0777);
    }
}

static palp_status write_csv(const palp_experiment *run, const char *csv, palp_error *error) {
    make_folder(csv);
    return palp_experiment_write(run, csv, error);
}

int tool_read_experiment(hid_t file, const char *name, const char *csv) {
    if (H5Aexists(file, MARK) <= 0)
        return TOOL_OTHER;
    reading r = {.rows = rows_of_time(file)};
    palp_error error = {PALP_OK, ""};
    double version = 0;
    if (r.rows == 0)
        return tool_failure(name, "time_s is missing or has no numbers");
    if (palp_experiment_create((size_t)r.rows, &r.run))
        return tool_failure(name, "out of memory");
    int code = TOOL_OK;
    if (take_all(file, &r) < 0)
        code = tool_failure(name, "%s %s", *r.name ? r.name : "the list of its parts",
                            r.bad ? r.bad : "is damaged");
    else if (palp_experiment_get_number(r.run, MARK, &version) || version != 1)
        code = tool_failure(name, "%s must be 1", MARK);
    else if (write_csv(r.run, csv, &error))
        code = tool_status(error.status, &error);
    palp_experiment_free(r.run);
    return code;
}
