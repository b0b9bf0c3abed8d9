/* test_allocation_network.c: the allocations of networks: each may be refused, and none is made in a step
 * or a tick. */
/* link: -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free */
#define _POSIX_C_SOURCE 200809L
#include "scratch.h"
#include "allocation_count.h"

#include <palpate/cut.h>
#include <palpate/realtime.h>
#include <palpate/tool.h>

#include <SuiteSparse_config.h>

/* ---- networks ---- */

/* A material that needs more room than there is leaves the network as it was. */
static palp_status use_network(palp_network *network) {
    palp_material more = with_arms(3), other = with_arms(1);
    palp_status status = palp_network_step(network, 0.002, 0.1, NULL);
    double force = palp_network_force(network);
    if (!status)
        status = palp_network_set_material(network, &more);
    if (status && (palp_network_force(network) != force || palp_network_step(network, 0.003, 0.1, NULL)))
        abort();
    other.formulation = PALP_SEDEF2008;
    if (!status)
        status = palp_network_step(network, 0.002, 0.1, NULL);
    if (!status)
        status = palp_network_set_material(network, &other);
    if (!status)
        status = palp_network_step(network, 0.002, 0.1, NULL);
    return status;
}

static palp_status network_banded(palp_error *error) {
    palp_network *network;
    palp_status status = make_network(PALP_SOLVER_BAND, 1000.0, &network, error);
    if (!status)
        status = use_network(network);
    palp_network_free(network);
    return status;
}

static palp_status network_simplicial(palp_error *error) {
    palp_network *network;
    palp_status status = make_network(PALP_SOLVER_SIMPLICIAL, 0.0, &network, error);
    if (!status)
        status = use_network(network);
    palp_network_free(network);
    return status;
}

/* A sphere and a hull press, a node is held; then steps that must not allocate. */
static palp_status network_with_tools(palp_error *error) {
    palp_network *network;
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_tool tool[2] = {{PALP_TOOL_SPHERE, {0.012, 0.012, -0.0035}, {0, 0, 0}, 0, 0.004, 0.3, {0}, NULL},
                         {PALP_TOOL_HULL, {0.012, 0.012, 0.0275}, {0, 0, 0}, 0, 0.002, 0.3, {0}, NULL}};
    palp_hull *hull = NULL;
    palp_status status = make_network(PALP_SOLVER_BAND, 0.0, &network, error);
    if (!status)
        status = palp_hull_create_box((const double[]){0.003, 0.003, 0.002}, &hull, error);
    tool[1].hull = hull;
    if (!status)
        status = palp_network_enable_tools(network, 2, 1, &contact);
    if (!status)
        status =
            palp_network_grasp(network, 1, (const int32_t[]){13}, (const double[]){0.0121, 0.012, 0.012});
    size_t calls = heap.calls;
    for (int i = 0; i < 3 && !status; i++) {
        tool[0].position_m[2] += 1e-4;
        tool[1].position_m[2] -= 1e-4;
        status = palp_network_set_tools(network, 2, tool);
        if (!status)
            status = palp_network_step(network, 0.0, 0.1, NULL);
    }
    if (heap.calls != calls)
        abort();
    palp_network_free(network);
    palp_hull_free(hull);
    return status;
}

/* With levels, and with a thread that makes the next factor. */
static palp_status network_realtime(palp_error *error) {
    palp_network *network;
    palp_realtime *realtime = NULL;
    palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_budget budget = {.corrections = 1};
    settings.background = true;
    palp_status status = make_lattice(8, PALP_SOLVER_BAND, 0.0, &network, error);
    if (!status)
        status = palp_realtime_create(network, &settings, &realtime);
    if (!status)
        status = palp_realtime_step(realtime, 1e-4, 1e-3, &budget, NULL);
    palp_realtime_free(realtime);
    palp_network_free(network);
    return status;
}

