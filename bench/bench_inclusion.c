/* bench_inclusion.c: how well palp_palpate finds hidden balls, and how long it takes. A cube of 24 mm with a
 * ball of another stiffness is pressed at 16 places; every fourth has none. The cube that is pressed has 12
 * nodes a side, the one in which the ball is looked for 8. The forces have noise of 0.5 %. change is
 * the largest of a force by the ball, over the noise. bench_inclusion [FIRST LAST]: cases by number (default
 * 1 4; 1 26 has 20 balls); bench_inclusion map NAME: a map of data/tips/palpation.csv */
#include "bench.h"

#include <palpate/palpation.h>
#include <palpate/region.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TRUE_NODES = 12, NODES = 8, GRID = 4, PRESSES = GRID * GRID, STEPS = 4 };
static const double SIDE = 0.024, RADIUS = 0.004, DEPTH = 1.5e-3, NOISE = 0.005;

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

/* Mean force over the deeper half, in small steps. */
static double press(palp_network *net, palp_tool tool) {
    const double top = tool.position_m[1];
    double sum = 0.0;
    palp_tool_force felt;
    palp_network_reset(net);
    for (int i = 0; i <= STEPS; i++) {
        tool.position_m[1] = top - DEPTH * (0.5 + 0.5 * i / STEPS);
        palp_network_set_tools(net, 1, &tool);
        bench_check(palp_network_step(net, 0.0, INFINITY, NULL), "step");
        palp_network_tool_force(net, &felt);
        sum += felt.force_N[1] * (i == 0 || i == STEPS ? 0.5 : 1.0) / STEPS;
    }
    return sum;
}

/* Forces without noise. */
static void map_presses(const palp_region *ball, palp_palpation_press map[PRESSES]) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_contact_settings contact = palp_contact_settings_default();
    palp_mesh_source source;
    palp_model model;
    palp_network *net = NULL;
    make_model(TRUE_NODES, 0.45, &source, &model);
    source.n_regions = 1;
    source.regions[0] = *ball;
    contact.subdivisions = 2;
    bench_check(palp_network_from_model(&model, NULL, 1, &bottom, NULL, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 1, 0, &contact), "tools");
    for (int i = 0; i < PRESSES; i++) {
        palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = RADIUS};
        tool.position_m[0] = 0.0045 + 0.015 * (i / GRID) / (GRID - 1);
        tool.position_m[1] = SIDE + RADIUS;
        tool.position_m[2] = 0.0045 + 0.015 * (i % GRID) / (GRID - 1);
        map[i] = (palp_palpation_press){tool, DEPTH, press(net, tool)};
    }
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

/* Finds the ball of a map; prints it. Returns whether it was found. */
static bool look(const palp_palpation_press map[PRESSES], double poisson, const double truth[5],
                 int *inside) {
    const palp_palpation_settings settings = palp_palpation_settings_default();
    palp_palpation p;
    palp_mesh_source source;
    palp_model model;
    palp_mesh *mesh = NULL;
    make_model(NODES, poisson, &source, &model);
    bench_check(palp_model_mesh(&model, &mesh, NULL), "mesh");
    const clock_t start = clock();
    bench_check(palp_palpate(&model, mesh, PRESSES, map, &settings, &p, NULL), "palpate");
    const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    palp_mesh_free(mesh);
    const palp_palpation_value *value[] = {&p.x_m, &p.y_m, &p.z_m, &p.radius_m, &p.stiffness};
    printf(" %6.1f %8.1f %5.2f", seconds, p.evidence, 100.0 * p.scatter_found);
    for (int k = 0; k < 5; k++) {
        const double unit = k < 4 ? 1e3 : 1.0;
        printf(" %6.4g (%5.3g %5.3g)/%5.3g", unit * value[k]->best, unit * value[k]->low,
               unit * value[k]->high, unit * truth[k]);
        *inside += p.found && value[k]->low <= truth[k] && truth[k] <= value[k]->high;
    }
    printf("%s\n", p.found ? "" : "  not found");
    fflush(stdout);
    return p.found;
}

