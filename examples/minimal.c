/* minimal.c: loads a calibrated network, presses a sphere into its top and prints the force.
 *   minimal NETWORK.json */
#include <palpate/palpate.h>

#include <stdio.h>

int main(int argc, char **argv) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_error error = {PALP_OK, "usage: minimal NETWORK.json"};
    palp_network *network = NULL;
    palp_model model;
    palp_mesh_source source;

    if (argc != 2 || palp_model_read(argv[1], &model, &source, &error) ||
        palp_network_from_model(&model, NULL, 1, &bottom, NULL, &network, &error)) {
        fprintf(stderr, "minimal: %s\n", error.text);
        return 1;
    }
    double low[3], high[3];
    palp_mesh_bounds(palp_network_mesh(network), low, high);
    const double radius_m = (high[1] - low[1]) / 5;
    const double x = (low[0] + high[0]) / 2, z = (low[2] + high[2]) / 2;
    palp_tool sphere = {PALP_TOOL_SPHERE, {x, 0, z}, {0, 0, 0}, 0, radius_m, 0.3, {0}, NULL};
    palp_status status = palp_network_enable_tools(network, 1, 0, &contact);

    for (int i = 1; i <= 100 && !status; i++) { /* 0.1 s: a tenth of the height down */
        palp_tool_force force;
        sphere.position_m[1] = high[1] + radius_m - 1e-3 * i * (high[1] - low[1]);
        palp_network_set_tools(network, 1, &sphere);
        status = palp_network_step(network, 0, 1e-3, NULL);
        palp_network_tool_force(network, &force);
        if (i % 10 == 0)
            printf("%5.1f ms %8.4f N\n", 1e3 * palp_network_time(network), force.force_N[1]);
    }
    if (status)
        fprintf(stderr, "minimal: %s\n", palp_status_text(status));
    palp_network_free(network);
    return status != PALP_OK;
}
