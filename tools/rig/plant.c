/* plant.c: the simulated indenter as a whole: a tick under the firmware's output. */
#include "plant_internal.h"
#include "plant_specimen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SUBSTEPS = 20, JUMP_COUNTS = 5000 };
static const double TICK = 1e-3, HOT_C = 120, DUTY_FULL = 32767;
static const double SHAKEN = 0.5, SHAKEN_HZ = 5, PI = 3.14159265358979323846;
static const double OBSTACLE = 0.98; /* of the sensor's range: over every limit, but below saturation */

struct plant {
    plant_settings settings;
    drive drive;
    sensor sensor;
    specimen specimen;
    double plate_m;        /* of the plate from the home switch, for a stiff frame */
    double push_m_s2;      /* acceleration of the carriage, mean of the last tick, within which it jumps */
    double zero_m;         /* where the encoder counts from */
    double put_N;          /* a weight on the sensor */
    int32_t jumped;        /* counts */
    int32_t counted;       /* when the encoder lost its signal */
    int32_t place;         /* of a stepper, counts: steps it was given, whether it followed or not */
    bool said;             /* its sensor has a new sample */
    uint32_t tick, faults; /* bits 1 << plant_fault */
};

plant_settings plant_settings_default(void) {
    return (plant_settings){.actuator = plant_actuator_default(),
                            .sensor = {.noise_N = 2e-3, .gain = 1, .seed = 1},
                            .specimen = PLANT_MODEL,
                            .scale = 1,
                            .contact_m = 0.012,
                            .rigid_N_m = 1e6};
}

