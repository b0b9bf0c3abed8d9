/* machine_ask.c: shared by the actions: a device at rest, error messages, a question, a date. */
#define _POSIX_C_SOURCE 200809L
#include "calibrate_device.h"

#include <math.h>
#include <time.h>

static const char NAME[] = MACHINE_NAME;

enum { IDLE_TRIES = 100, IDLE_POLL_MS = 20, DAY_S = 86400 };

int machine_failure(device *d, device_result result) {
    const bool faulted = result == DEVICE_REFUSED && d->refusal == PALP_WIRE_RESULT_FAULTED;
    cli_failure(NAME, "%s", d->why);
    return faulted ? CLI_DEVICE_FAULT : CLI_FAILURE;
}

int machine_idle(device *d) {
    palp_wire_message got;
    device_result result = device_do(d, PALP_WIRE_TYPE_GET_STATUS, &got);
    for (int i = 0; result == DEVICE_OK && d->status.state != PALP_WIRE_STATE_IDLE && i < IDLE_TRIES; i++) {
        if (d->status.state == PALP_WIRE_STATE_FAULT) {
            cli_failure(
                NAME,
                "the device has stopped: %s (%s); remove the cause, then run palpate firmware clear-fault",
                palp_wire_fault_name(d->status.fault), palp_wire_fault_text(d->status.fault));
            return CLI_DEVICE_FAULT;
        }
        if (d->status.state != PALP_WIRE_STATE_BOOT)
            result = device_do(d, PALP_WIRE_TYPE_STOP, NULL);
        result =
            result == DEVICE_OK && device_poll(d, IDLE_POLL_MS) == DEVICE_CLOSED ? DEVICE_CLOSED : result;
        result = result ? result : device_do(d, PALP_WIRE_TYPE_GET_STATUS, &got);
    }
    if (result)
        return machine_failure(d, result);
    return d->status.state == PALP_WIRE_STATE_IDLE
               ? CLI_OK
               : cli_failure(NAME, "the device does not come to rest: it is in %s",
                             palp_wire_state_name(d->status.state));
}

bool machine_agrees(const machine_options *o, const char *question) {
    char line[64];
    if (o->yes)
        return true;
    fprintf(stderr, "%s [y/N] ", question);
    return fgets(line, sizeof line, stdin) && (line[0] == 'y' || line[0] == 'Y');
}

double machine_today(void) {
    return floor((double)time(NULL) / DAY_S);
}
