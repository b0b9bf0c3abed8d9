/* benchmark.h: the parts of palpate benchmark. */
#ifndef PALPATE_TOOL_BENCHMARK_H
#define PALPATE_TOOL_BENCHMARK_H

#include "shared/cli.h"

#include <jansson.h>
#include <stdbool.h>

#define BENCHMARK_NAME "benchmark"

enum { BENCHMARK_RUNS = 64, BENCHMARK_SPLITS = 64, BENCHMARK_PROGRAMS = 16, BENCHMARK_WORDS = 32 };

/* Runs to fit, and runs whose force is to be predicted. The strings belong to the manifest. */
typedef struct benchmark_split {
    const char *name, *leaves_out;
    size_t n_fit, n_predict;
    const char *fit[BENCHMARK_RUNS], *predict[BENCHMARK_RUNS]; /* relative to the folder */
    double deeper_than_mm, later_than_s;                       /* only such samples count; -inf: all */
} benchmark_split;

/* Whose predictions are compared. own: palpate's, with these further arguments of characterize. */
typedef struct benchmark_program {
    const char *name;
    bool own;
    size_t n_words;
    const char *words[BENCHMARK_WORDS];
} benchmark_program;

typedef struct benchmark {
    const char *folder;
    json_t *root; /* the caller's to json_decref */
    size_t n_splits, n_programs;
    benchmark_split split[BENCHMARK_SPLITS];
    benchmark_program program[BENCHMARK_PROGRAMS];
} benchmark;

/* Reads FOLDER/benchmark.json; returns an exit code. (benchmark_manifest.c) */
int benchmark_read(const char *folder, benchmark *b);

/* A path in the benchmark's folder. false: too long. */
bool benchmark_path(const benchmark *b, char path[CLI_PATH_MAX], const char *format, ...) CLI_PRINTF(3, 4);

/* palpate's own predictions for a split, PREDICT_NUMBER.csv in a folder that exists; returns an exit code.
 * (benchmark_own.c) */
int benchmark_predict(const benchmark *b, const benchmark_program *own, const benchmark_split *split,
                      const char *folder);

/* The error of a program's forces. (benchmark_score.c) */
typedef struct benchmark_score {
    size_t samples;
    double rms_N, peak_N; /* peak: the largest recorded force of the runs to predict */
    bool there;           /* false: the program has no prediction for this split */
} benchmark_score;

/* folder: of palpate's own predictions, or NULL: FOLDER/predictions/PROGRAM/SPLIT/RUN.csv. Returns an exit
 * code. */
int benchmark_find(const benchmark *b, const benchmark_split *split, const benchmark_program *program,
                   const char *folder, benchmark_score *score);

#endif
