/* import.h: the parts of palpate import: a file's text, its tables, what their columns are, signs and
 * contact. */
#ifndef PALPATE_IMPORT_H
#define PALPATE_IMPORT_H

#include "shared/cli.h"

#include <palpate/experiment.h>
#include <stdint.h>
#include <stdio.h>

enum { IMPORT_COLUMNS = 64, IMPORT_SETTINGS = 160, IMPORT_NAME = 512, IMPORT_WORD = 96, IMPORT_NOTE = 256 };

/* The meaning of a column. The first three make an experiment; the others can replace them. */
enum { TIME, DEPTH, FORCE, QUANTITIES, STRESS = QUANTITIES, STRAIN, DEFLECTION, ROLES };
#define IMPORT_NONE SIZE_MAX /* no column */

typedef enum import_format { IMPORT_MACH1, IMPORT_INSTRON, IMPORT_CSV } import_format;
typedef enum import_contact { CONTACT_AUTO, CONTACT_AIR, CONTACT_START, CONTACT_RECORDED } import_contact;

/* The options; -1, 0 or NULL = not given. */
typedef struct import_options {
    int format, contact, protocol, separator, tip; /* indices of the choices */
    const char *map, *units, *negate, *kind, *specimen, *session, *license, *out;
    double height_mm, radius_mm, area_mm2, spring_N_m, rate_Hz, tip_radius_mm, tip_angle_deg;
    double from_s, to_s; /* NAN: no from or to */
    size_t skip_lines;   /* SIZE_MAX = find the names */
    bool force;          /* replaces recordings */
    bool strict;         /* stops where rows would be skipped */
    bool folder;         /* a folder was named: its files are one session */
    size_t n_files;
    const char **files; /* that are imported */
} import_options;

/* ---- the text ---- */

/* A file in memory as UTF-8, line by line. Splitting a line changes it. */
typedef struct import_text {
    const char *file;        /* for messages */
    char *text;              /* NUL-terminated */
    char **lines;            /* [n] in it, without their ends */
    size_t n, longest, line; /* line = number of the line last returned by import_line, from 1 */
    size_t size;             /* of the file, bytes */
    uint32_t crc32;          /* of the file */
} import_text;

/* A file without a table, such as a licence or a picture, is skipped with a note in a folder; if it is named,
 * it is an error. */
bool import_left_out(const import_options *o, const char *file);

int import_text_read(const char *file, import_text *text); /* an exit code */
void import_text_free(import_text *text);
char *import_line(import_text *text);                   /* the next; NULL at the end of the file */
int import_sheet_read(import_text *text, size_t *size); /* a spreadsheet becomes its text; all else stays */

/* Output of a program, malloc'ed; FILE among its words stands for the file. NULL unless it ended with *code
 * 0; -1: a signal ended it; IMPORT_MISSING: it is not installed. quiet: its standard error is not shown. */
enum { IMPORT_MISSING = 127 };
char *import_run(const char *const words[], const char *file, bool quiet, size_t *size, int *code);

/* HDF5 files, by the program palpate-hdf5: their tables as text; and experiments of palpate that need no
 * import. import_convert writes those and takes them from the files of o. */
bool import_hdf5_is(const char *file);
int import_hdf5_read(import_text *text);
int import_convert(import_options *o);
bool import_out_is_file(const import_options *o); /* --out names a file, not a folder */

/* Where a source's recording, or that of a file, is written. An exit code. */
int import_out_path(const import_options *o, const char *name, char path[CLI_PATH_MAX]);

/* ---- how rows are written ---- */

typedef struct import_dialect {
    char separator, decimal, thousands; /* a blank as separator: blanks and tabs, any number of them */
} import_dialect;

/* chosen: index of --separator or -1; scratch[longest + 1]. */
void import_dialect_find(const import_text *text, int chosen, char *scratch, import_dialect *dialect);

/* Splits a line at the separator (not inside "...") and trims the fields; empty ones at the end do not count.
 */
size_t import_split(char *line, char separator, char *fields[IMPORT_COLUMNS]);

/* A number, perhaps with a unit after it; *end: where it ends. */
bool import_number(const char *field, const import_dialect *d, double *value);
bool import_number_unit(const char *field, const import_dialect *d, double *value, const char **rest);

