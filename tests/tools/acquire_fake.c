/* acquire_fake.c: a scripted indenter: a thread at the other end of a socket pair. */
#define _POSIX_C_SOURCE 200809L
#include "acquire_fake.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { CONTACT = 12000 /* counts of 1 um below home */, MOVING_TICKS = 40 };
enum { PHASE_NONE, PHASE_GO, PHASE_AIR, PHASE_FOLLOW, PHASE_BACK, PHASE_AFTER };

static const double STIFFNESS_N_MM = 0.477, COUNT_N = 1.0 / 1280, TARE = 100;

/* ---- sending ---- */

static void send_message(fake *f, palp_wire_message *m) {
    uint8_t frame[PALP_WIRE_FRAME_MAX];
    m->sequence = f->sequence++;
    size_t n = palp_wire_encode(m, frame), done = 0;
    while (done < n) {
        ssize_t sent = send(f->fd, frame + done, n - done, MSG_NOSIGNAL);
        if (sent <= 0) {
            f->on = false;
            return;
        }
        done += (size_t)sent;
    }
}

static void send_status(fake *f) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STATUS};
    m.as.status = f->status;
    send_message(f, &m);
}

static void send_block(fake *f) {
    palp_wire_samples *b = &f->block.as.samples;
    bool lost = f->settings.lose_tick && f->recorded > f->settings.lose_tick &&
                f->recorded <= f->settings.lose_tick +
                                   (f->settings.lose_ticks ? f->settings.lose_ticks : PALP_WIRE_SAMPLES);
    if (b->count > 0 && f->streaming) {
        if (lost) {
            f->sequence++;
        } else {
            f->block.type = PALP_WIRE_TYPE_SAMPLES;
            send_message(f, &f->block);
        }
    }
    memset(&f->block, 0, sizeof f->block);
}

/* ---- commands ---- */

static void to_state(fake *f, uint8_t state) {
    send_block(f);
    f->status.state = state;
    f->phase = PHASE_NONE;
    f->phase_tick = 0;
}

static void answer(fake *f, uint8_t type, uint8_t axis) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_INFO};
    if (type == PALP_WIRE_TYPE_HELLO) {
        m.as.info =
            (palp_wire_info){.protocol = f->settings.protocol ? f->settings.protocol : PALP_WIRE_VERSION,
                             .minor = 1,
                             .tick_Hz = 1000,
                             .count_pm = 1000000,
                             .travel_nm = 30000000,
                             .force_uN = 24000000,
                             .board = "fake",
                             .serial = 7};
    } else if (type == PALP_WIRE_TYPE_GET_LIMITS) {
        m.type = PALP_WIRE_TYPE_LIMITS_NOW;
        m.as.limits_now = (palp_wire_limits_now){f->limits.force_uN, 30000000, 1000000, 11000, 5000, 1000};
    } else if (type == PALP_WIRE_TYPE_GET_CONFIGURATION) {
        m.type = PALP_WIRE_TYPE_CONFIGURATION; /* with no parameters */
    } else {
        m.type = PALP_WIRE_TYPE_CALIBRATION;
        m.as.calibration.axis = axis;
        memcpy(m.as.calibration.row, f->row, sizeof f->row);
        m.as.calibration.tare[2] = (int32_t)(16 * TARE);
    }
    send_message(f, &m);
}

static uint8_t obey(fake *f, const palp_wire_message *m) {
    bool ready = f->status.state == PALP_WIRE_STATE_READY;
    switch (m->type) {
    case PALP_WIRE_TYPE_HELLO:
        return f->settings.protocol ? PALP_WIRE_RESULT_VERSION : PALP_WIRE_RESULT_DONE;
    case PALP_WIRE_TYPE_STREAM:
        f->streaming = m->as.stream.on;
        break;
    case PALP_WIRE_TYPE_LIMITS:
        f->limits = m->as.limits;
        break;
    case PALP_WIRE_TYPE_SET_CALIBRATION:
        memcpy(f->row, m->as.set_calibration.row, sizeof f->row);
        break;
    case PALP_WIRE_TYPE_SEGMENT:
        f->segment[m->as.segment.index % PALP_WIRE_SEGMENTS] = m->as.segment;
        return m->as.segment.rate_nm_s > 250000000 ? PALP_WIRE_RESULT_RANGE : PALP_WIRE_RESULT_DONE;
    case PALP_WIRE_TYPE_HOME:
        f->homings++;
        to_state(f, PALP_WIRE_STATE_HOMING);
        break;
    case PALP_WIRE_TYPE_FIND_CONTACT:
        to_state(f, PALP_WIRE_STATE_APPROACH);
        break;
    case PALP_WIRE_TYPE_START:
        if (!ready) {
            return PALP_WIRE_RESULT_STATE;
        }
        f->start = m->as.start;
        f->starts++;
        to_state(f, PALP_WIRE_STATE_RUN);
        f->phase = PHASE_GO;
        f->recorded = 0;
        break;
    case PALP_WIRE_TYPE_STOP:
        f->stops++;
        to_state(f, PALP_WIRE_STATE_RETRACT);
        break;
    default:
        break;
    }
    return PALP_WIRE_RESULT_DONE;
}

