/* cmd_inclusion.c: palpate inclusion: a stiffer or softer ball or layer in a network, from a map of presses
 * by spheres. */
#include "shared/cli.h"
#include "shared/commands.h"
#include "shared/json_out.h"
#include "shared/opening.h"
#include "shared/press.h"

#include <math.h>
#include <palpate/palpation.h>
#include <palpate/recording.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "inclusion";

enum { PRESSES_MAX = 400, GRID = 7 };

typedef struct inclusion_options {
    const char *words[1 + PRESSES_MAX];
    size_t n_words, subdivisions;
    double false_alarm;
    const char *out;
    bool json;
    int gain; /* 1: known */
} inclusion_options;

typedef struct inclusion {
    palp_model model;
    palp_mesh_source source;
    palp_mesh *mesh;
    size_t n, n_candidates;
    palp_palpation_press press[PRESSES_MAX], candidate[GRID * GRID];
    palp_palpation found;
} inclusion;

static int parse(int argc, char **argv, inclusion_options *o) {
    const cli_option options[] = {
        cli_heading("Search"),
        cli_positive("false-alarm", "P", 0.5, &o->false_alarm,
                     "something is found if the probability of neither is below P (default 0.05)"),
        cli_choice(
            "gain", "fitted|known", &o->gain,
            "fitted: a factor of all forces is not known (default); known: the network was calibrated\n"
            "on this very tissue and protocol"),
        cli_count("subdivisions", "N", 0, 4, &o->subdivisions,
                  "subdivisions of the surface for contact, see doc/simulator.md (default 2)"),
        cli_heading("Output"),
        cli_out("out", "MODEL.json", &o->out,
                "the network with the ball or layer as the region \"inclusion\""),
        cli_flag("json", &o->json, "the answer as JSON on standard output"),
    };
    const cli_command command = {
        NAME,
        "NETWORK.json PRESS.csv PRESS.csv ... [options]",
        "Finds a ball of another stiffness in tissue, or a layer at its surface, from at least 8 presses by\n"
        "spheres, all with the same protocol. A layer needs presses of two depths or radii, or a known "
        "gain.\n"
        "Headers of the recordings have tip.kind sphere, tip.radius_mm, tip.x_mm and tip.z_mm. Says which\n"
        "of both it is, where, how large and how stiff, with 95 % intervals, and where to press next.",
        "  palpate inclusion liver.json map_*.csv --out liver_with_nodule.json\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, o->words, 1 + PRESSES_MAX, &o->n_words);
    if (code == CLI_OK && o->n_words < 2)
        return cli_usage_error(NAME, "name a NETWORK.json and presses; see palpate inclusion --help");
    return code;
}

/* ---- presses -------------------------------------------------------------------------------------- */

/* Mean force from half the largest depth on to it, by the work of the first way there. */
static bool mean_of_deeper_half(const palp_recording *r, double *force_N) {
    double work = 0.0, way = 0.0, reached = 0.5 * r->deepest_m;
    for (size_t i = 1; i < r->n && r->depth_m[i - 1] < r->deepest_m; i++) {
        if (!(r->depth_m[i] > reached) || !r->use[i])
            continue;
        const double step = r->depth_m[i] - reached;
        work += step * r->force_N[i];
        way += step;
        reached = r->depth_m[i];
    }
    *force_N = work / way;
    return way > 0.0 && *force_N > 0.0;
}

static int press_of_run(inclusion *s, const char *file, const palp_experiment *run) {
    palp_palpation_press *press = &s->press[s->n++];
    palp_recording_settings settings = palp_recording_settings_default();
    palp_recording recording;
    palp_error error = {PALP_OK, ""};
    double low[3], high[3], radius_m, at_m[2];
    int code = open_tip(NAME, file, run, &radius_m, at_m);
    if (code)
        return code;
    if (!(radius_m > 0.0) || !isfinite(at_m[0]) || !isfinite(at_m[1]))
        return cli_failure(NAME, "%s: a press of a map is by a sphere at a place, tip.x_mm and tip.z_mm",
                           file);
    palp_mesh_bounds(s->mesh, low, high);
    settings.height_m = high[1] - low[1];
    palp_status status = palp_recording_prepare(run, file, &settings, &recording, &error);
    if (status)
        return cli_status_of(NAME, file, status, &error);
    press->tool = press_sphere(s->mesh, radius_m, at_m[0], at_m[1]);
    press->depth_m = recording.deepest_m;
    if (!isfinite(press->tool.position_m[1]))
        code = cli_failure(NAME, "%s: nothing of the network is below the sphere at x = %.4g, z = %.4g mm",
                           file, 1e3 * at_m[0], 1e3 * at_m[1]);
    else if (!mean_of_deeper_half(&recording, &press->force_N))
        code = cli_failure(NAME, "%s: no force from half the depth on", file);
    palp_recording_free(&recording);
    return code;
}

static int read_presses(const inclusion_options *o, inclusion *s) {
    int code = CLI_OK;
    for (size_t i = 1; i < o->n_words && code == CLI_OK; i++) {
        palp_experiment *run = NULL;
        code = open_run(NAME, o->words[i], &run);
        if (code == CLI_OK)
            code = press_of_run(s, o->words[i], run);
        palp_experiment_free(run);
    }
    return code;
}

/* A grid of places within the map, as deep as the first press. */
static void list_candidates(inclusion *s) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < s->n; i++)
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], s->press[i].tool.position_m[2 * k]);
            high[k] = fmax(high[k], s->press[i].tool.position_m[2 * k]);
        }
    for (int i = 0; i < GRID * GRID; i++) {
        palp_palpation_press *c = &s->candidate[s->n_candidates];
        c->depth_m = s->press[0].depth_m;
        c->tool = press_sphere(s->mesh, s->press[0].tool.radius_m,
                               low[0] + (high[0] - low[0]) * (i / GRID) / (GRID - 1),
                               low[1] + (high[1] - low[1]) * (i % GRID) / (GRID - 1));
        s->n_candidates += isfinite(c->tool.position_m[1]) ? 1 : 0;
    }
}