/* A time of day, or since the start, h:mm:ss or mm:ss with a fraction, perhaps after a date (dated: s since
 * 1970). */
bool import_clock(const char *text, double *seconds, bool *dated);

/* ---- words ---- */

typedef enum import_dimension {
    UNIT_TIME,
    UNIT_LENGTH,
    UNIT_FORCE,
    UNIT_STRESS,
    UNIT_RATIO,
    UNIT_VOLT,
    UNIT_AREA,
    UNIT_SPRING,
    UNIT_SLOPE,
    UNIT_RATE,
    UNIT_OTHER
} import_dimension;

typedef struct import_unit {
    import_dimension dimension;
    const char *name;
    double factor; /* to s, mm, N, Pa, 1, V, mm2, N/m, mm/V, Hz */
} import_unit;

const import_unit *import_unit_find(const char *name); /* NULL = none */
bool import_unit_any(const char *name);
const import_unit *import_unit_of_name(const char *name); /* of a column's name: "Position (z), mm" */
bool import_unit_fits(const import_unit *unit, int role);
void import_plain(const char *from, bool lower, char *to, size_t room); /* without accents */

/* Confidence that a column of this name and unit (NULL = none) is a quantity: 0 = not, 1 = by its unit, up
 * to 4. */
int import_name_rank(const char *name, const import_unit *unit, int role);

bool import_names_in_han(const char *text); /* whether a text names two columns in Chinese or Japanese */
bool import_names_gap(const char *name);    /* of a column with the remaining height or gap */

enum {
    PART_HEIGHT,
    PART_DIAMETER,
    PART_RADIUS,
    PART_AREA,
    PART_SPRING,
    PART_SENSITIVITY,
    PART_RATE,
    PART_INTERVAL,
    PART_TIP_RADIUS,
    PART_TIP_DIAMETER,
    PARTS
};
int import_part_rank(const char *name, int part); /* of a setting, likewise */

/* ---- one table of a file and, later, the recording it holds ---- */

typedef struct import_source {
    const char *file;
    char name[IMPORT_NAME];  /* of the output, without .csv */
    char block[IMPORT_WORD]; /* Mach-1: "Find Contact" */
    import_format format;
    size_t size;
    uint32_t crc32;
    size_t n_settings;
    char setting[IMPORT_SETTINGS][2][IMPORT_WORD]; /* key, value */
    double stamp_s; /* start, s since 1970 or midnight; NAN = not in the file */
    bool stamp_dated;
    /* the table: value[row * n_columns + column], NAN = no number; line[row] = of the file */
    import_dialect dialect;
    size_t n_columns, rows, capacity;
    char column[IMPORT_COLUMNS][IMPORT_WORD];
    bool clock[IMPORT_COLUMNS]; /* its numbers are times of day */
    double *value;
    size_t *line;
    size_t group, groups; /* of specimens side by side: which, from 1, and of how many; 0 = not so */
    bool rated;           /* the time is by the rate of sampling */
    size_t used[ROLES];   /* which column it is, or IMPORT_NONE */
    int role[QUANTITIES]; /* what the time, depth and force come from */
    const import_unit *unit[ROLES];
    bool listed[ROLES];   /* by --map */
    bool seconds_assumed; /* the time has no unit in the file */
    size_t bad, bad_line, doubled, doubled_line, restarts,
        segments; /* skipped rows, and the line of the first */
    size_t lost;  /* missing samples, by the sampling interval */
    double step_s;
    const char *skip; /* why a Mach-1 block cannot be imported; else NULL */
    /* the recording: [rows] each; signs and zero applied by import_contact */
    double *time_s, *depth_mm, *force_N;
    double height_mm, radius_mm, spring_N_m, slope_mm_V;
    const char *height_from, *radius_from; /* in words */
    const char *tip;                       /* shape of the indenter; NULL = unknown */
    double tip_radius_mm, tip_angle_deg;   /* 0 = nothing says */
    bool gap, piezo;               /* the depth column is the remaining height; that of a cantilever's base */
    double depth_sign, force_sign; /* -1 = reversed */
    import_contact rule;
    bool agreed;                          /* the contact rule was chosen by similar presses */
    const char *sign_rule, *contact_rule; /* in words; free_air, find_contact, ... */
    const char *contact_from;             /* name of the approach with the contact; NULL = itself */
    double first_mm, last_mm;             /* recorded positions with the sign applied */
    double contact_mm, contact_sd_mm;     /* recorded position of depth 0 */
    double zero_N;                        /* recorded force of force 0, with the sign applied */
    double preload_N;                     /* force at the end of an approach */
    const char *protocol;
    char phases[IMPORT_WORD]; /* in words */
    double start_s;           /* of the session; NAN = no session */
} import_source;

