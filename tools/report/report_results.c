/* report_results.c: the sections of a report on fits, parameters, the law, the network, simulations. */
#include "shared/digits.h"
#include "report.h"

#include <math.h>
#include <string.h>

static const char *base_of(const json_t *object) {
    return cli_base(json_text_at(object, "file"));
}

/* ---- fits and residuals ---- */

static void table_spread(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "spread"), *at;
    if (json_array_size(list) == 0)
        return;
    html_table(to, "Spread of the static presses", "strain|mean force (N)|sd (%)|lowest (N)|highest (N)");
    for (size_t i = 0; (at = json_array_get(list, i)) != NULL; i++)
        html_row(to, "%.3f|%#.4g|%.2f|%#.4g|%#.4g", json_number_at(at, "strain"),
                 json_number_at(at, "mean_N"),
                 100 * json_number_at(at, "sd_N") / json_number_at(at, "mean_N"), json_number_at(at, "low_N"),
                 json_number_at(at, "high_N"));
    html_table_end(to);
}

static void table_runs(FILE *to, const json_t *all) {
    const json_t *runs = json_object_get(all, "runs"), *run;
    html_table(to, "Residuals of the model", "recording|rms (mN)|rms over noise|largest (% of peak)|sum (N)");
    for (size_t i = 0; (run = json_array_get(runs, i)) != NULL; i++)
        html_row(to, "%s|%#.4g|%#.3g|%.2f|%#.5g", base_of(run), 1e3 * json_number_at(run, "rms_N"),
                 json_number_at(run, "rms_noise"), json_number_at(run, "largest_residual_percent"),
                 json_number_at(run, "absolute_N"));
    html_table_end(to);
}

/* "8.18 -0.7 47.5": coefficients in ascending powers. */
static void coefficients(const json_t *list, char *line, size_t size) {
    const json_t *value;
    size_t n = 0;
    line[0] = '\0';
    for (size_t i = 0; (value = json_array_get(list, i)) != NULL && n < size; i++)
        n += (size_t)snprintf(line + n, size - n, "%s%.5g", i ? ", " : "", json_number_value(value));
}

static void table_static(FILE *to, const json_t *all) {
    const json_t *statics = json_object_get(all, "static"), *one, *polynomial;
    char line[512];
    for (size_t i = 0; (one = json_array_get(statics, i)) != NULL; i++) {
        snprintf(line, sizeof line, "Plain polynomials of %s", base_of(one));
        html_table(to, line, "degree of F(e)|norm of the residual (N)|~coefficients of e, e^2, ... (N)");
        const json_t *list = json_object_get(one, "polynomials");
        for (size_t k = 0; (polynomial = json_array_get(list, k)) != NULL; k++) {
            coefficients(json_object_get(polynomial, "coefficients_N"), line, sizeof line);
            html_row(to, "%.0f|%.4g|~%s", json_number_at(polynomial, "degree"),
                     json_number_at(polynomial, "norm_N"), line);
        }
        html_table_end(to);
    }
}

static void table_scores(FILE *to, const json_t *list, const char *key, const char *what) {
    char heads[128];
    const json_t *row;
    if (json_array_size(list) == 0)
        return;
    snprintf(heads, sizeof heads, "%s|held-out error|s.e. of the excess|rms over noise|~", what);
    html_table(to, "Error on blocks left out of the fit, over the noise variance", heads);
    for (size_t i = 0; (row = json_array_get(list, i)) != NULL; i++) {
        char ratio[32];
        html_number(ratio, json_object_get(row, "rms_noise"), 4);
        html_row(to, "%.0f|%.5g|%.3g|%s|~%s", json_number_at(row, key), json_number_at(row, "held_out"),
                 json_number_at(row, "excess_sd"), ratio,
                 json_is_true(json_object_get(row, "taken")) ? "taken" : "");
    }
    html_table_end(to);
}

