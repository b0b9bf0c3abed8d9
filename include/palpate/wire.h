/* wire.h: the messages between an indenter and its host: framing, check, and the one list of messages.
 * Freestanding: the firmware compiles lib/wire/wire.c as it is. doc/protocol.md has every byte. Stable. */
#ifndef PALPATE_WIRE_H
#define PALPATE_WIRE_H

#include <palpate/export.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The protocol's version, apart from the firmware's: raised when a message or its meaning changes. */
enum { PALP_WIRE_VERSION = 3 };

enum {
    PALP_WIRE_CHANNELS = 6,       /* force sensor */
    PALP_WIRE_SAMPLES = 10,       /* control ticks in a SAMPLES frame */
    PALP_WIRE_SEGMENTS = 32,      /* most segments of a trajectory */
    PALP_WIRE_NAME = 16,          /* bytes of a name, zero-padded */
    PALP_WIRE_PARAMETER_NAME = 24 /* the same, of a parameter's */
};

/* Lists of macros, which clang-format would tear apart. */
/* clang-format off */

/* What the supervisor is doing. X(NAME, name in files): the number on the wire is the place in the list. */
#define PALP_WIRE_STATES(X)                                                                     \
    X(BOOT, boot) X(IDLE, idle) X(HOMING, homing) X(READY, ready) X(APPROACH, approach) X(RUN, run) \
    X(RETRACT, retract) X(FAULT, fault) X(JOG, jog)

/* Why it stopped. X(NAME, name in files, what it means). NONE is 0. */
#define PALP_WIRE_FAULTS(X)                                                                        \
    X(NONE, none, "no fault")                                                                      \
    X(OVER_FORCE, over_force, "the force passed its limit")                                        \
    X(OVER_TRAVEL, over_travel, "the plate left its travel")                                       \
    X(OVER_TEMPERATURE, over_temperature, "the motor is too hot")                                  \
    X(FOLLOWING_ERROR, following_error, "the plate does not follow its reference")                 \
    X(SENSOR_SILENT, sensor_silent, "the force sensor does not answer")                            \
    X(SENSOR_SATURATED, sensor_saturated, "a channel of the force sensor is at its rail")          \
    X(ENCODER_JUMP, encoder_jump, "the position jumped by more than the plate can move in a tick") \
    X(HOST_TIMEOUT, host_timeout, "nothing was heard from the host")                               \
    X(STREAM_OVERFLOW, stream_overflow, "the host does not take the samples")                      \
    X(COMMAND_OUT_OF_RANGE, command_out_of_range, "the reference leaves the travel or its segment's depth") \
    X(WATCHDOG_RESET, watchdog_reset, "the firmware hung and the watchdog restarted it")           \
    X(STACK_GUARD, stack_guard, "the stack overran its guard")                                     \
    X(EMERGENCY_STOP, emergency_stop, "the emergency stop was pressed")                            \
    X(ENCODER_LOST, encoder_lost, "the encoder has lost its signal")                               \
    X(DRIVER_FAULT, driver_fault, "the motor's driver has switched itself off")                    \
    X(BROWN_OUT, brown_out, "the processor's supply fell too low")                                 \
    X(CONTACT_LOST, contact_lost, "the force stays far below what is wanted: contact is lost")     \
    X(FORCE_OSCILLATES, force_oscillates, "the force swings about what is wanted")

/* The answer to a command. */
#define PALP_WIRE_RESULTS(X)                                                     \
    X(DONE, "accepted")                                                          \
    X(UNKNOWN, "the device does not know this command")                          \
    X(VERSION, "another version of the protocol")                                \
    X(STATE, "not in this state")                                                \
    X(RANGE, "a value is out of range")                                          \
    X(FAULTED, "a fault is latched; clear it first")                             \
    X(NOT_HOMED, "not homed yet")                                                \
    X(NO_CONTACT, "contact has not been found yet")                              \
    X(PERSISTS, "the fault's cause is still there")                              \
    X(FULL, "no room left in its flash: restart the device")                     \
    X(UNSTABLE, "the specimen is too stiff or too soft for force control")

/* clang-format on */

