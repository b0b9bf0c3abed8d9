/* calibrate.h: the parts of palpate calibrate. */
#ifndef PALPATE_TOOL_CALIBRATE_H
#define PALPATE_TOOL_CALIBRATE_H

#include "shared/cli.h"
#include "shared/record.h"

#include <jansson.h>
#include <palpate/palpate.h>

enum { RUNS_MAX = 64, PRESSES_MAX = 64 };

typedef enum calibrate_stage { STAGE_STATIC, STAGE_RELAXATION, STAGE_ALL } calibrate_stage;
typedef enum calibrate_method { METHOD_NLOPT, METHOD_FIXED_POINT, METHOD_THREE_PHASE } calibrate_method;
typedef enum calibrate_law { LAW_POLYNOMIAL, LAW_SPLINE } calibrate_law;

typedef struct calibrate_options {
    const char *lumped, *mesh, *start, *out, *result, *report, *check;
    const char *words[1 + RUNS_MAX]; /* LUMPED.json, RUN.csv ... */
    size_t n_words;
    cli_list nodes, size_mm, depth_mm, tip_radius_mm;
    double scale_mm, area_mm2, poisson, ramp_s, hold_s, dt_ms;
    int stage, method, formulation, dwell, law, branch; /* indices of the choices */
    int scaling;                                        /* palp_mesh_scaling, or -1 = not given */
    size_t arms, degree, knots, steps;
    size_t subdivisions; /* SIZE_MAX = not given */
    bool hex_diagonals, strain_dependent, every_step, json;
    const char *regions; /* names of those to fit, with commas, or NULL */
    char command[CLI_COMMAND_MAX];
} calibrate_options;

/* A target ramp and hold, and the response of the calibrated network. */
typedef struct press_target {
    palp_path path;
    record target;    /* samples given to the library */
    record network;   /* the calibrated network's answer */
    double *wanted_N; /* the target's force at the times of network */
    double depth_m, peak_N, max_error_percent;
    bool measured;       /* from a run, not from the lumped model */
    bool relaxed;        /* slow: the network is at rest at every sample */
    double tip_radius_m; /* of the sphere that pressed; 0 = the plate */
    double tip_m[2];     /* x and z of the sphere's place; NAN = the middle of the top */
} press_target;

typedef struct calibrate_state {
    palp_model lumped, model; /* model: the network with the latest material */
    palp_mesh_source source;  /* of its mesh */
    palp_mesh *mesh;
    palp_network *network;
    double height_m; /* of the mesh */
    calibrate_method static_method, relaxation_method;
    bool does_static, does_relaxation;
    size_t n_static;                    /* the static target */
    bool static_lumped;                 /* it is the lumped model's */
    bool tools;                         /* some run is of a tool: all runs are met at once */
    bool fits_poisson;                  /* tips of different size: with their runs */
    bool fits_region[PALP_REGIONS_MAX]; /* of the mesh's source */
    double *depth_m, *force_N;
    size_t n_presses;
    press_target press[PRESSES_MAX];
    palp_calibration static_result, relaxation_result;
    double strain_max; /* largest |element strain| in the presses */
    bool buckled;
    double stable_m, unstable_m;
    double *lumped_covariance, *lumped_between, *covariance,
        *between; /* covariance of the lumped model, of the network; NULL: unknown */
    size_t n_specimens;
} calibrate_state;

/* Functions return an exit code, after one line on stderr if it is not 0. */
int calibrate_setup(const calibrate_options *o, calibrate_state *s);   /* models, mesh, network */
int calibrate_targets(const calibrate_options *o, calibrate_state *s); /* curves to meet */
int calibrate_static(const calibrate_options *o, calibrate_state *s);
int calibrate_relaxation(const calibrate_options *o, calibrate_state *s);
int calibrate_tools(const calibrate_options *o, calibrate_state *s);   /* in place of both */
int calibrate_compare(const calibrate_options *o, calibrate_state *s); /* fills press[].network */
int calibrate_known(const calibrate_options *o, calibrate_state *s); /* the model's covariance and between */
int calibrate_report(const calibrate_options *o, const calibrate_state *s);
int calibrate_check(const calibrate_options *o); /* the other thing that the command does: --check */
json_t *calibrate_figures(const calibrate_state *s);

/* First guesses. calibrate_first_arms: the material, with arms from those of the lumped model. */
void calibrate_first_arms(const calibrate_options *o, const calibrate_state *s, palp_material *start);
palp_status guess_polynomial(const palp_law *law, size_t degree, double strain_max, palp_law *guess);
palp_status guess_spline(const palp_law *law, size_t knots, double strain_max, palp_law *guess);
void guess_arms(const palp_material *lumped, size_t n, double ratio, palp_material *guess);

#endif
