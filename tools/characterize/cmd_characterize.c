/* cmd_characterize.c: palpate characterize: a lumped model with intervals from raw recordings. */
#include "characterize.h"
#include "shared/commands.h"
#include "shared/page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

static int parse(int argc, char **argv, characterize_options *o) {
    const cli_option options[] = {
        cli_heading("Model"),
        cli_text("arms", "N|auto|log:N|fractional", &o->arms_text,
                 "number of Maxwell arms, 0 to 16 (default auto: by evidence);\n"
                 "log:N: N arms a decade at fixed relaxation times, stiffness >= 0;\n"
                 "fractional: a spring and a springpot in series, as 16 arms"),
        cli_choice("law", "auto|polynomial|spline|neo_hookean|mooney_rivlin2|mooney_rivlin5|yeoh|ogden",
                   &o->law_choice,
                   "form of the stiffness law K(e), F = K(e) e (default auto: a spline of 31 knots\n"
                   "unless another is more probable; with --degree a polynomial, with --knots a\n"
                   "spline)"),
        cli_text("degree", "N|auto", &o->degree_text,
                 "degree of the force polynomial F(e) = K(e) e, 2 to 7, counted as in Table 4.1\n"
                 "of Sedef 2008 (default 5, with no more terms than depths); auto: by evidence"),
        cli_count("knots", "N", 2, PALP_LAW_MAX, &o->knots, "number of knots of the spline (default 5)"),
        cli_heading("Fit"),
        cli_flag("shared-arms", &o->shared_arms,
                 "beside the model only the fit of one set of arms to the dwells of all depths"),
        cli_flag("per-depth", &o->per_depth,
                 "beside the model only the fit of each depth by itself (default: both)"),
        cli_choice("method", "likelihood|grid", &o->method,
                   "likelihood: law, arms, contacts and specimens together, by one statistical\n"
                   "model (default; doc/likelihood.md); grid: the procedure of Sedef 2008,\n"
                   "Section 4.3.3, with one or two arms"),
        cli_flag("hold-only", &o->dwell_only,
                 "fit the model to the dwells only, without the ramps (the fit of each\n"
                 "depth always does, since K(e) is not constant on a ramp)"),
        cli_flag("fit-filtered", &o->fit_filtered,
                 "fit the filtered force instead of the raw one (biased; to compare)"),
        cli_heading("Recordings"),
        cli_positive("filter-Hz", "F", 1e6, &o->filter_Hz,
                     "cut-off of the zero-phase Butterworth filter in the figures, Hz\n(default 10, at most "
                     "a fifth of the sampling rate)"),
        cli_positive("specimen-height-mm", "H", 1e4, &o->height_mm,
                     "height of the specimen, mm, instead of the files'"),
        cli_positive("specimen-radius-mm", "R", 1e4, &o->radius_mm,
                     "radius of the specimen, mm, instead of the files'"),
        cli_choice("specimens", "auto|one|name|folder|file", &o->specimens_by,
                   "which runs belong to one specimen: auto: same specimen.name and size (all, if\n"
                   "every run has another name); one: all; name, folder: same name or folder;\n"
                   "file: each run is a specimen. Several specimens are pooled in stress and\n"
                   "strain: the model is that of the mean specimen, with the spread"),
        cli_choice("contact", "auto|known|common|free", &o->contact,
                   "depth of contact: known: as in the recordings; common: one shift for all\n"
                   "runs; free: a shift of each run, with an estimated scatter (default auto:\n"
                   "free where two or more runs identify it)"),
        cli_number("contact-mm", "D", -1e4, 1e4, &o->contact_mm,
                   "recorded depth at which the plate touches, mm (default: estimated)"),
        cli_heading("Tip: moduli of the layer under it"),
        cli_choice("tip", "plate|flat|sphere|cone", &o->tip,
                   "shape of the indenter: a plate over the whole face, or a flat punch, sphere or\n"
                   "cone on a wide layer (default: the files' tip.kind, if any)"),
        cli_positive("tip-radius-mm", "R", 1e4, &o->tip_radius_mm,
                     "radius of the punch or sphere, mm, instead of the files' tip.radius_mm"),
        cli_positive("tip-angle-deg", "A", 90, &o->tip_angle_deg,
                     "half angle of the cone, from its axis, instead of the files' tip.half_angle_deg"),
        cli_number("poisson", "NU", 0, 0.5, &o->poisson,
                   "known Poisson's ratio (default: estimated if tips of different size pressed,\n"
                   "else 0.5)"),
        cli_choice("floor", "bonded|slides", &o->floor,
                   "contact of the layer with its support (default bonded)"),
        cli_flag("tip-sticks", &o->tip_sticks,
                 "no slip at the punch's face or at both plates (default: no friction)"),
        cli_flag("small-strain", &o->small_strain,
                 "moduli of linear elasticity (default: corrected as for a neo-Hookean layer)"),
        cli_heading("Output"),
        cli_out("out", "LUMPED.json", &o->out, "the lumped model"),
        cli_out("spectrum", "FILE.csv", &o->spectrum,
                "storage and loss stiffness by frequency, of oscillating runs and of the model"),
        cli_flag("json", &o->json, "the result as one JSON object on standard output"),
        cli_out("result", "RESULT.json", &o->result,
                "the result and its figures as a file for palpate report"),
        cli_out("report", "PAGE.html", &o->report, "tables and figures on one page"),
    };
    const cli_command command = {
        NAME,
        "RUN.csv ... [options]",
        "Fits a generalized Maxwell solid, with 95 % intervals, to raw static, ramp-and-hold and creep "
        "runs.\n"
        "Contact, zero force and noise of each run are estimated first and reported on standard error.",
        "  palpate characterize static.csv hold_*.csv --out lumped.json --report page.html\n"
        "  palpate characterize hold_*.csv --arms 2 --shared-arms --json\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, o->words, CHARACTERIZE_RUNS_MAX, &o->n_words);
    return code == CLI_OK && o->n_words == 0
               ? cli_usage_error(NAME, "name a RUN.csv; see palpate characterize --help")
               : code;
}

/* "auto" or a whole number from low to high. */
static int number_or_auto(const char *option, const char *text, double low, double high, size_t *number,
                          bool *automatic) {
    double value = 0;
    *automatic = strcmp(text, "auto") == 0;
    if (*automatic)
        return CLI_OK;
    if (!cli_read_number(text, &value) || value != floor(value) || value < low || value > high)
        return cli_usage_error(NAME, "--%s must be auto or a whole number from %g to %g, not \"%s\"", option,
                               low, high, text);
    *number = (size_t)value;
    return CLI_OK;
}

/* "log:N" and "fractional", else as above. */
static int read_arms(characterize_options *o) {
    double value = 0;
    o->arms_auto = true;
    if (strcmp(o->arms_text, "fractional") == 0) {
        o->fractional = true;
        return CLI_OK;
    }
    if (strncmp(o->arms_text, "log:", 4) != 0)
        return number_or_auto("arms", o->arms_text, 0, PALP_ARMS_MAX, &o->arms, &o->arms_auto);
    if (!cli_read_number(o->arms_text + 4, &value) || value != floor(value) || value < 1 ||
        value > PALP_ARMS_MAX)
        return cli_usage_error(NAME, "--arms log:N takes a whole number from 1 to %d, not \"%s\"",
                               PALP_ARMS_MAX, o->arms_text + 4);
    o->per_decade = (size_t)value;
    return CLI_OK;
}

static int check_options(characterize_options *o) {
    o->degree_given = o->degree_text != NULL;
    int code = read_arms(o);
    if (code == CLI_OK && o->degree_given)
        code = number_or_auto("degree", o->degree_text, DEGREE_MIN, DEGREE_MAX, &o->degree, &o->degree_auto);
    if (code)
        return code;
    o->law_auto = o->law_choice == 0 && !o->degree_given && o->knots == 0 && o->method == METHOD_LIKELIHOOD;
    o->law = o->law_choice > 0 ? o->law_choice - 1 : o->knots > 0 ? PALP_LAW_SPLINE : PALP_LAW_POLYNOMIAL;
    if (o->law != PALP_LAW_POLYNOMIAL && o->degree_given)
        return cli_usage_error(NAME, "--degree goes with --law polynomial");
    if (o->law != PALP_LAW_SPLINE && o->knots > 0)
        return cli_usage_error(NAME, "--knots goes with --law spline");
    if (o->shared_arms && o->per_depth)
        return cli_usage_error(NAME, "give --shared-arms or --per-depth, not both (default: both fits)");
    if (o->method == METHOD_GRID && (o->arms_auto || o->arms < 1 || o->arms > 2))
        return cli_usage_error(NAME, "--method grid needs --arms 1 or --arms 2");
    if (o->method == METHOD_GRID && (o->law != PALP_LAW_POLYNOMIAL || o->per_depth))
        return cli_usage_error(NAME, "--method grid fits shared arms and a polynomial; leave out %s",
                               o->per_depth ? "--per-depth" : "--law");
    o->knots = o->knots ? o->knots : 5;
    return code;
}

/* ---- the model ---- */

static int write_model(const characterize_options *o, const characterize_state *s) {
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = s->run[0].height_m};
    palp_error error = {PALP_OK, ""};
    for (size_t i = 0; i < s->n; i++)
        model.radius_m = model.radius_m > 0 ? model.radius_m : s->run[i].radius_m;
    if (model.radius_m > 0)
        strcpy(model.specimen_kind, "cylinder");
    model.material = s->material;
    double fractional[3];
    if (o->fractional && s->has_final) {
        const palp_estimate *element =
            &s->final.estimate[s->final.n_estimates - 3]; /* the last three: K_frac, tau_frac, exponent */
        for (size_t k = 0; k < 3; k++)
            fractional[k] = element[k].value;
        model.fractional = fractional;
    }
    model.covariance = s->has_final ? s->final.covariance : NULL;
    model.between = s->n_points > 0 ? s->specimens.between : NULL;
    model.n_specimens = s->n_points > 0 ? s->n_specimens : 0;
    palp_status status = o->out ? palp_model_write(&model, o->out, &error) : PALP_OK;
    if (status && palp_law_minimum(&s->material.law, characterize_strain_max(s)) <= 0)
        return cli_failure(NAME,
                           "%s: not written, as K(e) falls to zero within the measured strain of %.3g; try "
                           "another --degree or --law",
                           o->out, characterize_strain_max(s));
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

static int characterize(const characterize_options *o, characterize_state *s) {
    int code = characterize_read(o, s);
    code = code ? code : characterize_model(o, s);
    code = code ? code : write_model(o, s);
    code = code || !o->spectrum ? code : characterize_write_spectrum(o->spectrum, s);
    if (code == CLI_OK && !o->json)
        code = characterize_print(o, s);
    json_t *figures = code == CLI_OK && (o->result || o->report) ? characterize_figures(s) : NULL;
    if (code == CLI_OK && (o->result || o->report) && !figures)
        code = CLI_FAILURE;
    if (code == CLI_OK)
        code = page_result(NAME, characterize_json(o, s), figures, o->json, o->result, o->report);
    return code == CLI_OK && !characterize_fit_of(s)->converged ? CLI_NOT_CONVERGED : code;
}

static void state_free(characterize_state *s) {
    for (size_t i = 0; i < s->n; i++) {
        palp_recording_free(&s->run[i]);
        palp_spectrum_free(&s->spectrum[i]);
        free(s->filtered_N[i]);
    }
    for (size_t i = 0; i < s->n_single; i++)
        palp_lumped_fit_free(&s->single[i]);
    palp_lumped_fit_free(&s->shared);
    palp_lumped_fit_free(&s->final);
    palp_specimens_fit_free(&s->specimens);
    free(s);
}

int cmd_characterize(int argc, char **argv) {
    characterize_options o = {.arms_text = "auto", .degree = 5, .contact_mm = NAN, .tip = -1, .poisson = NAN};
    cli_keep_command(argc, argv, o.command);
    int code = parse(argc, argv, &o);
    code = code ? code : check_options(&o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    characterize_state *s = calloc(1, sizeof *s);
    if (!s)
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    code = characterize(&o, s);
    state_free(s);
    return code;
}
