/* device_peer.c: the other end of a link, for tests. */
#define _POSIX_C_SOURCE 200809L
#include "device_peer.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void send_bytes(int fd, const uint8_t *byte, size_t n) {
    while (n > 0) {
        ssize_t done = write(fd, byte, n);
        if (done < 0) {
            return; /* the host has gone */
        }
        byte += done;
        n -= (size_t)done;
    }
}

static bool once(unsigned *left) {
    bool is = *left > 0;
    *left -= is;
    return is;
}

void peer_send(peer *p, palp_wire_message *m) {
    uint8_t frame[PALP_WIRE_FRAME_MAX];
    m->sequence = p->sequence++;
    size_t n = palp_wire_encode(m, frame);
    if (once(&p->settings.damage)) {
        frame[n / 2] ^=
            frame[n / 2] == 0x10 ? 0x20 : 0x10; /* a zero would end the frame there: two bad ones */
    }
    send_bytes(p->fd, frame, n);
}

static void send_samples(peer *p) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SAMPLES};
    m.as.samples.tick = p->tick += p->settings.stream_ticks;
    m.as.samples.count = 1;
    peer_send(p, &m);
}

/* What is asked for; false where nothing is. */
static bool answer(peer *p, const palp_wire_message *m, palp_wire_message *made) {
    memset(made, 0, sizeof *made);
    switch (m->type) {
    case PALP_WIRE_TYPE_HELLO:
        made->type = PALP_WIRE_TYPE_INFO;
        made->as.info.protocol = p->settings.protocol;
        made->as.info.count_pm = 1000000;
        made->as.info.serial = 4711;
        memcpy(made->as.info.board, "peer", 4);
        return !p->settings.no_info;
    case PALP_WIRE_TYPE_GET_STATUS:
        made->type = PALP_WIRE_TYPE_STATUS;
        made->as.status = p->settings.status;
        made->as.status.tick = p->tick += p->settings.status_ticks;
        return true;
    case PALP_WIRE_TYPE_GET_GAINS:
        made->type = PALP_WIRE_TYPE_GAINS;
        made->as.gains = (palp_wire_gains){.softness = m->as.get_gains.softness,
                                           .kp_N_m = 100U * m->as.get_gains.softness};
        return true;
    case PALP_WIRE_TYPE_GET_CALIBRATION:
        made->type = PALP_WIRE_TYPE_CALIBRATION;
        made->as.calibration = (palp_wire_calibration){.axis = m->as.get_calibration.axis, .tare = {-24, 8}};
        return true;
    default:
        return false;
    }
}

static uint8_t result_of(const peer *p, const palp_wire_message *m) {
    if (m->type == PALP_WIRE_TYPE_HELLO && p->settings.protocol != PALP_WIRE_VERSION) {
        return PALP_WIRE_RESULT_VERSION;
    }
    if (m->type == PALP_WIRE_TYPE_GET_GAINS && p->settings.classes &&
        m->as.get_gains.softness >= p->settings.classes) {
        return PALP_WIRE_RESULT_RANGE;
    }
    return m->type == p->settings.refuse ? p->settings.result : PALP_WIRE_RESULT_DONE;
}

static void take_command(peer *p, const palp_wire_message *m) {
    palp_wire_message made, ack = {.type = PALP_WIRE_TYPE_ACK};
    bool again = p->n_seen > 0 && p->last.type == m->type && p->last.sequence == m->sequence;
    ack.as.ack = (palp_wire_ack){m->sequence, m->type, result_of(p, m)};
    p->last = *m;
    p->n_seen++;
    p->done[m->type] += !again && ack.as.ack.result == PALP_WIRE_RESULT_DONE;
    if (p->n_seen == p->settings.mistake) {
        ack.as.ack.command = PALP_WIRE_TYPE_STOP;
        p->done[m->type]--;
    } else if ((ack.as.ack.result == PALP_WIRE_RESULT_DONE || m->type == PALP_WIRE_TYPE_HELLO) &&
               answer(p, m, &made) && !once(&p->settings.lose_answers)) {
        peer_send(p, &made);
    }
    if (once(&p->settings.lose_acks)) {
        p->sequence++;
    } else {
        peer_send(p, &ack);
    }
}

/* False when the host has gone, or is to think that we have. */
static bool receive(peer *p) {
    palp_wire_message m;
    uint8_t byte[256];
    ssize_t n = read(p->fd, byte, sizeof byte);
    for (ssize_t i = 0; i < n; i++) {
        if (once(&p->settings.deaf) || p->settings.garbage || p->settings.chatter ||
            !palp_wire_decode(&p->decoder, byte[i], &m)) {
            continue;
        }
        if (p->settings.closes) {
            return false;
        }
        take_command(p, &m);
        if (p->settings.leaves_at_stop && m.type == PALP_WIRE_TYPE_STOP) {
            return false;
        }
    }
    return n > 0;
}

static void *live(void *context) {
    static const uint8_t noise[] = {1, 2, 3, 0};
    peer *p = context;
    struct pollfd wait[2] = {{.fd = p->fd, .events = POLLIN}, {.fd = p->stop[0], .events = POLLIN}};
    while (poll(wait, 2, p->settings.stream_ticks || p->settings.garbage ? 5 : 1000) >= 0 &&
           !wait[1].revents) {
        if (wait[0].revents && !receive(p)) {
            close(p->fd);
            p->fd = -1;
            break;
        }
        if (p->settings.garbage) {
            send_bytes(p->fd, noise, sizeof noise);
        } else if (p->settings.stream_ticks &&
                   (p->done[PALP_WIRE_TYPE_STREAM] || !p->settings.stream_on_demand)) {
            send_samples(p);
        }
    }
    return NULL;
}

void peer_start(peer *p, int fd, const peer_settings *settings) {
    *p = (peer){.settings = *settings, .fd = fd};
    if (p->settings.protocol == 0) {
        p->settings.protocol = PALP_WIRE_VERSION;
    }
    if (pipe(p->stop) != 0 || pthread_create(&p->thread, NULL, live, p) != 0) {
        abort();
    }
}

void peer_stop(peer *p) {
    if (write(p->stop[1], "", 1) != 1 || pthread_join(p->thread, NULL) != 0) {
        abort();
    }
    close(p->stop[0]);
    close(p->stop[1]);
}
