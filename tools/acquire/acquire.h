/* acquire.h: the parts of palpate acquire: the plan of runs, the recording on disk, the session. */
#ifndef PALPATE_ACQUIRE_H
#define PALPATE_ACQUIRE_H

#include "shared/cli.h"
#include "indenter/device_parameters.h"

#include <jansson.h>
#include <stdint.h>
#include <sys/types.h>

/* The device's least speed on the way back, and its speed to contact for a force; mm/s. */
enum { ACQUIRE_BACK_MM_S = 5, ACQUIRE_SEEK_MM_S = 1 };

enum { ACQUIRE_RUNS = 128, ACQUIRE_NAME = 96, ACQUIRE_TEXT = 512 };

/* ---- what the plate does (acquire_protocol.c, acquire_segments.c) ---- */

typedef enum acquire_kind {
    ACQUIRE_STATIC,
    ACQUIRE_RAMP_HOLD,
    ACQUIRE_CYCLIC,
    ACQUIRE_SINE,
    ACQUIRE_SWEEP,
    ACQUIRE_SEGMENTS,
    ACQUIRE_FREE, /* in the air */
    ACQUIRE_KINDS
} acquire_kind;

/* Parameters of a motion; NAN = not given. */
typedef struct acquire_motion {
    double depth_mm, rate_mm_s, ramp_s, hold_s, cycles;
    double amplitude_mm, frequency_Hz, frequency_end_Hz, duration_s; /* waves about the depth */
    double deepest_mm; /* largest depth of a force segment; by default the specimen's height, if known */
    double acceleration_mm_s2, air_mm, air_s, after_s, rest_s;
} acquire_motion;

/* X(name, kinds that have it, whether it may be 0, largest value). Files use this name. */
#define ACQUIRE_PRESSES (1 << ACQUIRE_STATIC | 1 << ACQUIRE_RAMP_HOLD | 1 << ACQUIRE_CYCLIC)
#define ACQUIRE_WAVES (1 << ACQUIRE_SINE | 1 << ACQUIRE_SWEEP)
#define ACQUIRE_ALL ((1 << ACQUIRE_KINDS) - 1)
#define ACQUIRE_FIGURES(X)                                                                                   \
    X(depth_mm, ACQUIRE_ALL & ~(1 << ACQUIRE_SEGMENTS), true, 1000)                                          \
    X(rate_mm_s, ACQUIRE_PRESSES | ACQUIRE_WAVES | 1 << ACQUIRE_FREE, false, 1000)                           \
    X(ramp_s, 1 << ACQUIRE_RAMP_HOLD | 1 << ACQUIRE_FREE, false, 1e6)                                        \
    X(hold_s, 1 << ACQUIRE_RAMP_HOLD | ACQUIRE_WAVES | 1 << ACQUIRE_FREE, true, 1e6)                         \
    X(cycles, 1 << ACQUIRE_CYCLIC | 1 << ACQUIRE_SINE, false, 65535)                                         \
    X(amplitude_mm, ACQUIRE_WAVES, false, 1000)                                                              \
    X(frequency_Hz, ACQUIRE_WAVES, false, 1000)                                                              \
    X(frequency_end_Hz, 1 << ACQUIRE_SWEEP, false, 1000)                                                     \
    X(duration_s, 1 << ACQUIRE_SWEEP, false, 1e6)                                                            \
    X(deepest_mm, 1 << ACQUIRE_SEGMENTS, false, 1000)                                                        \
    X(acceleration_mm_s2, ACQUIRE_ALL, false, 1e6)                                                           \
    X(air_mm, ACQUIRE_ALL, true, 1000)                                                                       \
    X(air_s, ACQUIRE_ALL, true, 1e6)                                                                         \
    X(after_s, ACQUIRE_ALL, true, 1e6)                                                                       \
    X(rest_s, ACQUIRE_ALL & ~(1 << ACQUIRE_FREE), true, 1e6)

/* One experiment. Depths count from contact. */
typedef struct acquire_run {
    acquire_kind kind;
    acquire_motion motion;                   /* complete; NAN for parameters that the kind does not have */
    char name[ACQUIRE_NAME];                 /* of the file, without .csv */
    bool repeat;                             /* of the first */
    bool smooth;                             /* ramps with continuous acceleration */
    double start_mm, highest_mm, deepest_mm; /* where the plate waits; highest place of the run */
    double at_mm, press_s;                   /* end of the segments; their duration */
    size_t n_segments;
    palp_wire_segment segment[PALP_WIRE_SEGMENTS];
} acquire_run;

