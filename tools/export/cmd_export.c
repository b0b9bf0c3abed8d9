/* cmd_export.c: palpate export: a model for another program. */
#include "calculix.h"
#include "export.h"
#include "export_fmu.h"
#include "shared/cli.h"
#include "shared/commands.h"
#include "shared/opening.h"

#include <math.h>
#include <palpate/model.h>
#include <string.h>

enum { EXPORT_FMU = 8 }; /* after the springs and the solids */

static int check_solid(const export_options *o) {
    if (o->depth_mm.n + o->strain.n > 1)
        return cli_usage_error("export", "a solid is pressed to one depth");
    if (o->json && (!o->out || strcmp(o->out, "-") == 0))
        return cli_usage_error("export", "--json needs --out FILE: standard output has one of them only");
    return CLI_OK;
}

static int parse(int argc, char **argv, export_options *o, const char **model) {
    const cli_option options[] = {
        cli_choice("to", "calculix-springs|calculix|abaqus|febio|sofa|mujoco|newton|vega|fmu", &o->to,
                   "the other program. The first gets springs (default); fmu is any model as it is,\n"
                   "FMI 3.0 for co-simulation; all others get a solid"),
        cli_heading("Presses"),
        cli_numbers("depth-mm", "LIST", 1e4, &o->depth_mm,
                    "springs: depths, mm; one static step each. Solid: one depth, of the fit to\n"
                    "the model and of the scene (default the recordings', or a quarter of the height)"),
        cli_numbers("strain", "LIST", 0.95, &o->strain, "depths as a share of the height"),
        cli_positive("rate-mm-s", "V", 1e4, &o->rate_mm_s,
                     "solid: rate of the scene's ramp (default the first recording's, or 1)"),
        cli_positive("hold-s", "T", 1e6, &o->hold_s,
                     "solid: dwell (default 3 of the longest relaxation times, at least 10)"),
        cli_heading("Solid"),
        cli_in("runs", "RUN.csv[,...]", &o->runs,
               "recordings of the plate to fit (default: the model's own force)"),
        cli_choice("law", "yeoh|neo-hookean|mooney-rivlin|st-venant", &o->law,
                   "of those that the program has: calculix and abaqus the first three, sofa\n"
                   "the second and third, vega the second and fourth (default: the first)"),
        cli_number("poisson", "NU", 0, 0.49, &o->poisson,
                   "Poisson's ratio (default the model's; 0.25 of springs, 0.45 of a lumped model)"),
        cli_flag("slide", &o->slides, "the plates slide; else they are bonded to the tissue"),
        cli_count("nodes", "N", 2, 64, &o->nodes, "lumped model: nodes a side of its mesh (default 7)"),
        cli_positive("density-kg-m3", "D", 1e5, &o->density_kg_m3,
                     "of the tissue, if the program needs one (default the model's, or 1000)"),
        cli_heading("Springs"),
        cli_count("table-points", "N", 5, 200, &o->points,
                  "points of each force-elongation table, rounded down to an odd number\n"
                  "(default and most 199: CalculiX drops points of longer tables)"),
        cli_positive("table-strain", "E", 0.99, &o->table_strain,
                     "strain range of the tables, -E to E (default 1.2 x the largest strain;\n"
                     "0.95 with a Poisson's ratio, where elements stretch by more);\n"
                     "beyond it CalculiX keeps the force constant"),
        cli_positive("step-strain", "E", 1, &o->step_strain,
                     "largest increment of a step, as a share of the height (default 0.01)"),
        cli_heading("Output"),
        cli_out("out", "FILE", &o->out, "the deck or scene (default: standard output)"),
        cli_flag("json", &o->json, "solid: the fit as JSON on standard output; needs --out"),
    };
    const cli_command command = {
        "export",
        "MODEL.json [--to PROGRAM] [options]",
        "Writes a solid of another program, fitted to the model or to recordings: its law, mesh, supports\n"
        "and a press, and the error of the plate's force. Or the fully relaxed network as springs of\n"
        "CalculiX, with a static step to each depth.",
        "  palpate export network.json --to febio --runs run1.csv,run2.csv --out tissue.feb\n"
        "  palpate export network.json --strain 0.1,0.2,0.3,0.4 --out network.inp\n"
        "  ccx -i network && cat network.dat\n"
        "  palpate export network.json --to fmu --out network.fmu\n",
        options,
        sizeof options / sizeof options[0]};
    size_t n = 0;
    int code = cli_parse(&command, argc, argv, model, 1, &n);
    if (code == CLI_OK && n == 0)
        return cli_usage_error("export", "name a MODEL.json; see palpate export --help");
    if (code == CLI_OK && o->to == EXPORT_FMU)
        return o->depth_mm.n + o->strain.n == 0 && !o->runs && !o->json
                   ? CLI_OK
                   : cli_usage_error("export", "an FMU takes its depths from the importer; leave out --%s",
                                     o->runs         ? "runs"
                                     : o->json       ? "json"
                                     : o->depth_mm.n ? "depth-mm"
                                                     : "strain");
    if (code == CLI_OK && o->to > 0)
        return check_solid(o);
    if (code == CLI_OK && (o->runs || o->json))
        return cli_usage_error("export", "--%s is for a solid; name a program by --to",
                               o->json ? "json" : "runs");
    if (code == CLI_OK && (o->depth_mm.n > 0) == (o->strain.n > 0))
        return cli_usage_error("export", "give the depths by either --depth-mm or --strain");
    return code;
}

