/* cut.c: pulls a network model, slices it in two while it runs, and prints the force and the surface left to
 * draw. cut NETWORK.json */
#include <palpate/palpate.h>

#include <stdio.h>

static const double DT = 1e-3;            /* s */
static const int PULL = 200, SLICE = 800; /* ticks */

/* The blade's edge lies along z at a height y and goes from one x to another: two triangles. */
static size_t slice(palp_network *network, double y, const double z[2], double from, double to) {
    const double first[9] = {from, y, z[0], from, y, z[1], to, y, z[1]};
    const double second[9] = {from, y, z[0], to, y, z[1], to, y, z[0]};
    size_t a = 0, b = 0;
    palp_network_cut(network, first, &a);
    palp_network_cut(network, second, &b);
    return a + b;
}

/* Pulled by a twelfth of its height, then cut through at 0.46 of it. */
static palp_status run(palp_realtime *realtime) {
    palp_network *network = palp_realtime_network(realtime);
    const palp_budget budget = {0, 10,
                                0}; /* ten corrections a tick; or seconds, 1e-3, for a tick that is on time */
    double low[3], high[3];
    size_t cut = 0, triangles;
    const int32_t *surface;
    palp_tick_info info;
    palp_mesh_bounds(palp_network_mesh(network), low, high);
    const double height = high[1] - low[1], width = 1.2 * (high[0] - low[0]), start = low[0] - 0.1 * width;
    const double z[2] = {low[2] - height, high[2] + height}, depth = -height / 12;
    printf("time_s,force_N,cut,loose,triangles\n");
    for (int i = 1; i <= PULL + SLICE; i++) {
        if (i > PULL) /* all the way from the start: what has moved back over it since is cut too */
            cut += slice(network, low[1] + 0.46 * height, z, start, start + width * (i - PULL) / SLICE);
        palp_status status =
            palp_realtime_step(realtime, i < PULL ? depth * i / PULL : depth, DT, &budget, &info);
        if (status)
            return status;
        palp_network_surface(network, &triangles, &surface); /* to be drawn at palp_network_positions */
        if (i % 50 == 0)
            printf("%.3f,%.4f,%zu,%zu,%zu\n", palp_network_time(network), info.force_N, cut,
                   palp_network_loose(network, NULL), triangles);
    }
    return PALP_OK;
}

int main(int argc, char **argv) {
    const palp_realtime_settings settings = palp_realtime_settings_default();
    palp_error error = {PALP_OK, "usage: cut NETWORK.json"};
    palp_network *network = NULL;
    palp_realtime *realtime = NULL;
    palp_model model;
    palp_mesh_source source;
    if (argc != 2 || palp_model_read(argv[1], &model, &source, &error) ||
        palp_network_from_model(&model, NULL, 0, NULL, NULL, &network, &error)) {
        fprintf(stderr, "cut: %s\n", error.text);
        return 1;
    }
    palp_status status = palp_network_enable_cutting(network);
    if (!status)
        status = palp_realtime_create(network, &settings, &realtime);
    if (!status)
        status = run(realtime);
    if (status)
        fprintf(stderr, "cut: %s\n", palp_status_text(status));
    palp_realtime_free(realtime);
    palp_network_free(network);
    return status != PALP_OK;
}
