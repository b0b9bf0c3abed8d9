/* test_tool.c: tools, held nodes and gravity: balances of force and moment, the tangent, where a tool is
 * felt. */
#include "hull_make.h"
#include "tool_make.h"

START_TEST(all_forces_and_moments_balance) {
    palp_material m = quartic(2);
    palp_contact_settings penalty = palp_contact_settings_default();
    penalty.gravity_m_s2[1] = -9.81;
    penalty.gravity_m_s2[2] = 2.0;
    palp_network *net = block(5, &m, 1000.0, &penalty);
    palp_tool tools[3] = {sphere(0.007, 0.0235, 0.008, 0.003, 0.4),
                          capsule(0.013, 0.0238, 0.013, 0.002, 0.2),
                          {PALP_TOOL_PLANE, {0.001, 0.012, 0.012}, {1, 0, 0}, 0, 0, 0.3, {0}, NULL}};
    const int32_t held[2] = {4 * 25 + 4 * 5 + 4, 4 * 25 + 2 * 5 + 1};
    double target[6], sum[6];
    for (int i = 0; i < 6; i++)
        target[i] = net->rest[3 * held[i / 3] + i % 3] + 0.001 * (i - 2);
    ck_assert_int_eq(palp_network_grasp(net, 2, held, target), PALP_OK);
    for (int i = 0; i < 6; i++) {
        for (size_t k = 0; k < 3; k++) {
            tools[k].position_m[0] += k < 2 ? 1e-4 : 2e-5;
            tools[k].position_m[1] -= k < 2 ? 1e-4 : 0.0;
        }
        ck_assert_int_eq(palp_network_set_tools(net, 3, tools), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, i < 3 ? INFINITY : 0.01, NULL), PALP_OK);
        if (i >= 3) /* accelerating: only the relaxed steps are in balance */
            continue;
        balance(net, 3, tools, sum);
        for (int k = 0; k < 3; k++) {
            ck_assert_double_eq_tol(sum[k], 0.0, 1e-8);
            ck_assert_double_eq_tol(sum[3 + k], 0.0, 1e-10);
        }
    }
    palp_tool_force felt[3];
    ck_assert_int_eq(palp_network_tool_force(net, felt), PALP_OK);
    for (size_t k = 0; k < 3; k++) {
        ck_assert_uint_gt(felt[k].contacts, 0);
        ck_assert_double_gt(felt[k].depth_m, 0.0);
    }
    palp_network_free(net);
}
END_TEST

