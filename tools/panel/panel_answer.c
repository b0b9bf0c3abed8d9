/* panel_answer.c: the answers to the page's requests, by path. */
#define _POSIX_C_SOURCE 200809L
#include "panel.h"
#include "shared/json_out.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OK = 200, BAD = 400, NOT_FOUND = 404, BUSY = 409, FAILED_HERE = 500 };

static panel_reply json_reply(unsigned code, json_t *value) {
    panel_reply r = {.code = code, .type = "application/json"};
    r.text = value ? json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    r.n = r.text ? strlen(r.text) : 0;
    json_decref(value);
    return r;
}

static panel_reply done(void) {
    return json_reply(OK, json_object());
}

static panel_reply wrong(unsigned code, const char *format, ...) {
    char text[ACQUIRE_WORDS];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return json_reply(code, json_pack("{ss}", "error", text));
}

static panel_reply ask(panel *p, const panel_command *command) {
    return panel_ask(p, command) ? done() : wrong(BUSY, "The indenter is busy; stop it first.");
}

static bool number_of(const panel_request *q, const char *key, double *value) {
    const char *text = q->query(q->context, key);
    return text && cli_read_number(text, value);
}

static size_t count_of(const panel_request *q, const char *key) {
    double value = 0;
    return number_of(q, key, &value) && value >= 0 && value < 1e15 ? (size_t)value : 0;
}

/* ---- the page and what it shows ---- */

static panel_reply get_page(panel *p, const panel_request *q) {
    panel_reply r = {.code = OK, .type = "text/html; charset=utf-8"};
    (void)p;
    (void)q;
    r.text = panel_page(&r.n);
    return r;
}

static panel_reply get_live(panel *p, const panel_request *q) {
    return json_reply(OK, panel_live(p, count_of(q, "point"), count_of(q, "note")));
}

static panel_reply get_runs(panel *p, const panel_request *q) {
    (void)q;
    return json_reply(OK, panel_runs(p));
}

static panel_reply get_curve(panel *p, const panel_request *q) {
    char path[CLI_PATH_MAX], why[ACQUIRE_TEXT];
    if (!panel_file(p, "", q->query(q->context, "run"), ".csv", path))
        return wrong(NOT_FOUND, "there is no such run");
    json_t *curve = panel_curve(path, why);
    return curve ? json_reply(OK, curve) : wrong(BAD, "%s", why);
}

/* Results of a calculation: pages, models, the next experiment. */
static panel_reply get_made(panel *p, const panel_request *q) {
    const char *name = q->query(q->context, "name");
    char path[CLI_PATH_MAX];
    palp_error error;
    bool page = panel_file(p, "fits/", name, ".html", path);
    panel_reply r = {OK, page ? "text/html; charset=utf-8" : "application/json", NULL, 0};
    if (!page && !panel_file(p, "fits/", name, ".json", path))
        return wrong(NOT_FOUND, "there is no such file");
    return palp_file_read(path, &r.text, &r.n, &error) ? wrong(NOT_FOUND, "%s", error.text) : r;
}

static panel_reply post_job(panel *p, const panel_request *q) {
    static const char *const names[] = {"fit", "explain", "report"};
    const char *what = q->query(q->context, "what");
    char why[ACQUIRE_TEXT];
    double next_s = 0;
    if (q->query(q->context, "next_s") && !(number_of(q, "next_s", &next_s) && next_s > 0 && next_s <= 1e7))
        return wrong(BAD, "next_s must be a number above 0, 1e7 at most");
    if (what && strcmp(what, "cancel") == 0) {
        panel_job_cancel(p);
        return done();
    }
    for (int i = 0; what && i < 3; i++)
        if (strcmp(what, names[i]) == 0)
            return panel_job_start(p, (panel_job_what)i, q->body, next_s, why) ? done()
                                                                               : wrong(BUSY, "%s", why);
    return wrong(BAD, "no such calculation");
}

/* ---- a protocol: what the page's form makes ---- */

/* Tries the protocol with the program that would run it. Its message loses the file's name, which the user
 * never gave. */
static panel_reply try_plan(panel *p, const char *file) {
    const acquire_options *o = &p->setup->session;
    char height[32], *out, *words;
    const char *kind = o->specimen_kind ? o->specimen_kind : "cylinder";
    snprintf(height, sizeof height, "%.17g", o->height_mm > 0 ? o->height_mm : 1000);
    const char *argv[] = {
        NULL,   "acquire",         "--dry-run", "--json", "--protocol", file, "--specimen-height-mm",
        height, "--specimen-kind", kind,        NULL};
    int code = panel_child(argv, &out, &words, NULL);
    panel_reply r;
    if (code == CLI_OK) {
        r = (panel_reply){OK, "application/json", out, strlen(out)};
        out = NULL;
    } else {
        char *at = words ? strstr(words, file) : NULL;
        const char *why = at                ? at + strlen(file)
                          : words && *words ? words
                                            : "the protocol could not be tried";
        why += *why == ':';
        r = wrong(BAD, "%.*s", (int)strcspn(why, "\n"), why);
    }
    free(out);
    free(words);
    return r;
}

