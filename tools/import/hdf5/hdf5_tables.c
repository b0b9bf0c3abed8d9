/* hdf5_tables.c: the tables of any HDF5 file as text: a record or matrix each, or the columns of a group. */
#include "hdf5_tool.h"

#include <math.h>
#include <palpate/file.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 64, DATASETS_MAX = 1024, ALL_MAX = 4096 };

/* One column of numbers: a dataset, a field of its records (member), or a row or column of a matrix. */
typedef struct column {
    char path[TOOL_WORD], label[TOOL_WORD];
    char *member;          /* NULL: the dataset has plain numbers; else HDF5's */
    int dimensions, along; /* which dimension the rows are */
    hsize_t index, rows;   /* index: of the other dimension */
} column;

typedef struct table {
    char group[TOOL_WORD]; /* for the settings around it */
    size_t n;
    column *column[COLUMNS_MAX];
} table;

typedef struct contents {
    hid_t file;
    const char *name;
    size_t n, capacity;
    column *column; /* [n] of all datasets */
    bool whole;     /* memory sufficed */
} contents;

/* ---- what is in the file ---- */

static column *add(contents *c, const column *one) {
    if (c->n == c->capacity) {
        size_t more = c->capacity ? 2 * c->capacity : 64;
        column *larger = more <= ALL_MAX ? realloc(c->column, more * sizeof *larger) : NULL;
        if (!larger) {
            c->whole = false;
            return NULL;
        }
        c->column = larger;
        c->capacity = more;
    }
    c->column[c->n] = *one;
    return &c->column[c->n++];
}

static char **attribute_texts(hid_t set, const char *const *names, size_t *n) {
    char **texts = NULL;
    *n = 0;
    for (; *names && !texts; names++) {
        hid_t at = H5Aexists(set, *names) > 0 ? H5Aopen(set, *names, H5P_DEFAULT) : -1;
        if (at >= 0)
            texts = tool_texts(at, true, n);
        H5Aclose(at);
    }
    return texts;
}

/* "name (unit)"; name may be the label itself. */
static void set_label(hid_t set, const char *name, size_t j, char label[TOOL_WORD]) {
    static const char *const units[] = {"units", "unit", "Units", "Unit", NULL};
    char own[TOOL_WORD];
    size_t n;
    char **unit = attribute_texts(set, units, &n);
    const char *of = n == 1 ? unit[0] : j < n ? unit[j] : "";
    snprintf(own, sizeof own, *of ? "%.120s (%.40s)" : "%.120s", name, of);
    for (char *at = palp_text_make_plain(own); *at; at++)
        *at = *at == '\t' || *at == '"' ? ' ' : *at;
    memcpy(label, own, sizeof own);
    tool_free_texts(unit, n);
}

static void add_record(contents *c, hid_t set, hid_t type, column one) {
    for (int j = 0; j < H5Tget_nmembers(type) && j < COLUMNS_MAX; j++) {
        H5T_class_t class = H5Tget_member_class(type, (unsigned)j);
        if (class != H5T_INTEGER && class != H5T_FLOAT)
            continue;
        one.member = H5Tget_member_name(type, (unsigned)j);
        one.index = (hsize_t)j;
        if (one.member)
            set_label(set, one.member, (size_t)j, one.label);
        if (one.member && !add(c, &one))
            H5free_memory(one.member);
    }
}

/* The longer dimension of a matrix is its rows: MATLAB writes its own transposed. */
static void add_matrix(contents *c, hid_t set, const hsize_t size[2], column one) {
    static const char *const lists[] = {"columns", "names", "column_names", "channels", "fields", NULL};
    size_t n;
    char **names = attribute_texts(set, lists, &n);
    one.along = size[0] < size[1];
    one.rows = size[one.along];
    for (size_t j = 0; j < size[!one.along] && j < COLUMNS_MAX; j++) {
        one.index = j;
        set_label(set,
                  n == size[!one.along]   ? names[j]
                  : size[!one.along] == 1 ? one.label
                                          : "",
                  j, one.label);
        add(c, &one);
    }
    tool_free_texts(names, n);
}

static bool is_matlab_text(hid_t set) {
    static const char *const class[] = {"MATLAB_class", NULL};
    size_t n;
    char **texts = attribute_texts(set, class, &n);
    bool text = n == 1 && strcmp(texts[0], "char") == 0;
    tool_free_texts(texts, n);
    return text;
}