/* Depths in m, and the tables' reach. */
static int presses(const export_options *o, const char *model, calculix_deck *deck,
                   double depth_m[CLI_LIST_MAX]) {
    double deepest = 0;
    deck->n_depths = o->depth_mm.n ? o->depth_mm.n : o->strain.n;
    for (size_t i = 0; i < deck->n_depths; i++) {
        depth_m[i] = o->depth_mm.n ? 1e-3 * o->depth_mm.value[i] : o->strain.value[i] * deck->height_m;
        deepest = fmax(deepest, depth_m[i]);
        if (i > 0 && depth_m[i] == depth_m[i - 1])
            return cli_usage_error("export", "two successive steps go to %g mm; leave one out",
                                   1e3 * depth_m[i]);
    }
    if (deepest >= 0.95 * deck->height_m)
        return cli_usage_error("export",
                               "a depth of %g mm is not below the height of %g mm of %s; press less",
                               1e3 * deepest, 1e3 * deck->height_m, model);
    deck->depth_m = depth_m;
    deck->table_strain = o->table_strain > 0  ? o->table_strain
                         : deck->n_solids > 0 ? 0.95
                                              : fmin(0.95, 1.2 * deepest / deck->height_m);
    return CLI_OK;
}

static int write_deck(const export_options *o, const palp_model *model, const char *path,
                      const palp_network *network) {
    const palp_mesh *mesh = palp_network_mesh(network);
    palp_support supports[2];
    double low[3], high[3], depth_m[CLI_LIST_MAX];
    palp_file file;
    palp_supports_default(supports);
    palp_mesh_bounds(mesh, low, high);
    calculix_deck deck = {.mesh = mesh,
                          .law = &model->material.law,
                          .model = path,
                          .n_supports = 2,
                          .supports = supports,
                          .height_m = high[1] - low[1],
                          .step_strain = o->step_strain,
                          .table_points = o->points - (o->points % 2 == 0)};
    deck.factor = palp_network_element_scale(network);
    palp_network_volume_solids(network, &deck.n_solids, &deck.corners, &deck.solids);
    deck.solid_Pa = palp_network_volume_moduli(network);
    int code = presses(o, path, &deck, depth_m);
    if (code == CLI_OK)
        code = cli_file_open("export", o->out, &file);
    if (code)
        return code;
    palp_status status = calculix_write(&deck, file.stream);
    if (status) {
        palp_file_abandon(&file);
        return cli_status_of("export", path, status, NULL);
    }
    return cli_file_close("export", &file);
}

int cmd_export(int argc, char **argv) {
    export_options o = {.law = -1,
                        .points = CALCULIX_POINTS_MAX,
                        .nodes = 7,
                        .step_strain = 0.01,
                        .poisson = NAN,
                        .density_kg_m3 = 1000};
    const char *path = NULL;
    palp_model model;
    palp_mesh_source source;
    palp_mesh *mesh = NULL;
    palp_error error = {PALP_OK, ""};
    int code = parse(argc, argv, &o, &path);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    if (o.to == EXPORT_FMU)
        return export_fmu(path, o.out);
    if (o.to > 0)
        return export_solid(&o, path);
    code = open_model_of("export", path, PALP_MODEL_NETWORK,
                         "is a lumped model, which has no mesh; palpate calibrate makes a network of it",
                         &model, &source);
    if (code)
        return code;
    for (size_t r = 0; r < source.n_regions; r++)
        if (source.regions[r].stiffness == 0 || source.regions[r].fibre_Pa > 0)
            return cli_failure("export",
                               "%s: its regions have materials of their own or fibres; only their "
                               "stiffness_factor and poisson_ratio can be exported",
                               path);
    palp_network *network = NULL;
    palp_status status = palp_model_mesh(&model, &mesh, &error);
    model.n_effects = 0; /* the deck is that of the network without effects */
    if (!status)
        status = palp_network_from_model(&model, mesh, 0, NULL, NULL, &network, &error);
    code = status ? cli_status("export", status, &error) : write_deck(&o, &model, path, network);
    palp_network_free(network);
    palp_mesh_free(mesh);
    return code;
}
