/* batch_child.c: a job as a process of this program; its output has a temporary name until it has ended. */
#define _XOPEN_SOURCE 700
#include "batch.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char *const endings[2][2] = {{".out.tmp", ".out"}, {".err.tmp", ".err"}};

double batch_now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The child gets the signal actions that the batch was started with, not the batch's own. */
static void reset_signals(const sigset_t *mask) {
    static const int numbers[] = {SIGCHLD, SIGINT, SIGTERM, SIGHUP};
    struct sigaction usual = {.sa_handler = SIG_DFL}, now;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (sigaction(numbers[i], NULL, &now) == 0 && now.sa_handler != SIG_IGN)
            sigaction(numbers[i], &usual, NULL);
    sigprocmask(SIG_SETMASK, mask, NULL);
}

/* The child: a group of its own, so that Ctrl-C is the batch's; it does not outlive the batch. */
static void become(const char *folder, const batch_child *child, pid_t parent, const sigset_t *mask) {
    static const char why[] = "palpate batch: the job cannot be started\n";
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    reset_signals(mask);
    int null = getppid() == parent ? open("/dev/null", O_RDONLY) : -1;
    if (null >= 0 && dup2(null, STDIN_FILENO) >= 0 && dup2(child->fd[0], STDOUT_FILENO) >= 0 &&
        dup2(child->fd[1], STDERR_FILENO) >= 0 && chdir(folder) == 0) {
        close(null);
        execv("/proc/self/exe", child->job->argv);
    }
    if (write(child->fd[1], why, sizeof why - 1) < 0)
        _exit(126);
    _exit(127);
}

/* No signal comes between the fork and the exec. */
static pid_t start(const char *folder, const batch_child *child) {
    sigset_t all, before;
    pid_t parent = getpid();
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before);
    pid_t pid = fork();
    if (pid == 0)
        become(folder, child, parent, &before);
    int number = errno;
    sigprocmask(SIG_SETMASK, &before, NULL);
    errno = number;
    return pid;
}

/* What a killed batch left under the name may still be written to by its child: it is another file. An
 * earlier result goes too, so that the journal's line of it is void. */
static int open_output(const char *out, const char *name, int k) {
    char path[BATCH_PATH_MAX];
    batch_path(path, out, name, endings[k][1]);
    unlink(path);
    batch_path(path, out, name, endings[k][0]);
    unlink(path);
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        cli_failure(BATCH_NAME, "%s: cannot write: %s", path, strerror(errno));
    return fd;
}

int batch_child_start(const char *out, const char *folder, batch_job *job, batch_child *child) {
    *child = (batch_child){.job = job, .fd = {-1, -1}};
    child->fd[0] = open_output(out, job->name, 0);
    child->fd[1] = child->fd[0] >= 0 ? open_output(out, job->name, 1) : -1;
    if (child->fd[1] < 0) {
        batch_child_drop(out, child);
        return CLI_FAILURE;
    }
    child->started_s = batch_now_s();
    pid_t pid = start(folder, child);
    if (pid < 0) {
        batch_child_drop(out, child);
        return cli_failure(BATCH_NAME, "cannot start a process: %s", strerror(errno));
    }
    setpgid(pid, pid);
    child->pid = pid;
    return CLI_OK;
}

int batch_child_keep(const char *out, batch_child *child) {
    char from[BATCH_PATH_MAX], to[BATCH_PATH_MAX];
    struct stat file;
    int number = 0;
    for (int k = 0; k < 2; k++) {
        batch_path(from, out, child->job->name, endings[k][0]);
        batch_path(to, out, child->job->name, endings[k][1]);
        bool good = fstat(child->fd[k], &file) == 0 && (file.st_size == 0 || fsync(child->fd[k]) == 0);
        good = close(child->fd[k]) == 0 && good;
        if (!number && (!good || rename(from, to) != 0)) {
            number = errno;
            cli_failure(BATCH_NAME, "%s: cannot write: %s", to, strerror(number));
        }
        child->fd[k] = -1;
    }
    child->pid = 0;
    return number ? CLI_FAILURE : CLI_OK;
}

void batch_child_drop(const char *out, batch_child *child) {
    char path[BATCH_PATH_MAX];
    int number = errno;
    for (int k = 0; k < 2; k++) {
        if (child->fd[k] < 0)
            continue;
        close(child->fd[k]);
        batch_path(path, out, child->job->name, endings[k][0]);
        unlink(path);
    }
    child->pid = 0;
    errno = number;
}
