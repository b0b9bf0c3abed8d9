/* report.h: the parts of palpate report. */
#ifndef PALPATE_TOOL_REPORT_H
#define PALPATE_TOOL_REPORT_H

#include "shared/cli.h"
#include "shared/plot_runs.h"

#include <jansson.h>
#include <palpate/palpate.h>
#include <palpate/recording.h>
#include <stdint.h>
#include <time.h>

enum { REPORT_FILES_MAX = 512, REPORT_CURVES_MAX = 64, REPORT_NOTE_MAX = 256 };

typedef enum report_kind {
    REPORT_OTHER,      /* not recognised or not readable; note says why */
    REPORT_RECORDING,  /* an experiment CSV */
    REPORT_SIMULATION, /* an experiment CSV that palpate simulate wrote */
    REPORT_MODEL,      /* a model JSON */
    REPORT_RESULT      /* what palpate characterize, calibrate or explain --result wrote */
} report_kind;

typedef struct report_file {
    char *path;         /* as named */
    const char *source; /* what is read: path, or copied */
    FILE *copy;         /* copy of a pipe or the like */
    char copied[32];    /* its name */
    report_kind kind;
    char note[REPORT_NOTE_MAX];
    uint32_t crc;
    long long size;
    time_t modified;
    palp_experiment *experiment; /* recording, simulation */
    palp_recording recording;    /* recording; n = 0: could not be prepared */
    palp_model model;            /* model */
    json_t *json;                /* model, result */
} report_file;

/* A simulation beside the recording it repeats. */
typedef struct report_pair {
    const report_file *simulation, *recording;
    double *force_N; /* [recording->recording.n] the simulated force at the recording's samples */
    double *band_N;  /* [2 n] its 95 % band, low and high; NULL = not simulated */
    double peak_N, rms_N, worst_percent;
} report_pair;

typedef struct report {
    size_t n;
    report_file *file; /* [REPORT_FILES_MAX], in the order of the page */
    size_t n_pairs;
    report_pair pair[REPORT_CURVES_MAX];
} report;

/* ---- report_load.c; exit codes, after one line on stderr if not 0 ---- */
int report_add(report *r, const char *path, bool must_read); /* a file, or all of a folder */
void report_sort(report *r); /* recordings and simulations, by the keys of the figures */
void report_free(report *r);
size_t report_count(const report *r, report_kind kind);

/* ---- report_figures.c ---- */
int report_pairs(report *r);             /* simulations beside recordings */
json_t *report_figures(const report *r); /* figures that no result has, of recordings, models and pairs */

/* What the page shows; NULL = out of memory. (report_json.c) */
json_t *report_json(const report *r, const char *title);

#endif