/* Cuts and tears, and steps between them, that must not allocate. */
static palp_status network_cut_up(palp_error *error) {
    static const double blade[9] = {-1, 0.017, -1, 0.01, 0.017, 1, 1, 0.017, -1};
    palp_network *network;
    size_t n = 0;
    palp_status status = make_network(PALP_SOLVER_BAND, 0.0, &network, error);
    if (!status)
        status = palp_network_enable_cutting(network);
    size_t calls = heap.calls;
    if (!status)
        status = palp_network_step(network, 1e-3, 0.1, NULL);
    if (!status)
        status = palp_network_cut(network, blade, &n);
    if (!status && n == 0)
        abort();
    if (!status)
        status = palp_network_set_tearing(network, 0.01, 0.0);
    if (!status)
        status = palp_network_tear(network, &n);
    if (!status && n == 0)
        abort();
    if (!status)
        status = palp_network_step(network, 1e-3, 0.1, NULL);
    if (heap.calls != calls)
        abort();
    palp_network_free(network);
    return status;
}

START_TEST(networks) {
    each_fails(network_banded, 40, NULL);
    each_fails(network_simplicial, 40, NULL);
    each_fails(network_with_tools, 50, NULL);
    each_fails(network_cut_up, 50, NULL);
    each_fails(network_realtime, 100, NULL);
}
END_TEST

/* ---- the forward model ---- */

/* CHOLMOD's allocations fail too: its memory is counted by SuiteSparse's own wrappers. */
static size_t cholmod_live;

static void *cholmod_malloc(size_t size) {
    void *p = refused() ? NULL : __real_malloc(size);
    cholmod_live += p != NULL;
    return p;
}

static void *cholmod_calloc(size_t n, size_t size) {
    void *p = refused() ? NULL : __real_calloc(n, size);
    cholmod_live += p != NULL;
    return p;
}

static void *cholmod_realloc(void *old, size_t size) {
    void *p = refused() ? NULL : __real_realloc(old, size);
    cholmod_live += p && !old;
    return p;
}

static void cholmod_free_one(void *p) {
    cholmod_live -= p != NULL;
    __real_free(p);
}

static void wrap_cholmod(bool on) {
#if SUITESPARSE_VERSION >= SUITESPARSE_VER_CODE(6, 0)
    SuiteSparse_config_malloc_func_set(on ? cholmod_malloc : __real_malloc);
    SuiteSparse_config_calloc_func_set(on ? cholmod_calloc : __real_calloc);
    SuiteSparse_config_realloc_func_set(on ? cholmod_realloc : __real_realloc);
    SuiteSparse_config_free_func_set(on ? cholmod_free_one : __real_free);
#else
    SuiteSparse_config.malloc_func = on ? cholmod_malloc : __real_malloc;
    SuiteSparse_config.calloc_func = on ? cholmod_calloc : __real_calloc;
    SuiteSparse_config.realloc_func = on ? cholmod_realloc : __real_realloc;
    SuiteSparse_config.free_func = on ? cholmod_free_one : __real_free;
#endif
    cholmod_live = 0;
}

START_TEST(networks_with_cholmod) {
    wrap_cholmod(true);
    each_fails(network_simplicial, 80, NULL);
    ck_assert_uint_eq(cholmod_live, 0);
    wrap_cholmod(false);
}
END_TEST

/* ---- none in a time step ---- */

/* Presses past the loss of stability, holds, comes back and starts anew. */
static palp_status press(palp_network *network) {
    palp_material material = with_arms(2);
    palp_status status = PALP_OK;
    for (int i = 2; i <= 97 && !status; i++)
        status = palp_network_step(network, 0.0001 * i, 100.0, NULL);
    for (int i = 0; i < 5 && !status; i++)
        status = palp_network_step(network, 0.0097, 0.1, NULL);
    if (!status && !palp_network_buckled(network, &(double){0}, &(double){0}))
        status = PALP_ERR_ARGUMENT;
    if (!status)
        status = palp_network_step(network, 0.002, INFINITY, NULL);
    if (!status)
        status = palp_network_step_force(network, 0.5, 1.0, NULL);
    if (!status)
        status = palp_network_set_material(network, &material);
    if (!status)
        status = palp_network_step(network, 0.004, 1.0, NULL);
    palp_network_reset(network);
    return status;
}

