/* acquire_file.c: the recording on disk: an experiment CSV that is whole at every moment. */
#define _POSIX_C_SOURCE 200809L
#include "acquire.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The first lines of the file hold the end of the run and its start in the session. They have a fixed width
 * and are overwritten when both are known. If the host dies, "interrupted" and the expected start remain. No
 * row crosses the end of a page, where an incomplete write may stop; blanks at the end of lines fill the
 * page. */
enum { PAGE = 4096, ROW_MAX = 256, END_WIDTH = 48 };

static const char NAME[] = "acquire";
static const char VERSION[] = "# palpate.experiment: 1\n";
static const double KEEP_S = 0.5; /* longest delay of a row before it is written */

/* Number of bytes in complete lines. */
static size_t whole_lines(const char *text, size_t n) {
    while (n > 0 && text[n - 1] != '\n')
        n--;
    return n;
}

static size_t count_lines(const char *text, size_t n) {
    size_t lines = 0;
    for (size_t i = 0; i < n; i++)
        lines += text[i] == '\n';
    return lines;
}

/* Writes all pending rows. On failure the file is cut to complete lines and closed. */
static void flush(acquire_file *f) {
    size_t done = 0;
    while (done < f->n && !f->error) {
        ssize_t n = write(f->fd, f->text + done, f->n - done);
        if (n > 0) {
            done += (size_t)n;
        } else if (errno != EINTR) {
            f->error = errno;
            done = whole_lines(f->text, done);
            if (ftruncate(f->fd, f->at + (off_t)done) != 0)
                done = 0;
            size_t rows = count_lines(f->text + done, f->n - done);
            f->figures.samples -= rows < f->figures.samples ? rows : f->figures.samples;
        }
    }
    f->at += (off_t)done;
    f->n = 0;
    f->written_s = link_now_s();
}

static void put(acquire_file *f, const char *text, size_t n) {
    if (f->n + n > sizeof f->text)
        flush(f);
    if (n <= sizeof f->text) {
        memcpy(f->text + f->n, text, n);
        f->n += n;
    }
}

/* Ends a row. If the page has no room for another one, blanks fill it. */
static void put_row(acquire_file *f, char row[ROW_MAX + PAGE], int length) {
    size_t n = (size_t)length, left = PAGE - ((size_t)f->at + f->n + n + 1) % PAGE;
    size_t blanks = left < ROW_MAX ? left : 0;
    memset(row + n, ' ', blanks);
    row[n + blanks] = '\n';
    put(f, row, n + blanks + 1);
}

unsigned acquire_columns(const char *words) {
    static const struct {
        const char *word;
        unsigned column;
    } known[] = {{"forces", ACQUIRE_FORCES}, {"temperature", ACQUIRE_TEMPERATURE}};
    unsigned columns = 0;
    for (const char *next = words; *next;) {
        const size_t n = strcspn(next, ",");
        const unsigned before = columns;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            if (strlen(known[i].word) == n && strncmp(next, known[i].word, n) == 0)
                columns |= known[i].column;
        if (columns == before)
            return 0;
        next += n + (next[n] == ',');
    }
    return columns;
}

/* One "# key: value", padded. */
static size_t end_line(char *to, const char *key, const char *value) {
    char line[2 * END_WIDTH];
    int n = snprintf(line, sizeof line, "# %s: %.24s", key, value);
    memset(to, ' ', END_WIDTH);
    memcpy(to, line, (size_t)n);
    to[END_WIDTH - 1] = '\n';
    return END_WIDTH;
}

static size_t end_number(char *to, const char *key, int digits, double value) {
    char text[64];
    int n = fabs(value) < 1e12 ? snprintf(text, sizeof text, "%.*f", digits, value) : 0;
    return end_line(to, key, n > 0 ? text : "null");
}

enum { END_LINES = 10 };

