/* step_gains.c: a sweep in the air above the specimen: mass, drag and friction of the drive, and the gains
 * that follow from them. */
#include "calibrate_device.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = MACHINE_NAME;

enum {
    WIDTH = 8 /* half-width of the triangular mean of all signals, ticks */,
    STEP = 8 /* ticks between points */,
    CLASSES = 6,
    TERMS = 4,
    PARTS = 8
};

static const double FULL = 32767, AIR_MM = 4, AMPLITUDE_MM = 0.5, FROM_HZ = 2, TO_HZ = 20, SWEEP_S = 10;
static const double EQUATIONS =
    0.005; /* systematic error: delays within a tick, friction that varies with speed */
static const double ONE_WAY = 0.999, WORSE = 1.2;

/* force = mass * acceleration + drag * velocity + friction * sign(velocity) + lift */
typedef struct drive {
    machine_figure mass_kg, drag_Ns_m, friction_N, lift_N;
    double error_um; /* rms of the control error */
} drive;

static bool plan_sweep(acquire_plan *plan) {
    char why[ACQUIRE_TEXT];
    acquire_motion m = acquire_motion_none();
    m.air_mm = AIR_MM;
    plan->n = 0;
    acquire_run *r = acquire_plan_add(plan, ACQUIRE_SEGMENTS, &m, "calibrate_gains", why);
    m = r->motion;
    m.frequency_Hz = FROM_HZ;
    m.frequency_end_Hz = TO_HZ;
    m.duration_s = SWEEP_S;
    r->motion.rest_s = 0;
    return acquire_segment_add(r, PALP_WIRE_SEGMENT_SWEEP, AMPLITUDE_MM, &m);
}

static int sweep(session *s, machine_trace *trace) {
    trace->n = 0;
    outcome end = session_make_ready(s);
    trace->on = true;
    end = end ? end : session_run(s, 0);
    trace->on = false;
    return machine_ended(s, session_withdraw(s, end));
}

typedef struct signals {
    const machine_sample *list;
    size_t n;
    double count_m, tick_s, motor_N;
} signals;

static double place(const signals *g, size_t i) {
    return g->count_m * g->list[i].position;
}

/* Central difference, since an output is constant within a tick. */
static double force_at(const signals *g, size_t i) {
    return 0.5 * g->motor_N / FULL * (g->list[i].duty + g->list[i - 1].duty);
}

static double speed_at(const signals *g, size_t i) {
    return (place(g, i + 1) - place(g, i - 1)) / (2 * g->tick_s);
}

static double direction_at(const signals *g, size_t i) {
    const int32_t way = g->list[i + 1].position - g->list[i - 1].position;
    return way > 0 ? 1 : way < 0 ? -1 : 0;
}

/* All signals have the same triangular mean, with which a second difference over its width is the mean
 * acceleration. */
static void averaged(const signals *g, size_t i, double x[MACHINE_TERMS], double *force_N) {
    const double width_s = WIDTH * g->tick_s;
    x[0] = (place(g, i + WIDTH) - 2 * place(g, i) + place(g, i - WIDTH)) / (width_s * width_s);
    x[1] = x[2] = *force_N = 0;
    x[3] = 1;
    for (int j = 1 - WIDTH; j < WIDTH; j++) {
        const double weight = (double)(WIDTH - abs(j)) / (WIDTH * WIDTH);
        const size_t at = (size_t)((ptrdiff_t)i + j);
        x[1] += weight * speed_at(g, at);
        x[2] += weight * direction_at(g, at);
        *force_N += weight * force_at(g, at);
    }
}

/* The samples of the sweep, without gaps; their number. */
static size_t keep_sweep(machine_trace *t) {
    size_t n = 0;
    for (size_t i = 0; i < t->n; i++) {
        if (!(t->list[i].flags & PALP_WIRE_FLAG_TRAJECTORY))
            continue;
        if (n > 0 && t->list[i].tick != t->list[n - 1].tick + 1)
            n = 0;
        t->list[n++] = t->list[i];
    }
    return n;
}

typedef struct points {
    size_t n;
    double (*x)[MACHINE_TERMS], *y;
} points;

static bool make_points(const signals *g, points *p) {
    const size_t most = g->n / STEP + 1;
    *p = (points){0, calloc(most, sizeof *p->x), calloc(most, sizeof *p->y)};
    for (size_t i = 2 * WIDTH; p->x && p->y && i + 2 * WIDTH < g->n; i += STEP) {
        averaged(g, i, p->x[p->n], &p->y[p->n]);
        p->n += fabs(p->x[p->n][2]) > ONE_WAY; /* where the motion reverses, friction is undefined */
    }
    return p->x && p->y && p->n > 10 * PARTS;
}

/* Jackknife over parts of the sweep, which differ in frequency, so the interval includes errors of the model.
 */
static bool widen(const points *p, machine_figure c[TERMS]) {
    double square[TERMS] = {0};
    points some = {0, malloc(p->n * sizeof *p->x), malloc(p->n * sizeof *p->y)};
    bool good = some.x && some.y;
    for (size_t k = 0; k < PARTS && good; k++) {
        machine_figure without[TERMS];
        some.n = 0;
        for (size_t i = 0; i < p->n; i++)
            if (i * PARTS / p->n != k) {
                memcpy(some.x[some.n], p->x[i], sizeof *p->x);
                some.y[some.n++] = p->y[i];
            }
        good = machine_fit(some.n, TERMS, some.x, some.y, 0, without, NULL);
        for (size_t j = 0; j < TERMS && good; j++)
            square[j] += pow(without[j].value - c[j].value, 2) * (PARTS - 1) / PARTS;
    }
    for (size_t j = 0; j < TERMS; j++)
        c[j].half =
            hypot(fmax(c[j].half, palp_student_95(PARTS - 1) * sqrt(square[j])), EQUATIONS * c[j].value);
    free(some.x);
    free(some.y);
    return good;
}

