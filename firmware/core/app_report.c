/* app_report.c: the messages to the host: identity, status, samples. */
#include "app_internal.h"

#include "real.h"

enum { STATUS_TICKS = CONTROL_HZ / 10 };

void report_ack(app *a, uint16_t sequence, uint8_t command, uint8_t result) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_ACK,
                           .as.ack = {.sequence = sequence, .command = command, .result = result}};
    (void)stream_send(&a->stream, &m);
}

void report_info(app *a) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_INFO};
    palp_wire_info *info = &m.as.info;
    *info = (palp_wire_info){.protocol = PALP_WIRE_VERSION,
                             .major = FIRMWARE_MAJOR,
                             .minor = FIRMWARE_MINOR,
                             .patch = FIRMWARE_PATCH,
                             .simulated = a->identity.simulated,
                             .tick_Hz = CONTROL_HZ,
                             .count_pm = (uint32_t)real_round(a->machine.count_m * 1e12f),
                             .travel_nm = real_round(a->machine.travel_m * 1e9f),
                             .force_uN = real_round(a->machine.force_N * 1e6f),
                             .serial = a->identity.serial};
    for (int i = 0; i < PALP_WIRE_NAME && a->identity.board[i] != '\0'; i++)
        info->board[i] = (uint8_t)a->identity.board[i];
    (void)stream_send(&a->stream, &m);
}

void report_calibration(app *a, uint8_t axis) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_CALIBRATION};
    m.as.calibration.axis = axis;
    (void)force_get_row(&a->force, axis, m.as.calibration.row);
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        m.as.calibration.tare[i] = a->force.tare[i];
    (void)stream_send(&a->stream, &m);
}

static uint32_t scaled(float x, float scale) {
    return (uint32_t)real_round(x * scale);
}

void report_gains(app *a, uint8_t softness) {
    const gains *g = &a->gains[softness];
    palp_wire_message m = {.type = PALP_WIRE_TYPE_GAINS};
    m.as.gains = (palp_wire_gains){.softness = softness,
                                   .stiffness_mN_m = scaled(g->stiffness_N_m, 1e3f),
                                   .kp_N_m = scaled(g->kp_N_m, 1.0f),
                                   .ki_N_m_s = scaled(g->ki_N_ms, 1.0f),
                                   .kd_mN_s_m = scaled(g->kd_Ns_m, 1e3f),
                                   .filter_mHz = scaled(g->filter_Hz, 1e3f),
                                   .feed_mN_m = scaled(g->feed_N_m, 1e3f)};
    (void)stream_send(&a->stream, &m);
}

void report_limits(app *a) {
    const app_limits *l = &a->limits;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_LIMITS_NOW};
    m.as.limits_now = (palp_wire_limits_now){.force_uN = real_round(l->force_N * 1e6f),
                                             .travel_nm = real_round(l->travel_m * 1e9f),
                                             .following_nm = real_round(l->following_m * 1e9f),
                                             .temperature_cC = (int16_t)real_round(l->winding_C * 100.0f),
                                             .host_timeout_ms = l->host_timeout_ms,
                                             .overflow_samples = l->overflow_samples};
    (void)stream_send(&a->stream, &m);
}

void report_parameter(app *a, uint8_t id) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_PARAMETER};
    (void)parameters_get(a, id, &m.as.parameter);
    (void)stream_send(&a->stream, &m);
}

void report_configuration(app *a) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_CONFIGURATION, .as.configuration = parameters_state(a)};
    (void)stream_send(&a->stream, &m);
}

static int16_t short_of(float x) {
    const int32_t whole = real_round(x);
    return (int16_t)(whole > INT16_MAX ? INT16_MAX : whole < INT16_MIN ? INT16_MIN : whole);
}

static int16_t case_cC(const app *a) {
    return short_of(a->thermal.case_C * 100.0f);
}

static int32_t position(const app *a) {
    return a->in.position - a->home;
}

