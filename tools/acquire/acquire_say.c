/* acquire_say.c: the texts of a session: a recording's header, the summary, the line on the terminal. */
#define _POSIX_C_SOURCE 200809L
#include "acquire_session.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdarg.h>
#include <palpate/version.h>
#include <string.h>
#include <time.h>

/* Keys with a zero, NAN or NULL are left out. */
static void number(json_t *to, const char *key, double value) {
    if (isfinite(value)) {
        bool whole = value == rint(value) && fabs(value) < 1e15;
        json_object_set_new(to, key, whole ? json_integer((json_int_t)value) : json_real(value));
    }
}

static void positive(json_t *to, const char *key, double value) {
    number(to, key, value > 0 ? value : NAN);
}

static void string(json_t *to, const char *key, const char *value) {
    if (value)
        json_object_set_new(to, key, json_text(value));
}

static void list(json_t *to, const char *key, const double value[PALP_WIRE_CHANNELS]) {
    json_object_set_new(to, key, json_numbers(PALP_WIRE_CHANNELS, value));
}

static void specimen(const session *s, json_t *to) {
    const acquire_options *o = s->options;
    bool air = s->run->kind == ACQUIRE_FREE;
    string(to, "specimen.name", o->specimen);
    string(to, "specimen.kind", air ? "none" : o->specimen_kind);
    positive(to, "specimen.height_mm", air ? 0 : o->height_mm);
    positive(to, "specimen.radius_mm", air ? 0 : o->radius_mm);
}

static void protocol(const session *s, json_t *to) {
    const acquire_run *r = s->run;
    string(to, "protocol.kind", acquire_kind_name(r->kind));
#define ACQUIRE_SAY(name, mask, zero, most) number(to, "protocol." #name, r->motion.name);
    ACQUIRE_FIGURES(ACQUIRE_SAY)
#undef ACQUIRE_SAY
    number(to, "protocol.order", (double)s->number);
    number(to, "protocol.runs", (double)s->plan->n);
    number(to, "protocol.repeat", r->repeat);
    if (s->plan->random == 1)
        number(to, "protocol.order_seed", s->plan->seed);
    string(to, "protocol.file", s->options->protocol);
}

static json_t *device_is(const session *s) {
    const palp_wire_info *info = &s->device.info;
    char version[16], board[PALP_WIRE_NAME + 1] = "";
    snprintf(version, sizeof version, "%u.%u.%u", (unsigned)info->major, (unsigned)info->minor,
             (unsigned)info->patch);
    memcpy(board, info->board, PALP_WIRE_NAME);
    return json_pack("{so so ss sI sb}", "port", json_text(s->options->port), "board", json_text(board),
                     "firmware", version, "serial", (json_int_t)info->serial, "simulated", info->simulated);
}

static void device_keys(const session *s, json_t *to) {
    json_t *is = device_is(s), *value;
    const char *key;
    json_object_foreach(is, key, value) {
        char full[32];
        snprintf(full, sizeof full, "device.%.16s", key);
        json_object_set(to, full, value);
    }
    json_decref(is);
}

static void clock_time(json_t *to, const char *key, time_t clock) {
    char text[32];
    struct tm utc;
    if (gmtime_r(&clock, &utc) && strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc) > 0)
        string(to, key, text);
}

static void limits(const session *s, json_t *to) {
    number(to, "limits.force_N", 1e-6 * s->limits.force_uN);
    number(to, "limits.travel_mm", 1e-6 * s->limits.travel_nm);
    number(to, "limits.following_mm", 1e-6 * s->limits.following_nm);
    number(to, "limits.winding_C", 1e-2 * s->limits.temperature_cC);
    number(to, "limits.host_timeout_s", 1e-3 * s->limits.host_timeout_ms);
    number(to, "limits.overflow_samples", s->limits.overflow_samples);
}

static const char *const row_keys[PALP_WIRE_CHANNELS] = {"device.row_Fx_N",  "device.row_Fy_N",
                                                         "device.row_Fz_N",  "device.row_Tx_Nm",
                                                         "device.row_Ty_Nm", "device.row_Tz_Nm"};