START_TEST(weight_rests_on_the_support) {
    palp_material m = quartic(0);
    palp_contact_settings penalty = palp_contact_settings_default();
    penalty.gravity_m_s2[1] = -9.81;
    palp_network *net = block(5, &m, 1060.0, &penalty);
    double force[3], low = 0.0;
    ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", force), PALP_OK);
    ck_assert_double_eq_tol(force[1], -1060.0 * HEIGHT * HEIGHT * HEIGHT * 9.81, 1e-9);
    ck_assert_double_eq_tol(hypot(force[0], force[2]), 0.0, 1e-9);
    for (size_t i = 0; i < net->n_nodes; i++)
        low = fmin(low, palp_network_positions(net)[3 * i + 1] - net->rest[3 * i + 1]);
    ck_assert_double_lt(low, -1e-5); /* it sags */
    palp_network_reset(net);
    for (int i = 0; i < 2000; i++) /* and moving it comes to the same rest */
        ck_assert_int_eq(palp_network_step(net, 0.0, 0.01, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", force), PALP_OK);
    ck_assert_double_eq_tol(force[1], -1060.0 * HEIGHT * HEIGHT * HEIGHT * 9.81, 1e-6);
    palp_network_free(net);
}
END_TEST

/* ---- tangent ------------------------------------------------------------------------------------- */

static uint64_t seed = 3;
static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

enum { LOCAL = 9, STIFFENING }; /* instead of subdivisions: local points, and these in tissue that stiffens */

/* A step half solved: tools inside the tissue, nodes off their places. */
static palp_network *unsettled(const palp_tool *tools, size_t n, size_t subdivisions) {
    palp_material m = quartic(1);
    palp_contact_settings penalty = palp_contact_settings_default();
    penalty.local = subdivisions >= LOCAL;
    if (subdivisions == STIFFENING)
        ck_assert_int_eq(palp_law_polynomial(2, (double[]){0.54, 8.1}, &m.law), PALP_OK);
    penalty.subdivisions = penalty.local ? 0 : subdivisions;
    palp_network *net = block(5, &m, 0.0, &penalty);
    const int32_t held = 124;
    ck_assert_int_eq(palp_network_grasp(net, 1, &held, (double[]){0.024, 0.0245, 0.0235}), PALP_OK);
    ck_assert_int_eq(palp_network_set_tools(net, n, tools), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, 0.0, 0.01, NULL), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.x[i] += net->dof[i] >= 0 ? uniform(-2e-5, 2e-5) : 0.0;
    ck_assert(network_evaluate(net));
    return net;
}

static void term_times(const palp_network *net, const double *u, double *out) {
    NETWORK_EACH_TERM(net, times, net, u, out);
}

static void evaluate_terms(palp_network *net) {
    memset(net->outer, 0, 3 * net->n_nodes * sizeof *net->outer);
    NETWORK_EACH_TERM(net, evaluate, net);
}

/* Largest difference of -dF v by central differences and by the terms' products, over the largest of it. */
static double times_error(palp_network *net, const double *v, double h) {
    size_t n = 3 * net->n_nodes;
    double *x = malloc(n * sizeof *x), *f = malloc(n * sizeof *f), *kv = calloc(n, sizeof *kv), worst = 0.0,
           size = 0.0;
    ck_assert(x && f && kv);
    memcpy(x, net->next.x, n * sizeof *x);
    term_times(net, v, kv);
    for (int side = 1; side >= -1; side -= 2) {
        for (size_t i = 0; i < n; i++)
            net->next.x[i] = x[i] + side * h * v[i];
        evaluate_terms(net);
        for (size_t i = 0; i < n; i++)
            f[i] = side * net->outer[i] + (side < 0 ? f[i] : 0.0);
    }
    for (size_t i = 0; i < n; i++) {
        worst = fmax(worst, fabs(kv[i] + f[i] / (2.0 * h)));
        size = fmax(size, fabs(kv[i]));
    }
    memcpy(net->next.x, x, n * sizeof *x);
    evaluate_terms(net);
    free(x), free(f), free(kv);
    return worst / size;
}

/* Difference of the energy's slope along v and the forces on that way, over those. */
static double energy_error(palp_network *net, const double *v, double h) {
    size_t n = 3 * net->n_nodes;
    double *x = malloc(n * sizeof *x), energy[2],
           work = network_dot(net->fint, v, n) + network_dot(net->outer, v, n);
    ck_assert(x);
    memcpy(x, net->next.x, n * sizeof *x);
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < n; i++)
            net->next.x[i] = x[i] + (side ? h : -h) * v[i];
        ck_assert(network_evaluate(net) && network_energy(net, &energy[side]));
    }
    memcpy(net->next.x, x, n * sizeof *x);
    ck_assert(network_evaluate(net));
    free(x);
    return fabs((energy[1] - energy[0]) / (2.0 * h) + work) / fabs(work);
}

START_TEST(tangent_is_the_derivative) {
    palp_hull *hull = box_hull(0.004, 0.003, 0.005);
    palp_tool box = hull_tool(hull, 0.0075, 0.0275, 0.0083, 0.001, 0);
    turn_tool(&box, (const double[]){0.6, 0.0, 0.8}, 0.3); /* on its edges and corners */
    const palp_tool tools[][2] = {
        {sphere(0.0075, 0.0232, 0.0083, 0.004, 0), plane(0.0239, 0)},
        {box, hull_tool(hull, 0.0175, 0.0272, 0.0183, 0.0005, 0)},
        {capsule(0.0075, 0.0232, 0.0083, 0.003, 0), sphere(0.021, 0.0236, 0.021, 0.002, 0)},
        {plane(0.0237, 1e9), plane(0.0239, 0)}}; /* which sticks */
    for (size_t t = 0; t < 16; t++) {
        palp_network *net = unsettled(tools[t % 4], 2, t < 8 ? t / 4 : t < 12 ? LOCAL : STIFFENING);
        size_t n = 3 * net->n_nodes;
        double *v = malloc(n * sizeof *v);
        for (int k = 0; k < 3; k++) {
            for (size_t i = 0; i < n; i++)
                v[i] = uniform(-1.0, 1.0);
            ck_assert_double_lt(times_error(net, v, 1e-9), 2e-5);
            if (t % 4 < 3) /* without friction */
                ck_assert_double_lt(energy_error(net, v, 1e-7), 1e-4);
        }
        free(v);
        palp_network_free(net);
    }
    palp_hull_free(hull);
}
END_TEST

