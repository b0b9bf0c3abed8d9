/* acquire_reconnect.c: opens a broken link again, where nothing moved and nothing was recorded. If the device
 * ran on meanwhile, its home, tare and contact are still valid. */
#define _POSIX_C_SOURCE 200809L
#include "acquire_session.h"

#include <time.h>

enum { NAP_MS = 100 };

bool session_reopen(session *s) {
    palp_wire_message got;
    if (device_reopen(s->options->where, s->options->baud, &s->device) != DEVICE_OK ||
        device_do(&s->device, PALP_WIRE_TYPE_GET_STATUS, &got) != DEVICE_OK)
        return false;
    s->why[0] = '\0';
    s->heard_s = s->asked_s = link_now_s();
    return true;
}

/* Tries until the device answers, a stop is requested, or the time is over. */
static outcome wait_for_it(session *s, double patience_s) {
    const double until_s = link_now_s() + patience_s;
    const struct timespec nap = {.tv_nsec = 1000000L * NAP_MS};
    while (!session_reopen(s)) {
        if (session_is_to_stop(s))
            return STOPPED;
        if (link_now_s() > until_s) {
            session_fail(s, "%s", s->device.why);
            return GONE;
        }
        nanosleep(&nap, NULL);
    }
    return GOES_ON;
}

/* Checks that it is the same device without a restart; samples stay on or off. */
static outcome go_on(session *s, uint32_t serial, const palp_wire_status *then) {
    const palp_wire_status *now = &s->device.status;
    const bool quiet = s->quiet,
               moved = then->contact_known && (!now->contact_known || now->contact != then->contact);
    if (s->device.info.serial != serial)
        return session_fail(s, "another device answers at %s", s->options->where);
    if (now->tick - then->tick > INT32_MAX || moved)
        return session_fail(
            s, "the device restarted while it was disconnected: home, tare and contact are lost");
    session_tell(s, false, "reconnected after %.1f s of the device's time",
                 s->scale.tick_s * (now->tick - then->tick));
    outcome end = session_configure(s);
    return end || !quiet ? end : session_stream(s, false);
}

outcome session_reconnect(session *s) {
    const palp_wire_status then = s->device.status;
    const uint32_t serial = s->device.info.serial;
    const double patience_s = s->options->reconnect_s;
    session_tell(s, true, "%s, %s: waiting %.0f s for a connection", s->device.why, s->doing, patience_s);
    s->reconnect = NULL; /* no second attempt after an immediate failure */
    outcome end = wait_for_it(s, patience_s);
    end = end ? end : go_on(s, serial, &then);
    s->reconnect = session_reconnect;
    return end;
}
