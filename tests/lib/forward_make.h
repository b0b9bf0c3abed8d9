/* forward_make.h: lumped models and paths that the tests of the forward model press. */
#ifndef FORWARD_MAKE_H
#define FORWARD_MAKE_H

#include <palpate/experiment.h>
#include <palpate/forward.h>
#include <palpate/random.h>

#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define HEIGHT 0.024 /* m */

enum { SAMPLES_MAX = 4096, COLUMNS_MAX = 96 };

typedef struct samples {
    size_t n;
    double time_s[SAMPLES_MAX], depth_m[SAMPLES_MAX], force_N[SAMPLES_MAX];
} samples;

/* A recording of them. */
static inline palp_experiment *samples_experiment(const samples *s) {
    palp_experiment *e;
    ck_assert_int_eq(palp_experiment_create(s->n, &e), PALP_OK);
    for (size_t i = 0; i < s->n; i++) {
        palp_experiment_column(e, "time_s")[i] = s->time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s->depth_m[i];
        palp_experiment_column(e, "force_N")[i] = s->force_N[i];
    }
    return e;
}

/* The seed's K(e) of Eq. 4.3 beside n_arms arms, no effects. */
static inline palp_model lumped_model(size_t n_arms) {
    static const double law[] = {8.18, -0.70, 47.47, -131.36, 146.89}; /* N */
    static const palp_arm arms[] = {{1.3, 17.9, 0, 0}, {0.8, 0.4, 0, 0}, {0.5, 60, 0, 0}};
    palp_model m;
    memset(&m, 0, sizeof m);
    m.height_m = HEIGHT;
    m.radius_m = 0.012;
    m.material.n_arms = n_arms;
    ck_assert_int_eq(palp_law_polynomial(5, law, &m.material.law), PALP_OK);
    memcpy(m.material.arms, arms, n_arms * sizeof *arms);
    return m;
}

static inline palp_model linear_model(double stiffness_N) {
    palp_model m = lumped_model(0);
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness_N, &m.material.law), PALP_OK);
    return m;
}

/* The effect with its strengths at share of the typical ones. Returns it. */
static inline palp_effect *add_effect(palp_model *m, palp_effect_id id, double share) {
    const palp_effect_info *info = palp_effect_look_up(id);
    palp_effect *effect = &m->effects[m->n_effects++];
    ck_assert_int_eq(palp_effect_default(id, effect), PALP_OK);
    for (size_t k = 0; k < info->n_parameters; k++)
        if (info->parameter[k].strength)
            effect->value[k] = share * info->parameter[k].typical;
    return effect;
}

/* Goes on to depth_mm at time in n even steps, or with growing steps where the plate stands. */
static inline void go(samples *s, double time, double depth_mm, size_t n) {
    const double first = 1e-3;
    double t0 = s->time_s[s->n - 1], d0 = s->depth_m[s->n - 1], d1 = 1e-3 * depth_mm;
    for (size_t i = 1; i <= n; i++) {
        double share = (double)i / (double)n;
        double u = d0 == d1 ? first * (pow(1 + 1 / first, share) - 1) : share;
        ck_assert_uint_lt(s->n, SAMPLES_MAX);
        s->time_s[s->n] = i < n ? t0 + u * (time - t0) : time;
        s->depth_m[s->n++] = i < n ? d0 + u * (d1 - d0) : d1;
    }
}

static inline void start(samples *s, double time, double depth_mm) {
    s->n = 1;
    s->time_s[0] = time;
    s->depth_m[0] = 1e-3 * depth_mm;
}

/* Air, a press and hold, a withdrawal, air, a deeper press and hold, a withdrawal. */
static inline void all_phases(samples *s, size_t n) {
    start(s, 0, -2.03);
    go(s, 0.9, -0.51, n);
    go(s, 3, 4.02, n);
    go(s, 8.1, 4.02, n);
    go(s, 10, -1.07, n);
    go(s, 13, -1.07, n);
    go(s, 15, 5.03, n);
    go(s, 18, 5.03, n);
    go(s, 20.2, -2.01, n);
}

/* With every column that an effect of the catalogue reads: a slow wave. The columns are good until the next
 * call. */
static inline palp_forward_run run_of(const samples *s) {
    static double wave[SAMPLES_MAX];
    static palp_forward_column column[PALP_EFFECT_COUNT];
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        wave[i] = 21 + 2 * sin(0.4 * s->time_s[i]);
    for (int id = 0; id < PALP_EFFECT_COUNT; id++)
        if (palp_effect_look_up((palp_effect_id)id)->column)
            column[n++] = (palp_forward_column){palp_effect_look_up((palp_effect_id)id)->column, wave};
    return (palp_forward_run){.n = s->n,
                              .time_s = s->time_s,
                              .depth_m = s->depth_m,
                              .session_s = 5000.0,
                              .hum_phase = 0.3,
                              .n_columns = n,
                              .column = column};
}