/* Slipping, the tangent is the derivative where the pressure stays: along the plane. And always symmetric. */
START_TEST(tangent_of_slip) {
    palp_tool tools[1] = {plane(0.0237, 0.3)};
    palp_network *net = unsettled(tools, 1, 0);
    ck_assert_int_eq(palp_network_step(net, 0.0, 0.01, NULL), PALP_OK);
    tools[0].position_m[0] += 1e-3;
    ck_assert_int_eq(palp_network_set_tools(net, 1, tools), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, 0.0, 0.01, NULL), PALP_OK);
    size_t n = 3 * net->n_nodes;
    double *u = malloc(n * sizeof *u), *v = malloc(n * sizeof *v), *ku = calloc(n, sizeof *ku);
    double *kv = calloc(n, sizeof *kv), uv = 0.0, vu = 0.0;
    for (size_t i = 0; i < n; i++) {
        u[i] = uniform(-1.0, 1.0);
        v[i] = i % 3 == 1 ? 0.0 : uniform(-1.0, 1.0);
    }
    ck_assert_double_lt(times_error(net, v, 1e-9), 2e-5);
    term_times(net, u, ku);
    term_times(net, v, kv);
    for (size_t i = 0; i < n; i++) {
        uv += u[i] * kv[i];
        vu += v[i] * ku[i];
    }
    ck_assert_double_eq_tol(uv, vu, 1e-9 * fabs(uv));
    free(u), free(v), free(ku), free(kv);
    palp_network_free(net);
}
END_TEST

/* The assembled matrix is that of the products: K^-1 (K v) = v. */
static void assembled_is_that_of_the_products(size_t subdivisions) {
    palp_hull *hull = box_hull(0.003, 0.002, 0.002);
    const palp_tool tools[3] = {sphere(0.0075, 0.0232, 0.0083, 0.004, 0.2),
                                capsule(0.012, 0.0235, 0.014, 0.002, 0.5),
                                hull_tool(hull, 0.0175, 0.0264, 0.0063, 0.001, 0.3)};
    palp_network *net = unsettled(tools, 3, subdivisions);
    size_t n = net->n_free;
    double *x = malloc(3 * net->n_nodes * sizeof *x), *v = malloc(n * sizeof *v), *r = calloc(n, sizeof *r),
           scale;
    double *full = calloc(3 * net->n_nodes, sizeof *full), *kv = calloc(3 * net->n_nodes, sizeof *kv);
    memcpy(x, net->next.x, 3 * net->n_nodes * sizeof *x);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            full[i] = v[net->dof[i]] = uniform(-1.0, 1.0);
    term_times(net, full, kv); /* of tools and hands; of the elements by differences */
    for (int side = 1; side >= -1; side -= 2) {
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            net->next.x[i] = x[i] + side * 1e-8 * full[i];
        ck_assert(network_evaluate(net));
        network_residual(net, &scale);
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            if (net->dof[i] >= 0)
                r[net->dof[i]] -= side * (net->rhs[net->dof[i]] - net->outer[i]) / 2e-8;
    }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            r[net->dof[i]] += kv[i];
    memcpy(net->next.x, x, 3 * net->n_nodes * sizeof *x);
    ck_assert(network_evaluate(net));
    int negative;
    ck_assert_int_eq(network_factor(net, 0.0, &negative), PALP_OK);
    linsys_solve(net->ls, r);
    for (size_t i = 0; i < n; i++)
        ck_assert_double_eq_tol(r[i], v[i], 1e-4);
    free(x), free(v), free(r), free(full), free(kv);
    palp_network_free(net);
    palp_hull_free(hull);
}

START_TEST(assembled_tangent_is_that_of_the_products) {
    assembled_is_that_of_the_products(0);
    assembled_is_that_of_the_products(2);
    assembled_is_that_of_the_products(LOCAL);
}
END_TEST

/* ---- where a tool is felt ------------------------------------------------------------------------ */

