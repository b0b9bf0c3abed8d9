/* acquire_run.c: a session with the device: home, tare, contact, then run after run. */
#include "acquire_session.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "acquire";

enum { AXIS_Z = 2, TARE_TICKS = 1000 };

static const double SEEK_MM_S = 0.5;

/* ---- making ready ---- */

static outcome set_limits(session *s) {
    const acquire_options *o = s->options;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_LIMITS};
    palp_wire_limits *limits = &m.as.limits;
    /* a simulated device may run many times faster than the clock by which we tell it that we are there */
    double host_s = o->host_timeout_s > 0 ? o->host_timeout_s : s->device.info.simulated ? 60 : 0;
    limits->force_uN = (int32_t)lrint(1e6 * o->limit_N);
    limits->temperature_cC = (int16_t)lrint(1e2 * o->limit_C);
    limits->host_timeout_ms = (uint16_t)lrint(1e3 * host_s);
    outcome end = session_order(s, &m, "set its limits");
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_LIMITS}, got = {0};
    end = end ? end : session_ask(s, &ask, &got);
    s->limits = got.as.limits_now;
    return end;
}

static outcome set_calibration(session *s) {
    outcome end = GOES_ON;
    for (uint8_t axis = 0; axis < PALP_WIRE_CHANNELS && end == GOES_ON; axis++) {
        palp_wire_message m = {.type = PALP_WIRE_TYPE_SET_CALIBRATION, .as.set_calibration = {.axis = axis}};
        memcpy(m.as.set_calibration.row, s->options->row[axis], sizeof s->options->row[axis]);
        end = s->options->calibration[axis] ? session_order(s, &m, "take the sensor's calibration") : GOES_ON;
    }
    return end;
}

static outcome configure(session *s) {
    palp_wire_message gains = {.type = PALP_WIRE_TYPE_SELECT_GAINS,
                               .as.select_gains = {.softness = (uint8_t)s->options->gains}};
    outcome end = session_stream(s, true);
    end = end ? end : set_limits(s);
    end = end ? end : set_calibration(s);
    return end ? end : session_order(s, &gains, "take the gains");
}

static outcome home(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_HOME};
    snprintf(s->doing, sizeof s->doing, "homing");
    outcome end = session_order(s, &m, "home");
    end = end ? end : session_settle(s, 60);
    return end || s->device.status.homed ? end : session_fail(s, "the plate has not come home");
}

/* In the air; then the conversion of counts is known but for contact. */
static outcome tare(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = TARE_TICKS}}, got = {0};
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_CALIBRATION, .as.get_calibration = {.axis = AXIS_Z}};
    snprintf(s->doing, sizeof s->doing, "taring");
    outcome end = session_order(s, &m, "tare");
    end = end ? end : session_wait(s, TARE_TICKS * s->scale.tick_s + 0.1);
    end = end ? end : session_ask(s, &ask, &got);
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++) {
        s->scale.row_N[c] = 1e-9 * got.as.calibration.row[c];
        s->scale.tare[c] = got.as.calibration.tare[c] / 16.0;
    }
    return end;
}

static outcome find_contact(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_FIND_CONTACT};
    double travel_mm = 1e-6 * s->device.info.travel_nm;
    m.as.find_contact.rate_nm_s = (uint32_t)lrint(1e6 * SEEK_MM_S);
    m.as.find_contact.force_uN = (int32_t)lrint(1e6 * s->options->contact_N);
    m.as.find_contact.travel_nm = s->device.info.travel_nm;
    snprintf(s->doing, sizeof s->doing, "finding contact");
    outcome end = session_order(s, &m, "find contact");
    end = end ? end : session_settle(s, travel_mm / SEEK_MM_S + 60);
    if (end == GOES_ON && !s->device.status.contact_known)
        end = session_fail(s, "no contact in %g mm of travel: is a specimen under the plate?", travel_mm);
    return end;
}

/* What the device would refuse, or stop for, an hour later. */
static outcome check_run(session *s, const acquire_run *r) {
    double above_mm = s->scale.count_mm * s->scale.contact,
           below_mm = 1e-6 * s->device.info.travel_nm - above_mm;
    outcome end = session_segments(s, r);
    if (end == GOES_ON && r->deepest_mm > below_mm)
        end = session_fail(s, "%s goes to %g mm, but the plate's travel ends %.2f mm below contact", r->name,
                           r->deepest_mm, below_mm);
    else if (end == GOES_ON && r->highest_mm < -above_mm)
        end = session_fail(s, "%s begins %g mm above contact, but home is only %.2f mm above it", r->name,
                           -r->highest_mm, above_mm);
    return end;
}

