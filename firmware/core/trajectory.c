/* trajectory.c: the depth that the plate is to follow, tick by tick, from a list of segments. */
#include "trajectory.h"

#include "contact.h"
#include "machine.h"
#include "real.h"

enum { PERIOD = 1000000000, MOST_CYCLES = 65535 };

/* The next whole number, limited to the type's range. */
static uint32_t round_up(float x) {
    if (x >= 4e9f)
        return 4000000000u;
    uint32_t whole = (uint32_t)x;
    return (float)whole < x ? whole + 1 : whole;
}

void stroke_begin(stroke *s, float start_m, float end_m, float rate_m_s, float acceleration_m_s2) {
    float way = end_m - start_m, length = real_abs(way), rate = rate_m_s;
    if (length * acceleration_m_s2 < rate * rate)
        rate = __builtin_sqrtf(length * acceleration_m_s2);
    *s = (stroke){.start_m = start_m, .end_m = end_m, .ticks = 1};
    if (rate <= 0.0f)
        return;
    s->rate_m_s = way < 0.0f ? -rate : rate;
    s->acceleration_m_s2 = way < 0.0f ? -acceleration_m_s2 : acceleration_m_s2;
    s->ramp_s = rate / acceleration_m_s2;
    float ticks = (length / rate + s->ramp_s) * (float)CONTROL_HZ;
    s->ticks = round_up(ticks);
    s->rest_s = ((float)s->ticks - ticks) / (float)CONTROL_HZ;
}

/* So long after rest, or before it, of a ramp: way, velocity, acceleration. */
static reference ramp_at(const stroke *s, float time) {
    const float a = s->acceleration_m_s2, turn = time / s->ramp_s;
    float sine, cosine;
    if (!s->smooth)
        return (reference){0.5f * a * time * time, a * time, a};
    real_sine(turn, &sine, &cosine);
    return (reference){s->rate_m_s * s->ramp_s *
                           (0.5f * turn * turn - (1.0f - cosine) / (4.0f * REAL_PI * REAL_PI)),
                       s->rate_m_s * (turn - sine / (2.0f * REAL_PI)), a * (1.0f - cosine)};
}

bool stroke_step(stroke *s, reference *next) {
    bool going = s->tick < s->ticks;
    *next = (reference){.position_m = s->end_m};
    if (!going || ++s->tick == s->ticks)
        return going;
    const float time = (float)s->tick / (float)CONTROL_HZ;
    const float left = (float)(s->ticks - s->tick) / (float)CONTROL_HZ - s->rest_s;
    if (time < s->ramp_s && time < left) {
        *next = ramp_at(s, time);
        next->position_m = s->start_m + next->position_m;
    } else if (left > s->ramp_s) {
        *next = (reference){s->start_m + s->rate_m_s * (time - 0.5f * s->ramp_s), s->rate_m_s, 0.0f};
    } else if (left > 0.0f) {
        *next = ramp_at(s, left);
        *next = (reference){s->end_m - next->position_m, next->velocity_m_s, -next->acceleration_m_s2};
    }
    return true;
}

/* Periods of a SWEEP: start * duration * (2^octaves - 1) / ln 2^octaves, plus 0.002 against rounding. A last
 * period that is short by this ends practically at rest. */
static float sweep_cycles(float start_Hz, float octaves, float duration_s) {
    float x = octaves * REAL_LN2;
    float mean = real_abs(x) < 1e-3f ? 1.0f + 0.5f * x : (real_exp2(octaves) - 1.0f) / x;
    return start_Hz * duration_s * mean + 0.002f;
}

static float sweep_octaves(const palp_wire_segment *wire) {
    return real_log2((float)wire->frequency_end_mHz / (float)wire->frequency_mHz);
}

static uint32_t wave_frequency(const trajectory *t, const segment *s) {
    if (s->kind == PALP_WIRE_SEGMENT_SINE)
        return s->frequency_uHz;
    float octaves = s->octaves * ((float)t->tick / (float)s->ticks);
    return (uint32_t)((float)s->frequency_uHz * real_exp2(octaves) + 0.5f);
}