/* fault: as JSON. */
static size_t end_text(const acquire_file *f, const char *fault, double winding_C,
                       char text[END_LINES * END_WIDTH]) {
    const acquire_figures *g = &f->figures;
    bool known = strcmp(fault, "\"interrupted\"") != 0;
    size_t n = end_line(text, "end.fault", fault);
    n += end_number(text + n, "end.samples", 0, known ? (double)g->samples : NAN);
    n += end_number(text + n, "end.lost_samples", 0, known ? (double)g->lost : NAN);
    n += end_number(text + n, "end.bad_samples", 0, known ? (double)g->bad : NAN);
    n += end_number(text + n, "end.peak_N", 4, g->samples ? g->peak_N : NAN);
    n += end_number(text + n, "end.contact_mm", 4, known ? g->contact_mm : NAN);
    n += end_number(text + n, "end.error_rms_mm", 5,
                    g->errors ? sqrt(g->error_square / (double)g->errors) : NAN);
    n += end_number(text + n, "end.error_most_mm", 5, g->errors ? g->error_most_mm : NAN);
    n += end_number(text + n, "end.winding_C", 1, winding_C);
    n += end_number(text + n, "session.start_s", 3, f->start_s);
    return n;
}

static void put_names(acquire_file *f) {
    static const struct {
        unsigned column;
        const char *names;
    } groups[] = {{ACQUIRE_RAW, ",error_mm,position_counts,adc_0,adc_1,adc_2,adc_3,adc_4,adc_5,duty,flags"},
                  {ACQUIRE_FORCES, ",Fx_N,Fy_N,Fz_N,Tx_Nm,Ty_Nm,Tz_Nm"},
                  {ACQUIRE_TEMPERATURE, ",temperature_C"},
                  {ACQUIRE_TRIGGER, ",trigger_in,trigger_out"}};
    put(f, "time_s,depth_mm,force_N", strlen("time_s,depth_mm,force_N"));
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++)
        if (f->columns & groups[i].column)
            put(f, groups[i].names, strlen(groups[i].names));
    put(f, "\n", 1);
}

static void put_header(acquire_file *f, json_t *header) {
    char text[END_LINES * END_WIDTH];
    const char *key;
    json_t *value;
    put(f, VERSION, sizeof VERSION - 1);
    put(f, text, end_text(f, "\"interrupted\"", NAN, text));
    json_object_foreach(header, key, value) {
        char *shown = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(12));
        put(f, "# ", 2);
        put(f, key, strlen(key));
        put(f, ": ", 2);
        put(f, shown ? shown : "null", shown ? strlen(shown) : 4);
        put(f, "\n", 1);
        free(shown);
    }
    put_names(f);
}

int acquire_file_open(acquire_file *f, const char *path, bool force, unsigned columns,
                      const acquire_scale *scale, uint32_t now_tick, json_t *header) {
    f->columns = columns;
    f->started = f->waits = f->over = false;
    f->scale = *scale;
    f->start_s = f->in_session ? scale->tick_s * (now_tick - f->session_tick) : 0;
    f->figures = (acquire_figures){.contact_mm = NAN};
    f->at = 0;
    f->error = 0;
    f->n = 0;
    snprintf(f->path, sizeof f->path, "%s", path);
    f->fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | (force ? O_TRUNC : O_EXCL), 0666);
    if (f->fd < 0 && errno == EEXIST)
        return cli_failure(NAME, "%s exists; name another --out, or give --force", path);
    if (f->fd < 0)
        return cli_failure(NAME, "%s: %s", path, strerror(errno));
    put_header(f, header);
    flush(f);
    if (f->error) {
        int code = cli_failure(NAME, "%s: %s", path, strerror(f->error));
        acquire_file_remove(f);
        return code;
    }
    return CLI_OK;
}

static double along(const acquire_scale *s, const double row[PALP_WIRE_CHANNELS],
                    const int16_t adc[PALP_WIRE_CHANNELS]) {
    double sum = 0;
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++)
        sum += row[c] * ((double)adc[c] - s->tare[c]);
    return sum;
}