static void add_dataset(contents *c, hid_t set, const char *path) {
    hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    H5T_class_t class = H5Tget_class(type);
    const char *slash = strrchr(path, '/');
    hsize_t size[2] = {0, 0};
    column one = {.dimensions = H5Sget_simple_extent_ndims(space)};
    snprintf(one.path, sizeof one.path, "%s", path);
    snprintf(one.label, sizeof one.label, "%s", slash ? slash + 1 : path);
    bool numbers = (class == H5T_INTEGER || class == H5T_FLOAT) && !is_matlab_text(set);
    if (one.dimensions == 1 || one.dimensions == 2)
        H5Sget_simple_extent_dims(space, size, NULL);
    one.rows = size[0];
    if (strlen(path) >= TOOL_WORD || size[0] * (one.dimensions == 2 ? size[1] : 1) < 2) {
        /* a single value is a setting */
    } else if (class == H5T_COMPOUND && one.dimensions == 1) {
        add_record(c, set, type, one);
    } else if (numbers && one.dimensions == 2) {
        add_matrix(c, set, size, one);
    } else if (numbers && one.dimensions == 1) {
        set_label(set, one.label, 0, one.label);
        add(c, &one);
    }
    H5Tclose(type);
    H5Sclose(space);
}

static herr_t visit(hid_t file, const char *path, const H5O_info_t *info, void *data) {
    contents *c = data;
    if (info->type == H5O_TYPE_DATASET && c->n < DATASETS_MAX) {
        hid_t set = H5Dopen2(file, path, H5P_DEFAULT);
        if (set < 0)
            return -1;
        add_dataset(c, set, path);
        H5Dclose(set);
    }
    return c->whole ? 0 : -1;
}

/* ---- tables ---- */

/* Length of the part of a path before its last slash. */
static size_t group_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) : 0;
}

static bool same_group(const column *a, const column *b) {
    size_t n = group_length(a->path);
    return n == group_length(b->path) && strncmp(a->path, b->path, n) == 0;
}

/* Whether two columns can stand in one table: of one dataset, or plain columns of one group. */
static bool belongs(const column *a, const column *b, bool anywhere) {
    if (a->rows != b->rows)
        return false;
    return strcmp(a->path, b->path) == 0 || (!a->member && !b->member && (anywhere || same_group(a, b)));
}

static void gather(const contents *c, size_t i, bool anywhere, table *t) {
    t->n = 0;
    snprintf(t->group, sizeof t->group, "%.*s", (int)group_length(c->column[i].path), c->column[i].path);
    for (size_t j = 0; j < c->n && t->n < COLUMNS_MAX; j++)
        if (belongs(&c->column[i], &c->column[j], anywhere))
            t->column[t->n++] = &c->column[j];
}

/* Whether the column begins its table, and no longer one is in its group. */
static bool begins(const contents *c, size_t i, bool anywhere) {
    for (size_t j = 0; j < c->n; j++) {
        const column *one = &c->column[i], *other = &c->column[j];
        table t;
        if (j < i && belongs(one, other, anywhere))
            return false;
        if (other->rows <= one->rows || one->member || other->member || !(anywhere || same_group(one, other)))
            continue;
        gather(c, j, anywhere, &t);
        if (t.n > 1)
            return false;
    }
    return true;
}

/* ---- printing ---- */

static void print_setting(const char *key, hid_t from, bool attribute) {
    size_t n;
    double value;
    char **texts = tool_texts(from, attribute, &n);
    if (n == 1 && strlen(texts[0]) < TOOL_WORD) {
        for (char *at = palp_text_make_plain(texts[0]); *at; at++)
            *at = *at == '\t' || *at == ';' ? ',' : *at;
        printf("%s: %s\n", key, texts[0]);
    } else if (tool_number(from, attribute, &value) && isfinite(value)) {
        printf("%s: %.15g\n", key, value);
    }
    tool_free_texts(texts, n);
}

static herr_t print_attribute(hid_t object, const char *key, const H5A_info_t *info, void *data) {
    char plain[TOOL_WORD];
    (void)info, (void)data;
    hid_t at = H5Aopen(object, key, H5P_DEFAULT);
    snprintf(plain, sizeof plain, "%.80s", key);
    if (!strpbrk(palp_text_make_plain(plain), ":;\t") && strncmp(plain, "MATLAB", 6) != 0)
        print_setting(plain, at, true);
    H5Aclose(at);
    return 0;
}

static herr_t print_single(hid_t group, const char *name, const H5L_info_t *info, void *data) {
    (void)data;
    if (info->type != H5L_TYPE_HARD)
        return 0;
    hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
    if (set >= 0 && !strpbrk(name, ":;\t\n\r") && strlen(name) < 80)
        print_setting(name, set, false);
    H5Dclose(set);
    return 0;
}