static void take_command(fake *f, const palp_wire_message *m) {
    palp_wire_message ack = {.type = PALP_WIRE_TYPE_ACK};
    bool again = f->command_seen && m->sequence == f->last_command;
    f->command_seen = true;
    f->last_command = m->sequence;
    ack.as.ack = (palp_wire_ack){.sequence = m->sequence, .command = m->type};
    ack.as.ack.result = again ? PALP_WIRE_RESULT_DONE : obey(f, m);
    send_message(f, &ack);
    if (m->type == PALP_WIRE_TYPE_HELLO || m->type == PALP_WIRE_TYPE_GET_CALIBRATION ||
        m->type == PALP_WIRE_TYPE_GET_LIMITS || m->type == PALP_WIRE_TYPE_GET_CONFIGURATION) {
        answer(f, m->type, m->as.get_calibration.axis);
    } else if (m->type == PALP_WIRE_TYPE_GET_STATUS) {
        send_block(f);
        send_status(f);
    }
}

static void receive(fake *f) {
    uint8_t byte[512];
    palp_wire_message m;
    ssize_t n = recv(f->fd, byte, sizeof byte, MSG_DONTWAIT);
    f->on = f->on && n != 0;
    for (ssize_t i = 0; i < n; i++) {
        if (palp_wire_decode(&f->decoder, byte[i], &m)) {
            take_command(f, &m);
        }
    }
}

/* ---- a tick ---- */

static void next_phase(fake *f, uint8_t phase) {
    f->phase = phase;
    f->phase_tick = 0;
    f->from_mm = f->at_mm;
}

/* Moves towards a depth; true when it is there. */
static bool move(fake *f, double to_mm, double rate_mm_s) {
    double way = to_mm - f->at_mm, step = 1e-3 * rate_mm_s;
    f->at_mm += fabs(way) < step ? way : copysign(step, way);
    return fabs(way) <= step;
}

static void follow(fake *f) {
    const palp_wire_segment *s = &f->segment[f->n_segments];
    double target = 1e-6 * s->target_nm, rate = 1e-6 * s->rate_nm_s;
    bool over = s->kind == PALP_WIRE_SEGMENT_MOVE ? move(f, target, rate) : f->phase_tick >= s->duration_ms;
    if (over) {
        f->n_segments++;
        next_phase(f, f->n_segments < f->start.segments ? PHASE_FOLLOW : PHASE_BACK);
    }
}

static void run_tick(fake *f) {
    double start_mm = 1e-6 * f->start.start_nm;
    switch (f->phase) {
    case PHASE_GO:
        f->at_mm = start_mm;
        f->n_segments = 0;
        if (f->phase_tick == MOVING_TICKS) {
            next_phase(f, PHASE_AIR);
        }
        break;
    case PHASE_AIR:
        if (f->phase_tick >= f->start.air_ms) {
            next_phase(f, PHASE_FOLLOW);
        }
        break;
    case PHASE_FOLLOW:
        follow(f);
        break;
    case PHASE_BACK:
        if (move(f, start_mm, 5)) {
            next_phase(f, PHASE_AFTER);
        }
        break;
    default:
        if (f->phase_tick >= f->start.after_ms) {
            to_state(f, PALP_WIRE_STATE_READY);
        }
        break;
    }
}

