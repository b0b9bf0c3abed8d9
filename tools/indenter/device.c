/* device.c: the handshake, commands repeated until they are answered, and the frames that arrive meanwhile.
 */
#define _POSIX_C_SOURCE 200809L
#include "device.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
    TRY_MS = 250,
    HELLO_TRIES = 24, /* 6 s: a PTY may be noticed only after a second */
    TRIES = 12,
    WRITE_MS = 1000,
    ALIVE_MS = 500, /* by our clock and by the device's; a simulated device may run faster than ours */
    READ_SIZE = 4096,
    STATUS_WAIT_MS = 50,
    NAP_MS = 1
};

/* A command that waits for its answer. */
typedef struct pending {
    const palp_wire_message *command;
    palp_wire_message *answer; /* NULL: an ACK is enough */
    bool acked, answered, mistaken;
    uint8_t result;
} pending;

static unsigned count_losses(device *d, const palp_wire_message *m) {
    unsigned gap = (uint16_t)(m->sequence - d->device_sequence - 1);
    if (!d->heard || gap >= 0x8000) { /* this is the first frame, or the device has restarted */
        gap = 0;
    }
    if (d->heard && m->lost > d->device_lost)
        d->lost_samples += m->lost - d->device_lost;
    d->lost_frames += gap;
    d->heard = true;
    d->device_sequence = m->sequence;
    d->device_lost = m->lost;
    return gap;
}

static void keep_newest(device *d, const palp_wire_message *m) {
    if (m->type == PALP_WIRE_TYPE_SAMPLES && m->as.samples.count > 0) {
        d->device_tick = m->as.samples.tick + m->as.samples.count - 1;
    } else if (m->type == PALP_WIRE_TYPE_STATUS) {
        d->status = m->as.status;
        d->status_known = true;
        d->device_tick = m->as.status.tick;
    } else if (m->type == PALP_WIRE_TYPE_INFO) {
        d->info = m->as.info;
    }
}

static bool answers(const palp_wire_message *command, const palp_wire_message *m) {
    switch (command->type) {
    case PALP_WIRE_TYPE_HELLO:
        return m->type == PALP_WIRE_TYPE_INFO;
    case PALP_WIRE_TYPE_GET_STATUS:
        return m->type == PALP_WIRE_TYPE_STATUS;
    case PALP_WIRE_TYPE_GET_LIMITS:
        return m->type == PALP_WIRE_TYPE_LIMITS_NOW;
    case PALP_WIRE_TYPE_GET_CALIBRATION:
        return m->type == PALP_WIRE_TYPE_CALIBRATION &&
               m->as.calibration.axis == command->as.get_calibration.axis;
    case PALP_WIRE_TYPE_GET_PARAMETER:
        return m->type == PALP_WIRE_TYPE_PARAMETER && m->as.parameter.id == command->as.get_parameter.id;
    case PALP_WIRE_TYPE_GET_CONFIGURATION:
        return m->type == PALP_WIRE_TYPE_CONFIGURATION;
    case PALP_WIRE_TYPE_GET_GAINS:
        return m->type == PALP_WIRE_TYPE_GAINS && m->as.gains.softness == command->as.get_gains.softness;
    default:
        return false;
    }
}

static void match(pending *p, const palp_wire_message *m) {
    if (m->type == PALP_WIRE_TYPE_ACK && m->as.ack.sequence == p->command->sequence) {
        p->acked = m->as.ack.command == p->command->type;
        p->mistaken = !p->acked;
        p->result = m->as.ack.result;
    } else if (p->answer && answers(p->command, m)) {
        *p->answer = *m;
        p->answered = true;
    }
}

static void take(device *d, const palp_wire_message *m, pending *p) {
    unsigned lost = count_losses(d, m);
    keep_newest(d, m);
    if (p)
        match(p, m);
    if (d->listener)
        d->listener(m, lost, d->context);
}

static device_result from_link(device *d, link_result result) {
    if (result == LINK_OK)
        return DEVICE_OK;
    if (d->link)
        snprintf(d->why, sizeof d->why, "%s", link_error(d->link));
    return result == LINK_TIMEOUT ? DEVICE_TIMEOUT : DEVICE_CLOSED;
}

/* A processor under QEMU sends byte by byte. A reader that wakes for each byte would take most of the
 * computer's time. */
static void nap(void) {
    const struct timespec t = {.tv_nsec = 1000000L * NAP_MS};
    nanosleep(&t, NULL);
}