void report_fits(FILE *to, report *r) {
    const report_file *f;
    if (!r->has_fits)
        return;
    html_section(to, "fits", "Fits and residuals");
    fputs("<div class=\"figures\">\n", to);
    report_figure(to, r, "fit_linear", "The model (dark) over the raw samples (light).");
    report_figure(to, r, "fit_log", "The same over the logarithm of time.");
    report_figure(to, r, "fit_first", "The first ten seconds, with the ramp.");
    report_figure(to, r, "fit_depth",
                  "Force against depth, loops included: the model (dark) over the raw samples (light).");
    report_figure(to, r, "residuals",
                  "Model minus measured in units of the noise of a sample; means of short stretches.");
    report_figure(to, r, "fit_static", "The slow press: the model with its arms at work.");
    report_figure(to, r, "static_polynomials",
                  "Plain polynomials through the slow press, as if it were at rest.");
    report_figure(to, r, "arms_score",
                  "More arms always fit better; these errors are of samples that the fit did not see.");
    report_figure(to, r, "degree_score", "Which degree of the force polynomial.");
    fputs("</div>\n", to);
    for (size_t i = 0; (f = report_find(r, REPORT_CHARACTERIZE, i)) != NULL; i++) {
        fputs("<div class=\"tables\">\n", to);
        table_runs(to, f->json);
        table_scores(to, json_object_get(f->json, "arms_scores"), "n_arms", "arms");
        table_scores(to, json_object_get(f->json, "degree_scores"), "degree", "degree of F(e)");
        table_spread(to, f->json);
        table_static(to, f->json);
        fputs("</div>\n", to);
    }
}

/* ---- parameters ---- */

static void estimate_row(FILE *to, const json_t *e) {
    double low = json_number_at(e, "low"), high = json_number_at(e, "high");
    double half = 0.5 * (high - low);
    char value[DIGITS_TEXT], from[DIGITS_TEXT], end[DIGITS_TEXT];
    if (json_is_true(json_object_get(e, "determined")))
        html_row(to, "%s|%s|%s to %s|~%s", json_text_at(e, "name"),
                 digits_text(value, json_number_at(e, "value"), half), digits_text(from, low, half),
                 digits_text(end, high, half), json_text_at(e, "unit"));
    else
        html_row(to, "%s|not determined|%.1g to %.1g|~%s", json_text_at(e, "name"), low, high,
                 json_text_at(e, "unit"));
}

static void table_estimates(FILE *to, const char *caption, const json_t *list) {
    const json_t *e;
    if (json_array_size(list) == 0)
        return;
    html_table(to, caption, "parameter|value|95 % interval|~unit");
    for (size_t i = 0; (e = json_array_get(list, i)) != NULL; i++)
        estimate_row(to, e);
    html_table_end(to);
}

static void list_pairs(FILE *to, const json_t *all) {
    const json_t *rows = json_object_get(all, "correlation"), *names = json_object_get(all, "estimates");
    size_t found = 0;
    for (size_t i = 0; i < json_array_size(rows); i++) {
        for (size_t j = i + 1; j < json_array_size(rows); j++) {
            double c = json_number_value(json_array_get(json_array_get(rows, i), j));
            if (fabs(c) > 0.95) {
                fputs(
                    found++
                        ? ", "
                        : "<p class=\"about\">Correlated above 0.95, so that only their combination is known "
                          "well: ",
                    to);
                html_text(to, json_text_at(json_array_get(names, i), "name"));
                fputs(" and ", to);
                html_text(to, json_text_at(json_array_get(names, j), "name"));
                fprintf(to, " (%.3f)", c);
            }
        }
    }
    fputs(found ? ".</p>\n" : "", to);
}

/* "7.608 ± 0.012" or "not determined" of the estimate of a name. */
static void cell(const json_t *list, const char *name, char line[64]) {
    const json_t *e;
    strcpy(line, "-");
    for (size_t i = 0; (e = json_array_get(list, i)) != NULL; i++) {
        size_t n = strlen(name);
        if (strncmp(json_text_at(e, "name"), name, n) == 0 &&
            (json_text_at(e, "name")[n] == '\0' || json_text_at(e, "name")[n] == ' ')) {
            double half = 0.5 * (json_number_at(e, "high") - json_number_at(e, "low"));
            char value[DIGITS_TEXT], more[DIGITS_TEXT];
            if (json_is_true(json_object_get(e, "determined")))
                snprintf(line, 64, "%.28s \u00b1 %.28s", digits_text(value, json_number_at(e, "value"), half),
                         digits_text(more, half, half));
            else
                strcpy(line, "not determined");
            return;
        }
    }
}

