/* step_block.c: a press on a rigid block: the frame's compliance, and the motor's force. */
#include "calibrate_device.h"

#include <math.h>
#include <palpate/explain.h>
#include <stdlib.h>

static const char NAME[] = MACHINE_NAME;

enum { MEAN = 50 /* ticks of a point */, DOWN = 1, UP = 3 /* of the segments */ };

static const double FULL = 32767, SHARE = 0.4 /* of the highest force */, AIR_MM = 0.05, RAMP_S = 5,
                    HOLD_S = 1, BACK = 0.1;
static const double SOFT_N_M = 1e4;
static const double LOADED = 0.1, TURNED = 0.7; /* least share of the force; below it friction reverses */

static bool move(acquire_run *r, double to_mm, double seconds) {
    acquire_motion m = r->motion;
    m.rate_mm_s = fabs(to_mm - r->at_mm) / seconds;
    return acquire_segment_add(r, PALP_WIRE_SEGMENT_MOVE, to_mm, &m);
}

/* Presses slowly to a depth, not to a force: the depth follows from the slope at contact. */
static bool plan_press(acquire_plan *plan, double depth_mm) {
    char why[ACQUIRE_TEXT];
    acquire_motion m = acquire_motion_none();
    m.air_mm = AIR_MM;
    acquire_run *r = acquire_plan_add(plan, ACQUIRE_SEGMENTS, &m, "calibrate_block", why);
    r->motion.rest_s = 0;
    m = r->motion;
    m.hold_s = HOLD_S;
    return move(r, 0, HOLD_S) && move(r, depth_mm, RAMP_S) &&
           acquire_segment_add(r, PALP_WIRE_SEGMENT_HOLD, depth_mm, &m) && move(r, BACK * depth_mm, RAMP_S);
}

/* ---- force of the motor by its duty against the sensor, up and down apart ---- */

static bool motor_share(const session *s, const machine_trace *t, double force_N, double motor_N,
                        machine_figure c[3]) {
    const size_t points = t->n / MEAN;
    double(*x)[MACHINE_TERMS] = calloc(points + 1, sizeof *x), *y = calloc(points + 1, sizeof *y);
    double read = 0, given = 0;
    size_t n = 0, in = 0;
    unsigned last = 0;
    for (size_t i = 0; x && y && i < t->n && n < points; i++) {
        const machine_sample *one = &t->list[i];
        const unsigned part = one->flags >> 8;
        const double N = acquire_force_N(&s->scale, one->adc);
        if (!(one->flags & PALP_WIRE_FLAG_TRAJECTORY) || N < LOADED * force_N || N > TURNED * force_N ||
            (part != DOWN && part != UP) || part != last) {
            in = 0;
            read = given = 0;
            last = part;
            continue;
        }
        read += N / MEAN;
        given += motor_N / FULL * one->duty / MEAN;
        if (++in < MEAN)
            continue;
        x[n][0] = 1;
        x[n][1] = part == UP;
        x[n][2] = read;
        y[n++] = given;
        in = 0;
        read = given = 0;
    }
    const bool found = x && y && machine_fit(n, 3, x, y, 0, c, NULL);
    free(x);
    free(y);
    return found;
}

static int frame_of(const char *folder, palp_frame *frame) {
    char path[CLI_PATH_MAX];
    palp_error error = {PALP_OK, ""};
    palp_experiment *e = NULL;
    snprintf(path, sizeof path, "%.*s/calibrate_block.csv", (int)sizeof path - 32, folder);
    palp_status status = palp_experiment_read(path, &e, &error);
    const palp_explain_input run = {e, path};
    status = status ? status : palp_explain_frame(1, &run, frame, &error);
    palp_experiment_free(e);
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

static int keep(const machine_options *o, session *s, const machine_trace *trace, double force_N,
                const device_parameters *p, machine_result *result) {
    const double motor_N = device_parameter_value(p, "motor_N", 0);
    palp_frame frame;
    machine_figure c[3];
    int code = frame_of(o->setup.session.out, &frame);
    if (code)
        return code;
    if (!motor_share(s, trace, force_N, motor_N, c))
        return cli_failure(NAME, "the press was too short to measure the motor's force");
    const double share = c[2].value, half = motor_N * c[2].half / (share * share);
    machine_tell(result, "frame_mm_N", 1e3 * frame.compliance_m_N, 5e2 * (frame.high_m_N - frame.low_m_N),
                 "compliance of the frame");
    machine_tell(result, "motor_N", motor_N / share, half, "force of the motor at full duty, by the sensor");
    const machine_change change[] = {{device_parameter_find(p, "compliance_m_N", 0), frame.compliance_m_N},
                                     {device_parameter_find(p, "motor_N", 0), motor_N / share},
                                     {device_parameter_find(p, "calibration_day", 0), machine_today()}};
    return machine_change_all(o, &s->device, sizeof change / sizeof change[0], change);
}

static outcome press(const machine_options *o, session *s, double force_N, machine_trace *trace) {
    outcome end = session_make_ready(s);
    if (end)
        return end;
    const double stiffness_N_m = 1e-3 * s->device.status.stiffness_mN_m;
    if (!(stiffness_N_m > SOFT_N_M))
        return session_fail(s, "a stiffness of %.3g N/m is not that of a rigid block", stiffness_N_m);
    if (!plan_press(o->plan, 1e3 * force_N / stiffness_N_m))
        return session_fail(s, "the plate's travel is too short for the press on the block");
    end = session_check_run(s, &o->plan->run[0]);
    trace->on = true;
    return end ? end : session_run(s, 0);
}

int step_block(const machine_options *o, session *s) {
    machine_trace trace = {.on = false};
    machine_result result = {.step = "block"};
    device_parameters p;
    device_result read = device_parameters_read(&s->device, DEVICE_PARAMETERS, &p);
    if (read)
        return machine_failure(&s->device, read);
    const double force_N = o->force_N > 0 ? o->force_N : SHARE * device_parameter_value(&p, "force_N", 0);
    char prompt[160];
    o->plan->n = 0;
    snprintf(prompt, sizeof prompt,
             "Put a rigid block (steel, flat) under the plate, to be pressed with %.3g N, then press Enter.",
             force_N);
    if (!machine_ready_unless(o, prompt))
        return cli_failure(NAME, "cancelled: nothing is changed");
    s->watcher = (session_watcher){machine_trace_heard, NULL, NULL, &trace};
    int code = machine_ended(s, session_withdraw(s, press(o, s, force_N, &trace)));
    s->watcher = (session_watcher){NULL, NULL, NULL, NULL};
    code = code ? code : keep(o, s, &trace, force_N, &p, &result);
    machine_trace_free(&trace);
    return machine_finish(o, &result, code);
}
