/* temporary.c: removes temporary files and folders when a signal ends the command. */
#define _GNU_SOURCE /* getdents64 */
#include "temporary.h"
#include "cli.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The folders that this command writes to, and those that it made for a while. An unfinished file is called
 * NAME.PID.N.tmp (palpate/file.h), also if the library writes it, which catches no signal. */
enum { FOLDERS_MAX = 64 };
static struct {
    char *path;
    bool whole; /* goes with all that is in it */
} folders[FOLDERS_MAX];
static int n_folders;
static char temporary_mark[32]; /* ".PID." */

static bool is_ours(const char *name) {
    size_t digits = 0;
    for (const char *at = name; (at = strstr(at, temporary_mark)) != NULL; at++) {
        digits = strspn(at + strlen(temporary_mark), "0123456789");
        if (digits > 0 && strcmp(at + strlen(temporary_mark) + digits, ".tmp") == 0)
            return true;
    }
    return false;
}

/* Calls only what a handler may call. */
static void tidy(const char *path, bool whole) {
    union {
        char bytes[4096];
        struct dirent64 first;
    } list;
    int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (ssize_t n; folder >= 0 && (n = getdents64(folder, list.bytes, sizeof list)) > 0;)
        for (ssize_t at = 0; at < n;) {
            const struct dirent64 *entry = (const void *)(list.bytes + at);
            if (whole || is_ours(entry->d_name))
                unlinkat(folder, entry->d_name, 0); /* "." and ".." cannot be unlinked */
            at += entry->d_reclen;
        }
    if (folder >= 0)
        close(folder);
    if (whole)
        rmdir(path);
}

static void on_end(int number) {
    for (int i = 0; i < n_folders; i++)
        tidy(folders[i].path, folders[i].whole);
    raise(number); /* as if it had not been caught, when this returns: SA_RESETHAND */
}

static void watch(const char *folder, bool whole) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    for (int i = 0; i < n_folders; i++)
        if (strcmp(folders[i].path, folder) == 0)
            return;
    if (n_folders == FOLDERS_MAX || !(folders[n_folders].path = strdup(folder)))
        return;
    folders[n_folders].whole = whole;
    snprintf(temporary_mark, sizeof temporary_mark, ".%ld.", (long)getpid());
    struct sigaction act = {.sa_handler = on_end, .sa_flags = (int)SA_RESETHAND}, before;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0] && n_folders == 0; i++)
        if (sigaction(numbers[i], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
            sigaction(numbers[i], &act, NULL);
    n_folders++;
}

void temporary_tidy_on_signal(const char *path) {
    const char *slash = strrchr(path, '/');
    char *target = slash && !slash[1] ? NULL : realpath(path, NULL); /* of a link the folder of its target */
    const char *file = target ? target : path, *last = strrchr(file, '/');
    char folder[CLI_PATH_MAX];
    snprintf(folder, sizeof folder, "%.*s.", last ? (int)(last + 1 - file) : 0, file);
    free(target);
    watch(folder, false);
}

int temporary_folder_make(const char *command, char folder[CLI_PATH_MAX]) {
    const char *base = getenv("TMPDIR");
    base = base && *base ? base : "/tmp";
    if (snprintf(folder, CLI_PATH_MAX, "%s/palpate.XXXXXX", base) >= CLI_PATH_MAX || !mkdtemp(folder))
        return cli_failure(command, "no folder for temporary files can be made in %s", base);
    watch(folder, true);
    return CLI_OK;
}

void temporary_folder_remove(const char *folder) {
    tidy(folder, true);
    for (int i = 0; i < n_folders; i++)
        if (strcmp(folders[i].path, folder) == 0) {
            free(folders[i].path);
            folders[i] = folders[n_folders - 1];
            n_folders--;
            return;
        }
}