static bool identify(const signals *g, drive *d) {
    machine_figure c[TERMS];
    points p;
    double square = 0;
    const bool found = make_points(g, &p) && machine_fit(p.n, TERMS, p.x, p.y, 0, c, NULL) && widen(&p, c);
    for (size_t i = 0; i < g->n; i++)
        square += pow(1e6 * g->count_m * g->list[i].error, 2);
    if (found)
        *d = (drive){c[0], c[1], c[2], c[3], sqrt(square / (double)g->n)};
    free(p.x);
    free(p.y);
    return found;
}

static int measure(session *s, machine_trace *trace, double motor_N, drive *d) {
    int code = sweep(s, trace);
    if (code)
        return code;
    const signals g = {trace->list, keep_sweep(trace), 1e-3 * s->scale.count_mm, s->scale.tick_s, motor_N};
    if (identify(&g, d))
        return CLI_OK;
    return cli_failure(
        NAME, "the sweep does not identify mass, drag and friction: it has %zu successive samples", g.n);
}

/* Three equal poles -w: w and the stiffness of the class follow from the gains in use; doc/control.md. */
static bool class_gains(const device_parameters *p, size_t k, const drive *d, machine_change change[3]) {
    const double old_kg = device_parameter_value(p, "moving_kg", 0), m = d->mass_kg.value;
    const double w = cbrt(device_parameter_value(p, "ki_N_ms", k) / old_kg);
    const double stiffness = 3 * old_kg * w * w - device_parameter_value(p, "kp_N_m", k);
    change[0] = (machine_change){device_parameter_find(p, "kp_N_m", k), 3 * m * w * w - stiffness};
    change[1] = (machine_change){device_parameter_find(p, "ki_N_ms", k), m * w * w * w};
    change[2] = (machine_change){device_parameter_find(p, "kd_Ns_m", k), 3 * m * w - d->drag_Ns_m.value};
    return change[0].value > 0 && change[2].value > 0;
}

static int keep(const machine_options *o, session *s, const device_parameters *p, const drive *d) {
    machine_change change[3 * CLASSES + 4];
    size_t n = 0;
    for (size_t k = 0; k < CLASSES; k++, n += 3)
        if (!class_gains(p, k, d, &change[n]))
            return cli_failure(
                NAME, "no stable gains of class %zu exist for so light a plate with so much drag", k);
    change[n++] = (machine_change){device_parameter_find(p, "moving_kg", 0), d->mass_kg.value};
    change[n++] =
        (machine_change){device_parameter_find(p, "motor_drag_Ns_m", 0), fmax(0, d->drag_Ns_m.value)};
    change[n++] = (machine_change){device_parameter_find(p, "friction_N", 0), fmax(0, d->friction_N.value)};
    change[n++] = (machine_change){device_parameter_find(p, "calibration_day", 0), machine_today()};
    return machine_change_all(o, &s->device, n, change);
}

static void tell(machine_result *r, const drive *d) {
    machine_tell(r, "moving_kg", d->mass_kg.value, d->mass_kg.half, "moving mass");
    machine_tell(r, "motor_drag_Ns_m", d->drag_Ns_m.value, d->drag_Ns_m.half, "drag, per m/s");
    machine_tell(r, "friction_N", d->friction_N.value, d->friction_N.half, "friction, at any speed");
    machine_tell(r, "error_um", d->error_um, NAN, "control error of the plate in the sweep, rms");
}

/* Repeats the sweep with the new values and gains. */
static int calibrate(const machine_options *o, session *s, machine_trace *trace, const device_parameters *p,
                     machine_result *result) {
    const double motor_N = device_parameter_value(p, "motor_N", 0);
    drive before, after;
    int code = measure(s, trace, motor_N, &before);
    if (code)
        return code;
    tell(result, &before);
    code = keep(o, s, p, &before);
    snprintf(o->plan->run[0].name, sizeof o->plan->run[0].name, "calibrate_gains_after");
    code = code ? code : measure(s, trace, motor_N, &after);
    if (code)
        return code;
    machine_tell(result, "error_after_um", after.error_um, NAN, "control error with the new gains");
    if (after.error_um > WORSE * before.error_um)
        cli_warning(NAME,
                    "the control error grew with the new gains; restore the old ones by load or standard");
    return CLI_OK;
}

int step_gains(const machine_options *o, session *s) {
    machine_trace trace = {.on = false};
    machine_result result = {.step = "gains"};
    device_parameters p;
    device_result read = device_parameters_read(&s->device, DEVICE_PARAMETERS, &p);
    if (read)
        return machine_failure(&s->device, read);
    if (!plan_sweep(o->plan))
        return cli_failure(NAME, "the plate's travel is too short for the sweep");
    if (!machine_ready_unless(
            o,
            "Put a soft specimen under the plate, 6 mm or more below home; the plate will touch it and then "
            "oscillate above it. Press Enter."))
        return cli_failure(NAME, "cancelled: nothing is changed");
    s->watcher = (session_watcher){machine_trace_heard, NULL, NULL, &trace};
    int code = calibrate(o, s, &trace, &p, &result);
    s->watcher = (session_watcher){NULL, NULL, NULL, NULL};
    machine_trace_free(&trace);
    return machine_finish(o, &result, code);
}
