/* progress.h: a progress bar on stderr, only where stderr is a terminal. */
#ifndef PALPATE_PROGRESS_H
#define PALPATE_PROGRESS_H

#include <stdbool.h>

typedef struct progress {
    bool on, shown;
    char label[64];
    double started_s, drawn_s;
} progress;

void progress_start(progress *bar, const char *label);
void progress_update(progress *bar, double fraction); /* draws at most ten times a second */
void progress_finish(progress *bar);                  /* clears the line */

#endif
