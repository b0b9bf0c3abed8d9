/* cmd_calibrate.c: palpate calibrate: the element material with which a network meets wanted curves. */
#include "calibrate.h"
#include "shared/commands.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "calibrate";
static const double LEAST_POISSON = 0.25, MOST_POISSON = 0.49;

/* ---- the command line; each function returns the number of its options ---- */

static size_t network_options(calibrate_options *o, cli_option *to) {
    const cli_option options[] = {
        cli_heading("Network"),
        cli_counts("nodes", "N[,N,N]", 2, 200, &o->nodes,
                   "nodes of a lattice along x, y (direction of the press) and z"),
        cli_numbers("size-mm", "MM[,MM,MM]", 1e4, &o->size_mm,
                    "size of the lattice, mm (default: the specimen's height)"),
        cli_in("mesh", "FILE.msh", &o->mesh,
               "instead of --nodes: a Gmsh 2.2 or 4.1 file of tetrahedra or hexahedra"),
        cli_positive("scale-mm", "MM", 1e6, &o->scale_mm, "unit of length of the mesh file, mm (default 1)"),
        cli_flag("hex-diagonals", &o->hex_diagonals,
                 "also put elements on the diagonals of the file's hexahedra; without\n"
                 "them the hexahedra have little resistance to shear"),
        cli_choice("scaling", "none|volume|continuum", &o->scaling,
                   "stiffness of the elements: none: all equal, as in Sedef 2008; volume: by\n"
                   "the volume of the tetrahedra; continuum: as an isotropic solid, for\n"
                   "tetrahedra with elements across their faces (default)"),
        cli_positive("area-mm2", "MM2", 1e8, &o->area_mm2,
                     "area by which a scaled element's K (N) is a modulus, mm2 (default: the\n"
                     "specimen's cross-section, or the mesh's volume over its height)"),
        cli_positive("poisson", "RATIO", MOST_POISSON, &o->poisson,
                     "Poisson's ratio of the network as a solid at rest, 0.25 to 0.49:\n"
                     "springs alone have 0.25 (default: that of --start, or 0.25, or found\n"
                     "from runs of tips of different size, one a sphere); soft\n"
                     "tissue is near 0.45. Its cells then resist a change of volume"),
        cli_choice("branch", "continue|stable", &o->branch,
                   "equilibrium to follow where the network buckles: the one that\n"
                   "Newton's method finds (default), or a stable one"),
    };
    memcpy(to, options, sizeof options);
    return sizeof options / sizeof options[0];
}

static size_t fit_options(calibrate_options *o, cli_option *to) {
    const cli_option options[] = {
        cli_heading("Fit"),
        cli_choice("stage", "static|relaxation|all", &o->stage,
                   "the stiffness law, the arms, or both (default all)"),
        cli_choice("method", "nlopt|fixed_point|three_phase", &o->method,
                   "nlopt: least squares (default); fixed_point and three_phase: the\n"
                   "iterations of Sedef 2008 for the law and the arms (Figures 5.6 and\n"
                   "5.21); with --stage all either name means both"),
        cli_choice("formulation", "history|sedef2008", &o->formulation,
                   "time integration of an element: history: exact (default);\n"
                   "sedef2008: Eq. 5.4, one arm"),
        cli_choice("dwell", "equilibrium|frozen", &o->dwell,
                   "three_phase: in the dwell nodes move to equilibrium (default), or\n"
                   "stay where the ramp leaves them, as in the tables of Sedef 2008"),
        cli_choice("law", "polynomial|spline", &o->law, "form of the stiffness law (default polynomial)"),
        cli_count("degree", "N", 0, 12, &o->degree, "degree of the polynomial (default 4)"),
        cli_count("knots", "N", 2, PALP_LAW_MAX, &o->knots, "number of knots of the spline (default 8)"),
        cli_count("arms", "N", 1, PALP_ARMS_MAX, &o->arms,
                  "Maxwell arms of an element (default: as many as the lumped model)"),
        cli_flag("strain-dependent", &o->strain_dependent,
                 "let the stiffness of the arms grow with strain, K (1 + beta |e|)"),
        cli_in("start", "NETWORK.json", &o->start,
               "first guess. --stage relaxation takes its law (default: from a static\n"
               "stage first), and its mesh unless --nodes or --mesh is given. Its\n"
               "regions stay"),
        cli_text("fit-region", "NAME[,NAME]", &o->regions,
                 "stiffness of these regions of --start, beside the law; from runs of spheres\n"
                 "that stand over them (tip.x_mm, tip.z_mm in their headers) and of plates"),
    };
    memcpy(to, options, sizeof options);
    return sizeof options / sizeof options[0];
}

