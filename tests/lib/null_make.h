/* null_make.h: what the tests of NULL give the calls beside it. */
#ifndef NULL_MAKE_H
#define NULL_MAKE_H

#include "network_make.h"

#include <palpate/palpate.h>

#include <stdint.h>

#define REFUSED(call) ck_assert_int_eq(call, PALP_ERR_ARGUMENT)
#define NOTHING(told) ck_assert(told)

/* What else the calls are given; opaque and large things are storage, which a call that is refused does not
 * look at. */
static union {
    double aligned;
    unsigned char bytes[1 << 16];
} room;
static unsigned char *const storage = room.bytes;
static void *pointers[4] = {room.bytes, room.bytes, room.bytes, room.bytes};
static double numbers[16] = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
static const size_t sizes[3] = {3, 3, 3};
static const char *text = "top";
static size_t count;
static palp_material material;
static palp_model model;
static palp_path path;
static palp_mesh *mesh;
static palp_network *net;

static inline void setup(void) {
    palp_contact_settings settings = palp_contact_settings_default();
    material = quartic(1);
    model.material = material;
    ck_assert_int_eq(palp_path_ramp_hold(1e-3, 1.0, 1.0, &path), PALP_OK);
    mesh = cube(3, PALP_NEIGHBOURS_26);
    net = cube_network(3, &material, NULL);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 2, 2, &settings), PALP_OK);
}

static inline void teardown(void) {
    palp_network_free(net);
    palp_mesh_free(mesh);
    palp_path_free(&path);
}

#endif
