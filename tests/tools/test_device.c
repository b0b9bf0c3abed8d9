/* test_device.c: handshake, commands and the stream, against a peer that loses, damages, refuses and leaves.
 */
/* link: -pthread -Wl,--wrap=link_now_s,--wrap=link_read */
#define _POSIX_C_SOURCE 200809L
#include "indenter/device.h"
#include "device_peer.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- a clock that can run faster, so that waiting takes no time ---- */

static int speed = 1;

double __real_link_now_s(void);
double __wrap_link_now_s(void);
double __wrap_link_now_s(void) {
    return speed * __real_link_now_s();
}

link_result __real_link_read(link_t *l, void *to, size_t size, size_t *got, int timeout_ms);
link_result __wrap_link_read(link_t *l, void *to, size_t size, size_t *got, int timeout_ms);
link_result __wrap_link_read(link_t *l, void *to, size_t size, size_t *got, int timeout_ms) {
    return __real_link_read(l, to, size, got, (timeout_ms + speed - 1) / speed);
}

static int usual_speed(void **state) {
    (void)state;
    speed = 1;
    signal(SIGPIPE, SIG_IGN); /* for the peer; the device raises none */
    return 0;
}

/* ---- helpers ---- */

/* Starts a peer and opens a device to it. */
static device_result meet(peer *p, device *d, peer_settings settings) {
    int end[2];
    char where[20];
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, end), 0);
    snprintf(where, sizeof where, "fd:%d", end[0]);
    peer_start(p, end[1], &settings);
    return device_open(where, LINK_BAUD, d);
}

static void part(peer *p, device *d) {
    device_close(d);
    peer_stop(p);
    if (p->fd >= 0)
        close(p->fd);
}

static void says(const device *d, const char *text) {
    if (!strstr(d->why, text) || strchr(d->why, '\n'))
        fail_msg("\"%s\" does not say \"%s\"", d->why, text);
}

/* ---- handshake ---- */

static void test_handshake(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    assert_int_equal(d.info.serial, 4711);
    assert_string_equal((const char *)d.info.board, "peer");
    assert_int_equal(p.done[PALP_WIRE_TYPE_HELLO], 1);
    part(&p, &d);
}

/* The first bytes are not heard: one whole HELLO and half of the next. */
static void test_handshake_is_repeated(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){.deaf = 22}), DEVICE_OK);
    assert_int_equal(d.info.serial, 4711);
    part(&p, &d);
}

static void test_other_version(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){.protocol = 9}), DEVICE_OTHER_VERSION);
    says(&d, "the device speaks protocol 9, this palpate 3; bring both to the same release");
    assert_null(d.link);
    part(&p, &d);
    speed = 10;
    assert_int_equal(meet(&p, &d, (peer_settings){.protocol = 9, .no_info = true}), DEVICE_OTHER_VERSION);
    says(&d, "the device speaks another protocol, this palpate 3");
    part(&p, &d);
}

static void test_nobody_answers(void **state) {
    peer p;
    device d;
    (void)state;
    speed = 25;
    assert_int_equal(meet(&p, &d, (peer_settings){.deaf = 1000000}), DEVICE_TIMEOUT);
    says(&d, "no answer; is it an indenter");
    assert_null(d.link);
    part(&p, &d);
    assert_int_equal(meet(&p, &d, (peer_settings){.garbage = true}), DEVICE_TIMEOUT);
    says(&d, "what comes is not an indenter's");
    part(&p, &d);
    assert_int_equal(meet(&p, &d, (peer_settings){.chatter = true, .stream_ticks = 1}), DEVICE_TIMEOUT);
    says(&d, "sends, but does not answer; restart it");
    part(&p, &d);
}

static void test_no_link(void **state) {
    device d;
    (void)state;
    assert_int_equal(device_open("fd:999", LINK_BAUD, &d), DEVICE_CLOSED);
    says(&d, "fd:999 is not an open descriptor");
}

/* ---- commands ---- */

static void test_command(void **state) {
    peer p;
    device d;
    palp_wire_message got, gains = {.type = PALP_WIRE_TYPE_GET_GAINS, .as.get_gains = {.softness = 3}};
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){.status = {.state = PALP_WIRE_STATE_READY}}), DEVICE_OK);
    assert_int_equal(device_command(&d, &gains, &got), DEVICE_OK);
    assert_int_equal(got.type, PALP_WIRE_TYPE_GAINS);
    assert_int_equal(got.as.gains.kp_N_m, 300);
    assert_false(d.status_known);
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_GET_STATUS, &got), DEVICE_OK);
    assert_true(d.status_known && d.status.state == PALP_WIRE_STATE_READY);
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_HOME, NULL), DEVICE_OK);
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_HOME, NULL), DEVICE_OK);
    assert_int_equal(d.lost_frames, 0);
    part(&p, &d);
    assert_int_equal(p.done[PALP_WIRE_TYPE_HOME], 2); /* two numbers: not taken for a repetition */
}

