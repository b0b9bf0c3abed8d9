/* acquire_session.c: orders to the device, and waiting for it while its samples are recorded. */
#define _XOPEN_SOURCE 700 /* SIGXFSZ */
#include "acquire_session.h"

#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* Wall-clock limits: without samples for so long we ask for the status; without any message we give up. */
static const double ASK_S = 1, SILENT_S = 10;

static const double DEEPEST_MM = 1000; /* more than any travel */

enum { LISTEN_MS = 50, QUIET_MS = 10 };

static volatile sig_atomic_t stops;

static void note_stop(int signal_number) {
    (void)signal_number;
    stops++;
}

int session_stops(void) {
    return stops;
}

/* Errors while stopping do not replace the reason. */
outcome session_fail(session *s, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (!s->stopping)
        vsnprintf(s->why, sizeof s->why, format, arguments);
    va_end(arguments);
    return FAILED;
}

static void hear_samples(session *s, const palp_wire_samples *b) {
    s->tick = b->tick + b->count - 1u;
    s->case_C = 1e-2 * b->case_cC;
    if (s->tick - s->status_tick - 1 < INT32_MAX) { /* else a newer status has arrived */
        s->state = b->state;
    }
    if (s->file.fd >= 0 && acquire_file_add(&s->file, b) > 0)
        acquire_live_add(&s->live, &s->file.last);
}

static void hear(const palp_wire_message *m, unsigned lost_frames, void *context) {
    session *s = context;
    (void)lost_frames;
    s->heard_s = link_now_s();
    if (m->type == PALP_WIRE_TYPE_SAMPLES && m->as.samples.count > 0) {
        s->asked_s = s->heard_s;
        hear_samples(s, &m->as.samples);
    } else if (m->type == PALP_WIRE_TYPE_STATUS) {
        s->state = m->as.status.state;
        s->tick = s->status_tick = m->as.status.tick;
        s->case_C = 1e-2 * m->as.status.case_cC;
    }
    if (s->watcher.heard)
        s->watcher.heard(s, m, s->watcher.context);
}

bool session_moving(const session *s) {
    return s->state == PALP_WIRE_STATE_HOMING || s->state == PALP_WIRE_STATE_APPROACH ||
           s->state == PALP_WIRE_STATE_RUN || s->state == PALP_WIRE_STATE_RETRACT ||
           s->state == PALP_WIRE_STATE_JOG;
}

/* Whether a broken link may be reopened: nothing moved and nothing was recorded. */
static outcome mended(session *s, outcome end) {
    const bool may = s->reconnect && s->file.fd < 0 && !s->stopping && !session_moving(s) &&
                     strncmp(s->options->where, "fd:", 3) != 0;
    return end == GONE && may ? s->reconnect(s) : end;
}

/* The fault's reason and its time in the recording. */
static outcome faulted(session *s) {
    const palp_wire_status *now = &s->device.status;
    acquire_file *f = &s->file;
    palp_wire_message got;
    device_do(&s->device, PALP_WIRE_TYPE_GET_STATUS, &got);
    uint32_t ticks = now->fault_tick - f->first_tick;
    bool same_clock = now->state == PALP_WIRE_STATE_FAULT && ticks - (f->last_tick - f->first_tick) < 60000;
    if (f->fd >= 0 && f->started) {
        s->faulted_s = same_clock ? s->scale.tick_s * ticks : f->figures.duration_s;
        f->figures.lost += same_clock && !f->over && now->fault_tick != f->last_tick
                               ? now->fault_tick - f->last_tick - 1
                               : 0;
    }
    return FAULTED;
}

/* A write may fail before the last data were read. */
static outcome gone(session *s) {
    session_fail(s, "%s", s->device.why);
    for (int failed = 0, reads = 0; failed < 2 && reads < 10000; reads++)
        failed = device_poll(&s->device, 0) == DEVICE_OK ? 0 : failed + 1;
    return GONE;
}

outcome session_from_device(session *s, device_result result, const char *what) {
    switch (result) {
    case DEVICE_OK:
        return GOES_ON;
    case DEVICE_REFUSED:
        if (s->device.refusal == PALP_WIRE_RESULT_FAULTED || s->state == PALP_WIRE_STATE_FAULT)
            return faulted(s);
        return session_fail(s, "the device does not %s: %s (%s)", what,
                            palp_wire_result_text(s->device.refusal), s->doing);
    default:
        return gone(s);
    }
}

outcome session_ask(session *s, palp_wire_message *question, palp_wire_message *answer) {
    return session_from_device(s, device_command(&s->device, question, answer), "answer");
}

outcome session_order(session *s, palp_wire_message *command, const char *what) {
    return session_from_device(s, device_command(&s->device, command, NULL), what);
}

outcome session_status(session *s) {
    palp_wire_message got;
    outcome end = session_from_device(s, device_do(&s->device, PALP_WIRE_TYPE_GET_STATUS, &got), "answer");
    end = mended(s, end);
    return end == GOES_ON && s->state == PALP_WIRE_STATE_FAULT ? faulted(s) : end;
}