typedef enum palp_wire_state {
#define PALP_WIRE_MEMBER(name, id) PALP_WIRE_STATE_##name,
    PALP_WIRE_STATES(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
        PALP_WIRE_STATE_COUNT
} palp_wire_state;

typedef enum palp_wire_fault {
#define PALP_WIRE_MEMBER(name, id, text) PALP_WIRE_FAULT_##name,
    PALP_WIRE_FAULTS(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
        PALP_WIRE_FAULT_COUNT
} palp_wire_fault;

typedef enum palp_wire_result {
#define PALP_WIRE_MEMBER(name, text) PALP_WIRE_RESULT_##name,
    PALP_WIRE_RESULTS(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
        PALP_WIRE_RESULT_COUNT
} palp_wire_result;

/* How the last search for contact ended. NO_AIR: it met the specimen before it had seen enough air. NO_SLOPE:
 * a force was met, but noise hides whether it rises with depth. */
#define PALP_WIRE_SEARCHES(X) X(NONE) X(FOUND) X(NOTHING) X(NO_AIR) X(NO_SLOPE)
typedef enum palp_wire_search {
#define PALP_WIRE_MEMBER(name) PALP_WIRE_SEARCH_##name,
    PALP_WIRE_SEARCHES(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
        PALP_WIRE_SEARCH_COUNT
} palp_wire_search;

/* Kinds of a SEGMENT. Depths count from contact, positive into the specimen.
 * MOVE: to target at rate, corners rounded by at most acceleration. HOLD: for duration.
 * CYCLE: cycles times to target at rate and back to where the segment began.
 * SINE: cycles periods of frequency about where the segment began, amplitude = target.
 * SWEEP: the same with the frequency rising exponentially to frequency_end over duration.
 * FORCE: to a force, target in uN, at rate in uN/s, and holds it for duration; from the air to contact
 * first; no deeper than deepest (0: than the travel). */
#define PALP_WIRE_SEGMENT_KINDS(X) X(MOVE) X(HOLD) X(CYCLE) X(SINE) X(SWEEP) X(FORCE)
typedef enum palp_wire_segment_kind {
#define PALP_WIRE_MEMBER(name) PALP_WIRE_SEGMENT_##name,
    PALP_WIRE_SEGMENT_KINDS(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
        PALP_WIRE_SEGMENT_KIND_COUNT
} palp_wire_segment_kind;

/* Added to the kind of MOVE and CYCLE: their acceleration rises and falls as 1 - cos, up to what is asked
 * for, and does not jump. */
enum { PALP_WIRE_SEGMENT_SMOOTH = 128 };

/* Bits of a sample's flags; 8 to 12 are the segment in progress. */
enum {
    PALP_WIRE_FLAG_RECORD = 1,     /* part of a run's recording */
    PALP_WIRE_FLAG_TRAJECTORY = 2, /* the segments are being followed (bits 8 to 12 say which) */
    PALP_WIRE_FLAG_MOTOR = 4,      /* the motor is on */
    PALP_WIRE_FLAG_DERATED = 8,    /* a limit holds the motor back */
    PALP_WIRE_FLAG_HOME_SWITCH = 16,
    PALP_WIRE_FLAG_SENSOR_BAD = 32,  /* these ADC counts are not a reading */
    PALP_WIRE_FLAG_TICK_MISSED = 64, /* a tick before this one was missed */
    PALP_WIRE_FLAG_FAULT = 128,
    PALP_WIRE_FLAG_TRIGGER_IN = 8192,  /* a pulse has come in since the tick before */
    PALP_WIRE_FLAG_TRIGGER_OUT = 16384 /* a pulse goes out with it */
};

/* TRIGGER: what a pulse that comes in does. */
enum { PALP_WIRE_TRIGGER_IGNORED = 0, PALP_WIRE_TRIGGER_MARKS = 1, PALP_WIRE_TRIGGER_STARTS = 2 };

enum { PALP_WIRE_GAINS_AUTO = 255 }; /* GAINS: the class follows from the measured stiffness */

/* clang-format off */

/* The fields of each message: F(type, name), A(type, name, count). All little-endian, without padding. */
/* ---- host to device; each is answered by ACK (HELLO also by INFO, the GET ones by what they ask) ---- */
#define PALP_WIRE_HELLO(F, A) F(u16, protocol)
#define PALP_WIRE_ALIVE(F, A) F(u8, reserved)
#define PALP_WIRE_STREAM(F, A) F(u8, on)
#define PALP_WIRE_CLEAR_FAULT(F, A) F(u8, reserved)
#define PALP_WIRE_HOME(F, A) F(u8, reserved)
#define PALP_WIRE_TARE(F, A) F(u16, samples) /* averages so many ticks of every channel, 1..4096 */
/* Row axis (0..5: Fx Fy Fz Tx Ty Tz) of the calibration matrix: nN (nNm) for a count of each channel. */
#define PALP_WIRE_SET_CALIBRATION(F, A) F(u8, axis) A(i32, row, PALP_WIRE_CHANNELS)
#define PALP_WIRE_GET_CALIBRATION(F, A) F(u8, axis)
#define PALP_WIRE_LIMITS(F, A) /* within the machine's own; 0 leaves one as it is */                         \
    F(i32, force_uN) F(i32, travel_nm) F(i32, following_nm) F(i16, temperature_cC) F(u16, host_timeout_ms) \
    F(u16, overflow_samples)
#define PALP_WIRE_GET_LIMITS(F, A) F(u8, reserved)
#define PALP_WIRE_SELECT_GAINS(F, A) F(u8, softness)
#define PALP_WIRE_GET_GAINS(F, A) F(u8, softness)
#define PALP_WIRE_FIND_CONTACT(F, A) F(u32, rate_nm_s) F(i32, force_uN) F(i32, travel_nm)
#define PALP_WIRE_SEGMENT(F, A)                                                                          \
    F(u8, index) F(u8, kind) F(i32, target_nm) F(u32, rate_nm_s) F(u32, acceleration_um_s2) \
    F(u32, duration_ms) \
    F(u32, frequency_mHz) F(u32, frequency_end_mHz) F(u16, cycles) F(i32, deepest_nm)
/* Goes to start, rests there for air, follows the segments, withdraws to start, rests there for after;
 * all but the first is flagged RECORD. */
#define PALP_WIRE_START(F, A) F(u8, segments) F(i32, start_nm) F(u32, air_ms) F(u32, after_ms)
#define PALP_WIRE_STOP(F, A) F(u8, reserved) /* ends a motion by withdrawing */
#define PALP_WIRE_GET_STATUS(F, A) F(u8, reserved)
#define PALP_WIRE_HALT(F, A) F(u8, reserved) /* the motor off at once: the fault EMERGENCY_STOP */
#define PALP_WIRE_JOG(F, A) F(i32, to_nm) F(u32, rate_nm_s) /* to a place below home, and holds it there */
/* in: PALP_WIRE_TRIGGER_*; out: pulses with a recording's first sample and every so many after it (0: none
 * more) */
#define PALP_WIRE_TRIGGER(F, A) F(u8, in) F(u8, out) F(u16, every)
/* The machine's parameters, by number; as the bits of an IEEE 754 binary32 in SI units. Set in IDLE only. */
#define PALP_WIRE_GET_PARAMETER(F, A) F(u8, id)
#define PALP_WIRE_SET_PARAMETER(F, A) F(u8, id) F(u32, value)
#define PALP_WIRE_SAVE(F, A) F(u8, reserved) /* those in use, into flash; begins to */
#define PALP_WIRE_GET_CONFIGURATION(F, A) F(u8, reserved)
/* ---- device to host ---- */
#define PALP_WIRE_ACK(F, A) F(u16, sequence) F(u8, command) F(u8, result)
#define PALP_WIRE_INFO(F, A)                                                                              \
    F(u16, protocol) F(u8, major) F(u8, minor) F(u8, patch) F(u8, simulated) F(u16, tick_Hz) \
    F(u32, count_pm) \
    F(i32, travel_nm) F(i32, force_uN) A(u8, board, PALP_WIRE_NAME) F(u32, serial)
#define PALP_WIRE_STATUS(F, A)                                                                          \
    F(u32, tick) F(u8, state) F(u8, fault) F(u32, fault_tick) F(u8, homed) F(u8, contact_known) \
    F(u8, search) F(u8, softness) \
    F(i32, position) F(i32, contact) F(u32, stiffness_mN_m) F(i32, force_uN) F(i16, case_cC) \
    F(i16, winding_cC) \
    F(u16, derating_permille) F(u32, missed_ticks) F(u32, bad_frames) F(u32, tick_cost) F(u16, stack_free)
#define PALP_WIRE_CALIBRATION(F, A) /* tare in sixteenths of a count */ \
    F(u8, axis) A(i32, row, PALP_WIRE_CHANNELS) A(i32, tare, PALP_WIRE_CHANNELS)
#define PALP_WIRE_GAINS(F, A) /* of a class of softness; stiffness: where the class ends */ \
    F(u8, softness) F(u32, stiffness_mN_m) F(u32, kp_N_m) F(u32, ki_N_m_s) F(u32, kd_mN_s_m) \
    F(u32, filter_mHz) \
    F(u32, feed_mN_m)
/* What LIMITS has left in force. */
#define PALP_WIRE_LIMITS_NOW(F, A) PALP_WIRE_LIMITS(F, A)
/* One of them: which of how many of its name; standard: what is compiled in; name: zero-padded, with its
 * unit. */
#define PALP_WIRE_PARAMETER(F, A)                                                                      \
    F(u8, id) F(u8, index) F(u8, count) F(u32, value) F(u32, standard) F(u32, low) F(u32, high) \
    A(u8, name, PALP_WIRE_PARAMETER_NAME)
/* source: 0 compiled in, 1 from flash, 2 compiled in because what is in flash is damaged; bad: damaged
 * records; saving: 0 no, 1 in progress, 2 the last one failed; id, stored_id: CRC-32 of the parameters in
 * use and in flash (0: none); room: records until the next start. */
#define PALP_WIRE_CONFIGURATION(F, A)                                                         \
    F(u8, source) F(u8, bad) F(u8, saving) F(u8, parameters) F(u32, id) F(u32, stored_id) F(u8, room)
/* count <= PALP_WIRE_SAMPLES consecutive ticks from tick on; what follows count is zero. error: reference
 * minus position in counts, held at the ends of its range. adc: channel by channel within a tick. duty: of
 * the motor, 32767 = full. */
#define PALP_WIRE_SAMPLES_MESSAGE(F, A)                                                      \
    F(u32, tick) F(u8, count) F(u8, state) F(i16, case_cC) A(i32, position, PALP_WIRE_SAMPLES) \
    A(i16, error, PALP_WIRE_SAMPLES) A(i16, adc, PALP_WIRE_SAMPLES * PALP_WIRE_CHANNELS)       \
    A(i16, duty, PALP_WIRE_SAMPLES) A(u16, flags, PALP_WIRE_SAMPLES)

/* X(NAME, number, member, fields): the only list of messages. Below 128: host to device. */
#define PALP_WIRE_MESSAGES(X)                                     \
    X(HELLO, 1, hello, PALP_WIRE_HELLO)                           \
    X(ALIVE, 2, alive, PALP_WIRE_ALIVE)                           \
    X(STREAM, 3, stream, PALP_WIRE_STREAM)                        \
    X(CLEAR_FAULT, 4, clear_fault, PALP_WIRE_CLEAR_FAULT)         \
    X(HOME, 5, home, PALP_WIRE_HOME)                              \
    X(TARE, 6, tare, PALP_WIRE_TARE)                              \
    X(SET_CALIBRATION, 7, set_calibration, PALP_WIRE_SET_CALIBRATION) \
    X(GET_CALIBRATION, 8, get_calibration, PALP_WIRE_GET_CALIBRATION) \
    X(LIMITS, 9, limits, PALP_WIRE_LIMITS)                        \
    X(SELECT_GAINS, 10, select_gains, PALP_WIRE_SELECT_GAINS)     \
    X(GET_GAINS, 11, get_gains, PALP_WIRE_GET_GAINS)              \
    X(FIND_CONTACT, 12, find_contact, PALP_WIRE_FIND_CONTACT)     \
    X(SEGMENT, 13, segment, PALP_WIRE_SEGMENT)                    \
    X(START, 14, start, PALP_WIRE_START)                          \
    X(STOP, 15, stop, PALP_WIRE_STOP)                             \
    X(GET_STATUS, 16, get_status, PALP_WIRE_GET_STATUS)           \
    X(GET_LIMITS, 17, get_limits, PALP_WIRE_GET_LIMITS)           \
    X(HALT, 18, halt, PALP_WIRE_HALT)                             \
    X(JOG, 19, jog, PALP_WIRE_JOG)                                \
    X(TRIGGER, 20, trigger, PALP_WIRE_TRIGGER)                    \
    X(GET_PARAMETER, 21, get_parameter, PALP_WIRE_GET_PARAMETER)  \
    X(SET_PARAMETER, 22, set_parameter, PALP_WIRE_SET_PARAMETER)  \
    X(SAVE, 23, save, PALP_WIRE_SAVE)                             \
    X(GET_CONFIGURATION, 24, get_configuration, PALP_WIRE_GET_CONFIGURATION) \
    X(ACK, 128, ack, PALP_WIRE_ACK)                               \
    X(INFO, 129, info, PALP_WIRE_INFO)                            \
    X(STATUS, 130, status, PALP_WIRE_STATUS)                      \
    X(SAMPLES, 131, samples, PALP_WIRE_SAMPLES_MESSAGE)           \
    X(CALIBRATION, 132, calibration, PALP_WIRE_CALIBRATION)       \
    X(GAINS, 133, gains, PALP_WIRE_GAINS)                         \
    X(LIMITS_NOW, 134, limits_now, PALP_WIRE_LIMITS_NOW)          \
    X(PARAMETER, 135, parameter, PALP_WIRE_PARAMETER)             \
    X(CONFIGURATION, 136, configuration, PALP_WIRE_CONFIGURATION)

/* clang-format on */

typedef uint8_t palp_wire_u8;
typedef uint16_t palp_wire_u16;
typedef uint32_t palp_wire_u32;
typedef int16_t palp_wire_i16;
typedef int32_t palp_wire_i32;

#define PALP_WIRE_FIELD(type, name) palp_wire_##type name;
#define PALP_WIRE_ARRAY(type, name, count) palp_wire_##type name[count];
#define PALP_WIRE_STRUCT(NAME, number, member, fields)                                                       \
    typedef struct palp_wire_##member {                                                                      \
        fields(PALP_WIRE_FIELD, PALP_WIRE_ARRAY)                                                             \
    } palp_wire_##member;
PALP_WIRE_MESSAGES(PALP_WIRE_STRUCT)
#undef PALP_WIRE_STRUCT
#undef PALP_WIRE_FIELD
#undef PALP_WIRE_ARRAY

typedef enum palp_wire_type {
    PALP_WIRE_TYPE_NONE = 0,
#define PALP_WIRE_MEMBER(NAME, number, member, fields) PALP_WIRE_TYPE_##NAME = number,
    PALP_WIRE_MESSAGES(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
} palp_wire_type;

/* A message with its header. sequence counts the sender's frames; lost: samples the sender had to drop
 * since it started (0 from the host). A plain value. */
typedef struct palp_wire_message {
    uint8_t type; /* palp_wire_type */
    uint16_t sequence;
    uint32_t lost;
    union {
#define PALP_WIRE_MEMBER(NAME, number, member, fields) palp_wire_##member member;
        PALP_WIRE_MESSAGES(PALP_WIRE_MEMBER)
#undef PALP_WIRE_MEMBER
    } as;
} palp_wire_message;

/* Longest payload (header and body), and longest frame with its closing zero. */
enum { PALP_WIRE_PAYLOAD_MAX = 240, PALP_WIRE_FRAME_MAX = PALP_WIRE_PAYLOAD_MAX + 5 };

/* Bytes of a payload of this type, header included; 0 for a type that is not in the list. */
PALP_API size_t palp_wire_payload_size(uint8_t type);

/* Encodes a message into frame (>= PALP_WIRE_FRAME_MAX bytes): COBS of the payload, three check
 * characters, a zero. Its length, or 0 for a type that is not in the list. */
PALP_API size_t palp_wire_encode(const palp_wire_message *message, uint8_t *frame);

/* Collects bytes into frames. Zero-initialised = ready; a plain value. */
typedef struct palp_wire_decoder {
    uint16_t n;      /* bytes held */
    uint32_t frames; /* good frames so far */
    uint32_t bad;    /* frames that were damaged, too long, unknown or of the wrong length */
    uint8_t byte[PALP_WIRE_FRAME_MAX];
} palp_wire_decoder;

/* Takes one byte; true when it closed a good frame, which is then in *message (untouched otherwise). A
 * damaged frame is counted and dropped; the next zero starts afresh. Never reads or writes outside. */
PALP_API bool palp_wire_decode(palp_wire_decoder *decoder, uint8_t byte, palp_wire_message *message);

/* CRC-16/IBM-3740 (polynomial 0x1021, start 0xffff; check value 0x29b1). */
PALP_API uint16_t palp_wire_crc(const uint8_t *byte, size_t n);

/* Names for messages and files, "?" for a number outside the list. Never NULL. */
PALP_API const char *palp_wire_type_name(uint8_t type);
PALP_API const char *palp_wire_state_name(uint8_t state); /* "boot" ... */
PALP_API const char *palp_wire_fault_name(uint8_t fault); /* "over_force" ... */
PALP_API const char *palp_wire_fault_text(uint8_t fault);
PALP_API const char *palp_wire_result_text(uint8_t result);

#ifdef __cplusplus
}
#endif
#endif
