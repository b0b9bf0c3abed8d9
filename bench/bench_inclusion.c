/* bench_inclusion.c: how well palp_palpate finds hidden balls, and how long it takes. A cube of 24 mm with a
 * ball of another stiffness is pressed at 16 places; every fourth has none. The cube that is pressed has 12
 * nodes a side, the one in which the ball is looked for 8. The forces have noise of 0.5 %. change is
 * the largest of a force by the ball, over the noise. bench_inclusion [FIRST LAST]: cases by number (default
 * 1 4; 1 26 has 20 balls); bench_inclusion layers FIRST LAST [known]: layers at the surface, pressed at 9
 * places to two depths by a larger sphere, the gain fitted or known; bench_inclusion lattice FIRST LAST: what
 * a finer lattice shows of the error of another; bench_inclusion map NAME: a map of data/tips/palpation.csv
 * or layers.csv */
#include "bench.h"

#include <palpate/palpation.h>
#include <palpate/region.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TRUE_NODES = 12, NODES = 8, GRID = 4, PRESSES = GRID * GRID, STEPS = 4 };
static const double SIDE = 0.024, RADIUS = 0.004, DEPTH = 1.5e-3, NOISE = 0.005, YOUNG = 2e4; /* Pa */

typedef struct stream {
    unsigned long long state;
} stream;

static double uniform(stream *s, double low, double high) {
    s->state = s->state * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * (double)(s->state >> 11) / 9007199254740992.0;
}

static double normal(stream *s) {
    const double a = uniform(s, 1e-12, 1.0), b = uniform(s, 0.0, 6.283185307179586);
    return sqrt(-2.0 * log(a)) * cos(b);
}

/* Stiffer by 2 to 20 in three of four, else softer by 3 to 20; 1 to 6 mm below the top. */
static palp_region hide_ball(int number, stream *s) {
    palp_region ball = {.name = "hidden", .shape = PALP_REGION_SPHERE};
    s->state = (unsigned long long)(number * 7919 + 1);
    for (int i = 0; i < 10; i++)
        uniform(s, 0.0, 1.0);
    ball.radius_m = uniform(s, 0.003, 0.0055);
    ball.centre_m[0] = uniform(s, 0.008, 0.016);
    ball.centre_m[2] = uniform(s, 0.008, 0.016);
    ball.centre_m[1] = SIDE - uniform(s, 0.001, 0.006) - ball.radius_m;
    const bool stiffer = uniform(s, 0.0, 1.0) < 0.75;
    ball.stiffness = exp(stiffer ? uniform(s, log(2.0), log(20.0)) : -uniform(s, log(3.0), log(20.0)));
    if (number % 4 == 0)
        ball.stiffness = 1.0;
    return ball;
}

static void make_model(size_t nodes, double poisson, palp_mesh_source *source, palp_model *model) {
    memset(source, 0, sizeof *source);
    memset(model, 0, sizeof *model);
    source->kind = PALP_MESH_LATTICE;
    source->neighbourhood = PALP_NEIGHBOURS_26;
    source->scaling = PALP_SCALING_CONTINUUM;
    for (int k = 0; k < 3; k++) {
        source->nodes[k] = nodes;
        source->size_m[k] = SIDE;
    }
    model->kind = PALP_MODEL_NETWORK;
    model->mesh = source;
    model->poisson_ratio = poisson;
    bench_check(palp_law_polynomial(1, (double[]){8.18}, &model->material.law), "law");
}

/* A region that changes nothing. */
static const palp_region NOTHING = {.name = "hidden",
                                    .shape = PALP_REGION_SPHERE,
                                    .centre_m = {0.012, 0.012, 0.012},
                                    .radius_m = 0.004,
                                    .stiffness = 1.0};

/* Mean force over the deeper half, in small steps. */
static double press(palp_network *net, palp_tool tool, double depth) {
    const double top = tool.position_m[1];
    double sum = 0.0;
    palp_tool_force felt;
    palp_network_reset(net);
    for (int i = 0; i <= STEPS; i++) {
        tool.position_m[1] = top - depth * (0.5 + 0.5 * i / STEPS);
        palp_network_set_tools(net, 1, &tool);
        bench_check(palp_network_step(net, 0.0, INFINITY, NULL), "step");
        palp_network_tool_force(net, &felt);
        sum += felt.force_N[1] * (i == 0 || i == STEPS ? 0.5 : 1.0) / STEPS;
    }
    return sum;
}

