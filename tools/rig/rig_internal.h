/* rig_internal.h: the parts of the virtual indenter: the firmware's process, and its inputs. */
#ifndef PALPATE_RIG_INTERNAL_H
#define PALPATE_RIG_INTERNAL_H

#include "rig.h"

#include <palpate/wire.h>

/* ---- the firmware as a child process: rig_process.c ---- */

typedef struct rig_process {
    pid_t pid;
    int to, from; /* FIFOs */
    int text;     /* its output on stdout and stderr; at its end when the process ends */
    char folder[RIG_PATH];
    char line[RIG_NOTE], last[RIG_NOTE]; /* the line being collected; the last whole one */
    size_t n;
} rig_process;

/* Starts it in a folder of its own; an exit code. rig_process_end must follow in any case. */
int rig_process_start(const char *name, const rig_settings *settings, rig_process *p);

/* Takes its output; false once it has ended. */
bool rig_process_listen(rig_process *p);

/* Lets it end within a second, otherwise kills it; removes the folder. */
void rig_process_end(rig_process *p);

/* ---- what the firmware is fed besides the plant: rig_feed.c ---- */

typedef struct rig_line {
    uint32_t tick;
    size_t from, n; /* bytes */
} rig_line;

typedef struct rig_feed {
    const rig_settings *settings;
    size_t n_lines, next; /* of the script */
    rig_line *line;
    uint8_t *byte;                           /* of all lines */
    size_t at;                               /* within the next line */
    uint8_t limits[PALP_WIRE_FRAME_MAX + 1]; /* a frame of the rig's to send first */
    size_t limits_n, limits_at;
    uint32_t done; /* a bit for each injection that happens once and has */
} rig_feed;

/* Reads the script, if any; an exit code. rig_feed_free must follow in any case. */
int rig_feed_open(const char *name, const rig_settings *settings, rig_feed *f);
void rig_feed_free(rig_feed *f);

/* Causes the faults of a tick. To be called before the plant's step to it. */
void rig_feed_plant(const rig_feed *f, uint32_t tick, plant *p);

/* Completes the record with events and bytes. */
void rig_feed_record(rig_feed *f, const plant *p, plant_in *in);

#endif
