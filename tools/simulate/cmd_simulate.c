/* cmd_simulate.c: palpate simulate: presses a model and writes the run. */
#include "shared/cli.h"
#include "shared/commands.h"
#include "shared/opening.h"
#include "simulate.h"

#include <math.h>
#include <stdint.h>
#include <palpate/palpate.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "simulate";

static int parse(int argc, char **argv, simulate_options *o) {
    const cli_option options[] = {
        cli_heading("Protocol"),
        cli_choice("protocol", "static|ramp_hold|cyclic|creep", &o->protocol, "motion of the plate"),
        cli_in("like", "RUN.csv", &o->like, "instead: follow the recorded depth of a run, at its samples"),
        cli_positive("depth-mm", "MM", 1e4, &o->depth_mm, "depth to press to, mm (not creep)"),
        cli_positive("rate-mm-s", "R", 1e6, &o->rate_mm_s,
                     "speed of the plate, mm/s (default: static 0.1, cyclic 1; ramp_hold:\n"
                     "use it instead of --ramp-s)"),
        cli_positive("ramp-s", "S", 1e9, &o->ramp_s, "duration of the ramp, s (ramp_hold, creep; default 1)"),
        cli_number("hold-s", "S", 0, 1e9, &o->hold_s,
                   "duration of the dwell, s (ramp_hold, creep; default 200)"),
        cli_count("cycles", "N", 1, 1e5, &o->cycles,
                  "number of presses, each with its return (cyclic; default 3)"),
        cli_positive("force-N", "F", 1e6, &o->force_N, "force on the plate, N (creep)"),
        cli_flag("relaxed", &o->relaxed, "fully relaxed force at every sample (static)"),
        cli_choice("tip", "plate|sphere", &o->tip,
                   "what presses a network (default: tip.kind of --like, or the plate): a\n"
                   "smooth sphere, down onto the middle of its top"),
        cli_positive("tip-radius-mm", "MM", 1e4, &o->tip_radius_mm,
                     "of the sphere (default: tip.radius_mm of --like)"),
        cli_number("tip-x-mm", "MM", -1e4, 1e4, &o->tip_mm[0],
                   "its place on the network (default: tip.x_mm of --like, or the middle)"),
        cli_number("tip-z-mm", "MM", -1e4, 1e4, &o->tip_mm[1], "likewise"),
        cli_heading("Solution"),
        cli_positive("dt-ms", "MS", 1e9, &o->dt_ms, "fixed time steps of at most MS ms"),
        cli_positive("tolerance", "REL", 0.1, &o->tolerance,
                     "instead: steps with this error of the force, relative to the largest\n"
                     "force (default 1e-4)"),
        cli_choice("branch", "continue|stable", &o->branch,
                   "equilibrium to follow where the network buckles: the one that\n"
                   "Newton's method finds (default), or a stable one"),
        cli_counts("nodes", "N[,N,N]", 2, 200, &o->nodes,
                   "nodes along x, y and z, instead of those of the model's lattice"),
        cli_count("ranks", "N", 1, 1e5, &o->ranks,
                  "divide a network over N processes of mpirun, for millions of nodes (a\n"
                  "build with PETSC=1)"),
        cli_choice("solver", "auto|band|simplicial|supernodal", &o->solver, "sparse solver (default auto)"),
        cli_heading("Tester"),
        cli_positive("sample-Hz", "F", 1e9, &o->sample_Hz,
                     "constant sampling rate, Hz (default: samples where the force bends)"),
        cli_number("air-s", "S", 0, 1e6, &o->air_s,
                   "begin S seconds before contact, at the speed of the first ramp\n"
                   "(needs --sample-Hz)"),
        cli_number("noise-N", "SD", 0, 1e6, &o->noise_N,
                   "standard deviation of white Gaussian noise on the force, N"),
        cli_count("seed", "N", 0, 9e15, &o->seed,
                  "seed of the noise (default 1); the same seed gives the same run"),
        cli_number("hum-N", "A", 0, 1e6, &o->hum_N, "amplitude of mains hum on the force, N, at 50 Hz"),
        cli_text("spike", "T,F", &o->spike, "add F newtons to the sample at T s; several: T,F,T,F"),
        cli_number("clip-N", "F", 0, 1e6, &o->clip_N, "the sensor saturates at F and -F newtons"),
        cli_text("drop", "T0,T1", &o->drop,
                 "lose the samples from T0 s until before T1 s; several: T0,T1,T0,T1"),
        cli_heading("Output"),
        cli_out("out", "RUN.csv", &o->out, "the run (default: standard output)"),
        cli_out_folder("vtu", "DIR", &o->vtu, "network.pvd network_*.vtu network_*.pvtu",
                       "frames for ParaView, DIR/network.pvd (networks only)"),
        cli_out("checkpoint", "FILE", &o->checkpoint,
                "the state of a run with --ranks and --dt-ms, for --restart"),
        cli_count("checkpoint-every", "N", 1, 1e9, &o->checkpoint_every,
                  "write it every N steps (default 1)"),
        cli_in("restart", "FILE", &o->restart, "resume from such a state with the same options"),
        cli_count("vtu-every", "N", 1, 1e9, &o->vtu_every, "write a frame every N steps (default 1)"),
        cli_flag("band", &o->band,
                 "columns force_low_N and force_high_N: 95 % band of the force from the model's\n"
                 "covariance, without sensor noise; for a model of several specimens the band\n"
                 "of a specimen that was not measured"),
        cli_flag("json", &o->json, "a summary as JSON on standard output; the run goes to --out only"),
    };
    const cli_command command = {
        NAME,
        "MODEL.json --protocol P [options]",
        "Presses a lumped or network model and writes time_s, depth_mm, force_N.",
        "  palpate simulate network.json --protocol ramp_hold --depth-mm 6 --hold-s 50 --out run.csv\n"
        "  palpate simulate network.json --like measured.csv --out simulated.csv\n",
        options,
        sizeof options / sizeof options[0]};
    const char *words[1] = {NULL};
    size_t n = 0;
    int code = cli_parse(&command, argc, argv, words, 1, &n);
    o->model = words[0];
    return code == CLI_OK && n == 0 ? cli_usage_error(NAME, "name a MODEL.json; see palpate simulate --help")
                                    : code;
}