/* Places on a grid so many a side, each to n_depths depths up to this one. Returns their number. */
static int plan_presses(int grid, int n_depths, double radius, double depth, palp_palpation_press *map) {
    const int n = grid * grid * n_depths;
    for (int i = 0; i < n; i++) {
        const int place = i / n_depths;
        palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = radius};
        tool.position_m[0] = 0.0045 + 0.015 * (place / grid) / (grid - 1);
        tool.position_m[1] = SIDE + radius;
        tool.position_m[2] = 0.0045 + 0.015 * (place % grid) / (grid - 1);
        map[i] = (palp_palpation_press){.tool = tool, .depth_m = depth * (1 + i % n_depths) / n_depths};
    }
    return n;
}

/* Forces without noise. */
static void map_presses(size_t nodes, const palp_region *hidden, int n, palp_palpation_press *map) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_contact_settings contact = palp_contact_settings_default();
    palp_mesh_source source;
    palp_model model;
    palp_network *net = NULL;
    make_model(nodes, 0.45, &source, &model);
    source.n_regions = 1;
    source.regions[0] = *hidden;
    contact.subdivisions = 2;
    bench_check(palp_network_from_model(&model, NULL, 1, &bottom, NULL, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 1, 0, &contact), "tools");
    for (int i = 0; i < n; i++)
        map[i].force_N = press(net, map[i].tool, map[i].depth_m);
    palp_network_free(net);
}

/* The largest change of a force by the ball, over the noise; a common factor of all forces is no change. */
static double change_by_ball(const palp_palpation_press map[PRESSES],
                             const palp_palpation_press bare[PRESSES]) {
    double change[PRESSES], mean = 0.0, most = 0.0;
    for (int i = 0; i < PRESSES; i++) {
        change[i] = log(map[i].force_N / bare[i].force_N);
        mean += change[i] / PRESSES;
    }
    for (int i = 0; i < PRESSES; i++)
        most = fmax(most, fabs(change[i] - mean));
    return most / NOISE;
}

/* What was found, and how many of the n intervals cover the truth. */
static int print_values(int n, palp_palpation_value *const *value, const double *truth) {
    int inside = 0;
    for (int k = 0; k < n; k++) {
        const double unit = k < n - 1 ? 1e3 : 1.0;
        printf(" %6.4g (%5.3g %5.3g)/%5.3g", unit * value[k]->best, unit * value[k]->low,
               unit * value[k]->high, unit * truth[k]);
        inside += value[k]->low <= truth[k] && truth[k] <= value[k]->high;
    }
    return inside;
}

/* Looks in a map, for n values of a ball or a layer; prints them. Returns what was found. */
static palp_palpation_kind look(int n_presses, const palp_palpation_press *map, double poisson, bool of_solid,
                                bool gain_known, int n, const double *truth, int *inside) {
    static const char *const FOUND[] = {"  none found", "  ball", "  layer"};
    palp_palpation_settings settings = palp_palpation_settings_default();
    palp_palpation p;
    palp_mesh_source source;
    palp_model model;
    palp_mesh *mesh = NULL;
    settings.gain_known = gain_known;
    make_model(NODES, poisson, &source, &model);
    bench_check(palp_model_mesh(&model, &mesh, NULL), "mesh");
    if (of_solid) {
        bench_check(palp_law_of_solid(mesh, poisson, YOUNG, &model.material.law), "law");
        model.edge_correction = true;
    }
    const clock_t start = clock();
    bench_check(palp_palpate(&model, mesh, (size_t)n_presses, map, &settings, &p, NULL), "palpate");
    const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    palp_mesh_free(mesh);
    palp_palpation_value *const ball[] = {&p.x_m, &p.y_m, &p.z_m, &p.radius_m, &p.stiffness},
                                *const layer[] = {&p.thickness_m, &p.layer_stiffness};
    printf(" %6.1f %8.1f %8.1f %5.2f", seconds, p.evidence, p.evidence_layer,
           100.0 * (n == 2 ? p.scatter_layer : p.scatter_found));
    const int cover = print_values(n, n == 2 ? layer : ball, truth);
    *inside += p.kind == (n == 2 ? PALP_PALPATION_LAYER : PALP_PALPATION_BALL) ? cover : 0;
    printf("%s\n", FOUND[p.kind]);
    fflush(stdout);
    return p.kind;
}