static void say_contact(session *s) {
    const palp_wire_status *now = &s->device.status;
    acquire_live_end(&s->live);
    fprintf(stderr, "palpate %s: contact %.3f mm below home, %.4g N/m, gains of class %u\n", NAME,
            s->scale.count_mm * s->scale.contact, 1e-3 * now->stiffness_mN_m, (unsigned)now->softness);
}

/* A session that was cut off may have left it in the middle of a run. */
static outcome end_last_session(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STOP};
    outcome end = session_status(s);
    if (end || !session_moving(s))
        return end;
    cli_warning(NAME, "the device was still moving for a session that has gone: it withdraws first");
    end = session_order(s, &m, "stop");
    return end ? end : session_settle(s, 30);
}

static outcome make_ready(session *s) {
    bool keep = s->options->keep_contact;
    outcome end = end_last_session(s);
    end = end ? end : configure(s);
    if (end == GOES_ON && keep && !s->device.status.contact_known)
        end = session_fail(s, "the device knows no contact to keep: leave out --keep-contact");
    end = end || keep ? end : home(s);
    end = end ? end : tare(s);
    end = end || keep ? end : find_contact(s);
    end = end ? end : session_status(s);
    if (end)
        return end;
    s->scale.contact = s->device.status.contact;
    say_contact(s);
    for (size_t i = 0; i < s->plan->n && end == GOES_ON; i++)
        end = check_run(s, &s->plan->run[i]);
    return end;
}

/* ---- one run ---- */

/* Where this run's force rose, against the contact that was found at first. */
static void check_contact(const session *s) {
    const double early_mm = -0.1, late_mm = 0.25;
    double at_mm = s->file.figures.contact_mm;
    if (s->run->kind == ACQUIRE_FREE || isnan(at_mm) || (at_mm > early_mm && at_mm < late_mm))
        return;
    cli_warning(NAME, "%s: contact at %.2f mm: the specimen %s", s->file.path, at_mm,
                at_mm > 0 ? "has not recovered (raise --rest-s), or has moved"
                          : "has risen or moved; let it settle and start again");
}

static void say_run(const session *s) {
    const acquire_figures *g = &s->file.figures;
    fprintf(stderr, "palpate %s: %s: %zu samples, %.4g mm, %.4g N, error %.2g mm rms", NAME, s->file.path,
            g->samples, g->deepest_mm, g->peak_N,
            g->errors ? sqrt(g->error_square / (double)g->errors) : 0.0);
    if (g->lost + g->bad > 0)
        fprintf(stderr, ", %zu lost, %zu without a reading", g->lost, g->bad);
    fputc('\n', stderr);
}

static outcome start_run(session *s) {
    const acquire_motion *a = &s->run->motion;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_START};
    m.as.start.segments = (uint8_t)s->run->n_segments;
    m.as.start.start_nm = (int32_t)lrint(1e6 * s->run->start_mm);
    m.as.start.air_ms = (uint32_t)lrint(1e3 * a->air_s);
    m.as.start.after_ms = (uint32_t)lrint(1e3 * a->after_s);
    outcome end = session_segments(s, s->run);
    return end ? end : session_order(s, &m, "start the run");
}

/* Without samples, which nobody would keep. */
static outcome rest(session *s) {
    outcome end = GOES_ON;
    if (s->run->motion.rest_s > 0) { /* not NAN */
        snprintf(s->doing, sizeof s->doing, "resting before run %zu of %zu", s->number, s->plan->n);
        end = session_stream(s, false);
        end = end ? end : session_wait(s, s->run->motion.rest_s);
        end = end ? end : session_stream(s, true);
    }
    return end;
}

static outcome one_run(session *s, size_t i) {
    char path[CLI_PATH_MAX];
    s->run = &s->plan->run[i];
    s->number = i + 1;
    s->file.started = false;
    outcome end = rest(s);
    snprintf(s->doing, sizeof s->doing, "run %zu of %zu", s->number, s->plan->n);
    end = end ? end : session_status(s);
    if (end)
        return end;
    snprintf(path, sizeof path, "%.*s/%s.csv", (int)sizeof path - ACQUIRE_NAME - 8, s->options->out,
             s->run->name);
    json_t *header = session_header(s);
    int code =
        acquire_file_open(&s->file, path, s->options->force, s->options->raw, &s->scale, s->tick, header);
    json_decref(header);
    if (code)
        return FAILED_SAID;
    acquire_live_begin(&s->live, s->run->kind == ACQUIRE_STATIC || s->run->kind == ACQUIRE_CYCLIC);
    end = start_run(s);
    end = end ? end : session_settle(s, acquire_run_length_s(s->run) + 60);
    bool lost = end == GOES_ON && s->state != PALP_WIRE_STATE_READY;
    return lost ? session_fail(s, "the device has restarted, %s", s->doing) : end;
}

