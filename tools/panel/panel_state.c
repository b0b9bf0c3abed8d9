/* panel_state.c: the data shared between the thread that owns the indenter and the threads of the requests.
 */
#define _POSIX_C_SOURCE 200809L
#include "panel.h"
#include "shared/json_out.h"

#include <stdarg.h>
#include <string.h>
#include <time.h>

enum { HALT_TRIES = 60, HALT_WAIT_MS = 50 };

bool panel_ask(panel *p, const panel_command *command) {
    pthread_mutex_lock(&p->lock);
    bool free = !p->waiting && !p->busy;
    if (free) {
        p->command = *command;
        p->waiting = true;
        p->stop = false;
    }
    pthread_mutex_unlock(&p->lock);
    return free;
}

void panel_stop(panel *p) {
    pthread_mutex_lock(&p->lock);
    p->waiting = false;
    p->stop = p->busy;
    pthread_mutex_unlock(&p->lock);
}

bool panel_take(panel *p, panel_command *command) {
    pthread_mutex_lock(&p->lock);
    bool taken = p->waiting;
    if (taken) {
        *command = p->command;
        p->waiting = false;
        p->busy = true;
    }
    pthread_mutex_unlock(&p->lock);
    return taken;
}

void panel_done(panel *p) {
    pthread_mutex_lock(&p->lock);
    p->busy = p->stop = false;
    pthread_mutex_unlock(&p->lock);
}

bool panel_is_to_stop(panel *p) {
    pthread_mutex_lock(&p->lock);
    bool stop = p->stop;
    pthread_mutex_unlock(&p->lock);
    return stop;
}

static bool has_stopped(panel *p) {
    pthread_mutex_lock(&p->lock);
    bool stopped = p->view.state == PALP_WIRE_STATE_FAULT;
    p->waiting = false;
    p->stop = p->busy;
    pthread_mutex_unlock(&p->lock);
    return stopped;
}

/* A frame may be damaged on its way, so HALT is sent until the device reports that it stopped. */
bool panel_emergency(panel *p) {
    const struct timespec wait = {.tv_nsec = 1000000L * HALT_WAIT_MS};
    bool stopped = false;
    for (int i = 0; i < HALT_TRIES && !stopped; i++) {
        device_halt(p->device);
        nanosleep(&wait, NULL);
        stopped = has_stopped(p);
    }
    return stopped;
}

void panel_say(panel *p, bool bad, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    pthread_mutex_lock(&p->lock);
    panel_note *n = &p->note[p->notes++ % PANEL_NOTES];
    vsnprintf(n->text, sizeof n->text, format, arguments);
    n->bad = bad;
    pthread_mutex_unlock(&p->lock);
    va_end(arguments);
}

void panel_see(panel *p, const panel_view *view) {
    pthread_mutex_lock(&p->lock);
    p->view = *view;
    pthread_mutex_unlock(&p->lock);
}

void panel_add(panel *p, const panel_point *point, const panel_view *view) {
    pthread_mutex_lock(&p->lock);
    p->point[p->points++ % PANEL_POINTS] = *point;
    p->view = *view;
    pthread_mutex_unlock(&p->lock);
}

/* What to do about a fault. */
static const char *advise(uint8_t fault) {
    static const char *const advice[PALP_WIRE_FAULT_COUNT] = {
        [PALP_WIRE_FAULT_NONE] = "",
        [PALP_WIRE_FAULT_OVER_FORCE] =
            "Press less deep or more slowly, or raise --limit-force-N if the sensor bears it.",
        [PALP_WIRE_FAULT_OVER_TRAVEL] = "Clear the fault, then home the plate.",
        [PALP_WIRE_FAULT_OVER_TEMPERATURE] = "Let the motor cool down; then clear the fault.",
        [PALP_WIRE_FAULT_FOLLOWING_ERROR] = "See whether something blocks the plate; then clear the fault.",
        [PALP_WIRE_FAULT_SENSOR_SILENT] = "See to the force sensor's cable and supply; then clear the fault.",
        [PALP_WIRE_FAULT_SENSOR_SATURATED] = "Take the load off the sensor; if it stays, see to its cable.",
        [PALP_WIRE_FAULT_ENCODER_JUMP] =
            "See to the encoder's cable; then clear the fault and home the plate.",
        [PALP_WIRE_FAULT_HOST_TIMEOUT] =
            "This computer was silent for too long. Clear the fault and start again.",
        [PALP_WIRE_FAULT_STREAM_OVERFLOW] =
            "This computer was too slow for the samples. Close other programs, then clear the fault.",
        [PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE] =
            "The stimulus leaves the travel, or a force its deepest place. Clear the fault; press less deep.",
        [PALP_WIRE_FAULT_WATCHDOG_RESET] =
            "The firmware restarted. Clear the fault and home the plate; please report it.",
        [PALP_WIRE_FAULT_STACK_GUARD] =
            "The firmware restarted. Clear the fault and home the plate; please report it.",
        [PALP_WIRE_FAULT_EMERGENCY_STOP] =
            "Release the switch if it is pressed. When all is safe, clear the fault.",
        [PALP_WIRE_FAULT_ENCODER_LOST] =
            "See to the encoder's cable; then clear the fault and home the plate.",
        [PALP_WIRE_FAULT_DRIVER_FAULT] =
            "The motor's driver is too hot or short-circuited. See to it, then clear the fault.",
        [PALP_WIRE_FAULT_BROWN_OUT] =
            "See to the processor's supply; then clear the fault and home the plate.",
        [PALP_WIRE_FAULT_CONTACT_LOST] =
            "See whether the specimen still lies under the plate. Clear the fault, then find contact again.",
        [PALP_WIRE_FAULT_FORCE_OSCILLATES] =
            "See whether something shakes the specimen. Clear the fault, then find contact again.",
    };
    return fault < PALP_WIRE_FAULT_COUNT && advice[fault] ? advice[fault] : "";
}