double acquire_force_N(const acquire_scale *s, const int16_t adc[PALP_WIRE_CHANNELS]) {
    return along(s, s->row_N, adc);
}

static acquire_sample make_sample(const acquire_file *f, const palp_wire_samples *b, size_t i) {
    const acquire_scale *s = &f->scale;
    acquire_sample x = {.time_s = s->tick_s * (double)(b->tick + (uint32_t)i - f->first_tick),
                        .depth_mm = s->count_mm * (double)(b->position[i] - s->contact),
                        .error_mm = s->count_mm * (double)b->error[i]};
    x.force_N = acquire_force_N(s, &b->adc[i * PALP_WIRE_CHANNELS]);
    return x;
}

/* Contact of this recording: where the running mean of the force rises above that in air. The depth has the
 * same mean, so that both have the same delay. */
static void seek_contact(acquire_file *f, const acquire_sample *x, bool moving) {
    const double share = 1.0 / 16;
    acquire_figures *g = &f->figures;
    if (!moving && g->air == g->samples) {
        g->air_sum_N += x->force_N;
        g->air++;
        g->mean_N = g->air_sum_N / (double)g->air;
        g->mean_mm = x->depth_mm;
        return;
    }
    g->mean_N += share * (x->force_N - g->mean_N);
    g->mean_mm += share * (x->depth_mm - g->mean_mm);
    if (isnan(g->contact_mm) && g->air > 0 &&
        g->mean_N - g->air_sum_N / (double)g->air > f->scale.contact_N) {
        g->contact_mm = g->mean_mm;
    }
}

static void look(acquire_file *f, const acquire_sample *x, unsigned flags) {
    acquire_figures *g = &f->figures;
    bool moving = (flags & PALP_WIRE_FLAG_TRAJECTORY) != 0;
    seek_contact(f, x, moving);
    g->peak_N = g->samples ? fmax(g->peak_N, x->force_N) : x->force_N;
    g->deepest_mm = g->samples ? fmax(g->deepest_mm, x->depth_mm) : x->depth_mm;
    if (moving) {
        g->error_square += x->error_mm * x->error_mm;
        g->error_most_mm = fmax(g->error_most_mm, fabs(x->error_mm));
        g->errors++;
    }
    g->duration_s = x->time_s;
    g->samples++;
}

static void put_sample(acquire_file *f, const acquire_sample *x, const palp_wire_samples *b, size_t i) {
    char row[ROW_MAX + PAGE];
    const int16_t *adc = &b->adc[i * PALP_WIRE_CHANNELS];
    int n = snprintf(row, ROW_MAX, "%.*f,%.*f,%.5f", f->scale.tick_s == 1e-3 ? 3 : 6, x->time_s,
                     f->scale.count_mm == 1e-3 ? 3 : 6, x->depth_mm, x->force_N);
    if (f->columns & ACQUIRE_RAW)
        n += snprintf(row + n, (size_t)(ROW_MAX - n), ",%.*f,%ld,%d,%d,%d,%d,%d,%d,%d,%u",
                      f->scale.count_mm == 1e-3 ? 3 : 6, x->error_mm, (long)b->position[i], adc[0], adc[1],
                      adc[2], adc[3], adc[4], adc[5], b->duty[i], (unsigned)b->flags[i]);
    for (size_t axis = 0; (f->columns & ACQUIRE_FORCES) && axis < PALP_WIRE_CHANNELS; axis++)
        n += snprintf(row + n, (size_t)(ROW_MAX - n), ",%.*f", axis < 3 ? 5 : 7,
                      along(&f->scale, f->scale.matrix[axis], adc));
    if (f->columns & ACQUIRE_TEMPERATURE)
        n += snprintf(row + n, (size_t)(ROW_MAX - n), ",%.2f", 1e-2 * b->case_cC);
    if (f->columns & ACQUIRE_TRIGGER)
        n +=
            snprintf(row + n, (size_t)(ROW_MAX - n), ",%d,%d", (b->flags[i] & PALP_WIRE_FLAG_TRIGGER_IN) != 0,
                     (b->flags[i] & PALP_WIRE_FLAG_TRIGGER_OUT) != 0);
    put_row(f, row, n < ROW_MAX ? n : ROW_MAX - 1);
}

