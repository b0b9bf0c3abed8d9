/* test_network_mass.c: the mass of tetrahedra and hexahedra; ramps that stop, and swinging, with real
 * density. */
#include "mesh/mesh_internal.h"
#include "network/network_internal.h"
#include "network_make.h"

#include <palpate/tool.h>

static const double DENSITY = 1000.0;
static const palp_integrator INTEGRATORS[] = {PALP_BACKWARD_EULER, PALP_GENERALIZED_ALPHA};

static palp_mesh *read_mesh(const char *path, bool diagonals, palp_mesh_scaling scaling) {
    palp_mesh *mesh = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_mesh_read_gmsh(path, 1e-3, diagonals, &mesh, &error);
    ck_assert_msg(!status, "%s", error.text);
    ck_assert_int_eq(palp_mesh_scale(mesh, scaling, 4.5e-4, &error), PALP_OK);
    return mesh;
}

/* Of the lumped specimen's stiffness, for the scaling's area. */
static palp_material tissue(size_t n_arms) {
    static const palp_arm arms[] = {{.stiffness_N = 2.58, .viscosity_Ns = 3.61},
                                    {.stiffness_N = 0.685, .viscosity_Ns = 23.96}};
    palp_material m = {.n_arms = n_arms};
    ck_assert_int_eq(palp_law_polynomial(5, (double[]){8.18, -0.70, 47.47, -131.36, 146.89}, &m.law),
                     PALP_OK);
    for (size_t j = 0; j < n_arms; j++)
        m.arms[j] = arms[j];
    return m;
}

static palp_network *body_network(const palp_mesh *mesh, size_t n_arms, double density,
                                  palp_integrator integrator) {
    palp_material m = tissue(n_arms);
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_error error = {PALP_OK, ""};
    settings.density_kg_m3 = density;
    settings.integrator = integrator;
    palp_supports_default(supports);
    palp_status status = palp_network_create(mesh, &m, 2, supports, &settings, &net, &error);
    ck_assert_msg(!status, "%s", error.text);
    return net;
}

/* A press of the cylinder of tetrahedra. */
static palp_network *cylinder(size_t n_arms, double density, palp_integrator integrator) {
    palp_mesh *mesh = read_mesh("data/meshes/cylinder_tetra.msh", false, PALP_SCALING_CONTINUUM);
    palp_network *net = body_network(mesh, n_arms, density, integrator);
    palp_mesh_free(mesh);
    return net;
}

/* ---- distribution -------------------------------------------------------------------------------- */

/* Mass, its centre, and the node's share against the closed forms of a body. */
static void check_mass(const palp_network *net, double volume, const double centre[3]) {
    double sum = 0.0, first[3] = {0.0};
    for (size_t i = 0; i < net->n_nodes; i++) {
        ck_assert_double_gt(net->mass[i], 0.0);
        sum += net->mass[i];
        for (size_t k = 0; k < 3; k++)
            first[k] += net->mass[i] * net->rest[3 * i + k];
    }
    ck_assert_double_eq_tol(sum, DENSITY * volume, 1e-8 * sum);
    for (size_t k = 0; k < 3; k++)
        ck_assert_double_eq_tol(first[k] / sum, centre[k], 1e-8);
}

START_TEST(mass_is_that_of_the_body) {
    const double section =
        9.0 * sin(acos(-1.0) / 9.0) * 144e-6; /* a polygon of 18 corners on a circle of 12 mm */
    palp_mesh *mesh = read_mesh("data/meshes/cylinder_tetra.msh", false, PALP_SCALING_NONE);
    palp_network *net = body_network(mesh, 0, DENSITY, PALP_BACKWARD_EULER);
    check_mass(net, section * 24e-3, (double[]){0.0, 12e-3, 0.0});
    palp_network_free(net);
    palp_mesh_free(mesh);
    for (int cell = 0; cell < 2; cell++) {
        mesh = read_mesh(cell ? "data/meshes/box_tetra.msh" : "data/meshes/box_hexa.msh", true,
                         PALP_SCALING_NONE);
        net = body_network(mesh, 0, DENSITY, PALP_BACKWARD_EULER);
        check_mass(net, 13824e-9, (double[]){12e-3, 12e-3, 12e-3});
        palp_network_free(net);
        palp_mesh_free(mesh);
    }
}
END_TEST

