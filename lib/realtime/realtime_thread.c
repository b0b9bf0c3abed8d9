/* realtime_thread.c: a thread that makes the next factor, and the clock. */
#define _POSIX_C_SOURCE 200809L
#include "realtime_internal.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

struct refresh_thread {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    multigrid *mg;
    bool busy, quit;
    palp_status status;
};

double realtime_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static palp_status complete_next_factor(multigrid *mg) {
    bool done = false;
    palp_status status = PALP_OK;
    while (!status && !done)
        status = multigrid_advance(mg, INFINITY, &done);
    return status;
}

static void *refresh_factors_until_quit(void *self) {
    refresh_thread *t = self;
    pthread_mutex_lock(&t->lock);
    while (!t->quit) {
        if (!t->busy) {
            pthread_cond_wait(&t->changed, &t->lock);
            continue;
        }
        pthread_mutex_unlock(&t->lock);
        palp_status status = complete_next_factor(t->mg);
        pthread_mutex_lock(&t->lock);
        t->status = status;
        t->busy = false;
        pthread_cond_broadcast(&t->changed);
    }
    pthread_mutex_unlock(&t->lock);
    return NULL;
}

palp_status refresh_thread_create(multigrid *mg, refresh_thread **out) {
    refresh_thread *t = calloc(1, sizeof *t);
    if (!t)
        return PALP_ERR_NO_MEMORY;
    t->mg = mg;
    pthread_mutex_init(&t->lock, NULL);
    pthread_cond_init(&t->changed, NULL);
    if (pthread_create(&t->thread, NULL, refresh_factors_until_quit, t)) {
        free(t);
        return PALP_ERR_NO_MEMORY;
    }
    *out = t;
    return PALP_OK;
}

void refresh_thread_free(refresh_thread *t) {
    if (!t)
        return;
    pthread_mutex_lock(&t->lock);
    t->quit = true;
    pthread_cond_broadcast(&t->changed);
    pthread_mutex_unlock(&t->lock);
    pthread_join(t->thread, NULL);
    pthread_mutex_destroy(&t->lock);
    pthread_cond_destroy(&t->changed);
    free(t);
}

void refresh_thread_start(refresh_thread *t) {
    pthread_mutex_lock(&t->lock);
    t->busy = true;
    pthread_cond_broadcast(&t->changed);
    pthread_mutex_unlock(&t->lock);
}

bool refresh_thread_done(refresh_thread *t, palp_status *status) {
    pthread_mutex_lock(&t->lock);
    bool done = !t->busy;
    *status = t->busy ? PALP_OK : t->status;
    pthread_mutex_unlock(&t->lock);
    return done;
}

void refresh_thread_wait(refresh_thread *t) {
    pthread_mutex_lock(&t->lock);
    while (t->busy)
        pthread_cond_wait(&t->changed, &t->lock);
    pthread_mutex_unlock(&t->lock);
}