/* Presses of CalculiX: forces at half the depth and at all of it, between which they are a power of depth. */
static int look_in_map(const char *name) {
    static const struct {
        const char *name;
        double truth[5];
    } BALLS[] = {{"none", {0, 0, 0, 0, 1}}, {"near", {0.015, 0.019, 0.009, 0.0035, 20}}};
    palp_palpation_press map[PRESSES];
    char line[200], ball[20];
    double x, z, half, whole;
    int n = 0, inside = 0;
    FILE *file = fopen("data/tips/palpation.csv", "r");
    if (!file)
        return 1;
    while (fgets(line, sizeof line, file))
        if (n < PRESSES && sscanf(line, "%19[^,],%lf,%lf,%lf,%lf", ball, &x, &z, &half, &whole) == 5 &&
            strcmp(ball, name) == 0) {
            const double power = log2(whole / half), depth = 1.2e-3, radius = 5e-3;
            const palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                                    .position_m = {1e-3 * x, SIDE + radius, 1e-3 * z},
                                    .radius_m = radius};
            map[n++] = (palp_palpation_press){tool, depth,
                                              2.0 * whole * (1.0 - pow(0.5, power + 1.0)) / (power + 1.0)};
        }
    fclose(file);
    for (size_t k = 0; n == PRESSES && k < sizeof BALLS / sizeof *BALLS; k++)
        if (strcmp(BALLS[k].name, name) == 0) {
            printf("%4s", name);
            look(map, 0.3, BALLS[k].truth, &inside);
            return 0;
        }
    fprintf(stderr, "bench_inclusion: no map of %d presses called %s\n", PRESSES, name);
    return 1;
}

int main(int argc, char **argv) {
    if (argc == 3 && strcmp(argv[1], "map") == 0)
        return look_in_map(argv[2]);
    const int first = argc > 2 ? atoi(argv[1]) : 1, last = argc > 2 ? atoi(argv[2]) : 4;
    const palp_region none = {.name = "hidden",
                              .shape = PALP_REGION_SPHERE,
                              .centre_m = {0.012, 0.012, 0.012},
                              .radius_m = 0.004,
                              .stiffness = 1.0};
    palp_palpation_press bare[PRESSES];
    int found = 0, felt = 0, found_felt = 0, balls = 0, false_alarms = 0, inside = 0;
    map_presses(&none, bare);
    printf("best (95 %% interval) / truth\n%4s %6s %6s %8s %5s %22s %22s %22s %22s %22s\n", "case", "change",
           "s", "evidence", "left", "x, mm", "y, mm", "z, mm", "radius, mm", "stiffness");
    for (int number = first; number <= last; number++) {
        stream s;
        const palp_region ball = hide_ball(number, &s);
        palp_palpation_press map[PRESSES];
        const double truth[] = {ball.centre_m[0], ball.centre_m[1], ball.centre_m[2], ball.radius_m,
                                ball.stiffness};
        int within = 0;
        map_presses(&ball, map);
        const double change = change_by_ball(map, bare);
        for (int i = 0; i < PRESSES; i++)
            map[i].force_N *= exp(NOISE * normal(&s));
        printf("%4d %6.1f", number, change);
        const bool is_found = look(map, 0.45, truth, &within);
        if (ball.stiffness == 1.0) {
            false_alarms += is_found;
            continue;
        }
        balls++;
        found += is_found;
        felt += change >= 3.0;
        found_felt += change >= 3.0 && is_found;
        inside += within;
    }
    printf("%d of %d balls found, %d of %d that change a force by three noise levels; %d false alarms in %d; "
           "%d of %d intervals cover\n",
           found, balls, found_felt, felt, false_alarms, last - first + 1 - balls, inside, 5 * found);
    return 0;
}
