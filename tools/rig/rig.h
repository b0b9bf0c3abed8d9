/* rig.h: the virtual indenter: the firmware (under QEMU or as a process) and the plant in lockstep. */
#ifndef PALPATE_RIG_H
#define PALPATE_RIG_H

#include "plant.h"

#include <sys/types.h>

/* Auto: QEMU where it is installed and the image is built. */
typedef enum rig_firmware { RIG_AUTO, RIG_QEMU, RIG_HOST } rig_firmware;

enum { RIG_INJECTIONS = 16, RIG_PATH = 4096, RIG_NOTE = 256 };

typedef struct rig_injection {
    int fault;              /* palp_wire_fault */
    double time_s, until_s; /* since the rig started; until: when it is lifted, 0 = never */
} rig_injection;

typedef struct rig_settings {
    plant_settings plant;
    rig_firmware firmware;
    size_t n_injections;
    rig_injection injection[RIG_INJECTIONS];
    bool paced;           /* at real time; otherwise as fast as possible */
    const char *port;     /* "pty"; "tcp:PORT" to listen on; "file:PATH"; "fd:NUMBER", an open socket */
    const char *script;   /* a file of "TICK HEXBYTES" lines to send in place of a host, or NULL */
    const char *log;      /* CSV of the plant's true values at every tick, or NULL */
    const char *store;    /* a file that keeps the flash with the parameters; NULL: lost at the end */
    const char *weight;   /* a file with the weight on the sensor in newtons, read 50 times a second of device
                             time; or NULL */
    double until_s;       /* stop after this device time; 0 = until closed */
    double trigger_s;     /* period of pulses at the trigger's input; 0 = none */
    double patience_s;    /* for an answer of the firmware; 15, since a full port may delay it by 10 */
    char image[RIG_PATH]; /* the firmware's file, from rig_find */
} rig_settings;

rig_settings rig_settings_default(void);

/* Resolves RIG_AUTO and finds the image: in $PALPATE_FIRMWARE, in firmware/ beside this program, or in
 * ../lib/palpate/ from there. note: the firmware that will run, such as "the STM32F405 image under
 * QEMU 7.2.22" or "the host process". False where there is none; note has the reason. */
bool rig_find(rig_settings *settings, char note[RIG_NOTE]);

/* Finds a file of the firmware, in the folders of rig_find. */
bool rig_find_image(const char *file, char path[RIG_PATH]);

/* How a run went. */
typedef struct rig_figures {
    uint32_t ticks, restarts;
    uint32_t cost;    /* most processor instructions of a tick; 0 = not known */
    uint32_t late;    /* paced: ticks more than one tick late */
    double worst_s;   /* paced: the latest */
    double elapsed_s; /* wall clock */
} rig_figures;

/* Runs the firmware that rig_find finds, and the plant, until until_s or until *stop is not zero. on_port
 * (may be NULL) is called once the port exists, with what to connect to, such as "pty:/dev/pts/5" or
 * "tcp:127.0.0.1:4000". figures may be NULL. Returns an exit code. Errors go to stderr under name, also where
 * the firmware ends or does not answer. */
int rig_run(const char *name, const rig_settings *settings, const volatile int *stop,
            void (*on_port)(const char *port, void *context), void *context, rig_figures *figures);

/* The same in a child process, for palpate acquire. Ctrl-C does not reach it, and it ends with this process.
 */
typedef struct rig {
    pid_t child;
    int fd;        /* this end of the line; the port is a copy */
    char port[32]; /* what link_open() takes */
} rig;
int rig_open(const char *name, const rig_settings *settings, rig *r);
int rig_close(rig *r);                 /* ends it; its exit code */
void rig_open_again(rig *r);           /* a new port, as the link that was closed has closed its own */
void rig_pause(const rig *r, bool on); /* its clock stands still, and it takes no time of the processor */

#endif
