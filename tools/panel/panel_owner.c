/* panel_owner.c: the one thread that talks to the indenter: it carries out the pages' commands and keeps what
 * they show. */
#define _POSIX_C_SOURCE 200809L
#include "panel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char NAME[] = "panel";

typedef struct owner {
    panel *panel;
    session *session;
    acquire_plan *plan;
    bool configured, tared;
    uint32_t faulted_tick; /* of the fault that was told */
    bool faulted, gone;    /* and whether it was */
} owner;

static panel_view view_of(const owner *o) {
    const session *s = o->session;
    const acquire_file *f = &s->file;
    panel_view v = {.status = s->device.status,
                    .limits = s->limits,
                    .info = s->device.info,
                    .calibration = s->calibration.now.id,
                    .calibration_day = device_parameter_value(&s->calibration, "calibration_day", 0),
                    .number = s->number,
                    .of = s->plan->n,
                    .recording = f->fd >= 0,
                    .gone = o->gone,
                    .state = s->state,
                    .case_C = s->case_C,
                    .place_mm = s->scale.count_mm * s->device.status.position,
                    .runs = (unsigned)json_array_size(s->done)};
    snprintf(v.doing, sizeof v.doing, "%s", s->doing);
    if (f->fd >= 0) {
        snprintf(v.run, sizeof v.run, "%s", s->run->name);
        v.samples = f->figures.samples;
        v.lost = f->figures.lost;
        v.elapsed_s = f->started ? f->last.time_s : 0;
        v.length_s = acquire_run_length_s(s->run);
    }
    return v;
}

static void add_block(const owner *o, const palp_wire_samples *b) {
    const session *s = o->session;
    const palp_wire_status *now = &s->device.status;
    panel_point x = {.time_s = s->scale.tick_s * b->tick};
    double n = 0;
    for (size_t i = 0; i < b->count; i++) {
        if (b->flags[i] & PALP_WIRE_FLAG_SENSOR_BAD)
            continue;
        x.force_N += acquire_force_N(&s->scale, &b->adc[i * PALP_WIRE_CHANNELS]);
        x.place_mm += s->scale.count_mm * b->position[i];
        x.error_mm += s->scale.count_mm * b->error[i];
        n++;
    }
    panel_view v = view_of(o);
    x.force_N /= n; /* NAN where there was none */
    x.place_mm /= n;
    x.error_mm /= n;
    v.place_mm = x.place_mm;
    x.depth_mm = now->contact_known ? x.place_mm - s->scale.count_mm * now->contact : NAN;
    x.run = s->file.fd >= 0 && s->file.started ? v.runs + 1 : 0;
    panel_add(o->panel, &x, &v);
}

static void heard(const session *s, const palp_wire_message *m, void *context) {
    const owner *o = context;
    if (m->type == PALP_WIRE_TYPE_SAMPLES && m->as.samples.count > 0) {
        add_block(o, &m->as.samples);
    } else {
        panel_view v = view_of(o);
        panel_see(o->panel, &v);
    }
    (void)s;
}

static void told(bool warning, const char *text, void *context) {
    const owner *o = context;
    panel_say(o->panel, warning, "%s", text);
}

static bool stops(const session *s, void *context) {
    const owner *o = context;
    (void)s;
    return panel_is_to_stop(o->panel);
}

static outcome configure(owner *o) {
    outcome end = o->configured ? GOES_ON : session_configure(o->session);
    end = end || o->configured ? end : session_read_scale(o->session);
    o->configured = end == GOES_ON;
    return end;
}

static outcome find_contact(owner *o) {
    outcome end = session_find_contact(o->session);
    o->session->scale.contact = o->session->device.status.contact;
    return end;
}

/* Not in the specimen: its force would then count as zero. */
static outcome tare(owner *o) {
    const session *s = o->session;
    const palp_wire_status *now = &s->device.status;
    outcome end = session_status(o->session);
    if (end == GOES_ON && now->contact_known && now->position > now->contact)
        return session_fail(o->session, "the plate is in the specimen: move it up, then tare");
    end = end ? end : session_tare(o->session);
    o->tared = o->tared || end == GOES_ON;
    return end;
}

