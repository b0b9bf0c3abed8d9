/* tool_make.h: the blocks and tools of the tests of contact. */
#ifndef TOOL_MAKE_H
#define TOOL_MAKE_H

#include "network_make.h"
#include "contact/contact_internal.h"

/* A cube of n nodes a side on its bottom, its top free, ready for three tools and all its nodes held. */
static inline palp_network *block(size_t n, const palp_material *m, double density,
                                  const palp_contact_settings *penalty) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_contact_settings own = palp_contact_settings_default();
    palp_supports_default(supports);
    settings.branch = PALP_BRANCH_STABLE;
    settings.density_kg_m3 = density;
    ck_assert_int_eq(palp_network_create(mesh, m, 1, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 3, n * n * n, penalty ? penalty : &own), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static inline palp_material linear(void) {
    palp_material m = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){0.54}, &m.law), PALP_OK);
    return m;
}

static inline palp_tool sphere(double x, double bottom, double z, double radius, double friction) {
    return (palp_tool){PALP_TOOL_SPHERE, {x, bottom + radius, z}, {0, 0, 0}, 0, radius, friction, {0}, NULL};
}

static inline palp_tool capsule(double x, double bottom, double z, double radius, double friction) {
    return (palp_tool){
        PALP_TOOL_CAPSULE, {x, bottom + radius, z}, {0.6, 0, 0.8}, 0.008, radius, friction, {0}, NULL};
}

static inline palp_tool plane(double y, double friction) {
    return (palp_tool){PALP_TOOL_PLANE, {0.012, y, 0.012}, {0, -1, 0}, 0, 0, friction, {0}, NULL};
}

static inline palp_tool_force step(palp_network *net, const palp_tool *tool, double dt) {
    palp_tool_force force[3];
    ck_assert_int_eq(palp_network_set_tools(net, 1, tool), PALP_OK);
    palp_status status = palp_network_step(net, 0.0, dt, NULL);
    ck_assert_msg(!status, "%s", palp_status_text(status));
    ck_assert_int_eq(palp_network_tool_force(net, force), PALP_OK);
    return force[0];
}

static inline void add_moment(const double at[3], double share, const double force[3], double sum[6]) {
    double moment[3];
    cross3(at, force, moment);
    for (int k = 0; k < 3; k++) {
        sum[k] += share * force[k];
        sum[3 + k] += share * moment[k];
    }
}

/* Force and moment about the origin of all that acts on the tissue: supports, tools, hands, weight. */
static inline void balance(const palp_network *net, size_t n_tools, const palp_tool *tools, double sum[6]) {
    palp_tool_force felt[3];
    const double *x = palp_network_positions(net);
    memset(sum, 0, 6 * sizeof *sum);
    ck_assert_int_eq(palp_network_tool_force(net, felt), PALP_OK);
    for (size_t i = 0; i < n_tools; i++) {
        add_moment(tools[i].position_m, -1.0, felt[i].force_N, sum);
        for (int k = 0; k < 3; k++)
            sum[3 + k] -= felt[i].moment_Nm[k];
    }
    for (size_t i = 0; i < net->n_nodes; i++) {
        int32_t node = (int32_t)i;
        double hand[3], weight[3] = {0.0};
        ck_assert_int_eq(palp_network_grasp_force(net, 1, &node, hand), PALP_OK);
        add_moment(x + 3 * i, -1.0, hand, sum);
        for (int k = 0; k < 3 && net->mass; k++)
            weight[k] = net->mass[i] * contact_of(net)->settings.gravity_m_s2[k];
        add_moment(x + 3 * i, 1.0, weight, sum);
        if (net->dof[3 * i] < 0)
            add_moment(x + 3 * i, -1.0, net->now.inner + 3 * i, sum);
    }
}

#endif
