/* nodule.c: puts a stiff nodule below the top of a calibrated network and feels for it with a sphere.
 *   nodule NETWORK.json
 * Prints the force with and without it, at places along x. */
#include <palpate/palpate.h>

#include <stdio.h>
#include <string.h>

/* A sphere pressed into the top at x by a twentieth of the height, held: the force, N. */
static palp_status press(palp_network *network, double x_m, double *force_N) {
    double low[3], high[3];
    palp_tool_force felt;
    palp_mesh_bounds(palp_network_mesh(network), low, high);
    const double height_m = high[1] - low[1], radius_m = height_m / 8, z_m = (low[2] + high[2]) / 2;
    palp_tool sphere = {PALP_TOOL_SPHERE, {x_m, 0, z_m}, {0, 0, 0}, 0, radius_m, 0, {0}, NULL};
    palp_status status = PALP_OK;
    palp_network_reset(network);
    for (int i = 1; i <= 10 && !status; i++) {
        sphere.position_m[1] = high[1] + radius_m - 0.005 * i * height_m;
        palp_network_set_tools(network, 1, &sphere);
        status = palp_network_step(network, 0, 1e-3, NULL);
    }
    palp_network_tool_force(network, &felt);
    *force_N = felt.force_N[1];
    return status;
}

int main(int argc, char **argv) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_error error = {PALP_OK, "usage: nodule NETWORK.json"};
    palp_network *network[2] = {NULL, NULL};
    palp_model model;
    palp_mesh_source source;
    palp_status status = argc == 2 ? palp_model_read(argv[1], &model, &source, &error) : PALP_ERR_ARGUMENT;

    for (int with = 0; with < 2 && !status; with++) {
        double low[3], high[3];
        status = palp_network_from_model(&model, NULL, 1, &bottom, NULL, &network[with], &error);
        if (!status)
            status = palp_network_enable_tools(network[with], 1, 0, &contact);
        if (status || source.n_regions == PALP_REGIONS_MAX)
            break;
        palp_mesh_bounds(palp_network_mesh(network[with]), low, high);
        palp_region *nodule = &source.regions[source.n_regions++]; /* of the next network */
        strcpy(nodule->name, "nodule");
        nodule->shape = PALP_REGION_SPHERE;
        nodule->stiffness = 10; /* times that of the tissue around it */
        for (int k = 0; k < 3; k++)
            nodule->centre_m[k] = (low[k] + high[k]) / 2;
        nodule->radius_m = 0.2 * (high[1] - low[1]);
        nodule->centre_m[1] = high[1] - 1.2 * nodule->radius_m;
    }
    for (int i = 1; i < 8 && !status; i++) {
        double low[3], high[3], force_N[2] = {0, 0};
        palp_mesh_bounds(palp_network_mesh(network[0]), low, high);
        const double x_m = low[0] + i / 8.0 * (high[0] - low[0]);
        for (int with = 0; with < 2 && !status; with++)
            status = press(network[with], x_m, &force_N[with]);
        printf("x %6.2f mm: %7.4f N, without the nodule %7.4f N\n", 1e3 * x_m, force_N[1], force_N[0]);
    }
    if (status)
        fprintf(stderr, "nodule: %s\n", error.text[0] ? error.text : palp_status_text(status));
    for (int with = 0; with < 2; with++)
        palp_network_free(network[with]);
    return status != PALP_OK;
}