/* Nodes that mirror each other weigh the same, though the boxes' tetrahedra do not mirror. */
START_TEST(boxes_stay_symmetric) {
    palp_mesh *mesh = read_mesh("data/meshes/box_hexa.msh", true, PALP_SCALING_NONE);
    palp_network *net = body_network(mesh, 0, DENSITY, PALP_BACKWARD_EULER);
    for (size_t i = 0; i < net->n_nodes; i++)
        for (size_t j = 0; j < i; j++) {
            double off = 0.0;
            for (size_t k = 0; k < 3; k++) {
                double a = fabs(net->rest[3 * i + k] - 12e-3), b = fabs(net->rest[3 * j + k] - 12e-3);
                off = fmax(off, fabs(a - b));
            }
            if (off < 1e-9)
                ck_assert_double_eq_tol(net->mass[i], net->mass[j], 1e-12 * net->mass[i]);
        }
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- ramps --------------------------------------------------------------------------------------- */

/* A 1 s ramp to a strain of 0.2 and a hold: against the massless network within 1 % of the force, and settled
 * on it. */
START_TEST(ramps_do_not_ring) {
    const size_t n_arms = (size_t)(_i / 2);
    palp_network *net = cylinder(n_arms, DENSITY, INTEGRATORS[_i % 2]),
                 *massless = cylinder(n_arms, 0.0, PALP_BACKWARD_EULER);
    const int n = 200;
    double off = 0.0, force = 0.0;
    for (int i = 1; i <= 2 * n; i++) {
        double depth = 0.2 * 24e-3 * fmin(1.0, (double)i / n);
        ck_assert_int_eq(palp_network_step(net, depth, 1.0 / n, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(massless, depth, 1.0 / n, NULL), PALP_OK);
        force = palp_network_force(massless);
        off = fabs(palp_network_force(net) - force) / force;
        if (i >= n)
            ck_assert_msg(off < 0.01, "step %d: %g of the force", i, off);
    }
    ck_assert_double_lt(off, _i % 2 ? 1e-4 : 1e-5);
    palp_network_free(net);
    palp_network_free(massless);
}
END_TEST

/* ---- energy -------------------------------------------------------------------------------------- */

/* Of motion, of the springs and of the arms' springs, J. */
static double total_energy(const palp_network *net) {
    const network_state *s = &net->now;
    double sum = 0.0, force, energy;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            sum += 0.5 * net->mass[i / 3] * s->velocity[i] * s->velocity[i];
    for (size_t i = 0; i < net->n_elements; i++) {
        double factor = net->scale ? net->scale[i] : 1.0;
        palp_law_force(&net->material.law, 1, &s->history.strain[i], &force, NULL, &energy);
        for (size_t j = 0; j < net->material.n_arms; j++) {
            double q = s->history.arm[j * net->n_elements + i];
            energy += 0.5 * q * q / net->material.arms[j].stiffness_N;
        }
        sum += factor * energy / net->inverse_rest[i];
    }
    return sum;
}

/* Pressed, let back a little in one step, then left to swing with the plates still. */
START_TEST(swinging_gains_no_energy) {
    static const double steps[] = {1e-4, 1e-3, 1e-2};
    const size_t n_arms = (size_t)(_i / 2 % 2) * 2;
    const bool euler = _i % 2 == 0;
    palp_network *net = cylinder(n_arms, DENSITY, INTEGRATORS[_i % 2]);
    for (size_t s = 0; s < 3; s++) {
        palp_network_reset(net);
        for (int i = 1; i <= 20; i++)
            ck_assert_int_eq(palp_network_step(net, 0.01 * i * 24e-3, 0.05, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.19 * 24e-3, steps[s], NULL), PALP_OK);
        double first = total_energy(net), before = first, kinetic = 0.0;
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            kinetic += net->dof[i] >= 0 ? 0.5 * net->mass[i / 3] * pow(net->now.velocity[i], 2.0) : 0.0;
        ck_assert_double_gt(kinetic, 1e-9);
        for (int i = 0; i < 150; i++) {
            ck_assert_int_eq(palp_network_step(net, 0.19 * 24e-3, steps[s], NULL), PALP_OK);
            double energy = total_energy(net);
            ck_assert_msg(energy <= (euler ? before : first) * (1.0 + 1e-9),
                          "dt %g, step %d: %.12g J after %.12g J", steps[s], i, energy, before);
            before = energy;
        }
        ck_assert_double_lt(before, first);
    }
    palp_network_free(net);
}
END_TEST

/* ---- error control ------------------------------------------------------------------------------- */

static int stop_after_one(void *user, double time_s, double depth_m, double force_N) {
    (void)time_s, (void)depth_m, (void)force_N;
    return ++*(int *)user == 2;
}

/* A whole step and two halves differ by d: the halves err by d with backward Euler, by d / 3 with generalized
 * alpha. With d / 2 allowed the first takes smaller steps, the second does not. */
START_TEST(error_control_knows_the_order) {
    const double h = 0.002, speed = 0.1 * 24e-3 / 0.2;
    double force[2];
    palp_path path;
    ck_assert_int_eq(palp_path_ramp_hold(0.1 * 24e-3, 0.2, 0.1, &path), PALP_OK);
    palp_network *net = cylinder(1, DENSITY, INTEGRATORS[_i]);
    for (int parts = 1; parts <= 2; parts++) {
        palp_network_reset(net);
        for (int i = 1; i <= parts; i++)
            ck_assert_int_eq(palp_network_step(net, speed * h * i / parts, h / parts, NULL), PALP_OK);
        force[parts - 1] = palp_network_force(net);
    }
    int seen = 0;
    palp_run_settings settings = {.tolerance = 0.5 * fabs(force[1] - force[0]) / force[1],
                                  .dt_min_s = h,
                                  .observer = stop_after_one,
                                  .user = &seen};
    palp_run_info info;
    palp_network_reset(net);
    ck_assert_int_eq(palp_network_run(net, &path, &settings, &info), PALP_ERR_STOPPED);
    ck_assert_int_eq(info.rejected > 0, INTEGRATORS[_i] == PALP_BACKWARD_EULER);
    palp_network_free(net);
    palp_path_free(&path);
}
END_TEST

/* Nothing holds the body: it falls by g t^2 / 2, which generalized alpha gives exactly from the first step
 * on. */
START_TEST(free_fall_from_the_first_step) {
    palp_material m = tissue(1);
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    const double g = -9.81, dt = 1e-3;
    settings.density_kg_m3 = DENSITY;
    settings.integrator = PALP_GENERALIZED_ALPHA;
    settings.tolerance = 1e-12;
    contact.gravity_m_s2[1] = g;
    ck_assert_int_eq(palp_network_create(mesh, &m, 0, NULL, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 0, 0, &contact), PALP_OK);
    for (int i = 1; i <= 10; i++) {
        ck_assert_int_eq(palp_network_step(net, 0.0, dt, NULL), PALP_OK);
        for (size_t k = 0; k < 3 * net->n_nodes; k++)
            ck_assert_double_eq_tol(palp_network_positions(net)[k] - net->rest[k],
                                    k % 3 == 1 ? 0.5 * g * (i * dt) * (i * dt) : 0.0, 1e-6 * 9.81 * dt * dt);
    }
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, free_fall_from_the_first_step);
    tcase_add_test(tc, mass_is_that_of_the_body);
    tcase_add_test(tc, boxes_stay_symmetric);
    tcase_add_loop_test(tc, ramps_do_not_ring, 0, 4);
    tcase_add_loop_test(tc, swinging_gains_no_energy, 0, 4);
    tcase_add_loop_test(tc, error_control_knows_the_order, 0, 2);
}
