/* app_command.c: the host's commands: whether the state permits each, and its effect. */
#include "app_internal.h"

#include "real.h"

#define SEARCH_RATE_M_S 5e-4f /* where the host leaves it open */
#define SEARCH_FORCE_N 0.01f
#define JOG_RATE_FREE_M_S 0.01f

enum { LEAST_TIMEOUT_MS = 100, MOST_TIMEOUT_MS = 60000 };

#define IN(state) (1U << PALP_WIRE_STATE_##state)
#define ALWAYS ((1U << PALP_WIRE_STATE_COUNT) - 1)
#define STILL (IN(IDLE) | IN(READY))

static const struct permission {
    uint8_t command;
    uint16_t states;
} permissions[] = {
    {PALP_WIRE_TYPE_HELLO, ALWAYS},
    {PALP_WIRE_TYPE_ALIVE, ALWAYS},
    {PALP_WIRE_TYPE_STREAM, ALWAYS},
    {PALP_WIRE_TYPE_CLEAR_FAULT, IN(FAULT)},
    {PALP_WIRE_TYPE_HOME, STILL},
    {PALP_WIRE_TYPE_TARE, STILL | IN(FAULT)}, /* the wrong one may be the fault */
    {PALP_WIRE_TYPE_SET_CALIBRATION, STILL | IN(FAULT)},
    {PALP_WIRE_TYPE_GET_CALIBRATION, ALWAYS},
    {PALP_WIRE_TYPE_LIMITS, ALWAYS},
    {PALP_WIRE_TYPE_GET_LIMITS, ALWAYS},
    {PALP_WIRE_TYPE_SELECT_GAINS, STILL},
    {PALP_WIRE_TYPE_GET_GAINS, ALWAYS},
    {PALP_WIRE_TYPE_FIND_CONTACT, IN(READY)},
    {PALP_WIRE_TYPE_SEGMENT, ALWAYS & ~IN(BOOT) & ~IN(RUN) & ~IN(FAULT)},
    {PALP_WIRE_TYPE_START, IN(READY)},
    {PALP_WIRE_TYPE_STOP, ALWAYS & ~IN(BOOT) & ~IN(FAULT)},
    {PALP_WIRE_TYPE_GET_STATUS, ALWAYS},
    {PALP_WIRE_TYPE_HALT, ALWAYS & ~IN(BOOT) & ~IN(FAULT)},
    {PALP_WIRE_TYPE_JOG, IN(READY)},
    {PALP_WIRE_TYPE_TRIGGER, STILL},
    {PALP_WIRE_TYPE_GET_PARAMETER, ALWAYS},
    {PALP_WIRE_TYPE_SET_PARAMETER, IN(IDLE)},
    {PALP_WIRE_TYPE_SAVE, IN(IDLE)},
    {PALP_WIRE_TYPE_GET_CONFIGURATION, ALWAYS},
};

static uint8_t permitted(const app *a, uint8_t command) {
    const uint16_t here = (uint16_t)(1U << a->supervisor.state);
    for (size_t i = 0; i < sizeof permissions / sizeof permissions[0]; i++) {
        const uint16_t states = permissions[i].states;
        if (permissions[i].command != command)
            continue;
        if (a->store.writing && (states & IN(RUN)) == 0)
            return PALP_WIRE_RESULT_STATE; /* flash is not written while something moves */
        if ((states & here) != 0 || (here == IN(IDLE) && states == IN(READY) && a->homed))
            return PALP_WIRE_RESULT_DONE;
        if (here == IN(FAULT))
            return PALP_WIRE_RESULT_FAULTED;
        return here == IN(IDLE) && states == IN(READY) ? PALP_WIRE_RESULT_NOT_HOMED : PALP_WIRE_RESULT_STATE;
    }
    return PALP_WIRE_RESULT_UNKNOWN;
}

static uint8_t done_if(bool good) {
    return good ? PALP_WIRE_RESULT_DONE : PALP_WIRE_RESULT_RANGE;
}

/* A new host has set nothing yet. A motion in progress keeps the limits that it was started with. */
static uint8_t hello(app *a, const palp_wire_hello *asked) {
    if (asked->protocol != PALP_WIRE_VERSION)
        return PALP_WIRE_RESULT_VERSION;
    stream_end_block(&a->stream);
    a->stream.on = false;
    if (!app_moving(a)) {
        watch_limits_begin(a);
        a->trigger = (palp_wire_trigger){.in = PALP_WIRE_TRIGGER_IGNORED};
    }
    return PALP_WIRE_RESULT_DONE;
}

static uint8_t set_stream(app *a, const palp_wire_stream *asked) {
    stream_end_block(&a->stream);
    a->stream.on = asked->on != 0;
    return PALP_WIRE_RESULT_DONE;
}

