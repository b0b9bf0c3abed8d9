/* batch_folder.c: the folder of the results, and its locks. */
#define _POSIX_C_SOURCE 200809L
#include "batch.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

void batch_path(char path[BATCH_PATH_MAX], const char *out, const char *name, const char *ending) {
    snprintf(path, BATCH_PATH_MAX, "%s/%s%s", out, name, ending);
}

static void numbered_path(char path[BATCH_PATH_MAX], const batch_options *o, const char *name) {
    char ending[32] = "";
    if (o->is_task)
        snprintf(ending, sizeof ending, ".%zu", o->task);
    batch_path(path, o->out, name, ending);
}

void batch_journal_path(char path[BATCH_PATH_MAX], const batch_options *o) {
    numbered_path(path, o, "journal");
}

/* The lock is the process's own and ends with it; network file systems know it too. */
static int lock_file(const batch_options *o, const char *path, short type, const char *who) {
    struct flock lock = {.l_type = type, .l_whence = SEEK_SET}, other = lock;
    int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0)
        return cli_failure(BATCH_NAME, "%s: cannot write: %s", path, strerror(errno));
    if (fcntl(fd, F_SETLK, &lock) == 0)
        return CLI_OK;
    int number = errno;
    bool held = number == EACCES || number == EAGAIN;
    bool known = held && fcntl(fd, F_GETLK, &other) == 0 && other.l_type != F_UNLCK && other.l_pid > 0;
    close(fd);
    if (!held)
        return cli_failure(BATCH_NAME, "%s: cannot lock: %s", path, strerror(number));
    return known ? cli_failure(BATCH_NAME, "%s: %s works here already (process %ld)", o->out, who,
                               (long)other.l_pid)
                 : cli_failure(BATCH_NAME, "%s: %s works here already", o->out, who);
}

int batch_lock(const batch_options *o) {
    char path[BATCH_PATH_MAX];
    batch_path(path, o->out, "lock", "");
    int code = lock_file(o, path, o->is_task ? F_RDLCK : F_WRLCK, "another batch");
    if (code || !o->is_task)
        return code;
    numbered_path(path, o, "lock");
    return lock_file(o, path, F_WRLCK, "the same task");
}
