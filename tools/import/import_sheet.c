/* import_sheet.c: sheets of a spreadsheet as text, by the programs that are kept for that. */
#define _POSIX_C_SOURCE 200809L
#include "import.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const char NAME[] = "import";

enum { HELPERS = 2 };

/* What turns a kind of spreadsheet into text; the first that is installed is taken. FILE stands for the
 * file's name. */
static const struct kind {
    const char *magic;
    size_t n;
    const char *name;
    const char *const helper[HELPERS][7];
    const char *install;
} kinds[] = {{"PK\003\004",
              4,
              ".xlsx",
              {{"xlsx2csv", "-a", "-d", "tab", "FILE", NULL},
               {"ssconvert", "-T", "Gnumeric_stf:stf_csv", "FILE", "fd://1", NULL}},
              "xlsx2csv (Debian package xlsx2csv) or ssconvert (gnumeric)"},
             {"\xD0\xCF\x11\xE0",
              4,
              ".xls",
              {{"xls2csv", "-d", "utf-8", "-c\t", "FILE", NULL},
               {"ssconvert", "-T", "Gnumeric_stf:stf_csv", "FILE", "fd://1", NULL}},
              "xls2csv (Debian package catdoc) or ssconvert (gnumeric)"}};

/* Starts a program with its output in a pipe; returns errno, 0 = it runs. */
static int start(const char *const words[], const char *file, bool quiet, pid_t *pid, int *from) {
    char *argv[8] = {NULL};
    posix_spawn_file_actions_t actions;
    int ends[2];
    for (size_t i = 0; words[i]; i++)
        argv[i] = (char *)(strcmp(words[i], "FILE") == 0 ? file : words[i]);
    if (pipe(ends))
        return errno;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    if (quiet)
        posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1 /* O_WRONLY */, 0);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    posix_spawn_file_actions_addclose(&actions, ends[1]);
    int error = posix_spawnp(pid, words[0], &actions, NULL, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error)
        close(ends[0]);
    *from = ends[0];
    return error;
}

char *import_run(const char *const words[], const char *file, bool quiet, size_t *size, int *code) {
    pid_t pid;
    char *text = NULL, output[32];
    int from = -1, how = 0;
    *code = IMPORT_MISSING;
    if (start(words, file, quiet, &pid, &from))
        return NULL;
    snprintf(output, sizeof output, "/dev/fd/%d", from);
    palp_file_read(output, &text, size, NULL);
    close(from);
    while (waitpid(pid, &how, 0) < 0 && errno == EINTR) {
    }
    *code = WIFEXITED(how) ? WEXITSTATUS(how) : -1;
    if (*code) {
        free(text);
        return NULL;
    }
    return text;
}

int import_sheet_read(import_text *text, size_t *size) {
    const struct kind *kind = kinds, *end = kinds + sizeof kinds / sizeof kinds[0];
    while (kind < end && !(*size > kind->n && memcmp(text->text, kind->magic, kind->n) == 0))
        kind++;
    if (kind == end)
        return CLI_OK;
    char path[CLI_PATH_MAX]; /* a name that starts with '-' is no option */
    int n = snprintf(path, sizeof path, "%s%s", *text->file == '-' ? "./" : "", text->file);
    int missing = IMPORT_MISSING;
    for (size_t i = 0; n > 0 && (size_t)n < sizeof path && i < HELPERS && missing == IMPORT_MISSING; i++) {
        char *other = import_run(kind->helper[i], path, true, size, &missing);
        if (other) {
            free(text->text);
            text->text = other;
            return CLI_OK;
        }
    }
    return missing == IMPORT_MISSING
               ? cli_failure(NAME, "%s: to read an %s file, install %s; or export the sheet as CSV",
                             text->file, kind->name, kind->install)
               : cli_failure(NAME, "%s: the %s file cannot be read; export the sheet as CSV", text->file,
                             kind->name);
}
