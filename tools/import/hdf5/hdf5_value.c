/* hdf5_value.c: single texts and numbers of HDF5 attributes and datasets. */
#include "hdf5_tool.h"

#include <palpate/file.h>
#include <stdlib.h>
#include <string.h>

enum { TEXTS_MAX = 64 };

static hid_t space_of(hid_t from, bool attribute) {
    return attribute ? H5Aget_space(from) : H5Dget_space(from);
}

static hid_t type_of(hid_t from, bool attribute) {
    return attribute ? H5Aget_type(from) : H5Dget_type(from);
}

static bool fetch(hid_t from, bool attribute, hid_t type, void *to) {
    return (attribute ? H5Aread(from, type, to) : H5Dread(from, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to)) >=
           0;
}

static size_t points(hid_t from, bool attribute) {
    hid_t space = space_of(from, attribute);
    hssize_t n = space < 0 ? 0 : H5Sget_simple_extent_npoints(space);
    H5Sclose(space);
    return n > 0 ? (size_t)n : 0;
}

/* Texts of their own length each. */
static bool fetch_long(hid_t from, bool attribute, hid_t type, size_t n, char **to) {
    char *own[TEXTS_MAX] = {NULL};
    hid_t space = space_of(from, attribute);
    bool good = fetch(from, attribute, type, own);
    for (size_t i = 0; good && i < n; i++) {
        to[i] = malloc((own[i] ? strlen(own[i]) : 0) + 1);
        good = to[i] != NULL;
        if (good)
            strcpy(to[i], own[i] ? own[i] : "");
    }
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, own);
    H5Sclose(space);
    return good;
}

/* Texts of one length, perhaps without NUL. */
static bool fetch_fixed(hid_t from, bool attribute, hid_t type, size_t n, char **to) {
    size_t size = H5Tget_size(type);
    char *all = size > 0 && size < 65536 ? calloc(n, size) : NULL;
    bool good = all && fetch(from, attribute, type, all);
    for (size_t i = 0; good && i < n; i++) {
        to[i] = calloc(1, size + 1);
        good = to[i] != NULL;
        if (good)
            memcpy(to[i], all + i * size, size);
        for (size_t k = size; good && H5Tget_strpad(type) == H5T_STR_SPACEPAD && k > 0 && to[i][k - 1] == ' ';
             k--)
            to[i][k - 1] = '\0';
    }
    free(all);
    return good;
}

char **tool_texts(hid_t from, bool attribute, size_t *n) {
    hid_t type = type_of(from, attribute);
    size_t count = points(from, attribute);
    char **texts = NULL;
    bool is_text = type >= 0 && H5Tget_class(type) == H5T_STRING && count > 0 && count <= TEXTS_MAX;
    bool good = is_text && (texts = calloc(count, sizeof *texts)) != NULL;
    good = good && (H5Tis_variable_str(type) > 0 ? fetch_long(from, attribute, type, count, texts)
                                                 : fetch_fixed(from, attribute, type, count, texts));
    H5Tclose(type);
    if (!good) {
        tool_free_texts(texts, count);
        texts = NULL;
    }
    *n = good ? count : 0;
    return texts;
}

void tool_free_texts(char **texts, size_t n) {
    for (size_t i = 0; texts && i < n; i++)
        free(texts[i]);
    free(texts);
}

bool tool_number(hid_t from, bool attribute, double *value) {
    hid_t type = type_of(from, attribute);
    H5T_class_t class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    H5Tclose(type);
    return (class == H5T_INTEGER || class == H5T_FLOAT) && points(from, attribute) == 1 &&
           fetch(from, attribute, H5T_NATIVE_DOUBLE, value);
}
