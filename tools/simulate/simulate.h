/* simulate.h: the parts of palpate simulate. */
#ifndef PALPATE_SIMULATE_H
#define PALPATE_SIMULATE_H

#include "shared/cli.h"
#include "shared/press.h"

#include <palpate/palpate.h>

typedef struct simulate_options {
    const char *model, *like, *out, *vtu, *checkpoint, *restart;
    int tip;                      /* index of plate, sphere; -1 = that of --like */
    int protocol, branch, solver; /* protocol: index of static, ramp_hold, cyclic, creep; -1 = --like */
    double depth_mm, rate_mm_s, ramp_s, hold_s, force_N, dt_ms, tolerance;
    size_t cycles, vtu_every, ranks, checkpoint_every; /* ranks: 0 = not given */
    cli_list nodes;
    double tip_mm[2], tip_radius_mm, sample_Hz, air_s, noise_N, hum_N, clip_N;
    size_t seed; /* SIZE_MAX = not given */
    const char *drop, *spike;
    cli_list gaps, spikes; /* their values: from, to; time, force */
    bool relaxed, band, json;
} simulate_options;

typedef struct simulation {
    palp_model model;
    palp_mesh_source source; /* network only */
    palp_experiment *like;
    palp_path path;
    palp_mesh *mesh; /* network only, as is network */
    palp_network *network;
    palp_reduced *reduced; /* instead of both */
    palp_ranks *ranks;     /* the processes over which the network is, or NULL */
    double height_m;       /* of what is pressed */
    double tip_radius_m;   /* network: of the sphere that presses it; 0 = the plate */
    double tip_m[2];       /* x and z of its place; NAN = the middle of the top */
    record curve;
    bool recorded;          /* the curve has regular samples, with air before them */
    double *low_N, *high_N; /* [curve.n] --band: 95 % band of the force, or NULL */
    palp_run_info info;
    double beyond_s, strain_max; /* first time beyond the measured strain, < 0 = never; largest strain */
    bool buckled;
    double stable_m, unstable_m;
} simulation;

/* Functions return an exit code, after one line on stderr if it is not 0. */
int simulate_mesh(const simulate_options *o, simulation *s); /* mesh and height_m */
int simulate_tip(const simulate_options *o, simulation *s);  /* tip_radius_m */
int simulate_network(const simulate_options *o, simulation *s);
int simulate_effects(
    const simulate_options *o,
    simulation *s); /* for a model with effects, or a plate that separates from its specimen */
int simulate_reduced(const simulate_options *o, simulation *s); /* instead: a reduced model */
bool simulate_is_reduced(const char *path);
int simulate_band_check(const simulate_options *o, const simulation *s);
int simulate_band(const simulate_options *o, simulation *s); /* low_N, high_N of the finished curve */
int simulate_report(const simulate_options *o, const simulation *s);

/* --ranks: starts the processes, or becomes mpirun, which starts this command in each; only the first of them
 * speaks. agree: the code of one of them that cannot go on, for a model that was read. */
int simulate_ranks_start(int argc, char **argv, const simulate_options *o, simulation *s);
int simulate_ranks_agree(const simulate_options *o, const simulation *s, int code);

/* The state and the curve so far, to and from a file. */
palp_status simulate_ranks_save(const simulate_options *o, const simulation *s, palp_error *error);
palp_status simulate_ranks_restore(const simulate_options *o, simulation *s, palp_error *error);

/* Imperfections of a tester: regular samples, free air, sensor errors. check reads the options; resample adds
 * the samples to the path before the run; sense makes the recording after it. samples: the times of a
 * recording, from its first sample on (malloc'ed; the caller frees them). */
enum { SIMULATE_HUM_HZ = 50 };

int simulate_sensor_check(simulate_options *o);
int simulate_resample(const simulate_options *o, palp_path *path);
palp_status simulate_samples(const simulate_options *o, const palp_path *path, size_t *n, double **time_s);
int simulate_sense(const simulate_options *o, simulation *s);
double simulate_air_rate(const simulate_options *o); /* mm/s */

#endif
