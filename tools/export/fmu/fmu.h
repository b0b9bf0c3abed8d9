/* fmu.h: a model as an FMU steps it: a specimen under a plate, or a network under a plate or sphere. */
#ifndef PALPATE_FMU_H
#define PALPATE_FMU_H

#include "fmi3.h"

#include <palpate/sim.h>

/* The variables, by value reference; modelDescription.xml (export_fmu.c) has the same numbers. Metres,
 * newtons and seconds. Of those from MAX_STEP on, a lumped model has MAX_STEP only. */
enum {
    FMU_TIME,
    FMU_DEPTH, /* inputs: of the plate at the start of a step, and its rate during it */
    FMU_DEPTH_RATE,
    FMU_FORCE,    /* output */
    FMU_MAX_STEP, /* parameter; 0 = as long as the importer's */
    FMU_LUMPED_COUNT,
    FMU_TIP_RADIUS = FMU_LUMPED_COUNT,  /* parameter; 0 = a plate */
    FMU_TOOL,                           /* input[3]: centre of the sphere at the start of a step */
    FMU_TOOL_RATE = FMU_TOOL + 3,       /* input[3] */
    FMU_TOOL_FORCE = FMU_TOOL_RATE + 3, /* output[3] */
    FMU_COUNT = FMU_TOOL_FORCE + 3
};

typedef enum fmu_mode { FMU_NEW, FMU_STARTING, FMU_STEPPING, FMU_ENDED } fmu_mode;

/* What a saved state has, beside that of the network. */
typedef struct fmu_values {
    fmu_mode mode;
    double value[FMU_COUNT];
    double reached[1 + 3]; /* depth and centre of the sphere at the end of the last step */
    palp_element_state element;
} fmu_values;

struct fmu {
    palp_model model;
    palp_mesh_source source;
    fmu_values start, now;
    double height_m;
    palp_network *network; /* NULL: lumped, or not yet made */
    double network_tip_m;  /* radius for which it was made */
    bool logs;
    fmi3LogMessageCallback log;
    void *environment;
};

struct fmu_state {
    size_t size; /* of all, bytes */
    uint32_t sum;
    bool has_network;
    fmu_values values;
    unsigned char network[]; /* as saved by the library */
};

/* Makes the network for the present tip, if the model is one and there is none yet. */
palp_status fmu_prepare(fmi3Instance fmu, palp_error *error);

/* Goes to the initial place at once, if there is a load. */
palp_status fmu_begin(fmi3Instance fmu);

/* Follows depth and tool for step_s. *done_s: the time that it reached, also on failure. */
palp_status fmu_advance(fmi3Instance fmu, double step_s, double *done_s);

#endif