/* Where the position is known: holds the plate where it is. */
static void make_ready(app *a) {
    if (a->supervisor.state != PALP_WIRE_STATE_IDLE || !a->homed)
        return;
    motion_begin(a);
    (void)supervisor_take(&a->supervisor, SUPERVISOR_HOMED);
}

static uint8_t clear_fault(app *a) {
    if (watch_persists(a))
        return PALP_WIRE_RESULT_PERSISTS;
    if (watch_out_of_travel(a) || watch_pressed(a))
        a->homed = a->contact_known = false;
    (void)supervisor_take(&a->supervisor, SUPERVISOR_CLEAR);
    if (a->homed)
        make_ready(a);
    return PALP_WIRE_RESULT_DONE;
}

static uint8_t begin(app *a, supervisor_event event) {
    make_ready(a);
    motion_begin(a);
    (void)supervisor_take(&a->supervisor, event);
    return PALP_WIRE_RESULT_DONE;
}

static uint8_t home(app *a) {
    a->homed = a->contact_known = false;
    return begin(a, SUPERVISOR_HOME);
}

static uint8_t tare(app *a, const palp_wire_tare *asked) {
    if (asked->samples < 1 || asked->samples > FORCE_TARE_MOST)
        return PALP_WIRE_RESULT_RANGE;
    force_tare_begin(&a->force, asked->samples);
    return PALP_WIRE_RESULT_DONE;
}

/* 0 leaves it as it is. */
static bool limit(float *value, int32_t asked, float unit, float most) {
    if (asked < 0 || asked > real_round(most / unit))
        return false;
    if (asked > 0)
        *value = (float)asked * unit;
    return true;
}

static uint8_t set_limits(app *a, const palp_wire_limits *asked) {
    const machine *m = &a->machine;
    const uint16_t timeout_ms = asked->host_timeout_ms;
    app_limits next = a->limits;
    if (!limit(&next.force_N, asked->force_uN, 1e-6f, m->force_N) ||
        !limit(&next.travel_m, asked->travel_nm, 1e-9f, m->travel_m) ||
        !limit(&next.following_m, asked->following_nm, 1e-9f, m->following_m) ||
        !limit(&next.winding_C, asked->temperature_cC, 0.01f, m->fault_C) ||
        (timeout_ms != 0 && (timeout_ms < LEAST_TIMEOUT_MS || timeout_ms > MOST_TIMEOUT_MS)))
        return PALP_WIRE_RESULT_RANGE;
    if (timeout_ms != 0)
        next.host_timeout_ms = timeout_ms;
    if (asked->overflow_samples != 0)
        next.overflow_samples = asked->overflow_samples;
    a->limits = next;
    return PALP_WIRE_RESULT_DONE;
}

static uint8_t select_gains(app *a, const palp_wire_select_gains *asked) {
    const bool automatic = asked->softness == PALP_WIRE_GAINS_AUTO;
    if (!automatic && asked->softness >= GAINS_CLASSES)
        return PALP_WIRE_RESULT_RANGE;
    a->softness_auto = automatic;
    if (!automatic)
        a->softness = asked->softness;
    else
        a->softness = a->contact_known ? gains_class(a->gains, a->stiffness_N_m) : (uint8_t)GAINS_MIDDLE;
    return PALP_WIRE_RESULT_DONE;
}

/* A field of 0 stands for the firmware's own choice. */
static uint8_t find_contact(app *a, const palp_wire_find_contact *asked) {
    const float rate = asked->rate_nm_s > 0 ? (float)asked->rate_nm_s * 1e-9f : SEARCH_RATE_M_S;
    const float threshold = asked->force_uN != 0 ? (float)asked->force_uN * 1e-6f : SEARCH_FORCE_N;
    const float way = asked->travel_nm != 0 ? (float)asked->travel_nm * 1e-9f : a->limits.travel_m;
    const float end = a->position_m + way;
    if (rate > a->machine.search_m_s || threshold <= 0.0f || threshold > a->limits.force_N || way <= 0.0f)
        return PALP_WIRE_RESULT_RANGE;
    a->contact_known = false;
    a->search = PALP_WIRE_SEARCH_NONE;
    a->rate_m_s = rate;
    contact_begin(&a->contact, threshold, end < a->limits.travel_m ? end : a->limits.travel_m);
    return begin(a, SUPERVISOR_FIND_CONTACT);
}

static uint8_t set_segment(app *a, const palp_wire_segment *asked) {
    if (asked->index >= PALP_WIRE_SEGMENTS)
        return PALP_WIRE_RESULT_RANGE;
    const uint8_t result = trajectory_check(asked, a->machine.speed_m_s, a->machine.force_N);
    if (result == PALP_WIRE_RESULT_DONE) {
        trajectory_set(&a->trajectory, asked->index, asked);
        a->segments_set |= 1U << asked->index;
    }
    return result;
}

