/* hdf5_tool.h: the parts of palpate-hdf5, which palpate import runs for HDF5 files: a program of its own, so
 * that no other command loads the library, and a damaged file cannot end palpate. */
#ifndef PALPATE_HDF5_TOOL_H
#define PALPATE_HDF5_TOOL_H

#define H5Ovisit_vers 1 /* the form that all versions from 1.8 on have */
#define H5O_info_t_vers 1
#define H5Literate_vers 1
#define H5L_info_t_vers 1

#include <hdf5.h>
#include <palpate/experiment.h>
#include <stdbool.h>

enum { TOOL_OK = 0, TOOL_FAILURE = 1, TOOL_OTHER = 3 }; /* exit codes; OTHER: is no experiment of palpate */
enum { TOOL_BLOCK = 8192, TOOL_WORD = 256 };            /* rows read at a time; bytes of a text */

/* One line on stderr, with the library's own reason if it has one. Returns TOOL_FAILURE. */
int tool_failure(const char *file, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same for a failed call of the library. */
int tool_status(palp_status status, const palp_error *error);

/* The texts of an attribute or dataset, up to 64, each with NUL and plain. n = 0: it holds no texts. The
 * caller frees the list by tool_free_texts. */
char **tool_texts(hid_t from, bool attribute, size_t *n);
void tool_free_texts(char **texts, size_t n);

/* Reads an attribute or a dataset of one number; false: it is something else. */
bool tool_number(hid_t from, bool attribute, double *value);

/* The experiment that an HDF5 file is, into a CSV, and back. Exit codes. */
int tool_read_experiment(hid_t file, const char *name, const char *csv);
int tool_write_experiment(const char *csv, const char *name);

/* Prints all tables of a file as text for palpate import. */
int tool_print_tables(hid_t file, const char *name);

#endif