static void wave_reference(trajectory *t, const segment *s) {
    float sine, cosine;
    real_sine((float)t->phase * 1e-9f, &sine, &cosine);
    float shape = sine, slope = cosine, bend = -sine;
    bool late = t->phase >= PERIOD / 2;
    if (late ? t->cycle + 1 == s->cycles : t->cycle == 0) { /* times (1 - cosine) / 2 */
        shape = 0.5f * sine * (1.0f - cosine);
        slope = 0.5f * (1.0f + cosine - 2.0f * cosine * cosine);
        bend = sine * (2.0f * cosine - 0.5f);
    }
    float omega = 2.0f * REAL_PI * 1e-6f * (float)t->frequency_uHz;
    float rising = s->octaves * REAL_LN2 * (float)CONTROL_HZ / (float)s->ticks; /* omega' / omega */
    t->now.position_m = t->start_m + s->target_m * shape;
    t->now.velocity_m_s = s->target_m * omega * slope;
    t->now.acceleration_m_s2 = s->target_m * omega * (omega * bend + rising * slope);
}

static bool wave_step(trajectory *t, const segment *s) {
    if (t->tick == s->ticks)
        return false;
    t->tick++;
    uint32_t before = t->frequency_uHz;
    t->frequency_uHz = wave_frequency(t, s);
    t->phase += (before + t->frequency_uHz) / 2;
    if (t->phase >= PERIOD) {
        t->phase -= PERIOD;
        t->cycle++;
    }
    t->now = (reference){.position_m = t->start_m};
    if (t->cycle < s->cycles && t->tick < s->ticks)
        wave_reference(t, s);
    return true;
}

static bool within(uint32_t x, uint32_t most) {
    return x > 0 && x <= most;
}

static bool stroke_possible(const palp_wire_segment *wire, float speed_m_s) {
    return wire->rate_nm_s > 0 && (float)wire->rate_nm_s * 1e-9f <= speed_m_s &&
           wire->acceleration_um_s2 > 0 &&
           (float)wire->acceleration_um_s2 * 1e-6f <= TRAJECTORY_ACCELERATION_M_S2;
}

/* Fading and sweeping accelerate by up to 1.6 times what the wave does. */
static bool wave_possible(const palp_wire_segment *wire, uint32_t frequency_mHz, float speed_m_s) {
    float amplitude = real_abs((float)wire->target_nm) * 1e-9f;
    float omega = 2.0f * REAL_PI * 1e-3f * (float)frequency_mHz;
    return amplitude > 0.0f && within(frequency_mHz, TRAJECTORY_FREQUENCY_MHZ) &&
           amplitude * omega <= speed_m_s && 1.6f * amplitude * omega * omega <= TRAJECTORY_ACCELERATION_M_S2;
}

static uint64_t sine_ticks(const palp_wire_segment *wire) {
    return ((uint64_t)wire->cycles * 1000 * CONTROL_HZ + wire->frequency_mHz - 1) / wire->frequency_mHz;
}

static bool sweep_possible(const palp_wire_segment *wire, float speed_m_s) {
    if (wire->duration_ms == 0 || !wave_possible(wire, wire->frequency_mHz, speed_m_s) ||
        !wave_possible(wire, wire->frequency_end_mHz, speed_m_s))
        return false;
    float cycles = sweep_cycles((float)wire->frequency_mHz * 1e-3f, sweep_octaves(wire),
                                (float)wire->duration_ms * 1e-3f);
    return cycles >= 1.0f && cycles <= (float)MOST_CYCLES;
}

static bool force_possible(const palp_wire_segment *wire, float force_N) {
    return wire->target_nm > 0 && (float)wire->target_nm * 1e-6f <= force_N && wire->rate_nm_s > 0 &&
           wire->deepest_nm >= 0;
}

static bool is_smooth(uint8_t kind) {
    return kind == (PALP_WIRE_SEGMENT_MOVE | PALP_WIRE_SEGMENT_SMOOTH) ||
           kind == (PALP_WIRE_SEGMENT_CYCLE | PALP_WIRE_SEGMENT_SMOOTH);
}

static uint8_t plain(uint8_t kind) {
    return is_smooth(kind) ? (uint8_t)(kind - PALP_WIRE_SEGMENT_SMOOTH) : kind;
}

static bool possible(const palp_wire_segment *wire, float speed_m_s, float force_N) {
    switch (plain(wire->kind)) {
    case PALP_WIRE_SEGMENT_MOVE:
        return stroke_possible(wire, speed_m_s);
    case PALP_WIRE_SEGMENT_HOLD:
        return wire->duration_ms > 0;
    case PALP_WIRE_SEGMENT_CYCLE:
        return stroke_possible(wire, speed_m_s) && wire->cycles > 0;
    case PALP_WIRE_SEGMENT_SINE:
        return wave_possible(wire, wire->frequency_mHz, speed_m_s) && wire->cycles > 0 &&
               sine_ticks(wire) <= UINT32_MAX;
    case PALP_WIRE_SEGMENT_SWEEP:
        return sweep_possible(wire, speed_m_s);
    case PALP_WIRE_SEGMENT_FORCE:
        return force_possible(wire, force_N);
    default:
        return false;
    }
}

