/* characterize.h: the parts of palpate characterize. */
#ifndef PALPATE_TOOL_CHARACTERIZE_H
#define PALPATE_TOOL_CHARACTERIZE_H

#include "shared/cli.h"
#include "shared/json_out.h"
#include "shared/plot_runs.h"

#include <jansson.h>
#include <palpate/characterize.h>
#include <palpate/palpate.h>

enum {
    CHARACTERIZE_RUNS_MAX = 256,
    CHARACTERIZE_WARNINGS_MAX = 32,
    DEGREE_MIN = 2, /* of the force polynomial F(e) = K(e) e, as Table 4.1 counts */
    DEGREE_MAX = 7,
    SELECT_LAWS_MAX = 20,
    CHARACTERIZE_BAND = 41,
    CHARACTERIZE_SPREAD_MAX = 20
};

typedef enum characterize_method { METHOD_LIKELIHOOD, METHOD_GRID } characterize_method;

typedef enum characterize_specimens_by {
    SPECIMENS_AUTO,
    SPECIMENS_ONE,
    SPECIMENS_NAME,
    SPECIMENS_FOLDER,
    SPECIMENS_FILE
} characterize_specimens_by;

typedef struct characterize_options {
    const char *words[CHARACTERIZE_RUNS_MAX]; /* RUN.csv ... */
    size_t n_words;
    const char *arms_text, *degree_text, *out, *result, *report, *spectrum;
    int contact;                 /* 0 = auto, known, common, free */
    int law_choice, law, method; /* 0 = auto, else 1 + palp_law_kind; palp_law_kind; characterize_method */
    size_t arms, degree, knots, per_decade; /* per_decade: of --arms log:N */
    bool arms_auto, law_auto, degree_auto, degree_given;
    bool shared_arms, per_depth, dwell_only, fit_filtered, fractional, json;
    int specimens_by;                                   /* characterize_specimens_by */
    double filter_Hz, height_mm, radius_mm, contact_mm; /* 0, 0, 0, NaN = not given */
    int tip, floor; /* -1 = from the files, else palp_tip_kind; 0 = bonded, slides */
    bool tip_sticks, small_strain;
    double tip_radius_mm, tip_angle_deg, poisson; /* 0, 0, NaN = not given */
    char command[CLI_COMMAND_MAX];
} characterize_options;

/* K at the depth of a ramp and hold: of the plain static polynomial, the joint law and the run by itself. */
typedef struct characterize_gap {
    double strain, run_N, low_N, high_N, plain_N, joint_N;
} characterize_gap;

/* K of the model's law at a strain with its 95 % band; the force is K times the strain, and so is its band.
 */
typedef struct characterize_known {
    double strain, stiffness_N, low_N, high_N;
} characterize_known;

/* Force of several static runs at a strain. */
typedef struct characterize_spread {
    double strain, mean_N, sd_N, low_N, high_N;
} characterize_spread;

typedef struct characterize_body {
    double height_m, radius_m;
    size_t n_runs;
} characterize_body;

