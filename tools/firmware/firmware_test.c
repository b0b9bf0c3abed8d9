/* firmware_test.c: the self-test: the sensor at rest, homing and motion, each with a verdict. */
#include "firmware_test.h"

#include "shared/cli.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { REST_SAMPLES = 1000 };
static const double HANG_S = 120; /* wall clock: no step takes so long */
static const double MOVE_MM = 3, MOVE_MM_S = 2;
static const double ROOM_MM = 5, TOUCH_NOISES = 5; /* free below home; force of a touch, in noise levels */
/* Thresholds, as shares of the device's own figures: its range of force, its limit of the following error. */
static const double NOISE_SHARE = 1e-3, ERROR_SHARE = 0.1, DUTY_MOST = 0.5;
static const double COLDEST_C = -10, HOTTEST_C = 60;

typedef struct figures {
    size_t n, bad, closed; /* samples; without a reading; with the home switch closed */
    double mean[PALP_WIRE_CHANNELS], square[PALP_WIRE_CHANNELS], force_square, force_mean;
    int16_t low[PALP_WIRE_CHANNELS], high[PALP_WIRE_CHANNELS];
    double error_square, duty_most;
    int32_t deepest;
} figures;

typedef struct self_test {
    const char *name;
    device *device;
    double row_N[PALP_WIRE_CHANNELS], following_mm;
    figures now; /* since begin() */
    json_t *checks;
    bool all_good;
} self_test;

static void take(self_test *t, const palp_wire_samples *b, size_t i) {
    figures *f = &t->now;
    const int16_t *adc = &b->adc[i * PALP_WIRE_CHANNELS];
    double force_N = 0;
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++) {
        f->low[c] = f->n == 0 || adc[c] < f->low[c] ? adc[c] : f->low[c];
        f->high[c] = f->n == 0 || adc[c] > f->high[c] ? adc[c] : f->high[c];
        force_N += t->row_N[c] * adc[c];
    }
    f->n++;
    const double off = force_N - f->force_mean;
    f->force_mean += off / (double)f->n;
    f->force_square += off * (force_N - f->force_mean);
    f->bad += (b->flags[i] & PALP_WIRE_FLAG_SENSOR_BAD) != 0;
    f->closed += (b->flags[i] & PALP_WIRE_FLAG_HOME_SWITCH) != 0;
    f->error_square += (double)b->error[i] * b->error[i];
    f->deepest = f->n == 1 || b->position[i] > f->deepest ? b->position[i] : f->deepest;
    f->duty_most = fmax(f->duty_most, fabs(b->duty[i] / 32767.0));
}

static void hear(const palp_wire_message *m, unsigned lost_frames, void *context) {
    (void)lost_frames;
    for (size_t i = 0; m->type == PALP_WIRE_TYPE_SAMPLES && i < m->as.samples.count; i++)
        take(context, &m->as.samples, i);
}

static void begin(self_test *t) {
    t->now = (figures){.n = 0};
}

static void judge(self_test *t, const char *what, double value, const char *unit, bool good,
                  const char *advice) {
    json_array_append_new(t->checks,
                          json_pack("{ss so ss sb ss}", "check", what, "value", json_number_or_null(value),
                                    "unit", unit, "good", good, "advice", good ? "" : advice));
    t->all_good = t->all_good && good;
}

static double noise_N(const figures *f) {
    return f->n > 1 ? sqrt(f->force_square / (double)(f->n - 1)) : NAN;
}

/* How many channels that enter the force never change. */
static size_t dead_channels(const self_test *t) {
    size_t n = 0;
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++)
        n += t->row_N[c] != 0 && t->now.low[c] == t->now.high[c];
    return n;
}

static void judge_rest(self_test *t) {
    const double case_C = 1e-2 * t->device->status.case_cC, range_N = 1e-6 * t->device->info.force_uN;
    judge(t, "samples without a reading", (double)t->now.bad, "", t->now.bad == 0,
          "the converter does not answer, or a channel is at its rail: see its wires");
    judge(t, "channels that never change", (double)dead_channels(t), "", dead_channels(t) == 0,
          "pull each gauge's wire in turn: its channel is not connected");
    judge(t, "noise of the force", noise_N(&t->now), "N", noise_N(&t->now) < NOISE_SHARE * range_N,
          "see grounds and shields; is something touching the plate?");
    judge(t, "case of the motor", case_C, "C", case_C > COLDEST_C && case_C < HOTTEST_C,
          "see the thermistor's wires and divider");
}

static void judge_motion(self_test *t, double way_mm) {
    const double count_mm = 1e-9 * t->device->info.count_pm,
                 error_mm = count_mm * sqrt(t->now.error_square / fmax((double)t->now.n, 1));
    judge(t, "home switch closed away from home", (double)t->now.closed, "samples", t->now.closed == 0,
          "it sticks, or its wire is open");
    judge(t, "way by the encoder", way_mm, "mm", fabs(way_mm - MOVE_MM) < 0.02,
          "see the encoder's wires and its interpolator");
    judge(t, "error on the way", error_mm, "mm", error_mm < ERROR_SHARE * t->following_mm,
          "friction, or gains of another machine");
    judge(t, "largest share of the motor's force", t->now.duty_most, "", t->now.duty_most < DUTY_MOST,
          "something holds the carriage, or coil, driver or supply are not what the parameters say");
}

static void judge_line(self_test *t) {
    const palp_wire_status *s = &t->device->status;
    const double damaged = s->bad_frames + (double)t->device->lost_frames;
    judge(t, "damaged frames", damaged, "", damaged == 0, "see the serial cable, its length and its ground");
    judge(t, "missed ticks", s->missed_ticks, "", s->missed_ticks == 0,
          "the processor does too much: see tick_cost of status");
}