static size_t curve_options(calibrate_options *o, cli_option *to) {
    const cli_option options[] = {
        cli_heading(
            "Target curves (from the runs of the kind that a stage needs, else from the lumped model)"),
        cli_numbers("depth-mm", "LIST", 1e4, &o->depth_mm,
                    "static: largest depth (default for 24 mm of height: 9.7); relaxation, all:\n"
                    "depths of the dwells (default 1.5,2,...,7; three_phase: 6); the defaults\n"
                    "stay within the depths at which the lumped model was measured"),
        cli_count("steps", "N", 10, 1e7, &o->steps,
                  "samples of the static curve (default 97000, 1e-4 mm each, as in Sedef\n"
                  "2008; the residual is the 2-norm over all samples)"),
        cli_positive("ramp-s", "S", 1e6, &o->ramp_s, "duration of the ramp, s (default 1)"),
        cli_number("hold-s", "S", 0, 1e6, &o->hold_s, "duration of the dwell, s (default 200)"),
        cli_positive("dt-ms", "MS", 1e6, &o->dt_ms,
                     "time step, ms (default: three_phase 1; nlopt: steps that grow in the dwell)"),
        cli_flag(
            "every-step", &o->every_step,
            "solve every sample of the static curve (default: only as many as\nits interpolation needs)"),
    };
    memcpy(to, options, sizeof options);
    return sizeof options / sizeof options[0];
}

static size_t output_options(calibrate_options *o, cli_option *to) {
    const cli_option options[] = {
        cli_heading("Output"),
        cli_out("out", "NETWORK.json", &o->out, "the calibrated network"),
        cli_flag("json", &o->json, "the result as one JSON object on standard output"),
        cli_out("result", "RESULT.json", &o->result,
                "the result and its figures as a file for palpate report"),
        cli_out("report", "PAGE.html", &o->report, "tables and figures on one page"),
    };
    memcpy(to, options, sizeof options);
    return sizeof options / sizeof options[0];
}

static size_t check_options_of(calibrate_options *o, cli_option *to) {
    const cli_option options[] = {
        cli_heading("Check under tools (of a finished network, a box without regions)"),
        cli_in("check", "NETWORK.json", &o->check,
               "instead: press spheres into it and list their force relative to that of\n"
               "the solid that it models; --out writes it with its \"validity\""),
        cli_numbers("tip-radius-mm", "LIST", 1e4, &o->tip_radius_mm,
                    "of the spheres (default 3,5,10 of 24 mm); their depths: --depth-mm\n"
                    "(default 0.5,1,2 of 24 mm)"),
        cli_count("subdivisions", "N", 0, 4, &o->subdivisions,
                  "of the surface that the spheres touch (default: the library's)"),
    };
    memcpy(to, options, sizeof options);
    return sizeof options / sizeof options[0];
}