/* ---- as JSON, under the lock ---- */

static json_t *state_json(const panel *p) {
    const panel_view *v = &p->view;
    const palp_wire_status *now = &v->status;
    const double count_mm = v->info.count_pm / 1e9;
    json_t *run = json_pack("{ss sI sI so so sI sI}", "name", v->run, "number", (json_int_t)v->number, "of",
                            (json_int_t)v->of, "elapsed_s", json_number_or_null(v->elapsed_s), "length_s",
                            json_number_or_null(v->length_s), "samples", (json_int_t)v->samples, "lost",
                            (json_int_t)v->lost);
    char calibration[40] = "", date[16];
    device_date(v->calibration_day, date);
    if (v->calibration)
        snprintf(calibration, sizeof calibration, "%08x%s%s", (unsigned)v->calibration,
                 *date ? " of " : ", never measured", date);
    return json_pack(
        "{ss ss ss ss ss sb sb sb sb sb sb so so so so so so sf sf so sI so}", "calibration", calibration,
        "state", v->gone ? "gone" : palp_wire_state_name(v->state), "fault", palp_wire_fault_name(now->fault),
        "fault_text", palp_wire_fault_text(now->fault), "advice", advise(now->fault), "homed", now->homed,
        "contact_known", now->contact_known, "busy", p->busy || p->waiting, "stopping", p->stop, "recording",
        v->recording, "gone", v->gone, "doing", json_string(v->doing), "contact_mm",
        now->contact_known ? json_number_or_null(count_mm * now->contact) : json_null(), "place_mm",
        json_number_or_null(v->place_mm), "stiffness_N_m",
        now->contact_known ? json_number_or_null(1e-3 * now->stiffness_mN_m) : json_null(), "case_C",
        json_number_or_null(v->case_C), "winding_C", json_number_or_null(1e-2 * now->winding_cC), "travel_mm",
        1e-6 * v->info.travel_nm, "limit_N", 1e-6 * v->limits.force_uN, "limit_C",
        json_number_or_null(1e-2 * v->limits.temperature_cC), "runs", (json_int_t)v->runs, "run",
        v->recording ? run : (json_decref(run), json_null()));
}

/* The points after the number that a page has, thinned where there are many. */
static json_t *points_json(const panel *p, size_t since) {
    static const char *const names[] = {"time_s", "place_mm", "depth_mm", "force_N", "error_mm", "run"};
    json_t *list[6], *to = json_pack("{sI}", "next", (json_int_t)p->points);
    size_t first = p->points > PANEL_POINTS ? p->points - PANEL_POINTS : 0;
    first = since > first && since <= p->points ? since : first;
    const size_t step = (p->points - first) / PANEL_SHOWN + 1;
    for (size_t k = 0; k < 6; k++) {
        list[k] = json_array();
        json_object_set_new(to, names[k], list[k]);
    }
    for (size_t i = first; i < p->points; i += step) {
        const panel_point *x = &p->point[i % PANEL_POINTS];
        const double value[] = {x->time_s, x->place_mm, x->depth_mm, x->force_N, x->error_mm, x->run};
        for (size_t k = 0; k < 6; k++)
            json_array_append_new(list[k], json_number_or_null(value[k]));
    }
    return to;
}

static json_t *notes_json(const panel *p, size_t since) {
    json_t *list = json_array();
    size_t first = p->notes > PANEL_NOTES ? p->notes - PANEL_NOTES : 0;
    for (size_t i = since > first && since <= p->notes ? since : first; i < p->notes; i++) {
        const panel_note *n = &p->note[i % PANEL_NOTES];
        json_array_append_new(list, json_pack("{ss sb}", "text", n->text, "bad", n->bad));
    }
    return json_pack("{sI so}", "next", (json_int_t)p->notes, "list", list);
}

static json_t *job_json(const panel *p) {
    static const char *const names[] = {"fit", "explain", "report"};
    const panel_job *j = &p->job;
    return json_pack("{ss sb sb sI}", "what", names[j->what], "running", j->running, "good",
                     j->good && !j->cancelled, "done", (json_int_t)j->done);
}

json_t *panel_live(panel *p, size_t point, size_t note) {
    pthread_mutex_lock(&p->lock);
    json_t *to = json_pack("{so so so so}", "state", state_json(p), "points", points_json(p, point), "notes",
                           notes_json(p, note), "job", job_json(p));
    pthread_mutex_unlock(&p->lock);
    return to;
}
