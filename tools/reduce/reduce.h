/* reduce.h: the parts of palpate reduce. */
#ifndef PALPATE_TOOLS_REDUCE_H
#define PALPATE_TOOLS_REDUCE_H

#include "shared/cli.h"

#include <palpate/palpate.h>
#include <palpate/reduce.h>

enum { REDUCE_RUNS_MAX = 256 };

typedef struct reduce_options {
    const char *model, *runs, *out;
    const char *words[1 + REDUCE_RUNS_MAX];
    size_t n_words, samples, jobs;
    int supports; /* index of auto, plate, bottom */
    double hold_out;
    palp_reduce_settings settings;
    bool json;
} reduce_options;

/* The path of the plate or of a ball. */
typedef struct reduce_run {
    const char *file;
    size_t n;
    double *time_s, *depth_m; /* [n] */
    palp_tool *tool;          /* [n], or NULL: only the plate moves */
    bool held_out;            /* held out, to measure the error */
    palp_snapshots *snapshots;
    palp_reduce_error error; /* held_out only */
} reduce_run;

/* Reads a run, thinned to at most samples rows; returns an exit code. */
int reduce_run_read(const char *file, size_t samples, reduce_run *run);
void reduce_run_free(reduce_run *run);

#endif
