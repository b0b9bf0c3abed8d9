/* jobs.c: tasks on several threads; which thread runs a task makes no difference to its result. */
#define _POSIX_C_SOURCE 200809L
#include "jobs.h"

#include <pthread.h>

enum { THREADS_MAX = 64 };

typedef struct queue {
    pthread_mutex_t lock;
    size_t next, n;
    void (*task)(void *work, size_t i);
    void *work;
} queue;

static void *worker(void *user) {
    queue *q = user;
    for (;;) {
        pthread_mutex_lock(&q->lock);
        size_t i = q->next < q->n ? q->next++ : q->n;
        pthread_mutex_unlock(&q->lock);
        if (i == q->n)
            return NULL;
        q->task(q->work, i);
    }
}

void jobs_run(void *user, size_t n, void (*task)(void *work, size_t i), void *work) {
    size_t jobs = *(const size_t *)user, started = 0;
    pthread_t thread[THREADS_MAX];
    queue q = {.n = n, .task = task, .work = work};
    pthread_mutex_init(&q.lock, NULL);
    while (started + 1 < jobs && started < THREADS_MAX &&
           pthread_create(&thread[started], NULL, worker, &q) == 0)
        started++;
    worker(&q);
    while (started > 0)
        pthread_join(thread[--started], NULL);
    pthread_mutex_destroy(&q.lock);
}