/* The session goes on, since the specimen is there; its exit code says it. */
static void note_loss(session *s) {
    const acquire_figures *g = &s->file.figures;
    const size_t missing = g->lost + g->bad, all = g->samples + missing;
    if (s->lossy++ == 0)
        snprintf(s->why, sizeof s->why, "%.300s lacks %zu of %zu samples (%.0f %%): record it again", s->file.path,
                 missing, all, 100.0 * (double)missing / (double)all);
}

/* Closes what the run has recorded; a run of which nothing came leaves no file. */
static outcome end_run(session *s, outcome end, const char *cause) {
    if (s->file.fd < 0)
        return end;
    if (!s->file.started) {
        acquire_file_remove(&s->file);
        return end ? end : session_fail(s, "no samples came, %s", s->doing);
    }
    acquire_live_end(&s->live);
    if (end == GOES_ON && acquire_file_lossy(&s->file.figures)) {
        cause = "samples_lost";
        note_loss(s);
    }
    double winding_C = end == GONE ? NAN : 1e-2 * s->device.status.winding_cC;
    if (acquire_file_close(&s->file, cause, winding_C) != CLI_OK)
        end = end == GOES_ON || end == FAILED ? FAILED_SAID : end;
    session_note_run(s, cause);
    if (end == GOES_ON) {
        say_run(s);
        check_contact(s);
    }
    return end;
}

/* ---- the end ---- */

/* The plate off the specimen, whatever it was doing; what comes meanwhile is still recorded. */
static outcome withdraw(session *s, outcome end) {
    if (end == GONE || end == FAULTED || !session_moving(s))
        return end;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STOP};
    s->stopping = true;
    s->stops_seen = session_stops();
    outcome last = session_order(s, &m, "stop");
    last = last ? last : session_settle(s, 30);
    return last == FAULTED ? last : end;
}

static int say_fault(const session *s) {
    const palp_wire_status *now = &s->device.status;
    char when[ACQUIRE_TEXT], hint[ACQUIRE_TEXT] = "";
    int n = snprintf(when, sizeof when, "%s", s->doing);
    if (s->faulted_s >= 0)
        snprintf(when + n, sizeof when - (size_t)n, " at %.3f s; %.300s holds what came before", s->faulted_s,
                 s->file.path);
    if (strncmp(s->options->port, "rig", 3) != 0)
        snprintf(hint, sizeof hint, "; see to it, then palpate firmware clear-fault --port %.200s",
                 s->options->port);
    cli_failure(NAME, "the device stopped: %s (%s), %s%s", palp_wire_fault_name(now->fault),
                palp_wire_fault_text(now->fault), when, hint);
    return CLI_DEVICE_FAULT;
}

static int conclude(session *s, outcome end) {
    const char *kept = s->file.started ? s->file.path : NULL;
    switch (end) {
    case GOES_ON:
        return s->lossy == 0  ? CLI_OK
               : s->lossy > 1 ? cli_failure(NAME, "%s; and %zu more like it", s->why, s->lossy - 1)
                              : cli_failure(NAME, "%s", s->why);
    case FAULTED:
        return say_fault(s);
    case STOPPED:
        return cli_failure(NAME, "stopped, %s%s%s", s->doing, kept ? "; what came is in " : "",
                           kept ? kept : "");
    case GONE:
        return cli_failure(NAME, "%s, %s%s%s", s->why, s->doing, kept ? "; what came is in " : "",
                           kept ? kept : "");
    case FAILED:
        return cli_failure(NAME, "%s", s->why);
    case FAILED_SAID:
        break;
    }
    return CLI_FAILURE;
}

static const char *cause_of(const session *s, outcome end) {
    switch (end) {
    case GOES_ON:
        return NULL;
    case FAULTED:
        return palp_wire_fault_name(s->device.status.fault);
    case STOPPED:
        return "stopped";
    case GONE:
        return "disconnected";
    default:
        return "failed";
    }
}

static outcome run_all(session *s) {
    outcome end = make_ready(s);
    for (size_t i = 0; i < s->plan->n && end == GOES_ON; i++) {
        end = one_run(s, i);
        end = withdraw(s, end);
        end = end_run(s, end, cause_of(s, end));
    }
    return withdraw(s, end);
}

int acquire_session(const acquire_options *options, const acquire_plan *plan, json_t **summary) {
    session *s = session_open(options, plan);
    if (!s)
        return CLI_FAILURE;
    outcome end = run_all(s);
    acquire_live_end(&s->live);
    int code = conclude(s, end);
    if (summary)
        *summary = session_summary(s, cause_of(s, end));
    if (end != GONE)
        session_stream(s, false);
    session_close(s);
    return code;
}
