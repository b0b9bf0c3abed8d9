/* batch.h: the parts of palpate batch. */
#ifndef PALPATE_TOOL_BATCH_H
#define PALPATE_TOOL_BATCH_H

#include "shared/cli.h"

#include <glob.h>
#include <jansson.h>
#include <stdint.h>

#define BATCH_NAME "batch"

enum { BATCH_PATH_MAX = CLI_PATH_MAX + 512, BATCH_NAME_MAX = 240 };

typedef struct batch_job {
    char *name;    /* of its files; any bytes but a slash */
    char **argv;   /* "palpate", its arguments, NULL */
    size_t number; /* its place in the list, from 0 */
    uint32_t hash; /* of its arguments */
    bool ended;    /* with these arguments, by the journal; its files are there */
    int status;    /* exit status, or 128 + N if signal N ended it */
    double seconds, at_s;
} batch_job;

typedef struct batch_plan {
    size_t n, room;
    batch_job *job;
    batch_job **by_name; /* [n] sorted by their names */
    char *folder;        /* where the jobs run */
} batch_plan;

typedef struct batch_options {
    const char *manifest, *template, *out, *task_text;
    size_t jobs, slurm;
    bool retry_failed, collect;
    bool is_task, under_mpi; /* does only the jobs whose number leaves task when divided by tasks */
    size_t task, tasks;
} batch_options;

/* All functions that return an int return an exit code, after one line on stderr if it is not 0. */

/* ---- batch_plan.c: the list of jobs ---- */

/* NULL = good; else why a job cannot be called so. */
const char *batch_name_fault(const char *name);

/* Adds a job; name and argv become the plan's, also on failure. False = out of memory. */
bool batch_plan_add(batch_plan *plan, char *name, char **argv);

/* Sorts the names; the later one of two that are the same; NULL = none. */
const batch_job *batch_plan_sort(batch_plan *plan);

/* The files of a pattern in the folder, in the order of their bytes; 0 or an error of glob. */
int batch_glob(const char *folder, const char *pattern, glob_t *found);

/* The jobs of a command with placeholders and patterns, one for each input. */
typedef struct batch_template {
    size_t n_words;
    char **words;     /* of the command */
    const char *name; /* pattern of the names */
} batch_template;
const char *batch_plan_fill(batch_plan *plan, const batch_template *from, const char *input); /* a fault */

bool batch_is_mine(const batch_options *o, const batch_job *job);
void batch_free_words(char **words);
void batch_plan_free(batch_plan *plan);

/* ---- batch_manifest.c ---- */
int batch_manifest_read(const char *path, batch_plan *plan);

/* ---- batch_line.c: lines of a JSON text that jansson has read ---- */

/* Of member key of the root, or of item index of that list if it is one; index SIZE_MAX: of the member. */
size_t batch_line_of(const char *text, const char *key, size_t index);

/* ---- batch_journal.c ---- */

/* Takes over the plan's jobs from the journals of the folder. */
int batch_journal_load(const char *out, batch_plan *plan);

/* Makes one journal of those that tasks wrote. */
int batch_journal_merge(const char *out);

int batch_journal_open(const batch_options *o, int *fd);
int batch_journal_add(const batch_options *o, int fd, const batch_job *job);

/* ---- batch_folder.c: the folder of the results ---- */
void batch_path(char path[BATCH_PATH_MAX], const char *out, const char *name, const char *ending);

/* The journal of all, or that of this task. */
void batch_journal_path(char path[BATCH_PATH_MAX], const batch_options *o);

/* Holds until the process ends: nobody else works here but other tasks of the same batch. */
int batch_lock(const batch_options *o);

/* ---- batch_child.c: one process ---- */
typedef struct batch_child {
    long pid; /* 0 = none */
    int fd[2];
    batch_job *job;
    double started_s;
} batch_child;

double batch_now_s(void);
int batch_child_start(const char *out, const char *folder, batch_job *job, batch_child *child);
int batch_child_keep(const char *out, batch_child *child); /* its output gets its name */
void batch_child_drop(const char *out, batch_child *child);

/* ---- batch_run.c ---- */

/* Runs what has not ended. *stopped is the signal that ended it early, or 0. */
int batch_run(const batch_options *o, batch_plan *plan, int *stopped);

/* ---- batch_table.c ---- */

/* Scalars of the jobs' results: columns in the order of their first occurrence. */
typedef struct batch_table {
    json_t *columns; /* name to number */
    json_t **row;    /* [jobs] name to value; NULL = no result */
    size_t n, left_out;
} batch_table;
int batch_table_make(const char *out, const batch_plan *plan, batch_table *table);
int batch_table_save(const char *out, const batch_plan *plan, const batch_table *table);
void batch_table_free(batch_table *table);

/* ---- batch_page.c ---- */
int batch_page_save(const char *out, const batch_plan *plan, const batch_table *table);

/* The last line that a job wrote to its standard error. */
void batch_last_words(const char *out, const batch_job *job, char line[256]);

/* ---- batch_slurm.c ---- */
int batch_slurm_save(const batch_options *o);

#endif
