/* import.h: the parts of palpate import: a file's table, what its columns are, signs and contact. */
#ifndef PALPATE_IMPORT_H
#define PALPATE_IMPORT_H

#include "shared/cli.h"

#include <palpate/experiment.h>
#include <stdint.h>

enum { IMPORT_COLUMNS = 64, IMPORT_SETTINGS = 64, IMPORT_NAME = 512, IMPORT_WORD = 96 };
enum { TIME, DEPTH, FORCE, QUANTITIES };

typedef enum import_format { IMPORT_MACH1, IMPORT_INSTRON, IMPORT_CSV } import_format;
typedef enum import_contact { CONTACT_AUTO, CONTACT_AIR, CONTACT_START, CONTACT_RECORDED } import_contact;

/* What the user says; -1 or 0 or NULL = nothing. */
typedef struct import_options {
    int format, contact, protocol, separator; /* indices of the choices */
    const char *map, *units, *negate, *kind, *license, *out;
    double height_mm, radius_mm;
    size_t skip_lines; /* SIZE_MAX = find the names */
    bool force;        /* replaces recordings */
    size_t n_files;
    const char **files; /* that are imported */
} import_options;

/* A text file in memory, read line by line. Splitting a line changes it. */
typedef struct import_text {
    const char *file;  /* for messages */
    char *text, *at;   /* NUL-terminated; at = the next line or NULL */
    size_t size, line; /* line = number of the line last returned, from 1 */
    uint32_t crc32;
} import_text;

int import_text_read(const char *file, import_text *text); /* an exit code */
void import_text_free(import_text *text);
char *import_line(import_text *text); /* without its end; NULL at the end of the file */

/* Cuts a line at the separator (not inside "..."), trims the fields; empty ones at the end do not count. */
size_t import_split(char *line, char separator, char *fields[IMPORT_COLUMNS]);

/* A number; where the separator is not ',', a comma is a decimal point too. */
bool import_number(const char *field, char separator, double *value);

/* One table of a file and, later, the recording it holds. */
typedef struct import_source {
    const char *file;
    char name[IMPORT_NAME];  /* of the output, without .csv */
    char block[IMPORT_WORD]; /* Mach-1: "Find Contact" */
    import_format format;
    size_t size;
    uint32_t crc32;
    size_t n_settings;
    char setting[IMPORT_SETTINGS][2][IMPORT_WORD]; /* key, value */
    /* the table: value[row * n_columns + column], NAN = no number; line[row] = of the file */
    char separator;
    size_t n_columns, rows, capacity;
    char column[IMPORT_COLUMNS][IMPORT_WORD];
    double *value;
    size_t *line;
    size_t used[QUANTITIES]; /* which column is time, depth, force */
    char unit[QUANTITIES][8];
    const char *skip; /* why a Mach-1 block holds nothing to import; else NULL */
    /* the recording: [rows] each; signs and zero applied by import_contact */
    double *time_s, *depth_mm, *force_N;
    double height_mm, radius_mm;
    double depth_sign, force_sign;        /* -1 = reversed */
    const char *sign_rule, *contact_rule; /* in words; free_air, find_contact, ... */
    const char *contact_from;             /* name of the approach that shows the contact; NULL = itself */
    double first_mm, last_mm;             /* positions as recorded, but for the sign */
    double contact_mm, contact_sd_mm;     /* position there that is depth 0 */
    double zero_N;                        /* force recorded, but for the sign, that is force 0 */
    double preload_N;                     /* approach: force it ends at */
    const char *protocol;
} import_source;

typedef struct import_sources {
    size_t n, capacity;
    import_source **source;
} import_sources;

/* Reads a file's tables, one or more, and appends them. An exit code, after one line on stderr if it is not 0. */
int import_read(const import_options *o, const char *file, import_sources *all);
void import_free(import_sources *all);
const char *import_setting(const import_source *s, const char *key);   /* its value; NULL = not there */
double import_setting_number(const import_source *s, const char *key); /* "50mm" is 50; 0 = not there */

/* Finds which columns are time, depth and force, and their units; then the recording in SI and mm. */
int import_columns(const import_options *o, import_source *s);

bool import_is_approach(const import_source *s); /* a Mach-1's search for the contact */

/* Signs, then contact and zero force; relaxation files look in all for the approach that ended where they
 * start, whose contact was found before. */
int import_signs(const import_options *o, import_source *s);
int import_contact_find(const import_options *o, const import_sources *all, import_source *s);

/* Height and radius (an exit code if there is no height), and protocol. */
int import_specimen(const import_options *o, import_source *s);
void import_protocol(const import_options *o, import_source *s);

/* OUT/NAME.csv */
int import_write(const import_options *o, const import_source *s);

#endif
