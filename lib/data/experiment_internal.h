/* experiment_internal.h: the data of an experiment, for its reader and writer. */
#ifndef PALP_EXPERIMENT_INTERNAL_H
#define PALP_EXPERIMENT_INTERNAL_H

#include <palpate/experiment.h>

#include <jansson.h>
#include <stdbool.h>

typedef struct palp_column {
    char *name;
    double *values; /* [capacity], rows of them used */
} palp_column;

struct palp_experiment {
    json_t *header; /* flat: "specimen.height_mm" -> value, in the order of the file */
    size_t rows, capacity;
    size_t n_columns;
    palp_column *columns; /* [n_columns] */
};

/* Creates an experiment without columns and keys. */
palp_status palp_experiment_empty(palp_experiment **experiment);

/* Adds a column of zeros with this name[length]. */
palp_status palp_experiment_append_column(palp_experiment *experiment, const char *name, size_t length);

/* Allocates room for at least twice the rows. */
palp_status palp_experiment_grow(palp_experiment *experiment);

enum { PALP_KEY_MAX = 127 }; /* most characters of a header key */

/* 1 to PALP_KEY_MAX letters, digits, '_', '.' and '-'. */
bool palp_experiment_key_valid(const char *key, size_t length);

/* Printable without comma or '#', without blanks at the ends, and not starting like a number. */
bool palp_experiment_name_valid(const char *name, size_t length);

/* Index of a column, or n_columns. */
size_t palp_experiment_find(const palp_experiment *experiment, const char *name, size_t length);

#endif
