/* infer_recordings.c: the lumped solid of recordings: in blocks of samples, and in units of their own. */
#include <palpate/explain.h>

#include "base/file.h"
#include "explain_data.h"
#include "fit/fit_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The runs are fitted in units of their largest force, their longest time and the size of the specimen.
 * Depths and forces are rounded to 6e-8 of these. So other units of the files give the same numbers to the
 * last bit. Else rounding would decide between two fits that are nearly as good. */
typedef struct own_units {
    double force, time, height, radius; /* N, s, m, m; radius 0 where no run knows it */
} own_units;

/* Bits of the time, which is as the file has it, and of values that depend on an estimated contact or zero.
 */
enum { FINE = 32, COARSE = 24 };

static double rounded(double x, int bits) {
    return ldexp(round(ldexp(x, bits)), -bits);
}

static double area_of(const own_units *unit) {
    return unit->radius > 0.0 ? pow(unit->radius, 2.0) : 1.0;
}

static double peak_of(const palp_recording *run) {
    double peak = 0.0;
    for (size_t i = 0; i < run->n; i++)
        peak = fmax(peak, fabs(run->force_N[i]));
    return peak;
}

static own_units find_units(size_t n, const palp_recording *run) {
    own_units unit = {.height = run[0].height_m};
    for (size_t r = 0; r < n && run[r].n > 0; r++) {
        unit.radius = fmax(unit.radius, run[r].radius_m);
        unit.time = fmax(unit.time, run[r].time_s[run[r].n - 1] - run[r].time_s[0]);
        unit.force = fmax(unit.force, peak_of(&run[r]));
    }
    return unit;
}

/* ---- the runs ---- */

/* Parts of the way for the blocks of a run. The force in the middle of a block is peak / (12 parts^2) off the
 * mean over it, if it grows with the square of the depth. A block lasts six parts of the time since the
 * corner. So the mean of a parabola is 18 / parts^4 of the relaxed force off at most. Over all n samples this
 * may change chi2 by a tenth. A hundred parts are three between two knots of a law. Beyond three hundred the
 * parabola counts: fewer blocks would be so few innovations of slow noise that it takes a relaxation. */
static double parts_of(const palp_recording *run) {
    static const double LEAST = 100.0, ENOUGH = 300.0;
    const double peak = peak_of(run), noise = fmax(run->noise_N, EXPLAIN_EXACT * peak),
                 n = 10.0 * (double)run->n, middle = pow(n, 0.25) * sqrt(peak / (12.0 * noise)),
                 parabola = pow(n, 0.125) * pow(18.0 * peak / noise, 0.25);
    return fmax(LEAST, fmin(middle, fmax(ENOUGH, parabola)));
}

/* A run in blocks, of a specimen of height 1 m and radius 1 m. */
static palp_status make_run(const palp_recording *run, size_t specimen, const own_units *unit,
                            palp_experiment **e) {
    char name[32];
    palp_status status = palp_recording_blocks(run, parts_of(run), e);
    if (status)
        return status;
    double *time = palp_experiment_column(*e, "time_s"), *depth = palp_experiment_column(*e, "depth_mm"),
           *force = palp_experiment_column(*e, "force_N"), *spread = palp_experiment_column(*e, "time_sd_s"),
           *noise = palp_experiment_column(*e, "noise_N");
    const double start = time[0];
    for (size_t i = 0; i < palp_experiment_rows(*e); i++) {
        time[i] = rounded((time[i] - start) / unit->time, FINE);
        depth[i] = 1e3 * rounded(1e-3 * depth[i] / unit->height, COARSE);
        force[i] = rounded(force[i] / unit->force, COARSE);
        spread[i] = rounded(spread[i] / unit->time, FINE);
        noise[i] = rounded(noise[i] / unit->force, FINE);
    }
    snprintf(name, sizeof name, "specimen %zu", specimen + 1);
    status = palp_experiment_set_string(*e, "specimen.name", name);
    if (!status)
        status = palp_experiment_set_number(*e, "specimen.height_mm", 1e3);
    if (!status && unit->radius > 0.0)
        status = palp_experiment_set_number(*e, "specimen.radius_mm", 1e3);
    if (!status && run->contact_rule == PALP_CONTACT_GIVEN)
        status = palp_experiment_set_number(*e, "contact.sd_mm",
                                            1e3 * rounded(run->contact_sd_m / unit->height, COARSE));
    return status;
}

/* ---- the laws ---- */

/* Times a force, or divided by it; stresses are those of the area that goes with the radius. */
static void scale_law(const own_units *unit, bool divide, palp_law *law) {
    const bool stress = law->kind != PALP_LAW_POLYNOMIAL && law->kind != PALP_LAW_SPLINE;
    const double area = stress ? area_of(unit) : 1.0, size = unit->force / area;
    palp_law_scale(law, divide ? 1.0 / size : size, law);
    law->area_m2 *= divide ? 1.0 / area : area;
}

/* A first guess counts to a few digits. */
static palp_status take_units(const own_units *unit, palp_law *law) {
    enum { BITS = 16 };
    double c[PALP_LAW_MAX];
    scale_law(unit, true, law);
    law->area_m2 = rounded(law->area_m2, FINE);
    for (size_t k = 0; k < law->n; k++) {
        int exponent = 0;
        const double mantissa = frexp(law->coefficients[k], &exponent);
        c[k] = ldexp(round(ldexp(mantissa, BITS)), exponent - BITS);
    }
    return palp_law_set_coefficients(law, c);
}

