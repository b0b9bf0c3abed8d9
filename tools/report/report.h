/* report.h: the parts of palpate report. */
#ifndef PALPATE_TOOL_REPORT_H
#define PALPATE_TOOL_REPORT_H

#include "shared/cli.h"
#include "explain/page.h"
#include "shared/html.h"
#include "shared/plot_runs.h"

#include <jansson.h>
#include <palpate/palpate.h>
#include <palpate/recording.h>
#include <stdint.h>
#include <time.h>

enum { REPORT_FILES_MAX = 512, REPORT_CURVES_MAX = 64, REPORT_NOTE_MAX = 256 };

typedef enum report_kind {
    REPORT_OTHER,        /* not recognised or not readable; note says why */
    REPORT_RECORDING,    /* an experiment CSV */
    REPORT_SIMULATION,   /* an experiment CSV that palpate simulate wrote */
    REPORT_MODEL,        /* a model JSON */
    REPORT_CHARACTERIZE, /* what palpate characterize --json wrote */
    REPORT_CALIBRATE,    /* what palpate calibrate --json wrote */
    REPORT_EXPLAIN,      /* what palpate explain --result wrote */
    REPORT_FIGURE        /* an SVG */
} report_kind;

typedef struct report_file {
    char *path;         /* as named */
    const char *source; /* what is read: path, or copied */
    FILE *copy;         /* of what is no regular file, such as a pipe */
    char copied[32];    /* its name */
    report_kind kind;
    char note[REPORT_NOTE_MAX];
    uint32_t crc;
    long long size;
    time_t modified;
    palp_experiment *experiment; /* recording, simulation */
    palp_recording recording;    /* likewise; n = 0: could not be prepared */
    palp_model model;            /* model */
    palp_mesh_source mesh;       /* of a network */
    json_t *json;                /* characterize, calibrate, explain */
    char *svg;                   /* figure: from "<svg" on */
    bool shown;                  /* figure: placed on the page */
    bool drawn;                  /* figure: by the report itself */
} report_file;

/* A simulation beside the recording it repeats. */
typedef struct report_pair {
    const report_file *simulation, *recording;
    double *force_N; /* [recording->recording.n] the simulated force at the recording's samples */
    double *band_N;  /* [2 n] its 95 % band, low and high; NULL = not simulated */
    double peak_N, rms_N, worst_percent;
} report_pair;

typedef struct report {
    const char *title;
    size_t n;
    report_file *file; /* [REPORT_FILES_MAX], in the order of the page */
    size_t n_pairs;
    report_pair pair[REPORT_CURVES_MAX];
    bool has_fits, has_law, has_calibration;
} report;

/* ---- report_load.c; exit codes, after one line on stderr if not 0 ---- */
int report_add(report *r, const char *path, bool must_read); /* a file, or all of a folder */
void report_sort(report *r); /* recordings, and simulations, as the figures' keys have them */
void report_free(report *r);
const report_file *report_find(const report *r, report_kind kind, size_t which); /* NULL = no more */
size_t report_count(const report *r, report_kind kind);

/* ---- report_figures.c ---- */
int report_pairs(report *r);   /* simulations beside recordings */
int report_figures(report *r); /* draws what was not among the files; adds them as figures */

/* The figure of a name ("fit_log") among the files that is not on the page yet; report_figure puts it there.
 */
void report_place(FILE *to, report_file *figure, const char *caption);
report_file *report_find_figure(const report *r, const char *name); /* NULL = none */
void report_figure(FILE *to, report *r, const char *name, const char *caption);

/* ---- report_page.c, report_results.c: the sections ---- */
int report_page(report *r, const char *path);
void report_fits(FILE *to, report *r);
void report_parameters(FILE *to, report *r);
void report_law(FILE *to, report *r);
void report_calibrations(FILE *to, report *r);
void report_simulations(FILE *to, report *r);

#endif
