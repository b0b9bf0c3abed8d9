/* app_parameters.c: what can be set of the machine: one table of named parameters, kept in flash (store.h).
 *
 * A record in flash holds them in this order: a new one goes to the end, none is taken out. SI units. */
#include "app_internal.h"

#include "real.h"

#include <string.h>

/* X(name, where in the app, how many, floats from one to the next, least, most) */
#define GAIN_STRIDE (sizeof(gains) / sizeof(float))
#define PARAMETERS(X)                                                                                        \
    X(calibration_day, calibrated.day, 1, 1, 0.0f, 100000.0f)                                                \
    X(compliance_m_N, calibrated.compliance_m_N, 1, 1, 0.0f, 1e-3f)                                          \
    X(noise_N, calibrated.noise_N, 1, 1, 0.0f, 10.0f)                                                        \
    X(sensitivity_sd, calibrated.sensitivity_sd, 1, 1, 0.0f, 1.0f)                                           \
    X(lift_N, calibrated.lift_N, 1, 1, -20.0f, 20.0f)                                                        \
    X(ripple_N, calibrated.ripple_N, 1, 1, 0.0f, 20.0f)                                                      \
    X(count_m, machine.count_m, 1, 1, 1e-8f, 1e-4f)                                                          \
    X(travel_m, machine.travel_m, 1, 1, 2e-3f, 0.5f)                                                         \
    X(speed_m_s, machine.speed_m_s, 1, 1, 1e-3f, 2.0f)                                                       \
    X(force_N, machine.force_N, 1, 1, 0.1f, 200.0f)                                                          \
    X(motor_N, machine.motor_N, 1, 1, 1.0f, 1000.0f)                                                         \
    X(motor_drag_Ns_m, machine.motor_drag_Ns_m, 1, 1, 0.0f, 1000.0f)                                         \
    X(moving_kg, machine.moving_kg, 1, 1, 0.01f, 20.0f)                                                      \
    X(friction_N, machine.friction_N, 1, 1, 0.0f, 20.0f)                                                     \
    X(supply_V, machine.supply_V, 1, 1, 5.0f, 60.0f)                                                         \
    X(resistance_ohm, machine.resistance_ohm, 1, 1, 0.1f, 100.0f)                                            \
    X(force_constant_N_A, machine.force_constant_N_A, 1, 1, 0.1f, 200.0f)                                    \
    X(current_A, machine.current_A, 1, 1, 0.1f, 20.0f)                                                       \
    X(winding_K_W, machine.winding_K_W, 1, 1, 0.1f, 50.0f)                                                   \
    X(winding_s, machine.winding_s, 1, 1, 1.0f, 10000.0f)                                                    \
    X(derate_C, machine.derate_C, 1, 1, 40.0f, 100.0f)                                                       \
    X(fault_C, machine.fault_C, 1, 1, 101.0f, 180.0f)                                                        \
    X(following_m, machine.following_m, 1, 1, 1e-5f, 0.01f)                                                  \
    X(Fx_N, force.matrix[0], 6, 1, -2.0f, 2.0f)                                                              \
    X(Fy_N, force.matrix[1], 6, 1, -2.0f, 2.0f)                                                              \
    X(Fz_N, force.matrix[2], 6, 1, -2.0f, 2.0f)                                                              \
    X(Tx_Nm, force.matrix[3], 6, 1, -2.0f, 2.0f)                                                             \
    X(Ty_Nm, force.matrix[4], 6, 1, -2.0f, 2.0f)                                                             \
    X(Tz_Nm, force.matrix[5], 6, 1, -2.0f, 2.0f)                                                             \
    X(class_N_m, gains[0].stiffness_N_m, GAINS_CLASSES, GAIN_STRIDE, 1.0f, 1e7f)                             \
    X(kp_N_m, gains[0].kp_N_m, GAINS_CLASSES, GAIN_STRIDE, 10.0f, 1e6f)                                      \
    X(ki_N_ms, gains[0].ki_N_ms, GAINS_CLASSES, GAIN_STRIDE, 0.0f, 1e8f)                                     \
    X(kd_Ns_m, gains[0].kd_Ns_m, GAINS_CLASSES, GAIN_STRIDE, 0.0f, 1e4f)                                     \
    X(filter_Hz, gains[0].filter_Hz, GAINS_CLASSES, GAIN_STRIDE, 1.0f, 500.0f)                               \
    X(feed_N_m, gains[0].feed_N_m, GAINS_CLASSES, GAIN_STRIDE, 0.0f, 1e6f)

typedef struct row {
    char name[PALP_WIRE_PARAMETER_NAME];
    uint16_t offset; /* in the app */
    uint8_t count, stride;
    float low, high;
} row;

static const row rows[] = {
#define ROW(name, member, count, stride, low, high) {#name, offsetof(app, member), count, stride, low, high},
    PARAMETERS(ROW)
#undef ROW
};

enum {
#define ROW(name, member, count, stride, low, high) +(count)
    COUNT = 0 PARAMETERS(ROW),
#undef ROW
    FITS = 1 / (COUNT <= STORE_VALUES && COUNT <= UINT8_MAX),
};

/* The row of a parameter, and which of its values; NULL: there is no such number. */
static const row *row_of(uint8_t id, uint8_t *index) {
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; id = (uint8_t)(id - rows[i++].count)) {
        if (id < rows[i].count) {
            *index = id;
            return &rows[i];
        }
    }
    return NULL;
}