enum { STATIC = 1, RAMP_HOLD = 2, CYCLIC = 4, CREEP = 8 };

static int check_options(simulate_options *o) {
    static const char *const protocols[] = {"static", "ramp_hold", "cyclic", "creep"};
    const struct {
        const char *option;
        bool given;
        int goes_with;
    } uses[] = {{"depth-mm", o->depth_mm > 0, STATIC | RAMP_HOLD | CYCLIC},
                {"rate-mm-s", o->rate_mm_s > 0, STATIC | RAMP_HOLD | CYCLIC},
                {"ramp-s", o->ramp_s > 0, RAMP_HOLD | CREEP},
                {"hold-s", o->hold_s >= 0, RAMP_HOLD | CREEP},
                {"cycles", o->cycles > 0, CYCLIC},
                {"force-N", o->force_N > 0, CREEP},
                {"relaxed", o->relaxed, STATIC}};
    if ((o->protocol >= 0) == (o->like != NULL))
        return cli_usage_error(NAME, "give the motion of the plate by either --protocol or --like");
    for (size_t i = 0; i < sizeof uses / sizeof uses[0]; i++) {
        if (uses[i].given && (o->like || !(uses[i].goes_with & (1 << o->protocol))))
            return cli_usage_error(NAME, "--%s does not go with %s%s", uses[i].option,
                                   o->like ? "--like" : "--protocol ", o->like ? "" : protocols[o->protocol]);
    }
    if (o->rate_mm_s > 0 && o->ramp_s > 0)
        return cli_usage_error(NAME, "--rate-mm-s and --ramp-s both set the speed; leave one out");
    if (o->protocol >= 0 && !(o->protocol == 3 ? o->force_N > 0 : o->depth_mm > 0))
        return cli_usage_error(NAME, "--protocol %s needs --%s", protocols[o->protocol],
                               o->protocol == 3 ? "force-N" : "depth-mm");
    if (o->dt_ms > 0 && o->tolerance > 0)
        return cli_usage_error(NAME, "give either --dt-ms or --tolerance");
    return simulate_sensor_check(o);
}

static void set_defaults(simulate_options *o) {
    if (o->rate_mm_s <= 0 && (o->protocol == 0 || o->protocol == 2))
        o->rate_mm_s = o->protocol == 0 ? 0.1 : 1;
    if (o->ramp_s <= 0)
        o->ramp_s = o->rate_mm_s > 0 && o->protocol == 1 ? o->depth_mm / o->rate_mm_s : 1;
    o->hold_s = o->hold_s >= 0 ? o->hold_s : 200;
    o->cycles = o->cycles ? o->cycles : 3;
    o->tolerance = o->tolerance > 0 ? o->tolerance : 1e-4;
}