static int parse(int argc, char **argv, calibrate_options *o) {
    cli_option options[48];
    size_t n = network_options(o, options);
    n += fit_options(o, options + n);
    n += curve_options(o, options + n);
    n += check_options_of(o, options + n);
    n += output_options(o, options + n);
    const cli_command command = {
        NAME,
        "LUMPED.json [RUN.csv ...] --nodes N [options]\n"
        "       palpate calibrate --check NETWORK.json [options]",
        "Fits the stiffness law and the arms of a network's elements, so that its force equals that of a\n"
        "lumped model, or of measured runs (protocol.kind static or ramp_hold). If a run is of a sphere\n"
        "(tip.kind), the runs of plates and spheres are met at once, and the lumped model is the first "
        "guess.",
        "  palpate calibrate data/sedef2008/lumped_n2.json --nodes 5 --strain-dependent --out network.json\n"
        "  palpate calibrate data/sedef2008/lumped_n1.json --nodes 3 --stage static --method fixed_point "
        "--json\n",
        options,
        n};
    int code = cli_parse(&command, argc, argv, o->words, 1 + RUNS_MAX, &o->n_words);
    o->lumped = o->words[0];
    return code == CLI_OK && o->n_words == 0 && !o->check
               ? cli_usage_error(NAME, "name a LUMPED.json; see palpate calibrate --help")
               : code;
}

static int check_mesh(const calibrate_options *o) {
    if (o->nodes.n && o->mesh)
        return cli_usage_error(NAME, "give either --nodes or --mesh");
    if (!o->nodes.n && !o->mesh && !o->start)
        return cli_usage_error(NAME, "name the network: --nodes N, --mesh FILE.msh or --start NETWORK.json");
    if (o->size_mm.n && !o->nodes.n)
        return cli_usage_error(NAME, "--size-mm goes with --nodes");
    if ((o->scale_mm > 0 || o->hex_diagonals) && !o->mesh)
        return cli_usage_error(NAME, "--scale-mm and --hex-diagonals go with --mesh");
    if ((o->scaling >= 0 || o->area_mm2 > 0) && !o->mesh && !o->nodes.n)
        return cli_usage_error(NAME, "--scaling and --area-mm2 go with --nodes or --mesh");
    if (o->scaling == PALP_SCALING_NONE && o->area_mm2 > 0)
        return cli_usage_error(NAME, "--area-mm2 goes with --scaling volume or continuum");
    if (o->poisson > 0 && o->poisson < LEAST_POISSON)
        return cli_usage_error(NAME, "--poisson is from %g to %g: springs alone have %g", LEAST_POISSON,
                               MOST_POISSON, LEAST_POISSON);
    return CLI_OK;
}

static int check_method(const calibrate_options *o) {
    if (o->stage == STAGE_STATIC && o->method == METHOD_THREE_PHASE)
        return cli_usage_error(NAME, "--method three_phase is for --stage relaxation or all");
    if (o->stage == STAGE_RELAXATION && o->method == METHOD_FIXED_POINT)
        return cli_usage_error(NAME, "--method fixed_point is for --stage static or all");
    bool loops = o->method != METHOD_NLOPT, sedef = o->formulation == PALP_SEDEF2008;
    if (o->stage != STAGE_STATIC && (loops || sedef) && o->arms > 1)
        return cli_usage_error(NAME, "%s has one arm; leave out --arms %zu",
                               loops ? "--method three_phase" : "--formulation sedef2008", o->arms);
    if (o->stage != STAGE_STATIC && (loops || sedef) && o->strain_dependent)
        return cli_usage_error(NAME, "--strain-dependent needs --method nlopt and --formulation history");
    if (o->stage != STAGE_STATIC && loops && o->depth_mm.n > 1)
        return cli_usage_error(NAME, "--method three_phase takes one depth; run it once for each");
    if (o->dwell && (o->stage == STAGE_STATIC || o->method != METHOD_THREE_PHASE))
        return cli_usage_error(NAME, "--dwell goes with --method three_phase");
    if (o->law == LAW_SPLINE && loops && !(o->stage == STAGE_RELAXATION && o->start))
        return cli_usage_error(NAME, "--law spline needs --method nlopt");
    return CLI_OK;
}