uint8_t trajectory_check(const palp_wire_segment *wire, float speed_m_s, float force_N) {
    return possible(wire, speed_m_s, force_N) ? PALP_WIRE_RESULT_DONE : PALP_WIRE_RESULT_RANGE;
}

void trajectory_set(trajectory *t, uint8_t index, const palp_wire_segment *wire) {
    segment *s = &t->list[index];
    *s = (segment){.kind = plain(wire->kind),
                   .smooth = is_smooth(wire->kind),
                   .target_m = (float)wire->target_nm * 1e-9f,
                   .rate_m_s = (float)wire->rate_nm_s * 1e-9f,
                   .acceleration_m_s2 = (float)wire->acceleration_um_s2 * 1e-6f,
                   .target_N = (float)wire->target_nm * 1e-6f,
                   .rate_N_s = (float)wire->rate_nm_s * 1e-6f,
                   .deepest_m = wire->deepest_nm > 0 ? (float)wire->deepest_nm * 1e-9f : 1.0f,
                   .ticks = wire->duration_ms * (CONTROL_HZ / 1000),
                   .frequency_uHz = wire->frequency_mHz * 1000,
                   .cycles = wire->cycles};
    if (s->kind == PALP_WIRE_SEGMENT_SINE)
        s->ticks = (uint32_t)sine_ticks(wire);
    if (s->kind == PALP_WIRE_SEGMENT_SWEEP) {
        s->octaves = sweep_octaves(wire);
        s->cycles = (uint32_t)sweep_cycles((float)wire->frequency_mHz * 1e-3f, s->octaves,
                                           (float)wire->duration_ms * 1e-3f);
    }
}

static void begin_stroke(trajectory *t, const segment *s, float from_m, float to_m) {
    stroke_begin(&t->stroke, from_m, to_m, s->rate_m_s,
                 s->smooth ? 0.5f * s->acceleration_m_s2 : s->acceleration_m_s2);
    t->stroke.smooth = s->smooth;
}

static void begin_segment(trajectory *t) {
    const segment *s = &t->list[t->current];
    t->start_m = t->now.position_m;
    t->tick = t->cycle = t->phase = 0;
    t->frequency_uHz = s->frequency_uHz;
    t->wants = t->felt = false;
    t->wanted_N = t->sum_Ns = 0.0f;
    t->smooth_N = t->measured_N;
    t->far_ticks = t->swing_ticks = t->swings = 0;
    t->side = 0;
    begin_stroke(t, s, t->start_m, s->target_m);
}

void trajectory_begin(trajectory *t, uint8_t count, float start_m) {
    t->count = count;
    t->current = 0;
    t->fault = PALP_WIRE_FAULT_NONE;
    t->now = (reference){.position_m = start_m};
    if (count > 0)
        begin_segment(t);
}

/* Adds a motion to the reach; fading makes waves faster by at most a hundredth. */
static void widen(reach *r, float low_m, float high_m, float speed_m_s) {
    r->low_m = low_m < r->low_m ? low_m : r->low_m;
    r->high_m = high_m > r->high_m ? high_m : r->high_m;
    if (high_m > 0.0f && speed_m_s > r->speed_m_s)
        r->speed_m_s = speed_m_s;
}

static float wave_speed(const segment *s) {
    const float end = s->octaves > 0.0f ? real_exp2(s->octaves) : 1.0f;
    return 2.0f * REAL_PI * 1e-6f * (float)s->frequency_uHz * end * real_abs(s->target_m);
}

reach trajectory_reach(const trajectory *t, uint8_t count, float start_m) {
    reach r = {start_m, start_m, 0.0f, 0.0f};
    float at_m = start_m;
    for (uint8_t i = 0; i < count; i++) {
        const segment *s = &t->list[i];
        const float to_m = s->target_m, wide_m = real_abs(to_m);
        if (s->kind == PALP_WIRE_SEGMENT_FORCE)
            r.force_N = s->target_N > r.force_N ? s->target_N : r.force_N;
        else if (s->kind == PALP_WIRE_SEGMENT_SINE || s->kind == PALP_WIRE_SEGMENT_SWEEP)
            widen(&r, at_m - wide_m, at_m + wide_m, wave_speed(s));
        else if (s->kind != PALP_WIRE_SEGMENT_HOLD)
            widen(&r, at_m < to_m ? at_m : to_m, at_m > to_m ? at_m : to_m, s->rate_m_s);
        at_m = s->kind == PALP_WIRE_SEGMENT_MOVE ? to_m : at_m;
    }
    return r;
}