/* Attributes and single values of the groups from the root to the table's own. */
static void print_settings(const contents *c, const table *t) {
    char path[TOOL_WORD];
    printf("[%s]\ngroup: /%s\n", c->name, t->group);
    for (size_t n = 0; n <= strlen(t->group); n++) {
        if (n > 0 && t->group[n] != '/' && t->group[n] != '\0')
            continue;
        snprintf(path, sizeof path, "%.*s", (int)n, t->group);
        hid_t group = H5Gopen2(c->file, n ? path : "/", H5P_DEFAULT);
        H5Aiterate2(group, H5_INDEX_NAME, H5_ITER_INC, NULL, print_attribute, NULL);
        H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, print_single, NULL);
        H5Gclose(group);
    }
}

static bool read_block(const column *one, hid_t set, hsize_t first, hsize_t n, double *to) {
    hsize_t start[2] = {one->index, one->index}, count[2] = {1, 1};
    start[one->along] = first;
    count[one->along] = n;
    hid_t space = H5Dget_space(set), memory = H5Screate_simple(1, &n, NULL), type = H5T_NATIVE_DOUBLE;
    if (one->member) {
        type = H5Tcreate(H5T_COMPOUND, sizeof *to);
        H5Tinsert(type, one->member, 0, H5T_NATIVE_DOUBLE);
    }
    bool good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
                H5Dread(set, type, memory, space, H5P_DEFAULT, to) >= 0;
    if (one->member)
        H5Tclose(type);
    H5Sclose(memory);
    H5Sclose(space);
    return good;
}

static void print_block(const table *t, size_t n, const double *value) {
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < t->n; j++) {
            double x = value[j * TOOL_BLOCK + i];
            if (isfinite(x))
                printf("%.17g", x);
            putchar(j + 1 < t->n ? '\t' : '\n');
        }
}

/* One block of rows after the other. */
static int print_rows(const contents *c, const table *t, hid_t *set, double *value) {
    hsize_t rows = t->column[0]->rows;
    for (hsize_t first = 0; first < rows; first += TOOL_BLOCK) {
        hsize_t n = rows - first < TOOL_BLOCK ? rows - first : TOOL_BLOCK;
        for (size_t j = 0; j < t->n; j++)
            if (!read_block(t->column[j], set[j], first, n, value + j * TOOL_BLOCK))
                return tool_failure(c->name, "/%s cannot be read from row %llu on", t->column[j]->path,
                                    (unsigned long long)first + 1);
        print_block(t, (size_t)n, value);
        if (ferror(stdout))
            return TOOL_FAILURE;
    }
    return TOOL_OK;
}

static int print_table(const contents *c, const table *t) {
    hid_t set[COLUMNS_MAX];
    double *value = malloc(COLUMNS_MAX * TOOL_BLOCK * sizeof *value);
    if (!value)
        return tool_failure(c->name, "out of memory");
    print_settings(c, t);
    for (size_t j = 0; j < t->n; j++) {
        set[j] = H5Dopen2(c->file, t->column[j]->path, H5P_DEFAULT);
        printf("%s%c", t->column[j]->label, j + 1 < t->n ? '\t' : '\n');
    }
    int code = print_rows(c, t, set, value);
    for (size_t j = 0; j < t->n; j++)
        H5Dclose(set[j]);
    free(value);
    return code;
}

static void add_group(column *one) {
    char label[TOOL_WORD];
    size_t n = group_length(one->path);
    snprintf(label, sizeof label, "%.*s/%.160s", (int)(n < 80 ? n : 80), one->path, one->label);
    memcpy(one->label, label, sizeof label);
}

/* Groups that hold no table of two columns may hold a column each. */
static int print_all(contents *c) {
    int code = TOOL_OK;
    size_t found = 0;
    for (int anywhere = 0; anywhere < 2 && found == 0; anywhere++)
        for (size_t i = 0; i < c->n && code == TOOL_OK; i++) {
            table t;
            gather(c, i, anywhere, &t);
            if (t.n < 2 || !begins(c, i, anywhere))
                continue;
            for (size_t j = 0; anywhere && j < t.n; j++)
                add_group(t.column[j]);
            code = print_table(c, &t);
            found++;
        }
    return code || found ? code
                         : tool_failure(c->name, "the HDF5 file has no two columns of as many numbers");
}

int tool_print_tables(hid_t file, const char *name) {
    contents c = {.file = file, .name = name, .whole = true};
    int code =
        H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, visit, &c) >= 0
            ? print_all(&c)
            : tool_failure(name, c.whole ? "the HDF5 file is damaged" : "more datasets than can be listed");
    for (size_t i = 0; i < c.n; i++)
        H5free_memory(c.column[i].member);
    free(c.column);
    return fflush(stdout) ? TOOL_FAILURE : code;
}
