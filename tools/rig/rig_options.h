/* rig_options.h: the options that describe the virtual indenter, for palpate rig and acquire --port rig. */
#ifndef PALPATE_RIG_OPTIONS_H
#define PALPATE_RIG_OPTIONS_H

#include "shared/cli.h"
#include "rig.h"

enum { RIG_OPTIONS = 22 }; /* a heading and the options */

/* The options' values, as cli_parse leaves them; rig_options_settings makes settings of them. */
typedef struct rig_options {
    const char *actuator, *inject, *log, *store, *weight;
    int machine, specimen, firmware; /* index of the choice; -1 = not given */
    bool paced;
    double scale, contact_mm, compliance_mm_N, backlash_mm;
    double trigger_s;
    double noise_N, hum_N, bias_N, drift_N_s, gain, range_N;
    size_t seed;
} rig_options;

/* The defaults are those of rig_settings_default(); NAN or -1 = not given. */
rig_options rig_options_default(void);

/* Writes the options into list, after a command's own. *o must outlive the parsing. */
void rig_options_list(rig_options *o, cli_option list[RIG_OPTIONS]);

/* The first option that was given, without its dashes, or NULL. For a command that runs without a rig, and
 * refuses them. */
const char *rig_options_given(const rig_options *o);

/* Makes settings of the options: reads the actuator, checks that the model's file exists, parses the faults.
 * model may be NULL: the phantom of the thesis. The settings point at the options' texts. Returns an exit
 * code, after one line on stderr under name. */
int rig_options_settings(const char *name, const rig_options *o, const char *model, rig_settings *settings);

#endif