static void calibration(const session *s, json_t *to) {
    const device_parameters *p = &s->calibration;
    const double day = device_parameter_value(p, "calibration_day", 0);
    const bool changed = p->now.id != p->now.stored_id && p->now.source != 2;
    char id[12];
    snprintf(id, sizeof id, "%08x", (unsigned)p->now.id);
    string(to, "calibration.id", id);
    string(to, "calibration.source",
           p->now.stored_id && changed ? "flash, changed" : device_source_text(p->now.source));
    if (day > 0)
        clock_time(to, "calibration.date", (time_t)day * 86400);
    positive(to, "calibration.frame_mm_N", 1e3 * device_parameter_value(p, "compliance_m_N", 0));
    positive(to, "calibration.noise_N", device_parameter_value(p, "noise_N", 0));
    positive(to, "calibration.sensitivity_sd", device_parameter_value(p, "sensitivity_sd", 0));
}

json_t *session_header(const session *s) {
    const palp_wire_status *now = &s->device.status;
    json_t *to = json_object();
    specimen(s, to);
    protocol(s, to);
    device_keys(s, to);
    number(to, "device.protocol", s->device.info.protocol);
    number(to, "device.tick_Hz", s->device.info.tick_Hz);
    number(to, "device.gains_class", now->softness);
    number(to, "device.stiffness_N_m", 1e-3 * now->stiffness_mN_m);
    number(to, "device.contact_counts", s->scale.contact);
    number(to, "device.contact_N", s->scale.contact_N);
    number(to, "device.count_mm", s->scale.count_mm);
    list(to, "device.force_row_N", s->scale.row_N);
    list(to, "device.force_tare", s->scale.tare);
    for (size_t axis = 0; (s->options->columns & ACQUIRE_FORCES) && axis < PALP_WIRE_CHANNELS; axis++)
        list(to, row_keys[axis], s->scale.matrix[axis]);
    calibration(s, to);
    limits(s, to);
    number(to, "device.case_C", 1e-2 * now->case_cC);
    number(to, "device.winding_C", 1e-2 * now->winding_cC);
    clock_time(to, "session.time", s->began);
    clock_time(to, "acquire.time", time(NULL));
    string(to, "palpate.version", palp_version());
    return to;
}

void session_note_run(session *s, const char *cause) {
    const acquire_figures *g = &s->file.figures;
    json_t *one = json_object();
    string(one, "file", s->file.path);
    string(one, "kind", acquire_kind_name(s->run->kind));
    number(one, "depth_mm", s->run->motion.depth_mm);
    json_object_set_new(one, "repeat", json_boolean(s->run->repeat));
    number(one, "samples", (double)g->samples);
    number(one, "lost_samples", (double)g->lost);
    number(one, "bad_samples", (double)g->bad);
    number(one, "duration_s", g->duration_s);
    number(one, "deepest_mm", g->deepest_mm);
    number(one, "peak_N", g->peak_N);
    number(one, "error_rms_mm", g->errors ? sqrt(g->error_square / (double)g->errors) : NAN);
    number(one, "error_most_mm", g->errors ? g->error_most_mm : NAN);
    number(one, "contact_mm", g->contact_mm);
    json_object_set_new(one, "fault", cause ? json_string(cause) : json_null());
    json_array_append_new(s->done, one);
}

static json_t *contact(const session *s) {
    json_t *to = json_object();
    number(to, "below_home_mm", s->scale.count_mm * s->scale.contact);
    number(to, "stiffness_N_m", 1e-3 * s->device.status.stiffness_mN_m);
    number(to, "gains_class", s->device.status.softness);
    return to;
}

json_t *session_summary(session *s, const char *cause) {
    return json_pack("{s{si} so so sI sO ss?}", "palpate", "acquire", 1, "device", device_is(s), "contact",
                     s->device.status.contact_known ? contact(s) : json_null(), "planned",
                     (json_int_t)s->plan->n, "runs", s->done, "fault", cause);
}

void session_tell(const session *s, bool warning, const char *format, ...) {
    char text[ACQUIRE_WORDS];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (warning ? cli_warning : cli_note)(s->options->command, "%s", text);
    if (s->watcher.told)
        s->watcher.told(warning, text, s->watcher.context);
}

void session_line(const session *s, char line[ACQUIRE_TEXT]) {
    const acquire_sample *x = &s->file.last;
    int n = snprintf(line, ACQUIRE_TEXT, "%.40s", s->doing);
    if (s->file.fd >= 0 && s->file.started)
        n += snprintf(line + n, ACQUIRE_TEXT - (size_t)n, "  %.1f/%.0f s  %.3f mm  %.3f N", x->time_s,
                      acquire_run_length_s(s->run), x->depth_mm, x->force_N);
    snprintf(line + n, ACQUIRE_TEXT - (size_t)n, "  %.1f C  lost %zu", s->case_C,
             s->file.fd >= 0 ? s->file.figures.lost : 0);
}
