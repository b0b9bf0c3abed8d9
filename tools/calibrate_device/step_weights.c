/* step_weights.c: known masses on the sensor: its sensitivity, sign, linearity and noise. */
#include "calibrate_device.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>

static const char NAME[] = MACHINE_NAME;

enum { STATIONS = 34 };

/* A larger change of the sensitivity by this factor is more often a wrong mass than a new sensor. */
static const double LARGE = 1.2;

static const double SETTLE_S = 0.5, STANDARD_GRAVITY = 9.80665, UNSEEN = 0.2;

/* Reading of the sensor with one mass. */
typedef struct station {
    double force_N, mean, sd, n;
    double read_N; /* by the matrix in use */
} station;

typedef struct weighing {
    const machine_options *o;
    session *s;
    machine_trace *trace;
    double used[PALP_WIRE_CHANNELS]; /* the row in use */
    double row[PALP_WIRE_CHANNELS];  /* weights of the counts: the matrix row, or one channel */
    size_t n;
    station station[STATIONS];
} weighing;

static double gravity(const machine_options *o) {
    return o->gravity_m_s2 > 0 ? o->gravity_m_s2 : STANDARD_GRAVITY;
}

/* Averages the samples: a reading is the weighted sum of counts. */
static outcome measure(weighing *w, station *at) {
    machine_trace *t = w->trace;
    double sum = 0, square = 0, used = 0;
    t->n = 0;
    outcome end = session_stream(w->s, true);
    end = end ? end : session_wait(w->s, SETTLE_S);
    t->on = end == GOES_ON;
    end = end ? end : session_wait(w->s, w->o->average_s);
    t->on = false;
    end = end ? end : session_stream(w->s, false);
    for (size_t i = 0; i < t->n; i++) {
        double y = 0;
        for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++) {
            y += w->row[c] * t->list[i].adc[c];
            used += w->used[c] * t->list[i].adc[c];
        }
        if (t->list[i].flags & PALP_WIRE_FLAG_SENSOR_BAD)
            return end ? end : session_fail(w->s, "the sensor gives no reading with %g N on it", at->force_N);
        sum += y;
        square += y * y;
    }
    at->n = (double)t->n;
    at->mean = sum / at->n;
    at->read_N = used / at->n;
    at->sd = sqrt(fmax(0, square / at->n - at->mean * at->mean));
    return end || t->n > 1 ? end : session_fail(w->s, "no samples arrived");
}

static outcome weigh(weighing *w, double mass_g) {
    char prompt[128];
    station *at = &w->station[w->n];
    at->force_N = (w->o->hanging ? -1e-3 : 1e-3) * mass_g * gravity(w->o);
    if (mass_g > 0)
        snprintf(prompt, sizeof prompt, "%s %g g %s the sensor, let it come to rest, then press Enter.",
                 w->o->hanging ? "Hang" : "Put", mass_g, w->o->hanging ? "below" : "on");
    else
        snprintf(prompt, sizeof prompt, "Take everything off the sensor, then press Enter.");
    if (!machine_ready(prompt))
        return session_fail(w->s, "cancelled: nothing is changed");
    outcome end = measure(w, at);
    if (end == GOES_ON)
        fprintf(stderr, "  reads %.6g, noise %.2g\n", at->mean, at->sd);
    w->n++;
    return end;
}

static outcome weigh_all(weighing *w) {
    const cli_list *masses = &w->o->weights_g;
    outcome end = weigh(w, 0);
    for (size_t i = 0; i < masses->n && end == GOES_ON; i++)
        end = weigh(w, masses->value[i]);
    return end ? end : weigh(w, 0);
}

typedef struct weighed {
    machine_figure zero, slope; /* reading = zero + slope * force */
    double linearity_percent, noise_N, drift_N;
} weighed;

static bool fit(const weighing *w, weighed *r) {
    double x[STATIONS][MACHINE_TERMS], y[STATIONS], off[STATIONS], mean_sd = 0, sd = 0, largest = 0, most = 0;
    machine_figure c[2];
    for (size_t i = 0; i < w->n; i++) {
        const station *at = &w->station[i];
        x[i][0] = 1;
        x[i][1] = at->force_N;
        y[i] = at->mean;
        sd = fmax(sd, at->sd);
        mean_sd = fmax(mean_sd, at->sd / sqrt(at->n));
        largest = fmax(largest, fabs(at->force_N));
    }
    if (!machine_fit(w->n, 2, x, y, mean_sd, c, off))
        return false;
    for (size_t i = 0; i < w->n; i++)
        most = fmax(most, fabs(off[i]));
    const double slope = fabs(c[1].value);
    *r = (weighed){c[0], c[1], 100 * most / (slope * largest), sd / slope,
                   (w->station[w->n - 1].mean - w->station[0].mean) / c[1].value};
    return slope > 0 && c[1].half < UNSEEN * slope;
}