typedef struct import_sources {
    size_t n, capacity;
    import_source **source;
} import_sources;

/* Reads a file's tables, one or more, and appends them. An exit code, after one line on stderr if it is not
 * 0. */
int import_read(const import_options *o, const char *file, import_sources *all);
import_source *import_append(import_sources *all, const import_text *text,
                             import_format format); /* NULL = out of memory */

/* The list with room for one more than n; NULL = out of memory, and it is as it was. */
void *import_grow(void *list, size_t n, size_t *capacity, size_t size);
void import_free_source(import_source *s);
void import_free(import_sources *all);
int import_mach1_read(import_text *text, import_sources *all);
bool import_mach1_starts(const import_text *text);
int import_table_read(const import_options *o, import_text *text, import_format format, import_sources *all);

void import_set_names(import_source *s, char *const *fields, size_t n);
int import_add_row(import_source *s, char *const *fields, size_t n,
                   size_t line);                       /* other fields become NAN */
double *import_new_row(import_source *s, size_t line); /* to be filled; NULL = out of memory */

/* Settings: "key: value" between semicolons. */
void import_copy_word(char to[IMPORT_WORD], const char *from, size_t n);
void import_add_settings(import_source *s, const char *text);
void import_add_setting(import_source *s, const char *key, const char *value);
const char *import_setting(const import_source *s, const char *key);   /* its value; NULL = not found */
double import_setting_number(const import_source *s, const char *key); /* "50mm" is 50; 0 = not found */

/* The setting that most probably is this quantity, converted to its unit, with its key; 0 = none. */
double import_part(const import_source *s, int part, const char **key);

/* Adds a column of times by --rate, or by the sampling rate in a file without times. */
bool import_rate_known(const import_options *o, const import_source *s);
int import_rate(const import_options *o, import_source *s);
bool import_has_time(const import_options *o, import_source *s);

/* Finds the meaning and unit of each column; quiet: without a message if it fails. */
int import_columns_find(const import_options *o, import_source *s, bool quiet);

/* Joins tables of one file if each continues the one before. */
int import_join(const import_options *o, import_sources *all, size_t first);

/* Finds the columns, then the recording in s, mm and N; rows without numbers are skipped. */
int import_columns(const import_options *o, import_source *s);

/* x rounded to the 15th digit of a number of this size, which removes rounding errors. */
double import_digits(double x, double size);

bool import_is_approach(const import_source *s); /* a Mach-1's search for the contact */

/* Finds signs, then contact and zero force. Relaxation files use the approach in all that ended at their
 * start; its contact must be known before. */
int import_signs(const import_options *o, import_source *s);
int import_contact_rule(const import_options *o, import_source *s);
void import_contact_agree(import_sources *all); /* similar presses get the rule of the majority */
int import_contact_find(const import_options *o, const import_sources *all, import_source *s);

/* Reads height, radius, spring constant and start from settings and options; then checks that the height is
 * known and exceeds the depth. */
void import_specimen(const import_options *o, import_source *s);
void import_tip(const import_options *o, import_source *s);
bool import_is_stretch(const import_source *s); /* its depth comes from a stretch, which is 1 at rest */
int import_specimen_check(const import_options *o, const import_source *s);
int import_protocol(const import_options *o, import_source *s);

/* Sets the start of each run in the session, if required. */
int import_session(const import_options *o, import_sources *all);

void import_say(const import_sources *all); /* the table on stderr */

/* OUT/NAME.csv */
int import_write(const import_options *o, const import_source *s);

#endif
