/* batch_run.c: runs jobs in so many processes at once and journals what has ended. */
#define _XOPEN_SOURCE 700
#include "batch.h"
#include "shared/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATIENCE_S = 10 }; /* from SIGTERM to SIGKILL */

typedef struct running {
    const batch_options *o;
    batch_plan *plan;
    batch_child *child, *done; /* [o->jobs] the places; those that have ended */
    size_t n, n_done, next;    /* processes now; ended, but not yet journaled; next job of the plan */
    size_t wanted, ended;
    int journal, stopped, code;
    progress bar;
} running;

static bool is_wanted(const batch_options *o, const batch_job *job) {
    bool again = job->ended && (job->status >= 128 || (o->retry_failed && job->status));
    return batch_is_mine(o, job) && (!job->ended || again);
}

/* A signal may reach any thread, such as one of OpenBLAS: a pipe wakes the one that waits. */
static int wake[2];
static volatile sig_atomic_t stop_number;

static void on_signal(int number) {
    int kept = errno;
    if (number != SIGCHLD)
        stop_number = number;
    ssize_t written = write(wake[1], "", 1); /* a full pipe wakes too */
    (void)written;
    errno = kept;
}

/* Waits for a signal, at most a fifth of a second; the one that ends the batch, or 0. */
static int await_signal(void) {
    struct pollfd pipe_end = {.fd = wake[0], .events = POLLIN};
    char bytes[256];
    if (poll(&pipe_end, 1, 200) > 0)
        while (read(wake[0], bytes, sizeof bytes) > 0)
            continue;
    int number = stop_number;
    stop_number = 0;
    return number;
}

static const int caught[] = {SIGCHLD, SIGINT, SIGTERM, SIGHUP};
enum { CAUGHT = sizeof caught / sizeof caught[0] };

/* A signal that is ignored stays so. */
static int catch_signals(struct sigaction before[CAUGHT]) {
    struct sigaction act = {.sa_handler = on_signal, .sa_flags = SA_RESTART | SA_NOCLDSTOP};
    bool good = pipe(wake) == 0;
    for (int i = 0; i < 2 && good; i++)
        good = fcntl(wake[i], F_SETFL, O_NONBLOCK) == 0 && fcntl(wake[i], F_SETFD, FD_CLOEXEC) == 0;
    if (!good)
        return cli_failure(BATCH_NAME, "cannot make a pipe: %s", strerror(errno));
    for (size_t i = 0; i < CAUGHT; i++)
        if (sigaction(caught[i], NULL, &before[i]) == 0 &&
            (before[i].sa_handler != SIG_IGN || caught[i] == SIGCHLD))
            sigaction(caught[i], &act, NULL);
    return CLI_OK;
}

static void release_signals(const struct sigaction before[CAUGHT]) {
    for (size_t i = 0; i < CAUGHT; i++)
        sigaction(caught[i], &before[i], NULL);
    close(wake[0]);
    close(wake[1]);
}

/* An ended job frees its place; its result is kept or dropped. */
static void reap(running *r, bool keep) {
    int status;
    for (size_t i = 0; i < r->o->jobs; i++) {
        batch_child *child = &r->child[i];
        if (!child->pid || waitpid((pid_t)child->pid, &status, WNOHANG) != (pid_t)child->pid)
            continue;
        child->job->seconds = batch_now_s() - child->started_s;
        child->job->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        if (keep)
            r->done[r->n_done++] = *child;
        else
            batch_child_drop(r->o->out, child);
        child->pid = 0;
        r->n--;
    }
}

/* Waiting for the disk delays no process: those that follow have been started. After a failure nothing is
 * kept, and one line has said why. */
static void journal_done(running *r) {
    for (size_t i = 0; i < r->n_done; i++) {
        batch_job *job = r->done[i].job;
        if (r->code) {
            batch_child_drop(r->o->out, &r->done[i]);
            continue;
        }
        r->code = batch_child_keep(r->o->out, &r->done[i]);
        if (r->code == CLI_OK)
            r->code = batch_journal_add(r->o, r->journal, job);
        job->ended = r->code == CLI_OK;
        r->ended++;
    }
    r->n_done = 0;
}

static void fill_places(running *r) {
    for (size_t i = 0; i < r->o->jobs && r->code == CLI_OK; i++) {
        if (r->child[i].pid)
            continue;
        while (r->next < r->plan->n && !is_wanted(r->o, &r->plan->job[r->next]))
            r->next++;
        if (r->next == r->plan->n)
            return;
        batch_job *job = &r->plan->job[r->next++];
        job->ended = false;
        r->code = batch_child_start(r->o->out, r->plan->folder, job, &r->child[i]);
        r->n += r->code == CLI_OK;
    }
}

static void send(const running *r, int number) {
    for (size_t i = 0; i < r->o->jobs; i++)
        if (r->child[i].pid && kill(-(pid_t)r->child[i].pid, number) != 0)
            kill((pid_t)r->child[i].pid, number);
}

/* Ends the processes; what had not ended before is done anew the next time. */
static void end_all(running *r) {
    double since_s = batch_now_s();
    if (r->code == CLI_OK)
        reap(r, true);
    journal_done(r);
    send(r, SIGTERM);
    while (r->n > 0) {
        reap(r, false);
        if (r->n > 0 && (await_signal() || batch_now_s() - since_s > PATIENCE_S))
            send(r, SIGKILL);
    }
}

static void work(running *r) {
    progress_start(&r->bar, "batch");
    fill_places(r);
    while (r->n > 0 && r->code == CLI_OK && !r->stopped) {
        r->stopped = await_signal();
        reap(r, true);
        if (!r->stopped)
            fill_places(r);
        journal_done(r);
        progress_update(&r->bar, (double)r->ended / (double)r->wanted);
    }
    end_all(r);
    progress_finish(&r->bar);
}

int batch_run(const batch_options *o, batch_plan *plan, int *stopped) {
    struct sigaction before[CAUGHT];
    running r = {.o = o, .plan = plan, .child = calloc(2 * o->jobs, sizeof *r.child)};
    for (size_t i = 0; i < plan->n; i++)
        r.wanted += is_wanted(o, &plan->job[i]);
    if (!r.child)
        return cli_failure(BATCH_NAME, "out of memory");
    r.done = r.child + o->jobs;
    if (!getenv("OPENBLAS_NUM_THREADS"))
        setenv("OPENBLAS_NUM_THREADS", "1", 1);
    r.code = batch_journal_open(o, &r.journal);
    if (r.code == CLI_OK && (r.code = catch_signals(before)) == CLI_OK) {
        work(&r);
        release_signals(before);
    }
    if (r.journal >= 0)
        close(r.journal);
    free(r.child);
    *stopped = r.stopped;
    return r.code;
}