/* A force segment without a deepest place stays within the specimen, if its height is known. */
outcome session_segments(session *s, const acquire_run *r) {
    outcome end = GOES_ON;
    for (size_t i = 0; i < r->n_segments && end == GOES_ON; i++) {
        palp_wire_message m = {.type = PALP_WIRE_TYPE_SEGMENT, .as.segment = r->segment[i]};
        if (r->segment[i].kind == PALP_WIRE_SEGMENT_FORCE && r->segment[i].deepest_nm == 0)
            m.as.segment.deepest_nm = (int32_t)lrint(1e6 * fmin(s->options->height_mm, DEEPEST_MM));
        char what[ACQUIRE_NAME + 64];
        snprintf(what, sizeof what, "take segment %zu of %s", i + 1, r->name);
        end = session_order(s, &m, what);
    }
    return end;
}

static void show(session *s) {
    char line[ACQUIRE_TEXT];
    if (s->live.terminal) {
        session_line(s, line);
        acquire_live_show(&s->live, line);
    }
}

/* A restarted or silent device sends no samples. */
static outcome ask_how_it_is(session *s) {
    palp_wire_message got;
    s->asked_s = link_now_s();
    device_result result = device_do(&s->device, PALP_WIRE_TYPE_GET_STATUS, &got);
    if (result == DEVICE_TIMEOUT && link_now_s() - s->heard_s < SILENT_S)
        return GOES_ON;
    return session_from_device(s, result, "answer");
}

bool session_is_to_stop(const session *s) {
    return stops > s->stops_seen ||
           (!s->stopping && s->watcher.stops && s->watcher.stops(s, s->watcher.context));
}

outcome session_listen(session *s) {
    outcome end = GOES_ON;
    if (device_poll(&s->device, s->quiet ? QUIET_MS : LISTEN_MS) == DEVICE_CLOSED)
        end = gone(s);
    else if (s->quiet || link_now_s() - s->asked_s > ASK_S)
        end = ask_how_it_is(s);
    end = mended(s, end);
    acquire_file_keep(&s->file);
    if (end == GOES_ON && s->state == PALP_WIRE_STATE_FAULT)
        end = faulted(s);
    else if (end == GOES_ON && session_is_to_stop(s))
        end = STOPPED;
    else if (end == GOES_ON && s->file.error && !s->stopping)
        end = FAILED_SAID; /* by acquire_file_close */
    show(s);
    return end;
}

outcome session_settle(session *s, double limit_s) {
    outcome end = session_status(s);
    uint32_t from = s->tick;
    while (end == GOES_ON && session_moving(s)) {
        end = session_listen(s);
        if (end == GOES_ON && s->scale.tick_s * (s->tick - from) > limit_s)
            end = session_fail(s, "%s takes longer than %.0f s", s->doing, limit_s);
    }
    return end ? end : session_status(s);
}

outcome session_wait(session *s, double seconds) {
    outcome end = session_status(s);
    uint32_t from = s->tick;
    while (end == GOES_ON && s->scale.tick_s * (s->tick - from) < seconds)
        end = session_listen(s);
    return end;
}

outcome session_stream(session *s, bool on) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STREAM, .as.stream = {.on = on}};
    s->quiet = !on;
    outcome end = session_order(s, &m, "send samples");
    return mended(s, end);
}

static void catch_signals(void) {
    struct sigaction note = {.sa_handler = note_stop}, ignore = {.sa_handler = SIG_IGN};
    stops = 0;
    sigaction(SIGINT, &note, NULL);
    sigaction(SIGTERM, &note, NULL);
    sigaction(SIGHUP, &note, NULL);
    sigaction(SIGPIPE, &ignore, NULL);
    sigaction(SIGXFSZ, &ignore, NULL); /* a file-size limit gives an errno instead of a signal */
}

session *session_open(const acquire_options *options, const acquire_plan *plan) {
    session *s = calloc(1, sizeof *s);
    if (!s || !(s->done = json_array())) {
        free(s);
        cli_failure(options->command, "out of memory");
        return NULL;
    }
    s->options = options;
    s->plan = plan;
    s->began = time(NULL);
    s->file.fd = -1;
    s->faulted_s = -1;
    snprintf(s->doing, sizeof s->doing, "starting");
    if (device_open(options->where, options->baud, &s->device) != DEVICE_OK) {
        cli_failure(options->command, "%s", s->device.why);
        json_decref(s->done);
        free(s);
        return NULL;
    }
    catch_signals();
    s->scale.tick_s = s->device.info.tick_Hz > 0 ? 1.0 / s->device.info.tick_Hz : 1e-3;
    s->scale.count_mm = s->device.info.count_pm / 1e9;
    s->scale.contact_N = options->contact_N;
    s->device.listener = hear;
    s->device.context = s;
    s->heard_s = s->asked_s = link_now_s();
    acquire_live_start(&s->live, options->live);
    return s;
}

void session_close(session *s) {
    device_close(&s->device);
    json_decref(s->done);
    free(s);
}
