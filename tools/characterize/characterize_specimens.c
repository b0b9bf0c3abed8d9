/* characterize_specimens.c: several specimens in one call: the specimen of each run, one height and area for
 * all, their mean and their spread. */
#include "characterize.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "characterize";

/* ---- which run is of which specimen ---- */

static bool close_to(double a, double b) {
    return fabs(a - b) <= 1e-6 * fmax(fabs(a), fabs(b));
}

static bool same_folder(const char *a, const char *b) {
    const char *end_a = strrchr(a, '/'), *end_b = strrchr(b, '/');
    size_t n = end_a ? (size_t)(end_a - a) : 0;
    return n == (end_b ? (size_t)(end_b - b) : 0) && strncmp(a, b, n) == 0;
}

/* An unknown radius equals any. */
static bool same_size(const palp_recording *a, const palp_recording *b) {
    return close_to(a->height_m, b->height_m) &&
           (a->radius_m == 0 || b->radius_m == 0 || close_to(a->radius_m, b->radius_m));
}

static bool same_specimen(const characterize_options *o, const palp_recording *a, const palp_recording *b) {
    switch (o->specimens_by) {
    case SPECIMENS_ONE:
        return true;
    case SPECIMENS_NAME:
        return strcmp(a->specimen, b->specimen) == 0;
    case SPECIMENS_FOLDER:
        return same_folder(a->name, b->name);
    case SPECIMENS_FILE:
        return false;
    default:
        return strcmp(a->specimen, b->specimen) == 0 && same_size(a, b);
    }
}

/* Name of a specimen for tables, else of its first run. */
const char *characterize_specimen_name(const characterize_state *s, size_t k) {
    for (size_t r = 0; r < s->n; r++)
        if (s->specimen[r] == k)
            return s->run[r].specimen[0] ? s->run[r].specimen : s->run[r].name;
    return "";
}

static int add_to(characterize_state *s, size_t r, size_t k) {
    characterize_body *body = &s->body[k];
    const palp_recording *run = &s->run[r];
    if (k == s->n_specimens)
        s->body[s->n_specimens++] = (characterize_body){.height_m = run->height_m};
    if (!close_to(body->height_m, run->height_m))
        return cli_failure(NAME,
                           "%s: has a height of %g mm, but its specimen \"%s\" has %g mm; assign runs to "
                           "specimens by --specimens, or give --specimen-height-mm",
                           run->name, 1e3 * run->height_m, characterize_specimen_name(s, k),
                           1e3 * body->height_m);
    if (body->radius_m > 0 && run->radius_m > 0 && !close_to(body->radius_m, run->radius_m))
        return cli_failure(NAME,
                           "%s: has a radius of %g mm, but its specimen \"%s\" has %g mm; assign runs to "
                           "specimens by --specimens, or give --specimen-radius-mm",
                           run->name, 1e3 * run->radius_m, characterize_specimen_name(s, k),
                           1e3 * body->radius_m);
    body->radius_m = fmax(body->radius_m, run->radius_m);
    body->n_runs++;
    s->specimen[r] = k;
    return CLI_OK;
}

/* Scales all runs to the mean height and area at unchanged stress and strain. */
static int pool(characterize_state *s) {
    double height = 0, area = 0;
    size_t sized = 0;
    bool differ = false;
    for (size_t k = 0; k < s->n_specimens; k++) {
        height += s->body[k].height_m / (double)s->n_specimens;
        area += s->body[k].radius_m * s->body[k].radius_m / (double)s->n_specimens;
        sized += s->body[k].radius_m > 0;
        differ = differ || !close_to(s->body[k].height_m, s->body[0].height_m);
    }
    if (sized < s->n_specimens && (differ || sized > 0))
        return cli_failure(NAME, "specimens of different size are pooled in stress, which needs their radii; "
                                 "add lines # specimen.radius_mm: R, "
                                 "or give --specimen-radius-mm");
    for (size_t r = 0; r < s->n; r++) {
        const characterize_body *body = &s->body[s->specimen[r]];
        s->run[r].radius_m = body->radius_m;
        palp_recording_scale(&s->run[r], height / body->height_m,
                             sized ? area / (body->radius_m * body->radius_m) : 1.0);
    }
    return CLI_OK;
}

