/* plant_link.h: the lockstep records between the firmware on a simulated board (board/rig under QEMU,
 * board/host as a process) and the simulated plant (palpate rig). One record each way a control tick, over
 * two FIFOs opened in the same order on both sides: plant-to-firmware first. The bytes to and from the host's
 * program are in them too: the plant has the port. Little-endian, no padding. */
#ifndef PLANT_LINK_H
#define PLANT_LINK_H

#include <stdint.h>

enum {
    PLANT_LINK_VERSION = 4,
    PLANT_LINK_IN = 64,
    PLANT_LINK_OUT = 116,
    PLANT_LINK_RX = 36,
    PLANT_LINK_TX = 92
};

/* What the plant asks of the simulated board at this tick. */
enum {
    PLANT_EVENT_DEAF = 1,       /* drop what the host sends */
    PLANT_EVENT_STALL_TX = 2,   /* send nothing to the host */
    PLANT_EVENT_HANG = 4,       /* restart as if by the watchdog */
    PLANT_EVENT_SMASH = 8,      /* overwrite the stack's guard */
    PLANT_EVENT_LATE = 16,      /* miss the next tick */
    PLANT_EVENT_BROWN_OUT = 32, /* restart as if its supply had fallen */
    PLANT_EVENT_QUIT = 128      /* the plant is closing: exit */
};

enum {
    PLANT_SWITCH_HOME = 1,
    PLANT_SWITCH_EMERGENCY = 2,
    PLANT_ENCODER_LOST = 4, /* alarms of encoder and driver */
    PLANT_DRIVER_FAULT = 8,
    PLANT_TRIGGER = 16,    /* a pulse has come in */
    PLANT_FORCE_HELD = 32, /* the sensor has no new sample */
    PLANT_SENSOR_SILENT = 128
};

/* Which machine it is: machine_indenter, machine_stepper, machine_stepper_fast of machine.h. */
enum { PLANT_VOICE_COIL = 0, PLANT_STEPPER = 1, PLANT_STEPPER_FAST = 2 };

/* The motor: without current; driven; shorted, so that it brakes. */
enum { PLANT_MOTOR_OFF = 0, PLANT_MOTOR_ON = 1, PLANT_MOTOR_BRAKED = 2 };

/* Plant to firmware: what the board senses at the start of a tick. On the wire in this order, 64 bytes. */
typedef struct plant_in {
    uint32_t tick;
    int32_t position; /* encoder counts since power-on */
    int16_t adc[6];
    uint16_t thermistor; /* 12-bit counts of the divider */
    uint8_t switches;    /* PLANT_SWITCH_* and what follows them */
    uint8_t events;      /* PLANT_EVENT_* */
    uint8_t reset_cause; /* of the first record: APP_RESET_* in app.h */
    uint8_t rx_count;    /* bytes of the host in rx */
    uint8_t rx[PLANT_LINK_RX];
    uint8_t machine;
} plant_in;

/* Firmware to plant, 116 bytes. boot = 1 in the first record after a start or restart: it asks for the first
 * plant_in. cost: processor instructions of the last tick. stack_free: bytes of the stack never used so far
 * (0 = not known). After PLANT_EVENT_QUIT the remaining bytes for the host follow, up to a record without
 * any. */
typedef struct plant_out {
    uint32_t tick; /* tick of the plant_in before; 0 with boot */
    int16_t duty;  /* 32767 = full */
    uint8_t motor; /* PLANT_MOTOR_* */
    uint8_t boot;
    uint32_t cost;
    uint16_t version; /* PLANT_LINK_VERSION */
    uint16_t stack_free;
    uint8_t tx_count; /* bytes for the host in tx: at most those that 921600 baud carry in a tick */
    uint8_t tx[PLANT_LINK_TX];
    uint8_t trigger; /* 1: a pulse goes out */
    int32_t place;   /* steps for a stepper until the next tick, counts */
} plant_out;

/* Packed by hand, so that both sides agree whatever their compilers do. plant_link.c */
void plant_link_put_in(const plant_in *in, uint8_t byte[PLANT_LINK_IN]);
void plant_link_get_in(const uint8_t byte[PLANT_LINK_IN], plant_in *in);
void plant_link_put_out(const plant_out *out, uint8_t byte[PLANT_LINK_OUT]);
void plant_link_get_out(const uint8_t byte[PLANT_LINK_OUT], plant_out *out);

#endif
