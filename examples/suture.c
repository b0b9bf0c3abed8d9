/* suture.c: two tissues, the upper one half as stiff, with a gap between them. A thread runs to and fro
 * across the gap and is drawn tight until the tissues touch; then they are pulled apart until it tears.
 * Prints the tension of the thread, and how many points touch. */
#include <palpate/sim.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double SIDE = 0.024, GAP = 0.002; /* m */

static palp_status block(double up_m, palp_mesh **mesh) {
    const double size_m[3] = {SIDE, 2 * SIDE / 3, SIDE}, move_m[3] = {0, up_m, 0};
    const double none[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const size_t nodes[3] = {7, 5, 7};
    palp_status status = palp_mesh_lattice(nodes, size_m, PALP_NEIGHBOURS_26, mesh);
    if (!status)
        status = palp_mesh_scale(*mesh, PALP_SCALING_CONTINUUM, 0, NULL);
    return status ? status : palp_mesh_transform(*mesh, none, move_m);
}

static palp_status make_network(palp_network **network) {
    const palp_support supports[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}},
                                     {"upper.top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}}};
    palp_mesh *lower = NULL, *upper = NULL, *both = NULL;
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    const double modulus_N = 8;
    palp_material material;
    palp_region softer;
    palp_status status = block(0, &lower);
    if (!status)
        status = block(2 * SIDE / 3 + GAP, &upper);
    if (!status)
        status = palp_mesh_join(lower, upper, "upper", &both);
    memset(&material, 0, sizeof material);
    memset(&softer, 0, sizeof softer);
    strcpy(softer.name, "upper");
    softer.shape = PALP_REGION_OF_MESH;
    softer.stiffness = 0.5;
    settings.n_regions = 1;
    settings.regions = &softer;
    if (!status)
        status = palp_law_polynomial(1, &modulus_N, &material.law);
    if (!status)
        status = palp_network_create(both, &material, 2, supports, &settings, network, NULL);
    contact.tissue = true;
    contact.tissue_friction = 0.3;
    if (!status)
        status = palp_network_enable_tools(*network, 0, 0, &contact);
    if (!status)
        status = palp_network_enable_ties(*network, 1);
    palp_mesh_free(lower);
    palp_mesh_free(upper);
    palp_mesh_free(both);
    return status;
}

/* Six points, 3 mm above and below the gap, taut. */
static palp_status sew(const palp_network *network, palp_tie *thread) {
    palp_status status = PALP_OK;
    memset(thread, 0, sizeof *thread);
    thread->n_points = 6;
    thread->stiffness_N_m = 200;
    thread->strength_N = 0.15;
    for (size_t i = 0; i < thread->n_points && !status; i++) {
        const double above = (i + 1) / 2 % 2 == 0 ? -0.003 : GAP + 0.003;
        const double place_m[3] = {SIDE / 2, 2 * SIDE / 3 + above, SIDE * (0.3 + 0.2 * (double)(i / 2))};
        status = palp_tie_point_at(palp_network_mesh(network), place_m, &thread->point[i]);
    }
    return status ? status : palp_network_tie_length(network, thread, &thread->length_m);
}

static palp_status step(palp_network *network, double pulled_m, const palp_tie *thread,
                        palp_tie_state *state) {
    size_t contacts = 0;
    palp_status status = palp_network_set_ties(network, 1, thread);
    if (!status)
        status = palp_network_step(network, -pulled_m, 0.01, NULL);
    if (!status)
        status = palp_network_ties(network, state);
    palp_network_contacts(network, 0, NULL, &contacts);
    printf("%6.1f mm pulled, thread %5.1f mm, %6.1f mN%s, %3zu points touch\n", 1e3 * pulled_m,
           1e3 * thread->length_m, 1e3 * state->force_N, state->torn ? ", torn" : "", contacts);
    return status;
}

int main(void) {
    palp_network *network = NULL;
    palp_tie thread;
    palp_tie_state state = {0, 0, false};
    palp_status status = make_network(&network);
    if (!status)
        status = sew(network, &thread);
    for (int i = 0; i < 6 && !status; i++) {
        status = step(network, 0, &thread, &state);
        thread.length_m *= 0.92;
    }
    for (int i = 1; i <= 30 && !status && !state.torn; i++)
        status = step(network, 0.0005 * i, &thread, &state);
    if (status)
        fprintf(stderr, "suture: %s\n", palp_status_text(status));
    palp_network_free(network);
    return status != PALP_OK;
}
