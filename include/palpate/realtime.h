/* realtime.h: stepping a network within a haptic tick: best state reached, with an estimate of its error.
 * Stable. */
#ifndef PALPATE_REALTIME_H
#define PALPATE_REALTIME_H

#include <palpate/network.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Steps a network within ticks: a kept factor of its tangent, and what tells the error of a force. */
typedef struct palp_realtime palp_realtime; /* opaque; palp_realtime_free */

typedef struct palp_realtime_settings {
    double refresh_share; /* of a tick's work that goes into the next factor while the present one serves, 0
                             to 1 */
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

/* Sets the network back to rest and makes the factor anew, which takes as long as creating. After
 * palp_network_reset or _set_material, which know nothing of it, the next step does so first. The statuses of
 * create; where it fails the factor in use still serves. */
PALP_API palp_status palp_realtime_reset(palp_realtime *realtime);

/* When a tick's work ends; the first of these. 0 = that one does not count; all 0 = at the network's
 * tolerance. Without a limit in seconds or corrections a tick of a network with PALP_BRANCH_STABLE goes
 * downhill until it is solved, however far a branch that ended was above the next stable one; of other
 * networks it gives up after some 400 corrections. */
typedef struct palp_budget {
    double seconds; /* since the call, monotonic clock; at least one correction is made. Results then depend
                       on the machine */
    size_t corrections; /* solves with the kept factor; same input gives same bits */
    double force_error; /* estimated, relative to the force */
} palp_budget;

typedef struct palp_tick_info {
    bool converged;     /* the residual met the network's tolerance or the budget's force_error */
    size_t corrections; /* solves done */
    bool buckled;    /* on the way the tangent was found not to be positive definite: the branch may have been
                        left for another, or have ended */
    bool refreshed;  /* a new factor came into use */
    double residual; /* |residual| / |element forces| */
    double force_N;  /* reaction conjugate to depth by virtual work: its error is of second order */
    double force_error_N; /* its estimated error and that of the forces on tools, rather too large than too
                             small: of a tick that has not converged it may be many times the force, which
                             then says nothing */
    bool error_known; /* false where most of that error is what friction remembers of earlier ticks: of this
                         only a bound is known, which may be hundreds of times the error */
    double seconds;   /* that the call took */
    double beyond;    /* as of palp_step_info */
    size_t inverted;  /* likewise; a tick looks at a 16th of the tetrahedra, so each is as the last 16 ticks
                         saw it */
} palp_tick_info;

/* One step to depth_m after dt_s seconds, as palp_network_step, but ended by the budget: the best state
 * reached is committed, what is left of the residual is worked off by the next ticks. Allocates nothing. info
 * may be NULL. A tool that goes far is followed in parts (palp_network_set_tools), each with a budget of
 * corrections of its own. On failure the state stays as it was: ERR_ARGUMENT: a number out of range;
 * ERR_COLLAPSED: no sound place to start from; ERR_INSIDE: as of palp_network_step. */
PALP_API palp_status palp_realtime_step(palp_realtime *realtime, double depth_m, double dt_s,
                                        const palp_budget *budget, palp_tick_info *info);

/* Stored in springs (the law's energy), arms and motion at the committed state, J; NAN for no realtime. */
PALP_API double palp_realtime_energy(const palp_realtime *realtime);

/* The network's state and its own (which factor serves, how far the next one is) into a buffer of the
 * caller's, and back into this one or another made alike: palp_realtime_step with a budget of corrections
 * then goes on to the same bits. Restoring takes as long as creating. To take back steps only,
 * palp_network_save and _restore will do: the factor stays. ERR_ARGUMENT: a buffer too small or of another
 * kind or network, none; ERR_INPUT: a buffer whose checksums are not those of its bytes. What is refused
 * changes nothing. */
PALP_API size_t palp_realtime_state_size(const palp_realtime *realtime); /* bytes */
PALP_API palp_status palp_realtime_save(const palp_realtime *realtime, void *buffer, size_t size);
PALP_API palp_status palp_realtime_restore(palp_realtime *realtime, const void *buffer, size_t size);

#ifdef __cplusplus
}
#endif
#endif