/* The depths of a run, with times from 0. Without effects negative depth (air) becomes 0. */
static palp_status path_like(const palp_experiment *run, bool air, palp_path *path) {
    const double *time_s = palp_experiment_column(run, "time_s");
    const double *depth_mm = palp_experiment_column(run, "depth_mm");
    size_t n = palp_experiment_rows(run);
    palp_status status = palp_path_create(n, time_s, depth_mm, path);
    for (size_t i = 0; status == PALP_OK && i < n; i++) {
        path->time_s[i] -= time_s[0];
        path->depth_m[i] = 1e-3 * (air ? path->depth_m[i] : fmax(path->depth_m[i], 0));
    }
    return status;
}

static int make_path(const simulate_options *o, const palp_experiment *like, bool air, palp_path *path) {
    palp_status status = PALP_OK;
    double depth_m = 1e-3 * o->depth_mm;
    if (like)
        status = palp_experiment_rows(like) < 2 ? PALP_ERR_INPUT : path_like(like, air, path);
    else if (o->protocol == 0)
        status = palp_path_static(depth_m, 1e-3 * o->rate_mm_s, path);
    else if (o->protocol == 1)
        status = palp_path_ramp_hold(depth_m, o->ramp_s, o->hold_s, path);
    else if (o->protocol == 2)
        status = palp_path_cyclic(depth_m, 1e-3 * o->rate_mm_s, o->cycles, path);
    else
        status = palp_path_creep(o->force_N, o->ramp_s, o->hold_s, path);
    if (status == PALP_ERR_INPUT)
        return cli_failure(NAME, "%s: needs at least two samples to follow", o->like);
    return status ? cli_status_of(NAME, o->like ? o->like : "--protocol", status, NULL) : CLI_OK;
}

static int check_path(const simulate_options *o, const palp_path *path, double height_m) {
    double deepest = 0, length = path->time_s[path->n - 1];
    for (size_t i = 0; path->depth_m && i < path->n; i++)
        deepest = fmax(deepest, path->depth_m[i]);
    if (o->dt_ms > 0 && length / (1e-3 * o->dt_ms) > 1e8)
        return cli_usage_error(NAME, "%g s in steps of %g ms are too many steps; raise --dt-ms", length,
                               o->dt_ms);
    if (deepest < height_m)
        return CLI_OK;
    if (o->like)
        return cli_failure(NAME,
                           "%s: depth_mm reaches %g, beyond the model's height of %g mm; use the model of "
                           "that specimen",
                           o->like, 1e3 * deepest, 1e3 * height_m);
    return cli_usage_error(NAME, "--depth-mm %g is beyond the model's height of %g mm; press less",
                           o->depth_mm, 1e3 * height_m);
}

static int override_nodes(const simulate_options *o, simulation *s) {
    double nodes[3];
    if (o->vtu && s->model.kind != PALP_MODEL_NETWORK)
        return cli_usage_error(NAME, "--vtu needs a network; %s is a lumped model", o->model);
    if (o->nodes.n == 0)
        return CLI_OK;
    if (s->model.kind != PALP_MODEL_NETWORK || s->source.kind != PALP_MESH_LATTICE)
        return cli_usage_error(NAME, "--nodes changes a lattice; %s has none", o->model);
    if (!cli_spread(&o->nodes, nodes))
        return cli_usage_error(NAME, "--nodes must be one or three numbers, e.g. 5 or 5,7,5");
    for (int i = 0; i < 3; i++)
        s->source.nodes[i] = (size_t)nodes[i];
    return CLI_OK;
}

/* Strain of a lumped specimen: depth over height; for a network the run gives it. */
static void simulate_judge_range(simulation *s) {
    const palp_law *law = &s->model.material.law;
    bool lumped = s->model.kind == PALP_MODEL_LUMPED && !s->reduced;
    s->beyond_s = -1;
    if (!lumped && s->info.beyond > 0) {
        s->beyond_s = s->info.beyond_s;
        s->strain_max = law->strain_max + s->info.beyond;
    }
    for (size_t i = 0; lumped && i < s->curve.n; i++) {
        double strain = s->curve.depth_m[i] / s->height_m;
        if (palp_law_beyond(law, strain) > 1e-9) {
            s->beyond_s = s->beyond_s < 0 ? s->curve.time_s[i] : s->beyond_s;
            s->strain_max = fmax(s->strain_max, strain);
        }
    }
    if (s->beyond_s >= 0)
        press_warn_beyond(NAME, law, s->strain_max, s->beyond_s);
}

