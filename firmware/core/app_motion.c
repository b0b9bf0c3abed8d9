/* app_motion.c: the motions: homing, the search for contact, a run, withdrawing. */
#include "app_internal.h"

#include "real.h"

#define ACCELERATION_M_S2 5.0f
#define HOME_RATE_M_S 0.01f
#define HOME_SLOW_M_S 0.002f  /* 2 um a tick, which is how well the edge is known */
#define HOME_REST_M 1e-3f     /* where homing ends */
#define HOME_OFF_M 5e-4f      /* least distance from the switch, */
#define HOME_OFF_MOST_M 3e-3f /* which has to open within this */
#define BEYOND_M 3e-4f        /* largest distance of the plate outside its travel, */
#define STOP_M 1e-3f          /* and at a hard stop when it is homed */

enum { HOME_LEAVE, HOME_SEEK, HOME_LEAVE_AGAIN, HOME_SEEK_SLOWLY, HOME_BACK_OFF };
enum { HOME_SURE = 3 /* ticks in a row that the switch is closed */ };
enum { RUN_TO_START, RUN_WAIT, RUN_AIR, RUN_FOLLOW, RUN_WITHDRAW, RUN_AFTER };

/* A motor that holds the plate keeps the force that holds it. */
void motion_begin(app *a) {
    a->phase = 0;
    a->phase_ticks = 0;
    if (!app_drives(a)) {
        a->reference = (reference){.position_m = a->position_m};
        pid_reset(&a->pid);
    }
    a->from_m = a->back_m = a->reference.position_m;
}

static void next_phase(app *a) {
    a->phase++;
    a->phase_ticks = 0;
}

/* One tick towards a place, from any velocity, to rest there; true once there. The root is the largest speed
 * that still stops in time: v dt + v^2 / (2 a) = way. */
static bool move_toward(reference *r, float to_m, float rate_m_s) {
    const float step = ACCELERATION_M_S2 * TICK_S, way = to_m - r->position_m;
    const float most = __builtin_sqrtf(step * step + 2.0f * ACCELERATION_M_S2 * real_abs(way)) - step;
    const float speed = most < rate_m_s ? most : rate_m_s;
    const float change = real_clamp((way < 0.0f ? -speed : speed) - r->velocity_m_s, -step, step);
    if (real_abs(way) < 1e-8f && real_abs(r->velocity_m_s) <= step) {
        *r = (reference){.position_m = to_m};
        return true;
    }
    r->acceleration_m_s2 = change / TICK_S;
    r->velocity_m_s += change;
    r->position_m += r->velocity_m_s * TICK_S;
    return false;
}

static bool rest(app *a, uint32_t ticks) {
    return ++a->phase_ticks >= ticks;
}

/* Moves until it is off the switch by HOME_OFF_M. */
static bool leave_switch(app *a) {
    const float off_m = a->reference.position_m + HOME_OFF_M;
    if (a->in.home_switch && a->back_m < off_m)
        a->back_m = off_m;
    return move_toward(&a->reference, a->back_m, a->machine.search_m_s);
}

/* From here on positions count from there. */
static void set_home(app *a, int32_t counts, float next_m) {
    const float shift_m = (float)(counts - a->home) * a->machine.count_m;
    a->home = counts;
    a->reference.position_m -= shift_m;
    a->position_m -= shift_m;
    a->from_m -= shift_m;
    a->back_m = next_m;
}

/* Moves up until the switch is closed for longer than a glitch. The edge is where it closed. */
static bool seek_switch(app *a, float rate_m_s, float next_m) {
    (void)move_toward(&a->reference, a->from_m - 2.0f * a->machine.travel_m, rate_m_s);
    if (!a->in.home_switch)
        a->phase_ticks = 0;
    else if (a->phase_ticks++ == 0)
        a->edge = a->in.position;
    if (a->phase_ticks < HOME_SURE)
        return false;
    set_home(a, a->edge, next_m);
    return true;
}

static bool home_phase(app *a) {
    switch (a->phase) {
    case HOME_SEEK:
        return seek_switch(a, HOME_RATE_M_S < a->machine.speed_m_s ? HOME_RATE_M_S : a->machine.speed_m_s,
                           HOME_OFF_M);
    case HOME_SEEK_SLOWLY:
        return seek_switch(a, HOME_SLOW_M_S, HOME_REST_M);
    default:
        return leave_switch(a);
    }
}

static void home_step(app *a) {
    if (!home_phase(a))
        return;
    if (a->phase == HOME_BACK_OFF)
        a->homed = supervisor_take(&a->supervisor, SUPERVISOR_HOMED);
    else
        next_phase(a);
}

