/* watch.c: see watch.h. */
#define _POSIX_C_SOURCE 200809L
#include "watch.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void show_progress(void *user, double share) {
    watch *w = user;
    pthread_mutex_lock(&w->lock);
    w->done += share;
    progress_update(&w->bar, w->done);
    pthread_mutex_unlock(&w->lock);
}

static volatile sig_atomic_t stop_wanted;
static struct sigaction before_stop;
static char said[128];

static void on_stop(int number) {
    int saved = errno;
    stop_wanted = 1;
    sigaction(number, &before_stop, NULL);
    if (write(STDERR_FILENO, said, strlen(said)) < 0)
        stop_wanted = 1;
    errno = saved;
}

static bool asked_to_stop(void *user) {
    (void)user;
    return stop_wanted != 0;
}

void watch_start(watch *w, const char *command, palp_explain_settings *settings) {
    *w = (watch){.done = 0};
    stop_wanted = 0;
    pthread_mutex_init(&w->lock, NULL);
    progress_start(&w->bar, command);
    settings->progress = show_progress;
    settings->progress_user = w;
    settings->stop = asked_to_stop;
    snprintf(said, sizeof said,
             "\npalpate %s: stopping; what was found is written, Ctrl-C again ends at once\n", command);
    struct sigaction act = {.sa_handler = on_stop};
    sigaction(SIGINT, NULL, &before_stop);
    if (before_stop.sa_handler != SIG_IGN)
        sigaction(SIGINT, &act, NULL);
}

void watch_finish(watch *w) {
    sigaction(SIGINT, &before_stop, NULL);
    progress_finish(&w->bar);
    pthread_mutex_destroy(&w->lock);
}