typedef struct characterize_state {
    size_t n, n_static, n_hold; /* runs: static, then ramp and hold by depth, then others */
    palp_recording run[CHARACTERIZE_RUNS_MAX];
    bool has_tip;                                /* every run has a tip */
    palp_indentation tip[CHARACTERIZE_RUNS_MAX]; /* of each run */
    palp_moduli moduli;                          /* of the layer under it */
    size_t n_tip_specimens;                      /* moduli of each specimen under a tip; 0 = one specimen */
    palp_moduli each[CHARACTERIZE_RUNS_MAX];     /* of each of them */
    double between_Pa[2]; /* sd between them, long-term and instantaneous shear modulus */
    double *filtered_N[CHARACTERIZE_RUNS_MAX]; /* NULL = not even enough */
    double cutoff_Hz;
    palp_law plain[CHARACTERIZE_RUNS_MAX][DEGREE_MAX + 1]; /* [static run][degree]; n = 0: not fitted */
    double norm_N[CHARACTERIZE_RUNS_MAX][DEGREE_MAX + 1];
    size_t degree, n_arms; /* of the final model */
    size_t n_laws;
    palp_law law[SELECT_LAWS_MAX];    /* first guesses of the laws to choose from */
    double log_odds[SELECT_LAWS_MAX]; /* of a spline of 31 knots over each, nats */
    palp_contact_form contact;
    double contact_scatter_m;
    size_t n_single;
    palp_lumped_fit single[CHARACTERIZE_RUNS_MAX]; /* fit of each ramp and hold by itself */
    bool has_shared;
    palp_lumped_fit shared; /* one set of arms, a K_inf for each run */
    bool has_final; /* false: with the thesis' procedure the model comes from the static polynomial and shared
                     */
    palp_lumped_fit final;
    palp_material material; /* of the model */
    size_t n_gap;
    characterize_gap gap[CHARACTERIZE_RUNS_MAX];
    double gap_before_percent, gap_after_percent;
    double peak_N[CHARACTERIZE_RUNS_MAX],
        largest_N[CHARACTERIZE_RUNS_MAX]; /* force; |residual| of the model */
    size_t n_band;                        /* 0: no intervals */
    characterize_known band[CHARACTERIZE_BAND];
    palp_spectrum spectrum[CHARACTERIZE_RUNS_MAX]; /* of each run; n = 0: it does not oscillate */
    size_t n_spread;
    characterize_spread spread[CHARACTERIZE_SPREAD_MAX];
    size_t n_specimens, specimen[CHARACTERIZE_RUNS_MAX]; /* of each run, from 0 */
    characterize_body body[CHARACTERIZE_RUNS_MAX];       /* [n_specimens] */
    double factor[CHARACTERIZE_RUNS_MAX]; /* [n_specimens] about the stress of each by that of all */
    palp_specimens_fit specimens;         /* without the mean, which is final */
    size_t n_points;                      /* 0: one specimen, or no significant spread */
    palp_specimens_point point[CHARACTERIZE_BAND];
    size_t n_warnings;
    char warning[CHARACTERIZE_WARNINGS_MAX][256];
} characterize_state;

/* Warns on stderr and keeps the text for the report. */
void characterize_warn(characterize_state *s, const char *format, ...);

/* The fit the model comes from. */
const palp_lumped_fit *characterize_fit_of(const characterize_state *s);

bool characterize_took(const characterize_state *s, size_t k); /* the model's law is of the form of law k */
double characterize_strain_max(const characterize_state *s);
double characterize_total(const palp_lumped_fit *fit); /* sum of |residual|, N */
double characterize_noise_ratio(const palp_lumped_fit *fit, size_t run, const palp_recording *r);

/* Functions that return int return an exit code, after one line on stderr if it is not 0. */
int characterize_read(const characterize_options *o, characterize_state *s);  /* runs and their findings */
int characterize_model(const characterize_options *o, characterize_state *s); /* all fits */
palp_characterize_settings characterize_settings(const characterize_options *o, palp_spring_form spring,
                                                 size_t n_arms);
size_t characterize_depths(const characterize_state *s); /* different depths of dwells, within 2 % */
palp_status characterize_list_laws(const characterize_options *o, characterize_state *s); /* s->law */
int characterize_likelihood(const characterize_options *o, characterize_state *s);        /* the model */
palp_status characterize_law_of_depths(const characterize_state *s, size_t degree, palp_law *law);
palp_status characterize_guess(const characterize_options *o, const characterize_state *s, palp_law *law);
int characterize_tip_read(const characterize_options *o, const palp_experiment *experiment,
                          const palp_recording *run, characterize_state *s); /* of run s->n */
int characterize_tip_fit(const characterize_options *o,
                         characterize_state *s); /* moduli of the layer, with a tip */
void characterize_tip_print(const characterize_state *s);
json_t *characterize_tip_json(const characterize_state *s); /* null without a tip */
/* Several specimens. With one, n_specimens is 1 and these functions change nothing. */
int characterize_group(const characterize_options *o, characterize_state *s); /* runs as of one size */
void characterize_take_spread(characterize_state *s); /* of s->specimens, whose mean becomes the final fit */
const char *characterize_specimen_name(const characterize_state *s, size_t k);
void characterize_print_specimens(const characterize_state *s);
json_t *characterize_json_specimens(const characterize_state *s);

int characterize_compare(characterize_state *s); /* the model with its runs, runs with each other */
int characterize_measure_spectra(characterize_state *s);
void characterize_print_spectrum(const characterize_state *s);
int characterize_write_spectrum(const char *path,
                                const characterize_state *s); /* CSV: measured points, then the model's */
json_t *characterize_spectrum_json(const characterize_state *s);
int characterize_print(const characterize_options *o, const characterize_state *s);
json_t *characterize_json(const characterize_options *o, const characterize_state *s);
json_t *characterize_figures(const characterize_state *s); /* NULL after one line on stderr */

#endif