/* Reads once; waits at most timeout_s for the first byte. */
static device_result pump(device *d, double timeout_s, pending *p) {
    uint8_t byte[READ_SIZE];
    palp_wire_message m;
    size_t n = 0;
    int timeout_ms = timeout_s > 0 ? (int)ceil(1e3 * timeout_s) : 0;
    if (timeout_ms > NAP_MS && d->info.simulated)
        nap();
    device_result result =
        from_link(d, d->link ? link_read(d->link, byte, sizeof byte, &n, timeout_ms) : LINK_CLOSED);
    for (size_t i = 0; i < n; i++)
        if (palp_wire_decode(&d->decoder, byte[i], &m) && m.type >= PALP_WIRE_TYPE_ACK)
            take(d, &m, p);
    return result;
}

/* Writes one frame; the caller holds the lock. A zero goes first: it ends whatever noise on the line looked
 * like the beginning of a frame. */
static link_result write_frame(device *d, const palp_wire_message *m) {
    uint8_t frame[1 + PALP_WIRE_FRAME_MAX] = {0};
    size_t n = palp_wire_encode(m, frame + 1);
    return d->link ? link_write(d->link, frame, n + 1, WRITE_MS) : LINK_CLOSED;
}

static device_result send_frame(device *d, const palp_wire_message *m) {
    d->alive_s = link_now_s();
    d->alive_tick = d->device_tick;
    pthread_mutex_lock(&d->writing);
    link_result result = write_frame(d, m);
    pthread_mutex_unlock(&d->writing);
    return from_link(d, result);
}

device_result device_halt(device *d) {
    pthread_mutex_lock(&d->writing);
    palp_wire_message m = {.type = PALP_WIRE_TYPE_HALT, .sequence = d->halts++};
    link_result result = write_frame(d, &m);
    pthread_mutex_unlock(&d->writing);
    return result == LINK_OK ? DEVICE_OK : result == LINK_TIMEOUT ? DEVICE_TIMEOUT : DEVICE_CLOSED;
}

/* An ACK alone does not say which other version the device has; INFO does, so it is waited for. */
static bool done(const pending *p) {
    bool is_final = p->result != PALP_WIRE_RESULT_DONE && p->result != PALP_WIRE_RESULT_VERSION;
    return p->acked && (p->answered || !p->answer || is_final);
}

/* Sends it once and listens for TRY_MS. */
static device_result try_once(device *d, pending *p) {
    device_result result = send_frame(d, p->command);
    double until_s = link_now_s() + 1e-3 * TRY_MS;
    while (result != DEVICE_CLOSED && !done(p) && !p->mistaken) {
        double left_s = until_s - link_now_s();
        if (left_s <= 0)
            return DEVICE_TIMEOUT;
        result = pump(d, left_s, p);
    }
    return result == DEVICE_CLOSED ? result : DEVICE_OK;
}

static device_result refused(device *d, const pending *p) {
    d->refusal = p->result;
    snprintf(d->why, sizeof d->why, "the device refused %s: %s", palp_wire_type_name(p->command->type),
             palp_wire_result_text(p->result));
    return p->result == PALP_WIRE_RESULT_VERSION ? DEVICE_OTHER_VERSION : DEVICE_REFUSED;
}

static device_result command_within(device *d, palp_wire_message *command, palp_wire_message *answer,
                                    int tries) {
    pending p = {.command = command, .answer = answer};
    command->lost = 0;
    command->sequence = d->sequence++;
    for (int i = 0; i < tries; i++) {
        device_result result = try_once(d, &p);
        if (result == DEVICE_CLOSED)
            return result;
        if (p.acked && (p.result != PALP_WIRE_RESULT_DONE || !answer || p.answered))
            return p.result == PALP_WIRE_RESULT_DONE ? DEVICE_OK : refused(d, &p);
        if (p.acked || p.mistaken) { /* its answer was lost, or the device has seen this number before */
            command->sequence = d->sequence++;
            p.acked = p.mistaken = false;
        }
    }
    snprintf(d->why, sizeof d->why, "the device does not answer %s", palp_wire_type_name(command->type));
    return DEVICE_TIMEOUT;
}

device_result device_command(device *d, palp_wire_message *command, palp_wire_message *answer) {
    return command_within(d, command, answer, TRIES);
}

device_result device_do(device *d, palp_wire_type type, palp_wire_message *answer) {
    palp_wire_message command = {.type = (uint8_t)type};
    return device_command(d, &command, answer);
}

