/* outside.c: a program that knows the installed palpate only; C99 and C++. */
#include <palpate/palpate.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static int check(palp_status status, const char *what) {
    if (status != PALP_OK) {
        fprintf(stderr, "outside: %s: %s\n", what, palp_status_text(status));
    }
    return status != PALP_OK;
}

/* The 27-node cube of 24 mm at 10 % strain, whose force two other solvers agree on. */
int main(void) {
    const double coefficients_N[5] = {0.54, -2.34, 33.25, -124.03, 177.63};
    const size_t nodes[3] = {3, 3, 3};
    const double size_m[3] = {0.024, 0.024, 0.024};
    const palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_material material;
    palp_mesh *mesh = NULL;
    palp_network *network = NULL;
    palp_step_info info;
    int failed;

    if (strcmp(palp_version(), PALP_VERSION) != 0) {
        fprintf(stderr, "outside: headers of %s, library of %s\n", PALP_VERSION, palp_version());
        return 1;
    }
    memset(&material, 0, sizeof material);
    memset(&info, 0, sizeof info);
    palp_supports_default(supports);
    failed = check(palp_law_polynomial(5, coefficients_N, &material.law), "law") ||
             check(palp_mesh_lattice(nodes, size_m, PALP_NEIGHBOURS_26, &mesh), "mesh") ||
             check(palp_network_create(mesh, &material, 2, supports, &settings, &network, NULL), "network") ||
             check(palp_network_step(network, 0.0024, INFINITY, &info), "step");
    palp_network_free(network);
    palp_mesh_free(mesh);
    if (failed) {
        return 1;
    }
    printf("%.6f N\n", info.force_N);
    return fabs(info.force_N - 0.851966) < 1e-6 ? 0 : 1;
}