/* A map of data/tips: its file, Poisson's ratio 0.3, what is in it, and the sphere's radius. */
typedef struct known_map {
    const char *name, *file;
    double radius;
    int n; /* of the truth: 5 of a ball, 2 of a layer */
    double truth[5];
} known_map;

/* A row of palpation.csv. Between its two forces, at half the depth and at all of it, they are a power of
 * depth. */
static bool read_ball_row(const char *line, const known_map *m, palp_palpation_press *p) {
    double x, z, half, whole;
    char name[20];
    if (sscanf(line, "%19[^,],%lf,%lf,%lf,%lf", name, &x, &z, &half, &whole) != 5 ||
        strcmp(name, m->name) != 0)
        return false;
    const double power = log2(whole / half);
    *p = (palp_palpation_press){.depth_m = 1.2e-3};
    p->tool.position_m[0] = 1e-3 * x;
    p->tool.position_m[2] = 1e-3 * z;
    p->force_N = 2.0 * whole * (1.0 - pow(0.5, power + 1.0)) / (power + 1.0);
    return true;
}

/* A row of layers.csv: the mean of three forces by Simpson's rule. */
static bool read_layer_row(const char *line, const known_map *m, palp_palpation_press *p) {
    double x, z, depth, half, middle, whole;
    char name[20];
    if (sscanf(line, "%19[^,],%lf,%lf,%lf,%lf,%lf,%lf", name, &x, &z, &depth, &half, &middle, &whole) != 7 ||
        strcmp(name, m->name) != 0)
        return false;
    *p = (palp_palpation_press){.depth_m = 1e-3 * depth, .force_N = (half + 4.0 * middle + whole) / 6.0};
    p->tool.position_m[0] = 1e-3 * x;
    p->tool.position_m[2] = 1e-3 * z;
    return true;
}

static int read_map(const known_map *m, palp_palpation_press map[PRESSES]) {
    char line[200];
    int n = 0;
    FILE *file = fopen(m->file, "r");
    while (file && fgets(line, sizeof line, file)) {
        palp_palpation_press *p = &map[n];
        if (n == PRESSES || !(m->n == 5 ? read_ball_row : read_layer_row)(line, m, p))
            continue;
        p->tool.shape = PALP_TOOL_SPHERE;
        p->tool.radius_m = m->radius;
        p->tool.position_m[1] = SIDE + m->radius;
        n++;
    }
    if (file)
        fclose(file);
    return n;
}

/* Presses of CalculiX. */
static int look_in_map(const char *name) {
    static const known_map MAPS[] = {
        {"none", "data/tips/palpation.csv", 0.005, 5, {0, 0, 0, 0, 1}},
        {"near", "data/tips/palpation.csv", 0.005, 5, {0.015, 0.019, 0.009, 0.0035, 20}},
        {"no_layer", "data/tips/layers.csv", 0.006, 2, {0, 1}},
        {"stiff_layer", "data/tips/layers.csv", 0.006, 2, {0.006, 5}},
        {"soft_layer", "data/tips/layers.csv", 0.006, 2, {0.006, 0.2}}};
    for (size_t k = 0; k < sizeof MAPS / sizeof *MAPS; k++) {
        palp_palpation_press map[PRESSES];
        const int n = strcmp(MAPS[k].name, name) == 0 ? read_map(&MAPS[k], map) : 0;
        int inside = 0;
        if (n == 0)
            continue;
        printf("%4s", name);
        look(n, map, 0.3, true, false, MAPS[k].n, MAPS[k].truth, &inside);
        return 0;
    }
    fprintf(stderr, "bench_inclusion: no map called %s\n", name);
    return 1;
}

static void add_noise(int n, palp_palpation_press *map, stream *s) {
    for (int i = 0; i < n; i++)
        map[i].force_N *= exp(NOISE * normal(s));
}

/* A layer of 4 to 9 mm at the top, as stiff as balls are. */
static palp_region hide_layer(int number, stream *s) {
    palp_region layer = hide_ball(number, s);
    const double thickness = uniform(s, 0.004, 0.009);
    layer.shape = PALP_REGION_BOX;
    for (int k = 0; k < 3; k++) {
        layer.low_m[k] = k == 1 ? SIDE - thickness : -SIDE;
        layer.high_m[k] = 2.0 * SIDE;
    }
    return layer;
}