static bool moves(const self_test *t) {
    const uint8_t s = t->device->status.state;
    return s == PALP_WIRE_STATE_HOMING || s == PALP_WIRE_STATE_APPROACH || s == PALP_WIRE_STATE_JOG ||
           s == PALP_WIRE_STATE_RETRACT;
}

static device_result settle(self_test *t, device_result result) {
    const double until_s = link_now_s() + HANG_S;
    do {
        result = result ? result : device_status(t->device);
    } while (!result && moves(t) && link_now_s() < until_s);
    return result;
}

static device_result rest(self_test *t) {
    const double until_s = link_now_s() + HANG_S;
    device_result result = DEVICE_OK;
    begin(t);
    while (!result && t->now.n < REST_SAMPLES && link_now_s() < until_s)
        result = device_status(t->device);
    return result;
}

static device_result jog(self_test *t, double to_mm) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_JOG,
                           .as.jog = {(int32_t)lrint(1e6 * to_mm), (uint32_t)lrint(1e6 * MOVE_MM_S)}};
    return settle(t, device_command(t->device, &m, NULL));
}

static double place_mm(const self_test *t) {
    return 1e-9 * t->device->info.count_pm * t->device->status.position;
}

/* Down until something is touched; the search withdraws by itself. *clear: nothing was. */
static device_result seek_obstacle(self_test *t, double noise, bool *clear) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_FIND_CONTACT};
    m.as.find_contact.rate_nm_s = (uint32_t)lrint(1e6 * MOVE_MM_S);
    m.as.find_contact.force_uN = (int32_t)lrint(1e6 * TOUCH_NOISES * noise);
    m.as.find_contact.travel_nm = (int32_t)lrint(1e6 * (ROOM_MM - place_mm(t)));
    begin(t);
    const device_result result = settle(t, device_command(t->device, &m, NULL));
    const double deepest_mm = 1e-9 * t->device->info.count_pm * t->now.deepest;
    *clear = !result && !t->device->status.contact_known && deepest_mm > ROOM_MM - 0.1;
    judge(t, "free way below home", deepest_mm, "mm", *clear,
          "take away what is under the plate: it was touched, and the plate has withdrawn");
    return result;
}

static device_result move(self_test *t) {
    const double noise = noise_N(&t->now);
    bool clear;
    device_result result = settle(t, device_do(t->device, PALP_WIRE_TYPE_HOME, NULL));
    judge(t, "home", result || !t->device->status.homed ? 0 : 1, "found", !result && t->device->status.homed,
          "see the home switch and the motor's leads");
    if (result || !t->all_good) /* a bad sensor would not feel a specimen */
        return result;
    result = seek_obstacle(t, noise, &clear);
    if (result || !clear)
        return result;
    const double from_mm = place_mm(t);
    begin(t);
    result = jog(t, from_mm + MOVE_MM);
    const double to_mm = place_mm(t);
    result = result ? result : jog(t, from_mm);
    judge_motion(t, to_mm - from_mm);
    return result;
}

static device_result read_limits(self_test *t) {
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_LIMITS}, got = {0};
    const device_result result = device_command(t->device, &ask, &got);
    t->following_mm = 1e-6 * got.as.limits_now.following_nm;
    return result;
}

static device_result read_row(self_test *t) {
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_CALIBRATION,
                             .as.get_calibration = {.axis = DEVICE_AXIS_Z}},
                      got = {0};
    const device_result result = device_command(t->device, &ask, &got);
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++)
        t->row_N[c] = 1e-9 * got.as.calibration.row[c];
    return result;
}

static device_result run(self_test *t) {
    palp_wire_message on = {.type = PALP_WIRE_TYPE_STREAM, .as.stream = {1}},
                      off = {.type = PALP_WIRE_TYPE_STREAM};
    device_result result = read_row(t);
    result = result ? result : read_limits(t);
    result = result ? result : device_command(t->device, &on, NULL);
    result = result ? result : rest(t);
    if (result)
        return result;
    judge_rest(t);
    result = move(t);
    judge_line(t);
    return result ? result : device_command(t->device, &off, NULL);
}

static void print(const self_test *t) {
    size_t i;
    json_t *check;
    json_array_foreach(t->checks, i, check) {
        const bool good = json_is_true(json_object_get(check, "good"));
        const char *advice = json_string_value(json_object_get(check, "advice"));
        printf("%-5s %-36s %.4g %s%s%s\n", good ? "good" : "BAD",
               json_string_value(json_object_get(check, "check")),
               json_number_value(json_object_get(check, "value")),
               json_string_value(json_object_get(check, "unit")), good ? "" : "; ", advice);
    }
}

int firmware_self_test(const char *name, device *d, bool json) {
    self_test t = {.name = name, .device = d, .checks = json_array(), .all_good = true};
    d->listener = hear;
    d->context = &t;
    const device_result result = run(&t);
    d->listener = NULL;
    int code = CLI_OK;
    if (json)
        code = json_print(name, json_pack("{sb sO}", "good", t.all_good && !result, "checks", t.checks));
    else
        print(&t);
    json_decref(t.checks);
    if (d->status.state == PALP_WIRE_STATE_FAULT)
        return CLI_DEVICE_FAULT;
    if (result)
        return cli_failure(name, "%s", d->why);
    return code || t.all_good ? code : cli_failure(name, "the self-test found what is not as it should be");
}
