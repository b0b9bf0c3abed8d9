/* experiment.h: the experiment CSV: "# key: JSON value" lines, a name row, numbers. Stable. */
#ifndef PALPATE_EXPERIMENT_H
#define PALPATE_EXPERIMENT_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_experiment palp_experiment; /* opaque; palp_experiment_free */

/* An experiment with the columns time_s, depth_mm, force_N and rows rows of zeros, and the key
 * palpate.experiment = 1. The caller frees it. ERR_NO_MEMORY. */
PALP_API palp_status palp_experiment_create(size_t rows, palp_experiment **experiment);
PALP_API void palp_experiment_free(palp_experiment *experiment); /* NULL is fine */

/* Reads a file. Unknown keys and columns are kept. ERR_INPUT with "file:line: ..." for: a line that is no "#
 * key: value"; something that is no number, or NaN or infinite; a row of the wrong width; a missing column;
 * times that do not increase; a truncated last row; a version other than 1. */
PALP_API palp_status palp_experiment_read(const char *path, palp_experiment **experiment, palp_error *error);

/* Writes to a temporary name beside path, then renames: path is never half a file. Numbers keep
 * every digit needed to read the same double back. ERR_ARGUMENT (and no file) if a number is not
 * finite or time_s does not increase. */
PALP_API palp_status palp_experiment_write(const palp_experiment *experiment, const char *path,
                                           palp_error *error);

PALP_API size_t palp_experiment_rows(const palp_experiment *experiment);

/* The numbers of a column by its name, [palp_experiment_rows], which may be written to. They are the
 * experiment's. NULL if there is no such column. */
PALP_API double *palp_experiment_column(const palp_experiment *experiment, const char *name);
PALP_API size_t palp_experiment_column_count(const palp_experiment *experiment);
PALP_API const char *palp_experiment_column_name(const palp_experiment *experiment, size_t i);
/* Adds a column of zeros; ERR_ARGUMENT if the name is taken or cannot stand in a name row (a comma, '#',
 * a blank at its ends, a digit or sign first). */
PALP_API palp_status palp_experiment_add_column(palp_experiment *experiment, const char *name);

/* Header values. The getters give ERR_INPUT if the key is absent or of another type; *value of
 * get_string is the experiment's. Setters add or replace; ERR_ARGUMENT for a number that is not
 * finite, a text that is not UTF-8, a key of other than letters, digits, '_', '.' and '-'. Keys that
 * start with "end." are written after the numbers. */
PALP_API palp_status palp_experiment_get_number(const palp_experiment *experiment, const char *key,
                                                double *value);
PALP_API palp_status palp_experiment_get_string(const palp_experiment *experiment, const char *key,
                                                const char **value);
PALP_API palp_status palp_experiment_set_number(palp_experiment *experiment, const char *key, double value);
PALP_API palp_status palp_experiment_set_string(palp_experiment *experiment, const char *key,
                                                const char *value);

/* The header's keys in the order of the file; NULL from i = their number on. */
PALP_API const char *palp_experiment_key(const palp_experiment *experiment, size_t i);

/* Any header value as JSON text, as it stands in a file: numbers with every digit that they need. The caller
 * frees *text by free. set_json adds or replaces. ERR_INPUT: the key is absent, or the text is not JSON;
 * ERR_ARGUMENT as for the other setters. */
PALP_API palp_status palp_experiment_get_json(const palp_experiment *experiment, const char *key,
                                              char **text);
PALP_API palp_status palp_experiment_set_json(palp_experiment *experiment, const char *key, const char *text);

/* Joins runs that are spread over several files. A recording continues another one of the same specimen
 * (specimen.name) if it begins under load where that one ends: in time, depth and force. of[i] is the
 * recording that begins the run which recording i is a part of; i itself if it stands alone. whole[i] is the
 * joined run where one begins at i, which the caller frees, and NULL elsewhere. A joined run has the rows of
 * its parts in turn, the columns that all parts have, and the keys of the first part. From the last part it
 * has the keys that start with "end.". ERR_NO_MEMORY: there is nothing to free. */
PALP_API palp_status palp_experiment_join(size_t n, const palp_experiment *const *run,
                                          palp_experiment **whole, size_t *of);

#ifdef __cplusplus
}
#endif
#endif