typedef struct acquire_plan {
    size_t n;
    acquire_run run[ACQUIRE_RUNS];
    int random, repeat_first; /* of the presses; -1 = not given */
    bool smooth;              /* of the runs added from now on */
    double seed;              /* of the order; NAN = not given */
} acquire_plan;

acquire_motion acquire_motion_none(void);

/* Fills missing parameters from the next source; rate or ramp time only if both are missing. */
void acquire_motion_inherit(acquire_kind kind, acquire_motion *motion, const acquire_motion *from);
const char *acquire_kind_name(acquire_kind kind); /* "ramp_hold" */

/* Appends a run with its segments and fills in defaults. The caller adds the segments of ACQUIRE_SEGMENTS.
 * name: of the file; NULL: from kind and depth. Returns NULL on failure; why has the reason. */
acquire_run *acquire_plan_add(acquire_plan *plan, acquire_kind kind, const acquire_motion *motion,
                              const char *name, char why[ACQUIRE_TEXT]);

/* The 13 experiments of the thesis, and a recording of air before and after; defaults: hold_s and the like.
 */
bool acquire_plan_seed(acquire_plan *plan, const acquire_motion *defaults, char why[ACQUIRE_TEXT]);

/* Reads a protocol file; options come before its values for all runs. Returns an exit code. (acquire_read.c)
 */
int acquire_plan_read(acquire_plan *plan, const char *file, const acquire_motion *options);

/* Shuffles the presses by the plan's seed; runs in air keep their place. Repeats the first press at the end,
 * makes names unique and fills in the rests. False: no room for the repeated press. */
bool acquire_plan_arrange(acquire_plan *plan);

/* Appends a segment from the end of the last one (acquire_segments.c); false: there is no room. target:
 * depth, amplitude of waves, or force (N); motion has the other parameters. */
bool acquire_segment_add(acquire_run *run, uint8_t kind, double target_mm, const acquire_motion *motion);

/* Makes start and segments from kind and motion; of ACQUIRE_SEGMENTS only the start. */
void acquire_segments_make(acquire_run *run);
double acquire_run_length_s(const acquire_run *run); /* of the recording, with the withdrawal */

/* The plan in advance (acquire_path.c): the runs as lines of a table, or as JSON with their paths. A path has
 * points of time and depth, and of time and force for force segments. */
void acquire_plan_print(const acquire_plan *plan, FILE *to);
json_t *acquire_plan_json(const acquire_plan *plan);

/* ---- JSON with lines in its errors (acquire_json.c) ---- */

typedef struct acquire_json {
    const char *file;
    char *text;
    json_t *root;
} acquire_json;

/* Reads a file with {"palpate": {what: 1}}; an exit code. */
int acquire_json_open(const char *file, const char *what, acquire_json *json);
void acquire_json_close(acquire_json *json);
/* One line with file, line and name of a value such as "runs[2].hold_s"; returns the exit code. */
int acquire_json_fail(const acquire_json *json, const char *where, const char *format, ...);
/* The matrix rows of a sensor's calibration file: row[axis][channel] in nN (nNm) a count; given[axis]. */
int acquire_calibration_read(const char *file, int32_t row[PALP_WIRE_CHANNELS][PALP_WIRE_CHANNELS],
                             bool given[PALP_WIRE_CHANNELS]);

/* ---- the recording on disk (acquire_file.c) ---- */

/* Columns beside time, depth and force, a bit each. RAW: error, position and ADC counts, duty, flags. */
enum { ACQUIRE_RAW = 1, ACQUIRE_FORCES = 2, ACQUIRE_TEMPERATURE = 4, ACQUIRE_TRIGGER = 8 };
/* "forces,temperature" as bits; 0 = an unknown word. */
unsigned acquire_columns(const char *words);

/* From counts to seconds, millimetres and newtons. */
typedef struct acquire_scale {
    double tick_s, count_mm;
    int32_t contact; /* counts at depth 0 */
    double row_N[PALP_WIRE_CHANNELS], tare[PALP_WIRE_CHANNELS];
    double contact_N; /* force above that in air that counts as contact */
    double matrix[PALP_WIRE_CHANNELS]
                 [PALP_WIRE_CHANNELS]; /* of all axes, where ACQUIRE_FORCES asks for them */
} acquire_scale;

typedef struct acquire_sample {
    double time_s, depth_mm, force_N, error_mm;
} acquire_sample;

double acquire_force_N(const acquire_scale *scale, const int16_t adc[PALP_WIRE_CHANNELS]);

/* Figures of a recording. */
typedef struct acquire_figures {
    size_t samples, lost, bad; /* bad: without a reading of the sensor; treated as lost samples */
    double peak_N, deepest_mm, duration_s;
    double error_square, error_most_mm; /* reference minus position, in motion */
    size_t errors;
    double contact_mm; /* depth at which the force rose; NAN = it did not */
    double air_sum_N, mean_N, mean_mm;
    size_t air;
} acquire_figures;