/* Reading of the largest mass by the matrix in use, relative to its weight. A wrong mass changes only this;
 * the line stays straight. */
static int check_change(const weighing *w) {
    const station *most = w->station;
    for (size_t i = 1; i < w->n; i++)
        most = fabs(w->station[i].force_N) > fabs(most->force_N) ? &w->station[i] : most;
    const double ratio = (most->read_N - w->station[0].read_N) / most->force_N;
    if ((ratio > 1 / LARGE && ratio < LARGE) || w->o->large_change)
        return CLI_OK;
    cli_warning(NAME, "the calibration in use reads %.4g N as %.4g N, which is more than 20 %% off",
                most->force_N, ratio * most->force_N);
    if (w->o->yes)
        return cli_failure(
            NAME, "nothing is changed: check the masses; --large-change accepts the new sensitivity");
    return machine_agrees(w->o, "Are the masses right, and shall the sensitivity change by so much?")
               ? CLI_OK
               : cli_failure(NAME, "nothing is changed");
}

/* The row in use divided by the slope, with its sign. */
static int keep(const weighing *w, const weighed *r, const device_parameters *p) {
    machine_change change[PALP_WIRE_CHANNELS + 3];
    size_t n = 0;
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++)
        change[n++] = (machine_change){device_parameter_find(p, "Fz_N", c), w->row[c] / r->slope.value};
    change[n++] = (machine_change){device_parameter_find(p, "noise_N", 0), r->noise_N};
    change[n++] = (machine_change){device_parameter_find(p, "sensitivity_sd", 0),
                                   r->slope.half / palp_student_95(w->n - 2) / fabs(r->slope.value)};
    change[n++] = (machine_change){device_parameter_find(p, "calibration_day", 0), machine_today()};
    const int code = check_change(w);
    return code ? code : machine_change_all(w->o, &w->s->device, n, change);
}

static void tell(const weighing *w, const weighed *r, machine_result *result) {
    machine_tell(result, w->o->channel ? "counts_N" : "reads_N_N", r->slope.value, r->slope.half,
                 w->o->channel ? "counts per newton" : "reading of one newton by the matrix in use");
    machine_tell(result, "zero", r->zero.value, r->zero.half, "reading without a mass");
    machine_tell(result, "linearity_percent", r->linearity_percent, NAN,
                 "largest deviation from a line, relative to the largest force");
    machine_tell(result, "drift_N", r->drift_N, NAN, "drift of the zero from the first reading to the last");
    machine_tell(result, "noise_N", r->noise_N, NAN, "standard deviation of a sample");
}

int step_weights(const machine_options *o, session *s) {
    machine_trace trace = {.on = false};
    device_parameters p;
    weighed r;
    weighing w = {.o = o, .s = s, .trace = &trace};
    machine_result result = {.step = "weights"};
    if (o->weights_g.n < 2)
        return cli_usage_error(NAME, "give two masses or more by --weights-g 50,100,200");
    int code = machine_idle(&s->device);
    device_result read = code ? DEVICE_OK : device_parameters_read(&s->device, DEVICE_PARAMETERS, &p);
    if (code || read)
        return code ? code : machine_failure(&s->device, read);
    for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++) {
        w.used[c] = device_parameter_value(&p, "Fz_N", c);
        w.row[c] = o->channel ? c + 1 == o->channel : w.used[c];
    }
    s->watcher = (session_watcher){machine_trace_heard, NULL, NULL, &trace};
    code = machine_ended(s, weigh_all(&w));
    s->watcher = (session_watcher){NULL, NULL, NULL, NULL};
    machine_trace_free(&trace);
    if (code)
        return code;
    if (!fit(&w, &r))
        return cli_failure(NAME, "the sensor's reading does not change with the masses");
    tell(&w, &r, &result);
    if (r.slope.value < 0 && !o->channel)
        cli_warning(NAME, "the force has the wrong sign, which is corrected");
    code = keep(&w, &r, &p);
    return machine_finish(o, &result, code);
}