void motion_bounds(const app *a, float *low_m, float *high_m) {
    if (a->supervisor.state != PALP_WIRE_STATE_HOMING) { /* no bounds while the position is not known */
        *low_m = a->homed ? -BEYOND_M : -1.0f;
        *high_m = a->homed ? a->limits.travel_m + BEYOND_M : 1.0f;
    } else if (a->phase > HOME_SEEK) {
        *low_m = -BEYOND_M;
        *high_m = HOME_OFF_MOST_M;
    } else {
        *low_m = a->from_m - a->machine.travel_m - STOP_M - BEYOND_M;
        *high_m = a->from_m + HOME_OFF_MOST_M;
    }
}

void motion_withdraw(app *a, float to_m) {
    a->back_m = real_clamp(to_m, 0.0f, a->limits.travel_m);
}

static void contact_is_known(app *a) {
    a->contact_known = true;
    a->search = PALP_WIRE_SEARCH_FOUND;
    a->contact_m = a->contact.position_m;
    motion_withdraw(a, a->contact_m - MOTION_AIR_M);
    a->stiffness_N_m = a->contact.stiffness_N_m;
    if (a->softness_auto)
        a->softness = gains_class(a->gains, a->stiffness_N_m);
}

/* Invalid readings are left out: one at its rail would look like something hard. */
static void approach_step(app *a) {
    const bool at_end = move_toward(&a->reference, a->contact.end_m, a->rate_m_s);
    if (a->answering && !a->saturated && !a->in.force_held)
        (void)contact_step(&a->contact, a->position_m - a->velocity_m_s * a->machine.force_lag_s, a->force_N);
    if (a->contact.phase == CONTACT_FOUND)
        contact_is_known(a);
    else if (a->contact.phase == CONTACT_MISSED || at_end)
        a->search =
            a->contact.phase == CONTACT_MISSED ? a->contact.reason : (uint8_t)PALP_WIRE_SEARCH_NOTHING;
    if (a->contact.phase == CONTACT_FOUND || a->contact.phase == CONTACT_MISSED || at_end)
        (void)supervisor_take(&a->supervisor, SUPERVISOR_DONE);
}

/* A jog that is stopped goes no deeper, and leaves the specimen. */
void motion_stop(app *a) {
    const float here_m = a->reference.position_m,
                air_m = a->contact_known ? a->contact_m - MOTION_AIR_M : a->from_m;
    if (a->supervisor.state == PALP_WIRE_STATE_JOG)
        motion_withdraw(a, here_m < air_m ? here_m : air_m);
}

static void retract_step(app *a) {
    const bool jogs = a->supervisor.state == PALP_WIRE_STATE_JOG;
    if (move_toward(&a->reference, a->back_m, jogs ? a->rate_m_s : MOTION_RATE_M_S))
        (void)supervisor_take(&a->supervisor, SUPERVISOR_DONE);
}

static bool follow(app *a) {
    a->trajectory.measured_N = a->force_N;
    const bool going = trajectory_step(&a->trajectory, &a->reference);
    a->reference.position_m += a->contact_m;
    return !going;
}

static bool run_phase(app *a) {
    switch (a->phase) {
    case RUN_WAIT:
        return a->in.trigger;
    case RUN_AIR:
        return rest(a, a->air_ticks);
    case RUN_FOLLOW:
        return follow(a);
    case RUN_AFTER:
        return rest(a, a->after_ticks);
    default:
        return move_toward(&a->reference, a->back_m, a->rate_m_s);
    }
}

static void run_step(app *a) {
    if (!run_phase(a))
        return;
    if (a->phase == RUN_AFTER)
        (void)supervisor_take(&a->supervisor, SUPERVISOR_DONE);
    else
        next_phase(a);
    if (a->phase == RUN_WAIT && a->phase_ticks == 0 && a->trigger.in != PALP_WIRE_TRIGGER_STARTS)
        next_phase(a);
}

bool motion_records(const app *a) {
    return a->supervisor.state == PALP_WIRE_STATE_RUN && a->phase >= RUN_AIR;
}

bool motion_follows(const app *a) {
    return a->supervisor.state == PALP_WIRE_STATE_RUN && a->phase == RUN_FOLLOW;
}

/* A pulse at the first sample of a recording, and then one after every so many samples. */
bool motion_pulse(app *a) {
    const bool records = motion_records(a), first = records && !a->recorded;
    a->recorded = records;
    a->pulse_ticks = first ? 0 : a->pulse_ticks + 1;
    const bool due = first || (a->trigger.every > 0 && a->pulse_ticks == a->trigger.every);
    if (due)
        a->pulse_ticks = 0;
    return records && due && a->trigger.out != 0;
}

void motion_step(app *a) {
    switch (a->supervisor.state) {
    case PALP_WIRE_STATE_HOMING:
        home_step(a);
        break;
    case PALP_WIRE_STATE_APPROACH:
        approach_step(a);
        break;
    case PALP_WIRE_STATE_RUN:
        run_step(a);
        break;
    default:
        retract_step(a);
        break;
    }
}