static size_t most_arms(const json_t *list) {
    const json_t *one;
    size_t most = 0;
    char name[32], line[64];
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL; i++) {
        for (size_t j = most + 1; j <= 5; j++) {
            snprintf(name, sizeof name, "K_%zu", j);
            cell(json_object_get(one, "estimates"), name, line);
            most = strcmp(line, "-") ? j : most;
        }
    }
    return most;
}

static void table_depths(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "per_depth"), *one;
    char line[1024], name[32], value[64];
    size_t arms = most_arms(list);
    if (json_array_size(list) == 0)
        return;
    size_t n = (size_t)snprintf(line, sizeof line, "depth (mm)|strain|K_inf (N)");
    for (size_t j = 1; j <= arms; j++)
        n += (size_t)snprintf(line + n, sizeof line - n, "|K_%zu (N)|b_%zu (N s)", j, j);
    snprintf(line + n, sizeof line - n, "|rms over noise");
    html_table(to, "The hold of each depth alone", line);
    for (size_t i = 0; (one = json_array_get(list, i)) != NULL; i++) {
        const json_t *estimates = json_object_get(one, "estimates");
        cell(estimates, "K_inf", value);
        n = (size_t)snprintf(line, sizeof line, "%.4g|%.4f|%s", json_number_at(one, "depth_mm"),
                             json_number_at(one, "strain"), value);
        for (size_t j = 1; j <= arms; j++) {
            for (int k = 0; k < 2; k++) {
                snprintf(name, sizeof name, "%c_%zu", k ? 'b' : 'K', j);
                cell(estimates, name, value);
                n += (size_t)snprintf(line + n, sizeof line - n, "|%s", value);
            }
        }
        snprintf(line + n, sizeof line - n, "|%.3g", json_number_at(one, "rms_noise"));
        html_row(to, "%s", line);
    }
    html_table_end(to);
}

void report_parameters(FILE *to, report *r) {
    const report_file *f = report_find(r, REPORT_CHARACTERIZE, 0);
    if (!f)
        return;
    html_section(to, "parameters", "Parameters");
    for (size_t i = 0; (f = report_find(r, REPORT_CHARACTERIZE, i)) != NULL; i++) {
        const json_t *shared = json_object_get(f->json, "shared");
        fputs("<div class=\"tables\">\n", to);
        table_estimates(to, "The model: one law, one set of arms", json_object_get(f->json, "estimates"));
        table_estimates(to, "Arms shared by all holds, K_inf of each", json_object_get(shared, "estimates"));
        fputs("</div>\n", to);
        list_pairs(to, f->json);
        table_depths(to, f->json);
    }
}

/* ---- the stiffness law ---- */

static void formula(FILE *to, const palp_law *law) {
    fputs("<p>", to);
    if (law->kind == PALP_LAW_POLYNOMIAL) {
        fputs("K(e) = ", to);
        for (size_t i = 0; i < law->n; i++) {
            double c = law->coefficients[i];
            fprintf(to, "%s%.5g", i ? (c < 0 ? " \u2212 " : " + ") : (c < 0 ? "\u2212" : ""), fabs(c));
            if (i > 0)
                fprintf(to, i > 1 ? " e<sup>%zu</sup>" : " e", i);
        }
        fputs(" N", to);
    } else if (law->kind == PALP_LAW_SPLINE) {
        fputs("A monotone cubic through (strain, N):", to);
        for (size_t i = 0; i < law->n; i++)
            fprintf(to, " (%.3g, %.4g)", law->strain[i], law->coefficients[i]);
    } else {
        fprintf(to, "%s of a cylinder of %.4g mm\u00b2:", palp_law_kind_name(law->kind), 1e6 * law->area_m2);
        for (size_t i = 0; i < law->n; i++)
            fprintf(to, " %.5g", law->coefficients[i]);
        fputs(" Pa", to);
    }
    fputs("</p>\n", to);
}

static void table_gap(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "comparison"), *g;
    char plain[32];
    if (json_array_size(list) == 0)
        return;
    html_table(to, "K_inf: ramp and hold, static press as if at rest, model",
               "strain|ramp and hold (N)|static polynomial (N)|model (N)");
    for (size_t i = 0; (g = json_array_get(list, i)) != NULL; i++) {
        html_number(plain, json_object_get(g, "static_plain_N"), 4);
        html_row(to, "%.4f|%#.4g|%s|%#.4g", json_number_at(g, "strain"), json_number_at(g, "ramp_hold_N"),
                 plain, json_number_at(g, "joint_N"));
    }
    html_table_end(to);
}

