/* watch.h: a progress bar for a search of the library, which Ctrl-C ends early. */
#ifndef PALPATE_WATCH_H
#define PALPATE_WATCH_H

#include "progress.h"

#include <palpate/explain.h>
#include <pthread.h>

/* The progress bar, and the finished share of the work; threads take turns. */
typedef struct watch {
    pthread_mutex_t lock;
    progress bar;
    double done;
} watch;

/* Sets the settings' progress and stop, for the command of this name. The first Ctrl-C ends the search, which
 * returns what it found; the next one ends the command. One at a time; w stays where it is until
 * watch_finish. */
void watch_start(watch *w, const char *command, palp_explain_settings *settings);
void watch_finish(watch *w);

#endif