enum { ACQUIRE_BUFFER = 65536 };

typedef struct acquire_file {
    int fd; /* -1 = none */
    char path[CLI_PATH_MAX];
    unsigned columns;
    bool started;
    acquire_scale scale;
    acquire_figures figures;
    uint32_t first_tick, last_tick;
    bool waits,
        over; /* samples came before those of the recording, the last at before_tick; and after them */
    uint32_t before_tick;
    bool in_session; /* an earlier recording exists; its first sample was at session_tick */
    uint32_t session_tick;
    double start_s;      /* of this recording since then */
    acquire_sample last; /* the newest sample */
    off_t at;            /* bytes written */
    int error;           /* errno of a failed write; nothing more is written after it */
    double written_s;    /* wall clock */
    size_t n;
    char text[ACQUIRE_BUFFER];
} acquire_file;

/* Creates the file with its header (an object), marked as interrupted until it is closed. *file is zero
 * before the first recording of a session. now_tick: of the device. Returns an exit code; an existing file is
 * kept unless force. */
int acquire_file_open(acquire_file *file, const char *path, bool force, unsigned columns,
                      const acquire_scale *scale, uint32_t now_tick, json_t *header);
/* Adds the samples that belong to the recording; returns their number. */
size_t acquire_file_add(acquire_file *file, const palp_wire_samples *block);
void acquire_file_keep(acquire_file *file); /* writes rows older than half a second */
/* fault: why the run ended early, or NULL; winding_C: NAN = not known. Returns an exit code. */
int acquire_file_close(acquire_file *file, const char *fault, double winding_C);
void acquire_file_remove(acquire_file *file); /* instead of close, if no samples arrived */
/* Whether more than one sample in a hundred is missing: too many for a useful recording. */
bool acquire_file_lossy(const acquire_figures *figures);

/* ---- what is shown meanwhile (acquire_live.c) ---- */

enum { ACQUIRE_POINTS = 4096 };

typedef struct acquire_live {
    bool terminal, curve, by_depth;
    bool shown;
    int rows; /* lines of the curve on the screen */
    double drawn_s;
    size_t n, stride, skipped;
    float x[ACQUIRE_POINTS], force_N[ACQUIRE_POINTS];
} acquire_live;

void acquire_live_start(acquire_live *live, bool curve);
void acquire_live_begin(acquire_live *live, bool by_depth); /* of a run */
void acquire_live_add(acquire_live *live, const acquire_sample *sample);
/* The line, and the curve below it, at most ten times a second; only where stderr is a terminal. */
void acquire_live_show(acquire_live *live, const char *line);
/* Clears the line; the curve, if any, stays. */
void acquire_live_end(acquire_live *live);
/* The curve as text, rows lines of columns characters without the axis. */
void acquire_live_draw(const acquire_live *live, int rows, int columns, FILE *to);

/* ---- the session (acquire_run.c) ---- */

typedef struct acquire_options {
    const char *command;            /* name of the command, for messages */
    const char *port, *where, *out; /* as given; argument of link_open */
    int baud;
    const char *specimen, *specimen_kind;                         /* name and kind, or NULL */
    double height_mm, radius_mm;                                  /* 0 = not given */
    const char *protocol;                                         /* its file's name, or NULL */
    double contact_N, limit_N, limit_mm, limit_C, host_timeout_s; /* limits: 0 = the device's own */
    double reconnect_s;                                           /* time to wait for a broken link */
    int gains;                                                    /* class, or PALP_WIRE_GAINS_AUTO */
    bool keep_contact, force, live;
    unsigned columns; /* ACQUIRE_RAW and its like */
    int trigger_in;   /* PALP_WIRE_TRIGGER_* */
    bool trigger_out; /* a pulse at a run's start, and with every so many samples */
    size_t trigger_every;
    bool calibration[PALP_WIRE_CHANNELS]; /* rows that are given */
    int32_t row[PALP_WIRE_CHANNELS][PALP_WIRE_CHANNELS];
} acquire_options;

/* Runs the plan; returns an exit code, after one line on stderr if it is not 0. *summary (may be NULL): the
 * results, owned by the caller. */
int acquire_session(const acquire_options *options, const acquire_plan *plan, json_t **summary);

double acquire_plan_time_s(const acquire_plan *plan); /* with its rests */

/* Shows the device's readings ten times a second of its clock, until Ctrl-C: one line on a terminal,
 * otherwise rows of CSV on stdout. Moves nothing (acquire_monitor.c). Returns an exit code. */
int acquire_monitor(const acquire_options *options);

#endif