static bool segments_are_set(const app *a, uint8_t count) {
    const uint32_t wanted =
        count > 0 && count <= PALP_WIRE_SEGMENTS ? UINT32_MAX >> (PALP_WIRE_SEGMENTS - count) : 0;
    return wanted != 0 && (a->segments_set & wanted) == wanted;
}

static float first_rate(const trajectory *t) {
    const segment *s = &t->list[0];
    const bool has_rate = s->kind == PALP_WIRE_SEGMENT_MOVE || s->kind == PALP_WIRE_SEGMENT_CYCLE;
    return has_rate && s->rate_m_s > MOTION_RATE_M_S ? s->rate_m_s : MOTION_RATE_M_S;
}

/* A speed in the specimen is allowed if the force exceeds its limit by at most the limit itself: by momentum,
 * and in the two ticks until the motor is off (more with a slow sensor). */
static float safe_m_s(const app *a) {
    const float k = a->stiffness_N_m, blind_s = 2.0f * TICK_S + a->machine.force_delay_s;
    const float momentum_Ns_m = a->machine.stepper ? 0.0f : __builtin_sqrtf(k * a->machine.moving_kg);
    return a->limits.force_N / (momentum_Ns_m + blind_s * k);
}

/* Within the travel, and slowly enough; to a force only where its loop is stable. */
static uint8_t can_follow(const app *a, uint8_t segments, float start_m) {
    const reach r = trajectory_reach(&a->trajectory, segments, start_m);
    const float to_start_m_s = start_m > 0.0f ? first_rate(&a->trajectory) : 0.0f;
    if (r.force_N > 0.0f && !trajectory_force_stable(&a->trajectory, contact_noise_N(&a->contact)))
        return PALP_WIRE_RESULT_UNSTABLE;
    return done_if(r.force_N <= a->limits.force_N && a->contact_m + r.low_m >= 0.0f &&
                   a->contact_m + r.high_m <= a->limits.travel_m && r.speed_m_s <= safe_m_s(a) &&
                   to_start_m_s <= safe_m_s(a));
}

static uint8_t start(app *a, const palp_wire_start *asked) {
    const float depth = (float)asked->start_nm * 1e-9f, place = a->contact_m + depth;
    if (!a->contact_known)
        return PALP_WIRE_RESULT_NO_CONTACT;
    if (!segments_are_set(a, asked->segments))
        return PALP_WIRE_RESULT_RANGE;
    a->trajectory.stiffness_N_m = a->stiffness_N_m;
    a->trajectory.count_m = a->machine.count_m;
    const uint8_t result = can_follow(a, asked->segments, depth);
    if (result != PALP_WIRE_RESULT_DONE)
        return result;
    a->trajectory.touch_N = a->contact.threshold_N;
    a->trajectory.force_most_m_s = safe_m_s(a) < a->machine.speed_m_s ? safe_m_s(a) : a->machine.speed_m_s;
    trajectory_begin(&a->trajectory, asked->segments, depth);
    a->air_ticks = asked->air_ms * (CONTROL_HZ / 1000);
    a->after_ticks = asked->after_ms * (CONTROL_HZ / 1000);
    a->rate_m_s = first_rate(&a->trajectory);
    a->lost_at_start = a->stream.lost;
    (void)begin(a, SUPERVISOR_START);
    motion_withdraw(a, place);
    return PALP_WIRE_RESULT_DONE;
}

/* Nothing is met on the way up, nor down to a known contact. */
static float fastest_jog(const app *a, float to_m) {
    const bool free = to_m <= a->position_m || (a->contact_known && to_m <= a->contact_m);
    const float most = free ? JOG_RATE_FREE_M_S : a->machine.search_m_s;
    return most < a->machine.speed_m_s ? most : a->machine.speed_m_s;
}

static uint8_t jog(app *a, const palp_wire_jog *asked) {
    const float to_m = (float)asked->to_nm * 1e-9f, rate_m_s = (float)asked->rate_nm_s * 1e-9f;
    if (to_m < 0.0f || to_m > a->limits.travel_m || rate_m_s <= 0.0f || rate_m_s > fastest_jog(a, to_m))
        return PALP_WIRE_RESULT_RANGE;
    (void)begin(a, SUPERVISOR_JOG);
    a->rate_m_s = rate_m_s;
    motion_withdraw(a, to_m);
    return PALP_WIRE_RESULT_DONE;
}

static uint8_t set_trigger(app *a, const palp_wire_trigger *asked) {
    if (asked->in > PALP_WIRE_TRIGGER_STARTS || asked->out > 1)
        return PALP_WIRE_RESULT_RANGE;
    a->trigger = *asked;
    return PALP_WIRE_RESULT_DONE;
}