static void table_arms(FILE *to, const char *caption, const report_file *f) {
    if (f->model.material.n_arms > 0) {
        html_table(to, caption, "arm|stiffness (N)|viscosity (N s)|time (s)|beta");
        for (size_t j = 0; j < f->model.material.n_arms; j++) {
            const palp_arm *a = &f->model.material.arms[j];
            html_row(to, "%zu|%#.4g|%#.4g|%#.4g|%#.4g", j + 1, a->stiffness_N, a->viscosity_Ns,
                     a->viscosity_Ns / a->stiffness_N, a->beta);
        }
        html_table_end(to);
    }
}

/* Of several specimens: what they are, and their mean with both bands. */
static void table_specimens(FILE *to, const json_t *all) {
    const json_t *about = json_object_get(all, "specimens"), *list = json_object_get(about, "each"), *at;
    if (json_array_size(list) == 0)
        return;
    html_table(to, "Specimens, pooled in stress and strain",
               "specimen|height (mm)|radius (mm)|runs|stress by that of all");
    for (size_t i = 0; (at = json_array_get(list, i)) != NULL; i++)
        html_row(to, "%s|%.4g|%.4g|%.0f|%.4g", json_text_at(at, "name"), json_number_at(at, "height_mm"),
                 json_number_at(at, "radius_mm"), json_number_at(at, "runs"), json_number_at(at, "factor"));
    html_table_end(to);
    list = json_object_get(about, "stiffness");
    if (json_array_size(list) == 0)
        return;
    html_table(
        to,
        "K_inf of the mean specimen; standard deviation between specimens and within one (what its runs "
        "leave open)",
        "strain|K_inf (N)|95 % of the mean (N)|between (%)|within (%)|95 % of specimens not measured (N)");
    for (size_t i = json_array_size(list) / 5; (at = json_array_get(list, i)) != NULL;
         i += json_array_size(list) / 5) {
        double k = json_number_at(at, "stiffness_N");
        html_row(to, "%.3f|%#.4g|%#.4g to %#.4g|%.3g|%.3g|%#.4g to %#.4g", json_number_at(at, "strain"), k,
                 json_number_at(at, "mean_low_N"), json_number_at(at, "mean_high_N"),
                 100 * json_number_at(at, "between_sd_N") / k, 100 * json_number_at(at, "within_sd_N") / k,
                 json_number_at(at, "specimen_low_N"), json_number_at(at, "specimen_high_N"));
    }
    html_table_end(to);
}

void report_law(FILE *to, report *r) {
    const report_file *f;
    if (!r->has_law)
        return;
    html_section(to, "law", "Stiffness law and arms");
    for (size_t i = 0; (f = report_find(r, REPORT_MODEL, i)) != NULL; i++) {
        if (f->model.kind == PALP_MODEL_LUMPED) {
            fputs("<h3>", to);
            html_text(to, cli_base(f->path));
            fputs("</h3>\n", to);
            formula(to, &f->model.material.law);
            table_arms(to, NULL, f);
        }
    }
    fputs("<div class=\"figures\">\n", to);
    report_figure(to, r, "stiffness_law",
                  "F = K(e) e at rest. A static press that is not slow enough has the arms' force in it.");
    fputs("<div>", to);
    for (size_t i = 0; (f = report_find(r, REPORT_CHARACTERIZE, i)) != NULL; i++)
        table_gap(to, f->json);
    fputs("</div>\n", to);
    report_figure(to, r, "specimens",
                  "Force at rest, K_inf times the strain, of the mean specimen: where 95 % of the means lie "
                  "that the data "
                  "allow, and where 95 % of the specimens lie that were not measured.");
    fputs("<div>", to);
    for (size_t i = 0; (f = report_find(r, REPORT_CHARACTERIZE, i)) != NULL; i++)
        table_specimens(to, f->json);
    fputs("</div></div>\n", to);
}

/* ---- the network ---- */

