/* jaws.c: two jaws close on the sides of a calibrated network, hold it by friction and lift.
 *   jaws NETWORK.json
 * Prints how far they have closed and lifted, the force of each and the pull on the tissue. */
#include <palpate/palpate.h>

#include <stdio.h>

enum { CLOSING = 10, LIFTING = 10 };

/* The jaws on both sides of the mesh, near its top: boxes, longer than the tissue is deep. */
static palp_status make_jaws(const palp_network *network, palp_hull **hull, palp_tool jaw[2],
                             palp_error *error) {
    double low[3], high[3], half_m[3];
    palp_mesh_bounds(palp_network_mesh(network), low, high);
    const double height_m = high[1] - low[1], radius_m = height_m / 16;
    half_m[0] = height_m / 16;
    half_m[1] = height_m / 8;
    half_m[2] = 0.6 * (high[2] - low[2]);
    const palp_status status = palp_hull_create_box(half_m, hull, error);
    for (int k = 0; k < 2; k++) {
        const palp_tool box = {PALP_TOOL_HULL, {0, 0, 0}, {0, 0, 0}, 0, radius_m, 0.8, {0}, *hull};
        jaw[k] = box;
        jaw[k].position_m[0] = k == 0 ? low[0] - half_m[0] - radius_m : high[0] + half_m[0] + radius_m;
        jaw[k].position_m[1] = high[1] - 1.5 * half_m[1];
        jaw[k].position_m[2] = (low[2] + high[2]) / 2;
    }
    return status;
}

/* Moves the jaws towards each other and up, each by so much, and makes a step. */
static palp_status move_jaws(palp_network *network, palp_tool jaw[2], double close_m, double lift_m) {
    jaw[0].position_m[0] += close_m;
    jaw[1].position_m[0] -= close_m;
    for (int k = 0; k < 2; k++)
        jaw[k].position_m[1] += lift_m;
    const palp_status status = palp_network_set_tools(network, 2, jaw);
    return status ? status : palp_network_step(network, 0, 0.01, NULL);
}

int main(int argc, char **argv) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_error error = {PALP_OK, "usage: jaws NETWORK.json"};
    palp_network *network = NULL;
    palp_hull *hull = NULL;
    palp_model model;
    palp_mesh_source source;
    palp_tool jaw[2];
    palp_tool_force felt[2];
    palp_status status = argc == 2 ? palp_model_read(argv[1], &model, &source, &error) : PALP_ERR_ARGUMENT;

    if (!status)
        status = palp_network_from_model(&model, NULL, 1, &bottom, NULL, &network, &error);
    if (!status)
        status = palp_network_enable_tools(network, 2, 0, &contact);
    if (!status)
        status = make_jaws(network, &hull, jaw, &error);
    for (int i = 1; i <= CLOSING + LIFTING && !status; i++) {
        const bool closing = i <= CLOSING;
        const double part_m = 0.005 * model.height_m;
        status = move_jaws(network, jaw, closing ? part_m : 0, closing ? 0 : part_m);
        if (status)
            break;
        palp_network_tool_force(network, felt);
        printf("closed %5.2f mm, lifted %5.2f mm: squeeze %7.4f and %7.4f N, pull %7.4f N\n",
               1e3 * part_m * (closing ? i : CLOSING), 1e3 * part_m * (closing ? 0 : i - CLOSING),
               -felt[0].force_N[0], felt[1].force_N[0], -felt[0].force_N[1] - felt[1].force_N[1]);
    }
    if (status)
        fprintf(stderr, "jaws: %s\n", error.text[0] ? error.text : palp_status_text(status));
    palp_network_free(network);
    palp_hull_free(hull); /* after the network that has it as a tool */
    return status != PALP_OK;
}
