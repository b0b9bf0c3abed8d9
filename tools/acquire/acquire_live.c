/* acquire_live.c: the display of palpate acquire during a run: a line, and the force curve in plain
 * characters. */
#define _POSIX_C_SOURCE 200809L
#include "acquire.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 16, COLUMNS = 64, ROWS_MAX = 64, COLUMNS_MAX = 256 };

void acquire_live_start(acquire_live *l, bool curve) {
    l->terminal = isatty(STDERR_FILENO) == 1;
    l->curve = curve;
    l->shown = false;
    l->rows = 0;
    l->drawn_s = 0;
    acquire_live_begin(l, false);
}

void acquire_live_begin(acquire_live *l, bool by_depth) {
    l->by_depth = by_depth;
    l->n = l->skipped = 0;
    l->stride = 1;
}

/* Keeps every stride-th sample; halves them when they are too many. */
void acquire_live_add(acquire_live *l, const acquire_sample *x) {
    if (++l->skipped < l->stride)
        return;
    l->skipped = 0;
    if (l->n == ACQUIRE_POINTS) {
        for (size_t i = 0; i < ACQUIRE_POINTS / 2; i++) {
            l->x[i] = l->x[2 * i];
            l->force_N[i] = l->force_N[2 * i];
        }
        l->n = ACQUIRE_POINTS / 2;
        l->stride *= 2;
    }
    l->x[l->n] = (float)(l->by_depth ? x->depth_mm : x->time_s);
    l->force_N[l->n++] = (float)x->force_N;
}

static void range(const float *x, size_t n, double *low, double *high) {
    *low = *high = n ? (double)x[0] : 0;
    for (size_t i = 0; i < n; i++) {
        *low = fmin(*low, (double)x[i]);
        *high = fmax(*high, (double)x[i]);
    }
    *high = *high > *low ? *high : *low + 1;
}

static int place(double x, double low, double high, int cells) {
    return (int)lrint((x - low) / (high - low) * (cells - 1));
}

void acquire_live_draw(const acquire_live *l, int rows, int columns, FILE *to) {
    char cell[ROWS_MAX][COLUMNS_MAX];
    double left, right, low, high;
    rows = rows < ROWS_MAX ? rows : ROWS_MAX;
    columns = columns < COLUMNS_MAX ? columns : COLUMNS_MAX;
    memset(cell, ' ', sizeof cell);
    range(l->x, l->n, &left, &right);
    range(l->force_N, l->n, &low, &high);
    for (size_t i = 0; i < l->n; i++) {
        int row = rows - 1 - place((double)l->force_N[i], low, high, rows);
        cell[row][place((double)l->x[i], left, right, columns)] = '*';
    }
    for (int r = 0; r < rows; r++) {
        char label[16] = "";
        if (r % 5 == 0)
            snprintf(label, sizeof label, "%.3f", high - (high - low) * r / (rows - 1));
        fprintf(to, "%8s |%.*s\n", label, columns, cell[r]);
    }
    fprintf(to, "%8s +", "N");
    for (int c = 0; c < columns; c++)
        fputc('-', to);
    fprintf(to, "\n%10s%-12.4g%*.4g %s\n", "", left, columns - 12, right, l->by_depth ? "mm" : "s");
}

/* Moves the cursor to the start of the last drawing. */
static void rewind_screen(acquire_live *l) {
    if (l->rows > 0)
        fprintf(stderr, "\033[%dA", l->rows);
    fputs("\r\033[J", stderr);
    l->rows = 0;
}

void acquire_live_show(acquire_live *l, const char *line) {
    double now = link_now_s();
    if (!l->terminal || now - l->drawn_s < 0.1)
        return;
    rewind_screen(l);
    if (l->curve && l->n > 1) {
        acquire_live_draw(l, ROWS, COLUMNS, stderr);
        l->rows = ROWS + 2;
    }
    fputs(line, stderr);
    fflush(stderr);
    l->drawn_s = now;
    l->shown = true;
}

void acquire_live_end(acquire_live *l) {
    if (l->terminal && l->shown)
        rewind_screen(l);
    if (l->curve && l->n > 1)
        acquire_live_draw(l, ROWS, COLUMNS, stderr);
    l->n = 0;
    l->shown = false;
}