static bool cycle_step(trajectory *t, const segment *s) {
    if (stroke_step(&t->stroke, &t->now))
        return true;
    if (++t->cycle == 2 * s->cycles)
        return false;
    begin_stroke(t, s, t->now.position_m, t->cycle % 2 == 0 ? s->target_m : t->start_m);
    return stroke_step(&t->stroke, &t->now);
}

#define FORCE_AIR_M_S 1e-3f  /* speed in the air, towards contact */
#define FORCE_MOST_M_S 0.02f /* highest speed in the specimen */
#define FORCE_MOST_M_S2 5.0f /* highest acceleration there */
#define FORCE_SLOPE_M 3e-4f  /* from this depth on, force over depth is a valid stiffness */
#define FORCE_W_S 12.0f      /* poles of the loop, 1/s: a sixth of the slowest position loop's (gains.c) */
#define FORCE_LATE 0.25f     /* largest phase lag by the sensor's delay at that frequency, rad */

/* With both poles at w the error after a step decays as (1 - wt) exp(-wt). After 4/w it is below 6 %, and
 * below half if the slope is a tenth of the measured one. A force below half of the target for longer is
 * lost. */
#define FORCE_FAR 0.5f
#define FORCE_STEP 4.0f
#define FORCE_SMOOTH_TICKS 16.0f /* of the mean that is compared: a fifth of 1/w */
/* Such an error changes its sign once; with a tenth of the slope it halves with each change. Six swings by a
 * tenth of the target, each within two periods of the loop, show that the loop is unstable. */
#define FORCE_SWING 0.1f
#define FORCE_SWING_PERIODS 2.0f
enum { FORCE_SWINGS = 6 };
#define FORCE_SWING_COUNTS 2.0f /* encoder counts by which rounding alone may move the plate */
/* Least number of encoder counts per newton: the search measures a high stiffness over 1 N, and rounding to
 * counts then makes an error of at most a tenth. */
#define FORCE_LINE_COUNTS 4.0f

float trajectory_force_w_s(float delay_s) {
    return FORCE_W_S * delay_s <= FORCE_LATE ? FORCE_W_S : FORCE_LATE / delay_s;
}

/* White noise of the force makes a speed of 2 w noise / slope, which changes by sqrt(2) times that in a tick.
 * If this exceeds the highest acceleration, the loop lags. */
bool trajectory_force_stable(const trajectory *t, float noise_N) {
    const float jump_N_s = 1.414214f * 2.0f * t->force_w_s * noise_N;
    return t->stiffness_N_m * (FORCE_MOST_M_S2 * TICK_S) >= jump_N_s &&
           t->stiffness_N_m * FORCE_LINE_COUNTS * t->count_m <= CONTACT_FORCE_N;
}

/* The measured stiffness or the secant, whichever is more: a slope that is too small makes the loop too fast.
 */
float trajectory_slope(const trajectory *t) {
    const float depth = t->now.position_m, chord = depth > FORCE_SLOPE_M ? t->measured_N / depth : 0.0f;
    return chord > t->stiffness_N_m ? chord : t->stiffness_N_m;
}

bool trajectory_forces(const trajectory *t) {
    return t->current < t->count && t->list[t->current].kind == PALP_WIRE_SEGMENT_FORCE;
}

static float highest_speed_m_s(const trajectory *t) {
    return FORCE_MOST_M_S < t->force_most_m_s ? FORCE_MOST_M_S : t->force_most_m_s;
}

static bool is_far_below_wanted(const trajectory *t) {
    return t->smooth_N < FORCE_FAR * t->wanted_N;
}

/* Ramps the wanted force; true once it reached the target. The ramp, N/s, uses at most half of the plate's
 * highest speed and leaves the other half to the loop. Before contact is felt, only its threshold is wanted.
 */
static bool ramp_wanted_force(trajectory *t, const segment *s, float *rate_N_s) {
    const float touch_N = t->touch_N < s->target_N ? t->touch_N : s->target_N;
    const float fast_N_s = 0.5f * highest_speed_m_s(t) * trajectory_slope(t);
    const float most_N_s = s->rate_N_s < fast_N_s ? s->rate_N_s : fast_N_s;
    t->felt = t->felt || t->smooth_N >= FORCE_FAR * touch_N;
    const float step = most_N_s * TICK_S, way = (t->felt ? s->target_N : touch_N) - t->wanted_N;
    const bool there = real_abs(way) <= step;
    *rate_N_s = there ? 0.0f : way < 0.0f ? -most_N_s : most_N_s;
    t->wanted_N += there ? way : *rate_N_s * TICK_S;
    return there && t->felt;
}