static void move_tick(fake *f) {
    if (f->status.state == PALP_WIRE_STATE_RUN) {
        run_tick(f);
    } else if (f->phase_tick == MOVING_TICKS) {
        bool approached = f->status.state == PALP_WIRE_STATE_APPROACH;
        f->status.homed = 1;
        f->status.contact_known = approached && !f->settings.no_contact ? 1 : f->status.contact_known;
        f->status.contact = CONTACT;
        f->status.stiffness_mN_m = 477000;
        f->status.softness = 2;
        if (f->status.state != PALP_WIRE_STATE_READY && f->status.state != PALP_WIRE_STATE_IDLE &&
            f->status.state != PALP_WIRE_STATE_FAULT) {
            to_state(f, PALP_WIRE_STATE_READY);
        }
    }
}

static void sample_tick(fake *f, bool record) {
    palp_wire_samples *b = &f->block.as.samples;
    size_t i = b->count++;
    double contact_mm = f->starts > 1 ? f->settings.contact_mm : 0;
    double force_N = STIFFNESS_N_MM * fmax(f->at_mm - contact_mm, 0);
    b->tick = i ? b->tick : f->status.tick;
    b->state = f->status.state;
    b->case_cC = 2500;
    b->position[i] = CONTACT + (int32_t)lrint(1e3 * f->at_mm);
    b->error[i] = record ? 2 : 0;
    b->adc[i * PALP_WIRE_CHANNELS + 2] = (int16_t)lrint(force_N / COUNT_N + TARE);
    b->flags[i] = record ? PALP_WIRE_FLAG_RECORD : 0;
    b->flags[i] |= f->phase == PHASE_FOLLOW ? PALP_WIRE_FLAG_TRAJECTORY : 0;
    b->flags[i] |=
        record && f->settings.bad_tick && f->settings.bad_tick == f->recorded ? PALP_WIRE_FLAG_SENSOR_BAD : 0;
}

static void restart(fake *f) {
    f->block.as.samples.count = 0;
    f->streaming = f->command_seen = false;
    f->status = (palp_wire_status){.state = PALP_WIRE_STATE_FAULT, .fault = PALP_WIRE_FAULT_WATCHDOG_RESET};
    f->phase = PHASE_NONE;
}

static void fault(fake *f, uint8_t reason) {
    f->status.fault = reason;
    f->status.fault_tick = f->status.tick;
    to_state(f, PALP_WIRE_STATE_FAULT);
}

/* What was asked for in the settings at this recorded tick. */
static void mishaps(fake *f) {
    const fake_settings *s = &f->settings;
    if (s->fault_tick == f->recorded && s->fault_run == f->starts && s->fault) {
        fault(f, s->fault);
    }
    if (s->restart_tick && s->restart_tick == f->recorded) {
        restart(f);
    }
    if (s->signal_tick && s->signal_tick == f->recorded) {
        kill(getpid(), SIGINT);
    }
    if (s->unplug_tick && s->unplug_tick == f->recorded) {
        send_block(f);
        f->on = false;
    }
}

static void tick(fake *f) {
    bool record = f->status.state == PALP_WIRE_STATE_RUN && f->phase >= PHASE_AIR;
    f->status.tick++;
    f->phase_tick++;
    sample_tick(f, record);
    f->recorded += record;
    if (f->block.as.samples.count == PALP_WIRE_SAMPLES) {
        send_block(f);
    }
    if (record) {
        mishaps(f);
    }
    move_tick(f);
}

static void *live(void *context) {
    fake *f = context;
    while (f->on) {
        /* as fast as the host takes it while it streams, else slowly */
        struct pollfd one = {.fd = f->fd, .events = POLLIN};
        poll(&one, 1, f->streaming ? 0 : 1);
        receive(f);
        for (int i = 0; i < PALP_WIRE_SAMPLES && f->on; i++) {
            tick(f);
        }
    }
    close(f->fd);
    return NULL;
}

void fake_start(fake *f, const fake_settings *settings) {
    int pair[2];
    *f = (fake){.settings = *settings, .on = true, .row = {0, 0, 781250}};
    f->status.state = settings->latched ? PALP_WIRE_STATE_FAULT : PALP_WIRE_STATE_IDLE;
    f->status.fault = settings->latched;
    f->status.case_cC = 2500;
    f->status.winding_cC = 2600;
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0) {
        abort();
    }
    f->fd = pair[0];
    f->host_fd = pair[1];
    snprintf(f->port, sizeof f->port, "fd:%d", pair[1]);
    if (pthread_create(&f->thread, NULL, live, f) != 0) {
        abort();
    }
}

/* The host's end is closed by link_close. */
void fake_join(fake *f) {
    pthread_join(f->thread, NULL);
}