palp_status plant_create(const plant_settings *settings, plant **made, palp_error *error) {
    *made = NULL;
    plant *p = calloc(1, sizeof *p);
    if (!p)
        return plant_fail(error, PALP_ERR_NO_MEMORY, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    p->settings = *settings;
    p->drive = drive_start(&settings->actuator);
    p->plate_m = p->zero_m = settings->actuator.start_m;
    palp_error why = {PALP_OK, ""};
    palp_status status = specimen_create(settings, &p->specimen, &why);
    plant_sensor amplifier = settings->sensor;
    if (p->specimen.range_N > 0 && !(amplifier.range_N > 0 && amplifier.range_N < p->specimen.range_N))
        amplifier.range_N = p->specimen.range_N;
    if (status == PALP_OK && !sensor_start(&amplifier, &p->sensor))
        status = plant_fail(&why, PALP_ERR_SINGULAR, "the sensor's matrix has no inverse");
    if (status) {
        plant_free(p);
        return plant_fail(error, status, "%s", why.text[0] ? why.text : palp_status_text(status));
    }
    *made = p;
    return PALP_OK;
}

void plant_free(plant *p) {
    if (p) {
        specimen_free(&p->specimen);
        free(p);
    }
}

static bool has(const plant *p, plant_fault fault) {
    return (p->faults & (1u << fault)) != 0;
}

static bool stepped(const plant *p) {
    return p->settings.machine != PLANT_VOICE_COIL;
}

static int32_t counts(const plant *p) {
    if (stepped(p)) /* the count of its own steps, which never jumps */
        return p->place;
    return (int32_t)floor((p->drive.carriage_m - p->zero_m) / p->settings.actuator.count_m) + p->jumped;
}

/* What holds the carriage, if anything. */
static void hold(plant *p) {
    p->drive.hold = has(p, PLANT_PUSHED) ? DRIVE_DRAGGED : has(p, PLANT_JAMMED) ? DRIVE_JAMMED : DRIVE_FREE;
}

void plant_inject(plant *p, plant_fault fault) {
    p->faults |= 1u << fault;
    if (fault == PLANT_HOT)
        p->drive.winding_C = p->drive.case_C = HOT_C;
    if (fault == PLANT_JUMP)
        p->jumped += JUMP_COUNTS;
    if (fault == PLANT_ENCODER)
        p->counted = counts(p);
    hold(p);
}

void plant_lift(plant *p, plant_fault fault) {
    p->faults &= ~(1u << fault);
    hold(p);
}

void plant_put(plant *p, double force_N) {
    p->put_N = force_N;
}

static double reach(const plant *p) {
    return p->plate_m - p->settings.contact_m;
}

/* Of the specimen on the plate. */
static double load(const plant *p) {
    return has(p, PLANT_GONE) ? 0 : p->specimen.force_N;
}

/* The plate within its play below the carriage: friction holds it, a larger force pushes it against the
 * carriage. */
static void follow(plant *p) {
    const plant_actuator *a = &p->settings.actuator;
    double low = p->drive.carriage_m, high = low - a->backlash_m;
    p->plate_m = load(p) > a->coulomb_N ? high : fmin(fmax(p->plate_m, high), low);
}

/* The force by the model's sensor, or limited by the amplifier. */
static double read_force(const plant *p) {
    const palp_specimen_motion motion = {TICK * p->tick, p->drive.carriage_m - p->settings.contact_m,
                                         p->drive.velocity_m_s, p->push_m_s2};
    double read_N = (has(p, PLANT_GONE) ? 0 : specimen_sense(&p->specimen, &motion)) + p->put_N;
    read_N *= has(p, PLANT_SHAKEN) ? 1 + SHAKEN * sin(2 * PI * SHAKEN_HZ * motion.time_s) : 1;
    return has(p, PLANT_OBSTACLE) ? fmax(read_N, OBSTACLE * sensor_range(&p->sensor)) : read_N;
}

static void sense(const plant *p, plant_in *in) {
    double read_N = read_force(p);
    memset(in, 0, sizeof *in);
    in->tick = p->tick;
    in->position = has(p, PLANT_ENCODER) ? p->counted : counts(p);
    in->thermistor = sensor_thermistor(p->drive.case_C);
    in->switches = (uint8_t)((p->drive.carriage_m <= 0 ? PLANT_SWITCH_HOME : 0) |
                             (has(p, PLANT_EMERGENCY) ? PLANT_SWITCH_EMERGENCY : 0) |
                             (has(p, PLANT_ENCODER) ? PLANT_ENCODER_LOST : 0) |
                             (has(p, PLANT_DRIVER) ? PLANT_DRIVER_FAULT : 0) |
                             (has(p, PLANT_SILENT) ? PLANT_SENSOR_SILENT : 0));
    in->machine = p->settings.machine;
    if (stepped(p)) {
        in->adc[0] = p->sensor.held;
        in->switches |= p->said ? 0 : PLANT_FORCE_HELD;
    } else if (!has(p, PLANT_SILENT)) {
        sensor_convert(&p->sensor, read_N, p->tick, in->adc);
    }
    if (has(p, PLANT_SATURATED))
        in->adc[0] = INT16_MAX;
}

void plant_first(plant *p, plant_in *in) {
    p->zero_m = p->drive.carriage_m;
    p->jumped = p->place = 0;
    sense(p, in);
}

palp_status plant_step(plant *p, const plant_out *out, plant_in *in, palp_error *error) {
    const plant_actuator *a = &p->settings.actuator;
    const double dt = TICK / SUBSTEPS, volt = a->supply_V * fmax(out->duty, -DUTY_FULL) / DUTY_FULL;
    const uint8_t supply = has(p, PLANT_DRIVER) ? PLANT_MOTOR_OFF : out->motor;
    const double before_m_s = p->drive.velocity_m_s;
    const bool slow = p->specimen.slow, stepper = stepped(p);
    const double steps_m_s = out->motor == PLANT_MOTOR_ON ? (out->place - p->place) * a->count_m / TICK : 0;
    palp_status status = PALP_OK;
    for (int i = 1; i <= SUBSTEPS && status == PALP_OK; i++) {
        if (stepper)
            drive_step(a, &p->drive, steps_m_s, dt);
        else
            drive_advance(a, &p->drive, supply, volt, load(p), dt);
        follow(p);
        if (!slow || i == SUBSTEPS)
            status = specimen_advance(&p->specimen, reach(p), slow ? TICK : dt);
    }
    p->push_m_s2 = (p->drive.velocity_m_s - before_m_s) / TICK;
    p->tick++;
    p->place = out->motor == PLANT_MOTOR_ON ? out->place : p->place;
    p->said = stepper &&
              sensor_gather(&p->sensor, p->settings.machine == PLANT_STEPPER_FAST, read_force(p), p->tick);
    sense(p, in);
    return status ? plant_fail(error, status, "%s: %s at %.4g mm (%.4g s)", p->specimen.path,
                               palp_status_text(status), 1e3 * reach(p), TICK * p->tick)
                  : PALP_OK;
}

plant_truth plant_look(const plant *p) {
    return (plant_truth){.time_s = TICK * p->tick,
                         .carriage_m = p->drive.carriage_m,
                         .velocity_m_s = p->drive.velocity_m_s,
                         .depth_m = reach(p) - p->specimen.compliance_m_N * p->specimen.force_N,
                         .force_N = load(p),
                         .winding_C = p->drive.winding_C,
                         .case_C = p->drive.case_C,
                         .current_A = p->drive.current_A};
}
