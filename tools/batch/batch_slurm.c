/* batch_slurm.c: a script that submits the batch to Slurm: an array of tasks, and a job that collects. */
#define _XOPEN_SOURCE 700
#include "batch.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* As one word of a shell. */
static void put_quoted(const char *text, FILE *to) {
    fputc('\'', to);
    for (; *text; text++)
        fprintf(to, *text == '\'' ? "'\\''" : "%c", *text);
    fputc('\'', to);
}

static void put_command(char *const path[3], const batch_options *o, FILE *to) {
    fputs("exec ", to);
    put_quoted(path[0], to);
    fputs(" batch ", to);
    put_quoted(path[1], to);
    fputs(" --out ", to);
    put_quoted(path[2], to);
    fputs(o->retry_failed ? " --retry-failed" : "", to);
}

/* The quoted end of a here-document leaves its lines as they are. */
static void put_script(char *const path[3], const batch_options *o, FILE *to) {
    fprintf(to,
            "#!/bin/sh\n"
            "# Submits %zu tasks to Slurm, and a job that collects their results when all have ended.\n"
            "# Words after the script's name are options of sbatch for both, such as --time=60.\n"
            "set -eu\n"
            "array=$(sbatch --parsable --job-name=palpate --array=0-%zu \"$@\" <<'END_OF_TASK'\n"
            "#!/bin/sh\n",
            o->slurm, o->slurm - 1);
    put_command(path, o, to);
    fprintf(to,
            " --task \"$SLURM_ARRAY_TASK_ID/%zu\" --jobs \"${SLURM_CPUS_PER_TASK:-1}\"\n"
            "END_OF_TASK\n"
            ")\n"
            "sbatch --parsable --job-name=palpate-collect --dependency=\"afterany:${array%%%%;*}\" \"$@\" "
            "<<'END_OF_COLLECT'\n"
            "#!/bin/sh\n",
            o->slurm);
    batch_options collect = *o;
    collect.retry_failed = false;
    put_command(path, &collect, to);
    fputs(" --collect\nEND_OF_COLLECT\n", to);
}

int batch_slurm_save(const batch_options *o) {
    char name[BATCH_PATH_MAX];
    palp_file file;
    const char *const from[3] = {"/proc/self/exe", o->manifest, o->out};
    char *path[3] = {NULL, NULL, NULL};
    int code = CLI_OK;
    for (int i = 0; i < 3 && code == CLI_OK; i++) {
        path[i] = realpath(from[i], NULL);
        code = !path[i] ? cli_failure(BATCH_NAME, "%s: %s", from[i], strerror(errno))
               : strchr(path[i], '\n')
                   ? cli_failure(BATCH_NAME, "%s: its name cannot stand in a script", from[i])
                   : CLI_OK;
    }
    batch_path(name, o->out, "slurm", ".sh");
    code = code ? code : cli_file_open(BATCH_NAME, name, &file);
    if (code == CLI_OK) {
        put_script(path, o, file.stream);
        code = cli_file_close(BATCH_NAME, &file);
    }
    if (code == CLI_OK)
        cli_say(stdout, "Submit it by: sh %s", name);
    for (int i = 0; i < 3; i++)
        free(path[i]);
    return code;
}