static bool write_all(int fd, const char *text) {
    size_t n = strlen(text), at = 0;
    while (at < n) {
        ssize_t some = write(fd, text + at, n - at);
        if (some < 0 && errno != EINTR)
            return false;
        at += some > 0 ? (size_t)some : 0;
    }
    return true;
}

/* Writes the protocol to the first of protocol.json, protocol_2.json ... that does not exist yet. It stays
 * beside the recordings made by it. */
static bool keep_protocol(const panel *p, const char *text, char file[CLI_PATH_MAX]) {
    int fd = -1;
    for (int k = 1; fd < 0 && k < 100000 && (k == 1 || errno == EEXIST); k++) {
        char number[16] = "";
        if (k > 1)
            snprintf(number, sizeof number, "_%d", k);
        int n = snprintf(file, CLI_PATH_MAX, "%s/protocol%s.json", p->setup->session.out, number);
        fd = n < CLI_PATH_MAX ? open(file, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666) : -1;
    }
    bool good = fd >= 0 && write_all(fd, text);
    return fd >= 0 && close(fd) == 0 && good;
}

/* Tries it; the file stays only with keep and if it is valid. */
static panel_reply with_protocol(panel *p, const panel_request *q, bool keep, char file[CLI_PATH_MAX]) {
    if (!keep_protocol(p, q->body, file))
        return wrong(FAILED_HERE, "%s: %s", file, strerror(errno));
    panel_reply r = try_plan(p, file);
    if (!keep || r.code != OK)
        unlink(file);
    return r;
}

static panel_reply post_plan(panel *p, const panel_request *q) {
    char file[CLI_PATH_MAX];
    return with_protocol(p, q, false, file);
}

static panel_reply post_start(panel *p, const panel_request *q) {
    panel_command c = {.what = PANEL_START};
    panel_reply r = with_protocol(p, q, true, c.file);
    if (r.code != OK)
        return r;
    free(r.text);
    r = ask(p, &c);
    if (r.code != OK)
        unlink(c.file);
    return r;
}

static panel_reply post_do(panel *p, const panel_request *q) {
    static const struct {
        const char *name;
        panel_what what;
    } orders[] = {{"prepare", PANEL_PREPARE}, {"home", PANEL_HOME}, {"tare", PANEL_TARE},
                  {"contact", PANEL_CONTACT}, {"hold", PANEL_HOLD}, {"release", PANEL_RELEASE},
                  {"clear", PANEL_CLEAR}};
    const char *what = q->query(q->context, "what");
    for (size_t i = 0; what && i < sizeof orders / sizeof orders[0]; i++)
        if (strcmp(what, orders[i].name) == 0)
            return ask(p, &(panel_command){.what = orders[i].what});
    return wrong(BAD, "no such order");
}

static panel_reply post_jog(panel *p, const panel_request *q) {
    panel_command c = {.what = PANEL_JOG};
    if (!number_of(q, "by_mm", &c.by_mm) || !(c.by_mm >= -100 && c.by_mm <= 100))
        return wrong(BAD, "by_mm must be a number from -100 to 100");
    if (!number_of(q, "rate_mm_s", &c.rate_mm_s) || !(c.rate_mm_s >= 0.01 && c.rate_mm_s <= 10))
        return wrong(BAD, "rate_mm_s must be a number from 0.01 to 10");
    return ask(p, &c);
}

static panel_reply post_stop(panel *p, const panel_request *q) {
    (void)q;
    panel_stop(p);
    return done();
}

static panel_reply post_emergency(panel *p, const panel_request *q) {
    (void)q;
    return json_reply(OK, json_pack("{sb}", "stopped", panel_emergency(p)));
}

panel_reply panel_answer(panel *p, const panel_request *q) {
    static const struct {
        bool post;
        const char *path;
        panel_reply (*answer)(panel *p, const panel_request *q);
    } answers[] = {
        {false, "/", get_page},     {false, "/live", get_live},   {true, "/plan", post_plan},
        {false, "/runs", get_runs}, {false, "/curve", get_curve}, {false, "/made", get_made},
        {true, "/job", post_job},   {true, "/start", post_start}, {true, "/do", post_do},
        {true, "/jog", post_jog},   {true, "/stop", post_stop},   {true, "/emergency", post_emergency}};
    for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++)
        if (answers[i].post == q->post && strcmp(answers[i].path, q->path) == 0)
            return answers[i].answer(p, q);
    return wrong(NOT_FOUND, "there is no %.100s", q->path);
}