/* After the first step nothing is allocated, by us or by CHOLMOD. */
static void count_steps(palp_solver solver, palp_branch branch) {
    palp_network_settings settings = palp_network_settings_default();
    palp_material material = with_arms(2);
    settings.solver = solver;
    settings.branch = branch;
    wrap_cholmod(true);
    arm(0);
    palp_network *network = cube_network(3, &material, &settings);
    palp_status first = palp_network_step(network, 0.0001, 100.0, NULL);
    size_t before = heap.calls;
    palp_status status = press(network);
    size_t after = heap.calls;
    palp_network_free(network);
    heap.armed = false;
    ck_assert_int_eq(first, PALP_OK);
    ck_assert_int_eq(status, PALP_OK);
    ck_assert_uint_gt(before, 40);
    ck_assert_uint_eq(after, before);
    ck_assert_uint_eq(heap.live, 0);
    ck_assert_uint_eq(cholmod_live, 0);
    wrap_cholmod(false);
}

/* Ticks through several factors, saved and restored with and without the factor: nothing is allocated. */
static palp_status ticks(palp_realtime *realtime, void *buffer, size_t size) {
    palp_network *network = palp_realtime_network(realtime);
    palp_status status = PALP_OK;
    palp_tick_info info;
    size_t refreshed = 0;
    for (int i = 1; i <= 150 && !status; i++) {
        palp_budget budget = {
            .corrections = (size_t)(i % 3), .force_error = 1e-6, .seconds = i % 2 ? 1.0 : 0.0};
        status = palp_realtime_step(realtime, 2e-5 * i, 1e-3, &budget, &info);
        refreshed += info.refreshed;
    }
    if (!status)
        status = palp_network_save(network, buffer, size);
    if (!status)
        status = palp_network_restore(network, buffer, size);
    if (!status)
        status = palp_realtime_save(realtime, buffer, size);
    if (!status)
        status = palp_realtime_restore(realtime, buffer, size);
    return !status && refreshed < 2 ? PALP_ERR_ARGUMENT : status;
}

static void count_ticks(size_t n, bool background) {
    static unsigned char buffer[4000000];
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_network *network = NULL;
    palp_realtime *realtime = NULL;
    settings.background = background;
    arm(0);
    palp_status first = make_lattice(n, PALP_SOLVER_BAND, 0.0, &network, NULL);
    if (!first)
        first = palp_realtime_create(network, &settings, &realtime);
    size_t before = heap.calls, size = palp_realtime_state_size(realtime);
    palp_status status = size <= sizeof buffer ? ticks(realtime, buffer, size) : PALP_ERR_LIMIT;
    size_t after = heap.calls;
    palp_realtime_free(realtime);
    palp_network_free(network);
    heap.armed = false;
    ck_assert_int_eq(first, PALP_OK);
    ck_assert_int_eq(status, PALP_OK);
    ck_assert_uint_eq(after, before);
    ck_assert_uint_eq(heap.live, 0);
}

START_TEST(none_in_a_tick) {
    count_ticks(4, false);
    count_ticks(8, false);
    count_ticks(8, true);
}
END_TEST

START_TEST(none_in_a_step) {
    count_steps(PALP_SOLVER_BAND, PALP_BRANCH_CONTINUE);
    count_steps(PALP_SOLVER_BAND, PALP_BRANCH_STABLE);
    count_steps(PALP_SOLVER_SIMPLICIAL, PALP_BRANCH_CONTINUE);
    count_steps(PALP_SOLVER_SIMPLICIAL, PALP_BRANCH_STABLE);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, networks);
    tcase_add_test(tc, networks_with_cholmod);
    tcase_add_test(tc, none_in_a_step);
    tcase_add_test(tc, none_in_a_tick);
}
