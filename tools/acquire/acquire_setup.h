/* acquire_setup.h: the options for device, specimen and output folder that commands share. */
#ifndef PALPATE_ACQUIRE_SETUP_H
#define PALPATE_ACQUIRE_SETUP_H

#include "acquire.h"
#include "rig/rig_options.h"

#include <palpate/model.h>

enum { ACQUIRE_SETUP_OPTIONS = 24 }; /* at most, of each of the lists */

typedef struct acquire_setup {
    acquire_options session;
    rig_options rig;
    size_t baud;
    int gains;
    const char *calibration, *channels;
    bool raw;
    /* of the virtual indenter */
    char kind[PALP_SPECIMEN_KIND_MAX];
    rig_settings settings;
    rig virtual_one;
} acquire_setup;

acquire_setup acquire_setup_default(void);

/* The options with headings; return their number. Those of the rig are rig_options_list's. */
size_t acquire_setup_device(acquire_setup *setup, cli_option *list);
size_t acquire_setup_specimen(acquire_setup *setup, cli_option *list);
size_t acquire_setup_columns(acquire_setup *setup,
                             cli_option *list); /* of the recordings; without a heading */

/* Call in this order after the options were read; they return exit codes. check: a device and a folder are
 * named. prepare: reads the specimen's size from the virtual indenter's model. open: starts the virtual
 * indenter, if used. */
int acquire_setup_check(const char *name, acquire_setup *setup);
int acquire_setup_prepare(const char *name, acquire_setup *setup);
int acquire_setup_open(const char *name, acquire_setup *setup);
int acquire_setup_close(acquire_setup *setup);

/* How a session goes on (acquire_until.c). */
typedef struct acquire_until {
    const char *model;  /* NULL: it does not */
    double time_s;      /* for all further experiments; 0: as long as the session takes */
    size_t every;       /* explain takes one sample in so many of each run; 0: its default */
    double false_alarm; /* chance that explain names an effect where none is; 0: explain's own */
} acquire_until;

/* After a session of this plan: palpate explain says what its recordings and the model leave open, and
 * designs an experiment, which is run; so on, until no effect has look-alikes. The plan is overwritten.
 * explain.json, explained.json and next.json stand beside the recordings. summary: of the session, or NULL;
 * gets the further runs and the verdict. Returns an exit code, CLI_NOT_CONVERGED where more than one cause is
 * left or none fits. */
int acquire_until_explained(acquire_setup *setup, acquire_plan *plan, const acquire_until *how,
                            json_t *summary);

#endif
