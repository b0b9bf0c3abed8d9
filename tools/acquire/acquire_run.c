/* acquire_run.c: a session with the device: run after run, and how it ends. */
#include "acquire_session.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "acquire";

static const double TRIGGER_S = 1e6; /* the time of a trigger is unknown; Ctrl-C ends the wait */

/* Warns if the force of this run rises at another depth than the contact found before the first run. */
static void check_contact(const session *s) {
    const double early_mm = -0.1, late_mm = 0.25;
    double at_mm = s->file.figures.contact_mm;
    if (s->run->kind == ACQUIRE_FREE || isnan(at_mm) || (at_mm > early_mm && at_mm < late_mm))
        return;
    session_tell(s, true, "%s: contact at %.2f mm: the specimen %s", s->file.path, at_mm,
                 at_mm > 0 ? "has not recovered (raise --rest-s), or has moved"
                           : "has risen or moved; let it recover and start again");
}

static void say_run(const session *s) {
    const acquire_figures *g = &s->file.figures;
    char missing[80] = "";
    if (g->lost + g->bad > 0)
        snprintf(missing, sizeof missing, ", %zu lost, %zu without a reading", g->lost, g->bad);
    session_tell(s, false, "%s: %zu samples, %.4g mm, %.4g N, error %.2g mm rms%s", s->file.path, g->samples,
                 g->deepest_mm, g->peak_N, g->errors ? sqrt(g->error_square / (double)g->errors) : 0.0,
                 missing);
}

/* The device refuses speeds at which the force may grow to twice its limit before the motor is off. */
static outcome out_of_range(session *s) {
    static const double BLIND_S = 2e-3; /* until the motor is off */
    const double k = 1e-3 * s->device.status.stiffness_mN_m, force_N = 1e-6 * s->limits.force_uN;
    const double moving_kg = device_parameter_value(&s->calibration, "moving_kg", 0);
    char speed[80] = "";
    if (k > 0 && moving_kg > 0)
        snprintf(speed, sizeof speed, "faster than %.3g mm/s into a stiffness of %.4g N/m, ",
                 1e3 * force_N / (sqrt(k * moving_kg) + BLIND_S * k), k);
    return session_fail(s, "the device refuses %s: it may move %sexceed %g N, or leave its travel of %g mm",
                        s->run->name, speed, force_N, 1e-6 * s->limits.travel_nm);
}

static outcome start_run(session *s) {
    const acquire_motion *a = &s->run->motion;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_START};
    m.as.start.segments = (uint8_t)s->run->n_segments;
    m.as.start.start_nm = (int32_t)lrint(1e6 * s->run->start_mm);
    m.as.start.air_ms = (uint32_t)lrint(1e3 * a->air_s);
    m.as.start.after_ms = (uint32_t)lrint(1e3 * a->after_s);
    outcome end = session_segments(s, s->run);
    end = end ? end : session_order(s, &m, "start the run");
    if (end == FAILED && s->device.refusal == PALP_WIRE_RESULT_UNSTABLE)
        return session_fail(
            s,
            "the device refuses %s: force control is not stable at the measured stiffness of %.3g N/m "
            "(see doc/control.md for the range)",
            s->run->name, 1e-3 * s->device.status.stiffness_mN_m);
    return end == FAILED && s->device.refusal == PALP_WIRE_RESULT_RANGE ? out_of_range(s) : end;
}