START_TEST(one_sided) {
    palp_material m = quartic(0);
    const palp_tool tools[] = {sphere(0.011, HEIGHT, 0.012, 0.004, 0.3),
                               capsule(0.008, HEIGHT, 0.009, 0.003, 0.3), plane(HEIGHT, 0.3)};
    for (int t = 0; t < 3; t++) {
        palp_network *net = block(5, &m, 0.0, NULL);
        palp_tool tool = tools[t];
        for (int i = 0; i <= 20; i++) {
            tool.position_m[1] = tools[t].position_m[1] - 1e-4 * (i <= 10 ? i : 21 - 1.1 * i);
            palp_tool_force f = step(net, &tool, INFINITY);
            ck_assert_double_ge(f.force_N[1], 0.0); /* never pulls */
            if (i == 10)
                ck_assert_double_gt(f.force_N[1], 0.1);
            if (i == 20)
                ck_assert(f.contacts == 0 && f.force_N[1] == 0.0);
        }
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            ck_assert_double_eq_tol(palp_network_positions(net)[i], net->rest[i], 1e-9);
        palp_network_free(net);
    }
}
END_TEST

/* A tool that begins inside the body without touching the surface is an error; one beside or above it is not.
 */
START_TEST(begins_inside) {
    palp_material m = quartic(0);
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_tool tool = sphere(0.012, 0.011, 0.013, 0.001, 0);
    snapshot before = snapshot_take(net);
    ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_ERR_INSIDE);
    ck_assert(still_at(net, &before));
    snapshot_free(&before);
    for (int i = 0; i < 3; i++) {
        tool = sphere(i == 0 ? -0.004 : 0.012, i == 1 ? -0.006 : 0.011, i == 2 ? 0.03 : 0.013, 0.001, 0);
        palp_network_reset(net);
        palp_tool_force f = step(net, &tool, INFINITY);
        ck_assert(f.contacts == 0 && f.force_N[1] == 0.0);
    }
    palp_network_free(net);
}
END_TEST

/* However far a tool goes in a step, it is felt as one that went there slowly. In one step it would have come
 * to lie inside, or have turned the surface inside out. */
START_TEST(far_in_one_step) {
    static const double radius[] = {0.001, 0.003, 0.005}, depth = 0.004;
    palp_material m = linear();
    for (int k = 0; k < 3; k++) {
        double force[2];
        for (int slow = 0; slow < 2; slow++) {
            palp_network *net = block(7, &m, 0.0, NULL);
            palp_tool tool = sphere(0.0121, HEIGHT, 0.0121, radius[k], 0);
            step(net, &tool, INFINITY);
            for (int i = 1; i <= (slow ? 40 : 1); i++) {
                tool.position_m[1] = HEIGHT + radius[k] - depth * i / (slow ? 40 : 1);
                force[slow] = step(net, &tool, INFINITY).force_N[1];
            }
            palp_network_free(net);
        }
        ck_assert_double_gt(force[1], 0.4);
        /* which points touch beside a triangle is found once in a step */
        ck_assert_double_eq_tol(force[0], force[1], 4e-4 * force[1]);
    }
}
END_TEST

/* Negative pivots of the tangent at the committed state: 0 on a stable branch. */
static int negative_pivots_of(palp_network *net) {
    int negative = -1;
    ck_assert_int_eq(network_begin(net, 0.0, INFINITY), PALP_OK);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    NETWORK_EACH_TERM(net, follow, net);
    ck_assert(network_evaluate(net));
    ck_assert_int_eq(network_factor(net, 0.0, &negative), PALP_OK);
    net->factored = false;
    return negative;
}

/* A sphere of 5 mm pressed 8 mm into five nodes a side: after 6.5 mm the branch that is followed continues as
 * an unstable one, with a force that is half as large again. */
START_TEST(unstable_branch_is_left) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings penalty = palp_contact_settings_default();
    const palp_network_settings settings = palp_network_settings_default();
    palp_material m = linear();
    palp_mesh *mesh = cube(5, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    ck_assert_int_eq(settings.branch, PALP_BRANCH_CONTINUE);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &penalty), PALP_OK);
    palp_mesh_free(mesh);
    for (int i = 0; i <= 16; i++) {
        const palp_tool tool = sphere(0.012, HEIGHT - 5e-4 * i, 0.0121, 0.005, 0);
        step(net, &tool, INFINITY);
        ck_assert_msg(negative_pivots_of(net) == 0, "%g mm deep", 0.5 * i);
    }
    palp_network_free(net);
}
END_TEST

