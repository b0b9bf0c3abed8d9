/* realtime.h: steps a network within a haptic tick: the best state reached, and an estimate of its error.
 * Stable. */
#ifndef PALPATE_REALTIME_H
#define PALPATE_REALTIME_H

#include <palpate/network.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A solver for ticks: a kept factor of the network's tangent, and an adjoint for the error of the force. */
typedef struct palp_realtime palp_realtime; /* opaque; palp_realtime_free */

typedef struct palp_realtime_settings {
    double refresh_share; /* share of a tick's work spent on the next factor while the present one is in use,
                             0 to 1 */
    bool background;      /* make the next factor in a thread of its own; the results then depend on timing */
} palp_realtime_settings;

/* 0.15, no thread */
PALP_API palp_realtime_settings palp_realtime_settings_default(void);

/* Makes one for a network, which stays the caller's and must outlive it; all memory is allocated and a first
 * factor made here, of the network as it is. The caller owns *realtime. ERR_ARGUMENT: a setting out of range,
 * a network that has one already; ERR_NO_MEMORY; ERR_SINGULAR: a mechanism; ERR_COLLAPSED. */
PALP_API palp_status palp_realtime_create(palp_network *network, const palp_realtime_settings *settings,
                                          palp_realtime **realtime);
PALP_API void palp_realtime_free(palp_realtime *realtime); /* NULL is fine */
PALP_API palp_network *palp_realtime_network(const palp_realtime *realtime);

/* Resets the network to rest and makes a new factor, which takes as long as creating. After
 * palp_network_reset or _set_material the next step does this first. Statuses as for create; after a failure
 * the factor in use stays. */
PALP_API palp_status palp_realtime_reset(palp_realtime *realtime);

/* A tick's work ends at the first limit reached. 0 = no limit; all 0 = at the network's tolerance. Without a
 * limit in seconds or corrections a tick with PALP_BRANCH_STABLE goes downhill in energy until it is solved.
 * With the other branch it gives up after some 400 corrections. */
typedef struct palp_budget {
    double seconds; /* since the call, monotonic clock; at least one correction is made. Results then depend
                       on the machine */
    size_t corrections; /* solves with the kept factor; same input gives same bits. A tick whose residual
                           still exceeds the element forces makes more, up to 60, whatever the budget: the
                           next ticks could not recover from it (doc/realtime.md, Fast tools) */
    double force_error; /* estimated, relative to the force */
} palp_budget;

typedef struct palp_tick_info {
    bool converged;     /* the residual met the network's tolerance or the budget's force_error */
    size_t corrections; /* solves done */
    bool buckled;    /* the tangent was not positive definite in this tick: the branch may have been left, or
                        have ended */
    bool refreshed;  /* a new factor came into use */
    double residual; /* |residual| / |element forces| */
    double force_N;  /* reaction conjugate to depth by virtual work: its error is of second order */
    double force_error_N; /* its estimated error and that of the forces on tools, rather too large than too
                             small: with tools 20 to 85 times the error in the mean, in a steady
                             slide some hundreds of times */
    double seconds;       /* that the call took */
    double beyond;        /* as in palp_step_info */
    size_t inverted; /* likewise; a tick assesses a 16th of the tetrahedra, so the count covers the last 16
                        ticks */
} palp_tick_info;

/* One step to depth_m after dt_s seconds, as palp_network_step, but limited by the budget: the best state
 * reached is committed, and the next ticks reduce the remaining residual. Allocates nothing. info may be
 * NULL. A tool that moves far is followed in parts (palp_network_set_tools), each with its own budget of
 * corrections. On failure the state stays as it was: ERR_ARGUMENT: a number out of range; ERR_COLLAPSED: no
 * first guess could be evaluated; ERR_INSIDE, ERR_LIMIT: as in palp_network_step. */
PALP_API palp_status palp_realtime_step(palp_realtime *realtime, double depth_m, double dt_s,
                                        const palp_budget *budget, palp_tick_info *info);

/* Energy in springs (of the law), arms and motion at the committed state, J; NAN if realtime is NULL. */
PALP_API double palp_realtime_energy(const palp_realtime *realtime);

/* Saves the states of network and solver (which factor is in use, progress of the next one) to the caller's
 * buffer. Restores them to this solver or another one created alike: palp_realtime_step with a budget of
 * corrections then gives the same bits. Restoring takes as long as creating. To undo steps only,
 * palp_network_save and _restore suffice: the factor stays. ERR_ARGUMENT: no buffer, one too small, or of
 * another kind or network; ERR_INPUT: wrong checksum. After an error nothing has changed. */
PALP_API size_t palp_realtime_state_size(const palp_realtime *realtime); /* bytes */
PALP_API palp_status palp_realtime_save(const palp_realtime *realtime, void *buffer, size_t size);
PALP_API palp_status palp_realtime_restore(palp_realtime *realtime, const void *buffer, size_t size);

#ifdef __cplusplus
}
#endif
#endif