static palp_wire_status status(const app *a) {
    return (palp_wire_status){
        .tick = a->tick,
        .state = a->supervisor.state,
        .fault = a->supervisor.fault,
        .fault_tick = a->supervisor.fault_tick,
        .homed = a->homed,
        .contact_known = a->contact_known,
        .search = a->search,
        .softness = a->softness,
        .position = position(a),
        .contact = a->contact_known ? real_round(a->contact_m / a->machine.count_m) : 0,
        .stiffness_mN_m = a->contact_known ? scaled(a->stiffness_N_m, 1e3f) : 0,
        .force_uN = real_round(a->force_N * 1e6f),
        .case_cC = case_cC(a),
        .winding_cC = short_of(thermal_winding_C(&a->thermal) * 100.0f),
        .derating_permille = (uint16_t)real_round(thermal_derating(&a->thermal, &a->machine) * 1000.0f),
        .missed_ticks = a->missed_ticks,
        .bad_frames = a->decoder.bad,
        .tick_cost = a->cost_most,
        .stack_free = a->in.stack_free,
    };
}

static void status_message(app *a, palp_wire_message *m) {
    *m = (palp_wire_message){.type = PALP_WIRE_TYPE_STATUS};
    m->as.status = status(a);
    a->status_tick = a->tick;
}

void report_status(app *a) {
    palp_wire_message m;
    status_message(a, &m);
    (void)stream_send(&a->stream, &m);
}

/* A change of state is reported as soon as there is room, a regular status only where there is plenty. */
static void report_changes(app *a) {
    palp_wire_message m;
    const bool changed = a->told_state != a->supervisor.state;
    if (!changed && !(a->stream.on && a->tick - a->status_tick >= STATUS_TICKS))
        return;
    status_message(a, &m);
    if (!changed)
        (void)stream_offer(&a->stream, &m);
    else if (stream_send(&a->stream, &m))
        a->told_state = m.as.status.state;
}

static uint16_t flags(const app *a) {
    const bool follows = motion_follows(a);
    uint32_t bits = follows ? (uint32_t)a->trajectory.current << 8 | PALP_WIRE_FLAG_TRAJECTORY : 0;
    bits |= motion_records(a) ? PALP_WIRE_FLAG_RECORD : 0;
    bits |= app_drives(a) ? PALP_WIRE_FLAG_MOTOR : 0;
    bits |= thermal_derating(&a->thermal, &a->machine) < 1.0f ? PALP_WIRE_FLAG_DERATED : 0;
    bits |= a->in.home_switch ? PALP_WIRE_FLAG_HOME_SWITCH : 0;
    bits |= !a->answering || a->saturated ? PALP_WIRE_FLAG_SENSOR_BAD : 0;
    bits |= a->elapsed > 1 ? PALP_WIRE_FLAG_TICK_MISSED : 0;
    bits |= a->supervisor.state == PALP_WIRE_STATE_FAULT ? PALP_WIRE_FLAG_FAULT : 0;
    bits |= a->in.trigger && a->trigger.in != PALP_WIRE_TRIGGER_IGNORED ? PALP_WIRE_FLAG_TRIGGER_IN : 0;
    bits |= a->pulsed ? PALP_WIRE_FLAG_TRIGGER_OUT : 0;
    return (uint16_t)bits;
}

/* No tick sends more than a frame of samples, the answers to one command, or a status. The samples up to a
 * change of state are sent before its status. */
void report_tick(app *a, int16_t duty) {
    const float error_m = app_drives(a) ? a->reference.position_m - a->position_m : 0.0f;
    sample one = {.tick = a->tick,
                  .position = position(a),
                  .error = short_of(error_m / a->machine.count_m),
                  .duty = duty,
                  .flags = flags(a)};
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        one.adc[i] = a->in.adc[i];
    const bool busy = stream_turn(&a->stream) || a->command_taken;
    stream_sample(&a->stream, &one, a->supervisor.state, case_cC(a));
    if (!busy && !a->stream.due)
        report_changes(a);
    a->command_taken = false;
}
