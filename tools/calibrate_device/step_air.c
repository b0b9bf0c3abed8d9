/* step_air.c: the plate up and down in the air: friction, drag, balance and ripple of the drive, and the
 * sensor's noise. */
#include "calibrate_device.h"

#include <math.h>

static const char NAME[] = MACHINE_NAME;

enum {
    RATES = 3,
    REPEATS = 2,
    PASSES = RATES * REPEATS,
    BLOCK = 20 /* ticks of a mean; the ripple is the sd of these means */
};

static const double RATE_MM_S[RATES] = {2, 5, 10}, TOP_MM = 2, STROKE_MM = 10,
                    MARGIN = 0.2 /* share of the stroke left out at both ends */;
static const double FULL = 32767, REST_S = 1;

typedef struct airing {
    const machine_options *o;
    session *s;
    machine_trace *trace;
    double motor_N, low_mm, high_mm;
    size_t n; /* pairs of passes */
    double rate_m_s[PASSES], half_N[PASSES],
        mean_N[PASSES]; /* half the difference of down and up, and their mean */
    double ripple_N, noise_N;
} airing;

typedef struct pass {
    double force_N, speed_m_s, ripple_N;
} pass;

static outcome jog(session *s, double to_mm, double rate_mm_s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_JOG};
    m.as.jog =
        (palp_wire_jog){.to_nm = (int32_t)lrint(1e6 * to_mm), .rate_nm_s = (uint32_t)lrint(1e6 * rate_mm_s)};
    outcome end = session_order(s, &m, "jog");
    return end ? end : session_settle(s, 60);
}

/* In the middle of the stroke: mean force of the motor, and the sd of means of 20 ms. */
static bool middle(const airing *a, pass *p) {
    const machine_trace *t = a->trace;
    const double margin = MARGIN * (a->high_mm - a->low_mm), mm = a->s->scale.count_mm;
    double sum = 0, block = 0, blocks = 0, block_sum = 0, block_square = 0;
    size_t n = 0, first = 0, last = 0;
    for (size_t i = 0; i < t->n; i++) {
        const double at_mm = mm * t->list[i].position;
        if (t->list[i].state != PALP_WIRE_STATE_JOG || at_mm < a->low_mm + margin ||
            at_mm > a->high_mm - margin)
            continue;
        const double force_N = a->motor_N * t->list[i].duty / FULL;
        first = n ? first : i;
        last = i;
        sum += force_N;
        block += force_N;
        if (++n % BLOCK == 0) {
            blocks++;
            block_sum += block / BLOCK;
            block_square += block * block / (BLOCK * BLOCK);
            block = 0;
        }
    }
    if (blocks < 4)
        return false;
    *p = (pass){sum / (double)n,
                1e-3 * mm * (t->list[last].position - t->list[first].position) /
                    (a->s->scale.tick_s * (double)(t->list[last].tick - t->list[first].tick)),
                sqrt(fmax(0, block_square / blocks - block_sum * block_sum / (blocks * blocks)))};
    return true;
}

static outcome one_pass(airing *a, double to_mm, double rate_mm_s, pass *p) {
    a->trace->n = 0;
    a->trace->on = true;
    outcome end = jog(a->s, to_mm, rate_mm_s);
    a->trace->on = false;
    return end || middle(a, p) ? end : session_fail(a->s, "too few samples arrived at %g mm/s", rate_mm_s);
}

static outcome down_and_up(airing *a, double rate_mm_s) {
    pass down, up;
    outcome end = one_pass(a, a->high_mm, rate_mm_s, &down);
    end = end ? end : one_pass(a, a->low_mm, rate_mm_s, &up);
    if (end)
        return end;
    a->rate_m_s[a->n] = 0.5 * (down.speed_m_s - up.speed_m_s);
    a->half_N[a->n] = 0.5 * (down.force_N - up.force_N);
    a->mean_N[a->n++] = 0.5 * (down.force_N + up.force_N);
    a->ripple_N = fmax(a->ripple_N, fmax(down.ripple_N, up.ripple_N));
    return GOES_ON;
}