static int check_options(const calibrate_options *o) {
    int code = check_mesh(o);
    if (code == CLI_OK)
        code = check_method(o);
    if (code == CLI_OK && o->stage == STAGE_STATIC && o->depth_mm.n > 1)
        code = cli_usage_error(NAME, "--stage static takes one --depth-mm, the deepest");
    return code;
}

static void plan(calibrate_options *o, calibrate_state *s) {
    bool loops = o->method != METHOD_NLOPT;
    s->does_relaxation = o->stage != STAGE_STATIC;
    s->does_static = o->stage != STAGE_RELAXATION || !o->start;
    s->static_method = loops ? METHOD_FIXED_POINT : METHOD_NLOPT;
    s->relaxation_method = loops ? METHOD_THREE_PHASE : METHOD_NLOPT;
    o->scale_mm = o->scale_mm > 0 ? o->scale_mm : 1;
    if (s->does_relaxation && loops) {
        o->arms = 1;
        o->dt_ms = o->dt_ms > 0 ? o->dt_ms : 1;
    }
}

/* Exit code after calibration: 3 if a stage did not converge. */
static int verdict(const calibrate_state *s) {
    bool missed_static = s->does_static && !s->static_result.converged;
    bool missed_relaxation = s->does_relaxation && !s->relaxation_result.converged;
    if (missed_static)
        cli_warning(NAME, "the static stage did not converge; the result is the best law found");
    if (missed_relaxation)
        cli_warning(NAME, "the relaxation stage did not converge; the result is the best arms found");
    return missed_static || missed_relaxation ? CLI_NOT_CONVERGED : CLI_OK;
}

static int write_model(const calibrate_options *o, const calibrate_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_status status = o->out ? palp_model_write(&s->model, o->out, &error) : PALP_OK;
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

static int calibrate(const calibrate_options *o, calibrate_state *s) {
    int code = calibrate_setup(o, s);
    code = code ? code : calibrate_targets(o, s);
    if (code == CLI_OK && s->tools)
        code = calibrate_tools(o, s);
    if (code == CLI_OK && s->does_static)
        code = calibrate_static(o, s);
    if (code == CLI_OK && s->does_relaxation && !s->tools)
        code = calibrate_relaxation(o, s);
    code = code ? code : calibrate_compare(o, s);
    if (code == CLI_OK && o->out)
        code = calibrate_known(o, s);
    code = code ? code : write_model(o, s);
    code = code ? code : calibrate_report(o, s);
    return code ? code : verdict(s);
}

static void state_free(calibrate_state *s) {
    palp_calibration_free(&s->static_result);
    palp_calibration_free(&s->relaxation_result);
    for (size_t i = 0; i < s->n_presses; i++) {
        palp_path_free(&s->press[i].path);
        record_free(&s->press[i].target);
        record_free(&s->press[i].network);
        free(s->press[i].wanted_N);
    }
    double *const arrays[] = {s->depth_m,        s->force_N,    s->lumped_covariance,
                              s->lumped_between, s->covariance, s->between};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    palp_network_free(s->network);
    palp_mesh_free(s->mesh);
    free(s);
}

int cmd_calibrate(int argc, char **argv) {
    calibrate_options o = {.scaling = -1,
                           .stage = STAGE_ALL,
                           .degree = 4,
                           .knots = 8,
                           .steps = 97000,
                           .subdivisions = SIZE_MAX,
                           .ramp_s = 1,
                           .hold_s = 200};
    cli_keep_command(argc, argv, o.command);
    int code = parse(argc, argv, &o);
    if (code == CLI_OK && o.check)
        return calibrate_check(&o);
    if (code == CLI_OK)
        code = check_options(&o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    calibrate_state *s = calloc(1, sizeof *s);
    if (!s)
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    plan(&o, s);
    code = calibrate(&o, s);
    state_free(s);
    return code;
}
