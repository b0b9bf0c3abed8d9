/* app_bench.h: the whole app around the simulated indenter, in process, with a host of the test's own. */
#ifndef APP_BENCH_H
#define APP_BENCH_H

#include "app.h"
#include "rig/plant.h"

enum { BENCH_SAMPLES = 200000 };

typedef struct bench {
    app app;
    plant *plant;
    plant_in in;
    app_inputs inputs; /* of the last tick */
    app_outputs out;
    /* What goes wrong with the next tick, and only with it. */
    bool smashed, pulse; /* pulse: at the trigger's input */
    uint32_t missed;
    /* What goes wrong until it is set right, beside the plant's own. */
    bool unplugged, no_thermistor, switch_stuck;
    int16_t level; /* of all six channels while unplugged */
    /* The host. */
    bool mute;    /* sends no ALIVE */
    bool stalled; /* reads nothing */
    uint16_t sequence;
    palp_wire_decoder decoder;
    palp_wire_message frame[256]; /* all but SAMPLES since the last bench_command */
    size_t n_frames;
    uint32_t statuses;       /* STATUS frames since the beginning */
    uint16_t next_frame;     /* number of the next from the device */
    uint32_t damaged, lost;  /* frames missing or bad; samples that the device says it dropped */
    palp_wire_status status; /* newest */
    sample *sample;          /* all that came */
    uint8_t *state;          /* of each */
    size_t n_samples;
} bench;

/* NULL: the plant's defaults. All fail the running test on an error. */
void bench_open(bench *b, const plant_settings *settings);
void bench_close(bench *b);
void bench_restart(bench *b, uint8_t reset_cause, uint8_t failed); /* of the firmware; the plant goes on */

/* One tick of the device. */
void bench_tick(bench *b);
void bench_run(bench *b, uint32_t ticks);
/* Ticks until the state is entered. */
uint32_t bench_until(bench *b, uint8_t state, uint32_t at_most);

void bench_send(bench *b, const palp_wire_message *command); /* as it is, before the next tick */
/* Sends a command and runs the tick that takes it; the result. */
uint8_t bench_command(bench *b, palp_wire_message *command);
uint8_t bench_simple(bench *b, uint8_t type); /* one without parameters that matter */
void bench_accepted(bench *b, palp_wire_message *command);
/* The first frame of a type among those of the last command; fails where there is none. */
const palp_wire_message *bench_answer(const bench *b, uint8_t type);

/* Commands with parameters. */
palp_wire_message bench_find_contact(double rate_mm_s, double travel_mm);
palp_wire_message bench_move(uint8_t index, double to_mm, double rate_mm_s);
palp_wire_message bench_force(uint8_t index, double newton, double rate_N_s, uint32_t ms);
palp_wire_message bench_hold(uint8_t index, uint32_t ms);
palp_wire_message bench_start(uint8_t segments, double start_mm, uint32_t air_ms, uint32_t after_ms);
palp_wire_message bench_limits(palp_wire_limits limits);
palp_wire_message bench_stream(bool on);

void bench_near(double got, double wanted, double tolerance);

/* Into READY: homed; and with contact known. */
void bench_home(bench *b);
void bench_contact(bench *b);

#endif