/* Only the steps that are missing, so that contact is searched for once. */
static outcome prepare(owner *o, bool all) {
    const palp_wire_status *now = &o->session->device.status;
    outcome end = session_status(o->session);
    end = end || (now->homed && !all) ? end : session_home(o->session);
    end = end || (o->tared && !all) ? end : tare(o);
    end = end || (now->contact_known && !all) ? end : find_contact(o);
    o->session->scale.contact = now->contact;
    return end;
}

static outcome jog(owner *o, double by_mm, double rate_mm_s) {
    session *s = o->session;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_JOG};
    const double travel_mm = 1e-6 * s->device.info.travel_nm;
    outcome end = session_status(s);
    const double to_mm = s->scale.count_mm * s->device.status.position + by_mm;
    m.as.jog.to_nm = (int32_t)lrint(1e6 * fmin(fmax(to_mm, 0), travel_mm));
    m.as.jog.rate_nm_s = (uint32_t)lrint(1e6 * rate_mm_s);
    snprintf(s->doing, sizeof s->doing, by_mm == 0 ? "holding" : "moving the plate");
    end = end ? end : session_order(s, &m, "move the plate");
    return end ? end : session_settle(s, fabs(by_mm) / rate_mm_s + 60);
}

static outcome release(owner *o) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STOP};
    outcome end = session_order(o->session, &m, "let go of the plate");
    return end ? end : session_status(o->session);
}

static outcome clear(owner *o) {
    session *s = o->session;
    palp_wire_message got;
    device_result result = device_do(&s->device, PALP_WIRE_TYPE_CLEAR_FAULT, NULL);
    o->configured = false; /* it may have restarted */
    if (result == DEVICE_REFUSED && s->device.refusal == PALP_WIRE_RESULT_PERSISTS)
        return session_fail(s, "the cause of %s is still there",
                            palp_wire_fault_name(s->device.status.fault));
    device_do(&s->device, PALP_WIRE_TYPE_GET_STATUS, &got);
    return configure(o);
}

/* A number makes the name new: nothing is overwritten. */
static void rename_run(const acquire_options *options, acquire_run *r) {
    char path[CLI_PATH_MAX], name[ACQUIRE_NAME - 8];
    snprintf(name, sizeof name, "%.*s", (int)sizeof name - 1, r->name);
    for (unsigned k = 2; k < 100000; k++) {
        int n = snprintf(path, sizeof path, "%s/%s.csv", options->out, r->name);
        if (n < 0 || (size_t)n >= sizeof path || access(path, F_OK) != 0)
            return;
        snprintf(r->name, sizeof r->name, "%s_%u", name, k);
    }
}

static outcome read_plan(owner *o, const char *file) {
    const acquire_motion none = acquire_motion_none();
    session *s = o->session;
    *o->plan = (acquire_plan){.random = -1, .repeat_first = -1, .seed = NAN};
    if (acquire_plan_read(o->plan, file, &none) != CLI_OK || !acquire_plan_arrange(o->plan))
        return session_fail(s, "%.300s cannot be read any more", file);
    for (size_t i = 0; i < o->plan->n; i++)
        rename_run(s->options, &o->plan->run[i]);
    s->plan = o->plan;
    s->number = 0;
    return GOES_ON;
}

static outcome start(owner *o, const char *file) {
    session *s = o->session;
    outcome end = read_plan(o, file);
    o->panel->setup->session.protocol = file;
    end = end ? end : prepare(o, false);
    for (size_t i = 0; i < o->plan->n && end == GOES_ON; i++)
        end = session_check_run(s, &o->plan->run[i]);
    for (size_t i = 0; i < o->plan->n && end == GOES_ON; i++)
        end = session_run(s, i);
    if (end == GOES_ON && s->lossy == 0)
        panel_say(o->panel, false, o->plan->n > 1 ? "%zu runs are done" : "the run is done", o->plan->n);
    return end;
}

