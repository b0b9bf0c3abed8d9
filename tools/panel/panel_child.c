/* panel_child.c: runs this program as a child with other arguments, and returns what it prints. */
#define _XOPEN_SOURCE 700
#include "panel.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { TEXT_MAX = 64 << 20 };

typedef struct text {
    char *at;
    size_t n, size;
} text;

/* False at the end of the child's output. */
static bool take(text *t, int fd) {
    if (t->n + 4096 > t->size) {
        char *more = t->size < TEXT_MAX ? realloc(t->at, 2 * t->size + 8192) : NULL;
        if (!more)
            return false;
        t->at = more;
        t->size = 2 * t->size + 8192;
    }
    ssize_t n = read(fd, t->at + t->n, 4095);
    t->n += n > 0 ? (size_t)n : 0;
    t->at[t->n] = '\0';
    return n > 0 || (n < 0 && errno == EINTR);
}

static void take_all(const int fd[2], text t[2]) {
    struct pollfd wait[2] = {{.fd = fd[0], .events = POLLIN}, {.fd = fd[1], .events = POLLIN}};
    while (wait[0].fd >= 0 || wait[1].fd >= 0) {
        if (poll(wait, 2, -1) < 0 && errno != EINTR)
            break;
        for (int i = 0; i < 2; i++)
            if (wait[i].fd >= 0 && wait[i].revents && !take(&t[i], wait[i].fd))
                wait[i].fd = -1;
    }
}

static int spawn(const char **argv, const int out[2], const int words[2], pid_t *child) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t how;
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", 0, 0);
    posix_spawn_file_actions_adddup2(&files, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, words[1], STDERR_FILENO);
    for (int i = 0; i < 2; i++) {
        posix_spawn_file_actions_addclose(&files, out[i]);
        posix_spawn_file_actions_addclose(&files, words[i]);
    }
    posix_spawnattr_init(&how); /* a group of its own: Ctrl-C is not for it */
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setsigmask(&how, &none);
    posix_spawnattr_setsigdefault(&how, &usual);
    int failed = posix_spawn(child, "/proc/self/exe", &files, &how, (char *const *)argv, environ);
    posix_spawnattr_destroy(&how);
    posix_spawn_file_actions_destroy(&files);
    return failed;
}

static void note_child(panel *job, pid_t child) {
    if (job) {
        pthread_mutex_lock(&job->lock);
        job->job.child = child;
        if (child > 0)
            setpriority(PRIO_PROCESS, (id_t)child, 10); /* recording samples goes before calculating */
        pthread_mutex_unlock(&job->lock);
    }
}

int panel_child(const char **argv, char **out, char **words, panel *job) {
    int o[2] = {-1, -1}, w[2] = {-1, -1}, status = -1;
    text t[2] = {{calloc(1, 1), 0, 0}, {calloc(1, 1), 0, 0}};
    pid_t child = -1;
    argv[0] = "palpate";
    if (pipe(o) == 0 && pipe(w) == 0 && spawn(argv, o, w, &child) != 0)
        child = -1;
    for (int i = 0; i < 2; i++)
        if ((i ? w : o)[1] >= 0)
            close((i ? w : o)[1]);
    note_child(job, child > 0 ? child : 0);
    if (child > 0)
        take_all((const int[]){o[0], w[0]}, t);
    if (o[0] >= 0)
        close(o[0]);
    if (w[0] >= 0)
        close(w[0]);
    note_child(job, 0);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    *out = t[0].at;
    *words = t[1].at;
    return child > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