static int show(void *user, double share) {
    progress_update(user, share);
    return 0;
}

static int search(const inclusion_options *o, inclusion *s) {
    palp_palpation_settings settings = palp_palpation_settings_default();
    palp_error error = {PALP_OK, ""};
    progress bar;
    settings.false_alarm = o->false_alarm;
    settings.contact.subdivisions = o->subdivisions;
    settings.gain_known = o->gain == 1;
    list_candidates(s);
    settings.n_candidates = s->n_candidates;
    settings.candidate = s->candidate;
    settings.progress = show;
    settings.user = &bar;
    progress_start(&bar, "inclusion: presses");
    const palp_status status = palp_palpate(&s->model, s->mesh, s->n, s->press, &settings, &s->found, &error);
    progress_finish(&bar);
    return status ? cli_status_of(NAME, o->words[0], status, &error) : CLI_OK;
}

/* ---- the answer ----------------------------------------------------------------------------------- */

/* From the surface above its middle to the ball, m. */
static double cover_of_ball(const inclusion *s) {
    static const double POINT = 1e-6;
    const palp_palpation *p = &s->found;
    const palp_tool above = press_sphere(s->mesh, POINT, p->x_m.best, p->z_m.best);
    return above.position_m[1] - POINT - p->y_m.best - p->radius_m.best;
}

static json_t *value_json(const palp_palpation_value *v, double unit) {
    return json_pack("{s:o, s:o, s:o}", "value", json_number_or_null(unit * v->best), "low",
                     json_number_or_null(unit * v->low), "high", json_number_or_null(unit * v->high));
}

/* Where to press next; NULL: the network could not be pressed at all candidates. */
static const double *next_place(const inclusion *s) {
    return s->found.next < s->n_candidates ? s->candidate[s->found.next].tool.position_m : NULL;
}

static int print_json(const inclusion *s) {
    const palp_palpation *p = &s->found;
    static const char *const KIND[] = {"none", "ball", "layer"};
    json_t *ball = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o}", "x_mm", value_json(&p->x_m, 1e3), "y_mm", value_json(&p->y_m, 1e3),
        "z_mm", value_json(&p->z_m, 1e3), "radius_mm", value_json(&p->radius_m, 1e3), "stiffness_factor",
        value_json(&p->stiffness, 1.0), "cover_mm", json_number_or_null(1e3 * cover_of_ball(s)));
    json_t *layer = json_pack("{s:o, s:o}", "thickness_mm", value_json(&p->thickness_m, 1e3),
                              "stiffness_factor", value_json(&p->layer_stiffness, 1.0));
    const double *next = next_place(s);
    json_t *place =
        next ? json_pack("{s:f, s:f}", "x_mm", 1e3 * next[0], "z_mm", 1e3 * next[2]) : json_null();
    return json_print(NAME, json_pack("{s:I, s:b, s:s, s:o, s:o, s:o, s:o, s:f, s:f, s:f, s:f, s:f, s:o}",
                                      "presses", (json_int_t)s->n, "found", p->found, "kind", KIND[p->kind],
                                      "evidence", json_number_or_null(p->evidence), "evidence_layer",
                                      json_number_or_null(p->evidence_layer), "ball", ball, "layer", layer,
                                      "scatter", p->scatter, "scatter_with_ball", p->scatter_found,
                                      "scatter_with_layer", p->scatter_layer, "gain", p->gain,
                                      "gain_with_layer", p->gain_layer, "next_press", place));
}