/* ---- the result ---- */

static void scale_material(palp_material *m, const own_units *unit) {
    scale_law(unit, false, &m->law);
    for (size_t j = 0; j < m->n_arms; j++) {
        m->arms[j].stiffness_N *= unit->force;
        m->arms[j].viscosity_Ns *= unit->force * unit->time;
    }
}

static double size_of(const own_units *unit, const char *name) {
    return strcmp(name, "N") == 0     ? unit->force
           : strcmp(name, "N s") == 0 ? unit->force * unit->time
           : strcmp(name, "s") == 0   ? unit->time
           : strcmp(name, "Pa") == 0  ? unit->force / area_of(unit)
                                      : 1.0;
}

/* Of parameter p: springs, then K_j and b_j of each arm. */
static double parameter_size(const own_units *unit, const palp_lumped_fit *fit, size_t p) {
    const size_t springs = fit->material.law.n;
    return size_of(unit, p < springs ? fit->estimate[p].unit : (p - springs) % 2 ? "N s" : "N");
}

/* From the units of the fit to SI. */
static void scale_fit(palp_specimens_fit *fit, const own_units *unit) {
    palp_lumped_fit *mean = &fit->mean;
    const size_t n = mean->n_parameters;
    for (size_t i = 0; i < mean->n_estimates; i++) {
        palp_estimate *e = &mean->estimate[i];
        const double size = size_of(unit, e->unit);
        e->value *= size;
        e->sd *= size;
        e->low *= size;
        e->high *= size;
    }
    for (size_t i = 0; i < n * n; i++) {
        const double size = parameter_size(unit, mean, i / n) * parameter_size(unit, mean, i % n);
        mean->covariance[i] *= size;
        if (fit->between && fit->within) {
            fit->between[i] *= size;
            fit->within[i] *= size;
        }
    }
    for (size_t r = 0; r < mean->n_runs; r++) {
        mean->contact_m[r] *= unit->height;
        mean->contact_sd_m[r] *= unit->height;
    }
    mean->contact_scatter_m *= unit->height;
    scale_material(&mean->material, unit);
    for (size_t k = 0; k < fit->n_specimens; k++)
        scale_material(&fit->own[k], unit);
}

/* Of all samples, in place of those of the blocks. */
static palp_status measure_residuals(size_t n, const palp_recording *recordings, palp_lumped_fit *fit) {
    const palp_characterize_settings all = palp_characterize_settings_default();
    memset(fit->rms_N, 0, n * sizeof *fit->rms_N);
    memset(fit->absolute_N, 0, n * sizeof *fit->absolute_N);
    return fit_fill_residuals(n, recordings, &all, fit);
}

static palp_status check(size_t n, const palp_recording *run, const own_units *unit, palp_error *error) {
    for (size_t r = 0; r < n; r++)
        if (run[r].n == 0 || !(run[r].height_m > 0.0) ||
            fabs(run[r].height_m / run[0].height_m - 1.0) > 1e-6 ||
            (run[r].radius_m > 0.0 && fabs(run[r].radius_m / unit->radius - 1.0) > 1e-6))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "%s: no samples, or of another size than %s",
                                  run[r].name, run[0].name);
    return PALP_OK;
}

palp_status palp_explain_recordings(size_t n, const palp_recording *recordings, const size_t *specimen,
                                    const palp_explain_settings *settings, const palp_explain_choice *choice,
                                    palp_specimens_fit *fit, palp_error *error) {
    if (!recordings || !settings || !choice || !fit || (choice->n_laws > 0 && !choice->law))
        return palp_error_null(error);
    memset(fit, 0, sizeof *fit);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no recordings");
    const own_units unit = find_units(n, recordings);
    palp_status status = check(n, recordings, &unit, error);
    if (status)
        return status;
    const palp_model model = {
        .kind = PALP_MODEL_LUMPED, .height_m = 1.0, .radius_m = unit.radius > 0.0 ? 1.0 : 0.0};
    palp_explain_choice own = *choice;
    palp_experiment **run = calloc(n, sizeof *run);
    palp_explain_input *input = calloc(n, sizeof *input);
    palp_law *law = calloc(choice->n_laws + 1, sizeof *law);
    status = run && input && law ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < n && !status; r++) {
        status = make_run(&recordings[r], specimen ? specimen[r] : 0, &unit, &run[r]);
        input[r] = (palp_explain_input){run[r], recordings[r].name};
    }
    for (size_t i = 0; i < choice->n_laws && !status; i++) {
        law[i] = choice->law[i];
        status = take_units(&unit, &law[i]);
    }
    own.law = law;
    if (!status)
        status = palp_explain_material(&model, n, input, settings, &own, fit, error);
    if (!status) {
        scale_fit(fit, &unit);
        status = measure_residuals(n, recordings, &fit->mean);
        if (status)
            palp_specimens_fit_free(fit);
    }
    for (size_t r = 0; r < n && run; r++)
        palp_experiment_free(run[r]);
    free(run);
    free(input);
    free(law);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
