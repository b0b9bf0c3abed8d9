/* allocation_count.h: counts and refuses allocations, where the library asks for them. */
#ifndef ALLOCATION_COUNT_H
#define ALLOCATION_COUNT_H

#include "cube.h"

/* The wrapped functions are those that this program and the library in it call; other libraries' own are
 * not touched, but for CHOLMOD's, which asks SuiteSparse_config for them. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *p);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_free(void *p);

enum { LIVE_MAX = 8192 };

static struct {
    bool armed;         /* inside the library */
    size_t calls, fail; /* the fail-th call gives NULL; 0 = none does */
    size_t live;        /* blocks taken while armed and not yet given back */
    void *block[LIVE_MAX];
} heap;

static inline bool refused(void) {
    return heap.armed && ++heap.calls == heap.fail;
}

static inline void *taken(void *p) {
    if (heap.armed && p) {
        if (heap.live == LIVE_MAX)
            abort();
        heap.block[heap.live++] = p;
    }
    return p;
}

/* Blocks from elsewhere (realpath, Jansson) are not ours to count. */
static inline void given_back(const void *p) {
    for (size_t i = heap.live; i-- > 0;)
        if (heap.block[i] == p) {
            heap.block[i] = heap.block[--heap.live];
            return;
        }
}

void *__wrap_malloc(size_t size) {
    return refused() ? NULL : taken(__real_malloc(size));
}

void *__wrap_calloc(size_t n, size_t size) {
    return refused() ? NULL : taken(__real_calloc(n, size));
}

void *__wrap_realloc(void *old, size_t size) {
    if (refused())
        return NULL;
    given_back(old);
    return taken(__real_realloc(old, size));
}

void __wrap_free(void *p) {
    given_back(p);
    __real_free(p);
}

static inline void arm(size_t fail) {
    heap.armed = true;
    heap.calls = 0;
    heap.fail = fail;
}

typedef palp_status (*scenario)(palp_error *error);

/* Runs a scenario, which gives back all that it takes, until none of its allocations is left to fail. */
static inline void each_fails(scenario run, size_t least, void (*check)(palp_status status)) {
    size_t n = 0;
    for (;;) {
        palp_error error = {PALP_OK, ""};
        arm(++n);
        palp_status status = run(&error);
        heap.armed = false;
        ck_assert_msg(heap.live == 0, "allocation %zu: %zu blocks leak", n, heap.live);
        if (check)
            check(status);
        if (heap.calls < n) {
            ck_assert_int_eq(status, PALP_OK);
            break;
        }
        ck_assert_msg(status == PALP_OK || status == PALP_ERR_NO_MEMORY, "allocation %zu: %s", n,
                      palp_status_name(status));
        if (error.status) {
            ck_assert_int_eq(error.status, status);
            ck_assert_int_ne(error.text[0], '\0');
        }
    }
    ck_assert_uint_gt(n, least); /* the wrapping works */
}

static inline palp_material with_arms(size_t n) {
    palp_material material = {.law = {.kind = PALP_LAW_POLYNOMIAL, .n = 5}, .n_arms = n};
    memcpy(material.law.coefficients, NETWORK_LAW, sizeof NETWORK_LAW);
    for (size_t j = 0; j < n; j++)
        material.arms[j] = (palp_arm){.stiffness_N = 0.1, .viscosity_Ns = 0.1 * (double)(j + 1)};
    return material;
}

static inline palp_status make_lattice(size_t n, palp_solver solver, double density, palp_network **network,
                                       palp_error *error) {
    palp_mesh *mesh = NULL;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_material material = with_arms(1);
    settings.solver = solver;
    settings.density_kg_m3 = density;
    *network = NULL;
    palp_supports_default(supports);
    palp_status status =
        palp_mesh_lattice((size_t[3]){n, n, n}, (double[3]){CUBE_HEIGHT_M, CUBE_HEIGHT_M, CUBE_HEIGHT_M},
                          PALP_NEIGHBOURS_26, &mesh);
    if (!status)
        status = palp_network_create(mesh, &material, 2, supports, &settings, network, error);
    palp_mesh_free(mesh);
    return status;
}

static inline palp_status make_network(palp_solver solver, double density, palp_network **network,
                                       palp_error *error) {
    return make_lattice(3, solver, density, network, error);
}

#endif