static void network(FILE *to, const report_file *f) {
    const palp_mesh_source *mesh = &f->mesh;
    fputs("<h3>", to);
    html_text(to, cli_base(f->path));
    fputs("</h3>\n<p>", to);
    if (mesh->kind == PALP_MESH_LATTICE) {
        fprintf(to,
                "A lattice of %zu \u00d7 %zu \u00d7 %zu nodes, %.4g \u00d7 %.4g \u00d7 %.4g mm. Element "
                "law:</p>\n",
                mesh->nodes[0], mesh->nodes[1], mesh->nodes[2], 1e3 * mesh->size_m[0], 1e3 * mesh->size_m[1],
                1e3 * mesh->size_m[2]);
    } else {
        fputs("The mesh of ", to);
        html_text(to, cli_base(mesh->path));
        fputs(". Element law:</p>\n", to);
    }
    formula(to, &f->model.material.law);
}

static void calibrated_depths(FILE *to, const json_t *all) {
    const json_t *depths = json_object_get(all, "depths"), *depth;
    if (json_array_size(depths) > 0) {
        html_table(to, "Network against its target, ramp and hold",
                   "depth (mm)|peak (N)|largest error (% of the peak)");
        for (size_t i = 0; (depth = json_array_get(depths, i)) != NULL; i++)
            html_row(to, "%.4g|%#.4g|%.3f", json_number_at(depth, "depth_mm"),
                     json_number_at(depth, "peak_N"), json_number_at(depth, "max_error_percent"));
        html_table_end(to);
    }
}

static void calibrated(FILE *to, const json_t *all) {
    fputs("<p>Method ", to);
    html_text(to, json_text_at(all, "method"));
    fprintf(to, ", %s.</p>\n",
            json_is_false(json_object_get(all, "converged")) ? "<b>not converged</b>" : "converged");
}

void report_calibrations(FILE *to, report *r) {
    const report_file *f;
    if (!r->has_calibration)
        return;
    html_section(to, "calibration", "Network calibration");
    for (size_t i = 0; (f = report_find(r, REPORT_MODEL, i)) != NULL; i++)
        if (f->model.kind == PALP_MODEL_NETWORK)
            network(to, f);
    for (size_t i = 0; (f = report_find(r, REPORT_CALIBRATE, i)) != NULL; i++)
        calibrated(to, f->json);
    fputs("<div class=\"tables\">\n", to);
    for (size_t i = 0; (f = report_find(r, REPORT_CALIBRATE, i)) != NULL; i++)
        calibrated_depths(to, f->json);
    for (size_t i = 0; (f = report_find(r, REPORT_MODEL, i)) != NULL; i++)
        if (f->model.kind == PALP_MODEL_NETWORK)
            table_arms(to, "Arms of an element", f);
    fputs("</div>\n<div class=\"figures\">\n", to);
    report_figure(to, r, "static_fit", "The static curve: what was wanted and what the network gives.");
    report_figure(to, r, "stiffness", "Stiffness law of the lumped model and of an element.");
    report_figure(to, r, "relaxation_linear", "Ramp and hold: wanted and network.");
    report_figure(to, r, "relaxation_log", "The same over the logarithm of time.");
    report_figure(to, r, "static_convergence", "How the static stage converged.");
    report_figure(to, r, "relaxation_convergence", "How the relaxation stage converged.");
    fputs("</div>\n", to);
}

/* ---- simulations ---- */

void report_simulations(FILE *to, report *r) {
    if (r->n_pairs == 0)
        return;
    html_section(to, "simulation", "Simulation against recordings");
    html_table(to, NULL,
               "simulation|~of the model|~recording|peak (N)|rms error (mN)|largest error (% of the peak)");
    for (size_t i = 0; i < r->n_pairs; i++) {
        const report_pair *p = &r->pair[i];
        const char *model = "-";
        palp_experiment_get_string(p->simulation->experiment, "model.file", &model);
        html_row(to, "%s|~%s|~%s|%#.4g|%#.3g|%#.3g", cli_base(p->simulation->path), cli_base(model),
                 cli_base(p->recording->path), p->peak_N, 1e3 * p->rms_N, p->worst_percent);
    }
    html_table_end(to);
    fputs("<div class=\"figures\">\n", to);
    report_figure(to, r, "simulated_linear",
                  "Simulated (dark) over recorded (light); its 95 % band, if it was simulated with --band.");
    report_figure(to, r, "simulated_log", "The same over the logarithm of time.");
    report_figure(to, r, "simulated_static", "The slow press.");
    fputs("</div>\n", to);
}