static void print_value(const char *name, const palp_palpation_value *v, double unit, const char *of) {
    printf("  %-10s %8.3g %s, 95 %% interval %.3g to ", name, unit * v->best, of, unit * v->low);
    if (isinf(v->high))
        printf("any\n");
    else
        printf("%.3g\n", unit * v->high);
}

static void print_ball(const inclusion *s) {
    const palp_palpation *p = &s->found;
    print_value("x", &p->x_m, 1e3, "mm");
    print_value("y", &p->y_m, 1e3, "mm");
    print_value("z", &p->z_m, 1e3, "mm");
    print_value("radius", &p->radius_m, 1e3, "mm");
    print_value("stiffness", &p->stiffness, 1.0, "times");
    printf("  %-10s %8.3g mm, from the surface to the ball\n", "cover", 1e3 * cover_of_ball(s));
    printf("With this ball they differ by %.2g %%.\n", 100.0 * p->scatter_found);
}

static void print_layer(const palp_palpation *p) {
    print_value("thickness", &p->thickness_m, 1e3, "mm");
    print_value("stiffness", &p->layer_stiffness, 1.0, "times");
    printf("With this layer they differ by %.2g %%.\n", 100.0 * p->scatter_layer);
}

/* The layer is more probable than the ball. */
static bool is_layer(const palp_palpation *p) {
    return p->evidence_layer > p->evidence;
}

static void print_text(const inclusion *s) {
    static const char *const FOUND[] = {"Neither a ball nor a layer is found",
                                        "A ball of another stiffness is there",
                                        "A layer of another stiffness is there"};
    const palp_palpation *p = &s->found;
    const double most = fmax(0.0, fmax(p->evidence, p->evidence_layer)), none = exp(-most),
                 ball = exp(p->evidence - most), layer = exp(p->evidence_layer - most),
                 all = none + ball + layer;
    printf("%s: evidence of a ball %.1f, of a layer %.1f nats over neither\n", FOUND[p->kind], p->evidence,
           p->evidence_layer);
    printf("Probabilities of a ball %.3f, a layer %.3f, neither %.3f in %zu presses\n", ball / all,
           layer / all, none / all, s->n);
    printf("Forces differ by %.2g %% from those of the tissue alone%s%s\n", 100.0 * p->scatter,
           p->found ? ":" : "; the best ",
           p->found      ? ""
           : is_layer(p) ? "layer is"
                         : "ball is");
    if (is_layer(p))
        print_layer(p);
    else
        print_ball(s);
    const double *next = next_place(s);
    if (next)
        printf("Press next at x = %.3g mm, z = %.3g mm.\n", 1e3 * next[0], 1e3 * next[2]);
}

/* The more probable of both as a region. */
static palp_region region_found(const inclusion *s) {
    const palp_palpation *p = &s->found;
    palp_region region = {.name = "inclusion"};
    if (is_layer(p)) {
        region.shape = PALP_REGION_BOX;
        region.stiffness = p->layer_stiffness.best;
        palp_mesh_bounds(s->mesh, region.low_m, region.high_m);
        region.low_m[1] = region.high_m[1] - p->thickness_m.best;
    } else {
        region.shape = PALP_REGION_SPHERE;
        region.stiffness = p->stiffness.best;
        region.centre_m[0] = p->x_m.best;
        region.centre_m[1] = p->y_m.best;
        region.centre_m[2] = p->z_m.best;
        region.radius_m = p->radius_m.best;
    }
    return region;
}

static int answer(const inclusion_options *o, inclusion *s) {
    palp_error error = {PALP_OK, ""};
    if (o->out) {
        s->source.regions[s->source.n_regions++] = region_found(s);
        const palp_status status = palp_model_write(&s->model, o->out, &error);
        if (status)
            return cli_status(NAME, status, &error);
    }
    if (o->json)
        return print_json(s);
    print_text(s);
    return CLI_OK;
}

static int find(const inclusion_options *o, inclusion *s) {
    palp_error error = {PALP_OK, ""};
    int code = open_model_of(NAME, o->words[0], PALP_MODEL_NETWORK, "is a lumped model; give a network",
                             &s->model, &s->source);
    if (code)
        return code;
    const palp_status status = palp_model_mesh(&s->model, &s->mesh, &error);
    if (status)
        return cli_status_of(NAME, o->words[0], status, &error);
    code = read_presses(o, s);
    if (code == CLI_OK)
        code = search(o, s);
    return code ? code : answer(o, s);
}

int cmd_inclusion(int argc, char **argv) {
    inclusion_options o = {.false_alarm = 0.05, .subdivisions = 2};
    int code = parse(argc, argv, &o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    inclusion *s = calloc(1, sizeof *s);
    if (!s)
        return cli_status(NAME, PALP_ERR_NO_MEMORY, NULL);
    code = find(&o, s);
    palp_mesh_free(s->mesh);
    free(s);
    return code;
}