/* What a step says of tetrahedra turned inside out is what their volumes say. */
START_TEST(inverted_are_counted) {
    palp_material m = linear();
    palp_network *net = block(7, &m, 0.0, NULL);
    const palp_mesh *mesh = palp_network_mesh(net);
    const int32_t *t = palp_mesh_tetrahedra(mesh);
    size_t some = 0, none = 0;
    for (int i = 0; i <= 16; i++) {
        const palp_tool tool = sphere(0.012, HEIGHT - 5e-4 * i, 0.0121, 0.003, 0);
        palp_step_info info;
        size_t flat = 0;
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, &info), PALP_OK);
        for (size_t j = 0; j < palp_mesh_tetrahedron_count(mesh); j++) {
            double edge[3][3], across[3];
            for (int k = 0; k < 3; k++)
                along3(palp_network_positions(net) + 3 * t[4 * j + 1 + (size_t)k], -1.0,
                       palp_network_positions(net) + 3 * t[4 * j], edge[k]);
            cross3(edge[0], edge[1], across);
            flat += dot3(across, edge[2]) <= 0.0;
        }
        ck_assert_uint_eq(info.inverted, flat);
        some += flat > 0;
        none += flat == 0;
    }
    ck_assert(some > 0 && none > 0);
    palp_network_free(net);
}
END_TEST

/* A sphere of a tenth of an edge is felt in the middle of a triangle and on an edge, much as on a node. */
START_TEST(smaller_than_the_mesh) {
    const double edge = HEIGHT / 4.0,
                 at[][2] = {{2.0, 2.0}, {2.5, 2.0}, {2.5, 2.5}, {2.33, 2.67}, {2.67, 2.33}};
    palp_material m = linear();
    double force[5];
    for (int i = 0; i < 5; i++) {
        palp_network *net = block(5, &m, 0.0, NULL);
        palp_tool tool = sphere(at[i][0] * edge, HEIGHT, at[i][1] * edge, 0.1 * edge, 0.3);
        for (int k = 0; k < 10; k++) {
            tool.position_m[1] -= 5e-5;
            force[i] = step(net, &tool, INFINITY).force_N[1];
        }
        ck_assert_double_gt(force[i], 0.4 * force[0]);
        ck_assert_double_lt(force[i], 2.5 * force[0]);
        palp_network_free(net);
    }
}
END_TEST

/* Dragged across triangles, edges and nodes the force has no jumps. */
START_TEST(force_is_smooth_across_triangles) {
    palp_material m = linear();
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_tool tool = sphere(0.0071, HEIGHT - 4e-4, 0.0083, 0.003, 0);
    palp_tool_force before = step(net, &tool, INFINITY);
    double worst = 0.0;
    for (int i = 0; i < 160; i++) {
        tool.position_m[0] += 5e-5;
        tool.position_m[2] += 2e-5;
        palp_tool_force now = step(net, &tool, INFINITY);
        worst = fmax(worst, fabs(now.force_N[1] - before.force_N[1]) / now.force_N[1]);
        before = now;
    }
    ck_assert_double_lt(worst, 0.03);
    palp_network_free(net);
}
END_TEST

/* An organ of scaled tetrahedra: all its couplings are in the matrix, and forces balance. */
START_TEST(on_tetrahedra) {
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    const palp_support base = {"base", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings penalty = palp_contact_settings_default();
    palp_mesh *mesh;
    palp_network *net;
    double low[3], high[3], sum[6];
    ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/sphere_4.4.msh", 1e-3, false, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 4.5e-4, NULL), PALP_OK);
    palp_mesh_bounds(mesh, low, high);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "base", 1, low[1], 0.3 * (high[1] - low[1])), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &base, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &penalty), PALP_OK);
    palp_tool tool = sphere(0.5 * (low[0] + high[0]) + 0.001, high[1], 0.5 * (low[2] + high[2]), 0.006, 0);
    for (int i = 0; i < 5; i++) {
        tool.position_m[1] -= 2e-4;
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    }
    balance(net, 1, &tool, sum);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(sum[k], 0.0, 1e-8);
        ck_assert_double_eq_tol(sum[3 + k], 0.0, 1e-10);
    }
    for (size_t i = 0; i < 3 * net->n_surface; i++)
        for (int k = 1; k < 3 && i % 3 == 0; k++) {
            bool joined = false;
            for (size_t e = 0; e < net->n_elements && !joined; e++)
                joined = (net->pair[2 * e] == net->surface[i] &&
                          net->pair[2 * e + 1] == net->surface[i + (size_t)k]) ||
                         (net->pair[2 * e + 1] == net->surface[i] &&
                          net->pair[2 * e] == net->surface[i + (size_t)k]);
            ck_assert(joined);
        }
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- what is refused ----------------------------------------------------------------------------- */