/* Seconds until the next ALIVE is due; 0 or less: now. */
static double until_alive(const device *d) {
    double left_s = d->alive_s + 1e-3 * ALIVE_MS - link_now_s();
    return d->device_tick - d->alive_tick >= ALIVE_MS ? 0 : left_s;
}

static device_result keep_alive(device *d) {
    palp_wire_message alive = {.type = PALP_WIRE_TYPE_ALIVE};
    if (until_alive(d) > 0)
        return DEVICE_OK;
    alive.sequence = d->sequence++;
    return send_frame(d, &alive);
}

device_result device_poll(device *d, int timeout_ms) {
    double until_s = link_now_s() + 1e-3 * timeout_ms;
    device_result result;
    do {
        result = keep_alive(d);
        if (result != DEVICE_CLOSED)
            result = pump(d, fmin(until_s - link_now_s(), until_alive(d)), NULL);
    } while (result == DEVICE_TIMEOUT && link_now_s() < until_s);
    return result;
}

device_result device_status(device *d) {
    palp_wire_message got;
    device_result result = device_poll(d, STATUS_WAIT_MS);
    return result == DEVICE_CLOSED ? result : device_do(d, PALP_WIRE_TYPE_GET_STATUS, &got);
}

static void say_no_answer(device *d, const char *where) {
    if (d->heard)
        snprintf(d->why, sizeof d->why, "%s: the device sends, but does not answer; restart it", where);
    else if (d->decoder.bad > 0)
        snprintf(d->why, sizeof d->why,
                 "%s: what comes is not an indenter's (%u damaged frames); are port and baud rate right?",
                 where, (unsigned)d->decoder.bad);
    else
        snprintf(d->why, sizeof d->why,
                 "%s: no answer; is it an indenter with palpate's firmware, and is it switched on?", where);
}

static void say_other_version(device *d, const char *where, const palp_wire_message *info) {
    char protocol[20] = "another protocol";
    if (info->type)
        snprintf(protocol, sizeof protocol, "protocol %u", (unsigned)info->as.info.protocol);
    snprintf(d->why, sizeof d->why,
             "%s: the device speaks %s, this palpate %d; bring both to the same release", where, protocol,
             PALP_WIRE_VERSION);
}

/* Sends HELLO until INFO comes. */
static device_result shake_hands(const char *where, device *d) {
    palp_wire_message hello = {.type = PALP_WIRE_TYPE_HELLO, .as.hello = {.protocol = PALP_WIRE_VERSION}},
                      info = {0};
    device_result result = command_within(d, &hello, &info, HELLO_TRIES);
    bool other = info.type && info.as.info.protocol != PALP_WIRE_VERSION;
    if (result == DEVICE_TIMEOUT) {
        say_no_answer(d, where);
    } else if (result == DEVICE_OTHER_VERSION || (result == DEVICE_OK && other)) {
        say_other_version(d, where, &info);
        result = DEVICE_OTHER_VERSION;
    }
    return result;
}

static device_result open_link(const char *where, int baud, device *d, link_t **made) {
    char why[LINK_TEXT];
    if (link_open(where, baud, made, why) == LINK_OK)
        return DEVICE_OK;
    snprintf(d->why, sizeof d->why, "%s", why);
    return DEVICE_CLOSED;
}

device_result device_open(const char *where, int baud, device *d) {
    *d = (device){.sequence = (uint16_t)(time(NULL) ^ getpid())}; /* differs from that of the last session */
    device_result result = open_link(where, baud, d, &d->link);
    if (result)
        return result;
    pthread_mutex_init(&d->writing, NULL);
    result = shake_hands(where, d);
    if (result != DEVICE_OK)
        device_close(d);
    return result;
}

/* The old link is closed first: it may still hold the port. */
static void change_link(device *d, link_t *next) {
    pthread_mutex_lock(&d->writing);
    link_close(d->link);
    d->link = next;
    pthread_mutex_unlock(&d->writing);
}

device_result device_reopen(const char *where, int baud, device *d) {
    link_t *next;
    change_link(d, NULL);
    device_result result = open_link(where, baud, d, &next);
    if (result)
        return result;
    change_link(d, next);
    d->decoder = (palp_wire_decoder){.n = 0};
    d->heard = false;
    result = shake_hands(where, d);
    if (result)
        change_link(d, NULL);
    return result;
}

void device_close(device *d) {
    link_close(d->link);
    pthread_mutex_destroy(&d->writing);
    d->link = NULL;
}