/* Runs of equal size that all have different names. A specimen for each run would leave its scatter between
 * runs unknown. */
static bool each_its_own(const characterize_state *s) {
    for (size_t r = 0; r < s->n; r++)
        for (size_t q = 0; q < r; q++)
            if (strcmp(s->run[r].specimen, s->run[q].specimen) == 0 || !same_size(&s->run[r], &s->run[q]))
                return false;
    return s->n > 1;
}

int characterize_group(const characterize_options *options, characterize_state *s) {
    characterize_options own = *options, *o = &own;
    int code = CLI_OK;
    if (o->specimens_by == SPECIMENS_AUTO && each_its_own(s)) {
        cli_note(NAME, "every run names another specimen: all are taken as runs of one; --specimens name "
                       "separates them");
        o->specimens_by = SPECIMENS_ONE;
    }
    for (size_t r = 0; r < s->n && code == CLI_OK; r++) {
        size_t before = 0;
        while (before < r && !same_specimen(o, &s->run[before], &s->run[r]))
            before++;
        code = add_to(s, r, before < r ? s->specimen[before] : s->n_specimens);
    }
    if (code == CLI_OK && s->n_specimens > 1 &&
        s->has_tip) { /* a tip's force does not scale with area, so only the moduli are pooled */
        characterize_warn(s,
                          "%zu specimens under a tip: their moduli are pooled; the lumped model is fitted to "
                          "all runs as if of one specimen",
                          s->n_specimens);
        s->n_tip_specimens = s->n_specimens;
        s->n_specimens = 1;
    }
    return code || s->n_specimens == 1 ? code : pool(s);
}

static void fill_points(characterize_state *s) {
    double top = characterize_strain_max(s), strain[CHARACTERIZE_BAND];
    for (size_t i = 0; i < CHARACTERIZE_BAND; i++)
        strain[i] = top * (double)i / (CHARACTERIZE_BAND - 1);
    if (palp_specimens_fit_stiffness(&s->specimens, CHARACTERIZE_BAND, strain, s->point) == PALP_OK)
        s->n_points = CHARACTERIZE_BAND;
}

void characterize_take_spread(characterize_state *s) {
    if (s->specimens.n_spread > 0) {
        fill_points(s);
        memcpy(s->factor, s->specimens.factor, s->n_specimens * sizeof *s->factor);
    } else if (s->n_specimens > 1)
        characterize_warn(
            s,
            "no significant difference between the %zu specimens: all runs are fitted as of one "
            "specimen",
            s->n_specimens);
    s->final = s->specimens.mean;
    memset(&s->specimens.mean, 0, sizeof s->specimens.mean);
}

/* Index of parameter i of the model (coefficients, K_j, b_j) among the estimates, which include tau_j. */
static size_t estimate_of(const palp_lumped_fit *fit, size_t i) {
    size_t springs = fit->material.law.n;
    return i < springs ? i : springs + 3 * ((i - springs) / 2) + (i - springs) % 2;
}

static void print_points(const characterize_state *s) {
    printf("  K_inf of the mean specimen; sd between specimens with its 95 %% interval, and within one (from "
           "the uncertainty of its fit)\n");
    printf("  strain   K_inf (N)   95 %% of the mean     between (%%)   95 %% interval    within (%%)   95 "
           "%% of specimens (N)\n");
    for (size_t i = s->n_points / 5; i < s->n_points; i += s->n_points / 5) {
        const palp_specimens_point *at = &s->point[i];
        double k = at->stiffness_N, part = 100 / k;
        printf("  %6.4f  %10.5g   %8.5g to %-8.5g   %11.3g   %5.3g to %-6.3g  %10.3g   %8.5g to %.5g\n",
               characterize_strain_max(s) * (double)i / (double)(s->n_points - 1), k, k - 1.96 * at->sd_N,
               k + 1.96 * at->sd_N, part * at->between_N, part * at->between_low, part * at->between_high,
               part * at->within_N, k - 1.96 * at->new_sd_N, k + 1.96 * at->new_sd_N);
    }
}