START_TEST(refuses_what_makes_no_sense) {
    palp_material m = quartic(0);
    palp_contact_settings penalty = palp_contact_settings_default();
    palp_network *net = cube_network(3, &m, NULL), *column = column_of(3, &m);
    palp_tool tool = sphere(0.01, HEIGHT, 0.01, 0.004, 0);
    const int32_t nodes[3] = {1, 2, 27};
    const double target[9] = {0};
    double force[3];
    ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_ERR_ARGUMENT); /* not enabled */
    ck_assert_int_eq(palp_network_grasp(net, 1, nodes, target), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_enable_tools(column, 1, 0, &penalty), PALP_ERR_UNSUPPORTED);
    ck_assert_int_eq(palp_network_enable_tools(column, 0, 1, &penalty), PALP_OK);
    penalty.gravity_m_s2[1] = -9.81;
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 1, &penalty), PALP_ERR_ARGUMENT); /* no mass */
    penalty = palp_contact_settings_default();
    penalty.stiffness = 0.0;
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 1, &penalty), PALP_ERR_ARGUMENT);
    penalty = palp_contact_settings_default();
    penalty.subdivisions = 5;
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 1, &penalty), PALP_ERR_ARGUMENT);
    penalty = palp_contact_settings_default();
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 1, &penalty), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 1, &penalty), PALP_ERR_ARGUMENT); /* twice */
    ck_assert_int_eq(palp_network_set_tools(net, 2, (palp_tool[]){tool, tool}), PALP_ERR_ARGUMENT);
    const palp_tool wrong[] = {{PALP_TOOL_SPHERE, {0, NAN, 0}, {0, 0, 0}, 0, 0.001, 0, {0}, NULL},
                               {PALP_TOOL_SPHERE, {0, 0, 0}, {0, 0, 0}, 0, 0.0, 0, {0}, NULL},
                               {PALP_TOOL_CAPSULE, {0, 0, 0}, {0, 2, 0}, 0.01, 0.001, 0, {0}, NULL},
                               {PALP_TOOL_CAPSULE, {0, 0, 0}, {0, 1, 0}, -0.01, 0.001, 0, {0}, NULL},
                               {PALP_TOOL_PLANE, {0, 0, 0}, {0, 0, 0}, 0, 0, 0, {0}, NULL},
                               {PALP_TOOL_PLANE, {0, 0, 0}, {0, 1, 0}, 0, 0, -0.1, {0}, NULL}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        ck_assert_int_eq(palp_network_set_tools(net, 1, &wrong[i]), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_grasp(net, 2, nodes, target), PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_network_grasp(net, 1, nodes + 2, target), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_grasp(net, 1, nodes, (double[]){0, INFINITY, 0}), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_grasp(net, 2, nodes, (double[]){0, 0, 0, 0, INFINITY, 0}),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_release(net, 1, nodes), PALP_OK);
    ck_assert_int_eq(palp_network_grasp_force(net, 1, nodes, force), PALP_OK);
    ck_assert_double_eq(force[0], 0.0);
    palp_network_free(net);
    palp_network_free(column);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, all_forces_and_moments_balance);
    tcase_add_test(tc, weight_rests_on_the_support);
    tcase_add_test(tc, tangent_is_the_derivative);
    tcase_add_test(tc, tangent_of_slip);
    tcase_add_test(tc, assembled_tangent_is_that_of_the_products);
    tcase_add_test(tc, one_sided);
    tcase_add_test(tc, begins_inside);
    tcase_add_test(tc, far_in_one_step);
    tcase_add_test(tc, unstable_branch_is_left);
    tcase_add_test(tc, inverted_are_counted);
    tcase_add_test(tc, smaller_than_the_mesh);
    tcase_add_test(tc, force_is_smooth_across_triangles);
    tcase_add_test(tc, on_tetrahedra);
    tcase_add_test(tc, refuses_what_makes_no_sense);
}