static uint8_t set_calibration(app *a, const palp_wire_set_calibration *asked) {
    const bool good = force_set_row(&a->force, asked->axis, asked->row);
    parameters_changed(a);
    return done_if(good);
}

static uint8_t execute(app *a, const palp_wire_message *c) {
    switch (c->type) {
    case PALP_WIRE_TYPE_HELLO:
        return hello(a, &c->as.hello);
    case PALP_WIRE_TYPE_STREAM:
        return set_stream(a, &c->as.stream);
    case PALP_WIRE_TYPE_CLEAR_FAULT:
        return clear_fault(a);
    case PALP_WIRE_TYPE_HOME:
        return home(a);
    case PALP_WIRE_TYPE_TARE:
        return tare(a, &c->as.tare);
    case PALP_WIRE_TYPE_SET_CALIBRATION:
        return set_calibration(a, &c->as.set_calibration);
    case PALP_WIRE_TYPE_GET_CALIBRATION:
        return done_if(c->as.get_calibration.axis < FORCE_AXES);
    case PALP_WIRE_TYPE_LIMITS:
        return set_limits(a, &c->as.limits);
    case PALP_WIRE_TYPE_SELECT_GAINS:
        return select_gains(a, &c->as.select_gains);
    case PALP_WIRE_TYPE_GET_GAINS:
        return done_if(c->as.get_gains.softness < GAINS_CLASSES);
    case PALP_WIRE_TYPE_FIND_CONTACT:
        return find_contact(a, &c->as.find_contact);
    case PALP_WIRE_TYPE_SEGMENT:
        return set_segment(a, &c->as.segment);
    case PALP_WIRE_TYPE_START:
        return start(a, &c->as.start);
    case PALP_WIRE_TYPE_STOP: /* back_m says where to */
        motion_stop(a);
        (void)supervisor_take(&a->supervisor, SUPERVISOR_STOP);
        return PALP_WIRE_RESULT_DONE;
    case PALP_WIRE_TYPE_HALT:
        return supervisor_fault(&a->supervisor, PALP_WIRE_FAULT_EMERGENCY_STOP, a->tick)
                   ? PALP_WIRE_RESULT_DONE
                   : PALP_WIRE_RESULT_STATE;
    case PALP_WIRE_TYPE_JOG:
        return jog(a, &c->as.jog);
    case PALP_WIRE_TYPE_TRIGGER:
        return set_trigger(a, &c->as.trigger);
    case PALP_WIRE_TYPE_GET_PARAMETER:
        return done_if(parameters_get(a, c->as.get_parameter.id, &(palp_wire_parameter){.id = 0}));
    case PALP_WIRE_TYPE_SET_PARAMETER:
        return parameters_set(a, &c->as.set_parameter);
    case PALP_WIRE_TYPE_SAVE:
        return parameters_save(a);
    default: /* ALIVE, GET_CONFIGURATION, GET_LIMITS, GET_STATUS */
        return PALP_WIRE_RESULT_DONE;
    }
}

static void answer(app *a, const palp_wire_message *c) {
    switch (c->type) {
    case PALP_WIRE_TYPE_GET_CALIBRATION:
        report_calibration(a, c->as.get_calibration.axis);
        break;
    case PALP_WIRE_TYPE_GET_LIMITS:
        report_limits(a);
        break;
    case PALP_WIRE_TYPE_GET_GAINS:
        report_gains(a, c->as.get_gains.softness);
        break;
    case PALP_WIRE_TYPE_GET_PARAMETER:
        report_parameter(a, c->as.get_parameter.id);
        break;
    case PALP_WIRE_TYPE_GET_CONFIGURATION:
        report_configuration(a);
        break;
    case PALP_WIRE_TYPE_GET_STATUS:
        report_status(a);
        break;
    default:
        break;
    }
}

/* The host repeats a command whose answer it missed. Then only the answer is repeated, not the action. A
 * HELLO is always new, since another host may begin with the same number. */
void command_take(app *a, const palp_wire_message *c) {
    const bool again = a->command_seen && c->sequence == a->command_sequence && c->type == a->command_type &&
                       c->type != PALP_WIRE_TYPE_HELLO;
    uint8_t result = a->command_result;
    if (!again) {
        result = permitted(a, c->type);
        result = result == PALP_WIRE_RESULT_DONE ? execute(a, c) : result;
    }
    a->command_taken = a->command_seen = true;
    a->command_sequence = c->sequence;
    a->command_type = c->type;
    a->command_result = result;
    report_ack(a, c->sequence, c->type, result);
    if (result == PALP_WIRE_RESULT_DONE)
        answer(a, c);
    if (c->type == PALP_WIRE_TYPE_HELLO) /* also to one of another version, which must learn of ours */
        report_info(a);
}