void characterize_print_specimens(const characterize_state *s) {
    if (s->n_specimens < 2)
        return;
    int width = 8;
    for (size_t k = 0; k < s->n_specimens; k++) {
        int length = (int)strlen(characterize_specimen_name(s, k));
        width = length > width ? length : width;
    }
    printf("Specimens: %zu, pooled in stress and strain; forces are for their mean size, height %.4g mm",
           s->n_specimens, 1e3 * s->run[0].height_m);
    printf(s->run[0].radius_m > 0 ? " and radius %.4g mm\n" : "\n", 1e3 * s->run[0].radius_m);
    printf("  %-*s  height (mm)  radius (mm)  runs   stress relative to mean\n", width, "specimen");
    for (size_t k = 0; k < s->n_specimens; k++) {
        const characterize_body *body = &s->body[k];
        printf("  %-*s  %11.4g  %11.4g  %4zu  %22.4g\n", width, characterize_specimen_name(s, k),
               1e3 * body->height_m, 1e3 * body->radius_m, body->n_runs, s->factor[k]);
    }
    if (s->n_points == 0)
        return;
    const size_t n = s->final.n_parameters;
    printf("  parameter        mean   sd between specimens   sd within one\n");
    for (size_t i = 0; i < n; i++) {
        const palp_estimate *e = &s->final.estimate[estimate_of(&s->final, i)];
        printf("  %-9s  %10.5g  %21.4g  %14.4g %s\n", e->name, e->value,
               sqrt(s->specimens.between[i * n + i]), sqrt(s->specimens.within[i * n + i]), e->unit);
    }
    print_points(s);
}

static json_t *bodies_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t k = 0; k < s->n_specimens; k++) {
        const characterize_body *body = &s->body[k];
        json_t *to = json_object();
        json_object_set_new(to, "name", json_text(characterize_specimen_name(s, k)));
        json_object_set_new(to, "runs", json_integer((json_int_t)body->n_runs));
        json_figures(to, {"height_mm", 1e3 * body->height_m}, {"radius_mm", 1e3 * body->radius_m},
                     {"factor", s->factor[k]});
        json_array_append_new(list, to);
    }
    return list;
}

static json_t *parameters_json(const characterize_state *s) {
    const size_t n = s->n_points ? s->final.n_parameters : 0;
    json_t *list = json_array();
    for (size_t i = 0; i < n; i++) {
        const palp_estimate *e = &s->final.estimate[estimate_of(&s->final, i)];
        json_array_append_new(list, json_pack("{s:s, s:s, s:o, s:o, s:o}", "name", e->name, "unit", e->unit,
                                              "mean", json_number_or_null(e->value), "between_sd",
                                              json_number_or_null(sqrt(s->specimens.between[i * n + i])),
                                              "within_sd",
                                              json_number_or_null(sqrt(s->specimens.within[i * n + i]))));
    }
    return list;
}

static json_t *points_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < s->n_points; i++) {
        const palp_specimens_point *at = &s->point[i];
        json_t *to = json_object();
        json_figures(to, {"strain", characterize_strain_max(s) * (double)i / (double)(s->n_points - 1)},
                     {"stiffness_N", at->stiffness_N}, {"mean_low_N", at->stiffness_N - 1.96 * at->sd_N},
                     {"mean_high_N", at->stiffness_N + 1.96 * at->sd_N}, {"between_sd_N", at->between_N},
                     {"between_low_N", at->between_low}, {"between_high_N", at->between_high},
                     {"within_sd_N", at->within_N}, {"specimen_low_N", at->stiffness_N - 1.96 * at->new_sd_N},
                     {"specimen_high_N", at->stiffness_N + 1.96 * at->new_sd_N});
        json_array_append_new(list, to);
    }
    return list;
}

json_t *characterize_json_specimens(const characterize_state *s) {
    if (s->n_specimens < 2)
        return json_null();
    return json_pack("{s:I, s:o, s:o, s:b, s:o, s:o, s:o}", "count", (json_int_t)s->n_specimens, "height_mm",
                     json_number_or_null(1e3 * s->run[0].height_m), "radius_mm",
                     json_number_or_null(1e3 * s->run[0].radius_m), "differ", s->n_points > 0, "each",
                     bodies_json(s), "parameters", parameters_json(s), "stiffness", points_json(s));
}