static outcome execute(owner *o, const panel_command *c) {
    outcome end = c->what == PANEL_CLEAR ? GOES_ON : configure(o);
    if (end)
        return end;
    switch (c->what) {
    case PANEL_PREPARE:
        return prepare(o, true);
    case PANEL_HOME:
        return session_home(o->session);
    case PANEL_TARE:
        return tare(o);
    case PANEL_CONTACT:
        return find_contact(o);
    case PANEL_HOLD:
        return jog(o, 0, 1);
    case PANEL_RELEASE:
        return release(o);
    case PANEL_JOG:
        return jog(o, c->by_mm, c->rate_mm_s);
    case PANEL_CLEAR:
        return clear(o);
    case PANEL_START:
        return start(o, c->file);
    case PANEL_NOTHING:
        break;
    }
    return GOES_ON;
}

/* A fault between commands is reported once. */
static void conclude(owner *o, outcome end, bool asked) {
    session *s = o->session;
    char words[ACQUIRE_WORDS];
    session_words(s, end, words);
    const uint32_t tick = s->device.status.fault_tick;
    bool told = !asked && (end == GONE ? o->gone : end == FAULTED && o->faulted && o->faulted_tick == tick);
    o->faulted = end == FAULTED;
    o->faulted_tick = tick;
    o->gone = o->gone || end == GONE;
    if (end == FAILED_SAID)
        snprintf(words, sizeof words, "%.200s failed; the terminal says why", s->doing);
    if (words[0] && !told) {
        panel_say(o->panel, end != STOPPED, "%s", words);
        cli_failure(NAME, "%s", words);
    }
}

static void begin(owner *o) {
    session *s = o->session;
    s->stopping = s->file.started = false;
    s->stops_seen = 0;
    s->why[0] = '\0';
    s->faulted_s = -1;
    s->lossy = 0;
}

static void do_command(owner *o, const panel_command *c) {
    session *s = o->session;
    begin(o);
    outcome end = o->gone ? session_fail(s, "the indenter is not connected") : execute(o, c);
    conclude(o, o->gone ? end : session_withdraw(s, end), true);
    s->doing[0] = '\0';
    panel_done(o->panel);
}

/* Tries whether the cable is back. A device that has restarted must be configured again. */
static void come_back(owner *o) {
    session *s = o->session;
    const uint32_t tick = s->tick;
    if (!session_reopen(s))
        return;
    o->gone = o->configured = false;
    o->tared = o->tared && s->device.status.tick - tick <= INT32_MAX;
    panel_say(o->panel, false, "connected again");
    conclude(o, configure(o), false);
}

static void idle(owner *o) {
    begin(o);
    outcome end = o->gone ? GONE : session_listen(o->session);
    if (end == FAULTED || end == GONE)
        conclude(o, end, false);
    else
        o->faulted = false;
    panel_view v = view_of(o);
    panel_see(o->panel, &v);
    if (o->gone) {
        nanosleep(&(struct timespec){.tv_nsec = 100000000L}, NULL);
        come_back(o);
    }
}

static int run(owner *o) {
    session *s = o->session;
    panel_command command;
    begin(o);
    outcome end = session_end_last(s);
    conclude(o, end ? end : configure(o), false);
    s->doing[0] = '\0';
    while (session_stops() == 0)
        if (panel_take(o->panel, &command))
            do_command(o, &command);
        else
            idle(o);
    if (o->gone)
        return CLI_FAILURE;
    end = session_withdraw(s, STOPPED);
    session_stream(s, false);
    return CLI_OK;
}

int panel_own(panel *p, session *s) {
    acquire_plan *plan = calloc(1, sizeof *plan);
    owner o = {.panel = p, .session = s, .plan = plan};
    if (!plan)
        return cli_failure(NAME, "out of memory");
    s->plan = plan;
    s->watcher = (session_watcher){heard, stops, told, &o};
    int code = run(&o);
    s->watcher = (session_watcher){NULL, NULL, NULL, NULL};
    free(plan);
    return code;
}
