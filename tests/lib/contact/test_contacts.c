/* test_contacts.c: the list of points in contact. */
#include "tool_make.h"

enum { ROOM = 400 };

static size_t contacts_of(const palp_network *net, palp_contact contacts[ROOM]) {
    size_t n = 0;
    ck_assert_int_eq(palp_network_contacts(net, ROOM, contacts, &n), PALP_OK);
    ck_assert_uint_le(n, ROOM);
    return n;
}

/* What the list says adds up to what the tools feel. */
static void check_sums(const palp_network *net, size_t n_tools) {
    palp_contact contacts[ROOM];
    palp_tool_force felt[3];
    double sum[3][3] = {{0}}, deepest[3] = {0};
    size_t count[3] = {0};
    const size_t n = contacts_of(net, contacts);
    ck_assert_int_eq(palp_network_tool_force(net, felt), PALP_OK);
    for (size_t i = 0; i < n; i++) {
        const palp_contact *c = &contacts[i];
        ck_assert_uint_lt(c->tool, n_tools);
        ck_assert_double_eq_tol(dot3(c->normal, c->normal), 1.0, 1e-9);
        ck_assert_double_ge(c->normal_N, 0.0);
        ck_assert(c->node >= 0 && (size_t)c->node < net->n_nodes);
        for (int k = 0; k < 3; k++)
            sum[c->tool][k] -= c->normal_N * c->normal[k] + c->friction_N[k];
        deepest[c->tool] = fmax(deepest[c->tool], c->depth_m);
        count[c->tool]++;
    }
    for (size_t t = 0; t < n_tools; t++) {
        ck_assert_uint_eq(count[t], felt[t].contacts);
        ck_assert_double_eq_tol(deepest[t], felt[t].depth_m, 1e-15);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(sum[t][k], felt[t].force_N[k],
                                    1e-12 + 1e-9 * sqrt(dot3(felt[t].force_N, felt[t].force_N)));
    }
}

/* On local points, whole triangles and a smooth surface; a sphere and a capsule that slide, and a plane. */
START_TEST(sums_are_what_tools_feel) {
    palp_material m = linear();
    palp_contact_settings touch = palp_contact_settings_default();
    touch.local = _i == 0;
    touch.subdivisions = _i == 2 ? 1 : 0;
    palp_network *net = block(5, &m, 0.0, &touch);
    palp_contact contacts[ROOM];
    ck_assert_uint_eq(contacts_of(net, contacts), 0);
    for (int i = 0; i < 6; i++) {
        palp_tool tools[3] = {sphere(0.006 + 2e-4 * i, HEIGHT - 1e-3, 0.012, 0.005, 0.3),
                              capsule(0.016, HEIGHT - 5e-4, 0.008, 0.003, 0.0), plane(HEIGHT - 1e-4, 0.0)};
        const size_t n = i < 4 ? 2 : 3;
        ck_assert_int_eq(palp_network_set_tools(net, n, tools), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, 0.01, NULL), PALP_OK);
        check_sums(net, n);
    }
    ck_assert_uint_gt(contacts_of(net, contacts), 2);
    palp_network_free(net);
}
END_TEST

/* Pressed without friction nothing slips; led sideways with little of it, it does. A sphere from above
 * pushes down, at places within its contact. */
START_TEST(places_and_slip) {
    palp_material m = linear();
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_contact contacts[ROOM];
    size_t n, slipping = 0;
    palp_tool tool = sphere(0.012, HEIGHT - 1e-3, 0.012, 0.005, 0.1);
    step(net, &tool, 0.01);
    n = contacts_of(net, contacts);
    for (size_t i = 0; i < n; i++) {
        ck_assert_double_lt(hypot(contacts[i].place_m[0] - 0.012, contacts[i].place_m[2] - 0.012), 0.005);
        ck_assert_double_lt(contacts[i].normal[1], -0.5);
        ck_assert_int_eq(contacts[i].region, -1);
    }
    for (int i = 0; i < 10; i++) {
        tool.position_m[0] += 2e-4;
        step(net, &tool, 0.01);
    }
    n = contacts_of(net, contacts);
    for (size_t i = 0; i < n; i++)
        slipping += contacts[i].slips;
    ck_assert_uint_gt(slipping, 0);
    palp_network_free(net);
}
END_TEST

/* Which region a tool touches; a restored state has a list after its next step. */
START_TEST(regions_and_states) {
    palp_material m = linear();
    palp_mesh *mesh = cube(5, PALP_NEIGHBOURS_26);
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings touch = palp_contact_settings_default();
    palp_support supports[2];
    palp_region halves[2] = {{.name = "left",
                              .shape = PALP_REGION_BOX,
                              .low_m = {-1, -1, -1},
                              .high_m = {0.25 * HEIGHT, 1, 1},
                              .stiffness = 2},
                             {.name = "right",
                              .shape = PALP_REGION_BOX,
                              .low_m = {0.75 * HEIGHT, -1, -1},
                              .high_m = {1, 1, 1},
                              .stiffness = 0.5}};
    palp_network *net = NULL;
    palp_contact before[ROOM], after[ROOM];
    palp_supports_default(supports);
    for (int r = 0; r < 2; r++)
        ck_assert_int_eq(palp_region_place_in(mesh, &halves[r], NULL), PALP_OK);
    settings.n_regions = 2;
    settings.regions = halves;
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &touch), PALP_OK);
    void *buffer = malloc(palp_network_state_size(net));
    static const double PLACE[] = {0.1, 0.5, 0.95};
    static const int WANTED[] = {0, -1, 1};
    for (int i = 0; i < 3; i++) {
        palp_tool tool = sphere(PLACE[i] * HEIGHT, HEIGHT - 3e-4, 0.012, 0.0015, 0.0);
        palp_network_reset(net);
        step(net, &tool, 0.01);
        const size_t n = contacts_of(net, before);
        ck_assert_uint_gt(n, 0);
        int most = -2;
        double force = -1.0;
        for (size_t k = 0; k < n; k++)
            if (before[k].normal_N > force) {
                force = before[k].normal_N;
                most = before[k].region;
            }
        ck_assert_msg(most == WANTED[i], "at %g the region is %d", PLACE[i], most);
        ck_assert_int_eq(palp_network_save(net, buffer, palp_network_state_size(net)), PALP_OK);
        palp_network_reset(net);
        ck_assert_uint_eq(contacts_of(net, after), 0);
        ck_assert_int_eq(palp_network_restore(net, buffer, palp_network_state_size(net)), PALP_OK);
        ck_assert_uint_eq(contacts_of(net, after), 0);
        step(net, &tool, 0.01);
        ck_assert_uint_eq(contacts_of(net, after), n);
        for (size_t k = 0; k < n; k++)
            ck_assert_double_eq_tol(after[k].normal_N, before[k].normal_N, 1e-6 * force);
        size_t all = 0;
        ck_assert_int_eq(palp_network_contacts(net, 1, after, &all), PALP_OK);
        ck_assert_uint_eq(all, n);
    }
    free(buffer);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(needs_tools) {
    palp_material m = linear();
    palp_network *net = cube_network(3, &m, NULL);
    size_t n;
    ck_assert_int_eq(palp_network_contacts(net, 0, NULL, &n), PALP_ERR_ARGUMENT);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_loop_test(tc, sums_are_what_tools_feel, 0, 3);
    tcase_add_test(tc, places_and_slip);
    tcase_add_test(tc, regions_and_states);
    tcase_add_test(tc, needs_tools);
}
