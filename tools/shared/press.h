/* press.h: runs a lumped model or a network along a path and records the force. */
#ifndef PALPATE_PRESS_H
#define PALPATE_PRESS_H

#include "progress.h"
#include "record.h"

#include <palpate/network.h>
#include <palpate/tool.h>
#include <stdbool.h>

typedef struct press_settings {
    double dt_s;      /* > 0: fixed steps */
    double tolerance; /* else: relative error of the force (of the depth, creep) */
    bool relaxed;     /* every sample fully relaxed */
    bool corners;     /* keep only the samples at the path's corners */
    double from_s;    /* network, fixed steps: > 0: it is restored at this time of the path, and the curve
                         has what was before */
} press_settings;

/* Sample times for a path: its corners only; or steps of at most dt_s; or, if dt_s is 0, even steps
 * where it moves and growing ones where it is held. malloc'ed; the caller frees it. */
palp_status press_times(const palp_path *path, const press_settings *settings, size_t *n, double **time_s);

/* A lumped specimen of height height_m. PALP_ERR_COLLAPSED: a creep force it cannot carry. */
palp_status press_lumped(const palp_material *material, double height_m, const palp_path *path,
                         const press_settings *settings, record *curve);

/* A network at rest, or restored. bar may be NULL; frame may be NULL, else it is called after each step and
 * stops the run by a non-zero return. */
typedef struct press_watch {
    progress *bar;
    int (*frame)(void *user);
    void *user;
} press_watch;

palp_status press_network(palp_network *network, const palp_path *path, const press_settings *settings,
                          const press_watch *watch, record *curve, palp_run_info *info);

/* A sphere where it just touches a mesh from above at x and z; where these are NAN, its highest nodes in
 * their middle. */
palp_tool press_sphere(const palp_mesh *mesh, double radius_m, double x_m, double z_m);

/* A network at rest under a tool that comes down along the path from where it just touches: start. In steps
 * of the path's times (press_times), with the upward force on the tool. */
palp_status press_tool(palp_network *network, const palp_tool *start, const palp_path *path,
                       const press_settings *settings, const press_watch *watch, record *curve,
                       palp_run_info *info);

/* The one warning about a run that goes beyond the strain that its law was measured to; first_s < 0: told no
 * time. */
void press_warn_beyond(const char *name, const palp_law *law, double largest_strain, double first_s);

/* The one warning about a network that buckled between two depths. */
void press_warn_buckled(const char *name, double stable_m, double unstable_m, double height_m,
                        palp_branch branch);

#endif