static int look_for_layers(int first, int last, bool gain_known) {
    static const double WIDER = 0.006, DEEPER = 2e-3;
    int counts[3] = {0}, none[3] = {0}, inside = 0;
    printf("best (95 %% interval) / truth\n%4s %6s %8s %8s %5s %22s %22s\n", "case", "s", "ball", "layer",
           "left", "thickness, mm", "stiffness");
    for (int number = first; number <= last; number++) {
        stream s;
        palp_palpation_press map[PRESSES + 2];
        const palp_region layer = hide_layer(number, &s);
        const double truth[] = {SIDE - layer.low_m[1], layer.stiffness};
        const int n = plan_presses(3, 2, WIDER, DEEPER, map);
        map_presses(TRUE_NODES, &layer, n, map);
        add_noise(n, map, &s);
        printf("%4d", number);
        (layer.stiffness == 1.0 ? none : counts)[look(n, map, 0.45, false, gain_known, 2, truth, &inside)]++;
    }
    printf("of %d layers %d found, %d called a ball; of %d without one %d false alarms; %d of %d intervals "
           "cover\n",
           counts[0] + counts[1] + counts[2], counts[PALP_PALPATION_LAYER], counts[PALP_PALPATION_BALL],
           none[0] + none[1] + none[2], none[1] + none[2], inside, 2 * counts[PALP_PALPATION_LAYER]);
    return 0;
}

/* log(a / b) of the forces of two maps, less the mean. */
static void compare_maps(int n, const palp_palpation_press *a, const palp_palpation_press *b, double *ratio) {
    double mean = 0.0;
    for (int i = 0; i < n; i++)
        mean += log(a[i].force_N / b[i].force_N) / n;
    for (int i = 0; i < n; i++)
        ratio[i] = log(a[i].force_N / b[i].force_N) - mean;
}

/* Derivative of the digamma function. */
static double trigamma(double x) {
    double sum = 0.0;
    for (; x < 6.0; x += 1.0)
        sum += 1.0 / (x * x);
    const double s = 1.0 / (x * x);
    return sum + (1.0 + 0.5 / x + s * (1.0 / 6.0 - s * (1.0 / 30.0 - s / 42.0))) / x;
}

/* What a lattice 1.6 times as fine shows of the error of another, both with the region: the multiple of it
 * that fits what a still finer one shows, and what then remains over it. */
static void compare_lattices(const palp_region *region, int n, const palp_palpation_press *plan,
                             double *multiple, double *remains) {
    enum { COARSE = 6, FINE = 9, FINEST = 14, MOST = PRESSES + 2 };
    static const size_t NODES_OF[3] = {COARSE, FINE, FINEST};
    palp_palpation_press map[3][MOST];
    double taken[MOST], whole[MOST], along = 0.0, square = 0.0, left = 0.0;
    for (int i = 0; i < 3; i++) {
        memcpy(map[i], plan, (size_t)n * sizeof *plan);
        map_presses(NODES_OF[i], region, n, map[i]);
    }
    compare_maps(n, map[1], map[0], taken);
    compare_maps(n, map[2], map[0], whole);
    for (int i = 0; i < n; i++) {
        along += taken[i] * whole[i];
        square += taken[i] * taken[i];
    }
    *multiple = along / square;
    for (int i = 0; i < n; i++)
        left += (whole[i] - *multiple * taken[i]) * (whole[i] - *multiple * taken[i]);
    *remains = sqrt(left / square);
}

typedef struct spread {
    double n, sum, squares;
} spread;

static void add_to_spread(spread *s, double x) {
    s->n += 1.0;
    s->sum += x;
    s->squares += x * x;
}

static double variance_of(const spread *s) {
    return (s->squares - s->sum * s->sum / s->n) / (s->n - 1.0);
}

/* Of a scaled inverse chi-squared distribution with k degrees of freedom the logarithm has the variance
 * trigamma(k / 2); the scatter of a map adds its own. */
