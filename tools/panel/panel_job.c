/* panel_job.c: the calculations: fits, explain, the report. One runs at a time, as child processes that a
 * thread waits for. */
#define _POSIX_C_SOURCE 200809L
#include "panel.h"
#include "shared/json_out.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct line {
    const char *argv[PANEL_JOB_RUNS + 24];
    size_t n;
    char text[PANEL_JOB_RUNS + 8][CLI_PATH_MAX];
    size_t texts;
} line;

static void word(line *l, const char *text) {
    l->argv[l->n++] = text;
}

static char *place(line *l) {
    return l->text[l->texts++];
}

static void file(line *l, const panel *p, const char *folder, const char *name, const char *end) {
    char *to = place(l);
    if (panel_file(p, folder, name, end, to))
        word(l, to);
}

static void runs(line *l, const panel *p) {
    for (size_t i = 0; i < p->job.n; i++)
        file(l, p, "", p->job.run[i], ".csv");
}

/* Fits each run alone, then all of them together. */
static void fit_line(line *l, const panel *p, size_t i) {
    char *model = place(l);
    const char *name = p->job.run[i];
    snprintf(model, CLI_PATH_MAX, "%s/fits/%.*s.json", p->setup->session.out, (int)strlen(name) - 4, name);
    word(l, "characterize");
    file(l, p, "", name, ".csv");
    word(l, "--out");
    word(l, model);
}

static void all_line(line *l, const panel *p) {
    word(l, "characterize");
    runs(l, p);
    word(l, "--out");
    file(l, p, "fits/", PANEL_MODEL, ".json");
}

/* The next experiment of an earlier result must not stay. */
static void explain_line(line *l, const panel *p) {
    char old[CLI_PATH_MAX];
    if (panel_file(p, "fits/", "next.json", ".json", old))
        unlink(old);
    word(l, "explain");
    word(l, "--model");
    file(l, p, "fits/", PANEL_MODEL, ".json");
    runs(l, p);
    word(l, "--result");
    file(l, p, "fits/", "explain.json", ".json");
    word(l, "--next");
    file(l, p, "fits/", "next.json", ".json");
    word(l, "--report");
    file(l, p, "fits/", "explain.html", ".html");
    if (p->job.next_s > 0) {
        char *time = place(l);
        snprintf(time, CLI_PATH_MAX, "%.9g", p->job.next_s);
        word(l, "--next-time-s");
        word(l, time);
    }
}

/* Whether the last result of explain is of the chosen runs. */
static bool is_explained(const panel *p) {
    char path[CLI_PATH_MAX];
    json_t *result =
        panel_file(p, "fits/", "explain.json", ".json", path) ? json_load_file(path, 0, NULL) : NULL;
    const json_t *list = json_object_get(result, "pressed");
    bool same = json_array_size(list) == p->job.n;
    for (size_t i = 0; i < p->job.n && same; i++)
        same = strcmp(cli_base(json_text_at(json_array_get(list, i), "experiment")), p->job.run[i]) == 0;
    json_decref(result);
    return same;
}

static void report_line(line *l, const panel *p) {
    word(l, "report");
    runs(l, p);
    file(l, p, "fits/", PANEL_MODEL, ".json");
    if (is_explained(p))
        file(l, p, "fits/", "explain.json", ".json");
    word(l, "--out");
    file(l, p, "fits/", "report.html", ".html");
}

static bool is_cancelled(panel *p) {
    pthread_mutex_lock(&p->lock);
    bool cancelled = p->job.cancelled;
    pthread_mutex_unlock(&p->lock);
    return cancelled;
}

/* False after a failure, whose message has become a note. */
static bool run_line(panel *p, line *l) {
    char *out = NULL, *words = NULL;
    int code = is_cancelled(p) ? -1 : panel_child(l->argv, &out, &words, p);
    bool cancelled = is_cancelled(p);
    if (code != CLI_OK && code != CLI_NOT_CONVERGED && !cancelled) {
        size_t n = words ? strlen(words) : 0;
        while (n > 0 && words[n - 1] == '\n')
            words[--n] = '\0';
        const char *last = words && strrchr(words, '\n') ? strrchr(words, '\n') + 1 : words;
        panel_say(p, true, "%.2000s", last && *last ? last : "a calculation has failed");
    }
    free(out);
    free(words);
    return !cancelled && (code == CLI_OK || code == CLI_NOT_CONVERGED);
}

static void make(panel *p, line *l, void (*fill)(line *l, const panel *p), bool *good) {
    memset(l, 0, sizeof *l);
    word(l, NULL); /* its name */
    fill(l, p);
    *good = *good && run_line(p, l);
}

static void *work(void *context) {
    panel *p = context;
    line *l = malloc(sizeof *l);
    bool good = l != NULL;
    if (good && p->job.what == PANEL_FIT) {
        for (size_t i = 0; i < p->job.n && !is_cancelled(p); i++) {
            memset(l, 0, sizeof *l);
            word(l, NULL);
            fit_line(l, p, i);
            run_line(p, l); /* a run that cannot be fitted alone may be of use with others */
        }
        if (p->job.n > 1)
            make(p, l, all_line, &good);
    } else if (good) {
        make(p, l, all_line, &good);
        if (good)
            make(p, l, p->job.what == PANEL_EXPLAIN ? explain_line : report_line, &good);
    }
    free(l);
    pthread_mutex_lock(&p->lock);
    p->job.running = false;
    p->job.good = good;
    p->job.done++;
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

bool panel_job_start(panel *p, panel_job_what what, const char *names, double next_s,
                     char why[ACQUIRE_TEXT]) {
    char path[CLI_PATH_MAX];
    pthread_mutex_lock(&p->lock);
    bool free_now = !p->job.running;
    if (free_now) {
        if (p->job.started)
            pthread_join(p->job.thread, NULL); /* which has ended */
        p->job.started = p->job.cancelled = false;
        p->job.what = what;
        p->job.next_s = next_s;
        p->job.n = 0;
        for (const char *at = names; at && *at && p->job.n < PANEL_JOB_RUNS;
             at += at[strcspn(at, ",")] == ',') {
            size_t n = strcspn(at, ",");
            char *to = p->job.run[p->job.n];
            snprintf(to, sizeof p->job.run[0], "%.*s", (int)n, at);
            p->job.n += panel_file(p, "", to, ".csv", path) && access(path, R_OK) == 0;
            at += n;
        }
        snprintf(path, sizeof path, "%s/fits", p->setup->session.out);
        bool good = p->job.n > 0 && cli_folder("panel", path) == CLI_OK;
        p->job.running = p->job.started = good && pthread_create(&p->job.thread, NULL, work, p) == 0;
    }
    bool started = p->job.started && free_now;
    pthread_mutex_unlock(&p->lock);
    snprintf(why, ACQUIRE_TEXT,
             free_now ? "choose runs in the list first" : "a calculation is under way already");
    return started;
}

void panel_job_cancel(panel *p) {
    pthread_mutex_lock(&p->lock);
    p->job.cancelled = p->job.running;
    if (p->job.running && p->job.child > 0)
        kill(p->job.child, SIGTERM);
    pthread_mutex_unlock(&p->lock);
}

void panel_job_close(panel *p) {
    panel_job_cancel(p);
    if (p->job.started)
        pthread_join(p->job.thread, NULL);
}