/* Runs into s->force_N. */
static inline void press_model(const palp_model *m, samples *s) {
    palp_forward_run run = run_of(s);
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_forward_force(m, &run, s->force_N, NULL, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
}

/* Run r of a session, n samples with noise of 2 mN: a press, a dwell and a withdrawal; each is slower than
 * the one before, and less deep. */
static inline void press_session_run(const palp_model *m, size_t r, size_t n, uint64_t *noise, samples *s) {
    s->n = n;
    for (size_t i = 0; i < n; i++) {
        const double up = (double)i / (20 + 25 * (double)r), down = ((double)n - 15.0 - (double)i) / 40;
        s->time_s[i] = 0.05 * (double)i;
        s->depth_m[i] = 1e-3 * fmax(-1, (6 - 0.5 * (double)r) * fmin(1, fmin(up, down)) - 1);
    }
    press_model(m, s);
    for (size_t i = 0; i < n; i++)
        s->force_N[i] += 2e-3 * palp_random_normal(noise);
}

/* ---- derivatives against finite differences ---- */

/* As palp_forward_force. */
typedef palp_status force_function(const palp_model *model, const palp_forward_run *run, double *force_N,
                                   double *gradient, palp_error *error);

/* d force[i] / d parameter k by central differences with Richardson extrapolation, or one-sided where the
 * parameter is on its bound. */
static inline void difference(force_function *press, const palp_model *model, const samples *s, size_t k,
                              double h, double *slope) {
    static const double central[4][2] = {{1, 8}, {-1, -8}, {2, -1}, {-2, 1}},
                        forward[5][2] = {{0, -25}, {1, 48}, {2, -36}, {3, 16}, {4, -3}};
    double at[COLUMNS_MAX];
    static double force[SAMPLES_MAX];
    palp_forward_run run = run_of(s);
    palp_model moved = *model;
    ck_assert_int_eq(palp_forward_get(model, at), PALP_OK);
    double here = at[k];
    at[k] = here - 2 * h;
    bool inside = palp_forward_set(&moved, at) == PALP_OK;
    memset(slope, 0, s->n * sizeof *slope);
    for (size_t j = 0; j < (inside ? 4u : 5u); j++) {
        const double *term = inside ? central[j] : forward[j];
        at[k] = here + term[0] * h;
        ck_assert_int_eq(palp_forward_set(&moved, at), PALP_OK);
        ck_assert_int_eq(press(&moved, &run, force, NULL, NULL), PALP_OK);
        for (size_t i = 0; i < s->n; i++)
            slope[i] += term[1] * force[i] / (12 * h);
    }
}

/* What a parameter is measured by where it is zero. */
static inline double scale_of(const palp_model *model, size_t k, double value) {
    size_t column = model->material.law.n + 2 * model->material.n_arms;
    if (value != 0 || k < column)
        return fmax(fabs(value), 1e-3);
    for (size_t i = 0; i < model->n_effects; i++) {
        const palp_effect_info *info = palp_effect_look_up(model->effects[i].id);
        if (k < column + info->n_parameters)
            return fmax(fabs(info->parameter[k - column].typical), 1e-6);
        column += info->n_parameters;
    }
    return 1;
}

/* exact's gradient against differences of press. share: step of the differences over the parameter's size;
 * tolerance: of the largest slope of the column. */
static inline void check_slopes(const char *what, force_function *exact, force_function *press,
                                const palp_model *model, const samples *s, double share, double tolerance) {
    static double gradient[COLUMNS_MAX * SAMPLES_MAX], wanted[SAMPLES_MAX], force[SAMPLES_MAX];
    double at[COLUMNS_MAX];
    palp_forward_run run = run_of(s);
    palp_error error = {PALP_OK, ""};
    size_t n = palp_forward_parameter_count(model);
    ck_assert_uint_le(n, COLUMNS_MAX);
    ck_assert_int_eq(palp_forward_get(model, at), PALP_OK);
    ck_assert_msg(!exact(model, &run, force, gradient, &error), "%s: %s", what, error.text);
    for (size_t k = 0; k < n; k++) {
        double scale = scale_of(model, k, at[k]), largest = 1e-3 / scale;
        difference(press, model, s, k, share * scale, wanted);
        for (size_t i = 0; i < s->n; i++)
            largest = fmax(largest, fabs(wanted[i]));
        for (size_t i = 0; i < s->n; i++)
            ck_assert_msg(fabs(gradient[k * s->n + i] - wanted[i]) <= tolerance * largest,
                          "%s, parameter %zu, at %g s, %g mm: %.9g, not %.9g (largest %g)", what, k,
                          s->time_s[i], 1e3 * s->depth_m[i], gradient[k * s->n + i], wanted[i], largest);
    }
}

/* A cube of so many nodes a side, fewer than eight; there is one of each kind, and no model may change it. */
static inline const palp_mesh_source *lattice_source(size_t nodes, palp_neighbourhood neighbourhood) {
    static palp_mesh_source sources[8][3];
    palp_mesh_source *source = &sources[nodes][neighbourhood / 10];
    *source = (palp_mesh_source){
        .nodes = {nodes, nodes, nodes}, .size_m = {HEIGHT, HEIGHT, HEIGHT}, .neighbourhood = neighbourhood};
    return source;
}

/* 27 nodes and a stiffness law; no arms. */
static inline palp_model cube_model(void) {
    static const double law[] = {0.49, 0.3, 2.4}; /* N */
    palp_model m = lumped_model(0);
    m.kind = PALP_MODEL_NETWORK;
    m.mesh = lattice_source(3, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_law_polynomial(3, law, &m.material.law), PALP_OK);
    return m;
}

/* Sum of 12 uniform numbers: sd 1. */
static inline double white_noise(uint64_t *state) {
    double sum = -6;
    for (int i = 0; i < 12; i++) {
        *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        sum += (double)(*state >> 11) * 0x1p-53;
    }
    return sum;
}

/* A lattice of so many nodes a side, by the first arms of two. */
static inline palp_model lattice_model(size_t n_arms, size_t nodes) {
    static const double law[] = {0.49, 0.3, 2.4, -3.1, 4.2}; /* N */
    static const palp_arm arms[] = {{0.08, 1.1, 0, 0}, {0.05, 0.02, 0, 0}};
    palp_model m = lumped_model(0);
    m.kind = PALP_MODEL_NETWORK;
    m.mesh = lattice_source(nodes, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_law_polynomial(5, law, &m.material.law), PALP_OK);
    m.material.n_arms = n_arms;
    memcpy(m.material.arms, arms, n_arms * sizeof *arms);
    return m;
}

#endif
