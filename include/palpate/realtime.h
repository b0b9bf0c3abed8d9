/* realtime.h: stepping a network within a haptic tick: best state reached, with an estimate of its error. */
#ifndef PALPATE_REALTIME_H
#define PALPATE_REALTIME_H

#include <palpate/network.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How a network is stepped within a tick. */
typedef struct palp_realtime_settings {
    double refresh_share;  /* of a tick's work that goes into the next factor while the present one serves, 0 to 1 */
    bool background;       /* make the next factor in a thread of its own; the results then depend on timing */
} palp_realtime_settings;

/* 0.15, no thread */
PALP_API palp_realtime_settings palp_realtime_settings_default(void);

/* Makes ready for palp_network_step_within; all memory is allocated and a first factor made here. After
 * palp_network_enable_tools and _enable_cutting where those are wanted; once. ERR_ARGUMENT: a setting out of range, done
 * before; ERR_NO_MEMORY; ERR_SINGULAR: a mechanism. palp_network_reset and _set_material make the factor anew. */
PALP_API palp_status palp_network_enable_realtime(palp_network *network, const palp_realtime_settings *settings);

/* When a tick's work ends; the first of these. 0 = that one does not count; all 0 = at the network's tolerance. */
typedef struct palp_budget {
    double seconds;     /* since the call, monotonic clock; at least one correction is made. Results then depend on
                           the machine */
    size_t corrections; /* solves with the kept factor; same input gives same bits */
    double force_error; /* estimated, relative to the force */
} palp_budget;

typedef struct palp_tick_info {
    bool converged;       /* the residual met the network's tolerance or the budget's force_error */
    size_t corrections;   /* solves done */
    bool refreshed;       /* a new factor came into use */
    double residual;      /* |residual| / |element forces| */
    double force_N;       /* reaction conjugate to depth by virtual work: its error is of second order */
    double force_error_N; /* its estimated error and that of the forces on tools, rather too large than too small */
    double energy_J;      /* stored in springs (the law's energy), arms and motion */
    double seconds;       /* that the call took */
} palp_tick_info;

/* One step to depth_m after dt_s, as palp_network_step, but ended by the budget: the best state reached is
 * committed, what is left of the residual is worked off by the next ticks. Allocates nothing. info may be
 * NULL. On failure (ERR_ARGUMENT, ERR_COLLAPSED, ...) the state stays as it was. */
PALP_API palp_status palp_network_step_within(palp_network *network, double depth_m, double dt_s,
                                              const palp_budget *budget, palp_tick_info *info);

/* Takes back the last committed step, once; a factor that came into use meanwhile and cuts stay. ERR_ARGUMENT: there
 * is none. */
PALP_API palp_status palp_network_undo(palp_network *network);

/* The whole state (positions, history, contacts, held nodes, cuts, what the predictor knows and which factor serves)
 * into a buffer of the caller's, and back into the same network or another one made and enabled alike. Step_within with a
 * budget of corrections goes on to the same bits; palp_network_step, which keeps no factor then, to the same within its
 * tolerance. Restoring takes as long as enabling. ERR_ARGUMENT: a buffer too small, another network's, none. */
PALP_API size_t palp_network_state_size(const palp_network *network); /* bytes */
PALP_API palp_status palp_network_save(const palp_network *network, void *buffer, size_t size);
PALP_API palp_status palp_network_restore(palp_network *network, const void *buffer, size_t size);

#ifdef __cplusplus
}
#endif
#endif