/* Session time is relative to the first sample of the first recording. */
static void start_clock(acquire_file *f, uint32_t tick) {
    f->session_tick = f->in_session ? f->session_tick : tick;
    f->in_session = f->started = true;
    f->first_tick = tick;
    f->start_s = f->scale.tick_s * (tick - f->session_tick);
}

/* Counts a sample outside the recording: samples missing next to it may belong to the recording. */
static void take_other(acquire_file *f, uint32_t tick, uint32_t step) {
    if (!f->started) {
        f->waits = true;
        f->before_tick = tick;
    } else if (!f->over && step > 0 && step <= INT32_MAX) {
        f->figures.lost += step - 1;
        f->over = true;
    }
}

/* Adds sample i of a block; false: it is outside the recording. */
static bool take(acquire_file *f, const palp_wire_samples *b, size_t i) {
    const uint32_t tick = b->tick + (uint32_t)i, step = tick - (f->started ? f->last_tick : f->before_tick);
    if (!(b->flags[i] & PALP_WIRE_FLAG_RECORD)) {
        take_other(f, tick, step);
        return false;
    }
    if ((f->started || f->waits) && (step == 0 || step > INT32_MAX))
        return false;
    f->figures.lost += f->started || f->waits ? step - 1 : 0;
    if (!f->started)
        start_clock(f, tick);
    f->last_tick = tick;
    if (b->flags[i] & PALP_WIRE_FLAG_SENSOR_BAD) {
        f->figures.bad++;
        return false;
    }
    f->last = make_sample(f, b, i);
    look(f, &f->last, b->flags[i]);
    put_sample(f, &f->last, b, i);
    return true;
}

size_t acquire_file_add(acquire_file *f, const palp_wire_samples *b) {
    size_t taken = 0;
    for (size_t i = 0; i < b->count && i < PALP_WIRE_SAMPLES && f->fd >= 0 && !f->error; i++)
        taken += take(f, b, i);
    acquire_file_keep(f);
    return taken;
}

void acquire_file_keep(acquire_file *f) {
    if (f->fd >= 0 && f->n > 0 && (f->n > sizeof f->text / 2 || link_now_s() - f->written_s > KEEP_S))
        flush(f);
}

bool acquire_file_lossy(const acquire_figures *g) {
    return 100 * (g->lost + g->bad) > g->samples + g->lost + g->bad;
}

int acquire_file_close(acquire_file *f, const char *fault, double winding_C) {
    char text[END_LINES * END_WIDTH], quoted[32];
    snprintf(quoted, sizeof quoted, fault ? "\"%.22s\"" : "null", fault);
    flush(f);
    size_t n = end_text(f, quoted, winding_C, text);
    ssize_t done;
    do {
        done = pwrite(f->fd, text, n, sizeof VERSION - 1);
    } while (done < 0 && errno == EINTR);
    if (done != (ssize_t)n && !f->error)
        f->error = done < 0 ? errno : EIO;
    if (fdatasync(f->fd) != 0 && !f->error && errno != EINVAL && errno != EROFS)
        f->error = errno;
    close(f->fd);
    f->fd = -1;
    return f->error ? cli_failure(NAME, "%s: %s", f->path, strerror(f->error)) : CLI_OK;
}

void acquire_file_remove(acquire_file *f) {
    close(f->fd);
    f->fd = -1;
    unlink(f->path);
}
