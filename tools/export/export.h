/* export.h: a solid of another program, fitted to a model, and its scene files. */
#ifndef PALPATE_EXPORT_TOOL_H
#define PALPATE_EXPORT_TOOL_H

#include "shared/cli.h"

#include <palpate/model.h>
#include <palpate/solid.h>

enum { EXPORT_RUNS_MAX = 64 };

typedef struct export_options {
    int to;  /* 0: springs; else a target and 1 more */
    int law; /* index of export_laws; -1 = the target's first */
    bool slides, json;
    cli_list depth_mm, strain;
    size_t points, nodes;
    double table_strain, step_strain, poisson, rate_mm_s, hold_s, density_kg_m3;
    const char *runs, *out;
} export_options;

/* A fitted solid and what its scene needs. */
typedef struct export_scene {
    const struct export_target *target;
    const char *model; /* name of its file */
    palp_mesh *mesh;
    palp_solid solid;
    palp_solid_fit_info info;
    unsigned char *held;   /* [n_nodes] palp_solid_supports */
    size_t n_runs;         /* recordings that it was fitted to; 0 = the model's own force */
    double ramp_N, hold_N; /* the solid's force at the end of the scene's ramp and of its dwell */
    double lumped_rms_N;   /* of the lumped model against these recordings; NAN = not known */
    double height_m, depth_m, ramp_s, hold_s, density_kg_m3;
} export_scene;

/* A law that a target has, and the target's name of it. */
typedef struct export_law {
    palp_solid_law law;
    const char *option, *name;
} export_law;

typedef struct export_target {
    const char *name;
    palp_solid_time time;
    size_t arms_max; /* of its Prony series */
    bool slides;     /* its scene can have plates that slide */
    size_t n_laws;
    export_law laws[3];
    void (*write)(const export_scene *scene, FILE *to);
} export_target;

enum { EXPORT_TARGETS = 7 };
extern const export_target export_targets[EXPORT_TARGETS];

/* Fits and writes; functions return an exit code. */
int export_solid(const export_options *o, const char *path);
int export_fit(const export_options *o, const palp_model *model, export_scene *scene);
int export_press(export_scene *scene); /* ramp_N and hold_N */

/* The law of the scene's target. */
const export_law *export_law_of(const export_scene *scene);

/* Law, presses of the fit and error of the force, as lines after a prefix. No line has two hyphens. */
void export_state(const export_scene *scene, const char *prefix, FILE *to);

/* The indices of the nodes with these supports, counted from first (0 or 1), between separators. */
void export_nodes_held(const export_scene *scene, unsigned char held, int first, const char *separator,
                       FILE *to);

/* True where a node has these supports. */
bool export_has_held(const export_scene *scene, unsigned char held);

/* Writers of the targets. */
void export_calculix(const export_scene *scene, FILE *to);
void export_abaqus(const export_scene *scene, FILE *to);
void export_febio(const export_scene *scene, FILE *to);
void export_mujoco(const export_scene *scene, FILE *to);
void export_newton(const export_scene *scene, FILE *to);
void export_sofa(const export_scene *scene, FILE *to);
void export_vega(const export_scene *scene, FILE *to);

#endif