/* The ACK gets lost: the same number again, and done once. */
static void test_lost_ack(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    speed = 2;
    p.settings.lose_acks = 3;
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_STOP, NULL), DEVICE_OK);
    part(&p, &d);
    assert_int_equal(p.done[PALP_WIRE_TYPE_STOP], 1);
    assert_true(p.n_seen >= 5);
}

/* The answer gets lost, the ACK does not: asked anew. */
static void test_lost_answer(void **state) {
    peer p;
    device d;
    palp_wire_message got = {0};
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    speed = 2;
    p.settings.lose_answers = 1;
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_GET_STATUS, &got), DEVICE_OK);
    assert_int_equal(got.type, PALP_WIRE_TYPE_STATUS);
    part(&p, &d);
    assert_true(p.done[PALP_WIRE_TYPE_GET_STATUS] >= 2);
}

static void test_damaged_answers(void **state) {
    peer p;
    device d;
    palp_wire_message got;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    speed = 2;
    p.settings.damage = 3;
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_GET_STATUS, &got), DEVICE_OK);
    assert_int_equal(d.decoder.bad, 3);
    assert_int_equal(d.lost_frames, 3);
    part(&p, &d);
}

static void test_refused(void **state) {
    peer p;
    device d;
    palp_wire_message got;
    (void)state;
    assert_int_equal(
        meet(&p, &d, (peer_settings){.refuse = PALP_WIRE_TYPE_START, .result = PALP_WIRE_RESULT_NOT_HOMED}),
        DEVICE_OK);
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_START, NULL), DEVICE_REFUSED);
    assert_int_equal(d.refusal, PALP_WIRE_RESULT_NOT_HOMED);
    says(&d, "the device refused START: not homed yet");
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_GET_STATUS, &got), DEVICE_OK);
    part(&p, &d);
    assert_true(p.done[PALP_WIRE_TYPE_START] == 0 && p.done[PALP_WIRE_TYPE_GET_STATUS] >= 1);
}

/* The device has done another command of that number before us: another number is tried. */
static void test_mistaken(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    p.settings.mistake = p.n_seen + 1;
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_HOME, NULL), DEVICE_OK);
    part(&p, &d);
    assert_int_equal(p.done[PALP_WIRE_TYPE_HOME], 1);
}

static void test_no_answer(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    speed = 25;
    p.settings.deaf = 1000000;
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_HOME, NULL), DEVICE_TIMEOUT);
    says(&d, "the device does not answer HOME");
    part(&p, &d);
}

static void test_closing(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){.closes = true}), DEVICE_CLOSED);
    says(&d, "the other end has closed");
    part(&p, &d);
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    p.settings.closes = true;
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_HOME, NULL), DEVICE_CLOSED);
    assert_int_equal(device_poll(&d, 10), DEVICE_CLOSED);
    part(&p, &d);
}

/* ---- the stream ---- */

typedef struct heard {
    unsigned n, lost;
    uint32_t tick[16];
} heard;

static void listen_to(const palp_wire_message *m, unsigned lost_frames, void *context) {
    heard *h = context;
    if (m->type == PALP_WIRE_TYPE_SAMPLES) {
        h->tick[h->n++ % 16] = m->as.samples.tick;
        h->lost += lost_frames;
    }
}

static void send_samples(peer *p, uint16_t sequence, uint32_t lost, uint32_t tick) {
    palp_wire_message m = {
        .type = PALP_WIRE_TYPE_SAMPLES, .lost = lost, .as.samples = {.tick = tick, .count = 10}};
    p->sequence = sequence;
    peer_send(p, &m);
}

static void poll_until(device *d, const heard *h, unsigned n) {
    while (h->n < n)
        assert_int_equal(device_poll(d, 1000), DEVICE_OK);
}

