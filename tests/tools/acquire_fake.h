/* acquire_fake.h: a scripted indenter: a thread at the other end of a socket pair. */
#ifndef ACQUIRE_FAKE_H
#define ACQUIRE_FAKE_H

#include <palpate/wire.h>
#include <pthread.h>

/* Ticks count from the first recorded one; 0 = never. */
typedef struct fake_settings {
    uint16_t protocol; /* that it says it speaks; 0 = ours */
    uint8_t latched;   /* a fault from the start */
    bool no_contact, restarts_silent;
    uint8_t fault; /* at fault_tick of run fault_run (from 1) */
    uint32_t fault_run, fault_tick;
    uint32_t unplug_tick, restart_tick; /* restart: as if by the watchdog */
    uint32_t lose_tick, lose_ticks;     /* the frame with this tick is lost, or so many from there, */
    uint32_t bad_tick;                  /* and this tick has no reading */
    uint32_t signal_tick;               /* raises SIGINT in this process */
    double contact_mm;                  /* later runs find the specimen so much lower */
} fake_settings;

typedef struct fake {
    fake_settings settings;
    int fd, host_fd;
    char port[16]; /* for link_open */
    pthread_t thread;
    /* what it was told */
    uint32_t starts, stops, homings;
    palp_wire_limits limits;
    palp_wire_start start;
    /* inside */
    palp_wire_decoder decoder;
    palp_wire_status status;
    palp_wire_segment segment[PALP_WIRE_SEGMENTS];
    int32_t row[PALP_WIRE_CHANNELS];
    uint16_t sequence, last_command;
    bool on, streaming, command_seen;
    uint8_t phase;
    uint32_t phase_tick, recorded, n_segments;
    double at_mm, from_mm; /* depth; where the segment began */
    palp_wire_message block;
} fake;

void fake_start(fake *f, const fake_settings *settings);
void fake_join(fake *f);

#endif