/* Rests with samples off, unless somebody watches. */
static outcome rest(session *s) {
    outcome end = GOES_ON;
    if (s->run->motion.rest_s > 0) { /* not NAN */
        snprintf(s->doing, sizeof s->doing, "resting before run %zu of %zu", s->number, s->plan->n);
        bool watched = s->watcher.heard != NULL;
        end = watched ? GOES_ON : session_stream(s, false);
        end = end ? end : session_wait(s, s->run->motion.rest_s);
        end = end || watched ? end : session_stream(s, true);
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
        acquire_file_open(&s->file, path, s->options->force, s->options->columns, &s->scale, s->tick, header);
    json_decref(header);
    if (code)
        return FAILED_SAID;
    acquire_live_begin(&s->live, s->run->kind == ACQUIRE_STATIC || s->run->kind == ACQUIRE_CYCLIC);
    end = start_run(s);
    const double wait_s = s->options->trigger_in == PALP_WIRE_TRIGGER_STARTS ? TRIGGER_S : 60;
    end = end ? end : session_settle(s, acquire_run_length_s(s->run) + wait_s);
    bool lost = end == GOES_ON && s->state != PALP_WIRE_STATE_READY;
    return lost ? session_fail(s, "the device has restarted, %s", s->doing) : end;
}

/* Notes a run with too many lost samples; the session continues, but its exit code reports it. */
static void note_loss(session *s) {
    const acquire_figures *g = &s->file.figures;
    const size_t missing = g->lost + g->bad, all = g->samples + missing;
    if (s->lossy++ == 0)
        snprintf(s->why, sizeof s->why, "%.300s lacks %zu of %zu samples (%.0f %%): record it again",
                 s->file.path, missing, all, 100.0 * (double)missing / (double)all);
}

/* Closes the recording; a run without samples leaves no file. */
static outcome end_run(session *s, outcome end, const char *cause) {
    if (s->file.fd < 0)
        return end;
    if (!s->file.started) {
        acquire_file_remove(&s->file);
        return end ? end : session_fail(s, "no samples arrived, %s", s->doing);
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

/* Withdraws the plate in any state; samples until then are recorded. */
outcome session_withdraw(session *s, outcome end) {
    if (end == GONE || end == FAULTED || !session_moving(s))
        return end;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STOP};
    s->stopping = true;
    s->stops_seen = session_stops();
    outcome last = session_order(s, &m, "stop");
    last = last ? last : session_settle(s, 30);
    return last == FAULTED ? last : end;
}

static void fault_words(const session *s, char words[ACQUIRE_WORDS]) {
    const palp_wire_status *now = &s->device.status;
    char when[ACQUIRE_TEXT], hint[ACQUIRE_TEXT] = "";
    int n = snprintf(when, sizeof when, "%s", s->doing);
    if (s->faulted_s >= 0)
        snprintf(when + n, sizeof when - (size_t)n, " at %.3f s; %.300s has the samples before it",
                 s->faulted_s, s->file.path);
    if (strncmp(s->options->port, "rig", 3) != 0 && !s->watcher.stops)
        snprintf(hint, sizeof hint, "; remove the cause, then run palpate firmware clear-fault --port %.200s",
                 s->options->port);
    snprintf(words, ACQUIRE_WORDS, "the device stopped: %s (%s), %s%s", palp_wire_fault_name(now->fault),
             palp_wire_fault_text(now->fault), when, hint);
}

int session_words(const session *s, outcome end, char words[ACQUIRE_WORDS]) {
    const char *kept = s->file.started ? s->file.path : NULL,
               *are = kept ? "; the samples so far are in " : "";
    const char *why = end == STOPPED ? "stopped" : s->why, *path = kept ? kept : "";
    words[0] = '\0';
    switch (end) {
    case GOES_ON:
        if (s->lossy > 1)
            snprintf(words, ACQUIRE_WORDS, "%s; and %zu more like it", s->why, s->lossy - 1);
        else if (s->lossy == 1)
            snprintf(words, ACQUIRE_WORDS, "%s", s->why);
        return s->lossy ? CLI_FAILURE : CLI_OK;
    case FAULTED:
        fault_words(s, words);
        return CLI_DEVICE_FAULT;
    case STOPPED:
    case GONE:
        snprintf(words, ACQUIRE_WORDS, "%s, %s%s%s", why, s->doing, are, path);
        break;
    case FAILED:
        snprintf(words, ACQUIRE_WORDS, "%s", why);
        break;
    case FAILED_SAID:
        break;
    }
    return CLI_FAILURE;
}

static const char *session_cause(const session *s, outcome end) {
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

outcome session_run(session *s, size_t i) {
    outcome end = one_run(s, i);
    end = session_withdraw(s, end);
    return end_run(s, end, session_cause(s, end));
}

static outcome run_all(session *s) {
    outcome end = session_make_ready(s);
    for (size_t i = 0; i < s->plan->n && end == GOES_ON; i++)
        end = session_run(s, i);
    return session_withdraw(s, end);
}

int acquire_session(const acquire_options *options, const acquire_plan *plan, json_t **summary) {
    char words[ACQUIRE_WORDS];
    session *s = session_open(options, plan);
    if (!s)
        return CLI_FAILURE;
    s->reconnect = options->reconnect_s > 0 ? session_reconnect : NULL;
    outcome end = run_all(s);
    acquire_live_end(&s->live);
    int code = session_words(s, end, words);
    if (words[0])
        cli_failure(NAME, "%s", words);
    if (summary)
        *summary = session_summary(s, session_cause(s, end));
    if (end != GONE)
        session_stream(s, false);
    session_close(s);
    return code;
}
