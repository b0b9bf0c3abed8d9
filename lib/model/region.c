/* region.c: regions by their shape. */
#include "base/file.h"

#include <palpate/region.h>

#include <math.h>
#include <string.h>

static double is_in_box(void *user, const double x[3]) {
    const palp_region *r = user;
    for (int k = 0; k < 3; k++)
        if (x[k] < fmin(r->low_m[k], r->high_m[k]) || x[k] > fmax(r->low_m[k], r->high_m[k]))
            return 0.0;
    return 1.0;
}

static double is_in_sphere(void *user, const double x[3]) {
    const palp_region *r = user;
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (x[k] - r->centre_m[k]) * (x[k] - r->centre_m[k]);
    return square <= r->radius_m * r->radius_m ? 1.0 : 0.0;
}

palp_status palp_region_place_in(palp_mesh *mesh, const palp_region *region, palp_error *error) {
    if (!mesh || !region || !memchr(region->name, '\0', PALP_REGION_NAME_MAX))
        return palp_error_null(error);
    palp_region shape = *region; /* places have no const user */
    palp_status status = PALP_OK;
    if (region->shape == PALP_REGION_MEMBRANE) /* it has no volume */
        return region->set[0] && palp_mesh_set(mesh, region->set, &(size_t){0}, &(const int32_t *){NULL})
                   ? palp_error_set(error, PALP_ERR_INPUT, "the mesh has no node set \"%s\"", region->set)
                   : PALP_OK;
    if (region->shape != PALP_REGION_OF_MESH)
        status = palp_mesh_add_region(mesh, region->name,
                                      region->shape == PALP_REGION_BOX ? is_in_box : is_in_sphere, &shape);
    else if (palp_mesh_region(mesh, region->name, &(const double *){NULL}))
        return palp_error_set(error, PALP_ERR_INPUT, "the mesh has no group of volumes called \"%s\"",
                              region->name);
    if (status == PALP_ERR_INPUT)
        return palp_error_set(error, status, "no part of the mesh is in the region \"%s\"", region->name);
    return status ? palp_error_set(error, status, "the region \"%s\": %s", region->name,
                                   palp_status_text(status))
                  : PALP_OK;
}