static int run_lumped(const simulate_options *o, simulation *s) {
    press_settings press = {1e-3 * o->dt_ms, o->tolerance, o->relaxed, o->like || o->sample_Hz > 0, 0};
    palp_status status = press_lumped(&s->model.material, s->height_m, &s->path, &press, &s->curve);
    if (status == PALP_ERR_COLLAPSED) {
        cli_failure(NAME, "%g N press the specimen beyond 95 %% of its height; lower --force-N", o->force_N);
        return CLI_NOT_CONVERGED;
    }
    s->info.steps = s->curve.n ? s->curve.n - 1 : 0;
    s->info.peak_force_N = record_peak(&s->curve);
    return status ? cli_status_of(NAME, o->model, status, NULL) : CLI_OK;
}

/* Whether the plate would pull the specimen if bonded to it. */
static bool pulls(const simulate_options *o, const simulation *s) {
    const double rounding = 1e-9;
    double most = 0, least = 0;
    for (size_t i = 0; i < s->curve.n; i++) {
        most = fmax(most, s->curve.force_N[i]);
        least = fmin(least, s->curve.force_N[i]);
    }
    return !s->path.force_N && !o->relaxed && least < -rounding * most;
}

/* Without effects: follows one-sided contact if the plate would pull. */
static int run_plain(const simulate_options *o, simulation *s) {
    int code = s->model.kind == PALP_MODEL_NETWORK ? simulate_network(o, s) : run_lumped(o, s);
    if (code || !pulls(o, s))
        return code;
    if (o->vtu || s->ranks) {
        const char *option = o->vtu ? "vtu" : "ranks";
        cli_warning(NAME,
                    "with --%s the plate stays bonded to the specimen and pulls on its way back; without "
                    "--%s it lifts off",
                    option, option);
        return code;
    }
    record_free(&s->curve);
    return simulate_effects(o, s);
}

/* Reads the model and makes the path. */
static int prepare(const simulate_options *o, simulation *s) {
    palp_error error = {PALP_OK, ""};
    palp_status status = simulate_is_reduced(o->model)
                             ? palp_reduced_read(o->model, &s->model, &s->source, &s->reduced, &error)
                             : palp_model_read(o->model, &s->model, &s->source, &error);
    if (status == PALP_OK && o->like)
        status = palp_experiment_read(o->like, &s->like, &error);
    if (status == PALP_OK && o->like)
        status = open_smooth_path(s->like);
    if (status)
        return cli_status(NAME, status, &error);
    int code = o->band ? simulate_band_check(o, s) : CLI_OK;
    code = code ? code : override_nodes(o, s);
    code = code ? code : simulate_tip(o, s);
    if (code == CLI_OK)
        code = make_path(o, s->like, s->model.n_effects + s->model.n_free > 0, &s->path);
    code = code ? code : simulate_resample(o, &s->path);
    s->height_m = s->reduced ? palp_reduced_describe(s->reduced).height_m : s->model.height_m;
    if (code == CLI_OK && s->model.kind == PALP_MODEL_NETWORK && !s->reduced)
        code = simulate_mesh(o, s);
    return code || !(s->height_m > 0) ? code : check_path(o, &s->path, s->height_m);
}

static int simulate(const simulate_options *o, simulation *s) {
    int code = simulate_ranks_agree(o, s, prepare(o, s));
    if (code)
        return code;
    if (s->reduced)
        code = simulate_reduced(o, s);
    else
        code = s->model.n_effects + s->model.n_free > 0 ? simulate_effects(o, s) : run_plain(o, s);
    simulate_judge_range(s);
    code = code ? code : simulate_sense(o, s);
    if (code == CLI_OK && o->band)
        code = simulate_band(o, s);
    return code ? code : simulate_report(o, s);
}

int cmd_simulate(int argc, char **argv) {
    simulate_options o = {.protocol = -1,
                          .tip = -1,
                          .hold_s = -1,
                          .vtu_every = 1,
                          .checkpoint_every = 1,
                          .seed = SIZE_MAX,
                          .tip_mm = {NAN, NAN}};
    simulation s;
    int code = parse(argc, argv, &o);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    code = check_options(&o);
    if (code)
        return code;
    set_defaults(&o);
    memset(&s, 0, sizeof s);
    code = simulate_ranks_start(argc, argv, &o, &s);
    code = code ? code : simulate(&o, &s);
    palp_network_free(s.network);
    if (palp_ranks_rank(s.ranks) > 0)
        code = CLI_OK; /* the first process answers for all */
    palp_ranks_finish(s.ranks);
    palp_reduced_free(s.reduced);
    palp_mesh_free(s.mesh);
    palp_experiment_free(s.like);
    palp_path_free(&s.path);
    record_free(&s.curve);
    free(s.low_N);
    free(s.high_N);
    return code;
}