static size_t place(const row *r, uint8_t index) {
    return r->offset + sizeof(float) * r->stride * index;
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint32_t read_bits(const app *a, const row *r, uint8_t index) {
    uint32_t bits;
    memcpy(&bits, (const char *)a + place(r, index), sizeof bits);
    return bits;
}

static bool write_bits(app *a, const row *r, uint8_t index, uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    if (!(value >= r->low && value <= r->high)) /* not so a NaN */
        return false;
    memcpy((char *)a + place(r, index), &value, sizeof value);
    return true;
}

/* The compiled-in values, at the same places of another app. */
static uint32_t standard_bits(const app *a, const row *r, uint8_t index) {
    const size_t at = place(r, index), matrix = offsetof(app, force.matrix), table = offsetof(app, gains);
    uint32_t bits = 0;
    if (at < sizeof(machine))
        memcpy(&bits, (const char *)a->standard + at, sizeof bits);
    else if (at >= table && at < table + sizeof gains_table)
        memcpy(&bits, (const char *)gains_table + at - table, sizeof bits);
    else if (at >= matrix && at < matrix + sizeof(((force_sensor *)0)->matrix))
        bits = bits_of(force_standard(a->standard->count_nN, (uint8_t)((at - matrix) / sizeof(float))));
    return bits;
}

/* A sensor that reads 0 along the press would not notice any force. */
static bool sees(const app *a) {
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        if (a->force.matrix[FORCE_Z][i] != 0.0f)
            return true;
    return false;
}

bool parameters_get(const app *a, uint8_t id, palp_wire_parameter *one) {
    uint8_t index = 0;
    const row *r = row_of(id, &index);
    if (r == NULL)
        return false;
    *one = (palp_wire_parameter){.id = id,
                                 .index = index,
                                 .count = r->count,
                                 .value = read_bits(a, r, index),
                                 .standard = standard_bits(a, r, index),
                                 .low = bits_of(r->low),
                                 .high = bits_of(r->high)};
    memcpy(one->name, r->name, sizeof one->name);
    return true;
}

/* Positions in metres may now be other places, and limits may have changed. */
void parameters_changed(app *a) {
    uint32_t check = 0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        for (uint8_t k = 0; k < rows[i].count; k++)
            check = store_check(check, read_bits(a, &rows[i], k));
    a->id = check;
}

uint8_t parameters_set(app *a, const palp_wire_set_parameter *asked) {
    uint8_t index = 0;
    const row *r = row_of(asked->id, &index);
    if (r == NULL)
        return PALP_WIRE_RESULT_RANGE;
    const uint32_t before = read_bits(a, r, index);
    if (!write_bits(a, r, index, asked->value))
        return PALP_WIRE_RESULT_RANGE;
    if (!sees(a)) {
        (void)write_bits(a, r, index, before);
        return PALP_WIRE_RESULT_RANGE;
    }
    a->homed = a->contact_known = false;
    watch_limits_begin(a);
    parameters_changed(a);
    return PALP_WIRE_RESULT_DONE;
}

/* ---- all of them, in flash ---- */

/* A record whose check is right may still hold what this firmware does not take. Its values were measured
 * together: then none of them is used, but what is compiled in. */
void app_load(app *a, const uint32_t *stored) {
    uint32_t n = 0;
    uint8_t index = 0;
    bool good = true;
    store_open(&a->store, stored);
    const uint32_t *value = store_values(&a->store, &n);
    for (uint8_t id = 0; id < COUNT && id < n; id++) {
        const row *r = row_of(id, &index);
        good = write_bits(a, r, index, value[id]) && good;
    }
    good = good && sees(a);
    for (uint8_t id = 0; id < COUNT && !good; id++) {
        const row *r = row_of(id, &index);
        (void)write_bits(a, r, index, standard_bits(a, r, index));
    }
    a->store.bad = (uint8_t)(a->store.bad + !good);
    watch_limits_begin(a);
    parameters_changed(a);
    a->stored_id = good && n > 0 ? a->id : 0;
}

uint8_t parameters_save(app *a) {
    if (a->id == a->stored_id)
        return PALP_WIRE_RESULT_DONE;
    return store_begin(&a->store, COUNT) ? PALP_WIRE_RESULT_DONE : PALP_WIRE_RESULT_FULL;
}

/* No parameter changes while it is written: such commands are refused. */
bool parameters_write(app *a, app_outputs *out) {
    uint8_t index = 0;
    if (app_drives(a))
        return false;
    const row *r = row_of((uint8_t)store_wants(&a->store), &index);
    if (store_step(&a->store, read_bits(a, r, index), &out->store_at, &out->store_word))
        return true;
    if (!a->store.failed)
        a->stored_id = a->id;
    return false;
}

palp_wire_configuration parameters_state(const app *a) {
    const store *s = &a->store;
    const uint32_t area_left = s->room < STORE_WORDS ? STORE_AREA - s->room % STORE_AREA : 0;
    return (palp_wire_configuration){.source = a->stored_id != 0 ? 1
                                               : s->bad > 0      ? 2
                                                                 : 0,
                                     .bad = s->bad,
                                     .saving = s->writing  ? 1
                                               : s->failed ? 2
                                                           : 0,
                                     .parameters = COUNT,
                                     .id = a->id,
                                     .stored_id = a->stored_id,
                                     .room =
                                         (uint8_t)((area_left + (s->spare ? STORE_AREA : 0)) / STORE_RECORD)};
}
