/* reduce_snapshots.c: snapshots of the full network on a path. */
#include "base/file.h"
#include "reduce_internal.h"

#include <palpate/realtime.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORRECTIONS = 200 };

void palp_snapshots_free(palp_snapshots *t) {
    if (!t)
        return;
    arena_free(&t->memory);
    free(t);
}

static palp_snapshots *create_empty_snapshots(const palp_network *net, const palp_tool_path *path) {
    palp_snapshots *t = calloc(1, sizeof *t);
    if (!t)
        return NULL;
    t->n = path->n;
    t->n_nodes = net->n_nodes;
    t->n_tools = path->n_tools;
    t->time = arena_take(&t->memory, t->n, sizeof *t->time);
    t->depth = arena_take(&t->memory, t->n, sizeof *t->depth);
    t->force = arena_take(&t->memory, t->n, sizeof *t->force);
    t->x = arena_take(&t->memory, 3 * t->n_nodes * t->n, sizeof *t->x);
    t->tools = arena_take(&t->memory, t->n * t->n_tools, sizeof *t->tools);
    t->tool_force = arena_take(&t->memory, 3 * t->n * t->n_tools, sizeof *t->tool_force);
    if (!t->memory.failed)
        return t;
    palp_snapshots_free(t);
    return NULL;
}

static bool is_tool_path_valid(const palp_tool_path *path) {
    double before = -1.0;
    for (size_t i = 0; i < path->n; i++) {
        double time = path->time_s[i], depth = path->depth_m ? path->depth_m[i] : 0.0;
        if (!isfinite(time) || !isfinite(depth) || time < 0.0 || !(time > before))
            return false;
        before = time;
    }
    return path->n > 0;
}

/* Objects that record snapshots. */
typedef struct recorder {
    palp_network *net;
    palp_realtime *realtime; /* or NULL */
    void *saved;             /* [saved_size] bytes: the network before a step; with realtime */
    size_t saved_size;
    palp_tool_force *force; /* [n_tools] */
} recorder;

/* Solves for equilibrium, with the kept factor if there is one, which is much faster for large networks.
 * Newton's iteration follows if that does not converge. */
static palp_status step_to_equilibrium(const recorder *rec, double depth, double dt) {
    const palp_budget budget = {.corrections = CORRECTIONS};
    palp_tick_info info;
    if (!rec->realtime)
        return palp_network_step(rec->net, depth, dt, NULL);
    palp_status status = palp_network_save(rec->net, rec->saved, rec->saved_size);
    if (!status)
        status = palp_realtime_step(rec->realtime, depth, dt, &budget, &info);
    if (!status && info.converged)
        return PALP_OK;
    if (!status)
        status = palp_network_restore(rec->net, rec->saved, rec->saved_size);
    return status ? status : palp_network_step(rec->net, depth, dt, NULL);
}

/* Records one sample: sets the tools, makes a step, stores the result. */
static palp_status record_one_sample(const recorder *rec, palp_snapshots *t, size_t i) {
    palp_network *net = rec->net;
    double since = i ? t->time[i - 1] : 0.0;
    palp_status status = PALP_OK;
    if (t->n_tools > 0)
        status = palp_network_set_tools(net, t->n_tools, t->tools + i * t->n_tools);
    if (!status && (t->time[i] > since || t->depth[i] != 0.0 || t->n_tools > 0))
        status = step_to_equilibrium(rec, t->depth[i], t->time[i] - since);
    if (!status && t->n_tools > 0)
        status = palp_network_tool_force(net, rec->force);
    if (status)
        return status;
    t->force[i] = palp_network_force(net);
    memcpy(t->x + 3 * t->n_nodes * i, palp_network_positions(net), 3 * t->n_nodes * sizeof *t->x);
    for (size_t j = 0; j < t->n_tools; j++)
        memcpy(t->tool_force + 3 * (i * t->n_tools + j), rec->force[j].force_N, 3 * sizeof *t->tool_force);
    return PALP_OK;
}

static palp_status record_whole_path(const recorder *rec, const palp_tool_path *path,
                                     palp_network_observer observer, void *user, palp_snapshots *t,
                                     palp_error *error) {
    palp_status status = PALP_OK;
    for (size_t i = 0; !status && i < t->n; i++) {
        t->time[i] = path->time_s[i];
        t->depth[i] = path->depth_m ? path->depth_m[i] : 0.0;
        if (t->n_tools > 0)
            memcpy(t->tools + i * t->n_tools, path->tools + i * t->n_tools, t->n_tools * sizeof *t->tools);
        status = record_one_sample(rec, t, i);
        if (status)
            palp_error_set(error, status, "%s at %g s", palp_status_text(status), t->time[i]);
        else if (observer && observer(user, t->time[i], t->depth[i], t->force[i]))
            status = palp_error_set(error, PALP_ERR_STOPPED, "%s", palp_status_text(PALP_ERR_STOPPED));
    }
    return status;
}

palp_status palp_snapshots_record(palp_network *net, palp_realtime *realtime, const palp_tool_path *path,
                                  palp_network_observer observer, void *user, palp_snapshots **snapshots,
                                  palp_error *error) {
    if (!net || !path || !snapshots)
        return palp_error_null(error);
    if (!is_tool_path_valid(path) || (realtime && palp_realtime_network(realtime) != net))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "a path needs finite numbers at increasing times from 0 s on");
    recorder rec = {
        .net = net, .realtime = realtime, .saved_size = realtime ? palp_network_state_size(net) : 1};
    palp_snapshots *t = create_empty_snapshots(net, path);
    rec.force = calloc(path->n_tools + 1, sizeof *rec.force);
    rec.saved = malloc(rec.saved_size);
    palp_status status = t && rec.force && rec.saved ? PALP_OK : PALP_ERR_NO_MEMORY;
    palp_network_reset(net);
    if (realtime)
        palp_realtime_reset(realtime); /* if that fails, the factor in use stays */
    if (!status)
        status = record_whole_path(&rec, path, observer, user, t, error);
    free(rec.force);
    free(rec.saved);
    if (status) {
        palp_snapshots_free(t);
        return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
    }
    *snapshots = t;
    return PALP_OK;
}