/* Noise of the force while the motor holds the plate. */
static outcome noise(airing *a) {
    double sum = 0, square = 0;
    a->trace->n = 0;
    a->trace->on = true;
    outcome end = session_wait(a->s, REST_S);
    a->trace->on = false;
    for (size_t i = 0; i < a->trace->n; i++) {
        const double y = acquire_force_N(&a->s->scale, a->trace->list[i].adc);
        sum += y;
        square += y * y;
    }
    const double n = (double)a->trace->n;
    a->noise_N = n > 1 ? sqrt(fmax(0, square / n - sum * sum / (n * n))) : 0;
    return end;
}

static outcome measure(airing *a) {
    session *s = a->s;
    outcome end = session_end_last(s);
    end = end ? end : session_configure(s);
    end = end ? end : session_home(s);
    end = end ? end : session_tare(s);
    snprintf(s->doing, sizeof s->doing, "moving in the air");
    end = end ? end : jog(s, a->low_mm, RATE_MM_S[RATES - 1]);
    for (size_t i = 0; i < PASSES && end == GOES_ON; i++)
        end = down_and_up(a, RATE_MM_S[i % RATES]);
    end = end ? end : noise(a);
    return session_withdraw(s, end);
}

static int keep(const airing *a, const device_parameters *p, machine_result *result) {
    double x[PASSES][MACHINE_TERMS], one[PASSES][MACHINE_TERMS];
    machine_figure line[2], lift;
    for (size_t i = 0; i < a->n; i++) {
        x[i][0] = one[i][0] = 1;
        x[i][1] = a->rate_m_s[i];
    }
    if (!machine_fit(a->n, 2, x, a->half_N, 0, line, NULL) ||
        !machine_fit(a->n, 1, one, a->mean_N, 0, &lift, NULL))
        return cli_failure(NAME, "the passes do not separate friction from drag");
    machine_tell(result, "friction_N", line[0].value, line[0].half, "friction of the drive, at any speed");
    machine_tell(result, "motor_drag_Ns_m", line[1].value, line[1].half,
                 "drag including the motor's, per m/s");
    machine_tell(result, "lift_N", lift.value, lift.half,
                 "excess of the counterbalance: above 0 the plate rises without current");
    machine_tell(result, "ripple_N", a->ripple_N, NAN,
                 "ripple of the motor's force at constant speed, means of 20 ms");
    machine_tell(result, "noise_N", a->noise_N, NAN, "noise of the sensor, standard deviation of a sample");
    const machine_change change[] = {{device_parameter_find(p, "friction_N", 0), fmax(0, line[0].value)},
                                     {device_parameter_find(p, "lift_N", 0), lift.value},
                                     {device_parameter_find(p, "ripple_N", 0), a->ripple_N},
                                     {device_parameter_find(p, "noise_N", 0), a->noise_N},
                                     {device_parameter_find(p, "calibration_day", 0), machine_today()}};
    return machine_change_all(a->o, &a->s->device, sizeof change / sizeof change[0], change);
}

int step_air(const machine_options *o, session *s) {
    machine_trace trace = {.on = false};
    machine_result result = {.step = "air"};
    device_parameters p;
    device_result read = device_parameters_read(&s->device, DEVICE_PARAMETERS, &p);
    if (read)
        return machine_failure(&s->device, read);
    airing a = {.o = o,
                .s = s,
                .trace = &trace,
                .motor_N = device_parameter_value(&p, "motor_N", 0),
                .low_mm = TOP_MM};
    a.high_mm = fmin(TOP_MM + STROKE_MM, 1e3 * device_parameter_value(&p, "travel_m", 0) - TOP_MM);
    char prompt[160];
    snprintf(prompt, sizeof prompt,
             "The plate will move: clear its way for %.0f mm below home, then press Enter.", a.high_mm + 1);
    if (!machine_ready_unless(o, prompt))
        return cli_failure(NAME, "cancelled: nothing is changed");
    s->watcher = (session_watcher){machine_trace_heard, NULL, NULL, &trace};
    int code = machine_ended(s, measure(&a));
    s->watcher = (session_watcher){NULL, NULL, NULL, NULL};
    machine_trace_free(&trace);
    if (code == CLI_OK)
        code = keep(&a, &p, &result);
    return machine_finish(o, &result, code);
}
