/* app.h: the whole firmware without registers: inputs of a tick to outputs of a tick. */
#ifndef APP_H
#define APP_H

#include "contact.h"
#include "force.h"
#include "machine.h"
#include "pid.h"
#include "store.h"
#include "stream.h"
#include "supervisor.h"
#include "thermal.h"

enum { FIRMWARE_MAJOR = 0, FIRMWARE_MINOR = 1, FIRMWARE_PATCH = 0 };

typedef struct app_inputs {
    int32_t position; /* encoder counts since power-on, positive towards the specimen */
    int16_t adc[PALP_WIRE_CHANNELS];
    uint16_t thermistor; /* 12-bit counts */
    bool sensor_silent, home_switch, emergency_stop;
    bool force_held;                 /* adc holds an earlier reading: the sensor has no new one */
    bool encoder_lost, driver_fault; /* their alarms */
    bool trigger;                    /* a pulse has come in since the last tick */
    bool stack_intact;
    uint32_t missed; /* ticks missed before this one */
    uint32_t cost;   /* of the last tick */
    uint16_t stack_free;
} app_inputs;

typedef struct app_outputs {
    int32_t place; /* of a stepper: its place at the next tick, in counts of position */
    int16_t duty;  /* 32767 = full force towards the specimen */
    bool motor_on; /* false: the board shorts the motor, which brakes it without current from the supply */
    bool trigger;  /* a pulse goes out until the next tick */
    bool stores;   /* a word must be programmed into the store's flash; never while the motor is on */
    uint32_t store_at, store_word;
} app_outputs;

/* Why the processor started; which parts failed to start, a bit each. */
enum { APP_RESET_POWER = 0, APP_RESET_WATCHDOG = 1, APP_RESET_STACK = 2, APP_RESET_BROWN_OUT = 3 };
enum { APP_CLOCK_FAILED = 1, APP_SENSOR_FAILED = 2, APP_ENCODER_FAILED = 4 };

/* The board's identity, for INFO. */
typedef struct app_identity {
    const char *board;
    uint32_t serial;
    bool simulated;
} app_identity;

enum { APP_TRANSMIT = 16384 }; /* bytes that wait for the host: 0.6 s of samples */

/* At most the machine's own. */
typedef struct app_limits {
    float force_N, travel_m, following_m, winding_C;
    uint16_t host_timeout_ms;
    uint16_t overflow_samples; /* lost in a run */
} app_limits;

/* What a calibration says besides the machine's own figures; 0 where it was not measured. */
typedef struct calibrated {
    float day;              /* of the last calibration, days since 1970-01-01 */
    float compliance_m_N;   /* of the frame */
    float noise_N;          /* sd of the force at rest */
    float sensitivity_sd;   /* relative, of the sensor's gain */
    float lift_N, ripple_N; /* of the drive: what its balance lifts, sd of its force at an even speed */
} calibrated;

typedef struct app {
    /* its figures in use, which SET_PARAMETER changes (app_parameters.c) */
    machine machine;
    const struct machine *standard; /* as it was compiled in */
    gains gains[GAINS_CLASSES];     /* softest first */
    calibrated calibrated;
    store store;
    uint32_t id;        /* of these and the sensor's matrix: their CRC-32 */
    uint32_t stored_id; /* of those in flash; 0 = none */
    app_identity identity;
    uint8_t unfit; /* APP_*_FAILED, what forbids to move; BOOT and FAULT are not left before it is none */
    app_limits limits;
    /* parts */
    supervisor supervisor;
    palp_wire_decoder decoder;
    stream stream;
    force_sensor force;
    thermal thermal;
    trajectory trajectory;
    pid pid;
    contact contact;
    /* what this tick sensed */
    app_inputs in;
    uint32_t tick, elapsed; /* now; ticks since the last that was not missed */
    float position_m, velocity_m_s, force_N;
    bool answering, saturated; /* the force sensor, in this tick */
    /* where it is */
    int32_t home, edge; /* counts; edge: of the switch, while homing */
    bool sensed, homed; /* sensed: there has been a tick */
    bool contact_known;
    uint8_t search; /* palp_wire_search: how the last one ended */
    float contact_m, stiffness_N_m;
    uint8_t softness; /* class of gains in use */
    bool softness_auto;
    /* the motion in progress */
    uint8_t phase;
    uint32_t phase_ticks;
    float from_m, back_m; /* where it began, where it withdraws to */
    float rate_m_s;
    uint32_t air_ticks, after_ticks;
    uint32_t segments_set; /* one bit each */
    palp_wire_trigger trigger;
    uint32_t pulse_ticks;  /* since the last pulse of a recording was due */
    bool recorded, pulsed; /* the last sample was of a recording; a pulse goes out with this one */
    reference reference;
    float duty;
    /* watches */
    uint32_t causes;                      /* one bit a fault: what is the case now */
    uint32_t signal_ticks, encoder_ticks; /* with the encoder's signal, without */
    uint32_t level_ticks;                 /* of a sensor all of whose channels say 0, or -1 */
    uint32_t silent_ticks, saturated_ticks, following_ticks, host_ticks, lost_at_start;
    uint32_t missed_ticks, cost_most;
    /* the host */
    bool command_seen, command_taken; /* ever; in this tick */
    uint16_t command_sequence;
    uint8_t command_type, command_result; /* a repeated command gets the same answer */
    uint8_t told_state;                   /* by the last status */
    uint32_t status_tick;                 /* of the last status */
    uint8_t transmit[APP_TRANSMIT];
} app;

/* reset_cause: APP_RESET_*; failed: APP_*_FAILED. Any reset but by power starts in FAULT. A board whose start
 * failed stays in BOOT or FAULT: for good without its crystal, otherwise until its encoder has a signal. */
void app_init(app *a, const machine *m, const app_identity *who, uint8_t reset_cause, uint8_t failed);
/* Takes the parameters of the last good record in flash. stored: its words (store.h), which must stay. To be
 * called after app_init and before the first tick. */
void app_load(app *a, const uint32_t *stored);
/* False: bytes from the host must wait for the next tick, which bounds the cost of a tick. */
bool app_listens(const app *a);
void app_receive(app *a, uint8_t byte);
void app_tick(app *a, const app_inputs *in, app_outputs *out);

#endif