static float larger(float x, float y) {
    return x > y ? x : y;
}

/* Sets a fault for lost contact, oscillation or a place that is too deep. */
static void watch_force(trajectory *t, const segment *s) {
    const float off_N = t->measured_N - t->wanted_N;
    const float count_N = FORCE_SWING_COUNTS * t->count_m * trajectory_slope(t);
    const float most_N = larger(FORCE_SWING * t->wanted_N, larger(t->touch_N, count_N));
    const int8_t side = off_N > most_N ? 1 : off_N < -most_N ? -1 : 0;
    const float period = 2.0f * REAL_PI / t->force_w_s * (float)CONTROL_HZ;
    t->far_ticks = t->felt && is_far_below_wanted(t) ? t->far_ticks + 1 : 0;
    t->swing_ticks++;
    if ((float)t->swing_ticks > FORCE_SWING_PERIODS * period)
        t->swings = 0;
    if (side != 0 && side != t->side) {
        t->side = side;
        t->swings++;
        t->swing_ticks = 0;
    }
    if ((float)t->far_ticks > FORCE_STEP / t->force_w_s * (float)CONTROL_HZ)
        t->fault = PALP_WIRE_FAULT_CONTACT_LOST;
    else if (t->swings >= FORCE_SWINGS)
        t->fault = PALP_WIRE_FAULT_FORCE_OSCILLATES;
    else if (t->now.position_m > s->deepest_m)
        t->fault = PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE;
}

static void move_at_speed(trajectory *t, float speed_m_s) {
    const float most = FORCE_MOST_M_S2 * TICK_S;
    const float change = real_clamp(speed_m_s - t->now.velocity_m_s, -most, most);
    t->now.acceleration_m_s2 = change / TICK_S;
    t->now.velocity_m_s += change;
    t->now.position_m += t->now.velocity_m_s * TICK_S;
}

/* Plate speed = (rate of the wanted force + PI of the force error) / slope. While the force is far too small
 * the speed is limited to that in air. Before contact the plate only approaches. */
static bool force_step(trajectory *t, const segment *s) {
    float rate_N_s = 0.0f;
    t->smooth_N += (t->measured_N - t->smooth_N) / FORCE_SMOOTH_TICKS;
    if (!t->wants)
        t->wanted_N = t->measured_N;
    t->wants = t->wants || t->now.position_m >= 0.0f || t->measured_N >= s->target_N;
    if (!t->wants) {
        move_at_speed(t, FORCE_AIR_M_S);
        return true;
    }
    if (ramp_wanted_force(t, s, &rate_N_s) && t->tick++ >= s->ticks) {
        t->now.velocity_m_s = t->now.acceleration_m_s2 = 0.0f;
        return false;
    }
    watch_force(t, s);
    const float off_N = t->wanted_N - t->measured_N, w = t->force_w_s, slope = trajectory_slope(t);
    const float asked = (rate_N_s + 2.0f * w * off_N + w * w * t->sum_Ns) / slope,
                most = highest_speed_m_s(t);
    const float slow = FORCE_AIR_M_S + real_abs(rate_N_s) / slope;
    const float speed = real_clamp(asked, -most, is_far_below_wanted(t) && slow < most ? slow : most);
    if (speed == asked)
        t->sum_Ns += off_N * TICK_S;
    move_at_speed(t, speed);
    return true;
}

static bool segment_step(trajectory *t, const segment *s) {
    switch (s->kind) {
    case PALP_WIRE_SEGMENT_MOVE:
        return stroke_step(&t->stroke, &t->now);
    case PALP_WIRE_SEGMENT_CYCLE:
        return cycle_step(t, s);
    case PALP_WIRE_SEGMENT_HOLD:
        return t->tick++ < s->ticks;
    case PALP_WIRE_SEGMENT_FORCE:
        return force_step(t, s);
    default:
        return wave_step(t, s);
    }
}

bool trajectory_step(trajectory *t, reference *next) {
    bool going = t->current < t->count;
    if (going && !segment_step(t, &t->list[t->current])) {
        going = ++t->current < t->count;
        if (going) {
            begin_segment(t);
            going = segment_step(t, &t->list[t->current]); /* every segment takes a tick at least */
        }
    }
    *next = t->now;
    return going;
}