static void test_losses_are_counted(void **state) {
    peer p;
    device d;
    heard h = {0};
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    peer_stop(&p);
    d.listener = listen_to;
    d.context = &h;
    d.device_sequence = 65532;
    d.lost_frames = 0;
    send_samples(&p, 65533, 100, 1000); /* lost before we came: not ours */
    d.device_lost = 100;
    send_samples(&p, 65535, 100, 1020); /* one frame missing */
    send_samples(&p, 2, 107, 1060);     /* two more, about the wrap; and 7 samples that found no room */
    send_samples(&p, 3, 107, 1070);
    poll_until(&d, &h, 4);
    assert_int_equal(d.lost_frames, 3);
    assert_int_equal(h.lost, 3);
    assert_int_equal(d.lost_samples, 7);
    assert_int_equal(d.device_tick, 1079);
    send_samples(&p, 0, 0, 5); /* it has started anew: nothing is lost by that */
    send_samples(&p, 1, 4, 15);
    poll_until(&d, &h, 6);
    assert_int_equal(d.lost_frames, 3);
    assert_int_equal(d.lost_samples, 11);
    assert_int_equal(d.device_tick, 24);
    p.settings.damage = 1; /* a frame that is damaged is one that is lost */
    send_samples(&p, 2, 4, 25);
    send_samples(&p, 3, 4, 35);
    poll_until(&d, &h, 7);
    assert_int_equal(d.lost_frames, 4);
    assert_int_equal(d.decoder.bad, 1);
    device_close(&d);
    close(p.fd);
}

/* What comes in pieces, and several frames at once. */
static void test_pieces(void **state) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SAMPLES, .as.samples = {.count = 1}};
    uint8_t frame[PALP_WIRE_FRAME_MAX];
    peer p;
    device d;
    heard h = {0};
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    peer_stop(&p);
    d.listener = listen_to;
    d.context = &h;
    for (uint32_t i = 0; i < 5; i++) {
        m.as.samples.tick = i;
        m.sequence = (uint16_t)(p.sequence + i);
        size_t n = palp_wire_encode(&m, frame), half = i < 4 ? n / 2 : n;
        assert_int_equal(write(p.fd, frame, half), (ssize_t)half);
        if (i == 0)
            assert_int_equal(device_poll(&d, 1000), DEVICE_OK);
        assert_int_equal(write(p.fd, frame + half, n - half), (ssize_t)(n - half));
    }
    poll_until(&d, &h, 5);
    assert_int_equal(h.tick[4], 4);
    assert_int_equal(d.lost_frames, 0);
    assert_int_equal(device_poll(&d, 0), DEVICE_TIMEOUT);
    device_close(&d);
    close(p.fd);
}

/* A simulated device's clock may run faster: 1000 of its ticks with every frame. */
static void test_alive_by_the_devices_clock(void **state) {
    peer p;
    device d;
    heard h = {0};
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){.stream_ticks = 1000}), DEVICE_OK);
    d.listener = listen_to;
    d.context = &h;
    poll_until(&d, &h, 10);
    assert_int_equal(device_do(&d, PALP_WIRE_TYPE_STOP, NULL), DEVICE_OK);
    part(&p, &d);
    assert_true(p.done[PALP_WIRE_TYPE_ALIVE] >= 2); /* frames that came together need but one */
    assert_int_equal(d.lost_frames, 0);
}

static void test_alive_by_our_clock(void **state) {
    peer p;
    device d;
    (void)state;
    assert_int_equal(meet(&p, &d, (peer_settings){0}), DEVICE_OK);
    speed = 25;
    while (p.done[PALP_WIRE_TYPE_ALIVE] < 3) /* each with a number of its own; their ACKs arrive in between */
        assert_int_not_equal(device_poll(&d, 500), DEVICE_CLOSED);
    part(&p, &d);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_handshake, usual_speed),
    cmocka_unit_test_setup(test_handshake_is_repeated, usual_speed),
    cmocka_unit_test_setup(test_other_version, usual_speed),
    cmocka_unit_test_setup(test_nobody_answers, usual_speed),
    cmocka_unit_test_setup(test_no_link, usual_speed),
    cmocka_unit_test_setup(test_command, usual_speed),
    cmocka_unit_test_setup(test_lost_ack, usual_speed),
    cmocka_unit_test_setup(test_lost_answer, usual_speed),
    cmocka_unit_test_setup(test_damaged_answers, usual_speed),
    cmocka_unit_test_setup(test_refused, usual_speed),
    cmocka_unit_test_setup(test_mistaken, usual_speed),
    cmocka_unit_test_setup(test_no_answer, usual_speed),
    cmocka_unit_test_setup(test_closing, usual_speed),
    cmocka_unit_test_setup(test_losses_are_counted, usual_speed),
    cmocka_unit_test_setup(test_pieces, usual_speed),
    cmocka_unit_test_setup(test_alive_by_the_devices_clock, usual_speed),
    cmocka_unit_test_setup(test_alive_by_our_clock, usual_speed),
    {0},
};