static int measure_lattice(int first, int last) {
    static const double TIP = 0.005, WIDER_TIP = 0.006, DEEPER = 2e-3;
    palp_palpation_press plan[2][PRESSES + 2];
    const int n[2] = {plan_presses(GRID, 1, TIP, DEPTH, plan[0]),
                      plan_presses(3, 2, WIDER_TIP, DEEPER, plan[1])};
    spread multiples = {0}, logs = {0};
    printf("%4s %5s %9s %8s %8s\n", "case", "", "stiffness", "multiple", "remains");
    for (int number = first; number <= last; number++)
        for (int is_layer = 0; is_layer < 2; is_layer++) {
            stream s;
            double multiple, remains;
            const palp_region region = (is_layer ? hide_layer : hide_ball)(number, &s);
            if (region.stiffness == 1.0)
                continue;
            compare_lattices(&region, n[is_layer], plan[is_layer], &multiple, &remains);
            add_to_spread(&multiples, multiple);
            add_to_spread(&logs, 2.0 * log(remains));
            printf("%4d %5s %9.3g %8.2f %8.2f\n", number, is_layer ? "layer" : "ball", region.stiffness,
                   multiple, remains);
            fflush(stdout);
        }
    const double own = variance_of(&logs) - trigamma(0.5 * (PRESSES - 2));
    double low = 0.01, high = 1000.0;
    for (int i = 0; i < 60; i++) {
        const double middle = sqrt(low * high);
        if (trigamma(0.5 * middle) > own)
            low = middle;
        else
            high = middle;
    }
    printf("multiple %.2f, sd %.2f; remains %.2f in the geometric mean, as of %.2g degrees of freedom\n",
           multiples.sum / multiples.n, sqrt(variance_of(&multiples)), exp(0.5 * logs.sum / logs.n), low);
    return 0;
}

int main(int argc, char **argv) {
    if (argc == 3 && strcmp(argv[1], "map") == 0)
        return look_in_map(argv[2]);
    if (argc > 3 && strcmp(argv[1], "layers") == 0)
        return look_for_layers(atoi(argv[2]), atoi(argv[3]), argc > 4 && strcmp(argv[4], "known") == 0);
    if (argc > 3 && strcmp(argv[1], "lattice") == 0)
        return measure_lattice(atoi(argv[2]), atoi(argv[3]));
    const int first = argc > 2 ? atoi(argv[1]) : 1, last = argc > 2 ? atoi(argv[2]) : 4;
    palp_palpation_press bare[PRESSES];
    int found = 0, layers = 0, felt = 0, found_felt = 0, balls = 0, false_alarms = 0, inside = 0;
    plan_presses(GRID, 1, RADIUS, DEPTH, bare);
    map_presses(TRUE_NODES, &NOTHING, PRESSES, bare);
    printf("best (95 %% interval) / truth\n%4s %6s %6s %8s %8s %5s %22s %22s %22s %22s %22s\n", "case",
           "change", "s", "ball", "layer", "left", "x, mm", "y, mm", "z, mm", "radius, mm", "stiffness");
    for (int number = first; number <= last; number++) {
        stream s;
        const palp_region ball = hide_ball(number, &s);
        palp_palpation_press map[PRESSES];
        const double truth[] = {ball.centre_m[0], ball.centre_m[1], ball.centre_m[2], ball.radius_m,
                                ball.stiffness};
        int within = 0;
        plan_presses(GRID, 1, RADIUS, DEPTH, map);
        map_presses(TRUE_NODES, &ball, PRESSES, map);
        const double change = change_by_ball(map, bare);
        add_noise(PRESSES, map, &s);
        printf("%4d %6.1f", number, change);
        const palp_palpation_kind kind = look(PRESSES, map, 0.45, false, false, 5, truth, &within);
        const bool is_found = kind == PALP_PALPATION_BALL;
        if (ball.stiffness == 1.0) {
            false_alarms += kind != PALP_PALPATION_NONE;
            continue;
        }
        balls++;
        found += is_found;
        layers += kind == PALP_PALPATION_LAYER;
        felt += change >= 3.0;
        found_felt += change >= 3.0 && is_found;
        inside += within;
    }
    printf("%d of %d balls found, %d called a layer, %d of %d that change a force by three noise levels; %d "
           "false alarms in %d; "
           "%d of %d intervals cover\n",
           found, balls, layers, found_felt, felt, false_alarms, last - first + 1 - balls, inside, 5 * found);
    return 0;
}
