/* benchmark_own.c: palpate's predictions: characterize the runs to fit, simulate those to predict. */
#define _XOPEN_SOURCE 700
#include "benchmark.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* The last line of a file, without its newline. */
static void last_line(const char *path, char *line, size_t size) {
    char next[512];
    FILE *from = fopen(path, "r");
    line[0] = '\0';
    while (from && fgets(next, sizeof next, from)) {
        next[strcspn(next, "\n")] = '\0';
        snprintf(line, size, "%s", next);
    }
    if (from)
        fclose(from);
}

static void become(const char *const *words, const char *said) {
    union {
        const char *const *constant;
        char *const *plain;
    } argv = {.constant = words}; /* execv changes none of them */
    int null = open("/dev/null", O_WRONLY), log = open(said, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (null >= 0 && log >= 0 && dup2(null, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0)
        execv("/proc/self/exe", argv.plain);
    _exit(127);
}

/* This program with these words about a run; its messages go to a file of the folder, and are shown if it
 * fails.
 */
static int run_command(const char *folder, const char *const *words, const char *run) {
    char said[CLI_PATH_MAX], line[512];
    int status = 0;
    snprintf(said, sizeof said, "%.4000s/said", folder);
    fflush(NULL);
    pid_t pid = fork();
    if (pid == 0)
        become(words, said);
    while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    if (pid > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return CLI_OK;
    last_line(said, line, sizeof line);
    return cli_failure(BENCHMARK_NAME, "palpate %s %s failed: %s", words[1], run, line);
}

int benchmark_predict(const benchmark *b, const benchmark_program *own, const benchmark_split *split,
                      const char *folder) {
    static char file[BENCHMARK_RUNS][CLI_PATH_MAX];
    const char *words[BENCHMARK_RUNS + BENCHMARK_WORDS];
    char model[CLI_PATH_MAX], out[CLI_PATH_MAX];
    size_t n = 0;
    bool fits = snprintf(model, CLI_PATH_MAX, "%s/model.json", folder) < CLI_PATH_MAX;
    words[n++] = "palpate";
    words[n++] = "characterize";
    for (size_t i = 0; i < own->n_words; i++)
        words[n++] = own->words[i];
    words[n++] = "--out";
    words[n++] = model;
    words[n++] = "--";
    for (size_t i = 0; i < split->n_fit; i++) {
        fits = benchmark_path(b, file[i], "%s", split->fit[i]) && fits;
        words[n++] = file[i];
    }
    words[n] = NULL;
    int code = fits ? run_command(folder, words, file[0])
                    : cli_failure(BENCHMARK_NAME, "%s: a path is too long", split->name);
    for (size_t r = 0; r < split->n_predict && code == CLI_OK; r++) {
        fits = benchmark_path(b, file[0], "%s", split->predict[r]) &&
               snprintf(out, CLI_PATH_MAX, "%s/%zu.csv", folder, r) < CLI_PATH_MAX;
        const char *const simulate[] = {"palpate", "simulate", model, "--like", file[0], "--out", out, NULL};
        code = fits ? run_command(folder, simulate, file[0])
                    : cli_failure(BENCHMARK_NAME, "%s: a path is too long", split->name);
    }
    return code;
}
