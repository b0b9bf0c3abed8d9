/* progress.c: a progress bar on stderr, only where stderr is a terminal. */
#define _POSIX_C_SOURCE 200809L
#include "progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { BAR_WIDTH = 30 };

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_start(progress *bar, const char *label) {
    *bar = (progress){.on = isatty(STDERR_FILENO) == 1};
    snprintf(bar->label, sizeof bar->label, "%s", label);
    bar->started_s = bar->drawn_s = now_s();
}

void progress_update(progress *bar, double fraction) {
    if (!bar->on)
        return;
    double now = now_s();
    if (now - bar->drawn_s < 0.1)
        return;
    fraction = fraction >= 0 && fraction <= 1 ? fraction : fraction > 1;
    int full = (int)(fraction * BAR_WIDTH);
    fprintf(stderr, "\r%-20s [", bar->label);
    for (int i = 0; i < BAR_WIDTH; i++)
        fputc(i < full ? '#' : '.', stderr);
    fprintf(stderr, "] %3.0f %%", 100 * fraction);
    if (fraction > 0.02)
        fprintf(stderr, "  %.0f s left\033[K", (now - bar->started_s) * (1 - fraction) / fraction);
    fflush(stderr);
    bar->drawn_s = now;
    bar->shown = true;
}

void progress_finish(progress *bar) {
    if (bar->shown) {
        fputs("\r\033[K", stderr);
        bar->shown = false;
    }
}
